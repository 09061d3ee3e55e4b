"""Outputs by time that a time history and a periodic response of a cable share."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from .diagnostics import largest_change
from .outcome import ConvergenceError, InputError
from .validation import array_of_reals

ROUNDING = 1e-12  # of a duration, that rounding may leave
_SAMPLES = 64  # in a period for each harmonic asked for: the interpolated tension then has no alias above 1e-6


def within_history(t, time) -> np.ndarray:
    """Return times t in s as an array; raises InputError outside those that are stored, time (K,)."""
    t, rounding = np.asarray(t, dtype=float), ROUNDING * time[-1]
    within = (t >= time[0] - rounding) & (t <= time[-1] + rounding)
    if not np.all(within):
        problem = f"{t[~within].flat[0]:g} s is outside the history, {time[0]:g} to {time[-1]:g} s"
        raise InputError(problem, field="t", value=t, unit="s")
    return t


def last_period(time, period) -> tuple[float, float]:
    """Return the start of the last whole period that is stored at time (K,), and the period, s. InputError without."""
    if period is None or time[-1] - time[0] < period * (1 - ROUNDING):
        problem = f"{time[-1] - time[0]:g} s are stored, no whole period ({period} s)"
        raise InputError(problem, field="time", value=time, unit="s")
    return max(time[0], time[-1] - period), period


def describe_range(name: str, values) -> str:
    """Return words for forces over time (K,) in N: the least, mean and greatest."""
    return f"{name} {values.min():.6g} to {values.max():.6g} N, mean {values.mean():.6g} N"


class Response:
    """Mixin of results with ``system``, ``time`` (K,), ``y`` and ``ydot`` (n_f, N, K), at(t), rate_at(t), last_period.

    Forces are those of the line on what holds it, in N, public frame.
    """

    system: Any  # a chain with ``tension``, ``positions`` and ``direction``
    if TYPE_CHECKING:  # of the class of the result
        time: Any
        y: Any
        ydot: Any
        last_period: Any
        at: Any
        rate_at: Any

    repeat: Any = None  # solves for another system with the same settings, or None
    coarse: Any = None  # the result on half as many cells, where it is known
    correction: float | None = None  # mean |dz| of a deferred correction

    def field(self, name: str) -> np.ndarray:
        """Return one of ``system.fields`` at stored times, (N, K): u, v, w in m/s, phi, theta in rad, z in m."""
        return self.y[self.system.fields.index(name)]

    @cached_property
    def tension(self) -> np.ndarray:
        """Tension at the nodes and stored times, (N, K), N."""
        return self.system.tension(self.y, self.ydot)

    @cached_property
    def r(self) -> np.ndarray:
        """Positions of the nodes at the stored times, (3, N, K), m."""
        return self.system.positions(self.y)

    @cached_property
    def mesh_error(self) -> float | None:
        """Rms change of the fairlead tension that half as many nodes make, over its range; None where that fails.

        Of a network the largest of its elements. Over the last period, or the second half of a history; about three
        times the error of the mesh where the response is smooth. Solved for when first asked, unless ``coarse`` is
        there, or a history of a chain began at a given state; None after a deferred correction, whose size tells it.
        """
        if self.coarse is not None:
            return largest_change(self, self.coarse)
        coarser = self.system.coarser() if self.correction is None and self.repeat is not None else None
        try:
            return None if coarser is None else largest_change(self, self.repeat(coarser[0]))
        except ConvergenceError:  # the coarser chain has no equilibrium
            return None

    @property
    def lines(self) -> tuple:
        """This result where it is that of one line, else its elements: each with a fairlead and an anchor."""
        return (self,)

    def describe(self):
        """Yield how long the result is, and the extremes of its fairlead tension."""
        yield f"{self.y.shape[1]} nodes, {self.time.size} instants to t = {self.time[-1]:.6g} s"
        if hasattr(self.system, "tension"):
            yield describe_range("fairlead tension", self.tension[-1])

    @property
    def fairlead_force(self) -> np.ndarray:
        """Force on the vessel at the stored times, (3, K), N."""
        return -self.tension[-1] * self.system.direction(self.y[:, -1:])[:, 0]

    @property
    def anchor_force(self) -> np.ndarray:
        """Force on the anchor at the stored times, (3, K), N."""
        return self.tension[0] * self.system.direction(self.y[:, :1])[:, 0]

    def fairlead_tension(self, t: ArrayLike) -> np.ndarray:
        """Return the fairlead tension at times t in s, any shape, N; raises InputError outside the history."""
        t = array_of_reals("t", t, f"{t!r} must be real numbers (s)", "s")
        return self._tension_at(np.atleast_1d(t).ravel()).reshape(t.shape)

    def _tension_at(self, t) -> np.ndarray:
        """Return the fairlead tension at times t (S,) in s, (S,), N."""
        return self.system.tension(self.at(t), self.rate_at(t))[-1]

    def tension_harmonics(self, k: int) -> np.ndarray:
        """Return mean and amplitudes of harmonics 1..k of the fairlead tension over the last period, (k + 1,), N."""
        first, period = self.last_period
        n = _SAMPLES * (k + 1)
        spectrum = np.fft.rfft(self.fairlead_tension(first + period * np.arange(n) / n)) / n
        return np.concatenate([[spectrum[0].real], 2 * abs(spectrum[1 : k + 1])])
