"""Compile loops with numba: over arrays so small that interpreted loops take several times as long."""

from __future__ import annotations

from numba import njit


def compiled(loop):
    """Return the loop compiled at its first call, cached on disk for all processes where numba finds a folder.

    A division by zero gives inf or NaN, as in numpy, and other threads run beside the loop. What a loop calls has to
    stand in its own file: numba checks no other file for changes.
    """
    try:
        return njit(cache=True, nogil=True, error_model="numpy")(loop)
    except RuntimeError:
        return njit(nogil=True, error_model="numpy")(loop)
