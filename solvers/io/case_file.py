"""Tables of load cases in CSV, their results in CSV, and the records from which an interrupted table goes on.

A table of load cases has a header with the names of its columns, those of ``keys.CASES``: a duration, and one of
  a sea: Hs, Tp and seed, or spectrum and seed; gamma, heading, amplitudes, and operators where the system names none
  a regular motion: period and amplitudes surge, sway, heave, roll or roll_deg, ...
  a series: motion, a CSV file, see solvers/io/series/motion_file.py
with ramp, current and offset. Files are relative to that of the table; a cell may be empty. CSV has no schema for
editors: ``describe_columns`` says what there is, and a wrong name gets the nearest column.
"""

from __future__ import annotations

import csv
import io
import json
import math
import os
from os import PathLike
from pathlib import Path

from ..common.load_case import LoadCase
from ..common.motions.body_motion import BodyMotion
from ..common.motions.sea_state import SeaMotion
from ..common.outcome import InputError
from .keys import CASES, SEA
from .network_scene import load_network
from .scene import Scene, read_tables
from .series.csv_columns import read_rows
from .series.motion_file import COORDINATES, load_body_motion
from .series.sea_file import sea_from_settings

_TEXTS = tuple(name for name, key in CASES.items() if key.kind in ("text", "amplitudes"))
_SEA = tuple(key for key in SEA if key != "duration")
_REGULAR = ("period", *COORDINATES, *(f"{name}_deg" for name in COORDINATES[3:]))
_VECTORS = {name: tuple(f"{name}_{axis}" for axis in "xyz") for name in ("current", "offset")}


def describe_columns() -> str:
    """Return a line for each column of a table of load cases: its name, unit and meaning.

    >>> print(describe_columns().splitlines()[1])
    duration (s): Time over which statistics are taken, after the ramp. Always.
    """
    units = {name: f" ({key.unit})" if key.unit else "" for name, key in CASES.items()}
    return "\n".join(f"{name}{units[name]}: {key.help}{' Always.' if key.required else ''}"
                     for name, key in CASES.items())  # fmt: skip


def load_system(path: str | PathLike[str]):
    """Return the Scene or the network of a TOML file: a network is what has elements."""
    return (load_network if read_tables(path, lambda data, _: "elements" in data) else Scene.load)(path)


def read_load_cases(path: str | PathLike[str], system=None) -> list[LoadCase | InputError]:
    """Return a LoadCase for each row of a CSV file, or the InputError that says what is wrong with it.

    system: whose [motion] from a spectrum gives response amplitude operators and reference point to rows without them.
    Raises InputError where the file itself cannot be read or has a column that is unknown.
    """
    names, rows = read_rows(path, CASES)
    if not rows:
        raise InputError("has no rows of load cases", field="path", value=str(path), label=str(path))
    cases: list[LoadCase | InputError] = []
    for i, (number, cells) in enumerate(rows, start=1):
        where = f"{path}:{number}"
        try:
            if len(cells) != len(names):
                raise InputError(f"{len(cells)} values where there are {len(names)} columns", label="")
            cases.append(_case(dict(zip(names, cells, strict=True)), f"case {i}", Path(path).parent, system))
        except InputError as error:
            label = dict(zip(names, cells, strict=False)).get("name")
            cases.append(error.located(f"{where}: {label}" if label else where))
    return cases


def load_case_of(system) -> LoadCase:
    """Return the LoadCase of the sea in a system's own [motion], over the time after which its waves repeat.

    Raises InputError where the system has none.
    """
    motion = getattr(system, "motion", None)
    if not isinstance(motion, SeaMotion) or motion.sea is None:
        problem = "is no sea: give a table of load cases, or a [motion] with spectrum, seed, duration and operators"
        raise InputError(problem, field="motion", value=motion, label="[motion]")
    sea = motion.sea
    height = f"Hs {sea.spectrum.significant_height:.4g} m"
    return LoadCase(f"{height}, seed {sea.seed}", sea, sea.duration)


def _case(cells: dict[str, str], name: str, folder: Path, system) -> LoadCase:
    given = {key: _value(key, cell) for key, cell in cells.items() if cell}
    if "duration" not in given:
        raise InputError("not given (s)", field="duration", unit="s")
    settings: dict = {key: given[key] for key in ("ramp",) if key in given}
    for key, axes in _VECTORS.items():
        if any(axis in given for axis in axes):
            settings[key] = tuple(given.get(axis, 0.0) for axis in axes)
    case = LoadCase(given.get("name", name), BodyMotion.harmonic(1.0, [0.0] * 6), given["duration"], **settings)
    return LoadCase(case.name, _motion(given, folder, system, case.whole_duration), case.duration, **settings)


def _value(key: str, cell: str):
    if key in _TEXTS:
        return cell
    try:
        number = float(cell)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise InputError(f"{cell!r} must be a finite number", field=key, value=cell)
    return int(number) if key == "seed" and number.is_integer() else number


def _motion(given: dict, folder: Path, system, whole_duration):
    """Return the SeaState or motion of a row; raises InputError where it has none or several."""
    base = getattr(system, "motion", None)
    reference = getattr(base, "reference", (0.0, 0.0, 0.0))
    kinds = {"a sea": _SEA, "a regular motion": _REGULAR, "a series": ("motion",)}
    there = [kind for kind, keys in kinds.items() if any(key in given for key in keys)]
    if len(there) != 1:
        problem = "takes a sea (Hs, Tp, seed), a regular motion (period, surge, ...) or a series; given: "
        raise InputError(problem + (" and ".join(there) or "none"), field="motion")
    if there[0] == "a series":
        return load_body_motion(folder / given["motion"], reference)
    if there[0] == "a sea":
        operators = base.sea.operators if isinstance(base, SeaMotion) and base.sea is not None else None
        return sea_from_settings({key: given[key] for key in _SEA if key in given}, folder, whole_duration, operators,
                                 reference)  # fmt: skip
    if "period" not in given or not given["period"] > 0:
        raise InputError(f"{given.get('period')} s must be > 0", field="period", value=given.get("period"), unit="s")
    six = [given.get(name, math.radians(given.get(f"{name}_deg", 0.0))) for name in COORDINATES]
    return BodyMotion.harmonic(1 / given["period"], six, reference=reference)


# ---------------------------------------------------------------- records
def append_record(path: str | PathLike[str], record: dict) -> None:
    """Append a record to a file of JSON lines, in one write that is on the disk when this returns."""
    line = json.dumps(record, allow_nan=False) + "\n"
    handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o666)
    try:
        os.write(handle, line.encode())
        os.fsync(handle)
    finally:
        os.close(handle)


def read_records(path: str | PathLike[str]) -> list[dict]:
    """Return the whole records of a file of JSON lines; the end of a record that was being written is cut off."""
    path = Path(path)
    if not path.exists():
        return []
    text = path.read_bytes()
    whole = text[: text.rfind(b"\n") + 1]
    if len(whole) < len(text):
        with path.open("r+b") as file:
            file.truncate(len(whole))
    return [json.loads(line) for line in whole.splitlines()]


def write_rows(path: str | PathLike[str], header, rows) -> None:
    """Write a CSV file whole or not at all; None is an empty cell, and numbers have all their digits."""
    path, text = Path(path), io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    writer.writerows([["" if cell is None else cell for cell in row] for row in rows])
    temporary = path.with_name(f"{path.name}.{os.getpid()}.tmp")
    try:
        temporary.write_text(text.getvalue(), encoding="utf-8")
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)
