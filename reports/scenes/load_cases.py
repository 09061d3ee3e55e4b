"""The section on tables of load cases: what each line felt in each case, and the greatest tensions over the sea."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..drawing import style
from ..drawing.axes import add_legend, panel
from ..page.figures import Figure, Group
from ..page.formatting import number, plural, slug, status_words
from ..page.section import Content, Inputs, Section
from ..page.tables import Table
from .network_tables import as_text

SHOWN = 40  # rows of the page, those of the greatest tensions; the CSV file has all
IN_TERMINAL = 20
COLUMNS = {
    "case": "case", "line": "line", "minimum": "least", "mean": "mean", "maximum": "greatest",
    "standard_deviation": "std. dev.", "extreme": "in 3 h", "interval": "90 %", "damage_equivalent_load": "1 Hz range",
    "anchor_maximum": "anchor", "grounded": "on the seabed, m", "slack_time": "slack, s", "remarks": "remarks",
}  # fmt: skip
GROUPS = (("", 2), ("tension at the fairlead, kN", 4), ("extreme, kN", 2), ("damage, kN", 1), ("greatest, kN", 1),
          ("", 3))  # fmt: skip


def _kn(value) -> str:
    return number(None if value is None else 1e-3 * value, 4)


FORMATS = dict.fromkeys(("minimum", "mean", "maximum", "standard_deviation", "extreme", "damage_equivalent_load",
                         "anchor_maximum"), _kn)  # fmt: skip


def build(inputs: Inputs) -> Content:
    """Return table, figure and sentences of every table of load cases."""
    summaries = inputs.results["load_cases"] or {}
    shown = [_show(summary, f"cases_{slug(stem)}", inputs) for stem, summary in summaries.items()]
    return Content({"tables_of_cases": shown})


def _show(summary: dict, name: str, inputs: Inputs) -> dict:
    table = _table(summary, name, SHOWN).write(inputs.tables)
    return {"data": summary, "sentence": _sentence(summary), "failed": _failed(summary), "table": table,
            "figure": _figures(summary, name, inputs.figures)}  # fmt: skip


def _rows(summary: dict) -> list[dict]:
    """Return a row for each line of each case that was solved, the greatest tension first."""
    rows = []
    for case in summary["rows"]:
        for line in case["lines"]:
            least, most = line["grounded_least"], line["grounded_most"]
            interval = None
            if line["extreme"] is not None:
                interval = f"{_kn(line['extreme_low'])} to {_kn(line['extreme_high'])}"
            on_seabed = f"{number(least)} to {number(most)}" if most else None
            rows.append(line | {"case": case["name"], "interval": interval, "grounded": on_seabed,
                                "remarks": "; ".join(line["warnings"])})  # fmt: skip
    return sorted(rows, key=lambda row: -row["maximum"])


def _table(summary: dict, name: str, most: int) -> Table:
    rows = _rows(summary)[:most]
    solved = sum(len(case["lines"]) for case in summary["rows"])
    note = (
        f"{plural(len(rows), 'row')} of the greatest tensions of {solved}; all of them, unrounded, are in "
        f"{summary['output']}. Damage: range of a cycle a second that does the same, exponent {summary['wohler']:g}."
    )
    return Table(f"{name}_rows", "Load cases", COLUMNS, rows, FORMATS, GROUPS, note=note)


def _failed(summary: dict) -> list[str]:
    """Return a sentence for each row that has no results."""
    return [f"{case['name']}: {status_words(case['status'])}. {case['message']}"
            for case in summary["rows"] if case["status"] != "SUCCESS"]  # fmt: skip


def _sentence(summary: dict) -> str:
    """Return how many rows were solved, with which setting, and what its error is."""
    rows, accuracy = summary["rows"], summary["accuracy"]
    solved = sum(case["status"] == "SUCCESS" for case in rows)
    text = (
        f"{solved} of {plural(len(rows), 'load case')} solved, in steps of {number(summary['dt'])} s on "
        f"{summary['cells']} cells."
    )
    if accuracy["tolerance"] is None:
        return f"{text} The error of this setting was not asked for: give a tolerance in place of step and cells."
    text += (
        f" Maximum, standard deviation and damage are promised to {100 * accuracy['promised']:.2g} % "
        f"(wanted: {100 * accuracy['tolerance']:.2g} %)."
    )
    if accuracy["sampled"]:
        text += (
            f" Measured with half the step and twice the cells on {plural(accuracy['sampled'], 'case')} of it: at "
            f"most {100 * accuracy['measured']:.2g} %, within the tolerance in {accuracy['within']}."
        )
    return text


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
    for line in names:
        pairs = np.array([(height, 1e-3 * row["maximum"]) for height, row in rows if row["line"] == line])
        axes.plot(*pairs.T, "o", markersize=3, alpha=0.7, label=line)
    add_legend(figure, axes)
    return style.save(figure, folder, name, title, f"{title}, one point a case and line.")


def _exceedance(rows, names, name, folder) -> Figure:
    title = "Exceedance of the greatest tension"
    figure, axes = panel(title, "greatest tension, kN", "share of cases that exceed it", yscale="log")
    for line in names:
        values = np.sort([1e-3 * row["maximum"] for _, row in rows if row["line"] == line])[::-1]
        axes.plot(values, np.arange(1, values.size + 1) / values.size, drawstyle="steps-post", label=line)
    add_legend(figure, axes)
    return style.save(figure, folder, name, title, f"{title}, one curve a line.")


def summarise(summary: dict, out: Path) -> str:
    """Return what the terminal shows of a table: the rows of the greatest tensions, the error, where all rows are."""
    table = _table(summary, "cases", IN_TERMINAL)
    kept = [key for key in COLUMNS if key not in ("remarks", "interval", "anchor_maximum")]
    short = Table(table.name, table.title, {key: COLUMNS[key] for key in kept}, table.rows, FORMATS)
    text = [f"{summary['name']}: tensions in kN", as_text(short), _sentence(summary), *_failed(summary)]
    return "\n".join([*text, str(out / summary["output"])])


LOAD_CASES = Section(
    id="load-cases",
    title="Load cases",
    part="error-for-time",
    page="lines",
    needs=("load_cases",),
    template="scenes/load_cases.html.j2",
    build=build,
    tests={
        "load-cases": (
            "load_cases/test_solve.py::test_a_linear_line_has_rayleigh_maxima_and_the_damage_of_a_narrow_band",
            "load_cases/test_statistics.py::test_cycles_of_the_standard",
            "load_cases/test_accuracy.py::test_the_promise_is_kept",
        )
    },
)
