"""The monolithic Jacobian (3.7) as one dense matrix: for small networks, trust region, differences, condition numbers.

Rows [F of the moving coordinates / force unit, (l, h) gaps of the elements / length unit]; columns [moving coordinates
/ length unit, (H, V) of the elements / force unit]; without those that are no unknowns.
"""

from __future__ import annotations

import numpy as np

from .equations import Elements

DIFFERENCE = 1e-7  # relative step of forward differences, about the square root of eps
SHRINK, GROW = 0.5, 3.0  # of the trust region's radius


def analytic_jacobian(now):
    """J = [[A, B], [-G, C]] by the blocks of (4.8)-(4.16), scaled; shape (m + k, m + k)."""
    b, x, n = now.monolith.balance, now.x, now.r.size
    motion, pulls = now.geometry.frame
    _, G, D = now.blocks
    fixed_forces = np.where(now.closed[:, None, None], D, 0.0)
    fixed_forces[:, 3, 1] = np.where(now.closed, D[:, 3, 1], x.raised[:, 2])
    A = Elements(now.geometry, now.elements.Q, lambda: D).tangents(fixed_forces)
    B = pulls[:, :, :4] @ np.concatenate([np.broadcast_to(np.eye(2), x.C.shape), x.anchor], axis=1)
    J = np.zeros((n + 2 * b.w.size,) * 2)
    for i, ends in enumerate(b.coordinates):
        own = [n + 2 * i, n + 2 * i + 1]
        J[np.ix_(ends, ends)] -= A[i]
        J[np.ix_(ends, own)] -= B[i]
        J[np.ix_(own, ends)] -= G[i] @ motion[i, :3]
        J[np.ix_(own, own)] = x.C[i]
    kept = np.flatnonzero(np.concatenate([now.moving.ravel(), now.unknown.ravel()]))
    units = _units(now)
    residual_units = np.where(kept < n, now.monolith.force_unit, now.monolith.length_unit)
    return J[np.ix_(kept, kept)] * units / residual_units[:, None]


def difference_jacobian(now):
    """The same by forward differences of the residual: one evaluation a column."""
    columns, b, m = [], now.monolith.balance, now.monolith
    units, forces, n = _units(now), now.elements.Q[:2].T[now.unknown], np.count_nonzero(now.moving)
    typical = np.full(units.size, np.median(np.abs(b.w) * b.L))
    typical[:n] = np.median(b.L)
    scale = np.concatenate([np.abs(now.r[now.moving]), np.abs(forces)])
    for i in range(units.size):
        step = DIFFERENCE * max(scale[i], typical[i], units[i] * 1e-3)
        change = np.zeros(units.size)
        change[i] = step
        moved = _moved(now, change)
        difference = np.concatenate(
            [
                (moved.force - now.force)[now.moving] / m.force_unit,
                (moved.gap - now.gap)[now.unknown] / m.length_unit,
            ]
        )
        columns.append(difference / step * units[i])
    return np.column_stack(columns)


def _units(now):
    m = now.monolith
    return np.repeat([m.length_unit, m.force_unit], [np.count_nonzero(now.moving), np.count_nonzero(now.unknown)])


def _moved(now, change):
    """The iterate with z + change (unscaled), no safeguards."""
    dr, *forces = _as_step(now, change / _units(now))
    return now.monolith.at(now.r + dr, *(now.elements.Q[:2] + forces))


def _as_step(now, scaled):
    """(dr, dH, dV) from a scaled vector of unknowns."""
    change = scaled * _units(now)
    n = np.count_nonzero(now.moving)
    dr, dq = np.zeros_like(now.r), np.zeros((now.kind.size, 2))
    dr[now.moving] = change[:n]
    dq[now.unknown] = change[n:]
    return dr, dq[:, 0], dq[:, 1]


def jacobian_of(now, jacobian):
    """The scaled Jacobian, "analytic" or by "finite-difference"."""
    return analytic_jacobian(now) if jacobian == "analytic" else difference_jacobian(now)


def dense_step(now, jacobian):
    """Newton step with the whole matrix; counts (2/3) n^3 operations, (5.6)."""
    J = jacobian_of(now, jacobian)
    now.monolith.count.operations += 2 / 3 * J.shape[0] ** 3
    return _as_step(now, _solve(J, -now.residual))


def trust_region_step(now, jacobian, radius):
    """Powell's dogleg between the gradient and the Newton step; returns (next iterate or None, radius)."""
    J, Z = jacobian_of(now, jacobian), now.residual
    now.monolith.count.operations += 2 / 3 * J.shape[0] ** 3
    newton = _solve(J, -Z)
    gradient = J.T @ Z
    cauchy = -gradient * (gradient @ gradient) / np.sum((J @ gradient) ** 2)
    radius = np.linalg.norm(newton) if radius is None else radius
    while radius > 1e-12 * (1 + np.linalg.norm(newton)):
        p = _dogleg(newton, cauchy, radius)
        new = now.after(1.0, _as_step(now, p))
        promised = Z @ Z - np.sum((Z + J @ p) ** 2)
        gained = (Z @ Z - np.sum(new.residual**2)) / promised
        if gained > 0.75:
            radius = max(radius, GROW * np.linalg.norm(p))
        if gained > 1e-4:
            return new, radius if gained > 0.25 else SHRINK * np.linalg.norm(p)
        radius = SHRINK * np.linalg.norm(p)
    return None, radius


def _dogleg(newton, cauchy, radius):
    if np.linalg.norm(newton) <= radius:
        return newton
    if np.linalg.norm(cauchy) >= radius:
        return cauchy * (radius / np.linalg.norm(cauchy))
    d = newton - cauchy
    a, half_b, c = d @ d, cauchy @ d, cauchy @ cauchy - radius**2
    return cauchy + (-half_b + np.sqrt(half_b**2 - a * c)) / a * d


def _solve(J, right):
    """J^-1 right; where slack lines leave J singular, the smallest correction; NaN where J is not finite."""
    if not np.isfinite(J).all():
        return np.full_like(right, np.nan)
    try:
        return np.linalg.solve(J, right)
    except np.linalg.LinAlgError:
        return np.linalg.lstsq(J, right, rcond=None)[0]
