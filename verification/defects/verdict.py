"""What the results of the catalogue say: who found which defect, and whether the catalogue keeps its promises."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass

from .catalogue import CATALOGUE, frozen
from .defect import Defect
from .runner import Result

WANTED = 0.95
"""Share of the defects that a check other than a comparison with stored numbers has to find."""


@dataclass(frozen=True)
class Verdict:
    """A defect with the results of its checks, its own first; ``void``: checks that are red without any defect."""

    defect: Defect
    results: tuple[Result, ...]
    void: frozenset[str] = frozenset()

    @property
    def seen(self) -> tuple[Result, ...]:
        """Results of the checks that it turned red."""
        return tuple(r for r in self.results if r.red and r.check not in self.void)

    @property
    def by_named(self) -> bool:
        """The check that was named beforehand saw it."""
        return any(r.check == self.defect.check for r in self.seen)

    @property
    def by_other(self) -> bool:
        """A check saw it that compares with nothing stored."""
        return any(not frozen(r.test or r.check) for r in self.seen)

    @property
    def good(self) -> bool:
        """As it should be: found without stored numbers, or blind and unseen."""
        return not self.seen if self.defect.blind else self.by_other


def verdicts(catalogue: Iterable[Defect], results: Iterable[Result]) -> list[Verdict]:
    """One for each defect that has a result of its named check."""
    results = list(results)
    void = frozenset(r.check for r in results if not r.defect and r.red)
    entries = []
    for defect in catalogue:
        mine = [r for r in results if r.defect == defect.name]
        mine.sort(key=lambda r: (r.check != defect.check, r.check))
        if mine and mine[0].check == defect.check:
            entries.append(Verdict(defect, tuple(mine), void))
    return entries


def summary(result: list[Verdict]) -> dict:
    """Counts and lists of names for the report, the command line and the tests."""
    real = [v for v in result if not v.defect.blind]
    caught = [v for v in real if v.seen]
    return {
        "defects": len(real),
        "caught": len(caught),
        "caught_otherwise": sum(v.by_other for v in real),
        "caught_by_named": sum(v.by_named for v in real),
        "rate": sum(v.by_other for v in real) / len(real) if real else 0.0,
        "survivors": [v.defect.name for v in real if not v.by_other],
        "unexplained": [v.defect.name for v in real if not v.by_other and not v.defect.survives],
        "blind": sum(bool(v.defect.blind) for v in result),
        "seen_blind": [v.defect.name for v in result if v.defect.blind and v.seen],
        "misprints": sorted({v.defect.misprint for v in real if v.defect.misprint}),
        "missed_misprints": sorted({v.defect.misprint for v in real if v.defect.misprint and not v.by_other}),
        "void": sorted({check for v in result for check in v.void}),
    }


def kept(counts: dict) -> bool:
    """The promises: 95 % found, survivors explained, misprints all found, blind spots blind, no check red by itself."""
    broken = ("unexplained", "seen_blind", "missed_misprints", "void")
    return counts["rate"] >= WANTED and not any(counts[name] for name in broken)


def as_json(result: list[Verdict]) -> dict:
    """The content of the result file."""
    rows = []
    for v in result:
        results = [asdict(r) | {"void": r.check in v.void, "frozen": frozen(r.test or r.check)} for r in v.results]
        about = asdict(v.defect) | {"module": v.defect.module}
        rows.append(about | {"results": results, "by_named": v.by_named, "by_other": v.by_other})
    counts = summary(result)
    return {"summary": counts, "kept": kept(counts), "catalogue": len(CATALOGUE), "defects": rows}
