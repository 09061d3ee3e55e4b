"""The figures on stability: one map per pair of axes pushed to where a solver breaks, and stiff integration."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.colors import ListedColormap
from matplotlib.ticker import LogLocator, NullFormatter

from ..drawing import interactive, style
from ..page.figures import Figure, Group
from ..page.numbers.formatting import MINUS, number, plural, seconds, status_words

CHART_SIZES = {"warned": 18, "invalid": 50}
"""Area of a mark on a chart in square pixels, where it is not 40."""
CHART_SHAPES = {"invalid": "D"}
"""Marker on a chart, where it is another one: legends show all in one size, so that rings would look like dots."""
MARKS = {
    "warned": {"marker": ".", "c": "white", "edgecolors": style.INK, "s": 42, "linewidths": 0.6},
    "refused": {"marker": "s", "c": style.INK, "s": 26},
    "not converged": {"marker": "x", "c": style.INK, "s": 30, "linewidths": 1.3},
    "invalid": {"marker": "o", "facecolors": "none", "edgecolors": style.INK, "s": 26, "linewidths": 1.1},
    "too coarse": {"marker": "v", "c": style.INK, "s": 24},
    "wrong": {"marker": "X", "c": style.WRONG, "s": 60},
    "crashed": {"marker": "P", "c": style.WRONG, "s": 60},
}
"""Of every verdict but solved; where there is an answer, it has the colour of its error."""
CHART_MARKS = {
    verdict: {"marker": CHART_SHAPES.get(verdict, look["marker"]), "size": CHART_SIZES.get(verdict, 40),
              "fill": look.get("c", "transparent"), "stroke": look.get("edgecolors", look.get("c"))}
    for verdict, look in MARKS.items()
}  # fmt: skip
"""The same on a chart."""
ANSWERED = ("solved", "warned")

LIMITS, FORCES, TENSION = (-3, 2), (-18, -8), (-7, 1)
"""log10 of the errors that the colours span: in condition limits, over forces to rounding, and of a discretisation."""
RANGES = {"span": LIMITS, "network": FORCES}
RADIUS = "\N{GREEK SMALL LETTER RHO}\N{INFINITY}"
TICKS = 10  # on an axis at most


def maps(entries: list[dict], explicit: list[dict], folder: Path) -> Group:
    """Return the maps of one solver; explicit: limits of explicit steps, drawn where the step is an axis."""
    captions, drawn = [_caption(entry) for entry in entries], [_map(entry, explicit, folder) for entry in entries]
    if any(_limit(entry, explicit) for entry in entries):
        captions.append("Dashed: the largest step of the leapfrog, an explicit method, on this mesh.")
    return Group(" ".join(captions), drawn)


def _limit(entry: dict, explicit: list[dict]) -> tuple[str, float] | None:
    """Return ("x" or "y", position) of the largest leapfrog step on the mesh of a map with smaller steps."""
    limits = [row["leapfrog"] / row["period"] for row in explicit if row["nodes"] == entry["nodes"] and not row["beta"]]
    for key in ("x", "y"):
        values = entry[key]["values"]
        if limits and entry[key]["label"].startswith("step") and limits[0] > values[0]:
            return key, float(np.interp(math.log(limits[0]), np.log(values), np.arange(len(values)) + 0.5))
    return None


def _map(entry: dict, explicit: list[dict], folder: Path) -> Figure:
    x, y, low_high = entry["x"]["values"], entry["y"]["values"], RANGES.get(entry["solver"], TENSION)
    image = np.full((len(y), len(x)), np.nan)
    marked = {}
    for point in entry["points"]:
        if point["verdict"] in ANSWERED and point["error"] is not None:
            error = max(point["error"] or 0.0, 10.0 ** low_high[0])
            image[point["y"], point["x"]] = min(math.log10(error), low_high[1])
        if point["verdict"] != "solved":
            marked.setdefault(point["verdict"], []).append((point["x"] + 0.5, point["y"] + 0.5))
    figure, axes = plt.subplots(figsize=(style.PANEL[0], 4.4))
    colours = ListedColormap(plt.get_cmap("viridis")(np.linspace(0.05, 1, low_high[1] - low_high[0])))
    mesh = axes.pcolormesh(image, cmap=colours, vmin=low_high[0], vmax=low_high[1], rasterized=True)
    for verdict, look in MARKS.items():
        if verdict in marked:
            axes.scatter(*zip(*marked[verdict], strict=True), label=verdict, **look)
    for axis, values in ((axes.xaxis, x), (axes.yaxis, y)):
        ticks = range(0, len(values), math.ceil(len(values) / TICKS))
        axis.set_ticks([i + 0.5 for i in ticks], [_tick(values[i]) for i in ticks])
    axes.tick_params(axis="x", labelrotation=45 if max(len(_tick(v)) for v in x) > 4 else 0)
    axes.set(title=entry["title"], xlabel=entry["x"]["label"], ylabel=entry["y"]["label"])
    axes.set(xlim=(0, len(x)), ylim=(0, len(y)))
    axes.grid(False)
    limit = _limit(entry, explicit)
    if limit:
        draw = axes.axvline if limit[0] == "x" else axes.axhline
        draw(limit[1], color=style.INK, linestyle="--", linewidth=1.2)
    if marked:
        axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.08), ncols=3, borderaxespad=0)
    bar = figure.colorbar(mesh, ax=axes, location="bottom", shrink=0.9, pad=0.02, extend="min", aspect=30)
    bar.set_label("log10 of the error")
    counts = ", ".join(f"{count} {verdict}" for verdict, count in entry["counts"].items() if count)
    alt = f"Stability map, {entry['title']}: {counts}."
    rows = [{entry[key]["label"]: entry[key]["values"][point[key]] for key in "xy"}
            | {key: point.get(key) for key in ("verdict", "status", "error")} for point in entry["points"]]  # fmt: skip
    return style.save(figure, folder, f"stability_{entry['name']}", entry["title"], alt, rows,
                      _map_chart(entry, limit, low_high))  # fmt: skip


def _map_chart(entry: dict, limit: tuple[str, float] | None, decades: tuple[int, int]) -> str:
    """Return the same map as a chart: the pointer shows verdict, status, error, run time and message of a cell."""
    ticks = [_tick(value) for value in entry["x"]["values"]], [_tick(value) for value in entry["y"]["values"]]
    rows = [
        {"x": ticks[0][point["x"]], "y": ticks[1][point["y"]], "verdict": point["verdict"],
         "status": status_words(point["status"]), "error": point["error"], "run time": seconds(point.get("seconds"))}
        | ({"message": point["message"]} if point.get("message") else {})
        for point in entry["points"]
    ]  # fmt: skip
    axes, colours = (entry["x"]["label"], entry["y"]["label"]), interactive.Colours(decades, "error", ANSWERED)
    return interactive.draw_map(rows, axes, ticks, CHART_MARKS, colours, limit)


def _tick(value: float) -> str:
    """Return such as 0.001, 30, 1e5, 1 - 1e-6."""
    if 0 < abs(value - 1) < 1e-3:
        return f"1{'+' if value > 1 else MINUS}{abs(value - 1):.0e}".replace("e-0", "e-")
    text = f"{value:.0e}" if value >= 1e4 and value == 10 ** round(math.log10(value)) else f"{value:g}"
    return text.replace("e+0", "e").replace("e-0", "e-").replace("e+", "e")


def _caption(entry: dict) -> str:
    solved = [point for point in entry["points"] if point["verdict"] == "solved"]
    counts = "".join(f", {count} {v}" for v, count in entry["counts"].items() if count and v != "solved")
    text = f"{entry['title']}: {len(solved)} of {plural(len(entry['points']), 'point')} solved{counts}"
    if solved:
        worst = max(solved, key=lambda point: point["error"])
        where = ", ".join(f"{entry[key]['label']} {_tick(entry[key]['values'][worst[key]])}" for key in ("x", "y"))
        text += f"; greatest error of the solved {number(worst['error'], 2)} ({where})"
    return f"{text}. {entry['left_out']}".strip()


# ---------------------------------------------------------------- stiff integration
def stiff(explicit: list[dict], axial: list[dict], folder: Path) -> Group:
    """Return the limits of explicit steps by nodes, and the loss of an axial wave by steps in its period."""
    plain = [row for row in explicit if not row["beta"]]
    last = plain[-1]
    leapfrog, runge_kutta = (f"{number(1e3 * last[key], 2)} ms" for key in ("leapfrog", "rk4"))
    text = (
        f"Left: the largest eigenvalue of the chain linearised about rest limits explicit steps, on {last['nodes']} "
        f"nodes the leapfrog's to {leapfrog} and that of the classical Runge-Kutta method to {runge_kutta}; the box "
        "scheme's shortest waves are faster than an axial wave crosses a cell, so the limit falls with the square of "
        "the cell. The implicit method has none: the maps above step from a fraction of it to half a period. "
    )
    damped = [row for row in explicit if row["beta"]]
    if damped:
        limits = ", ".join(f"{number(row['rk4'], 2)} s with β = {row['beta']:g} s" for row in damped)
        text += f"Structural damping tightens an explicit step further on {damped[0]['nodes']} nodes: {limits}. "
    worst = max(abs(row["measured"] - row["expected"]) for row in axial if row["measured"] is not None)
    text += (
        f"Right: what the first axial wave ({number(axial[0]['frequency'])} Hz) loses in a period, measured in a free "
        f"motion (markers) and from the roots of the method (lines); they differ by at most {number(worst, 1)}. With "
        "spectral radius 1 it loses nothing, and nothing above it either."
    )
    return Group(text, [_limits(plain, folder), _losses(axial, folder)])


def _limits(rows, folder) -> Figure:
    figure, axes = plt.subplots(figsize=style.PANEL)
    nodes = [row["nodes"] for row in rows]
    named = (("transit", "wave through a cell"), ("rk4", "Runge-Kutta limit"), ("leapfrog", "leapfrog limit"))
    for rank, (key, label) in enumerate(named):
        look = {"color": style.PALETTE[rank], "marker": style.MARKERS[rank]}
        axes.plot(nodes, [row[key] for row in rows], label=label, **look)
    axes.set(xscale="log", yscale="log", xlabel="nodes", ylabel="time step, s")
    axes.set_xticks(nodes, [str(n) for n in nodes])
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.yaxis.set_major_locator(LogLocator(numticks=9))
    figure.legend(loc="outside upper center", ncols=3)
    alt = "Largest stable explicit time steps against the number of nodes, both logarithmic."
    return style.save(figure, folder, "stability_explicit", "Explicit step limits", alt)


def _losses(rows, folder) -> Figure:
    figure, axes = plt.subplots(figsize=style.PANEL)
    for rank, radius in enumerate(radius for radius in dict.fromkeys(row["radius"] for row in rows) if radius < 1):
        mine = [row for row in rows if row["radius"] == radius]
        steps = [row["steps"] for row in mine]
        colour = style.PALETTE[rank % len(style.PALETTE)]
        axes.plot(steps, [row["expected"] for row in mine], color=colour, linewidth=1)
        measured = [row["measured"] for row in mine]
        axes.plot(steps, measured, style.MARKERS[rank], color=colour, label=f"{RADIUS} = {radius:g}")
    axes.set(xscale="log", yscale="log", xlabel="steps in a period of the wave", ylabel="share lost in a period")
    steps = sorted({row["steps"] for row in rows})
    axes.set_xticks(steps, [str(s) for s in steps])
    axes.xaxis.set_minor_formatter(NullFormatter())
    figure.legend(loc="outside upper center", ncols=4)
    alt = "Share of an axial wave that is lost in a period against the steps in it, by spectral radius."
    return style.save(figure, folder, "stability_axial", "Numerical damping", alt)
