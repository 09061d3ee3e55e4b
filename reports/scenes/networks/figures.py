"""The figures of a network file: the lines in space and from above, tensions in time and their harmonics, settings."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.collections import LineCollection
from mpl_toolkits.mplot3d.art3d import Line3DCollection

from ...cable.cases import METHODS
from ...drawing import style
from ...drawing.axes import KN, add_legend, panel, set_decade_ticks
from ...network.pictures import draw_network
from ...page.figures import Figure, Group
from ...page.numbers.analysis import pareto_front
from ...page.numbers.formatting import number, plural
from .settings import OWN, STAR, count_outcomes, find_hidden_errors

SHOWN_TRAVEL = 0.05  # of the width of a picture, to which the motion of a line is enlarged
NICE = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)
NEAR, ROOM = 0.15, 1.35  # of the width: nodes around the body that the close view shows; its half width over theirs
DASHES = ("-", "--", ":", "-.")
FLAT = 1e-3  # of the width: less in y is none
FLATTEST = 6  # width over height of a side view, beyond which its heights are enlarged
MOST_NAMES = 24  # of nodes in a picture
SMALLEST = 1e-6  # of the largest harmonic, below which nothing is drawn


def pictures(report: dict, name: str, folder: Path) -> Group:
    """Return the lines in space, from above, and from above around the body, with the envelope of their motion."""
    row = report["picture"] | {"name": name, "title": "In space", "near": None}
    poses = report.get("envelope")
    factor = enlargement(poses)
    draw = None if poses is None else lambda axes: _draw_poses_in_space(axes, poses, factor)
    with plt.rc_context({"figure.constrained_layout.use": False}):
        figures = [draw_network(row, f"{name}_space", folder, draw)]
    top = max(max(element["tension"]) for element in row["elements"])
    planes = {"xy": "From above", "xz": "From the side"}
    if _is_flat(row):
        del planes["xy"]
    for k, (plane, title) in enumerate(planes.items()):
        figures.append(_projection(report, f"{name}_{plane}", folder, title, factor, top, plane, has_names=k == 0))
        view = _close_view(row, plane) if k == 0 else None
        if view is not None:
            title = f"{title}, around the body"
            figures.append(_projection(report, f"{name}_body", folder, title, 1, top, plane, view))
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


def enlargement(envelope: dict | None) -> int:
    """Return how many times motions are enlarged to be seen beside the size of the lines; envelope: rest and poses."""
    if envelope is None:
        return 1
    rest = [np.array(line) for line in envelope["rest"]]
    pairs = ((np.array(line), r) for pose in envelope["poses"] for line, r in zip(pose, rest, strict=True))
    travel = max(np.linalg.norm(line - r, axis=0).max() for line, r in pairs)
    wanted = SHOWN_TRAVEL * max(np.ptp(np.concatenate(rest, axis=1)[:2], axis=1)) / travel if travel else 1.0
    return max(n for n in NICE if n <= max(1.0, wanted))


def _width(picture: dict) -> float:
    """Return the largest extent of the lines in x or y, m."""
    return max(np.ptp(np.concatenate([element[axis] for element in picture["elements"]])) for axis in "xy")


def _is_flat(picture: dict) -> bool:
    """Return whether all lines lie in a plane of constant y, which shows nothing from above."""
    return np.ptp(np.concatenate([element["y"] for element in picture["elements"]])) < FLAT * _width(picture)


def _poses(envelope: dict, factor: int):
    """Yield positions (3, points) of each line at each instant, their displacements from rest multiplied."""
    for pose in envelope["poses"]:
        for moved, rest in zip(pose, envelope["rest"], strict=True):
            yield np.array(rest) + factor * (np.array(moved) - np.array(rest))


def _draw_poses_in_space(axes, envelope: dict, factor: int):
    pieces = [line.T for line in _poses(envelope, factor)]
    axes.add_collection3d(Line3DCollection(pieces, colors=style.PALE, linewidths=0.6, alpha=0.6, zorder=1))


def _close_view(picture: dict, plane: str):
    """Return (centre (2,), half width) around the coupled nodes and what is near them, m; None where that is all."""
    coupled = np.array([_in_plane(node, plane) for node in picture["nodes"] if node["kind"] == "coupled"])
    if not coupled.size:
        return None
    centre, width = coupled.mean(axis=0), _width(picture)
    others = np.array([_in_plane(node, plane) for node in picture["nodes"] if node["kind"] != "fixed"])
    away = np.linalg.norm(others - centre, axis=1)
    near = away[away <= NEAR * width]
    half = ROOM * max(float(near.max(initial=0.0)), 0.01 * width)
    return None if half > NEAR * ROOM * width else (centre, half)


def _in_plane(node: dict, plane: str) -> np.ndarray:
    return np.array([node["r"]["xyz".index(axis)] for axis in plane])


def _projection(report, name: str, folder: Path, title: str, factor: int, top: float, plane: str, view=None,
                has_names=True) -> Figure:  # fmt: skip
    """Return the lines in a plane, whole or within a view (centre (2,), half width) in m, with names of nodes."""
    picture = report["picture"]
    points = [np.column_stack([element[axis] for axis in plane]) for element in picture["elements"]]
    figure, axes = plt.subplots(figsize=(4.7, _height_of_side_view(points) if plane == "xz" and view is None else 4.3))
    if "envelope" in report:
        kept = ["xyz".index(axis) for axis in plane]
        pieces = [line[kept].T for line in _poses(report["envelope"], factor)]
        axes.add_collection(LineCollection(pieces, colors=style.PALE, linewidths=0.6, alpha=0.6, zorder=1))
    tension = [np.array(element["tension"]) for element in picture["elements"]]
    lines = LineCollection(
        np.concatenate([np.stack([p[:-1], p[1:]], axis=1) for p in points]),
        cmap=style.TENSION_COLOURS, linewidths=2.4, capstyle="round", zorder=3)  # fmt: skip
    lines.set_array(np.concatenate([(t[:-1] + t[1:]) / 2 for t in tension]) * KN)
    lines.set_clim(0, KN * top or 1.0)
    axes.add_collection(lines)
    _draw_nodes(axes, picture["nodes"], plane)
    if has_names:
        _name_nodes(axes, picture["nodes"], plane, view)
    if plane == "xz" and picture["seabed"] is not None:
        axes.axhline(picture["seabed"], color=style.SEABED, linewidth=1.2, zorder=1)
    enlarged = _set_limits(axes, np.concatenate(points), view, plane)
    axes.set(title=title, xlabel="x, m", ylabel=f"{plane[1]}, m{enlarged}")
    figure.colorbar(lines, ax=axes, location="bottom", aspect=35, shrink=0.9).set_label("tension at rest, kN")
    return style.save(figure, folder, name, title, f"{report['name']}, {title.lower()}, coloured by tension at rest.")


def _height_of_side_view(points) -> float:
    """Return inches that title, labels and colour bar take, and the lines at equal scales; of a flat view as usual."""
    across, up = np.ptp(np.concatenate(points), axis=0)
    return 3.2 if across > FLATTEST * up else float(np.clip(1.75 + 3.8 * up / max(across, 1e-9), 2.3, 4.3))


def _draw_nodes(axes, nodes: list[dict], plane: str):
    """Draw markers by kind."""
    for kind, marker in (("fixed", "s"), ("free", "o"), ("coupled", "^")):
        places = np.array([_in_plane(node, plane) for node in nodes if node["kind"] == kind]).reshape(-1, 2)
        face = "none" if kind == "free" else style.INK
        axes.scatter(*places.T, s=24, marker=marker, facecolor=face, edgecolor=style.INK, zorder=5, label=kind)


def _name_nodes(axes, nodes: list[dict], plane: str, view):
    """Write the names of the fixed nodes where all is seen, in a close view those of all nodes within it."""
    places = [_in_plane(node, plane) for node in nodes]
    if view is None:
        middle, is_named = np.mean(places, axis=0), [node["kind"] == "fixed" for node in nodes]
    else:
        middle, is_named = view[0], [abs(place - view[0]).max() < view[1] for place in places]
    named = [(node, place) for node, place, yes in zip(nodes, places, is_named, strict=True) if yes]
    by_place: dict[tuple, list[str]] = {}
    for node, place in named[:MOST_NAMES]:
        by_place.setdefault(tuple(np.round(place, 2)), []).append(node["name"])
    for at, names in by_place.items():
        _name_node(axes, at, names, np.sign(np.round(at - middle, 3)), inwards=view is None)


def _name_node(axes, at, names: list[str], side, inwards: bool):
    """Write names beside a node, to the side (2,) of it where it lies; at the rim of a picture towards its middle."""
    right, up = (-side if inwards else side).tolist()
    axes.annotate(
        "\n".join(names), at, (9 * right, 7 * up if up else 7), textcoords="offset points", fontsize=8, zorder=6,
        ha={1.0: "left", -1.0: "right"}.get(right, "center"), va="bottom" if up >= 0 else "top")  # fmt: skip


def _set_limits(axes, points, view, plane: str) -> str:
    """Set the limits; equal scales, unless a side view is too flat for them, which the words for its label say."""
    if view is None:
        low, high = points.min(axis=0), points.max(axis=0)
        centre, size = (low + high) / 2, high - low
        half = np.maximum(0.56 * size, 0.12 * size.max() if plane == "xy" else 0.56 * size)
    else:
        centre, half = view[0], np.array([view[1], view[1]])
    half = np.maximum(half, 1e-3)
    axes.set_xlim(centre[0] - half[0], centre[0] + half[0])
    axes.set_ylim(centre[1] - half[1], centre[1] + half[1])
    if plane == "xz" and half[0] > FLATTEST * half[1]:
        return " (enlarged)"
    axes.set_aspect("equal")
    return ""


def line_looks(lines: list[str]) -> list[dict]:
    """Return a look for each line: every second one dashed and on top, for symmetric lines have the same tension."""
    colours = len(style.PALETTE)
    return [
        {"color": style.PALETTE[i % colours], "linestyle": DASHES[i % 2 + 2 * (i // colours % 2)], "zorder": 2 + i % 2}
        for i in range(len(lines))
    ]


def tensions(report: dict, name: str, folder: Path) -> Group:
    """Return the tension at the fairlead end of every line over the last period, or the series."""
    waves = report["waveforms"]
    title = "Tension at the fairlead end" + (" over a period" if report["period"] else "")
    figure, axes = plt.subplots(figsize=style.WIDE)
    for line, wave, look in zip(report["lines"], waves["tension"], line_looks(report["lines"]), strict=True):
        axes.plot(waves["time"], KN * np.array(wave), label=line, **look)
    axes.set(title=title, xlabel="time, s", ylabel="tension, kN")
    axes.set_xlim(waves["time"][0], waves["time"][-1])
    add_legend(figure, axes, 3)
    alt = f"{title} of {plural(len(report['lines']), 'line')} of {report['name']}."
    known = number(report["reference"]["uncertainty"], 2)
    drawn = style.save(figure, folder, f"{name}_tension", title, alt)
    return Group(f"Known to {known} of the largest tension; one curve a line.", [drawn])


def harmonics(report: dict, name: str, folder: Path) -> Figure | None:
    """Return the amplitudes of the harmonics of every line's tension; None of a series."""
    if report["waveforms"]["harmonics"] is None:
        return None
    title, amplitudes = "Harmonics of the tension", KN * np.array(report["waveforms"]["harmonics"])[:, 1:]
    figure, axes = panel(title, "harmonic of the frequency", "amplitude, kN", yscale="log")
    number_of, least = np.arange(1, amplitudes.shape[1] + 1), SMALLEST * amplitudes.max()
    for line, row, look in zip(report["lines"], amplitudes, line_looks(report["lines"]), strict=True):
        axes.plot(number_of, np.where(row > least, row, np.nan), marker="o", markersize=3.5, linewidth=0.8, label=line,
                  **look)  # fmt: skip
    axes.set_xticks(number_of)
    return style.save(figure, folder, f"{name}_harmonics", title, f"{title} of every line, 1 to {number_of.size}.")


def spectrum(report: dict, name: str, folder: Path) -> Figure | None:
    """Return the spectral density of every line's tension over a series; None of a periodic motion."""
    part = report["waveforms"].get("spectrum")
    if part is None:
        return None
    title = "Spectrum of the tension"
    figure, axes = panel(title, "frequency, Hz", "density, kN^2/Hz", yscale="log")
    density = KN**2 * np.array(part["density"])
    least = SMALLEST * density.max()
    for line, row, look in zip(report["lines"], density, line_looks(report["lines"]), strict=True):
        axes.plot(part["frequency"], np.where(row > least, row, np.nan), linewidth=0.9, label=line, **look)
    shown = np.flatnonzero((density > least).any(axis=0))
    axes.set_xlim(0, part["frequency"][shown[-1]] if shown.size else None)
    return style.save(figure, folder, f"{name}_spectrum", title, f"{title} of every line.")


def along(report: dict, name: str, folder: Path) -> Figure | None:
    """Return least to greatest and mean tension along every line."""
    if not report.get("along"):
        return None
    title = "Tension along the lines"
    figure, axes = panel(title, "s / length, from the anchor end", "tension, kN")
    for line, part, look in zip(report["lines"], report["along"], line_looks(report["lines"]), strict=True):
        s = np.array(part["s"]) / (part["s"][0] + part["s"][-1])
        axes.fill_between(s, KN * np.array(part["low"]), KN * np.array(part["high"]), color=look["color"], alpha=0.12)
        axes.plot(s, KN * np.array(part["mean"]), label=line, **look)
    axes.set_xlim(0, 1)
    return style.save(figure, folder, f"{name}_along", title, f"{title}: least to greatest, and mean, of every line.")


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
    if (known := find_hidden_errors(report)) is not None:
        axes.axhline(known, color=style.INK, linestyle=":", linewidth=1)
    best = report["recommended"]
    if best and best["error"]:
        axes.plot(best["seconds"], best["error"], "*", color=style.RECOMMENDED, markeredgecolor=style.INK,
                  markersize=14, zorder=6)  # fmt: skip
    set_decade_ticks(axes)
    add_legend(figure, axes)
    return style.save(figure, folder, f"{name}_work", title, f"{title} of {plural(len(solved), 'setting')}.")


def details(report: dict, name: str, folder: Path) -> Group:
    """Return harmonics and error against run time side by side."""
    drawn = (harmonics, spectrum, along, work)
    figures = [figure for draw in drawn if (figure := draw(report, name, folder)) is not None]
    lines = "Lines in the colours of the tensions above; along them shaded from least to greatest. "
    known = find_hidden_errors(report)
    dotted = "" if known is None else f" Dotted: to what the reference is known, {number(known, 2)}."
    return Group(f"{lines}{count_outcomes(report['ladder'])}. Dashed: the tolerance.{dotted} {STAR} "
                 "Ringed: the Pareto front of this project.", figures)  # fmt: skip
