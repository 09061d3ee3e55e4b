"""Which tests show what a section says: links from the page's claims to the rows of the table of tests."""

from __future__ import annotations

from dataclasses import dataclass

from .claims import Question, claim_id, file_id, find

SHOWN_BY = {
    "regimes": (
        "catenary/test_exact.py::test_forces_equal_the_reference_table",
        "catenary/test_exact.py::test_stiffness_equals_the_reference_table",
        "catenary/test_exact.py::test_random_lines",
        "catenary/test_exact.py::test_any_line_over_a_seabed_agrees_with_50_digits",
    ),
    "work-precision": (
        "catenary/test_exact.py::test_few_evaluations_from_no_guess",
        "catenary/test_cross_solver.py::test_batch_and_scalar_share_the_meaning_of_tolerance",
    ),
    "map": ("catenary/test_limits.py", "suite/test_stability.py::test_spans_at_the_limits_against_50_digits"),
    "speed": ("catenary/test_cross_solver.py::test_batch_equals_scalar_on_the_reference_table",
              "catenary/test_cross_solver.py::test_rows_do_not_know_their_neighbours"),
    "networks": (
        "network/test_solve.py::test_small_networks_to_40_digits",
        "network/test_solve.py::test_methods_agree",
        "network/test_solve.py::test_random_networks_from_no_guess",
        "network/test_jacobian.py::test_network_derivatives",
        "network/test_properties.py",
    ),
    "msqs-table2": (
        "network/test_solve.py::test_two_line_example_to_every_digit",
        "network/test_solve.py::test_from_the_start_of_the_paper",
    ),
    "rest": (
        "cable/test_statics.py::test_box_scheme_converges_to_the_catenary",
        "cable/test_statics.py::test_shooting_agrees_with_the_truth",
    ),
    "orders": (
        "cable/test_order.py::test_order_in_ds",
        "cable/test_order.py::test_order_in_dt",
        "cable/test_order.py::test_order_in_ds_and_dt_together",
        "cable/test_order.py::test_planted_orders_are_found",
    ),
    "settling": ("time_domain/test_solve.py::test_the_motion_becomes_periodic",),
    "drift": ("time_domain/test_solve.py::test_the_fairlead_stays_where_it_is_prescribed",),
    "dynamics": (
        "cable/test_exact.py::test_the_vector_form_gives_the_rows_of_the_paper",
        "time_domain/test_solve.py::test_the_converged_line_meets_the_reference",
        "time_domain/test_solve.py::test_frequencies_of_the_oc3_line_in_water",
        "cable/test_jacobian.py",
    ),
    "harmonic": (
        "harmonic_balance/test_solve.py::test_refined_time_integration_is_the_response",
        "harmonic_balance/test_solve.py::test_case_1_converges_to_the_independent_reference",
        "harmonic_balance/test_solve.py::test_convergence_in_nodes_is_of_second_order",
        "harmonic_balance/test_jacobian.py",
        "harmonic_balance/test_oscillators.py",
    ),
    "table2": ("harmonic_balance/test_solve.py::test_paper_cases_converge_from_zero",),
    "constant": (
        "harmonic_balance/test_solve.py::test_table_of_the_constant_term",
        "harmonic_balance/test_solve.py::test_the_constant_term_explains_fig_8",
        "harmonic_balance/test_solve.py::test_9_m_without_the_constant_shows_the_papers_zero_tension",
    ),
    "needed": ("harmonic_balance/test_solve.py::test_needed_harmonics",
               "harmonic_balance/test_solve.py::test_four_samples_a_harmonic_are_enough"),
    "limit": ("harmonic_balance/test_solve.py::test_compression_is_named",
              "harmonic_balance/test_solve.py::test_a_motion_too_large_is_named"),
    "published": (
        "suite/test_published.py::test_openfast_summary_to_its_printed_digits",
        "suite/test_published.py::test_two_line_example_line_by_line",
    ),
    "errata": ("suite/test_published.py::test_every_erratum_has_its_test",),
    "stability": (
        "suite/test_stability.py::test_networks_with_a_stiffness_contrast",
        "suite/test_stability.py::test_time_domain_at_the_limits",
        "suite/test_stability.py::test_harmonic_balance_at_the_limits",
        "suite/test_stability.py::test_lost_tension_is_never_a_success",
        "suite/test_stability.py::test_a_spoiled_success_is_found",
    ),
    "defects": ("suite/test_defects.py::test_planted_defects_are_found", "catenary/test_checks.py"),
    "scenes": ("io/test_scene.py::test_every_key_arrives",),
}  # fmt: skip
"""Section of the page -> tests by file and name, or a whole file."""


@dataclass(frozen=True)
class Link:
    """label : file and name; anchor : id of its row, or of the file's entry, in the table of tests; state : outcome."""

    label: str
    anchor: str
    state: str


def link(test: str, found: list[Question]) -> Link:
    """Raises KeyError where there is no such test: a claim without its test must not be printed."""
    module, _, name = test.partition(".py")
    name = name.removeprefix("::")
    question = next((q for q in found if q.module == module), None)
    claim = find(found, test) if name else None
    if question is None or (name and claim is None):
        raise KeyError(f"no such test: {test}")
    if claim:
        return Link(test, claim_id(module, name), claim.state)
    state = "failed" if question.total("failed") else "passed" if question.total("passed") else "not run"
    return Link(test, file_id(module), state)


def links(found: list[Question]) -> dict[str, list[Link]]:
    """Section -> links, for all sections."""
    return {section: [link(test, found) for test in tests] for section, tests in SHOWN_BY.items()}
