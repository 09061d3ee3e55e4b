"""Typical mistakes in motion: what each changes, in the inputs, in the equations or in what is given out.

A mistake in the inputs maps them to others, one in the equations is a ``Variant``. Their answers are computed on the
mesh ``MESH`` and stand in the table as truth plus what the mistake moves there, so that the mesh is not in them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from solvers import BodyMotion

from .cases import changed, in_plane, without_rotation
from .responses import Variant, body_motion, end_segments, is_network, march

MESH = (100, 400)
"""Cells and steps in a period on which mistakes are computed."""

NOMINAL = 1.8  # volume-equivalent over nominal diameter of a studless chain
STIFF, SLOW = 50.0, 1000.0  # times EA; times the period
WET = 1000.0  # kg/m^3


# ---------------------------------------------------------------- mistaken inputs
def _parts(inputs, change) -> dict:
    """Return the inputs with each section changed in place by a function."""
    result = changed(inputs)
    for part in result.get("elements", [result]):
        change(part)
    return result


def _nodes(inputs, **values) -> dict:
    result = changed(inputs)
    for node in result.get("nodes", []):
        if node["kind"] == "free":
            node.update({key: value for key, value in values.items() if node[key]})
    return result


def _times(factor, *keys):
    def change(part):
        part.update({key: factor * part[key] for key in keys})

    return lambda inputs: _parts(inputs, change)


def _weight_in_air(inputs):
    return _parts(inputs, lambda part: part.update(w=inputs["g"] * part["mass_per_length"]))


def _rho_1000(inputs):
    def change(part):
        area = math.pi * part["diameter"] ** 2 / 4
        part.update(w=inputs["g"] * (part["mass_per_length"] - WET * area))

    return _parts(inputs, change) | {"rho": WET}


def _seabed_per_area(inputs):
    if inputs["depth"] is None:
        return inputs
    d = inputs["diameter"]
    return changed(inputs, seabed_stiffness=lambda k: k * d, seabed_damping=lambda c: c * d)


def _seabed_ignored(inputs):
    return changed(inputs, depth=None, seabed_stiffness=None, seabed_damping=0.0, friction=0.0)


def _slow(inputs):
    result = changed(inputs)
    rule = result["body" if is_network(inputs) else "fairlead"]
    rule["frequency"] /= SLOW
    rule["ramp"] *= SLOW
    for key in ("dt", "period"):
        result["time"][key] *= SLOW
    return inputs if inputs.get("friction") else result  # which depends on the direction alone


INPUTS = {
    "added_mass_missing": ("There is no added mass.", _times(0.0, "Ca")),
    "drag_without_half": ("Drag is without the factor 1/2: twice as large.", _times(2.0, "Cdn", "Cdb", "Cdt")),
    "drag_missing": ("There is no drag.", _times(0.0, "Cdn", "Cdb", "Cdt")),
    "tangential_drag_ignored": ("Drag along the line is left out.", _times(0.0, "Cdt")),
    "drag_on_wrong_area": (
        "Drag along the line acts on the diameter, not on the circumference pi times as long.",
        _times(1 / math.pi, "Cdt"),
    ),
    "normal_drag_on_circumference": (
        "Drag across the line acts on the circumference, not on the diameter.",
        _times(math.pi, "Cdn", "Cdb"),
    ),
    "current_ignored": ("The water is still.", lambda given: changed(given, current=[0.0, 0.0, 0.0])),
    "drag_relative_velocity_wrong_sign": (
        "The current is added to the velocity of the line, not subtracted from it.",
        lambda given: changed(given, current=lambda u: [-c if c else 0.0 for c in u]),
    ),
    "damping_ignored": ("The line has no structural damping.", _times(0.0, "damping")),
    "nominal_diameter": (
        "Drag and added mass are those of the nominal diameter of a chain, diameter / 1.8.",
        _times(1 / NOMINAL, "diameter"),
    ),
    "radius_for_diameter": (
        "The diameter is taken for the radius in drag and added mass.",
        _times(2.0, "diameter"),
    ),
    "rho_1000": ("The density of water is 1000 kg/m^3, in weight, drag and added mass.", _rho_1000),
    "weight_in_air": ("The weight of the line is that in air: buoyancy is left out.", _weight_in_air),
    "g_9_81": ("Gravity is 9.81 m/s^2, not the 9.80665 m/s^2 of the case.", _times(9.81 / 9.80665, "w")),
    "mass_submerged": (
        "The mass that is accelerated is the submerged weight over g, without the displaced water.",
        lambda given: _parts(given, lambda part: part.update(mass_per_length=abs(part["w"]) / given["g"])),
    ),
    "elasticity_ignored": ("The line does not stretch (EA times 50).", _times(STIFF, "EA")),
    "seabed_ignored": ("There is no seabed: the line hangs through it.", _seabed_ignored),
    "seabed_per_area": (
        "Stiffness and damping of the seabed are taken per area: times the diameter, per length.",
        _seabed_per_area,
    ),
    "seabed_damping_ignored": ("The seabed has no damping.", lambda given: changed(given, seabed_damping=0.0)),
    "friction_ignored": ("The seabed has no friction.", lambda given: changed(given, friction=0.0)),
    "out_of_plane_dropped": ("Motion and current across the plane of x and z are left out.", in_plane),
    "quasi_static": ("At each instant the line is at rest: no inertia, no drag but that of a current.", _slow),
    "body_rotation_ignored": ("The body does not turn.", without_rotation),
    "point_mass_ignored": ("Free nodes have no mass.", lambda given: _nodes(given, mass=0.0)),
    "volume_ignored": ("Free nodes displace no water.", lambda given: _nodes(given, volume=0.0)),
    "point_drag_ignored": ("Free nodes have no drag.", lambda given: _nodes(given, CdA=0.0)),
}
"""Name -> (sentence, inputs -> mistaken inputs)."""


def mistaken_inputs(name, inputs) -> dict | None:
    """Return the inputs as the mistake has them, None where it has nothing to go wrong with."""
    if name in ("out_of_plane_dropped", "seabed_per_area", "seabed_ignored") and is_network(inputs):
        return None
    if name in ("body_rotation_ignored",) and not is_network(inputs):
        return None
    mistaken = INPUTS[name][1](inputs)
    return None if mistaken == inputs else mistaken


# ---------------------------------------------------------------- mistaken equations
@dataclass(frozen=True, eq=False)
class SmallAngles(BodyMotion):
    """A body whose rotation is linearised: displacements of its points are s + angles x arm."""

    def trajectory(self, points, t):
        """Return displacement, velocity and acceleration, (3, P, S) each."""
        arms = self._arms(points)
        parts = zip(self.translation.trajectory(t), self.rotation.trajectory(t), strict=True)
        return tuple(s[:, None] + np.cross(angle[:, None], arms.T[..., None], axis=0) for s, angle in parts)

    def displacement(self, points, t):
        """Return displacements, (3, P, S)."""
        t = np.asarray(t, dtype=float)
        whole = self.trajectory(points, np.atleast_1d(t))[0]
        return whole if t.ndim else whole[..., 0]


def _added_mass_tangential(line):
    return line._replace(mass=line.mass + line.added_mass, added_mass=np.zeros_like(line.added_mass))


def _small_angles(inputs):
    motion = body_motion(inputs)
    return SmallAngles(motion.translation, motion.rotation, motion.reference)


EQUATIONS = {
    "added_mass_tangential": (
        "Added mass acts on the acceleration along the line, too.",
        lambda inputs: Variant(line=_added_mass_tangential) if not is_network(inputs) and inputs["Ca"] else None,
    ),
    "small_angles": (
        "The rotation of the body is linearised.",
        lambda inputs: Variant(motion=_small_angles(inputs)) if _turns(inputs) else None,
    ),
    "ramp_left_in": (
        "The first period, in which the motion still grows, is given for the one asked for.",
        lambda inputs: Variant(first_period=0),
    ),
}
"""Name -> (sentence, inputs -> Variant, None where there is nothing to go wrong with)."""


def _turns(inputs) -> bool:
    return is_network(inputs) and any(any(row[3:]) for part in ("sin", "cos") for row in inputs["body"][part])


# ---------------------------------------------------------------- mistakes in what is given out
def _swapped(truth):
    if "force" in truth:
        return {"tension": truth["tension"][:, ::-1]}
    ends = {"fairlead_tension": truth["anchor_tension"], "anchor_tension": truth["fairlead_tension"]}
    return ends | {key: truth[key][::-1] for key in ("envelope_max", "envelope_min")}


OUTPUTS = {
    "kN_for_N": ("Forces are in kN.", lambda truth: {key: value / 1000 for key, value in truth.items()}),
    "kgf_for_N": (
        "Forces are in kilogram-force (divided by 9.80665).",
        lambda truth: {key: value / 9.80665 for key, value in truth.items()},
    ),
    "ends_swapped": ("What belongs to the anchor is given for the fairlead, and the reverse.", _swapped),
    "anchor_force_for_fairlead": (
        "The force at the anchor is given at both ends.",
        lambda truth: {"fairlead_tension": truth["anchor_tension"]} if "force" not in truth else {},
    ),
    "dynamic_part_alone": (
        "The mean over the period is left out.",
        lambda truth: {
            key: truth[key] - truth[key].mean(axis=-1, keepdims=True)
            for key in ("fairlead_tension", "anchor_tension", "force", "tension")
            if key in truth
        },
    ),
    "force_sign": (
        "The force is that of the body on the lines.",
        lambda truth: {"force": -truth["force"]} if "force" in truth else {},
    ),
    "vertical_sign": (
        "Vertical forces are positive downwards.",
        lambda truth: {"force": truth["force"] * np.array([1.0, 1.0, -1.0])[:, None]} if "force" in truth else {},
    ),
}
"""Name -> (sentence, truth -> what is given out)."""

SEGMENTS = {
    "tension_of_last_segment": (
        "The force at each end is the tension of the last segment: half a node's weight, drag and inertia are missing.",
    ),
    "horizontal_for_tension": ("The horizontal component is given for the tension.",),
}
COMPRESSION = {"compression_allowed": "The line bears compression: its tension becomes negative."}
SENTENCES = {
    name: entry[0] for group in (INPUTS, EQUATIONS, OUTPUTS, SEGMENTS) for name, entry in group.items()
} | COMPRESSION
"""Name -> what is done wrong, one sentence."""


def mistaken_answers(case, truth, base) -> dict:
    """Return mistake -> quantity -> value, of all that apply; truth and base, on MESH, as ``responses`` return them."""
    answers = {}
    for name in INPUTS:
        if (inputs := mistaken_inputs(name, case.inputs)) is not None:
            answers[name] = add_difference(truth, base, march(inputs, *MESH))
    for name, (_, make) in EQUATIONS.items():
        if (variant := make(case.inputs)) is not None:
            answers[name] = add_difference(truth, base, march(case.inputs, *MESH, variant))
    for name, (_, make) in OUTPUTS.items():
        answers[name] = make(truth)
    if not is_network(case.inputs):
        ends, segments, level = end_segments(case.inputs, case.inputs["cells"], MESH[1])
        answers["tension_of_last_segment"] = add_difference(truth, ends, segments)
        answers["horizontal_for_tension"] = add_difference(truth, ends, level)
    return {name: answer for name, answer in answers.items() if answer}


def add_difference(truth, base, answer) -> dict:
    """Return the truth plus the difference of an answer from one of the same method without the mistake (base)."""
    return {key: truth[key] + (answer[key] - base[key]) for key in answer}
