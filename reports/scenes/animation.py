"""Lines as they move, from the side and from above: drawings that the browser animates; on paper they stand still.

SVG's own animation of the points of polylines: no script but one line, which halts it for readers who want no motion.
"""

from __future__ import annotations

from dataclasses import dataclass
from html import escape

import numpy as np

from ..page.numbers.formatting import number

LEFT, WIDTH, HEIGHT = 0.0, 440.0, 260.0  # of a drawing, in its own units
MARGIN = 14.0
SLOWEST, QUICKEST = 20.0, 2.0  # s that a period, or a series, takes on the page
FLATTEST = 6  # width over height, beyond which heights are enlarged
PLANES = {"From the side": (0, 2), "From above": (0, 1)}
FLAT = 1e-3  # of the width: less in a plane's second coordinate is nothing to see


@dataclass
class Animation:
    """One drawing: its title, the SVG element to embed, and what it shows, in words."""

    title: str
    svg: str
    alt: str


def animate(envelope: dict, name: str, duration: float, factor: int, seabed: float | None) -> list[Animation]:
    """Return the views of lines whose poses are known, at some instants of a duration in s.

    envelope: "rest", (3, points) m of each line, and "poses", such lists of lines; factor: by which displacements from
    rest are multiplied. A view in which all lines coincide with an axis is left out.
    """
    rest = [np.array(line) for line in envelope["rest"]]
    poses = [[r + factor * (np.array(line) - r) for line, r in zip(pose, rest, strict=True)]
             for pose in envelope["poses"]]  # fmt: skip
    made = []
    for title, axes in PLANES.items():
        every = np.concatenate([line[list(axes)] for pose in [rest, *poses] for line in pose], axis=1)
        if np.ptp(every[1]) >= FLAT * np.ptp(every[0]):
            levels = {"seabed": seabed, "water": 0.0} if axes[1] == 2 else {}
            svg, note = _draw(rest, poses, axes, every, duration, levels, f"{name}, moving, {title.lower()}")
            made.append(Animation(title + note, svg, f"{name}, moving, {title.lower()}"))
    return made


def _draw(rest, poses, axes, every, duration: float, levels: dict, alt: str) -> tuple[str, str]:
    heights = [level for level in levels.values() if level is not None]
    low = np.array([every[0].min(), min([every[1].min(), *heights])])
    high = np.array([every[0].max(), max([every[1].max(), *heights])])
    size = np.maximum(high - low, 1e-9)
    enlarged = size[0] > FLATTEST * size[1]
    scale = (np.array([WIDTH, HEIGHT]) - 2 * MARGIN) / size
    scale = scale if enlarged else np.full(2, scale.min())
    height = 2 * MARGIN + scale[1] * size[1]
    middle = (WIDTH - scale[0] * size[0]) / 2

    def points(line) -> str:
        x = middle + scale[0] * (line[axes[0]] - low[0])
        y = height - MARGIN - scale[1] * (line[axes[1]] - low[1])
        return " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True))

    seconds = min(max(duration, QUICKEST), SLOWEST)
    parts = []
    for kind, level in levels.items():
        if level is not None:
            y = height - MARGIN - scale[1] * (level - low[1])
            parts.append(f'<line class="{kind}" x1="{LEFT:g}" x2="{WIDTH:g}" y1="{y:.1f}" y2="{y:.1f}"/>')
    for e, line in enumerate(rest):
        values = ";".join(points(pose[e]) for pose in [*poses, poses[0]])
        parts.append(f'<polyline class="rest" points="{points(line)}"/>')
        parts.append(f'<polyline class="line" points="{points(poses[0][e])}"><animate attributeName="points" '
                     f'dur="{seconds:g}s" repeatCount="indefinite" values="{values}"/></polyline>')  # fmt: skip
    head = (
        f'<svg class="moving" viewBox="{LEFT:g} {LEFT:g} {WIDTH:g} {height:.0f}" role="img" aria-label="{escape(alt)}">'
    )
    svg = f"{head}{''.join(parts)}</svg>"
    across = "heights" if axes[1] == 2 else "widths"
    return svg, f", {across} enlarged" if enlarged else ""


def caption(duration: float, factor: int, span: str) -> str:
    """Return what the drawings show and at which speed; span: words for the time shown, such as "A period"."""
    shown = min(max(duration, QUICKEST), SLOWEST)
    speed = duration / shown
    pace = "in real time" if abs(speed - 1) < 0.01 else f"{number(speed, 2)} times as fast"  # fmt: skip
    pace = pace if speed >= 0.99 else f"{number(1 / speed, 2)} times as slow"
    times = (
        f"; displacements from rest (dashed) enlarged {factor} times, which may draw them below a seabed"
        if factor > 1
        else "; dashed: at rest"
    )
    return f"{span} of {number(duration)} s, {pace}{times}."
