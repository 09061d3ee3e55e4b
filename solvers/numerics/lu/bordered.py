"""LU of a chain of dense blocks, node after node: start rows, cell rows between neighbours, end rows, some full rows.

The matrix has the shape of a two-point boundary-value problem, and is eliminated without fill as Varah (SIAM J. Numer.
Anal. 13 (1976) 71) does: the rows open at a node take as many of its unknowns away by column exchanges, the next cell
takes the others away by row exchanges, and the rows that it has left are open at the next node. Cost and storage grow
linearly with the nodes, HB 3.2.

The loops over the nodes are compiled, and call the BLAS and LAPACK of scipy: blocks are so small that interpreted
loops take two to five times as long. Blocks are stored as C arrays, which BLAS sees transposed.
"""

from __future__ import annotations

import ctypes

import llvmlite.binding
import numba
import numpy as np
from numba import njit, types
from numba.extending import get_cython_function_address
from scipy.linalg import cython_blas, cython_lapack, lapack

from ..compiled import compiled


class BlockChain:
    """Factors of start (p, n), cells (2, N - 1, n, n), end (n - p - k, n) and full rows border (k, N, n).

    cells[0] multiplies the left node of a cell, cells[1] the right one; long chains may give ``cells`` as an iterator
    over parts (2, m, n, n), from left to right, which then never exist all at once. The precision, single or double,
    is that of ``start``. ``singular``: no use to solve. Raises ValueError where the shapes do not fit together.
    """

    def __init__(self, start, cells, end, border):
        (p, n), (k, nodes) = start.shape, border.shape[:2]
        self.precision = real = np.dtype(np.float32 if start.dtype == np.float32 else float)
        self.signs = np.array([1, -1], real)  # factors that BLAS takes by address
        self.opened = np.empty((nodes - 1, p, n), real)  # factors of the open rows
        self.cell = np.empty((nodes - 1, n, n + k), real)  # of a cell's rows and the full ones, by columns
        self.ahead = np.empty((nodes - 1, n - p, n), real)  # coefficients of the next node
        self.columns, self.rows = np.empty((2, nodes - 1, n), np.int32)  # their order in each
        border, end = _block(border.swapaxes(0, 1), real, nodes, k, n), _block(end, real, n - p - k, n)
        rest, done, singular = np.empty((p + k, n), real), 0, 0
        rest[:p], rest[p:] = start, border[0]
        for left, right in (cells,) if isinstance(cells, np.ndarray) else cells:
            at, done = slice(done, done + len(left)), done + len(left)
            beside = border[at.start + 1 : at.stop + 1]
            left, right = (_block(part, real, at.stop - at.start, n, n) for part in (left, right))
            result = self.opened[at], self.cell[at], self.ahead[at], self.columns[at], self.rows[at]
            singular += _eliminate(rest, left, right, beside, *result, self.signs)
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
        return _solve(*right, *factors, self.signs).astype(float)


def _block(part, real, *shape):
    """A C array of a block, whose shape is looked at here: compiled loops would read beside it."""
    if part.shape != shape:
        raise ValueError(f"a block of shape {part.shape} must be {shape}")
    return np.ascontiguousarray(part, real)


# ---------------------------------------------------------------- BLAS and LAPACK in compiled code
def _external(module, name, count):
    """A routine of scipy with so many arguments, all of them addresses, those of integers to 32 bits."""
    if "int64" in str(module.__pyx_capi__[name]):
        raise ImportError("scipy: this build has 64-bit integers in BLAS; one with 32 bits, as on PyPI, is needed")
    address = get_cython_function_address(module.__name__, name)
    if numba.config.DISABLE_JIT:  # type: ignore[attr-defined]
        return ctypes.CFUNCTYPE(None, *[ctypes.c_size_t] * count)(address)
    llvmlite.binding.add_symbol("scipy_" + name, address)
    return types.ExternalFunction("scipy_" + name, types.void(*[types.uintp] * count))


_sgetrf, _dgetrf = (_external(cython_lapack, letter + "getrf", 6) for letter in "sd")
_strsm, _dtrsm = (_external(cython_blas, letter + "trsm", 11) for letter in "sd")
_sgemm, _dgemm = (_external(cython_blas, letter + "gemm", 13) for letter in "sd")
_strsv, _dtrsv = (_external(cython_blas, letter + "trsv", 8) for letter in "sd")
_sgemv, _dgemv = (_external(cython_blas, letter + "gemv", 11) for letter in "sd")
# The letters of BLAS; of the diagonal, _ONES is not looked at. Each call ends with a look at ``sizes``: numba frees an
# array after its last use, and the routine has but its address.
_RIGHT, _UPPER, _LOWER, _PLAIN, _TURNED, _ONES, _ANY = (ord(letter) for letter in "RULNTUN")


@njit
def _at(A, i, j):
    """Address of A[i, j] of a C array; one row or column too far where nothing is taken from there."""
    return A.ctypes.data + A.itemsize * (i * A.shape[1] + j)


@njit
def _getrf(m, n, A, lda, exchanges, signs):
    """LU of A (m, n) in place; whether it met a pivot of zero."""
    sizes = np.array([m, n, lda, 0], np.int32)
    s = sizes.ctypes.data
    if n and signs.itemsize == 4:
        _sgetrf(s, s + 4, A, s + 8, exchanges.ctypes.data, s + 12)
    elif n:
        _dgetrf(s, s + 4, A, s + 8, exchanges.ctypes.data, s + 12)
    return sizes[3] != 0


@njit
def _trsm(triangle, turned, diagonal, m, n, A, lda, B, ldb, signs):
    """B (m, n) = B A^-1 with a triangle of A (n, n), or with A turned."""
    sizes = np.array([_RIGHT, triangle, turned, diagonal, m, n, lda, ldb], np.int32)
    s, one = sizes.ctypes.data, signs.ctypes.data
    if m and n and signs.itemsize == 4:
        _strsm(s, s + 4, s + 8, s + 12, s + 16, s + 20, one, A, s + 24, B, s + 28)
    elif m and n:
        _dtrsm(s, s + 4, s + 8, s + 12, s + 16, s + 20, one, A, s + 24, B, s + 28)
    return sizes[0]


@njit
def _gemm(m, n, k, A, lda, B, ldb, C, ldc, signs):
    """C (m, n) -= A (m, k) B^T."""
    sizes = np.array([_PLAIN, _TURNED, m, n, k, lda, ldb, ldc], np.int32)
    s, one = sizes.ctypes.data, signs.ctypes.data
    minus = one + signs.itemsize
    if m and n and k and signs.itemsize == 4:
        _sgemm(s, s + 4, s + 8, s + 12, s + 16, minus, A, s + 20, B, s + 24, one, C, s + 28)
    elif m and n and k:
        _dgemm(s, s + 4, s + 8, s + 12, s + 16, minus, A, s + 20, B, s + 24, one, C, s + 28)
    return sizes[0]


@njit
def _trsv(triangle, turned, diagonal, n, A, lda, x, signs):
    """x (n) = A^-1 x with a triangle of A, or with A turned."""
    sizes = np.array([triangle, turned, diagonal, n, lda, 1], np.int32)
    s = sizes.ctypes.data
    if n and signs.itemsize == 4:
        _strsv(s, s + 4, s + 8, s + 12, A, s + 16, x, s + 20)
    elif n:
        _dtrsv(s, s + 4, s + 8, s + 12, A, s + 16, x, s + 20)
    return sizes[0]


@njit
def _gemv(turned, m, n, A, lda, x, y, signs):
    """y -= A x with A (m, n), or with A turned."""
    sizes = np.array([turned, m, n, lda, 1], np.int32)
    s, one = sizes.ctypes.data, signs.ctypes.data
    minus = one + signs.itemsize
    if m and n and signs.itemsize == 4:
        _sgemv(s, s + 4, s + 8, minus, A, s + 12, x, s + 16, one, y, s + 16)
    elif m and n:
        _dgemv(s, s + 4, s + 8, minus, A, s + 12, x, s + 16, one, y, s + 16)
    return sizes[0]


# ---------------------------------------------------------------- the elimination
@compiled
def _order(exchanges, order):
    """The order of rows after LAPACK's exchanges, counted from 1."""
    for i in range(order.size):
        order[i] = i
    for i in range(exchanges.size):
        j = exchanges[i] - 1
        order[i], order[j] = order[j], order[i]


@compiled
def _eliminate(rest, left, right, beside, opened, cell, ahead, columns, rows, signs):
    """Factors of some nodes; how many were singular.

    rest (p + k, n): open and full rows at the first of them, and then at the node after the last. left, right (m, n, n)
    of the cells, beside (m, k, n) of the full rows at their right nodes. Of the n unknowns p are taken away by the open
    rows, q by the cell's.
    """
    m, q, n = ahead.shape
    p, k, singular = n - q, beside.shape[1], 0
    first, second = np.empty(p, np.int32), np.empty(q, np.int32)
    for i in range(m):
        o, c = opened[i], cell[i]
        o[:] = rest[:p]
        singular += _getrf(n, p, _at(o, 0, 0), n, first, signs)
        _order(first, columns[i])
        for j in range(n):
            column = columns[i, j]
            for r in range(n):
                c[j, r] = left[i, r, column]
            for r in range(k):
                c[j, n + r] = rest[p + r, column]
        _trsm(_LOWER, _TURNED, _ONES, n + k, p, _at(o, 0, 0), n, _at(c, 0, 0), n + k, signs)
        _gemm(n + k, q, p, _at(c, 0, 0), n + k, _at(o, 0, p), n, _at(c, p, 0), n + k, signs)
        singular += _getrf(n, q, _at(c, p, 0), n + k, second, signs)
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
        rest[p:] = beside[i]
        _trsm(_LOWER, _TURNED, _ONES, n, q, _at(c, p, 0), n + k, _at(a, 0, 0), n, signs)
        _trsm(_UPPER, _PLAIN, _ANY, k, q, _at(c, p, 0), n + k, _at(c, p, n), n + k, signs)
        _gemm(n, p + k, q, _at(a, 0, 0), n, _at(c, p, q), n + k, _at(rest, 0, 0), n, signs)
    return singular


@compiled
def _solve(start, cells, end, border, opened, cell, ahead, columns, rows, last, last_rows, signs):
    """Solution (N, n) for right-hand sides (p,), (N - 1, n), (n - p - k,) and (k,)."""
    m, q, n = ahead.shape
    p, k = n - q, border.size
    result, x = np.empty((m, n), signs.dtype), np.empty((m + 1, n), signs.dtype)
    rest, right = np.empty(p + k, signs.dtype), np.empty(n + k, signs.dtype)
    rest[:p], rest[p:] = start, border
    for i in range(m):
        o, c, f = opened[i], cell[i], result[i]
        for r in range(n):
            right[r] = cells[i, rows[i, r]]
        right[n:] = rest[p:]
        f[:p] = rest[:p]
        _trsv(_UPPER, _TURNED, _ANY, p, _at(o, 0, 0), n, _at(result, i, 0), signs)
        _gemv(_PLAIN, n + k, p, _at(c, 0, 0), n + k, _at(result, i, 0), right.ctypes.data, signs)
        _trsv(_LOWER, _PLAIN, _ONES, q, _at(c, p, 0), n + k, right.ctypes.data, signs)
        _gemv(_PLAIN, p + k, q, _at(c, p, q), n + k, right.ctypes.data, right[q:].ctypes.data, signs)
        f[p:] = right[:q]
        rest[:] = right[q:]
    right[:p], right[p : n - k], right[n - k : n] = rest[:p], end, rest[p:]
    for r in range(n):
        x[m, r] = right[last_rows[r]]
    _trsv(_LOWER, _PLAIN, _ONES, n, _at(last, 0, 0), n, _at(x, m, 0), signs)
    _trsv(_UPPER, _PLAIN, _ANY, n, _at(last, 0, 0), n, _at(x, m, 0), signs)
    for i in range(m - 1, -1, -1):
        o, c, f = opened[i], cell[i], result[i]
        _gemv(_TURNED, n, q, _at(ahead[i], 0, 0), n, _at(x, i + 1, 0), _at(result, i, p), signs)
        _trsv(_UPPER, _PLAIN, _ANY, q, _at(c, p, 0), n + k, _at(result, i, p), signs)
        _gemv(_TURNED, q, p, _at(o, 0, p), n, _at(result, i, p), _at(result, i, 0), signs)
        _trsv(_LOWER, _TURNED, _ONES, p, _at(o, 0, 0), n, _at(result, i, 0), signs)
        for j in range(n):
            x[i, columns[i, j]] = f[j]
    return x
