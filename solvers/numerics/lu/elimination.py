"""LU of a symmetric pattern of blocks of two or three rows: plain loops, no LAPACK, along the steps of an Elimination.

The cost is linear in the nodes of a line, which is block-tridiagonal, and of a network's elements, beside the Schur
complement of its joints. Without exchanges of rows: mass, stiffness and drag have positive diagonal blocks.
"""

from __future__ import annotations

from ..compiled import compiled


@compiled
def factorise(order, diagonal, right, left, row):
    """Replace the blocks of an Elimination by their LU factors, diagonal (N, n, n) ones by inverses.

    right, left (edges, n, n). row (n,): working space. Rows of prescribed nodes stay as they are.
    """
    n, pair = len(order.axes), 0
    for i in range(diagonal.shape[0]):
        if order.is_prescribed[i]:
            continue
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
        for a in range(order.start[i], order.start[i + 1]):
            e, q = order.edge[a], order.other[a]
            for j in range(n):
                for k in range(n):
                    row[k] = left[e, j, k]
                for k in range(n):
                    total = 0.0
                    for p in range(n):
                        total += row[p] * diagonal[i, p, k]
                    left[e, j, k] = total
                for k in range(n):
                    for p in range(n):
                        diagonal[q, j, k] -= left[e, j, p] * right[e, p, k]
        for a in range(order.start[i], order.start[i + 1]):
            for b in range(a + 1, order.start[i + 1]):
                e, f, between = order.edge[a], order.edge[b], order.pair[pair]
                pair += 1
                for j in range(n):
                    for k in range(n):
                        for p in range(n):
                            right[between, j, k] -= left[e, j, p] * right[f, p, k]
                            left[between, j, k] -= left[f, j, p] * right[e, p, k]


@compiled
def solve(order, diagonal, right, left, x, column):
    """Replace x (N, n), zero at prescribed nodes, by the solution; the blocks as ``factorise`` leaves them.

    column (n,): working space.
    """
    nodes, n = x.shape[0], len(order.axes)
    for i in range(nodes):
        for a in range(order.start[i], order.start[i + 1]):
            e, q = order.edge[a], order.other[a]
            for j in range(n):
                total = x[q, j]
                for k in range(n):
                    total -= left[e, j, k] * x[i, k]
                x[q, j] = total
    for i in range(nodes - 1, -1, -1):
        if order.is_prescribed[i]:
            continue
        for j in range(n):
            column[j] = x[i, j]
        for a in range(order.start[i], order.start[i + 1]):
            e, q = order.edge[a], order.other[a]
            for j in range(n):
                for k in range(n):
                    column[j] -= right[e, j, k] * x[q, k]
        for j in range(n):
            total = 0.0
            for k in range(n):
                total += diagonal[i, j, k] * column[k]
            x[i, j] = total
