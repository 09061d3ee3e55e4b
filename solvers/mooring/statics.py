"""Equilibrium of a moving line on its own mesh: nodes and elements with nothing moving, started from the catenaries."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from ..common.outcome import Outcome, Status
from ..numerics.continuation import continue_in_load
from ..numerics.newton import Step, relaxed_newton
from . import elimination, equations
from .components import merge_states
from .diagnostics import exact_pretension, rest_warnings

TOLERANCE = 1e-13  # largest change of a position over the length: some hundred roundings of a coordinate
MAX_STEPS = 30  # of Newton's method; the mixed one takes four to eight from a catenary
MIN_LOAD_STEP = 2.0**-10  # of the load parameter, in the continuation


@dataclass(frozen=True)
class MooringState(Outcome):
    """Equilibrium: y (n, N): coordinates of the nodes in m, axes of the system; tension (C,) of the cells, N.

    forces (3, N): on what holds each node, public frame, N; those of free nodes are what Newton's method left.
    residual_norm: the largest of these, N.
    """

    system: Any = field(repr=False)
    y: np.ndarray = field(repr=False)
    tension: np.ndarray = field(repr=False)
    forces: np.ndarray = field(repr=False)
    status: Status
    iterations: int
    residual_norm: float
    steps: tuple[Step, ...] = field(repr=False, default=())

    @cached_property
    def r(self) -> np.ndarray:
        """Positions of the nodes, (3, N), m."""
        return self.system.positions(self.y)

    @cached_property
    def pretension_error(self) -> float | None:
        """Relative difference of the fairlead tension from the exact catenaries'; None where they do not tell it."""
        exact = exact_pretension(self.system) if self.success else None
        return None if exact is None else abs(self.fairlead_tension / exact - 1)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What the mesh has lost: a pretension that is off."""
        return rest_warnings(self.system) if self.success else ()

    @property
    def fairlead_force(self) -> np.ndarray:
        """Force of the line on the vessel, (3,), N."""
        return self.forces[:, -1]

    @property
    def anchor_force(self) -> np.ndarray:
        """Force of the line on the anchor, (3,), N."""
        return self.forces[:, 0]

    @property
    def fairlead_tension(self) -> float:
        """Size of the force on the vessel, N."""
        return float(np.linalg.norm(self.fairlead_force))


def solve_rest(system, displacement=(0.0, 0.0, 0.0), throw=True) -> MooringState:
    """Return the equilibrium of a MooringSystem, its moved points displaced by (3,) or (M, 3) in m.

    Newton's method with the tensions of the cells as unknowns of their own beside the positions; where it fails, the
    current grows and the seabed stiffens in steps. Raises ConvergenceError where no equilibrium is found
    (``throw=False``: a state whose status says so).
    """
    if system.components:
        displaced = np.broadcast_to(displacement, system.moved_points.shape)
        states = [solve_rest(part.system, displaced[part.moved], throw=False) for part in system.components]
        state = merge_states(system, states)
        failed = [
            part.system.model.name for part, one in zip(system.components, states, strict=True) if not one.success
        ]
        return state.or_raise("; ".join(failed)) if throw else state
    catenaries = system.model.at_rest(system.layout, displacement)
    start = np.ascontiguousarray(system.to_axes(catenaries.r).T)
    solve = lambda load_factor, x: _Statics(system, load_factor, catenaries.tension).newton(x)
    x, reached, iterations, steps = continue_in_load(solve, start, min_step=MIN_LOAD_STEP)
    R, T, _ = _Statics(system, 1.0, np.zeros(system.line.length.size)).evaluate(x)
    forces = system.axes.T @ -R.T
    free = np.delete(R, system.prescribed_nodes, axis=0)
    status = Status.SUCCESS if reached == 1.0 else Status.NO_EQUILIBRIUM_FOUND
    norm = float(abs(free).max(initial=0.0))
    state = MooringState(system, x.T.copy(), np.maximum(T, 0.0), forces, status, iterations, norm, tuple(steps))
    return state.or_raise(system.model.name) if throw else state


class _Statics:
    """Rows and Newton's method of the equilibrium under a share of the current, over a seabed as soft as the mesh."""

    def __init__(self, system, load_factor, tension):
        self.auxiliary = tension
        line = system.line
        if load_factor < 1.0:
            line = line._replace(current=tuple(load_factor * c for c in line.current))
            stiffest = line.seabed_stiffness.max()
            if stiffest > 0:
                soft = float(tension.max()) / (4 * float(line.length.max()))  # the line lifts off over two cells
                line = line._replace(
                    seabed_stiffness=line.seabed_stiffness * min(1.0, soft / stiffest) ** (1 - load_factor)
                )
        self.line, self.order, self.length = line, system.order, system.length
        self.prescribed_nodes = system.prescribed_nodes
        self.still = np.zeros((system.nodes, len(system.axes)))
        self.last_linearisation = None  # positions, tensions and directions where the last Jacobian stood

    def evaluate(self, x):
        """Return R (N, n), T (C,) and unit (C, n)."""
        cells = self.line.length.size
        R, T, unit = np.empty_like(x), np.empty(cells), np.empty((cells, x.shape[1]))
        equations.residual(self.line, x, self.still, self.still, self.auxiliary, R, T, unit)
        return R, T, unit

    def residual(self, x):
        """Return R, zero at prescribed nodes."""
        R = self.evaluate(x)[0]
        R[self.prescribed_nodes] = 0.0
        return R

    def tangents(self, x):
        """Return a function that solves with the tangents at x, None where they are singular."""
        nodes, n = x.shape
        edges = self.order.edges
        diagonal, right, left = np.empty((nodes, n, n)), np.empty((edges, n, n)), np.empty((edges, n, n))
        weights = (1.0, 0.0, 0.0)
        equations.tangents(self.line, x, self.still, self.still, self.auxiliary, weights, diagonal, right, left)
        elimination.factorise(self.order, diagonal, right, left)

        def solve(F):
            step = F.copy()
            elimination.solve(self.order, diagonal, right, left, step)
            return step

        return solve if np.isfinite(diagonal).all() else None

    def newton(self, x):
        """Return (x, steps, converged) of the mixed method from x, in full steps until they grow."""

        def linearise(x):
            if self.last_linearisation is not None:
                x0, T0, unit0 = self.last_linearisation
                moved, first, last = x - x0, self.line.first, self.line.last
                stretch = np.sum(unit0 * (moved[last] - moved[first]), axis=1)
                self.auxiliary = np.where(T0 != 0, T0 + self.line.EA / self.line.length * stretch, 0.0)
            R, T, unit = self.evaluate(x)
            R[self.prescribed_nodes] = 0.0
            self.last_linearisation = x, T, unit
            return R, self.tangents(x)

        norm = lambda step: float(abs(step).max()) / self.length
        with np.errstate(all="ignore"):  # a diverging step is seen by its size
            result, steps, converged = relaxed_newton(linearise, self.residual, x, TOLERANCE, norm, MAX_STEPS)
        return result if converged else x, steps, converged
