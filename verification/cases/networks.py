"""Cases of the problem type "network": cables between nodes. Inputs only; truth is in exact/network/network_mp.py.

Rows carry the attributes of solvers.Network (nodes, elements, environment) without importing it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np

GRAVITY = 9.80665


@dataclass(frozen=True)
class NodeCase:
    """Inputs of solvers.Node: r in m, mass in kg, volume in m^3, force in N."""

    kind: str
    r: tuple[float, float, float]
    mass: float = 0.0
    volume: float = 0.0
    force: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class ElementCase:
    """Inputs of solvers.Element: N/m, N, m; ends = (anchor node, fairlead node)."""

    w: float
    EA: float
    L: float
    ends: tuple[int, int]
    friction: float = 0.0


@dataclass(frozen=True)
class EnvironmentCase:
    """Inputs of solvers.Environment: kg/m^3, m/s^2, m."""

    rho: float = 1025.0
    g: float = GRAVITY
    depth: float | None = None


@dataclass(frozen=True)
class NetworkCase:
    """Inputs of solvers.Network and transformations that leave its physics as it is."""

    name: str
    nodes: tuple[NodeCase, ...]
    elements: tuple[ElementCase, ...]
    environment: EnvironmentCase = field(default_factory=EnvironmentCase)

    def mapped(self, matrix) -> NetworkCase:
        """Positions and forces multiplied by a (3, 3) matrix: rotation about z, reflection."""
        move = lambda v: tuple(float(c) for c in np.asarray(matrix) @ v)
        nodes = tuple(replace(node, r=move(node.r), force=move(node.force)) for node in self.nodes)
        return replace(self, name=f"{self.name}, mapped", nodes=nodes)

    def renumbered(self, nodes, elements) -> NetworkCase:
        """Row i of the new network is row nodes[i] (elements[i]) of this one."""
        new = {old: i for i, old in enumerate(nodes)}
        rows = (self.elements[e] for e in elements)
        lines = tuple(replace(line, ends=(new[line.ends[0]], new[line.ends[1]])) for line in rows)
        return replace(self, name=f"{self.name}, renumbered", nodes=tuple(self.nodes[i] for i in nodes), elements=lines)

    def end_swapped(self) -> NetworkCase:
        """Anchor and fairlead of every element exchanged: the same cable where no friction tells them apart."""
        lines = tuple(replace(line, ends=line.ends[::-1]) for line in self.elements)
        return replace(self, name=f"{self.name}, ends swapped", elements=lines)

    def scaled(self, length: float, force: float) -> NetworkCase:
        """Lengths and forces in other units."""
        env = self.environment
        nodes = tuple(
            replace(
                node,
                r=tuple(length * c for c in node.r),
                force=tuple(force * c for c in node.force),
                mass=force * node.mass,
                volume=force * node.volume,
            )
            for node in self.nodes
        )
        lines = tuple(
            replace(line, w=line.w * force / length, EA=line.EA * force, L=line.L * length) for line in self.elements
        )
        depth = None if env.depth is None else env.depth * length
        return NetworkCase(f"{self.name}, scaled", nodes, lines, replace(env, depth=depth))


def _water(depth):
    return EnvironmentCase(depth=depth)


# ---------------------------------------------------------------- the example of MSQS section 5
TWO_LINE_EA, TWO_LINE_W, TWO_LINE_W_PRINTED = 2.34e8, 59.1, 226.61
PAPER_START = (
    ((-1200.0, 0.0, -350.0), (0.0, 0.0, -350.0), (-26.0, 0.0, -65.0)),
    (168.7e3, 1.4e3),
    (752.7e3, 168.1e3),
)
"""r, H, V of (5.1), (5.2), in m and N."""


def two_line(w: float = TWO_LINE_W, friction: float = 0.0, depth: float | None = 350.0) -> NetworkCase:
    """Two lines that hold a buoy, MSQS section 5; w N/m of the paper's text or of its result (see the errata)."""
    nodes = (
        NodeCase("fixed", (-1200.0, 0.0, -350.0)),
        NodeCase("fixed", (0.0, 0.0, -350.0)),
        NodeCase("free", (-26.0, 0.0, -65.0), force=(0.0, 0.0, 637.65e3)),
    )
    lines = tuple(ElementCase(w, TWO_LINE_EA, L, (anchor, 2), friction) for anchor, L in ((0, 1175.0), (1, 300.0)))
    return NetworkCase(f"two-line, w {w:g}, friction {friction:g}, depth {depth}", nodes, lines, _water(depth))


# ---------------------------------------------------------------- networks with a closed form
def symmetric_v(span: float = 100.0, L: float = 60.0, w: float = 20.0, EA: float = 1e7, load: float = 5e3):
    """Two equal lines from (+-span/2, 0, 0) to a loaded node between them, no seabed."""
    nodes = (
        NodeCase("fixed", (-span / 2, 0.0, 0.0)),
        NodeCase("fixed", (span / 2, 0.0, 0.0)),
        NodeCase("free", (3.0, 1.0, -10.0), force=(0.0, 0.0, -load)),
    )
    lines = (ElementCase(w, EA, L, (0, 2)), ElementCase(w, EA, L, (1, 2)))
    return NetworkCase("symmetric V", nodes, lines, _water(None))


def chain(n: int, end=(300.0, 400.0, 200.0), L=600.0, w=100.0, EA=1e7, depth=None, friction=0.0) -> NetworkCase:
    """n equal elements in a row from (0, 0, -depth or 0) to ``end`` above it: one line of length L."""
    bottom = -(depth or 0.0)
    a, b = np.array([0.0, 0.0, bottom]), np.array(end) + [0.0, 0.0, bottom]
    places = [a + (b - a) * i / n for i in range(n + 1)]
    kinds = ["fixed", *["free"] * (n - 1), "coupled"]
    nodes = tuple(NodeCase(kind, tuple(map(float, p))) for kind, p in zip(kinds, places, strict=True))
    lines = tuple(ElementCase(w, EA, L / n, (i, i + 1), friction) for i in range(n))
    return NetworkCase(f"chain of {n}", nodes, lines, _water(depth))


def hanging_mass(mass: float = 2000.0, volume: float = 0.5, L: float = 50.0, w: float = 30.0, EA: float = 2e6):
    """A point mass at the end of one line: vertical, no azimuth."""
    nodes = (NodeCase("fixed", (3.0, -2.0, -5.0)), NodeCase("free", (10.0, 5.0, -30.0), mass, volume))
    return NetworkCase("hanging mass", nodes, (ElementCase(w, EA, L, (1, 0)),), _water(None))


def dragged_mass(EA: float = 1e9, force=(3e4, 4e4, 0.0), L: float = 100.0) -> NetworkCase:
    """A heavy node on the seabed, pulled along it at the end of one line that lies there: H is the pull."""
    nodes = (
        NodeCase("fixed", (7.0, -3.0, -50.0)),
        NodeCase("free", (60.0, 70.0, -50.0), mass=2e4, force=force),
    )
    return NetworkCase("dragged mass", nodes, (ElementCase(100.0, EA, L, (0, 1)),), _water(50.0))


def spring_net(n: int = 4, spacing: float = 10.0, EA: float = 1e6, stretch: float = 1.05, push: float = 500.0):
    """An n x n net of taut weightless lines between fixed rims, free nodes pushed sideways and down."""
    rim = lambda i, j: i in (0, n - 1) or j in (0, n - 1)
    corners = {(i, j) for i in (0, n - 1) for j in (0, n - 1)}
    place = {ij: k for k, ij in enumerate(ij for ij in np.ndindex(n, n) if ij not in corners)}
    nodes = tuple(
        NodeCase("fixed", (spacing * i, spacing * j, 0.0))
        if rim(i, j)
        else NodeCase("free", (spacing * i, spacing * j, 0.0), force=(push * (i - j), push, -push * (1 + i)))
        for i, j in place
    )
    pairs = [((i, j), (i + di, j + dj)) for i, j in place for di, dj in ((1, 0), (0, 1))]
    lines = tuple(
        ElementCase(0.0, EA, spacing / stretch, (place[a], place[b]))
        for a, b in pairs
        if b in place and not (rim(*a) and rim(*b))
    )
    return NetworkCase(f"spring net {n} x {n}", nodes, lines, _water(None))


# ---------------------------------------------------------------- moorings
def chain_wire_chain(friction: float = 0.0, depth: float = 100.0) -> NetworkCase:
    """Ground chain, wire, upper chain: the joint of ground chain and wire rests on the seabed."""
    nodes = (
        NodeCase("fixed", (0.0, 0.0, -depth)),
        NodeCase("free", (180.0, 5.0, -depth + 1.0), mass=100.0),
        NodeCase("free", (380.0, 5.0, -40.0)),
        NodeCase("coupled", (440.0, 10.0, -10.0)),
    )
    lines = (
        ElementCase(1500.0, 6e8, 200.0, (0, 1), friction),
        ElementCase(300.0, 3e8, 220.0, (1, 2), friction),
        ElementCase(1500.0, 6e8, 60.0, (2, 3)),
    )
    return NetworkCase(f"chain-wire-chain, friction {friction:g}", nodes, lines, _water(depth))


def clump_weight(friction: float = 0.0) -> NetworkCase:
    """A weight that rests on the seabed: a soft chain lies behind it, two lines rise from it to a body."""
    nodes = (
        NodeCase("fixed", (-300.0, 40.0, -100.0)),
        NodeCase("free", (-127.0, 17.0, -100.0), mass=3e4),
        NodeCase("coupled", (-4.0, 7.0, -20.0)),
        NodeCase("coupled", (-3.0, -6.0, -22.0)),
    )
    lines = (
        ElementCase(400.0, 2e6, 172.0, (0, 1), friction),
        ElementCase(150.0, 4e7, 152.0, (1, 2)),
        ElementCase(150.0, 4e7, 151.5, (1, 3)),
    )
    return NetworkCase(f"clump weight, friction {friction:g}", nodes, lines, _water(100.0))


def bridle() -> NetworkCase:
    """A lower line and two legs from a joint to a body, a buoy at the joint; no symmetry, no seabed."""
    nodes = (
        NodeCase("fixed", (-400.0, 30.0, -200.0)),
        NodeCase("free", (-50.0, 3.0, -60.0), mass=500.0, volume=2.0),
        NodeCase("coupled", (-5.0, 8.0, -20.0)),
        NodeCase("coupled", (-5.0, -9.0, -22.0)),
    )
    lines = (
        ElementCase(250.0, 4e8, 385.0, (0, 1)),
        ElementCase(180.0, 2e8, 61.0, (1, 2)),
        ElementCase(180.0, 2e8, 62.0, (1, 3)),
    )
    return NetworkCase("bridle", nodes, lines, _water(None))


def bridle_system(friction: float = 0.0, offset=(0.0, 0.0, 0.0)) -> NetworkCase:
    """Three lower lines on the seabed at 120 degrees, each with two legs to neighbouring fairleads: 9 lines."""
    depth, polar = 320.0, lambda radius, angle, z: (radius * math.cos(angle), radius * math.sin(angle), z)
    turns = [2 * math.pi * i / 3 for i in range(3)]
    moved = lambda r: tuple(a + b for a, b in zip(r, offset, strict=True))
    nodes = (
        *(NodeCase("fixed", polar(853.87, turn, -depth)) for turn in turns),
        *(NodeCase("free", polar(50.0, turn, -95.0)) for turn in turns),
        *(NodeCase("coupled", moved(polar(5.2, turn + math.pi / 3, -70.0))) for turn in turns),
    )
    lower = [ElementCase(698.094, 3.84243e8, 857.0, (i, 3 + i), friction) for i in range(3)]
    legs = [ElementCase(698.094, 3.84243e8, 51.0, (3 + i, 6 + j)) for i in range(3) for j in (i, (i + 2) % 3)]
    return NetworkCase("three bridles", nodes, (*lower, *legs), _water(depth))


NAMED = (
    two_line(),
    two_line(TWO_LINE_W_PRINTED),
    two_line(TWO_LINE_W_PRINTED, 1.0),
    two_line(TWO_LINE_W_PRINTED, depth=None),
    symmetric_v(),
    chain(6),
    hanging_mass(),
    spring_net(),
    chain_wire_chain(),
    chain_wire_chain(friction=0.6),
    bridle(),
    bridle_system(),
)


# ---------------------------------------------------------------- random networks
def random_networks(n: int, seed: int = 2026) -> list[NetworkCase]:
    """n valid networks of 2 to 40 elements, the same list for the same (n, seed).

    Trees with loops closed at random; slack to over-stretched lines, light, heavy, weightless and buoyant, stiffness
    over six decades; point masses, buoys and pulls; with and without seabed and friction.
    """
    return [random_network(i, seed) for i in range(n)]


def random_network(i: int, seed: int = 2026) -> NetworkCase:
    """Number i of ``random_networks``."""
    rng = np.random.default_rng((seed, i))
    count, size = int(rng.integers(2, 41)), 10 ** rng.uniform(0.5, 3)
    depth = float(size * rng.uniform(0.3, 1.5)) if rng.random() < 0.7 else None
    n = max(2, int(rng.integers(2, count + 2)))
    weight, EA = 10 ** rng.uniform(0, 3.5), 10 ** rng.uniform(4, 8)
    r = np.column_stack([rng.uniform(-size, size, (n, 2)), -rng.uniform(0, 1, n) * (depth or size)])
    kinds = ["free"] * n
    for node in rng.choice(n, int(rng.integers(1, max(2, n // 2) + 1)), replace=False):
        kinds[node] = "fixed" if rng.random() < 0.6 else "coupled"
        if kinds[node] == "fixed" and depth and rng.random() < 0.7:
            r[node, 2] = -depth
    lines = tuple(
        _random_line(rng, r, ends, weight, EA, kinds[ends[0]] == "fixed" and r[ends[0], 2] == -(depth or 0.0))
        for ends in _random_ends(rng, n, count)
    )
    nodes = tuple(_random_node(rng, kind, p, weight * size) for kind, p in zip(kinds, r, strict=True))
    return NetworkCase(f"random-{seed}-{i}", nodes, lines, _water(depth))


def _random_ends(rng, n, count):
    """A tree of n nodes and further pairs up to count elements."""
    order = rng.permutation(n)
    ends = [(int(order[rng.integers(0, k)]), int(order[k])) for k in range(1, n)]
    while len(ends) < count:
        ends.append(tuple(int(i) for i in rng.choice(n, 2, replace=False)))
    return ends


def _random_line(rng, r, ends, weight, EA, on_seabed):
    chord = np.linalg.norm(r[ends[0]] - r[ends[1]])
    L = chord * rng.choice([rng.uniform(0.8, 1), rng.uniform(1, 1.1), rng.uniform(1, 2.5)])
    relative = [rng.uniform(0.3, 3), 10 ** rng.uniform(-3, 0), 0.0, -rng.uniform(0.1, 1)]
    w = weight * rng.choice(relative, p=[0.7, 0.15, 0.05, 0.1])
    friction = rng.choice([0.0, rng.uniform(0, 1)]) if on_seabed else 0.0
    return ElementCase(float(w), float(EA * 10 ** rng.uniform(-3, 3)), float(L), ends, float(friction))


def _random_node(rng, kind, r, force):
    """A third of the free nodes carry a mass and a buoy, a fifth are pulled; ``force`` N is the typical line weight."""
    r, extra = tuple(float(c) for c in r), {}
    if kind == "free" and rng.random() < 0.3:
        mass, lift = (float(rng.uniform(0, 1) * force / 9.8) for _ in range(2))
        extra |= {"mass": mass, "volume": lift / 1025.0}
    if kind == "free" and rng.random() < 0.2:
        extra["force"] = tuple(float(v) for v in rng.normal(size=3) * force * 0.3)
    return NodeCase(kind, r, **extra)
