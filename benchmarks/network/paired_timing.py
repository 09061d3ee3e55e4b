"""Two solvers of a network turn and turn about in one run: methods of this project (speed), and MoorPy (peers).

Times are CPU times, and what is quoted is the median of their ratio: load of the machine falls on both alike.
"""

from __future__ import annotations

import importlib.util
from collections.abc import Callable
from functools import partial

import numpy as np

from solvers import solve_network
from verification.registry import PROBLEMS

from ..run import harness
from .systems import WEIGHTS, chain, cpu_seconds, scene, two_lines, without_friction
from .table2 import STARTS

SPREAD = (5, 95)  # percentiles of the ratios: their extremes are single interruptions
BUDGET = 1.0  # s for all turns of one comparison of methods, between the bounds of TURNS
TURNS, QUICK_TURNS = (3, 15), (3, 7)

SIZES, QUICK_SIZES = (2, 5, 10, 20, 40), (2, 5, 10)  # elements of a chain
END_MOVES = 8.0  # m, 1 % of the chain's span

PEER_TURNS, QUICK_PEER_TURNS = 12, 5  # each way
OFFSET = 1.0  # m: of the vessel in surge, before a warm re-solve


def turns(calls: dict[str, Callable], count: int) -> dict:
    """Name -> seconds (count,): one call of each a turn, in an order drawn anew each time, after a warm-up."""
    rng, times = np.random.default_rng(2026), {name: [] for name in calls}
    with harness.quiet():
        for call in calls.values():
            call()
        for _ in range(count):
            for name in rng.permutation(list(calls)).tolist():
                times[name].append(cpu_seconds(calls[name]))
    return times


def against(times, name: str, base: str) -> dict:
    """Median and spread of the ratio of times."""
    ratios = np.divide(times[name], times[base])
    return {"ratio": float(np.median(ratios)), "ratio_spread": np.percentile(ratios, SPREAD)}


# ---------------------------------------------------------------- monolithic analytic, nested with differences
_SOLVERS = PROBLEMS["network"].solvers
METHODS = {
    "monolithic": _SOLVERS["monolithic-line-search"],
    "nested_differences": _SOLVERS["nested-differences"],
}


def speed(quick: bool) -> list:
    """Calls, each giving rows of the part "speed"."""
    lines = [partial(two_lines_row, w, quick) for w in WEIGHTS]
    return lines + [partial(chain_row, n, quick) for n in (QUICK_SIZES if quick else SIZES)]


def two_lines_row(w: float, quick: bool) -> list[dict]:
    """From the sound start of Table 2."""
    network = two_lines(w)
    start = (np.array([node.r for node in network.nodes]), *map(np.array, STARTS["sound"]))
    return [{"system": f"two lines, {w} N/m"} | compared(network, start, quick)]


def chain_row(n: int, quick: bool) -> list[dict]:
    """From the state before the end moved."""
    network = chain(n)
    before = solve_network(network)
    after = network.moved(before.r[before.coupled] + [END_MOVES, 0.0, 0.0])
    return [{"system": f"chain of {n}, end moved by 1 %"} | compared(after, before, quick)]


def compared(network, start, quick: bool) -> dict:
    """Both methods on one network, without fallback."""

    def call(name):
        return METHODS[name](network, start=start, fallback=False, throw=False)

    calls = {name: partial(call, name) for name in METHODS}
    slow = cpu_seconds(calls["nested_differences"])
    times = turns(calls, int(np.clip(BUDGET / slow, *(QUICK_TURNS if quick else TURNS))))
    row = {"elements": len(network.elements), "turns": len(times["monolithic"])}
    for name in METHODS:
        state = call(name)
        row |= {
            f"{name}_seconds": min(times[name]),
            f"{name}_iterations": state.iterations,
            f"{name}_evaluations": state.function_evaluations,
            f"{name}_residual_norm": state.residual_norm,
            f"{name}_status": state.status.name,
        }
    return row | against(times, "nested_differences", "monolithic")


# ---------------------------------------------------------------- MoorPy
SYSTEMS = ("oc3_three_lines", "three_bridles")


def peers(quick: bool) -> list:
    """Calls, each giving rows of the part "peers": warm re-solves after an offset; none where MoorPy is missing."""
    if importlib.util.find_spec("moorpy") is None:
        return []
    return [partial(peer_rows, name, setting, quick) for name in SYSTEMS for setting in ("default", "tight")]


def peer_rows(name: str, setting: str, quick: bool) -> list[dict]:
    """One system and one tolerance of MoorPy."""
    from ..peers import moorpy_networks as moorpy

    tolerance = {"default": moorpy.DEFAULT, "tight": moorpy.TIGHT}[setting]
    row = {"system": name, "peer": "moorpy", "setting": setting, "tolerance": tolerance}
    count = QUICK_PEER_TURNS if quick else PEER_TURNS
    return [row | warm(without_friction(scene(name)), moorpy, tolerance, count)]


def warm(network, moorpy, tolerance: float, count: int) -> dict:
    """The vessel goes out by OFFSET and back, each solver from its own last state; figures of the way out."""
    home = np.array([node.r for node in network.nodes if node.kind == "coupled"])
    places = (home + [OFFSET, 0.0, 0.0], home)
    with harness.quiet():
        system, state = moorpy.build(network), solve_network(network)
        moorpy.solve(system, tolerance)
    mine, theirs = {"state": state, "next": 0}, {"next": 0}

    def ours():
        mine["state"] = solve_network(network.moved(places[mine["next"]]), start=mine["state"])
        mine["next"] = 1 - mine["next"]

    def peer():
        moorpy.place(system, places[theirs["next"]])
        moorpy.solve(system, tolerance)
        theirs["next"] = 1 - theirs["next"]

    times = turns({"ours": ours, "peer": peer}, 2 * count)
    out = {name: values[1::2] for name, values in times.items()}  # after the warm-up the first turn leads back
    back = {name: values[0::2] for name, values in times.items()}
    state = mine["state"]
    tension = np.column_stack([np.hypot(state.H_anchor, state.V_anchor), np.hypot(state.H, state.V)])
    return {
        "elements": len(network.elements),
        "our_seconds": min(out["ours"]),
        "peer_seconds": min(out["peer"]),
        "ratio_back": against(back, "peer", "ours")["ratio"],
        "our_residual_norm": state.residual_norm,
        "peer_residual_norm": moorpy.unbalanced(system) / tension.max(),
        "peer_tension_difference": abs(moorpy.tensions(system) / tension - 1).max(),
        "our_iterations": state.iterations,
    } | against(out, "peer", "ours")
