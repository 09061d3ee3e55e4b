"""Do response curves pass through folds, find them where shooting does, and say where they end?"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest

from solvers import (
    BodyMotion,
    ConvergenceError,
    Environment,
    InputError,
    Motion,
    Scene,
    Status,
    mooring_system,
    solve_periodic,
)
from solvers.common.properties import CableProperties
from solvers.harmonic_balance.residual import HarmonicResidual
from solvers.stability import response_curve
from solvers.stability.curves.bordered import _solve_twice, factorise_bordered
from solvers.stability.curves.family import HarmonicFamily, build_family
from solvers.stability.multipliers.floquet import floquet

from ..cases.oscillators import MassChain, cubic_chain, duffing, harmonic_force, towed_chain
from ..exact.oscillators import duffing_bifurcations

FOLD = 1e-12  # of a fold in the parameter: its place along the curve is found to 1e-6 of a step, which enters squared
AMPLITUDE = 1e-8  # of a harmonic at a fold, into which that place enters as it is
ROUND_OFF = 1e-10  # of states of order one: the last Newton step is 1e-10 at most, and the next its square
SOLVED = 1e-9  # of the rows of a bordered system of order one, from a well-conditioned elimination
NEAR_ONE = 1e-6  # of a multiplier at a fold, the square root of the error of its place
STARTS = {0: ("1.27", "-0.14", "3.41"), 1: ("1.116", "-1.02", "0.41")}
"""Frequency in rad/s and state of a fold to three digits, from which the oracle starts."""


def resonance(omega):
    """Duffing's oscillator with two folds: damping 0.05, stiffness 1 and 0.1, force 0.18."""
    return duffing(omega, 0.18, c=0.05, k3=0.1)


@cache
def resonance_curve(start=0.8, stop=1.6, harmonics=15, max_step=0.1):
    return response_curve(parameter=resonance, start=start, stop=stop, harmonics=harmonics, max_step=max_step)


# ---------------------------------------------------------------- folds
@pytest.mark.parametrize("which", STARTS)
def test_folds_are_those_of_shooting(which, deep):
    """Frequency and first harmonic of a fold, of both in the long version, against shooting in 15 digits."""
    if which and not deep:
        pytest.skip("in the long version")
    fold = resonance_curve().folds[which]
    omega, amplitude = duffing_bifurcations.fold(duffing_bifurcations.Oscillator(), *STARTS[which], digits=15)
    assert fold.value == pytest.approx(float(omega), rel=FOLD)
    assert np.hypot(*fold.z[0, 0, 1:3]) == pytest.approx(float(amplitude), rel=AMPLITUDE)


def test_digits_of_the_oracle_agree(deep):
    """The series of 15 and of 25 digits give one fold to 15 digits: neither order nor steps are left in it."""
    if not deep:
        pytest.skip("in the long version")
    oscillator = duffing_bifurcations.Oscillator()
    coarse, fine = (duffing_bifurcations.fold(oscillator, *STARTS[0], digits=digits) for digits in (15, 25))
    assert all(abs(a - b) < 1e-15 for a, b in zip(coarse, fine, strict=True))
    with pytest.raises(ValueError, match="no fold near"):
        duffing_bifurcations.fold(duffing_bifurcations.Oscillator(b="0"), "0.5", "0", "0", digits=15)


@pytest.mark.parametrize("options", [{"start": 1.6, "stop": 0.8}, {"max_step": 0.03}, {"harmonics": 12}])
def test_folds_do_not_depend_on_the_way(options):
    """From the other end, in shorter steps, and with as many harmonics as it takes: the same folds."""
    folds, others = (
        sorted(fold.value for fold in curve.folds) for curve in (resonance_curve(), resonance_curve(**options))
    )
    assert others == pytest.approx(folds, rel=FOLD)


def test_stability_changes_at_folds():
    """Between its folds the curve turns back and is unstable, elsewhere stable; at a fold a multiplier is one."""
    curve = resonance_curve()
    assert len(curve.folds) == 2 and (curve.tangents < 0).sum() > 5
    for i in range(0, len(curve.values), 3):
        assert floquet(curve.response(i), method="monodromy").stable == (curve.tangents[i] > 0)
    for fold in curve.folds:
        assert abs(floquet(curve.response(fold)).multipliers - 1).min() <= NEAR_ONE
        assert (curve.tangents[fold.after] > 0) != (curve.tangents[fold.after + 1] > 0)


# ---------------------------------------------------------------- points
def test_linear_oscillators_follow_their_transfer_function():
    """Amplitudes at every point, ends exactly at the range, outputs over the period; no folds, and no jump."""
    F, c = 0.3, 0.1
    curve = response_curve(parameter=lambda w: duffing(w, F, c=c, k3=0.0), start=0.5, stop=2.0, harmonics=2)
    exact = F / abs(1 - curve.values**2 + 1j * c * curve.values)
    assert (curve.values[0], curve.values[-1]) == (0.5, 2.0) and not curve.folds
    assert abs(curve.harmonic(1) - exact).max() <= ROUND_OFF
    assert abs(curve.omega - curve.values).max() <= ROUND_OFF
    assert curve.greatest[:, 0] == pytest.approx(exact, rel=1 - math.cos(math.pi / 32))  # 32 instants in a period
    assert curve.least[:, 3] == pytest.approx(-exact, rel=1 - math.cos(math.pi / 32))
    assert abs(np.diff(curve.harmonic(1))).max() < 0.15 * exact.max()


def test_each_point_is_a_response():
    """Newton's method from a point of the curve stays there, on the unstable part as well."""
    curve = resonance_curve()
    for i in range(0, len(curve.values), 10):
        response = curve.response(i)
        again = solve_periodic(response.system, harmonics=15, start=response, symmetry=False)
        assert abs(again.z - response.z).max() <= ROUND_OFF
    assert curve.residual_norm <= ROUND_OFF


LINE = Scene(
    "OC3", CableProperties(EA=384.243e6, diameter=0.09, mass_per_length=77.7066, Cdn=1.6), 902.2,
    (0.0, 0.0, -320.0), (848.67, 0.0, -70.0), motion=Motion.harmonic(0.05, (3.0, 0.0, 0.0)))  # fmt: skip
MILLIMETRE = 1e-3  # m, of a line: 1e-4 of its motion, far below what a wrong frequency or amplitude would make


@pytest.mark.parametrize(
    ("parameter", "start", "stop"), [("frequency", 0.05, 0.04), ("amplitude", 1.0, 0.6), ("amplitude", 0.0, 0.6)]
)
def test_a_line_ends_where_it_is_solved_directly(parameter, start, stop):
    """Frequency and amplitude of a line of nodes and elements: the last response is that of ``solve_periodic``.

    At an amplitude of zero the response is rounding errors alone, and these must not set the scale of the curve.
    """
    line = mooring_system(LINE, cells=10)
    output = lambda response: response.fairlead_tension(response.time)
    curve = response_curve(line, parameter=parameter, start=start, stop=stop, harmonics=3, output=output)
    motion = replace(LINE.motion, frequency=stop) if parameter == "frequency" else LINE.motion.scaled(stop)
    direct = solve_periodic(line.with_motion(motion), harmonics=3)  # on the same mesh
    assert abs(curve.z[-1] - direct.z).max() <= MILLIMETRE
    assert curve.greatest[-1] == pytest.approx(output(direct).max(), rel=1e-6)
    assert curve.response(-1).tension_harmonics(1) == pytest.approx(direct.tension_harmonics(1), rel=1e-6)


def test_a_line_is_followed_through_kinks():
    """Where cells go slack between two samples or not, the curve has a kink that no shorter step takes away."""
    line = mooring_system(LINE, cells=10, motion=Motion.harmonic(0.05, (5.0, 0.0, 0.0)))
    curve = response_curve(line, start=0.02, stop=0.1, harmonics=5)
    tensions = curve.response(-1).tension_harmonics(1)
    direct = solve_periodic(curve.response(-1).system, harmonics=5, start=curve.response(-1))
    assert curve.values[-1] == 0.1 and tensions == pytest.approx(direct.tension_harmonics(1), rel=1e-6)


# ---------------------------------------------------------------- the bordered system
@pytest.mark.parametrize("system", [duffing(0.7, 0.3), cubic_chain(3), towed_chain(4)], ids=["mass", "chain", "towed"])
@pytest.mark.parametrize("factorise", [factorise_bordered, _solve_twice], ids=["extended", "twice"])
def test_the_bordered_solution_meets_every_row(system, factorise):
    """J dx + column dp = F and row dx + corner dp = g for numbers drawn at random, by both eliminations."""
    rng = np.random.default_rng(3)
    family = HarmonicFamily(lambda _: system, 4, 16, 1)
    residual = family.rows(1.0)
    assert isinstance(residual, HarmonicResidual)
    shape = residual.rest.shape[1], residual.n
    x, row, column = (
        rng.normal(size=shape),
        rng.normal(size=shape),
        rng.normal(size=residual.rest.size * residual.n // 3),
    )
    F, solve = factorise(residual, x, column, row, 0.7)
    assert abs(F - residual.residual(x)).max() == 0.0
    right, g = rng.normal(size=F.size), 1.3
    dx, dp = solve(right, g)
    rows, state = residual.rows(x, True)
    left = residual.product(rows, residual.slope(state), dx) + column * dp
    assert abs(left - right).max() <= SOLVED and abs(np.vdot(row, dx) + 0.7 * dp - g) <= SOLVED


def test_the_extended_chain_solves_at_a_fold():
    """There J is singular and only the border makes the matrix regular: the tangent has no part in the parameter."""
    curve = resonance_curve()
    fold = curve.folds[0]
    rows = curve.family.rows(fold.value)
    x = rows.pack(fold.z)
    column = curve.family.derivative(x, fold.value, 1.0)
    row = np.random.default_rng(4).normal(size=x.shape)
    t, u = factorise_bordered(rows, x, column, row, 0.0)[1](np.zeros(column.size), 1.0)
    assert abs(u) <= NEAR_ONE * abs(t).max()
    tangents, state = rows.rows(x, True)
    assert abs(rows.product(tangents, rows.slope(state), t) + column * u).max() <= SOLVED * abs(t).max()


@pytest.mark.parametrize("parameter", ["amplitude", resonance], ids=["amplitude", "function"])
def test_derivatives_by_the_parameter(parameter):
    """By central differences of the rows: of an amplitude its force, of a frequency as a wider difference has it."""
    build = build_family(resonance(1.1) if parameter == "amplitude" else None, parameter)
    family = HarmonicFamily(build, 3, 12, 1)
    x = np.random.default_rng(5).normal(size=(1, 21))
    rows = lambda value: family.rows(value).residual(x)
    exact = (8 * (rows(1.01) - rows(0.99)) - (rows(1.02) - rows(0.98))) / 0.12
    assert family.derivative(x, 1.0, 1.0) == pytest.approx(exact, rel=1e-7, abs=1e-7)


# ---------------------------------------------------------------- where a curve ends
@dataclass(frozen=True, eq=False)
class Limited(MassChain):
    """A mass whose equations end at a place."""

    limit: float = 1.0

    def invalid(self, y):
        """Return a status where the mass is beyond its limit."""
        return (Status.OVERSTRETCHED, 0) if abs(y[0]).max() > self.limit else None


def limited(omega, limit):
    return Limited(
        "limited", 2 * math.pi / omega, harmonic_force(0.18, omega), 1, 1.0, 0.05, 0.0, 1.0, 0.0, 0.1, limit=limit
    )


@pytest.mark.parametrize(
    ("build", "options", "status", "end"),
    [
        (lambda w: limited(w, 1.0), {}, Status.CURVE_STEP_TOO_SHORT, "stretched beyond 30 %"),
        (lambda w: limited(w, 0.1), {}, Status.NO_PERIODIC_RESPONSE, "stretched beyond 30 %"),
        (resonance, {"max_points": 7}, Status.CURVE_TOO_LONG, "7 points"),
    ],
    ids=["limit", "start", "points"],
)
def test_a_curve_says_where_it_ends(build, options, status, end):
    """Equations that end, no response at the start, too many points: a status, with all points before it."""
    options = {"parameter": build, "start": 0.8, "stop": 1.6, "harmonics": 5} | options
    curve = response_curve(throw=False, **options)
    assert curve.status is status and end in curve.end
    with pytest.raises(ConvergenceError, match=r"no response at the start|the last one at"):
        response_curve(**options)
    if status is Status.CURVE_STEP_TOO_SHORT:
        assert 0.999 < curve.greatest[-1, 0] <= 1.0
    assert len(curve.values) == {Status.NO_PERIODIC_RESPONSE: 0, Status.CURVE_TOO_LONG: 7}.get(
        status, len(curve.values)
    )


@pytest.mark.parametrize(("damping", "contact_depth"), [(0.0, 0.0), (1e3, 0.0), (1e3, 0.14)])
def test_a_seabed_whose_force_jumps_ends_the_curve(damping, contact_depth):
    """With damping that acts at once the rows lose their zero as nodes touch down: the status names it.

    Without damping, or where it grows from contact on, there is no end.
    """
    chain = replace(LINE.cable, submerged_weight=698.094, damping=0.05)
    sea = Environment(depth=60.0, seabed_stiffness=5e3, seabed_damping=damping)
    surge = Motion.harmonic(1 / 12, (2.0, 0.0, 0.0))
    scene = Scene("chain", chain, 665.0, (-655.2, 0.0, -60.0), (-5.2, 0.0, -10.0), sea, motion=surge)
    made = mooring_system(scene, cells=12, contact_depth=contact_depth)
    curve = response_curve(made, start=0.03, stop=0.1, harmonics=5, throw=False)
    if damping and not contact_depth:
        assert curve.status is Status.CURVE_STEP_TOO_SHORT and "a contact_depth" in curve.status.value
        assert 0.03 < curve.values[-1] < 0.1
    else:
        assert curve.success and curve.values[-1] == 0.1


def test_a_parameter_that_leaves_its_physical_range_ends_the_curve():
    """What the system refuses is the end, with the reason of the system."""

    def build(k):
        if k < 0.5:
            raise InputError(f"{k:g} N/m must be at least 0.5", field="k", value=k, unit="N/m")
        return duffing(1.1, 0.18, c=0.3, k=k)

    curve = response_curve(parameter=build, start=1.0, stop=0.2, harmonics=5, throw=False)
    assert curve.status is Status.CURVE_LEFT_RANGE and "k: " in curve.end
    assert 0.5 <= curve.values[-1] < 0.51


def test_a_curve_that_comes_back_to_its_start_says_so():
    """From the upper response between the folds: up to one, and back through the start on the part between them."""
    whole = resonance_curve()
    before = int(np.flatnonzero(whole.values > 1.2)[0])
    at = float(whole.values[before])
    assert before < whole.folds[0].after
    options = {"parameter": resonance, "start": at, "stop": 1.6, "harmonics": 15, "first": whole.response(before)}
    curve = response_curve(throw=False, **options)
    assert curve.status is Status.CURVE_RETURNED and len(curve.folds) == 1
    assert curve.values[-1] == at and abs(curve.harmonic(1)[-1] - curve.harmonic(1)[0]) > 0.1
    assert curve.folds[0].value == pytest.approx(whole.folds[0].value, rel=FOLD)


def test_progress_is_told_after_each_point():
    """Number of the point, value, share of the range that is left."""
    calls = []
    curve = response_curve(
        parameter=resonance, start=0.8, stop=0.9, harmonics=3, progress=lambda *call: calls.append(call)
    )
    assert [number for number, *_ in calls] == list(range(1, len(curve.values) + 1))
    assert [value for _, value, _ in calls] == list(curve.values)
    assert calls[0][2] == 1.0 and calls[-1][2] == 0.0


def motionless():
    """A line whose motion displaces nothing in any of six directions."""
    return mooring_system(LINE, cells=4, motion=BodyMotion.harmonic(0.05, (0.0,) * 6))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"system": resonance(1.0)}, "system: give either"),
        ({"parameter": "amplitude"}, "system: give either"),
        ({"parameter": "damping", "system": resonance(1.0)}, "parameter: 'damping' must be 'frequency' or 'amplitude'"),
        ({"parameter": "frequency", "system": resonance(1.0)}, "parameter: 'frequency' takes a system that a Motion"),
        ({"parameter": "frequency", "system": motionless()}, "motion: its amplitude is 0 m .* give it one"),
        ({"parameter": "amplitude", "system": motionless()}, "motion: its amplitude is 0 m .* give it one"),
        ({"stop": 0.8}, "stop: 0.8 .* must differ from start"),
        ({"stop": math.inf}, "stop: inf"),
        ({"harmonics": 0}, "harmonics: 0 must be a whole number"),
        ({"samples": 10}, "samples: 10 must be a whole number"),
        ({"step": 1.0}, "step: 1 must lie between"),
        ({"min_step": 0.0}, "min_step: 0 .* must be > 0"),
        ({"max_points": 0}, "max_points: 0"),
        ({"throw": "no"}, "throw: 'no'"),
    ],
)
def test_inputs_are_checked(changes, message):
    """Before any work, each by its name."""
    options = {"parameter": resonance, "start": 0.8, "stop": 1.6, "harmonics": 5} | changes
    with pytest.raises(InputError, match=message):
        response_curve(**options)


# ---------------------------------------------------------------- the line of OC3
REFERENCE = 5e-3  # of the greatest tension: 20 cells, 5 harmonics in 5 m of surge, against 80 and 15; measured 2.3e-3


def test_the_oc3_line_in_surge_over_its_band(deep):
    """From 0.02 to 0.1 Hz: no fold, tensions that rise, the greatest as a direct solve on a finer mesh has it."""
    motion = Motion.harmonic(0.05, (5.0, 0.0, 0.0))
    line = mooring_system(LINE, cells=20, motion=motion)
    output = lambda response: response.fairlead_tension(response.time)
    curve = response_curve(line, start=0.02, stop=0.1, harmonics=5, output=output)
    assert not curve.folds and (np.diff(curve.greatest[:, 0]) > 0).all() and (curve.tangents > 0).all()
    within = curve.values < 0.06  # where no cell is slack
    indices = np.flatnonzero(within)[:: 1 if deep else 4]
    assert all(floquet(curve.response(i)).stable for i in indices)
    i = indices[-1]
    fine = mooring_system(LINE, cells=80, motion=replace(motion, frequency=float(curve.values[i])))
    direct = solve_periodic(fine, harmonics=15)
    assert curve.greatest[i, 0] == pytest.approx(output(direct).max(), rel=REFERENCE)
