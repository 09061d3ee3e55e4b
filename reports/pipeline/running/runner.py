"""Runs the stages as child processes: those that time nothing beside one another, then the timings one at a time."""

from __future__ import annotations

import contextlib
import os
import queue
import subprocess
import threading
import time
from collections import deque
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path

from ..dependencies.installation import MODULE, child_environment
from ..dependencies.ledger import Ledger, key
from ..stages import CORES, Stage
from .progress import Progress

REFUSED = 2  # exit status of a stage whose input is wrong
OF_FILES = ("scenes", "moving_networks", "load_cases", "sweep")
"""Groups of stages about files of a user; the first source is the file."""
TAIL = 15  # last lines of a failing child that are shown
ONE_THREAD = {f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "MKL", "VECLIB", "BLIS")}


PIPED = {"MOORING_PROGRESS": "lines", "PYTHONUNBUFFERED": "1", "PYTHONIOENCODING": "utf-8"}
HYPOTHESIS = "HYPOTHESIS_STORAGE_DIRECTORY"
"""Environment variable: where Hypothesis keeps its files, by default in the caller's folder."""


class BusyError(RuntimeError):
    """Another report is being made in the same folder."""


@dataclass(frozen=True)
class Ended:
    """How a stage ended: state "reused", "measured" or "failed"; ``tail`` is what a failing child said last.

    code : exit status of the child (pytest gives 1 where tests fail)
    """

    stage: Stage
    state: str
    tail: tuple[str, ...] = ()
    code: int = 0

    @property
    def is_refused(self) -> bool:
        """Whether the stage refused the file that it is about."""
        return self.state == "failed" and self.code == REFUSED and self.stage.group in OF_FILES


def run_all(stages: list[Stage], results: Path, fresh: bool) -> list[Ended]:
    """Run what is not current; a failure does not stop the others. Raises BusyError."""
    with only_run(results):
        ledger = Ledger(results)
        todo = [stage for stage in stages if fresh or not ledger.current(stage)]
        for left in (path for stage in todo for path in _unfinished(results, stage)):
            left.unlink()  # by a run that was killed
        ended = {stage.name: Ended(stage, "reused") for stage in stages}
        with Progress({stage: ledger.expected(stage) for stage in todo}) as progress:
            run = _Run(todo, ledger, progress)
            ended |= {end.stage.name: end for end in run.ended()}
            ended |= run.dropped
    return [ended[stage.name] for stage in stages]


def _part(results: Path, stage: Stage) -> Path:
    return results / f"{stage.output}.part"


def _unfinished(results: Path, stage: Stage) -> list[Path]:
    path = results / stage.output
    return [*path.parent.glob(f"{path.name}.part"), *path.parent.glob(f"{path.name}.*.tmp")]


@contextlib.contextmanager
def only_run(results: Path):
    """Hold the folder's lock, which the system takes back however this process ends (where it has such locks)."""
    try:
        import fcntl
    except ImportError:
        yield
        return
    with (results / "lock").open("w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise BusyError(f"another report is being made in {results.parent}: wait for it, or give --out") from None
        yield


@dataclass
class _Child:
    """A stage under way."""

    stage: Stage
    process: subprocess.Popen
    load: list[float] | None
    began: float
    tail: deque = field(default_factory=lambda: deque(maxlen=4 * TAIL))


class _Run:
    """The stages of one run, and those of them that are under way."""

    def __init__(self, todo: list[Stage], ledger: Ledger, progress: Progress):
        self.ledger, self.progress = ledger, progress
        self.waiting = sorted(todo, key=lambda stage: (stage.timed, -ledger.expected(stage)))  # the longest first
        self.running: dict[str, _Child] = {}
        self.dropped: dict[str, Ended] = {}
        self.lines: queue.Queue = queue.Queue()  # (name of the stage, line it printed or None at its end)

    def ended(self):
        """Yield what becomes of each stage; interrupted, end those under way and what they started."""
        try:
            while self.waiting or self.running:
                while stage := self._startable():
                    self._start(stage)
                if end := self._next():
                    yield end
        finally:
            _end([child.process for child in self.running.values()])

    def _startable(self) -> Stage | None:
        """Return the first stage that finds its cores free; a timing has the machine for itself."""
        busy = sum(child.stage.jobs for child in self.running.values())
        for stage in self.waiting:
            if stage.timed:  # all others are over, or would have come first
                return None if self.running else stage
            if not busy or busy + stage.jobs <= CORES:
                return stage
        return None

    def _start(self, stage: Stage):
        self.waiting.remove(stage)
        self.ledger.forget(stage)
        part = _part(self.ledger.results, stage)
        part.parent.mkdir(parents=True, exist_ok=True)
        words = [stage.filled(word, self.ledger.results, part) for word in stage.arguments]
        load = [round(value, 2) for value in os.getloadavg()] if hasattr(os, "getloadavg") else None
        process = subprocess.Popen(
            [*MODULE, "reports.pipeline.running.process_group", "alone" if stage.timed else "beside", *words],
            env=child_environment() | ONE_THREAD | PIPED | {HYPOTHESIS: str(self.ledger.results / "hypothesis")},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            encoding="utf-8",
            errors="replace",
            start_new_session=True,
        )
        self.running[stage.name] = _Child(stage, process, load, time.perf_counter())
        threading.Thread(target=self._pump, args=(stage.name, process.stdout), daemon=True).start()
        self.progress.start(stage)

    def _pump(self, name: str, stream):
        for line in stream:
            self.lines.put((name, line))
        self.lines.put((name, None))

    def _next(self) -> Ended | None:
        """Take one line of a child; return the end of its stage if it was the last one."""
        try:
            name, line = self.lines.get(timeout=0.5)
        except queue.Empty:
            self.progress.tick()
            return None
        child = self.running[name]
        if line is not None:
            if not self.progress.read(child.stage, line) and line.strip():
                child.tail.append(line.rstrip())
            return None
        child.process.wait()
        child.process.stdin.close()
        del self.running[name]
        end = self._kept(child)
        if end.is_refused:
            self._drop_others(end)
        self.progress.finish(child.stage, end.state, time.perf_counter() - child.began)
        return end

    def _drop_others(self, end: Ended):
        """Take what would refuse the same file for the same reason from those that wait."""
        file = end.stage.sources[0]
        dropped = [stage for stage in self.waiting if stage.group in OF_FILES and file in stage.sources]
        self.waiting = [stage for stage in self.waiting if stage not in dropped]
        self.dropped |= {stage.name: Ended(stage, "failed", end.tail, end.code) for stage in dropped}

    def _kept(self, child: _Child) -> Ended:
        """Record the result of a child that is over; return how its stage ended."""
        stage, code, seconds = child.stage, child.process.returncode, time.perf_counter() - child.began
        output, part = self.ledger.results / stage.output, _part(self.ledger.results, stage)
        if code in stage.codes and part.exists():
            os.replace(part, output)
        if code not in stage.codes or not output.exists():
            return Ended(stage, "failed", (*child.tail, f"(exit status {code})")[-TAIL:], code)
        finished = datetime.now().astimezone().isoformat(" ", "minutes")
        good = code == 0  # failing tests are a result, but not one to be reused
        self.ledger.record(
            stage, key=key(stage, stage.arguments), good=good, seconds=seconds, finished=finished, load=child.load
        )
        return Ended(stage, "measured", code=code)


def _end(processes: list[subprocess.Popen]):
    """Let the guards end their stages and what these started."""
    for process in processes:
        process.stdin.close()
    for process in processes:
        try:
            process.wait(timeout=10)
        except subprocess.TimeoutExpired:
            process.kill()
