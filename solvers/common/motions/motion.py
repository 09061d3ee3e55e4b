"""Prescribed motion of the fairlead: displacement about its mean position and its derivatives, SI units, public frame.

A solver takes any object with ``displacement(t)`` and ``velocity(t)`` in m and m/s, t in s a number -> (3,) or an array
(S,) -> (3, S), and ``directions()`` -> (k, 3), unit vectors that span the motion: they tell whether it stays in
the plane of the line. Here: ``Motion`` (periodic), ``SampledMotion`` (a measured series), ``FunctionMotion`` (any
function of time) and ``Ramped`` (one of these, started from rest).
t may be complex in Motion, SampledMotion and Ramped: a complex step passes through.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicSpline

from ..outcome import InputError
from ..types import Vector
from ..validation import positive_number, real_number, vector
from .motion_arrays import as_times, check_finite, evaluate_function, motion_rows, read_only_array, spanning_vectors

_DIFFERENCE = 1e-5  # of the span of some times: a step of central differences
_EXTREME = 1e100  # s; a ramp between this and its inverse has squares within double precision
_END_OF_SERIES = 1e-9  # share of the duration of a series by which a sum of time steps may exceed its ends


@dataclass(frozen=True, eq=False)
class Motion:
    """Periodic displacement r(t) = sum_k sine[k-1] sin(2 pi k f t) + cosine[k-1] cos(2 pi k f t), k = 1..K, HB (49).

    frequency f in Hz; sine and cosine (K, 3) in m in x, y, z (cosine None: zero).
    Raises InputError naming the field, its value and its unit.

    >>> Motion.harmonic(0.05, (5.0, 0.0, 0.0)).displacement(5.0).round(6).tolist()  # m, a quarter of the period
    [5.0, 0.0, 0.0]
    """

    frequency: float
    sine: np.ndarray
    cosine: np.ndarray = None  # type: ignore[assignment]  # zeros once it is built

    if TYPE_CHECKING:  # what may be given, beside what is kept

        def __init__(self, frequency: float, sine: ArrayLike, cosine: ArrayLike | None = None) -> None: ...

    def __post_init__(self):
        object.__setattr__(self, "frequency", positive_number("frequency", self.frequency, "Hz"))
        sine = motion_rows("sine", self.sine, 1)
        cosine = np.zeros_like(sine) if self.cosine is None else motion_rows("cosine", self.cosine, 1)
        if cosine.shape != sine.shape:
            problem = f"shape {cosine.shape} must be that of sine, {sine.shape}: one row a harmonic (m)"
            raise InputError(problem, field="cosine", value=self.cosine, unit="m")
        object.__setattr__(self, "sine", sine)
        object.__setattr__(self, "cosine", cosine)

    @classmethod
    def harmonic(cls, frequency: float, amplitude: Vector, phase: Vector = (0.0, 0.0, 0.0)) -> Motion:
        """Return the motion amplitude sin(2 pi f t + phase): Hz, amplitude (3,) in m, phase (3,) in rad, in x, y, z."""
        size, angle = np.array(vector("amplitude", amplitude, "m")), np.array(vector("phase", phase, "rad"))
        return cls(frequency, [size * np.cos(angle)], [size * np.sin(angle)])

    @property
    def period(self) -> float:
        """1/f, s."""
        return 1 / self.frequency

    @property
    def harmonics(self) -> int:
        """Number K of harmonics of the frequency."""
        return len(self.sine)

    def directions(self) -> np.ndarray:
        """Return unit vectors that span the motion, (k, 3)."""
        return spanning_vectors(np.concatenate([self.sine, self.cosine]))

    def scaled(self, factor: float) -> Motion:
        """Return the same motion with every displacement multiplied by a number."""
        factor = real_number("factor", factor, "(dimensionless)")
        return Motion(self.frequency, factor * self.sine, factor * self.cosine)

    @cached_property
    def _omega(self):
        """Angular frequencies of the harmonics, (K,), rad/s."""
        return 2 * math.pi * self.frequency * np.arange(1, self.harmonics + 1)

    @cached_property
    def _rates(self):
        """Coefficients (3, K) of the cosines and of the sines in the velocity, m/s."""
        return self._omega * self.sine.T, -self._omega * self.cosine.T

    def displacement(self, t: ArrayLike) -> np.ndarray:
        """Return the displacement, m: t in s, number -> (3,) or (S,) -> (3, S)."""
        angle = np.multiply.outer(self._omega, as_times(t))
        return self.sine.T @ np.sin(angle) + self.cosine.T @ np.cos(angle)

    def velocity(self, t: ArrayLike) -> np.ndarray:
        """Return the velocity, m/s: t in s, number -> (3,) or (S,) -> (3, S)."""
        angle = np.multiply.outer(self._omega, as_times(t))
        of_cosine, of_sine = self._rates
        return of_cosine @ np.cos(angle) + of_sine @ np.sin(angle)

    def acceleration(self, t: ArrayLike) -> np.ndarray:
        """Return the acceleration, m/s^2: t in s, number -> (3,) or (S,) -> (3, S)."""
        angle = np.multiply.outer(self._omega, as_times(t))
        of_cosine, of_sine = self._rates
        return (self._omega * of_sine) @ np.cos(angle) - (self._omega * of_cosine) @ np.sin(angle)

    def trajectory(self, t: ArrayLike) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return displacement, velocity and acceleration, (3, S) each, at times t (S,) in s, from one evaluation."""
        angle = np.multiply.outer(self._omega, as_times(t))
        sin, cos = np.sin(angle), np.cos(angle)
        of_cosine, of_sine = self._rates
        a = (self._omega * of_sine) @ cos - (self._omega * of_cosine) @ sin
        return self.sine.T @ sin + self.cosine.T @ cos, of_cosine @ cos + of_sine @ sin, a


@dataclass(frozen=True, eq=False)
class SampledMotion:
    """A C2 cubic spline through a series: time (n,) in s, increasing; samples (n, 3) in m in x, y, z.

    Two or more samples, not-a-knot ends; t outside the series is refused. Raises InputError naming what is wrong.

    >>> SampledMotion([0, 1, 2, 3], [[0, 0, 0], [1, 0, 0], [4, 0, 0], [9, 0, 0]]).velocity(1.5).round(6).tolist()  # m/s
    [3.0, 0.0, 0.0]
    """

    time: np.ndarray
    samples: np.ndarray

    if TYPE_CHECKING:  # what may be given, beside what is kept

        def __init__(self, time: ArrayLike, samples: ArrayLike) -> None: ...

    def __post_init__(self):
        series = motion_rows("samples", self.samples, 2)
        time = read_only_array("time", self.time, "s")
        if time.shape != series.shape[:1]:
            problem = f"shape {time.shape} (s) must be ({len(series)},), one for each row of samples"
            raise InputError(problem, field="time", value=self.time, unit="s")
        check_finite("time", time, "s")
        if not (np.diff(time) > 0).all():
            i = int(np.argmin(np.diff(time) > 0))
            problem = f"must increase (s), and {time[i + 1]:g} follows {time[i]:g} at index {i + 1}"
            raise InputError(problem, field="time", value=self.time, unit="s")
        object.__setattr__(self, "time", time)
        object.__setattr__(self, "samples", series)

    def directions(self) -> np.ndarray:
        """Return unit vectors that span the motion, (k, 3)."""
        return spanning_vectors(self.samples)

    @cached_property
    def _cubics(self):
        """Coefficients of (t - time[i])^p, p = 3, 2, 1, 0 down the first axis, (4, 3, n - 1)."""
        return np.moveaxis(CubicSpline(self.time, self.samples).c, 1, 2)

    def _locate(self, t):
        """Return the coefficients (4, 3, *S) of the pieces that contain t, and t from their left ends."""
        t = as_times(t)
        first, last = self.time[0], self.time[-1]
        slack = _END_OF_SERIES * (last - first)
        inside = (t.real >= first - slack) & (t.real <= last + slack)
        if not np.all(inside):
            bad = t.real[~inside].flat[0] if t.ndim else t.real
            problem = f"{bad:g} s lies outside the series, {first:g} to {last:g} s"
            raise InputError(problem, field="time", value=float(bad), unit="s")
        i = np.clip(np.searchsorted(self.time, t.real, side="right") - 1, 0, len(self.time) - 2)
        return self._cubics[..., i], t - self.time[i]

    def displacement(self, t: ArrayLike) -> np.ndarray:
        """Return the displacement, m: t in s, number -> (3,) or (S,) -> (3, S); InputError outside the series."""
        (a, b, c, d), h = self._locate(t)
        return ((a * h + b) * h + c) * h + d

    def velocity(self, t: ArrayLike) -> np.ndarray:
        """Return the velocity, m/s: t in s, number -> (3,) or (S,) -> (3, S); InputError outside the series."""
        (a, b, c, _), h = self._locate(t)
        return (3 * a * h + 2 * b) * h + c

    def acceleration(self, t: ArrayLike) -> np.ndarray:
        """Return the acceleration, m/s^2: t in s, number -> (3,) or (S,) -> (3, S); InputError outside the series."""
        (a, b, _, _), h = self._locate(t)
        return 6 * a * h + 2 * b


@dataclass(frozen=True, eq=False)
class FunctionMotion:
    """Motion by functions of one time in s: position t -> (3,) in m in x, y, z, and its rate t -> (3,) in m/s.

    >>> FunctionMotion(position=lambda t: (2.0 * t, 0, 0), rate=lambda t: (2.0, 0, 0)).displacement(1.5).tolist()  # m
    [3.0, 0.0, 0.0]
    """

    position: Callable[[float], ArrayLike]
    rate: Callable[[float], ArrayLike]

    def __post_init__(self):
        for name in ("position", "rate"):
            if not callable(getattr(self, name)):
                given = getattr(self, name)
                raise InputError(f"{given!r} must be a function of time (s)", field=name, value=given)

    def directions(self) -> np.ndarray:
        """Return x, y and z, (3, 3): a function may go anywhere."""
        return np.eye(3)

    def displacement(self, t: ArrayLike) -> np.ndarray:
        """Return the displacement, m: t in s, number -> (3,) or (S,) -> (3, S); InputError where it is not finite."""
        return evaluate_function("position", self.position, t, "m")

    def velocity(self, t: ArrayLike) -> np.ndarray:
        """Return the velocity, m/s: t in s, number -> (3,) or (S,) -> (3, S); InputError where it is not finite."""
        return evaluate_function("rate", self.rate, t, "m/s")


@dataclass(frozen=True, eq=False)
class Ramped:
    """A motion started from rest: its displacement times q(t/duration), q = 10 x^3 - 15 x^4 + 6 x^5 from 0 to 1, C2.

    duration in s; HB section 4 ramps over half a period. The acceleration of a motion that gives none is that of
    ``trajectory``, from differences.
    """

    motion: Motion | SampledMotion | FunctionMotion
    duration: float

    def __post_init__(self):
        duration = positive_number("duration", self.duration, "s")
        if not 1 / _EXTREME <= duration <= _EXTREME:
            problem = f"a ramp of {duration:g} s must lie between {1 / _EXTREME:g} and {_EXTREME:g} s"
            raise InputError(problem, field="duration", value=duration, unit="s")
        object.__setattr__(self, "duration", duration)

    def directions(self) -> np.ndarray:
        """Return unit vectors that span the motion, (k, 3)."""
        return self.motion.directions()

    def _ramp(self, t):
        """Return q and its first two time derivatives, each of the shape of t."""
        if np.ndim(t) == 0 and t.real >= self.duration:
            return 1.0, 0.0, 0.0
        t = as_times(t)
        x = np.where(t.real <= 0, 0.0, np.where(t.real >= self.duration, 1.0, t / self.duration))
        q = x**3 * (10 - 15 * x + 6 * x**2)
        return q, 30 * x**2 * (1 - x) ** 2 / self.duration, 60 * x * (1 - x) * (1 - 2 * x) / self.duration**2

    def displacement(self, t) -> np.ndarray:
        """Return the displacement, m: t in s, number -> (3,) or (S,) -> (3, S)."""
        return self._ramp(t)[0] * self.motion.displacement(t)

    def velocity(self, t) -> np.ndarray:
        """Return the velocity, m/s: t in s, number -> (3,) or (S,) -> (3, S)."""
        if np.ndim(t) == 0 and t.real >= self.duration:  # the motion itself, at nearly every step
            return self.motion.velocity(t)
        q, q_t, _ = self._ramp(t)
        return q_t * self.motion.displacement(t) + q * self.motion.velocity(t)

    def acceleration(self, t) -> np.ndarray:
        """Return the acceleration, m/s^2: t in s, number -> (3,) or (S,) -> (3, S)."""
        return self.trajectory(t)[2]

    def trajectory(self, t) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return displacement, velocity and acceleration, (3, S) each, at times t (S,) in s."""
        (q, q_t, q_tt), (r, v, a) = self._ramp(t), trajectory(self.motion, t)
        return q * r, q_t * r + q * v, q_tt * r + 2 * q_t * v + q * a


def trajectory(motion, t) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return displacement, velocity and acceleration, (3, S) each, of any motion at times t (S,) in s.

    The acceleration comes from differences of the velocity where the motion gives none.
    """
    if hasattr(motion, "trajectory"):
        return motion.trajectory(t)
    if hasattr(motion, "acceleration"):
        return motion.displacement(t), motion.velocity(t), motion.acceleration(t)
    h = _DIFFERENCE * (float(np.ptp(t)) or 1.0)
    return motion.displacement(t), motion.velocity(t), (motion.velocity(t + h) - motion.velocity(t - h)) / (2 * h)
