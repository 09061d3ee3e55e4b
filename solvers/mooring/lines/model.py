"""Lines as they are given: segments of one material each, between points that may carry a mass.

A Scene is one segment between a fixed and a moved point; of a Network each element is one, and names its ``cable``, the
section that the dynamics takes. Where elements follow one another they are one line, taken from end to end.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ...catenary.span import Span, solve_span
from ...common.outcome import InputError
from ...common.properties import CableProperties, Environment, missing_seabed_stiffness
from ...network.model import Element, Network, Node
from ...network.solve import solve_network
from .layout import follow_segments

_ON_SEABED = 1e-9  # of the depth: a point as near to the seabed rests on it, but for rounding


@dataclass(frozen=True)
class Segment:
    """A part of a line of one material: weight N/m, EA N, length m, friction of the seabed, section for dynamics.

    ends: indices of its first and last point; reversed: whether its catenary runs from its last point to its first.
    """

    weight: float
    EA: float
    length: float
    friction: float
    cable: CableProperties
    ends: tuple[int, int] = (0, 1)
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
class MooringModel:
    """Segments (k,) between points, network.Node each; environment; name for messages.

    is_line: whether each segment follows the one before, and each point, from the first to the last.
    given: the Scene or Network that it was made of.
    """

    name: str
    segments: tuple[Segment, ...]
    points: tuple[Node, ...]
    environment: Environment
    is_line: bool = True
    given: Any = field(default=None, repr=False, compare=False)

    @property
    def length(self) -> float:
        """Unstretched length of all segments, m."""
        return sum(segment.length for segment in self.segments)

    @cached_property
    def positions(self) -> np.ndarray:
        """Positions (P, 3) of the points as they are given, m."""
        return np.array([point.r for point in self.points], dtype=float)

    @cached_property
    def moved(self) -> list[int]:
        """Indices of the M points that a motion moves: the coupled ones."""
        return [i for i, point in enumerate(self.points) if point.kind == "coupled"]

    def equilibrium(self, displacement=(0.0, 0.0, 0.0)) -> np.ndarray:
        """Return positions (P, 3) of the points at rest, the moved ones displaced by (3,) or (M, 3), m."""
        places = self.positions.copy()
        places[self.moved] += np.asarray(displacement)
        free = [i for i, point in enumerate(self.points) if point.kind == "free"]
        if free:
            nodes = [replace(p, r=tuple(r)) for p, r in zip(self.points, places.tolist(), strict=True)]
            elements = [Element(s.weight, s.EA, s.length, s.ends[:: -1 if s.reversed else 1]) for s in self.segments]
            places[free] = solve_network(Network(nodes, elements, self.environment)).r[free]
        return places

    def pretension(self, displacement=(0.0, 0.0, 0.0)) -> float:
        """Return the tension of a line's catenaries at its last point, displaced by (3,) in m, N."""
        points, last = self.equilibrium(displacement), self.segments[-1]
        state = last.profile(points[-2], points[-1], self.environment, np.zeros(1))[2]
        return math.hypot(state.H_anchor, state.V_anchor) if last.reversed else state.tension

    def at_rest(self, layout, displacement=(0.0, 0.0, 0.0)) -> CatenariesAtRest:
        """Return the catenaries on the nodes of a Layout, the moved points displaced by (3,) or (M, 3) in m.

        Nodes that rest on the seabed are as deep as their weight presses them.
        """
        points, environment = self.equilibrium(displacement), self.environment
        r, (tension, horizontal_tension), states = np.zeros((3, layout.size)), np.zeros((2, layout.first.size)), []
        for segment, s, nodes, cells in zip(self.segments, layout.s, layout.nodes, layout.cells, strict=True):
            start, end = (points[i] for i in segment.ends)
            position, _, state = segment.profile(start, end, environment, s)
            if state.grounded_length > 0 and environment.seabed_stiffness:
                lying = (segment.length - s if segment.reversed else s) <= state.grounded_length
                position[2] -= np.where(lying, segment.weight / environment.seabed_stiffness, 0.0)
            r[:, nodes] = position
            tension[cells] = segment.profile(start, end, environment, (s[1:] + s[:-1]) / 2)[1]
            horizontal_tension[cells] = state.H
            states.append(state)
        r[2, layout.points] = points[:, 2] - self._sinkage(layout, points)
        prescribed = [i for i, point in enumerate(self.points) if point.kind != "free"]
        r[:, layout.points[prescribed]] = points[prescribed].T
        return CatenariesAtRest(r, tension, horizontal_tension, tuple(states))

    def _sinkage(self, layout, points) -> np.ndarray:
        """Return how far points (P, 3) on the seabed sink under their weight and that of half a cell each way, m."""
        environment, weight, length = self.environment, np.zeros(len(points)), np.zeros(len(points))
        if environment.depth is None or not environment.seabed_stiffness:
            return weight
        for i, point in enumerate(self.points):
            weight[i] = environment.g * (point.mass - environment.rho * point.volume) - point.force[2]
        for segment, s in zip(self.segments, layout.s, strict=True):
            halves = (s[[1, -1]] - s[[0, -2]]) / 2
            np.add.at(length, list(segment.ends), halves)
            np.add.at(weight, list(segment.ends), segment.weight * halves)
        rests = points[:, 2] <= -environment.depth * (1 - _ON_SEABED)
        return np.where(rests, np.maximum(weight / length, 0.0) / environment.seabed_stiffness, 0.0)


class CatenariesAtRest(NamedTuple):
    """Catenaries on a mesh: nodes at r (3, N) in m; tension of the cells and its horizontal part, (C,) in N.

    states: a CatenaryState of each segment.
    """

    r: np.ndarray
    tension: np.ndarray
    horizontal_tension: np.ndarray
    states: tuple


def build_model(given) -> MooringModel:
    """Return the model of a Scene or a Network. Raises InputError where what dynamics needs is missing."""
    model = _from_network(given) if isinstance(given, Network) else _from_scene(given)
    for i, segment in enumerate(model.segments):
        for name, unit in (("diameter", "m"), ("mass_per_length", "kg/m")):
            if getattr(segment.cable, name) is None:
                where = name if len(model.segments) == 1 else f"elements[{i}].cable.{name}"
                raise InputError(f"not given ({unit}), and a moving line takes it", field=where, unit=unit)
    environment = model.environment
    if environment.depth is not None and environment.seabed_stiffness is None:
        diameter = max(segment.cable.diameter for segment in model.segments)  # type: ignore[type-var]
        raise missing_seabed_stiffness("a moving line", diameter)
    return model


def _from_scene(scene) -> MooringModel:
    for name in ("cable", "length", "anchor", "fairlead", "environment"):
        if not hasattr(scene, name):
            raise InputError(f"{scene!r} is no Scene and no Network", field="scene", value=scene)
    friction = scene.friction[0] if getattr(scene, "friction", ()) else 0.0
    segment = Segment(scene.cable.weight_in(scene.environment), scene.cable.EA, scene.length, friction, scene.cable)
    points = Node("fixed", scene.anchor), Node("coupled", scene.fairlead)
    return MooringModel(scene.name, (segment,), points, scene.environment, given=scene)


def _from_network(network) -> MooringModel:
    for e, element in enumerate(network.elements):
        if element.cable is None:
            raise InputError("not given, and a moving line takes it", field=f"elements[{e}].cable", value=None)
    ends = [element.ends for element in network.elements]
    degree = np.bincount(np.ravel(ends), minlength=len(network.nodes))
    tips = np.flatnonzero(degree == 1).tolist()
    tips.sort(key=lambda i: (network.nodes[i].kind == "coupled", network.nodes[i].kind == "fixed"))
    (_, start), *path = follow_segments(ends, tips[:1] or [0], degree > 2)
    is_line = degree.max() <= 2 and len(tips) == 2 and len(path) == len(ends) == len(network.nodes) - 1
    if is_line:
        order = [start, *(point for _, point in path)]
        used = [(network.elements[e], (i, i + 1), ends[e][0] == point) for i, (e, point) in enumerate(path)]
    else:
        order, used = list(range(len(network.nodes))), [(element, element.ends, False) for element in network.elements]
    segments = tuple(Segment(e.w, e.EA, e.L, e.friction, e.cable, *where) for e, *where in used)
    points, name = tuple(network.nodes[i] for i in order), getattr(network, "name", "") or "the network"
    return MooringModel(name, segments, points, network.environment, is_line, network)
