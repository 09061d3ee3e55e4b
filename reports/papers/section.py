"""The section on items: every table and figure with numbers of both papers, and what comes out here."""

from __future__ import annotations

from dataclasses import asdict

from ..page.navigation.claim_links import link_test
from ..page.numbers.tables import Table
from ..page.numbers.verdicts import Verdict
from ..page.section import Content, Inputs, Section
from . import harmonic_items, network_items
from .items import AGREES, CORRECTED, DIFFERS, MISSING, Item, evaluate, read_sources


def build(inputs: Inputs) -> Content:
    """Return the items in the order of the papers, each with links to its tests, their table, and how many agree."""
    sources = read_sources(*(inputs.results[name] for name in ("dynamics", "harmonic_balance", "networks")))
    items = [evaluate(entry, sources) for entry in entries()]
    columns = {key: key for key in ("paper", "item", "prints", "outcome", "verdict", "why", "section", "tests")}
    rows = [asdict(item) | {"tests": " ".join(item.tests)} for item in items]
    context = {
        "items": [(item, [link_test(test, inputs.results["tests"]) for test in item.tests]) for item in items],
        "table": Table("papers", "Items of the papers", columns, rows).write(inputs.tables),
    }
    return Content(context, [_verdict(items)], [_sentence(items)])


def entries() -> tuple:
    """Return every item of both papers, in their order."""
    return (*harmonic_items.ENTRIES, *network_items.ENTRIES)


def _verdict(items: list[Item]) -> Verdict:
    """Return how many items of the papers come out."""
    good = sum(item.verdict in (AGREES, CORRECTED) for item in items)
    detail = "tables, figures, equations; of the others the reason is given"
    return Verdict(f"{good} of {len(items)}", "items of the papers come out", detail, None, "items")


def _sentence(items: list[Item]) -> str:
    words = {AGREES: "agree", CORRECTED: "agree once a misprint is corrected", DIFFERS: "differ", MISSING: MISSING}
    counts = {verdict: sum(item.verdict == verdict for item in items) for verdict in words}
    listed = ", ".join(f"{count} {words[verdict]}" for verdict, count in counts.items() if count)
    differing = [f"{item.paper} {item.item}" for item in items if item.verdict == DIFFERS]
    text = f"Of {len(items)} tables, figures and equations of both papers {listed}."
    reasons = f" The table gives the reason for each that differs: {', '.join(differing)}."
    return text + reasons if differing else text


ITEMS = Section(
    id="items",
    title="Item by item",
    part="papers",
    page="papers",
    needs=("tests", "dynamics", "harmonic_balance", "networks"),
    template="papers/section.html.j2",
    build=build,
)
