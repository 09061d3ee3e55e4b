"""Moving lines of nodes and elements: implicit, compiled, through slack and over the seabed."""

from .statics import MooringState
from .stepping.history import MooringHistory, Slack
from .system import MooringSystem, mooring_system

__all__ = ["MooringHistory", "MooringState", "MooringSystem", "Slack", "mooring_system"]
