"""What makes the harmonic balance quick: does it leave the answer alone, and does it do less work?

Starts that follow the fairlead, on fewer nodes and harmonics, factors in single precision that are checked, updates of
an old Jacobian after Broyden, memory that stays with the process, one BLAS thread.
"""

from __future__ import annotations

import gc
import math
import os
import platform
import subprocess
import sys
import weakref

import numpy as np
import pytest

from solvers import Status
from solvers.cable.system import CableSystem, cable_system
from solvers.harmonic_balance import residual as harmonic_rows
from solvers.harmonic_balance import start
from solvers.harmonic_balance.residual import HarmonicResidual
from solvers.harmonic_balance.solve import solve_periodic
from solvers.numerics import newton
from solvers.numerics.fourier import Basis
from solvers.numerics.lu.bordered import BlockChain
from verification import ROOT

from ..cases.oscillators import MassChain, harmonic_force
from ..numerics.test_bordered import FORWARD, Chain
from .test_solve import ROUND_OFF, each_case, largest, scene, system

SINGLE = np.finfo(np.float32).eps
DETUNED = 2e-7  # share of the stiffness, twice the spacing of single precision: the condition is the inverse
NEAR_RESONANCE = 1e-7  # of the amplitude: rounding, 1e-16, times that condition, and a hundred
CUBIC = 1e-12  # of the values: splines reproduce cubic polynomials


# ---------------------------------------------------------------- single precision
@pytest.mark.parametrize("shape", [(9, 8, 4, 2), (7, 18, 9, 3), (300, 3, 2, 1)], ids=str)
def test_single_precision_is_as_good_as_it_can_be(shape):
    """Factors of a chain in single precision: its rounding times the condition."""
    chain = Chain.random(*shape)
    A, b = chain.dense()
    factors = BlockChain(*(part.astype(np.float32) for part in chain.blocks))
    x, wanted = factors.solve(*chain.right).ravel(), np.linalg.solve(A, b)
    allowed = FORWARD * SINGLE * np.linalg.cond(A / abs(A).max(axis=1)[:, None])
    error = np.linalg.norm(x - wanted) / np.linalg.norm(wanted)
    assert x.dtype == float and SINGLE / FORWARD < error <= allowed  # and single it is


def step_error(force=1.0) -> float:
    """Of the first Newton step of a mass without damping, driven at 1 rad/s, DETUNED below its resonance; relative.

    The problem is linear, so the step is the solution: a place of F / (k - omega^2 m).
    """
    chain = MassChain("detuned", 2 * math.pi, harmonic_force(force, 1.0), k=1.0 + DETUNED)
    balance = HarmonicResidual(chain, Basis(1, 8, 1.0, True))
    F, solve = balance.linearise(np.zeros((1, balance.n)))
    place = abs(balance.unpack(solve(F))[0]).max()
    return abs(place * DETUNED / force - 1)


def test_double_precision_where_single_does_not_do(monkeypatch):
    """Single precision cannot tell the frequencies apart; that is seen, and the step is right all the same."""
    monkeypatch.setattr(
        harmonic_rows, "SINGLE_PRECISION_FROM", 0
    )  # or a chain as small as this one is never in single precision
    for force in (1.0, 1e-9, 1e9):  # the refinement is compared with the step
        assert step_error(force) < NEAR_RESONANCE
    monkeypatch.setattr(harmonic_rows, "MAX_REFINEMENT", np.inf)
    assert not step_error() < NEAR_RESONANCE


def made(monkeypatch) -> list:
    """(nodes, precision) of every factorisation from now on."""
    kept, solve = [], BlockChain

    class Counted(solve):
        def __init__(self, *blocks):
            super().__init__(*blocks)
            kept.append((len(self.cell) + 1, self.precision.name))

    monkeypatch.setattr(harmonic_rows, "BlockChain", Counted)
    return kept


@pytest.mark.parametrize("options", [{}, {"deferred_correction": True}, {"globalisation": "relaxation"}], ids=str)
def test_factors_do_not_outlive_the_solve(options, monkeypatch):
    """Without a collection of garbage every factorisation is freed: the next solve gets its memory, still warm."""
    living = []

    class Watched(BlockChain):
        def __init__(self, *blocks):
            super().__init__(*blocks)
            living.append(weakref.ref(self))

    monkeypatch.setattr(harmonic_rows, "BlockChain", Watched)
    gc.disable()
    try:
        response = solve_periodic(system(2, 25), harmonics=5, **options)
        assert response.status is Status.SUCCESS and living and not any(factors() for factors in living)
    finally:
        gc.enable()


@each_case
def test_one_factorisation_on_all_nodes(case, monkeypatch):
    """Of the paper's cases, in single precision; starts are on fewer nodes, and those with few harmonics in double."""
    kept = made(monkeypatch)
    solve_periodic(system(case), harmonics=9)
    assert kept.count((50, "float32")) == 1 and all(nodes < 20 for nodes, precision in kept if precision != "float32")


def test_many_nodes_and_harmonics(deep):
    """1000 nodes and 60 harmonics with --deep (3 GB): found like few of both, with one factorisation on all nodes."""
    nodes, harmonics = (1000, 60) if deep else (120, 20)
    response = solve_periodic(system(1, nodes), harmonics=harmonics)
    assert response.iterations <= 5 and response.steps[-1].error <= 1e-10


# ---------------------------------------------------------------- starts
@each_case
def test_starts_change_nothing(case):
    """With and without starts on fewer nodes and harmonics."""
    for mean in (True, False):
        with_starts, without = (
            solve_periodic(system(case), harmonics=6, mean=mean, multilevel=multilevel) for multilevel in (True, False)
        )
        assert largest(with_starts.z - without.z) < ROUND_OFF


@pytest.mark.parametrize("nodes", (20, 21, 50))
def test_a_coarser_cable_is_the_cable_on_that_mesh(nodes):
    """Both ends stay, nodes are about half as many; the response is that of the line on this mesh."""
    coarse, _ = system(1, nodes).coarser()
    assert coarse.s[0] == 0 and coarse.s[-1] == scene(1).length and coarse.nodes == nodes // 2 + 1
    wanted = cable_system(scene(1), mesh=coarse.s)
    result = (solve_periodic(of, harmonics=4) for of in (coarse, wanted))
    t = np.linspace(0.0, coarse.period, 50)
    got, other = (response.fairlead_tension(t) for response in result)
    assert largest(got - other) < ROUND_OFF * np.ptp(other)


def test_few_nodes_have_no_coarser_ones():
    """Below twenty."""
    assert system(1, 19).coarser() is None


def test_coefficients_are_carried_by_cubic_splines():
    """Cubic polynomials of s arrive as they are, on the nodes of the finer mesh."""
    fine = system(1, 40)
    coarse, carry = fine.coarser()
    powers = np.arange(4)[:, None, None]
    wanted, given = ((of.s / of.s[-1])[None, :, None] ** powers for of in (fine, coarse))
    assert largest(carry(given) - wanted) < CUBIC


@pytest.mark.parametrize(
    ("coarsest", "harmonics", "levels"),
    [
        (0, 3, []),
        (0, 4, [(0, 3)]),
        (0, 24, [(0, 3)]),
        (0, 25, [(0, 3), (0, 12)]),
        (0, 97, [(0, 3), (0, 12), (0, 48)]),
        (1, 3, [(1, 3)]),
        (1, 20, [(1, 3), (1, 7), (1, 20)]),
        (2, 9, [(2, 3), (1, 9)]),
        (3, 20, [(3, 3), (2, 7), (1, 20)]),
        (3, 100, [(3, 3), (3, 4), (3, 12), (2, 34), (1, 100)]),
    ],
)
def test_levels_are_those_of_the_rule(coarsest, harmonics, levels):
    """A third of the harmonics on half the nodes, down to three; fourfold harmonics where nodes cannot be fewer."""
    assert start._levels(coarsest, 3, harmonics) == levels


@pytest.mark.parametrize(
    ("nodes", "harmonics", "levels"), [(41, 9, [(11, 3), (21, 9)]), (15, 3, [(15, 3)]), (15, 5, [(15, 3)])]
)
def test_each_level_is_solved_and_counted(nodes, harmonics, levels, monkeypatch):
    """Of a line with a predictor, without fewer nodes and harmonics once with its own; undamped steps only at first."""
    solved, solve = [], start.solve_with_continuation

    def recorded(chain, basis, z, tolerance, newton, *options):
        solution = solve(chain, basis, z, tolerance, newton, *options)
        solved.append((chain.nodes, basis.harmonics, newton is start.undamped_then_damped, solution.iterations))
        return solution

    monkeypatch.setattr(start, "solve_with_continuation", recorded)
    chain = cable_system(scene(1), nodes)
    basis = Basis(harmonics, 4 * harmonics, 2 * math.pi / chain.period, True)
    z, iterations = start.multilevel_start(chain, basis, 1, newton.damped_newton, None)
    assert [level[:2] for level in solved] == levels
    assert [level[2] for level in solved] == [True] + [False] * (len(levels) - 1)
    assert iterations == sum(level[3] for level in solved) and z.shape[1:] == (nodes, 2 * harmonics + 1)


@pytest.mark.parametrize("coarsest, harmonics", [(0, 3), (0, 60), (1, 3), (2, 9), (2, 24), (6, 60), (6, 2)])
def test_levels_grow_to_all(coarsest, harmonics):
    """Nodes and harmonics never fall; with coarser chains the last level has all harmonics and half the nodes."""
    levels = start._levels(coarsest, 3, harmonics)
    assert all(0 <= coarse <= coarsest and 1 <= few <= harmonics for coarse, few in levels)
    assert levels == sorted(levels, key=lambda level: (-level[0], level[1]))
    assert (levels[-1] == (1, harmonics)) if coarsest else all(few < harmonics for _, few in levels)


def test_a_carried_start_saves_steps(monkeypatch):
    """Surge and sway: from rest, where drag has no slope, the first steps are short and many."""
    carried = solve_periodic(system(4), harmonics=9).coarse_iterations
    monkeypatch.setattr(CableSystem, "predict_motion", lambda self, t: None)
    assert carried < solve_periodic(system(4), harmonics=9).coarse_iterations


def test_damped_steps_follow_where_full_ones_fail(monkeypatch):
    """Without any full step the response is the same."""
    response = solve_periodic(system(3), harmonics=5)
    monkeypatch.setattr(start, "MAX_UNDAMPED_STEPS", 0)
    again = solve_periodic(system(3), harmonics=5)
    assert largest(response.z - again.z) < 1e-8 * largest(response.z)  # two ways to (76) < 1e-10


# ---------------------------------------------------------------- updates
def newton_steps() -> int:
    """Newton steps of the case 1 from rest with all harmonics."""
    response = solve_periodic(system(1), harmonics=15, tolerance=1e-12)
    return response.iterations


def test_updates_of_an_old_jacobian_save_steps(monkeypatch):
    """Broyden's updates: fewer steps on all nodes than with the old Jacobian as it was."""
    updated = newton_steps()
    monkeypatch.setattr(newton, "_updated", lambda simplified, taken: simplified)
    assert updated < newton_steps()


def test_an_update_makes_a_secant_step():
    """In one unknown the second step with an old slope is that of the secant, worked by hand: 1/2 / (1 - 1/4)."""
    first, simplified = np.array([2.0]), np.array([0.5])
    assert newton._updated(simplified, [first]) == pytest.approx(0.5 / (1 - 0.25), rel=1e-15)


# ---------------------------------------------------------------- the checks turn red
def test_a_shifted_mesh_is_found(monkeypatch):
    """Coefficients put one node off are no cubic polynomials any more."""
    fine = system(1, 40)
    coarse, carry = fine.coarser()
    given = ((coarse.s / coarse.s[-1])[None, :, None]) ** 3
    wanted = ((fine.s / fine.s[-1])[None, :, None]) ** 3
    assert largest(np.roll(carry(given), 1, axis=1) - wanted) > CUBIC


def test_double_precision_is_not_called_single():
    """Factors in double precision fail the lower bound of the first check."""
    chain = Chain.random(9, 8, 4, 2)
    A, b = chain.dense()
    wanted = np.linalg.solve(A, b)
    assert np.linalg.norm(chain.solved() - wanted) / np.linalg.norm(wanted) < SINGLE / FORWARD


# ---------------------------------------------------------------- memory
PAGES = """
import resource
from benchmarks.cable.cases import system
from solvers import solve_periodic
chain = system("case_1", 50, "spatial")
for _ in range(3):
    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    solve_periodic(chain, harmonics=9)
print(resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before)
"""
FEW_PAGES = 400  # new ones in a solve; without the heap's lesson 4700 of 4 kB, with it 0 to 5


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="of the C library of GNU")
def test_a_second_solve_touches_no_new_memory():
    """What a solve frees is there for the next one: the system is not asked for it again."""
    run = subprocess.run([sys.executable, "-c", PAGES], cwd=ROOT, capture_output=True, text=True)
    assert run.returncode == 0 and int(run.stdout) < FEW_PAGES, run.stdout + run.stderr


# ---------------------------------------------------------------- threads
THREADS = """
import threading
from threadpoolctl import threadpool_info, threadpool_limits
from solvers.numerics.threads import one_blas_thread

def count():
    return {library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"}

def run(*works):
    threads = [threading.Thread(target=work) for work in works]
    for thread in threads:
        thread.start()
    return threads

counts, first_is_in, second_is_in, first_is_out, end = [], *(threading.Event() for _ in range(4))

def first():
    with one_blas_thread():
        first_is_in.set()
        second_is_in.wait()
    first_is_out.set()
    end.wait()  # a thread of a pool lives on

def second():
    first_is_in.wait()
    with one_blas_thread():
        second_is_in.set()
        first_is_out.wait()
        counts.append(count())

def alone():
    with one_blas_thread():
        counts.append(count())
    with threadpool_limits(1):
        counts.append(count())

before = count()
with one_blas_thread():
    counts.append(count())
try:
    with one_blas_thread():
        raise ValueError
except ValueError:
    pass
run(alone)[0].join()
assert count() == before
run(first, second)[1].join()
after = count()
end.set()
print(before == after, [one <= {1} for one in counts])  # none where no library can be told
"""


def test_overlapping_solves_leave_the_threads_as_they_were():
    """A solve, then one in a thread of Python, then two that overlap, of which the first began first and its thread
    lives on: one BLAS thread inside, as many as before in the end."""
    environment = {name: value for name, value in os.environ.items() if not name.endswith("_NUM_THREADS")}
    run = subprocess.run([sys.executable, "-c", THREADS], cwd=ROOT, env=environment, capture_output=True, text=True)
    assert (run.stdout, run.stderr) == (f"True {[True] * 4}\n", "")
