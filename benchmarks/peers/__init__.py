"""Other codes under the same cases: one small adapter a peer, used as its own documentation says, with its defaults.

An adapter has NAME, LABEL, version(), unsupported(case) -> reason or "", and solve(case, tolerance=None) -> SpanAnswer.
``solve`` only translates inputs, calls, and translates the answer: what it raises is caught by benchmarks.harness.
"""

from __future__ import annotations

import importlib
from functools import cache
from types import ModuleType

import numpy as np

PACKAGES = {"moorpy": "moorpy", "pycatenary": "pycatenary"}
"""Adapter -> the package that it needs."""


@cache
def available() -> dict[str, ModuleType]:
    """Adapter modules of the peers that are installed; ImportError for one that is installed and does not import."""
    found = {}
    for name, package in PACKAGES.items():
        try:
            with np.errstate():  # pycatenary sets numpy's error state for the whole process when imported
                found[name] = importlib.import_module(f"{__name__}.{name}")
        except Exception as error:
            if not (isinstance(error, ModuleNotFoundError) and error.name == package):
                raise ImportError(f"{package} is installed but cannot be imported: {error!r}") from error
    return found
