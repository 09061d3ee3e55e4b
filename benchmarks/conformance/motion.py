"""Write the motion level of the conformance cases: ``python -m benchmarks.conformance.motion``.

Truth is that of nodes and elements in time, extrapolated from three meshes; its uncertainty the greatest of what the
last mesh moves the extrapolated answer by and of the difference from the second formulation, over the range.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import sys
from importlib.resources import files
from pathlib import Path

import numpy as np

from solvers import ConvergenceError

from ..run import console
from . import independent
from .cases import BILATERAL, BOX, EXACT, WITHOUT, all_cases
from .mistakes import MESH, SENTENCES, add_difference, mistaken_answers
from .responses import Variant, balance_box, balance_nodes, distance, extrapolate, is_network, march, spread

FILE = Path(str(files("reference_data"))) / "conformance" / "motion.json"
VERSION = "2026.11"
DIGITS, FEWER_DIGITS = 6, 5  # of the truth, and of the answers of mistakes
WRONG = 0.05  # of the range: no fatigue or strength check stands that
WIDER = 3.0  # times the right bound, which a wrong answer is at least away
HARMONICS = 5
BOX_NODES = (61, 121, 241)  # with a node at each place of the envelope
FINE_STEPS = 12800  # in a period, against the reference integrator, whose steps have no error worth mentioning
EXACT_PERIOD = 1  # from rest, in which the two are compared: after the ramp
UNITS = {
    "fairlead_tension": "N, magnitude of the force at the fairlead at the instants of the compared period",
    "anchor_tension": "N, magnitude of the force at the anchor",
    "envelope_max": "N, greatest tension in the compared period at 21 equally spaced unstretched arc lengths",
    "envelope_min": "N, least tension there",
    "mean": "N, of the fairlead tension",
    "harmonics": "rows of amplitude in N and phase in rad: a cos(2 pi k t/T + phase), of the fairlead tension",
    "force": "N, (P, 3, instants), of lines and loads on the coupled nodes, z up",
    "tension": "N, (e, 2, instants), magnitude of each element's force at its anchor and fairlead ends",
    "anchor": "m", "fairlead": "m, rad, Hz, s", "length": "m", "w": "N/m, submerged, per unstretched length", "EA": "N",
    "diameter": "m, volume-equivalent", "mass_per_length": "kg/m", "Cdn": "1, on diameter", "Cdb": "1, on diameter",
    "Cdt": "1, on pi times diameter", "Ca": "1, of the displaced water, on the acceleration across the line",
    "damping": "s, beta of T = EA (e + beta de/dt)", "rho": "kg/m^3", "g": "m/s^2", "current": "m/s", "depth": "m",
    "seabed_stiffness": "N/m^2, per unstretched length and penetration", "seabed_damping": "N s/m^2, per length",
    "friction": "1", "slip_speed": "m/s", "body": "m, rad, Hz, s", "time": "s",
}  # fmt: skip


# ---------------------------------------------------------------- truth and its uncertainty
def first_formulation(case) -> tuple[dict, dict]:
    """Return the truth, and the extrapolated answer without the finest mesh."""
    return extrapolate([march(case.inputs, *level) for level in case.levels])


def scales(case, truth) -> dict:
    """Return the size over which each quantity errs: the range of the fairlead tension, of forces the greatest."""
    if is_network(case.inputs):
        return {key: float(np.ptp(value, axis=-1).max()) for key, value in truth.items()}
    return dict.fromkeys(truth, float(np.ptp(truth["fairlead_tension"])))


def second_spread(case, truth, scale) -> dict:
    """Return what the second formulation differs by: quantity -> share of its scale."""
    if case.second == EXACT:
        by_reference = integrate_exact(case)
        steps = Variant(first_period=EXACT_PERIOD, options={"mesh": "uniform", "calibrate": False})
        return spread(by_reference, march(case.inputs, case.exact_cells, FINE_STEPS, steps), scale)
    answers, start = [], None
    for nodes in BOX_NODES if case.second == BOX else [cells for cells, _ in case.levels]:
        if case.second == BOX:
            answer, start = balance_box(case.inputs, nodes, case.harmonics, start)
        else:
            answer = balance_nodes(case.inputs, nodes, case.harmonics)
        answers.append(answer)
    return spread(extrapolate(answers)[0], truth, scale)


def integrate_exact(case, bilateral=False) -> dict:
    """Return the answer of the reference integrator over EXACT_PERIOD."""
    return independent.integrate(case.inputs, case.exact_cells, EXACT_PERIOD, bilateral=bilateral)


def uncertainty_of(case, truth, before, scale) -> dict:
    """Return quantity -> the greatest of what mesh and second formulation leave, over the scale."""
    meshes, second = spread(before, truth, scale), second_spread(case, truth, scale)
    return {key: max(meshes[key], second.get(key, 0.0)) for key in truth}


# ---------------------------------------------------------------- one row of the table
def make_row(case) -> dict:
    """Return one case as the table has it."""
    truth, before = first_formulation(case)
    scale = scales(case, truth)
    uncertainty = uncertainty_of(case, truth, before, scale)
    bound = {}
    for key, u in uncertainty.items():
        right = case.right + 2 * u
        bound[key] = [right, max(WRONG, WIDER * right)]
    base = march(case.inputs, *MESH)
    without = {feature: left_out(case, feature, truth, base) for feature in case.features}
    mistakes = mistaken_answers(case, truth, base)
    if set(BILATERAL) & set(case.features):
        mistakes["compression_allowed"] = without["slack"]
    mistakes = {
        name: answer
        for name, answer in mistakes.items()
        if any(distance(key, truth[key], value) > bound[key][0] * scale[key] for key, value in answer.items())
    }
    if not is_network(case.inputs):
        for key, value in summary(truth["fairlead_tension"]).items():
            truth[key], scale[key] = value, scale["fairlead_tension"]
            uncertainty[key], bound[key] = uncertainty["fairlead_tension"], bound["fairlead_tension"]
    return {
        "id": case.id, "group": case.group, "title": case.title, "features": list(case.features),
        "laws": list(case.laws), "second": case.second, "inputs": case.inputs, "truth": rounded(truth),
        "scale": rounded(scale), "uncertainty": rounded(uncertainty, 2), "bound": rounded(bound, 3),
        "mistakes": rounded(mistakes, FEWER_DIGITS), "without": rounded(without, FEWER_DIGITS),
    }  # fmt: skip


def make_row_or_say_why(case) -> tuple:
    """Return the id of a case and its row, or why there is none."""
    try:
        return case.id, make_row(case)
    except (ConvergenceError, ArithmeticError) as error:
        return case.id, f"{type(error).__name__}: {error}"


def left_out(case, feature, truth, base) -> dict:
    """Return the answer without a feature: quantity -> value."""
    if feature in BILATERAL:
        return add_difference(truth, integrate_exact(case), integrate_exact(case, bilateral=True))
    return add_difference(truth, base, march(WITHOUT[feature](case.inputs), *MESH))


def summary(series) -> dict:
    """Return mean and harmonics of a period (M,), as the judge of answers computes them."""
    terms = np.fft.rfft(series) / len(series)
    rows = [[2 * abs(term), float(np.angle(term))] for term in terms[1 : HARMONICS + 1]]
    return {"mean": float(terms[0].real), "harmonics": rows}


def rounded(value, digits=DIGITS):
    """Return nested numbers with so many significant digits, plain for JSON."""
    if isinstance(value, dict):
        return {key: rounded(one, digits) for key, one in value.items()}
    if isinstance(value, (list, tuple, np.ndarray)):
        return [rounded(one, digits) for one in value]
    number = float(f"{float(value):.{digits - 1}e}")
    return int(number) if number == int(number) and abs(number) < 10**digits else number


# ---------------------------------------------------------------- the file
def write(rows):
    """Write the table with these rows."""
    used = {name for row in rows for name in row["mistakes"]}
    head = {"version": VERSION, "level": "motion", "units": UNITS,
            "mistakes": {name: text for name, text in SENTENCES.items() if name in used}}  # fmt: skip
    body = ",\n".join(json.dumps(row, separators=(",", ":")) for row in rows)
    text = json.dumps(head, indent=1)[:-2] + ',\n "cases": [\n' + body + "\n ]\n}\n"
    FILE.parent.mkdir(exist_ok=True)
    FILE.write_text(text, encoding="utf-8")


def main(argv=None) -> int:
    """Command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.conformance.motion", description=__doc__)
    parser.add_argument("--only", action="append", metavar="ID", help="these cases; the others stay as they are")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    arguments = parser.parse_args(argv)
    known, failed = {}, 0
    if arguments.only and FILE.exists():
        known = {row["id"]: row for row in json.loads(FILE.read_text(encoding="utf-8"))["cases"]}
    wanted = [case for case in all_cases() if not arguments.only or case.id in arguments.only]
    with multiprocessing.get_context("spawn").Pool(arguments.jobs, maxtasksperchild=4) as pool:
        for number, (name, row) in enumerate(pool.imap_unordered(make_row_or_say_why, wanted), start=1):
            failed += isinstance(row, str)
            failure = row if isinstance(row, str) else ""
            print(f"{number} of {len(wanted)}: {name}", failure, file=sys.stderr, flush=True)
            if not isinstance(row, str):
                known[name] = row
                write([known[case.id] for case in all_cases() if case.id in known])
    return int(failed > 0)


if __name__ == "__main__":
    console.run(main)
