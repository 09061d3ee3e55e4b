"""Answers to a motion case by two formulations, each on three meshes that are extrapolated.

The first is nodes and elements in time, generalized-alpha, all periods from rest. The second is the periodic response
by harmonic balance: of the box scheme, whose unknowns are strain, velocities and angles, or, where that has no law for
the case (friction, networks), of the nodes and elements. It has neither a start nor a ramp, so that what is left of
them in the first one shows.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from scipy.interpolate import PchipInterpolator

from solvers import (
    BodyMotion,
    CableProperties,
    Element,
    Environment,
    Motion,
    Network,
    Node,
    Scene,
    cable_system,
    mooring_system,
    solve_periodic,
    solve_time_domain,
)

from ..cable.cases import on_mesh

ENVELOPE_PLACES = 21  # arc lengths, equally spaced, both ends included
ENVELOPE_INSTANTS = 800
_SECTION = ("Cdn", "Cdb", "Cdt", "Ca", "damping")


# ---------------------------------------------------------------- inputs as this project's solvers take them
def environment(inputs) -> Environment:
    """Return the water, gravity and seabed of a case."""
    return Environment(
        inputs["rho"], inputs["g"], inputs["depth"], current=tuple(inputs["current"]),
        seabed_stiffness=inputs["seabed_stiffness"], seabed_damping=inputs["seabed_damping"])  # fmt: skip


def section(part) -> CableProperties:
    """Return the section of a line or of an element of a network."""
    return CableProperties(
        part["EA"], part["diameter"], part["mass_per_length"], part["w"], **{key: part[key] for key in _SECTION}
    )


def scene(inputs) -> Scene:
    """Return the Scene of a line, with the periodic motion of its fairlead."""
    fairlead = inputs["fairlead"]
    motion = Motion(fairlead["frequency"], fairlead["sin"], fairlead["cos"])
    return Scene(
        "case", section(inputs), inputs["length"], tuple(inputs["anchor"]), tuple(fairlead["mean"]),
        environment(inputs), (inputs["friction"],), motion=motion)  # fmt: skip


def network(inputs) -> Network:
    """Return the Network of a case."""
    nodes = [
        Node(node["kind"], tuple(node["r"]), node["mass"], node["volume"], tuple(node["force"]),
             CdA=node["CdA"], Ca=node["Ca"])
        for node in inputs["nodes"]
    ]  # fmt: skip
    elements = [
        Element(part["w"], part["EA"], part["L"], tuple(part["ends"]), part["friction"], section(part))
        for part in inputs["elements"]
    ]
    return Network(nodes, elements, environment(inputs))


def body_motion(inputs) -> BodyMotion:
    """Return the periodic motion of the body of a network."""
    body = inputs["body"]
    return BodyMotion.periodic(body["frequency"], body["sin"], body["cos"], tuple(body["reference"]))


def is_network(inputs) -> bool:
    """Return whether the case is one of a network."""
    return "elements" in inputs


@dataclass(frozen=True)
class Variant:
    """What a mistaken code does otherwise: inputs are changed before, these while and after solving.

    line: changes the arrays ``equations.Line`` of the mesh; motion: replaces the periodic motion;
    first_period: the period that is answered with; options: of ``mooring_system``
    """

    line: object = None
    motion: object = None
    first_period: int | None = None
    options: dict = field(default_factory=dict)


# ---------------------------------------------------------------- nodes and elements, in time
def moving_system(inputs, cells, variant=None):
    """Return the MooringSystem of a case on so many cells."""
    variant = variant or Variant()
    options = {"slip_speed": inputs["slip_speed"], "motion": variant.motion} | variant.options
    if is_network(inputs):
        motion = variant.motion or body_motion(inputs)
        system = mooring_system(network(inputs), cells, **options | {"motion": motion, "calibrate": False})
    else:
        system = mooring_system(scene(inputs), cells, **options)
    if variant.line is not None:
        system.line = variant.line(system.line)
    return system


def march(inputs, cells, steps, variant=None) -> dict:
    """Return the answer of nodes and elements: quantity -> array; ``steps`` in a period."""
    variant = variant or Variant()
    clock = inputs["time"]
    period, rule = clock["period"], inputs["body" if is_network(inputs) else "fairlead"]
    system = moving_system(inputs, cells, variant)
    duration = clock["periods"] * period
    history = solve_time_domain(system, dt=period / steps, duration=duration, ramp=rule["ramp"])
    first = clock["discard"] if variant.first_period is None else variant.first_period
    t = period * (first + np.arange(clock["instants"]) / clock["instants"])
    if is_network(inputs):
        return _network_answer(history, t)
    within = slice(round(first * steps), round((first + 1) * steps) + 1)
    ends = [history.end_tension_at(history.time[within], end) for end in (0, -1)]
    tensions = {"fairlead_tension": history.end_tension_at(t, -1), "anchor_tension": history.end_tension_at(t, 0)}
    return tensions | _envelope(system, history.tension[:, within], ends)


def _network_answer(history, t) -> dict:
    """Return forces (P, 3, M) on the coupled nodes and tensions (e, 2, M) at the ends of elements, at steps t."""
    at = np.rint(t / history.time[1]).astype(int)
    tension = [[history.end_tension_at(t, end, e) for end in (0, -1)] for e in range(len(history.elements))]
    force = history.forces[:, history.system.coupled_nodes][..., at].swapaxes(0, 1)
    return {"force": force, "tension": np.array(tension)}


def end_segments(inputs, cells, steps) -> tuple[dict, dict, dict]:
    """Return of a line on equal cells the tensions of its ends, those of its last cells, and their level components."""
    clock = inputs["time"]
    system = moving_system(inputs, cells, Variant(options={"mesh": "uniform", "calibrate": False}))
    duration, ramp = clock["periods"] * clock["period"], inputs["fairlead"]["ramp"]
    history = solve_time_domain(system, dt=clock["period"] / steps, duration=duration, ramp=ramp)
    at = clock["discard"] * steps + np.arange(clock["instants"]) * (steps // clock["instants"])
    names = {"fairlead_tension": -1, "anchor_tension": 0}
    forces = {name: history.forces[:, end, at] for name, end in names.items()}
    ends = {name: np.linalg.norm(force, axis=0) for name, force in forces.items()}
    segments = {name: history.tension[end, at] for name, end in names.items()}
    return ends, segments, {name: np.hypot(*force[:2]) for name, force in forces.items()}


def _envelope(system, tension, ends) -> dict:
    """Return greatest and least tension at equal arc lengths from those of cells (C, K) and of both ends (M,)."""
    s, length = system.s, system.length
    places = np.concatenate([[0.0], (s[1:] + s[:-1]) / 2, [length]])
    wanted = np.linspace(0.0, length, ENVELOPE_PLACES)
    return {
        f"envelope_{name}": PchipInterpolator(
            places, np.concatenate([[of(ends[0])], of(tension, axis=1), [of(ends[-1])]])
        )(wanted)
        for name, of in (("max", np.max), ("min", np.min))
    }


# ---------------------------------------------------------------- periodic responses
def balance_box(inputs, nodes, harmonics, start=None):
    """Return the answer of the box scheme and its PeriodicResponse."""
    system = cable_system(scene(inputs), nodes)
    response = solve_periodic(system, harmonics=harmonics, start=on_mesh(start, system))
    t = _instants(inputs, ENVELOPE_INSTANTS)
    tension, stride = system.tension(response.at(t), response.rate_at(t)), len(t) // inputs["time"]["instants"]
    places = tension[:: (nodes - 1) // (ENVELOPE_PLACES - 1)]
    envelope = {"envelope_max": places.max(axis=1), "envelope_min": places.min(axis=1)}
    return {"fairlead_tension": tension[-1, ::stride], "anchor_tension": tension[0, ::stride]} | envelope, response


def _instants(inputs, count=None):
    clock = inputs["time"]
    count = count or clock["instants"]
    return clock["period"] * np.arange(count) / count


def balance_nodes(inputs, cells, harmonics) -> dict:
    """Return the answer of harmonic balance of the nodes and elements."""
    system = moving_system(inputs, cells)
    response = solve_periodic(system, harmonics=harmonics)
    t = _instants(inputs)
    if is_network(inputs):
        y, ydot, yddot = response.at(t), response.rate_at(t), response.acceleration_at(t)
        force = system.forces(y, ydot, yddot)[0][:, system.coupled_nodes].swapaxes(0, 1)
        tension = [[response.end_tension_at(t, end, e) for end in (0, -1)] for e in range(len(inputs["elements"]))]
        return {"force": force, "tension": np.array(tension)}
    fine = _instants(inputs, ENVELOPE_INSTANTS)
    states = response.at(fine), response.rate_at(fine), response.acceleration_at(fine)
    ends = {end: response.end_tension_at(fine, end) for end in (0, -1)}
    tensions = {"fairlead_tension": ends[-1], "anchor_tension": ends[0]}
    stride = ENVELOPE_INSTANTS // inputs["time"]["instants"]
    kept = {name: tension[::stride] for name, tension in tensions.items()}
    return kept | _envelope(system, system.forces(*states)[1], ends)


# ---------------------------------------------------------------- extrapolation
def extrapolate(answers) -> tuple[dict, dict]:
    """Return the limit of three answers on meshes of h, h/2 and h/4, and that of the first two: of second order."""
    before, last = (
        {key: fine[key] + (fine[key] - coarse[key]) / 3 for key in fine} for coarse, fine in pairwise(answers)
    )
    return last, before


def spread(a, b, scale) -> dict:
    """Return by how much two answers differ: rms of series, greatest difference of envelopes, over their scale."""
    return {key: distance(key, a[key], b[key]) / scale[key] for key in a if key in b}


def distance(key, a, b) -> float:
    """Return the rms over instants, the greatest of several series; of envelopes the greatest difference."""
    difference = np.asarray(a) - np.asarray(b)
    if key.startswith("envelope"):
        return float(abs(difference).max())
    return float(np.sqrt((difference**2).mean(axis=-1)).max())
