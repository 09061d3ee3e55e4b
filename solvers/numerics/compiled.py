"""Compile loops with numba: over arrays so small that interpreted loops take several times as long."""

from __future__ import annotations

import hashlib
from functools import partial

from numba import njit


def compiled(loop=None, *, calls=None):
    """Return the loop compiled at its first call, cached on disk for all processes where numba finds a folder.

    calls: the module with the compiled functions that the loop calls, if that is not its own. The code of these is
    cached with the loop, and numba checks no file but the loop's for changes; so a digest of the module's text stands
    in the loop's name, and with it in that of the cached file.
    """
    if loop is None:
        return partial(compiled, calls=calls)
    if calls is not None:
        text = calls.__loader__.get_source(calls.__name__)
        loop.__qualname__ += "_" + hashlib.sha256(text.encode()).hexdigest()[:16]
    try:
        return njit(cache=True)(loop)
    except RuntimeError:
        return njit(loop)
