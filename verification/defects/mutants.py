"""Mistakes that nobody thought of: one operator, comparison, sign or number of a module changed at random.

The catalogue holds mistakes that people make; mutants show whether the checks see any other change, too. One that
no check sees is either no mistake (another start, another message, an equal form) or the sign of a missing check.
"""

from __future__ import annotations

import ast
import random
import re
from collections.abc import Iterator
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


def sample(solvers: Path, count: int, seed: int = 2026) -> list[Defect]:
    """``count`` mutants over all modules, as many of each as it has places for, but two at least."""
    draw, found = random.Random(seed), []
    paths = [path for path in sorted(solvers.rglob("*.py")) if path.stem != "__init__"]
    name = lambda path: ".".join(path.relative_to(solvers).with_suffix("").parts)
    texts = {name(path): path.read_text(encoding="utf-8") for path in paths}
    places = {module: list(changes(text)) for module, text in texts.items()}
    total = sum(map(len, places.values()))
    for module, mine in places.items():
        for change in draw.sample(mine, min(len(mine), max(2, round(count * len(mine) / total)))):
            found.append(mutant(module, texts[module], *change))
    return found


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


@cache
def check(module: str) -> str:
    """All files of tests of a module at one go, but what is long, plants mistakes itself or compares with a file."""
    names, left_out = (*files(module), "common/test_found_by_defects.py"), []
    for name in names:
        words = (*PLANTING.get(name, ()), *LONG.get(name, ()))
        for function in re.findall(r"^def (test_\w+)", (TESTS / name).read_text(encoding="utf-8"), re.MULTILINE):
            if any(word in function for word in words) or frozen(f"{name}::{function}"):
                left_out.append(f"--deselect=verification/{name}::{function}")
    return " ".join((*names, *left_out))
