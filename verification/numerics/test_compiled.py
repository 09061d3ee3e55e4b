"""Are compiled loops those of the files on disk, whatever was cached of them before?"""

from __future__ import annotations

import importlib
import os
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

from solvers.harmonic_balance import blocks
from solvers.numerics.compiled import _source_of, compiled
from solvers.numerics.lu import blas_by_address, bordered
from verification import ROOT

from ..tools.planting import PLANTED, Fault, planted


def python(program: str, cwd: Path, **environment) -> str:
    """Return what a program of Python prints in a process of its own."""
    env = os.environ | {"PYTHONPATH": str(ROOT)} | environment
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=cwd, env=env)
    assert (ended.returncode, ended.stderr) == (0, ""), ended.stderr
    return ended.stdout.strip()


def test_compiled_loops_need_no_folder():
    """Where numba finds no folder to keep them in (all are taken from it), they are compiled all the same."""
    program = """
import numpy as np
from numba.core.caching import FunctionCache
FunctionCache._impl_class._locator_classes = []
from solvers.numerics.lu.bordered import _order
order = np.empty(3, np.int32)
_order(np.array([3, 3], np.int32), order)
print(order, _order.stats.cache_path)
"""
    assert python(program, ROOT) == "[2 0 1] None"


CALLED = "from numba import njit\n@njit\ndef factor():\n    return {}\n"
LOOP = """
import called
from solvers.numerics.compiled import compiled
@compiled(calls=(called,))
def double(x):
    return called.factor() * x
"""


def test_a_changed_function_of_another_file_compiles_the_loop_anew(tmp_path):
    """A loop is taken from the disk while the function that it calls stays as it is, and not after a change."""
    (tmp_path / "loop.py").write_text(LOOP)
    program = "from loop import double; print(double(1), sum(double.stats.cache_hits.values()))"
    outputs = []
    for factor in (2, 2, 3):
        (tmp_path / "called.py").write_text(CALLED.format(factor))
        outputs.append(python(program, tmp_path, PYTHONDONTWRITEBYTECODE="1", NUMBA_CACHE_DIR=str(tmp_path / "cache")))
    assert outputs == ["2 0", "2 1", "3 0"]


def foreign(loop) -> set[str]:
    """Return the modules with compiled functions that a loop names, but for its own."""
    code, scope = loop.py_func.__code__, loop.py_func.__globals__
    values = [scope[name] for name in code.co_names if name in scope]
    modules = {v.__name__ for v in values if isinstance(v, ModuleType) and any(map(is_compiled, vars(v).values()))}
    return modules | {v.py_func.__module__ for v in values if is_compiled(v)} - {loop.py_func.__module__}


def is_compiled(value) -> bool:
    """Return whether it is a function compiled by numba."""
    return hasattr(value, "py_func")


def undeclared(module) -> list[str]:
    """Return the loops of a module that call compiled functions of another, and are kept under their bare names."""
    loops = [
        value for value in vars(module).values() if is_compiled(value) and value.py_func.__module__ == module.__name__
    ]
    names = [loop.py_func.__name__ for loop in loops if foreign(loop)]
    return [name for name in names if getattr(module, name).py_func.__qualname__ == name]


@pytest.mark.parametrize("module", [bordered, blocks], ids=lambda module: module.__name__)
def test_loops_declare_the_module_that_they_call(module):
    """Loops on the disk contain the functions of other files, whose changes numba does not see."""
    assert undeclared(module) == []


def test_a_loop_that_does_not_declare_what_it_calls_is_seen(monkeypatch):
    """The elimination with its bare name, and a loop that calls one of another module by name, are reported."""
    monkeypatch.setattr(bordered._solve.py_func, "__qualname__", "_solve")
    assert foreign(bordered._solve) == {blas_by_address.__name__} and undeclared(bordered) == ["_solve"]


def test_a_planted_fault_of_a_called_module_is_another_text():
    """Loops of solvers with a fault in what they call are not taken from the disk, where those without it are."""
    with planted(Fault("numerics.lu.blas_by_address", "gemm", "_address(_MINUS64)", "_address(_ONE64)")):
        loop = importlib.import_module(f"{PLANTED}.numerics.lu.bordered")._eliminate.py_func
    assert loop.__qualname__ != bordered._eliminate.py_func.__qualname__
    assert loop.__qualname__.startswith("_eliminate_")


def test_a_loop_without_calls_keeps_its_name():
    """Nothing stands in the name of a loop that calls its own file alone."""

    def loop(x):
        return x

    assert compiled(loop).py_func.__qualname__.endswith("<locals>.loop")


def test_the_text_of_a_module_is_read_whatever_loaded_it(monkeypatch):
    """The loader of pytest, by which installed packages with a plugin are imported, has no get_source."""
    text = Path(bordered.__file__).read_text(encoding="utf-8")
    assert _source_of(bordered) == text
    monkeypatch.setattr(bordered, "__loader__", object())
    assert _source_of(bordered) == text
