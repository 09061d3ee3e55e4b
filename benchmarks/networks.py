"""Networks: pictures, the paper's Table 2 remade, error against time, speed, growth, MoorPy beside: networks.json.

Table 2 is that of MSQS, section 5: two lines and a buoyant joint, both weights, counts of each method by itself (no
fallback). Speed and peers are measured turn and turn about in one run and quoted as ratios.
"""

from __future__ import annotations

import gc
import importlib.util
import time
from collections.abc import Callable

import numpy as np

from solvers import solve_network
from solvers.network_balance import Balance
from solvers.network_jacobian import analytic_jacobian
from solvers.network_monolithic import Monolith
from solvers.network_nested import Count

from . import console, harness, network_accuracy, network_memory, network_pictures, results
from .network_systems import FAMILIES, WEIGHTS, chain, scene, two_lines, without_friction

EXACT_H = {59.1: 137765.51942683, 226.61: 162586.27222711}
"""N: horizontal force of both lines, 40-digit solution rounded; without friction."""

STARTS = {
    "printed": ([168.7e3, 1.4e3], [752.7e3, 168.1e3]),
    "sound": ([168.69e3, 0.125e3], [75.26e3, 16.81e3]),
}
"""(H, V) (2,) in N: (5.1) as printed, and the values of the guess formula that it came from; both with JOINT_GUESS."""

UNITS = ("N", "kN", "scaled")

SPEED_TURNS = 15
SPEED_SIZES = (2, 5, 10, 20, 40)  # elements of a chain
PEER_TURNS = 12  # each way
SPREAD = (5, 95)  # percentiles of the ratios: their extremes are single interruptions

FITTED_FROM = 1000  # elements: below, a solve is mostly overhead that does not grow
LONG = 1.0  # s: solves that last longer are timed once
OFFSET = 1.0  # m: of the vessel in surge, before a warm re-solve


# ---------------------------------------------------------------- Table 2
PRINTED = (
    {"method": "nested", "iterations": 24, "inner_iterations": 90, "operations": 4272, "residual_norm": 2.74e-7},
    *(
        {
            "method": "monolithic",
            "jacobian": j,
            "globalisation": g,
            "iterations": 7,
            "operations": 1600,
            "residual_norm": r,
        }
        for j, g, r in (
            ("finite-difference", "trust-region", 2.04e-5),
            ("analytic", "trust-region", 2.04e-5),
            ("finite-difference", "line-search", 2.08e-9),
            ("analytic", "line-search", 2.10e-9),
        )
    ),
)
"""The paper's Table 2, beside which the measured rows stand; its norms have units that it does not name."""


def methods():
    """Options of solve_network, one dict a row of the table."""
    for jacobian in ("finite-difference", "analytic"):
        yield {"method": "nested", "jacobian": jacobian, "globalisation": "line-search", "units": "scaled"}
    for jacobian in ("finite-difference", "analytic"):
        for globalisation in ("trust-region", "line-search"):
            for units in UNITS:
                yield {
                    "method": "monolithic",
                    "jacobian": jacobian,
                    "globalisation": globalisation,
                    "units": units,
                }


def table2():
    """Yield once a row; the last value is the part "table2" of the file."""
    rows = []
    for w in WEIGHTS:
        network = two_lines(w)
        condition = condition_numbers(network)
        for start, forces in (*STARTS.items(), ("none", None)):
            for options in methods():
                rows.append(table_row(w, network, start, forces, options, condition))
                yield None
    yield rows


def table_row(w, network, start, forces, options, condition) -> dict:
    """One method from one start."""
    given = None if forces is None else (np.array([node.r for node in network.nodes]), *map(np.array, forces))

    def solve():
        return solve_network(network, **options, start=given, fallback=False, throw=False)

    with harness.quiet():
        state = solve()
    return {
        "weight": w,
        "start": start,
        **options,
        "units": options["units"] if options["method"] == "monolithic" else None,
        "globalisation": options["globalisation"] if options["method"] == "monolithic" else None,
        "iterations": state.iterations,
        "inner_iterations": state.inner_iterations if options["method"] == "nested" else None,
        "function_evaluations": state.function_evaluations,
        "operations": state.operations,
        "residual_norm": state.residual_norm,
        "error": abs(state.H / EXACT_H[w] - 1).max(),
        "seconds": harness.seconds_per_call(solve),
        "status": state.status.name,
        "condition_number": condition[options["units"]] if options["method"] == "monolithic" else None,
    }


def condition_numbers(network) -> dict:
    """Of the analytic monolithic Jacobian at the solution, by units."""
    state, found = solve_network(network), {}
    for units in UNITS:
        iterate = Monolith(Balance(network), units, Count()).at(state.r, state.H, state.V)
        found[units] = float(np.linalg.cond(analytic_jacobian(iterate)))
    return found


# ---------------------------------------------------------------- speed, turn and turn about
def turns(calls: dict[str, Callable], count: int):
    """Name -> seconds (count,): one call of each a turn, in an order drawn anew each time."""
    rng, times = np.random.default_rng(2026), {name: [] for name in calls}
    with harness.quiet():
        for call in calls.values():
            call()  # warm-up
        for _ in range(count):
            for name in rng.permutation(list(calls)).tolist():
                times[name].append(harness.clock(calls[name], 1))
    return times


def against(times, name: str, base: str) -> dict:
    """Median and spread of the ratio of times."""
    ratios = np.divide(times[name], times[base])
    return {"ratio": float(np.median(ratios)), "ratio_spread": np.percentile(ratios, SPREAD)}


FAST = {"method": "monolithic", "jacobian": "analytic"}
CONVENTIONAL = {"method": "nested", "jacobian": "finite-difference"}


def speed():
    """Yield once a system; the last value is the part "speed": monolithic analytic and nested with differences."""
    rows = []
    for w in WEIGHTS:
        network = two_lines(w)
        start = (np.array([node.r for node in network.nodes]), *map(np.array, STARTS["sound"]))
        rows.append({"system": f"two lines, {w} N/m"} | compared(network, start))
        yield None
    for n in SPEED_SIZES:
        network = chain(n)
        before = solve_network(network)
        after = network.moved(before.r[before.coupled] + [8.0, 0.0, 0.0])
        rows.append({"system": f"chain of {n}, end moved by 1 %"} | compared(after, before))
        yield None
    yield rows


def compared(network, start) -> dict:
    """Both methods on one network, without fallback."""
    shared = {"start": start, "fallback": False, "throw": False}
    calls = {
        name: lambda options=options: solve_network(network, **options, **shared)
        for name, options in (("monolithic", FAST), ("nested_differences", CONVENTIONAL))
    }
    times = turns(calls, SPEED_TURNS)
    row = {"elements": len(network.elements)}
    for name, call in calls.items():
        state = call()
        row |= {
            f"{name}_seconds": min(times[name]),
            f"{name}_iterations": state.iterations,
            f"{name}_evaluations": state.function_evaluations,
            f"{name}_residual_norm": state.residual_norm,
            f"{name}_status": state.status.name,
        }
    return row | against(times, "nested_differences", "monolithic")


# ---------------------------------------------------------------- growth
SIZES = (10, 30, 100, 300, 1000, 3000, 10000)


def growth():
    """Yield once a solve; the last value is the part "growth": rows, and the exponent fitted for each family."""
    rows = []
    for family, make in FAMILIES.items():
        for size in SIZES:
            network = make(size)
            start = time.perf_counter()
            state = solve_network(network, throw=False)
            seconds = time.perf_counter() - start
            if seconds < LONG:
                again = [harness.clock(lambda n=network: solve_network(n, throw=False), 1) for _ in range(2)]
                seconds = min(seconds, *again)
            rows.append(
                {
                    "family": family,
                    "elements": len(network.elements),
                    "seconds": seconds,
                    "iterations": state.iterations,
                    "residual_norm": state.residual_norm,
                    "status": state.status.name,
                    "memory": network_memory.in_its_own_process(family, size) if size == SIZES[-1] else None,
                }
            )
            yield None
    yield {
        "rows": rows,
        "fitted_from": FITTED_FROM,
        "exponents": {family: exponent(rows, family) for family in FAMILIES},
    }


def exponent(rows, family: str) -> float:
    """p of seconds = C elements^p, least squares in logarithms, over the solved networks from FITTED_FROM on."""
    n, t = np.array(
        [
            (row["elements"], row["seconds"])
            for row in rows
            if row["family"] == family and row["elements"] >= FITTED_FROM and row["status"] == "SUCCESS"
        ]
    ).T
    return float(np.polyfit(np.log(n), np.log(t), 1)[0])


# ---------------------------------------------------------------- MoorPy
def systems() -> dict:
    """The systems compared."""
    return {name: without_friction(scene(name)) for name in ("oc3_three_lines", "three_bridles")}


def peers():
    """Yield once a system and tolerance; the last value is the part "peers": warm re-solves after an offset."""
    if importlib.util.find_spec("moorpy") is None:
        yield []
        return
    from .peers import moorpy_networks as moorpy

    rows = []
    for name, network in systems().items():
        for label, tolerance in (("default", moorpy.DEFAULT), ("tight", moorpy.TIGHT)):
            rows.append({"system": name, "peer": "moorpy", "setting": label, "tolerance": tolerance})
            rows[-1] |= warm(network, moorpy, tolerance)
            yield None
    yield rows


def warm(network, moorpy, tolerance: float) -> dict:
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

    times = turns({"ours": ours, "peer": peer}, 2 * PEER_TURNS)
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


# ---------------------------------------------------------------- the file
PARTS = {
    "pictures": network_pictures.pictures,
    "table2": table2,
    "work": network_accuracy.work,
    "speed": speed,
    "growth": growth,
    "peers": peers,
}
STEPS = {
    "pictures": len(network_pictures.PICTURES) + 1,
    "work": network_accuracy.STEPS,
    "table2": len(WEIGHTS) * (len(STARTS) + 1) * len(list(methods())) + 1,
    "speed": len(WEIGHTS) + len(SPEED_SIZES) + 1,
    "growth": len(FAMILIES) * len(SIZES) + 1,
    "peers": 5,
}


def measured(parts) -> dict:
    """The file, or the named parts of it."""
    file = {"printed": PRINTED}

    def steps():
        for name in parts:
            for value in PARTS[name]():
                file[name] = value
                yield

    gc.disable()  # as timeit does: a collection in one solver's turn is not its doing
    try:
        for _ in console.progress(steps(), sum(STEPS[name] for name in parts), "networks"):
            pass
    finally:
        gc.enable()
    return file


def main(argv=None) -> int:
    """Command line."""
    parser = console.parser("networks", __doc__)
    parser.add_argument("--parts", nargs="+", choices=PARTS, default=list(PARTS), help="measure only these")
    arguments = parser.parse_args(argv)
    file = measured(arguments.parts)
    results.write(arguments.out / "networks.json", file)
    for name in ("speed", "peers"):
        for row in file.get(name, ()):
            print(f"{row['system']}{' ' + row['setting'] if 'setting' in row else ''}: ratio {row['ratio']:.4g}")
    for family, p in file.get("growth", {"exponents": {}})["exponents"].items():
        print(f"growth of {family}: elements^{p:.3g}")
    return 0


if __name__ == "__main__":
    console.run(main)
