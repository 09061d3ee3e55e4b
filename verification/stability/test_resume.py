"""Does a curve that ended early go on bit for bit, from memory and from a file, and meet an accuracy with harmonics?"""

from __future__ import annotations

from dataclasses import replace
from functools import cache, partial
from types import SimpleNamespace

import numpy as np
import pytest

from solvers import (
    BodyMotion,
    Environment,
    InputError,
    Motion,
    ResponseCurve,
    Scene,
    Status,
    mooring_system,
    response_curve,
    solve_time_domain,
)
from solvers.common.properties import CableProperties
from solvers.io import load_curve, save_curve
from solvers.stability import switch_branch
from solvers.stability.curves import special_points, switching
from solvers.stability.curves.adaptivity import more_harmonics, needed_harmonics
from solvers.stability.curves.continuation import CorrectionError, Point, Tracer, next_step
from solvers.stability.curves.family import HarmonicFamily
from solvers.stability.curves.special_points import DoublingTest, explain_doubt
from solvers.stability.multipliers.floquet import floquet

from ..cases.planar_systems import forced_oscillator

UNIT = 1e-12  # of the length of a tangent: round-off
ARRAYS = "values", "omega", "z", "greatest", "least", "tangents", "harmonics", "errors"
LINE = Scene(
    "OC3", CableProperties(EA=384.243e6, diameter=0.09, mass_per_length=77.7066, Cdn=1.6), 902.2,
    (0.0, 0.0, -320.0), (848.67, 0.0, -70.0), motion=Motion.harmonic(0.05, (3.0, 0.0, 0.0)))  # fmt: skip
TRUE_ERROR = 3.0  # of an estimate against the change to many harmonics: those left out decay by a third each step
PARTLY = 0.1  # of it: the estimate sees the next harmonics only


def resonance(omega):
    """Duffing's oscillator with two folds."""
    return forced_oscillator(omega, 0.18, c=0.05, b=0.1)


def interrupt_at(number):
    """Return a progress function that interrupts after a point."""

    def progress(count, *_):
        if count == number:
            raise KeyboardInterrupt

    return progress


RESONANCE = partial(response_curve, parameter=resonance, start=0.8, stop=1.6, harmonics=7, throw=False)
WAYS = {
    "resonance": RESONANCE,
    "stability": partial(RESONANCE, stability=True),
    "accuracy": partial(RESONANCE, accuracy=1e-7, harmonics=3),
    "line": partial(response_curve, mooring_system(LINE, cells=6), start=0.02, stop=0.05, harmonics=3, throw=False),
}


@cache
def whole(way):
    return WAYS[way]()


def assert_same(curve, other):
    """All numbers of two curves are the same to the last bit."""
    for name in ARRAYS:
        assert np.array_equal(getattr(curve, name), getattr(other, name)), name
    assert (curve.status, curve.iterations) == (other.status, other.iterations)
    assert len(curve.special) == len(other.special)
    for one, two in zip(curve.special, other.special, strict=True):
        assert (one.kind, one.value, one.after) == (two.kind, two.value, two.after) and np.array_equal(one.z, two.z)
    assert (curve.multipliers is None) == (other.multipliers is None)
    for one, two in zip(curve.multipliers or (), other.multipliers or (), strict=True):
        assert np.array_equal(one, two)


@pytest.mark.parametrize("way", WAYS)
def test_an_interrupted_curve_goes_on_bit_for_bit(way):
    """After KeyboardInterrupt, and after max_points: as if it had not ended."""
    first = WAYS[way](progress=interrupt_at(5))
    assert first.status is Status.CURVE_INTERRUPTED and len(first.values) == 5
    second = WAYS[way](max_points=11, resume=first)
    assert second.status is Status.CURVE_TOO_LONG and len(second.values) == 11
    assert_same(WAYS[way](resume=second), whole(way))


@pytest.mark.parametrize("way", ["stability", "accuracy", "line"])
def test_a_curve_goes_on_from_its_file(way, tmp_path):
    """What is saved is what is loaded, and goes on bit for bit."""
    first = WAYS[way](max_points=9)
    save_curve(first, tmp_path / "curve.npz")
    system, parameter = (mooring_system(LINE, cells=6), "frequency") if way == "line" else (None, resonance)
    loaded = load_curve(tmp_path / "curve.npz", system, parameter)
    assert_same(loaded, first)
    assert np.array_equal(loaded.response(-1).y, first.response(-1).y)
    assert_same(WAYS[way](resume=loaded), whole(way))


def test_what_is_interrupted_in_the_middle_of_a_point_is_not_half_there():
    """The interrupt comes out of the system itself, while Newton's method runs."""
    calls = []

    def build(omega):
        calls.append(omega)
        if len(calls) == 400:
            raise KeyboardInterrupt
        return resonance(omega)

    first = RESONANCE(parameter=build)
    assert first.status is Status.CURVE_INTERRUPTED and 1 < len(first.values) < len(whole("resonance").values)
    assert_same(RESONANCE(resume=first), whole("resonance"))


@pytest.mark.parametrize("factor", [3.0, 1000.0])
def test_a_start_that_is_no_response_is_solved_for(factor):
    """One from which Newton's method takes many steps, and one from which it has not come in those that it has."""
    curve = whole("resonance")
    given = curve.response(0)
    again = RESONANCE(first=replace(given, z=factor * given.z), max_points=1)
    assert abs(again.z[0] - curve.z[0]).max() <= UNIT


def test_a_curve_that_is_complete_does_not_go_on():
    """It is refused: nothing is left to do."""
    curve = whole("resonance")
    with pytest.raises(InputError, match="resume: has reached its end"):
        RESONANCE(resume=curve)


def test_inputs_of_files_and_of_what_goes_on_are_checked(tmp_path):
    """Another parameter, another start, no curve; a file that is none, or of another parameter."""
    first = RESONANCE(max_points=5)
    for changes in ({"start": 0.9}, {"stability": True}, {"resume": 3}):
        with pytest.raises(InputError, match="resume: "):
            RESONANCE(**{"resume": first} | changes)
    save_curve(first, tmp_path / "curve.npz")
    with pytest.raises(InputError, match="parameter: the file is over 'value'"):
        load_curve(tmp_path / "curve.npz", mooring_system(LINE, cells=6))
    np.savez(tmp_path / "other.npz", format=7)
    (tmp_path / "text.npz").write_text("no curve")
    for name in ("other.npz", "text.npz", "none.npz"):
        with pytest.raises(InputError, match="path: "):
            load_curve(tmp_path / name, None, resonance)
    with pytest.raises(InputError, match="curve: must be a ResponseCurve"):
        save_curve(3, tmp_path / "curve.npz")


# ---------------------------------------------------------------- harmonics
def test_errors_are_estimated_with_a_third_more_harmonics(monkeypatch):
    """And two at least; with as many samples for each of them."""
    asked, with_harmonics = set(), Tracer.with_harmonics
    monkeypatch.setattr(Tracer, "with_harmonics", lambda tracer, n: asked.add(n) or with_harmonics(tracer, n))
    RESONANCE(harmonics=3, max_points=2)
    RESONANCE(harmonics=9, max_points=2)
    assert asked == {5, 12}


def test_errors_are_those_against_many_harmonics():
    """The estimate of each point against the response with four times as many harmonics at the same parameter."""
    curve = RESONANCE(harmonics=3, max_points=30)
    assert (curve.errors > 0).all()
    for i in (5, 15, 25):
        size = np.sqrt((curve.z[: i + 1] ** 2).sum(axis=(2, 3)).max(axis=0))
        fine = RESONANCE(start=float(curve.values[i]), harmonics=12, first=curve.response(i), max_points=1)
        change = np.array(fine.z[0])
        change[..., : curve.z.shape[-1]] -= curve.z[i]
        true = (np.sqrt((change**2).sum(axis=(1, 2))) / size).max()
        assert PARTLY * true <= curve.errors[i] <= TRUE_ERROR * true


@pytest.mark.parametrize("accuracy", [1e-4, 1e-8])
def test_harmonics_follow_the_accuracy(accuracy):
    """Each point meets it; more harmonics for more digits, more at resonance than at the ends."""
    curve = RESONANCE(harmonics=2, accuracy=accuracy)
    assert curve.success and (curve.errors <= accuracy).all()
    at_resonance = int(np.argmax(curve.harmonic(1)))
    assert curve.harmonics[at_resonance] > max(curve.harmonics[0], curve.harmonics[-1])
    assert curve.values[0] == 0.8 and curve.values[-1] == 1.6
    fixed = RESONANCE(harmonics=int(curve.harmonics.max()))
    folds, exact = ([p.value for p in c.folds] for c in (curve, fixed))
    assert folds == pytest.approx(exact, abs=accuracy)
    assert curve.response(at_resonance).basis.harmonics == curve.harmonics[at_resonance]


def test_needed_harmonics_are_those_above_a_tenth_of_the_accuracy():
    """By hand: over the norm of their field, all that are left out together; one at least."""
    z, norms = np.zeros((2, 3, 9)), np.array([2.0, 0.5])[:, None, None]
    assert needed_harmonics(z, norms, 0.1) == 1
    z[0, 1, 1:3], z[1, 2, 4], z[1, 0, 7] = 2.0, 4e-4, 3e-4  # of harmonics 1, 2 and 4: together 1e-3 of the second field
    for accuracy, needed in ((0.0101, 1), (0.0099, 2), (0.0061, 2), (0.0059, 4)):
        assert needed_harmonics(z, norms, accuracy) == needed
    assert more_harmonics(3) == 5 and more_harmonics(9) == 12 and more_harmonics(10) == 14


def test_twice_the_period_takes_twice_of_all():
    """Harmonics, samples and multiples of the driving's period, from whichever multiple on."""
    doubled = HarmonicFamily(resonance, 3, 12, 3).doubled()
    assert (doubled.settings, doubled.subharmonic) == ((6, 24), 6)


def test_samples_stay_as_dense_as_they_are_given():
    """For each harmonic, from the fewest on: one more than twice as many."""
    family = HarmonicFamily(resonance, 3, 7, 1)
    assert [family.with_harmonics(n).settings for n in (2, 3, 6)] == [(2, 5), (3, 7), (6, 14)]
    curve = RESONANCE(harmonics=3, samples=7, max_points=2)
    assert curve.values.size == 2
    assert next(curve.describe()).startswith(f"2 points from 0.8 to {curve.values[1]:.6g} ")


def test_steps_follow_the_work_of_newtons_method():
    """Longer up to four Newton steps and no longer than allowed, the same after five, shorter from six on."""
    assert [next_step(0.1, n, 1.0) for n in (1, 4, 5, 6)] == pytest.approx([0.15, 0.15, 0.1, 0.07])
    assert next_step(0.1, 4, 0.12) == 0.12


def test_a_period_doubling_is_found_by_the_secant_method(monkeypatch):
    """Of a test function that is a line in two steps, without the multipliers' own, coarser place."""
    monkeypatch.setattr(special_points, "DoublingTest", lambda *_: lambda s: 3.0 * (s - 0.37))
    segment = SimpleNamespace(tracer=None, length=1.0, at=lambda s: f"at {s:.3f}")
    kind, s, point = special_points._locate_doubling(segment, 0.3, 0.5, 0)
    assert (kind, point) == ("period doubling", "at 0.370") and s == pytest.approx(0.37, abs=1e-12)


def test_an_end_that_takes_more_harmonics_stays_the_end():
    """The last point of long steps is solved with more harmonics at the stop itself, and not beside it."""
    curve = RESONANCE(stop=1.0, harmonics=2, accuracy=1e-6, step=0.1, max_step=0.5)
    assert curve.harmonics[-1] > curve.harmonics[-2] and curve.values[-1] == 1.0


def test_more_accuracy_takes_more_harmonics():
    """From four to eight digits, and no more of them than are allowed."""
    few, many = (RESONANCE(harmonics=2, accuracy=accuracy).harmonics.max() for accuracy in (1e-4, 1e-8))
    assert few < many
    limited = RESONANCE(harmonics=2, accuracy=1e-8, max_harmonics=4)
    assert limited.harmonics.max() == 4 and limited.errors.max() > 1e-8
    assert RESONANCE(max_harmonics=1, max_points=2).values.size == 2  # without an accuracy nobody asks for it
    with pytest.raises(InputError, match="max_harmonics: 2"):
        RESONANCE(harmonics=4, accuracy=1e-8, max_harmonics=2)
    with pytest.raises(InputError, match="accuracy: 0"):
        RESONANCE(accuracy=0.0)


def test_a_branch_of_a_curve_with_adapted_harmonics():
    """A special point has the harmonics of its own place, and a branch starts from them, towards the odd ones."""
    build = lambda P: forced_oscillator(0.85, P, c=0.1, a=-1.0)
    curve = response_curve(parameter=build, start=0.02, stop=0.12, harmonics=5, accuracy=1e-9, stability=True)
    doubling = curve.special[-1]
    _, response = switch_branch(curve, doubling)
    assert response.basis.harmonics == doubling.z.shape[-1] - 1 > 10
    tracer = Tracer(curve.family.with_harmonics(5), 0.1, 1e-10, doubling.value, curve.state.norms)
    test = DoublingTest(tracer, lambda _: Point(tracer.pack(doubling.z[..., :11]), doubling.value, None, None, 0))
    assert test(0.0) != 0
    z = test.tracer.unpack(test.direction[0])  # of twice the period: the mean, then sines and cosines of 1, 2, ...
    assert z[..., 1::4].any() and z[..., 2::4].any() and not z[..., 3::4].any() and not z[..., 0::4].any()


def test_the_direction_beside_a_special_point_is_that_between_its_neighbours():
    """Whatever harmonics each of them has, of lines with more nodes than coefficients, too."""
    few, many = np.ones((1, 9, 5)), np.full((1, 9, 7), 3.0)
    curve = SimpleNamespace(points=[SimpleNamespace(z=few, value=1.0), SimpleNamespace(z=many, value=2.0)])
    tracer = SimpleNamespace(pack=lambda z: z, product=lambda *_: 4.0)
    t, u = switching._tangent_beside(tracer, curve, SimpleNamespace(z=many, after=0))
    assert u == 0.5 and t[0, 8].tolist() == [1.0] * 5 + [1.5] * 2


def test_the_tangent_is_of_unit_length_in_the_weights_of_its_state():
    """Where the response still grows, too, and its weights with it: steps are as long as they are said to be."""
    for most in (5, 11, 20):
        curve = RESONANCE(max_points=most)
        state, family = curve.state, curve.family
        tracer = Tracer(family, 0.8, 1e-10, state.value, state.norms)
        assert tracer.product(state.t, state.u, state.t, state.u) == pytest.approx(1.0, abs=UNIT)
    for u in (0.0, np.inf, np.nan):  # as a singular matrix may have it
        with pytest.raises(CorrectionError, match="no tangent"):
            tracer._tangent(lambda *_, u=u: (0.0 * state.t, u), state.x, 1.0)


# ---------------------------------------------------------------- what a line adds: slack, and a third direction
NO_FOLD = 1e-2  # m, of motions swept up and down through a fold of the series, in 2.6 m: short waves that slack leaves
SWEPT = np.linspace(0.2298, 0.2308, 6)  # Hz, a sweep through it
PERIODS, STEPS = 20, 400


@cache
def slack_curve():
    """The line of OC3 in 2 m of surge up to where its cells go slack."""
    motion = Motion.harmonic(0.2, (2.0, 0.0, 0.0))
    return response_curve(mooring_system(LINE, cells=15, motion=motion), start=0.2, stop=0.26, harmonics=9,
                          max_points=20, stability=True, throw=False)  # fmt: skip


def swept(frequencies):
    """Displacements at the start of a period in m, one motion after the other from the last state."""
    state, places = None, []
    for frequency in frequencies:
        system = slack_curve().family.build(frequency)
        history = solve_time_domain(system, dt=system.period / STEPS, periods=PERIODS, every=STEPS, start=state)
        state = history.y[..., -1], history.ydot[..., -1]
        places.append(state[0])
    return np.array(places)


def test_a_fold_of_the_series_alone_is_not_a_special_point(tmp_path):
    """Nine harmonics of a slack line turn back at 0.2304 Hz; no multiplier is near one, and time steps go on."""
    curve = slack_curve()
    assert not curve.special and not curve.folds and len(curve.unresolved) == 1
    (fold,) = curve.unresolved
    assert fold.kind == "fold" and fold.value == pytest.approx(0.23045, abs=1e-4)
    assert "no multiplier" in fold.doubt and abs(fold.multipliers).max() < 0.6
    assert curve.tangents[fold.after] > 0 > curve.tangents[fold.after + 1]
    save_curve(curve, tmp_path / "curve.npz")
    again = load_curve(tmp_path / "curve.npz", curve.family.build(0.2))
    assert again.unresolved[0].doubt == fold.doubt
    assert all(np.array_equal(one, two) for one, two in zip(again.sideways, curve.sideways, strict=True))
    up, down = swept(SWEPT), swept(SWEPT[::-1])[::-1]  # a fold would keep one of them from a part of the band
    assert abs(up - down).max() <= NO_FOLD


def test_points_that_many_harmonics_would_change_are_unresolved():
    """A special point whose neighbours have an error above the bound, whatever its multipliers are."""
    ones = np.array([1.0 + 0j, 0.5])
    assert "0.06" in explain_doubt("period doubling", ones, 0.06) and explain_doubt("fold", ones, 0.04) == ""
    assert explain_doubt("fold", None, 0.04) == "" and "no multiplier" in explain_doubt("fold", ones / 2, 0.04)


def test_a_planar_response_that_grows_sideways_is_not_stable():
    """A taut cable whose end moves along it near twice its first sideways frequency, stable in its plane at least."""
    cable = CableProperties(EA=2e7, diameter=0.08, mass_per_length=2.5, Cdn=1.25)
    ends, along = ((0.0, 0.0, -120.0), (100.05, 0.0, -120.0)), Motion.harmonic(0.8, (0.003, 0.0, 0.0))
    scene = Scene("taut", cable, 100.0, *ends, Environment(rho=1.225), motion=along)
    system = mooring_system(scene, cells=6, fields="planar", mesh="uniform")
    curve = response_curve(system, start=0.80, stop=0.92, harmonics=3, stability=True)
    largest = np.array([abs(each).max() for each in curve.sideways])
    assert np.array_equal(curve.stable, curve.stable_in_plane & (largest < 1)) and curve.stable[0]
    (i, *_) = np.flatnonzero(curve.stable_in_plane & ~curve.stable)
    assert np.array_equal(curve.sideways[i], floquet(curve.response(i), method="monodromy").sideways)


# ---------------------------------------------------------------- frequency of a body
def test_the_frequency_of_a_body_that_carries_a_line():
    """Surge and pitch of a BodyMotion, one at twice the frequency of the other: both follow the parameter."""
    surge, pitch = Motion.harmonic(0.05, (2.0, 0.0, 0.0)), Motion.harmonic(0.1, (0.0, 0.01, 0.0))
    line = mooring_system(LINE, cells=6, motion=BodyMotion(surge, pitch, (848.67, 0.0, -50.0)))
    curve = response_curve(line, start=0.05, stop=0.04, harmonics=4)
    assert isinstance(curve, ResponseCurve) and curve.success
    moved = curve.response(-1).system.motion
    assert (moved.translation.frequency, moved.rotation.frequency) == (0.04, 0.08)
    assert curve.omega == pytest.approx(2 * np.pi * curve.values, rel=1e-15)
