"""Runs a module as a stage of the report: `python -m reports.guard alone|beside MODULE ARGUMENT...`.

"alone" is pinned to one core. The stage ends with the report however that ends, kill -9 included: the report holds the
other end of its standard input, and when that is closed the whole group of processes of the stage is killed.
"""

from __future__ import annotations

import os
import runpy
import signal
import sys
import threading


def main():
    """Become the module."""
    how, module, *arguments = sys.argv[1:]
    _end_with_parent()
    if how == "alone" and hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})  # interrupts tend to go to the first core
    sys.argv = [module, *arguments]
    runpy.run_module(module, run_name="__main__", alter_sys=True)


def _end_with_parent():
    """Watch the parent through a copy of standard input, which becomes empty for the stage and its own children."""
    line = os.dup(0)
    empty = os.open(os.devnull, os.O_RDONLY)
    os.dup2(empty, 0)
    os.close(empty)
    threading.Thread(target=_watch, args=(line,), daemon=True).start()


def _watch(line: int):
    os.read(line, 1)  # nothing is ever written: this returns when the parent is gone
    if hasattr(os, "killpg") and os.getpgrp() == os.getpid():
        os.killpg(os.getpid(), signal.SIGKILL)
    os._exit(1)


if __name__ == "__main__":
    main()
