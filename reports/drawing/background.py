"""Work in forked processes beside the program that goes on: pictures are written while the next one is made."""

from __future__ import annotations

import os
import sys
import traceback
from collections.abc import Callable

from ..pipeline.stages import CORES

_children: list[int] = []


def start(work: Callable[[], object]):
    """``work()`` in a process of its own, at most CORES at a time; at once where processes are not to be forked."""
    if sys.platform != "linux" or CORES < 2:  # elsewhere forking a program that draws is not safe, or not there
        work()
        return
    if len(_children) >= CORES:
        _ended(_children.pop(0))
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
        os._exit(code)  # also where it is interrupted: it must not go on as the program


def finish():
    """Wait for all of it. Raises RuntimeError where some has failed."""
    while _children:
        _ended(_children.pop(0))


def _ended(pid: int):
    if code := os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]):
        raise RuntimeError(f"a process that writes a picture ended with status {code}; its message is above")
