"""The figures on moving lines of nodes and elements. Captions come from the same data."""

from __future__ import annotations

from pathlib import Path
from statistics import median
from textwrap import fill

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.lines import Line2D

from ..drawing import interactive, style
from ..drawing.axes import LOOKS, add_legend, draw_growth, panel, set_decade_ticks
from ..page.figures import Figure, Group
from ..page.numbers.analysis import pareto_front
from ..page.numbers.formatting import number, plural, seconds, times
from .cases import CASES, GROWING, LEGEND, METHODS, OWN, save

WIDEST_TITLE = 46
"""Letters of a title that fit over a panel."""
ORCAFLEX, PEER = "OrcaFlex", "MoorDyn"


def work(data: dict, folder: Path) -> Group:
    """Return error against run time, a panel a case."""
    figures, titles = [], CASES | data["titles"]
    looks = style.add_missing_looks(METHODS, dict.fromkeys(p["method"] for p in data["points"]))
    for case in dict.fromkeys(point["case"] for point in data["points"]):
        points = [p for p in data["points"] if p["case"] == case and p["rms"]]
        figure, axes = plt.subplots(figsize=(style.PANEL[0], 4.4))
        for method in (name for name in looks if any(p["method"] == name for p in points)):
            mine = [p for p in points if p["method"] == method]
            front = pareto_front(mine, "rms")
            axes.plot([p["seconds"] for p in mine], [p["rms"] for p in mine], linestyle="none", alpha=0.9,
                      label=LEGEND.get(method, method), **looks[method])  # fmt: skip
            axes.plot([p["seconds"] for p in front], [p["rms"] for p in front], linewidth=0.9, alpha=0.7,
                      color=looks[method]["color"], label="_front")  # fmt: skip
        axes.set(
            title=fill(titles[case], WIDEST_TITLE),
            xscale="log",
            yscale="log",
            xlabel="run time, s",
            ylabel="rms error over the range",
        )
        axes.set_ylim(top=min(axes.get_ylim()[1], 2.0))
        axes.axhspan(axes.get_ylim()[0], data["uncertainty"][case], color=style.PALE, alpha=0.25, linewidth=0)
        axes.set_xlim(*axes.get_xlim())
        set_decade_ticks(axes)
        add_legend(figure, axes)
        alt = f"Error of the fairlead tension against run time, both logarithmic: {titles[case]}."
        rows = list_settings(points)
        chart = interactive.draw_work(rows, looks, ("run time", "rms error over the range"),
                                      band=data["uncertainty"][case])  # fmt: skip
        figures.append(save(figure, folder, f"work_{case}", titles[case], alt, rows, chart))
    return Group(_work_caption(data), figures)


def list_settings(points: list[dict]) -> list[dict]:
    """Return a row for each setting, unrounded; rank: its place on the front of its method, or None."""
    rows = []
    for method in dict.fromkeys(p["method"] for p in points):
        mine = [p for p in points if p["method"] == method]
        rank = {id(p): k for k, p in enumerate(pareto_front(mine, "rms"))}
        rows += [
            {"method": method, "setting": describe_setting(p), "time_s": p["seconds"], "error": p["rms"],
             "greatest error": p["error"], "rank": rank.get(id(p))}
            for p in mine
        ]  # fmt: skip
    return rows


def describe_setting(point: dict) -> str:
    """Return such as "40 cells, 12 harmonics"; of several kinds of lines "14, 1, 1 cells"."""
    size = ", ".join(map(str, point["size"])) if isinstance(point["size"], list) else point["size"]
    kind = "harmonics" if "harmonic balance" in point["method"] else "steps a period"
    return f"{size} cells, {point['other']} {kind}"


def _work_caption(data) -> str:
    sentences, wanted = [], wanted_errors(data)
    for method in dict.fromkeys(row["method"] for row in data["ratios"]):
        ratios = [row["ratio"] for row in data["ratios"] if row["method"] == method]
        slower = sum(ratio < 1 for ratio in ratios)
        end = f"; in {slower} of them it is the faster one" if slower else ""
        sentences.append(
            f"{_beginning(method)} takes {times(median(ratios))} as long as nodes and elements at equal error (median "
            f"of {len(ratios)} settings on its front with errors of {wanted}, {number(min(ratios), 2)} to "
            f"{number(max(ratios), 2)}{end})."
        )
    missed = [
        (CASES | data["titles"])[case]
        for case in data["uncertainty"]
        if (errors := [p["rms"] for p in data["points"] if (p["case"], p["method"]) == (case, PEER) and p["rms"]])
        and min(errors) > data["wanted"][1]
    ]
    if missed:
        sentences.append(f"{PEER} does not come to {100 * data['wanted'][1]:g} % in: {'; '.join(missed)}.")
    return (
        "Each point is one setting, from rest, one core; lower and further left is better; thin lines: the front of "
        f"each method. {' '.join(sentences)} The grey band is the uncertainty of the reference: of the cases of the "
        "paper, harmonic balance on the box scheme, extrapolated; over a seabed, this core on a mesh far finer than "
        "those shown. Run times include the forces at the fairlead; the equilibrium is solved before the clock starts."
    )


def wanted_errors(data) -> str:
    """Return such as "0.1 to 1 %", between which settings of other codes are compared."""
    return f"{100 * data['wanted'][0]:g} to {100 * data['wanted'][1]:g} %"


def _beginning(text: str) -> str:
    return text[:1].upper() + text[1:]


def growth(data: dict, folder: Path) -> Group:
    """Return the seconds of one period by cells."""
    rows = data["rows"]
    figure = draw_growth("Growth with cells", "cells", rows, "cells", METHODS["in time"])
    drawn = save(figure, folder, "growth", "Growth with cells", "Time of one period by cells, logarithmic.")
    first, last = rows[0], rows[-1]
    caption = (
        f"One period of {GROWING} in steps of {data['dt']:g} s: {seconds(first['seconds'])} on "
        f"{number(first['cells'])} cells, {seconds(last['seconds'])} on {number(last['cells'])}; cells to the power "
        f"{number(data['exponent'], 3)} from {number(data['fitted_from'])} cells on. No matrix is "
        "larger than that of a node."
    )
    return Group(caption, [drawn])


def damping(data: dict, folder: Path) -> Group:
    """Return the time to one error by drag, in time and by harmonic balance."""
    figure, axes = panel("Where harmonic balance pays", "drag coefficient", "run time, s", xscale="log", yscale="log")
    labels = {"in_time": "in time, extrapolated", "balance": "harmonic balance, extrapolated"}
    for key, label in labels.items():
        rows = [row for row in data["rows"] if row[key]]
        axes.plot([r["drag"] for r in rows], [r[key]["seconds"] for r in rows], linewidth=1, label=label,
                  **METHODS[label])  # fmt: skip
    axes.invert_xaxis()
    set_decade_ticks(axes)
    add_legend(figure, axes, 1)
    title = "Run time to one error by drag"
    drawn = save(figure, folder, "damping", title, f"{title}, logarithmic, in time and by harmonic balance.")
    sentences = []
    for row in data["rows"]:
        stepped, balanced = row["in_time"], row["balance"]
        count = plural(stepped["periods"], "period") if stepped else f"not within {data['most_periods']} periods"
        pays = f"{seconds(stepped['seconds'])} in time" if stepped else "no setting in time"
        other = f"{seconds(balanced['seconds'])} by harmonic balance" if balanced else "none by harmonic balance"
        sentences.append(f"drag {row['drag']:g}: {count}, {pays}, {other}")
    return Group(f"{GROWING}, to an rms error of {data['level']:g} of the range. {'; '.join(sentences)}.", [drawn])


def laboratory(data: dict, folder: Path) -> Group:
    """Return computed against measured maxima."""
    title = "Maxima of the laboratory chain"
    figure, axes = panel(title, "measured, N", "computed, N")
    rows, most = data["rows"], 1.08 * max(row["maximum"] for row in data["rows"])
    line = np.array([0.9 * min(row["maximum"] for row in rows), most])
    band = data["band"]
    axes.fill_between(line, (1 - band) * line, (1 + band) * line, color=style.PALE, alpha=0.25, linewidth=0,
                      label=f"within {100 * band:g} %")  # fmt: skip
    axes.plot(line, line, color=style.PALE, linewidth=1, label="equal")
    for period, look in zip(dict.fromkeys(row["period"] for row in rows), LOOKS, strict=False):
        mine = [row for row in rows if row["period"] == period]
        axes.plot([r["maximum"] for r in mine], [r["computed"] for r in mine], linestyle="none",
                  label=f"{period:g} s", **look)  # fmt: skip
    axes.set(xlim=line, ylim=line)
    add_legend(figure, axes, 3)
    drawn = save(figure, folder, "laboratory", title, f"{title}: computed against measured.")
    return Group(_laboratory_caption(data), [drawn, _deviations(data, folder)])


def _deviations(data, folder) -> Figure:
    """Return the deviations by radius, a line a period."""
    title = "Deviation by radius"
    figure, axes = panel(title, "radius of the circle, m", "deviation from the measured, %")
    band = 100 * data["band"]
    axes.axhspan(-band, band, color=style.PALE, alpha=0.25, linewidth=0)
    axes.axhline(0, color=style.PALE, linewidth=1)
    for period, look in zip(dict.fromkeys(row["period"] for row in data["rows"]), LOOKS, strict=False):
        mine = [row for row in data["rows"] if row["period"] == period]
        axes.plot([r["radius"] for r in mine], [100 * r["deviation"] for r in mine], linewidth=1,
                  label=f"{period:g} s", **look)  # fmt: skip
    add_legend(figure, axes, 3)
    return save(figure, folder, "laboratory_deviation", title, f"{title} for three periods, in per cent.")


def _laboratory_caption(data) -> str:
    rows = data["rows"]
    refined = [abs(row["finer"] / row["computed"] - 1) for row in rows if row.get("finer")]
    other = [row["other_way"] / row["maximum"] - 1 for row in rows if row.get("other_way")]
    smooth = [abs(row["without_friction"] / row["maximum"] - 1) for row in rows if row.get("without_friction")]
    outside = sum(abs(row["deviation"]) > data["band"] for row in rows)
    text = (
        f"Lindahl's chain of {data['length']:g} m, whose upper end goes round a circle, and which goes slack and snaps "
        f"in most conditions: the mean of the maxima of the last {data['counted']} cycles, at one setting "
        f"({data['cells']} cells, {data['steps']} steps a period, {data['damping']:g} s of internal damping, a seabed "
        f"of {data['seabed_stiffness']:g} N/m², friction {data['friction']:g} as the paper states it), nothing fitted. "
        f"Deviation: mean {_percent(data['mean'], True)}, mean size {_percent(data['mean_absolute'])}, greatest "
        f"{_percent(data['greatest'])}; {len(rows) - outside} of {len(rows)} within {100 * data['band']:g} %."
    )
    if refined:
        change = _percent(max(refined))
        text += f" Twice the cells and steps change the maxima at the largest radius by at most {change}."
    if smooth:
        text += f" On a smooth seabed the greatest deviation is {_percent(max(smooth))}."
    if other:
        text += (
            " The table of the paper does not say which way the circle is turned; here the end goes away from the "
            f"anchor at the top. Turned the other way the maxima are {_percent(float(np.mean(other)), True)} off in "
            "the mean."
        )
    return text


def _percent(value: float, signed: bool = False) -> str:
    return f"{100 * value:+.1f} %".replace("-", "\N{MINUS SIGN}") if signed else f"{100 * value:.1f} %"


def orcaflex(rows: list[dict], folder: Path) -> Group:
    """Return the tensions of OrcaFlex and of this core over two periods, at both ends."""
    figures = []
    for row in rows:
        for end in ("fairlead", "anchor"):
            title = f"{row['scene']}, heave {row['amplitude']:.0f} m: {end}"
            figure, axes = panel(title, "time, s", f"{end} tension, kN")
            axes.plot(row["time"], row[end], color=style.INK, linewidth=1.4, label=ORCAFLEX)
            lines = zip(row["computed"].items(), style.PALETTE, ("-", "--"), strict=False)
            for (label, computed), colour, line in lines:
                axes.plot(row["time"], computed[end]["tension"], line, color=colour,
                          linewidth=1.2, label=label)  # fmt: skip
            add_legend(figure, axes, 3)
            alt = f"{end.capitalize()} tension in time, by OrcaFlex and computed here: {title}."
            figures.append(save(figure, folder, f"orcaflex_{row['name']}_{end}", title, alt))
    first, *others = rows[0]["computed"]
    of = lambda end: ", ".join(_percent(row["computed"][first][end]["rms"]) for row in rows)
    caption = (
        f"A studless chain over a seabed in heave of {rows[0]['period']:g} s, drag, added mass and seabed as given, "
        f"without the internal damping that is not stated. Rms of the difference over the range, without friction: "
        f"{of('fairlead')} at the fairlead, {of('anchor')} at the anchor. The shape and range at the fairlead "
        "agree; part of the difference there is the tension at rest. The range at the anchor is "
        f"{_ranges(rows, first)} that of OrcaFlex without friction"
    )
    if others:
        caption += (
            f", {_ranges(rows, others[0])} with the {others[0]} of the input file, but it lags: friction here grows "
            "with the speed of slip and does not hold the line. The tensions at rest fit no friction"
        )
    return Group(f"{caption}. Nothing is claimed of the anchor.", figures)


def _ranges(rows, label) -> str:
    """Return the range of the anchor tension over OrcaFlex's, of each row."""
    return ", ".join(
        times(float(np.ptp(row["computed"][label]["anchor"]["tension"]) / np.ptp(row["anchor"]))) for row in rows
    )


KINDS = {"surge": "o", "heave": "s", "circle": "D"}


def seabeds(data: dict, folder: Path) -> Group:
    """Return the error of every motion on the default mesh, those warned of filled."""
    title = "Error of the default mesh over a seabed"
    figure, axes = plt.subplots(figsize=(style.WIDE[0], 4.2))
    titles = {row["line"]: row["title"] for row in data["rows"]}
    lines = list(titles)
    for row in data["rows"]:
        if row.get("error") is None:
            continue
        warned = not set(data["advice"]).isdisjoint(row["subjects"])
        axes.plot(row["error"], lines.index(row["line"]), marker=KINDS[row["kind"]], linestyle="none", markersize=7,
                  color=style.PALETTE[1], markerfacecolor=style.PALETTE[1] if warned else "none",
                  label=f"{row['title']}, {row['kind']} {row['amplitude']:g} m, {row['period']:g} s")  # fmt: skip
    axes.axvline(data["large"], color=style.PALE, linestyle="--", linewidth=1)
    axes.set(title=title, xscale="log", xlabel="rms error over the range", ylabel="line")
    axes.set_yticks(range(len(lines)), list(titles.values()))
    axes.invert_yaxis()
    set_decade_ticks(axes, "x")
    shapes = [Line2D([], [], linestyle="none", marker=m, color=style.PALETTE[1], markerfacecolor="none", label=kind)
              for kind, m in KINDS.items()]  # fmt: skip
    shapes.append(Line2D([], [], linestyle="none", marker="o", color=style.PALETTE[1], label="warned of"))
    figure.legend(handles=shapes, loc="outside upper center", ncols=4)
    alt = f"{title}: one mark for each motion of each line, filled where a warning was given."
    return Group(_seabed_caption(data), [save(figure, folder, "seabeds", title, alt)])


def _seabed_caption(data) -> str:
    summary, rows = data["summary"], data["rows"]
    failed = [row for row in rows if row["status"] != "SUCCESS"]
    unchecked = summary["motions"] - summary["solved"] - len(failed)
    tried = [row for row in rows if row.get("balance") and row["balance"]["status"] != "SLACK"]
    parts = [
        f"{number(summary['motions'])} motions of everyday lines, {data['cells']} cells, {data['steps']} steps a "
        f"period, against {data['finer']} times the cells and {data['halved']} times the steps",
        f"{summary['motions'] - len(failed)} were solved"
        + (f", {unchecked} of them without an error, for the finer run failed" if unchecked else ""),
        f"{summary['periodic']} of {summary['solved']} are periodic within {100 * data['periodic']:g} %",
        f"the error is {_percent(summary['median'])} in the median and {_percent(summary['greatest'])} at most",
        f"{summary['large']} exceed {100 * data['large']:g} %, of {summary['large_and_warned']} of these the history "
        f"warned; {summary['warned_and_small']} warnings were given where the error is smaller",
    ]
    if tried:
        parts.append(
            f"harmonic balance on the same mesh has a response in {summary['balanced']} of {len(tried)} motions that "
            f"keep the line taut, {_percent(summary['balance_median'])} from the history in the median"
        )
    marks = "Filled marks: the history warned of its mesh, its steps or of a motion not yet periodic"
    return f"{'; '.join(parts)}. {marks}; dashed: {100 * data['large']:g} %."


def is_own(point: dict) -> bool:
    """Return whether a point is of nodes and elements."""
    return point["method"] in OWN
