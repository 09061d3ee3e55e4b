"""The claims of speed, this project and the peers side by side in one run: speed.json.

One cold solve of the OC3 line, turn and turn about; many mixed lines in one call.
"""

from __future__ import annotations

import gc
import os
import time
import tracemalloc

import numpy as np

from solvers import Span, solve_span, solve_spans
from verification.cases.spans import NAMED, random_arrays
from verification.registry import SpanAnswer

from ..run import console, harness, results
from ..run import oracle_cache as truth

COLD_CASE = "oc3-friction-0.001"
WITHOUT_FRICTION = "oc3-friction-0"
"""The same line for peers that have no seabed friction."""

TURNS = 200  # of each solver, in an order drawn anew each time: a busy machine interrupts none of them regularly
TURN = 1e-3  # s: length of a turn, far above the clock's resolution, below the time slices of a busy machine
SPREAD = (5, 95)  # percentiles of the ratios: their extremes are single interruptions
ENOUGH = 10.0  # s of its calls, one a turn, after which a solver takes no more turns
PROBES = 5  # calls, the shortest of which tells how many make a turn
SEED = 2026
SIZES = (100_000, 1_000_000)  # lines
BATCH_TURNS = 4  # of each size, the smaller one repeated until it has solved as many lines


def our_cold_solve(case, tolerance=None) -> SpanAnswer:
    """What a user does for one line: check the input, solve. No guess, nothing kept from an earlier call."""
    state = solve_span(Span(case.w, case.EA, case.L, case.x, case.z, case.seabed, case.friction, case.clearance))
    return SpanAnswer(state.H, state.V, state.iterations)


def contestants(cases, known) -> tuple[dict, dict]:
    """Name -> (solver, case), and name -> verdict: every solver that answers the OC3 line, or it without friction."""
    solvers = harness.solvers()
    solvers["catenary"] = harness.Solver("catenary", "this project", "", our_cold_solve)
    chosen, judged = {}, {}
    for name, solver in solvers.items():
        for case in (cases[COLD_CASE], cases[WITHOUT_FRICTION]):
            verdict = harness.assess(solver, case, known.get_or_compute(case))
            if verdict["verdict"] in ("right", "wrong"):
                chosen[name], judged[name] = (solver, case), verdict | {"case": case.name, "label": solver.label}
            if verdict["verdict"] != "unsupported":
                break
    return chosen, judged


def cold(known: truth.TruthCache):
    """Yield once a turn; the last value is the part "cold_oc3" of the file."""
    cases = {case.name: case for case in NAMED}
    chosen, judged = contestants(cases, known)
    counts = {name: _count(solver.solve, case) for name, (solver, case) in chosen.items()}
    times = {name: [] for name in chosen}
    rng = np.random.default_rng(SEED)
    for _ in range(TURNS):
        for name in rng.permutation([name for name in chosen if sum(times[name]) < ENOUGH]).tolist():
            solver, case = chosen[name]
            times[name].append(_turn(solver.solve, case, counts[name]))
        yield None
    yield _cold_report(times, judged)


def _count(solve, case) -> int:
    """Calls in a turn."""
    return max(1, round(TURN / min(_turn(solve, case, 1) for _ in range(PROBES))))


def _turn(solve, case, count: int) -> float:
    """Seconds a call."""
    with harness.quiet():
        start = time.perf_counter()
        for _ in range(count):
            solve(case)
        return (time.perf_counter() - start) / count


def _cold_report(times, judged) -> dict:
    report = {"turns": TURNS, "case": COLD_CASE, "solvers": {name: one["label"] for name, one in judged.items()}}
    for name, one in judged.items():
        report[f"{name}_us"] = 1e6 * min(times[name])
        report[f"error_{name}"], report[f"case_{name}"] = one["error"], one["case"]
        if name != "catenary":
            ratios = np.divide(times[name], times["catenary"][: len(times[name])])
            report[f"ratio_{name}"] = float(np.median(ratios))
            report[f"ratio_spread_{name}"] = np.percentile(ratios, SPREAD)
    return report


def batch():
    """Yield once a turn; the last value is the part "batch" of the file.

    The growth compares the best of stretches that last equally long, one run of the larger size with as many runs of
    the smaller as solve as many lines: a busy machine lets a short run through undisturbed more often than a long one.
    """
    few, many = SIZES
    lines = {n: random_arrays(n) for n in SIZES}
    times, failed = {n: [] for n in SIZES}, 0
    solve_spans(**lines[few])  # warm-up
    for _ in range(BATCH_TURNS):
        for n in SIZES:
            runs = [_timed_batch(lines[n]) for _ in range(many // n)]
            times[n].append([seconds for seconds, _ in runs])
            failed = max(failed, *(failures for _, failures in runs))
        yield None
    least = {n: float(np.min(times[n])) for n in SIZES}
    stretch = {n: float(np.min(np.sum(times[n], axis=1))) for n in SIZES}
    yield {
        "us_per_line_1e5": 1e6 * least[few] / few,
        "us_per_line_1e6": 1e6 * least[many] / many,
        "seconds_1e5": least[few],
        "seconds_1e6": least[many],
        "growth": many / few * stretch[many] / stretch[few],
        "peak_MB_1e6": _peak(lines[many]) / 1e6,
        "failed_rows": failed,
    }


def _timed_batch(lines) -> tuple[float, int]:
    """Seconds of one call, and how many rows failed."""
    start = time.perf_counter()
    batch = solve_spans(**lines)
    return time.perf_counter() - start, int(np.count_nonzero(~batch.success))


def _peak(lines) -> int:
    """Most bytes held at one time by the call, its results included and its inputs not."""
    tracemalloc.start()
    try:
        solve_spans(**lines)
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def measured(out) -> dict:
    """The file."""
    parts = {"cold_oc3": cold(truth.TruthCache(out)), "batch": batch()}
    total = TURNS + 1 + BATCH_TURNS + 1
    file = {"load_before": list(os.getloadavg()) if hasattr(os, "getloadavg") else None}

    def steps():
        for name, part in parts.items():
            for value in part:
                file[name] = value
                yield

    gc.disable()  # as timeit does: a collection in one solver's turn is not its doing
    try:
        for _ in console.progress(steps(), total, "speed"):
            pass
    finally:
        gc.enable()
    return file


def main(argv=None) -> int:
    """Command line."""
    arguments = console.parser("speed", __doc__).parse_args(argv)
    file = measured(arguments.out)
    results.write(arguments.out / "speed.json", file)
    for part in ("cold_oc3", "batch"):
        values = file[part]
        print(part, *(f"{key} {value:.4g}" for key, value in values.items() if isinstance(value, (int, float))))
    return 0


if __name__ == "__main__":
    console.run(main)
