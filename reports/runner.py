"""Runs the stages one after another as child processes, with one progress bar and the time left."""

from __future__ import annotations

import contextlib
import os
import queue
import re
import signal
import subprocess
import sys
import threading
import time
from collections import deque
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from tqdm import tqdm

from .ledger import Ledger, key
from .stages import ROOT, Stage

TAIL = 15  # last lines of a failing child that are shown
_LINES = re.compile(r"progress (\d+(?:\.\d+)?) (\d+(?:\.\d+)?)\s*$")  # of our programs
_PERCENT = re.compile(r"\[\s*(\d+)%\]\s*$")  # of pytest


@dataclass(frozen=True)
class Ended:
    """How a stage ended: state "reused", "measured" or "failed"; ``tail`` is what a failing child said last.

    code : exit status of the child (pytest gives 1 where tests fail)
    """

    stage: Stage
    state: str
    tail: tuple[str, ...] = ()
    code: int = 0


def run_all(stages: list[Stage], results: Path, fresh: bool) -> list[Ended]:
    """Run what is not current, one at a time, so that nothing disturbs a timing. A failure does not stop the others."""
    ledger = Ledger(results)
    todo = {stage.name for stage in stages if fresh or not ledger.current(stage)}
    bar = _Bar([(stage, ledger.expected(stage)) for stage in stages if stage.name in todo])
    with bar:
        return [_ended(stage, ledger, bar) if stage.name in todo else Ended(stage, "reused") for stage in stages]


def _ended(stage: Stage, ledger: Ledger, bar: _Bar) -> Ended:
    bar.start(stage)
    ledger.forget(stage)
    load, began = _load(), time.perf_counter()
    part = ledger.results / f"{stage.output}.part"
    code, lines = _child(stage, ledger.results, part, bar)
    seconds = time.perf_counter() - began
    bar.finish(stage)
    if part.exists() and part.stat().st_size:
        os.replace(part, ledger.results / stage.output)
    if code not in stage.codes or not (ledger.results / stage.output).exists():
        return Ended(stage, "failed", (*lines, f"(exit status {code})")[-TAIL:], code)
    finished = datetime.now().astimezone().isoformat(" ", "minutes")
    good = code == 0  # failing tests are a result, but not one to be reused
    ledger.record(stage, key=key(stage, stage.arguments), good=good, seconds=seconds, finished=finished, load=load)
    return Ended(stage, "measured", code=code)


def _load() -> list[float] | None:
    return [round(value, 2) for value in os.getloadavg()] if hasattr(os, "getloadavg") else None


def _child(stage: Stage, results: Path, part: Path, bar: _Bar) -> tuple[int, list[str]]:
    """Exit status and last lines of the child; ends it and what it started if we are interrupted."""
    words = [word.replace("{results}", str(results)).replace("{part}", str(part)) for word in stage.arguments]
    process = subprocess.Popen(
        [sys.executable, "-m", *words],
        cwd=ROOT,
        env=os.environ | {"MOORING_PROGRESS": "lines", "PYTHONUNBUFFERED": "1", "PYTHONIOENCODING": "utf-8"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        encoding="utf-8",
        errors="replace",
        start_new_session=True,
    )
    try:
        tail = _follow(process, bar)
        return process.returncode, tail
    except BaseException:
        _end(process)
        raise


def _follow(process, bar: _Bar) -> list[str]:
    """Show the child's progress until it ends; its last lines that are not progress."""
    lines, tail = queue.Queue(), deque(maxlen=4 * TAIL)
    threading.Thread(target=_pump, args=(process.stdout, lines), daemon=True).start()
    while True:
        try:
            line = lines.get(timeout=0.5)
        except queue.Empty:
            bar.tick()
            continue
        if line is None:
            process.wait()
            return list(tail)
        if not bar.read(line) and line.strip():
            tail.append(line.rstrip())


def _pump(stream, lines: queue.Queue):
    for line in stream:
        lines.put(line)
    lines.put(None)


def _end(process):
    with contextlib.suppress(ProcessLookupError):
        if hasattr(os, "killpg"):
            os.killpg(process.pid, signal.SIGTERM)
        else:
            process.terminate()
    with contextlib.suppress(subprocess.TimeoutExpired):
        process.wait(timeout=10)


class _Bar:
    """One bar over all stages, in expected seconds; a stage moves it by the share that it reports done."""

    def __init__(self, expected: list[tuple[Stage, float]]):
        self.expected = {stage.name: seconds for stage, seconds in expected}
        self.count, self.index, self.before = len(expected), 0, 0.0
        form = "{desc:<34} {percentage:3.0f}% |{bar}| {elapsed} gone, {remaining} left"
        self.bar = tqdm(
            total=max(sum(self.expected.values()), 1e-9), bar_format=form, smoothing=0, disable=not expected
        )

    def __enter__(self):
        return self

    def __exit__(self, *error):
        self.bar.close()

    def start(self, stage: Stage):
        """A stage begins."""
        self.index, self.span = self.index + 1, self.expected[stage.name]
        self.began, self.reported = time.perf_counter(), None
        self.bar.set_description_str(f"{self.index}/{self.count} {stage.title}", refresh=False)
        self.bar.refresh()

    def read(self, line: str) -> bool:
        """Take a line of the child: True if it tells progress."""
        if ours := _LINES.match(line):
            done, total = map(float, ours.groups())
            self.reported = done / total if total else 1.0
        elif percent := _PERCENT.search(line):
            self.reported = float(percent[1]) / 100
        self.tick()
        return bool(ours)

    def tick(self):
        """Redraw: by what the child reports, else by the clock and never beyond nine tenths."""
        clock = min((time.perf_counter() - self.began) / self.span, 0.9)
        self._to(self.before + self.span * (clock if self.reported is None else min(self.reported, 1.0)))

    def finish(self, stage: Stage):
        """A stage is over, however long it took."""
        self.before += self.span
        self._to(self.before)
        self.bar.refresh()

    def _to(self, value: float):
        self.bar.n = min(value, self.bar.total)
        if sys.stderr.isatty():  # in a log one line at each end of a stage is enough
            self.bar.refresh()
