"""Steps of the linearised motion of lines, M d'' + C d' + K d = 0 about an orbit, compiled.

Implicit Runge-Kutta steps with stages i of nodes c and weights a_ij, and accelerations q_j of the stages, have
d_i = d + h c_i v + h^2 sum (a^2)_ij q_j,  v_i = v + h sum a_ij q_j,  M_i q_i + C_i v_i + K_i d_i = 0,
so the q of all stages of a step are one system in the pattern of the line's cells, with blocks of stages times axes.
The steps of generalized-alpha have one stage and other weights of K, C and M. Factors and right-hand sides are
kept; many disturbances then take a step at once.
"""

from __future__ import annotations

import numpy as np

from ...numerics.compiled import compiled
from ...numerics.lu import elimination
from ...numerics.lu.elimination import factorise
from .. import equations
from ..equations import residual, tangents


@compiled(calls=(equations,))
def set_blocks(line, orbit, kept, weights, weight_of_M, right_weights, blocks, right_side):
    """Set the blocks and right-hand sides of S steps; return how many cells are slack at their stages.

    orbit: r, v, r'' (S, s, N, m) of the m axes at the s stages of each step; kept (n,): the axes that are disturbed.
    weights (2, s, s): of K_i and C_i in the block of stages i and j, weight_of_M: of M_i in that of i and i;
    right_weights (2, 3, s): of K_i, C_i and M_i in the products with the two disturbances that a step begins with.
    blocks: diagonal (S, N, s n, s n), upper and lower (S, edges, s n, s n). right_side: blocks of the nodes (S, 2, N,
    s n, n) and of the cells' ends by each other (S, 1 or 2, C, s n, n): 1 where the second disturbance is in M alone.
    """
    steps, stages, count, axes = orbit[0].shape
    n, cells = kept.size, line.length.size
    diagonal, upper, lower = blocks
    own, from_last, from_first = right_side
    R, T, unit = np.empty((count, axes)), np.empty(cells), np.empty((cells, axes))
    no_tension, apart = np.zeros(cells), (1.0, 1.0, 1.0)
    by_own = np.empty((3, count, axes, axes))
    by_last, by_first = np.empty((2, cells, axes, axes)), np.empty((2, cells, axes, axes))
    slack = 0
    upper[:], lower[:] = 0.0, 0.0
    for step in range(steps):
        for i in range(stages):
            r, v, a = orbit[0][step, i], orbit[1][step, i], orbit[2][step, i]
            residual(line, r, v, a, no_tension, R, T, unit)
            tangents(line, r, v, a, T, apart, by_own, by_last, by_first)
            slack += (T <= 0).sum()
            for j in range(n):
                for k in range(n):
                    p, q, row_j = kept[j], kept[k], i * n + j
                    for node in range(count):
                        K, C, M = by_own[0, node, p, q], by_own[1, node, p, q], by_own[2, node, p, q]
                        for side in range(2):
                            w = right_weights[side]
                            own[step, side, node, row_j, k] = w[0, i] * K + w[1, i] * C + w[2, i] * M
                        for l in range(stages):
                            in_row = weights[0, i, l] * K + weights[1, i, l] * C
                            diagonal[step, node, row_j, l * n + k] = in_row + (weight_of_M * M if l == i else 0.0)
                    for c in range(cells):
                        K, C = by_last[0, c, p, q], by_last[1, c, p, q]
                        K2, C2 = by_first[0, c, p, q], by_first[1, c, p, q]
                        for side in range(from_last.shape[1]):
                            w_K, w_C = right_weights[side, 0, i], right_weights[side, 1, i]
                            from_last[step, side, c, row_j, k] = w_K * K + w_C * C
                            from_first[step, side, c, row_j, k] = w_K * K2 + w_C * C2
                        for l in range(stages):
                            w_K, w_C = weights[0, i, l], weights[1, i, l]
                            upper[step, c, row_j, l * n + k] = w_K * K + w_C * C
                            lower[step, c, row_j, l * n + k] = w_K * K2 + w_C * C2
    return slack


@compiled(calls=(elimination,))
def factorise_steps(order, diagonal, upper, lower):
    """Replace the blocks of all steps by their factors."""
    row = np.empty(diagonal.shape[2])
    for step in range(diagonal.shape[0]):
        factorise(order, diagonal[step], upper[step], lower[step], row)


@compiled
def add_product(factor, blocks, e, x, i, y, q):
    """Add ``factor`` times the product of block e of blocks (.., m, n) and columns x[i] (n, k) to y[q] (m, k).

    Whole arrays and indices, for a slice of each costs more than the product of few columns; and up to three rows of x
    and two of y in one loop, for a loop over few columns costs more to begin than it takes.
    """
    rows, n, columns = blocks.shape[1], blocks.shape[2], x.shape[2]
    last = n - n % 3
    for p in range(0, last, 3):
        for j in range(0, rows - 1, 2):
            a, b, c = factor * blocks[e, j, p], factor * blocks[e, j, p + 1], factor * blocks[e, j, p + 2]
            f, g, h = factor * blocks[e, j + 1, p], factor * blocks[e, j + 1, p + 1], factor * blocks[e, j + 1, p + 2]
            for k in range(columns):
                u, v, w = x[i, p, k], x[i, p + 1, k], x[i, p + 2, k]
                y[q, j, k] += a * u + b * v + c * w
                y[q, j + 1, k] += f * u + g * v + h * w
        if rows % 2:
            j = rows - 1
            a, b, c = factor * blocks[e, j, p], factor * blocks[e, j, p + 1], factor * blocks[e, j, p + 2]
            for k in range(columns):
                y[q, j, k] += a * x[i, p, k] + b * x[i, p + 1, k] + c * x[i, p + 2, k]
    for j in range(rows):
        if n - last == 2:
            a, b = factor * blocks[e, j, last], factor * blocks[e, j, last + 1]
            for k in range(columns):
                y[q, j, k] += a * x[i, last, k] + b * x[i, last + 1, k]
        elif n - last == 1:
            a = factor * blocks[e, j, last]
            for k in range(columns):
                y[q, j, k] += a * x[i, last, k]


@compiled
def solve_columns(order, diagonal, upper, lower, x, column):
    """Replace columns x (N, m, k), zero at prescribed nodes, by the solutions, with the blocks of ``factorise``.

    column (1, m, k): working space.
    """
    nodes, m, columns = x.shape
    for i in range(nodes):
        for a in range(order.start[i], order.start[i + 1]):
            add_product(-1.0, lower, order.edge[a], x, i, x, order.other[a])
    for i in range(nodes - 1, -1, -1):
        if order.is_prescribed[i]:
            continue
        for j in range(m):
            for k in range(columns):
                column[0, j, k] = x[i, j, k]
                x[i, j, k] = 0.0
        for a in range(order.start[i], order.start[i + 1]):
            add_product(-1.0, upper, order.edge[a], x, order.other[a], column, 0)
        add_product(1.0, diagonal, i, column, 0, x, i)


@compiled
def set_right_side(order, ends, right_side, step, one, other, x):
    """Set x (N, m, k) to the right-hand side of a step that begins with two disturbances (N, n, k).

    ends: the first and the last nodes of the cells.
    """
    own, from_last, from_first = right_side
    side = from_last.shape[1] - 1
    own_one, own_other, last_one, last_other = own[step, 0], own[step, 1], from_last[step, 0], from_last[step, side]
    first_one, first_other = from_first[step, 0], from_first[step, side]
    x[:] = 0.0
    for i in range(x.shape[0]):
        if not order.is_prescribed[i]:
            add_product(1.0, own_one, i, one, i, x, i)
            add_product(1.0, own_other, i, other, i, x, i)
    for c in range(ends[0].size):
        first, last = ends[0][c], ends[1][c]
        if not (order.is_prescribed[first] or order.is_prescribed[last]):
            add_product(1.0, last_one, c, one, last, x, first)
            add_product(1.0, first_one, c, one, first, x, last)
            if side == 1:
                add_product(1.0, last_other, c, other, last, x, first)
                add_product(1.0, first_other, c, other, first, x, last)


@compiled
def take_steps(order, ends, h, by_velocity, by_position, factors, right_side, d, v):
    """Replace disturbances d and v (N, n, k), zero at prescribed nodes, by those after all steps.

    by_velocity, by_position (s,): weights of the stages' accelerations in v over h, in d over h^2.
    """
    diagonal, upper, lower = factors
    nodes, n, columns = d.shape
    m = diagonal.shape[2]
    x, column = np.empty((nodes, m, columns)), np.empty((1, m, columns))
    for step in range(diagonal.shape[0]):
        set_right_side(order, ends, right_side, step, d, v, x)
        solve_columns(order, diagonal[step], upper[step], lower[step], x, column)
        for i in range(nodes):
            for j in range(n):
                for k in range(columns):
                    d[i, j, k] += h * v[i, j, k]
                for s in range(by_velocity.size):
                    in_v, in_d = h * by_velocity[s], h * h * by_position[s]
                    for k in range(columns):
                        v[i, j, k] += in_v * x[i, s * n + j, k]
                        d[i, j, k] += in_d * x[i, s * n + j, k]


@compiled
def take_newmark_steps(order, ends, h, scheme, factors, right_side, state):
    """Replace disturbances d, v, r'' and a of a state (4, N, n, k), zero at prescribed nodes, by those after all steps.

    The derivative of ``stepping.steps.integrate``. With the formulas of a step, r'' = w_a dr + (known) and
    v = w_v dr + (known), the rows at its end are (K + w_v C + w_a M) dr = -C v* - M r''*, where v* and r''* follow from
    the start of the step alone. a: the algorithmic acceleration. right_side: as of ``set_blocks``.
    """
    alpha_m, alpha_f, beta, gamma = scheme
    diagonal, upper, lower = factors
    d, v, acceleration, a = state
    nodes, n, columns = d.shape
    column, force = np.empty((1, n, columns)), np.empty(d.shape)
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
        set_right_side(order, ends, right_side, step, v, acceleration, force)
        solve_columns(order, diagonal[step], upper[step], lower[step], force, column)
        for i in range(nodes):
            if order.is_prescribed[i]:
                continue
            for j in range(n):
                for k in range(columns):
                    d[i, j, k] = force[i, j, k]
                    v[i, j, k] += w_v * force[i, j, k]
                    a[i, j, k] += force[i, j, k] / (beta * h * h)
                    acceleration[i, j, k] += w_a * force[i, j, k]
