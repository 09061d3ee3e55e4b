"""Stability maps of the harmonic balance: harmonics, frequency, drag, amplitude; against twice as many harmonics."""

from __future__ import annotations

import numpy as np

from solvers import Status, solve_periodic
from solvers.common import diagnostics

from .cables import flowing
from .maps import Axis, Found, Map
from .time import DRAG, FLOW, HERTZ, NODES_OF_MESH, SMALL, SURGES, line

HARMONICS = 8
SAMPLES = 16  # at which the claims are looked at, for each harmonic

ROWS = 1e-9
"""Largest Fourier coefficient of a row over the sum of the sizes of its terms at the samples."""
ERROR = 4 * diagnostics.TAIL
"""Largest error without a warning, of the range of the tension: a tail of harmonics, some of them near a resonance."""
MEAN = 1e-8  # m: the mean place of the fairlead over the samples, of a chord of 885 m

ORDERS = Axis("harmonics", (1, 2, 3, 5, 9, 15, 30, 60))
AMPLITUDES = Axis("amplitude of the surge, m", (0.01, 0.1, 1.0, 3.0, 6.0, 7.5, 9.0, 12.0))
COSTLY, LARGE = 30, 7.5  # harmonics, m: giving up takes seconds to a minute there


def maps() -> list[Map]:
    """All of the harmonic balance."""
    error = "error of the fairlead tension over its range, against twice the harmonics, from 30 on half as many more"
    claim = (
        f"the Fourier coefficients of the rows zero to {ROWS:g} of their terms, the fairlead's mean place kept to "
        f"{MEAN:g} m, no tension below zero at any instant; and without a warning the error within {ERROR:g} of the "
        "range"
    )
    why = (
        "Not converged: Newton's method gets nowhere even with the amplitude raised in small steps. Invalid: the "
        "response solves the equations and is no motion of a cable, which carries no compression; its status says so."
    )
    make = lambda name, title, x, y, solve, **more: Map(
        f"harmonic_{name}", "harmonic balance", title, x, y, error, claim, solve, why, **more
    )
    costly = {
        "brief": ((1, 3, 9), (0.1, 3.0, 9.0)),
        "skip": lambda k, a: k >= COSTLY and a > (LARGE if k < 2 * COSTLY else 1.0),
        "left_out": f"Blank: {COSTLY} harmonics and more where the tension is lost, as giving up takes up to a minute; "
        f"and {2 * COSTLY} above 1 m.",
    }
    return [
        make("orders", "Harmonics by amplitude", ORDERS, AMPLITUDES, lambda k, a: _solve(line(a), k), **costly),
        make("nodes", "Nodes by harmonics", NODES_OF_MESH, Axis("harmonics", (2, 5, 8)),
             lambda n, k: _solve(line(1e-3, nodes=n), k), brief=((3, 10, 100), (2, 8)),
             skip=lambda n, k: n * k > 10000, left_out="Blank: 8 harmonics on 2000 nodes, which take a gigabyte."),
        make("current", "Current by amplitude", FLOW, SURGES, lambda v, a: _solve(line(a, around=flowing(v))),
             brief=((0.0, 1.0, 5.0), (0.1, 3.0))),
        make("frequency", "Frequency by amplitude", HERTZ, SMALL, lambda f, a: _solve(line(a, f))),
        make("drag", "Drag by amplitude", DRAG, AMPLITUDES, lambda c, a: _solve(line(a, Cdn=c)),
             brief=((0.0, 1.0, 100.0), (0.1, 3.0))),
    ]  # fmt: skip


def _solve(system, harmonics=HARMONICS) -> Found:
    response = solve_periodic(system, harmonics=harmonics, throw=False)
    if response.status is not Status.SUCCESS:
        return Found(response.status, values={"amplitude": response.amplitude, "iterations": response.iterations})
    lost, warned = list(broken(response)), response.warnings
    more = (2 if harmonics < COSTLY else 1.5) * harmonics
    finer = solve_periodic(system, harmonics=int(more), start=response, throw=False)
    if not finer.success:
        return Found(response.status, lost=lost, finer=finer.status, warned=warned)
    t = system.period * np.arange(16 * harmonics) / (16 * harmonics)
    tension, exact = response.fairlead_tension(t), finer.fairlead_tension(t)
    error = float(abs(tension - exact).max() / np.ptp(exact))
    if not warned and error > ERROR:
        lost.append(f"error {error:.3g}")
    return Found(response.status, error, lost, warned=warned)


def broken(response):
    """Claims of a response that do not hold, in words."""
    system, basis = response.system, response.basis
    y, ydot, t = response.y, response.ydot, response.time
    if not (np.isfinite(y).all() and np.isfinite(ydot).all()):
        yield "states that are not finite"
        return
    rows = system.cells(y, ydot, t)
    size = sum(
        np.einsum("ijns,jns->ins", abs(J[side]), abs(field)[:, at])
        for J, field in ((rows.dy, y), (rows.dydot, ydot))
        for side, at in enumerate((slice(None, -1), slice(1, None)))
    )
    left = abs(np.fft.rfft(rows.value)[..., : basis.harmonics + 1]) / t.size
    share = float((left / size.mean(axis=-1, keepdims=True)).max())
    if share > ROWS:
        yield f"rows {share:.3g}"
    count = SAMPLES * basis.harmonics
    fine = system.period * np.arange(count) / count
    state = response.at(fine)
    drift = float(abs(system.drift(y, t).mean(axis=-1)).max())
    if drift > MEAN:
        yield f"mean place {drift:.3g} m"
    tension = system.tension(state, response.rate_at(fine)).min()
    if tension < 0:
        yield f"tension {tension:.3g} N between the samples"
