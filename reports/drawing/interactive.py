"""Charts that answer to the reader, in Vega-Lite by Altair: the rows of a figure's CSV, drawn a second time.

Every function returns the JSON of a chart for the page, with the colours of the page's theme; charts.js draws it.
A click on a name of a legend takes its marks away or brings them back. Altair is imported where a chart is made: it
takes a second. A test validates every kind of chart.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from .style import GRID, INK, PALE, THEME, WRONG

HEIGHT = 340
MOST_TICKS = 9  # of a logarithmic axis
MANY = 16  # cells of a map in a row, which then stand without a gap
PADDING = {"left": 5, "top": 5, "right": 14, "bottom": 5}  # room for half of the last label of the x axis
LETTERS = 70  # of all labels of a map in a row, which are slanted beyond
NARROW = 560  # CSS pixels of a chart below which its legend has one column
SHAPES = {
    "o": "circle", "s": "square", "D": "diamond", "^": "triangle-up", "v": "triangle-down", "P": "cross",
    ">": "triangle-right", "<": "triangle-left", ".": "circle", "": "stroke",
    "X": "M-.6,-1L0,-.4L.6,-1L1,-.6L.4,0L1,.6L.6,1L0,.4L-.6,1L-1,.6L-.4,0L-1,-.6Z",
    "*": "M0,-1L.24,-.32L.95,-.31L.38,.12L.59,.81L0,.4L-.59,.81L-.38,.12L-.95,-.31L-.24,-.32Z",
    "h": "M0,-1L.87,-.5L.87,.5L0,1L-.87,.5L-.87,-.5Z",
}  # fmt: skip
"""Marker of matplotlib -> the same in Vega: a name or a path."""
SHAPES["x"] = SHAPES["X"]


def draw_work(rows: list[dict], looks: dict[str, dict], axes: tuple[str, str], limits=(None, None), band=None) -> str:
    """Return the chart of error against run time, both logarithmic.

    rows : method, setting, time_s, error; front: ringed if "yes"; rank: place on the line of its method, or None
    looks : method -> color and marker; axes : labels of time and error; limits : (x, y) as (least, greatest) or None
    band : uncertainty of the reference, shaded below it
    """
    alt = _import_altair()
    methods = [name for name in looks if any(row["method"] == name for row in rows)]
    x = limits[0] or _widen([row["time_s"] for row in rows])
    y = limits[1] or _widen([row["error"] for row in rows])
    shown, shape = _switch("shown", "method", methods), [SHAPES.get(looks[m]["marker"], "circle") for m in methods]
    colour = alt.Color("method:N", scale=alt.Scale(domain=methods, range=[looks[m]["color"] for m in methods]),
                       legend=_legend())  # fmt: skip
    tooltip = [alt.Tooltip("method:N"), alt.Tooltip("setting:N"), alt.Tooltip("error:Q", format=".3~g"),
               alt.Tooltip("time:N", title="run time")]  # fmt: skip
    axes_encoding = {"x": alt.X("time_s:Q", scale=_log(x), axis=_log_axis(axes[0], x, SECONDS_LABEL)),
             "y": alt.Y("shown_error:Q", scale=_log(y), axis=_log_axis(axes[1], y, ERROR_LABEL))}  # fmt: skip
    base = alt.Chart().encode(**axes_encoding)
    points = base.mark_point(filled=True, size=55, opacity=0.9).encode(
        color=colour, shape=alt.Shape("method:N", scale=alt.Scale(domain=methods, range=shape)), tooltip=tooltip
    )
    layers = [points.add_params(shown).properties(name="points")]
    if any(row.get("rank") is not None for row in rows):
        line = base.transform_filter("isValid(datum.rank)").mark_line(strokeWidth=1, opacity=0.7)
        layers.insert(0, line.encode(color=colour, order="rank:Q"))
    if any(row.get("front") for row in rows):
        rings = base.transform_filter("datum.front === 'yes'").mark_point(size=170, stroke=INK, strokeWidth=1)
        layers.insert(0, rings.encode(tooltip=tooltip))
    if any(row.get("wrong") for row in rows):
        wrong = base.transform_filter("datum.wrong === 'yes'")
        layers.append(wrong.mark_point(shape=SHAPES["X"], filled=True, size=60, color=WRONG).encode(tooltip=tooltip))
    if band:
        layers.insert(0, _shade(band, y))
    chart = alt.layer(*layers, data=alt.NamedData("rows")).transform_calculate(
        shown_error=f"clamp(datum.error, {y[0]!r}, {y[1]!r})", time="format(datum.time_s, '.3~s') + 's'"
    )
    return _to_json(chart.transform_filter(shown), rows=rows)


@dataclass(frozen=True)
class Colours:
    """What colours of a map stand for. decades : log10 of the least and the greatest error; title : of the errors;
    answered : verdicts whose error is shown."""

    decades: tuple[int, int]
    title: str
    answered: tuple[str, ...]


def draw_map(rows: list[dict], axes: tuple[str, str], ticks: tuple[list[str], list[str]], looks: dict[str, dict],
             colours: Colours, limit: tuple[str, float] | None = None) -> str:  # fmt: skip
    """Return a map of verdicts over two quantities, coloured by the error where there is an answer.

    rows : x and y as they stand in ticks, verdict, error, and what the pointer shows beside: title -> text
    axes : labels of x and y; ticks : all values of x and of y from the least on, as texts
    looks : verdict -> marker, size, fill and stroke of what is drawn on its cells; others are cells only
    limit : dashed line, ("x" or "y", position in cells from the first)
    """
    alt = _import_altair()
    verdicts = list(dict.fromkeys(row["verdict"] for row in rows))
    shown = _switch("shown", "verdict", verdicts)
    axes_encoding = {"x": _steps(alt.X, "x", axes[0], ticks[0]), "y": _steps(alt.Y, "y", axes[1], ticks[1][::-1])}
    shown_keys = dict.fromkeys(key for row in rows for key in row if key not in ("x", "y"))
    tooltip = [alt.Tooltip("x:N", title=axes[0]), alt.Tooltip("y:N", title=axes[1])]
    tooltip += [
        alt.Tooltip(f"{key}:Q", format=".3~g") if key == "error" else alt.Tooltip(f"{key}:N") for key in shown_keys
    ]
    base = alt.Chart().encode(**axes_encoding, tooltip=tooltip)
    blank = base.transform_filter("!isValid(datum.tint)").mark_rect(color=GRID)
    cells = base.transform_filter("isValid(datum.tint)").mark_rect().encode(color=_error_colour(colours))
    layers = [blank.properties(name="blank"), cells.properties(name="cells")]
    marked = [verdict for verdict in looks if verdict in verdicts]
    if marked:
        layers.append(_mark_verdicts(base, marked, looks).add_params(shown))
    if limit:
        layers.append(_rule(limit, ticks["xy".index(limit[0])]))
    chart = alt.layer(*layers, data=alt.NamedData("rows")).resolve_scale(color="independent")
    tint = f"indexof({json.dumps(colours.answered)}, datum.verdict) >= 0 ? datum.error : null"
    chart = chart.transform_calculate(tint=tint)
    return _to_json(chart.transform_filter(shown) if marked else chart, rows=rows)


def _error_colour(colours: Colours):
    """Return the colour of cells by their error, with its bar below the map."""
    alt = _import_altair()
    low, high = colours.decades
    values = [10.0**k for k in range(low, high + 1, math.ceil((high - low) / 5))]
    bar = alt.Legend(title=colours.title, titleLimit=320, orient="bottom", direction="horizontal", gradientLength=240,
                     values=values, labelExpr="'1e' + round(log(datum.value) / LN10)")  # fmt: skip
    scale = alt.Scale(type="log", domain=[10.0**low, 10.0**high], scheme="viridis", clamp=True)
    return alt.Color("tint:Q", legend=bar, scale=scale)


def _mark_verdicts(base, marked: list[str], looks: dict[str, dict]):
    """Return the layer of markers on cells, whose legend switches verdicts."""
    alt = _import_altair()
    scale = lambda key: alt.Scale(domain=marked, range=[looks[verdict][key] for verdict in marked])
    shapes = alt.Scale(domain=marked, range=[SHAPES[looks[verdict]["marker"]] for verdict in marked])
    sizes = json.dumps({verdict: looks[verdict]["size"] for verdict in marked})
    points = base.transform_filter(f"indexof({json.dumps(marked)}, datum.verdict) >= 0")
    return points.mark_point(opacity=1, size=alt.ExprRef(f"{sizes}[datum.verdict]")).encode(
        shape=alt.Shape("verdict:N", scale=shapes, legend=_legend()),
        fill=alt.Fill("verdict:N", scale=scale("fill"), legend=_legend()),
        stroke=alt.Stroke("verdict:N", scale=scale("stroke"), legend=_legend()),
    )


def draw_curves(rows: list[dict], special: list[dict], colours: dict[str, str], axes: tuple[str, str]) -> str:
    """Return curves of the greatest and least tension over the frequency, unstable parts dotted.

    rows : series, bound, frequency_Hz, tension_kN, state ("stable" or "unstable"), in the order of each curve
    special : kind, frequency_Hz, tension_kN, marker; colours : series -> colour; axes : labels
    """
    alt = _import_altair()
    names, states = list(colours), [s for s in ("stable", "unstable") if any(row["state"] == s for row in rows)]
    of_series, of_state = _switch("series_shown", "series", names), _switch("states_shown", "state", states)
    near = alt.selection_point(name="near", on="pointerover", clear="pointerout", empty=False)
    axes_encoding = {
        "x": alt.X("frequency_Hz:Q", axis=alt.Axis(title=axes[0], tickCount=8, labelOverlap=True),
                   scale=_linear([row["frequency_Hz"] for row in rows])),
        "y": alt.Y("tension_kN:Q", axis=alt.Axis(title=axes[1], format="~r"),
                   scale=_linear([row["tension_kN"] for row in [*rows, *special]])),
    }  # fmt: skip
    colour = alt.Color("series:N", legend=_legend(), scale=alt.Scale(domain=names, range=list(colours.values())))
    dashes = [[1, 0] if state == "stable" else [2, 3] for state in states]
    dash = alt.StrokeDash("state:N", legend=_legend(), scale=alt.Scale(domain=states, range=dashes))
    tooltip = [alt.Tooltip("series:N", title="curve"), alt.Tooltip("bound:N", title="tension, which"),
               alt.Tooltip("frequency_Hz:Q", title=axes[0], format=".4~g"),
               alt.Tooltip("tension_kN:Q", title=axes[1], format=".4~g"), alt.Tooltip("state:N")]  # fmt: skip
    lines = alt.Chart(alt.NamedData("pieces")).transform_filter(of_series).transform_filter(of_state)
    lines = lines.mark_line(strokeWidth=1.6).encode(
        **axes_encoding, color=colour, strokeDash=dash, detail="piece:N", order="rank:Q"
    )
    points = alt.Chart(alt.NamedData("rows")).transform_filter(of_series).transform_filter(of_state)
    points = points.mark_point(filled=True, size=110).encode(
        **axes_encoding,
        color=colour,
        tooltip=tooltip,
        opacity=alt.when(near).then(alt.value(1)).otherwise(alt.value(0)),
    )
    layers = [lines.add_params(of_series, of_state), points.add_params(near).properties(name="points")]
    if special:
        layers.append(_special_points(special, axes_encoding, axes))
    chart = alt.layer(*layers).resolve_scale(shape="independent")
    return _to_json(chart, rows=rows, pieces=_split_at_changes(rows), special=special)


def _special_points(special: list[dict], axes_encoding: dict, axes):
    """Return the layer of folds, branch points and others."""
    alt = _import_altair()
    kinds = {point["kind"]: SHAPES[point["marker"]] for point in special}
    tooltip = [alt.Tooltip("kind:N"), alt.Tooltip("frequency_Hz:Q", title=axes[0], format=".4~g"),
               alt.Tooltip("tension_kN:Q", title=axes[1], format=".4~g")]  # fmt: skip
    shape = alt.Shape("kind:N", legend=_legend(), scale=alt.Scale(domain=list(kinds), range=list(kinds.values())))
    points = alt.Chart(alt.NamedData("special")).mark_point(filled=True, size=55, color=INK, opacity=1)
    return points.encode(**axes_encoding, shape=shape, tooltip=tooltip)


def _split_at_changes(rows: list[dict]) -> list[dict]:
    """Return the rows as pieces of lines, each stable or unstable: where the state changes, an unstable segment."""
    result: list[dict] = []
    piece = -1
    for before, row in pairwise([{}, *rows]):
        if (before.get("series"), before.get("bound")) != (row["series"], row["bound"]):
            piece, state = piece + 1, row["state"]
        else:
            now = "stable" if before["state"] == row["state"] == "stable" else "unstable"
            if now != state or not result:
                piece, state = piece + 1, now
                result.append(before | {"state": state, "piece": piece, "rank": len(result)})
        result.append(row | {"state": state, "piece": piece, "rank": len(result)})
    return result


# ---------------------------------------------------------------- parts of charts
def _import_altair() -> Any:
    """Return Altair, its validation of every part of a chart off: it takes as long as all else."""
    import altair
    from altair.utils.schemapi import disable_debug_mode

    disable_debug_mode()
    return altair


def _switch(name: str, field: str, values: list[str]):
    """Return the selection that a legend switches: everything at first, a click takes away or brings back."""
    alt = _import_altair()
    return alt.selection_point(name=name, fields=[field], bind="legend", toggle="true", clear=False, empty=False,
                               value=[{field: value} for value in values])  # fmt: skip


def _legend():
    alt = _import_altair()
    return alt.Legend(title=None, orient="top", columns=alt.ExprRef(f"width < {NARROW} ? 1 : 5"), labelLimit=300,
                      symbolSize=80, symbolOpacity=1)  # fmt: skip


def _linear(values: list[float]):
    """Return the scale from the least to the greatest value, which stays where marks are switched off."""
    finite = [value for value in values if math.isfinite(value)]
    return _import_altair().Scale(domain=[min(finite), max(finite)], zero=False, nice=True)


def _log(domain: tuple[float, float]):
    return _import_altair().Scale(type="log", domain=list(domain), clamp=True, nice=False)


def _log_axis(title: str, domain: tuple[float, float], label: str):
    alt = _import_altair()
    return alt.Axis(title=title, values=list_decades(*domain), format="~g", labelExpr=label)


ERROR_LABEL = "datum.value < 1e-2 ? format(datum.value, '.0e') : datum.label"
SECONDS_LABEL = "format(datum.value, '~s') + 's'"
"""Labels of ticks: powers of ten where a plain number is long; seconds with the prefix of their size."""


def list_decades(low: float, high: float) -> list[float]:
    """Return at most MOST_TICKS decades within an interval; on fewer than two also 2 and 5 times these."""
    first, last = math.ceil(math.log10(low) - 1e-9), math.floor(math.log10(high) + 1e-9)
    if high / low < 100:
        values = [m * 10.0**k for k in range(first - 1, last + 1) for m in (1, 2, 5)]
        return [float(f"{value:.6g}") for value in values if low <= value <= high]
    step = max(1, math.ceil((last - first + 1) / MOST_TICKS))
    return [10.0**k for k in range(first, last + 1, step)]


def _widen(values: list[float]) -> tuple[float, float]:
    """Return the least and greatest positive value, with room around them on a logarithmic axis."""
    positive = [value for value in values if value > 0] or [1.0]
    return min(positive) / 1.5, max(positive) * 1.5


def _shade(band: float, y: tuple[float, float]):
    """Return the layer of the band from the foot of the chart up to a value."""
    alt = _import_altair()
    row = {"low": y[0], "high": min(max(band, y[0]), y[1]), "uncertainty of the reference": band}
    tooltip = alt.Tooltip("uncertainty of the reference:Q", format=".2~g")
    return (
        alt.Chart(alt.Data(values=[row]))
        .mark_rect(color=PALE, opacity=0.22)
        .encode(y="low:Q", y2="high:Q", tooltip=tooltip)
    )


def _steps(channel, field: str, title: str, labels: list[str]):
    """Return an axis of evenly spaced cells in the order of their labels."""
    if len(set(labels)) < len(labels):
        raise ValueError(f"{title}: two cells have the same label: {', '.join(labels)}")
    alt = _import_altair()
    angle = -45 if field == "x" and sum(map(len, labels)) > LETTERS else 0
    axis = alt.Axis(title=title, labelAngle=angle, grid=False, labelOverlap=True)
    return channel(
        f"{field}:O",
        sort=None,
        scale=alt.Scale(domain=labels, paddingInner=0.03 if len(labels) < MANY else 0),
        axis=axis,
    )


def _rule(limit: tuple[str, float], labels: list[str]):
    """Return the dashed line at a position between cells, counted from the first."""
    alt = _import_altair()
    key, position = limit
    inside = 1 - position % 1 if key == "y" else position % 1
    channel = {"x": alt.XDatum, "y": alt.YDatum}[key](labels[int(position)], bandPosition=inside)
    return alt.Chart(alt.Data(values=[{}])).mark_rule(strokeDash=[4, 3], color=INK).encode(**{key: channel})


def _to_json(chart, **datasets: list[dict]) -> str:
    """Return the JSON of a chart, as wide as its place on the page, in the colours of the page.

    datasets : name -> rows; they are added behind Altair, which copies what a chart holds at every step
    """
    spec = chart.properties(width="container", height=HEIGHT).to_dict(validate=False)
    spec = {key: value for key, value in spec.items() if key not in ("$schema", "config")} | {"datasets": datasets}
    text = json.dumps(
        spec | {"autosize": {"type": "fit-x", "contains": "padding"}, "padding": PADDING},
        separators=(",", ":"),
        default=float,
    )
    for colour, variable in THEME.items():
        text = text.replace(f'"{colour}"', f'"{variable}"')
    return text.replace("</", "<\\/")
