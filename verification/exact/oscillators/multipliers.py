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


def string_frequency(EA, tension, mass_per_length, length, cells, mode=1) -> float:
    """Return the angular frequency of a mode across a taut line of equal cells in rad/s, masses at their ends.

    length: unstretched, m. Each cell pulls with tension / (stretched length) on the difference across.
    """
    unstretched = length / cells
    stiffness = tension / (unstretched * (1 + tension / EA))
    wave = 2 * math.sin(mode * math.pi / (2 * cells))
    return wave * math.sqrt(stiffness / (mass_per_length * unstretched))


def stiffness_change(EA, tension, length, amplitude) -> float:
    """Return the relative amplitude of the stiffness across a line whose end moves along it by ``amplitude`` in m.

    To first order, waves along the line far faster than the motion: T / d = EA (1 / l - 1 / d) of every cell.
    """
    return EA * amplitude / (tension * length * (1 + tension / EA))


def parametric_growth(omega, natural, change, damping=0.0) -> complex:
    """Return the larger growth rate in 1/s of q'' + damping q' + natural^2 (1 + change cos(omega t)) q = 0.

    To first order in ``change``, omega near twice the natural frequency: q = A cos(omega t / 2) + B sin(omega t / 2)
    with A and B proportional to exp(s t), slow (Nayfeh and Mook, Nonlinear Oscillations, 1979, 5.3). Multipliers are
    -exp(2 pi s / omega).
    """
    pumped, detuned = change * natural**2 / (2 * omega), (omega**2 / 4 - natural**2) / omega
    return -damping / 2 + cmath.sqrt(pumped**2 - detuned**2)


def parametric_threshold(omega, natural, damping) -> float:
    """Return the relative change of the stiffness from which on ``parametric_growth`` is positive."""
    return 2 * omega / natural**2 * math.hypot(damping / 2, (omega**2 / 4 - natural**2) / omega)
