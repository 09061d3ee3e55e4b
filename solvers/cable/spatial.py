"""Cable moving in space: all rows of HB (1)-(6) in (eps, u, v, w, phi, theta), and z on a seabed."""

from __future__ import annotations

import numpy as np

from .loads import quadratic_drag, transverse_drag

FIELDS = ("eps", "u", "v", "w", "phi", "theta")
EPS, U, V, W, PHI, THETA = range(6)


class _Current:
    """Steady current in the moving frame, (7)-(9): parts along t, n, b, and their derivatives by phi and theta."""

    def __init__(self, current, sin_p, cos_p, sin_t, cos_t):
        up, plane, out = current
        level = up * cos_p + plane * sin_p
        self.n = plane * cos_p - up * sin_p
        self.t = level * cos_t - out * sin_t
        self.b = level * sin_t + out * cos_t
        self.level, self.t_phi, self.b_phi = level, self.n * cos_t, self.n * sin_t
        self.n_phi, self.t_theta, self.b_theta = -level, -self.b, self.t


def local_terms(c, y, ydot, tangents):
    """Return M y_t + f of HB (1)-(6) at points of the cable ``c``, the tension, and tangents of the former or None."""
    eps, u, v, w, phi, theta = y[:6]
    eps_t, u_t, v_t, w_t, phi_t, theta_t = ydot[:6]
    m, ma = c.m, c.ma
    sin_p, cos_p, sin_t, cos_t = np.sin(phi), np.cos(phi), np.sin(theta), np.cos(theta)
    T = c.EA * (eps + c.beta * eps_t) if c.beta else c.EA * eps
    stretch = np.sqrt(1 + eps)
    flow = None if c.current is None else _Current(c.current, sin_p, cos_p, sin_t, cos_t)
    u_r, v_r, w_r = (u, v, w) if flow is None else (u - flow.t, v - flow.n, w - flow.b)
    Fdt, dFdt = quadratic_drag(c.drag_t, u_r, stretch) if c.drag_t else (0.0, 0.0)
    (Fdn, Fdb), (dFdn, dFdb) = transverse_drag(c.drag_n, c.drag_b, v_r, w_r, stretch)

    M25, M35, M36 = -m * (u * cos_t + w * sin_t), m * v * sin_t, m * u
    if flow is not None:
        M25 = M25 - c.inertia * flow.level
        M35 = M35 + c.inertia * flow.b_phi
        M36 = M36 + c.inertia * flow.t
    a = np.empty_like(y)  # M y_t + f at the nodes
    a[0] = m * (v * cos_t * phi_t - w * theta_t - u_t) - c.w0 * cos_p * cos_t + Fdt
    a[1] = -(m + ma) * v_t + M25 * phi_t + c.w0 * sin_p + Fdn
    a[2] = -(m + ma) * w_t + M35 * phi_t + M36 * theta_t - c.w0 * cos_p * sin_t + Fdb
    a[3] = -eps_t
    a[4] = -(1 + eps) * cos_t * phi_t
    a[5] = (1 + eps) * theta_t
    if c.has_seabed:
        a[6] = -(1 + eps) * cos_p * cos_t
    if not tangents:
        return a, T, None, None

    n, shape = y.shape[0], y.shape[1:]
    by, bt = np.zeros((2, n, n, *shape), dtype=a.dtype)  # of a by y and by ydot
    per_stretch = 1 / (2 * (1 + eps))
    by[0, EPS], by[0, U] = Fdt * per_stretch, dFdt
    by[0, V], by[0, W] = m * cos_t * phi_t, -m * theta_t
    by[0, PHI] = c.w0 * sin_p * cos_t
    by[0, THETA] = c.w0 * cos_p * sin_t - m * v * sin_t * phi_t
    by[1, EPS], by[1, V], by[1, W] = Fdn * per_stretch, dFdn[0], dFdn[1] - m * sin_t * phi_t
    by[1, U] = -m * cos_t * phi_t
    by[1, PHI] = c.w0 * cos_p
    by[1, THETA] = m * (u * sin_t - w * cos_t) * phi_t
    by[2, EPS], by[2, V], by[2, W] = Fdb * per_stretch, dFdb[0] + m * sin_t * phi_t, dFdb[1]
    by[2, U] = m * theta_t
    by[2, PHI] = c.w0 * sin_p * sin_t
    by[2, THETA] = m * v * cos_t * phi_t - c.w0 * cos_p * cos_t
    by[4, EPS], by[4, THETA] = -cos_t * phi_t, (1 + eps) * sin_t * phi_t
    by[5, EPS] = theta_t
    bt[0, U], bt[0, PHI], bt[0, THETA] = -m, m * v * cos_t, -m * w
    bt[1, V], bt[1, PHI] = -(m + ma), M25
    bt[2, W], bt[2, PHI], bt[2, THETA] = -(m + ma), M35, M36
    bt[3, EPS] = -1
    bt[4, PHI] = -(1 + eps) * cos_t
    bt[5, THETA] = 1 + eps
    if flow is not None:
        by[0, PHI] -= dFdt * flow.t_phi
        by[0, THETA] -= dFdt * flow.t_theta
        by[1, PHI] -= dFdn[0] * flow.n_phi + dFdn[1] * flow.b_phi + c.inertia * flow.n * phi_t
        by[1, THETA] -= dFdn[1] * flow.b_theta
        by[2, PHI] -= dFdb[0] * flow.n_phi + dFdb[1] * flow.b_phi
        by[2, PHI] += c.inertia * (flow.t_phi * theta_t - flow.level * sin_t * phi_t)
        by[2, THETA] -= dFdb[1] * flow.b_theta
        by[2, THETA] += c.inertia * (flow.t_phi * phi_t + flow.t_theta * theta_t)
    if c.has_seabed:
        by[6, EPS] = -cos_p * cos_t
        by[6, PHI], by[6, THETA] = (1 + eps) * sin_p * cos_t, (1 + eps) * cos_p * sin_t
    return a, T, by, bt


def stiffness_coefficients(y, T):
    """Return what y_s is multiplied by in K y_s: T, T cos, v cos, w, u cos + w sin, v sin, u (of theta)."""
    u, v, w, sin, cos = y[U], y[V], y[W], np.sin(y[THETA]), np.cos(y[THETA])
    return T, T * cos, v * cos, w, u * cos + w * sin, v * sin, u


def add_stiffness(F, coefficients, y_s, T_s, count):
    """Add K y_s to the rows F at a point (count 1), or summed over the two nodes of a cell (count 2).

    coefficients: as ``stiffness_coefficients`` gives them, at the point or summed; T_s: dT/ds, summed likewise.
    """
    T, k25, k45, k46, k55, k65, k66 = coefficients
    D_phi, D_theta = y_s[PHI], y_s[THETA]
    F[0] += T_s
    F[1] += k25 * D_phi
    F[2] -= T * D_theta
    F[3] += count * y_s[U] - k45 * D_phi + k46 * D_theta
    F[4] += count * y_s[V] + k55 * D_phi
    F[5] += count * y_s[W] - k65 * D_phi - k66 * D_theta


def add_stiffness_tangents(J, y, T, sums, D, per):
    """Add to J those d/dy at one node of a cell of K y_s that are not by the tension; return those, of the first rows.

    sums: coefficients of both nodes; D: y_s of the cell; per: +-1/ds, d(D)/dy.
    """
    S_T, S25, S45, S46, S55, S65, S66 = sums
    D_phi, D_theta = D[PHI], D[THETA]
    u, v, w, sin, cos = y[U], y[V], y[W], np.sin(y[THETA]), np.cos(y[THETA])
    J[1, PHI] += S25 * per
    J[1, THETA] -= T * sin * D_phi
    J[2, THETA] -= S_T * per
    J[3, U] += 2 * per
    J[3, V] -= cos * D_phi
    J[3, W] += D_theta
    J[3, PHI] -= S45 * per
    J[3, THETA] += S46 * per + v * sin * D_phi
    J[4, V] += 2 * per
    J[4, U] += cos * D_phi
    J[4, W] += sin * D_phi
    J[4, PHI] += S55 * per
    J[4, THETA] += (w * cos - u * sin) * D_phi
    J[5, W] += 2 * per
    J[5, V] -= sin * D_phi
    J[5, U] -= D_theta
    J[5, PHI] -= S65 * per
    J[5, THETA] -= S66 * per + v * cos * D_phi
    return 2 * per, cos * D_phi, -D_theta


def frame(y, tangents=True):
    """Return t, n and b as columns in (up, along, out), (3, 3, *shape), and their derivatives by phi and theta.

    The latter (3, 3, 2, *shape), None without ``tangents``.
    """
    vectors, by_angles = np.zeros((3, 3, *y.shape[1:]), y.dtype), None
    sin_p, cos_p, sin_t, cos_t = np.sin(y[PHI]), np.cos(y[PHI]), np.sin(y[THETA]), np.cos(y[THETA])
    vectors[0, 0], vectors[0, 1], vectors[0, 2] = cos_p * cos_t, -sin_p, cos_p * sin_t
    vectors[1, 0], vectors[1, 1], vectors[1, 2] = sin_p * cos_t, cos_p, sin_p * sin_t
    vectors[2, 0], vectors[2, 2] = -sin_t, cos_t
    if tangents:
        by_angles = np.zeros((3, 3, 2, *y.shape[1:]), y.dtype)
        by_angles[0, :, 0], by_angles[1, :, 0] = -vectors[1], vectors[0]
        by_angles[:, 0, 1], by_angles[:, 2, 1] = -vectors[:, 2], vectors[:, 0]
    return vectors, by_angles
