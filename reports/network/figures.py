"""The figures on networks of lines: error against time, gain of the monolithic method, growth with size."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.ticker import LogLocator, NullFormatter

from ..drawing import interactive, style
from ..drawing.axes import clip_error, draw_work_points, list_looks, list_work_rows, set_time_ticks
from ..page.figures import Group
from ..page.numbers import analysis
from ..page.numbers.formatting import across, number, seconds, slug, times

TALL = (4.7, 3.9)  # inches: a panel with three lines of legend
TIGHT, BASE = 1e-6, "monolithic-line-search"  # error that the caption compares methods at, and with which


METHOD_LOOKS = {
    "monolithic-line-search": {"color": style.PALETTE[0], "marker": "o"},
    "moorpy": {"color": style.PALETTE[1], "marker": "s"},
    "monolithic-trust-region": {"color": style.PALETTE[2], "marker": "D"},
    "monolithic-differences": {"color": style.PALETTE[5], "marker": "v"},
    "nested-analytic": {"color": style.PALETTE[4], "marker": "P"},
    "nested-differences": {"color": style.PALETTE[3], "marker": "^"},
}
"""MoorPy has the colour that it has among the solvers of single lines."""


# ---------------------------------------------------------------- error against time
def work(points: list[dict], folder: Path) -> Group | None:
    """Return error against run time, one panel a system."""
    good, figures = analysis.select_answered(points), []
    looks = style.add_missing_looks(METHOD_LOOKS, dict.fromkeys(point["solver"] for point in points))
    for case in dict.fromkeys(point["case"] for point in good):
        figure, axes = plt.subplots(figsize=TALL)
        mine = [point for point in points if point["case"] == case]
        draw_work_points(axes, mine, looks)
        axes.set(ylabel="relative error of the end tensions", ylim=_errors(good))
        set_time_ticks(axes)
        axes.set_title(case)
        alt = f"Error against run time of the methods for networks, both logarithmic: {case}."
        rows, labels = list_work_rows(mine), ("run time of one call", "relative error of the end tensions")
        chart = interactive.draw_work(rows, list_looks(mine, looks), labels, (None, _errors(good)))
        figures.append(style.save(figure, folder, f"networks_work_{slug(case)}", case, alt, rows, chart))
    return Group(_work_caption(points), figures) if figures else None


def _errors(points: list[dict]) -> tuple[float, float]:
    errors = [clip_error(point) for point in points]
    return min(errors) / 4, max(errors) * 4


def _work_caption(points: list[dict]) -> str:
    sentences = [_ranking(points)]
    sentences.append(
        "Each method starts from the guessed positions of the nodes and has no fallback; each point is one tolerance. "
        "Rings: points that no other beats in both time and error. Red crosses: an error above the bound of a wrong "
        "answer although a tolerance ten times smaller was asked for."
    )
    never = [f"{p['label']} ({p['case']}, {number(p['tolerance'], 1)})" for p in points if p["verdict"] == "refused"]
    if never:
        sentences.append(f"Without an answer, at the tolerance: {', '.join(never)}.")
    return " ".join(filter(None, sentences))


def _ranking(points: list[dict]) -> str:
    """Return the least times of the methods to an error of at most TIGHT, over that of the plain monolithic one."""
    least = {}
    for p in analysis.select_answered(points):
        if p["error"] <= TIGHT:
            key = p["case"], p["solver"]
            least[key] = min(p["seconds"], least.get(key, np.inf))
    base = {case: value for (case, solver), value in least.items() if solver == BASE}
    others = []
    for solver, label in {p["solver"]: p["label"] for p in points if p["solver"] != BASE}.items():
        ratios = [least[case, solver] / base[case] for case in base if (case, solver) in least]
        if ratios:
            others.append(f"{label}, {across(ratios)} times")
    if not base:
        return ""
    text = f"To an error of {number(TIGHT, 1)} the monolithic method with line search takes {_span(base.values())}"
    return f"{text}{'; as long as that take: ' + '; '.join(others) if others else ''}."


def _span(values) -> str:
    """Return such as "4.42 ms to 6.42 ms"."""
    low, high = seconds(min(values)), seconds(max(values))
    return low if low == high else f"{low} to {high}"


# ---------------------------------------------------------------- growth with size
def growth(data: dict, folder: Path) -> Group | None:
    """Return seconds against elements, one line a family, with the fitted power law."""
    solved = [row for row in data["rows"] if row["status"] == "SUCCESS"]
    if not solved:
        return None
    figure, axes = plt.subplots(figsize=style.PANEL)
    for rank, family in enumerate(dict.fromkeys(row["family"] for row in solved)):
        mine = [row for row in solved if row["family"] == family]
        n, t = np.array([(row["elements"], row["seconds"]) for row in mine], dtype=float).T
        look = {"color": style.PALETTE[rank], "marker": style.MARKERS[rank]}
        axes.plot(n, t, label=family, linewidth=1, **look)
        exponent, far = data["exponents"][family], n >= data["fitted_from"]
        if exponent is not None:
            constant = np.exp(np.mean(np.log(t[far]) - exponent * np.log(n[far])))
            axes.plot(n[far], constant * n[far] ** exponent, "--", color=style.INK, linewidth=1)
    axes.set(xscale="log", yscale="log", xlabel="elements", ylabel="time of one solve without a start, s")
    _decades(axes)
    figure.legend(loc="outside upper center", ncols=3)
    alt = "Time of one solve against the number of elements, both logarithmic: chain, net and tree."
    drawn = style.save(figure, folder, "networks_growth", "Growth with size", alt)
    return Group(_growth_caption(data), [drawn])


def _growth_caption(data: dict) -> str:
    sentences = []
    for family, exponent in data["exponents"].items():
        last = max((row for row in data["rows"] if row["family"] == family), key=lambda row: row["elements"])
        power = f", growing as elements to the power {number(exponent)}" if exponent is not None else ""
        sentences.append(f"a {family} of {number(last['elements'])} takes {seconds(last['seconds'])}{power}")
    text = f"{'; '.join(sentences)}."
    if any(exponent is not None for exponent in data["exponents"].values()):
        text += f" Dashed: the power, fitted from {number(data['fitted_from'])} elements on."
    else:
        text += " The short run stops before the size from which a power is fitted."
    failed = [f"{row['family']} of {row['elements']}" for row in data["rows"] if row["status"] != "SUCCESS"]
    memory = {row["family"]: row["memory_MB"] for row in data["rows"] if row.get("memory_MB") is not None}
    if memory:
        peaks = ", ".join(f"{family} {number(value, 2)} MB" for family, value in memory.items())
        text += f" Memory that the largest solves need at most, the factors of the sparse matrices included: {peaks}."
    if failed:
        return f"{text} Not solved: {', '.join(failed)}."
    worst = max(row["residual_norm"] for row in data["rows"])
    return f"{text} Every network is in balance to {number(worst, 2)} of its largest force."


# ---------------------------------------------------------------- gain
def gain(rows: list[dict], folder: Path) -> Group | None:
    """Return time of both methods for chains of growing size."""
    chains = sorted((row for row in rows if row["system"].startswith("chain")), key=lambda row: row["elements"])
    if len(chains) < 2:
        return None
    figure, axes = plt.subplots(figsize=style.PANEL)
    n = [row["elements"] for row in chains]
    for name, label, look in (
        ("monolithic", "monolithic, analytic", "monolithic-line-search"),
        ("nested_differences", "nested, differences", "nested-differences"),
    ):
        t = [1e3 * row[f"{name}_seconds"] for row in chains]
        axes.plot(n, t, label=label, linewidth=1, **METHOD_LOOKS[look])
    axes.set(xscale="log", yscale="log", xlabel="elements of the chain", ylabel="time of one solve, ms")
    _decades(axes)
    axes.set_xticks(n, [str(size) for size in n])
    figure.legend(loc="outside upper center", ncols=2)
    alt = (
        "Time of one solve against the number of elements of a chain: monolithic analytic and nested with differences."
    )
    drawn = style.save(figure, folder, "networks_gain", "Gain of the monolithic method", alt)
    first, last = chains[0], chains[-1]
    caption = (
        f"Nested with differences takes {times(first['ratio'])} as long as monolithic at {first['elements']} elements "
        f"and {times(last['ratio'])} as long at {last['elements']}. Warm re-solves of a chain whose end moves by 1 %, "
        "least times of all turns."
    )
    return Group(caption, [drawn])


def _decades(axes):
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(numticks=9))
        axis.set_minor_formatter(NullFormatter())
