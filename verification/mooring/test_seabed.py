"""Does the seabed bear, damp and rub as it has to? Against a bouncing mass, work in closed form, and energy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from solvers import (
    CableProperties,
    Element,
    Environment,
    FunctionMotion,
    Network,
    Node,
    mooring_system,
    solve_time_domain,
)

from ..cases.cables import OC3_SEABED, SLACK_CHAIN
from ..exact.mooring.elastic_bounce import SeabedBounce
from ..exact.mooring.seabed_friction import work_per_cycle
from .problems import energy_gap, energy_of, hanging_mass, scene

G = 9.80665
FALLING = SeabedBounce(150.0, 150 * G, 30.0, 8e3, position=-28.8, velocity=-0.5)
BOUNCES = {
    # the mass, and the error of height and speed over their ranges at 1.25e-4 s
    "undamped": (FALLING, 1e-5),  # measured 2e-6
    "damped": (replace(FALLING, damping=150.0), 5e-4),  # a damper bears at once: of first order; measured 1.5e-4
    "much damped": (replace(FALLING, damping=1200.0), 1e-3),  # measured 4e-4
    "overdamped": (replace(FALLING, damping=4000.0), 4e-3),  # measured 1.5e-3
}


@pytest.mark.parametrize("name", BOUNCES)
def test_a_mass_bounces_on_the_seabed(name):
    """On the last node of a line that is as soft as nothing: stiffness and damping are those of its half cell."""
    exact, within = BOUNCES[name]
    share = 6.25  # m, of two cells of twelve and a half
    bed = Environment(0.0, depth=exact.depth, seabed_stiffness=exact.stiffness / share,
                      seabed_damping=exact.damping / share)  # fmt: skip
    system = hanging_mass(exact.mass, EA=1e-3, length=25.0, position=exact.position, environment=bed)
    y, ydot = np.zeros((2, 2, 3))
    y[1], ydot[1] = (value * np.array([1.0, 0.5, 0.0]) for value in (exact.position, exact.velocity))
    history = solve_time_domain(system, dt=1.25e-4, duration=4.0, start=(y, ydot), tolerance=1e-9)
    z, v, _ = exact.motion(history.time)
    assert exact.events(4.0) and history.success
    errors = abs(history.y[1, 0] - z).max() / np.ptp(z), abs(history.ydot[1, 0] - v).max() / np.ptp(v)
    assert max(errors) <= within, errors


# ---------------------------------------------------------------- friction
LENGTH, WEIGHT, SINK = 100.0, 1000.0, 1e-3  # m, N/m, m
SPEED, OMEGA = 0.5, 0.5  # m/s, rad/s


def dragged(friction, slip_speed, direction=(1.0, 0.0)):
    """Return the system of a stiff line on the seabed whose end moves to and fro, along it or across.

    The seabed is as much higher than given as the line sinks in, so that its ends are borne as the rest is.
    """
    cable, pull = CableProperties(1e11, 0.1, 120.0, WEIGHT), 4 * LENGTH * WEIGHT * max(friction, 0.1)
    bed = Environment(0.0, depth=30.0, seabed_stiffness=WEIGHT / SINK)
    nodes = [Node("free", (0.0, 0.0, -30.0), force=(-pull, 0.0, 0.0)), Node("coupled", (LENGTH, 0.0, -30.0))]
    network = Network(nodes, [Element(WEIGHT, cable.EA, LENGTH, (0, 1), friction, cable=cable)], bed)
    x, y = (SPEED / OMEGA * part for part in direction)
    motion = FunctionMotion(
        lambda t: (x * np.sin(OMEGA * t), y * np.sin(OMEGA * t), 0.0),
        lambda t: (x * OMEGA * np.cos(OMEGA * t), y * OMEGA * np.cos(OMEGA * t), 0.0),
    )
    system = mooring_system(network, 8, mesh="uniform", motion=motion, slip_speed=slip_speed)
    system.line = system.line._replace(floor=system.line.floor + SINK)
    return system


@pytest.mark.parametrize("slip_speed", [0.02, 0.2, 1.0])
@pytest.mark.parametrize("friction", [0.3, 0.8])
def test_work_of_friction(friction, slip_speed):
    """What the fairlead gives in a period to a line that is dragged to and fro is the work of smoothed friction."""
    period, steps = 2 * np.pi / OMEGA, 400
    history = solve_time_domain(
        dragged(friction, slip_speed), dt=period / steps, duration=3 * period, ramp=period, tolerance=1e-7
    )
    cycle = history.time >= 2 * period * (1 - 1e-12)
    energy = energy_of(history)
    got = [power[cycle][:-1].sum() * period / steps for power in (energy.given, energy.friction)]
    exact = float(work_per_cycle(friction, WEIGHT * LENGTH, SPEED, slip_speed, OMEGA))
    assert np.abs(np.array(got) / exact - 1).max() <= 1e-4 and history.tension.min() > 0


def test_friction_is_against_the_velocity_in_the_plane():
    """A line that is dragged along both axes is rubbed along both, with the normal force that it rests with."""
    system = dragged(0.8, 0.2, (0.6, 0.0))
    v = np.zeros((9, 3))
    v[:, :2] = [0.3, -0.4]
    system.line = system.line._replace(normal_drag=0 * system.line.normal_drag)
    rest = np.ascontiguousarray(system.rest.y.T)
    forces = [system.forces(rest.T[..., None], speed.T[..., None], 0 * rest.T[..., None])[0] for speed in (v, 0 * v)]
    rubbed = (forces[0] - forces[1])[:, 1:-1, 0]
    normal = WEIGHT * LENGTH / 8
    wanted = -0.8 * normal * np.array([0.3, -0.4, 0.0]) / np.hypot(0.5, 0.2)
    assert np.abs(rubbed[:, :6] - wanted[:, None]).max() <= 1e-5 * normal


# ---------------------------------------------------------------- a line that falls on the seabed
LYING = replace(SLACK_CHAIN, name="slack chain in vacuo", current=(0.0, 0.0, 0.0), amplitude=None, Cdn=0.0, Ca=0.0)


def dropped(damping, dt, contact_depth=0.0, **options):
    """Return the history of a chain that is let go from half a metre above where it rests."""
    system = mooring_system(scene(LYING, seabed_damping=damping), 40, mesh="uniform", contact_depth=contact_depth)
    y = system.rest.y.copy()
    y[-1] += 0.5 * np.sin(np.pi * system.s / system.s[-1])
    return solve_time_domain(system, dt=dt, duration=3.0, start=(y, None), tolerance=1e-8, **options)


STORED = LYING.submerged_weight * 0.5 * LYING.length * 2 / np.pi  # J, of the line above where it rests


def test_a_dropped_line_loses_no_energy():
    """In vacuo, without dampers, on springs of the seabed and with the trapezoid in time: all of it stays."""
    energy = energy_of(dropped(0.0, 2.5e-4, rho_inf=1.0))
    assert not (energy.drag.any() or energy.damper.any() or energy.seabed.any() or energy.friction.any())
    assert abs(energy.total - energy.total[0]).max() <= 6e-4 * STORED  # measured 2.9e-4, 1.7e-3 with twice the step


def test_a_dropped_line_loses_energy_to_the_damper_of_the_seabed():
    """What is lost is its work: of first order in the step, for it bears at once."""
    gaps = []
    for dt in (1e-3, 2.5e-4):
        history = dropped(2e3, dt, rho_inf=1.0)
        energy = energy_of(history)
        gaps.append(energy_gap(history))
        assert (energy.seabed >= 0).all() and energy.total[0] - energy.total[-1] > 0.5 * STORED
    assert gaps[1] < gaps[0] / 2.5 and gaps[1] <= 2.2e-3  # measured 1.1e-3


def test_a_damper_that_grows_from_contact_on_closes_its_energy():
    """Its force is continuous: what is lost is its work, of second order in the step."""
    depth, gaps = LYING.submerged_weight / LYING.seabed_stiffness, []
    for dt in (1e-3, 2.5e-4):
        history = dropped(2e3, dt, depth, rho_inf=1.0)
        energy = energy_of(history)
        gaps.append(energy_gap(history))
        assert (energy.seabed >= 0).all() and energy.total[0] - energy.total[-1] > 0.5 * STORED
    assert gaps[1] < gaps[0] / 12 and gaps[1] <= 7e-4  # measured 3.3e-4


def test_a_line_over_the_seabed_closes_its_energy():
    """Surge and heave with drag, a damped seabed and friction: work and energy differ by less with shorter steps."""
    given = replace(scene(replace(OC3_SEABED, amplitude=(3.0, 0.0, 2.0)), seabed_damping=2e3), friction=(0.5,))
    system = mooring_system(given, 16, slip_speed=0.3)
    gaps = [energy_gap(solve_time_domain(system, dt=dt, duration=20.0, tolerance=1e-9)) for dt in (0.05, 0.0125)]
    assert gaps[1] < gaps[0] / 6 and gaps[1] <= 8e-5
