"""The section on response curves and stability: curves, special points in time, multipliers, basins, maps, costs."""

from __future__ import annotations

from ..page.figures import FigureWithTable, Group
from ..page.numbers.formatting import number, plural, seconds, two_digits
from ..page.numbers.tables import Table
from ..page.numbers.verdicts import Verdict
from ..page.section import Content, Inputs, Section
from . import figures

MOST_SECONDS = 60.0  # CPU, of a curve of 200 points on 50 cells: the bound that this project sets itself
WHOLE_POINTS, WHOLE_CELLS = 200, 50
KINDS = {"fold": "s", "branch point": "s", "period doubling": "s", "Neimark-Sacker": "", "jump": "s"}
"""Kind of a special point -> what its plural adds."""
AGREE = 1e-5  # difference of the two methods on a smooth system, at its best settings
KN_COLUMNS = {"kind": "special point", "value": "frequency, Hz", "tension": "tension, kN", "error": "error"}
SIDES = {-1: "before", 1: "after", 0: "past it"}


def build(inputs: Inputs) -> Content:
    """Return figures and tables of every part that was measured, and the verdicts on them."""
    data = inputs.results["response_curves"]
    if not data:
        return Content({"response_curves": None})
    cases = [value for key, value in data.items() if key.startswith("curve_")]
    shown = {
        "curves": _curves(cases, inputs) if cases else None,
        "confirmed": _confirmed(cases, inputs) if cases else None,
        "multipliers": _multipliers(cases, data.get("methods"), inputs),
        "basins": _basins(data, inputs) if data.get("count") and data.get("basins") else None,
        "parametric": _parametric(data["parametric"], inputs) if data.get("parametric") else None,
        "cost": _cost(data, inputs) if data.get("cost") else None,
    }
    return Content({"response_curves": shown}, list(verdicts(data, cases)), _sentences(cases))


def _rows(cases) -> list[dict]:
    """Return the time integrations of all curves."""
    return [row | {"case": case["title"], "amplitude": curve["amplitude"]}
            for case in cases for curve in case["curves"] for row in curve["confirmed"]]  # fmt: skip


def _curves(cases, inputs) -> Group:
    special = sum(len(row["curve"]["special"]) for case in cases for row in case["curves"])
    unresolved = sum(len(row["unresolved"]) for case in cases for row in case["curves"])
    ended = [f"{case['title']}, {row['amplitude']:g} m, ends at {number(row['curve']['frequency'][-1])} Hz: "
             f"{row['curve']['end']}" for case in cases for row in case["curves"]
             if row["curve"]["status"] != "SUCCESS"]  # fmt: skip
    text = (
        "Greatest and least tension in the period over the frequency; dotted: unstable, in the plane of the line or "
        "across it; markers: special points in the plane "
        f"({special} in all)."
    )
    if unresolved:
        text += (
            f" {plural(unresolved, 'special point')} of the truncated series left out: the line is nearly slack there, "
            "and the multipliers of the time steps, or the error by the harmonics, say that the motion has none."
        )
    return Group(f"{text} {'; '.join(ended)}{'.' if ended else ''}",
                 [figures.curve_figure(case, inputs.figures) for case in cases])  # fmt: skip


def _confirmed(cases, inputs) -> dict | None:
    rows = [row | {"side": SIDES[row["side"]], "agrees": {True: "yes", False: "no", None: "not decided"}[row["agrees"]]}
            for row in _rows(cases)]  # fmt: skip
    if not rows:
        return None
    columns = {"case": "curve", "kind": "special point", "at": "at, Hz", "side": "started", "value": "frequency, Hz",
               "multiplier": "multiplier", "measured": "growth in time", "periods": "periods", "outcome": "outcome",
               "lands": "comes to", "agrees": "as predicted"}  # fmt: skip
    formats = dict.fromkeys(("at", "value", "multiplier", "measured"), lambda value: number(value, 5))
    table = Table("curves_confirmed", "Special points in time", columns, rows, formats).write(inputs.tables)
    counts = {answer: sum(row["agrees"] == answer for row in rows) for answer in ("yes", "no", "not decided")}
    text = (
        f"Of {plural(len(rows), 'time integration')} {counts['yes']} grow or decay as the multipliers say, "
        f"{counts['no']} contradict them, {counts['not decided']} are not decided."
    )
    return {"table": table, "sentence": text}


def _multipliers(cases, compared, inputs) -> Group | None:
    count = lambda case: max(len(row["curve"]["special"]) for row in case["curves"])
    case = max(cases, key=count, default=None)
    drawn = [figures.multiplier_figure(case, inputs.figures)] if case and count(case) else []
    text = (
        f"The largest multipliers at all points of a curve ({case['title']}): outside a disturbance grows. "
        if drawn
        else ""
    )
    if compared:
        drawn += figures.comparison_figures(compared, inputs.figures)
        least = min(row["difference"] for row in compared if row["difference"] is not None)
        worst = max(row["difference"] for row in compared if row["difference"] is not None)
        text += (
            f"Hill's problem and the monodromy of the OC3 line in small surge differ by {number(least, 1)} at best, "
            f"and by {number(worst, 1)} where harmonics or steps are too few."
        )
    return Group(text, drawn) if drawn else None


def _basins(data, inputs) -> FigureWithTable:
    basins = data["basins"]
    columns = {"size": "displacement, mm", "stable": "stable", "share": "share, %", "low": "from, %", "high": "to, %"}
    rows = [row | {key: 100 * row[key] for key in ("share", "low", "high")}
            | {"size": 1e3 * row["size"], "stable": "yes" if row["stable"] else "no"}
            for row in basins["rows"]]  # fmt: skip
    table = Table("curves_basins", "Basins", columns, rows, dict.fromkeys(columns, number)).write(inputs.tables)
    text = (
        f"Left: stable responses of the taut cable in its plane. Right: of {basins['count']} random starts at "
        f"{number(basins['frequency'])} Hz and {1e3 * basins['amplitude']:g} mm the share that comes to each, with "
        f"its confidence interval (Wilson); {plural(basins['unsettled'], 'start')} came to none."
    )
    drawn = [figures.count_figure(data["count"], inputs.figures), figures.basin_figure(basins, inputs.figures)]
    return FigureWithTable(Group(text, drawn), table)


def _parametric(data, inputs) -> Group:
    text = (
        "The end of the taut cable moves along it: its tension changes, and it starts to swing "
        "near twice its natural frequencies, sideways and in its plane. Grey: disturbances decay."
    )
    return Group(text, figures.parametric_figures(data, inputs.figures))


def _cost(data, inputs) -> dict:
    cost, whole = data["cost"], data.get("whole_curve")
    per_point = cost["rows"][-1]["seconds"]
    text = (
        f"A point of the OC3 line in surge with nine harmonics and its multipliers takes {seconds(per_point)} of one "
        f"core on {cost['rows'][-1]['cells']} cells; the time grows as the cells to the power "
        f"{number(cost['exponent'], 2)}."
    )
    if whole and whole["seconds"]:
        text += f" A whole curve of {whole['points']} points on {whole['cells']} cells: {seconds(whole['seconds'])}."
    return {"group": Group(text, [figures.cost_figure(cost, inputs.figures)])}


def _whole_seconds(data):
    """Return CPU seconds of a whole curve, measured or from its first points, and whether it was measured."""
    whole = data.get("whole_curve")
    if whole and whole["seconds"]:
        return whole["seconds"], True
    mine = [row for row in (data.get("cost") or {"rows": []})["rows"] if row["cells"] == WHOLE_CELLS]
    return (WHOLE_POINTS * mine[0]["seconds"], False) if mine and mine[0]["seconds"] else (None, False)


def verdicts(data: dict, cases: list[dict]):
    """Yield what was measured beside what it should be."""
    rows = _rows(cases)
    if rows:
        bad = sum(row["agrees"] is False for row in rows)
        text = f"of {plural(len(rows), 'time integration')} beside special points contradict the multipliers, wanted 0"
        yield Verdict(str(bad), text, "returns, or leaves", bad == 0, "response-curves")
    if data.get("methods"):
        least = min(row["difference"] for row in data["methods"] if row["difference"] is not None)
        text = f"least difference of Hill's problem and the monodromy, at most {AGREE:g}"
        yield Verdict(two_digits(least), text, "OC3 line in small surge", least <= AGREE, "response-curves")
    total, is_measured = _whole_seconds(data)
    if total is not None:
        how = "measured" if is_measured else f"{WHOLE_POINTS} times that of its first points"
        size = f"{WHOLE_POINTS} points with stability, {WHOLE_CELLS} cells"
        text = f"CPU time of a curve of {size}, at most {MOST_SECONDS:g} s"
        yield Verdict(seconds(total), text, how, total <= MOST_SECONDS, "response-curves")


def _sentences(cases) -> list[str]:
    kinds: dict[str, int] = {}
    for case in cases:
        for row in case["curves"]:
            for point in row["curve"]["special"]:
                kinds[point["kind"]] = kinds.get(point["kind"], 0) + 1
    if not cases:
        return []
    listed = (
        ", ".join(f"{number(count)} {kind}{KINDS[kind] if count > 1 else ''}" for kind, count in kinds.items())
        or "none"
    )
    curves = sum(len(case["curves"]) for case in cases)
    return [f"Response curves: special points on {plural(curves, 'curve')} of cables: {listed}."]


RESPONSE_CURVES = Section(
    id="response-curves",
    title="Response curves and stability",
    part="breaks",
    page="stability",
    needs=("response_curves",),
    template="response_curves/section.html.j2",
    build=build,
    tests={
        "response-curves": (
            "stability/test_special_points.py::test_special_points_are_those_of_shooting",
            "stability/test_curve.py::test_folds_are_those_of_shooting",
            "stability/test_basins.py::test_starts_land_where_another_integrator_has_them",
            "stability/test_line_multipliers.py::test_sideways_growth_is_that_of_mathieu",
        ),
    },
)
