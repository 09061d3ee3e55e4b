"""Load cases on a system: a table of them, or the sea of its own [motion].

Rows are kept one by one in <system>/<cases>.csv (of its own sea <system>/sea.csv) beside --out, a summary in JSON.
"""

from __future__ import annotations

import argparse
import math
import sys
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path

import numpy as np
from tqdm import tqdm

from solvers import ConvergenceError, InputError
from solvers.io.case_file import describe_columns, load_case_of, load_system, read_load_cases
from solvers.load_cases import solve_load_cases
from solvers.load_cases.envelope import find_envelopes
from solvers.load_cases.integration import integrate_case
from solvers.load_cases.solve import REFERENCE_TIME
from solvers.load_cases.statistics import CONFIDENCE, REFERENCE_FREQUENCY
from solvers.numerics.threads import one_blas_thread

from ..run import console, results
from ..scenes.margin import margins_of_cases
from ..scenes.network_files import check_weights, load
from ..scenes.network_outputs import spectral_density

BAD_INPUT, NO_SETTING = 2, 1  # exit status
TOLERANCE = 0.02
"""Relative error of maximum, standard deviation and damage-equivalent load, where no setting is given."""
OWN = "sea"
"""Name of the results of a system's own sea."""
WINDOW = 300.0  # s of the series that is shown, about the greatest tension
ANIMATED, POSES = 60.0, 80  # s about the greatest tension in which the lines are drawn, and at how many instants
POINTS = 31  # of a line that is drawn, at most


class _Bar:
    """Rows done: a bar with the time left, or a line for each where a parent asks for lines."""

    def __init__(self, label: str):
        self.label, self.bar = label, None

    def __call__(self, done: int, total: int):
        if console.asks_for_lines():
            print(f"progress {done} {total}", flush=True)
            return
        if self.bar is None:
            self.bar = tqdm(total=total, initial=done, desc=self.label, file=sys.stderr, unit="case")
        self.bar.update(done - self.bar.n)

    def close(self):
        """End the bar."""
        if self.bar is not None:
            self.bar.close()


@contextmanager
def _executor(address: str | None, jobs: int):
    """Yield an executor: threads of this process, or the workers of a Dask scheduler."""
    if address is None:
        with ThreadPoolExecutor(jobs) as pool:
            yield pool
        return
    try:
        from distributed import Client
    except ImportError:
        raise ImportError("--dask takes the extra dask: pip install 'mooring-verification[dask]'") from None
    with Client(address) as client:
        yield client.get_executor()


def _system(path: Path):
    if path.suffix.lower() != ".toml":
        return load(path)[0]
    system = load_system(path)
    elements = getattr(system, "elements", (system,))
    check_weights(system, [element.cable for element in elements], path)
    return system


def solve(arguments) -> dict:
    """Return the summary of the table: its rows with their seas, its setting and accuracy; of a sea its series, too."""
    path, cases, system = arguments.system, arguments.cases, _system(arguments.system)
    rows = [load_case_of(system)] if cases is None else read_load_cases(cases, system)
    folder = arguments.out.parent / (arguments.name or path.stem)
    folder.mkdir(parents=True, exist_ok=True)
    stem = OWN if cases is None else cases.stem
    output, bar = folder / f"{stem}.csv", _Bar(f"load cases {stem}")
    given = {"dt": arguments.dt, "cells": arguments.cells}
    if arguments.dt is None and arguments.cells is None:
        given = {"tolerance": arguments.tolerance}
    try:
        with _executor(arguments.dask, arguments.jobs) as pool:
            table = solve_load_cases(
                system, rows, **given, wohler=arguments.wohler, executor=pool, progress=bar, output=output,
                resume=not arguments.fresh, takes_best=True)  # fmt: skip
    finally:
        bar.close()
    summary = {
        "name": getattr(system, "name", "") or path.stem, "file": path.name, "cases": cases and cases.name,
        "output": f"{folder.name}/{output.name}", "dt": table.dt,
        "cells": table.cells, "wohler": arguments.wohler,
        "accuracy": asdict(table.accuracy) | {"is_kept": table.accuracy.is_kept, "share": table.accuracy.SHARE},
        "rows": [_row(case, row) for case, row in zip(table.cases, rows, strict=True)],
        "hours": REFERENCE_TIME / 3600, "confidence": CONFIDENCE, "frequency": REFERENCE_FREQUENCY,
        "series": None, "margins": [], "suspected": getattr(system, "warnings", ()),
    }  # fmt: skip
    if cases is None and table.cases[0].success:
        summary["series"] = series_of(system, rows[0], table)
        summary |= envelopes_of(system, rows[0], table, summary["series"]["time_of_max"])
    summary["margins"] = _margins(system, table.cases)
    return summary


def series_of(system, case, table) -> dict:
    """Return spectra of the tensions of one case, tensions (lines, K) in N about the greatest, and when each is that.

    Times in s from the end of the ramp, over which the table has its statistics.
    """
    with one_blas_thread():
        series = integrate_case(system, case, dt=table.dt, cells=table.cells)
    wave = np.array([line.fairlead for line in series.lines])
    greatest = int(wave.max(axis=0).argmax())
    count = min(wave.shape[1], math.ceil(WINDOW / series.dt))
    first = min(max(greatest - count // 2, 0), wave.shape[1] - count)
    return {"time": series.dt * np.arange(first, first + count), "tension": wave[:, first : first + count],
            "spectrum": spectral_density(wave, series.dt), "time_of_max": series.dt * wave.argmax(axis=1),
            "duration": case.duration, "ramp": case.ramp}  # fmt: skip


def envelopes_of(system, case, table, times_of_max) -> dict:
    """Return extremes of tension along the lines over a case, and where they are about the greatest tension of all.

    along: of each line s in m, low, mean and high in N; envelope: rest and poses as network_outputs.envelope has them,
    their duration in s and the time of the first.
    """
    centre = times_of_max[int(np.argmax([line.maximum for line in table.cases[0].lines]))]
    length = min(ANIMATED, case.duration)
    first = min(max(centre - length / 2, 0.0), case.duration - length)
    times = first + length * np.arange(POSES) / POSES
    with one_blas_thread():
        lines = find_envelopes(system, case, dt=table.dt, cells=table.cells, times=times)
    along = [{"s": line.s, "low": line.low, "mean": line.mean, "high": line.high} for line in lines]
    kept = [np.unique(np.linspace(0, line.rest.shape[1] - 1, POINTS).astype(int)) for line in lines]
    undisplaced = [line.rest[:, points] for line, points in zip(lines, kept, strict=True)]
    poses = [[line.poses[k][:, points] for line, points in zip(lines, kept, strict=True)] for k in range(POSES)]
    depth = system.environment.depth
    return {"along": along, "envelope": {"rest": undisplaced, "poses": poses, "first": first, "duration": length},
            "seabed": None if depth is None else -depth}  # fmt: skip


def _margins(system, cases) -> list[dict]:
    if cable := getattr(system, "cable", None):
        breaking_loads = [cable.breaking_load]
    else:
        breaking_loads = list(getattr(system, "breaking_loads", ()))
    return margins_of_cases(cases, breaking_loads, getattr(system, "safety_factors", None))


def _row(case, row) -> dict:
    """Return a row for the page: the result, and the height of its waves where it has some."""
    spectrum = getattr(getattr(row, "motion", None), "spectrum", None)
    return case.as_record() | {"Hs": None if spectrum is None else spectrum.significant_height}


def main(argv=None) -> int:
    """Command line."""
    parser = console.parser("load_cases.table", __doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.epilog = f"Columns of CASES.csv, for which editors know no schema:\n{describe_columns()}"
    parser.add_argument("files", nargs="+", type=Path, metavar="FILE", help="CASES.csv and a scene or network (.toml, "
                        ".map, .txt, .dat); or a scene or network alone, whose [motion] is a sea")  # fmt: skip
    parser.add_argument("--name", help="of the result, where another system has the same stem")
    parser.add_argument("--dt", type=float, metavar="S", help="step in s, with --cells in place of the tolerance")
    parser.add_argument("--cells", type=int, metavar="N", help="cells of a line, with --dt")
    parser.add_argument("--tolerance", type=float, default=TOLERANCE, metavar="E",
                        help=f"relative error of maximum, deviation and damage (default: {TOLERANCE:g})")  # fmt: skip
    parser.add_argument("--wohler", type=float, default=3.0, metavar="M", help="exponent of the Woehler curve")
    parser.add_argument("--dask", metavar="ADDRESS", help="scheduler of a Dask cluster, such as tcp://host:8786")
    parser.add_argument("--fresh", action="store_true", help="solve again what an earlier run has left")
    console.add_jobs(parser)
    arguments = parser.parse_args(argv)
    *cases, arguments.system = arguments.files
    if len(cases) > 1:
        parser.error("one table of load cases and one system")
    arguments.cases = cases[0] if cases else None
    try:
        summary = solve(arguments)
    except (InputError, ConvergenceError) as error:
        print(error, file=sys.stderr)
        return BAD_INPUT if isinstance(error, InputError) else NO_SETTING
    stems = [*([arguments.cases.stem] if cases else []), arguments.name or arguments.system.stem]
    results.write(arguments.out / f"load_cases_{'_'.join(stems)}.json", {"-".join(stems): summary})
    return 0


if __name__ == "__main__":
    console.run(main)
