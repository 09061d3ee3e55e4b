"""Work in forked processes: sections side by side, and figures written to files while the program draws the next."""

from __future__ import annotations

import os
import signal
import sys
import traceback
from collections.abc import Callable
from multiprocessing import get_context

from ..pipeline.stages import CORES

_children: list[int] = []
_forks = sys.platform == "linux" and CORES > 1  # elsewhere a program that draws cannot be forked safely
_work: Callable | None = None


def for_each(work: Callable, count: int) -> list:
    """Return work(i) for i below count, made in forked processes; in this process where forking is not safe.

    What is returned is pickled. An exception of ``work`` is raised here. A process that is ended before it has begun
    keeps that signal until ``_stay`` has set what it does.
    """
    global _work
    if not _forks or count < 2:
        return [work(i) for i in range(count)]
    _work = work
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGTERM})  # which forked processes have, too
    try:
        pool = get_context("fork").Pool(min(CORES, count), _stay)
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
    with pool:
        return pool.map(_do, range(count), chunksize=1)


def _stay():
    """Have this process, which is one of several, start no others, and end without a word when the program ends it."""
    global _forks
    _forks = False
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # of a terminal, which the program gets as well
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGTERM})


def _do(i: int):
    return _work(i)


def start(work: Callable[[], object]):
    """Run ``work()`` in a process of its own, at most CORES at a time; in this process where forking is not safe."""
    if not _forks:
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
