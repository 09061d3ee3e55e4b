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
    """Factors of a node: its open rows are upper^T [lower^T, below^T] in exchanged ``columns``; q = n - p."""

    columns: np.ndarray  # (n,) order of the unknowns, the first p of them by the open rows
    first: np.ndarray  # (p, p) LU
    below: np.ndarray  # (q, p)
    shares: np.ndarray  # (n + k, p) of the open rows in those of the cell and the full ones
    rows: np.ndarray  # (n + k,) order of those, the first q of them for the other unknowns
    second: np.ndarray  # (q, q) LU
    left: np.ndarray  # (p + k, q) of those rows in the rows left over
    right: np.ndarray  # (q, n) coefficients of the next node in those rows


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
        self._trsm, self._trsv = (getattr(blas, letter + name) for name in ("trsm", "trsv"))
        self._getrf, self._laswp = (getattr(lapack, letter + name) for name in ("getrf", "laswp"))
        opened, full = start, border[:, 0]
        for i, (left, right) in enumerate(cell for part in parts for cell in zip(*part, strict=True)):
            opened, full = self._eliminate(opened, np.concatenate([left, full]), right, border[:, i + 1])
        self.last, self.last_pivots, info = self._getrf(np.concatenate([opened, end, full]))
        self.singular |= info != 0 or not np.isfinite(self.last).all()

    def _eliminate(self, opened, left, right, full):
        """Eliminate a node; the rows open at the next one, and what the full rows are there."""
        p, n = opened.shape
        first, columns = self._factors(opened.T)
        top, below = np.asfortranarray(first[:p]), first[p:]
        left = left.T[columns].T
        shares = self._unit_solve(top, left[:, :p])
        rest = left[:, p:] - shares @ below.T
        lu, rows = self._factors(rest[:n])
        second, pivots = np.asfortranarray(lu[: n - p]), right[rows[: n - p]]
        pivots = self._unit_solve(second, pivots.T).T
        lower = lu[n - p :]
        if len(full):
            lower = np.concatenate([lower, self._trsm(1.0, second, rest[n:], side=1) if p < n else rest[n:]])
        over = np.concatenate([right[rows[n - p :]], full]) - lower @ pivots
        rows = np.concatenate([rows, np.arange(n, n + len(full))])
        self.steps.append(_Step(columns, top, below, shares, rows, second, lower, pivots))
        return over[:p], over[p:]

    def _unit_solve(self, lu, rows):
        """Rows in Fortran order, overwritten, times the transposed inverse of the unit lower factor."""
        return self._trsm(1.0, lu, rows, side=1, lower=1, trans_a=1, diag=1, overwrite_b=1) if rows.size else rows

    def _factors(self, panel):
        """LU of a tall panel, and the order of its rows."""
        rows, count = panel.shape
        if not count:
            return panel, np.arange(rows)
        lu, exchanges, info = self._getrf(panel)
        self.singular |= info != 0
        return lu, self._laswp(np.arange(rows, dtype=self.precision)[:, None], exchanges)[:, 0].astype(int)

    def solve(self, start, cells, end, border):
        """Solution (N, n) for right-hand sides (p,), (N - 1, n), (n - p - k,) and (k,)."""
        p, n, k = len(start), self.last.shape[0], len(border)
        q = n - p
        x, y = (np.empty((count, n), self.precision) for count in (len(self.steps) + 1, len(self.steps)))
        right = np.empty((len(self.steps), n + k), self.precision)
        right[:, :n] = cells
        over = np.concatenate([start, border]).astype(self.precision)
        for step, b, found in zip(self.steps, right, y, strict=True):
            b[n:] = over[p:]
            if p:
                found[:p] = self._trsv(step.first, over[:p], lower=0, trans=1)
            b = (b - step.shares @ found[:p])[step.rows]
            if q:
                found[p:] = self._trsv(step.second, b[:q], lower=1, diag=1)
            over = b[q:] - step.left @ found[p:]
        b = np.concatenate([over[:p], end, over[p:]]).astype(self.precision)
        b = self._laswp(b[:, None], self.last_pivots)[:, 0]
        x[-1] = self._trsv(self.last, self._trsv(self.last, b, lower=1, diag=1))
        for i in range(len(self.steps) - 1, -1, -1):
            step, found = self.steps[i], y[i]
            if q:
                found[p:] = self._trsv(step.second, found[p:] - step.right @ x[i + 1])
            if p:
                found[:p] = self._trsv(step.first, found[:p] - step.below.T @ found[p:], lower=1, trans=1, diag=1)
            x[i, step.columns] = found
        return x.astype(float)
