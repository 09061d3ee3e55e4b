"""Counts, medians and ratios of recorded results. Every number in the report's sentences comes from here."""

from __future__ import annotations

import math
from collections import defaultdict
from statistics import median

VERDICTS = ("right", "wrong", "refused", "unsupported")
OURS = "catenary"
PEER_EXAMPLES = 3

SAME_TIME = 1.1  # ratio of two timings below which they count as equal

TINY = 1e-5
"""Part of the line's weight: a wrong force smaller than this matters to nobody and is counted separately."""

TYPICAL = {"L": 800.0, "w": 500.0, "stiffness": 1e3, "slackness": 1.05, "friction": 1.0}
"""A line as it is used at sea; examples are sought near it."""


def sort_solvers(names) -> list[str]:
    """Return this project's solvers first, then the others by name."""
    return sorted(names, key=lambda name: (not name.startswith(OURS), name))


def summarise(rows: list[dict], solver: str) -> dict:
    """Return counts of verdicts, and median and greatest error of the answers that were returned as success.

    Errors in units of the condition limit; rows without a finite limit count but have no such error.
    """
    answers = [(row, row["answers"][solver]) for row in rows if solver in row["answers"]]
    counts = {verdict: sum(answer["verdict"] == verdict for _, answer in answers) for verdict in VERDICTS}
    given = [(a["in_limits"], row) for row, a in answers if a["verdict"] in ("right", "wrong")]
    measured = [item for item in given if item[0] is not None]
    worst = max(measured, key=lambda item: item[0], default=(None, None))
    return counts | {
        "cases": len(answers),
        "median": median(item[0] for item in measured) if measured else None,
        "max": worst[0],
        "tiny": sum(a["verdict"] == "wrong" and is_tiny(a) for _, a in answers),
        "worst": worst[1],
    }


def by_regime(accuracy: dict) -> list[dict]:
    """Return one entry per regime: the reference table by its labels, then each other set as a whole."""
    groups = defaultdict(list)
    for row in accuracy["rows"]:
        groups[row["regime"] if row["set"] == "reference" else f"{row['set']} set"].append(row)
    names = sort_solvers(accuracy["solvers"])
    return [
        {"regime": regime, "cases": len(rows), "solvers": {name: summarise(rows, name) for name in names}}
        for regime, rows in groups.items()
    ]


def typical_wrong_answers(accuracy: dict, solver: str) -> list[dict]:
    """Return up to PEER_EXAMPLES wrong answers, one per regime, those nearest to a line as it is used at sea."""
    answers = [(row, row["answers"].get(solver, {})) for row in accuracy["rows"]]
    wrong = [row for row, answer in answers if answer.get("verdict") == "wrong" and not is_tiny(answer)]
    chosen = {}
    for row in sorted(wrong, key=_distance_from_typical):
        chosen.setdefault(row["regime"], row)
    return list(chosen.values())[:PEER_EXAMPLES]


def is_tiny(answer: dict) -> bool:
    """Return whether the error of the force is a tiny part of the weight of the line."""
    weights = answer.get("in_weights")
    return weights is not None and weights < TINY


def _distance_from_typical(row: dict) -> float:
    """Return the decades between a row and a typical line, all inputs together; a large condition number adds."""
    values = row["inputs"] | {key: row[key] for key in ("stiffness", "slackness")}
    ratios = [abs(values[key] or 1e-9) / usual for key, usual in TYPICAL.items() if key != "friction"]
    decades = sum(abs(math.log10(value)) for value in ratios) + math.log10(max(values["friction"], TYPICAL["friction"]))
    return decades + math.log10(1 + (row["condition"] or math.inf)) / 2


def pareto_front(points: list[dict], error: str = "error") -> list[dict]:
    """Return the points that no other beats in both seconds and error (a key of theirs), the fastest first."""
    front, best = [], math.inf
    for point in sorted(points, key=lambda point: (point["seconds"], point[error])):
        if point[error] < best:
            front.append(point)
            best = point[error]
    return front


def select_answered(points: list[dict]) -> list[dict]:
    """Return the points with an answer: neither refused nor unsupported."""
    return [p for p in points if p["verdict"] in ("right", "wrong") and p["error"] is not None and p["seconds"]]


def misses_tolerance(point: dict) -> bool:
    """Return whether an answer is wrong although a tolerance ten times smaller than its error was asked for."""
    if point["verdict"] != "wrong" or not is_single_line(point):
        return False
    return point["tolerance"] is None or point["tolerance"] < point["error"] / 10


def is_single_line(point: dict) -> bool:
    """Return whether a point is of one line; one of many has their median error, and the verdict of the worst."""
    return (point.get("lines") or 1) == 1


def factor_at_equal_error(points: list[dict], peer: str) -> dict | None:
    """Return how many times longer a peer takes than this project for an error at most the peer's smallest."""
    theirs = [p for p in select_answered(points) if p["solver"] == peer and p["verdict"] == "right"]
    if not theirs:
        return None
    least = min(p["error"] for p in theirs)
    seconds = min(p["seconds"] for p in theirs if p["error"] == least)
    ours = [p["seconds"] for p in select_answered(points) if p["solver"] == OURS and p["error"] <= least]
    return {"error": least, "seconds": seconds, "factor": seconds / min(ours)} if ours else None


def sum_over_cases(points: list[dict]) -> tuple[list[dict], list[str], list[str]]:
    """Return (greatest error and total seconds per solver and tolerance, the cases summed, the solvers left out).

    Summed are the cases that every solver in the sum answers at every tolerance; a solver that answers fewer than half
    of the cases is left out, so that it does not decide which cases count.
    """
    points = [p for p in points if is_single_line(p)]
    cases = list(dict.fromkeys(p["case"] for p in points))
    good = {name: _answered(points, name, cases) for name in sort_solvers({p["solver"] for p in points})}
    names = [name for name, answered in good.items() if 2 * len(answered) >= len(cases)]
    common = [case for case in cases if all(case in good[name] for name in names)] if names else []
    groups = defaultdict(list)
    for p in select_answered(points):
        if p["solver"] in names and p["case"] in common:
            groups[p["solver"], p["label"], p["tolerance"]].append(p)
    total = [
        {
            "solver": solver, "label": label, "tolerance": tolerance, "verdict": "right",
            "error": max(p["error"] for p in group), "seconds": sum(p["seconds"] for p in group),
        }
        for (solver, label, tolerance), group in groups.items()
        if len(group) == len(common)
    ]  # fmt: skip
    return total, common, [name for name in good if name not in names]


def _answered(points, solver: str, cases) -> set[str]:
    mine = [p for p in points if p["solver"] == solver]
    bad = {p["case"] for p in mine} - {p["case"] for p in select_answered(mine)}
    return {case for case in cases if case in {p["case"] for p in mine} - bad}


def find_cheapest(points: list[dict], tolerance: float) -> dict | None:
    """Return the fastest setting whose error is within the tolerance; of equally fast ones the loosest."""
    good = [p for p in select_answered(points) if p["error"] <= tolerance]
    least = min((p["seconds"] for p in good), default=None)
    return max((p for p in good if p["seconds"] <= SAME_TIME * least), key=lambda p: p["tolerance"] or 0, default=None)


def benchmark_rows(benchmark: dict) -> list[dict]:
    """Return one row per timing of pytest-benchmark: group, solver, and seconds per line (median and quartiles)."""
    rows = []
    for entry in benchmark["benchmarks"]:
        extra, stats = entry["extra_info"], entry["stats"]
        lines = extra.get("lines") or 1
        rows.append(
            {
                "group": entry["group"] or "", "case": extra.get("case", entry["name"]),
                "solver": extra.get("solver", ""), "label": extra.get("label", ""), "lines": lines,
                "median": stats["median"] / lines, "q1": stats["q1"] / lines, "q3": stats["q3"] / lines,
                "rounds": stats["rounds"], "error": extra.get("error"), "in_limits": extra.get("in_limits"),
                "verdict": extra.get("verdict", ""),
            }
        )  # fmt: skip
    return rows
