"""Compact mooring-cable solvers: numpy and scipy only. See README.md for the conventions."""

from .catenary import CatenaryBatch, CatenaryState, Regime, Span, solve_span, solve_spans
from .outcome import ConvergenceError, InputError, Status
from .properties import CableProperties, Environment
from .scene import Scene

__all__ = [
    "CableProperties",
    "CatenaryBatch",
    "CatenaryState",
    "ConvergenceError",
    "Environment",
    "InputError",
    "Regime",
    "Scene",
    "Span",
    "Status",
    "solve_span",
    "solve_spans",
]
