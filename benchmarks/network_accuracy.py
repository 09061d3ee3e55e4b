"""Error against run time of the methods for networks, a sweep of tolerances: the part "work" of networks.json.

Every method starts from the node positions of the network and does without fallback; the error is that of the end
tensions, against 40 digits. MoorPy, where it is installed, takes its tolerance in m: the same ladder times the longest
line, as for single lines. Its system is built anew before each solve, outside the clock.
"""

from __future__ import annotations

import importlib.util
from dataclasses import dataclass
from functools import cache, partial

import numpy as np

from solvers import solve_network
from verification.reference import WRONG, exact_network, tension_error

from . import harness
from .network_systems import WEIGHTS, cpu_seconds, scene, two_lines, without_friction

TOLERANCES, QUICK_TOLERANCES = (1e-1, 1e-3, 1e-5, 1e-7, 1e-9, 1e-11), (1e-1, 1e-5, 1e-9)
"""Relative: of the residual norm, and times the longest line for a peer; the smallest that doubles can carry there."""

REPEATS = 3
QUICK_FROM = 1  # the quick run leaves out the first system


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


def tasks(quick: bool) -> list:
    """Calls, each giving rows of the part "work": one system and method."""
    methods = [*METHODS, PEER] if importlib.util.find_spec("moorpy") else METHODS
    tolerances = QUICK_TOLERANCES if quick else TOLERANCES
    titles = list(systems())[QUICK_FROM if quick else 0 :]
    return [partial(ladder, title, method, tolerances) for title in titles for method in methods]


@cache
def truth(title: str):
    """40 digits, and the network."""
    network = systems()[title]
    return exact_network(network, solve_network(network).r), network


def ladder(title: str, method: Method, tolerances) -> list[dict]:
    """Points of one method; a tolerance that does not change the answer is not timed again."""
    exact, network = truth(title)
    found, before = [], {"error": None}
    for tolerance in tolerances:
        tension, message, clock = (moorpy if method is PEER else ours)(network, method, tolerance)
        error = None if tension is None else tension_error(tension, exact)
        same = error is not None and error == before["error"]
        with harness.quiet():
            seconds = None if error is None else before["seconds"] if same else min(clock() for _ in range(REPEATS))
        verdict = "refused" if error is None else "wrong" if error > WRONG else "right"
        before = {"solver": method.name, "label": method.label, "case": title, "tolerance": tolerance}
        before |= {"verdict": verdict, "message": message[:200], "error": error, "seconds": seconds}
        found.append(before)
    return found


def ours(network, method: Method, tolerance: float) -> tuple:
    """(end tensions (e, 2) or None where it did not converge, message, call that times one solve, s)."""

    def solve():
        return solve_network(network, **method.options, tolerance=tolerance, start="nodes", fallback=False, throw=False)

    with harness.quiet():
        state = solve()
    tension = np.column_stack([np.hypot(state.H_anchor, state.V_anchor), np.hypot(state.H, state.V)])
    clock = partial(cpu_seconds, solve)
    return (tension, "", clock) if state.success else (None, state.status.value, clock)


def moorpy(network, _, tolerance: float) -> tuple:
    """The same of MoorPy."""
    from .peers import moorpy_networks as adapter

    metres = tolerance * max(element.L for element in network.elements)

    def once() -> tuple:
        system = adapter.build(network)
        return cpu_seconds(lambda: adapter.solve(system, metres)), adapter.tensions(system)

    try:
        with harness.quiet():
            tension = once()[1]
    except Exception as error:  # whatever it raises is its way of refusing
        return None, f"{type(error).__name__}: {error}", None
    clock = lambda: once()[0]
    return (tension, "", clock) if np.isfinite(tension).all() else (None, "tensions that are not finite", clock)
