"""What tables of load cases cost and err by, beside MoorDyn on the same cases: one OC3 line, three lines on a seabed.

Seconds are CPU seconds of one process, the least of some runs in turn, so that a busy machine says little against them.
The error is that of the standard deviation against a run with a quarter of the step and four times the cells. MoorDyn
is refined until its own error, against the same run, is no larger than ours, or to the last of its settings.
"""

from __future__ import annotations

import time

import numpy as np

from solvers.common.load_case import LoadCase
from solvers.common.sea_state import ResponseOperators, SeaState
from solvers.common.spectrum import Spectrum
from solvers.io import Scene, load_network
from solvers.load_cases import solve_load_cases
from solvers.load_cases.integration import integrate_case
from solvers.load_cases.results import QUANTITIES
from solvers.numerics.threads import one_blas_thread

from ..run import console, results

SCENES = console.ROOT / "reference_data" / "scenes"
HOUR, RAMP = 3600.0, 120.0  # s
TOLERANCE = 0.02  # promised of maximum, standard deviation and damage
COMPARED = 600.0  # s of a case that MoorDyn runs, for an hour takes it minutes; its cost is proportional
MOORDYN = ((10, 0.1), (10, 0.05), (10, 0.025), (20, 0.1), (20, 0.05), (20, 0.025), (40, 0.05), (40, 0.025), (80, 0.025))
"""Cells and coupling steps in s, by rising cost: a coupling step moves the fairlead with one velocity, which excites
short waves of fine meshes; MoorDyn's own steps are shorter."""
CASES = {"line": 1000, "three lines": 100}
"""How many one-hour sea states the totals are for."""


def spar_operators() -> ResponseOperators:
    """Return operators of the shape of a spar's: following the waves when they are long, still when they are short."""
    f = np.linspace(0.01, 0.6, 60)
    six = np.zeros((1, f.size, 6), dtype=complex)
    six[0, :, 0] = -1j * np.exp(-((f / 0.1) ** 2))
    six[0, :, 2] = 0.5 * np.exp(-((f / 0.08) ** 2))
    six[0, :, 4] = 0.006j * np.exp(-((f / 0.1) ** 2))
    return ResponseOperators(f, six)


def sea_states(count: int, duration: float = HOUR) -> list[LoadCase]:
    """Return cases of a scatter diagram: significant heights of 1 to 7 m, steepnesses of 1/45 to 1/15."""
    generator, operators = np.random.default_rng(20240601), spar_operators()
    cases = []
    for i in range(count):
        Hs, steepness = generator.uniform(1.0, 7.0), generator.uniform(1 / 45, 1 / 15)
        Tp = float(np.clip((2 * np.pi * Hs / (9.81 * steepness)) ** 0.5, 7.0, 15.0))
        sea = SeaState(Spectrum.jonswap(float(Hs), Tp), operators, i, RAMP + HOUR)
        cases.append(LoadCase(f"Hs {Hs:.2f} m, Tp {Tp:.1f} s, seed {i}", sea, duration, RAMP))
    return cases


def systems() -> dict:
    """Return the OC3 line in deep water and the three OC3 lines over the seabed."""
    scene = Scene.load(SCENES / "dynamics" / "hb_case_1.toml")
    return {"line": scene, "three lines": load_network(SCENES / "networks" / "oc3_moving.toml")}


def check_errors(system, cases) -> dict:
    """Return the setting chosen for the tolerance and the errors of each case against a run four times finer."""
    table = solve_load_cases(system, cases, tolerance=TOLERANCE)
    finer = solve_load_cases(system, cases, dt=table.dt / 4, cells=4 * table.cells)
    errors = {name: abs(table.values(name) / finer.values(name) - 1).max(axis=1) for name in QUANTITIES}
    within = np.max(list(errors.values()), axis=0) <= TOLERANCE
    return {"dt": table.dt, "cells": table.cells, "promised": table.accuracy.promised, "errors": errors,
            "measured": table.accuracy.measured, "within": int(within.sum()), "cases": len(cases)}  # fmt: skip


def seconds_a_case(system, cases, dt, cells) -> list[float]:
    """Return the CPU seconds of each case."""
    integrate_case(system, LoadCase("warm", cases[0].motion, 5.0, 5.0), dt=dt, cells=cells)
    seconds = []
    for case in cases:
        began = time.process_time()
        solve_load_cases(system, [case], dt=dt, cells=cells, executor=None)
        seconds.append(time.process_time() - began)
    return seconds


def beside_moordyn(system, case, dt, cells) -> list[dict]:
    """Return rows of code, cells, CPU seconds and error of the standard deviation (largest of the lines)."""
    fine = integrate_case(system, case, dt=dt / 4, cells=4 * cells)
    truth = np.array([line.fairlead.std() for line in fine.lines])
    began = time.process_time()
    ours = integrate_case(system, case, dt=dt, cells=cells)
    rows = [{"code": "this project", "cells": cells, "seconds": time.process_time() - began,
             "error": _error([line.fairlead for line in ours.lines], truth)}]  # fmt: skip
    for count, coupling in MOORDYN:
        began = time.process_time()
        tensions = _moordyn(system, case, count, coupling)
        rows.append({"code": "MoorDyn", "cells": count, "coupling": coupling, "seconds": time.process_time() - began,
                     "error": _error(tensions, truth)})  # fmt: skip
        if rows[-1]["error"] <= rows[0]["error"]:
            break
    return rows


def _error(tensions, truth) -> float:
    return float(max(abs(np.std(tension) / value - 1) for tension, value in zip(tensions, truth, strict=True)))


def _moordyn(system, case, cells, coupling):
    """Return the tensions after the ramp, (lines, K), N."""
    from ..peers.moordyn import MoorDyn

    motion = case.motion.motion().ramped(case.ramp)
    times = coupling * np.arange(round(case.whole_duration / coupling) + 1)
    if hasattr(system, "elements"):
        forces = MoorDyn().moving_network(system, motion, times, cells)
    else:
        fairlead = np.array(system.fairlead) + motion.displacement([system.fairlead], times)[:, 0].T
        return MoorDyn().cable(system, times, fairlead, cells)[None, times > case.ramp]
    return np.linalg.norm(forces, axis=1)[:, times > case.ramp]


def measure(sampled: int, timed: int) -> dict:
    """Return for each system errors, CPU seconds of an hour, the total of all cases, and MoorDyn's."""
    found = {}
    for name, system in systems().items():
        errors = check_errors(system, sea_states(sampled, COMPARED))
        setting = errors["dt"], errors["cells"]
        hours = seconds_a_case(system, sea_states(timed), *setting)
        rows = beside_moordyn(system, sea_states(3, COMPARED)[1], *setting)
        equal = next((row for row in rows[1:] if row["error"] <= rows[0]["error"]), rows[-1])
        found[name] = errors | {
            "seconds_an_hour": hours, "total": CASES[name] * float(np.mean(hours)), "count": CASES[name],
            "beside": rows, "ratio": equal["seconds"] / rows[0]["seconds"],
            "reached": equal["error"] <= rows[0]["error"]}  # fmt: skip
    return found


def describe(found: dict) -> str:
    """Return the figures as sentences."""
    text = []
    for name, row in found.items():
        errors = ", ".join(f"{key} {100 * max(values):.2g} %" for key, values in row["errors"].items())
        text.append(
            f"{name}: dt {row['dt']:g} s, {row['cells']} cells; promised {100 * row['promised']:.2g} %, measured "
            f"{100 * row['measured']:.2g} %; within in {row['within']} of {row['cases']}; largest errors: {errors}\n"
            f"  {np.mean(row['seconds_an_hour']):.3g} CPU seconds an hour, {row['count']} hours in "
            f"{row['total'] / 2:.4g} s on two cores; MoorDyn {row['ratio']:.3g} times that"
            f"{'' if row['reached'] else ' (at a larger error)'}"
        )
        text += [
            f"  {r['code']}, {r['cells']} cells: {r['seconds']:.3g} s, error {r['error']:.2g}" for r in row["beside"]
        ]
    return "\n".join(text)


def main(argv=None) -> int:
    """Command line."""
    parser = console.parser("load_cases.measure", __doc__)
    parser.add_argument("--sampled", type=int, default=20, help="cases whose errors are measured")
    parser.add_argument("--timed", type=int, default=4, help="hours that are timed")
    arguments = parser.parse_args(argv)
    with one_blas_thread():
        found = measure(arguments.sampled, arguments.timed)
    results.write(arguments.out / "load_cases.json", found)
    print(describe(found))
    return 0


if __name__ == "__main__":
    console.run(main)
