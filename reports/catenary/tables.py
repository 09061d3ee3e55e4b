"""The tables about one line at rest, from accuracy.json, work_precision.json, speed.json and benchmark.json."""

from __future__ import annotations

from ..page.numbers import analysis
from ..page.numbers.formatting import number, seconds, two_digits
from ..page.numbers.tables import Table

SOLVER_COLUMNS = {
    "unsupported": "not modelled",
    "refused": "refused",
    "wrong": "wrong",
    "median": "median",
    "max": "max",
}


def regime_table(accuracy: dict) -> Table:
    """Return one row per regime, five columns per solver."""
    names = analysis.sort_solvers(accuracy["solvers"])
    columns = {"regime": "regime", "cases": "cases"}
    keys = {name: _columns_of(accuracy, name) for name in names}
    columns |= {f"{name}_{key}": SOLVER_COLUMNS[key] for name in names for key in keys[name]}
    rows = [
        {"regime": entry["regime"], "cases": entry["cases"]}
        | {f"{name}_{key}": entry["solvers"][name][key] for name in names for key in SOLVER_COLUMNS}
        for entry in analysis.by_regime(accuracy)
    ]
    formats = {f"{name}_{key}": two_digits for name in names for key in ("median", "max")}
    groups = (("", 2), *((_label(accuracy, name), len(keys[name])) for name in names))
    return Table("regimes", "Regimes", columns, rows, formats, groups)


def _columns_of(accuracy: dict, name: str) -> list[str]:
    """Return the columns of a solver: one that models every case needs no column "not modelled"."""
    whole = not analysis.summarise(accuracy["rows"], name)["unsupported"]
    return [key for key in SOLVER_COLUMNS if not (whole and key == "unsupported")]


def _label(accuracy: dict, name: str) -> str:
    solver = accuracy["solvers"][name]
    return f"{solver['label']} {solver['version']}"


def set_table(accuracy: dict) -> Table:
    """Return one row per set of cases and solver."""
    rows = []
    for key, chosen in accuracy["sets"].items():
        for name in analysis.sort_solvers(accuracy["solvers"]):
            mine = analysis.summarise([row for row in accuracy["rows"] if row["set"] == key], name)
            rows.append({"set": chosen["title"], "solver": _label(accuracy, name)} | mine)
    columns = {"set": "set", "solver": "solver", "cases": "cases", "right": "right", **SOLVER_COLUMNS}
    columns |= {"tiny": f"wrong by less than {number(analysis.TINY, 1)} of the weight"}
    return Table("totals", "All cases by set", columns, rows, {"median": two_digits, "max": two_digits})


def speed_table(data: dict) -> Table:
    """Return the measurements side by side."""
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
    return Table("speed", "Speed, side by side in one run", columns, rows, {"error": two_digits, "ratio": two_digits,
                 "least": two_digits, "most": two_digits})  # fmt: skip


def timing_table(rows: list[dict]) -> Table:
    """Return all timings of pytest-benchmark."""
    columns = {"group": "group", "label": "solver", "lines": "lines", "median": "median per line",
               "q1": "first quartile", "q3": "third quartile", "rounds": "rounds", "error": "error"}  # fmt: skip
    formats = dict.fromkeys(("median", "q1", "q3"), seconds) | {"error": two_digits}
    return Table("timings", "Timings", columns, rows, formats)


def work_table(data: dict) -> Table:
    """Return the points of the figure of error against time."""
    columns = {key: key for key in ("case", "label", "tolerance", "seconds", "error", "verdict", "iterations")}
    return Table("work_precision", "Error against run time", columns, data["points"])
