"""LU of a chain of dense blocks, node after node: start rows, cell rows between neighbours, end rows, some full rows.

The matrix has the shape of a two-point boundary-value problem, and is eliminated without fill as Varah (SIAM J. Numer.
Anal. 13 (1976) 71) does: the rows open at a node take as many of its unknowns away by column exchanges, the next cell
takes the others away by row exchanges, and the rows that it has left are open at the next node. Cost and storage grow
linearly with the nodes, HB 3.2.

The loops over the nodes are compiled, and call the BLAS and LAPACK of scipy: blocks are so small that interpreted
loops take two to five times as long. Blocks are stored as C arrays, which BLAS sees transposed.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import lapack

from ..compiled import compiled
from . import blas_by_address as blas
from .blas_by_address import LOWER, NON_UNIT, PLAIN, TRANSPOSED, UNIT, UPPER


class BlockChain:
    """Factors of start (p, n), cells (2, N - 1, n, n), end (n - p - k, n) and full rows border (k, N, n).

    cells[0] multiplies the left node of a cell, cells[1] the right one; long chains may give ``cells`` as an iterator
    over parts (2, m, n, n), from left to right, which then never exist all at once. The precision, single or double,
    is that of ``start``. ``singular``: no use to solve. Raises ValueError where the shapes do not fit together.
    """

    def __init__(self, start, cells, end, border):
        (p, n), (k, nodes) = start.shape, border.shape[:2]
        self.precision = real = np.dtype(np.float32 if start.dtype == np.float32 else float)
        self.opened = np.empty((nodes - 1, p, n), real)  # factors of the open rows
        self.cell = np.empty((nodes - 1, n, n + k), real)  # of a cell's rows and the full ones, by columns
        self.ahead = np.empty((nodes - 1, n - p, n), real)  # coefficients of the next node
        self.columns, self.rows = np.empty((2, nodes - 1, n), np.int32)  # their order in each
        border, end = _block(border.swapaxes(0, 1), real, nodes, k, n), _block(end, real, n - p - k, n)
        rest, done, singular = np.empty((p + k, n), real), 0, 0
        rest[:p], rest[p:] = start, border[0]
        for left, right in (cells,) if isinstance(cells, np.ndarray) else cells:
            at, done = slice(done, done + len(left)), done + len(left)
            ahead = border[at.start + 1 : at.stop + 1]
            left, right = (_block(part, real, at.stop - at.start, n, n) for part in (left, right))
            result = self.opened[at], self.cell[at], self.ahead[at], self.columns[at], self.rows[at]
            singular += _eliminate(rest, left, right, ahead, *result)
        if done != nodes - 1:
            raise ValueError(f"cells: {done} of them do not lie between {nodes} nodes")
        getrf = lapack.sgetrf if real == np.float32 else lapack.dgetrf
        last, exchanges, info = getrf(np.concatenate([rest[:p], end, rest[p:]]))
        self.last, self.last_rows = np.ascontiguousarray(last.T), np.empty(n, np.int32)
        _order(exchanges + 1, self.last_rows)
        self.singular = bool(singular or info != 0 or not np.isfinite(last).all())

    def solve(self, start, cells, end, border):
        """Solution (N, n) for right-hand sides (p,), (N - 1, n), (n - p - k,) and (k,)."""
        (m, p, n), k = self.opened.shape, self.cell.shape[2] - self.cell.shape[1]
        shapes = ((start, p), (cells, m, n), (end, n - p - k), (border, k))
        right = (_block(part, self.precision, *shape) for part, *shape in shapes)
        factors = self.opened, self.cell, self.ahead, self.columns, self.rows, self.last, self.last_rows
        return _solve(*right, *factors).astype(float)


def _block(part, real, *shape):
    """A C array of a block, whose shape is looked at here: compiled loops would read past it."""
    if part.shape != shape:
        raise ValueError(f"a block of shape {part.shape} must be {shape}")
    return np.ascontiguousarray(part, real)


# ---------------------------------------------------------------- the elimination
@compiled
def _order(exchanges, order):
    """The order of rows after LAPACK's exchanges, counted from 1."""
    for i in range(order.size):
        order[i] = i
    for i in range(exchanges.size):
        j = exchanges[i] - 1
        order[i], order[j] = order[j], order[i]


@compiled(calls=(blas,))
def _eliminate(rest, left, right, border, opened, cell, ahead, columns, rows):
    """Factors of some nodes; how many were singular.

    rest (p + k, n): open and full rows at the first of them, and then at the node after the last. left, right (m, n, n)
    of the cells, border (m, k, n) of the full rows at their right nodes. Of the n unknowns p are taken away by the open
    rows, q by the cell's.
    """
    m, q, n = ahead.shape
    p, k, singular = n - q, border.shape[1], 0
    first, second = np.empty(p, np.int32), np.empty(q, np.int32)
    for i in range(m):
        o, c = opened[i], cell[i]
        o[:] = rest[:p]
        singular += blas.getrf(o, first)
        _order(first, columns[i])
        for j in range(n):
            column = columns[i, j]
            for r in range(n):
                c[j, r] = left[i, r, column]
            for r in range(k):
                c[j, n + r] = rest[p + r, column]
        blas.trsm(LOWER, TRANSPOSED, UNIT, o, c[:p])
        blas.gemm(c[:p], o[:, p:], c[p:])
        singular += blas.getrf(c[p:, :n], second)
        _order(second, rows[i])
        for shares in c[:p]:
            for j in range(q):
                r = second[j] - 1
                shares[j], shares[r] = shares[r], shares[j]
        a = ahead[i]
        for r in range(q):
            a[r] = right[i, rows[i, r]]
        for r in range(p):
            rest[r] = right[i, rows[i, q + r]]
        rest[p:] = border[i]
        blas.trsm(LOWER, TRANSPOSED, UNIT, c[p:], a)
        blas.trsm(UPPER, PLAIN, NON_UNIT, c[p:], c[p:, n:])
        blas.gemm(a, c[p:, q:], rest)
    return singular


@compiled(calls=(blas,))
def _solve(start, cells, end, border, opened, cell, ahead, columns, rows, last, last_rows):
    """Solution (N, n) for right-hand sides (p,), (N - 1, n), (n - p - k,) and (k,)."""
    m, q, n = ahead.shape
    p, k = n - q, border.size
    result, x = np.empty((m, n), start.dtype), np.empty((m + 1, n), start.dtype)
    rest, right = np.empty(p + k, start.dtype), np.empty(n + k, start.dtype)
    of_cell, of_rest = right[:q], right[q:]
    rest[:p], rest[p:] = start, border
    for i in range(m):
        first, second, by_first, by_second = result[i, :p], result[i, p:], cell[i, :p], cell[i, p:]
        for r in range(n):
            right[r] = cells[i, rows[i, r]]
        right[n:] = rest[p:]
        first[:] = rest[:p]
        blas.trsv(UPPER, TRANSPOSED, NON_UNIT, opened[i], first)
        blas.gemv(PLAIN, by_first, first, right)
        blas.trsv(LOWER, PLAIN, UNIT, by_second, of_cell)
        blas.gemv(PLAIN, by_second[:, q:], of_cell, of_rest)
        second[:] = of_cell
        rest[:] = of_rest
    right[:p], right[p : n - k], right[n - k : n] = rest[:p], end, rest[p:]
    for r in range(n):
        x[m, r] = right[last_rows[r]]
    blas.trsv(LOWER, PLAIN, UNIT, last, x[m])
    blas.trsv(UPPER, PLAIN, NON_UNIT, last, x[m])
    for i in range(m - 1, -1, -1):
        first, second = result[i, :p], result[i, p:]
        blas.gemv(TRANSPOSED, ahead[i], x[i + 1], second)
        blas.trsv(UPPER, PLAIN, NON_UNIT, cell[i, p:], second)
        blas.gemv(TRANSPOSED, opened[i, :, p:], second, first)
        blas.trsv(LOWER, TRANSPOSED, UNIT, opened[i], first)
        for j in range(n):
            x[i, columns[i, j]] = result[i, j]
    return x
