"""LU of a block-tridiagonal matrix with blocks of two or three rows: plain loops, no LAPACK, cost linear in the nodes.

Without exchanges of rows: mass, stiffness and drag of a line have positive diagonal blocks.
"""

from __future__ import annotations

import numpy as np

from ..numerics.compiled import compiled


@compiled
def factorise(line, diagonal, right, left, is_prescribed):
    """Replace the blocks by their LU factors, diagonal ones by inverses; rows of is_prescribed nodes are those of 1."""
    n, nodes = len(line.current), diagonal.shape[0]
    row = np.empty(n)
    for i in range(nodes):
        if is_prescribed[i]:
            for j in range(n):
                for k in range(n):
                    diagonal[i, j, k] = 1.0 if j == k else 0.0
                    if i < nodes - 1:
                        right[i, j, k] = 0.0
                    if i > 0:
                        left[i - 1, j, k] = 0.0
            continue
        if i > 0:
            for j in range(n):
                for k in range(n):
                    row[k] = left[i - 1, j, k]
                for k in range(n):
                    total = 0.0
                    for p in range(n):
                        total += row[p] * diagonal[i - 1, p, k]
                    left[i - 1, j, k] = total
                for k in range(n):
                    for p in range(n):
                        diagonal[i, j, k] -= left[i - 1, j, p] * right[i - 1, p, k]
        for p in range(n):  # Gauss and Jordan
            pivot = 1 / diagonal[i, p, p]
            diagonal[i, p, p] = 1.0
            for k in range(n):
                diagonal[i, p, k] *= pivot
            for j in range(n):
                if j != p:
                    factor = diagonal[i, j, p]
                    diagonal[i, j, p] = 0.0
                    for k in range(n):
                        diagonal[i, j, k] -= factor * diagonal[i, p, k]


@compiled
def solve(line, diagonal, right, left, x):
    """Replace x (N, n) by the solution for that right-hand side; the blocks as ``factorise`` leaves them."""
    n, nodes = len(line.current), x.shape[0]
    for i in range(1, nodes):
        for j in range(n):
            total = x[i, j]
            for k in range(n):
                total -= left[i - 1, j, k] * x[i - 1, k]
            x[i, j] = total
    column = np.empty(n)
    for i in range(nodes - 1, -1, -1):
        for j in range(n):
            column[j] = x[i, j]
            if i < nodes - 1:
                for k in range(n):
                    column[j] -= right[i, j, k] * x[i + 1, k]
        for j in range(n):
            total = 0.0
            for k in range(n):
                total += diagonal[i, j, k] * column[k]
            x[i, j] = total
