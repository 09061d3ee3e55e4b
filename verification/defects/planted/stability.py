"""Defects of response curves, of their special points and branches."""

from __future__ import annotations

from functools import partial

from ...tools.planting import Fault
from ..defect import Defect, defect_in

_FOLDS = "stability/test_curve.py::test_folds_do_not_depend_on_the_way"
_SHOOTING = "stability/test_curve.py::test_folds_are_those_of_shooting"
_ROWS = "stability/test_curve.py::test_the_bordered_solution_meets_every_row"
_LINEAR = "stability/test_curve.py::test_linear_oscillators_follow_their_transfer_function"
_DERIVATIVE = "stability/test_curve.py::test_derivatives_by_the_parameter"
_STABILITY = "stability/test_curve.py::test_stability_changes_at_folds"
_END = "stability/test_curve.py::test_a_curve_says_where_it_ends"
_BACK = "stability/test_curve.py::test_a_curve_that_comes_back_to_its_start_says_so"
_KINK = "stability/test_curve.py::test_a_line_is_followed_through_kinks"
_LINE = "stability/test_curve.py::test_a_line_ends_where_it_is_solved_directly -k frequency"
_STEPS = "stability/test_special_points.py::test_special_points_do_not_depend_on_the_steps -k '{}'"
_MIRRORED = "stability/test_special_points.py::test_both_sides_of_a_broken_symmetry"
_CHANGES = "stability/test_special_points.py::test_stability_changes_where_special_points_are"
_JUMP = "stability/test_special_points.py::test_a_jump_from_below_what_is_known_is_a_jump"
_DOUBLED = "stability/test_special_points.py::test_a_doubled_branch_leads_to_the_next_doubling"
_CIRCLE = "stability/test_special_points.py::test_multipliers_that_stay_on_the_circle_pass_nothing"
_RESUMED = "stability/test_resume.py::test_an_interrupted_curve_goes_on_bit_for_bit"
_TANGENT = "stability/test_resume.py::test_the_tangent_is_of_unit_length_in_the_weights_of_its_state"
_SERIES = "stability/test_resume.py::test_a_fold_of_the_series_alone_is_not_a_special_point"
_UNRESOLVED = "stability/test_resume.py::test_points_that_many_harmonics_would_change_are_unresolved"
_ACROSS = "stability/test_resume.py::test_a_planar_response_that_grows_sideways_is_not_stable"
_FILE = "stability/test_resume.py::test_a_curve_goes_on_from_its_file"
_ERRORS = "stability/test_resume.py::test_errors_are_those_against_many_harmonics"
_ACCURACY = "stability/test_resume.py::test_harmonics_follow_the_accuracy"
_BODY = "stability/test_resume.py::test_the_frequency_of_a_body_that_carries_a_line"
_LURE = "stability/test_known_curves.py::test_the_period_doubling_of_lures_system"
_AT_STOP = "stability/test_known_curves.py::test_a_fold_at_the_stop_ends_the_curve"
_SINGULAR = "stability/test_known_curves.py::test_a_start_at_a_fold_is_singular"
_REFUSED = "stability/test_curve.py::test_a_parameter_that_leaves_its_physical_range_ends_the_curve"

_SIDEWAYS = "stability/test_special_points.py::test_a_branch_leaves_the_plane_of_a_taut_cable"
_BASINS = "stability/test_basins.py::test_starts_land_where_another_integrator_has_them"
_WILSON = "stability/test_basins.py::test_intervals_solve_wilsons_equation"
_BRANCHES = "stability/test_basins.py::test_responses_at_a_value_are_those_of_the_curve"

_defect = partial(defect_in, "stability")


DEFECTS: tuple[Defect, ...] = (
    _defect(
        "curve-derivative-one-sided-share", "curves.family", "HarmonicFamily.derivative", "(2 * h)", "h", "factor",
        "a central difference divided by one step in place of two", _DERIVATIVE,
    ),
    _defect(
        "curve-frequency-kept", "curves.family", "_tunable", "replace(motion, frequency=value)", "replace(motion)",
        "input", "the motion keeps its frequency whatever the parameter is", _LINE,
    ),
    _defect(
        "border-column-on-the-right", "curves.bordered", "_with_parameter", "wide[0, :, :n, n] = by_cells",
        "wide[0, :, :n, n] = -by_cells", "sign", "the column of the parameter with another sign in the cells", _ROWS,
    ),
    _defect(
        "border-means-without-parameter", "curves.bordered", "_with_parameter", "full[:k, -1, n] = by_border",
        "full[:k, -1, n] = 0.0", "term",
        "the means of the drift as if they did not depend on the parameter", _ROWS,
    ),
    _defect(
        "bordering-sign", "curves.bordered", "_solve_twice", "dx - dp * by_column", "dx + dp * by_column", "sign",
        "the part of the parameter added to the solution of the bordering algorithm", _ROWS,
    ),
    _defect(
        "fold-at-the-next-point", "curves.special_points", "_locate_fold",
        "min(segment.points, key=lambda s: abs(segment.points[s].u))", "segment.length", "regime",
        "the point after a fold for the fold itself", _FOLDS,
    ),
    _defect(
        "fold-loosely-located", "curves.special_points", "", "FOLD_STEP = 1e-6", "FOLD_STEP = 1e-1", "tolerance",
        "the place of a fold along the curve to a tenth of a step", _SHOOTING,
    ),
    _defect(
        "curve-without-newton", "curves.continuation", "Tracer.correct", "size <= self.tolerance", "size <= 1e-3",
        "tolerance", "points corrected to 1e-3 alone", _LINEAR,
    ),
    _defect(
        "curve-leads-back", "curves.continuation", "Tracer._tangent", "along * u", "-along * u", "sign",
        "the first tangent leads away from the stop", _LINEAR,
    ),
    _defect(
        "curve-goes-on-where-states-are-invalid", "curves.tracing", "CurveTrace._checked", "invalid is not None",
        "False",
        "regime", "states that are invalid are points of the curve", _END,
    ),
    _defect(
        "curve-harmonic-index", "curves.curve", "ResponseCurve.harmonic", "z[:, 2 * k]", "z[:, 2 * k + 1]", "index",
        "the sine of the next harmonic for the cosine of this one", _LINEAR,
    ),
    _defect(
        "curve-passes-its-start", "curves.tracing", "CurveTrace._predicted", "Status.CURVE_RETURNED", "Status.SUCCESS",
        "regime", "a curve that came back to its start said to have reached its stop", _BACK,
    ),
    _defect(
        "kink-refused", "curves.tracing", "CurveTrace._next", "step > KINK_STEP", "step > 0.0", "regime",
        "a kink, where a cell goes slack, ends the curve", _KINK,
    ),
    _defect(
        "fold-not-noticed", "curves.special_points", "locate_special_points",
        "segment.at(0.0).u * segment.at(segment.length).u < 0", "False", "regime",
        "no fold is located", _STABILITY,
    ),
    _defect(
        "body-frequencies-alike", "curves.family", "_tunable", "value * times[name]", "value", "factor",
        "translation and rotation of a body at one frequency", _BODY,
    ),
    _defect(
        "doubled-harmonics-misplaced", "curves.family", "double_period", "z[..., 2::2]", "-z[..., 2::2]", "sign",
        "cosines of a response with another sign once its period is doubled", _DOUBLED,
    ),
    _defect(
        "doubling-by-every-harmonic", "curves.special_points", "DoublingTest.__call__",
        "z[..., 0::4], z[..., 3::4] = 0.0, 0.0", "z[..., 1::4], z[..., 2::4] = 0.0, 0.0", "index",
        "the harmonics of the period itself in the test function of a doubling", _DOUBLED,
    ),
    _defect(
        "branch-points-left-out", "curves.special_points", "_locate_branch_point", "first * test(high) > 0",
        "first * test(high) < 0", "sign", "branch points taken for folds", _MIRRORED,
    ),
    _defect(
        "branch-point-between-two-nodes", "curves.special_points", "_locate_branch_point",
        "brentq(BarycentricInterpolator(NODES, values), NODES[2], NODES[3], xtol=LOCATION)", "0.0", "order",
        "a branch point taken for the middle of its two nodes", _STEPS.format("hardening"),
    ),
    _defect(
        "neimark-sacker-loosely", "curves.special_points", "_locate_neimark_sacker",
        "_passage(segment, low, high, k)", "(low + high) / 2", "tolerance",
        "a Neimark-Sacker bifurcation to a hundredth of a step", _STEPS.format("entrained"),
    ),
    _defect(
        "crossings-not-noticed", "curves.special_points", "CurveSegment.growth_at",
        "sizes[k] if k < sizes.size else sizes.min(initial=WANTED)", "0.5", "term",
        "multipliers that never grow", _CHANGES,
    ),
    _defect(
        "unlisted-multiplier-is-zero", "curves.special_points", "CurveSegment.growth_at",
        "sizes.min(initial=WANTED)", "0.0", "regime",
        "a multiplier below those that are known taken for zero, beside which every change is small", _JUMP,
    ),
    _defect(
        "multipliers-on-the-circle-counted", "curves.special_points", "CurveSegment.set_multipliers",
        "int((_distance(values) <= NOISE).sum())", "0", "regime",
        "multipliers that rounding moves over one are bifurcations", _LURE,
    ),
    _defect(
        "circle-too-wide", "curves.special_points", "", "NOISE = 1e-6", "NOISE = 1e-12", "tolerance",
        "multipliers of a free phase taken for others", _CIRCLE,
    ),
    _defect(
        "branch-along-the-curve", "curves.switching", "switch_branch", "dx, dp = test.direction", "dx, dp = t, u",
        "regime",
        "a branch started along the curve itself", _MIRRORED,
    ),
    _defect(
        "error-without-more-harmonics", "curves.adaptivity", "estimate_error",
        "tracer.with_harmonics(more_harmonics(tracer.family.settings[0]))", "tracer", "term",
        "the error of a response by the harmonics that it has", _ERRORS,
    ),
    _defect(
        "harmonics-never-fewer", "curves.adaptivity", "needed_harmonics", "small.size", "False",
        "regime", "harmonics that are not needed are kept", _ACCURACY,
    ),
    _defect(
        "accuracy-not-asked", "curves.tracing", "CurveTrace._accurate", "error > self.accuracy", "False", "regime",
        "harmonics that an accuracy needs are not added", _ACCURACY,
    ),
    _defect(
        "tangent-not-normalised", "curves.tracing", "CurveTrace._add", "tracer.normalised(point)", "point", "factor",
        "a tangent that is of unit length in older weights alone", _TANGENT,
    ),
    _defect(
        "folds-of-the-series-reported", "curves.special_points", "explain_doubt", "kind == FOLD", "False", "regime",
        "folds of a truncated series said to be those of the motion", _SERIES,
    ),
    _defect(
        "errors-of-special-points-not-asked", "curves.special_points", "explain_doubt", "error > RESOLVED", "False",
        "regime",
        "special points that the harmonics do not resolve said to be those of the motion", _UNRESOLVED,
    ),
    _defect(
        "curve-stable-in-its-plane-alone", "curves.curve", "ResponseCurve.stable", "_are_inside(self.sideways)", "True",
        "term", "growth across the plane of a line left out of whether it is stable", _ACROSS,
    ),
    _defect(
        "resumed-with-the-first-step", "curves.tracing", "CurveTrace._advance", "step = self.points_and_state[1].step",
        "step = lengths[1]", "input", "a curve that goes on with its first step", _RESUMED,
    ),
    _defect(
        "interrupt-lost", "curves.tracing", "CurveTrace.follow", "Status.CURVE_INTERRUPTED", "Status.SUCCESS", "regime",
        "an interrupted curve said to have reached its stop", _RESUMED,
    ),
    _defect(
        "fold-at-stop-passed", "curves.tracing", "CurveTrace._next", "each.kind == FOLD", "False", "regime",
        "a curve that goes on past a fold at its stop", _AT_STOP,
    ),
    _defect(
        "start-at-a-fold", "curves.continuation", "Tracer.upright",
        "abs(self._tangent(solve, F, 1.0)[1]) / self.span < UPRIGHT", "False", "regime", "a curve started at a fold",
        _SINGULAR,
    ),
    _defect(
        "refusal-taken-for-a-short-step", "curves.tracing", "_reason", "isinstance(error, RefusedError)", "False",
        "regime", "a parameter that the system refuses said to be a short step", _REFUSED,
    ),
    Defect(
        "curve-file-without-tangent",
        Fault("io.curve_file", "load_curve", "float(numbers[key])", "0.999 * float(numbers[key])"),
        "factor", "numbers of the state changed on their way from a file", _FILE,
    ),
    _defect(
        "basins-rates-left-out", "curves.basins", "draw_start", "_rate_at(response, t)",
        "(0.0 * _rate_at(response, t))",
        "term",
        "starts that all begin from standstill", _BASINS,
    ),
    _defect(
        "basins-nearest-of-many", "curves.basins", "_Metric.nearest", "inside[0]", "0", "index",
        "whichever response is near is counted as the first", _BASINS,
    ),
    _defect(
        "wilson-interval-centre", "curves.basins", "wilson_interval", "share + z * z / (2 * count)", "share", "term",
        "an interval about the share itself, as of the normal approximation", _WILSON,
    ),
    _defect(
        "responses-of-one-crossing", "curves.basins", "responses_at",
        "np.flatnonzero((curve.values[:-1] - value) * (curve.values[1:] - value) <= 0)",
        "np.flatnonzero((curve.values[:-1] - value) * (curve.values[1:] - value) <= 0)[:1]", "index",
        "the first part of the curve alone", _BRANCHES,
    ),
    _defect(
        "branch-without-weight", "curves.switching", "_norms_beside",
        "np.where(norms > AT_REST * norms.max(), norms, norms.max())", "norms", "regime",
        "a field at rest on the curve that a step along the branch does not count", _SIDEWAYS,
    ),
)  # fmt: skip
