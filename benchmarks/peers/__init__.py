"""Other codes under the same cases: one small class a code, used as its own documentation says, with its defaults.

Here are the peers, where they are installed, and what is brought: ``python -m reports --solver my_code.py``, or the
files that the environment variable MOORING_SOLVERS names. verification/conformance/adapter.py says what such a class
has, program.py there what a program reads and prints.
"""

from __future__ import annotations

import importlib
import importlib.util
import inspect
import os
import sys
from functools import cache
from pathlib import Path
from types import ModuleType

import numpy as np

from verification.conformance import program
from verification.conformance.adapter import INSTANTS, LIMITS, Adapter, Refused, SpanAnswer
from verification.conformance.program import Program

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
    for module in (*filter(None, map(_peer, PACKAGES)), *map(_load, files)):
        for adapter in _classes(module):
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


def _load(path: Path) -> ModuleType:
    """A Python file as a module; what lies beside it can be imported from it, as from a script."""
    path = path.resolve()
    if not path.is_file() or path.suffix != ".py":
        raise ImportError(f"{path}: a solver is brought as a Python file (.py) with an Adapter or Program class in it")
    if str(path.parent) not in sys.path:
        sys.path.append(str(path.parent))
    made = importlib.util.spec_from_file_location(f"brought_{path.stem}", path)
    module = importlib.util.module_from_spec(made)
    sys.modules[made.name] = module  # where dataclasses and pickle look for it
    try:
        made.loader.exec_module(module)
    except (Exception, SystemExit) as error:
        raise ImportError(f"{path}: cannot be imported: {type(error).__name__}: {error}") from error
    if not list(_classes(module)):
        raise ImportError(f"{path}: defines no class derived from benchmarks.peers.Adapter or Program")
    return module


def _classes(module: ModuleType):
    """An adapter of each class that the module itself defines. Raises ImportError naming what is wrong with one."""
    for one in vars(module).values():
        if not (inspect.isclass(one) and issubclass(one, Adapter) and one.__module__ == module.__name__):
            continue
        try:
            adapter = one()
            if isinstance(adapter, Program):
                adapter.folder = adapter.folder or str(Path(module.__file__).parent)
                adapter.words()
            adapter.label = str(adapter.label or one.__name__)
            _check(adapter)
        except Exception as error:
            raise ImportError(f"{module.__file__}: {one.__name__}: {error}") from error
        yield adapter


def _check(adapter: Adapter):
    if not any(adapter.solves(problem) for problem in LIMITS):
        raise ValueError("solves nothing: define span, network or cable")
    for _, steps in adapter.settings:
        if INSTANTS % steps and steps % INSTANTS:
            raise ValueError(f"settings: {steps} steps in a period must divide {INSTANTS}, or be a multiple of it")
