"""A mass on one elastic cell that goes slack and snaps taut, and a mass that bounces on the seabed: exact, in pieces.

In both the mass moves up and down only. With x downwards, the stretch of the cell or the penetration of the seabed,

    M x'' = W - max(k x + c x', 0),

where the seabed bears only while x > 0. While the force acts the motion is a damped oscillation about W / k, else a
free fall with W / M. The force k (x + (c / k) x') is itself an oscillation, so the time at which it ends is bracketed
by its extremes, which are known in closed form, and is computed by bisection in mpmath; a fall ends at the root of a
parabola.
An event is thus exact to the digits of a double however many went before. Any mass, no added mass. SI units.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from mpmath import mp, mpf

DIGITS = 40
MOST_EVENTS = 10_000


@dataclass(frozen=True)
class ElasticBounce:
    """A mass that hangs on a massless elastic cell below an anchor at z = 0, in vacuo.

    mass : kg;  weight : N, W > 0;  length, EA : of the cell, m (unstretched) and N;  beta : s, Kelvin-Voigt damping
    position, velocity : z < 0 in m and z_t in m/s, upwards, at t = 0

    The tension is max(EA (e + beta e'), 0) with e = -z / length - 1. With damping it ends before the cell is back at
    its unstretched length and begins before it is there again.
    """

    mass: float
    weight: float
    length: float
    EA: float
    position: float
    velocity: float
    beta: float = 0.0

    def motion(self, t):
        """Return z in m, z_t in m/s and the tension in N at times t >= 0 of any shape, each shaped as t.

        Raises ValueError where the mass is thrown up to the anchor, for the cell would turn over.
        """
        x, v, force = self._contact.evaluate(t)
        if min(piece.highest for piece in self._contact.pieces(np.max(t, initial=0.0))) <= -self.length:
            raise ValueError("the mass reaches the anchor: throw it with less speed or from further down")
        return -(self.length + x), -v, force

    def events(self, duration):
        """Return (time in s as mpf, "taut" or "slack") of every change in 0 < t <= duration, in order."""
        pieces = self._contact.pieces(duration)[1:]
        return [(piece.begin, "taut" if piece.bears else "slack") for piece in pieces if piece.begin <= duration]

    @cached_property
    def _contact(self):
        k = mpf(self.EA) / self.length
        stretch = -mpf(self.position) - mpf(self.length)
        return _Contact(self.mass, self.weight, k, k * mpf(self.beta), stretch, -self.velocity, one_sided=False)


@dataclass(frozen=True)
class SeabedBounce:
    """A mass dropped on a flat seabed with a spring and a damper that never pull: N = max(k p - c z_t, 0) where p > 0.

    mass : kg;  weight : N, W > 0;  depth : m, p = -depth - z;  stiffness : k in N/m;  damping : c in N s/m
    position, velocity : z in m and z_t in m/s, upwards, at t = 0
    """

    mass: float
    weight: float
    depth: float
    stiffness: float
    position: float
    velocity: float
    damping: float = 0.0

    def motion(self, t):
        """Return z in m, z_t in m/s and the normal force N in N at times t >= 0 of any shape, each shaped as t."""
        x, v, force = self._contact.evaluate(t)
        return -(self.depth + x), -v, force

    def events(self, duration):
        """Return (time in s as mpf, "contact" or "free") of every change in 0 < t <= duration, in order."""
        pieces = self._contact.pieces(duration)[1:]
        return [(piece.begin, "contact" if piece.bears else "free") for piece in pieces if piece.begin <= duration]

    def seabed_work(self, t):
        """Return the work of the mass on the seabed until t, the integral of -N z_t, in J, shaped as t.

        It is what the mass has lost of its kinetic and potential energy; the spring gives part of it back.
        """
        x, v, _ = self._contact.evaluate(t)
        start = -mpf(self.depth) - mpf(self.position)
        return self.mass / 2 * (self.velocity**2 - v**2) + self.weight * (x - float(start))

    def damper_work(self, t):
        """Return the energy lost to the damper while it bears until t, the integral of c z_t^2 where N > 0, in J.

        A spring that is still compressed when the damper lets the mass go keeps k p^2 / 2 beside that, which the mass
        does not get back.
        """
        return self._contact.damper_work(t)

    @cached_property
    def _contact(self):
        start = -mpf(self.depth) - mpf(self.position)
        return _Contact(
            self.mass, self.weight, mpf(self.stiffness), mpf(self.damping), start, -self.velocity, one_sided=True
        )


# --- the pieces -------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Piece:
    """A stretch of time from `begin` with x, v there; whether the force bears; highest: least x of a fall, else x."""

    begin: object
    x: object
    v: object
    bears: bool
    highest: object
    damper_work: object  # before it begins


class _Contact:
    """Motion with max(k x + c x', 0), one_sided: only where x > 0."""

    def __init__(self, mass, weight, stiffness, damping, x, v, *, one_sided):
        if not (mass > 0 and weight > 0 and stiffness > 0 and damping >= 0):
            raise ValueError("mass, weight and stiffness must be positive and the damping not negative")
        self.M, self.W, self.k, self.c = mpf(mass), mpf(weight), mpf(stiffness), mpf(damping)
        self.one_sided = one_sided
        with mp.workdps(DIGITS):
            self.lag = self.c / self.k
            self.decay = self.c / self.M / 2
            self.turning = self.decay**2 - self.k / self.M  # negative for an oscillation
            self._pieces, self._last = [self._piece(mpf(0), mpf(x), mpf(v), mpf(0))], False

    def pieces(self, duration):
        """Return the pieces that begin before `duration`, and perhaps one more."""
        with mp.workdps(DIGITS):
            while not self._last and self._pieces[-1].begin <= duration:
                if len(self._pieces) > MOST_EVENTS:
                    raise ArithmeticError(f"more than {MOST_EVENTS} events in {float(duration):g} s")
                piece = self._pieces[-1]
                length = self._until_release(piece.x, piece.v) if piece.bears else self._until_contact(piece.x, piece.v)
                if length is None:
                    self._last = True
                    break
                x, v = self._state(piece, length)
                work = piece.damper_work + (self._lost(piece, x, v) if piece.bears else 0)
                self._pieces.append(self._piece(piece.begin + length, x, v, work, bears=not piece.bears))
        return self._pieces

    def evaluate(self, t):
        """Return x, v and the force at times t, doubles."""
        t = np.asarray(t, float)
        x, v, force = (np.zeros(t.shape) for _ in range(3))
        for piece, here in self._pieces_at(t):
            tau = t[here] - float(piece.begin)
            x[here], v[here] = self._state(piece, tau)
            if piece.bears:
                force[here] = np.maximum(float(self.k) * x[here] + float(self.c) * v[here], 0.0)
        return x, v, force

    def damper_work(self, t):
        """Return the integral of c v^2 over the times of contact until t."""
        t = np.asarray(t, float)
        work = np.zeros(t.shape)
        for piece, here in self._pieces_at(t):
            work[here] = float(piece.damper_work)
            if piece.bears:
                x, v = self._state(piece, t[here] - float(piece.begin))
                work[here] += self._lost(piece, x, v, number=float)
        return work

    def _pieces_at(self, t):
        if np.any(t < 0):
            raise ValueError("times must not be negative")
        pieces = self.pieces(np.max(t, initial=0.0))
        which = np.searchsorted([float(piece.begin) for piece in pieces], t, side="right") - 1
        return [(pieces[j], which == j) for j in np.unique(which)]

    def _piece(self, begin, x, v, work, bears=None):
        """Return the piece that begins here; whether the force bears follows from x and v unless it is given."""
        if bears is None:
            force, rate = x + self.lag * v, v + self.lag * self.W / self.M
            bears = force > 0 or (force == 0 and rate >= 0)
            if self.one_sided:
                bears = bears and (x > 0 or (x == 0 and v >= 0))
        highest = x if bears or v >= 0 else x - v * v * self.M / (2 * self.W)
        return _Piece(begin, x, v, bears, highest, work)

    def _lost(self, piece, x, v, number=mpf):
        """Return the energy lost to the damper from the beginning of a piece of contact to x, v."""
        M, W, k, x0, v0 = (number(a) for a in (self.M, self.W, self.k, piece.x, piece.v))
        return M / 2 * (v0 - v) * (v0 + v) + (x - x0) * (W - k / 2 * (x + x0))

    def _state(self, piece, tau):
        """Return x, v at tau after the beginning, mpf or arrays."""
        number = mpf if isinstance(tau, mpf) else float
        M, W, k, a, x0, v0 = (number(b) for b in (self.M, self.W, self.k, self.decay, piece.x, piece.v))
        if not piece.bears:
            return x0 + tau * (v0 + W / M / 2 * tau), v0 + W / M * tau
        h, (C, S) = number(piece.x - self.W / self.k), self._waves(tau)
        return W / k + h * C + (v0 + a * h) * S, v0 * C - (a * v0 + k / M * h) * S

    def _waves(self, tau):
        """Return exp(-a tau) times cos(w tau) and sin(w tau) / w, where w^2 = k/M - a^2 may be negative."""
        lib, number = (mp, mpf) if isinstance(tau, mpf) else (np, float)
        a, w = number(self.decay), number(mp.sqrt(abs(self.turning)))
        if self.turning == 0:
            return lib.exp(-a * tau), tau * lib.exp(-a * tau)
        if self.turning < 0:
            return lib.exp(-a * tau) * lib.cos(w * tau), lib.exp(-a * tau) * lib.sin(w * tau) / w
        slow = number(-self.k / self.M / (self.decay + mp.sqrt(self.turning)))  # -a + w without cancellation
        rest = lib.expm1(-2 * w * tau)
        return lib.exp(slow * tau) * (1 + rest / 2), -lib.exp(slow * tau) * rest / (2 * w)

    def _until_release(self, x, v):
        """Return how long the force stays positive, None where it does so for ever.

        f = x + (c/k) v falls to a first minimum, the lowest of all, and is negative there if it ever is.
        """
        f, rate = x + self.lag * v, v + self.lag * (self.W - self.k * x - self.c * v) / self.M
        h = f - self.W / self.k

        def force(tau):
            C, S = self._waves(tau)
            return self.W / self.k + h * C + (rate + self.decay * h) * S

        # f' = exp(-a tau) (rate C - slope S) is zero where S / C = rate / slope
        slope, w = self.decay * rate + self.k / self.M * h, mp.sqrt(abs(self.turning))
        if self.turning < 0:
            first = mp.atan2(w * rate, slope) % mp.pi / w
            above, lowest = (0, first) if rate < 0 else (first, first + mp.pi / w)
        else:
            reached = rate / slope if slope else mpf(-1)
            if rate >= 0 or reached <= 0 or reached * w >= 1:
                return None
            above, lowest = 0, reached if w == 0 else mp.atanh(w * reached) / w
        return _root(force, mpf(above), lowest) if force(lowest) < 0 else None

    def _until_contact(self, x, v):
        """Return how long the mass falls freely."""
        g = self.W / self.M
        tau = _later_root(g, v + self.lag * g, x + self.lag * v)
        if self.one_sided and x + tau * (v + g / 2 * tau) <= 0:
            return _later_root(g, v, x)
        return tau


def _later_root(g, v, x):
    """Return the later root of x + v tau + g tau^2 / 2 with g > 0; where x is a rounding error, that with v < 0."""
    root = mp.sqrt(max(v * v - 2 * g * x, 0))
    return (root - v) / g if v <= 0 else -2 * x / (root + v)


def _root(f, a, b):
    """Return the root of f between a, where it is not negative, and b, where it is."""
    for _ in range(mp.prec + 4):
        middle = (a + b) / 2
        a, b = (middle, b) if f(middle) > 0 else (a, middle)
    return (a + b) / 2
