"""Harmonic balance of moving lines: the rows of their nodes in Fourier coefficients, and their Jacobian.

Sampled, transformed and solved as the paper's cable is (HB (63), (72)-(74)), on nodes with positions alone: of a node
n (2 Nh + 1) unknowns, coupled to its neighbours. The tensions of the cells at the samples are unknowns of their own
that each Newton step condenses (``equations.residual``): plain full steps then converge from a linear guess.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from ...common.outcome import InputError
from ...harmonic_balance.blocks import Blocks
from ...harmonic_balance.response import PeriodicResponse
from ...harmonic_balance.solve import solve_periodic
from ...numerics.lu.block_elimination import BlockFactors
from ...time_domain.solve import solve_time_domain
from .. import diagnostics
from ..linearised.monodromy import LinearisedPeriod
from ..linearised.stepped_orbit import SteppedOrbit
from ..lines.assembly import evaluate_forces
from ..stepping.history import MooringOutputs
from .hill import LineHill
from .samples import predict_tensions, sampled_residual, sampled_tangents


@dataclass(frozen=True, repr=False)
class MooringResponse(MooringOutputs, PeriodicResponse):
    """Periodic state of a moving line: PeriodicResponse with the outputs of MooringOutputs at the samples.

    coarse: the response on half as many cells, which forces at the ends are extrapolated with, or None.
    """

    system: Any = field(repr=False)
    coarse: MooringResponse | None = field(repr=False, default=None)

    @property
    def yddot(self) -> np.ndarray:
        """Accelerations at the samples, (n, N, Nt), m/s^2."""
        return self.acceleration_at(self.time)

    def acceleration_at(self, t) -> np.ndarray:
        """Accelerations at times t (S,) in s, (n, N, S), m/s^2."""
        return self._motion_of(t, slice(None))[2]

    def _motion_of(self, t, nodes):
        """Return the states, rates and accelerations (n, k, S) of some nodes at times t (S,) in s."""
        z, (q, q_t) = self.z[:, nodes], self.basis.functions(np.asarray(t, dtype=float))
        omega = self.basis.omega * self.basis.harmonic
        return self.system.rest_state()[:, nodes, None] + z @ q.T, z @ q_t.T, -(z * omega**2) @ q.T

    def end_force(self, end) -> np.ndarray:
        """Force on what holds the anchor (0) or the fairlead (-1) at the samples, (3, Nt), N."""
        return np.einsum("dc,kd->ck", self.system.axes, self._of_line(self).end_force_at(self.time, end))

    def end_force_at(self, t, end, element=None) -> np.ndarray:
        """Return the force at an end (0 or -1) of an element at times t (S,) in s, (S, n), N.

        Extrapolated with ``coarse``: the error of both meshes is of second order in the cells, so a third of their
        difference is left.
        """
        line, nodes = self.system.end_cell(end, element)
        force = evaluate_forces(line, *self._motion_of(t, nodes))[0][:, end]
        return force if self.coarse is None else force + (force - self.coarse.end_force_at(t, end, element)) / 3

    def motion_at(self, t) -> tuple[np.ndarray, ...]:
        """Return r, v and r'' (S, N, n) of the nodes at times t (S,) in s, in the axes of the system."""
        return tuple(np.ascontiguousarray(part.T) for part in self._motion_of(t, slice(None)))

    def linearised_period(self, steps, scheme, sideways=False) -> LinearisedPeriod:
        """Return what takes small disturbances of this response over its period, as ``floquet`` asks."""
        return LinearisedPeriod(self, steps, scheme, sideways)

    def stepped_orbit(self, steps) -> SteppedOrbit:
        """Return the motion near this response that so many time steps in its period repeat."""
        return SteppedOrbit(self, steps)

    def hill_problem(self) -> LineHill:
        """Return Hill's problem of this response."""
        return LineHill(self)

    def end_tension_at(self, t, end, element=None) -> np.ndarray:
        """Return the size of the force at an end (0 or -1) of an element at times t (S,) in s, N."""
        return np.linalg.norm(self.end_force_at(t, end, element), axis=1)

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        """What the mesh or the number of harmonics has lost."""
        return tuple(diagnostics.check_response(self))


def start_from_time(system, basis) -> tuple[np.ndarray, int]:
    """Return the coefficients z (n, N, C) of the last period of a time integration and its Newton steps.

    Coefficients are zero where the integration fails.
    Of three periods; of a line in deep water with coarser iterations, and two where the second ends as the first did.
    """
    steps = max(LEAST_STEPS, STEPS_PER_HARMONIC * basis.harmonics)
    period, y_at_rest = 2 * np.pi / basis.omega, system.rest_state()[..., None]
    is_smooth = system.model.is_line and not system.line.seabed_stiffness.any()
    tolerance = START_TOLERANCE if is_smooth else None
    integrate = partial(solve_time_domain, system, dt=period / steps, tolerance=tolerance, throw=False)
    history = integrate(duration=(2 if is_smooth else 3) * period)
    iterations = history.iterations
    if is_smooth and history.success:
        change = abs(history.y[..., -1] - history.y[..., -steps - 1]).max()
        if change > SETTLED * abs(history.y - y_at_rest).max():
            history = integrate(duration=3 * period)
            iterations += history.iterations
    if not history.success:
        return np.zeros((len(system.axes), system.nodes, basis.harmonic.size)), iterations
    t = period * np.arange(steps) / steps
    return 2 / steps * (history.y[..., -steps - 1 : -1] - y_at_rest) @ basis.functions(t)[0], iterations


def solve_extrapolated(system, **options) -> MooringResponse:
    """Return the periodic response of a MooringSystem with ``coarse``, that on half as many cells.

    options: of ``solve_periodic``. Raises as that does; InputError where the line has too few cells for a coarser one.
    """
    coarser = system.coarser()
    if coarser is None:
        problem = f"{system.nodes - 1} cells are too few for a mesh of half as many"
        raise InputError(problem, field="deferred_correction", value=True)
    coarse: Any = solve_periodic(coarser[0], **options | {"start": None})
    if not coarse.success:
        return coarse
    fine: Any = solve_periodic(system, **options)
    return replace(fine, coarse=coarse)


SETTLED = 2e-2  # change from one period to the next, over the largest displacement, that a start may have
LEAST_STEPS, STEPS_PER_HARMONIC = 48, 6  # in a period of the time integration that a solve starts from
START_TOLERANCE = 3e-3  # of it, for a line in deep water, where dt leaves more; slack and touchdown need a finer one
SINGLE_PRECISION_FROM = 20  # unknowns of a node from which on factors in single precision are faster
SINGLE_PRECISION_STEPS = 3  # linearisations in single precision; where Newton's method takes more, they may be why


class MooringHarmonics:
    """Rows of a MooringSystem for the coefficients z (n, N, C) of its displacement from rest; x (N, n C) as a vector.

    The methods are those of ``harmonic_balance.residual.HarmonicResidual`` without a mirror.
    """

    symmetric = False

    def __init__(self, system, basis):
        self.system, self.basis = system, basis
        self.rest = np.ascontiguousarray(system.rest_state().T)
        self.n, count = len(system.axes), basis.harmonic.size
        self.shape = (system.nodes, self.n, count)
        self.rows = Blocks.harmonics([np.arange(count)] * self.n, basis)
        path = system.path(basis.times)[:, 0] - self.rest[system.prescribed_nodes]
        self.prescribed_coefficients = np.moveaxis(path, 0, -1) @ basis.P  # (P, n, C)
        self.source = system.source_at(basis.times)
        self.auxiliary = np.empty((basis.samples, system.line.length.size))
        self.initial: Any = None  # unknowns where Newton's method began
        self.linearisations = 0
        self.last_linearisation: Any = None  # samples, tensions and directions where the last Jacobian stood

    @cached_property
    def functions(self) -> np.ndarray:
        """The Fourier functions and their first two derivatives at the samples, (3 Nt, C)."""
        basis = self.basis
        return np.concatenate([basis.Q, basis.Q_t, -basis.Q * (basis.omega * basis.harmonic) ** 2])

    @cached_property
    def blocks(self) -> Blocks:
        """What makes blocks of sampled tangents."""
        return Blocks(self.basis, [np.arange(self.shape[2])] * self.n)

    # ------------------------------------------------------------ what solve_periodic asks
    def pack(self, z) -> np.ndarray:
        """Return x (N, n C) of z (n, N, C)."""
        return np.swapaxes(z, 0, 1).reshape(self.shape[0], -1)

    def unpack(self, x) -> np.ndarray:
        """Return z (n, N, C) of x (N, n C)."""
        return np.ascontiguousarray(x.reshape(self.shape).swapaxes(0, 1))

    # ------------------------------------------------------------ rows
    def samples(self, x) -> np.ndarray:
        """Return r, v, a (3, Nt, N, n) at the samples."""
        result = self.functions @ x.reshape(-1, self.shape[2]).T
        result = result.reshape(3, self.basis.samples, self.shape[0], self.n)
        result[0] += self.rest
        return result

    def evaluate(self, x, samples=None):
        """Return the rows (N, n C), tensions (Nt, C) and directions (Nt, C, n) at the samples, and the samples."""
        samples = self.samples(x) if samples is None else samples
        R, T = np.empty(samples[0].shape), np.empty(self.auxiliary.shape)
        unit = np.empty((*T.shape, self.n))
        sampled_residual(self.system.line, samples, self.auxiliary, R, T, unit)
        if len(self.source):
            R -= self.source
        rows = self.project(R)
        prescribed = self.system.prescribed_nodes
        rows[prescribed] = x.reshape(self.shape)[prescribed] - self.prescribed_coefficients
        return rows.reshape(len(rows), -1), T, unit, samples

    def project(self, R) -> np.ndarray:
        """Return the coefficients (N, n, C) of samples (Nt, N, n)."""
        return (R.reshape(len(R), -1).T @ self.basis.P).reshape(self.shape)

    def residual(self, x) -> np.ndarray:
        """Return all rows, (N, n C)."""
        if self.initial is None:
            self._condense(x, self.samples(x))
        return self.evaluate(x)[0]

    def linearise(self, x):
        """Return the rows and a function that solves with the Jacobian, None where it is singular."""
        samples = self.samples(x)
        self._condense(x, samples)
        rows, T, unit, _ = self.evaluate(x, samples)
        self.last_linearisation = samples, T, unit
        if not np.isfinite(rows).all():
            return rows, None
        self.linearisations += 1
        return rows, self.factorise(samples, self.auxiliary)

    def factorise(self, samples, auxiliary):
        """Return a function that solves with the Jacobian at the samples, None where that is singular."""
        line, shape = self.system.line, (self.shape[0], self.n * self.shape[2])
        is_single = self.linearisations <= SINGLE_PRECISION_STEPS and shape[1] >= SINGLE_PRECISION_FROM
        blocks = self.jacobian(samples, auxiliary, np.float32 if is_single else float)
        factors = BlockFactors(self.system.order, line.first, line.last, *blocks)
        return None if factors.singular else lambda F: factors.solve(F.reshape(shape))

    def _condense(self, x, samples):
        """Set the auxiliary tensions: those of the start, then what the last Jacobian foretold for the step to x."""
        if self.initial is None:
            self.initial = x.copy()
        if np.array_equal(x, self.initial):  # the first step, or a solve that starts again
            self.auxiliary = np.zeros(self.auxiliary.shape)
            self.auxiliary = self.evaluate(x, samples)[1] if x.any() else self.auxiliary + self.system.rest.tension
        else:
            predict_tensions(self.system.line, samples, *self.last_linearisation, self.auxiliary)

    def tangents(self, samples, auxiliary):
        """Return what ``sampled_tangents`` sets: diagonal (3, n, n, N, Nt), right and left (2, n, n, C, Nt)."""
        cells = self.auxiliary.shape[1]
        sizes = (3, self.shape[0]), (2, cells), (2, cells)
        parts = [np.empty((count, self.n, self.n, size, self.basis.samples)) for count, size in sizes]
        sampled_tangents(self.system.line, samples, auxiliary, *parts)
        return parts

    def jacobian(self, samples, auxiliary, precision=float):
        """Return blocks diagonal (N, m, m), right and left (C, m, m) of the rows, m = n C, in a precision.

        auxiliary (Nt, C): tensions of the cells at the samples.
        """
        diagonal, right, left = (
            self.blocks(parts[0], parts[1], self.rows, precision, by_yddot=parts[2:])
            for parts in self.tangents(samples, auxiliary)
        )
        line = self.system.line
        is_prescribed = self.system.order.is_prescribed
        diagonal[is_prescribed] = np.eye(diagonal.shape[1])
        right[is_prescribed[line.first]] = 0.0
        left[is_prescribed[line.last]] = 0.0
        return diagonal, right, left
