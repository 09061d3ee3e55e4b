"""The figures on networks of lines: gain of the monolithic method and growth with size."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.ticker import LogLocator, NullFormatter

from . import style
from .words import across, number, ratio, seconds


def growth(data: dict, folder: Path) -> style.Group | None:
    """Seconds against elements, one line a family, with the fitted power law."""
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
        if far.any():
            constant = np.exp(np.mean(np.log(t[far]) - exponent * np.log(n[far])))
            axes.plot(n[far], constant * n[far] ** exponent, "--", color=style.INK, linewidth=1)
    axes.set(xscale="log", yscale="log", xlabel="elements", ylabel="time of one solve without a start, s")
    _decades(axes)
    figure.legend(loc="outside upper center", ncols=3)
    alt = "Time of one solve against the number of elements, both logarithmic: chain, net and tree."
    drawn = style.save(figure, folder, "networks_growth", "Growth with size", alt)
    return style.Group(_growth_caption(data), [drawn])


def _growth_caption(data: dict) -> str:
    said = []
    for family, exponent in data["exponents"].items():
        last = max((row for row in data["rows"] if row["family"] == family), key=lambda row: row["elements"])
        said.append(
            f"{family}: elements to the power {number(exponent)}, "
            f"{seconds(last['seconds'])} for {number(last['elements'])}"
        )
    failed = [row for row in data["rows"] if row["status"] != "SUCCESS"]
    memory = [row["peak_MB"] for row in data["rows"] if row.get("peak_MB") is not None]
    text = f"Fitted from {number(data['fitted_from'])} elements on (dashed): {'; '.join(said)}."
    if memory:
        text += f" The largest of each hold {across(memory)} MB at most, the factors of the sparse matrix not counted."
    return f"{text} {len(failed)} of {len(data['rows'])} solves failed."


def gain(rows: list[dict], looks: dict, folder: Path) -> style.Group | None:
    """Time of both methods for chains of growing size."""
    chains = sorted((row for row in rows if row["system"].startswith("chain")), key=lambda row: row["elements"])
    if len(chains) < 2:
        return None
    figure, axes = plt.subplots(figsize=style.PANEL)
    n = [row["elements"] for row in chains]
    for rank, (name, label) in enumerate(
        (("monolithic", "monolithic, analytic"), ("nested_differences", "nested, differences"))
    ):
        t = [1e3 * row[f"{name}_seconds"] for row in chains]
        axes.plot(n, t, label=label, linewidth=1, color=style.PALETTE[rank], marker=style.MARKERS[rank])
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
        f"Warm re-solves of a chain whose end moves by 1 %; the ratio grows from {ratio(first['ratio'])} at "
        f"{first['elements']} elements to {ratio(last['ratio'])} at {last['elements']}. Least times of all turns."
    )
    return style.Group(caption, [drawn])


def _decades(axes):
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(numticks=9))
        axis.set_minor_formatter(NullFormatter())
