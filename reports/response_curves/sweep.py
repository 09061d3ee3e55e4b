"""The section on the sweep of one's own line or network: its curve, and in sentences what it means for the design."""

from __future__ import annotations

from ..page.numbers.formatting import number, slug
from ..page.numbers.tables import Table
from ..page.section import Content, Inputs, Section
from .figures import sweep_figure
from .section import KN_COLUMNS


def build(inputs: Inputs) -> Content:
    """Return figure, table and sentences of every file that was swept."""
    shown = []
    for stem, report in (inputs.results["sweep"] or {}).items():
        name = f"sweep_{slug(stem)}"
        figure = sweep_figure(report, name, inputs.figures) if report["curves"] else None
        rows = special_rows(report)
        table = Table(f"{name}_special", "Special points", KN_COLUMNS, rows).write(inputs.tables) if rows else None
        shown.append({"report": report, "figure": figure, "table": table})
    return Content({"sweeps": shown})


def special_rows(report: dict) -> list[dict]:
    """Return a row for each special point of the curves of a file."""
    return [{"kind": point["kind"], "value": point["value"], "tension": 1e-3 * point["tension"],
             "error": point["error"]} for curve in report["curves"] for point in curve["special"]]  # fmt: skip


def summarise(report: dict) -> str:
    """Return what the terminal shows of a sweep."""
    low, high = report["band"]
    head = f"{report['name']}: response curve from {number(low)} to {number(high)} Hz"
    return "\n".join([head, *report["sentences"], *(f"- {note}" for note in report["notes"])])


SWEEP = Section(
    id="sweep",
    title="Response curve over the band",
    part="breaks",
    needs=("sweep",),
    template="response_curves/sweep.html.j2",
    build=build,
)
