"""Tensions by time integration at frequencies of a sweep: where its curve ends early, and where they are largest."""

from __future__ import annotations

import numpy as np

from solvers import solve_time_domain
from solvers.stability.curves.family import build_family

PERIODS, KEPT_PERIODS = 12, 2  # integrated from rest, and the last of them, in which tensions are taken
STEPS = 100  # in a period
GAP_FREQUENCIES = 10  # in the part of a band that no curve covers


def find_gap(curves, band) -> tuple[float, float] | None:
    """Return the ends in Hz of the part of a band that the curves, rows of the report, leave out, or None."""
    if any(curve["status"] == "SUCCESS" for curve in curves):
        return None
    reached = {curve["way"]: curve["frequency"] for curve in curves}
    low = max(reached["up"]) if "up" in reached else band[0]
    high = min(reached["down"]) if "down" in reached else band[1]
    return (float(low), float(high)) if low < high else None


def integrate_gap(system, gap) -> list[dict]:
    """Return tensions at frequencies in a gap in Hz and at its end, as ``integrate_tensions``; [] without a gap."""
    return [] if gap is None else integrate_tensions(system, np.linspace(*gap, GAP_FREQUENCIES + 1)[1:])


def integrate_tensions(system, frequencies) -> list[dict]:
    """Return {frequency, greatest, least}: Hz, N (E,) at the second end of each element over the last periods.

    Frequencies at which the integration fails are left out.
    """
    tune, rows = build_family(system, "frequency"), []
    for frequency in map(float, frequencies):
        history = solve_time_domain(tune(frequency), dt=1 / (STEPS * frequency), periods=PERIODS, throw=False)
        if history.success:
            forces = np.array([element.fairlead_force for element in history.elements])
            tension = np.linalg.norm(forces, axis=1)[:, -KEPT_PERIODS * STEPS :]
            rows.append({"frequency": frequency, "greatest": tension.max(axis=1), "least": tension.min(axis=1)})
    return rows
