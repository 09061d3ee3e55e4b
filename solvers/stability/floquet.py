"""Local stability of a periodic response: Floquet multipliers of a chain by two roads, and their difference.

Monodromy: the linearised chain dF/dydot d' + dF/dy d = 0 is integrated over one period by Radau IIA of order five
(Hairer, Wanner, Solving Ordinary Differential Equations II, 1996, IV.5), which takes algebraic rows as they are. A line
of nodes and elements has none and takes Gauss's scheme of order six (ibid.): its axial waves are too fast for any step,
and this scheme does not damp what it does not resolve.
Hill: d(t) = exp(mu t) times a series with the harmonics of the response makes the Jacobian J of the harmonic balance
J + mu D, D that of the rates alone. Of the mu of a multiplier exp(mu T) that with the most central series counts.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from scipy.linalg import eig
from scipy.optimize import linear_sum_assignment

from ..common.outcome import InputError
from ..common.validation import one_of, whole_number
from ..harmonic_balance.residual import HarmonicResidual


class Scheme(NamedTuple):
    """An implicit Runge-Kutta scheme of three stages: nodes (3,), weights (3, 3) of stages, last (3,) of the step."""

    nodes: np.ndarray
    weights: np.ndarray
    last: np.ndarray


def _radau() -> Scheme:
    """Return Radau IIA, order five, whose last stage is the end of the step."""
    r = np.sqrt(6.0)
    weights = np.array([
        [(88 - 7 * r) / 360, (296 - 169 * r) / 1800, (-2 + 3 * r) / 225],
        [(296 + 169 * r) / 1800, (88 + 7 * r) / 360, (-2 - 3 * r) / 225],
        [(16 - r) / 36, (16 + r) / 36, 1 / 9],
    ])  # fmt: skip
    return Scheme(np.array([(4 - r) / 10, (4 + r) / 10, 1.0]), weights, weights[-1])


def _gauss() -> Scheme:
    """Return Gauss's scheme, order six, which damps no wave however short."""
    r = np.sqrt(15.0)
    weights = np.array([
        [5 / 36, 2 / 9 - r / 15, 5 / 36 - r / 30],
        [5 / 36 + r / 24, 2 / 9, 5 / 36 - r / 24],
        [5 / 36 + r / 30, 2 / 9 + r / 15, 5 / 36],
    ])  # fmt: skip
    return Scheme(np.array([0.5 - r / 10, 0.5, 0.5 + r / 10]), weights, np.array([5 / 18, 4 / 9, 5 / 18]))


RADAU, GAUSS = _radau(), _gauss()
MAX_UNKNOWNS = 600  # of a chain, or of its harmonic balance, in dense matrices
MAX_STEPS = 10**6
INFINITE = 1e8  # times the frequency, a Hill exponent of an algebraic row that rounding made finite
EDGE = 1e-6  # the bounds of a mean harmonic are moved so far: of a negative multiplier, with 1/2 and -1/2, one counts


@dataclass(frozen=True)
class FloquetResult:
    """Multipliers (m,), largest first, complex; by the monodromy matrix where it was asked for, else by Hill.

    hill (m,): those of Hill's problem in the same order; difference: largest distance between the two, which estimates
    the error of the worse of them, infinite (and hill None) where Hill's overflow. Both are None with one method alone.
    constraints: how many multipliers of 1 were taken out that belong to rows which prescribe velocities, not positions.
    """

    multipliers: np.ndarray
    period: float
    constraints: int
    hill: np.ndarray | None = field(repr=False, default=None)
    difference: float | None = None

    @property
    def stable(self) -> bool:
        """True if every multiplier is less than one in size: small disturbances decay."""
        return bool(abs(self.multipliers).max(initial=0.0) < 1.0)

    @property
    def exponents(self) -> np.ndarray:
        """Floquet exponents (m,), log(multiplier)/T, 1/s, whose real parts are rates of growth: -inf of a zero."""
        with np.errstate(divide="ignore"):
            return np.log(self.multipliers.astype(complex)) / self.period


def floquet(response, *, method: str = "both", steps: int = 200) -> FloquetResult:
    """Return the Floquet multipliers of a PeriodicResponse, and whether it is stable.

    method: "monodromy", "hill" or "both", which of a line of nodes and elements is the monodromy alone. steps: of the
    time integration in the period. Hill's problem takes the harmonics of the response. Both work with dense matrices,
    for up to ``MAX_UNKNOWNS`` unknowns. Where cells go slack, few harmonics give multipliers that are far too large.
    Raises InputError for bad options, and for a chain that is too long.
    """
    one_of("method", method, ("both", "monodromy", "hill"))
    steps = whole_number("steps", steps, 1, MAX_STEPS)
    if not hasattr(response, "system"):
        problem = f"{type(response).__name__} is no PeriodicResponse: give what solve_periodic returns of it"
        raise InputError(problem, field="response", value=response)
    system = response.system
    if hasattr(response, "linearised_at"):  # a line of nodes and elements
        if method == "hill":
            problem = "'hill' takes chains of first-order rows; of a line of nodes and elements take 'monodromy'"
            raise InputError(problem, field="method", value=method)
        method = "monodromy"
    size = len(system.fields) * system.nodes * (1 if method == "monodromy" else response.basis.harmonic.size)
    if size > MAX_UNKNOWNS:
        problem = f"{size} unknowns are more than {MAX_UNKNOWNS}; take fewer nodes or harmonics, or the monodromy alone"
        raise InputError(problem, field="response", value=response)
    drift = system.drift(system.rest_state(), 0.0) if hasattr(system, "drift") else None
    constraints = 0 if drift is None else len(drift)
    period = response.last_period[1]
    with np.errstate(over="ignore"):
        by_hill = None if method == "monodromy" else np.exp(hill_exponents(response) * period)
    is_finite = by_hill is not None and bool(np.isfinite(by_hill).all())
    if method == "hill":
        if not is_finite:
            problem = "'hill' gives multipliers beyond all numbers: take more harmonics, or 'monodromy'"
            raise InputError(problem, field="method", value=method)
        return FloquetResult(_largest_first(by_hill), period, constraints)
    multipliers = _largest_first(np.linalg.eigvals(monodromy(response, steps)))
    for _ in range(constraints):
        multipliers = np.delete(multipliers, np.argmin(abs(multipliers - 1)))
    if by_hill is None or not is_finite:
        return FloquetResult(multipliers, period, constraints, None, None if by_hill is None else float("inf"))
    multipliers = multipliers[: by_hill.size]
    distance = abs(multipliers[:, None] - by_hill)
    pairs = linear_sum_assignment(distance)
    return FloquetResult(multipliers, period, constraints, by_hill[pairs[1]], float(distance[pairs].max(initial=0.0)))


def _largest_first(multipliers):
    return multipliers[np.argsort(-abs(multipliers), kind="stable")]


def assemble(start, cells, end, border=()) -> np.ndarray:
    """Return the dense matrix of blocks start (p, n, *S), cells (2, N - 1, n, n, *S), end (e, n, *S), border (k, N, n).

    Rows start, cells, end, border; (rows, N n, *S).
    """
    (p, n), count = start.shape[:2], cells.shape[1]
    matrix = np.zeros((p + count * n + len(end) + len(border), (count + 1) * n, *start.shape[2:]))
    matrix[:p, :n] = start
    for i in range(count):
        rows = slice(p + i * n, p + (i + 1) * n)
        matrix[rows, i * n : (i + 1) * n], matrix[rows, (i + 1) * n : (i + 2) * n] = cells[:, i]
    last = p + count * n + len(end)
    matrix[p + count * n : last, count * n :] = end
    if len(border):
        matrix[last:] = border.reshape(len(border), -1)
    return matrix


# ---------------------------------------------------------------- by the monodromy matrix
def monodromy(response, steps) -> np.ndarray:
    """Return the matrix (n, n) that takes a small disturbance over one period of a response."""
    is_line = hasattr(response, "linearised_at")
    tangents, (nodes, weights, last) = (_tangents_of_line, GAUSS) if is_line else (_tangents_of_chain, RADAU)
    h, eye, result = response.last_period[1] / steps, np.eye(len(nodes)), np.ones(())
    for step in range(steps):
        by_y, by_ydot = tangents(response, (step + nodes) * h)
        n = len(by_y)
        stages = np.einsum("ij,abi->iajb", eye, by_ydot) + h * np.einsum("ij,abi->iajb", weights, by_y)
        right = -np.moveaxis(by_y, -1, 0).reshape(-1, n)
        rates = np.linalg.solve(stages.reshape(len(right), -1), right).reshape(len(nodes), n, n)
        result = np.dot(np.eye(n) + h * np.tensordot(last, rates, 1), result)
    return result


def _tangents_of_line(response, t):
    """Return those of positions r and velocities v of a line of nodes and elements, r' = v, M v' + C v + K r = 0."""
    K, C, M = response.linearised_at(t)
    one = np.broadcast_to(np.eye(len(K))[..., None], K.shape)
    zero = np.zeros(K.shape)
    join = lambda *rows: np.concatenate([np.concatenate(row, axis=1) for row in rows])
    return join((zero, -one), (K, C)), join((one, zero), (zero, M))


def _tangents_of_chain(response, t):
    """Return dF/dy and dF/dydot of the chain about its response at times t (S,), (n, n, S) each."""
    system = response.system
    state = response.at(t), response.rate_at(t), t
    start, cells, end = (part(*state) for part in (system.start, system.cells_or_empty, system.end))
    each = ((part, np.moveaxis(getattr(cells, part), 3, 1)) for part in ("dy", "dydot"))
    return tuple(assemble(getattr(start, part), between, getattr(end, part)) for part, between in each)


# ---------------------------------------------------------------- by Hill's problem
def hill_exponents(response) -> np.ndarray:
    """Return the Floquet exponents (m,) of Hill's problem, 1/s: of each multiplier that whose series is most central.

    A multiplier has an exponent for each harmonic, its series moved by one from the next. The mean harmonic of a series
    lies between -1/2 and 1/2 for one of them alone, also where a wave is faster than every harmonic.
    """
    basis = response.basis
    residual = HarmonicResidual(response.system, basis)
    rows, state = residual.rows(residual.pack(response.z), True)
    J, D = assemble(*residual.jacobian(rows, residual.slope(state))), assemble(*_rate_blocks(residual, rows))
    mu, modes = eig(J, -D)
    is_finite = np.isfinite(mu) & (abs(mu) < INFINITE * basis.omega)  # rows without a rate have infinite ones
    central = _mean_harmonics(modes[:, is_finite], basis)
    return mu[is_finite][(central > EDGE - 0.5) & (central <= EDGE + 0.5)]


def _mean_harmonics(modes, basis):
    """Return the mean of the harmonics k of exp(i k omega t) in modes (.. C, m), weighed by their energy, (m,)."""
    parts = modes.reshape(-1, basis.harmonic.size, modes.shape[1])
    sine, cosine = parts[:, int(basis.mean) :: 2], parts[:, int(basis.mean) + 1 :: 2]
    k = np.arange(1, basis.harmonics + 1)
    energy = lambda part: (abs(part) ** 2).sum(axis=0)
    forth, back = energy(cosine - 1j * sine) / 4, energy(cosine + 1j * sine) / 4
    still = energy(parts[:, :1]).sum(axis=0) / 2 if basis.mean else 0.0
    return k @ (forth - back) / (forth.sum(axis=0) + back.sum(axis=0) + still)


def _rate_blocks(residual, rows):
    """Return the blocks of the rows' derivatives by rates alone, in the places of the Jacobian's."""
    parts = []
    for part, harmonics in zip(rows, residual.row_harmonics, strict=True):
        by_rate = part.dydot if part.dydot.ndim == 5 else part.dydot[:, :, None]
        parts.append(residual.blocks(by_rate, np.zeros(by_rate.shape), harmonics, float))
    start, cells, end = parts
    border = np.zeros((len(residual.mean_constraints), residual.rest.shape[1], residual.n))
    return start[0], cells, end[0], border
