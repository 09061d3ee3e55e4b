"""Response curves: periodic responses over a parameter, followed through folds, which are located."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from ..common.outcome import InputError, Outcome, Status
from ..common.validation import flags, positive_number, real_number, whole_number
from ..harmonic_balance.response import PeriodicResponse
from ..harmonic_balance.solve import solve_periodic
from ..numerics.memory import keep_freed_memory
from ..numerics.threads import one_blas_thread
from .continuation import HALF, KINK_STEP, LEAST_COSINE, CorrectionError, Point, Tracer, next_step
from .family import UNITS, HarmonicFamily, build_family

INSTANTS_PER_SAMPLE = 4  # instants for each sample at which outputs are taken and a state must be valid
MAX_COUNT = 10**5  # harmonics, samples or points, far beyond what memory holds


class Fold(NamedTuple):
    """A fold: value of the parameter, coefficients z (n_f, N, C) there, and the number of the point before it."""

    value: float
    z: np.ndarray
    after: int


@dataclass(frozen=True, repr=False)
class ResponseCurve(Outcome):
    """P periodic responses along a curve, from the start of the parameter's range on; see ``response_curve``.

    values (P,): of the parameter; omega (P,): angular frequency of the response, rad/s; z (P, n_f, N, C): coefficients
    as those of PeriodicResponse; greatest, least (P, m): of the m outputs over the period; tangents (P,): share of the
    parameter in the unit tangent, whose sign tells which way the curve leads. folds: in their order. iterations: Newton
    steps in total; residual_norm: largest coefficient of the rows at the last point.
    end: what ended a curve that does not reach the stop of its range, or "". Its last point is the last good one.
    """

    parameter: str
    values: np.ndarray
    omega: np.ndarray = field(repr=False)
    z: np.ndarray = field(repr=False)
    greatest: np.ndarray = field(repr=False)
    least: np.ndarray = field(repr=False)
    tangents: np.ndarray = field(repr=False)
    folds: tuple[Fold, ...] = field(repr=False)
    status: Status
    iterations: int
    residual_norm: float
    end: str
    family: Any = field(repr=False, compare=False)

    def describe(self):
        """Yield the range of the parameter that was followed, the folds and the outputs."""
        unit = UNITS.get(self.parameter, "")
        first, last = self.values[[0, -1]]
        yield f"{self.values.size} points from {first:.6g} to {last:.6g} {unit}, {len(self.folds)} folds"
        yield f"outputs from {self.least.min():.6g} to {self.greatest.max():.6g}"

    def harmonic(self, k, component=0, node=-1) -> np.ndarray:
        """Return amplitudes (P,) of harmonic k >= 1 of a field at a node."""
        z = self.z[:, component, node]
        return np.hypot(z[:, 2 * k - 1], z[:, 2 * k])

    def response(self, point) -> PeriodicResponse:
        """Return the PeriodicResponse at a point, or at a Fold."""
        value, z = (point.value, point.z) if isinstance(point, Fold) else (self.values[point], self.z[point])
        return as_response(self.family, float(value), z)


def as_response(family, value, z) -> PeriodicResponse:
    """Return the PeriodicResponse of the system at a value of the parameter that has coefficients z."""
    system = family.build(value)
    basis, rows = family.basis(system), family.rows(value)
    norm = float(abs(rows.residual(rows.pack(z))).max())
    result = getattr(system, "periodic_response", PeriodicResponse)
    return result(system, basis, z, family.subharmonic, Status.SUCCESS, 0, 0, norm, (), 1.0, True, False)


def response_curve(
    system=None,
    *,
    parameter: str | Callable = "frequency",
    start: float,
    stop: float,
    harmonics: int,
    samples: int | None = None,
    subharmonic: int = 1,
    first: PeriodicResponse | None = None,
    step: float = 0.02,
    max_step: float = 0.1,
    min_step: float = 1e-6,
    max_points: int = 1000,
    tolerance: float = 1e-10,
    output: Callable | None = None,
    progress: Callable | None = None,
    throw: bool = True,
) -> ResponseCurve:
    """Return the curve of periodic responses from ``start`` to ``stop`` of a parameter, through its folds.

    parameter: "frequency" of the system's Motion in Hz; "amplitude", a factor of its driving; or a function from the
    value to the system, then without ``system``. harmonics, samples, subharmonic, tolerance: as of ``solve_periodic``,
    which gives the response at ``start``, from the response ``first`` where there is one.
    step, max_step, min_step: along the curve, in units of the parameter's range and of the largest response so far: the
    first one, the longest, and the shortest that is tried. output: response -> (m, S) or (S,), whose greatest and least
    are kept; by default the fields, each over all nodes. progress: called with (number of the point, value, what of the
    range is left, as a share) after each point.
    Raises InputError for bad input, ConvergenceError for a curve that ends before its stop (``throw=False``: the curve
    to its last good point, whose status and ``end`` say why).

    >>> chain = CableProperties(EA=384.243e6, diameter=0.09, mass_per_length=77.7066, Cdn=1.6)
    >>> surge = Motion.harmonic(0.05, (2.0, 0.0, 0.0))
    >>> scene = Scene("my line", chain, 902.2, (0.0, 0.0, -320.0), (848.67, 0.0, -70.0), motion=surge)
    >>> curve = response_curve(mooring_system(scene, cells=10), start=0.02, stop=0.06, harmonics=3)
    >>> float(curve.values[-1]), len(curve.folds)  # Hz
    (0.06, 0)
    """
    if (system is None) != callable(parameter):
        problem = "give either a system or, as parameter, a function that returns one"
        raise InputError(problem, field="system", value=system)
    build = build_family(system, parameter)
    name = parameter if isinstance(parameter, str) else "value"
    unit = UNITS.get(name, "(of the parameter)")
    ends, lengths = _ends(start, stop, unit), _lengths(step, max_step, min_step)
    counts = [("harmonics", harmonics), ("subharmonic", subharmonic), ("max_points", max_points)]
    Nh, nu, limit = (whole_number(*each, 1, MAX_COUNT) for each in counts)
    Nt = max(4 * Nh, 8) if samples is None else whole_number("samples", samples, 2 * Nh + 1, MAX_COUNT)
    tolerance = positive_number("tolerance", tolerance, "(mean change of a coefficient)")
    flags(throw=throw)
    family = HarmonicFamily(build, Nh, Nt, nu)
    keep_freed_memory()
    with one_blas_thread(), np.errstate(all="ignore"):  # a diverging step is found by its size
        run = _Curve(family, ends, tolerance, output or _fields, progress, first)
        status, end = run.follow(lengths, limit)
        curve = run.result(name, status, end)
    return curve.or_raise(f"{ends[0]:g} to {ends[1]:g} {unit}; {run.describe_end(end)}") if throw else curve


def _ends(start, stop, unit):
    """Return the ends of the range as numbers. Raises InputError where they are equal or no numbers."""
    ends = real_number("start", start, unit), real_number("stop", stop, unit)
    if ends[0] == ends[1]:
        raise InputError(f"{ends[1]:g} {unit} must differ from start", field="stop", value=stop, unit=unit)
    return ends


def _lengths(step, max_step, min_step):
    """Return the shortest, the first and the longest step. Raises InputError where they are not in this order."""
    given = ("min_step", min_step), ("step", step), ("max_step", max_step)
    lengths = [positive_number(*each, "(of the curve)") for each in given]
    if not lengths[0] <= lengths[1] <= lengths[2]:
        problem = f"{step:g} must lie between min_step = {min_step:g} and max_step = {max_step:g}"
        raise InputError(problem, field="step", value=step)
    return lengths


def _instants(response):
    """Return times (S,) in the period of a response, s, more than it has samples."""
    count = INSTANTS_PER_SAMPLE * response.basis.samples
    return response.last_period[1] * np.arange(count) / count


def _fields(response):
    """Return the greatest and least of each field over the nodes, (2 n_f, S)."""
    y = response.at(_instants(response))
    return np.concatenate([y.max(axis=1), y.min(axis=1)])


class _Curve:
    """The points of one curve as they are gathered."""

    def __init__(self, family, ends, tolerance, output, progress, first):
        self.family, self.ends, self.output, self.progress = family, ends, output, progress
        self.span, self.first = abs(ends[1] - ends[0]), first
        self.tracer = Tracer(family, self.span, tolerance, self._field_norms)
        self.points: list[Point] = []
        self.responses: list[tuple] = []
        self.folds: list[Fold] = []
        self.iterations = 0

    def _field_norms(self, x):
        """Return the norm of the field of each unknown."""
        z = self.rows.unpack(x)
        norms = np.sqrt((z**2).sum(axis=(1, 2), keepdims=True))
        return self.rows.pack(np.broadcast_to(norms, z.shape))

    def follow(self, lengths, limit):
        """Gather points until the range ends; return the status and what ended the curve."""
        least, step, most = lengths
        try:
            self._begin()
        except CorrectionError as error:
            return Status.NO_PERIODIC_RESPONSE, str(error)
        while len(self.points) < limit:
            point = self.points[-1]
            try:
                new, status = self._next(point, step)
                if step > KINK_STEP and self.tracer.cosine(point, new.t, new.u) < LEAST_COSINE:
                    raise CorrectionError("the curve turns too sharply")
                response = self._checked(new)
                if new.u * point.u < 0:
                    self._locate_fold(point, step, new)
            except CorrectionError as error:
                step *= HALF
                if step < least:
                    return Status.CURVE_STEP_TOO_SHORT, str(error)
                continue
            self._add(new, response)
            if status is not None:
                return status, "" if status is Status.SUCCESS else "it came back to its start"
            step = next_step(step, new.iterations, most)
        return Status.CURVE_TOO_LONG, f"{limit} points"

    def _begin(self):
        """Add the point at the start. Raises CorrectionError without a response there."""
        begin, stop = self.ends
        Nh, Nt = self.family.settings
        system = self.family.build(begin)
        self.rows = self.family.rows(begin)
        response = solve_periodic(system, harmonics=Nh, samples=Nt, subharmonic=self.family.subharmonic, symmetry=False,
                               start=self.first, throw=False)  # fmt: skip
        if not response.success:
            raise CorrectionError(response.status.value)
        point = self.tracer.start(self.rows.pack(response.z), begin, np.sign(stop - begin))
        self._add(point, self._checked(point))

    def _next(self, point, step):
        """Return the next point and, where it is the last one, the status of the curve."""
        new = self.tracer.advance(point, step)
        (begin, stop), side = self.ends, np.sign(self.ends[1] - self.ends[0])
        if side * (new.value - stop) >= 0:
            return self.tracer.end(point, stop), Status.SUCCESS
        if side * (new.value - begin) <= 0 and new.u * side < 0:
            return self.tracer.end(point, begin), Status.CURVE_RETURNED
        return new, None

    def _checked(self, point):
        """Return the response at a point. Raises CorrectionError where its states are invalid."""
        response = as_response(self.family, point.value, self.rows.unpack(point.x))
        invalid = response.system.invalid(response.at(_instants(response)))
        if invalid is not None:
            raise CorrectionError(invalid[0].value)
        return response

    def _locate_fold(self, point, step, new):
        fold = self.tracer.fold(point, step, new)
        self.folds.append(Fold(fold.value, self.rows.unpack(fold.x), len(self.points) - 1))

    def _add(self, point, response):
        self.tracer.measure(point.x)
        self.points.append(self.tracer.normalised(point))
        outputs = np.atleast_2d(self.output(response))
        self.responses.append((response.basis.omega, response.z, outputs.max(axis=1), outputs.min(axis=1)))
        self.iterations += point.iterations
        self.residual_norm = response.residual_norm
        if self.progress is not None:
            left = abs(self.ends[1] - point.value) / self.span
            self.progress(len(self.points), point.value, left)

    def describe_end(self, end) -> str:
        """Return the last good point and what ended the curve, for a message."""
        if not self.points:
            return f"no response at the start: {end}"
        return f"{len(self.points)} points, the last one at {self.points[-1].value:.6g}: {end}"

    def result(self, name, status, end) -> ResponseCurve:
        """Return the curve."""
        columns: Any = [np.array(column) for column in zip(*self.responses, strict=True)] or [np.empty(0)] * 4
        values, tangents = np.array([(p.value, p.u / self.span) for p in self.points]).reshape(-1, 2).T
        norm = getattr(self, "residual_norm", np.nan)
        omega, z, greatest, least = columns
        points = values, omega, z, greatest, least, tangents
        return ResponseCurve(name, *points, tuple(self.folds), status, self.iterations, norm, end, self.family)
