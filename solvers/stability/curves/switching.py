"""Starts on the branches that leave a response curve: of twice the period, or through a branch point.

From the special point a step along the null vector of the singular Jacobian is corrected in the plane across it: along
a branch the parameter changes with the square of the step only, so the plane meets it once.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...common.outcome import ConvergenceError, InputError
from ...common.validation import real_number
from ...harmonic_balance.response import PeriodicResponse
from .continuation import CorrectionError, Point, Tracer
from .family import double_period
from .special_points import BRANCH_POINT, PERIOD_DOUBLING, BranchTest, DoublingTest
from .tracing import as_response

AT_REST = 1e-10  # of the largest norm, below which a field does not take part in the responses of a curve


class BranchStart(NamedTuple):
    """Where a branch starts: value of the parameter and response there, the ``start`` and ``first`` of its curve."""

    value: float
    response: PeriodicResponse


def switch_branch(curve, point, step=0.02, tolerance=1e-10) -> BranchStart:
    """Return a start on the branch that leaves a curve at a SpecialPoint, a period doubling or a branch point.

    step: along the branch, in units of the largest response of the curve; its sign takes one side or the other. Past a
    period doubling the response has twice the ``subharmonic`` and the harmonics of the curve. Raises InputError at
    other points, ConvergenceError where the step leads to no response.

    >>> doubling = next(point for point in curve.special if point.kind == "period doubling")  # doctest: +SKIP
    >>> value, response = switch_branch(curve, doubling)  # doctest: +SKIP
    >>> response_curve(..., start=value, first=response, subharmonic=response.subharmonic)  # doctest: +SKIP
    """
    if getattr(point, "kind", None) not in (BRANCH_POINT, PERIOD_DOUBLING):
        problem = "must be a period doubling or a branch point of the curve: no branch starts elsewhere"
        raise InputError(problem, field="point", value=point)
    step = real_number("step", step, "(of the largest response)")
    family = curve.family.with_harmonics(point.z.shape[-1] // 2)
    span = abs(curve.values[-1] - curve.values[0]) or 1.0
    tracer = Tracer(family, span, tolerance, point.value, _norms_beside(curve.state.norms))
    try:
        x = tracer.pack(point.z)
        t, u = _tangent_beside(tracer, curve, point)
        at = Point(x, point.value, t, u, 0)
        test = (DoublingTest if point.kind == PERIOD_DOUBLING else BranchTest)(tracer, lambda _: at)
        test(0.0)  # at any number: the point is there
        if test.direction is None:
            raise CorrectionError("the Jacobian is singular to the last digit")
        if point.kind == PERIOD_DOUBLING:
            tracer = tracer.doubled()
            x = tracer.pack(double_period(point.z))
        dx, dp = test.direction
        length = np.sqrt(tracer.product(dx, dp, dx, dp))
        dx, dp = dx / length, dp / length
        row, corner = tracer.plane(dx, dp)
        new = tracer.correct(x + step * dx, point.value + step * dp, row, corner, Point(x, point.value, dx, dp, 0))
    except CorrectionError as error:
        problem = f"no response on the branch at {point.value:.6g}: {error}; take another step than {step:g}"
        raise ConvergenceError(problem) from error
    return BranchStart(new.value, as_response(tracer.family, new.value, tracer.unpack(new.x)))


def _norms_beside(norms):
    """Return the norms of fields, the largest for those at rest on the curve: they may be all that a branch moves."""
    return np.where(norms > AT_REST * norms.max(), norms, norms.max())


def _tangent_beside(tracer, curve, point):
    """Return (t, u), the direction between the two points of the curve beside a special point."""
    before, after = (curve.points[i] for i in (point.after, point.after + 1))
    count = point.z.shape[-1]
    cut = lambda z: np.concatenate([z, np.zeros((*z.shape[:-1], max(0, count - z.shape[-1])))], axis=-1)[..., :count]
    t, u = tracer.pack(cut(after.z) - cut(before.z)), after.value - before.value
    length = np.sqrt(tracer.product(t, u, t, u))
    return t / length, u / length
