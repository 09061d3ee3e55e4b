"""Compact mooring-cable solvers: numpy and scipy only. See README.md for the conventions."""

from .catenary import CatenaryBatch, CatenaryState, Regime, Span, solve_span, solve_spans
from .motion import Motion, SampledMotion
from .network import NetworkState, solve_network
from .network_model import Element, Network, Node
from .outcome import ConvergenceError, InputError, Status
from .properties import CableProperties, Environment
from .scene import Scene

__all__ = [
    "CableProperties",
    "CatenaryBatch",
    "CatenaryState",
    "ConvergenceError",
    "Element",
    "Environment",
    "InputError",
    "Motion",
    "Network",
    "NetworkState",
    "Node",
    "Regime",
    "SampledMotion",
    "Scene",
    "Span",
    "Status",
    "solve_network",
    "solve_span",
    "solve_spans",
]
