"""Lines, states and manufactured problems for the moving line of nodes and elements, and its text without a compiler.

Checks of the equations take the module they look at, so that they can look at one with a planted fault.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace
from functools import cache
from types import ModuleType, SimpleNamespace

import numpy as np
from mpmath import mp

from solvers import CableProperties, Element, Environment, Motion, Network, Node, Scene, mooring_system
from solvers.mooring import equations
from solvers.mooring.equations import Line
from solvers.mooring.lines.layout import INDEX, Elimination, Layout, plan_elimination
from solvers.numerics.lu import elimination

from ..cases.cables import CableCase
from ..exact.mooring.lumped_node import Cell, Seabed, force_terms
from ..exact.mooring.moving_line import ManufacturedLine
from ..tools.planting import ROOT, Fault

EQUATIONS, ELIMINATION, STEPS = "mooring.equations", "numerics.lu.elimination", "mooring.stepping.steps"
LAYOUT = "mooring.lines.layout"


def interpreted(fault: Fault | None = None) -> ModuleType:
    """Return equations, elimination and steps in one module as Python runs them, complex too, with a fault."""
    module = ModuleType("as_written")
    for place in (STEPS, EQUATIONS, ELIMINATION):  # what the first imports, the others define anew
        module.__package__ = f"solvers.{place.rpartition('.')[0]}"
        path = ROOT / Fault(place, "", "", "").path
        text = path.read_text(encoding="utf-8")
        text = fault.apply_to(text) if fault is not None and fault.module == place else text
        text = re.sub(r"^@compiled.*$", "", text, flags=re.MULTILINE)
        exec(compile(text, f"<{path.name} as it is written>", "exec"), module.__dict__)
    return module


compiled = SimpleNamespace(
    residual=equations.residual,
    tangents=equations.tangents,
    factorise=elimination.factorise,
    solve=elimination.solve,
)
"""The same functions as the solvers use them."""


# ---------------------------------------------------------------- scenes and systems
def scene(case: CableCase, **environment) -> Scene:
    """Return the solvers.Scene of a case; more of its Environment by keyword, as seabed_damping."""
    section = (case.EA, case.diameter, case.mass_per_length, case.submerged_weight)
    loads = {name: getattr(case, name) for name in ("Cdn", "Cdt", "Ca", "damping")}
    water = {"depth": case.depth, "current": case.current, "seabed_stiffness": case.seabed_stiffness} | environment
    motion = Motion(case.frequency, [case.amplitude], [case.quadrature]) if case.amplitude else None
    cable = CableProperties(*section, **loads)
    return Scene(case.name, cable, case.length, case.anchor, case.fairlead, Environment(case.rho, **water),
                 motion=motion)  # fmt: skip


def build(case: CableCase, cells=25, **options):
    """Return the solvers.mooring_system of a case."""
    return mooring_system(scene(case), cells, **options)


def hanging_mass(mass, *, EA, length, damping=0.0, position, cells=2, line_mass=1e-6, environment=None):
    """Return the system of a light line from an anchor at the origin to a free mass below it, of two cells or more.

    mass: kg; EA N, length m, damping s: of the line; line_mass: kg, of all of it; position: z of the mass, m.
    """
    per_metre = line_mass / length
    cable = CableProperties(EA, 0.01, per_metre, 0.0, damping=damping)
    nodes = [Node("fixed", (0.0, 0.0, 0.0)), Node("free", (0.0, 0.0, position), mass=mass)]
    line = Network(nodes, [Element(1e-9, EA, length, (1, 0), cable=cable)], environment or Environment(rho=0.0))
    return mooring_system(line, cells, mesh="uniform")


# ---------------------------------------------------------------- random lines, networks and states
NODES = 6
PATTERNS = {
    "line": ((0, 1), (1, 2), (2, 3), (3, 4), (4, 5)),
    "three arms": ((0, 1), (1, 5), (2, 3), (3, 5), (4, 5)),
    "ring through a joint": ((0, 1), (1, 5), (2, 3), (2, 5), (3, 4), (4, 5)),
    "two joints, two lines between": ((2, 4), (0, 4), (0, 5), (1, 4), (1, 5), (3, 5)),
    "star with its centre first": ((0, 1), (0, 2), (0, 3), (0, 4), (0, 5)),
}
"""Nodes (first, last) of the cells, first < last; eliminated, the last three add one, one and all blocks there are."""
BRANCHED = tuple(PATTERNS)[1:]
TERMS = {
    "inertia": ("mass",),
    "added mass": ("added_mass",),
    "point mass": ("point_mass",),
    "load": ("load",),
    "tension": ("EA",),
    "tension and damping": ("EA", "damping"),
    "normal drag": ("normal_drag",),
    "tangential drag": ("tangential_drag",),
    "drag in a current": ("normal_drag", "tangential_drag", "current"),
    "drag of nodes": ("point_drag",),
    "drag of nodes in a current": ("point_drag", "current"),
    "seabed": ("seabed_stiffness",),
    "seabed and damping": ("seabed_stiffness", "seabed_damping"),
    "seabed and friction": ("seabed_stiffness", "friction"),
    "seabed, damping and friction": ("seabed_stiffness", "seabed_damping", "friction"),
    "seabed, damping from contact on": ("seabed_stiffness", "seabed_damping", "contact_depth"),
    "seabed, damping from contact on and friction": ("seabed_stiffness", "seabed_damping", "contact_depth", "friction"),
}
"""Fields of equations.Line that are not zero; "all" has every one."""
TERMS["all"] = tuple(sorted({field for fields in TERMS.values() for field in fields}))


@dataclass(frozen=True)
class RandomState:
    """Cells between NODES nodes in n axes with their state r, v, a (N, n) and auxiliary tensions (C,), N.

    residual (N, n): what 40 digits make of it, N; size: the largest force on a node, N.
    """

    line: Line
    r: np.ndarray
    v: np.ndarray
    a: np.ndarray
    auxiliary: np.ndarray
    residual: np.ndarray
    size: float

    def order(self, *prescribed) -> Elimination:
        """Return the Elimination of the pattern with prescribed nodes."""
        layout = Layout((), (), (), np.arange(NODES), self.line.first, self.line.last)
        return plan_elimination(layout, np.array(prescribed, dtype=int), self.r.shape[1])


@cache
def random_state(name: str, n: int, seed: int = 1, pattern: str = "line") -> RandomState:
    """Return cells with the terms of that name in a state far from rest: cells taut and slack, nodes in and out.

    pattern: one of PATTERNS.
    """
    rng = np.random.default_rng([2026, n, seed])
    first, last = (np.array(part, INDEX) for part in zip(*PATTERNS[pattern], strict=True))
    cells, nodes, number = first.size, NODES, lambda size, count: size * rng.uniform(0.7, 1.3, count)
    given = {
        "EA": number(3e3, cells), "damping": number(0.4, cells), "mass": number(80.0, cells),
        "added_mass": number(60.0, cells), "point_mass": number(300.0, nodes), "load": number(500.0, (nodes, n)),
        "point_drag": number(400.0, nodes), "seabed_stiffness": number(100.0, 1), "seabed_damping": number(60.0, 1),
        "friction": number(0.6, nodes), "current": number(0.6, n) * [-1.0, 1.0, 0.5][-n:],
        "Cdn": number(1.2, cells), "Cdt": number(0.5, cells),
    }  # fmt: skip
    kept = {"Cdn" if f == "normal_drag" else "Cdt" if f == "tangential_drag" else f for f in TERMS[name]}
    value = {field: array if field in kept else 0 * array for field, array in given.items()}
    d, rho, slip = number(0.3, cells), 1025.0, 0.5
    r, v, a = _spread(first, last, n, rng), rng.normal(0, 1.0, (nodes, n)), rng.normal(0, 1.0, (nodes, n))
    stretch = rng.permutation(np.resize([0.8, 0.93, 1.05, 1.3, 1.6], cells))
    chord = r[last] - r[first]
    distance = np.linalg.norm(chord, axis=1)
    length = distance / stretch
    below, above = np.argsort(r[:, -1])[nodes // 2 - 1 : nodes // 2 + 1]
    floor = float(r[above, -1] - 0.05)  # half of the nodes in the seabed; one just above sinks, one below is pulled out
    depths = np.sort(floor - r[:, -1])[-nodes // 2 :]  # of those in the seabed; the second is where damping grows
    contact_depth = float(depths[1:3].mean()) if "contact_depth" in TERMS[name] else 0.0
    v[above, -1], v[below, -1] = -1.2, 4 * max(depths[0], contact_depth) + 0.2
    halves = np.bincount(np.append(first, last), np.append(length, length) / 2, nodes)
    k, c = float(value["seabed_stiffness"][0]), float(value["seabed_damping"][0])
    line = Line(
        first=first, last=last, length=length, EA=value["EA"], damping=value["damping"], mass=value["mass"],
        added_mass=value["added_mass"], normal_drag=rho * d * value["Cdn"] / 2,
        tangential_drag=rho * math.pi * d * value["Cdt"] / 2, point_mass=value["point_mass"],
        point_drag=value["point_drag"], load=value["load"], seabed_stiffness=k * halves, seabed_damping=c * halves,
        friction=value["friction"], floor=floor, slip_speed=slip, current=tuple(value["current"].tolist()),
        contact_depth=contact_depth,
    )  # fmt: skip
    of_mpmath = [
        Cell(length[i], line.EA[i], line.damping[i], line.mass[i], line.added_mass[i], 0.0, rho, d[i], value["Cdn"][i],
             value["Cdt"][i])
        for i in range(cells)
    ]  # fmt: skip
    R, size = _residual_by_mpmath(line, of_mpmath, (r, v, a), k, c)
    rate = np.sum(chord * (v[last] - v[first]), axis=1) / distance
    T = line.EA * (stretch - 1 + line.damping * rate / length)
    return RandomState(line, r, v, a, np.maximum(T, 0.0), R, size)


def _spread(first, last, n, rng) -> np.ndarray:
    """Return positions (N, n), m, of nodes that a tree of cells of some 6 m reaches, one after another."""
    r, reached = np.zeros((NODES, n)), {0}
    both = np.append(first, last), np.append(last, first)
    while len(reached) < NODES:
        p, q = next((p, q) for p, q in zip(*both, strict=True) if p in reached and q not in reached)
        step = rng.normal(0, 1, n)
        r[q] = r[p] + rng.uniform(4.0, 8.0) * step / np.linalg.norm(step)
        reached.add(q)
    return r


def _residual_by_mpmath(line, cells, state, k, c):
    """Return R (N, n) and the largest force on a node, N: a node with one half cell at a time, whatever its end."""
    (nodes, n), beyond = state[0].shape, Cell(1e-40, 0.0)  # of no length and no mass, on the other side of the node
    current = (line.current[0], 0.0, line.current[1]) if n == 2 else line.current
    r, v, a = ([list(map(float, row)) for row in part] for part in state)
    R, size = np.zeros((nodes, n)), 0.0
    with mp.workdps(40):
        for i in range(nodes):
            bed = Seabed(-line.floor, k, c, line.friction[i], line.slip_speed, line.contact_depth)
            away = [r[i][0] - 1.0, *r[i][1:]]
            u = [mp.mpf(x) - mp.mpf(y) for x, y in zip(v[i], line.current, strict=True)]
            drag = -mp.mpf(line.point_drag[i]) * mp.norm(mp.matrix(u))
            parts = [[drag * x for x in u], [-mp.mpf(line.point_mass[i]) * x for x in a[i]], line.load[i].tolist()]
            for cell in np.flatnonzero((line.first == i) | (line.last == i)).tolist():
                other = int(line.first[cell] + line.last[cell] - i)
                given = (beyond, cells[cell]), (away, r[i], r[other]), (v[i], v[i], v[other]), a[i]
                parts += force_terms(*given, current=current, seabed=bed).values()
            R[i] = [-float(mp.fsum(one)) for one in zip(*parts, strict=True)]
            size = max(size, *(abs(float(x)) for part in parts for x in part))
    return R, size


def evaluate(module, line, r, v, a, auxiliary):
    """Return R (N, n), T (C,) and unit (C, n) of the module's residual, of the type of r."""
    kind, cells = np.result_type(r, v, a), line.length.size
    R, T, unit = np.empty(r.shape, kind), np.empty(cells, kind), np.empty((cells, r.shape[1]), kind)
    r, v, a = (np.ascontiguousarray(part, kind) for part in (r, v, a))
    module.residual(line, r, v, a, auxiliary, R, T, unit)
    return R, T, unit


def tangent_blocks(module, line, r, v, a, auxiliary, weights, edges=None):
    """Return diagonal (N, n, n), right and left (C or edges, n, n) of the module's tangents."""
    (nodes, n), edges = r.shape, line.length.size if edges is None else edges
    diagonal, right, left = np.empty((nodes, n, n)), np.empty((edges, n, n)), np.empty((edges, n, n))
    module.tangents(line, r, v, a, auxiliary, weights, diagonal, right, left)
    return diagonal, right, left


def dense(line, diagonal, right, left) -> np.ndarray:
    """Return the matrix (N n, N n): right[c] is of row first[c] and node last[c], left[c] of row last[c]."""
    nodes, n = diagonal.shape[:2]
    matrix = np.zeros((nodes, n, nodes, n))
    for i in range(nodes):
        matrix[i, :, i] = diagonal[i]
    for c, (i, j) in enumerate(zip(line.first, line.last, strict=True)):
        matrix[i, :, j] += right[c]
        matrix[j, :, i] += left[c]
    return matrix.reshape(nodes * n, nodes * n)


def matrix(module, line, r, v, a, auxiliary, weights) -> np.ndarray:
    """Return the module's tangents as one matrix."""
    return dense(line, *tangent_blocks(module, line, r, v, a, auxiliary, weights))


# ---------------------------------------------------------------- manufactured problems
class EndMotion:
    """The motion of the last node of a manufactured line from where it is on average, with its acceleration."""

    def __init__(self, line: ManufacturedLine):
        self.line, self.mean = line, in_space(line, line.position(line.length, 0.0))
        if line.omega:
            self.period = 2 * np.pi / line.omega

    def displacement(self, t):
        """Return the displacement (3, *S), m."""
        return in_space(self.line, self.line.position(self.line.length, t)) - self.mean.reshape(3, *(1,) * np.ndim(t))

    def velocity(self, t):
        """Return the velocity (3, *S), m/s."""
        return in_space(self.line, self.line.velocity(self.line.length, t))

    def acceleration(self, t):
        """Return the acceleration (3, *S), m/s^2."""
        return in_space(self.line, self.line.acceleration(self.line.length, t))

    def directions(self):
        """Return the axes of the motion."""
        return np.eye(3)[self.line.components]


def in_space(line, vector) -> np.ndarray:
    """Return vectors (3, ...) of those in the components of a line, planar or spatial."""
    whole = np.zeros((3, *np.shape(vector)[1:]))
    whole[line.components] = vector
    return whole


def manufactured(line: ManufacturedLine, cells: int, mesh="uniform"):
    """Return the system of a manufactured line of mass and stiffness, with the load that it needs.

    Its catenaries, which only start a search, know no seabed: the line lies wholly inside it.
    """
    bed = {"depth": line.depth, "seabed_stiffness": line.seabed_stiffness, "seabed_damping": line.seabed_damping}
    current = tuple(float(c) if i in line.components else 0.0 for i, c in enumerate(line.current))
    environment = Environment(line.rho, current=current, **(bed if line.seabed_stiffness else {}))
    cable = CableProperties(line.EA, line.d, line.mass, line.weight, Cdn=line.Cdn, Cdt=line.Cdt, Ca=line.Ca,
                            damping=line.beta)  # fmt: skip
    motion = EndMotion(line)
    given = SimpleNamespace(name="manufactured", cable=cable, length=line.length, anchor=line.anchor,
                            fairlead=tuple(motion.mean.tolist()), environment=environment,
                            friction=(line.friction,))  # fmt: skip
    system = mooring_system(given, cells, mesh=mesh, fields="planar" if line.planar else "spatial", motion=motion,
                          calibrate=False, slip_speed=line.friction_speed,
                          contact_depth=line.contact_depth)  # fmt: skip
    system.source = lambda t: lumped_load(system, line, t)
    system.model = replace(system.model, environment=Environment(line.rho, current=current))
    return system


def lumped_load(system, line, t) -> np.ndarray:
    """Return the load of a manufactured line on the nodes, (S, N, n), N: that of a node times its share of the line."""
    share = np.append(system.line.length, 0.0) / 2 + np.append(0.0, system.line.length) / 2
    return (line.load(system.s, np.atleast_1d(t)) * share[:, None]).transpose(2, 1, 0)


def exact_load(system, line, t) -> np.ndarray:
    """Return the load (S, N, n), N, that makes a manufactured motion exact on its mesh, all cells taut."""
    t = np.atleast_1d(t)
    y = np.stack([exact_state(system, line, one)[0].T for one in t])
    v, a = (rate(system.s, t).transpose(2, 1, 0) for rate in (line.velocity, line.acceleration))
    taut = np.ones(system.line.length.size)
    return np.stack([evaluate(compiled, system.line, *state, taut)[0] for state in zip(y, v, a, strict=True)])


def exact_state(system, line, t):
    """Return y and ydot (n, N) of a manufactured line at a time, coordinates of its system."""
    lift = -system.origin[line.components]
    return line.position(system.s, t) + lift[:, None], line.velocity(system.s, t)


# ---------------------------------------------------------------- energy
@dataclass(frozen=True)
class Energy:
    """Energy of lines at stored times (K,), J, and the powers that change it, W, each by its own formula.

    total: kinetic with added mass, elastic, of the loads and of the seabed's springs. given: by the holders of the
    prescribed nodes, those on a body among them; drag, damper (of the cells), seabed (its damper) and friction: taken.
    turning: what the energy of the added mass changes by as its cell turns, for the equations leave the force of that
    out.
    """

    total: np.ndarray
    given: np.ndarray
    drag: np.ndarray
    damper: np.ndarray
    seabed: np.ndarray
    friction: np.ndarray
    turning: np.ndarray

    @property
    def power(self) -> np.ndarray:
        """What the total changes by, W."""
        return self.given - self.drag - self.damper - self.seabed - self.friction + self.turning


def energy_of(history) -> Energy:
    """Return the Energy of a MooringHistory."""
    line, system = history.system.line, history.system
    r, v = (part.transpose(2, 1, 0) for part in (history.y, history.ydot))
    l = line.length
    d, opening = (part[:, line.last] - part[:, line.first] for part in (r, v))
    size = np.linalg.norm(d, axis=2)
    t = d / size[..., None]
    strain, rate = size / l - 1, (t * opening).sum(axis=2) / l
    turn = (opening - (t * opening).sum(axis=2)[..., None] * t) / size[..., None]  # rate of t
    T = np.maximum(line.EA * (strain + line.damping * rate), 0.0)
    elastic = np.maximum(strain, 0.0) ** 2 * line.EA * l / 2
    total = elastic.sum(axis=1) - (line.load * r).sum(axis=(1, 2))
    total = total + (line.point_mass / 2 * (v**2).sum(axis=2)).sum(axis=1)
    damper = ((T - np.maximum(line.EA * strain, 0.0)) * rate * l).sum(axis=1)
    drag, turning = np.zeros(len(r)), np.zeros(len(r))
    for nodes in (line.first, line.last):
        velocity, half = v[:, nodes], l / 2
        along = (velocity * t).sum(axis=2)
        square = (velocity**2).sum(axis=2)
        total = total + (half / 2 * (line.mass * square + line.added_mass * (square - along**2))).sum(axis=1)
        turning -= (half * line.added_mass * along * (velocity * turn).sum(axis=2)).sum(axis=1)
        u = velocity - np.array(line.current)
        u_t = (u * t).sum(axis=2)
        u_n = u - u_t[..., None] * t
        wet = half * np.sqrt(size / l)
        force = (wet * line.normal_drag * np.linalg.norm(u_n, axis=2))[..., None] * u_n
        force += (wet * line.tangential_drag * abs(u_t) * u_t)[..., None] * t
        drag += (force * velocity).sum(axis=(1, 2))
    u = v - np.array(line.current)
    drag += (line.point_drag * np.linalg.norm(u, axis=2) * (u * v).sum(axis=2)).sum(axis=1)
    penetration = np.maximum(line.floor - r[..., -1], 0.0)
    share = np.minimum(penetration / line.contact_depth, 1.0) if line.contact_depth else 1.0
    damping = line.seabed_damping * share
    normal = np.maximum(line.seabed_stiffness * penetration - damping * v[..., -1], 0.0) * (penetration > 0)
    total = total + (line.seabed_stiffness * penetration**2).sum(axis=1) / 2
    seabed = -((normal - line.seabed_stiffness * penetration) * v[..., -1]).sum(axis=1)
    level = (v[..., :-1] ** 2).sum(axis=2)
    friction = (line.friction * normal * level / np.sqrt(level + line.slip_speed**2)).sum(axis=1)
    held = system.prescribed_nodes
    on_line = -np.tensordot(system.axes, history.forces, 1).transpose(2, 1, 0)[:, held]
    return Energy(total, (on_line * v[:, held]).sum(axis=(1, 2)), drag, damper, seabed, friction, turning)


def energy_gap(history) -> float:
    """Return the largest difference of the change of energy and the work done, over the largest change, J/J."""
    energy = energy_of(history)
    h = np.diff(history.time)
    work = np.concatenate([[0.0], np.cumsum(h * (energy.power[1:] + energy.power[:-1]) / 2)])
    change = energy.total - energy.total[0]
    exchanged = sum(
        np.sum(h * abs(part)[1:]) for part in (energy.given, energy.drag, energy.damper, energy.seabed, energy.friction)
    )
    return float(abs(change - work).max() / max(abs(change).max(), exchanged))
