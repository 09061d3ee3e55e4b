"""The elastic catenary of one mooring line, every regime: MSQS section 2 (Masciola, Jonkman, Robertson), eqs. 2.1-2.24.

``Span`` states the problem, ``solve_span`` solves it, ``solve_spans`` solves arrays of them; the equations are in
``catenary_regimes``. Lengths in m, forces in N; x horizontal and z up, from the anchor to the fairlead.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from enum import Enum

import numpy as np

from . import catenary_regimes as regimes
from .catenary_profile import profile
from .catenary_regimes import LARGEST, LOWEST, MASSLESS, NARROWEST, STIFFEST, TINY
from .elementary import ARRAY, SCALAR
from .newton import monotone_root, monotone_roots
from .outcome import InputError, Outcome, Status
from .properties import real_number

TOLERANCE = 4 * np.finfo(float).eps  # of the relative residual; two roundings are lost in the closed forms
BLOCK = 8192  # rows solved together: the working set stays in the cache, whatever the number of lines


class Regime(Enum):
    """Which closed form holds."""

    SUSPENDED = "suspended between its ends"
    STEEP = "suspended, stretched along its whole length and steep"
    GROUNDED = "resting on the seabed from the anchor on"
    SAGGING = "resting on the seabed between two raised ends"
    SLACK = "hanging straight down to the seabed, without horizontal force"
    LYING = "stretched along the seabed"
    VERTICAL = "vertical, or folded over without horizontal force"
    MASSLESS = "a straight spring"


REGIMES, _STATUSES = tuple(Regime), tuple(Status)
_SUSPENDED, _STEEP, _GROUNDED, _SAGGING, _SLACK, _LYING, _VERTICAL, _MASSLESS = range(len(REGIMES))
_SUCCESS, _INVALID_INPUT, _NOT_CONVERGED, _FRICTION_UNDETERMINED, _NOT_FINITE = range(len(_STATUSES))


@dataclass(frozen=True, slots=True)
class Span:
    """One line between two ends.

    w : submerged weight per unstretched length, N/m (negative: buoyant; zero: a straight spring)
    EA : axial stiffness, N, > 0
    L : unstretched length, m, > 0
    x, z : horizontal (>= 0) and vertical distance from anchor to fairlead, m
    seabed : a flat seabed carries the line; then w >= 0 and no end below it
    friction : coefficient CB of the seabed, >= 0; the tension falls by CB w per metre towards the anchor (2.15)
    clearance : height of the anchor above the seabed, m, >= 0

    Raises InputError naming the field, its value and its unit.
    """

    w: float
    EA: float
    L: float
    x: float
    z: float
    seabed: bool = True
    friction: float = 0.0
    clearance: float = 0.0

    def __post_init__(self):
        for name, unit in _UNITS.items():
            object.__setattr__(self, name, real_number(name, getattr(self, name), unit))
        if not isinstance(self.seabed, (bool, np.bool_)):
            raise InputError(f"seabed: {self.seabed!r} must be True or False")
        for name, bad, need in (
            ("L", self.L <= 0, "> 0"),
            ("EA", self.EA <= 0, "> 0"),
            ("x", self.x < 0, ">= 0: it is the horizontal distance from anchor to fairlead"),
            ("friction", self.friction < 0, ">= 0 (a height above the seabed is given as clearance)"),
            ("clearance", self.clearance < 0, ">= 0: the anchor cannot be below the seabed"),
        ):
            if bad:
                raise InputError(f"{name}: {getattr(self, name):g} {_UNITS[name]} must be {need}")
        if self.seabed and self.w < 0:
            raise InputError(f"w: {self.w:g} N/m, a buoyant line, cannot rest on a seabed: give seabed=False")
        if self.seabed and self.z < -self.clearance:
            raise InputError(
                f"z: {self.z:g} m puts the fairlead below the seabed, {self.clearance:g} m under the anchor: "
                "give clearance, swap the ends, or give seabed=False"
            )
        if not self.seabed and self.clearance > 0:
            raise InputError(f"clearance: {self.clearance:g} m has no meaning with seabed=False")


_UNITS = {"w": "N/m", "EA": "N", "L": "m", "x": "m", "z": "m", "friction": "(dimensionless)", "clearance": "m"}


@dataclass(frozen=True)
class CatenaryState(Outcome):
    """Solution of a span.

    H, V : components of the tension at the fairlead, N; V > 0 where the line hangs below it
    H_anchor, V_anchor : the same at the anchor, N; V_anchor < 0 where the line sags below it
    grounded_length : unstretched length on the seabed, m
    stiffness : (2, 2), d(H, V)/d(x, z) with the anchor held, N/m
    regime : Regime
    status, iterations, residual_norm : Status; function evaluations; error of x over max(x, L) at the last iterate
        (suspended: over x)
    """

    span: Span
    H: float
    V: float
    H_anchor: float
    V_anchor: float
    grounded_length: float
    stiffness: np.ndarray
    regime: Regime
    status: Status
    iterations: int
    residual_norm: float

    @property
    def tension(self) -> float:
        """Fairlead tension, N."""
        return math.hypot(self.H, self.V)

    def profile(self, s) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Position and tension at unstretched arc length ``s`` from the anchor: (2.1), (2.5), (2.20), (2.22), (2.24).

        s : array (...), m, in [0, L]. Returns (x, z, tension), arrays of the same shape, m, m, N.
        Where the tension is zero the line's place is not determined: a slack line is spread evenly over the seabed
        between its vertical ends, a weightless one straight between them.
        Raises InputError if s leaves [0, L], ConvergenceError if the span was not solved.
        """
        self.or_throw(self.span)
        return profile(self, s)


@dataclass(frozen=True)
class CatenaryBatch:
    """Solutions of n spans: fields of CatenaryState as arrays (n,), stiffness (n, 2, 2); NaN in rows that failed."""

    H: np.ndarray
    V: np.ndarray
    H_anchor: np.ndarray
    V_anchor: np.ndarray
    grounded_length: np.ndarray
    stiffness: np.ndarray
    regime_code: np.ndarray
    status_code: np.ndarray
    iterations: np.ndarray
    residual_norm: np.ndarray

    @property
    def status(self) -> np.ndarray:
        """Status of each row, object array (n,)."""
        return np.array(_STATUSES, dtype=object)[self.status_code]

    @property
    def regime(self) -> np.ndarray:
        """Regime of each row, object array (n,); without meaning where the input was refused."""
        return np.array(REGIMES, dtype=object)[self.regime_code]

    @property
    def success(self) -> np.ndarray:
        """True for the rows that can be used, (n,)."""
        return self.status_code == 0


def solve_span(span: Span, *, tolerance: float = TOLERANCE, throw: bool = True) -> CatenaryState:
    """Solve one span from no guess.

    tolerance : of residual_norm (default: round-off). Raises ConvergenceError unless throw is False, in which case the
    state carries the status and NaN. Every valid span has a solution; the two ways to fail are friction under a line
    that touches the seabed between two raised ends, and forces beyond 1e308 N.
    """
    if not isinstance(span, Span):
        raise InputError(f"span: {span!r} is not a solvers.Span")
    if not 0 < tolerance < 1:
        raise InputError(f"tolerance: {tolerance!r} (dimensionless) must lie in (0, 1)")
    inputs = span.w, span.EA, span.L, span.x, span.z, span.seabed, span.friction, span.clearance
    *forces, regime, status, iterations, residual = _solve(SCALAR, _one, *inputs, max(tolerance, TOLERANCE))
    stiffness = np.array(forces[5:]).reshape(2, 2)
    state = CatenaryState(span, *forces[:5], stiffness, REGIMES[regime], _STATUSES[status], iterations, residual)
    return state.or_throw(span) if throw else state


def solve_spans(w, EA, L, x, z, seabed=True, friction=0.0, clearance=0.0, *, tolerance=TOLERANCE) -> CatenaryBatch:
    """Solve n spans; arguments as in Span, scalars or arrays (n,), broadcast. Row i equals solve_span bit for bit.

    A row with bad input or without solution gets its own status and NaN. Memory beyond inputs and results does not
    grow with n. Raises InputError for shapes that do not broadcast, more than one dimension, values that are not real.
    """
    if not 0 < tolerance < 1:
        raise InputError(f"tolerance: {tolerance!r} (dimensionless) must lie in (0, 1)")
    names = [field.name for field in fields(Span)]
    columns = _columns(dict(zip(names, (w, EA, L, x, z, seabed, friction, clearance), strict=True)))
    n = columns[0].size
    result = [np.full(n, np.nan) for _ in range(9)]
    codes = [np.zeros(n, dtype=np.int8), np.full(n, _INVALID_INPUT, dtype=np.int8)]
    result += [*codes, np.zeros(n, dtype=np.int16), np.full(n, np.nan)]
    with np.errstate(all="ignore"):  # both sides of every np.where are computed, the unused one may overflow
        for first in range(0, n, BLOCK):
            block = [column[first : first + BLOCK] for column in columns]
            rows = np.flatnonzero(_valid(*block))
            solved = _solve(ARRAY, _many, *(column[rows] for column in block), max(tolerance, TOLERANCE))
            for target, values in zip(result, solved, strict=True):
                target[first + rows] = values
    return CatenaryBatch(*result[:5], np.stack(result[5:9], axis=-1).reshape(n, 2, 2), *result[9:])


def span_arrays(w, EA, L, x, z, seabed, friction, clearance, tolerance=TOLERANCE):
    """solve_spans without its checks, for a caller that has made them: arrays (n,), one block.

    Returns H, V, H_anchor, V_anchor, grounded_length, (K11, K12, K21, K22), regime (index into REGIMES), status (0: solved).
    """
    with np.errstate(all="ignore"):
        solved = _solve(ARRAY, _many, w, EA, L, x, z, seabed, friction, clearance, tolerance)
    return *solved[:5], solved[5:9], solved[9], solved[10]


def _columns(arguments) -> list[np.ndarray]:
    """The arguments as float (seabed: bool) arrays of one shape (n,)."""
    columns = {}
    for name, value in arguments.items():
        column = np.asarray(value)
        kinds, wanted = ("b", "True or False") if name == "seabed" else ("iuf", f"real numbers ({_UNITS[name]})")
        if column.dtype.kind not in kinds and column.size:
            raise InputError(f"{name}: values of type {column.dtype} must be {wanted}")
        if column.ndim > 1:
            raise InputError(f"{name}: shape {column.shape} must be () or (n,)")
        columns[name] = column.astype(bool if name == "seabed" else float)
    try:
        return list(np.broadcast_arrays(np.empty(1), *columns.values()))[1:]
    except ValueError:
        shapes = ", ".join(f"{name} {column.shape}" for name, column in columns.items() if column.ndim)
        raise InputError(f"the shapes of the arguments do not broadcast to one (n,): {shapes}") from None


def _valid(w, EA, L, x, z, seabed, friction, clearance):
    """The rules of Span, row by row."""
    finite = np.isfinite(w) & np.isfinite(EA) & np.isfinite(L + x + z) & np.isfinite(friction + clearance)
    signs = (L > 0) & (EA > 0) & (x >= 0) & (friction >= 0) & (clearance >= 0)
    return finite & signs & np.where(seabed, (w >= 0) & (z >= -clearance), clearance == 0)


# ---------------------------------------------------------------- one text for a span (floats) and for many (arrays)
def _solve(f, run, w, EA, L, x, z, seabed, CB, clearance, tolerance):
    """(H, V, H_anchor, V_anchor, grounded_length, K11, K12, K21, K22, regime, status, iterations, residual)."""
    up = f.where(w < 0, -1.0, 1.0)  # a buoyant line is the mirror image of a heavy one
    weight = up * w * L
    l, c, e = x / L, f.where(clearance > LOWEST * L, clearance / L, 0.0), f.maximum(weight / EA, STIFFEST)
    h = f.where(seabed, f.maximum(z / L, -c), up * z / L)
    beyond = (l > LARGEST) | (abs(h) > LARGEST) | (c > LARGEST) | (CB > LARGEST) | (e > LARGEST) | (EA / L == math.inf)
    massless = (weight < TINY) | beyond  # where beyond, only to give it a kernel that cannot fail
    columns = l, h, e, CB, c
    regime = _classify(f, *columns, seabed, massless)
    solved = run(regime, columns, tolerance)
    touching = seabed & (c > 0) & (regime <= _STEEP) & (regimes.lowest_point(f, solved[:5], e) > c)
    if f.any(touching):
        regime = f.where(touching, _SAGGING, regime)
        solved = run(regime, columns, tolerance, solved, touching)
    H, V, H_anchor, V_anchor, grounded, K11, K12, K21, K22, iterations, residual, converged = solved
    unit = f.where(regime == _MASSLESS, EA, weight)
    status = f.where(converged, _SUCCESS, _NOT_CONVERGED)
    status = f.where(beyond | (abs(H * unit) + abs(V * unit) == math.inf), _NOT_FINITE, status)
    status = f.where((regime == _SAGGING) & (CB > 0), _FRICTION_UNDETERMINED, status)
    force = unit * f.where(status == _SUCCESS, 1.0, math.nan)
    lift, stiff, turn = up * force, force / L, up * force / L
    forces = force * H, lift * V, force * H_anchor, lift * V_anchor, f.where(status == _SUCCESS, L * grounded, math.nan)
    return *forces, stiff * K11, turn * K12, turn * K21, stiff * K22, regime, status, iterations, residual


def _classify(f, l, h, e, CB, c, seabed, massless):
    """Regime of each span; a line over a raised anchor is taken as suspended until its lowest point is known."""
    chord = f.sqrt(l * l + h * h)
    over = f.where(seabed, h + c, 0.0)
    slack = seabed & (1 - regimes.hanging_length(f, over, e) - regimes.hanging_length(f, c, e) >= l)
    # just touching: V = wL, so H = (1 - k^2)/2k from (2.23b) with k = h - e/2, and l from (2.23a)
    k = h - e / 2
    H = f.where(k > 0, (1 - k * k) / f.where(k > 0, 2 * k, 1.0), 1.0)
    rests = (k <= 0) | ((k < 1) & (l <= H * (f.arcsinh(1 / f.where(k < 1, H, 1.0)) + e)))
    regime = f.where(h > 1 + e / 2, _STEEP, f.where(h < -1 - e / 2, _STEEP, _SUSPENDED))
    regime = f.where((e < MASSLESS) & (chord > 1), _MASSLESS, regime)
    regime = f.where(seabed & (c == 0) & rests, f.where(h > LOWEST, _GROUNDED, _LYING), regime)
    regime = f.where(l < NARROWEST * (1 + abs(h)), _VERTICAL, regime)
    return f.where(massless, _MASSLESS, f.where(slack, _SLACK, regime))


def _one(regime, columns, tolerance, *_):
    return _KERNELS[regime](SCALAR, monotone_root, *columns, tolerance)


def _many(regime, columns, tolerance, solved=None, only=True):
    """Regime by regime: gather the rows, solve them, put the results in place."""
    if solved is None:
        solved = [np.empty(regime.size) for _ in range(9)]
        solved += [np.empty(regime.size, dtype=int), np.empty(regime.size), np.empty(regime.size, dtype=bool)]
    for code, kernel in enumerate(_KERNELS):
        rows = np.flatnonzero((regime == code) & only)
        if rows.size:
            values = kernel(ARRAY, monotone_roots, *(column[rows] for column in columns), tolerance)
            for target, value in zip(solved, values, strict=True):
                target[rows] = value
    return solved


def _result(state, iterations=0, residual=0.0, converged=True):
    forces, stiffness = state
    return *forces, *stiffness, iterations, residual, converged


def _suspended(f, root, l, h, e, CB, c, tolerance):
    start, upper = regimes.suspended_start(f, l, abs(h), e)
    y, *count = root(regimes.suspended_residual, start, upper, (l, abs(h), e), tolerance)
    return _result(regimes.suspended_state(f, y, l, h, e), *count)


def _steep(f, root, l, h, e, CB, c, tolerance):
    start, upper = regimes.steep_start(f, l, abs(h), e)
    t, *count = root(regimes.steep_residual, start, upper, (l, abs(h), e), tolerance)
    return _result(regimes.steep_state(f, t, l, h, e), *count)


def _grounded(f, root, l, h, e, CB, c, tolerance):
    start, upper = regimes.grounded_start(f, l, h, e, CB)
    p, *count = root(regimes.grounded_residual, start, upper, (l, h, e, CB), tolerance)
    return _result(regimes.grounded_state(f, p, l, h, e, CB), *count)


def _sagging(f, root, l, h, e, CB, c, tolerance):
    high, low, none = f.maximum(h + c, c), f.minimum(h + c, c), 0 * CB
    start, upper = regimes.grounded_start(f, l, high, e, none, low)
    p, *count = root(regimes.grounded_residual, start, upper, (l, high, e, none, low), tolerance)
    return _result(regimes.grounded_state(f, p, l, high, e, none, low, h < 0), *count)


def _slack(f, root, l, h, e, CB, c, tolerance):
    return _result(regimes.slack_state(f, h, e, c))


def _lying(f, root, l, h, e, CB, c, tolerance):
    return _result(regimes.lying_state(f, l, e, CB))


def _vertical(f, root, l, h, e, CB, c, tolerance):
    return _result(regimes.vertical_state(f, h, e))


def _massless(f, root, l, h, e, CB, c, tolerance):
    return _result(regimes.massless_state(f, l, h))


_KERNELS = (_suspended, _steep, _grounded, _sagging, _slack, _lying, _vertical, _massless)
