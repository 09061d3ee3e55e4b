"""Is a single step in time right: the work of Newton's method, the size of the next step, the control of the drift?"""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest

from solvers.time_domain.drift_control import PositionDriftControl
from solvers.time_domain.generalized_alpha import Scheme, Stepper
from solvers.time_domain.step_control import StepControl

from ..cases.oscillators import LINEAR, MassChain


def stepped(*lengths):
    """(iterations, factorisations) of each step of these lengths of a linear chain from rest."""
    stepper = Stepper(LINEAR, Scheme.from_spectral_radius(0.5), 1e-10, None, max(lengths))
    y, ydot, t, spent = LINEAR.rest_state(), LINEAR.rest_state(), 0.0, []
    for h in lengths:
        before = stepper.iterations, stepper.factorisations
        y, ydot = stepper.step(y, ydot, t, h, ydot)
        spent.append((stepper.iterations - before[0], stepper.factorisations - before[1]))
        t += h
    return spent


def test_a_new_jacobian_converges_quadratically():
    """Equations that are linear take one iteration, and one that finds nothing left; the factors are kept."""
    assert stepped(0.3, 0.3, 0.3) == [(2, 1), (2, 0), (2, 0)]


def test_a_new_step_length_takes_a_new_jacobian():
    """A change of the step makes the factors new ones, and again two iterations are enough."""
    assert stepped(0.3, 0.1, 0.1, 0.3) == [(2, 1), (2, 1), (2, 0), (2, 1)]


@pytest.mark.parametrize("share", [0.05, 0.4])
def test_the_next_step_size_follows_from_the_error(share):
    """A free swing from exact states: the next step is 0.9 h (tolerance / true error)^(1/3), to 3 per cent."""
    omega, h = 1.3, 0.03
    swing = MassChain("swing", 1.0, lambda t: np.zeros((1, *np.shape(t))), 1, 1.0, 0.0, 0.0, omega**2)

    def exact(t):
        q, v = math.cos(omega * t), -omega * math.sin(omega * t)
        state, rate = [q, v, omega**2 * q], [v, -(omega**2) * q, omega**2 * v]
        return np.array(state)[:, None], np.array(rate)[:, None]

    stepper, size = Stepper(swing, Scheme(1.0, 1.0, 0.5), 1e-13, None, h), np.array([[1.0], [omega], [omega**2]])
    predicted = 2 * exact(h)[1] - exact(0.0)[1]
    result = stepper.step(*exact(h), h, h, predicted)
    error = float((abs(result[0] - exact(2 * h)[0]) / size).max())
    control = StepControl(swing, h, share * error, stepper.scheme.error_constant())
    control.size = size
    assert not control.accept(result, h, *exact(h), predicted, (h, exact(0.0)[1]))
    assert control.h == pytest.approx(0.9 * h * share ** (1 / 3), rel=0.03)


def test_drift_control_takes_an_offset_back():
    """An end that runs away by itself: the hold learns its rate; after twelve intervals 1 % of the offset is left."""
    offset, growth, before = np.array([1.0]), 0.3, np.zeros(1)
    hold = PositionDriftControl(
        SimpleNamespace(drift=lambda y, t: offset, settling_time=lambda: 0.0, drift_gain=lambda: 1.0), 1.0
    )
    for k in range(12):
        correction = hold(None, float(k), 1.0)
        offset, before = offset + growth + (before + correction) / 2, correction
    assert abs(offset[0]) <= 0.01
    assert correction[0] == pytest.approx(-growth, abs=0.01)
