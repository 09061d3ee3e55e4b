"""Does the answer keep what physics keeps? Halves, swapped ends, other units, mirrors, rotations, balance."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from solvers import Regime, Scene, Span, solve_span

from ..cases.spans import NAMED, OC3
from ..exact.cable import catenary_mp
from ..reference import EPS, span_references
from ..tools.strategies import powers, seabed_cases, suspended_cases
from .test_exact import sensitivity, stiffness_condition

ROUNDINGS = 200  # condition limits: two solves of a hundred each
POSITION = 1e-11  # of L: the profile is the forward map of forces that are right to 100 eps kappa, kappa about 100 here
DIGITS = 6e-3  # the table gives the condition to three digits
MANY = settings(max_examples=300)  # cheap examples; the count is independent of the run's length

LINES = [Span(**case.inputs()) for case in NAMED] + [
    Span(30.0, 1e6, 100.0, 80.0, 10.0, clearance=5.0),  # raised, touching
    Span(30.0, 1e6, 100.0, 80.0, -4.0, clearance=5.0),  # the anchor is the higher end
    Span(30.0, 1e6, 100.0, 50.0, 30.0),  # slack
    Span(30.0, 1e6, 100.0, 40.0, 5.0, clearance=20.0),  # slack over a raised anchor
    Span(30.0, 1e5, 100.0, 101.0, 0.0, friction=0.5),  # lying
    Span(-30.0, 1e6, 100.0, 70.0, 40.0, seabed=False),  # buoyant
    Span(30.0, 1e5, 100.0, 0.0, 60.0, seabed=False),  # folded
    Span(30.0, 1e4, 100.0, 30.0, 160.0, seabed=False),  # steep
    Span(0.0, 1e5, 100.0, 90.0, 60.0),  # weightless
]


def kappa(span: Span, state=None) -> float:
    """Return the condition of the force, from the solver's stiffness by dimension analysis."""
    state = state or solve_span(span)
    return stiffness_condition(span, state) if math.hypot(state.H, state.V) else 0.0


def assert_same_force(a, b, limits, scale=None):
    """Raise AssertionError unless (H, V) pairs agree to ``limits`` roundings of the larger tension."""
    scale = scale or max(math.hypot(*a), math.hypot(*b))
    difference = max(abs(p - q) for p, q in zip(a, b, strict=True))
    assert difference <= limits * EPS * scale, f"{a} and {b} differ by {difference / scale / EPS:.3g} eps"


# ---------------------------------------------------------------- a line equals its parts
TAUT = [span for span in LINES if span.w != 0 and solve_span(span).H > 0]  # those that have a tangent everywhere
HANGING = [span for span in LINES if span.w != 0 and span.x > 0 and not (span.z == 0 and span.seabed)]


@pytest.mark.parametrize("part", [0.1, 0.25, 0.5, 0.9])  # of the length that hangs from the fairlead
@pytest.mark.parametrize("span", HANGING)
def test_a_line_equals_two_joined_parts(span, part):
    """Cut at any point that hangs and solved as two lines, both parts carry the forces of the whole."""
    state = solve_span(span)
    touchdown = span.L - state.V / span.w if state.grounded_length else 0.0
    cut = touchdown + part * (span.L - touchdown)
    x, z, _ = (float(value) for value in state.profile(cut))
    V = state.V - span.w * (span.L - cut)
    lower = replace(span, L=cut, x=x, z=z)
    upper = Span(span.w, span.EA, span.L - cut, span.x - x, span.z - z, seabed=False)
    below, above = solve_span(lower), solve_span(upper)
    scale = max(state.tension, math.hypot(state.H_anchor, state.V_anchor))
    for piece, got, wanted in (
        (lower, (below.H, below.V), (state.H, V)),
        (lower, (below.H_anchor, below.V_anchor), (state.H_anchor, state.V_anchor)),
        (upper, (above.H, above.V), (state.H, state.V)),
        (upper, (above.H_anchor, above.V_anchor), (state.H, V)),
    ):
        # a piece is given by positions to eps of the whole line, which counts like an error of its own length
        assert_same_force(got, wanted, ROUNDINGS * (1 + kappa(piece) + kappa(span)) * span.L / piece.L, scale)


# ---------------------------------------------------------------- swapped ends and mirrors
def swap_misses(cases) -> list[str]:
    """Lines without seabed whose forces or stiffness change by a bit when their ends are swapped."""
    misses = []
    for case in cases:
        if case.seabed:
            continue
        span = Span(**case.inputs())
        state, other = solve_span(span), solve_span(replace(span, z=-span.z))
        same = (other.H, other.V, other.V_anchor) == (state.H, -state.V_anchor, -state.V)
        if not (same and np.array_equal(other.stiffness, state.stiffness * [[1, -1], [-1, 1]])):
            misses.append(f"{case.name}: {(state.H, state.V, state.V_anchor)} and {(other.H, other.V, other.V_anchor)}")
    return misses


@MANY
@given(suspended_cases())
def test_swapped_ends_without_seabed(case):
    """With its ends swapped, a free line has the same forces at the same ends, bit for bit."""
    misses = swap_misses([case])
    assert not misses, misses[0]


def test_swapped_ends_of_the_reference_lines():
    """The same for the reference lines without seabed: nearly vertical, folded, over-stretched, weightless."""
    misses = swap_misses([case for case, _ in span_references()])
    assert not misses, "\n".join(misses)


@MANY
@given(seabed_cases())
def test_swapped_ends_over_a_seabed(case):
    """With both ends above a frictionless seabed, anchor and fairlead can be swapped."""
    span = Span(**case.inputs())
    assume(span.friction == 0 and span.clearance > 0 and span.z + span.clearance > 1e-9 * span.L)
    state = solve_span(span)
    other = solve_span(replace(span, z=-span.z, clearance=span.z + span.clearance))
    # the sum z + clearance is rounded, which may count more than the inputs: the heights are given to eps L
    limits = ROUNDINGS * (1 + kappa(span, state)) * (1 + span.L / (span.z + span.clearance))
    assert_same_force((other.H, -other.V_anchor), (state.H, state.V), limits)
    assert abs(other.grounded_length - state.grounded_length) <= limits * EPS * (span.L + state.tension / span.w)


@MANY
@given(suspended_cases(buoyant=False))
def test_a_buoyant_line_is_the_mirror_image(case):
    """Weight and z negated, V is negated and H kept, bit for bit."""
    span = Span(**case.inputs())
    state, mirror = solve_span(span), solve_span(replace(span, w=-span.w, z=-span.z))
    assert (mirror.H, mirror.V, mirror.H_anchor, mirror.V_anchor) == (
        state.H,
        -state.V,
        state.H_anchor,
        -state.V_anchor,
    )
    assert np.array_equal(mirror.stiffness, state.stiffness * [[1, -1], [-1, 1]])
    s = span.L * np.array([0.0, 0.2, 0.7, 1.0])
    (x, z, T), (xm, zm, Tm) = state.profile(s), mirror.profile(s)
    for got, wanted in ((xm, x), (zm, -z), (Tm, T)):
        assert np.allclose(got, wanted, rtol=POSITION, atol=POSITION * span.L)


# ---------------------------------------------------------------- dimension analysis
POWERS_OF_TWO = st.integers(-40, 40).map(lambda exponent: 2.0**exponent)
FORCES = ("H", "V", "H_anchor", "V_anchor")


@MANY
@given(suspended_cases() | seabed_cases(), POWERS_OF_TWO)
def test_lengths_scale(case, factor):
    """All lengths times a power of two, w divided by it: the same forces, bit for bit, and stiffness over it."""
    span = Span(**case.inputs())
    larger = Span(
        span.w / factor,
        span.EA,
        span.L * factor,
        span.x * factor,
        span.z * factor,
        span.seabed,
        span.friction,
        span.clearance * factor,
    )
    a, b = solve_span(span), solve_span(larger)
    assert [getattr(b, name) for name in FORCES] == [getattr(a, name) for name in FORCES]
    assert b.grounded_length == factor * a.grounded_length
    assert np.array_equal(b.stiffness, a.stiffness / factor)


@MANY
@given(suspended_cases() | seabed_cases(), POWERS_OF_TWO)
def test_forces_scale(case, factor):
    """w and EA times a power of two: all forces and the stiffness times it, bit for bit."""
    span = Span(**case.inputs())
    a, b = solve_span(span), solve_span(replace(span, w=span.w * factor, EA=span.EA * factor))
    assert [getattr(b, name) for name in FORCES] == [factor * getattr(a, name) for name in FORCES]
    assert b.grounded_length == a.grounded_length
    assert np.array_equal(b.stiffness, factor * a.stiffness)


def test_condition_follows_from_the_stiffness():
    """The condition of the oracle, by differences, is that of dimension analysis on its stiffness."""
    compared = 0
    for case, truth in span_references():
        if case.friction or case.clearance:  # inputs of their own
            continue
        tension = math.hypot(truth.H, truth.V)
        if truth.H > 0.01 * tension and 10 < truth.condition < 1e100 and np.all(np.isfinite(truth.stiffness)):
            assert sensitivity(case, truth) / tension == pytest.approx(truth.condition, rel=DIGITS), case.name
            compared += 1
    assert compared > 100


# ---------------------------------------------------------------- rotation
@MANY
@given(st.floats(0.0, math.pi / 2), powers(-3, 3), powers(0, 6), st.floats(0.1, 3.0))
def test_a_weightless_line_can_be_turned(angle, L, EA, chord):
    """Without weight only the chord counts: tension along it, stiffness turned with it."""
    cos, sin = math.cos(angle), math.sin(angle)
    flat = solve_span(Span(0.0, EA, L, chord * L, 0.0, seabed=False))
    turned = solve_span(Span(0.0, EA, L, chord * L * cos, chord * L * sin, seabed=False))
    limits = 20 * (1 + EA / max(flat.H, EPS * EA))  # T = EA (chord/L - 1): the chord is rounded
    assert_same_force((turned.H, turned.V), (flat.H * cos, flat.H * sin), limits, EA * EPS + flat.H)
    if chord > 1.001:
        turn = np.array([[cos, -sin], [sin, cos]])
        wanted = turn @ flat.stiffness @ turn.T
        assert np.allclose(turned.stiffness, wanted, rtol=0, atol=1e3 * EPS * EA / L)


SCENE = """
[environment]
depth = 320.0
[line]
length = 902.2
EA = 384.243e6
submerged_weight = 698.094
friction = 0.001
[ends]
anchor = {anchor}
fairlead = {fairlead}
"""


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("angle", [0.3, 2.0, 4.5])
def test_a_scene_can_be_turned_about_the_vertical(tmp_path, angle, mirrored):
    """Anchor and fairlead turned or mirrored about the vertical: the same line, the same forces."""
    anchor, fairlead = (-853.87, 0.0, -320.0), (-5.2, 0.0, -70.0)
    cos, sin = math.cos(angle), math.sin(angle) * (-1 if mirrored else 1)
    forces = []
    for number, (c, s) in enumerate(((1.0, 0.0), (cos, sin))):
        ends = [[c * x - s * y, s * x + c * y, z] for x, y, z in (anchor, fairlead)]
        path = tmp_path / f"{number}.toml"
        path.write_text(SCENE.format(anchor=ends[0], fairlead=ends[1]))
        (span,) = Scene.load(path).spans()
        state = solve_span(span)
        forces.append((state.H, state.V))
    assert_same_force(*forces, ROUNDINGS * (1 + kappa(span)))


# ---------------------------------------------------------------- monotonicity
@pytest.mark.parametrize("span", [span for span in LINES if span.x > 0])
def test_pulling_further_pulls_harder(span):
    """H never falls while x grows, from slack to over-stretched, through every change of regime."""
    stretches = np.linspace(0.02, 2.0, 400)
    H = [solve_span(replace(span, x=float(stretch * span.L))).H for stretch in stretches]
    assert np.all(np.diff(H) >= 0)
    assert H[-1] > 0


# ---------------------------------------------------------------- along the line
@pytest.mark.parametrize("span", LINES)
def test_profile_ends_at_the_ends(span):
    """The profile starts at the anchor and ends at the fairlead, with the tension of each."""
    state = solve_span(span)
    x, z, T = state.profile([0.0, span.L])
    assert (x[0], z[0]) == (0.0, 0.0)
    assert (x[1], z[1]) == pytest.approx((span.x, span.z), abs=POSITION * span.L)
    scale = POSITION * (state.tension + abs(span.w) * span.L)
    assert T == pytest.approx([math.hypot(state.H_anchor, state.V_anchor), state.tension], abs=scale)


@pytest.mark.parametrize("span", LINES)
def test_profile_equals_the_50_digit_profile(span):
    """Position and tension at points inside the line are those of the oracle's quadrature."""
    state = solve_span(span)
    inputs = {name: getattr(span, name) for name in Span.__slots__}
    exact = catenary_mp.solve(**inputs, start=(state.H, state.V) if state.H else None)
    s = [part * span.L for part in (0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99)]
    wanted = np.array([[float(v) for v in catenary_mp.profile(point, **inputs, solution=exact)] for point in s])
    x, z, T = state.profile(s)
    for got, right, unit in ((x, wanted[:, 0], span.L), (z, wanted[:, 1], span.L), (T, wanted[:, 2], state.tension)):
        assert np.max(np.abs(got - right)) <= POSITION * (unit or abs(span.w) * span.L)


@pytest.mark.parametrize("span", [span for span in LINES if span.w != 0])  # a weightless line has one tension
def test_profile_keeps_the_balance_of_forces(span):
    """Off the seabed H is constant and V grows by w; on it the tension grows by CB w while there is any."""
    state = solve_span(span)
    lifted = -state.V_anchor / span.w if state.grounded_length else 0.0
    landed = lifted + state.grounded_length
    s = np.linspace(0, span.L, 41)
    _, _, T = state.profile(s)
    lies = (s >= lifted) & (s < landed)
    V = np.where(s >= landed, state.V - span.w * (span.L - s), state.V_anchor + span.w * s)
    drag = span.friction * span.w * (landed - s)
    wanted = np.where(lies, np.maximum(state.H - drag, 0.0), np.hypot(state.H, V))
    assert np.max(np.abs(T - wanted)) <= POSITION * (state.tension + abs(span.w) * span.L)


@pytest.mark.parametrize("span", TAUT)
def test_profile_follows_its_tension(span):
    """dx/ds = (H/T)(1 + T/EA) and dz/ds = (V/T)(1 + T/EA): the secant of the profile is the tangent at its middle."""
    state = solve_span(span)
    step = 1e-4 * span.L
    s = np.linspace(0.013, 0.987, 37) * span.L
    (xa, za, _), (xb, zb, _), (_, _, T) = state.profile(s - step), state.profile(s + step), state.profile(s)
    lies = np.abs((zb - za) / step) < 1e-12
    dx_ds, dz_ds = (xb - xa) / (2 * step), (zb - za) / (2 * step)
    H = np.where(lies, T, state.H)
    # the chord of an arc misses its tangent by (step w/H)^2/6 of its length: 1e-6 for the slackest of these lines
    bound = 1e-9 + (step * span.w / state.H) ** 2
    assert np.max(np.abs(dx_ds - H / np.where(T > 0, T, 1.0) * (1 + T / span.EA))[T > 0]) <= bound
    assert np.max(np.abs(np.hypot(dx_ds, dz_ds) - 1 - T / span.EA)) <= bound


@pytest.mark.parametrize("span", LINES)
def test_the_whole_line_is_in_equilibrium(span):
    """Weight of what hangs, friction on what lies, and the forces at the ends add to nothing."""
    state = solve_span(span)
    scale = state.tension + abs(span.w) * span.L
    assert abs(state.V - state.V_anchor - span.w * (span.L - state.grounded_length)) <= 100 * EPS * scale
    friction = min(span.friction * span.w * state.grounded_length, state.H)
    assert abs(state.H - state.H_anchor - friction) <= 100 * EPS * scale
    assert state.H >= state.H_anchor >= 0
    assert 0 <= state.grounded_length <= span.L


def test_oc3_line_touches_where_its_weight_ends():
    """The OC3 line hangs V/w metres of its length, rests with the remainder, and lies flat there."""
    state = solve_span(Span(**OC3))
    assert state.regime is Regime.GROUNDED
    _, z, _ = state.profile(np.linspace(0, state.grounded_length, 9))
    assert np.max(np.abs(z)) <= EPS * OC3["L"]
    assert state.grounded_length == pytest.approx(OC3["L"] - state.V / OC3["w"], rel=1e-13)
