"""pytest-benchmark: every case by every solver, one cold solve each; many lines in one call.

Run with: pytest benchmarks --benchmark-only. What a row found stands in its extra_info beside the times.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from threadpoolctl import threadpool_limits

from solvers import solve_spans
from verification.cases.spans import NAMED, random_arrays

from ..run import harness, results
from ..run import oracle_cache as truth
from . import work_precision

SECONDS = 0.2  # spent on each case and solver, so that the whole file takes less than a minute
SIZES = (100_000, 1_000_000)  # lines
BATCH_ROUNDS = 3
JUDGED = 20  # lines of a batch that are compared with the oracle: median error, most limits

SOLVERS = harness.solvers()
oracle = cache(truth.oracle)


@pytest.fixture(autouse=True)
def one_thread():
    with threadpool_limits(1):
        yield


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("case", NAMED, ids=lambda case: case.name)
@pytest.mark.benchmark(max_time=SECONDS, min_rounds=3)
def test_span_cold(benchmark, case, solver):
    solver = SOLVERS[solver]
    row = harness.assess(solver, case, oracle(case))
    if row["verdict"] not in ("right", "wrong"):
        pytest.skip(f"{solver.label}: {row['message']}")
    benchmark.group = f"span-cold: {case.name}"
    benchmark.extra_info.update(
        {"problem": "span", "case": case.name, "solver": solver.name, "label": solver.label, "lines": 1}
        | results.plain({key: row[key] for key in ("error", "in_limits", "iterations", "verdict")})
    )
    with harness.quiet():
        benchmark(solver.solve, case)


@pytest.mark.parametrize("lines", SIZES)
def test_batch(benchmark, lines):
    columns = random_arrays(lines)
    benchmark.group = "batch"
    batch = benchmark.pedantic(solve_spans, kwargs=columns, rounds=BATCH_ROUNDS, warmup_rounds=1)
    sample = enumerate(work_precision.first_cases(columns, JUDGED))
    rows = [harness.judge(work_precision.batch_answer(batch, i), oracle(case), case) for i, case in sample]
    verdicts = {one["verdict"] for one in rows}
    benchmark.extra_info.update(
        {"problem": "span", "case": harness.MIXED, "solver": harness.BATCH, "label": harness.BATCH_LABEL}
        | {"lines": lines, "failed_rows": int(np.count_nonzero(~batch.success)), "judged": JUDGED}
        | {"error": float(np.median([one["error"] for one in rows]))}
        | {"in_limits": max(one["in_limits"] for one in rows)}
        | {"iterations": float(np.mean(batch.iterations))}
        | {"verdict": next(verdict for verdict in ("wrong", "refused", "right") if verdict in verdicts)}
    )
