"""A manufactured motion of three lines that meet at a joint: the loads that make it exact.

Line 0 runs from an anchor to the joint, lines 1 and 2 from the joint to two fairleads on a moving body. With s from 0
to the length l of a line between its ends A(t) and B(t) the motion is

    r(s, t) = A + (B - A) s / l + l sum_k a_k sin(pi k s / l) cos(n omega t + phase),

the joint moves about its mean place by harmonics of omega, and fairleads follow a `RigidMotion`. The strong form

    (m I + ma (I - tau tau')) r_tt = (T tau)_s - w e_z + drag + f,     tau = r_s / |r_s|, e = |r_s| - 1,
    T = EA (e + beta tau . r_st),    drag = -rho d / 2 sqrt(1 + e) (Cdn |u_n| u_n + pi Cdt |u_t| u_t tau)

gives the load f(s, t) on each line; (T tau)_s is a complex step through T tau. The joint's own equation, with the
tensions of the lines that end there, gives its load F(t). On a mesh of cells a node bears f times half of the cells
beside it, the joint F as well: the motion of the nodes then tends to r with the square of the cells' size.
SI units, z up.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from verification.exact.mooring.moving_network import Lines, Mesh, Network, Nodes
from verification.exact.rigid_motion import RigidMotion

STEP = 1e-30
ANCHOR, JOINT, LEFT, RIGHT = range(4)
ENDS = ((ANCHOR, JOINT), (JOINT, LEFT), (JOINT, RIGHT))
PLACES = np.array([(0.0, 0.0, -80.0), (52.0, 4.0, -38.0), (88.0, -14.0, -20.0), (90.0, 16.0, -21.0)])
STRETCH = (1.14, 1.15, 1.14)
"""Of the chords between mean places: by so much each line is longer than unstretched, before any wave."""
WAVES = (
    # line, a (x, y, z), k, n, phase
    (0, (0.010, -0.020, -0.060), 1, 0, 0.0),
    (0, (0.004, 0.012, 0.010), 1, 1, 0.4),
    (0, (-0.002, 0.004, 0.003), 2, 2, 1.9),
    (1, (0.012, 0.020, -0.050), 1, 0, 0.0),
    (1, (-0.004, 0.008, 0.012), 1, 1, 1.2),
    (1, (0.003, -0.003, 0.002), 3, 1, 2.5),
    (2, (-0.008, 0.030, -0.040), 1, 0, 0.0),
    (2, (0.005, -0.010, 0.007), 1, 1, 2.2),
    (2, (0.002, 0.003, -0.004), 2, 2, 0.7),
)
JOINT_WAVES = (((0.8, 0.5, 0.6), 1, 0.3), ((0.1, -0.2, 0.15), 2, 1.4))
"""Amplitudes in m, harmonic, phase."""


@dataclass(frozen=True)
class ManufacturedBridle:
    """Coefficients of the lines and of the joint; three of each line's, or one for all; zero switches a term off.

    omega : rad/s;  EA N;  beta s;  mass, added_mass kg/m;  weight N/m;  d m;  Cdn, Cdt;  current m/s
    joint_mass kg, joint_volume m^3, joint_Ca, joint_CdA m^2, joint_force N : of the joint
    With the default values every line stays taut, and the current keeps all relative velocities from zero.
    """

    omega: float = 0.7
    EA: tuple[float, ...] = (4e4, 3e4, 3.5e4)
    beta: tuple[float, ...] = (0.2, 0.1, 0.15)
    mass: tuple[float, ...] = (40.0, 25.0, 30.0)
    added_mass: tuple[float, ...] = (15.0, 9.0, 12.0)
    weight: tuple[float, ...] = (200.0, 120.0, 150.0)
    d: tuple[float, ...] = (0.15, 0.12, 0.13)
    Cdn: tuple[float, ...] = (1.2, 1.0, 1.1)
    Cdt: tuple[float, ...] = (0.05, 0.04, 0.06)
    current: tuple[float, float, float] = (-1.8, 2.4, -2.4)
    joint_mass: float = 900.0
    joint_volume: float = 0.4
    joint_Ca: float = 0.5
    joint_CdA: float = 0.9
    joint_force: tuple[float, float, float] = (100.0, -50.0, 30.0)
    rho: float = 1025.0
    g: float = 9.81
    motion: RigidMotion = field(
        default_factory=lambda: RigidMotion(
            reference=(95.0, 1.0, -10.0),
            omega=0.7,
            amplitude=(0.9, 0.4, 0.7, 0.03, 0.04, 0.05),
            phase=(0.0, 0.8, 1.7, 0.2, 2.0, 1.1),
        )
    )

    @property
    def lengths(self):
        """Unstretched lengths of the lines, ndarray (3,), m."""
        chords = np.array([PLACES[b] - PLACES[a] for a, b in ENDS])
        return np.sqrt((chords**2).sum(axis=1)) / np.array(STRETCH)

    def ends(self, t, order=0):
        """Return the derivative of order 0, 1 or 2 of anchor, joint and fairleads, ndarray (b, 4, 3), at t (b,)."""
        result = np.zeros((len(t), 4, 3))
        if order == 0:
            result[:] = PLACES
        for a, n, phase in JOINT_WAVES:
            rate = n * self.omega
            result[:, JOINT] += rate**order * np.cos(rate * t + phase + order * np.pi / 2)[:, None] * np.array(a)
        result[:, [LEFT, RIGHT]] = self.motion.kinematics(PLACES[[LEFT, RIGHT]], t)[order]
        return result

    def derivative(self, line, s, t, s_order, t_order):
        """Return a partial derivative of a line's position, (b, n, 3), at s (n,), real or complex, and t (b,).

        s_order : 0 or 1;  t_order : 0, 1 or 2
        """
        l = self.lengths[line]
        ends = self.ends(t, t_order)
        A, B = (ends[:, k][:, None] for k in ENDS[line])
        x = (s / l)[:, None]
        result = A + (B - A) * x if s_order == 0 else (B - A) / l + 0 * x
        for own, a, k, n, phase in WAVES:
            if own == line:
                angle = np.pi * k * s / l
                shape = l * np.sin(angle) if s_order == 0 else np.pi * k * np.cos(angle)
                rate = n * self.omega
                wave = rate**t_order * np.cos(rate * t + phase + t_order * np.pi / 2)
                result = result + wave[:, None, None] * shape[:, None] * np.array(a)
        return result

    def tension_vector(self, line, s, t):
        """Return T tau, (b, n, 3), N; s may be complex."""
        r_s, r_st = (self.derivative(line, s, t, 1, order) for order in (0, 1))
        size = np.sqrt((r_s * r_s).sum(axis=-1, keepdims=True))
        rate = (r_s * r_st).sum(axis=-1, keepdims=True) / size
        return self.EA[line] * (size - 1 + self.beta[line] * rate) * r_s / size

    def tension(self, line, s, t):
        """Return T, (b, n), N."""
        r_s = self.derivative(line, s, t, 1, 0)
        return (self.tension_vector(line, s, t) * r_s).sum(axis=-1) / np.sqrt((r_s * r_s).sum(axis=-1))

    def tension_slope(self, line, s, t):
        """Return (T tau)_s, (b, n, 3), N/m, by a complex step."""
        return self.tension_vector(line, s + STEP * 1j, t).imag / STEP

    def load(self, line, s, t):
        """Return f, (b, n, 3), N/m, at s (n,), m, and t (b,), s."""
        r_s, v, a = (self.derivative(line, s, t, *orders) for orders in ((1, 0), (0, 1), (0, 2)))
        size = np.sqrt((r_s * r_s).sum(axis=-1, keepdims=True))
        tau = r_s / size
        along = lambda x: (x * tau).sum(axis=-1, keepdims=True) * tau
        inertia = self.mass[line] * a + self.added_mass[line] * (a - along(a))
        u = v - np.array(self.current)
        u_n, u_t = u - along(u), along(u)
        norm = lambda x: np.sqrt((x * x).sum(axis=-1, keepdims=True))
        drag = self.Cdn[line] * norm(u_n) * u_n + np.pi * self.Cdt[line] * norm(u_t) * u_t
        drag = -self.rho * self.d[line] / 2 * np.sqrt(size) * drag
        weight = np.array([0.0, 0.0, -self.weight[line]])
        return inertia - self.tension_slope(line, s, t) - weight - drag

    def joint_load(self, t):
        """Return F, (b, 3), N."""
        v, a = (self.ends(t, order)[:, JOINT] for order in (1, 2))
        u = v - np.array(self.current)
        drag = -self.rho / 2 * self.joint_CdA * np.sqrt((u * u).sum(axis=-1, keepdims=True)) * u
        displaced = self.rho * self.joint_volume
        weight = np.array([0.0, 0.0, -(self.joint_mass - displaced) * self.g])
        pull = sum(
            (1 if ENDS[i][0] == JOINT else -1) * self.tension_vector(i, self._joint_place(i), t)[:, 0] for i in range(3)
        )
        inertia = (self.joint_mass + self.joint_Ca * displaced) * a
        return inertia - pull - drag - weight - np.array(self.joint_force)

    def _joint_place(self, line):
        return np.array([0.0 if ENDS[line][0] == JOINT else self.lengths[line]])

    # -------------------------------------------------------------- on a mesh
    def network(self, cells):
        """Return the `Network` in cells (3,), nodes in the order anchor, joint, left and right fairlead."""
        point = lambda value: [0.0, value, 0.0, 0.0]
        nodes = Nodes(
            PLACES,
            ("fixed", "free", "coupled", "coupled"),
            mass=point(self.joint_mass),
            volume=point(self.joint_volume),
            Ca=point(self.joint_Ca),
            CdA=point(self.joint_CdA),
            force=[(0.0, 0.0, 0.0), self.joint_force, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)],
        )
        names = ("EA", "beta", "mass", "added_mass", "weight", "d", "Cdn", "Cdt")
        lines = Lines(ENDS, self.lengths, cells, **{name: getattr(self, name) for name in names})
        return Network(nodes, lines, self.motion, current=self.current, rho=self.rho, g=self.g)

    def places(self, line, cells):
        """Return the unstretched arc lengths of the nodes of a line in equal cells, ndarray (cells + 1,), m."""
        return np.linspace(0.0, self.lengths[line], cells + 1)

    def node_motion(self, mesh, t, order=0):
        """Return the derivative of order 0, 1 or 2 of all nodes of a `Mesh`, ndarray (b, size, 3), at t (b,)."""
        result = np.zeros((len(t), mesh.size, 3))
        for line, chain in enumerate(mesh.chains):
            result[:, chain] = self.derivative(line, self.places(line, len(chain) - 1), t, 0, order)
        return result

    def line_loads(self, line, s, t):
        """Return the loads of one line on its nodes, ndarray (b, n, 3), N: f times half of the cells beside each.

        s (n,) : arc lengths of its nodes on any mesh, from 0 to its length, m. The joint bears `joint_load` as well.
        """
        bounds = np.concatenate([s[:1], (s[1:] + s[:-1]) / 2, s[-1:]])
        return self.load(line, s, t) * np.diff(bounds)[:, None]

    def node_loads(self, mesh, t):
        """Return the loads on the nodes of a `Mesh`, ndarray (b, size, 3), N, at t (b,): `load` of `simulate`."""
        result = np.zeros((len(t), mesh.size, 3))
        for line, chain in enumerate(mesh.chains):
            result[:, chain] += self.line_loads(line, self.places(line, len(chain) - 1), t)
        result[:, JOINT] += self.joint_load(t)
        return result


def load_of(bridle, cells):
    """Return the network of a bridle in cells (3,), and its loads as `simulate` takes them."""
    network = bridle.network(cells)
    mesh = Mesh(network)
    return network, lambda t: bridle.node_loads(mesh, t)
