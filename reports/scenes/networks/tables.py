"""The tables of a network file: its lines, the force on the body, stiffness and impedance, settings, statics."""

from __future__ import annotations

from ...page.numbers.formatting import DASH, number, seconds, status_words, two_digits
from ...page.numbers.tables import Table
from ..margins import describe_margin
from .settings import OWN, UNSUPPORTED, find_hidden_errors, mark_best, sentence

KN = 1e-3
COORDINATES = ("surge", "sway", "heave", "roll", "pitch", "yaw")
VANISHING = 1e-9  # of the entries on the diagonal: what rounding leaves where symmetry makes zero

LINES = {
    "line": "line", "pretension": "at rest", "min": "least", "mean": "mean", "max": "greatest", "std": "std. dev.",
    "time_of_max": "greatest at, s", "greatest": "kN", "greatest_s": "at s, m", "anchor_max": "greatest, kN",
    "uplift": "upwards, kN", "uplift_angle": "at, degrees", "grounded_min": "least", "grounded_max": "greatest",
    "slack": "slack",
}  # fmt: skip
ALONG = "greatest along the line", 2
GROUPS = (("", 1), ("tension at the fairlead end, kN", 6), ALONG, ("anchor end", 3), ("on the seabed, m", 2), ("", 1))


def _kn(digits: int = 4):
    return lambda value: number(None if value is None else KN * value, digits)


def lines_of_all(reports: dict[str, dict]) -> Table | None:
    """Return one table of the lines of all networks in motion; None where none moved."""
    parts = [(report["name"], lines(report, stem)) for stem, report in reports.items() if "motion" in report]
    if not parts:
        return None
    rows = [{"network": name if k == 0 else ""} | row for name, table in parts for k, row in enumerate(table.rows)]
    first = parts[0][1]
    columns = {"network": "network"} | {key: head for key, head in LINES.items() if not key.startswith("greatest")}
    groups = (("", 2), *(group for group in GROUPS[1:] if group != ALONG))
    return Table("networks_lines", "Lines of all networks", columns, rows, first.formats, groups, note=first.note)


def lines(report: dict, name: str) -> Table:
    """Return the table of every line in motion."""
    rows = []
    for row in report["motion"]:
        low, high = row["grounded"] or (None, None)
        low, high = (low, high) if high else (None, None)  # never on it
        rows.append(row | {"greatest": row["greatest"]["tension"], "greatest_s": row["greatest"]["s"],
                           "grounded_min": low, "grounded_max": high, "slack": _slack(row["slack"])})  # fmt: skip
    formats = dict.fromkeys(("pretension", "min", "mean", "max", "greatest", "anchor_max"), _kn()) | {
        "std": _kn(3), "uplift": _kn(3), "uplift_angle": two_digits, "time_of_max": number}  # fmt: skip
    note = (
        f"Over {'the last period' if report['period'] else 'the series'}; s is the unstretched length from the anchor "
        "end; upwards: the vertical force on a fixed anchor."
    )
    return Table(f"{name}_lines", "Lines", LINES, rows, formats, GROUPS, note=note)


def _slack(slack: dict) -> str:
    if not slack["share"]:
        return "no"
    return f"from {number(slack['start'])} s, {number(100 * slack['share'], 2)} % of the time"


def statics(report: dict, name: str) -> Table:
    """Return the pretension of every line: exact catenaries, and on meshes."""
    meshes, exact = [m for m in report["statics"]["meshes"] if m["tension"]], report["statics"]["exact"]
    in_current = any(report.get("current") or ())
    columns = {"line": "line", "exact": "still water" if in_current else "exact"}
    columns |= {f"on {m['cells']}": f"{m['cells']} cells" for m in meshes}
    rows = [
        {"line": line, "exact": exact[e]} | {f"on {m['cells']}": m["tension"][e] for m in meshes}
        for e, line in enumerate(report["lines"])
    ]
    groups = (("", 1), ("pretension, kN", 1 + len(meshes)))
    return Table(f"{name}_statics", "Pretension", columns, rows, dict.fromkeys(list(columns)[1:], _kn(6)), groups,
                 note=_static_note(meshes, in_current))  # fmt: skip


def _static_note(meshes, in_current: bool) -> str:
    if in_current:
        still = "Still water: the catenaries of the lines, on a rigid seabed. "
        return still + ("The meshes of the moving lines hang in the current of the file." if meshes else "")
    if not meshes:
        return "Exact: the catenaries of the lines at rest."
    errors = ", ".join(f"{number(m['error'], 2)} on {m['cells']} cells" for m in meshes)
    return (
        "Exact: catenaries on a rigid seabed. On the mesh of the moving lines, whose seabed is elastic, the worst line "
        f"is off by {errors}."
    )


def body(report: dict, name: str) -> Table:
    """Return statistics and harmonics of force and moment on the body."""
    columns = {"component": "", "mean": "mean", "min": "least", "max": "greatest", "std": "std. dev."}
    groups = (("", 1), ("kN and kN m", len(columns) - 1))
    labels = [f"force {axis}, kN" for axis in "xyz"] + [f"moment {axis}, kN m" for axis in "xyz"]
    rows = [row | {"component": label} for row, label in zip(report["body"], labels, strict=True)]
    if report["period"]:
        count = len(report["body"][0]["harmonics"])
        columns |= {f"h{k}": str(k) for k in range(1, count + 1)}
        groups += (("amplitude of harmonic", count),)
        rows = [row | {f"h{k}": value for k, value in enumerate(row["harmonics"], 1)} for row in rows]
    note = "Of the lines on the body, the moment about its moving reference point."
    return Table(f"{name}_body", "Force and moment on the body", columns, rows,
                 dict.fromkeys(list(columns)[1:], _small(rows)), groups, note=note)  # fmt: skip


def _small(rows):
    """Return a format in kN that writes zero for what is only rounding of the largest value of its kind."""
    largest = max(abs(value) for row in rows for value in (row["min"], row["max"]))
    return lambda value: number(0.0 if abs(value) < VANISHING * largest else KN * value, 4)


def matrices(report: dict, name: str) -> list[Table]:
    """Return stiffness, and real and imaginary part of the impedance, of the lines on the body about rest."""
    parts = report.get("impedance") or {}
    if "stiffness" not in parts:
        return []
    tables = [_matrix(f"{name}_stiffness", "Stiffness at rest", parts["stiffness"], "")]
    if parts["frequency"]:
        at = f"at {number(parts['frequency'], 4)} Hz"
        damping = "Damping by the seabed and by a current; drag in still water has none about rest."
        for part, note in (("real", "Stiffness less inertia."), ("imaginary", damping)):
            tables.append(_matrix(f"{name}_impedance_{part}", f"Impedance {at}, {part} part", parts[part], note))
    return tables


def stiffness_at_rest(report: dict, name: str) -> list[Table]:
    """Return the stiffness of exact catenaries of a network that does not move."""
    K = report.get("stiffness_at_rest")
    return [_matrix(f"{name}_stiffness", "Stiffness at rest", K, "About the origin of the file.")] if K else []


def _matrix(name: str, title: str, K, note: str) -> Table:
    columns = {"row": ""} | {c: f"{c}, {'m' if i < 3 else 'rad'}" for i, c in enumerate(COORDINATES)}
    rows, scales = [], [max(abs(K[i][i]) for i in part) for part in (range(3), range(3, 6))]
    for i, (label, values) in enumerate(zip(COORDINATES, K, strict=True)):
        sizes = [(scales[i // 3] * scales[j // 3]) ** 0.5 for j in range(6)]
        values = [0.0 if abs(v) <= VANISHING * size else v for v, size in zip(values, sizes, strict=True)]
        kind = "force, kN" if i < 3 else "moment, kN m"
        rows.append({"row": f"{label}: {kind}"} | dict(zip(COORDINATES, values, strict=True)))
    about = "Rows: what the lines resist with; columns: displacement or rotation of the body."
    return Table(name, title, columns, rows, dict.fromkeys(COORDINATES, _kn()), note=f"{about} {note}".strip())


def settings(report: dict, name: str) -> Table:
    """Return every setting with its error, its run time and how it ended."""
    best, rows = report["recommended"], []
    for row in report["ladder"]:
        other = f"{row['harmonics']} harmonics" if "harmonics" in row else f"dt = {number(row['dt'])} s"
        rows.append({"method": row["method"], "cells": row["cells"], "setting": other, "error": row["error"],
                     "seconds": row["seconds"], "ended": _outcome(row, best)})  # fmt: skip
    columns = {"method": "method", "cells": "cells", "setting": "setting", "error": "error", "seconds": "run time",
               "ended": ""}  # fmt: skip
    error = lambda value: DASH if value is None else number(value, 2)
    note = "Cells are those of the longest line, or of all lines where they follow one another."
    if (known := find_hidden_errors(report)) is not None:
        note += f" The reference is known to {number(known, 2)}: smaller errors are how far a setting is from it."
    return Table(f"{name}_settings", "Settings", columns, rows, {"error": error, "seconds": seconds}, note=note)


def _outcome(row: dict, best: dict | None) -> str:
    if row["status"] in UNSUPPORTED:
        return f"{UNSUPPORTED[row['status']]}: {row['sentence']}"
    if row["status"] != "SUCCESS":
        return status_words(row["status"])
    if row["method"] not in OWN:
        return f"{row['sentence']}{', on a smooth seabed' if row['smooth'] else ''}"
    keys = ("method", "cells", "steps", "harmonics")
    return mark_best(best) if best and all(best.get(key) == row.get(key) for key in keys) else ""


def peers(report: dict, name: str) -> Table | None:
    """Return the extremes of the force on each coupled node by another code and by this project."""
    rows = []
    for row in report["ladder"]:
        for node, extremes in zip(report["coupled"], row.get("nodes") or (), strict=False):
            off = extremes["max"] / extremes["our_max"] - 1
            rows.append({"code": row["method"], "cells": row["cells"], "node": node} | extremes | {"off": 100 * off})
    if not rows:
        return None
    columns = {"code": "code", "cells": "cells", "node": "node", "max": "greatest", "our_max": "here", "min": "least",
               "our_min": "here ", "off": "greatest differs, %"}  # fmt: skip
    smooth = any(row.get("smooth") for row in report["ladder"])
    note = "Force of the lines on each coupled node" + (", both on a seabed without friction." if smooth else ".")
    return Table(f"{name}_peers", "Other codes", columns, rows,
                 dict.fromkeys(("max", "our_max", "min", "our_min"), _kn(5)) | {"off": two_digits},
                 (("", 3), ("kN", 4), ("", 1)), note=note)  # fmt: skip


def as_text(table: Table) -> str:
    """Return a table in letters, its columns aligned, for a terminal."""
    head = list(table.columns.values())
    rows = [head, *([text for text, *_ in row] for row in table.cells())]
    right = [table.is_numeric(key) for key in table.columns]
    widths = [max(len(row[i]) for row in rows) for i in range(len(head))]
    lines = ("  ".join(cell.rjust(w) if r else cell.ljust(w) for cell, w, r in zip(row, widths, right, strict=True))
             for row in rows)  # fmt: skip
    return "\n".join(line.rstrip() for line in lines)


def lines_for_terminal(report: dict) -> Table:
    """Return the table of lines in as few columns as a terminal has room for."""
    full = lines(report, "terminal")
    columns = {key: LINES[key] for key in ("line", "pretension", "min", "mean", "max", "std", "time_of_max")}
    columns |= {"anchor_max": "anchor", "uplift": "upwards", "grounded": "on seabed, m", "slack": "slack"}
    rows = [row | {"grounded": _range(row["grounded_min"], row["grounded_max"])} for row in full.rows]
    return Table("terminal", "", columns, rows, full.formats)


def _range(low, high) -> str:
    return DASH if low is None else f"{number(low)} to {number(high)}"


def sort_warnings(report: dict) -> dict[str, list[str]]:
    """Return what is suspected, what else is to be known of the lines, and notes on the file, each said once."""
    suspected, notes = list(report.get("suspected", ())), list(report.get("notes", ()))
    shown_elsewhere = {*suspected, *notes}
    warnings = [text for text in report["warnings"] if text not in shown_elsewhere]
    return {"suspected": suspected, "warnings": warnings, "notes": notes}


def summarise(report: dict, stem: str) -> str:
    """Return what the terminal shows of a network: its lines, and the setting to use."""
    kept = sort_warnings(report)
    text = [report["name"], *(f"SUSPECTED: {warning}" for warning in kept["suspected"])]
    if "failed" in report:
        text.append(report["failed"])
    if "motion" in report:
        text += ["tensions in kN", as_text(lines_for_terminal(report)), sentence(report)]
    elif report.get("statics"):
        text += ["tensions in kN", as_text(statics(report, stem))]
    text += describe_margin(report.get("margins", []), is_at_rest="motion" not in report)
    text += [f"- {warning}" for warning in kept["warnings"]]
    if kept["notes"]:
        text.append(f"of the file: {'; '.join(note.removesuffix('.') for note in kept['notes'])}.")
    return "\n".join(text)
