"""Time integration of a ChainSystem by the generalized-alpha method."""

from .generalized_alpha import Scheme
from .solve import TimeHistory, solve_time_domain

__all__ = [
    "Scheme",
    "TimeHistory",
    "solve_time_domain",
]
