"""Compile loops with numba: over arrays so small that interpreted loops take several times as long."""

from __future__ import annotations

import hashlib
import inspect
from functools import partial

from numba import njit


def _source_of(module) -> str:
    """Return the text of a module. pytest's own loader, which takes installed packages with a plugin, gives none."""
    loader = module.__loader__
    return loader.get_source(module.__name__) if hasattr(loader, "get_source") else inspect.getsource(module)


def compiled(loop=None, *, calls=()):
    """Return the loop compiled at its first call, cached on disk for all processes where numba finds a folder.

    A division by zero gives inf or NaN, as in numpy, and other threads run beside the loop.
    calls: the modules with the compiled functions that the loop calls, beside its own. The code of these is cached with
    the loop, and numba checks no file but the loop's for changes; so a digest of their text stands in the loop's name,
    and with it in that of the cached file.
    """
    if loop is None:
        return partial(compiled, calls=calls)
    if calls:
        text = "".join(map(_source_of, calls))
        loop.__qualname__ += "_" + hashlib.sha256(text.encode()).hexdigest()[:16]
    try:
        return njit(cache=True, nogil=True, error_model="numpy")(loop)
    except RuntimeError:
        return njit(nogil=True, error_model="numpy")(loop)
