"""Defects of the cable and of what it is made of: properties, motion, loads, cable*, chain, statics, shooting."""

from __future__ import annotations

from collections.abc import Iterable

from ...tools.planting import Fault
from ..defect import Defect

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


def reused(faults: Iterable[tuple[Fault, str]], kind: str, check) -> tuple[Defect, ...]:
    """Return the defects of a table (fault, what); those that begin with "HB (n)" are misprints."""
    defects = []
    for fault, what in faults:
        misprint = what.split(":")[0] if what.startswith("HB (") else ""
        name = f"{what.removeprefix(misprint).strip(': ')}, {fault.module}"
        own = "misprint" if misprint else kind
        defects.append(Defect(name, fault, own, what, check(fault.module, what), misprint=misprint))
    return tuple(defects)


ERRATA_FAULTS = [
    (
        Fault(
            "cable.equations",
            "CableEquations._set_loads",
            "(1 + cable.Ca) * rho * cable.area",
            "(1 + cable.Ca) * rho * d**2 / 4",
            where="0.5 * rho * math.pi * d",
        ),
        "HB (22): C_m rho d^2/4",
    ),
    (
        Fault("cable.planar", "add_stiffness", "F[1] += T * y_s[PHI]", "F[1] -= T * y_s[PHI]"),
        "HB (30): f2 with -EA eps cos(theta) dphi/ds",
    ),
    (
        Fault("cable.spatial", "add_stiffness", "F[1] += k25 * D_phi", "F[1] -= k25 * D_phi"),
        "HB (30): f2 with -EA eps cos(theta) dphi/ds",
    ),
    (
        Fault(
            "cable.spatial",
            "add_stiffness",
            "count * y_s[W] - k65 * D_phi - k66 * D_theta",
            "count * y_s[W] - k65 * D_phi + k66 * D_theta",
        ),
        "HB (34): f6, +u dtheta/ds",
    ),
    (
        Fault("cable.planar", "add_stiffness", "count * y_s[U]", "2 * count * y_s[U]"),
        "HB (37): the constant part of K counted twice, row 4",
    ),
    (
        Fault("cable.spatial", "add_stiffness", "F[2] -= T * D_theta", "F[2] -= 2 * T * D_theta"),
        "HB (37): the same, row 3",
    ),
    (
        Fault(
            "cable.planar",
            "local_terms",
            "m * (v * phi_t - u_t)",
            "c.EA * c.beta * eps_t + m * (v * phi_t - u_t)",
            where="c.EA * (eps + c.beta * eps_t)",
        ),
        "HB (1), (28): damping EA beta d(eps)/dt in the momentum balance",
    ),
    (
        Fault(
            "cable.spatial",
            "local_terms",
            "m * (v * cos_t * phi_t - w * theta_t - u_t)",
            "c.EA * c.beta * eps_t + m * (v * cos_t * phi_t - w * theta_t - u_t)",
            where="c.EA * (eps + c.beta * eps_t)",
        ),
        "HB (1), (28): damping EA beta d(eps)/dt in the momentum balance",
    ),
]
"""The misprints of HB sections 2 and 3 that touch the equations of motion, as they would stand in the solvers."""

LOAD_FAULTS = [
    (
        Fault("cable.equations", "CableEquations._set_loads", "0.5 * rho * math.pi * d", "0.5 * rho * d"),
        "tangential drag on d l, not pi d l",
    ),
    (
        Fault("cable.equations", "CableEquations._set_loads", "0.5 * rho * d * cable.Cdn", "rho * d * cable.Cdn"),
        "normal drag without its half",
    ),
    (Fault("cable.equations", "CableEquations._set_loads", "cable.Cdb", "cable.Cdn"), "binormal drag with C_dn"),
    (
        Fault("cable.equations", "CableEquations._set_loads", "(1 + cable.Ca) * rho", "cable.Ca * rho"),
        "C_m = C_a: no Froude-Krylov force",
    ),
    (
        Fault("cable.equations", "CableEquations._box_scheme", "F[:n] += support * S_up", "F[:n] -= support * S_up"),
        "the seabed pulls",
    ),
    (
        Fault(
            "cable.equations",
            "CableEquations._box_scheme",
            "(y[-1, 1:] + y[-1, :-1]) / 2",
            "y[-1, 1:] + y[-1, :-1]",
        ),
        "the seabed at the sum of two heights",
    ),
    (Fault("cable.equations", "CableEquations.cells", "np.subtract", "np.add"), "source with the wrong sign"),
    (Fault("cable.equations", "CableEquations.positions", "self.ds / 2", "self.ds"), "positions twice as far"),
    (
        Fault("cable.mesh", "trapezoidal_weights", "weights[1:] += ds / 2", "weights[1:] += ds"),
        "drift by a wrong quadrature",
    ),
    (
        Fault(
            "cable.equations",
            "CableEquations.end",
            "value - self.axes @ self.motion.velocity(t)",
            "value + self.axes @ self.motion.velocity(t)",
        ),
        "the end runs off",
    ),
    (Fault("cable.loads", "quadratic_drag", "-coefficient", "coefficient"), "(10): drag drives"),
    (Fault("cable.loads", "quadratic_drag", "2 * slope", "slope"), "(10): d|q|q/dq = |q|"),
    (
        Fault(
            "cable.loads",
            "transverse_drag",
            "-normal * v * speed, -binormal * w * speed",
            "normal * v * speed, -binormal * w * speed",
        ),
        "(11): drag drives",
    ),
    (
        Fault(
            "cable.loads",
            "transverse_drag",
            "-normal * v * speed, -binormal * w * speed",
            "-normal * v * speed, binormal * w * speed",
        ),
        "(12): drag drives",
    ),
    (
        Fault(
            "cable.loads",
            "transverse_drag",
            "(-normal * (speed + vv), -normal * vw)",
            "(-normal * speed, -normal * vw)",
        ),
        "(11): d|q|/dq left out",
    ),
    (
        Fault(
            "cable.loads",
            "transverse_drag",
            "(-binormal * vw, -binormal * (speed + ww))",
            "(0 * vw, -binormal * (speed + ww))",
        ),
        "(12): cross tangent left out",
    ),
    (Fault("cable.loads", "transverse_drag", "v * v + w * w", "v * v"), "(11), (12): each component alone"),
    (Fault("cable.loads", "seabed_support", "-depth - z", "-depth + z"), "seabed above the water"),
    (
        Fault("cable.loads", "seabed_support", "np.where(touching, support, 0.0)", "support"),
        "the seabed holds the line down",
    ),
    (
        Fault(
            "cable.loads",
            "seabed_support",
            "np.where(touching, -stiffness, 0.0)",
            "-stiffness + 0.0 * z",
            where="-depth - z",
        ),
        "the seabed's tangent above it",
    ),
    (Fault("cable.planar", "local_terms", "np.sqrt(1 + eps)", "(1 + eps)"), "(10), (11): 1 + eps for its root"),
    (Fault("cable.spatial", "local_terms", "np.sqrt(1 + eps)", "1 + eps"), "(10)-(12): 1 + eps for its root"),
    (
        Fault("cable.equations", "CableEquations._box_scheme", "q[1:] + q[:-1]", "2 * q[1:]"),
        "(39): K of one node, not the mean",
    ),
]
"""Loads, kinematics and their coefficients: each changes what a system is, not how it is solved."""


DEFECTS = (
    *reused(ERRATA_FAULTS, "misprint", _check),
    *reused(LOAD_FAULTS, "term", _check),
    # ------------------------------------------------------------ outcome, properties, scene
    Defect(
        "a status that is no refusal is a success",
        Fault(
            "common.outcome",
            "Outcome.success",
            "self.status is Status.SUCCESS",
            "self.status is not Status.INVALID_INPUT",
        ),
        "regime",
        "every result but that of bad input says that it can be used",
        "common/test_failures.py::test_undetermined_friction_without_throw",
    ),
    Defect(
        "failures are not thrown",
        Fault(
            "common.outcome",
            "Outcome.or_raise",
            "self.status is not Status.SUCCESS",
            "self.status is Status.INVALID_INPUT",
        ),
        "regime",
        "a failed solve returns its numbers although throw is on",
        "common/test_failures.py::test_forces_out_of_range_are_an_error",
    ),
    Defect(
        "area from the diameter as radius",
        Fault(
            "common.properties", "CableProperties.area", "math.pi * self.diameter**2 / 4", "math.pi * self.diameter**2"
        ),
        "factor",
        "pi d^2 for pi d^2/4",
        "io/test_network_scene.py::test_weights_follow_the_environment_of_the_file",
    ),
    Defect(
        "weight in air",
        Fault(
            "common.properties",
            "CableProperties.weight_in",
            "environment.g * (self.mass_per_length - environment.rho * self.area)",
            "environment.g * self.mass_per_length",
        ),
        "misprint",
        "section 5: 226.61 N/m is the mass times g, without the displaced water",
        "io/test_network_scene.py::test_weights_follow_the_environment_of_the_file",
        misprint="MSQS section 5, weight",
    ),
    Defect(
        "added mass counts the water twice",
        Fault("common.properties", "CableProperties.added_mass", "self.Ca", "(1 + self.Ca)"),
        "symbol",
        "C_m for C_a in the added mass",
        _PATCH + " -k all",
    ),
    Defect(
        "zero lets through",
        Fault("common.validation", "positive_number", "value <= 0", "value < 0"),
        "input",
        "a stiffness, length or depth of zero is accepted",
        "common/test_failures.py::test_properties_are_validated_when_built",
    ),
    Defect(
        "infinite is a number",
        Fault("common.validation", "real_number", "not math.isfinite(number)", "math.isnan(number)"),
        "input",
        "infinite inputs are accepted",
        "common/test_failures.py::test_numbers_must_be_finite",
    ),
    Defect(
        "span along x only",
        Fault("io.scene", "Scene.spans", "math.hypot(x1 - x0, y1 - y0)", "abs(x1 - x0)"),
        "term",
        "the horizontal distance forgets y",
        "catenary/test_invariants.py::test_a_scene_can_be_turned_about_the_vertical",
    ),
    Defect(
        "period taken for the frequency",
        Fault("io.scene", "_motion", "1 / frequency", "1 * frequency"),
        "unit",
        "a motion given by its period moves with so many hertz",
        "io/test_scene.py::test_every_key_arrives",
    ),
    Defect(
        "phase lost in the cosines",
        Fault("io.scene", "_motion", "np.sin(phase)", "np.sin(np.radians(phase))"),
        "unit",
        "the cosines of a motion take its phase for degrees",
        "io/test_scene.py",
    ),
    Defect(
        "fairlead below the seabed moves on",
        Fault("io.scene", "Scene._check_dynamics", "-depth", "-10 * depth"),
        "input",
        "a motion may take the fairlead through the seabed",
        "io/test_scene.py::test_bad_scenes_with_motion",
    ),
    # ------------------------------------------------------------ motion
    Defect(
        "velocity of the cosines",
        Fault("common.motions.motion", "Motion._rates", "-self._omega", "self._omega"),
        "sign",
        "d/dt cos = + sin",
        _RATES,
    ),
    Defect(
        "hertz for radians per second",
        Fault("common.motions.motion", "Motion._omega", "2 * math.pi * self.frequency", "self.frequency"),
        "unit",
        "the frequency is used as the angular one",
        "common/test_motion.py::test_harmonic_motion_is_a_sine_with_phase",
    ),
    Defect(
        "harmonics counted from zero",
        Fault(
            "common.motions.motion", "Motion._omega", "np.arange(1, self.harmonics + 1)", "np.arange(self.harmonics)"
        ),
        "index",
        "the first harmonic stands still, the second moves with the first's frequency",
        "common/test_motion.py::test_harmonic_motion_is_a_sine_with_phase",
    ),
    Defect(
        "rate of the ramp per step, not per second",
        Fault(
            "common.motions.motion",
            "Ramped._ramp",
            "30 * x**2 * (1 - x) ** 2 / self.duration",
            "30 * x**2 * (1 - x) ** 2",
        ),
        "unit",
        "dq/dt of the ramp is dq/dx",
        _RATES,
    ),
    Defect(
        "product rule without its 2",
        Fault("common.motions.motion", "Ramped.trajectory", "2 * q_t", "q_t"),
        "factor",
        "acceleration of a ramped motion",
        _RATES,
    ),
    Defect(
        "ramp that jumps",
        Fault("common.motions.motion", "Ramped._ramp", "6 * x**2", "7 * x**2"),
        "factor",
        "the ramp ends at 2 and the motion at 1",
        _RATES,
    ),
    Defect(
        "spline one piece further",
        Fault(
            "common.motions.motion",
            "SampledMotion._locate",
            'np.searchsorted(self.time, t.real, side="right") - 1',
            'np.searchsorted(self.time, t.real, side="right")',
        ),
        "index",
        "a time of a series is looked up in the next piece of the spline",
        "common/test_motion.py::test_a_series_goes_through_its_samples",
    ),
    Defect(
        "everything moves in a plane",
        Fault(
            "common.motions.motion_arrays",
            "spanning_vectors",
            "_SAME_DIRECTION * max(extent[0], np.finfo(float).tiny)",
            "0.5 * max(extent[0], np.finfo(float).tiny)",
        ),
        "tolerance",
        "directions of a motion smaller than half its largest are left out",
        "common/test_motion.py::test_directions_span_the_motion_and_no_more",
    ),
    Defect(
        "product rule of rotations without its 2",
        Fault("common.motions.body_motion", "_product", "2 * A[1] @ B[1]", "A[1] @ B[1]"),
        "factor",
        "accelerations of a body that turns about two axes at once lack half of the Coriolis term",
        "common/test_body_motion.py::test_rates_are_derivatives",
    ),
    Defect(
        "yaw taken before pitch before roll",
        Fault("common.motions.body_motion", "_rotation", "yaw @ pitch @ roll", "roll @ pitch @ yaw"),
        "order",
        "rotations of a body are composed about its own axes",
        "common/test_body_motion.py::test_roll_is_taken_before_pitch_before_yaw",
    ),
    Defect(
        "left-handed rotations",
        Fault("common.motions.body_motion", "_axis_rotation", "1.0, -1.0", "-1.0, 1.0"),
        "sign",
        "positive angles turn a body clockwise",
        "common/test_body_motion.py::test_one_rotation_is_a_circle",
    ),
    Defect(
        "body without centripetal acceleration",
        Fault("common.motions.body_motion", "_axis_rotation", "rate**2 * (sin * J + cos * turning)", "0.0"),
        "term",
        "a body that turns uniformly has no acceleration",
        "common/test_body_motion.py::test_one_rotation_is_a_circle",
    ),
    # ------------------------------------------------------------ cable
    Defect(
        "anchor row one field early",
        Fault("cable.equations", "CableEquations.start", "y[1 : 1 + self.start_rows, 0]", "y[0 : self.start_rows, 0]"),
        "boundary",
        "the anchor holds its strain instead of its last velocity",
        _TANGENTS + " -k planar",
    ),
    Defect(
        "anchor held at the next node",
        Fault(
            "cable.equations", "CableEquations.start", "y[1 : 1 + self.start_rows, 0]", "y[1 : 1 + self.start_rows, 1]"
        ),
        "boundary",
        "the boundary condition of the anchor is that of its neighbour",
        _TANGENTS + " -k planar",
    ),
    Defect(
        "fairlead one node short",
        Fault("cable.equations", "CableEquations.end", "y[:, -1]", "y[:, -2]"),
        "boundary",
        "the prescribed velocity acts on the last node but one",
        "cable/test_order.py::test_fields_linear_in_s_and_t_are_reproduced -k bare",
    ),
    Defect(
        "anchor's height is that of still water",
        Fault("cable.equations", "CableEquations.start", "y[-1, 0] - self.anchor[2]", "y[-1, 0]"),
        "boundary",
        "over a seabed the anchor is at z = 0",
        _MEETS + " -k seabed",
    ),
    Defect(
        "motion across the line forgotten",
        Fault("cable.system", "_is_planar", "(current, *directions)", "(current,)"),
        "regime",
        "a sway is computed in the plane of the line, where it does nothing",
        "cable/test_invariants.py::test_the_scene_picks_the_fields",
    ),
    Defect(
        "out-of-plane axis to the other side",
        Fault("cable.equations", "line_axes", "[-cy, cx, 0.0]", "[cy, -cx, 0.0]"),
        "sign",
        "a left-handed frame: sideways motion and current are mirrored",
        _GEOMETRY + " -k spatial",
    ),
    Defect(
        "line always along x",
        Fault("cable.equations", "line_axes", "(dx / span, dy / span)", "(1.0, 0.0)"),
        "term",
        "the azimuth of the line is not looked at",
        "cable/test_invariants.py::test_the_scene_picks_the_fields",
    ),
    Defect(
        "weights of the other cells",
        Fault("cable.mesh", "trapezoidal_weights", "weights[:-1] += ds / 2", "weights[:-1] += ds[::-1] / 2"),
        "index",
        "the trapezoidal rule is right on even meshes only",
        "cable/test_system.py::test_drift_is_that_of_the_last_position_on_any_mesh",
    ),
    Defect(
        "damping out of the tension",
        Fault("cable.equations", "CableEquations.tension", "y[0] + self.beta * ydot[0]", "y[0]"),
        "term",
        "the tension that is reported has no part of the material's damping",
        "common/test_response.py::test_tension_includes_the_material_damping",
    ),
    Defect(
        "mirror keeps the sideways velocity",
        Fault("cable.equations", "CableEquations.mirror", "(1, 1, 1, -1, 1, -1, *z)", "(1, 1, 1, 1, 1, -1, *z)"),
        "sign",
        "the symmetry of the system has a wrong sign for w",
        "cable/test_invariants.py::test_the_mirror_of_the_system_is_its_symmetry",
    ),
    Defect(
        "compression anywhere is fine",
        Fault("cable.equations", "CableEquations.invalid", "y[0][least] < 0", "y[0][least] < -1"),
        "regime",
        "a cable in compression is no event",
        "harmonic_balance/test_solve.py::test_compression_is_named",
    ),
    Defect(
        "equilibrium of another system",
        Fault(
            "cable.system",
            "CableSystem.replace",
            "super().replace(**kept | changes)",
            "super().replace(equilibrium=self.equilibrium, **changes)",
            where="{'equilibrium': self.equilibrium}",
        ),
        "stale",
        "a copy of a system takes over an equilibrium that is none",
        "cable/test_system.py",
    ),
    # ------------------------------------------------------------ cable_planar, cable_spatial
    Defect(
        "drag by the length of the chord",
        Fault(
            "cable.planar",
            "local_terms",
            "by[0, EPS], by[0, U] = Fdt / (2 * stretch * stretch), dFdt",
            "by[0, EPS], by[0, U] = Fdt / (stretch * stretch), dFdt",
        ),
        "derivative",
        "d/d(eps) of sqrt(1 + eps) without its half",
        _TANGENTS + " -k 'planar and tangential'",
    ),
    Defect(
        "current of the neighbour",
        Fault(
            "cable.planar",
            "local_terms",
            "c.inertia * across * phi_t",
            "c.inertia * along * phi_t",
            where="m * u + c.inertia * along",
        ),
        "symbol",
        "tangent of the current's inertia with the wrong component",
        _TANGENTS + " -k 'planar and current'",
    ),
    Defect(
        "angles exchanged in the weight",
        Fault(
            "cable.spatial",
            "local_terms",
            "-(m + ma) * w_t + M35 * phi_t + M36 * theta_t - c.w0 * cos_p * sin_t",
            "-(m + ma) * w_t + M35 * phi_t + M36 * theta_t - c.w0 * sin_p * cos_t",
            where="(1 + eps) * sin_p * cos_t",
        ),
        "symbol",
        "row 3 with phi and theta exchanged",
        f"{_PATCH} -k 'all and spatial'",
    ),
    Defect(
        "twist of a binormal",
        Fault("cable.spatial", "_Current.__init__", "-self.b", "self.b"),
        "sign",
        "derivative of the current along the tangent by theta",
        _TANGENTS + " -k 'spatial and current'",
    ),
    Defect(
        "the seabed pulls at the middle of a cell",
        Fault(
            "cable.equations",
            "CableEquations.point",
            "F[: self.dimension] += self.support(y[-1])[0] * self.equations.frame(y, False)[0][0]",
            "F[: self.dimension] -= self.support(y[-1])[0] * self.equations.frame(y, False)[0][0]",
        ),
        "sign",
        "support of the seabed reversed in the rows of fourth order",
        "cable/test_order.py::test_order_of_the_corrected_rows -k seabed",
    ),
    Defect(
        "a seabed that carries the weight at most",
        Fault(
            "cable.equations",
            "CableEquations.support",
            "return seabed_support(self.seabed_stiffness, self.scene.environment.depth, z)",
            (
                "support, slope = seabed_support(self.seabed_stiffness, self.scene.environment.depth, z)\n"
                "return np.minimum(support, self.w0), np.where(support < self.w0, slope, 0.0)"
            ),
        ),
        "regime",
        "the limit of statics, HB 2.5, in motion: nothing stops a line that sinks deeper than at rest",
        "suite/test_stability.py::test_a_slack_chain_on_a_seabed_settles",
    ),
    Defect(
        "a hold as strong as on a fine mesh",
        Fault(
            "cable.system",
            "CableSystem.drift_gain",
            "min(1.0, float(_SMALL_TURN**2 / max((turn**2).sum(axis=0).max(), _SMALL_TURN**2)))",
            "max(1.0, float(_SMALL_TURN**2 / max((turn**2).sum(axis=0).max(), _SMALL_TURN**2)))",
        ),
        "symbol",
        "the greater for the smaller: the gain of the hold is one on every mesh",
        "suite/test_stability.py::test_a_slack_chain_on_a_seabed_settles",
    ),
    # ------------------------------------------------------------ chain
    Defect(
        "band one row off",
        Fault(
            "numerics.chain",
            "BandedJacobian._position",
            "self.kl + self.ku + i - j",
            "self.kl + self.ku + i - j - (i > j)",
        ),
        "index",
        "entries below the diagonal stand one row too high in the band storage",
        _BAND,
    ),
    Defect(
        "end rows where the last cell ends",
        Fault("numerics.chain", "BandedJacobian.__init__", "n - fields + first + row", "n - fields + row"),
        "boundary",
        "rows of the last node are written over rows of the last cell",
        _BAND,
    ),
    Defect(
        "product with the other neighbour",
        Fault("numerics.chain", "product", "x[:, 1:]", "x[:, :-1]"),
        "index",
        "tangents of the right nodes times the left ones",
        "numerics/test_chain.py::test_tangents_times_a_state_are_the_change_of_the_rows",
    ),
    Defect(
        "cells field after field",
        Fault("numerics.chain", "stack", "cells.value.swapaxes(0, 1).reshape", "cells.value.reshape"),
        "index",
        "rows of the cells in another order than the unknowns",
        _BAND,
    ),
    # ------------------------------------------------------------ statics, shooting
    Defect(
        "place by the tangent at the far end",
        Fault(
            "cable.statics",
            "_Statics.rows",
            "2 * (place[:, 1:] - place[:, :-1]) / system.ds - tangent[:, 1:] - tangent[:, :-1]",
            "2 * (place[:, 1:] - place[:, :-1]) / system.ds - 2 * tangent[:, 1:]",
        ),
        "order",
        "positions of the equilibrium by a rule of first order",
        "cable/test_statics.py::test_box_scheme_converges_to_the_catenary -k 'uniform and OC3'",
    ),
    Defect(
        "tangent of the places",
        Fault("cable.statics", "_Statics.rows", "-slope[:, self.angles, at]", "slope[:, self.angles, at]"),
        "derivative",
        "rows of the places by strain and angles have the wrong sign in the Jacobian",
        _EQUILIBRIUM + " -k planar",
    ),
    Defect(
        "pull of the line on the vessel outwards",
        Fault("cable.statics", "StaticState.fairlead_force", "-self.tension[-1]", "self.tension[-1]"),
        "sign",
        "the force on the vessel points away from the line",
        _SHOT + " -k plane",
    ),
    Defect(
        "anchor's force in the direction of the fairlead's",
        Fault(
            "cable.statics",
            "StaticState.anchor_force",
            "self.system.direction(self.y)[:, 0]",
            "self.system.direction(self.y)[:, -1]",
        ),
        "index",
        "the force on the anchor has the tangent of the other end",
        _SHOT + " -k plane",
    ),
    Defect(
        "equilibrium to three digits",
        Fault("cable.statics", "", "TOLERANCE = 1e-11", "TOLERANCE = 1e-3"),
        "tolerance",
        "Newton's method for the equilibrium stops after its first good step",
        _MEETS,
    ),
    Defect(
        "half the current is the current",
        Fault(
            "cable.statics",
            "solve_static",
            "_with_eased_loads(system, x, load_factor)",
            "_with_eased_loads(system, x, load_factor / 2)",
        ),
        "regime",
        "the continuation ends half way and calls it the equilibrium",
        "cable/test_statics.py::test_a_strong_current_is_reached_in_steps",
    ),
    Defect(
        "shot without stretch",
        Fault("cable.shooting", "shoot", "_direction(F)[0] * (1 + _direction(F)[1] / system.EA)", "_direction(F)[0]"),
        "term",
        "dr/ds = t in the shooting method",
        _SHOT + " -k plane",
    ),
    Defect(
        "drag of the binormal to the normal",
        Fault(
            "cable.shooting",
            "_load",
            "drag + (system.drag_b - system.drag_n) * (binormal * across).sum(axis=0) * binormal",
            "drag - (system.drag_b - system.drag_n) * (binormal * across).sum(axis=0) * binormal",
        ),
        "sign",
        "C_db and C_dn exchanged about their mean in the shooting method",
        "cable/test_statics.py::test_shooting_has_the_drag_of_the_binormal",
    ),
    Defect(
        "tangential drag on stretched length twice",
        Fault("cable.shooting", "_load", "np.sqrt(1 + T / system.EA)", "(1 + T / system.EA)"),
        "term",
        "1 + eps for its root in the drag of the shooting method",
        _SHOT + " -k plane",
    ),
    # ------------------------------------------------------------ declared blind spots
    Defect(
        "start of the equilibrium too taut",
        Fault("cable.statics", "_Statics.catenary", "T / system.EA", "1.05 * T / system.EA"),
        "factor",
        "the strain that the iteration for the equilibrium starts from",
        f"{_MEETS} {_SHOT} cable/test_statics.py::test_the_oc3_line_is_that_of_the_notes",
        blind="a start: the same equilibrium comes out, with the same number of steps or one more",
    ),
    Defect(
        "two BLAS threads",
        Fault("numerics.threads", "one_blas_thread", "limits=1", "limits=2"),
        "factor",
        "the number of threads of the linear algebra",
        _OVERLAP,
    ),
    Defect(
        "threads of the first thread alone",
        Fault("numerics.threads", "_release_owner", 'hasattr(library, "clear_controlling_thread")', "False"),
        "regime",
        "after a solve in one thread of Python the linear algebra heeds no other one",
        _OVERLAP,
    ),
    Defect(
        "threads back before the last has left",
        Fault("numerics.threads", "one_blas_thread", "_entered.pop()", "_entered.pop(0)"),
        "stale",
        "of solves that overlap in threads of Python the second ends with all threads of the linear algebra",
        _OVERLAP,
    ),
)
