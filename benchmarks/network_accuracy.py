"""Error against run time of the methods for networks, a sweep of tolerances: the part "work" of networks.json.

Every method starts from the node positions of the network and does without fallback; the error is that of the end
tensions, against 40 digits. MoorPy, where it is installed, takes its tolerance in m: the same ladder times the longest
line, as for single lines. Its system is built anew before each solve, outside the clock.
"""

from __future__ import annotations

import importlib.util
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from solvers import solve_network
from verification.reference import WRONG, exact_network, tension_error

from . import harness
from .network_systems import WEIGHTS, scene, two_lines, without_friction

TOLERANCES = tuple(10.0**-k for k in range(1, 13))
"""Relative: of the residual norm, and times the longest line for a peer; the smallest that doubles can carry there."""

REPEATS = 5  # of a peer, whose system is built anew for each


@dataclass(frozen=True)
class Method:
    """name and label in figures; options of solve_network."""

    name: str
    label: str
    options: dict


METHODS = (
    Method("monolithic-line-search", "monolithic, line search", {}),
    Method("monolithic-trust-region", "monolithic, trust region", {"globalisation": "trust-region"}),
    Method("monolithic-differences", "monolithic, differences", {"jacobian": "finite-difference"}),
    Method("nested-analytic", "nested, analytic", {"method": "nested"}),
    Method("nested-differences", "nested, differences", {"method": "nested", "jacobian": "finite-difference"}),
)
PEER = Method("moorpy", "MoorPy", {})


def systems() -> dict:
    """Title -> network, on a smooth seabed."""
    lines = {f"two lines, {w} N/m": two_lines(w) for w in WEIGHTS}
    return lines | {"three lines with bridles": without_friction(scene("three_bridles"))}


def work():
    """Yield once a system and method; the last value is the part "work" of the file."""
    peer = importlib.util.find_spec("moorpy") is not None
    rows = []
    for title, network in systems().items():
        truth = exact_network(network, solve_network(network).r)
        for method in METHODS:
            rows += [
                point(title, method, tolerance, *ours(network, method, tolerance), truth) for tolerance in TOLERANCES
            ]
            yield None
        if peer:
            rows += [point(title, PEER, t, *moorpy(network, t), truth) for t in TOLERANCES]
        yield None
    yield rows


STEPS = 3 * (len(METHODS) + 1) + 1
"""Values that ``work`` yields."""


def ours(network, method: Method, tolerance: float) -> tuple:
    """(end tensions (e, 2) or None where it did not converge, message, call to be timed)."""

    def solve():
        return solve_network(network, **method.options, tolerance=tolerance, start="nodes", fallback=False, throw=False)

    with harness.quiet():
        state = solve()
    tension = np.column_stack([np.hypot(state.H_anchor, state.V_anchor), np.hypot(state.H, state.V)])
    seconds: Callable[[], float] = lambda: harness.seconds_per_call(solve)
    return (tension, "", seconds) if state.success else (None, state.status.value, seconds)


def moorpy(network, tolerance: float) -> tuple:
    """The same of MoorPy."""
    from .peers import moorpy_networks as adapter

    metres = tolerance * max(element.L for element in network.elements)

    def once() -> tuple:
        system = adapter.build(network)
        return harness.clock(lambda: adapter.solve(system, metres), 1), adapter.tensions(system)

    def seconds() -> float:
        with harness.quiet():
            return min(once()[0] for _ in range(REPEATS))

    try:
        with harness.quiet():
            tension = once()[1]
    except Exception as error:  # whatever it raises is its way of refusing
        return None, f"{type(error).__name__}: {error}", seconds
    return (tension, "", seconds) if np.isfinite(tension).all() else (None, "tensions that are not finite", seconds)


def point(title: str, method: Method, tolerance: float, tension, message: str, seconds, truth) -> dict:
    """A row of the file; without error and seconds where there is no answer."""
    row = {"solver": method.name, "label": method.label, "case": title, "tolerance": tolerance}
    if tension is None:
        return row | {"verdict": "refused", "message": message[:200], "error": None, "seconds": None}
    error = tension_error(tension, truth)
    return row | {"verdict": "wrong" if error > WRONG else "right", "error": error, "seconds": seconds()}
