"""Steps and cells for a tolerance on what is asked: chosen from pilot cases, checked on a sample of the table.

The error of a setting is what half the step, and what twice the cells, change of maximum, standard deviation and
damage-equivalent load, each over itself (LEAST_SIZE of the mean at least), by 4/3 for a method of second order; SAFETY
times the sum of both is promised. The pilots are the cases of the fastest and of the widest motion, and some between:
of each the first PILOT_TIME.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from ..common.load_case import LoadCase
from ..common.motions.irregular_motion import IrregularMotion
from ..common.motions.sea_state import SeaState
from ..common.outcome import ConvergenceError, InputError
from .results import QUANTITIES, Accuracy, CaseResult

COARSEST = 0.4, 12  # s, cells: where the search begins
FINER = math.sqrt(2)  # by which it goes on in one of them: half the step is known two steps of the search before
FINEST = 0.005, 400
PATIENCE = 6  # refinements, within which errors of first order fall to a third
PILOT_TIME = 600.0  # s after the ramp
PILOTS = 4
SAMPLE, LARGE_SAMPLE = 5, 20  # cases of the table that are run again; of one that has more than LARGE_SAMPLE
SAMPLE_SEED = 1  # of numpy's default generator, which draws the cases of a large sample
LEAST_SIZE = 0.01  # of the mean tension: a smaller deviation or range errs over that, for it matters to nobody
SAFETY = 1.5  # the estimates are those of second order, which slack and touchdown reach late
_ORDER_FACTOR = 4 / 3  # of a change by half a step, for the error of the whole one: 1 / (1 - 2^-2)
LEAST_ARM = 10.0  # m
_LOOKED_AT = 256  # times of a motion that is no sea


def choose_setting(rows, tolerance: float, run, takes_best: bool = False) -> tuple[float, int, Accuracy]:
    """Return dt in s, cells and the Accuracy that they promise for a list of LoadCase.

    run: (numbered cases, dt, cells) -> their CaseResult. The search ends at the finest setting, or where PATIENCE
    refinements have not halved what is left. Where no setting meets the tolerance: raises ConvergenceError, or with
    takes_best returns the one of those tried that leaves least, if it solves the pilot cases.
    """
    pilots = list(enumerate(_shortened(rows[i]) for i in _pilots(rows)))
    if not pilots:
        raise InputError("no row is a load case that could be solved", field="cases", value=None)
    known: dict[tuple, list[CaseResult]] = {}

    def results(dt, cells):
        key = round(dt, 12), cells  # half a step is the same number, whichever way the search came to it
        if key not in known:
            known[key] = sorted(run(pilots, dt, cells), key=lambda result: result.number)
        return known[key]

    step, mesh = 0, 0
    tried: list[tuple[float, float, int]] = []  # what each setting leaves, its step and cells
    while True:
        dt, cells = COARSEST[0] / FINER**step, round(COARSEST[1] * FINER**mesh)
        by_step = _error(results(dt, cells), results(dt / 2, cells))
        by_mesh = _error(results(dt, cells), results(dt, 2 * cells))
        promised = SAFETY * _ORDER_FACTOR * (by_step + by_mesh)
        if promised <= tolerance:
            return dt, cells, Accuracy(tolerance, promised)
        tried.append((promised, dt, cells))
        if by_step >= by_mesh:
            step += 1
        else:
            mesh += 1
        is_finest = COARSEST[0] / FINER**step < FINEST[0] or COARSEST[1] * FINER**mesh > FINEST[1]
        if is_finest or (len(tried) > PATIENCE and promised > tried[-1 - PATIENCE][0] / 2):
            least = min(tried)
            if takes_best and math.isfinite(least[0]):
                return least[1], least[2], Accuracy(tolerance, least[0])
            failed = next((one.message for one in results(dt, cells) if not one.success), "")
            problem = f"no step and mesh meets a tolerance of {tolerance:g}: at dt = {dt:g} s and {cells} cells "
            raise ConvergenceError(f"{problem}{promised:.2g} is left; {failed}".rstrip("; "))


def measure_accuracy(rows, table, accuracy: Accuracy, run) -> Accuracy:
    """Return the Accuracy with what half the step and twice the cells change on a sample of the table."""
    chosen = draw_sample([case.number for case in table.cases if case.success])
    finer = run([(i, rows[i]) for i in chosen], table.dt / 2, 2 * table.cells)
    changes = [_ORDER_FACTOR * _error([table.cases[fine.number]], [fine]) for fine in finer]
    tolerance = accuracy.tolerance or 0.0
    within = sum(change <= tolerance for change in changes)
    return replace(accuracy, measured=max(changes, default=None), within=within, sampled=len(changes))


def draw_sample(solved: list[int]) -> list[int]:
    """Return the numbers of the rows to check, in order: SAMPLE evenly spaced, or of more than LARGE_SAMPLE that many.

    Those are drawn at random, each row as likely as any other, and always the same of the same table: 19 of 20 within
    the tolerance is then what is to be expected of the table.
    """
    if len(solved) <= LARGE_SAMPLE:
        return sorted({solved[int(i)] for i in np.linspace(0, len(solved) - 1, min(SAMPLE, len(solved)))})
    return sorted(np.random.default_rng(SAMPLE_SEED).choice(solved, LARGE_SAMPLE, replace=False).tolist())


def _error(results, finer) -> float:
    """Return the largest change of what is asked, over lines and cases; infinite where a case failed in one."""
    largest = 0.0
    for one, other in zip(results, finer, strict=True):
        if not other.success or not one.success:
            return np.inf
        for a, b in zip(one.lines, other.lines, strict=True):
            for name in QUANTITIES:
                size = max(abs(getattr(b, name)), LEAST_SIZE * abs(b.mean))
                largest = max(largest, abs(getattr(a, name) - getattr(b, name)) / size if size else 0.0)
    return largest


def _shortened(case: LoadCase) -> LoadCase:
    return replace(case, duration=min(case.duration, PILOT_TIME))


def _pilots(rows) -> list[int]:
    """Return the numbers of the rows with the fastest and the widest motion, and of some between, from the fastest."""
    there = [i for i, row in enumerate(rows) if isinstance(row, LoadCase)]
    if not there:
        return []
    speed, width = np.array([_vigour(rows[i]) for i in there]).T
    by_speed = [there[i] for i in np.argsort(-speed, kind="stable")]
    chosen = [by_speed[0], there[int(width.argmax())]]
    chosen += [by_speed[len(by_speed) // k] for k in (4, 2)]
    return list(dict.fromkeys(chosen))[:PILOTS]


def _vigour(case: LoadCase) -> tuple[float, float]:
    """Return root mean squares of the velocity, m/s, and of the displacement with the offset, m, of a case.

    Angles count as on an arm as long as the reference point is off the origin, LEAST_ARM at least.
    """
    motion = case.motion.motion() if isinstance(case.motion, SeaState) else case.motion
    parts: list[Any] = [getattr(motion, "translation", motion), getattr(motion, "rotation", None)]
    arm = max(float(np.linalg.norm(getattr(motion, "reference", (0.0, 0.0, 0.0)))), LEAST_ARM)
    speed = width = 0.0
    for part, factor in zip(parts, (1.0, arm), strict=True):
        if part is None:
            continue
        if isinstance(part, IrregularMotion):
            rms = part.velocity_deviation, part.standard_deviation
        else:
            times = np.linspace(0.0, case.whole_duration, _LOOKED_AT)
            rms = tuple(np.sqrt((call(times) ** 2).mean(axis=1)) for call in (part.velocity, part.displacement))
        speed, width = (x + factor * float(np.linalg.norm(y)) for x, y in zip((speed, width), rms, strict=True))
    return speed, width + float(np.linalg.norm(case.offset))
