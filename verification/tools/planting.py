"""Faults planted in the solvers: one expression or some statements of one function take the place of others.

A fault addresses the function and the syntax in it, not a text: line breaks, brackets, comments and the names of
local variables may change. It is applied to a copy of the project on disk, to a second package of solvers in memory, or
to a function of the solvers themselves.
"""

from __future__ import annotations

import ast
import importlib
import importlib.abc
import importlib.util
import inspect
import re
import sys
import textwrap
import threading
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from types import CodeType, ModuleType

from .patterns import (
    Pattern,
    Place,
    find_definitions,
    line_starts,
    module_syntax,
    same_code,
    undefined_names,
    units_around,
)

ROOT = Path(__file__).parents[2]
PLANTED = "planted_solvers"
"""Name of the package in memory."""
_READING = threading.Lock()
"""Held while syntax is read: up to 3.12 Python counts the depth of a tree for all threads together, and may fail."""


@dataclass(frozen=True)
class Fault:
    """In ``function`` of a module of solvers, ``old`` becomes ``new``.

    module : path below ``solvers`` with dots, without .py
    function : qualified name, as "Stepper.step"; "" for what the module does by itself, a class for its own statements
    old, new : an expression, statements (``pass`` for none), or ``name=value`` of a call or of a parameter
    occurrence : which of several equal places, from 1 on; with 0 there has to be one alone
    where : other code of the function that has the local variables of ``new`` which are not in ``old``

    Names in ``old`` that the function does not have stand for its local variables, each for one: after a variable was
    renamed the fault is still found, and ``new`` takes over the name.
    """

    module: str
    function: str
    old: str
    new: str
    occurrence: int = 0
    where: str = ""

    @property
    def path(self) -> str:
        """File of the module, relative to the root of the project."""
        return f"solvers/{self.module.replace('.', '/')}.py"

    def __str__(self) -> str:
        nth = f", place {self.occurrence}" if self.occurrence else ""
        where = f", where {self.where!r}" if self.where else ""
        return f"{self.path}, {self.function or 'outside functions'}: {self.old!r} -> {self.new!r}{nth}{where}"

    def apply_to(self, text: str) -> str:
        """Return the text of the module with the fault.

        Raises ValueError where ``old`` is not there or not alone, or where ``new`` names what nobody defines.
        """
        try:
            with _READING:
                return self._applied(text)
        except ValueError as error:
            raise ValueError(f"{self}: {error}") from error

    def _applied(self, text: str) -> str:
        tree, source = ast.parse(text), text.encode()
        path, pattern = find_definitions(tree, self.function), Pattern(self.old, self.new)
        place, before = _choose(pattern.places(path[-1]), self.occurrence), module_syntax(source)
        if self.where:
            place.names.update(_choose(Pattern(self.where, self.where).places(path[-1], place.names), 0).names)
        new = pattern.replacement(place)
        if unknown := undefined_names(new, path):
            raise ValueError(f"nothing defines {', '.join(sorted(unknown))}")
        start, end = place.span(line_starts(source))
        as_given = not place.names and type(new[0]) is type(pattern.new[0])
        written = self.new if as_given else "\n".join(map(ast.unparse, new))
        place.put(new)
        if len(path) == 1:
            wanted = tuple(map(_dump, tree.body))
        else:  # one statement of the module is another
            wanted = tuple(
                _dump(node) if node is path[1] else part for node, part in zip(tree.body, before, strict=True)
            )
        for piece in _layouts(written, source, start):
            changed = source[:start] + piece.encode() + source[end:]
            if _syntax(changed) == wanted:
                return changed.decode()
        raise ValueError("the new code cannot stand where the old one stands")

    def write_to(self, root: Path):
        """Plant it in the copy of the project at ``root``."""
        path = root / self.path
        path.write_text(self.apply_to(path.read_text(encoding="utf-8")), encoding="utf-8", newline="")


def _choose(places: list[Place], occurrence: int) -> Place:
    """The place meant. Raises ValueError where it is not there, or not the only one."""
    if not occurrence and len(places) != 1:
        raise ValueError(f"found {len(places)} times, not once")
    if occurrence > len(places):
        raise ValueError(f"found {len(places)} times, not {occurrence}")
    return places[max(occurrence, 1) - 1]


def _dump(node: ast.stmt) -> str:
    return ast.dump(ast.Module([node], []))


def _syntax(source: bytes) -> tuple[str, ...]:
    """The syntax of a text; none where it is no code."""
    try:
        return module_syntax(source)
    except SyntaxError:
        return ()


def _layouts(written: str, source: bytes, start: int) -> Iterator[str]:
    """Ways to write new code at an offset of the text: as it is, indented, in brackets, after an ``el`` of ``elif``."""
    first = source.rfind(b"\n", 0, start) + 1
    lines = textwrap.dedent(written).strip().splitlines()
    code = f"\n{' ' * (start - first)}".join(lines)
    yield code
    yield f"({code})"
    yield f"el{code}"


# ---------------------------------------------------------------- a second package of solvers, in memory
class _Modules(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Finds one module of the package in memory, and gives it the text with the fault."""

    def __init__(self, fault: Fault):
        self.name, self.path = f"{PLANTED}.{fault.module}", ROOT / fault.path
        text = self.path.read_text(encoding="utf-8")
        self.text = fault.apply_to(text)
        # numba keeps compiled loops by the name of their file: those with a fault must not be taken for the true ones
        file = f"<{self.path.name} with a fault>" if "compiled import" in text else str(self.path)
        self.code = compile(self.text, file, "exec")

    def find_spec(self, fullname, path, target=None):
        """Says how to load the module with the fault; all others are left to Python."""
        if fullname != self.name:
            return None
        return importlib.util.spec_from_loader(fullname, self, origin=str(self.path))

    def get_source(self, fullname):
        """Return the text with the fault."""
        return self.text

    def exec_module(self, module):
        """Runs the text with the fault."""
        module.__file__ = str(self.path)
        exec(self.code, module.__dict__)


class _Package:
    """A package whose modules and packages are its attributes, too, imported when first asked for."""

    def __init__(self, name):
        self._name = name

    def __getattr__(self, part):
        package = importlib.import_module(self._name)
        value = getattr(package, part) if hasattr(package, part) else importlib.import_module(f"{self._name}.{part}")
        return _Package(value.__name__) if hasattr(value, "__path__") else value


@contextmanager
def planted(fault: Fault) -> Iterator[_Package]:
    """Give a second package of solvers with the fault in it; its modules are its attributes."""
    package, modules = ModuleType(PLANTED), _Modules(fault)
    package.__path__ = [str(ROOT / "solvers")]
    sys.modules[PLANTED] = package
    sys.meta_path.insert(0, modules)
    try:
        importlib.import_module(modules.name)
        yield _Package(PLANTED)
    finally:
        sys.meta_path.remove(modules)
        for name in [name for name in sys.modules if name == PLANTED or name.startswith(f"{PLANTED}.")]:
            del sys.modules[name]


# ---------------------------------------------------------------- a function of the solvers themselves
def plant_in_place(fault: Fault, monkeypatch):
    """Give the function itself, wherever it was imported, the code with the fault until the test ends.

    Raises ValueError for a fault outside the function's body: its defaults and decorators stay as they are.
    """
    text = (ROOT / fault.path).read_text(encoding="utf-8")
    code = compile(fault.apply_to(text), str(ROOT / fault.path), "exec")
    function = importlib.import_module(f"solvers.{fault.module}")
    for name in fault.function.split("."):
        code = next(part for part in code.co_consts if isinstance(part, CodeType) and part.co_name == name)
        function = inspect.getattr_static(function, name)
    for wrapper in ("fget", "func", "__func__"):  # of property, cached_property, class and static methods
        function = getattr(function, wrapper, function)
    if all(getattr(code, part) == getattr(function.__code__, part) for part in ("co_code", "co_consts", "co_names")):
        raise ValueError(f"{fault}: changes nothing in the body of the function")
    monkeypatch.setattr(function, "__code__", code)


# ---------------------------------------------------------------- faults by rule
def fault_at(module: str, text: str, start: int, end: int, new: str) -> Fault:
    """Return the fault that puts ``new`` in place of the bytes from start to end of the module's text.

    It names the smallest unit around them: an expression that is no bare name or number, an argument or a statement.
    Raises ValueError where no such unit gives the same code.
    """
    source, piece = text.encode(), new.encode()
    wanted, tree = _syntax(source[:start] + piece + source[end:]), ast.parse(source)
    for function, begin, stop, lead in units_around(tree, source, start, end):
        old, changed = source[begin:stop], source[begin:start] + piece + source[end:stop]
        fault = Fault(module, function, *(_on_one_line(lead + part.decode()) for part in (old, changed)))
        try:
            places = Pattern(fault.old, fault.new).places(find_definitions(tree, function)[-1])
            if len(places) > 1:
                spans = [place.span(line_starts(source)) for place in places]
                fault = replace(fault, occurrence=1 + spans.index((begin, stop)))
            if _syntax(fault.apply_to(text).encode()) == wanted:
                return fault
        except ValueError:
            continue
    raise ValueError(f"solvers/{module}.py: nothing around {source[start:end].decode()!r} can become {new!r}")


def _on_one_line(code: str) -> str:
    """The code with its line breaks as spaces, where that leaves it what it is."""
    code = textwrap.dedent(code).strip()
    joined = re.sub(r"([(\[{]) | ([)\]}])", r"\1\2", re.sub(r"\s*\n\s*", " ", code))
    joined = re.sub(r",([)\]}])", r"\1", joined)
    same = "\n" in code and same_code(code, joined)
    return joined if same else code


def sign_faults(module: str, functions: Iterable[str], every: int = 1) -> list[Fault]:
    """Return a fault for each term of each sum, and for each value of an entry that is set: its sign is the other one.

    functions : without the names of their classes; every : 2 for every other term, and so on
    """
    text = (ROOT / Fault(module, "", "", "").path).read_text(encoding="utf-8")
    source = text.encode()
    starts, spans = line_starts(source), {}
    for function in ast.walk(ast.parse(text)):
        if isinstance(function, ast.FunctionDef) and function.name in functions:
            for term in _terms(function):
                begin = starts[term.lineno - 1] + term.col_offset
                end = starts[term.end_lineno - 1] + term.end_col_offset
                spans[begin, end] = f"(-({source[begin:end].decode()}))"
    return [fault_at(module, text, *span, new) for span, new in list(spans.items())[::every]]


def _terms(function: ast.FunctionDef) -> Iterator[ast.expr]:
    """Nodes that carry a sign: operands of + and -, and values of entries that are set, but nothing in a subscript."""
    inside = {id(node) for s in ast.walk(function) if isinstance(s, ast.Subscript) for node in ast.walk(s.slice)}
    is_sum = lambda node: isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub)
    for node in ast.walk(function):
        if id(node) in inside:
            continue
        if is_sum(node):
            terms = [node.left, node.right]
        elif isinstance(node, ast.Assign | ast.AugAssign):
            target = node.targets[0] if isinstance(node, ast.Assign) else node.target
            places = target.elts if isinstance(target, ast.Tuple) else [target]
            values = node.value.elts if isinstance(node.value, ast.Tuple) else [node.value]
            terms = values if all(isinstance(place, ast.Subscript) for place in places) else []
        else:
            continue
        yield from (term for term in terms if not is_sum(term))
