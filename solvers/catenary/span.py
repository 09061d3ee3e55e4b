"""The elastic catenary of one mooring line, every regime: MSQS section 2 (Masciola, Jonkman, Robertson), eqs. 2.1-2.24.

``Span`` states the problem, ``solve_span`` solves it, ``solve_spans`` solves arrays of them. The equations are in
``regimes`` and ``suspended``. Lengths in m, forces in N; x horizontal and z up, from the anchor to the fairlead.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..common.outcome import InputError, Outcome, Status
from ..common.validation import as_array, flags, instance_of, real_number
from ..numerics.elementary import ARRAY, SCALAR
from .profile import profile
from .regimes import REGIMES, Regime
from .solve import INVALID_INPUT, STATUSES, solve, solve_batch, solve_one

TOLERANCE = 4 * np.finfo(float).eps  # of the relative residual; the closed forms lose two roundings
BLOCK = 8192  # rows solved together: the working set stays in the cache, whatever the number of lines


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

    >>> Span(w=698.094, EA=384.243e6, L=902.2, x=848.67, z=250.0).friction
    0.0
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
        flags(seabed=self.seabed)
        for name, bad, need in (
            ("L", self.L <= 0, "> 0"),
            ("EA", self.EA <= 0, "> 0"),
            ("x", self.x < 0, ">= 0: it is the horizontal distance from anchor to fairlead"),
            ("friction", self.friction < 0, ">= 0 (a height above the seabed is given as clearance)"),
            ("clearance", self.clearance < 0, ">= 0: the anchor cannot be below the seabed"),
        ):
            if bad:
                value, unit = getattr(self, name), _UNITS[name]
                raise InputError(f"{value:g} {unit} must be {need}", field=name, value=value, unit=unit)
        if self.seabed and self.w < 0:
            problem = f"{self.w:g} N/m, a buoyant line, cannot rest on a seabed: give seabed=False"
            raise InputError(problem, field="w", value=self.w, unit="N/m")
        if self.seabed and self.z < -self.clearance:
            raise InputError(
                f"z: {self.z:g} m puts the fairlead below the seabed, {self.clearance:g} m under the anchor: "
                "give clearance, swap the ends, or give seabed=False"
            )
        if not self.seabed and self.clearance > 0:
            problem = f"{self.clearance:g} m has no meaning with seabed=False"
            raise InputError(problem, field="clearance", value=self.clearance, unit="m")


_UNITS = {"w": "N/m", "EA": "N", "L": "m", "x": "m", "z": "m", "friction": "(dimensionless)", "clearance": "m"}


@dataclass(frozen=True, repr=False)
class CatenaryState(Outcome):
    """Solution of a span.

    H, V : components of the tension at the fairlead, N; V > 0 where the line hangs below it
    H_anchor, V_anchor : the same at the anchor, N; V_anchor < 0 where the line sags below it
    grounded_length : unstretched length on the seabed, m
    stiffness : (2, 2), d(H, V)/d(x, z) with the anchor fixed, N/m
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

    def describe(self):
        """Yield forces at the fairlead, and what lies on the seabed."""
        yield f"{self.regime.value}: T = {self.tension:.7g} N at the fairlead, H = {self.H:.7g} N, V = {self.V:.7g} N"
        yield f"{self.grounded_length:.5g} m of {self.span.L:g} m on the seabed"

    @property
    def tension(self) -> float:
        """Fairlead tension, N."""
        return math.hypot(self.H, self.V)

    def profile(self, s: ArrayLike) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return (x, z, tension) at unstretched arc length ``s`` from the anchor: (2.1), (2.5), (2.20), (2.22), (2.24).

        s : array (...), m, in [0, L]. Returns arrays of the same shape, m, m, N.
        Where the tension is zero the line's position is not determined: a slack line is spread evenly over the
        seabed between its vertical ends, a weightless one straight between them.
        Raises InputError if s leaves [0, L], ConvergenceError if the span was not solved.
        """
        self.or_raise(self.span)
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
        return np.array(STATUSES, dtype=object)[self.status_code]

    @property
    def regime(self) -> np.ndarray:
        """Regime of each row, object array (n,); without meaning where the input was refused."""
        return np.array(REGIMES, dtype=object)[self.regime_code]

    @property
    def success(self) -> np.ndarray:
        """True for the rows that can be used, (n,)."""
        return self.status_code == 0


def solve_span(span: Span, *, tolerance: float = TOLERANCE, throw: bool = True) -> CatenaryState:
    """Return the solution of one span; no guess is needed.

    tolerance : of residual_norm (default: round-off). Raises ConvergenceError unless throw is False, in which case the
    state carries the status and NaN. Every valid span has a solution; the ways to fail are friction under a line that
    touches the seabed between two raised ends, and inputs so extreme that doubles cannot carry the forces or the ratios
    between (x, z, clearance over L, friction, w L/EA above 1e40; EA/L above 1e308; 0 < |w| L < 1e-300 N).

    >>> state = solve_span(Span(w=698.094, EA=384.243e6, L=902.2, x=848.67, z=250.0))
    >>> round(state.H), round(state.V)  # N
    (736938, 535727)
    """
    instance_of("span", span, Span)
    tolerance = _bounded_tolerance(tolerance)
    flags(throw=throw)
    inputs = span.w, span.EA, span.L, span.x, span.z, span.seabed, span.friction, span.clearance
    *forces, regime, status, iterations, residual = solve(SCALAR, solve_one, *inputs, tolerance)
    stiffness = np.array(forces[5:]).reshape(2, 2)
    state = CatenaryState(span, *forces[:5], stiffness, REGIMES[regime], STATUSES[status], iterations, residual)  # type: ignore[call-arg]
    return state.or_raise(span) if throw else state


def solve_spans(
    w: ArrayLike,
    EA: ArrayLike,
    L: ArrayLike,
    x: ArrayLike,
    z: ArrayLike,
    seabed: ArrayLike = True,
    friction: ArrayLike = 0.0,
    clearance: ArrayLike = 0.0,
    *,
    tolerance: float = TOLERANCE,
) -> CatenaryBatch:
    """Return the solutions of n spans, row i bit for bit that of ``solve_span``.

    Arguments as in Span, scalars or arrays (n,), broadcast.

    A row with bad input or without solution gets its own status and NaN. Memory beyond inputs and results does not
    grow with n. Raises InputError for shapes that do not broadcast, more than one dimension, values that are not real.

    >>> batch = solve_spans(w=698.094, EA=384.243e6, L=902.2, x=[840.0, 848.67], z=250.0)
    >>> batch.H.round(-3).tolist(), batch.success.all().item()  # N
    ([547000.0, 737000.0], True)
    """
    tolerance = _bounded_tolerance(tolerance)
    columns = _columns(w=w, EA=EA, L=L, x=x, z=z, seabed=seabed, friction=friction, clearance=clearance)
    n = columns[0].size
    forces, stiffness = np.full((5, n), np.nan), np.full((n, 4), np.nan)
    regime, status = np.zeros(n, dtype=np.int8), np.full(n, INVALID_INPUT, dtype=np.int8)
    iterations, residual = np.zeros(n, dtype=np.int16), np.full(n, np.nan)
    columns_out = [*forces, *stiffness.T, regime, status, iterations, residual]
    with np.errstate(all="ignore"):  # both sides of every np.where are computed, the unused one may overflow
        for first in range(0, n, BLOCK):
            block = [column[first : first + BLOCK] for column in columns]
            rows = np.flatnonzero(_valid_rows(*block))
            solved = solve(ARRAY, solve_batch, *(column[rows] for column in block), tolerance)  # type: ignore[call-arg]
            for column, values in zip(columns_out, solved, strict=True):
                column[first + rows] = values
    return CatenaryBatch(*forces, stiffness.reshape(n, 2, 2), regime, status, iterations, residual)  # type: ignore[call-arg]


def span_arrays(w, EA, L, x, z, seabed, friction, clearance, tolerance=TOLERANCE):
    """Return the results of spans whose input a caller has checked: arrays (n,), one block.

    H, V, H_anchor, V_anchor, grounded_length, (K11, K12, K21, K22), regime, status (indices into REGIMES and STATUSES),
    iterations
    """
    with np.errstate(all="ignore"):
        solved = solve(ARRAY, solve_batch, w, EA, L, x, z, seabed, friction, clearance, tolerance)
    return *solved[:5], solved[5:9], solved[9], solved[10], solved[11]


def _bounded_tolerance(tolerance) -> float:
    """Return the tolerance, no smaller than TOLERANCE; raises InputError outside (0, 1)."""
    value = real_number("tolerance", tolerance, "dimensionless")
    if not 0 < value < 1:
        problem = f"{tolerance!r} (dimensionless) must lie in (0, 1)"
        raise InputError(problem, field="tolerance", value=tolerance, unit="(dimensionless)")
    return max(value, TOLERANCE)


def _columns(**arguments) -> list[np.ndarray]:
    """Return the arguments as float (seabed: bool) arrays of one shape (n,)."""
    columns = {}
    for name, value in arguments.items():
        if np.ma.is_masked(value):
            raise InputError(f"{name}: has masked elements; leave them out, or fill them")
        try:
            column = as_array(value)
        except ValueError:
            why = f"{name}: rows of different lengths, or masked elements"
            raise InputError(f"{why}; it must be of shape () or (n,)") from None
        kinds, wanted = ("b", "True or False") if name == "seabed" else ("iuf", f"real numbers ({_UNITS[name]})")
        if column.dtype.kind not in kinds and column.size:
            raise InputError(f"{name}: values of type {column.dtype} must be {wanted}")
        if column.ndim > 1:
            raise InputError(f"{name}: shape {column.shape} must be () or (n,)")
        columns[name] = column.astype(bool if name == "seabed" else float, copy=False)
    try:
        return list(np.broadcast_arrays(np.empty(1), *columns.values()))[1:]
    except ValueError:
        shapes = ", ".join(f"{name} {column.shape}" for name, column in columns.items() if column.ndim)
        raise InputError(f"the shapes of the arguments do not broadcast to one (n,): {shapes}") from None


def _valid_rows(w, EA, L, x, z, seabed, friction, clearance):
    """Return whether each row obeys the rules of Span, (n,) bool."""
    finite = np.logical_and.reduce([np.isfinite(v) for v in (w, EA, L, x, z, friction, clearance)])
    signs = (L > 0) & (EA > 0) & (x >= 0) & (friction >= 0) & (clearance >= 0)
    return finite & signs & np.where(seabed, (w >= 0) & (z >= -clearance), clearance == 0)
