"""Links from what a section says to the tests that show it, in the table of tests."""

from __future__ import annotations

from dataclasses import dataclass

from .claims import Question, claim_id, file_id, find_claim


@dataclass(frozen=True)
class Link:
    """label : file and name; anchor : id of its row, or of the file's entry, in the table of tests; state : outcome."""

    label: str
    anchor: str
    state: str


def link_test(test: str, questions: list[Question]) -> Link:
    """Return the link to a test. Raises KeyError where there is none: a claim without its test must not be printed."""
    module, _, name = test.partition(".py")
    name = name.removeprefix("::")
    question = next((q for q in questions if q.module == module), None)
    claim = find_claim(questions, test) if name else None
    if question is None or (name and claim is None):
        raise KeyError(f"no such test: {test}")
    if claim:
        return Link(test, claim_id(module, name), claim.state)
    state = "failed" if question.total("failed") else "passed" if question.total("passed") else "not run"
    return Link(test, file_id(module), state)


def link_tests(tests: dict[str, tuple[str, ...]], questions: list[Question]) -> dict[str, list[Link]]:
    """Return the links of every anchor of a section."""
    return {anchor: [link_test(test, questions) for test in names] for anchor, names in tests.items()}
