"""Manufactured solutions of the mooring-cable equations: the source that makes chosen fields exact.

Written in vectors, not in the component rows of Chen, Basu and Nielsen (2019), (1)-(12), whose result it must equal.
With r(s, t) the position, s the unstretched arc length, V = r_t the velocity, t the unit tangent:

    momentum       m V_t = (T t)_s - w_e z_hat + drag + hydrodynamic inertia
    compatibility  V_s = ((1 + eps) t)_t
    position       z_s = (1 + eps) t . z_hat

projected on the frame t, n, b of the line. T = EA (eps + beta eps_t), beta in s (Kelvin-Voigt). The hydrodynamic
inertia per unit unstretched length along e = n, b is -ma d(V . e)/dt + Cm rho A d(c . e)/dt, with c the current,
A = pi d^2/4, ma = Ca rho A, Cm = 1 + Ca. Drag acts on the relative velocity, with sqrt(1 + eps). A flat elastic seabed
bears with max(k (-depth - z), 0).

Vectors are written in the paper's axes (up, along, out) = (z, x, y):
t = (cos phi cos theta, sin phi cos theta, -sin theta), n = t_phi / cos theta, b = t x n = -t_theta. With this choice
the projections are the paper's rows with the paper's signs: momentum along t, n, b, compatibility along t, n, b, and
position. State order: eps, u, v, w (velocities along t, n, b), phi, theta, and z. SI units, radians.

A source is the left side of the rows M y_t + K y_s + f evaluated with the chosen fields: subtract it from the rows and
the fields solve them. `source` differentiates numerically in mpmath, `source_grid` exactly, by jets.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import mpmath
import numpy as np
from mpmath import mp, mpf

FIELDS = ("eps", "u", "v", "w", "phi", "theta", "z")
PLANAR_FIELDS, PLANAR_ROWS = [0, 1, 2, 4], [0, 1, 3, 4]


@dataclass(frozen=True)
class CableParameters:
    """EA N; m kg/m; w0 N/m (submerged, unstretched); d m; rho kg/m^3; coefficients; beta s; current (x, y, z) m/s.

    seabed_stiffness : N/m^2, None for no seabed; depth : m, the seabed lies at z = -depth.
    """

    EA: float
    m: float
    w0: float
    d: float
    rho: float
    Ca: float
    Cdn: float
    Cdb: float
    Cdt: float
    beta: float
    current: tuple[float, float, float]
    seabed_stiffness: float | None
    depth: float


@dataclass(frozen=True)
class Fields:
    """Seven closed-form fields of (s, t), written with `sin`, `cos`, `exp` of this module so that jets can pass."""

    eps: Callable
    u: Callable
    v: Callable
    w: Callable
    phi: Callable
    theta: Callable
    z: Callable

    def velocity(self, s, t):
        """ndarray (3, N, *S): velocity in the axes x, y, z, m/s; at s = L that of the fairlead."""
        _, u, v, w, phi, theta, _ = derivatives(self, s, t)[0]
        up, along, out = _vector((u, v, w), _frame(phi, theta))
        return np.array([along, out, up])

    def steady(self, t0=0.0):
        """The same fields frozen at time t0: still moving through the frame, but independent of time."""
        return Fields(**{name: partial(_frozen, getattr(self, name), t0) for name in FIELDS})

    def at_rest(self, t0=0.0):
        """Frozen at time t0 and without velocity: the manufactured problem of statics."""
        return replace(self.steady(t0), u=_zero, v=_zero, w=_zero)


def _frozen(field, t0, s, t):
    return field(s, 0 * t + t0)


def _zero(s, t):
    return 0 * s * t


# --- arithmetic -------------------------------------------------------------------------------------------------------


class Jet:
    """a + b ds + c dt + e ds dt: a function's value and derivatives f, f_s, f_t, f_st; parts are mpf or arrays."""

    __array_ufunc__ = None  # an array times a jet is a jet, not an array of jets
    __slots__ = ("a", "b", "c", "e")

    def __init__(self, a, b=0, c=0, e=0):
        self.a, self.b, self.c, self.e = a, b, c, e

    def __add__(self, other):
        o = _jet(other)
        return Jet(self.a + o.a, self.b + o.b, self.c + o.c, self.e + o.e)

    def __mul__(self, other):
        o = _jet(other)
        mixed = self.a * o.e + self.b * o.c + self.c * o.b + self.e * o.a
        return Jet(self.a * o.a, self.a * o.b + self.b * o.a, self.a * o.c + self.c * o.a, mixed)

    def __neg__(self):
        return self * -1

    def __sub__(self, other):
        return self + -_jet(other)

    def __rsub__(self, other):
        return -self + other

    def of(self, f, slope, curvature):
        """The jet of a function of this one, from its value, first and second derivative at `a`."""
        return Jet(f, slope * self.b, slope * self.c, slope * self.e + curvature * self.b * self.c)

    __radd__ = __add__
    __rmul__ = __mul__


def _jet(x):
    return x if isinstance(x, Jet) else Jet(x)


def _library(x):
    return mp if isinstance(x, mpf) else np


def sin(x):
    """Sine of a number, an array, an mpf or a jet of them."""
    if isinstance(x, Jet):
        f, g = sin(x.a), cos(x.a)
        return x.of(f, g, -f)
    return _library(x).sin(x)


def cos(x):
    """Cosine, likewise."""
    if isinstance(x, Jet):
        f, g = cos(x.a), sin(x.a)
        return x.of(f, -g, -f)
    return _library(x).cos(x)


def exp(x):
    """Exponential, likewise."""
    if isinstance(x, Jet):
        f = exp(x.a)
        return x.of(f, f, f)
    return _library(x).exp(x)


def _frame(phi, theta):
    """t, n, b, each (up, along, out); b is the cross product of the others."""
    sp, cp, st, ct = sin(phi), cos(phi), sin(theta), cos(theta)
    t, n = (cp * ct, sp * ct, -1 * st), (-1 * sp, cp, 0 * cp)
    return t, n, tuple(t[i] * n[j] - t[j] * n[i] for i, j in ((1, 2), (2, 0), (0, 1)))


def _vector(parts, frame):
    """The vector, (up, along, out), with these components along t, n, b."""
    return [_dot(parts, components) for components in zip(*frame, strict=True)]


def _in_paper_axes(xyz):
    return xyz[2], xyz[0], xyz[1]


def _dot(a, b):
    return sum(x * y for x, y in zip(a, b, strict=True))


# --- the equations, once, in vectors ----------------------------------------------------------------------------------


def seabed_support(p, z):
    """max(k (-depth - z), 0), N/m."""
    support = p.seabed_stiffness * (-p.depth - z)
    return max(support, mpf(0)) if isinstance(support, mpf) else np.maximum(support, 0.0)


def _drag(p, eps, velocity, frame):
    """Drag vector per unit unstretched length: Cdt on pi d along t, Cdn and Cdb on d across, N/m."""
    sqrt = _library(eps).sqrt
    relative = [V - c for V, c in zip(velocity, _in_paper_axes(p.current), strict=True)]
    ur, vr, wr = (_dot(relative, e) for e in frame)
    across = sqrt(vr * vr + wr * wr)
    size = -p.rho * p.d / 2 * sqrt(1 + eps)
    along = size * _library(eps).pi * p.Cdt * abs(ur) * ur
    parts = along, size * p.Cdn * vr * across, size * p.Cdb * wr * across
    return _vector(parts, frame)


def _hydrodynamic_inertia(p, frame, velocity_rates, current_rates, area):
    """Vector along n and b from the rates d(V . e)/dt and d(c . e)/dt, e = n, b, N/m."""
    forces = [
        p.rho * area * ((1 + p.Ca) * dc - p.Ca * dV) for dV, dc in zip(velocity_rates, current_rates, strict=True)
    ]
    return [sum(f * e[i] for f, e in zip(forces, frame[1:], strict=True)) for i in range(3)]


@dataclass(frozen=True)
class _Point:
    """Values and derivatives that the equations need, whoever differentiated them."""

    eps: object
    z: object
    frame: tuple  # t, n, b
    V: list
    V_s: list
    V_t: list
    force_s: list  # (T t)_s
    stretched_t: list  # ((1 + eps) t)_t
    velocity_rates: list  # d(V . n)/dt, d(V . b)/dt
    current_rates: list  # d(c . n)/dt, d(c . b)/dt
    z_s: object


def _rows(p, q):
    """The seven rows at a point or on a grid."""
    area = _library(q.eps).pi * p.d * p.d / 4
    support = 0 if p.seabed_stiffness is None else seabed_support(p, q.z)
    drag = _drag(p, q.eps, q.V, q.frame)
    inertia = _hydrodynamic_inertia(p, q.frame, q.velocity_rates, q.current_rates, area)
    momentum = [f + d + i - p.m * a for f, d, i, a in zip(q.force_s, drag, inertia, q.V_t, strict=True)]
    momentum[0] = momentum[0] - (p.w0 - support)
    compatibility = [a - b for a, b in zip(q.V_s, q.stretched_t, strict=True)]
    rows = [_dot(vector, e) for vector in (momentum, compatibility) for e in q.frame]
    return [*rows, q.z_s - (1 + q.eps) * q.frame[0][0]]


# --- derivatives by jets ----------------------------------------------------------------------------------------------


def _point_of_jets(p, fields, s, t):
    eps, u, v, w, phi, theta, z = (_jet(getattr(fields, name)(Jet(s, 1, 0, 0), Jet(t, 0, 1, 0))) for name in FIELDS)
    frame = _frame(phi, theta)
    V = _vector((u, v, w), frame)
    tension = p.EA * (eps + p.beta * Jet(eps.c, eps.e))  # its part in ds alone is needed
    return _Point(
        eps=eps.a,
        z=z.a,
        frame=tuple(tuple(c.a for c in e) for e in frame),
        V=[c.a for c in V],
        V_s=[c.b for c in V],
        V_t=[c.c for c in V],
        force_s=[(tension * c).b for c in frame[0]],
        stretched_t=[((1 + eps) * c).c for c in frame[0]],
        velocity_rates=[_dot(V, e).c for e in frame[1:]],
        current_rates=[_dot(_in_paper_axes(p.current), e).c for e in frame[1:]],
        z_s=z.b,
    )


def _grid(s, t):
    """s (N, 1, ...) and t (1, *S), ready to broadcast to (N, *S)."""
    s, t = np.asarray(s, float), np.asarray(t, float)
    return s.reshape(s.shape + (1,) * t.ndim), t[None]


def _stacked(values, s, t):
    return np.array(
        [np.broadcast_to(np.asarray(value, float), np.broadcast_shapes(s.shape, t.shape)) for value in values]
    )


def _kept(array, chosen, position):
    """The rows or fields of a planar or spatial problem, with or without the position."""
    return array[[*(chosen or range(6)), *([6] if position else [])]]


def source_grid(parameters, fields, s, t, *, planar=False):
    """ndarray (n_f, N, *S): the source at s (N,) m and times t of any shape S, s; derivatives exact.

    Rows: momentum t, n, b, compatibility t, n, b; planar: momentum t, n, compatibility t, n. A seabed adds the row of
    z at the end.
    """
    s, t = _grid(s, t)
    rows = _stacked(_rows(parameters, _point_of_jets(parameters, fields, s, t)), s, t)
    return _kept(rows, PLANAR_ROWS if planar else None, parameters.seabed_stiffness is not None)


def state_grid(parameters, fields, s, t, *, planar=False):
    """y, y_s, y_t, each ndarray (n_f, N, *S): the fields that `source_grid` has rows for, and their derivatives."""
    chosen = PLANAR_FIELDS if planar else None
    return tuple(_kept(part, chosen, parameters.seabed_stiffness is not None) for part in derivatives(fields, s, t))


def derivatives(fields, s, t):
    """y, y_s, y_t, each ndarray (7, N, *S), in the order of `FIELDS`."""
    s, t = _grid(s, t)
    jets = [_jet(getattr(fields, name)(Jet(s, 1, 0, 0), Jet(t, 0, 1, 0))) for name in FIELDS]
    return tuple(_stacked([getattr(jet, part) for jet in jets], s, t) for part in "abc")


def source_by_jets(parameters, fields, s, t):
    """Seven mpf: as `source_grid` at one point, in mpmath."""
    return [+mpf(row) for row in _rows(parameters, _point_of_jets(parameters, fields, mpf(s), mpf(t)))]


# --- derivatives by mpmath --------------------------------------------------------------------------------------------


def source(parameters, fields, s, t, digits=30):
    """Seven mpf: the source at s (m) and t (s), every derivative a difference quotient of mpmath to `digits` digits."""
    p = parameters
    with mpmath.workdps(digits + 10):
        at = mpf(s), mpf(t)

        def value(name, s, t):
            return mpf(getattr(fields, name)(s, t))

        def frame(s, t):
            return _frame(value("phi", s, t), value("theta", s, t))

        def velocity(i, s, t):
            return _vector([value(name, s, t) for name in "uvw"], frame(s, t))[i]

        def along(vector, k, s, t):
            return _dot(vector(s, t), frame(s, t)[k])

        def force(i, s, t):
            strain_rate = mp.diff(partial(value, "eps"), (s, t), (0, 1)) if p.beta else 0
            return p.EA * (value("eps", s, t) + p.beta * strain_rate) * frame(s, t)[0][i]

        def stretched(i, s, t):
            return (1 + value("eps", s, t)) * frame(s, t)[0][i]

        def d_s(f, *first):
            return mp.diff(partial(f, *first), at, (1, 0))

        def d_t(f, *first):
            return mp.diff(partial(f, *first), at, (0, 1))

        def whole_velocity(s, t):
            return [velocity(i, s, t) for i in range(3)]

        point = _Point(
            eps=value("eps", *at),
            z=value("z", *at),
            frame=frame(*at),
            V=whole_velocity(*at),
            V_s=[d_s(velocity, i) for i in range(3)],
            V_t=[d_t(velocity, i) for i in range(3)],
            force_s=[d_s(force, i) for i in range(3)],
            stretched_t=[d_t(stretched, i) for i in range(3)],
            velocity_rates=[d_t(along, whole_velocity, k) for k in (1, 2)],
            current_rates=[d_t(along, lambda s, t: [mpf(c) for c in _in_paper_axes(p.current)], k) for k in (1, 2)],
            z_s=d_s(value, "z"),
        )
        return [+row for row in _rows(p, point)]


# --- chosen fields ----------------------------------------------------------------------------------------------------


def manufactured(parameters, length, omega, *, planar=False, oscillating=False):
    """`Fields` on 0 <= s <= length (m), periodic in time with omega (rad/s): large, smooth, taut, fixed at s = 0.

    eps 3.5e-3 to 7e-3, phi 0.3 to 1.2, theta -0.1 to 0.4, velocities up to 0.6 m/s; z(0, t) = -depth, and the line lies
    in the seabed by up to 0.75 w0/seabed_stiffness (1 m without seabed), so that it never leaves the seabed.

    Velocities are positive for s > 0 and vanish linearly at s = 0, so quadratic drag is a smooth function of s and t in
    still water and in every current with c . t < 0 and c . n < 0, such as `OPPOSING_CURRENT`. With oscillating=True
    they change sign and the line leaves the seabed: drag and support are then only once differentiable and
    continuous, and orders of accuracy should not be read from it.
    planar : theta = w = 0.
    """
    L, sink = float(length), 1.0 if parameters.seabed_stiffness is None else parameters.w0 / parameters.seabed_stiffness
    steady, swing = (0.0, 2.0) if oscillating else (1.0, 1.0)

    def speed(size, share, curve, lag):
        part = share * swing
        return lambda s, t: size * sin(curve / L * s) * (steady + part * sin(omega * t + lag / L * s))

    def eps(s, t):
        return 4.5e-3 + 1.5e-3 / L * s + 1e-3 * cos(2.2 / L * s + 0.4) * sin(omega * t + 0.3)

    def phi(s, t):
        return 1.1 - 0.7 / L * s + 0.15 * sin(2.9 / L * s + 0.5) * cos(omega * t - 0.7 / L * s)

    def theta(s, t):
        return 0.25 * sin(1.7 / L * s + 0.2) + 0.12 * cos(omega * t - 1.1 / L * s + 0.9)

    def z(s, t):
        depth_in = 0.5 + (1.0 if oscillating else 0.25) * sin(omega * t + 1.3 / L * s)
        return -parameters.depth - sink * (s * (2 / L - s * (1 / L / L))) * depth_in

    v, w = speed(0.4, 0.5, 1.5, -0.5), speed(0.3, 0.5, 1.1, 0.8)
    u = speed(0.25, 0.6, 1.2, 1.0)
    return Fields(eps, u, v, _zero if planar else w, phi, _zero if planar else theta, z)


OPPOSING_CURRENT = (-1.0, 0.3, 0.2)
"""x, y, z, m/s. With the fields of `manufactured` the relative velocities along t and n never change sign. Planar
problems take (-1.0, 0.0, 0.2)."""

ALL_TERMS = CableParameters(
    EA=3.84243e8,
    m=77.7066,
    w0=698.094,
    d=0.09,
    rho=1025.0,
    Ca=1.0,
    Cdn=1.6,
    Cdb=1.2,
    Cdt=0.05,
    beta=0.02,
    current=OPPOSING_CURRENT,
    seabed_stiffness=3000.0,
    depth=320.0,
)
"""The line of Chen, Basu and Nielsen, Table 1, with every other term switched on."""

BARE = replace(
    ALL_TERMS, w0=0.0, Ca=0.0, Cdn=0.0, Cdb=0.0, Cdt=0.0, beta=0.0, current=(0.0, 0.0, 0.0), seabed_stiffness=None
)
"""Inertia, tension and compatibility alone."""

_ON = {
    "bare": (),
    "weight": ("w0",),
    "added mass": ("Ca",),
    "normal drag": ("Cdn",),
    "binormal drag": ("Cdb",),
    "tangential drag": ("Cdt",),
    "damping": ("beta",),
    "current inertia": ("current",),
    "current and drag": ("current", "Cdn", "Cdb", "Cdt"),
    "seabed": ("w0", "seabed_stiffness"),
}
ONE_TERM = {name: replace(BARE, **{key: getattr(ALL_TERMS, key) for key in keys}) for name, keys in _ON.items()}
"""`CableParameters` with one term switched on. The seabed carries weight, so it comes with it; a current always brings
its Froude-Krylov force (Cm = 1 + Ca)."""


def in_plane(parameters):
    """The same parameters without the current across the plane."""
    x, _, z = parameters.current
    return replace(parameters, current=(x, 0.0, z))
