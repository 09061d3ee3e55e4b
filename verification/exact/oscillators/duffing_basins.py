"""Where starts of Duffing's oscillator lead, by the classical Runge-Kutta method on the equation of motion.

    q'' + c q' + q + b q^3 = F cos(omega t)

All starts go side by side, from t = 0 on for many periods; the size of the last period tells a large response from a
small one.
"""

from __future__ import annotations

import math

import numpy as np


def last_amplitudes(q, v, *, omega, force, c, b, periods=80, steps=100) -> np.ndarray:
    """Return the largest |q| in the last of so many periods, (K,), of starts q, v (K,)."""
    q, v = np.array(q, dtype=float), np.array(v, dtype=float)
    h, largest = 2 * math.pi / omega / steps, np.zeros(q.shape)

    def rate(t, q, v):
        return v, force * math.cos(omega * t) - c * v - q - b * q**3

    for step in range(periods * steps):
        t = h * step
        k1 = rate(t, q, v)
        k2 = rate(t + h / 2, q + h / 2 * k1[0], v + h / 2 * k1[1])
        k3 = rate(t + h / 2, q + h / 2 * k2[0], v + h / 2 * k2[1])
        k4 = rate(t + h, q + h * k3[0], v + h * k3[1])
        q, v = (x + h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]) for i, x in enumerate((q, v)))
        if step >= (periods - 1) * steps:
            largest = np.maximum(largest, abs(q))
    return largest
