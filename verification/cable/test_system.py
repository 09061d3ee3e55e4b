"""Is a cable changed in its mesh, motion, loads or order the one that is built so at once?"""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest

from solvers import CableSystem, Motion, Status, solve_static
from solvers.cable.mesh import every_second_node, refine, trapezoidal_weights

from ..cases.cables import EVERYTHING, OC3_SEABED, SURGE_5
from .problems import graded, random_state, system

CASES = pytest.mark.parametrize("case", [SURGE_5, OC3_SEABED, EVERYTHING], ids=lambda case: case.name)


def assert_same_cable(got, wanted, seed=4):
    """Rows with their tangents, drift, positions and rest state agree bit for bit."""
    assert np.array_equal(got.s, wanted.s) and got.fields == wanted.fields and got.period == wanted.period
    y, ydot = random_state(wanted, seed)
    for rows in ("start", "cells", "end"):
        for part, other in zip(getattr(got, rows)(y, ydot, 1.3), getattr(wanted, rows)(y, ydot, 1.3), strict=True):
            assert np.array_equal(part, other)
    for output in (
        lambda chain: chain.drift(y, 1.3),
        lambda chain: chain.positions(y),
        lambda chain: chain.rest_state(),
    ):
        assert np.array_equal(output(got), output(wanted))


@CASES
def test_a_cable_on_another_mesh_is_the_one_built_on_it(case):
    """Its equilibrium, too, is that of the new mesh."""
    mesh = graded(case.length, 13)
    chain = system(case, 9)
    chain.rest_state()
    assert_same_cable(chain.on_mesh(mesh), system(case, mesh=mesh))
    assert chain.nodes == 9 and chain.rest_state().shape[1] == 9


@CASES
def test_a_changed_motion_keeps_the_equilibrium(case):
    """One equilibrium is solved for, and shared by the cables of a continuation, a ramp and a deferred correction."""
    chain = system(case, 9, motion=Motion.harmonic(0.1, (1.0, 0.0, 0.5)))
    for changed in (chain.scaled(0.5), chain.ramped(5.0), chain.fourth_order(), chain.ramped(5.0).fourth_order()):
        assert changed.rest_state() is chain.rest_state()
        assert changed.period == chain.period
    t = np.linspace(0.0, 9.0, 5)
    assert np.array_equal(chain.scaled(0.5).motion.velocity(t), 0.5 * chain.motion.velocity(t))
    assert chain.replace(motion=Motion.harmonic(0.2, (1.0, 0.0, 0.0))).period == 5.0
    assert chain.replace(motion=None).period is None


def test_changed_loads_take_a_new_equilibrium():
    """Half the current or half the stiffness of the seabed: that of a scene with half of it."""
    case = EVERYTHING
    chain = system(case, 9)
    chain.rest_state()
    half = tuple(0.5 * part for part in case.current)
    wanted = system(replace(case, current=half), 9)
    assert_same_cable(chain.replace(current=0.5 * chain.current), wanted)
    softer = chain.replace(seabed_stiffness=0.5 * case.seabed_stiffness)
    assert_same_cable(softer, system(replace(case, seabed_stiffness=0.5 * case.seabed_stiffness), 9))


def test_a_source_goes_with_every_second_node():
    """The coarser cable takes the source and the equilibrium of the nodes that are left."""
    chain = system(SURGE_5, 21)
    source = lambda t: np.outer(np.ones(4), np.arange(21.0))
    fine = chain.replace(source=source, equilibrium=chain.equilibrium)
    coarse, _ = fine.coarser()
    assert np.array_equal(coarse.source(0.0)[0], np.arange(0, 21, 2))
    assert np.array_equal(coarse.rest_state(), chain.rest_state()[:, ::2])


def test_drift_is_that_of_the_last_position_on_any_mesh():
    """Where cells differ, too, the drift of the end is that of the positions of the nodes."""
    chain = system(replace(SURGE_5, amplitude=None), mesh=graded(SURGE_5.length, 9))
    y, _ = random_state(chain, 3)
    off = chain.positions(y)[:, -1] - chain.scene.fairlead
    assert abs(chain.axes.T @ chain.drift(y, 0.0) - off).max() <= 1e-12 * chain.s[-1]


@CASES
def test_the_drift_of_a_corrected_cable_is_the_end_of_its_positions(case):
    """Both by the integral of fourth order, on a mesh whose cells differ."""
    chain = system(replace(case, amplitude=None), mesh=graded(case.length, 9)).fourth_order()
    y, _ = random_state(chain, 3)
    off = chain.positions(y)[:, -1] - chain.scene.fairlead
    assert abs(chain.axes @ off - chain.drift(y, 0.0)).max() <= 1e-12 * chain.s[-1]
    assert abs(off - (system(case, mesh=chain.s).positions(y)[:, -1] - chain.scene.fairlead)).max() > 1e-3


class Heavy(CableSystem):
    """A kind of cable of its own."""


def test_a_kind_of_cable_stays_what_it_is():
    """A subclass, and what was solved for, survive changes and pickling."""
    chain = system(SURGE_5, 9)
    chain.__class__ = Heavy
    for changed in (chain.ramped(1.0), chain.on_mesh(chain.s[::2]), chain.fourth_order()):
        assert type(changed) is Heavy
    copy = pickle.loads(pickle.dumps(chain.fourth_order()))
    assert type(copy) is Heavy and copy.is_fourth_order
    assert np.array_equal(copy.rest_state(), solve_static(chain).y)


def test_what_is_invalid_is_named_with_its_node():
    """Compression where a strain is below zero, however little; overstretched above 0.3; the worst node and sample."""
    chain = system(SURGE_5, 9)
    y = np.zeros((4, 9, 3))
    assert chain.invalid(y) is None
    y[0, 4, 1] = 0.3
    assert chain.invalid(y) is None
    y[0, 6, 2] = 0.3001
    assert chain.invalid(y) == (Status.OVERSTRETCHED, 6)
    y[0, 2, 0], y[0, 3, 1] = -1e-300, -2e-300
    assert chain.invalid(y) == (Status.COMPRESSION, 3)


# ---------------------------------------------------------------- meshes
def test_meshes_are_cut_and_thinned_at_their_nodes():
    """refine keeps each node and cuts cells evenly; every_second_node keeps both ends; weights are the trapezoid's."""
    s = graded(100.0, 6)
    fine = refine(s, 3)
    assert fine.size == 16 and np.array_equal(fine[::3], s)
    assert np.diff(fine)[:3] == pytest.approx(np.diff(s)[0] / 3, rel=1e-12)
    assert every_second_node(6).tolist() == [0, 2, 4, 5] and every_second_node(7).tolist() == [0, 2, 4, 6]
    q = np.random.default_rng(1).normal(size=6)
    assert trapezoidal_weights(np.diff(s)) @ q == pytest.approx(np.trapezoid(q, s), rel=1e-13)
