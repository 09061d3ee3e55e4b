"""The linearised motion of lines over one period, without its matrix, for Floquet multipliers.

``LinearisedPeriod`` goes about the series of a periodic response by implicit Runge-Kutta steps, ``SteppedPeriod`` about
the motion that time steps gave, by the derivative of these steps. Both factorise all steps once and keep the factors:
memory in proportion to the steps and the cells, 30 MB for 200 steps and 50 cells in a plane.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from .steps import factorise_steps, set_blocks, take_newmark_steps, take_steps

COLUMNS = {1: 32, 2: 16, 3: 12}  # by axes, disturbances that take a period in less than twice the time of one


class PeriodMap:
    """Takes small disturbances of a moving line over a period, by steps that are factorised once.

    size: numbers of a disturbance, those of the free nodes in the axes that are disturbed; columns: of disturbances
    that ``apply`` takes at little more than one. has_slack: whether a cell is slack at some stage of the steps.
    take_steps(state): replaces a state (parts, N, n, k) by that after all steps.
    """

    take_steps: Any

    def __init__(self, system, orbit, sideways, units, weights, weight_of_M, right_weights):
        """orbit: r, v, r'' (S, s, N, m) at the stages of the steps; weights as of ``set_blocks``.

        units: what the parts of a disturbance are multiplied by to be those of the state. sideways: disturb the axis
        across the plane of the motion alone.
        """
        line, orbit, kept = disturbed_axes(system, orbit, sideways)
        (steps, stages, nodes), self.n = orbit[0].shape[:3], kept.size
        cells, edges, block = line.length.size, system.order.edges, stages * self.n
        self.order, self.ends = system.order.with_rows(0), (line.first, line.last)
        self.free = np.flatnonzero(~system.order.is_prescribed)
        self.units, self.columns = np.reshape(units, (-1, 1, 1, 1)), COLUMNS[self.n]
        self.size = len(self.units) * self.n * self.free.size
        self.factors = tuple(np.empty((steps, count, block, block)) for count in (nodes, edges, edges))
        sides = 2 if right_weights[1, :2].any() else 1  # the second disturbance may be in the masses alone
        shapes = (2, nodes), (sides, cells), (sides, cells)
        self.right_side = tuple(np.empty((steps, *shape, block, self.n)) for shape in shapes)
        slack = set_blocks(line, orbit, kept, weights, weight_of_M, right_weights, self.factors, self.right_side)
        factorise_steps(system.order.with_rows(block), *self.factors)
        self.has_slack = slack > 0

    def apply(self, disturbances) -> np.ndarray:
        """Return disturbances (size, k) one period later."""
        columns = disturbances.shape[1]
        state = np.zeros((len(self.units), self.order.is_prescribed.size, self.n, columns))
        state[:, self.free] = disturbances.reshape(-1, self.free.size, self.n, columns)
        state *= self.units
        self.take_steps(state)
        state /= self.units
        return state[:, self.free].reshape(self.size, columns)


class LinearisedPeriod(PeriodMap):
    """Takes small disturbances of a moving line over one period of a MooringResponse.

    A disturbance is (displacement, velocity / omega). scheme: nodes, weights and last weights of an implicit
    Runge-Kutta scheme.
    """

    def __init__(self, response, steps, scheme, sideways=False):
        self.h, stages = response.last_period[1] / steps, scheme.nodes.size
        t = self.h * (np.arange(steps)[:, None] + scheme.nodes).ravel()
        orbit = [part.reshape(steps, stages, *part.shape[1:]) for part in response.motion_at(t)]
        self.updates = scheme.last, scheme.last @ scheme.weights
        A, right_weights = self.h * scheme.weights, np.zeros((2, 3, stages))
        right_weights[0, 0] = right_weights[1, 1] = -1.0  # -K d - (C + h c K) v
        right_weights[1, 0] = -self.h * scheme.nodes
        units = 1.0, response.basis.omega
        super().__init__(response.system, orbit, sideways, units, np.stack([A @ A, A]), 1.0, right_weights)

    def take_steps(self, state):
        """Replace a state (2, N, n, k) by that after all steps."""
        take_steps(self.order, self.ends, self.h, *self.updates, self.factors, self.right_side, *state)


class SteppedPeriod(PeriodMap):
    """Takes small disturbances of the state of generalized-alpha over a period of equal steps of h in s.

    A disturbance is that of r, v / omega, r'' / omega^2 and the algorithmic acceleration a / omega^2. scheme: alpha_m,
    alpha_f, beta, gamma; orbit: r, v, r'' (S, N, m) at the ends of the steps.
    """

    def __init__(self, system, orbit, h, scheme, sideways=False):
        self.h, self.scheme = h, scheme
        alpha_m, alpha_f, beta, gamma = scheme
        weights = np.array([1.0, gamma / (beta * h)]).reshape(2, 1, 1)
        weight_of_M = (1 - alpha_m) / (1 - alpha_f) / (beta * h * h)
        right_weights = np.zeros((2, 3, 1))
        right_weights[0, 1] = right_weights[1, 2] = -1.0  # -C v - M r''
        units = (2 * np.pi / (len(orbit[0]) * h)) ** np.array([0.0, 1.0, 2.0, 2.0])
        orbit = [part[:, None] for part in orbit]
        super().__init__(system, orbit, sideways, units, weights, weight_of_M, right_weights)

    def take_steps(self, state):
        """Replace a state (4, N, n, k) by that after all steps."""
        take_newmark_steps(self.order, self.ends, self.h, self.scheme, self.factors, self.right_side, state)

    def pack(self, state) -> np.ndarray:
        """Return the disturbance (size,) of changes (4 or more, N, n) of r, v, r'' and a."""
        return (state[:4, self.free] / self.units[..., 0]).ravel()

    def unpack(self, disturbance) -> np.ndarray:
        """Return the changes (4, N, n) of r, v, r'' and a in a disturbance (size,), zero at prescribed nodes."""
        state = np.zeros((4, self.order.is_prescribed.size, self.n))
        state[:, self.free] = disturbance.reshape(4, self.free.size, self.n) * self.units[..., 0]
        return state


def disturbed_axes(system, orbit, sideways):
    """Return the Line, the orbit (.., N, m) in its axes and which of these are disturbed, all those of the system.

    sideways: of a system in a vertical plane the line gets an axis across it, between the other two, and this alone is
    disturbed: the forces along the others do not change with it in the first order.
    """
    line = system.line
    if not sideways:
        return line, tuple(np.ascontiguousarray(part) for part in orbit), np.arange(len(system.axes))
    along, up = line.current
    line = line._replace(load=np.insert(line.load, 1, 0.0, axis=1), current=(along, 0.0, up))
    return line, tuple(np.insert(part, 1, 0.0, axis=-1) for part in orbit), np.array([1])
