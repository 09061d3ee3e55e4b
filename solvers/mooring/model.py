"""A line as it is given: segments of one material each, between points that may carry a mass, from anchor to fairlead.

A Scene is one segment between a fixed and a moved point. A Network whose elements follow one another is a line of
several; each element then names its ``cable``, the section that the dynamics takes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ..catenary.span import Span, solve_span
from ..common.outcome import InputError
from ..common.properties import CableProperties, Environment
from ..network.model import Element, Network, Node
from ..network.solve import solve_network


@dataclass(frozen=True)
class Segment:
    """A part of a line of one material: weight N/m, EA N, length m, friction of the seabed, section for dynamics.

    reversed: whether its catenary runs from its last point to its first.
    """

    weight: float
    EA: float
    length: float
    friction: float
    cable: CableProperties
    reversed: bool = False

    def span(self, start, end, environment) -> Span:
        """Return the segment at rest between two points (3,), without the friction that dynamics has none of."""
        lower, upper = (end, start) if self.reversed else (start, end)
        seabed = environment.depth is not None and self.weight >= 0
        clearance = lower[2] + environment.depth if seabed else 0.0
        run = math.hypot(upper[0] - lower[0], upper[1] - lower[1])
        return Span(self.weight, self.EA, self.length, run, upper[2] - lower[2], seabed, 0.0, clearance)

    def profile(self, start, end, environment, s):
        """Return positions (3, k) and tensions (k,) at arc lengths s (k,) from the start, and the CatenaryState."""
        state = solve_span(self.span(start, end, environment))
        lower, upper = (np.array(end), np.array(start)) if self.reversed else (np.array(start), np.array(end))
        along, up, T = state.profile(self.length - s if self.reversed else s)
        level = np.hypot(*(upper - lower)[:2])
        direction = (upper - lower)[:2] / level if level > 0 else np.array([1.0, 0.0])
        return np.stack([lower[0] + along * direction[0], lower[1] + along * direction[1], lower[2] + up]), T, state


@dataclass(frozen=True)
class LineModel:
    """Segments (k,) between points (k + 1,), network.Node each; environment; name for messages."""

    name: str
    segments: tuple[Segment, ...]
    points: tuple[Node, ...]
    environment: Environment

    @property
    def length(self) -> float:
        """Unstretched length, m."""
        return sum(segment.length for segment in self.segments)

    def equilibrium(self, displacement=(0.0, 0.0, 0.0)) -> list[np.ndarray]:
        """Return the positions (3,) of the points on the catenaries at rest, the last one displaced, m."""
        places = [np.array(point.r) for point in self.points]
        places[-1] = places[-1] + np.array(displacement)
        free = [i for i, point in enumerate(self.points) if point.kind == "free"]
        if free:
            nodes = [
                Node(p.kind, tuple(r), p.mass, p.volume, p.force) for p, r in zip(self.points, places, strict=True)
            ]
            ends = [(i + 1, i) if segment.reversed else (i, i + 1) for i, segment in enumerate(self.segments)]
            elements = [Element(s.weight, s.EA, s.length, e) for s, e in zip(self.segments, ends, strict=True)]
            state = solve_network(Network(nodes, elements, self.environment))
            for i in free:
                places[i] = state.r[i]
        return places

    def pretension(self, displacement=(0.0, 0.0, 0.0)) -> float:
        """Return the tension of the catenaries at the last point, displaced by (3,) in m, N."""
        points, last = self.equilibrium(displacement), self.segments[-1]
        state = last.profile(points[-2], points[-1], self.environment, np.zeros(1))[2]
        return math.hypot(state.H_anchor, state.V_anchor) if last.reversed else state.tension

    def at_rest(self, s, displacement=(0.0, 0.0, 0.0)) -> LineAtRest:
        """Return the catenaries on a mesh s (N,) in m, the last point displaced by (3,) in m.

        Nodes that rest on the seabed are as deep as their weight presses them.
        """
        points, joint, middles = self.equilibrium(displacement), 0.0, (s[1:] + s[:-1]) / 2
        r, tension, horizontal_tension, states = np.zeros((3, s.size)), np.zeros(s.size - 1), np.zeros(s.size - 1), []
        for segment, (start, end) in zip(self.segments, pairwise(points), strict=True):
            nodes = (s >= joint - 1e-9 * segment.length) & (s <= joint + segment.length * (1 + 1e-9))
            local = np.clip(s[nodes] - joint, 0.0, segment.length)
            position, _, state = segment.profile(start, end, self.environment, local)
            if state.grounded_length > 0 and self.environment.seabed_stiffness:
                lying = (segment.length - local if segment.reversed else local) <= state.grounded_length
                position[2] -= np.where(lying, segment.weight / self.environment.seabed_stiffness, 0.0)
            r[:, nodes] = position
            cells = (middles > joint) & (middles < joint + segment.length)
            tension[cells] = segment.profile(start, end, self.environment, middles[cells] - joint)[1]
            horizontal_tension[cells] = state.H
            states.append(state)
            joint += segment.length
        r[:, 0], r[:, -1] = points[0], points[-1]
        return LineAtRest(r, tension, horizontal_tension, tuple(states))


class LineAtRest(NamedTuple):
    """Catenaries on a mesh: nodes at r (3, N) in m; tension of the cells and its horizontal part, (C,) in N.

    states: a CatenaryState of each segment.
    """

    r: np.ndarray
    tension: np.ndarray
    horizontal_tension: np.ndarray
    states: tuple


def build_line_model(given) -> LineModel:
    """Return the line of a Scene, or of a Network whose elements follow one another.

    Raises InputError where elements branch, or where what dynamics needs is missing.
    """
    if isinstance(given, Network):
        return _from_network(given)
    for name in ("cable", "length", "anchor", "fairlead", "environment"):
        if not hasattr(given, name):
            raise InputError(f"{given!r} is no Scene and no Network", field="scene", value=given)
    friction = given.friction[0] if getattr(given, "friction", ()) else 0.0
    weight = given.cable.weight_in(given.environment)
    segment = Segment(weight, given.cable.EA, given.length, friction, given.cable)
    points = Node("fixed", given.anchor), Node("coupled", given.fairlead)
    return _require_dynamic_data(LineModel(given.name, (segment,), points, given.environment))


def _from_network(network) -> LineModel:
    ends = [element.ends for element in network.elements]
    degree = np.bincount(np.ravel(ends), minlength=len(network.nodes))
    tips = np.flatnonzero(degree == 1).tolist()
    if degree.max() > 2 or len(tips) != 2:
        problem = "its elements must follow one another from one end to the other; here they branch or close a ring"
        raise InputError(problem, field="network", value=network)
    tips.sort(key=lambda i: (network.nodes[i].kind == "coupled", network.nodes[i].kind == "fixed"))
    node, order, segments, left = tips[0], [tips[0]], [], list(range(len(ends)))
    while left:
        e = next(e for e in left if node in ends[e])
        left.remove(e)
        element, backward = network.elements[e], ends[e][1] == node
        if element.cable is None:
            raise InputError("not given, and a moving line takes it", field=f"elements[{e}].cable", value=None)
        segments.append(Segment(element.w, element.EA, element.L, element.friction, element.cable, backward))
        node = ends[e][0] if backward else ends[e][1]
        order.append(node)
    points = tuple(network.nodes[i] for i in order)
    return _require_dynamic_data(LineModel("the network", tuple(segments), points, network.environment))


def _require_dynamic_data(model) -> LineModel:
    for i, segment in enumerate(model.segments):
        for name, unit in (("diameter", "m"), ("mass_per_length", "kg/m")):
            if getattr(segment.cable, name) is None:
                where = name if len(model.segments) == 1 else f"elements[{i}].cable.{name}"
                raise InputError(f"not given ({unit}), and a moving line takes it", field=where, unit=unit)
    environment = model.environment
    if environment.depth is not None and environment.seabed_stiffness is None:
        problem = "not given (N/m^2), and a moving line over a seabed takes it"
        raise InputError(problem, field="seabed_stiffness", unit="N/m^2")
    return model
