"""LU of a symmetric pattern of dense blocks, those of the harmonic balance of moving lines, along an Elimination.

Compiled, with the BLAS and LAPACK of scipy on each block, in the precision of the blocks. A diagonal block D is stored
as a C array, which LAPACK sees transposed: D^T = P L U. Its neighbours are divided by one triangle each, so an update
is one product,
    left D^-1 right = (left P L^-T) (U^-T right),
and a solve takes U on the way forth and L on the way back.
"""

from __future__ import annotations

import numpy as np

from ..compiled import compiled
from . import blas_by_address as blas
from .blas_by_address import LOWER, NON_UNIT, PLAIN, TRANSPOSED, UNIT, UPPER


class BlockFactors:
    """LU factors of diagonal (N, m, m), right and left (C, m, m) blocks, as ``equations.tangents`` has them.

    order: the Elimination; first, last (C,): the nodes of the cells. Blocks of float32 or float64, which the factors
    replace. ``singular``: no use to solve. Raises ValueError where shapes or precisions do not fit together.
    """

    def __init__(self, order, first, last, diagonal, right, left):
        (nodes, m), cells = diagonal.shape[:2], first.size
        for part, count in ((diagonal, nodes), (right, cells), (left, cells)):
            if part.shape != (count, m, m) or part.dtype != diagonal.dtype or not part.flags.c_contiguous:
                raise ValueError(f"blocks {part.shape} of {part.dtype} must be {(count, m, m)} of {diagonal.dtype}")
        if order.is_prescribed.size != nodes:
            raise ValueError(f"an order of {order.is_prescribed.size} nodes does not fit to {nodes} blocks")
        if order.edges > cells:
            fill = np.zeros((order.edges - cells, m, m), diagonal.dtype)
            right, left = np.concatenate([right, fill]), np.concatenate([left, fill])
        self.order, self.ends = order.with_rows(0), (first, last)  # for blocks of any size: compiled once
        self.exchanges = np.empty((nodes, m), np.int32)
        self.blocks = diagonal, right, left
        self.singular = bool(_factorise(self.order, *self.blocks, self.exchanges))

    def solve(self, F) -> np.ndarray:
        """Return the solution (N, m) in double precision for a right-hand side (N, m)."""
        if F.shape != self.exchanges.shape:
            raise ValueError(f"a right-hand side of shape {F.shape} must be {self.exchanges.shape}")
        x = np.array(F, self.blocks[0].dtype, order="C")
        _solve(self.order, *self.ends, *self.blocks, self.exchanges, x)
        return x.astype(float, copy=False)


@compiled(calls=(blas,))
def _factorise(order, diagonal, right, left, exchanges):
    """Replace the blocks by factors, exchanges (N, m) by those of LAPACK; return how many pivots were singular.

    left is stored transposed from its pivot on; blocks beside prescribed nodes stay as they are.
    """
    nodes, m, pair, singular = diagonal.shape[0], diagonal.shape[1], 0, 0
    for i in range(nodes):
        if order.is_prescribed[i]:
            continue
        lu, swaps = diagonal[i], exchanges[i]
        singular += blas.getrf(lu, swaps) or not np.isfinite(lu[m - 1, m - 1])
        for a in range(order.start[i], order.start[i + 1]):
            one = left[order.edge[a]]
            for j in range(m):
                for k in range(j):
                    one[j, k], one[k, j] = one[k, j], one[j, k]
            for j in range(m):
                r = swaps[j] - 1
                if r != j:
                    for k in range(m):
                        one[j, k], one[r, k] = one[r, k], one[j, k]
            blas.trsm(LOWER, TRANSPOSED, UNIT, lu, one)
            blas.trsm(UPPER, PLAIN, NON_UNIT, lu, right[order.edge[a]])
        for a in range(order.start[i], order.start[i + 1]):
            e = order.edge[a]
            blas.gemm(right[e], left[e], diagonal[order.other[a]])
            for b in range(a + 1, order.start[i + 1]):
                f, between = order.edge[b], order.pair[pair]
                pair += 1
                blas.gemm(right[f], left[e], right[between])
                blas.gemm(right[e], left[f], left[between])
    return singular


@compiled(calls=(blas,))
def _solve(order, first, last, diagonal, right, left, exchanges, x):
    """Replace x (N, m) by the solution; blocks and exchanges as ``_factorise`` leaves them."""
    nodes, m = x.shape
    for c in range(first.size):
        p, q = first[c], last[c]
        if order.is_prescribed[p] and not order.is_prescribed[q]:
            blas.gemv(TRANSPOSED, left[c], x[p], x[q])
        elif order.is_prescribed[q] and not order.is_prescribed[p]:
            blas.gemv(TRANSPOSED, right[c], x[q], x[p])
    for i in range(nodes):
        if order.is_prescribed[i]:
            continue
        blas.trsv(UPPER, TRANSPOSED, NON_UNIT, diagonal[i], x[i])
        for a in range(order.start[i], order.start[i + 1]):
            blas.gemv(PLAIN, left[order.edge[a]], x[i], x[order.other[a]])
    for i in range(nodes - 1, -1, -1):
        if order.is_prescribed[i]:
            continue
        for a in range(order.start[i], order.start[i + 1]):
            blas.gemv(TRANSPOSED, right[order.edge[a]], x[order.other[a]], x[i])
        blas.trsv(LOWER, TRANSPOSED, UNIT, diagonal[i], x[i])
        for j in range(m - 1, -1, -1):
            r = exchanges[i, j] - 1
            x[i, j], x[i, r] = x[i, r], x[i, j]
