"""The section on networks of lines: its tables, figures and paragraphs from networks.json."""

from __future__ import annotations

from pathlib import Path

from . import network_figures, network_words
from .tables import Table, short
from .words import number, slug

STARTS = ("printed", "sound")
"""Starts of the table; without any start all settings go through the same robust start, so one sentence tells it."""

METHOD = ("method", "jacobian", "globalisation")
COUNTS = ("iterations", "inner_iterations", "operations", "residual_norm")  # of the printed table
SYSTEMS = {"oc3_three_lines": "three lines of a spar", "three_bridles": "three lines with bridles"}


def section(data: dict | None, looks: dict, figure_folder: Path, table_folder: Path) -> dict | None:
    """All that the page shows about networks, of the parts that were measured; None without a result file."""
    if not data:
        return None
    table2, speed, peers = (data.get(part) or [] for part in ("table2", "speed", "peers"))
    made = {
        "table2": [_table2(table2, data["printed"], w) for w in dict.fromkeys(row["weight"] for row in table2)],
        "speed": _speed(speed) if speed else None,
        "peers": _peers(peers) if peers else None,
    }
    for table in filter(None, (*made["table2"], made["speed"], made["peers"])):
        table.write(table_folder)
    growth = data.get("growth")
    return made | {
        "reproduction": network_words.reproduction(table2, data["printed"]) if table2 else [],
        "speed_words": network_words.speed(speed) if speed else "",
        "peer_words": network_words.peers(peers, SYSTEMS) if peers else "",
        "gain": network_figures.gain(speed, looks, figure_folder) if speed else None,
        "growth": network_figures.growth(growth, figure_folder) if growth else None,
    }


def printed_row(row: dict, printed: list[dict]) -> dict:
    """What the paper prints for the same method; {} where it has no such row."""
    if row["method"] == "nested" and row["jacobian"] != "finite-difference":
        return {}  # the paper proposes it and gives no figures
    return next((p for p in printed if all(p.get(key) in (None, row[key]) for key in METHOD)), {})


def status(value: str) -> str:
    """NOT_CONVERGED: not converged."""
    return {"SUCCESS": "solved"}.get(value, value.lower().replace("_", " "))


def _table2(rows: list[dict], printed: list[dict], w: float) -> Table:
    """One row per start and method at the weight w, N/m."""
    shown = []
    for row in (row for start in STARTS for row in rows if (row["weight"], row["start"]) == (w, start)):
        paper = {f"printed_{key}": printed_row(row, printed).get(key) for key in COUNTS}
        shown.append(row | paper | {"ms": 1e3 * row["seconds"]})
    ours = {"iterations": "iter­ations", "function_evaluations": "evalu­ations", "operations": "oper­ations",
            "residual_norm": "residual", "condition_number": "condition", "ms": "ms", "status": "status"}  # fmt: skip
    if any("inner_iterations" in row for row in shown):
        ours = {"iterations": ours.pop("iterations"), "inner_iterations": "inner"} | ours
    paper = {"iterations": "iter­ations", "inner_iterations": "inner", "operations": "oper­ations",
             "residual_norm": "residual"}  # fmt: skip
    given = {"start": "start", "method": "method", "jacobian": "Jacobian", "globalisation": "globalisation"}
    columns = given | {"units": "units"} | ours | {f"printed_{key}": heading for key, heading in paper.items()}
    groups = (("setting", len(given) + 1), ("measured", len(ours)), ("printed", len(paper)))
    formats = dict.fromkeys(("residual_norm", "printed_residual_norm", "condition_number", "ms"), short)
    formats |= {"operations": _whole, "status": status}
    formats |= dict.fromkeys(
        ("jacobian", "globalisation"), lambda value: (value or number(None)).replace("finite-", "")
    )
    return Table(f"networks_table2_{slug(str(w))}", f"Table 2 remade, {w:g} N/m", columns, shown, formats, groups)


def _whole(value) -> str:
    return number(round(value))


def _speed(rows: list[dict]) -> Table:
    """Nested with differences beside monolithic analytic."""
    shown = []
    for row in rows:
        times = {f"{name}_ms": 1e3 * row[f"{name}_seconds"] for name in ("monolithic", "nested_differences")}
        least, most = row["ratio_spread"]
        shown.append(row | times | {"least": least, "most": most})
    each = {"ms": "ms", "iterations": "iter­ations", "evaluations": "evalu­ations", "residual_norm": "residual",
            "status": "status"}  # fmt: skip
    columns = {"system": "system"}
    columns |= {
        f"{name}_{key}": heading for name in ("monolithic", "nested_differences") for key, heading in each.items()
    }
    columns |= {"ratio": "median", "least": "5 %", "most": "95 %"}
    groups = (("", 1), ("monolithic, analytic", len(each)), ("nested, differences", len(each)), ("ratio of times", 3))
    formats = dict.fromkeys(("ratio", "least", "most", "monolithic_residual_norm"), short)
    formats |= {"nested_differences_residual_norm": short}
    formats |= {f"{name}_status": status for name in ("monolithic", "nested_differences")}
    return Table("networks_speed", "Methods side by side", columns, shown, formats, groups)


def _peers(rows: list[dict]) -> Table:
    """MoorPy on the same systems."""
    shown = []
    for row in rows:
        least, most = row["ratio_spread"]
        times = {"our_ms": 1e3 * row["our_seconds"], "peer_ms": 1e3 * row["peer_seconds"]}
        shown.append(row | times | {"name": SYSTEMS.get(row["system"], row["system"]), "least": least, "most": most})
    columns = {"name": "system", "elements": "elements", "setting": "MoorPy setting", "tolerance": "its tolerance, m",
               "our_ms": "this project, ms", "peer_ms": "MoorPy, ms", "ratio": "MoorPy over this project, out",
               "least": "5 %", "most": "95 %", "ratio_back": "the same, back",
               "our_iterations": "iterations of this project",
               "our_residual_norm": "residual of this project", "peer_residual_norm": "residual of MoorPy",
               "peer_tension_difference": "difference of tension"}  # fmt: skip
    keys = (
        "ratio",
        "least",
        "most",
        "ratio_back",
        "our_residual_norm",
        "peer_residual_norm",
        "peer_tension_difference",
    )
    return Table("networks_peers", "Networks beside MoorPy", columns, shown, dict.fromkeys(keys, short))
