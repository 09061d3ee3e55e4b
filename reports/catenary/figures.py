"""The figures about all solvers: error against time, error map, cost. Captions are computed from the same data."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.colors import ListedColormap

from ..drawing import interactive, style
from ..drawing.axes import (
    GREATEST_ERROR,
    clip_error,
    draw_work_points,
    list_looks,
    list_work_rows,
    set_time_ticks,
)
from ..page.figures import Figure, Group
from ..page.numbers import analysis
from ..page.numbers.formatting import MINUS, across, number, ratio, slug, times

MAP_RANGE = (-1, 13)  # log10 of the error over the unavoidable rounding error: one colour a decade
MAP_LINES = 12  # tick labels of the slackness at most


def work_precision(data: dict, looks: dict, folder: Path) -> Group:
    """Return error against time: all cases together, then one panel per case."""
    points = data["points"]
    total, common, excluded = analysis.sum_over_cases(points)
    limits = _limits(analysis.select_answered(points))
    figures = []
    if total:
        title = f"All {len(common)} cases: greatest error, total time"
        figures.append(_panel(total, title, "work_precision_all", looks, folder, (None, limits[1])))
    for case in dict.fromkeys(p["case"] for p in points):
        mine = [p for p in analysis.select_answered(points) if p["case"] == case]
        if mine:
            title = case if analysis.is_single_line(mine[0]) else f"{case}: median error, time per line"
            figures.append(_panel(mine, title, f"work_precision_{slug(case)}", looks, folder, limits))
    return Group(_work_caption(points, total, common, excluded), figures)


def _limits(points):
    seconds = [p["seconds"] for p in points] or [1e-6, 1]
    errors = [clip_error(p) for p in points] or [1e-16, 1]
    return (1e6 * min(seconds) / 1.6, 1e6 * max(seconds) * 1.6), (min(errors) / 4, min(max(errors), GREATEST_ERROR) * 4)


def _panel(points, title: str, name: str, looks: dict, folder: Path, limits) -> Figure:
    figure, axes = plt.subplots(figsize=style.PANEL)
    draw_work_points(axes, points, looks)
    axes.set_title(title)
    if limits[0]:
        axes.set_xlim(limits[0])
    axes.set_ylim(limits[1])
    set_time_ticks(axes)
    labels = {p["label"] for p in points}
    alt = f"Error against run time, both logarithmic, {title}: {', '.join(sorted(labels))}."
    rows, axes = list_work_rows(points), ("run time of one call", "relative error of the fairlead force")
    x = tuple(1e-6 * value for value in limits[0]) if limits[0] else None
    chart = interactive.draw_work(rows, list_looks(points, looks), axes, (x, limits[1]))
    return style.save(figure, folder, name, title, alt, rows, chart)


def _work_caption(points, total, common, excluded) -> str:
    sentences = []
    labels = {p["solver"]: p["label"] for p in points}
    for peer in [name for name in analysis.sort_solvers(labels) if not name.startswith(analysis.OURS)]:
        cases = dict.fromkeys(p["case"] for p in points)
        factors = [analysis.factor_at_equal_error([p for p in points if p["case"] == c], peer) for c in cases]
        factors = [factor["factor"] for factor in factors if factor]
        if factors:
            sentences.append(
                f"At the smallest error that {labels[peer]} reaches, it takes {times(np.median(factors))} as long as "
                f"this project (median of {len(factors)} cases, {ratio(min(factors))} to {ratio(max(factors))})."
            )
    sentences.append(_front(total))
    if excluded:
        sentences.append(
            "Not in the sum, because they answer fewer than half of the cases: "
            f"{', '.join(labels[n] for n in excluded)}."
        )
    sentences.append(
        "Each point is one tolerance, joined from the loosest to the tightest. Rings: the Pareto front, points that "
        "no other beats in both time and error. Red crosses: an error above the bound of a wrong answer although a "
        f"tolerance ten times smaller was asked for. Errors above {GREATEST_ERROR:g} are drawn at {GREATEST_ERROR:g}; "
        "refused settings have no point."
    )
    return " ".join(filter(None, sentences))


def _front(total) -> str:
    front = analysis.pareto_front(total)
    if not front:
        return ""
    ours = sum(p["solver"].startswith(analysis.OURS) for p in front)
    return f"Over all cases together, {ours} of the {len(front)} points of the Pareto front belong to this project."


# --- the error map ---------------------------------------------------------------------------------------------------


def error_map(accuracy: dict, looks: dict, folder: Path) -> Group | None:
    """Return the error over slackness and stiffness, one panel per solver that supports the map."""
    rows = [row for row in accuracy["rows"] if row["set"] == "map"]
    figures, sentences = [], []
    for name in analysis.sort_solvers(accuracy["solvers"]):
        label = accuracy["solvers"][name]["label"]
        counts = analysis.summarise(rows, name)
        if counts["unsupported"] == counts["cases"]:
            sentences.append(f"{label} has no panel: it does not model these lines.")
            continue
        figures.append(_map_panel(rows, name, label, folder))
        sentences.append(_map_sentence(label, counts))
    sentences.append(
        f"Colour: the error over the unavoidable rounding error, cut off at {10.0 ** MAP_RANGE[0]:g} and "
        f"{number(10.0 ** MAP_RANGE[1], 1)}; red cross: returned as success with an error above the bound of a wrong "
        "answer; black dot: refused. Rows are evenly spaced, dense near L = chord."
    )
    return Group(" ".join(sentences), figures) if figures else None


def _map_sentence(label: str, counts: dict) -> str:
    text = f"{label}: {counts['wrong']} wrong and {counts['refused']} refused of {counts['cases']}"
    if not counts["worst"]:
        return text + "."
    row = counts["worst"]
    return (
        f"{text}; worst point L/chord = {row['slackness']:.9g}, EA/wL = {number(row['stiffness'])}, "
        f"{number(counts['max'])} times the unavoidable rounding error."
    )


def _map_panel(rows, name: str, label: str, folder: Path) -> Figure:
    slackness = sorted({row["slackness"] for row in rows})
    columns = {(i, j): row for i, j, row in _grid(rows, slackness)}
    width = 1 + max(j for _, j in columns)
    image = np.full((len(slackness), width), np.nan)
    marks = {"wrong": [], "refused": []}
    for (i, j), row in columns.items():
        answer = row["answers"][name]
        if answer["verdict"] in ("right", "wrong") and answer["in_limits"] is not None:
            image[i, j] = math.log10(max(answer["in_limits"], 10.0 ** MAP_RANGE[0]))
        if answer["verdict"] in marks:
            marks[answer["verdict"]].append((j + 0.5, i + 0.5))
    figure, axes = plt.subplots(figsize=(style.PANEL[0], 4.4))
    colours = ListedColormap(plt.get_cmap("viridis")(np.linspace(0, 1, MAP_RANGE[1] - MAP_RANGE[0])))
    mesh = axes.pcolormesh(image, cmap=colours, vmin=MAP_RANGE[0], vmax=MAP_RANGE[1], rasterized=True)
    for points, look in ((marks["wrong"], {"marker": "x", "c": style.WRONG, "s": 14, "linewidths": 1.1}),
                         (marks["refused"], {"marker": "o", "c": style.REFUSED, "s": 9})):  # fmt: skip
        if points:
            axes.scatter(*zip(*points, strict=True), **look)
    _map_axes(axes, slackness, [columns[0, j]["stiffness"] for j in range(width)], label)
    bar = figure.colorbar(mesh, ax=axes, location="bottom", shrink=0.9, pad=0.02, extend="both", aspect=30)
    bar.set_label("log10 (error / unavoidable rounding error)")
    counts = ", ".join(f"{len(points)} {verdict}" for verdict, points in marks.items())
    alt = f"Map of the error of {label} over slackness and stiffness: {counts}."
    chart = _map_chart(columns, slackness, name)
    return style.save(figure, folder, f"error_map_{slug(name)}", label, alt, [_map_row(row, name) for row in rows],
                      chart)  # fmt: skip


MAP_LOOKS = {
    "wrong": {"marker": "X", "size": 26, "fill": style.WRONG, "stroke": style.WRONG},
    "refused": {"marker": "o", "size": 14, "fill": style.INK, "stroke": style.INK},
}
MAP_COLOURS = interactive.Colours(MAP_RANGE, "error over the unavoidable rounding error", ("right", "wrong"))


def _map_chart(columns: dict, slackness: list[float], name: str) -> str:
    """Return the map as a chart; columns : (row, column) of the grid -> case."""
    stiffness = [number(row["stiffness"], 2).replace(".0e", "e") for (i, _), row in columns.items() if i == 0]
    labels, rows = [_near_one(value, 1) for value in slackness], []
    for (i, j), row in columns.items():
        answer = row["answers"][name]
        details = {"relative error": number(answer["error"]), "message": answer["message"]}
        rows.append({"x": stiffness[j], "y": labels[i], "verdict": answer["verdict"], "error": answer["in_limits"]}
                    | {key: text for key, text in details.items() if text})  # fmt: skip
    axes = "stiffness EA/(w L)", "slackness L/chord"
    return interactive.draw_map(rows, axes, (stiffness, labels), MAP_LOOKS, MAP_COLOURS)


def _map_row(row: dict, name: str) -> dict:
    """Return a cell of the map for the CSV: its own slackness and stiffness, not its row and column."""
    answer = row["answers"][name]
    outcome = {key: answer[key] for key in ("verdict", "error", "in_limits")}
    return {"slackness L/chord": row["slackness"], "stiffness EA/(w L)": row["stiffness"]} | outcome


def _grid(rows, slackness):
    """Yield (row, column, case): rows by slackness, columns by rank of the stiffness of that slackness."""
    for i, value in enumerate(slackness):
        mine = sorted((row for row in rows if row["slackness"] == value), key=lambda row: row["stiffness"])
        yield from ((i, j, row) for j, row in enumerate(mine))


def _map_axes(axes, slackness, stiffness, label: str):
    decades = [k for k in range(0, 30) if stiffness[0] * 0.99 <= 10.0**k <= stiffness[-1] * 1.01]
    positions = np.interp(decades, np.log10(stiffness), np.arange(len(stiffness)) + 0.5)
    axes.set_xticks(positions, [f"$10^{{{k}}}$" for k in decades])
    step = max(1, math.ceil(len(slackness) / MAP_LINES))
    one = min(range(len(slackness)), key=lambda i: abs(slackness[i] - 1))
    ticks = sorted({0, len(slackness) - 1, *range(one % step, len(slackness), step)})
    ticks = [i for i in ticks if i in (0, len(slackness) - 1) or 1 < i < len(slackness) - 2]
    axes.set_yticks([i + 0.5 for i in ticks], [_near_one(slackness[i]) for i in ticks])
    axes.set(title=label, xlabel="stiffness EA/(w L)", ylabel="slackness L/chord")
    axes.grid(False)


def _near_one(value: float, decimals: int = 0) -> str:
    """Return such as 1 + 2e-7 rather than 1.00000023; decimals : of what is beside 1."""
    gap = value - 1
    if gap == 0 or abs(gap) >= 0.009:
        return f"{value:.3g}"
    return f"1 {'+' if gap > 0 else MINUS} {abs(gap):.{decimals}e}".replace("e-0", "e-")


# --- cost ------------------------------------------------------------------------------------------------------------


def cold_times(rows: list[dict], looks: dict, folder: Path) -> Group | None:
    """Return dots: seconds of one cold solve per case and solver, with the quartiles; from pytest-benchmark."""
    rows = [row for row in rows if row["group"].startswith("span-cold")]
    cases = list(dict.fromkeys(row["case"] for row in rows))
    if not cases:
        return None
    figure, axes = plt.subplots(figsize=(style.WIDE[0], 1.4 + 0.42 * len(cases)))
    names = analysis.sort_solvers({row["solver"] for row in rows})
    for rank, name in enumerate(names):
        mine = [row for row in rows if row["solver"] == name]
        y = [len(cases) - cases.index(row["case"]) + 0.22 * ((len(names) - 1) / 2 - rank) for row in mine]
        middle = np.array([row["median"] for row in mine]) * 1e6
        low, high = (np.array([row[q] for row in mine]) * 1e6 for q in ("q1", "q3"))
        spread = [np.maximum(middle - low, 0), np.maximum(high - middle, 0)]
        axes.errorbar(middle, y, xerr=spread, linestyle="none", label=mine[0]["label"], capsize=2, **looks[name])
    axes.set_yticks(range(len(cases), 0, -1), cases)
    axes.set(
        ylabel="case", xscale="log", xlabel="one cold solve, µs (median; bars: quartiles)", ylim=(0.4, len(cases) + 0.6)
    )
    figure.legend(loc="outside upper center", ncols=len(names))
    alt = "Time of one cold solve for each case and solver, logarithmic."
    columns = ("case", "label", "median", "q1", "q3", "rounds")  # s
    data = [{key: row[key] for key in columns} for row in rows]
    drawn = style.save(figure, folder, "cold_solve", "One cold solve", alt, data)
    return Group(_cold_caption(rows, names), [drawn])


def _cold_caption(rows, names) -> str:
    ours = {row["case"]: row["median"] for row in rows if row["solver"] == analysis.OURS}
    sentences = ["One solve from the inputs alone, nothing kept from an earlier call."]
    if ours:
        sentences.append(f"This project takes {across(1e6 * v for v in ours.values())} µs.")
    for name in names:
        mine = [row for row in rows if row["solver"] == name and row["case"] in ours]
        if name != analysis.OURS and mine:
            factors = [row["median"] / ours[row["case"]] for row in mine]
            sentences.append(
                f"{mine[0]['label']}: {ratio(np.median(factors))} times that (median of {len(mine)} cases)."
            )
    return " ".join(sentences)
