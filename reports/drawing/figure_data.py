"""What a figure draws, as rows for its CSV: every line, marker, band, bar and map of every panel, unrounded."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator

import numpy as np
from matplotlib.collections import LineCollection, PathCollection, PolyCollection, QuadMesh
from matplotlib.container import BarContainer
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Path3DCollection

COLUMNS = ("panel", "series", "x axis", "x", "y axis", "y", "z axis", "z", "value axis", "value")
"""value: what colour stands for. Columns that a figure does not use are left out."""


def drawn_rows(figure) -> list[dict]:
    """Return every point drawn, in long form. Guides such as grids and limits of one whole axis are no data."""
    bars = {id(axes) for axes in figure.axes if hasattr(axes, "_colorbar")}
    panels = [axes for axes in figure.axes if axes.get_visible() and id(axes) not in bars]
    return [row for axes in panels for row in _panel(axes, _value_label(figure, axes))]


def to_csv(rows: list[dict]) -> str:
    """Return the CSV of such rows."""
    keys = dict.fromkeys(key for row in rows for key in row)
    used = [key for key in COLUMNS if key in keys] + [key for key in keys if key not in COLUMNS]
    out = io.StringIO()
    writer = csv.DictWriter(out, used, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return out.getvalue()


def unlabelled_axes(figure) -> list[str]:
    """Return the axes without a label: neither their own nor, where they are shared, that of a neighbour."""
    bars = [axes for axes in figure.axes if hasattr(axes, "_colorbar")]
    panels = [axes for axes in figure.axes if axes.get_visible() and axes not in bars]
    missing = [f"{a.get_title() or 'panel'}: {name}" for a in panels for name in "xy" if not _label(a, name)]
    missing += ["colour" for bar in bars if not (bar.get_xlabel() or bar.get_ylabel())]
    return missing


def _label(axes, name: str) -> str:
    """Return the label of an axis; of a shared axis without one, that of a neighbour."""
    own = getattr(axes, f"get_{name}label")()
    if own:
        return own
    shared = getattr(axes, f"get_shared_{name}_axes")().get_siblings(axes)
    return next((label for other in shared if (label := getattr(other, f"get_{name}label")())), "")


def _value_label(figure, axes) -> str:
    bars = [a for a in figure.axes if hasattr(a, "_colorbar")]
    mine = [a for a in bars if a._colorbar.mappable.axes is axes] or bars[:1]
    return next((a.get_xlabel() or a.get_ylabel() for a in mine), "")


def _panel(axes, value_label: str) -> Iterator[dict]:
    names = {
        "panel": axes.get_title("left") or axes.get_title(),
        "x axis": _label(axes, "x"),
        "y axis": _label(axes, "y"),
    }
    names |= {"z axis": axes.get_zlabel()} if hasattr(axes, "get_zlabel") else {}
    data = axes.transData
    for artist in axes.get_lines():
        if artist.get_transform().contains_branch(data):
            points = np.column_stack(np.broadcast_arrays(*(_float(v) for v in artist.get_data())))
            if not _is_guide(axes, artist, points):
                yield from _rows(names, artist, points)
    for artist in axes.collections:
        yield from _collection(names, artist, value_label)
    for bars in (c for c in axes.containers if isinstance(c, BarContainer)):
        points = [(p.get_x() + p.get_width() / 2, p.get_y() + p.get_height()) for p in bars.patches]
        yield from _rows(names, bars, np.array(points))


def _is_guide(axes, artist, points) -> bool:
    """Return whether a line is a level over a whole axis, as axhline draws, and no data; one with a label is data."""
    return artist.get_transform() != axes.transData and len(points) == 2 and artist.get_label().startswith("_")


def _collection(names, artist, value_label: str) -> Iterator[dict]:
    values = artist.get_array()
    coloured = {"value axis": value_label} if values is not None and value_label else {}
    if isinstance(artist, QuadMesh):
        grid = artist.get_coordinates()
        same = values.shape == grid.shape[:2]  # one value a point, else one a cell
        middle = grid if same else (grid[:-1, :-1] + grid[1:, 1:]) / 2
        points = np.column_stack([middle.reshape(-1, 2), np.ma.filled(values.astype(float), np.nan).ravel()])
        yield from _rows(names | coloured, artist, points[~np.isnan(points[:, 2])], ("x", "y", "value"))
    elif isinstance(artist, Path3DCollection):
        yield from _rows(names, artist, np.column_stack(artist._offsets3d), ("x", "y", "z"))
    elif isinstance(artist, Line3DCollection):
        if values is None:  # places without a value
            yield from _rows(names, artist, np.concatenate(artist._segments3d), ("x", "y", "z"))
            return
        middles = np.array([np.mean(segment, axis=0) for segment in artist._segments3d])
        yield from _rows(names | coloured, artist, np.column_stack([middles, values]), ("x", "y", "z", "value"))
    elif isinstance(artist, LineCollection):
        middles = np.array([segment.mean(axis=0) for segment in map(np.asarray, artist.get_segments())])
        if values is not None:
            yield from _rows(names | coloured, artist, np.column_stack([middles, values]), ("x", "y", "value"))
        else:  # bars of a spectrum or of a spread: both ends
            yield from _rows(names, artist, np.concatenate([np.asarray(s) for s in artist.get_segments()]))
    elif isinstance(artist, PathCollection):
        yield from _rows(names, artist, np.asarray(artist.get_offsets(), dtype=float))
    elif isinstance(artist, PolyCollection):
        for path in artist.get_paths():
            yield from _rows(names, artist, path.vertices[:-1])


def _rows(names, artist, points, keys=("x", "y")) -> Iterator[dict]:
    label = artist.get_label()
    series = {"series": "" if str(label).startswith("_") else label}
    for point in points:
        yield names | series | dict(zip(keys, (float(v) for v in point), strict=True))


def _float(values):
    return np.ma.filled(np.ma.asarray(values, dtype=float), np.nan)
