"""The checks of these benchmarks: are systems, tensions, differences, periods, memory and points measured rightly?"""

from __future__ import annotations

import os

import numpy as np
import pytest

from solvers import mooring_system, solve_network, solve_periodic
from solvers.io import write_moordyn

from ... import peers
from . import agreement, scaling, systems
from . import work_precision as work

moordyn_installed = pytest.mark.skipif("moordyn" not in peers.adapters(), reason="the optional peer is not installed")
ROUNDING = 1e-12  # relative: the same sums in another order
BETWEEN = 1e-6
"""Of a tension: stored steps against polynomials through them, which pass through their points."""


# ---------------------------------------------------------------- the systems
@pytest.mark.parametrize("name", systems.SYSTEMS)
def test_a_system_moves_in_all_six_and_moordyn_can_state_it(name, tmp_path):
    """Each coordinate moves, at rest there is an equilibrium, and MoorDyn's file holds the same lines."""
    network = systems.network(name)
    translation, rotation = network.motion.translation, network.motion.rotation
    times = np.arange(8) / 8 * network.motion.period
    assert all(np.ptp(part.displacement(times), axis=1).min() > 0 for part in (translation, rotation))
    assert solve_network(network).success and 10 <= network.motion.period <= 20
    counts = systems.SEGMENTS[name](20)
    notes = write_moordyn(tmp_path / "lines.txt", network, counts, damping_ratio=agreement.DAMPING)
    assert len(counts) == len(network.elements) and not any("friction" in note for note in notes)
    assert not any(element.cable.damping for element in network.elements)


def test_radial_lines_are_alike():
    """Three equal lines: each fairlead has the force of the first, turned by its azimuth."""
    network = systems.network("polyester")
    state = solve_network(network)
    forces = state.reaction[[i for i, node in enumerate(network.nodes) if node.kind == "coupled"]]
    for force, angle in zip(forces, systems.AZIMUTHS, strict=True):
        c, s = np.cos(angle), np.sin(angle)
        turned = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]) @ forces[0]
        np.testing.assert_allclose(force, turned, rtol=0, atol=1e-6 * np.linalg.norm(forces[0]))  # of the equilibrium
    assert len(network.elements) == 9 and systems.farm(10).elements[0].L == systems.FARM_LINE


# ---------------------------------------------------------------- tensions and differences
def test_tensions_are_those_of_the_lines_at_the_fairleads():
    """By stored steps and by the outputs of each line, in time and by harmonic balance, in one order."""
    made = systems.system(systems.NINE_LINES, 20)
    run = systems.history(made, 200, 2)
    elements = systems.fairlead_elements(made.model)
    assert elements == [1, 2, 4, 5, 7, 8]
    times = run.last_period[0] + np.arange(systems.COUNT) / systems.COUNT * made.period
    expected = np.array([run.elements[e].fairlead_tension(times) for e in elements])
    np.testing.assert_allclose(systems.our_tensions(run, 200), expected, rtol=BETWEEN)
    other = mooring_system(systems.network("oc3"), 10)
    response = solve_periodic(other, harmonics=5)
    tensions = systems.periodic_tensions(response)
    at_samples = np.linalg.norm(response.forces[:, other.coupled_nodes], axis=0)
    np.testing.assert_allclose(tensions[:, 0], at_samples[:, 0], rtol=1e-9)


@pytest.mark.parametrize(("steps", "kept"), [(400, 200), (50, 50)])
def test_the_last_period_is_kept(steps, kept):
    forces = np.zeros((2, 3, 3 * steps + 1))
    forces[:, 0] = np.arange(3 * steps + 1)
    tensions = systems.last_tensions(forces, steps)
    assert tensions.shape == (2, kept) and tensions[0, 0] == 2 * steps and tensions[1, -1] == 3 * steps - steps / kept


def test_differences_are_the_largest_over_the_fairleads():
    """A sine of amplitude 0.1 on a range of 2 and one of 0.1 on 4: the first counts, and times are matched."""
    sine = np.sin(2 * np.pi * np.arange(systems.COUNT) / systems.COUNT)
    reference = np.array([sine, 2 * sine])
    wave = reference + 0.1 * sine
    assert systems.differences(wave, reference) == pytest.approx({"rms": 0.05 / np.sqrt(2), "error": 0.05}, rel=1e-12)
    assert systems.differences(reference[:, ::4], reference) == {"rms": 0.0, "error": 0.0}


# ---------------------------------------------------------------- beside MoorDyn
@moordyn_installed
def test_the_difference_from_moordyn_is_explained():
    """Three lines, cheap settings: refining explains the difference, which half the segments make larger."""
    row = agreement.compare("oc3", quick=True)
    assert 0 < row["rms"] <= row["explained"] < 0.02 and row["rms"] < row["rms_of_half"]
    assert row["same_cells"] < row["rms_of_half"]
    (_, rough), (_, fine) = row["at_rest"]
    assert abs(fine) < abs(rough) < 0.01


def test_what_is_explained_is_summed_with_its_orders():
    row = {"by_segments": 0.3, "by_steps": 0.01, "by_damping": 0.04, "uncertainty": 0.002}
    assert agreement.explained(row) == pytest.approx(0.1 + 0.01 + 0.02 + 0.002, rel=ROUNDING)


@moordyn_installed
def test_the_equilibrium_that_moordyn_gets_is_solved_for_once(monkeypatch):
    """Else the run time of a repeated call would hold this project's statics."""
    work.run_moordyn((8, 1, 1), 50, 2)
    monkeypatch.setattr("solvers.network.solve.solve_network", None)
    tensions = work.run_moordyn((8, 1, 1), 50, 2).tensions
    assert tensions.shape == (6, 50) and tensions.min() > 0


@moordyn_installed
def test_more_internal_damping_changes_moordyn():
    network, counts = systems.network("oc3"), systems.SEGMENTS["oc3"](8)
    one, two = (agreement.moordyn_tensions(network, counts, 100, 2, share) for share in (0.1, 0.2))
    assert 1e-4 < systems.differences(two, np.repeat(one, 2, axis=1)[:, :200])["rms"] < 0.1


# ---------------------------------------------------------------- error against run time
def test_points_have_the_error_from_the_reference_of_their_method(monkeypatch):
    """Also what fails: it has no error, and a status."""
    sine = np.sin(2 * np.pi * np.arange(systems.COUNT) / systems.COUNT)[None]
    fine = {work.TIME: sine, work.BALANCE: sine, work.MOORDYN: 3 * sine}

    counted = {"steps": 3, "iterations": 7, "factorisations": 2, "cell_evaluations": 70}

    def fail(*setting):
        raise RuntimeError("an error of another code")

    calls = {work.TIME: lambda *s: work.Answer(sine, counted), work.BALANCE: lambda *s: work.Answer(None),
             work.MOORDYN: lambda *s: work.Answer(3.3 * sine)}  # fmt: skip
    plan = {("in time", (20, 50, 2)): calls[work.TIME], ("harmonic balance", (20, 5)): calls[work.BALANCE],
            ("MoorDyn", ((8, 1, 1), 200, 2)): calls[work.MOORDYN], ("MoorDyn", ((9, 1, 1), 200, 2)): fail}  # fmt: skip
    monkeypatch.setattr(work, "settings", lambda quick: plan)
    rows = {(p["method"], p["size"]): p for p in work.points(True, fine) if p is not None}
    assert rows["in time", 20]["rms"] == 0 and rows["in time", 20]["periods"] == 2
    assert rows["harmonic balance", 20]["status"] == "FAILED" and rows["harmonic balance", 20]["periods"] is None
    assert rows["MoorDyn", (8, 1, 1)]["error"] == pytest.approx(0.05, rel=ROUNDING)
    assert rows["MoorDyn", (9, 1, 1)]["rms"] is None and rows["MoorDyn", (9, 1, 1)]["status"] == "FAILED"
    assert all(0 < row["seconds"] < work.LONG for row in rows.values())
    assert counted.items() <= rows["in time", 20].items() and rows["MoorDyn", (9, 1, 1)]["cell_evaluations"] is None


def test_errors_of_the_nine_lines_fall_along_the_ladder():
    fine = systems.our_tensions(systems.history(systems.system(systems.NINE_LINES, 80), 200, 4), 200)
    errors = [
        systems.differences(work.run_in_time(*one).tensions, fine)["rms"]
        for one in ((10, 25, 2), (20, 50, 2), (40, 100, 3))
    ]
    assert errors[0] > errors[1] > errors[2] and errors[2] < 0.005
    balanced = work.run_balance(*work.BALANCED[0]).tensions
    assert balanced is not None and systems.differences(balanced, fine)["rms"] < 0.03


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="this system sets no cores")
def test_one_core_is_taken_and_given_back():
    before = os.sched_getaffinity(0)
    with systems.one_core():
        assert len(os.sched_getaffinity(0)) == 1
    assert os.sched_getaffinity(0) == before


# ---------------------------------------------------------------- growth and drag
def test_memory_is_the_most_of_a_call():
    """Eight million bytes, let go before four million more: numpy's arrays are counted, and the peak of them."""

    def run():
        np.ones(1_000_000).sum()
        return np.ones(500_000)

    assert 8e6 <= scaling.peak_memory(run) < 8.2e6


def test_memory_and_time_of_a_history_grow_with_its_lines():
    few, many = (mooring_system(systems.farm(lines), 10) for lines in (3, 12))
    both = [scaling.peak_memory(lambda made=made: systems.history(made, 20, 1)) for made in (few, many)]
    assert 2 < both[1] / both[0] < 5


def test_a_share_of_the_drag_is_of_every_coefficient():
    network = systems.network("polyester")
    for element, changed in zip(network.elements, scaling.with_drag(network, 0.1).elements, strict=True):
        for key in ("Cdn", "Cdb", "Cdt"):
            assert getattr(changed.cable, key) == pytest.approx(0.1 * getattr(element.cable, key), rel=ROUNDING)
        assert changed.cable.Ca == element.cable.Ca and changed.L == element.L


@pytest.mark.parametrize(("sizes", "count"), [((1, 0.1, 0, 0, 0), 4), ((0, 0), 2), ((0, 1, 0), None), ((1, 0, 0), 3)])
def test_periods_pass_until_each_is_as_the_next(sizes, count):
    """What is added to a sine falls to nothing: the first period that repeats its predecessor counts."""
    sine = np.sin(2 * np.pi * np.arange(100) / 100)
    assert scaling.settling_count(np.array([[sine + size] for size in sizes])) == count


def test_less_drag_takes_more_periods():
    few, many = (scaling.at_drag("oc3", drag, 30) for drag in (1.0, 0.1))
    assert few["periods"] < many["periods"] < 30 and few["status"] == many["status"] == "SUCCESS"
    assert few["difference"] < 0.01 and few["in_time"] > 0


# ---------------------------------------------------------------- periodic or not yet
def test_the_change_of_the_last_period_is_that_of_the_worst_fairlead():
    """A sine that is 2 % of its range higher in the period before, beside one that repeats itself."""
    sine = 5.0 + np.sin(2 * np.pi * np.arange(100) / 100)
    tension = np.array([[*sine, *sine, sine[0]], [*(sine + 0.04), *sine, sine[0]]])
    forces = np.stack([tension, 0 * tension, 0 * tension], axis=1)
    assert systems.last_change(forces, 100) == pytest.approx(0.02, rel=1e-9)
    assert systems.last_change(forces[:1], 100) < 1e-12


# ---------------------------------------------------------------- references
def test_the_fine_run_is_refined_in_mesh_and_step_alone():
    """Of a taut system each has three sizes that end at the fine run's, and the mesh its second order."""
    kept = agreement.refine("polyester", quick=True)
    cells, steps = agreement.QUICK_REFERENCE
    assert {what: one["sizes"] for what, one in kept.items()} == {
        "mesh": (cells // 4, cells // 2, cells), "steps": (steps // 4, steps // 2, steps)}  # fmt: skip
    assert kept["mesh"]["is_asymptotic"] and kept["mesh"]["order"] == pytest.approx(2.0, abs=0.2)
    assert 0 < kept["mesh"]["change"] < 1e-3 and 0 < kept["steps"]["change"] < 1e-3
