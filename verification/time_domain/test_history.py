"""Does a history hold what was asked for: its times, its interpolation, its last period, its ramp?"""

from __future__ import annotations

import math

import numpy as np
import pytest

from solvers import InputError, Status, solve_time_domain

from ..cases.oscillators import duffing, towed_chain

OMEGA = 0.7
PERIOD = 2 * math.pi / OMEGA
MASS = duffing(OMEGA, 0.3)


@pytest.mark.parametrize(("every", "stored"), [(1, range(41)), (7, (0, 7, 14, 21, 28, 35, 40)), (99, (0, 40))])
def test_every_nth_step_is_stored_and_the_last(every, stored):
    """At equal times that end at the duration, whatever dt would leave over."""
    history = solve_time_domain(MASS, dt=0.251, duration=10.0, every=every)
    assert history.steps == 40 and history.rejected == 0
    assert history.time == pytest.approx(np.array(stored) * 0.25, rel=1e-14)
    assert history.y.shape == history.ydot.shape == (3, 1, len(stored))


def test_between_the_stored_times_it_is_hermites_cubic():
    """Values and rates of cubics, one for each field, are those at any time; outside, a rounding is forgiven."""
    history = solve_time_domain(MASS, dt=0.5, duration=2.0)
    a = np.array([[1.0, -2.0, 0.3, 0.1], [0.0, 1.0, 0.0, -0.2], [2.0, 0.0, -1.0, 0.0]])
    value = lambda t: (a @ [t**0, t, t**2, t**3])[:, None]
    rate = lambda t: (a @ [0 * t, t**0, 2 * t, 3 * t**2])[:, None]
    history.y[...], history.ydot[...] = value(history.time), rate(history.time)
    t = np.array([0.0, 0.1, 0.5, 0.77, 1.999, 2.0, 2.0 + 1e-12, -1e-12])
    assert history.at(t) == pytest.approx(value(t), abs=1e-13)
    assert history.rate_at(t) == pytest.approx(rate(t), abs=1e-12)
    for outside in (-1e-9, 2.0 + 1e-9):
        with pytest.raises(InputError, match=r"^t: .* s is outside the history, 0 to 2 s"):
            history.at([0.5, outside])


def test_the_last_period_is_a_whole_one():
    """From one period before the end; none of a shorter history."""
    first, period = solve_time_domain(MASS, dt=PERIOD / 20, periods=2.5).last_period
    assert (first, period) == (pytest.approx(1.5 * PERIOD), PERIOD)
    assert solve_time_domain(MASS, dt=PERIOD / 20, periods=1).last_period[0] == pytest.approx(0.0, abs=1e-12)
    with pytest.raises(InputError, match=r"^time: .* s are stored, no whole period"):
        _ = solve_time_domain(MASS, dt=PERIOD / 20, periods=0.99).last_period


@pytest.mark.parametrize(("ramp", "taken"), [(None, PERIOD / 2), (0.0, 0.0), (0, 0.0), (0.4, 0.4), (30.0, 30.0)])
def test_the_ramp_is_the_one_asked_for(ramp, taken):
    """Half a period if none is; none from a start of one's own."""
    assert solve_time_domain(MASS, dt=0.5, duration=1.0, ramp=ramp).ramp == taken
    state = np.zeros((3, 1)), np.zeros((3, 1))
    assert solve_time_domain(MASS, dt=0.5, duration=1.0, ramp=ramp, start=state).ramp == (ramp or 0.0)


def test_a_ramp_below_zero_is_refused():
    with pytest.raises(InputError, match=r"^ramp: -0.1 s must be >= 0"):
        solve_time_domain(MASS, dt=0.5, duration=1.0, ramp=-0.1)


def test_a_start_without_a_rate_gets_one():
    """That of the equations: q' = v and m v' = F - c v - p."""
    y = np.array([[0.2], [-0.4], [0.2 + 0.2**3]])
    history = solve_time_domain(MASS, dt=1e-3, duration=1e-3, start=(y, None))
    assert history.ydot[:2, 0, 0] == pytest.approx([-0.4, 0.3 + 0.1 * 0.4 - y[2, 0]], abs=1e-5)
    assert history.success and history.y[:, :, 0] == pytest.approx(y)


def test_a_start_that_has_no_rate_is_a_failed_step():
    """A spring that is stretched beyond doubles: the history is its start, at the time 0."""
    y = np.array([[1e200], [0.0], [0.0]])
    history = solve_time_domain(MASS, dt=0.5, duration=1.0, start=(y, None), throw=False)
    assert history.status is Status.STEP_FAILED and history.event == (0.0, 0)
    assert history.time.tolist() == [0.0] and history.steps == 0
    assert np.array_equal(history.y[..., 0], y) and not history.ydot.any()


def test_progress_is_the_time_reached():
    """After each step, to the end."""
    times = []
    history = solve_time_domain(towed_chain(3), dt=0.5, duration=3.0, progress=times.append)
    assert times == history.time[1:].tolist() == pytest.approx([0.5, 1.0, 1.5, 2.0, 2.5, 3.0])
