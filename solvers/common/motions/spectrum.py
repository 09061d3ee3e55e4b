"""Energy spectra of waves, S(f) in m^2/Hz over frequencies f in Hz: JONSWAP, Pierson-Moskowitz, or a given table."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..outcome import InputError
from ..validation import positive_number, real_number
from .motion_arrays import check_finite, read_only_array

HIGHEST = 10.0  # of the peak frequency: above it lies 1.25e-4 of the energy of a Pierson-Moskowitz spectrum
_LOWEST = 0.2  # of the peak frequency, below which exp(-1.25 / 0.2^4) leaves nothing
_POINTS = 4000  # frequencies of the tables of the formulas, equal ratios apart
WIDTHS = 0.07, 0.09
"""Of JONSWAP's peak: sigma below and above the peak frequency (Hasselmann et al. 1973)."""
STEEPEST = 0.9, 7.0
"""JONSWAP's peakedness is meant for 1 <= gamma <= 7 (DNV-RP-C205, 3.5.5); taken is anything above the first."""


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Density of energy over frequency: frequency (n,) in Hz, increasing; density (n,) in m^2/Hz; linear between them.

    Nothing outside the frequencies. Raises InputError naming the field that is wrong.

    >>> round(Spectrum.jonswap(Hs=6.0, Tp=11.0, gamma=3.3).significant_height, 6)  # m
    6.0
    """

    frequency: np.ndarray
    density: np.ndarray

    def __post_init__(self):
        for name, unit in (("frequency", "Hz"), ("density", "m^2/Hz")):
            array = read_only_array(name, getattr(self, name), unit)
            if array.ndim != 1 or array.size < 2:
                problem = f"shape {array.shape} must be (n,), n >= 2 ({unit})"
                raise InputError(problem, field=name, value=getattr(self, name), unit=unit)
            check_finite(name, array, unit)
            if (array < 0).any():
                i = int(array.argmin())
                problem = f"{array[i]:g} {unit} must be >= 0"
                raise InputError(problem, field=f"{name}[{i}]", value=array[i], unit=unit)
            object.__setattr__(self, name, array)
        if self.frequency.shape != self.density.shape:
            problem = f"shape {self.density.shape} must be that of frequency, {self.frequency.shape} (m^2/Hz)"
            raise InputError(problem, field="density", value=self.density, unit="m^2/Hz")
        if not (np.diff(self.frequency) > 0).all():
            i = int(np.diff(self.frequency).argmin()) + 1
            problem = f"must increase (Hz), and {self.frequency[i]:g} follows {self.frequency[i - 1]:g}"
            raise InputError(problem, field=f"frequency[{i}]", value=self.frequency[i], unit="Hz")
        if not self.density.any():
            raise InputError("is zero everywhere (m^2/Hz): no sea", field="density", value=self.density, unit="m^2/Hz")

    @classmethod
    def jonswap(cls, Hs: float, Tp: float, gamma: float | None = None) -> Spectrum:
        """Return the spectrum of Hasselmann et al. (1973) of significant height Hs in m and peak period Tp in s.

        gamma: peakedness; None: that of DNV-RP-C205 (3.5.5.5), 5 where Tp <= 3.6 sqrt(Hs), 1 where Tp >= 5 sqrt(Hs),
        exp(5.75 - 1.15 Tp / sqrt(Hs)) between. Scaled so that the energy is Hs^2/16 to the last digits, where that rule
        has 1 - 0.287 ln(gamma).
        """
        Hs, Tp = positive_number("Hs", Hs, "m"), positive_number("Tp", Tp, "s")
        gamma = usual_gamma(Hs, Tp) if gamma is None else real_number("gamma", gamma, "(dimensionless)")
        if gamma < STEEPEST[0]:
            problem = f"{gamma:g} (dimensionless) must be >= 1, which is the Pierson-Moskowitz spectrum"
            raise InputError(problem, field="gamma", value=gamma, unit="(dimensionless)")
        ratio = np.geomspace(_LOWEST, HIGHEST, _POINTS)  # f / fp
        width = np.where(ratio <= 1, *WIDTHS)
        shape = ratio**-5 * np.exp(-1.25 * ratio**-4) * gamma ** np.exp(-0.5 * ((ratio - 1) / width) ** 2)
        made = cls(ratio / Tp, shape)
        return cls(made.frequency, made.density * (Hs**2 / 16 / made.moment(0)))

    @classmethod
    def pierson_moskowitz(cls, Hs: float, Tp: float) -> Spectrum:
        """Return the spectrum of a fully developed sea of significant height Hs in m and peak period Tp in s."""
        return cls.jonswap(Hs, Tp, 1.0)

    def at(self, frequency: ArrayLike) -> np.ndarray:
        """Return the density at frequencies in Hz, any shape, m^2/Hz; zero outside those of the spectrum."""
        return np.interp(np.asarray(frequency, dtype=float), self.frequency, self.density, left=0.0, right=0.0)

    def moment(self, order: int, lowest: float = 0.0, highest: float = math.inf) -> float:
        """Return the integral of f^order S(f) between two frequencies in Hz, m^2 Hz^order: exact for the lines."""
        inside = (self.frequency > lowest) & (self.frequency < highest)
        ends = [f for f in (lowest, highest) if self.frequency[0] <= f <= self.frequency[-1]]
        f = np.union1d(self.frequency[inside], ends)
        if f.size < 2:
            return 0.0
        middle, S = (f[1:] + f[:-1]) / 2, self.at(f)
        values = [x**order * y for x, y in ((f[:-1], S[:-1]), (middle, (S[1:] + S[:-1]) / 2), (f[1:], S[1:]))]
        return float(np.diff(f) @ (values[0] + 4 * values[1] + values[2])) / 6  # Simpson: exact up to order 2

    @property
    def significant_height(self) -> float:
        """Four times the standard deviation, m."""
        return 4 * math.sqrt(self.moment(0))


def usual_gamma(Hs: float, Tp: float) -> float:
    """Return JONSWAP's peakedness for a significant height in m and a peak period in s, DNV-RP-C205 (3.5.5.5)."""
    ratio = Tp / math.sqrt(Hs)
    return 5.0 if ratio <= 3.6 else 1.0 if ratio >= 5 else math.exp(5.75 - 1.15 * ratio)
