"""Does a moving line do what it must on any mesh: rest, energy, symmetries, restarts, settings, and its limit?"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from solvers import Element, FunctionMotion, Motion, Network, Node, mooring_system, solve_time_domain
from solvers.mooring.stepping.time_domain import _Run

from ..cable import problems as box
from ..cases.cables import EVERYTHING, OC3, OC3_SEABED, SURGE_5, SWAY_5
from ..tools.orders import assert_order, extrapolated
from .problems import build, energy_gap, energy_of, scene
from .test_statics import NETWORKS

ROUNDED = 1e-10  # m, after a hundred steps; measured 1e-12


# ---------------------------------------------------------------- rest, and the fairlead
AT_REST = {
    "OC3": lambda: build(OC3, 20),
    "over a seabed": lambda: build(OC3_SEABED, 20),
    "in a current": lambda: build(replace(OC3, current=(0.5, 0.3, 0.0)), 20),
    "with a buoy": lambda: mooring_system(NETWORKS["buoy"], 20),
    "with a clump weight": lambda: mooring_system(NETWORKS["clump weight"], 20),
    "calibrated": lambda: build(OC3, 20, calibrate=True),
}


@pytest.mark.parametrize("name", AT_REST)
def test_a_line_at_rest_stays_there(name):
    """A hundred steps without motion: no node moves faster than 1e-10 m/s; the moment is that about the origin."""
    history = solve_time_domain(AT_REST[name](), dt=0.1, duration=10.0)
    assert history.steps == 100 and abs(history.ydot).max() <= 1e-10
    assert history.iterations == 100 and history.success
    moment = np.cross(history.r[:, -1], history.forces[:, -1], axis=0)
    assert np.allclose(history.body_moment, moment, rtol=1e-12, atol=1e-12 * abs(moment).max())


@pytest.mark.parametrize("case", [SURGE_5, EVERYTHING], ids=lambda case: case.name)
def test_the_fairlead_is_where_it_is_prescribed(case):
    """Position, velocity and acceleration of both ends are those of the ramped motion to rounding at every time."""
    history = solve_time_domain(build(case, 12), dt=0.1, duration=30.0)
    t, moved = history.time, history.ramped_system.motion
    fairlead = np.array(case.fairlead)[:, None]
    axes = history.system.axes.T
    assert abs(history.r[:, -1] - fairlead - moved.displacement(t)).max() <= 1e-12 * case.length
    assert abs(axes @ history.ydot[:, -1] - moved.velocity(t)).max() <= 1e-12
    assert abs(axes @ history.yddot[:, -1] - moved.acceleration(t)).max() <= 1e-12
    assert abs(history.r[:, 0] - np.array(case.anchor)[:, None]).max() <= 1e-12 * case.length
    assert not history.ydot[:, 0].any() and history.ramp == 10.0 and history.time[-1] == 30.0


# ---------------------------------------------------------------- energy
BARE = replace(SURGE_5, name="surge in vacuo", Cdn=0.0, Ca=0.0, rho=0.0)
SWINGS = {
    "vacuo": BARE,
    "added mass": replace(SURGE_5, Cdn=0.0),
    "drag": SURGE_5,
    "all": replace(OC3, Cdt=0.05, damping=0.02, amplitude=(5.0, 1.0, 2.0), current=(0.3, 0.2, 0.0)),
}


@pytest.mark.parametrize("name", SWINGS)
def test_energy_of_a_swing_closes(name):
    """Kinetic, elastic and potential energy change by the work of fairlead, drag and damper, up to dt^2."""
    system, dts = build(SWINGS[name], 12, calibrate=False), (0.05, 0.025, 0.0125)
    histories = [solve_time_domain(system, dt=dt, duration=20.0, tolerance=1e-9) for dt in dts]
    energy = energy_of(histories[-1])
    assert (name != "vacuo") == bool(energy.turning.any()) and (name in ("drag", "all")) == bool(energy.drag.any())
    assert_order(dts, [energy_gap(history) for history in histories], 2, ceiling=5e-6, what=name)


# ---------------------------------------------------------------- symmetries
def run(case, cells=12, dt=0.1, duration=12.0, **options):
    """Return the history of a case, its steps solved to rounding."""
    settings = {"tolerance": 1e-9} | {name: options.pop(name) for name in ("every", "ramp") if name in options}
    return solve_time_domain(build(case, cells, calibrate=False, **options), dt=dt, duration=duration, **settings)


@pytest.mark.parametrize("angle", [1.1, -2.3, np.pi])
def test_a_turned_line_moves_turned(angle):
    """All inputs turned about the vertical: positions and forces turn."""
    plain, turned = run(EVERYTHING), run(EVERYTHING.turned(angle))
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    assert abs(np.tensordot(turn, plain.r, 1) - turned.r).max() <= ROUNDED
    assert abs(turn @ plain.fairlead_force - turned.fairlead_force).max() <= ROUNDED * abs(plain.fairlead_force).max()


def test_a_mirrored_line_moves_mirrored():
    """All inputs in a mirror: positions and forces too."""
    plain, mirrored = run(EVERYTHING), run(EVERYTHING.mirrored())
    flip = np.array([1.0, -1.0, 1.0])[:, None, None]
    assert abs(plain.r * flip - mirrored.r).max() <= ROUNDED
    assert abs(plain.anchor_force * flip[:, 0] - mirrored.anchor_force).max() <= ROUNDED * abs(plain.anchor_force).max()


@pytest.mark.parametrize("case", [SURGE_5, replace(OC3_SEABED, amplitude=(3.0, 0.0, 2.0))], ids=lambda case: case.name)
def test_planar_and_spatial_move_alike(case):
    """In two axes and in three, a motion in the plane is the same."""
    planar, spatial = run(case), run(case, fields="spatial")
    assert planar.y.shape[0] == 2 and spatial.y.shape[0] == 3
    assert abs(planar.r - spatial.r).max() <= ROUNDED and not spatial.field("y").any()
    assert abs(planar.tension - spatial.tension).max() <= ROUNDED * planar.tension.max()


def test_a_line_given_from_its_other_materials_end():
    """A Network of one element is its Scene, and so with the element's ends exchanged."""
    given = scene(SURGE_5)
    weight, cable = given.cable.weight_in(given.environment), given.cable
    nodes = [Node("fixed", given.anchor), Node("coupled", given.fairlead)]
    histories = [run(SURGE_5)]
    for ends in ((0, 1), (1, 0)):
        network = Network(nodes, [Element(weight, cable.EA, given.length, ends, cable=cable)], given.environment)
        system = mooring_system(network, 12, motion=given.motion, calibrate=False)
        histories.append(solve_time_domain(system, dt=0.1, duration=12.0, tolerance=1e-9))
    for history in histories[1:]:
        assert abs(history.y - histories[0].y).max() <= ROUNDED


# ---------------------------------------------------------------- settings
def test_a_list_of_lines_is_each_alone():
    """Bit for bit, side by side on threads."""
    lines = [build(case, 10) for case in (SURGE_5, SWAY_5, EVERYTHING)]
    together = solve_time_domain(lines, dt=0.2, duration=8.0)
    for history, line in zip(together, lines, strict=True):
        assert np.array_equal(history.y, solve_time_domain(line, dt=0.2, duration=8.0).y)


def test_a_scene_is_taken_as_its_line():
    """With fifty cells on a fitted mesh."""
    given = scene(SURGE_5)
    one, other = (solve_time_domain(line, dt=0.5, duration=5.0) for line in (given, mooring_system(given)))
    assert one.system.nodes == 51 and np.array_equal(one.y, other.y)


@pytest.mark.parametrize("count", [120, 121, 7])
def test_states_are_kept_every_so_often(count):
    """The first, every n-th and the last, the same as when all are kept."""
    whole = run(SURGE_5, duration=count * 0.1)
    for every in (2, 5, 50, 1000):
        part = run(SURGE_5, duration=count * 0.1, every=every)
        kept = sorted({*range(0, count + 1, every), count})
        assert np.array_equal(part.y, whole.y[..., kept]) and np.allclose(part.time, whole.time[kept], atol=1e-12)
        assert np.array_equal(part.yddot, whole.yddot[..., kept]) and part.steps == count


def test_progress_is_told_the_times():
    """Increasing times up to the end, and the same history as without."""
    times, system = [], build(SURGE_5, 10)
    told = solve_time_domain(system, dt=0.01, duration=12.0, progress=times.append)
    plain = solve_time_domain(system, dt=0.01, duration=12.0)
    assert len(times) > 2 and (np.diff(times) > 0).all() and times[-1] == pytest.approx(12.0)
    assert abs(told.y - plain.y).max() <= 1e-4  # within the tolerance of the steps: factors are made anew
    assert told.time.size == plain.time.size


def test_dt_divides_the_duration():
    """A step that does not is made shorter; a ramp of nothing starts at once."""
    history = run(SURGE_5, dt=0.3, duration=1.0, ramp=0.0)
    assert history.time.size == 5 and history.time[-1] == 1.0 and history.ramp == 0.0
    assert abs(history.ydot[0, -1, 0] - 2 * np.pi * 0.05 * 5.0) < 1e-12


def test_steps_adapt_to_their_tolerance():
    """With step_tolerance the error falls with it, with short steps where the motion needs them, from any dt."""
    exact = run(SURGE_5, dt=0.005, duration=15.0).y[..., -1]
    errors, system = [], build(SURGE_5, 12, calibrate=False)
    for tolerance in (1e-3, 1e-4, 1e-5):
        history = solve_time_domain(system, dt=1.0, duration=15.0, tolerance=1e-9, step_tolerance=tolerance)
        assert history.time.size == 16 and history.success
        errors.append(abs(history.y[..., -1] - exact).max())
        assert history.cut > 0
    assert errors[2] < errors[1] / 2 < errors[0] / 4 and errors[2] < 0.02, errors


@pytest.mark.parametrize("cells", [10, 100])
def test_a_tolerance_below_rounding_ends_at_rounding(cells):
    """Newton's method is not asked for more digits than positions have: no step is cut, and the tension stays."""
    line = build(SURGE_5, cells, mesh="uniform")
    waves = [solve_time_domain(line, dt=0.1, periods=0.5, tolerance=tolerance) for tolerance in (1e-9, 1e-15)]
    assert waves[1].cut == 0
    tensions = [wave.tension[-1, -1] for wave in waves]
    assert tensions[1] == pytest.approx(tensions[0], rel=1e-9)


def test_a_failed_step_is_said():
    """Where no number of parts solves a step the history ends there and says where; states before it are there."""
    system = build(SURGE_5, 10)
    broken = FunctionMotion(
        lambda t: (0.0 if t < 1.95 else 1e30, 0.0, 0.0), lambda t: (0.0 if t < 1.95 else 1e30, 0.0, 0.0)
    )
    history = solve_time_domain(system.with_motion(broken), dt=0.1, duration=3.0, throw=False)
    assert not history.success and history.event[0] == pytest.approx(1.9, abs=0.11)
    assert history.time[-1] == pytest.approx(history.event[0]) and np.isfinite(history.y).all()
    with pytest.raises(RuntimeError, match=r"dt = 0.1 s"):
        solve_time_domain(system.with_motion(broken), dt=0.1, duration=3.0)


# ---------------------------------------------------------------- restarts and shifts of time
class Later:
    """A motion that has gone on for some time already."""

    def __init__(self, motion, lead):
        self.motion, self.lead, self.period = motion, lead, motion.period

    def displacement(self, t):
        return self.motion.displacement(np.asarray(t) + self.lead)

    def velocity(self, t):
        return self.motion.velocity(np.asarray(t) + self.lead)

    def acceleration(self, t):
        return self.motion.acceleration(np.asarray(t) + self.lead)

    def directions(self):
        return self.motion.directions()


@pytest.mark.parametrize("container", [tuple, list, np.array])
def test_a_restart_goes_on(container):
    """From a stored state, with the motion as it then is, the history is that without a stop, up to dt^2."""
    gaps, dts = [], (0.1, 0.05, 0.025)
    for dt in dts:
        whole = run(SURGE_5, dt=dt, duration=24.0)
        half = round(14.0 / dt)
        line = whole.system.with_motion(Later(whole.system.motion, 14.0))
        start = container([whole.y[..., half], whole.ydot[..., half]])
        rest = solve_time_domain(line, dt=dt, duration=10.0, start=start, tolerance=1e-9)
        assert rest.ramp == 0.0 and np.array_equal(rest.y[..., 0], whole.y[..., half])
        gaps.append(abs(rest.y - whole.y[..., half:]).max())
    assert gaps[2] < gaps[1] / 3 < gaps[0] / 9 and gaps[2] < 1e-4, gaps


def test_a_motion_that_starts_later_is_followed_later():
    """In still water the response to a motion begun later is the same one later."""
    rise = lambda t: np.clip(t, 0, None) ** 3 * np.exp(-np.clip(t, 0, None))
    slope = lambda t: np.clip(t, 0, None) ** 2 * (3 - np.clip(t, 0, None)) * np.exp(-np.clip(t, 0, None))
    system = build(OC3, 12)
    early, late = (
        solve_time_domain(
            system.with_motion(
                FunctionMotion(
                    lambda t, lag=lag: (rise(t - lag), 0.0, 0.0), lambda t, lag=lag: (slope(t - lag), 0.0, 0.0)
                )
            ),
            dt=0.05, duration=8.0, tolerance=1e-9,
        )
        for lag in (0.0, 2.0)
    )  # fmt: skip
    assert abs(early.y[..., :121] - late.y[..., 40:]).max() <= 1e-5 and np.ptp(early.y[0, 6]) > 0.1
    assert abs(late.ydot[..., :40]).max() <= 1e-9


# ---------------------------------------------------------------- outputs
def test_outputs_belong_together():
    """Forces, tensions, harmonics and interpolated tension of one history, in the public frame."""
    history = solve_time_domain(build(SURGE_5.turned(0.4), 20, calibrate=False), dt=0.1, periods=3)
    size = np.linalg.norm(history.fairlead_force, axis=0)
    assert np.allclose(history.fairlead_tension(history.time), size, rtol=1e-12)
    assert abs(size / history.tension[-1] - 1).max() < 0.05 and history.tension.shape == (20, 601)
    free = np.delete(history.forces, history.system.prescribed_nodes, axis=1)
    assert abs(free).max() <= 0.05 * size.max()  # what the steps leave at their ends
    start, period = history.last_period
    assert (start, period) == (pytest.approx(40.0), 20.0)
    t = start + period * np.arange(400) / 400
    spectrum = np.fft.rfft(history.fairlead_tension(t)) / 400
    wanted = np.concatenate([[spectrum[0].real], 2 * abs(spectrum[1:4])])
    assert np.allclose(history.tension_harmonics(3), wanted, rtol=1e-5, atol=1e-5 * wanted[0])
    assert np.array_equal(history.field("z"), history.y[-1])
    assert np.allclose(history.r[2], history.y[-1]) and history.r.shape == (3, 21, 601)


BETWEEN = 2e-14
"""Of the greatest tension: fifty roundings of a polynomial of degree five in steps of its own, near the middle."""


def test_tension_between_steps_is_of_degree_five():
    """A tension of degree five in time is met between the steps to rounding, at both ends of the history too."""
    history = solve_time_domain(build(SURGE_5, 10), dt=1.0, duration=40.0)
    time, wanted = history.time, np.polynomial.Polynomial([1.0, -0.3, 0.7, 0.1, -0.4, 0.2], domain=[0.0, 40.0])
    interpolate, t = history._interpolant(wanted(time)), np.linspace(0.0, 40.0, 777)
    assert abs(interpolate(t) - wanted(t)).max() <= BETWEEN * abs(wanted(t)).max()


# ---------------------------------------------------------------- the limit
LIMIT = np.array([1377.82, 603.93, 970.68])  # kN: max, min, mean of case 1; two formulations agree to 0.03
BAND = 0.03  # kN


@cache
def summary(cells, dt, periods):
    """Return max, min and mean of the tension in the last period of case 1, kN."""
    system = build(SURGE_5, cells, calibrate=False)
    history = solve_time_domain(system, dt=dt, periods=periods, tolerance=1e-7)
    start, period = history.last_period
    tension = history.fairlead_tension(start + period * np.arange(4000) / 4000) / 1e3
    return np.array([tension.max(), tension.min(), tension.mean()])


def test_case_1_tends_to_the_limit_of_other_formulations(deep):
    """Extrapolated in cells and steps, extremes and mean are those of the box scheme and others to 0.03 kN (--deep)."""
    if deep:
        runs = [summary(cells, dt, 7) for cells, dt in ((100, 0.025), (200, 0.0125))]
    else:
        runs = [summary(cells, dt, 5) for cells, dt in ((50, 0.05), (100, 0.025))]
    limit = extrapolated((2, 1), runs)
    assert abs(limit - LIMIT).max() <= (BAND if deep else 3 * BAND), limit


def test_the_box_scheme_has_the_same_limit(deep):
    """Both extrapolated in cells and steps alike, the tension of the last period is the same."""
    cells, periods = ((50, 100), 4) if deep else ((20, 40), 3)
    instants = (periods - 1 + np.arange(400) / 400) * 20.0
    runs = {"box": [], "line": []}
    for count in cells:
        dt = 0.1 * cells[0] / count
        for name, system in (("box", box.system(SURGE_5, count + 1)), ("line", build(SURGE_5, count, calibrate=False))):
            runs[name].append(solve_time_domain(system, dt=dt, periods=periods).fairlead_tension(instants))
    one, other = (extrapolated((2, 1), table) for table in runs.values())
    apart = [abs(a - b).max() / np.ptp(one) for a, b in ((one, other), (runs["box"][-1], runs["line"][-1]))]
    assert apart[0] <= (1e-3 if deep else 4e-3) and apart[0] < apart[1] / 2, apart


def test_sampled_and_other_motions_are_taken():
    """A motion by a function, that has no period, moves the line as the harmonic that it is."""
    motion = Motion.harmonic(0.05, (5.0, 0.0, 0.0))
    plain = FunctionMotion(motion.displacement, motion.velocity)
    lines = [build(OC3, 10, motion=given, mesh="uniform", fields="spatial") for given in (motion, plain)]
    one, other = solve_time_domain(lines, dt=0.1, duration=10.0, ramp=5.0, tolerance=1e-9)
    assert abs(one.y - other.y).max() <= 1e-6 and other.system.period is None


def test_a_start_is_not_changed():
    """Arrays whose transposes are contiguous, as those of an earlier history, stay as they were."""
    system = build(SURGE_5, cells=6)
    y = np.array(system.rest_state().T, order="C").T
    before, ydot = y.copy(), np.zeros((system.nodes, 2)).T
    settings = {
        "dt": 0.1,
        "count": 5,
        "rho_inf": 0.5,
        "tolerance": 1e-8,
        "step_tolerance": None,
        "ramp": 0.0,
        "every": 1,
    }
    system.integrate(start=(y, ydot), **settings)
    assert np.array_equal(y, before) and not ydot.any()


FEW_ITERATIONS = 3.8  # of a step of a 25th of a period; measured 3.2, 4.1 where none begins with new factors


def test_factors_are_taken_anew_where_steps_converge_slowly():
    """The OC3 line in 5 m of surge, whose tension changes by half of itself: Newton's method keeps its pace."""
    line = build(SURGE_5, 10)
    history = solve_time_domain(line, dt=line.period / 25, periods=3)
    assert history.cut == 0 and history.iterations <= FEW_ITERATIONS * history.steps


def test_the_error_of_steps_is_that_of_newmark_over_the_displacements():
    """h^2 |beta - 1/6| times the largest change of an acceleration, over the largest displacement so far."""
    system, h = build(OC3, 4), 0.2
    run = _Run(system, 0.8, 1e-4, 1e-3, tuple(np.zeros((5, 2)) for _ in range(5)))
    still, a = np.zeros((2, 5, 2)), np.zeros((2, 5, 2))
    a[0, 2, 1], a[1, 2, 1] = 1.0, -2.0
    expected = h**2 * abs(run.scheme[2] - 1 / 6) * 3.0 / 4.0
    for displacement in (4.0, 2.0):
        record = system.rest.y.T + np.array([0.0, displacement])[:, None, None], still, a
        assert run._step_error(record, still[0], h) == pytest.approx(expected, rel=1e-12)
