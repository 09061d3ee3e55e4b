"""Monolithic solution of a network, MSQS section 3.3: positions and element forces z = [r, H, V] in one Newton loop.

The residual is the force balance (3.6) of the free nodes, then l(H, V) - l(r) and h(H, V) - h(r) of each element, with
the Jacobian (3.7): A = dF/dr, B = dF/d(H, V), C = d(l, h)/d(H, V). C consists of 2 x 2 blocks, so a Newton step
eliminates it (Schur complement) and factorizes only a matrix of the size of the positions, sparse for large networks.

Forces as unknowns keep their digits where positions rounded to doubles do not tell them: in stiff taut lines, vertical
ones and those stretched along the seabed too. Only where forces follow from weights alone (slack, or folded over) an
element enters by its exact forces, as in the nested method.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from .catenary_excursion import excursion
from .catenary_regimes import hanging_force, hanging_length
from .elementary import ARRAY
from .network_balance import Elements, Geometry, exact_forces
from .network_jacobian import dense_step, trust_region_step
from .network_nested import EPS, largest_force, solve_sparse

MAX_ITERATIONS = 60
REGULAR = 1e-9  # of the softest stiffness that counts
LEAST = 0.1  # a step leaves every H at least this part of itself
UNITS = {"N": (1.0, 1.0), "kN": (1e3, 1.0), "scaled": None}
TAUTENED = 16 * EPS  # strain that a line which just became taut starts from
OPEN, FLAT, UPRIGHT, CLOSED = range(4)


def kinds(balance, g):
    """(e,) how elements of geometry ``g`` enter.

    OPEN : by the unknowns H and V;  FLAT : by H alone, the fairlead on the seabed, V = 0;
    UPRIGHT : by V alone, vertical, H in proportion to l;  CLOSED : by exact forces, slack
    """
    kind = np.where(g.l <= g.rounding, UPRIGHT, OPEN)
    if balance.any_massless:
        loose = (balance.w == 0) & (np.sqrt(g.l * g.l + g.rise * g.rise) < balance.L - g.rounding)
        kind[balance.w == 0] = OPEN
        kind[loose] = CLOSED
    if balance.any_rests:
        over, e, heavy = np.maximum(g.rise + g.clearance, 0.0), balance.w / balance.EA, balance.rests & (balance.w > 0)
        spare = balance.L - hanging_length(ARRAY, over, e) - hanging_length(ARRAY, g.clearance, e) - g.l
        low = np.flatnonzero(heavy & (over == 0))
        if low.size:
            spare[low] -= g.rounding[low]
            kind[low[_rests(g.l[low] / balance.L[low], g.clearance[low] / balance.L[low], (e * balance.L)[low])]] = FLAT
        kind[heavy & (spare >= 0)] = CLOSED
    return kind


def _rests(l, h, e):
    """Whether a line down to the seabed is horizontal there, by (2.23) where it just touches; in units of L and w L."""
    k = h - e / 2
    H = (1 - k * k) / (2 * k)
    return (k <= 0) | ((k < 1) & (l <= H * (np.arcsinh(1 / H) + e)))


class Monolith:
    """Residual and Jacobian of one network at an iterate; force and length units scale unknowns and residual alike."""

    def __init__(self, balance, units, count):
        self.balance, self.count = balance, count
        weight = np.abs(balance.w) * balance.L
        typical = max(float(np.median(weight)), float(np.abs(balance.load).max()) / weight.size, 1e-300)
        self.force_unit, self.length_unit = UNITS[units] or (typical, float(np.median(balance.L)))

    def at(self, r, H, V, before=None):
        """The iterate at positions r (n, 3), forces (e,); before: the kinds (e,) that they come from."""
        self.count.function_evaluations += 1
        return Iterate(self, r, H, V, before)


class Iterate:
    """One iterate: forces on its nodes, gaps (e, 2) of the catenary equations, and what a step needs of them."""

    def __init__(self, monolith, r, H, V, before):
        b = monolith.balance
        self.monolith, self.r, self.geometry = monolith, r, Geometry(b, r)
        g = self.geometry
        self.kind = kinds(b, g)
        self.closed, self.flat, self.upright = (self.kind == kind for kind in (CLOSED, FLAT, UPRIGHT))
        Q = self._begun(H, V, H > 0, before)
        self.x = x = excursion(Q[0], Q[1], b.w, b.EA, b.L, b.rests, g.friction, g.clearance)
        if self.upright.any():
            Q[0] = np.where(self.upright, g.l / x.C[:, 0, 0], Q[0])
            x.H_anchor = np.where(self.upright, Q[0], x.H_anchor)
        Q[2:] = np.where(self.closed, Q[2:], (x.H_anchor, x.V_anchor))
        self.unknown = np.array([~(self.closed | self.upright), ~(self.closed | self.flat)]).T
        self.gap = np.where(self.unknown, np.array([x.l - g.l, x.h - g.rise]).T, 0.0)
        self.elements = Elements(g, Q, None)
        self.force = b.unbalanced(self.elements)
        self.moving = b.moving(r, self.force)

    def _begun(self, H, V, pulled, before):
        """Q (4, e): H and V as given but where the kind has changed, the rest to be filled; closed rows complete."""
        b, g = self.monolith.balance, self.geometry
        Q = np.empty((4, H.size))
        Q[0], Q[1] = np.where(self.upright, 0.0, H), np.where(self.flat, 0.0, V)
        new = ~pulled & ~self.upright if before is None else (before >= UPRIGHT) & ~self.upright
        straight = new & ((self.flat & (g.friction == 0)) | ((b.w == 0) & ~self.closed))  # forces from nothing: they keep the digits that lengths lack
        if straight.any():
            T = TAUTENED * b.EA / np.sqrt(g.l * g.l + g.rise * g.rise)
            Q[0], Q[1] = np.where(straight, T * g.l, Q[0]), np.where(straight & ~self.flat, T * g.rise, Q[1])
        if before is not None and (before == FLAT).any():
            rows = np.flatnonzero((before == FLAT) & (self.kind == OPEN))
            weight, over = (b.w * b.L)[rows], np.maximum(g.rise + g.clearance, 0.0)[rows]
            Q[1, rows] = weight * hanging_force(ARRAY, Q[0, rows] / weight, over / b.L[rows], weight / b.EA[rows])
        self.exact = np.flatnonzero(self.closed | (new & ~straight))
        if self.exact.size:
            Q[:, self.exact], self.D_exact, inner = exact_forces(b, g, self.exact)
            self.monolith.count.inner_iterations += inner
        return Q

    @property
    def residual(self):
        """Scaled residual [F, l - l(r), h - h(r)] of the moving coordinates and of the unknown forces."""
        m = self.monolith
        return np.concatenate([self.force[self.moving] / m.force_unit, self.gap[self.unknown] / m.length_unit])

    @cached_property
    def norm(self):
        """Of the residual."""
        m, F, gap = self.monolith, self.force[self.moving], self.gap.ravel()
        return np.sqrt(F @ F / m.force_unit**2 + gap @ gap / m.length_unit**2)

    @cached_property
    def blocks(self):
        """(K, G, D): C^-1 (e, 2, 2); d(l, h)/d(l, z_a, z_f) (e, 2, 3), less what the height of the anchor moves; all
        derivatives of the forces (e, 4, 3). Zero rows of K where H or V is no unknown.
        """
        x = self.x
        K = _inverse(x.C, self.flat | self.upright)
        K[self.flat, 1, 1] = 0.0
        G = np.zeros((self.kind.size, 2, 3))
        G[:, 0, 0] = G[:, 1, 2] = 1.0
        G[:, 0, 1], G[:, 1, 1] = -x.raised[:, 0], -1.0 - x.raised[:, 1]
        G[self.flat, 1] = 0.0
        K[self.closed] = G[self.closed] = 0.0
        D = np.empty((self.kind.size, 4, 3))
        D[:, :2] = K @ G
        D[:, 2:] = x.anchor @ D[:, :2]
        D[:, 3, 1] += x.raised[:, 2]
        if self.closed.any():
            D[self.closed] = self.D_exact[self.closed[self.exact]]
        return K, G, D

    def newton_step(self, other=None):
        """(dr (n, 3), dH (e,), dV (e,)) by the Schur complement of the C blocks; for the residual of another iterate
        with this Jacobian if given. None where it is singular.
        """
        b, e, other = self.monolith.balance, self.elements, other or self
        K, _, e.D = self.blocks
        closing = K @ -other.gap[:, :, None]  # of the gaps, the nodes held
        changed = np.concatenate([closing, self.x.anchor @ closing], axis=1)[:, :, 0]
        right = (other.force + b.unbalanced(e, np.where(self.closed, 0.0, changed.T)) - b.load)[self.moving]
        tangent, unknown = b.tangent(e), b.dof[self.moving]
        tangent = tangent if unknown.size == b.size else tangent[unknown][:, unknown]
        dr = np.zeros_like(self.r)
        shift = REGULAR * b.soft_stiffness  # where slack lines leave a direction without stiffness
        change = solve_sparse(tangent, shift, right, self.monolith.count)
        if change is None:
            return None
        dr[self.moving] = change
        motion = self.geometry.frame[0][:, :3] @ dr.ravel()[b.coordinates][:, :, None]
        dH, dV = (e.D[:, :2] @ motion + closing)[:, :, 0].T
        return dr, np.where(self.unknown[:, 0], dH, 0.0), np.where(self.unknown[:, 1], dV, 0.0)

    def after(self, length, step):
        """The next iterate: no node below the floor, no H below a part of itself."""
        dr, dH, dV = step
        H, V = self.elements.H, self.elements.V
        r = self.monolith.balance.on_floor(self.r + length * dr)
        return self.monolith.at(r, np.maximum(H + length * dH, LEAST * H), V + length * dV, self.kind)


def solve(balance, r, H, V, count, units="scaled", jacobian="analytic", globalisation="line-search", tolerance=1e-10):
    """Newton's method from positions r (n, 3) and forces H, V (e,); returns (last iterate, converged).

    tolerance : of the force balance over the largest force, gaps counted by the force that they stand for; a gap that
    is no more than the rounding of the positions is closed.
    """
    m, radius, whole = Monolith(balance, units, count), None, jacobian != "analytic"
    with np.errstate(all="ignore"):  # trial steps may overflow; their norm is then no decrease
        now = m.at(r, H, V)
        for _ in range(MAX_ITERATIONS):
            if _converged(now, tolerance):
                return now, True
            count.iterations += 1
            if globalisation == "trust-region":
                new, radius = trust_region_step(now, jacobian, radius)
            else:
                step = dense_step(now, jacobian) if whole else now.newton_step()
                new = None if step is None else _line_search(now, step, tolerance)
                if new is None and not whole:
                    new, whole = now, True  # eliminating the stiffest lines may leave the others no digits
            if new is None:
                break
            now = new
        return now, _converged(now, tolerance)


def _converged(now, tolerance):
    """The force balance, and the forces that the gaps stand for, are small against the largest force."""
    b, bound = now.monolith.balance, tolerance * largest_force(now.elements)
    if not np.abs(now.force[now.moving]).max(initial=0.0) <= bound:
        return False
    gap = np.abs(now.gap).max(axis=1)
    closed = gap <= now.geometry.rounding
    if not (closed | (gap * b.EA / b.L <= bound)).all():  # the line stretched straight: it may be stiffer than now
        return False
    return bool((closed | (np.abs(now.blocks[0] @ now.gap[:, :, None]).max(axis=(1, 2)) <= bound)).all())


def _inverse(C, single):
    """Inverses of 2 x 2 blocks (e, 2, 2); of their diagonals, infinite entries too, where ``single``."""
    a, b, c, d = C.reshape(-1, 4).T
    K = (np.array([d, -b, -c, a]) / (a * d - b * c)).T.reshape(-1, 2, 2)
    if single.any():
        K[single] = 0.0
        K[single, 0, 0], K[single, 1, 1] = 1 / a[single], 1 / d[single]
    return K


def _line_search(now, step, tolerance):
    """Halve the step until the residual falls in norm, or what it leaves is mended by a shorter step, or all is balanced.

    The norm alone would creep where a stiff line swings: a full step across lengthens it, which the next step mends.
    """
    length = 1.0
    while length > 1e-8:
        new = now.after(length, step)
        if new.norm <= (1 - 1e-4 * length) * now.norm or _mends(now, new, step, length) or _converged(new, tolerance):
            return new
        length /= 2
    return None


def _mends(now, new, step, length):
    """The natural test of Deuflhard (Newton Methods for Nonlinear Problems): the simplified step is the shorter."""
    if not np.isfinite(new.norm):
        return False
    simplified = now.newton_step(new)
    return simplified is not None and np.linalg.norm(simplified[0]) <= (1 - length / 4) * np.linalg.norm(step[0])
