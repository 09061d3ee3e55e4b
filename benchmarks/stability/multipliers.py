"""Floquet multipliers of moving lines: their time, how each road fails, slack and the step, multipliers.json.

``growth``: CPU time of the multipliers of the OC3 line by its cells. ``methods``: difference of Hill's problem and the
monodromy by harmonics and by steps. ``steps``: multipliers over slack cells by time steps, beside the decay in time.
``tongue``: sideways growth of a taut line over frequency and amplitude. ``curve``: a response curve with stability.
"""

from __future__ import annotations

import math
import time

import numpy as np

from solvers import CableProperties, Environment, Motion, Scene, mooring_system, solve_periodic
from solvers.common.outcome import ConvergenceError
from solvers.numerics.modes import natural_modes
from solvers.stability import response_curve
from solvers.stability.multipliers.floquet import floquet

from ..run import console, results

CELLS, QUICK_CELLS = (25, 50, 100, 200), (25, 50)
HARMONICS, ROADS_STEPS = (5, 9, 15, 25), (50, 100, 200, 400, 800, 1600)
SLACK_STEPS = (100, 200, 400, 800)
TURNS = 3
LEAST_IN_TIME = 0.15  # a smaller multiplier leaves less than rounding after three periods
TENSION, STIFFNESS, MASS, LENGTH, TAUT_CELLS = 2000.0, 1e6, 1.0, 100.0, 10  # N, N, kg/m, m: the taut line
POINTS = 200


def line(amplitude, frequency, cells):
    """The line of OC3 in surge, m and Hz."""
    chain = CableProperties(EA=384.243e6, diameter=0.09, mass_per_length=77.7066, Cdn=1.6)
    motion = Motion.harmonic(frequency, (amplitude, 0.0, 0.0))
    scene = Scene("OC3", chain, 902.2, (0.0, 0.0, -320.0), (848.67, 0.0, -70.0), motion=motion)
    return mooring_system(scene, cells=cells)


def taut_line(change, omega):
    """A taut line without weight or drag, its stiffness across changed by a share ``change`` through its end."""
    cable = CableProperties(EA=STIFFNESS, diameter=0.02, mass_per_length=MASS, submerged_weight=0.0)
    amplitude = change * TENSION / STIFFNESS * LENGTH * (1 + TENSION / STIFFNESS)
    motion = Motion.harmonic(omega / (2 * math.pi), (amplitude, 0.0, 0.0))
    end = (LENGTH * (1 + TENSION / STIFFNESS), 0.0, 0.0)
    scene = Scene("taut", cable, LENGTH, (0.0, 0.0, 0.0), end, Environment(rho=0.0), motion=motion)
    return mooring_system(scene, cells=TAUT_CELLS, mesh="uniform")


def growth(quick):
    """Least CPU time of ``floquet`` in s, by cells and by method, in 3 m of surge at 0.05 Hz with nine harmonics."""
    rows = []
    for cells in QUICK_CELLS if quick else CELLS:
        response = solve_periodic(line(3.0, 0.05, cells), harmonics=9)
        seconds = {}
        for method in ("monodromy", "hill", "both") * TURNS:
            start = time.process_time()
            floquet(response, method=method)
            seconds[method] = min(time.process_time() - start, seconds.get(method, math.inf))
        rows.append({"cells": cells, "seconds": seconds})
    return rows


def compare_methods(quick):
    """Difference of the two methods in 2 mm of surge at 0.2 Hz, by harmonics and by steps, most of the other."""
    rows = []
    for harmonics in HARMONICS:
        response = solve_periodic(line(0.002, 0.2, 10), harmonics=harmonics)
        for steps in ROADS_STEPS if harmonics == HARMONICS[-1] else ROADS_STEPS[-1:]:
            result = floquet(response, steps=steps)
            counted = 0 if result.hill is None else result.hill.size
            rows.append({"harmonics": harmonics, "steps": steps, "counted": counted, "difference": result.difference})
    return rows


def steps(quick):
    """Largest multipliers over slack cells by time steps, and how disturbances change over a period in time."""
    rows = []
    for amplitude, frequency in ((5.0, 0.093), (5.0, 0.08), (10.0, 0.05)):
        response = solve_periodic(line(amplitude, frequency, 10), harmonics=5)
        for count in SLACK_STEPS[:-1] if quick else SLACK_STEPS:
            result = floquet(response, method="steps", steps=count)
            row = {"amplitude": amplitude, "frequency": frequency, "steps": count, "repeats": result.by_time_steps}
            row |= {"real": result.multipliers[:4].real, "imag": result.multipliers[:4].imag}
            rows.append(row | {"in_time": _change_in_time(response, count) if result.by_time_steps else None})
    return rows


def _change_in_time(response, count):
    """Return by how much a disturbance along the leading mode changes in a period of the time steps.

    None where it falls below rounding, or turns as a pair of modes does.
    """
    orbit = response.stepped_orbit(count)
    period = orbit.linearised()
    values, vectors = np.linalg.eig(period.apply(np.eye(period.size)))
    first = abs(values).argmax()
    if abs(values[first]) < LEAST_IN_TIME or values[first].imag:
        return None
    vector = vectors[:, first].real
    small = 1e-7 * period.unpack(vector / abs(vector).max())
    ends, sizes = [orbit.state + small, orbit.state - small], []
    for _ in range(3):
        taken = [orbit.take_period(end) for end in ends]
        if None in taken:
            return None
        ends = [end for end, _ in taken]
        sizes.append(np.linalg.norm(period.pack(ends[0] - ends[1])))
    return sizes[-1] / sizes[-2]


def tongue(quick):
    """Sideways growth in 1/s of the taut line about twice its first frequency, beside the formula of first order."""
    natural = 2 * math.pi * natural_modes(taut_line(0.0, 1.0)).frequencies[0]
    rows = []
    for change in np.linspace(0.02, 0.2, 4 if quick else 10):
        for ratio in np.linspace(1.9, 2.1, 9 if quick else 21):
            response = solve_periodic(taut_line(change, ratio * natural), harmonics=5)
            result = floquet(response, method="monodromy")
            pumped, detuned = change * natural / (2 * ratio), natural * (ratio / 4 - 1 / ratio)
            formula = math.sqrt(max(0.0, pumped**2 - detuned**2))
            rate = math.log(abs(result.sideways[0])) / result.period
            rows.append({"change": change, "ratio": ratio, "growth": rate, "first_order": formula})
    return rows


def curve(quick):
    """CPU time of a response curve of the OC3 line, 50 cells and nine harmonics, with multipliers at each point, s."""
    most = 20 if quick else POINTS
    step = 0.9 / most
    start = time.process_time()
    points = response_curve(line(2.0, 0.03, 50), start=0.03, stop=0.08, harmonics=9, step=step, max_step=step,
                            min_step=step / 100, max_points=most, throw=False)  # fmt: skip
    middle = time.process_time()
    stable = [floquet(points.response(k)).stable for k in range(points.values.size)]
    seconds = {"curve": middle - start, "multipliers": time.process_time() - middle}
    return [{"points": points.values.size, "stable": sum(stable), "seconds": seconds, "end": points.end}]


PARTS = {"growth": growth, "methods": compare_methods, "steps": steps, "tongue": tongue, "curve": curve}


def main(argv=None) -> int:
    """Command line."""
    parser = console.parser("multipliers", __doc__)
    parser.add_argument("--quick", action="store_true", help="fewer points")
    parser.add_argument("--parts", nargs="+", choices=PARTS, default=list(PARTS), help="only these parts")
    arguments = parser.parse_args(argv)
    file: dict = {"quick": arguments.quick}
    for name in arguments.parts:
        try:
            file[name] = PARTS[name](arguments.quick)
        except ConvergenceError as error:
            file[name] = {"failed": str(error)}
        print(f"{name}: {len(file[name])} rows")
    results.write(arguments.out / "multipliers.json", file)
    return 0


if __name__ == "__main__":
    console.run(main)
