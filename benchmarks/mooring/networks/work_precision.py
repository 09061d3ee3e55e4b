"""Error against run time of the nine lines with bridles: in time, by harmonic balance and by MoorDyn, on one core.

Errors are of the fairlead tensions over the last period, the largest rms over the range of a fairlead. Those of this
core are against its own fine run; those of MoorDyn against its own fine run, so that what the two models have apart
(``agreement``) is no error of it.
"""

from __future__ import annotations

import hashlib
import json
import math
import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from solvers import ConvergenceError, solve_periodic
from solvers.numerics.threads import one_blas_thread

from ... import peers
from ...run import costs, results
from ..work_precision import WANTED, pareto_front, ratios
from . import agreement, systems

TIME, BALANCE, MOORDYN = "in time", "harmonic balance", "MoorDyn"
OWN = (TIME, BALANCE)
TOLERANCE = 1e-2
"""Of a Newton step in time, of the largest change of a tension: errors of the settings below hardly change with it."""
STEPPED = ((10, 25, 2), (14, 25, 2), (20, 25, 2), (20, 50, 2), (24, 40, 2), (28, 50, 2), (34, 50, 2), (40, 50, 3),
           (40, 100, 3), (56, 100, 3), (80, 100, 4), (80, 200, 4), (112, 200, 5))  # fmt: skip
"""(cells of the longest line, steps in a period, periods), on uniform meshes."""
BALANCED = ((20, 5), (28, 6), (40, 15))
"""(cells of the longest line, harmonics), on the default mesh."""
TRIED = (*BALANCED, (28, 9))
"""Those and one more at which harmonic balance is asked for a response, untimed: it is not there at all of them."""
PEER = (((8, 1, 1), 200, 2), ((10, 1, 1), 400, 2), ((14, 1, 1), 400, 2), ((14, 1, 1), 400, 3), ((20, 1, 1), 400, 2),
        ((20, 1, 1), 400, 3), ((20, 2, 2), 400, 3), ((28, 2, 2), 400, 3), ((28, 2, 2), 800, 3), ((40, 2, 2), 800, 3),
        ((40, 4, 4), 800, 3), ((56, 4, 4), 800, 4))  # fmt: skip
"""(segments of a lower line and of both legs of its bridle, coupling steps in a period, periods)."""
QUICK = {TIME: STEPPED[3:8], BALANCE: BALANCED[:1], MOORDYN: (PEER[5], PEER[7])}
PEER_REFERENCE, QUICK_PEER_REFERENCE = ((80, 8, 8), 3200, 4), ((56, 4, 4), 1600, 4)
COARSE = 5e-2  # greatest error at which MoorDyn is compared beside those wanted
ROUNDS, LONG = 2, 0.3  # a call longer than that, in s, is timed once


@dataclass(frozen=True)
class Answer:
    """Fairlead tensions (P, S) in N over the last period, None where there are none; what they cost."""

    tensions: np.ndarray | None
    work: dict = field(default_factory=lambda: costs.NOT_TOLD)


def run_in_time(cells: int, steps: int, periods: int) -> Answer:
    """Return the fairlead tensions of a history on a uniform mesh."""
    run = systems.history(systems.system(systems.NINE_LINES, cells, "uniform"), steps, periods, tolerance=TOLERANCE)
    return Answer(systems.our_tensions(run, steps), costs.count_work(run))


def run_balance(cells: int, harmonics: int) -> Answer:
    """Return the fairlead tensions of harmonic balance, None where it has no response."""
    response = solve_periodic(systems.system(systems.NINE_LINES, cells), harmonics=harmonics, throw=False)
    tensions = systems.periodic_tensions(response) if response.success else None
    return Answer(tensions, costs.count_work(response))


def run_moordyn(segments, steps: int, periods: int) -> Answer:
    """Return the fairlead tensions of MoorDyn."""
    network, counts = systems.network(systems.NINE_LINES), [*segments] * 3
    adapter = peers.adapters()[agreement.PEER]
    inner = adapter.count_network_steps(network, network.motion.period / steps, counts)
    tensions = agreement.moordyn_tensions(network, counts, steps, periods)
    return Answer(tensions, costs.count_explicit(periods * steps, inner, adapter.stages, sum(counts)))


CALLS = {TIME: run_in_time, BALANCE: run_balance, MOORDYN: run_moordyn}


def settings(quick: bool) -> dict:
    """Return (method, setting) -> function of no argument that gives tensions."""
    chosen = QUICK if quick else {TIME: STEPPED, BALANCE: BALANCED, MOORDYN: PEER}
    if agreement.PEER not in peers.adapters():
        chosen = {method: chosen[method] for method in OWN}
    return {(method, one): lambda method=method, one=one: CALLS[method](*one)
            for method, several in chosen.items() for one in several}  # fmt: skip


def references(quick: bool, folder: Path) -> dict:
    """Return method -> fine tensions (P, COUNT): MoorDyn's of its own, kept in ``folder``/cache."""
    ours = agreement.reference(systems.NINE_LINES, quick).tensions
    fine = dict.fromkeys(OWN, ours)
    if agreement.PEER in peers.adapters():
        fine[MOORDYN] = _peer_reference(QUICK_PEER_REFERENCE if quick else PEER_REFERENCE, folder)
    return fine


def _peer_reference(setting, folder: Path) -> np.ndarray:
    made_with = [setting, peers.adapters()[agreement.PEER].version, systems.sources()]
    digest = hashlib.sha256(json.dumps(made_with).encode()).hexdigest()[:16]
    path = folder / "cache" / f"mooring-networks-{digest}.json"
    if not path.exists():
        results.write(path, run_moordyn(*setting).tensions)
    return np.array(json.loads(path.read_text(encoding="utf-8")))


def points(quick: bool, fine: dict):
    """Yield a dict for each setting: method, size, other, periods, least seconds, rms, error, status, cost.

    All settings take turns in a random order, ROUNDS times, after one call each that is not timed.
    """
    plan = settings(quick)
    seconds, answers = dict.fromkeys(plan, math.inf), {}
    rng = np.random.default_rng(2026)
    with one_blas_thread(), systems.one_core():
        for turn in range(ROUNDS + 1):
            for i in rng.permutation(len(plan)).tolist():
                key, run = list(plan.items())[i]
                if turn > 1 and seconds[key] > LONG:
                    continue
                began = time.perf_counter()
                try:
                    answers[key] = run()
                except (ConvergenceError, RuntimeError):
                    answers[key] = Answer(None)
                if turn or time.perf_counter() - began > LONG:  # the first call finds empty caches
                    seconds[key] = min(seconds[key], time.perf_counter() - began)
                yield None
    for (method, setting), answer in answers.items():
        tensions = answer.tensions
        errors = {"rms": None, "error": None} if tensions is None else systems.differences(tensions, fine[method])
        size, other, *periods = setting
        yield {"case": systems.NINE_LINES, "method": method, "size": size, "other": other,
               "periods": periods[0] if periods else None, "status": "FAILED" if tensions is None else "SUCCESS",
               "seconds": seconds[method, setting]} | errors | answer.work  # fmt: skip


def balance(quick: bool):
    """Return a row for each setting of TRIED: cells, harmonics, status and Newton steps of harmonic balance."""
    rows = []
    for cells, harmonics in BALANCED[:1] if quick else TRIED:
        made = systems.system(systems.NINE_LINES, cells)
        response = solve_periodic(made, harmonics=harmonics, throw=False)
        rows.append({"cells": cells, "harmonics": harmonics, "status": response.status.name,
                     "iterations": response.iterations})  # fmt: skip
    return rows


def work(quick: bool, folder: Path):
    """Points of every setting, the ratios at equal error on MoorDyn's front, and how far the two references are."""
    fine, measured = references(quick, folder), []
    for point in points(quick, fine):
        measured += [] if point is None else [point]
        yield None
    apart = systems.differences(fine[MOORDYN], fine[TIME])["rms"] if MOORDYN in fine else None
    network = systems.network(systems.NINE_LINES)
    yield {"title": network.name, "lines": len(network.elements), "points": measured, "wanted": WANTED,
           "uncertainty": agreement.reference(systems.NINE_LINES, quick).uncertainty, "references_apart": apart,
           "tolerance": TOLERANCE, "ratios": ratios(measured, MOORDYN, WANTED, OWN),
           "coarse_ratios": ratios(measured, MOORDYN, (WANTED[1], COARSE), OWN), "coarse": COARSE,
           "fronts": {method: len(pareto_front(p for p in measured if p["method"] == method))
                      for method in fine}}  # fmt: skip
