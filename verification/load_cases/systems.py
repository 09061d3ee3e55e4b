"""Small systems and seas for tests of load cases: some milliseconds a row."""

from __future__ import annotations

import numpy as np

from solvers import CableProperties, Element, Environment, Network, Node, Scene
from solvers.common.load_case import LoadCase
from solvers.common.motions.sea_state import ResponseOperators, SeaState
from solvers.common.motions.spectrum import Spectrum

ROPE = CableProperties(EA=2e6, diameter=0.1, mass_per_length=9.0, Cdn=1.2)
TAUT = Scene("a taut rope", ROPE, 100.0, (0.0, 0.0, -70.0), (73.2, 0.0, 0.0))
CHAIN = CableProperties(EA=3e8, diameter=0.08, mass_per_length=110.0, Cdn=1.6)
OVER_SEABED = Environment(depth=50.0, seabed_stiffness=2e4, seabed_damping=1e3)
CATENARY = Scene("a chain on the seabed", CHAIN, 220.0, (0.0, 0.0, -50.0), (205.0, 0.0, -10.0), OVER_SEABED)
TWO_LINES = Network(
    (
        Node("fixed", (205.0, 0.0, -50.0)),
        Node("coupled", (5.0, 0.0, -10.0)),
        Node("fixed", (-205.0, 0.0, -50.0)),
        Node("coupled", (-5.0, 0.0, -10.0)),
    ),
    tuple(Element(CHAIN.weight_in(OVER_SEABED), CHAIN.EA, 220.0, ends, 0.0, CHAIN) for ends in ((0, 1), (2, 3))),
    OVER_SEABED,
)
SURGE = ResponseOperators([0.0, 2.0], np.array([[[1.0, 0, 0, 0, 0, 0]] * 2]))


def sea_case(name: str, Hs: float, seed: int, duration=100.0, ramp=20.0, Tp=8.0, **more) -> LoadCase:
    """Return a case of surge as high as the waves."""
    sea = SeaState(Spectrum.jonswap(Hs, Tp, 2.0), SURGE, seed, ramp + duration)
    return LoadCase(name, sea, duration, ramp, **more)
