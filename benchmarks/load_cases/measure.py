"""What tables of load cases cost and err by, beside MoorDyn on the same cases: one OC3 line, three lines on a seabed.

Seconds are CPU seconds of one process, the least of some runs, so that a busy machine says little against them. The
error is that of the standard deviation against a run with a quarter of the step and four times the cells. MoorDyn is
refined until its own error, against the same run, is no larger than ours, or to the last of its settings; its hour is
extrapolated from a long and a short run, which leaves its start out of what is multiplied.
"""

from __future__ import annotations

import importlib
import json
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np

from solvers.common.load_case import LoadCase
from solvers.common.motions.sea_state import ResponseOperators, SeaState
from solvers.common.motions.spectrum import Spectrum
from solvers.io import Scene, load_network
from solvers.load_cases import solve_load_cases
from solvers.load_cases.integration import integrate_case
from solvers.load_cases.results import QUANTITIES
from solvers.load_cases.solve import RowSettings, solve_row
from solvers.load_cases.statistics import damage_equivalent_load, find_peaks, fit_weibull
from solvers.numerics.threads import one_blas_thread
from verification.exact.gaussian import dirlik_load, gaussian_series, narrow_band_load, rayleigh_extreme

from ..run import console, results

SCENES = console.ROOT / "reference_data" / "scenes"
HOUR, RAMP = 3600.0, 120.0  # s
TOLERANCE = 0.02  # promised of maximum, standard deviation and damage
COMPARED = 600.0  # s of a case that MoorDyn runs, for an hour takes it minutes; its cost is proportional
REPEATS = 3  # of each timing of ours
SHORT = 60.0  # s of the second run from which MoorDyn's hour is extrapolated
MOORDYN = ((10, 0.05), (20, 0.05), (20, 0.025), (20, 0.0125), (40, 0.025), (40, 0.0125))
"""Cells and coupling steps in s, by rising cost: a coupling step moves the fairlead with one velocity, which excites
short waves of fine meshes; MoorDyn's own steps are shorter."""
COMPARED_CASES = 1, 9, 15  # of the sampled ones, that MoorDyn solves
BAND = 0.098, 0.102, 1080.0  # Hz, Hz, peaks of an extreme: Gaussian series with Rayleigh's peaks
BROAD = 0.02, 0.2  # Hz
SERIES = 30  # of each band
EXPONENT = 3.0
STEP = 0.25  # s, of these series
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
    table = solve_load_cases(system, cases, tolerance=TOLERANCE, executor=one_thread)
    finer = solve_load_cases(system, cases, dt=table.dt / 4, cells=4 * table.cells, executor=one_thread)
    errors = {name: abs(table.values(name) / finer.values(name) - 1).max(axis=1) for name in QUANTITIES}
    within = np.max(list(errors.values()), axis=0) <= TOLERANCE
    return {"dt": table.dt, "cells": table.cells, "promised": table.accuracy.promised, "errors": errors,
            "measured": table.accuracy.measured, "within": int(within.sum()), "cases": len(cases)}  # fmt: skip


def one_thread() -> ThreadPoolExecutor:
    """Return an executor of one thread, so that nothing of this process runs beside what is timed."""
    return ThreadPoolExecutor(1)


def cpu_seconds(work, repeats: int = REPEATS):
    """Return the least CPU seconds of some runs, and what the last returned."""
    seconds = []
    for _ in range(repeats):
        began = time.process_time()
        result = work()
        seconds.append(time.process_time() - began)
    return min(seconds), result


def seconds_a_case(system, cases, dt, cells) -> list[float]:
    """Return the CPU seconds of each case, its statistics included."""
    integrate_case(system, LoadCase("warm", cases[0].motion, 5.0, 5.0), dt=dt, cells=cells)
    row = RowSettings(dt, cells)
    return [cpu_seconds(lambda case=case: solve_row(system, 0, case, row))[0] for case in cases]


def beside_moordyn(system, cases, dt, cells) -> dict:
    """Return rows of code, setting, CPU seconds of an hour and largest error of a standard deviation over some cases.

    One setting is for all of them, as of a table: MoorDyn's is the first that errs no more than ours, or the last.
    ratio: of the hours.
    """
    truths = [_deviations(integrate_case(system, case, dt=dt / 4, cells=4 * cells)) for case in cases]
    hours = [replace(case, duration=HOUR) for case in cases]
    own = [cpu_seconds(lambda case=case: integrate_case(system, case, dt=dt, cells=cells))[0] for case in hours]
    errors = [_error(_deviations(integrate_case(system, case, dt=dt, cells=cells)), truth)
              for case, truth in zip(cases, truths, strict=True)]  # fmt: skip
    rows = [{"code": "this project", "cells": cells, "dt": dt, "hour": float(np.mean(own)), "error": max(errors)}]
    for count, coupling in MOORDYN:
        short = replace(cases[0], duration=SHORT)
        few = cpu_seconds(lambda case=short, setting=(count, coupling): _moordyn(system, case, *setting), 1)[0]
        times, error = [], 0.0
        for case, truth in zip(cases, truths, strict=True):
            seconds, answer = cpu_seconds(lambda case=case, of=(count, coupling): _moordyn(system, case, *of), 1)
            times.append(few + (seconds - few) / (case.duration - SHORT) * (HOUR - SHORT))
            error = max(error, _error(answer, truth))
            if error > rows[0]["error"]:
                break
        rows.append({"code": "MoorDyn", "cells": count, "dt": coupling, "hour": float(np.mean(times)), "error": error})
        if error <= rows[0]["error"]:
            break
    return {"cases": [case.name for case in cases], "rows": rows, "ratio": rows[-1]["hour"] / rows[0]["hour"],
            "reached": rows[-1]["error"] <= rows[0]["error"]}  # fmt: skip


def _deviations(series) -> np.ndarray:
    return np.array([line.fairlead.std() for line in series.lines])


def _error(deviations, truth) -> float:
    return float(abs(deviations / truth - 1).max())


def _has_moordyn() -> bool:
    try:
        importlib.import_module("benchmarks.peers.moordyn")
    except ImportError:
        return False
    return True


def _moordyn(system, case, cells, coupling):
    """Return the standard deviation of the tension of each line after the ramp, (lines,), N."""
    from ..peers.moordyn import MoorDyn

    motion = case.motion.motion().ramped(case.ramp)
    times = coupling * np.arange(round(case.whole_duration / coupling) + 1)
    if hasattr(system, "elements"):
        forces = MoorDyn().moving_network(system, motion, times, cells)
    else:
        fairlead = np.array(system.fairlead) + motion.displacement([system.fairlead], times)[:, 0].T
        return MoorDyn().cable(system, times, fairlead, cells)[None, times > case.ramp].std(axis=1)
    return np.linalg.norm(forces, axis=1)[:, times > case.ramp].std(axis=1)


def check_theory() -> list[dict]:
    """Return what Gaussian series of two bands give beside theory: Rayleigh's extremes, closed form and Dirlik's loads.

    sampling: the standard error of the average over the series.
    """
    lowest, highest, peaks = BAND
    duration = peaks / (lowest + highest) * 2
    narrow = [gaussian_series(seed, lowest, highest, duration, STEP) for seed in range(SERIES)]
    broad = [gaussian_series(seed, *BROAD, HOUR, STEP) for seed in range(SERIES)]
    rows = (
        ("extreme of a narrow band, Rayleigh", rayleigh_extreme(peaks),
         [fit_weibull(find_peaks(x)).extreme(peaks)[0] / x.std() for x in narrow]),
        ("damage of a narrow band, closed form", narrow_band_load((lowest + highest) / 2, EXPONENT),
         [damage_equivalent_load(x, duration, EXPONENT) / x.std() for x in narrow]),
        ("damage of a broad band, Dirlik", dirlik_load(*BROAD, EXPONENT),
         [damage_equivalent_load(x, HOUR, EXPONENT) for x in broad]),
    )  # fmt: skip
    return [{"quantity": name, "theory": theory, "measured": np.mean(values),
             "sampling": np.std(values, ddof=1) / SERIES**0.5} for name, theory, values in rows]  # fmt: skip


def measure_errors(sampled: int) -> dict:
    """Return the errors of each system, "checked", and what theory says of the statistics: no timing."""
    checked = {name: check_errors(system, sea_states(sampled, COMPARED)) for name, system in systems().items()}
    return {"checked": checked, "theory": check_theory()}


def measure_times(checked: dict, timed: int) -> dict:
    """Return for each system its errors, CPU seconds of an hour, the total of all cases, and MoorDyn's."""
    measured = {}
    for name, system in systems().items():
        errors = checked[name]
        setting = errors["dt"], errors["cells"]
        hours = seconds_a_case(system, sea_states(timed), *setting)
        cases = sea_states(max(COMPARED_CASES) + 1, COMPARED)
        moordyn = beside_moordyn(system, [cases[i] for i in COMPARED_CASES], *setting) if _has_moordyn() else None
        measured[name] = errors | {
            "seconds_an_hour": hours, "total": CASES[name] * float(np.mean(hours)), "count": CASES[name],
            "beside": moordyn}  # fmt: skip
    return {"tolerance": TOLERANCE, "systems": measured, "exponent": EXPONENT, "duration": COMPARED}


def describe(measured: dict) -> str:
    """Return the figures as sentences."""
    text = []
    for name, row in measured.get("systems", {}).items():
        errors = ", ".join(f"{key} {100 * max(values):.2g} %" for key, values in row["errors"].items())
        text.append(
            f"{name}: dt {row['dt']:.3g} s, {row['cells']} cells; promised {100 * row['promised']:.2g} %, measured "
            f"{100 * row['measured']:.2g} %; within in {row['within']} of {row['cases']}; largest errors: {errors}\n"
            f"  {np.mean(row['seconds_an_hour']):.3g} CPU seconds an hour, {row['count']} hours in "
            f"{row['total'] / 2:.4g} s on two cores"
        )
        if beside := row["beside"]:
            at = "" if beside["reached"] else " (at a larger error)"
            text.append(f"  MoorDyn takes {beside['ratio']:.3g} times as long{at}")
            text += [
                f"    {r['code']}, {r['cells']} cells, {r['dt']:.3g} s: {r['hour']:.3g} s, error {r['error']:.2g}"
                for r in beside["rows"]
            ]
    for row in measured.get("theory", ()):
        text.append(f"{row['quantity']}: {row['measured']:.4g} +- {row['sampling']:.2g} for {row['theory']:.4g}")
    return "\n".join(text)


def main(argv=None) -> int:
    """Command line."""
    parser = console.parser("load_cases.measure", __doc__)
    parser.add_argument("--sampled", type=int, default=20, help="cases whose errors are measured")
    parser.add_argument("--timed", type=int, default=3, help="hours that are timed")
    parser.add_argument("--kind", choices=("timed", "untimed"), help="only what is a timing, with the errors that the "
                        "other kind has left in the folder, or only the rest, in a file of its own")  # fmt: skip
    arguments = parser.parse_args(argv)
    untimed, kept = arguments.out / "load_case_costs_untimed.json", {}
    if arguments.kind == "timed" and untimed.exists():
        kept = json.loads(untimed.read_text(encoding="utf-8"))
    with one_blas_thread():
        checked = kept or results.plain(measure_errors(arguments.sampled))
        if arguments.kind == "untimed":
            results.write(untimed, checked)
            print(describe(checked))
            return 0
        measured = measure_times(checked["checked"], arguments.timed)
    results.write(arguments.out / "load_case_costs.json", measured | {"theory": checked["theory"]})
    print(describe(measured))
    return 0


if __name__ == "__main__":
    console.run(main)
