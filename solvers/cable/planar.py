"""Cable moving in its vertical plane: rows 1, 2, 4, 5 of HB (1)-(6) in (eps, u, v, phi), and z on a seabed."""

from __future__ import annotations

import numpy as np

from ..numerics.chain import Residual
from .loads import quadratic_drag

FIELDS = ("eps", "u", "v", "phi")
EPS, U, V, PHI, Z = range(5)


def _loads(c, u, v, sin, cos, tangents, stretch):
    """Return F_dt, F_dn of (10), (11), their d/d(eps, velocity, phi), and the current along t and n, (7), (8)."""
    if c.current is None:
        along = across = 0.0
    else:
        along, across = c.current[0] * cos + c.current[1] * sin, c.current[1] * cos - c.current[0] * sin
    values, by_state = [], []
    for coefficient, q, q_phi in ((c.drag_t, u - along, -across), (c.drag_n, v - across, along)):
        if coefficient:
            value, by_q = quadratic_drag(coefficient, q, stretch)
            values.append(value)
            if not tangents:
                continue
            by_state.append((value / (2 * stretch * stretch), by_q, by_q * q_phi if c.current is not None else 0.0))
        else:
            values.append(0.0)
            by_state.append((0.0, 0.0, 0.0))
    return values, by_state, along, across


def _local(c, y, ydot, tangents):
    """Return M y_t + f of HB (1)-(6) at points of the cable ``c``, the tension, and tangents of the former or None."""
    eps, u, v, phi = y[:4]
    eps_t, u_t, v_t, phi_t = ydot[:4]
    m, ma, EA = c.m, c.ma, c.EA
    sin, cos = np.sin(phi), np.cos(phi)
    T = EA * (eps + c.beta * eps_t) if c.beta else EA * eps
    (Fdt, Fdn), by_state, along, across = _loads(c, u, v, sin, cos, tangents, np.sqrt(1 + eps))
    turning = m * u if c.current is None else m * u + c.inertia * along

    a = np.empty_like(y)  # M y_t + f at the nodes
    a[0] = m * (v * phi_t - u_t) - c.w0 * cos + Fdt
    a[1] = -(m + ma) * v_t - turning * phi_t + c.w0 * sin + Fdn
    a[2] = -eps_t
    a[3] = -(1 + eps) * phi_t
    if c.has_seabed:
        a[4] = -(1 + eps) * cos
    if not tangents:
        return a, T, None, None

    dFdt, dFdn = by_state
    n, shape = y.shape[0], y.shape[1:]
    by, bt = np.zeros((2, n, n, *shape), dtype=a.dtype)  # of a by y and by ydot
    by[0, EPS], by[0, U] = dFdt[0], dFdt[1]
    by[0, V] = m * phi_t
    by[0, PHI] = c.w0 * sin + dFdt[2]
    by[1, EPS], by[1, V] = dFdn[0], dFdn[1]
    by[1, U] = -m * phi_t
    by[1, PHI] = c.w0 * cos + dFdn[2]
    by[3, EPS] = -phi_t
    bt[0, U], bt[0, PHI] = -m, m * v
    bt[1, V], bt[1, PHI] = -(m + ma), -turning
    bt[2, EPS] = -1
    bt[3, PHI] = -(1 + eps)
    if c.current is not None:
        by[1, PHI] -= c.inertia * across * phi_t
    if c.has_seabed:
        by[4, EPS], by[4, PHI] = -cos, (1 + eps) * sin
    return a, T, by, bt


def _add_stiffness(F, coefficients, y_s, T_s, count):
    """Add K y_s to the rows F at a point (count 1), or summed over the two nodes of a cell (count 2).

    coefficients: T, u, v, at the point or summed over the nodes; T_s: dT/ds, summed likewise.
    """
    T, u, v = coefficients
    F[0] += T_s
    F[1] += T * y_s[PHI]
    F[2] += count * y_s[U] - v * y_s[PHI]
    F[3] += count * y_s[V] + u * y_s[PHI]
    if len(F) > Z:
        F[Z] += count * y_s[Z]


def _up(y):
    """Return the upward parts of t and n."""
    return np.array([np.cos(y[PHI]), -np.sin(y[PHI])])


def point(c, y, ydot, y_s, ydot_s):
    """Return M y_t + K y_s + f at points of the cable ``c``, all (4 or 5, n, *S)."""
    F, T, *_ = _local(c, y, ydot, False)
    _add_stiffness(F, (T, y[U], y[V]), y_s, c.EA * (y_s[EPS] + c.beta * ydot_s[EPS]), 1)
    if c.has_seabed:
        F[:2] += c.support(y[Z])[0] * _up(y)
    return F


def cells(c, y, ydot, tangents=True) -> Residual:
    """Return the rows of the box scheme (39) between the nodes of the cable ``c``; y and ydot (4 or 5, N, *S)."""
    a, T, by, bt = _local(c, y, ydot, tangents)
    EA = c.EA

    ds = c.ds if y.ndim == 2 else c.ds[:, None]
    D, S = (y[:, 1:] - y[:, :-1]) / ds, y[:, 1:] + y[:, :-1]  # y_s, and twice the mean
    S_T, D_phi = T[1:] + T[:-1], D[PHI]
    F = a[:, 1:] + a[:, :-1]
    _add_stiffness(F, (S_T, S[U], S[V]), D, 2 * (T[1:] - T[:-1]) / ds, 2)
    if c.has_seabed:
        support, support_z = c.support(S[Z] / 2)
        up = _up(y)
        S_up = up[:, 1:] + up[:, :-1]
        F[:2] += support * S_up
    if not tangents:
        return Residual(F)

    J = np.stack([by[:, :, :-1], by[:, :, 1:]])
    Jt = np.stack([bt[:, :, :-1], bt[:, :, 1:]])
    for side, sign, at in ((0, -1.0, slice(None, -1)), (1, 1.0, slice(1, None))):
        per = sign / ds
        J[side, 0, EPS] += 2 * EA * per
        J[side, 1, EPS] += EA * D_phi
        J[side, 1, PHI] += S_T * per
        J[side, 2, U] += 2 * per
        J[side, 2, V] -= D_phi
        J[side, 2, PHI] -= S[V] * per
        J[side, 3, V] += 2 * per
        J[side, 3, U] += D_phi
        J[side, 3, PHI] += S[U] * per
        if c.beta:
            Jt[side, 0, EPS] += 2 * EA * c.beta * per
            Jt[side, 1, EPS] += EA * c.beta * D_phi
        if c.has_seabed:
            J[side, 0, PHI] += support * up[1, at]
            J[side, 1, PHI] -= support * up[0, at]
            J[side, :2, Z] += support_z / 2 * S_up
            J[side, 4, Z] += 2 * per
    return Residual(F, J, Jt)


def velocity(y, tangents=True):
    """Return the velocity of the nodes, (up, along): (2, *shape), (43), (44); and d/dy (2, n_f, *shape), or None."""
    u, v, phi = y[U], y[V], y[PHI]
    sin, cos = np.sin(phi), np.cos(phi)
    value = np.array([u * cos - v * sin, u * sin + v * cos])
    if not tangents:
        return value, None
    by_y = np.zeros((2, *y.shape), dtype=y.dtype)
    by_y[0, U], by_y[0, V], by_y[0, PHI] = cos, -sin, -value[1]
    by_y[1, U], by_y[1, V], by_y[1, PHI] = sin, cos, value[0]
    return value, by_y


def stretched_tangent(y, tangents=True):
    """Return (1 + eps) t of the nodes in (up, along): (2, *shape), and d/dy (2, n_f, *shape), or None."""
    stretch, sin, cos = 1 + y[EPS], np.sin(y[PHI]), np.cos(y[PHI])
    value = np.array([stretch * cos, stretch * sin])
    if not tangents:
        return value, None
    by_y = np.zeros((2, *y.shape), dtype=y.dtype)
    by_y[0, EPS], by_y[0, PHI] = cos, -value[1]
    by_y[1, EPS], by_y[1, PHI] = sin, value[0]
    return value, by_y
