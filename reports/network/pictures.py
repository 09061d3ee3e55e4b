"""Networks in space: lines with their tension in colour, nodes marked by kind, the seabed as a plane."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d.art3d import Line3DCollection

from ..drawing import style
from ..page.figures import Figure, Group
from ..page.numbers.formatting import number, plural

SIZE = (4.7, 3.9)  # inches
ELEVATION, AZIMUTH, BROADSIDE = 26, -38, -64  # degrees, of the view; broadside: on a network that is all but plane
FLAT, THIN = 0.32, 0.25  # least height and width of the box over its length; a flatter one is enlarged or widened
ROOM = 0.93  # of the box over its natural size in the axes
KINDS = {"fixed": "s", "free": "o", "coupled": "^"}
LABEL_ROOM = 7  # points between the ends of the tick labels and the name of an axis
CROWD = 20  # nodes beyond which markers are small


def pictures(rows: list[dict], folder: Path) -> Group:
    """Return one picture a network, each with its own scale of tension."""
    ranges = "; ".join(f"{row['title']}: {_describe(row)}" for row in rows if not row.get("near"))
    with plt.rc_context({"figure.constrained_layout.use": False}):  # it does not know boxes in space
        figures = [draw_network(row, f"networks_{row['name']}", folder) for row in rows]
    colours = "Colour is the tension, each picture in a scale of its own; the axes have one scale unless z is enlarged."
    return Group(f"{colours} {ranges}.", figures)


def _describe(row: dict) -> str:
    low, high = _tensions(row)
    return f"{plural(len(row['elements']), 'line')}, {number(low)} to {number(high)} kN"


def _tensions(row: dict) -> tuple[float, float]:
    """Return least and largest tension along all lines, kN."""
    tension = np.concatenate([element["tension"] for element in row["elements"]]) / 1e3
    return float(tension.min()), float(tension.max())


def draw_network(row: dict, name: str, folder: Path, draw_more: Callable | None = None) -> Figure:
    """Return a picture in space, without constrained layout; draw_more(axes) adds to it."""
    figure = plt.figure(figsize=SIZE)
    axes = figure.add_axes((-0.1, 0.13, 1.16, 0.79), projection="3d")  # its edge would cut lines
    lines = _lines(axes, row, _tensions(row)[1])
    size = _box(axes, row)
    if draw_more is not None:
        draw_more(axes)
    handles = _nodes(axes, row["nodes"])
    if row["seabed"] is not None:
        handles.append(_seabed(axes, row["seabed"]))
    enlarged = " (enlarged)" if size[2] < FLAT * max(size) else ""
    for label, axis, width in zip(("x, m", "y, m", f"z, m{enlarged}"), _axes(axes), size, strict=True):
        axis.set_label_text(label)
        axis.set_major_locator(MaxNLocator(4 if width > FLAT * max(size) or axis is axes.zaxis else 2))
        axis.set_pane_color((0, 0, 0, 0))
        axis.labelpad = LABEL_ROOM
    if size[1] < FLAT * max(size):  # its first number would stand on the last one of x
        axes.yaxis.set_major_locator(MaxNLocator(2, prune="lower"))
        axes.xaxis.labelpad = 2 * LABEL_ROOM
    axes.zaxis.labelpad = 1
    axes.zaxis.set_rotate_label(False)
    axes.zaxis.label.set_rotation(90)
    axes.tick_params(pad=0)
    plane = min(size[:2]) <= 1.01 * THIN * max(size)
    axes.view_init(elev=ELEVATION, azim=BROADSIDE if plane else AZIMUTH)
    figure.legend(handles=handles, loc="upper center", ncols=len(handles), bbox_to_anchor=(0.5, 0.945))
    figure.suptitle(row["title"], x=0.03, y=0.985, ha="left", fontsize=10.5, fontweight="bold")
    bar = figure.colorbar(lines, cax=figure.add_axes((0.12, 0.115, 0.76, 0.022)), orientation="horizontal")
    bar.set_label("tension, kN", labelpad=1)
    kinds = ", ".join(f"{len(_of(row['nodes'], kind))} {kind}" for kind in KINDS)
    alt = f"{row['title']} in space: {_describe(row)}; nodes: {kinds}."
    return style.save(figure, folder, name, row["title"], alt)


def _lines(axes, row: dict, top: float):
    """Draw all pieces of all lines as one collection, coloured by the tension in the middle of each, kN; return it."""
    pieces, values = [], []
    for element in row["elements"]:
        points = np.column_stack([element[axis] for axis in "xyz"])
        tension = np.array(element["tension"])
        pieces.append(np.stack([points[:-1], points[1:]], axis=1))
        values.append((tension[:-1] + tension[1:]) / 2e3)
    width = 3.0 if len(row["elements"]) < CROWD else 2.0
    lines = Line3DCollection(np.concatenate(pieces), cmap=style.TENSION_COLOURS, linewidths=width, capstyle="round")
    lines.set_array(np.concatenate(values))
    lines.set_clim(0, top or 1.0)
    axes.add_collection3d(lines)
    return lines


def _axes(axes) -> tuple:
    return axes.xaxis, axes.yaxis, axes.zaxis


def _box(axes, row: dict) -> np.ndarray:
    """Set limits around all lines, one scale on all axes but where z is enlarged; return their widths (3,), m."""
    points = [np.concatenate([element[axis] for element in row["elements"]]) for axis in "xyz"]
    if row["seabed"] is not None:
        points[2] = np.append(points[2], row["seabed"])
    size = np.array([np.ptp(p) for p in points]) * 1.04
    size[:2] = np.maximum(size[:2], THIN * size.max())
    for name, p, width in zip("xyz", points, size, strict=True):
        centre = (p.min() + p.max()) / 2
        getattr(axes, f"set_{name}lim")(centre - width / 2, centre + width / 2)
    axes.set_box_aspect((*size[:2], max(size[2], FLAT * size.max())), zoom=ROOM)
    return size


def _of(nodes: list[dict], kind: str) -> list:
    return [node["r"] for node in nodes if node["kind"] == kind]


def _nodes(axes, nodes: list[dict]) -> list:
    """Draw markers of all nodes; return one handle a kind for the legend."""
    size, handles = 26 if len(nodes) < CROWD else 9, []
    for kind, marker in KINDS.items():
        if places := _of(nodes, kind):
            look = {"marker": marker, "color": style.INK, "depthshade": False, "zorder": 5}
            if kind == "free":
                look |= {"facecolor": "none", "edgecolor": style.INK}
                look.pop("color")
            handles.append(axes.scatter(*np.array(places).T, s=size, label=kind, **look))
    return handles


def _seabed(axes, height: float) -> Patch:
    """Draw a plane over the whole box; return its handle for the legend."""
    x, y = np.meshgrid(axes.get_xlim(), axes.get_ylim())
    axes.plot_surface(x, y, np.full_like(x, height), color=style.SEABED, alpha=0.16, shade=False, linewidth=0, zorder=0)
    return Patch(color=style.SEABED, alpha=0.3, label="seabed")
