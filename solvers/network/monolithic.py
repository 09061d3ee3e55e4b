"""Monolithic solution of a network, MSQS section 3.3: positions and element forces z = [r, H, V] in one Newton loop.

The residual is the force balance (3.6) of the free nodes, then l(H, V) - l(r) and h(H, V) - h(r) of each element, with
the Jacobian (3.7): A = dF/dr, B = dF/d(H, V), C = d(l, h)/d(H, V). C consists of 2 x 2 blocks, so a Newton step
eliminates it (Schur complement) and factorizes only a matrix of the size of the positions, sparse for large networks.

Forces as unknowns keep their digits where positions rounded to doubles do not tell them: in stiff taut lines, vertical
ones and those stretched along the seabed too. Only a slack element, whose forces follow from its weight alone, enters
by its exact forces, as in the nested method.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from ..catenary.excursion import excursion, spring_stiffness
from ..catenary.regimes import hanging_force, hanging_length
from ..numerics.elementary import ARRAY
from .equations import Elements, Geometry, exact_forces
from .jacobian import dense_step, trust_region_step
from .nested import EPS, largest_force, solve_sparse
from .scalar import FEWEST, LEAST, lead

MAX_ITERATIONS = 60
LARGEST_WHOLE = 1000  # unknowns up to which the whole Jacobian is factorized when eliminating parts of it failed
REGULAR = 1e-9  # of the softest stiffness that counts
UNITS = {"N": (1.0, 1.0), "kN": (1e3, 1.0), "scaled": None}
TAUTENED = 16 * EPS  # strain that a line which just became taut starts from
OPEN, FLAT, UPRIGHT, CLOSED = range(4)
RISE = np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 1.0]])  # d(l, rise)/d(l, z_a, z_f)


def kinds(balance, g):
    """(e,) how elements of geometry ``g`` enter.

    OPEN : by the unknowns H and V;  FLAT : by H alone, the fairlead on the seabed, V = 0;
    UPRIGHT : by V alone, vertical, H in proportion to l;  CLOSED : by exact forces, slack
    """
    short = g.l <= g.rounding
    kind = np.where(short, UPRIGHT, OPEN) if np.count_nonzero(short) else np.zeros(short.size, int)
    if balance.any_massless:
        taut = np.sqrt(g.l * g.l + g.rise * g.rise) >= balance.L - g.rounding
        kind = np.where(balance.massless, np.where(taut, OPEN, CLOSED), kind)
    if balance.any_rests:
        over = np.maximum(g.rise + g.clearance, 0.0)
        hanging = hanging_length(ARRAY, np.array([over, g.clearance]), balance.softness)
        spare = balance.L - hanging[0] - hanging[1] - g.l
        if np.count_nonzero(over) < over.size:
            low = np.flatnonzero(balance.heavy & (over == 0))
            L = balance.L[low]
            spare[low] -= g.rounding[low]
            kind[low[_rests(g.l[low] / L, g.clearance[low] / L, balance.softness[low] * L)]] = FLAT
        slack = balance.heavy & (spare >= 0)
        if np.count_nonzero(slack):
            kind[slack] = CLOSED
    return kind


def _rests(l, h, e):
    """Whether a line down to the seabed is horizontal there, by (2.23) where it just touches; in units of L and w L."""
    k = h - e / 2
    H = (1 - k * k) / (2 * k)
    return (k <= 0) | ((k < 1) & (l <= H * (np.arcsinh(1 / H) + e)))


class Monolith:
    """Rows and Jacobian of one network at an iterate; force and length units scale unknowns and residual alike."""

    def __init__(self, balance, units, count):
        self.balance, self.count = balance, count
        self.force_unit, self.length_unit = UNITS[units] or (balance.typical_force, balance.typical_length)  # type: ignore[var-annotated]

    def at(self, r, H, V, before=None):
        """The iterate at positions r (n, 3), forces (e,); before: the kinds (e,) that they come from."""
        self.count.function_evaluations += 1
        return Iterate(self, r, H, V, before)


class Iterate:
    """One iterate: forces on its nodes, gaps (e, 2) of the catenary equations, and what a step needs of them."""

    def __init__(self, monolith, r, H, V, before):
        b, Q = monolith.balance, np.empty((4, H.size))
        self.monolith, self.r, self.geometry = monolith, r, Geometry(b, r)
        g, Q[0], Q[1] = self.geometry, H, V
        self.kind = kinds(b, g)
        self.plain = not np.count_nonzero(self.kind)  # all of them OPEN
        self.closed, self.flat, self.upright = (self.kind == kind for kind in (CLOSED, FLAT, UPRIGHT))
        if not self.plain or (H.min() <= 0 if before is None else np.count_nonzero(before)):
            self._begin(Q, before)
        self.x = x = excursion(Q[0], Q[1], b.w, b.EA, b.L, b.rests, g.friction, g.clearance)
        if self.plain:
            Q[2], Q[3] = x.H_anchor, x.V_anchor
        else:
            x.H_anchor = np.where(self.upright, g.l / x.C[:, 0, 0], x.H_anchor)
            Q[0] = np.where(self.upright, x.H_anchor, Q[0])
            Q[2:] = np.where(self.closed, Q[2:], (x.H_anchor, x.V_anchor))
        self.gap = np.array([x.l - g.l, x.h - g.rise]).T
        if not self.plain:
            self.gap[~self.unknown] = 0.0
        self.elements = Elements(g, Q)
        self.force = b.unbalanced(self.elements)
        self.moving = b.moving(r, self.force)

    def _begin(self, Q, before):
        """Set H and V of Q (4, e) where the kind has changed; all of closed elements.

        Lines that become straight begin with hardly a force, and keep the digits that lengths lack.
        """
        b, g, change = self.monolith.balance, self.geometry, ~self.upright
        new = change & (Q[0] <= 0) if before is None else change & (before >= UPRIGHT)
        straight = new & ((self.flat & (g.friction == 0)) | (b.massless & ~self.closed))
        if straight.any():
            T = TAUTENED * b.EA / np.sqrt(g.l * g.l + g.rise * g.rise)
            Q[0], Q[1] = np.where(straight, T * g.l, Q[0]), np.where(straight, T * g.rise, Q[1])
        Q[0, self.upright] = Q[1, self.flat] = 0.0
        lifted = np.flatnonzero((self.kind == OPEN) & (before == FLAT)) if before is not None else ()
        if len(lifted):
            weight, over = (b.w * b.L)[lifted], (g.rise + g.clearance)[lifted] / b.L[lifted]
            Q[1, lifted] = weight * hanging_force(ARRAY, Q[0, lifted] / weight, over, weight / b.EA[lifted])
        self.exact = np.flatnonzero(self.closed | (new & ~straight))
        if self.exact.size:
            Q[:, self.exact], self.D_exact, inner = exact_forces(b, g, self.exact)
            self.monolith.count.inner_iterations += inner

    @cached_property
    def unknown(self):
        """(e, 2) bool: which of (H, V) are unknowns."""
        return np.array([~(self.closed | self.upright), ~(self.closed | self.flat)]).T

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
        x, balance = self.x, self.monolith.balance
        a, b, c, d = x.C.reshape(-1, 4).T
        K = (np.array([d, -b, -c, a]) / (a * d - b * c)).T.reshape(-1, 2, 2)
        G, D = np.empty((self.kind.size, 2, 3)), np.empty((self.kind.size, 4, 3))
        G[:] = RISE
        G[:, :, 1] -= x.raised[:, :2]
        if not self.plain:
            K[self.kind != OPEN] = G[self.flat, 1] = G[self.closed] = 0.0
            K[:, 0, 0] = np.where(self.flat | self.upright, 1 / a, K[:, 0, 0])
            K[:, 1, 1] = np.where(self.upright, 1 / d, K[:, 1, 1])
        if balance.any_massless:
            springs = np.flatnonzero(balance.massless & ~self.closed)
            K[springs] = spring_stiffness(*self.elements.Q[:2, springs], balance.EA[springs], balance.L[springs])  # type: ignore[call-arg]
        D[:, :2] = K @ G
        D[:, 2:] = x.anchor @ D[:, :2]
        D[:, 3, 1] += x.raised[:, 2]
        if not self.plain and self.closed.any():
            D[self.closed] = self.D_exact()[self.closed[self.exact]]
        return K, G, D

    @cached_property
    def tangent(self):
        """Of the moving coordinates, the forces following: A - B C^-1 G."""
        b = self.monolith.balance
        self.elements.D = self.blocks[2]
        tangent = b.tangent(self.elements)
        if self.moving is b.unknown:
            return tangent
        unknown = b.dof[self.moving]
        return tangent[unknown][:, unknown]

    def newton_step(self, other=None):
        """(dr (n, 3), dH (e,), dV (e,)) by the Schur complement of the C blocks; for the residual of another iterate
        with this Jacobian if given. None where it is singular.
        """
        b, other = self.monolith.balance, other or self
        K, _, D = self.blocks
        closing = K @ -other.gap[:, :, None]  # of the gaps, the nodes held
        changed = np.concatenate([closing, self.x.anchor @ closing], axis=1)[:, :, 0].T
        if not self.plain:
            changed = np.where(self.closed, 0.0, changed)
        right = (other.force + b.unbalanced(self.elements, changed) - b.load)[self.moving]
        shift = REGULAR * b.soft_stiffness  # where slack lines leave a direction without stiffness
        change = solve_sparse(self.tangent, shift, right, self.monolith.count)
        if change is None:
            return None
        dr = np.zeros(self.r.shape)
        dr[self.moving] = change
        motion = self.geometry.frame[0][:, :3] @ dr.ravel()[b.coordinates][:, :, None]
        dq = (D[:, :2] @ motion + closing)[:, :, 0]
        if not self.plain:
            dq[~self.unknown] = 0.0
        return dr, dq[:, 0], dq[:, 1]

    def after(self, length, step):
        """The next iterate: no node below the floor, no H below a part of itself, weightless lines pull straight."""
        dr, dH, dV = step
        b, H, V = self.monolith.balance, self.elements.H, self.elements.V
        r = b.on_floor(self.r + length * dr)
        H, V = np.maximum(H + length * dH, LEAST * H), V + length * dV
        if b.any_massless:
            springs = np.flatnonzero(b.massless)
            reach = r[b.fairlead[springs]] - r[b.anchor[springs]]
            l, h = np.hypot(reach[:, 0], reach[:, 1]), reach[:, 2]
            chord = np.hypot(l, h)
            T = np.maximum((H[springs] * l + V[springs] * h) / chord, TAUTENED * b.EA[springs])
            H[springs], V[springs] = T * l / chord, T * h / chord
        return self.monolith.at(r, H, V, self.kind)


def solve(balance, r, H, V, count, units="scaled", jacobian="analytic", globalisation="line-search", tolerance=1e-10):
    """Newton's method from positions r (n, 3) and forces H, V (e,); returns (last iterate, converged).

    tolerance : of the force balance over the largest force, gaps counted by the force that they stand for; a gap that
    is no more than the rounding of the positions is closed.
    """
    m, radius, whole = Monolith(balance, units, count), None, jacobian != "analytic"
    if balance.w.size <= FEWEST and not whole and globalisation == "line-search":
        led = lead(balance, r, H, V, count, (m.force_unit, m.length_unit), tolerance, MAX_ITERATIONS)
        if led is not None and led.balanced:
            return led, True
        r, H, V = (r, H, V) if led is None else (led.r, *led.elements.Q[:2])
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
                if new is None and not whole and balance.size + 2 * balance.w.size <= LARGEST_WHOLE:
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
    if np.count_nonzero(closed) == closed.size:
        return True
    if not (closed | (gap * b.EA / b.L <= bound)).all():  # the line stretched straight: it may be stiffer than now
        return False
    return bool((closed | (np.abs(now.blocks[0] @ now.gap[:, :, None]).max(axis=(1, 2)) <= bound)).all())


def _line_search(now, step, tolerance):
    """Halve the step until the residual falls in norm, or a shorter step mends what it leaves, or all is balanced.

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
