"""Is a line at rest where it should be: on catenaries as cells shrink and seabeds stiffen, and at its frequencies?"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.linalg import eigh

from solvers import (
    CableProperties,
    Element,
    Environment,
    Motion,
    Network,
    Node,
    Scene,
    mooring_system,
    solve_network,
    solve_static,
)
from solvers.mooring.statics import _Statics
from solvers.numerics.modes import natural_modes

from ..cases.cables import OC3, OC3_SEABED, SHORT_CHAIN
from ..exact.cable import catenary_mp, frequencies
from ..reference import EPS
from ..tools.orders import assert_order, extrapolated
from .problems import build, compiled, matrix

CELLS = (25, 50, 100)
DIGITS = 25
CEILING = 8e-5  # on 100 cells, of the force or the length: twice the largest measured, 3.7e-5
JOINTS = 6e-6  # of joints on 240 cells, of the length: twice the largest measured, 2.6e-6
STEP = 1e-4  # m, of differences of an energy that is piecewise nearly quadratic
UNBALANCED = 1e-8  # of the tension: a rounding of a position times EA/l


# ---------------------------------------------------------------- catenaries
@cache
def catenary(case):
    """Return forces on vessel and anchor, (3,), N, and r(s) -> (3, n), m, of a case's catenary, by mpmath."""
    dx, _, dz = (b - a for a, b in zip(case.anchor, case.fairlead, strict=True))
    line = {"w": case.submerged_weight, "EA": case.EA, "L": case.length, "x": dx, "z": dz}
    line["seabed"] = case.depth is not None
    state = catenary_mp.solve(**line, digits=DIGITS)

    def r(s):
        points = [catenary_mp.profile(float(one), **line, solution=state)[:2] for one in s]
        return np.array([[case.anchor[0] + float(x), 0.0, case.anchor[2] + float(z)] for x, z in points]).T

    force = lambda H, V, sign: sign * np.array([float(H), 0.0, float(V)])
    return force(state.H, state.V, -1), force(state.H_anchor, state.V_anchor, 1), r


SAGGING = replace(OC3, name="slack line", length=1000.0)
SLACK_TOP = replace(OC3, name="between two heights", fairlead=(600.0, 0.0, 20.0))
LEANING = replace(OC3, name="turned", fairlead=(848.67 * math.cos(0.7), 848.67 * math.sin(0.7), 250.0))


@pytest.mark.parametrize("case", [OC3, SAGGING, SLACK_TOP], ids=lambda case: case.name)
@pytest.mark.parametrize("mesh", ["uniform", "fitted"])
def test_order_against_the_catenary(case, mesh):
    """Forces at both ends and positions of the nodes tend to the elastic catenary with the square of the cell."""
    fairlead, anchor, r = catenary(case)
    size, errors = np.linalg.norm(fairlead), {"fairlead": [], "anchor": [], "places": []}
    for cells in CELLS:
        system = build(case, cells, mesh=mesh, calibrate=False)
        state = solve_static(system)
        kept = slice(None, None, cells // CELLS[0])
        errors["fairlead"].append((state.fairlead_force - fairlead)[0] / size)
        errors["anchor"].append((state.anchor_force - anchor)[0] / size)
        places = state.r[:, kept] - r(system.s[kept])
        errors["places"].append(float(np.linalg.norm(places, axis=0).max()) / case.length)
        assert state.residual_norm <= UNBALANCED * size and state.tension.shape == (cells,)
    for name, table in errors.items():
        assert_order([1 / c for c in CELLS], table, 2, ceiling=CEILING, what=f"{case.name}, {mesh}, {name}")


def test_the_end_forces_carry_the_line():
    """The forces on anchor and vessel, the weight and the drag are in balance; the ends are where they are given."""
    system = build(replace(LEANING, current=(0.6, -0.3, 0.0)), 40)
    state = system.solve_static()
    weight = OC3.submerged_weight * OC3.length
    cable, d = system.model.segments[0].cable, np.diff(state.r, axis=1)
    size, current = np.linalg.norm(d, axis=0), np.array([[0.6], [-0.3], [0.0]])
    t = d / size
    u = current - (current * t).sum(axis=0) * t
    per_length = 1025.0 * cable.diameter * cable.Cdn / 2 * np.sqrt(size / np.diff(system.s))
    drag = (per_length * np.diff(system.s) * np.linalg.norm(u, axis=0) * u).sum(axis=1)
    total = -state.fairlead_force - state.anchor_force + drag - [0.0, 0.0, weight]
    assert abs(total).max() <= 1e-8 * weight and abs(drag).max() > 1e-3 * weight
    assert np.abs(state.r[:, [0, -1]].T - [OC3.anchor, LEANING.fairlead]).max() <= 4 * EPS * OC3.length
    assert state.fairlead_tension == pytest.approx(np.linalg.norm(state.fairlead_force), rel=1e-15)


@pytest.mark.parametrize("angle", [0.0, 0.7, -2.0])
def test_planar_and_spatial_rest_alike(angle):
    """Turned about the vertical, and in three axes, the line rests with the same tensions."""
    planar, turned = build(OC3, 20), build(OC3.turned(angle), 20, fields="spatial")
    assert len(planar.axes) == 2 and len(turned.axes) == 3
    one, other = planar.solve_static(), turned.solve_static()
    assert abs(one.tension - other.tension).max() <= 1e-11 * one.tension.max()
    c, s = math.cos(angle), math.sin(angle)
    assert abs(np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ one.r - other.r).max() <= 1e-11 * OC3.length


# ---------------------------------------------------------------- seabeds
@pytest.mark.parametrize("case", [OC3_SEABED, SHORT_CHAIN], ids=lambda case: case.name)
def test_a_stiffening_seabed_tends_to_the_contact_catenary(case):
    """On cells extrapolated away, the fairlead tension tends to that over a rigid seabed with the sinkage w/k."""
    fairlead, _, _ = catenary(case)
    size, errors, stiffness = np.linalg.norm(fairlead), [], [case.seabed_stiffness * f for f in (1, 4, 16)]
    for k in stiffness:
        tensions = [
            build(replace(case, seabed_stiffness=k), cells, mesh="uniform").solve_static().fairlead_tension
            for cells in (200, 400)
        ]
        errors.append(float(extrapolated((1 / 200, 1 / 400), tensions)) / size - 1)
    assert abs(errors[0]) > abs(errors[1]) > abs(errors[2]) and abs(errors[2]) < 2e-3


# ---------------------------------------------------------------- several materials, buoys and clumps
CHAIN = CableProperties(6e8, 0.08, 110.0, Cdn=1.4, Ca=1.0)
ROPE = CableProperties(2e7, 0.12, 13.0, Cdn=1.2, Ca=1.0)
BUOYANT = CableProperties(1e7, 0.15, 15.0)
WATER = Environment(depth=None)


def lines_of(materials, ends, free, environment=WATER, backward=()):
    """Return the Network of (cable, length) one after another between ends, with free nodes where they meet."""
    nodes = [Node("fixed", ends[0]), *free, Node("coupled", ends[1])]
    elements = [
        Element(
            cable.weight_in(environment), cable.EA, length, (i + 1, i) if i in backward else (i, i + 1), cable=cable
        )
        for i, (cable, length) in enumerate(materials)
    ]
    return Network(nodes, elements, environment)


ENDS = (0.0, 0.0, -150.0), (420.0, 0.0, -10.0)
NETWORKS = {
    "chain and rope": lines_of([(CHAIN, 200.0), (ROPE, 270.0)], ENDS, [Node("free", (150.0, 0.0, -140.0))]),
    "clump weight": lines_of(
        [(ROPE, 200.0), (ROPE, 270.0)], ENDS, [Node("free", (150.0, 0.0, -140.0), mass=4e3, volume=1.2)]
    ),
    "buoy": lines_of(
        [(CHAIN, 200.0), (ROPE, 290.0)], ENDS, [Node("free", (150.0, 0.0, -90.0), mass=2e3, volume=9.0)], backward=(0,)
    ),
    "pulled sideways": lines_of(
        [(CHAIN, 150.0), (ROPE, 150.0), (CHAIN, 180.0)], ENDS,
        [Node("free", (130.0, 0.0, -120.0)), Node("free", (260.0, 0.0, -80.0), force=(0.0, 2e4, 1e4))], backward=(1,),
    ),
    "over a seabed": lines_of(
        [(CHAIN, 300.0), (ROPE, 180.0)], ENDS, [Node("free", (280.0, 0.0, -100.0))],
        Environment(depth=150.0, seabed_stiffness=1e6),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", NETWORKS)
def test_lines_of_several_materials_rest_as_their_network(name):
    """Forces at the ends and places of the joints tend to those of solve_network with the square of the cell."""
    network = NETWORKS[name]
    exact = solve_network(network)
    size = np.linalg.norm(exact.reaction[-1])
    errors, tension = [], []
    cells = (60, 120, 240) if "seabed" not in name else (240, 480)
    for count in cells:
        system = mooring_system(network, count, mesh="uniform", calibrate=False)
        state = system.solve_static()
        joints = [int(abs(system.s - s).argmin()) for s in np.cumsum([element.L for element in network.elements])[:-1]]
        errors.append(np.array([state.r[:, i] - exact.r[k + 1] for k, i in enumerate(joints)]).ravel())
        tension.append(state.fairlead_tension)
        assert state.residual_norm <= UNBALANCED * state.tension.max()
    worst = abs(errors[-1]).argmax()
    table = [float(error[worst]) / sum(element.L for element in network.elements) for error in errors]
    if "seabed" in name:  # w/k deep, 1e-3 m: what is left is that of the catenary over a rigid floor
        assert abs(table[-1]) < 1e-4 and abs(tension[-1] / size - 1) < 1e-3
    else:
        assert_order([1 / c for c in cells], table, 2, ceiling=JOINTS, what=name)
        assert abs(tension[-1] / size - 1) < CEILING


# ---------------------------------------------------------------- cells calibrated on the catenaries
TANK = replace(LEANING, name="turned, in a tank", length=9.022, fairlead=tuple(x / 100 for x in LEANING.fairlead))


@pytest.mark.parametrize("case", [OC3, SAGGING, SLACK_TOP, TANK], ids=lambda case: case.name)
def test_calibrated_cells_rest_on_the_catenary(case):
    """On twenty cells that are calibrated the nodes stand on the catenary, and the end forces are its forces."""
    level = replace(case, fairlead=(math.hypot(*case.fairlead[:2]), 0.0, case.fairlead[2]))
    fairlead, anchor, r = catenary(level)
    system = build(case, 20, calibrate=True)
    state = system.solve_static()
    places, size = r(system.s), np.linalg.norm(fairlead)
    along = np.hypot(*state.r[:2])
    assert np.abs([along - places[0], state.r[2] - places[2]]).max() <= 1e-9 * case.length
    for got, wanted in ((state.fairlead_force, fairlead), (state.anchor_force, anchor)):
        assert np.abs([np.hypot(*got[:2]) - abs(wanted[0]), got[2] - wanted[2]]).max() <= 1e-9 * size


def test_lines_that_hardly_move_are_calibrated():
    """By default a line is calibrated where its motion changes the tension by less than a tenth, and not at rest."""
    small, large = (Motion.harmonic(0.05, (size, 0.0, 0.0)) for size in (0.05, 5.0))
    assert build(OC3, 20, motion=small).calibrated
    assert not build(OC3, 20, motion=large).calibrated and not build(OC3, 20).calibrated
    assert not build(OC3_SEABED, 20, motion=small).calibrated


# ---------------------------------------------------------------- far from the catenaries
LIMP = {  # weight N/m, EA N, length, anchor, fairlead, seabed stiffness N/m^2, current m/s
    "hangs limp": (22.7, 1.2e9, 152.0, (130.6, -35.5, -34.1), (13.8, -3.8, -1.9), 1.8e5, (0.0, 0.0, 0.0)),
    "lies slack": (27.8, 8.3e8, 1065.0, (864.2, 31.6, -226.9), (11.1, 0.4, -84.4), 2.2e5, (0.0, 0.0, 0.0)),
    "lies slack and heavy": (505.8, 5.2e9, 522.5, (59.5, 425.3, -139.5), (2.7, 19.3, -47.7), 1.1e4, (0.0, 0.0, 0.0)),
    "flies in a current": (5.5, 6.7e7, 270.0, (-152.6, 193.6, -126.4), (-4.0, 10.0, -22.2), 2.2e4, (-0.8, 0.97, 0.0)),
}


@pytest.mark.parametrize("name", LIMP)
def test_limp_lines_and_lines_in_strong_currents_rest(name):
    """Lines that no catenary is near to have an equilibrium: in balance at each node, and carried as a whole."""
    weight, EA, length, anchor, fairlead, stiffness, current = LIMP[name]
    cable = CableProperties(EA, 0.03, weight / 8, weight, Cdn=1.2)
    water = Environment(1025.0, depth=-anchor[2], seabed_stiffness=stiffness, current=current)
    nodes = [Node("fixed", anchor), Node("coupled", fairlead)]
    network = Network(nodes, [Element(weight, EA, length, (0, 1), cable=cable)], water)
    state = solve_static(mooring_system(network, 12, fields="spatial"))
    assert state.residual_norm <= UNBALANCED * weight * length
    line, depth = state.system.line, np.maximum(-water.depth - state.r[2], 0.0)
    carried = (state.forces[2, [0, -1]]).sum() + weight * length - line.seabed_stiffness @ depth
    assert abs(carried) <= UNBALANCED * weight * length or any(current)  # which lifts the line


def test_the_energy_falls_along_the_forces():
    """Its slope in any direction is that of the rows: of taut and of slack cells, of loads and in the seabed."""
    system, rng = build(OC3_SEABED, 12), np.random.default_rng(4)
    rows, x = _Statics(system, 1.0, np.zeros(12)), system.rest.y.T + rng.normal(size=(13, 2))
    tension, depth = rows.evaluate(x)[1], system.line.floor - x[:, -1]
    assert (tension > 0).any() and (tension <= 0).any() and (depth > 0.1).any()
    for change in rng.normal(size=(3, 13, 2)):
        slope = (rows.energy(x + STEP * change) - rows.energy(x - STEP * change)) / (2 * STEP)
        assert slope == pytest.approx(np.vdot(rows.evaluate(x)[0], change), rel=1e-6)
    assert not _Statics(build(OC3, 4), 0.5, np.ones(4)).line.seabed_stiffness.any()  # none is none at any share


# ---------------------------------------------------------------- frequencies
def modes(system):
    """Return frequencies (k,), Hz, ascending, and shapes (N, n, k) of an undamped line at rest, from its tangents."""
    state = system.solve_static()
    r = np.ascontiguousarray(state.y.T)
    still = np.zeros_like(r)
    K, M = (
        matrix(compiled, system.line, r, still, still, state.tension, w) for w in ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    )
    assert abs(K - K.T).max() <= 1e-12 * abs(K).max() and abs(M - M.T).max() <= 1e-12 * abs(M).max()
    n = len(system.axes)
    free = np.setdiff1d(np.arange(r.size), [n * i + k for i in system.prescribed_nodes for k in range(n)])
    values, vectors = eigh(K[np.ix_(free, free)], M[np.ix_(free, free)])
    shapes = np.zeros((r.size, free.size))
    shapes[free] = vectors
    return np.sqrt(values) / (2 * np.pi), shapes.reshape(*r.shape, free.size)


def taut(EA, strain, length=100.0, mass=20.0, **scene):
    """Return the Scene of a weightless line in vacuo along x, stretched."""
    cable = CableProperties(EA, 0.05, mass, 0.0, Ca=0.0)
    return Scene("taut", cable, length, (0.0, 0.0, 0.0), ((1 + strain) * length, 0.0, 0.0), Environment(rho=0.0))


@pytest.mark.parametrize("strain", [1e-3, 0.25])
def test_a_taut_line_has_the_frequencies_of_a_lumped_string_and_bar(strain):
    """All of them to rounding: T/(1 + e) and EA over unstretched cells, with half a cell's mass at either end."""
    EA, cells, length, mass = 2e6, 12, 100.0, 20.0
    frequency, shapes = modes(mooring_system(taut(EA, strain), cells, mesh="uniform", fields="spatial"))
    share = (shapes**2).sum(axis=0) / (shapes**2).sum(axis=(0, 1))  # x, y, z of each mode
    string = frequencies.lumped_string(cells - 1, EA * strain / (1 + strain), mass, length, cells)
    bar = frequencies.lumped_bar(cells - 1, EA, mass, length, cells)
    every = np.sort(np.array([*string, *string, *bar], float))
    assert frequency.shape == every.shape and abs(frequency / every - 1).max() <= 1e-10
    if strain < 0.01:  # no frequency of the bar is among those of the string
        of_bar = frequency[share[0] > 0.5]
        assert abs(of_bar / np.array(bar, float) - 1).max() <= 1e-12


def frequency_errors(build, exact, count, select=lambda frequency, shapes: frequency):
    """Return relative errors (meshes, count) of the first frequencies on 16, 32 and 64 cells, and the cells."""
    cells = (16, 32, 64)
    exact = np.array(exact, float)[:count]
    return cells, np.array([select(*modes(build(c)))[:count] / exact - 1 for c in cells])


def assert_second_order(cells, errors, what):
    """Hold each column of errors to the second order and to a per cent on the last mesh."""
    for k, column in enumerate(errors.T):
        assert_order([1 / c for c in cells], column, 2, ceiling=0.01, what=f"{what}, mode {k + 1}")


def test_a_hanging_chain():
    """Free at its lower end, nearly inextensible: zeros of J0."""
    w, m, L = 9.80665 * 20.0, 20.0, 50.0

    def build(cells):
        cable = CableProperties(1e10, 0.05, m, w)
        nodes = [Node("fixed", (0.0, 0.0, 0.0)), Node("free", (0.0, 0.0, -L))]
        return mooring_system(Network(nodes, [Element(w, 1e10, L, (1, 0), cable=cable)], Environment(rho=0.0)), cells,
                              mesh="uniform", fields="planar")  # fmt: skip

    assert_second_order(*frequency_errors(build, frequencies.hanging_chain(3, L, 9.80665), 3), "hanging chain")


@pytest.mark.parametrize("joint_mass", [0.0, 3e3])
def test_a_line_of_two_materials_and_a_mass(joint_mass):
    """Across, the string of two materials under one tension; along, the bar; a point mass at the joint counts once."""
    parts, T = [(CableProperties(2e7, 0.05, 20.0, 0.0), 60.0), (CableProperties(4e6, 0.05, 8.0, 0.0), 45.0)], 4e4
    strains = [T / cable.EA for cable, _ in parts]
    end = sum(length * (1 + e) for (_, length), e in zip(parts, strains, strict=True))
    network = lines_of(parts, ((0.0, 0.0, 0.0), (end, 0.0, 0.0)),
                       [Node("free", (60.1, 0.0, 0.0), mass=joint_mass, force=(0.0, 0.0, 9.80665 * joint_mass))],
                       Environment(rho=0.0))  # fmt: skip
    masses, lengths = [cable.mass_per_length for cable, _ in parts], [length for _, length in parts]
    string = frequencies.two_part_line(3, [T / (1 + e) for e in strains], masses, lengths, joint_mass)
    bar = frequencies.two_part_bar(2, [cable.EA for cable, _ in parts], masses, lengths, joint_mass)

    def along(frequency, shapes, wanted=True):
        share = (shapes[:, 0] ** 2).sum(axis=0) / (shapes**2).sum(axis=(0, 1))
        return frequency[(share > 0.5) == wanted]

    build = lambda cells: mooring_system(network, cells, mesh="uniform", fields="planar")
    across = lambda frequency, shapes: along(frequency, shapes, False)
    assert_second_order(*frequency_errors(build, string, 3, across), "string")
    assert_second_order(*frequency_errors(build, bar, 2, along), "bar")


@pytest.mark.parametrize("lambda2", [0.5, 30.0, 400.0])
def test_a_sagging_line(lambda2):
    """In and out of the plane, with added mass: those of the continuous line by polynomials of degree 80."""
    EA, m, w0, L, span, _ = frequencies.irvine_line(lambda2, 0.05)
    d, rho = 0.05, 1000.0
    ma = rho * math.pi * d**2 / 4
    exact = frequencies.frequencies(EA, m, ma, w0, L, span)
    cable = CableProperties(EA, d, m, w0, Ca=1.0)
    given = Scene("sagging", cable, L, (0.0, 0.0, 0.0), (span[0], 0.0, span[1]), Environment(rho=rho))
    build = lambda cells: mooring_system(given, cells, mesh="uniform", fields="spatial", calibrate=False)

    def out_of_plane(frequency, shapes, wanted=True):
        share = (shapes[:, 1] ** 2).sum(axis=0) / (shapes**2).sum(axis=(0, 1))
        return frequency[(share > 0.5) == wanted]

    in_plane = lambda frequency, shapes: out_of_plane(frequency, shapes, False)
    assert_second_order(*frequency_errors(build, exact.in_plane, 3, in_plane), "in plane")
    assert_second_order(*frequency_errors(build, exact.out_of_plane, 3, out_of_plane), "out of plane")


def test_natural_modes_are_those_of_the_tangents():
    """The solver of natural modes, which takes the damping too, has the same frequencies where there is none.

    Also those near a frequency that is given, about which it searches then.
    """
    system = mooring_system(taut(2e6, 1e-3), 16, mesh="uniform", fields="planar")
    frequency, _ = modes(system)
    got = natural_modes(system, 5)
    assert abs(got.frequencies / frequency[:5] - 1).max() <= 1e-9
    for k in (2, 4):
        near = natural_modes(system, 1, near=1.001 * float(frequency[k])).frequencies
        assert abs(near / frequency[k] - 1).max() <= 1e-9


def test_natural_modes_are_damped():
    """With damping in its cells, frequency and damping are those of the dense problem of K, C and M."""
    system = build(replace(OC3, damping=0.3), 12, fields="planar")
    r = np.ascontiguousarray(system.rest.y.T)
    still, inner = np.zeros_like(r), slice(2, -2)
    K, C, M = (
        matrix(compiled, system.line, r, still, still, system.rest.tension, tuple(w))[inner, inner] for w in np.eye(3)
    )
    M_C, M_K = np.linalg.solve(M, C), np.linalg.solve(M, K)
    values = np.linalg.eigvals(np.block([[np.zeros_like(K), np.eye(len(K))], [-M_K, -M_C]]))
    values = values[values.imag > 0]
    values = values[abs(values).argsort()][:6]
    got = natural_modes(system, 6)
    assert abs(got.frequencies / (abs(values) / (2 * np.pi)) - 1).max() <= 1e-9
    assert abs(got.damping - (-values.real / abs(values))).max() <= 1e-9 and got.damping.max() > 1e-3
