"""Stability maps of the time domain: drag, step, mass, frequency, structural damping; against runs with finer steps."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from solvers import Motion, Status, cable_system, solve_time_domain
from solvers.generalized_alpha import Scheme

from .dynamic_cases import scene
from .stability_cables import defect
from .stability_maps import Axis, Found, Map

NODES = 10
FREQUENCY, AMPLITUDE = 0.05, 2.0  # Hz, m
STEPS, PERIODS = 40, 1.5  # steps in a period; half a period of ramp, then one period
HALVINGS = 2  # of the step, for the truth
MOST_STEPS = 300  # runs with shorter steps end before their period is over

TOLERANCE = 1e-10  # mean |dy| of the last Newton step, the solver's default
DRIFT = 1.0
"""Largest distance of the fairlead from its place, in half the acceleration of its motion times the square of the step,
or of the time in which the line answers: what is added before the correction is felt."""
RELATION = 1e-9  # of the largest value of each field: y(n+1) - y(n) against its rates

AMPLITUDES = Axis("amplitude of the surge, m", (0.01, 0.1, 1.0, 2.0, 5.0, 8.0, 11.0, 15.0, 20.0))
DRAG = Axis("drag coefficient", (0.0, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0))
STEP = Axis("step, share of the period", (1e-4, 1e-3, 3e-3, 0.01, 0.03, 0.1, 0.25, 0.5))
RADIUS = Axis("spectral radius", (0.0, 0.3, 0.6, 0.9, 1.0))
MASS = Axis("mass over displaced water", (1e-3, 0.01, 0.1, 1.0, 10.0, 100.0, 1e3))
ADDED = Axis("added mass coefficient", (0.0, 0.1, 1.0, 10.0, 100.0))
HERTZ = Axis("frequency, Hz", (1e-4, 1e-3, 0.01, 0.03, 0.107, 0.2, 0.5, 1.23, 3.0, 10.0))
SMALL = Axis("amplitude of the surge, m", (1e-4, 1e-3, 0.01, 0.1, 1.0, 3.0))
BETA = Axis("damping time, s", (0.0, 1e-3, 0.1, 1.0, 10.0, 100.0))


def maps() -> list[Map]:
    """All of the time domain."""
    error = "error of the fairlead tension over its range, against steps four times as short"
    claim = "the rows of every step met to the solver's tolerance, states finite, no tension below zero at a step"
    held = f"{claim}, the fairlead within one step's error of its place"
    lost = (
        "Invalid: the solver stops with a status, at the time and node where the tension vanishes or the line would "
        "break. Too coarse: a shorter step does so, or fails. With a spectral radius near 1 nothing damps the shortest "
        "waves, which the velocity that holds the end at its place excites; holding its mean does not."
    )

    def make(name, title, x, y, solve, hold="mean", **more):
        solve = partial(solve, hold=hold)
        said = held if hold == "position" else claim
        return Map(f"time_{name}", "time domain", title, x, y, error, said, solve, lost, nodes=NODES, **more)

    return [
        make("drag", "Drag by amplitude", DRAG, AMPLITUDES, lambda c, a, hold: _solve(line(a, Cdn=c), hold)),
        make("step", "Step by spectral radius, end held", STEP, RADIUS, _stepped, "position",
             brief=((1e-3, 0.01, 0.1, 0.5), (0.0, 0.6, 1.0))),
        make("step_mean", "Step by spectral radius, mean held", STEP, RADIUS, _stepped,
             brief=((0.01, 0.1, 0.5), (0.0, 0.6, 1.0))),
        make("mass", "Mass by added mass", MASS, ADDED,
             lambda m, c, hold: _solve(line(AMPLITUDE, ratio=m, Ca=c), hold)),
        make("frequency", "Frequency by amplitude", HERTZ, SMALL, lambda f, a, hold: _solve(line(a, f), hold)),
        make("stiff", "Structural damping by step", BETA, Axis(STEP.label, STEP.values[2:]),
             lambda b, share, hold: _solve(line(AMPLITUDE, damping=b), hold, 1 / share),
             brief=((0.0, 0.1, 10.0), (0.03, 0.1, 0.5))),
    ]  # fmt: skip


def line(amplitude, frequency=FREQUENCY, *, nodes=NODES, ratio=None, **section):
    """The OC3 line in surge with another section; ratio: mass over displaced water, the weight kept."""
    at = scene("case_1")
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
    lost = list(broken(history, Scheme.from_spectral_radius(radius), hold))
    finer = run(dt=dt / 2**HALVINGS)
    if not finer.success:
        return Found(history.status, lost=lost, finer=finer.status)
    tension, exact = history.tension[-1], finer.tension[-1]
    return Found(history.status, float(abs(tension - exact[:: 2**HALVINGS]).max() / np.ptp(exact)), lost)


def broken(history, scheme, hold):
    """Claims of a finished time history that do not hold, in words."""
    y, ydot, time, system = history.y, history.ydot, history.time, history.moved
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
    if hold == "position":
        fine = np.linspace(0.0, time[-1], 20 * time.size)
        pace = max(dt, history.system.answer())
        drift = history.drift().max() / (np.linalg.norm(system.motion.acceleration(fine), axis=0).max() * pace**2 / 2)
        if drift > DRIFT:
            yield f"drift {drift:.3g}"
