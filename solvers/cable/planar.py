"""Cable moving in its vertical plane: rows 1, 2, 4, 5 of HB (1)-(6) in (eps, u, v, phi), and z on a seabed."""

from __future__ import annotations

import numpy as np

from .loads import quadratic_drag

FIELDS = ("eps", "u", "v", "phi")
EPS, U, V, PHI = range(4)


def local_terms(c, y, ydot, tangents):
    """Return M y_t + f of HB (1)-(6) at points of the cable ``c``, the tension, and tangents of the former or None."""
    eps, u, v, phi = y[:4]
    eps_t, u_t, v_t, phi_t = ydot[:4]
    m, ma = c.m, c.ma
    sin, cos, stretch = np.sin(phi), np.cos(phi), np.sqrt(1 + eps)
    T = c.EA * (eps + c.beta * eps_t) if c.beta else c.EA * eps
    u_r, v_r, turning = u, v, m * u
    if c.current is not None:  # its parts along t and n, (7), (8)
        along, across = c.current[0] * cos + c.current[1] * sin, c.current[1] * cos - c.current[0] * sin
        u_r, v_r, turning = u - along, v - across, m * u + c.inertia * along
    Fdt, dFdt = quadratic_drag(c.drag_t, u_r, stretch) if c.drag_t else (0.0, 0.0)
    Fdn, dFdn = quadratic_drag(c.drag_n, v_r, stretch) if c.drag_n else (0.0, 0.0)

    a = np.empty_like(y)  # M y_t + f at the nodes
    a[0] = m * (v * phi_t - u_t) - c.w0 * cos + Fdt
    a[1] = -(m + ma) * v_t - turning * phi_t + c.w0 * sin + Fdn
    a[2] = -eps_t
    a[3] = -(1 + eps) * phi_t
    if c.has_seabed:
        a[4] = -(1 + eps) * cos
    if not tangents:
        return a, T, None, None

    n, shape = y.shape[0], y.shape[1:]
    by, bt = np.zeros((2, n, n, *shape), dtype=a.dtype)  # of a by y and by ydot
    by[0, EPS], by[0, U] = Fdt / (2 * stretch * stretch), dFdt
    by[0, V] = m * phi_t
    by[0, PHI] = c.w0 * sin
    by[1, EPS], by[1, V] = Fdn / (2 * stretch * stretch), dFdn
    by[1, U] = -m * phi_t
    by[1, PHI] = c.w0 * cos
    by[3, EPS] = -phi_t
    bt[0, U], bt[0, PHI] = -m, m * v
    bt[1, V], bt[1, PHI] = -(m + ma), -turning
    bt[2, EPS] = -1
    bt[3, PHI] = -(1 + eps)
    if c.current is not None:
        by[0, PHI] -= dFdt * across
        by[1, PHI] += dFdn * along - c.inertia * across * phi_t
    if c.has_seabed:
        by[4, EPS], by[4, PHI] = -cos, (1 + eps) * sin
    return a, T, by, bt


def stiffness_coefficients(y, T):
    """Return what y_s is multiplied by in K y_s: T, u, v."""
    return T, y[U], y[V]


def add_stiffness(F, coefficients, y_s, T_s, count):
    """Add K y_s to the rows F at a point (count 1), or summed over the two nodes of a cell (count 2).

    coefficients: as ``stiffness_coefficients`` gives them, at the point or summed; T_s: dT/ds, summed likewise.
    """
    T, u, v = coefficients
    F[0] += T_s
    F[1] += T * y_s[PHI]
    F[2] += count * y_s[U] - v * y_s[PHI]
    F[3] += count * y_s[V] + u * y_s[PHI]


def add_stiffness_tangents(J, y, T, sums, D, per):
    """Add to J those d/dy at one node of a cell of K y_s that are not by the tension; return those, of the first rows.

    sums: coefficients of both nodes; D: y_s of the cell; per: +-1/ds, d(D)/dy.
    """
    S_T, S_u, S_v = sums
    J[1, PHI] += S_T * per
    J[2, U] += 2 * per
    J[2, V] -= D[PHI]
    J[2, PHI] -= S_v * per
    J[3, V] += 2 * per
    J[3, U] += D[PHI]
    J[3, PHI] += S_u * per
    return 2 * per, D[PHI]


def frame(y, tangents=True):
    """Return t and n as columns in (up, along), (2, 2, *shape), and their derivatives by phi, (2, 2, 1, *shape)."""
    vectors, sin, cos = np.empty((2, 2, *y.shape[1:]), y.dtype), np.sin(y[PHI]), np.cos(y[PHI])
    vectors[0, 0], vectors[0, 1] = cos, -sin
    vectors[1, 0], vectors[1, 1] = sin, cos
    return vectors, np.stack([-vectors[1], vectors[0]])[:, :, None] if tangents else None
