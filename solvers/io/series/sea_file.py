"""Spectra and response amplitude operators from CSV, and a sea state from a table of settings.

A spectrum has the columns frequency (Hz) and density (m^2/Hz). Operators have the column frequency (Hz) or period (s),
heading (degrees, into which the waves run; may be missing), and for each of surge, sway, heave (m/m), roll, pitch, yaw
(rad/m, or roll_deg ...: degrees/m) an amplitude and its phase, surge_phase (rad) or surge_phase_deg (degrees), by which
the motion leads the wave at the reference point; columns that are not there are zero. A phase in rad is within a turn:
beyond it the numbers are degrees.
"""

from __future__ import annotations

import math
from os import PathLike
from pathlib import Path

import numpy as np

from ...common.motions.sea_state import ResponseOperators, SeaState
from ...common.motions.spectrum import Spectrum
from ...common.outcome import InputError
from .csv_columns import read_numbers

COORDINATES = ("surge", "sway", "heave", "roll", "pitch", "yaw")
SPECTRA = ("jonswap", "pierson_moskowitz")
LEAST_SUSPECT, STEEPEST = 0.1, 8.0
"""Rotations per metre of wave up to these are likely: rad/m, and times the slope of the wave (rolling barges: 3)."""
_GRAVITY = 9.80665  # m/s^2
ONE_TURN = 2 * math.pi * (1 + 1e-6)  # rad, with what rounding in a file may add
_OPERATOR_COLUMNS = (
    *("frequency", "period", "heading", *COORDINATES),
    *(f"{name}_deg" for name in COORDINATES[3:]),
    *(f"{name}_phase" for name in COORDINATES),
    *(f"{name}_phase_deg" for name in COORDINATES),
)


def load_spectrum(path: str | PathLike[str]) -> Spectrum:
    """Return the spectrum of a CSV file with the columns frequency (Hz) and density (m^2/Hz).

    Raises InputError naming file, line and column of what is missing, unknown or wrong.
    """
    columns = read_numbers(path, ("frequency", "density"))
    for name in ("frequency", "density"):
        if name not in columns:
            raise InputError(f"has no column {name!r}", field=name, label=str(path))
    try:
        return Spectrum(np.array(columns["frequency"]), np.array(columns["density"]))
    except InputError as error:
        raise error.located(str(path)) from None


def load_response_operators(path: str | PathLike[str]) -> ResponseOperators:
    """Return the response amplitude operators of a CSV file; every heading has the same frequencies.

    Raises InputError naming file, line and column of what is missing, unknown or wrong.
    """
    columns = {name: np.array(values) for name, values in read_numbers(path, _OPERATOR_COLUMNS).items()}
    try:
        return _operators(columns)
    except InputError as error:
        raise error.located(str(path)) from None


def _operators(columns) -> ResponseOperators:
    given = [name for name in ("frequency", "period") if name in columns]
    if len(given) != 1 or not len(columns[given[0]]):
        problem = f"takes rows of either frequency (Hz) or period (s); given: {' and '.join(given) or 'none'}"
        raise InputError(problem, field="frequency", unit="Hz")
    values = columns[given[0]]
    if given[0] == "period":
        if not (values > 0).all():
            raise InputError(f"{values.min():g} s must be > 0", field="period", value=float(values.min()), unit="s")
        values = 1 / values
    heading = columns.get("heading", np.zeros(values.size))
    headings, frequencies = np.unique(heading), np.unique(values)
    table = np.full((headings.size, frequencies.size, 6), np.nan, dtype=complex)
    for k, name in enumerate(COORDINATES):
        at = np.searchsorted(headings, heading), np.searchsorted(frequencies, values)
        table[(*at, k)] = _one_operator(columns, name, values.size)
        if k >= 3:
            _require_likely_rotation(name, values, abs(table[(*at, k)]))
    if np.isnan(table).any() or values.size != headings.size * frequencies.size:
        problem = (
            f"{values.size} rows for {headings.size} headings of {frequencies.size} frequencies: each heading takes "
        )
        raise InputError(problem + "the same frequencies, each once", field="heading", unit="degrees")
    return ResponseOperators(frequencies, table, headings)


def _require_likely_rotation(name: str, frequency, amplitude):
    """Raise InputError where a rotation per metre of wave, rad/m, is more than any body has: likely degrees."""
    slope = (2 * math.pi * frequency) ** 2 / _GRAVITY  # of a wave of 1 m in deep water, rad
    too_large = amplitude > np.maximum(LEAST_SUSPECT, STEEPEST * slope)
    if too_large.any():
        i = int(too_large.argmax())
        problem = (
            f"{amplitude[i]:.3g} rad/m at {frequency[i]:.3g} Hz, {math.degrees(amplitude[i]):.3g} degrees a metre of "
            f"wave, is {amplitude[i] / slope[i]:.2g} times the slope of the wave, as no body turns: likely in degrees; "
            f"name the column {name}_deg"
        )
        raise InputError(problem, field=name, value=float(amplitude[i]), unit="rad/m")


def _one_operator(columns, name, size) -> np.ndarray:
    amplitude = columns.get(name, np.zeros(size))
    if f"{name}_deg" in columns:
        amplitude = np.radians(columns[f"{name}_deg"])
    phase = columns.get(f"{name}_phase", np.zeros(size))
    if (largest := float(abs(phase).max(initial=0.0))) > ONE_TURN:
        problem = f"{largest:g} rad is more than a turn: likely in degrees; name the column {name}_phase_deg"
        raise InputError(problem, field=f"{name}_phase", value=largest, unit="rad")
    if f"{name}_phase_deg" in columns:
        phase = np.radians(columns[f"{name}_phase_deg"])
    if (amplitude < 0).any():
        problem = f"{amplitude.min():g} must be >= 0: an amplitude; its sign belongs to {name}_phase"
        raise InputError(problem, field=name, value=float(amplitude.min()))
    return amplitude * np.exp(1j * phase)


def sea_from_settings(given: dict, folder: Path, duration, operators=None, reference=(0.0, 0.0, 0.0)) -> SeaState:
    """Return the sea of settings ``keys.SEA``, files relative to the folder.

    duration: s, where the settings have none; operators: those where the settings name no file. Raises InputError
    naming the key, its value and its unit.
    """
    if "operators" in given:
        operators = load_response_operators(_file(folder, "operators", given["operators"]))
    if operators is None:
        problem = "not given: a sea moves the body by response amplitude operators, a CSV file"
        raise InputError(problem, field="operators")
    if "seed" not in given:
        raise InputError("not given: a whole number, which chooses the waves", field="seed")
    settings = {key: given[key] for key in ("heading", "amplitudes") if key in given}
    duration = given.get("duration", duration)
    if duration is None:
        raise InputError("not given (s): the time after which the waves repeat", field="duration", unit="s")
    return SeaState(_spectrum(given, folder), operators, given["seed"], duration, reference=reference, **settings)


def _spectrum(given: dict, folder: Path) -> Spectrum:
    kind = given.get("spectrum", "jonswap")
    if kind not in SPECTRA:
        for key in ("Hs", "Tp", "gamma"):
            if key in given:
                problem = f"has no meaning beside the spectrum of a file; known spectra are {', '.join(SPECTRA)}"
                raise InputError(problem, field=key, value=given[key])
        return load_spectrum(_file(folder, "spectrum", kind))
    for key, unit in (("Hs", "m"), ("Tp", "s")):
        if key not in given:
            raise InputError(f"not given ({unit}), and spectrum = {kind!r} takes it", field=key, unit=unit)
    if kind == "jonswap":
        return Spectrum.jonswap(given["Hs"], given["Tp"], given.get("gamma"))
    if "gamma" in given:
        raise InputError("has no meaning for pierson_moskowitz", field="gamma", value=given["gamma"])
    return Spectrum.pierson_moskowitz(given["Hs"], given["Tp"])


def _file(folder: Path, key: str, name) -> Path:
    if not isinstance(name, str):
        raise InputError(f"{name!r} must be the name of a CSV file", field=key, value=name)
    return folder / name
