"""What is claimed and which test shows it: docstrings of the tests, read as text, with the outcomes in tests/*.xml."""

from __future__ import annotations

import ast
import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

OUTCOMES = ("passed", "failed", "skipped")


@dataclass
class Claim:
    """A test function with all its parameters: counts of outcomes, seconds, first message of a failure."""

    name: str
    text: str
    counts: dict = field(default_factory=lambda: dict.fromkeys(OUTCOMES, 0))
    seconds: float = 0.0
    message: str = ""

    @property
    def state(self) -> str:
        """One word for all parameters together."""
        if self.counts["failed"]:
            return "failed"
        return "passed" if self.counts["passed"] else "skipped" if self.counts["skipped"] else "not run"


@dataclass
class Question:
    """A test file: the question it asks and the claims that answer it."""

    module: str
    text: str
    claims: list[Claim]

    def total(self, outcome: str) -> int:
        """Return the number of tests in this file with that outcome."""
        return sum(claim.counts[outcome] for claim in self.claims)

    @property
    def seconds(self) -> float:
        """Time of all its tests."""
        return sum(claim.seconds for claim in self.claims)


def first_sentence(docstring: str | None) -> str:
    """Return the first paragraph up to its first full stop, on one line."""
    paragraph = " ".join((docstring or "").strip().split("\n\n")[0].split())
    return re.split(r"(?<=[.?!])\s+(?=[A-Z])", paragraph)[0]


def read_sources(folder: Path) -> dict[str, tuple[str, dict[str, str]]]:
    """Return test file ("room/test_x") -> (question, {test function: claim}), read without importing any."""
    files = {}
    for path in sorted(folder.rglob("test_*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        functions = [node for node in tree.body if isinstance(node, ast.FunctionDef) and _is_test(node.name)]
        files[path.relative_to(folder).with_suffix("").as_posix()] = (
            first_sentence(ast.get_docstring(tree)),
            {node.name: first_sentence(ast.get_docstring(node)) or _words(node.name) for node in functions},
        )
    return files


def _is_test(name: str) -> bool:
    return name.startswith("test")


def _words(name: str) -> str:
    return name.removeprefix("test_").replace("_", " ")


def read_questions(folder: Path, outcomes: Iterable[Path]) -> list[Question]:
    """Return the test files by name, their claims in the order of the file, with the outcomes of the last run."""
    by_module = {
        module: Question(module, text, [Claim(name, claim) for name, claim in claims.items()])
        for module, (text, claims) in read_sources(folder).items()
    }
    for xml in outcomes:
        for case in ElementTree.parse(xml).iter("testcase"):
            _count(case, by_module)
    return list(by_module.values())


def _count(case, by_module: dict[str, Question]):
    """Add one test case of the XML to its claim; cases of unknown files or functions get an entry of their own."""
    path = (case.get("classname") or case.get("name")).removeprefix("verification.").split(".")
    file = next((i for i, part in enumerate(path) if _is_test(part)), None)
    module = "elsewhere" if file is None else "/".join(path[: file + 1])
    question = by_module.setdefault(module, Question(module, "", []))
    name = case.get("name").split("[")[0]
    claim = next((claim for claim in question.claims if claim.name == name), None)
    if claim is None:
        question.claims.append(claim := Claim(name, _words(name)))
    trouble = [node for node in case if node.tag in ("failure", "error")]
    outcome = "failed" if trouble else "skipped" if case.find("skipped") is not None else "passed"
    claim.counts[outcome] += 1
    claim.seconds += float(case.get("time") or 0)
    if trouble and not claim.message:
        claim.message = f"{case.get('name')}: {trouble[0].get('message') or ''}"[:600]


def find_claim(questions: list[Question], test: str) -> Claim | None:
    """Return the claim of a path such as verification/room/test_x.py::test_y."""
    module, _, name = test.removeprefix("verification/").partition(".py::")
    return next((c for q in questions if q.module == module for c in q.claims if c.name == name.split("[")[0]), None)


def claim_id(module: str, name: str) -> str:
    """Return the id of the row of a test on the page."""
    return f"claim-{module.replace('/', '-')}-{name}"


def file_id(module: str) -> str:
    """Return the id of the entry of a test file on the page."""
    return f"tests-{module.replace('/', '-')}"
