"""Periodic response of a ChainSystem by multi-harmonic balance."""

from .response import PeriodicResponse
from .solve import solve_periodic

__all__ = [
    "PeriodicResponse",
    "solve_periodic",
]
