"""The section on claims: every test file with its question, every test with its claim and its outcome."""

from __future__ import annotations

from ..page.navigation.claims import OUTCOMES, Question
from ..page.numbers.formatting import number, plural
from ..page.numbers.tables import Table
from ..page.numbers.verdicts import Verdict
from ..page.section import Content, Inputs, Section


def build(inputs: Inputs) -> Content:
    """Return the questions with their claims, the table of claims, and how many tests passed."""
    questions = inputs.results["tests"]
    counts = {outcome: sum(question.total(outcome) for question in questions) for outcome in OUTCOMES}
    claims = sum(len(question.claims) for question in questions)
    text = (
        f"{plural(claims, 'claim')} in {plural(len(questions), 'test file')}, each with its test: "
        f"{', '.join(f'{number(counts[outcome])} {outcome}' for outcome in OUTCOMES)}."
    )
    left = sum(claim.state == "not run" for question in questions for claim in question.claims)
    context = {
        "rooms": _by_room(questions),
        "counts": counts,
        "claims": claims,
        "left": left,
        "table": claim_table(questions).write(inputs.tables),
    }
    return Content(context, [_verdict(counts)] if any(counts.values()) else [], [text])


def _by_room(questions: list[Question]) -> dict[str, list[dict]]:
    """Return folder of tests -> its files, each with its question, claims and counts of outcomes."""
    rooms: dict[str, list[dict]] = {}
    for q in questions:
        counts = {outcome: q.total(outcome) for outcome in OUTCOMES}
        entry = counts | {"module": q.module, "text": q.text, "claims": q.claims, "seconds": q.seconds}
        rooms.setdefault(q.module.rpartition("/")[0].replace("_", " ") or "elsewhere", []).append(entry)
    return rooms


def _verdict(counts: dict) -> Verdict:
    detail = f"{counts['failed']} failed, {counts['skipped']} skipped"
    good = counts["failed"] == 0 and counts["passed"] > 0
    return Verdict(number(counts["passed"]), "tests passed", detail, good, "claims")


def claim_table(questions: list[Question]) -> Table:
    """Return every claim with its outcome."""
    rows = [
        {"file": q.module, "question": q.text, "test": c.name, "claim": c.text, "state": c.state, **c.counts,
         "seconds": c.seconds}
        for q in questions for c in q.claims
    ]  # fmt: skip
    keys = ("file", "question", "test", "claim", "state", "passed", "failed", "skipped", "seconds")
    return Table("claims", "Claims and tests", {key: key for key in keys}, rows)


CLAIMS = Section(
    id="claims",
    title="Claims and tests",
    part="verified",
    page="evidence",
    needs=("tests",),
    template="evidence/claims.html.j2",
    build=build,
)
