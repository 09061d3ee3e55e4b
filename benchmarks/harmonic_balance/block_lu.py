"""Eliminations without BLAS by address, to be timed against BlockChain: plain loops, and numba's np.dot.

They eliminate the matrix of BlockChain in the same order and with the same choice of pivots, but on rows of C arrays.
With np.dot only the two large products of a node are its: smaller ones cost more than they save.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numba import njit

PANEL = 8  # rows or columns that are eliminated before the others are updated
FASTMATH = {"loops": False, "contracted loops": {"contract"}, "np.dot": False}
"""Name of an elimination -> the option of numba; contracted: products and sums rounded once."""


def _subtract_loops(C, A, B):
    """C -= A B, eight rows of B at a time: so many terms for each element of C that is loaded and stored."""
    (m, n), k = C.shape, B.shape[0]
    for i in range(m):
        c, a, s = C[i], A[i], 0
        while s + 8 <= k:
            b0, b1, b2, b3 = B[s], B[s + 1], B[s + 2], B[s + 3]
            b4, b5, b6, b7 = B[s + 4], B[s + 5], B[s + 6], B[s + 7]
            a0, a1, a2, a3, a4, a5, a6, a7 = a[s], a[s + 1], a[s + 2], a[s + 3], a[s + 4], a[s + 5], a[s + 6], a[s + 7]
            for j in range(n):
                first = (a0 * b0[j] + a1 * b1[j]) + (a2 * b2[j] + a3 * b3[j])
                c[j] -= first + ((a4 * b4[j] + a5 * b5[j]) + (a6 * b6[j] + a7 * b7[j]))
            s += 8
        for r in range(s, k):
            b, factor = B[r], a[r]
            for j in range(n):
                c[j] -= factor * b[j]


def _subtract_dot(C, A, B):
    """C -= A B by numba's np.dot, whose arrays have to be contiguous."""
    if C.size and B.size:
        C -= np.dot(np.ascontiguousarray(A), np.ascontiguousarray(B))


@cache
def build(name):
    """Return the compiled functions (eliminate, factor_by_rows, solve) of one of FASTMATH."""
    compiled = njit(fastmath=FASTMATH[name], boundscheck=False, error_model="numpy")
    subtract = compiled(_subtract_loops)
    subtract_large = compiled(_subtract_dot) if name == "np.dot" else subtract

    @compiled
    def divide_right(C, U, count):
        """C[:, :count] = C[:, :count] U^-1 with the upper triangle of U, and C[:, count:] without its share."""
        for first in range(0, count, PANEL):
            last = min(first + PANEL, count)
            for c in C:
                for s in range(first, last):
                    c[s] /= U[s, s]
                    for j in range(s + 1, last):
                        c[j] -= c[s] * U[s, j]
            subtract(C[:, last:count], C[:, first:last], U[first:last, last:count])
        subtract_large(C[:, count:], C[:, :count], U[:count, count:])

    @compiled
    def divide_left(L, A):
        """A = L^-1 A with the lower triangle of L, whose diagonal is one."""
        for first in range(0, len(A), PANEL):
            last = min(first + PANEL, len(A))
            subtract(A[first:last], L[first:last, :first], A[:first])
            for r in range(first + 1, last):
                subtract_row(A[r], L[r, first:r], A[first:r])

    @compiled
    def subtract_row(c, a, B):
        """c -= a B."""
        for s in range(a.size):
            factor, b = a[s], B[s]
            for j in range(c.size):
                c[j] -= factor * b[j]

    @compiled
    def factor_by_columns(o, columns):
        """LU of o (p, n) with column exchanges, U with the diagonal; whether it met a pivot of zero."""
        (p, n), singular = o.shape, False
        for j in range(n):
            columns[j] = j
        for r in range(p):
            divide_right(o[r : r + 1], o, r)
            pivot = r
            for j in range(r + 1, n):
                if abs(o[r, j]) > abs(o[r, pivot]):
                    pivot = j
            singular |= not abs(o[r, pivot]) > 0
            columns[r], columns[pivot] = columns[pivot], columns[r]
            for row in o:
                row[r], row[pivot] = row[pivot], row[r]
        return singular

    @compiled
    def factor_by_rows(C, p, n, rows):
        """LU of C[:n, p:] with exchanges of its first n rows, L with ones; the rows after n are updated, too."""
        q, singular = C.shape[1] - p, False
        for i in range(n):
            rows[i] = i
        S = C[:, p:]
        for first in range(0, q, PANEL):
            last = min(first + PANEL, q)
            for s in range(first, last):
                pivot = s
                for r in range(s + 1, n):
                    if abs(S[r, s]) > abs(S[pivot, s]):
                        pivot = r
                singular |= not abs(S[pivot, s]) > 0
                if pivot != s:
                    rows[s], rows[pivot] = rows[pivot], rows[s]
                    for j in range(C.shape[1]):
                        C[s, j], C[pivot, j] = C[pivot, j], C[s, j]
                top = S[s]
                for r in range(s + 1, len(S)):
                    row = S[r]
                    l = row[s] / top[s]
                    row[s] = l
                    for j in range(s + 1, last):
                        row[j] -= l * top[j]
            divide_left(S[first:last, first:last], S[first:last, last:])
            subtract(S[last:, last:], S[last:, first:last], S[first:last, last:])
        return singular

    @compiled
    def eliminate(remaining, left, right, border, opened, cell, ahead, columns, rows):
        """Factors of all nodes but the last; arguments as of numerics.lu.bordered, cell (m, n + k, n) by rows."""
        m, q, n = ahead.shape
        p, singular = n - q, 0
        for i in range(m):
            o, C, a = opened[i], cell[i], ahead[i]
            o[:] = remaining[:p]
            singular += factor_by_columns(o, columns[i])
            for r in range(n):
                for j in range(n):
                    C[r, j] = left[i, r, columns[i, j]]
            for r in range(n, len(C)):
                for j in range(n):
                    C[r, j] = remaining[p + r - n, columns[i, j]]
            divide_right(C, o, p)
            singular += factor_by_rows(C, p, n, rows[i])
            for r in range(q):
                a[r] = right[i, rows[i, r]]
            for r in range(p):
                remaining[r] = right[i, rows[i, q + r]]
            remaining[p:] = border[i]
            divide_left(C[:q, p:], a)
            subtract_large(remaining, C[q:, p:], a)
        return singular

    @compiled
    def dot(a, x):
        """a x in four sums, which do not wait for each other."""
        n, s0, s1, s2, s3 = a.size, a.dtype.type(0), a.dtype.type(0), a.dtype.type(0), a.dtype.type(0)
        last = n - n % 4
        for j in range(0, last, 4):
            s0 += a[j] * x[j]
            s1 += a[j + 1] * x[j + 1]
            s2 += a[j + 2] * x[j + 2]
            s3 += a[j + 3] * x[j + 3]
        for j in range(last, n):
            s0 += a[j] * x[j]
        return (s0 + s1) + (s2 + s3)

    @compiled
    def solve(start, cells, end, border, opened, cell, ahead, columns, rows, last, last_rows):
        """Solution (N, n) for right-hand sides (p,), (N - 1, n), (n - p - k,) and (k,)."""
        m, q, n = ahead.shape
        p, k, x = n - q, border.size, np.empty((m + 1, n), last.dtype)
        right, y, remaining = np.empty(n + k, x.dtype), np.empty(n, x.dtype), np.empty(p + k, x.dtype)
        remaining[:p], remaining[p:] = start, border
        for i in range(m):
            o, C, f = opened[i], cell[i], x[i]
            for r in range(p):
                f[r] = remaining[r] - dot(o[r, :r], f[:r])
            for r in range(n):
                right[r] = cells[i, rows[i, r]]
            right[n:] = remaining[p:]
            for r in range(len(C)):
                right[r] -= dot(C[r, :p], f[:p])
            for r in range(len(C)):
                at = min(r, q)
                right[r] -= dot(C[r, p : p + at], right[:at])
            f[p:], remaining[:] = right[:q], right[q:]
        right[:p], right[p : n - k], right[n - k : n] = remaining[:p], end, remaining[p:]
        for r in range(n):
            x[m, r] = right[last_rows[r]] - dot(last[r, :r], x[m, :r])
        for r in range(n - 1, -1, -1):
            x[m, r] = (x[m, r] - dot(last[r, r + 1 :], x[m, r + 1 :])) / last[r, r]
        for i in range(m - 1, -1, -1):
            o, C, f = opened[i], cell[i], x[i]
            for r in range(q):
                f[p + r] -= dot(ahead[i, r], x[i + 1])
            for r in range(q - 1, -1, -1):
                f[p + r] = (f[p + r] - dot(C[r, p + r + 1 :], f[p + r + 1 :])) / C[r, p + r]
            for r in range(p - 1, -1, -1):
                f[r] = (f[r] - dot(o[r, r + 1 :], f[r + 1 :])) / o[r, r]
            for j in range(n):
                y[columns[i, j]] = f[j]
            f[:] = y
        return x

    return eliminate, factor_by_rows, solve


class Alternative:
    """Factors and solution of a chain as by BlockChain, with the compiled functions that ``build`` returns."""

    def __init__(self, functions, start, cells, end, border):
        (p, n), (k, nodes), real = start.shape, border.shape[:2], start.dtype
        eliminate, factor_by_rows, self._solve = functions
        if not isinstance(cells, np.ndarray):
            cells = np.concatenate(list(cells), axis=1)
        self.opened, self.cell = np.empty((nodes - 1, p, n), real), np.empty((nodes - 1, n + k, n), real)
        self.ahead, (self.columns, self.rows) = np.empty((nodes - 1, n - p, n), real), np.empty((2, nodes - 1, n), int)
        border, remaining = np.ascontiguousarray(border.swapaxes(0, 1)), np.concatenate([start, border[:, 0]])
        factors = self.opened, self.cell, self.ahead, self.columns, self.rows
        singular = eliminate(remaining, *cells, border[1:], *factors)
        self.last, self.last_rows = np.concatenate([remaining[:p], end, remaining[p:]]), np.empty(n, int)
        singular += factor_by_rows(self.last, 0, n, self.last_rows)
        self.singular = bool(singular or not np.isfinite(self.last).all())

    def solve(self, *right):
        """Solution (N, n) for right-hand sides (p,), (N - 1, n), (n - p - k,) and (k,)."""
        right = (np.ascontiguousarray(part, self.last.dtype) for part in right)
        factors = self.opened, self.cell, self.ahead, self.columns, self.rows
        return self._solve(*right, *factors, self.last, self.last_rows).astype(float)
