"""Observed orders on the line of the HB paper: statics and dynamics in the cell, time integration in the step."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from solvers.cable.statics import solve_static
from solvers.cable.system import cable_system
from solvers.catenary.span import solve_span
from solvers.harmonic_balance.solve import solve_periodic
from solvers.time_domain.solve import solve_time_domain
from verification.registry import last_period_tension

from .cases import HARMONICS, PERIODS, axial_ratio, rms, scene

CASE = "case_1"
STATIC_CELLS = tuple(12 * 2**k for k in range(8))
CELLS, QUICK_CELLS = (12, 24, 48, 96, 192, 384), (12, 24, 48)
DT = 0.1  # s: of the time integration whose order in the cell is measured

STEPS, QUICK_STEPS = (50, 100, 200, 400, 800, 1600), (50, 100, 200, 400)  # in a period
NODES, FINEST, QUICK_FINEST = 25, 60, 30  # nodes and harmonics of the orbit that is integrated
DAMPING = 0.02  # s, Kelvin-Voigt: the axial mode, which nothing else damps, then has 8 % of critical damping


def statics() -> dict:
    """Errors against the catenary: fairlead tension and tension along the line (relative), places (m)."""
    case = scene(CASE)
    exact, rows = solve_span(case.spans()[0]), []
    for cells in STATIC_CELLS:
        chain = cable_system(case, cells + 1)
        state = solve_static(chain)
        x, z, tension = exact.profile(chain.s)
        off = state.r[0] - case.anchor[0] - x, state.r[2] - case.anchor[2] - z
        rows.append(
            {
                "cells": cells,
                "ds": case.length / cells,
                "fairlead": abs(state.tension[-1] / tension[-1] - 1),
                "along": abs(state.tension - tension).max() / tension[-1],
                "place": np.hypot(*off).max(),
                "iterations": state.iterations,
            }
        )
    return with_orders(rows, ("fairlead", "along", "place"))


def in_cell(quick: bool):
    """Yield once a mesh; last the errors of both methods in the cell, against their own extrapolation."""
    waves_by_method = {"harmonic balance": [], "time domain": []}
    sizes = QUICK_CELLS if quick else CELLS
    for cells in sizes:
        chain = cable_system(scene(CASE), cells + 1)
        waves_by_method["harmonic balance"].append(last_period_tension(solve_periodic(chain, harmonics=HARMONICS)))
        waves_by_method["time domain"].append(last_period_tension(solve_time_domain(chain, dt=DT, periods=PERIODS)))
        yield None
    rows = [{"cells": cells, "ds": scene(CASE).length / cells} for cells in sizes]
    for method, waves in waves_by_method.items():
        rows = against_extrapolation(rows, method, waves)
    yield with_orders(rows, tuple(waves_by_method))


def against_extrapolation(rows, name: str, waves) -> list[dict]:
    """Rows with the error rms over range of each wave; the last two, halved once more, make the limit."""
    limit = waves[-1] + (waves[-1] - waves[-2]) / 3
    return [row | {name: rms(wave - limit) / np.ptp(limit)} for row, wave in zip(rows, waves, strict=True)]


def with_orders(rows, keys) -> dict:
    """The rows and, for each key, the order of every pair of neighbours (sizes are halved)."""
    orders = {key: [float(np.log2(rough[key] / fine[key])) for rough, fine in pairwise(rows)] for key in keys}
    return {"rows": rows, "orders": orders}


@dataclass(frozen=True)
class _Led:
    """A motion with a constant velocity added."""

    motion: object
    constant: np.ndarray

    @property
    def period(self):
        return self.motion.period

    def displacement(self, t):
        return self.motion.displacement(t)

    def velocity(self, t):
        return self.motion.velocity(t) + self.constant.reshape(3, *(1,) * np.ndim(t))

    def directions(self):
        return self.motion.directions()


def in_step(quick: bool):
    """Yield once a line; last the errors in the step, against the same orbit by harmonic balance, without and with
    structural damping, and of the damped one against its own extrapolation.

    Start on that orbit and integrate one period without a hold: nothing has to settle, and both solve the same
    ordinary differential equations. The mean velocity of the end that the periodic solution finds (its rows close the
    mean with the place) goes into the motion.
    """
    steps, harmonics = (QUICK_STEPS, QUICK_FINEST) if quick else (STEPS, FINEST)
    rows = [{"steps": count, "dt": scene(CASE).motion.period / count} for count in steps]
    for name, damping in (("undamped", 0.0), ("damped", DAMPING)):
        waves, periodic = _orbit(damping, steps, harmonics)
        rows = [row | {name: rms(wave - periodic) / np.ptp(periodic)} for row, wave in zip(rows, waves, strict=True)]
        yield None
    rows = against_extrapolation(rows, "extrapolated", waves)
    keys = ("undamped", "damped", "extrapolated")
    yield with_orders(rows, keys) | {"damping": DAMPING, "nodes": NODES, "harmonics": harmonics,
                                          "axial": axial_ratio(CASE)}  # fmt: skip


def _orbit(damping: float, steps, harmonics) -> tuple[list, np.ndarray]:
    """Waves of a period integrated with each number of steps, and that of harmonic balance."""
    case = scene(CASE)
    case = replace(case, cable=replace(case.cable, damping=damping))
    chain = cable_system(case, NODES)
    orbit = solve_periodic(chain, harmonics=harmonics)
    mean_place = chain.end(orbit.y, orbit.ydot, orbit.time, False).value.mean(axis=-1)
    system = cable_system(case, NODES, motion=_Led(case.motion, chain.axes.T @ mean_place))
    zero = np.zeros(1)
    start = orbit.at(zero)[..., 0], orbit.rate_at(zero)[..., 0]
    period = chain.period
    return [
        last_period_tension(solve_time_domain(system, dt=period / count, periods=1, hold=None, start=start))
        for count in steps
    ], last_period_tension(orbit)
