"""Local stability of a periodic response: its Floquet multipliers by two methods, and their difference.

Of a chain of first-order rows: the dense monodromy matrix (``monodromy``) and Hill's dense problem (``hill``). Of
lines of nodes and elements: the leading eigenvalues of the linearised period, which is a function and no matrix
(``leading``), and Hill's problem by shift and invert; over slack cells the time steps themselves are linearised.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import linear_sum_assignment

from ...common.outcome import InputError
from ...common.validation import flags, one_of, positive_number, whole_number
from .hill import MAX_GROWTH, hill_exponents, line_multipliers
from .leading import FLOOR, largest_first, leading_eigenvalues
from .monodromy import GAUSS, RADAU, monodromy

MAX_UNKNOWNS = 600  # of a chain, or of its harmonic balance, in dense matrices
MAX_STEPS = 10**6
SCHEMES = {"radau": RADAU, "gauss": GAUSS}
ABOVE = 1.1  # times the least size, from which on a multiplier of Hill's problem has its counterpart in the monodromy's
NEAREST = 0.5  # of the smallest multiplier, from which on those of half as many steps are taken to compare with it
NOT_PERIODIC = (
    "the time steps repeat no motion of this period near the response, whose own multipliers these are: over slack "
    "cells they are not to be trusted; take other steps, or internal damping of the line"
)


@dataclass(frozen=True)
class FloquetResult:
    """Multipliers (m,), largest first, complex; by the monodromy where it was asked for, else by Hill.

    Of a line with more than ``leading.MAX_DENSE`` disturbances all from the ``least_size`` on, each to a residual of
    ``leading.TOLERANCE``; in any case the largest, and some that follow it, to ``leading.RELATIVE`` of their size.
    hill: those of Hill's problem, of a chain (m,) in the same order, of a line those (h,) whose series is long enough;
    difference: largest distance between the two, which estimates the error of the worse of them. Both are None with one
    method alone, or where Hill has none; the difference also where all of Hill's are next to the least size.
    constraints: how many multipliers of 1 were taken out that belong to rows which prescribe velocities, not positions.
    sideways (k,): of disturbances across the vertical plane of a line whose motion lies in it, else None.
    step_errors (m,): of a line, the distance of each multiplier from the nearest one of half as many steps; large ones
    belong to waves that the steps do not resolve.
    by_time_steps: whether the time steps were linearised, about the motion that they repeat. warnings: what to doubt.
    """

    multipliers: np.ndarray
    period: float
    constraints: int
    hill: np.ndarray | None = field(repr=False, default=None)
    difference: float | None = None
    sideways: np.ndarray | None = field(repr=False, default=None)
    step_errors: np.ndarray | None = field(repr=False, default=None)
    by_time_steps: bool = False
    warnings: tuple[str, ...] = ()

    @property
    def stable(self) -> bool:
        """True if every multiplier, sideways too, is less than one in size: small disturbances decay."""
        largest = (abs(part).max(initial=0.0) for part in (self.multipliers, self.sideways) if part is not None)
        return bool(max(largest) < 1.0)

    @property
    def exponents(self) -> np.ndarray:
        """Floquet exponents (m,), log(multiplier)/T, 1/s, whose real parts are rates of growth: -inf of a zero."""
        with np.errstate(divide="ignore"):
            return np.log(self.multipliers.astype(complex)) / self.period


def floquet(
    response,
    *,
    method: str = "both",
    steps: int = 200,
    scheme: str = "radau",
    out_of_plane: bool = True,
    has_step_errors: bool = True,
    least_size: float = FLOOR,
) -> FloquetResult:
    """Return the Floquet multipliers of a PeriodicResponse, and whether it is stable.

    method: "monodromy", "hill" or "both"; "steps" linearises the time steps of a line of nodes and elements about the
    motion that they repeat, which the others do, too, where a cell goes slack in the response. steps: of the time
    integration in the period. scheme: "radau" damps waves that the steps do not resolve, "gauss", of lines alone, does
    not: then all of a long line's waves are returned. out_of_plane: of a line in its vertical plane the sideways
    multipliers as well. has_step_errors: of a line, whether to take half as many steps, too, for ``step_errors``.
    least_size: below 1, of the multipliers of a line that are wanted. What a period damps to a tenth decides nothing,
    and with 0.1 the work is linear in the cells also of a fine mesh, which has many such waves alike.
    Hill's problem takes the harmonics of the response. Of a chain both work with dense matrices, for up to
    ``MAX_UNKNOWNS`` unknowns.
    Raises InputError for bad options, and for a chain that is too long.
    """
    steps = whole_number("steps", steps, 1, MAX_STEPS)
    if not hasattr(response, "system"):
        problem = f"{type(response).__name__} is no PeriodicResponse: give what solve_periodic returns of it"
        raise InputError(problem, field="response", value=response)
    one_of("scheme", scheme, tuple(SCHEMES))
    flags(out_of_plane=out_of_plane, has_step_errors=has_step_errors)
    if positive_number("least_size", least_size, "(of a multiplier)") >= 1:
        problem = f"{least_size:g} must be < 1: multipliers that grow are always wanted"
        raise InputError(problem, field="least_size", value=least_size)
    if hasattr(response, "linearised_period"):
        one_of("method", method, ("both", "monodromy", "hill", "steps"))
        return _of_line(response, method, steps, SCHEMES[scheme], out_of_plane, has_step_errors, least_size)
    one_of("method", method, ("both", "monodromy", "hill"))
    return _of_chain(response, method, steps)


# ---------------------------------------------------------------- lines of nodes and elements
def _of_line(response, method, steps, scheme, out_of_plane, has_step_errors, least_size):
    """Return the FloquetResult of a response of lines of nodes and elements."""
    (_, period), omega = response.last_period, response.basis.omega
    if method == "hill":
        return FloquetResult(line_multipliers(response.hill_problem(), omega, least_size), period, 0)
    is_plane = out_of_plane and len(response.system.fields) == 2
    leading = lambda linearised: leading_eigenvalues(linearised, least_size).values
    linearised = response.linearised_period(steps, scheme)
    warnings: tuple[str, ...] = ()
    if method == "steps" or linearised.has_slack:
        orbit = response.stepped_orbit(steps)
        if orbit.is_periodic:
            sideways = leading(orbit.linearised(sideways=True)) if is_plane else None
            return FloquetResult(leading(orbit.linearised()), period, 0, sideways=sideways, by_time_steps=True)
        warnings = (NOT_PERIODIC,)
    multipliers = leading(linearised)
    del linearised  # its factors
    step_errors = None
    if has_step_errors:
        coarser = response.linearised_period(max(1, steps // 2), scheme)
        known = leading_eigenvalues(coarser, NEAREST * abs(multipliers).min()).values
        step_errors = _distances(multipliers, known)
    sideways = leading(response.linearised_period(steps, scheme, sideways=True)) if is_plane else None
    hill = difference = None
    if method == "both" and not warnings:
        hill, difference = _compare_hill(response, multipliers, least_size)
    return FloquetResult(multipliers, period, 0, hill, difference, sideways, step_errors, False, warnings)


def _compare_hill(response, multipliers, least_size):
    """Return the multipliers of Hill's problem of a line and their largest distance from others, or None for each."""
    hill = line_multipliers(response.hill_problem(), response.basis.omega, least_size)
    clear = hill[abs(hill) >= ABOVE * least_size]
    difference = float(_distances(clear, multipliers).max()) if clear.size else None
    return (hill if hill.size else None), difference


def _distances(values, others):
    """Return the distance of each of several multipliers from the nearest of the others."""
    return abs(values[:, None] - others).min(axis=1)


# ---------------------------------------------------------------- chains of first-order rows
def _of_chain(response, method, steps):
    """Return the FloquetResult of a response of a chain, by dense matrices."""
    system = response.system
    size = len(system.fields) * system.nodes * (1 if method == "monodromy" else response.basis.harmonic.size)
    if size > MAX_UNKNOWNS:
        problem = f"{size} unknowns are more than {MAX_UNKNOWNS}; take fewer nodes or harmonics, or the monodromy alone"
        raise InputError(problem, field="response", value=response)
    drift = system.drift(system.rest_state(), 0.0) if hasattr(system, "drift") else None
    constraints = 0 if drift is None else len(drift)
    period = response.last_period[1]
    by_hill: np.ndarray | None = None
    warnings: tuple[str, ...] = ()
    if method != "monodromy":
        mu = hill_exponents(response)
        is_algebraic = mu.real > MAX_GROWTH * response.basis.omega
        by_hill = np.exp(mu[~is_algebraic] * period)
        if is_algebraic.any():
            warnings = (f"{is_algebraic.sum()} exponents of Hill's problem are too large for any but algebraic rows",)
    if method == "hill":
        return FloquetResult(largest_first(by_hill), period, constraints, warnings=warnings)
    multipliers = largest_first(np.linalg.eigvals(monodromy(response, steps)))
    for _ in range(constraints):
        multipliers = np.delete(multipliers, np.argmin(abs(multipliers - 1)))
    if by_hill is None:
        return FloquetResult(multipliers, period, constraints)
    multipliers = multipliers[: by_hill.size]
    distance = abs(multipliers[:, None] - by_hill)
    pairs = linear_sum_assignment(distance)
    difference = float(distance[pairs].max(initial=0.0))
    return FloquetResult(multipliers, period, constraints, by_hill[pairs[1]], difference, warnings=warnings)
