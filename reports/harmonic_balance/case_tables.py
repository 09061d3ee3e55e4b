"""The cases of the HB paper: measured and printed times, errors, the converged tension, and times at equal error."""

from __future__ import annotations

from itertools import pairwise
from statistics import median

from ..cable.cases import CASES
from ..cable.tables import write_table
from ..page.figures import FigureWithTable
from ..page.numbers.formatting import number, seconds, two_digits
from ..page.numbers.tables import Table
from ..pipeline import published
from ..pipeline.published import printed_value
from . import paper_figures, work_figures


def show_cases(data, folder, tables) -> dict:
    """Return HB Table 2 with the printed times, HB Figs. 6 to 9 and the converged tension."""
    rows = [row for row in data["rows"] if "seconds" in row]
    entries = [
        {"case": CASES[row["case"]], "method": row["method"], "seconds": min(row["seconds"]),
         "median": median(row["seconds"]), "printed": published.hb_table2(row["case"], row["method"]),
         "iterations": row["iterations"],
         "rms": row["rms"], "error": row["error"], "uncertainty": row["uncertainty"]}
        for row in rows
    ]  # fmt: skip
    columns = {"case": "case", "method": "method", "seconds": "least time", "median": "median time",
               "printed": "printed (C++)", "iterations": "Newton iterations", "rms": "rms error", "error": "greatest "
               "error",
               "uncertainty": "uncertainty of the reference"}  # fmt: skip
    formats = dict.fromkeys(("seconds", "median", "printed"), seconds) | dict.fromkeys(
        ("rms", "error", "uncertainty"), two_digits
    )
    waves = [
        {"case": row["case"], "method": row["method"], "instant": i, "tension": value}
        for row in data["rows"]
        for i, value in enumerate(row["tension"])
    ]
    states = [
        {"case": row["case"], "method": row["method"], "instant": i, "field": field, "value": value}
        for row in rows
        for field, values in row.get("fields", {}).items()
        for i, value in enumerate(values)
    ]
    return {
        "table": write_table(tables, "table2", "HB Table 2 remade", entries, columns, formats=formats),
        "text": _table2_text(rows),
        "states": paper_figures.states(data, folder),
        "waves": write_table(tables, "waves", "Tension of the cases", waves),
        "fields": write_table(tables, "states", f"State at node {data['node']}", states),
        "independent": _independent(data, tables),
        "levels": data["levels"],
    }


def _table2_text(rows) -> str:
    gains, paper = [], []
    for stepped, balanced in pairwise(rows):
        if (stepped["method"], balanced["method"]) == ("time domain", "harmonic balance"):
            gains.append(min(stepped["seconds"]) / min(balanced["seconds"]))
            paper.append(published.hb_table2(balanced["case"], balanced["method"]) / min(balanced["seconds"]))
    return (
        f"The paper's settings: {printed_value('nodes')} nodes, {printed_value('harmonics sufficient')} harmonics and "
        f"{printed_value('samples sufficient')} samples, dt = {printed_value('time step')} s and "
        f"{printed_value('periods simulated')} periods. Errors are those of the fairlead tension over a period against "
        f"the converged one, over its range. Harmonic balance is {number(min(gains), 2)} to {number(max(gains), 2)} "
        f"times as fast as time stepping here, and {number(min(paper), 2)} to {number(max(paper), 2)} times as fast as "
        "the paper prints for its C++ on an older machine."
    )


def _independent(data, tables) -> Table:
    """Return the converged tension of case 1 and that of independent programs."""
    ours, theirs = data["converged"], published.independent("reference")
    within = max(float(row["uncertainty"]) for row in published.read("oc3_dynamics")[1] if row["name"] == "reference")
    computed = {"maximum": ours["max"], "minimum": ours["min"], "mean": ours["harmonics"][0]}
    computed |= {f"harmonic {k}": value for k, value in enumerate(ours["harmonics"][1:], 1)}
    rows = [
        {"what": what, "ours": a, "theirs": theirs[what], "difference": a - theirs[what],
         "within": abs(a - theirs[what]) <= within}
        for what, a in computed.items()
    ]  # fmt: skip
    columns = {"what": "fairlead tension of case 1", "ours": "this project, kN", "theirs": "two other programs, kN",
               "difference": "difference", "within": f"within {within:g} kN"}  # fmt: skip
    formats = {"ours": "{:.3f}".format, "theirs": "{:.2f}".format, "difference": two_digits,
               "within": lambda v: "yes" if v else "no"}  # fmt: skip
    return write_table(tables, "independent", "Converged tension of case 1", rows, columns, formats=formats)


def show_work(data, folder, tables) -> dict:
    """Return error against run time, and every method's least time to an error."""
    keys = ("case", "method", "size", "harmonics", "dt", "seconds", "steps", "iterations", "factorisations",
            "cell_evaluations", "rms", "error", "status", "message")  # fmt: skip
    columns = {key: key.replace("_", " ") for key in keys}
    table = write_table(tables, "work", "Error against run time", data["points"], columns)
    return {"points": FigureWithTable(work_figures.work(data, folder), table), "levels": _levels(data, tables)}


def _levels(data, tables) -> Table:
    """Return every method's least time to an error and its cell evaluations, with the setting of harmonic balance."""
    family, rows = "harmonic balance", []
    others = dict.fromkeys(method for row in data["at_errors"] for method in row["best"] if method != family)
    for entry in data["at_errors"]:
        best, row = entry["best"], {"case": CASES[entry["case"]], "level": entry["level"]}
        if ours := best.get(family):
            corrected = ", corrected" if ours["method"] != family else ""
            row |= {
                "ours": ours["seconds"],
                "cells": ours.get("cell_evaluations"),
                "setting": f"{ours['size']}, {ours['harmonics']}{corrected}",
            }
        for method in (name for name in others if name in best):
            row[method] = best[method]["seconds"]
            row[f"{method} cells"] = best[method].get("cell_evaluations")
            row[f"{method} ratio"] = best[method]["seconds"] / ours["seconds"] if ours else None
        rows.append(row)
    columns = {"case": "case", "level": "rms error at most", "ours": family, "setting": "with (nodes, harmonics)",
               "cells": "cell evaluations"}  # fmt: skip
    for method in others:
        columns |= {method: method, f"{method} ratio": "over harmonic balance",
                    f"{method} cells": "cell evaluations"}  # fmt: skip
    formats = dict.fromkeys(("ours", *others), seconds) | {f"{method} ratio": two_digits for method in others}
    formats["level"] = "{:g}".format
    return write_table(tables, "equal_errors", "Least times to an error", rows, columns, formats=formats)
