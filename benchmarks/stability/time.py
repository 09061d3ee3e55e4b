"""Stability maps of the time domain: drag, step, mass, frequency, structural damping; against runs with finer steps."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from solvers import Motion, Status, cable_system, solve_time_domain
from solvers.common import diagnostics
from solvers.time_domain.generalized_alpha import Scheme

from ..cable.cases import scene
from .cables import defect, flowing, resting
from .maps import Axis, Found, Map

NODES = 10
FREQUENCY, AMPLITUDE = 0.05, 2.0  # Hz, m
STEPS, PERIODS = 60, 1.0  # steps in a period; half a period of ramp, then half a period
HALVINGS = 2  # of the step, for the truth
MOST_STEPS = 160  # runs with shorter steps end before their period is over

TOLERANCE = 1e-10  # mean |dy| of the last Newton step, the solver's default
WAVES = 2e-3  # of the range of the tension: waves of the start, which a short step does not bend
BENDS = 4.0
"""Largest error without a warning, in what the slope of the tension changes in a step: the error of a method of second
order is about as large in a forced motion, and grows in a wave that nothing damps."""
RELATION = 1e-9  # of the largest value of each field: y(n+1) - y(n) against its rates

AMPLITUDES = Axis("amplitude of the surge, m", (0.01, 0.1, 1.0, 2.0, 5.0, 8.0, 11.0, 15.0, 20.0))
DRAG = Axis("drag coefficient", (0.0, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0))
STEP = Axis("step, share of the period", (1e-4, 1e-3, 3e-3, 0.01, 0.03125, 0.1, 0.25, 0.5))
RADIUS = Axis("spectral radius", (0.0, 0.3, 0.6, 0.9, 1.0))
MASS = Axis("mass over displaced water", (1e-3, 0.01, 0.1, 1.0, 10.0, 100.0, 1e3))
ADDED = Axis("added mass coefficient", (0.0, 0.1, 1.0, 10.0, 100.0))
HERTZ = Axis("frequency, Hz", (1e-4, 1e-3, 0.01, 0.03, 0.107, 0.2, 0.5, 1.23, 3.0, 10.0))
SMALL = Axis("amplitude of the surge, m", (1e-4, 1e-3, 0.01, 0.1, 1.0, 3.0))
NODES_OF_MESH = Axis("nodes", (3, 5, 10, 30, 100, 300, 1000, 2000))
COARSE_STEP = Axis("step, share of the period", (0.01, 0.02, 0.1, 0.5))
FLOW = Axis("current, m/s", (0.0, 0.1, 0.3, 1.0, 2.0, 3.0, 5.0))
GROUND = Axis("seabed stiffness, N/m²", (0.0, 1.0, 100.0, 1e3, 1e4, 1e5, 1e7, 1e9))
SURGES = Axis("amplitude of the surge, m", (0.01, 0.1, 1.0, 3.0, 6.0, 9.0))
BETA = Axis("damping time, s", (0.0, 1e-3, 0.1, 1.0, 10.0, 100.0))


def maps() -> list[Map]:
    """All of the time domain."""
    error = "error of the fairlead tension over its range, against steps four times as short"
    claim = (
        "the rows of every step met to the solver's tolerance, states finite, no tension below zero at a step; and "
        f"without a warning the error within {BENDS:g} times the change of the tension's slope in a step, for which it "
        f"warns above {diagnostics.CURVED:g} of the range, and {WAVES:g} for the waves of the start"
    )
    position_claim = f"{claim}, and the fairlead within {diagnostics.DRIFT:g} of its amplitude of its place"
    lost = (
        "Invalid: the solver stops with a status, at the time and node where the tension vanishes or the line would "
        "break. Too coarse: a shorter step does so, or fails. With a spectral radius near 1 nothing damps the shortest "
        "waves, which the velocity that holds the end at its place excites; holding its mean does not. Not converged: "
        "a step failed, the status says when and where, and asks for a shorter one."
    )

    ground = (
        "A stiff seabed takes up or lets go of a cell of this coarse mesh, the weight of a hundred metres, "
        "within millimetres of its path, and Newton's method jumps between the two."
    )

    def make(name, title, x, y, solve, hold="mean", at=NODES, **more):
        solve = partial(solve, hold=hold)
        claim_text = position_claim if hold == "position" else claim
        more = {"explained": lost, "nodes": at} | more
        return Map(f"time_{name}", "time domain", title, x, y, error, claim_text, solve, **more)

    return [
        make("drag", "Drag by amplitude", DRAG, AMPLITUDES, lambda c, a, hold: _solve(line(a, Cdn=c), hold),
             brief=((0.0, 1.0, 100.0), (0.1, 2.0, 20.0))),
        make("step", "Step by spectral radius, end held", STEP, RADIUS, _stepped, "position",
             brief=((0.01, 0.1, 0.5), (0.0, 0.6, 1.0))),
        make("step_mean", "Step by spectral radius, mean held", STEP, RADIUS, _stepped,
             brief=((0.01, 0.1, 0.5), (0.0, 0.6, 1.0))),
        make("mass", "Mass by added mass", MASS, ADDED,
             lambda m, c, hold: _solve(line(AMPLITUDE, ratio=m, Ca=c), hold)),
        make("frequency", "Frequency by amplitude", HERTZ, SMALL,
             lambda f, a, hold: _solve(line(a, f), hold), "position"),
        make("nodes", "Nodes by step, end held", NODES_OF_MESH, COARSE_STEP,
             lambda n, share, hold: _solve(line(AMPLITUDE, nodes=n), hold, 1 / share), "position", at=None,
             brief=((3, 10, 100), (0.02, 0.5))),
        make("current", "Current by amplitude", FLOW, SURGES,
             lambda v, a, hold: _solve(line(a, around=flowing(v)), hold), brief=((0.0, 1.0, 5.0), (0.1, 3.0))),
        make("seabed", "Seabed stiffness by amplitude, end held", GROUND, SURGES,
             lambda k, a, hold: _solve(line(a, around=resting(k)), hold), "position",
             brief=((0.0, 100.0, 1e4), (0.1, 3.0)), explained=ground),
        make("stiff", "Structural damping by step", BETA, Axis(STEP.label, STEP.values[2:]),
             lambda b, share, hold: _solve(line(AMPLITUDE, damping=b), hold, 1 / share),
             brief=((0.0, 0.1, 10.0), (0.03125, 0.1, 0.5))),
    ]  # fmt: skip


def line(amplitude, frequency=FREQUENCY, *, nodes=NODES, ratio=None, around=None, **section):
    """The OC3 line in surge with another section, around: or environment; ratio: mass over water, the weight kept."""
    at = scene("case_1")
    at = at if around is None else replace(at, environment=around)
    cable = replace(at.cable, Cdb=None, **section) if section else at.cable
    if ratio is not None:
        cable = replace(cable, mass_per_length=ratio * at.environment.rho * cable.area)
    motion = Motion.harmonic(frequency, (amplitude, 0.0, 0.0))
    return cable_system(replace(at, cable=cable, motion=motion), nodes)


def _stepped(share, radius, hold) -> Found:
    return _solve(line(AMPLITUDE), hold, 1 / share, radius)


def _solve(system, hold, steps=STEPS, radius=0.5) -> Found:
    dt = system.period / steps
    duration = min(PERIODS * system.period, MOST_STEPS * dt)
    run = partial(solve_time_domain, system, duration=duration, rho_inf=radius, hold=hold, throw=False)
    history = run(dt=dt)
    if history.status is not Status.SUCCESS:
        t, node = history.event
        return Found(history.status, values={"at": t / system.period, "node": node})
    lost, warned = list(broken(history, Scheme.from_spectral_radius(radius), hold)), history.warnings
    finer = run(dt=dt / 2**HALVINGS)
    if not finer.success:
        return Found(history.status, lost=lost, finer=finer.status, warned=warned)
    tension, exact = history.tension[-1], finer.tension[-1]
    error = float(abs(tension - exact[:: 2**HALVINGS]).max() / np.ptp(exact))
    allowed = BENDS * diagnostics.largest_slope_change(tension, history.time) / np.ptp(tension) + WAVES
    if not warned and error > allowed:
        lost.append(f"error {error:.3g} above {allowed:.3g}")
    return Found(history.status, error, lost, warned=warned)


def broken(history, scheme, hold):
    """Claims of a finished time history that do not hold, in words."""
    y, ydot, time, system = history.y, history.ydot, history.time, history.ramped_system
    if not (np.isfinite(y).all() and np.isfinite(ydot).all()):
        yield "states that are not finite"
        return
    if history.tension.min() < 0:
        yield f"tension {history.tension.min():.3g} N"
    between = lambda a, share: a[..., :-1] + share * np.diff(a)
    state, rate, dt = between(y, scheme.alpha_f), between(ydot, scheme.alpha_m), float(np.diff(time).max())
    rows = system.cells(state, rate, between(time, scheme.alpha_f))
    change = defect(rows, np.ones_like(state), np.full_like(rate, 1 / dt)) / (TOLERANCE * y[..., 0].size)
    if change > 1:
        yield f"rows {change:.3g} tolerances"
    miss = abs(np.diff(y) - np.diff(time) * between(ydot, scheme.gamma)) / abs(y).max(axis=(1, 2), keepdims=True)
    if miss.max() > RELATION:
        yield f"rates {miss.max():.3g}"
    if hold == "position" and not history.warnings:
        drift = history.drift().max() / np.linalg.norm(history.system.motion.sine[0])
        if drift > diagnostics.DRIFT:
            yield f"drift {drift:.3g}"
