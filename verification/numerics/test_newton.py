"""Do Newton iterations stop where they should? The driver, the halving of a step, the natural test, the damping."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest

from solvers import ConvergenceError, Span, Status, solve_span, solve_spans
from solvers.numerics import newton
from solvers.numerics.newton import (
    MIN_STEP,
    adapted_relaxation,
    damped_newton,
    full_newton,
    halve_step,
    is_contraction,
    iterate,
    relaxed_newton,
)

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


# ---------------------------------------------------------------- steps against the algorithms, written out
def largest(step) -> float:
    """Return the largest component."""
    return float(abs(step).max())


def solved(solver, F, J, x, tolerance=1e-12):
    """Return (x, errors, relaxations, number of Jacobians, converged) of a solver for F(x) = 0, x a list."""
    jacobians = []

    def linearise(x):
        jacobians.append(np.atleast_2d(J(x)))
        return F(x), lambda right: np.linalg.solve(jacobians[-1], right)

    x, steps, converged = solver(linearise, F, np.array(x, dtype=float), tolerance, largest)
    errors, relaxations = np.array(steps).T
    return x, errors, relaxations, len(jacobians), converged


def test_the_relaxation_factor_grows_while_the_error_falls():
    """By 2 % up to 1 where the error fell, by 1/1.1 down where it did not."""
    assert adapted_relaxation(0.5, 0.9, 1.0) == 0.51
    assert adapted_relaxation(0.99, 0.9, 1.0) == 1.0
    assert adapted_relaxation(0.5, 1.0, 1.0) == adapted_relaxation(0.5, 1.1, 1.0) == 0.5 / 1.1


def test_relaxed_steps_are_those_of_the_rule():
    """From 1.1, where the steps for tanh(x) = 0 first grow, against the rule in floats."""
    tanh, slope = np.tanh, lambda x: 1 / np.cosh(x) ** 2
    x, errors, relaxations, _, converged = solved(relaxed_newton, tanh, slope, [1.1], 1e-9)
    place, factor, last, expected = 1.1, 1.0, math.inf, []
    while not expected or expected[-1][0] > 1e-9:
        step = -math.tanh(place) * math.cosh(place) ** 2
        factor = min(1.0, 1.02 * factor) if abs(step) < last else factor / 1.1
        last, place = abs(step), place + factor * step
        expected.append((last, factor))
    assert converged and x[0] == pytest.approx(place, abs=1e-15)
    assert np.column_stack([errors, relaxations]) == pytest.approx(np.array(expected), rel=1e-6, abs=1e-15)
    assert min(relaxations) < 1.0


def written_out(F, J, x, tolerance=1e-12):
    """Return [(full step, relaxation)] of NLEQ-ERR for one unknown without Broyden's updates, until a step is kept.

    Deuflhard, Newton Methods for Nonlinear Problems, algorithm NLEQ-ERR: predicted factor mu, corrected factor mu'.
    """
    steps, before = [], None
    while True:
        full = -F(x) / J(x)
        relaxation = 1.0
        if before is not None and before[1] != full:
            last, simplified, taken = before
            relaxation = min(1.0, abs(last * simplified / ((simplified - full) * full)) * taken)
        while True:
            simplified = -F(x + relaxation * full) / J(x)
            if abs(simplified) <= (1 - relaxation / 4) * abs(full):
                break
            mu = abs(full) * relaxation**2 / (2 * abs(simplified - (1 - relaxation) * full))
            relaxation = min(mu, relaxation / 2)
        steps.append((abs(full), relaxation))
        before, x = (full, simplified, relaxation), x + relaxation * full
        if relaxation == 1.0 and abs(simplified) <= 0.2 * abs(full):
            return steps


@pytest.mark.parametrize("size", [1e-4, 1.0, 1e4])
@pytest.mark.parametrize("start", [1.5, 3.0, 30.0])
def test_damped_steps_are_those_of_the_algorithm(size, start):
    """arctan(x / size) = 0, where full steps diverge: steps and factors, whatever the unit of x."""
    F, J = lambda x: np.arctan(x / size), lambda x: 1 / (1 + (x / size) ** 2) / size
    x, errors, relaxations, _, converged = solved(damped_newton, F, J, [start * size], 1e-12 * size)
    expected = np.array(written_out(F, J, start * size))
    assert converged and abs(x[0]) <= 1e-12 * size and expected[:, 1].min() < 1.0
    assert errors[: len(expected)] == pytest.approx(expected[:, 0], rel=1e-9)
    assert relaxations[: len(expected)] == pytest.approx(expected[:, 1], rel=1e-9)


@pytest.mark.parametrize(("bend", "points"), [(0.02, [0.0]), (0.5, [0.0, 1.0, 0.75])], ids=["flat", "bent"])
def test_full_steps_keep_a_jacobian_that_serves(bend, points):
    """x + bend x^2 = 1: of a flat function the Jacobian at 0 serves to the end, a bent one has another at once.

    One more is made where the steps do not shrink tenfold. points: where Jacobians are made.
    """
    made = []
    residual = lambda x: x + bend * x**2 - 1

    def linearise(x):
        made.append(float(x[0]))
        slope = 1 + 2 * bend * x
        return residual(x), lambda F: F / slope

    norm = lambda step: float(abs(step).max())
    x, taken, converged = full_newton(linearise, residual, np.zeros(1), 1e-10, norm)
    exact = (math.sqrt(1 + 4 * bend) - 1) / (2 * bend)
    assert converged and abs(x[0] - exact) <= 1e-11
    assert made == pytest.approx(points)
    if len(made) > 1:
        assert taken[1].error == pytest.approx(bend / (1 + 2 * bend))


def test_no_change_of_a_step_is_divided_by():
    """F with a kink: the first step is damped, the second is the simplified one, and is tried in full.

    Full steps from x > 1 go to 0, where F = -9 is too large: the corrected factor is min(x / (2 * 9), 1 / 2).
    """
    F, J = lambda x: np.where(x > 1, x, 10 * x - 9), lambda x: np.where(x > 1, 1.0, 10.0)
    x, errors, relaxations, _, converged = solved(damped_newton, F, J, [10.0])
    assert converged and x == pytest.approx([0.9], abs=1e-12)
    assert errors[:3] == pytest.approx([10.0, 5.0, 5.0 * (1 - 5 / 18)], rel=1e-12)
    assert relaxations[:2] == pytest.approx([0.5, 5 / 18], rel=1e-12)


def test_steps_with_a_kept_jacobian_are_broydens():
    """A mildly nonlinear system of three: one Jacobian, then Broyden's good update of it as a dense matrix."""
    A, b = np.array([[4.0, 1.0, 0.5], [-1.0, 3.0, 0.2], [0.3, -0.7, 5.0]]), np.array([1.0, -2.0, 3.0])
    F, J = lambda x: A @ x + 0.1 * x**3 - b, lambda x: A + np.diag(0.3 * x**2)
    x, errors, relaxations, jacobians, converged = solved(damped_newton, F, J, [0.5, 0.5, 0.5])
    place, B, expected = np.full(3, 0.5), J(np.full(3, 0.5)), []
    while not expected or expected[-1] > 1e-12:
        step = -np.linalg.solve(B, F(place))
        place = place + step
        B += np.outer(F(place), step) / (step @ step)
        expected.append(largest(step))
    assert converged and jacobians == 1 and (relaxations == 1.0).all() and len(errors) >= 4
    assert errors == pytest.approx(np.array(expected), rel=1e-6, abs=1e-15)
    assert x == pytest.approx(place, abs=1e-15)


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
