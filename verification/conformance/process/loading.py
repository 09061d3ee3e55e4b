"""Solvers that are named on a command line: a Python file, a class in a package, or a program."""

from __future__ import annotations

import importlib
import importlib.util
import inspect
import os
import re
import shlex
import sys
from pathlib import Path
from types import ModuleType

from ..adapter import INSTANTS, LIMITS, Adapter
from .program import Program

FORMS = 'my_code.py, my_code.py:MyClass, package.module:MyClass, or a program, "./my_program --option"'
_DOTTED = re.compile(r"[A-Za-z_]\w*(\.[A-Za-z_]\w*)*:[A-Za-z_]\w*")


def load_solver(name: str) -> Adapter:
    """Return the adapter that a command line names, one of FORMS. Raises ImportError saying what is wrong."""
    path, one = name, ""
    if ".py:" in name:
        path, _, one = name.rpartition(":")
    if path.endswith(".py") and (Path(path).is_file() or len(name.split()) == 1):  # else the argument of a program
        return _only(load_file(Path(path)), one, name)
    if _DOTTED.fullmatch(name):
        module, _, one = name.partition(":")
        return _from_package(module, one)
    return _as_program(name)


def load_file(path: Path) -> ModuleType:
    """Return a Python file as a module; what lies beside it can be imported from it, as from a script."""
    path = path.resolve()
    if not path.is_file() or path.suffix != ".py":
        raise ImportError(f"{path}: a solver is brought as a Python file (.py) with an Adapter or Program class in it")
    if str(path.parent) not in sys.path:
        sys.path.append(str(path.parent))
    spec = importlib.util.spec_from_file_location(f"brought_{path.stem}", path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # where dataclasses and pickle look for it
    try:
        spec.loader.exec_module(module)
    except (Exception, SystemExit) as error:
        raise ImportError(f"{path}: cannot be imported: {type(error).__name__}: {error}") from error
    return module


def adapters_of(module: ModuleType) -> list[Adapter]:
    """Return an adapter of each class that the module itself defines. Raises ImportError naming what is wrong."""
    classes = [one for one in vars(module).values() if inspect.isclass(one) and issubclass(one, Adapter)]
    classes = [one for one in classes if one.__module__ == module.__name__]
    if not classes:
        raise ImportError(
            f"{module.__file__}: defines no class derived from verification.conformance.Adapter or Program"
        )
    return [make_adapter(one, module) for one in classes]


def make_adapter(one: type, module: ModuleType) -> Adapter:
    """Return an adapter of a class. Raises ImportError naming the file, the class and what is wrong with it."""
    try:
        adapter = one()
        if isinstance(adapter, Program):
            adapter.folder = adapter.folder or str(Path(module.__file__).parent)
            adapter.words()
        adapter.label = str(adapter.label or one.__name__)
        _check(adapter)
    except Exception as error:
        raise ImportError(f"{module.__file__}: {one.__name__}: {error}") from error
    return adapter


def _check(adapter: Adapter):
    if not any(adapter.solves(problem) for problem in LIMITS):
        raise ValueError(f"solves nothing: define {', '.join(LIMITS)}, one or more")
    for _, steps in adapter.settings:
        if INSTANTS % steps and steps % INSTANTS:
            raise ValueError(f"settings: {steps} steps in a period must divide {INSTANTS}, or be a multiple of it")


def _only(module: ModuleType, name: str, given: str) -> Adapter:
    """Return the adapter of the class of that name, or of the only one."""
    adapters = adapters_of(module)
    chosen = [one for one in adapters if name in ("", type(one).__name__)]
    names = ", ".join(type(one).__name__ for one in adapters)
    if not chosen:
        raise ImportError(f"{given}: there is no class {name}; it defines {names}")
    if len(chosen) > 1:
        raise ImportError(f"{given}: defines {names}: say which one, as {given}:{type(chosen[0]).__name__}")
    return chosen[0]


def _from_package(name: str, one: str) -> Adapter:
    if os.getcwd() not in sys.path:
        sys.path.append(os.getcwd())
    try:
        module = importlib.import_module(name)
    except (Exception, SystemExit) as error:
        raise ImportError(f"{name}: cannot be imported: {type(error).__name__}: {error}") from error
    adapter_class = getattr(module, one, None)
    if not (inspect.isclass(adapter_class) and issubclass(adapter_class, Adapter)):
        raise ImportError(f"{name}:{one}: is no class derived from verification.conformance.Adapter or Program")
    return make_adapter(adapter_class, module)


def _as_program(name: str) -> Adapter:
    """Return a Program of a command line; it is taken to solve everything, for it can say what it does not."""
    words = shlex.split(name)
    if not words:
        raise ImportError(f"a solver is wanted: {FORMS}")
    program = Program()
    program.command, program.folder, program.problems = tuple(words), os.getcwd(), tuple(LIMITS)
    program.label = Path(words[0]).name
    try:
        program.words()
    except FileNotFoundError as error:
        raise ImportError(f"{name}: {error}; a solver is {FORMS}") from None
    return program
