"""Is a line what it was given as: arrays of its cells and nodes, its mesh, its axes, and are bad inputs refused?"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from importlib.resources import files

import numpy as np
import pytest

from solvers import (
    CableProperties,
    Element,
    Environment,
    FunctionMotion,
    InputError,
    Motion,
    Network,
    Node,
    Scene,
    mooring_system,
    solve_network,
    solve_static,
    solve_time_domain,
)
from solvers.io import load_network
from solvers.mooring.lines.calibration import estimate_tension_change
from solvers.mooring.lines.mesh import LEAST_DENSITY, TOUCHDOWN_DENSITY, TOUCHDOWN_REACH
from solvers.mooring.lines.model import Segment, build_model

from ..cases.cables import OC3, OC3_SEABED, SLACK_CHAIN, SURGE_5
from ..reference import EPS
from .problems import build, scene

WATER = Environment(1025.0, depth=100.0, seabed_stiffness=4e4, seabed_damping=3e3, current=(0.3, 0.0, 0.1))
CHAIN = CableProperties(5e8, 0.1, 120.0, Cdn=1.3, Cdt=0.2, Ca=0.9, damping=0.01)
ROPE = CableProperties(3e7, 0.2, 40.0, Cdn=1.1, Cdt=0.1, Ca=1.1, damping=0.05)


def two_parts(**changes):
    """Return a Network of chain and rope with a buoy at the joint and a clump at the fairlead, the rope backward."""
    nodes = [
        Node("coupled", (180.0, 0.0, -10.0), mass=500.0, volume=0.1, force=(0.0, 0.0, 50.0)),
        Node("fixed", (0.0, 0.0, -100.0)),
        Node("free", (90.0, 0.0, -80.0), mass=3e3, volume=4.0, force=(200.0, 0.0, 100.0)),
    ]
    chain, rope = (cable.weight_in(WATER) for cable in (CHAIN, ROPE))
    elements = [Element(rope, ROPE.EA, 110.0, (0, 2), cable=ROPE),
                Element(chain, CHAIN.EA, 120.0, (1, 2), 0.7, cable=CHAIN)]  # fmt: skip
    return Network(**({"nodes": nodes, "elements": elements, "environment": WATER} | changes))


# ---------------------------------------------------------------- arrays
def test_arrays_of_a_line_of_two_materials():
    """By hand: 3 cells of chain of 40 m, 2 of rope of 55 m, from the anchor; halves of both at the joint."""
    s = np.array([0.0, 40.0, 80.0, 120.0, 175.0, 230.0])
    system = mooring_system(two_parts(), mesh=s, slip_speed=0.2, calibrate=False)
    line, chain = system.line, np.array([True] * 3 + [False] * 2)
    of = lambda name: np.where(chain, getattr(CHAIN, name), getattr(ROPE, name))
    assert np.array_equal(line.length, [40.0] * 3 + [55.0] * 2) and np.array_equal(system.s, s)
    for name, field in (("EA", "EA"), ("damping", "damping"), ("mass", "mass_per_length")):
        assert np.array_equal(getattr(line, name), of(field))
    d = of("diameter")
    assert np.allclose(line.added_mass, of("Ca") * 1025.0 * math.pi * d**2 / 4, rtol=4 * EPS, atol=0)
    assert np.allclose(line.normal_drag, 0.5 * 1025.0 * d * of("Cdn"), rtol=4 * EPS, atol=0)
    assert np.allclose(line.tangential_drag, 0.5 * 1025.0 * math.pi * d * of("Cdt"), rtol=4 * EPS, atol=0)
    share = np.array([20.0, 40.0, 40.0, 47.5, 55.0, 27.5])
    assert np.allclose(line.seabed_stiffness, 4e4 * share, rtol=4 * EPS, atol=0)
    assert np.allclose(line.seabed_damping, 3e3 * share, rtol=4 * EPS, atol=0)
    assert np.allclose(line.friction, [0.7, 0.7, 0.7, 0.7 * 20 / 47.5, 0.0, 0.0], rtol=4 * EPS, atol=0)
    assert np.array_equal(line.point_mass, [0, 0, 0, 3e3, 0, 500.0])
    g, chain_w, rope_w = 9.80665, CHAIN.weight_in(WATER), ROPE.weight_in(WATER)
    up = -np.array([20 * chain_w, 40 * chain_w, 40 * chain_w, 20 * chain_w + 27.5 * rope_w, 55 * rope_w, 27.5 * rope_w])
    up[3] += 100.0 - g * (3e3 - 1025.0 * 4.0)
    up[5] += 50.0 - g * (500.0 - 1025.0 * 0.1)
    assert np.allclose(line.load[:, -1], up, rtol=1e-14, atol=0)
    assert np.array_equal(line.load[:, 0], [0, 0, 0, 200.0, 0, 0])
    assert line.floor == -100.0 and line.slip_speed == 0.2 and line.current == (0.3, 0.1)
    assert system.prescribed_nodes.tolist() == [0, 5] and system.fields == ("along", "z") and system.nodes == 6
    assert [point.kind for point in system.model.points] == ["fixed", "free", "coupled"]
    assert system.model.length == 230.0 and system.period is None


def test_the_regularisation_of_the_seabed_stays_with_what_is_made_of_a_system():
    """Coarser lines, another motion, end cells and parts of a network have slip speed and contact depth."""
    system = mooring_system(two_parts(), 12, slip_speed=0.2, contact_depth=0.03)
    three = load_network(files("reference_data") / "scenes" / "networks" / "oc3_moving.toml")
    parts = [part.system for part in mooring_system(three, 8, slip_speed=0.2, contact_depth=0.03).components]
    lines = [one.line for one in (system, system.coarser()[0], system.with_motion(None), *parts)]
    lines += [system.end_cell(-1, element)[0] for element in (None, 1)]
    assert len(parts) == 3 and {(line.slip_speed, line.contact_depth) for line in lines} == {(0.2, 0.03)}
    assert mooring_system(two_parts(), 12).line.contact_depth == 0.0


def test_without_a_seabed_nothing_bears():
    """Neither stiffness nor damping nor a floor, in still water; the weight is that of the section or as given."""
    line = build(OC3, 10).line
    assert not line.seabed_stiffness.any() and not line.seabed_damping.any() and line.floor == -math.inf
    assert line.current == (0.0, 0.0) and abs(-line.load[:, -1].sum() / (698.094 * 902.2) - 1) < 1e-14
    bed = build(replace(OC3_SEABED, seabed_stiffness=0.0), 10).line
    assert not bed.seabed_stiffness.any() and not bed.seabed_damping.any()
    friction = build(OC3_SEABED, 10).line.friction
    assert not friction.any()
    rough = replace(scene(OC3_SEABED), friction=(0.6, 0.2))
    assert np.allclose(mooring_system(rough, 10).line.friction, 0.6, rtol=4 * EPS)


@pytest.mark.parametrize(
    ("case", "fields"),
    [
        (OC3, ("along", "z")),
        (OC3.turned(1.1), ("along", "z")),
        (SURGE_5.turned(-2.0), ("along", "z")),
        (replace(OC3, current=(0.1, 0.2, 0.0)), ("x", "y", "z")),
        (replace(OC3, amplitude=(0.0, 1.0, 0.0)), ("x", "y", "z")),
        (SLACK_CHAIN, ("x", "y", "z")),
    ],
    ids=["at rest", "turned", "surge, turned", "side current", "sway", "current"],
)
def test_axes_are_those_that_the_motion_needs(case, fields):
    """Planar where line, current and motion lie in one vertical plane; positions go there and back."""
    system = build(case, 8)
    assert system.fields == fields
    rng = np.random.default_rng(1)
    y = rng.normal(0, 50, (len(fields), 8, 3))
    assert abs(system.to_axes(system.positions(y)) - y).max() <= 100 * EPS * 50
    path = system.path(np.array([0.0, 3.0]))
    moved = 0.0 if case.amplitude is None else system.motion.displacement(np.array([0.0, 3.0]))
    wanted = np.array(case.fairlead)[:, None] + moved
    assert abs(system.positions(path[:, 0, 1].T) - wanted).max() <= 1e-12 * case.length
    assert abs(system.positions(path[:, 0, 0].T) - np.array(case.anchor)[:, None]).max() <= 1e-12 * case.length


def test_the_path_has_the_rates_of_the_motion():
    """Rates of the last node are those of the motion, whether it gives an acceleration or not."""
    motion = Motion.harmonic(0.1, (2.0, 0.0, 1.0), (0.3, 0.0, 1.0))
    plain = FunctionMotion(motion.displacement, motion.velocity)
    t = np.linspace(0, 7.0, 30)
    for given, error in ((motion, 1e-13), (plain, 1e-8)):
        system = build(OC3, 8, motion=given)
        path = system.path(t)
        for order, exact in enumerate((motion.displacement(t), motion.velocity(t), motion.acceleration(t))):
            wanted = system.axes @ (exact + (np.array(OC3.fairlead)[:, None] if order == 0 else 0.0))
            assert abs(path[:, order, 1] - wanted.T).max() <= error * max(1.0, abs(wanted).max())
        assert not path[:, 1:, 0].any()
        alone = np.stack([system.path(t[i : i + 1])[0, 2, 1] for i in range(3, 9)])
        assert abs(alone - path[3:9, 2, 1]).max() <= error  # at one time alone too


def test_a_segment_may_run_backward():
    """Positions and tensions along it are those of the same segment forward, and fit its ends."""
    forward = Segment(900.0, 5e8, 130.0, 0.0, CHAIN)
    start, end, s = np.array([0.0, 0.0, -50.0]), np.array([80.0, 30.0, -10.0]), np.linspace(0, 130.0, 14)
    (r, T, _), (other, tension, _) = (
        replace(forward, reversed=turned).profile(start, end, Environment(), s) for turned in (False, True)
    )
    assert abs(r - other).max() <= 1e-9 and abs(T - tension).max() <= 1e-9 * T.max()
    assert abs(other[:, [0, -1]].T - [start, end]).max() <= 1e-9 and tension[-1] > tension[0]


def test_a_ring_beside_a_line_is_no_line():
    """It has two loose ends and an element less than nodes, as a line has, but the line does not pass through all."""
    nodes = [Node("fixed", (10.0 * i, 3.0 * i * i, -50.0)) for i in range(5)]
    elements = [Element(CHAIN.weight_in(WATER), CHAIN.EA, 100.0, ends, cable=CHAIN)
                for ends in ((0, 1), (2, 3), (3, 4), (4, 2))]  # fmt: skip
    model = build_model(Network(nodes, elements, WATER))
    assert not model.is_line and len(model.segments) == 4 and [p.r for p in model.points] == [n.r for n in nodes]


# ---------------------------------------------------------------- meshes
@pytest.mark.parametrize("cells", [2, 3, 7, 50])
@pytest.mark.parametrize("mesh", ["uniform", "fitted"])
def test_meshes_have_their_cells_and_joints(cells, mesh):
    """As many cells as asked for, from 0 to the length, with a node at each joint exactly."""
    s = mooring_system(two_parts(), cells, mesh=mesh).s
    assert s.size == cells + 1 and s[0] == 0.0 and s[-1] == 230.0 and 120.0 in s and (np.diff(s) > 0).all()
    one = build(OC3_SEABED, cells, mesh=mesh).s
    assert one.size == cells + 1 and one[-1] == OC3_SEABED.length
    if mesh == "uniform":
        assert np.allclose(np.diff(one), OC3_SEABED.length / cells, rtol=1e-12)


def test_a_uniform_mesh_shares_its_cells():
    """Cells of 10 m for 100 m and 50 m of two materials."""
    parts = [(CHAIN, 100.0), (ROPE, 50.0)]
    nodes = [Node("fixed", (0.0, 0.0, 0.0)), Node("free", (90.0, 0.0, 0.0)), Node("coupled", (149.0, 0.0, 0.0))]
    network = Network(nodes, [Element(c.weight_in(WATER), c.EA, L, (i, i + 1), cable=c)
                              for i, (c, L) in enumerate(parts)], Environment())  # fmt: skip
    assert np.allclose(np.diff(mooring_system(network, 15, mesh="uniform").s), 10.0, rtol=1e-12)


def grounded_length(system, surge=0.0):
    """Return how much of a line of one material rests on the seabed with its fairlead moved along x, m."""
    model = system.model
    start, end = (np.array(point.r) for point in model.points)
    profile = model.segments[0].profile(start, end + [surge, 0.0, 0.0], model.environment, np.zeros(1))
    return profile[2].grounded_length


NEAR = 0.02  # relative: density within a cell of some metres
LYING = replace(SLACK_CHAIN, name="slack chain in still water", current=(0.0, 0.0, 0.0), amplitude=None)


def test_a_fitted_mesh_is_dense_where_the_line_bends():
    """As the square root of the curvature w H/T^2 from the touchdown on; before it as sparse as the limit allows."""
    system = build(LYING, 40)
    cells, middles, rests = np.diff(system.s), (system.s[1:] + system.s[:-1]) / 2, grounded_length(system)
    finest = cells[middles > rests + 2].min()
    assert abs(cells[system.s[1:] < rests - 5] * LEAST_DENSITY / finest - 1).max() < 0.02
    state = system.solve_static()
    hanging = middles > rests + 10
    wanted = state.tension[hanging]
    assert abs(cells[hanging] / wanted / (cells[hanging] / wanted).mean() - 1).max() < 0.01


def test_a_fitted_mesh_covers_the_travel_of_the_touchdown():
    """With a motion the fine cells begin at the nearest touchdown of its period."""
    for surge in (0.0, 3.0):
        system = build(replace(LYING, amplitude=(surge, 0.0, 0.0) if surge else None), 40)
        fine = system.s[:-1][np.diff(system.s) < 2 * np.diff(system.s).min()]
        assert -12 < fine[0] - grounded_length(system, surge) < 12
        assert surge == 0 or fine[0] < grounded_length(system) - 5


def test_a_touchdown_mesh_is_dense_where_the_touchdown_travels():
    """Beside a fitted mesh, a surplus of TOUCHDOWN_DENSITY there, half of it a reach away; of a hanging line none."""
    system, fitted = (build(replace(LYING, amplitude=(3.0, 0.0, 0.0)), 400, mesh=m) for m in ("touchdown", "fitted"))
    nearest, farthest = sorted(grounded_length(system, surge) for surge in (-3.0, 3.0))
    reach = TOUCHDOWN_REACH * system.s[-1]

    at = np.array([(nearest + farthest) / 2, farthest + reach, farthest + 6 * reach])
    dense, usual = (np.interp(at, (m.s[1:] + m.s[:-1]) / 2, 1 / np.diff(m.s)) for m in (system, fitted))
    by_curvature = usual * np.diff(fitted.s).min()  # of the greatest density
    surplus = TOUCHDOWN_DENSITY / np.array([1, 2, 7])
    assert dense / dense[0] == pytest.approx((by_curvature + surplus) / (by_curvature + surplus)[0], rel=NEAR)
    hanging = replace(OC3, amplitude=(3.0, 0.0, 0.0))
    assert np.array_equal(build(hanging, 40, mesh="touchdown").s, build(hanging, 40).s)


def test_a_mesh_is_taken_as_given():
    """Arc lengths of a list or an array; rounding at a joint is taken for the joint."""
    s = np.array([0.0, 100.0, 120.0 + 1e-11, 200.0, 230.0])
    moved = mooring_system(two_parts(), mesh=s).s
    assert abs(moved - s).max() <= 1.01e-11 and abs(moved[2] - s[2]) <= 1.01e-11
    assert np.array_equal(mooring_system(two_parts(), mesh=s.round(9)).s, s.round(9))


# ---------------------------------------------------------------- refused
SURGE = partial(build, SURGE_5, 10)
RUN = {"dt": 0.5, "periods": 1}


def run(**changes):
    """Integrate a line that moves with some options changed; None leaves one out."""
    options = {name: value for name, value in (RUN | changes).items() if value is not None}
    return solve_time_domain(SURGE(), **options)


def without(**changes):
    """Return a Scene of the OC3 line with its cable or environment changed."""
    given = scene(OC3_SEABED)
    for name in ("diameter", "mass_per_length"):
        if name in changes:
            given = replace(given, cable=replace(given.cable, submerged_weight=698.0, **{name: changes.pop(name)}))
    return replace(given, **changes)


def test_the_pretension_is_that_at_the_fairlead_however_the_last_element_runs():
    """Given from the fairlead down, its tension there is not the one at its own upper end, and the change as large."""
    rope, chain = two_parts().elements
    chain = replace(chain, friction=0.0)  # a moving line has none at rest
    backward, forward = (two_parts(elements=[replace(rope, ends=ends), chain]) for ends in ((0, 2), (2, 0)))
    models, surge = (
        [build_model(network) for network in (backward, forward)],
        Motion.harmonic(0.1, (2.0, 0.0, 0.0)),
    )
    assert [model.segments[-1].reversed for model in models] == [True, False]
    state = solve_network(forward)
    assert models[1].pretension() == pytest.approx(np.hypot(state.H[0], state.V[0]), rel=1e-9)
    for value in (lambda model: model.pretension(), lambda model: estimate_tension_change(model, surge, 8)):
        assert value(models[0]) == pytest.approx(value(models[1]), rel=1e-9)


def without_section():
    """Return a Network of which one element has no section for dynamics."""
    first, second = two_parts().elements
    return two_parts(elements=[replace(first, cable=None), second])


REFUSED = {
    # what is done; the field, words of the message
    "no scene": (lambda: mooring_system(3.0), "scene", ["3.0", "Scene", "Network"]),
    "no diameter": (lambda: mooring_system(without(diameter=None)), "diameter", ["m", "not given"]),
    "no mass": (lambda: mooring_system(without(mass_per_length=None)), "mass_per_length", ["kg/m", "not given"]),
    "a rigid seabed": (
        lambda: mooring_system(without(environment=Environment(depth=320.0))), "seabed_stiffness", ["N/m^2"]),
    "no section": (lambda: mooring_system(without_section()), "elements[0].cable", ["not given"]),
    "no motion": (lambda: SURGE(motion=3.0), "motion", ["3.0"]),
    "cells of a float": (lambda: build(OC3, 10.0), "cells", ["10.0", "whole number"]),
    "one cell": (lambda: build(OC3, 1), "cells", ["1", "from 2"]),
    "fewer cells than materials": (lambda: mooring_system(two_parts(), 1), "cells", ["1", "2"]),
    "a mesh of no name": (lambda: SURGE(mesh="fine"), "mesh", ["'fine'", "uniform", "m"]),
    "a mesh of words": (lambda: SURGE(mesh=["a", "b", "c"]), "mesh", ["arc lengths", "m"]),
    "a falling mesh": (lambda: SURGE(mesh=[0.0, 500.0, 400.0, 902.2]), "mesh", ["increasing", "m"]),
    "a mesh of two nodes": (lambda: SURGE(mesh=[0.0, 902.2]), "mesh", ["three"]),
    "a mesh that is too short": (lambda: SURGE(mesh=[0.0, 100.0, 900.0]), "mesh", ["902.2 m"]),
    "a mesh that is too long": (lambda: SURGE(mesh=[0.0, 902.2, 910.0]), "mesh", ["902.2 m"]),
    "a mesh that misses a joint": (
        lambda: mooring_system(two_parts(), mesh=[0.0, 100.0, 230.0]), "mesh", ["joint", "120 m"]),
    "a mesh that is not finite": (lambda: SURGE(mesh=[0.0, math.nan, 902.2]), "mesh", ["finite"]),
    "fields of no name": (lambda: SURGE(fields="flat"), "fields", ["'flat'", "planar"]),
    "a plane that is left": (lambda: build(replace(OC3, amplitude=(0, 1.0, 0)), fields="planar"), "fields", ["plane"]),
    "no slip speed": (lambda: SURGE(slip_speed=0.0), "slip_speed", ["0", "m/s", "> 0"]),
    "a negative contact depth": (lambda: SURGE(contact_depth=-0.1), "contact_depth", ["-0.1", "m"]),
    "calibrate": (lambda: SURGE(calibrate="yes"), "calibrate", ["'yes'", "auto"]),
    "calibrated over a seabed": (lambda: build(OC3_SEABED, calibrate=True), "calibrate", ["seabed"]),
    "no dt": (lambda: run(dt=0.0), "dt", ["0", "s", "> 0"]),
    "dt beyond the end": (lambda: run(dt=30.0), "dt", ["30 s", "20 s"]),
    "too many steps": (lambda: run(dt=1e-12), "dt", ["1e-12", "1e+09 steps"]),
    "no end": (lambda: run(periods=None), "periods", ["periods", "duration"]),
    "two ends": (lambda: run(duration=3.0), "periods", ["periods", "duration"]),
    "negative periods": (lambda: run(periods=-1), "periods", ["-1", "> 0"]),
    "periods of nothing": (lambda: solve_time_domain(build(OC3, 10), **RUN), "periods", ["no period", "duration"]),
    "a negative duration": (lambda: run(periods=None, duration=-3.0), "duration", ["-3", "s"]),
    "rho_inf": (lambda: run(rho_inf=1.2), "rho_inf", ["1.2", "between 0 and 1"]),
    "tolerance": (lambda: run(tolerance=0.0), "tolerance", ["0", "> 0"]),
    "step_tolerance": (lambda: run(step_tolerance=-1e-3), "step_tolerance", ["-0.001", "> 0"]),
    "ramp": (lambda: run(ramp=-1.0), "ramp", ["-1 s", ">= 0"]),
    "every": (lambda: run(every=0), "every", ["0", "whole number"]),
    "progress": (lambda: run(progress=3), "progress", ["3", "function"]),
    "throw": (lambda: run(throw=1), "throw", ["1", "True or False"]),
    "a start that is none": (lambda: run(start=3.0), "start", ["(y, ydot)"]),
    "a start of words": (lambda: run(start=("a", None)), "start", ["(y, ydot)"]),
    "a start of another shape": (lambda: run(start=(np.zeros((2, 5)), None)), "start", ["(2, 5)", "(2, 11)"]),
    "a start that is not finite": (lambda: run(start=(np.full((2, 11), math.inf), None)), "start", ["finite"]),
    "statics by shooting": (lambda: solve_static(SURGE(), method="shooting"), "method", ["'shooting'", "leave it out"]),
    "a tolerance of statics": (lambda: solve_static(SURGE(), tolerance=1e-3), "tolerance", ["0.001", "leave it out"]),
    "scheme": (lambda: solve_time_domain(SURGE(), **RUN, allow_invalid=True), "allow_invalid", ["True"]),
}  # fmt: skip


def test_a_motion_into_the_seabed_is_refused():
    """With the node, its height and the first time of those that are asked for."""
    system = build(OC3_SEABED, 4, mesh="uniform", motion=Motion.harmonic(0.05, (0.0, 0.0, -260.0)))
    system.path(np.array([0.0, 2.0, 6.0]))
    with pytest.raises(InputError, match=r"node 2 to z = -329\.872 m at t = 4\.9 s, below the seabed at -320 m"):
        system.path(np.array([0.0, 4.9, 5.0]))


@pytest.mark.parametrize("name", REFUSED)
def test_bad_input_is_refused(name, monkeypatch):
    """An InputError with the field, and in its words the value, the unit and what is wanted, before any solve."""
    act, field, words = REFUSED[name]
    for module in ("system", "stepping.time_domain"):
        monkeypatch.setattr(f"solvers.mooring.{module}.solve_rest", lambda *_, **__: pytest.fail("solved"))
    with pytest.raises(InputError) as caught:
        act()
    assert caught.value.field == field
    assert all(word in str(caught.value) for word in words), str(caught.value)


def test_times_outside_a_history_are_refused():
    """With the time and what is stored; so is a last period where none is."""
    history = run(periods=0.5)
    for t in (-0.1, 10.1, [3.0, 11.0]):
        with pytest.raises(InputError, match="outside the history"):
            history.fairlead_tension(t)
    with pytest.raises(InputError, match="real numbers"):
        history.fairlead_tension("now")
    with pytest.raises(InputError, match="no whole period"):
        _ = history.last_period


def test_the_example_of_a_scene():
    """A Scene is taken as its line; a motion may be given in place of its own, and scaled."""
    system = SURGE(motion=Motion.harmonic(0.1, (0.0, 0.0, 1.0)))
    assert system.period == 10.0 and system.scaled(2.0).motion.displacement(2.5)[2] == pytest.approx(2.0)
    assert system.with_motion(None).period == 10.0 and system.with_motion(None).ramped(3.0).motion is None
    assert isinstance(scene(OC3), Scene)


CATENARY = 1e-9
"""Of a force: the statics end at 1e-12 of it, and the last cell's chord divides positions of hundreds of metres."""


def test_elements_of_a_calibrated_line_end_with_the_forces_of_their_catenaries():
    """Where cells and loads make the catenaries the equilibrium, elements have them at the joint as well."""
    system = mooring_system(two_parts(environment=Environment(1025.0)), 12, calibrate=True)
    rest = system.rest_state()[..., None]
    still = np.zeros_like(rest)
    at_rest = system.model.at_rest(system.layout)
    for e, (segment, state) in enumerate(zip(system.model.segments, at_rest.states, strict=True)):
        middles = (system.layout.s[e][1:] + system.layout.s[e][:-1]) / 2
        along = state.profile(segment.length - middles if segment.reversed else middles)[2]
        assert at_rest.tension[system.layout.cells[e]] == pytest.approx(along, rel=CATENARY)
        H, lower, upper = state.H, math.hypot(state.H, state.V_anchor), math.hypot(state.H, state.V)
        wanted = (upper, lower) if segment.reversed else (lower, upper)
        for end, expected in zip((0, -1), wanted, strict=True):
            force = np.linalg.norm(system.end_force(rest, still, still, end, e))
            assert force == pytest.approx(expected, rel=CATENARY), (e, end, H)
