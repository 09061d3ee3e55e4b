"""Error against run time of the moving cables, all methods, and what they cost at equal error."""

from __future__ import annotations

from pathlib import Path
from statistics import median

from matplotlib import pyplot as plt

from ..cable.cases import CASES, METHODS, motion_of, save
from ..drawing import interactive, style
from ..drawing.axes import add_legend, set_decade_ticks
from ..page.figures import Group
from ..page.numbers.analysis import pareto_front
from ..page.numbers.formatting import number, times


def work(data: dict, folder: Path) -> Group:
    """Return error against run time, a panel a case."""
    figures, shares = [], []
    for case in dict.fromkeys(point["case"] for point in data["points"]):
        points = [p for p in data["points"] if p["case"] == case and p["rms"]]
        figure, axes = plt.subplots(figsize=(style.PANEL[0], 3.9))
        looks = style.add_missing_looks(METHODS, dict.fromkeys(p["method"] for p in data["points"]))
        for method in (name for name in looks if any(p["method"] == name for p in points)):
            mine = [p for p in points if p["method"] == method]
            axes.plot(
                [p["seconds"] for p in mine],
                [p["rms"] for p in mine],
                linestyle="none",
                label=method,
                **looks[method],
            )
        front = pareto_front(points, "rms")
        axes.plot([p["seconds"] for p in front], [p["rms"] for p in front], "o", markersize=11, markerfacecolor="none",
                  markeredgecolor=style.INK, linestyle="-", color=style.PALE, linewidth=0.8, zorder=1)  # fmt: skip
        axes.axhspan(axes.get_ylim()[0], data["uncertainty"][case], color=style.PALE, alpha=0.25, linewidth=0)
        axes.set(title=CASES[case], xscale="log", yscale="log", xlabel="run time, s", ylabel="rms error over the range")
        set_decade_ticks(axes)
        add_legend(figure, axes)
        alt = f"Error of the fairlead tension against run time, both logarithmic: {CASES[case]}."
        rows = [_row(p, front) for p in points]
        chart = interactive.draw_work(rows, looks, ("run time", "rms error over the range"),
                                      band=data["uncertainty"][case])  # fmt: skip
        figures.append(save(figure, folder, f"work_{case}", CASES[case], alt, rows, chart))
        others = sum(not p["method"].startswith("harmonic") for p in front)
        shares.append(f"{motion_of(case)}: {len(front) - others} of {len(front)} points of the front")
    caption = (
        "Each point is one setting; lower and further left is better; rings: the Pareto front. Of harmonic balance "
        f"are, {'; '.join(shares)}. {' '.join(_equal_error(data['points']))} The grey band is the uncertainty of the "
        "reference. “Extrapolated” solves in time on two meshes with two steps and takes the error of second order "
        "out. “Corrected” adds to harmonic balance up to three steps with the last Jacobian to equations of fourth "
        "order."
    )
    return Group(caption, figures)


def _row(point: dict, front: list[dict]) -> dict:
    """Return a setting for the CSV and the chart, unrounded."""
    setting = f"{point['harmonics']} harmonics" if "harmonics" in point else f"time step {point['dt']:g} s"
    return {"method": point["method"], "setting": f"{point['size']} nodes or cells, {setting}",
            "time_s": point["seconds"], "error": point["rms"], "greatest error": point["error"],
            "front": "yes" if point in front else ""}  # fmt: skip


def ratios_at_equal_error(points: list[dict], method: str, family: str = "harmonic") -> list[float]:
    """Return, for the points of a method's own Pareto front, its time over the least of harmonic balance at that error.

    Names that begin with ``method`` are one method, so are those of the family: each side has its best settings.
    """
    ratios = []
    for case in dict.fromkeys(p["case"] for p in points):
        mine = [p for p in points if p["case"] == case and p["rms"] is not None]
        ours = [p for p in mine if p["method"].startswith(family)]
        for point in pareto_front([p for p in mine if p["method"].startswith(method)], "rms"):
            good = [p["seconds"] for p in ours if p["rms"] <= point["rms"]]
            if good:
                ratios.append(point["seconds"] / min(good))
    return ratios


def _equal_error(points) -> list[str]:
    sentences = []
    for method in dict.fromkeys(p["method"].split(",")[0] for p in points if not p["method"].startswith("harmonic")):
        ratios = ratios_at_equal_error(points, method)
        if ratios:
            faster = sum(r < 1 for r in ratios)
            end = f"; in {faster} of them it is the faster one" if faster else ""
            sentences.append(
                f"At the error of each of its best settings (its own Pareto front), {method} takes "
                f"{times(median(ratios))} as long as harmonic balance (median of {len(ratios)}, "
                f"{number(min(ratios), 2)} to {number(max(ratios), 2)}{end})."
            )
    return sentences


def ratios_at_level(rows: list[dict], level: float, method: str, family: str = "harmonic balance") -> list[float]:
    """Return the least time of a method to an error over that of the family, for the cases in which both reach it."""
    pairs = [(row["best"].get(method), row["best"].get(family)) for row in rows if row["level"] == level]
    return [theirs["seconds"] / ours["seconds"] for theirs, ours in pairs if theirs and ours]
