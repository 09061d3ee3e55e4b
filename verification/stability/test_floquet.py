"""Are Floquet multipliers right? Closed forms, transition curves, Liouville's formula, both methods alike."""

from __future__ import annotations

import math
import sys
from importlib.resources import files

import numpy as np
import pytest
from scipy.special import mathieu_a, mathieu_b

from solvers import InputError, Scene, cable_system, solve_periodic
from solvers.stability.curves.curve import as_response
from solvers.stability.curves.family import HarmonicFamily
from solvers.stability.multipliers.floquet import MAX_UNKNOWNS, FloquetResult, floquet
from solvers.stability.multipliers.monodromy import monodromy

from ..cases import planar_systems as cases
from ..cases.oscillators import cubic_chain, duffing, towed_chain
from ..exact.oscillators import multipliers as exact
from ..tools.orders import assert_order

SCENE = files("reference_data") / "scenes" / "dynamics" / "hb_case_1.toml"

CLOSED_FORM = 1e-10  # of matrices of order one: 200 to 400 steps of fifth order leave 2e-11 of each wave of a period
SMOOTH = 1e-8  # of smooth responses with 15 harmonics and 200 steps, which leave 1e-9
DEFECTIVE = 1e-6  # a double multiplier with one mode moves by the root of what rounding changes
WITH_FEW = 1e-4  # what three harmonics are seen to lose at least
ZERO = 1e-12  # a multiplier of an algebraic row


def response_of(system, z=None, harmonics=15):
    """The response with coefficients z, or rest."""
    z = np.zeros((len(system.fields), system.nodes, 2 * harmonics + 1)) if z is None else z
    return as_response(HarmonicFamily(lambda _: system, harmonics, 4 * harmonics, 1), 1.0, z)


# ---------------------------------------------------------------- closed forms
@pytest.mark.parametrize("damping", [0.0, 0.1])
@pytest.mark.parametrize(("k", "change"), [(0.3, 0.1), (0.25, 0.2), (1.0, 0.3), (1.3, 0.5), (0.1, 0.4)])
def test_meissner_in_closed_form(k, change, damping):
    """The monodromy matrix of a stiffness with jumps, stable and unstable, and which of the two it is."""
    response = response_of(cases.meissner(k, change, damping))
    expected = exact.meissner(k, change, damping)
    assert abs(monodromy(response, 200) - expected).max() <= CLOSED_FORM * abs(expected).max()
    if damping:
        is_stable = abs(np.linalg.eigvals(expected)).max() < 1
        assert floquet(response, method="monodromy").stable == is_stable


def test_meissner_is_of_fifth_order():
    """Steps that end at the jumps: the error of Radau IIA falls with the fifth power of the step."""
    response, expected = response_of(cases.meissner(1.3, 0.5)), exact.meissner(1.3, 0.5)
    steps = [16, 32, 64]
    errors = [abs(monodromy(response, count) - expected).max() for count in steps]
    assert_order([1 / count for count in steps], errors, 5.0, ceiling=1e-5)


@pytest.mark.parametrize(
    ("characteristic", "order", "q"),
    [
        (mathieu_a, 0, 1.5),
        *((function, n, q) for function in (mathieu_a, mathieu_b) for n, q in ((1, 0.5), (2, 2.0), (3, 1.0))),
    ],
)
def test_mathieu_on_its_transition_curves(characteristic, order, q):
    """Where Mathieu functions are periodic the multipliers are both 1 or both -1, by both methods."""
    response = response_of(cases.mathieu(characteristic(order, q), q))
    trace = 2.0 if order % 2 == 0 else -2.0
    assert np.trace(monodromy(response, 400)) == pytest.approx(trace, abs=CLOSED_FORM)
    result = floquet(response, method="hill")
    assert result.multipliers.size == 2
    assert abs(result.multipliers - trace / 2).max() <= DEFECTIVE


def test_mathieu_beside_a_transition_curve():
    """On one side of the first tongue rest is stable, on the other it grows with a negative multiplier."""
    inside, outside = (floquet(response_of(cases.mathieu(a, 0.5, 0.01))) for a in (1.0, 2.0))
    assert not inside.stable and inside.multipliers[0].real < -1
    assert outside.stable
    assert max(inside.difference, outside.difference) <= SMOOTH


def test_stuart_landau_in_closed_form():
    """Along the cycle one, across it exp(-2 growth T), by both methods."""
    growth, omega = 0.09, 1.7
    z = np.zeros((2, 1, 31))
    z[0, 0, 2], z[1, 0, 1] = math.sqrt(growth), math.sqrt(growth)  # cosine and sine
    result = floquet(response_of(cases.stuart_landau(growth, omega), z))
    for multipliers in (result.multipliers, result.hill):
        assert abs(multipliers - exact.stuart_landau(growth, omega)).max() <= CLOSED_FORM
    assert result.exponents.real == pytest.approx([0.0, -2 * growth], abs=CLOSED_FORM)


# ---------------------------------------------------------------- nonlinear chains
def test_liouville_and_two_methods_on_a_nonlinear_orbit():
    """The product of the multipliers is exp(-c T); both methods agree, and do not with too few harmonics."""
    system = duffing(1.2, 0.18, c=0.05, k3=0.1)
    result = floquet(solve_periodic(system, harmonics=15))
    assert np.prod(result.multipliers).real == pytest.approx(math.exp(-0.05 * system.period), abs=SMOOTH)
    assert result.difference <= SMOOTH
    hard = duffing(0.7, 3.0, c=0.1)
    assert floquet(solve_periodic(hard, harmonics=25), steps=400).difference <= SMOOTH
    assert floquet(solve_periodic(hard, harmonics=3)).difference > WITH_FEW


def test_a_mode_faster_than_every_harmonic_is_found():
    """A linear oscillator driven at a fiftieth of its frequency, with three harmonics: exp(lambda T), both ways."""
    system = duffing(0.02, 0.3, c=0.01, k3=0.0)
    result = floquet(solve_periodic(system, harmonics=3), steps=8000)
    expected = np.exp(np.roots([1.0, 0.01, 1.0]) * system.period)
    for multipliers in (result.multipliers, result.hill):
        assert abs(np.sort_complex(multipliers) - np.sort_complex(expected)).max() <= SMOOTH


def test_too_few_steps_are_seen_in_the_difference():
    """Ten steps in the period: the difference of the two methods is that of the time integration."""
    response = solve_periodic(duffing(1.2, 0.18, c=0.05, k3=0.1), harmonics=15)
    assert floquet(response, steps=10).difference > 100 * floquet(response, steps=100).difference


def test_rows_that_prescribe_a_velocity_have_their_multiplier_taken_out():
    """A towed chain: one multiplier of one, of the place of the last mass, in the matrix and none in the result."""
    response = solve_periodic(towed_chain(3), harmonics=15)
    every = np.linalg.eigvals(monodromy(response, 200))
    result = floquet(response)
    assert abs(every - 1).min() <= CLOSED_FORM and result.constraints == 1
    assert abs(result.multipliers - 1).min() > 0.1 and result.multipliers.size == 4
    assert result.difference <= SMOOTH


def test_algebraic_rows_have_no_multipliers():
    """Three masses with springs: of nine fields six have multipliers, the others are zero."""
    response = solve_periodic(cubic_chain(3), harmonics=25)
    sizes = np.sort(abs(np.linalg.eigvals(monodromy(response, 200))))
    assert sizes[:3].max() <= ZERO and sizes[3] > 0.1
    result = floquet(response, steps=800)
    assert result.multipliers.size == 6 and result.difference <= SMOOTH


# ---------------------------------------------------------------- inputs
def test_inputs_are_checked():
    """Another method or scheme, no steps, a chain too long for dense matrices, the time steps of a chain."""
    response = solve_periodic(duffing(0.7, 0.3), harmonics=3)
    for options, message in (
        ({"method": "shooting"}, r"method.*'shooting'"),
        ({"method": "steps"}, r"method.*'steps'"),
        ({"scheme": "euler"}, r"scheme.*'euler'"),
        ({"steps": 0}, r"steps.*whole number"),
        ({"out_of_plane": 1}, r"out_of_plane.*True or False"),
        ({"least_size": 0.0}, r"least_size.*must be > 0"),
        ({"least_size": 1.5}, r"least_size.*1.5 must be < 1: multipliers that grow are always wanted"),
    ):
        with pytest.raises(InputError, match=message):
            floquet(response, **options)
    with pytest.raises(InputError, match=f"more than {MAX_UNKNOWNS}"):
        floquet(solve_periodic(cubic_chain(30), harmonics=3))


def test_infinite_exponents_of_algebraic_rows_are_left_out():
    """Of a cable with few harmonics five come out as large numbers: said, and the difference shows that few are few."""
    response = solve_periodic(cable_system(Scene.load(str(SCENE)), 12), harmonics=5)
    both, monodromy_alone, by_hill = (floquet(response, method=m, steps=60) for m in ("both", "monodromy", "hill"))
    assert both.warnings == by_hill.warnings and "5 exponents" in both.warnings[0]
    assert np.isfinite(by_hill.multipliers).all() and both.stable
    assert both.difference > WITH_FEW
    assert np.array_equal(both.multipliers, monodromy_alone.multipliers[: both.multipliers.size])


def test_exponents_of_algebraic_rows_are_left_out(monkeypatch):
    """Those of more than 50 times the frequency, whatever the frequency is, and it is said."""
    response = solve_periodic(duffing(1.2, 0.1), harmonics=3)
    exponents = 1.2 * np.array([49.0, 51.0, -60.0]) + 0j
    monkeypatch.setattr(sys.modules["solvers.stability.multipliers.floquet"], "hill_exponents", lambda _: exponents)
    assert floquet(response, method="monodromy", steps=1).multipliers.size == 3  # the fewest steps
    assert not FloquetResult(np.array([1.0, 0.5]), 1.0, 0).stable  # what stays as it is does not decay
    result = floquet(response, method="hill")
    assert np.log(result.multipliers.real) == pytest.approx([2 * np.pi * 49, -2 * np.pi * 60], rel=1e-12)
    assert len(result.warnings) == 1 and result.warnings[0].startswith("1 exponents of Hill's problem are too large")
