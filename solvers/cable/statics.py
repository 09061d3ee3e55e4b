"""Equilibrium of a cable on its own mesh: the box scheme with nothing moving, and both ends at their positions.

Unknowns are strain, angles and positions (up, along[, out]) of the nodes; the velocities are zero and rows 4 to 6 are
met. The start is the catenary; where Newton's method fails from there, the loads are raised in steps.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from ..catenary.pretension import mean_pretension, pretension_warnings
from ..catenary.span import Span, solve_span
from ..common.outcome import InputError, Outcome, Status, describe_vector
from ..common.types import as_system
from ..common.validation import flags, one_of, positive_number, refuse_for_lines
from ..numerics.chain import BandedJacobian, Residual, stack
from ..numerics.continuation import continue_in_load
from ..numerics.newton import Step, damped_newton
from .equations import CableEquations
from .mesh import refine
from .shooting import shoot

TOLERANCE = 1e-11  # mean change of (eps, angles in rad, positions in chords): a hundred roundings of a position
_ROUNDING = 1e-14  # mean change of a state that fifty roundings make
MIN_LOAD_STEP = 2.0**-10  # of the load parameter, in the continuation


@dataclass(frozen=True, repr=False)
class StaticState(Outcome):
    """Equilibrium: y (n_f, N) as in ``fields``; r (3, N): positions of the nodes in m; forces in N, public frame.

    residual_norm: of the rows in N/m ("box"), or the largest jump between shots in tensions and chords ("shooting").
    """

    system: Any = field(repr=False)  # CableSystem
    y: np.ndarray = field(repr=False)
    r: np.ndarray = field(repr=False)
    status: Status
    iterations: int
    residual_norm: float
    steps: tuple[Step, ...] = field(repr=False, default=())

    @cached_property
    def tension(self) -> np.ndarray:
        """Tension at the nodes, (N,), N."""
        return self.system.tension(self.y)

    @cached_property
    def pretension_error(self) -> float | None:
        """Relative difference of the fairlead tension from that of the exact catenary.

        None after a failure, in a current and over a seabed too soft for a catenary (``exact_pretension``).
        """
        exact = exact_pretension(self.system) if self.success else None
        return None if exact is None else abs(float(self.tension[-1]) / exact - 1)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is suspected in the input, and what the mesh has lost: a pretension off by ``MAX_PRETENSION_ERROR``."""
        return *self.system.input_warnings(), *pretension_warnings(self.pretension_error, "nodes")

    def describe(self):
        """Yield the tension at the fairlead and the force on the anchor."""
        yield f"{self.r.shape[1]} nodes; T = {self.tension[-1]:.7g} N at the fairlead"
        yield f"force on the anchor {describe_vector(self.anchor_force)} N"

    @property
    def fairlead_force(self) -> np.ndarray:
        """Force of the line on the vessel, (3,), N."""
        return -self.tension[-1] * self.system.direction(self.y)[:, -1]

    @property
    def anchor_force(self) -> np.ndarray:
        """Force of the line on the anchor, (3,), N."""
        return self.tension[0] * self.system.direction(self.y)[:, 0]


def solve_static(
    system: CableEquations, *, method: str = "box", tolerance: float = TOLERANCE, throw: bool = True
) -> StaticState:
    """Return the equilibrium of the cable between its ends, HB (13)-(15), or of a line of nodes and elements.

    A Scene is taken as ``mooring_system(scene)``; the MooringState of such a line is as exact as rounding allows.
    method: "box", the scheme (39) that the dynamic solvers use, or "shooting", the differential equations themselves
    from node to node, started from the former: its error is that of the integration, ten digits and more.
    Raises InputError for the system of a corrected response (``CableSystem.fourth_order``), ConvergenceError when no
    equilibrium is found (``throw=False``: a state whose status says so).

    >>> chain = CableProperties(EA=384.243e6, diameter=0.09, mass_per_length=77.7066, Cdn=1.6)
    >>> scene = Scene("my line", chain, 902.2, (0.0, 0.0, -320.0), (848.67, 0.0, -70.0))
    >>> round(solve_static(cable_system(scene, nodes=20)).tension[-1] / 1e3)  # kN
    963
    """
    one_of("method", method, ("box", "shooting"))
    flags(throw=throw)
    system = as_system(system)
    if hasattr(system, "solve_static"):  # a line of nodes and elements
        refuse_for_lines(("method", method, "box"), ("tolerance", tolerance, TOLERANCE))
        return system.solve_static(throw=throw)
    tolerance = positive_number("tolerance", tolerance, "(mean change of a state)")
    if tolerance < _ROUNDING:
        problem = f"{tolerance:g} must be at least {_ROUNDING:g}: rounding moves a state by as much"
        raise InputError(problem, field="tolerance", value=tolerance, unit="(mean change of a state)")
    if system.is_fourth_order:
        problem = "that of a corrected response has no statics; give the cable that was solved for"
        raise InputError(problem, field="system", value=system)
    if method == "shooting" and (pieces := _shots_per_cell(system)) > 1:
        fine = solve_static(system.on_mesh(refine(system.s, pieces)), method=method, tolerance=tolerance, throw=throw)
        return replace(fine, system=system, y=fine.y[:, ::pieces], r=fine.r[:, ::pieces])
    statics, residual_norm = _Statics(system), None
    solve = lambda load_factor, x: _Statics(_with_eased_loads(system, x, load_factor)).newton(x, tolerance)
    x, reached, iterations, steps = continue_in_load(solve, statics.catenary(), min_step=MIN_LOAD_STEP)
    converged = reached == 1.0
    if method == "shooting" and converged:
        x, residual_norm, steps, converged = shoot(system, statics.full(x), tolerance)
        iterations += len(steps)
    residual_norm = abs(statics.residual(x)).max() if residual_norm is None else residual_norm
    status, y = Status.SUCCESS, statics.full(x)
    if not converged:
        status = Status.NO_EQUILIBRIUM_FOUND
    elif (invalid := system.invalid(y)) is not None:
        status = invalid[0]
    r = system.axes.T @ x[system.dimension :] + system.anchor[:, None]
    state = StaticState(system, y, r, status, iterations, float(residual_norm), tuple(steps))
    return state.or_raise(system.scene.name) if throw else state


def exact_pretension(system) -> float | None:
    """Return the fairlead tension of the exact catenary between the ends of the cable, N.

    Over a seabed of stiffness k it is the mean of two, without friction: over rigid seabeds at the height of first
    contact and w_0/k lower, where the resting line lies, MSQS (2.23). A line leaves a seabed that yields between them.
    Returns None in a current, without a stressed equilibrium, and where the two differ by more than 2 %.
    """
    if system.current is not None or system.w0 <= 0:
        return None

    def tension_over(depth):
        state = solve_span(_span(system, depth), throw=False)
        return float(state.tension) if state.success else None

    return mean_pretension(tension_over, system.w0 / system.seabed_stiffness if _has_contact(system) else 0.0)


def _span(system, sink=0.0) -> Span:
    """Return the span between the ends of the cable, over a rigid seabed lower by ``sink`` in m, without friction."""
    seabed = _has_contact(system)
    clearance = float(system.anchor[2]) + system.scene.environment.depth + sink if seabed else 0.0
    height, distance = system.chord[:2]
    return Span(system.w0, system.EA, float(system.s[-1]), distance, height, seabed, 0.0, clearance)


def _has_contact(system) -> bool:
    """Return whether there is a seabed that supports the line."""
    return system.has_seabed and system.seabed_stiffness > 0


def _shots_per_cell(system) -> int:
    """Return how many shots a cell takes for none to pass more than two boundary layers sqrt(T/k) of the seabed."""
    if not _has_contact(system):
        return 1
    least_tension = system.EA * _Statics(system).catenary()[0].min()
    return math.ceil(system.ds.max() / (2 * math.sqrt(max(least_tension, 0.0) / system.seabed_stiffness) or math.inf))


def _with_eased_loads(system, x, load_factor) -> CableEquations:
    """Return the system with a share of its current, its seabed softened to the mesh, stiffening with the share."""
    loads = {}
    if system.current is not None:
        loads["current"] = load_factor * system.current
    if _has_contact(system):
        soft = system.EA * x[0].max() / (4 * system.ds.max() ** 2)  # the line lifts off over two cells, sqrt(T / k)
        ratio = min(1.0, soft / system.seabed_stiffness)
        loads["seabed_stiffness"] = system.seabed_stiffness * ratio ** (1 - load_factor)
    return system.replace(**loads) if loads else system


class _Statics:
    """The rows of the equilibrium in (eps, angles, positions), x (2 n_d, N), and Newton's method on them."""

    def __init__(self, system):
        self.system, n = system, system.dimension
        self.angles = [0, *range(1 + n, 2 * n)]  # eps and the angles among the fields
        self.jacobian = BandedJacobian(2 * n, system.nodes, n)
        self.scale = np.ones((2 * n, 1))
        self.scale[n:] = np.linalg.norm(system.chord) or 1.0
        self.end_tangent = np.eye(n, 2 * n, n)

    def catenary(self) -> np.ndarray:
        """Return the continuous equilibrium without current at the nodes, x; a seabed is rigid there."""
        system, n = self.system, self.system.dimension
        state = solve_span(_span(system))
        along, up, T = state.profile(system.s)
        x = np.zeros((2 * n, system.nodes))
        vertical = state.V - system.w0 * (system.s[-1] - system.s)
        if state.grounded_length > 0:
            vertical = np.maximum(vertical, 0.0)
            up = np.where(system.s <= state.grounded_length, up - 0.5 * system.w0 / system.seabed_stiffness, up)
        x[0], x[1], x[n], x[n + 1] = T / system.EA, np.arctan2(state.H, vertical), up, along
        return x

    def full(self, x) -> np.ndarray:
        """Return the state y (n_f, N) of x."""
        system = self.system
        y = np.zeros((len(system.fields), system.nodes))
        y[self.angles] = x[: system.dimension]
        if system.has_seabed:
            y[-1] = system.anchor[2] + x[system.dimension]
        return y

    def rows(self, x, tangents):
        """Return the rows of momentum (13)-(15) and of the positions in the cells, between those of the ends."""
        system, n = self.system, self.system.dimension
        y = self.full(x)
        cells = system.cells(y, np.zeros_like(y), 0.0, tangents)
        tangent, by_angles = system.stretched_tangent(y)
        position = x[n:]
        placed = 2 * (position[:, 1:] - position[:, :-1]) / system.ds - tangent[:, 1:] - tangent[:, :-1]
        value = np.concatenate([cells.value[:n], placed])
        start, end = Residual(position[:, 0]), Residual(position[:, -1] - system.chord)
        if not tangents:
            return start, Residual(value), end
        J = np.zeros((2, 2 * n, 2 * n, system.nodes - 1))
        J[:, :n, :n] = cells.dy[:, :n, self.angles]
        if system.has_seabed:
            J[:, :n, n] = cells.dy[:, :n, -1]
        for side, sign, at in ((0, -1, slice(None, -1)), (1, 1, slice(1, None))):
            J[side, n:, :n] = -by_angles[:, self.angles, at]
            J[side, range(n, 2 * n), range(n, 2 * n)] = sign * 2 / system.ds
        ends = self.end_tangent
        return Residual(start.value, ends, ends), Residual(value, J, J), Residual(end.value, ends, ends)

    def residual(self, x) -> np.ndarray:
        """Return the rows as one vector."""
        return stack(*self.rows(x, False))

    def newton(self, x, tolerance):
        """Return (x, steps, converged) of damped Newton from x."""

        def linearise(x):
            rows = self.rows(x, True)
            if not self.jacobian.factorise(*(part.dy for part in rows)):
                return stack(*rows), None
            return stack(*rows), lambda F: self.jacobian.solve(F).reshape(x.T.shape).T

        with np.errstate(all="ignore"):  # trial states may have eps < -1; they are refused as not finite
            return damped_newton(linearise, self.residual, x, tolerance, lambda d: float(np.mean(abs(d / self.scale))))
