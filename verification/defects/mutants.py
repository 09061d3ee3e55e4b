"""Mistakes that nobody thought of: one operator, comparison, sign or number of a module changed at random.

The catalogue holds mistakes that people make; mutants show whether the checks see any other change, too. One that
no check sees is either no mistake (another start, another message, an equal form) or the sign of a missing check.
"""

from __future__ import annotations

import ast
import random
import re
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

from ..tools.planting import fault_at
from .catalogue import LONG, PLANTING, files, frozen
from .defect import Defect

TESTS = Path(__file__).parents[1]
OPERATORS = {ast.Add: ("+", "-"), ast.Sub: ("-", "+"), ast.Mult: ("*", "/"), ast.Div: ("/", "*"), ast.Pow: ("**", "*"),
             ast.Lt: ("<", "<="), ast.LtE: ("<=", "<"), ast.Gt: (">", ">="), ast.GtE: (">=", ">"), ast.Eq: ("==", "!="),
             ast.NotEq: ("!=", "=="), ast.Is: ("is", "is not"), ast.IsNot: ("is not", "is"),
             ast.And: ("and", "or"), ast.Or: ("or", "and")}  # fmt: skip
NO_FORMULA = (ast.Raise, ast.JoinedStr, ast.AnnAssign, ast.arg, ast.Import, ast.ImportFrom)
"""Messages and types: to change them is no mistake of a solver."""


def module_names(solvers: Path) -> list[str]:
    """Names of the modules below ``solvers`` that hold code, as "network.nested"."""
    paths = sorted(path for path in solvers.rglob("*.py") if path.stem != "__init__")
    return [".".join(path.relative_to(solvers).with_suffix("").parts) for path in paths]


def sample(solvers: Path, count: int, modules: Iterable[str] = (), seed: int = 2026) -> list[Defect]:
    """``count`` mutants of each module, or of those that are named: all that it has where they are fewer.

    The draw of a module depends on no other one, and a larger one begins with the smaller one.
    """
    results = []
    for module in modules or module_names(solvers):
        text = (solvers / f"{module.replace('.', '/')}.py").read_text(encoding="utf-8")
        places = list(changes(text))
        random.Random(f"{seed} {module}").shuffle(places)
        results += [mutant(module, text, *change) for change in places[:count]]
    return results


def changes(text: str) -> Iterator[tuple[int, int, str]]:
    """(start, end, new text) of every change of one place; offsets in the text as bytes."""
    source, lines = text.encode(), text.encode().splitlines(keepends=True)
    starts = [sum(map(len, lines[:i])) for i in range(len(lines))]
    begin = lambda node: starts[node.lineno - 1] + node.col_offset
    end = lambda node: starts[node.end_lineno - 1] + node.end_col_offset

    def between(left, right, operator):
        old, new = OPERATORS.get(type(operator), ("", ""))
        at = source.find(old.encode(), end(left), begin(right)) if old else -1
        if at >= 0:
            yield at, at + len(old), new

    def visit(node):
        if isinstance(node, NO_FORMULA):
            return
        if isinstance(node, ast.BinOp):
            yield from between(node.left, node.right, node.op)
        elif isinstance(node, ast.Compare):
            for left, operator, right in zip([node.left, *node.comparators], node.ops, node.comparators, strict=False):
                yield from between(left, right, operator)
        elif isinstance(node, ast.BoolOp):
            for left, right in zip(node.values, node.values[1:], strict=False):
                yield from between(left, right, node.op)
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
            yield begin(node), begin(node) + 1, " "
        elif isinstance(node, ast.Constant) and type(node.value) in (int, float):
            yield begin(node), end(node), repr(node.value + 1 if type(node.value) is int else 1.5 * node.value or 0.5)
        for child in ast.iter_child_nodes(node):
            yield from visit(child)

    return visit(ast.parse(text))


def mutant(module: str, text: str, start: int, end: int, new: str) -> Defect:
    """Return a change as a defect, named by the function and the code that it changes there."""
    fault = fault_at(module, text, start, end, new)
    shown = " ".join(f"{fault.old} -> {fault.new}".split()) + (f" ({fault.occurrence})" if fault.occurrence else "")
    return Defect(f"{module}.{fault.function}: {shown}", fault, "factor", shown, check(module))


def check(module: str) -> str:
    """All files of tests of a module at one go, but what is long, plants mistakes itself or compares with a file."""
    names = files(module)
    return " ".join((*names, *filter(None, map(deselected, names))))


@cache
def deselected(file: str) -> str:
    """Options that leave out the tests of a file that are long, plant mistakes themselves or compare with a file."""
    words = (*PLANTING.get(file, ()), *LONG.get(file, ()))
    functions = re.findall(r"^def (test_\w+)", (TESTS / file).read_text(encoding="utf-8"), re.MULTILINE)
    left_out = [name for name in functions if any(word in name for word in words) or frozen(f"{file}::{name}")]
    return " ".join(f"--deselect=verification/{file}::{name}" for name in left_out)
