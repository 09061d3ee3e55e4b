"""Irregular prescribed motion: many harmonics of one low frequency, evaluated fast on even times.

On even times that divide the time of repetition all are one fast Fourier transform; on other even times, products of
two small matrices; at a few times, the sum as it stands. Which of them is taken changes the last digits only.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from ..outcome import InputError
from ..validation import positive_number, real_number
from .motion_arrays import as_times, check_finite, read_only_array, spanning_vectors

FEW_TIMES = 64  # up to which the sum is taken as it stands
_EVEN = 1e-12  # of the last time: rounding of even times
_DIVIDES = 1e-13  # of the time of repetition: rounding of a step that divides it


@dataclass(frozen=True, eq=False)
class IrregularMotion:
    """Displacement r(t) = Re sum_k amplitude[k-1] exp(2 pi i k t / repeats_after), k = 1..K.

    repeats_after in s; amplitude (K, 3), complex, in m in x, y, z. It has no ``period`` by design: nobody waits for it.
    Raises InputError naming the field, its value and its unit.

    >>> IrregularMotion(100.0, [[0, 0, 0], [2, 0, 0]]).displacement(25.0).round(6).tolist()  # m, half of 50 s
    [-2.0, 0.0, 0.0]
    """

    repeats_after: float
    amplitude: np.ndarray

    if TYPE_CHECKING:  # what may be given, beside what is kept

        def __init__(self, repeats_after: float, amplitude: ArrayLike) -> None: ...

    def __post_init__(self):
        object.__setattr__(self, "repeats_after", positive_number("repeats_after", self.repeats_after, "s"))
        given = np.asarray(self.amplitude)
        parts = [read_only_array("amplitude", part, "m") for part in (given.real, given.imag)]
        if given.ndim != 2 or given.shape[1] != 3 or not len(given):
            problem = f"shape {given.shape} must be (K, 3), one row [x, y, z] a harmonic (m)"
            raise InputError(problem, field="amplitude", value=self.amplitude, unit="m")
        for part in parts:
            check_finite("amplitude", part, "m")
        amplitude = parts[0] + 1j * parts[1]
        amplitude.flags.writeable = False
        object.__setattr__(self, "amplitude", amplitude)

    def directions(self) -> np.ndarray:
        """Return unit vectors that span the motion, (k, 3)."""
        return spanning_vectors(np.concatenate([self.amplitude.real, self.amplitude.imag]))

    def scaled(self, factor: float) -> IrregularMotion:
        """Return the same motion with every displacement multiplied by a number."""
        return IrregularMotion(self.repeats_after, real_number("factor", factor, "(dimensionless)") * self.amplitude)

    @property
    def standard_deviation(self) -> np.ndarray:
        """Root mean square of the displacement over the time of repetition, (3,), m."""
        return np.sqrt((abs(self.amplitude) ** 2).sum(axis=0) / 2)

    @property
    def velocity_deviation(self) -> np.ndarray:
        """Root mean square of the velocity over the time of repetition, (3,), m/s."""
        return np.sqrt((abs(self.amplitude * self._rates[:, None]) ** 2).sum(axis=0) / 2)

    @cached_property
    def _rates(self) -> np.ndarray:
        """i omega of the harmonics, (K,), 1/s."""
        return 2j * math.pi / self.repeats_after * np.arange(1, len(self.amplitude) + 1)

    def displacement(self, t: ArrayLike) -> np.ndarray:
        """Return the displacement, m: t in s, number -> (3,) or (S,) -> (3, S)."""
        return self._sums(t, 0)[0]

    def velocity(self, t: ArrayLike) -> np.ndarray:
        """Return the velocity, m/s: t in s, number -> (3,) or (S,) -> (3, S)."""
        return self._sums(t, 1)[0]

    def acceleration(self, t: ArrayLike) -> np.ndarray:
        """Return the acceleration, m/s^2: t in s, number -> (3,) or (S,) -> (3, S)."""
        return self._sums(t, 2)[0]

    def trajectory(self, t: ArrayLike) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return displacement, velocity and acceleration, (3, S) each, at times t (S,) in s."""
        r, v, a = self._sums(t, 0, 1, 2)
        return r, v, a

    def _sums(self, t, *orders) -> np.ndarray:
        """Return the derivatives of these orders, (len(orders), 3, *S), at times t, which may be complex."""
        t = as_times(t)
        used = np.flatnonzero(self.amplitude.any(axis=0))  # of x, y, z; the others are zero
        result = np.zeros((len(orders), 3, *t.shape), dtype=t.dtype if t.dtype.kind == "c" else float)
        rows = [self.amplitude[:, j] * self._rates**order for order in orders for j in used]
        if rows and t.size:
            values = self._evaluate(np.array(rows), t)
            result[:, used] = values.reshape(len(orders), used.size, *t.shape)
        return result

    def _evaluate(self, rows, t) -> np.ndarray:
        """Return Re of the sums of rows (R, K) of amplitudes at times t, (R, *S)."""
        if t.dtype.kind == "c":  # a complex step: the real part of each factor by itself
            angle = np.multiply.outer(self._rates / 1j, t)
            return np.tensordot(rows.real, np.cos(angle), 1) - np.tensordot(rows.imag, np.sin(angle), 1)
        if t.ndim == 0 or t.size <= FEW_TIMES:
            return np.tensordot(rows, np.exp(np.multiply.outer(self._rates, t)), 1).real
        first, h = t[0], (t[-1] - t[0]) / (t.size - 1)
        if abs(t - (first + h * np.arange(t.size))).max() > _EVEN * abs(t).max():
            parts = np.array_split(t, -(-t.size // FEW_TIMES))
            return np.concatenate([self._evaluate(rows, part) for part in parts], axis=-1)
        rows = rows * np.exp(self._rates * first)
        steps = round(self.repeats_after / h)
        if steps and abs(steps * h - self.repeats_after) <= _DIVIDES * self.repeats_after:
            return _transform(rows, steps)[:, np.arange(t.size) % steps]
        return _multiply_blocks(rows, self._rates * h, t.size)


def _transform(rows, steps) -> np.ndarray:
    """Return Re sum_k rows[:, k-1] exp(2 pi i k j / steps), j = 0..steps - 1, (R, steps)."""
    coefficients = np.zeros((steps, len(rows)), dtype=complex)
    np.add.at(coefficients, np.arange(1, rows.shape[1] + 1) % steps, rows.T)
    return np.fft.ifft(coefficients, axis=0).real.T * steps


def _multiply_blocks(rows, rates, count) -> np.ndarray:
    """Return Re sum_k rows[:, k] exp(rates[k] j), j = 0..count - 1, (R, count): j is a block and a place in it."""
    places = math.isqrt(count) + 1
    blocks = np.exp(np.multiply.outer(np.arange(-(-count // places)) * places, rates))  # (B, K)
    within = np.exp(np.multiply.outer(rates, np.arange(places)))  # (K, P)
    return np.array([((row * blocks) @ within).real.ravel()[:count] for row in rows])
