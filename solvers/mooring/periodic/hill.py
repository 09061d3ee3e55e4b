"""Hill's problem of moving lines: (J + mu D + mu^2 M) z = 0 for disturbances exp(mu t) times a series, by block LU.

With d = exp(mu t) z(t), d' = exp(mu t) (mu + d/dt) z and d'' = exp(mu t) (mu^2 + 2 mu d/dt + d^2/dt^2) z, so J is the
Jacobian of the harmonic balance, D has the blocks of C and twice those of the masses with rates, M those of the masses.
"""

from __future__ import annotations

import math

import numpy as np

from ...numerics.lu.block_elimination import BlockFactors


class LineHill:
    """The quadratic pencil of a MooringResponse; a mode is (z, mu z) of all nodes, ``size`` numbers.

    shape: of z, (N, n, C).
    """

    def __init__(self, response):
        rows = response.system.harmonic_residual(response.basis, None)
        samples = rows.samples(rows.pack(response.z))
        rows.auxiliary[:] = 0.0  # of evaluate, which then gives the tensions of the cells' own law
        tensions = rows.evaluate(rows.pack(response.z), samples)[1]
        by_own, *by_neighbours = rows.tangents(samples, tensions)
        none, blocks = np.zeros_like(by_own[0]), lambda *parts, **also: rows.blocks(*parts, rows.rows, float, **also)
        self.line, self.order, self.shape = response.system.line, response.system.order, rows.shape
        self.size = 2 * math.prod(rows.shape)
        self.J = (blocks(by_own[0], by_own[1], by_yddot=by_own[2:]), *(blocks(*part) for part in by_neighbours))
        self.D = (
            blocks(by_own[1], 2 * by_own[2]),
            *(blocks(part[1], np.zeros_like(part[1])) for part in by_neighbours),
        )
        self.M = blocks(by_own[2], none)
        self.is_free = ~self.order.is_prescribed

    def inverse(self, sigma):
        """Return the function whose eigenvalues are 1/(sigma - mu), None where mu = sigma is one of the exponents.

        A (u, w) = (-w, J u + D w), B (u, w) = (u, M w): (A + sigma B)^-1 B.
        """
        diagonal, right, left = (J + sigma * D for J, D in zip(self.J, self.D, strict=True))
        diagonal += sigma**2 * self.M
        factors = BlockFactors(self.order, self.line.first, self.line.last, diagonal, right, left)
        if factors.singular:
            return None

        def apply(x):
            p, q = x.reshape(2, self.shape[0], -1)
            F = self.multiply(self.D, p) + (self.M @ (q + sigma * p)[..., None])[..., 0]
            F[~self.is_free] = 0.0  # the elimination leaves the rows of prescribed nodes out
            u = factors.solve(F)
            return np.concatenate([u.ravel(), (sigma * u - p).ravel()])

        return apply

    def multiply(self, blocks, x):
        """Return the product of blocks and x (N, n C)."""
        diagonal, right, left = blocks
        result = (diagonal @ x[..., None])[..., 0]
        np.add.at(result, self.line.first, (right @ x[self.line.last][..., None])[..., 0])
        np.add.at(result, self.line.last, (left @ x[self.line.first][..., None])[..., 0])
        return result

    def series(self, modes):
        """Return z of modes (size, k) as coefficients (N n, C, k)."""
        return modes[: self.size // 2].reshape(-1, self.shape[2], modes.shape[1])
