"""The tables of the page, each also a CSV and a JSON file with the unrounded values."""

from __future__ import annotations

import csv
import io
import json
from dataclasses import dataclass, field
from pathlib import Path

from ..pipeline.ledger import write_atomically
from . import analysis
from .claims import Question, claim_id, find
from .formatting import number, seconds


@dataclass
class Table:
    """columns : key of a row -> heading; rows : raw values; formats : key -> how the page writes it (default: number).

    groups : (heading, number of columns) over the headings, where columns belong together.
    anchors : column -> key of the row with the id that its cells link to
    """

    name: str
    title: str
    columns: dict
    rows: list[dict]
    formats: dict = field(default_factory=dict)
    groups: tuple = ()
    anchors: dict = field(default_factory=dict)

    def numeric(self, key) -> bool:
        """A column that holds numbers, its dashes among them."""
        values = [row.get(key) for row in self.rows]
        return any(isinstance(value, (int, float)) and not isinstance(value, bool) for value in values)

    def shown(self) -> list[list[tuple[str, bool, str | None]]]:
        """(text, is in a column of numbers, id that it links to) of every cell."""
        numeric = {key: self.numeric(key) for key in self.columns}
        return [
            [
                (self.formats.get(key, number)(row.get(key)), numeric[key], row.get(self.anchors.get(key)))
                for key in numeric
            ]
            for row in self.rows
        ]

    def write(self, folder: Path) -> Table:
        """name.csv and name.json; returns self."""
        text = io.StringIO()
        writer = csv.DictWriter(text, list(self.columns), extrasaction="ignore", lineterminator="\n")
        writer.writeheader()
        writer.writerows(self.rows)
        write_atomically(folder / f"{self.name}.csv", text.getvalue())
        kept = [{key: row.get(key) for key in self.columns} for row in self.rows]
        write_atomically(folder / f"{self.name}.json", json.dumps(kept, indent=1))
        return self


SOLVER_COLUMNS = {
    "unsupported": "not modelled",
    "refused": "refused",
    "wrong": "wrong",
    "median": "median",
    "max": "max",
}


def regimes(accuracy: dict) -> Table:
    """One row per regime, five columns per solver."""
    names = analysis.sort_solvers(accuracy["solvers"])
    columns = {"regime": "regime", "cases": "cases"}
    kept = {name: _kept(accuracy, name) for name in names}
    columns |= {f"{name}_{key}": SOLVER_COLUMNS[key] for name in names for key in kept[name]}
    rows = [
        {"regime": entry["regime"], "cases": entry["cases"]}
        | {f"{name}_{key}": entry["solvers"][name][key] for name in names for key in SOLVER_COLUMNS}
        for entry in analysis.by_regime(accuracy)
    ]
    short = {f"{name}_{key}": lambda value: number(value, 2) for name in names for key in ("median", "max")}
    groups = (("", 2), *((_named(accuracy, name), len(kept[name])) for name in names))
    return Table("regimes", "Regimes", columns, rows, short, groups)


def _kept(accuracy: dict, name: str) -> list[str]:
    """The columns of a solver: one that models every case needs none for those that it does not."""
    whole = not analysis.summarise(accuracy["rows"], name)["unsupported"]
    return [key for key in SOLVER_COLUMNS if not (whole and key == "unsupported")]


def _named(accuracy: dict, name: str) -> str:
    solver = accuracy["solvers"][name]
    return f"{solver['label']} {solver['version']}"


def totals(accuracy: dict) -> Table:
    """One row per set of cases and solver."""
    rows = []
    for key, chosen in accuracy["sets"].items():
        for name in analysis.sort_solvers(accuracy["solvers"]):
            mine = analysis.summarise([row for row in accuracy["rows"] if row["set"] == key], name)
            rows.append({"set": chosen["title"], "solver": _named(accuracy, name)} | mine)
    columns = {"set": "set", "solver": "solver", "cases": "cases", "right": "right", **SOLVER_COLUMNS}
    columns |= {"tiny": f"wrong by less than {number(analysis.TINY, 1)} of the weight"}
    return Table("totals", "All cases by set", columns, rows, {"median": short, "max": short})


def short(value) -> str:
    return number(value, 2)


def speed(data: dict) -> Table:
    """The measurements side by side."""
    cold, batch, rows = data["cold_oc3"], data["batch"], []
    for name, label in cold["solvers"].items():
        spread = cold.get(f"ratio_spread_{name}") or (None, None)
        rows.append(
            {
                "what": f"one cold solve, {cold[f'case_{name}']}", "solver": label, "us": cold[f"{name}_us"],
                "ratio": cold.get(f"ratio_{name}"), "least": spread[0], "most": spread[1],
                "error": cold[f"error_{name}"],
            }
        )  # fmt: skip
    for size in ("1e5", "1e6"):
        title = f"{float(size):,.0f} mixed lines in one call".replace(",", " ")
        rows.append({"what": title, "solver": "this project", "us": batch[f"us_per_line_{size}"]})
    columns = {"what": "what", "solver": "solver", "us": "µs per line", "ratio": "times this project (median)",
               "least": "least", "most": "most", "error": "relative error"}  # fmt: skip
    return Table("speed", "Speed, side by side in one run", columns, rows, {"error": short, "ratio": short,
                 "least": short, "most": short})  # fmt: skip


def timings(rows: list[dict]) -> Table:
    """All timings of pytest-benchmark."""
    columns = {"group": "group", "label": "solver", "lines": "lines", "median": "median per line",
               "q1": "first quartile", "q3": "third quartile", "rounds": "rounds", "error": "error"}  # fmt: skip
    formats = dict.fromkeys(("median", "q1", "q3"), seconds) | {"error": short}
    return Table("timings", "Timings", columns, rows, formats)


def work_points(data: dict) -> Table:
    """The points of the figure of error against time."""
    columns = {key: key for key in ("case", "label", "tolerance", "seconds", "error", "verdict", "iterations")}
    return Table("work_precision", "Error against run time", columns, data["points"])


def claims(found: list[Question]) -> Table:
    """Every claim with its outcome."""
    rows = [
        {
            "file": q.module,
            "question": q.text,
            "test": c.name,
            "claim": c.text,
            "state": c.state,
            **c.counts,
            "seconds": c.seconds,
        }
        for q in found
        for c in q.claims
    ]
    keys = ("file", "question", "test", "claim", "state", "passed", "failed", "skipped", "seconds")
    return Table("claims", "Claims and tests", {key: key for key in keys}, rows)


def errata(data: dict, found: list[Question]) -> Table:
    """The misprints, each with its test and how that test ended."""
    rows = []
    for entry in data["erratum"]:
        claim, (file, _, name) = find(found, entry["test"]), entry["test"].partition("::")
        anchor = claim_id(file.removeprefix("verification/").removesuffix(".py"), claim.name) if claim else None
        result = claim.state if claim else "no such test yet"
        rows.append(entry | {"test": name, "result": result, "anchor": anchor})
    keys = ("paper", "where", "printed", "right", "evidence", "test", "result")
    return Table(
        "errata", "Misprints found in the papers", {key: key for key in keys}, rows, anchors={"test": "anchor"}
    )


def published(name: str, rows: list[dict]) -> Table:
    """Printed against computed values."""
    columns = {"line": "line", "quantity": "quantity", "printed": "printed", "computed": "computed",
               "difference": "difference", "open": "left open by printed digits", "within": "within"}  # fmt: skip
    long = {"printed": "{:.10g}".format, "computed": "{:.9g}".format, "difference": short, "open": short,
            "within": lambda v: "yes" if v else "no"}  # fmt: skip
    return Table(f"published_{name}", name, columns, rows, long)
