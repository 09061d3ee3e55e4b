"""Validation of moving lines of nodes and elements: a laboratory chain that goes slack, and histories by OrcaFlex."""

from __future__ import annotations

import csv
import tomllib
from dataclasses import replace
from importlib.resources import files

import numpy as np

from solvers import Motion, Scene, mooring_system, solve_time_domain

from . import cases

DATA = files("reference_data")
PERIODS, RAMP, COUNTED = 12, 3, 5
"""Of both: periods in all, of the ramp, and at the end of which the maxima are counted."""
CHAIN_CELLS, CHAIN_STEPS = (
    100,
    800,
)  # a period; of the laboratory chain: with half of each, maxima differ by up to 0.7 %
CELLS, STEPS = 50, 400  # a period; of the chains that OrcaFlex solved
BAND = 0.06  # of the measured maximum: what a first model of this kind kept within, before anything here was run
REFINED = 0.2  # m: radius at which the setting is refined as well


def read(name: str, file: str = "data.csv") -> tuple[list[dict], dict]:
    """Return rows of a file of a reference set, numbers as float, and its source.toml."""
    with (DATA / name / file).open(encoding="utf-8", newline="") as lines:
        rows = [{key: value if key == "name" else float(value) for key, value in row.items()}
                for row in csv.DictReader(lines)]  # fmt: skip
    return rows, tomllib.loads((DATA / name / "source.toml").read_text(encoding="utf-8"))


def scene(name: str) -> Scene:
    """Return a scene of reference_data/scenes/mooring."""
    return Scene.load(cases.SCENES / "mooring" / f"{name}.toml")


def mean_maximum(tension, steps: int, counted: int) -> float:
    """Return the mean of the maxima of the last cycles of a tension at equal steps, (K,), whose last value ends one."""
    return float(np.asarray(tension)[-counted * steps :].reshape(counted, steps).max(axis=1).mean())


def circle(radius: float, period: float, turn: int = 1) -> Motion:
    """Return a circle from its highest point: away from the anchor there with turn 1, towards it with -1."""
    return Motion(1 / period, [[turn * radius, 0.0, 0.0]], [[0.0, 0.0, radius]])


def laboratory(quick: bool):
    """Yield the measured and computed mean of the maxima of each cycle, N: at one setting, nothing fitted.

    maximum: measured; computed; other_way: with the circle turned the other way; finer: on twice the cells, half the
    step, of the greatest radius; without_friction: on a smooth seabed; all three in the whole run. deviation: computed
    over measured, less one.
    """
    case, rows = scene("laboratory_chain"), []
    for given in read("laboratory_chain")[0]:
        row = given | {"computed": _laboratory_maximum(case, given)}
        if not quick:
            row["other_way"] = _laboratory_maximum(case, given, turn=-1)
            row["without_friction"] = _laboratory_maximum(replace(case, friction=(0.0,)), given)
            if given["radius"] == REFINED:
                row["finer"] = _laboratory_maximum(case, given, finer=2)
        rows.append(row | {"deviation": row["computed"] / row["maximum"] - 1})
        yield None
    deviations = np.array([row["deviation"] for row in rows])
    yield {"rows": rows, "mean": deviations.mean(), "mean_absolute": abs(deviations).mean(),
           "greatest": abs(deviations).max(), "band": BAND, "cells": CHAIN_CELLS, "steps": CHAIN_STEPS,
           "counted": COUNTED, "length": case.length, "friction": case.friction[0], "damping": case.cable.damping,
           "seabed_stiffness": case.environment.seabed_stiffness}  # fmt: skip


def _laboratory_maximum(case, given, turn=1, finer=1) -> float:
    """Return the mean maximum in N of one condition."""
    period, steps = given["period"], finer * CHAIN_STEPS
    system = mooring_system(case, finer * CHAIN_CELLS, motion=circle(given["radius"], period, turn))
    history = solve_time_domain(system, dt=period / steps, periods=PERIODS, ramp=RAMP * period)
    return mean_maximum(np.linalg.norm(history.fairlead_force, axis=0), steps, COUNTED)


# ---------------------------------------------------------------- OrcaFlex
FRICTIONS = {"without friction": 0.0, "friction 0.5": 0.5}  # what fits the statics; what the input file says


def sine_of(rows) -> tuple[float, float]:
    """Return amplitude in m and lag in s of z in rows with time, for a sine of period ORCAFLEX_PERIOD from time 0."""
    t, z = (np.array([row[key] for row in rows]) for key in ("time", "z"))
    angle = 2 * np.pi * t / ORCAFLEX_PERIOD
    sine, cosine = np.linalg.lstsq(np.column_stack([np.sin(angle), np.cos(angle)]), z, rcond=None)[0]
    return float(np.hypot(sine, cosine)), float(-np.arctan2(cosine, sine) * ORCAFLEX_PERIOD / (2 * np.pi))


ORCAFLEX_PERIOD = 10.0  # s


def orcaflex(quick: bool):
    """Yield tensions of the chains that OrcaFlex solved, at rest and over its last two periods, in kN.

    The motion is the sine of the heights of the fairlead in the histories, and starts smoothly. rms: of the difference
    over the range of OrcaFlex's; bias: its mean over the same; fairlead and anchor as sizes of the force.
    """
    histories, about = read("orcaflex_chain")
    rows = []
    for name, of in about["sets"].items():
        given = [row for row in histories if row["name"] == name]
        static = {end: value / 1e3 for end, value in about["static"][of["scene"]].items()}
        row = {"name": name, "scene": of["scene"], "static": static, "computed": {}, "period": ORCAFLEX_PERIOD}
        row["amplitude"], lag = sine_of(given)
        row |= {key: [one[key] for one in given] for key in ("time", "fairlead", "anchor")}
        for label, friction in list(FRICTIONS.items())[: 1 if quick else None]:
            row["computed"][label] = _compare(scene(of["scene"]), friction, row, lag)
        rows.append(row)
        yield None
    yield rows


def _compare(case, friction, row, lag) -> dict:
    """Return tensions in kN at the times of a row, at rest, and their differences from the row's."""
    motion = Motion.harmonic(1 / ORCAFLEX_PERIOD, (0.0, 0.0, row["amplitude"]))
    system = mooring_system(replace(case, friction=(friction,), motion=motion), CELLS)
    dt = ORCAFLEX_PERIOD / STEPS
    history = solve_time_domain(system, dt=dt, periods=PERIODS, ramp=RAMP * ORCAFLEX_PERIOD)
    t = history.time[-1] - ORCAFLEX_PERIOD + np.mod(np.array(row["time"]) - lag, ORCAFLEX_PERIOD)
    result = {"static": {}}
    for end, node in (("fairlead", -1), ("anchor", 0)):
        tension = np.interp(t, history.time, np.linalg.norm(history.forces[:, node], axis=0)) / 1e3
        difference, spread = tension - row[end], np.ptp(row[end])
        result["static"][end] = float(np.linalg.norm(system.rest.forces[:, node])) / 1e3
        result[end] = {"tension": tension, "rms": np.sqrt(np.mean(difference**2)) / spread,
                       "bias": difference.mean() / spread, "maximum": tension.max() / np.max(row[end]) - 1}  # fmt: skip
    return result
