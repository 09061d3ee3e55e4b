"""A table of load cases on a system, kept row by row in <system>/<cases>.csv beside --out, and a summary in JSON."""

from __future__ import annotations

import sys
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path

from tqdm import tqdm

from solvers import ConvergenceError, InputError
from solvers.io.case_file import load_system, read_load_cases
from solvers.load_cases import solve_load_cases

from ..run import console, results
from ..scenes.network_files import load

BAD_INPUT = 2  # exit status
TOLERANCE = 0.02
"""Relative error of maximum, standard deviation and damage-equivalent load, where no setting is given."""


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
    return load_system(path) if path.suffix.lower() == ".toml" else load(path)[0]


def solve(arguments) -> dict:
    """Return the summary of the table: its rows with their seas, its setting and accuracy."""
    system = _system(arguments.system)
    rows = read_load_cases(arguments.cases, system)
    folder = arguments.out.parent / arguments.system.stem
    folder.mkdir(parents=True, exist_ok=True)
    output, bar = folder / f"{arguments.cases.stem}.csv", _Bar(f"load cases {arguments.cases.stem}")
    given = {"dt": arguments.dt, "cells": arguments.cells}
    if arguments.dt is None and arguments.cells is None:
        given = {"tolerance": arguments.tolerance}
    try:
        with _executor(arguments.dask, arguments.jobs) as pool:
            table = solve_load_cases(
                system, rows, **given, wohler=arguments.wohler, executor=pool, progress=bar, output=output,
                resume=not arguments.fresh)  # fmt: skip
    finally:
        bar.close()
    return {
        "name": getattr(system, "name", "") or arguments.system.stem, "file": arguments.system.name,
        "cases": arguments.cases.name, "output": f"{arguments.system.stem}/{output.name}", "dt": table.dt,
        "cells": table.cells, "wohler": arguments.wohler, "accuracy": asdict(table.accuracy),
        "rows": [_row(case, row) for case, row in zip(table.cases, rows, strict=True)],
    }  # fmt: skip


def _row(case, row) -> dict:
    """Return a row for the page: the result, and the height of its waves where it has some."""
    spectrum = getattr(getattr(row, "motion", None), "spectrum", None)
    return case.as_record() | {"Hs": None if spectrum is None else spectrum.significant_height}


def main(argv=None) -> int:
    """Command line."""
    parser = console.parser("load_cases.table", __doc__)
    parser.add_argument("cases", type=Path, metavar="CASES.csv")
    parser.add_argument("system", type=Path, metavar="SYSTEM", help="scene or network: .toml, .map, .txt, .dat")
    parser.add_argument("--dt", type=float, metavar="S", help="step in s, with --cells in place of the tolerance")
    parser.add_argument("--cells", type=int, metavar="N", help="cells of a line, with --dt")
    parser.add_argument("--tolerance", type=float, default=TOLERANCE, metavar="E",
                        help=f"relative error of maximum, deviation and damage (default: {TOLERANCE:g})")  # fmt: skip
    parser.add_argument("--wohler", type=float, default=3.0, metavar="M", help="exponent of the Woehler curve")
    parser.add_argument("--dask", metavar="ADDRESS", help="scheduler of a Dask cluster, such as tcp://host:8786")
    parser.add_argument("--fresh", action="store_true", help="solve again what an earlier run has left")
    console.add_jobs(parser)
    arguments = parser.parse_args(argv)
    try:
        summary = solve(arguments)
    except (InputError, ConvergenceError) as error:
        print(error, file=sys.stderr)
        return BAD_INPUT
    name = f"load_cases_{arguments.cases.stem}_{arguments.system.stem}.json"
    results.write(arguments.out / name, {f"{arguments.cases.stem}-{arguments.system.stem}": summary})
    return 0


if __name__ == "__main__":
    console.run(main)
