"""Cases of the problem type "oscillator": masses in a row with nonlinear springs and dampers, one mass or many.

A row is a ChainSystem, the contract that the dynamic solvers take. Mass n (from 0) hangs on spring n, mass 0 on a wall:

    m q_n'' + c q_n' + d |q_n'| q_n' + p_n(q_n - q_(n-1)) - p_(n+1)(q_(n+1) - q_n) = F_n(t),
    p(x) = k x + k2 x^2 + k3 x^3.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from solvers.numerics.chain import ChainSystem, Residual


@dataclass(frozen=True, eq=False)
class MassChain(ChainSystem):
    """SI units; a number or one value a mass each: m kg, c N s/m, d N s^2/m^2, k N/m, k2 N/m^2, k3 N/m^3.

    force: t (*S) in s -> (N, *S), N, of the period in s. velocity, place: t -> (*S), m/s and m: the last mass is moved
    with this velocity (then no force acts on it), and the mean of its place is that of ``place``. load_factor: of the
    driving, from 0 to 1.
    """

    name: str
    period: float = field()  # without this, the default None of ChainSystem would be taken
    force: Callable
    nodes: int = 1
    m: float | np.ndarray = 1.0
    c: float | np.ndarray = 0.0
    d: float | np.ndarray = 0.0
    k: float | np.ndarray = 1.0
    k2: float | np.ndarray = 0.0
    k3: float | np.ndarray = 0.0
    velocity: Callable | None = None
    place: Callable | None = None
    odd: bool = False  # whether to offer the mirror q -> -q, which half a period later may map the chain to itself
    load_factor: float = 1.0

    fields = ("q", "v", "p")  # place, velocity, force of the spring
    start_rows = 2

    def __post_init__(self):
        for name in ("m", "c", "d", "k", "k2", "k3"):
            object.__setattr__(self, name, np.broadcast_to(np.asarray(getattr(self, name), dtype=float), self.nodes))

    # ------------------------------------------------------------ rows
    def _spring(self, n, x):
        """Return p and dp/dx of springs n at elongations x (len(n), *S)."""
        k, k2, k3 = (_append_sample_axes(a[n], x) for a in (self.k, self.k2, self.k3))
        return x * (k + x * (k2 + x * k3)), k + x * (2 * k2 + 3 * k3 * x)

    def _momentum(self, n, y, ydot, t):
        """Return m v' + c v + d |v| v + p - F of masses n and its derivatives by v and v'."""
        v = y[1, n]
        m, c, d = (_append_sample_axes(a[n], v) for a in (self.m, self.c, self.d))
        speed = np.sqrt(v * v)
        value = m * ydot[1, n] + (c + d * speed) * v + y[2, n] - self.load_factor * self.force(t)[n]
        return value, c + 2 * d * speed, m

    def start(self, y, ydot, t, tangents=True) -> Residual:
        """Return the rows q' = v and of the spring on the wall."""
        p, slope = self._spring(slice(1), y[0, :1])
        value = np.stack([ydot[0, 0] - y[1, 0], y[2, 0] - p[0]])
        if not tangents:
            return Residual(value)
        J, Jt = np.zeros((2, 2, 3, *y.shape[2:]), dtype=y.dtype)
        Jt[0, 0], J[0, 1] = 1.0, -1.0
        J[1, 2], J[1, 0] = 1.0, -slope[0]
        return Residual(value, J, Jt)

    def cells(self, y, ydot, t, tangents=True) -> Residual:
        """Return the rows of the momentum of the left mass, q' = v of the right one, and the spring between."""
        left = slice(0, -1)
        momentum, by_velocity, by_rate = self._momentum(left, y, ydot, t)
        p, slope = self._spring(slice(1, None), y[0, 1:] - y[0, :-1])
        value = np.stack([momentum - y[2, 1:], ydot[0, 1:] - y[1, 1:], y[2, 1:] - p])
        if not tangents:
            return Residual(value)
        J, Jt = np.zeros((2, 2, 3, 3, self.nodes - 1, *y.shape[2:]), dtype=y.dtype)
        J[0, 0, 1], J[0, 0, 2], J[1, 0, 2], Jt[0, 0, 1] = by_velocity, 1.0, -1.0, by_rate
        Jt[1, 1, 0], J[1, 1, 1] = 1.0, -1.0
        J[1, 2, 2], J[0, 2, 0], J[1, 2, 0] = 1.0, slope, -slope
        return Residual(value, J, Jt)

    def end(self, y, ydot, t, tangents=True, correction=0.0) -> Residual:
        """Return the row of the momentum of the last mass, or the velocity with which it is moved."""
        J, Jt = np.zeros((2, 1, 3, *y.shape[2:]), dtype=y.dtype)
        if self.velocity is None:
            value, by_velocity, by_rate = self._momentum(slice(-1, None), y, ydot, t)
            J[0, 1], J[0, 2], Jt[0, 1] = by_velocity[0], 1.0, by_rate[0]
        else:
            value = y[1, -1:] - self.load_factor * self.velocity(t) - correction
            J[0, 1] = 1.0
        return Residual(value, J, Jt) if tangents else Residual(value)

    def scaled(self, load_factor) -> MassChain:
        """Return the same chain with its driving multiplied by a number."""
        return replace(self, load_factor=load_factor * self.load_factor)

    def mirror(self):
        """Return signs that turn everything, for chains with odd springs."""
        return ((-1,) * 3, (-1,) * 2, (-1,) * 3, (-1,)) if self.odd else None

    def drift(self, y, t):
        """Return the position of the last mass less the prescribed one, (1, *S), or None when nothing prescribes it."""
        return None if self.place is None else y[0, -1:] - self.load_factor * self.place(t)

    def drift_tangent(self, y) -> np.ndarray:
        """Return d(drift)/dy, (1, 3, N, *S)."""
        slope = np.zeros((1, *y.shape))
        slope[0, 0, -1] = 1.0
        return slope


def _append_sample_axes(array, like):
    """Return an array (n,) with the axes of the samples of ``like`` (n, *S) appended."""
    return array.reshape(-1, *(1,) * (like.ndim - 1))


def harmonic_force(amplitude, omega, at=0, nodes=1, phase=0.0):
    """Return the force amplitude cos(omega t + phase) on mass ``at`` as a function of t, s -> (N, *S), N."""

    def force(t):
        value = np.zeros((nodes, *np.shape(t)))
        value[at] = amplitude * np.cos(omega * t + phase)
        return value

    return force


def duffing(omega, amplitude, c=0.1, k=1.0, k3=1.0, k2=0.0, d=0.0, m=1.0) -> MassChain:
    """Return the mass of m q'' + c q' + d |q'| q' + k q + k2 q^2 + k3 q^3 = amplitude cos(omega t)."""
    force = harmonic_force(amplitude, omega)
    name = f"one mass, omega = {omega:g}, F = {amplitude:g}"
    return MassChain(name, 2 * math.pi / omega, force, 1, m, c, d, k, k2, k3, odd=k2 == 0)


def cubic_chain(nodes, omega=0.4, amplitude=0.5, c=0.05, k3=1.0, d=0.0) -> MassChain:
    """Return equal masses on cubic springs, the last mass driven: amplitude cos(omega t)."""
    force = harmonic_force(amplitude, omega, nodes - 1, nodes)
    return MassChain(f"{nodes} masses", 2 * math.pi / omega, force, nodes, 1.0, c, d, 1.0, 0.0, k3, odd=True)


def towed_chain(nodes, omega=0.7, amplitude=0.3, c=0.2, k2=0.4, k3=0.5) -> MassChain:
    """Return masses, the last moved as amplitude (sin(omega t) + cos(2 omega t) / 2), its velocity in the end row."""
    place = lambda t: amplitude * (np.sin(omega * t) + 0.5 * np.cos(2 * omega * t))
    velocity = lambda t: amplitude * omega * (np.cos(omega * t) - np.sin(2 * omega * t))
    force = lambda t: np.zeros((nodes, *np.shape(t)))
    period = 2 * math.pi / omega
    return MassChain(
        f"{nodes} masses, towed", period, force, nodes, 1.0, c, 0.0, 1.0, k2, k3, velocity=velocity, place=place
    )


LINEAR = MassChain("linear", 2 * math.pi / 0.7, harmonic_force(0.3, 0.7, 2, 3), 3, 1.3, 0.2, 0.0, 2.0)
"""Three equal masses on linear springs, the last one driven."""
