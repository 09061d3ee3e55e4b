"""Equilibrium of a moving line on its own mesh: nodes and elements with nothing moving, started from the catenaries."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from ..common.outcome import Outcome, Status, describe_vector
from ..numerics.continuation import continue_in_load
from ..numerics.lu import elimination
from ..numerics.newton import Step, relaxed_newton
from . import equations
from .diagnostics import exact_pretension, friction_warnings, rest_warnings
from .lines.assembly import evaluate_forces

TOLERANCE = 1e-13  # largest change of a position over the length: some hundred roundings of a coordinate
SOFT_STRAIN = 0.1  # of the greatest tension, where the continuation begins
SETTLED = 1e-9  # of the length: a step that ends the search for the least energy
FIRST_SHIFT = 1e-3  # of the greatest stiffness of a cell
MAX_DESCENTS = 200  # steps towards the least energy of soft lines
MAX_STEPS = 30  # of Newton's method; the mixed one takes four to eight from a catenary
MIN_LOAD_STEP = 2.0**-10  # of the load parameter, in the continuation
SLACK_STIFFNESS = 1e-9  # of the stiffest cell's, in the Jacobian alone, at nodes of slack cells: it is singular else


@dataclass(frozen=True, repr=False)
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
        """What is suspected in the input, friction that the rest has none of, and a pretension that is off."""
        made = self.system.input_warnings() + friction_warnings(self.system)
        return made + rest_warnings(self.system) if self.success else made

    def describe(self):
        """Yield the tension at the fairlead and the force on the anchor; of a network the range of all cells."""
        if self.system.model.is_line:
            yield f"{self.r.shape[1]} nodes; T = {self.fairlead_tension:.7g} N at the fairlead"
            yield f"force on the anchor {describe_vector(self.anchor_force)} N"
        else:
            low, high = self.tension.min(), self.tension.max()
            yield f"{self.r.shape[1]} nodes; tension {low:.6g} to {high:.6g} N in its cells"

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

    Newton's method with the tensions of the cells as unknowns of their own beside the positions. Where it fails from
    the catenaries, soft lines over a soft seabed in still water, whose energy has one minimum, settle first; stiffness
    and current then grow in steps. Raises ConvergenceError where no equilibrium is found (``throw=False``: a state
    whose status says so).
    """
    if system.components:
        displaced = np.broadcast_to(displacement, system.moved_points.shape)
        states = [_solve_component(part.system, displaced[part.moved]) for part in system.components]
        state = _merge_states(system, states)
        name = "; ".join(one.system.model.name for one in states if not one.success)
        return state.or_raise(name) if throw else state
    catenaries = system.model.at_rest(system.layout, displacement)
    start = np.ascontiguousarray(system.to_axes(catenaries.r).T)
    search = _Search(system, catenaries.tension)
    x, steps, converged = search.newton(1.0, start)
    reached, iterations = float(converged), len(steps)
    if not converged:
        soft, descents = search.descend(0.0, start)
        x, reached, more, steps = continue_in_load(search.solve, soft, min_step=MIN_LOAD_STEP)
        iterations += len(descents) + more
    status = Status.SUCCESS if reached == 1.0 else Status.NO_EQUILIBRIUM_FOUND
    state = _make_state(system, x.T.copy(), status, iterations, steps)
    return state.or_raise(system.model.name) if throw else state


def _solve_component(system, displacement):
    """Return the equilibrium of a part of a network; undisplaced it is solved for once, as that of a whole network."""
    if np.any(displacement):
        return solve_rest(system, displacement, throw=False)
    if "rest" in vars(system):
        return system.rest
    state = solve_rest(system, throw=False)
    if state.success:
        vars(system)["rest"] = state  # where the cached property keeps it
    return state


def _merge_states(system, states) -> MooringState:
    """Return the MooringState of a network from those of its components."""
    worst, y = min(states, key=lambda state: state.success), np.empty((len(system.axes), system.nodes))
    for part, state in zip(system.components, states, strict=True):
        y[:, part.nodes] = state.y
    return _make_state(system, y, worst.status, sum(state.iterations for state in states), worst.steps)


def _make_state(system, y, status, iterations, steps) -> MooringState:
    """Return the MooringState of positions y (n, N): a point that holds several parts bears its load once."""
    still = np.zeros((*y.shape, 1))
    forces, tension = evaluate_forces(system.line, y[..., None], still, still)
    norm = abs(np.delete(forces[0], system.prescribed_nodes, axis=0)).max(initial=0.0)
    return MooringState(
        system, y, tension[0], system.axes.T @ forces[0].T, status, iterations, float(norm), tuple(steps)
    )


class _Search:
    """The solves of a continuation: each begins with the tensions (C,) in N that the one before ended with."""

    def __init__(self, system, tension):
        self.system, self.tension = system, tension

    def newton(self, load_factor, x):
        """Return (x, steps, converged) of Newton's method at a load factor."""
        statics = _Statics(self.system, load_factor, self.tension)
        result, steps, converged = statics.newton(x)
        if converged:
            self.tension = statics.evaluate(result)[1]
        return result, steps, converged

    def descend(self, load_factor, x):
        """Return (x, steps) near the least energy at a load factor."""
        statics = _Statics(self.system, load_factor, self.tension)
        x, steps = statics.lower_energy(x)
        self.tension = statics.evaluate(x)[1]
        return x, steps

    def solve(self, load_factor, x):
        """Return (x, steps, converged) at a load factor: of Newton's method, or of both in turn where it fails."""
        result, steps, converged = self.newton(load_factor, x)
        if not converged:
            result, descents = self.descend(load_factor, x)
            result, steps, converged = self.newton(load_factor, result)
            steps = [*descents, *steps]
        return result, steps, converged


class _Statics:
    """Rows and Newton's method of the equilibrium under a share of the current, over a seabed as soft as the mesh."""

    def __init__(self, system, load_factor, tension):
        self.auxiliary = tension
        line = system.line
        if load_factor < 1.0:
            easing, greatest, stiffest = 1 - load_factor, float(tension.max()), line.seabed_stiffness.max()
            soft = greatest / (4 * float(line.length.max()))  # the line lifts off over two cells
            seabed = line.seabed_stiffness * (min(soft, stiffest) / (stiffest or 1.0)) ** easing
            EA = line.EA * np.minimum(1.0, greatest / SOFT_STRAIN / line.EA) ** easing
            current = tuple(load_factor * c for c in line.current)
            line = line._replace(current=current, seabed_stiffness=seabed, EA=EA)
        self.line, self.order, self.length = line, system.order, system.length
        self.prescribed_nodes = system.prescribed_nodes
        self.still = np.zeros((system.nodes, len(system.axes)))
        self.last_linearisation = None  # positions, tensions and directions where the last Jacobian stood

    def evaluate(self, x, line=None):
        """Return R (N, n), T (C,) and unit (C, n); line: another one."""
        cells = self.line.length.size
        R, T, unit = np.empty_like(x), np.empty(cells), np.empty((cells, x.shape[1]))
        equations.residual(line or self.line, x, self.still, self.still, self.auxiliary, R, T, unit)
        return R, T, unit

    def tangents(self, x, shift=0.0):
        """Return a function that solves with the tangents at x, None where they are singular.

        shift: what to add to the diagonal, of the greatest stiffness of a cell.
        """
        nodes, n = x.shape
        edges = self.order.edges
        diagonal, right, left = np.empty((nodes, n, n)), np.empty((edges, n, n)), np.empty((edges, n, n))
        weights = (1.0, 0.0, 0.0)
        equations.tangents(self.line, x, self.still, self.still, self.auxiliary, weights, diagonal, right, left)
        stiffest = float((self.line.EA / self.line.length).max())
        diagonal += shift * stiffest * np.eye(n)
        slack = self.auxiliary <= 0
        for ends in (self.line.first[slack], self.line.last[slack]):  # which nothing keeps from moving sideways
            diagonal[ends] += SLACK_STIFFNESS * stiffest * np.eye(n)
        elimination.factorise(self.order, diagonal, right, left, np.empty(n))

        def solve(F):
            step = F.copy()
            step[self.prescribed_nodes] = 0.0
            elimination.solve(self.order, diagonal, right, left, step, np.empty(n))
            return step

        return solve if np.isfinite(diagonal).all() else None

    def energy(self, x) -> float:
        """Return the potential energy in J: of cells in tension, of loads and of the seabed. It is convex."""
        line = self.line
        chord = np.linalg.norm(x[line.last] - x[line.first], axis=1)
        strain = np.maximum(chord / line.length - 1, 0.0)
        depth = np.maximum(line.floor - x[:, -1], 0.0)
        stored = line.EA @ (line.length * strain**2) + line.seabed_stiffness @ depth**2
        return float(stored / 2 - (line.load * x).sum())

    def lower_energy(self, x):
        """Return x near the least energy and the steps there: Newton's method, damped so that each lowers the energy.

        The drag of a current has no energy: it counts as a load that stays as it is within a step.
        """
        shift, steps = FIRST_SHIFT, []
        drag = np.zeros_like(x)
        for _ in range(MAX_DESCENTS):
            self.auxiliary = np.zeros_like(self.auxiliary)  # so that the tensions are those of the law
            R, self.auxiliary, _ = self.evaluate(x)
            if any(self.line.current):
                drag = R - self.evaluate(x, self.line._replace(current=(0.0,) * x.shape[1]))[0]
            solve = self.tangents(x, shift)
            step = np.full_like(x, np.nan) if solve is None else solve(R)
            size = float(abs(step).max()) / self.length
            if np.isfinite(size) and self.energy(x - step) - (drag * step).sum() <= self.energy(x):
                x, shift = x - step, shift / 4
                steps.append(Step(size, 1.0))
                if size <= SETTLED:
                    break
            else:
                shift *= 8
        return x, steps

    def newton(self, x):
        """Return (x, steps, converged) of the mixed method from x, in full steps until they grow."""

        def linearise(x):
            if self.last_linearisation is not None:
                x0, T0, unit0 = self.last_linearisation
                moved, first, last = x - x0, self.line.first, self.line.last
                stretch = np.sum(unit0 * (moved[last] - moved[first]), axis=1)
                self.auxiliary = np.where(T0 != 0, T0 + self.line.EA / self.line.length * stretch, 0.0)
            R, T, unit = self.evaluate(x)
            self.last_linearisation = x, T, unit
            return R, self.tangents(x)

        norm = lambda step: float(abs(step).max()) / self.length
        with np.errstate(all="ignore"):  # a diverging step is seen by its size
            result, steps, converged = relaxed_newton(linearise, None, x, TOLERANCE, norm, MAX_STEPS)
        return result if converged else x, steps, converged
