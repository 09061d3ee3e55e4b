"""What keeps the last node of a chain where it is prescribed, although the rows of the end see velocities only."""

from __future__ import annotations

import numpy as np

from ..common.outcome import InputError
from ..common.validation import one_of

_STEPS_TO_RETURN = 2  # steps (or periods) in which an offset is taken back: the loop's spectral radius is then 1/2


class PositionDriftControl:
    """Velocity that returns the last node to its prescribed place: it cancels the offset and the rate of its growth.

    The rows of the end see velocities only; what space and time discretisation make of their integral is the drift.
    dt: the longest step, s. The velocity changes linearly from its last value to the one that the last offset asks
    for, over an interval no shorter than the settling time of the chain: a sudden correction would excite axial waves.
    On a coarse chain a full correction would feed its waves: ``gain`` is the fraction that is safe.
    """

    def __init__(self, system, dt):
        self.system, self.interval, self.gain = system, max(dt, system.settling_time()), system.drift_gain()
        self.t, self.offset, self.rate = 0.0, None, 0.0
        self.correction = self.previous = 0.0  # at the end and at the start of the interval last passed

    def __call__(self, y, t, h) -> np.ndarray:
        """Return the correction (n_d,) of the velocity at t + h, m/s; the same when a step is tried again from t."""
        if t >= self.t + self.interval - 0.5 * h or self.offset is None:
            self.correction = self._interpolate(t)  # an interval may end a little early or late
            self.update(self.system.drift(y, t), t - self.t)
            self.t = t
        return self._interpolate(t + h)

    def _interpolate(self, t):
        return self.previous + min(1.0, (t - self.t) / self.interval) * (self.correction - self.previous)

    def update(self, offset, elapsed):
        """Estimate the rate at which the offset grows by itself from its change over ``elapsed``, and correct both."""
        if self.offset is not None:
            rate = (offset - self.offset) / elapsed - (self.correction + self.previous) / 2
            self.rate = self.rate + self.gain * (rate - self.rate)
        self.previous, self.offset = self.correction, offset
        self.correction = -self.rate - self.gain * (offset / (_STEPS_TO_RETURN * self.interval))


class MeanDriftControl(PositionDriftControl):
    """The same for the mean over a period, as ``solve_periodic`` closes it: the velocity changes once a period.

    Within a period the end moves as the rows of the chain say, so this is the time integration of the same equations.
    """

    def __init__(self, system, dt):
        super().__init__(system, system.period)
        self.gain = 1.0  # the mean over a period does not see waves
        self.sum, self.ends = 0.0, system.period

    def __call__(self, y, t, h) -> np.ndarray:
        """As PositionDriftControl."""
        if t > self.t:
            self.sum, self.t = self.sum + (t - self.t) * self.system.drift(y, t), t
        if t >= self.ends - 0.5 * h:
            self.update(self.sum / self.interval, self.interval)
            self.sum, self.ends = 0.0, self.ends + self.interval
        return self.correction  # type: ignore[return-value]


DRIFT_CONTROLS = {"position": PositionDriftControl, "mean": MeanDriftControl, None: None}


def check_hold(system, hold):
    """Raise InputError where ``hold`` names no drift control, or one that the motion of the system does not allow."""
    one_of("hold", hold, DRIFT_CONTROLS)
    if hold == "mean" and system.period is None:
        raise InputError("'mean' takes a motion with a period; use 'position'", field="hold", value=hold)
