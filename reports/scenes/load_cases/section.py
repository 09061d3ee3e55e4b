"""The section on tables of load cases: what each line felt in each case, and the greatest tensions over the sea."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from ...drawing import style
from ...drawing.axes import add_legend, panel
from ...page.figures import Figure, Group
from ...page.numbers.formatting import number, plural, slug, status_words
from ...page.numbers.tables import Table
from ...page.section import Content, Inputs, Section
from .. import margins
from ..animation import animate, caption
from ..networks import figures as network_figures
from ..networks.tables import as_text

SHOWN = 40  # rows of the page, those of the greatest tensions; the CSV file has all
IN_TERMINAL = 20
EVENLY_SPACED = 20  # solved cases, up to which those that are checked are evenly spaced
FEW = 30  # cases, up to which an exceedance has no tail to see
MARKERS = "os"  # by turns, for symmetric lines have the same tensions
COLUMNS = {
    "case": "case", "line": "line", "minimum": "least", "mean": "mean", "maximum": "greatest",
    "standard_deviation": "std. dev.",
    "time_of_max": "greatest at, s", "extreme": "in {hours:g} h", "interval": "{confidence:.0%}",
    "damage_equivalent_load": "range at {frequency:g} Hz",
    "anchor_maximum": "anchor", "grounded": "on the seabed, m", "slack_time": "slack, s", "remarks": "remarks",
}  # fmt: skip
GROUPS = (("", 2), ("tension at the fairlead, kN", 4), ("extreme, kN", 2), ("damage, kN", 1), ("greatest, kN", 1),
          ("", 3))  # fmt: skip
OWN_GROUPS = (("", 1), ("tension at the fairlead, kN", 5), *GROUPS[2:])
"""Of a system in its own sea, where the case has no column and the time of the greatest tension one."""


def _kn(value) -> str:
    return number(None if value is None else 1e-3 * value, 4)


FORMATS = dict.fromkeys(("minimum", "mean", "maximum", "standard_deviation", "extreme", "damage_equivalent_load",
                         "anchor_maximum"), _kn)  # fmt: skip


def _columns(summary: dict, without: str) -> dict:
    """Return the columns but one, with what extremes and damage refer to in their heads."""
    given = {key: summary[key] for key in ("hours", "confidence", "frequency")}
    return {key: head.format(**given) for key, head in COLUMNS.items() if key != without}


def build(inputs: Inputs) -> Content:
    """Return table, figure and sentences of every table of load cases."""
    summaries = inputs.results["load_cases"] or {}
    shown = [_show(summary, f"cases_{slug(stem)}", inputs) for stem, summary in summaries.items()]
    return Content({"tables_of_cases": shown})


def _show(summary: dict, name: str, inputs: Inputs) -> dict:
    table = _table(summary, name, SHOWN).write(inputs.tables)
    margin, output = margins.margin_table(summary["margins"], name), summary["output"]
    draw = _own_figures if summary["series"] else _figures
    spectrum = _own_spectrum(summary, name, inputs.figures) if summary["series"] else None
    views = _views(summary) if summary.get("envelope") else None
    return {"data": summary, "sentence": _sentence(summary), "failed": _failed(summary), "table": table,
            "figure": draw(summary, name, inputs.figures), "spectrum": spectrum,
            "views": views, "margin": margin and margin.write(inputs.tables),
            "margin_words": margins.describe_margin(summary["margins"]), "link": output,
            "title": f"{summary['cases']} on {summary['file']}" if summary["cases"] else f"{summary['name']} in waves",
            "python": _python_to_paste(summary)}  # fmt: skip


def _python_to_paste(summary: dict) -> str | None:
    """Return the solution of a system's own sea as Python; None of a table, whose files the page names."""
    if summary["cases"]:
        return None
    reader = ("from solvers.io.case_file import load_case_of, load_system\n"
              f'system = load_system("{summary["file"]}")\n')  # fmt: skip
    return (
        f"{reader}from solvers.load_cases import solve_load_cases\n\n"
        f"table = solve_load_cases(system, [load_case_of(system)], dt={summary['dt']:.6g}, cells={summary['cells']})\n"
        """table.values("maximum"), table.values("standard_deviation")  # N, of each line"""
    )


def _rows(summary: dict) -> list[dict]:
    """Return a row for each line of each case that was solved, by greatest tension; of one sea as they are."""
    rows, times = [], (summary["series"] or {}).get("time_of_max")
    for case in summary["rows"]:
        for k, line in enumerate(case["lines"]):
            least, most = line["grounded_least"], line["grounded_most"]
            interval = None
            if line["extreme"] is not None:
                interval = f"{_kn(line['extreme_low'])} to {_kn(line['extreme_high'])}"
            on_seabed = f"{number(least)} to {number(most)}" if most else None
            rows.append(line | {"case": case["name"], "interval": interval, "grounded": on_seabed,
                                "time_of_max": times and times[k],
                                "remarks": "; ".join(line["warnings"])})  # fmt: skip
    return rows if times else sorted(rows, key=lambda row: -row["maximum"])


def _table(summary: dict, name: str, most: int) -> Table:
    rows = _rows(summary)[:most]
    solved = sum(len(case["lines"]) for case in summary["rows"])
    damage = f"Damage: range of a cycle a second that does the same, exponent {summary['wohler']:g}."
    if summary["series"]:
        columns = _columns(summary, "case")
        times = f"Over {number(summary['series']['duration'])} s after a ramp of {number(summary['series']['ramp'])} s."
        return Table(f"{name}_rows", "Lines", columns, rows, FORMATS, OWN_GROUPS, note=f"{times} {damage}")
    columns = _columns(summary, "time_of_max")
    note = f"{plural(len(rows), 'row')} of the greatest tensions of {solved}; the CSV file has all of them. {damage}"
    return Table(f"{name}_rows", "Load cases", columns, rows, FORMATS, GROUPS, note=note)


def _failed(summary: dict) -> list[str]:
    """Return a sentence for each row that has no results."""
    return [f"{case['name']}: {status_words(case['status'])}. {case['message']}"
            for case in summary["rows"] if case["status"] != "SUCCESS"]  # fmt: skip


def _sentence(summary: dict) -> str:
    """Return how many rows were solved, with which setting, and what its error is."""
    rows, accuracy = summary["rows"], summary["accuracy"]
    solved = sum(case["status"] == "SUCCESS" for case in rows)
    how = f"in steps of {number(summary['dt'])} s on {summary['cells']} cells."
    text = f"{solved} of {plural(len(rows), 'load case')} solved, {how}" if summary["cases"] else f"Solved {how}"
    if accuracy["tolerance"] is None:
        return f"{text} The error of this setting was not asked for: give a tolerance in place of step and cells."
    meets = accuracy["promised"] <= accuracy["tolerance"]
    text += (
        f" Maximum, standard deviation and damage are promised to {100 * accuracy['promised']:.2g} % "
        f"(wanted: {100 * accuracy['tolerance']:.2g} %)."
    )
    if accuracy["sampled"]:
        drawn = " drawn at random" if accuracy["sampled"] < solved and solved > EVENLY_SPACED else ""
        text += (
            f" Measured with half the step and twice the cells on {plural(accuracy['sampled'], 'case')} of it{drawn}: "
            f"at most {100 * accuracy['measured']:.2g} %, within the tolerance in {accuracy['within']}."
        )
        if meets and accuracy.get("is_kept") is False:
            share = f"{accuracy['share']:.0%}"
            text += f" THE PROMISE IS NOT KEPT: fewer than {share} of them are within it; ask for a smaller tolerance."
    return text if meets else f"{_what_would_meet(summary)} {text}"


def _what_would_meet(summary: dict) -> str:
    """Return that the tolerance is not met, and which step and mesh would at least be needed, by second order."""
    promised, tolerance = summary["accuracy"]["promised"], summary["accuracy"]["tolerance"]
    finer = (promised / tolerance) ** 0.5
    return (
        f"THE TOLERANCE OF {100 * tolerance:.2g} % IS NOT MET: no step and mesh that was tried promises it, as snap "
        f"loads of slack lines converge slowly. By second order it would take at least --dt "
        f"{number(summary['dt'] / finer, 2)} --cells {math.ceil(finer * summary['cells'])}."
    )


def _as_network(summary: dict) -> dict:
    """Return what figures of networks take of a system in its own sea."""
    lines = [line["line"] for line in summary["rows"][0]["lines"]]
    return {"name": summary["name"], "lines": lines, "period": None, "waveforms": summary["series"],
            "along": summary.get("along"), "reference": {"uncertainty": summary["accuracy"]["promised"]}}  # fmt: skip


def _own_figures(summary: dict, name: str, folder: Path) -> Group:
    """Return the tensions about the greatest of a sea."""
    times = summary["series"]["time"]
    text = f"The {number(times[-1] - times[0])} s about the greatest tension; time from the end of the ramp."
    return Group(text, network_figures.tensions(_as_network(summary), name, folder).figures)


def _own_spectrum(summary: dict, name: str, folder: Path) -> Group:
    """Return the spectra of the tensions over a whole sea, and their extremes along the lines."""
    drawn = (network_figures.spectrum, network_figures.along)
    figures = [figure for draw in drawn if (figure := draw(_as_network(summary), name, folder)) is not None]
    text = f"Of all {number(summary['series']['duration'])} s, spectra averaged over overlapping parts."
    return Group(f"{text} Along the lines shaded from least to greatest.", figures)


def _views(summary: dict) -> dict:
    """Return drawings of the lines as they move about the greatest tension, and their caption."""
    envelope, name = summary["envelope"], summary["name"]
    factor, duration = network_figures.enlargement(envelope), envelope["duration"]
    drawn = animate(envelope, name, duration, factor, summary["seabed"])
    return {"drawn": drawn, "caption": caption(duration, factor, f"From t = {number(envelope['first'])} s, a stretch")}


def _figures(summary: dict, name: str, folder: Path) -> Group | None:
    """Return the greatest tensions over the height of the waves, and how often which of them is exceeded."""
    rows = [(case["Hs"], line) for case in summary["rows"] for line in case["lines"]]
    if not rows:
        return None
    names = list(dict.fromkeys(line["line"] for _, line in rows))
    figures = []
    if all(height is not None for height, _ in rows):
        figures.append(_scatter(rows, names, f"{name}_height", folder))
    figures.append(_exceedance(rows, names, f"{name}_exceedance", folder))
    return Group("Greatest tension of each case at the fairlead.", figures)


def _scatter(rows, names, name, folder) -> Figure:
    title = "Greatest tension over the height of the waves"
    figure, axes = panel(title, "significant height, m", "greatest tension, kN")
    for line, look in zip(names, network_figures.line_looks(names), strict=True):
        pairs = np.array([(height, 1e-3 * row["maximum"]) for height, row in rows if row["line"] == line])
        axes.plot(*pairs.T, MARKERS[int(look["zorder"]) % 2], markersize=4, alpha=0.7, label=line, color=look["color"],
                  fillstyle="none")  # fmt: skip
    add_legend(figure, axes)
    return style.save(figure, folder, name, title, f"{title}, one point a case and line.")


def _exceedance(rows, names, name, folder) -> Figure:
    title = "Exceedance of the greatest tension"
    figure, axes = panel(
        title,
        "greatest tension, kN",
        "share of cases that exceed it",
        yscale="log" if len(rows) > FEW * len(names) else "linear",
    )
    for line, look in zip(names, network_figures.line_looks(names), strict=True):
        values = np.sort([1e-3 * row["maximum"] for _, row in rows if row["line"] == line])[::-1]
        axes.plot(values, np.arange(1, values.size + 1) / values.size, drawstyle="steps-post", label=line, **look)
    add_legend(figure, axes)
    return style.save(figure, folder, name, title, f"{title}, one curve a line.")


def summarise(summary: dict, out: Path) -> str:
    """Return what the terminal shows of a table: the rows of the greatest tensions, the error, where all rows are."""
    table = _table(summary, "cases", IN_TERMINAL)
    kept = [key for key in table.columns if key not in ("remarks", "interval", "anchor_maximum")]
    whole = {"extreme": "extreme {}", "damage_equivalent_load": "damage, {}"}  # without heads of groups
    heads = {key: whole.get(key, "{}").format(table.columns[key]) for key in kept}
    short = Table(table.name, table.title, heads, table.rows, FORMATS)
    where = f" in waves, {summary['rows'][0]['name']}" if summary["cases"] is None else ""
    text = [f"{summary['name']}{where}: tensions in kN", as_text(short), _sentence(summary), *_failed(summary)]
    text += margins.describe_margin(summary["margins"])
    return "\n".join([*text, str(out / summary["output"])])


LOAD_CASES = Section(
    id="load-cases",
    title="Load cases",
    part="error-for-time",
    page="lines",
    needs=("load_cases",),
    template="scenes/load_cases/section.html.j2",
    build=build,
    tests={
        "load-cases": (
            "load_cases/test_solve.py::test_a_linear_line_has_rayleigh_maxima_and_the_damage_of_a_narrow_band",
            "load_cases/test_statistics.py::test_cycles_of_the_standard",
            "load_cases/test_accuracy.py::test_the_promise_is_kept",
        )
    },
)
