"""The contract between physics and the two dynamic solvers: a chain of nodes coupled to their neighbours only.

``ChainSystem`` is all that the dynamic solvers know of a moving body; ``BandedJacobian`` solves with its tangents.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.linalg.lapack import dgbtrf, dgbtrs, zgbtrf, zgbtrs

from ..common.outcome import Status


class Residual(NamedTuple):
    """Some rows of F and their tangents dF/dy and dF/dydot; S is () at one instant or (samples,).

    Cells: value (n_f, N - 1, *S); dy and dydot (2, n_f, n_f, N - 1, *S), the first axis the left and the right node.
    Ends: value (n_r, *S); dy and dydot (n_r, n_f, *S). Without tangents dy and dydot are None.
    """

    value: np.ndarray
    dy: np.ndarray | None = None
    dydot: np.ndarray | None = None


class ChainSystem:
    """F(y, ydot, t) = 0 for y of shape (n_f, N, *S), n_f ``fields`` at N ``nodes``; t of shape S.

    A subclass sets ``fields`` (names), ``nodes`` and ``start_rows``, and gives the rows of F in the order
    start (start_rows rows of node 1), cells (n_f rows between neighbours), end (n_f - start_rows rows of node N).
    A single node has no cells: its rows are start and end. Every other method has a default that the solvers can work
    with, or raises NotImplementedError with the name of the method that a subclass would have to give.
    """

    fields: tuple[str, ...]
    nodes: int
    start_rows: int
    needs_mesh_check = False  # whether results are compared with those on half the nodes, for warnings
    period: float | None = None  # of the motion, s
    motion = None  # of the last node: displacement(t) and velocity(t), (3, *S) in m and m/s

    # ------------------------------------------------------------ equations
    def start(self, y, ydot, t, tangents=True) -> Residual:
        """Return the rows of the first node, (start_rows, *S)."""
        raise self._missing("start")

    def cells(self, y, ydot, t, tangents=True) -> Residual:
        """Return the rows between neighbours; asked of chains with two nodes and more."""
        raise self._missing("cells")

    def end(self, y, ydot, t, tangents=True) -> Residual:
        """Return the rows of the last node, (n_f - start_rows, *S).

        A chain whose ``drift`` is not None takes a keyword, too: correction (n_d, *S), a velocity in m/s that is added
        to the prescribed one.
        """
        raise self._missing("end")

    def rest_warnings(self) -> tuple[str, ...]:
        """Return sentences on what the rest state itself has lost, for the warnings of every result about it."""
        return ()

    def cells_or_empty(self, y, ydot, t, tangents=True) -> Residual:
        """Return ``cells``, or arrays without cells for a single node."""
        if self.nodes > 1:
            return self.cells(y, ydot, t, tangents)
        n = len(self.fields)
        empty = np.zeros((2, n, n, 0, *y.shape[2:]), dtype=y.dtype)
        return Residual(empty[0, 0], empty, empty)

    def residual(self, y, ydot, t) -> np.ndarray:
        """Return F as one vector, (N n_f, *S), rows start, cells (node after node), end."""
        return stack(*(part(y, ydot, t, False) for part in (self.start, self.cells_or_empty, self.end)))

    def mirror(self) -> tuple[tuple[int, ...], ...] | None:
        """Return the signs +1 or -1 of the fields and of the start, cell and end rows under a mirror, or None.

        The mirror may map the chain to itself half a period later; the solver checks whether it does.
        """
        return None

    def invalid(self, y) -> tuple[Status, int] | None:
        """Return why and at which node (from 0) the equations do not hold for a state y (n_f, N, *S), or None."""
        return None

    # ------------------------------------------------------------ where a solve starts, what it measures errors by
    def rest_state(self) -> np.ndarray:
        """Return the state (n_f, N) from which a motion starts, with F(rest, 0, 0) = 0 when nothing moves yet."""
        return np.zeros((len(self.fields), self.nodes))

    def scale(self) -> np.ndarray:
        """Return the size (n_f,) of each field that relative errors refer to where the field itself is smaller."""
        return np.ones(len(self.fields))

    def predict_motion(self, t) -> np.ndarray | None:
        """Return a rough state (n_f, N, S) of the moving chain at times t (S,), from which Newton starts, or None.

        At rest a quadratic drag has no slope, so Newton's first undamped step from there goes far too far.
        """
        return None

    # ------------------------------------------------------------ the same chain, changed
    def ramped(self, duration) -> ChainSystem:
        """Return the chain with a motion that grows from rest over a duration in s; by default the chain as it is."""
        return self

    def scaled(self, load_factor) -> ChainSystem:
        """Return the chain with its driving multiplied by a number from 0 to 1, for a continuation in it."""
        raise self._missing("scaled")

    def coarser(self) -> tuple[ChainSystem, Callable] | None:
        """Return the chain on about half the nodes and a function that interpolates z (n_f, nodes, C) back, or None."""
        return None

    def fourth_order(self) -> ChainSystem | None:
        """Return the chain with cells of fourth order in their size and the same tangents, or None."""
        return None

    # ------------------------------------------------------------ the position of the last node
    def drift(self, y, t) -> np.ndarray | None:
        """Return the last node's position less the prescribed one, (n_d, *S), or None where no position is prescribed.

        The rows ``end`` see velocities, so a constant of integration is open: a time integration lets it drift and a
        periodic solution leaves it undetermined. The solvers close it with this: as the velocity that ``end`` takes
        in ``correction``, or in place of the mean of the last n_d rows of ``end``.
        """
        return None

    def drift_tangent(self, y) -> np.ndarray:
        """Return d(drift)/dy, (n_d, n_f, N, *S)."""
        raise self._missing("drift_tangent")

    def settling_time(self) -> float:
        """Return the time in s in which the position of the last node settles after a change of its velocity."""
        return 0.0

    def drift_gain(self) -> float:
        """Return the share (0 to 1) of an offset of the last node that may be taken back without exciting waves."""
        return 1.0

    # ------------------------------------------------------------ outputs of a line, for forces and diagnostics
    def tension(self, y, ydot=None) -> np.ndarray:
        """Return the tension at the nodes, (N, *S), N."""
        raise self._missing("tension")

    def positions(self, y) -> np.ndarray:
        """Return the positions of the nodes, (3, N, *S), m."""
        raise self._missing("positions")

    def direction(self, y) -> np.ndarray:
        """Return the unit tangent at the nodes, (3, N, *S)."""
        raise self._missing("direction")

    def _missing(self, method) -> NotImplementedError:
        return NotImplementedError(f"{type(self).__name__}.{method}: not given by this chain; see ChainSystem.{method}")


def stack(start: Residual, cells: Residual, end: Residual) -> np.ndarray:
    """Return the values of the rows as one vector, (N n_f, *S)."""
    n_f, count = cells.value.shape[:2]
    by_cell = cells.value.swapaxes(0, 1).reshape(n_f * count, *cells.value.shape[2:])
    return np.concatenate([start.value, by_cell, end.value])


def product(parts, x) -> np.ndarray:
    """Return a combination of tangents (start, cells, end) of one instant times x (n_f, N), rows as in ``stack``."""
    start, cells, end = parts
    cell_rows = np.einsum("ijn,jn->in", cells[0], x[:, :-1]) + np.einsum("ijn,jn->in", cells[1], x[:, 1:])
    return stack(Residual(start @ x[:, 0]), Residual(cell_rows), Residual(end @ x[:, -1]))


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
        """Return the index into the storage, Fortran order, of entry (i, j)."""
        return np.ravel(self.storage.shape[0] * j + (self.kl + self.ku + i - j))

    def factorise(self, start, cells, end) -> bool:
        """Fill and factorise the matrix; return False when it is singular or not finite.

        start (start_rows, n_f), cells (2, n_f, n_f, N - 1), end (n_f - start_rows, n_f).
        """
        flat = self.storage.ravel(order="K")
        for entries, part in ((self._start, start), (self._cells, cells), (self._end, end)):
            flat[entries] = part.ravel()
        self._lu, self._pivots, info = self._trf(self.storage, self.kl, self.ku)
        return info == 0 and bool(np.isfinite(self._lu[self.kl + self.ku]).all())

    def solve(self, right) -> np.ndarray:
        """Return the solution x of matrix x = right, (N n_f,) or (N n_f, k)."""
        return self._trs(self._lu, self.kl, self.ku, right, self._pivots)[0]
