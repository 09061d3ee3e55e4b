"""What a line has left of its strength, other codes beside it at rest, and the files for other programs."""

from __future__ import annotations

from ..page.numbers.formatting import DASH, number, seconds
from ..page.numbers.tables import Table

KN = 1e-3


def margin_table(rows: list[dict], name: str, is_at_rest: bool = False) -> Table | None:
    """Return design tension, strength and utilisation of each line; None where no breaking load is given."""
    if not rows:
        return None
    is_of_cases = "case" in rows[0]
    columns = {"line": "line"} | ({"case": "load case", "basis": "T_max is"} if is_of_cases else {})
    columns |= {"mean": "mean", "dynamic": "T_max - mean", "design": "design tension T_d",
                "strength": "strength S_C", "utilisation": "T_d / S_C"}  # fmt: skip
    kn = lambda value: number(KN * value, 5)
    first = rows[0]
    factors = f"gamma_mean = {first['gamma_mean']:g} and gamma_dyn = {first['gamma_dyn']:g}"
    whose = "of the file, and its author's choice"
    if not first["given"]:
        whose = "for the file gives none: a comparison of forces and no design; give [safety_factors] mean and dynamic"
    share = first["strength"] / first["breaking_load"]
    greatest = "T_max is that of this motion, no extreme of a storm."
    if is_at_rest:
        greatest = "At rest, in still water: T_max is the tension at rest, and no motion takes a part."
    if is_of_cases:
        greatest = (
            "Of each line the load case that leaves least. T_max is the most probable largest tension of the reference "
            "time, by a Weibull fit of the peaks (extreme), or the greatest of the case where that is more."
        )
    note = (
        f"T_d = gamma_mean T_mean + gamma_dyn (T_max - T_mean) and S_C = {number(share)} of the breaking load, the "
        f"combination of DNV-OS-E301; {factors}, {whose}. {greatest} Factors, and what counts as characteristic, are "
        "to be taken from the edition of the standard that applies."
    )
    formats = dict.fromkeys(("mean", "dynamic", "design", "strength"), kn) | {"utilisation": lambda v: number(v, 3)}
    groups = (("", 3 if is_of_cases else 1), ("kN", 4), ("", 1))
    return Table(f"{name}_margin", "Margin", columns, rows, formats, groups, note=note)


def describe_margin(rows: list[dict], is_at_rest: bool = False) -> list[str]:
    """Return a sentence on the line with the greatest utilisation; none where no breaking load is given."""
    if not rows:
        return []
    worst = max(rows, key=lambda row: row["utilisation"])
    state = "within" if worst["utilisation"] <= 1 else "BEYOND"
    where = f" in {worst['case']}" if "case" in worst else ""
    start = "At rest utilisation" if is_at_rest else "Utilisation"
    return [f"{start} at most {number(worst['utilisation'], 3)}, of {worst['line']}{where}: {state} the strength, with "
            f"factors {worst['gamma_mean']:g} and {worst['gamma_dyn']:g}."]  # fmt: skip


def static_peers(report: dict, name: str) -> Table | None:
    """Return the tensions at rest of other codes beside those of this project; None where none is installed."""
    rows = report.get("static_peers") or []
    if not rows:
        return None
    solved = [row for row in rows if row["tension"]]
    columns = {"line": "line", "ours": "this project"} | {row["method"]: row["method"] for row in solved}
    lines = [{"line": line, "ours": rows[0]["ours"][e]} | {row["method"]: row["tension"][e] for row in solved}
             for e, line in enumerate(report["lines"])]  # fmt: skip
    failed = [f"{row['method']}: {row['status'].lower()}, {row['sentence']}" for row in rows if not row["tension"]]
    times = [f"{row['method']} took {seconds(row['seconds'])}, its set-up included" for row in solved]
    smooth = "Both on a seabed without friction. " if rows[0]["smooth"] else ""
    note = smooth + "; ".join([*times, *failed]) + "."
    return Table(f"{name}_static_peers", "Other codes at rest", columns, lines,
                 dict.fromkeys(list(columns)[1:], lambda v: DASH if v is None else number(KN * v, 6)),
                 (("", 1), ("pretension, kN", len(columns) - 1)), note=note)  # fmt: skip


def describe_exports(exports: list[dict] | None) -> list[dict]:
    """Return the files for other programs with their notes as one text."""
    return [row | {"notes": "; ".join(row["notes"])} for row in exports or ()]
