"""Prescribed motion: velocity and acceleration are the derivatives of the displacement; bad series are refused."""

from __future__ import annotations

import numpy as np
import pytest

from solvers import FunctionMotion, InputError, Motion, SampledMotion
from solvers.common.motions.motion import Ramped

from ..reference import EPS

STEP = 1e-30  # of a complex step: its error is the rounding of the derivative
DERIVATIVE = 1e-13  # relative: a few roundings of sums of sines
DIFFERENCES = 2e-7  # relative, of central differences: (h w)^2 / 6, h = 1e-5 of 31 s and w up to 1.8 rad/s, is 5e-8
CUBIC = 1e-12  # relative: the spline through samples of a cubic is that cubic, its system solved in doubles

rng = np.random.default_rng(20190101)
PERIODIC = Motion(0.07, rng.normal(size=(4, 3)), rng.normal(size=(4, 3)))
SERIES = SampledMotion(np.sort(rng.uniform(0, 60, 40)), rng.normal(size=(40, 3)))
MOTIONS = {
    "periodic": PERIODIC,
    "sampled": SERIES,
    "ramped": Ramped(PERIODIC, 11.0),
    "ramped series": Ramped(SERIES, 30.0),
}


@pytest.mark.parametrize("motion", MOTIONS.values(), ids=MOTIONS)
def test_rates_are_derivatives(motion):
    """Velocity and acceleration are the complex-step derivatives of displacement and velocity, at one time and many."""
    t = np.linspace(SERIES.time[0], SERIES.time[-1], 57)[1:-1]
    for value, rate in ((motion.displacement, motion.velocity), (motion.velocity, motion.acceleration)):
        expected = value(t + 1j * STEP).imag / STEP
        np.testing.assert_allclose(rate(t), expected, rtol=0, atol=DERIVATIVE * abs(expected).max())
        np.testing.assert_allclose(rate(float(t[5])), rate(t)[:, 5], rtol=0, atol=DERIVATIVE * abs(expected).max())


def test_a_series_goes_through_its_samples():
    """At the times of a series the motion is its samples, from either side."""
    rng = np.random.default_rng(11)
    series = SampledMotion(np.sort(rng.uniform(0, 60, 20)), rng.normal(size=(20, 3)))
    assert abs(series.displacement(series.time) - series.samples.T).max() <= 100 * EPS
    before = series.displacement(series.time[1:] * (1 - 1e-9))
    assert abs(before - series.samples[1:].T).max() <= 1e-6  # some 10 m/s for 6e-8 s


def test_harmonic_motion_is_a_sine_with_phase():
    """Motion.harmonic is amplitude sin(2 pi f t + phase) in each direction."""
    amplitude, phase, t = np.array([1.0, 2.0, 0.5]), np.array([0.3, -1.0, 2.0]), np.array([0.0, 0.9, 7.0])
    motion = Motion.harmonic(0.2, amplitude, phase)
    expected = amplitude[:, None] * np.sin(0.4 * np.pi * t + phase[:, None])
    np.testing.assert_allclose(motion.displacement(t), expected, rtol=0, atol=DERIVATIVE)


def test_harmonic_motion_without_a_phase_starts_at_its_place():
    """Every direction is a sine alone."""
    motion = Motion.harmonic(0.2, (1.0, 2.0, 0.5))
    assert not motion.displacement(0.0).any() and not motion.cosine.any()
    np.testing.assert_allclose(motion.displacement(1.25), [1.0, 2.0, 0.5], rtol=DERIVATIVE)


@pytest.mark.parametrize("factor", [2.0, 0.5, -1.0, 0.0])
def test_a_scaled_motion_is_the_motion_times_the_factor(factor):
    t = np.linspace(0.0, 30.0, 17)
    expected = factor * PERIODIC.displacement(t)
    np.testing.assert_allclose(PERIODIC.scaled(factor).displacement(t), expected, rtol=0, atol=1e-13)


def test_series_of_a_cubic_is_that_cubic():
    """A spline with not-a-knot ends reproduces a cubic, values and rates."""
    time = np.array([0.0, 0.7, 1.1, 2.0, 3.5, 4.0])
    coefficients = rng.normal(size=(3, 4))
    cubic = SampledMotion(time, np.array([np.polyval(c, time) for c in coefficients]).T)
    t = np.linspace(0, 4, 23)
    for order, function in enumerate((cubic.displacement, cubic.velocity, cubic.acceleration)):
        expected = np.array([np.polyval(np.polyder(c, order), t) for c in coefficients])
        np.testing.assert_allclose(function(t), expected, rtol=0, atol=CUBIC * abs(expected).max())


def test_ramp_starts_from_rest_and_ends_in_the_motion():
    """At t = 0 displacement, velocity and acceleration vanish; from the duration on they are those of the motion."""
    ramped = MOTIONS["ramped"]
    for name in ("displacement", "velocity", "acceleration"):
        assert not getattr(ramped, name)(0.0).any()
        np.testing.assert_array_equal(getattr(ramped, name)(11.0), getattr(PERIODIC, name)(11.0))
        before = getattr(ramped, name)(11.0 - 1e-9)
        np.testing.assert_allclose(before, getattr(PERIODIC, name)(11.0), rtol=0, atol=1e-7)  # continuous: C2


@pytest.mark.parametrize("t", [4.0, np.array([-1.0, 2.0, 7.0, 30.0])], ids=["one time", "many"])
def test_ramped_functions_have_an_acceleration(t):
    """A function gives no acceleration: that of its ramped motion comes from differences of its rate."""
    function = Ramped(FunctionMotion(PERIODIC.displacement, PERIODIC.velocity), 11.0)
    expected = MOTIONS["ramped"].acceleration(t)
    np.testing.assert_allclose(function.acceleration(t), expected, rtol=0, atol=DIFFERENCES * abs(expected).max())


def test_function_motion_is_its_functions():
    """Times one by one or many at once give what the functions give."""
    motion = FunctionMotion(lambda t: [t, 2 * t, t**2], lambda t: [1.0, 2.0, 2 * t])
    assert motion.displacement([]).shape == motion.velocity([]).shape == (3, 0)  # no time, no value
    np.testing.assert_array_equal(motion.displacement(np.array([1.0, 3.0])), [[1, 3], [2, 6], [1, 9]])
    np.testing.assert_array_equal(motion.velocity(3.0), [1.0, 2.0, 6.0])


def test_directions_span_the_motion_and_no_more():
    """A motion along one line has one direction, in a plane two; a zero motion has none."""
    one = Motion(0.1, [[1.0, 2.0, 0.0], [-2.0, -4.0, 0.0]]).directions()
    np.testing.assert_allclose(abs(one), [[1 / np.sqrt(5), 2 / np.sqrt(5), 0]], atol=1e-15)
    assert Motion.harmonic(0.1, (1.0, 0.0, 2.0), (0.0, 0.0, 1.0)).directions().shape == (2, 3)
    assert Motion(0.1, np.zeros((2, 3))).directions().shape == (0, 3)


BAD = [
    (lambda: Motion(0.0, [[1, 0, 0]]), r"frequency: 0 Hz must be > 0"),
    (lambda: Motion(np.nan, [[1, 0, 0]]), r"frequency: nan Hz must be finite"),
    (lambda: Motion(0.1, [1, 0, 0]), r"sine: shape \(3,\) must be \(n, 3\), n >= 1 rows \[x, y, z\] \(m\)"),
    (lambda: Motion(0.1, [[1, 0, np.inf]]), r"sine\[0, 2\]: inf m must be finite"),
    (lambda: Motion(0.1, [[1, 0, 0]], np.zeros((2, 3))), r"cosine: shape \(2, 3\) must be that of sine, \(1, 3\)"),
    (lambda: Motion.harmonic(0.1, (1.0, 0.0)), r"amplitude: \(1.0, 0.0\) must be three components"),
    (lambda: PERIODIC.scaled("2"), r"factor: '2' must be a real number"),
    (lambda: SampledMotion([0, 1, 1], np.zeros((3, 3))), r"time: must increase \(s\), and 1 follows 1 at index 2"),
    (lambda: SampledMotion([0, 2, 1], np.zeros((3, 3))), r"time: must increase \(s\), and 1 follows 2 at index 2"),
    (lambda: SampledMotion([0, np.nan], np.zeros((2, 3))), r"time\[1\]: nan s must be finite"),
    (lambda: SampledMotion([0, 1], [[0, 0, 0], [0, np.nan, 0]]), r"samples\[1, 1\]: nan m must be finite"),
    (lambda: SampledMotion([0, 1, 2], np.zeros((2, 3))), r"time: shape \(3,\) \(s\) must be \(2,\), one for each row"),
    (lambda: SampledMotion([0], np.zeros((1, 3))), r"samples: shape \(1, 3\) must be \(n, 3\), n >= 2"),
    (lambda: SampledMotion([0, 1], [[0, 0, 0], [0, 0]]), r"samples: rows of different lengths"),
    (lambda: SERIES.velocity(61.0), r"time: 61 s lies outside the series, "),
    (lambda: FunctionMotion(3.0, lambda t: 0), r"position: 3.0 must be a function of time \(s\)"),
    (lambda: FunctionMotion(lambda t: [0, 0], lambda t: [0, 0, 0]).displacement(2.0), r"position: .* at 2 s must be"),
    (lambda: Ramped(PERIODIC, -1.0), r"duration: -1 s must be > 0"),
]  # fmt: skip


@pytest.mark.parametrize(("make", "message"), BAD, ids=[message[:24] for _, message in BAD])
def test_bad_motion_is_refused(make, message):
    """What is wrong is refused with the field, its value or shape and its unit."""
    with pytest.raises(InputError, match=message):
        make()
