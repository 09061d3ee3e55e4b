"""Cases of two first-order equations at one node, or some more, whose Floquet multipliers are known otherwise."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from solvers.numerics.chain import ChainSystem, Residual


@dataclass(frozen=True, eq=False)
class PlanarSystem(ChainSystem):
    """y' = f(y, t) for y = (y_0, y_1), or more; rate: y (n, *S), t (*S) -> (n, *S); slope: df/dy (n, n, *S).

    period in s; rescale: factor -> the system with its driving multiplied by it, or None.
    """

    rate: Callable
    slope: Callable
    period: float
    rescale: Callable | None = None
    size: int = 2

    nodes = 1

    @property
    def fields(self):
        """Names of the n unknowns."""
        return tuple(f"y_{i}" for i in range(self.size))

    @property
    def start_rows(self):
        """All rows but one are of the start."""
        return self.size - 1

    def _rows(self, i, y, ydot, t, tangents):
        value = (ydot[:, 0] - self.rate(y[:, 0], t))[i]
        if not tangents:
            return Residual(value)
        one = np.eye(self.size).reshape(self.size, self.size, *(1,) * (y.ndim - 2))
        shape = (self.size, self.size, *y.shape[2:])
        return Residual(value, -np.broadcast_to(self.slope(y[:, 0], t), shape)[i], np.broadcast_to(one, shape)[i])

    def start(self, y, ydot, t, tangents=True) -> Residual:
        """Return the rows of all equations but the last."""
        return self._rows(slice(None, -1), y, ydot, t, tangents)

    def end(self, y, ydot, t, tangents=True) -> Residual:
        """Return the row of the last equation."""
        return self._rows(slice(-1, None), y, ydot, t, tangents)

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


def unilateral_spring(omega, mass, damping, stiffness, force, contact, gap) -> PlanarSystem:
    """Return M q'' + D q' + K q + contact max(q_0 - gap, 0) = force cos(omega t); matrices (n, n), force (n,)."""
    n, inverse = len(force), np.linalg.inv(mass)

    def rate(y, t):
        q, v = y[:n], y[n:]
        load = np.multiply.outer(force, np.cos(omega * np.asarray(t))) - np.tensordot(damping, v, 1)
        load = load - np.tensordot(stiffness, q, 1)
        load[0] -= contact * np.maximum(q[0] - gap, 0.0)
        return np.concatenate([v, np.tensordot(inverse, load, 1)])

    def slope(y, t):
        result = np.zeros((2 * n, 2 * n, *y.shape[1:]))
        column = lambda matrix: matrix.reshape(n, n, *(1,) * (y.ndim - 1))
        result[:n, n:] = column(np.eye(n))
        result[n:, :n], result[n:, n:] = column(-inverse @ stiffness), column(-inverse @ damping)
        result[n:, 0] -= contact * np.multiply.outer(inverse[:, 0], (y[0] > gap).astype(float))
        return result

    again = lambda factor: unilateral_spring(omega, mass, damping, stiffness, factor * force, contact, gap)
    return PlanarSystem(rate, slope, 2 * math.pi / omega, again, 2 * n)


class FeedbackSystem(PlanarSystem):
    """A PlanarSystem without driving whose last unknown is a parameter, constant in time, at a frequency that is given.

    Its mean row is that of the phase: the first unknown has no sine of the frequency.
    """

    def drift(self, y, t):
        """Return sin(omega t) times the first unknown, whose mean fixes the phase, (1, *S)."""
        return y[0] * np.sin(2 * math.pi / self.period * np.asarray(t))

    def drift_tangent(self, y) -> np.ndarray:
        """Return d(drift)/dy, (1, n, 1, S), at S equal times of the period."""
        count = y.shape[2]
        slope = np.zeros((1, *y.shape))
        slope[0, 0, 0] = np.sin(2 * math.pi * np.arange(count) / count)
        return slope


def lure(omega) -> FeedbackSystem:
    """Return Lur'e's system in cycles of a frequency, alpha its last unknown: x(3) + alpha x(2) + x(1) + x = x^2."""

    def rate(y, t):
        x, v, a, alpha = y
        return np.array([v, a, -alpha * a - v - x + x * x, 0 * x])

    def slope(y, t):
        x, _, a, alpha = y
        zero, one = 0 * x, 0 * x + 1
        last = [-one + 2 * x, -one, -alpha, -a]
        return np.array([[zero, one, zero, zero], [zero, zero, one, zero], last, [zero] * 4])

    return FeedbackSystem(rate, slope, 2 * math.pi / omega, None, 4)
