"""Manufactured motions of a line in Cartesian positions: the load that makes a chosen motion exact.

With s the unstretched arc length, r(s, t) the position, v = r_t, e = |r_s| - 1, tau = r_s / |r_s| and e' = tau . r_st,

    (m + ma) r_tt - ma (r_tt . tau) tau = (T tau)_s - w e_z + drag + seabed + q
    T      = max(EA (e + beta e'), 0)
    drag   = -rho d sqrt(1 + e) / 2 (Cdn |u_n| u_n + pi Cdt |u_t| u_t tau),   u = v - current, u_t = u . tau,
                                                                               u_n = u - u_t tau
    seabed = N (e_z - mu v_h / sqrt(v_h . v_h + v_0^2)),   N = max(k p - c z_t, 0) where p = -depth - z > 0, else 0

with ma = Ca rho pi d^2 / 4 and v_h the horizontal part of v. All loads are per unit unstretched length; q is the load
that has to be added for r to be a solution. The motion is the straight line plus waves

    A (cos(k s + n omega t + phase) - cos(n omega t + phase)),

which vanish at s = 0 and whose partial derivatives of any order are written down by quarter turns of the phase.
Components are x, y, z with z up, or x, z for a planar line. SI units, radians.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

DIRECTION = (1.08, 0.15, 0.10)  # r_s of the straight line, so that it is stretched by some percent before any wave
WAVES = (
    # A / length (x, y, z), k length, n, phase
    ((-0.015, 0.130, 0.210), 2.1, 0, 1.0),
    ((0.012, -0.045, 0.045), 3.7, 0, 2.9),
    ((0.006, 0.006, 0.005), 3.1, 1, 0.2),
    ((-0.005, 0.005, 0.005), -2.6, 1, 1.7),
    ((0.002, -0.002, 0.002), 2.9, 2, 2.6),
)
"""Waves of the shape, lengths in units of the line's: two that stand still and bend the line, two that run up and down
it once a period, and one that runs twice a period."""
QUARTER = np.pi / 2


@dataclass(frozen=True)
class ManufacturedLine:
    """A line with a chosen periodic motion and the load that it needs; a coefficient of zero switches its term off.

    length : m, unstretched;  omega : rad/s of the motion, 0 for a manufactured problem of statics
    anchor : (x, y, z), m, of the end s = 0;  planar : whether x and z alone are used, of the current too
    EA : N;  beta : s, Kelvin-Voigt damping;  mass, weight : kg/m and N/m (submerged), unstretched
    rho, d, Ca, Cdn, Cdt : kg/m^3, m, coefficients as in the module's equations;  current : (x, y, z), m/s, steady
    depth : m, the seabed lies at z = -depth;  seabed_stiffness, seabed_damping : k in N/m^2 and c in N s/m^2
    friction, friction_speed : mu and v_0 in m/s;  contact_depth : p_0 in m, over which the damping grows to c

    With the values of `ALL_TERMS` the line is taut everywhere and lies wholly inside the seabed, which never lets go,
    and no relative velocity along or across the line vanishes: q is then a smooth function of s and t. With another
    depth the line crosses the seabed's surface; without current the drag is once differentiable only.
    """

    length: float
    omega: float
    EA: float
    beta: float
    mass: float
    weight: float
    rho: float
    d: float
    Ca: float
    Cdn: float
    Cdt: float
    current: tuple[float, float, float]
    depth: float
    seabed_stiffness: float
    seabed_damping: float
    friction: float
    friction_speed: float
    anchor: tuple[float, float, float] = (0.0, 0.0, -80.0)
    planar: bool = False
    contact_depth: float = 0.0

    @property
    def components(self):
        """Return the places of the line's components among x, y, z."""
        return [0, 2] if self.planar else [0, 1, 2]

    def derivative(self, s, t, s_order, t_order):
        """Return the partial derivative of the position of the given orders, ndarray (n, *s.shape, *t.shape).

        s, t : unstretched arc lengths in m and times in s, of any shapes; n = 2 or 3 components. Orders 0, 0 give r.
        """
        s, t = np.asarray(s, float), np.asarray(t, float)
        shape = (-1,) + (1,) * (s.ndim + t.ndim)
        s, t = np.broadcast_arrays(s.reshape(s.shape + (1,) * t.ndim), t)
        total = np.zeros((len(self.components), *s.shape))
        if t_order == 0 and s_order < 2:
            direction = np.array(DIRECTION)[self.components].reshape(shape)
            total += direction if s_order else np.array(self.anchor)[self.components].reshape(shape) + direction * s
        for amplitude, k_length, n, phase in WAVES:
            k, rate = k_length / self.length, n * self.omega
            turn = rate * t + phase + QUARTER * (s_order + t_order)
            wave = k**s_order * rate**t_order * np.cos(k * s + turn)
            if s_order == 0:
                wave = wave - rate**t_order * np.cos(turn)
            total += self.length * np.array(amplitude)[self.components].reshape(shape) * wave
        return total

    def position(self, s, t):
        """Return the position r in m, ndarray (n, *s.shape, *t.shape)."""
        return self.derivative(s, t, 0, 0)

    def velocity(self, s, t):
        """Return r_t in m/s, shaped as the position."""
        return self.derivative(s, t, 0, 1)

    def acceleration(self, s, t):
        """Return r_tt in m/s^2, shaped as the position."""
        return self.derivative(s, t, 0, 2)

    def tension(self, s, t):
        """Return the tension T in N, ndarray (*s.shape, *t.shape)."""
        return np.maximum(self._stretch(s, t).force, 0.0)

    def forces(self, s, t):
        """Return the forces on the line per unit unstretched length in N/m by name, each shaped as the position.

        They are those of the equation's right side without q, and minus its left side as "inertia" and "added mass".
        """
        stretch = self._stretch(s, t)
        tau = stretch.tau
        a = self.acceleration(s, t)
        normal, friction = self._seabed(s, t)
        normal_drag, tangential_drag = self._drag(stretch, self.velocity(s, t))
        up = self._up(a)
        return {
            "tension": stretch.force_slope,
            "inertia": -self.mass * a,
            "added mass": -self.Ca * self.rho * np.pi * self.d**2 / 4 * (a - _dot(a, tau) * tau),
            "normal drag": normal_drag,
            "tangential drag": tangential_drag,
            "weight": -self.weight * up,
            "seabed": normal * up,
            "friction": friction,
        }

    def load(self, s, t):
        """Return q in N/m, the load to add to the right side, shaped as the position."""
        return -sum(self.forces(s, t).values())

    def _up(self, like):
        return np.eye(len(self.components))[-1].reshape((-1,) + (1,) * (like.ndim - 1))

    def _stretch(self, s, t):
        r_s, r_ss, r_st, r_sst = (self.derivative(s, t, i, j) for i, j in ((1, 0), (2, 0), (1, 1), (2, 1)))
        return _Stretch(self, r_s, r_ss, r_st, r_sst)

    def _drag(self, stretch, velocity):
        """Return the normal and the tangential drag."""
        current = np.array(self.current)[self.components].reshape((-1,) + (1,) * (velocity.ndim - 1))
        u = velocity - current
        u_t = _dot(u, stretch.tau)
        u_n = u - u_t * stretch.tau
        size = -self.rho * self.d / 2 * np.sqrt(stretch.length)
        normal = size * self.Cdn * np.sqrt(_dot(u_n, u_n)) * u_n
        return normal, size * np.pi * self.Cdt * np.abs(u_t) * u_t * stretch.tau

    def _seabed(self, s, t):
        """Return the normal force N, and the friction as a vector."""
        v = self.velocity(s, t)
        penetration = -self.depth - self.position(s, t)[-1]
        damping = self.seabed_damping
        if self.contact_depth:
            damping = damping * np.clip(penetration / self.contact_depth, 0.0, 1.0)
        normal = np.maximum(self.seabed_stiffness * penetration - damping * v[-1], 0.0) * (penetration > 0)
        horizontal = v * (1 - self._up(v))
        speed = np.sqrt(_dot(horizontal, horizontal) + self.friction_speed**2)
        return normal, -self.friction * normal * horizontal / speed


class _Stretch:
    """Length |r_s| = 1 + e, tangent tau, force EA (e + beta e') without the limit at zero, and (T tau)_s."""

    def __init__(self, line, r_s, r_ss, r_st, r_sst):
        self.length = np.sqrt(_dot(r_s, r_s))
        self.tau = r_s / self.length
        strain_slope = _dot(self.tau, r_ss)
        tau_s = (r_ss - strain_slope * self.tau) / self.length
        rate, rate_slope = _dot(self.tau, r_st), _dot(tau_s, r_st) + _dot(self.tau, r_sst)
        self.force = line.EA * (self.length - 1 + line.beta * rate)
        slope = line.EA * (strain_slope + line.beta * rate_slope)
        self.force_slope = (slope * self.tau + self.force * tau_s) * (self.force > 0)


def _dot(a, b):
    return (a * b).sum(axis=0)


# --- chosen lines -----------------------------------------------------------------------------------------------------

ALL_TERMS = ManufacturedLine(
    length=100.0,
    omega=0.6,
    EA=2.5e4,
    beta=2.0,
    mass=110.0,
    weight=60.0,
    rho=1025.0,
    d=0.35,
    Ca=1.4,
    Cdn=0.2,
    Cdt=0.02,
    current=(-1.8, 0.8, 1.2),
    depth=50.0,
    seabed_stiffness=2.0,
    seabed_damping=75.0,
    friction=0.9,
    friction_speed=0.4,
)
"""Every term switched on, each with a root mean square of some 40 to 80 N/m."""

_ALL = ("EA", "beta", "mass", "weight", "Ca", "Cdn", "Cdt", "seabed_stiffness", "seabed_damping", "friction")
BARE = replace(ALL_TERMS, **dict.fromkeys(_ALL, 0.0), current=(0.0, 0.0, 0.0))
"""No term at all: q vanishes."""

_ON = {
    "tension": ("EA",),
    "tension and damping": ("EA", "beta"),
    "inertia": ("mass",),
    "added mass": ("Ca",),
    "normal drag": ("Cdn",),
    "normal drag in a current": ("Cdn", "current"),
    "tangential drag": ("Cdt",),
    "tangential drag in a current": ("Cdt", "current"),
    "weight": ("weight",),
    "seabed": ("seabed_stiffness",),
    "seabed and damping": ("seabed_stiffness", "seabed_damping"),
    "seabed and friction": ("seabed_stiffness", "friction"),
}
ONE_TERM = {name: replace(BARE, **{key: getattr(ALL_TERMS, key) for key in keys}) for name, keys in _ON.items()}
"""`ManufacturedLine` with one term switched on, and what it cannot be without."""
