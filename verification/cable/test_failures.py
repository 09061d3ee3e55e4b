"""What a dynamic cable does where it used to fail silently: short steps with a held end, over-stretch, odd seabeds."""

from __future__ import annotations

import pickle
from dataclasses import replace
from importlib.resources import files

import numpy as np
import pytest

from solvers import (
    ConvergenceError,
    Environment,
    FunctionMotion,
    InputError,
    Scene,
    Status,
    cable_system,
    solve_periodic,
    solve_static,
    solve_time_domain,
)

OC3 = Scene.load(files("reference_data") / "scenes" / "dynamics" / "hb_case_1.toml")


@pytest.mark.parametrize(("nodes", "dt", "rho_inf"), [(7, 0.02, 0.5), (20, 0.01, 0.5), (20, 0.005, 1.0)])
def test_drift_control_is_stable_at_steps_shorter_than_an_axial_wave_needs(nodes, dt, rho_inf):
    """Steps below the time of an axial wave in a cell leave the end as near as long steps do, without growth."""
    history = solve_time_domain(cable_system(OC3, nodes), dt=dt, duration=10, rho_inf=rho_inf)
    long = solve_time_domain(cable_system(OC3, nodes), dt=0.1, duration=10)
    assert history.drift().max() <= 1.5 * long.drift().max() + 1e-3


def test_the_first_controlled_step_is_short_whatever_the_longest():
    """Under step control the longest step allowed does not show in the error: the first one is controlled, too."""
    chain, t = cable_system(OC3, 20), np.linspace(1, 10, 91)
    fine = solve_time_domain(chain, dt=0.0025, duration=10, ramp=10, hold=None).fairlead_tension(t)
    options = {"duration": 10, "ramp": 10, "hold": None, "step_tolerance": 1e-5}
    errors = [
        abs(solve_time_domain(chain, dt=dt, **options).fairlead_tension(t) - fine).max() / np.ptp(fine)
        for dt in (0.1, 1.0)
    ]
    assert max(errors) <= 1e-3 and errors[1] <= 1.5 * errors[0]


def test_a_line_far_too_short_is_not_an_equilibrium():
    """A line of 40 m between ends 885 m apart has a balance of forces at a strain of 21: named, not returned."""
    state = solve_static(cable_system(replace(OC3, length=40.0), 50), throw=False)
    assert state.status is Status.OVERSTRETCHED and state.y[0].max() > 1
    with pytest.raises(ConvergenceError, match=r"stretched beyond 30 %"):
        solve_static(cable_system(replace(OC3, length=40.0), 50))


def test_an_overstretching_motion_ends_with_time_and_node():
    """A fairlead towed away without end is stopped with time and node; the history up to there is kept."""
    towed = FunctionMotion(lambda t: (3.0 * t, 0, 0), lambda t: (3.0, 0, 0))
    chain = cable_system(OC3, 10, motion=towed)
    history = solve_time_domain(chain, dt=0.5, duration=200, throw=False)
    time, node = history.event
    assert history.status is Status.OVERSTRETCHED and 50 < time == history.time[-1] < 200 and 0 <= node < 10
    with pytest.raises(ConvergenceError, match=r"stretched beyond 30 %.*stopped at t = .* s, node \d+ of 10"):
        solve_time_domain(chain, dt=0.5, duration=200)


def test_a_seabed_without_stiffness_carries_nothing():
    """A stiffness of zero is the line without seabed."""
    seabed = replace(OC3, environment=Environment(depth=320.0, seabed_stiffness=0.0))
    none = replace(seabed, environment=Environment())
    pair = [solve_static(cable_system(scene, 30)).tension for scene in (seabed, none)]
    np.testing.assert_allclose(*pair, rtol=1e-9)


@pytest.mark.parametrize(
    ("change", "mesh", "message"),
    [
        ({}, "abc", r"mesh: 'abc' must be arc lengths \(m\)"),
        (
            {"environment": Environment(depth=310.0, seabed_stiffness=1e4)},
            None,
            r"anchor: z = -320 m is below the seabed, z = -310 m",
        ),
    ],
)
def test_bad_cables_are_refused(change, mesh, message):
    """A mesh that is none and an anchor in the ground are refused by name."""
    with pytest.raises(InputError, match=message):
        cable_system(replace(OC3, **change), 20, mesh=mesh)


# ---------------------------------------------------------------- in another process
def moving():
    """The line on few nodes, with its motion of 5 m."""
    return cable_system(OC3, 12)


RESULTS = {
    "equilibrium": lambda: solve_static(moving()),
    "history": lambda: solve_time_domain(moving(), dt=0.5, periods=1),
    "periodic": lambda: solve_periodic(moving(), harmonics=4),
    "corrected": lambda: solve_periodic(moving(), harmonics=4, deferred_correction=True),
}


@pytest.mark.parametrize("name", RESULTS)
def test_results_go_from_one_process_to_another(name):
    """A study over many cases runs in a pool of processes: its results come back whole, with their systems."""
    result = RESULTS[name]()
    copy = pickle.loads(pickle.dumps(result))
    assert copy.status is result.status and np.array_equal(copy.tension, result.tension)
    assert np.array_equal(solve_static(pickle.loads(pickle.dumps(moving()))).y, copy.system.rest_state())


def test_failures_go_from_one_process_to_another():
    """An exception that cannot be sent back would leave the pool waiting; it keeps its message."""
    with pytest.raises(ConvergenceError) as failed:
        solve_periodic(cable_system(replace(OC3, motion=OC3.motion.scaled(4.0)), 12), harmonics=4)
    copy = pickle.loads(pickle.dumps(failed.value))
    assert str(copy) == str(failed.value) and type(copy) is ConvergenceError
