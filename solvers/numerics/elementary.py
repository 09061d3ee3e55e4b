"""The elementary functions twice, under numpy's names: for floats and for arrays, so that one formula serves both."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np

ARRAY = np

# numpy's own functions for floats too, except where the result is exact: an array then equals its elements bit for bit.
SCALAR = SimpleNamespace(
    where=lambda condition, a, b: a if condition else b,
    any=bool,
    minimum=min,
    maximum=max,
    sqrt=math.sqrt,
    sinh=lambda x: float(np.sinh(x)),
    log=lambda x: float(np.log(x)),
    log1p=lambda x: float(np.log1p(x)),
    cbrt=lambda x: float(np.cbrt(x)),
    arcsinh=lambda x: float(np.arcsinh(x)),
)
