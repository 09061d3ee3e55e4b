"""All seeded defects, the checks they are shown to, and which of these compare with numbers kept on file."""

from __future__ import annotations

import random

from .defect import Defect
from .planted.cables import DEFECTS as CABLES
from .planted.dynamics import DEFECTS as DYNAMICS
from .planted.load_cases import DEFECTS as LOAD_CASES
from .planted.mooring import DEFECTS as MOORING
from .planted.multipliers import DEFECTS as MULTIPLIERS
from .planted.networks import DEFECTS as NETWORKS
from .planted.spans import DEFECTS as SPANS
from .planted.stability import DEFECTS as STABILITY

CATALOGUE: tuple[Defect, ...] = (
    *SPANS, *NETWORKS, *CABLES, *DYNAMICS, *MOORING, *LOAD_CASES, *STABILITY, *MULTIPLIERS
)  # fmt: skip

# ---------------------------------------------------------------- kinds of checks
FROZEN = (
    "suite/test_published.py",
    "catenary/test_references.py",
    "cable/test_statics.py::test_the_oc3_line_is_that_of_the_notes",
    "catenary/test_exact.py::test_forces_equal_the_reference_table",
    "catenary/test_exact.py::test_anchor_forces_equal_the_reference_table",
    "catenary/test_exact.py::test_grounded_length_equals_the_reference_table",
    "catenary/test_exact.py::test_stiffness_equals_the_reference_table",
    "harmonic_balance/test_solve.py::test_table_of_the_constant_term",
    "harmonic_balance/test_solve.py::test_9_m",
    "harmonic_balance/test_solve.py::test_needed_harmonics",
    "harmonic_balance/test_solve.py::test_the_constant_term_explains_fig_8",
    "harmonic_balance/test_solve.py::test_case_1_converges_to_the_independent_reference",
    "mooring/test_time_domain.py::test_case_1_tends_to_the_limit_of_other_formulations",
    "io/test_map_file.py::test_the_oc3_file_gives_the_forces_of_openfast",
    "network/test_solve.py::test_two_line_example_to_every_digit",
    "network/test_solve.py::test_from_the_start_of_the_paper",
    "io/test_scene.py::test_four_cases_of_the_paper",
    "time_domain/test_solve.py::test_the_sixth_period_is_that_of_the_notes",
    "time_domain/test_solve.py::test_nine_metres_keep_the_line_in_tension",
    "time_domain/test_solve.py::test_the_converged_line_meets_the_reference",
)
"""Checks that compare with published or stored numbers: files, and functions as the beginning of file::function."""

PLANTING = {
    "cable/test_invariants.py": ("wrong_term",),
    "cable/test_jacobian.py": ("wrong_tangent",),
    "cable/test_order.py": ("planted", "no_fault"),
    "cable/test_statics.py": ("wrong_equation",),
    "harmonic_balance/test_deferred_correction.py": ("planted", "each_sign"),
    "numerics/test_compiled.py": ("planted",),
    "numerics/test_newton.py": ("planted",),
    "mooring/test_equations.py": ("planted", "no_fault"),
    "mooring/test_order.py": ("planted", "no_fault"),
    "suite/test_stability.py": ("at_most_is_seen", "counts_cells"),
    "time_domain/test_solve.py": ("fault",),
}
"""Words in the names of tests that plant mistakes of their own by text: with another one there they fail for that."""

LONG = {
    "catenary/test_exact.py": ("50_digits", "random_lines"),
    "common/test_failures.py": ("any_numbers", "ordinary_ratios"),
    "harmonic_balance/test_solve.py": ("needed_harmonics",),
    "network/test_solve.py": ("random_networks", "40_digits"),
    "harmonic_balance/test_oscillators.py": ("enough", "five_masses", "smoothed", "converges", "found", "long_chains"),
    "catenary/test_references.py": ("recomputed", "closes", "turns_red", "found"),
}
"""Words in the names of tests that take too long to be shown every defect."""


def draw(count: int, seed: str) -> list[Defect]:
    """Return all misprints and blind spots, and ``count`` of the other defects in the order of the catalogue.

    They are drawn from each module in turn, so that as many modules as can be have one.
    """
    always = [defect for defect in CATALOGUE if defect.misprint or defect.blind]
    others: dict[str, list[Defect]] = {}
    for defect in CATALOGUE:
        if defect not in always:
            others.setdefault(defect.module, []).append(defect)
    generator = random.Random(seed)
    for group in others.values():
        generator.shuffle(group)
    turns = [group[turn:] for turn in range(max(map(len, others.values()))) for group in _shuffled(generator, others)]
    drawn = {*always, *[left[0] for left in turns if left][:count]}
    return [defect for defect in CATALOGUE if defect in drawn]


def _shuffled(generator: random.Random, groups: dict) -> list:
    order = list(groups.values())
    generator.shuffle(order)
    return order


def frozen(test: str) -> bool:
    """Whether a test, as file::function, compares with numbers kept on file."""
    return test.startswith(FROZEN)


def whole(file: str) -> str:
    """A file of tests as a check, without those that are long, plant mistakes themselves or compare with a file."""
    without = [*PLANTING.get(file, ()), *LONG.get(file, ())]
    without += [name.split("::")[1] for name in FROZEN if name.startswith(f"{file}::")]
    words = " and ".join(f"not {word}" for word in without)
    return f"{file} -k '{words}'" if words else file


STORED = "suite/test_published.py catenary/test_references.py -k '{}'".format(
    " and ".join(f"not {word}" for word in LONG["catenary/test_references.py"])
)
_SPAN = (
    "catenary/test_exact.py",
    "catenary/test_jacobian.py",
    "catenary/test_limits.py",
    "catenary/test_invariants.py",
    "catenary/test_cross_solver.py",
    "catenary/test_starts.py",
    "common/test_failures.py",
)
_NETWORK = (
    "network/test_solve.py",
    "network/test_jacobian.py",
    "network/test_nested.py",
    "network/test_start.py",
    "io/test_network_scene.py",
    "io/test_map_file.py",
)
_CABLE = (
    "cable/test_loads.py",
    "cable/test_mesh.py",
    "cable/test_system.py",
    "cable/test_predictor.py",
    "cable/test_order.py",
    "cable/test_jacobian.py",
    "cable/test_statics.py",
    "cable/test_system.py",
    "cable/test_invariants.py",
    "io/test_scene.py",
)
_TIME = (
    "time_domain/test_drift_control.py",
    "time_domain/test_step_control.py",
    "time_domain/test_history.py",
    "time_domain/test_solve.py",
    "time_domain/test_steps.py",
    "cable/test_order.py",
    "cable/test_invariants.py",
    "harmonic_balance/test_oscillators.py",
)
_PERIODIC = (
    "harmonic_balance/test_jacobian.py",
    "harmonic_balance/test_oscillators.py",
    "numerics/test_bordered.py",
    "harmonic_balance/test_solve.py",
)
_LINE = tuple(
    f"mooring/test_{name}.py"
    for name in ("equations", "order", "statics", "model", "time_domain", "slack", "seabed", "periodic", "network")
)
_LAYOUT = ("mooring/test_layout.py", *_LINE)
_CASES = (
    "common/test_sea_state.py",
    "io/test_case_file.py",
    "load_cases/test_statistics.py",
    "load_cases/test_solve.py",
    "load_cases/test_accuracy.py",
)
_FILES = {
    **dict.fromkeys(
        (
            "mooring.equations",
            "mooring.stepping.steps",
            "mooring.lines.model",
            "mooring.system",
            "mooring.lines.assembly",
            "mooring.statics",
            "mooring.stepping.time_domain",
        ),
        _LINE,
    ),
    **dict.fromkeys(("mooring.lines.layout", "numerics.lu.elimination", "mooring.lines.coarsening"), _LAYOUT),
    **dict.fromkeys(("mooring.lines.components", "mooring.linearised.impedance"), ("mooring/test_network.py",)),
    "mooring.lines.prescribed_motion": (
        "mooring/test_model.py",
        "mooring/test_network.py",
        "mooring/test_time_domain.py",
    ),
    "mooring.lines.mesh": ("mooring/test_model.py", "mooring/test_statics.py", "mooring/test_periodic.py"),
    "mooring.lines.calibration": ("mooring/test_statics.py", "mooring/test_periodic.py"),
    "mooring.linearised.modes": ("mooring/test_statics.py", "mooring/test_network.py"),
    "numerics.lu.block_elimination": ("mooring/test_layout.py", "mooring/test_periodic.py", "mooring/test_network.py"),
    "mooring.periodic.samples": ("mooring/test_periodic.py", "mooring/test_network.py"),
    "mooring.periodic.harmonic": ("mooring/test_periodic.py", "mooring/test_layout.py", "mooring/test_network.py"),
    "mooring.periodic.iterative_harmonics": ("mooring/test_periodic.py",),
    "mooring.stepping.history": ("mooring/test_slack.py", "mooring/test_time_domain.py", "mooring/test_periodic.py"),
    "mooring.diagnostics": ("mooring/test_periodic.py", "io/test_plausibility.py"),
    **dict.fromkeys(
        (
            "catenary.span",
            "catenary.profile",
            "catenary.regimes",
            "catenary.suspended",
            "catenary.solve",
            "numerics.elementary",
        ),
        _SPAN,
    ),
    **dict.fromkeys(
        (
            "network.solve",
            "network.equations",
            "network.scalar",
            "network.jacobian",
            "network.model",
            "network.nested",
            "network.start",
            "network.monolithic",
            "network.rounding",
            "io.network_scene",
            "io.map_plus_plus.reader",
        ),
        _NETWORK,
    ),
    **dict.fromkeys(
        (
            "cable.system",
            "cable.equations",
            "cable.mesh",
            "cable.planar",
            "cable.spatial",
            "cable.loads",
        ),
        (*_CABLE, "common/test_response.py", "time_domain/test_solve.py", "harmonic_balance/test_solve.py"),
    ),
    "numerics.chain": (
        "numerics/test_chain.py",
        *_CABLE,
        "time_domain/test_solve.py",
        "harmonic_balance/test_solve.py",
    ),
    "cable.statics": (*_CABLE, "harmonic_balance/test_start.py"),
    "cable.shooting": _CABLE,
    **dict.fromkeys(
        (
            "time_domain.generalized_alpha",
            "time_domain.solve",
            "time_domain.history",
            "time_domain.step_control",
            "time_domain.drift_control",
        ),
        (*_TIME, "cable/test_failures.py"),
    ),
    "numerics.continuation": ("numerics/test_continuation.py", *_PERIODIC, "cable/test_statics.py"),
    **dict.fromkeys(
        (
            "numerics.fourier",
            "harmonic_balance.residual",
            "harmonic_balance.blocks",
            "harmonic_balance.start",
        ),
        (*_PERIODIC, "harmonic_balance/test_start.py"),
    ),
    **dict.fromkeys(
        ("numerics.lu.bordered", "numerics.lu.blas_by_address", "numerics.memory", "numerics.threads"),
        (*_PERIODIC, "harmonic_balance/test_start.py"),
    ),
    "numerics.compiled": ("numerics/test_compiled.py", "numerics/test_bordered.py"),
    "catenary.pretension": ("cable/test_statics.py", "mooring/test_periodic.py"),
    "catenary.excursion": ("catenary/test_excursion.py", *_NETWORK),
    "common.diagnostics": ("common/test_diagnostics.py", "suite/test_stability.py"),
    "numerics.modes": ("numerics/test_modes.py", "time_domain/test_solve.py"),
    "cable.midpoint_stencils": ("cable/test_mesh.py", "harmonic_balance/test_deferred_correction.py"),
    **dict.fromkeys(
        ("common.motions.motion", "common.motions.motion_arrays"),
        ("common/test_motion.py", "io/test_scene.py", "time_domain/test_solve.py"),
    ),
    "io.keys": ("io/test_schema.py", "io/test_case_file.py"),
    "io.schema": ("io/test_schema.py",),
    "io.map_plus_plus.writer": ("io/test_map_writer.py",),
    "io.plausibility": ("io/test_plausibility.py",),
    "io.series.motion_file": ("io/test_motion_file.py",),
    **dict.fromkeys(("io.moordyn.reader", "io.moordyn.tables", "io.moordyn.writer"), ("io/test_moordyn_file.py",)),
    "common.motions.body_motion": ("common/test_body_motion.py", "mooring/test_network.py"),
    "numerics.newton": ("numerics/test_newton.py", *_SPAN, *_PERIODIC, "cable/test_statics.py"),
    "common.outcome": ("common/test_failures.py", "network/test_solve.py", "harmonic_balance/test_oscillators.py"),
    "common.validation": (
        "common/test_validation.py",
        "common/test_failures.py",
        "io/test_network_scene.py",
        "io/test_scene.py",
    ),
    "common.properties": (
        "common/test_failures.py",
        "io/test_network_scene.py",
        "io/test_scene.py",
        "cable/test_order.py",
    ),
    "common.response": ("common/test_response.py", "time_domain/test_solve.py", "harmonic_balance/test_solve.py"),
    "harmonic_balance.solve": (*_PERIODIC, "harmonic_balance/test_deferred_correction.py"),
    "harmonic_balance.response": _PERIODIC,
    **dict.fromkeys(
        (
            "stability.curves.family",
            "stability.curves.bordered",
            "stability.curves.continuation",
            "stability.curves.curve",
            "stability.curves.tracing",
        ),
        ("stability/test_curve.py", "stability/test_resume.py", "stability/test_special_points.py"),
    ),
    "stability.curves.special_points": ("stability/test_special_points.py", "stability/test_known_curves.py"),
    "stability.curves.switching": ("stability/test_special_points.py", "stability/test_resume.py"),
    "stability.curves.adaptivity": ("stability/test_resume.py",),
    "io.curve_file": ("stability/test_resume.py",),
    **dict.fromkeys(
        ("stability.multipliers.floquet", "stability.multipliers.hill", "stability.multipliers.monodromy"),
        ("stability/test_floquet.py", "stability/test_line_multipliers.py"),
    ),
    "stability.curves.basins": ("stability/test_basins.py",),
    "stability.multipliers.dense": ("stability/test_floquet.py",),
    **dict.fromkeys(
        (
            "stability.multipliers.leading",
            "mooring.periodic.hill",
            "mooring.linearised.monodromy",
            "mooring.linearised.stepped_orbit",
            "mooring.linearised.steps",
        ),
        ("stability/test_line_multipliers.py",),
    ),
    **dict.fromkeys(
        ("common.motions.spectrum", "common.motions.irregular_motion", "common.motions.sea_state"), _CASES[:1]
    ),
    **dict.fromkeys(("io.series.sea_file", "io.case_file", "common.load_case"), _CASES[1:]),
    "io.series.csv_columns": ("io/test_motion_file.py", "io/test_case_file.py"),
    **dict.fromkeys(
        (
            "load_cases.envelope",
            "load_cases.integration",
            "load_cases.statistics",
            "load_cases.results",
            "load_cases.accuracy",
            "load_cases.solve",
            "load_cases.fingerprint",
        ),
        _CASES,
    ),
    "io.scene": ("common/test_failures.py", "catenary/test_invariants.py", "io/test_scene.py"),
}


def files(module: str) -> tuple[str, ...]:
    """The files of tests that say anything of a module of solvers."""
    return _FILES[module]


WIDER = {module: (*(whole(file) for file in files), STORED) for module, files in _FILES.items()}
"""Module of solvers -> checks that each of its defects is shown with --all, beside the one named for it."""
