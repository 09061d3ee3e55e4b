"""Nested solution of a network: exact spans inside, Newton's method on the force balance outside.

Without friction the potential energy of a network is a convex function of the node positions (tension-only cables,
gravity, a flat seabed), so a regularised Newton step with a line search on the slope of the energy converges from
anywhere. ``start`` makes it fast from no guess.
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy.sparse as sparse
from scipy.linalg.lapack import dgesv
from scipy.sparse.linalg import splu

from ..numerics.newton import iterate
from .equations import Elements, NetworkEquations

EPS = np.finfo(float).eps
MAX_ITERATIONS = 150
STALLS = 3  # iterations without halving the smallest unbalanced force after which it counts as rounding
MAX_DAMPING = 1e16  # of the soft stiffness


@dataclass
class Count:
    """Work done: outer iterations, residuals, span iterations, operations of factorizations, (2/3) n^3 each, (5.6)."""

    iterations: int = 0
    function_evaluations: int = 0
    inner_iterations: int = 0
    operations: float = 0.0


class Balance(NamedTuple):
    """Positions r (n, 3), m, their elements, unbalanced force (n, 3), N, and moving coordinates (n, 3) bool."""

    r: np.ndarray
    elements: Elements
    force: np.ndarray
    moving: np.ndarray


def largest_force(elements):
    """Return the largest force of the elements, N, which residuals are measured by; reactions may be far larger."""
    return float(np.abs(elements.Q).max())


def rounding_floor(equations):
    """Return the unbalanced force that rounding the positions to eps causes, N."""
    return 4 * EPS * float(np.max(equations.EA / equations.L)) * (np.abs(equations.position).max() + equations.L.max())


class _RegularisedNewton:
    """Steps and stopping rule of ``solve_regularised``."""

    def __init__(self, equations, bound, count, rounding):
        self.equations, self.bound, self.count, self.rounding = equations, bound, count, rounding
        self.damping, self.smallest, self.stalled = 1e-2, np.inf, 0

    def is_solved(self, now):
        """Return whether the largest unbalanced force is small enough, or below rounding and no longer falling."""
        worst = np.abs(now.force[now.moving]).max(initial=0.0)
        self.smallest, self.stalled = min(self.smallest, worst), 0 if worst < self.smallest / 2 else self.stalled + 1
        return worst <= self.bound(now.elements) or (worst <= self.rounding and self.stalled >= STALLS)

    def step(self, now):
        """Return the next Balance, None where no damping leads to one."""
        self.count.iterations += 1
        tangent = tangent_of(self.equations, now.elements, now.moving)
        while True:
            shift = self.damping * self.equations.soft_stiffness
            step = motion_by(tangent, shift, now.force, now.moving, self.count)
            if step is not None:
                length, new = _search_along(self.equations, now, step, self.count)
                if new is not None:
                    self.damping = max(self.damping * (0.1 if length == 1.0 else 3.0), 1e-14)
                    return new
            self.damping *= 10
            if self.damping > MAX_DAMPING:
                return None


def solve_regularised(equations, r, bound, count, limit, rounding=0.0):
    """Return the positions r (n, 3) that regularised Newton steps on the force balance reach from positions r.

    bound : function of the elements, N; a force below ``rounding`` (N) that no longer falls is accepted too.
    """
    method = _RegularisedNewton(equations, bound, count, rounding)
    now, _ = iterate(method.step, method.is_solved, evaluate_balance(equations, r, count), limit)
    return now.r


def solve_nested(equations, r, jacobian, tolerance, count):
    """Return positions from r (n, 3), m, on, balanced to ``tolerance`` times the largest force if that is reached.

    jacobian : "analytic" or "finite-difference"
    """
    system = equations if jacobian == "analytic" else DifferenceTangent(equations, count)
    bound = lambda elements: tolerance * largest_force(elements)
    return solve_regularised(system, r, bound, count, MAX_ITERATIONS, rounding_floor(equations))


class DifferenceTangent(NetworkEquations):
    """The equations with a tangent from forward differences: every unknown moved in turn, all spans solved again."""

    STEP = 1e-7  # of the mean length, about the square root of eps

    def __init__(self, equations, count):
        vars(self).update(vars(equations))
        self.count = count

    def tangent(self, elements):
        """Return NetworkEquations.tangent, dense, one column a coordinate."""
        r = elements.geometry.r
        step = self.STEP * float(self.L.mean())
        free, columns = self.free, []
        base = self.unbalanced_force(elements)[free].ravel()
        for node in np.flatnonzero(free):
            for axis in range(3):
                shifted = r.copy()
                shifted[node, axis] += step
                force = evaluate_balance(self, shifted, self.count).force
                columns.append((base - force[free].ravel()) / step)
        return np.column_stack(columns)


def coupled_stiffness(equations, r, resting):
    """Return the stiffness (3c, 3c) of the coupled nodes, N/m, the free nodes following: K_cc - K_cf K_ff^-1 K_fc.

    resting : (n,) bool, free nodes whose height the seabed fixes
    """
    every = copy(equations)
    every.build_sparsity(equations.free | equations.coupled)
    K = every.tangent(equations.solve_elements(r))
    coupled, moving = every.dof[equations.coupled].ravel(), equations.free[:, None] & np.array([True, True, True])
    moving[resting, 2] = False
    free = every.dof[moving]
    if coupled.size == 0 or free.size == 0:
        return to_dense(K[coupled][:, coupled])
    columns = to_dense(K[free][:, coupled])
    shift = 1e-12 * np.abs(K.diagonal()).max()  # keeps slack parts in place, whose position is not determined
    motion = np.column_stack([solve_sparse(K[free][:, free], shift, column, Count()) for column in columns.T])
    return to_dense(K[coupled][:, coupled]) - to_dense(K[coupled][:, free]) @ motion


def to_dense(matrix):
    """Return a dense or sparse matrix as an array."""
    return matrix if isinstance(matrix, np.ndarray) else matrix.toarray()


def evaluate_balance(equations, r, count):
    """Return the Balance at r (n, 3), counted."""
    elements = equations.solve_elements(r)
    count.function_evaluations += 1
    count.inner_iterations += elements.inner_iterations
    force = equations.unbalanced_force(elements)
    return Balance(r, elements, force, equations.moving_coordinates(r, force))


def _search_along(equations, now, step, count):
    """Return (length, Balance) along a step, cut at the seabed; (0, None) where there is none.

    Accepted where the energy still falls, or its slope is down to nine tenths: the energy is convex, so that its slope
    tells more than a residual norm.
    """
    length, slope = 1.0, float((now.force * step)[now.moving].sum())
    for _ in range(12):
        r = equations.lift_to_seabed(now.r + length * step)
        new = evaluate_balance(equations, r, count)
        new_slope = float((new.force * (r - now.r)).sum()) / length
        if np.isfinite(new_slope) and (new_slope > 0 or -new_slope <= 0.9 * slope):
            return length, new
        length *= min(max(slope / (slope - new_slope), 0.1), 0.7) if np.isfinite(new_slope) else 0.3
    return 0.0, None


def tangent_of(equations, elements, moving):
    """Return the tangent of the ``moving`` coordinates (n, 3) alone."""
    unknown, tangent = equations.dof[moving], equations.tangent(elements)
    return tangent if unknown.size == equations.size else tangent[unknown][:, unknown]


def motion_by(tangent, shift, force, moving, count):
    """Return the motion (n, 3) of the nodes by which the tangent takes a ``force`` (n, 3), None if it is singular."""
    change = solve_sparse(tangent, shift, force[moving], count)
    if change is None:
        return None
    dr = np.zeros(force.shape)
    dr[moving] = change
    return dr


def solve_sparse(matrix, shift, right, count):
    """Return (matrix + shift I)^-1 right, by LAPACK or by SuperLU with a symmetric ordering; None if singular."""
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
