"""Nested solution of a network: exact spans inside, Newton's method on the force balance outside.

Without friction the potential energy of a network is a convex function of the node positions (tension-only cables,
gravity, a flat floor), so a regularised Newton step with a line search on the slope of the energy converges from
anywhere. What makes it fast from no guess is a continuation in stiffness: soft lines and a soft floor first, which are
nearly linear, then harder ones from the result before.
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sparse
from scipy.linalg.lapack import dgesv
from scipy.sparse.linalg import splu

EPS = np.finfo(float).eps
SHORT = 60  # elements up to which a network is led by contact of its lines
HARDER = 0.1  # ratio of softness from stage to stage: strain under the total load, sinking over the total length
SOFTEST, HARDEST = 1.0, 1e-3  # first stage; last stage, over the number of elements, or at the strain of the lines
LEAST_SOFT = 1e-10  # strains below it are no longer told from none
STAGE_TOLERANCE = 1e-2  # of the heaviest node load: the next stage only needs a start
MAX_ITERATIONS = 150
STALLS = 3  # iterations without halving the least force that show its rounding


@dataclass
class Count:
    """Work done: outer iterations, residuals, span iterations, factorization operations (2/3) n^3 as in (5.6)."""

    iterations: int = 0
    function_evaluations: int = 0
    inner_iterations: int = 0
    operations: float = 0.0


class SoftFloor:
    """A stage of the continuation: lines no stiffer than load/softness, free nodes that sink into a floor of springs.

    With ``contact`` the lines rest on the rigid floor, where a sunk node holds their ends; without, they pass through.
    """

    def __init__(self, balance, softness, contact):
        self.balance, self.contact = copy(balance), contact
        if not contact:
            self.balance.rests = np.zeros_like(balance.rests)
        weight = np.abs(balance.w) * balance.L
        total = weight.sum() + np.abs(balance.load).sum()
        if total > 0:
            self.balance.made_of(1 / (1 / balance.EA + softness / total))
        node = np.abs(balance.load).sum(axis=1)
        np.add.at(node, balance.anchor, weight / 2)
        np.add.at(node, balance.fairlead, weight / 2)
        self.load = node[balance.free].max(initial=0.0)
        self.spring = np.where(balance.free, node, 0.0) / (softness * balance.L.sum())
        self.dof, self.size, self.soft_stiffness = balance.dof, balance.size, self.balance.soft_stiffness

    def spans(self, r):
        """The softened elements between nodes at r (n, 3), and how far each node has sunk."""
        held = self.balance.on_floor(r.copy())
        elements = self.balance.spans(held if self.contact else r)
        elements.sunk = held[:, 2] - r[:, 2]
        return elements

    def moving(self, r, force):
        """Every unknown coordinate: nodes sink in."""
        return self.balance.unknown

    def on_floor(self, r):
        """Nodes stay where they sank."""
        return r

    def unbalanced(self, elements):
        """As Balance.unbalanced, with the springs of the floor."""
        force = self.balance.unbalanced(elements)
        force[:, 2] += self.spring * elements.sunk
        return force

    def tangent(self, elements):
        """As Balance.tangent, with the springs of the floor; what a sunk node holds does not move with it."""
        below = np.flatnonzero(elements.sunk > 0)
        above, springs = np.ones(self.size), np.zeros(self.size)
        springs[self.dof[below, 2]] = self.spring[below]
        if self.contact:
            above[self.dof[below, 2]] = 0.0
        tangent = self.balance.tangent(elements)
        if isinstance(tangent, np.ndarray):
            return tangent * above * above[:, None] + np.diag(springs)
        above = sparse.diags(above, format="csc")
        return above @ tangent @ above + sparse.diags(springs, format="csc")


def force_density(balance):
    """Positions of a net of linear springs of density 1/L under the same loads: one sparse solve, no guess needed."""
    r, free = balance.position.copy(), np.flatnonzero(balance.free)
    if free.size == 0:
        return r
    a, f, q = balance.anchor, balance.fairlead, 1 / balance.L
    n = balance.free.size
    laplacian = sparse.coo_matrix(
        (np.concatenate([q, q, -q, -q]), (np.concatenate([a, f, a, f]), np.concatenate([a, f, f, a]))), shape=(n, n)
    ).tocsr()
    load = balance.load.copy()
    weight = balance.w * balance.L / 2
    np.subtract.at(load[:, 2], a, weight)
    np.subtract.at(load[:, 2], f, weight)
    held = np.flatnonzero(~balance.free)
    scale = np.abs(load).sum() or 1.0
    right = load[free] / scale - laplacian[free][:, held] @ r[held]
    r[free] = splu(laplacian[free][:, free].tocsc()).solve(right)
    return r


def robust_start(balance, count, contact):
    """Positions near equilibrium from no guess.

    Lines that rest on the floor (``contact``) lead a network with much slack well; a long chain of short elements is
    led better by its nodes alone.
    """
    r, softness = force_density(balance), SOFTEST
    total = (np.abs(balance.w) * balance.L).sum() + np.abs(balance.load).sum()
    hardest = min(HARDEST / balance.w.size, max(HARDER * total / balance.EA.max(), LEAST_SOFT))
    while softness > hardest:
        stage = SoftFloor(balance, softness, contact)
        r, _, _ = newton(stage, r, lambda _, stage=stage: STAGE_TOLERANCE * stage.load, count, 60)
        softness *= HARDER
    return balance.on_floor(r)


def largest_force(elements):
    """The force that residuals are measured by, N: of the elements, for what a support carries says nothing of them."""
    return float(np.abs(elements.Q).max())


def attainable(balance):
    """Unbalanced force that rounding the positions to eps causes, N."""
    return 4 * EPS * float(np.max(balance.EA / balance.L)) * (np.abs(balance.position).max() + balance.L.max())


def newton(balance, r, bound, count, limit=MAX_ITERATIONS, rounding=0.0):
    """Regularised Newton on the force balance; returns (r, largest unbalanced force of the free nodes, converged).

    bound : function of the elements, N; a force below ``rounding`` (N) that no longer falls is accepted too.
    """
    damping, least, stalled = 1e-2, np.inf, 0
    elements, force = evaluate(balance, r, count)
    for _ in range(limit):
        moving = balance.moving(r, force)
        worst = np.abs(force[moving]).max(initial=0.0)
        least, stalled = min(least, worst), 0 if worst < least / 2 else stalled + 1
        if worst <= bound(elements) or (worst <= rounding and stalled >= STALLS):
            return r, worst, True
        count.iterations += 1
        unknown = balance.dof[moving]
        tangent = balance.tangent(elements)
        tangent = tangent if unknown.size == balance.size else tangent[unknown][:, unknown]
        while True:
            found, step = None, np.zeros_like(r)
            change = solve_sparse(tangent, damping * balance.soft_stiffness, force[moving], count)
            if change is not None:
                step[moving] = change
                found = _search(balance, r, step, float((force * step)[moving].sum()), count)
            if found is not None:
                break
            damping *= 10
            if damping > 1e16:
                return r, worst, False
        full, r, elements, force = found
        damping = max(damping * (0.1 if full else 3.0), 1e-14)
    return r, worst, False


def nested(balance, r, jacobian, tolerance, count):
    """Equilibrium from positions r (n, 3), balanced to ``tolerance`` times the largest force: (r, converged)."""
    equations = balance if jacobian == "analytic" else Differences(balance, count)
    rounding = attainable(balance)

    def bound(elements):
        return tolerance * largest_force(elements)

    r, _, converged = newton(equations, r, bound, count, rounding=rounding)
    return r, converged


class Differences:
    """The balance with its tangent from forward differences: every unknown moved in turn, all spans solved again."""

    STEP = 1e-7  # of the mean length, about the square root of eps

    def __init__(self, balance, count):
        self.balance, self.count = balance, count
        self.dof, self.size, self.soft_stiffness = balance.dof, balance.size, balance.soft_stiffness
        self.spans, self.unbalanced = balance.spans, balance.unbalanced
        self.moving, self.on_floor = balance.moving, balance.on_floor

    def tangent(self, elements):
        """As Balance.tangent, one column a coordinate."""
        r = elements.geometry.r
        step = self.STEP * float(self.balance.L.mean())
        free, columns = self.balance.free, []
        base = self.unbalanced(elements)[free].ravel()
        for node in np.flatnonzero(free):
            for axis in range(3):
                moved = r.copy()
                moved[node, axis] += step
                _, force = evaluate(self.balance, moved, self.count)
                columns.append((base - force[free].ravel()) / step)
        return np.column_stack(columns)


def coupled_stiffness(balance, r, resting):
    """(3c, 3c) stiffness of the coupled nodes, the free nodes following: K_cc - K_cf K_ff^-1 K_fc."""
    every = copy(balance)
    every.pattern(balance.free | balance.coupled)
    K = every.tangent(balance.spans(r))
    held, own = every.dof[balance.coupled].ravel(), balance.free[:, None] & np.array([True, True, True])
    own[resting, 2] = False
    follow = every.dof[own]
    if held.size == 0 or follow.size == 0:
        return dense(K[held][:, held])
    columns = dense(K[follow][:, held])
    slack = 1e-12 * np.abs(K.diagonal()).max()  # a slack part follows nowhere in particular: keep it in place
    inner = np.column_stack([solve_sparse(K[follow][:, follow], slack, column, Count()) for column in columns.T])
    return dense(K[held][:, held]) - dense(K[held][:, follow]) @ inner


def dense(matrix):
    """An array whatever the storage."""
    return matrix if isinstance(matrix, np.ndarray) else matrix.toarray()


def evaluate(balance, r, count):
    """Elements and unbalanced force at r, counted."""
    elements = balance.spans(r)
    count.function_evaluations += 1
    count.inner_iterations += elements.inner_iterations
    return elements, balance.unbalanced(elements)


def _search(balance, r, step, slope, count):
    """Along the step (cut at the floor): accept while the energy still falls, or its slope is down to nine tenths."""
    length = 1.0
    for _ in range(12):
        trial = balance.on_floor(r + length * step)
        elements, force = evaluate(balance, trial, count)
        new = float((force * (trial - r)).sum()) / length
        if np.isfinite(new) and (new > 0 or -new <= 0.9 * slope):
            return length == 1.0, trial, elements, force
        length *= min(max(slope / (slope - new), 0.1), 0.7) if np.isfinite(new) else 0.3
    return None


def solve_sparse(matrix, shift, right, count):
    """(matrix + shift I)^-1 right: LAPACK if dense, SuperLU with a symmetric ordering if sparse; None if singular."""
    n = right.size
    count.operations += 2 / 3 * n**3
    try:
        if isinstance(matrix, np.ndarray):
            shifted = matrix.copy()
            shifted.ravel()[:: n + 1] += shift
            *_, solution, failed = dgesv(shifted, right, overwrite_a=True)
            return None if failed else solution
        shifted = (matrix + shift * sparse.identity(n, format="csc")).tocsc()
        options = {"SymmetricMode": True}
        return splu(shifted, permc_spec="MMD_AT_PLUS_A", options=options, diag_pivot_thresh=0.0).solve(right)
    except RuntimeError:  # singular
        return None
