"""Four systems by MoorDyn and by this core, both refined: how far their fairlead tensions differ, and why.

MoorDyn's run is repeated with half the segments, that one with half the coupling steps and with twice the internal
damping, and this core runs on as many uniform cells as MoorDyn: what each changes is what it can explain.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from functools import cache

import numpy as np

from solvers import mooring_system
from solvers.network.solve import solve_network

from ... import peers
from ...run import refinement
from . import systems

PERIODS, OUR_PERIODS = 4, 6  # the last one is compared
REFERENCE, QUICK_REFERENCE = (160, 800), (80, 400)
"""(cells, steps in a period) of this core, beside half of both."""
SEGMENTS = {"oc3": 80, "oc4": 160, "bridles": 40, "polyester": 160}
QUICK_SEGMENTS = dict.fromkeys(SEGMENTS, 40)
"""Of MoorDyn's longest line: where doubling them once more takes longer than all else here."""
STEPS, QUICK_STEPS = 1600, 800
"""Coupling steps of MoorDyn in a period."""
AT_REST, QUICK_AT_REST, RELAXED = (20, 40), (10, 20), 100.0
"""Segments of the longest line for the tension at rest, and s that MoorDyn relaxes for: 600 s change it by 5e-5."""
DAMPING = 0.1
"""Of the critical damping of a segment, what MoorDyn is given; RK2 is unstable with half of it."""
PERIODIC = 1e-2
"""Change of the last period from the one before, rms over the range, to which a history is called periodic."""
PEER = "moordyn"


@dataclass(frozen=True)
class FineRun:
    """Tensions (P, COUNT) of this core on a fine mesh, N; rms uncertainty; change of the last period from the one
    before, the largest rms over the range."""

    tensions: np.ndarray
    uncertainty: float
    change: float


@cache
def reference(name: str, quick: bool) -> FineRun:
    """Return the finer of two runs of this core, of twice the cells and steps.

    A third of their difference is what an error of second order leaves in the finer one: over a seabed a guide and no
    bound.
    """
    cells, steps = QUICK_REFERENCE if quick else REFERENCE
    coarse = _fine_tensions(systems.system(name, cells // 2), steps // 2, OUR_PERIODS)
    run, kept = _fine_history(systems.system(name, cells), steps, OUR_PERIODS)
    fine = systems.our_tensions(run, kept)
    uncertainty = systems.differences(coarse, fine)["rms"] / 3
    return FineRun(fine, uncertainty, systems.last_change(systems.coupled_forces(run), kept))


def _fine_tensions(made, steps: int, periods: int) -> np.ndarray:
    """Return the tensions (P, S) of a history; S: COUNT, or fewer steps."""
    return systems.our_tensions(*_fine_history(made, steps, periods))


def _fine_history(made, steps: int, periods: int) -> tuple:
    """Return a history of which no more is kept than is compared, and how many steps of a period are."""
    every = max(1, steps // systems.COUNT)
    return systems.history(made, steps, periods, every=every), steps // every


def refine(name: str, quick: bool) -> dict:
    """Return "mesh" and "steps" -> the fields of a Refinement of the fine run, of the fairlead that it is largest of.

    Three meshes with the finest step and three steps on the finest mesh, each by four, by two and by one.
    """
    cells, steps = QUICK_REFERENCE if quick else REFERENCE
    fine = reference(name, quick).tensions
    levels = {"mesh": [(cells // k, steps) for k in (4, 2)], "steps": [(cells, steps // k) for k in (4, 2)]}
    kept = {}
    for i, (what, coarse) in enumerate(levels.items()):
        waves = [*(_fine_tensions(systems.system(name, n), k, OUR_PERIODS) for n, k in coarse), fine]
        count = min(wave.shape[1] for wave in waves)
        waves = [wave[:, :: wave.shape[1] // count] for wave in waves]
        sizes = [*(level[i] for level in coarse), (cells, steps)[i]]
        of_fairleads = (
            refinement.estimate_uncertainty(sizes, [wave[p] for wave in waves], float(np.ptp(fine[p])))
            for p in range(len(fine))
        )
        kept[what] = asdict(refinement.largest(of_fairleads))
    return kept


def moordyn_tensions(network, counts, steps: int, periods: int = PERIODS, damping_ratio: float = DAMPING) -> np.ndarray:
    """Return MoorDyn's tensions (P, S) at the fairleads over the last period, from rest, N; see ``moordyn_forces``."""
    return systems.last_tensions(moordyn_forces(network, counts, steps, periods, damping_ratio), steps)


def moordyn_forces(network, counts, steps: int, periods: int = PERIODS, damping_ratio: float = DAMPING) -> np.ndarray:
    """Return MoorDyn's forces (P, 3, K) at the fairleads in so many periods from rest, N.

    counts: segments of each element; steps: coupling steps in a period.
    """
    period = network.motion.period
    time = np.arange(periods * steps + 1) * (period / steps)
    moved = network.motion.ramped(period / 2)  # as solve_time_domain starts by default
    adapter = peers.adapters()[PEER]
    return adapter.moving_network(network, moved, time, counts, damping_ratio)


def rows(quick: bool):
    """Yield the row of each system; none where MoorDyn is not installed."""
    for name in systems.SYSTEMS if PEER in peers.adapters() else ():
        yield compare(name, quick)


def compare(name: str, quick: bool) -> dict:
    """Return how far MoorDyn is from this core in one system, and what its segments, steps and damping change."""
    network, counts = systems.network(name), systems.SEGMENTS[name]
    segments, steps = (QUICK_SEGMENTS if quick else SEGMENTS)[name], QUICK_STEPS if quick else STEPS
    reference_run = reference(name, quick)
    ours = reference_run.tensions
    forces = moordyn_forces(network, counts(segments), steps)
    fine = systems.last_tensions(forces, steps)
    rough = moordyn_tensions(network, counts(segments // 2), steps)
    fewer = moordyn_tensions(network, counts(segments // 2), steps // 2)
    damped = moordyn_tensions(network, counts(segments // 2), steps, damping_ratio=2 * DAMPING)
    apart, half = systems.differences(fine, ours), systems.differences(rough, ours)
    row = {"system": name, "title": network.name, "period": network.motion.period, "fairleads": len(ours),
           "lines": len(network.elements), "segments": segments, "steps": steps, "rms": apart["rms"],
           "error": apart["error"], "rms_of_half": half["rms"], "uncertainty": reference_run.uncertainty,
           "range": float(np.ptp(ours, axis=1).max()), "mean_difference": mean_difference(fine, ours),
           "refinements": refine(name, quick), "periodic": PERIODIC,
           "change": max(reference_run.change, systems.last_change(forces, steps))}  # fmt: skip
    pairs = {"segments": (rough, fine), "steps": (fewer, rough), "damping": (damped, rough)}
    row |= {f"by_{key}": systems.differences(one, other)["rms"] for key, (one, other) in pairs.items()}
    row["explained"] = explained(row)
    return row | {"same_cells": same_cells(network, counts(segments), steps, fine)} | pretension(network, counts, quick)


def explained(row) -> float:
    """Return the rms difference that refining MoorDyn further, and this core, would account for.

    A third of the change by its segments, as an error of second order leaves; all of that by its coupling steps; half
    of that by its damping, which falls with the segment and was doubled on segments twice as long; the uncertainty.
    """
    return row["by_segments"] / 3 + row["by_steps"] + row["by_damping"] / 2 + row["uncertainty"]


def mean_difference(theirs, ours) -> float:
    """Return the largest difference of the mean tensions of a fairlead over its range, with its sign."""
    apart = (theirs.mean(axis=1) - ours.mean(axis=1)) / np.ptp(ours, axis=1)
    return float(apart[abs(apart).argmax()])


def same_cells(network, counts, steps: int, theirs) -> float:
    """Return the rms difference of MoorDyn from this core on its own uniform cells, two of a line at least."""
    made = mooring_system(network, [max(2, n) for n in counts], mesh="uniform")
    return systems.differences(_fine_tensions(made, steps, PERIODS), theirs)["rms"]


def pretension(network, counts, quick: bool) -> dict:
    """Return the tension at rest of the first fairlead, N, and MoorDyn's relative difference at two segmentations.

    It relaxes from this project's equilibrium, which is exact.
    """
    first = next(i for i, node in enumerate(network.nodes) if node.kind == "coupled")
    exact = float(np.linalg.norm(solve_network(network).reaction[first]))
    adapter = peers.adapters()[PEER]
    relaxed = {n: float(np.linalg.norm(adapter.forces_at_rest(network, counts(n), RELAXED)[first]))
               for n in (QUICK_AT_REST if quick else AT_REST)}  # fmt: skip
    return {"pretension": exact, "at_rest": [[n, tension / exact - 1] for n, tension in relaxed.items()]}
