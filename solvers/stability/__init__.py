"""Response curves over a parameter, their special points, and the stability of periodic responses of any system."""

from .curves.basins import BasinShares, find_basins, find_landing, responses_at
from .curves.curve import ResponseCurve, response_curve
from .curves.special_points import SpecialPoint
from .curves.switching import BranchStart, switch_branch
from .multipliers.floquet import FloquetResult, floquet

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
