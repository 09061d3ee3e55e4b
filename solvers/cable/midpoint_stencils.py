"""Four-node weights for a cell's midpoint value, slope and integral: fourth order in the size of the cells."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

_WIDTH = 4  # nodes; at the ends of the mesh they lie to one side


class Stencils(NamedTuple):
    """Weights (N - 1, 4) of the nodes ``at`` (N - 1, 4) for each cell: midpoint value and slope (1/m), integral (m).

    Exact for cubic polynomials; a mesh of three nodes has three weights a cell, exact for quadratic polynomials.
    """

    at: np.ndarray
    value: np.ndarray
    slope: np.ndarray
    integral: np.ndarray

    def __call__(self, q, *weights):
        """Return the sums (n, N - 1, *S) of the fields q (n, N, *S) with each of the weights."""
        at_nodes = [q[:, at] for at in self.at.T]
        shaped = lambda weight: weight.reshape(-1, *(1,) * (q.ndim - 2))
        return [sum(shaped(part) * of for part, of in zip(w.T, at_nodes, strict=True)) for w in weights]

    def quadrature(self) -> np.ndarray:
        """Return the weights (N,) of the nodes in the integral over the whole mesh, m."""
        weights = np.zeros(len(self.at) + 1)
        np.add.at(weights, self.at, self.integral)
        return weights


def midpoint_stencils(s) -> Stencils:
    """Return the stencils of the mesh s (N,), m."""
    width, cell = min(_WIDTH, s.size), np.arange(s.size - 1)
    first = np.clip(cell - width // 2 + 1, 0, s.size - width)
    at, h = first[:, None] + np.arange(width), np.diff(s)
    x = (s[at] - (s[1:, None] + s[:-1, None]) / 2) / h[:, None]  # the cell is -1/2 to 1/2
    power = np.arange(width)
    moments = np.zeros((width, 3))  # of 1, x, x^2, x^3: at 0, slope at 0, integral over the cell
    moments[0, 0] = moments[1, 1] = 1.0
    moments[:, 2] = np.where(power % 2, 0.0, 0.5**power / (power + 1))
    weights = np.linalg.solve(np.swapaxes(x[:, :, None] ** power, 1, 2), np.broadcast_to(moments, (h.size, width, 3)))
    value, slope, integral = np.moveaxis(weights, 2, 0)
    return Stencils(at, value, slope / h[:, None], integral * h[:, None])
