"""Cable moving in space: all rows of HB (1)-(6) in (eps, u, v, w, phi, theta), and z on a seabed."""

from __future__ import annotations

import numpy as np

from ..numerics.chain import Residual
from .loads import quadratic_drag, transverse_drag

FIELDS = ("eps", "u", "v", "w", "phi", "theta")
EPS, U, V, W, PHI, THETA, Z = range(7)


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


def _local(c, y, ydot, tangents):
    """Return M y_t + f of HB (1)-(6) at points of the cable ``c``, the tension, and tangents of the former or None."""
    eps, u, v, w, phi, theta = y[:6]
    eps_t, u_t, v_t, w_t, phi_t, theta_t = ydot[:6]
    m, ma, EA = c.m, c.ma, c.EA
    sin_p, cos_p, sin_t, cos_t = np.sin(phi), np.cos(phi), np.sin(theta), np.cos(theta)
    T = EA * (eps + c.beta * eps_t) if c.beta else EA * eps
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


def _stiffness_coefficients(y, T):
    """Return what y_s is multiplied by in K y_s: T, T cos, v cos, w, u cos + w sin, v sin, u (of theta)."""
    u, v, w, sin, cos = y[U], y[V], y[W], np.sin(y[THETA]), np.cos(y[THETA])
    return T, T * cos, v * cos, w, u * cos + w * sin, v * sin, u


def _add_stiffness(F, coefficients, y_s, T_s, count):
    """Add K y_s to the rows F at a point (count 1), or summed over the two nodes of a cell (count 2).

    coefficients: as ``_stiffness_coefficients`` gives them, at the point or summed; T_s: dT/ds, summed likewise.
    """
    T, k25, k45, k46, k55, k65, k66 = coefficients
    D_phi, D_theta = y_s[PHI], y_s[THETA]
    F[0] += T_s
    F[1] += k25 * D_phi
    F[2] -= T * D_theta
    F[3] += count * y_s[U] - k45 * D_phi + k46 * D_theta
    F[4] += count * y_s[V] + k55 * D_phi
    F[5] += count * y_s[W] - k65 * D_phi - k66 * D_theta
    if len(F) > Z:
        F[Z] += count * y_s[Z]


def _up(y):
    """Return the upward parts of t, n and b."""
    cos_p = np.cos(y[PHI])
    return np.array([cos_p * np.cos(y[THETA]), -np.sin(y[PHI]), cos_p * np.sin(y[THETA])])


def point(c, y, ydot, y_s, ydot_s):
    """Return M y_t + K y_s + f at points of the cable ``c``, all (6 or 7, n, *S)."""
    F, T, *_ = _local(c, y, ydot, False)
    _add_stiffness(F, _stiffness_coefficients(y, T), y_s, c.EA * (y_s[EPS] + c.beta * ydot_s[EPS]), 1)
    if c.has_seabed:
        F[:3] += c.support(y[Z])[0] * _up(y)
    return F


def cells(c, y, ydot, tangents=True) -> Residual:
    """Return the rows of the box scheme (39) between the nodes of the cable ``c``; y and ydot (6 or 7, N, *S)."""
    a, T, by, bt = _local(c, y, ydot, tangents)
    EA = c.EA

    ds = c.ds if y.ndim == 2 else c.ds[:, None]
    D = (y[:, 1:] - y[:, :-1]) / ds  # y_s
    D_phi, D_theta = D[PHI], D[THETA]
    sums = [q[1:] + q[:-1] for q in _stiffness_coefficients(y, T)]  # twice the mean
    S_T, S25, S45, S46, S55, S65, S66 = sums
    F = a[:, 1:] + a[:, :-1]
    _add_stiffness(F, sums, D, 2 * (T[1:] - T[:-1]) / ds, 2)
    if c.has_seabed:
        support, support_z = c.support((y[Z, 1:] + y[Z, :-1]) / 2)
        up = _up(y)
        S_up = up[:, 1:] + up[:, :-1]
        F[:3] += support * S_up
    if not tangents:
        return Residual(F)

    _, u, v, w, _, theta = y[:6]
    sin_t, cos_t = np.sin(theta), np.cos(theta)
    J = np.stack([by[:, :, :-1], by[:, :, 1:]])
    Jt = np.stack([bt[:, :, :-1], bt[:, :, 1:]])
    for side, sign, at in ((0, -1.0, slice(None, -1)), (1, 1.0, slice(1, None))):
        per, sin, cos = sign / ds, sin_t[at], cos_t[at]
        J[side, 0, EPS] += 2 * EA * per
        J[side, 1, EPS] += EA * cos * D_phi
        J[side, 1, PHI] += S25 * per
        J[side, 1, THETA] -= T[at] * sin * D_phi
        J[side, 2, EPS] -= EA * D_theta
        J[side, 2, THETA] -= S_T * per
        J[side, 3, U] += 2 * per
        J[side, 3, V] -= cos * D_phi
        J[side, 3, W] += D_theta
        J[side, 3, PHI] -= S45 * per
        J[side, 3, THETA] += S46 * per + v[at] * sin * D_phi
        J[side, 4, V] += 2 * per
        J[side, 4, U] += cos * D_phi
        J[side, 4, W] += sin * D_phi
        J[side, 4, PHI] += S55 * per
        J[side, 4, THETA] += (w[at] * cos - u[at] * sin) * D_phi
        J[side, 5, W] += 2 * per
        J[side, 5, V] -= sin * D_phi
        J[side, 5, U] -= D_theta
        J[side, 5, PHI] -= S65 * per
        J[side, 5, THETA] -= S66 * per + v[at] * cos * D_phi
        if c.beta:
            Jt[side, 0, EPS] += 2 * EA * c.beta * per
            Jt[side, 1, EPS] += EA * c.beta * cos * D_phi
            Jt[side, 2, EPS] -= EA * c.beta * D_theta
        if c.has_seabed:
            J[side, 0, PHI] += support * up[1, at] * cos_t[at]
            J[side, 1, PHI] -= support * np.cos(y[PHI, at])
            J[side, 2, PHI] += support * up[1, at] * sin_t[at]
            J[side, 0, THETA] -= support * up[2, at]
            J[side, 2, THETA] += support * up[0, at]
            J[side, :3, Z] += support_z / 2 * S_up
            J[side, 6, Z] += 2 * per
    return Residual(F, J, Jt)


def velocity(y, tangents=True):
    """Return the velocity of the nodes (up, along, out): (3, *shape), (43)-(45); and d/dy (3, n_f, *shape), or None."""
    u, v, w = y[U], y[V], y[W]
    sin_p, cos_p, sin_t, cos_t = np.sin(y[PHI]), np.cos(y[PHI]), np.sin(y[THETA]), np.cos(y[THETA])
    level = u * cos_t + w * sin_t
    out = w * cos_t - u * sin_t
    value = np.array([level * cos_p - v * sin_p, level * sin_p + v * cos_p, out])
    if not tangents:
        return value, None
    by_y = np.zeros((3, *y.shape), dtype=y.dtype)
    by_y[0, U], by_y[0, V], by_y[0, W] = cos_p * cos_t, -sin_p, cos_p * sin_t
    by_y[1, U], by_y[1, V], by_y[1, W] = sin_p * cos_t, cos_p, sin_p * sin_t
    by_y[2, U], by_y[2, W] = -sin_t, cos_t
    by_y[0, PHI], by_y[1, PHI] = -value[1], value[0]
    by_y[0, THETA], by_y[1, THETA], by_y[2, THETA] = out * cos_p, out * sin_p, -level
    return value, by_y


def stretched_tangent(y, tangents=True):
    """Return (1 + eps) t of the nodes in (up, along, out): (3, *shape), and d/dy (3, n_f, *shape), or None."""
    stretch = 1 + y[EPS]
    sin_p, cos_p, sin_t, cos_t = np.sin(y[PHI]), np.cos(y[PHI]), np.sin(y[THETA]), np.cos(y[THETA])
    t = np.array([cos_p * cos_t, sin_p * cos_t, -sin_t])
    if not tangents:
        return stretch * t, None
    by_y = np.zeros((3, *y.shape), dtype=y.dtype)
    by_y[:, EPS] = t
    by_y[0, PHI], by_y[1, PHI] = -stretch * t[1], stretch * t[0]
    by_y[0, THETA], by_y[1, THETA] = -stretch * cos_p * sin_t, -stretch * sin_p * sin_t
    by_y[2, THETA] = -stretch * cos_t
    return stretch * t, by_y
