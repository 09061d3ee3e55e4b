"""pytest-benchmark: block elimination by BLAS by address, and by what could replace it; turn and turn about.

Run with: pytest benchmarks/harmonic_balance/bench_block_lu.py --benchmark-only --deep. Times are those of BlockChain;
in the extra_info of a row stand medians of ratios of CPU times, alternative over BlockChain: of factors, of a solution
with them, of a whole solve. Skipped without --deep: the alternatives take a minute to compile.
"""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from threadpoolctl import threadpool_limits

from solvers import solve_periodic
from solvers.harmonic_balance import residual
from solvers.numerics.lu.bordered import BlockChain

from ..cable.cases import system
from ..network.paired_timing import against, turns
from .block_lu import FASTMATH, Alternative, build

UNKNOWNS = (10, 22, 38, 57, 61, 93, 122)  # of a node
NODES = (7, 15, 50, 100)
FULL_ROWS = 2
TURNS, SOLVE_TURNS = 15, 9
SECONDS = 0.01  # of a turn at least: the clock of CPU times is coarse
AGREED = 1e4  # in units of eps: random chains are that far from well-conditioned, or farther from it in few rows
REAL = [(case, harmonics) for case in ("case_1", "case_4") for harmonics in (5, 9, 15)]


@pytest.fixture(autouse=True)
def one_thread(request):
    if not request.config.getoption("--deep"):
        pytest.skip("compiles the alternatives: with --deep")
    with threadpool_limits(1):
        yield


def makers() -> dict:
    """Name -> what makes factors of a chain."""
    return {"BlockChain": BlockChain} | {name: partial(Alternative, build(name)) for name in FASTMATH}


def random_chain(n, nodes, precision) -> tuple:
    """Blocks and a right-hand side as BlockChain takes them; half the unknowns of a node have start rows."""
    rng, p = np.random.default_rng(2026), n // 2
    e = n - p - FULL_ROWS
    blocks = (p, n), (2, nodes - 1, n, n), (e, n), (FULL_ROWS, nodes, n)
    right = tuple(rng.normal(size=shape) for shape in (p, (nodes - 1, n), e, FULL_ROWS))
    return tuple(rng.normal(size=shape).astype(precision) for shape in blocks), right


def ratios(calls, count) -> dict:
    """Name of an alternative -> median of its time over that of BlockChain; short calls are repeated, all as often."""
    seconds = min(turns({"": calls["BlockChain"]}, 3)[""])
    repeats = max(1, round(SECONDS / max(seconds, 1e-6)))
    many = {name: lambda call=call: [call() for _ in range(repeats)] for name, call in calls.items()}
    times = turns(many, count)
    return {name: round(against(times, name, "BlockChain")["ratio"], 2) for name in calls if name != "BlockChain"}


def compare(benchmark, blocks, right):
    """Time factors by BlockChain, and note the ratios."""
    factors = {name: make(*blocks) for name, make in makers().items()}
    assert not any(made.singular for made in factors.values())
    make = {name: partial(make, *blocks) for name, make in makers().items()}
    solve = {name: partial(made.solve, *right) for name, made in factors.items()}
    benchmark.extra_info["factors"] = ratios(make, TURNS)
    benchmark.extra_info["solution"] = ratios(solve, TURNS)
    benchmark(BlockChain, *blocks)
    return [made.solve(*right) for made in factors.values()]


@pytest.mark.parametrize("precision", (np.float64, np.float32), ids=("double", "single"))
@pytest.mark.parametrize("nodes", NODES)
@pytest.mark.parametrize("n", UNKNOWNS)
@pytest.mark.benchmark(max_time=0.2, min_rounds=3)
def test_random_chain(benchmark, n, nodes, precision):
    benchmark.group = f"block LU: {n} unknowns a node"
    compare(benchmark, *random_chain(n, nodes, precision))


def last_chain(case, harmonics) -> tuple:
    """The last matrix and right-hand side of a solve."""
    kept = {}

    class Kept(BlockChain):
        def __init__(self, start, cells, end, border):
            cells = cells if isinstance(cells, np.ndarray) else np.concatenate(list(cells), axis=1)
            kept["blocks"] = start, cells, end, border
            super().__init__(*kept["blocks"])

        def solve(self, *right):
            kept["right"] = right
            return super().solve(*right)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(residual, "BlockChain", Kept)
        solve_periodic(system(case), harmonics=harmonics)
    return kept["blocks"], kept["right"]


@pytest.mark.parametrize(("case", "harmonics"), REAL)
@pytest.mark.benchmark(max_time=0.2, min_rounds=3)
def test_chain_of_a_cable(benchmark, case, harmonics):
    blocks, right = last_chain(case, harmonics)
    benchmark.group = f"block LU: {case}, {harmonics} harmonics"
    benchmark.extra_info |= {"unknowns": blocks[0].shape[1], "precision": blocks[0].dtype.name}
    wanted, *others = compare(benchmark, blocks, right)
    for x in others:
        assert abs(x - wanted).max() <= AGREED * np.finfo(blocks[0].dtype).eps * abs(wanted).max()


@pytest.mark.parametrize(("case", "harmonics"), REAL)
@pytest.mark.benchmark(max_time=0.5, min_rounds=3)
def test_whole_solve(benchmark, case, harmonics):
    def solve(make):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(residual, "BlockChain", make)
            return solve_periodic(system(case), harmonics=harmonics)

    benchmark.group = f"block LU: {case}, {harmonics} harmonics"
    calls = {name: partial(solve, make) for name, make in makers().items()}
    wanted, *others = (call().z for call in calls.values())
    assert all(abs(z - wanted).max() <= 1e-9 * abs(wanted).max() for z in others)
    benchmark.extra_info["whole solve"] = ratios(calls, SOLVE_TURNS)
    benchmark(solve_periodic, system(case), harmonics=harmonics)
