"""Waves and free decay: exact motions of a weightless line, some of any size, and small waves on a taut string.

`pulse`, `axial_wave` and `axial_decay` solve the full nonlinear equations of `cable_mp` (no weight, no drag, no seabed;
the pulse without added mass) and are `cable_mp.Fields`: `source_grid` finds no source for them.

A string that runs along its own shape feels no inertia but that of its bends: with a uniform strain eps and
c^2 = T / (m (1 + eps)) every shape r(s - c t) is a free motion, because m c^2 r'' = (T t)'. Adding a translation puts
the straight part ahead of it at rest. SI units.
"""

from __future__ import annotations

import numpy as np
from mpmath import mpf

from verification.exact.cable.cable_mp import Fields, Jet, cos, exp, sin


def _zero(s, t):
    return 0 * s * t


def bump(x, width):
    """cos^8(pi x / (2 width)) within |x| < width, zero outside: seven times differentiable; x number, array or jet."""
    place = x.a if isinstance(x, Jet) else x
    inside = int(abs(place) < width) if isinstance(place, mpf) else 1.0 * (np.abs(place) < width)
    c = cos(x * (np.pi / 2 / width))
    square = c * c
    fourth = square * square
    return fourth * fourth * inside


def string_speed(tension, EA, mass):
    """Speed of a transverse wave along the unstretched arc length, m/s: sqrt(T / ((1 + T/EA) mass))."""
    return np.sqrt(tension / ((1 + tension / EA) * mass))


def pulse(EA, m, tension, *, angles=(1.0, 0.0), bend=(0.6, 0.3), start, width, towards=-1):
    """`Fields` of a bend of any size that runs along a straight taut line at `string_speed`, unchanged.

    tension N; angles (phi, theta) of the straight line and the largest change `bend` of both, rad; at t = 0 the bend
    covers start - width < s < start + width, m; towards = 1 runs to the fairlead, -1 to the anchor. The line is at rest
    outside the bend.
    """
    eps, c = tension / EA, towards * string_speed(tension, EA, m)
    (phi0, theta0), (dphi, dtheta) = angles, bend
    t0 = float(np.cos(phi0) * np.cos(theta0)), float(np.sin(phi0) * np.cos(theta0)), float(-np.sin(theta0))

    def phi(s, t):
        return phi0 + dphi * bump(s - c * t - start, width)

    def theta(s, t):
        return theta0 + dtheta * bump(s - c * t - start, width)

    def speed(part):
        # V = -c (1 + eps) (t - t0), along t, n, b in the axes (up, along, out) of the paper
        def field(s, t):
            a, b = phi(s, t), theta(s, t)
            e = {
                "t": (cos(a) * cos(b), sin(a) * cos(b), -1 * sin(b)),
                "n": (-1 * sin(a), cos(a), 0 * sin(a)),
                "b": (cos(a) * sin(b), sin(a) * sin(b), cos(b)),
            }[part]
            return c * (1 + eps) * (sum(x * y for x, y in zip(e, t0, strict=True)) - (part == "t"))

        return field

    return Fields(lambda s, t: eps + 0 * s * t, speed("t"), speed("n"), speed("b"), phi, theta, _zero)


def axial_wave(EA, m, eps0, size, *, phi=1.0, start, width, towards=-1):
    """`Fields` of a pulse of strain on a straight line: eps = eps0 + size bump, u = -+ c size bump, c = sqrt(EA/m)."""
    c = towards * float(np.sqrt(EA / m))

    def eps(s, t):
        return eps0 + size * bump(s - c * t - start, width)

    def u(s, t):
        return -c * size * bump(s - c * t - start, width)

    return Fields(eps, u, _zero, _zero, lambda s, t: phi + 0 * s * t, _zero, _zero)


def axial_decay(EA, m, beta, L, eps0, size, *, mode=1, phi=1.0):
    """`Fields` of a standing axial wave between fixed ends that Kelvin-Voigt damping (beta, s) wears down.

    Displacement (size / k) sin(k s) g(t), k = mode pi / L, omega = k sqrt(EA/m), g'' + beta omega^2 g' + omega^2 g = 0,
    g(0) = 1, g'(0) = 0; light damping, beta omega < 2. size is the strain amplitude at t = 0.
    """
    k = mode * float(np.pi) / L
    omega = k * float(np.sqrt(EA / m))
    rate = beta * omega**2 / 2
    turning = float(np.sqrt(omega**2 - rate**2))

    def g(t):
        return exp(-rate * t) * (cos(turning * t) + rate / turning * sin(turning * t))

    def g_t(t):
        return -(omega**2) / turning * (exp(-rate * t) * sin(turning * t))

    def eps(s, t):
        return eps0 + size * (cos(k * s) * g(t))

    def u(s, t):
        return size / k * (sin(k * s) * g_t(t))

    return Fields(eps, u, _zero, _zero, lambda s, t: phi + 0 * s * t, _zero, _zero)


# --- small waves on a taut string -------------------------------------------------------------------------------------


def plucked_string(shape, speed, L, s, t):
    """Displacement at (s, t) of a string held at 0 and L, released from rest with shape(s), by d'Alembert's formula.

    The shape is continued oddly about both ends and halved into two waves; shape is called on [0, L] only.
    """
    s, t = np.asarray(s, float), np.asarray(t, float)
    return (_odd(shape, L, s - speed * t) + _odd(shape, L, s + speed * t)) / 2


def plucked_string_velocity(slope, speed, L, s, t):
    """Velocity of `plucked_string` from slope(s), the derivative of the shape on [0, L]."""
    s, t = np.asarray(s, float), np.asarray(t, float)
    return speed / 2 * (_even(slope, L, s + speed * t) - _even(slope, L, s - speed * t))


def _folded(L, s):
    """(place in [0, L], whether on a mirrored stretch) of s in the continuation with period 2 L."""
    s = np.mod(s, 2 * L)
    return np.where(s > L, 2 * L - s, s), s > L


def _odd(f, L, s):
    place, mirrored = _folded(L, s)
    return np.where(mirrored, -1, 1) * f(place)


def _even(f, L, s):
    return f(_folded(L, s)[0])
