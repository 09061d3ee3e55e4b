"""Stability maps of the cable at rest: current and seabed by the number of nodes, against shooting and the catenary.

Here too what the maps of moving cables share: their line, and the check that rows of a chain are met.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np

from solvers import Environment, Scene, Span, Status, cable_system, solve_span, solve_static

from ..cable.cases import scene
from .maps import Axis, Found, Map

ROWS = 1e-8
"""Largest row of a result over the sum of the sizes of its terms: the tolerance is of the step, 1e-11 of each field."""
PLACES = 1e-9
"""Largest miss of the fairlead by the integral of the strained tangent, over the chord."""
SAFETY = 3.0
"""Errors may exceed the second-order estimate from other meshes so many times: where the line leaves the seabed within
a cell moves the error of a mesh by its own size."""
FLOOR = 1e-8  # of the tension: rounding, which a mesh of 2000 cells shows

NODES = Axis("nodes", (3, 5, 10, 20, 50, 100, 300, 1000, 2000))
RESTING_NODES = Axis("nodes", (3, 5, 10, 20, 50, 100, 300, 2000))
CURRENT = Axis("current, m/s", (0.0, 0.1, 0.3, 1.0, 2.0, 3.0, 5.0))
SEABED = Axis("seabed stiffness, N/m²", (0.0, 1.0, 100.0, 1e3, 1e4, 1e5, 1e7, 1e9))
DIRECTION = (0.8, 0.6, 0.0)  # of the current: not in the plane of the line
DEPTH = 320.0  # m
SHOT, SHOT_TO = 50, 1e5
"""Nodes of the shooting, and the seabed stiffness up to which it is the truth. Beyond, the boundary layer at the
touchdown is shorter than any shot, and the truth is the catenary on a rigid seabed lower by w/2k: to first order in w/k
the two lines have the same energy, w^2/2k a metre at rest. The two truths agree to 2e-7 where they meet."""


@cache
def line() -> Scene:
    """The OC3 line of the HB paper, at rest in still water without seabed."""
    return replace(scene("case_1"), motion=None)


def defect(rows, y, ydot) -> float:
    """Largest |F| over the sum of |dF/dy| |y| + |dF/dydot| |ydot|, of cell rows; one instant or many.

    That is the relative change of y and ydot that makes the rows zero; with other sizes in place of y and ydot, the
    change in units of these.
    """
    size = sum(
        np.einsum("ij...,j...->i...", abs(J[side]), abs(field)[:, at])
        for J, field in ((rows.dy, y), (rows.dydot, ydot))
        for side, at in enumerate((slice(None, -1), slice(1, None)))
    )
    return float((abs(rows.value) / np.maximum(size, np.finfo(float).tiny)).max())


def maps() -> list[Map]:
    """Current and seabed."""
    claim = (
        f"rows met to {ROWS:g} of their terms, the fairlead to {PLACES:g} of the chord, and the error within "
        f"{SAFETY:g} times what two other meshes let expect"
    )
    text = "relative error of the fairlead tension"
    return [
        Map("statics_current", "statics", "Current by nodes", NODES, CURRENT, text, claim,
            lambda nodes, current: _solve(nodes, *_shot_of(flowing(current)))),
        Map("statics_seabed", "statics", "Seabed stiffness by nodes", RESTING_NODES, SEABED, text, claim,
            lambda nodes, stiffness: _solve(nodes, _in(resting(stiffness)), _rested(stiffness)),
            "A stiff seabed is raised in steps from one that the mesh resolves; where the support changes from none "
            "to all within a small part of a cell, Newton's method jumps between the two.",
            ((3, 10, 100), (0.0, 100.0, 1e4))),
    ]  # fmt: skip


def flowing(speed) -> Environment:
    """Water with a current of so many m/s."""
    return Environment(current=tuple(speed * c for c in DIRECTION))


def resting(stiffness) -> Environment:
    """Water over a seabed of so many N/m^2."""
    return Environment(depth=DEPTH, seabed_stiffness=stiffness)


def _in(environment) -> Scene:
    return replace(line(), environment=environment)


def _shot_of(environment) -> tuple[Scene, float]:
    return _in(environment), _shot(_in(environment))


@cache
def _shot(at) -> float:
    """Fairlead tension by shooting, N."""
    return float(solve_static(cable_system(at, SHOT), method="shooting").tension[-1])


def _rested(stiffness) -> float:
    if stiffness <= SHOT_TO:
        return _shot(_in(resting(stiffness)))
    at, weight = line(), line().cable.submerged_weight
    reach = math.dist(at.anchor[:2], at.fairlead[:2])
    rise = at.fairlead[2] - at.anchor[2] + weight / (2 * stiffness)
    return solve_span(Span(weight, at.cable.EA, at.length, reach, rise)).tension


def _estimate(at, nodes, tension) -> float:
    """Error by the second order, N: the largest from coarser meshes, or from finer ones where there are none."""
    cells, shares = nodes - 1, (2, 3) if nodes < 10 else (0.5, 0.4, 0.3)
    others = [solve_static(cable_system(at, round(share * cells) + 1), throw=False) for share in shares]
    return max(
        abs(tension - other.tension[-1]) / abs(1 - (cells / (other.system.nodes - 1)) ** 2)
        for other in others
        if other.success
    )


def _solve(nodes, at, truth) -> Found:
    system = cable_system(at, nodes)
    state = solve_static(system, throw=False)
    if state.status is not Status.SUCCESS:
        return Found(state.status)
    tension, estimate = state.tension[-1], SAFETY * _estimate(at, nodes, state.tension[-1]) / truth
    error = abs(tension - truth) / truth
    still = np.zeros_like(state.y)
    rows = defect(system.cells(state.y, still, 0.0), state.y, still)
    miss = math.dist(system.positions(state.y)[:, -1], at.fairlead) / np.linalg.norm(system.chord)
    lost = [
        f"{name} {value:.3g} above {bound:.3g}"
        for name, value, bound in (("rows", rows, ROWS), ("place", miss, PLACES), ("error", error, estimate + FLOOR))
        if value > bound
    ]
    return Found(state.status, error, lost, values={"rows": rows, "place": miss, "estimate": estimate})
