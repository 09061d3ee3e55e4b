"""Published values of reference_data, and scene files made from the published inputs."""

from __future__ import annotations

import csv
import json
import tomllib
from functools import cache
from importlib.resources import files
from pathlib import Path

from .dependencies.ledger import write_atomically

DATA = files("reference_data")
SETS = ("openfast_r_test", "msqs_two_line")


@cache
def read(name: str) -> tuple[dict, list[dict]]:
    """Return (source.toml, rows of data.csv) of a published set; empty where the set is not there."""
    try:
        source = tomllib.loads((DATA / name / "source.toml").read_text(encoding="utf-8"))
        with (DATA / name / "data.csv").open(encoding="utf-8", newline="") as file:
            return source, list(csv.DictReader(file))
    except OSError:
        return {}, []


def values(name: str) -> dict[tuple[str, str], float]:
    """Return (name, quantity) -> value of a set in long form: hb_paper, msqs_paper, oc3_dynamics."""
    return {(row["name"], row["quantity"]): float(row["value"]) for row in read(name)[1]}


def printed_value(quantity: str) -> str:
    """Return a number that the text of the HB paper gives, as it would be written."""
    return f"{values('hb_paper')['statement', quantity]:g}"


def msqs_table2() -> list[dict]:
    """Return Table 2 of MSQS: method, jacobian and globalisation (absent for nested), counts and norms as printed."""
    rows = {}
    for (name, quantity), value in values("msqs_paper").items():
        method, *options = name.split(", ")
        if method in ("nested", "monolithic"):
            row = rows.setdefault(
                name, {"method": method} | dict(zip(("jacobian", "globalisation"), options, strict=False))
            )
            whole = quantity.endswith(("iterations", "operations"))
            row[quantity.replace(" ", "_")] = int(value) if whole else value
    return list(rows.values())


def hb_table2(case: str, method: str) -> float | None:
    """Return seconds that HB Table 2 prints for case_1 to case_4; None for what it does not have."""
    return values("hb_paper").get((case.replace("_", " "), method))


def independent(name: str) -> dict[str, float]:
    """Return quantity -> fairlead tension, kN, of a set of oc3_dynamics, by programs independent of this project."""
    return {quantity: value for (program, quantity), value in values("oc3_dynamics").items() if program == name}


def other_times(name: str) -> dict[str, float]:
    """Return code or quantity -> time of a set of other_codes, in the unit of its rows; none for a bound."""
    rows = read("other_codes")[1]
    return {row["quantity"]: float(row["value"]) for row in rows if row["name"] == name and not row["bound"]}


def write_scenes(folder: Path) -> list[Path]:
    """Write one scene file per published line, from its printed inputs; return the paths."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = []
    for name in SETS:
        source, rows = read(name)
        for row in rows:
            path = folder / f"{name}-{row['name']}.toml"
            text = _scene(name, source, row)
            if not path.exists() or path.read_text(encoding="utf-8") != text:
                write_atomically(path, text)
            paths.append(path)
    return paths


def _scene(name: str, source: dict, row: dict) -> str:
    write = {"openfast_r_test": _openfast, "msqs_two_line": _msqs}[name]
    environment, line, ends = write(source, row)
    tables = {"environment": environment, "line": line, "ends": ends}
    lines = [f"name = {json.dumps(row['name'] + ' of ' + name)}", f"description = {json.dumps(source['title'])}"]
    for table, values in tables.items():
        lines += ["", f"[{table}]", *(f"{key} = {value}" for key, value in values.items())]
    return "\n".join(lines) + "\n"


def _point(row: dict, end: str) -> list[float]:
    return [float(row.get(f"{axis}_{end}") or 0) for axis in "xyz"]


def _openfast(source, row):
    anchor, fairlead = _point(row, "anchor"), _point(row, "fairlead")
    environment = {"rho": float(row["rho"]), "g": float(row["g"]), "depth": -anchor[2]}
    pi = source["inferred"]["pi_in_code"]  # the digits of the code that printed the values; they show in its last ones
    buoyancy = float(row["rho"]) * pi * float(row["diameter"]) ** 2 / 4
    weight = float(row["g"]) * (float(row["mass_density"]) - buoyancy)
    line = {"length": float(row["L"]), "EA": float(row["EA"]), "submerged_weight": weight,
            "friction": float(row["friction"])}  # fmt: skip
    return environment, line, {"anchor": anchor, "fairlead": fairlead}


def _msqs(source, row):
    line = {"length": float(row["L"]), "EA": 1e3 * float(row["EA_kN"]), "submerged_weight": source["inferred"]["w"]}
    return {}, line, {"anchor": _point(row, "anchor"), "fairlead": _point(row, "fairlead")}
