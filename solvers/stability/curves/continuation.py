"""Pseudo-arclength continuation of F(x, p) = 0: tangent predictor, Newton's corrector, control of the step.

H. B. Keller, in Applications of Bifurcation Theory, 1977, 359. A step of length s along the unit tangent (t, u) of the
last point is corrected in the plane across it: t . W (x - x_predicted) + u (p - p_predicted) / range^2 = 0. W weighs
each field by the inverse square of its largest norm so far, and the parameter is measured in its range, so neither
units nor meshes change the steps.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...common.outcome import InputError
from .family import resize_harmonics

MAX_NEWTON = 8  # Newton steps of a corrector; more come from a step that is too long
FEW_NEWTON = 4  # up to so many Newton steps the next step is longer, from one more on shorter
LONGER, SHORTER, HALF = 1.5, 0.7, 0.5
LEAST_COSINE = 0.9  # of the angle between neighbouring tangents: a larger turn may have missed a part of the curve
UPRIGHT = 1e-4  # share of the parameter in a unit tangent below which a start is a fold, within its square
KINK_STEP = 1e-4  # a step below which a large turn is a kink, where a cell goes slack or a node touches the seabed


class Point(NamedTuple):
    """A point (x, value) of the curve with its unit tangent (t, u); iterations: Newton steps that it took."""

    x: np.ndarray
    value: float
    t: np.ndarray
    u: float
    iterations: int


class CorrectionError(Exception):
    """A predicted point was not corrected: the message says why."""


class RefusedError(CorrectionError):
    """The system refuses the parameter: the message is its own."""


class Tracer:
    """Points of the curve of a HarmonicFamily, one from the last.

    span: size of the range of the parameter; tolerance: of the last Newton step, mean |dx| and |dp| over the span;
    value: of the parameter, at which there is a system. norms (n_f, 1, 1): largest norm of each field so far, which
    weighs it. pack, unpack: between coefficients z and x.
    """

    def __init__(self, family, span, tolerance, value, norms=None):
        self.family, self.span, self.tolerance, self.value, self.norms = family, span, tolerance, value, norms
        self.frame = family.rows(value)
        self.pack, self.unpack = self.frame.pack, self.frame.unpack

    def with_harmonics(self, harmonics) -> Tracer:
        """Return the Tracer with other harmonics."""
        family = self.family.with_harmonics(harmonics)
        return Tracer(family, self.span, self.tolerance, self.value, self.norms)

    def doubled(self) -> Tracer:
        """Return the Tracer of responses of twice the period."""
        return Tracer(self.family.doubled(), self.span, self.tolerance, self.value, self.norms)

    def resized(self, point) -> Point:
        """Return a point of a Tracer with other harmonics with those of this one: cut, or filled with zeros."""
        Nh = self.family.settings[0]
        of_other = lambda x: self.pack(resize_harmonics(_fields_of(x, len(self.norms)), Nh))
        return point._replace(x=of_other(point.x), t=of_other(point.t))

    def measure(self, x):
        """Take the norms of the fields at x into the weights, which never grow; a field of rounding errors has none."""
        z = self.unpack(x)
        norms = np.sqrt((z**2).sum(axis=(1, 2), keepdims=True))
        norms[norms <= self.tolerance * np.sqrt(z[0].size)] = 0.0  # coefficients are not known to less
        self.norms = norms if self.norms is None else np.maximum(self.norms, norms)

    def plane(self, t, u):
        """Return (row, corner) of the plane across a tangent."""
        count = 2 * self.family.settings[0] + 1
        size = np.repeat(self.norms.ravel(), count)  # of each coefficient of a node, field after field
        return t / np.where(size > 0, size, np.inf) ** 2, u / self.span**2

    def correct(self, x, value, row, corner, along) -> Point:
        """Return the point in the plane through (x, value), its tangent turned as that of the Point ``along``.

        Raises CorrectionError where Newton's method does not converge, RefusedError where the system refuses the value.
        """
        last = np.inf
        for iteration in range(1, MAX_NEWTON + 1):
            F, solve = self.linearise(x, value, row, corner)
            dx, dp = solve(F, 0.0)
            x, value = x - dx, value - dp
            size = max(float(abs(dx).mean()), abs(dp) / self.span)
            if not size <= 2 * last:
                raise CorrectionError("Newton's method diverges")
            if size <= self.tolerance:  # the last Jacobian stood so near that its tangent is that of the point
                t, u = self._tangent(solve, F, along)
                return Point(x, float(value), t, u, iteration)
            last = size
        raise CorrectionError("Newton's method does not converge in the steps it has")

    def linearise(self, x, value, row, corner):
        """Return the rows at (x, value) and a solve of the bordered Jacobian. Raises as ``correct``."""
        try:
            F, solve = self.family.linearise(x, value, row, corner, self.span)
        except InputError as error:
            raise RefusedError(str(error)) from error
        if solve is None:
            raise CorrectionError("the bordered Jacobian is singular, or the rows are not finite")
        return F, solve

    def _tangent(self, solve, F, along):
        """Return the unit tangent, on the side of that of a point; ``along`` a sign: on that side of the parameter."""
        t, u = solve(np.zeros_like(F), 1.0)
        length = np.sqrt(self.product(t, u, t, u))
        if not (np.isfinite(length) and length > 0):
            raise CorrectionError("the curve has no tangent: the bordered Jacobian is singular")
        side = along * u if isinstance(along, float) else self.product(along.t, along.u, t, u)
        length = -length if side < 0 else length
        return t / length, float(u / length)

    def product(self, t, u, x, value) -> float:
        """Return the inner product of (t, u) with (x, value) in the weights."""
        row, corner = self.plane(t, u)
        return float(np.vdot(row, x) + corner * value)

    def start(self, x, value, direction) -> Point:
        """Return the point at a value of the parameter; direction +1.0 or -1.0: where its tangent leads."""
        self.measure(x)
        return self.correct(x, value, np.zeros_like(x), 1.0, float(direction))

    def upright(self, x, value) -> bool:
        """Return whether the curve has next to no direction in the parameter at (x, value), as at a fold."""
        self.measure(x)
        F, solve = self.linearise(x, value, np.zeros_like(x), 1.0)
        return abs(self._tangent(solve, F, 1.0)[1]) / self.span < UPRIGHT

    def advance(self, point, step) -> Point:
        """Return the point a step along the tangent of the last one."""
        row, corner = self.plane(point.t, point.u)
        return self.correct(point.x + step * point.t, point.value + step * point.u, row, corner, point)

    def end(self, point, value) -> Point:
        """Return the point at a value of the parameter, predicted along the tangent of the last one."""
        step = (value - point.value) / point.u
        return self.correct(point.x + step * point.t, value, np.zeros_like(point.x), 1.0, point)

    def refined(self, point, is_end) -> Point:
        """Return a point that other harmonics gave, solved with these; an end at the same value of the parameter."""
        point = self.resized(point)
        row, corner = (np.zeros_like(point.x), 1.0) if is_end else self.plane(point.t, point.u)
        return self.correct(point.x, point.value, row, corner, point)

    def distance(self, point, other) -> float:
        """Return how far another point is along the tangent of a point."""
        return self.product(point.t, point.u, other.x - point.x, other.value - point.value)

    def normalised(self, point) -> Point:
        """Return a point with its tangent of unit length in the weights as they are now."""
        length = np.sqrt(self.product(point.t, point.u, point.t, point.u))
        return point._replace(t=point.t / length, u=point.u / length)


def _fields_of(x, count):
    """Return coefficients (n_f, N, C) of x (N, n_f C), whose harmonics may be any."""
    return np.swapaxes(x.reshape(len(x), count, -1), 0, 1)


def next_step(step, iterations, max_step) -> float:
    """Return the length of the next step after one that took so many Newton steps."""
    if iterations <= FEW_NEWTON:
        return min(max_step, LONGER * step)
    return SHORTER * step if iterations > FEW_NEWTON + 1 else step
