"""A chain: nodes with a few fields each, coupled to their neighbours only: all that the dynamic solvers know."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.linalg.lapack import dgbtrf, dgbtrs, zgbtrf, zgbtrs

from ..common.outcome import Status


class Rows(NamedTuple):
    """Some rows of F and its tangents; S is () at one instant or (samples,).

    Cells: value (n_f, N - 1, *S); y and ydot (2, n_f, n_f, N - 1, *S), the first axis the left and the right node.
    End rows: value (n_r, *S); y and ydot (n_r, n_f, *S). Without tangents y and ydot are None.
    """

    value: np.ndarray
    y: np.ndarray | None = None
    ydot: np.ndarray | None = None


class ChainSystem:
    """F(y, ydot, t) = 0 for y of shape (n_f, N, *S), n_f ``fields`` at N ``nodes``; t of shape S.

    A subclass sets ``fields`` (names), ``nodes`` and ``start_rows``, and gives the rows of F in the order
    start (start_rows rows of node 1), cells (n_f rows between neighbours), end (n_f - start_rows rows of node N).
    A single node has no cells: its rows are start and end.
    """

    fields: tuple[str, ...]
    nodes: int
    start_rows: int
    period: float | None = None  # of the motion, s

    def start(self, y, ydot, t, tangents=True) -> Rows:
        """Rows of the first node, (start_rows, *S)."""
        raise NotImplementedError

    def cells(self, y, ydot, t, tangents=True) -> Rows:
        """Rows between neighbours; a chain of one node has none."""
        raise NotImplementedError

    def end(self, y, ydot, t, tangents=True) -> Rows:
        """Rows of the last node, (n_f - start_rows, *S)."""
        raise NotImplementedError

    def rest(self) -> np.ndarray:
        """State (n_f, N) from which a motion starts, with F(rest, 0, 0) = 0 when nothing moves yet."""
        return np.zeros((len(self.fields), self.nodes))

    def scale(self) -> np.ndarray:
        """A size (n_f,) of each field below which an error does not matter: what a relative error is relative to."""
        return np.ones(len(self.fields))

    def ramped(self, duration) -> ChainSystem:
        """The same chain with a motion that grows from rest over a duration in s."""
        return self

    def scaled(self, share) -> ChainSystem:
        """The same chain with its driving multiplied by a number from 0 to 1."""
        raise NotImplementedError

    def coarser(self) -> tuple[ChainSystem, Callable] | None:
        """The chain on about half the nodes, and what carries z (n_f, nodes, C) from there to here; None: no such."""
        return None

    def fourth_order(self) -> ChainSystem | None:
        """The chain with cells of fourth order in their size, and the same tangents; None: no such."""
        return None

    def carried(self, t) -> np.ndarray | None:
        """A rough state (n_f, N, S) of the moving chain at times t (S,), to start from instead of rest; None: no such.

        At rest a quadratic drag has no slope: Newton's first step, undamped, goes far too far.
        """
        return None

    def mirror(self) -> tuple[tuple[int, ...], ...] | None:
        """Signs +1 or -1 of the fields and of the start, cell and end rows under a mirror that may map it to itself."""
        return None

    def invalid(self, y) -> tuple[Status, int] | None:
        """Why and at which node (from 0) a state of y (n_f, N, *S) is outside what the equations hold for, or None."""
        return None

    def drift(self, y, t) -> np.ndarray | None:
        """How far the last node's position is from the prescribed one, (n_d, *S), or None: rows see it only as a rate.

        The rows ``end`` see velocities, so a constant of integration is open: a time integration lets it drift and a
        periodic solution leaves it undetermined. The solvers close it with this: as the velocity that ``end`` takes
        in ``correction``, or in place of the mean of the last n_d rows of ``end``.
        """
        return None

    def answer(self) -> float:
        """Time in s in which the last node answers a velocity that it is given."""
        return 0.0

    def hold_gain(self) -> float:
        """Share (0 to 1) of an offset of the last node, and of its rate, that a hold may take back without waves."""
        return 1.0

    def drift_tangent(self, y) -> np.ndarray:
        """d(drift)/dy, (n_d, n_f, N, *S)."""
        raise NotImplementedError

    def residual(self, y, ydot, t) -> np.ndarray:
        """F as one vector, (N n_f, *S), rows start, cells (node after node), end."""
        return stack(self.start(y, ydot, t, False), self.between(y, ydot, t, False), self.end(y, ydot, t, False))

    def between(self, y, ydot, t, tangents=True) -> Rows:
        """``cells``, or no rows for a single node."""
        if self.nodes > 1:
            return self.cells(y, ydot, t, tangents)
        n = len(self.fields)
        empty = np.zeros((2, n, n, 0, *y.shape[2:]), dtype=y.dtype)
        return Rows(empty[0, 0], empty, empty)


def stack(start: Rows, cells: Rows, end: Rows) -> np.ndarray:
    """Values of the rows as one vector, (N n_f, *S)."""
    n_f, between = cells.value.shape[:2]
    middle = cells.value.swapaxes(0, 1).reshape(n_f * between, *cells.value.shape[2:])
    return np.concatenate([start.value, middle, end.value])


def product(parts, x) -> np.ndarray:
    """A combination of tangents (start, cells, end) of one instant times x (n_f, N), rows as in ``stack``."""
    start, cells, end = parts
    between = np.einsum("ijn,jn->in", cells[0], x[:, :-1]) + np.einsum("ijn,jn->in", cells[1], x[:, 1:])
    return stack(Rows(start @ x[:, 0]), Rows(between), Rows(end @ x[:, -1]))


class BandedJacobian:
    """A combination of dF/dy and dF/dydot of a chain in LAPACK's band storage, and its LU factors; one instant."""

    def __init__(self, fields: int, nodes: int, start_rows: int, dtype=float):
        n, first = fields * nodes, start_rows
        self.kl = max(first + fields - 1, fields - 1)
        self.ku = max(2 * fields - 1 - first, fields - 1)
        self.storage = np.zeros((2 * self.kl + self.ku + 1, n), dtype, order="F")
        self._trf, self._trs = (zgbtrf, zgbtrs) if dtype is complex else (dgbtrf, dgbtrs)
        cell = np.arange(nodes - 1)
        side, row, column = np.ogrid[:2, :fields, :fields]
        i = first + fields * cell + row[..., None]
        j = fields * (cell + side[..., None]) + column[..., None]
        self._cells = self._position(i, j)
        row, column = np.ogrid[:first, :fields]
        self._start = self._position(row, column)
        row, column = np.ogrid[: fields - first, :fields]
        self._end = self._position(n - fields + first + row, n - fields + column)

    def _position(self, i, j):
        """Index into the storage, Fortran order, of entry (i, j)."""
        return np.ravel(self.storage.shape[0] * j + (self.kl + self.ku + i - j))

    def factorise(self, start, cells, end) -> bool:
        """Fill and factorise: start (start_rows, n_f), cells (2, n_f, n_f, N - 1), end (n_f - start_rows, n_f).

        False when the matrix is singular or not finite.
        """
        flat = self.storage.ravel(order="K")
        for where, part in ((self._start, start), (self._cells, cells), (self._end, end)):
            flat[where] = part.ravel()
        self._lu, self._pivots, info = self._trf(self.storage, self.kl, self.ku)
        return info == 0 and bool(np.isfinite(self._lu[self.kl + self.ku]).all())

    def solve(self, right) -> np.ndarray:
        """Solution x of matrix x = right, (N n_f,) or (N n_f, k)."""
        return self._trs(self._lu, self.kl, self.ku, right, self._pivots)[0]
