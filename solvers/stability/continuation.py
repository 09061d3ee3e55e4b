"""Pseudo-arclength continuation of F(x, p) = 0: tangent predictor, Newton's corrector, control of the step.

H. B. Keller, in Applications of Bifurcation Theory, 1977, 359. A step of length s along the unit tangent (t, u) of the
last point is corrected in the plane across it: t . W (x - x_predicted) + u (p - p_predicted) / range^2 = 0. W weighs
each field by the inverse square of its largest norm so far, and the parameter is measured in its range, so neither
units nor meshes change the steps.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from ..common.outcome import InputError
from .family import HarmonicFamily

MAX_NEWTON = 8  # Newton steps of a corrector; more come from a step that is too long
FEW_NEWTON = 4  # up to so many Newton steps the next step is longer, from one more on shorter
LONGER, SHORTER, HALF = 1.5, 0.7, 0.5
LEAST_COSINE = 0.9  # of the angle between neighbouring tangents: a larger turn may have missed a part of the curve
KINK_STEP = 1e-4  # a step below which a large turn is a kink, where a cell goes slack or a node touches the seabed
FOLD_STEP = 1e-6  # of the step over a fold, to which its place is found: its square is left in the parameter


class Point(NamedTuple):
    """A point (x, value) of the curve with its unit tangent (t, u); iterations: Newton steps that it took."""

    x: np.ndarray
    value: float
    t: np.ndarray
    u: float
    iterations: int


class CorrectionError(Exception):
    """A predicted point was not corrected: the message says why."""


@dataclass
class Tracer:
    """Points of the curve of a HarmonicFamily, one from the last.

    span: size of the range of the parameter; tolerance: of the last Newton step, mean |dx| and |dp| over the span.
    fields: function x -> norms of each unknown's field, of the shape of x, which weigh it.
    """

    family: HarmonicFamily
    span: float
    tolerance: float
    fields: Callable
    size: np.ndarray | float = 0.0

    def measure(self, x):
        """Take the norms of the fields at x into the weights, which never grow."""
        norms = self.fields(x)
        self.size = np.maximum(self.size, norms)

    def plane(self, t, u):
        """Return (row, corner) of the plane across a tangent."""
        return t / np.where(self.size > 0, self.size, np.inf) ** 2, u / self.span**2

    def correct(self, x, value, row, corner, along) -> Point:
        """Return the point in the plane through (x, value), its tangent turned as that of the Point ``along``.

        Raises CorrectionError where Newton's method does not converge, or where the system refuses the parameter.
        """
        last = np.inf
        for iteration in range(1, MAX_NEWTON + 1):
            try:
                F, solve = self.family.linearise(x, value, row, corner, self.span)
            except InputError as error:
                raise CorrectionError(str(error)) from error
            if solve is None:
                raise CorrectionError("the bordered Jacobian is singular, or the rows are not finite")
            dx, dp = solve(F, 0.0)
            x, value = x - dx, value - dp
            size = max(float(abs(dx).mean()), abs(dp) / self.span)
            if not size <= 2 * last:
                raise CorrectionError("Newton's method diverges")
            if size <= self.tolerance:  # the last Jacobian stood so near that its tangent is that of the point
                t, u = self._tangent(solve, F, along)
                return Point(x, value, t, u, iteration)
            last = size
        raise CorrectionError("Newton's method does not converge in the steps it has")

    def _tangent(self, solve, F, along):
        """Return the unit tangent, on the side of that of a point; ``along`` a sign: on that side of the parameter."""
        t, u = solve(np.zeros_like(F), 1.0)
        row, corner = self.plane(t, u)
        length = np.sqrt(np.vdot(row, t) + corner * u)
        if not (np.isfinite(length) and length > 0):
            raise CorrectionError("the curve has no tangent")
        side = along * u if isinstance(along, float) else self.cosine(along, t, u)
        length = -length if side < 0 else length
        return t / length, float(u / length)

    def cosine(self, point, t, u) -> float:
        """Return the inner product of the tangent of a point with another."""
        row, corner = self.plane(point.t, point.u)
        return float(np.vdot(row, t) + corner * u)

    def start(self, x, value, direction) -> Point:
        """Return the point at a value of the parameter; direction +1.0 or -1.0: where its tangent leads."""
        self.measure(x)
        return self.correct(x, value, np.zeros_like(x), 1.0, float(direction))

    def advance(self, point, step) -> Point:
        """Return the point a step along the tangent of the last one."""
        row, corner = self.plane(point.t, point.u)
        return self.correct(point.x + step * point.t, point.value + step * point.u, row, corner, point)

    def end(self, point, value) -> Point:
        """Return the point at a value of the parameter, predicted along the tangent of the last one."""
        step = (value - point.value) / point.u
        return self.correct(point.x + step * point.t, value, np.zeros_like(point.x), 1.0, point)

    def normalised(self, point) -> Point:
        """Return a point with its tangent of unit length in the weights as they are now."""
        length = np.sqrt(self.cosine(point, point.t, point.u))
        return point._replace(t=point.t / length, u=point.u / length)

    def fold(self, point, step, after) -> Point:
        """Return the fold between a point and that a step further, where the tangent has no part in the parameter."""
        points = {0.0: point, step: after}

        def slope(s):
            if s not in points:
                points[s] = self.advance(point, s)
            return points[s].u

        brentq(slope, 0.0, step, xtol=FOLD_STEP * step, rtol=FOLD_STEP)
        return min(points.values(), key=lambda p: abs(p.u))


def next_step(step, iterations, most) -> float:
    """Return the length of the next step after one that took so many Newton steps."""
    if iterations <= FEW_NEWTON:
        return min(most, LONGER * step)
    return SHORTER * step if iterations > FEW_NEWTON + 1 else step
