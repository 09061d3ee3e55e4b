"""Motion of a body in six degrees of freedom, from the [motion] table of a network file or from a series in CSV.

A series has one header line with the names of its columns, then a row for each time; lines that start with # are
comments. Column time (s), increasing, and any of surge, sway, heave (m), roll, pitch, yaw (rad), or roll_deg,
pitch_deg, yaw_deg (degrees); columns that are not there are zero.
"""

from __future__ import annotations

import csv
import math
from difflib import get_close_matches
from os import PathLike
from pathlib import Path

import numpy as np

from ..common.body_motion import UNITS, BodyMotion
from ..common.motion import SampledMotion
from ..common.outcome import InputError
from ..common.types import Vector
from ..common.validation import positive_number, real_number, vector
from .keys import NETWORK

COORDINATES = ("surge", "sway", "heave", "roll", "pitch", "yaw")
COLUMNS = ("time", *COORDINATES, "roll_deg", "pitch_deg", "yaw_deg")

_DESCRIPTIONS = ("amplitude", "sine", "file")  # a motion is described by one of these keys


def load_body_motion(path: str | PathLike[str], reference: Vector = (0.0, 0.0, 0.0)) -> BodyMotion:
    """Return the motion of a series in a CSV file about a reference point (3,) in m.

    Raises InputError naming file, line and column of what is missing, unknown or wrong.

    >>> from importlib.resources import files
    >>> from solvers.io import load_body_motion
    >>> drift = load_body_motion(files("reference_data") / "scenes" / "networks" / "drift.csv")
    >>> drift.displacement([[0.0, 0.0, -70.0]], 60.0).round(6).tolist()  # m: x, y, z of one point
    [[4.0], [0.0], [0.0]]
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
        raise InputError(f"has no line of column names: {', '.join(COLUMNS)}", field="path", label=str(path))
    columns = _columns(f"{path}:{lines[0][0]}", [name.strip() for name in _cells(lines[0][1])])
    rows = [_numbers(f"{path}:{number}", columns, _cells(line)) for number, line in lines[1:]]
    try:
        return _from_series(columns, rows, reference)
    except InputError as error:
        raise error.located(str(path)) from None


def _cells(line: str) -> list[str]:
    return next(csv.reader([line]))


def _columns(where: str, names: list[str]) -> list[str]:
    """Return the names of the columns; raises InputError for one unknown, twice there, or a missing time."""
    for i, name in enumerate(names):
        if name not in COLUMNS:
            near = get_close_matches(name.lower(), COLUMNS, n=1)
            hint = f"did you mean {near[0]!r}?" if near else f"known columns are {', '.join(COLUMNS)}"
            raise InputError(f"{where}: unknown column {name!r}; {hint}", field=name, label="")
        if name.removesuffix("_deg") in [other.removesuffix("_deg") for other in names[:i]]:
            raise InputError(f"{where}: column {name!r} is there already", field=name, label="")
    if "time" not in names or len(names) < 2:
        problem = f"columns {', '.join(names)} must be time and one or more of {', '.join(COLUMNS[1:])}"
        raise InputError(f"{where}: {problem}", field="time", label="")
    return names


def _numbers(where: str, columns: list[str], cells: list[str]) -> list[float]:
    if len(cells) != len(columns):
        raise InputError(f"{where}: {len(cells)} values where there are {len(columns)} columns", label="")
    numbers = []
    for name, cell in zip(columns, cells, strict=True):
        try:
            number = float(cell)
        except ValueError:
            number = math.nan
        if not math.isfinite(number):
            problem = f"{where}: column {name!r}: {cell.strip()!r} must be a finite number"
            raise InputError(problem, field=name, value=cell, label="")
        numbers.append(number)
    return numbers


def _from_series(columns: list[str], rows: list[list[float]], reference) -> BodyMotion:
    if len(rows) < 2:
        raise InputError(f"{len(rows)} rows of numbers; a series has two or more", field="time")
    values = dict(zip(columns, np.transpose(rows), strict=True))
    six = np.zeros((6, len(rows)))
    for name, series in values.items():
        if name != "time":
            i = COORDINATES.index(name.removesuffix("_deg"))
            six[i] = np.radians(series) if name.endswith("_deg") else series
    turns = six[3:].any()
    rotation = SampledMotion(values["time"], six[3:].T) if turns else None
    translation = SampledMotion(values["time"], six[:3].T) if six[:3].any() or not turns else None
    return BodyMotion(translation, rotation, reference)


def motion_from_table(table: dict, folder: Path) -> BodyMotion:
    """Return the motion of a [motion] table, of which a ``file`` is relative to the folder.

    Raises InputError naming the key, its value and its unit.
    """
    given = [key for key in _DESCRIPTIONS if key in table]
    if "cosine" in table and "sine" not in table:
        given.append("cosine")
    if len(given) != 1:
        problem = "[motion] takes one of amplitude (m, rad), sine with cosine (m, rad), and file"
        raise InputError(f"{problem}; given: {' and '.join(given) or 'none'}", label="")
    reference = vector("motion.reference", table.get("reference", [0.0, 0.0, 0.0]), "m", "coordinates")
    strangers = {"amplitude": set(), "file": NETWORK["motion"].keys() - {"file", "reference"}}.get(given[0], {"phase"})
    for key in sorted(strangers & set(table)):
        raise InputError(f"has no meaning beside {given[0]}; leave it out", field=f"motion.{key}", value=table[key])
    if given[0] == "file":
        if not isinstance(table["file"], str):
            raise InputError(f"{table['file']!r} must be a text", field="motion.file", value=table["file"])
        return load_body_motion(folder / table["file"], reference)
    try:
        return _periodic(table, _frequency(table), reference)
    except InputError as error:
        raise error.labelled(f"motion.{error.field}") from None


def _periodic(table: dict, frequency: float, reference) -> BodyMotion:
    if "amplitude" in table:
        return BodyMotion.harmonic(frequency, table["amplitude"], table.get("phase", [0.0] * 6), reference)
    rows = {key: _rows(key, table[key]) for key in ("sine", "cosine") if key in table}
    shape = next(iter(rows.values())).shape
    return BodyMotion.periodic(frequency, rows.get("sine", np.zeros(shape)), rows.get("cosine"), reference)


def _frequency(table: dict) -> float:
    given = [key for key in ("frequency", "period") if key in table]
    if len(given) != 1:
        problem = f"takes either frequency (Hz) or period (s); given: {' and '.join(given) or 'none'}"
        raise InputError(problem, field="frequency", unit="Hz")
    if given[0] == "frequency":
        return positive_number("frequency", table["frequency"], "Hz")
    return 1 / positive_number("period", table["period"], "s")


def _rows(name: str, value) -> np.ndarray:
    """Return a list of rows of six, one for each harmonic, as an array (K, 6)."""
    if not isinstance(value, list) or not value or not all(isinstance(row, list) and len(row) == 6 for row in value):
        problem = f"{value!r} must be rows of six, [[surge, sway, heave, roll, pitch, yaw], ...] (m, rad)"
        raise InputError(problem, field=name, value=value, unit="m, rad")
    return np.array([[real_number(f"{name}[{k}]", v, u) for v, u in zip(row, UNITS, strict=True)]
                     for k, row in enumerate(value)])  # fmt: skip
