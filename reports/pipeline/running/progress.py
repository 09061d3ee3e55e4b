"""Progress over all stages, some of them beside one another, with the time left; lines where it is read from a log."""

from __future__ import annotations

import re
import sys
import time

from tqdm import tqdm

from ..stages import CORES, Stage

_LINES = re.compile(r"progress (\d+(?:\.\d+)?) (\d+(?:\.\d+)?)\s*$")  # of our programs
_PERCENT = re.compile(r"\[\s*(\d+)%\]\s*$")  # of pytest
SETTLED = 0.1
"""Part of the whole after which the pace of this run counts more than the times that were expected."""


class Progress:
    """A bar in expected seconds of the run; a stage moves it by the share that it reports done."""

    def __init__(self, expected: dict[Stage, float]):
        self.seconds = {stage.name: seconds for stage, seconds in expected.items()}
        self.weight = {stage.name: seconds * _share(stage) for stage, seconds in expected.items()}
        self.total, self.began = max(sum(self.weight.values()), 1e-9), time.perf_counter()
        self.running: dict[str, tuple[Stage, float, float | None]] = {}  # name -> stage, begin, share reported
        self.over: set[str] = set()
        self.bar = None
        if expected and sys.stderr.isatty():
            form = "{percentage:3.0f}% |{bar:20}| {desc}"
            self.bar = tqdm(total=self.total, bar_format=form, dynamic_ncols=True, leave=False)

    def __enter__(self):
        return self

    def __exit__(self, *error):
        if self.bar is not None:
            self.bar.close()

    def start(self, stage: Stage):
        """Show that a stage begins."""
        self.running[stage.name] = stage, time.perf_counter(), None
        if self.bar is None:
            self._say(f"{stage.title} ...")
        self.tick()

    def read(self, stage: Stage, line: str) -> bool:
        """Return whether a line of a stage reports progress and nothing else; take the progress from it."""
        ours, percent = _LINES.match(line), _PERCENT.search(line)
        if ours or percent:
            done, total = map(float, ours.groups()) if ours else (float(percent[1]), 100.0)
            self.running[stage.name] = *self.running[stage.name][:2], min(done / total, 1.0) if total else 1.0
            self.tick()
        return bool(ours)

    def finish(self, stage: Stage, state: str, seconds: float):
        """Show that a stage is over, however long it took."""
        del self.running[stage.name]
        self.over.add(stage.name)
        if self.bar is None or state == "failed":
            self._say(f"{stage.title}: {'FAILED after ' if state == 'failed' else ''}{seconds:.1f} s")
        self.tick()

    def tick(self):
        """Redraw the bar."""
        if self.bar is not None:
            titles = ", ".join(stage.title for stage, *_ in self.running.values())
            self.bar.n = min(self._done(), self.total)
            self.bar.set_description_str(f"{self._times()} | {len(self.over)}/{len(self.weight)} done, now {titles}")

    def _done(self) -> float:
        """Return the expected seconds done: as the stages report, else by the clock, at most nine tenths."""
        done = sum(self.weight[name] for name in self.over)
        for name, (_, began, reported) in self.running.items():
            clock = min((time.perf_counter() - began) / max(self.seconds[name], 1e-9), 0.9)
            done += self.weight[name] * (clock if reported is None else reported)
        return done

    def left(self) -> float:
        """Return the seconds left, at the pace of this run as soon as there is one."""
        done, gone = self._done(), time.perf_counter() - self.began
        trust = min(done / (SETTLED * self.total), 1.0)
        pace = trust * gone / done + (1 - trust) if done else 1.0
        return (self.total - done) * pace

    def _times(self) -> str:
        return f"{_clock(time.perf_counter() - self.began)} gone, {_clock(self.left())} left"

    def _say(self, text: str):
        line = f"[{len(self.over):2}/{len(self.weight)}] {self._times()}: {text}"
        tqdm.write(line, file=sys.stderr) if self.bar is not None else print(line, file=sys.stderr, flush=True)


def _share(stage: Stage) -> float:
    """Return part of the machine that a stage takes."""
    return 1.0 if stage.timed else min(stage.jobs / CORES, 1.0)


def _clock(seconds: float) -> str:
    minutes, remaining = divmod(round(seconds), 60)
    return f"{minutes}:{remaining:02}"
