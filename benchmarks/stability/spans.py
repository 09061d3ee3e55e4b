"""Stability maps of single lines at rest against 50 digits, and the same grids on the other codes."""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from solvers import Span, Status, solve_span
from verification.cases.spans import OC3, SpanCase
from verification.reference import force_error

from ..run import harness
from .maps import Axis, Found, Map

CLAIM = harness.EXCUSED
QUANTITY = "error of the fairlead force in condition limits (what rounding the inputs alone causes)"
CLAIMED = f"the fairlead force is within {CLAIM:g} condition limits of 50 digits"

SLACKNESS = Axis("L / chord", (0.5, 0.8, 0.95, 0.999, 1 - 1e-6, 1.0, 1 + 1e-6, 1.001, 1.05, 1.5, 3.0, 10.0))
TOUCHING = Axis("L / chord", (0.99, 1.0, 1.01, 1.02, 1.04, 1.08, 1.16, 1.3))
STIFFNESS = Axis("EA / wL", tuple((10.0 ** np.arange(13)).tolist()))
FRICTION = Axis("friction", (0.0, 1e-3, 1e-2, 0.1, 1.0, 10.0, 100.0, 1e3))
DEPTH = Axis("depth, m", (1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1e3, 3e3, 1e4))
DIAMETER = Axis("diameter, m", (1e-3, 3e-3, 1e-2, 0.03, 0.1, 0.3, 1.0))

STEEL_E, STEEL_RHO, WATER_RHO, GRAVITY = 2.0e11, 7850.0, 1025.0, 9.80665
WEIGHT, CHORD_ENDS = OC3["w"], {"x": 864.0, "z": 252.0}  # m: a chord of 900 exactly


def stretched(stiffness, slackness) -> SpanCase:
    """Slackness against stiffness on a smooth seabed."""
    L = slackness * 900.0
    return SpanCase(f"EA/wL {stiffness:g}, L/chord {slackness!r}", "", WEIGHT, stiffness * WEIGHT * L, L, **CHORD_ENDS)


def rubbed(friction, slackness) -> SpanCase:
    """Friction against slackness, the stiffness that of the OC3 line."""
    L = slackness * 900.0
    name = f"friction {friction:g}, L/chord {slackness!r}"
    return SpanCase(name, "", WEIGHT, OC3["EA"], L, **CHORD_ENDS, friction=friction)


def sized(depth, diameter) -> SpanCase:
    """A solid steel line, anchored two depths away, 2 % longer than its chord."""
    area = math.pi * diameter**2 / 4
    L = 1.02 * math.hypot(2.0, 1.0) * depth
    w = (STEEL_RHO - WATER_RHO) * area * GRAVITY
    return SpanCase(f"depth {depth:g} m, diameter {diameter:g} m", "", w, STEEL_E * area, L, 2 * depth, depth)


GRIDS = {
    "stiffness": ("Stiffness by slackness", STIFFNESS, SLACKNESS, stretched),
    "friction": ("Seabed friction by slackness", FRICTION, TOUCHING, rubbed),
    "size": ("From 1 m to 10 km, from 1 mm to 1 m", DEPTH, DIAMETER, sized),
}
"""Name -> title, axes, case of a point."""


def maps(known) -> list[Map]:
    """The three maps; ``known`` is a truth.TruthCache."""
    return [
        Map(
            *(f"spans_{name}", "span", title, x, y, QUANTITY, CLAIMED, partial(_solve, known, case)),
        )
        for name, (title, x, y, case) in GRIDS.items()
    ]


def _solve(known, make, x, y) -> Found:
    case = make(x, y)
    state = solve_span(Span(**case.inputs()), throw=False)
    if state.status is not Status.SUCCESS:
        return Found(state.status)
    truth = known.get_or_compute(case)
    error = force_error(state.H, state.V, truth, case) / truth.limit
    numbers = [state.H, state.V, state.H_anchor, state.V_anchor, state.grounded_length]
    lost = [f"error of {error:.3g} condition limits"] if not error <= CLAIM else []
    lost += ["a force that is not finite"] if not np.isfinite(numbers).all() else []
    return Found(state.status, error, lost, values={"regime": state.regime.name})
