"""One BLAS thread: on small blocks several threads wait for each other, ten to sixty times longer on a busy machine."""

from __future__ import annotations

from functools import lru_cache

from threadpoolctl import ThreadpoolController


@lru_cache(maxsize=1)
def _controller() -> ThreadpoolController:
    """Found once: looking for the libraries takes longer than a solve."""
    return ThreadpoolController()


def one_blas_thread():
    """Context in which BLAS and LAPACK use one thread."""
    return _controller().limit(limits=1, user_api="blas")
