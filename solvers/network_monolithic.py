"""Monolithic solution of a network, MSQS section 3.3: positions and element forces z = [r, H, V] in one Newton loop.

The residual is the force balance (3.6) of the free nodes, then l(H, V) - l(r) and h(H, V) - h(r) of each element, with
the Jacobian (3.7): A = dF/dr, B = dF/d(H, V), C = d(l, h)/d(H, V). C consists of 2 x 2 blocks, so a Newton step
eliminates it (Schur complement) and factorizes only a matrix of the size of the positions, sparse for large networks.

H and V cannot be unknowns of an element whose forces follow in closed form (slack, vertical, lying): it
enters by its exact forces, as in the nested method, and joins the unknowns when it stretches.
"""

from __future__ import annotations

import numpy as np

from .catenary_excursion import excursion
from .catenary_regimes import NARROWEST, hanging_length
from .elementary import ARRAY
from .network_balance import Elements, exact_forces
from .network_jacobian import dense_step, trust_region_step
from .network_nested import EPS, largest_force, soft_stiffness, solve_sparse

MAX_ITERATIONS = 60
REGULAR = 1e-9  # of the softest stiffness that counts
LEAST = 0.1  # a step leaves every H at least this part of itself
UNITS = {"N": (1.0, 1.0), "kN": (1e3, 1.0), "scaled": None}


def closed_form(balance, geometry):
    """(e,) bool: elements whose forces are not unknowns: vertical, slack, or a fairlead on the seabed."""
    g, w, L = geometry, balance.w, balance.L
    closed = (g.l <= NARROWEST * (L + np.abs(g.rise))) | ((w == 0) & (np.hypot(g.l, g.rise) <= L))
    rows = np.flatnonzero(balance.rests)
    if rows.size:
        e, c = w[rows] / balance.EA[rows], g.clearance[rows]
        over = np.maximum(g.rise[rows] + c, 0.0)
        spare = L[rows] - hanging_length(ARRAY, over, e) - hanging_length(ARRAY, c, e)
        closed[rows] |= (w[rows] > 0) & ((spare >= g.l[rows]) | (over == 0))
    return closed


class Monolith:
    """Residual and Jacobian of one network at an iterate; force and length units scale unknowns and residual alike."""

    def __init__(self, balance, units, count):
        self.balance, self.count = balance, count
        weight = np.abs(balance.w) * balance.L
        typical = max(float(np.median(weight)), float(np.abs(balance.load).max()) / weight.size, 1e-300)
        self.force_unit, self.length_unit = UNITS[units] or (typical, float(np.median(balance.L)))

    def at(self, r, H, V, closed_before=None):
        """The iterate at positions r (n, 3), forces (e,); an element that just stretched gets its exact forces."""
        b = self.balance
        self.count.evaluations += 1
        g = b.geometry(r)
        closed = closed_form(b, g)
        H, V, C = H.copy(), V.copy(), np.zeros((H.size, 2, 2))
        fresh = closed if closed_before is None else closed | closed_before
        H_anchor, V_anchor, D, gap = H.copy(), V.copy(), np.zeros((H.size, 4, 3)), np.zeros((H.size, 2))
        if fresh.any():
            rows = np.flatnonzero(fresh)
            H[rows], V[rows], H_anchor[rows], V_anchor[rows], D[rows], _ = exact_forces(b, g, rows)
        rows = np.flatnonzero(~closed)
        lines = (b.w[rows], b.EA[rows], b.L[rows], b.rests[rows], g.friction[rows], g.clearance[rows])
        x = excursion(H[rows], V[rows], *lines)
        H_anchor[rows], V_anchor[rows] = x.H_anchor, x.V_anchor
        gap[rows] = np.column_stack([x.l - g.l[rows], x.h - g.rise[rows]])
        C[rows] = _inverse(x.C)
        # P = dQ/d(H, V) of the forces Q = (H, V, H_anchor, V_anchor); G = d(l, h)/d(l, z_a, z_f), less what c moves
        P = np.concatenate([np.broadcast_to(np.eye(2), x.C.shape), x.anchor], axis=1)
        G = np.zeros((rows.size, 2, 3))
        G[:, 0, 0] = G[:, 1, 2] = 1.0
        G[:, 0, 1], G[:, 1, 1] = -x.raised[:, 0], -1.0 - x.raised[:, 1]
        D[rows] = P @ C[rows] @ G
        D[rows, 3, 1] += x.raised[:, 2]
        return Iterate(self, r, Elements(g, H, V, H_anchor, V_anchor, D), closed, gap, C, P, G, rows, x)


class Iterate:
    """One iterate: node forces, gaps (e, 2) of the catenary equations, C^-1 (e, 2, 2), what a step needs of them."""

    def __init__(self, monolith, r, elements, closed, gap, C_inverse, P, G, rows, x):
        self.monolith, self.r, self.elements, self.closed, self.gap = monolith, r, elements, closed, gap
        self.C_inverse, self.P, self.G, self.rows, self.C, self.raised = C_inverse, P, G, rows, x.C, x.raised
        b = monolith.balance
        self.force = b.unbalanced(elements)
        self.moving = b.free[:, None] & np.array([True, True, True])
        self.moving[:, 2] &= ~((r[:, 2] <= b.floor) & (self.force[:, 2] <= 0))

    @property
    def residual(self):
        """Scaled residual [F, l - l(r), h - h(r)] of the moving coordinates and open elements."""
        m = self.monolith
        return np.concatenate([self.force[self.moving] / m.force_unit, self.gap[self.rows].ravel() / m.length_unit])

    def newton_step(self):
        """(dr (n, 3), dH (e,), dV (e,)) by the Schur complement of the C blocks."""
        b, e, rows = self.monolith.balance, self.elements, self.rows
        correction = -np.einsum("eij,ej->ei", self.P, np.einsum("eij,ej->ei", self.C_inverse[rows], self.gap[rows]))
        Q = np.stack([e.H, e.V, e.H_anchor, e.V_anchor], axis=-1)
        Q[rows] += correction
        right = b.unbalanced(Elements(e.geometry, *Q.T, e.D))[self.moving]
        unknown = b.dof[self.moving]
        tangent = b.tangent(e)
        tangent = tangent if unknown.size == b.size else tangent[unknown][:, unknown]
        dr = np.zeros_like(self.r)
        shift = REGULAR * soft_stiffness(b)  # where slack lines leave a direction without stiffness
        change = solve_sparse(tangent, shift, right, self.monolith.count)
        if change is None:
            return None
        dr[self.moving] = change
        return dr, *self._forces_after(dr)

    def _forces_after(self, dr):
        b, rows = self.monolith.balance, self.rows
        along = np.einsum("ei,ei->e", self.elements.geometry.direction, dr[b.fairlead, :2] - dr[b.anchor, :2])
        change = np.column_stack([along, dr[b.anchor, 2], dr[b.fairlead, 2]])[rows]
        dq = np.zeros((b.w.size, 2))
        target = np.einsum("eij,ej->ei", self.G, change) - self.gap[rows]
        dq[rows] = np.einsum("eij,ej->ei", self.C_inverse[rows], target)
        return dq[:, 0], dq[:, 1]

    def after(self, length, step):
        """The next iterate: no node below the floor, no H below a part of itself."""
        dr, dH, dV = step
        b, e = self.monolith.balance, self.elements
        r = self.r + length * dr
        r[b.free, 2] = np.maximum(r[b.free, 2], b.floor)
        return self.monolith.at(r, np.maximum(e.H + length * dH, LEAST * e.H), e.V + length * dV, self.closed)


def solve(balance, r, H, V, count, units="scaled", jacobian="analytic", globalisation="line-search", tolerance=1e-10):
    """Newton's method from positions r (n, 3) and forces H, V (e,); returns (last iterate, converged).

    tolerance : of the force balance over the largest force, gaps counted by the force that they stand for; a gap that
    is no more than the rounding of the positions is closed.
    """
    m = Monolith(balance, units, count)
    with np.errstate(all="ignore"):  # trial steps may overflow; their norm is then no decrease
        now = _iterate(m.at(r, H, V), jacobian, globalisation, tolerance)
        return now, _converged(now, tolerance)


def _iterate(now, jacobian, globalisation, tolerance):
    radius = None
    for _ in range(MAX_ITERATIONS):
        if _converged(now, tolerance):
            break
        now.monolith.count.iterations += 1
        if globalisation == "trust-region":
            new, radius = trust_region_step(now, jacobian, radius)
        else:
            new = _line_search(now, now.newton_step() if jacobian == "analytic" else dense_step(now, jacobian))
        if new is None:
            break
        now = new
    return now


def _converged(now, tolerance):
    """The force balance, and the forces that the gaps stand for, are small against the largest force."""
    b = now.monolith.balance
    bound = tolerance * largest_force(b, now.elements)
    rounding = 4 * EPS * (np.abs(now.r).max() + b.L)
    gap = np.abs(now.gap).max(axis=1)
    closed = (gap * b.EA / b.L <= bound) | (gap <= rounding)  # the stiffest that the line can answer with
    return bool(np.abs(now.force[now.moving]).max(initial=0.0) <= bound and closed.all())


def _inverse(C):
    """Inverses of 2 x 2 blocks (k, 2, 2)."""
    swapped = np.stack([C[:, 1, 1], -C[:, 0, 1], -C[:, 1, 0], C[:, 0, 0]], axis=-1).reshape(-1, 2, 2)
    return swapped / (C[:, 0, 0] * C[:, 1, 1] - C[:, 0, 1] * C[:, 1, 0])[:, None, None]


def _line_search(now, step):
    """Halve the step until the norm of the residual falls; None if it does not, or if there is no step."""
    if step is None:
        return None
    norm, length = np.linalg.norm(now.residual), 1.0
    while length > 1e-8:
        new = now.after(length, step)
        if np.linalg.norm(new.residual) <= (1 - 1e-4 * length) * norm:
            return new
        length /= 2
    return None
