"""LU of a chain of dense blocks, node after node: start rows, cell rows between neighbours, end rows, some full rows.

The matrix has the shape of a two-point boundary-value problem. At each node the rows still open (as many as there are
start rows) are stacked on those of the next cell and eliminated by LAPACK with row exchanges; what is left over is open
at the next node. Cost and storage grow linearly with the nodes, HB 3.2.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg.blas import dtrsm
from scipy.linalg.lapack import dgetrf, dlaswp


class BlockChain:
    """Factors of start (p, n), cells (2, N - 1, n, n), end (n - p - k, n) and full rows border (k, N, n).

    cells[0] multiplies the left node of a cell, cells[1] the right one; long chains may give ``cells`` as an iterator
    over parts (2, m, n, n), from left to right, which then never exist all at once. ``singular``: no use to solve.
    """

    def __init__(self, start, cells, end, border):
        n, p = start.shape[1], start.shape[0]
        parts = (cells,) if isinstance(cells, np.ndarray) else cells
        self.steps, border, opened = [], border.copy(), start
        panel, beside = np.empty((p + n, n), order="F"), np.empty((p + n, n), order="F")
        self.singular = False
        for i, (left, right) in enumerate(cell for part in parts for cell in zip(*part, strict=True)):
            panel[:p], panel[p:] = opened, left
            beside[:p], beside[p:] = 0.0, right
            lu, pivots, info = dgetrf(panel)
            moved = dlaswp(beside, pivots)
            lower = np.asfortranarray(lu[:n])
            top = dtrsm(1.0, lower, moved[:n], lower=1, diag=1)
            left_over = np.ascontiguousarray(lu[n:])
            opened = moved[n:] - left_over @ top
            shares = dtrsm(1.0, lower, border[:, i], side=1) if len(border) else border[:, i]
            border[:, i + 1] -= shares @ top
            self.steps.append((lower, left_over, pivots, top, shares))
            self.singular |= info != 0
        self.last, self.last_pivots, info = dgetrf(np.concatenate([opened, end, border[:, -1]]))
        self.singular |= info != 0 or not np.isfinite(self.last).all()

    def solve(self, start, cells, end, border):
        """Solution (N, n) for right-hand sides (p,), (N - 1, n), (n - p - k,) and (k,)."""
        n = self.last.shape[0]
        x = np.empty((len(self.steps) + 1, n))
        opened = start
        for i, (lower, left_over, pivots, _, shares) in enumerate(self.steps):
            right = dlaswp(np.concatenate([opened, cells[i]])[:, None], pivots)
            x[i] = dtrsm(1.0, lower, right[:n], lower=1, diag=1)[:, 0]
            opened = right[n:, 0] - left_over @ x[i]
            border = border - shares @ x[i]
        right = dlaswp(np.concatenate([opened, end, border])[:, None], self.last_pivots)
        right = dtrsm(1.0, self.last, right, lower=1, diag=1)
        x[-1] = dtrsm(1.0, self.last, right)[:, 0]
        for i in range(len(self.steps) - 1, -1, -1):
            lower, _, _, top, _ = self.steps[i]
            x[i] = dtrsm(1.0, lower, (x[i] - top @ x[i + 1])[:, None])[:, 0]
        return x
