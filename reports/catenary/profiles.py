"""Profiles of the solvers of lines at rest: run times over the best, and evaluations over all lines judged."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from ..drawing import style
from ..drawing.profiles import show_profiles
from ..page.figures import Group
from ..page.numbers import analysis
from ..page.numbers.formatting import number, plural
from ..page.numbers.profiles import Costs, cheapest_points, least_costs
from ..page.numbers.tables import Table

LEVELS = (1e-3, 1e-6, 1e-9, 1e-12)
"""Relative errors of the fairlead force that are to be reached."""


def profiles(work: dict, accuracy: dict | None, looks: dict, folder: Path) -> Group | None:
    """Return the performance profile of the swept tolerances and the data profile of all lines at default settings."""
    points, labels = _points(work), {p["label"]: p["solver"] for p in work["points"]}
    costs = least_costs(points, LEVELS, lambda p: p["seconds"])
    evaluations = _evaluations(accuracy) if accuracy else {}
    counted = len(next(iter(evaluations.values()), ()))
    cases = len({p["case"] for p in points})
    about = (
        f"Left, a problem is one of {plural(cases, 'line')} with an error of {_levels()} to be reached by any "
        f"tolerance; right, one of {number(counted)} lines judged against 50 digits, at default settings. What a "
        "solver does not model, refuses or answers wrong counts as never solved."
    )
    looks = {label: looks[solver] for label, solver in labels.items()}
    save = partial(_save, folder)
    return show_profiles(costs, evaluations, looks, save, about, "evaluations of a line", "spans-profiles")


def _save(folder: Path, figure, name: str, title: str, alt: str):
    return style.save(figure, folder, f"spans_{name}", title, alt)


def _levels() -> str:
    return ", ".join(number(level, 1) for level in LEVELS)


def _points(work: dict) -> list[dict]:
    """Return the points of single lines with the solver's label as method; one that is wrong has no answer."""
    return [p | {"method": p["label"], "rms": p["error"] if p["verdict"] == "right" and p["seconds"] else None}
            for p in work["points"] if analysis.is_single_line(p)]  # fmt: skip


def _evaluations(accuracy: dict) -> Costs:
    """Return label -> evaluations of each judged line, of the solvers that tell them."""
    costs = {}
    for name in analysis.sort_solvers(accuracy["solvers"]):
        answers = [row["answers"].get(name, {}) for row in accuracy["rows"]]
        mine = [a.get("iterations") if a.get("verdict") == "right" else None for a in answers]
        if any(count is not None for count in mine):
            costs[accuracy["solvers"][name]["label"]] = mine
    return costs


def cost_table(work: dict) -> Table:
    """Return the cheapest tolerance of each solver to each error: run time, and evaluations."""
    rows = cheapest_points(_points(work), list(LEVELS), lambda p: p["seconds"])
    columns = {"case": "line", "level": "error at most", "label": "solver", "tolerance": "tolerance", "us": "µs",
               "iterations": "evaluations"}  # fmt: skip
    rows = [row | {"us": 1e6 * row["seconds"]} for row in rows]
    formats = {"level": "{:g}".format, "us": partial(number, digits=2), "tolerance": partial(number, digits=1)}
    return Table("spans_costs", "Least cost of a line to an error", columns, rows, formats)
