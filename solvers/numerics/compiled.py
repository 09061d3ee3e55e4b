"""Loops that numba compiles: where arrays are so small that interpreted loops over them take several times as long."""

from __future__ import annotations

from numba import njit


def compiled(loop):
    """Compiled at the first call: once for all processes, or in each where numba finds no folder to keep it in.

    What a loop calls has to stand in its own file: numba looks at no other for changes.
    """
    try:
        return njit(cache=True)(loop)
    except RuntimeError:
        return njit(loop)
