"""The figures on moving networks beside MoorDyn. Captions come from the same data."""

from __future__ import annotations

from pathlib import Path
from statistics import median

from matplotlib import pyplot as plt

from ..drawing import interactive, style
from ..drawing.axes import LOOKS, add_legend, panel, set_decade_ticks, set_size_ticks
from ..page.figures import Figure, Group
from ..page.numbers.analysis import pareto_front
from ..page.numbers.formatting import across, number, plural, seconds, times
from .cases import LEGEND, METHODS, save_network
from .figures import list_settings

PEER = "MoorDyn"


def work(data: dict, folder: Path) -> Group:
    """Return error against run time of the nine lines."""
    title = f"Error against run time: {data['title']}"
    points = [point for point in data["points"] if point["rms"]]
    figure, axes = plt.subplots(figsize=(style.PANEL[0], 4.4))
    for method in (name for name in METHODS if any(p["method"] == name for p in points)):
        mine = [p for p in points if p["method"] == method]
        front = pareto_front(mine, "rms")
        axes.plot([p["seconds"] for p in mine], [p["rms"] for p in mine], linestyle="none",
                  label=LEGEND.get(method, method), **METHODS[method])  # fmt: skip
        axes.plot([p["seconds"] for p in front], [p["rms"] for p in front], linewidth=0.9, alpha=0.7,
                  color=METHODS[method]["color"], label="_front")  # fmt: skip
    axes.set(title="Nine lines with bridles", xscale="log", yscale="log", xlabel="run time, s",
             ylabel="largest rms error over the range")  # fmt: skip
    lowest = min(axes.get_ylim()[0], data["uncertainty"] / 2)
    axes.set_ylim(bottom=lowest)
    axes.axhspan(lowest, data["uncertainty"], color=style.PALE, alpha=0.25, linewidth=0)
    set_decade_ticks(axes)
    add_legend(figure, axes)
    alt = f"Error of the fairlead tensions against run time, both logarithmic: {data['title']}."
    rows, labels = list_settings(points), ("run time", "largest rms error over the range")
    chart = interactive.draw_work(rows, METHODS, labels, band=data["uncertainty"])
    return Group(_work_caption(data), [save_network(figure, folder, "work", title, alt, rows, chart)])


def _work_caption(data) -> str:
    title, apart = _beginning(data["title"]), data["references_apart"]
    failed = [p for p in data["points"] if p["status"] != "SUCCESS"]
    sentences = [
        f"{title}, from rest, one core and one thread; each point is one setting of cells and steps, or harmonics.",
        _comparison(data),
        f"In time on uniform meshes, to a tolerance of {data['tolerance']:g} of the largest change of a tension in "
        "Newton's method.",
        "Errors are the largest over the fairleads, over the last period.",
        f"Those of {PEER} are against its own fine run, {_percent(apart)} from that of this core, so that what the "
        "models have apart is no error of it." if apart else "",
        f"Equilibria are solved before the clock starts, for {PEER} too.",
        "The grey band is the uncertainty of the fine run of this core.",
        f"{plural(len(failed), 'setting')} gave no answer." if failed else "",
    ]  # fmt: skip
    return " ".join(sentence for sentence in sentences if sentence)


def _comparison(data) -> str:
    """Return how much longer MoorDyn takes at equal error, and at larger errors than are asked for."""
    ratios, coarse = ([row["ratio"] for row in data[key]] for key in ("ratios", "coarse_ratios"))
    if not ratios:
        return ""
    text = (
        f"At equal error {PEER} takes {across(ratios)} times as long as this core (median {times(median(ratios))}, "
        f"{plural(len(ratios), 'setting')} on its front with errors of {wanted_errors(data)}"
    )
    larger = f"; {across(coarse)} times at larger errors, to {100 * data['coarse']:g} %" if coarse else ""
    return f"{text}{larger})."


def wanted_errors(data) -> str:
    """Return such as "0.1 to 1 %", between which settings of MoorDyn are compared."""
    return f"{100 * data['wanted'][0]:g} to {100 * data['wanted'][1]:g} %"


def _beginning(text: str) -> str:
    return text[:1].upper() + text[1:]


def _percent(value: float) -> str:
    return f"{number(100 * value, 2)} %"


def growth(data: dict, folder: Path) -> Group:
    """Return run time and memory by lines."""
    kinds = (("seconds", 1.0, "Run time by lines", "run time, s"), ("memory", 1e6, "Memory by lines", "memory, MB"))
    return Group(_growth_caption(data), [_draw_growth(data, folder, *kind) for kind in kinds])


def _draw_growth(data, folder, key, unit, title, label) -> Figure:
    figure, axes = panel(title, "lines", label, xscale="log", yscale="log")
    lines = [row["lines"] for row in data["rows"]]
    axes.plot(lines, [row[key] / unit for row in data["rows"]], linewidth=1, **METHODS["in time"])
    set_decade_ticks(axes, "y")
    set_size_ticks(axes, lines)
    return save_network(figure, folder, f"growth_{key}", title, f"{title}, both logarithmic.")


def _growth_caption(data) -> str:
    first, last = data["rows"][0], data["rows"][-1]
    return (
        f"Chains of the OC3 spar around one body, {data['cells']} cells each, {plural(data['periods'], 'period')} of "
        f"{data['steps']} steps, every {data['every']}th kept, with the force on the body: "
        f"{seconds(first['seconds'])} and {first['memory'] / 1e6:.2g} MB for {first['lines']} lines, "
        f"{seconds(last['seconds'])} and {last['memory'] / 1e6:.2g} MB for {last['lines']}; lines to the power "
        f"{data['exponents']['seconds']:.2f} in time and {data['exponents']['memory']:.2f} in memory. "
        "One core; memory is what a call has at most beyond the lines at rest."
    )


def damping(data: dict, folder: Path) -> Group:
    """Return run time until a motion is periodic, and of harmonic balance, by drag."""
    title = "Periodic in time, and by harmonic balance"
    figure, axes = panel(title, "share of the drag", "run time, s", xscale="log", yscale="log")
    for k, name in enumerate(dict.fromkeys(row["system"] for row in data["rows"])):
        rows = [row for row in data["rows"] if row["system"] == name]
        for key, label, line in (("in_time", "in time", "-"), ("balance", "harmonic balance", "--")):
            mine = [row for row in rows if row[key] and (key == "in_time" or row["status"] == "SUCCESS")]
            axes.plot([r["drag"] for r in mine], [r[key] for r in mine], line, linewidth=1,
                      label=f"{rows[0]['title'].split(',')[0]}, {label}", **LOOKS[k])  # fmt: skip
    axes.invert_xaxis()
    set_decade_ticks(axes)
    add_legend(figure, axes, 1)
    alt = f"{title}: run times by share of the drag, logarithmic, two systems."
    drawn = save_network(figure, folder, "damping", title, alt)
    return Group(_damping_caption(data), [drawn])


def _damping_caption(data) -> str:
    sentences = []
    for name in dict.fromkeys(row["system"] for row in data["rows"]):
        rows = [row for row in data["rows"] if row["system"] == name]
        solved = [row for row in rows if row["status"] == "SUCCESS"]
        pays = [row for row in solved if row["in_time"] is None or row["balance"] < row["in_time"]]
        border = f"from {pays[0]['drag']:g} of the drag down" if pays else "at none of these"
        title = rows[0]["title"]
        sentences.append(f"{_beginning(title)}: harmonic balance is the faster one {border}")
    return (
        f"Periodic: a tension changes by no more than {data['periodic']:g} of its range (rms) from one period to the "
        f"next. {data['cells']} cells of the longest line, {data['steps']} steps a period or {data['harmonics']} "
        f"harmonics, one core, so that the two differ as the table says. {'. '.join(sentences)}."
    )
