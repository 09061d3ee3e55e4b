"""The monolithic Newton iteration (3.3) of small networks in plain floats, where NumPy's overhead dominates.

It holds while every line hangs free, or lies on a smooth seabed from its anchor on, and no node rests. With anything
else ``monolithic`` goes on from the last iterate.
"""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
from scipy.linalg.lapack import dgesv, dgetrs

from ..catenary.excursion import suspended
from ..catenary.regimes import hanging_force_in_newtons, hanging_length, slack_length, touches_seabed
from ..numerics.elementary import SCALAR
from ..numerics.newton import halve_step, is_contraction, iterate
from .equations import ROUNDING, Elements, Geometry

MAX_LINES = 10  # lines up to which floats are faster
MIN_H_FRACTION = 0.1  # part of every H that a step leaves at least
FLOAT = SimpleNamespace(**vars(SCALAR) | {"arcsinh": math.asinh})  # faster; its last bit may differ from an array's


class Point(NamedTuple):
    """An iterate z = [r of the free nodes, H and V of each line]; lengths in m, forces in N.

    Z : the scaled residual, norm : its Euclidean norm;  lines : direction (c, s), H/l, V_anchor, C11, C12, C22 of each
    unbalanced, largest, gap_force : largest unbalanced force, largest force, and the largest force that a gap of more
        than rounding stands for, N
    """

    z: list
    Z: list
    norm: float
    lines: list
    unbalanced: float
    largest: float
    gap_force: float


def _excursion(line, H, V, reach, rise, clearance):
    """Return ``suspended`` of a line, None where it is slack, weightless, or lies with friction or a raised anchor."""
    w, EA, L, weight, weight_strain, can_rest, friction, *_ = line
    touching = False
    if can_rest:
        height = rise + clearance
        hanging = hanging_length(FLOAT, height, weight_strain), hanging_length(FLOAT, clearance, weight_strain)
        if height <= 0 or slack_length(L, reach, *hanging) >= 0:
            return None
        lift = V + hanging_force_in_newtons(FLOAT, H, clearance, w, EA, L) if clearance > 0 else V
        touching = touches_seabed(V, lift, weight)
    if not (H > 0 and w != 0) or (touching and (clearance > 0 or friction > 0)):
        return None
    return suspended(FLOAT, H, V, w, EA, L, weight, touching)


class ScalarEquations:
    """The equations of a small network around positions r (n, 3), m.

    units : of force, N, and length, m;  count : where each point that is evaluated is counted
    """

    def __init__(self, equations, r, units, count):
        eq, self.count = equations, count
        self.force_unit, self.length_unit = units
        constants = eq.w, eq.EA, eq.L, eq.w * eq.L, eq.weight_strain, eq.can_rest, eq.friction
        columns = *constants, 3 * eq.anchor, 3 * eq.fairlead
        self.lines = list(zip(*(column.tolist() for column in columns), strict=True))
        self.r, self.load, self.seabed = r.ravel().tolist(), eq.load.ravel().tolist(), eq.seabed
        dof, self.free = eq.dof.ravel().tolist(), np.flatnonzero(eq.unknown).tolist()
        self.heights, self.m = self.free[2::3], len(self.free)
        self.ends = [((dof[line[-2]], 1.0), (dof[line[-1]], -1.0)) for line in self.lines]

    def evaluate(self, z):
        """Return the Point at z, None where a line or a node is none of those that this module knows."""
        try:
            point = self._evaluate(z)
        except (ArithmeticError, ValueError):  # a division by zero or an overflow: arrays go on with inf and nan
            return None
        self.count.function_evaluations += point is not None
        return point

    def _evaluate(self, z):
        X, F, gaps, lines, m = self.r.copy(), self.load.copy(), [], [], self.m  # type: ignore[var-annotated]
        largest = gap_force = 0.0
        for k, value in zip(self.free, z, strict=False):
            X[k] = value
        extent = max(map(abs, X))
        for k in self.heights:
            if X[k] <= self.seabed:
                return None
        for line, H, V in zip(self.lines, z[m::2], z[m + 1 :: 2], strict=True):
            EA, L, a, f = line[1], line[2], *line[-2:]
            x, y, rise, clearance = X[f] - X[a], X[f + 1] - X[a + 1], X[f + 2] - X[a + 2], X[a + 2] - self.seabed
            reach, rounding = math.sqrt(x * x + y * y), ROUNDING * (extent + L)
            end = _excursion(line, H, V, reach, rise, clearance) if reach > rounding else None
            if end is None:
                return None
            l, h, V_anchor, C11, C12, C22 = end
            c, s, gap_l, gap_h = x / reach, y / reach, l - reach, h - rise
            for node, pull, lift in ((a, H, V_anchor), (f, -H, -V)):
                F[node] += pull * c
                F[node + 1] += pull * s
                F[node + 2] += lift
            lines.append((c, s, H / reach, V_anchor, C11, C12, C22))
            gaps += gap_l, gap_h
            largest, gap = max(largest, H, abs(V), abs(V_anchor)), max(abs(gap_l), abs(gap_h))
            if gap > rounding:  # the stiffer of the line as it is and stretched straight
                dH, dV = C22 * gap_l - C12 * gap_h, C11 * gap_h - C12 * gap_l
                gap_force = max(gap_force, gap * EA / L, max(abs(dH), abs(dV)) / (C11 * C22 - C12 * C12))
        F = [F[k] for k in self.free]
        Z = [force / self.force_unit for force in F] + [gap / self.length_unit for gap in gaps]
        norm = math.hypot(*Z)
        return Point(z, Z, norm, lines, max(map(abs, F)), largest, gap_force) if math.isfinite(norm) else None

    def jacobian(self, point):
        """Return the rows of (3.7), scaled and symmetric: [[-T, B], [B^T, C]], T = H/l the stiffness across a line."""
        m, unit = self.m, self.force_unit / self.length_unit
        J = [[0.0] * len(point.z) for _ in point.z]
        columns = range(m, len(point.z), 2)  # of H; that of V follows
        for p, (c, s, across, _, C11, C12, C22), ends in zip(columns, point.lines, self.ends, strict=True):
            J[p][p], J[p + 1][p + 1] = C11 * unit, C22 * unit
            J[p][p + 1] = J[p + 1][p] = C12 * unit
            across /= unit
            for i, sign in ends:
                if i < 0:
                    continue
                J[i][p] = J[p][i] = sign * c
                J[i + 1][p] = J[p][i + 1] = sign * s
                J[i + 2][p + 1] = J[p + 1][i + 2] = sign
                for j, other in ends:
                    if j >= 0:
                        T = across * sign * other
                        J[i][j] -= T * s * s
                        J[i][j + 1] += T * c * s
                        J[i + 1][j] += T * c * s
                        J[i + 1][j + 1] -= T * c * c
        return J

    def take_step(self, point, length, step):
        """Return z after a part of a scaled step; no H falls below a part of itself."""
        m = self.m
        z = [a + length * self.length_unit * d for a, d in zip(point.z[:m], step, strict=False)]
        z += [a + length * self.force_unit * d for a, d in zip(point.z[m:], step[m:], strict=True)]
        z[m::2] = map(max, z[m::2], [MIN_H_FRACTION * H for H in point.z[m::2]])
        return z


class SmallResult(NamedTuple):
    """Positions r (n, 3) and elements of the last iterate, and whether they are balanced."""

    r: np.ndarray
    elements: Elements
    balanced: bool


def solve_small(equations, r, H, V, count, units, tolerance, limit):
    """Return the SmallResult of the iteration from r (n, 3), H and V (e,), None where it does not hold there.

    Steps and tests are those of ``monolithic.solve``.
    """
    system = ScalarEquations(equations, r, units, count)
    m, solved = system.m, lambda point: is_balanced(point, tolerance)

    def step(point):
        count.operations += 2 / 3 * m**3
        lu, pivots, newton, singular = dgesv(system.jacobian(point), [-value for value in point.Z])
        if singular:
            return None
        newton = newton.tolist()

        def contracts(new, length):
            simplified, _ = dgetrs(lu, pivots, [-value for value in new.Z])
            return is_contraction(math.hypot(*simplified[:m].tolist()), math.hypot(*newton[:m]), length)

        trial = lambda length: system.evaluate(system.take_step(point, length, newton))
        new = halve_step(trial, point.norm, contracts, solved)
        count.iterations += new is not None
        return new

    point = system.evaluate([*r[equations.unknown].tolist(), *np.array([H, V]).T.ravel().tolist()])
    if point is None:
        return None
    point, balanced = iterate(step, solved, point, limit)
    r = r.copy()
    r[equations.unknown], H, V = point.z[:m], point.z[m::2], point.z[m + 1 :: 2]
    forces = np.array([H, V, H, [line[3] for line in point.lines]])
    return SmallResult(r, Elements(Geometry(equations, r), forces), balanced)


def is_balanced(point, tolerance):
    """Return whether unbalanced forces, and the forces that gaps stand for, are small against the largest force."""
    return max(point.unbalanced, point.gap_force) <= tolerance * point.largest
