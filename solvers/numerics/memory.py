"""Memory that is freed stays with the process: the first touch of new pages takes as long as the arithmetic on them."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

_LARGEST = 31 * 2**20  # bytes; glibc learns from blocks up to 32 MiB


@lru_cache(maxsize=1)
def keep_freed_memory():
    """Take one large block, untouched, and give it back.

    The C library of GNU then takes blocks up to that size from its own heap, of which it keeps up to twice as much
    (mallopt(3), M_MMAP_THRESHOLD), where it would ask the system for new pages and return them each time. Elsewhere
    nothing changes.
    """
    np.empty(_LARGEST, np.uint8)
