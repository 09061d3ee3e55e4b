"""Conformance of a mooring code: what outside solvers are judged by; it takes numpy and pytest, and no solver of ours.

``pytest --pyargs verification.conformance --solver my_code.py`` judges a code; adapter.py says what it has to have.
"""

from .adapter import (
    INSTANTS,
    LIMITS,
    Adapter,
    CableAnswer,
    MovingNetworkAnswer,
    NetworkAnswer,
    Refused,
    SpanAnswer,
)
from .process.program import Program

__all__ = [
    "INSTANTS",
    "LIMITS",
    "Adapter",
    "CableAnswer",
    "MovingNetworkAnswer",
    "NetworkAnswer",
    "Program",
    "Refused",
    "SpanAnswer",
]
