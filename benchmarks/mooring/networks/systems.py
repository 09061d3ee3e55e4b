"""The moving networks that are measured, their bodies in all six degrees of freedom, and tensions at their fairleads.

MoorDyn has no friction of this kind and needs no internal damping beside its own, so that neither is in them.
"""

from __future__ import annotations

import hashlib
import os
from contextlib import contextmanager
from dataclasses import replace
from functools import cache
from importlib.resources import files
from pathlib import Path

import numpy as np

from solvers import BodyMotion, Element, Environment, Network, Node, Scene, mooring_system, solve_time_domain
from solvers.io.network_scene import NamedNetwork, load_network

from ...network.systems import without_friction

SCENES = files("reference_data") / "scenes"
COUNT = 200
"""Times of a period at which tensions are compared."""
FARM_RADII = (853.87, 5.2)  # m, of anchors and fairleads of the OC3 spar
FARM_LINE = 902.2  # m
AZIMUTHS = (0.0, 2 * np.pi / 3, 4 * np.pi / 3)


def motion(period: float, amplitude, phase=(0.0, 0.5, 1.2, 0.9, 0.4, 0.3)) -> BodyMotion:
    """Return a harmonic motion of a body about the origin: period in s, amplitudes and phases (6,) in m, rad."""
    return BodyMotion.harmonic(1 / period, amplitude, phase)


def rename(network: Network, name: str, moved: BodyMotion) -> NamedNetwork:
    """Return a network with another name and motion, on a smooth seabed."""
    smooth = without_friction(network)
    return NamedNetwork(smooth.nodes, smooth.elements, smooth.environment, name=name, motion=moved)


def oc3_spar() -> NamedNetwork:
    """Return three chains of the OC3 Hywind spar over its seabed."""
    network = load_network(SCENES / "networks" / "oc3_moving.toml")
    return rename(network, "OC3 spar, three lines", motion(12.0, (2.0, 0.5, 0.5, 0.01, 0.03, 0.02)))


def oc4_semisubmersible() -> NamedNetwork:
    """Return three chains of the OC4 DeepCwind semisubmersible, 120 degrees apart, over its seabed."""
    scene = Scene.load(SCENES / "mooring" / "oc4.toml")
    cable = replace(scene.cable, damping=0.0)
    radii, heights = (-scene.anchor[0], -scene.fairlead[0]), (scene.anchor[2], scene.fairlead[2])
    network = radial_lines(AZIMUTHS, radii, heights, [(cable, scene.length)], scene.environment)
    return rename(network, "OC4 semisubmersible, three lines", motion(14.0, (2.0, 0.5, 1.0, 0.02, 0.03, 0.02)))


def three_bridles() -> NamedNetwork:
    """Return nine lines of a spar: three lower lines, each with a bridle of two legs."""
    network = load_network(SCENES / "networks" / "three_bridles_moving.toml")
    moved = motion(10.0, (1.5, 0.4, 0.4, 0.01, 0.02, 0.03), (0.0, 0.5, 1.2, 0.9, 0.6, 1.0))
    return rename(network, "spar with three bridles, nine lines", moved)


def chain_polyester_chain() -> NamedNetwork:
    """Return three taut lines in 1600 m, each a ground chain, a polyester rope and a top chain.

    Chain and rope are those of the scenes chain_wire_chain_moving and taut_polyester_current.
    """
    chain = load_network(SCENES / "networks" / "chain_wire_chain_moving.toml").elements[0].cable
    rope = replace(Scene.load(SCENES / "dynamics" / "taut_polyester_current.toml").cable, damping=0.0)
    environment = Environment(depth=1600.0, seabed_stiffness=2e4, seabed_damping=2e3)
    parts = [(chain, 150.0), (rope, 2190.0), (chain, 60.0)]
    inner = ((1750.0, -1580.0), (75.0, -60.0))  # m: radius and height of the joints, from where rest is sought
    network = radial_lines(AZIMUTHS, (1850.0, 35.0), (-1600.0, -20.0), parts, environment, inner)
    return rename(network, "taut polyester between chains, three lines", motion(16.0, (3, 1, 1.5, 0.02, 0.03, 0.02)))


def farm(lines: int) -> NamedNetwork:
    """Return a body with so many chains of the OC3 spar all around it."""
    one = load_network(SCENES / "networks" / "oc3_moving.toml")
    azimuths = 2 * np.pi * np.arange(lines) / lines
    parts = [(one.elements[0].cable, FARM_LINE)]
    network = radial_lines(azimuths, FARM_RADII, (-320.0, -70.0), parts, one.environment)
    return rename(network, f"{lines} lines", motion(12.0, (2.0, 0.5, 0.5, 0.01, 0.03, 0.02)))


def radial_lines(azimuths, radii, heights, parts, environment, inner=()) -> Network:
    """Return equal lines from anchors to fairleads, at radii and heights (2,) in m each.

    parts: (cable, length in m) of each element from the anchor; inner: (radius, height) in m of the joints.
    """
    places = [(radii[0], heights[0]), *inner, (radii[1], heights[1])]
    kinds = ["fixed", *["free"] * len(inner), "coupled"]
    nodes, elements = [], []
    for c, s in zip(np.cos(azimuths).tolist(), np.sin(azimuths).tolist(), strict=True):
        for i, (cable, length) in enumerate(parts):
            ends = len(nodes) + i, len(nodes) + i + 1
            elements.append(Element(cable.weight_in(environment), cable.EA, length, ends, cable=cable))
        nodes += [Node(kind, (r * c, r * s, z)) for kind, (r, z) in zip(kinds, places, strict=True)]
    return Network(nodes, elements, environment)


SYSTEMS = {
    "oc3": oc3_spar,
    "oc4": oc4_semisubmersible,
    "bridles": three_bridles,
    "polyester": chain_polyester_chain,
}
NINE_LINES = "bridles"
SEGMENTS = {
    "oc3": lambda n: [n] * 3,
    "oc4": lambda n: [n] * 3,
    "bridles": lambda n: [n, max(1, n // 10), max(1, n // 10)] * 3,
    "polyester": lambda n: [max(1, n // 15), n, max(1, n // 40)] * 3,
}
"""Segments of the longest line -> those of each that MoorDyn gets; short segments shorten all its steps."""


@cache
def network(name: str) -> NamedNetwork:
    """Return one of SYSTEMS."""
    return SYSTEMS[name]()


def history(made, steps: int, periods: int, **options):
    """Return the motion of a moving network from rest, in so many steps a period."""
    return solve_time_domain(made, dt=made.period / steps, periods=periods, **options)


@cache
def system(name: str, cells: int, mesh: str = "fitted"):
    """Return one of SYSTEMS on so many cells of its longest element, its equilibrium solved for."""
    made = mooring_system(network(name), cells, mesh=mesh)
    made.rest_state()
    return made


def last_tensions(forces, steps: int) -> np.ndarray:
    """Return tensions (P, S) of the last of whole periods: of forces (P, 3, K) at so many steps a period, N.

    S is COUNT where the steps are a multiple of it, or else the steps, which divide it.
    """
    last = np.linalg.norm(np.asarray(forces)[..., -1 - steps : -1], axis=1)
    return last[:, :: max(1, steps // COUNT)]


def last_change(forces, steps: int) -> float:
    """Return the change of the tensions from the last period but one to the last, rms over the range, the largest.

    forces (P, 3, K) of two whole periods at least, at so many steps in each, N.
    """
    last, before = last_tensions(forces, steps), last_tensions(np.asarray(forces)[..., :-steps], steps)
    return float((np.sqrt(((last - before) ** 2).mean(axis=1)) / np.ptp(last, axis=1)).max())


def coupled_forces(run) -> np.ndarray:
    """Return the forces (P, 3, K) at the fairleads of a history, N."""
    return run.forces[:, run.system.coupled_nodes].swapaxes(0, 1)


def our_tensions(run, steps: int) -> np.ndarray:
    """Return the tensions (P, S) at the fairleads over the last period of a history, N; steps: kept, in a period."""
    return last_tensions(coupled_forces(run), steps)


def periodic_tensions(response) -> np.ndarray:
    """Return the tensions (P, COUNT) at the fairleads of a periodic response, N."""
    times = np.arange(COUNT) / COUNT * response.system.period
    elements = fairlead_elements(response.system.model)
    return np.array([response.elements[e].fairlead_tension(times) for e in elements])


def fairlead_elements(model) -> list[int]:
    """Return which element ends at each coupled node; each of these networks has one."""
    return [next(e for e, segment in enumerate(model.segments) if segment.ends[1] == p) for p in model.moved]


def differences(tensions, reference) -> dict:
    """Return rms and error, the largest over the fairleads of rms and greatest difference over the range.

    tensions (P, S), reference (P, COUNT), N, S a divisor of COUNT.
    """
    apart = np.asarray(tensions) - reference[:, :: reference.shape[1] // np.shape(tensions)[1]]
    size = np.ptp(reference, axis=1)
    return {"rms": float((np.sqrt((apart**2).mean(axis=1)) / size).max()),
            "error": float((abs(apart).max(axis=1) / size).max())}  # fmt: skip


@contextmanager
def one_core():
    """Keep this process on one core, so that the parts of a large network take turns there, where that can be set."""
    if not hasattr(os, "sched_setaffinity"):
        yield
        return
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(before)})
    try:
        yield
    finally:
        os.sched_setaffinity(0, before)


@cache
def sources() -> str:
    """Return a digest of the modules that a reference depends on."""
    folders = (files("solvers") / "mooring", Path(__file__).parent)
    paths = sorted(Path(str(path)) for folder in folders for path in folder.iterdir() if path.name.endswith(".py"))
    total = hashlib.sha256()
    for path in paths:
        total.update(path.read_bytes())
    return total.hexdigest()
