"""Hypothesis strategies of mooring lines and networks. Sizes are drawn as powers of ten: examples shrink to 1."""

from __future__ import annotations

import math

from hypothesis import strategies as st

from ..cases.networks import GRAVITY, ElementCase, EnvironmentCase, NetworkCase, NodeCase
from ..cases.spans import SpanCase


def powers(low: float, high: float):
    """Numbers between 10^low and 10^high, uniform in the exponent; the simplest is 1 where the range holds it."""
    return st.floats(low, high).map(lambda exponent: 10.0**exponent)


signs = st.sampled_from((1.0, -1.0))


@st.composite
def suspended_cases(draw, buoyant=True) -> SpanCase:
    """Lines without seabed, nowhere vertical: everyday ones, near-taut, over-stretched, slack, in every direction."""
    L, w = draw(powers(-1, 4)), draw(powers(-3, 5)) * (draw(signs) if buoyant else 1.0)
    EA = abs(w) * L * draw(powers(0.5, 12))
    x, z = _ends(draw, L)
    return SpanCase("hypothesis", "suspended", w, EA, L, x, z * draw(signs), seabed=False)


@st.composite
def seabed_cases(draw) -> SpanCase:
    """Lines over a seabed: with friction, or with a raised anchor and then without friction."""
    L, w = draw(powers(-1, 4)), draw(powers(-3, 5))
    EA = w * L * draw(powers(0.5, 12))
    x, z = _ends(draw, L)
    if draw(st.booleans()):
        return SpanCase("hypothesis", "seabed", w, EA, L, x, z, friction=draw(st.just(0.0) | powers(-4, 3)))
    clearance = L * draw(powers(-4, 0))
    return SpanCase("hypothesis", "raised", w, EA, L, x, max(z * draw(signs), -clearance), clearance=clearance)


def _ends(draw, L):
    """(x, z), both >= 0: slack, near the unstretched length, or over-stretched."""
    near = st.builds(lambda size, sign: 1 + sign * size, powers(-13, -1), signs)
    chord = L * draw(st.floats(0.05, 1.0) | near | powers(0, 1.5) | st.just(1.0))
    rise = draw(st.just(0.0) | powers(-9, -0.001))  # z/chord; exactly vertical lines are rows of the reference table
    return chord * (1 - rise * rise) ** 0.5, chord * rise


any_number = st.one_of(
    st.floats(),  # nan, inf, subnormal and huge among them
    st.sampled_from((0.0, -0.0, 5e-324, 2.3e-308, 1.7e308, 1.0, -1.0)),
    st.floats(-3.0, 3.0),
    powers(-30, 30),
)
"""What a careless caller may pass where a number is wanted."""


# ---------------------------------------------------------------- networks
@st.composite
def networks(draw, most_elements: int = 12, friction=True) -> NetworkCase:
    """Networks of 2 to ``most_elements`` elements, all regimes mixed: every free node tied to a fixed or coupled one.

    A tree over the nodes and closing elements; taut to slack, light, heavy, weightless and buoyant lines; stiffness
    over four decades; masses, buoys and pulls at free nodes; with and without seabed and its friction.
    """
    size, weight, EA = draw(powers(0.5, 3)), draw(powers(0, 3.5)), draw(powers(4, 8))
    depth = size * draw(st.floats(0.3, 1.5)) if draw(st.booleans()) else None
    count = draw(st.integers(2, most_elements))
    n = draw(st.integers(2, count + 1))
    nodes = [_anchor(draw, size, depth), *(_node(draw, size, depth, weight * size) for _ in range(n - 1))]
    ends = [(draw(st.integers(0, k - 1)), k) for k in range(1, n)]
    ends += [_pair(draw, n) for _ in range(count - len(ends))]
    lines = [_line(draw, nodes, pair, size, weight, EA, friction and depth is not None) for pair in ends]
    return NetworkCase("hypothesis", tuple(nodes), tuple(lines), EnvironmentCase(depth=depth))


def _pair(draw, n):
    """Two different nodes of n."""
    first, step = draw(st.integers(0, n - 1)), draw(st.integers(1, n - 1))
    return first, (first + step) % n


def _place(draw, size, depth):
    """Within a box of the half-width ``size``, above the seabed if there is one."""
    across, height = st.floats(-size, size), st.floats(-(depth or size), 0.0)
    return draw(across), draw(across), draw(height)


def _anchor(draw, size, depth) -> NodeCase:
    """A fixed node, on the seabed where there is one, or a coupled one."""
    x, y, z = _place(draw, size, depth)
    if draw(st.booleans()):
        return NodeCase("fixed", (x, y, z if depth is None else -depth))
    return NodeCase("coupled", (x, y, z))


def _node(draw, size, depth, force) -> NodeCase:
    """Mostly free; ``force`` N is the typical weight of a line."""
    if draw(st.sampled_from(("free", "free", "held"))) == "held":
        return _anchor(draw, size, depth)
    r, extra = _place(draw, size, depth), {}
    if draw(st.booleans()):
        share = st.floats(0.0, 1.0)
        extra = {"mass": draw(share) * force / GRAVITY, "volume": draw(share) * force / GRAVITY / EnvironmentCase.rho}
    if draw(st.integers(0, 3)) == 3:
        pull = st.floats(-0.5, 0.5)
        extra["force"] = (draw(pull) * force, draw(pull) * force, draw(pull) * force)
    return NodeCase("free", r, **extra)


def _line(draw, nodes, ends, size, weight, EA, seabed) -> ElementCase:
    """Its length is about the distance of the guessed places of its ends; friction where the anchor end is held.

    Held above the seabed it has none; at a free node it would come and go with the touch of the seabed.
    """
    first, last = (nodes[end] for end in ends)
    chord = max(math.dist(first.r, last.r), 1e-3 * size)
    L = chord * draw(st.floats(0.8, 1.0) | st.floats(1.0, 1.1) | st.floats(1.0, 2.5))
    w = weight * draw(st.floats(0.3, 3.0) | powers(-3, 0) | st.just(0.0) | st.floats(-1.0, -0.1))
    is_held = seabed and first.kind != "free"
    friction = draw(st.just(0.0) | st.floats(0.0, 1.0)) if is_held else 0.0
    return ElementCase(w, EA * draw(powers(-2, 2)), L, ends, friction)
