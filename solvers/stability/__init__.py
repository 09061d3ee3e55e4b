"""Response curves over a parameter, their special points, and the stability of periodic responses of any system."""

from .curve import ResponseCurve, response_curve
from .floquet import FloquetResult, floquet
from .special_points import SpecialPoint
from .switching import BranchStart, switch_branch

__all__ = [
    "BranchStart",
    "FloquetResult",
    "ResponseCurve",
    "SpecialPoint",
    "floquet",
    "response_curve",
    "switch_branch",
]
