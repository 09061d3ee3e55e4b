"""The monolithic Newton iteration (3.3) of few lines in plain floats: there an array costs more than its numbers.

Only while every line hangs free, or lies on a smooth seabed from its anchor on, and no node rests. With anything else
``network_monolithic`` goes on from the last iterate.
"""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
from scipy.linalg.lapack import dgesv, dgetrs

from ..catenary.excursion import suspended
from ..catenary.regimes import hanging_force, hanging_length
from ..numerics.elementary import SCALAR
from .equations import ROUNDING, Elements, Geometry

FEWEST = 10  # lines up to which floats are faster
LEAST = 0.1  # a step leaves every H at least this part of itself
SHORTEST = 1e-8  # part of a step
FLOAT = SimpleNamespace(**vars(SCALAR) | {"arcsinh": math.asinh})  # the last bit need not be that of an array


class Point(NamedTuple):
    """An iterate z = [r of the free nodes, H and V of each line]; lengths in m, forces in N.

    Z : its scaled residual, norm : of it;  lines : direction (c, s), H/l, V_anchor, C11, C12, C22 of each
    unbalanced, largest, gap_force : forces, N; the last is what gaps of more than rounding stand for
    """

    z: list
    Z: list
    norm: float
    lines: list
    unbalanced: float
    largest: float
    gap_force: float


def _law(line, H, V, reach, rise, clearance):
    """``suspended`` of a line; None where it is slack, weightless, or lies otherwise than smooth from its anchor on."""
    w, EA, L, weight, softness, rests, friction, *_ = line
    touching = False
    if rests:
        over = rise + clearance
        if over <= 0 or L - hanging_length(FLOAT, over, softness) - hanging_length(FLOAT, clearance, softness) >= reach:
            return None
        lift = weight * hanging_force(FLOAT, H / weight, clearance / L, weight / EA) if clearance > 0 else 0.0
        touching = V >= 0 and V + lift < weight
    if not (H > 0 and w != 0) or (touching and (clearance > 0 or friction > 0)):
        return None
    return suspended(FLOAT, H, V, w, EA, L, weight, touching)


class Few:
    """The equations of a small network from positions r (n, 3)."""

    def __init__(self, balance, r, units):
        b = balance
        self.force_unit, self.length_unit = units
        columns = b.w, b.EA, b.L, b.w * b.L, b.softness, b.rests, b.friction, 3 * b.anchor, 3 * b.fairlead
        self.lines = list(zip(*(column.tolist() for column in columns), strict=True))
        self.r, self.load, self.floor = r.ravel().tolist(), b.load.ravel().tolist(), b.floor
        self.place, self.free = b.dof.ravel().tolist(), np.flatnonzero(b.unknown).tolist()
        self.m = len(self.free)

    def at(self, z):
        """The Point at z; None where a line or a node is none of those that this module knows."""
        try:
            return self._at(z)
        except (ArithmeticError, ValueError):  # beyond what floats divide: arrays go on with inf and nan
            return None

    def _at(self, z):
        X, F, gaps, lines, m = self.r.copy(), self.load.copy(), [], [], self.m  # type: ignore[var-annotated]
        largest = gap_force = 0.0
        for k, value in zip(self.free, z, strict=False):
            X[k] = value
        size = max(map(abs, X))
        if any(X[k] <= self.floor for k in self.free[2::3]):
            return None
        for line, H, V in zip(self.lines, z[m::2], z[m + 1 :: 2], strict=True):
            EA, L, a, f = line[1], line[2], *line[-2:]
            x, y, rise, clearance = X[f] - X[a], X[f + 1] - X[a + 1], X[f + 2] - X[a + 2], X[a + 2] - self.floor
            reach, rounding = math.sqrt(x * x + y * y), ROUNDING * (size + L)
            law = _law(line, H, V, reach, rise, clearance) if reach > rounding else None
            if law is None:
                return None
            l, h, V_anchor, C11, C12, C22 = law
            c, s, gap_l, gap_h = x / reach, y / reach, l - reach, h - rise
            for end, pull, lift in ((a, H, V_anchor), (f, -H, -V)):
                F[end] += pull * c
                F[end + 1] += pull * s
                F[end + 2] += lift
            lines.append((c, s, H / reach, V_anchor, C11, C12, C22))
            gaps += gap_l, gap_h
            largest, gap = max(largest, H, abs(V), abs(V_anchor)), max(abs(gap_l), abs(gap_h))
            if gap > rounding:  # as the line is, and stretched straight
                dH, dV = C22 * gap_l - C12 * gap_h, C11 * gap_h - C12 * gap_l
                gap_force = max(gap_force, gap * EA / L, max(abs(dH), abs(dV)) / (C11 * C22 - C12 * C12))
        F = [F[k] for k in self.free]
        Z = [force / self.force_unit for force in F] + [gap / self.length_unit for gap in gaps]
        norm = math.hypot(*Z)
        return Point(z, Z, norm, lines, max(map(abs, F)), largest, gap_force) if math.isfinite(norm) else None

    def jacobian(self, point):
        """(3.7) scaled, rows of a symmetric matrix: [[-T, B], [B^T, C]] with the stiffness T across the lines, H/l."""
        m, softness = self.m, self.force_unit / self.length_unit
        J = [[0.0] * len(point.z) for _ in point.z]
        for p, (c, s, turn, _, C11, C12, C22), line in zip(
            range(m, len(point.z), 2), point.lines, self.lines, strict=True
        ):
            J[p][p], J[p][p + 1], J[p + 1][p], J[p + 1][p + 1] = (C * softness for C in (C11, C12, C12, C22))
            turn /= softness
            ends = [(self.place[end], sign) for end, sign in ((line[-2], 1.0), (line[-1], -1.0))]
            for i, sign in ends:
                if i < 0:
                    continue
                J[i][p] = J[p][i] = sign * c
                J[i + 1][p] = J[p][i + 1] = sign * s
                J[i + 2][p + 1] = J[p + 1][i + 2] = sign
                for j, other in ends:
                    if j >= 0:
                        T = turn * sign * other
                        J[i][j] -= T * s * s
                        J[i][j + 1] += T * c * s
                        J[i + 1][j] += T * c * s
                        J[i + 1][j + 1] -= T * c * c
        return J

    def after(self, point, length, step):
        """z after a part of a scaled step; no H below a part of itself."""
        m = self.m
        z = [a + length * self.length_unit * d for a, d in zip(point.z[:m], step, strict=False)]
        z += [a + length * self.force_unit * d for a, d in zip(point.z[m:], step[m:], strict=True)]
        z[m::2] = map(max, z[m::2], [LEAST * H for H in point.z[m::2]])
        return z


class Led(NamedTuple):
    """Positions r (n, 3) and elements that the iteration led to, and whether they are balanced."""

    r: np.ndarray
    elements: Elements
    balanced: bool


def lead(balance, r, H, V, count, units, tolerance, limit):
    """As far as this iteration leads, or None; steps and tests are those of ``network_monolithic.solve``."""
    few, point = Few(balance, r, units), None
    new = few.at([*r[balance.unknown].tolist(), *np.array([H, V]).T.ravel().tolist()])
    while new is not None:
        point, balanced = new, _balanced(new, tolerance)
        count.function_evaluations += 1
        if balanced or limit == 0:
            break
        lu, pivots, step, singular = dgesv(few.jacobian(point), [-value for value in point.Z])
        new = None if singular else _line_search(few, point, step.tolist(), (lu, pivots), count, tolerance)
        count.iterations += new is not None
        count.operations += 2 / 3 * few.m**3
        limit -= 1
    if point is None:
        return None
    r = r.copy()
    r[balance.unknown], H, V = point.z[: few.m], point.z[few.m :: 2], point.z[few.m + 1 :: 2]
    return Led(r, Elements(Geometry(balance, r), np.array([H, V, H, [line[3] for line in point.lines]])), balanced)


def _balanced(point, tolerance):
    return max(point.unbalanced, point.gap_force) <= tolerance * point.largest


def _line_search(few, point, step, factors, count, tolerance):
    length = 1.0
    while length > SHORTEST:
        new = few.at(few.after(point, length, step))
        if new is None:
            return None
        if new.norm <= (1 - 1e-4 * length) * point.norm or _balanced(new, tolerance):
            return new
        simplified, _ = dgetrs(*factors, [-value for value in new.Z])
        if math.hypot(*simplified[: few.m].tolist()) <= (1 - length / 4) * math.hypot(*step[: few.m]):
            return new
        count.function_evaluations += 1
        length /= 2
    return None
