"""The monolithic Jacobian (3.7) as one dense matrix: for small networks, trust region, differences, condition numbers.

Rows [F of the moving coordinates / force unit, (l, h) gaps of the open elements / length unit]; columns [moving
coordinates / length unit, (H, V) of the open elements / force unit].
"""

from __future__ import annotations

import numpy as np

from .network_balance import Elements
from .network_nested import dense

DIFFERENCE = 1e-7  # relative step of forward differences, about the square root of eps
SHRINK, GROW = 0.5, 3.0  # of the trust region's radius


def analytic_jacobian(now):
    """J = [[A, B], [-G, C]] by the blocks of (4.8)-(4.16), scaled; shape (m + 2k, m + 2k)."""
    b, e, rows, g = now.monolith.balance, now.elements, now.rows, now.elements.geometry
    force, length = now.monolith.force_unit, now.monolith.length_unit
    unknown, k = b.dof[now.moving], rows.size
    place = np.full(b.size, -1)
    place[unknown] = np.arange(unknown.size)
    D = e.D.copy()
    D[rows] = 0.0
    D[rows, 3, 1] = now.raised[:, 2]
    A = -dense(b.tangent(Elements(g, e.H, e.V, e.H_anchor, e.V_anchor, D)))[np.ix_(unknown, unknown)]
    B, minus_G = np.zeros((b.size + 1, 2 * k)), np.zeros((2 * k, b.size + 1))
    for i, row in enumerate(rows):
        for node, sign, P in ((b.fairlead[row], -1.0, now.P[i, :2]), (b.anchor[row], 1.0, now.P[i, 2:])):
            dof = b.dof[node]  # -1, the last row, where the node does not move
            B[dof[:2], 2 * i : 2 * i + 2] += sign * np.outer(g.direction[row], P[0])
            B[dof[2], 2 * i : 2 * i + 2] += sign * P[1]
            minus_G[2 * i : 2 * i + 2, dof[:2]] += sign * np.outer(now.G[i, :, 0], g.direction[row])
        minus_G[2 * i : 2 * i + 2, b.dof[b.anchor[row], 2]] -= now.G[i, :, 1]
        minus_G[2 * i : 2 * i + 2, b.dof[b.fairlead[row], 2]] -= now.G[i, :, 2]
    C = np.zeros((2 * k, 2 * k))
    for i in range(k):
        C[2 * i : 2 * i + 2, 2 * i : 2 * i + 2] = now.C[i]
    return np.block(
        [
            [A * (length / force), B[unknown]],
            [minus_G[:, unknown], C * (force / length)],
        ]
    )


def difference_jacobian(now):
    """The same by forward differences of the residual: one evaluation a column."""
    base, columns = now.residual, []
    units, b = _units(now), now.monolith.balance
    typical = np.full(base.size, np.median(np.abs(b.w) * b.L))
    typical[: np.count_nonzero(now.moving)] = np.median(b.L)
    scale = np.concatenate([np.abs(now.r[now.moving]), np.abs(_open_forces(now))])
    for i in range(base.size):
        step = DIFFERENCE * max(scale[i], typical[i], units[i] * 1e-3)
        change = np.zeros(base.size)
        change[i] = step
        moved = _moved(now, change)
        difference = np.concatenate(
            [
                (moved.force - now.force)[now.moving] / now.monolith.force_unit,
                ((moved.gap - now.gap)[now.rows] / now.monolith.length_unit).ravel(),
            ]
        )
        columns.append(difference / step * units[i])
    return np.column_stack(columns)


def _units(now):
    m = now.monolith
    return np.concatenate(
        [np.full(np.count_nonzero(now.moving), m.length_unit), np.full(2 * now.rows.size, m.force_unit)]
    )


def _open_forces(now):
    return np.column_stack([now.elements.H, now.elements.V])[now.rows].ravel()


def _moved(now, change):
    """The iterate with z + change (unscaled), no safeguards."""
    n = np.count_nonzero(now.moving)
    r, q = now.r.copy(), np.column_stack([now.elements.H, now.elements.V])
    r[now.moving] += change[:n]
    q[now.rows] += change[n:].reshape(-1, 2)
    return now.monolith.at(r, *q.T)


def _as_step(now, scaled):
    """(dr, dH, dV) from a scaled vector of unknowns."""
    change = scaled * _units(now)
    n = np.count_nonzero(now.moving)
    dr, dq = np.zeros_like(now.r), np.zeros((now.elements.H.size, 2))
    dr[now.moving] = change[:n]
    dq[now.rows] = change[n:].reshape(-1, 2)
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
    """J^-1 right; where slack lines leave J singular, the smallest correction."""
    try:
        return np.linalg.solve(J, right)
    except np.linalg.LinAlgError:
        return np.linalg.lstsq(J, right, rcond=None)[0]
