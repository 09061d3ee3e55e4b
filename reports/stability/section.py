"""The section on stability: maps, counts, stiff integration and the other codes, from stability.json."""

from __future__ import annotations

from ..page.numbers.formatting import number, plural, python_call, two_digits
from ..page.numbers.tables import Table
from ..page.numbers.verdicts import Verdict
from ..page.section import Content, Inputs, Section
from . import figures

TITLES = {
    "span": "Lines at rest",
    "network": "Networks",
    "statics": "The cable at rest on a mesh",
    "time domain": "Time domain",
    "harmonic balance": "Harmonic balance",
}


def build(inputs: Inputs) -> Content:
    """Return the maps by solver, their counts, and the same grids on other codes."""
    data = inputs.results["stability"]
    limit = (inputs.results["harmonic_balance"] or {}).get("limit")
    sentences = [*_map_sentences(data), *_limit_sentences(limit)]
    if not data:
        return Content({"stability": None}, sentences=sentences)
    by_solver = {}
    for entry in data["maps"]:
        by_solver.setdefault(entry["solver"], []).append(entry)
    shown = [
        {
            "title": TITLES.get(solver, solver),
            "quantity": list(dict.fromkeys(entry["quantity"] for entry in entries)),
            "bounds": list(dict.fromkeys(number(e["bound"]) for e in entries if e.get("bound") is not None)),
            "claims": [text.replace("e-0", "e-") for text in dict.fromkeys(entry["claim"] for entry in entries)],
            "explained": _explained(entries),
            "maps": figures.maps(entries, data.get("explicit") or [], inputs.figures),
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
        table.write(inputs.tables)
    stability = tables | {
        "sections": shown,
        "stiff": figures.stiff(data["explicit"], data["axial"], inputs.figures) if stiff else None,
        "examples": [_example(row, one) for row in spans for one in row["examples"]],
        "moving_rows": moving,
        "moving_examples": [_moved(row) for row in moving if row["counts"]["wrong"]],
    }
    return Content({"stability": stability}, verdicts(data), sentences)


def _totals(data: dict) -> dict[str, int]:
    """Return verdict -> number of points of all maps."""
    return {v: sum(entry["counts"][v] for entry in data["maps"]) for v in data["verdicts"]}


def verdicts(data: dict) -> list[Verdict]:
    """Return how many points of all maps are wrong, and how many are solved."""
    if not data["maps"]:
        return []
    totals = _totals(data)
    points, bad = sum(totals.values()), totals["wrong"] + totals["crashed"]
    text = f"of {number(points)} points of {len(data['maps'])} stability maps, wanted 0"
    answers = f"of {number(points)}; the others warn, or say that they have none"
    return [
        Verdict(number(bad), "wrong at the limits", text, bad == 0, "stability"),
        Verdict(number(totals["solved"]), "solved at the limits", answers, None, "stability"),
    ]


def _map_sentences(data: dict | None) -> list[str]:
    if not data or not data["maps"]:
        return []
    totals = _totals(data)
    counts = ", ".join(f"{number(count)} {verdict}" for verdict, count in totals.items() if count)
    maps = plural(len(data["maps"]), "map")
    return [f"{number(sum(totals.values()))} points pushed to the limits on {maps}: {counts}."]


def _limit_sentences(limit: dict | None) -> list[str]:
    """Return where the tension of the OC3 line vanishes under surge, from harmonic_balance.json."""
    if not limit or not limit["vanishes"]:
        return []
    failed = [row["amplitude"] for row in limit["rows"] if row["reached"] < 1.0]
    end = f"; no response is found from {number(min(failed))} m on" if failed else ""
    return [
        f"Under surge the tension of the OC3 line vanishes at an amplitude of {number(limit['vanishes'], 4)} m: beyond "
        f"it results are marked as compression{end}."
    ]


def _explained(entries: list[dict]) -> list[str]:
    """Return why there are points without an answer, where there are some."""
    failed = ("not converged", "invalid", "too coarse")
    return list(
        dict.fromkeys(e["explained"] for e in entries if any(e["counts"][v] for v in failed) and e["explained"])
    )


def _counts(data: dict) -> Table:
    rows = [{"map": entry["title"], "solver": entry["solver"]} | entry["counts"] for entry in data["maps"]]
    columns = {"map": "map", "solver": "solver"} | {verdict: verdict for verdict in data["verdicts"]}
    return Table("stability_counts", "Stability maps", columns, [*rows, {"map": "all", "solver": ""} | _totals(data)])


def _points(data: dict) -> Table:
    """Return every point of every map; for the files beside the page."""
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
    return Table("stability_moving", "Surge on other codes", columns, shown, {"worst": two_digits})


def _example(row: dict, one: dict) -> dict:
    label, call = f"{row['label']} {row['version']}", python_call(row["solver"], one["inputs"])
    return one | {"label": label, "map": row["title"], "call": call}


def _moved(row: dict) -> dict:
    """Return the wrong point of a grid of motions with the least amplitude."""
    point = min((p for p in row["points"] if p["verdict"] == "wrong"), key=lambda p: p["y"])
    return row | {"x": point["x"], "y": point["y"], "error": point["error"]}


TESTS = "suite/test_stability.py::"
STABILITY = Section(
    id="stability",
    title="Stability maps",
    part="breaks",
    page="limits",
    needs=("stability", "harmonic_balance"),
    template="stability/section.html.j2",
    build=build,
    tests={
        "stability": (
            f"{TESTS}test_networks_with_a_stiffness_contrast",
            f"{TESTS}test_time_domain_at_the_limits",
            f"{TESTS}test_harmonic_balance_at_the_limits",
            f"{TESTS}test_lost_tension_is_never_a_success",
            f"{TESTS}test_a_spoiled_success_is_found",
        ),
    },
)
