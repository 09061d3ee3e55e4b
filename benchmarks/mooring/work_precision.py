"""Error against run time of moving lines: nodes and elements, box scheme and other codes; ratios at equal error."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from solvers import solve_periodic, solve_time_domain
from solvers.common.motions.motion import Ramped
from solvers.common.outcome import ConvergenceError
from solvers.numerics.threads import one_blas_thread
from verification.registry import last_period_tension

from ..cable import work_precision as cable_work
from ..run import costs
from . import cases

TIME, EXTRAPOLATED = "in time", "in time, extrapolated"
BALANCE, CORRECTED = "harmonic balance", "harmonic balance, extrapolated"
BOX_TIME, BOX_CORRECTED = "box scheme, in time", "box scheme, harmonic balance, corrected"
OWN = (TIME, EXTRAPOLATED, BALANCE, CORRECTED)
"""Methods of nodes and elements."""

SETTINGS = {
    TIME: ((10, 25), (14, 25), (14, 50), (20, 50), (28, 50), (28, 100), (40, 100), (56, 100), (56, 200), (80, 200),
           (112, 200), (112, 400), (160, 400)),
    EXTRAPOLATED: ((20, 50), (28, 50), (28, 100), (40, 100), (56, 200), (80, 200)),
    BALANCE: ((10, 4), (14, 4), (20, 6), (28, 6), (28, 9), (40, 9), (40, 12), (80, 12)),
    CORRECTED: ((14, 4), (14, 6), (14, 9), (20, 9), (20, 12), (28, 12), (28, 15), (40, 15)),
    BOX_TIME: ((25, 50), (50, 100)),
    BOX_CORRECTED: ((9, 5), (13, 9), (17, 12), (25, 15), (41, 12)),
}  # fmt: skip
"""(cells, or nodes of the box scheme; steps in a period, or harmonics); extrapolated: of the finer of two runs."""
OVER_SEABED = {
    BALANCE: ((14, 4), (28, 6), (40, 9), (80, 12)),
    CORRECTED: ((28, 9), (80, 12)),
    BOX_CORRECTED: ((25, 15), (41, 12)),
}
"""Fewer of those that take long where they fail."""
QUICK = {
    TIME: ((14, 25), (20, 50), (28, 100), (56, 100), (80, 200)),
    EXTRAPOLATED: ((28, 100),),
    BALANCE: ((20, 6), (40, 9)),
    CORRECTED: ((20, 9), (28, 12)),
    BOX_TIME: ((50, 100),),
    BOX_CORRECTED: ((17, 12),),
}
QUICK_CASES = ("case_1", "case_1_large", "oc3_seabed")
PEER_SETTINGS = ((8, 100), (12, 200), (17, 500), (24, 500), (34, 1000), (49, 1000))
FINE_PEER = (98, 2000)
NEED_FINE_PEER = ("case_3", *cases.SEABED)  # cases in which other codes have larger errors
QUICK_PEER = ((12, 200), (24, 500), (34, 1000))
WANTED = (1e-3, 1e-2)  # errors between which other codes are compared with
LONG = 0.1  # s: of a call that is timed once: three of 0.1 to 0.3 s in turn differ by 3 % at most
ROUNDS = 2
SHORT = 0.05  # s: of a call that is made once before it is timed, for what ran before it has emptied the caches


@dataclass(frozen=True)
class Tension:
    """Fairlead tension (n,) in N over the last period, or None and a word on why; what it cost."""

    wave: np.ndarray | None
    status: str = "SUCCESS"
    work: dict = field(default_factory=lambda: costs.NOT_TOLD)


def call(name: str, method: str, size: int, other: int):
    """Return a function of no argument that solves a case from rest and gives its Tension."""
    if method == EXTRAPOLATED:
        return _extrapolated_call(name, size, other)
    if method in (TIME, BOX_TIME):
        system = cases.line(name, size) if method == TIME else cases.box(name, size)
        options = {"dt": system.period / other, "periods": cases.periods(name)}
        return lambda: _tension(lambda: solve_time_domain(system, **options, throw=False))
    if method in (BALANCE, CORRECTED, BOX_CORRECTED):
        system = cases.box(name, size) if method == BOX_CORRECTED else cases.line(name, size)
        corrected = method != BALANCE
        return lambda: _tension(
            lambda: solve_periodic(system, harmonics=other, deferred_correction=corrected, throw=False)
        )
    return _peer_call(cable_work.peer_adapters()[method], name, size, other)


def _tension(solve) -> Tension:
    """Return what a solve gives, its forces included: they are what is asked for."""
    try:
        response = solve()
    except ConvergenceError as error:
        return Tension(None, error.args[0].splitlines()[0][:80])
    wave = last_period_tension(response) if response.success else None
    return Tension(wave, response.status.name, costs.count_work(response))


def _extrapolated_call(name, cells, steps):
    """Return a function that solves on two meshes and takes out the error of second order in cells and steps."""
    fine, count = cases.line(name, cells), cases.periods(name)
    coarse = cases.every_second_node(fine)

    def run():
        runs = ((coarse, 2 * fine.period / steps), (fine, fine.period / steps))
        waves = [_tension(partial(solve_time_domain, system, dt=dt, periods=count, throw=False)) for system, dt in runs]
        failed = [one for one in waves if one.wave is None]
        if failed:
            return failed[0]
        extrapolated = waves[1].wave + (waves[1].wave - waves[0].wave) / 3
        return Tension(extrapolated, work=costs.add_work(one.work for one in waves))

    return run


def _peer_call(adapter, name, size, steps):
    case, period = cases.scene(name), cases.scene(name).motion.period
    moved = Ramped(case.motion, period / 2)  # as solve_time_domain starts by default

    def run():
        answer = cable_work.ask(adapter, case, moved, period, (size, steps), cases.periods(name))
        return Tension(answer.tension, answer.kind.upper() or "SUCCESS", answer.work)

    return run


def calls(name: str, quick: bool) -> dict:
    """Return (method, size, other) -> call of every setting of a case."""
    chosen = QUICK if quick else SETTINGS | (OVER_SEABED if name in cases.SEABED else {})
    plan = {
        (method, *setting): call(name, method, *setting) for method, settings in chosen.items() for setting in settings
    }
    for label in cable_work.peer_adapters():
        settings = QUICK_PEER if quick else PEER_SETTINGS + (FINE_PEER,) * (name in NEED_FINE_PEER)
        plan |= {(label, *setting): call(name, label, *setting) for setting in settings}
    return plan


def points(name: str, reference, quick: bool):
    """Yield a dict for each setting of a case: method, size, other, least seconds, rms, error, status, cost.

    All settings take turns in a random order, ROUNDS times; a call longer than LONG is not repeated, one shorter than
    SHORT is timed with warm caches.
    """
    plan = calls(name, quick)
    seconds, answers = dict.fromkeys(plan, math.inf), {}
    rng = np.random.default_rng(2026)
    with one_blas_thread():
        for _ in range(ROUNDS):
            for i in rng.permutation(len(plan)).tolist():
                key, run = list(plan.items())[i]
                if key in answers and seconds[key] > LONG:
                    continue
                if seconds[key] < SHORT:
                    run()
                began = time.perf_counter()
                answers[key] = run()
                seconds[key] = min(seconds[key], time.perf_counter() - began)
                yield None
    for (method, size, other), answer in answers.items():
        if answer.status == "UNSUPPORTED":
            continue
        errors = {"rms": None, "error": None} if answer.wave is None else reference.errors(answer.wave)
        point = {"case": name, "method": method, "size": size, "other": other, "status": answer.status}
        yield point | {"seconds": seconds[method, size, other]} | errors | answer.work


def pareto_front(points) -> list[dict]:
    """Return the points that none is both faster and more accurate than, by growing run time."""
    front = []
    for point in sorted((p for p in points if p["rms"]), key=lambda p: (p["seconds"], p["rms"])):
        if not front or point["rms"] < front[-1]["rms"]:
            front.append(point)
    return front


def seconds_at(front, rms: float) -> float | None:
    """Return the run time at an error, interpolated in logarithms along a front; None below its least error.

    Above its greatest error: the least time of the front.
    """
    if not front or rms < front[-1]["rms"]:
        return None
    errors = np.log([point["rms"] for point in front[::-1]])
    return float(np.exp(np.interp(math.log(rms), errors, np.log([point["seconds"] for point in front[::-1]]))))


def ratios(points, method: str, wanted=WANTED, own=OWN) -> list[dict]:
    """Return for each setting on a method's front with a wanted error: its time over that of ``own`` at that error."""
    rows = []
    for case in dict.fromkeys(point["case"] for point in points):
        mine = [point for point in points if point["case"] == case]
        front = pareto_front(point for point in mine if point["method"] in own)
        for point in pareto_front(point for point in mine if point["method"] == method):
            ours = seconds_at(front, point["rms"])
            if wanted[0] <= point["rms"] <= wanted[1] and ours is not None:
                rows.append({key: point[key] for key in ("case", "method", "size", "other", "rms", "seconds")}
                            | {"ours": ours, "ratio": point["seconds"] / ours})  # fmt: skip
    return rows
