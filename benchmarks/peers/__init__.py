"""Other codes under the same cases: one small class a code, used as its own documentation says, with its defaults.

Here are the peers, where they are installed, and what is brought: ``python -m reports --solver my_code.py``, or the
files that the environment variable MOORING_SOLVERS names. verification/conformance/adapter.py says what such a class
has, program.py there what a program reads and prints.
"""

from __future__ import annotations

import importlib
import os
from functools import cache
from pathlib import Path
from types import ModuleType

import numpy as np

from verification.conformance.adapter import INSTANTS, LIMITS, Adapter, Refused, SpanAnswer
from verification.conformance.process import program
from verification.conformance.process.loading import adapters_of, load_file
from verification.conformance.process.program import Program

__all__ = ["INSTANTS", "LIMITS", "Adapter", "Program", "Refused", "SpanAnswer", "adapters", "program"]

PACKAGES = ("moorpy", "pycatenary", "moordyn")
"""Modules here, each named after the package that it needs."""

BROUGHT = "MOORING_SOLVERS"
"""Environment variable: files with adapters, separated as in PATH."""

OURS = ("this project", "catenary", "planar", "six fields", "reference", "harmonic balance", "time domain",
        "monolithic", "nested")  # fmt: skip
"""How the names and labels of this project's own rows begin."""


@cache
def adapters() -> dict[str, Adapter]:
    """Name -> adapter of every installed peer, then of every class that is brought.

    Raises ImportError for a package that is installed and does not import, and for a file that brings no adapter.
    """
    adapters_by_name = {}
    files = [Path(name) for name in os.environ.get(BROUGHT, "").split(os.pathsep) if name]
    for module in (*filter(None, map(_peer, PACKAGES)), *map(load_file, files)):
        for adapter in adapters_of(module):
            taken = {word for one in adapters_by_name.values() for word in (one.name, one.label)}
            for word, what in ((adapter.name, "class"), (adapter.label, "label")):
                if word in taken or word.startswith(OURS):
                    raise ImportError(f"{module.__file__}: {word!r} is taken: give another {what}")
            adapters_by_name[adapter.name] = adapter
    return adapters_by_name


def solving(problem: str) -> dict[str, Adapter]:
    """Those that solve "span", "network" or "cable"."""
    return {name: adapter for name, adapter in adapters().items() if adapter.solves(problem)}


def _peer(package: str) -> ModuleType | None:
    """The module of a peer; None where its package is not installed."""
    try:
        with np.errstate():  # pycatenary sets numpy's error state for the whole process when imported
            return importlib.import_module(f"{__name__}.{package}")
    except Exception as error:
        if isinstance(error, ModuleNotFoundError) and error.name == package:
            return None
        raise ImportError(f"{package} is installed but cannot be imported: {error!r}") from error
