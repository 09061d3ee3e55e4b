"""Tables of load cases: rows side by side on any executor, kept one by one, and taken up again where they ended."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, ThreadPoolExecutor, wait
from dataclasses import dataclass, fields
from functools import partial
from os import PathLike
from pathlib import Path
from typing import Any

from ..common.load_case import LoadCase
from ..common.outcome import ConvergenceError, InputError, Status
from ..common.validation import flags, positive_number, whole_number
from ..io.case_file import append_record, load_system, read_load_cases, read_records, write_rows
from .accuracy import choose_setting, measure_accuracy
from .fingerprint import fingerprint
from .integration import integrate_case
from .results import Accuracy, CaseResult, LineResult, LoadCaseTable, line_result

REFERENCE_TIME = 10800.0  # s, for which extremes are given: three hours
WOHLER_EXPONENT = 3.0  # of chain in seawater (DNV-OS-E301, table of S-N curves)
MOST_RESTARTS = 3  # of an executor that broke, with no row done between
AHEAD = 64  # rows that are handed to an executor before the first of them is done
FAILED = "FAILED"
"""Status of a row that ended with an error that is none of the solvers'."""


@dataclass(frozen=True)
class RowSettings:
    """What every row is given: dt in s, cells, exponent of the Woehler curve, time in s that extremes refer to."""

    dt: float
    cells: int
    exponent: float = WOHLER_EXPONENT
    reference_time: float = REFERENCE_TIME


def solve_load_cases(
    system,
    cases,
    *,
    dt: float | None = None,
    cells: int | None = None,
    tolerance: float | None = None,
    wohler: float = WOHLER_EXPONENT,
    reference_time: float = REFERENCE_TIME,
    executor: Executor | Callable[[], Executor] | None = None,
    progress: Callable[[int, int], object] | None = None,
    output: str | PathLike[str] | None = None,
    resume: bool = True,
    check: bool = True,
    takes_best: bool = False,
) -> LoadCaseTable:
    """Return the LoadCaseTable of a Scene, a Network or the path of one, in each LoadCase, or in a CSV file of them.

    dt in s and cells, as of ``solve_time_domain`` and ``mooring_system``; or tolerance: both are chosen from some pilot
    cases so that maximum, standard deviation and damage-equivalent load err by no more than that part of themselves,
    and the choice is checked on a sample of the table (check=False: not). Where no setting meets it, ConvergenceError
    is raised, or with takes_best the setting is taken that leaves least; ``accuracy.promised`` says how much.
    wohler: exponent of the Woehler curve; reference_time: s, that extremes refer to.
    executor: any of concurrent.futures, that of Dask (``client.get_executor()``) included; a function that makes one is
    asked for another where one breaks; None: a thread for each core. Results do not depend on it, to the last bit.
    progress: called with rows done and rows in all.
    output: a CSV file of results; beside it, each row is kept in a .jsonl file as soon as it is done, and with resume
    a later call takes those rows whose inputs and solvers are the same, bit for bit.
    A row that cannot be solved has its status and message, and no other row minds. Raises InputError for what concerns
    all rows. Memory: some rows at a time, of each its series of tension.

    >>> from importlib.resources import files
    >>> from solvers import BodyMotion
    >>> from solvers.common.load_case import LoadCase
    >>> surge = BodyMotion.harmonic(0.1, (1.0, 0, 0, 0, 0, 0))
    >>> case = LoadCase("surge of 1 m", surge, duration=30.0, ramp=10.0)
    >>> scene = files("reference_data") / "scenes" / "dynamics" / "hb_case_1.toml"
    >>> solve_load_cases(scene, [case], dt=0.1, cells=20).cases[0].status
    'SUCCESS'
    """
    flags(resume=resume, check=check, takes_best=takes_best)
    given = load_system(system) if isinstance(system, (str, PathLike)) else system
    rows = read_load_cases(cases, given) if isinstance(cases, (str, PathLike)) else _checked(cases)
    settings = {"exponent": positive_number("wohler", wohler, "(dimensionless)"),
                "reference_time": positive_number("reference_time", reference_time, "s")}  # fmt: skip
    if (tolerance is None) == (dt is None and cells is None) or (dt is None) != (cells is None):
        raise InputError("give either dt (s) and cells, or tolerance (relative)", field="tolerance", value=tolerance)
    run = partial(_run_rows, given, executor=executor)
    accuracy = Accuracy()
    if tolerance is not None:
        tolerance = positive_number("tolerance", tolerance, "(dimensionless)")
        dt, cells, accuracy = choose_setting(rows, tolerance, partial(_run_with, run, settings), takes_best)
    row_settings = RowSettings(positive_number("dt", dt, "s"), whole_number("cells", cells, 2), **settings)
    kept = _Kept(output, given, row_settings, resume)
    done: dict[int, CaseResult] = {}
    numbered = list(enumerate(rows))
    for result in kept.known(numbered):
        done[result.number] = result
    if progress is not None:
        progress(len(done), len(rows))
    for result in run([pair for pair in numbered if pair[0] not in done], row_settings):
        done[result.number] = result
        kept.keep(result)
        if progress is not None:
            progress(len(done), len(rows))
    table = LoadCaseTable(tuple(done[i] for i in range(len(rows))), row_settings.dt, row_settings.cells, accuracy)
    if tolerance is not None and check:
        accuracy = measure_accuracy(rows, table, accuracy, partial(_run_with, run, settings))
        table = LoadCaseTable(table.cases, table.dt, table.cells, accuracy)
    kept.finish(table)
    return table


def _checked(cases) -> list:
    if not isinstance(cases, Sequence) or not cases:
        problem = f"{cases!r} must be the path of a CSV file, or a list of LoadCase"
        raise InputError(problem, field="cases", value=cases)
    for i, case in enumerate(cases):
        if not isinstance(case, (LoadCase, InputError)):
            raise InputError(f"{case!r} is no LoadCase", field=f"cases[{i}]", value=case)
    return list(cases)


# ---------------------------------------------------------------- one row
def solve_row(given, number: int, case, settings: RowSettings) -> CaseResult:
    """Return the CaseResult of one LoadCase, or of the InputError in its place, whatever happens in it."""
    if isinstance(case, InputError):
        return CaseResult(number, f"case {number + 1}", Status.INVALID_INPUT.name, str(case))
    try:
        series = integrate_case(given, case, dt=settings.dt, cells=settings.cells)
        if series.status is not Status.SUCCESS:
            time, node = series.event or (0.0, "")
            message = f"at t = {time:.6g} s, {node}: {series.status.value}"
            return CaseResult(number, case.name, series.status.name, message, (), series.iterations)
        names = line_names(given, len(series.lines))
        lines = tuple(line_result(name, line, series.dt, settings.exponent, settings.reference_time)
                      for name, line in zip(names, series.lines, strict=True))  # fmt: skip
        return CaseResult(number, case.name, Status.SUCCESS.name, "", lines, series.iterations)
    except InputError as error:
        return CaseResult(number, case.name, Status.INVALID_INPUT.name, str(error))
    except ConvergenceError as error:
        return CaseResult(number, case.name, Status.NO_EQUILIBRIUM_FOUND.name, str(error))
    except Exception as error:  # of one row: the others go on, and the row says what it was
        return CaseResult(number, case.name, FAILED, f"{type(error).__name__}: {error}")


def line_names(given, count: int) -> list[str]:
    """Return a name for each line: those of the nodes at its ends, or its number."""
    names = getattr(given, "node_names", ())
    if not names:
        return [f"line {i}" for i in range(1, count + 1)] if count > 1 else ["line"]
    return [f"{names[a]} - {names[b]}" for a, b in (element.ends for element in given.elements)]


# ---------------------------------------------------------------- many rows
def _run_with(run, settings, numbered, dt, cells) -> list[CaseResult]:
    return list(run(numbered, RowSettings(dt, cells, **settings)))


def _run_rows(given, numbered, settings, *, executor) -> Iterator[CaseResult]:
    """Yield the CaseResult of each (number, case) as it is done; an executor that breaks is replaced if it can be."""
    left: dict[int, Any] = dict(numbered)
    restarts = 0
    while left:
        own = not isinstance(executor, Executor)
        pool = (executor or partial(ThreadPoolExecutor, os.cpu_count()))() if own else executor
        try:
            for result in _run_once(pool, given, dict(left), settings):
                del left[result.number]
                restarts = 0
                yield result
        except BrokenExecutor:
            restarts += 1
            if not own or restarts > MOST_RESTARTS:
                raise
        finally:
            if own:
                pool.shutdown(wait=not left, cancel_futures=True)


def _run_once(pool, given, left, settings) -> Iterator[CaseResult]:
    pending, waiting = set(), iter(left.items())
    try:
        while True:
            for number, case in waiting:
                pending.add(pool.submit(solve_row, given, number, case, settings))
                if len(pending) >= AHEAD:
                    break
            if not pending:
                return
            done, pending = wait(pending, return_when=FIRST_COMPLETED)
            finished = [future for future in done if future.exception() is None]
            yield from (future.result() for future in finished)
            for future in done:
                future.result()  # of the first that broke
    finally:
        for future in pending:
            future.cancel()


# ---------------------------------------------------------------- what is kept
class _Kept:
    """The rows that are done, in a file of JSON lines beside the CSV file of results, or nowhere."""

    def __init__(self, output, given, settings, resume):
        self.path = None if output is None else Path(output)
        self.rows = None if self.path is None else self.path.with_suffix(".jsonl")
        self.given, self.settings, self.resume, self.keys = given, settings, resume, {}
        if self.rows is not None and not resume:
            self.rows.unlink(missing_ok=True)

    def known(self, numbered) -> list[CaseResult]:
        """Return the rows that an earlier run left for the same inputs, settings and solvers."""
        if self.rows is None:
            return []
        common = fingerprint(self.given, self.settings)
        self.keys = {i: fingerprint(common, str(case) if isinstance(case, InputError) else case)
                     for i, case in numbered}  # fmt: skip
        there = {(record["key"], record["row"]["number"]): record["row"] for record in read_records(self.rows)}
        rows = (there.get((key, i)) for i, key in self.keys.items())
        return [CaseResult.from_record(row) for row in rows if row is not None and row["status"] != FAILED]

    def keep(self, result: CaseResult):
        """Put one row on the disk."""
        if self.rows is not None:
            append_record(self.rows, {"key": self.keys[result.number], "row": result.as_record()})

    def finish(self, table: LoadCaseTable):
        """Write the CSV file: a row for each line of each case."""
        if self.path is None:
            return
        names = [field.name for field in fields(LineResult) if field.name != "warnings"]
        rows = []
        for case in table.cases:
            for line in case.lines:
                rows.append(
                    [case.name, case.status, *(getattr(line, name) for name in names), "; ".join(line.warnings)]
                )
            if not case.lines:
                rows.append([case.name, case.status, *[None] * len(names), case.message])
        write_rows(self.path, ["case", "status", *names, "remarks"], rows)
