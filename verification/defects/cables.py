"""Defects of the cable and of what it is made of: properties, motion, loads, cable*, chain, statics, shooting."""

from __future__ import annotations

from collections.abc import Iterable

from ..cases.cables import ERRATA_FAULTS, LOAD_FAULTS
from .defect import Defect

_PATCH = "cable/test_order.py::test_fields_linear_in_s_leave_no_residual"
_GEOMETRY = "cable/test_order.py::test_geometry_is_that_of_the_conventions"
_TANGENTS = "cable/test_jacobian.py::test_tangents_of_the_rows"
_EQUILIBRIUM = "cable/test_jacobian.py::test_tangents_of_the_equilibrium"
_BAND = "cable/test_jacobian.py::test_the_band_is_the_whole_matrix"
_OVERLAP = "harmonic_balance/test_start.py::test_overlapping_solves_leave_the_threads_as_they_were"
_MEETS = "cable/test_statics.py::test_the_equilibrium_solves_the_rows_and_meets_the_ends"
_SHOT = "cable/test_statics.py::test_shooting_agrees_with_the_truth"
_RATES = "common/test_motion.py::test_rates_are_derivatives"
_RAMP = "common/test_motion.py::test_ramp_starts_from_rest_and_ends_in_the_motion"

# ---------------------------------------------------------------- those that the checks of the cable plant themselves
_BY_TANGENTS = ("d|q|q/dq", "d|q|/dq", "cross tangent", "seabed's tangent")
_BY_GEOMETRY = ("positions twice", "drift by")


def _check(module: str, what: str) -> str:
    """The check for a fault of the equations of motion."""
    if any(word in what for word in _BY_TANGENTS):
        return _TANGENTS
    if any(word in what for word in _BY_GEOMETRY):
        return _GEOMETRY
    if "runs off" in what:
        return "cable/test_order.py::test_fields_linear_in_s_and_t_are_reproduced -k bare"
    fields = {"cable.planar": " and planar", "cable.spatial": " and spatial"}.get(module, "")
    return f"{_PATCH} -k 'all{fields}'"


def reused(faults: Iterable[tuple[str, str, str, str]], kind: str, check) -> tuple[Defect, ...]:
    """Defects of a table (module, old, new, what); those that begin with "HB (n)" are misprints."""
    found = []
    for module, old, new, what in faults:
        misprint = what.split(":")[0] if what.startswith("HB (") else ""
        name = f"{what.removeprefix(misprint).strip(': ')}, {module}"
        own = "misprint" if misprint else kind
        found.append(Defect(name, module, old, new, own, what, check(module, what), misprint=misprint))
    return tuple(found)


DEFECTS = (
    *reused(ERRATA_FAULTS, "misprint", _check),
    *reused(LOAD_FAULTS, "term", _check),
    # ------------------------------------------------------------ outcome, properties, scene
    Defect(
        "a status that is no refusal is a success",
        "common.outcome",
        "return self.status is Status.SUCCESS",
        "return self.status is not Status.INVALID_INPUT",
        "regime",
        "every result but that of bad input says that it can be used",
        "common/test_failures.py::test_undetermined_friction_without_throw",
    ),
    Defect(
        "failures are not thrown",
        "common.outcome",
        "if self.status is not Status.SUCCESS:",
        "if self.status is Status.INVALID_INPUT:",
        "regime",
        "a failed solve returns its numbers although throw is on",
        "common/test_failures.py::test_forces_out_of_range_are_an_error",
    ),
    Defect(
        "area from the diameter as radius",
        "common.properties",
        "return math.pi * self.diameter**2 / 4",
        "return math.pi * self.diameter**2",
        "factor",
        "pi d^2 for pi d^2/4",
        "io/test_network_scene.py::test_weights_follow_the_environment_of_the_file",
    ),
    Defect(
        "weight in air",
        "common.properties",
        "environment.g * (self.mass_per_length - environment.rho * self.area)",
        "environment.g * self.mass_per_length",
        "misprint",
        "section 5: 226.61 N/m is the mass times g, without the displaced water",
        "io/test_network_scene.py::test_weights_follow_the_environment_of_the_file",
        misprint="MSQS section 5, weight",
    ),
    Defect(
        "added mass counts the water twice",
        "common.properties",
        "return self.Ca * environment.rho * self.area",
        "return (1 + self.Ca) * environment.rho * self.area",
        "symbol",
        "C_m for C_a in the added mass",
        _PATCH + " -k all",
    ),
    Defect(
        "zero lets through",
        "common.properties",
        "    if value <= 0:\n",
        "    if value < 0:\n",
        "input",
        "a stiffness, length or depth of zero is accepted",
        "common/test_failures.py::test_properties_are_validated_when_built",
    ),
    Defect(
        "infinite is a number",
        "common.properties",
        "    if not math.isfinite(value):\n",
        "    if math.isnan(value):\n",
        "input",
        "infinite inputs are accepted",
        "common/test_failures.py::test_numbers_must_be_finite",
    ),
    Defect(
        "span along x only",
        "io.scene",
        '"x": math.hypot(x1 - x0, y1 - y0)',
        '"x": abs(x1 - x0)',
        "term",
        "the horizontal distance forgets y",
        "catenary/test_invariants.py::test_a_scene_can_be_turned_about_the_vertical",
    ),
    Defect(
        "period taken for the frequency",
        "io.scene",
        "        frequency = 1 / frequency\n",
        "        frequency = 1 * frequency\n",
        "unit",
        "a motion given by its period moves with so many hertz",
        "io/test_scene.py::test_every_key_arrives",
    ),
    Defect(
        "phase lost in the cosines",
        "io.scene",
        "amplitude * np.cos(phase), amplitude * np.sin(phase))",
        "amplitude * np.cos(phase), amplitude * np.sin(np.radians(phase)))",
        "unit",
        "the cosines of a motion take its phase for degrees",
        "io/test_scene.py",
    ),
    Defect(
        "fairlead below the seabed moves on",
        "io.scene",
        "        if lowest < -depth:\n",
        "        if lowest < -10 * depth:\n",
        "input",
        "a motion may take the fairlead through the seabed",
        "io/test_scene.py::test_bad_scenes_with_motion",
    ),
    # ------------------------------------------------------------ motion
    Defect(
        "velocity of the cosines",
        "common.motion",
        "return self._omega * self.sine.T, -self._omega * self.cosine.T",
        "return self._omega * self.sine.T, self._omega * self.cosine.T",
        "sign",
        "d/dt cos = + sin",
        _RATES,
    ),
    Defect(
        "hertz for radians per second",
        "common.motion",
        "return 2 * math.pi * self.frequency * np.arange",
        "return self.frequency * np.arange",
        "unit",
        "the frequency is used as the angular one",
        "common/test_motion.py::test_harmonic_motion_is_a_sine_with_phase",
    ),
    Defect(
        "harmonics counted from zero",
        "common.motion",
        "np.arange(1, self.harmonics + 1)",
        "np.arange(self.harmonics)",
        "index",
        "the first harmonic stands still, the second moves with the first's frequency",
        "common/test_motion.py::test_harmonic_motion_is_a_sine_with_phase",
    ),
    Defect(
        "rate of the ramp per step, not per second",
        "common.motion",
        "(1 - x) ** 2 / self.duration, 60",
        "(1 - x) ** 2, 60",
        "unit",
        "dq/dt of the ramp is dq/dx",
        _RATES,
    ),
    Defect(
        "product rule without its 2",
        "common.motion",
        "q_tt * r + 2 * q_t * v + q * a",
        "q_tt * r + q_t * v + q * a",
        "factor",
        "acceleration of a ramped motion",
        _RATES,
    ),
    Defect(
        "ramp that jumps",
        "common.motion",
        "q = x**3 * (10 - 15 * x + 6 * x**2)",
        "q = x**3 * (10 - 15 * x + 7 * x**2)",
        "factor",
        "the ramp ends at 2 and the motion at 1",
        _RATES,
    ),
    Defect(
        "spline one piece further",
        "common.motion",
        'side="right") - 1, 0, len(self.time) - 2)',
        'side="right"), 0, len(self.time) - 2)',
        "index",
        "a time of a series is looked up in the next piece of the spline",
        "common/test_found_by_defects.py::test_a_series_goes_through_its_samples",
    ),
    Defect(
        "everything moves in a plane",
        "common.motion",
        "extent > _SAME_DIRECTION * max",
        "extent > 0.5 * max",
        "tolerance",
        "directions of a motion smaller than half its largest are left out",
        "common/test_motion.py::test_directions_span_the_motion_and_no_more",
    ),
    # ------------------------------------------------------------ cable
    Defect(
        "anchor row one field early",
        "cable.system",
        "value = y[1 : 1 + self.start_rows, 0].copy()",
        "value = y[0 : self.start_rows, 0].copy()",
        "boundary",
        "the anchor holds its strain instead of its last velocity",
        _TANGENTS + " -k planar",
    ),
    Defect(
        "anchor held at the next node",
        "cable.system",
        "value = y[1 : 1 + self.start_rows, 0].copy()",
        "value = y[1 : 1 + self.start_rows, 1].copy()",
        "boundary",
        "the boundary condition of the anchor is that of its neighbour",
        _TANGENTS + " -k planar",
    ),
    Defect(
        "fairlead one node short",
        "cable.system",
        "self._rows.velocity(y[:, -1], tangents)",
        "self._rows.velocity(y[:, -2], tangents)",
        "boundary",
        "the prescribed velocity acts on the last node but one",
        "cable/test_order.py::test_fields_linear_in_s_and_t_are_reproduced -k bare",
    ),
    Defect(
        "anchor's height is that of still water",
        "cable.system",
        "value[-1] = y[-1, 0] - self.anchor[2]",
        "value[-1] = y[-1, 0]",
        "boundary",
        "over a seabed the anchor is at z = 0",
        _MEETS + " -k seabed",
    ),
    Defect(
        "motion across the line forgotten",
        "cable.system",
        "for vector in (current, *moves))",
        "for vector in (current,))",
        "regime",
        "a sway is computed in the plane of the line, where it does nothing",
        "cable/test_invariants.py::test_the_scene_picks_the_fields",
    ),
    Defect(
        "out-of-plane axis to the other side",
        "cable.system",
        "[cx, cy, 0.0], [-cy, cx, 0.0]])",
        "[cx, cy, 0.0], [cy, -cx, 0.0]])",
        "sign",
        "a left-handed frame: sideways motion and current are mirrored",
        _GEOMETRY + " -k spatial",
    ),
    Defect(
        "line always along x",
        "cable.system",
        "cx, cy = (dx / span, dy / span) if span > 0",
        "cx, cy = (1.0, 0.0) if span > 0",
        "term",
        "the azimuth of the line is not looked at",
        "cable/test_invariants.py::test_the_scene_picks_the_fields",
    ),
    Defect(
        "weights of the other cells",
        "cable.system",
        "weights[:-1] += self.ds / 2",
        "weights[:-1] += self.ds[::-1] / 2",
        "index",
        "the trapezoidal rule is right on even meshes only",
        "common/test_found_by_defects.py::test_drift_is_the_end_of_the_positions_on_any_mesh",
    ),
    Defect(
        "damping out of the tension",
        "cable.system",
        "y[0] if ydot is None else y[0] + self.beta * ydot[0]",
        "y[0] if ydot is None else y[0]",
        "term",
        "the tension that is reported has no part of the material's damping",
        "common/test_found_by_defects.py::test_tension_has_its_part_of_damping",
    ),
    Defect(
        "mirror keeps the sideways velocity",
        "cable.system",
        "(1, 1, 1, -1, 1, -1, *z), (1, 1, -1, *z),",
        "(1, 1, 1, 1, 1, -1, *z), (1, 1, -1, *z),",
        "sign",
        "the symmetry of the system has a wrong sign for w",
        "cable/test_invariants.py::test_the_mirror_of_the_system_is_its_symmetry",
    ),
    Defect(
        "compression anywhere is fine",
        "cable.system",
        "if y[0][least] < 0:",
        "if y[0][least] < -1:",
        "regime",
        "a cable in compression is no event",
        "harmonic_balance/test_solve.py::test_compression_is_named",
    ),
    Defect(
        "equilibrium of another system",
        "cable.system",
        "        ramped = copy.copy(self)\n",
        "        self.motion, self.__dict__['_equilibrium'] = self.motion, 0 * self.rest()\n"
        "        ramped = copy.copy(self)\n",
        "stale",
        "a copy of a system takes over an equilibrium that is none",
        "cable/test_invariants.py::test_shifting_the_line_changes_nothing",
    ),
    # ------------------------------------------------------------ cable_planar, cable_spatial
    Defect(
        "drag by the length of the chord",
        "cable.planar",
        "value / (2 * stretch * stretch), slope",
        "value / (stretch * stretch), slope",
        "derivative",
        "d/d(eps) of sqrt(1 + eps) without its half",
        _TANGENTS + " -k 'planar and tangential'",
    ),
    Defect(
        "current of the neighbour",
        "cable.planar",
        "by[1, PHI] -= c.inertia * across * phi_t",
        "by[1, PHI] -= c.inertia * along * phi_t",
        "symbol",
        "tangent of the current's inertia with the wrong component",
        _TANGENTS + " -k 'planar and current'",
    ),
    Defect(
        "angles exchanged in the weight",
        "cable.spatial",
        "M36 * theta_t - c.w0 * cos_p * sin_t + Fdb",
        "M36 * theta_t - c.w0 * sin_p * cos_t + Fdb",
        "symbol",
        "row 3 with phi and theta exchanged",
        f"{_PATCH} -k 'all and spatial'",
    ),
    Defect(
        "twist of a binormal",
        "cable.spatial",
        "self.n_phi, self.t_theta, self.b_theta = -level, -self.b, self.t",
        "self.n_phi, self.t_theta, self.b_theta = -level, self.b, self.t",
        "sign",
        "derivative of the current along the tangent by theta",
        _TANGENTS + " -k 'spatial and current'",
    ),
    *(
        Defect(
            f"the seabed pulls at the middle of a cell, {module}",
            module,
            f"{rows} += c.support(y[Z])[0] * _up(y)",
            f"{rows} -= c.support(y[Z])[0] * _up(y)",
            "sign",
            "support of the seabed reversed in the rows of fourth order",
            f"cable/test_order.py::test_order_of_the_corrected_rows -k 'seabed and {fields}'",
        )
        for module, rows, fields in (("cable.planar", "F[:2]", "planar"), ("cable.spatial", "F[:3]", "spatial"))
    ),
    Defect(
        "a seabed that carries the weight at most",
        "cable.system",
        "return seabed_support(self.seabed_stiffness, self.scene.environment.depth, z)",
        "support, slope = seabed_support(self.seabed_stiffness, self.scene.environment.depth, z)\n"
        "        return np.minimum(support, self.w0), np.where(support < self.w0, slope, 0.0)",
        "regime",
        "the limit of statics, HB 2.5, in motion: nothing stops a line that sinks deeper than at rest",
        "suite/test_stability.py::test_a_slack_chain_on_a_seabed_settles",
    ),
    Defect(
        "a hold as strong as on a fine mesh",
        "cable.system",
        "return min(1.0, float(_SMALL_TURN",
        "return max(1.0, float(_SMALL_TURN",
        "symbol",
        "the greater for the smaller: the gain of the hold is one on every mesh",
        "suite/test_stability.py::test_a_slack_chain_on_a_seabed_settles",
    ),
    # ------------------------------------------------------------ chain
    Defect(
        "band one row off",
        "numerics.chain",
        "(self.kl + self.ku + i - j))",
        "(self.kl + self.ku + i - j - (i > j)))",
        "index",
        "entries below the diagonal stand one row too high in the band storage",
        _BAND,
    ),
    Defect(
        "end rows where the last cell ends",
        "numerics.chain",
        "self._end = self._position(n - fields + first + row, n - fields + column)",
        "self._end = self._position(n - fields + row, n - fields + column)",
        "boundary",
        "rows of the last node are written over rows of the last cell",
        _BAND,
    ),
    Defect(
        "product with the other neighbour",
        "numerics.chain",
        'np.einsum("ijn,jn->in", cells[1], x[:, 1:])',
        'np.einsum("ijn,jn->in", cells[1], x[:, :-1])',
        "index",
        "tangents of the right nodes times the left ones",
        "common/test_found_by_defects.py::test_tangents_times_a_state_are_the_change_of_the_rows",
    ),
    Defect(
        "cells field after field",
        "numerics.chain",
        "middle = cells.value.swapaxes(0, 1).reshape(",
        "middle = cells.value.reshape(",
        "index",
        "rows of the cells in another order than the unknowns",
        _BAND,
    ),
    # ------------------------------------------------------------ statics, shooting
    Defect(
        "place by the tangent at the far end",
        "cable.statics",
        "- tangent[:, 1:] - tangent[:, :-1]",
        "- 2 * tangent[:, 1:]",
        "order",
        "positions of the equilibrium by a rule of first order",
        "cable/test_statics.py::test_box_scheme_converges_to_the_catenary -k 'uniform and OC3'",
    ),
    Defect(
        "tangent of the places",
        "cable.statics",
        "J[side, n:, :n] = -slope[:, self.angles, at]",
        "J[side, n:, :n] = slope[:, self.angles, at]",
        "derivative",
        "rows of the places by strain and angles have the wrong sign in the Jacobian",
        _EQUILIBRIUM + " -k planar",
    ),
    Defect(
        "pull of the line on the vessel outwards",
        "cable.statics",
        "return -self.tension[-1] * self.system.direction(self.y)[:, -1]",
        "return self.tension[-1] * self.system.direction(self.y)[:, -1]",
        "sign",
        "the force on the vessel points away from the line",
        _SHOT + " -k plane",
    ),
    Defect(
        "anchor's force in the direction of the fairlead's",
        "cable.statics",
        "return self.tension[0] * self.system.direction(self.y)[:, 0]",
        "return self.tension[0] * self.system.direction(self.y)[:, -1]",
        "index",
        "the force on the anchor has the tangent of the other end",
        _SHOT + " -k plane",
    ),
    Defect(
        "equilibrium to three digits",
        "cable.statics",
        "TOLERANCE = 1e-11",
        "TOLERANCE = 1e-3",
        "tolerance",
        "Newton's method for the equilibrium stops after its first good step",
        _MEETS,
    ),
    Defect(
        "half the current is the current",
        "cable.statics",
        "_Statics(_eased(system, x, share)).newton(x, tolerance)",
        "_Statics(_eased(system, x, share / 2)).newton(x, tolerance)",
        "regime",
        "the continuation ends half way and calls it the equilibrium",
        "cable/test_statics.py::test_a_strong_current_is_reached_in_steps",
    ),
    Defect(
        "shot without stretch",
        "cable.shooting",
        "_direction(F)[0] * (1 + _direction(F)[1] / system.EA)",
        "_direction(F)[0]",
        "term",
        "dr/ds = t in the shooting method",
        _SHOT + " -k plane",
    ),
    Defect(
        "drag of the binormal to the normal",
        "cable.shooting",
        "drag + (system.drag_b - system.drag_n)",
        "drag - (system.drag_b - system.drag_n)",
        "sign",
        "C_db and C_dn exchanged about their mean in the shooting method",
        "common/test_found_by_defects.py::test_shooting_knows_the_binormal",
    ),
    Defect(
        "tangential drag on stretched length twice",
        "cable.shooting",
        "np.sqrt(1 + T / system.EA)",
        "(1 + T / system.EA)",
        "term",
        "1 + eps for its root in the drag of the shooting method",
        _SHOT + " -k plane",
    ),
    # ------------------------------------------------------------ declared blind spots
    Defect(
        "start of the equilibrium too taut",
        "cable.statics",
        "        x[0] = T / system.EA\n",
        "        x[0] = 1.05 * T / system.EA\n",
        "factor",
        "the strain that the iteration for the equilibrium starts from",
        f"{_MEETS} {_SHOT} cable/test_statics.py::test_the_oc3_line_is_that_of_the_notes",
        blind="a start: the same equilibrium comes out, with the same number of steps or one more",
    ),
    Defect(
        "two BLAS threads",
        "numerics.threads",
        "limits=1,",
        "limits=2,",
        "factor",
        "the number of threads of the linear algebra",
        _OVERLAP,
    ),
    Defect(
        "threads of the first thread alone",
        "numerics.threads",
        'if hasattr(library, "clear_controlling_thread"):',
        "if False:",
        "regime",
        "after a solve in one thread of Python the linear algebra heeds no other one",
        _OVERLAP,
    ),
    Defect(
        "threads back before the last has left",
        "numerics.threads",
        "limits := _entered.pop()",
        "limits := _entered.pop(0)",
        "stale",
        "of solves that overlap in threads of Python the second ends with all threads of the linear algebra",
        _OVERLAP,
    ),
)
