"""Points of a response curve as they are traced: steps, harmonics, multipliers and special points, and where it ends.

All that the next point depends on is a TraceState, kept after each point: a curve that ends early goes on from it as if
it had not.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ...common.outcome import Status
from ...harmonic_balance.response import PeriodicResponse
from ...harmonic_balance.solve import solve_periodic
from ..multipliers.floquet import floquet
from .adaptivity import estimate_error, more_harmonics, needed_harmonics
from .continuation import (
    HALF,
    KINK_STEP,
    LEAST_COSINE,
    UPRIGHT,
    CorrectionError,
    Point,
    RefusedError,
    Tracer,
    next_step,
)
from .special_points import FOLD, WANTED, CurveSegment, SpecialPoint, explain_doubt, locate_special_points

INSTANTS_PER_SAMPLE = 4  # instants for each sample at which outputs are taken and a state must be valid
AT_STOP = 1e-8  # of the range: a fold so near the stop is taken to lie there
SAME_FREQUENCY = 1e-12  # relative, of a response that a curve may start from
FEW_ITERATIONS = 4  # Newton steps after which a response that was given is not the start


class TraceState(NamedTuple):
    """What the next point depends on: tangent (t, u) and x of the last one, norms of the fields, step, harmonics."""

    x: np.ndarray
    t: np.ndarray
    u: float
    value: float
    norms: np.ndarray
    step: float
    harmonics: int


class CurvePoint(NamedTuple):
    """One point of a curve; z (n_f, N, C); special: the SpecialPoints before it."""

    value: float
    omega: float
    z: np.ndarray
    greatest: np.ndarray
    least: np.ndarray
    tangent: float
    error: float
    multipliers: np.ndarray | None
    sideways: np.ndarray | None
    special: tuple[SpecialPoint, ...]
    iterations: int
    residual_norm: float


class EndError(CorrectionError):
    """The curve reaches the stop of its range, and has no point there."""


def as_response(family, value, z) -> PeriodicResponse:
    """Return the PeriodicResponse of the system at a value of the parameter that has coefficients z."""
    family = family.with_harmonics(z.shape[-1] // 2)
    system = family.build(value)
    basis, rows = family.basis(system), family.rows(value)
    norm = float(abs(rows.residual(rows.pack(z))).max())
    result = getattr(system, "periodic_response", PeriodicResponse)
    return result(system, basis, z, family.subharmonic, Status.SUCCESS, 0, 0, norm, (), 1.0, True, False)


def instants_of(response):
    """Return times (S,) in the period of a response, s, more than it has samples."""
    count = INSTANTS_PER_SAMPLE * response.basis.samples
    return response.last_period[1] * np.arange(count) / count


class CurveTrace:
    """The points of one curve as they are traced.

    output, progress, first: as of ``response_curve``. accuracy: None, or of the error, by as many harmonics as it takes
    up to a largest number of them; has_stability: whether multipliers are wanted.
    """

    def __init__(self, family, ends, tolerance, output, progress, first, accuracy, max_harmonics, has_stability):
        self.family, self.ends, self.output, self.progress = family, ends, output, progress
        self.span, self.first = abs(ends[1] - ends[0]), first
        self.tracer = Tracer(family, self.span, tolerance, ends[0])
        self.accuracy, self.max_harmonics, self.has_stability = accuracy, max_harmonics, has_stability
        self.points_and_state: tuple[list[CurvePoint], Any] = ([], None)  # replaced as one: never half a point

    @property
    def points(self) -> list[CurvePoint]:
        """The points so far."""
        return self.points_and_state[0]

    # ------------------------------------------------------------ the walk
    def follow(self, lengths, limit):
        """Gather points until the range ends; return the status and what ended the curve."""
        try:
            if self.points_and_state[1] is None:
                self._begin(lengths[1])
            return self._advance(lengths, limit)
        except CorrectionError as error:
            return Status.NO_PERIODIC_RESPONSE, str(error)
        except _SingularStartError:
            return Status.CURVE_SINGULAR_START, "no direction at the start"
        except KeyboardInterrupt:
            return Status.CURVE_INTERRUPTED, "interrupted"

    def _advance(self, lengths, limit):
        """Add points from the last state on; return the status and what ended the curve."""
        min_step, _, max_step = lengths
        step = self.points_and_state[1].step
        while len(self.points) < limit:
            state = self.points_and_state[1]
            self.tracer = self._tracer_of(state)
            point = self.tracer.resized(Point(state.x, state.value, state.t, state.u, 0))
            try:
                new, status, record = self._next(point, step)
            except CorrectionError as error:
                step *= HALF
                if step < min_step:
                    return _reason(error), str(error)
                continue
            if new is None:
                return status, f"a fold at {record:.9g}"
            step = next_step(step, new.iterations, max_step)
            self._add(new, record, step)
            if status is not None:
                return status, "" if status is Status.SUCCESS else "it came back to its start"
        return Status.CURVE_TOO_LONG, f"{limit} points"

    def _tracer_of(self, state):
        """Return the Tracer with the harmonics and the norms of a state."""
        if state.harmonics == self.tracer.family.settings[0] and self.tracer.norms is state.norms:
            return self.tracer
        self.tracer.norms = state.norms
        return self.tracer.with_harmonics(state.harmonics)

    def _begin(self, step):
        """Add the point at the start. Raises CorrectionError without a response there."""
        point = self._start_at_first() or self._start_from_rest()
        if abs(point.u) / self.span < UPRIGHT:
            raise _SingularStartError
        point, error = self._accurate(point, True)
        response = self._checked(point)
        multipliers, sideways = self._all_multipliers(response)
        self._add(point, self._record(point, response, error, multipliers, sideways, ()), step)

    def _start_at_first(self):
        """Return the start where the response that was given is one already, else None: a solve might leave it."""
        begin, stop = self.ends
        basis = self.family.basis(self.family.build(begin))
        if not isinstance(self.first, PeriodicResponse):
            return None
        z, old = self.first.z, self.first.basis
        if z.shape[-1] != basis.harmonic.size or abs(old.omega / basis.omega - 1) > SAME_FREQUENCY:
            return None
        try:
            if self.tracer.upright(self.tracer.pack(z), begin):  # Newton's method would lead anywhere
                raise _SingularStartError
            point = self.tracer.start(self.tracer.pack(z), begin, np.sign(stop - begin))
        except CorrectionError:
            point = None
        if point is None or point.iterations > FEW_ITERATIONS:
            self.tracer.norms = None
            return None
        return point

    def _start_from_rest(self):
        """Return the start as ``solve_periodic`` gives it. Raises CorrectionError where it gives none."""
        begin, stop = self.ends
        Nh, Nt = self.family.settings
        response = solve_periodic(self.family.build(begin), harmonics=Nh, samples=Nt, symmetry=False, start=self.first,
                                  subharmonic=self.family.subharmonic, throw=False)  # fmt: skip
        if not response.success:
            has_no_more = response.status is Status.NO_PERIODIC_RESPONSE  # to say than the status of the curve itself
            raise CorrectionError("solve_periodic has none" if has_no_more else response.status.value)
        try:
            return self.tracer.start(self.tracer.pack(response.z), begin, np.sign(stop - begin))
        except CorrectionError as reason:
            raise _SingularStartError from reason

    def _next(self, point, step):
        """Return the next point, the status of the curve where it is the last one, and its CurvePoint.

        Where a fold lies at the stop: None, the status and the fold's place.
        """
        new, status = self._predicted(point, step)
        if step > KINK_STEP and self.tracer.product(point.t, point.u, new.t, new.u) < LEAST_COSINE:
            raise CorrectionError("the curve turns too sharply")
        coarse, (new, error) = self.tracer, self._accurate(new, status is not None)
        response = self._checked(new)
        multipliers, sideways = self._all_multipliers(response)
        special = self._special_points(self.tracer.resized(point) if coarse is not self.tracer else point, new,
                                       multipliers, error)  # fmt: skip
        for each in special:
            if each.kind == FOLD and abs(each.value - self.ends[1]) <= AT_STOP * self.span:
                return None, Status.CURVE_FOLD_AT_STOP, each.value
        return new, status, self._record(new, response, error, multipliers, sideways, special)

    def _predicted(self, point, step):
        """Return the next point and, where it is the last one, the status of the curve."""
        new = self.tracer.advance(point, step)
        (begin, stop), side = self.ends, np.sign(self.ends[1] - self.ends[0])
        if side * (new.value - stop) >= 0:
            try:
                return self.tracer.end(point, stop), Status.SUCCESS
            except CorrectionError as error:
                raise EndError(f"no point at the stop: {error}") from error
        if side * (new.value - begin) <= 0 and new.u * side < 0:
            return self.tracer.end(point, begin), Status.CURVE_RETURNED
        return new, None

    def _accurate(self, point, is_end):
        """Return a point and its error; with an accuracy that is met, or as many harmonics as are allowed."""
        error = estimate_error(self.tracer, point)
        while self.accuracy is not None and error > self.accuracy:
            harmonics = min(more_harmonics(self.tracer.family.settings[0]), self.max_harmonics)
            if harmonics <= self.tracer.family.settings[0]:
                break
            self.tracer = self.tracer.with_harmonics(harmonics)
            point = self.tracer.refined(point, is_end)
            error = estimate_error(self.tracer, point)
        return point, error

    # ------------------------------------------------------------ one point
    def _checked(self, point):
        """Return the response at a point. Raises CorrectionError where its states are invalid."""
        response = as_response(self.tracer.family, point.value, self.tracer.unpack(point.x))
        invalid = response.system.invalid(response.at(instants_of(response)))
        if invalid is not None:
            raise CorrectionError(invalid[0].value)
        return response

    def _multipliers(self, response):
        """Return the multipliers of a response, largest first, or None where they are not wanted."""
        return self._all_multipliers(response, out_of_plane=False)[0]

    def _all_multipliers(self, response, out_of_plane=True):
        """Return the multipliers of a response and those sideways of a planar one, each None where there are none."""
        if not self.has_stability:
            return None, None
        result = floquet(response, method="monodromy", out_of_plane=out_of_plane, has_step_errors=False,
                         least_size=WANTED)  # fmt: skip
        return result.multipliers, result.sideways

    def _special_points(self, point, new, multipliers, error):
        """Return the SpecialPoints between two points; error: of the new one by its harmonics."""
        tracer, unpack = self.tracer, self.tracer.unpack
        multipliers_of = lambda p: self._multipliers(as_response(tracer.family, p.value, unpack(p.x)))
        segment = CurveSegment(tracer, point, new, multipliers_of)
        if self.has_stability:
            segment.set_multipliers(self.points[-1].multipliers, multipliers)
        result, error = [], max(error, self.points[-1].error)
        for kind, _, at in locate_special_points(segment, self.has_stability):
            values = multipliers_of(at)
            doubt = explain_doubt(kind, values, error)
            result.append(SpecialPoint(kind, at.value, unpack(at.x), values, len(self.points) - 1, doubt))
        return tuple(result)

    def _record(self, point, response, error, multipliers, sideways, special):
        """Return the CurvePoint of a point."""
        outputs = np.atleast_2d(self.output(response))
        extremes = outputs.max(axis=1), outputs.min(axis=1)
        return CurvePoint(point.value, response.basis.omega, response.z, *extremes, point.u / self.span, error,
                          multipliers, sideways, special, point.iterations, response.residual_norm)  # fmt: skip

    def _add(self, point, record, step):
        """Add a point, and keep what the next one depends on."""
        tracer = self.tracer
        tracer.measure(point.x)
        point, harmonics = tracer.normalised(point), tracer.family.settings[0]
        if self.accuracy is not None:
            harmonics = min(harmonics, max(needed_harmonics(record.z, tracer.norms, self.accuracy), 1))
        state = TraceState(point.x, point.t, point.u, point.value, tracer.norms, step, harmonics)
        self.points_and_state = [*self.points, record], state
        if self.progress is not None:
            self.progress(len(self.points), point.value, abs(self.ends[1] - point.value) / self.span)

    def describe_end(self, end) -> str:
        """Return the last good point and what ended the curve, for a message."""
        if not self.points:
            return f"no response at the start: {end}"
        return f"{len(self.points)} points, the last one at {self.points[-1].value:.6g}: {end}"


class _SingularStartError(Exception):
    """The curve has no direction at its start."""


def _reason(error) -> Status:
    """Return the status of a curve that an error ends."""
    if isinstance(error, RefusedError):
        return Status.CURVE_LEFT_RANGE
    return Status.CURVE_FOLD_AT_STOP if isinstance(error, EndError) else Status.CURVE_STEP_TOO_SHORT
