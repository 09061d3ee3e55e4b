"""Defects of load cases: seas and their motion, files, integration, statistics, error control, what is kept."""

from __future__ import annotations

from functools import partial

from ..defect import defect_in

_SEA = "common/test_sea_state.py::test_"
_STATISTICS = "load_cases/test_statistics.py::test_"
_SOLVE = "load_cases/test_solve.py::test_"
_ACCURACY = "load_cases/test_accuracy.py::test_"
_FILE = "io/test_case_file.py::test_"

_defect = partial(defect_in, "")


DEFECTS = (
    _defect(
        "a sea of the wrong height", "common.motions.spectrum", "Spectrum.jonswap", "Hs**2 / 16 / made.moment(0)",
        "Hs**2 / 8 / made.moment(0)", "factor", "the energy of a sea is that of a sine of its height",
        f"{_SEA}moments_of_a_developed_sea",
    ),
    _defect(
        "moments of one order", "common.motions.spectrum", "Spectrum.moment", "x**order * y", "x * y", "symbol",
        "all moments but one are the first", f"{_SEA}moments_of_lines_are_exact",
    ),
    _defect(
        "one transform without its start", "common.motions.irregular_motion", "IrregularMotion._evaluate",
        "rows * np.exp(self._rates * first)", "rows", "term", "even times are taken to begin at zero",
        f"{_SEA}every_way_gives_the_sum",
    ),
    _defect(
        "velocity of another sign", "common.motions.irregular_motion", "IrregularMotion._rates",
        "2j * math.pi / self.repeats_after", "-2j * math.pi / self.repeats_after", "sign",
        "the waves run backwards in the exponent", f"{_SEA}every_way_gives_the_sum",
    ),
    _defect(
        "amplitudes of half the energy", "common.motions.sea_state", "SeaState.waves", "math.sqrt(2) * deviation",
        "deviation", "factor", "a sine of this amplitude has half the variance",
        f"{_SEA}a_realisation_has_the_energy_of_its_sea",
    ),
    _defect(
        "a heading between two taken as one", "common.motions.sea_state", "ResponseOperators.at",
        "(1 - share) * rows + share * self.operators[lower + 1]", "rows + share * self.operators[lower + 1]", "term",
        "between two headings operators add up", f"{_SEA}operators_between_headings_go_round",
    ),
    _defect(
        "a case without its ramp", "common.load_case", "LoadCase.whole_duration", "self.ramp + self.duration",
        "self.duration", "term", "the time of the ramp is taken from the time of the statistics",
        f"{_SOLVE}a_row_is_what_time_stepping_gives",
    ),
    _defect(
        "a short line of a table let through", "io.series.csv_columns", "_numbers", "len(cells) != len(names)",
        "len(cells) > len(names)", "input", "a row with a value missing ends in an error of the interpreter",
        "io/test_motion_file.py",
    ),
    _defect(
        "phases in degrees for radians", "io.series.sea_file", "_one_operator",
        'np.radians(columns[f"{name}_phase_deg"])', 'columns[f"{name}_phase_deg"]', "unit",
        "phases in degrees are taken for radians",
        f"{_FILE}operators_arrive_in_radians",
    ),
    _defect(
        "an empty ramp is none", "io.case_file", "_case", "case.whole_duration", "case.duration", "symbol",
        "the sea repeats before the case ends", f"{_FILE}rows_become_cases",
    ),
    _defect(
        "statistics of the ramp", "load_cases.integration", "_run", "max(first + 1 - at, 0)", "max(1 - at, 0)", "stale",
        "the motion that grows from rest is part of the statistics", f"{_SOLVE}a_row_is_what_time_stepping_gives",
    ),
    _defect(
        "a pose of the step before", "load_cases.envelope", "_Watcher.look", "self.steps[here] - self.at",
        "self.steps[here] - self.at - 1", "stale", "lines are drawn where they were a step earlier",
        f"{_SOLVE}extremes_along_the_lines_are_those_of_the_history",
    ),
    _defect(
        "an offset of the anchor's side", "load_cases.integration", "_moved", "float(a + b)", "float(a - b)", "sign",
        "offsets move the coupled points the other way", f"{_SOLVE}offset_and_current_change_the_rest",
    ),
    _defect(
        "cycles of half the range", "load_cases.statistics", "damage_equivalent_load",
        "largest * damage ** (1 / exponent)", "largest / 2 * damage ** (1 / exponent)", "factor",
        "amplitudes in place of ranges", f"{_STATISTICS}cycles_of_the_standard",
    ),
    _defect(
        "half cycles counted whole", "load_cases.statistics", "damage_equivalent_load", "(span, count)", "(span, 1.0)",
        "factor", "what is left of a history counts twice", f"{_STATISTICS}cycles_of_the_standard",
    ),
    _defect(
        "an interval of a single error", "load_cases.statistics", "WeibullFit.extreme",
        "ndtri((1 + confidence) / 2)", "ndtri(confidence)", "symbol", "a two-sided interval with one-sided quantiles",
        f"{_STATISTICS}intervals_hold_the_truth_as_often_as_they_say",
    ),
    _defect(
        "an extreme without the mean", "load_cases.results", "_extreme", "float(tension.mean() + part)", "float(part)",
        "term", "extremes are those over the mean",
        f"{_SOLVE}a_linear_line_has_rayleigh_maxima_and_the_damage_of_a_narrow_band",
    ),
    _defect(
        "an error of the step alone", "load_cases.accuracy", "choose_setting", "by_step + by_mesh", "by_step", "term",
        "the mesh is never refined", f"{_ACCURACY}the_search_ends_where_the_estimate_does",
    ),
    _defect(
        "rows in the order of their ends", "load_cases.solve", "solve_load_cases",
        "tuple(done[i] for i in range(len(rows)))", "tuple(done[i] for i in reversed(range(len(rows))))", "index",
        "results stand beside the wrong cases", f"{_SOLVE}a_bad_row_spoils_no_other",
    ),
    _defect(
        "rows of other settings taken", "load_cases.solve", "_Kept.known", "fingerprint(self.given, self.settings)",
        "fingerprint(self.given)", "stale", "a resumed table mixes two settings",
        f"{_SOLVE}rows_of_other_inputs_are_not_taken",
    ),
    _defect(
        "arrays that all look alike", "load_cases.fingerprint", "_add", "np.ascontiguousarray(value).tobytes()", 'b""',
        "input", "systems that differ in an array have one digest", f"{_SOLVE}fingerprints_tell_inputs_apart",
    ),
    _defect(
        "a touchdown away from itself", "mooring.lines.mesh", "_surplus",
        "segment.length - s if segment.reversed else s", "s if segment.reversed else segment.length - s", "sign",
        "nodes stand close at the other end of the line",
        "mooring/test_model.py::test_a_touchdown_mesh_is_dense_where_the_touchdown_travels",
    ),
    _defect(
        "usual names of columns not looked up", "io.series.csv_columns", "_check_names",
        'describe_likely_key(name, known, "columns") if isinstance(known, dict) else _nearest(name, known)',
        "_nearest(name, known)", "input", "peak_period is said to be period, the nearest in letters",
        f"{_FILE}an_unknown_column_gets_the_nearest_one",
    ),
)  # fmt: skip
