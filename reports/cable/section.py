"""The section on the moving cable in time: what the page shows of dynamics.json."""

from __future__ import annotations

from statistics import median

from ..page.figures import FigureWithTable
from ..page.numbers.formatting import number, seconds, times, two_digits
from ..page.section import Content, Inputs, Section, show_parts
from ..pipeline.published import other_times, printed_value, read
from . import figures
from .tables import to_long_form, write_table
from .verdicts import THREE_PERIODS, verdicts


def build(inputs: Inputs) -> Content:
    """Return figures and tables of every part that was measured, and the verdicts on them."""
    data = inputs.results["dynamics"]
    if not data:
        return Content({"dynamics": None})
    shown = show_parts(PARTS, data, inputs)
    frequency = read("hb_paper")[0]["cases"]["case 1"]["Y"][1]
    return Content({"dynamics": shown, "frequency": frequency}, list(verdicts(data)))


def _profile(data, folder, tables) -> FigureWithTable:
    rows = to_long_form(data["nodes"], of="node") + to_long_form(data["catenary"], of="catenary")
    return FigureWithTable(figures.profile(data, folder), write_table(tables, "profile", "Static profile", rows))


def _settling(rows, folder, tables) -> FigureWithTable:
    points = [
        point
        for row in rows
        for point in to_long_form({"time": row["time"], "tension": row["tension"]}, drag=row["drag"])
    ]
    return FigureWithTable(figures.settling(rows, folder), write_table(tables, "settling", "Tension from rest", points))


def _spacetime(rows, folder, tables) -> FigureWithTable:
    points = [
        {"case": row["case"], "s": s, "time": t, "tension": value}
        for row in rows
        for s, values in zip(row["s"], row["tension"], strict=True)
        for t, value in zip(row["time"], values, strict=True)
    ]
    return FigureWithTable(
        figures.spacetime(rows, folder), write_table(tables, "spacetime", "Tension in space and time", points)
    )


ORDER_TABLES = {
    "statics": ("Statics in the cell", {"cells": "cells", "ds": "ds, m"}, figures.STATIC),
    "cell": ("Dynamics in the cell", {"cells": "cells", "ds": "ds, m"}, figures.CELL),
    "step": ("Time domain in the step", {"steps": "steps in a period", "dt": "dt, s"}, figures.STEP),
}


def _orders(data, folder, tables) -> dict:
    orders = {"figures": figures.orders(data, folder), "tables": []}
    for name, (title, given, measured) in ORDER_TABLES.items():
        rows = [dict(row) for row in data[name]["rows"]]
        for key in measured:
            for row, order in zip(rows[1:], data[name]["orders"][key], strict=True):
                row[f"{key}_order"] = order
        columns = dict(given)
        for key in measured:
            columns |= {key: "error", f"{key}_order": "order"}
        groups = (("", len(given)), *((label, 2) for label in measured.values()))
        formats = dict.fromkeys(measured, two_digits) | {f"{key}_order": _order for key in measured}
        orders["tables"].append(
            write_table(tables, f"orders_{name}", title, rows, columns, formats=formats, groups=groups)
        )
    return orders


def _order(value) -> str:
    return number(value, 4)


def _drift(rows, folder, tables) -> FigureWithTable:
    points = [
        point
        for row in rows
        for point in to_long_form(
            {"period": row["period"], "drift": row["drift"]}, case=row["case"], hold=row["hold"] or "free"
        )
    ]
    return FigureWithTable(figures.drift(rows, folder), write_table(tables, "drift", "Drift", points))


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
    formats = {"least": seconds, "median": seconds, "ratio": two_digits}
    printed = other_times("OpenMOOR")["three periods"]
    text = (
        f"Three periods on {printed_value('nodes')} nodes with dt = {printed_value('time step')} s take "
        f"{seconds(min(base))} ({data['steps']} steps, {data['iterations']} Newton iterations, "
        f"{data['factorisations']} factorisations); wanted was at most {seconds(THREE_PERIODS)}, and the C++ program "
        f"of the paper's authors took {seconds(printed)} on another day. In six fields the same case takes "
        f"{times(rows[1]['ratio'])} as long and its tension differs by {number(data['fields_difference'], 1)}."
    )
    return {
        "text": text,
        "table": write_table(tables, "speed", "Three periods, in alternating runs", rows, columns, formats=formats),
    }


def _growth_time(data, folder, tables) -> FigureWithTable:
    table = write_table(tables, "growth_time", "Time stepping, growth with nodes", data["rows"])
    return FigureWithTable(figures.growth(data, folder), table)


PARTS = {
    "profile": _profile,
    "orders": _orders,
    "settling": _settling,
    "spacetime": _spacetime,
    "drift": _drift,
    "speed": _speed,
    "growth": _growth_time,
}
"""Part of dynamics.json -> what the template takes of it."""

DYNAMICS = Section(
    id="dynamics",
    title="Moving cable in time",
    part="error-for-time",
    page="cable",
    needs=("dynamics",),
    template="cable/section.html.j2",
    build=build,
    tests={
        "dynamics": (
            "cable/test_exact.py::test_the_vector_form_gives_the_rows_of_the_paper",
            "time_domain/test_solve.py::test_the_converged_line_meets_the_reference",
            "time_domain/test_solve.py::test_frequencies_of_the_oc3_line_in_water",
            "cable/test_jacobian.py",
        ),
        "rest": (
            "cable/test_statics.py::test_box_scheme_converges_to_the_catenary",
            "cable/test_statics.py::test_shooting_agrees_with_the_truth",
        ),
        "orders": (
            "cable/test_order.py::test_order_in_ds",
            "cable/test_order.py::test_order_in_dt",
            "cable/test_order.py::test_order_in_ds_and_dt_together",
            "cable/test_order.py::test_planted_orders_are_found",
        ),
        "settling": ("time_domain/test_solve.py::test_the_motion_becomes_periodic",),
        "drift": ("time_domain/test_solve.py::test_the_fairlead_stays_where_it_is_prescribed",),
    },
)
