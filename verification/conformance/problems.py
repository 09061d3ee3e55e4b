"""Cases as an adapter is given them: plain objects with the attributes that solvers.Span, Network and Scene have."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np

SPAN_INPUTS = ("w", "EA", "L", "x", "z", "seabed", "friction", "clearance")
ENVELOPE_PLACES = 21
"""Arc lengths of an envelope, equally spaced from the anchor to the fairlead."""
CELLS = 50
"""Segments of a moving line where neither the case nor the adapter says how many."""

_WATER = {"depth": None, "current": (0.0, 0.0, 0.0), "seabed_stiffness": None, "seabed_damping": 0.0}
_SECTION = ("EA", "diameter", "mass_per_length", "Cdn", "Cdb", "Cdt", "Ca", "damping")
_STILL = {"mass": 0.0, "volume": 0.0, "force": (0.0, 0.0, 0.0), "CdA": 0.0, "Ca": 0.0}


class SpanCase(SimpleNamespace):
    """A line at rest: w, EA, L, x, z, seabed, friction, clearance, and s, mass_per_length, diameter, rho, g."""

    def inputs(self) -> dict:
        """Return the arguments of solvers.Span."""
        return {name: getattr(self, name) for name in SPAN_INPUTS}


class Section(SimpleNamespace):
    """A section of a moving line: EA, diameter, mass_per_length, Cdn, Cdb, Cdt, Ca, damping."""

    def weight_in(self, environment) -> float:
        """Return the submerged weight per unstretched length, N/m."""
        if self.submerged_weight is not None:
            return self.submerged_weight
        return environment.g * (self.mass_per_length - environment.rho * math.pi * self.diameter**2 / 4)


class BodyMotion:
    """Motion of a rigid body in six degrees of freedom: a sum of harmonics, all ramped from rest.

    coordinates are surge, sway, heave (m) of the reference point and roll, pitch, yaw (rad) about it,
    R = Rz(yaw) Ry(pitch) Rx(roll); the ramp is 10 x^3 - 15 x^4 + 6 x^5 of x = t/ramp.
    """

    def __init__(self, rule: dict):
        self.rule = rule
        self.reference = tuple(rule["reference"])

    def coordinates(self, time) -> np.ndarray:
        """Return the six coordinates at times (K,) in s, (6, K)."""
        return harmonic_sum(self.rule, time)

    def displacement(self, points, time) -> np.ndarray:
        """Return the displacements of points (P, 3) at their mean positions, m: time (K,) in s -> (3, P, K)."""
        arms = np.asarray(points, dtype=float) - self.reference
        coordinates = self.coordinates(np.asarray(time, dtype=float))
        turned = np.einsum("ijk,pj->ipk", rotation_matrix(*coordinates[3:]), arms)
        return coordinates[:3, None] + turned - arms.T[..., None]


def rotation_matrix(roll, pitch, yaw) -> np.ndarray:
    """Return Rz(yaw) Ry(pitch) Rx(roll), (3, 3, K), of angles (K,) in rad."""
    (cr, sr), (cp, sp), (cy, sy) = ((np.cos(angle), np.sin(angle)) for angle in (roll, pitch, yaw))
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def harmonic_sum(rule: dict, time) -> np.ndarray:
    """Return the ramped sum of cosines and sines of a rule, (n, K): frequency in Hz, rows cos and sin (k, n)."""
    cos, sin = (np.asarray(rule[name], dtype=float) for name in ("cos", "sin"))
    angle = 2 * math.pi * rule["frequency"] * np.multiply.outer(np.arange(1, len(sin) + 1), time)
    return ramp(time, rule.get("ramp", 0.0)) * (cos.T @ np.cos(angle) + sin.T @ np.sin(angle))


def ramp(time, duration: float) -> np.ndarray:
    """Return the share of the motion at times (K,), s: from 0 to 1 with two continuous derivatives."""
    x = np.clip(np.asarray(time) / duration, 0.0, 1.0) if duration > 0 else np.ones_like(time)
    return x**3 * (10 - 15 * x + 6 * x**2)


# ---------------------------------------------------------------- what the methods are called with
def as_arguments(problem: str, inputs: dict, cells: int | None = None) -> tuple:
    """Return the positional arguments of the method of an Adapter that solves the problem."""
    if problem == "span":
        return (SpanCase(**inputs),)
    if problem == "network":
        return (as_network(inputs),)
    time, cells = as_times(inputs), cells or inputs.get("cells") or CELLS
    if problem == "cable":
        return as_scene(inputs), time, as_places(inputs, time), cells
    return as_network(inputs), BodyMotion(inputs["body"]), time, cells


def as_network(inputs: dict) -> SimpleNamespace:
    """Return nodes, elements (with their section as ``cable`` where they move), environment and body."""
    nodes = [SimpleNamespace(**_STILL | node | _tuples(node, "r", "force")) for node in inputs["nodes"]]
    elements = []
    for part in inputs["elements"]:
        element = SimpleNamespace(**{"friction": 0.0} | part | _tuples(part, "ends"))
        element.cable = as_section(part) if "Cdn" in part else None
        elements.append(element)
    network = SimpleNamespace(nodes=tuple(nodes), elements=tuple(elements), environment=as_environment(inputs))
    network.slip_speed = inputs.get("slip_speed")
    coupled = [i for i, node in enumerate(nodes) if node.kind == "coupled"]
    body = inputs.get("body")
    network.body = body and SimpleNamespace(nodes=body.get("nodes", coupled), reference=tuple(body["reference"]))
    return network


def as_scene(inputs: dict) -> SimpleNamespace:
    """Return one moving line: cable, environment, anchor, fairlead at its mean place, length, friction, s, window."""
    start, period = inputs["time"]["discard"] * inputs["time"]["period"], inputs["time"]["period"]
    return SimpleNamespace(
        cable=as_section(inputs),
        environment=as_environment(inputs),
        anchor=tuple(inputs["anchor"]),
        fairlead=tuple(inputs["fairlead"]["mean"]),
        length=inputs["length"],
        friction=(inputs.get("friction", 0.0),),
        slip_speed=inputs.get("slip_speed"),
        s=[inputs["length"] * k / (ENVELOPE_PLACES - 1) for k in range(ENVELOPE_PLACES)],
        window=(start, start + period),
    )


def as_environment(inputs: dict) -> SimpleNamespace:
    """Return rho, g, depth, current, seabed_stiffness and seabed_damping."""
    given = {name: inputs[name] for name in ("rho", "g", *_WATER) if name in inputs}
    return SimpleNamespace(**_WATER | given | _tuples(given, "current"))


def as_section(part: dict) -> Section:
    """Return the section of a line or an element."""
    return Section(**{name: part.get(name, 0.0) for name in _SECTION}, submerged_weight=part.get("w"))


def as_times(inputs: dict) -> np.ndarray:
    """Return the times at which an answer is wanted, (K,), s, from 0."""
    clock = inputs["time"]
    steps = steps_per_period(clock)
    return clock["period"] / steps * np.arange(round(clock["periods"] * steps) + 1)


def as_places(inputs: dict, time) -> np.ndarray:
    """Return the places of the moving fairlead, (K, 3), m."""
    rule = inputs["fairlead"]
    return np.asarray(rule["mean"], dtype=float) + harmonic_sum(rule, time).T


def steps_per_period(clock: dict) -> int:
    """Return the steps in a period: a multiple of the instants that are compared. Raises ValueError for others."""
    steps = round(clock["period"] / clock["dt"])
    if steps % clock["instants"] or abs(steps * clock["dt"] - clock["period"]) > 1e-9 * clock["period"]:
        raise ValueError(f"dt = {clock['dt']} s: a period must have a multiple of {clock['instants']} steps")
    return steps


def _tuples(part: dict, *names) -> dict:
    return {name: tuple(part[name]) for name in names if name in part}
