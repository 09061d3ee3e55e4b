"""The history of a time integration: states at the stored times, what lies between them, and warnings."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ..common import diagnostics
from ..common.outcome import Outcome, Status
from ..common.response import Response, last_period, within_history
from ..numerics.chain import ChainSystem


@dataclass(frozen=True, repr=False)
class TimeHistory(Response, Outcome):
    """Motion over time: time (K,) s; y, ydot (n_f, N, K); Newton iterations and factorisations in total.

    residual_norm: mean |dy| of the last Newton step, HB (76). steps taken, and rejected by the step control.
    event: (time in s, node from 0) where the status arose, None on success. moved: the system with its ramp.
    hold: what kept the last node from drifting, as given. ramp: time over which the motion grew from rest, s.
    failed_ramp: the default ramp of half a period, s, where the integration failed with it and a longer one was taken.
    repeat: integrates another system with the same settings, from rest.
    """

    system: ChainSystem = field(repr=False)
    ramped_system: ChainSystem = field(repr=False)
    time: np.ndarray = field(repr=False)
    y: np.ndarray = field(repr=False)
    ydot: np.ndarray = field(repr=False)
    status: Status
    iterations: int
    factorisations: int
    residual_norm: float
    steps: int
    rejected: int
    event: tuple[float, int] | None = None
    hold: str | None = None
    ramp: float = 0.0
    failed_ramp: float | None = None
    repeat: Callable | None = field(repr=False, default=None, compare=False)

    @property
    def last_period(self) -> tuple[float, float]:
        """Start of the last whole period that is stored, and the period, s. Raises InputError without one."""
        return last_period(self.time, self.system.period)

    def at(self, t: ArrayLike) -> np.ndarray:
        """State at times t (S,) in s, (n_f, N, S): cubic between the stored times. Raises InputError outside them."""
        return self._cubic(t, 0)

    def rate_at(self, t: ArrayLike) -> np.ndarray:
        """Rate of the state at times t (S,) in s, (n_f, N, S)."""
        return self._cubic(t, 1)

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        """What a cable's history has lost: drift, compression between steps, steps too long, not periodic yet."""
        return tuple(diagnostics.check_history(self))

    def drift(self) -> np.ndarray:
        """Distance of the last node from its prescribed place at the stored times, (K,), m."""
        return np.linalg.norm(self.ramped_system.drift(self.y, self.time), axis=0)  # type: ignore[arg-type]

    def _cubic(self, t, order):
        """Hermite's cubic through y and ydot, or its first derivative."""
        time = self.time
        t = within_history(t, time)
        i = np.clip(np.searchsorted(time, t, side="right") - 1, 0, time.size - 2)
        h = time[i + 1] - time[i]
        x = (t - time[i]) / h
        if order == 0:
            weights = (1 - x) ** 2 * (1 + 2 * x), x * x * (3 - 2 * x), h * x * (1 - x) ** 2, h * x * x * (x - 1)
        else:
            weights = -6 * x * (1 - x) / h, 6 * x * (1 - x) / h, (1 - x) * (1 - 3 * x), x * (3 * x - 2)
        parts = self.y[..., i], self.y[..., i + 1], self.ydot[..., i], self.ydot[..., i + 1]
        return sum(weight * part for weight, part in zip(weights, parts, strict=True))
