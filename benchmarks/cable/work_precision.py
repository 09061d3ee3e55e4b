"""Error against run time of the moving cables: harmonic balance, time domain, and other codes that solve them."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from solvers.common.motions.motion import Ramped
from solvers.numerics.threads import one_blas_thread
from verification.registry import PROBLEMS

from .. import peers
from ..run import costs, harness
from ..run.harness import clock
from .cases import PERIODS, system

SETTINGS = {
    "harmonic balance": ((10, 3), (13, 3), (17, 5), (25, 5), (25, 9), (35, 9), (50, 9), (50, 15), (100, 15), (200, 24)),
    "harmonic balance, corrected": ((7, 3), (8, 4), (9, 5), (9, 7), (13, 7), (13, 9), (15, 6), (17, 9), (17, 12),
                                    (17, 15), (21, 12), (25, 9), (25, 12), (25, 15), (25, 18), (29, 18), (41, 12),
                                    (35, 24), (50, 30)),
    "time domain": ((17, 0.8, 2), (25, 0.8, 2), (25, 0.4, 2), (50, 0.4, 2), (50, 0.2, 2), (70, 0.2, 2), (100, 0.2, 2),
                    (100, 0.2), (100, 0.1, 2), (140, 0.1, 2), (140, 0.2), (200, 0.1), (200, 0.05)),
    "time domain, extrapolated": ((13, 0.8, 2), (13, 0.4), (25, 0.4), (25, 0.2)),
}  # fmt: skip
"""(nodes, harmonics), the same with a deferred correction, (nodes, dt in s), (nodes and dt of the coarser of two runs):
pairs that grow together, for of two errors the larger hides the other. Two periods, where they are given, are enough
for the errors of large steps; finer ones need PERIODS. Other codes have their own settings, (cells, steps in a period).
"""
QUICK = {
    "harmonic balance": ((13, 3), (25, 5), (50, 9), (50, 15)),
    "harmonic balance, corrected": ((9, 5), (13, 9), (17, 15), (25, 24)),
    "time domain": ((25, 0.4, 2), (50, 0.2, 2), (100, 0.2)),
    "time domain, extrapolated": ((13, 0.4),),
}
QUICK_PEER = slice(1, None, 2)  # of the settings of another code
PAPER_SETTING = (49, 1000)  # (cells, steps in a period) of another code beside the paper's settings

ERRORS = (3e-2, 1e-2, 3e-3, 1e-3, 3e-4)  # rms of the tension over its range, at which methods are set side by side

LONG, ENOUGH, REPEATS = 0.1, 0.2, 3  # s: of a call that is timed once; of all repeats of a shorter one; at most so many
"""Three calls of 0.1 to 0.3 s in turn, of Table 2 remade, differ by 3 % at most."""


def peer_adapters() -> dict[str, peers.Adapter]:
    """Label -> other code that solves moving cables."""
    return {adapter.label: adapter for adapter in peers.solving("cable").values()}


@dataclass(frozen=True)
class PeerTension:
    """Fairlead tension (n,) in N of another code over the last period, from its beginning; None: it gave none.

    kind "refused" or "unsupported", message why. work: what it cost, as ``costs.count_work`` has it.
    """

    tension: np.ndarray | None
    kind: str = ""
    message: str = ""
    work: dict = field(default_factory=lambda: costs.NOT_TOLD)


def ask(adapter: peers.Adapter, scene, motion, period: float, setting, periods=PERIODS) -> PeerTension:
    """The last of some periods (s) of a motion from rest, at (cells, steps in a period); it never raises."""
    cells, steps = setting
    time = np.linspace(0.0, periods * period, periods * steps + 1)
    fairlead = np.array(scene.fairlead) + motion.displacement(time).T
    limit = adapter.limit("cable") * max(1.0, periods / PERIODS)
    who = f"{adapter.name}, cables"
    answer, kind, message = harness.attempt(lambda: adapter.cable(scene, time, fairlead, cells), limit, who)
    if not kind:
        answer, kind, message = harness.checked(answer, time.shape)
    if kind:
        return PeerTension(None, kind, message)
    return PeerTension(answer[-1 - steps : -1], work=_count_peer_work(adapter, scene, time, cells))


def _count_peer_work(adapter, scene, time, cells: int) -> dict:
    """Return what another code cost, where its adapter knows the steps that it takes within a coupling step."""
    if not hasattr(adapter, "count_cable_steps"):
        return costs.NOT_TOLD
    inner = adapter.count_cable_steps(scene, time[1] - time[0], cells)
    return costs.count_explicit(len(time) - 1, inner, adapter.stages, cells)


def call(name: str, method: str, size: int, other, periods=PERIODS):
    """A function of no argument that solves the case from rest; what it returns is for ``errors``."""
    if method in peer_adapters():
        return _peer_call(peer_adapters()[method], system(name), size, other)
    more = (periods,) if method.startswith("time domain") else ()
    return PROBLEMS["cable"].solvers[method](partial(system, name), size, other, *more)


def peer_calls(name: str) -> dict:
    """Label -> call of every other code on a case, as finely as the paper's settings."""
    return {label: call(name, label, *PAPER_SETTING) for label in peer_adapters()}


def _peer_call(adapter, chain, cells, steps):
    moved = Ramped(chain.scene.motion, chain.period / 2)  # as solve_time_domain starts by default
    return lambda: ask(adapter, chain.scene, moved, chain.period, (cells, steps))


def errors(reference, answer) -> dict:
    """rms, error, status and cost of what ``call`` returned; of another code that gave no tension, why."""
    if isinstance(answer, PeerTension) and answer.tension is None:
        return {"rms": None, "error": None, "status": answer.kind.upper(), "message": answer.message[:200]}
    if isinstance(answer, (np.ndarray, PeerTension)):
        work = getattr(answer, "work", costs.NOT_TOLD)
        return reference.errors(getattr(answer, "tension", answer)) | {"status": "SUCCESS"} | work
    return reference.errors_of_response(answer) | {"status": answer.status.name} | costs.count_work(answer)


def least_seconds(run) -> tuple[float, object]:
    """Least time of a few calls, and what the first returned."""
    start = time.perf_counter()
    result = run()
    seconds, spent = [time.perf_counter() - start], 0.0
    while seconds[0] < LONG and spent < ENOUGH and len(seconds) < REPEATS:
        seconds.append(clock(run, 1))
        spent += seconds[-1]
    return min(seconds), result


def points(name: str, reference, quick: bool):
    """Yield each point of a case; of a code whose model does not include it, none."""
    period = reference.period
    for method, settings in (QUICK if quick else SETTINGS).items():
        second = "harmonics" if method.startswith("harmonic") else "dt"
        for size, other, *periods in settings:
            run = call(name, method, size, other, *periods)
            with one_blas_thread():  # also around what is made of a response: threads wait for each other
                seconds, answer = least_seconds(run)
            point = {"case": name, "method": method, "size": size, second: other, "seconds": seconds}
            yield point | ({"periods": periods[0]} if periods else {}) | errors(reference, answer)
    for method, adapter in peer_adapters().items():
        for cells, steps in adapter.settings[QUICK_PEER if quick else slice(None)]:
            with one_blas_thread():
                seconds, answer = least_seconds(call(name, method, cells, steps))
            if answer.kind == "unsupported":
                break
            point = {"case": name, "method": method, "size": cells, "dt": period / steps, "seconds": seconds}
            point["code"] = f"{method} {adapter.version}".strip()
            yield point | errors(reference, answer)
            if answer.message.startswith(harness.OVERTIME):
                break


def at_errors(points) -> list[dict]:
    """Of each case and each of ERRORS that a method reaches: the least time (s) of every method that does, and how.

    Names that begin with the same words before a comma are one method: each has its best settings.
    """
    rows = []
    for case in dict.fromkeys(point["case"] for point in points):
        for level in ERRORS:
            best = {}
            for point in points:
                if point["case"] == case and point["rms"] is not None and point["rms"] <= level:
                    method = point["method"].partition(",")[0]
                    best[method] = min(best.get(method, point), point, key=lambda one: one["seconds"])
            if best:
                rows.append({"case": case, "level": level, "best": best})
    return rows
