"""One elastic line at rest: MSQS section 2."""

from .span import CatenaryBatch, CatenaryState, Regime, Span, solve_span, solve_spans

__all__ = [
    "CatenaryBatch",
    "CatenaryState",
    "Regime",
    "Span",
    "solve_span",
    "solve_spans",
]
