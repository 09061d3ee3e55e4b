"""Axes that figures of several rooms share: one panel, its legend and ticks, and points of error against run time."""

from __future__ import annotations

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.ticker import LogLocator, NullFormatter, NullLocator

from ..page.numbers import analysis
from . import style

KN = 1e-3
"""kN in one N: forces are N in the results and kN on the page."""
LOOKS = [{"color": c, "marker": m} for c, m in zip(style.PALETTE, style.MARKERS, strict=True)]

LEAST_ERROR, GREATEST_ERROR = 1e-17, 10.0
"""Where errors of exactly zero and above any use are drawn: below what doubles can show, and ten times the force."""
LEGEND_LETTERS = 40  # of all labels that fit into one row above a panel


def panel(title: str, xlabel: str, ylabel: str, **axes_options):
    """Return (figure, axes) of one panel."""
    figure, axes = plt.subplots(figsize=style.PANEL)
    axes.set(title=title, xlabel=xlabel, ylabel=ylabel, **axes_options)
    return figure, axes


def add_legend(figure, axes, columns: int = 2, **options):
    """Draw the legend above the axes, in as many columns as fit."""
    handles, labels = axes.get_legend_handles_labels()
    if labels:
        figure.legend(handles, labels, loc="outside upper center", ncols=min(columns, len(labels)), **options)


SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def write_decade(value: float, _position=None) -> str:
    """Return such as 10⁻³ in plain letters, which are laid out several times as fast as formulas; else ""."""
    power = np.log10(value) if value > 0 else 0.5
    if abs(power - round(power)) > 1e-6:
        return ""
    return f"10{str(round(power)).translate(SUPERSCRIPTS)}" if not -1 <= round(power) <= 1 else f"{value:g}"


def set_decade_ticks(axes, which: str = "xy", most: int = 8):
    """Put at most so many decades on logarithmic axes; on fewer than two, label numbers between them as well."""
    for name in which:
        axis, (low, high) = getattr(axes, f"{name}axis"), getattr(axes, f"get_{name}lim")()
        close = high / low < 100
        axis.set_major_locator(LogLocator(subs=(1, 2, 5) if close else (1,), numticks=most))
        axis.set_minor_formatter(NullFormatter())
        axis.set_major_formatter("{x:g}" if close else write_decade)


def set_time_ticks(axes):
    """Put decades of the run time on the x axis."""
    set_decade_ticks(axes, "x", 9)


def set_size_ticks(axes, values):
    """Put these sizes on a logarithmic x axis."""
    axes.set_xticks(values, [str(value) for value in values])
    axes.xaxis.set_minor_locator(NullLocator())


def draw_growth(title: str, xlabel: str, rows: list[dict], key: str, look: dict):
    """Return a figure of the seconds of one period by size, both logarithmic; key: of the size in a row."""
    figure, axes = panel(title, xlabel, "time of one period, s", xscale="log", yscale="log")
    sizes = [row[key] for row in rows]
    axes.plot(sizes, [row["seconds"] for row in rows], linewidth=1, **look)
    set_decade_ticks(axes, "y")
    set_size_ticks(axes, sizes)
    return figure


def draw_order_line(axes, x, y, order: int = 2):
    """Draw a dashed line of this order from the point of the least x with the value y."""
    x = np.array([min(x), max(x)], dtype=float)
    axes.plot(x, y * (x / x.min()) ** order, "--", color=style.PALE, linewidth=1, label=f"order {order}", zorder=1)


def draw_work_points(axes, points, looks: dict):
    """Draw error against run time: each solver's points joined in the order of its tolerances, the Pareto front ringed.

    A red cross: an error above the bound of a wrong answer although a ten times smaller tolerance was asked for.
    """
    good = analysis.select_answered(points)
    for name in analysis.sort_solvers({p["solver"] for p in good}):
        mine = [p for p in good if p["solver"] == name]
        mine.sort(key=lambda p: -(p["tolerance"] or 0))
        xy = [1e6 * p["seconds"] for p in mine], [clip_error(p) for p in mine]
        axes.plot(*xy, label=mine[0]["label"], alpha=0.95, linewidth=1, zorder=3, **looks[name])
        wrong = [(s, e) for s, e, p in zip(*xy, mine, strict=True) if analysis.misses_tolerance(p)]
        if wrong:
            axes.plot(*zip(*wrong, strict=True), "x", color=style.WRONG, markersize=10, markeredgewidth=2, zorder=5)
    front = analysis.pareto_front([p for p in good if not analysis.misses_tolerance(p)])
    axes.plot([1e6 * p["seconds"] for p in front], [clip_error(p) for p in front], "o", markersize=11,
              markerfacecolor="none", markeredgecolor=style.INK, markeredgewidth=1, zorder=4)  # fmt: skip
    axes.set(
        xscale="log", yscale="log", xlabel="run time of one call, µs", ylabel="relative error of the fairlead force"
    )
    axes.yaxis.set_major_locator(LogLocator(numticks=7))
    axes.yaxis.set_major_formatter(write_decade)
    axes.yaxis.set_minor_formatter(NullFormatter())
    labels = axes.get_legend_handles_labels()[1]
    axes.figure.legend(loc="outside upper center", ncols=len(labels) if sum(map(len, labels)) < LEGEND_LETTERS else 2)


def list_work_rows(points) -> list[dict]:
    """Return what draw_work_points draws, a row a point, unrounded: for the CSV and the chart."""
    good = analysis.select_answered(points)
    front = [id(p) for p in analysis.pareto_front([p for p in good if not analysis.misses_tolerance(p)])]
    rows = []
    for name in analysis.sort_solvers({p["solver"] for p in good}):
        mine = sorted((p for p in good if p["solver"] == name), key=lambda p: -(p["tolerance"] or 0))
        rows += [
            {"method": p["label"], "setting": f"tolerance {p['tolerance']:g}" if p["tolerance"] else "default",
             "time_s": p["seconds"], "error": p["error"], "front": "yes" if id(p) in front else "",
             "wrong": "yes" if analysis.misses_tolerance(p) else "", "rank": rank}
            for rank, p in enumerate(mine)
        ]  # fmt: skip
    return rows


def list_looks(points, looks: dict) -> dict[str, dict]:
    """Return label -> look of the solvers that have points."""
    labels = {p["solver"]: p["label"] for p in points}
    return {labels[name]: looks[name] for name in analysis.sort_solvers(labels)}


def clip_error(point: dict) -> float:
    """Return the error of a point, kept within the panel."""
    return min(max(point["error"], LEAST_ERROR), GREATEST_ERROR)
