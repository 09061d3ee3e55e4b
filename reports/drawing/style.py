"""One look for every figure: sizes, one colour and marker per solver, and SVG that follows the page's theme."""

from __future__ import annotations

import io
import re
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import numpy as np
from matplotlib import pyplot as plt
from matplotlib.colors import ListedColormap

from ..page.figures import Figure
from ..page.numbers.analysis import sort_solvers
from ..page.numbers.formatting import slug
from ..pipeline.dependencies.ledger import write_atomically
from . import background, figure_data

INK, PALE, GRID = "#1c1d20", "#8b8f98", "#d5d7db"
THEME = {INK: "var(--ink)", PALE: "var(--pale)", GRID: "var(--grid)"}
"""Colours of the files, and what the page puts in their place so that its dark theme reaches into the figures."""

PALETTE = ("#2a7fb8", "#d9701a", "#1a9a72", "#b35aa0", "#a3851a", "#6f6fc0")
"""Colour-blind safe (after Okabe and Ito), dark enough for white paper and light enough for a dark page."""
MARKERS = "osD^vP"
WRONG, REFUSED = "#cc2936", "#1c1d20"
RECOMMENDED = "#f2c230"
SEABED, WATER = "#a3851a", "#2a7fb8"
# Without the ends of the map, which white or black paper would swallow.
TENSION_COLOURS = ListedColormap(plt.get_cmap("plasma")(np.linspace(0.15, 0.9, 256)))

PANEL = (4.7, 3.5)  # inches: one of two columns on the page, and the width of a telephone
WIDE = (9.6, 3.6)

plt.rcParams.update(
    {
        "font.family": "DejaVu Sans", "font.size": 10, "axes.titlesize": 10.5,
        "axes.labelsize": 10, "xtick.labelsize": 9, "ytick.labelsize": 9, "legend.fontsize": 9,
        "text.color": INK, "axes.labelcolor": INK, "axes.edgecolor": PALE, "xtick.color": INK, "ytick.color": INK,
        "axes.titleweight": "bold", "axes.titlelocation": "left", "axes.spines.top": False, "axes.spines.right": False,
        "axes.grid": True, "grid.color": GRID, "grid.linewidth": 0.6, "axes.axisbelow": True,
        "legend.frameon": False, "legend.handletextpad": 0.4, "legend.columnspacing": 1.2,
        "lines.linewidth": 1.6, "lines.markersize": 5.5, "svg.fonttype": "none", "figure.dpi": 100,
        "figure.constrained_layout.use": True,
    }
)  # fmt: skip


def assign_looks(names) -> dict[str, dict]:
    """Return colour and marker of every solver; the batch call of this project shares its colour."""
    looks = {}
    for name in sort_solvers(names):
        base = name.removesuffix("-batch")
        shared = {"color": looks[base]["color"]} if base in looks else {}
        rank = len({look["color"] for look in looks.values()}) % len(PALETTE)
        looks[name] = {"color": PALETTE[rank], "marker": MARKERS[len(looks) % len(MARKERS)]} | shared
    return looks


def add_missing_looks(known: dict, names) -> dict[str, dict]:
    """Return ``known`` looks, and one for each of the names that has none, such as an external solver."""
    new = [name for name in names if name not in known]
    return known | {
        name: {"color": PALETTE[-1 - k % len(PALETTE)], "marker": "*<>hX"[k % 5]} for k, name in enumerate(new)
    }


def save(
    figure, folder: Path, name: str, title: str, alt: str, rows: list[dict] | None = None, chart: str = ""
) -> Figure:
    """Write name.svg, name.png and name.csv to ``folder``; return the figure for the page.

    rows : the data where they are more than what is drawn, such as a map over numbered cells; else read off the figure.
    chart : JSON of the same rows as an interactive chart.
    Raises ValueError where an axis does not say what it shows.
    """
    if missing := figure_data.unlabelled_axes(figure):
        raise ValueError(f"figure {name!r}: axes without a label: {', '.join(missing)}")
    write_atomically(
        folder / f"{name}.csv", figure_data.to_csv(figure_data.drawn_rows(figure) if rows is None else rows)
    )
    width = figure.get_size_inches()[0]
    drawn = io.StringIO()
    nothing = dict.fromkeys(("Creator", "Date", "Format", "Type"))
    with plt.rc_context({"svg.hashsalt": name}):
        figure.savefig(drawn, format="svg", metadata=nothing, transparent=True)
        write_atomically(folder / f"{name}.svg", _add_white_background(drawn.getvalue()))
    figure.set_layout_engine("none")  # the layout is done: the PNG is drawn with the same places
    quickly = {"pil_kwargs": {"compress_level": 1}}  # a fifth of the time of a PNG is its compression
    background.start(lambda: figure.savefig(folder / f"{name}.png", dpi=160, facecolor="white", **quickly))
    plt.close(figure)
    return Figure(name, title, alt, _embed(drawn.getvalue(), name, alt, width), width > 6, chart)


def save_in_section(section: str, figure, folder: Path, name: str, title: str, alt: str, *more) -> Figure:
    """Save a figure under the names that all figures of a section have; more: rows and chart."""
    return save(figure, folder, f"{section}_{slug(name)}", title, alt, *more)


def _add_white_background(svg: str) -> str:
    """Return the same drawing on white paper, for a file of its own."""
    return re.sub(r"(<svg [^>]*>)", r'\1<rect width="100%" height="100%" fill="#ffffff"/>', svg, count=1)


def _embed(svg: str, name: str, alt: str, width: float) -> str:
    """Return the <svg> element for the page: theme colours as variables, ids of its own, described in words."""
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r"<metadata>.*?</metadata>\s*", "", svg, flags=re.DOTALL)
    svg = re.sub(r'\bid="([^"]+)"', rf'id="{name}-\1"', svg)
    svg = re.sub(r"url\(#([^)]+)\)", rf"url(#{name}-\1)", svg)
    svg = re.sub(r'href="#([^"]+)"', rf'href="#{name}-\1"', svg)
    svg = svg.replace("'DejaVu Sans'", "'DejaVu Sans', Verdana, sans-serif")  # Verdana is as wide
    for colour, variable in THEME.items():
        svg = svg.replace(colour, variable)
    svg = re.sub(r'(<svg [^>]*?)\s+width="[^"]*"', r"\1", svg, count=1)
    svg = re.sub(r'(<svg [^>]*?)\s+height="[^"]*"', r"\1", svg, count=1)
    alt = alt.replace("&", "&amp;").replace('"', "&quot;").replace("<", "&lt;")
    return svg.replace("<svg ", f'<svg role="img" aria-label="{alt}" style="max-width:{96 * width:.0f}px" ', 1)
