"""Lines over a seabed in everyday motions: error of the default mesh, its warnings, and harmonic balance beside it."""

from __future__ import annotations

import numpy as np

from solvers import Status, mooring_system, solve_periodic, solve_time_domain
from verification.registry import instants

from ..cable.cases import rms
from . import cases
from .validation import scene

LINES = {
    "oc3": ((5.0, 20.0), (2.0, 10.0)),
    "oc4": ((5.0, 20.0), (2.0, 8.0)),
    "semi_15MW": ((5.0, 20.0), (2.0, 10.0)),
    "soft_clay": ((4.0, 15.0), (1.0, 8.0)),
    "rock": ((4.0, 15.0), (1.5, 8.0)),
    "wire": ((5.0, 15.0), (1.0, 6.0)),
    "wave_energy": ((2.0, 10.0), (0.5, 5.0)),
    "nylon": ((2.0, 10.0), (0.5, 5.0)),
    "buoy": ((2.0, 8.0), (0.5, 5.0)),
    "shallow": ((0.5, 10.0), (0.5, 5.0)),
}
"""Line -> amplitudes or radii in m and periods in s, each taken as surge, heave and circle."""
QUICK_LINES = ("oc3", "soft_clay", "wave_energy")
KINDS = ("surge", "heave", "circle")
CELLS, STEPS, FINER, HALVED, SHORTEST = 50, 200, 4, 2, 4
PERIODS, HARMONICS = 6, 12
PERIODIC = 1e-2  # change of the last period from the one before, over the range, below which a history is periodic
LARGE = 0.03  # rms error over the range that a user should be warned of
ADVICE = frozenset({"mesh", "dt", "periods"})  # subjects of warnings that say what to change; slack is a fact


def seabed(quick: bool):
    """Yield a row for every line and motion; see ``measure_motion``."""
    rows = []
    for name in QUICK_LINES if quick else LINES:
        for amplitude, period in LINES[name][: 1 if quick else None]:
            for kind in KINDS:
                rows.append(measure_motion(name, kind, amplitude, period))
                yield None
    yield {"rows": rows, "large": LARGE, "cells": CELLS, "steps": STEPS, "finer": FINER, "halved": HALVED,
           "harmonics": HARMONICS, "periodic": PERIODIC, "advice": sorted(ADVICE)}  # fmt: skip


def measure_motion(name, kind, amplitude, period) -> dict:
    """Return what one motion of a line gives on the default mesh, beside a run that is far finer.

    change: of the last period from the one before, rms over the range; error: of the last period against a run on
    FINER times the cells with steps HALVED, or SHORTEST where that fails; warnings: with their subjects; balance:
    status of harmonic balance on the same mesh, and its difference from the history; it is not tried where a cell
    goes slack.
    """
    case, motion = scene(name), cases.motion(kind, amplitude, period)
    system = mooring_system(case, CELLS, motion=motion)
    row = {"line": name, "title": case.name, "kind": kind, "amplitude": amplitude, "period": period,
           "seabed_stiffness": case.environment.seabed_stiffness}  # fmt: skip
    history = solve_time_domain(system, dt=period / STEPS, periods=PERIODS, throw=False)
    row["status"] = history.status.name
    if not history.success:
        return row
    before, last = (_wave(history, k) for k in (PERIODS - 2, PERIODS - 1))
    spread = float(np.ptp(last))
    warnings = tuple(getattr(history, "warnings", ()))
    row |= {"pretension": system.rest.fairlead_tension, "least": last.min(), "greatest": last.max(),
            "change": rms(last - before) / spread, "slack": history.damped_from is not None,
            "warnings": list(warnings), "subjects": sorted({text.partition(":")[0] for text in warnings})}  # fmt: skip
    finer = mooring_system(case, FINER * CELLS, motion=motion)
    for factor in (HALVED, SHORTEST):
        fine = solve_time_domain(finer, dt=period / (STEPS * factor), periods=PERIODS, throw=False)
        if fine.success:
            break
    row |= {"fine_status": fine.status.name, "fine_steps": factor * STEPS, "error": None}
    if fine.success:
        reference = _wave(fine, PERIODS - 1)
        row["error"] = rms(last - reference) / float(np.ptp(reference))
    if row["slack"]:  # harmonic balance is for lines that stay taut
        return row | {"balance": {"status": "SLACK", "difference": None}}
    return row | {"balance": _balance(system, last)}


def _wave(history, k) -> np.ndarray:
    """Return the fairlead tension over period k, N."""
    period = history.system.period
    return history.fairlead_tension(k * period + instants(period))


def _balance(system, tension) -> dict:
    """Return status of harmonic balance, and the rms of its difference from a tension over the range of that."""
    response = solve_periodic(system, harmonics=HARMONICS, throw=False)
    if response.status is not Status.SUCCESS:
        return {"status": response.status.name, "difference": None}
    wave = response.fairlead_tension(instants(system.period))
    return {"status": "SUCCESS", "difference": rms(wave - tension) / float(np.ptp(tension))}


def summarise(rows, large: float = LARGE, periodic: float = PERIODIC) -> dict:
    """Return counts of motions: solved on both meshes, periodic, with a large error, warned of, and both together.

    warned: by a history whose warnings have one of the subjects ADVICE.
    """
    solved = [row for row in rows if row["status"] == "SUCCESS" and row["error"] is not None]
    wrong = [row for row in solved if row["error"] > large]
    warned = [row for row in solved if ADVICE & set(row["subjects"])]
    errors = [row["error"] for row in solved]
    balanced = [row["balance"]["difference"] for row in solved if row["balance"]["status"] == "SUCCESS"]
    return {
        "motions": len(rows), "solved": len(solved), "periodic": sum(row["change"] <= periodic for row in solved),
        "large": len(wrong), "large_and_warned": sum(row in warned for row in wrong),
        "warned": len(warned), "warned_and_small": sum(row not in wrong for row in warned),
        "median": float(np.median(errors)) if errors else None, "greatest": max(errors, default=None),
        "balanced": len(balanced), "balance_median": float(np.median(balanced)) if balanced else None,
    }  # fmt: skip
