"""Nodes, the elements between them, and the network of both (MSQS sections 3.1, 3.2), validated when built.

Lengths in m, forces in N, z up; the seabed is at z = -environment.depth.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, field
from functools import cached_property
from operator import index

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from ..catenary.span import Span
from ..common.outcome import InputError
from ..common.properties import CableProperties, Environment
from ..common.types import Vector
from ..common.validation import array_of_reals, instance_of, non_negative_number, one_of, vector
from .equations import NetworkEquations

KINDS = ("fixed", "free", "coupled")


@dataclass(frozen=True)
class Node:
    """A point where elements meet.

    kind : "fixed" (an anchor), "free" (its position is solved for) or "coupled" (moved by a body)
    r : (3,) position, m; of a free node the user's guess
    mass : point mass, kg, and volume : displaced volume, m^3, both >= 0
    force : (3,) external force, N
    CdA : drag coefficient times area, m^2, and Ca : added-mass coefficient of the volume, both >= 0, alike in all
    directions; they act in motion only

    >>> Node("free", (0, 0, -65), force=(0, 0, 6.4e5)).mass
    0.0
    """

    kind: str
    r: Vector
    mass: float = 0.0
    volume: float = 0.0
    force: Vector = (0.0, 0.0, 0.0)
    CdA: float = field(default=0.0, kw_only=True)
    Ca: float = field(default=0.0, kw_only=True)

    def __post_init__(self):
        one_of("kind", self.kind, KINDS)
        for name, unit in (("r", "m"), ("force", "N")):
            object.__setattr__(self, name, vector(name, getattr(self, name), unit, "numbers"))
        for name, unit in (("mass", "kg"), ("volume", "m^3"), ("CdA", "m^2"), ("Ca", "(dimensionless)")):
            object.__setattr__(self, name, non_negative_number(name, getattr(self, name), unit))


@dataclass(frozen=True)
class Element:
    """A cable between two nodes: w N/m, EA N, L m as in Span; ends = (anchor node, fairlead node), indices.

    w < 0: buoyant; such a line never touches the seabed, and hangs as if there were none, below it too.
    friction : coefficient of the seabed where the anchor end lies on it (MSQS 2.15); a raised anchor end has none.
    cable : the section for dynamics (mass, drag, damping), of the same EA; None where statics alone is asked for.

    >>> Element(w=59.1, EA=2.34e8, L=300, ends=(1, 2)).friction
    0.0
    """

    w: float
    EA: float
    L: float
    ends: Sequence[int]
    friction: float = 0.0
    cable: CableProperties | None = None

    def __post_init__(self):
        if self.cable is not None:
            instance_of("cable", self.cable, CableProperties)
            if self.cable.EA != self.EA:
                problem = f"its EA, {self.cable.EA:g} N, must be that of the element, {self.EA:g} N"
                raise InputError(problem, field="cable", value=self.cable, unit="N")
        line = Span(self.w, self.EA, self.L, 0.0, 0.0, seabed=False, friction=self.friction)
        for name in ("w", "EA", "L", "friction"):
            object.__setattr__(self, name, getattr(line, name))
        try:
            first, last = (index(end) for end in self.ends if not isinstance(end, (bool, np.bool_)))
        except (TypeError, ValueError):
            raise InputError(f"{self.ends!r} must be two node indices", field="ends", value=self.ends) from None
        object.__setattr__(self, "ends", (first, last))


@dataclass(frozen=True)
class Network:
    """Nodes, elements and environment. Raises InputError naming the node or element, its value and its unit.

    >>> nodes = [Node("fixed", (0, 0, 0)), Node("free", (0, 0, -90))]
    >>> len(Network(nodes, [Element(w=59.1, EA=2.34e8, L=100, ends=(1, 0))]).elements)
    1
    """

    nodes: Sequence[Node]
    elements: Sequence[Element]
    environment: Environment = field(default_factory=Environment)

    def __post_init__(self):
        for name, kind in (("nodes", Node), ("elements", Element)):
            object.__setattr__(self, name, _tuple_of(name, getattr(self, name), kind))
        instance_of("environment", self.environment, Environment)
        if not self.elements:
            raise InputError("a network needs at least one element", field="elements", value=self.elements)
        n, depth = len(self.nodes), self.environment.depth
        for e, element in enumerate(self.elements):
            ends = {"item": ("element", e), "field": "ends", "value": element.ends}
            if not all(0 <= end < n for end in element.ends):
                raise InputError(f"ends {element.ends} must be node indices from 0 to {n - 1}", **ends)
            if element.ends[0] == element.ends[1]:
                raise InputError(f"both ends are node {element.ends[0]}", **ends)
        node_error = lambda i, problem, **field: InputError(
            problem, item=("node", i), label=f"node {i} ({self.nodes[i].kind})", **field
        )
        for i, node in enumerate(self.nodes):
            if depth is not None and node.r[2] < -depth:
                problem = f"z = {node.r[2]:g} m lies below the seabed at {-depth:g} m"
                raise node_error(i, problem, field="r", value=node.r, unit="m")
        supported, used = self._supported_nodes(), {end for element in self.elements for end in element.ends}
        for i in range(n):
            if i not in used:
                raise node_error(i, "carries no element")
            if not supported[i]:
                raise node_error(i, "no chain of elements ties it to a fixed or coupled node")

    def _supported_nodes(self) -> np.ndarray:
        """Return whether each node is tied to a fixed or coupled one by elements."""
        first, last = np.array([element.ends for element in self.elements]).T
        links = coo_matrix((np.ones(first.size), (first, last)), shape=(len(self.nodes),) * 2)
        _, part = connected_components(links, directed=False)
        return np.isin(part, part[[node.kind != "free" for node in self.nodes]])

    def moved(self, positions) -> Network:
        """Return the same network with its coupled nodes at positions (c, 3), m, in their order: u of section 1.3.

        Raises InputError for another shape, for what is not finite, and for a position below the seabed.
        """
        coupled = np.flatnonzero(self.equations.coupled)
        count, seabed = coupled.size, self.equations.seabed
        given = {"field": "positions", "value": positions, "unit": "m"}
        r = array_of_reals("positions", positions, f"{positions!r} must be ({count}, 3) real numbers (m)", "m")
        if r.shape != (count, 3):
            raise InputError(f"shape {r.shape} must be ({count}, 3), one row a coupled node", **given)
        if not np.isfinite(r).all():
            raise InputError(f"{r.tolist()} m must be finite", **given)
        if (r[:, 2] < seabed).any():
            raise InputError(f"z = {r[:, 2].min():g} m lies below the seabed at {seabed:g} m", **given)
        nodes, moved = list(self.nodes), copy(self)
        for i, place in zip(coupled.tolist(), r.tolist(), strict=True):
            nodes[i] = copy(nodes[i])
            object.__setattr__(nodes[i], "r", tuple(place))
        object.__setattr__(moved, "nodes", tuple(nodes))
        moved.__dict__["equations"] = self.equations.with_coupled_nodes_at(r)  # keeps the sparsity
        return moved

    @cached_property
    def equations(self) -> NetworkEquations:
        """The equations, set up when first needed."""
        return NetworkEquations(self)


def _tuple_of(name: str, given, kind: type) -> tuple:
    """Return what is given as a tuple; raises InputError naming the first item that is not of the kind."""
    try:
        given = tuple(given)
    except TypeError:
        raise InputError(f"{given!r} must be a list of solvers.{kind.__name__}", field=name, value=given) from None
    for i, item in enumerate(given):
        instance_of(f"{name}[{i}]", item, kind)
    return given
