"""One elastic line at rest: MSQS section 2."""

from .regimes import Regime
from .span import CatenaryBatch, CatenaryState, Span, solve_span, solve_spans

__all__ = [
    "CatenaryBatch",
    "CatenaryState",
    "Regime",
    "Span",
    "solve_span",
    "solve_spans",
]
