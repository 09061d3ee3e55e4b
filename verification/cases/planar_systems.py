"""Cases of two first-order equations at one node, y' = f(y, t), whose Floquet multipliers are known in closed form."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from solvers.numerics.chain import ChainSystem, Residual


@dataclass(frozen=True, eq=False)
class PlanarSystem(ChainSystem):
    """y' = f(y, t) for y = (y_0, y_1); rate: y (2, *S), t (*S) -> (2, *S); slope: df/dy (2, 2, *S); period in s.

    rescale: factor -> the system with its driving multiplied by it, or None.
    """

    rate: Callable
    slope: Callable
    period: float
    rescale: Callable | None = None

    fields = ("first", "second")
    nodes = 1
    start_rows = 1

    def _row(self, i, y, ydot, t, tangents):
        value = (ydot[:, 0] - self.rate(y[:, 0], t))[i : i + 1]
        if not tangents:
            return Residual(value)
        by_rate = np.zeros((1, 2, *y.shape[2:]))
        by_rate[0, i] = 1.0
        return Residual(value, -np.broadcast_to(self.slope(y[:, 0], t), (2, 2, *y.shape[2:]))[i : i + 1], by_rate)

    def start(self, y, ydot, t, tangents=True) -> Residual:
        """Return the row of the first equation."""
        return self._row(0, y, ydot, t, tangents)

    def end(self, y, ydot, t, tangents=True) -> Residual:
        """Return the row of the second equation."""
        return self._row(1, y, ydot, t, tangents)

    def scaled(self, load_factor) -> PlanarSystem:
        """Return the same system with its driving multiplied by a number."""
        return super().scaled(load_factor) if self.rescale is None else self.rescale(load_factor)


def parametric(stiffness, damping, period) -> PlanarSystem:
    """Return x'' + damping x' + stiffness(t) x = 0 of the period of the stiffness, whose response is rest."""
    zero, one = (lambda t: np.zeros(np.shape(t))), (lambda t: np.ones(np.shape(t)))
    slope = lambda y, t: np.array([[zero(t), one(t)], [-stiffness(t), -damping * one(t)]])
    rate = lambda y, t: np.array([y[1], -damping * y[1] - stiffness(t) * y[0]])
    return PlanarSystem(rate, slope, period)


def meissner(k, change, damping=0.0) -> PlanarSystem:
    """Return x'' + damping x' + (k +- change) x = 0, stiff for pi seconds and soft for pi; at a jump as before it."""

    def stiffness(t):
        share = np.asarray(t) / (2 * math.pi)
        share = share - np.ceil(share - 1e-9) + 1  # in (0, 1]; rounding puts no jump before its time
        return np.where(share <= 0.5 + 1e-9, k + change, k - change)

    return parametric(stiffness, damping, 2 * math.pi)


def mathieu(a, q, damping=0.0) -> PlanarSystem:
    """Return x'' + damping x' + (a - 2 q cos 2 t) x = 0."""
    return parametric(lambda t: a - 2 * q * np.cos(2 * np.asarray(t)), damping, math.pi)


def stuart_landau(growth, omega) -> PlanarSystem:
    """Return z' = (growth + i omega - |z|^2) z, whose cycle is sqrt(growth) exp(i omega t)."""

    def rate(y, t):
        size = growth - y[0] ** 2 - y[1] ** 2
        return np.array([size * y[0] - omega * y[1], size * y[1] + omega * y[0]])

    def slope(y, t):
        (a, b), size = y, growth - y[0] ** 2 - y[1] ** 2
        return np.array([[size - 2 * a * a, -omega - 2 * a * b], [omega - 2 * a * b, size - 2 * b * b]])

    return PlanarSystem(rate, slope, 2 * math.pi / omega)


def forced_oscillator(omega, P, c=0.0, e=0.0, k=1.0, a=0.0, b=0.0) -> PlanarSystem:
    """Return x'' + (c + e x^2) x' + k x + a x^2 + b x^3 = P cos(omega t): Duffing's, van der Pol's, Helmholtz's."""

    def rate(y, t):
        x, v = y
        return np.array([v, P * np.cos(omega * np.asarray(t)) - (c + e * x * x) * v - (k + (a + b * x) * x) * x])

    def slope(y, t):
        x, v = y
        by_x = -2 * e * x * v - k - 2 * a * x - 3 * b * x * x
        return np.array([[np.zeros(x.shape), np.ones(x.shape)], [by_x, -(c + e * x * x)]])

    again = lambda factor: forced_oscillator(omega, factor * P, c, e, k, a, b)
    return PlanarSystem(rate, slope, 2 * math.pi / omega, again)
