"""Error control: the setting that is chosen meets its tolerance against a run four times finer, and says so."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from solvers import ConvergenceError, InputError
from solvers.load_cases import Accuracy, CaseResult, LoadCaseTable, accuracy, solve_load_cases
from solvers.load_cases.results import QUANTITIES, LineResult

from .systems import CATENARY, TAUT, sea_case

SEAS = [sea_case(f"sea {seed}", 0.2 + 0.05 * seed, seed, duration=80.0, Tp=9.0 + seed / 4) for seed in range(6)]
HANGING = replace(CATENARY, fairlead=(199.0, 0.0, -10.0))


def errors(table, finer) -> np.ndarray:
    """Return the relative errors of what is asked, (quantities, cases, lines)."""
    return np.array(
        [
            abs(table.values(name) - finer.values(name))
            / np.maximum(finer.values(name), accuracy.LEAST_SIZE * finer.values("mean"))
            for name in QUANTITIES
        ]
    )


@pytest.mark.parametrize(
    ("system", "tolerances"), [(TAUT, (0.1, 0.004)), (HANGING, (0.3, 0.15))], ids=["taut", "on the seabed"]
)
def test_the_promise_is_kept(system, tolerances):
    """Against steps and cells four times finer every case is within the tolerance; tighter ones cost finer settings."""
    chosen = []
    for tolerance in tolerances:
        table = solve_load_cases(system, SEAS, tolerance=tolerance)
        assert table.accuracy.tolerance == tolerance and table.accuracy.promised <= tolerance
        assert table.accuracy.sampled == accuracy.SAMPLE and table.accuracy.within == accuracy.SAMPLE
        assert table.accuracy.measured <= tolerance
        finer = solve_load_cases(system, SEAS, dt=table.dt / 4, cells=4 * table.cells)
        assert errors(table, finer).max() <= tolerance
        chosen.append((table.dt, table.cells))
    (dt, cells), (finer_dt, finer_cells) = chosen
    assert finer_dt <= dt and finer_cells >= cells and chosen[0] != chosen[1]


def made_of(dt, cells, number=0, of_mesh=40.0, of_step=0.3) -> CaseResult:
    """Return a row whose quantities err by of_mesh / cells^2 and of_step dt^2, relative."""
    value = 1e6 * (1 + of_mesh / cells**2 + of_step * dt**2)
    line = LineResult("line", 0.0, 0.0, value, value, value, None, None, None, 0.0, 0.0, 0.0, 0.0)
    return CaseResult(number, "made", "SUCCESS", "", (line,))


def test_the_search_ends_where_the_estimate_does():
    """Errors of second order are estimated as they are, times the factor of safety; the larger one is refined first."""
    asked = []

    def run(numbered, dt, cells):
        asked.append((dt, cells))
        return [made_of(dt, cells, number) for number, _ in numbered]

    dt, cells, result = accuracy.choose_setting(SEAS, 0.02, run)
    truth = 40.0 / cells**2 + 0.3 * dt**2
    assert result.promised == pytest.approx(accuracy.SAFETY * truth, rel=0.05)  # each over a value that errs itself
    assert result.promised <= 0.02 and len(set(asked)) == len(asked)  # nothing is run twice
    coarser = [made_of(2 * dt, cells), made_of(dt, cells // 2)]
    assert all(accuracy.SAFETY * (one.lines[0].maximum / 1e6 - 1) > 0.02 for one in coarser)  # neither would have done


def test_a_tolerance_out_of_reach_is_refused():
    """Where the finest setting leaves more, and where no row can be solved, the message says so."""
    with pytest.raises(ConvergenceError, match=r"no step and mesh meets a tolerance of 0\.001"):
        accuracy.choose_setting(
            SEAS, 1e-3, lambda numbered, dt, cells: [made_of(dt, cells, i, 1e4) for i, _ in numbered]
        )
    with pytest.raises(InputError, match="no row is a load case"):
        accuracy.choose_setting([InputError("x", field="Hs")], 0.1, None)


def test_a_sample_that_errs_is_told():
    """Rows of the table that change more than the tolerance lower ``within`` and are what ``measured`` says."""
    rows = SEAS[:4]
    table = LoadCaseTable(tuple(made_of(0.2, 40, i) for i in range(4)), 0.2, 40)

    def run(numbered, dt, cells):
        assert (dt, cells) == (0.1, 80)
        return [made_of(dt, cells, i, of_mesh=0.0 if i == 2 else 40.0) for i, _ in numbered]

    result = accuracy.measure_accuracy(rows, table, Accuracy(0.04, 0.04), run)
    assert (result.within, result.sampled) == (3, 4)
    change = made_of(0.2, 40).lines[0].maximum / made_of(0.1, 80, of_mesh=0.0).lines[0].maximum - 1
    assert result.measured == pytest.approx(4 / 3 * change, rel=1e-9)


def test_pilots_are_the_fastest_and_the_widest():
    """Among many rows those of the highest and the steepest sea, and at the farthest offset, are pilots."""
    rows = [sea_case(f"{i}", 1.0, i, Tp=9.0) for i in range(40)]
    rows[17], rows[23] = sea_case("steep", 3.0, 1, Tp=6.0), replace(rows[23], offset=(50.0, 0.0, 0.0))
    pilots = accuracy._pilots(rows)
    assert pilots[:2] == [17, 23] and len(pilots) == accuracy.PILOTS


def test_a_large_sample_is_drawn_at_random_and_judged_by_19_of_20():
    """Of up to 20 rows five evenly spaced, of more 20 different ones, always the same, over the whole table."""
    assert accuracy.draw_sample(list(range(20))) == [0, 4, 9, 14, 19]
    solved = list(range(3, 1003))
    drawn = accuracy.draw_sample(solved)
    assert drawn == accuracy.draw_sample(solved) and drawn != [solved[int(i)] for i in np.linspace(0, 999, 20)]
    assert len(set(drawn)) == accuracy.LARGE_SAMPLE and set(drawn) <= set(solved)
    assert min(drawn) < 150 and max(drawn) > 850
    for within, is_kept in ((20, True), (19, True), (18, False)):
        assert Accuracy(0.02, 0.01, 0.05, within, 20).is_kept is is_kept
    assert Accuracy(0.02, 0.01, 0.05, 4, 5).is_kept is False
    assert Accuracy().is_kept is None and Accuracy(0.02, 0.01).is_kept is None


FEW = 3 * 9  # runs of the pilot cases: three for each of the first seven settings, and two more


def test_the_search_has_patience_and_no_more():
    """An error that does not fall is left after PATIENCE refinements; the setting that leaves least can be taken."""
    asked = []

    def run(numbered, dt, cells):
        asked.append((dt, cells))
        return [made_of(1.0, 1, i, of_mesh=0.0, of_step=0.1 * (len(asked) % 5)) for i, _ in numbered]

    dt, cells, best = accuracy.choose_setting(SEAS, 1e-9, run, takes_best=True)
    assert len(asked) <= FEW and best.promised > best.tolerance and (dt, cells) in asked
    failing = lambda numbered, dt, cells: [CaseResult(i, "made", "STEP_FAILED", "at t = 3 s") for i, _ in numbered]
    with pytest.raises(ConvergenceError, match="at t = 3 s"):
        accuracy.choose_setting(SEAS, 1e-9, failing, takes_best=True)
