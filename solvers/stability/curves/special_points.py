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
from scipy.interpolate import BarycentricInterpolator
from scipy.optimize import brentq

from .bordered import factorise_bordered
from .continuation import CorrectionError, Point
from .family import double_period

FOLD, BRANCH_POINT = "fold", "branch point"
PERIOD_DOUBLING, NEIMARK_SACKER = "period doubling", "Neimark-Sacker"
JUMP = "jump"

FOLD_STEP = 1e-6  # of the step over a fold, to which it is located: the square of that is its error in the parameter
LOCATION = 1e-9  # of the step, to which other special points are located
NOISE = 1e-6  # multipliers so near the circle are on it: those of free phases, and of motions without damping
REAL = 1e-3  # rad from 1 or -1, within which a multiplier on the circle is taken for real
WANTED = 0.1  # size of multipliers from which on all are known at a point: what a period damps to it decides nothing
LEAST_SIZE = 1e-300  # of a multiplier whose logarithm is taken
JUMPS = 0.3  # share of the change of a multiplier over a step that a 64th of it may have: 1/64, or 1/8 of a root
BISECTIONS = 6  # of a step in which a multiplier passes the circle, before its kind is determined
NEIGHBOURHOOD = 1.0  # of the last such part, beside it, beyond which the secant method does not go
MAX_SECANT = 20
RESOLVED = 0.05  # error of the points beside a special one, by their harmonics, up to which it is one of the motion
FOLD_MULTIPLIER = 0.25  # from one, of the nearest multiplier at a fold: that of a motion is one, blurred by the series
NODES = np.array([-3.0, -2.0, -1.0, 1.0, 2.0, 3.0])  # of the interpolation over a branch point, clear of it


class SpecialPoint(NamedTuple):
    """A special point: its kind, value of the parameter, coefficients z (n_f, N, C), and number of the point before it.

    kind: "fold", "branch point", "period doubling", "Neimark-Sacker", or "jump" where multipliers jump over the circle:
    a contact begins, a cell goes slack, or time steps are too few for such a kink. multipliers: there, largest first,
    or None. doubt: why the point may be one of the truncated series alone and not of the motion, or "".
    """

    kind: str
    value: float
    z: np.ndarray
    multipliers: np.ndarray | None
    after: int
    doubt: str = ""


def explain_doubt(kind, multipliers, error) -> str:
    """Return why a special point may be one of the truncated series alone, or "".

    At a fold of the motion a multiplier is one. Over slack cells a series of few harmonics rings and turns back where
    the motion goes on: its multipliers, which are those of the time steps, know nothing of such a fold.
    """
    if error > RESOLVED:
        return f"more harmonics would change the responses beside it by {error:.2g} of the largest"
    if kind == FOLD and multipliers is not None and abs(multipliers - 1).min(initial=np.inf) > FOLD_MULTIPLIER:
        return "no multiplier of the motion is near one there"
    return ""


class CurveSegment:
    """The curve between a point and another one, s along its tangent; each s is corrected once.

    multipliers: function of a Point, or None.
    """

    def __init__(self, tracer, point, other, multipliers=None):
        self.tracer, self.length = tracer, tracer.distance(point, other)
        if not self.length > 0:
            raise CorrectionError("the curve leads back on itself")
        self.points, self._multipliers, self._known = {0.0: point, self.length: other}, multipliers, {}
        self.on_circle = 0

    def at(self, s):
        """Return the point at s."""
        if s not in self.points:
            self.points[s] = self.tracer.advance(self.points[0.0], s)
        return self.points[s]

    def multipliers_at(self, s) -> np.ndarray:
        """Return the multipliers at s, largest first, without those that stay on the circle."""
        if s not in self._known:
            self._known[s] = self._multipliers(self.at(s))
        values = self._known[s]
        return np.delete(values, np.argsort(_distance(values), kind="stable")[: self.on_circle])

    def set_multipliers(self, first, last):
        """Take multipliers at both ends that are known; as many as lie on the circle at both stay there."""
        self._known |= {0.0: first, self.length: last}
        self.on_circle = min(int((_distance(values) <= NOISE).sum()) for values in (first, last))

    def growth_at(self, s, k) -> float:
        """Return the logarithm of the size of the k-th largest multiplier at s, or the least bound that is known."""
        sizes = abs(self.multipliers_at(s))
        return float(np.log(max(sizes[k] if k < sizes.size else sizes.min(initial=WANTED), LEAST_SIZE)))


def _distance(multipliers):
    """Return how far the sizes of multipliers are from one, as logarithms."""
    return abs(np.log(np.maximum(abs(multipliers), LEAST_SIZE)))


def locate_special_points(segment, has_multipliers) -> list[tuple]:
    """Return (kind, s, Point) of the special points of a CurveSegment in their order. Raises CorrectionError."""
    located = []
    if segment.at(0.0).u * segment.at(segment.length).u < 0:
        located.append(_locate_fold(segment))
    if has_multipliers:
        located += _locate_crossings(segment)
    return sorted(located, key=lambda each: each[1])


def _locate_fold(segment):
    brentq(lambda s: segment.at(s).u, 0.0, segment.length, xtol=FOLD_STEP * segment.length, rtol=FOLD_STEP)
    s = min(segment.points, key=lambda s: abs(segment.points[s].u))
    return FOLD, s, segment.at(s)


def _locate_crossings(segment):
    """Return (kind, s, Point) where multipliers pass the unit circle, those of folds left out."""
    located = []
    outside = [int((abs(segment.multipliers_at(s)) > 1 + NOISE).sum()) for s in (0.0, segment.length)]
    k = min(outside)
    while k < max(outside):
        growth = [segment.growth_at(s, k) - NOISE for s in (0.0, segment.length)]
        if growth[0] * growth[1] > 0:
            k += 1
            continue
        low, high = _bisect(segment, k, growth[0])
        beyond = max((low, high), key=lambda s: segment.growth_at(s, k))  # there a pair may have become real
        multiplier = segment.multipliers_at(beyond)[k]
        angle, is_pair = abs(np.angle(multiplier)), False
        if abs(segment.growth_at(high, k) - segment.growth_at(low, k)) > JUMPS * abs(growth[1] - growth[0]):
            is_pair = abs(multiplier.imag) > 0
            located.append((JUMP, high, segment.at(high)))
        elif angle <= REAL:
            located += _locate_branch_point(segment, (low + high) / 2)
        elif angle >= np.pi - REAL:
            located.append(_locate_doubling(segment, low, high, k))
        else:
            is_pair = True
            located.append(_locate_neimark_sacker(segment, low, high, k))
        k += 2 if is_pair else 1
    return located


def _bisect(segment, k, first):
    """Return the ends of a part of the segment in which the k-th multiplier passes the circle; first: its growth."""
    low, high = 0.0, segment.length
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        if (segment.growth_at(middle, k) - NOISE) * first > 0:
            low = middle
        else:
            high = middle
    return low, high


def _locate_neimark_sacker(segment, low, high, k):
    s = _passage(segment, low, high, k)
    return NEIMARK_SACKER, s, segment.at(s)


def _passage(segment, low, high, k):
    """Return where the k-th multiplier passes the circle, or its outer edge where it comes from the circle."""
    edge = 0.0 if segment.growth_at(low, k) * segment.growth_at(high, k) < 0 else NOISE
    growth = lambda s: segment.growth_at(s, k) - edge
    return brentq(growth, low, high, xtol=LOCATION * segment.length, rtol=LOCATION)


def _locate_doubling(segment, low, high, k):
    """Return the zero of the test function, or that of the multiplier where the secant method finds none beside it."""
    test, width = DoublingTest(segment.tracer, segment.at), high - low
    other, s = low, high
    before, value = test(other), test(s)
    for _ in range(MAX_SECANT):
        if value == 0 or abs(s - other) <= LOCATION * segment.length:
            return PERIOD_DOUBLING, s, segment.at(s)
        slope = (value - before) / (s - other)
        other, before = s, value
        s = s - value / slope if slope else np.inf
        if not low - NEIGHBOURHOOD * width <= s <= high + NEIGHBOURHOOD * width:
            break
        value = test(s)
    s = _passage(segment, low, high, k)
    return PERIOD_DOUBLING, s, segment.at(s)


def _locate_branch_point(segment, near):
    """Return the branch point near s in a list, or none where the test function does not vanish: a fold, or rounding.

    Points beside it are interpolated: at the branch point itself Newton's method has a singular matrix.
    """
    test, width = BranchTest(segment.tracer, segment.at), segment.length * 2.0 ** (1 - BISECTIONS)
    low, high = near - width, near + width
    first = test(low)
    if first * test(high) > 0:  # a fold, or rounding
        return []
    for _ in range(BISECTIONS - 1):
        middle = (low + high) / 2
        low, high = (middle, high) if test(middle) * first > 0 else (low, middle)
    near, width = (low + high) / 2, high - low
    positions = near + width * NODES
    values = np.array([test(s) for s in positions])
    inner, outer = values[[2, 3]], values[[0, 5]]
    if inner[0] * inner[1] > 0 or (abs(inner) > abs(outer)).any():  # no change of sign, or one at a pole
        return []
    position = brentq(BarycentricInterpolator(NODES, values), NODES[2], NODES[3], xtol=LOCATION)
    points = [segment.at(s) for s in positions]
    interpolate = lambda name: BarycentricInterpolator(NODES, np.array([getattr(p, name) for p in points]))(position)
    x, value, t, u = (interpolate(name) for name in ("x", "value", "t", "u"))
    s = near + width * position
    return [(BRANCH_POINT, s, Point(x, float(value), t, float(u), 0))]


class BranchTest:
    """The bordered test function of a branch point: that of the Jacobian with the parameter and the tangent.

    at: function s -> Point. direction: the last A^-1 b, at a zero the null vector (dx, dp) of A.
    """

    def __init__(self, tracer, at):
        self.tracer, self.at, self.left_vector, self.direction = tracer, at, None, None

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
        if self.left_vector is None:
            self.left_vector = dx, dp
        return 1 / float(np.vdot(self.left_vector[0], dx) + self.left_vector[1] * dp)


class DoublingTest:
    """The bordered test function of a period doubling: that of the odd harmonics of twice the period, as BranchTest."""

    def __init__(self, tracer, at):
        self.tracer, self.at, self.left_vector, self.direction = tracer.doubled(), at, None, None
        self.unpack = tracer.unpack

    def __call__(self, s) -> float:
        """Return the test function at s, zero where the Jacobian of the odd harmonics is singular."""
        point = self.at(s)
        rows = self.tracer.family.rows(point.value)
        x = rows.pack(double_period(self.unpack(point.x)))
        column = np.zeros_like(rows.residual(x))
        _, solve = factorise_bordered(rows, x, column, np.zeros_like(x), 1.0)  # of full precision, as J alone is not
        if solve is None:
            return 0.0
        z = rows.unpack(solve(np.random.default_rng(7).normal(size=column.shape), 0.0)[0])
        z[..., 0::4], z[..., 3::4] = 0.0, 0.0  # the mean and the harmonics of the period itself
        self.direction = rows.pack(z), 0.0
        if self.left_vector is None:
            self.left_vector = self.direction[0]
        return 1 / float(np.vdot(self.left_vector, self.direction[0]))
