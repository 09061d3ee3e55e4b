"""Every solver of spans, this project's and the installed peers', behind one call that never raises and always ends."""

from __future__ import annotations

import math
import os
import signal
import time
import tomllib
import warnings
from collections.abc import Callable
from contextlib import contextmanager, redirect_stdout
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from verification.reference import WRONG, SpanTruth, force_error
from verification.registry import SOLVERS, SpanAnswer

from . import peers

TIME_LIMIT = 5.0
"""Seconds after which one solve counts as refused: 500 times what the slowest solver takes on an everyday line."""

OVERTIME = f"no answer within {TIME_LIMIT:g} s"

EXCUSED = 100.0
"""Errors up to this many condition limits are not called wrong, however large: at L = chord with an extreme EA,
rounding the inputs moves the true force by more than WRONG, and no code in double precision can do better. The same
bound holds for every solver; 100 is what this project asks of its own answers on its reference table."""

BATCH = "catenary-batch"
BATCH_LABEL = "this project, many lines in one call"
MIXED = "mixed-lines"
"""Names in the result files of solve_spans and of the lines that it solves together."""

OURS = {"catenary": "this project"}
"""Labels of this project's solvers; one that is not here goes by its name."""


@dataclass(frozen=True)
class Solver:
    """One solver of spans: solve(case, tolerance=None) -> SpanAnswer; unsupported(case) -> reason or ""."""

    name: str
    label: str
    version: str
    solve: Callable
    unsupported: Callable = lambda case: ""


def solvers() -> dict[str, Solver]:
    """This project's solvers from the registry, then the installed peers."""
    project = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    ours = {
        name: Solver(name, OURS.get(name, name), project["version"], solve) for name, solve in SOLVERS["span"].items()
    }
    return ours | {
        name: Solver(name, peer.LABEL, peer.version(), peer.solve, peer.unsupported)
        for name, peer in peers.available().items()
    }


@contextmanager
def quiet():
    """Silence for codes that print and warn; the time it takes is spent outside the clock."""
    with open(os.devnull, "w") as nowhere, redirect_stdout(nowhere), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with np.errstate(all="ignore"):
            yield


class _Overtime(BaseException):
    """Not an Exception, so that no solver's own handler swallows it."""


def _ring(*_):
    raise _Overtime


@contextmanager
def _time_limit(seconds: float):
    """_Overtime after ``seconds`` (in the main thread of a process; without a limit where there are no such timers)."""
    if not hasattr(signal, "setitimer"):
        yield
        return
    before = signal.signal(signal.SIGALRM, _ring)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def ask(solver: Solver, case, tolerance=None) -> SpanAnswer:
    """The solver's answer; one that raises, returns NaN or takes longer than TIME_LIMIT has refused."""
    try:
        with quiet(), _time_limit(TIME_LIMIT):
            answer = solver.solve(case, tolerance)
    except _Overtime:
        return SpanAnswer(refused=OVERTIME)
    except Exception as error:  # whatever a peer raises is its way of refusing
        return SpanAnswer(refused=f"{type(error).__name__}: {error}")
    if not answer.refused and not (math.isfinite(answer.H) and math.isfinite(answer.V)):
        return SpanAnswer(refused=f"returned H = {answer.H}, V = {answer.V}")
    return answer


def judge(answer: SpanAnswer, truth: SpanTruth, case) -> dict:
    """The row of a result file: verdict, error (of the force, over the tension), the same in condition limits and in
    weights of the line (a wrong force of 1e-7 line weights matters to nobody), iterations, message.
    """
    if answer.refused:
        return _judged("refused", math.nan, truth, case, None, answer.refused)
    error = force_error(answer.H, answer.V, truth, case)
    verdict = "wrong" if error > max(WRONG, EXCUSED * truth.limit) else "right"
    return _judged(verdict, error, truth, case, answer.iterations, "")


def _judged(verdict, error, truth, case, iterations, message):
    weight = abs(case.w) * case.L
    return {
        "verdict": verdict,
        "error": error,
        "in_limits": error / truth.limit,
        "in_weights": error * math.hypot(truth.H, truth.V) / weight if weight else None,
        "iterations": iterations,
        "message": message[:200],
    }


def assess(solver: Solver, case, truth: SpanTruth, tolerance=None) -> dict:
    """Ask and judge; "unsupported", with the reason, where the peer's model does not include the case."""
    reason = solver.unsupported(case)
    if reason:
        return _judged("unsupported", math.nan, truth, case, None, reason)
    return judge(ask(solver, case, tolerance), truth, case)


REPEATS, SLOW_REPEATS = 7, 3
LONG = 0.5  # s a call: one such call is enough, no interruption is as long
SLOW = 5e-3  # s a call: such calls are repeated SLOW_REPEATS times, one by one
BLOCK = 2e-3  # s: fast calls are timed in blocks of about this length, far above the resolution of the clock


def seconds_per_call(call) -> float:
    """Minimum over repeated blocks of calls; the caller has made the warm-up call."""
    with quiet():
        once = clock(call, 1)
        if once > LONG:
            return once
        count = 1 if once > SLOW else max(1, round(BLOCK / once))
        repeats = SLOW_REPEATS if once > SLOW else REPEATS
        return min(clock(call, count) for _ in range(repeats)) / count


def clock(call, count: int) -> float:
    """Seconds of ``count`` calls."""
    start = time.perf_counter()
    for _ in range(count):
        call()
    return time.perf_counter() - start


def measure(solver: Solver, case, truth: SpanTruth, tolerance=None) -> dict:
    """As ``assess``, with the seconds of one cold solve (none where the solver refuses)."""
    found = assess(solver, case, truth, tolerance)  # also the warm-up call
    if found["verdict"] in ("right", "wrong"):
        return found | {"seconds": seconds_per_call(lambda: solver.solve(case, tolerance))}
    return found | {"seconds": None}
