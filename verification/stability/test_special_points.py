"""Are special points located where shooting in 12 digits has them, of the right kind, and do branches lead on?"""

from __future__ import annotations

from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

from solvers import (
    CableProperties,
    ConvergenceError,
    Environment,
    InputError,
    Motion,
    Scene,
    mooring_system,
    solve_periodic,
)
from solvers.stability import response_curve, switch_branch
from solvers.stability.curves import special_points
from solvers.stability.curves.continuation import Tracer
from solvers.stability.curves.special_points import (
    BRANCH_POINT,
    FOLD,
    JUMP,
    NEIMARK_SACKER,
    PERIOD_DOUBLING,
    BranchTest,
    CurveSegment,
    locate_special_points,
)
from solvers.stability.multipliers.floquet import floquet

from ..cases.planar_systems import forced_oscillator
from ..exact.oscillators.duffing_bifurcations import Oscillator, bifurcation

PLACE = 1e-8  # of the range: what the issue of special points asks for; measured below 1e-9 for all of these
MULTIPLIER = 1e-6  # of a multiplier on the circle: a place to 1e-9 and 200 time steps in a period
AMPLITUDE = 1e-6  # of the first harmonic at a special point, which changes as the place does, and faster at folds
SYMMETRIC = 1e-9  # of even harmonics where there are none: round-off beside a branch point
SIDEWAYS = 1e-9  # of a motion in its plane: round-off across it
SOLVED_LINE = 1e-7  # m, of coefficients of a line of 100 m, whose last Newton step is below 1e-10 in the mean
BY_ROOT = 1e-3  # of a branch: the parameter changes with the square of the step 0.01


def escape(P):
    """Helmholtz's oscillator, which escapes from its well after a cascade of period doublings."""
    return forced_oscillator(0.85, P, c=0.1, a=-1.0)


def hardening(P):
    """Duffing's oscillator, strongly driven, where the symmetry of its response breaks."""
    return forced_oscillator(1.0, P, c=0.2, b=1.0)


def entrained(omega):
    """Van der Pol's oscillator, entrained by its force near its own frequency only."""
    return forced_oscillator(omega, 0.5, c=-0.2, e=0.2)


SYSTEMS = {
    "escape": (escape, 0.02, 0.12, 20, Oscillator(c="0.1", b="0", a="-1", omega="0.85"), "P"),
    "hardening": (hardening, 0.5, 14.0, 30, Oscillator(c="0.2", b="1", omega="1"), "P"),
    "entrained": (entrained, 0.95, 1.4, 15, Oscillator(c="-0.2", e="0.2", b="0", P="0.5"), "omega"),
}
"""Name -> system over its parameter, start, stop, harmonics, and the oscillator of the oracle with its parameter."""

EXPECTED = {
    "escape": [
        ("fold", "0.0688", "0.356", "0.097"),
        ("fold", "0.0472", "0.289", "0.39"),
        ("period doubling", "0.1005", "-0.282", "0.429"),
    ],
    "hardening": [("symmetry breaking", "2.716", None, None), ("symmetry breaking", "10.987", None, None)],
    "entrained": [("Neimark-Sacker", "1.1545", None, None)],
}
"""Kind, value to four digits and start of the orbit of each special point; None: the start is that of the curve."""

KINDS = {"symmetry breaking": BRANCH_POINT, "Neimark-Sacker": NEIMARK_SACKER, "fold": FOLD}


@cache
def curve_of(name, **options):
    build, start, stop, harmonics, *_ = SYSTEMS[name]
    options = {"start": start, "stop": stop, "harmonics": harmonics, "stability": True} | options
    return response_curve(parameter=build, **options)


@pytest.mark.parametrize("name", SYSTEMS)
def test_special_points_are_those_of_shooting(name, deep):
    """Folds, a period doubling, a broken symmetry and a Neimark-Sacker bifurcation: all of them, no other, in place."""
    if name == "escape" and not deep:
        pytest.skip("in the long version")
    curve, (oscillator, parameter) = curve_of(name), SYSTEMS[name][4:]
    assert [p.kind for p in curve.special] == [KINDS.get(kind, kind) for kind, *_ in EXPECTED[name]]
    span = abs(curve.values[-1] - curve.values[0])
    for point, (kind, value, *start) in zip(curve.special, EXPECTED[name], strict=True):
        x, v = curve.response(point).at([0.0])[:, 0, 0] if start[0] is None else start
        exact, amplitude, trace, _ = bifurcation(oscillator, kind, parameter, value, repr(float(x)), repr(float(v)), 12)
        assert abs(point.value - float(exact)) <= PLACE * span, (kind, point.value, exact)
        assert np.hypot(*point.z[0, 0, 1:3]) == pytest.approx(float(amplitude), rel=AMPLITUDE)
        target = {"period doubling": -1.0, NEIMARK_SACKER: None}.get(kind, 1.0)
        if target is None:
            assert abs(abs(point.multipliers) - 1).max() <= MULTIPLIER
            assert point.multipliers.sum().real == pytest.approx(float(trace), abs=MULTIPLIER)
        else:
            assert abs(point.multipliers - target).min() <= MULTIPLIER


@pytest.mark.parametrize(("name", "max_step"), [("escape", 0.04), ("hardening", 0.04), ("entrained", 0.04)])
def test_special_points_do_not_depend_on_the_steps(name, max_step):
    """Shorter steps: the same points to the digits that are asked for."""
    curve, other = curve_of(name), curve_of(name, max_step=max_step)
    span = abs(curve.values[-1] - curve.values[0])
    assert len(other.values) > len(curve.values)
    assert [p.value for p in other.special] == pytest.approx([p.value for p in curve.special], abs=PLACE * span)


@pytest.mark.parametrize("name", SYSTEMS)
def test_stability_changes_where_special_points_are(name):
    """Each point knows its multipliers and whether it is stable, and between two of a kind a special point lies."""
    curve = curve_of(name)
    assert len(curve.multipliers) == len(curve.values) == len(curve.stable)
    for i in range(0, len(curve.values), 7):
        assert np.array_equal(curve.multipliers[i], floquet(curve.response(i), method="monodromy").multipliers)
    changes = set(np.flatnonzero(np.diff(curve.stable.astype(int))).tolist())
    assert changes == {point.after for point in curve.special}


def test_without_stability_only_folds_are_looked_for():
    """No multipliers, no other special points, the same folds."""
    curve, plain = curve_of("escape"), curve_of("escape", stability=False)
    assert plain.multipliers is None and plain.stable is None
    assert [p.value for p in plain.special] == [p.value for p in curve.folds] and len(plain.folds) == 2


# ---------------------------------------------------------------- branches
def test_a_doubled_branch_leads_to_the_next_doubling():
    """Past a period doubling the response has twice the period, is stable, and doubles again where shooting has it."""
    curve = curve_of("escape")
    value, response = switch_branch(curve, curve.special[-1])
    assert response.subharmonic == 2 and response.basis.harmonics == 40
    assert abs(response.z[0, 0, 1::4]).max() > 0.005  # harmonics that the response before has not
    doubled = response_curve(parameter=escape, start=value, stop=0.108, first=response, harmonics=40, subharmonic=2,
                             step=0.005, stability=True)  # fmt: skip
    (point,) = doubled.special
    assert point.kind == PERIOD_DOUBLING and doubled.stable[: point.after + 1].all() and not doubled.stable[-1]
    start = curve.special[-1].value
    assert abs(value - start) <= BY_ROOT * start and value > start
    again = response_curve(parameter=escape, start=value, stop=0.108, first=response, harmonics=50, subharmonic=2,
                           step=0.01, stability=True)  # fmt: skip
    assert again.special[0].value == pytest.approx(point.value, abs=PLACE * 0.1)


def test_both_sides_of_a_broken_symmetry():
    """From a branch point two branches leave, each the mirror image of the other, with even harmonics; both stable."""
    curve = curve_of("hardening")
    point = curve.special[1]
    assert abs(point.z[..., [0, 3, 4]]).max() <= SYMMETRIC
    (one, first), (other, second) = (switch_branch(curve, point, step) for step in (0.03, -0.03))
    assert one == pytest.approx(other, rel=PLACE) and first.z[0, 0, 0] * second.z[0, 0, 0] < 0
    assert abs(first.z[0, 0, 0]) > 0.01 and first.subharmonic == 1
    branch = response_curve(parameter=hardening, start=one, stop=10.0, first=first, harmonics=30, stability=True)
    assert branch.stable.all() and abs(branch.z[:, 0, 0, 0]).min() > 0.01


def test_branches_start_at_branch_points_only():
    """A fold, a number, and a step that leads nowhere."""
    curve = curve_of("escape")
    for point in (curve.folds[0], 3):
        with pytest.raises(InputError, match="point: must be a period doubling or a branch point"):
            switch_branch(curve, point)
    with pytest.raises(ConvergenceError, match="take another step than 100"):
        switch_branch(curve, curve.special[-1], 100.0)


# ---------------------------------------------------------------- what the search does between two points
def test_a_test_function_vanishes_at_branch_points_and_not_at_folds():
    """The bordered test function changes its sign across a broken symmetry; across a fold it does not."""
    for name, which, changes in (("hardening", 0, True), ("escape", 0, False)):
        curve = curve_of(name)
        point = curve.special[which]
        tracer, at = _tracer_and_points(curve)
        test = BranchTest(tracer, lambda i, at=at: at(i))
        values = test(point.after), test(point.after + 1)
        assert (values[0] * values[1] < 0) == changes


def _tracer_and_points(curve):
    """Return a Tracer and a function from numbers of points to Points with tangents along the curve."""
    tracer = Tracer(curve.family, abs(curve.values[-1] - curve.values[0]), 1e-10, curve.values[0], curve.state.norms)

    def at(i):
        point = tracer.correct(tracer.pack(curve.z[i]), curve.values[i], np.zeros_like(curve.state.x), 1.0, 1.0)
        sign = np.sign(curve.tangents[i])
        return point._replace(t=sign * point.t, u=sign * point.u)

    return tracer, at


def test_multipliers_that_stay_on_the_circle_pass_nothing():
    """Sizes that rounding alone moves over one are no bifurcation."""
    curve = curve_of("escape")
    tracer, at = _tracer_and_points(curve)
    segment = CurveSegment(tracer, at(3), at(4), lambda point: np.array([1 + 1e-9, 0.5]))
    segment.set_multipliers(np.array([1 - 1e-8, 0.5]), np.array([1 + 1e-8, 0.5]))
    assert locate_special_points(segment, True) == []


def test_a_jump_from_below_what_is_known_is_a_jump():
    """A multiplier that is too small to be listed where the step begins, then 0.5, jumps over the circle to 1.05."""
    curve = curve_of("escape")
    tracer, at = _tracer_and_points(curve)
    first, last = at(3), at(4)
    share = lambda point: (point.value - first.value) / (last.value - first.value)
    listed = lambda point: np.array([1.2, 0.5 if share(point) < 0.6 else 1.05][: 1 if share(point) < 0.3 else 2])
    segment = CurveSegment(tracer, first, last, listed)
    segment.set_multipliers(listed(first), listed(last))
    assert [kind for kind, *_ in locate_special_points(segment, True)] == [JUMP]


def _kinds_between(first, last, monkeypatch, listed=lambda values, s: values):
    """Return kinds of special points on a line from 0 to 1 on which multipliers change evenly."""
    tracer = SimpleNamespace(distance=lambda *_: 1.0, advance=lambda _, s: SimpleNamespace(u=1.0, s=s))
    monkeypatch.setattr(special_points, "_locate_branch_point", lambda *_: [])  # a fold
    monkeypatch.setattr(special_points, "_locate_doubling", lambda segment, low, *_: (PERIOD_DOUBLING, low, None))
    ends = [SimpleNamespace(u=1.0, s=s) for s in (0.0, 1.0)]
    between = lambda p: listed((1 - p.s) * np.array(first) + p.s * np.array(last), p.s)
    segment = CurveSegment(tracer, *ends, between)
    segment.set_multipliers(*map(between, ends))
    return [kind for kind, *_ in locate_special_points(segment, True)]


def test_multipliers_that_pass_in_one_step_are_each_a_special_point(monkeypatch):
    """A pair, a fold and a doubling: the pair is two of those that pass, the fold one, which is listed elsewhere."""
    pair = np.exp([1j, -1j])
    first, last = [*(0.9 * pair), 0.8, -0.7], [*(1.5 * pair), 1.3, -1.2]
    assert sorted(_kinds_between(first, last, monkeypatch)) == [NEIMARK_SACKER, PERIOD_DOUBLING]


@pytest.mark.parametrize("inwards", [False, True])
def test_a_jump_is_known_by_its_outer_side(inwards, monkeypatch):
    """A pair jumps from below what is listed to the outside, or back: one jump, whichever way the curve goes."""
    pair = np.exp([1j, -1j])
    jumped = lambda _, s: np.array([1.1 + 0j, *(1.05 * pair)][: 1 if (s > 0.55) == inwards else 3])
    assert _kinds_between(np.ones(1), np.ones(1), monkeypatch, jumped) == [JUMP]


# ---------------------------------------------------------------- a field that a curve leaves at rest
AIR = Environment(rho=1.225)
CABLE = CableProperties(EA=2e7, diameter=0.08, mass_per_length=2.5, Cdn=1.25)


def test_a_branch_leaves_the_plane_of_a_taut_cable():
    """Near its second frequency a taut cable whose end moves up and down starts to move sideways."""
    ends = (0.0, 0.0, -120.0), (100.05, 0.0, -120.0)
    scene = Scene("taut", CABLE, 100.0, *ends, AIR, motion=Motion.harmonic(0.89, (0.0, 0.0, 0.03)))
    system = mooring_system(scene, cells=6, fields="spatial", mesh="uniform")
    curve = response_curve(system, start=0.87, stop=1.0, harmonics=4, max_points=40, stability=True, throw=False)
    point = next(each for each in curve.special if each.kind == "branch point")
    assert abs(point.z[1]).max() <= SIDEWAYS * abs(point.z[2]).max()
    start = switch_branch(curve, point)
    assert abs(start.value - point.value) < 0.01 * point.value
    z = start.response.z
    assert 0.001 * abs(z[2]).max() < abs(z[1]).max() < abs(z[2]).max()  # a small step along it, and no more
    again = solve_periodic(start.response.system, harmonics=4, start=start.response, symmetry=False)
    assert abs(again.z - z).max() <= SOLVED_LINE
