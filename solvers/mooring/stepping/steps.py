"""The steps of generalized-alpha on a moving line, as one compiled loop.

It is one function, for each call inside it would pass and count all arrays: parted into predictor, corrector and
acceptance, put in line, it took 15 % longer on ten cells.
The forces at n + 1 balance the inertia there: no force is taken between two steps, where stiff cells that turn would be
too short. The acceleration r'' follows an algorithmic one a, and r and v follow from a by Newmark's formulas:
(1 - alpha_f) r''[n+1] + alpha_f r''[n] = (1 - alpha_m) a[n+1] + alpha_m a[n]
(Arnold and Bruels, Multibody Syst. Dyn. 18 (2007) 185). Newton's method solves for r at n + 1, with the tensions of the
cells as unknowns of their own.
"""

from __future__ import annotations

import numpy as np

from ...numerics.compiled import compiled
from ...numerics.lu import elimination
from ...numerics.lu.elimination import factorise, solve
from .. import equations
from ..equations import residual, tangents

MAX_ITERATIONS = 30  # of one step
FULL_STEPS = 15  # of Newton's method, before they are halved
MAX_CONTRACTION = 0.03  # with a slack cell: contraction above which new factors are cheaper than more iterations
REMAINDER = 0.1  # of the tolerance: what iterations to come may change, judged by the contraction of the last
LEAST_CONTRACTION = 0.02  # that is trusted: the first iteration takes what is stiff and linear away, which is most
REMEMBERED = 0.9  # of the wear of old factors, from a step that begins with new ones to the next: they are tried again


def newmark_parameters(rho_inf) -> tuple[float, float, float, float]:
    """Return alpha_m, alpha_f, beta, gamma of second order with this spectral radius at infinite frequency."""
    alpha_m, alpha_f = (2 * rho_inf - 1) / (rho_inf + 1), rho_inf / (rho_inf + 1)
    return alpha_m, alpha_f, (1 - alpha_m + alpha_f) ** 2 / 4, 0.5 - alpha_m + alpha_f


@compiled
def seabed_after_step(line, i, depth, speed, step, by_v):
    """Return about what the force of the seabed on node i in N changes by with a step in r, and by_v times it in v.

    depth, speed: greatest penetration in m and vertical speed in m/s of the node before and after.
    """
    n, slip = len(line.current), 0.0
    for k in range(n - 1):
        slip = max(slip, by_v * abs(step[i, k]))
    damping, growth = line.seabed_damping[i], 0.0
    if depth < line.contact_depth:
        growth = damping * speed / line.contact_depth
        damping *= depth / line.contact_depth
    normal = (line.seabed_stiffness[i] + growth + by_v * damping) * abs(step[i, n - 1])
    return normal + line.friction[i] * line.seabed_stiffness[i] * depth * min(1.0, slip / line.slip_speed)


@compiled
def law_after_step(line, c, r, v, step, by_v):
    """Return the tension in N that the law gives to cell c once r less ``step`` and v less by_v times it are taken."""
    square, opening, first, last = 0.0, 0.0, line.first[c], line.last[c]
    for k in range(len(line.current)):
        change = step[last, k] - step[first, k]
        d = r[last, k] - r[first, k] - change
        square += d * d
        opening += d * (v[last, k] - v[first, k] - by_v * change)
    distance = np.sqrt(square)
    return line.EA[c] * (distance / line.length[c] - 1 + line.damping[c] * opening / (distance * line.length[c]))


@compiled(calls=(equations, elimination))
def integrate(
    line, order, driven, path, source, h, scheme, scale, tolerance, rest, state, auxiliary, record, every, stop
):
    """Take a step of generalized-alpha for each row but the first of ``path`` (S + 1, 3, P, n); stop where one fails.

    order: the Elimination; driven (P,): the nodes whose motion is prescribed; path: their r, v, r'' at the ends of the
    steps. source (S, N, n): load added at n + 1, N, or empty. scheme: (alpha_m, alpha_f, beta, gamma). scale: tension
    in N and length in m that errors refer to; the largest change of a tension from ``rest`` (C,) so far over the
    former, which the tolerance refers to, and which grows; the error that rounding makes. state: r, v, r'', a and the a
    before (N, n), and auxiliary (C,): left at the last step that was taken. record: r, v, r'' (K, N, n) of every
    ``every``-th step. stop: end after a step with slack.
    Returns steps, iterations, factorisations and the error of the last iteration: the largest change of a tension or
    position, relative to ``scale``.
    A factorisation serves another step while two iterations are foreseen to do: its contraction of the error grows with
    its age in steps, by its wear at each. Nothing is foreseen of cells that turn taut and slack.
    """
    r, v, acceleration, a, before = state
    nodes, n = r.shape[0], len(line.current)
    alpha_m, alpha_f, beta, gamma = scheme
    cells = line.length.size
    r1, v1, a1 = np.empty((nodes, n)), np.empty((nodes, n)), np.empty((nodes, n))
    new_acceleration, R = np.empty((nodes, n)), np.empty((nodes, n))
    T, unit, column = np.empty(cells), np.empty((cells, n)), np.empty(n)
    diagonal, right, left = np.empty((nodes, n, n)), np.empty((order.edges, n, n)), np.empty((order.edges, n, n))
    iterations, factorisations, error, factorised, slack = 0, 0, 0.0, False, False
    age, wear, first_error = 0, 0.0, 0.0  # the latter of the step before
    by_v, by_a = gamma / (beta * h), 1 / (beta * h * h)
    weights = (1.0, by_v, (1 - alpha_m) / (1 - alpha_f) * by_a)
    axial = line.EA / line.length * (1 + by_v * line.damping)  # change of a tension by the length of its cell
    kept, taut, lies = auxiliary.copy(), np.zeros(cells, np.bool_), np.zeros(nodes, np.bool_)  # in the factors
    for step in range(path.shape[0] - 1):
        kept[:], solved = auxiliary, False
        limit = max(tolerance * scale[2], scale[3])
        age += 1
        if factorised and not slack and wear * age * first_error > limit:  # as is foreseen of the second iteration
            wear *= REMEMBERED
            factorised = False
        for attempt in range(2):  # predicted with a steady change of acceleration, then with a steady velocity
            for i in range(nodes):
                for k in range(n):
                    a1[i, k] = 2 * a[i, k] - before[i, k] if attempt == 0 else (1 - 0.5 / beta) * a[i, k]
                    filtered = (1 - alpha_m) * a1[i, k] + alpha_m * a[i, k] - alpha_f * acceleration[i, k]
                    new_acceleration[i, k] = filtered / (1 - alpha_f)
                    r1[i, k] = r[i, k] + h * v[i, k] + h * h * ((0.5 - beta) * a[i, k] + beta * a1[i, k])
                    v1[i, k] = v[i, k] + h * ((1 - gamma) * a[i, k] + gamma * a1[i, k])
            for p in range(driven.size):
                for k in range(n):
                    r1[driven[p], k], v1[driven[p], k] = path[step + 1, 0, p, k], path[step + 1, 1, p, k]
                    a1[driven[p], k] = new_acceleration[driven[p], k] = path[step + 1, 2, p, k]
            if attempt == 1:
                auxiliary[:], factorised = kept, False
            last = np.inf
            for iteration in range(MAX_ITERATIONS):
                if iteration >= FULL_STEPS:
                    auxiliary[:] = 0.0
                residual(line, r1, v1, new_acceleration, auxiliary, R, T, unit)
                if iteration >= FULL_STEPS:
                    auxiliary[:] = T
                if source.shape[0] > 0:
                    for i in range(nodes):
                        for k in range(n):
                            R[i, k] -= source[step, i, k]
                for p in range(driven.size):
                    for k in range(n):
                        R[driven[p], k] = 0.0
                iterations += 1
                if not factorised:
                    tangents(line, r1, v1, new_acceleration, auxiliary, weights, diagonal, right, left)
                    factorise(order, diagonal, right, left, column)
                    factorisations += 1
                    factorised, age = True, 0
                    for c in range(cells):
                        taut[c] = T[c] != 0
                    for i in range(nodes):
                        lies[i] = r1[i, n - 1] < line.floor
                solve(order, diagonal, right, left, R, column)
                largest_step, largest_force, is_finite, regime_changed, slack = 0.0, 0.0, True, False, False
                for i in range(nodes):
                    regime_changed = regime_changed or (r1[i, n - 1] < line.floor) != lies[i]
                    depth = line.floor - min(r1[i, n - 1], r1[i, n - 1] - R[i, n - 1])
                    if depth > 0:
                        speed = max(abs(v1[i, n - 1]), abs(v1[i, n - 1] - by_v * R[i, n - 1]))
                        largest_force = max(largest_force, seabed_after_step(line, i, depth, speed, R, by_v))
                    for k in range(n):
                        largest_step = max(largest_step, abs(R[i, k]))
                        is_finite = is_finite and abs(R[i, k]) < np.inf
                for c in range(cells):
                    slack, regime_changed = slack or T[c] == 0, regime_changed or (T[c] != 0) != taut[c]
                    change = 0.0
                    for k in range(n):
                        change -= unit[c, k] * (R[line.last[c], k] - R[line.first[c], k])
                    change *= axial[c]
                    if T[c] != 0:
                        largest_force = max(largest_force, abs(change), -(T[c] + change))
                        auxiliary[c] = T[c] + change
                    else:
                        law = law_after_step(line, c, r1, v1, R, by_v)
                        largest_force = max(largest_force, law)  # of a cell that the step stretches
                        auxiliary[c] = 0.0
                error = max(largest_step / scale[1] * max(1.0, scale[2]), largest_force / scale[0])
                error = error if is_finite else np.inf
                contraction = error / last  # zero at the first
                if iteration == 0:
                    first_error = error
                elif iteration == 1 and age > 0:
                    wear = contraction / age
                solved = error <= limit
                if iteration > 0 and not slack:
                    solved = solved or max(contraction, LEAST_CONTRACTION) * error <= REMAINDER * limit
                if solved and regime_changed:  # old factors are too stiff where cells went slack, nodes lifted
                    solved, factorised = False, False
                part = 1.0 if solved or iteration < FULL_STEPS else 0.5  # cells that turn taut and slack by turns
                for i in range(nodes):
                    for k in range(n):
                        r1[i, k] -= part * R[i, k]
                        v1[i, k] -= part * by_v * R[i, k]
                        a1[i, k] -= part * by_a * R[i, k]
                        new_acceleration[i, k] -= part * weights[2] * R[i, k]
                if solved or not error < np.inf:
                    break
                is_slow = contraction > MAX_CONTRACTION if slack else contraction**2 * error > limit
                if is_slow:
                    factorised = False
                last = error
            if solved:
                break
        if not solved:
            auxiliary[:] = kept
            return step, iterations, factorisations, error
        for i in range(nodes):
            for k in range(n):
                before[i, k] = a[i, k]
                r[i, k], v[i, k], a[i, k] = r1[i, k], v1[i, k], a1[i, k]
                acceleration[i, k] = new_acceleration[i, k]
        for c in range(cells):
            scale[2] = max(scale[2], abs(T[c] - rest[c]) / scale[0])
        if (step + 1) % every == 0:
            for i in range(nodes):
                for k in range(n):
                    at = (step + 1) // every - 1
                    record[0][at, i, k], record[1][at, i, k], record[2][at, i, k] = r[i, k], v[i, k], acceleration[i, k]
        if stop and slack:
            return step + 1, iterations, factorisations, error
    return path.shape[0] - 1, iterations, factorisations, error
