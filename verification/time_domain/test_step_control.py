"""Is the error of a step what it is for a cubic, and the next step what follows from it?"""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from solvers.time_domain.step_control import StepControl

DT, TOLERANCE, CONSTANT = 2.0, 1e-3, -1 / 12  # of the trapezoidal rule: its local error is -h^3 y'''/12
SCALE = np.array([2.0, 4.0])


def control(h):
    """Return a StepControl of two fields that is at a step h."""
    made = StepControl(SimpleNamespace(scale=lambda: SCALE), DT, TOLERANCE, CONSTANT)
    assert made.h == DT / 1024
    made.h = h
    return made


def try_step(made, third, h, before=0.5, t=0.0, first=False):
    """Return whether a step of the cubic third t^3/6 (one value for each field) with the scheme's error is taken.

    before : length of the step before; the rate predicted for the end extrapolates those at its start and end
    """
    third = np.array(third)[:, None]
    y, rate = lambda t: third * t**3 / 6, lambda t: third * t**2 / 2
    new = y(t + h) + CONSTANT * h**3 * third, rate(t + h)
    predicted = rate(t) + h / before * (rate(t) - rate(t - before))
    previous = None if first else (before, rate(t - before))
    return made.accept(new, h, y(t), rate(t), predicted, previous)


def third_of(relative, h, size=2.0):
    """Return y''' for which the error of a step is ``relative`` to the tolerance in a field of that size."""
    return relative * TOLERANCE * size / (abs(CONSTANT) * h**3)


@pytest.mark.parametrize("h", [0.02, 0.3])
@pytest.mark.parametrize("before", [0.02, 0.5])
@pytest.mark.parametrize(("relative", "factor"), [(0.2, 0.9 * 5 ** (1 / 3)), (0.01, 2.0), (0.9, 1.0), (0.5, 1.0)])
def test_a_step_within_the_tolerance_is_taken(h, before, relative, factor):
    """The next is as long as its error allows, by 0.9 and the third root, twice at most; kept between 0.8 and 1.2."""
    made = control(h)
    made.size = np.full((2, 1), 1e9)  # far above the values, so that they do not matter
    assert try_step(made, [third_of(relative, h, 1e9), 0.0], h, before)
    assert made.h == pytest.approx(factor * h, rel=1e-6)


@pytest.mark.parametrize(("relative", "factor"), [(1.1, 0.9), (2.0, 0.9 / 2 ** (1 / 3)), (8.0, 0.45), (200.0, 0.2)])
def test_a_step_beyond_the_tolerance_is_tried_again(relative, factor):
    """Shorter by its error, to a fifth at least, and by a tenth in any case."""
    made = control(0.3)
    made.size = np.full((2, 1), 1e9)
    assert not try_step(made, [0.0, third_of(relative, 0.3, 1e9)], 0.3)
    assert made.h == pytest.approx(factor * 0.3, rel=1e-6)
    assert made.size.tolist() == [[1e9], [1e9]]


def test_steps_stay_below_the_longest():
    made = control(1.6)
    assert try_step(made, [0.0, 0.0], 1.6) and made.h == DT


def test_errors_are_relative_to_the_largest_value_so_far():
    """Of each field, the scale of the chain at first; the mean over the nodes, the worst of the fields."""
    made = control(0.1)
    assert try_step(made, [60.0, 0.0], 0.1, t=2.0)  # y = 92.6 at 2.1 s: the error 0.005 is 0.05 of the tolerance
    assert made.size[:, 0] == pytest.approx([10.0 * 2.1**3 + CONSTANT * 1e-3 * 60, 4.0])
    made = control(0.1)
    assert not try_step(made, [60.0, 0.0], 0.1, t=-0.05, before=0.1)  # there |y| stays below 2
    made = control(0.1)
    new = np.array([[0.0, 0.0, 0.0, 4.0], [0.0, 0.0, 0.0, 0.0]])
    rate = np.zeros((2, 4))
    made.accept((new, rate), 0.1, np.zeros((2, 4)), rate, rate, (0.1, rate))
    error = CONSTANT / (5 / 12 + CONSTANT) * 4.0 / 4.0 / 2  # of the size 4 of the new value; the mean square of four
    assert made.h == pytest.approx(max(0.9 * (abs(error) / TOLERANCE) ** (-1 / 3), 0.2) * 0.1)


def test_the_first_step_is_taken_as_it_is():
    """Nothing to compare it with: 0.9 times the step would be within the margin."""
    made = control(0.1)
    assert try_step(made, [1e9, 0.0], 0.1, first=True) and made.h == 0.1


def test_a_step_that_did_not_converge_is_a_fifth_next():
    made = control(0.1)
    assert not made.accept(None, 0.1, None, None, None, None)
    assert made.h == pytest.approx(0.02) and not made.gave_up
    for part, gave_up in ((1.1e-6, False), (0.9e-6, True)):
        made.h = part * DT
        assert made.gave_up is gave_up
