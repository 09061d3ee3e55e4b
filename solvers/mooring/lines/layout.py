"""Numbers of the nodes and cells of a mesh, in an order in which elimination adds few blocks, and that elimination.

Elements are followed through points where no more than two of them meet, from a prescribed or loose end where they have
one; the joints of three or more come last. A line is numbered along itself, and its matrix is block-tridiagonal; an
element between two joints adds one block a node, and joints those of their Schur complement.
"""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np

INDEX = np.uint64  # of the sign of others compiled loops take care at every access


class Layout(NamedTuple):
    """Nodes and cells of segments (k,) between points (P,).

    s: unstretched arc lengths of the nodes of each segment from its first point, m; nodes: their numbers; cells: those
    of the cells between them; points (P,): the nodes at the points. first < last (C,): the nodes of a cell.
    """

    s: tuple[np.ndarray, ...]
    nodes: tuple[np.ndarray, ...]
    cells: tuple[slice, ...]
    points: np.ndarray
    first: np.ndarray
    last: np.ndarray

    @property
    def size(self) -> int:
        """Number N of nodes."""
        return int(self.last.max()) + 1


class Elimination(NamedTuple):
    """Steps of the LU factorisation of blocks, found once; pivots are the nodes in their order.

    is_prescribed (N,): nodes without rows. Of pivot p the entries start[p]:start[p + 1] of other and edge are its later
    neighbours and the blocks between: right[edge] in its row, left[edge] in its column. pair: for each two of them in
    turn the block between these two. edges: number of blocks beside the diagonal, those of the cells first. axes: a
    zero for each row of a block, whose number is a constant for the compiler; none where loops serve blocks of any.
    """

    is_prescribed: np.ndarray
    start: np.ndarray
    other: np.ndarray
    edge: np.ndarray
    pair: np.ndarray
    edges: int
    axes: tuple

    def with_rows(self, n) -> Elimination:
        """Return the same steps for blocks of n rows."""
        return self._replace(axes=(0.0,) * n)


def number_nodes(model, s) -> Layout:
    """Return the Layout of a MooringModel on arc lengths s of each segment."""
    ends = [segment.ends for segment in model.segments]
    degree = np.bincount(np.ravel(ends), minlength=len(model.points)).tolist()
    is_joint = [p.kind == "free" and d > 2 for p, d in zip(model.points, degree, strict=True)]
    is_end = [p.kind != "free" or d == 1 for p, d in zip(model.points, degree, strict=True)]
    nodes, points, count = [np.empty(part.size, dtype=int) for part in s], np.full(len(degree), -1), 0
    starts = [*np.flatnonzero(is_end).tolist(), *np.flatnonzero(is_joint).tolist(), *range(len(degree))]
    for e, p in follow_segments(ends, starts, np.logical_or(is_joint, is_end).tolist()):
        if e is not None:
            inner = np.arange(count, count + s[e].size - 2)
            nodes[e][1:-1] = inner if ends[e][1] == p else inner[::-1]
            count += inner.size
        if points[p] < 0 and not is_joint[p]:
            points[p], count = count, count + 1
    joints = _order_joints(ends, is_joint)
    points[joints] = np.arange(count, count + len(joints))
    for numbers, pair in zip(nodes, ends, strict=True):
        numbers[[0, -1]] = points[list(pair)]
    bounds = np.cumsum([0, *(part.size - 1 for part in s)])
    cells = tuple(slice(a, b) for a, b in pairwise(bounds.tolist()))
    pairs = np.sort(np.concatenate([np.stack([n[:-1], n[1:]]) for n in nodes], axis=1), axis=0)
    return Layout(tuple(s), tuple(nodes), cells, points, *pairs.astype(INDEX))


def follow_segments(ends, starts, is_end):
    """Yield segments with the point that each leads to, from some points on (with None) to those where paths end.

    ends: the two points of each segment; is_end (P,): whether a path ends at a point.
    """
    at_point = [[] for _ in is_end]  # type: list[list[int]]
    for segment, pair in enumerate(ends):
        for p in pair:
            at_point[p].append(segment)
    unvisited = set(range(len(ends)))
    for start in starts:
        yield None, start
        for first in at_point[start]:
            at, e = start, first  # type: int, int | None
            while e in unvisited:
                unvisited.remove(e)
                at = ends[e][1] if ends[e][0] == at else ends[e][0]
                yield e, at
                e = next((one for one in at_point[at] if one in unvisited and not is_end[at]), None)


def _order_joints(ends, is_joint) -> list[int]:
    """Return the joints by minimum degree: next is always one with the fewest neighbours, which it then joins."""
    neighbours = {p: set() for p, yes in enumerate(is_joint) if yes}  # type: dict[int, set[int]]
    for a, b in ends:
        if is_joint[a] and is_joint[b]:
            neighbours[a].add(b)
            neighbours[b].add(a)
    order = []
    while neighbours:
        p = min(neighbours, key=lambda p: (len(neighbours[p]), p))
        for q in neighbours[p]:
            neighbours[q] |= neighbours[p] - {q}
            neighbours[q].discard(p)
        del neighbours[p]
        order.append(p)
    return order


def plan_elimination(layout, prescribed, n) -> Elimination:
    """Return the Elimination of a Layout with prescribed nodes, its blocks of n rows."""
    is_prescribed = np.zeros(layout.size, dtype=bool)
    is_prescribed[prescribed] = True
    later = [{} for _ in range(layout.size)]  # type: list[dict[int, int]]
    for c, (p, q) in enumerate(zip(layout.first.tolist(), layout.last.tolist(), strict=True)):
        if not (is_prescribed[p] or is_prescribed[q]):
            later[p][q] = c
    edges, pair = layout.first.size, []
    for p in range(layout.size):
        others = sorted(later[p])
        for i, one in enumerate(others):
            for two in others[i + 1 :]:
                if two not in later[one]:
                    later[one][two] = edges
                    edges += 1
                pair.append(later[one][two])
    start = np.cumsum([0, *map(len, later)]).astype(INDEX)
    other = np.array([q for row in later for q in sorted(row)], dtype=INDEX)
    edge = np.array([row[q] for row in later for q in sorted(row)], dtype=INDEX)
    return Elimination(is_prescribed, start, other, edge, np.array(pair, dtype=INDEX), edges, (0.0,) * n)
