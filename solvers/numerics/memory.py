"""Keep freed memory in the process: touching new pages takes as long as the arithmetic on them."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

_LARGEST = 31 * 2**20  # bytes; glibc adapts its threshold to blocks of up to 32 MiB


@lru_cache(maxsize=1)
def keep_freed_memory():
    """Allocate one large block and free it, so that glibc keeps later blocks of up to that size.

    glibc then raises its threshold (mallopt(3), M_MMAP_THRESHOLD) and serves such blocks from its heap, instead of
    asking the system for new pages each time. Other C libraries are not affected.
    """
    np.empty(_LARGEST, np.uint8)
