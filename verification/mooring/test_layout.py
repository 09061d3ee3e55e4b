"""Are nodes and cells of any network numbered once, in an order that elimination likes, and does it solve?"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from solvers import mooring_system
from solvers.mooring.lines.coarsening import common_nodes
from solvers.numerics.lu import elimination
from solvers.numerics.lu.block_elimination import BlockFactors

from ..cases import networks as cases
from ..reference import EPS
from .networks import case_network
from .test_network import scene

SOLVED = 1e-10  # of the solution: random blocks, without exchanges of rows between nodes; measured 2e-13
SINGLE = 1e-4  # the same in single precision; measured 2e-6
COUNT = 12  # of the random networks, two to forty elements each


@cache
def network(name):
    """Return a Network of that name: one of the random ones, of the suite's cases or of the scenes."""
    if isinstance(name, int):
        return case_network(cases.random_network(name))
    named = {"bridles": cases.bridle_system(), "net": cases.spring_net(5), "clump": cases.clump_weight()}
    return case_network(named[name]) if name in named else scene(name)


NAMES = ["bridles", "net", "clump", "oc3_three_lines", *range(COUNT)]


def build(name, cells=3):
    """Return the system of a network; its mesh asks for no statics."""
    return mooring_system(network(name), cells, mesh="uniform", fields="spatial", calibrate=False)


@pytest.mark.parametrize("name", NAMES)
def test_every_node_and_cell_has_one_number(name):
    """Numbers run from 0 without a gap; elements that meet share a node, and their cells join nodes along them."""
    system = build(name)
    layout, given, points = system.layout, system.model.segments, system.layout.points
    inner = [nodes[1:-1] for nodes in layout.nodes]
    assert np.array_equal(np.sort(np.concatenate([points, *inner])), np.arange(layout.size))
    assert [(nodes[0], nodes[-1]) for nodes in layout.nodes] == [tuple(points[list(s.ends)]) for s in given]
    for s, nodes, cells in zip(layout.s, layout.nodes, layout.cells, strict=True):
        pairs = np.sort(np.stack([nodes[:-1], nodes[1:]]), axis=0)
        assert np.array_equal(pairs, [layout.first[cells], layout.last[cells]])
        assert np.array_equal(system.line.length[cells], np.diff(s)) and s[0] == 0.0
    assert (layout.first < layout.last).all() and layout.first.size == sum(s.size - 1 for s in layout.s)


@pytest.mark.parametrize("name", NAMES)
def test_elimination_adds_few_blocks(name):
    """At most one a node of an element between two joints, and those of the joints; a line adds none."""
    system = build(name, 8)
    model, layout, order = system.model, system.layout, system.order
    ends = np.array([segment.ends for segment in model.segments])
    degree = np.bincount(ends.ravel(), minlength=len(model.points))
    is_joint = np.array([point.kind == "free" for point in model.points]) & (degree > 2)
    added, between = order.edges - layout.first.size, is_joint.any() * is_joint.sum() * (is_joint.sum() - 1) // 2
    inner = sum(nodes.size - 2 for nodes in layout.nodes) + len(model.points)
    assert added <= (inner if is_joint.sum() > 1 else 0) + between
    if not is_joint.any():
        assert added == 0
    assert layout.points[is_joint].min(initial=layout.size) >= layout.size - is_joint.sum()


@pytest.mark.parametrize("name", NAMES)
def test_any_network_is_eliminated(name):
    """Random blocks, prescribed nodes among them: what numpy solves, in blocks of three and of many rows."""
    system, rng = build(name), np.random.default_rng(7)
    line, order, nodes = system.line, system.order, system.nodes
    free = ~order.is_prescribed
    for m in (3, 5):
        right, left = rng.normal(0, 1, (2, order.edges, m, m)) / m
        right[line.length.size :], left[line.length.size :] = 0.0, 0.0
        diagonal = rng.normal(0, 1, (nodes, m, m)) / m + 3 * degrees(line, nodes)[:, None, None] * np.eye(m)
        x = rng.normal(0, 1, (nodes, m)) * free[:, None]
        wanted = dense_solution(line, order, diagonal, right, left, x)
        if m == 3:
            blocks, solution = (diagonal.copy(), right.copy(), left.copy()), x.copy()
            steps = order._replace(axes=(0.0,) * m)
            elimination.factorise(steps, *blocks, np.empty(m))
            elimination.solve(steps, *blocks, solution, np.empty(m))
        else:
            size = line.length.size
            blocks = prescribed_to_one(diagonal, order), right[:size].copy(), left[:size].copy()
            factors = BlockFactors(order, line.first, line.last, *blocks)
            assert not factors.singular
            solution = factors.solve(x)
        assert abs(solution - wanted).max() <= SOLVED * abs(wanted).max()
        assert not solution[order.is_prescribed].any()


@pytest.mark.parametrize("name", NAMES)
def test_changes_of_prescribed_nodes_are_taken_over(name):
    """The solution has the given values there, and satisfies the rows of the others, in both precisions."""
    system, rng, m = build(name), np.random.default_rng(8), 5
    line, order, nodes = system.line, system.order, system.nodes
    right, left = rng.normal(0, 1, (2, line.length.size, m, m)) / m
    permuted = np.stack([rng.permutation(np.eye(m)) for _ in range(nodes)])  # rows have to be exchanged
    diagonal = rng.normal(0, 1, (nodes, m, m)) / m + 3 * degrees(line, nodes)[:, None, None] * permuted
    diagonal = prescribed_to_one(diagonal, order)
    right[order.is_prescribed[line.first]], left[order.is_prescribed[line.last]] = 0.0, 0.0
    given = rng.normal(0, 1, (nodes, m))
    for real, tolerance in ((float, SOLVED), (np.float32, SINGLE)):
        blocks = (part.astype(real) for part in (diagonal, right, left))
        x = BlockFactors(order, line.first, line.last, *blocks).solve(given)
        assert np.array_equal(x[order.is_prescribed], given[order.is_prescribed].astype(real))
        rows = np.einsum("nij,nj->ni", diagonal, x)
        np.add.at(rows, line.first, np.einsum("nij,nj->ni", right, x[line.last]))
        np.add.at(rows, line.last, np.einsum("nij,nj->ni", left, x[line.first]))
        assert abs(rows - given).max() <= tolerance * abs(given).max()


def test_blocks_that_do_not_fit_are_refused():
    """Compiled loops do not look at their indices: other numbers of nodes, cells and unknowns are refused."""
    system = build("clump")
    line, order, cells = system.line, system.order, system.line.length.size
    blocks = [np.tile(np.eye(3), (count, 1, 1)) for count in (system.nodes, cells, cells)]
    factors = BlockFactors(order, line.first, line.last, *blocks)
    with pytest.raises(ValueError, match="right-hand side"):
        factors.solve(np.zeros((system.nodes, 4)))
    for i in range(3):
        for wrong in (blocks[i][1:], blocks[i][:, 1:], blocks[i].astype(np.float32), blocks[i].swapaxes(1, 2)):
            with pytest.raises(ValueError, match=r"must be|does not fit"):
                BlockFactors(order, line.first, line.last, *blocks[:i], wrong, *blocks[i + 1 :])


def test_singular_blocks_are_reported():
    """A free node whose block is zero, and one that is not a number."""
    system = build("clump")
    line, order = system.line, system.order
    for bad in (0.0, np.nan):
        diagonal = np.tile(np.eye(3), (system.nodes, 1, 1))
        diagonal[np.flatnonzero(~order.is_prescribed)[0]] = bad
        right, left = np.zeros((2, line.length.size, 3, 3))
        assert BlockFactors(order, line.first, line.last, diagonal, right, left).singular


def degrees(line, nodes):
    """Return how many cells each node has (N,): with so large a diagonal no pivot is near zero."""
    return np.bincount(np.append(line.first, line.last), minlength=nodes)


def prescribed_to_one(diagonal, order):
    """Return the blocks with those of prescribed nodes one, as the harmonic balance has them."""
    result = diagonal.copy()
    result[order.is_prescribed] = np.eye(diagonal.shape[1])
    return result


def dense_solution(line, order, diagonal, right, left, x):
    """Return (N, m) by numpy of all free rows and columns at once."""
    nodes, m = x.shape
    whole = np.zeros((nodes, m, nodes, m))
    for i in range(nodes):
        whole[i, :, i] = diagonal[i]
    for c, (i, j) in enumerate(zip(line.first, line.last, strict=True)):
        whole[i, :, j], whole[j, :, i] = right[c], left[c]
    free = np.repeat(~order.is_prescribed, m)
    solution = np.zeros(nodes * m)
    whole = whole.reshape(nodes * m, nodes * m)
    solution[free] = np.linalg.solve(whole[np.ix_(free, free)], x.ravel()[free])
    return solution.reshape(nodes, m)


@pytest.mark.parametrize("name", ["bridles", "net", *range(0, COUNT, 3)])
def test_coarser_lines_keep_every_second_node(name):
    """Nodes of the coarser lines are where they say, and a cubic motion along each element comes back."""
    system = build(name, [8 + e % 3 for e in range(len(network(name).elements))])
    coarse, prolong = system.coarser()
    kept, (fine, few) = common_nodes(coarse.layout, system.layout), (system.layout, coarse.layout)
    assert np.array_equal(kept[few.points], fine.points)
    for e in range(len(fine.s)):
        places = [fine.nodes[e].tolist().index(kept[i]) for i in few.nodes[e]]
        assert np.array_equal(fine.s[e][places], few.s[e])
    assert abs(prolong(cubic(coarse)) - cubic(system)).max() <= 1e3 * EPS * abs(cubic(system)).max()


def cubic(system):
    """Return (3, N, 2) that is cubic in the arc length of each element, from random values at the points."""
    result = np.zeros((3, system.nodes, 2))
    points = np.random.default_rng(3).normal(0, 1, (len(system.model.points), 3, 1, 2))
    for s, nodes, segment in zip(system.layout.s, system.layout.nodes, system.model.segments, strict=True):
        (a, b), x = points[list(segment.ends)], (s / s[-1])[:, None]
        result[:, nodes] = a + (b - a) * x + 0.5 * (x**3 - x)
    return result
