"""Networks of lines at rest: MSQS sections 3 to 5."""

from .model import Element, Network, Node
from .solve import NetworkState, solve_network

__all__ = [
    "Element",
    "Network",
    "NetworkState",
    "Node",
    "solve_network",
]
