"""The section on stability: maps, counts, stiff integration and the other codes, from stability.json."""

from __future__ import annotations

from pathlib import Path

from ..page.formatting import number
from ..page.tables import Table, short
from ..page.verdicts import Verdict
from . import figures

TITLES = {
    "span": "Lines at rest",
    "network": "Networks",
    "statics": "The cable at rest on a mesh",
    "time domain": "Time domain",
    "harmonic balance": "Harmonic balance",
}
OURS = "catenary"


def section(data: dict | None, figure_folder: Path, table_folder: Path) -> dict | None:
    """What the template stability.html.j2 takes; None without a result file."""
    if not data:
        return None
    by_solver = {}
    for entry in data["maps"]:
        by_solver.setdefault(entry["solver"], []).append(entry)
    shown = [
        {
            "title": TITLES.get(solver, solver),
            "quantity": list(dict.fromkeys(entry["quantity"] for entry in entries)),
            "claims": [text.replace("e-0", "e-") for text in dict.fromkeys(entry["claim"] for entry in entries)],
            "explained": _explained(entries),
            "maps": figures.maps(entries, data.get("explicit") or [], figure_folder),
        }
        for solver, entries in by_solver.items()
    ]
    stiff = data.get("explicit") and data.get("axial")
    spans, moving = data.get("peers_spans") or [], data.get("peers_dynamics") or []
    tables = {
        "counts": _counts(data),
        "points": _points(data),
        "peers": _peers(spans) if spans else None,
        "moving": _moving(moving) if moving else None,
    }
    for table in filter(None, tables.values()):
        table.write(table_folder)
    return tables | {
        "sections": shown,
        "verdicts": verdicts(data),
        "stiff": figures.stiff(data["explicit"], data["axial"], figure_folder) if stiff else None,
        "examples": [_example(row, one) for row in spans for one in row["examples"]],
        "moving_rows": moving,
        "moving_examples": [_moved(row) for row in moving if row["counts"]["wrong"]],
    }


def verdicts(data: dict | None) -> list[Verdict]:
    """For the strip at the top of the page."""
    if not data or not data["maps"]:
        return []
    total = {v: sum(entry["counts"][v] for entry in data["maps"]) for v in data["verdicts"]}
    points = sum(total.values())
    bad = total["wrong"] + total["crashed"]
    text = f"of {number(points)} points of {len(data['maps'])} stability maps, wanted 0"
    answers = f"of {number(points)}; the others warn, or say that they have none"
    return [
        Verdict(number(bad), "wrong at the limits", text, bad == 0, "stability"),
        Verdict(number(total["solved"]), "solved at the limits", answers, None, "stability"),
    ]


def _explained(entries: list[dict]) -> list[str]:
    """Why there are points without an answer, where there are some."""
    failed = ("not converged", "invalid", "too coarse")
    return list(
        dict.fromkeys(e["explained"] for e in entries if any(e["counts"][v] for v in failed) and e["explained"])
    )


def _counts(data: dict) -> Table:
    rows = [{"map": entry["title"], "solver": entry["solver"]} | entry["counts"] for entry in data["maps"]]
    total = {v: sum(entry["counts"][v] for entry in data["maps"]) for v in data["verdicts"]}
    columns = {"map": "map", "solver": "solver"} | {verdict: verdict for verdict in data["verdicts"]}
    return Table("stability_counts", "Stability maps", columns, [*rows, {"map": "all", "solver": ""} | total])


def _points(data: dict) -> Table:
    """Every point of every map; for the files beside the page."""
    rows = [
        point | {"map": entry["name"], "x": entry["x"]["values"][point["x"]], "y": entry["y"]["values"][point["y"]]}
        for entry in data["maps"]
        for point in entry["points"]
    ]
    keys = ("map", "x", "y", "verdict", "status", "error", "message", "seconds")
    return Table("stability_points", "Every point", {key: key for key in keys}, rows)


def _peers(spans: list[dict]) -> Table:
    rows = [{"map": row["title"], "solver": f"{row['label']} {row['version']}"} | row["counts"] for row in spans]
    columns = {"map": "map", "solver": "solver", "right": "right", "wrong": "wrong", "refused": "refused",
               "unsupported": "not modelled"}  # fmt: skip
    return Table("stability_peers", "The same lines on other codes", columns, rows)


def _moving(rows: list[dict]) -> Table:
    shown = [
        {"map": " by ".join(row["axes"]), "solver": f"{row['label']} {row['version']}"}
        | row["counts"]
        | {"worst": max((p["error"] for p in row["points"] if p.get("error") is not None), default=None)}
        for row in rows
    ]
    columns = {"map": "grid", "solver": "solver", "right": "right", "wrong": "wrong", "refused": "refused",
               "no truth": "no converged truth", "worst": "greatest error"}  # fmt: skip
    return Table("stability_moving", "Surge on other codes", columns, shown, {"worst": short})


def _example(row: dict, one: dict) -> dict:
    arguments = ", ".join(f"{key}={value!r}" for key, value in one["inputs"].items())
    call = (
        "from benchmarks.peers import adapters\nfrom solvers import Span, solve_span\n"
        f"from verification.cases.spans import SpanCase\ninputs = dict({arguments})\n"
        f'adapters()["{row["solver"]}"].span(SpanCase("example", "", **inputs)), solve_span(Span(**inputs))'
    )
    return one | {"label": f"{row['label']} {row['version']}", "map": row["title"], "call": call}


def _moved(row: dict) -> dict:
    """The wrong point of a grid of motions with the least amplitude."""
    point = min((p for p in row["points"] if p["verdict"] == "wrong"), key=lambda p: p["y"])
    return row | {"x": point["x"], "y": point["y"], "error": point["error"]}
