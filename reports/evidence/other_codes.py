"""The section on other codes: one row per code and problem, from the results of every problem type."""

from __future__ import annotations

from statistics import median

from ..cable.cases import CASES
from ..harmonic_balance.work_figures import ratios_at_equal_error
from ..page.numbers import analysis, pareto
from ..page.numbers.formatting import plural, python_call, ratio, two_digits
from ..page.numbers.tables import Table
from ..page.section import Content, Inputs, Section

FASTER = "where it is the faster one"


def build(inputs: Inputs) -> Content:
    """Return one row per code and problem, and inputs that reproduce a wrong answer of each code."""
    accuracy, machine = inputs.results["accuracy"], inputs.results["machine"] or {}
    work, networks, harmonic = (inputs.results[name] for name in ("work_precision", "networks", "harmonic_balance"))
    table = code_table(accuracy, work, networks, harmonic, machine.get("versions", {})).write(inputs.tables)
    context = {"table": table, "accuracy": accuracy, "examples": _examples(accuracy) if accuracy else []}
    return Content(context)


def code_table(
    accuracy: dict | None, work: dict | None, networks: dict | None, harmonic: dict | None, versions: dict
) -> Table:
    """Return wrong and refused answers of every code, and its time over that of this project at equal error."""
    rows = [*_lines(accuracy, work), *_networks(networks, versions), *_moving(harmonic)]
    columns = {"code": "code", "problem": "problem", "cases": "cases", "right": "right", "wrong": "wrong",
               "refused": "refused", "unsupported": "not modelled", "median": "median error over rounding error",
               "ratio": "time over this project", "of": "at", "faster": FASTER}  # fmt: skip
    return Table("peers", "Other codes", columns, rows, {"median": two_digits, "ratio": two_digits})


def _examples(accuracy: dict) -> list[dict]:
    """Return counts of every other solver, and inputs that reproduce a wrong answer."""
    return [
        {"name": name, **accuracy["solvers"][name], "rows": [
            row | {"answer": row["answers"][name], "call": python_call(name, row["inputs"])}
            for row in analysis.typical_wrong_answers(accuracy, name)
        ]}
        for name in analysis.sort_solvers(accuracy["solvers"]) if name != analysis.OURS
    ]  # fmt: skip


def _lines(accuracy, work):
    """Yield lines at rest, at the default setting; the time at the smallest error that the code reaches."""
    for name in analysis.sort_solvers((accuracy or {}).get("solvers", ())):
        if name.startswith(analysis.OURS):
            continue
        chosen = accuracy["solvers"][name]
        counts = analysis.summarise([row for row in accuracy["rows"] if row["set"] != "map"], name)
        points = (work or {}).get("points", [])
        factors = [analysis.factor_at_equal_error([p for p in points if p["case"] == case], name)
                   for case in dict.fromkeys(p["case"] for p in points)]  # fmt: skip
        factors = [factor["factor"] for factor in factors if factor]
        faster = [
            front for front in pareto.static_fronts(points) if any(b.label == chosen["label"] for b in front.slower)
        ]
        yield counts | {
            "code": f"{chosen['label']} {chosen['version']}", "problem": "lines at rest",
            "ratio": median(factors) if factors else None,
            "of": f"its smallest error, median of {plural(len(factors), 'case')}" if factors else "",
            "faster": "; ".join(front.case for front in faster) or "nowhere",
        }  # fmt: skip


def _networks(data, versions):
    """Yield warm re-solves compared with MoorPy; then every code at the tightest tolerance that it answers."""
    rows = (data or {}).get("peers") or []
    if rows:
        both = [row[key] for row in rows for key in ("ratio", "ratio_back")]
        slower = [row["system"] for row in rows if max(row["ratio"], row["ratio_back"]) < 1]
        yield {
            "code": f"MoorPy {versions.get('MoorPy') or ''}".strip(), "problem": "networks, moved", "cases": len(rows),
            "ratio": median(both), "of": f"warm re-solves, {ratio(min(both))} to {ratio(max(both))}",
            "faster": "; ".join(dict.fromkeys(slower)).replace("_", " ") or "nowhere",
        }  # fmt: skip
    points = (data or {}).get("work") or []
    for code in dict.fromkeys(p["code"] for p in points if p.get("code")):
        mine = [p for p in points if p.get("code") == code]
        last = {p["case"]: p for p in mine if p["verdict"] in ("right", "wrong")}
        cases = dict.fromkeys(p["case"] for p in mine)
        verdicts = [last.get(case, {"verdict": "refused"})["verdict"] for case in cases]
        verdicts = ["unsupported"] * len(verdicts) if {p["verdict"] for p in mine} == {"unsupported"} else verdicts
        yield {"code": code, "problem": "networks", "cases": len(verdicts)} | {v: verdicts.count(v) for v in
              analysis.VERDICTS}  # fmt: skip


def _moving(data):
    """Yield every code at the errors of its own settings."""
    points = ((data or {}).get("work") or {}).get("points") or []
    for code, method in dict.fromkeys((p["code"], p["method"]) for p in points if p.get("code")):
        mine, ratios = [p for p in points if p["method"] == method], ratios_at_equal_error(points, method)
        faster = [
            front for front in pareto.moving_fronts(points, CASES) if any(b.label == method for b in front.slower)
        ]
        last = {p["case"]: p for p in mine if p["rms"] is not None}
        verdicts = [_verdict(last.get(case)) for case in dict.fromkeys(p["case"] for p in mine)]
        row = {"code": code, "problem": "moving cable", "cases": len(verdicts)}
        row |= {verdict: verdicts.count(verdict) for verdict in analysis.VERDICTS}
        if ratios:
            of = f"the error of each of its {plural(len(ratios), 'best setting')}, {ratio(min(ratios))} to "
            row |= {"ratio": median(ratios), "of": of + ratio(max(ratios)),
                    "faster": "; ".join(front.case for front in faster) or "nowhere"}  # fmt: skip
        yield row


def _verdict(point: dict | None) -> str:
    """Return the verdict on the finest setting of a case; ``point`` is None where there is no tension."""
    return "refused" if point is None else "wrong" if point["error"] > pareto.WRONG_BOUND else "right"


OTHER_CODES = Section(
    id="other-codes",
    title="Other codes",
    part="peers",
    page="codes",
    needs=("accuracy", "work_precision", "networks", "harmonic_balance", "machine"),
    template="evidence/other_codes.html.j2",
    build=build,
)
