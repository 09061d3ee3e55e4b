"""Equilibrium of a cable on its own mesh: the box scheme with nothing moving, and the ends where they are.

Unknowns are strain, angles and positions (up, along[, out]) of the nodes; the velocities are zero and rows 4 to 6 are
met. The start is the catenary; a current, where Newton's method alone does not get there, is raised in steps.
"""

from __future__ import annotations

import copy
import math
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from ..catenary.span import Span, solve_span
from ..common.outcome import InputError, Outcome, Status
from ..common.properties import flags, one_of, positive_number
from ..numerics.chain import BandedJacobian, Residual, stack
from ..numerics.continuation import continue_in_load
from ..numerics.newton import Step, damped_newton
from .shooting import shoot
from .system import CableSystem

TOLERANCE = 1e-11  # mean change of (eps, angles in rad, positions in chords): a hundred roundings of a position
_ROUNDING = 1e-14  # mean change of a state that fifty roundings make
MIN_LOAD_STEP = 2.0**-10  # of the load parameter, in the continuation


@dataclass(frozen=True)
class StaticState(Outcome):
    """Equilibrium: y (n_f, N) as in ``fields``; r (3, N): places of the nodes in m; forces in N, public frame.

    residual_norm: of the rows in N/m ("box"), or the largest jump between shots in tensions and chords ("shooting").
    """

    system: CableSystem = field(repr=False)
    y: np.ndarray = field(repr=False)
    r: np.ndarray = field(repr=False)
    status: Status
    iterations: int
    residual_norm: float
    steps: tuple[Step, ...] = field(repr=False, default=())

    @cached_property
    def tension(self) -> np.ndarray:
        """(N,) N."""
        return self.system.tension(self.y)

    @property
    def fairlead_force(self) -> np.ndarray:
        """Force of the line on the vessel, (3,), N."""
        return -self.tension[-1] * self.system.direction(self.y)[:, -1]

    @property
    def anchor_force(self) -> np.ndarray:
        """Force of the line on the anchor, (3,), N."""
        return self.tension[0] * self.system.direction(self.y)[:, 0]


def solve_static(system: CableSystem, *, method="box", tolerance=TOLERANCE, throw=True) -> StaticState:
    """Equilibrium of the cable between its ends, HB (13)-(15).

    method: "box", the scheme (39) that the dynamic solvers use, or "shooting", the differential equations themselves
    from node to node, started from the former: its error is that of the integration, ten digits and more.
    Raises InputError for the system of a corrected response (``CableSystem.fourth_order``), ConvergenceError when no
    equilibrium is found (``throw=False``: a state whose status says so).
    """
    one_of("method", method, ("box", "shooting"))
    flags(throw=throw)
    tolerance = positive_number("tolerance", tolerance, "(mean change of a state)")
    if tolerance < _ROUNDING:
        raise InputError(f"tolerance: {tolerance:g} must be at least {_ROUNDING:g}: rounding moves a state by as much")
    if system.corrected:
        raise InputError("system: that of a corrected response has no statics; give the cable that was solved for")
    if method == "shooting" and (pieces := _pieces(system)) > 1:
        fine = solve_static(_refined(system, pieces), method=method, tolerance=tolerance, throw=throw)
        return replace(fine, system=system, y=fine.y[:, ::pieces], r=fine.r[:, ::pieces])
    statics, left = _Statics(system), None
    solve = lambda load_factor, x: _Statics(_eased(system, x, load_factor)).newton(x, tolerance)
    x, reached, iterations, steps = continue_in_load(solve, statics.catenary(), min_step=MIN_LOAD_STEP)
    converged = reached == 1.0
    if method == "shooting" and converged:
        x, left, steps, converged = shoot(system, statics.full(x), tolerance)
        iterations += len(steps)
    left = abs(statics.residual(x)).max() if left is None else left
    status, y = Status.SUCCESS, statics.full(x)
    if not converged:
        status = Status.NO_EQUILIBRIUM_FOUND
    elif (invalid := system.invalid(y)) is not None:
        status = invalid[0]
    place = system.axes.T @ x[system.dimension :] + system.anchor[:, None]
    state = StaticState(system, y, place, status, iterations, float(left), tuple(steps))
    return state.or_raise(system.scene.name) if throw else state


def follow(system) -> tuple[np.ndarray, np.ndarray] | None:
    """How the state (n_d, n_f, N) and the places of the nodes (n_d, n_d, N) at rest follow the fairlead, per metre.

    The first axis is the direction of the fairlead, the second of the places, in the system's own axes; linearised.
    None where the stiffness is singular.
    """
    statics, n, y = _Statics(system), system.dimension, system.rest_state()
    place = system.axes @ (system.positions(y) - system.anchor[:, None])
    rows = statics.rows(np.concatenate([y[statics.angles], place]), True)
    if not statics.jacobian.factorise(*(part.dy for part in rows)):
        return None
    moved = np.zeros((2 * n * system.nodes, n))
    moved[-n:] = np.eye(n)  # the rows of the end
    x = statics.jacobian.solve(moved).T.reshape(n, system.nodes, 2 * n).swapaxes(1, 2)
    return np.array([statics.full(one) - statics.full(0 * one) for one in x]), x[:, n:]


def _pieces(system) -> int:
    """Into how many shots a cell is cut, so that none passes more than two boundary layers sqrt(T/k) of the seabed."""
    if not system.has_seabed or not system.seabed_stiffness:
        return 1
    slack = system.EA * _Statics(system).catenary()[0].min()
    return math.ceil(system.ds.max() / (2 * math.sqrt(max(slack, 0.0) / system.seabed_stiffness) or math.inf))


def _refined(system, pieces) -> CableSystem:
    inner = np.arange(pieces) / pieces
    s = np.append((system.s[:-1, None] + system.ds[:, None] * inner).ravel(), system.s[-1])
    return CableSystem(system.scene, s, system.planar, system.motion, system.source)


def _eased(system, x, share) -> CableSystem:
    """The system with a share of its current, and a seabed soft enough for the mesh that stiffens with the share."""
    eased = copy.copy(system)
    if system.current is not None:
        eased.current = share * system.current
    if system.has_seabed and system.seabed_stiffness > 0:
        soft = system.EA * x[0].max() / (4 * system.ds.max() ** 2)  # the line lifts off over two cells, sqrt(T / k)
        eased.seabed_stiffness = system.seabed_stiffness * min(1.0, soft / system.seabed_stiffness) ** (1 - share)
    return eased


class _Statics:
    """The chain of (eps, angles, positions), x (2 n_d, N)."""

    def __init__(self, system):
        self.system, n = system, system.dimension
        self.angles = [0, *range(1 + n, 2 * n)]  # eps and the angles among the fields
        self.jacobian = BandedJacobian(2 * n, system.nodes, n)
        self.scale = np.ones((2 * n, 1))
        self.scale[n:] = np.linalg.norm(system.chord) or 1.0
        self.anchored = np.zeros((n, 2 * n))
        self.anchored[:, n:] = np.eye(n)

    def catenary(self) -> np.ndarray:
        """The continuous equilibrium without current, on the nodes; a seabed is rigid there."""
        system, n = self.system, self.system.dimension
        environment = system.scene.environment
        seabed = system.has_seabed and system.seabed_stiffness > 0
        clearance = system.anchor[2] + environment.depth if seabed else 0.0
        rise, run = system.chord[:2]
        span = Span(system.w0, system.EA, float(system.s[-1]), run, rise, seabed, 0.0, clearance)
        state = solve_span(span)
        along, up, T = state.profile(system.s)
        x = np.zeros((2 * n, system.nodes))
        x[0] = T / system.EA
        x[1] = np.arctan2(state.H, _vertical(state, system))
        if state.grounded_length > 0:
            up = np.where(system.s <= state.grounded_length, up - 0.5 * system.w0 / system.seabed_stiffness, up)
        x[n], x[n + 1] = up, along
        return x

    def full(self, x) -> np.ndarray:
        """The state y (n_f, N) of x."""
        system = self.system
        y = np.zeros((len(system.fields), system.nodes))
        y[self.angles] = x[: system.dimension]
        if system.has_seabed:
            y[-1] = system.anchor[2] + x[system.dimension]
        return y

    def rows(self, x, tangents):
        """Momentum of (13)-(15) and the positions' own rows, on the cells; the ends in place."""
        system, n = self.system, self.system.dimension
        y = self.full(x)
        cells = system.cells(y, np.zeros_like(y), 0.0, tangents)
        tangent, slope = system.stretched_tangent(y)
        place = x[n:]
        value = np.concatenate(
            [
                cells.value[:n],
                2 * (place[:, 1:] - place[:, :-1]) / system.ds - tangent[:, 1:] - tangent[:, :-1],
            ]
        )
        start, end = Residual(place[:, 0]), Residual(place[:, -1] - system.chord)
        if not tangents:
            return start, Residual(value), end
        J = np.zeros((2, 2 * n, 2 * n, system.nodes - 1))
        J[:, :n, :n] = cells.dy[:, :n, self.angles]
        if system.has_seabed:
            J[:, :n, n] = cells.dy[:, :n, -1]
        for side, sign, at in ((0, -1, slice(None, -1)), (1, 1, slice(1, None))):
            J[side, n:, :n] = -slope[:, self.angles, at]
            J[side, range(n, 2 * n), range(n, 2 * n)] = sign * 2 / system.ds
        fixed = self.anchored
        return Residual(start.value, fixed, fixed), Residual(value, J, J), Residual(end.value, fixed, fixed)

    def residual(self, x) -> np.ndarray:
        return stack(*self.rows(x, False))

    def newton(self, x, tolerance):
        """Damped Newton: (x, steps, converged)."""

        def linearise(x):
            rows = self.rows(x, True)
            if not self.jacobian.factorise(*(part.dy for part in rows)):
                return stack(*rows), None
            return stack(*rows), lambda F: self.jacobian.solve(F).reshape(x.T.shape).T

        with np.errstate(all="ignore"):  # trial states may have eps < -1; they are refused as not finite
            return damped_newton(linearise, self.residual, x, tolerance, lambda d: float(np.mean(abs(d / self.scale))))


def _vertical(state, system) -> np.ndarray:
    """Vertical force at the nodes of the catenary, N; zero where it rests."""
    V = state.V - system.w0 * (system.s[-1] - system.s)
    return np.maximum(V, 0.0) if state.grounded_length > 0 else V
