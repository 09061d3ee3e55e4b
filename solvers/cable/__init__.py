"""The moving cable of the HB paper on the box scheme, and its equilibrium."""

from .statics import StaticState, solve_static
from .system import CableSystem, cable_system

__all__ = [
    "CableSystem",
    "StaticState",
    "cable_system",
    "solve_static",
]
