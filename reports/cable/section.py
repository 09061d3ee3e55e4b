"""The sections on moving cables: what the page shows of dynamics.json and harmonic_balance.json."""

from __future__ import annotations

from pathlib import Path
from statistics import median

from ..evidence.published import other_times, stated
from ..harmonic_balance import section as dynamics_harmonic
from ..page.formatting import number, seconds, times
from ..page.tables import short
from . import figures
from . import verdicts as dynamics_verdicts
from .tables import Shown, long, written
from .verdicts import THREE_PERIODS


def section(results: dict, figure_folder: Path, table_folder: Path) -> dict:
    """What the template dynamics.html.j2 takes of both result files (name -> content or None), and the verdicts."""
    stepped, balanced = (results.get(name) or {} for name in ("dynamics", "harmonic_balance"))
    return {
        "dynamics": _parts(stepped, figure_folder, table_folder) if stepped else None,
        "harmonic": dynamics_harmonic.parts(balanced, figure_folder, table_folder) if balanced else None,
        "dynamics_verdicts": dynamics_verdicts.strip(stepped, balanced),
    }


def _parts(data: dict, folder: Path, tables: Path) -> dict:
    made = {name: _SHOWN[name](data[name], folder, tables) for name in _SHOWN if data.get(name)}
    return dict.fromkeys(_SHOWN) | made


def _profile(data, folder, tables) -> Shown:
    rows = long(data["nodes"], of="node") + long(data["catenary"], of="catenary")
    return Shown(figures.profile(data, folder), written(tables, "profile", "Static profile", rows))


def _settling(rows, folder, tables) -> Shown:
    points = [
        point for row in rows for point in long({"time": row["time"], "tension": row["tension"]}, drag=row["drag"])
    ]
    return Shown(figures.settling(rows, folder), written(tables, "settling", "Tension from rest", points))


def _spacetime(rows, folder, tables) -> Shown:
    points = [
        {"case": row["case"], "s": s, "time": t, "tension": value}
        for row in rows
        for s, values in zip(row["s"], row["tension"], strict=True)
        for t, value in zip(row["time"], values, strict=True)
    ]
    return Shown(figures.spacetime(rows, folder), written(tables, "spacetime", "Tension in space and time", points))


ORDER_TABLES = {
    "statics": ("Statics in the cell", {"cells": "cells", "ds": "ds, m"}, figures.STATIC),
    "cell": ("Dynamics in the cell", {"cells": "cells", "ds": "ds, m"}, figures.CELL),
    "step": ("Time domain in the step", {"steps": "steps in a period", "dt": "dt, s"}, figures.STEP),
}


def _orders(data, folder, tables) -> dict:
    made = {"figures": figures.orders(data, folder), "tables": []}
    for name, (title, given, measured) in ORDER_TABLES.items():
        rows = [dict(row) for row in data[name]["rows"]]
        for key in measured:
            for row, order in zip(rows[1:], data[name]["orders"][key], strict=True):
                row[f"{key}_order"] = order
        columns = dict(given)
        for key in measured:
            columns |= {key: "error", f"{key}_order": "order"}
        groups = (("", len(given)), *((label, 2) for label in measured.values()))
        formats = dict.fromkeys(measured, short) | {f"{key}_order": _order for key in measured}
        made["tables"].append(written(tables, f"orders_{name}", title, rows, columns, formats=formats, groups=groups))
    return made


def _order(value) -> str:
    return number(value, 4)


def _drift(rows, folder, tables) -> Shown:
    points = [
        point
        for row in rows
        for point in long(
            {"period": row["period"], "drift": row["drift"]}, case=row["case"], hold=row["hold"] or "free"
        )
    ]
    return Shown(figures.drift(rows, folder), written(tables, "drift", "Drift", points))


def _speed(data, folder, tables) -> dict:
    names = {"planar": "time domain, four fields", "six fields": "time domain, six fields"}
    base = data["seconds"]["planar"]
    rows = []
    for name, values in data["seconds"].items():
        ratios = [value / one for value, one in zip(values, base, strict=False)]
        row = {"solver": names.get(name, name), "least": min(values), "median": median(values)}
        rows.append(row | {"ratio": median(ratios)})
    columns = {
        "solver": "three periods of case 1",
        "least": "least time",
        "median": "median",
        "ratio": "times the first",
    }
    formats = {"least": seconds, "median": seconds, "ratio": short}
    printed = other_times("OpenMOOR")["three periods"]
    words = (
        f"Three periods on {stated('nodes')} nodes with dt = {stated('time step')} s take {seconds(min(base))} "
        f"({data['steps']} steps, "
        f"{data['iterations']} Newton iterations, {data['factorisations']} factorisations); wanted was at most "
        f"{seconds(THREE_PERIODS)}, and the C++ program of the paper's authors took {seconds(printed)} on another day. "
        f"In six fields the same case takes {times(rows[1]['ratio'])} as long and its tension differs by "
        f"{number(data['fields_difference'], 1)}."
    )
    return {
        "words": words,
        "table": written(tables, "speed", "Three periods, turn and turn about", rows, columns, formats=formats),
    }


def _growth_time(data, folder, tables) -> Shown:
    table = written(tables, "growth_time", "Time stepping, growth with nodes", data["rows"])
    return Shown(figures.growth(data, folder), table)


_SHOWN = {
    "profile": _profile,
    "orders": _orders,
    "settling": _settling,
    "spacetime": _spacetime,
    "drift": _drift,
    "speed": _speed,
    "growth": _growth_time,
}
