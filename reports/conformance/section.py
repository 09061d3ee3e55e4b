"""The section on conformance: verdicts by code and feature, and scripts that reproduce what is wrong."""

from __future__ import annotations

from collections import Counter

from ..page.numbers.formatting import number, plural, two_digits
from ..page.numbers.tables import Table
from ..page.numbers.verdicts import Verdict
from ..page.section import Content, Inputs, Section
from .explanations import explain
from .scripts import write_scripts

OURS = "this_project"
RIGHT, INACCURATE, WRONG, REFUSED, NOT_MODELLED = VERDICTS = (
    "right", "inaccurate", "wrong", "refused", "not modelled")  # fmt: skip
NOT_RUN, NO_METHOD = "not run", "no method"
FOLDER = "conformance"
"""Beside the page: where the scripts are."""


def build(inputs: Inputs) -> Content:
    """Return codes by features, the cases that are not right, and the bounds; write the scripts of wrong cells."""
    reports = inputs.results["conformance"]
    if not reports:
        return Content({"conformance": None})
    rows = list(case_rows(inputs.tables.parent / FOLDER, reports))
    tables = {"codes": code_table(reports), "cases": case_table(rows), "bounds": bound_table(reports)}
    matrix = feature_rows(reports, rows)
    flat = [{"feature": row["feature"]} | {one["label"]: one["text"] for one in row["cells"]} for row in matrix]
    labels = [report["solver"]["label"] for report in reports.values()]
    features = Table("conformance_features", "Codes by features", {key: key for key in ("feature", *labels)}, flat)
    for table in (*tables.values(), features):
        table.write(inputs.tables)
    mistakes = {report["solver"]["label"]: [_mistake(one) for one in report["mistakes"]] for report in reports.values()}
    shown = tables | {"set": next(iter(reports.values()))["set"], "matrix": matrix, "features": features,
                      "titles": [_title(report) for report in reports.values()], "mistakes": mistakes,
                      "wrong": [row for row in rows if row["verdict"] in (WRONG, REFUSED)],
                      "left_out": {_title(reports[name]): ids for name, ids in left_out(reports).items()}}  # fmt: skip
    return Content({"conformance": shown}, list(verdicts(reports)), [_sentence(report) for report in reports.values()])


def verdicts(reports: dict):
    """Yield how many conformance cases this project answers rightly."""
    if OURS in reports:
        count = reports[OURS]["verdicts"]
        total, right = sum(count.values()), count.get(RIGHT, 0)
        detail = f"of {plural(total, 'conformance case')} of the set {reports[OURS]['set']}, wanted all"
        yield Verdict(number(right), "right by the public bounds", detail, right == total, "conformance", "verified")


def _sentence(report: dict) -> str:
    counts = ", ".join(f"{count} {verdict}" for verdict, count in report["verdicts"].items())
    return f"Conformance {report['set']}, {_title(report)}: {counts}."


def _title(report: dict) -> str:
    return f"{report['solver']['label']} {report['solver']['version']}"


# ---------------------------------------------------------------- tables
def code_table(reports: dict) -> Table:
    """Return the verdicts of every code, and how much of what was asked it answers."""
    rows = []
    for report in reports.values():
        answered = report["answered"]
        rows.append({"code": _title(report)} | {verdict: report["verdicts"].get(verdict, 0) for verdict in VERDICTS}
                    | {"answered": f"{answered['quantities']} of {answered['asked']}",
                       "seconds": sum(row["seconds"] or 0 for row in report["cases"])})  # fmt: skip
    columns = {"code": "code"} | {verdict: verdict for verdict in VERDICTS}
    columns |= {"answered": "quantities answered", "seconds": "seconds"}
    return Table("conformance_codes", "Verdicts by code", columns, rows, {"seconds": two_digits})


def case_rows(folder, reports: dict):
    """Yield every case that is not right or not modelled, with its worst quantity, in words why, and its script."""
    for name, report in reports.items():
        mine = [row for row in report["cases"] if row["verdict"] in (INACCURATE, WRONG, REFUSED)]
        scripts = write_scripts(folder, name, report, [row for row in mine if row["verdict"] == WRONG])
        for row in mine:
            worst = max(row["quantities"], key=_excess, default={})
            yield {"code": _title(report), "name": name, "id": row["id"], "title": row["title"], "group": row["group"],
                   "features": ", ".join(row["features"]), "verdict": row["verdict"],
                   "quantity": worst.get("quantity"), "error": worst.get("error"), "right": worst.get("right"),
                   "wrong": worst.get("wrong"), "digits": worst.get("digits"), "why": why(name, row),
                   "script": f"{FOLDER}/{scripts[row['id']]}" if row["id"] in scripts else "",
                   "anchor": f"conformance-{name}-{row['id'].replace('/', '-')}"}  # fmt: skip


def _excess(quantity: dict) -> float:
    """Return by how much a quantity misses its verdict: over the wrong bound, else over the right one."""
    return (quantity["error"] > quantity["wrong"]) * 1e6 + quantity["error"] / quantity["right"]


def why(name: str, row: dict) -> str:
    """Return what was refused and why, or the mistake that the answer matches, or what is known of the code."""
    if row["message"]:
        return row["message"]
    matches = [_match(one) for one in row["matches"][:1]]
    return "; ".join(filter(None, [*matches, explain(name, row)])) or "no listed mistake has this answer"


def _match(match: dict) -> str:
    return f"equals the answer {'' if match['name'].startswith('without') else 'of '}{match['name']}"


def case_table(rows: list[dict]) -> Table:
    """Return the cases that are not right."""
    columns = {"code": "code", "id": "case", "verdict": "verdict", "quantity": "worst quantity", "error": "error",
               "right": "right up to", "wrong": "wrong above", "why": "diagnosis"}  # fmt: skip
    formats = dict.fromkeys(("error", "right", "wrong"), two_digits)
    return Table("conformance_cases", "Every case that is not right", columns, rows, formats)


def bound_table(reports: dict) -> Table:
    """Return the least and greatest bounds of every quantity by level, as the codes that answer it were judged."""
    bounds: dict[tuple[str, str], list] = {}
    for report in reports.values():
        for row in report["cases"]:
            for one in row["quantities"]:
                bounds.setdefault((row["level"], one["quantity"]), []).append((one["right"], one["wrong"]))
    rows = [{"level": level, "quantity": quantity, "right": min(pairs)[0], "most": max(pairs)[0], "wrong": pairs[0][1]}
            for (level, quantity), pairs in bounds.items()]  # fmt: skip
    columns = {"level": "level", "quantity": "quantity", "right": "right up to, least", "most": "greatest",
               "wrong": "wrong above"}  # fmt: skip
    return Table("conformance_bounds", "Bounds", columns, rows, dict.fromkeys(("right", "most", "wrong"), two_digits))


# ---------------------------------------------------------------- codes by features
def feature_rows(reports: dict, rows: list[dict]) -> list[dict]:
    """Return a row a feature: a cell a code with its sentence, state, and the script and rows of what is wrong."""
    features = dict.fromkeys(f for report in reports.values() for row in report["cases"] for f in row["features"])
    levels = {
        feature: {row["level"] for report in reports.values() for row in report["cases"] if feature in row["features"]}
        for feature in features
    }
    return [
        {"feature": feature,
         "cells": [_cell(name, report, feature, rows, levels[feature]) for name, report in reports.items()]}
        for feature in features
    ]  # fmt: skip


def _cell(name: str, report: dict, feature: str, rows: list[dict], levels: set[str]) -> dict:
    mine = [row for row in report["cases"] if feature in row["features"]]
    count = Counter(row["verdict"] for row in mine)
    failed = count[WRONG] or any(row["failed"] for row in mine)
    state = "failed" if failed else "passed" if count[RIGHT] and not (count[INACCURATE] or count[REFUSED]) else ""
    absent = NOT_RUN if levels.intersection(report["levels"]) else NO_METHOD
    bad = [row for row in rows if row["name"] == name and feature in row["features"].split(", ")]
    bad = sorted((row for row in bad if row["verdict"] in (WRONG, REFUSED)), key=_preference)
    return {"label": report["solver"]["label"], "text": report["features"].get(feature, absent), "state": state,
            "script": bad[0]["script"] if bad else "", "anchor": bad[0]["anchor"] if bad else ""}  # fmt: skip


def _preference(row: dict) -> tuple:
    """Sort first what has a script, then everyday cases, then those of fewest features."""
    return (not row["script"], row["verdict"] != WRONG, row["group"] != "everyday", row["features"].count(","))


def left_out(reports: dict) -> dict[str, list[str]]:
    """Return code -> ids of the levels that it was asked that were not run for it, but for another code."""
    every = dict.fromkeys(row["id"] for report in reports.values() for row in report["cases"])
    missing = {name: [i for i in every if i.partition("/")[0] in report["levels"]
                      and i not in {row["id"] for row in report["cases"]}]
               for name, report in reports.items()}  # fmt: skip
    return {name: ids for name, ids in missing.items() if ids}


def _mistake(one: dict) -> str:
    """Return a mistake of a code in words, with the number of cases that it explains."""
    names = " or ".join((one["name"], *one["alike"]))
    what = f" ({one['sentence']})" if one["sentence"] else ""
    return f"{names}{what}: {plural(len(one['cases']), 'case')}, of {one['applicable']} that it changes"


CONFORMANCE = Section(
    id="conformance",
    title="Conformance",
    part="peers",
    needs=("conformance",),
    template="conformance/section.html.j2",
    build=build,
    tests={"conformance": ("suite/conformance/test_conformance_matrix.py",)},
)
