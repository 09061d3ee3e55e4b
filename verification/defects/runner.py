"""Runs checks on copies of the project, each with one defect planted; keeps every result as soon as it is there.

A result belongs to the contents of solvers, tests, reference data and defect: when one of them changes it is not
taken again. Results are lines of one file, appended whole, so a run that is stopped anywhere loses what it was just
doing and nothing else.
"""

from __future__ import annotations

import contextlib
import hashlib
import importlib.metadata
import json
import os
import platform
import queue
import re
import shlex
import shutil
import signal
import tempfile
import threading
import time
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import asdict, astuple, dataclass, replace
from pathlib import Path

from verification import ROOT

from .defect import Defect, arguments
from .interpreter import Interpreter, Stopped

COPIED = ("solvers", "verification", "benchmarks", "reference_data", "conftest.py", "pyproject.toml")
SKIPPED = ("verification/defects", "verification/suite/test_defects.py", "benchmarks")
"""What no check of a solver depends on: results stay valid when it changes."""

_OPTIONS = ("-x", "--tb=no", "--no-header", "-p", "no:cacheprovider", "-p", "no:faulthandler")
_SUMMARY = re.compile(r"^(?:FAILED|ERROR) (\S+?\.py(?:::\w+)*)(\[.*?\])?(?: - (.*))?$", re.MULTILINE)
_LOOPS = re.compile(r"^@(compiled|njit)\b", re.MULTILINE)
_STOPPED = (-signal.SIGTERM, -signal.SIGINT, -9)


class CheckError(RuntimeError):
    """A check cannot be run (it does not exist, or pytest does not understand it), or patches do not apply."""


@dataclass(frozen=True)
class Result:
    """How a check ended with a defect planted ("" for none).

    outcome : "caught" (a test failed), "timeout" (it did not end), "crash" (the interpreter died) or "missed"
    test, message : the first test that failed and what it said; parameters : with which it did, as pytest writes them
    """

    defect: str
    check: str
    outcome: str
    seconds: float
    test: str = ""
    message: str = ""
    parameters: str = ""

    @property
    def red(self) -> bool:
        """The check has seen the defect."""
        return self.outcome != "missed"


# ---------------------------------------------------------------- one check
def run_check(
    interpreter: Interpreter, check: str, timeout: float, interpreted: bool = False
) -> tuple[str, float, str, str, str]:
    """Return (outcome, seconds, test, message, parameters) of a check on a copy of the project.

    interpreted: whether Python runs the loops of the solvers. Raises CheckError, KeyboardInterrupt.
    """
    began = time.perf_counter()
    try:
        code, output = interpreter.run([*arguments(check), *_OPTIONS], timeout, interpreted)
    except Stopped as stopped:
        raise KeyboardInterrupt from stopped
    seconds = time.perf_counter() - began
    if code is None:
        return "timeout", seconds, "", f"not ended after {timeout:g} s", ""
    if code in _STOPPED or "KeyboardInterrupt" in output:
        raise KeyboardInterrupt
    if code in (3, 4, 5):
        raise CheckError(f"{check}: pytest ended with status {code}:\n{output.strip()}")
    if code == 0:
        return "missed", seconds, "", "", ""
    match = _SUMMARY.search(output)
    test, message = (match[1].removeprefix("verification/"), match[3] or "") if match else ("", output[-300:])
    parameters = match[2] or "" if match else ""
    return ("caught" if code in (1, 2) else "crash"), seconds, test, message[:300], parameters


# ---------------------------------------------------------------- copies of the project
class Copies:
    """Copies of the project, one for each worker, from one snapshot that a run does not see change."""

    def __init__(self, folder: Path, project: Path, count: int):
        self.source, self.free = folder / "source", queue.SimpleQueue()
        self.all: list[Interpreter] = []
        self.stamp = 1_000_000_000  # a time of last change of its own for each patch: no stale bytecode is ever taken
        self.lock = threading.Lock()
        _copy(project, self.source)
        for i in range(count):
            _copy(self.source, folder / f"copy{i}")
            self.all.append(Interpreter(folder / f"copy{i}"))
            self.free.put(self.all[-1])

    def __enter__(self) -> Copies:
        return self

    def __exit__(self, *_):
        """Ends what still runs."""
        for interpreter in self.all:
            interpreter.close()

    def run(self, defect: Defect | None, check: str, timeout: float, interpreted: bool = False) -> Result:
        """Return the result of a check on a free copy with the defect planted, and removed again."""
        interpreter = self.free.get()
        root = interpreter.root
        try:
            if defect is not None:
                self._plant(defect, root)
            return Result(defect.name if defect else "", check, *run_check(interpreter, check, timeout, interpreted))
        finally:
            if defect is not None:
                name = defect.fault.path
                shutil.copy2(self.source / name, root / name)
            self.free.put(interpreter)

    def _plant(self, defect, root):
        defect.fault.write_to(root)
        with self.lock:
            self.stamp += 2
            stamp = self.stamp
        os.utime(root / defect.fault.path, (stamp, stamp))


def _copy(project: Path, to: Path):
    """Copy the files with their times, and so that what numba has cached beside them holds for the copy too."""
    to.mkdir()
    for name in COPIED:
        if (project / name).is_dir():
            shutil.copytree(project / name, to / name, ignore=shutil.ignore_patterns("*.pyc", "*.tmp*", ".*"))
        elif (project / name).exists():
            shutil.copy2(project / name, to / name)
    settings = to / "verification" / "installed_pytest.ini"
    if not (to / "pyproject.toml").exists() and settings.exists():  # an installed wheel
        shutil.copy2(settings, to / "pytest.ini")


def digest(project: Path) -> str:
    """Digest of all that a result depends on, apart from defect and check."""
    total = hashlib.sha256()
    for name in COPIED:
        path = project / name
        for file in [path] if path.is_file() else sorted(p for p in path.rglob("*") if p.is_file()):
            inside = file.relative_to(project).as_posix()
            if not inside.startswith(SKIPPED) and "__pycache__" not in inside:
                total.update(f"{inside}\0".encode() + hashlib.sha256(file.read_bytes()).digest())
    for package in ("numpy", "scipy", "numba", "mpmath", "hypothesis", "pytest"):
        total.update(f"{package} {importlib.metadata.version(package)}\0".encode())
    total.update(platform.python_version().encode())
    return total.hexdigest()


def key(tree: str, defect: Defect | None, check: str) -> str:
    """What a result is kept under."""
    patch = astuple(defect.fault) if defect else ()
    return hashlib.sha256(json.dumps([tree, patch, arguments(check)]).encode()).hexdigest()


# ---------------------------------------------------------------- results on disk
class Log:
    """Results by key, one line each; a line that was cut off is no result."""

    def __init__(self, path: Path):
        self.path, self.results = path, {}
        path.parent.mkdir(parents=True, exist_ok=True)
        for line in path.read_text(encoding="utf-8").splitlines() if path.exists() else ():
            try:
                entry = json.loads(line)
                name = entry.pop("key")
                self.results[name] = Result(**entry)
            except (ValueError, KeyError, TypeError, AttributeError):
                continue

    def append(self, key: str, result: Result):
        """Add a line at one go, after whatever a killed run left of its last one."""
        self.results[key] = result
        line = "\n" + json.dumps({"key": key, **asdict(result)}) + "\n"
        handle = os.open(self.path, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o644)
        try:
            os.write(handle, line.encode())
            os.fsync(handle)
        finally:
            os.close(handle)


# ---------------------------------------------------------------- many checks
def run(
    wanted: Iterable[tuple[Defect | None, str]],
    log: Log,
    *,
    project: Path = ROOT,
    jobs: int = 1,
    timeout: float = 120.0,
    fresh: bool = False,
) -> Iterator[tuple[int, int, list[Result]]]:
    """Run the (defect, check) that the log does not have yet; yields (done, total, results so far) after each.

    No defect means the project as it is, of which only the tests are run that a defect turned red. The results are all
    of ``wanted``, old ones included. Raises CheckError.
    """
    with tempfile.TemporaryDirectory(prefix="seeded-defects-", ignore_cleanup_errors=True) as folder:
        copies = Copies(Path(folder), project, jobs)
        tree, pairs = digest(copies.source), list(dict.fromkeys(wanted))
        planted = [(defect, check, check) for defect, check in pairs if defect is not None]
        _check_patches(copies.source, {defect for defect, _, _ in planted})
        how = copies, timeout, checks_of_loops(copies.source, pairs)
        outcome: list[Result] = []
        pool = ThreadPoolExecutor(jobs)
        try:
            for _ in _run_new(planted, tree, log, fresh, how, pool, outcome):
                yield len(outcome), len(pairs), outcome
            clean = [(None, check, narrowed(check, outcome)) for defect, check in pairs if defect is None]
            for _ in _run_new(clean, tree, log, fresh, how, pool, outcome):
                yield len(outcome), len(pairs), outcome
        finally:
            pool.shutdown(wait=False, cancel_futures=True)
            copies.__exit__()
            pool.shutdown(wait=True)


def narrowed(check: str, planted: Iterable[Result]) -> str:
    """Return the tests of a check that defects turned red, as a check; the whole one where that is not known.

    Empty where no defect turned it red: whether it is red by itself then says nothing of any defect.
    """
    mine = [result for result in planted if result.check == check]
    red = [result for result in mine if result.red]
    if not mine or not all(".py::" in result.test for result in red):
        return check
    return shlex.join(dict.fromkeys(result.test + result.parameters for result in red))


def _run_new(some, tree, log, fresh, how, pool, outcome) -> Iterator[None]:
    """Add the results of (defect, check, what of it is run) to the outcome, from the log where they are in it.

    Yields after each group.
    """
    keys = {key(tree, defect, words): (defect, check, words) for defect, check, words in some}
    left = {}
    for k, job in keys.items():
        if k in log.results and not fresh:
            outcome.append(replace(log.results[k], check=job[1]))
        elif not job[2]:
            outcome.append(Result("", job[1], "missed", 0.0))
        else:
            left[k] = job
    yield
    for future in as_completed([pool.submit(_results, group, *how) for group in _groups(left, how[-1])]):
        for k, result in future.result().items():
            log.append(k, result)
            outcome.append(result)
        yield


def checks_of_loops(root: Path, pairs: Iterable[tuple[Defect | None, str]]) -> set[str]:
    """Return the checks named for defects in modules with compiled loops, which are run with interpreted ones.

    A defect is in the text, and such a check looks at small problems: to compile the loops anew, with each defect and
    after it, would take several times as long. Other checks, and the tests themselves, run compiled loops.
    """
    named = [defect for defect, check in pairs if defect is not None and check == defect.check]
    has_loops = {path: bool(_LOOPS.search((root / path).read_text(encoding="utf-8"))) for path in
                 {defect.fault.path for defect in named}}  # fmt: skip
    return {defect.check for defect in named if has_loops[defect.fault.path]}


def _check_patches(root: Path, defects: Iterable[Defect]):
    """Before any work: raises CheckError naming every patch that does not apply."""
    wrong = []
    for defect in defects:
        try:
            defect.applied_to((root / defect.fault.path).read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            wrong.append(str(error))
    if wrong:
        raise CheckError("\n".join(sorted(wrong)))


def _groups(left: dict, interpreted: set[str]) -> list[dict]:
    """Return jobs that share one run: on the project as it is, the tests of one file; else each has its own."""
    together: dict[tuple, dict] = {}
    for k, job in left.items():
        defect, check, words = job
        files = {word.partition("::")[0] for word in shlex.split(words)}
        alone = defect is not None or words == check or len(files) > 1
        together.setdefault(((k,) if alone else tuple(files), check in interpreted), {})[k] = job
    return list(together.values())


def _results(group: dict, copies: Copies, timeout: float, interpreted: set[str]) -> dict[str, Result]:
    """Key -> result of a group; one by one where not all of it is green."""
    if len(group) > 1:
        joined = " ".join(words for _, _, words in group.values())
        with contextlib.suppress(CheckError):
            one = copies.run(None, joined, timeout, all(check in interpreted for _, check, _ in group.values()))
            if not one.red:
                return {k: Result("", job[1], "missed", one.seconds / len(group)) for k, job in group.items()}
    return {k: _result(*job, copies, timeout, interpreted) for k, job in group.items()}


def _result(defect, check, words, copies, timeout, interpreted) -> Result:
    """Return the result of one job; of the whole check where pytest does not find the tests by their parameters."""
    try:
        return replace(copies.run(defect, words, timeout, check in interpreted), check=check)
    except CheckError:
        if words == check:
            raise
        return copies.run(defect, check, timeout, check in interpreted)
