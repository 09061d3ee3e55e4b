"""Equations of a moving line of nodes and elements, and the loops that integrate them: compiled, in two or three axes.

A cell c joins nodes c and c + 1: d = r[c+1] - r[c], t = d/|d|, e = |d|/l - 1, e' = t.(v[c+1] - v[c])/l, and its tension
is T = EA (e + beta e') while that is positive, else 0. Half of its mass, added mass and drag stands at either end, with
that cell's t. The last axis points up; the number of axes is that of ``Line.current``, a constant for the compiler.

The residual R of a node is its inertia less the forces on it:
(m + ma) a - ma (a.t) t  of half a cell  -+ T t + drag - load - seabed.
Numba looks for changes in no other file, so what the loops call stands here.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..numerics.compiled import compiled

MAX_ITERATIONS = 30  # of one step
MAX_CONTRACTION = 0.03  # contraction above which a new factorisation is cheaper than more iterations with the old one


class Line(NamedTuple):
    """Cells (C,) and nodes (N,) of a line; n axes.

    length m, EA N, damping s, mass and added_mass kg/m: of the cells. normal_drag and tangential_drag: 1/2 rho d Cdn
    and 1/2 rho pi d Cdt, kg/m^2. point_mass kg and load (N, n) N: of the nodes, weight included. seabed_stiffness N/m,
    seabed_damping N s/m and friction: of the nodes, over a floor at height ``floor`` in m. slip_speed m/s: at which
    friction reaches 0.7 of Coulomb's. current: n floats, m/s.
    """

    length: np.ndarray
    EA: np.ndarray
    damping: np.ndarray
    mass: np.ndarray
    added_mass: np.ndarray
    normal_drag: np.ndarray
    tangential_drag: np.ndarray
    point_mass: np.ndarray
    load: np.ndarray
    seabed_stiffness: np.ndarray
    seabed_damping: np.ndarray
    friction: np.ndarray
    floor: float
    slip_speed: float
    current: tuple


# ---------------------------------------------------------------- one state
@compiled
def residual(line, r, v, a, auxiliary, R, T, unit):
    """Set R (N, n) in N to inertia less forces, T (C,) in N to the tensions, unit (C, n) to t.

    auxiliary (C,): the tension of each cell as Newton's method has it, an unknown of its own beside the positions. A
    cell is taut where that or the law is positive (a primal-dual active set), else its tension is zero.
    """
    n, nodes = len(line.current), r.shape[0]
    for i in range(nodes):
        for k in range(n):
            R[i, k] = line.point_mass[i] * a[i, k] - line.load[i, k]
        seabed(line, r, v, i, R)
    for c in range(nodes - 1):
        l, square, rate = line.length[c], 0.0 * r[0, 0], 0.0 * r[0, 0]
        for k in range(n):
            unit[c, k] = r[c + 1, k] - r[c, k]
            square += unit[c, k] * unit[c, k]
        distance = np.sqrt(square)
        for k in range(n):
            unit[c, k] /= distance
            rate += unit[c, k] * (v[c + 1, k] - v[c, k])
        T[c] = line.EA[c] * (distance / l - 1 + line.damping[c] * rate / l)
        if T[c].real <= 0 and auxiliary[c] <= 0:
            T[c] = 0.0
        else:
            for k in range(n):
                R[c, k] -= T[c] * unit[c, k]
                R[c + 1, k] += T[c] * unit[c, k]
        half, stretch = l / 2, np.sqrt(distance / l)
        for i in range(c, c + 2):
            along, across, inertia = 0.0 * r[0, 0], 0.0 * r[0, 0], 0.0 * r[0, 0]
            for k in range(n):
                along += (v[i, k] - line.current[k]) * unit[c, k]
                inertia += a[i, k] * unit[c, k]
            for k in range(n):
                across += (v[i, k] - line.current[k] - along * unit[c, k]) ** 2
            normal = half * stretch * line.normal_drag[c] * np.sqrt(across)
            tangential = half * stretch * line.tangential_drag[c] * (along if along.real > 0 else -along)
            by_t = (tangential - normal) * along - half * line.added_mass[c] * inertia
            for k in range(n):
                R[i, k] += half * (line.mass[c] + line.added_mass[c]) * a[i, k] + by_t * unit[c, k]
                R[i, k] += normal * (v[i, k] - line.current[k])


@compiled
def seabed(line, r, v, i, R):
    """Subtract the seabed's normal force, which never pulls, and its regularised friction from R[i]."""
    n, penetration = len(line.current), line.floor - r[i, -1]
    if penetration.real <= 0:
        return
    normal = line.seabed_stiffness[i] * penetration - line.seabed_damping[i] * v[i, -1]
    if normal.real <= 0:
        return
    R[i, -1] -= normal
    square = line.slip_speed**2 + 0.0 * v[0, 0]
    for k in range(n - 1):
        square += v[i, k] * v[i, k]
    for k in range(n - 1):
        R[i, k] += line.friction[i] * normal * v[i, k] / np.sqrt(square)


@compiled
def tangents(line, r, v, a, auxiliary, weights, diagonal, right, left):
    """Set diagonal (N, n, n), right and left (C, n, n) to w_r dR/dr + w_v dR/dv + w_a dR/da.

    right[c] is of R[c] by node c + 1, left[c] of R[c + 1] by node c. A cell turns with its auxiliary tension.
    """
    n, nodes, (w_r, w_v, w_a) = len(line.current), r.shape[0], weights
    unit, normal = np.empty(n), np.empty(n)
    diagonal[:] = 0.0
    for i in range(nodes):
        for k in range(n):
            diagonal[i, k, k] = w_a * line.point_mass[i]
        seabed_tangents(line, r, v, i, w_r, w_v, diagonal)
    for c in range(nodes - 1):
        l, square, rate = line.length[c], 0.0, 0.0
        for k in range(n):
            unit[k] = r[c + 1, k] - r[c, k]
            square += unit[k] * unit[k]
        distance = np.sqrt(square)
        for k in range(n):
            unit[k] /= distance
            rate += unit[k] * (v[c + 1, k] - v[c, k])
        taut = 1.0 if auxiliary[c] > 0 or distance / l - 1 + line.damping[c] * rate / l > 0 else 0.0
        axial = taut * (w_r + w_v * line.damping[c]) * line.EA[c] / l
        lateral = w_r * max(auxiliary[c], 0.0) / distance
        turning = taut * w_r * line.EA[c] * line.damping[c] / (l * distance)  # the rate of strain as the cell turns
        for j in range(n):
            for k in range(n):
                tt = unit[j] * unit[k]
                across = v[c + 1, k] - v[c, k] - rate * unit[k]
                G = axial * tt + lateral * ((1.0 if j == k else 0.0) - tt) + turning * unit[j] * across
                diagonal[c, j, k] += G
                diagonal[c + 1, j, k] += G
                right[c, j, k] = -G
                left[c, j, k] = -G
        half, stretch = l / 2, np.sqrt(distance / l)
        ma = half * line.added_mass[c]
        for side in range(2):
            i, sign, along, inertia, speed = c + side, 2.0 * side - 1, 0.0, 0.0, 0.0
            for k in range(n):
                along += (v[i, k] - line.current[k]) * unit[k]
                inertia += a[i, k] * unit[k]
            for k in range(n):
                normal[k] = v[i, k] - line.current[k] - along * unit[k]
                speed += normal[k] * normal[k]
            speed = np.sqrt(speed)
            cn, ct = half * stretch * line.normal_drag[c], half * stretch * line.tangential_drag[c]
            sharp = cn / speed if speed > 0 else 0.0
            for j in range(n):
                force = cn * speed * normal[j] + ct * abs(along) * along * unit[j]
                for k in range(n):
                    tt = unit[j] * unit[k]
                    P = (1.0 if j == k else 0.0) - tt
                    by_normal = cn * speed * P + sharp * normal[j] * normal[k]
                    own = w_v * (by_normal + 2 * ct * abs(along) * tt)
                    own += w_a * (half * line.mass[c] * (tt + P) + ma * P)
                    turn = -cn * speed * unit[j] * normal[k] - along * by_normal
                    turn += ct * abs(along) * (2 * unit[j] * normal[k] + along * P)
                    turn -= ma * (unit[j] * (a[i, k] - inertia * unit[k]) + inertia * P)
                    turn = sign * w_r * (turn + force * unit[k] / 2) / distance
                    if side == 0:
                        diagonal[i, j, k] += own + turn
                        right[c, j, k] -= turn
                    else:
                        diagonal[i, j, k] += own + turn
                        left[c, j, k] -= turn


@compiled
def seabed_tangents(line, r, v, i, w_r, w_v, diagonal):
    """Add the tangents of the seabed's forces on node i to diagonal[i]."""
    n, k, c = len(line.current), line.seabed_stiffness[i], line.seabed_damping[i]
    penetration = line.floor - r[i, -1]
    normal = k * penetration - c * v[i, -1]
    if penetration <= 0 or normal <= 0:
        return
    by_height = w_r * k + w_v * c
    diagonal[i, -1, -1] += by_height
    square = line.slip_speed**2
    for p in range(n - 1):
        square += v[i, p] * v[i, p]
    root = np.sqrt(square)
    for p in range(n - 1):
        diagonal[i, p, p] += w_v * line.friction[i] * normal / root
        diagonal[i, p, -1] -= line.friction[i] * by_height * v[i, p] / root
        for q in range(n - 1):
            diagonal[i, p, q] -= w_v * line.friction[i] * normal * v[i, p] * v[i, q] / (square * root)


# ---------------------------------------------------------------- block-tridiagonal LU
@compiled
def factorise(line, diagonal, right, left, prescribed):
    """Replace the blocks by their LU factors, diagonal ones by inverses; rows of prescribed nodes are those of 1."""
    n, nodes = len(line.current), diagonal.shape[0]
    row = np.empty(n)
    for i in range(nodes):
        if prescribed[i]:
            for j in range(n):
                for k in range(n):
                    diagonal[i, j, k] = 1.0 if j == k else 0.0
                    if i < nodes - 1:
                        right[i, j, k] = 0.0
                    if i > 0:
                        left[i - 1, j, k] = 0.0
            continue
        if i > 0:
            for j in range(n):
                for k in range(n):
                    row[k] = left[i - 1, j, k]
                for k in range(n):
                    total = 0.0
                    for p in range(n):
                        total += row[p] * diagonal[i - 1, p, k]
                    left[i - 1, j, k] = total
                for k in range(n):
                    for p in range(n):
                        diagonal[i, j, k] -= left[i - 1, j, p] * right[i - 1, p, k]
        for p in range(n):  # Gauss and Jordan
            pivot = 1 / diagonal[i, p, p]
            diagonal[i, p, p] = 1.0
            for k in range(n):
                diagonal[i, p, k] *= pivot
            for j in range(n):
                if j != p:
                    factor = diagonal[i, j, p]
                    diagonal[i, j, p] = 0.0
                    for k in range(n):
                        diagonal[i, j, k] -= factor * diagonal[i, p, k]


@compiled
def solve(line, diagonal, right, left, x):
    """Replace x (N, n) by the solution for that right-hand side; the blocks as ``factorise`` leaves them."""
    n, nodes = len(line.current), x.shape[0]
    for i in range(1, nodes):
        for j in range(n):
            total = x[i, j]
            for k in range(n):
                total -= left[i - 1, j, k] * x[i - 1, k]
            x[i, j] = total
    column = np.empty(n)
    for i in range(nodes - 1, -1, -1):
        for j in range(n):
            column[j] = x[i, j]
            if i < nodes - 1:
                for k in range(n):
                    column[j] -= right[i, j, k] * x[i + 1, k]
        for j in range(n):
            total = 0.0
            for k in range(n):
                total += diagonal[i, j, k] * column[k]
            x[i, j] = total


# ---------------------------------------------------------------- time
@compiled
def integrate(line, held, path, source, h, scheme, scale, tolerance, rest, state, auxiliary, record, every, watch):
    """Take a step of generalized-alpha for each row but the first of ``path`` (S + 1, 3, P, n); stop where one fails.

    held (P,): the prescribed nodes, path: their r, v, a at the ends of the steps. source (S, N, n): load added at
    n + 1 - alpha_f, N, or empty. scheme: (alpha_m, alpha_f, beta, gamma). scale: tension in N and length in m that
    errors refer to, and the largest change of a tension from ``rest`` (C,) so far, relative to the former, which the
    tolerance refers to: it grows. state: r, v, a and the a before (N, n), and auxiliary (C,): left at the last
    step that was taken. record: r, v, a (K, N, n) of every ``every``-th step. watch: end after a step with a slack cell.
    Returns steps, iterations, factorisations and the error of the last iteration: the largest change of a tension or
    position, relative to ``scale``.
    """
    r, v, a, before = state
    nodes, n = r.shape
    alpha_m, alpha_f, beta, gamma = scheme
    prescribed = np.zeros(nodes, np.bool_)
    prescribed[held] = True
    r1, v1, a1 = np.empty((nodes, n)), np.empty((nodes, n)), np.empty((nodes, n))
    rf, vf, am, R = np.empty((nodes, n)), np.empty((nodes, n)), np.empty((nodes, n)), np.empty((nodes, n))
    T, unit = np.empty(nodes - 1), np.empty((nodes - 1, n))
    diagonal, right, left = np.empty((nodes, n, n)), np.empty((nodes - 1, n, n)), np.empty((nodes - 1, n, n))
    iterations, factorisations, error, factorised = 0, 0, 0.0, False
    by_v, by_a = gamma / (beta * h), 1 / (beta * h * h)
    weights = (1 - alpha_f, (1 - alpha_f) * by_v, (1 - alpha_m) * by_a)
    kept = auxiliary.copy()
    for step in range(path.shape[0] - 1):
        kept[:], solved = auxiliary, False
        for attempt in range(2):  # predicted with a steady change of acceleration, then with a steady velocity
            for i in range(nodes):
                for k in range(n):
                    a1[i, k] = 2 * a[i, k] - before[i, k] if attempt == 0 else (1 - 0.5 / beta) * a[i, k]
                    r1[i, k] = r[i, k] + h * v[i, k] + h * h * ((0.5 - beta) * a[i, k] + beta * a1[i, k])
                    v1[i, k] = v[i, k] + h * ((1 - gamma) * a[i, k] + gamma * a1[i, k])
            for p in range(held.size):
                for k in range(n):
                    r1[held[p], k], v1[held[p], k] = path[step + 1, 0, p, k], path[step + 1, 1, p, k]
                    a1[held[p], k] = path[step + 1, 2, p, k]
            if attempt == 1:
                auxiliary[:], factorised = kept, False
            last = np.inf
            for _ in range(MAX_ITERATIONS):
                for i in range(nodes):
                    for k in range(n):
                        rf[i, k] = (1 - alpha_f) * r1[i, k] + alpha_f * r[i, k]
                        vf[i, k] = (1 - alpha_f) * v1[i, k] + alpha_f * v[i, k]
                        am[i, k] = (1 - alpha_m) * a1[i, k] + alpha_m * a[i, k]
                residual(line, rf, vf, am, auxiliary, R, T, unit)
                if source.shape[0] > 0:
                    for i in range(nodes):
                        for k in range(n):
                            R[i, k] -= source[step, i, k]
                for p in range(held.size):
                    for k in range(n):
                        R[held[p], k] = 0.0
                iterations += 1
                if not factorised:
                    tangents(line, rf, vf, am, auxiliary, weights, diagonal, right, left)
                    factorise(line, diagonal, right, left, prescribed)
                    factorisations += 1
                    factorised = True
                solve(line, diagonal, right, left, R)
                error = 0.0
                for i in range(nodes):
                    for k in range(n):
                        r1[i, k] -= R[i, k]
                        v1[i, k] -= by_v * R[i, k]
                        a1[i, k] -= by_a * R[i, k]
                        error = max(error, abs(R[i, k]) / scale[1])
                        if not abs(R[i, k]) < np.inf:
                            error = np.inf
                for c in range(nodes - 1):
                    change = 0.0
                    for k in range(n):
                        change -= unit[c, k] * (R[c + 1, k] - R[c, k])
                    change *= line.EA[c] / line.length[c] * (weights[0] + weights[1] * line.damping[c])
                    auxiliary[c] = T[c] + change if T[c] != 0 else 0.0
                    error = max(error, abs(change) / scale[0] if T[c] != 0 else 0.0, -auxiliary[c] / scale[0])
                if error <= tolerance * scale[2]:
                    solved = True
                    break
                if not error < np.inf:
                    break
                if error > MAX_CONTRACTION * last:
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
        slack = False
        for c in range(nodes - 1):
            scale[2] = max(scale[2], abs(T[c] - rest[c]) / scale[0])
            slack = slack or T[c] == 0
        if (step + 1) % every == 0:
            for i in range(nodes):
                for k in range(n):
                    at = (step + 1) // every - 1
                    record[0][at, i, k], record[1][at, i, k], record[2][at, i, k] = r[i, k], v[i, k], a[i, k]
        if watch and slack:
            return step + 1, iterations, factorisations, error
    return path.shape[0] - 1, iterations, factorisations, error


@compiled
def node_forces(line, record, forces, tensions):
    """Set forces (K, N, n), N, to the sums that holders of the nodes would feel, tensions (K, C) to those of the cells.

    record: r, v, a (K, N, n). The force on the holder of a node is what the balance of the node leaves.
    """
    nodes, n = record[0].shape[1:]
    R, unit, zeros = np.empty((nodes, n)), np.empty((nodes - 1, n)), np.zeros(nodes - 1)
    for k in range(record[0].shape[0]):
        residual(line, record[0][k], record[1][k], record[2][k], zeros, R, tensions[k], unit)
        for i in range(nodes):
            for p in range(n):
                forces[k, i, p] = -R[i, p]


# ---------------------------------------------------------------- samples of a period
@compiled
def sampled_residual(line, samples, auxiliary, R, T, unit):
    """Set R (S, N, n), T (S, C) and unit (S, C, n) at samples: r, v, a (S, N, n) with auxiliary tensions (S, C)."""
    for k in range(R.shape[0]):
        residual(line, samples[0][k], samples[1][k], samples[2][k], auxiliary[k], R[k], T[k], unit[k])


@compiled
def sampled_tangents(line, samples, auxiliary, weights, diagonal, right, left):
    """Set the tangents at samples, diagonal (n, n, N, S), right and left (n, n, C, S), else as ``tangents``."""
    n, (count, nodes) = len(line.current), samples[0].shape[:2]
    D, U, L = np.empty((nodes, n, n)), np.empty((nodes - 1, n, n)), np.empty((nodes - 1, n, n))
    for s in range(count):
        tangents(line, samples[0][s], samples[1][s], samples[2][s], auxiliary[s], weights, D, U, L)
        for i in range(nodes):
            for j in range(n):
                for k in range(n):
                    diagonal[j, k, i, s] = D[i, j, k]
                    if i < nodes - 1:
                        right[j, k, i, s], left[j, k, i, s] = U[i, j, k], L[i, j, k]
