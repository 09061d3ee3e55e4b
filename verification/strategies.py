"""Hypothesis strategies of mooring lines. Every quantity is drawn as a power of ten, so that examples shrink to 1."""

from __future__ import annotations

from hypothesis import strategies as st

from .cases.spans import SpanCase


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
