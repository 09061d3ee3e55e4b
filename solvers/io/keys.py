"""The keys of scene and network files: what each takes, in which unit; readers and schema take them from here.

A Key's kind is one of ``schema.KINDS``; its help is one sentence for an editor or for who mistypes it.
"""

from __future__ import annotations

from difflib import get_close_matches
from typing import NamedTuple

from ..common.outcome import InputError


class Key(NamedTuple):
    """What a key takes: kind, unit ("" without), one sentence, and whether it must be there."""

    kind: str
    unit: str
    help: str
    required: bool = False


_NAME = {
    "name": Key("text", "", "Name of the system, as pages show it."),
    "description": Key("text", "", "What the system is, in a sentence or two."),
}
ENVIRONMENT = {
    "rho": Key("non_negative", "kg/m^3", "Density of the water; 1025 where it is not given."),
    "g": Key("positive", "m/s^2", "Gravity; 9.80665 where it is not given."),
    "depth": Key("positive", "m", "Depth of the flat seabed at z = -depth; without it there is no seabed."),
    "current": Key("vector", "m/s", "Steady velocity [x, y, z] of the water."),
    "seabed_stiffness": Key("non_negative", "N/m^2", "Of the seabed, per length of line and metre of penetration."),
    "seabed_damping": Key("non_negative", "N s/m^2", "Of the seabed, per length of line and m/s, while it is pressed."),
}
SECTION = {
    "diameter": Key("positive", "m", "Diameter of the cylinder with the line's displacement and drag."),
    "mass_per_length": Key("positive", "kg/m", "Mass in air per unstretched length."),
    "submerged_weight": Key("number", "N/m", "Weight in water per unstretched length; else from mass and diameter."),
    "breaking_load": Key("positive", "N", "Minimum breaking load, for the margin on the page of the file."),
    "Cdn": Key("non_negative", "", "Coefficient of the drag across the line, on d l."),
    "Cdb": Key("non_negative", "", "Coefficient of the binormal drag, on d l; Cdn where it is not given."),
    "Cdt": Key("non_negative", "", "Coefficient of the drag along the line, on pi d l."),
    "Ca": Key("non_negative", "", "Added-mass coefficient across the line."),
    "damping": Key("non_negative", "s", "Kelvin-Voigt time of the material: T = EA (eps + damping d(eps)/dt)."),
}
_EA = {"EA": Key("positive", "N", "Axial stiffness of the line.", True)}
_FACTORS = {
    "mean": Key("positive", "", "Factor on the mean tension.", True),
    "dynamic": Key("positive", "", "Factor on what the greatest tension has above the mean.", True),
}
_FREQUENCY = {
    "frequency": Key("positive", "Hz", "Frequency of the motion; or period."),
    "period": Key("positive", "s", "Period of the motion; or frequency."),
}
SEA = {
    "spectrum": Key(
        "text", "", "Spectrum: jonswap, pierson_moskowitz, or a CSV file of frequency (Hz) and density (m^2/Hz)."
    ),
    "Hs": Key("positive", "m", "Significant wave height of the spectrum."),
    "Tp": Key("positive", "s", "Peak period of the spectrum."),
    "gamma": Key("positive", "", "Peak enhancement of JONSWAP; by Hs and Tp where it is not given."),
    "heading": Key("number", "degrees", "Direction into which the waves run, from x towards y; 0 without it."),
    "seed": Key("count", "", "Whole number that chooses the waves."),
    "duration": Key("positive", "s", "Time after which the waves repeat."),
    "amplitudes": Key("amplitudes", "", "Of the waves: rayleigh, random as in a sea, or deterministic."),
    "operators": Key("text", "", "Response amplitude operators of the body in CSV, beside this file."),
}
"""Of a [motion] in waves."""
_REFERENCE = {
    "reference": Key("vector", "m", "Point [x, y, z] that the body turns about; the origin where it is not given.")
}
SCENE = {
    "": _NAME | {
        "tolerance": Key("tolerance", "", "Relative error wanted of the fairlead tension."),
        "environment": Key("table", "", "Water, gravity and seabed."),
        "line": Key("table", "", "The line.", True),
        "ends": Key("table", "", "Where the line begins and ends.", True),
        "motion": Key("table", "", "Motion of the fairlead about its place."),
        "safety_factors": Key("table", "", "Factors of the design tension beside breaking_load."),
    },
    "environment": ENVIRONMENT,
    "line": {"length": Key("positive", "m", "Unstretched length of the line.", True)} | _EA
    | {"friction": Key("friction", "", "Coefficient of the seabed's friction, or a list to compare.")} | SECTION,
    "ends": {
        "anchor": Key("vector", "m", "Place [x, y, z] of the anchor, z up from still water.", True),
        "fairlead": Key("vector", "m", "Place [x, y, z] of the fairlead, z up from still water.", True),
    },
    "motion": _FREQUENCY | {
        "amplitude": Key("rows_of_three", "m", "Amplitudes [x, y, z]; or such a row for each harmonic.", True),
        "phase": Key("rows_of_three", "rad", "Phases of the sines, in the shape of amplitude."),
    },
    "sea": _REFERENCE | SEA,
    "safety_factors": _FACTORS,
}  # fmt: skip
"""Of a scene file ("sea": its [motion] where that has a spectrum): table -> key -> Key; "" is the top level."""
NETWORK = {
    "": _NAME | {
        "environment": Key("table", "", "Water, gravity and seabed."),
        "line_types": Key("tables", "", "Sections of the lines.", True),
        "nodes": Key("tables", "", "Points where lines meet.", True),
        "elements": Key("tables", "", "Lines between nodes.", True),
        "motion": Key("table", "", "Motion of the body that carries the coupled nodes."),
        "safety_factors": Key("table", "", "Factors of the design tension beside breaking_load."),
    },
    "environment": ENVIRONMENT,
    "line_types": {"name": Key("text", "", "Name, by which elements refer to it.", True)} | _EA | SECTION,
    "nodes": {
        "name": Key("text", "", "Name, by which elements refer to it.", True),
        "kind": Key("kind", "", "fixed: an anchor; free: solved for; coupled: moved by the body.", True),
        "r": Key("vector", "m", "Place [x, y, z], z up from still water; of a free node a guess.", True),
        "mass": Key("non_negative", "kg", "Point mass."),
        "volume": Key("non_negative", "m^3", "Displaced volume."),
        "force": Key("vector", "N", "External force [x, y, z]."),
        "CdA": Key("non_negative", "m^2", "Drag coefficient times area."),
        "Ca": Key("non_negative", "", "Added-mass coefficient of the volume."),
    },
    "elements": {
        "line_type": Key("text", "", "Name of a line type.", True),
        "length": Key("positive", "m", "Unstretched length.", True),
        "anchor": Key("text", "", "Name of the node at the lower end.", True),
        "fairlead": Key("text", "", "Name of the node at the upper end.", True),
        "friction": Key("non_negative", "", "Coefficient of the seabed's friction."),
    },
    "motion": _REFERENCE | _FREQUENCY | {
        "amplitude": Key("six", "m, rad", "Amplitudes of surge, sway, heave (m), roll, pitch, yaw (rad)."),
        "phase": Key("six", "rad", "Phases of the sines."),
        "sine": Key("rows_of_six", "m, rad", "Coefficients of sines, a row of six for each harmonic."),
        "cosine": Key("rows_of_six", "m, rad", "Coefficients of cosines, a row of six for each harmonic."),
        "file": Key("text", "", "Series of the motion in CSV, beside this file."),
    } | SEA,
    "safety_factors": _FACTORS,
}  # fmt: skip
"""Of a network file: table -> key -> Key; "" is the top level."""

_AXES = {"x": "along x", "y": "along y", "z": "upwards"}
CASES = {
    "name": Key("text", "", "Name of the row, as results show it."),
    "duration": Key("positive", "s", "Time over which statistics are taken, after the ramp.", True),
    "ramp": Key("non_negative", "s", "Time over which the motion grows from rest, before it; 120 where it is empty."),
    **{f"current_{axis}": Key("number", "m/s", f"Velocity of the water {way}, in place of the system's.")
       for axis, way in _AXES.items()},
    **{f"offset_{axis}": Key("number", "m", f"Displacement of the coupled points at rest, {way}.")
       for axis, way in _AXES.items()},
    **{name: key for name, key in SEA.items() if name != "duration"},
    "period": Key("positive", "s", "Period of a regular motion, in place of a sea."),
    **{name: Key("number", "m", f"Amplitude of a regular motion in {name}.") for name in ("surge", "sway", "heave")},
    **{name: Key("number", "rad", f"Amplitude of a regular motion in {name}.") for name in ("roll", "pitch", "yaw")},
    **{f"{name}_deg": Key("number", "degrees", f"Amplitude of a regular motion in {name}, in place of radians.")
       for name in ("roll", "pitch", "yaw")},
    "motion": Key("text", "", "Series of the motion in CSV, beside this file, in place of a sea."),
}  # fmt: skip
"""Columns of a table of load cases (CSV): name -> Key. CSV has no schema that an editor would check a file with."""

ALIASES = {
    "rho": "density water_density rho_w rhow",
    "g": "gravity",
    "depth": "water_depth waterdepth wtrdpth seabed h",
    "current": "current_velocity current_speed u",
    "seabed_stiffness": "kbot k_bot kb bottom_stiffness",
    "seabed_damping": "cbot c_bot bottom_damping",
    "diameter": "d diam od d_nom",
    "mass_per_length": "m mass massden mass_density mass_per_unit_length linear_mass",
    "submerged_weight": "w weight wet_weight weight_in_water",
    "breaking_load": "mbl mbs mbf breaking_strength minimum_breaking_load",
    "Cdn": "cd drag drag_coefficient cd_normal can_drag",
    "Cdt": "cdax cd_tangential cd_axial",
    "Ca": "cm can cmn added_mass ca_normal",
    "damping": "ba beta zeta internal_damping",
    "EA": "e stiffness axial_stiffness ae",
    "length": "l unstrlen unstretched_length l0",
    "friction": "mu cb friction_coefficient seabed_friction",
    "anchor": "nodeanch anchor_node start attacha",
    "fairlead": "nodefair fairlead_node end attachb",
    "frequency": "f freq",
    "period": "t tp",
    "amplitude": "a amp",
    "kind": "type",
    "r": "position xyz coordinates",
    "mass": "m",
    "volume": "v",
    "line_type": "type linetype",
    "Hs": "h hm0 swh significant_height significant_wave_height wave_height",
    "Tp": "t peak_period wave_period tpeak",
    "gamma": "peak_enhancement peakedness",
    "heading": "direction wave_direction wave_heading mwd dir theta beta",
    "seed": "random_seed rng realisation realization",
    "duration": "t_sim simulation_time length_s tmax time",
    "ramp": "ramp_time transient t_ramp",
    "operators": "rao raos transfer_functions",
    "current_x": "current current_speed u",
    "offset_x": "offset",
    "motion": "file series motion_file",
}
"""Key -> what other programs and papers call it, in small letters."""


def check_keys(where: str, table: dict, keys: dict[str, Key]):
    """Raise InputError for a key of a table that is not known, naming the likely one, or for one that is missing."""
    for key in table:
        if key not in keys:
            raise InputError(
                f"unknown key {key!r} in {where}; {describe_likely_key(key, keys)}",
                field=key,
                value=table[key],
                label="",
            )
    for key, about in keys.items():
        if about.required and key not in table:
            raise InputError(f"missing key {key!r} in {where}", field=key, label="")


def describe_likely_key(key: str, keys: dict[str, Key], noun: str = "keys") -> str:
    """Return which key or column is likely meant by an unknown one, with its unit where it has another name; or all."""
    same = [known for known in keys if known.lower() == key.lower()]
    usual = [known for known in keys if key.lower() in ALIASES.get(known, "").split()]
    near = same or usual or get_close_matches(key, keys, n=1)
    if not near:
        return f"known {noun} are {', '.join(sorted(keys))}"
    about = keys[near[0]]
    return f"did you mean {near[0]!r}?" + (f" {about.help.rstrip('.')} ({about.unit or 'no unit'})." if usual else "")
