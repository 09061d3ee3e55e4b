"""Does each regime end where the next one begins, and does an extreme input tend to the simpler model?"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from solvers import Regime, Span, Status, solve_span

from ..cases.spans import NAMED, OC3
from ..reference import EPS
from .test_exact import sensitivity

CLOSE = 1e-9  # relative distance to a limit that is stated per case; rounding is eps kappa, below it
NUDGE = 1e-9  # relative step across a boundary: forces change by kappa times it
CONTINUITY = 20 * NUDGE  # in units of 1 + kappa: a jump of the size of anything physical is 1e6 times larger
TOUCHING = Span(1.0, 100.0, 1.0, 0.5, 0.4)


def force(span: Span) -> np.ndarray:
    """Return (H, V) at the fairlead, N."""
    state = solve_span(span)
    return np.array([state.H, state.V])


# ---------------------------------------------------------------- extreme inputs
@pytest.mark.parametrize("EA", [1e15, 1e30, 1e100, 1e200, 1e300])
def test_a_stiff_line_tends_to_the_inextensible_one(EA):
    """EA up to 1e300 N: the catenary of parameter 10 m, V at a level anchor, w = 2 N/m, ends at x = 10 arsinh 1."""
    # L = a sinh(x/a), z = a (cosh(x/a) - 1) with a = 10 m; H = w a = 20 N, V = w L = 20 N
    span = Span(2.0, EA, 10.0, 10 * math.asinh(1.0), 10 * (math.sqrt(2) - 1), seabed=False)
    # H/EA is the stretch that is left; the rest is rounding
    assert force(span) == pytest.approx([20.0, 20.0], rel=200 * (EPS + 20.0 / EA))


@pytest.mark.parametrize("EA", [1e20, 1e100, 1e300])
def test_an_inextensible_grounded_line(EA):
    """EA up to 1e300 N with contact: H = w (s^2 - z^2)/(2 z) for a hanging length s, independently of friction."""
    # a = 10 m: s = 10 m hangs up to z = 10 (sqrt 2 - 1), 5 m rest
    span = Span(2.0, EA, 15.0, 5 + 10 * math.asinh(1.0), 10 * (math.sqrt(2) - 1))
    for friction in (0.0, 1e-3, 1.0, 1e3):
        assert force(replace(span, friction=friction)) == pytest.approx([20.0, 20.0], rel=1000 * EPS)


def test_large_friction_holds_the_anchor():
    """friction -> infinity: no tension reaches the anchor, and the line behaves as if fixed at its touchdown."""
    span = Span(**OC3, friction=1e3)
    forces = [force(replace(span, friction=10.0**n)) for n in (3, 6, 9, 12)]
    assert solve_span(span).H_anchor == 0
    gaps = [math.dist(f, forces[-1]) for f in forces[:-1]]
    assert gaps[0] > gaps[1] > gaps[2]
    assert gaps[1] == pytest.approx(gaps[0] / 1000, rel=1e-2)  # the stretched length is H/(CB w)
    hanging = Span(OC3["w"], OC3["EA"], forces[-1][1] / OC3["w"], *hanging_ends(forces[-1]))
    assert force(hanging) == pytest.approx(forces[-1], rel=CLOSE)


def hanging_ends(F):
    """Return (x, z) of the hanging part of the OC3 line when everything else stays where it lies, m."""
    return OC3["x"] - (OC3["L"] - F[1] / OC3["w"]), OC3["z"]


def test_friction_is_continuous_at_zero():
    """friction -> 0 tends to the frictionless line, linearly."""
    smooth = force(Span(**OC3))
    gaps = [math.dist(force(Span(**OC3, friction=CB)), smooth) for CB in (1e-4, 1e-6, 1e-8)]
    assert gaps[0] == pytest.approx(100 * gaps[1], rel=1e-3)
    assert gaps[2] <= CLOSE * math.hypot(*smooth)


@pytest.mark.parametrize("case", [case for case in NAMED if case.seabed and not case.friction], ids=lambda c: c.name)
def test_clearance_is_continuous_at_zero(case):
    """clearance -> 0 tends to the line anchored on the seabed."""
    span = Span(**case.inputs())
    on_seabed = solve_span(span)
    raised = solve_span(replace(span, clearance=1e-14 * span.L))
    # the anchor end leaves like sqrt(2 H c): its length and weight, 1e-7 of the line's, is what remains
    leaves = math.sqrt(2e-14 * span.L * (1 + on_seabed.H / span.w / span.L) * span.L) / span.L
    kappa = 1 + sensitivity(span, on_seabed) / on_seabed.tension
    gap = math.dist((raised.H, raised.V), (on_seabed.H, on_seabed.V))
    assert gap <= 10 * kappa * leaves * on_seabed.tension
    assert raised.H_anchor == raised.H


def test_a_high_anchor_makes_the_seabed_irrelevant():
    """With enough clearance the line never touches: bit for bit the line without seabed."""
    for x, z in ((60.0, 20.0), (99.0, -30.0), (120.0, 10.0)):
        free = solve_span(Span(30.0, 1e6, 100.0, x, z, seabed=False))
        deep = solve_span(Span(30.0, 1e6, 100.0, x, z, clearance=200.0))
        assert (deep.H, deep.V, deep.V_anchor) == (free.H, free.V, free.V_anchor)


def test_length_equal_to_the_chord():
    """L -> chord from both sides: H and V are continuous, and at L = chord T^3 = EA (w chord cos)^2/24."""
    for EA in (1e3, 1e6, 1e9):
        span = Span(1.0, EA, 5.0, 3.0, 4.0, seabed=False)
        here = solve_span(span)
        kappa = 1 + sensitivity(span, here) / here.tension
        for L in (5.0 * (1 - NUDGE), 5.0 * (1 + NUDGE)):
            assert math.dist(force(replace(span, L=L)), (here.H, here.V)) <= CONTINUITY * kappa * here.tension
    # a shallow parabola: sag stretch w^2 x^2 L/(24 H^2) equals elastic stretch T/EA, up to (wL/T)^2
    mean = math.hypot(here.H, (here.V + here.V_anchor) / 2)
    assert mean == pytest.approx((1e9 * 3.0**2 / 24) ** (1 / 3), rel=1e-3)


@pytest.mark.parametrize(("x", "z"), [(9.0, 6.0), (6.0, 9.0), (12.0, 0.0), (0.0, 11.0)])
def test_a_light_line_tends_to_the_spring(x, z):
    """w -> 0 tends to the straight spring EA (chord/L - 1), in force and stiffness."""
    spring = solve_span(Span(0.0, 1e3, 10.0, x, z, seabed=False))
    for w in (1e-8, 1e-30, 1e-100, 1e-200, 1e-300):
        light = solve_span(Span(w, 1e3, 10.0, x, z, seabed=False))
        # half the weight of the line is the difference of V at the two ends
        bound = 10 * w + 100 * EPS * spring.tension
        assert math.dist((light.H, light.V), (spring.H, spring.V)) <= bound
        assert np.max(np.abs(light.stiffness - spring.stiffness)) <= 10 * bound


def test_a_light_slack_line_pulls_in_proportion_to_its_weight():
    """w -> 0 with L > chord tends to no force, in proportion to w; the shape does not change."""
    heavy = force(Span(1.0, 1e300, 10.0, 5.0, 3.0, seabed=False))
    for w in (1e-3, 1e-30, 1e-100):
        assert force(Span(w, 1e300 * w, 10.0, 5.0, 3.0, seabed=False)) == pytest.approx(w * heavy, rel=1000 * EPS)


# ---------------------------------------------------------------- boundaries between regimes
def boundary_of(span: Span, field: str, low: float, high: float) -> float:
    """Return the value of ``field`` in (low, high) where the regime changes, by bisection to the last bit."""
    first = solve_span(replace(span, **{field: low})).regime
    assert solve_span(replace(span, **{field: high})).regime is not first
    while True:
        middle = 0.5 * (low + high)
        if not low < middle < high:
            return high
        if solve_span(replace(span, **{field: middle})).regime is first:
            low = middle
        else:
            high = middle


BOUNDARIES = {
    "touchdown, V = wL": (TOUCHING, "x", 0.85, 1.2, Regime.GROUNDED, Regime.SUSPENDED),
    "touchdown, with friction": (replace(TOUCHING, friction=1.0), "x", 0.85, 1.2, Regime.GROUNDED, Regime.SUSPENDED),
    "touchdown, over-stretched and soft": (
        Span(1.0, 2.0, 1.0, 2.0, 0.4, friction=0.1),
        "z",
        0.1,
        3.0,
        Regime.GROUNDED,
        Regime.SUSPENDED,
    ),
    "touchdown, raised anchor": (replace(TOUCHING, clearance=0.1), "x", 0.5, 0.9, Regime.SAGGING, Regime.SUSPENDED),
    "slack line": (TOUCHING, "x", 0.3, 0.8, Regime.SLACK, Regime.GROUNDED),
    "slack line, soft": (Span(1.0, 1.0, 1.0, 0.5, 0.4), "x", 0.3, 0.9, Regime.SLACK, Regime.GROUNDED),
    "slack line, raised anchor": (replace(TOUCHING, clearance=0.1), "x", 0.2, 0.7, Regime.SLACK, Regime.SAGGING),
    "steep, h = 1 + e/2": (
        Span(1.0, 10.0, 1.0, 0.3, 1.0, seabed=False),
        "z",
        1.0,
        1.2,
        Regime.SUSPENDED,
        Regime.STEEP,
    ),
    "steep, downwards": (
        Span(1.0, 10.0, 1.0, 0.3, -1.0, seabed=False),
        "z",
        -1.0,
        -1.2,
        Regime.SUSPENDED,
        Regime.STEEP,
    ),
    "steep, nearly inextensible": (
        Span(1.0, 1e6, 1.0, 1e-3, 1.0, seabed=False),
        "z",
        0.9999,
        1.1,
        Regime.SUSPENDED,
        Regime.STEEP,
    ),
}


@pytest.mark.parametrize("name", BOUNDARIES)
def test_forces_are_continuous_across_a_boundary(name):
    """A nudge of 1e-9 across the boundary of two regimes changes H and V by no more than their condition times it."""
    span, field, low, high, before, after = BOUNDARIES[name]
    value = (
        boundary_of(span, field, min(low, high), max(low, high))
        if low < high
        else -boundary_of(replace(span, z=-span.z, w=-span.w), field, -low, -high)
    )
    sides = [solve_span(replace(span, **{field: value * (1 + sign * NUDGE)})) for sign in (-1, 1)]
    assert [state.regime for state in sides] == [before, after]
    kappa = 1 + max(sensitivity(state.span, state) / state.tension for state in sides)
    gap = math.dist((sides[0].H, sides[0].V), (sides[1].H, sides[1].V))
    assert gap <= CONTINUITY * kappa * sides[0].tension, f"jump of {gap / sides[0].tension:.3g} T, kappa {kappa:.3g}"
    assert sides[1].H_anchor == pytest.approx(sides[0].H_anchor, abs=CONTINUITY * kappa * sides[0].tension)


def test_touchdown_has_the_weight_of_the_line():
    """At the touchdown boundary the fairlead carries V = w L and nothing lies."""
    x = boundary_of(TOUCHING, "x", 0.85, 1.2)
    state = solve_span(replace(TOUCHING, x=x))
    kappa = 1 + sensitivity(state.span, state) / state.tension
    assert state.V == pytest.approx(1.0, rel=100 * EPS * kappa)
    assert state.V_anchor == pytest.approx(0.0, abs=100 * EPS * kappa)


def test_slack_boundary_is_where_length_and_reach_agree():
    """The line goes slack at x = L - s_h with s_h + w s_h^2/(2 EA) = z."""
    x = boundary_of(TOUCHING, "x", 0.3, 0.8)
    s = (math.sqrt(1 + 2 * 0.4 / 100) - 1) * 100
    assert x == pytest.approx(1 - s, rel=1000 * EPS)  # s from a difference of 1e2 and 1e2 s


def test_friction_is_continuous_where_tension_leaves_the_anchor():
    """x0 = 0, H = CB w L_B: force, anchor force and stiffness are continuous."""
    span = Span(1.0, 50.0, 1.0, 0.95, 0.2)

    def excess(CB):
        state = solve_span(replace(span, friction=CB))
        return state.H - CB * state.grounded_length

    low, high = 0.01, 100.0
    for _ in range(100):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if excess(middle) > 0 else (low, middle)
    fixed, pulled = (solve_span(replace(span, friction=low * (1 + sign * NUDGE))) for sign in (1, -1))
    assert fixed.H_anchor == 0 < pulled.H_anchor
    assert (fixed.H, fixed.V) == pytest.approx((pulled.H, pulled.V), rel=1e-7)
    assert np.allclose(fixed.stiffness, pulled.stiffness, rtol=1e-6)


@pytest.mark.parametrize("friction", [0.0, 0.3, 50.0])
def test_lifting_a_lying_line(friction):
    """z -> 0 on the seabed tends to the lying line; V leaves like a square root, which is why K22 is infinite."""
    lying = solve_span(Span(1.0, 100.0, 1.0, 1.02, 0.0, friction=friction))
    assert lying.regime is Regime.LYING
    for z in (1e-6, 1e-9, 1e-12):
        state = solve_span(Span(1.0, 100.0, 1.0, 1.02, z, friction=friction))
        assert state.regime is Regime.GROUNDED
        rise = math.sqrt(2 * lying.H * z / (1 + lying.H / 100.0))  # (2.23b) for V << H
        assert state.V == pytest.approx(rise, rel=10 * math.sqrt(z) * (1 + friction))
        # no friction acts on the lifted length V/w: H changes by about CB V
        assert state.H == pytest.approx(lying.H, abs=2 * friction * rise + 100 * z + 100 * EPS * lying.H)


@pytest.mark.parametrize(("z", "seabed"), [(0.6, False), (-0.6, False), (1.3, False), (-1.3, False), (1.3, True)])
def test_a_narrow_line_tends_to_the_vertical_one(z, seabed):
    """x -> 0 tends to the vertical line: H -> K11 x and V -> V."""
    vertical = solve_span(Span(1.0, 10.0, 1.0, 0.0, z, seabed=seabed))
    assert vertical.regime is Regime.VERTICAL
    for x in (1e-4, 1e-8, 1e-16, 1e-100):
        state = solve_span(Span(1.0, 10.0, 1.0, x, z, seabed=seabed))
        assert state.V == pytest.approx(vertical.V, abs=20 * x + 100 * EPS)
        if abs(z) > 1.05:  # taut: a pendulum; folded: H falls faster than x
            assert state.H == pytest.approx(vertical.stiffness[0, 0] * x, rel=10 * x + 100 * EPS)
        else:
            assert 0 <= state.H < x


@pytest.mark.parametrize("seabed", [True, False])
@pytest.mark.parametrize("x", [0.0, 0.5, 0.999, 1.0, 1.3])
def test_negative_zero_is_zero(x, seabed):
    """z = -0.0 and x = -0.0 give what 0.0 gives."""
    a, b = (solve_span(Span(1.0, 10.0, 1.0, sign * x if x == 0 else x, sign * 0.0, seabed)) for sign in (1, -1))
    assert (a.H, a.V, a.H_anchor, a.V_anchor) == (b.H, b.V, b.H_anchor, b.V_anchor)
    assert np.array_equal(a.stiffness, b.stiffness)
    assert a.regime is b.regime


def test_every_regime_is_reached():
    """The boundaries above join all regimes that a line can be in."""
    reached = {regime for *_, before, after in BOUNDARIES.values() for regime in (before, after)}
    reached |= {Regime.LYING, Regime.VERTICAL, Regime.MASSLESS}
    assert reached == set(Regime)


def test_forces_beyond_double_precision_are_a_status():
    """A force above 1e308 N ends in NOT_FINITE with NaN, not in infinity."""
    state = solve_span(Span(1.0, 1e308, 1.0, 1e10, 0.0), throw=False)
    assert state.status is Status.NOT_FINITE
    assert math.isnan(state.H)


def test_the_stiffest_line_is_solved():
    """EA/L up to and including 1e308 N/m; beyond it NOT_FINITE."""
    for EA, status in ((1e308, Status.SUCCESS), (1.1e308, Status.NOT_FINITE)):
        assert solve_span(Span(1.0, EA, 1.0, 0.5, 0.6), throw=False).status is status


def test_closed_forms_take_no_iteration():
    """Slack, lying, vertical and weightless lines: no iteration, and no residual is left."""
    lines = {
        Regime.SLACK: Span(1.0, 100.0, 1.0, 0.3, 0.5),
        Regime.LYING: Span(1.0, 100.0, 1.0, 1.02, 0.0),
        Regime.VERTICAL: Span(1.0, 10.0, 1.0, 0.0, 0.6, seabed=False),
        Regime.MASSLESS: Span(0.0, 10.0, 1.0, 1.0, 0.6, seabed=False),
    }
    for regime, span in lines.items():
        state = solve_span(span)
        assert (state.regime, state.iterations, state.residual_norm) == (regime, 0, 0.0)


@pytest.mark.parametrize("EA", [1e120, 1e200, 1e300])
@pytest.mark.parametrize(("x", "z"), [(1.2, 0.0), (0.9, 0.8), (0.6, 0.8), (0.0, 1.1), (1e-9, 1.3)])
def test_profile_of_an_enormously_stiff_line_is_the_chord(EA, x, z):
    """A line stiffer than 1e120 N, its ends at least its length apart, is straight: T = EA (chord/L - 1)."""
    state = solve_span(Span(1e-6, EA, 1.0, x, z, seabed=False))
    xs, zs, T = state.profile([0.0, 0.25, 1.0])
    size = 1e-12  # of the length: a dozen roundings of a profile that is exact to eps
    assert np.abs(xs - [0, 0.25 * x, x]).max() < size and np.abs(zs - [0, 0.25 * z, z]).max() < size
    stretch = math.hypot(x, z) - 1
    if stretch > 0.01:
        assert state.tension == pytest.approx(EA * stretch, rel=size) and np.ptp(T) <= size * state.tension
