"""Defects of the single line: catenary*, newton (monotone), elementary."""

from __future__ import annotations

from ...tools.planting import Fault
from ..defect import Defect

_STEPS = "catenary/test_jacobian.py::test_newton_steps_agree_with_complex_step"
_IMPLICIT = "catenary/test_jacobian.py::test_stiffness_agrees_with_complex_step"
_CENTRAL = "catenary/test_jacobian.py::test_stiffness_agrees_with_central_differences"
_PARALLEL = "catenary/test_exact.py::test_parallel_catenary_with_stretch"
_PROFILE = "catenary/test_invariants.py::test_profile_equals_the_50_digit_profile"
_ENDS = "catenary/test_invariants.py::test_profile_ends_at_the_ends"
_BALANCE = "catenary/test_invariants.py::test_the_whole_line_is_in_equilibrium"

DEFECTS = (
    # ------------------------------------------------------------ catenary_regimes
    Defect(
        "stretch counted twice in the height",
        Fault("catenary.suspended", "_suspended_angle", "e / 2 / s * c", "e / s * c"),
        "factor",
        "(2.4b) with w L/EA for its half: the vertical stretch of a suspended line is twice too large",
        _PARALLEL,
    ),
    Defect(
        "no stretch in the reach",
        Fault("catenary.suspended", "_suspended_state", "2 * y + e", "2 * y"),
        "term",
        "(2.4a) without H L/EA",
        _PARALLEL,
    ),
    Defect(
        "Newton step without its first part",
        Fault(
            "catenary.suspended",
            "_suspended_step",
            "from_height + (cosh_excess(f, y, s, c) + e / 2 * c) / (y + e / 2) * (y / s)",
            "(cosh_excess(f, y, s, c) + e / 2 * c) / (y + e / 2) * (y / s)",
        ),
        "derivative",
        "d log l/d log y of a suspended line leaves out how sqrt(1 - v^2) falls",
        _STEPS,
    ),
    Defect(
        "series of y cosh y - sinh y",
        Fault("catenary.regimes", "cosh_excess", "y2 / 28", "y2 / 20"),
        "factor",
        "a coefficient of the series near y = 0: stiffness and steps of taut lines lose digits",
        _STEPS,
    ),
    Defect(
        "coupling stiffness does not change sign",
        Fault("catenary.suspended", "_suspended_state", "up * 2", "2"),
        "sign",
        "K12 of a line that hangs down from its anchor has the sign of one that rises",
        _CENTRAL,
    ),
    Defect(
        "determinant counts the stretch twice",
        Fault("catenary.suspended", "_suspended_state", "C11 + X - e * over_q", "C11 + X"),
        "term",
        "the determinant of the compliance keeps a term that is in both of its factors",
        _IMPLICIT,
    ),
    Defect(
        "steepest line twice as steep",
        Fault(
            "catenary.suspended",
            "_largest_y",
            "f.log1p(e / -spare_height(height, e)) / 2",
            "f.log1p(e / -spare_height(height, e))",
        ),
        "factor",
        "y_max of over-stretched steep lines without its half",
        "catenary/test_limits.py::test_a_narrow_line_tends_to_the_vertical_one",
    ),
    Defect(
        "cosh p of a grounded line",
        Fault(
            "catenary.regimes",
            "_grounded_forces",
            "rise, slope = (2 * s * s, 2 * s * f.sqrt(1 + s * s))",
            "rise, slope = (2 * s * s, 2 * s)",
        ),
        "term",
        "sinh p = 2 sinh(p/2) cosh(p/2) without its cosh",
        "catenary/test_exact.py::test_half_catenary_on_the_seabed",
    ),
    Defect(
        "drag along the whole grounded part",
        Fault("catenary.regimes", "friction_stretch", "H - drag / 2", "H - drag"),
        "factor",
        "(2.19): the mean of a tension that falls linearly taken for its least value",
        _ENDS,
    ),
    Defect(
        "friction term of dl/dV as printed",
        Fault(
            "catenary.regimes",
            "friction_stretch",
            "stretch, f.where(pulled, grounded, limit), f.where(pulled, drag, H)",
            "stretch, f.where(pulled, grounded, limit), drag",
        ),
        "misprint",
        "(4.16a): CB (L - V/w)/EA also where the tension ends before the anchor",
        _IMPLICIT,
        misprint="MSQS (4.16a)",
    ),
    Defect(
        "friction of a lying line",
        Fault("catenary.regimes", "lying_force", "2 * CB", "CB"),
        "factor",
        "H of a line that friction holds: the root without its 2",
        "catenary/test_exact.py::test_line_stretched_along_the_seabed",
    ),
    Defect(
        "part of a slack line on the seabed",
        Fault("catenary.regimes", "slack_state", "1 - V + V_anchor", "1 - V - V_anchor"),
        "sign",
        "the part hanging from a raised anchor is added to what rests",
        "catenary/test_exact.py::test_slack_line_over_a_raised_anchor",
    ),
    Defect(
        "folded line without stretch",
        Fault("catenary.regimes", "vertical_state", "height / (2 + e)", "height / 2"),
        "term",
        "the two parts of a folded vertical line do not stretch",
        "catenary/test_exact.py::test_vertical_line",
    ),
    Defect(
        "pendulum stiffness of a spring",
        Fault(
            "catenary.regimes",
            "massless_state",
            "f.where(T > 0, 1.0, 0.0), T / f.maximum(chord, TINY)",
            "f.where(T > 0, 1.0, 0.0), T",
        ),
        "unit",
        "stiffness across a straight spring is T/chord, not T",
        "catenary/test_limits.py::test_a_light_line_tends_to_the_spring",
    ),
    Defect(
        "sag without its stretch",
        Fault(
            "catenary.regimes",
            "lowest_point",
            "1 / (f.sqrt(H * H + b * b) + H + TINY) + e / 2",
            "1 / (f.sqrt(H * H + b * b) + H + TINY)",
        ),
        "regime",
        "a soft line over a raised anchor touches the seabed later than it should",
        "catenary/test_limits.py::test_forces_are_continuous_across_a_boundary",
    ),
    Defect(
        "sign in the compliance of an end",
        Fault("catenary.regimes", "_end_compliance", "-V", "V"),
        "sign",
        "d(reach)/dV of a hanging end: pulling up lengthens what hangs instead of shortening its reach",
        _STEPS,
    ),
    Defect(
        "Schur complement of the raised anchor added",
        Fault(
            "catenary.regimes",
            "grounded_state",
            "F11 + A11 - A12 * A12 / f.where(A22 > 0, A22, 1.0)",
            "F11 + A11 + A12 * A12 / f.where(A22 > 0, A22, 1.0)",
        ),
        "sign",
        "the anchor end keeps its height: its V is eliminated with the wrong sign",
        _IMPLICIT,
    ),
    Defect(
        "length that hangs",
        Fault("catenary.regimes", "hanging_length", "2 * e * h", "e * h"),
        "factor",
        "h = s + e s^2/2 solved with e for 2 e",
        "catenary/test_exact.py::test_slack_line_hangs_straight_down",
    ),
    # ------------------------------------------------------------ catenary_solve
    Defect(
        "buoyant line not turned over",
        Fault("catenary.solve", "_nondimensional", "up * z / L", "z / L"),
        "sign",
        "a buoyant line is the mirror image of a heavy one, its height left as it was",
        "catenary/test_invariants.py::test_a_buoyant_line_is_the_mirror_image",
    ),
    Defect(
        "stiffness in N",
        Fault("catenary.solve", "solve", "force / L", "force"),
        "unit",
        "K11 and K22 are not divided by the length",
        _CENTRAL,
    ),
    Defect(
        "touchdown of an inextensible line",
        Fault("catenary.regimes", "rests_from_anchor", "h - e / 2", "h"),
        "regime",
        "whether the line just touches is decided without its stretch",
        "catenary/test_limits.py::test_touchdown_has_the_weight_of_the_line",
    ),
    Defect(
        "no line rests between raised ends",
        Fault("catenary.regimes", "sags_to_seabed", "c > 0", "c > 1"),
        "regime",
        "lines over a seabed with a raised anchor hang through it",
        "catenary/test_limits.py::test_forces_are_continuous_across_a_boundary",
    ),
    Defect(
        "undetermined friction answered",
        Fault("catenary.solve", "solve", "(regime == SAGGING) & (CB > 0)", "(regime == SAGGING) & (CB > 1e9)"),
        "regime",
        "friction under a line between two raised ends is a number instead of a status",
        "common/test_failures.py::test_undetermined_friction_is_an_error",
    ),
    Defect(
        "ends of a sagging line exchanged",
        Fault("catenary.solve", "_sagging", "h < 0", "h > 0"),
        "symbol",
        "the forces of the higher end go to the lower one",
        "catenary/test_exact.py::test_a_line_that_rests_between_raised_ends",
    ),
    Defect(
        "whatever stops has converged",
        Fault(
            "catenary.solve",
            "solve",
            "f.where(converged, SUCCESS, NOT_CONVERGED)",
            "f.where(converged, SUCCESS, SUCCESS)",
        ),
        "tolerance",
        "an iteration that ran out of steps is a success",
        "numerics/test_newton.py::test_a_line_whose_iteration_runs_out_of_steps_is_not_converged",
    ),
    # ------------------------------------------------------------ catenary
    Defect(
        "blocks of rows on top of each other",
        Fault("catenary.span", "solve_spans", "first + rows", "rows"),
        "index",
        "results of every block of the batch go to the rows of the first",
        "catenary/test_cross_solver.py::test_blocks_do_not_show",
    ),
    Defect(
        "tension from the anchor's force",
        Fault("catenary.span", "CatenaryState.tension", "self.V", "self.V_anchor"),
        "symbol",
        "the tension at the fairlead is that of the other end",
        _ENDS,
    ),
    Defect(
        "clearance without a seabed let through",
        Fault("catenary.span", "_valid_rows", "clearance == 0", "clearance >= 0"),
        "input",
        "the batch takes what the single line refuses",
        "common/test_failures.py::test_bad_rows_are_refused_as_span_refuses_them",
    ),
    Defect(
        "tolerance of a millionth",
        Fault("catenary.span", "", "4 * np.finfo(float).eps", "1e-6 + 0 * np.finfo(float).eps"),
        "tolerance",
        "the iteration stops at six digits and says that it is done",
        "catenary/test_exact.py::test_half_catenary_on_the_seabed",
    ),
    # ------------------------------------------------------------ catenary_profile
    Defect(
        "profile on the seabed as printed",
        Fault("catenary.profile", "_resting", "np.maximum(s - x0, 0)", "np.maximum(0 * s - x0, 0)"),
        "misprint",
        "(2.18): the second integral ends at 0 and not at s",
        _PROFILE,
        misprint="MSQS (2.18)",
    ),
    Defect(
        "weight of the whole piece at its middle",
        Fault("catenary.profile", "_hanging", "rise / 2", "rise"),
        "factor",
        "stretch of the height by the tension at the end of a piece, not by its mean",
        _PROFILE,
    ),
    Defect(
        "resting part unstretched",
        Fault("catenary.profile", "_resting", "s + state.H * s / span.EA", "s"),
        "term",
        "without friction the part on the seabed does not stretch",
        _ENDS,
    ),
    Defect(
        "piece at the raised anchor",
        Fault("catenary.profile", "profile", "-state.V_anchor", "state.V_anchor"),
        "sign",
        "the length that hangs from a raised anchor is negative",
        _PROFILE,
    ),
    # ------------------------------------------------------------ newton, elementary
    Defect(
        "bracket turned round",
        Fault(
            "numerics.newton",
            "_advance",
            "lo = f.where(g > 0, t, lo)\nhi = f.where(g < 0, t, hi)",
            "lo = f.where(g < 0, t, lo)\nhi = f.where(g > 0, t, hi)",
        ),
        "sign",
        "the bracket of a decreasing function shrinks around the wrong side",
        "catenary/test_exact.py::test_half_catenary_on_the_seabed",
    ),
    Defect(
        "step taken for small too soon",
        Fault(
            "numerics.newton",
            "_advance",
            "(abs(g) <= tolerance) | (abs(step) <= tolerance)",
            "(abs(g) <= tolerance) | (abs(step) <= 1e-4)",
        ),
        "tolerance",
        "the iteration ends one step early: four digits are kept, or eight where Newton's method is at its best",
        "catenary/test_exact.py::test_half_catenary_on_the_seabed",
    ),
    Defect(
        "finished rows come back",
        Fault(
            "numerics.newton",
            "monotone_roots",
            "rows[left], t[left], lo[left], hi[left]",
            "rows[left], t[left], lo[left], hi[: left.size]",
        ),
        "index",
        "rows that go on in a batch get the bracket of others",
        "catenary/test_cross_solver.py::test_batch_equals_scalar_on_random_lines",
    ),
    Defect(
        "parameters of finished rows",
        Fault(
            "numerics.newton", "monotone_roots", "(p[left] for p in parameters)", "(p[: left.size] for p in parameters)"
        ),
        "stale",
        "rows that go on in a batch are solved with the parameters of finished ones",
        "catenary/test_cross_solver.py::test_batch_equals_scalar_on_the_reference_table",
    ),
    Defect(
        "arsinh by its logarithm",
        Fault(
            "numerics.elementary",
            "",
            "lambda x: float(np.arcsinh(x))",
            "lambda x: float(np.log(x + np.hypot(x, 1.0)))",
        ),
        "symbol",
        "one line and a batch differ in the last bit",
        "catenary/test_cross_solver.py::test_batch_equals_scalar_on_random_lines",
    ),
    Defect(
        "both branches swapped for floats",
        Fault(
            "numerics.elementary",
            "",
            "lambda condition, a, b: a if condition else b",
            "lambda condition, a, b: b if condition else a",
        ),
        "symbol",
        "where() of a single line takes the branch that is not meant",
        "catenary/test_exact.py::test_catenary_of_parameter_one",
    ),
    # ------------------------------------------------------------ declared blind spots
    Defect(
        "start of slack lines",
        Fault("catenary.suspended", "suspended_start", "6 * slack + slack * slack", "6 * slack"),
        "factor",
        "the start of the iteration for slack suspended lines",
        "catenary/test_exact.py catenary/test_invariants.py::test_profile_ends_at_the_ends "
        "-k 'not 50_digits and not random_lines'",
        blind="a start only decides how many evaluations a root takes, and these stay within the budget of eight",
    ),
    Defect(
        "rows leave the batch later",
        Fault("numerics.newton", "monotone_roots", "0.75 * rows.size", "0.25 * rows.size"),
        "factor",
        "when finished rows are taken out of the work of a batch",
        "catenary/test_cross_solver.py",
        blind="a finished row keeps its value while it waits, so only the time of a batch changes",
    ),
)
