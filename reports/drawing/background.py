"""Work in forked processes: a figure is written to its file while the program draws the next one."""

from __future__ import annotations

import os
import sys
import traceback
from collections.abc import Callable

from ..pipeline.stages import CORES

_children: list[int] = []


def start(work: Callable[[], object]):
    """Run ``work()`` in a process of its own, at most CORES at a time; in this process where forking is not safe."""
    if sys.platform != "linux" or CORES < 2:  # elsewhere a program that draws cannot be forked safely
        work()
        return
    if len(_children) >= CORES:
        _wait_for(_children.pop(0))
    sys.stdout.flush()
    sys.stderr.flush()
    if pid := os.fork():
        _children.append(pid)
        return
    code = 1
    try:
        work()
        code = 0
    except Exception:
        traceback.print_exc()
    finally:
        os._exit(code)  # also where it is interrupted: a child must not go on as the program


def finish():
    """Wait for all processes. Raises RuntimeError where one has failed."""
    while _children:
        _wait_for(_children.pop(0))


def _wait_for(pid: int):
    if code := os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]):
        raise RuntimeError(f"a process that writes a figure ended with status {code}; its message is above")
