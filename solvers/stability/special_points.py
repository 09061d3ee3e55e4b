"""Special points of a response curve: folds, branch points, period doublings and Neimark-Sacker bifurcations.

A fold is where the tangent has no part in the parameter. The others are where a multiplier passes the unit circle: the
k-th largest, whichever it is, is a continuous function along the curve, and its angle on the circle is the kind. Branch
points and period doublings are then located as zeros of a bordered test function 1 / (c . A^-1 b) (W. Govaerts,
Numerical Methods for Bifurcations of Dynamical Equilibria, 2000, 4.1) of the balance itself: A is its Jacobian with the
parameter and the tangent, or that of the odd harmonics of twice the period. Only folds and Neimark-Sacker bifurcations
rest on what the multipliers' own time steps leave.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from .continuation import CorrectionError
from .family import double_period

FOLD, BRANCH_POINT = "fold", "branch point"
PERIOD_DOUBLING, NEIMARK_SACKER = "period doubling", "Neimark-Sacker"

FOLD_STEP = 1e-6  # of the step over a fold, to which its place is found: its square is left in the parameter
PLACE = 1e-9  # of the step, to which other special points are located
NOISE = 1e-6  # a multiplier that stays so near the circle passes it by rounding: of motions without damping
REAL = 1e-3  # rad from 1 or -1, within which a multiplier on the circle is taken for real
LEAST_SIZE = 1e-300  # of a multiplier whose logarithm is taken
FIRST_SECANT = 1e-3  # of the step, of the secant method
MAX_SECANT = 20
BEYOND = 0.1  # of the step, how far beyond it the secant method may look
VANISHED = 1e-4  # of a test function at the end of its step, above which it did not vanish


class SpecialPoint(NamedTuple):
    """A special point: its kind, value of the parameter, coefficients z (n_f, N, C), and number of the point before it.

    kind: "fold", "branch point", "period doubling" or "Neimark-Sacker". multipliers: there, largest first, or None.
    """

    kind: str
    value: float
    z: np.ndarray
    multipliers: np.ndarray | None
    after: int


class CurveSegment:
    """The curve between a point and another one, s along its tangent; each s is corrected once.

    multipliers: function of a Point, or None.
    """

    def __init__(self, tracer, point, other, multipliers=None):
        self.tracer, self.length = tracer, tracer.distance(point, other)
        self.points, self._multipliers, self._sizes = {0.0: point, self.length: other}, multipliers, {}

    def at(self, s):
        """Return the point at s."""
        if s not in self.points:
            self.points[s] = self.tracer.advance(self.points[0.0], s)
        return self.points[s]

    def multipliers_at(self, s) -> np.ndarray:
        """Return the multipliers at s, largest first."""
        if s not in self._sizes:
            self._sizes[s] = self._multipliers(self.at(s))
        return self._sizes[s]

    def set_multipliers(self, first, last):
        """Take multipliers at both ends that are known."""
        self._sizes |= {0.0: first, self.length: last}

    def growth_at(self, s, k) -> float:
        """Return the logarithm of the size of the k-th largest multiplier at s."""
        sizes = abs(self.multipliers_at(s))
        return float(np.log(max(sizes[k] if k < sizes.size else 0.0, LEAST_SIZE)))


def locate_special_points(segment, has_multipliers) -> list[tuple]:
    """Return (kind, s) of the special points of a CurveSegment in their order. Raises CorrectionError."""
    located = []
    if segment.at(0.0).u * segment.at(segment.length).u < 0:
        located.append((FOLD, _locate_fold(segment)))
    if has_multipliers:
        located += _locate_crossings(segment)
    return sorted(located, key=lambda each: each[1])


def _locate_fold(segment):
    brentq(lambda s: segment.at(s).u, 0.0, segment.length, xtol=FOLD_STEP * segment.length, rtol=FOLD_STEP)
    return min(segment.points, key=lambda s: abs(segment.points[s].u))


def _locate_crossings(segment):
    """Return (kind, s) where multipliers pass the unit circle, those of folds left out."""
    ends, located = (0.0, segment.length), []
    outside = [int((abs(segment.multipliers_at(s)) > 1).sum()) for s in ends]
    k = min(outside)
    while k < max(outside):
        growth = [segment.growth_at(s, k) for s in ends]
        if max(map(abs, growth)) <= NOISE or growth[0] * growth[1] > 0:
            k += 1
            continue
        s = brentq(segment.growth_at, *ends, args=(k,), xtol=PLACE * segment.length, rtol=PLACE)
        angle = abs(np.angle(segment.multipliers_at(s)[k]))
        kind, test = _kind(segment, angle)
        if test is not None:
            refined = _refine(test, s, segment.length)
            s = s if refined is None and kind == PERIOD_DOUBLING else refined
        if s is not None:
            located.append((kind, s))
        k += 2 if kind == NEIMARK_SACKER else 1
    return located


def _kind(segment, angle):
    """Return the kind of a multiplier on the unit circle with an angle, and its bordered test function or None."""
    if angle <= REAL:
        return BRANCH_POINT, BranchTest(segment.tracer, segment.at)
    if angle >= np.pi - REAL:
        return PERIOD_DOUBLING, DoublingTest(segment.tracer, segment.at)
    return NEIMARK_SACKER, None


def _refine(test, s, length):
    """Return the zero near s of a test function by the secant method, None where it has none in the segment."""
    at_end, other = abs(test(length)), s + FIRST_SECANT * (length if s < length / 2 else -length)
    before, value = test(other), test(s)
    for _ in range(MAX_SECANT):
        if value == 0 or abs(other - s) <= PLACE * abs(length):
            break
        if value == before:
            return None
        other, s, before = s, s - value * (s - other) / (value - before), value
        if not -BEYOND <= s / length <= 1 + BEYOND:
            return None
        value = test(s)
    return s if abs(value) <= VANISHED * max(at_end, abs(test(0.0))) else None


class BranchTest:
    """The bordered test function of a branch point: that of the Jacobian with the parameter and the tangent.

    at: function s -> Point. direction: the last A^-1 b, at a zero the null vector (dx, dp) of A.
    """

    def __init__(self, tracer, at):
        self.tracer, self.at, self.left, self.direction = tracer, at, None, None

    def __call__(self, s) -> float:
        """Return the test function at s, zero where A is singular."""
        try:
            point = self.at(s)
            F, solve = self.tracer.linearise(point.x, point.value, *self.tracer.plane(point.t, point.u))
        except CorrectionError as error:
            if "singular" in str(error):
                return 0.0
            raise
        dx, dp = solve(np.random.default_rng(7).normal(size=F.shape), 0.0)
        self.direction = dx, dp
        if self.left is None:
            self.left = self.tracer.plane(dx, dp)
        return 1 / float(np.vdot(self.left[0], dx) + self.left[1] * dp)


class DoublingTest:
    """The bordered test function of a period doubling: that of the odd harmonics of twice the period, as BranchTest."""

    def __init__(self, tracer, at):
        self.tracer, self.at, self.left, self.direction = tracer.doubled(), at, None, None
        self.unpack = tracer.unpack

    def __call__(self, s) -> float:
        """Return the test function at s, zero where the Jacobian of the odd harmonics is singular."""
        point = self.at(s)
        rows = self.tracer.family.rows(point.value)
        F, solve = rows.linearise(rows.pack(double_period(self.unpack(point.x))))
        if solve is None:
            return 0.0
        z = rows.unpack(solve(np.random.default_rng(7).normal(size=F.shape)))
        z[..., 0::4], z[..., 3::4] = 0.0, 0.0  # the mean and the harmonics of the period itself
        self.direction = rows.pack(z), 0.0
        if self.left is None:
            self.left = self.tracer.plane(*self.direction)[0]
        return 1 / float(np.vdot(self.left, self.direction[0]))
