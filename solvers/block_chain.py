"""LU of a chain of dense blocks, node after node: start rows, cell rows between neighbours, end rows, some full rows.

The matrix has the shape of a two-point boundary-value problem, and is eliminated without fill as Varah (SIAM J. Numer.
Anal. 13 (1976) 71) does: the rows open at a node take as many of its unknowns away by column exchanges, the next cell
takes the others away by row exchanges, and the rows that it has left are open at the next node. Cost and storage grow
linearly with the nodes, HB 3.2.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.linalg import blas, lapack


class _Step(NamedTuple):
    """Factors of a node, p of whose unknowns its open rows take away and q = n - p the cell's."""

    columns: np.ndarray  # (n,) order of the unknowns, those of the open rows first
    lower: np.ndarray  # (n, n) of which the lower triangle counts: open rows, and rows of the cell
    upper: np.ndarray  # (n, n) of which the upper triangle counts
    left: np.ndarray  # (p + k, n) of those rows in the rows left over and the full ones
    right: np.ndarray  # (n, q) transposed coefficients of the next node in the rows of the cell


class BlockChain:
    """Factors of start (p, n), cells (2, N - 1, n, n), end (n - p - k, n) and full rows border (k, N, n).

    cells[0] multiplies the left node of a cell, cells[1] the right one; long chains may give ``cells`` as an iterator
    over parts (2, m, n, n), from left to right, which then never exist all at once. The precision, single or double,
    is that of ``start``. ``singular``: no use to solve.
    """

    def __init__(self, start, cells, end, border):
        parts = (cells,) if isinstance(cells, np.ndarray) else cells
        self.steps, self.singular, self.precision = [], False, start.dtype
        letter = "s" if self.precision == np.float32 else "d"
        self._trsm, self._trsv, self._gemv = (getattr(blas, letter + name) for name in ("trsm", "trsv", "gemv"))
        self._getrf, self._laswp = (getattr(lapack, letter + name) for name in ("getrf", "laswp"))
        self._order = np.arange(start.shape[1], dtype=self.precision)[:, None]
        self.p, rows, opened, full = len(start), [], start, border[:, 0]
        for i, (left, right) in enumerate(cell for part in parts for cell in zip(*part, strict=True)):
            step, order, opened, full = self._eliminated(opened, left, right, full, border[:, i + 1])
            self.steps.append(step)
            rows.append(order)
        self.rows = np.array(rows, dtype=int).reshape(len(rows), start.shape[1])  # (N - 1, n)
        self.last, self.last_pivots, info = self._getrf(np.concatenate([opened, end, full]))
        self.singular |= info != 0 or not np.isfinite(self.last).all()

    def _eliminated(self, opened, left, right, full, full_right):
        """The factors of a node, the order of the cell's rows, and the open and full rows at the next node."""
        p, n = opened.shape
        q, k = n - p, len(full)
        first, columns = self._factors(opened.T)
        if k:
            left = np.concatenate([left, full])
        left = left.T[columns].T
        shares = self._unit_solve(first[:p], left[:, :p])
        rest = left[:, p:] - shares @ first[p:].T
        second, rows = self._factors(rest[:n])
        ahead = right[rows]
        pivots = self._unit_solve(second[:q], ahead[:q].T)

        lower, upper, over = (np.empty((m, n), self.precision, "F") for m in (n, n, p + k))
        upper[:p], upper[p:, p:] = first.T, second[:q]
        lower[:p, :p], lower[p:, :p], lower[p:, p:] = first[:p].T, shares[rows[:q]], second[:q]
        upper.ravel("K")[: p * (n + 1) : n + 1] = 1.0  # the diagonals of the unit triangles
        lower.ravel("K")[p * (n + 1) :: n + 1] = 1.0
        over[:p, :p], over[:p, p:] = shares[rows[q:]], second[q:]
        if k:
            over[p:, :p] = shares[n:]
            over[p:, p:] = self._trsm(1.0, second[:q], rest[n:], side=1) if q else rest[n:]
        following = -over[:, p:] @ pivots.T
        following[:p] += ahead[q:]
        following[p:] += full_right
        return _Step(columns, lower, upper, over, pivots), rows, following[:p], following[p:]

    def _unit_solve(self, lu, rows):
        """Rows in Fortran order, overwritten, times the transposed inverse of the unit lower factor."""
        return self._trsm(1.0, lu, rows, side=1, lower=1, trans_a=1, diag=1, overwrite_b=1) if rows.size else rows

    def _factors(self, panel):
        """LU of a tall panel, and the order of its rows."""
        if not panel.shape[1]:
            return panel, np.arange(len(panel))
        lu, exchanges, info = self._getrf(panel)
        self.singular |= info != 0
        return lu, self._laswp(self._order, exchanges)[:, 0].astype(int)

    def solve(self, start, cells, end, border):
        """Solution (N, n) for right-hand sides (p,), (N - 1, n), (n - p - k,) and (k,)."""
        p, k, n = self.p, len(border), self.last.shape[0]
        q, cell = n - p, np.take_along_axis(np.asarray(cells, self.precision), self.rows, axis=1)
        found = np.empty((len(self.steps), n), self.precision)
        found[:, p:] = cell[:, :q]
        over = np.zeros((len(self.steps) + 1, p + k), self.precision)  # right-hand sides of open and full rows
        over[0, :p], over[1:, :p] = start, cell[:, q:]
        for step, f, here, following in zip(self.steps, found, over, over[1:], strict=False):
            f[:p] = here[:p]
            self._trsv(step.lower, f, lower=1, overwrite_x=1)
            if following.size:
                self._gemv(-1.0, step.left, f, 1.0, following, overwrite_y=1)
        b = np.concatenate([over[-1, :p], end, border + over[1:, p:].sum(axis=0)]).astype(self.precision)
        b = self._laswp(b[:, None], self.last_pivots)[:, 0]
        x = np.empty((len(self.steps) + 1, n), self.precision)
        x[-1] = self._trsv(self.last, self._trsv(self.last, b, lower=1, diag=1))
        for i in range(len(self.steps) - 1, -1, -1):
            step, f = self.steps[i], found[i]
            if q:
                self._gemv(-1.0, step.right, x[i + 1], 1.0, f, offy=p, trans=1, overwrite_y=1)
            x[i, step.columns] = self._trsv(step.upper, f, overwrite_x=1)
        return x.astype(float)
