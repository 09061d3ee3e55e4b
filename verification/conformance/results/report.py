"""What a run leaves: its report in JSON, whose schema is report.schema.json, and a badge in SVG."""

from __future__ import annotations

import json
from pathlib import Path
from xml.sax.saxutils import escape

from ..judge import INACCURATE, NOT_MODELLED, REFUSED, RIGHT, WRONG

GREEN, AMBER, RED = "#2a7d2e", "#8a6100", "#b3261e"
CHARACTER = 6.6
"""px, about the width of a character of 11 px."""
_BADGE = """<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="20" role="img" aria-label="{title}">
<title>{title}</title>
<rect width="{width}" height="20" rx="3" fill="#444"/>
<path d="M{left} 0h{middle}a3 3 0 0 1 3 3v14a3 3 0 0 1-3 3h-{middle}z" fill="{colour}"/>
<g fill="#fff" font-family="Verdana,DejaVu Sans,sans-serif" font-size="11" text-anchor="middle">
<text x="{x}" y="14">{subject}</text>
<text x="{y}" y="14">{status}</text>
</g>
</svg>
"""


def write_report(path: Path, description: dict):
    """Write the report of a run, run.Run.describe."""
    _write(path, json.dumps(description, indent=1, allow_nan=False) + "\n")


def write_badge(path: Path, description: dict):
    """Write the badge of a run."""
    _write(path, draw_badge(description))


def draw_badge(description: dict) -> str:
    """Return the SVG of a badge: the set, and how many of the cases that the code models are right.

    Red where a test fails or an answer is wrong, amber where one is inaccurate or refused, else green.
    """
    count = description["verdicts"]
    modelled = sum(count.values()) - count.get(NOT_MODELLED, 0)
    subject = f"mooring conformance {description['set']}"
    status = f"{count.get(RIGHT, 0)} of {modelled} right"
    for verdict in (WRONG, INACCURATE):
        status += f", {count[verdict]} {verdict}" if count.get(verdict) else ""
    bad = not description["passed"] or count.get(WRONG)
    colour = RED if bad else AMBER if count.get(INACCURATE) or count.get(REFUSED) else GREEN
    if not modelled:
        status, colour = "nothing judged", RED
    left, right = (round(CHARACTER * len(text) + 12) for text in (subject, status))
    return _BADGE.format(
        width=left + right, left=left, middle=right - 3, x=left / 2, y=left + right / 2, colour=colour,
        subject=escape(subject), status=escape(status), title=escape(f"{subject}: {status}", {'"': "&quot;"}),
    )  # fmt: skip


def _write(path: Path, text: str):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
