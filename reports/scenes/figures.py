"""The figures of one scene: where the line lies and what tension it carries, and which setting gives which error."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.collections import LineCollection

from ..drawing import style
from ..drawing.axes import clip_error, draw_work_points, set_time_ticks
from ..drawing.style import SEABED, TENSION_COLOURS, WATER
from ..page.figures import Figure, Group
from ..page.numbers import analysis
from ..page.numbers.formatting import number, plural, seconds, slug

EQUAL_UNTIL = 6
"""Width over height up to which both axes have the same scale; a longer picture is stretched, and says so."""

DASHES = ("-", "--", ":", "-.")


def profiles(scene: dict, surroundings: dict, folder: Path) -> Group:
    """Return every line of the scene in its surroundings, the tension in colour; one scale for all of them."""
    top = max(max(line["profile"]["tension"]) for line in scene["lines"]) / 1e3
    figures = [_profile(scene, line, surroundings, top, folder) for line in scene["lines"]]
    figures.append(tension(scene, surroundings, folder))
    sentences = [_sentence(scene, line) for line in scene["lines"]]
    if any(0 < line["grounded_length"] < line["inputs"]["L"] for line in scene["lines"]):
        sentences.append("Triangle: touchdown.")
    return Group(" ".join(sentences), figures)


def _start(scene: dict, line: dict) -> str:
    """Return the label before a sentence about one of several lines."""
    return f"{line['label']}: " if len(scene["lines"]) > 1 else ""


def _sentence(scene: dict, line: dict) -> str:
    grounded, length = line["grounded_length"], line["inputs"]["L"]
    rests = (
        f"{number(grounded, 4)} m of {number(length, 4)} m rest on the seabed"
        if grounded
        else "nothing rests on the seabed"
    )
    ends = line["tension"] / 1e3, np.hypot(line["H_anchor"], line["V_anchor"]) / 1e3
    return (
        f"{_start(scene, line)}{rests}; {number(ends[0], 4)} kN at the fairlead, {number(float(ends[1]), 4)} kN at the "
        "anchor."
    )


def _profile(scene, line, surroundings, top: float, folder: Path) -> Figure:
    x, z, tension = (np.array(line["profile"][key], dtype=float) for key in ("x", "z", "tension"))
    z = z + surroundings["anchor_z"]
    figure, axes = plt.subplots(figsize=(style.PANEL[0], _height(x, z, surroundings)))
    points = np.column_stack([x, z])
    pieces = LineCollection(
        np.stack([points[:-1], points[1:]], axis=1), cmap=TENSION_COLOURS, linewidth=3.2, capstyle="round", zorder=3
    )
    pieces.set_array((tension[:-1] + tension[1:]) / 2e3)
    pieces.set_clim(0, top)
    axes.add_collection(pieces)
    axes.plot(x[[0, -1]], z[[0, -1]], "o", color=style.INK, markersize=5, zorder=4)
    heights = _draw_surroundings(axes, z, surroundings)
    grounded = line["grounded_length"]
    if grounded and grounded < line["inputs"]["L"]:
        at = np.interp(grounded, line["profile"]["s"], x), np.interp(grounded, line["profile"]["s"], z)
        axes.plot(*at, "^", color=style.INK, markersize=8, zorder=5)
    note = _scale(axes, x, heights)
    title = _title(scene, line, "Profile")
    axes.set(
        title=title,
        xlabel="x, m from the anchor",
        ylabel=f"z, m{surroundings['z_note']}{note}",
    )
    bar = figure.colorbar(pieces, ax=axes, location="bottom", aspect=35, shrink=0.9)
    bar.set_label("tension, kN")
    alt = f"Profile of {scene['name']}, {line['label']}, coloured by tension from 0 to {number(top)} kN."
    name = f"scene_{slug(surroundings['stem'])}_profile_{slug(line['label'])}"
    return style.save(figure, folder, name, title, alt)


def _title(scene: dict, line: dict, alone: str) -> str:
    """Return the label of one of several lines, of one alone what the figure shows."""
    return alone if len(scene["lines"]) == 1 else line["label"] or scene["name"]


def _height(x, z, surroundings) -> float:
    """Return inches that fit the picture at equal scales: title, labels and colour bar, then what the line needs."""
    heights = [
        np.nanmin(z),
        np.nanmax(z),
        *(surroundings[key] for key in ("seabed", "water") if surroundings[key] is not None),
    ]
    tall = max(heights) - min(heights)
    return float(np.clip(1.95 + 3.9 * tall / max(np.ptp(x), 1e-9), 2.9, 5.4))


def _draw_surroundings(axes, z, surroundings) -> list[float]:
    """Draw seabed and still water where they are known; return the least and greatest height to show."""
    heights = [float(np.nanmin(z)), float(np.nanmax(z))]
    if surroundings["seabed"] is not None:
        axes.axhline(surroundings["seabed"], color=SEABED, linewidth=1.2, zorder=1)
        axes.annotate("seabed", (0.5, surroundings["seabed"]), (0, -2), xycoords=("axes fraction", "data"),
                      textcoords="offset points", ha="center", va="top", fontsize=9, color=SEABED)  # fmt: skip
        heights.append(surroundings["seabed"])
    if surroundings["water"] is not None:
        axes.axhline(surroundings["water"], color=WATER, linewidth=1.2, zorder=1)
        axes.annotate("still water", (0, surroundings["water"]), (3, -3), xycoords=("axes fraction", "data"),
                      textcoords="offset points", ha="left", va="top", fontsize=9, color=WATER)  # fmt: skip
        heights.append(surroundings["water"])
    return [min(heights), max(heights)]


def _scale(axes, x, heights) -> str:
    """Set the limits; equal scales unless the picture is too long or too tall for it, which the label then says."""
    width, height = float(np.nanmax(x) - np.nanmin(x)), heights[1] - heights[0]
    span = max(width, height, 1e-9)
    axes.set_xlim(
        np.nanmin(x) - 0.04 * max(width, span / EQUAL_UNTIL), np.nanmax(x) + 0.04 * max(width, span / EQUAL_UNTIL)
    )
    margin = 0.06 * max(height, span / 100)
    axes.set_ylim(heights[0] - 3.5 * margin, heights[1] + 1.5 * margin)
    if span <= EQUAL_UNTIL * min(width, height):
        axes.set_aspect("equal")
        return ""
    return " (enlarged)"


def tension(scene: dict, surroundings: dict, folder: Path) -> Figure:
    """Return tension along the line from the anchor, all lines of the scene together."""
    figure, axes = plt.subplots(figsize=style.PANEL)
    for line, dash, colour in zip(scene["lines"], DASHES * 9, style.PALETTE * 9, strict=False):
        curve = line["profile"]
        axes.plot(curve["s"], np.array(curve["tension"]) / 1e3, dash, color=colour, label=line["label"], linewidth=2)
    axes.set(xlabel="s, m of unstretched line from the anchor", ylabel="tension, kN")
    axes.set_ylim(0, max(1.06 * axes.dataLim.ymax, 1e-9))
    axes.set_title("Tension along the line")
    if len(scene["lines"]) > 1:
        figure.legend(loc="outside upper center", ncols=2)
    name, title = f"scene_{slug(surroundings['stem'])}_tension", "Tension along the line"
    return style.save(figure, folder, name, title, f"Tension along {scene['name']} from the anchor to the fairlead.")


def ladder(scene: dict, surroundings: dict, looks: dict, folder: Path) -> Group:
    """Return error against time of every setting, with the scene's tolerance and the cheapest setting within it."""
    figures, sentences = [], []
    for line in scene["lines"]:
        sentences.append(_ladder_sentence(scene, line))
        if analysis.select_answered(line["ladder"]):
            figures.append(_ladder_panel(scene, line, surroundings, looks, folder))
    sentences.append(
        "Dashed: the tolerance of the scene. Star: the cheapest setting that meets it. Rings: the Pareto front."
    )
    return Group(" ".join(sentences), figures)


def _ladder_panel(scene, line, surroundings, looks, folder) -> Figure:
    figure, axes = plt.subplots(figsize=style.PANEL)
    draw_work_points(axes, line["ladder"], looks)
    axes.axhline(scene["tolerance"], color=style.INK, linestyle="--", linewidth=1)
    best = analysis.find_cheapest(line["ladder"], scene["tolerance"])
    if best:
        axes.plot(1e6 * best["seconds"], clip_error(best), "*", color=style.RECOMMENDED, markeredgecolor=style.INK,
                  markersize=14, zorder=6)  # fmt: skip
    title = _title(scene, line, "Error against run time")
    axes.set_title(title)
    set_time_ticks(axes)
    name = f"scene_{slug(surroundings['stem'])}_ladder_{slug(line['label'])}"
    return style.save(figure, folder, name, title, f"Error against run time: {_start(scene, line)}{scene['name']}.")


def _ladder_sentence(scene: dict, line: dict) -> str:
    tolerance = scene["tolerance"]
    best, start = analysis.find_cheapest(line["ladder"], tolerance), _start(scene, line)
    refused = sum(p["verdict"] == "refused" for p in line["ladder"])
    end = f" {plural(refused, 'setting')} refused." if refused else ""
    if not best:
        return f"{start}no setting meets the tolerance of {number(tolerance)}.{end}"
    setting = "with its default" if best["tolerance"] is None else f"at tolerance {number(best['tolerance'], 1)}"
    return (
        f"{start}cheapest setting within {number(tolerance, 1)}: {best['label']} {setting}, "
        f"{seconds(best['seconds'])}, error {number(best['error'], 2)}.{end}"
    )
