"""Periodic response of a ChainSystem by multi-harmonic balance with AFT, HB section 3; knows nothing of cables.

y(t) = rest + q(t) z with the Fourier functions q of ``fourier``; the rows of F are sampled, their Fourier coefficients
vanish, (63), and Newton's method solves for z with the blocks (72)-(74) of the sampled tangents.

Mean: rows that see only rates cannot tell the mean position, so with the constant term kept the mean of the last node's
rows is replaced by the mean of ``ChainSystem.drift``. Without the constant term (the paper's variant) the mean balance of
forces is not solved.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from .block_chain import BlockChain
from .chain import ChainSystem
from .fourier import Basis
from .newton import Step, damped_newton, relaxed_newton
from .outcome import InputError, Outcome, Status
from .properties import positive_number
from .response import Response

_SMALLEST_RISE = 2.0**-8  # of the amplitude, in the continuation
_SYMMETRIC = 1e-9  # share of the rows that may be left where a symmetry says zero


@dataclass(frozen=True)
class PeriodicResponse(Response, Outcome):
    """Periodic state: coefficients z (n_f, N, C) about ``system.rest()`` in the order of ``basis.harmonic``.

    time (Nt,) s; y, ydot (n_f, N, Nt): the samples. iterations: Newton steps of all levels and amplitudes; steps: those
    of the last solve, error (76) and relaxation each. residual_norm: largest coefficient of the rows.
    amplitude: share of the motion that was reached, 1 on success. event: (time, node) of an invalid state, or None.
    mean: False marks the paper's variant without constant term: its mean forces are not in balance.
    """

    system: ChainSystem = field(repr=False)
    basis: Basis = field(repr=False)
    z: np.ndarray = field(repr=False)
    subharmonic: int
    status: Status
    iterations: int
    residual_norm: float
    steps: tuple[Step, ...] = field(repr=False)
    amplitude: float
    mean: bool
    symmetric: bool
    event: tuple[float, int] | None = None

    @property
    def time(self) -> np.ndarray:
        """Sample times, (Nt,), s."""
        return self.basis.times

    @cached_property
    def y(self) -> np.ndarray:
        """State at the samples, (n_f, N, Nt)."""
        return self.at(self.time)

    @cached_property
    def ydot(self) -> np.ndarray:
        """Rate at the samples, (n_f, N, Nt)."""
        return self.rate_at(self.time)

    @property
    def last_period(self) -> tuple[float, float]:
        """0 and the period of the response, nu / f, s."""
        return 0.0, 2 * math.pi / self.basis.omega

    def at(self, t) -> np.ndarray:
        """State at times t (S,) in s, (n_f, N, S)."""
        return self.system.rest()[..., None] + self.z @ self.basis.functions(np.asarray(t, dtype=float))[0].T

    def rate_at(self, t) -> np.ndarray:
        """Rate of the state at times t (S,) in s, (n_f, N, S)."""
        return self.z @ self.basis.functions(np.asarray(t, dtype=float))[1].T


def solve_periodic(
    system: ChainSystem,
    *,
    harmonics,
    samples=None,
    subharmonic=1,
    mean=True,
    start=None,
    tolerance=1e-10,
    globalisation="damped",
    multilevel=False,
    symmetry=True,
    throw=True,
) -> PeriodicResponse:
    """The periodic response to the periodic driving of a chain.

    harmonics: Nh of the frequency divided by ``subharmonic`` (nu). samples: Nt >= 2 Nh + 1 in the period, by default
    4 Nh: aliasing of the drag then falls below its truncation. mean: keep the constant term; False is the paper's variant.
    start: a PeriodicResponse of the same nodes and fields, or coefficients z (n_f, N, C), in place of rest.
    tolerance: error (76), the mean |dz| of the last Newton step. globalisation: "damped" (error-oriented damping) or
    "relaxation" (the paper's factor). multilevel: solve with Nh/3 first. symmetry: use a mirror symmetry of the chain
    where its rows show it.
    When Newton's method fails, the driving is raised in steps. Raises InputError for bad input, ConvergenceError when no
    response is found (``throw=False``: the largest amplitude reached, with its status).
    """
    Nh = _whole("harmonics", harmonics, 1)
    nu = _whole("subharmonic", subharmonic, 1)
    Nt = max(4 * Nh, 8) if samples is None else _whole("samples", samples, 1)
    if Nt < 2 * Nh + 1:
        raise InputError(f"samples: {Nt} must be at least 2 harmonics + 1 = {2 * Nh + 1}")
    tolerance = positive_number("tolerance", tolerance, "(mean change of a coefficient)")
    if globalisation not in _NEWTON:
        raise InputError(f"globalisation: {globalisation!r} must be 'damped' or 'relaxation'")
    if system.period is None:
        raise InputError("motion: the chain has no periodic driving, and its periodic response takes one")
    basis = Basis(Nh, Nt, 2 * math.pi / (nu * system.period), bool(mean))
    newton = _NEWTON[globalisation]
    z, spent = _start(system, basis, start), 0
    with np.errstate(all="ignore"):  # a diverging step is found by its size
        if multilevel and Nh > 3:
            coarse = Basis(max(Nh // 3, 2), max(Nt // 3, 16), basis.omega, basis.mean)
            z, spent, *_ = _continued(system, coarse, _resized(z, basis, coarse), tolerance, newton, symmetry)
            z = _resized(z, coarse, basis)
        z, iterations, steps, reached, balance = _continued(system, basis, z, tolerance, newton, symmetry)
        response = _response(system, basis, z, nu, spent + iterations, steps, reached, balance)
    return response.or_throw(f"{Nh} harmonics, {Nt} samples, amplitude reached: {reached:.4g}") if throw else response


def _continued(system, basis, z, tolerance, newton, symmetry):
    """Newton at the full driving, or from rest by steps in its amplitude: (z, iterations, steps, reached, balance)."""
    reached, rise, iterations, before = 0.0, 1.0, 0, None
    while True:
        share = min(1.0, reached + rise)
        balance = Balance(system if share == 1.0 else system.scaled(share), basis, symmetry)
        guess = z
        if before is not None:  # along the secant
            guess = z + (share - reached) / (reached - before[0]) * (z - before[1])
        x, steps, converged = newton(balance.linearise, balance.residual, balance.pack(guess), tolerance, _error)
        iterations += len(steps)
        if converged and balance.symmetric and not balance.holds(x):
            return _continued(system, basis, z, tolerance, newton, False)
        if converged:
            if reached > 0:
                before = (reached, z)
            z, reached, rise = balance.unpack(x), share, 2 * rise
            if reached == 1.0:
                return z, iterations, steps, reached, balance
        else:
            if reached == 0:
                z = np.zeros_like(z)
            rise /= 2
            if rise < _SMALLEST_RISE:
                return z, iterations, steps, reached, balance


def _response(system, basis, z, nu, iterations, steps, reached, balance) -> PeriodicResponse:
    status, event = Status.SUCCESS, None
    if reached < 1.0:
        status = Status.NO_PERIODIC_RESPONSE
    y = system.rest()[..., None] + z @ basis.Q.T
    for i, t in enumerate(basis.times):
        invalid = system.invalid(y[..., i])
        if invalid is not None:
            status, event = (invalid[0] if reached == 1.0 else status), (float(t), invalid[1])
            break
    norm = float(abs(balance.residual(balance.pack(z))).max())
    return PeriodicResponse(
        system, basis, z, nu, status, iterations, norm, tuple(steps), reached, basis.mean, balance.symmetric, event
    )


class Balance:
    """The rows (63) of a chain for the coefficients z, as a vector for Newton's method, and its Jacobian (72)-(74).

    x (N, n): the active coefficients of a node, field after field. Where a mirror maps the chain onto itself half a
    period later, fields that it keeps have even harmonics and fields that it turns have odd ones.
    """

    def __init__(self, system, basis, symmetry=True):
        self.system, self.basis, self.rest = system, basis, system.rest()
        mirror = system.mirror() if symmetry else None
        self.symmetric = mirror is not None and self._mirrored(mirror)
        fields, start, cells, end = mirror if self.symmetric else (None,) * 4
        n_f, first = len(system.fields), system.start_rows
        self.columns = self._active(fields, n_f)
        self.start_rows, self.cell_rows = self._active(start, first), self._active(cells, n_f)
        self.end_rows = self._active(end, n_f - first)
        self.closed = []  # components of the drift whose mean is in place of that of an end row
        drift = system.drift(self.rest, 0.0) if basis.mean else None
        if drift is not None:
            offset = n_f - first - len(drift)
            self.closed = [d for d in range(len(drift)) if 0 in self.end_rows[offset + d]]
            for d in self.closed:
                self.end_rows[offset + d] = self.end_rows[offset + d][1:]
        self.weights = {}
        self.n = sum(map(len, self.columns))

    def _active(self, signs, count):
        """Coefficients (a list of index arrays) of each field or row."""
        k = self.basis.harmonic
        if signs is None:
            return [np.arange(k.size)] * count
        return [np.flatnonzero(k % 2 == (0 if sign > 0 else 1)) for sign in signs]

    def _mirrored(self, mirror) -> bool:
        """Whether the rows at a random state and those at its mirror image half a period later are mirror images."""
        fields, *rows = mirror
        rng = np.random.default_rng(1)
        shape = self.rest.shape
        y, ydot = self.rest * (1 + 0.1 * rng.random(shape)) + 0.1 * rng.random(shape), rng.random(shape)
        signs, half = np.array(fields)[:, None], math.pi / self.basis.omega
        for t in half * rng.random(3):
            for part, sign in zip(("start", "between", "end"), rows, strict=True):
                here = getattr(self.system, part)(y, ydot, t, False).value
                there = getattr(self.system, part)(signs * y, signs * ydot, t + half, False).value
                turned = (np.array(sign) * here.T).T
                if abs(turned - there).max(initial=0) > _SYMMETRIC * abs(here).max(initial=0):
                    return False
        return True

    def holds(self, x) -> bool:
        """Whether the solution meets the rows that the symmetry left out, too: it found them zero, not assumed."""
        full = Balance(self.system, self.basis, False)
        F, size = full.residual(full.pack(self.unpack(x))), abs(self.residual(self.pack(0 * self.unpack(x)))).max()
        return bool(abs(F).max() <= _SYMMETRIC * size)

    def pack(self, z) -> np.ndarray:
        """x (N, n) of z (n_f, N, C)."""
        return np.concatenate([z[f][:, c] for f, c in enumerate(self.columns)], axis=1)

    def unpack(self, x) -> np.ndarray:
        """z (n_f, N, C) of x (N, n)."""
        z, at = np.zeros((*self.rest.shape, self.basis.harmonic.size)), 0
        for f, c in enumerate(self.columns):
            z[f][:, c] = x[:, at : at + c.size]
            at += c.size
        return z

    def samples(self, x):
        """(y, ydot, t) at the samples."""
        z = self.unpack(x)
        return self.rest[..., None] + z @ self.basis.Q.T, z @ self.basis.Q_t.T, self.basis.times

    def rows(self, x, tangents):
        """start, cells and end rows at the samples, and the state there."""
        state = self.samples(x)
        parts = self.system.start, self.system.between, self.system.end
        return tuple(part(*state, tangents) for part in parts), state

    def residual(self, x) -> np.ndarray:
        """All rows as one vector."""
        return self._vector(*self.rows(x, False))

    def _vector(self, rows, state):
        start, cells, end = (part.value @ self.basis.P for part in rows)
        middle = np.concatenate([cells[f][:, c] for f, c in enumerate(self.cell_rows)], axis=1)
        parts = [start[f, c] for f, c in enumerate(self.start_rows)]
        parts += [middle.ravel()]
        parts += [end[f, c] for f, c in enumerate(self.end_rows)]
        if self.closed:
            parts += [(self.system.drift(state[0], state[2]) @ self.basis.P)[self.closed, 0]]
        return np.concatenate(parts)

    def linearise(self, x):
        """The residual and a function that solves with the Jacobian, None where it is singular."""
        rows, state = self.rows(x, True)
        F = self._vector(rows, state)
        if not np.isfinite(F).all():
            return F, None
        factors = BlockChain(*self.jacobian(rows, state))
        return F, None if factors.singular else lambda F: factors.solve(*self._split(F))

    def jacobian(self, rows, state):
        """Blocks of BlockChain: start (p, n), cells (2, N - 1, n, n), end (e, n), border (k, N, n)."""
        start, cells, end = rows
        blocks = (
            self._blocks(start.y[:, :, None], start.ydot[:, :, None], self.start_rows)[0],
            self._blocks(cells.y, cells.ydot, self.cell_rows),
            self._blocks(end.y[:, :, None], end.ydot[:, :, None], self.end_rows)[0],
        )
        nodes = self.rest.shape[1]
        if not self.closed:
            return *blocks, np.zeros((0, nodes, self.n))
        slope = self.system.drift_tangent(state[0])[self.closed]
        return *blocks, self._blocks(slope, None, [np.array([0])] * len(self.closed)).swapaxes(0, 1)

    def _blocks(self, by_y, by_ydot, active):
        """Blocks (..., nodes, rows, n) of tangents (..., n_r, n_f, nodes, Nt): P^T diag(dF/dy) Q + P^T diag(dF/dydot) Q_t."""
        *lead, _, _, nodes, _ = by_y.shape
        out = np.zeros((*lead, nodes, sum(map(len, active)), self.n))
        row = 0
        for a, rows in enumerate(active):
            column = 0
            for b, columns in enumerate(self.columns):
                for tangent, of_rate in ((by_y, False), (by_ydot, True)):
                    if tangent is None:
                        continue
                    part = tangent[..., a, b, :, :]
                    if part.any():
                        block = part @ self._weight(rows, columns, of_rate)
                        shape = (*block.shape[:-1], rows.size, columns.size)
                        out[..., row : row + rows.size, column : column + columns.size] += block.reshape(shape)
                column += columns.size
            row += rows.size
        return out

    def _weight(self, rows, columns, of_rate):
        """P[t, i] Q[t, j] or P[t, i] Q_t[t, j], (Nt, rows columns)."""
        key = (rows.tobytes(), columns.tobytes(), of_rate)
        if key not in self.weights:
            Q = self.basis.Q_t if of_rate else self.basis.Q
            weight = self.basis.P[:, rows, None] * Q[:, None, columns]
            self.weights[key] = weight.reshape(len(weight), -1)
        return self.weights[key]

    def _split(self, F):
        """Parts of a right-hand side as BlockChain takes them."""
        first, nodes = sum(map(len, self.start_rows)), self.rest.shape[1]
        middle = first + (nodes - 1) * self.n
        last = F.size - len(self.closed)
        return F[:first], F[first:middle].reshape(nodes - 1, self.n), F[middle:last], F[last:]


def _error(step) -> float:
    """(76)."""
    return float(abs(step).mean())


_NEWTON = {"damped": damped_newton, "relaxation": relaxed_newton}


def _whole(name, value, least) -> int:
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)) or value < least:
        raise InputError(f"{name}: {value!r} must be a whole number >= {least}")
    return int(value)


def _start(system, basis, start) -> np.ndarray:
    shape = (len(system.fields), system.nodes)
    if start is None:
        return np.zeros((*shape, basis.harmonic.size))
    if isinstance(start, PeriodicResponse):
        z, of = start.z, start.basis
        if z.shape[:2] != shape or abs(of.omega / basis.omega - 1) > 1e-12:
            raise InputError(f"start: a response of {z.shape[:2]} fields and nodes at {of.omega:g} rad/s does not fit")
        return _resized(z, of, basis)
    z = np.asarray(start, dtype=float)
    if z.shape != (*shape, basis.harmonic.size) or not np.isfinite(z).all():
        raise InputError(f"start: coefficients of shape {z.shape} must be {(*shape, basis.harmonic.size)}, all finite")
    return z


def _resized(z, of, to) -> np.ndarray:
    """Coefficients in another basis of the same frequency: cut, or filled with zeros."""
    new = np.zeros((*z.shape[:2], to.harmonic.size))
    if of.mean and to.mean:
        new[..., 0] = z[..., 0]
    count = 2 * min(of.harmonics, to.harmonics)
    new[..., to.mean : to.mean + count] = z[..., of.mean : of.mean + count]
    return new
