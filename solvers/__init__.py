"""Compact mooring-cable solvers: numpy and scipy, numba for loops over small blocks. Conventions: README.md."""

from importlib.metadata import PackageNotFoundError as _PackageNotFoundError
from importlib.metadata import version as _version

from .cable.statics import StaticState, solve_static
from .cable.system import CableSystem, cable_system
from .catenary.span import CatenaryBatch, CatenaryState, Regime, Span, solve_span, solve_spans
from .common.motions.body_motion import BodyMotion
from .common.motions.motion import FunctionMotion, Motion, SampledMotion
from .common.outcome import ConvergenceError, InputError, Status
from .common.properties import CableProperties, Environment
from .harmonic_balance.solve import PeriodicResponse, solve_periodic
from .io.scene import Scene
from .load_cases.solve import solve_load_cases
from .mooring.system import MooringSystem, mooring_system
from .network.model import Element, Network, Node
from .network.solve import NetworkState, solve_network
from .stability.curves.curve import ResponseCurve, response_curve
from .time_domain.history import TimeHistory
from .time_domain.solve import solve_time_domain

__all__ = [
    "BodyMotion",
    "CableProperties",
    "CableSystem",
    "CatenaryBatch",
    "CatenaryState",
    "ConvergenceError",
    "Element",
    "Environment",
    "FunctionMotion",
    "InputError",
    "MooringSystem",
    "Motion",
    "Network",
    "NetworkState",
    "Node",
    "PeriodicResponse",
    "Regime",
    "ResponseCurve",
    "SampledMotion",
    "Scene",
    "Span",
    "StaticState",
    "Status",
    "TimeHistory",
    "__version__",
    "cable_system",
    "mooring_system",
    "response_curve",
    "solve_load_cases",
    "solve_network",
    "solve_periodic",
    "solve_span",
    "solve_spans",
    "solve_static",
    "solve_time_domain",
]

try:
    __version__ = _version("mooring-verification")  # stated by pyproject.toml alone
except _PackageNotFoundError:  # imported from a folder that was never installed
    __version__ = "unknown"
