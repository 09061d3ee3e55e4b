"""One seeded defect: a fault in one solver module, and the check that was named for it beforehand."""

from __future__ import annotations

import re
import shlex
from dataclasses import dataclass

from ..tools.planting import Fault

KINDS = {
    "sign": "a sign",
    "factor": "a factor such as 2 or pi",
    "index": "a wrong index or end",
    "symbol": "one symbol for another",
    "term": "a missing or doubled term",
    "boundary": "a slip in a boundary row",
    "derivative": "a wrong derivative beside a right value",
    "stale": "something old kept too long",
    "unit": "a wrong unit",
    "order": "a first-order slip in a scheme of second order",
    "tolerance": "a tolerance that is none",
    "regime": "a regime missing or taken for another",
    "input": "an input lost, or a bad one let through",
    "misprint": "a misprint of one of the papers, taken at its word",
}


@dataclass(frozen=True)
class Defect:
    """A fault in the solvers, and what is known of it.

    kind : one of KINDS; what : the mistake in one sentence
    check : what should find it, named beforehand: arguments of pytest, paths relative to verification/
    misprint : where the paper has it, as "MSQS (4.16a)"
    blind : why no check can see it; then ``check`` has to stay green
    survives : why it is not found although it could be; empty for all that are found
    """

    name: str
    fault: Fault
    kind: str
    what: str
    check: str
    misprint: str = ""
    blind: str = ""
    survives: str = ""

    @property
    def module(self) -> str:
        """The module with the mistake, as its fault names it."""
        return self.fault.module

    def applied_to(self, text: str) -> str:
        """Return the module's text with the mistake. Raises ValueError where the fault does not apply to it."""
        try:
            return self.fault.apply_to(text)
        except ValueError as error:
            raise ValueError(f"{self.name}: {error}") from error


def defect_in(room: str, name, module, function, old, new, kind, what, check, **place) -> Defect:
    """Return a Defect without the words Defect and Fault. room: of the module, as "stability", or "" for a whole path.

    place: occurrence and where of the Fault.
    """
    return Defect(name, Fault(f"{room}.{module}" if room else module, function, old, new, **place), kind, what, check)


def arguments(check: str) -> list[str]:
    """A check as arguments of pytest, run from the root of the project."""
    return [f"verification/{word}" if re.match(r"(\w+/)?test_", word) else word for word in shlex.split(check)]
