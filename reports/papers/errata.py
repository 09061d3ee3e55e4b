"""The section on misprints: those found in the papers, each with the test that shows it."""

from __future__ import annotations

import tomllib

from ..page.navigation.claims import Question, claim_id, find_claim
from ..page.numbers.formatting import plural
from ..page.numbers.tables import Table
from ..page.section import Content, Inputs, Section
from ..pipeline.dependencies.sources import ROOT


def build(inputs: Inputs) -> Content:
    """Return the table of misprints, and how many of them a test shows."""
    table = errata_table(read_errata(), inputs.results["tests"]).write(inputs.tables)
    passed = sum(row["result"] == "passed" for row in table.rows)
    text = f"{plural(len(table.rows), 'misprint')} found in the papers, {passed} of them shown by a test that passed."
    return Content({"errata": table}, sentences=[text])


def read_errata() -> dict:
    """Return the table of misprints, each with the test that shows it."""
    return tomllib.loads((ROOT / "reference_data" / "errata.toml").read_text(encoding="utf-8"))


def errata_table(data: dict, questions: list[Question]) -> Table:
    """Return the misprints, each with its test and how that test ended."""
    rows = []
    for entry in data["erratum"]:
        claim, (file, _, name) = find_claim(questions, entry["test"]), entry["test"].partition("::")
        anchor = claim_id(file.removeprefix("verification/").removesuffix(".py"), claim.name) if claim else None
        result = claim.state if claim else "no such test yet"
        rows.append(entry | {"test": name, "result": result, "anchor": anchor})
    columns = {key: key for key in ("paper", "where", "printed", "right", "evidence", "test", "result")}
    return Table("errata", "Misprints found in the papers", columns, rows, anchors={"test": "anchor"})


ERRATA = Section(
    id="errata",
    title="Misprints",
    part="papers",
    page="evidence",
    needs=("tests",),
    template="papers/errata.html.j2",
    build=build,
    tests={"errata": ("suite/test_published.py::test_every_erratum_has_its_test",)},
)
