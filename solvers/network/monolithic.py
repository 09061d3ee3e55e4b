"""Monolithic solution of a network, MSQS section 3.3: positions and element forces z = [r, H, V] in one Newton loop.

The residual is the force balance (3.6) of the free nodes, then l(H, V) - l(r) and h(H, V) - h(r) of each element, with
the Jacobian (3.7): A = dF/dr, B = dF/d(H, V), C = d(l, h)/d(H, V). C consists of 2 x 2 blocks, so a Newton step
eliminates it (Schur complement) and factorizes only a matrix of the size of the positions, sparse for large networks.

Forces as unknowns keep digits that positions rounded to doubles lose: in stiff taut lines, also vertical ones and those
stretched along the seabed. Only a slack element, whose forces follow from its weight alone, enters by its exact forces,
as in the nested method.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from ..catenary.excursion import excursion, spring_stiffness
from ..catenary.regimes import hanging_force_in_newtons, hanging_length, rests_from_anchor, slack_length
from ..numerics.elementary import ARRAY
from ..numerics.newton import halve_step, is_contraction, iterate
from .equations import Elements, Geometry, exact_forces
from .jacobian import dense_step, trust_region_step
from .nested import EPS, largest_force, motion_by, tangent_of
from .scalar import MAX_LINES, MIN_H_FRACTION, solve_small

MAX_ITERATIONS = 60
MAX_DENSE_JACOBIAN = 1000  # unknowns up to which the whole Jacobian is factorized when eliminating C failed
REGULARISATION = 1e-9  # of the softest stiffness that counts
UNITS = {"N": (1.0, 1.0), "kN": (1e3, 1.0), "scaled": None}
TAUT_STRAIN = 16 * EPS  # strain that a line which just became taut starts from
RISE = np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 1.0]])  # d(l, rise)/d(l, z_a, z_f)


class Kind:
    """How an element enters.

    GENERAL : by the unknowns H and V;  LYING : by H alone, the fairlead on the seabed, V = 0;
    VERTICAL : by V alone, H in proportion to l;  SLACK : by exact forces
    """

    GENERAL, LYING, VERTICAL, SLACK = range(4)


def element_kinds(equations, g):
    """Return the Kind (e,) of each element of geometry ``g``."""
    short = g.l <= g.rounding
    kind = np.where(short, Kind.VERTICAL, Kind.GENERAL) if np.count_nonzero(short) else np.zeros(short.size, int)
    if equations.any_massless:
        taut = np.sqrt(g.l * g.l + g.rise * g.rise) >= equations.L - g.rounding
        kind = np.where(equations.massless, np.where(taut, Kind.GENERAL, Kind.SLACK), kind)
    if equations.any_can_rest:
        height = np.maximum(g.rise + g.clearance, 0.0)
        hanging = hanging_length(ARRAY, np.array([height, g.clearance]), equations.weight_strain)
        left = slack_length(equations.L, g.l, *hanging)
        if np.count_nonzero(height) < height.size:
            low = np.flatnonzero(equations.heavy & (height == 0))
            L = equations.L[low]
            left[low] -= g.rounding[low]
            rests = rests_from_anchor(ARRAY, g.l[low] / L, g.clearance[low] / L, equations.weight_strain[low] * L)
            kind[low[rests]] = Kind.LYING
        slack = equations.heavy & (left >= 0)
        if np.count_nonzero(slack):
            kind[slack] = Kind.SLACK
    return kind


class MonolithicSystem:
    """Residual and Jacobian of one network at an iterate; force and length units scale unknowns and residual alike."""

    def __init__(self, equations, units, count):
        self.equations, self.count = equations, count
        self.force_unit, self.length_unit = UNITS[units] or (equations.typical_force, equations.typical_length)  # type: ignore[var-annotated]

    def evaluate(self, r, H, V, previous_kind=None):
        """Return the Iterate at positions r (n, 3), forces (e,); previous_kind : (e,) of the iterate before."""
        self.count.function_evaluations += 1
        return Iterate(self, r, H, V, previous_kind)


class Iterate:
    """One iterate: forces on its nodes, gaps (e, 2) of the catenary equations, and what a step needs of them."""

    def __init__(self, system, r, H, V, previous_kind):
        eq, Q = system.equations, np.empty((4, H.size))
        self.system, self.r, self.geometry = system, r, Geometry(eq, r)
        g, Q[0], Q[1] = self.geometry, H, V
        self.kind = element_kinds(eq, g)
        self.all_general = not np.count_nonzero(self.kind)
        self.slack, self.lying, self.vertical = (self.kind == k for k in (Kind.SLACK, Kind.LYING, Kind.VERTICAL))
        if not self.all_general or (H.min() <= 0 if previous_kind is None else np.count_nonzero(previous_kind)):
            self._start_changed_elements(Q, previous_kind)
        self.excursion = x = excursion(Q[0], Q[1], eq.w, eq.EA, eq.L, eq.can_rest, g.friction, g.clearance)
        if self.all_general:
            Q[2], Q[3] = x.H_anchor, x.V_anchor
        else:
            x.H_anchor = np.where(self.vertical, g.l / x.C[:, 0, 0], x.H_anchor)
            Q[0] = np.where(self.vertical, x.H_anchor, Q[0])
            Q[2:] = np.where(self.slack, Q[2:], (x.H_anchor, x.V_anchor))
        self.gap = np.array([x.l - g.l, x.h - g.rise]).T
        if not self.all_general:
            self.gap[~self.unknown] = 0.0
        self.elements = Elements(g, Q)
        self.force = eq.unbalanced_force(self.elements)
        self.moving = eq.moving_coordinates(r, self.force)

    def _start_changed_elements(self, Q, previous_kind):
        """Set H and V of Q (4, e) where the kind has changed, and all of slack elements.

        Lines that become straight start with hardly a force, and keep the digits that lengths lack.
        """
        eq, g, can_change = self.system.equations, self.geometry, ~self.vertical
        new = can_change & (Q[0] <= 0 if previous_kind is None else previous_kind >= Kind.VERTICAL)
        straight = new & ((self.lying & (g.friction == 0)) | (eq.massless & ~self.slack))
        if straight.any():
            T = TAUT_STRAIN * eq.EA / np.sqrt(g.l * g.l + g.rise * g.rise)
            Q[0], Q[1] = np.where(straight, T * g.l, Q[0]), np.where(straight, T * g.rise, Q[1])
        Q[0, self.vertical] = Q[1, self.lying] = 0.0
        if previous_kind is not None:
            lifted = np.flatnonzero((self.kind == Kind.GENERAL) & (previous_kind == Kind.LYING))
            if lifted.size:
                line = (a[lifted] for a in (Q[0], g.rise + g.clearance, eq.w, eq.EA, eq.L))
                Q[1, lifted] = hanging_force_in_newtons(ARRAY, *line)
        self.exact = np.flatnonzero(self.slack | (new & ~straight))
        if self.exact.size:
            Q[:, self.exact], self.D_exact, inner = exact_forces(eq, g, self.exact)
            self.system.count.inner_iterations += inner

    @cached_property
    def unknown(self):
        """(e, 2) bool: which of (H, V) are unknowns."""
        return np.array([~(self.slack | self.vertical), ~(self.slack | self.lying)]).T

    @property
    def residual(self):
        """Scaled residual [F, l - l(r), h - h(r)] of the moving coordinates and of the unknown forces."""
        s = self.system
        return np.concatenate([self.force[self.moving] / s.force_unit, self.gap[self.unknown] / s.length_unit])

    @cached_property
    def norm(self):
        """Euclidean norm of the scaled residual."""
        s, F, gap = self.system, self.force[self.moving], self.gap.ravel()
        return np.sqrt(F @ F / s.force_unit**2 + gap @ gap / s.length_unit**2)

    @cached_property
    def blocks(self):
        """(K, G, D): C^-1 (e, 2, 2), zero rows where H or V is no unknown; d(l, h)/d(l, z_a, z_f) (e, 2, 3), less what
        the height of the anchor changes; all derivatives of the forces (e, 4, 3).
        """
        x, equations = self.excursion, self.system.equations
        a, b, c, d = x.C.reshape(-1, 4).T
        K = (np.array([d, -b, -c, a]) / (a * d - b * c)).T.reshape(-1, 2, 2)
        G, D = np.empty((self.kind.size, 2, 3)), np.empty((self.kind.size, 4, 3))
        G[:] = RISE
        G[:, :, 1] -= x.by_clearance[:, :2]
        if not self.all_general:
            K[self.kind != Kind.GENERAL] = G[self.lying, 1] = G[self.slack] = 0.0
            K[:, 0, 0] = np.where(self.lying | self.vertical, 1 / a, K[:, 0, 0])
            K[:, 1, 1] = np.where(self.vertical, 1 / d, K[:, 1, 1])
        if equations.any_massless:
            springs = np.flatnonzero(equations.massless & ~self.slack)
            K[springs] = spring_stiffness(*self.elements.Q[:2, springs], equations.EA[springs], equations.L[springs])  # type: ignore[call-arg]
        D[:, :2] = K @ G
        D[:, 2:] = x.anchor @ D[:, :2]
        D[:, 3, 1] += x.by_clearance[:, 2]
        if not self.all_general and self.slack.any():
            D[self.slack] = self.D_exact()[self.slack[self.exact]]
        return K, G, D

    @cached_property
    def tangent(self):
        """Schur complement A - B C^-1 G of the moving coordinates: the forces follow them."""
        self.elements.D = self.blocks[2]
        return tangent_of(self.system.equations, self.elements, self.moving)

    def newton_step(self, other=None):
        """Return (dr (n, 3), dH (e,), dV (e,)) by the Schur complement of the C blocks, None where it is singular.

        other : iterate whose residual is taken, with the Jacobian of this one, instead of its own
        """
        equations, other = self.system.equations, other or self
        K, _, D = self.blocks
        closing = K @ -other.gap[:, :, None]  # forces that close the gaps at fixed nodes
        changed = np.concatenate([closing, self.excursion.anchor @ closing], axis=1)[:, :, 0].T
        if not self.all_general:
            changed = np.where(self.slack, 0.0, changed)
        force = other.force + equations.unbalanced_force(self.elements, changed) - equations.load
        shift = REGULARISATION * equations.soft_stiffness  # where slack lines leave a direction without stiffness
        dr = motion_by(self.tangent, shift, force, self.moving, self.system.count)
        if dr is None:
            return None
        motion = self.geometry.frame[0][:, :3] @ dr.ravel()[equations.coordinates][:, :, None]
        dq = (D[:, :2] @ motion + closing)[:, :, 0]
        if not self.all_general:
            dq[~self.unknown] = 0.0
        return dr, dq[:, 0], dq[:, 1]

    def take_step(self, length, step):
        """Return the iterate after a part of a step.

        No node falls below the seabed, no H below a part of itself; weightless lines pull along their chord.
        """
        dr, dH, dV = step
        eq, H, V = self.system.equations, self.elements.H, self.elements.V
        r = eq.lift_to_seabed(self.r + length * dr)
        H, V = np.maximum(H + length * dH, MIN_H_FRACTION * H), V + length * dV
        if eq.any_massless:
            springs = np.flatnonzero(eq.massless)
            reach = r[eq.fairlead[springs]] - r[eq.anchor[springs]]
            l, h = np.hypot(reach[:, 0], reach[:, 1]), reach[:, 2]
            chord = np.hypot(l, h)
            T = np.maximum((H[springs] * l + V[springs] * h) / chord, TAUT_STRAIN * eq.EA[springs])
            H[springs], V[springs] = T * l / chord, T * h / chord
        return self.system.evaluate(r, H, V, self.kind)


class _MonolithicNewton:
    """The steps of ``solve``."""

    def __init__(self, jacobian, globalisation, tolerance):
        self.jacobian, self.trust_region, self.tolerance = jacobian, globalisation == "trust-region", tolerance
        self.dense, self.radius = jacobian != "analytic", None

    def step(self, now):
        """Return the next Iterate, None where there is none."""
        system, equations = now.system, now.system.equations
        system.count.iterations += 1
        if self.trust_region:
            new, self.radius = trust_region_step(now, self.jacobian, self.radius)
            return new
        newton = dense_step(now, self.jacobian) if self.dense else now.newton_step()
        new = None if newton is None else line_search(now, newton, self.tolerance)
        if new is None and not self.dense and equations.size + 2 * equations.w.size <= MAX_DENSE_JACOBIAN:
            new, self.dense = now, True  # eliminating the stiffest lines may leave the others no digits
        return new


def solve(equations, r, H, V, count, units="scaled", jacobian="analytic", globalisation="line-search", tolerance=1e-10):
    """Return (last iterate, converged) of Newton's method from positions r (n, 3) and forces H, V (e,).

    tolerance : of the force balance over the largest force, gaps counted by the force that they stand for; a gap that
    is no more than the rounding of the positions is closed.
    """
    system, method = MonolithicSystem(equations, units, count), _MonolithicNewton(jacobian, globalisation, tolerance)
    if equations.w.size <= MAX_LINES and not (method.dense or method.trust_region):
        unit = system.force_unit, system.length_unit
        small = solve_small(equations, r, H, V, count, unit, tolerance, MAX_ITERATIONS)
        if small is not None and small.balanced:
            return small, True
        r, H, V = (r, H, V) if small is None else (small.r, *small.elements.Q[:2])
    with np.errstate(all="ignore"):  # trial steps may overflow; their norm is then no decrease
        is_solved = lambda now: is_balanced(now, tolerance)
        return iterate(method.step, is_solved, system.evaluate(r, H, V), MAX_ITERATIONS)


def is_balanced(now, tolerance):
    """Return whether the force balance, and the forces that the gaps stand for, are small against the largest force."""
    eq, bound = now.system.equations, tolerance * largest_force(now.elements)
    if not np.abs(now.force[now.moving]).max(initial=0.0) <= bound:
        return False
    gap = np.abs(now.gap).max(axis=1)
    closed = gap <= now.geometry.rounding
    if np.count_nonzero(closed) == closed.size:
        return True
    if not (closed | (gap * eq.EA / eq.L <= bound)).all():  # the line stretched straight: it may be stiffer than now
        return False
    return bool((closed | (np.abs(now.blocks[0] @ now.gap[:, :, None]).max(axis=(1, 2)) <= bound)).all())


def line_search(now, step, tolerance):
    """Return the first acceptable iterate along a step, None where there is none."""

    def contracts(new, length):
        simplified = now.newton_step(new) if np.isfinite(new.norm) else None
        return simplified is not None and is_contraction(np.linalg.norm(simplified[0]), np.linalg.norm(step[0]), length)

    trial = lambda length: now.take_step(length, step)
    return halve_step(trial, now.norm, contracts, lambda new: is_balanced(new, tolerance))
