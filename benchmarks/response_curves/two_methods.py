"""Multipliers by Hill's problem and by the monodromy, with how each fails; and what a curve with stability costs."""

from __future__ import annotations

import math
import time

import numpy as np

from solvers import solve_periodic
from solvers.stability import response_curve
from solvers.stability.multipliers.floquet import floquet

from . import systems

ROAD_HARMONICS, ROAD_STEPS = (3, 5, 9, 15, 25), (25, 50, 100, 200, 400, 800)
SMOOTH = 0.002, 0.2  # m and Hz: the OC3 line in so small a surge that no cell comes near slack
CELLS, QUICK_CELLS = (25, 50, 100, 200, 400), (25, 50)
COST_POINTS, WHOLE_POINTS = 12, 200
COST = {"start": 0.03, "stop": 0.08, "harmonics": 9}
TURNS = 1


def compare_methods(quick: bool) -> list[dict]:
    """Return the difference of the two methods by harmonics, with most steps, and by steps, with most harmonics."""
    rows = []
    amplitude, frequency = SMOOTH
    for harmonics in ROAD_HARMONICS:
        response = solve_periodic(systems.oc3(amplitude, frequency, 10), harmonics=harmonics)
        for steps in ROAD_STEPS if harmonics == ROAD_HARMONICS[-1] else ROAD_STEPS[-1:]:
            result = floquet(response, steps=steps, out_of_plane=False)
            rows.append({"harmonics": harmonics, "steps": steps, "difference": result.difference,
                         "counted": 0 if result.hill is None else result.hill.size})  # fmt: skip
    return rows


def cost(quick: bool) -> dict:
    """Return CPU seconds of a point of the OC3 line in surge, nine harmonics, with stability, by cells."""
    rows = []
    for cells in QUICK_CELLS if quick else CELLS:
        seconds = min(_seconds(cells, COST_POINTS) for _ in range(TURNS)) / COST_POINTS
        rows.append({"cells": cells, "seconds": seconds})
    logs = np.log([[row["cells"], row["seconds"]] for row in rows])
    return {"rows": rows, "exponent": float(np.polyfit(*logs.T, 1)[0]), "points": COST_POINTS, "whole": None}


def whole_curve(quick: bool) -> dict:
    """Return CPU seconds of 200 points on 50 cells with stability."""
    return {"cells": 50, "points": WHOLE_POINTS, "seconds": _seconds(50, WHOLE_POINTS)}


def _seconds(cells, points) -> float:
    """Return CPU seconds of a curve of so many points; NaN where it ends before."""
    step = 0.9 / WHOLE_POINTS
    system = systems.oc3(2.0, COST["start"], cells)
    begin = time.process_time()
    curve = response_curve(system, **COST, step=step, max_step=step, min_step=step / 100, max_points=points,
                           stability=True, throw=False)  # fmt: skip
    return time.process_time() - begin if curve.values.size == points else math.nan
