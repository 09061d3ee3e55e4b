"""Outputs by time that a time history and a periodic response of a cable share."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from .outcome import InputError
from .validation import real_array

_SAMPLES = 64  # in a period for each harmonic asked for: the interpolated tension then has no alias above 1e-6


class Response:
    """Mixin of results with ``system``, ``time`` (K,), ``y`` and ``ydot`` (n_f, N, K), at(t), rate_at(t), last_period.

    Forces are those of the line on what holds it, in N, public frame.
    """

    system: Any  # a chain with ``tension``, ``positions`` and ``direction``
    if TYPE_CHECKING:  # of the class of the result
        y: Any
        ydot: Any
        last_period: Any
        at: Any
        rate_at: Any

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
        try:
            t = real_array(t)
        except (TypeError, ValueError):
            raise InputError(f"{t!r} must be real numbers (s)", field="t", value=t, unit="s") from None
        flat = np.atleast_1d(t).ravel()
        return self.system.tension(self.at(flat), self.rate_at(flat))[-1].reshape(t.shape)

    def tension_harmonics(self, k: int) -> np.ndarray:
        """Return mean and amplitudes of harmonics 1..k of the fairlead tension over the last period, (k + 1,), N."""
        first, period = self.last_period
        n = _SAMPLES * (k + 1)
        spectrum = np.fft.rfft(self.fairlead_tension(first + period * np.arange(n) / n)) / n
        return np.concatenate([[spectrum[0].real], 2 * abs(spectrum[1 : k + 1])])
