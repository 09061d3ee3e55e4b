"""Where each network lies and what tension it carries: the part "pictures" of networks.json, which the report draws."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from solvers import Network, Span, solve_network, solve_span

from .systems import chain, net, scene, tree, two_lines

POINTS = 240  # of a whole picture, shared by its elements
LEAST_POINTS, MOST_POINTS = 4, 60  # of one element: few where many short ones make the shape


@dataclass(frozen=True)
class Picture:
    """A network to be drawn: name for files, title, how to make it; near: only so far around the coupled nodes, m."""

    name: str
    title: str
    make: Callable[[], Network]
    near: float | None = None


PICTURES = (
    Picture("two_lines", "Two lines and a buoyant joint (MSQS, section 5)", lambda: two_lines(59.1)),
    Picture("three_bridles", "Three lines with bridles", lambda: scene("three_bridles")),
    Picture("bridles_near", "The same, 60 m around the spar", lambda: scene("three_bridles"), near=60.0),
    Picture("oc3_three_lines", "Three lines of a spar (OC3)", lambda: scene("oc3_three_lines")),
    Picture("chain_wire_chain", "Chain, wire, chain: a joint on the seabed", lambda: scene("chain_wire_chain")),
    Picture("chain", "Chain", lambda: chain(10)),
    Picture("tree", "Tree", lambda: tree(30)),
    Picture("net", "Net", lambda: net(84)),
)


def tasks(quick: bool) -> list:
    """Calls, each giving the row of one network of the part "pictures"; the quick run draws all of them too."""
    return [partial(rows, picture) for picture in PICTURES]


def rows(picture: Picture) -> list[dict]:
    """One network, solved."""
    named = {"name": picture.name, "title": picture.title, "near": picture.near}
    return [named | drawn(picture.make(), picture.near)]


def drawn(network: Network, near: float | None = None) -> dict:
    """Nodes, elements and seabed of a solved network: lengths in m, tensions in N.

    nodes : kind and r (3,);  elements : x, y, z, tension along each, from its anchor, and its tension at either end as
    the network's state has it;  seabed : height, or None
    """
    state = solve_network(network)
    depth = network.environment.depth
    count = int(np.clip(POINTS // len(network.elements), LEAST_POINTS, MOST_POINTS))
    ends = np.column_stack([np.hypot(state.H_anchor, state.V_anchor), np.hypot(state.H, state.V)])
    centre, reach = state.r[state.coupled].mean(axis=0) if near else np.zeros(3), near or np.inf
    seen = np.linalg.norm(state.r - centre, axis=1) <= reach
    lines = [
        profile(element, state.r, depth, np.linspace(*part, count)) | {"ends": pair}
        for element, pair in zip(network.elements, ends, strict=True)
        for part in _parts(element, seen, reach)
    ]
    nodes = [{"kind": node.kind, "r": r} for node, r, yes in zip(network.nodes, state.r, seen, strict=True) if yes]
    seabed = None if depth is None or near else -depth
    return {"seabed": seabed, "nodes": nodes, "elements": lines, "residual_norm": state.residual_norm}


def _parts(element, seen, reach: float):
    """(s from, s to), m, of what is drawn of an element: all, a piece at an end that is seen, or nothing."""
    first, last = (bool(seen[end]) for end in element.ends)
    if first and last:
        yield 0.0, element.L
    elif first or last:
        piece = min(reach / 2, element.L)
        yield (0.0, piece) if first else (element.L - piece, element.L)


def profile(element, r, depth, s) -> dict:
    """x, y, z (m) and tension (N), arrays (k,), at s (k,), m, of one element between the nodes at r (n, 3)."""
    anchor, fairlead = (r[end] for end in element.ends)
    across = fairlead[:2] - anchor[:2]
    l = float(np.hypot(*across))
    seabed = depth is not None and element.w >= 0  # a buoyant line never lies on it
    clearance = float(anchor[2] + depth) if seabed else 0.0
    friction = element.friction if seabed and clearance == 0 else 0.0  # as in a network: where the anchor end lies
    rise = float(fairlead[2] - anchor[2])
    span = Span(element.w, element.EA, element.L, l, rise, seabed, friction, clearance)
    along, height, tension = solve_span(span).profile(s)
    direction = across / l if l > 0 else np.zeros(2)
    x, y = anchor[:2, None] + along * direction[:, None]
    return {"x": x, "y": y, "z": anchor[2] + height, "tension": tension}
