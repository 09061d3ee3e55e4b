"""The cases of the paper and the methods for them, as the page names and draws them."""

from __future__ import annotations

from functools import partial

from ..drawing import style

CASES = {
    "case_1": "Case 1: surge 5 m",
    "case_2": "Case 2: heave 5 m",
    "case_3": "Case 3: sway 5 m",
    "case_4": "Case 4: surge and sway",
    "case_1_large": "Surge 9 m",
}
METHODS = {
    "harmonic balance": {"color": style.PALETTE[0], "marker": "o"},
    "harmonic balance, corrected": {"color": style.PALETTE[3], "marker": "P"},
    "time domain": {"color": style.PALETTE[1], "marker": "s"},
    "time domain, extrapolated": {"color": style.PALETTE[1], "marker": "X"},
    "MoorDyn": {"color": style.PALETTE[2], "marker": "D"},
    "reference": {"color": style.INK, "marker": ""},
}


def motion_of(case: str) -> str:
    """Return the motion of a case: "Surge 5 m" of "Case 1: surge 5 m"."""
    return CASES[case].split(": ")[-1].capitalize()


save = partial(style.save_in_section, "dynamics")
"""Write a figure as style.save does, under the names that all figures of moving cables have."""
