"""The tables on networks of lines, from networks.json."""

from __future__ import annotations

from ..page.numbers.formatting import number, status_words, two_digits
from ..page.numbers.tables import Table
from .paragraphs import PRINTED_WEIGHT, in_paper_units, solved

METHOD = ("method", "jacobian", "globalisation")
WORDS = {"finite-difference": "differences", "trust-region": "trust region", "line-search": "line search"}
COUNTS = {"iterations": "iter­ations", "inner_iterations": "inner", "operations": "oper­ations",
          "residual_norm": "residual"}  # fmt: skip
MEASURED = {"iterations": "iter­ations", "inner_iterations": "inner", "function_evaluations": "evalu­ations",
            "operations": "oper­ations", "residual_norm": "residual", "ms": "ms"}  # fmt: skip
SYSTEMS = {"oc3_three_lines": "three lines of a spar", "three_bridles": "three lines with bridles"}


def _printed_row(row: dict, printed: list[dict]) -> dict:
    """Return what the paper prints for the same method; {} where it has no such row."""
    if row["method"] == "nested" and row["jacobian"] != "finite-difference":
        return {}  # the paper proposes it and gives no figures
    return next((p for p in printed if all(p.get(key) in (None, row[key]) for key in METHOD)), {})


def describe_method(row: dict) -> str:
    """Return such as "monolithic, differences, trust region"."""
    return ", ".join(WORDS.get(row[key], row[key]) for key in METHOD if row[key])


def remade_table2(rows: list[dict], printed: list[dict], start: str) -> Table:
    """Return one row per method from one start, forces in kN: what is printed, and what is measured at each weight."""
    weights, entries = dict.fromkeys(row["weight"] for row in rows), {}
    for row in in_paper_units(rows):
        if row["start"] == start:
            entry = entries.setdefault(describe_method(row), {"label": describe_method(row)})
            entry |= {f"printed_{key}": _printed_row(row, printed).get(key) for key in COUNTS}
            failed = {} if row["status"] == "SUCCESS" else {"iterations": "failed", "residual_norm": None}
            entry |= {f"{row['weight']:g}_{key}": (row | {"ms": _ms(row)} | failed)[key] for key in MEASURED}
    columns = {"label": "method"} | {f"printed_{key}": heading for key, heading in COUNTS.items()}
    columns |= {f"{w:g}_{key}": heading for w in weights for key, heading in MEASURED.items()}
    groups = [("", 1), ("printed", len(COUNTS))]
    groups += [(f"{w:g} N/m{' (as printed)' if w == PRINTED_WEIGHT else ''}", len(MEASURED)) for w in weights]
    formats = {key: two_digits for key in columns if key.endswith(("residual_norm", "_ms"))}
    formats |= {key: _whole for key in columns if key.endswith("operations")}
    title = f"Table 2 remade, forces in kN, from the {start} start"
    return Table(f"networks_table2_{start}", title, columns, list(entries.values()), formats, tuple(groups))


def _ms(row: dict) -> float | None:
    return None if row["seconds"] is None else 1e3 * row["seconds"]


def _whole(value) -> str:
    return number(None if value is None else round(value))


def unit_table(rows: list[dict]) -> Table:
    """Return one row per unit of force: condition numbers, and how many settings succeed from each start."""
    monolithic = [row for row in rows if row["units"]]
    entries = []
    for units in dict.fromkeys(row["units"] for row in monolithic):
        mine = [row for row in monolithic if row["units"] == units]
        entry = {"units": units}
        for row in mine:
            entry[f"{row['weight']:g}_condition"] = row["condition_number"]
        for w, start in dict.fromkeys((row["weight"], row["start"]) for row in mine):
            group = [row for row in mine if (row["weight"], row["start"]) == (w, start)]
            entry[f"{w:g}_{start}"] = f"{len(solved(group))} of {len(group)}"
        entries.append(entry)
    each = {"printed": "printed start", "sound": "sound start", "none": "no start", "condition": "condition number"}
    weights = dict.fromkeys(row["weight"] for row in rows)
    columns = {"units": "units of force"} | {f"{w:g}_{key}": heading for w in weights for key, heading in each.items()}
    groups = (("", 1), *((f"{w:g} N/m: settings solved from", len(each)) for w in weights))
    formats = {f"{w:g}_condition": two_digits for w in weights}
    return Table("networks_units", "Units of force", columns, entries, formats, groups)


def setting_table(rows: list[dict]) -> Table:
    """Return every setting by itself."""
    columns = {"weight": "w, N/m", "start": "start", "label": "method", "units": "units", **MEASURED,
               "condition_number": "condition", "error": "error of H", "status": "status"}  # fmt: skip
    entries = [row | {"label": describe_method(row), "ms": _ms(row)} for row in rows]
    formats = dict.fromkeys(("residual_norm", "error", "condition_number", "ms"), two_digits)
    formats |= {"operations": _whole, "status": status_words, "weight": "{:g}".format}
    return Table("networks_settings", "Every setting", columns, entries, formats, (("", len(columns)),))


def work_table(rows: list[dict]) -> Table:
    """Return the points of the figure of error against time."""
    columns = {key: key for key in ("case", "label", "tolerance", "seconds", "error", "lines", "iterations",
                                     "evaluations", "catenary_evaluations", "verdict", "message")}  # fmt: skip
    return Table("networks_work", "Error against run time, networks", columns, rows)


def speed_table(rows: list[dict]) -> Table:
    """Return nested with differences beside monolithic analytic."""
    names = ("monolithic", "nested_differences")
    entries = []
    for row in rows:
        least, most = row["ratio_spread"]
        entries.append(row | {f"{name}_ms": 1e3 * row[f"{name}_seconds"] for name in names})
        entries[-1] |= {f"{name}_iterations": "failed" for name in names if row[f"{name}_status"] != "SUCCESS"}
        entries[-1] |= {"least": least, "most": most}
    each = {"ms": "ms", "iterations": "iter­ations", "evaluations": "evalu­ations", "residual_norm": "residual"}
    columns = {"system": "system"} | {f"{name}_{key}": heading for name in names for key, heading in each.items()}
    columns |= {"ratio": "median", "least": "low", "most": "high"}
    groups = (("", 1), ("monolithic, analytic", len(each)), ("nested, differences", len(each)), ("ratio of times", 3))
    formats = dict.fromkeys(("ratio", "least", "most"), two_digits)
    formats |= {f"{name}_{key}": two_digits for name in names for key in ("residual_norm", "ms")}
    return Table("networks_speed", "Methods side by side", columns, entries, formats, groups)


def peer_table(rows: list[dict]) -> Table:
    """Return MoorPy on the same systems."""
    entries = []
    for row in rows:
        least, most = row["ratio_spread"]
        times = {"our_ms": 1e3 * row["our_seconds"], "peer_ms": 1e3 * row["peer_seconds"]}
        entries.append(row | times | {"name": SYSTEMS.get(row["system"], row["system"]), "least": least, "most": most})
    ours = {"our_ms": "ms", "our_iterations": "iter­ations", "our_residual_norm": "residual"}
    theirs = {"tolerance": "toler­ance, m", "peer_ms": "ms", "peer_residual_norm": "residual",
              "peer_tension_difference": "tensions differ by"}  # fmt: skip
    ratios = {"ratio": "out", "least": "low", "most": "high", "ratio_back": "back"}
    columns = {"name": "system", "elements": "lines"} | ours | theirs | ratios
    groups = (("", 2), ("this project", len(ours)), ("MoorPy", len(theirs)), ("ratio of times", len(ratios)))
    formats = dict.fromkeys((*ours, *theirs, *ratios), two_digits) | {
        "our_iterations": number,
        "tolerance": lambda value: number(value, 1),
    }
    return Table("networks_peers", "Networks compared with MoorPy", columns, entries, formats, groups)
