"""What a network is: nodes and the elements between them (MSQS sections 3.1, 3.2), validated when built.

Lengths in m, forces in N, z up; the seabed is at z = -environment.depth.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from .catenary import Span
from .network_balance import Balance
from .outcome import InputError
from .properties import Environment, real_number

KINDS = ("fixed", "free", "coupled")


@dataclass(frozen=True)
class Node:
    """A point where elements meet.

    kind : "fixed" (an anchor), "free" (its position is solved for) or "coupled" (moved by a body)
    r : (3,) position, m; of a free node the user's guess
    mass : point mass, kg, and volume : displaced volume, m^3, both >= 0
    force : (3,) external force, N
    """

    kind: str
    r: tuple[float, float, float]
    mass: float = 0.0
    volume: float = 0.0
    force: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self):
        if self.kind not in KINDS:
            raise InputError(f"kind: {self.kind!r} must be one of {', '.join(KINDS)}")
        object.__setattr__(self, "r", _vector("r", self.r, "m"))
        object.__setattr__(self, "force", _vector("force", self.force, "N"))
        for name, unit in (("mass", "kg"), ("volume", "m^3")):
            value = real_number(name, getattr(self, name), unit)
            if value < 0:
                raise InputError(f"{name}: {value:g} {unit} must be >= 0")
            object.__setattr__(self, name, value)


@dataclass(frozen=True)
class Element:
    """A cable between two nodes: w N/m, EA N, L m as in Span; ends = (anchor node, fairlead node), indices.

    friction : coefficient of the seabed where the anchor end lies on it (MSQS 2.15); a raised anchor end has none.
    """

    w: float
    EA: float
    L: float
    ends: tuple[int, int]
    friction: float = 0.0

    def __post_init__(self):
        line = Span(self.w, self.EA, self.L, 0.0, 0.0, seabed=False, friction=self.friction)
        for name in ("w", "EA", "L", "friction"):
            object.__setattr__(self, name, getattr(line, name))
        try:
            first, last = (int(end) for end in self.ends if not isinstance(end, bool))
        except (TypeError, ValueError):
            raise InputError(f"ends: {self.ends!r} must be two node indices") from None
        object.__setattr__(self, "ends", (first, last))


@dataclass(frozen=True)
class Network:
    """Nodes, elements and environment. Raises InputError naming the node or element, its value and its unit."""

    nodes: tuple[Node, ...]
    elements: tuple[Element, ...]
    environment: Environment = field(default_factory=Environment)

    def __post_init__(self):
        object.__setattr__(self, "nodes", tuple(self.nodes))
        object.__setattr__(self, "elements", tuple(self.elements))
        if not self.elements:
            raise InputError("elements: a network needs at least one element")
        n, depth = len(self.nodes), self.environment.depth
        for e, element in enumerate(self.elements):
            if not all(0 <= end < n for end in element.ends):
                raise InputError(f"element {e}: ends {element.ends} must be node indices from 0 to {n - 1}")
            if element.ends[0] == element.ends[1]:
                raise InputError(f"element {e}: both ends are node {element.ends[0]}")
        for i, node in enumerate(self.nodes):
            if depth is not None and node.r[2] < -depth:
                raise InputError(f"node {i} ({node.kind}): z = {node.r[2]:g} m lies below the seabed at {-depth:g} m")
        held, carrying = self._held(), {end for element in self.elements for end in element.ends}
        for i, node in enumerate(self.nodes):
            if i not in carrying:
                raise InputError(f"node {i} ({node.kind}): carries no element")
            if not held[i]:
                raise InputError(f"node {i} ({node.kind}): no chain of elements ties it to a fixed or coupled node")

    def _held(self) -> list[bool]:
        """Nodes that are tied to a fixed or coupled node; one that carries no element is not."""
        neighbours = [[] for _ in self.nodes]
        for first, last in (element.ends for element in self.elements):
            neighbours[first].append(last)
            neighbours[last].append(first)
        reached = [node.kind != "free" and bool(neighbours[i]) for i, node in enumerate(self.nodes)]
        front = [i for i, yes in enumerate(reached) if yes]
        while front:
            for other in neighbours[front.pop()]:
                if not reached[other]:
                    reached[other] = True
                    front.append(other)
        return reached

    def moved(self, positions) -> Network:
        """The same network, its coupled nodes at positions (c, 3), m, in their order: the inputs u of section 1.3."""
        positions = np.asarray(positions, dtype=float)
        coupled = [i for i, node in enumerate(self.nodes) if node.kind == "coupled"]
        if positions.shape != (len(coupled), 3):
            raise InputError(f"positions: shape {positions.shape} must be ({len(coupled)}, 3), one row a coupled node")
        nodes = list(self.nodes)
        for i, r in zip(coupled, positions, strict=True):
            old = nodes[i]
            nodes[i] = Node("coupled", tuple(r), old.mass, old.volume, old.force)
        moved = Network(tuple(nodes), self.elements, self.environment)
        moved.__dict__["balance"] = self.balance.moved(moved)  # the assembly pattern is found once
        return moved

    @cached_property
    def balance(self) -> Balance:
        """The equations, assembled when first needed."""
        return Balance(self)


def _vector(name, value, unit) -> tuple[float, float, float]:
    try:
        x, y, z = value
    except (TypeError, ValueError):
        raise InputError(f"{name}: {value!r} must be three numbers ({unit})") from None
    return tuple(real_number(f"{name}[{i}]", number, unit) for i, number in enumerate((x, y, z)))
