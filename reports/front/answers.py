"""The five questions of the first page with what is measured: one value with its meaning, sentences and a figure."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

from ..mooring.cases import CASES, OWN
from ..page.figures import Figure
from ..page.numbers import analysis
from ..page.numbers.formatting import number, plural, ratio, seconds
from ..page.numbers.verdicts import Verdict
from . import figures

QUESTIONS = {
    "verified": ("How strongly is this verified?", "evidence"),
    "method": ("Which method, at which error and cost?", "moving"),
    "breaks": ("What breaks?", "limits"),
    "codes": ("How do other codes do, and yours?", "codes"),
    "lines": ("What will it say of your own line?", "lines"),
}
"""Name of an answer -> its question, and the page that it leads to."""

NEAR_TAUT = 0.01
"""Difference of length and chord over the chord, below which a line is called nearly taut."""
PEER = "moorpy"
"""The code of lines at rest whose answers near taut lines are told on the first page."""
MOVING_PEER = "MoorDyn"
AT_REST = "At rest there is nothing to choose: the elastic catenary is exact to rounding."
VALIDATION = ("difference from the laboratory", "difference from OrcaFlex")
"""Labels of verdicts that compare with measurements, and with another program whose model is not the same."""
WORDS = {
    "in time": "integrated in time",
    "in time, extrapolated": "integrated in time and extrapolated from two meshes",
    "harmonic balance": "by harmonic balance",
    "harmonic balance, extrapolated": "by harmonic balance, extrapolated from two meshes",
}


@dataclass(frozen=True)
class Answer:
    """An answer. value, meaning : the one number and what it is; good : within its bound (None: no bound)."""

    name: str
    question: str
    page: str
    value: str
    meaning: str
    good: bool | None
    sentences: list[str]
    figure: Figure | None


def answer_questions(results: Any, sections: Iterable[tuple[Any, Any]], folder: Path) -> list[Answer]:
    """Return the five answers, of what was measured.

    results : loads groups of stages; sections : (section, built section) of the report; folder : of the figures
    """
    built = list(sections)
    verdicts = [verdict for _, section in built for verdict in section.verdicts]
    made = {
        "verified": _verified(results, verdicts, folder),
        "method": _method(results.load("mooring"), folder),
        "breaks": _breaks(results.load("stability"), results.load("harmonic_balance"), folder),
        "codes": _codes(results.load("accuracy"), results.load("mooring"), folder),
        "lines": _lines(results.load("scenes"), folder),
    }
    pages = {section.page for section, _ in built}
    return [Answer(name, question, f"{page}.html" if page in pages else "index.html", *made[name])
            for name, (question, page) in QUESTIONS.items()]  # fmt: skip


NOTHING = ("", "", None, [], None)


def _verified(results, verdicts: list[Verdict], folder: Path) -> tuple:
    """Return how many bounds set beforehand are reached, and the errors of lines at rest by regime."""
    bounded = [v for v in verdicts if v.good is not None]
    missed = [v for v in bounded if not v.good]
    accuracy, defects = results.load("accuracy"), results.load("defects")
    sentences = []
    if accuracy:
        counts = analysis.summarise([row for row in accuracy["rows"] if row["set"] != "map"], analysis.OURS)
        rounding = f"{number(counts['max'], 3)} of what rounding the inputs alone must cause"
        sentences.append(
            f"{plural(counts['cases'], 'line')} at rest against 50 digits: {counts['wrong']} wrong, "
            f"{counts['refused']} refused; the greatest error is {rounding}, the median {number(counts['median'], 2)}."
        )
    if defects:
        counts = defects["summary"]
        sentences.append(
            f"The checks are checked: {counts['caught']} of {plural(counts['defects'], 'mistake')} planted in the "
            "solvers are found."
        )
    if measured := [v for v in verdicts if v.label in VALIDATION]:
        measured = [f"{v.label} {v.value} ({v.detail.partition(', wanted')[0]})" for v in measured]
        sentences.append(f"In motion, differences of the models included: {'; '.join(measured)}.")
    if missed:
        missing = [f"{v.label}, {v.value} where {_wanted(v)} was wanted" for v in missed]
        sentences.append(f"Not met: {'; '.join(missing)}.")
    if not bounded:
        return "", "", None, sentences, None
    value = f"{len(bounded) - len(missed)} of {len(bounded)}"
    return (value, "bounds that were set before anything was measured are met", None if missed else True, sentences,
            figures.errors_by_regime(accuracy, folder) if accuracy else None)  # fmt: skip


def _wanted(verdict: Verdict) -> str:
    """Return the bound of a verdict, "at most 1 %", as its detail says it."""
    return verdict.detail.partition("wanted ")[2].partition(";")[0].partition(",")[0]


def _method(mooring: dict | None, folder: Path) -> tuple:
    """Return the cheapest setting for the larger of the wanted errors, over all cases of the moving line."""
    work = (mooring or {}).get("work")
    if not work:
        return NOTHING
    least, level = work["wanted"]
    best = {case: _cheapest(work["points"], case, level) for case in work["uncertainty"]}
    best = {case: point for case, point in best.items() if point}
    finest = [point for case in work["uncertainty"] if (point := _cheapest(work["points"], case, least))]
    if not best:
        return NOTHING
    methods = [point["method"] for point in best.values()]
    method = max(dict.fromkeys(methods), key=methods.count)
    typical = next(point for point in best.values() if point["method"] == method)
    title = (CASES | work["titles"])[typical["case"]]
    sentences = [
        f"For {100 * level:g} % on a moving line take nodes and elements, {WORDS[method]}: the cheapest in "
        f"{methods.count(method)} of {plural(len(best), 'case')}. Here {_setting(typical)} do; by case it takes "
        f"{_spread(best.values())} on one core.",
    ]
    if finest:
        counts = Counter(WORDS[point["method"]] for point in finest).most_common()
        names = ", ".join(f"{name} in {plural(count, 'case')}" for name, count in counts)
        sentences.append(f"For {100 * least:g} % the cheapest is {names}; {_spread(finest)}.")
    ratios = [row["ratio"] for row in work["ratios"] if row["method"] == MOVING_PEER]
    if ratios:
        times = f"{ratio(min(ratios))} to {ratio(max(ratios))} times as long for the same error"
        sentences.append(f"{MOVING_PEER} takes {times}. {AT_REST}")
    else:
        sentences.append(AT_REST)
    meaning = (
        f"to {100 * level:g} %, the numerical error of the fairlead tension (rms over its range); {title.lower()}, "
        "from rest until periodic"
    )
    case = next(name for name, point in best.items() if point is typical)
    return seconds(typical["seconds"]), meaning, None, sentences, figures.moving_line(work, case, folder)


def _cheapest(points: list[dict], case: str, level: float) -> dict | None:
    """Return the fastest setting of this project's line of nodes and elements within an error."""
    good = [p for p in points if p["case"] == case and p["method"] in OWN and p["rms"] and p["rms"] <= level]
    return min(good, key=lambda p: p["seconds"], default=None)


def _spread(points: Iterable[dict]) -> str:
    """Return the least and the greatest run time."""
    times = [point["seconds"] for point in points]
    return f"{seconds(min(times))} to {seconds(max(times))}"


def _setting(point: dict) -> str:
    other = "harmonics" if "harmonic" in point["method"] else "steps a period"
    return f"{point['size']} cells and {point['other']} {other}"


def _breaks(stability: dict | None, harmonic: dict | None, folder: Path) -> tuple:
    """Return what the solvers make of points pushed to the limits."""
    maps = (stability or {}).get("maps")
    if not maps:
        return NOTHING
    totals = {verdict: sum(entry["counts"].get(verdict, 0) for entry in maps) for verdict in stability["verdicts"]}
    points = sum(totals.values())
    bad = totals["wrong"] + totals["crashed"]
    ended = points - bad - sum(totals.get(verdict, 0) for verdict in ("solved", "warned", "too coarse"))
    sentences = [
        f"{plural(points, 'input')}, most of them far beyond use at sea: {number(totals['solved'])} solved; "
        f"{number(totals.get('warned', 0))} solved, with a warning that says what the answer lacks; "
        f"{number(totals.get('too coarse', 0))} too coarse, with an error above what counts as solved; "
        f"{number(ended)} ended with a message in place of an answer."
    ]
    limit = (harmonic or {}).get("limit")
    if limit and limit["vanishes"]:
        sentences.append(
            f"The OC3 line goes slack in surge of {number(limit['vanishes'], 3)} m: there the box scheme's equations "
            "end, and those of nodes and elements go on."
        )
    return (number(bad), "wrong answers given as success, or crashes", bad == 0, sentences,
            figures.verdicts_by_solver(maps, stability["verdicts"], folder))  # fmt: skip


def _codes(accuracy: dict | None, mooring: dict | None, folder: Path) -> tuple:
    """Return how other codes do on lines at rest, near taut ones first, and on the moving line."""
    if not accuracy or len(accuracy["solvers"]) < 2:  # this project alone: no peer is installed
        return NOTHING
    sentences, value, meaning, good = [], "", "", None
    taut = [row for row in accuracy["rows"] if _is_nearly_taut(row)]
    if PEER in accuracy["solvers"] and taut:
        label = accuracy["solvers"][PEER]["label"]
        theirs, ours = analysis.summarise(taut, PEER), analysis.summarise(taut, analysis.OURS)
        given = theirs["cases"] - theirs["unsupported"]
        value = f"{theirs['wrong']} of {given}"
        meaning = (
            f"nearly taut lines (unstretched length within {100 * NEAR_TAUT:g} % of the chord) get a wrong answer "
            f"from {label}, more than {100 * accuracy['wrong_bound']:g} % off, without an error raised; "
            f"{ours['wrong']} from this project"
        )
        good = theirs["wrong"] == 0
        if errors := [row["answers"][PEER]["error"] for row in taut if row["answers"][PEER]["verdict"] == "wrong"]:
            sentences.append(f"Half of these are off by more than {100 * median(errors):.2g} %.")
    others = []
    for name in analysis.sort_solvers(accuracy["solvers"]):
        if not name.startswith(analysis.OURS):
            counts, chosen = analysis.summarise(accuracy["rows"], name), accuracy["solvers"][name]
            others.append(
                f"{chosen['label']} {chosen['version']} {number(counts['wrong'])} wrong, {number(counts['refused'])} "
                f"refused, {number(counts['unsupported'])} not modelled of {number(counts['cases'])}"
            )
    sentences.append(f"All lines at rest: {'; '.join(others)}.")
    sentences.append(
        "**Your own code**, in Python or a program that reads and prints JSON: `pytest --pyargs "
        "verification.conformance --solver my_code.py` judges it at rest and in motion, and says which cases are "
        "wrong, and why. README has an adapter to copy."
    )
    return value, meaning, good, sentences, figures.verdicts_by_code(accuracy, folder)


def _is_nearly_taut(row: dict) -> bool:
    return row.get("slackness") is not None and abs(row["slackness"] - 1) <= NEAR_TAUT


def _lines(scenes: dict | None, folder: Path) -> tuple:
    """Return what a scene file gives, shown on the first one that is shipped, and how to bring one."""
    sentences = [
        "**Your own line**, in a file of ten lines that README has to copy: `python -m reports my_line.toml` writes a "
        "page of forces, shape, margin against breaking, and the error and run time of each setting. Networks, files "
        "of MAP++ and MoorDyn go the same way, and load cases: `python -m reports cases.csv my_system.toml`. An input "
        "that looks like a mistake in units is warned of.",
    ]
    if not scenes:
        return "", "", None, sentences, None
    scene = next(iter(scenes.values()))
    line = scene["lines"][0]
    value = f"{number(line['tension'] / 1e3, 4)} kN"
    label = f" ({line['label']})" if line["label"] else ""
    meaning = (
        f"for example, at the fairlead of {scene['name']}{label}; {number(line['grounded_length'])} m of it lie on the "
        f"seabed; relative error against 50 digits: {number(line['error'], 2)}"
    )
    return value, meaning, None, sentences, figures.shape_of(scene, folder)
