"""What a few neighbouring nodes say of the cell in their midst, to fourth order: middle, slope there, integral."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

_WIDTH = 4  # nodes; at the ends of the mesh they lie to one side


class Stencils(NamedTuple):
    """Weights (N - 1, 4) of the nodes ``at`` (N - 1, 4) for each cell: value and slope (1/m) of its middle, integral.

    Exact for cubic polynomials; a mesh of three nodes has three, and is exact for quadratic ones.
    """

    at: np.ndarray
    value: np.ndarray
    slope: np.ndarray
    integral: np.ndarray

    def __call__(self, q, *weights):
        """(n, N - 1, *S) of the fields q (n, N, *S) with each of the weights."""
        there = [q[:, at] for at in self.at.T]
        over = lambda weight: weight.reshape(-1, *(1,) * (q.ndim - 2))
        return [sum(over(part) * of for part, of in zip(weight.T, there, strict=True)) for weight in weights]


def stencils(s) -> Stencils:
    """Of a mesh s (N,), m."""
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
