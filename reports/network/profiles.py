"""Profiles of the methods for networks at rest: run times over the best, and evaluations of the catenary."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from ..drawing import style
from ..drawing.profiles import show_profiles
from ..page.figures import Group
from ..page.numbers.formatting import number, plural
from ..page.numbers.profiles import cheapest_points, least_costs
from ..page.numbers.tables import Table
from .figures import METHOD_LOOKS

LEVELS = (1e-3, 1e-6, 1e-9)
"""Relative errors of the end tensions that are to be reached."""


def profiles(work: list[dict], folder: Path) -> Group | None:
    """Return the performance profile of run times and the data profile of evaluations of the catenary a line."""
    points, solvers = _points(work), {p["label"]: p["solver"] for p in work}
    known = style.add_missing_looks(METHOD_LOOKS, solvers.values())
    looks = {label: known[solver] for label, solver in solvers.items()}
    costs = least_costs(points, LEVELS, lambda p: p["seconds"])
    evaluations = least_costs(points, LEVELS, _evaluations)
    cases = len({p["case"] for p in points})
    about = (
        f"A problem is one of {plural(cases, 'system')} with an error of {', '.join(number(v, 1) for v in LEVELS)} to "
        "be reached by any tolerance, from the guessed positions of the nodes, without fallback; no answer or a wrong "
        "one counts as never solved."
    )
    save = partial(_save, folder)
    return show_profiles(costs, evaluations, looks, save, about, "evaluations of each line", "networks-profiles")


def _save(folder: Path, figure, name: str, title: str, alt: str):
    return style.save(figure, folder, f"networks_{name}", title, alt)


def _points(work: list[dict]) -> list[dict]:
    return [p | {"method": p["label"], "rms": p["error"] if p["verdict"] == "right" else None} for p in work]


def _evaluations(point: dict) -> float | None:
    evaluations = point.get("catenary_evaluations")
    return None if evaluations is None else evaluations / point["lines"]


def cost_table(work: list[dict]) -> Table:
    """Return the cheapest tolerance of each method to each error: run time, iterations and evaluations."""
    rows = cheapest_points(_points(work), list(LEVELS), lambda p: p["seconds"])
    columns = {"case": "system", "level": "error at most", "label": "method", "tolerance": "tolerance", "ms": "ms",
               "iterations": "iter­ations", "evaluations": "residuals", "catenary": "evaluations a line"}  # fmt: skip
    rows = [row | {"ms": 1e3 * row["seconds"], "catenary": _evaluations(row)} for row in rows]
    formats = {"level": "{:g}".format, "ms": partial(number, digits=2), "tolerance": partial(number, digits=1)}
    return Table("networks_costs", "Least cost of a network to an error", columns, rows, formats)
