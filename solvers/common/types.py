"""Types of what callers give, for annotations: vectors as lists, tuples or arrays, and any object that moves an end."""

from __future__ import annotations

from collections.abc import Sequence
from functools import singledispatch
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .outcome import InputError

Vector = Sequence[float] | NDArray[np.floating]
"""Three numbers in x, y, z as they are given; validated, they are a tuple of floats."""


class Movement(Protocol):
    """What every solver asks of a motion of the fairlead; t in s, number -> (3,) or (S,) -> (3, S)."""

    def displacement(self, t: ArrayLike, /) -> np.ndarray:
        """Return the displacement from the mean position, m."""

    def velocity(self, t: ArrayLike, /) -> np.ndarray:
        """Return the velocity, m/s."""

    def directions(self) -> np.ndarray:
        """Return unit vectors whose combinations hold the motion, (k, 3)."""


@singledispatch
def as_system(given):
    """Return what a solver works on: what is given, or what the room of a scene or network has registered for it.

    Raises InputError for what is neither.
    """
    if not hasattr(given, "nodes"):
        problem = f"{type(given).__name__} is no system, and no Scene or Network, which are taken as one"
        raise InputError(problem, field="system", value=given)
    return given
