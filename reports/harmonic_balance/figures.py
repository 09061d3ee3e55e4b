"""The figures on harmonic balance beyond those of the paper: harmonics, tension along the line, limits and cost."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt

from ..cable.cases import motion_of, save
from ..drawing import style
from ..drawing.axes import KN, LOOKS, add_legend, panel, set_decade_ticks, set_size_ticks
from ..page.figures import Group
from ..page.numbers.formatting import across, number, seconds

LEAST_SHOWN = 1e-4  # kN: of a spectrum


def needed(data: dict, folder: Path) -> Group:
    """Return error against number of harmonics."""
    title = "Error in the number of harmonics alone"
    figure, axes = panel(title, "harmonics Nh", "rms error over the range", xscale="log", yscale="log")
    for row, look in zip(data["summary"], LOOKS, strict=False):
        mine = [r for r in data["rows"] if r["case"] == row["case"]]
        axes.plot(
            [r["harmonics"] for r in mine], [r["rms"] for r in mine], label=motion_of(row["case"]), linewidth=1, **look
        )
    ticks = sorted({r["harmonics"] for r in data["rows"]})
    set_decade_ticks(axes, "y")
    set_size_ticks(axes, ticks)
    add_legend(figure, axes)
    drawn = save(figure, folder, "needed", title, "Error by number of harmonics, both logarithmic, four cases.")
    rates = across(row["rate"] for row in data["summary"])
    level = "0.001"
    need = {row["case"]: row[level] for row in data["summary"]}
    counts = ", ".join(f"{motion_of(case)} {most or 'more than tried'}" for case, most in need.items())
    caption = (
        f"Against {data['most']} harmonics on the same {data['nodes']} nodes. The drag |v|v has a kink, so the decay "
        f"is algebraic, with exponents {rates} here, and slower where the axial mode answers, near harmonic "
        f"{number(data['axial'])}. Harmonics for an rms error of {level} of the range: {counts}. The last case moves "
        "with the second harmonic, so that its harmonics count half."
    )
    return Group(caption, [drawn])


def spectra(rows: list[dict], folder: Path) -> Group:
    """Return amplitude of the harmonics of the fairlead tension."""
    figure, grid = plt.subplots(1, len(rows), figsize=(style.WIDE[0], 3.2), sharey=True)
    for axes, row in zip(grid, rows, strict=True):
        amplitudes = np.array(row["amplitudes"][1:]) * KN
        k = np.arange(1, len(amplitudes) + 1)
        some = amplitudes > 1e-9 * amplitudes.max()  # those that a symmetry leaves
        axes.vlines(k[some], LEAST_SHOWN, amplitudes[some], color=style.PALETTE[0], linewidth=1.2)
        axes.plot(k[some], amplitudes[some], "o", color=style.PALETTE[0], markersize=3)
        axes.set(title=motion_of(row["case"]), xlabel="harmonic", yscale="log", ylim=(LEAST_SHOWN, 2e3))
    set_decade_ticks(grid[0], "y")
    grid[0].set_ylabel("amplitude, kN")
    title = "Harmonics of the fairlead tension"
    figures = [save(figure, folder, "spectra", title, f"{title}, logarithmic, a panel a case.")]
    late_harmonics = []
    for row in rows:
        a = np.array(row["amplitudes"][1:]) * KN
        late = a[19:] if len(a) > 20 else a[-1:]
        late_harmonics.append(
            f"{motion_of(row['case'])} {number(late.max(), 2)} kN at harmonic "
            f"{len(a) - len(late) + int(late.argmax()) + 1}"
        )
    caption = (
        "Harmonics of the fairlead tension. Out-of-plane motion of a planar line makes even ones only. The greatest "
        f"late harmonic: {'; '.join(late_harmonics)}; the axial mode of the line lies at {number(rows[0]['axial'])} "
        "times the frequency."
    )
    return Group(caption, figures)


def envelope(rows: list[dict], folder: Path) -> Group:
    """Return least, mean and greatest tension along the line."""
    figure, grid = plt.subplots(1, len(rows), figsize=(style.WIDE[0], 3.4), sharey=True)
    for axes, row in zip(grid, rows, strict=True):
        s = np.array(row["s"])
        low, high, mean, rest = (np.array(row[key]) * KN for key in ("min", "max", "mean", "rest"))
        axes.fill_between(s, low, high, color=style.PALETTE[0], alpha=0.25, linewidth=0)
        axes.plot(s, mean, color=style.PALETTE[0], linewidth=1.4, label="mean")
        axes.plot(s, rest, "--", color=style.INK, linewidth=1, label="at rest")
        axes.plot(s[row["node"] - 1], row["least"] * KN, "v", color=style.WRONG, label="least")
        axes.set(title=motion_of(row["case"]), xlabel="s, m", xticks=(0, 400, 800))
        axes.axhline(0, color=style.PALE, linewidth=0.8)
    grid[0].set_ylabel("tension, kN")
    add_legend(figure, grid[0], 3)
    drawn = save(
        figure, folder, "envelope", "Envelope of the tension", "Least, mean and greatest tension along the line."
    )
    least = "; ".join(
        f"{motion_of(row['case'])}: {number(row['least'] * KN, 3)} kN at node {row['node']} (s = "
        f"{number(row['s'][row['node'] - 1])} m), {number(row['at'], 3)} s"
        for row in rows
    )
    return Group(f"Range of the tension over a period along the line. Nearest to zero: {least}.", [drawn])


def limit(data: dict, folder: Path) -> Group:
    """Return least tension against amplitude."""
    rows = [row for row in data["rows"] if row["reached"] == 1.0]
    figure, axes = panel("Surge raised until the tension vanishes", "amplitude, m", "least tension over a period, kN")
    x = [row["amplitude"] for row in rows]
    for (key, label), look in zip(
        (("least", "anywhere on the line"), ("fairlead", "at the fairlead")), LOOKS, strict=False
    ):
        axes.plot(x, [row[key] * KN for row in rows], label=label, linewidth=1, **look)
    slack = [row for row in rows if row["status"] != "SUCCESS"]
    axes.plot([r["amplitude"] for r in slack], [r["least"] * KN for r in slack], "x", color=style.WRONG, markersize=10,
              markeredgewidth=2, label="compression")  # fmt: skip
    axes.axhline(0, color=style.PALE, linewidth=1)
    add_legend(figure, axes, 3)
    drawn = save(figure, folder, "limit", "Vanishing tension", "Least tension by amplitude of the surge.")
    sentences = []
    if data["vanishes"]:
        first = next(row for row in rows if row["least"] < 0)
        sentences.append(
            f"The tension vanishes at an amplitude of {number(data['vanishes'], 4)} m, first at node {first['node']} "
            f"(s = {number(first['s'])} m from the anchor), {number(first['at'], 3)} s into the period, not at the "
            "fairlead; from there on the status says compression."
        )
    failed = [row for row in data["rows"] if row["reached"] < 1.0]
    for row in failed:
        sentences.append(
            f"At {row['amplitude']:g} m no response was found: the solver gave up at {number(row['reached'], 3)} of "
            f"the amplitude after {row['iterations']} steps, and its status says so."
        )
    return Group(" ".join(sentences), [drawn])


def growth(data: dict, folder: Path) -> Group:
    """Return seconds by nodes and by harmonics."""
    figures = []
    for title, xlabel, name in (
        ("Growth with nodes", "nodes N", "nodes"),
        ("Growth with harmonics, sway", "harmonics Nh", "harmonics"),
    ):
        figure, axes = panel(title, xlabel, "time of one solve, s", xscale="log", yscale="log")
        mine = [row for row in data["rows"] if row["series"] == name]
        axes.plot([r["size"] for r in mine], [r["seconds"] for r in mine], linewidth=1, **LOOKS[0])
        set_decade_ticks(axes, "y")
        set_size_ticks(axes, sorted({r["size"] for r in mine}))
        figures.append(save(figure, folder, f"growth_{name}", title, f"{title}: time of one solve, logarithmic."))
    p, start = data["exponents"], data["fitted_from"]
    last = max((r for r in data["rows"] if r["series"] == "nodes"), key=lambda r: r["size"])
    caption = (
        f"With {data['harmonics']} harmonics the time grows as N to the power {number(p['nodes'], 3)} (from "
        f"{start['nodes']} nodes on; {seconds(last['seconds'])} for {last['size']}). With {data['nodes']} nodes it "
        f"grows as Nh to the power {number(p['harmonics'], 3)} (from {start['harmonics']} harmonics on)."
    )
    return Group(caption, figures)
