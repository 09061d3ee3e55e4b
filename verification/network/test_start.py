"""Is the start of a network the one that it is meant to be? Net of springs, stages of softness."""

from __future__ import annotations

import numpy as np
import pytest

from solvers import Element, Environment, Network, Node
from solvers.network import start
from solvers.network.nested import Count

ANCHORS = ((0.0, 0.0, -50.0), (90.0, 0.0, -40.0), (30.0, 60.0, -45.0))
LENGTHS = (80.0, 100.0, 50.0)


def star(w=10.0, EA=1e6, force=(0.0, 0.0, 0.0), depth=None):
    """Return the equations of a node on three lines to fixed nodes; its own position says nothing."""
    nodes = [*(Node("fixed", r) for r in ANCHORS), Node("free", (1e3, -1e3, 1e3), force=force)]
    lines = [Element(w, EA, L, (i, 3)) for i, L in enumerate(LENGTHS)]
    return Network(nodes, lines, Environment(depth=depth)).equations


@pytest.mark.parametrize(("w", "force"), [(0.0, (0.0, 0.0, 0.0)), (10.0, (0.0, 0.0, 0.0)), (10.0, (3e3, -2e3, 5e3))])
def test_a_net_of_springs_is_the_start(w, force):
    """Of stiffness 1/L each, under the loads as parts of all of them; half of each line's weight acts at either end."""
    load = np.array([*np.zeros((3, 3)), force])
    weight = w * np.array(LENGTHS) / 2
    load[:3, 2] -= weight
    load[3, 2] -= weight.sum()
    density = 1 / np.array(LENGTHS)
    expected = (density @ np.array(ANCHORS) + load[3] / (np.abs(load).sum() or 1.0)) / density.sum()
    r = start.force_density(star(w, force=force))
    assert r[:3].tolist() == [list(anchor) for anchor in ANCHORS]
    assert r[3] == pytest.approx(expected, rel=1e-14)


def test_a_network_without_free_nodes_starts_where_it_is():
    network = Network([Node("fixed", ANCHORS[0]), Node("coupled", ANCHORS[1])], [Element(10.0, 1e6, 95.0, (0, 1))])
    assert start.force_density(network.equations).tolist() == [list(ANCHORS[0]), list(ANCHORS[1])]


@pytest.mark.parametrize(
    ("strain", "stages"),
    [  # total load / EA: the last softness is 1e-3 / 3 at most, a tenth of the strain if that is less
        (1e-1, [1.0, 1e-1, 1e-2, 1e-3]),
        (2e-4, [1.0, 1e-1, 1e-2, 1e-3, 1e-4]),
        (3e-8, [10.0**-k for k in range(9)]),
    ],
)
def test_each_stage_is_a_tenth_as_soft(strain, stages, monkeypatch):
    """Until the lines are about as stiff as they are."""
    softness = []

    class Recorded(start.SoftenedStage):
        def __init__(self, equations, value, contact):
            softness.append(value)
            super().__init__(equations, value, contact)

    monkeypatch.setattr(start, "SoftenedStage", Recorded)
    equations = star(5.0, 10.0 * sum(LENGTHS) / strain, force=(0.0, 0.0, 5.0 * sum(LENGTHS)))
    start.robust_start(equations, Count(), contact=False)
    assert softness == pytest.approx(stages)


def test_a_stage_is_as_soft_as_it_says():
    """Lines and seabed: 1/EA grows by softness/load, and the load of a node sinks it by softness times all lengths."""
    equations, softness = star(w=-10.0, force=(300.0, 0.0, -400.0), depth=60.0), 0.02
    stage = start.SoftenedStage(equations, softness, contact=True)
    total, at_node = 10.0 * sum(LENGTHS) + 700.0, 10.0 * sum(LENGTHS) / 2 + 700.0
    assert stage.EA == pytest.approx(1 / (1e-6 + softness / total), rel=1e-14) and stage.heaviest == at_node
    assert stage.spring == pytest.approx([0.0, 0.0, 0.0, at_node / (softness * sum(LENGTHS))], rel=1e-14)


@pytest.mark.parametrize("contact", [True, False])
@pytest.mark.parametrize("dense", [True, False])
@pytest.mark.parametrize("z", [-55.0, -60.5, -61.5])
def test_the_tangent_of_a_stage_is_its_derivative(contact, dense, z, monkeypatch):
    """Above the seabed, and sunk into it; with contact the ends of lines at a sunk node keep their height."""
    if not dense:
        monkeypatch.setattr("solvers.network.equations.MAX_DENSE", 0)
    stage = start.SoftenedStage(star(force=(0.0, 0.0, 2e3), depth=60.0), 0.02, contact)
    r = np.array([*ANCHORS, (35.0, 20.0, z)])
    force = lambda r: stage.unbalanced_force(stage.solve_elements(r))[3]
    slope = []
    for step in 1e-4 * np.eye(3):
        change = np.vstack([np.zeros((3, 3)), step])
        slope.append((force(r + change) - force(r - change)) / 2e-4)
    tangent = stage.tangent(stage.solve_elements(r))
    tangent = tangent if dense else tangent.toarray()
    sunk = contact and z < -60.0  # the lines' reaction to their own height is left to the seabed
    rows = slice(2) if sunk else slice(3)
    assert tangent[rows] == pytest.approx(-np.array(slope).T[rows], rel=1e-6, abs=1e-6 * np.abs(tangent).max())
    assert not sunk or tangent[2].tolist() == [0.0, 0.0, stage.spring[3]]


@pytest.mark.parametrize("contact", [True, False])
def test_the_start_is_near_the_equilibrium(contact):
    """Within a hundredth of the lines of the balance, however far off the node's own position is."""
    equations = star(force=(0.0, 0.0, 2e3), depth=60.0)
    r = start.robust_start(equations, Count(), contact)
    unbalanced = equations.unbalanced_force(equations.solve_elements(r))[3]
    assert np.abs(unbalanced).max() <= 0.05 * 2e3 and r[3, 2] > -60.0
