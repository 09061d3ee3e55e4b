"""Runs checks on copies of the project, each with one defect planted; keeps every result as soon as it is there.

A result belongs to the contents of solvers, tests, reference data and defect: when one of them changes it is not
taken again. Results are lines of one file, appended whole, so a run that is stopped anywhere loses what it was just
doing and nothing else.
"""

from __future__ import annotations

import hashlib
import importlib.metadata
import json
import os
import platform
import queue
import re
import shutil
import signal
import tempfile
import threading
import time
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import asdict, astuple, dataclass
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
    test, message : the first test that failed and what it said
    """

    defect: str
    check: str
    outcome: str
    seconds: float
    test: str = ""
    message: str = ""

    @property
    def red(self) -> bool:
        """The check has seen the defect."""
        return self.outcome != "missed"


# ---------------------------------------------------------------- one check
def run_check(
    interpreter: Interpreter, check: str, timeout: float, interpreted: bool = False
) -> tuple[str, float, str, str]:
    """Return (outcome, seconds, test, message) of a check on a copy of the project, its loops compiled or interpreted.

    Raises CheckError, KeyboardInterrupt.
    """
    began = time.perf_counter()
    try:
        code, output = interpreter.run([*arguments(check), *_OPTIONS], timeout, interpreted)
    except Stopped as stopped:
        raise KeyboardInterrupt from stopped
    seconds = time.perf_counter() - began
    if code is None:
        return "timeout", seconds, "", f"not ended after {timeout:g} s"
    if code in _STOPPED or "KeyboardInterrupt" in output:
        raise KeyboardInterrupt
    if code in (3, 4, 5):
        raise CheckError(f"{check}: pytest ended with status {code}:\n{output.strip()}")
    if code == 0:
        return "missed", seconds, "", ""
    match = _SUMMARY.search(output)
    test, message = (match[1].removeprefix("verification/"), match[3] or "") if match else ("", output[-300:])
    return ("caught" if code in (1, 2) else "crash"), seconds, test, message[:300]


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
    to.mkdir()
    for name in COPIED:
        if (project / name).is_dir():
            shutil.copytree(project / name, to / name, ignore=shutil.ignore_patterns("__pycache__", ".*"))
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

    No defect means the project as it is. The results are all of ``wanted``, old ones included. Raises CheckError.
    """
    with tempfile.TemporaryDirectory(prefix="seeded-defects-", ignore_cleanup_errors=True) as folder:
        copies = Copies(Path(folder), project, jobs)
        tree = digest(copies.source)
        pairs = {key(tree, *pair): pair for pair in wanted}
        _check_patches(copies.source, {pair[0] for pair in pairs.values() if pair[0]})
        outcome = [] if fresh else [log.results[k] for k in pairs if k in log.results]
        left = {k: pair for k, pair in pairs.items() if fresh or k not in log.results}
        interpreted = checks_of_loops(copies.source, pairs.values())
        yield len(outcome), len(pairs), outcome
        pool = ThreadPoolExecutor(jobs)
        try:
            groups = _groups(left, interpreted)
            futures = [pool.submit(_results, copies, *group, timeout, interpreted) for group in groups]
            for future in as_completed(futures):
                for k, result in future.result().items():
                    log.append(k, result)
                    outcome.append(result)
                yield len(outcome), len(pairs), outcome
        finally:
            pool.shutdown(wait=False, cancel_futures=True)
            copies.__exit__()
            pool.shutdown(wait=True)


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


def _groups(left: dict, interpreted: set[str]) -> list[tuple[str, dict]]:
    """(check, what it answers for): on the project as it is, the functions of one file together; else one by one.

    A function that is named with several choices of its parameters is run once, with all of them. Those with
    interpreted loops are together, too.
    """
    clean = {k: check for k, (defect, check) in left.items() if defect is None and "::" in check}
    functions = {k: check.split(" -k ")[0] for k, check in clean.items() if len(check.split(" -k ")[0].split()) == 1}
    several = [function for function in functions.values() if list(functions.values()).count(function) > 1]
    together: dict[tuple, dict] = {}
    for k, pair in left.items():
        whole = k in functions and (functions[k] in several or functions[k] == clean[k])
        name = functions[k].split("::")[0] if whole else k
        together.setdefault((name, pair[1] in interpreted), {})[k] = pair
    joined = lambda group: " ".join(dict.fromkeys(functions.get(k, pair[1]) for k, pair in group.items()))
    return [(joined(group) if len(group) > 1 else "", group) for group in together.values()]


def _results(copies: Copies, joined: str, group: dict, timeout: float, interpreted: set[str]) -> dict[str, Result]:
    """Key -> result of a group; one by one where not all of it is green."""
    if joined:
        one = copies.run(None, joined, timeout, all(check in interpreted for _, check in group.values()))
        if not one.red:
            return {k: Result("", check, "missed", one.seconds / len(group)) for k, (_, check) in group.items()}
    return {k: copies.run(*pair, timeout, pair[1] in interpreted) for k, pair in group.items()}
