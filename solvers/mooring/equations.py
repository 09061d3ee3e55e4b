"""Equations of moving lines of nodes and elements: compiled, in two or three axes.

A cell joins nodes a and b: d = r[b] - r[a], t = d/|d|, e = |d|/l - 1, e' = t.(v[b] - v[a])/l, and its tension is
T = EA (e + beta e') while that is positive, else 0. Half of its mass, added mass and drag stands at either end, with
that cell's t. The last axis points up; the number of axes is that of ``Line.current``, a constant for the compiler.

The residual R of a node is its inertia less the forces on it:
(m + ma) a - ma (a.t) t  of half a cell  -+ T t + drag - load - seabed.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..numerics.compiled import compiled


class Line(NamedTuple):
    """Cells (C,) and nodes (N,) of a line, or of the lines of a network; n axes.

    first, last: the nodes of a cell. length m, EA N, damping s, mass and added_mass kg/m: of the cells. normal_drag and
    tangential_drag: 1/2 rho d Cdn and 1/2 rho pi d Cdt, kg/m^2. point_mass kg (with the added mass of its volume),
    point_drag 1/2 rho CdA kg/m and load (N, n) N: of the nodes, weight included. seabed_stiffness N/m,
    seabed_damping N s/m and friction: of the nodes, over a floor at height ``floor`` in m. slip_speed m/s: at which
    friction reaches 0.7 of Coulomb's. current: n floats, m/s. contact_depth m: penetration at which the damping of the
    seabed has grown from zero to its whole value; with 0 it acts at once, and its force jumps at contact.
    """

    first: np.ndarray
    last: np.ndarray
    length: np.ndarray
    EA: np.ndarray
    damping: np.ndarray
    mass: np.ndarray
    added_mass: np.ndarray
    normal_drag: np.ndarray
    tangential_drag: np.ndarray
    point_mass: np.ndarray
    point_drag: np.ndarray
    load: np.ndarray
    seabed_stiffness: np.ndarray
    seabed_damping: np.ndarray
    friction: np.ndarray
    floor: float
    slip_speed: float
    current: tuple
    contact_depth: float = 0.0


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
        if line.point_drag[i] > 0:
            drag(line, v, i, R)
        seabed(line, r, v, i, R)
    for c in range(line.length.size):
        first, last = line.first[c], line.last[c]
        l, square, rate = line.length[c], 0.0 * r[0, 0], 0.0 * r[0, 0]
        for k in range(n):
            unit[c, k] = r[last, k] - r[first, k]
            square += unit[c, k] * unit[c, k]
        distance = np.sqrt(square)
        for k in range(n):
            unit[c, k] /= distance
            rate += unit[c, k] * (v[last, k] - v[first, k])
        T[c] = line.EA[c] * (distance / l - 1 + line.damping[c] * rate / l)
        if T[c].real <= 0 and auxiliary[c] <= 0:
            T[c] = 0.0
        else:
            for k in range(n):
                R[first, k] -= T[c] * unit[c, k]
                R[last, k] += T[c] * unit[c, k]
        half, stretch = l / 2, np.sqrt(distance / l)
        for side in range(2):
            i = last if side else first
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
def drag(line, v, i, R):
    """Add the drag 1/2 rho CdA |u| u of node i itself, u relative to the current, to R[i]."""
    n, square = len(line.current), 0.0 * v[0, 0]
    for k in range(n):
        square += (v[i, k] - line.current[k]) ** 2
    for k in range(n):
        R[i, k] += line.point_drag[i] * np.sqrt(square) * (v[i, k] - line.current[k])


@compiled
def seabed(line, r, v, i, R):
    """Subtract the seabed's normal force, which never pulls, and its regularised friction from R[i]."""
    n, penetration = len(line.current), line.floor - r[i, -1]
    if penetration.real <= 0:
        return
    damping = line.seabed_damping[i] + 0.0 * penetration  # of the type of the state, which may be complex
    if penetration.real < line.contact_depth:
        damping *= penetration / line.contact_depth
    normal = line.seabed_stiffness[i] * penetration - damping * v[i, -1]
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
    """Set diagonal (N, n, n), right and left (C or more, n, n) to w_r dR/dr + w_v dR/dv + w_a dR/da.

    right[c] is of R[first[c]] by node last[c], left[c] of R[last[c]] by node first[c]; what follows those of the cells
    becomes zero. Blocks (3, N, n, n) and (2, C, n, n) get the derivatives apart, those by a neighbour of r and v alone.
    A cell turns with its auxiliary tension.
    """
    n, nodes = len(line.current), r.shape[0]
    unit, across, normal, turned = np.empty((4, n))
    diagonal[:], right[:], left[:] = 0.0, 0.0, 0.0
    for i in range(nodes):
        for k in range(n):
            add_own(diagonal, i, k, k, weights, 0.0, 0.0, line.point_mass[i])
        if line.point_drag[i] > 0:
            drag_tangents(line, v, i, weights, diagonal)
        seabed_tangents(line, r, v, i, weights, diagonal)
    for c in range(line.length.size):
        first, last = line.first[c], line.last[c]
        l, square, rate = line.length[c], 0.0, 0.0
        for k in range(n):
            unit[k] = r[last, k] - r[first, k]
            square += unit[k] * unit[k]
        distance = np.sqrt(square)
        for k in range(n):
            unit[k] /= distance
            across[k] = v[last, k] - v[first, k]
            rate += unit[k] * across[k]
        taut = 1.0 if auxiliary[c] > 0 or distance / l - 1 + line.damping[c] * rate / l > 0 else 0.0
        axial, lateral = taut * line.EA[c] / l, max(auxiliary[c], 0.0) / distance
        turning = axial * line.damping[c] / distance  # the rate of strain as the cell turns
        for k in range(n):
            across[k] -= rate * unit[k]
        half, stretch = l / 2, np.sqrt(distance / l)
        cn, ct = half * stretch * line.normal_drag[c], half * stretch * line.tangential_drag[c]
        m, ma = half * line.mass[c], half * line.added_mass[c]
        for side in range(2):
            i, along, inertia, square = last if side else first, 0.0, 0.0, 0.0
            for k in range(n):
                along += (v[i, k] - line.current[k]) * unit[k]
                inertia += a[i, k] * unit[k]
            for k in range(n):
                normal[k] = v[i, k] - line.current[k] - along * unit[k]
                square += normal[k] * normal[k]
            speed, sign = np.sqrt(square), (2.0 * side - 1) / distance
            sharp, slide = cn / speed if speed > 0 else 0.0, ct * abs(along)
            level = along * (slide - cn * speed) - ma * inertia
            for k in range(n):  # the forces as unit turns, and half of the drag with the stretch
                turned[k] = (2 * slide - cn * speed) * normal[k] - ma * (a[i, k] - inertia * unit[k])
                turned[k] += slide * along * unit[k] / 2
            for j in range(n):
                stretched, sharpened = cn * speed * normal[j] / 2, sharp * normal[j]
                for k in range(n):
                    tt = unit[j] * unit[k]
                    P = (1.0 if j == k else 0.0) - tt
                    stiffness = axial * tt + lateral * P + turning * unit[j] * across[k]
                    turn = unit[j] * turned[k] + level * P - along * sharpened * normal[k] + stretched * unit[k]
                    by_r, by_rate = stiffness + sign * turn, axial * line.damping[c] * tt
                    by_v = cn * speed * P + sharpened * normal[k] + 2 * slide * tt
                    add_own(diagonal, i, j, k, weights, by_r, by_v + by_rate, m * (tt + P) + ma * P)
                    if side == 0:
                        add_next(right, c, j, k, weights, -by_r, -by_rate)
                    else:
                        add_next(left, c, j, k, weights, -by_r, -by_rate)


@compiled
def add_own(block, i, j, k, weights, by_r, by_v, by_a):
    """Add derivatives by the node's own r, v, a to entry j, k of block i: weighted in sum, or apart."""
    if block.ndim == 4:
        block[0, i, j, k] += by_r
        block[1, i, j, k] += by_v
        block[2, i, j, k] += by_a
    else:
        block[i, j, k] += weights[0] * by_r + weights[1] * by_v + weights[2] * by_a


@compiled
def add_next(block, c, j, k, weights, by_r, by_v):
    """Add derivatives by a neighbour's r and v, the same way."""
    if block.ndim == 4:
        block[0, c, j, k] += by_r
        block[1, c, j, k] += by_v
    else:
        block[c, j, k] += weights[0] * by_r + weights[1] * by_v


@compiled
def drag_tangents(line, v, i, weights, diagonal):
    """Add the tangents of the drag of node i itself to diagonal[i]."""
    n, square = len(line.current), 0.0
    for k in range(n):
        square += (v[i, k] - line.current[k]) ** 2
    speed = np.sqrt(square)
    if speed == 0:
        return
    for j in range(n):
        add_own(diagonal, i, j, j, weights, 0.0, line.point_drag[i] * speed, 0.0)
        for k in range(n):
            uu = (v[i, j] - line.current[j]) * (v[i, k] - line.current[k])
            add_own(diagonal, i, j, k, weights, 0.0, line.point_drag[i] * uu / speed, 0.0)


@compiled
def seabed_tangents(line, r, v, i, weights, diagonal):
    """Add the tangents of the seabed's forces on node i to diagonal[i]."""
    n, up, c = len(line.current), line.seabed_stiffness[i], line.seabed_damping[i]
    penetration, last = line.floor - r[i, -1], len(line.current) - 1
    if penetration <= 0:
        return
    if penetration < line.contact_depth:
        up -= c * v[i, -1] / line.contact_depth  # the deeper, the more damping
        c *= penetration / line.contact_depth
    normal = line.seabed_stiffness[i] * penetration - c * v[i, -1]
    if normal <= 0:
        return
    add_own(diagonal, i, last, last, weights, up, c, 0.0)
    square = line.slip_speed**2
    for p in range(n - 1):
        square += v[i, p] * v[i, p]
    root = np.sqrt(square)
    for p in range(n - 1):
        by_height = -line.friction[i] * v[i, p] / root
        add_own(diagonal, i, p, p, weights, 0.0, line.friction[i] * normal / root, 0.0)
        add_own(diagonal, i, p, last, weights, by_height * up, by_height * c, 0.0)
        for q in range(n - 1):
            by_v = line.friction[i] * normal * v[i, p] * v[i, q] / (square * root)
            add_own(diagonal, i, p, q, weights, 0.0, -by_v, 0.0)


# ---------------------------------------------------------------- many states
@compiled
def node_forces(line, record, forces, tensions):
    """Set forces (K, N, n), N, to the sums that holders of the nodes would feel, tensions (K, C) to those of the cells.

    record: r, v, a (K, N, n). The force on the holder of a node is what the balance of the node leaves.
    """
    nodes, n = record[0].shape[1:]
    cells = line.length.size
    R, unit, zeros = np.empty((nodes, n)), np.empty((cells, n)), np.zeros(cells)
    for k in range(record[0].shape[0]):
        residual(line, record[0][k], record[1][k], record[2][k], zeros, R, tensions[k], unit)
        for i in range(nodes):
            for p in range(n):
                forces[k, i, p] = -R[i, p]
