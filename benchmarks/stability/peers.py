"""The same grids on other codes: refused, wrong or right; lines at rest, and in surge.

A wrong answer is told by its kind, the regime of the line and the size of the force that was returned; of each kind
one input stands in the file.
"""

from __future__ import annotations

import math

import numpy as np

from solvers import solve_periodic
from verification.registry import INSTANTS, instants

from ..cable.work_precision import ask, peer_adapters
from ..run import harness
from .maps import Axis
from .spans import GRIDS
from .time import line

DYNAMIC_WRONG = 0.1
"""Largest difference of the fairlead tension over its range; points where two meshes of this project differ by a fifth
of it have no truth."""

NODES, COARSE, HARMONICS, SEGMENTS = 41, 21, 12, 20
PERIODS, SECONDS = 6, 120.0  # at least, so that the waves of the start have died away
STEPS = 1000  # in a period
HERTZ = Axis("frequency, Hz", (0.01, 0.03, 0.1, 0.2, 0.5))
DRAG = Axis("drag coefficient", (0.3, 3.0, 30.0, 100.0))
SURGE = Axis("amplitude of the surge, m", (1.0, 3.0, 9.0))
"""Smaller motions and less drag leave the waves of the start in the last period."""
VERDICTS = ("right", "wrong", "refused", "unsupported")


def spans(known, quick: bool):
    """Yield a row for each map and solver of spans, its points and one example for each kind of wrong answer."""
    for name, (title, x, y, make) in GRIDS.items():
        step = 3 if quick else 1
        cases = [make(u, v) for v in y.thinned(step).values for u in x.thinned(step).values]
        for key, solver in harness.solvers().items():
            answers = [harness.assess(solver, case, known.get_or_compute(case)) for case in cases]
            yield {
                "map": name,
                "title": title,
                "solver": key,
                "label": solver.label,
                "version": solver.version,
                "counts": {v: sum(answer["verdict"] == v for answer in answers) for v in VERDICTS},
                "examples": list(_kinds(solver, cases, answers, known)),
            }


def _kinds(solver, cases, answers, known):
    """Of each kind of wrong answer its count and the case nearest to an everyday line."""
    kinds = {}
    for case, judged in zip(cases, answers, strict=True):
        if judged["verdict"] == "wrong":
            answer, truth = harness.ask(solver, case), known.get_or_compute(case)
            kinds.setdefault(_kind(answer, truth, case), []).append((_strangeness(case), case, answer, truth, judged))
    for kind, examples in kinds.items():
        _, case, answer, truth, judged = min(examples, key=lambda one: one[0])
        forces = {"H": answer.H, "V": answer.V, "exact_H": truth.H, "exact_V": truth.V}
        yield {"kind": kind, "count": len(examples), "inputs": case.inputs(), "error": judged["error"]} | forces


def _kind(answer, truth, case) -> str:
    slackness = case.L / math.hypot(case.x, case.z)
    where = "longer than" if slackness > 1.1 else "about as long as" if slackness >= 0.99 else "shorter than"
    share = math.hypot(answer.H, answer.V) / (math.hypot(truth.H, truth.V) or math.inf)
    size = "below half of" if share < 0.5 else "above twice" if share > 2 else "near"
    return f"line {where} its chord, force {size} the exact one"


def _strangeness(case) -> float:
    """How far from a line as it is used: decades of stiffness from 1e4 weights, and of friction above 1."""
    stiffness = abs(math.log10(case.EA / (case.w * case.L)) - 4)
    return stiffness + max(math.log10(case.friction or 1), 0) + abs(math.log10(max(case.z, 1e-9) / 300))


def dynamics(quick: bool):
    """Yield a row for each grid of every other code in surge; none in the quick run."""
    if quick:
        return
    by_frequency, by_drag = (lambda n, f, a: line(a, f, nodes=n)), (lambda n, c, a: line(a, Cdn=c, nodes=n))
    for adapter in peer_adapters().values():
        for name, x, make in (("frequency", HERTZ, by_frequency), ("drag", DRAG, by_drag)):
            points = [_moved(adapter, make, u, v) for v in SURGE.values for u in x.values]
            yield {
                "map": name,
                "axes": [x.label, SURGE.label],
                "solver": adapter.name,
                "label": adapter.label,
                "version": adapter.version,
                "counts": {v: sum(point["verdict"] == v for point in points) for v in (*VERDICTS, "no truth")},
                "points": points,
                "segments": SEGMENTS,
                "bound": DYNAMIC_WRONG,
            }


def _moved(adapter, make, x, y) -> dict:
    row, waves = {"x": x, "y": y}, []
    for nodes in (COARSE, NODES):
        system = make(nodes, x, y)
        response = solve_periodic(system, harmonics=HARMONICS, throw=False)
        if not response.success:
            return row | {"verdict": "no truth", "message": response.status.value}
        waves.append(response.fairlead_tension(instants(system.period)))
    exact, spread = waves[1], np.ptp(waves[1])
    if abs(waves[1] - waves[0]).max() / 3 > DYNAMIC_WRONG / 5 * spread:
        return row | {"verdict": "no truth", "message": "two meshes differ"}
    ramped = system.ramped(system.period / 2).motion
    periods = max(PERIODS, math.ceil(SECONDS / system.period))
    answer = ask(adapter, system.scene, ramped, system.period, (SEGMENTS, STEPS), periods)
    if answer.tension is None:
        return row | {"verdict": answer.kind, "message": answer.message[:200]}
    wave = answer.tension
    error = float(abs(wave - exact[:: INSTANTS // wave.size]).max() / spread)
    return row | {"verdict": "wrong" if error > DYNAMIC_WRONG else "right", "error": error}
