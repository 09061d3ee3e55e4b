"""Motion of a body in six degrees of freedom, from the [motion] table of a network file or from a series in CSV.

A series has one header line with the names of its columns, then a row for each time; lines that start with # are
comments. Column time (s), increasing, and any of surge, sway, heave (m), roll, pitch, yaw (rad), or roll_deg,
pitch_deg, yaw_deg (degrees); columns that are not there are zero.
"""

from __future__ import annotations

from os import PathLike
from pathlib import Path

import numpy as np

from ...common.motions.body_motion import UNITS, BodyMotion
from ...common.motions.motion import SampledMotion
from ...common.outcome import InputError
from ...common.types import Vector
from ...common.validation import positive_number, real_number, vector
from ..keys import NETWORK, SEA
from .csv_columns import read_numbers
from .sea_file import sea_from_settings

COORDINATES = ("surge", "sway", "heave", "roll", "pitch", "yaw")
COLUMNS = ("time", *COORDINATES, "roll_deg", "pitch_deg", "yaw_deg")

_DESCRIPTIONS = ("amplitude", "sine", "file", "spectrum")  # a motion is described by one of these keys


def load_body_motion(path: str | PathLike[str], reference: Vector = (0.0, 0.0, 0.0)) -> BodyMotion:
    """Return the motion of a series in a CSV file about a reference point (3,) in m.

    Raises InputError naming file, line and column of what is missing, unknown or wrong.

    >>> from importlib.resources import files
    >>> from solvers.io import load_body_motion
    >>> drift = load_body_motion(files("reference_data") / "scenes" / "networks" / "drift.csv")
    >>> drift.displacement([[0.0, 0.0, -70.0]], 60.0).round(6).tolist()  # m: x, y, z of one point
    [[4.0], [0.0], [0.0]]
    """
    columns = read_numbers(path, COLUMNS, required="time", others=1)
    try:
        return _from_series(columns, reference)
    except InputError as error:
        raise error.located(str(path)) from None


def _from_series(values: dict[str, list[float]], reference) -> BodyMotion:
    rows = len(values["time"])
    if rows < 2:
        raise InputError(f"{rows} rows of numbers; a series has two or more", field="time")
    six = np.zeros((6, rows))
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
        problem = "[motion] takes one of amplitude (m, rad), sine with cosine (m, rad), file, and spectrum"
        raise InputError(f"{problem}; given: {' and '.join(given) or 'none'}", label="")
    reference = vector("motion.reference", table.get("reference", [0.0, 0.0, 0.0]), "m", "coordinates")
    allowed = {"amplitude": {"frequency", "period", "phase"}, "file": set(), "spectrum": set(SEA)}
    strangers = (
        NETWORK["motion"].keys() - {"reference", given[0]} - allowed.get(given[0], {"frequency", "period", "cosine"})
    )
    for key in sorted(strangers & set(table)):
        raise InputError(f"has no meaning beside {given[0]}; leave it out", field=f"motion.{key}", value=table[key])
    if given[0] == "file":
        if not isinstance(table["file"], str):
            raise InputError(f"{table['file']!r} must be a text", field="motion.file", value=table["file"])
        return load_body_motion(folder / table["file"], reference)
    if given[0] == "spectrum":
        try:
            return sea_from_settings(table, folder, None, reference=reference).motion()
        except InputError as error:
            in_file = not str(error).startswith(f"{error.field}:")
            raise error if in_file else error.labelled(f"motion.{error.field}") from None
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
