"""Defects of response curves and of the stability of responses: family, bordered, continuation, curve, floquet."""

from __future__ import annotations

from ..tools.planting import Fault
from .defect import Defect

_FOLDS = "stability/test_curve.py::test_folds_do_not_depend_on_the_way"
_SHOOTING = "stability/test_curve.py::test_folds_are_those_of_shooting"
_ROWS = "stability/test_curve.py::test_the_bordered_solution_meets_every_row"
_LINEAR = "stability/test_curve.py::test_linear_oscillators_follow_their_transfer_function"
_DERIVATIVE = "stability/test_curve.py::test_derivatives_by_the_parameter"
_STABILITY = "stability/test_curve.py::test_stability_changes_at_folds"
_END = "stability/test_curve.py::test_a_curve_says_where_it_ends"
_BACK = "stability/test_curve.py::test_a_curve_that_comes_back_to_its_start_says_so"
_KINK = "stability/test_curve.py::test_a_line_is_followed_through_kinks"
_MEISSNER = "stability/test_floquet.py::test_meissner_in_closed_form"
_ORDER = "stability/test_floquet.py::test_meissner_is_of_fifth_order"
_ROADS = "stability/test_floquet.py::test_liouville_and_two_roads_on_a_nonlinear_orbit"
_TOWED = "stability/test_floquet.py::test_rows_that_prescribe_a_velocity_have_their_multiplier_taken_out"
_LINE_MODES = "stability/test_floquet.py::test_a_line_at_rest_swings_in_its_natural_modes"
_LINE_DECAYS = "stability/test_floquet.py::test_drag_damps_every_disturbance_of_a_moving_line"
_MATHIEU = "stability/test_floquet.py::test_mathieu_on_its_transition_curves"
_LINE = "stability/test_curve.py::test_a_line_ends_where_it_is_solved_directly -k frequency"


def _defect(name, module, function, old, new, kind, what, check, **place):
    return Defect(name, Fault(f"stability.{module}", function, old, new, **place), kind, what, check)


DEFECTS: tuple[Defect, ...] = (
    _defect(
        "curve-derivative-one-sided-share", "family", "HarmonicFamily.derivative", "(2 * h)", "h", "factor",
        "a central difference divided by one step in place of two", _DERIVATIVE,
    ),
    _defect(
        "curve-frequency-kept", "family", "build_family", "replace(motion, frequency=value)", "replace(motion)",
        "input", "the motion keeps its frequency whatever the parameter is", _LINE,
    ),
    _defect(
        "border-column-on-the-right", "bordered", "_with_parameter", "wide[0, :, :n, n] = by_cells",
        "wide[0, :, :n, n] = -by_cells", "sign", "the column of the parameter with another sign in the cells", _ROWS,
    ),
    _defect(
        "border-means-without-parameter", "bordered", "_with_parameter", "full[:k, -1, n] = by_border",
        "full[:k, -1, n] = 0.0", "term",
        "the means of the drift as if they did not depend on the parameter", _ROWS,
    ),
    _defect(
        "bordering-sign", "bordered", "_solve_twice", "dx - dp * by_column", "dx + dp * by_column", "sign",
        "the part of the parameter added to the solution of the bordering algorithm", _ROWS,
    ),
    _defect(
        "fold-at-the-next-point", "continuation", "Tracer.fold", "min(points.values(), key=lambda p: abs(p.u))",
        "after", "regime", "the point after a fold for the fold itself", _FOLDS,
    ),
    _defect(
        "fold-loosely-located", "continuation", "", "FOLD_STEP = 1e-6", "FOLD_STEP = 1e-1", "tolerance",
        "the place of a fold along the curve to a tenth of a step", _SHOOTING,
    ),
    _defect(
        "curve-without-newton", "continuation", "Tracer.correct", "size <= self.tolerance", "size <= 1e-3",
        "tolerance", "points corrected to 1e-3 alone", _LINEAR,
    ),
    _defect(
        "curve-leads-back", "continuation", "Tracer._tangent", "along * u", "-along * u", "sign",
        "the first tangent leads away from the stop", _LINEAR,
    ),
    _defect(
        "curve-goes-on-where-states-are-invalid", "curve", "_Curve._checked", "invalid is not None", "False", "regime",
        "states that are invalid are points of the curve", _END,
    ),
    _defect(
        "curve-harmonic-index", "curve", "ResponseCurve.harmonic", "z[:, 2 * k]", "z[:, 2 * k + 1]", "index",
        "the sine of the next harmonic for the cosine of this one", _LINEAR,
    ),
    _defect(
        "curve-passes-its-start", "curve", "_Curve._next", "Status.CURVE_RETURNED", "Status.SUCCESS", "regime",
        "a curve that came back to its start said to have reached its stop", _BACK,
    ),
    _defect(
        "kink-refused", "curve", "_Curve.follow", "step > KINK_STEP", "step > 0.0", "regime",
        "a kink, where a cell goes slack, ends the curve", _KINK,
    ),
    _defect(
        "fold-not-noticed", "curve", "_Curve.follow", "new.u * point.u < 0", "False", "regime",
        "no fold is located", _STABILITY,
    ),
    _defect(
        "radau-weight", "floquet", "_radau", "(296 - 169 * r) / 1800", "(296 + 169 * r) / 1800", "sign",
        "a sign in the weights of Radau IIA", _MEISSNER,
    ),
    _defect(
        "radau-node", "floquet", "_radau", "np.array([(4 - r) / 10, (4 + r) / 10, 1.0])",
        "np.array([(4 - r) / 10, (4 + r) / 10, 0.9])", "order",
        "the last stage before the end of the step", _ROADS,
    ),
    _defect(
        "monodromy-product-turned", "floquet", "monodromy",
        "np.dot(np.eye(n) + h * np.tensordot(last, rates, 1), result)",
        "np.dot(result, np.eye(n) + h * np.tensordot(last, rates, 1))", "index",
        "the matrices of the steps multiplied in another order", _MEISSNER,
    ),
    _defect(
        "gauss-weight", "floquet", "_gauss", "5 / 36 + r / 24", "5 / 36 - r / 24", "sign",
        "a sign in the weights of Gauss's scheme", _LINE_MODES,
    ),
    _defect(
        "line-without-damping", "floquet", "_tangents_of_line", "(K, C)", "(K, zero)", "term",
        "the disturbance of a line not damped by its drag", _LINE_DECAYS,
    ),
    _defect(
        "hill-sign", "floquet", "hill_exponents", "eig(J, -D)", "eig(J, D)", "sign",
        "Hill's exponents with another sign", _ROADS,
    ),
    _defect(
        "hill-series-twice", "floquet", "hill_exponents", "EDGE - 0.5", "EDGE - 1.0", "index",
        "bounds of a mean harmonic half as wide again, where some multipliers are twice", _MATHIEU,
    ),
    _defect(
        "constraint-multiplier-kept", "floquet", "floquet", "np.delete(multipliers, np.argmin(abs(multipliers - 1)))",
        "multipliers", "term", "the multiplier of a prescribed velocity kept among the others", _TOWED,
    ),
)  # fmt: skip
