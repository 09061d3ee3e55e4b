"""The figures of the first page."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt

from ..drawing import style
from ..drawing.axes import set_decade_ticks
from ..mooring.cases import CASES, LEGEND, METHODS
from ..page.figures import Figure
from ..page.numbers import analysis

SIZE = (style.PANEL[0], 2.7)

SHOWN = 8
"""Regimes with the greatest errors, those that are drawn."""

save = partial(style.save_in_section, "summary")

COLOURS = {
    "right": style.PALETTE[2], "solved": style.PALETTE[2], "warned": style.PALETTE[4], "refused": style.PALE,
    "not converged": style.PALETTE[5], "invalid": style.PALETTE[3], "too coarse": style.PALETTE[1],
    "unsupported": style.GRID, "wrong": style.WRONG, "crashed": style.INK,
}  # fmt: skip
WORDS = {"unsupported": "not modelled"}


def errors_by_regime(accuracy: dict, folder: Path) -> Figure:
    """Return the median and the greatest error of this project on lines at rest, regime by regime."""
    judged = accuracy | {"rows": [row for row in accuracy["rows"] if row["set"] != "map"]}
    entries = [(e["regime"].replace("-", " "), e["solvers"][analysis.OURS]) for e in analysis.by_regime(judged)]
    entries = sorted((e for e in entries if e[1]["max"]), key=lambda e: e[1]["max"])[-SHOWN:]
    figure, axes = plt.subplots(figsize=SIZE)
    places = np.arange(len(entries))
    for key, label, marker in (("median", "median", "o"), ("max", "greatest", "D")):
        axes.plot([counts[key] for _, counts in entries], places, marker, label=label,
                  color=style.PALETTE[0 if key == "median" else 1])  # fmt: skip
    axes.axvline(1, color=style.PALE, linestyle="--", linewidth=1, label="unavoidable")
    axes.set(xscale="log", xlabel="error over that of rounding the inputs", ylabel="regime")
    axes.set_yticks(places, [name for name, _ in entries], fontsize=8)
    set_decade_ticks(axes, "x")
    figure.legend(loc="outside upper center", ncols=3)
    title = "Lines at rest against 50 digits"
    return save(figure, folder, "errors", title, f"{title}: errors by regime, logarithmic; those with the greatest.")


def moving_line(work: dict, case: str, folder: Path) -> Figure:
    """Return error against run time of the moving line in one case."""
    points = [p for p in work["points"] if p["case"] == case and p["rms"]]
    looks = style.add_missing_looks(METHODS, dict.fromkeys(p["method"] for p in points))
    figure, axes = plt.subplots(figsize=SIZE)
    for method in (name for name in looks if any(p["method"] == name for p in points)):
        mine = [p for p in points if p["method"] == method]
        axes.plot([p["seconds"] for p in mine], [100 * p["rms"] for p in mine], linestyle="none",
                  label=LEGEND.get(method, method), **looks[method])  # fmt: skip
    axes.axhline(100 * work["wanted"][1], color=style.PALE, linestyle="--", linewidth=1)
    axes.set(xscale="log", yscale="log", xlabel="run time, s", ylabel="rms error, % of the range")
    set_decade_ticks(axes)
    figure.legend(loc="outside right upper", fontsize=7.5, handletextpad=0.1, labelspacing=0.9)
    title = f"Moving line, {(CASES | work['titles'])[case].lower()}"
    return save(figure, folder, "method", title, f"{title}: error against run time, both logarithmic, by method.")


def verdicts_by_solver(maps: list[dict], verdicts: list[str], folder: Path) -> Figure:
    """Return bars of the shares of points by verdict, a bar a solver."""
    solvers = list(dict.fromkeys(entry["solver"] for entry in maps))
    counts = {
        solver: {v: sum(e["counts"].get(v, 0) for e in maps if e["solver"] == solver) for v in verdicts}
        for solver in solvers
    }
    names = {"span": "line at rest", "statics": "cable at rest"}
    rows = {names.get(solver, solver): of for solver, of in counts.items()}
    title = "Points pushed to the limits"
    return _bars(rows, verdicts, title, "solver", "limits", folder)


def verdicts_by_code(accuracy: dict, folder: Path) -> Figure:
    """Return bars of the shares of lines at rest by verdict, a bar a code."""
    rows = {
        accuracy["solvers"][name]["label"]: analysis.summarise(accuracy["rows"], name)
        for name in analysis.sort_solvers(accuracy["solvers"])
    }
    return _bars(rows, analysis.VERDICTS, "Lines at rest by code", "code", "codes", folder)


def _bars(rows: dict[str, dict], verdicts, title: str, ylabel: str, name: str, folder: Path) -> Figure:
    figure, axes = plt.subplots(figsize=SIZE)
    labels, left = list(rows), np.zeros(len(rows))
    totals = np.array([sum(rows[label][v] for v in verdicts) for label in labels], dtype=float)
    for verdict in (v for v in verdicts if any(rows[label][v] for label in labels)):
        share = 100 * np.array([rows[label][verdict] for label in labels]) / totals
        axes.barh(labels, share, left=left, color=COLOURS.get(verdict, style.PALE), height=0.62,
                  label=WORDS.get(verdict, verdict))  # fmt: skip
        left += share
    axes.invert_yaxis()
    axes.grid(axis="y", visible=False)
    axes.set(xlabel="share of the cases, %", ylabel=ylabel, xlim=(0, 100))
    figure.legend(loc="outside upper center", ncols=5, fontsize=7.5, columnspacing=0.8, handlelength=1.2)
    data = [{ylabel: label, "verdict": WORDS.get(v, v), "cases": rows[label][v]} for label in labels for v in verdicts]
    data = [{"x axis": "cases", "y axis": ylabel, "x": row["cases"], "y": row[ylabel], "series": row["verdict"]}
            for row in data]  # fmt: skip
    return style.save(figure, folder, f"summary_{name}", title, f"{title}: shares by verdict, in per cent.", data)


def shape_of(scene: dict, folder: Path) -> Figure:
    """Return the shape of the first line of a scene."""
    line = scene["lines"][0]
    figure, axes = plt.subplots(figsize=SIZE)
    x, z = line["profile"]["x"], line["profile"]["z"]
    axes.axhline(min(z), color=style.SEABED, linewidth=1.5)
    axes.plot(x, z, color=style.PALETTE[0], linewidth=2.2, label=line["label"] or scene["name"])
    axes.plot(x[-1:], z[-1:], "o", color=style.PALETTE[1], label="fairlead")
    axes.set(xlabel="horizontal distance, m", ylabel="height above the anchor, m")
    figure.legend(loc="outside upper center", ncols=2)
    title = f"{scene['name']}: shape at rest"
    return save(figure, folder, "shape", title, f"{title}, from the anchor to the fairlead.")
