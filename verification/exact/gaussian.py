"""Gaussian series of a level band of frequencies, and what theory says of their peaks and their damage."""

from __future__ import annotations

import math

import numpy as np


def gaussian_series(seed: int, lowest: float, highest: float, duration: float, step: float) -> np.ndarray:
    """Return a series (K,) of unit variance, on average, with a level spectrum between two frequencies in Hz.

    duration in s, after which it repeats, a whole multiple of the step in s.
    """
    k = np.arange(1, int(highest * duration) + 1)
    band = k >= lowest * duration
    real, imaginary = np.random.default_rng(seed).standard_normal((2, k.size)) * band / math.sqrt(band.sum())
    samples = int(duration / step)
    coefficients = np.zeros(samples // 2 + 1, dtype=complex)
    coefficients[k] = (real + 1j * imaginary) * samples / 2
    return np.fft.irfft(coefficients, samples)


def level_moments(lowest: float, highest: float) -> list[float]:
    """Return moments 0, 1, 2 and 4 of a level spectrum of unit variance."""
    return [(highest ** (n + 1) - lowest ** (n + 1)) / (n + 1) / (highest - lowest) for n in (0, 1, 2, 4)]


def dirlik_load(lowest: float, highest: float, exponent: float) -> float:
    """Return the damage-equivalent range at 1 Hz of a level band by Dirlik (thesis, Warwick 1985)."""
    m0, m1, m2, m4 = level_moments(lowest, highest)
    gamma, peaks = m2 / math.sqrt(m0 * m4), math.sqrt(m4 / m2)
    x = m1 / m0 * math.sqrt(m2 / m4)
    D1 = 2 * (x - gamma**2) / (1 + gamma**2)
    R = (gamma - x - D1**2) / (1 - gamma - D1 + D1**2)
    D2 = (1 - gamma - D1 + D1**2) / (1 - R)
    D3, m = 1 - D1 - D2, exponent
    Q = 1.25 * (gamma - D3 - D2 * R) / D1
    mean = D1 * Q**m * math.gamma(1 + m) + 2 ** (m / 2) * math.gamma(1 + m / 2) * (D2 * abs(R) ** m + D3)
    return 2 * math.sqrt(m0) * (peaks * mean) ** (1 / m)


def rayleigh_extreme(peaks: float) -> float:
    """Return what one in so many peaks of a narrow-banded series of unit variance exceeds: they are Rayleigh's."""
    return math.sqrt(2 * math.log(peaks))


def narrow_band_load(frequency: float, exponent: float) -> float:
    """Return the damage-equivalent range at 1 Hz of a narrow-banded series of unit variance, frequency in Hz."""
    return 2 * math.sqrt(2) * (frequency * math.gamma(1 + exponent / 2)) ** (1 / exponent)
