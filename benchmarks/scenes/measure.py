"""One scene file: forces, profile, stiffness, error against 50 digits, cost of each setting: scene_<stem>.json."""

from __future__ import annotations

import math
import sys
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np

from solvers import ConvergenceError, InputError, Scene, solve_span
from solvers.common.motions.sea_state import SeaMotion
from verification.cases.spans import SpanCase
from verification.reference import SpanTruth, force_error

from ..catenary import work_precision
from ..run import console, harness, results
from ..run import oracle_cache as truth
from . import dynamics as scene_dynamics
from .exports import network_of, write_exports
from .margin import margins
from .network_files import check_weights

PROFILE_POINTS = 201
BAD_SCENE = 2  # exit status

SENSITIVE_TO = ("L", "EA", "w")
STEP = 1e-5
"""Relative step of the differences over 1 + condition: truncation STEP^2, rounding eps (1 + condition)/STEP."""

STRAIN_LIMIT = 0.05
ILL_CONDITIONED = 1e6
STRONG = 100.0  # relative change of the tension over that of an input: 1 % of length doubles the tension
NEAR_LIFT = 0.02  # of L on the seabed


def line(span, scene: Scene, known: truth.TruthCache, timed: bool = True) -> dict:
    """The part of the file for one friction coefficient; without the ladder where nothing is timed."""
    label = f"friction {span.friction:g}"
    case = SpanCase(label, "scene", **asdict(span))
    state, exact = solve_span(span), known.get_or_compute(case)
    s = np.linspace(0, span.L, PROFILE_POINTS)
    profile = dict(zip(("s", "x", "z", "tension"), (s, *state.profile(s)), strict=True))
    sensitivity = {name: _sensitivity(span, name, exact.condition) for name in SENSITIVE_TO}
    return {
        "label": label,
        "inputs": case.inputs(),
        "regime": state.regime.value,
        "H": state.H,
        "V": state.V,
        "tension": state.tension,
        "angle": math.atan2(state.V, state.H),
        "H_anchor": state.H_anchor,
        "V_anchor": state.V_anchor,
        "grounded_length": state.grounded_length,
        "stiffness": state.stiffness,
        "profile": profile,
        "condition": exact.condition,
        "limit": exact.limit,
        "exact": {"H": exact.H, "V": exact.V},
        "error": force_error(state.H, state.V, exact, case),
        "ladder": _ladder(case, exact) if timed else [],
        "sensitivity": sensitivity,
        "warnings": list(warnings(span, state, exact, sensitivity, scene.tolerance)),
    }


def _ladder(case: SpanCase, exact: SpanTruth) -> list[dict]:
    """Every installed solver at every tolerance, and as it comes (tolerance None): error and seconds."""
    rows = []
    for solver in harness.solvers().values():
        default = harness.measure(solver, case, exact)
        rows.append({"solver": solver.name, "label": solver.label, "tolerance": None} | default)
        if default["verdict"] != "unsupported" and solver.tolerances:
            rows += work_precision.sweep(solver, case, exact)
    return [{key: row.get(key) for key in _LADDER} for row in rows]


_LADDER = ("solver", "label", "tolerance", "error", "seconds", "verdict", "message")


def _sensitivity(span, name: str, condition: float) -> float | None:
    """|p dT/dp|/T at the fairlead by central differences; None where T or p is zero."""
    value = getattr(span, name)
    h = STEP / (1 + condition)
    low, high = value * (1 - h), value * (1 + h)
    tension = solve_span(span).tension
    if tension == 0 or high == low:
        return None
    change = solve_span(replace(span, **{name: high})).tension - solve_span(replace(span, **{name: low})).tension
    return abs(value * change / (high - low)) / tension


def warnings(span, state, exact: SpanTruth, sensitivity: dict, tolerance: float):
    """Sentences on what the owner of this line should know; nothing for an ordinary line."""
    yield from _slack(span, state)
    yield from _anchor(span, state)
    strain = state.tension / span.EA
    if strain > STRAIN_LIMIT:
        yield (
            f"The line is stretched by {100 * strain:.3g} % at the fairlead: a constant EA is doubtful beyond "
            f"{100 * STRAIN_LIMIT:g} %."
        )
    yield from _sensitive(exact, sensitivity, tolerance)


def _slack(span, state):
    if state.H == 0 and span.x > 0 and state.tension > 0:
        yield "The line is slack: it hangs straight down and gives no horizontal restoring force at this position."
    if state.tension == 0:
        yield "The line carries no tension at the fairlead: it holds nothing at this position."


def _anchor(span, state):
    if not span.seabed or span.clearance > 0:
        return
    if state.V_anchor > 0:
        angle = math.degrees(math.atan2(state.V_anchor, state.H_anchor))
        yield (
            f"The anchor is pulled upwards with {state.V_anchor:.4g} N, {angle:.3g} degrees from the seabed: "
            "a drag anchor would lift, this line needs one that takes uplift."
        )
    elif state.H > 0 and state.H_anchor == 0 and span.friction > 0:
        idle = state.grounded_length - state.H / (span.friction * span.w)
        yield f"Friction takes all the tension: the first {idle:.4g} m from the anchor carry none."
    elif 0 < state.grounded_length < NEAR_LIFT * span.L:
        yield (
            f"Only {state.grounded_length:.3g} m of the line lie on the seabed: a small offset away from the anchor "
            "would lift all of it and pull the anchor upwards."
        )


def _sensitive(exact: SpanTruth, sensitivity: dict, tolerance: float):
    strong = sensitivity["L"]
    if strong is not None and strong > STRONG:
        yield (
            f"The line is nearly taut: 0.01 % more or less length changes the fairlead tension by about "
            f"{0.01 * strong:.3g} %."
        )
    if exact.condition > ILL_CONDITIONED:
        yield (
            f"The forces depend on the inputs {exact.condition:.2g} times over: a relative error of "
            f"{tolerance:g} in the tension asks for inputs known to {tolerance / exact.condition:.1g}."
        )
    if exact.limit > tolerance:
        yield (
            f"The tolerance {tolerance:g} cannot be reached in double precision: rounding the inputs alone moves the "
            f"tension by about {exact.limit:.2g}."
        )


def _is_stepped(scene: Scene) -> bool:
    """Return whether the line moves in a period; a sea is a load case (benchmarks.load_cases.table)."""
    return scene.motion is not None and not isinstance(scene.motion, SeaMotion)


def _work(scene: Scene, spans, known: truth.TruthCache, timed: bool):
    """Yield the part of the file for each friction coefficient, then the steps of the moving line, its part last."""
    for span in spans:
        yield line(span, scene, known, timed)
    if _is_stepped(scene):
        yield from scene_dynamics.study(scene)


def report(path: Path, scene: Scene, lines: list[dict], dynamics: dict | None) -> dict:
    """The file; ``dynamics`` is absent from that of a line at rest."""
    about = {"file": path.name, "name": scene.name, "description": scene.description, "tolerance": scene.tolerance}
    about |= {"suspected": scene.warnings, "margins": _margins(scene, lines, dynamics)}
    return about | {"lines": lines} | ({"dynamics": dynamics} if dynamics else {})


def _margins(scene: Scene, lines: list[dict], dynamics: dict | None) -> list[dict]:
    """Return the margin of the line: moving where its motion was solved, else at rest with each friction."""
    if dynamics and "motion" in dynamics:
        rows = dynamics["motion"]
    else:
        rows = [{"line": row["label"], "mean": row["tension"], "max": row["tension"]} for row in lines]
    return margins(rows, [scene.cable.breaking_load] * len(rows), scene.safety_factors)


def main(argv=None) -> int:
    """Command line."""
    parser = console.parser("scene", __doc__)
    parser.add_argument("file", type=Path, metavar="FILE.toml", help="scene file, see solvers.Scene")
    parser.add_argument("--name", help="of the result, where another file has the same stem")
    parser.add_argument("--forces", action="store_true", help="no ladder of settings: nothing is timed")
    arguments = parser.parse_args(argv)
    try:
        scene = Scene.load(arguments.file)
        check_weights(scene, [scene.cable], arguments.file)
        spans, known = scene.spans(), truth.TruthCache(arguments.out)
        total = len(spans) + (scene_dynamics.steps(scene) if _is_stepped(scene) else 0)
        done = list(console.progress(_work(scene, spans, known, not arguments.forces), total, arguments.file.stem))
        lines, dynamics = done[: len(spans)], done[-1] if _is_stepped(scene) else None
    except (InputError, ConvergenceError) as error:
        print(error, file=sys.stderr)
        return BAD_SCENE
    name, whole = arguments.name or arguments.file.stem, report(arguments.file, scene, lines, dynamics)
    if not arguments.forces:
        whole["exports"] = write_exports(network_of(scene), arguments.out, f"scene_{name}")
    results.write(arguments.out / f"scene_{name}.json", whole)
    for line in lines:
        print(f"{line['label']}: H {line['H']:.7g} N, V {line['V']:.7g} N, error {line['error']:.1e}")
    return 0


if __name__ == "__main__":
    console.run(main)
