"""The figures of a network file: the lines in space and from above, tensions in time and their harmonics, settings."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.collections import LineCollection
from mpl_toolkits.mplot3d.art3d import Line3DCollection

from ..cable.cases import METHODS
from ..drawing import style
from ..drawing.axes import KN, add_legend, panel, set_decade_ticks
from ..network.pictures import draw_network
from ..page.analysis import pareto_front
from ..page.figures import Figure, Group
from ..page.formatting import number, plural
from .network_settings import OWN, count_outcomes

SHOWN_TRAVEL = 0.05  # of the width of a picture, to which the motion of a line is enlarged
NICE = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)
NEAR, ROOM = 0.15, 1.35  # of the width: nodes around the body that the close view shows; its half width over theirs
DASHES = ("-", "--", ":", "-.")
MOST_NAMES = 24  # of nodes in a picture
SMALLEST = 1e-6  # of the largest harmonic, below which nothing is drawn


def pictures(report: dict, name: str, folder: Path) -> Group:
    """Return the lines in space, from above, and from above around the body, with the envelope of their motion."""
    row = report["picture"] | {"name": name, "title": "In space", "near": None}
    poses = report.get("envelope")
    factor = _enlargement(report)
    draw = None if poses is None else lambda axes: _draw_poses_in_space(axes, poses, factor)
    with plt.rc_context({"figure.constrained_layout.use": False}):
        figures = [draw_network(row, f"{name}_space", folder, draw)]
    top = max(max(element["tension"]) for element in row["elements"])
    figures.append(_from_above(report, f"{name}_above", folder, factor, None, top))
    if (view := _close_view(row)) is not None:
        figures.append(_from_above(report, f"{name}_body", folder, 1, view, top))
    return Group(_caption(report, factor), figures)


def _caption(report: dict, factor: int) -> str:
    colours = "Colour: the tension at rest."
    if "envelope" not in report:
        return colours
    travel = max(report["envelope"]["travel"])
    times = f", enlarged {factor} times but in the view around the body" if factor > 1 else ""
    return (
        f"{colours} Thin lines: where the lines are within {'a period' if report['period'] else 'the series'}, in "
        f"which none moves further than {number(travel)} m from rest{times}."
    )


def _enlargement(report: dict) -> int:
    """Return how many times motions are enlarged to be seen beside the size of the network."""
    travel = max(report["envelope"]["travel"]) if "envelope" in report else 0.0
    wanted = SHOWN_TRAVEL * _width(report["picture"]) / travel if travel else 1.0
    return max(n for n in NICE if n <= max(1.0, wanted))


def _width(picture: dict) -> float:
    """Return the largest extent of the lines in x or y, m."""
    return max(np.ptp(np.concatenate([element[axis] for element in picture["elements"]])) for axis in "xy")


def _poses(envelope: dict, factor: int):
    """Yield positions (3, points) of each line at each instant, their displacements from rest multiplied."""
    for pose in envelope["poses"]:
        for moved, rest in zip(pose, envelope["rest"], strict=True):
            yield np.array(rest) + factor * (np.array(moved) - np.array(rest))


def _draw_poses_in_space(axes, envelope: dict, factor: int):
    pieces = [line.T for line in _poses(envelope, factor)]
    axes.add_collection3d(Line3DCollection(pieces, colors=style.PALE, linewidths=0.6, alpha=0.6, zorder=1))


def _close_view(picture: dict):
    """Return (centre (2,), half width) around the coupled nodes and what is near them, m; None where that is all."""
    coupled = np.array([node["r"][:2] for node in picture["nodes"] if node["kind"] == "coupled"])
    if not coupled.size:
        return None
    centre, width = coupled.mean(axis=0), _width(picture)
    away = np.linalg.norm(np.array([n["r"][:2] for n in picture["nodes"] if n["kind"] != "fixed"]) - centre, axis=1)
    near = away[away <= NEAR * width]
    half = ROOM * max(float(near.max(initial=0.0)), 0.01 * width)
    return None if half > NEAR * ROOM * width else (centre, half)


def _from_above(report: dict, name: str, folder: Path, factor: int, view, top: float) -> Figure:
    """Return the lines from above, whole or within a view (centre, half width), node names beside the nodes."""
    title = "From above" if view is None else "From above, around the body"
    figure, axes = plt.subplots(figsize=(4.7, 4.3))
    picture = report["picture"]
    if "envelope" in report:
        pieces = [line[:2].T for line in _poses(report["envelope"], factor)]
        axes.add_collection(LineCollection(pieces, colors=style.PALE, linewidths=0.6, alpha=0.6, zorder=1))
    points = [np.column_stack([e["x"], e["y"]]) for e in picture["elements"]]
    tension = [np.array(e["tension"]) for e in picture["elements"]]
    lines = LineCollection(
        np.concatenate([np.stack([p[:-1], p[1:]], axis=1) for p in points]),
        cmap=style.TENSION_COLOURS, linewidths=2.4, capstyle="round", zorder=3)  # fmt: skip
    lines.set_array(np.concatenate([(t[:-1] + t[1:]) / 2 for t in tension]) * KN)
    lines.set_clim(0, KN * top or 1.0)
    axes.add_collection(lines)
    _draw_nodes(axes, picture["nodes"], view)
    axes.set(title=title, xlabel="x, m", ylabel="y, m")
    _set_view(axes, np.concatenate(points), view)
    figure.colorbar(lines, ax=axes, location="bottom", aspect=35, shrink=0.9).set_label("tension at rest, kN")
    alt = f"{report['name']} from above{'' if view is None else ', around the body'}, coloured by the tension at rest."
    return style.save(figure, folder, name, title, alt)


def _draw_nodes(axes, nodes: list[dict], view):
    """Draw markers by kind; names of the fixed ones where all is seen, in the close view those of all within it."""
    for kind, marker in (("fixed", "s"), ("free", "o"), ("coupled", "^")):
        places = np.array([node["r"][:2] for node in nodes if node["kind"] == kind]).reshape(-1, 2)
        face = "none" if kind == "free" else style.INK
        axes.scatter(*places.T, s=24, marker=marker, facecolor=face, edgecolor=style.INK, zorder=5, label=kind)
    named = [n for n in nodes if n["kind"] == "fixed"] if view is None else [
        n for n in nodes if np.abs(np.array(n["r"][:2]) - view[0]).max() < view[1]]  # fmt: skip
    middle = np.mean([node["r"][:2] for node in nodes], axis=0) if view is None else view[0]
    by_place: dict[tuple, list[str]] = {}
    for node in named[:MOST_NAMES]:
        by_place.setdefault((round(node["r"][0], 2), round(node["r"][1], 2)), []).append(node["name"])
    for place, names in by_place.items():
        right, up = np.sign(np.round(np.array(place) - middle, 3))
        inward = view is None  # at the rim of the picture names have room towards its middle
        side = {1.0: "right", -1.0: "left"} if inward else {1.0: "left", -1.0: "right"}
        axes.annotate(
            "\n".join(names), place, (-6 * right if inward else 6 * right, 7 * up if up else 7),
            textcoords="offset points", ha=side.get(right, "center"), va="bottom" if up >= 0 else "top", fontsize=8,
            zorder=6)  # fmt: skip


def _set_view(axes, points, view):
    if view is None:
        low, high = points.min(axis=0), points.max(axis=0)
        centre, half = (low + high) / 2, np.maximum(0.56 * (high - low), 0.12 * (high - low).max())
    else:
        centre, half = view[0], np.array([view[1], view[1]])
    axes.set_xlim(centre[0] - half[0], centre[0] + half[0])
    axes.set_ylim(centre[1] - half[1], centre[1] + half[1])
    axes.set_aspect("equal")


def _looks(lines: list[str]) -> list[dict]:
    colours = len(style.PALETTE)
    return [{"color": style.PALETTE[i % colours], "linestyle": DASHES[i // colours % len(DASHES)]}
            for i in range(len(lines))]  # fmt: skip


def tensions(report: dict, name: str, folder: Path) -> Group:
    """Return the tension at the fairlead end of every line over the last period, or the series."""
    waves = report["waveforms"]
    title = "Tension at the fairlead end" + (" over a period" if report["period"] else "")
    figure, axes = plt.subplots(figsize=style.WIDE)
    for line, wave, look in zip(report["lines"], waves["tension"], _looks(report["lines"]), strict=True):
        axes.plot(waves["time"], KN * np.array(wave), label=line, **look)
    axes.set(title=title, xlabel="time, s", ylabel="tension, kN")
    axes.set_xlim(0, waves["time"][-1])
    add_legend(figure, axes, 3)
    alt = f"{title} of {plural(len(report['lines']), 'line')} of {report['name']}."
    return Group(
        "Converged in mesh and step; one curve a line.", [style.save(figure, folder, f"{name}_tension", title, alt)]
    )


def harmonics(report: dict, name: str, folder: Path) -> Figure | None:
    """Return the amplitudes of the harmonics of every line's tension; None of a series."""
    if report["waveforms"]["harmonics"] is None:
        return None
    title, amplitudes = "Harmonics of the tension", KN * np.array(report["waveforms"]["harmonics"])[:, 1:]
    figure, axes = panel(title, "harmonic of the frequency", "amplitude, kN", yscale="log")
    number_of, least = np.arange(1, amplitudes.shape[1] + 1), SMALLEST * amplitudes.max()
    for line, row, look in zip(report["lines"], amplitudes, _looks(report["lines"]), strict=True):
        axes.plot(number_of, np.where(row > least, row, np.nan), marker="o", markersize=3.5, linewidth=0.8, label=line,
                  **look)  # fmt: skip
    axes.set_xticks(number_of)
    return style.save(figure, folder, f"{name}_harmonics", title, f"{title} of every line, 1 to {number_of.size}.")


def work(report: dict, name: str, folder: Path) -> Figure:
    """Return error against run time of every setting, the tolerance and the recommended setting."""
    title = "Error against run time"
    figure, axes = panel(title, "run time, s", "error / largest tension", xscale="log", yscale="log")
    solved = [row for row in report["ladder"] if row["error"] and row["seconds"]]
    for method, look in style.add_missing_looks(METHODS, dict.fromkeys(row["method"] for row in solved)).items():
        rows = [row for row in solved if row["method"] == method]
        if rows:
            axes.plot([r["seconds"] for r in rows], [r["error"] for r in rows], look["marker"], label=method,
                      color=look["color"])  # fmt: skip
    front = pareto_front([row for row in solved if row["method"] in OWN])
    axes.plot([r["seconds"] for r in front], [r["error"] for r in front], "o", markerfacecolor="none",
              markeredgecolor=style.INK, markersize=10)  # fmt: skip
    axes.axhline(report["tolerance"], color=style.INK, linestyle="--", linewidth=1)
    best = report["recommended"]
    if best and best["error"]:
        axes.plot(best["seconds"], best["error"], "*", color=style.RECOMMENDED, markeredgecolor=style.INK,
                  markersize=14, zorder=6)  # fmt: skip
    set_decade_ticks(axes)
    add_legend(figure, axes)
    return style.save(figure, folder, f"{name}_work", title, f"{title} of {plural(len(solved), 'setting')}.")


def details(report: dict, name: str, folder: Path) -> Group:
    """Return harmonics and error against run time side by side."""
    figures = [figure for figure in (harmonics(report, name, folder), work(report, name, folder)) if figure]
    lines = "Harmonics in the colours of the tensions above. " if len(figures) > 1 else ""
    return Group(f"{lines}{count_outcomes(report['ladder'])}. Dashed: the tolerance. Star: the recommended setting. "
                 "Ringed: the Pareto front of this project.", figures)  # fmt: skip
