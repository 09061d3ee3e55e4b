"""Do response curves agree with closed forms and published cases: feedback, contact, coexisting responses?"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.special import mathieu_a, mathieu_b

from solvers import InputError, Status, response_curve, solve_periodic
from solvers.stability.curves.special_points import BRANCH_POINT, PERIOD_DOUBLING
from solvers.stability.multipliers.floquet import floquet

from ..cases.planar_systems import forced_oscillator, lure, mathieu, unilateral_spring
from ..exact.oscillators import lure as exact_lure
from ..exact.oscillators import piecewise_linear as exact
from ..exact.oscillators.duffing_bifurcations import Oscillator, bifurcation

PLACE = 1e-8  # of a special point, over the range: what shooting is met to
KINKED = (
    1e-3  # of a motion with contact by 30 or 40 harmonics, over the distance of multipliers from one; measured 5e-4
)
KINKED_MULTIPLIER = 2e-2  # of its multipliers: the time at which contact begins is known less well than the motion
BALANCED = 1e-12  # of a motion without contact: round-off
ONE_HARMONIC = 5e-3  # of an amplitude of 0.36 at most, of one harmonic alone, which the published curve is
BESIDE_FOLD = (
    0.03  # of a multiplier from one: nearer to a fold the amplitude at one frequency has the root of the error
)


# ---------------------------------------------------------------- feedback
@cache
def lure_curve():
    """From alpha = 0.716 on, in cycles of 0.99 rad/s, down to 0.98 rad/s."""
    z = np.zeros((4, 1, 41))
    z[0, 0, [0, 2]], z[1, 0, 1], z[2, 0, 2], z[3, 0, 0] = (0.21, 0.5), -0.5, -0.5, 0.716 * np.sqrt(2)
    return response_curve(parameter=lure, start=0.99, stop=0.98, harmonics=20, first=z, stability=True)


def test_the_period_doubling_of_lures_system():
    """Its place in alpha and in frequency, against series and shooting; no other special point."""
    curve = lure_curve()
    (point,) = curve.special
    assert point.kind == PERIOD_DOUBLING
    response = curve.response(point)
    t = np.linspace(0, 2 * np.pi / point.value, 2001)
    x, _, z, alpha = response.at(t)[:, 0, np.argmax(response.at(t)[0, 0])]
    start = (repr(float(v)) for v in (x, z, t[-1], alpha))
    expected, omega = exact_lure.doubling(*start, digits=12)
    assert point.z[3, 0, 0] / np.sqrt(2) == pytest.approx(float(expected), abs=PLACE)
    assert point.value == pytest.approx(float(omega), abs=PLACE * 0.01)
    assert float(expected) == pytest.approx(0.6303020, abs=1e-7)


# ---------------------------------------------------------------- parametric excitation
@pytest.mark.parametrize(
    ("start", "stop", "order", "kind"), [(0.3, 1.8, 1, PERIOD_DOUBLING), (3.6, 4.6, 2, BRANCH_POINT)]
)
def test_mathieu_transition_curves_are_special_points_of_rest(start, stop, order, kind):
    """Rest loses its stability between b_n(q) and a_n(q), doubled in period or not, without damping."""
    curve = response_curve(parameter=lambda a: mathieu(a, 0.5), start=start, stop=stop, harmonics=12, stability=True)
    assert [point.kind for point in curve.special] == [kind] * 2
    expected = float(mathieu_b(order, 0.5)), float(mathieu_a(order, 0.5))
    assert [point.value for point in curve.special] == pytest.approx(expected, abs=PLACE * (stop - start))


# ---------------------------------------------------------------- coexisting responses
DAMPED = Oscillator(c="0", b="1", P="0.01", e="0.1")


def damped_by_amplitude(omega):
    """Duffing's resonator with damping 0.1 x^2 x' and force 0.01, of HarmonicBalance.jl (SciPost Codebases 6, 2022)."""
    return forced_oscillator(omega, 0.01, e=0.1, b=1.0)


def test_three_responses_of_duffings_resonator_of_which_two_are_stable(deep):
    """Between its folds, which are those of shooting; outside of them one response, which is stable.

    The upper fold by default, both in the long version.
    """
    curve = response_curve(parameter=damped_by_amplitude, start=0.9, stop=1.2, harmonics=9, stability=True)
    upper, lower = curve.special
    for fold in (upper, lower) if deep else (upper,):
        x, v = (repr(float(value)) for value in curve.response(fold).at([0.0])[:, 0, 0])
        omega, amplitude, *_ = bifurcation(DAMPED, "fold", "omega", f"{fold.value:.6f}", x, v, 12)
        assert fold.value == pytest.approx(float(omega), abs=PLACE * 0.3)
        assert np.hypot(*fold.z[0, 0, 1:3]) == pytest.approx(float(amplitude), rel=1e-6)
    for omega, states in ((1.1, [True, False, True]), (1.0, [True]), (1.19, [True])):
        crossings = np.flatnonzero(np.diff(np.sign(curve.values - omega)))
        assert [bool(curve.stable[i]) for i in crossings] == states
    for i in range(0, len(curve.values), 10):  # one harmonic alone: a cubic for the square s of the amplitude
        if abs(curve.multipliers[i] - 1).min() > BESIDE_FOLD:
            d = 1 - curve.values[i] ** 2
            roots = np.roots([0.5625 + (0.025 * curve.values[i]) ** 2, 1.5 * d, d * d, -1e-4])
            assert abs(np.sqrt(roots.astype(complex)) - np.hypot(*curve.z[i, 0, 0, 1:3])).min() <= ONE_HARMONIC


# ---------------------------------------------------------------- contact
CHAIN = {
    "mass": np.eye(2), "stiffness": np.array([[1.0, -1.0], [-1.0, 2.0]]), "force": np.array([0.0, 0.1]),
    "contact": 100.0, "gap": 1.0, "damping": 0.03 * np.array([[1.0, -1.0], [-1.0, 2.0]])}  # fmt: skip
"""Example 3 of NLvib (M. Krack and J. Gross, Harmonic Balance for Nonlinear Vibration Problems, 2019).

Its amplitude is the first harmonic of the second mass. In closed form that is 0.936306 at most, at 0.7512 rad/s; the
lowest place of the mass is -0.980205, at 0.7529 rad/s. The peak of 0.98093 at 0.7541 rad/s that is reported is neither.
"""
RESONANCE_OF_CHAIN = 0.9363, 0.7512  # largest first harmonic of the second mass, at rad/s
READ = 5e-5  # of the digits of both
SINGLE = {
    "mass": np.eye(1), "stiffness": np.eye(1), "force": np.array([0.3]), "contact": 2.0, "gap": 0.5,
    "damping": 0.1 * np.eye(1)}  # fmt: skip


@cache
def orbits_of_the_chain():
    """Closed orbits of the chain from 0.6 to 0.754 rad/s, each from the last."""
    system = unilateral_spring(0.5, **CHAIN)
    start = solve_periodic(system, harmonics=5).at([0.0])[:, 0, 0]
    curve = response_curve(parameter=lambda w: unilateral_spring(w, **CHAIN), start=0.5, stop=0.63, harmonics=15,
                           samples=256)  # fmt: skip
    start, orbits = curve.response(-1).at([0.0])[:, 0, 0], {}
    for sequence in (np.arange(0.63, 0.7541, 0.001), np.arange(0.63, 0.5999, -0.001)):
        y = start
        for omega in sequence:
            orbits[round(float(omega), 3)] = closed = exact.orbit(exact.Masses(**CHAIN), float(omega), y)
            y = closed.start
    return orbits


def test_the_published_bifurcations_of_a_chain_at_a_stop():
    """Stable at 0.635 rad/s, past a Neimark-Sacker bifurcation at 0.6, past a period doubling at the resonance."""
    orbits, masses = orbits_of_the_chain(), exact.Masses(**CHAIN)
    assert abs(orbits[0.635].multipliers).max() < 1
    assert abs(orbits[0.6].multipliers[0]) > 1 and abs(orbits[0.6].multipliers[0].imag) > 0.1
    assert orbits[0.75].multipliers[0] == pytest.approx(orbits[0.75].multipliers[0].real) and (
        orbits[0.75].multipliers[0].real < -1
    )
    torus, closed = exact.bifurcation(masses, exact.growth_of_pair, (0.63, 0.615), orbits[0.63].start)
    doubling, _ = exact.bifurcation(masses, exact.doubling, (0.735, 0.742), orbits[0.735].start)
    assert torus == pytest.approx(0.618606874, abs=1e-8) and doubling == pytest.approx(0.738783025, abs=1e-8)
    damping = np.exp(-np.trace(CHAIN["damping"]) * 2 * np.pi / closed.omega)
    assert np.prod(closed.multipliers).real == pytest.approx(damping, rel=BALANCED * 100)  # Liouville's formula


def test_the_resonance_of_a_chain_at_a_stop():
    """The largest first harmonic of the second mass and its frequency, by a polynomial through the closed form."""
    y, omegas = orbits_of_the_chain()[0.75].start, np.arange(0.7495, 0.7531, 0.0004)
    amplitudes = []
    for omega in omegas:
        closed = exact.orbit(exact.Masses(**CHAIN), float(omega), y)
        y = closed.start
        amplitudes.append(closed.amplitude(1))
    fitted = np.polynomial.Polynomial.fit(omegas, amplitudes, 5)
    fine = np.linspace(omegas[0], omegas[-1], 10001)
    peak = fine[fitted(fine).argmax()]
    assert (fitted(peak), peak) == pytest.approx(RESONANCE_OF_CHAIN, abs=READ)


def test_harmonics_converge_to_the_closed_form_over_a_stop():
    """The chain in contact at 0.635 rad/s: its motion by 10, 20 and 40 harmonics, and its multipliers."""
    closed, errors = orbits_of_the_chain()[0.635], []
    guess = None
    for harmonics in (10, 20, 40):
        system = unilateral_spring(0.635, **CHAIN)
        if guess is None:
            curve = response_curve(parameter=lambda w: unilateral_spring(w, **CHAIN), start=0.5, stop=0.635,
                                   harmonics=harmonics, samples=256)  # fmt: skip
            guess = curve.response(-1)
        guess = solve_periodic(system, harmonics=harmonics, samples=1024, start=guess, symmetry=False)
        errors.append(abs(np.hypot(*guess.z[1, 0, 1:3]) - closed.amplitude(1)))
    assert errors[2] < errors[1] < errors[0] and errors[2] <= KINKED
    multipliers = floquet(guess, method="monodromy", steps=1000).multipliers
    assert abs(abs(multipliers) - abs(closed.multipliers)).max() <= KINKED_MULTIPLIER


def test_an_oscillator_over_a_stop():
    """One mass, a stop of twice its stiffness: every response and its stability against pieces in closed form."""
    curve = response_curve(parameter=lambda w: unilateral_spring(w, **SINGLE), start=0.6, stop=1.8, harmonics=30,
                           samples=256, stability=True)  # fmt: skip
    masses, seen = exact.Masses(**SINGLE), set()
    for i in range(0, len(curve.values), 3):
        closed = exact.orbit(masses, curve.values[i], curve.response(i).at([0.0])[:, 0, 0])
        touches = len(closed.pieces) > 1
        error = abs(np.hypot(*curve.z[i, 0, 0, 1:3]) - closed.amplitude(0)) * abs(closed.multipliers - 1).min()
        assert error <= (KINKED if touches else BALANCED), (curve.values[i], error)
        is_stable = abs(closed.multipliers).max() < 1
        assert curve.stable[i] == is_stable
        assert abs(np.sort(abs(curve.multipliers[i])) - np.sort(abs(closed.multipliers))).max() <= KINKED_MULTIPLIER
        seen.add((touches, bool(is_stable)))
    assert {(False, True), (True, True)} <= seen


# ---------------------------------------------------------------- where curves end
def resonance(omega):
    """Duffing's oscillator with two folds."""
    return forced_oscillator(omega, 0.18, c=0.05, b=0.1)


RESONANCE = {"parameter": resonance, "start": 0.8, "harmonics": 15, "throw": False}


def test_a_fold_at_the_stop_ends_the_curve():
    """The range ends where the curve turns back: a status, with the last good point before it."""
    fold = response_curve(**RESONANCE, stop=1.6).folds[0]
    curve = response_curve(**RESONANCE, stop=fold.value)
    assert curve.status is Status.CURVE_FOLD_AT_STOP
    assert 0.9 * fold.value < curve.values[-1] < fold.value and (curve.tangents > 0).all()


def test_a_start_at_a_fold_is_singular():
    """There the curve has no direction in the parameter: a status, and no point."""
    whole = response_curve(**RESONANCE, stop=1.6)
    fold = whole.folds[0]
    start = fold.value - 1e-10  # beyond the fold there is no response, and at it Newton's method may go there
    basis = whole.family.basis(resonance(start))
    curve = response_curve(
        **RESONANCE | {"start": start, "first": replace(whole.response(fold), basis=basis)}, stop=1.6
    )
    assert curve.status is Status.CURVE_SINGULAR_START and len(curve.values) == 0


def test_a_parameter_out_of_its_range_at_the_start_is_refused():
    """Before any work, as the system says it."""

    def build(omega):
        raise InputError("must be at least 1", field="omega", value=omega)

    with pytest.raises(InputError, match="omega: must be at least 1"):
        response_curve(**RESONANCE | {"parameter": build}, stop=1.6)
