"""Moving lines of nodes and elements: error against run time, growth, damping, validation and seabeds: mooring.json."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from solvers import cable_system, mooring_system, solve_periodic, solve_time_domain
from solvers.numerics.threads import one_blas_thread
from verification.registry import instants, last_period_tension

from ..cable.cases import Reference, rms
from ..cable.measure import add_parts, chosen, exponent, measured
from ..cable.work_precision import least_seconds
from ..run import console, results
from ..run.harness import clock
from . import agreement as agreement_of
from . import cases, seabed, validation
from . import work_precision as work_of

CASE = "case_1"
CELLS, DT, PERIODS = 50, 0.1, 3
TURNS, QUICK_TURNS = 7, 3
GROWTH, QUICK_GROWTH = (30, 100, 300, 1000, 3000, 10000), (100, 300, 1000)
FITTED_FROM = 300  # cells: below, what a step costs once weighs more
DRAGS, QUICK_DRAGS = (1.6, 0.4, 0.1, 0.03, 0.01), (1.6, 0.1)
LEVEL = 1e-3  # rms error over the range that both methods shall reach
MOST_PERIODS = 60
STEPPED = ((28, 100), (56, 200), (80, 400), (112, 400))  # (cells, steps in a period) of the finer of two runs
BALANCED = ((14, 9), (20, 12), (28, 15), (40, 15), (56, 15), (80, 20))  # (cells, harmonics), extrapolated
REFERENCE = (100, 24)  # (cells, harmonics) of extrapolated harmonic balance


def references(quick: bool, folder: Path):
    """How far this core on a fine mesh is from another discretisation; the timings find the references made.

    refinements: case -> observed order and numerical uncertainty of its reference.
    """
    tensions, difference, refinements = cases.ConvergedTensions(folder, quick), {}, {}
    for name in work_of.QUICK_CASES if quick else cases.CASES:
        reference = tensions.get_or_compute(name)
        refinements[name] = reference.refinements
        if name in cases.PAPER:
            difference[name] = reference.errors(cases.finest(name, cases.QUICK_REFERENCE[1:]).tension)["rms"]
        yield None
    titles = {name: cases.scene(name).name for name in refinements if name in cases.SEABED}
    yield {"difference": difference, "refinements": refinements, "titles": titles}


def work(quick: bool, folder: Path):
    """Error against run time of every method and setting, and ratios at equal error."""
    references, points, uncertainty = cases.ConvergedTensions(folder, quick), [], {}
    for name in work_of.QUICK_CASES if quick else cases.CASES:
        reference = references.get_or_compute(name)
        uncertainty[name] = reference.uncertainty
        for point in work_of.points(name, reference, quick):
            points += [] if point is None else [point]
            yield None
    others = dict.fromkeys(p["method"] for p in points if p["method"] not in work_of.OWN)
    titles = {name: cases.scene(name).name for name in uncertainty if name in cases.SEABED}
    yield {"points": points, "uncertainty": uncertainty, "titles": titles, "wanted": work_of.WANTED,
           "ratios": [row for method in others for row in work_of.ratios(points, method)]}  # fmt: skip


def three_periods(quick: bool, folder: Path):
    """Three periods of case 1 at 50 cells, dt = 0.1 s: this core and the box scheme, turn and turn about."""
    systems = {"nodes and elements": mooring_system(cases.scene(CASE), CELLS),
               "box scheme": cable_system(cases.scene(CASE), CELLS + 1)}  # fmt: skip
    for system in systems.values():
        system.rest_state()
    calls = {name: lambda system=system: last_period_tension(solve_time_domain(system, dt=DT, periods=PERIODS))
             for name, system in systems.items()}  # fmt: skip
    waves = {name: call() for name, call in calls.items()}
    seconds = {name: [] for name in calls}
    for _ in range(QUICK_TURNS if quick else TURNS):
        for name, call in calls.items():
            seconds[name].append(clock(call, 1))
        yield None
    rows = np.array(list(seconds.values()))
    spread = float(np.ptp(waves["box scheme"]))
    yield {"cells": CELLS, "dt": DT, "seconds": seconds, "ratio": float(np.median(rows[1] / rows[0])),
           "difference": rms(np.subtract(*waves.values())) / spread}  # fmt: skip


def growth(quick: bool, folder: Path):
    """Seconds of one period of case 1 by cells, and the fitted exponent."""
    rows = []
    for cells in QUICK_GROWTH if quick else GROWTH:
        system = mooring_system(cases.scene(CASE), cells)
        system.rest_state()
        seconds, history = least_seconds(lambda system=system: solve_time_domain(system, dt=DT, periods=1))
        rows.append({"cells": cells, "seconds": seconds, "iterations": history.iterations})
        yield None
    yield {"rows": rows, "dt": DT, "fitted_from": FITTED_FROM, "exponent": exponent(rows, "cells", FITTED_FROM)}


def damping(quick: bool, folder: Path):
    """Time to an error of LEVEL by drag coefficient: in time, with as many periods as that takes, and harmonic balance.

    Both extrapolated from two meshes, at the first of their settings that comes to it. The reference is harmonic
    balance on a finer mesh; periods: how many the transient takes.
    """
    rows = []
    with one_blas_thread():
        for drag in QUICK_DRAGS if quick else DRAGS:
            rows.append(_at_drag(drag))
            yield None
    yield {"rows": rows, "level": LEVEL, "most_periods": MOST_PERIODS}


def _at_drag(drag) -> dict:
    case = cases.scene(CASE)
    case = replace(case, cable=replace(case.cable, Cdn=drag, Cdb=drag))
    cells, harmonics = REFERENCE
    fine = solve_periodic(mooring_system(case, cells), harmonics=harmonics, deferred_correction=True, throw=False)
    row = {"drag": drag, "status": fine.status.name, "in_time": None, "balance": None}
    if not fine.success:
        return row
    known = Reference(fine.system.period, last_period_tension(fine), 0.0)
    return row | {"in_time": _time_in_time(case, known), "balance": _time_of_balance(case, known)}


def _time_in_time(case, known) -> dict | None:
    """Return setting, periods and seconds of the first histories that come to LEVEL; None where none do."""
    for cells, steps in STEPPED:
        fine = mooring_system(case, cells)
        systems = cases.every_second_node(fine), fine
        fine.rest_state()
        rough, better = (_by_period(_history(system, k * steps // 2, MOST_PERIODS)) for k, system in
                         enumerate(systems, start=1))  # fmt: skip
        waves = better + (better - rough) / 3
        periods = cases.least_period_count(waves, LEVEL, known)
        if periods is not None and periods < MOST_PERIODS:
            run = lambda systems=systems, steps=steps, periods=periods: [
                last_period_tension(_history(system, k * steps // 2, periods)) for k, system in enumerate(systems, 1)
            ]
            error = known.errors(waves[periods - 1])["rms"]
            return {"cells": cells, "steps": steps, "periods": periods, "seconds": least_seconds(run)[0],
                    "error": error}  # fmt: skip
    return None


def _history(system, steps, periods):
    return solve_time_domain(system, dt=system.period / steps, periods=periods)


def _by_period(history) -> np.ndarray:
    """Return the fairlead tension of each period, (P, INSTANTS), N."""
    period, count = history.system.period, round(history.time[-1] / history.system.period)
    return np.array([history.fairlead_tension(k * period + instants(period)) for k in range(count)])


def _time_of_balance(case, known) -> dict | None:
    """Return seconds of the first setting of harmonic balance that comes to LEVEL, None where none does."""
    for cells, harmonics in BALANCED:
        system = mooring_system(case, cells)
        system.rest_state()
        run = lambda system=system, harmonics=harmonics: solve_periodic(
            system, harmonics=harmonics, deferred_correction=True, throw=False
        )
        response = run()
        if response.success and (error := known.errors(last_period_tension(response))["rms"]) <= LEVEL:
            seconds, _ = least_seconds(lambda run=run: last_period_tension(run()))
            return {"cells": cells, "harmonics": harmonics, "seconds": seconds, "error": error}
    return None


def laboratory(quick: bool, folder: Path):
    """Measured and computed maxima of the laboratory chain."""
    yield from validation.laboratory(quick)


def orcaflex(quick: bool, folder: Path):
    """Histories of OrcaFlex and of this core."""
    yield from validation.orcaflex(quick)


def seabeds(quick: bool, folder: Path):
    """Lines over a seabed in everyday motions, and counts of them."""
    for value in seabed.seabed(quick):
        yield value and value | {"summary": seabed.summarise(value["rows"])}


def agreement(quick: bool, folder: Path):
    """Harmonic balance, time integration and MoorDyn over a seabed, on one mesh each."""
    yield from agreement_of.agreement(quick)


PARTS = {
    "references": references,
    "work": work,
    "three_periods": three_periods,
    "growth": growth,
    "damping": damping,
    "laboratory": laboratory,
    "orcaflex": orcaflex,
    "seabeds": seabeds,
    "agreement": agreement,
}
TIMED = ("work", "three_periods", "growth", "damping")


def main(argv=None) -> int:
    """Command line."""
    parser = console.parser("mooring", __doc__)
    add_parts(parser, PARTS)
    arguments = parser.parse_args(argv)
    names, output = chosen(arguments, TIMED, "mooring")
    file = measured(PARTS, names, "mooring", arguments.quick, arguments.out)
    results.write(arguments.out / output, file | {"quick": arguments.quick})
    if "three_periods" in file:
        print(f"three periods: the box scheme takes {file['three_periods']['ratio']:.3g} times as long")
    return 0


if __name__ == "__main__":
    console.run(main)
