"""Response curves of the cases, their branches, and time integrations beside their special points."""

from __future__ import annotations

import time

import numpy as np

from solvers import ConvergenceError
from solvers.stability import response_curve, switch_branch
from solvers.stability.curves.special_points import BRANCH_POINT, PERIOD_DOUBLING

from .confirm import confirm
from .systems import CurveCase

MOST_POINTS, QUICK_POINTS, BRANCH_POINTS, BRANCHES = 100, 40, 50, 2
STEP = 0.02
LEADING = 6  # multipliers of a point that are kept


def measure_case(case: CurveCase, quick: bool):
    """Return the curves of a case by amplitude, each with its branches and confirmations."""
    rows = []
    for amplitude in case.amplitudes[-1:] if quick else case.amplitudes:
        start = time.process_time()
        curve = follow(case, amplitude, QUICK_POINTS if quick else MOST_POINTS)
        seconds = time.process_time() - start
        branches = [] if quick else list(follow_branches(case, amplitude, curve))
        rows.append({"amplitude": amplitude, "seconds": seconds, "curve": describe(curve),
                     "unresolved": [{"kind": point.kind, "value": point.value, "doubt": point.doubt}
                                    for point in curve.unresolved],
                     "branches": [{"name": name} | describe(branch) for name, branch in branches],
                     "confirmed": confirm(curve, branches)})  # fmt: skip
    return {"name": case.name, "title": case.title, "curves": rows}


def tension(response):
    """Return the tension at the moved end over the samples, N, and the sizes of the fields, m, (1 + n, S)."""
    y = response.at(response.time) - response.system.rest_state()[..., None]
    system = response.system
    if hasattr(system.model, "given") and len(system.layout.s) > 1:
        nodes = range(len(system.layout.s))
        forces = [np.linalg.norm(response.end_force_at(response.time, -1, e), axis=1) for e in nodes]
        return np.concatenate([np.max(forces, axis=0)[None], abs(y).max(axis=1)])
    return np.concatenate([response.fairlead_tension(response.time)[None], abs(y).max(axis=1)])


def follow(case: CurveCase, amplitude, max_points):
    """Return the ResponseCurve of a case, as far as it comes."""
    return response_curve(case.build(amplitude, case.start), start=case.start, stop=case.stop,
                          harmonics=case.harmonics, step=STEP, max_step=case.max_step, max_points=max_points,
                          stability=True, output=tension, throw=False)  # fmt: skip


def follow_branches(case, amplitude, curve):
    """Yield (name, curve) of the first branches that leave a curve."""
    for point in [each for each in curve.special if each.kind in (BRANCH_POINT, PERIOD_DOUBLING)][:BRANCHES]:
        name = "doubled branch" if point.kind == PERIOD_DOUBLING else "sideways branch"
        for step in (0.02, -0.02, 0.005):
            try:
                begin = switch_branch(curve, point, step=step)
            except ConvergenceError:
                continue
            first = begin.response
            side = 1 if begin.value >= point.value else -1
            stop = case.stop if side > 0 else case.start
            branch = response_curve(case.build(amplitude, case.start), start=begin.value, stop=stop, first=first,
                                    harmonics=first.z.shape[-1] // 2, subharmonic=first.subharmonic, step=0.05,
                                    max_step=0.1, max_points=BRANCH_POINTS, stability=True, output=tension,
                                    throw=False)  # fmt: skip
            if branch.values.size > 1:
                yield name, branch
                break


def describe(curve) -> dict:
    """Return what the page shows of a curve: a list for each number of its points, and its special points."""
    sideways = None if curve.sideways is None else [float(abs(each).max()) for each in curve.sideways]
    special = [{"kind": point.kind, "value": point.value, "after": point.after,
                "tension": float(curve.greatest[point.after, 0]),
                "multipliers": _leading(point.multipliers)} for point in curve.special]  # fmt: skip
    return {"frequency": curve.values, "greatest": curve.greatest[:, 0], "least": curve.least[:, 0],
            "sizes": curve.greatest[:, 1:], "stable": curve.stable, "errors": curve.errors,
            "harmonics": curve.harmonics, "sideways": sideways, "special": special, "status": curve.status.name,
            "end": curve.end, "multipliers": [_leading(each) for each in curve.multipliers]}  # fmt: skip


def _leading(multipliers):
    """Return (real, imaginary) of the largest multipliers, lists of two."""
    largest = multipliers[np.argsort(-abs(multipliers))][:LEADING]
    return [[float(each.real), float(each.imag)] for each in largest]
