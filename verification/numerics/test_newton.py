"""Do Newton iterations stop where they should? The driver, the halving of a step, the natural test, the damping."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest

from solvers import ConvergenceError, Span, Status, solve_span, solve_spans
from solvers.numerics import newton
from solvers.numerics.newton import MIN_STEP, damped_newton, halve_step, is_contraction, iterate, relaxed_newton

from ..cases.spans import OC3
from ..tools.planting import Fault, plant_in_place


def count_down(limit, fails_at=None):
    """Return (result of ``iterate`` from 3 down to 0, iterates a step was asked at, iterates that were tested)."""
    stepped, tested = [], []

    def step(x):
        stepped.append(x)
        return None if x == fails_at else x - 1

    def is_solved(x):
        tested.append(x)
        return x == 0

    return iterate(step, is_solved, 3, limit), stepped, tested


def test_the_iteration_ends_at_the_solution():
    """No step is taken from a solved iterate, and a start that is solved takes none."""
    assert count_down(10) == ((0, True), [3, 2, 1], [3, 2, 1, 0])
    assert iterate(lambda x: pytest.fail("a step"), lambda x: True, 7, 5) == (7, True)


def test_the_last_step_that_is_allowed_may_solve():
    """With as many steps as are needed the result is solved, with one less it is not; no step with none."""
    assert count_down(3) == ((0, True), [3, 2, 1], [3, 2, 1, 0])
    assert count_down(2) == ((1, False), [3, 2], [3, 2, 1])
    assert count_down(0) == ((3, False), [], [3])


def test_the_iteration_keeps_the_iterate_before_a_failed_step():
    assert count_down(10, fails_at=2)[0] == (2, False)


def halved(norm, contracts=lambda new, length: False, is_solved=lambda new: False):
    """Return (accepted length or None, lengths tried) of a step whose residual norm was 1."""
    tried = []

    def trial(length):
        tried.append(length)
        return SimpleNamespace(length=length, norm=norm(length))

    new = halve_step(trial, 1.0, contracts, is_solved)
    return new and new.length, tried


def test_a_step_is_halved_until_the_residual_falls_enough():
    """A ten-thousandth of the length of the step is enough; less is not."""
    assert halved(lambda length: 1 - 1.01e-4 * length) == (1.0, [1.0])
    assert halved(lambda length: 1 - 0.99e-4 * length if length > 0.3 else 0.5) == (0.25, [1.0, 0.5, 0.25])


def test_a_step_is_accepted_by_the_natural_test_or_where_it_solves():
    """Also where the residual norm grows."""
    grows = lambda length: 1 + length
    assert halved(grows, contracts=lambda new, length: length < 0.6)[0] == 0.5
    assert halved(grows, is_solved=lambda new: new.length < 0.3)[0] == 0.25


@pytest.mark.parametrize("norm", [math.nan, math.inf, 1.0])
def test_no_step_is_accepted_below_the_least(norm):
    length, tried = halved(lambda _: norm)
    assert length is None and tried[-1] > MIN_STEP >= tried[-1] / 2


def test_a_trial_that_does_not_exist_ends_the_halving():
    assert halve_step(lambda length: None, 1.0, None, None) is None


def test_the_natural_test_asks_for_a_shorter_step():
    """By a quarter of the part that was taken; nan is never shorter."""
    assert is_contraction(0.75, 1.0, 1.0) and not is_contraction(0.751, 1.0, 1.0)
    assert is_contraction(0.9, 1.0, 0.4) and not is_contraction(0.901, 1.0, 0.4)
    assert not is_contraction(math.nan, 1.0, 1.0)


@pytest.mark.parametrize("solver", [damped_newton, relaxed_newton])
@pytest.mark.parametrize("fault", ["residual", "Jacobian", "step"])
def test_what_is_not_finite_ends_the_iteration_where_it_is(solver, fault):
    """A residual of nan, a singular Jacobian, a step of nan: the start is returned, not solved, without a step."""
    F = np.array([math.nan if fault == "residual" else 1.0])
    solve = {"residual": lambda F: np.ones(1), "Jacobian": None, "step": lambda F: F * math.nan}[fault]
    x, steps, converged = solver(lambda x: (F, solve), lambda x: F, np.array([2.0]), 1e-9, lambda dx: abs(dx).max())
    assert (x.tolist(), steps, converged) == ([2.0], [], False)


def test_a_line_whose_iteration_runs_out_of_steps_is_not_converged(monkeypatch):
    """With one step allowed a line ends in NOT_CONVERGED with NaN, alone and in a batch, and is raised."""
    monkeypatch.setattr(newton, "MAX_ITERATIONS", 1)
    span = Span(**OC3)
    state = solve_span(span, throw=False)
    assert state.status is Status.NOT_CONVERGED and math.isnan(state.H) and not state.success
    with pytest.raises(ConvergenceError, match="stopped above the requested tolerance"):
        solve_span(span)
    assert solve_spans(*(getattr(span, name) for name in ("w", "EA", "L", "x", "z"))).status.tolist() == [state.status]


@pytest.mark.parametrize("start", [1.5, 3.0, -20.0])
def test_damping_converges_where_full_steps_diverge(start):
    """arctan x = 0 from beyond 1.39, where full Newton steps run away."""
    residual = np.arctan
    linearise = lambda x: (residual(x), lambda F: F * (1 + x * x))
    x, steps, converged = damped_newton(linearise, residual, np.array([start]), 1e-12, lambda d: float(abs(d[0])))
    assert converged and abs(x[0]) <= 1e-12
    assert min(step.relaxation for step in steps) < 1


FAULTS = {
    test_the_iteration_ends_at_the_solution: Fault("numerics.newton", "iterate", "is_solved(x)", "False", occurrence=1),
    test_the_last_step_that_is_allowed_may_solve: Fault(
        "numerics.newton", "iterate", "range(limit)", "range(limit + 1)"
    ),
    test_the_iteration_keeps_the_iterate_before_a_failed_step: Fault(
        "numerics.newton", "iterate", "return x, False", "return new, False"
    ),
    test_a_step_is_halved_until_the_residual_falls_enough: Fault(
        "numerics.newton", "halve_step", "1 - SUFFICIENT_DECREASE * length", "1"
    ),
    test_a_step_is_accepted_by_the_natural_test_or_where_it_solves: Fault(
        "numerics.newton", "halve_step", "contracts(new, length)", "False"
    ),
    test_a_trial_that_does_not_exist_ends_the_halving: Fault("numerics.newton", "halve_step", "new is None", "False"),
    test_the_natural_test_asks_for_a_shorter_step: Fault(
        "numerics.newton", "is_contraction", "length / 4", "length / 2"
    ),
}


@pytest.mark.parametrize("test", FAULTS, ids=lambda test: test.__name__)
def test_a_planted_fault_turns_each_test_red(test, monkeypatch):
    test()
    plant_in_place(FAULTS[test], monkeypatch)
    with pytest.raises((AssertionError, AttributeError, TypeError, pytest.fail.Exception)):
        test()
