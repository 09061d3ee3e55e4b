"""Does MoorDyn get the network that is meant? Its forces against statics, its own single line, and by symmetry."""

from __future__ import annotations

import math
import sys
from dataclasses import replace
from importlib.resources import files

import numpy as np
import pytest

from solvers import BodyMotion, CableProperties, Element, Environment, Network, Node, Scene, solve_network
from solvers.io import load_moordyn, load_network, write_moordyn

from .. import peers

MOVING = files("reference_data") / "scenes" / "networks" / "oc3_moving.toml"

LIMITS = {600.0: 4e-6, 3000.0: 1e-6}
"""Seconds of MoorDyn's relaxation -> bound of the difference over the fairlead force; measured 1.8e-6 and 6e-7, which
is what the relaxation leaves unbalanced at the free node. The longer one with --deep."""
SAME = 1e-9
"""Of the largest force: one line described twice, with steps and damping rounded another way."""
SYMMETRY = 2e-7
"""Of the largest force: 4e-8 is to where MoorDyn iterates the catenaries that it starts from."""


# The chain of the OC3 Hywind spar in two parts with a buoyed joint, beside a whole one: 20 s of motion to rest.
TWO_LINES = """--- LINE TYPES ---
Name Diam MassDen EA BA/-zeta EI Cd Ca CdAx CaAx
(-) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
main 0.09 77.7066 384.243E6 -0.8 0 1.6 1.0 0.1 0.0
light 0.09 60.0 2e8 3e6 0 1.2 0.5 0.05 0.0
--- POINTS ---
ID Attachment X Y Z M V CdA CA
(#) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)
1 Fixed 853.87 0 -320.0 0 0 0 0
2 Fixed -426.94 739.47 -320.0 0 0 0 0
3 Free 420 0 -260.0 1e3 2.0 2 0.6
4 Coupled 5.2 0.0 -70.0 0 0 0 0
5 Coupled -2.6 4.5 -70.0 0 0 0 0
--- LINES ---
ID LineType AttachA AttachB UnstrLen NumSegs LineOutputs
(#) (name) (#) (#) (m) (-) (-)
1 main 1 3 450.0 20 -
2 light 3 4 452.2 15 -
3 main 2 5 902.2 12 -
--- OPTIONS ---
0.004 dtM
20.0 TmaxIC
1 ICgenDynamic
1e-9 threshIC
0 writeLog
1 disableOutput
1 disableOutTime
320 WtrDpth
--- need this line ---
"""


@pytest.fixture(scope="module")
def moordyn():
    """The adapter, where MoorDyn is installed."""
    if "moordyn" not in peers.adapters():
        pytest.skip("the optional peer is not installed")
    return peers.adapters()["moordyn"]


def bridle() -> Network:
    """Two ropes from anchors to a buoyed node, a chain from there to the body; nothing on the seabed."""
    rope = CableProperties(EA=2e7, diameter=0.12, mass_per_length=25.0, Cdn=1.2, Cdt=0.05, Ca=1.0)
    chain = CableProperties(EA=1e8, diameter=0.08, mass_per_length=80.0, Cdn=2.0, Cdt=0.1, Ca=1.0)
    environment = Environment()
    nodes = [
        Node("fixed", (0.0, 0.0, -80.0)),
        Node("fixed", (30.0, 60.0, -90.0)),
        Node("free", (60.0, 25.0, -60.0), mass=2000.0, volume=1.0, CdA=2.0, Ca=0.5),
        Node("coupled", (120.0, 40.0, -10.0)),
    ]
    lines = [(rope, 70.0, (0, 2)), (rope, 60.0, (1, 2)), (chain, 80.0, (2, 3))]
    elements = [Element(cable.weight_in(environment), cable.EA, L, ends, cable=cable) for cable, L, ends in lines]
    return Network(nodes, elements, environment)


def test_a_written_network_has_our_static_forces_in_the_limit(moordyn, request):
    """MoorDyn is of second order in the length of a segment; extrapolated it has the forces of the catenaries."""
    network = bridle()
    state = solve_network(network)
    forces_at_rest = sys.modules[type(moordyn).__module__].forces_at_rest
    seconds = max(LIMITS) if request.config.getoption("--deep", default=False) else min(LIMITS)
    coarse, fine = (forces_at_rest(network, cells, seconds)[3] for cells in (8, 16))
    size = np.linalg.norm(state.reaction[3])
    errors = [np.linalg.norm(force - state.reaction[3]) / size for force in (coarse, fine)]
    assert 3.5 < errors[0] / errors[1] < 4.5, errors
    limit = np.linalg.norm((4 * fine - coarse) / 3 - state.reaction[3]) / size
    assert limit <= LIMITS[seconds], limit


def test_a_file_read_and_written_is_the_same_to_moordyn(moordyn, tmp_path):
    """Sections, ratios of damping, seabed, points with loads: MoorDyn's forces of a file and of the one made of it."""
    forces_of_file = sys.modules[type(moordyn).__module__].forces_of_file
    first, second = tmp_path / "first.txt", tmp_path / "second.txt"
    first.write_text(TWO_LINES, encoding="ascii")
    network = load_moordyn(first)
    same = {
        "dtM": 0.004,
        "TmaxIC": 20.0,
        "ICgenDynamic": 1,
        "threshIC": 1e-9,
        "writeLog": 0,
        "disableOutput": 1,
        "disableOutTime": 1,
    }
    write_moordyn(second, network, cells=[20, 15, 12], options=same)
    coupled = [node.r for node in network.nodes if node.kind == "coupled"]
    expected, result = (forces_of_file(file, coupled, len(network.nodes)) for file in (first, second))
    assert abs(expected).max() > 1e5
    np.testing.assert_allclose(result, expected, rtol=0, atol=SAME * abs(expected).max())


def test_a_network_of_one_line_is_that_line(moordyn):
    """The adapter of networks against that of single lines: the same forces at every coupling step."""
    scene = Scene.load(files("reference_data") / "scenes" / "mooring" / "oc3.toml")
    scene = replace(scene, friction=(0.0,), cable=replace(scene.cable, damping=0.0, submerged_weight=None))
    element = Element(scene.cable.weight_in(scene.environment), scene.cable.EA, scene.length, (0, 1), cable=scene.cable)
    network = Network([Node("fixed", scene.anchor), Node("coupled", scene.fairlead)], [element], scene.environment)
    motion = BodyMotion.harmonic(0.1, (1.0, 0.0, 0.5, 0.0, 0.01, 0.0), reference=(0.0, 0.0, -30.0)).ramped(5.0)
    time = np.arange(101) * 0.1
    fairlead = np.array(scene.fairlead) + motion.displacement([scene.fairlead], time)[:, 0].T
    expected = moordyn.cable(scene, time, fairlead, 10)
    forces = moordyn.moving_network(network, motion, time, 10)
    assert forces.shape == (1, 3, 101)
    tension = np.linalg.norm(forces[0], axis=0)
    assert np.ptp(expected) > 0.05 * expected.max()
    np.testing.assert_allclose(tension, expected, rtol=0, atol=SAME * expected.max())


def test_yaw_turns_three_equal_lines_alike(moordyn):
    """Pure yaw of three lines 120 degrees apart: each fairlead has the force of the first, turned; no net force."""
    network = load_network(MOVING)
    angles = [0.0, 2 * math.pi / 3, -2 * math.pi / 3]
    nodes = [
        replace(node, r=(math.hypot(*node.r[:2]) * math.cos(a), math.hypot(*node.r[:2]) * math.sin(a), node.r[2]))
        for node, a in zip(network.nodes, np.repeat(angles, 2), strict=True)
    ]
    network = Network(nodes, network.elements, network.environment)
    time = np.arange(41) * 0.25
    forces = moordyn.moving_network(network, BodyMotion.harmonic(0.1, (0, 0, 0, 0, 0, 0.2)).ramped(5.0), time, 10)
    size = abs(forces).max()
    for force, angle in zip(forces, angles, strict=True):
        c, s = math.cos(angle), math.sin(angle)
        turned = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]) @ forces[0]
        np.testing.assert_allclose(force, turned, rtol=0, atol=SYMMETRY * size)
    assert abs(forces.sum(axis=0)[:2]).max() <= 3 * SYMMETRY * size
    assert np.ptp(forces[0, 1]) > 0.01 * size


def test_what_moordyn_cannot_state_is_outside_its_model(moordyn):
    network = load_network(MOVING)
    time = np.arange(3) * 0.1
    rubbing = Network(network.nodes, [replace(e, friction=0.5) for e in network.elements], network.environment)
    with pytest.raises(NotImplementedError, match="friction"):
        moordyn.moving_network(rubbing, network.motion, time, 5)
    current = replace(network.environment, current=(1.0, 0.0, 0.0))
    with pytest.raises(NotImplementedError, match="current"):
        moordyn.moving_network(Network(network.nodes, network.elements, current), network.motion, time, 5)


def test_moordyn_is_told_to_solve_no_network_at_rest():
    """Its method for moving networks is not that of networks at rest, which no table asks it for."""
    adapter = peers.Adapter()
    assert not adapter.solves("moving_network") and not adapter.solves("network")
