"""Sea states: a spectrum of long-crested waves and response amplitude operators make the motion of a body.

The wave at the origin is Re sum_k a_k exp(i 2 pi k t / duration), a_k from the spectrum and a seed, and each coordinate
of the body is the same sum with a_k multiplied by its operator, |R| exp(i phase): a positive phase leads the wave.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from ..outcome import InputError
from ..types import Vector
from ..validation import one_of, positive_number, real_number, vector, whole_number
from .body_motion import BodyMotion
from .irregular_motion import IrregularMotion
from .motion_arrays import check_finite, read_only_array
from .spectrum import Spectrum

MOST_LOST = 0.01  # of the energy of the waves, which may lie above the last frequency of the operators
AT_REST = 0.01  # of the greatest operator of a coordinate: as little as MOST_LOST
_MOST_HARMONICS = 10**6


@dataclass(frozen=True, eq=False)
class ResponseOperators:
    """Response amplitude operators: what a wave of 1 m makes of surge, sway, heave (m), roll, pitch, yaw (rad).

    frequency (n,) in Hz, increasing; heading (h,) in degrees, increasing, the direction into which the waves run, from
    the x axis towards the y axis; operators (h, n, 6), complex, m/m and rad/m. Linear in frequency and heading, as
    at the first frequency below it, zero above the last. Raises InputError naming the field that is wrong.
    """

    frequency: np.ndarray
    operators: np.ndarray
    heading: np.ndarray = field(default_factory=lambda: np.zeros(1))

    def __post_init__(self):
        frequency = read_only_array("frequency", self.frequency, "Hz")
        heading = read_only_array("heading", self.heading, "degrees")
        for name, array, unit in (("frequency", frequency, "Hz"), ("heading", heading, "degrees")):
            check_finite(name, array, unit)
            if array.ndim != 1 or not array.size or not (np.diff(array) > 0).all():
                problem = f"must be one row of increasing numbers ({unit})"
                raise InputError(problem, field=name, value=array, unit=unit)
            object.__setattr__(self, name, array)
        operators = np.array(self.operators, dtype=complex)
        if operators.shape != (heading.size, frequency.size, 6):
            problem = (
                f"shape {operators.shape} must be ({heading.size}, {frequency.size}, 6): heading, frequency, motion"
            )
            raise InputError(problem, field="operators", value=self.operators, unit="m/m, rad/m")
        check_finite("operators", operators, "m/m, rad/m")
        if frequency[0] < 0:
            raise InputError(f"{frequency[0]:g} Hz must be >= 0", field="frequency", value=frequency[0], unit="Hz")
        operators.flags.writeable = False
        object.__setattr__(self, "operators", operators)

    @property
    def ends_at_rest(self) -> bool:
        """Whether the body hardly moves any more at the last frequency, so that nothing is lost beyond it."""
        size = abs(self.operators)
        return bool((size[:, -1].max(axis=0) <= AT_REST * size.max(axis=(0, 1))).all())

    def at(self, frequency, heading: float) -> np.ndarray:
        """Return the operators at frequencies (K,) in Hz and one heading in degrees, (K, 6), complex.

        Raises InputError for a heading outside those of the table.
        """
        place = self._place(heading)
        lower = min(int(np.searchsorted(self.heading, place, side="right")) - 1, max(self.heading.size - 2, 0))
        rows = self.operators[lower]
        if self.heading.size > 1:
            share = (place - self.heading[lower]) / (self.heading[lower + 1] - self.heading[lower])
            rows = (1 - share) * rows + share * self.operators[lower + 1]
        parts = [np.interp(frequency, self.frequency, column, right=0.0) for column in rows.T]
        return np.stack(parts, axis=-1)

    def _place(self, heading) -> float:
        """Return the heading as a number of degrees within the table, which may go round."""
        first, last = self.heading[[0, -1]]
        if self.heading.size == 1 and abs((heading - first + 180) % 360 - 180) <= 1e-9:
            return float(first)
        for turned in (heading + 360 * turns for turns in range(-2, 3)):
            if first <= turned <= last:
                return float(turned)
        problem = f"{heading:g} degrees is outside the response amplitude operators, {first:g} to {last:g} degrees"
        if self.heading.size == 1:
            problem += ": give them for other headings, too, in rows with a column heading"
        raise InputError(problem, field="heading", value=heading, unit="degrees")


@dataclass(frozen=True, eq=False)
class SeaState:
    """One realisation of a sea and what it does to a body: ``motion()`` is its BodyMotion.

    spectrum; operators; heading in degrees, into which the waves run; seed of numpy's default generator; duration in s,
    after which the realisation repeats; reference (3,) in m, the point whose motion the operators give.
    amplitudes: "rayleigh" (random, as those of a stretch of a Gaussian sea: its variance differs from seed to seed) or
    "deterministic" (phases alone are random: every seed has the variance of the spectrum, extremes vary too little).
    """

    spectrum: Spectrum
    operators: ResponseOperators
    seed: int
    duration: float
    heading: float = 0.0
    amplitudes: str = "rayleigh"
    reference: Vector = (0.0, 0.0, 0.0)

    def __post_init__(self):
        whole_number("seed", self.seed, 0)
        object.__setattr__(self, "duration", positive_number("duration", self.duration, "s"))
        object.__setattr__(self, "heading", real_number("heading", self.heading, "degrees"))
        object.__setattr__(self, "reference", vector("reference", self.reference, "m", "coordinates"))
        one_of("amplitudes", self.amplitudes, ("rayleigh", "deterministic"))
        self.operators.at([0.0], self.heading)
        total, last = self.spectrum.moment(0), self.operators.frequency[-1]
        lost = self.spectrum.moment(0, lowest=last) / total
        if lost > MOST_LOST and not self.operators.ends_at_rest:
            problem = (
                f"{100 * lost:.2g} % of the energy of the waves lies above {last:g} Hz, where the response amplitude "
                "operators end: give them for higher frequencies, zero where the body does not move"
            )
            raise InputError(problem, field="operators", value=last, unit="Hz")
        if self._highest * self.duration > _MOST_HARMONICS:
            problem = f"{self.duration:g} s makes more than {_MOST_HARMONICS} harmonics"
            raise InputError(problem, field="duration", value=self.duration, unit="s")

    @property
    def _highest(self) -> float:
        return float(min(self.spectrum.frequency[-1], self.operators.frequency[-1]))

    @property
    def frequency(self) -> np.ndarray:
        """Frequencies of the waves, whole multiples of 1/duration, (K,), Hz."""
        return np.arange(1, max(math.floor(self._highest * self.duration), 1) + 1) / self.duration

    def waves(self) -> np.ndarray:
        """Return the complex amplitudes of the waves at the origin, (K,), m."""
        f = self.frequency
        generator = np.random.default_rng(self.seed)
        deviation = np.sqrt(self.spectrum.at(f) / self.duration)  # each of energy S df = |a|^2 / 2
        if self.amplitudes == "deterministic":
            return math.sqrt(2) * deviation * np.exp(2j * math.pi * generator.random(f.size))
        real, imaginary = generator.standard_normal((2, f.size))
        return deviation * (real + 1j * imaginary)

    def motion(self) -> SeaMotion:
        """Return the motion of the body in these waves."""
        six = self.operators.at(self.frequency, self.heading) * self.waves()[:, None]
        rotation = IrregularMotion(self.duration, six[:, 3:]) if six[:, 3:].any() else None
        return SeaMotion(IrregularMotion(self.duration, six[:, :3]), rotation, self.reference, self)


@dataclass(frozen=True, eq=False)
class SeaMotion(BodyMotion):
    """The BodyMotion of a body in waves, and the SeaState that it is made of."""

    sea: SeaState | None = None
