"""Newton steps of many harmonics of moving lines without blocks: GMRES, preconditioned by linearised time steps.

Blocks take storage N Nh^2 and work N Nh^3, and a line that lies on a stiff seabed or goes slack takes hundreds of
harmonics. Products with the sampled tangents take N Nt alone, and so do steps of generalized-alpha with the same
tangents, from one sample to the next, which come near to the periodic solution soon after rest. They have all
harmonics: what their inverse leaves out is the coupling of those that are kept with those beyond Nh. That is small
where inertia outweighs the seabed's stiffness there, at three times the frequency of a node that swings on it.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse.linalg import LinearOperator, gmres

from ...numerics.compiled import compiled
from ...numerics.fourier import project_samples, sample_series
from ...numerics.lu import elimination
from ...numerics.lu.elimination import factorise, solve
from .. import equations
from ..equations import tangents
from ..stepping.steps import newmark_parameters
from .harmonic import MooringHarmonics

ITERATIVE_FROM = 200  # harmonics, from which on GMRES takes less time than blocks
MOST_IN_BLOCKS = 300  # harmonics, up to which blocks serve where GMRES gives up: 2 GB for fifty cells in a plane

ACCURACY = 1e-3  # of a Newton step, relative and preconditioned: with more, steps become no fewer
MOST_VECTORS = 80  # kept before GMRES gives up: harmonics that need more are too few
PERIODS = 1.5  # of the steps from rest; in the first half the force grows, or axial waves would ring for long
RHO_INF = 0.5  # spectral radius of the steps at infinite frequency


class IterativeHarmonics(MooringHarmonics):
    """Rows as of MooringHarmonics, transformed by FFT, whose Jacobian is solved with by GMRES.

    Where that gives up, blocks serve from then on; of more than MOST_IN_BLOCKS harmonics the step is not a number.
    """

    gives_up = False

    def samples(self, x) -> np.ndarray:
        """Return r, v, a (3, Nt, N, n) at the samples."""
        result = sample_series(self.basis, x.reshape(-1, self.shape[2]), 3)
        result = result.reshape(3, self.basis.samples, self.shape[0], self.n)
        result[0] += self.rest
        return result

    def project(self, R) -> np.ndarray:
        """Return the coefficients (N, n, C) of samples (Nt, N, n)."""
        return project_samples(self.basis, R.reshape(len(R), -1)).reshape(self.shape)

    def factorise(self, samples, auxiliary):
        """Return a function that solves with the Jacobian at the samples, None where that is singular."""
        if self.gives_up:
            return super().factorise(samples, auxiliary)
        auxiliary = auxiliary.copy()  # which the next linearisation changes
        newton, by_blocks = SampledNewton(self, samples, auxiliary), []  # type: ignore[var-annotated]

        def solve_or_use_blocks(F):
            if not by_blocks:
                step = newton.solve(F)
                if np.isfinite(step).all() or self.basis.harmonics > MOST_IN_BLOCKS:
                    return step
                self.gives_up = True
                by_blocks.append(super(IterativeHarmonics, self).factorise(samples, auxiliary))
            return np.full(F.shape, np.nan) if by_blocks[0] is None else by_blocks[0](F)

        return solve_or_use_blocks if np.isfinite(newton.factors[0]).all() else None


class SampledNewton:
    """Products with the Jacobian of IterativeHarmonics, and its approximate inverse, from tangents at the samples."""

    def __init__(self, balance, samples, auxiliary):
        self.balance, system = balance, balance.system
        basis, n, nodes, cells = balance.basis, balance.n, system.nodes, system.line.length.size
        self.prescribed, self.h = system.prescribed_nodes, 2 * np.pi / basis.omega / basis.samples
        self.scheme = newmark_parameters(RHO_INF)
        alpha_m, alpha_f, beta, gamma = self.scheme
        by_a = 1 / (beta * self.h**2)
        self.weights = 1.0, gamma / (beta * self.h), (1 - alpha_m) / (1 - alpha_f) * by_a
        self.tangents = tuple(
            np.empty((basis.samples, d, size, n, n)) for d, size in ((3, nodes), (2, cells), (2, cells))
        )
        edges = system.order.edges
        self.factors = tuple(np.zeros((basis.samples, size, n, n)) for size in (nodes, edges, edges))
        factorise_samples(system.line, system.order, samples, auxiliary, self.weights, *self.tangents, *self.factors)

    def solve(self, F) -> np.ndarray:
        """Return J^-1 F (N, n C); not a number where GMRES does not get there."""
        F = F.reshape(self.balance.shape[0], -1)
        given = np.zeros_like(F)
        given[self.prescribed] = F[self.prescribed]
        right = self.precondition(F - self.product(given) if given.any() else F).ravel()
        product = lambda x: self.precondition(self.product(x.reshape(F.shape))).ravel()
        operator = LinearOperator((right.size, right.size), product)
        x, info = gmres(operator, right, rtol=ACCURACY, atol=0.0, restart=MOST_VECTORS, maxiter=1)
        return x.reshape(F.shape) + given if info == 0 else np.full(F.shape, np.nan)

    def product(self, x) -> np.ndarray:
        """Return J x (N, n C) of coefficients x, in the rows of the nodes that are free."""
        balance, system = self.balance, self.balance.system
        states = sample_series(balance.basis, x.reshape(-1, balance.shape[2]), 3)
        R = np.zeros((balance.basis.samples, system.nodes, balance.n))
        multiply_samples(system.line, *self.tangents, states.reshape(3, *R.shape), R)
        return balance.project(R).reshape(x.shape)

    def precondition(self, F) -> np.ndarray:
        """Return nearly J^-1 F (N, n C), from the last period of time steps; zero at the nodes that are prescribed."""
        balance, system = self.balance, self.balance.system
        force = sample_series(balance.basis, F.reshape(-1, balance.shape[2]), 1)
        force = force.reshape(balance.basis.samples, system.nodes, balance.n)
        take_forced_steps(system.line, system.order, self.h, self.scheme, self.weights, *self.tangents, *self.factors,
                          round(PERIODS * len(force)), force, d := np.empty_like(force))  # fmt: skip
        return balance.project(d).reshape(F.shape)


# ---------------------------------------------------------------- loops over the samples
@compiled(calls=(equations, elimination))
def factorise_samples(line, order, samples, auxiliary, weights, own, right, left, diagonal, upper, lower):
    """Set tangents and factors at the samples r, v, a (S, N, n) with auxiliary tensions (S, C).

    own (S, 3, N, n, n), right and left (S, 2, C, n, n): the derivatives apart, as ``tangents`` has them. diagonal
    (S, N, n, n), upper and lower (S, edges, n, n), zero before: LU factors of their sums with these weights.
    """
    n, cells = own.shape[3], line.length.size
    row = np.empty(n)
    for s in range(own.shape[0]):
        tangents(line, samples[0][s], samples[1][s], samples[2][s], auxiliary[s], (1.0, 1.0, 1.0),
                 own[s], right[s], left[s])  # fmt: skip
        for j in range(n):
            for k in range(n):
                for i in range(own.shape[2]):
                    for d in range(3):
                        diagonal[s, i, j, k] += weights[d] * own[s, d, i, j, k]
                for c in range(cells):
                    for d in range(2):
                        upper[s, c, j, k] += weights[d] * right[s, d, c, j, k]
                        lower[s, c, j, k] += weights[d] * left[s, d, c, j, k]
        factorise(order, diagonal[s], upper[s], lower[s], row)


@compiled
def add_product(line, own, right, left, r, v, a, sign, R):
    """Add sign times the tangents of one sample times changes r, v and a (N, n) of the motion to R (N, n)."""
    n = r.shape[1]
    for i in range(r.shape[0]):
        for j in range(n):
            total = 0.0
            for k in range(n):
                total += own[0, i, j, k] * r[i, k] + own[1, i, j, k] * v[i, k] + own[2, i, j, k] * a[i, k]
            R[i, j] += sign * total
    for c in range(line.length.size):
        p, q = line.first[c], line.last[c]
        for j in range(n):
            at_first, at_last = 0.0, 0.0
            for k in range(n):
                at_first += right[0, c, j, k] * r[q, k] + right[1, c, j, k] * v[q, k]
                at_last += left[0, c, j, k] * r[p, k] + left[1, c, j, k] * v[p, k]
            R[p, j] += sign * at_first
            R[q, j] += sign * at_last


@compiled
def multiply_samples(line, own, right, left, states, R):
    """Add the tangents at the samples times changes r, v, a (3, S, N, n) to R (S, N, n)."""
    for s in range(R.shape[0]):
        add_product(line, own[s], right[s], left[s], states[0, s], states[1, s], states[2, s], 1.0, R[s])


@compiled(calls=(elimination,))
def take_forced_steps(line, order, h, scheme, weights, own, right, left, diagonal, upper, lower, steps, force, d):
    """Set d (S, N, n) to the end of so many steps of K d + C v + M r'' = force (S, N, n) from rest, S of them a period.

    The force grows over the steps before the last period. Tangents and factors as of ``factorise_samples``; prescribed
    nodes stay at rest.
    """
    (samples, nodes, n), (_, alpha_f, beta, _) = force.shape, scheme
    r, v, acceleration, a, R = np.zeros((5, nodes, n))
    column = np.empty(n)
    for step in range(-steps, 0):
        s = step % samples
        grown = min(1.0, (steps + step) / max(1, steps - samples))
        share = grown * grown * (3 - 2 * grown)
        for i in range(nodes):
            for k in range(n):
                R[i, k], old = share * force[s, i, k], a[i, k]
                r[i, k] += h * v[i, k] + h * h / 2 * old  # predicted with the old acceleration
                v[i, k] += h * old
                acceleration[i, k] = (old - alpha_f * acceleration[i, k]) / (1 - alpha_f)
        add_product(line, own[s], right[s], left[s], r, v, acceleration, -1.0, R)
        for i in range(nodes):
            if order.is_prescribed[i]:
                for k in range(n):
                    R[i, k] = 0.0
        solve(order, diagonal[s], upper[s], lower[s], R, column)
        for i in range(nodes):
            for k in range(n):
                r[i, k] += R[i, k]
                v[i, k] += weights[1] * R[i, k]
                a[i, k] += R[i, k] / (beta * h * h)
                acceleration[i, k] += weights[2] * R[i, k]
                d[s, i, k] = r[i, k]
