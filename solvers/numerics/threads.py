"""One BLAS thread: on small blocks several threads wait for each other, ten to sixty times longer on a busy machine."""

from __future__ import annotations

import os
import threading
from contextlib import contextmanager
from functools import lru_cache

from threadpoolctl import ThreadpoolController

_lock, _entered = threading.Lock(), []  # what there was before the first who is inside came, then None for each other
if hasattr(os, "register_at_fork"):  # a lock that another thread holds would stay locked in the child
    os.register_at_fork(before=_lock.acquire, after_in_parent=_lock.release, after_in_child=_lock.release)


@lru_cache(maxsize=1)
def _controller() -> ThreadpoolController:
    """Found once: looking for the libraries takes longer than a solve."""
    return ThreadpoolController()


@contextmanager
def one_blas_thread():
    """Context in which BLAS and LAPACK use one thread, until the last of those who entered it has left.

    They may overlap, in threads of Python: if each restored what it had found, the last one would restore the one
    thread of the others.
    """
    with _lock:
        _entered.append(None if _entered else _controller().limit(limits=1, user_api="blas"))
    try:
        yield
    finally:
        with _lock:
            if limits := _entered.pop():
                _let_others_set()
                limits.restore_original_limits()
                _let_others_set()


def _let_others_set():
    """From threadpoolctl 3.8 on OpenBLAS obeys the thread that set it first, and no other one that leaves or comes."""
    for library in _controller().lib_controllers:
        if hasattr(library, "clear_controlling_thread"):
            library.clear_controlling_thread(force=True)
