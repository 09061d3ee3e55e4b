"""Suspicions of inputs by their magnitude: the likely slip of a unit or sign, one sentence each.

Nothing here is refused: what is unusual may be meant. Limits are wide of what chain, wire and rope have, at full scale
and in a tank.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from ..catenary.span import solve_span
from ..common.properties import MAX_STRAIN, CableProperties, Environment

LARGEST_DIAMETER = 0.7  # m: the largest chain has 0.2 m, dynamic power cables 0.4 m
DENSITIES = 150.0, 40_000.0  # kg/m^3 of mass over section: foam-cored ropes; studded chain of nominal diameter 28 000
FOAM = 0.75  # of the displaced water: a line that is lighter than this is meant to float
POLYESTER = 1380.0  # kg/m^3
LEAST_MODULUS = 1e8  # N/m^2, EA over section: nylon 5e8, chain at a scale of 1:80 1e9; in kN chain has 1e8 and less
LEAST_STRENGTH = 2e6  # N/m^2, breaking load over section: nylon has 2e8, chain at a scale of 1:80 6e6, in kN 5e5
USUAL_MODULI = 5e8, 3e11  # N/m^2: nylon; above steel
CONTRADICTION = 0.5  # of the weight in air, by which a weight may differ from mass and diameter: ropes have voids
SAME = 0.2  # relative, within which two weights are the same in another unit
LARGEST_ROTATION = 0.6  # rad, of a body in waves: 34 degrees
HIGHEST_END = 40.0  # m above still water: a fairlead is lower
_LENGTHS = {"mm": 1e-3, "cm": 1e-2, "in": 0.0254}  # m


def suspect_section(cable: CableProperties, environment: Environment) -> Iterator[str]:
    """Yield sentences on a section: diameter in mm, mass in t/m, EA in kN, a weight that contradicts the others."""
    diameter, mass = cable.diameter, cable.mass_per_length
    if diameter is not None and diameter > LARGEST_DIAMETER:
        unit = next((u for u, size in _LENGTHS.items() if _is_solid(mass, diameter * size)), "mm")
        yield (
            f"diameter = {diameter:g} m is larger than any mooring line's: likely in {unit}, "
            f"{diameter * _LENGTHS[unit]:g} m."
        )
        diameter *= _LENGTHS[unit]
    if mass is not None and diameter is not None and not _is_solid(mass, diameter):
        yield _suspect_mass(mass, diameter)
        mass = None
    if diameter is not None and (modulus := cable.EA / _area(diameter)) < LEAST_MODULUS:
        factor, unit = next(((f, u) for f, u in ((1e3, "kN"), (1e6, "MN"))
                             if USUAL_MODULI[0] <= f * modulus <= USUAL_MODULI[1]), (1e3, "kN"))  # fmt: skip
        yield (
            f"EA = {cable.EA:g} N over the section is {modulus:.2g} N/m^2, softer than any rope: likely in {unit}, "
            f"{factor * cable.EA:g} N."
        )
    yield from _suspect_strength(cable, diameter)
    if diameter is not None and mass is not None and cable.submerged_weight is None:
        yield from _suspect_buoyancy(mass, diameter, environment)
    if cable.submerged_weight is not None and mass is not None and diameter is not None:
        yield from _suspect_weight(cable.submerged_weight, mass, diameter, environment)


def is_lighter_than_any_line(cable: CableProperties) -> bool:
    """Return whether a section whose weight follows from mass and diameter is lighter than every line: a wrong unit."""
    diameter, mass = cable.diameter, cable.mass_per_length
    if cable.submerged_weight is not None or diameter is None or mass is None:
        return False
    return mass / _area(diameter) < DENSITIES[0]


def _area(diameter: float) -> float:
    return math.pi * diameter**2 / 4


def _is_solid(mass, diameter: float) -> bool:
    """Return whether mass per length over section is a density that lines have; True where the mass is not known."""
    return mass is None or DENSITIES[0] <= mass / _area(diameter) <= DENSITIES[1]


def _suspect_mass(mass: float, diameter: float) -> str:
    text = f"mass_per_length = {mass:g} kg/m over the section is {mass / _area(diameter):.2g} kg/m^3, as no line has"
    for factor, unit in ((1e3, "t/m"), (1e-3, "g/m"), (1 / 9.80665, "N/m")):
        if _is_solid(factor * mass, diameter):
            return f"{text}: likely in {unit}, {factor * mass:.4g} kg/m."
    return f"{text}: see both mass_per_length (kg/m) and diameter (m)."


def _suspect_strength(cable: CableProperties, diameter: float | None) -> Iterator[str]:
    """Yield a sentence on a breaking load that is far below that of any line of the section."""
    load = cable.breaking_load
    if load is None or diameter is None:
        return
    if load / _area(diameter) < LEAST_STRENGTH:
        yield f"breaking_load = {load:g} N is less than any line of this section has: likely in kN, {1e3 * load:g} N."


def _suspect_buoyancy(mass: float, diameter: float, environment: Environment) -> Iterator[str]:
    displaced = environment.rho * _area(diameter)
    if FOAM * displaced < mass < displaced:
        yield (
            f"diameter = {diameter:g} m displaces {displaced:.4g} kg/m of water, more than mass_per_length = {mass:g} "
            "kg/m: the line floats. A rope that water fills displaces less: give submerged_weight (N/m), or the "
            f"diameter of its fibres alone (of polyester {math.sqrt(4 * mass / (math.pi * POLYESTER)):.3g} m)."
        )


def _suspect_weight(weight, mass, diameter, environment) -> Iterator[str]:
    in_air, g = mass * environment.g, environment.g
    expected = in_air - environment.rho * _area(diameter) * g
    if abs(weight - expected) <= CONTRADICTION * in_air and weight <= in_air * (1 + SAME):
        return
    text = f"submerged_weight = {weight:g} N/m contradicts mass_per_length and diameter, which make {expected:.4g} N/m"
    for factor, unit in ((1e3, "kN/m"), (g, "kg/m")):
        if abs(factor * weight - expected) <= SAME * in_air:
            yield f"{text}: likely in {unit}, {factor * weight:.4g} N/m."
            return
    yield f"{text}: leave it out, and it follows from them."


def suspect_heights(ends: dict[str, float], anchors: tuple[str, ...], has_seabed: bool) -> Iterator[str]:
    """Yield a sentence where z seems to count downwards: names of points -> z in m, and those that are anchors."""
    lower, upper = [ends[name] for name in anchors], [z for name, z in ends.items() if name not in anchors]
    if lower and upper and min(lower) > max(upper) and min(ends.values()) >= 0:
        yield (
            f"Anchors at z = {max(lower):g} m are above the other points, {min(upper):g} m and up, and all above still "
            "water: z counts upwards, so depths are negative."
        )
        return
    for name, z in ends.items():
        if z > HIGHEST_END and has_seabed:  # without one z may count from anywhere
            yield f"{name} is {z:g} m above still water: z counts upwards, so {z:g} m below is z = {-z:g}."


def suspect_angles(motion, name: str = "[motion]") -> Iterator[str]:
    """Yield a sentence where rotations of a BodyMotion seem to be in degrees."""
    rotation = getattr(motion, "rotation", None)
    if rotation is None:
        return
    last = motion.period or getattr(rotation, "repeats_after", None) or float(rotation.time[-1])
    largest = float(abs(rotation.displacement(np.linspace(0.0, last, 512))).max())
    if largest > LARGEST_ROTATION:
        yield (
            f"{name} turns the body by {largest:.3g} rad, {math.degrees(largest):.0f} degrees: likely in degrees; give "
            "roll, pitch and yaw in rad (in CSV also roll_deg, pitch_deg, yaw_deg)."
        )


def suspect_phases(phases) -> Iterator[str]:
    """Yield a sentence where phases, numbers in any nesting of lists, seem to be in degrees."""
    largest = max((abs(value) for value in np.ravel(phases)), default=0.0)
    if largest > 2 * math.pi * (1 + 1e-6):
        yield f"phase = {largest:g} rad is more than a turn: likely in degrees, {math.radians(largest):.4g} rad."


def suspect_rest(span, current) -> Iterator[str]:
    """Yield a sentence where the line at rest is slack in still water, or stretched as none holds."""
    state = solve_span(span, throw=False)
    if not state.success:
        return
    if state.H == 0 and span.x > 0 and not any(current):
        yield (
            f"The line is slack: {span.L:g} m are more than {span.x:g} m along and {span.z:g} m up between its ends "
            "take, so it pulls nothing to the side; see length and ends (all in m)."
        )
    if state.tension > MAX_STRAIN * span.EA:
        yield (
            f"The line at rest is stretched by {100 * state.tension / span.EA:.3g} %, as no line holds: see length and "
            f"ends (m), and EA = {span.EA:g} N (likely {1e3 * span.EA:g} N where it was meant in kN)."
        )
