"""The tables of one scene: forces, stiffness, sensitivity, expected error and cost."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

from ..drawing.axes import KN
from ..page.numbers import analysis
from ..page.numbers.formatting import DASH, number, seconds, two_digits
from ..page.numbers.tables import Table

FORCES = {
    "label": "line", "regime": "state", "tension": "T, kN", "H": "H, kN", "V": "V, kN", "angle_deg": "angle, °",
    "H_anchor": "H anchor, kN", "V_anchor": "V anchor, kN", "grounded_length": "on seabed, m",
}  # fmt: skip
ACCURACY = {
    "label": "line", "condition": "condition number", "limit": "unavoidable rounding error",
    "error": "error against 50 digits",
    "in_limits": "error / rounding error", "cost": "cost, this project",
}  # fmt: skip
NOTES = {
    "forces": "H and V are the components of the tension T; the angle is that of the line at the fairlead from the "
    "horizontal. At the anchor a positive V pulls it upwards; V is negative there where the line sags below the "
    "anchor. Forces are kN here and N in the files.",
    "stiffness": "Change of the fairlead force per metre that the fairlead moves. A dash stands for an unbounded "
    "value. It is kN/m here and N/m in the files.",
    "sensitivity": "How far an uncertain length L, stiffness EA or weight w moves the tension: size of the change, to "
    "first order.",
    "expected_error": "The unavoidable rounding error is the relative error that rounding the inputs alone causes; the "
    "error is that of this project at its default setting; the cost is that of its cheapest setting within the "
    "tolerance of the scene.",
    "solvers": "The error is that of the fairlead force over the tension, against 50 digits.",
}
"""What the columns of each table mean."""
STIFFNESS = dict.fromkeys(("K11", "K12", "K21", "K22"), lambda v: number(v if v is None else KN * v, 6))


def _kN(value) -> str:
    return number(value if value is None else KN * value, 7)


def _seven_digits(value) -> str:
    return number(value, 7)


def _percent(value) -> str:
    return DASH if value is None else f"{number(value)} %"


def scene_tables(scene: dict, stem: str, folder: Path) -> list[Table]:
    """Write and return the tables of forces, stiffness, sensitivity, expected error and solvers of a scene's lines."""
    lines = [line | {"angle_deg": math.degrees(line["angle"])} for line in scene["lines"]]
    formats = dict.fromkeys(("tension", "H", "V", "H_anchor", "V_anchor"), _kN) | {"grounded_length": _seven_digits}
    forces = Table(f"scene_{stem}_forces", "Forces at the fairlead and at the anchor", FORCES, lines, formats)
    rows = [
        {"label": line["label"], **{f"K{i + 1}{j + 1}": line["stiffness"][i][j] for i in (0, 1) for j in (0, 1)}}
        for line in lines
    ]
    heads = {"label": "line", "K11": "dH/dx, kN/m", "K12": "dH/dz, kN/m", "K21": "dV/dx, kN/m", "K22": "dV/dz, kN/m"}
    stiffness = Table(f"scene_{stem}_stiffness", "Stiffness of the fairlead, anchor fixed", heads, rows, STIFFNESS)
    heads = {"label": "line"} | {key: f"per 1 % of {key}" for key in scene["lines"][0]["sensitivity"]}
    rows = [{"label": line["label"], **line["sensitivity"]} for line in lines]
    percent = dict.fromkeys(scene["lines"][0]["sensitivity"], _percent)
    changes = Table(f"scene_{stem}_sensitivity", "Change of the fairlead tension", heads, rows, percent)
    tables = (forces, stiffness, changes, _expected(lines, scene, stem), _solvers(lines, stem))
    return [replace(table, note=note).write(folder) for table, note in zip(tables, NOTES.values(), strict=True)]


def _solvers(lines, stem) -> Table:
    """Return every solver on every line, at its default setting."""
    rows = [point | {"line": line["label"], "answer": point["verdict"].replace("unsupported", "not modelled")}
            for line in lines for point in line["ladder"] if point["tolerance"] is None]  # fmt: skip
    heads = {"line": "line", "label": "solver", "answer": "answer", "error": "error", "seconds": "run time",
             "message": "why not"}  # fmt: skip
    formats = {"error": two_digits, "seconds": seconds}
    return Table(f"scene_{stem}_solvers", "Every solver at its default setting", heads, rows, formats)


def _expected(lines, scene, stem) -> Table:
    """Return the unavoidable and the actual error, and the cost of the cheapest setting within the tolerance."""
    rows = []
    for line in lines:
        best = analysis.find_cheapest([p for p in line["ladder"] if p["solver"] == analysis.OURS], scene["tolerance"])
        finite = line["error"] is not None and line["limit"]
        rows.append(
            line | {"in_limits": line["error"] / line["limit"] if finite else None, "cost": best and best["seconds"]}
        )
    return Table(f"scene_{stem}_expected_error", "Expected error and cost", ACCURACY, rows,
                 {"cost": seconds, "limit": two_digits, "error": two_digits, "in_limits": two_digits})  # fmt: skip
