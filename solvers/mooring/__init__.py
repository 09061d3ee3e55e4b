"""Moving lines of nodes and elements: implicit, compiled, through slack and over the seabed."""

from .linearised.impedance import harmonic_impedance, mooring_impedance, mooring_stiffness
from .statics import MooringState
from .stepping.history import MooringHistory, Slack
from .system import MooringSystem, mooring_system

__all__ = [
    "MooringHistory",
    "MooringState",
    "MooringSystem",
    "Slack",
    "harmonic_impedance",
    "mooring_impedance",
    "mooring_stiffness",
    "mooring_system",
]
