"""Blocks of a chain as one dense matrix."""

from __future__ import annotations

import numpy as np


def assemble(start, cells, end, border=()) -> np.ndarray:
    """Return the dense matrix of blocks start (p, n, *S), cells (2, N - 1, n, n, *S), end (e, n, *S), border (k, N, n).

    Rows start, cells, end, border; (rows, N n, *S).
    """
    (p, n), count = start.shape[:2], cells.shape[1]
    matrix = np.zeros((p + count * n + len(end) + len(border), (count + 1) * n, *start.shape[2:]))
    matrix[:p, :n] = start
    for i in range(count):
        rows = slice(p + i * n, p + (i + 1) * n)
        matrix[rows, i * n : (i + 1) * n], matrix[rows, (i + 1) * n : (i + 2) * n] = cells[:, i]
    last = p + count * n + len(end)
    matrix[p + count * n : last, count * n :] = end
    if len(border):
        matrix[last:] = border.reshape(len(border), -1)
    return matrix
