"""The summary of the page: the six questions in order, each with what the results say and the figures that matter."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from ..cable.figures import CASES
from ..drawing.style import Figure, Group
from ..evidence import papers
from . import pareto as fronts
from . import verdicts
from .claims import OUTCOMES
from .formatting import across, number, plural
from .verdicts import Verdict

PARTS = {
    "verified": "What is verified, and how strongly?",
    "error-for-time": "Which method gives which error for which run time, on which scene?",
    "papers": "What do the papers say, and what comes out?",
    "breaks": "What breaks, and where?",
    "peers": "How do the peers do?",
    "trust": "Can I trust this on my machine?",
}
"""Id of a part of the page -> the question that it answers."""

PART_OF = {"claims": "verified", "regimes": "verified", "dynamics": "verified", "drift": "verified",
           "defects": "verified", "stability": "breaks", "items": "papers"}  # fmt: skip
"""Section of a verdict -> part of the page; of all other sections, error for time."""
PEERS = ("MoorPy", "pycatenary", "MoorDyn")


@dataclass
class Answer:
    """A question with its answer. said : sentences; verdicts : measured figures; figures : those that matter."""

    part: str
    question: str
    said: list[str]
    verdicts: list[Verdict] = field(default_factory=list)
    figures: Group | None = None


def answers(context: dict, results: dict) -> list[Answer]:
    """One answer a part, in the order of the page.

    context : what the template is given; results : content of the result files by name, None where there is none
    """
    said = {
        "verified": _verified(context, results),
        "error-for-time": _error_for_time(results),
        "papers": [papers.sentence(context["papers"]), *_errata(context)],
        "breaks": _breaks(results),
        "peers": _peers(context["peers_table"]),
        "trust": _trust(context),
    }
    found = [Answer(part, question, said[part]) for part, question in PARTS.items()]
    for verdict in context["verdicts"]:
        next(answer for answer in found if answer.part == part_of(verdict)).verdicts.append(verdict)
    found[1].figures = _figures(context)
    return found


def part_of(verdict: Verdict) -> str:
    """The part of the page that a verdict belongs to."""
    if any(peer in verdict.label for peer in PEERS):
        return "peers"
    return PART_OF.get(verdict.section, "error-for-time")


def _verified(context, results) -> list[str]:
    counts, questions = context["counts"], context["questions"]
    claims = sum(len(question.claims) for question in questions)
    said = [
        f"{plural(claims, 'claim')} in {plural(len(questions), 'test file')}, each with its test: "
        f"{', '.join(f'{number(counts[outcome])} {outcome}' for outcome in OUTCOMES)}."
    ]
    if results["accuracy"]:
        said.append(verdicts.sentence(results["accuracy"])[0])
    if results["defects"]:
        found = results["defects"]["summary"]
        said.append(
            f"The checks themselves are checked: {found['caught']} of {plural(found['defects'], 'planted mistake')} "
            "are "
            "found."
        )
    return said


def _error_for_time(results) -> list[str]:
    said = []
    if results["work_precision"]:
        said.append(f"Lines at rest: {_short(fronts.static(results['work_precision']['points']))}")
    work = (results["harmonic_balance"] or {}).get("work")
    if work:
        said.append(f"Moving cable: {_short(fronts.moving(work['points'], CASES))}")
    speed = (results["networks"] or {}).get("speed")
    if speed:
        said.append(f"Networks: the nested method takes {across(row['ratio'] for row in speed)} times the time of the "
                    "monolithic one, growing with the number of lines.")  # fmt: skip
    return said or ["Not measured yet."]


def _short(found: list[fronts.Front]) -> str:
    """In how many cases this project is ahead at every error, and the codes ahead elsewhere."""
    ahead = sum(not front.behind for front in found)
    text = f"this project is the fastest at every error in {ahead} of {plural(len(found), 'case')}"
    others = {one.label for front in found for one in front.behind}
    where = "; ".join(f"{front.case}" for front in found if front.behind)
    return f"{text}; {', '.join(sorted(others))} is ahead at some error in: {where}." if others else f"{text}."


def _errata(context) -> list[str]:
    rows = context["errata"].rows
    shown = sum(row["result"] == "passed" for row in rows)
    return [f"{plural(len(rows), 'misprint')} found in the papers, {shown} of them shown by a test that passed."]


def _breaks(results) -> list[str]:
    said, maps = [], (results["stability"] or {}).get("maps")
    if maps:
        total = {v: sum(entry["counts"][v] for entry in maps) for v in results["stability"]["verdicts"]}
        shown = ", ".join(f"{number(count)} {verdict}" for verdict, count in total.items() if count)
        said.append(
            f"{number(sum(total.values()))} points pushed to the limits on {plural(len(maps), 'map')}: {shown}."
        )
    limit = (results["harmonic_balance"] or {}).get("limit")
    if limit and limit["vanishes"]:
        failed = [row["amplitude"] for row in limit["rows"] if row["reached"] < 1.0]
        end = f"; no response is found from {number(min(failed))} m on" if failed else ""
        said.append(
            f"Under surge the tension of the OC3 line vanishes at an amplitude of {number(limit['vanishes'], 4)} m: "
            "beyond "
            f"it results are marked as compression{end}."
        )
    return said or ["Not measured yet."]


def _peers(table) -> list[str]:
    said = []
    for row in table.rows:
        counts = ""
        if row.get("wrong") is not None:
            counts = f"{number(row['wrong'])} wrong and {number(row['refused'])} refused of {number(row['cases'])}, "
        if row.get("ratio") is not None:
            counts += f"{number(row['ratio'], 2)} times the time of this project"
        said.append(f"{row['code']}, {row['problem']}: {counts.strip(', ')}.")
    return said or ["No other code was measured: the optional extra “peers” is not installed."]


def _trust(context) -> list[str]:
    machine, said = context["machine"], []
    if machine:
        threads = across(library["threads"] for library in machine["blas"]) if machine["blas"] else "unknown"
        said.append(
            f"Measured at commit {machine['commit'] or 'unknown'} on {machine['cpu']}, {machine['cores']} cores, BLAS "
            "on "
            f"{threads} thread{'' if threads == '1' else 's'}."
        )
    loads = [stage["load"][0] for stage in context["stages"] if stage["load"]]
    if loads:
        said.append(f"Load before the stages {across(loads)}: times are the least or the median of turns in one "
                    "process, and comparisons are ratios, so that load falls on all alike.")  # fmt: skip
    old = sorted({text.split(":")[0] for notes in context["notes"].values() for text in notes})
    said += [f"{text}, of some stages: a note stands where it matters." for text in old]
    said.append("Errors and counts do not depend on the machine; times do, and one command repeats them on yours.")
    return said


def _figures(context) -> Group | None:
    """The two pictures of error against time: lines at rest together, and the first case of the moving cable."""
    chosen = []
    if context["work"]:
        chosen += context["work"].figures[:1]
    if context["harmonic"] and context["harmonic"]["work"]:
        chosen += context["harmonic"]["work"]["points"].group.figures[:1]
    caption = (
        "Error against run time; rings: the Pareto front. First lines at rest, all cases together; then a moving cable."
    )
    return Group(caption, [_again(figure) for figure in chosen]) if chosen else None


def _again(figure: Figure) -> Figure:
    """The same picture under ids of its own."""
    return replace(figure, svg=figure.svg.replace(f'"{figure.name}-', f'"again-{figure.name}-').replace(
        f"#{figure.name}-", f"#again-{figure.name}-"))  # fmt: skip


def front_verdicts(results: dict) -> list[Verdict]:
    """On the front at every error: lines at rest and moving cables."""
    found = []
    if results["work_precision"]:
        found.append(_front("lines at rest", fronts.static(results["work_precision"]["points"]), "work-precision"))
    work = (results["harmonic_balance"] or {}).get("work")
    if work:
        found.append(_front("moving cables", fronts.moving(work["points"], CASES), "dynamics-work"))
    return found


def _front(what: str, cases: list[fronts.Front], section: str) -> Verdict:
    ahead = sum(not front.behind for front in cases)
    detail = f"fastest at every error of all codes, wanted {len(cases)} of {len(cases)}"
    return Verdict(f"{ahead} of {len(cases)}", f"cases, {what}", detail, ahead == len(cases), section)


def paper_verdict(items: list[papers.Item]) -> Verdict:
    """How many items of the papers come out."""
    good = sum(item.verdict in (papers.AGREES, papers.CORRECTED) for item in items)
    detail = "tables, figures, equations; of the others the reason is given"
    return Verdict(f"{good} of {len(items)}", "items of the papers come out", detail, None, "items")
