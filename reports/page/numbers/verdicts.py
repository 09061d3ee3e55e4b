"""A verdict of the summary: one measured figure per claim, and whether it is within the bound set for it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Verdict:
    """value : as measured; good : within the bound (None: no bound); anchor : where the page shows it.

    part : id of the part of the page it belongs to; empty: that of its section
    """

    value: str
    label: str
    detail: str
    good: bool | None
    anchor: str
    part: str = ""
