"""Defects of the stability of responses: Floquet multipliers, of chains and of lines."""

from __future__ import annotations

from functools import partial

from ..defect import Defect, defect_in

_MEISSNER = "stability/test_floquet.py::test_meissner_in_closed_form"
_TWO_METHODS = "stability/test_floquet.py::test_liouville_and_two_methods_on_a_nonlinear_orbit"
_TOWED = "stability/test_floquet.py::test_rows_that_prescribe_a_velocity_have_their_multiplier_taken_out"
_LINES = "stability/test_line_multipliers.py::"
_TONGUE = _LINES + "test_sideways_growth_is_that_of_mathieu"
_THRESHOLD = _LINES + "test_sideways_threshold_is_that_of_mathieu"
_STEPS = _LINES + "test_steps_are_of_their_order"
_HILL_LINE = _LINES + "test_hill_and_monodromy_agree_on_a_line_in_small_motion"
_SHORT = _LINES + "test_series_that_are_too_short_do_not_count"
_LEADING = _LINES + "test_leading_eigenvalues_are_those_of_the_whole_matrix"
_LARGEST = _LINES + "test_eigenvalues_from_a_larger_size_on_are_the_largest"
_PERIODS = _LINES + "test_the_periods_of_a_point_do_not_grow_with_the_cells"
_SOLVES = _LINES + "test_the_solves_of_hills_problem_do_not_grow_with_the_cells"
_MAP = _LINES + "test_the_linearised_steps_are_the_derivative_of_the_steps"
_SLACK = _LINES + "test_disturbances_over_slack_cells_follow_their_multiplier_in_time"
_RINGING = _LINES + "test_multipliers_of_a_ringing_series_are_those_of_another_motion"
_NO_MOTION = _LINES + "test_a_motion_that_time_steps_do_not_repeat_is_said"
_ALGEBRAIC = "stability/test_floquet.py::test_infinite_exponents_of_algebraic_rows_are_left_out"
_MATHIEU = "stability/test_floquet.py::test_mathieu_on_its_transition_curves"

_defect = partial(defect_in, "stability")
_mooring_defect = partial(defect_in, "mooring")


DEFECTS: tuple[Defect, ...] = (
    _defect(
        "radau-weight", "multipliers.monodromy", "_radau", "(296 - 169 * r) / 1800", "(296 + 169 * r) / 1800", "sign",
        "a sign in the weights of Radau IIA", _MEISSNER,
    ),
    _defect(
        "radau-node", "multipliers.monodromy", "_radau", "np.array([(4 - r) / 10, (4 + r) / 10, 1.0])",
        "np.array([(4 - r) / 10, (4 + r) / 10, 0.9])", "order",
        "the last stage before the end of the step", _TWO_METHODS,
    ),
    _defect(
        "monodromy-product-turned", "multipliers.monodromy", "monodromy",
        "np.dot(np.eye(n) + h * growth, result)", "np.dot(result, np.eye(n) + h * growth)", "index",
        "the matrices of the steps multiplied in another order", _MEISSNER,
    ),
    _defect(
        "gauss-weight", "multipliers.monodromy", "_gauss", "5 / 36 + r / 24", "5 / 36 - r / 24", "sign",
        "a sign in the weights of Gauss's scheme", _STEPS,
    ),
    _defect(
        "hill-sign", "multipliers.hill", "hill_exponents", "eig(J, -D)", "eig(J, D)", "sign",
        "Hill's exponents with another sign", _TWO_METHODS,
    ),
    _defect(
        "hill-series-twice", "multipliers.hill", "hill_exponents", "EDGE - 0.5", "EDGE - 1.0", "index",
        "bounds of a mean harmonic half as wide again, where some multipliers are twice", _MATHIEU,
    ),
    _defect(
        "constraint-multiplier-kept", "multipliers.floquet", "_of_chain",
        "np.delete(multipliers, np.argmin(abs(multipliers - 1)))",
        "multipliers", "term", "the multiplier of a prescribed velocity kept among the others", _TOWED,
    ),
    _defect(
        "dense-neighbours-swapped", "multipliers.dense", "assemble", "cells[:, i]", "cells[::-1, i]", "index",
        "the blocks of a cell's two nodes in each other's place", _TOWED,
    ),
    _defect(
        "algebraic-exponents-counted", "multipliers.floquet", "_of_chain",
        "MAX_GROWTH * response.basis.omega",
        "np.inf", "regime",
        "infinite exponents of algebraic rows, made finite by rounding, taken for growth", _ALGEBRAIC,
    ),
    _defect(
        "sideways-not-asked-for-stability", "multipliers.floquet", "FloquetResult.stable",
        "(self.multipliers, self.sideways)",
        "(self.multipliers,)", "regime",
        "a planar response that is unstable sideways called stable", _TONGUE,
    ),
    _defect(
        "slack-taken-for-smooth", "multipliers.floquet", "_of_line",
        "linearised.has_slack",
        "False", "regime",
        "the series linearised where it rings over slack cells", _RINGING,
    ),
    _defect(
        "motion-not-repeated-kept-quiet", "multipliers.floquet", "_of_line",
        "orbit.is_periodic",
        "True", "regime",
        "multipliers about a motion that time steps do not repeat, as if they did", _NO_MOTION,
    ),
    _defect(
        "hill-line-shift-turned", "multipliers.hill", "_nearest",
        "sigma - 1 / inverses",
        "sigma + 1 / inverses", "sign",
        "exponents on the other side of the shift", _HILL_LINE,
    ),
    _defect(
        "hill-line-short-series", "multipliers.hill", "line_multipliers",
        "TAIL * energy.sum(axis=0)",
        "1.0 * energy.sum(axis=0)", "tolerance",
        "exponents of series that their last harmonics cut off counted", _SHORT,
    ),
    _defect(
        "hill-line-little-space", "multipliers.hill", "",
        "LEAST_SPACE = 40",
        "LEAST_SPACE = 2", "tolerance",
        "Arnoldi's method restarted so soon that it solves more often the finer the mesh", _SOLVES,
    ),
    _defect(
        "leading-block-lost", "multipliers.leading", "_extend",
        "np.hstack([np.zeros((R.shape[0], H.shape[1])), R])",
        "np.hstack([np.zeros((R.shape[0], H.shape[1])), 0 * R])", "term",
        "what a period adds to the known disturbances left out of their matrix", _LEADING,
    ),
    _defect(
        "leading-residual-unasked", "multipliers.leading", "_block_arnoldi",
        "exact >= wanted",
        "True", "tolerance",
        "the first block's values taken as they are", _LEADING,
    ),
    _defect(
        "leading-first-not-awaited", "multipliers.leading", "_block_arnoldi",
        "max(1, int((abs(values) >= least_size).sum()))",
        "int((abs(values) >= least_size).sum())", "tolerance",
        "a largest multiplier below the least size taken as it comes", _LARGEST,
    ),
    _defect(
        "small-multipliers-awaited", "curves.tracing", "CurveTrace._all_multipliers",
        "least_size=WANTED",
        "least_size=1e-3", "tolerance",
        "waves that a period damps awaited at each point, more of them the finer the mesh", _PERIODS,
    ),
    _mooring_defect(
        "period-velocity-not-scaled-back", "linearised.monodromy", "PeriodMap.apply",
        "state /= self.units",
        "pass", "unit",
        "velocities in m/s among displacements, on the way back", _TONGUE,
    ),
    _mooring_defect(
        "period-at-the-steps-start", "linearised.monodromy", "LinearisedPeriod.__init__",
        "(np.arange(steps)[:, None] + scheme.nodes)",
        "(np.arange(steps)[:, None] + 0 * scheme.nodes)", "order",
        "stages of a step linearised at its start", _STEPS,
    ),
    _mooring_defect(
        "sideways-along", "linearised.monodromy", "disturbed_axes",
        "np.array([1])",
        "np.array([2])", "index",
        "the vertical axis for the sideways one", _THRESHOLD,
    ),
    _mooring_defect(
        "stages-without-velocity-term", "linearised.monodromy", "LinearisedPeriod.__init__",
        "right_weights[1, 0] = -self.h * scheme.nodes",
        "pass", "term",
        "the displacement that a stage's velocity makes left out", _TONGUE,
    ),
    _mooring_defect(
        "stages-squared-weights", "linearised.monodromy", "LinearisedPeriod.__init__",
        "A @ A",
        "A * A", "factor",
        "squares of the weights for the square of their matrix", _STEPS,
    ),
    _mooring_defect(
        "stages-neighbour-turned", "linearised.steps", "set_right_side",
        "add_product(1.0, first_one, c, one, first, x, last)",
        "add_product(1.0, first_one, c, one, last, x, last)", "index",
        "a node pulled by itself in place of its neighbour", _TONGUE,
    ),
    _mooring_defect(
        "columns-for-rows", "linearised.steps", "solve_columns",
        "add_product(-1.0, upper, order.edge[a], x, order.other[a], column, 0)",
        "add_product(-1.0, lower, order.edge[a], x, order.other[a], column, 0)", "index",
        "the blocks of the columns for those of the rows on the way back", _MAP,
    ),
    _mooring_defect(
        "newmark-filter-turned", "linearised.steps", "take_newmark_steps",
        "alpha_m * old",
        "-alpha_m * old", "sign",
        "the old algorithmic acceleration with another sign", _MAP,
    ),
    _mooring_defect(
        "newmark-velocity-weight", "linearised.steps", "take_newmark_steps",
        "v[i, j, k] += w_v * force[i, j, k]",
        "v[i, j, k] += w_v * h * force[i, j, k]", "factor",
        "a velocity of the step in other units", _MAP,
    ),
    _mooring_defect(
        "newmark-mass-left-out", "linearised.steps", "set_right_side",
        "add_product(1.0, own_other, i, other, i, x, i)",
        "pass", "term",
        "the inertia of the known acceleration left out", _MAP,
    ),
    _mooring_defect(
        "orbit-without-newton", "linearised.stepped_orbit", "",
        "DAMPING = (1.0, 0.5, 0.25, 0.125)",
        "DAMPING = ()", "regime",
        "periods taken one after another, which an unstable motion leaves", _SLACK,
    ),
    _mooring_defect(
        "orbit-loosely-periodic", "linearised.stepped_orbit", "",
        "PERIODIC = 1e-8",
        "PERIODIC = 1e-1", "tolerance",
        "a motion that changes by a tenth over a period called periodic", _NO_MOTION,
    ),
    _mooring_defect(
        "hill-coriolis-once", "periodic.hill", "LineHill.__init__",
        "2 * own[2]",
        "own[2]", "factor",
        "the masses' part of D once in place of twice", _HILL_LINE,
    ),
    _mooring_defect(
        "hill-shift-without-mass", "periodic.hill", "LineHill.inverse",
        "diagonal += sigma**2 * self.M",
        "diagonal += 0 * self.M", "term",
        "the shifted pencil without its masses", _HILL_LINE,
    ),
    _mooring_defect(
        "start-changed-in-place", "stepping.time_domain", "_initial_state",
        "np.array(y.T, order=\"C\"), np.array(ydot.T, order=\"C\")",
        "np.ascontiguousarray(y.T), np.ascontiguousarray(ydot.T)", "stale",
        "the state that an integration starts from changed with it",
        "mooring/test_time_domain.py::test_a_start_is_not_changed",
    ),
)  # fmt: skip
