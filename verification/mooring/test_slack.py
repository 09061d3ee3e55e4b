"""Does a line go slack and snap taut as it has to? Against a bouncing mass, known exactly, and on ever finer lines."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from solvers import CableProperties, Element, Environment, Motion, Network, Node, mooring_system, solve_time_domain
from solvers.mooring.stepping.steps import law_after_step

from ..cases.cables import OC3
from ..exact.mooring.elastic_bounce import ElasticBounce
from ..tools.orders import assert_order
from .problems import build, hanging_mass, random_state

G = 9.80665
BOUNCES = {
    "undamped": ElasticBounce(200.0, 200 * G, 20.0, 1.2e5, position=-18.5, velocity=2.0),
    "taut at first": ElasticBounce(200.0, 200 * G, 20.0, 1.2e5, position=-22.5, velocity=0.0),
    "damped": ElasticBounce(200.0, 200 * G, 20.0, 1.2e5, position=-18.5, velocity=2.0, beta=0.02),
    "much damped": ElasticBounce(200.0, 200 * G, 20.0, 1.2e5, position=-18.5, velocity=2.0, beta=0.2),
    "overdamped": ElasticBounce(200.0, 200 * G, 20.0, 1.2e5, position=-18.5, velocity=2.0, beta=0.6),
}
DURATION = 4.0  # s: four snaps of the undamped mass
DT = 1.25e-4  # s
EXACT = 1e-6  # of the amplitude, at that step; measured 2e-7 to 8e-7


def bounce(name, dt, **options):
    """Return the history of a mass on a line of two cells and no weight, in the exact one's place at the start."""
    exact = BOUNCES[name]
    system = hanging_mass(exact.mass, EA=exact.EA, length=exact.length, damping=exact.beta, position=exact.position)
    y, ydot = np.zeros((2, 2, 3))
    y[1], ydot[1] = (value * np.array([1.0, 0.5, 0.0]) for value in (exact.position, exact.velocity))
    return solve_time_domain(system, dt=dt, duration=DURATION, start=(y, ydot), tolerance=1e-9, **options)


def bounce_errors(name, dt):
    """Return the largest errors of height and speed of the mass over their ranges, and of the tension."""
    history = bounce(name, dt)
    z, v, force = BOUNCES[name].motion(history.time)
    got = history.y[1, 0], history.ydot[1, 0]
    errors = [abs(a - b).max() / np.ptp(b) for a, b in zip(got, (z, v), strict=True)]
    away = abs(np.gradient(force)) < 0.2 * force.max()  # a damper begins to pull at once: not at that instant
    return errors, abs(history.tension[0] - force)[away].max() / force.max()


@pytest.mark.parametrize("name", BOUNCES)
def test_a_mass_bounces_as_it_has_to(name):
    """Height and speed through slack and snap, to a millionth of their ranges; the tension too."""
    (height, speed), tension = bounce_errors(name, DT)
    assert height <= EXACT and speed <= 3 * EXACT and tension <= 1e-2


@pytest.mark.parametrize("name", ["undamped", "damped"])
def test_order_through_slack(name):
    """The error falls with dt^2 on average over four halvings, though where an event falls in a step is by chance."""
    steps = [DT * 2**k for k in (4, 0)]
    errors = [bounce_errors(name, dt)[0][0] for dt in steps]
    assert_order(steps, errors, 2, ceiling=EXACT, band=0.15, what=name)


@pytest.mark.parametrize("name", ["undamped", "much damped"])
def test_times_of_slack_are_those_of_the_bounce(name):
    """history.slack gives every time without tension, to a step, and both cells."""
    history = bounce(name, 1e-3)
    events = [(float(t), kind) for t, kind in BOUNCES[name].events(DURATION)]
    starts, ends = ([t for t, kind in events if kind == which] for which in ("slack", "taut"))
    starts = [0.0, *starts] if events[0][1] == "taut" else starts
    assert len(history.slack) == len(starts) and history.success and history.damped_from is not None
    for spell, start, end in zip(history.slack, starts, [*ends, DURATION][: len(starts)], strict=True):
        assert abs(spell.start - start) <= 2.01e-3 and abs(spell.end - end) <= 2.01e-3 and spell.cells == (0, 1)
    loose = (history.tension <= 0).any(axis=0)
    inside = [any(a.start <= t <= a.end for a in history.slack) for t in history.time]
    assert np.array_equal(loose, inside) and (history.tension >= 0).all()


def test_a_taut_line_has_no_slack():
    """Neither times nor damping of the shortest waves where no cell goes slack."""
    history = solve_time_domain(build(replace(OC3, amplitude=(2.0, 0.0, 0.0)), 10), dt=0.2, periods=1)
    assert history.slack == () and history.damped_from is None and history.tension.min() > 0


# ---------------------------------------------------------------- a line in large surge
SNAPS = 5e-3  # of the greatest tension, over meshes and steps; measured 1.5e-3


@cache
def greatest_tension(amplitude, cells, dt) -> float:
    """Return the greatest fairlead tension in the third period of a surge, N; no step is given up."""
    history = solve_time_domain(build(replace(OC3, amplitude=(amplitude, 0.0, 0.0)), cells), dt=dt, periods=3)
    assert history.success and history.event is None
    assert len(history.slack) >= 3 and history.slack[-1].start > 40
    assert abs(history.damped_from - history.slack[0].start) <= dt * (1 + 1e-9)  # within the first step or at its end
    assert history.tension.min() == 0.0
    return float(history.fairlead_tension(np.linspace(40.0, 60.0, 4001)).max())


@pytest.mark.parametrize("amplitude", [12.0, 16.0])
def test_the_greatest_tension_does_not_depend_on_mesh_and_step(amplitude, deep):
    """A line that is slack for a third of each period snaps with the same tension on all meshes, with any step."""
    tensions = {
        (cells, dt): greatest_tension(amplitude, cells, dt)
        for cells in ((25, 50, 100, 200) if deep else (25, 50))
        for dt in (0.1, 0.05, *((0.025,) if deep else ()))
    }
    values = np.array(list(tensions.values()))
    assert np.ptp(values) <= SNAPS * values.mean(), tensions


def test_steps_that_fail_are_taken_again():
    """With steps too long for a snap some are taken in parts, none is given up, and the tension is nearly that."""
    history = solve_time_domain(build(replace(OC3, amplitude=(16.0, 0.0, 0.0)), 50), dt=0.25, periods=3)
    assert history.success and history.cut > 0 and history.steps == 240
    tension = history.fairlead_tension(np.linspace(40.0, 60.0, 4001)).max()
    assert abs(tension / greatest_tension(16.0, 50, 0.1) - 1) < 0.02


def test_slack_is_more_with_more_surge():
    """The tension grows by more than in proportion, and so does the time without any."""
    assert greatest_tension(16.0, 25, 0.1) > 1.25 * greatest_tension(12.0, 25, 0.1)


@pytest.mark.parametrize("every", [2, 3, 7])
def test_states_are_kept_at_their_times(every):
    """Every n-th step is kept as it is, though the loop over the steps stops where a cell goes slack."""
    moved = build(replace(OC3, amplitude=(12.0, 0.0, 0.0)), 50)  # before the slack line forgets where it came from
    whole, part = (solve_time_domain(moved, dt=0.1, periods=0.49, tolerance=1e-10, every=n) for n in (1, every))
    kept = [*range(0, whole.steps, every), whole.steps]
    assert whole.damped_from < 9.2 and np.allclose(part.time, whole.time[kept], rtol=1e-12)
    assert abs(part.y - whole.y[..., kept]).max() <= 1e-5 and abs(part.ydot - whole.ydot[..., kept]).max() <= 1e-4


def test_slack_alone_takes_no_step_again():
    """Where the steps succeed, the change to the damped scheme is none of those that are cut."""
    assert bounce("undamped", 1e-3).cut == 0


# ---------------------------------------------------------------- what steps leave
LEFT = {  # unstretched length over chord, surge in m, seabed stiffness in N/m^2; what may be left, over the tension
    "a stiff line in the water": (1.1, 4.0, None, 1e-5),  # measured 7e-7; 5e-3 where slack cells may stretch
    "a stiff line over a seabed": (1.1, 4.0, 1e5, 1e-4),  # measured 7e-6; 6e-3 where contact does not count
    "a stiff line that lies slack": (1.2, 6.0, 1e5, 1e-4),  # measured 2e-6; 2e-3 where positions may err with tensions
}


@pytest.mark.parametrize("name", LEFT)
def test_steps_of_slack_lines_end_in_balance(name):
    """At free nodes no force is left when a step of a stiff line that goes slack ends, with the default tolerance."""
    slackness, surge, stiffness, most = LEFT[name]
    cable = CableProperties(1e10, 0.1, 60.0, 400.0, Cdn=1.2, Ca=1.0)
    bed = {} if stiffness is None else {"depth": 60.0, "seabed_stiffness": stiffness}
    nodes = [Node("fixed", (0.0, 0.0, -60.0)), Node("coupled", (200.0, 0.0, -12.0))]
    length = float(np.hypot(200.0, 48.0)) * slackness
    network = Network(nodes, [Element(400.0, cable.EA, length, (0, 1), 0.3, cable=cable)], Environment(1025.0, **bed))
    motion = Motion.harmonic(1 / 8, (surge, 0.0, surge / 2))
    system = mooring_system(network, 5, motion=motion, calibrate=False)
    history = solve_time_domain(system, dt=0.2, periods=2)
    assert history.slack
    left = np.linalg.norm(history.forces[:, 1:-1, 1:], axis=0).max()
    assert left <= most * history.tension.max()


def test_the_law_after_a_step_is_that_of_elastic_damped_cells():
    """Strain and its rate where the step has been taken, by numpy: taut cells and slack ones, that open or close."""
    state, rng = random_state("tension and damping", 3), np.random.default_rng(5)
    line, step = state.line, 0.1 * rng.normal(size=state.r.shape)
    d, opening = (np.diff(part - by * step, axis=0) for part, by in ((state.r, 1.0), (state.v, 2.5)))
    distance = np.linalg.norm(d, axis=1)
    wanted = line.EA * (
        distance / line.length - 1 + line.damping * (d * opening).sum(axis=1) / (distance * line.length)
    )
    got = [law_after_step(line, c, state.r, state.v, step, 2.5) for c in range(line.length.size)]
    assert min(wanted) < 0 < max(wanted) and got == pytest.approx(wanted, rel=1e-12)
