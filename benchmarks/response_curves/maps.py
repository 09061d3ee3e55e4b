"""Basins, the number of stable responses, and parametric stability, over frequency and amplitude."""

from __future__ import annotations

import numpy as np

from solvers import solve_periodic
from solvers.stability import find_basins, response_curve, responses_at
from solvers.stability.multipliers.floquet import floquet

from . import systems

FIRST = systems.FIRST_SIDEWAYS
HARMONICS = 5
SECONDS_MODE = (1.9, 2.45)  # of the first sideways frequency: about the second mode in the plane
BASIN = 0.03, 2.1  # m and share of the first sideways frequency, between the folds of the taut cable
MAP_STEPS, BASIN_STEPS = 0.15, 200
ALONG_BAND = (1.7, 2.3)
SPREAD = 0.5
MOST_PERIODS = 2000  # a disturbance of the taut cable in air decays by a thousandth to a hundredth in a period


def count_responses(quick: bool) -> dict:
    """Return how many responses the taut cable has in its plane, and how many of them are stable, on a grid."""
    low, high = (FIRST * share for share in SECONDS_MODE)
    frequencies = np.linspace(low, high, 10 if quick else 23)[1:-1]
    amplitudes = np.linspace(0.005, 0.05, 4 if quick else 7)
    stable, total = (np.zeros((amplitudes.size, frequencies.size), dtype=int) for _ in range(2))
    for i, amplitude in enumerate(amplitudes):
        curve = response_curve(systems.taut_plane(amplitude, low), start=low, stop=high, harmonics=HARMONICS, step=0.02,
                               max_step=MAP_STEPS, max_points=200, throw=False)  # fmt: skip
        for j, frequency in enumerate(frequencies):
            if curve.values.min() <= frequency <= curve.values.max():
                responses = responses_at(curve, frequency)
                total[i, j] = len(responses)
                stable[i, j] = sum(_is_stable_in_plane(each) for each in responses)
    return {"frequency": frequencies, "amplitude": amplitudes, "stable": stable, "total": total}


def _is_stable_in_plane(response) -> bool:
    result = floquet(response, method="monodromy", out_of_plane=False, steps=100)
    return bool(abs(result.multipliers).max() < 1)


def basins(quick: bool) -> dict:
    """Return the shares of starts that come to each response of the taut cable in its plane between its folds."""
    amplitude, share = BASIN
    low, high = (FIRST * each for each in SECONDS_MODE)
    curve = response_curve(systems.taut_plane(amplitude, low), start=low, stop=high, harmonics=HARMONICS, step=0.02,
                           max_step=MAP_STEPS, throw=False)  # fmt: skip
    responses = responses_at(curve, share * FIRST)
    basins = find_basins(
        responses, count=20 if quick else 60, spread=SPREAD, seed=3, steps=BASIN_STEPS, periods=MOST_PERIODS
    )
    rows = [{"size": float(abs(each.z[..., 1:]).max()), "stable": _is_stable_in_plane(each), "share": part,
             "low": low, "high": high} for each, part, (low, high) in zip(responses, basins.shares, basins.intervals,
                                                                          strict=True)]  # fmt: skip
    return {"frequency": share * FIRST, "amplitude": amplitude, "count": basins.landed.size, "rows": rows,
            "unsettled": basins.unsettled}  # fmt: skip


def parametric(quick: bool) -> dict:
    """Return growth rates in 1/s, sideways and in the plane, of the taut cable whose end moves along it."""
    frequencies = FIRST * np.linspace(*ALONG_BAND, 7 if quick else 19)
    amplitudes = np.linspace(0.002, 0.02, 3 if quick else 7)
    sideways, upward = (np.full((amplitudes.size, frequencies.size), np.nan) for _ in range(2))
    for i, amplitude in enumerate(amplitudes):
        for j, frequency in enumerate(frequencies):
            response = solve_periodic(systems.taut_along(amplitude, frequency), harmonics=HARMONICS, throw=False)
            if not response.success:
                continue
            result = floquet(response, method="monodromy", steps=100)
            sideways[i, j], upward[i, j] = (np.log(abs(each).max()) / result.period
                                            for each in (result.sideways, result.multipliers))  # fmt: skip
    return {"frequency": frequencies, "amplitude": amplitudes, "sideways": sideways, "upward": upward,
            "natural": FIRST}  # fmt: skip
