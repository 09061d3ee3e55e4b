"""Error against run time of the moving cables: harmonic balance, time domain, and MoorDyn where it is installed."""

from __future__ import annotations

import importlib.util
import time

import numpy as np

from solvers.harmonic_balance import solve_periodic
from solvers.motion import Ramped
from solvers.threads import one_blas_thread
from solvers.time_domain import solve_time_domain

from .dynamic_cases import PERIODS, on_mesh, system, wave
from .harness import clock

SETTINGS = {
    "harmonic balance": ((10, 3), (13, 3), (17, 5), (25, 5), (25, 9), (35, 9), (50, 9), (50, 15), (100, 15), (200, 24)),
    "harmonic balance, extrapolated": ((13, 5), (13, 7), (13, 9), (13, 12), (17, 15), (25, 15), (25, 20), (25, 30),
                                       (50, 30)),
    "time domain": ((25, 0.8, 2), (25, 0.4, 2), (50, 0.4, 2), (50, 0.2, 2), (100, 0.2), (100, 0.1), (200, 0.1),
                    (200, 0.05)),
    "time domain, extrapolated": ((13, 0.8, 2), (13, 0.4), (25, 0.4), (25, 0.2)),
    "MoorDyn": ((12, 0.1), (24, 0.04), (49, 0.02), (98, 0.01)),
}  # fmt: skip
"""(nodes, harmonics), (nodes of the coarser of two meshes, harmonics), (nodes, dt in s), (nodes and dt of the coarser
of two runs), (segments, coupling step in s): pairs that grow together, for of two errors the larger hides the other.
Two periods, where they are given, are enough for the errors of large steps; finer ones need PERIODS. 196 segments take
MoorDyn four times as long as 98 and, but for case 3, no further: they are left out."""
QUICK = {
    "harmonic balance": ((13, 3), (25, 5), (50, 9), (50, 15)),
    "harmonic balance, extrapolated": ((13, 9), (17, 15), (25, 20)),
    "time domain": ((25, 0.4, 2), (50, 0.2, 2), (100, 0.2)),
    "time domain, extrapolated": ((13, 0.4),),
    "MoorDyn": ((24, 0.04), (49, 0.02)),
}
COUPLING = 0.02  # s: of MoorDyn beside the paper's settings

LONG, ENOUGH, REPEATS = 0.3, 0.2, 3  # s: of a call that is timed once; of all repeats of a shorter one; at most so many


def methods() -> list[str]:
    """Of this project, and the peer if it is there."""
    return [name for name in SETTINGS if name != "MoorDyn" or has_moordyn()]


def has_moordyn() -> bool:
    """Whether the peer is installed."""
    return importlib.util.find_spec("moordyn") is not None


def call(name: str, method: str, size: int, other, periods=PERIODS):
    """A function of no argument that solves the case from rest; what it returns is for ``errors``."""
    if method == "MoorDyn":
        return _moordyn(system(name), size, other)
    chain = system(name, size)
    if method == "time domain":
        return lambda: solve_time_domain(chain, dt=other, periods=periods, throw=False)
    if method == "harmonic balance":
        return lambda: solve_periodic(chain, harmonics=other, throw=False)
    finer = system(name, 2 * size - 1)
    if method == "time domain, extrapolated":
        return lambda: extrapolated_steps(chain, finer, other, periods)
    return lambda: extrapolated(chain, finer, other)


def extrapolated(chain, finer, harmonics: int) -> np.ndarray:
    """Tension of two meshes, the cells of the finer one half as long: its error of second order taken out."""
    coarse = solve_periodic(chain, harmonics=harmonics)
    fine = solve_periodic(finer, harmonics=harmonics, start=on_mesh(coarse, finer))
    return _second_order(wave(coarse), wave(fine))


def extrapolated_steps(chain, finer, dt: float, periods) -> np.ndarray:
    """The same of time stepping: cells and steps half as long."""
    return _second_order(*(
        wave(solve_time_domain(of, dt=step, periods=periods)) for of, step in ((chain, dt), (finer, dt / 2))
    ))  # fmt: skip


def _second_order(coarse, fine) -> np.ndarray:
    return fine + (fine - coarse) / 3


def _moordyn(chain, segments, coupling):
    from .peers import moordyn

    scene, period = chain.scene, chain.period
    moved = Ramped(scene.motion, period / 2)  # as solve_time_domain starts by default
    options = {"segments": segments, "coupling": coupling}
    return lambda: moordyn.simulate(scene, moved.displacement, PERIODS * period, **options)


def last_period(found, period: float) -> np.ndarray:
    """Tension of a peer, (time, tension), at equal times of the last period from its beginning."""
    time, tension = found
    return np.roll(tension[time > time[-1] - period + 1e-9], 1)  # its first value is one step into the period


def errors(reference, found) -> dict:
    """rms, error and status of what ``call`` returned."""
    if isinstance(found, np.ndarray):
        return reference.errors(found) | {"status": "SUCCESS"}
    if not isinstance(found, tuple):
        return reference.of(found) | {"status": found.status.name}
    tension = last_period(found, reference.period)
    if not np.isfinite(tension).all():
        return {"rms": None, "error": None, "status": "NOT_FINITE"}
    return reference.errors(tension) | {"status": "SUCCESS"}


def least_seconds(run) -> tuple[float, object]:
    """Least time of a few calls, and what the first returned."""
    start = time.perf_counter()
    found = run()
    seconds, spent = [time.perf_counter() - start], 0.0
    while seconds[0] < LONG and spent < ENOUGH and len(seconds) < REPEATS:
        seconds.append(clock(run, 1))
        spent += seconds[-1]
    return min(seconds), found


def points(name: str, reference, quick: bool):
    """Yield each point of a case."""
    for method in methods():
        second = "harmonics" if method.startswith("harmonic") else "dt"
        for size, other, *periods in (QUICK if quick else SETTINGS)[method]:
            run = call(name, method, size, other, *periods)
            with one_blas_thread():  # also around what is made of a response: threads wait for each other
                seconds, found = least_seconds(run)
            point = {"case": name, "method": method, "size": size, second: other, "seconds": seconds}
            yield point | ({"periods": periods[0]} if periods else {}) | errors(reference, found)
