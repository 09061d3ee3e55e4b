"""Do lines that meet at joints move as they must: at rest, over time and in a periodic motion, in whatever order?

Truth: solve_network for the rest, verification/exact for motions (an explicit integrator, closed forms, a manufactured
bridle), the same line without its joints, and symmetries. Networks are those of verification/cases, of the scenes and
of verification/exact/random_networks.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from importlib.resources import files

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from solvers import Motion, Network, Node, mooring_system, solve_network, solve_periodic, solve_time_domain
from solvers.common.motions.body_motion import BodyMotion
from solvers.common.outcome import Status
from solvers.io import load_network
from solvers.mooring import harmonic_impedance, mooring_impedance, mooring_stiffness
from solvers.mooring.stepping.time_domain import _Run, stream_line
from solvers.numerics.modes import natural_modes

from ..cases import networks as cases
from ..exact.mooring import moving_network
from ..exact.mooring.manufactured_bridle import ManufacturedBridle, load_of
from ..exact.mooring.random_networks import random_history, random_network
from ..exact.network import joint_modes, linear_network, network_symmetry
from ..exact.rigid_motion import RigidMotion
from ..tools.orders import assert_order, extrapolated
from .networks import case_network, exact_system, section, with_line_far_away
from .problems import energy_gap, energy_of


@pytest.fixture(autouse=True)
def no_limit_of_strain(monkeypatch):
    """The networks of other programs are so soft that an explicit integrator can follow them: beyond 0.3 of strain."""
    for module in ("system", "stepping.time_domain"):
        monkeypatch.setattr(f"solvers.mooring.{module}.MAX_STRAIN", math.inf)


SCENES = files("reference_data") / "scenes" / "networks"


def scene(name, seabed_stiffness: float | None = 1e6):
    """Return the Network of a scene with sections for dynamics; over no seabed with a stiffness of None."""
    given = load_network(str(SCENES / f"{name}.toml"))
    elements = [replace(e, cable=section(e.w, e.EA), friction=0.0) for e in given.elements]
    depth = None if seabed_stiffness is None else given.environment.depth
    bed = replace(given.environment, depth=depth, seabed_stiffness=seabed_stiffness)
    return Network(given.nodes, elements, bed)


# ---------------------------------------------------------------- at rest
SUSPENDED = [cases.two_line(depth=None), cases.symmetric_v(), cases.bridle()]
ON_SEABED = {
    "three bridles": lambda: case_network(cases.bridle_system()),
    "chain, wire, chain": lambda: case_network(cases.chain_wire_chain()),
    **{name: (lambda name=name: scene(name)) for name in ("oc3_three_lines", "chain_wire_chain", "three_bridles")},
}
CELLS = (40, 80, 160)
EXTRAPOLATED = 1e-7  # of the largest force, or of the longest line; measured 5.2e-8 of the bridle
OVER_A_FLOOR = 1.3e-4  # likewise on 160 cells: the touchdown falls within a cell, w/k is 1 to 2 mm; measured 6.6e-5


def errors_at_rest(network, cells):
    """Return the errors of forces on the nodes above the seabed that hold the network, and of joints (P, 3) each.

    Over the largest force, and the length of the longest line.
    """
    bed = replace(network.environment, seabed_stiffness=None)
    exact = solve_network(Network(network.nodes, network.elements, bed))
    system = mooring_system(with_line_far_away(network), cells, mesh="uniform")
    at = system.layout.points[: len(network.nodes)]
    lies = [bed.depth is not None and r[2] < 1e-6 - bed.depth for r in exact.r]
    is_holder = np.array([node.kind != "free" and not low for node, low in zip(network.nodes, lies, strict=True)])
    size = np.linalg.norm(exact.reaction[is_holder], axis=1).max()
    forces = (system.rest.forces.T[at] - exact.reaction) * is_holder[:, None]
    return forces / size, (system.rest.r.T[at] - exact.r) / max(element.L for element in network.elements)


@pytest.mark.parametrize("case", SUSPENDED, ids=lambda case: case.name)
def test_networks_rest_on_catenaries_as_cells_shrink(case):
    """Forces on the holders and places of joints tend to those of solve_network with the square of the cell."""
    tables = zip(*(errors_at_rest(case_network(case), cells) for cells in CELLS), strict=True)
    for what, table in zip(("forces", "places"), tables, strict=True):
        worst = np.unravel_index(abs(table[-1]).argmax(), table[-1].shape)
        assert_order([1 / c for c in CELLS], [error[worst] for error in table], 2, ceiling=1e-4, what=what)
        assert abs(extrapolated([1 / c for c in CELLS], table)).max() <= EXTRAPOLATED


def test_a_net_of_weightless_lines_rests_on_any_mesh():
    """Straight cells are the catenary of a line without weight: four cells are as good as the limit."""
    for error in errors_at_rest(case_network(cases.spring_net()), 4):
        assert abs(error).max() <= 1e-11


@pytest.mark.parametrize("name", ON_SEABED)
def test_networks_rest_on_a_seabed(name):
    """With 160 cells on a stiff seabed forces and joints are those of solve_network over a rigid one."""
    forces, places = errors_at_rest(ON_SEABED[name](), 160)
    assert abs(forces).max() <= OVER_A_FLOOR and abs(places).max() <= OVER_A_FLOOR


@pytest.mark.parametrize("cells", [10, 40, 80])
def test_a_clump_weight_rests_on_the_seabed(cells):
    """It sinks by what it weighs beyond what its lines lift, over the stiffness of the cells that meet at it."""
    network = case_network(cases.clump_weight())
    system = mooring_system(network, cells, mesh="uniform")
    state, clump = system.rest, system.layout.points[1]
    assert state.iterations <= 8
    _, places = errors_at_rest(network, cells)
    sinkage, exact = -100.0 - state.r[2, clump], solve_network(as_rigid(network))
    lifted = sum(exact.V[e] - network.elements[e].w * network.elements[e].L for e in (1, 2))
    borne = 9.80665 * 3e4 - lifted
    stiffness = system.line.seabed_stiffness[clump]
    assert sinkage == pytest.approx(borne / stiffness, rel=0.02) and abs(places[1, :2]).max() <= 1e-4


def as_rigid(network):
    """Return a network over the rigid seabed that statics takes."""
    return Network(network.nodes, network.elements, replace(network.environment, seabed_stiffness=None))


# ---------------------------------------------------------------- a line in pieces
SURGING = BodyMotion.harmonic(0.1, (2.0, 0.5, 1.0, 0.0, 0.0, 0.0), (0.0, 0.4, 1.0, 0.0, 0.0, 0.0))
CUT = 1e-11  # of the tension and the length: the cells are equal but for rounding of arc lengths; measured 5e-13


@cache
def one_line_and_six():
    """Return the system of a line and that of the same one cut by joints without mass, and its nodes in the latter."""
    whole, cut = cases.chain(1), cases.chain(6)
    s = np.linspace(0.0, 600.0, 19)
    line = mooring_system(case_network(whole), mesh=s, motion=SURGING, fields="spatial", calibrate=False)
    mixed = cut.renumbered([3, 0, 5, 6, 1, 4, 2], [4, 1, 5, 0, 3, 2])  # with two elements the other way round
    mixed = replace(
        mixed, elements=[replace(e, ends=e.ends[:: -1 if i in (1, 4) else 1]) for i, e in enumerate(mixed.elements)]
    )
    pieces = [s[:4]] * 6 + [[0.0, 20.0, 39.9]]
    many = mooring_system(with_line_far_away(case_network(mixed)), mesh=pieces, motion=SURGING)
    order = np.empty(19, int)
    for piece, e in enumerate([4, 1, 5, 0, 3, 2]):
        order[3 * e : 3 * e + 4] = many.layout.nodes[piece][:: -1 if piece in (1, 4) else 1]
    return line, many, order


def assert_same_line(one, other, order):
    """Hold positions and forces of the nodes of a line to those of its pieces."""
    assert one.success and other.success
    assert abs(one.r - other.r[:, order]).max() <= CUT * 600.0
    assert abs(one.forces - other.forces[:, order]).max() <= CUT * one.tension.max()


def test_a_line_cut_by_joints_is_the_line():
    """Six pieces that meet in joints without mass, two of them the other way round: at rest, moving and periodic."""
    line, pieces, order = one_line_and_six()
    assert line.model.is_line and not pieces.model.is_line
    assert_same_line(line.rest, pieces.rest, order)
    settings = {"dt": 0.1, "periods": 2, "tolerance": 1e-10}
    assert_same_line(*(solve_time_domain(system, **settings) for system in (line, pieces)), order)
    assert_same_line(*(solve_periodic(system, harmonics=4) for system in (line, pieces)), order)


# ---------------------------------------------------------------- symmetries
ALIKE = 1e-11  # of the largest tension, and the length: Newton's method ends at rounding; measured 8e-14
CHANGED = {0: "clump with three lines", 2: "bridle", 4: "crossing", 3: "on a seabed"}
PERIODIC = (2, 4)  # of these, those that settle into a periodic motion without slack or contact


def changes(seed):
    """Return (name, Change) of a random network: turned, reflected, in another order, with ends exchanged."""
    network = random_network(seed).network
    level = replace(network, motion=replace(network.motion, amplitude=(*network.motion.amplitude[:3], 0, 0, 0.04)))
    rng = np.random.default_rng(seed)
    lines, nodes = len(network.lines.ends), len(network.nodes.kind)
    return {
        "turned": (level, network_symmetry.rotate(level, 0.9, (3.0, -2.0))),
        "reflected": (network, network_symmetry.reflect(network, (0.0, 1.0))),
        "another order": (network, network_symmetry.renumber(network, rng.permutation(nodes), rng.permutation(lines))),
        "ends exchanged": (network, network_symmetry.renumber(network, swapped=np.arange(lines) % 2 == 0)),
    }


@pytest.mark.parametrize("change", ["turned", "reflected", "another order", "ends exchanged"])
@pytest.mark.parametrize("seed", CHANGED, ids=CHANGED.get)
def test_order_and_direction_do_not_matter(seed, change):
    """Positions and tensions of a changed network, mapped back, are those of the original, and as much work is done."""
    network, change = changes(seed)[change]
    one, other = exact_system(network), exact_system(change.network)

    def assert_alike(a, b):
        tension = one.tensions(a)
        assert abs(change.cells_back(other.tensions(b)) - tension).max() <= ALIKE * tension.max()
        places = change.positions_back(other.in_exact_order(b.r))
        assert abs(places - one.in_exact_order(a.r)).max() <= ALIKE * one.system.length

    assert_alike(one.system.rest, other.system.rest)
    histories = [solve_time_domain(pair.system, dt=0.05, duration=5.0, tolerance=1e-10) for pair in (one, other)]
    assert_alike(*histories)
    for count in ("steps", "cut", "damped_from"):
        assert getattr(histories[0], count) == getattr(histories[1], count)
    if seed in PERIODIC:
        assert_alike(*(solve_periodic(pair.system, harmonics=4) for pair in (one, other)))


@pytest.mark.parametrize("seed", PERIODIC)
def test_work_does_not_depend_on_the_order(seed):
    """Steps of a fixed size take as many iterations and factorisations in whatever order nodes and lines are given."""
    network, change = changes(seed)["another order"]
    one, other = (solve_time_domain(exact_system(n).system, dt=0.05, duration=5.0) for n in (network, change.network))
    assert (one.iterations, one.factorisations) == (other.iterations, other.factorisations)
    assert one.factorisations < one.steps / 2


@pytest.mark.parametrize("lines", [3, 4])
def test_lines_in_a_ring_are_equal_under_yaw(lines):
    """Around a body that turns about the axis of a ring, and heaves, all lines have the same tensions."""
    motion = RigidMotion((0.0, 0.0, 5.0), 0.9, (0.0, 0.0, 0.8, 0.0, 0.0, 0.1), (0.0, 0.0, 0.4, 0.0, 0.0, 1.0))
    system = ring(lines, motion)
    history = solve_time_domain(system.system, dt=0.05, duration=10.0, tolerance=1e-10)  # each ends by itself
    results = history, solve_periodic(system.system, harmonics=4)
    for result in results:
        tension = system.tensions(result).reshape(result.time.size, lines, -1)
        assert network_symmetry.spread_error(tension.swapaxes(0, 1)) <= ALIKE
        assert np.ptp(tension[..., -1], axis=0).min() > 0.05 * tension.max()


def test_lines_in_a_ring_follow_a_circling_body_in_turn():
    """With a body that circles the axis, each line has the tension of the one before a third of a period later."""
    system = ring(3, network_symmetry.circling(0.8, 0.9))
    response = solve_periodic(system.system, harmonics=6, samples=48)
    tension = system.tensions(response).reshape(response.time.size, 3, -1)[..., -1].T
    assert response.time.size % 3 == 0 and network_symmetry.shift_error(tension) <= ALIKE


def ring(lines, motion):
    """Return a ring of equal lines as an ExactSystem."""
    section = {
        "EA": 4e4,
        "beta": 0.05,
        "mass": 30.0,
        "added_mass": 10.0,
        "weight": 180.0,
        "d": 0.12,
        "Cdn": 1.2,
        "Cdt": 0.05,
    }
    place = {"radius": 45.0, "depth": 30.0, "fairlead_radius": 5.0, "length": 49.5, "cells": 6}
    return exact_system(network_symmetry.ring(lines, **place, motion=motion, line=section))


# ---------------------------------------------------------------- harmonic balance and time integration
MOTIONS = {
    "surge": (2.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    "sway": (0.0, 2.0, 0.0, 0.0, 0.0, 0.0),
    "yaw": (0.0, 0.0, 0.0, 0.0, 0.0, 0.05),
    "all six": (2.0, 1.0, 1.0, 0.02, 0.02, 0.05),
}
HARMONICS, STEPS = 20, 400  # of a period of 20 s
TWO_METHODS = 4e-4  # |u| u has harmonics without end, of which those above the 20th are left out; measured 2.6e-4


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("name", ["oc3_three_lines", "three_bridles"])
def test_harmonic_balance_and_time_integration_agree(name, motion, deep):
    """The tension of every cell of three lines and of nine, hanging freely, over the last of six periods.

    Relative to its range, or to a tenth of the tension where that hardly changes, as of three lines under yaw.
    """
    if not deep and (name, motion) not in (("oc3_three_lines", "yaw"), ("three_bridles", "all six")):
        pytest.skip("in the long version")
    body = BodyMotion.harmonic(0.05, MOTIONS[motion], (0.0, 0.3, 0.6, 0.9, 1.2, 1.5), (0.0, 0.0, -60.0))
    system = mooring_system(scene(name, None), 8, motion=body, mesh="uniform")
    response, tables = solve_periodic(system, harmonics=HARMONICS), []
    for count in (STEPS, 2 * STEPS):
        history = solve_time_domain(system, dt=20.0 / count, periods=6, tolerance=1e-7)
        tables.append(history.tension[:, -count - 1 : -1 : count // STEPS])
    t = 20.0 * np.arange(STEPS) / STEPS
    balance = system.forces(response.at(t), response.rate_at(t), response.acceleration_at(t))[1]
    size = max(np.ptp(balance, axis=1).max(), 0.1 * balance.max())
    assert abs(extrapolated((2.0, 1.0), tables) - balance).max() <= TWO_METHODS * size


REFINED = 1e-4  # of the range of each line's tension; measured 3.7e-5 hanging freely, 3.7e-5 over a seabed
FINE = {"hanging": (40, (800, 1600)), "over a seabed": (80, (1600, 3200))}
"""Harmonics, and steps in a period, of which the error is extrapolated: nodes that touch down one by one have spectra
that end slowly, and with 40 harmonics over a seabed 1.4e-4 is left."""
PERIODS = {"yaw": 40}  # until what the small swing of lines across leaves is gone; of the others eight
BY_DEFAULT = ("over a seabed", "oc3_three_lines", "all six")


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("name", ["oc3_three_lines", "three_bridles"])
@pytest.mark.parametrize("bed", FINE)
def test_both_methods_agree_on_each_line_when_refined(bed, name, motion, deep):
    """With many harmonics and small steps, of lines with an internal damper, whose axial waves die out."""
    if not deep and (bed, name, motion) != BY_DEFAULT:
        pytest.skip("in the long version")
    given = scene(name, SEABED if bed == "over a seabed" else None)
    given = replace(given, elements=[replace(e, cable=replace(e.cable, damping=0.1)) for e in given.elements])
    amplitude = tuple(2.0 * size if motion == "yaw" else 1.5 * size for size in MOTIONS[motion])
    system = mooring_system(given, 20, motion=BodyMotion.harmonic(0.05, amplitude, (0.0, 0.3, 0.6, 0.9, 1.2, 1.5)))
    periods, t = PERIODS.get(motion, 8), 20.0 * np.arange(STEPS) / STEPS
    harmonics, counts = FINE[bed]
    tables = []
    for count in counts:
        history = solve_time_domain(system, dt=20.0 / count, periods=periods, every=2, tolerance=1e-7)
        tables.append(np.array([line.fairlead_tension(t + 20.0 * (periods - 1)) for line in history.elements]))
    response = solve_periodic(system, harmonics=harmonics, samples=6 * harmonics)
    balance = np.array([line.fairlead_tension(t) for line in response.elements])
    ranges, lies = np.ptp(balance, axis=1)[:, None], history.r[2] < system.line.floor
    assert (lies.any(axis=1) & ~lies.all(axis=1)).any() == (bed == "over a seabed" and motion != "yaw")
    assert (abs(extrapolated((2.0, 1.0), tables) - balance) / ranges).max() <= REFINED


SEABED = 3e3  # N/m^2: soft clay, into which these lines sink by 0.23 m
OVER_A_SEABED = 0.014  # of the range: nodes that touch down one by one excite more than nine harmonics; 0.0068


@pytest.mark.parametrize("motion", ["surge", "all six"])
@pytest.mark.parametrize("name", ["oc3_three_lines", "three_bridles"])
def test_both_methods_agree_over_a_seabed(name, motion):
    """Force and moment on the body, of lines that lift off and touch down, over the last of five periods."""
    body = BodyMotion.harmonic(0.05, MOTIONS[motion], (0.0, 0.3, 0.6, 0.9, 1.2, 1.5), (0.0, 0.0, -60.0))
    system = mooring_system(scene(name, SEABED), 30, motion=body)
    response, history = solve_periodic(system, harmonics=9), solve_time_domain(system, dt=20.0 / STEPS, periods=5)
    lies = history.r[2] < system.line.floor
    assert (lies.any(axis=1) & ~lies.all(axis=1)).any() and (history.tension > 0).all()
    for balance, steps in ((response.body_force, history.body_force), (response.body_moment, history.body_moment)):
        last = CubicSpline(history.time[-STEPS - 1 :] - 80.0, steps[:, -STEPS - 1 :], axis=1)(response.time)
        assert abs(balance - last).max() <= OVER_A_SEABED * np.ptp(balance, axis=1).max()


# ---------------------------------------------------------------- energy
@pytest.mark.parametrize("seed", [2, 4, 5])
def test_energy_of_a_network_closes(seed):
    """Energy of all lines and points changes by the work of body, drag, dampers and current, up to dt^2."""
    system, dts = exact_system(random_network(seed).network).system, (0.02, 0.01, 0.005)
    histories = [solve_time_domain(system, dt=dt, duration=5.0, tolerance=1e-9, rho_inf=0.5) for dt in dts]
    energy = energy_of(histories[-1])
    assert energy.drag.any() and energy.damper.any() and np.ptp(energy.given) > 0
    assert_order(dts, [energy_gap(history) for history in histories], 2, ceiling=4e-6, what=str(seed))


# ---------------------------------------------------------------- frequencies
def test_arms_at_a_joint_have_their_frequencies():
    """Three taut arms in cells that meet at a mass: strings and bars coupled by the joint, to rounding."""
    tension, EA, mass, length, cells, joint = 5e4, 2e6, 20.0, 60.0, 5, 400.0
    exact = joint_modes.star_frequencies(2, arms=3, tension=tension, EA=EA, mass=mass, added_mass=0.0, length=length,
                                         joint_mass=joint, cells=cells)  # fmt: skip
    far, angle = length * (1 + tension / EA), 2 * np.pi * np.arange(3) / 3
    nodes = moving_network.Nodes(
        far * np.array([[0, 0, 0], *zip(np.cos(angle), np.sin(angle), 0 * angle, strict=True)]),
        ("free", "fixed", "coupled", "fixed"), mass=[joint, 0, 0, 0],
        force=[[0, 0, joint * 9.81], *[[0, 0, 0]] * 3],
    )  # fmt: skip
    lines = moving_network.Lines([(0, 1), (2, 0), (0, 3)], length, cells, EA, mass=mass)
    system = exact_system(moving_network.Network(nodes, lines, rho=0.0)).system
    twice = {"in plane": 2, "out of plane": 1, "axial": 1, "transverse in plane": 1, "transverse out of plane": 2}
    every = sorted(float(f) for kind, times in twice.items() for f in exact[kind] * times)
    lowest = [f for f in every if f <= min(float(exact[kind][-1]) for kind in twice)]
    got = natural_modes(system, len(lowest)).frequencies
    assert len(lowest) >= 6 and abs(got / lowest - 1).max() <= 1e-9


@pytest.mark.parametrize("mass", [900.0, -1.0])
def test_a_point_on_light_lines_has_its_frequencies(mass):
    """A clump weight, or a buoy, on three lines of next to no mass: those of its stiffness and mass."""
    mass, volume = (mass, 0.1) if mass > 0 else (300.0, 1.5)
    ends = ((-30.0, 0.0, 0.0), (25.0, 5.0, 3.0), (2.0, 35.0, -4.0))
    length, EA, light = (28.0, 26.0, 28.0), (3e4, 4e4, 2.5e4), 1e-6
    weight, added = 9.81 * (mass - 1025.0 * volume), 0.5 * 1025.0 * volume
    point = joint_modes.PointOnLines(ends, length, EA, mass, weight, added)
    r = point.equilibrium((0.0, 6.0, -20.0 if weight > 0 else 20.0))
    place = tuple(float(x) for x in r)
    nodes = moving_network.Nodes([*ends, place], ("fixed", "fixed", "coupled", "free"), mass=[0, 0, 0, mass],
                                 volume=[0, 0, 0, volume], Ca=0.5)  # fmt: skip
    lines = moving_network.Lines([(0, 3), (3, 1), (2, 3)], length, 2, EA, mass=light)
    system = exact_system(moving_network.Network(nodes, lines)).system
    assert abs(system.rest.r[:, system.layout.points[3]] - place).max() <= 1e-8
    wanted = np.array([float(f) for f in point.frequencies(r)])
    assert (
        abs(natural_modes(system, 3).frequencies / wanted - 1).max() <= 1e-6
    )  # the lines have a millionth of the mass


@pytest.mark.parametrize("seed", [2, 4])
def test_modes_of_a_network_are_those_of_its_matrices(seed):
    """Undamped frequencies about rest are those of mass and stiffness by complex steps of another program's forces."""
    network = random_network(seed).network
    lines = replace(network.lines, beta=np.zeros(len(network.lines.ends)))
    pair = exact_system(replace(network, lines=lines, current=(0.0, 0.0, 0.0), motion=RigidMotion()))
    exact = linear_network.linearise(pair.exact, pair.in_exact_order(pair.system.rest.r)).frequencies()[0]
    got = natural_modes(pair.system, 8).frequencies
    assert abs(got / exact[:8] - 1).max() <= 1e-9


# ---------------------------------------------------------------- the explicit integrator
AS_FAR = 1e-7  # m, of motions of a metre or two, where two steps are extrapolated; measured 6e-8, over 2 s 5e-9


@pytest.mark.parametrize("seed", range(10))
def test_random_networks_move_as_another_program_has_them(seed, deep):
    """Positions of all nodes tend with dt^2 to those of an explicit integrator of ten digits."""
    if not deep and seed not in (3, 4):
        pytest.skip("in the long version")
    duration, most = (5.0, 8000) if deep else (2.0, 4000)
    case, exact = random_network(seed), random_history(seed, duration=duration, samples=11)
    pair, counts = exact_system(case.network), (most // 4, most // 2, most)
    start = pair.coordinates(case.position), pair.rates(case.velocity)
    places = [
        pair.in_exact_order(
            solve_time_domain(pair.system, dt=duration / count, duration=duration, start=start, rho_inf=0.8,
                              tolerance=1e-11, every=count // 10).r)
        for count in counts
    ]  # fmt: skip
    errors = [abs(place - exact.position).max() for place in places]
    assert_order([1 / count for count in counts], errors, 2, ceiling=1e-4, what=f"seed {seed}")
    assert abs(extrapolated([1 / count for count in counts], places) - exact.position).max() <= AS_FAR
    assert abs(exact.position - exact.position[0]).max() > 0.2


FORCES = 1e-8  # of the largest, where two steps are extrapolated; measured 2.4e-9


@pytest.mark.parametrize("seed", [2, 4])
def test_forces_on_the_body_are_those_of_another_program(seed):
    """Force and moment on the body, about its moved reference point, and forces at the ends of each line alone."""
    case, exact = random_network(seed), random_history(seed, duration=1.0, samples=6)
    pair, tables = exact_system(case.network), []
    start = pair.coordinates(case.position), pair.rates(case.velocity)
    for count in (1000, 2000):
        history = solve_time_domain(pair.system, dt=1.0 / count, duration=1.0, start=start, rho_inf=1.0,
                                    tolerance=1e-11, every=count // 5)  # fmt: skip
        ends = [[element.anchor_force.T, element.fairlead_force.T] for element in history.elements]
        tables.append([history.body_force.T, history.body_moment.T, np.moveaxis(np.array(ends), 2, 0)])
    lines = len(case.network.lines.ends)
    wanted = [exact.body_force, exact.body_moment, exact.end_force]
    for *got, true in zip(*tables, wanted, strict=True):
        got = extrapolated((2.0, 1.0), [table[:, :lines] if table.ndim == 4 else table for table in got])
        assert abs(got - true).max() <= FORCES * abs(true).max()


def test_impedance_is_that_of_linear_motions():
    """Z of the body's six degrees of freedom at three frequencies, by small motions of another program's matrices."""
    network = random_network(4).network
    network = replace(network, current=(0.0, 0.0, 0.0))
    pair = exact_system(network)
    exact = linear_network.linearise(network, pair.in_exact_order(pair.system.rest.r))
    reference, frequencies = network.motion.reference, np.array([0.0, 0.08, 0.4])
    Z = mooring_impedance(pair.system, frequencies, reference)
    at = pair.system.rest.forces[:, pair.nodes[moving_network.Mesh(network).coupled]].T
    arms = network.nodes.position[[4, 5]] - reference
    for k, omega in enumerate(2 * np.pi * frequencies):
        for j in range(6):
            unit = np.eye(6)[j]
            _, _, forces = exact.response(omega, exact.held_by_body(unit, np.zeros(6)))
            moved = np.cross(unit[3:], arms)
            forces = forces[exact.mesh.coupled]
            moment = (np.cross(arms, forces) + np.cross(moved, at)).sum(axis=0)
            wanted = np.concatenate([forces.sum(axis=0), moment])
            assert abs(Z[k, :, j] + wanted).max() <= 1e-9 * abs(Z[k]).max()
    assert np.allclose(mooring_stiffness(pair.system, reference), Z[0].real, rtol=1e-12)


def test_impedance_of_small_motions_is_that_of_finite_ones():
    """Below all natural frequencies the difference is the drag's, which falls with the amplitude: 3e-3 at 1 mm."""
    network = replace(random_network(4).network, current=(0.0, 0.0, 0.0))
    system, reference = exact_system(network).system, network.motion.reference
    linear = mooring_impedance(system, 0.05, reference)
    finite = [harmonic_impedance(system, 0.05, [a] * 3 + [a / 20] * 3, reference) for a in (2e-3, 1e-3)]
    errors = [abs(Z - linear).max(axis=0) / abs(linear).max(axis=0) for Z in finite]
    assert (errors[1] <= 5e-3).all() and abs(errors[1] / errors[0] - 0.5).max() <= 0.01


PARTS = 1e-10  # of the largest tension: each part ends Newton's method by itself, at as much; measured 1.4e-11


def test_a_network_is_taken_apart_where_nodes_are_prescribed():
    """Nine lines in three parts that a body joins: rest, motion and balance are those of all of them at once.

    Two parts end at each point of the body, which carries a mass and a force.
    """
    case, motion = cases.bridle_system(), BodyMotion.harmonic(0.05, MOTIONS["all six"], reference=(0.0, 0.0, -60.0))
    loaded = [replace(n, mass=2e3, force=(100.0, 0.0, 50.0)) if n.kind == "coupled" else n for n in case.nodes]
    network = case_network(replace(case, nodes=loaded, environment=replace(case.environment, depth=None)))
    system, whole = (mooring_system(network, 6, motion=motion, mesh="uniform") for _ in range(2))
    whole.__dict__["components"] = ()
    assert len(system.components) == 3 and not whole.components
    assert sorted(cell for part in system.components for cell in part.cells) == list(range(system.line.length.size))

    def assert_alike(one, other):
        size = other.tension.max()
        assert abs(one.tension - other.tension).max() <= PARTS * size
        assert abs(one.forces - other.forces).max() <= PARTS * size
        assert abs(one.r - other.r).max() <= PARTS * system.length

    assert_alike(system.rest, whole.rest)
    start = whole.rest.y + 1e-4 * np.sin(np.arange(whole.rest.y.size)).reshape(whole.rest.y.shape), None
    start[0][:, system.prescribed_nodes] = system.path(np.zeros(1))[0, 0].T
    for options in ({"periods": 1}, {"duration": 2.0, "start": start, "rho_inf": 0.8}):
        assert_alike(*(solve_time_domain(one, dt=0.1, tolerance=1e-10, **options) for one in (system, whole)))
    for corrected in (False, True):
        assert_alike(*(solve_periodic(one, harmonics=4, deferred_correction=corrected) for one in (system, whole)))
    history = solve_time_domain(system, dt=0.1, periods=1)
    assert_alike(*(solve_periodic(one, harmonics=4, start=history) for one in (system, whole)))


def test_the_equilibrium_of_the_parts_is_solved_for_once(monkeypatch):
    """A history and a response of lines that are at rest already ask for no equilibrium again."""
    system = mooring_system(load_network(files("reference_data") / "scenes" / "networks" / "oc3_moving.toml"), 8)
    assert len(system.components) == 3 and system.rest.success

    def refuse(*arguments):
        raise AssertionError("an equilibrium is solved for")

    monkeypatch.setattr("solvers.mooring.statics._Statics.newton", refuse)
    assert solve_time_domain(system, dt=0.5, periods=1).success
    assert solve_periodic(system, harmonics=3).success


def to_a_body():
    """Return a network of two lines to a point of a body."""
    network = case_network(cases.two_line(depth=None))
    nodes = [*network.nodes[:2], Node("coupled", (-26.0, 0.0, -65.0))]
    return Network(nodes, network.elements, network.environment)


def test_two_lines_to_a_body_are_two_parts():
    """As few as there can be."""
    one, other = (part.cells.tolist() for part in mooring_system(to_a_body(), 8).components)
    assert one + other == list(range(8))


def two_lines(motion, **options):
    """Return the system of two lines to a point of a body and a third one, and the same one not taken apart."""
    network = with_third_line(to_a_body())
    system, whole = (mooring_system(network, 8, motion=motion, **options) for _ in range(2))
    whole.__dict__["components"] = ()
    return system, whole


def with_third_line(network):
    """Return a network of two lines with one more, so that it is no line."""
    third = replace(network.elements[0], L=860.0, ends=(3, 2))
    nodes = [*network.nodes, Node("fixed", (0.0, 700.0, -350.0))]
    return Network(nodes, [*network.elements, third], network.environment)


def test_a_torn_line_is_named_in_whatever_part_it_is(monkeypatch):
    """The time when a line is first stretched beyond 30 % is that of the whole network, the node one of that line."""
    for module in ("system", "stepping.time_domain"):
        monkeypatch.setattr(f"solvers.mooring.{module}.MAX_STRAIN", 0.3)
    system, whole = two_lines(BodyMotion.harmonic(0.02, (0.0, -500.0, 0.0, 0.0, 0.0, 0.0)))
    settings = {"dt": 0.1, "duration": 20.0, "ramp": 0.0, "throw": False}
    one, other = (solve_time_domain(system, **settings) for system in (system, whole))
    assert len(system.components) == 3 and not one.success and one.status == other.status
    assert one.event[0] == other.event[0] and {one.event[1], other.event[1]} <= set(system.layout.nodes[1].tolist())
    path = whole.path(0.1 * np.arange(201))
    states = stream_line(whole, dt=0.1, count=200, tolerance=1e-4, ramp=0.0, path=path, chunk=40)
    numbers = []
    while True:  # the same without a history
        try:
            numbers.append(next(states)[0])
        except StopIteration as end:
            assert numbers == [0, 1, 41] and end.value[:2] == (
                other.status,
                (pytest.approx(other.event[0]), other.event[1]),
            )
            return


def test_a_network_ends_with_the_part_that_fails_first(monkeypatch):
    """Between two stored steps, the parts have the stored ones before: those of the network that is not taken apart."""
    advance = _Run.advance

    def fail_after_ten_steps(run, t, record, every, path=None):
        takes_all = run.system.model.name.endswith(("element 1", "element 3"))
        return advance(run, t if takes_all else t[:11], record, every, path)

    monkeypatch.setattr(_Run, "advance", fail_after_ten_steps)
    system, whole = two_lines(BodyMotion.harmonic(0.02, (2.0, 0.0, 0.0, 0.0, 0.0, 0.0)))
    settings = {"dt": 0.1, "duration": 2.0, "tolerance": 1e-10, "every": 4, "throw": False}
    one, other = (solve_time_domain(system, **settings) for system in (system, whole))
    assert one.status is other.status is Status.STEP_FAILED and one.steps == other.steps == 10
    assert one.event[0] == other.event[0] == pytest.approx(1.0)
    assert one.time == pytest.approx([0.0, 0.4, 0.8]) and other.time == pytest.approx([0.0, 0.4, 0.8, 1.0])
    assert abs(one.r - other.r[..., :3]).max() <= PARTS * system.length


def test_parts_report_the_time_that_all_have_reached():
    """Never more than the slowest, ascending, and the whole duration in the end."""
    system, _ = two_lines(BodyMotion.harmonic(0.05, (1.0, 0.0, 0.0, 0.0, 0.0, 0.0)))
    reported = []
    solve_time_domain(system, dt=0.01, duration=10.0, progress=reported.append)
    assert reported == sorted(reported) and len(reported) > 1 and reported[-1] == pytest.approx(10.0)


def test_forces_of_parts_are_extrapolated_as_those_of_the_whole():
    """From two meshes, of each element, whichever part it is in."""
    system, whole = two_lines(BodyMotion.harmonic(0.05, (2.0, 1.0, 0.5, 0.0, 0.0, 0.0)))
    both = [solve_periodic(system, harmonics=3, deferred_correction=True) for system in (system, whole)]
    t = np.linspace(0.0, 20.0, 7)
    for e in range(3):
        one, other = (response.elements[e].fairlead_tension(t) for response in both)
        assert abs(one - other).max() <= PARTS * other.max()
        plain = np.linalg.norm(both[0].system.end_force(*rates_at(both[0], t), -1, e), axis=1)
        assert abs(one - plain).max() > 1e-6 * other.max()


def rates_at(response, t):
    """Return y, ydot and yddot of a response at times."""
    return response.at(t), response.rate_at(t), response.acceleration_at(t)


def test_points_of_a_body_without_rotation_move_alike():
    """A motion of all coupled points is that of a body which does not turn: path, tensions, force and moment."""
    amplitude = (1.0, 0.5, 0.3)
    given = Motion.harmonic(0.05, amplitude), BodyMotion.harmonic(0.05, (*amplitude, 0.0, 0.0, 0.0))
    system = [mooring_system(scene("three_bridles", None), 4, motion=motion) for motion in given]
    one, other = (solve_time_domain(system, dt=0.1, duration=5.0) for system in system)
    for name in ("tension", "body_force", "body_moment"):
        size = abs(getattr(other, name)).max()
        assert abs(getattr(one, name) - getattr(other, name)).max() <= ALIKE * size


def test_a_body_turns_about_the_origin_unless_told():
    """Stiffness and impedance of small and finite motions have the origin as their reference point by default."""
    network = replace(random_network(2).network, current=(0.0, 0.0, 0.0))
    system, origin = exact_system(network).system, (0.0, 0.0, 0.0)
    assert np.array_equal(mooring_stiffness(system), mooring_stiffness(system, origin))
    assert np.array_equal(mooring_impedance(system, 0.1), mooring_impedance(system, 0.1, origin))
    finite = [harmonic_impedance(system, 0.05, [0, 0, 0, 0, 1e-3, 0], *at, harmonics=2) for at in ((), (origin,))]
    assert np.array_equal(finite[0][:, 4], finite[1][:, 4]) and np.isnan(finite[0][:, 3]).all()


# ---------------------------------------------------------------- a manufactured bridle
BRIDLE = ManufacturedBridle()
CELLS_OF_BRIDLE = (8, 16, 32)


def bridle(cells):
    """Return the manufactured bridle with half as many cells in its legs, and its loads, as an ExactSystem."""
    return exact_system(*load_of(BRIDLE, (cells, cells // 2, cells // 2)))


def test_a_manufactured_bridle_comes_out_in_time():
    """Three lines that meet at a moving mass: the error falls with the square of cells and step together."""
    errors, duration = [], 4.0
    for cells in CELLS_OF_BRIDLE:
        pair = bridle(cells)
        mesh = moving_network.Mesh(pair.exact)
        start = [BRIDLE.node_motion(mesh, np.zeros(1), order)[0] for order in (0, 1)]
        history = solve_time_domain(pair.system, dt=duration / (20 * cells), duration=duration, tolerance=1e-9,
                                    start=(pair.coordinates(start[0]), pair.rates(start[1])), every=cells)  # fmt: skip
        exact = BRIDLE.node_motion(mesh, history.time)
        errors.append(abs(pair.in_exact_order(history.r) - exact).max())
    assert_order([1 / cells for cells in CELLS_OF_BRIDLE], errors, 2, ceiling=0.05, what="bridle in time")


def test_a_manufactured_bridle_comes_out_of_the_harmonic_balance():
    """Its periodic motion, which has two harmonics, with four of them: an error of second order in the cells."""
    errors = []
    for cells in CELLS_OF_BRIDLE:
        pair = bridle(cells)
        response = solve_periodic(pair.system, harmonics=4)
        exact = BRIDLE.node_motion(moving_network.Mesh(pair.exact), response.time)
        errors.append(abs(pair.in_exact_order(response.r) - exact).max())
    assert_order([1 / cells for cells in CELLS_OF_BRIDLE], errors, 2, ceiling=0.05, what="bridle, periodic")


# ---------------------------------------------------------------- a body that carries points
def test_points_of_a_body_have_its_motion():
    """Position, velocity and acceleration of each coupled point, by another program, in the order of the points."""
    network = random_network(4).network
    system, t = exact_system(network).system, np.linspace(0.0, 9.0, 13)
    wanted = network.motion.kinematics(network.nodes.position[[4, 5]], t)
    path = system.path(t)[:, :, [system.prescribed_nodes.tolist().index(i) for i in system.layout.points[[4, 5]]]]
    path[:, 0] += system.origin
    assert abs(path.swapaxes(0, 1) - wanted).max() <= 1e-12
    assert np.array_equal(system.coupled_nodes, system.layout.points[[4, 5]])
