"""Compact mooring-cable solvers: numpy and scipy, numba for loops over small blocks. Conventions: README.md."""

from .cable import CableSystem, cable_system
from .catenary import CatenaryBatch, CatenaryState, Regime, Span, solve_span, solve_spans
from .harmonic_balance import PeriodicResponse, solve_periodic
from .motion import FunctionMotion, Motion, SampledMotion
from .network import NetworkState, solve_network
from .network_model import Element, Network, Node
from .outcome import ConvergenceError, InputError, Status
from .properties import CableProperties, Environment
from .scene import Scene
from .statics import StaticState, solve_static
from .time_domain import TimeHistory, solve_time_domain

__all__ = [
    "CableProperties",
    "CableSystem",
    "CatenaryBatch",
    "CatenaryState",
    "ConvergenceError",
    "Element",
    "Environment",
    "FunctionMotion",
    "InputError",
    "Motion",
    "Network",
    "NetworkState",
    "Node",
    "PeriodicResponse",
    "Regime",
    "SampledMotion",
    "Scene",
    "Span",
    "StaticState",
    "Status",
    "TimeHistory",
    "cable_system",
    "solve_network",
    "solve_periodic",
    "solve_span",
    "solve_spans",
    "solve_static",
    "solve_time_domain",
]
