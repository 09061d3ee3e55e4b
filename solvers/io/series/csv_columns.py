"""Columns of CSV files: one header line with their names, then rows; lines that start with # are comments."""

from __future__ import annotations

import csv
import math
from difflib import get_close_matches
from os import PathLike
from pathlib import Path

from ...common.outcome import InputError
from ..keys import describe_likely_key


def read_rows(
    path: str | PathLike[str], known, required: str | None = None, others: int = 0
) -> tuple[list[str], list[tuple[int, list[str]]]]:
    """Return the names of the columns and, for each row, the number of its line and its cells.

    known: the names that a column may have, or a table of Key by name, whose aliases are hints; required: one that must
    be there, beside so many others. Raises InputError naming file, line and column of what is wrong.
    """
    try:
        text = Path(path).read_text(encoding="utf-8-sig")
    except (TypeError, ValueError) as error:
        if isinstance(error, UnicodeDecodeError):
            raise InputError("cannot be read as a text file", field="path", value=path, label=str(path)) from None
        raise InputError(f"{path!r} is not the path of a CSV file", field="path", value=path) from None
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", field="path", value=path, label=str(path)) from None
    lines = [(n, line) for n, line in enumerate(text.splitlines(), start=1) if line.strip() and line.lstrip()[0] != "#"]
    if not lines:
        raise InputError(f"has no line of column names: {', '.join(known)}", field="path", label=str(path))
    names = [name.strip() for name in _cells(lines[0][1])]
    where = f"{path}:{lines[0][0]}"
    _check_names(where, names, known)
    if required is not None and (required not in names or len(names) < 1 + others):
        problem = f"columns {', '.join(names)} must be {required} and one or more of "
        problem += ", ".join(name for name in known if name != required)
        raise InputError(f"{where}: {problem}", field=required, label="")
    return names, [(number, [cell.strip() for cell in _cells(line)]) for number, line in lines[1:]]


def read_numbers(
    path: str | PathLike[str], known, required: str | None = None, others: int = 0
) -> dict[str, list[float]]:
    """Return {name of a column: its numbers}; as ``read_rows``, and every cell must be a finite number."""
    names, rows = read_rows(path, known, required, others)
    numbers = [_numbers(f"{path}:{number}", names, cells) for number, cells in rows]
    return {name: [row[i] for row in numbers] for i, name in enumerate(names)}


def _cells(line: str) -> list[str]:
    return next(csv.reader([line]))


def _check_names(where: str, names: list[str], known):
    """Raise InputError for a name that is unknown or there twice, in radians and degrees say."""
    for i, name in enumerate(names):
        if name not in known:
            hint = describe_likely_key(name, known, "columns") if isinstance(known, dict) else _nearest(name, known)
            raise InputError(f"{where}: unknown column {name!r}; {hint}", field=name, label="")
        if name.removesuffix("_deg") in [other.removesuffix("_deg") for other in names[:i]]:
            raise InputError(f"{where}: column {name!r} is there already", field=name, label="")


def _nearest(name: str, known) -> str:
    near = get_close_matches(name.lower(), known, n=1) or [k for k in known if k.lower() == name.lower()]
    return f"did you mean {near[0]!r}?" if near else f"known columns are {', '.join(known)}"


def _numbers(where: str, names: list[str], cells: list[str]) -> list[float]:
    if len(cells) != len(names):
        raise InputError(f"{where}: {len(cells)} values where there are {len(names)} columns", label="")
    numbers = []
    for name, cell in zip(names, cells, strict=True):
        try:
            number = float(cell)
        except ValueError:
            number = math.nan
        if not math.isfinite(number):
            problem = f"{where}: column {name!r}: {cell!r} must be a finite number"
            raise InputError(problem, field=name, value=cell, label="")
        numbers.append(number)
    return numbers
