"""Error against run time, every solver at a sweep of tolerances, on named and on mixed lines: work_precision.json.

Each point: a warm-up call, then the minimum of repeated runs, of a batch that of two; the error is against 50 digits.
"""

from __future__ import annotations

import numpy as np

from solvers import solve_spans
from verification.cases.spans import NAMED, SpanCase, random_arrays
from verification.registry import SpanAnswer

from ..run import console, harness, results
from ..run import oracle_cache as truth

TOLERANCES = tuple(10.0**-k for k in range(1, 16))
"""Relative: of this project's residual, and times L where a peer wants a distance in m."""

BATCH_LINES = 100_000  # lines timed in one call
SAMPLE = 30  # of them, one by one, in every solver and in the oracle
BATCH_REPEATS = 2
BATCH_TOLERANCES = TOLERANCES[::2]  # each step of Newton's method doubles the digits


def points(known: truth.TruthCache):
    """Yield the points of the file, a list a step; ``total`` steps in all."""
    for case in NAMED:
        exact = known.get_or_compute(case)
        for solver in harness.solvers().values():
            yield list(sweep(solver, case, exact))
    sample = [(case, known.get_or_compute(case)) for case in mixed_cases()]
    for solver in harness.solvers().values():
        for tolerance in ladder(solver):
            yield [mixed_point(solver, sample, tolerance)]
    for tolerance in BATCH_TOLERANCES:
        yield [batch_point(sample, tolerance)]


def total() -> int:
    """Steps of ``points``."""
    solvers = harness.solvers().values()
    return len(NAMED) * len(solvers) + sum(len(ladder(solver)) for solver in solvers) + len(BATCH_TOLERANCES)


def ladder(solver: harness.Solver) -> tuple:
    """The tolerances that a solver is asked for: none but its own where it takes none."""
    return TOLERANCES if solver.tolerances else (None,)


def sweep(solver: harness.Solver, case, exact):
    """One point a tolerance, loosest first; below a tolerance that ran out of time nothing tighter is tried."""
    for tolerance in ladder(solver):
        row = harness.measure(solver, case, exact, tolerance)
        if row["verdict"] == "unsupported":
            return
        yield _point(solver.name, solver.label, case.name, tolerance, row)
        if row["message"].startswith(harness.OVERTIME):
            return


def _point(name, label, case, tolerance, judgement) -> dict:
    row = {"solver": name, "label": label, "case": case, "tolerance": tolerance}
    return row | {key: judgement[key] for key in _KEPT if key in judgement}


_KEPT = ("seconds", "error", "in_limits", "verdict", "iterations", "worst", "lines", "wrong", "refused", "right",
         "unsupported")  # fmt: skip


def mixed_cases() -> list[SpanCase]:
    """The first SAMPLE of the mixed lines as cases."""
    return first_cases(random_arrays(BATCH_LINES), SAMPLE)


def first_cases(columns: dict, n: int) -> list[SpanCase]:
    """The first n rows of arrays of inputs as cases."""
    rows = ({key: column[i].item() for key, column in columns.items()} for i in range(n))
    return [SpanCase(f"{harness.MIXED}-{i}", "mixed", **row) for i, row in enumerate(rows)]


def mixed_point(solver: harness.Solver, sample, tolerance) -> dict:
    """Mean time a line and median error over the lines of the sample that the solver supports and answers."""
    answers = [harness.ask(solver, case, tolerance) for case, _ in sample]
    rows = [harness.judge(answer, exact, case) for answer, (case, exact) in zip(answers, sample, strict=True)]
    answered = [i for i, one in enumerate(rows) if one["verdict"] in ("right", "wrong")]

    def all_lines():
        for i in answered:
            solver.solve(sample[i][0], tolerance)

    own = [answers[i].seconds for i in answered]
    seconds = harness.seconds_or_none(all_lines, solver, own)
    mean = seconds and seconds / len(answered)
    return _point(solver.name, solver.label, harness.MIXED, tolerance, _together(rows) | {"seconds": mean})


_WORST_FIRST = ("wrong", "refused", "right",
         "unsupported")  # fmt: skip


def _together(rows) -> dict:
    """One row for many: the worst verdict that occurred, and the counts behind it."""
    counts = {verdict: sum(one["verdict"] == verdict for one in rows) for verdict in _WORST_FIRST}
    errors = [one["error"] for one in rows if one["verdict"] in ("right", "wrong")]
    steps = [one["iterations"] for one in rows if one["iterations"] is not None]
    return {
        "verdict": next(verdict for verdict, number in counts.items() if number),
        "error": float(np.median(errors)) if errors else None,
        "iterations": float(np.mean(steps)) if steps else None,
        "worst": max(errors) if errors else None,
        "lines": len(rows),
        **counts,
    }


def batch_point(sample, tolerance) -> dict:
    """solve_spans on BATCH_LINES lines in one call: time a line; the error is that of the sample's rows."""
    columns, batches = random_arrays(BATCH_LINES), []

    def all_lines():
        batches[:] = [solve_spans(**columns, tolerance=tolerance)]

    seconds = min(harness.clock(all_lines, 1) for _ in range(BATCH_REPEATS)) / BATCH_LINES
    rows = [harness.judge(batch_answer(batches[0], i), exact, case) for i, (case, exact) in enumerate(sample)]
    together = _together(rows) | {"seconds": seconds}
    return _point(harness.BATCH, harness.BATCH_LABEL, harness.MIXED, tolerance, together)


def batch_answer(batch, i: int) -> SpanAnswer:
    """Row i of a batch as the answer of a solver."""
    refused = "" if batch.success[i] else batch.status[i].value
    return SpanAnswer(float(batch.H[i]), float(batch.V[i]), int(batch.iterations[i]), refused)


def main(argv=None) -> int:
    """Command line."""
    arguments = console.parser("work_precision", __doc__).parse_args(argv)
    steps = console.progress(points(truth.TruthCache(arguments.out)), total(), "work-precision")
    entries = [point for step in steps for point in step]
    file = {"cases": [case.name for case in NAMED] + [harness.MIXED], "points": entries, "reference": "50-digit oracle"}
    results.write(arguments.out / "work_precision.json", file)
    print(f"{len(entries)} points")
    return 0


if __name__ == "__main__":
    console.run(main)
