"""The bordered Jacobian of a continuation, solved by the block elimination of the system itself.

    J dx + column dp = F,    row dx + corner dp = g

In the chain of dense blocks the parameter p is one more field, equal at all nodes, and (row, corner) one more full row:
the elimination then exchanges rows and columns as it does within J, and a fold, where J is singular, is like any other
point. A system with an elimination of its own solves for F and for the column (bordering algorithm, W. Govaerts,
Numerical Methods for Bifurcations of Dynamical Equilibria, 2000, 3.6): near a fold it loses the digits that J lacks.
"""

from __future__ import annotations

import numpy as np

from ...harmonic_balance.residual import HarmonicResidual
from ...numerics.lu.bordered import BlockChain


def factorise_bordered(residual, x, column, row, corner):
    """Return F at x and solve(F, g) -> (dx, dp), which is None where the bordered Jacobian is singular.

    residual: a HarmonicResidual, or what takes its place; x, row and dx (N, n); column as F; corner and dp numbers.
    """
    bordered = _extend_chain if isinstance(residual, HarmonicResidual) else _solve_twice
    return bordered(residual, x, column, row, corner)


def _extend_chain(residual, x, column, row, corner):
    """Return F and the solve of the chain with the parameter as a field."""
    rows, state = residual.rows(x, True)
    F = residual.residual(x)
    if not np.isfinite(F).all():
        return F, None
    blocks = residual.jacobian(rows, residual.slope(state))
    factors = BlockChain(*_with_parameter(blocks, residual.split(column), row, corner))

    def solve(F, g):
        start, cells, end, border = residual.split(F)
        cells = np.concatenate([cells, np.zeros((len(cells), 1))], axis=1)
        result = factors.solve(start, cells, end, np.append(border, g))
        return result[:, :-1], float(result[-1, -1])

    return F, None if factors.singular else solve


def _with_parameter(blocks, column, row, corner):
    """Return blocks of BlockChain with one more unknown a node, equal to that of its neighbour, and one more full row.

    blocks: start (p, n), cells (2, N - 1, n, n), end (e, n), border (k, N, n); column: its parts (p,), (N - 1, n), (e,)
    and (k,).
    """
    (start, cells, end, border), (by_start, by_cells, by_end, by_border) = blocks, column
    (k, nodes), n = border.shape[:2], start.shape[1]
    wide, full = np.zeros((2, nodes - 1, n + 1, n + 1)), np.zeros((k + 1, nodes, n + 1))
    wide[:, :, :n, :n] = cells
    wide[0, :, :n, n] = by_cells
    wide[0, :, n, n], wide[1, :, n, n] = -1.0, 1.0
    full[:k, :, :n] = border
    full[:k, -1, n] = by_border
    full[k, :, :n], full[k, -1, n] = row, corner
    return np.column_stack([start, by_start]), wide, np.column_stack([end, by_end]), full


def _solve_twice(residual, x, column, row, corner):
    """Return F and the solve by the bordering algorithm."""
    F, inverse = residual.linearise(x)
    if inverse is None:
        return F, None
    by_column = inverse(column)
    pivot = corner - np.vdot(row, by_column)
    if pivot == 0 or not np.isfinite(pivot):
        return F, None

    def solve(F, g):
        dx = inverse(F) if np.any(F) else np.zeros_like(by_column)
        dp = (g - np.vdot(row, dx)) / pivot
        return dx - dp * by_column, float(dp)

    return F, solve
