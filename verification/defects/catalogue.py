"""All seeded defects, the checks they are shown to, and which of these compare with numbers kept on file."""

from __future__ import annotations

from .cables import DEFECTS as CABLES
from .defect import Defect
from .dynamics import DEFECTS as DYNAMICS
from .networks import DEFECTS as NETWORKS
from .spans import DEFECTS as SPANS

CATALOGUE: tuple[Defect, ...] = (*SPANS, *NETWORKS, *CABLES, *DYNAMICS)

# ---------------------------------------------------------------- kinds of checks
FROZEN = (
    "test_published.py",
    "test_references.py",
    "test_cable_statics.py::test_the_oc3_line_is_that_of_the_notes",
    "test_exact.py::test_forces_equal_the_reference_table",
    "test_exact.py::test_anchor_forces_equal_the_reference_table",
    "test_exact.py::test_grounded_length_equals_the_reference_table",
    "test_exact.py::test_stiffness_equals_the_reference_table",
    "test_harmonic_balance.py::test_table_of_the_constant_term",
    "test_harmonic_balance.py::test_9_m",
    "test_harmonic_balance.py::test_needed_harmonics",
    "test_harmonic_balance.py::test_the_constant_term_explains_fig_8",
    "test_harmonic_balance.py::test_case_1_converges_to_the_independent_reference",
    "test_map_file.py::test_the_oc3_file_gives_the_forces_of_openfast",
    "test_network.py::test_two_line_example_to_every_digit",
    "test_network.py::test_from_the_start_of_the_paper",
    "test_scene_dynamics.py::test_four_cases_of_the_paper",
    "test_time_domain.py::test_the_sixth_period_is_that_of_the_notes",
    "test_time_domain.py::test_nine_metres_keep_the_line_in_tension",
    "test_time_domain.py::test_the_converged_line_meets_the_reference",
)
"""Checks that compare with published or stored numbers: files, and functions as the beginning of file::function."""

PLANTING = {
    "test_cable_invariants.py": ("wrong_term",),
    "test_cable_jacobian.py": ("wrong_tangent",),
    "test_cable_order.py": ("planted", "no_fault"),
    "test_cable_statics.py": ("wrong_equation",),
    "test_deferred_correction.py": ("planted",),
    "test_stability.py": ("at_most_is_seen", "counts_cells"),
    "test_time_domain.py": ("fault",),
}
"""Words in the names of tests that plant mistakes of their own by text: with another one there they fail for that."""

LONG = {
    "test_exact.py": ("50_digits", "random_lines"),
    "test_failures.py": ("any_numbers", "ordinary_ratios"),
    "test_harmonic_balance.py": ("needed_harmonics",),
    "test_network.py": ("random_networks", "40_digits"),
    "test_oscillators.py": ("enough", "five_masses", "smoothed", "converges", "found", "long_chains"),
    "test_references.py": ("recomputed", "closes", "turns_red", "found"),
}
"""Words in the names of tests that take too long to be shown every defect."""


def frozen(test: str) -> bool:
    """Whether a test, as file::function, compares with numbers kept on file."""
    return test.startswith(FROZEN)


def whole(file: str) -> str:
    """A file of tests as a check, without those that are long, plant mistakes themselves or compare with a file."""
    without = [*PLANTING.get(file, ()), *LONG.get(file, ())]
    without += [name.split("::")[1] for name in FROZEN if name.startswith(f"{file}::")]
    words = " and ".join(f"not {word}" for word in without)
    return f"{file} -k '{words}'" if words else file


STORED = "test_published.py test_references.py -k '{}'".format(
    " and ".join(f"not {word}" for word in LONG["test_references.py"])
)
_SPAN = ("test_exact.py", "test_jacobian.py", "test_limits.py", "test_invariants.py", "test_cross_solver.py",
         "test_failures.py")  # fmt: skip
_NETWORK = ("test_network.py", "test_network_jacobian.py", "test_network_scene.py", "test_map_file.py")
_CABLE = ("test_cable_order.py", "test_cable_jacobian.py", "test_cable_statics.py", "test_cable_invariants.py",
          "test_scene_dynamics.py")  # fmt: skip
_TIME = ("test_time_domain.py", "test_cable_order.py", "test_cable_invariants.py", "test_oscillators.py")
_PERIODIC = ("test_harmonic_jacobian.py", "test_oscillators.py", "test_block_chain.py", "test_harmonic_balance.py")
_FILES = {
    **dict.fromkeys(("catenary", "catenary_profile", "catenary_regimes", "catenary_solve", "elementary"), _SPAN),
    **dict.fromkeys(("network", "network_balance", "network_few", "network_jacobian", "network_model", "network_nested",
                     "network_monolithic", "network_rounding", "network_scene", "map_file"), _NETWORK),
    **dict.fromkeys(("cable", "cable_planar", "cable_spatial", "loads", "chain"),
                    (*_CABLE, "test_time_domain.py", "test_harmonic_balance.py")),
    "statics": (*_CABLE, "test_harmonic_levels.py"),
    "shooting": _CABLE,
    **dict.fromkeys(("generalized_alpha", "time_domain"), _TIME),
    **dict.fromkeys(("fourier", "harmonic_balance", "harmonic_rows", "harmonic_krylov", "harmonic_blocks"),
                    _PERIODIC),
    **dict.fromkeys(("block_chain", "compiled", "heap", "threads"), (*_PERIODIC, "test_harmonic_levels.py")),
    "catenary_excursion": _NETWORK,
    "invariants": ("test_stability.py",),
    "modes": ("test_time_domain.py",),
    "stencils": ("test_deferred_correction.py",),
    "motion": ("test_motion.py", "test_scene_dynamics.py", "test_time_domain.py"),
    "newton": (*_SPAN, *_PERIODIC, "test_cable_statics.py"),
    "outcome": ("test_failures.py", "test_network.py", "test_oscillators.py"),
    "properties": ("test_failures.py", "test_network_scene.py", "test_scene_dynamics.py", "test_cable_order.py"),
    "response": ("test_time_domain.py", "test_harmonic_balance.py"),
    "periodic_response": _PERIODIC,
    "scene": ("test_failures.py", "test_invariants.py", "test_scene_dynamics.py"),
}  # fmt: skip


def files(module: str) -> tuple[str, ...]:
    """The files of tests that say anything of a module of solvers."""
    return _FILES[module]


WIDER = {
    module: (*(whole(file) for file in files), "test_found_by_defects.py", STORED) for module, files in _FILES.items()
}
"""Module of solvers -> checks that each of its defects is shown with --all, beside the one named for it."""
