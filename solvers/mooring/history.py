"""Results of a moving line over time, and what they say of slack."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from scipy.interpolate import PchipInterpolator

from ..common.diagnostics import relative_change
from ..common.outcome import Outcome, Status
from ..common.response import Response, last_period, within_history
from . import diagnostics

_STENCIL = 6  # points of the polynomials between steps
_LAGRANGE = np.linalg.inv(np.vander(np.arange(_STENCIL), _STENCIL, increasing=True))
"""Column j: coefficients of the polynomial that is one at j and zero at the other points 0..5."""


class Slack(NamedTuple):
    """A time in which some cell is slack: start and end in s, the cells that ever are (indices from the anchor)."""

    start: float
    end: float
    cells: tuple[int, ...]


class LineOutputs(Response):
    """Outputs over time that a history and a periodic response of a moving line share.

    system, time (K,), y, ydot, yddot (n, N, K). Forces are those of the line on what holds it, N, public frame.
    """

    if TYPE_CHECKING:  # of the class of the result
        yddot: Any

    @cached_property
    def _forces(self):
        return self.system.forces(self.y, self.ydot, self.yddot)

    @property
    def forces(self) -> np.ndarray:
        """Force on what holds each node at the stored times, (3, N, K), N; at free nodes what the steps left."""
        return self._forces[0]

    @property
    def tension(self) -> np.ndarray:
        """Tension of the cells at the stored times, (C, K), N."""
        return self._forces[1]

    @property
    def fairlead_force(self) -> np.ndarray:
        """Force on the vessel at the stored times, (3, K), N."""
        return self.forces[:, -1]

    @property
    def anchor_force(self) -> np.ndarray:
        """Force on the anchor at the stored times, (3, K), N."""
        return self.forces[:, 0]


@dataclass(frozen=True)
class MooringHistory(LineOutputs, Outcome):
    """Motion over time: time (K,) s; y, ydot, yddot (n, N, K): coordinates of the nodes in m, their rates.

    residual_norm: error of the last Newton step, the largest change of a tension or position, over the greatest tension
    at rest or the length. steps taken; cut: how often a step was taken again in more parts; damped_from: time in s
    from which the steps damp the shortest waves at once, for a cell went slack. ramp: time over which the motion grew
    from rest, s. event: (time in s, node) where a step failed however short, None on success.
    settings: of ``MooringSystem.integrate``.
    """

    system: Any = field(repr=False)
    ramped_system: Any = field(repr=False)
    time: np.ndarray = field(repr=False)
    y: np.ndarray = field(repr=False)
    ydot: np.ndarray = field(repr=False)
    yddot: np.ndarray = field(repr=False)
    status: Status
    iterations: int
    factorisations: int
    residual_norm: float
    steps: int
    cut: int
    damped_from: float | None = None
    ramp: float = 0.0
    event: tuple[float, int] | None = None
    settings: dict = field(repr=False, default_factory=dict)

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        """What the mesh, the step or the number of periods has lost; where cells are slack."""
        return tuple(diagnostics.check_history(self))

    @cached_property
    def mesh_error(self) -> float | None:
        """Rms change of the fairlead tension that half as many cells make, over its range; None where that fails.

        Over the last period, or the second half of the history; about three times the error of the mesh where the
        response is smooth. Integrates the line on every second node when first asked: half of the first run time.
        """
        coarser = self.system.coarser()
        if coarser is None:
            return None
        settings = dict(self.settings)
        if settings["start"] is not None:
            kept = self.system.nodes_of_coarser(coarser[0])
            settings["start"] = [part if part is None else part[:, kept] for part in settings["start"]]
        return relative_change(self, coarser[0].integrate(**settings))

    @property
    def last_period(self) -> tuple[float, float]:
        """Start of the last whole period that is stored, and the period, s. Raises InputError without one."""
        return last_period(self.time, self.system.period)

    @cached_property
    def _end_tension(self):
        return np.linalg.norm(self.system.end_force(self.y, self.ydot, self.yddot, -1), axis=1)

    @cached_property
    def _monotone(self):
        return PchipInterpolator(self.time, self._end_tension)

    def _tension_at(self, t) -> np.ndarray:
        """Return the size of the force on the vessel at times t (S,) in s, interpolated between the steps, N.

        By polynomials of degree five through six equal steps; by monotone cubics, which do not overshoot, where a cell
        went slack, the steps are few or the last one stored is shorter.
        """
        t, time = within_history(t, self.time), self.time
        is_even = time.size >= _STENCIL and np.isclose(time[1] - time[0], time[-1] - time[-2])
        if self.damped_from is not None or not is_even:
            return self._monotone(t)
        place = t / (time[1] - time[0])
        first = np.clip(place.astype(int) - _STENCIL // 2 + 1, 0, time.size - _STENCIL)
        powers = np.vander((place - first).ravel(), _STENCIL, increasing=True)
        weights = (powers @ _LAGRANGE).reshape(*place.shape, _STENCIL)
        return (weights * self._end_tension[first[..., None] + np.arange(_STENCIL)]).sum(axis=-1)

    @cached_property
    def slack(self) -> tuple[Slack, ...]:
        """The times in which some cell is slack, as the stored times show them; slack is no failure."""
        loose = self.tension <= 0
        some = np.concatenate([[False], loose.any(axis=0), [False]])
        starts, ends = np.flatnonzero(some[1:] & ~some[:-1]), np.flatnonzero(some[:-1] & ~some[1:]) - 1
        cells = (
            tuple(np.flatnonzero(loose[:, a : b + 1].any(axis=1)).tolist()) for a, b in zip(starts, ends, strict=True)
        )
        return tuple(
            Slack(float(self.time[a]), float(self.time[b]), which)
            for a, b, which in zip(starts, ends, cells, strict=True)
        )
