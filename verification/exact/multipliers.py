"""Floquet multipliers in closed form: Meissner's equation, and the cycle of Stuart and Landau."""

from __future__ import annotations

import cmath
import math

import numpy as np


def meissner(k, change, damping=0.0) -> np.ndarray:
    """Return the matrix (2, 2) over 2 pi s of x'' + damping x' + (k +- change) x = 0, stiff for pi s and then soft.

    Each half is a linear oscillator: exp(-damping t / 2) times sines of a real or imaginary frequency.
    """
    return _half(k - change, damping) @ _half(k + change, damping)


def _half(k, damping):
    """Return the matrix of (x, x') over pi s of x'' + damping x' + k x = 0."""
    decay, rate = math.exp(-damping * math.pi / 2), cmath.sqrt(k - damping**2 / 4)
    c = cmath.cos(rate * math.pi).real
    s = (cmath.sin(rate * math.pi) / rate).real if rate else math.pi
    half = damping / 2
    return decay * np.array([[c + half * s, s], [-k * s, c - half * s]])


def stuart_landau(growth, omega) -> np.ndarray:
    """Return the multipliers of the cycle of z' = (growth + i omega - |z|^2) z: along it, and across it."""
    return np.array([1.0, math.exp(-2 * growth * 2 * math.pi / omega)])
