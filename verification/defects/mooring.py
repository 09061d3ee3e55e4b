"""Defects of the moving line of nodes and elements: equations, elimination, steps, mesh, rest, harmonics, results."""

from __future__ import annotations

from ..tools.planting import Fault
from .defect import Defect

_FORCES = "mooring/test_equations.py::test_forces_are_those_of_mpmath"
_TANGENTS = "mooring/test_equations.py::test_tangents_are_complex_steps"
_IN_DT = "mooring/test_order.py::test_order_in_dt"
_ARRAYS = "mooring/test_model.py::test_arrays_of_a_line_of_two_materials"
_NETWORKS = "mooring/test_statics.py::test_lines_of_several_materials_rest_as_their_network"
_INTEGRATOR = "mooring/test_network.py::test_random_networks_move_as_another_program_has_them"
_IMPEDANCE = "mooring/test_network.py::test_impedance_is_that_of_linear_motions"
_BODY = "mooring/test_network.py::test_points_of_a_body_have_its_motion"
_MANUFACTURED = "mooring/test_periodic.py::test_a_motion_of_two_harmonics_comes_out"

DEFECTS = (
    # ------------------------------------------------------------ equations
    Defect(
        "a cell pulls one end alone",
        Fault("mooring.equations", "residual", "R[last, k] += T[c] * unit[c, k]", "pass"),
        "term",
        "the tension acts on the first node of a cell, not on the second",
        f"{_FORCES} -k tension",
    ),
    Defect(
        "strain rate of the stretched cell",
        Fault("mooring.equations", "residual", "line.damping[c] * rate / l", "line.damping[c] * rate / distance"),
        "symbol",
        "the rate of strain refers to the stretched length",
        f"{_FORCES} -k damping",
    ),
    Defect(
        "added mass along the line",
        Fault("mooring.equations", "residual", "half * line.added_mass[c] * inertia", "0.0 * inertia"),
        "term",
        "the added mass resists motion along the cell too",
        f"{_FORCES} -k added",
    ),
    Defect(
        "tangential drag that pushes",
        Fault(
            "mooring.equations",
            "residual",
            "along if along.real > 0 else -along",
            "along if along.real < 0 else -along",
        ),
        "sign",
        "the drag along a cell has the direction of the velocity",
        f"{_FORCES} -k tangential",
    ),
    Defect(
        "a line that pushes",
        Fault("mooring.equations", "residual", "T[c].real <= 0 and auxiliary[c] <= 0", "T[c].real <= -1e30"),
        "regime",
        "a slack cell keeps its negative tension",
        "mooring/test_slack.py::test_a_mass_bounces_as_it_has_to -k undamped",
    ),
    Defect(
        "drag of nodes in still water",
        Fault(
            "mooring.equations",
            "drag",
            "line.point_drag[i] * np.sqrt(square) * (v[i, k] - line.current[k])",
            "line.point_drag[i] * np.sqrt(square) * v[i, k]",
        ),
        "term",
        "the drag of a buoy has the direction of its velocity over the ground",
        f"{_FORCES} -k nodes",
    ),
    Defect(
        "halves of a cell on neighbours",
        Fault("mooring.equations", "residual", "last if side else first", "first + side"),
        "index",
        "the second half of a cell loads the node with the next number",
        f"{_FORCES} -k inertia",
    ),
    Defect(
        "a seabed that holds",
        Fault("mooring.equations", "seabed", "normal.real <= 0", "normal.real <= -1e30"),
        "regime",
        "the damper of the seabed pulls a node that is lifted",
        f"{_FORCES} -k damping",
    ),
    Defect(
        "friction of the sinking",
        Fault("mooring.equations", "seabed", "range(n - 1)", "range(n)", 1),
        "index",
        "the vertical velocity counts in the speed of friction",
        f"{_FORCES} -k friction",
    ),
    Defect(
        "a cell that does not turn",
        Fault("mooring.equations", "tangents", "max(auxiliary[c], 0.0)", "0.0"),
        "derivative",
        "the tangents leave the lateral stiffness of the tension out",
        f"{_TANGENTS} -k tension",
    ),
    Defect(
        "drag tangent halved",
        Fault("mooring.equations", "tangents", "2 * ct * abs(along) * tt", "ct * abs(along) * tt"),
        "derivative",
        "d(|u| u)/du is |u| along the cell",
        f"{_TANGENTS} -k tangential",
    ),
    Defect(
        "drag of nodes without direction",
        Fault("mooring.equations", "drag_tangents", "line.point_drag[i] * uu", "0.0 * uu"),
        "derivative",
        "the drag of a buoy grows with the size of its velocity, not with the direction",
        f"{_TANGENTS} -k nodes",
    ),
    Defect(
        "loads that turn with one end",
        Fault(
            "mooring.equations",
            "tangents",
            "add_next(left, c, j, k, weights, -turn, 0.0)",
            "add_next(right, c, j, k, weights, -turn, 0.0)",
        ),
        "index",
        "the loads of both halves of a cell turn with its last node",
        f"{_TANGENTS} -k 'added or drag'",
    ),
    Defect(
        "friction with a constant weight",
        Fault("mooring.equations", "seabed_tangents", "by_height * up", "0.0 * up"),
        "derivative",
        "the tangents of friction do not see the height of the node",
        f"{_TANGENTS} -k friction",
    ),
    Defect(
        "forces of the holder exchanged",
        Fault("mooring.equations", "node_forces", "-R[i, p]", "R[i, p]"),
        "sign",
        "the force on what holds a node is that on the node",
        "mooring/test_time_domain.py::test_energy_of_a_swing_closes -k vacuo",
    ),
    Defect(
        "tangents of one sample",
        Fault(
            "mooring.samples",
            "sampled_tangents",
            "diagonal[d, j, k, i, s] = D[d, i, j, k]",
            "diagonal[d, k, j, i, s] = D[d, i, j, k]",
        ),
        "index",
        "the blocks of the harmonic balance are transposed at each node",
        "mooring/test_periodic.py::test_jacobian_blocks_are_differences_of_the_rows",
    ),
    # ------------------------------------------------------------ elimination
    Defect(
        "elimination with the block until_stored",
        Fault(
            "mooring.elimination",
            "factorise",
            "left[e, j, p] * right[e, p, k]",
            "left[e, j, p] * right[e, k, p]",
        ),
        "index",
        "the Schur complement takes a block transposed",
        "mooring/test_equations.py::test_blocks_are_eliminated",
    ),
    Defect(
        "a prescribed node that yields",
        Fault("mooring.layout", "plan_elimination", "is_prescribed[p] or is_prescribed[q]", "is_prescribed[p]"),
        "boundary",
        "a prescribed node is a later neighbour of a free one, and its row is solved for",
        "mooring/test_equations.py::test_blocks_are_eliminated",
    ),
    Defect(
        "blocks between neighbours exchanged",
        Fault(
            "mooring.elimination",
            "factorise",
            "left[e, j, p] * right[f, p, k]",
            "left[f, j, p] * right[e, p, k]",
        ),
        "index",
        "the block that a pivot adds between two others is that of the other row",
        "mooring/test_equations.py::test_blocks_are_eliminated",
    ),
    Defect(
        "pairs of the pivot itself",
        Fault("mooring.layout", "plan_elimination", "pair.append(later[one][two])", "pair.append(later[p][two])"),
        "index",
        "what a pivot adds between two neighbours goes to the block beside the pivot",
        "mooring/test_equations.py::test_blocks_are_eliminated",
    ),
    Defect(
        "pairs of the pivot before",
        Fault(
            "mooring.block_elimination",
            "_factorise",
            "pair += 1",
            "pair += int(a == order.start[i])",
        ),
        "index",
        "a pivot with three neighbours has three pairs of them, not two",
        "mooring/test_layout.py::test_any_network_is_eliminated",
    ),
    Defect(
        "one side of the pairs",
        Fault(
            "mooring.block_elimination",
            "_factorise",
            "blas.gemm(right[e], left[f], left[between])",
            "blas.gemm(right[f], left[e], left[between])",
        ),
        "index",
        "the blocks of the harmonic balance that a joint adds are alike on both sides",
        "mooring/test_layout.py::test_any_network_is_eliminated",
    ),
    Defect(
        "exchanges of rows in their order",
        Fault("mooring.block_elimination", "_solve", "range(m - 1, -1, -1)", "range(m)"),
        "index",
        "the last step of a solve exchanges rows from the first on, as the factorisation does",
        "mooring/test_layout.py::test_changes_of_prescribed_nodes_are_taken_over",
    ),
    Defect(
        "a triangle of the wrong sort",
        Fault(
            "mooring.block_elimination",
            "_factorise",
            "blas.trsm(LOWER, TRANSPOSED, UNIT, lu, one)",
            "blas.trsm(LOWER, PLAIN, UNIT, lu, one)",
        ),
        "symbol",
        "the block below a pivot is divided by L, not by its transpose",
        "mooring/test_layout.py::test_any_network_is_eliminated",
    ),
    Defect(
        "prescribed motion of the last node",
        Fault(
            "mooring.block_elimination",
            "_solve",
            "blas.gemv(TRANSPOSED, right[c], x[q], x[p])",
            "blas.gemv(PLAIN, right[c], x[q], x[p])",
        ),
        "symbol",
        "a change of a prescribed node at the end of a cell enters with the transposed block",
        "mooring/test_layout.py::test_changes_of_prescribed_nodes_are_taken_over",
    ),
    # ------------------------------------------------------------ numbers of nodes
    Defect(
        "numbers against the run of an element",
        Fault(
            "mooring.layout",
            "_Numbers.interior",
            "inner if self.ends[e][0] == start else inner[::-1]",
            "inner",
        ),
        "order",
        "an element that is followed from its second end is numbered backward, and elimination fills its blocks",
        "mooring/test_layout.py::test_elimination_adds_few_blocks",
    ),
    Defect(
        "joints among the others",
        Fault("mooring.layout", "number_nodes", 'p.kind == "free" and d > 2', 'p.kind == "free" and d > 5'),
        "order",
        "a joint of three lines is numbered where the first of them ends",
        "mooring/test_layout.py::test_elimination_adds_few_blocks",
    ),
    Defect(
        "cells to the next number",
        Fault("mooring.layout", "number_nodes", "np.stack([n[:-1], n[1:]])", "np.stack([n[:-1], n[:-1] + 1])"),
        "index",
        "a cell ends at the next number, as in a line, not at the joint",
        "mooring/test_layout.py::test_every_node_and_cell_has_one_number",
    ),
    # ------------------------------------------------------------ steps
    Defect(
        "accelerations of one kind",
        Fault("mooring.steps", "integrate", "alpha_f * acceleration[i, k]", "alpha_f * a[i, k]"),
        "order",
        "the acceleration that balanced the forces of the step before is taken for the algorithmic one",
        _IN_DT,
    ),
    Defect(
        "acceleration with the weight of positions",
        Fault(
            "mooring.steps",
            "integrate",
            "(1 - alpha_m) * a1[i, k] + alpha_m * a[i, k]",
            "(1 - alpha_f) * a1[i, k] + alpha_f * a[i, k]",
        ),
        "order",
        "alpha_f stands where alpha_m has to",
        _IN_DT,
    ),
    Defect(
        "states a step late",
        Fault("mooring.steps", "integrate", "(step + 1) % every == 0", "step % every == 0"),
        "index",
        "of every n-th step the one after it is kept",
        "mooring/test_time_domain.py::test_states_are_kept_every_so_often",
    ),
    Defect(
        "old factors for ever",
        Fault("mooring.steps", "integrate", "if error > MAX_CONTRACTION * last:\n    factorised = False", "pass"),
        "stale",
        "a step that converges slowly keeps the factors of an earlier one",
        "mooring/test_order.py::test_work_of_a_step",
    ),
    # ------------------------------------------------------------ time_domain
    Defect(
        "a scheme of first order",
        Fault("mooring.steps", "newmark_parameters", "0.5 - alpha_m + alpha_f", "0.5 + alpha_m - alpha_f"),
        "order",
        "gamma has the signs of another convention",
        "mooring/test_order.py::test_order_in_dt_of_each_scheme",
    ),
    Defect(
        "coarser lines that keep the first nodes",
        Fault("mooring.coarsening", "common_nodes", "nodes[_every_second(s)]", "nodes[: coarse_nodes.size]"),
        "index",
        "the nodes that a coarser line has are taken from one end of the fine one",
        "mooring/test_layout.py::test_coarser_lines_keep_every_second_node",
    ),
    Defect(
        "a start without its load",
        Fault(
            "mooring.time_domain", "balancing_acceleration", "R -= system.source_at(np.zeros(1)).sum(axis=0)", "pass"
        ),
        "term",
        "the acceleration at the start does not know the load of a manufactured solution",
        _IN_DT,
    ),
    Defect(
        "kept states shifted by a stop",
        Fault("mooring.time_domain", "_Run.advance", "until_stored = -done % every", "until_stored = 0"),
        "index",
        "after the steps stopped at a slack cell every n-th state is counted anew",
        "mooring/test_slack.py::test_states_are_kept_at_their_times",
    ),
    Defect(
        "a load at the beginning of the step",
        Fault(
            "mooring.time_domain", "_Run._integrate", "self.system.source_at(t[1:])", "self.system.source_at(t[:-1])"
        ),
        "order",
        "the source is taken where the step begins, the forces where it ends",
        _IN_DT,
    ),
    # ------------------------------------------------------------ model, mesh, system
    Defect(
        "a catenary from the wrong end",
        Fault("mooring.model", "Segment.profile", "self.length - s if self.reversed else s", "s"),
        "index",
        "arc lengths of an element that runs backward count from its other end",
        "mooring/test_model.py::test_a_segment_may_run_backward",
    ),
    Defect(
        "the fairlead first",
        Fault(
            "mooring.model", "_from_network", 'network.nodes[i].kind == "coupled"', 'network.nodes[i].kind == "free"'
        ),
        "index",
        "a line given as a network begins at its fairlead",
        _ARRAYS,
    ),
    Defect(
        "cells of one material short",
        Fault("mooring.mesh", "_apportion_cells", "counts + 1", "np.maximum(counts, 1)"),
        "index",
        "the cell that each material is given first is not counted",
        "mooring/test_model.py::test_meshes_have_their_cells_and_joints",
    ),
    Defect(
        "a mesh for the line at rest alone",
        Fault("mooring.mesh", "_cumulative_density", "motion is not None and period is not None", "False"),
        "regime",
        "the travel of the touchdown is not meshed",
        "mooring/test_model.py::test_a_fitted_mesh_covers_the_travel_of_the_touchdown",
    ),
    Defect(
        "a buoy without its water",
        Fault("mooring.assembly", "assemble_line", "point.mass - rho * point.volume", "point.mass"),
        "term",
        "the volume of a point mass displaces nothing",
        f"{_NETWORKS} -k 'buoy or clump'",
    ),
    Defect(
        "tangential drag without pi",
        Fault(
            "mooring.assembly",
            "assemble_line",
            "rho * math.pi * cable.diameter * cable.Cdt / 2",
            "rho * cable.diameter * cable.Cdt / 2",
        ),
        "factor",
        "the drag along the line refers to its diameter, not its girth",
        _ARRAYS,
    ),
    Defect(
        "whole cells on the last nodes",
        Fault("mooring.assembly", "assemble_line", "per_length * counted / 2", "per_length * counted"),
        "factor",
        "a node carries both of its cells whole",
        _ARRAYS,
    ),
    Defect(
        "a buoy without its added mass",
        Fault("mooring.assembly", "assemble_line", "point.mass + point.Ca * rho * point.volume", "point.mass"),
        "term",
        "a moving point accelerates no water",
        f"{_INTEGRATOR} -k 4",
    ),
    Defect(
        "drag of nodes with twice its area",
        Fault("mooring.assembly", "assemble_line", "rho * point.CdA / 2", "rho * point.CdA"),
        "factor",
        "the drag of a point lacks the half of the dynamic pressure",
        f"{_INTEGRATOR} -k 4",
    ),
    Defect(
        "a clump above the seabed",
        Fault("mooring.model", "MooringModel._sinkage", "np.maximum(weight / length, 0.0)", "0.0 * weight / length"),
        "regime",
        "the search for rest starts with a heavy point at the surface of the seabed, out of contact",
        "mooring/test_network.py::test_a_clump_weight_rests_on_the_seabed",
    ),
    Defect(
        "the moved points first",
        Fault(
            "mooring.system",
            "MooringSystem.__init__",
            "self._prescribed_points.index(i)",
            "model.moved.index(i)",
        ),
        "index",
        "a body moves the first of the prescribed points, anchors too",
        _BODY,
    ),
    Defect(
        "points without arms",
        Fault(
            "mooring.prescribed_motion",
            "move_points",
            "motion.trajectory(points, t)",
            "motion.trajectory(0 * points, t)",
        ),
        "term",
        "every point that a body carries moves as the origin would",
        _BODY,
    ),
    Defect(
        "arms from the origin",
        Fault("common.body_motion", "BodyMotion._arms", "array - self.reference", "array"),
        "term",
        "a body turns about the origin, not about its reference point",
        _BODY,
    ),
    Defect(
        "a fairlead without its acceleration",
        Fault(
            "mooring.system",
            "MooringSystem.path",
            "self.axes @ of_point",
            "(k < 2) * self.axes @ of_point",
        ),
        "term",
        "the force on the vessel misses the inertia of the last half cell",
        "mooring/test_time_domain.py::test_the_fairlead_is_where_it_is_prescribed",
    ),
    # ------------------------------------------------------------ statics, calibration, modes
    Defect(
        "the forces of slack cells",
        Fault("mooring.statics", "solve_rest", "system.axes.T @ -R.T", "system.axes.T @ R.T"),
        "sign",
        "the forces at rest are those on the line",
        "mooring/test_statics.py::test_order_against_the_catenary",
    ),
    Defect(
        "calibrated without stretch",
        Fault("mooring.calibration", "calibrate_line", "1 + tension / line.EA", "1"),
        "term",
        "calibrated cells have the stretched length",
        "mooring/test_statics.py::test_calibrated_cells_rest_on_the_catenary",
    ),
    Defect(
        "modes that damping feeds",
        Fault("mooring.modes", "LinePencil.inverse", "self.M @ q + self.C @ p", "self.M @ q - self.C @ p"),
        "sign",
        "the damping has the other sign in one part of the pencil",
        "mooring/test_statics.py::test_natural_modes_are_damped",
    ),
    Defect(
        "modes without the coupling until_stored",
        Fault(
            "mooring.modes",
            "LinePencil.whole_matrix",
            "np.concatenate([np.arange(nodes), line.last, line.first])",
            "np.concatenate([np.arange(nodes), line.first, line.last])",
        ),
        "index",
        "the blocks until_stored the diagonal stand on it",
        "mooring/test_statics.py::test_natural_modes_are_those_of_the_tangents",
    ),
    # ------------------------------------------------------------ harmonic
    Defect(
        "accelerations of the fundamental",
        Fault(
            "mooring.harmonic",
            "MooringHarmonics.__init__",
            "(basis.omega * basis.harmonic) ** 2",
            "basis.omega**2 * basis.harmonic",
        ),
        "factor",
        "the k-th harmonic is accelerated by k, not k^2",
        _MANUFACTURED,
    ),
    Defect(
        "no damper in the predicted tensions",
        Fault("mooring.samples", "predict_tensions", "line.damping[c] * (t[k] * change + turned)", "0.0"),
        "term",
        "tensions after a step leave the rate of strain out",
        "mooring/test_periodic.py::test_tensions_of_a_step_are_predicted_to_second_order",
    ),
    Defect(
        "a start of any network as of a line in deep water",
        Fault(
            "mooring.harmonic",
            "start_from_time",
            "system.line.seabed_stiffness.any() or not system.model.is_line",
            "False",
        ),
        "regime",
        "a solve starts where a coarse time integration found cells slack that are not, and ends elsewhere",
        "mooring/test_periodic.py::test_starts_are_as_fine_as_slack_and_touchdown_need",
    ),
    Defect(
        "a start that has not settled",
        Fault("mooring.harmonic", "start_from_time", "change > SETTLED * abs(history.y - rest).max()", "False"),
        "regime",
        "a lightly damped line starts from two periods, too",
        "mooring/test_periodic.py::test_a_start_that_does_not_settle_takes_one_more_period",
    ),
    Defect(
        "single precision throughout",
        Fault(
            "mooring.harmonic",
            "MooringHarmonics.linearise",
            "self.linearisations <= SINGLE_PRECISION_STEPS",
            "True",
        ),
        "regime",
        "where Newton's method needs many factors, they stay in single precision",
        "mooring/test_periodic.py::test_factors_are_in_double_precision_where_many_are_needed",
    ),
    Defect(
        "coarser lines of the motion before",
        Fault("mooring.system", "MooringSystem.with_motion", "coarser[0].with_motion(motion)", "coarser[0]"),
        "index",
        "the coarser lines that are kept go on with the motion that they were made for",
        "mooring/test_periodic.py::test_coarser_lines_are_kept_and_take_the_motion",
    ),
    Defect(
        "a Jacobian without mass",
        Fault("mooring.harmonic", "MooringHarmonics.jacobian", "parts[2:]", "()"),
        "derivative",
        "the Jacobian leaves the mass out",
        "mooring/test_periodic.py::test_jacobian_blocks_are_differences_of_the_rows",
    ),
    Defect(
        "extrapolated the wrong way",
        Fault(
            "mooring.harmonic",
            "MooringResponse.end_force_at",
            "force + (force - self.coarse.end_force_at(t, end, element)) / 3",
            "force - (force - self.coarse.end_force_at(t, end, element)) / 3",
        ),
        "sign",
        "the error of the cells is added once more",
        "mooring/test_periodic.py::test_end_forces_are_extrapolated",
    ),
    # ------------------------------------------------------------ components, impedance, outputs of a body
    Defect(
        "parts apart at joints",
        Fault(
            "mooring.components", "split_system", 'model.points[p].kind == "free"', 'model.points[p].kind == "coupled"'
        ),
        "regime",
        "lines that meet at a free point are parted there, and those on a body are not",
        "mooring/test_network.py::test_a_network_is_taken_apart_where_nodes_are_prescribed",
    ),
    Defect(
        "equilibria of parts in their own order",
        Fault("mooring.components", "merge_states", "y[:, part.nodes] = state.y", "y[:, : part.nodes.size] = state.y"),
        "index",
        "every part rests where the first one does",
        "mooring/test_network.py::test_a_network_is_taken_apart_where_nodes_are_prescribed",
    ),
    Defect(
        "the first part speaks for all",
        Fault("mooring.components", "integrate_components", "not history.success", "history.steps < shortest.steps"),
        "regime",
        "a part that is torn, which takes all steps, does not fail the network",
        "mooring/test_network.py::test_a_torn_line_is_named_in_whatever_part_it_is",
    ),
    Defect(
        "starts of parts in their own order",
        Fault("mooring.components", "integrate_components", "y[:, part.nodes]", "y[:, : part.nodes.size]"),
        "index",
        "every part starts with the first nodes of the network",
        "mooring/test_network.py::test_a_network_is_taken_apart_where_nodes_are_prescribed",
    ),
    Defect(
        "moments without the force at rest",
        Fault("mooring.impedance", "mooring_impedance", "Z[k, 3:, 3:] -= _cross(F) @ _cross(arm)", "pass"),
        "term",
        "a body that turns carries the points where the lines pull, and with them the moment of the tension at rest",
        f"{_IMPEDANCE}",
    ),
    Defect(
        "impedance of another harmonic motion",
        Fault("mooring.impedance", "mooring_impedance", "1j * w * C", "-1j * w * C"),
        "sign",
        "damping feeds the motion",
        f"{_IMPEDANCE}",
    ),
    Defect(
        "a moment about the reference point at rest",
        Fault(
            "mooring.prescribed_motion",
            "reference_point",
            "np.array(motion.reference)[:, None] + motion.pose(t)[0]",
            "np.array(motion.reference)[:, None] + 0 * motion.pose(t)[0]",
        ),
        "term",
        "the arms of the moment count from where the reference point was, not from where it is",
        "mooring/test_network.py::test_forces_on_the_body_are_those_of_another_program",
    ),
    # ------------------------------------------------------------ history, diagnostics
    Defect(
        "slack that ends a state late",
        Fault("mooring.history", "MooringHistory.slack", "some[:-1] & ~some[1:]", "some[1:] & ~some[:-1]"),
        "index",
        "times of slack end where they begin",
        "mooring/test_slack.py::test_times_of_slack_are_those_of_the_bounce",
    ),
    Defect(
        "a pretension never doubted",
        Fault(
            "catenary.pretension",
            "pretension_warnings",
            "error > MAX_PRETENSION_ERROR",
            "error > 100 * MAX_PRETENSION_ERROR",
        ),
        "tolerance",
        "a tension at rest that is wrong by some per cent is passed over",
        "mooring/test_periodic.py::test_pretension_is_held_against_the_catenary",
    ),
    Defect(
        "settled before it is",
        Fault("mooring.diagnostics", "_check_periodicity", "end < 2 * period", "end < 200 * period"),
        "tolerance",
        "a motion that has not settled is taken for periodic",
        "mooring/test_periodic.py::test_a_bad_history_warns",
    ),
)
