"""Steps of generalized-alpha linearised about a motion that they gave, compiled: the derivative of ``steps.integrate``.

With the formulas of a step, r'' = w_a dr + (known), v = w_v dr + (known), the rows at its end are
(K + w_v C + w_a M) dr = -C v* - M r''*, where v* and r''* follow from the start of the step alone.
"""

from __future__ import annotations

import numpy as np

from ..numerics.compiled import compiled
from . import elimination, equations, linearised_steps
from .elimination import factorise
from .equations import residual, tangents
from .linearised_steps import multiply_subtract, solve_columns


@compiled(calls=(equations, elimination))
def factorise_newmark(line, order, orbit, kept, weights, factors, by_own, by_last, by_first):
    """Set the factors of the S steps of an orbit, and the blocks that disturbances at their start meet.

    orbit: r, v, r'' (S, N, m) at the ends of the steps; kept (n,): the axes that are disturbed. weights: w_v and w_a.
    factors: diagonal (S, N, n, n), right and left (S, edges, n, n). by_own (S, 2, N, n, n): derivatives by v and
    r''; by_last and by_first (S, C, n, n): those by the v of the neighbours.
    """
    count, axes = orbit[0].shape[1:]
    n, cells = kept.size, line.length.size
    diagonal, right, left = factors
    R, T, unit = np.empty((count, axes)), np.empty(cells), np.empty((cells, axes))
    no_tension, apart = np.zeros(cells), (1.0, 1.0, 1.0)
    own = np.empty((3, count, axes, axes))
    last, first = np.empty((2, cells, axes, axes)), np.empty((2, cells, axes, axes))
    right[:], left[:] = 0.0, 0.0
    row = np.empty(n)
    for step in range(orbit[0].shape[0]):
        r, v, a = orbit[0][step], orbit[1][step], orbit[2][step]
        residual(line, r, v, a, no_tension, R, T, unit)
        tangents(line, r, v, a, T, apart, own, last, first)
        for j in range(n):
            for k in range(n):
                p, q = kept[j], kept[k]
                for i in range(count):
                    by_own[step, 0, i, j, k], by_own[step, 1, i, j, k] = own[1, i, p, q], own[2, i, p, q]
                    in_sum = weights[0] * own[1, i, p, q] + weights[1] * own[2, i, p, q]
                    diagonal[step, i, j, k] = own[0, i, p, q] + in_sum
                for c in range(cells):
                    by_last[step, c, j, k], by_first[step, c, j, k] = last[1, c, p, q], first[1, c, p, q]
                    right[step, c, j, k] = last[0, c, p, q] + weights[0] * last[1, c, p, q]
                    left[step, c, j, k] = first[0, c, p, q] + weights[0] * first[1, c, p, q]
        factorise(order, diagonal[step], right[step], left[step], row)


@compiled(calls=(linearised_steps,))
def take_newmark_steps(line, order, h, scheme, factors, by_own, by_last, by_first, state):
    """Replace disturbances d, v, r'' and a of a state (4, N, n, k), zero at prescribed nodes, by those after all steps.

    a: the algorithmic acceleration of generalized-alpha.
    """
    alpha_m, alpha_f, beta, gamma = scheme
    diagonal, right, left = factors
    d, v, acceleration, a = state
    nodes, n, columns = d.shape
    column, force = np.empty((n, columns)), np.empty(d.shape)
    w_v, w_a = gamma / (beta * h), (1 - alpha_m) / (1 - alpha_f) / (beta * h * h)
    for step in range(diagonal.shape[0]):
        for i in range(nodes):
            for j in range(n):
                for k in range(columns):  # what the end of the step has without a change of d there
                    old = a[i, j, k]
                    a[i, j, k] = -(d[i, j, k] + h * v[i, j, k]) / (beta * h * h) - (0.5 / beta - 1) * old
                    v[i, j, k] += h * ((1 - gamma) * old + gamma * a[i, j, k])
                    filtered = (1 - alpha_m) * a[i, j, k] + alpha_m * old - alpha_f * acceleration[i, j, k]
                    acceleration[i, j, k] = filtered / (1 - alpha_f)
        force[:] = 0.0
        for i in range(nodes):
            if not order.is_prescribed[i]:
                multiply_subtract(by_own[step, 0, i], v[i], force[i])
                multiply_subtract(by_own[step, 1, i], acceleration[i], force[i])
        for c in range(line.length.size):
            first, last = line.first[c], line.last[c]
            if not (order.is_prescribed[first] or order.is_prescribed[last]):
                multiply_subtract(by_last[step, c], v[last], force[first])
                multiply_subtract(by_first[step, c], v[first], force[last])
        solve_columns(order, diagonal[step], right[step], left[step], force, column)
        for i in range(nodes):
            if order.is_prescribed[i]:
                continue
            for j in range(n):
                for k in range(columns):
                    d[i, j, k] = force[i, j, k]
                    v[i, j, k] += w_v * force[i, j, k]
                    a[i, j, k] += force[i, j, k] / (beta * h * h)
                    acceleration[i, j, k] += w_a * force[i, j, k]
