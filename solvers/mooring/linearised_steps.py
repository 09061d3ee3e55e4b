"""Implicit Runge-Kutta steps of the linearised motion of lines, M d'' + C d' + K d = 0 about an orbit, compiled.

With stages i of nodes c and weights a_ij, and accelerations q_j of the stages,
d_i = d + h c_i v + h^2 sum (a^2)_ij q_j,  v_i = v + h sum a_ij q_j,  M_i q_i + C_i v_i + K_i d_i = 0,
so the q of all stages of a step are one system in the pattern of the line's cells, with blocks of stages times axes.
Its factors are kept, and so are C_i and K_i; many disturbances then take a step at once.
"""

from __future__ import annotations

import numpy as np

from ..numerics.compiled import compiled
from . import elimination, equations
from .elimination import factorise
from .equations import residual, tangents


@compiled(calls=(equations, elimination))
def factorise_steps(line, order, orbit, kept, h, nodes, weights, factors, right_side):
    """Set the factors and right-hand sides of S steps of h in s; return how many cells are slack at their stages.

    orbit: r, v, r'' (S, s, N, m) of the m axes at the s stages of each step; kept (n,): the axes that are disturbed.
    nodes (s,), weights (s, s): of the scheme. factors: diagonal (S, N, s n, s n), right and left (S, edges, s n, s n).
    right_side: the same of -K_i and -C_i - h c_i K_i, (S, 2, N or C, s n, n).
    """
    steps, stages, count, axes = orbit[0].shape
    n, cells = kept.size, line.length.size
    diagonal, right, left = factors
    own, from_last, from_first = right_side
    squared = weights @ weights
    R, T, unit = np.empty((count, axes)), np.empty(cells), np.empty((cells, axes))
    no_tension, apart = np.zeros(cells), (1.0, 1.0, 1.0)
    by_own = np.empty((3, count, axes, axes))
    by_last, by_first = np.empty((2, cells, axes, axes)), np.empty((2, cells, axes, axes))
    slack, row = 0, np.empty(stages * n)
    for step in range(steps):
        right[step], left[step] = 0.0, 0.0
        for i in range(stages):
            r, v, a = orbit[0][step, i], orbit[1][step, i], orbit[2][step, i]
            residual(line, r, v, a, no_tension, R, T, unit)
            tangents(line, r, v, a, T, apart, by_own, by_last, by_first)
            slack += (T <= 0).sum()
            for j in range(n):
                for k in range(n):
                    p, q = kept[j], kept[k]
                    for node in range(count):
                        K, C = by_own[0, node, p, q], by_own[1, node, p, q]
                        own[step, 0, node, i * n + j, k] = -K
                        own[step, 1, node, i * n + j, k] = -C - h * nodes[i] * K
                        for l in range(stages):
                            value = h * weights[i, l] * C + h * h * squared[i, l] * K
                            if l == i:
                                value += by_own[2, node, p, q]
                            diagonal[step, node, i * n + j, l * n + k] = value
                    for c in range(cells):
                        K, C = by_last[0, c, p, q], by_last[1, c, p, q]
                        from_last[step, 0, c, i * n + j, k] = -K
                        from_last[step, 1, c, i * n + j, k] = -C - h * nodes[i] * K
                        K2, C2 = by_first[0, c, p, q], by_first[1, c, p, q]
                        from_first[step, 0, c, i * n + j, k] = -K2
                        from_first[step, 1, c, i * n + j, k] = -C2 - h * nodes[i] * K2
                        for l in range(stages):
                            by_v, by_r = h * weights[i, l], h * h * squared[i, l]
                            right[step, c, i * n + j, l * n + k] = by_v * C + by_r * K
                            left[step, c, i * n + j, l * n + k] = by_v * C2 + by_r * K2
        factorise(order, diagonal[step], right[step], left[step], row)
    return slack


@compiled
def multiply_add(block, x, y):
    """Add the product of a block (m, n) and columns x (n, k) to y (m, k)."""
    for j in range(y.shape[0]):
        for p in range(x.shape[0]):
            factor = block[j, p]
            for k in range(y.shape[1]):
                y[j, k] += factor * x[p, k]


@compiled
def multiply_subtract(block, x, y):
    """Subtract the product of a block (m, n) and columns x (n, k) from y (m, k)."""
    for j in range(y.shape[0]):
        for p in range(x.shape[0]):
            factor = block[j, p]
            for k in range(y.shape[1]):
                y[j, k] -= factor * x[p, k]


@compiled
def solve_columns(order, diagonal, right, left, x, column):
    """Replace columns x (N, m, k), zero at prescribed nodes, by the solutions, with the blocks of ``factorise``.

    column (m, k): working space.
    """
    nodes = x.shape[0]
    for i in range(nodes):
        for a in range(order.start[i], order.start[i + 1]):
            multiply_subtract(left[order.edge[a]], x[i], x[order.other[a]])
    for i in range(nodes - 1, -1, -1):
        if order.is_prescribed[i]:
            continue
        column[:] = x[i]
        for a in range(order.start[i], order.start[i + 1]):
            multiply_subtract(right[order.edge[a]], x[order.other[a]], column)
        x[i] = 0.0
        multiply_add(diagonal[i], column, x[i])


@compiled
def take_steps(line, order, h, by_velocity, by_position, factors, right_side, d, v):
    """Replace disturbances d and v (N, n, k), zero at prescribed nodes, by those after all steps.

    by_velocity, by_position (s,): weights of the stages' accelerations in v over h, in d over h^2.
    """
    diagonal, right, left = factors
    own, from_last, from_first = right_side
    nodes, n, columns = d.shape
    x, column = np.empty((nodes, diagonal.shape[2], columns)), np.empty((diagonal.shape[2], columns))
    for step in range(diagonal.shape[0]):
        x[:] = 0.0
        for i in range(nodes):
            if not order.is_prescribed[i]:
                multiply_add(own[step, 0, i], d[i], x[i])
                multiply_add(own[step, 1, i], v[i], x[i])
        for c in range(line.length.size):
            first, last = line.first[c], line.last[c]
            if not (order.is_prescribed[first] or order.is_prescribed[last]):
                multiply_add(from_last[step, 0, c], d[last], x[first])
                multiply_add(from_last[step, 1, c], v[last], x[first])
                multiply_add(from_first[step, 0, c], d[first], x[last])
                multiply_add(from_first[step, 1, c], v[first], x[last])
        solve_columns(order, diagonal[step], right[step], left[step], x, column)
        for i in range(nodes):
            for j in range(n):
                for k in range(columns):
                    d[i, j, k] += h * v[i, j, k]
                for s in range(by_velocity.size):
                    in_v, in_d = h * by_velocity[s], h * h * by_position[s]
                    for k in range(columns):
                        v[i, j, k] += in_v * x[i, s * n + j, k]
                        d[i, j, k] += in_d * x[i, s * n + j, k]
