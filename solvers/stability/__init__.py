"""Response curves over a parameter, their special points, and the stability of periodic responses of any system."""

from .basins import BasinShares, find_basins, find_landing, responses_at
from .curve import ResponseCurve, response_curve
from .floquet import FloquetResult, floquet
from .special_points import SpecialPoint
from .switching import BranchStart, switch_branch

__all__ = [
    "BasinShares",
    "BranchStart",
    "FloquetResult",
    "ResponseCurve",
    "SpecialPoint",
    "find_basins",
    "find_landing",
    "floquet",
    "response_curve",
    "responses_at",
    "switch_branch",
]
