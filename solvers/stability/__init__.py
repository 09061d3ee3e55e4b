"""Response curves over a parameter, their folds, and the stability of periodic responses, of any ChainSystem."""

from .curve import Fold, ResponseCurve, response_curve
from .floquet import FloquetResult, floquet

__all__ = [
    "FloquetResult",
    "Fold",
    "ResponseCurve",
    "floquet",
    "response_curve",
]
