"""Figures of response curves: tensions over frequency, multipliers in the complex plane, maps and costs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.colors import ListedColormap

from ..drawing import interactive, style
from ..drawing.axes import KN, add_legend, panel
from ..page.figures import Figure

SPECIAL = {"fold": "v", "branch point": "s", "period doubling": "D", "Neimark-Sacker": "P", "jump": "X"}
"""Marker of each kind of special point."""
UNSTABLE = {"linestyle": ":", "linewidth": 1.4}


def curve_figure(case: dict, folder: Path) -> Figure:
    """Return greatest and least tension over frequency, a colour for each amplitude, unstable parts dotted."""
    figure, axes = panel(case["title"], "frequency, Hz", "tension at the moved end, kN")
    drawn: set[str] = set()
    for rank, row in enumerate(case["curves"]):
        colour = style.PALETTE[rank]
        _draw_curve(axes, row["curve"], f"{row['amplitude']:g} m", colour, drawn)
        for branch in row["branches"]:
            colour = style.PALETTE[3 if branch["name"].startswith("sideways") else 4]
            _draw_curve(axes, branch, branch["name"], colour, drawn)
    add_legend(figure, axes, 3)
    amplitudes = ", ".join(f"{row['amplitude']:g}" for row in case["curves"])
    alt = f"{case['title']}: greatest and least tension over frequency, amplitudes {amplitudes} m."
    rows, special, colours = _curve_rows(case)
    chart = interactive.draw_curves(rows, special, colours, ("frequency, Hz", "tension at the moved end, kN"))
    return style.save(figure, folder, f"curves_{case['name']}", case["title"], alt, rows + special, chart)


def _curve_rows(case: dict) -> tuple[list[dict], list[dict], dict[str, str]]:
    """Return the points of all curves of a case, its special points, and the colour of each curve."""
    rows: list[dict] = []
    special: list[dict] = []
    colours = {}
    for rank, row in enumerate(case["curves"]):
        curves = {f"{row['amplitude']:g} m": (row["curve"], rank)}
        curves |= {b["name"]: (b, 3 if b["name"].startswith("sideways") else 4) for b in row["branches"]}
        for name, (curve, place) in curves.items():
            colours[name] = style.PALETTE[place]
            rows += _points_of(name, curve)
            special += _special_points_of(name, curve)
    return rows, special, colours


def _points_of(name: str, curve: dict) -> list[dict]:
    """Return both bounds of the tension along a curve, in its order."""
    return [
        {"series": name, "bound": bound, "frequency_Hz": frequency, "tension_kN": KN * tension,
         "state": "stable" if stable else "unstable"}
        for bound in ("greatest", "least")
        for frequency, tension, stable in zip(curve["frequency"], curve[bound], curve["stable"], strict=True)
    ]  # fmt: skip


def _special_points_of(name: str, curve: dict) -> list[dict]:
    """Return the special points of a curve."""
    return [{"series": name, "kind": point["kind"], "frequency_Hz": point["value"],
             "tension_kN": KN * point["tension"], "marker": SPECIAL[point["kind"]]}
            for point in curve["special"]]  # fmt: skip


def _draw_curve(axes, curve, label, colour, drawn):
    frequency = np.array(curve["frequency"])
    stable = np.array(curve["stable"], dtype=bool)
    for key in ("greatest", "least"):
        tension = KN * np.array(curve[key], dtype=float)
        for of, look in ((stable, {}), (~stable, UNSTABLE)):
            with_next = of[:-1] | of[1:] if of is not stable else of[:-1] & of[1:]
            shown = np.concatenate([with_next, [False]]) | np.concatenate([[False], with_next])
            part = np.where(shown, tension, np.nan)
            if np.isfinite(part).any():
                axes.plot(frequency, part, color=colour, label="_" if label in drawn else label, **look)
                drawn.add(label)
    for point in curve["special"]:
        kind = point["kind"]
        axes.plot([point["value"]], [KN * point["tension"]], SPECIAL[kind], color=style.INK, markersize=5,
                  label="_" if kind in drawn else kind)  # fmt: skip
        drawn.add(kind)


def multiplier_figure(case: dict, folder: Path) -> Figure:
    """Return the leading multipliers along a curve in the complex plane, those outside the circle marked."""
    figure, axes = panel("Multipliers along the curve", "real part", "imaginary part")
    angle = np.linspace(0, 2 * np.pi, 200)
    axes.plot(np.cos(angle), np.sin(angle), color=style.PALE, linewidth=1, label="unit circle")
    values = np.array([each for point in case["curves"][-1]["curve"]["multipliers"] for each in point], dtype=float)
    size = np.hypot(*values.T)
    for of, label, colour in ((size <= 1, "inside", style.PALETTE[0]), (size > 1, "outside", style.WRONG)):
        if of.any():
            axes.plot(*values[of].T, ".", color=colour, markersize=4, label=label)
    reach = max(1.3, 1.05 * size.max())
    axes.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal")
    add_legend(figure, axes, 3)
    alt = f"Floquet multipliers in the complex plane with the unit circle; {int((size > 1).sum())} lie outside."
    return style.save(figure, folder, f"curves_multipliers_{case['name']}", "Multipliers in the complex plane", alt)


def comparison_figures(rows: list[dict], folder: Path) -> list[Figure]:
    """Return the difference of Hill's problem and the monodromy by harmonics and by steps, logarithmic."""
    most = max(row["harmonics"] for row in rows), max(row["steps"] for row in rows)
    drawn = []
    for key, other, label in (("harmonics", most[1], "harmonics"), ("steps", most[0], "steps in the period")):
        hold = "steps" if key == "harmonics" else "harmonics"
        mine = [row for row in rows if row[hold] == other and row["difference"] is not None]
        title = f"Hill against monodromy by {key}"
        figure, axes = panel(title, label, "difference of multipliers", xscale="log", yscale="log")
        axes.plot([row[key] for row in mine], [row["difference"] for row in mine], "o-", color=style.PALETTE[0])
        axes.set_xticks([row[key] for row in mine], [str(row[key]) for row in mine])
        axes.minorticks_off()
        alt = f"Difference of the multipliers of both methods against {label}, {hold} {other}."
        drawn.append(style.save(figure, folder, f"curves_methods_{key}", title, alt))
    return drawn


def count_figure(data: dict, folder: Path) -> Figure:
    """Return a map of how many stable responses there are, over frequency and amplitude."""
    counts = np.array(data["stable"])
    colours = ["#d5d7db", "#9ecae1", "#2a7fb8", "#d9701a"][: max(2, counts.max() + 1)]
    figure, axes = panel("Stable responses in the plane", "frequency, Hz", "amplitude, mm")
    mesh = axes.pcolormesh(data["frequency"], 1e3 * np.array(data["amplitude"]), counts, cmap=ListedColormap(colours),
                           vmin=-0.5, vmax=len(colours) - 0.5, shading="nearest", rasterized=True)  # fmt: skip
    bar = figure.colorbar(mesh, ax=axes, ticks=range(len(colours)))
    bar.set_label("stable responses")
    axes.grid(False)
    rows = [{"frequency_Hz": f, "amplitude_m": a, "stable": int(counts[i, j]), "responses": data["total"][i][j]}
            for i, a in enumerate(data["amplitude"]) for j, f in enumerate(data["frequency"])]  # fmt: skip
    alt = f"Map of the number of stable responses over frequency and amplitude; up to {counts.max()}."
    return style.save(figure, folder, "curves_count", "Number of stable responses", alt, rows)


def basin_figure(data: dict, folder: Path) -> Figure:
    """Return the shares of starts that come to each response, with their intervals."""
    figure, axes = panel("Shares of random starts", "largest displacement, mm", "share of the starts, %")
    for row in data["rows"]:
        share, low, high = (100 * row[key] for key in ("share", "low", "high"))
        colour = style.PALETTE[0] if row["stable"] else style.WRONG
        name = "stable" if row["stable"] else "unstable"
        axes.errorbar([1e3 * row["size"]], [share], yerr=[[share - low], [high - share]], fmt="o", color=colour,
                      capsize=4, label=name if name not in axes.get_legend_handles_labels()[1] else "_")  # fmt: skip
    axes.set(ylim=(-3, 103))
    add_legend(figure, axes)
    alt = "Share of random starts that come to each coexisting response, with confidence intervals."
    return style.save(figure, folder, "curves_basins", "Shares of the basins", alt)


def parametric_figures(data: dict, folder: Path) -> list[Figure]:
    """Return maps of the growth of disturbances sideways and in the plane, where they grow."""
    drawn = []
    for key, title in (("sideways", "Growth across the plane"), ("upward", "Growth in the plane")):
        growth = np.array(data[key], dtype=float)
        figure, axes = panel(title, "frequency / first sideways frequency", "amplitude, mm")
        x, y = np.array(data["frequency"]) / data["natural"], 1e3 * np.array(data["amplitude"])
        shown = np.ma.masked_invalid(np.where(growth > 0, growth, np.nan))
        axes.set_facecolor(style.GRID)
        mesh = axes.pcolormesh(x, y, shown, cmap="viridis", shading="nearest", rasterized=True,
                               vmin=0, vmax=max(float(np.nanmax(growth)), 1e-6))  # fmt: skip
        figure.colorbar(mesh, ax=axes).set_label("growth rate, per second")
        axes.grid(False)
        rows = [{"frequency_Hz": f, "amplitude_m": a, "growth_per_s": data[key][i][j]}
                for i, a in enumerate(data["amplitude"]) for j, f in enumerate(data["frequency"])]  # fmt: skip
        alt = f"{title} over frequency and amplitude: {int((growth > 0).sum())} of {growth.size} points unstable."
        drawn.append(style.save(figure, folder, f"curves_parametric_{key}", title, alt, rows))
    return drawn


def cost_figure(data: dict, folder: Path) -> Figure:
    """Return the CPU time of a point with stability by cells, both logarithmic."""
    cells, seconds = ([row[key] for row in data["rows"]] for key in ("cells", "seconds"))
    figure, axes = panel("Cost of a point with stability", "cells", "CPU time, ms", xscale="log", yscale="log")
    axes.plot(cells, 1e3 * np.array(seconds), "o-", color=style.PALETTE[0])
    axes.set_xticks(cells, [str(each) for each in cells])
    axes.minorticks_off()
    alt = "CPU time of a point of the curve with its multipliers against cells, both logarithmic."
    return style.save(figure, folder, "curves_cost", "Cost of a point", alt)


def sweep_figure(report: dict, name: str, folder: Path) -> Figure:
    """Return the greatest and least tension of each line of one's own over the band, unstable parts dotted."""
    figure, axes = plt.subplots(figsize=style.WIDE)
    drawn: set[str] = set()
    rows: list[dict] = []
    for curve in report["curves"]:
        for e, line in enumerate(report["lines"]):
            special = [] if e else curve["special"]
            part = {"frequency": curve["frequency"], "greatest": curve["greatest"][e], "least": curve["least"][e],
                    "stable": curve["stable"], "special": special}  # fmt: skip
            _draw_curve(axes, part, line, style.PALETTE[e % len(style.PALETTE)], drawn)
            rows += _points_of(line, part) + _special_points_of(line, part)
    label = "time integration"
    for row in report["integrated"]:
        for e, ends in enumerate(zip(row["greatest"], row["least"], strict=True)):
            colour = style.PALETTE[e % len(style.PALETTE)]
            axes.plot([row["frequency"]] * 2, KN * np.array(ends), "o", color=colour, markersize=4, fillstyle="none",
                      label=label)  # fmt: skip
            label = "_"
            rows += [{"series": report["lines"][e], "bound": bound, "frequency_Hz": row["frequency"],
                      "tension_kN": KN * tension, "state": "time integration"}
                     for bound, tension in zip(("greatest", "least"), ends, strict=True)]  # fmt: skip
    low, high = report["band"]
    axes.set(title=f"{report['name']}: tension over the band", xlabel="frequency, Hz", ylabel="tension, kN",
             xlim=(low, high))  # fmt: skip
    add_legend(figure, axes, 4)
    alt = f"Greatest and least tension of each line from {low:g} to {high:g} Hz."
    return style.save(figure, folder, f"{name}_sweep", "Tension over the band", alt, rows)
