"""pytest-benchmark: the cases of the HB paper by harmonic balance and by time stepping, from the equilibrium.

Run with: pytest benchmarks --benchmark-only. Errors, against converged tensions, stand in harmonic_balance.json.
"""

from __future__ import annotations

import pytest
from threadpoolctl import threadpool_limits

from solvers.cable.statics import solve_static
from solvers.harmonic_balance.solve import solve_periodic
from solvers.time_domain.solve import solve_time_domain

from .cases import CASES, DT, HARMONICS, PAPER_CASES, SAMPLES, system

SECONDS = 0.3  # spent on each case


@pytest.fixture(autouse=True)
def one_thread():
    with threadpool_limits(1):
        yield


def timed(benchmark, case: str, label: str, solve, **options):
    """One timing with what it found."""
    benchmark.group = f"cable: {CASES[case]}"
    response = benchmark(solve, system(case), **options)
    benchmark.extra_info.update({"problem": "cable", "case": case, "solver": label, "label": label, "lines": 1})
    benchmark.extra_info.update({"iterations": response.iterations, "verdict": response.status.name})


@pytest.mark.parametrize("case", PAPER_CASES)
@pytest.mark.benchmark(max_time=SECONDS, min_rounds=3)
def test_harmonic_balance(benchmark, case):
    timed(benchmark, case, "harmonic balance", solve_periodic, harmonics=HARMONICS, samples=SAMPLES)


@pytest.mark.parametrize("case", ("case_1", "case_4"))
@pytest.mark.benchmark(max_time=SECONDS, min_rounds=2)
def test_one_period_of_time_stepping(benchmark, case):
    timed(benchmark, case, "time domain, one period", solve_time_domain, dt=DT, periods=1)


@pytest.mark.benchmark(max_time=SECONDS, min_rounds=3)
def test_statics(benchmark):
    timed(benchmark, "case_1", "statics on the box scheme", solve_static)
