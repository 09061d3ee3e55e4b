"""Runs a module as a stage: `python -m reports.pipeline.running.process_group alone|beside MODULE ARGUMENT...`.

"alone" is pinned to one core. The stage and the group of processes that it starts (where there are such groups) end
with the report however that ends, kill -9 included: the report holds the other end of the guard's standard input. When
that is closed, or the stage is over, or the guard is told to end, it kills them. It stands outside of that group: a
stage that found its output closed before its own watcher ran would take the watcher with it and leave its children.
"""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import threading


def main() -> int:
    """Start the module, and return its exit status after what it started was killed."""
    how, *words = sys.argv[1:]
    if how == "alone" and hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})  # interrupts tend to go to the first core
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda received, _: sys.exit(128 + received))
    group = {"process_group": 0} if hasattr(os, "killpg") else {}
    stage = subprocess.Popen([sys.executable, "-P", "-m", *words], stdin=subprocess.DEVNULL, **group)
    try:
        threading.Thread(target=_watch, args=(stage,), daemon=True).start()
        code = stage.wait()
    finally:
        _kill(stage)
    return code if code >= 0 else 128 - code  # of a signal, as shells tell it


def _watch(stage: subprocess.Popen):
    with contextlib.suppress(OSError):  # no standard input at all: nobody holds its other end
        os.read(0, 1)  # nothing is ever written: this returns when the report is gone
    _kill(stage)


def _kill(stage: subprocess.Popen):
    with contextlib.suppress(ProcessLookupError, PermissionError):  # nobody is left; macOS: only who is over
        os.killpg(stage.pid, signal.SIGKILL) if hasattr(os, "killpg") else stage.kill()


if __name__ == "__main__":
    sys.exit(main())
