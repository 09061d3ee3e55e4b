"""Defects of networks and of the readers of their files: catenary_excursion, network*, map_plus_plus."""

from __future__ import annotations

from ...tools.planting import Fault
from ..defect import Defect

_DERIVATIVES = "network/test_jacobian.py::test_network_derivatives"
_RESTING = "network/test_jacobian.py::test_stiffness_with_a_node_that_rests_on_the_seabed"
_ORIGINAL = "network/test_solve.py::test_solving_a_moved_network_leaves_the_original_as_it_was"
_MEMORY = "network/test_solve.py::test_a_state_shares_no_memory_with_its_network"
_CLOSED = "network/test_solve.py::test_closed_forms"
_ROUNDING = "network/test_solve.py -k 'below_the_rounding or within_rounding'"
_ACCEPTED = "network/test_solve.py::test_what_is_accepted_as_within_rounding_is"
_EXPLAINED = "network/test_solve.py::test_a_residual_beyond_rounding_is_not_refined"
_PUSHED = "network/test_solve.py::test_a_node_that_nothing_holds_is_not_balanced_by_rounding"
_REACTIONS = "network/test_solve.py::test_reactions_carry_loads_and_weights"
_AGREE = "network/test_solve.py::test_methods_agree"
_REFUSED = "network/test_solve.py::test_refused_inputs"
_JOINT = "network/test_solve.py::test_a_joint_on_the_seabed_to_40_digits"
_TOML = "io/test_network_scene.py::test_every_key_arrives"
_MAP = "io/test_map_file.py::test_every_column_arrives"
_BRIDLES = "io/test_map_file.py::test_copies_carry_equal_forces"

DEFECTS = (
    # ------------------------------------------------------------ catenary_excursion
    Defect(
        "block C as printed",
        Fault(
            "catenary.excursion",
            "_touching",
            "lost / (w * EA)",
            "friction * np.maximum(grounded, 0.0) / EA",
            where="friction * w * grounded",
        ),
        "misprint",
        "(4.16a): dl/dV with CB (L - V/w)/EA in every case of contact",
        f"{_DERIVATIVES} -k blocks",
        misprint="MSQS (4.16a)",
    ),
    Defect(
        "anchor force that knows nothing of V",
        Fault(
            "catenary.excursion",
            "_touching",
            "_block(pulled, pulled * friction, turn, zero)",
            "_block(pulled, 0 * pulled, turn, zero)",
        ),
        "misprint",
        "(4.11): dH_anchor/dV = 0 with friction",
        f"{_DERIVATIVES} -k blocks",
        misprint="MSQS (4.11)",
    ),
    Defect(
        "sine added",
        Fault("catenary.excursion", "suspended", "spread - sine", "spread + sine"),
        "sign",
        "(4.15a): dl/dH with the other sign before V/T",
        f"{_DERIVATIVES} -k blocks",
    ),
    Defect(
        "stretch by the tension at the top",
        Fault("catenary.excursion", "suspended", "stretch * (both / 2)", "stretch * b", where="V + b"),
        "factor",
        "(2.4b): the weight of the whole line where that of its half is meant",
        "network/test_solve.py::test_invariances",
    ),
    Defect(
        "part on the seabed forgotten",
        Fault("catenary.excursion", "suspended", "H * spread + lying", "H * spread"),
        "term",
        "(2.23a): the length that lies on the seabed does not reach",
        f"{_DERIVATIVES} -k blocks",
    ),
    Defect(
        "spring that turns the other way",
        Fault(
            "catenary.excursion",
            "_spring",
            "_block(long - turn * H * H, -turn * H * V, -turn * H * V, long - turn * V * V)",
            "_block(long - turn * H * H, turn * H * V, turn * H * V, long - turn * V * V)",
        ),
        "sign",
        "d(l, h)/d(H, V) of a weightless line: its coupling",
        f"{_DERIVATIVES} -k 'assembled or Schur'",
    ),
    Defect(
        "raised end that follows H the wrong way",
        Fault("catenary.excursion", "_touching", "turn = Ya_H * softness", "turn = -Ya_H * softness"),
        "sign",
        "how the force of a raised anchor end changes with H",
        f"{_DERIVATIVES} -k blocks",
    ),
    # ------------------------------------------------------------ network_balance
    Defect(
        "buoyancy and weight exchanged",
        Fault(
            "network.equations",
            "NetworkEquations.__init__",
            "environment.rho * node.volume - node.mass",
            "node.mass - environment.rho * node.volume",
        ),
        "sign",
        "(3.6c): a buoy pulls down, a mass up",
        _CLOSED,
    ),
    Defect(
        "mass without gravity",
        Fault(
            "network.equations",
            "NetworkEquations.__init__",
            "[(environment.rho * node.volume - node.mass) * environment.g for node in network.nodes]",
            "[(environment.rho * node.volume - node.mass) for node in network.nodes]",
        ),
        "unit",
        "loads of the nodes in kg",
        _CLOSED,
    ),
    Defect(
        "friction forgotten at the anchor",
        Fault(
            "network.equations",
            "NetworkEquations.unbalanced_force",
            "H_anchor * direction",
            "H * direction",
            where="H.size",
        ),
        "symbol",
        "the anchor end of an element pulls with the force of its fairlead",
        f"{_DERIVATIVES} -k tangent",
    ),
    Defect(
        "pull of the fairlead outwards",
        Fault("network.equations", "NetworkEquations.unbalanced_force", "-H * direction, -V", "-H * direction, V"),
        "sign",
        "the vertical force of the upper end acts upwards on its node",
        _CLOSED,
    ),
    Defect(
        "tangent of an anchor that friction holds",
        Fault(
            "network.equations",
            "exact_derivatives",
            "D[resting, 0] + friction[resting, None] * D[resting, 1]",
            "D[resting, 0]",
        ),
        "misprint",
        "(4.11): the anchor force does not follow V through the length that rubs",
        f"{_DERIVATIVES} -k 'tangent or coupled'",
        misprint="MSQS (4.11)",
    ),
    Defect(
        "azimuth does not turn",
        Fault(
            "network.equations",
            "Elements.tangents",
            "self.H / g.divisor, self.H_anchor / g.divisor",
            "0 * g.divisor, 0 * g.divisor",
        ),
        "term",
        "stiffness across the plane of a line, H/l, is left out",
        f"{_DERIVATIVES} -k tangent",
    ),
    Defect(
        "raised end hangs from a fixed height",
        Fault("network.equations", "_sagging_derivatives", "end_stiffness + a * a * K11", "end_stiffness"),
        "term",
        "part of the tangent of a line that rests between two raised ends",
        f"{_DERIVATIVES} -k tangent",
    ),
    Defect(
        "across to the other side",
        Fault("network.equations", "_frame", "[-s, c]", "[s, c]"),
        "sign",
        "the direction across a line is not normal to it",
        f"{_DERIVATIVES} -k tangent",
    ),
    Defect(
        "entries one unknown further",
        Fault(
            "network.equations",
            "NetworkEquations.build_sparsity",
            "self.columns * self.size + self.rows",
            "self.columns * self.size + self.rows[::-1]",
        ),
        "index",
        "rows of the sparse tangent in the wrong order",
        f"{_DERIVATIVES} -k pattern",
    ),
    Defect(
        "pressed nodes lifted",
        Fault("network.equations", "NetworkEquations.moving_coordinates", "force[:, 2] <= 0", "force[:, 2] >= 0"),
        "sign",
        "joints on the seabed that are pressed down count as free to move",
        _JOINT,
    ),
    Defect(
        "friction of hanging ends",
        Fault(
            "network.equations",
            "Geometry.__init__",
            "np.where(self.clearance > 0, 0.0, balance.friction)",
            "balance.friction",
        ),
        "regime",
        "lines with a raised anchor end have friction, which statics cannot tell",
        "network/test_solve.py::test_friction_acts_only_where_the_anchor_end_lies",
    ),
    Defect(
        "moved network that moves its original",
        Fault(
            "network.equations",
            "NetworkEquations.with_coupled_nodes_at",
            "other.position = self.position.copy()",
            "other.position = self.position",
        ),
        "stale",
        "the positions of a moved network are those of the original, changed in place",
        _ORIGINAL,
    ),
    # ------------------------------------------------------------ network_few
    Defect(
        "step past the smallest force",
        Fault(
            "network.scalar",
            "ScalarEquations.take_step",
            "map(max, z[m::2], [MIN_H_FRACTION * H for H in point.z[m::2]])",
            "z[m::2]",
        ),
        "term",
        "a step may leave H negative, and the iteration ends there",
        "network/test_solve.py::test_floats_take_the_steps_of_arrays",
    ),
    Defect(
        "lines pull their nodes apart, in floats",
        Fault(
            "network.scalar",
            "ScalarEquations._evaluate",
            "((a, H, V_anchor), (f, -H, -V))",
            "((a, -H, V_anchor), (f, H, -V))",
        ),
        "sign",
        "the horizontal forces of few lines act outwards",
        f"{_DERIVATIVES} -k floats",
    ),
    Defect(
        "rubbing lines taken for smooth ones",
        Fault(
            "network.scalar", "_excursion", "touching and (clearance > 0 or friction > 0)", "touching and clearance > 0"
        ),
        "regime",
        "few lines with friction of the seabed are solved without it",
        f"{_DERIVATIVES} -k floats",
    ),
    # ------------------------------------------------------------ network_jacobian
    Defect(
        "columns of the next element",
        Fault("network.jacobian", "analytic_jacobian", "n + 2 * i + 1", "n + 2 * i"),
        "misprint",
        "(4.5), (4.7): an index of the blocks repeated",
        f"{_DERIVATIVES} -k assembled",
        misprint="MSQS (4.5), (4.7)",
    ),
    Defect(
        "positions pull the gaps the wrong way",
        Fault(
            "network.jacobian",
            "analytic_jacobian",
            "J[np.ix_(own, ends)] -= G[i] @ motion[i, :3]",
            "J[np.ix_(own, ends)] += G[i] @ motion[i, :3]",
        ),
        "sign",
        "the block -d(l, h)/dr of (3.7)",
        f"{_DERIVATIVES} -k assembled",
    ),
    Defect(
        "half the differences",
        Fault("network.jacobian", "difference_jacobian", "difference / step", "difference / (2 * step)"),
        "factor",
        "forward differences divided as central ones",
        f"{_DERIVATIVES} -k assembled",
    ),
    Defect(
        "trust region that grows after failures",
        Fault(
            "network.jacobian",
            "trust_region_step",
            "radius if gained > 0.25 else SHRINK * np.linalg.norm(p)",
            "GROW * radius if gained > 0.25 else GROW * np.linalg.norm(p)",
        ),
        "factor",
        "the radius grows whatever the model was worth",
        "network/test_jacobian.py::test_the_trust_region_shrinks_where_its_model_fails",
    ),
    # ------------------------------------------------------------ network_model
    Defect(
        "joint below the seabed let in",
        Fault("network.model", "Network.__post_init__", "-depth", "-2 * depth"),
        "input",
        "nodes under the seabed are accepted",
        _REFUSED,
    ),
    Defect(
        "last node is one too many",
        Fault("network.model", "Network.__post_init__", "0 <= end < n", "0 <= end <= n"),
        "index",
        "an element may end at a node that is not there",
        _REFUSED,
    ),
    Defect(
        "islands are held",
        Fault(
            "network.model",
            "Network._supported_nodes",
            'np.isin(part, part[[node.kind != "free" for node in self.nodes]])',
            "part >= 0",
        ),
        "input",
        "parts of a network that nothing ties down are accepted",
        _REFUSED,
    ),
    Defect(
        "equations of the old place",
        Fault("network.model", "Network.moved", "self.equations.with_coupled_nodes_at(r)", "self.equations"),
        "stale",
        "a network moved with its vessel keeps the places of before in its equations",
        "network/test_solve.py::test_warm_start_of_a_moved_body",
    ),
    # ------------------------------------------------------------ network_monolithic
    Defect(
        "gap the wrong way",
        Fault("network.monolithic", "Iterate.newton_step", "-other.gap[:, :, None]", "other.gap[:, :, None]"),
        "sign",
        "the Schur complement opens the gaps that it should close",
        f"{_DERIVATIVES} -k Schur",
    ),
    Defect(
        "forces do not follow the gap",
        Fault("network.monolithic", "Iterate.newton_step", "D[:, :2] @ motion + closing", "D[:, :2] @ motion"),
        "term",
        "the step of H and V has no part of the gaps",
        f"{_DERIVATIVES} -k Schur",
    ),
    Defect(
        "inverse transposed",
        Fault("network.monolithic", "Iterate.blocks", "[d, -b, -c, a]", "[d, b, c, a]"),
        "sign",
        "2 x 2 inverse without its minus signs",
        f"{_DERIVATIVES} -k Schur",
    ),
    Defect(
        "satisfied with a percent",
        Fault(
            "network.monolithic",
            "is_balanced",
            "tolerance * largest_force(now.elements)",
            "1e-2 * largest_force(now.elements)",
        ),
        "tolerance",
        "the monolithic method stops at one per cent of the largest force",
        "network/test_solve.py::test_each_method_reaches_its_tolerance_by_itself",
    ),
    Defect(
        "row of the reach for that of the height",
        Fault("network.monolithic", "Iterate.__init__", "[x.l - g.l, x.h - g.rise]", "[x.h - g.rise, x.l - g.l]"),
        "symbol",
        "the two gaps of an element exchanged",
        f"{_DERIVATIVES} -k 'assembled or Schur'",
    ),
    # ------------------------------------------------------------ network_nested
    Defect(
        "free nodes do not follow",
        Fault(
            "network.nested",
            "coupled_stiffness",
            "to_dense(K[coupled][:, free]) @ motion",
            "0 * to_dense(K[coupled][:, free]) @ motion",
        ),
        "term",
        "stiffness of the coupled nodes with the free ones held",
        f"{_DERIVATIVES} -k 'coupled or body'",
    ),
    Defect(
        "resting weight that rises",
        Fault("network.nested", "coupled_stiffness", "own[resting, 2] = False", "own[resting, 2] = True"),
        "regime",
        "stiffness of the coupled nodes with the free nodes on the seabed free to leave it",
        _RESTING,
    ),
    Defect(
        "stiffness that renumbers the equations",
        Fault("network.nested", "coupled_stiffness", "every = copy(balance)", "every = balance"),
        "stale",
        "the coupled nodes stay unknowns of the network's equations after its stiffness was asked for",
        _ORIGINAL,
    ),
    Defect(
        "start in the network's own array",
        Fault(
            "network.start",
            "force_density",
            "r, free = balance.position.copy(), np.flatnonzero(balance.free)",
            "r, free = balance.position, np.flatnonzero(balance.free)",
        ),
        "stale",
        "a start from no guess overwrites the positions that the network was given",
        _ORIGINAL,
    ),
    Defect(
        "balanced to a percent",
        Fault(
            "network.nested", "solve_nested", "tolerance * largest_force(elements)", "1e-2 * largest_force(elements)"
        ),
        "tolerance",
        "the nested method stops at one per cent, and the monolithic one has to mend it",
        "network/test_solve.py::test_each_method_reaches_its_tolerance_by_itself",
    ),
    Defect(
        "difference backwards",
        Fault(
            "network.nested", "DifferenceTangent.tangent", "base - force[free].ravel()", "force[free].ravel() - base"
        ),
        "sign",
        "the tangent from differences has the sign of dF/dr, not of -dF/dr",
        "network/test_solve.py::test_each_method_reaches_its_tolerance_by_itself",
    ),
    Defect(
        "work counted half",
        Fault("network.nested", "solve_sparse", "2 / 3", "1 / 3"),
        "factor",
        "(5.6): operations of a factorisation",
        "network/test_jacobian.py::test_operations_are_counted_as_in_the_paper",
    ),
    # ------------------------------------------------------------ network_rounding
    Defect(
        "slack for taut",
        Fault(
            "network.rounding",
            "refine_within_rounding",
            "np.where(lengthens[:, None, None], stretched, as_is)",
            "np.where(lengthens[:, None, None], as_is, stretched)",
        ),
        "regime",
        "a line that its motion lengthens keeps the slope of a slack one",
        _ROUNDING,
    ),
    Defect(
        "one side for all",
        Fault("network.rounding", "", "MAX_STIFFNESS_CHOICES = 8", "MAX_STIFFNESS_CHOICES = 1"),
        "regime",
        "no line takes the slope of the side that it moves to",
        _ROUNDING,
    ),
    Defect(
        "any step is a rounding",
        Fault("network.rounding", "refine_within_rounding", "within.all() and balanced", "balanced"),
        "tolerance",
        "what a step foresees is not held against exact spans where it leads",
        _ROUNDING,
    ),
    Defect(
        "forces of the old places",
        Fault("network.rounding", "refine_within_rounding", "Q + (here.D @ motion)[:, :, 0].T", "Q"),
        "term",
        "the forces that the step adds are left out",
        _ROUNDING,
    ),
    Defect(
        "a thousand roundings are one",
        Fault(
            "network.rounding",
            "refine_within_rounding",
            "g.rounding * np.abs(stretched).max(axis=2).T",
            "1e3 * g.rounding * np.abs(stretched).max(axis=2).T",
        ),
        "tolerance",
        "foreseen forces are accepted that exact lines do not have",
        _ACCEPTED,
    ),
    Defect(
        "tolerance of the foreseen forces",
        Fault(
            "network.rounding",
            "refine_within_rounding",
            "bound = tolerance * largest_force(elements)",
            "bound = 1e3 * tolerance * largest_force(elements)",
        ),
        "tolerance",
        "a step within rounding is held to a thousand times the tolerance",
        _ACCEPTED,
    ),
    Defect(
        "anything may be explained by rounding",
        Fault(
            "network.rounding", "refine_within_rounding", "rounding_floor(equations)", "1e3 * rounding_floor(equations)"
        ),
        "tolerance",
        "positions that are far from balanced are mended as if rounding had put them there",
        _EXPLAINED,
    ),
    Defect(
        "unbalanced within rounding",
        Fault("network.rounding", "refine_within_rounding", "within.all() and balanced", "within.all()"),
        "tolerance",
        "what is left of the force balance after the step is not looked at",
        _PUSHED,
    ),
    # ------------------------------------------------------------ network
    Defect(
        "reaction that acts on the support",
        Fault("network.solve", "_reactions_and_residual", "force - unbalanced", "unbalanced - force"),
        "sign",
        "reactions with the other sign",
        _REACTIONS,
    ),
    Defect(
        "vertical forces of the other line",
        Fault(
            "network.solve", "_state", "getattr(elements, name)", 'getattr(elements, name)[:: -1 if name == "V" else 1]'
        ),
        "misprint",
        "(5.4): V1 and V2 exchanged",
        _CLOSED,
        misprint="MSQS (5.4)",
    ),
    Defect(
        "moment of the turned body",
        Fault(
            "network.solve",
            "NetworkState.body_stiffness",
            "K[3:, 3:] -= _cross(force) @ _cross(arm)",
            "K[3:, 3:] += _cross(force) @ _cross(arm)",
        ),
        "sign",
        "the part of the body's stiffness that comes from turning its forces",
        f"{_DERIVATIVES} -k body",
    ),
    Defect(
        "cross product the other way round",
        Fault(
            "network.solve",
            "_cross",
            "[[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]]",
            "[[0.0, a[2], -a[1]], [-a[2], 0.0, a[0]], [a[1], -a[0], 0.0]]",
        ),
        "sign",
        "the matrix of x a for that of a x",
        f"{_DERIVATIVES} -k body",
    ),
    Defect(
        "whatever comes out is a success",
        Fault("network.solve", "_state", "Status.NOT_CONVERGED", "Status.SUCCESS"),
        "tolerance",
        "a network that is out of balance is a success",
        "network/test_solve.py::test_stopping_short_is_a_status",
    ),
    Defect(
        "pressed nodes taken for lifted ones",
        Fault("network.solve", "NetworkState.stiffness", "self.reaction[:, 2] < 0", "self.reaction[:, 2] > 0"),
        "sign",
        "nodes that press on the seabed count as free to rise in the stiffness",
        _RESTING,
    ),
    Defect(
        "state in the network's own array",
        Fault(
            "network.solve",
            "solve_network",
            "state = _state(balance, first[0], count, tolerance)",
            "state = _state(balance, balance.position, count, tolerance)",
        ),
        "stale",
        "positions of a state without free nodes are the array of the network itself",
        _MEMORY,
    ),
    # ------------------------------------------------------------ network_scene
    Defect(
        "friction of a line lost",
        Fault("io.network_scene", "_element", 'table.get("friction", 0.0)', "0.0"),
        "input",
        "friction in a network's file is read and not used",
        _TOML,
    ),
    Defect(
        "anchor and fairlead exchanged in the file",
        Fault("io.network_scene", "_element", '("anchor", "fairlead")', '("fairlead", "anchor")'),
        "symbol",
        "elements run from the fairlead to the anchor",
        _TOML,
    ),
    Defect(
        "weights of another sea",
        Fault("io.network_scene", "_element", "cable.weight_in(environment)", "cable.weight_in(Environment())"),
        "stale",
        "weights follow the default density and gravity, not those of the file",
        "io/test_network_scene.py::test_weights_follow_the_environment_of_the_file",
    ),
    # ------------------------------------------------------------ map_plus_plus
    Defect(
        "copies turned the other way",
        Fault(
            "io.map_plus_plus.reader",
            "_turned",
            "(c * x + s * y, c * y - s * x, z)",
            "(c * x - s * y, c * y + s * x, z)",
        ),
        "sign",
        "repeat turns nodes counter-clockwise",
        "io/test_map_file.py::test_repeat_turns_clockwise_from_above",
    ),
    Defect(
        "forces stay where they were",
        Fault(
            "io.map_plus_plus.reader",
            "_turned",
            "replace(node, r=(c * x + s * y, c * y - s * x, z), force=(c * fx + s * fy, c * fy - s * fx, fz))",
            "replace(node, r=(c * x + s * y, c * y - s * x, z), force=(fx, fy, fz))",
        ),
        "term",
        "repeat turns the nodes and not the forces on them",
        "io/test_map_file.py::test_repeat_turns_clockwise_from_above",
    ),
    Defect(
        "degrees for radians",
        Fault(
            "io.map_plus_plus.reader",
            "_turned",
            "math.cos(math.radians(degrees)), math.sin(math.radians(degrees))",
            "math.cos(degrees), math.sin(degrees)",
        ),
        "unit",
        "angles of repeat are taken for radians",
        "io/test_map_file.py::test_repeat_turns_clockwise_from_above",
    ),
    Defect(
        "nodes counted from one",
        Fault("io.map_plus_plus.reader", "_element", 'int(row["NodeFair"]) - 1', 'int(row["NodeFair"])'),
        "index",
        "the fairlead is the node after the one that the file names",
        _MAP,
    ),
    Defect(
        "mass and volume exchanged",
        Fault(
            "io.map_plus_plus.reader",
            "_node",
            'row.checked(Node, kind, r, row.number("M"), row.number("B"), tuple(loads))',
            'row.checked(Node, kind, r, row.number("B"), row.number("M"), tuple(loads))',
        ),
        "symbol",
        "columns M and B of a node",
        "io/test_map_file.py::test_loads_of_nodes",
    ),
    Defect(
        "guessed reactions are loads",
        Fault(
            "io.map_plus_plus.reader",
            "_node",
            "row[f].startswith('#') and (not free)",
            "False and row[f].startswith('#') and (not free)",
        ),
        "input",
        "a guess of an unknown reaction acts as a force",
        "io/test_map_file.py::test_a_guessed_reaction_is_no_load",
    ),
    Defect(
        "friction from the column of damping",
        Fault(
            "io.map_plus_plus.reader",
            "_line_type",
            "values = {'w': cable.weight_in(environment), 'EA': EA, 'friction': friction}",
            "values = {'w': cable.weight_in(environment), 'EA': EA, 'friction': pressure}",
            where="{'CIntDamp': pressure, 'Ca': Ca, 'Cdn': Cdn, 'Cdt': Cdt}",
        ),
        "index",
        "CIntDamp is read as CB",
        _MAP,
    ),
    Defect(
        "degrees of a series taken for radians",
        Fault("io.series.motion_file", "_from_series", "np.radians(series)", "series"),
        "unit",
        "a column yaw_deg is read as yaw",
        "io/test_motion_file.py::test_columns_stand_in_any_order_and_angles_in_degrees",
    ),
    Defect(
        "network file without sections",
        Fault("io.network_scene", "_element", "cable.diameter and cable.mass_per_length", "False"),
        "input",
        "the dynamic properties of line types are read and dropped",
        "io/test_motion_file.py::test_the_example_moves_in_three_degrees_of_freedom",
    ),
    Defect(
        "series about the origin",
        Fault(
            "io.series.motion_file",
            "motion_from_table",
            "load_body_motion(folder / table['file'], reference)",
            "load_body_motion(folder / table['file'])",
        ),
        "input",
        "a series turns about the origin whatever reference the table names",
        "io/test_motion_file.py::test_a_series_beside_the_network",
    ),
    Defect(
        "pressure of damping taken for a force",
        Fault("io.map_plus_plus.reader", "_line_type", "pressure * cable.area / EA", "pressure / EA"),
        "unit",
        "CIntDamp (Pa s) is not multiplied by the area of the section",
        "io/test_map_file.py::test_coefficients_of_motion_arrive",
    ),
    # ------------------------------------------------------------ MoorDyn files
    Defect(
        "damping ratio of a whole line",
        Fault("io.moordyn.reader", "_element", "-BA * length / segments", "-BA * length"),
        "factor",
        "the share of critical damping is taken of the line, not of a segment",
        "io/test_moordyn_file.py::test_damping_is_a_time_whichever_way_it_is_given",
    ),
    Defect(
        "damping without stiffness",
        Fault("io.moordyn.writer", "_line_type", "cable.damping * cable.EA", "cable.damping"),
        "unit",
        "BA (N s) is written in s",
        "io/test_moordyn_file.py::test_a_network_comes_back_as_it_was_written",
    ),
    Defect(
        "seabed per area taken per length",
        Fault("io.moordyn.reader", "_environment", "options['kBot'] * thickest", "options['kBot']"),
        "unit",
        "the stiffness of the seabed lacks the diameter",
        "io/test_moordyn_file.py::test_every_column_arrives",
    ),
    Defect(
        "axial coefficients swapped",
        Fault("io.moordyn.reader", "_element", "'CdAx'", "'CaAx'"),
        "symbol",
        "added mass along the line is read as drag along it",
        "io/test_moordyn_file.py::test_every_column_arrives",
    ),
    Defect(
        "bending stiffness dropped",
        Fault("io.moordyn.reader", "_line_types", "('EI', 'bending stiffness')", "('CaAx', 'bending stiffness')"),
        "input",
        "a line with bending stiffness is read as a cable",
        "io/test_moordyn_file.py::test_what_is_wrong_is_named_with_its_line",
    ),
    Defect(
        "MoorDyn 1 read as MoorDyn 2",
        Fault("io.moordyn.tables", "_row", "columns = MOORDYN_1_LINES", "pass"),
        "input",
        "UnstrLen is read as an end",
        "io/test_moordyn_file.py::test_a_file_of_moordyn_1_has_other_columns",
    ),
    # ------------------------------------------------------------ declared blind spot
    Defect(
        "softer first stage",
        Fault("network.start", "", "1.0, 1e-3", "2.0, 1e-3"),
        "factor",
        "the first stage of the continuation that leads to a start",
        f"{_CLOSED} {_AGREE} -k 'closed or bridle or friction'",
        blind="a start: all methods converge to the same balance, and what the start cost is part of no claim",
    ),
    # ------------------------------------------------------------ io.keys, io.schema, io.plausibility
    Defect(
        "usual names of keys not looked up",
        Fault("io.keys", "describe_likely_key", 'ALIASES.get(known, "").split()', "()"),
        "input",
        "Cd is said to be Cdt, the nearest in letters",
        "io/test_schema.py::test_the_usual_name_leads_to_the_key",
    ),
    Defect(
        "missing keys pass",
        Fault("io.keys", "check_keys", "about.required and key not in table", "False"),
        "input",
        "a table without a key that it must have is read on",
        "io/test_schema.py::test_what_is_broken_fails_in_schema_and_reader",
    ),
    Defect(
        "schema with room for any key",
        Fault("io.schema", "_table", "additionalProperties=False", "additionalProperties=True"),
        "input",
        "an editor marks no key that is not known",
        "io/test_schema.py::test_what_is_broken_fails_in_schema_and_reader",
    ),
    Defect(
        "section of a line by its radius",
        Fault("io.plausibility", "_area", "math.pi * diameter**2 / 4", "math.pi * diameter**2"),
        "factor",
        "densities and moduli four times too small: ordinary rope is suspected",
        "io/test_plausibility.py::test_ordinary_systems_of_new_users_run",
    ),
    Defect(
        "weight held against that in air",
        Fault("io.plausibility", "_suspect_weight", "environment.rho * _area(diameter) * g", "0 * g"),
        "term",
        "the weight that mass and diameter make has no buoyancy",
        "io/test_plausibility.py::test_a_slip_is_suspected_with_the_likely_unit",
    ),
    Defect(
        "phases in degrees pass",
        Fault("io.plausibility", "suspect_phases", "2 * math.pi * (1 + 1e-6)", "360.0"),
        "unit",
        "a phase of 90 rad is no surprise",
        "io/test_plausibility.py::test_a_slip_is_suspected_with_the_likely_unit",
    ),
    Defect(
        "damping written as a time",
        Fault("io.map_plus_plus.writer", "_type", "cable.damping * cable.EA / cable.area", "cable.damping"),
        "unit",
        "MAP++ takes the viscosity of the section in Pa s",
        "io/test_map_writer.py::test_a_network_comes_back_as_it_was_written",
    ),
)
