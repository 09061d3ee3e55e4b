"""Response curves: periodic responses over a parameter, followed through folds, their special points and stability."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ...common.outcome import InputError, Outcome, Status
from ...common.validation import flags, positive_number, real_number, whole_number
from ...harmonic_balance.response import PeriodicResponse
from ...numerics.memory import keep_freed_memory
from ...numerics.threads import one_blas_thread
from .family import UNITS, HarmonicFamily, build_family, resize_harmonics
from .special_points import FOLD, SpecialPoint
from .tracing import CurvePoint, CurveTrace, TraceState, as_response, instants_of

MAX_COUNT = 10**5  # harmonics, samples or points, far beyond what memory holds


@dataclass(frozen=True, repr=False)
class ResponseCurve(Outcome):
    """P periodic responses along a curve, from the start of the parameter's range on; see ``response_curve``.

    values (P,): of the parameter; omega (P,): angular frequency of the response, rad/s; z (P, n_f, N, C): coefficients
    as those of PeriodicResponse, zeros beyond the ``harmonics`` (P,) of a point; greatest, least (P, m): of the m
    outputs over the period; tangents (P,): share of the parameter in the unit tangent, whose sign tells which way the
    curve leads; errors (P,): the change that a third more harmonics would make, over the largest response so far.
    special: SpecialPoints of the motion in their order; unresolved: those of the truncated series, their ``doubt`` says
    why. multipliers: an array for each point, largest first, or None; of a line with many disturbances those from
    ``special_points.WANTED`` on, see ``floquet``, at least the first; sideways: the same of disturbances across the
    plane of a line whose motion lies in it, whose passages of the unit circle are not among the special points.
    iterations: Newton steps in total; residual_norm: largest coefficient of the rows at the last point.
    end: what ended a curve that does not reach the stop of its range, or "". Its last point is the last good one.
    state: what the next point depends on.
    """

    parameter: str
    values: np.ndarray
    omega: np.ndarray = field(repr=False)
    z: np.ndarray = field(repr=False)
    greatest: np.ndarray = field(repr=False)
    least: np.ndarray = field(repr=False)
    tangents: np.ndarray = field(repr=False)
    harmonics: np.ndarray = field(repr=False)
    errors: np.ndarray = field(repr=False)
    special: tuple[SpecialPoint, ...] = field(repr=False)
    unresolved: tuple[SpecialPoint, ...] = field(repr=False)
    multipliers: tuple[np.ndarray, ...] | None = field(repr=False)
    sideways: tuple[np.ndarray, ...] | None = field(repr=False)
    status: Status
    iterations: int
    residual_norm: float
    end: str
    family: Any = field(repr=False, compare=False)
    state: TraceState | None = field(repr=False, compare=False)
    points: tuple[CurvePoint, ...] = field(repr=False, compare=False)

    @property
    def folds(self) -> tuple[SpecialPoint, ...]:
        """The folds among the special points."""
        return tuple(point for point in self.special if point.kind == FOLD)

    @property
    def stable(self) -> np.ndarray | None:
        """Whether each response is stable, (P,), sideways too: all multipliers are below one; None without them."""
        if self.multipliers is None or self.sideways is None:
            return self.stable_in_plane
        return self.stable_in_plane & _are_inside(self.sideways)

    @property
    def stable_in_plane(self) -> np.ndarray | None:
        """Whether ``multipliers`` alone, of the fields of the system, say that each response is stable, (P,)."""
        return None if self.multipliers is None else _are_inside(self.multipliers)

    def describe(self):
        """Yield the range of the parameter that was followed, the folds and the outputs."""
        unit = UNITS.get(self.parameter, "")
        first, last = self.values[[0, -1]]
        yield f"{self.values.size} points from {first:.6g} to {last:.6g} {unit}, {len(self.folds)} folds"
        if self.unresolved:
            yield f"{len(self.unresolved)} special points of the series alone: more harmonics, or time integration"
        yield f"outputs from {self.least.min():.6g} to {self.greatest.max():.6g}"

    def harmonic(self, k, component=0, node=-1) -> np.ndarray:
        """Return amplitudes (P,) of harmonic k >= 1 of a field at a node."""
        z = self.z[:, component, node]
        return np.hypot(z[:, 2 * k - 1], z[:, 2 * k])

    def response(self, point) -> PeriodicResponse:
        """Return the PeriodicResponse at a point, or at a SpecialPoint."""
        solution = point if isinstance(point, SpecialPoint) else self.points[point]
        return as_response(self.family, float(solution.value), solution.z)


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
    stability: bool = False,
    accuracy: float | None = None,
    max_harmonics: int = 100,
    output: Callable | None = None,
    progress: Callable | None = None,
    resume: ResponseCurve | None = None,
    throw: bool = True,
) -> ResponseCurve:
    """Return the curve of periodic responses from ``start`` to ``stop`` of a parameter, through its folds.

    parameter: "frequency" of the system's Motion or BodyMotion in Hz; "amplitude", a factor of its driving; or a
    function from the value to the system, then without ``system``. harmonics, samples, subharmonic, tolerance: as of
    ``solve_periodic``, which gives the response at ``start``, from the response ``first`` where there is one.
    step, max_step, min_step: along the curve, in units of the parameter's range and of the largest response so far: the
    first one, the longest, and the shortest that is tried. stability: whether to take the Floquet multipliers of each
    point, and to locate branch points, period doublings and Neimark-Sacker bifurcations, beside folds.
    accuracy: the error of each point (``errors``) that harmonics are raised for, up to max_harmonics, and lowered
    again; ``harmonics`` are then those of the start.
    output: response -> (m, S) or (S,), whose greatest and least are kept; by default the fields, each over all nodes.
    progress: called with (number of the point, value, share of the range that is left) after each point.
    resume: a curve of the same system and settings that was interrupted, or has max_points: it goes on as if it had not
    ended. KeyboardInterrupt ends a curve with a status, its points kept.
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
    flags(stability=stability, throw=throw)
    accuracy = None if accuracy is None else positive_number("accuracy", accuracy, "(of the largest response)")
    max_harmonics = whole_number("max_harmonics", max_harmonics, Nh if accuracy is not None else 1, MAX_COUNT)
    family = HarmonicFamily(build, Nh, Nt, nu)
    keep_freed_memory()
    with one_blas_thread(), np.errstate(all="ignore"):  # a diverging step is recognised by its size
        outputs = output or _fields
        trace = CurveTrace(family, ends, tolerance, outputs, progress, first, accuracy, max_harmonics, stability)
        if resume is not None:
            trace.points_and_state = _points_to_resume(resume, name, ends[0], stability)
        status, end = trace.follow(lengths, limit)
        curve = assemble_curve(family, name, *trace.points_and_state, status, end)
    return curve.or_raise(f"{ends[0]:g} to {ends[1]:g} {unit}; {trace.describe_end(end)}") if throw else curve


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


def _points_to_resume(curve, name, start, stability):
    """Return the points of a curve and its state. Raises InputError where it is of another kind, or has no points."""
    if not isinstance(curve, ResponseCurve) or curve.state is None:
        raise InputError("must be a ResponseCurve that has points", field="resume", value=curve)
    given = (name, start, bool(stability))
    if given != (curve.parameter, float(curve.values[0]), curve.multipliers is not None):
        problem = f"a curve over {curve.parameter} from {curve.values[0]:g} has other settings than these"
        raise InputError(problem, field="resume", value=curve)
    if curve.success:
        raise InputError("has reached its end", field="resume", value=curve)
    return list(curve.points), curve.state


def _are_inside(multipliers):
    """Return whether all multipliers of each point are inside the unit circle, (P,)."""
    return np.array([abs(each).max(initial=0.0) < 1.0 for each in multipliers], dtype=bool)


def _fields(response):
    """Return the greatest and least of each field over the nodes, (2 n_f, S)."""
    y = response.at(instants_of(response))
    return np.concatenate([y.max(axis=1), y.min(axis=1)])


def assemble_curve(family, name, points, state, status, end) -> ResponseCurve:
    """Return the ResponseCurve of CurvePoints."""
    column = lambda name: np.array([getattr(point, name) for point in points])
    harmonics = np.array([point.z.shape[-1] // 2 for point in points], dtype=int)
    z = np.array([resize_harmonics(point.z, harmonics.max()) for point in points])
    special_points = [each for point in points for each in point.special]
    of_motion = tuple(each for each in special_points if not each.doubt)
    of_series = tuple(each for each in special_points if each.doubt)
    multipliers = _arrays_of_points(points, "multipliers"), _arrays_of_points(points, "sideways")
    norm = points[-1].residual_norm if points else np.nan
    steps = sum(point.iterations for point in points)
    return ResponseCurve(
        name, column("value"), column("omega"), z, column("greatest"), column("least"), column("tangent"), harmonics,
        column("error"), of_motion, of_series, *multipliers, status, steps, norm, end, family, state,
        tuple(points))  # fmt: skip


def _arrays_of_points(points, name):
    """Return the arrays that points have under a name, or None where they have none."""
    return tuple(getattr(point, name) for point in points) if points and getattr(points[0], name) is not None else None
