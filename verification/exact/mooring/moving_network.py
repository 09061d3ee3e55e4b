"""Reference motion of small networks of lines in the time domain: all nodes at once, explicit, to ten digits.

Nodes are fixed, coupled to a body with a prescribed `RigidMotion`, or free. A line is cut into cells of unstretched
length l; with chord d between the nodes a and b of a cell, tau = d / |d|, e = |d| / l - 1 and
e' = tau . (v_b - v_a) / l, it pulls its ends together with T = max(EA (e + beta e'), 0), and gives half of itself to
either node:

    inertia    (l/2) (m I + ma (I - tau tau')) a              weight  -(l/2) w e_z
    drag      -(l/2) rho d / 2 sqrt(1 + e) (Cdn |u_n| u_n + pi Cdt |u_t| u_t tau)

with u = v - current, u_t = u . tau, u_n = u - u_t tau. A node has mass M, displaced volume V, Ca, drag area CdA and a
constant force F: inertia (M + Ca rho V) a, loads F - (M - rho V) g e_z - rho CdA |u| u / 2. Below z = -depth it bears
N = max((k p - c v_z) l_i, 0), l_i the half of its cells' lengths, with the friction -mu N v_h / sqrt(v_h^2 + v_0^2).

The mass matrix of each node is assembled and solved for its acceleration; what fixed and coupled nodes lack is the
force on their holders. Beside the motion the work of each load is integrated, so that the energy balance

    d/dt (kinetic + elastic + gravity + seabed) = power of holders - drag - damping - seabed's damping - friction
                                                  + power of the turning added mass,  v . M' v / 2,

checks the whole. z is up. SI units, radians.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from verification.exact.extrapolation import integrate
from verification.exact.rigid_motion import RigidMotion

KINDS = ("fixed", "coupled", "free")
WORKS = ("holders", "drag", "damping", "seabed damping", "friction", "turning")
"""Work done on the system by holders and applied loads; lost by drag, damping, seabed and friction; done by the added
mass that turns with its cell."""

JUMP, KINK, SMOOTH_KINK = 1e-13, 1e-9, 3e-5
"""Widths, s, of the brackets of touchdown, of tension and lift-off, and of a turn of the flow along a cell, in which
the force is wrong by a jump, by its slope times the width, by the square of that: some 1e-11 N s each."""


# ---------------------------------------------------------------- the description
@dataclass(frozen=True)
class Nodes:
    """n nodes of a network; a length-n tuple or array each, of zeros where it is left out.

    position : (n, 3), m, at rest for coupled ones;  kind : of `KINDS`
    mass kg, volume m^3, Ca, CdA m^2 : of the point;  force : (n, 3), N, constant
    """

    position: np.ndarray
    kind: tuple[str, ...]
    mass: np.ndarray = 0.0
    volume: np.ndarray = 0.0
    Ca: np.ndarray = 0.0
    CdA: np.ndarray = 0.0
    force: np.ndarray = 0.0

    def __post_init__(self):
        n = len(self.kind)
        if unknown := set(self.kind) - set(KINDS):
            raise ValueError(f"kind {sorted(unknown)} is none of {KINDS}")
        for name, shape in (
            ("position", (n, 3)),
            ("force", (n, 3)),
            *((k, (n,)) for k in ("mass", "volume", "Ca", "CdA")),
        ):
            object.__setattr__(self, name, np.broadcast_to(np.asarray(getattr(self, name), float), shape).copy())


@dataclass(frozen=True)
class Lines:
    """e lines between nodes of a network; a length-e tuple or array, or one number for all.

    ends : (e, 2), places of nodes, from the end a to the end b;  length m, unstretched;  cells : their number
    EA N; beta s; mass, added_mass kg/m; weight N/m, submerged; d m; Cdn, Cdt. All per unstretched length.
    """

    ends: np.ndarray
    length: np.ndarray
    cells: np.ndarray
    EA: np.ndarray
    beta: np.ndarray = 0.0
    mass: np.ndarray = 0.0
    added_mass: np.ndarray = 0.0
    weight: np.ndarray = 0.0
    d: np.ndarray = 0.0
    Cdn: np.ndarray = 0.0
    Cdt: np.ndarray = 0.0

    def __post_init__(self):
        ends = np.asarray(self.ends, int)
        object.__setattr__(self, "ends", ends)
        for name in (*self.PER_LINE, "cells"):
            kind = int if name == "cells" else float
            values = np.broadcast_to(np.asarray(getattr(self, name), kind), (len(ends),)).copy()
            object.__setattr__(self, name, values)

    PER_LINE = ("length", "EA", "beta", "mass", "added_mass", "weight", "d", "Cdn", "Cdt")


@dataclass(frozen=True)
class Seabed:
    """depth m; stiffness k N/m^2; damping c N s/m^2; friction mu; friction_speed v_0 m/s."""

    depth: float
    stiffness: float
    damping: float = 0.0
    friction: float = 0.0
    friction_speed: float = 0.1


@dataclass(frozen=True)
class Network:
    """Nodes, lines and what surrounds them: current (x, y, z) m/s, rho kg/m^3, g m/s^2."""

    nodes: Nodes
    lines: Lines
    motion: RigidMotion = field(default_factory=RigidMotion)
    seabed: Seabed | None = None
    current: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rho: float = 1025.0
    g: float = 9.81


# ---------------------------------------------------------------- the mesh
class Mesh:
    """Cells and nodes of a network: first its own nodes, then the inner nodes of line after line, from a to b.

    size : number of nodes;  a, b (c,) : nodes of each cell;  line (c,) : its line;  l (c,) : its length, m
    free, held (.,) : nodes that are solved for, and those that are fixed or coupled
    """

    def __init__(self, network):
        self.network, nodes, lines = network, network.nodes, network.lines
        self.chains, self.size = [], len(nodes.kind)
        for (a, b), cells in zip(lines.ends, lines.cells, strict=True):
            inner = np.arange(self.size, self.size + cells - 1)
            self.chains.append(np.concatenate([[a], inner, [b]]))
            self.size += cells - 1
        self.a = np.concatenate([chain[:-1] for chain in self.chains])
        self.b = np.concatenate([chain[1:] for chain in self.chains])
        self.line = np.repeat(np.arange(len(lines.cells)), lines.cells)
        self.l = (lines.length / lines.cells)[self.line]
        first = np.cumsum(lines.cells) - lines.cells
        self.end_cells = np.column_stack([first, first + lines.cells - 1])
        kind = np.array([*nodes.kind, *["free"] * (self.size - len(nodes.kind))])
        self.fixed, self.coupled, self.free = (np.flatnonzero(kind == k) for k in KINDS)
        self.held = np.flatnonzero(kind != "free")

    def per_cell(self, name):
        """Return a coefficient of `Lines`, ndarray (c,)."""
        return getattr(self.network.lines, name)[self.line]

    def per_node(self, name):
        """Return a coefficient of `Nodes`, ndarray (size, ...), zero at inner nodes."""
        values = getattr(self.network.nodes, name)
        return np.concatenate([values, np.zeros((self.size - len(values), *values.shape[1:]))])

    def gather(self, at_a, at_b):
        """Return the sums over cells at each node, (..., size, ...); at_a, at_b : (c, batch, ...)."""
        flat = (self._incidence[0] @ at_a.reshape(len(at_a), -1)) + (self._incidence[1] @ at_b.reshape(len(at_b), -1))
        return flat.reshape(self.size, *at_a.shape[1:])

    @cached_property
    def _incidence(self):
        """Matrices (size, c) of ones where a cell begins, and where it ends, at a node."""
        nodes = np.arange(self.size)[:, None]
        return (nodes == self.a).astype(float), (nodes == self.b).astype(float)

    @cached_property
    def tributary(self):
        """Half of the lengths of the cells at each node, ndarray (size,), m."""
        return self.gather(self.l / 2, self.l / 2)

    def straight(self):
        """Return positions with each line's nodes on the chord between its ends, ndarray (size, 3), m."""
        position = np.zeros((self.size, 3))
        position[: len(self.network.nodes.kind)] = self.network.nodes.position
        for chain in self.chains:
            share = np.linspace(0, 1, len(chain))[:, None]
            position[chain] = (1 - share) * position[chain[0]] + share * position[chain[-1]]
        return position


# ---------------------------------------------------------------- forces
class Forces:
    """Forces and masses of a mesh in one state, or a batch of them: r, v (size, ..., 3), nodes first.

    branches : None, or (k,) of `switches` that are taken for positive whatever the state
    After construction: tension (c, ...); pull, drag, point_drag, contact, friction, constant (size, ..., 3), N;
    mass (size, ..., 3, 3), kg, is assembled when it is asked for.
    """

    def __init__(self, mesh, r, v, branches=None):
        self.mesh, self.r, self.v = mesh, r, v
        network, shape = mesh.network, (-1,) + (1,) * (r.ndim - 2)
        self._cell = lambda name: mesh.per_cell(name).reshape(shape)
        self._node = lambda name: mesh.per_node(name).reshape(shape)
        self.l = mesh.l.reshape(shape)
        chord, self.opening = r[mesh.b] - r[mesh.a], v[mesh.b] - v[mesh.a]
        self.size = np.sqrt(_dot(chord, chord))
        self.tau = chord / self.size[..., None]
        self.strain = self.size / self.l - 1
        self.rate = _dot(self.tau, self.opening) / self.l
        self.law = self._cell("EA") * (self.strain + self._cell("beta") * self.rate)
        self.depth_below = -network.seabed.depth - r[..., 2] if network.seabed else np.full(r.shape[:-1], -1.0)
        self.bearing = self._bearing(network.seabed)
        self.relative = v - np.array(network.current, float)
        self.slip = [_dot(self.relative[end], self.tau) for end in (mesh.a, mesh.b)]
        signs = [np.real(x) > 0 for x in self._switches()] if branches is None else self._split(branches[:, None])
        self.is_taut, self.is_stretched, self.is_pressed, self.is_borne, *self.is_forward = signs
        self.tension = np.where(self.is_taut, self.law, 0.0)
        pull = self.tension[..., None] * self.tau
        self.pull = mesh.gather(pull, -pull)
        self.drag = mesh.gather(self.half_drag(0), self.half_drag(1))
        speed = np.sqrt(_dot(self.relative, self.relative))
        self.point_drag = (-network.rho / 2 * self._node("CdA") * speed)[..., None] * self.relative
        self._seabed(network.seabed)
        self.constant = self._constant()

    def half_drag(self, end):
        """Return the drag of half of each cell at its end 0 or 1, ndarray (c, ..., 3), N."""
        u, u_t = self.relative[(self.mesh.a, self.mesh.b)[end]], self.slip[end]
        u_n = u - u_t[..., None] * self.tau
        scale = -self.mesh.network.rho / 2 * self._cell("d") * np.sqrt(1 + self.strain) * self.l / 2
        across = (scale * self._cell("Cdn") * np.sqrt(_dot(u_n, u_n)))[..., None] * u_n
        return (
            across
            + (scale * np.pi * self._cell("Cdt") * np.where(self.is_forward[end], u_t, -u_t) * u_t)[..., None]
            * self.tau
        )

    def half_mass(self):
        """Return the mass matrix that each cell gives to either of its nodes, ndarray (c, ..., 3, 3), kg."""
        along = self.tau[..., :, None] * self.tau[..., None, :]
        m, ma = (self._cell(k)[..., None, None] for k in ("mass", "added_mass"))
        return self.l[..., None, None] / 2 * ((m + ma) * np.eye(3) - ma * along)

    @cached_property
    def mass(self):
        """Mass matrices of the nodes, ndarray (size, ..., 3, 3), kg."""
        half = self.half_mass()
        point = self._node("mass") + self._node("Ca") * self.mesh.network.rho * self._node("volume")
        return self.mesh.gather(half, half) + point[..., None, None] * np.eye(3)

    @property
    def total(self):
        """Sum of all forces but inertia, ndarray (size, ..., 3), N."""
        return self.pull + self.drag + self.point_drag + self.contact + self.friction + self.constant

    def _switches(self):
        drag = np.any(self._cell("Cdt"))
        forward = self.slip if drag else [x + np.inf for x in self.slip]
        return self.law, self.strain, self.depth_below, self.bearing, *forward

    def _split(self, branches):
        c, n = len(self.mesh.l), self.mesh.size
        return np.split(branches, np.cumsum([c, c, n, n, c]))

    def switches(self):
        """Return the functions whose signs choose the branches of the laws, ndarray (k, ...).

        Tension of each cell and its strain; of each node its depth below the seabed and what this would bear; the
        relative velocity along each cell at either end, whose drag |u_t| u_t has a kink.
        """
        return np.concatenate(self._switches())

    def _bearing(self, seabed):
        if seabed is None:
            return np.full(self.r.shape[:-1], -1.0)
        share = self.mesh.tributary.reshape((-1,) + (1,) * (self.r.ndim - 2))
        return share * (seabed.stiffness * self.depth_below - seabed.damping * self.v[..., 2])

    def _seabed(self, seabed):
        if seabed is None:
            self.bears = self.penetration = np.zeros(self.r.shape[:-1])
            self.contact = self.friction = np.zeros(self.r.shape)
            return
        self.penetration = np.where(self.is_pressed, self.depth_below, 0.0)
        self.bears = np.where(self.is_pressed & self.is_borne, self.bearing, 0.0)
        horizontal = self.v * np.array([1.0, 1.0, 0.0])
        speed = np.sqrt(_dot(horizontal, horizontal) + seabed.friction_speed**2)
        self.contact = self.bears[..., None] * np.array([0.0, 0.0, 1.0])
        self.friction = (-seabed.friction * self.bears / speed)[..., None] * horizontal

    def _constant(self):
        """Return weight, buoyancy and applied force of the nodes, (size, ..., 3)."""
        mesh, network = self.mesh, self.mesh.network
        half = mesh.per_cell("weight") * mesh.l / 2
        force = mesh.per_node("force")
        force[:, 2] -= (
            mesh.gather(half, half) + (mesh.per_node("mass") - network.rho * mesh.per_node("volume")) * network.g
        )
        return force.reshape((mesh.size,) + (1,) * (self.r.ndim - 2) + (3,))

    # -------------------------------------------------------------- energy
    def energies(self):
        """Return kinetic, elastic, gravity and seabed energy in J, dict of arrays shaped as the batch.

        Gravity is that of weight, buoyancy and constant forces, zero at the origin.
        """
        kinetic = np.einsum("n...i,n...ij,n...j->...", self.v, self.mass, self.v) / 2
        elastic = (self._cell("EA") * self.l * np.where(self.is_stretched, self.strain, 0.0) ** 2 / 2).sum(axis=0)
        gravity = -(self.constant * self.r).sum(axis=(0, -1))
        seabed = self.mesh.network.seabed
        share = self.mesh.tributary.reshape((-1,) + (1,) * (self.r.ndim - 2))
        springs = 0 * gravity if seabed is None else (seabed.stiffness * share * self.penetration**2 / 2).sum(axis=0)
        return {"kinetic": kinetic, "elastic": elastic, "gravity": gravity, "seabed": springs}

    def powers(self, acceleration):
        """Return the rates of `WORKS` in W, dict of arrays; acceleration (size, ..., 3) of all nodes."""
        held = self.mesh.held
        lacking = np.einsum("n...ij,n...j->n...i", self.mass, acceleration) - self.total
        elastic = self._cell("EA") * np.where(self.is_stretched, self.strain, 0.0)
        turning = (self.opening - self.tau * _dot(self.tau, self.opening)[..., None]) / self.size[..., None]
        ma = self._cell("added_mass") * self.l / 2
        turned = sum(_dot(self.v[end], self.tau) * _dot(self.v[end], turning) for end in (self.mesh.a, self.mesh.b))
        seabed, share = self.mesh.network.seabed, self.mesh.tributary.reshape((-1,) + (1,) * (self.r.ndim - 2))
        spring = 0.0 if seabed is None else seabed.stiffness * share * self.penetration
        return {
            "holders": _dot(lacking[held], self.v[held]).sum(axis=0),
            "drag": -_dot(self.drag + self.point_drag, self.v).sum(axis=0),
            "damping": ((self.tension - elastic) * self.rate * self.l).sum(axis=0),
            "seabed damping": -((self.bears - spring) * self.v[..., 2]).sum(axis=0),
            "friction": -_dot(self.friction, self.v).sum(axis=0),
            "turning": -(ma * turned).sum(axis=0),
        }


def _dot(a, b):
    return (a * b).sum(axis=-1)


# ---------------------------------------------------------------- the motion
@dataclass(frozen=True)
class History:
    """What `simulate` returns; nt times, `size` nodes and c cells as in `Mesh`, e lines.

    t (nt,) s;  position, velocity, acceleration (nt, size, 3);  tension (nt, c), N
    holder_force (nt, size, 3) : N, of the network on what holds the node; zero at free nodes
    end_force (nt, e, 2, 3) : N, of each line on its two end nodes, half a cell's weight, drag and inertia included
    body_force, body_moment (nt, 3) : N and N m about the moving reference point, of the network on the body
    energy, work : dicts of (nt,), J, of `Forces.energies` and, from t[0], of `WORKS`
    """

    mesh: Mesh
    t: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    tension: np.ndarray
    holder_force: np.ndarray
    end_force: np.ndarray
    body_force: np.ndarray
    body_moment: np.ndarray
    energy: dict
    work: dict

    @property
    def end_tension(self):
        """Magnitude of `end_force`, ndarray (nt, e, 2), N."""
        return np.sqrt((self.end_force**2).sum(axis=-1))

    @property
    def body_power(self):
        """Power that the body puts into the network, ndarray (nt,), W."""
        return -(self.holder_force * self.velocity)[:, self.mesh.coupled].sum(axis=(1, 2))

    @property
    def energy_error(self):
        """Energy that the balance lacks since t[0], ndarray (nt,), J."""
        gained = sum(values - values[0] for values in self.energy.values())
        lost = sum(self.work[name] for name in WORKS[1:5])
        return gained - self.work["holders"] - self.work["turning"] + lost


def simulate(network, times, position=None, velocity=None, *, load=None, rtol=1e-12, atol=1e-12):
    """Return the `History` at `times` (nt,), s, of a network that starts at times[0] from a given state.

    position, velocity : (size, 3) of the mesh's nodes, those of held ones unused; by default straight lines at rest
    load : None, or (t (b,)) -> (b, size, 3), N, added to the forces on the nodes
    rtol, atol : of `integrate`, for positions in m, velocities in m/s and works in units of 1 kJ
    Raises ArithmeticError where a node is without mass, or the integration does not get on.
    """
    mesh = Mesh(network)
    equations = _Equations(mesh, load)
    position = mesh.straight() if position is None else np.asarray(position, float)
    velocity = np.zeros((mesh.size, 3)) if velocity is None else np.asarray(velocity, float)
    start = np.concatenate([position[mesh.free].ravel(), velocity[mesh.free].ravel(), np.zeros(len(WORKS))])
    options = {"switches": equations.switches, "widths": _event_widths(mesh), "rtol": rtol, "atol": atol}
    states = integrate(equations.rates, times, start, **options)
    return equations.history(np.asarray(times, float), states)


def _event_widths(mesh):
    """Return how closely events are bracketed, ndarray (k,), s: a jump, the kink of a force, that of its derivative."""
    c, n = len(mesh.l), mesh.size
    return np.repeat([KINK, KINK, JUMP, KINK, SMOOTH_KINK], [c, c, n, n, 2 * c])


class _Equations:
    """The ordinary differential equations of a mesh: state (positions and velocities of free nodes, works in kJ)."""

    WORK_UNIT = 1e3

    def __init__(self, mesh, load=None):
        self.mesh, self.load, self.count = mesh, load, 3 * mesh.free.size

    def kinematics(self, t, y):
        """Return positions and velocities (size, b, 3) of all nodes, and accelerations, zero at free nodes."""
        mesh, n = self.mesh, self.count
        at_rest, motion = mesh.network.nodes.position, mesh.network.motion
        state = np.zeros((3, mesh.size, len(t), 3), y.dtype)
        state[0, mesh.fixed] = at_rest[mesh.fixed][:, None]
        if mesh.coupled.size:
            state[:, mesh.coupled] = np.swapaxes(motion.kinematics(at_rest[mesh.coupled], t), 1, 2)
        for order in range(2):
            values = y[:, order * n : (order + 1) * n].reshape(len(t), -1, 3)
            state[order, mesh.free] = np.moveaxis(values, 1, 0)
        return state

    def switches(self, t, y):
        """Return `Forces.switches`, ndarray (b, k)."""
        r, v, _ = self.kinematics(t, y)
        return Forces(self.mesh, r, v).switches().T

    def solve(self, t, y, branches=None):
        """Return `Forces`, applied loads (size, b, 3) or 0, and the accelerations of all nodes."""
        mesh = self.mesh
        r, v, a = self.kinematics(t, y)
        forces = Forces(mesh, r, v, branches)
        applied = np.moveaxis(self.load(t), 1, 0) if self.load else np.zeros(r.shape)
        try:
            a[mesh.free] = np.linalg.solve(forces.mass[mesh.free], (forces.total + applied)[mesh.free][..., None])[
                ..., 0
            ]
        except np.linalg.LinAlgError:
            raise ArithmeticError("a free node is without mass") from None
        return forces, applied, a

    def rates(self, t, y, branches):
        """Return y', ndarray (b, n)."""
        mesh, n, b = self.mesh, self.count, len(t)
        forces, applied, a = self.solve(t, y, branches)
        powers = forces.powers(a)
        powers["holders"] = powers["holders"] + (applied[mesh.free] * forces.v[mesh.free]).sum(axis=(0, -1))
        works = np.stack([powers[name] for name in WORKS], axis=-1) / self.WORK_UNIT
        return np.concatenate([y[:, n : 2 * n], np.moveaxis(a[mesh.free], 0, 1).reshape(b, -1), works], axis=1)

    def history(self, t, y):
        """Return the `History` of states (nt, n)."""
        mesh = self.mesh
        forces, _, a = self.solve(t, y)
        inertia = np.einsum("n...ij,n...j->n...i", forces.mass, a)
        holder = np.zeros(a.shape)
        holder[mesh.held] = (forces.total - inertia)[mesh.held]
        arms = forces.r[mesh.coupled] - mesh.network.motion.reference_point(t)
        works = y[:, 2 * self.count :] * self.WORK_UNIT
        time_first = lambda values: np.moveaxis(values, 0, 1)
        return History(
            mesh=mesh,
            t=t,
            position=time_first(forces.r),
            velocity=time_first(forces.v),
            acceleration=time_first(a),
            tension=forces.tension.T,
            holder_force=time_first(holder),
            end_force=self._end_forces(forces, a),
            body_force=holder[mesh.coupled].sum(axis=0),
            body_moment=np.cross(arms, holder[mesh.coupled]).sum(axis=0),
            energy=forces.energies(),
            work={name: works[:, i] for i, name in enumerate(WORKS)},
        )

    def _end_forces(self, forces, a):
        """Return the force of each line on its two end nodes, ndarray (nt, e, 2, 3)."""
        mesh, ends = self.mesh, []
        half_mass, half_weight = forces.half_mass(), mesh.per_cell("weight") * mesh.l / 2
        share = np.where(mesh.tributary > 0, mesh.tributary, 1.0)
        for side, (node, sign) in enumerate(((mesh.a, 1.0), (mesh.b, -1.0))):
            force = sign * forces.tension[..., None] * forces.tau + forces.half_drag(side)
            force = force - np.einsum("c...ij,c...j->c...i", half_mass, a[node])
            force[..., 2] -= half_weight[:, None]
            part = (mesh.l / 2 / share[node])[:, None, None]
            force += part * (forces.contact + forces.friction)[node]
            ends.append(force[mesh.end_cells[:, side]])
        return np.moveaxis(np.array(ends), 2, 0).transpose(0, 2, 1, 3)


# ---------------------------------------------------------------- the static state
def solve_equilibrium(network, start=None, *, t=0.0, tolerance=1e-11, most_steps=2000):
    """Return the positions of all nodes at rest, ndarray (size, 3), with the body where it is at time t, s.

    start : (size, 3), or None for straight lines pulled down a little. Pseudo-transient continuation: free nodes move
    by (lambda I - dF/dr) x = F, with lambda in proportion to |F|; dF/dr by complex steps.
    tolerance : of the largest force that is left over the largest tension. Raises ArithmeticError where not met.
    """
    mesh = Mesh(network)
    r = mesh.straight() if start is None else np.array(start, float)
    if start is None:
        for chain, length in zip(mesh.chains, network.lines.length, strict=True):
            share = np.linspace(0, 1, len(chain))
            r[chain, 2] -= 0.02 * length * share * (1 - share)
    if mesh.coupled.size:
        r[mesh.coupled] = network.motion.kinematics(network.nodes.position[mesh.coupled], t)[0]
    free, n = mesh.free, 3 * mesh.free.size
    scale, stiffest = None, (mesh.per_cell("EA") / mesh.l).max()
    for _ in range(most_steps):
        batch = np.repeat(r[:, None].astype(complex), n + 1, axis=1)
        batch[np.repeat(free, 3), np.arange(1, n + 1), np.tile(np.arange(3), free.size)] += 1e-30j
        forces = Forces(mesh, batch, np.zeros(batch.shape))
        residual = np.moveaxis(forces.total[free], 1, 0).reshape(n + 1, n)
        force, stiffness = residual[0].real, -residual[1:].imag.T / 1e-30
        size = np.abs(force).max(initial=0.0)
        if size <= tolerance * max(forces.tension[:, 0].real.max(), 1.0):
            return r
        scale = scale or size
        damping = stiffest * min(1.0, size / scale) * 0.1
        step = np.linalg.solve(stiffness + max(damping, 1e-10 * stiffest) * np.eye(n), force)
        longest = 0.5 * mesh.l.min()
        step *= min(1.0, longest / np.abs(step).max())
        r[free] += step.reshape(-1, 3)
    raise ArithmeticError(f"no equilibrium in {most_steps} steps: {size:.2e} N are left")
