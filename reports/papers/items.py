"""An item of a paper: a table, figure or equation with numbers, what it prints and what comes out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ..pipeline import published

AGREES, CORRECTED, DIFFERS, MISSING = "agrees", "agrees once corrected", "differs", "not computed yet"

Outcome = tuple[str, str, str]
"""(what comes out, verdict, reason of a difference or remark)."""


@dataclass(frozen=True)
class Sources:
    """Printed values of both papers by (name, quantity), half a unit of their last digits, and the result files."""

    hb: dict
    msqs: dict
    cases: dict
    half: dict
    dynamics: dict
    harmonic: dict
    networks: dict


@dataclass(frozen=True)
class Entry:
    """What is known of an item before results are read.

    anchor : of the remade figure or table; tests : those that show it
    prints : what the paper says; evaluate : what comes out, KeyError and the like where that was not measured
    """

    paper: str
    item: str
    anchor: str
    tests: tuple[str, ...]
    prints: Callable[[Sources], str]
    evaluate: Callable[[Sources], Outcome]


@dataclass(frozen=True)
class Item:
    """An item with its outcome."""

    paper: str
    item: str
    prints: str
    outcome: str
    verdict: str
    why: str
    section: str
    tests: tuple[str, ...] = ()


def read_sources(dynamics: dict | None, harmonic: dict | None, networks: dict | None) -> Sources:
    """Return the printed values of reference_data and the content of the result files, {} where there is none."""
    (about, rows), (_, msqs_rows) = published.read("hb_paper"), published.read("msqs_paper")
    half = {(row["name"], row["quantity"]): float(row["half_unit"]) for row in (*rows, *msqs_rows)}
    return Sources(published.values("hb_paper"), published.values("msqs_paper"), about["cases"], half,
                   dynamics or {}, harmonic or {}, networks or {})  # fmt: skip


def evaluate(entry: Entry, sources: Sources) -> Item:
    """Return the item with its outcome, "not computed yet" where its results are missing."""
    try:
        outcome, verdict, why = entry.evaluate(sources)
    except (KeyError, StopIteration, IndexError):
        outcome, verdict, why = "", MISSING, "the part of the results is not there"
    return Item(entry.paper, entry.item, entry.prints(sources), outcome, verdict, why, entry.anchor, entry.tests)
