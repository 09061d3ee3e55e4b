"""The section on networks of lines: its verdicts, tables, figures and paragraphs from networks.json."""

from __future__ import annotations

from pathlib import Path

from ..evidence import published
from ..page.formatting import TIMES, number, seconds
from ..page.tables import Table, short
from ..page.verdicts import Verdict
from . import figures as network_figures
from . import paragraphs as network_words
from . import pictures as network_pictures
from .paragraphs import PRINTED_WEIGHT, WANTED_GROWTH, WANTED_METHODS, WANTED_PEER, WANTED_SECONDS

STARTS = ("printed", "sound")
"""Starts of Table 2; without any start all settings go through one robust start, so a sentence tells it."""

METHOD = ("method", "jacobian", "globalisation")
WORDS = {"finite-difference": "differences", "trust-region": "trust region", "line-search": "line search"}
COUNTS = {"iterations": "iter­ations", "inner_iterations": "inner", "operations": "oper­ations",
          "residual_norm": "residual"}  # fmt: skip
MEASURED = {"iterations": "iter­ations", "inner_iterations": "inner", "function_evaluations": "evalu­ations",
            "operations": "oper­ations", "residual_norm": "residual", "ms": "ms"}  # fmt: skip
SYSTEMS = {"oc3_three_lines": "three lines of a spar", "three_bridles": "three lines with bridles"}


def section(data: dict | None, looks: dict, figure_folder: Path, table_folder: Path) -> dict | None:
    """All that the page shows about networks, of the parts that were measured; None without a result file."""
    if not data:
        return None
    pictures, table2, work, speed, peers = (
        data.get(part) or [] for part in ("pictures", "table2", "work", "speed", "peers")
    )
    tables = {start: _table2(table2, published.msqs_table2(), start) for start in STARTS if table2}
    made = {
        "units": _units(table2) if table2 else None,
        "settings": _settings(table2) if table2 else None,
        "work_table": _work(work) if work else None,
        "speed": _speed(speed) if speed else None,
        "peers": _peers(peers) if peers else None,
    }
    for table in filter(None, (*tables.values(), *made.values())):
        table.write(table_folder)
    growth = data.get("growth")
    return made | {
        "table2": tables,
        "verdicts": verdicts(speed, peers, growth),
        "pictures": network_pictures.pictures(pictures, figure_folder) if pictures else None,
        "reproduction": network_words.reproduction(table2, published.msqs_table2()) if table2 else [],
        "work": network_figures.work(work, figure_folder) if work else None,
        "speed_words": network_words.speed(speed) if speed else "",
        "gain": network_figures.gain(speed, figure_folder) if speed else None,
        "peer_words": network_words.peers(peers, SYSTEMS) if peers else "",
        "growth": network_figures.growth(growth, figure_folder) if growth else None,
    }


# ---------------------------------------------------------------- verdicts
def verdicts(speed: list[dict], peers: list[dict], growth: dict | None) -> list[Verdict]:
    """For the strip at the top of the page; of each ratio the least counts."""
    lines = [row["ratio"] for row in speed if row["system"].startswith("two lines")]
    bridles = [row["ratio"] for row in peers if row["system"] == "three_bridles"]
    found = []
    if lines:
        text = f"over monolithic analytic, two lines, wanted at least {WANTED_METHODS}"
        found.append(_ratio(min(lines), "time of nested with differences", text, WANTED_METHODS))
    if bridles:
        text = f"over this project, nine lines after an offset, wanted at least {WANTED_PEER}"
        found.append(_ratio(min(bridles), "time of MoorPy on a network", text, WANTED_PEER))
    if growth:
        found += _growth(growth)
    return found


def _ratio(value: float, label: str, detail: str, bound: float) -> Verdict:
    return Verdict(f"{number(value)} {TIMES}", label, detail, value >= bound, "networks")


def _growth(growth: dict):
    largest = [row for row in growth["rows"] if row["elements"] >= network_words.LARGE]
    if largest:
        slowest = max(largest, key=lambda row: row["seconds"])
        good = slowest["seconds"] <= WANTED_SECONDS and all(row["status"] == "SUCCESS" for row in largest)
        text = f"the slowest of chain, net and tree of 10 000, wanted at most {WANTED_SECONDS} s"
        label = f"for a {slowest['family']} of {number(slowest['elements'])} lines"
        yield Verdict(seconds(slowest["seconds"]), label, text, good, "networks")
    p = growth["exponents"]["chain"]
    if p is not None:
        text = f"the number of lines raised to it gives the time of a chain, wanted at most {WANTED_GROWTH}"
        yield Verdict(number(p), "power of growth", text, p <= WANTED_GROWTH, "networks")


# ---------------------------------------------------------------- Table 2
def printed_row(row: dict, printed: list[dict]) -> dict:
    """What the paper prints for the same method; {} where it has no such row."""
    if row["method"] == "nested" and row["jacobian"] != "finite-difference":
        return {}  # the paper proposes it and gives no figures
    return next((p for p in printed if all(p.get(key) in (None, row[key]) for key in METHOD)), {})


def status(value: str) -> str:
    """NOT_CONVERGED: not converged."""
    return {"SUCCESS": "solved"}.get(value, value.lower().replace("_", " "))


def method(row: dict) -> str:
    """ "monolithic, differences, trust region"."""
    return ", ".join(WORDS.get(row[key], row[key]) for key in METHOD if row[key])


def _table2(rows: list[dict], printed: list[dict], start: str) -> Table:
    """One row per method from one start, forces in kN: what is printed, and what is measured at each weight."""
    weights, shown = dict.fromkeys(row["weight"] for row in rows), {}
    for row in network_words.in_paper_units(rows):
        if row["start"] == start:
            entry = shown.setdefault(method(row), {"label": method(row)})
            entry |= {f"printed_{key}": printed_row(row, printed).get(key) for key in COUNTS}
            failed = {} if row["status"] == "SUCCESS" else {"iterations": "failed", "residual_norm": None}
            entry |= {f"{row['weight']:g}_{key}": (row | {"ms": _ms(row)} | failed)[key] for key in MEASURED}
    columns = {"label": "method"} | {f"printed_{key}": heading for key, heading in COUNTS.items()}
    columns |= {f"{w:g}_{key}": heading for w in weights for key, heading in MEASURED.items()}
    groups = [("", 1), ("printed", len(COUNTS))]
    groups += [(f"{w:g} N/m{' (as printed)' if w == PRINTED_WEIGHT else ''}", len(MEASURED)) for w in weights]
    formats = {key: short for key in columns if key.endswith(("residual_norm", "_ms"))}
    formats |= {key: _whole for key in columns if key.endswith("operations")}
    title = f"Table 2 remade, forces in kN, from the {start} start"
    return Table(f"networks_table2_{start}", title, columns, list(shown.values()), formats, tuple(groups))


def _ms(row: dict) -> float | None:
    return None if row["seconds"] is None else 1e3 * row["seconds"]


def _whole(value) -> str:
    return number(None if value is None else round(value))


def _units(rows: list[dict]) -> Table:
    """One row per unit of force: condition numbers, and how many settings succeed from each start."""
    monolithic = [row for row in rows if row["units"]]
    shown = []
    for units in dict.fromkeys(row["units"] for row in monolithic):
        mine = [row for row in monolithic if row["units"] == units]
        entry = {"units": units}
        for row in mine:
            entry[f"{row['weight']:g}_condition"] = row["condition_number"]
        for w, start in dict.fromkeys((row["weight"], row["start"]) for row in mine):
            group = [row for row in mine if (row["weight"], row["start"]) == (w, start)]
            entry[f"{w:g}_{start}"] = f"{len(network_words.solved(group))} of {len(group)}"
        shown.append(entry)
    each = {"printed": "printed start", "sound": "sound start", "none": "no start", "condition": "condition number"}
    weights = dict.fromkeys(row["weight"] for row in rows)
    columns = {"units": "units of force"} | {f"{w:g}_{key}": heading for w in weights for key, heading in each.items()}
    groups = (("", 1), *((f"{w:g} N/m: settings solved from", len(each)) for w in weights))
    formats = {f"{w:g}_condition": short for w in weights}
    return Table("networks_units", "Units of force", columns, shown, formats, groups)


def _settings(rows: list[dict]) -> Table:
    """Every setting by itself."""
    columns = {"weight": "w, N/m", "start": "start", "label": "method", "units": "units", **MEASURED,
               "condition_number": "condition", "error": "error of H", "status": "status"}  # fmt: skip
    shown = [row | {"label": method(row), "ms": _ms(row)} for row in rows]
    formats = dict.fromkeys(("residual_norm", "error", "condition_number", "ms"), short)
    formats |= {"operations": _whole, "status": status, "weight": "{:g}".format}
    return Table("networks_settings", "Every setting", columns, shown, formats, (("", len(columns)),))


# ---------------------------------------------------------------- the other tables
def _work(rows: list[dict]) -> Table:
    """The points of the figure of error against time."""
    columns = {key: key for key in ("case", "label", "tolerance", "seconds", "error", "verdict", "message")}
    return Table("networks_work", "Error against run time, networks", columns, rows)


def _speed(rows: list[dict]) -> Table:
    """Nested with differences beside monolithic analytic."""
    names = ("monolithic", "nested_differences")
    shown = []
    for row in rows:
        least, most = row["ratio_spread"]
        shown.append(row | {f"{name}_ms": 1e3 * row[f"{name}_seconds"] for name in names})
        shown[-1] |= {f"{name}_iterations": "failed" for name in names if row[f"{name}_status"] != "SUCCESS"}
        shown[-1] |= {"least": least, "most": most}
    each = {"ms": "ms", "iterations": "iter­ations", "evaluations": "evalu­ations", "residual_norm": "residual"}
    columns = {"system": "system"} | {f"{name}_{key}": heading for name in names for key, heading in each.items()}
    columns |= {"ratio": "median", "least": "low", "most": "high"}
    groups = (("", 1), ("monolithic, analytic", len(each)), ("nested, differences", len(each)), ("ratio of times", 3))
    formats = dict.fromkeys(("ratio", "least", "most"), short)
    formats |= {f"{name}_{key}": short for name in names for key in ("residual_norm", "ms")}
    return Table("networks_speed", "Methods side by side", columns, shown, formats, groups)


def _peers(rows: list[dict]) -> Table:
    """MoorPy on the same systems."""
    shown = []
    for row in rows:
        least, most = row["ratio_spread"]
        times = {"our_ms": 1e3 * row["our_seconds"], "peer_ms": 1e3 * row["peer_seconds"]}
        shown.append(row | times | {"name": SYSTEMS.get(row["system"], row["system"]), "least": least, "most": most})
    ours = {"our_ms": "ms", "our_iterations": "iter­ations", "our_residual_norm": "residual"}
    theirs = {"tolerance": "toler­ance, m", "peer_ms": "ms", "peer_residual_norm": "residual",
              "peer_tension_difference": "tensions differ by"}  # fmt: skip
    ratios = {"ratio": "out", "least": "low", "most": "high", "ratio_back": "back"}
    columns = {"name": "system", "elements": "lines"} | ours | theirs | ratios
    groups = (("", 2), ("this project", len(ours)), ("MoorPy", len(theirs)), ("ratio of times", len(ratios)))
    formats = dict.fromkeys((*ours, *theirs, *ratios), short) | {
        "our_iterations": number,
        "tolerance": lambda value: number(value, 1),
    }
    return Table("networks_peers", "Networks beside MoorPy", columns, shown, formats, groups)
