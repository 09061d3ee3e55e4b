"""Is the truth for moving networks true? Other formulas, another integrator, closed forms, energy, planted faults.

No solver takes part: what these modules say of a solver is worth what is checked here.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from mpmath import mp
from scipy.integrate import solve_ivp

from ..exact.cable import frequencies
from ..exact.extrapolation import _Extrapolation, integrate
from ..exact.mooring import lumped_node, manufactured_bridle, moving_network
from ..exact.mooring.elastic_bounce import ElasticBounce, SeabedBounce
from ..exact.mooring.manufactured_bridle import ManufacturedBridle, load_of
from ..exact.mooring.moving_network import Forces, Lines, Mesh, Network, Nodes, Seabed, simulate, solve_equilibrium
from ..exact.mooring.random_networks import FEATURES, SEEDS, random_history, random_network
from ..exact.network.joint_modes import (
    Arm,
    PointOnLines,
    buoy_heave,
    buoy_swing,
    joint_frequencies,
    star_frequencies,
    tethered_buoy,
)
from ..exact.network.linear_network import linearise
from ..exact.network.network_symmetry import (
    circling,
    reflect,
    renumber,
    ring,
    ring_error,
    rotate,
    shift_error,
    spread_error,
)
from ..exact.rigid_motion import RigidMotion
from ..reference import moving_network_tensions

ROUNDING = 1e-12  # of the largest value: some thousand roundings of sums of tens of terms; measured below 1e-13
INTEGRATED = 1e-10  # of the largest value: what the module promises; measured 1e-12 to 2e-11
EXPLICIT_RUNGE_KUTTA = 1e-9  # of the largest value: DOP853 at its own tolerance of 1e-12 steps over kinks
ALL_DEGREES = RigidMotion(
    (1.0, 2.0, 3.0), 0.9, (0.5, 0.4, 0.3, 0.2, 0.3, 0.4), (0.0, 1.0, 2.0, 0.5, 1.5, 2.5), (0.1,) * 6
)


# ---------------------------------------------------------------- rigid motion
def test_a_body_moves_its_points_rigidly():
    """Distances stay, and velocities and accelerations are the derivatives of positions and velocities."""
    points, h, t = np.array([(4.0, 0.0, -2.0), (-1.0, 5.0, 0.0), (0.0, 0.0, 9.0)]), 1e-4, np.array([0.3, 2.0, 7.7])
    r, v, a = ALL_DEGREES.kinematics(points, t)
    later, earlier = (ALL_DEGREES.kinematics(points, t + step) for step in (h, -h))
    assert np.linalg.norm(r[:, 0] - r[:, 1], axis=-1) == pytest.approx(np.linalg.norm(points[0] - points[1]), rel=1e-14)
    for order, exact in ((0, v), (1, a)):
        differences = (later[order] - earlier[order]) / (2 * h)
        assert np.abs(differences - exact).max() < 1e-7  # h^2 / 6 of a third derivative of some 5 m/s^3: 1e-8


def test_order_of_the_rotations():
    """Rz(yaw) Ry(pitch) Rx(roll): an arm along x first pitches down, then yaws."""
    mean = (0.0, 0.0, 0.0, np.pi / 2, np.pi / 2, np.pi / 2)
    r = RigidMotion(mean=mean).kinematics([(1.0, 0.0, 0.0), (0.0, 1.0, 0.0)], np.zeros(1))[0, 0]
    assert r == pytest.approx(np.array([(0.0, 0.0, -1.0), (0.0, 1.0, 0.0)]), abs=1e-15)


# ---------------------------------------------------------------- forces
def tangled(seed=0):
    """Return a network with every term switched on, and random positions, velocities, accelerations."""
    case, rng = random_network(3), np.random.default_rng(seed)
    network = replace(case.network, current=(0.7, -0.4, 0.2))
    r = case.position + rng.normal(0, 0.3, case.position.shape)
    return network, r, rng.normal(0, 1.0, r.shape), rng.normal(0, 2.0, r.shape)


def node_error(network, r, v, a):
    """Return how far `Forces` are from the equations of `lumped_node`, of the largest force, at inner nodes."""
    mesh, lines, bed = Mesh(network), network.lines, network.seabed
    forces = Forces(mesh, r, v)
    residual = forces.total - np.einsum("nij,nj->ni", forces.mass, a)
    floor = lumped_node.Seabed(bed.depth, bed.stiffness, bed.damping, bed.friction, bed.friction_speed)
    worst = 0.0
    for line, chain in enumerate(mesh.chains):
        values = {name: float(getattr(lines, name)[line]) for name in Lines.PER_LINE}
        values["length"] /= int(lines.cells[line])
        cell = lumped_node.Cell(rho=network.rho, **values)
        for i in range(1, len(chain) - 1):
            three = chain[i - 1 : i + 2]
            exact = lumped_node.force_residual(
                (cell, cell), r[three], v[three], a[chain[i]], current=network.current, seabed=floor
            )
            worst = max(worst, np.abs(np.array(exact, float) - residual[chain[i]]).max())
    return worst / np.abs(residual).max()


@pytest.mark.parametrize("seed", range(3))
def test_forces_on_inner_nodes(seed):
    """Those of the equations written node by node in mpmath, with contact, current, damping and friction."""
    assert node_error(*tangled(seed)) < ROUNDING


@pytest.mark.parametrize("name", ["EA", "beta", "mass", "added_mass", "weight", "d", "Cdn", "Cdt"])
def test_a_wrong_coefficient_is_found_in_planted_forces(name, monkeypatch):
    """A millionth too much of any coefficient is seen."""
    network, r, v, a = tangled()
    per_cell = Mesh.per_cell
    wrong = lambda mesh, key: per_cell(mesh, key) * (1 + 1e-6 * (key == name))
    monkeypatch.setattr(Mesh, "per_cell", wrong)
    assert node_error(network, r, v, a) > 10 * ROUNDING


def test_loads_of_a_point():
    """A free node far from any line: weight, buoyancy, force, drag and added mass by hand."""
    nodes = Nodes(
        [(0, 0, 0), (0, 0, -10), (5.0, 0, 0)],
        ("fixed", "free", "free"),
        [0, 1.0, 200.0],
        [0, 0, 0.5],
        0.5,
        0.3,
        [(7, 8, 9)] * 3,
    )
    network = Network(nodes, Lines([(0, 1)], 12.0, 1, 1e3), current=(1.0, 0, 0), rho=1000.0, g=10.0)
    mesh = Mesh(network)
    v = np.array([(0, 0, 0), (0, 0, 0), (4.0, 4.0, 0)], float)
    forces = Forces(mesh, mesh.straight(), v)
    assert forces.total[2] == pytest.approx([7 - 150 * 5 * 3, 8 - 150 * 5 * 4, 9 + 3000])
    assert forces.mass[2] == pytest.approx(450.0 * np.eye(3))


# ---------------------------------------------------------------- the integrator
def turning(t, y, branches):
    """Return y' of an oscillation with 5 rad/s, a batch."""
    return 5.0 * np.stack([y[:, 1], -y[:, 0]], axis=1)


@pytest.mark.parametrize("tolerance", [1e-6, 1e-9, 1e-12])
def test_an_oscillation_keeps_its_tolerance(tolerance):
    """After sixteen turns the error is below that of as many radians; a first step of fifty radians is refused."""
    times = np.array([0.0, 160.0, 165.0]) / 8
    y = integrate(turning, times, [1.0, 0.0], rtol=tolerance, atol=tolerance)
    exact = np.stack([np.cos(5 * times), -np.sin(5 * times)], axis=1)
    assert 1e-16 < np.abs(y - exact).max() < 100 * tolerance


def test_order_of_one_step():
    """With K columns the error of a step is of order 2 K + 1 and its estimate of order 2 K - 1."""
    method = _Extrapolation(turning, None, 0.0, 2 * np.arange(1, 4), 1.0)
    errors = []
    for H in (0.2, 0.1, 0.05):
        y, estimate = method.step(0.0, np.array([1.0, 0.0]), H, None)
        exact = np.array([np.cos(5 * H), -np.sin(5 * H)])
        errors.append((np.linalg.norm(y - exact), np.linalg.norm(estimate)))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders[-1] == pytest.approx([7.0, 5.0], abs=0.2)


def test_a_jump_is_met():
    """y' = 2 below one and 1 above: the time of the jump is that of the closed form, not one of a step."""
    slope = lambda t, y, branches: np.where(branches, 1.0, 2.0) + 0 * y
    y = integrate(slope, [0.0, 0.3, 0.9, 1.7], [0.0], switches=lambda t, y: y - 1.0)[:, 0]
    assert y == pytest.approx([0.0, 0.6, 1.4, 2.2], abs=1e-12)


def test_steps_too_many_or_too_short_are_refused():
    """A limit of steps, and a right side of noise that no step can follow."""
    with pytest.raises(ArithmeticError, match="after 6 steps"):
        integrate(turning, [0.0, 100.0], [1.0, 0.0], most_steps=5)
    rng = np.random.default_rng(1)
    with pytest.raises(ArithmeticError, match=r"step \S+e-1[3-9]"):
        integrate(lambda t, y, branches: rng.normal(size=y.shape), [0.0, 1.0], [0.0], atol=1e-15, rtol=0.0)


def scipy_history(case, times):
    """Return positions of the mesh's nodes by scipy's DOP853, (nt, size, 3)."""
    mesh = Mesh(case.network)
    equations = moving_network._Equations(mesh)
    start = np.concatenate([case.position[mesh.free].ravel(), case.velocity[mesh.free].ravel(), np.zeros(6)])
    f = lambda t, y: equations.rates(np.array([t]), y[None], None)[0]
    states = solve_ivp(f, (times[0], times[-1]), start, "DOP853", times, rtol=1e-12, atol=1e-12).y.T
    return np.moveaxis(equations.kinematics(times, states)[0], 0, 1)


@pytest.mark.parametrize("seed", [0, 6])
def test_another_integrator(seed):
    """An explicit Runge-Kutta method of order 8 gives the same motion."""
    case, times = random_network(seed), np.linspace(0, 2, 5)
    history = simulate(case.network, times, case.position, case.velocity)
    moved = np.abs(history.position - case.position).max()
    assert np.abs(history.position - scipy_history(case, times)).max() < EXPLICIT_RUNGE_KUTTA * moved


@pytest.mark.parametrize("beta", [0.0, 0.05])
def test_a_mass_that_snaps(beta):
    """A mass on one cell that goes slack and taut again: the closed form, piece by piece."""
    bounce = ElasticBounce(100.0, 981.0, 5.0, 2e4, -5.4, 4.0, beta)
    nodes = Nodes([(0, 0, 0), (0, 0, -5.4)], ("fixed", "free"), mass=[0, 100.0])
    times = np.linspace(0, 4, 41)
    start = np.zeros((2, 3)), np.array([(0, 0, 0), (0, 0, 4.0)])
    start[0][1, 2] = -5.4
    history = simulate(Network(nodes, Lines([(0, 1)], 5.0, 1, 2e4, beta)), times, *start)
    z, speed, tension = bounce.motion(times)
    assert len(bounce.events(4.0)) >= 2
    assert np.abs(history.position[:, 1, 2] - z).max() < INTEGRATED * 5
    assert np.abs(history.tension[:, 0] - tension).max() < INTEGRATED * tension.max()
    assert np.abs(history.velocity[:, 1, 2] - speed).max() < INTEGRATED * np.abs(speed).max()


@pytest.mark.parametrize("damping", [0.0, 12.0])
def test_a_mass_that_bounces_on_the_seabed(damping):
    """A mass with half of a slack line of 100 m on the seabed: the closed form, which is never pulled back."""
    bounce = SeabedBounce(300.0, 300 * 9.81, 20.0, 50 * 800.0, -19.0, 0.0, 50 * damping)
    position = np.array([(0, 0, 0), (0, 0, -19.0)])
    nodes = Nodes(position, ("fixed", "free"), mass=[0, 300.0])
    bed = Seabed(20.0, 800.0, damping)
    times = np.linspace(0, 4, 41)
    history = simulate(Network(nodes, Lines([(0, 1)], 100.0, 1, 1e4), seabed=bed), times, position)
    z, speed, _ = bounce.motion(times)
    assert len(bounce.events(4.0)) >= 3
    assert np.abs(history.position[:, 1, 2] - z).max() < INTEGRATED * 20
    assert np.abs(history.velocity[:, 1, 2] - speed).max() < INTEGRATED * np.abs(speed).max()
    lost = (
        bounce.seabed_work(times) - history.energy["seabed"]
    )  # what a compressed spring keeps at lift-off is lost too
    assert np.abs(history.work["seabed damping"] - lost).max() < INTEGRATED * 300 * 9.81


def test_a_slack_cell_left_in_its_branch_is_seen(monkeypatch):
    """Planted: no events. The pieces of the closed form are missed."""
    monkeypatch.setattr(moving_network._Equations, "switches", lambda self, t, y: np.ones((len(t), 8)))
    with pytest.raises(AssertionError):
        test_a_mass_that_snaps(0.05)


def energy_error(history):
    """Return the largest lack in the energy balance over the largest work or energy that was exchanged."""
    exchanged = [np.ptp(values) for values in (*history.energy.values(), *history.work.values())]
    return np.abs(history.energy_error).max() / max(exchanged)


@pytest.mark.parametrize("seed", range(5))
def test_energy_balance(seed):
    """Whatever holders bring is stored or lost: drag, damping, friction and the turning added mass included."""
    assert energy_error(random_history(seed, duration=2.0, samples=6)) < INTEGRATED


@pytest.mark.parametrize("name", ["holders", "drag", "damping", "seabed damping", "friction", "turning"])
def test_a_work_left_out_is_seen(name):
    """Planted: the balance without one of its works does not close."""
    case = random_network(3)
    lines = replace(case.network.lines, beta=np.full(3, 0.1))
    seabed = replace(case.network.seabed, damping=60.0)
    network = replace(case.network, lines=lines, seabed=seabed)
    history = simulate(network, np.linspace(0, 1, 3), case.position, case.velocity)
    assert energy_error(history) < INTEGRATED
    assert energy_error(replace(history, work=history.work | {name: 0.0 * history.t})) > 10 * INTEGRATED


def test_forces_on_holders_balance_the_whole():
    """What holders bear is all outer forces less the change of momentum, and moments are those of arms."""
    history = random_history(2, duration=1.0, samples=3)
    mesh, t = history.mesh, history.t
    forces = Forces(mesh, np.moveaxis(history.position, 1, 0), np.moveaxis(history.velocity, 1, 0))
    outer = (forces.total - forces.pull).sum(axis=0)
    momentum = np.einsum("n...ij,n...j->...i", forces.mass, np.moveaxis(history.acceleration, 1, 0))
    scale = np.abs(history.holder_force).max()
    assert np.abs(history.holder_force.sum(axis=1) - (outer - momentum)).max() < ROUNDING * scale
    arms = history.position[:, mesh.coupled] - mesh.network.motion.reference_point(t)[:, None]
    moment = sum(np.cross(arms[:, i], history.holder_force[:, n]) for i, n in enumerate(mesh.coupled))
    assert history.body_moment == pytest.approx(moment, rel=1e-13)
    assert history.body_force == pytest.approx(history.holder_force[:, mesh.coupled].sum(axis=1), rel=1e-13)


def test_the_power_of_the_body():
    """Its integral over time is the work of the holders: Simpson's rule on fine samples, whose order it shows."""
    case, errors = random_network(2), []
    for samples in (21, 41):
        times = np.linspace(0.0, 1.0, samples)
        history = simulate(case.network, times, case.position, case.velocity)
        weights = np.ones(samples)
        weights[1:-1:2], weights[2:-1:2] = 4.0, 2.0
        integral = weights @ history.body_power / (3 * (samples - 1))
        errors.append(abs(integral / history.work["holders"][-1] - 1))
    assert errors[1] < 1e-4 and errors[1] < errors[0] / 8


@pytest.mark.parametrize("seed", [2, 3])
def test_forces_of_lines_at_their_ends(seed):
    """They add up to the force on each holder, and at a joint to what its own mass, weight and drag need."""
    history = random_history(seed, duration=1.0, samples=3)
    mesh, network = history.mesh, history.mesh.network
    total, scale = np.zeros((len(history.t), mesh.size, 3)), np.abs(history.end_force).max()
    for line, (a, b) in enumerate(network.lines.ends):
        total[:, a] += history.end_force[:, line, 0]
        total[:, b] += history.end_force[:, line, 1]
    assert np.abs((total - history.holder_force)[:, mesh.held]).max() < ROUNDING * scale
    nodes = network.nodes
    joint = nodes.kind.index("free")
    u = history.velocity[:, joint] - np.array(network.current)
    own = nodes.force[joint] - network.rho * nodes.CdA[joint] / 2 * np.linalg.norm(u, axis=1)[:, None] * u
    own[:, 2] -= (nodes.mass[joint] - network.rho * nodes.volume[joint]) * network.g
    mass = nodes.mass[joint] + nodes.Ca[joint] * network.rho * nodes.volume[joint]
    assert np.abs(total[:, joint] + own - mass * history.acceleration[:, joint]).max() < 10 * ROUNDING * scale


# ---------------------------------------------------------------- closed forms
CLUMP = PointOnLines(
    ((-10.0, 0, 0), (12.0, 0, 3.0)),
    (9.0, 10.0),
    (2e4, 3e4),
    300.0,
    1500.0,
    50.0,
    (0.02, 0.05),
    (8.0, 9.0),
    (3.0, 2.0),
    (40.0, 50.0),
)


def clump_network(motion=None):
    """Return the network of `CLUMP`: its weight in water by a displaced volume, its added mass by Ca."""
    volume = (300 * 9.81 - 1500) / (1025 * 9.81)
    nodes = Nodes(
        [(-10, 0, 0), (12, 0, 3), (0, 0, -4)],
        ("fixed", "coupled", "free"),
        [0, 0, 300],
        [0, 0, volume],
        50 / (1025 * volume),
    )
    lines = Lines(
        [(0, 2), (1, 2)], CLUMP.length, 1, CLUMP.EA, CLUMP.beta, CLUMP.line_mass, CLUMP.line_added, CLUMP.line_weight
    )
    return Network(nodes, lines, motion or RigidMotion())


def test_a_clump_weight_on_two_lines():
    """Equilibrium, tensions, three frequencies and forced response of the closed form are those of the network."""
    network = clump_network()
    rest, exact = solve_equilibrium(network), CLUMP.equilibrium((0, 0, -4))
    assert np.array(exact.T.tolist()[0], float) == pytest.approx(rest[2], abs=1e-11)
    linear = linearise(network, rest)
    assert np.array(CLUMP.frequencies(exact), float) == pytest.approx(linear.frequencies()[0], rel=1e-9)
    plane, across = CLUMP.plane_frequencies(exact)
    assert sorted(map(float, (*plane, across))) == pytest.approx(linear.frequencies()[0], rel=1e-9)
    motion = (0.01, 0.02, 0.03)
    x, tension, _ = linear.response(1.9, [(0, 0, 0), motion])
    exact_x, exact_tension = CLUMP.response(exact, 1.9, 1, motion)
    assert np.abs(np.array(exact_x.T.tolist()[0], complex) - x[2]).max() < 1e-9 * np.abs(x).max()
    assert np.abs(np.array(exact_tension, complex) - tension).max() < 1e-9 * np.abs(tension).max()


def test_a_small_swing_in_the_time_domain():
    """A clump put by a small step along a mode is back after its period, but for the square of the step."""
    network = replace(clump_network(), lines=replace(clump_network().lines, beta=np.zeros(2)))
    rest = solve_equilibrium(network)
    frequencies_, shapes = linearise(network, rest).frequencies()
    errors = []
    for step in (1e-3, 1e-4):
        start = rest + step * shapes[0] / np.abs(shapes[0]).max()
        history = simulate(network, [0.0, 0.5 / frequencies_[0], 1 / frequencies_[0]], start)
        errors.append(np.abs(history.position[-1] - start).max() / step)
        assert np.abs(history.position[1] - (2 * rest - start)).max() < 0.1 * step
    assert errors[1] < errors[0] / 8 and errors[1] < 1e-4


def test_the_network_under_a_small_harmonic_motion():
    """Started on the linear response it stays there for a period, but for the square of the amplitude."""
    size = 1e-4
    motion = RigidMotion((12, 0, 3), 1.9, (size, size / 2, -size, 0, 0, 0), (0.0, 0.7, 0.2, 0, 0, 0))
    network = clump_network(motion)
    rest = solve_equilibrium(clump_network())
    linear = linearise(network, rest)
    x, tension, holder = linear.response(1.9, linear.held_by_body(motion.amplitude, motion.phase))
    times = np.linspace(0, 2 * np.pi / 1.9, 9)
    history = simulate(network, times, rest + x.real, (1j * 1.9 * x).real)
    wave = np.exp(1j * 1.9 * times)
    static = Forces(history.mesh, rest, 0 * rest)
    assert np.abs(history.position - rest - (wave[:, None, None] * x).real).max() < 1e-2 * size
    exact = static.tension + np.outer(wave, tension).real
    assert np.abs(history.tension - exact).max() < 1e-2 * np.abs(tension).max()
    force = static.total[history.mesh.held] + (wave[:, None, None] * holder[history.mesh.held]).real
    assert np.abs(history.holder_force[:, history.mesh.held] - force).max() < 1e-2 * np.abs(holder).max()


def test_a_buoy_on_a_tether():
    """Swing and heave without a tether's mass, and the tether's Bessel functions tend to the former."""
    nodes = Nodes([(0, 0, -30), (0, 0, -9)], ("fixed", "free"), [0, 400], [0, 1.0], 0.5)
    network = Network(nodes, Lines([(0, 1)], 20.0, 1, 2e5))
    rest = solve_equilibrium(network)
    B, M = (1025 - 400) * 9.81, 400 + 512.5
    swing, _, heave = linearise(network, rest).frequencies()[0]
    assert (swing, heave) == pytest.approx(
        (float(buoy_swing(B, M, 20.0, 2e5)), float(buoy_heave(M, 20.0, 2e5))), rel=1e-9
    )
    thin = tethered_buoy(1, B, M, 1e-6, 1e-6, 20.0)[0]
    assert float(thin) == pytest.approx(float(buoy_swing(B, M, 20.0)), rel=1e-7)  # by a third of the mass over M: 1e-8


def test_a_heavy_tether_tends_to_its_bessel_functions():
    """The lumped tether's first two swing frequencies, of order 2 in the cells; stretch, 6e-6, is far below."""
    B, M, w, m, l = (1025 - 400) * 9.81, 912.5, 60.0, 30.0, 20.0
    exact = np.array(tethered_buoy(2, B, M, w, m, l), float)
    errors = []
    for cells in (8, 16):
        nodes = Nodes([(0, 0, -30), (0, 0, -9.9)], ("fixed", "free"), [0, 400], [0, 1.0], 0.5)
        network = Network(nodes, Lines([(0, 1)], l, cells, 1e9, 0.0, m - 10, 10.0, w))
        linear = linearise(network, solve_equilibrium(network, tolerance=1e-8))
        errors.append(np.abs(linear.frequencies()[0][[0, 2]] / exact - 1))
    assert np.all(np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.1))
    assert errors[1].max() < 2e-3


STAR = {"arms": 3, "tension": 5e3, "EA": 4e5, "mass": 10.0, "added_mass": 4.0, "length": 20.0, "joint_mass": 201.25}


def star_network(cells):
    """Return the network of `STAR`, without gravity."""
    angle, radius = 2 * np.pi * np.arange(3) / 3, 20 * (1 + 5e3 / 4e5)
    around = radius * np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    nodes = Nodes([*around, (0, 0, 0)], ("fixed",) * 3 + ("free",), [0, 0, 0, 150], [0, 0, 0, 0.1], 0.5)
    return Network(nodes, Lines([(0, 3), (1, 3), (2, 3)], 20.0, cells, 4e5, 0.0, 10.0, 4.0), g=0.0)


def test_all_frequencies_of_a_lumped_star():
    """Three equal strings at a joint, in five cells each: every frequency, as often as it occurs."""
    cells = 5
    network = star_network(cells)
    computed = linearise(network, Mesh(network).straight()).frequencies()[0]
    closed = star_frequencies(cells - 1, cells=cells, **STAR)
    for kind, copies in zip(closed, (2, 1, 1, 1, 2), strict=True):
        for value in closed[kind]:
            nearest = np.sort(np.abs(computed / float(value) - 1))
            assert nearest[copies - 1] < 1e-11, (kind, value)
    assert len(closed) == 5


def test_a_star_tends_to_its_strings():
    """The lumped star's closed form tends to that of continuous arms with the square of the cells."""
    continuous = star_frequencies(3, **STAR)
    for kind, exact in continuous.items():
        errors = [
            abs(np.array(star_frequencies(3, cells=n, **STAR)[kind], float) / np.array(exact, float) - 1)
            for n in (20, 40)
        ]
        assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.02), kind


def test_two_materials_in_line():
    """Arms at a joint are the string and bar of two parts; cells of either tend to them, and to the network's."""
    arms = [Arm(5e3, 10, 20), Arm(5e3, 30, 11)]
    with mp.workdps(30):
        other = frequencies.two_part_string(4, 5e3, (10, 30), (20, 11), 40)
        for a, b in zip(joint_frequencies(4, arms, 40), other, strict=True):
            assert abs(a / b - 1) < 1e-25
    EA, T, l, cells = (3e5, 8e5), 4e3, (18.0, 11.0), (4, 3)
    stretched = [l[i] * (1 + T / EA[i]) for i in (0, 1)]
    nodes = Nodes([(0, 0, 0), (sum(stretched), 0, 0), (stretched[0], 0, 0)], ("fixed", "fixed", "free"), [0, 0, 40.0])
    network = Network(nodes, Lines([(0, 2), (2, 1)], l, cells, EA, 0.0, (12, 30), (5, 2)), g=0.0)
    computed = linearise(network, Mesh(network).straight()).frequencies()[0]
    string = [Arm(T / (1 + T / EA[i]), (17, 32)[i], l[i], cells[i]) for i in (0, 1)]
    bar = [Arm(EA[i], (12, 30)[i], l[i], cells[i]) for i in (0, 1)]
    for arms in (string, bar):
        for value in joint_frequencies(4, arms, 40):
            assert np.abs(computed / float(value) - 1).min() < 1e-11


# ---------------------------------------------------------------- symmetry
@pytest.fixture(scope="module")
def crossing():
    """A random network with five lines and its history over half a second."""
    return random_network(9), random_history(9, duration=0.5, samples=3)


def assert_follows(change, case, history):
    """The changed network's history, mapped back, is the history."""
    start = change.positions_forth(case.position), change.vectors_forth(case.velocity)
    other = simulate(change.network, history.t, *start)
    scale = history.end_tension.max()
    assert np.abs(change.positions_back(other.position) - history.position).max() < INTEGRATED * 10
    assert np.abs(change.vectors_back(other.holder_force) - history.holder_force).max() < INTEGRATED * scale
    assert np.abs(change.cells_back(other.tension) - history.tension).max() < INTEGRATED * scale
    assert np.abs(change.ends_back(other.end_tension) - history.end_tension).max() < INTEGRATED * scale
    moment = np.abs(history.body_moment).max()
    assert np.abs(change.moments_back(other.body_moment) - history.body_moment).max() < INTEGRATED * moment


CHANGES = {
    "half turn": lambda network: rotate(network, np.pi, (3.0, -2.0)),
    "reflected": lambda network: reflect(network, (1.0, 2.0)),
    "renumbered": lambda network: renumber(network, [3, 5, 0, 1, 4, 2], [4, 2, 0, 3, 1]),
    "ends swapped": lambda network: renumber(network, swapped=[True, False, True, True, False]),
    "renumbered and swapped": lambda network: renumber(network, [1, 2, 0, 4, 5, 3], [1, 2, 3, 4, 0], [1, 1, 0, 0, 1]),
}


@pytest.mark.parametrize("name", CHANGES)
def test_a_changed_network_moves_alike(name, crossing):
    """Turned by half a turn, in a mirror, in another order: the same motion, forces and moments, mapped back."""
    case, history = crossing
    assert_follows(CHANGES[name](case.network), case, history)


def test_any_angle_without_roll_and_pitch(crossing):
    """With surge, sway, heave and yaw alone a network may turn by any angle, current included."""
    case, _ = crossing
    motion = replace(case.network.motion, amplitude=(0.5, 0.3, 0.4, 0.0, 0.0, 0.05))
    network = replace(case.network, motion=motion, current=(0.4, -0.2, 0.1))
    case = replace(case, network=network)
    history = simulate(network, [0.0, 0.4], case.position, case.velocity)
    assert_follows(rotate(network, 0.7, (2.0, 1.0)), case, history)


def test_a_quarter_turn_with_pitch(crossing):
    """A pitching body turned by a quarter rolls."""
    case, _ = crossing
    motion = replace(case.network.motion, amplitude=(0.5, 0.3, 0.4, 0.0, 0.05, 0.05))
    case = replace(case, network=replace(case.network, motion=motion))
    history = simulate(case.network, [0.0, 0.4], case.position, case.velocity)
    assert_follows(rotate(case.network, np.pi / 2), case, history)


def test_an_angle_that_cannot_be_is_refused(crossing):
    """Roll and pitch at once allow half turns only."""
    with pytest.raises(ValueError, match="multiples"):
        rotate(crossing[0].network, 0.3)


def test_a_wrong_way_back_is_seen(crossing):
    """Planted: the order of cells is not turned round where ends are swapped."""
    case, history = crossing
    change = CHANGES["ends swapped"](case.network)
    with pytest.raises(AssertionError):
        assert_follows(replace(change, cell=np.arange(len(change.cell))), case, history)


LINE = {"EA": 3e4, "beta": 0.05, "mass": 20.0, "added_mass": 8.0, "weight": 110.0, "d": 0.2, "Cdn": 2.0, "Cdt": 0.0}


def test_lines_in_a_ring_follow_one_another():
    """Under a body that goes in a circle line i of three has the tension of line 0, a third of a period later each."""
    omega = 1.1
    build = lambda motion: ring(
        3, radius=32.0, depth=24.0, fairlead_radius=4.0, length=36.0, cells=3, motion=motion, line=LINE
    )
    network = build(circling(0.5, omega))
    period, per_period, periods = 2 * np.pi / omega, 6, 10
    times = np.linspace(0, periods * period, periods * per_period + 1)
    rest = solve_equilibrium(network)
    assert ring_error(build(None), solve_equilibrium(build(None))) < 1e-9
    history = simulate(network, times, rest)
    last = history.end_tension[-per_period:, :, 1].T
    assert shift_error(last) < 2e-4  # what is left of the start after ten periods; it falls by the damping of each
    assert spread_error(last) > 0.02 and shift_error(last[::-1]) > 0.02


def test_lines_in_a_ring_under_heave_are_equal():
    """To round-off, at any time, whatever the start."""
    motion = RigidMotion(omega=1.1, amplitude=(0, 0, 0.6, 0, 0, 0))
    network = ring(4, radius=32.0, depth=24.0, fairlead_radius=4.0, length=36.0, cells=3, motion=motion, line=LINE)
    rest = solve_equilibrium(network)
    history = simulate(network, np.linspace(0, 2, 5), rest)
    assert spread_error(history.end_tension[:, :, 1].T) < INTEGRATED
    assert np.abs(history.body_moment).max() < INTEGRATED * 32 * history.end_tension.max()


# ---------------------------------------------------------------- the manufactured bridle
BRIDLE = ManufacturedBridle()


def test_loads_of_the_bridle():
    """Complex steps give the slope of the tension that central differences give; every line stays taut in a current."""
    t, h = np.linspace(0, 9, 7), 1e-3
    for line in range(3):
        s = np.linspace(0.1, 0.9, 9) * BRIDLE.lengths[line]
        force = lambda x, line=line: BRIDLE.tension_vector(line, x, t)
        differences = (8 * (force(s + h) - force(s - h)) - force(s + 2 * h) + force(s - 2 * h)) / (12 * h)
        slope = BRIDLE.tension_slope(line, s, t)
        assert (
            np.abs(slope - differences).max() < 1e-7 * np.abs(slope).max()
        )  # rounding of T over h and the slope: 1e-8
        assert BRIDLE.tension(line, s, t).min() > 100.0
        v = BRIDLE.derivative(line, s, t, 0, 1)
        later = BRIDLE.derivative(line, s, t + h, 0, 0) - BRIDLE.derivative(line, s, t - h, 0, 0)
        assert np.abs(later / (2 * h) - v).max() < 1e-5 * np.abs(v).max()  # h^2 / 6 omega^2
    ends = [BRIDLE.derivative(line, BRIDLE.lengths[line : line + 1], t, 0, 0)[:, 0] for line in range(3)]
    assert np.abs(ends[0] - BRIDLE.derivative(1, np.zeros(1), t, 0, 0)[:, 0]).max() < 1e-13
    assert np.abs(ends[0] - BRIDLE.derivative(2, np.zeros(1), t, 0, 0)[:, 0]).max() < 1e-13
    assert np.abs(ends[1] - BRIDLE.motion.kinematics(manufactured_bridle.PLACES[2:3], t)[0][:, 0]).max() < 1e-13


def residuals(bridle, cells):
    """Return what the nodes' equations lack at the exact motion: N/m at inner nodes, N at the joint, largest."""
    network, load = load_of(bridle, cells)
    mesh, t = Mesh(network), np.linspace(0, 8, 5)
    r, v, a = (np.moveaxis(bridle.node_motion(mesh, t, order), 1, 0) for order in range(3))
    forces = Forces(mesh, r, v)
    lack = forces.total + np.moveaxis(load(t), 1, 0) - np.einsum("n...ij,n...j->n...i", forces.mass, a)
    inner = slice(len(network.nodes.kind), None)
    per_length = lack[inner] / mesh.tributary[inner][:, None, None]
    return np.abs(per_length).max(), np.abs(lack[manufactured_bridle.JOINT]).max()


def test_equations_of_cells_tend_to_those_of_the_bridle():
    """At the exact motion the residual falls with the square of the cells, within lines and at the joint."""
    errors = np.array([residuals(BRIDLE, n * np.array([4, 3, 3])) for n in (4, 8, 16)])
    assert np.log2(errors[:-1] / errors[1:]) == pytest.approx(np.full((2, 2), 2.0), abs=0.2)
    assert errors[-1, 0] < 10.0 and errors[-1, 1] < 100.0  # of loads of some 400 N/m and 10 kN


@pytest.mark.parametrize(
    "name", ["EA", "beta", "mass", "added_mass", "weight", "Cdn", "Cdt", "joint_mass", "joint_CdA", "joint_Ca"]
)
def test_a_term_missing_in_the_loads_is_seen(name):
    """Planted: loads of a bridle with a tenth less of one coefficient; the residual does not tend to zero."""
    value = np.asarray(getattr(BRIDLE, name)) * 0.9
    other = replace(BRIDLE, **{name: tuple(value) if value.ndim else float(value)})
    mixed = type(
        "Mixed", (), {"network": BRIDLE.network, "node_motion": BRIDLE.node_motion, "node_loads": other.node_loads}
    )
    fine, finer = (np.array(residuals(mixed, n * np.array([4, 3, 3]))) for n in (8, 16))
    assert max((4 * finer - fine) / 3 / finer) > 0.3  # what an order of 2 leaves at no size; less than 0.2 without


def bridle_error(k, duration=1.5):
    """Return the largest error of positions, m, and of the end tensions, N, on a mesh of k (4, 3, 3) cells."""
    network, load = load_of(BRIDLE, k * np.array([4, 3, 3]))
    mesh, t = Mesh(network), np.linspace(0, duration, 4)
    r, v = (BRIDLE.node_motion(mesh, t, order) for order in (0, 1))
    history = simulate(network, t, r[0], v[0], load=load, rtol=1e-8, atol=1e-8)
    return np.abs(history.position - r).max(), history


def test_the_bridle_is_approached_with_order_two():
    """Cells under the loads on their nodes follow the manufactured motion with the square of their size."""
    errors = [bridle_error(k)[0] for k in (1, 2, 4)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders == pytest.approx([2.0, 2.0], abs=0.25), errors
    assert errors[-1] < 0.03


# ---------------------------------------------------------------- random networks
def test_random_networks_have_what_they_say():
    """Two of each feature; 2 to 5 lines, at rest; one and the same for a seed."""
    for seed in SEEDS:
        case = random_network(seed)
        network, mesh = case.network, Mesh(case.network)
        assert case.feature == (FEATURES[seed % 5] if seed < 10 else "snap") and 2 <= len(network.lines.ends) <= 5
        forces = Forces(mesh, case.position, 0 * case.position)
        assert np.abs(forces.total[mesh.free]).max() < 1e-9 * forces.tension.max()
        assert (network.seabed is not None) == (case.feature == "seabed") == bool(forces.bears.any())
        assert bool(np.any(network.current)) == bool(seed % 2)
    assert np.array_equal(random_network(SEEDS[-1]).position, case.position)


@pytest.mark.parametrize("seed", [3, 7])
def test_end_tensions_do_not_depend_on_the_tolerance(seed):
    """A tenth of the tolerance changes them by less than the digits that are promised."""
    history, finer = (random_history(seed, duration=2.0, samples=6, rtol=tol, atol=tol) for tol in (1e-11, 1e-12))
    assert np.abs(history.end_tension - finer.end_tension).max() < INTEGRATED * finer.end_tension.max()


@pytest.mark.parametrize("seed", SEEDS)
def test_the_stored_tensions(seed, deep):
    """The table is what the networks give: its first second, in the long version all five."""
    t, stored = moving_network_tensions()[seed]
    samples = t.size if deep else 3
    history = random_history(seed, duration=t[samples - 1], samples=samples)
    assert np.array_equal(history.t, t[:samples])
    assert np.abs(history.end_tension - stored[:samples]).max() < INTEGRATED * stored.max()


def test_lines_that_snap_are_slack_at_times():
    """Cells of the last two seeds lose their tension and find it again."""
    for seed in SEEDS[-2:]:
        tension = random_history(seed, duration=2.0, samples=41, rtol=1e-8, atol=1e-8).tension
        assert ((tension[:-1] == 0) & (tension[1:] > 0)).any(axis=0).sum() > 3


def test_a_seabed_with_no_line_on_it_changes_nothing():
    """A seabed far below is none."""
    case, times = random_network(0), [0.0, 0.5]
    free = simulate(case.network, times, case.position, case.velocity)
    deep = simulate(replace(case.network, seabed=Seabed(500.0, 1e3)), times, case.position, case.velocity)
    assert np.abs(free.position - deep.position).max() < INTEGRATED
