"""One BLAS thread: on small blocks several threads wait for each other, ten to sixty times longer on a busy machine."""

from __future__ import annotations

import threading
from contextlib import contextmanager
from functools import lru_cache

from threadpoolctl import ThreadpoolController

_lock, _entered = threading.Lock(), []  # what there was before the first who is inside came, then None for each other


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
                limits.restore_original_limits()
