"""Steps of generalized-alpha linearised about a motion that they gave, compiled: the derivative of ``steps.integrate``.

With the formulas of a step, r'' = w_a dr + (known), v = w_v dr + (known), the rows at its end are
(K + w_v C + w_a M) dr = -C v* - M r''*, where v* and r''* follow from the start of the step alone.
"""

from __future__ import annotations

import numpy as np

from ...numerics.compiled import compiled
from . import steps as linearised_steps
from .steps import set_right_side, solve_columns


@compiled(calls=(linearised_steps,))
def take_newmark_steps(line, order, h, scheme, factors, right_side, state):
    """Replace disturbances d, v, r'' and a of a state (4, N, n, k), zero at prescribed nodes, by those after all steps.

    a: the algorithmic acceleration of generalized-alpha. factors, right_side: as of ``factorise_steps``.
    """
    alpha_m, alpha_f, beta, gamma = scheme
    diagonal, right, left = factors
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
        set_right_side(line, order, right_side, step, v, acceleration, force)
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
