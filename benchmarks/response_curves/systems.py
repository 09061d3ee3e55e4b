"""The lines whose response curves are measured, each a function of the amplitude in m and the frequency in Hz."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib.resources import files

from solvers import CableProperties, Element, Environment, Motion, Network, Node, Scene, mooring_system
from solvers.common.motions.body_motion import BodyMotion

SHALLOW = files("reference_data") / "scenes" / "dynamics" / "shallow_chain_surge.toml"
CHAIN = CableProperties(EA=384.243e6, diameter=0.09, mass_per_length=77.7066, Cdn=1.6)
TAUT_LENGTH, TAUT_SPAN, TAUT_DEPTH = 100.0, 100.05, -120.0  # m
TAUT = CableProperties(EA=2e7, diameter=0.08, mass_per_length=2.5, Cdn=1.25)
FIRST_SIDEWAYS = 0.458107  # Hz, of the taut cable at rest on ten cells
ALONG, UP = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)


def oc3(amplitude, frequency, cells=15, direction=ALONG):
    """The OC3 line without its seabed, its fairlead moved along a direction."""
    motion = Motion.harmonic(frequency, tuple(amplitude * part for part in direction))
    scene = Scene("OC3", CHAIN, 902.2, (0.0, 0.0, -320.0), (848.67, 0.0, -70.0), motion=motion)
    return mooring_system(scene, cells=cells)


def oc3_heave(amplitude, frequency, cells=15):
    """The OC3 line, its fairlead moved up and down."""
    return oc3(amplitude, frequency, cells, UP)


def taut(amplitude, frequency, cells=10, fields="spatial", direction=UP):
    """A taut cable in air between two heights alike, its second end moved up and down."""
    motion = Motion.harmonic(frequency, tuple(amplitude * part for part in direction))
    ends = (0.0, 0.0, TAUT_DEPTH), (TAUT_SPAN, 0.0, TAUT_DEPTH)
    scene = Scene("taut", TAUT, TAUT_LENGTH, *ends, Environment(rho=1.225), motion=motion)
    return mooring_system(scene, cells=cells, fields=fields, mesh="uniform")


def taut_plane(amplitude, frequency):
    """The taut cable in its plane on six cells, for maps of many points."""
    return taut(amplitude, frequency, 6, "planar")


def taut_along(amplitude, frequency):
    """The taut cable in its plane, its end moved along it: the tension changes, and little else."""
    return taut(amplitude, frequency, 10, "planar", ALONG)


def shallow(amplitude, frequency, cells=20):
    """The shallow chain over its seabed in surge."""
    return mooring_system(Scene.load(SHALLOW), cells=cells, motion=Motion.harmonic(frequency, (amplitude, 0.0, 0.0)))


def bridle(amplitude, frequency, cells=8):
    """A line whose joint hangs from two legs of a body in surge, without a seabed."""
    nodes = [Node("fixed", (853.87, 0.0, -320.0)), Node("free", (40.0, 0.0, -80.0)),
             Node("coupled", (2.6, 4.5, -70.0)), Node("coupled", (2.6, -4.5, -70.0))]  # fmt: skip
    lines = ((870.0, (0, 1)), (36.0, (1, 2)), (36.0, (1, 3)))
    w, EA = 698.094, CHAIN.EA
    elements = [Element(w, EA, length, ends, cable=CHAIN) for length, ends in lines]
    motion = BodyMotion.harmonic(frequency, (amplitude, 0.0, 0.0, 0.0, 0.0, 0.0))
    return mooring_system(Network(nodes, elements, Environment()), cells, motion=motion)


@dataclass(frozen=True)
class CurveCase:
    """A family of curves over frequencies in Hz: build(amplitude, frequency), amplitudes in m, and their settings."""

    name: str
    title: str
    build: Callable
    amplitudes: tuple[float, ...]
    start: float
    stop: float
    harmonics: int
    max_step: float = 0.1


CASES = (
    CurveCase("oc3_surge", "OC3 line in surge", oc3, (0.5, 1.0, 2.0), 0.01, 0.3, 9),
    CurveCase("oc3_heave", "OC3 line in heave", oc3_heave, (0.5, 1.0, 2.0), 0.01, 0.3, 9),
    CurveCase("taut", "Taut cable in air, its end moved up and down", taut, (0.03,), 1.9 * FIRST_SIDEWAYS,
              2.3 * FIRST_SIDEWAYS, 5),
    CurveCase("shallow", "Shallow chain over its seabed in surge", shallow, (0.5, 1.0), 0.02, 0.25, 7),
    CurveCase("bridle", "Bridle in surge", bridle, (0.5, 1.0, 2.0), 0.02, 0.15, 5, 0.2),
)  # fmt: skip
