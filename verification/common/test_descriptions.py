"""What a result shows of itself, and what is taken where a system is asked for."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from importlib.resources import files

import pytest

from solvers import (
    InputError,
    Motion,
    Scene,
    Status,
    cable_system,
    mooring_system,
    response_curve,
    solve_network,
    solve_periodic,
    solve_span,
    solve_static,
    solve_time_domain,
)
from solvers.io import load_network
from solvers.mooring import mooring_stiffness
from solvers.numerics.modes import natural_modes
from solvers.stability.multipliers.floquet import floquet

SCENES = files("reference_data") / "scenes"
MOST_LINES = 5  # of what a result shows of itself


@cache
def scene():
    return Scene.load(SCENES / "dynamics" / "hb_case_1.toml")


@cache
def network():
    return load_network(SCENES / "networks" / "oc3_moving.toml")


RESULTS = {
    "span": lambda: solve_span(scene().spans()[0]),
    "network": lambda: solve_network(network()),
    "box scheme": lambda: solve_static(cable_system(scene(), 20)),
    "line at rest": lambda: solve_static(mooring_system(scene(), 20)),
    "lines at rest": lambda: solve_static(mooring_system(network(), 10)),
    "paper in time": lambda: solve_time_domain(cable_system(scene(), 20), dt=0.5, periods=1),
    "paper's response": lambda: solve_periodic(cable_system(scene(), 20), harmonics=2),
    "line in time": lambda: solve_time_domain(mooring_system(scene(), 10), dt=0.5, periods=1),
    "line's response": lambda: solve_periodic(mooring_system(scene(), 10), harmonics=2),
    "lines in time": lambda: solve_time_domain(mooring_system(network(), 8), dt=0.5, duration=5.0),
    "curve": lambda: response_curve(
        mooring_system(scene(), 5), parameter="amplitude", start=0.1, stop=0.2, harmonics=1, output=lambda r: r.time
    ),
}


@pytest.mark.parametrize("make", RESULTS.values(), ids=RESULTS)
def test_a_result_shows_status_and_main_numbers_in_a_few_lines(make):
    """Class, status, numbers with units; what warnings there are, or how to ask for them; nothing is solved for it."""
    result = make()
    before = set(vars(result))
    lines = repr(result).splitlines()
    assert lines[0].startswith(f"{type(result).__name__}: SUCCESS") and 2 <= len(lines) <= MOST_LINES
    assert all(len(line) < 250 for line in lines)
    if hasattr(type(result), "warnings"):
        assert "warning" in lines[-1] and not {"warnings", "mesh_error"} & (set(vars(result)) - before)


def test_numbers_that_are_shown_are_those_of_the_result():
    """Tension at the fairlead of a span and of a state; the extremes of a history, and its warnings once asked for."""
    state, span = solve_static(mooring_system(scene(), 20)), solve_span(scene().spans()[0])
    assert f"T = {span.tension:.7g} N" in repr(span)
    assert f"T = {state.fairlead_tension:.7g} N" in repr(state) and "no warnings" in repr(state)
    history = RESULTS["line in time"]()
    tension = history.fairlead_tension(history.time)
    assert f"{tension.min():.6g} to {tension.max():.6g} N" in repr(history)
    assert repr(history).endswith("warnings: ask .warnings")
    assert history.warnings[0] in repr(history)


def test_a_failure_shows_what_to_try():
    """In place of numbers, which mean nothing then."""
    failed = replace(RESULTS["line in time"](), status=Status.STEP_FAILED)
    assert Status.STEP_FAILED.value in repr(failed) and "tension " not in repr(failed).partition("\n")[2][:40]


@pytest.mark.parametrize("given", [scene, network], ids=["Scene", "Network"])
def test_a_scene_and_a_network_are_taken_where_a_system_is(given):
    """Each public call, alone or in a batch; the curve by amplitude, which takes any motion."""
    one = given()
    assert solve_static(one).success and natural_modes(one, 2).frequencies.size == 2
    assert all(history.success for history in solve_time_domain([one, one], dt=0.5, duration=1.0))
    assert solve_periodic(one, harmonics=1).success
    assert mooring_stiffness(one).shape == (6, 6)


@pytest.mark.parametrize(
    "call",
    [
        lambda what: solve_static(what),
        lambda what: solve_time_domain(what, dt=0.1, periods=1),
        lambda what: solve_periodic(what, harmonics=1),
        lambda what: natural_modes(what, 1),
        lambda what: response_curve(what, parameter="amplitude", start=1, stop=2, harmonics=1, output=lambda r: r.time),
    ],
    ids=["static", "time", "periodic", "modes", "curve"],
)
def test_what_is_no_system_is_refused_by_its_type(call):
    with pytest.raises(InputError, match=r"system: Motion is no system, and no Scene or Network"):
        call(Motion.harmonic(0.1, (1.0, 0.0, 0.0)))


def test_what_takes_less_says_what_to_give():
    """The paper's cable is one line; Floquet's multipliers are those of a response."""
    with pytest.raises(InputError, match="NamedNetwork is no Scene; mooring_system takes a Network"):
        cable_system(network())
    with pytest.raises(InputError, match="Scene is no PeriodicResponse: give what solve_periodic returns"):
        floquet(scene())
