"""The linear pencil of a moving line about rest, for ``natural_modes``."""

from __future__ import annotations

import numpy as np
from scipy.sparse import bsr_array
from scipy.sparse.linalg import splu

from .. import equations


class LinePencil:
    """lambda^2 M + lambda C + K of a MooringSystem at rest, as a pencil in (displacements, velocities) of free nodes.

    size: twice the free coordinates, kept (size/2,) among all; whole: K, C and M with all nodes free.
    """

    def __init__(self, system):
        self.system = system
        nodes, n = system.nodes, len(system.axes)
        self.free = np.delete(np.arange(nodes), system.prescribed_nodes)
        self.kept = (n * self.free[:, None] + np.arange(n)).ravel()
        self.size = 2 * self.kept.size
        self.whole = [self.whole_matrix(weights) for weights in np.eye(3)]
        self.K, self.C, self.M = (matrix[self.kept][:, self.kept] for matrix in self.whole)

    def whole_matrix(self, weights):
        """Return the sparse matrix (N n, N n) of tangents at rest with weights of r, v and a, all nodes free."""
        system, n = self.system, len(self.system.axes)
        r, nodes = np.ascontiguousarray(system.rest.y.T), system.nodes
        line, cells = system.line, system.line.length.size
        diagonal, right, left = np.empty((nodes, n, n)), np.empty((cells, n, n)), np.empty((cells, n, n))
        still = np.zeros_like(r)
        tangents = (line, r, still, still, system.rest.tension, tuple(weights.tolist()))
        equations.tangents(*tangents, diagonal, right, left)
        rows = np.concatenate([np.arange(nodes), line.first, line.last])
        columns = np.concatenate([np.arange(nodes), line.last, line.first])
        order, starts = np.lexsort((columns, rows)), np.searchsorted(np.sort(rows), np.arange(nodes + 1))
        data = np.concatenate([diagonal, right, left])
        return bsr_array((data[order], columns[order], starts)).tocsc()

    def inverse(self, sigma):
        """Return the function (p, q) -> (u, w) of (A + sigma B)^-1 B, None where that is singular.

        A (u, w) = (-w, K u + C w), B (u, w) = (u, M w): eigenvalues -1/mu + sigma are those of the line.
        """
        try:
            factors = splu((self.K + sigma * self.C + sigma**2 * self.M).tocsc())
        except RuntimeError:
            return None

        def step(x):
            p, q = x[: self.size // 2], x[self.size // 2 :]
            u = factors.solve(self.M @ q + self.C @ p + sigma * (self.M @ p))
            return np.concatenate([u, sigma * u - p])

        return step

    def shapes(self, vectors) -> np.ndarray:
        """Return vectors (size, k) as displacements (n, N, k)."""
        n, count = len(self.system.axes), vectors.shape[1]
        shapes = np.zeros((self.system.nodes, n, count), dtype=vectors.dtype)
        shapes[self.free] = vectors[: self.size // 2].reshape(-1, n, count)
        return shapes.swapaxes(0, 1)
