"""The cases, methods and lines of the section on moving lines, as the page names and draws them."""

from __future__ import annotations

from functools import partial

from ..cable import cases as cable_cases
from ..drawing import style

CASES = cable_cases.CASES
"""Cases of the paper; those over a seabed have their titles in the results."""
GROWING = "case 1"
METHODS = {
    "in time": {"color": style.PALETTE[1], "marker": "s"},
    "in time, extrapolated": {"color": style.PALETTE[4], "marker": "X"},
    "harmonic balance": {"color": style.PALETTE[0], "marker": "o"},
    "harmonic balance, extrapolated": {"color": style.PALETTE[3], "marker": "P"},
    "box scheme, in time": {"color": style.PALE, "marker": "v"},
    "box scheme, harmonic balance, corrected": {"color": style.PALETTE[5], "marker": "^"},
    "MoorDyn": {"color": style.PALETTE[2], "marker": "D"},
}
LEGEND = {
    "harmonic balance": "harmonic balance (HB)",
    "harmonic balance, extrapolated": "HB, extrapolated",
    "box scheme, harmonic balance, corrected": "box scheme, HB corrected",
}
"""Names of methods that are too long for a legend."""
OWN = tuple(METHODS)[:4]
"""Methods of nodes and elements."""


save = partial(style.save_in_section, "mooring")
"""Write a figure as style.save does, under the names that all figures of this section have."""
save_network = partial(style.save_in_section, "mooring_networks")
"""As ``save``, of the section on moving networks."""


def describe_history(change: float | None, periodic: float) -> str:
    """Return whether a history has become periodic; change: of its last period from the one before, over the range."""
    return "" if change is None else "periodic" if change <= periodic else "not periodic yet"
