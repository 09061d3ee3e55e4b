"""Periodic motions of masses with a unilateral spring, piece by piece in closed form: a stop as a soft seabed is one.

    M q'' + D q' + K q + e k max(q_0 - gap, 0) = f cos(omega t),    e on coordinate 0

Out of contact and in it the equations are linear, and with cos and sin of the drive as two more states they are
w' = A w: w(t) = V exp(lambda t) V^-1 w(0) holds to the last digit until contact changes. The force is continuous there,
so a disturbance passes as it is, and the monodromy matrix is the product of the pieces' own. No time step, no series.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

LOOKS = 2000  # places of a period at which contact is looked at: a shorter touch would be missed
HALVINGS = 60
MOST_NEWTON = 30
CLOSED = 1e-12  # of the last step to a closed orbit
POINTS = 64  # of Gauss's quadrature over a piece, for harmonics


@dataclass(frozen=True)
class Masses:
    """Matrices (n, n) of mass, damping and stiffness, forces (n,), stiffness and gap of the spring on coordinate 0."""

    mass: np.ndarray
    damping: np.ndarray
    stiffness: np.ndarray
    force: np.ndarray
    contact: float
    gap: float

    def matrix(self, omega, touches):
        """Return A (2 n + 3, 2 n + 3) of q, q', cos, sin and a constant one."""
        n = len(self.force)
        A, inverse = np.zeros((2 * n + 3, 2 * n + 3)), np.linalg.inv(self.mass)
        K, load = self.stiffness.copy(), np.zeros(n)
        if touches:
            K[0, 0] += self.contact
            load[0] = self.contact * self.gap
        A[:n, n : 2 * n] = np.eye(n)
        A[n : 2 * n, :n], A[n : 2 * n, n : 2 * n] = -inverse @ K, -inverse @ self.damping
        A[n : 2 * n, -3], A[n : 2 * n, -1] = inverse @ self.force, inverse @ load
        A[-3, -2], A[-2, -3] = -omega, omega
        return A


@dataclass(frozen=True)
class ClosedOrbit:
    """Start y (2 n,), multipliers (2 n,) of the monodromy matrix (2 n, 2 n), and the pieces of an orbit."""

    omega: float
    start: np.ndarray
    monodromy: np.ndarray
    pieces: tuple

    @property
    def multipliers(self):
        """Multipliers, largest first."""
        values = np.linalg.eigvals(self.monodromy)
        return values[np.argsort(-abs(values))]

    def amplitude(self, coordinate):
        """Return the amplitude of the first harmonic of a coordinate."""
        nodes, weights = np.polynomial.legendre.leggauss(POINTS)
        total = 0.0
        for begin, length, values, V, c in self.pieces:
            t = (nodes + 1) / 2 * length
            q = (V[coordinate] * c * np.exp(np.outer(t, values))).sum(axis=1).real
            total += length / 2 * np.sum(weights * q * np.exp(1j * self.omega * (begin + t)))
        return abs(total) * self.omega / np.pi


def orbit(masses, omega, start) -> ClosedOrbit:
    """Return the orbit of one period of the drive near a start. Raises ArithmeticError where it does not close."""
    y = np.array(start, dtype=float)
    for _ in range(MOST_NEWTON):
        end, monodromy, pieces = _march(masses, omega, y)
        step = np.linalg.solve(np.eye(y.size) - monodromy, end - y)
        y = y + step
        if abs(step).max() <= CLOSED * (1 + abs(y).max()):
            return ClosedOrbit(omega, y, monodromy, tuple(pieces))
    raise ArithmeticError(f"the orbit at {omega} does not close: last step {abs(step).max():.3g}")


def _march(masses, omega, y):
    """Return the state after a period, the monodromy matrix, and pieces (begin, length, eigenvalues, V, V^-1 w)."""
    size, period = y.size, 2 * np.pi / omega
    w, M = np.concatenate([y, [1.0, 0.0, 1.0]]), np.eye(y.size)
    t, pieces, touches = 0.0, [], y[0] > masses.gap
    while t < period:
        values, V = np.linalg.eig(masses.matrix(omega, touches))
        inverse = np.linalg.inv(V)
        c = inverse @ w
        place = lambda s, V=V, c=c, values=values: (V[0] * c) @ np.exp(np.multiply.outer(values, s)) - masses.gap
        length, turns = _until_contact_changes(place, touches, period - t, period / LOOKS)
        flow = (V * np.exp(values * length)) @ inverse
        pieces.append((t, length, values, V, c))
        w, M = (flow @ w).real, (flow[:size, :size]).real @ M
        t = t + length if turns else period
        touches = not touches if turns else touches
    return w[:size], M, pieces


def _until_contact_changes(place, touches, most, step):
    """Return how long a piece lasts, at most ``most``, and whether contact changes at its end."""
    sign, looks = 1.0 if touches else -1.0, np.minimum(step * np.arange(int(most / step) + 2), most)
    changed = np.flatnonzero(sign * place(looks[1:]).real < 0)
    if not changed.size:
        return most, False
    low, high = looks[changed[0]], looks[changed[0] + 1]
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if sign * place(middle).real > 0 else (low, middle)
    return high, True


def bifurcation(masses, condition, between, start):
    """Return (omega, ClosedOrbit) where a condition of an orbit vanishes between two frequencies, by bisection.

    start: of an orbit at the first of them, which is followed in small steps.
    """
    low, high = between
    first = orbit(masses, low, start)
    sign = np.sign(condition(first))
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        if middle in (low, high):
            break
        trial = orbit(masses, middle, first.start)
        if sign * condition(trial) > 0:
            low, first = middle, trial
        else:
            high = middle
    return low, first


def doubling(closed) -> float:
    """Return det(M + 1), zero at a period doubling."""
    return float(np.linalg.det(closed.monodromy + np.eye(len(closed.start))))


def growth_of_pair(closed) -> float:
    """Return the size of the largest complex multiplier less one, zero at a Neimark-Sacker bifurcation."""
    pairs = closed.multipliers[abs(closed.multipliers.imag) > 0]
    return float(abs(pairs).max(initial=0.0) - 1)
