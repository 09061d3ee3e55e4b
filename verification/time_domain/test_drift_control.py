"""Is the velocity that takes an end back the one of the rule, at the instants of the rule?"""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from solvers.time_domain.drift_control import MeanDriftControl, PositionDriftControl

GAIN = 0.4


def chain(period=None, settling=2.0):
    """Return a chain whose state is its drift."""
    return SimpleNamespace(drift=lambda y, t: y, settling_time=lambda: settling, drift_gain=lambda: GAIN, period=period)


def at(*values):
    """Return an offset (n_d,), m."""
    return np.array(values, dtype=float)


# ---------------------------------------------------------------- the position, at every step
def test_a_correction_begins_at_once_and_grows_over_the_settling_time():
    """-gain x / (2 x 2 s) after 2 s, in proportion before, and no more later; the same when a step is tried again."""
    control = PositionDriftControl(chain(), 0.5)
    asked = -GAIN * at(0.1, -0.3) / 4
    for t, h, part in ((0.0, 0.5, 0.25), (0.0, 0.5, 0.25), (0.0, 1.0, 0.5), (0.5, 0.5, 0.5), (1.0, 0.7, 0.85)):
        assert control(at(0.1, -0.3), t, h) == pytest.approx(part * asked)
    assert control(at(9.0, 9.0), 1.5, 0.9) == pytest.approx(asked)


def test_an_interval_is_no_shorter_than_a_step():
    control = PositionDriftControl(chain(settling=0.1), 0.5)
    assert control(at(0.1), 0.0, 0.5) == pytest.approx(-GAIN * at(0.1) / (2 * 0.5))


@pytest.mark.parametrize("end", [1.76, 2.0, 2.2])
def test_the_next_correction_takes_the_growth_into_account(end):
    """From half a step before the end of the interval: what the offset grew by, less what the correction added."""
    control = PositionDriftControl(chain(), 0.5)
    control(at(0.1), 0.0, 0.5)
    assert control(at(0.3), 1.7, 0.5) == pytest.approx(-GAIN * at(0.1) / 4)  # too early: 1.7 s < 2 s - 0.5 s / 2
    reached = min(1.0, end / 2) * -GAIN * at(0.1) / 4
    rate = GAIN * ((at(0.3) - at(0.1)) / end - reached / 2)
    asked = -rate - GAIN * at(0.3) / 4
    assert control(at(0.3), end, 0.5) == pytest.approx(reached + 0.25 * (asked - reached))
    assert control(at(0.3), end + 1.0, 0.5) == pytest.approx(reached + 0.75 * (asked - reached))
    rate += GAIN * ((at(0.2) - at(0.3)) / 2 - (reached + asked) / 2 - rate)
    last = -rate - GAIN * at(0.2) / 4
    assert control(at(0.2), end + 2.0, 0.5) == pytest.approx(asked + 0.25 * (last - asked))


# ---------------------------------------------------------------- the mean, once a period
def test_the_mean_over_a_period_is_taken_back_over_two():
    """Of steps of unequal length, in whose ends the offset is taken; with all of it, and the growth in that time."""
    control = MeanDriftControl(chain(period=4.0), 0.5)
    for t, h, offset in ((0.0, 1.0, 9.0), (1.0, 2.0, 0.2), (1.0, 0.5, 0.2), (3.0, 1.0, 0.6)):
        assert control(at(offset), t, h) == pytest.approx(0.0)
    mean = at((1.0 * 0.2 + 2.0 * 0.6 + 1.0 * 0.4) / 4.0)
    first = control(at(0.4), 4.0, 1.0)
    assert first == pytest.approx(-mean / (2 * 4.0))
    for t, offset in ((5.0, 0.5), (6.0, 0.5), (7.0, 0.5)):
        assert control(at(offset), t, 1.0) == pytest.approx(first)
    rate = (at(0.5) - mean) / 4.0 - first / 2
    assert control(at(0.5), 8.0, 1.0) == pytest.approx(-rate - at(0.5) / 8.0)


@pytest.mark.parametrize(("t", "ended"), [(3.7, False), (3.74, False), (3.76, True), (4.2, True)])
def test_a_period_ends_within_half_a_step(t, ended):
    """With a step of 0.5 s: from 3.75 s on."""
    control = MeanDriftControl(chain(period=4.0), 0.5)
    control(at(1.0), 0.0, t)
    assert bool(control(at(1.0), t, 0.5) != 0.0) is ended
