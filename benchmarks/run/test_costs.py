"""Are steps, iterations and cell evaluations those that solvers tell and make?"""

from __future__ import annotations

import math
from types import SimpleNamespace

import pytest

from solvers import solve_periodic, solve_time_domain
from solvers.mooring.periodic import harmonic

from .. import peers
from ..cable import work_precision as cable_work
from ..mooring import cases
from ..mooring.networks import systems
from .costs import NOT_TOLD, add_work, count_explicit, count_work

CELLS = 14


def test_a_history_costs_its_iterations_times_its_cells():
    system = cases.line("case_1", CELLS)
    history = solve_time_domain(system, dt=system.period / 50, periods=2)
    work = count_work(history)
    assert work["steps"] == 100 and work["iterations"] == history.iterations >= 100
    assert work["factorisations"] == history.factorisations > 0
    assert work["cell_evaluations"] == CELLS * history.iterations


def test_harmonic_balance_costs_its_samples_and_the_start_in_time(monkeypatch):
    """As counted where the residual is computed, but for the trial steps of a line search, of which there are none."""
    counted = []
    monkeypatch.setattr(harmonic, "sampled_residual", _counting(harmonic.sampled_residual, counted))
    system = cases.line("case_1", CELLS)
    response = solve_periodic(system, harmonics=4)
    in_time = response.coarse_iterations * CELLS
    work = count_work(response)
    assert response.coarse_iterations > 50 and work["iterations"] == response.iterations
    assert work["cell_evaluations"] == response.iterations * 16 * CELLS + in_time
    # beside one residual an iteration: the tensions of the start and the norm of the result
    assert 0 <= sum(counted) - (work["cell_evaluations"] - in_time) <= 2 * 16 * CELLS


def _counting(function, counted: list):
    def count(line, samples, *others):
        counted.append(samples.shape[1] * line.length.size)
        return function(line, samples, *others)

    return count


def test_two_meshes_cost_both():
    system = cases.line("case_1", CELLS)
    one = count_work(solve_periodic(system, harmonics=4))
    both = count_work(solve_periodic(system, harmonics=4, deferred_correction=True))
    half = count_work(solve_periodic(cases.every_second_node(system), harmonics=4))
    assert both["cell_evaluations"] == one["cell_evaluations"] + half["cell_evaluations"]


def test_the_parts_of_a_network_share_its_cells():
    """Each iteration is of one of three equal parts."""
    made = systems.system(systems.NINE_LINES, 10)
    run = systems.history(made, 20, 1)
    assert len(made.components) == 3
    cells = sum(len(part.system.layout.first) for part in made.components)
    assert count_work(run)["cell_evaluations"] == round(run.iterations * cells / 3)


def test_a_count_that_is_not_told_leaves_none_of_the_sum():
    one = {"steps": 1, "iterations": 2, "factorisations": 3, "cell_evaluations": 4}
    assert add_work([one, one | {"steps": 10}]) == {"steps": 11, "iterations": 4, "factorisations": 6,
                                                    "cell_evaluations": 8}  # fmt: skip
    assert add_work([one, one | {"factorisations": None}])["factorisations"] is None


def test_an_explicit_scheme_costs_its_stages():
    assert count_explicit(10, 3, 2, 5) == NOT_TOLD | {"steps": 30, "cell_evaluations": 300}


@pytest.mark.skipif("moordyn" not in peers.adapters(), reason="the optional peer is not installed")
def test_moordyn_takes_as_many_steps_as_it_is_given():
    """Within a coupling step, the fewest that are no longer than its dtM."""
    adapter, case = peers.adapters()["moordyn"], cases.scene("case_1")
    wave_speed = math.sqrt(case.cable.EA / case.cable.mass_per_length)
    longest = 0.5 * case.length / 10 / wave_speed
    for share, steps in ((0.9, 1), (1.0, 1), (1.1, 2), (3.0, 3)):
        assert adapter.count_cable_steps(case, share * longest, 10) == steps
    network = systems.network(systems.NINE_LINES)
    inner = adapter.count_network_steps(network, 0.05, [8, 1, 1] * 3)
    assert adapter.count_network_steps(network, 0.05, [80, 1, 1] * 3) > 2 * inner > 0
    made = SimpleNamespace(count_cable_steps=lambda *of: 4, stages=2)
    assert cable_work._count_peer_work(made, case, [0.0, 0.1, 0.2], 10)["cell_evaluations"] == 2 * 4 * 2 * 10
