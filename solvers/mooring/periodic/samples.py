"""Equations of moving lines at the samples of a periodic motion: compiled loops over ``equations``."""

from __future__ import annotations

import numpy as np

from ...numerics.compiled import compiled
from .. import equations
from ..equations import residual, tangents


@compiled(calls=(equations,))
def sampled_residual(line, samples, auxiliary, R, T, unit):
    """Set R (S, N, n), T (S, C) and unit (S, C, n) at samples: r, v, a (S, N, n) with auxiliary tensions (S, C)."""
    for k in range(R.shape[0]):
        residual(line, samples[0][k], samples[1][k], samples[2][k], auxiliary[k], R[k], T[k], unit[k])


@compiled
def predict_tensions(line, samples, last, T, unit, auxiliary):
    """Set auxiliary (S, C) to T plus what a linear step from the samples ``last`` (3, S, N, n) changes it by.

    T and unit (S, C, n): tensions and directions at ``last``. Slack cells stay slack.
    """
    n = unit.shape[2]
    for s in range(T.shape[0]):
        for c in range(T.shape[1]):
            first, final, t = line.first[c], line.last[c], unit[s, c]
            along, distance, stretch = 0.0, 0.0, 0.0
            for k in range(n):
                along += t[k] * (last[1, s, final, k] - last[1, s, first, k])
                distance += t[k] * (last[0, s, final, k] - last[0, s, first, k])
            for k in range(n):
                velocity = last[1, s, final, k] - last[1, s, first, k]
                moved = samples[0, s, final, k] - samples[0, s, first, k] - last[0, s, final, k] + last[0, s, first, k]
                change = samples[1, s, final, k] - samples[1, s, first, k] - velocity
                turned = (velocity - along * t[k]) * moved / distance
                stretch += t[k] * moved + line.damping[c] * (t[k] * change + turned)
            auxiliary[s, c] = T[s, c] + line.EA[c] / line.length[c] * stretch if T[s, c] != 0 else 0.0


@compiled(calls=(equations,))
def sampled_tangents(line, samples, auxiliary, diagonal, right, left):
    """Set the derivatives apart as ``tangents``, diagonal (3, n, n, N, S), right and left (2, n, n, C, S)."""
    n, (count, nodes), cells = len(line.current), samples[0].shape[:2], line.length.size
    D, U, L = np.empty((3, nodes, n, n)), np.empty((2, cells, n, n)), np.empty((2, cells, n, n))
    for s in range(count):
        tangents(line, samples[0][s], samples[1][s], samples[2][s], auxiliary[s], (1.0, 1.0, 1.0), D, U, L)
        for j in range(n):
            for k in range(n):
                for d in range(3):
                    for i in range(nodes):
                        diagonal[d, j, k, i, s] = D[d, i, j, k]
                for d in range(2):
                    for c in range(cells):
                        right[d, j, k, c, s], left[d, j, k, c, s] = U[d, c, j, k], L[d, c, j, k]
