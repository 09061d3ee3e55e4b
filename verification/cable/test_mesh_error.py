"""Does a result over a seabed say what its mesh is worth?"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from solvers import CableProperties, Environment, Motion, Scene, cable_system, solve_periodic, solve_time_domain
from solvers.common.diagnostics import MAX_MESH_ERROR

from ..registry import last_period_tension

CHAIN = CableProperties(EA=1.674e9, diameter=0.252, mass_per_length=390.0, Cdn=1.37, Cdt=0.64, Ca=1.0)
SHALLOW = Scene(
    "a studless chain in 50 m of water",
    CHAIN,
    410.0,
    (-400.0, 0.0, -50.0),
    (0.0, 0.0, 0.0),
    environment=Environment(depth=50.0, seabed_stiffness=25.2e3),
    motion=Motion.harmonic(0.1, (0.0, 0.0, 0.5)),
)
DT, PERIODS = 0.05, 3


def mesh_warnings(result):
    return [warning for warning in result.warnings if warning.startswith("mesh: half as many")]


def test_a_uniform_mesh_over_a_seabed_warns():
    """Heave of 0.5 m on 50 uniform nodes is off by a fifth of the range and more, and both solvers say so."""
    history = solve_time_domain(cable_system(SHALLOW, 50), dt=DT, periods=PERIODS)
    response = solve_periodic(cable_system(SHALLOW, 50), harmonics=9)
    for result in (history, response):
        assert result.mesh_error > 0.2
        assert len(mesh_warnings(result)) == 1


def test_the_estimate_is_the_change_that_half_the_nodes_make():
    """What ``mesh_error`` says is what a caller finds who integrates the line on every second node."""
    system = cable_system(SHALLOW, 51)
    history = solve_time_domain(system, dt=DT, periods=PERIODS)
    waves = [last_period_tension(h) for h in (history, solve_time_domain(system.coarser()[0], dt=DT, periods=PERIODS))]
    change = np.sqrt(np.mean((waves[0] - waves[1]) ** 2)) / np.ptp(waves[0])
    assert history.mesh_error == pytest.approx(change, rel=0.01)


def test_without_a_seabed_no_second_run_is_made():
    """A line off the ground is smooth, and its warnings cost nothing; the estimate is there for who asks."""
    scene = replace(SHALLOW, environment=Environment(), fairlead=(-10.0, 0.0, 0.0))
    response = solve_periodic(cable_system(scene, 81), harmonics=5)
    assert not mesh_warnings(response)
    assert "mesh_error" not in vars(response)
    assert 0 < response.mesh_error < MAX_MESH_ERROR
