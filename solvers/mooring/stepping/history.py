"""Results of moving lines over time, and what they say of slack."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from scipy.interpolate import PchipInterpolator, PPoly

from ...common.outcome import InputError, Outcome, Status
from ...common.response import Response, describe_range, last_period, within_history
from .. import diagnostics
from ..lines.coarsening import common_nodes
from ..lines.prescribed_motion import reference_point

_STENCIL = 6  # points of the polynomials between steps
_UNEVEN = 1e-5  # of a step, by which the last one must differ to count as shorter
_BEFORE = 2  # of these before the interval, and the place of zero: small powers leave little rounding
_LAGRANGE = np.linalg.inv(np.vander(np.arange(_STENCIL) - _BEFORE, _STENCIL, increasing=True))
"""Column j: coefficients of the polynomial that is one at the j-th of the points -2..3 and zero at the others."""


class Slack(NamedTuple):
    """A time in which some cell is slack: start and end in s, the cells that ever are (indices from the anchor)."""

    start: float
    end: float
    cells: tuple[int, ...]


class EndForces(Response):
    """Outputs of a line between two ends, from its end_force(end): on what holds its anchor (0) or fairlead (-1)."""

    if TYPE_CHECKING:  # of the class of the result
        end_force: Any

    @property
    def fairlead_force(self) -> np.ndarray:
        """Force on what holds the fairlead end at the stored times, (3, K), N."""
        return self.end_force(-1)

    @property
    def anchor_force(self) -> np.ndarray:
        """Force on what holds the anchor end at the stored times, (3, K), N."""
        return self.end_force(0)


class MooringOutputs(EndForces):
    """Outputs over time that a history and a periodic response of moving lines share.

    system, time (K,), y, ydot, yddot (n, N, K). Forces are those of the lines on what holds them, N, public frame.
    Of a network ``elements`` has the outputs of each; what names the fairlead or the anchor is that of a single line.
    """

    if TYPE_CHECKING:  # of the class of the result
        time: Any
        yddot: Any
        end_tension_at: Any

    def describe(self):
        """Yield how long the result is, and extremes of the fairlead tension, of a network that of the worst line."""
        cells = self.system.line.length.size
        yield f"{cells} cells, {self.time.size} instants to t = {self.time[-1]:.6g} s"
        tensions = [np.linalg.norm(line.fairlead_force, axis=0) for line in self.lines]
        worst = max(range(len(tensions)), key=lambda e: tensions[e].max())
        name = "fairlead tension" if self.system.model.is_line else f"elements[{worst}], the most loaded: tension"
        yield describe_range(name, tensions[worst])

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

    def end_force(self, end) -> np.ndarray:
        """Force on what holds the anchor (0) or the fairlead (-1) at the stored times, (3, K), N."""
        return self._of_line(self.forces)[:, end]

    def _of_line(self, value):
        if not self.system.model.is_line:
            problem = "a network has as many as coupled nodes; ask its elements[i], or body_force"
            raise InputError(problem, field="fairlead")
        return value

    def _tension_at(self, t) -> np.ndarray:
        """Return the size of the force on the vessel at times t (S,) in s, N."""
        return self._of_line(self).end_tension_at(t, -1)

    @cached_property
    def elements(self) -> tuple[ElementOutputs, ...]:
        """Outputs of each element, in the order of the network; a Scene is one element."""
        return tuple(ElementOutputs(self, e) for e in range(len(self.system.model.segments)))

    @property
    def lines(self) -> tuple:
        """This result where it is that of one line, else its elements: each with a fairlead and an anchor."""
        return (self,) if self.system.model.is_line else self.elements

    @property
    def body_force(self) -> np.ndarray:
        """Sum of the forces on the coupled nodes at the stored times, (3, K), N."""
        return self.forces[:, self.system.coupled_nodes].sum(axis=1)

    @property
    def body_moment(self) -> np.ndarray:
        """Moment of the forces on the coupled nodes about the moved reference point of the body, (3, K), N m.

        That of the BodyMotion; of another motion the point that it moves from the origin of the public frame.
        """
        motion, nodes = getattr(self, "ramped_system", self.system).motion, self.system.coupled_nodes
        arms = self.system.positions(self.y[:, nodes]) - reference_point(motion, self.time)[:, None]
        return np.cross(arms, self.forces[:, nodes], axis=0).sum(axis=1)


class ElementOutputs(EndForces):
    """Outputs over time of one element of a network: forces at its ends, tensions of its cells.

    result: the history or response of the network, whose success it shares; index: of the element; the force at an end
    is that of the element alone, without what else its node carries.
    """

    def __init__(self, result, index):
        self.result, self.index, self.system = result, index, result.system
        self.time, self.success = result.time, result.success

    @property
    def last_period(self) -> tuple[float, float]:
        """Start of the last whole period, and the period, s. Raises InputError without one."""
        return self.result.last_period

    def end_force(self, end) -> np.ndarray:
        """Force on what holds the anchor end (0) or the fairlead end (-1) at the stored times, (3, K), N."""
        result = self.result
        force = self.system.end_force(result.y, result.ydot, result.yddot, end, self.index)
        return np.einsum("dc,kd->ck", self.system.axes, force)

    @property
    def tension(self) -> np.ndarray:
        """Tension of the cells of the element at the stored times, from the anchor end, (cells, K), N."""
        return self.result.tension[self.system.layout.cells[self.index]]

    @property
    def r(self) -> np.ndarray:
        """Positions of the nodes of the element at the stored times, from the anchor end, (3, nodes, K), m."""
        return self.system.positions(self.result.y[:, self.system.layout.nodes[self.index]])

    def _tension_at(self, t) -> np.ndarray:
        return self.result.end_tension_at(t, -1, self.index)

    def anchor_tension(self, t) -> np.ndarray:
        """Return the size of the force on what holds the anchor end at times t (S,) in s, N."""
        return self.result.end_tension_at(np.asarray(t, dtype=float), 0, self.index)


@dataclass(frozen=True, repr=False)
class MooringHistory(MooringOutputs, Outcome):
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
    _end_tensions: dict = field(init=False, repr=False, compare=False, default_factory=dict)

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        """What the mesh, the step or the number of periods has lost; where cells are slack."""
        return tuple(diagnostics.check_history(self))

    def repeat(self, coarser) -> MooringHistory:
        """Return the history of the lines on every second node with the same settings: half of the first run time."""
        settings = dict(self.settings)
        if settings["start"] is not None:
            kept = common_nodes(coarser.layout, self.system.layout)
            settings["start"] = [part if part is None else part[:, kept] for part in settings["start"]]
        return coarser.integrate(**settings)

    @property
    def last_period(self) -> tuple[float, float]:
        """Start of the last whole period that is stored, and the period, s. Raises InputError without one."""
        return last_period(self.time, self.system.period)

    def end_tension_at(self, t, end, element=None) -> np.ndarray:
        """Return the size of the force at an end (0 or -1) of an element at times t (S,) in s, N, between the steps.

        element None: of a line, what its first or last node leaves. By polynomials of degree five through six equal
        steps; by monotone cubics, which do not overshoot, where a cell went slack, the steps are few or the last one
        stored is shorter.
        """
        if (end, element) not in self._end_tensions:
            force = self.system.end_force(self.y, self.ydot, self.yddot, end, element)
            self._end_tensions[end, element] = self._interpolant(np.sqrt((force * force).sum(axis=1)))
        return self._end_tensions[end, element](within_history(t, self.time))

    def _interpolant(self, tension):
        """Return the function of times (S,) in s that ``end_tension_at`` describes, of tensions (K,) at the steps."""
        time = self.time
        dt, last = float(time[1] - time[0]), float(time[-1] - time[-2])
        if self.damped_from is not None or time.size < _STENCIL or abs(dt - last) > _UNEVEN * last:
            return PchipInterpolator(time, tension)
        coefficients = _LAGRANGE @ np.lib.stride_tricks.sliding_window_view(tension, _STENCIL).T
        polynomials = PPoly(coefficients[::-1], np.arange(_BEFORE, time.size - _STENCIL + _BEFORE + 2))
        return lambda t: polynomials(t / dt)

    @cached_property
    def slack(self) -> tuple[Slack, ...]:
        """The times in which some cell is slack, as the stored times show them; slack is no failure."""
        loose = self.tension <= 0
        some = np.concatenate([[False], loose.any(axis=0), [False]])
        starts, ends = np.flatnonzero(some[1:] & ~some[:-1]), np.flatnonzero(some[:-1] & ~some[1:]) - 1
        spells = zip(starts.tolist(), ends.tolist(), strict=True)
        which = lambda a, b: tuple(np.flatnonzero(loose[:, a : b + 1].any(axis=1)).tolist())
        return tuple(Slack(float(self.time[a]), float(self.time[b]), which(a, b)) for a, b in spells)
