"""Profiles of the methods for moving lines and networks: run times over the best, and cell evaluations."""

from __future__ import annotations

from pathlib import Path

from ..drawing import style
from ..drawing.profiles import show_profiles
from ..page.figures import Group
from ..page.numbers.formatting import number, plural, seconds
from ..page.numbers.profiles import cheapest_points, least_costs
from ..page.numbers.tables import Table, write_table
from .cases import CASES, METHODS, save

LEVELS = (3e-2, 1e-2, 3e-3, 1e-3)
"""Rms errors over the range that are to be reached."""
BOX = "box scheme"
OF_BOX = {"time domain": f"{BOX}, in time", "harmonic balance": f"{BOX}, harmonic balance"}
"""Beginning of a method of the paper's cable -> its family."""
LOOKS = {name: METHODS[name] for name in ("in time", "harmonic balance", f"{BOX}, in time", "MoorDyn")}
LOOKS |= {f"{BOX}, harmonic balance": METHODS[f"{BOX}, harmonic balance, corrected"]}
COUNTS = {"steps": "time steps", "iterations": "Newton iterations", "factorisations": "factorisations",
          "cell_evaluations": "cell evaluations"}  # fmt: skip


def collect_points(lines: dict, box: dict | None, networks: dict | None) -> list[dict]:
    """Return the points of all cases by family, each with its best settings: extrapolated or corrected is one of them.

    lines, box, networks: the parts "work" of mooring.json, harmonic_balance.json and mooring_networks.json.
    """
    titles = CASES | lines["titles"]
    points = [p | {"case": titles[p["case"]], "method": _family(p["method"])} for p in lines["points"]]
    shared = {p["case"] for p in lines["points"]}
    points += [p | {"case": titles[p["case"]], "method": _family_of_box(p["method"]), "other": _other(p)}
               for p in (box or {"points": ()})["points"] if p["case"] in shared]  # fmt: skip
    if networks:
        about = {"case": networks["title"], "lines": networks["lines"]}
        points += [p | about | {"size": _segments(p["size"])} for p in networks["points"]]
    return [p | {"rms": p["rms"] if p["status"] == "SUCCESS" else None} for p in points]


def _family(method: str) -> str:
    return next((name for name in sorted(LOOKS, key=len, reverse=True) if method.startswith(name)), method)


def _family_of_box(method: str) -> str:
    return next((family for start, family in OF_BOX.items() if method.startswith(start)), method)


def _other(point: dict):
    return point["harmonics"] if "harmonics" in point else f"dt {number(point['dt'], 2)} s"


def _segments(size):
    return " + ".join(map(str, size)) if isinstance(size, list) else size


def profiles(points: list[dict], folder: Path) -> Group | None:
    """Return the performance profile of run times and the data profile of cell evaluations."""
    costs, work = (least_costs(points, LEVELS, cost) for cost in (lambda p: p["seconds"], _evaluations))
    looks = style.add_missing_looks(LOOKS, costs)
    cases = len({p["case"] for p in points})
    about = (
        f"A problem is one of {plural(cases, 'case')} with an rms error of "
        f"{', '.join(f'{100 * level:g}' for level in LEVELS)} % of the range to be reached by any setting; failures, "
        "and cases that a method does not model, count as never solved. A cell evaluation is the equations of one "
        "cell at one instant, once in each Newton iteration or explicit stage."
    )
    return show_profiles(costs, work, looks, lambda figure, **named: save(figure, folder, **named), about,
                         "cell evaluations of each line", "mooring-profiles")  # fmt: skip


def _evaluations(point: dict) -> float | None:
    evaluations = point.get("cell_evaluations")
    return None if evaluations is None else evaluations / point.get("lines", 1)


def cost_table(points: list[dict], folder: Path) -> Table:
    """Return the fastest setting of each method to each error: run time, and cost that depends on no machine."""
    rows = cheapest_points(points, list(LEVELS), lambda p: p["seconds"])
    columns = {"case": "case", "level": "rms error at most", "method": "method", "size": "cells or nodes",
               "other": "steps or harmonics", "seconds": "run time", **COUNTS}  # fmt: skip
    formats = {"level": "{:g}".format, "seconds": seconds}
    return write_table("mooring", folder, "costs", "Least cost to an error", rows, columns, formats=formats)
