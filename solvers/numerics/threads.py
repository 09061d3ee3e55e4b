"""Limit BLAS to one thread: on small blocks of a busy machine several threads take ten to sixty times as long."""

from __future__ import annotations

import os
import threading
from contextlib import contextmanager
from functools import lru_cache

from threadpoolctl import ThreadpoolController

_entered: list
_lock, _entered = threading.Lock(), []  # one entry a context: the first restores the limits, the others are None
if hasattr(os, "register_at_fork"):  # a lock that another thread holds would stay locked in the child
    os.register_at_fork(before=_lock.acquire, after_in_parent=_lock.release, after_in_child=_lock.release)


@lru_cache(maxsize=1)
def _controller() -> ThreadpoolController:
    """Return the controller, built once: looking for the libraries takes longer than a solve."""
    return ThreadpoolController()


@contextmanager
def one_blas_thread():
    """Return a context in which BLAS and LAPACK use one thread until the last overlapping context is left.

    Contexts of several Python threads may overlap: if each restored the limits at its own entry, the last one would
    restore the one thread of the others.
    """
    with _lock:
        _entered.append(None if _entered else _controller().limit(limits=1, user_api="blas"))
    try:
        yield
    finally:
        with _lock:
            if limits := _entered.pop():
                _release_owner()
                limits.restore_original_limits()
                _release_owner()


def _release_owner():
    """Release the OpenBLAS setting from its thread: from threadpoolctl 3.8 on no other thread could change it."""
    for library in _controller().lib_controllers:
        if hasattr(library, "clear_controlling_thread"):
            library.clear_controlling_thread(force=True)
