"""Every solver of spans, this project's and other codes, behind one call that never raises and always ends."""

from __future__ import annotations

import math
import os
import signal
import time
import warnings
from collections import Counter
from collections.abc import Callable
from contextlib import contextmanager, redirect_stdout
from dataclasses import dataclass
from importlib import metadata
from numbers import Real

import numpy as np

from verification.reference import WRONG, SpanTruth, force_error
from verification.registry import PROBLEMS, SpanAnswer

from .. import peers

DISTRIBUTION = "mooring-verification"

OVERTIME = "no answer within"
"""How the words begin with which a solver is refused that takes longer than peers.LIMITS or its own limit."""

PATIENCE = 5
"""Times in a row that a solver may take too long before it is not asked again in this process."""

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
    """One solver of spans: solve(case, tolerance=None) -> SpanAnswer; limit in s, of one solve.

    tolerances : whether it takes one
    """

    name: str
    label: str
    version: str
    solve: Callable
    limit: float = peers.LIMITS["span"]
    tolerances: bool = True


def own_version() -> str:
    """Return the version of this distribution, or "unknown" in a folder that was never installed.

    Not ``solvers.__version__``: results would depend on every module that the package ``solvers`` imports.
    """
    try:
        return metadata.version(DISTRIBUTION)
    except metadata.PackageNotFoundError:
        return "unknown"


def solvers() -> dict[str, Solver]:
    """This project's solvers from the registry, then the other codes that solve spans."""
    own = PROBLEMS["span"].solvers.items()
    ours = {name: Solver(name, OURS.get(name, name), own_version(), solve) for name, solve in own}
    return ours | {
        name: Solver(name, one.label, one.version, one.span, one.limit("span"), one.tolerances)
        for name, one in peers.solving("span").items()
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


_overtime: Counter = Counter()
"""Who -> times in a row that it took too long."""


def attempt(call: Callable, limit: float, who: str) -> tuple[object, str, str]:
    """(what the call returns, "", ""), or (None, "refused" or "unsupported", why); it never raises and always ends.

    limit in s; ``who`` is not called again once it has taken longer PATIENCE times in a row.
    """
    if _overtime[who] >= PATIENCE:
        return None, "refused", f"{OVERTIME} {limit:g} s, {PATIENCE} times in a row: not asked again"
    try:
        with quiet(), _time_limit(limit):
            outcome = call(), "", ""
    except _Overtime:
        outcome = None, "refused", f"{OVERTIME} {limit:g} s"
    except NotImplementedError as error:
        outcome = None, "unsupported", str(error) or "it does not solve this problem"
    except peers.Refused as error:
        outcome = None, "refused", str(error) or "it gave no reason"
    except (Exception, SystemExit) as error:  # whatever it raises is its way of refusing
        outcome = None, "refused", f"{type(error).__name__}: {error}"
    value, kind, words = outcome
    _overtime[who] = _overtime[who] + 1 if words.startswith(OVERTIME) else 0
    return value, kind, " ".join(words.split())  # on one line of a table


def ask(solver: Solver, case, tolerance=None) -> SpanAnswer:
    """The solver's answer; one that raises, returns no finite forces or takes longer than its limit has refused."""
    answer, kind, words = attempt(lambda: solver.solve(case, tolerance), solver.limit, solver.name)
    if kind:
        return SpanAnswer(**{kind: words})
    if not isinstance(answer, SpanAnswer):
        return SpanAnswer(refused=f"returned {answer!r:.80}, and SpanAnswer(H, V) is wanted")
    if not (answer.refused or answer.unsupported or (_finite(answer.H) and _finite(answer.V))):
        return SpanAnswer(refused=f"returned H = {answer.H!r:.40}, V = {answer.V!r:.40}")
    return answer


def checked(tension, shape: tuple) -> tuple:
    """(tension as an array, "", ""), or (None, "refused", why) where it has not this shape or is not finite."""
    try:
        array = np.array(tension, dtype=float)
    except (TypeError, ValueError):
        return None, "refused", f"returned {tension!r:.80}, and tensions {shape} are wanted"
    if array.shape != shape:
        return None, "refused", f"returned tensions of shape {array.shape}, and {shape} is wanted"
    return (array, "", "") if np.isfinite(array).all() else (None, "refused", "tensions that are not finite")


def _finite(value) -> bool:
    return isinstance(value, Real) and math.isfinite(value)


def judge(answer: SpanAnswer, truth: SpanTruth, case) -> dict:
    """The row of a result file: verdict, error (of the force, over the tension), the same in condition limits and in
    weights of the line (a wrong force of 1e-7 line weights matters to nobody), iterations, message.
    """
    if answer.refused or answer.unsupported:
        verdict = "refused" if answer.refused else "unsupported"
        return _judged(verdict, math.nan, truth, case, None, answer.refused or answer.unsupported)
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
    """Ask and judge; "unsupported", with the reason, where the solver's model does not include the case."""
    return judge(ask(solver, case, tolerance), truth, case)


REPEATS, SLOW_REPEATS = 7, 3
LONG = 0.5  # s a call: one such call is enough, no interruption is as long
TIMED = SLOW_REPEATS + 1  # of the limit of one solve, for all the calls that are timed: one may answer, then hang
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


def seconds_or_none(call: Callable, solver: Solver, own: list) -> float | None:
    """Least seconds of a call that solves len(own) lines; by the solver's own clock, ``own``, where it gave all.

    None where there are no lines, or where the solver fails or hangs now although it answered before.
    """
    if not own or None not in own:
        return sum(own) or None
    limit = TIMED * len(own) * solver.limit
    return attempt(lambda: seconds_per_call(call), limit, solver.name)[0]


def measure(solver: Solver, case, truth: SpanTruth, tolerance=None) -> dict:
    """As ``assess``, with the seconds of one cold solve (none where the solver refuses)."""
    answer = ask(solver, case, tolerance)  # also the warm-up call
    row = judge(answer, truth, case)
    if row["verdict"] not in ("right", "wrong"):
        return row | {"seconds": None}
    return row | {"seconds": seconds_or_none(lambda: solver.solve(case, tolerance), solver, [answer.seconds])}
