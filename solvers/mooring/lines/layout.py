"""Numbers of the nodes and cells of a mesh, in an order in which elimination adds few blocks, and that elimination.

Elements are followed through points where no more than two of them meet, from a prescribed or loose end where they have
one; the joints of three or more come last. A line is numbered along itself, and its matrix is block-tridiagonal; an
element between two joints adds one block a node, and joints those of their Schur complement.
"""

from __future__ import annotations

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
    zero for each row of a block, whose number is a constant for the compiler.
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
    number = _Numbers(ends, [part.size for part in s])
    for start in [*np.flatnonzero(is_end).tolist(), *np.flatnonzero(is_joint).tolist(), *range(len(degree))]:
        if not is_joint[start]:
            number.point(start)
        while (e := number.next_segment(start)) is not None:
            at = start
            while e is not None:
                at = number.interior(e, at)
                e = None
                if not is_joint[at]:
                    number.point(at)
                    if not is_end[at]:
                        e = number.next_segment(at)
    for joint in _order_joints(ends, is_joint):
        number.point(joint)
    starts = np.cumsum([0, *(part.size - 1 for part in s)])
    cells = tuple(slice(a, b) for a, b in zip(starts[:-1].tolist(), starts[1:].tolist(), strict=True))
    pairs = np.sort(np.concatenate([np.stack([n[:-1], n[1:]]) for n in number.nodes], axis=1), axis=0)
    return Layout(tuple(s), tuple(number.nodes), cells, number.points, *pairs.astype(INDEX))


class _Numbers:
    """The numbers given so far: nodes of the segments and points."""

    def __init__(self, ends, sizes):
        self.ends, self.count = ends, 0
        self.nodes = [np.full(size, -1) for size in sizes]
        self.points = np.full(1 + max(map(max, ends)), -1)
        self.at_point = [[] for _ in self.points]  # type: list[list[int]]
        for e, pair in enumerate(ends):
            for p in pair:
                self.at_point[p].append(e)
        self.is_numbered = [False] * len(ends)

    def next_segment(self, point):
        """Return the first segment at a point that has no numbers, or None."""
        return next((e for e in self.at_point[point] if not self.is_numbered[e]), None)

    def point(self, point):
        """Number a point, unless it has its number."""
        if self.points[point] >= 0:
            return
        self.points[point] = self.count
        for e in self.at_point[point]:
            for end, p in zip((0, -1), self.ends[e], strict=True):
                if p == point:
                    self.nodes[e][end] = self.count
        self.count += 1

    def interior(self, e, start):
        """Number the nodes within a segment from one of its ends on; return the point at the other."""
        inner = np.arange(self.count, self.count + self.nodes[e].size - 2)
        self.nodes[e][1:-1] = inner if self.ends[e][0] == start else inner[::-1]
        self.count += inner.size
        self.is_numbered[e] = True
        return self.ends[e][1] if self.ends[e][0] == start else self.ends[e][0]


def _order_joints(ends, is_joint) -> list[int]:
    """Return the joints by minimum degree: next is always one with the fewest neighbours, which it then joins."""
    neighbours = {p: set() for p, yes in enumerate(is_joint) if yes}  # type: dict[int, set[int]]
    through = {}  # type: dict[int, set[int]]
    for a, b in ends:
        for p, q in ((a, b), (b, a)):
            if p in neighbours:
                neighbours[p].add(q)
            else:
                through.setdefault(p, set()).add(q)
    for p in neighbours:
        neighbours[p] = {q for q in neighbours[p] if q in neighbours}
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
