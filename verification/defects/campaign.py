"""Random mutants of the solvers against the default tests: killed, judged equivalent, or open, by module.

A first run without a mutant records what each test costs and which functions of the solvers each file of tests calls.
A mutant is then shown to the files that call its function, the quickest test first, until one fails. A mutant that was
killed stays killed while its module's text is the same and the test that killed it is there; one that survived is run
again when any test or solver changes.
"""

from __future__ import annotations

import hashlib
import json
import tempfile
import tomllib
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import astuple, dataclass
from pathlib import Path

from ..tools.planting import Fault
from .catalogue import files
from .defect import Defect
from .mutants import deselected
from .runner import ROOT, CheckError, Copies, Log, Result, digest

EQUIVALENT = Path(__file__).with_name("equivalent.toml")
LEAST = 0.95
"""Share of the mutants that are not equivalent which the tests of every module have to kill."""
PLUGIN = "-p verification.defects.ordering"
RECORDING = 1200.0  # s, for one file of tests
SLOWER = 5.0  # times the recorded seconds of its tests, beyond a start, a mutant may take before it counts as killed
COMPILING = 60.0  # s, for a start, and the loops that a mutant compiles anew


@dataclass(frozen=True)
class Judgement:
    """Why a mutant does what the original does, or nothing that anybody is promised."""

    fault: Fault
    reason: str


def judgements(path: Path = EQUIVALENT) -> dict[tuple, Judgement]:
    """Return the mutants that were judged equivalent, by module, function, old and new code, and occurrence."""
    rows = tomllib.loads(path.read_text(encoding="utf-8")).get("mutant", [])
    judged = [Judgement(Fault(**{name: row[name] for name in row if name != "reason"}), row["reason"]) for row in rows]
    if len({astuple(one.fault) for one in judged}) < len(judged):
        raise ValueError(f"{path.name}: a mutant stands there twice")
    return {astuple(one.fault): one for one in judged}


@dataclass(frozen=True)
class Score:
    """Mutants of one module: how many were planted and killed, which survived with a judgement, and which without."""

    module: str
    planted: int
    killed: int
    equivalent: tuple[Defect, ...]
    open: tuple[Defect, ...]

    @property
    def rate(self) -> float:
        """Share killed of those that are not equivalent."""
        return self.killed / max(1, self.planted - len(self.equivalent)) if self.planted else 1.0


def scores(mutants: list[Defect], results: dict[str, Result], judged: dict[tuple, Judgement]) -> list[Score]:
    """Return the score of every module with a result."""
    made = []
    for module in sorted({mutant.module for mutant in mutants}):
        mine = [mutant for mutant in mutants if mutant.module == module and mutant.name in results]
        left = [mutant for mutant in mine if not results[mutant.name].red]
        equivalent = tuple(mutant for mutant in left if astuple(mutant.fault) in judged)
        unjudged = tuple(mutant for mutant in left if mutant not in equivalent)
        made.append(Score(module, len(mine), len(mine) - len(left), equivalent, unjudged))
    return made


# ---------------------------------------------------------------- what tests cost and call
def record(copies: Copies, names: list[str], kept: Path, jobs: int) -> Iterator[dict]:
    """Record the files of tests that ``kept`` has no record of; yield {file: record} of the first files done.

    A record belongs to the text of its file. Raises CheckError where a test fails without any mutant.
    """
    known, results = json.loads(kept.read_text(encoding="utf-8")) if kept.exists() else {}, {}
    texts = {name: hashlib.sha256((copies.source / "verification" / name).read_bytes()).hexdigest() for name in names}
    results |= {name: known[name] for name in names if known.get(name, {}).get("text") == texts[name]}
    with ThreadPoolExecutor(jobs) as pool:
        futures = {pool.submit(_recorded, copies, name): name for name in names if name not in results}
        for future in as_completed(futures):
            name = futures[future]
            results[name] = known[name] = {"text": texts[name], **future.result()}
            kept.write_text(json.dumps(known), encoding="utf-8")
            yield results
    yield results


def _recorded(copies, name) -> dict:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "record.json"
        result = copies.run(None, f"{name} {deselected(name)} {PLUGIN} --record={path}", RECORDING)
        if result.red:
            raise CheckError(f"{name} is red without any mutant: {result.test} {result.message}")
        return json.loads(path.read_text(encoding="utf-8"))


def chosen_files(mutant: Defect, known: dict) -> list[str]:
    """Return the files of its module's tests that call the mutant's function; all where none of them is seen to.

    Compiled loops, and what runs when a module is imported, are in no record.
    """
    name, every = f"{mutant.module}:{mutant.fault.function}", files(mutant.module)
    calling = [file for file in every if any(name in functions for functions in known[file]["calls"].values())]
    return calling or every


# ---------------------------------------------------------------- mutants
def run(
    mutants: list[Defect], log: Log, *, project: Path = ROOT, jobs: int = 1, timeout: float = 300.0, fresh: bool = False
) -> Iterator[tuple[int, int, dict[str, Result]]]:
    """Show every mutant to the tests of its module; yields (done, total, results by name). Raises CheckError."""
    with tempfile.TemporaryDirectory(prefix="mutants-", ignore_cleanup_errors=True) as folder:
        copies = Copies(Path(folder), project, jobs)
        names = list(dict.fromkeys(file for mutant in mutants for file in files(mutant.module)))
        total, known = len(names) + len(mutants), {}
        try:
            for known in record(copies, names, log.path.with_name("tests.json"), jobs):
                yield len(known), total, {}
            order = Path(folder) / "order.json"
            order.write_text(json.dumps({k: v for one in known.values() for k, v in one["tests"].items()}))
            keys = {mutant.name: _keys(copies.source, mutant) for mutant in mutants}
            result = {} if fresh else {m.name: old for m in mutants if (old := _kept(log, project, *keys[m.name]))}
            left = [mutant for mutant in mutants if mutant.name not in result]
            yield total - len(left), total, result
            yield from _run_all(copies, left, (known, order, timeout), (log, keys, result), jobs, total)
        finally:
            copies.__exit__()


def _run_all(copies, left, how, kept, jobs, total):
    log, keys, outcome = kept
    pool = ThreadPoolExecutor(jobs)
    try:
        futures = [pool.submit(_run_one, copies, mutant, *how) for mutant in left]
        for done, future in enumerate(as_completed(futures), start=1):
            result = future.result()
            outcome[result.defect] = result
            log.append(keys[result.defect][0 if result.red else 1], result)
            yield total - len(left) + done, total, outcome
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
        copies.__exit__()
        pool.shutdown(wait=True)


def _run_one(copies, mutant, known, order, timeout) -> Result:
    chosen = chosen_files(mutant, known)
    seconds = sum(sum(known[file]["tests"].values()) for file in chosen)
    check = f"{' '.join(chosen)} {' '.join(map(deselected, chosen))} {PLUGIN} --order={order}"
    result = copies.run(mutant, check, min(timeout, COMPILING + SLOWER * seconds))
    return Result(mutant.name, " ".join(chosen), *astuple(result)[2:])


def _keys(source: Path, mutant: Defect) -> tuple[str, str]:
    """What a killed mutant and one that survived are kept under."""
    text = hashlib.sha256((source / mutant.fault.path).read_bytes()).hexdigest()
    dumped = json.dumps([text, astuple(mutant.fault)]).encode()
    return hashlib.sha256(dumped).hexdigest(), hashlib.sha256(dumped + digest(source).encode()).hexdigest()


def _kept(log, project, killed, survived) -> Result | None:
    """The result of an earlier run, if it still says something."""
    result = log.results.get(killed)
    if result is not None:
        file, _, function = result.test.partition("::")
        path = project / "verification" / file
        if not function or (path.is_file() and f"def {function}(" in path.read_text(encoding="utf-8")):
            return result
    return log.results.get(survived)
