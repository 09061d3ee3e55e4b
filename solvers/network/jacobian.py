"""The monolithic Jacobian (3.7) as one dense matrix: for small networks, trust region, differences, condition numbers.

Rows [F of the moving coordinates / force unit, (l, h) gaps of the elements / length unit]; columns [moving coordinates
/ length unit, (H, V) of the elements / force unit]; both only of what is unknown.
"""

from __future__ import annotations

import numpy as np

from .equations import Elements

DIFFERENCE = 1e-7  # relative step of forward differences, about the square root of eps
SHRINK, GROW = 0.5, 3.0  # of the trust region's radius


def analytic_jacobian(now):
    """Return J = [[A, B], [-G, C]] by the blocks of (4.8)-(4.16), scaled, (m + k, m + k), at an Iterate."""
    equations, x, n = now.system.equations, now.excursion, now.r.size
    motion, pulls = now.geometry.frame
    _, G, D = now.blocks
    at_fixed_forces = np.where(now.slack[:, None, None], D, 0.0)
    at_fixed_forces[:, 3, 1] = np.where(now.slack, D[:, 3, 1], x.by_clearance[:, 2])
    A = Elements(now.geometry, now.elements.Q, lambda: D).tangents(at_fixed_forces)
    B = pulls[:, :, :4] @ np.concatenate([np.broadcast_to(np.eye(2), x.C.shape), x.anchor], axis=1)
    J = np.zeros((n + 2 * equations.w.size,) * 2)
    for i, ends in enumerate(equations.coordinates):
        own = [n + 2 * i, n + 2 * i + 1]
        J[np.ix_(ends, ends)] -= A[i]
        J[np.ix_(ends, own)] -= B[i]
        J[np.ix_(own, ends)] -= G[i] @ motion[i, :3]
        J[np.ix_(own, own)] = x.C[i]
    unknown = np.flatnonzero(np.concatenate([now.moving.ravel(), now.unknown.ravel()]))
    units = _units(now)
    residual_units = np.where(unknown < n, now.system.force_unit, now.system.length_unit)
    return J[np.ix_(unknown, unknown)] * units / residual_units[:, None]


def difference_jacobian(now):
    """Return the scaled Jacobian by forward differences of the residual: one evaluation a column."""
    columns, system, equations = [], now.system, now.system.equations
    units, forces, n = _units(now), now.elements.Q[:2].T[now.unknown], np.count_nonzero(now.moving)
    typical = np.full(units.size, np.median(np.abs(equations.w) * equations.L))
    typical[:n] = np.median(equations.L)
    scale = np.concatenate([np.abs(now.r[now.moving]), np.abs(forces)])
    for i in range(units.size):
        step = DIFFERENCE * max(scale[i], typical[i], units[i] * 1e-3)
        scaled = np.zeros(units.size)
        scaled[i] = step / units[i]
        dr, *forces_change = split_step(now, scaled)
        shifted = system.evaluate(now.r + dr, *(now.elements.Q[:2] + forces_change))
        force_change = (shifted.force - now.force)[now.moving] / system.force_unit
        gap_change = (shifted.gap - now.gap)[now.unknown] / system.length_unit
        difference = np.concatenate([force_change, gap_change])
        columns.append(difference / step * units[i])
    return np.column_stack(columns)


def _units(now):
    """Return the unit of each unknown."""
    units = now.system.length_unit, now.system.force_unit
    return np.repeat(units, [np.count_nonzero(now.moving), np.count_nonzero(now.unknown)])


def split_step(now, scaled):
    """Return (dr (n, 3), dH (e,), dV (e,)) from a scaled vector of unknowns."""
    change = scaled * _units(now)
    n = np.count_nonzero(now.moving)
    dr, dq = np.zeros_like(now.r), np.zeros((now.kind.size, 2))
    dr[now.moving] = change[:n]
    dq[now.unknown] = change[n:]
    return dr, dq[:, 0], dq[:, 1]


def scaled_jacobian(now, jacobian):
    """Return the scaled Jacobian, "analytic" or by "finite-difference"."""
    return analytic_jacobian(now) if jacobian == "analytic" else difference_jacobian(now)


def _newton_step(now, jacobian):
    """Return the scaled Jacobian and the scaled Newton step; counts (2/3) n^3 operations (MSQS 5.6)."""
    J = scaled_jacobian(now, jacobian)
    now.system.count.operations += 2 / 3 * J.shape[0] ** 3
    return J, _solve(J, -now.residual)


def dense_step(now, jacobian):
    """Return the Newton step (dr, dH, dV) of an Iterate by the whole matrix."""
    return split_step(now, _newton_step(now, jacobian)[1])


def trust_region_step(now, jacobian, radius):
    """Return (next Iterate or None, radius) by Powell's dogleg between the gradient and the Newton step.

    Accepted by the reduction that the linear model predicts, not by ``halve_step``: the direction changes with length.
    """
    (J, newton), Z = _newton_step(now, jacobian), now.residual
    gradient = J.T @ Z
    cauchy = -gradient * (gradient @ gradient) / np.sum((J @ gradient) ** 2)
    radius = np.linalg.norm(newton) if radius is None else radius
    while radius > 1e-12 * (1 + np.linalg.norm(newton)):
        p = _dogleg(newton, cauchy, radius)
        new = now.take_step(1.0, split_step(now, p))
        predicted = Z @ Z - np.sum((Z + J @ p) ** 2)
        ratio = (Z @ Z - np.sum(new.residual**2)) / predicted
        if ratio > 0.75:
            radius = max(radius, GROW * np.linalg.norm(p))
        if ratio > 1e-4:
            return new, radius if ratio > 0.25 else SHRINK * np.linalg.norm(p)
        radius = SHRINK * np.linalg.norm(p)
    return None, radius


def _dogleg(newton, cauchy, radius):
    """Return the point of the dogleg path at most ``radius`` long."""
    if np.linalg.norm(newton) <= radius:
        return newton
    if np.linalg.norm(cauchy) >= radius:
        return cauchy * (radius / np.linalg.norm(cauchy))
    d = newton - cauchy
    a, half_b, c = d @ d, cauchy @ d, cauchy @ cauchy - radius**2
    return cauchy + (-half_b + np.sqrt(half_b**2 - a * c)) / a * d


def _solve(J, right):
    """Return J^-1 right; the smallest solution where slack lines leave J singular, NaN where J is not finite."""
    if not np.isfinite(J).all():
        return np.full_like(right, np.nan)
    try:
        return np.linalg.solve(J, right)
    except np.linalg.LinAlgError:
        return np.linalg.lstsq(J, right, rcond=None)[0]
