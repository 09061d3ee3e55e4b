"""The dynamics benchmarks' own checks: are errors, orders, references and the peer measured rightly?"""

from __future__ import annotations

import json
import sys
import tomllib
from dataclasses import replace
from functools import partial
from importlib.resources import files

import numpy as np
import pytest

from solvers import Motion, solve_span
from solvers.common.motions.motion import Ramped
from solvers.harmonic_balance.solve import solve_periodic
from solvers.time_domain.solve import solve_time_domain
from verification import registry
from verification.registry import INSTANTS, extrapolated_time_domain, instants, last_period_tension

from .. import peers
from ..harmonic_balance import limits as harmonic_limits
from ..harmonic_balance import measure as harmonic_balance
from . import cases as dynamic_cases
from . import measure as cable_dynamics
from . import orders as dynamic_orders
from . import work_precision as dynamic_work
from .cases import Reference, rms, scene, system

PERIOD = 20.0
SINE = np.sin(2 * np.pi * instants(PERIOD) / PERIOD)


def reference(tension=SINE) -> Reference:
    return Reference(PERIOD, tension, 0.0)


# ---------------------------------------------------------------- beside others
def sets(name: str) -> dict:
    """source.toml of a set of reference_data."""
    return tomllib.loads((files("reference_data") / name / "source.toml").read_text(encoding="utf-8"))


def test_what_stands_beside_others_has_their_settings():
    """Cases of the constant term and sizes of chains are those of the sets whose values the page puts beside them."""
    about, named = sets("oc3_dynamics"), {key: name for key, name in harmonic_balance.CONSTANT.items() if name}
    for (case, Nh, Nt, mean), name in named.items():
        one, moved = about["sets"][name], scene(case).motion
        assert (one["nodes"], one["harmonics"], one["samples"], one["mean"]) == (dynamic_cases.NODES, Nh, Nt, mean)
        assert moved.sine[0, 0] == one.get("amplitude", about["line"]["amplitude"]), name
        assert (moved.frequency, scene(case).length) == (about["line"]["frequency"], about["line"]["length"])
    results = {name for name, one in about["sets"].items() if {"harmonics", "samples"} <= one.keys()}
    assert set(named.values()) == results
    sizes = {name: (one["masses"], one["harmonics"]) for name, one in sets("other_codes")["sets"].items()
             if "masses" in one}  # fmt: skip
    assert sizes == harmonic_limits.SIZES


# ---------------------------------------------------------------- errors
@pytest.mark.parametrize("count", (INSTANTS // 5, INSTANTS // 2, INSTANTS, 2 * INSTANTS))
def test_an_offset_is_measured_at_any_sampling(count):
    """A wave 1 % of its range too high has rms and greatest error 0.01, however often it is sampled."""
    given = np.sin(2 * np.pi * np.arange(count) / count) + 0.02
    result = reference().errors(given)
    assert result["rms"] == pytest.approx(0.01, rel=1e-12)
    assert result["error"] == pytest.approx(0.01, rel=1e-12)


# Amplitudes and phases of the harmonics of a wave and of its reference, and the offset between their means, N.
WAVE, WAVE_REFERENCE, OFFSET = {1: (130.0, 0.3), 3: (20.0, -1.1)}, {1: (100.0, 0.0), 3: (25.0, 0.0)}, 7.0


def wave_at(harmonics: dict, mean: float, t) -> np.ndarray:
    """mean + sum of a cos(2 pi k t / PERIOD + phase)."""
    return mean + sum(a * np.cos(2 * np.pi * k * t / PERIOD + phase) for k, (a, phase) in harmonics.items())


def rms_in_closed_form() -> float:
    """rms of the difference of the two waves over the range of the reference, 2 (100 + 25) N, by Parseval's theorem."""
    parts = (WAVE[k][0] * np.exp(1j * WAVE[k][1]) - WAVE_REFERENCE[k][0] for k in WAVE)
    return float(np.sqrt(OFFSET**2 + sum(abs(part) ** 2 for part in parts) / 2) / 250.0)


class Tension:
    """A response of three periods whose last one is the wave: before it is all else, after it nothing is known."""

    last_period = (2 * PERIOD, PERIOD)

    def fairlead_tension(self, t):
        assert (t < 3 * PERIOD).all()
        return wave_at(WAVE, 500.0 + OFFSET, t) + np.where(t < 2 * PERIOD, 1e3, 0.0)


def rms_misses() -> list[str]:
    """What the error of a wave against its reference, and ``rms`` alone, are off from their closed forms."""
    known = reference(wave_at(WAVE_REFERENCE, 500.0, instants(PERIOD)))
    misses, wanted = [], rms_in_closed_form()
    results = {count: known.errors(wave_at(WAVE, 500.0 + OFFSET, instants(PERIOD, count)))["rms"]
             for count in (INSTANTS // 5, INSTANTS // 2, INSTANTS, 3 * INSTANTS)}  # fmt: skip
    results["a response"] = known.errors_of_response(Tension())["rms"]
    results["its wave"] = known.errors(last_period_tension(Tension()))["rms"]
    for name, got in results.items():
        misses += [] if got == pytest.approx(wanted, rel=1e-12) else [f"{name}: {got}, wanted {wanted}"]
    alone = dynamic_cases.rms(wave_at({2: (3.0, 0.4), 5: (4.0, 1.0)}, 2.0, instants(PERIOD).reshape(2, -1)))
    return misses if alone == pytest.approx(np.sqrt(4.0 + 12.5), rel=1e-12) else [*misses, f"alone: {alone}"]


WRONG_RMS = {
    "root of the sum": lambda values: float(np.sqrt(np.sum(np.square(values)))),
    "mean square": lambda values: float(np.mean(np.square(values))),
    "mean size": lambda values: float(np.mean(np.abs(values))),
    "without the offset": lambda values: float(np.std(values)),
    "of one sample less": lambda values: float(np.sqrt(np.sum(np.square(values)) / (np.size(values) - 1))),
    "greatest": lambda values: float(np.max(np.abs(values))),
}


def test_the_rms_of_an_error_is_that_of_its_closed_form():
    """Amplitudes, phases and offset of two harmonics, over the range of the reference, at any sampling."""
    assert rms_misses() == []


@pytest.mark.parametrize("wrong", WRONG_RMS.values(), ids=WRONG_RMS)
def test_a_wrong_rms_is_found(wrong, monkeypatch):
    monkeypatch.setattr(dynamic_cases, "rms", wrong)
    assert len(rms_misses()) == 7


WRONG_PLACES = {
    "the end of the period twice": ("instants", lambda period, count=INSTANTS: np.linspace(0.0, period, count)),
    "half an instant late": ("instants", lambda period, count=INSTANTS: period * (np.arange(count) + 0.5) / count),
}


@pytest.mark.parametrize("name", WRONG_PLACES)
def test_a_response_at_wrong_instants_is_found(name, monkeypatch):
    """Instants of the response that are not those of its reference change the error."""
    monkeypatch.setattr(registry, *WRONG_PLACES[name])
    assert any(miss.startswith("a response") for miss in misses_or_refusal())


def misses_or_refusal() -> list[str]:
    """``rms_misses``, or that times were asked for that the response does not have."""
    try:
        return rms_misses()
    except AssertionError:
        return ["a response: asked beyond its last period"]


@pytest.mark.parametrize("wrong", [np.max, np.std, lambda tension: np.ptp(tension) / 2])
def test_a_wrong_range_is_found(wrong, monkeypatch):
    """Errors are over greatest less least tension: with another scale the check of the closed form turns red."""
    monkeypatch.setattr(Reference, "range", property(lambda self: float(wrong(self.tension))))
    assert len(rms_misses()) == 6


def test_harmonics_of_a_reference_are_its_amplitudes():
    """Mean, amplitudes of harmonics 1 and 3, and nothing in between."""
    result = reference(wave_at(WAVE, 500.0, instants(PERIOD))).harmonics(4)
    assert np.allclose(result, [500.0, 130.0, 0.0, 20.0, 0.0], rtol=1e-12, atol=1e-9)


class Planted(peers.Adapter):
    """A code whose tension is that function of time."""

    def __init__(self, tension):
        self.label, self.tension = "planted", tension

    def cable(self, scene, time, fairlead, cells):
        return self.tension(time)


def peer_tension(tension, steps=INSTANTS):
    """What a planted code says of the last of three periods of a motion."""
    still = Ramped(Motion.harmonic(1 / PERIOD, (0, 0, 0)), PERIOD / 2)
    return dynamic_work.ask(Planted(tension), scene("case_1"), still, PERIOD, (10, steps), periods=3)


@pytest.mark.parametrize("steps", (INSTANTS // 5, INSTANTS, 2 * INSTANTS))
def test_another_code_is_compared_at_the_right_instants(steps):
    """A sine at the times that are given has no error; one step late it has that of one step."""
    sine = lambda t: np.sin(2 * np.pi * t / PERIOD)
    assert dynamic_work.errors(reference(), peer_tension(sine, steps))["error"] < 1e-12
    late = peer_tension(lambda t: sine(t - PERIOD / steps), steps)
    assert dynamic_work.errors(reference(), late)["error"] == pytest.approx(np.pi / steps, rel=1e-2)


@pytest.mark.parametrize(
    ("tension", "status", "words"),
    [
        (lambda t: np.where(t > 3, np.nan, 1.0), "REFUSED", "tensions that are not finite"),
        (lambda t: t[1:], "REFUSED", "returned tensions of shape (3000,), and (3001,) is wanted"),
        (lambda t: "none", "REFUSED", "returned 'none'"),
        (lambda t: 1 / 0, "REFUSED", "ZeroDivisionError"),
    ],
)
def test_another_code_that_fails_is_refused_in_words(tension, status, words):
    """No number, and why."""
    result = dynamic_work.errors(reference(), peer_tension(tension))
    assert (result["rms"], result["status"]) == (None, status)
    assert result["message"].startswith(words)


def test_harmonics_of_a_reference():
    """Mean and amplitudes come from the samples."""
    t = 2 * np.pi * instants(1.0)
    result = reference(7 + 3 * np.sin(t) + 0.5 * np.cos(4 * t)).harmonics(4)
    assert np.allclose(result, [7, 3, 0, 0, 0.5], atol=1e-12)


# ---------------------------------------------------------------- orders, exponents, thresholds
@pytest.mark.parametrize("p", (1.0, 2.0, 3.0))
def test_planted_orders_and_exponents_are_found(p):
    """Errors C h^p give the order p, times C n^p the exponent p, and only sizes from the bound on count."""
    rows = [{"h": 2.0**-k, "e": 3 * 2.0 ** (-p * k)} for k in range(5)]
    assert np.allclose(dynamic_orders.with_orders(rows, ("e",))["orders"]["e"], p, atol=1e-12)
    times = [{"n": 1, "seconds": 1e9}, *({"n": n, "seconds": 2 * n**p} for n in (10, 20, 40))]
    assert cable_dynamics.exponent(times, "n", 10) == pytest.approx(p, rel=1e-12)


def test_a_limit_of_second_order_is_extrapolated():
    """Waves 1 + C h^2 have their error against 1; an error of first order does not vanish from the last."""
    h = 2.0 ** -np.arange(4)
    waves = [SINE * (1 + 0.1 * step**2) for step in h]
    result = dynamic_orders.against_extrapolation([{}] * 4, "e", waves)
    assert np.allclose([row["e"] for row in result], rms(SINE) / 2 * 0.1 * h**2, rtol=1e-9)
    first = dynamic_orders.against_extrapolation([{}] * 4, "e", [SINE * (1 + 0.1 * step) for step in h])
    assert dynamic_orders.with_orders(first, ("e",))["orders"]["e"][0] < 1.5


@pytest.mark.parametrize(
    ("away", "first"), [([0.5, 0.2, 0.01, 0.0], 3), ([0.5, 0.01, 0.2, 0.01, 0.0], 4), ([0.5, 0.4, 0.3, 0.0], None)]
)
def test_settled_means_settled_for_good(away, first):
    """The first period from which all later ones are within the level; the last one is no evidence for itself."""
    assert cable_dynamics.first_within(away, 0.05) == first


def test_amplitude_of_vanishing_tension_is_between_its_neighbours():
    """Interpolated between converged responses of either sign; responses that were not reached do not count."""
    result = (9.0, 30.0, 1.0), (10.0, 10.0, 1.0), (11.0, -10.0, 1.0), (12.0, -30.0, 0.9)
    rows = [dict(zip(("amplitude", "least", "reached"), row, strict=True)) for row in result]
    assert harmonic_limits.vanishing(rows) == pytest.approx(10.5)
    assert harmonic_limits.vanishing(rows[:2]) is None


# ---------------------------------------------------------------- references
COARSE = ((13, 25, 49), 5, 7)


def test_a_reference_is_better_than_its_finest_mesh():
    """Extrapolated in N and corrected in Nh, three coarse meshes beat the finest of them five times over."""
    result = dynamic_cases.converged("case_1", *COARSE)
    finer = solve_periodic(system("case_1", 193), harmonics=COARSE[2])
    plain = result.errors(last_period_tension(solve_periodic(system("case_1", 49), harmonics=COARSE[1])))
    assert result.errors_of_response(finer)["rms"] < 0.2 * plain["rms"]
    assert result.uncertainty < 0.01


def test_a_reference_has_its_order_in_mesh_and_harmonics():
    """Three meshes show the second order of the scheme; more harmonics change the tension less each time."""
    kept = dynamic_cases.converged("case_1", (13, 25, 49), 6, 12).refinements
    assert kept["mesh"]["sizes"] == (12, 24, 48) and kept["harmonics"]["sizes"] == (3, 6, 12)
    assert kept["mesh"]["is_asymptotic"] and kept["mesh"]["order"] == pytest.approx(2.0, abs=0.3)
    assert kept["harmonics"]["is_asymptotic"] and kept["harmonics"]["order"] > 1


def test_a_reference_is_computed_once_and_again_when_the_scene_changes(tmp_path, monkeypatch):
    """Kept by content: a second run reads it, a changed scene file makes a new one, a finer one is preferred."""
    made = []

    def converged(name, *settings):
        made.append((name, settings))
        return Reference(PERIOD, SINE * len(made), 1e-5)

    monkeypatch.setattr(dynamic_cases, "converged", converged)
    quick, again = (dynamic_cases.References(tmp_path, True) for _ in range(2))
    assert np.array_equal(quick.get_or_compute("case_1").tension, again.get_or_compute("case_1").tension)
    assert len(made) == 1
    whole = dynamic_cases.References(tmp_path, False).get_or_compute("case_1")
    assert len(made) == 2 and np.array_equal(quick.get_or_compute("case_1").tension, whole.tension)
    changed = tmp_path / "scenes"
    changed.mkdir()
    text = (dynamic_cases.SCENES / "hb_case_1.toml").read_text(encoding="utf-8")
    (changed / "hb_case_1.toml").write_text(text.replace("5.0", "5.1"), encoding="utf-8")
    monkeypatch.setattr(dynamic_cases, "SCENES", changed)
    quick.get_or_compute("case_1")
    assert len(made) == 3


def test_two_histories_extrapolated_are_better_than_the_finer_one():
    """The method of that name takes the error of second order out; the rest, of fourth order, was 0.31 of the error."""
    exact = last_period_tension(solve_time_domain(system("case_1", 193), dt=0.025, periods=2))
    both = extrapolated_time_domain(partial(system, "case_1"), 25, 0.2, 2)()
    finer = last_period_tension(solve_time_domain(system("case_1", 49), dt=0.1, periods=2))
    assert rms(both - exact) < 0.4 * rms(finer - exact)


# ---------------------------------------------------------------- the peer
STATIC_ERROR = 1e-3  # of the tension: five times that of 49 straight segments with their masses at the nodes
SAME_PLACE = 1e-6  # rms over the range: of coordinates rounded otherwise; in the air it is off by a fifth
MOVING_ERROR = 2e-3  # rms over the range: that of 24 segments, and half as much again


def test_times_at_equal_errors():
    """The least time of each method that meets the error; one that does not get there is left out."""
    point = lambda case, method, seconds, rms: {"case": case, "method": method, "seconds": seconds, "rms": rms}
    points = [
        point("a", "harmonic balance", 1.0, 5e-3),
        point("a", "harmonic balance, corrected", 2.0, 1e-4),
        point("a", "time domain", 6.0, 2e-3),
        point("a", "time domain", 9.0, 9e-4),
        point("b", "harmonic balance", 1.0, 1e-3),
        point("b", "time domain", 1.0, None),
    ]
    results = {(row["case"], row["level"]): {method: best["seconds"] for method, best in row["best"].items()}
             for row in dynamic_work.at_errors(points)}  # fmt: skip
    both, balanced = {"harmonic balance": 1.0, "time domain": 6.0}, {"harmonic balance": 1.0}
    later, last = {"harmonic balance": 2.0, "time domain": 6.0}, {"harmonic balance": 2.0, "time domain": 9.0}
    assert results == {("a", 3e-2): both, ("a", 1e-2): both, ("a", 3e-3): later, ("a", 1e-3): last,
                     ("a", 3e-4): {"harmonic balance": 2.0}, ("b", 3e-2): balanced, ("b", 1e-2): balanced,
                     ("b", 3e-3): balanced, ("b", 1e-3): balanced}  # fmt: skip


moordyn_installed = pytest.mark.skipif("moordyn" not in peers.adapters(), reason="the optional peer is not installed")


def moordyn_step() -> float:
    """Of the adapter, where MoorDyn is installed."""
    adapter = peers.adapters().get("moordyn")
    return sys.modules[type(adapter).__module__].STEP if adapter else 0.0


def simulated(case, motion, period: float, steps: int, cells: int, periods: int = 3):
    """What MoorDyn says of the last period."""
    return dynamic_work.ask(peers.adapters()["moordyn"], case, motion, period, (cells, steps), periods)


@moordyn_installed
@pytest.mark.parametrize(("factor", "within"), [(1.0, True), (1.01, False)])
def test_the_adapter_describes_the_line_that_was_meant(factor, within):
    """At rest MoorDyn carries the tension of the catenary; a line 1 % heavier is told apart."""
    case = scene("case_1")
    mass = factor * case.cable.mass_per_length  # a weight that was given would contradict it
    heavier = replace(case, cable=replace(case.cable, mass_per_length=mass, submerged_weight=None))
    tension = simulated(heavier, Motion.harmonic(0.05, (0, 0, 0)), 20.0, 200, 49).tension
    exact = solve_span(case.spans()[0]).tension
    assert (abs(tension[-100:].mean() / exact - 1) < STATIC_ERROR) == within


@moordyn_installed
@pytest.mark.parametrize(("change", "within"), [({}, True), ({"Cdn": 1.68, "Cdb": 1.68}, False), ({"Cdt": 0.05}, False),
                                                ({"Ca": 3.0}, False)])  # fmt: skip
def test_the_adapter_moves_the_line_that_was_meant(change, within):
    """In surge MoorDyn has the tension of harmonic balance; 5 % more drag, or drag along the line, is told apart."""
    chain = system("case_1")
    known = Reference(chain.period, last_period_tension(solve_periodic(chain, harmonics=15)), 0.0)
    changed = replace(chain.scene, cable=replace(chain.scene.cable, **change))
    result = simulated(changed, Ramped(changed.motion, chain.period / 2), chain.period, 1000, 24)
    assert (dynamic_work.errors(known, result)["rms"] < MOVING_ERROR) == within


@moordyn_installed
def test_the_adapter_puts_the_line_into_the_water():
    """A scene without a seabed has its origin anywhere; MoorDyn has air above z = 0, where the line moves otherwise."""
    case = scene("case_1")
    higher = {name: tuple(np.array(getattr(case, name)) + (0, 0, 1000.0)) for name in ("anchor", "fairlead")}
    below, above = (simulated(one, case.motion, 20.0, 200, 12).tension for one in (case, replace(case, **higher)))
    assert rms(above - below) / np.ptp(below) < SAME_PLACE


@moordyn_installed
@pytest.mark.parametrize(("step", "within"), [(moordyn_step(), True), (4 * moordyn_step(), False)])
def test_the_adapter_steps_as_short_a_line_as_it_takes(monkeypatch, step, within):
    """A line a third as long, whose stable step is a third too, comes to rest; with four times the step it does not."""
    monkeypatch.setattr(sys.modules[type(peers.adapters()["moordyn"]).__module__], "STEP", step)
    case = scene("case_1")
    ends = {name: tuple(np.array(getattr(case, name)) / 3) for name in ("anchor", "fairlead")}
    short = replace(case, length=case.length / 3, **ends)
    tension = simulated(short, Motion.harmonic(0.05, (0, 0, 0)), 20.0, 200, 49).tension
    exact = solve_span(short.spans()[0]).tension
    assert (tension is not None and abs(tension[-100:].mean() / exact - 1) < STATIC_ERROR) == within


@moordyn_installed
def test_the_adapter_refuses_what_it_does_not_describe():
    """A rigid seabed is named, not left out; a current and structural damping are in its answer."""
    case = scene("case_1")
    rigid = replace(case, environment=replace(case.environment, depth=400.0))
    result = simulated(rigid, case.motion, 20.0, 10, 5)
    assert result.kind == "unsupported" and "no stiffness" in result.message
    plain = simulated(case, case.motion, 20.0, 10, 5).tension
    for other in (
        replace(case, environment=replace(case.environment, current=(1.0, 0.0, 0.0))),
        replace(case, cable=replace(case.cable, damping=0.1)),
    ):
        assert abs(simulated(other, case.motion, 20.0, 10, 5).tension - plain).max() > 1e-3 * plain.max()


# ---------------------------------------------------------------- the files
def test_a_part_writes_its_file(tmp_path):
    """The program measures the parts that are asked for and writes strict JSON."""
    assert cable_dynamics.main(["--parts", "profile", "--quick", "--out", str(tmp_path)]) == 0
    result = json.loads((tmp_path / "dynamics.json").read_text())
    assert set(result) == {"profile", "quick"}
    tensions = result["profile"]["fairlead"]
    assert tensions["shooting"] == pytest.approx(tensions["catenary"], rel=1e-9)
    assert tensions["box scheme"] != pytest.approx(tensions["catenary"], rel=1e-5)
