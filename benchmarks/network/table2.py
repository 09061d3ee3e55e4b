"""Table 2 of MSQS, section 5, remade: two lines and a buoyant joint, counts of each method by itself, no fallback.

Both weights, the printed start and a sound one, and none; the condition number of the Jacobian in N, in kN and scaled.
"""

from __future__ import annotations

from functools import cache, partial

import numpy as np

from solvers import solve_network
from solvers.network.equations import NetworkEquations
from solvers.network.jacobian import DIFFERENCE, analytic_jacobian, difference_jacobian
from solvers.network.monolithic import MonolithicSystem
from solvers.network.nested import Count

from ..run import harness
from .systems import WEIGHTS, cpu_seconds, two_lines

EXACT_H = {59.1: 137765.51942683, 226.61: 162586.27222711}
"""N: horizontal force of both lines, 40-digit solution rounded; without friction."""

STARTS = {
    "printed": ([168.7e3, 1.4e3], [752.7e3, 168.1e3]),
    "sound": ([168.69e3, 0.125e3], [75.26e3, 16.81e3]),
    "none": None,
}
"""(H, V) (2,) in N: (5.1) as printed, and the values of the guess formula that it came from; both with JOINT_GUESS."""

UNITS = ("N", "kN", "scaled")
REPEATS = 5


def methods():
    """Options of solve_network, one dict a row of the table."""
    for jacobian in ("finite-difference", "analytic"):
        yield {"method": "nested", "jacobian": jacobian}
    for jacobian in ("finite-difference", "analytic"):
        for globalisation in ("trust-region", "line-search"):
            for units in UNITS:
                yield {"method": "monolithic", "jacobian": jacobian, "globalisation": globalisation, "units": units}


def tasks(quick: bool) -> list:
    """Calls, each giving rows of the part "table2"; the quick run takes every setting too and times it once."""
    repeats = 1 if quick else REPEATS
    return [partial(rows, w, start, options, repeats) for w in WEIGHTS for start in STARTS for options in methods()]


def rows(w: float, start: str, options: dict, repeats: int) -> list[dict]:
    """One method from one start; timed where it comes to an end from a given start."""
    network, forces = two_lines(w), STARTS[start]
    given = None if forces is None else (np.array([node.r for node in network.nodes]), *map(np.array, forces))

    def solve():
        return solve_network(network, **options, start=given, fallback=False, throw=False)

    with harness.quiet():
        state = solve()
    row = {"weight": w, "start": start, "globalisation": None, "units": None} | options
    return [
        row
        | {
            "iterations": state.iterations,
            "inner_iterations": state.inner_iterations if options["method"] == "nested" else None,
            "function_evaluations": state.function_evaluations,
            "operations": state.operations,
            "residual_norm": state.residual_norm,
            "error": abs(state.H / EXACT_H[w] - 1).max(),
            "seconds": min(cpu_seconds(solve) for _ in range(repeats)) if state.success and forces else None,
            "status": state.status.name,
            "condition_number": condition_number(w, options["units"]) if "units" in options else None,
        }
    ]


@cache
def condition_number(w: float, units: str) -> float:
    """Of the analytic monolithic Jacobian at the solution."""
    network = two_lines(w)
    state = solve_network(network)
    iterate = MonolithicSystem(NetworkEquations(network), units, Count()).evaluate(state.r, state.H, state.V)
    return float(np.linalg.cond(analytic_jacobian(iterate)))


def example_tasks(quick: bool) -> list:
    """Calls, each giving the row of one weight of the part "example": (5.3) to (5.5) remade."""
    return [partial(example, w) for w in WEIGHTS]


def example(w: float) -> list[dict]:
    """The solution of the two lines, forces in N, and the norm (5.3) at the printed start, by units of force."""
    network, forces = two_lines(w), STARTS["printed"]
    state = solve_network(network)
    places = np.array([node.r for node in network.nodes])
    norms = {}
    for units in UNITS:
        start = MonolithicSystem(NetworkEquations(network), units, Count()).evaluate(places, *map(np.array, forces))
        exact = analytic_jacobian(start)
        apart = np.linalg.norm(difference_jacobian(start) - exact, 2)
        norms[units] = {"difference": apart, "relative": apart / np.linalg.norm(exact, 2)}
    return [{"weight": w, "r": state.r[-1], "H": state.H, "V": state.V, "residual_norm": state.residual_norm,
             "relative_step": DIFFERENCE, "jacobian": norms}]  # fmt: skip
