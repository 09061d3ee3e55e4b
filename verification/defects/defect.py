"""One seeded defect: a small patch of one solver module, and the check that was named for it beforehand."""

from __future__ import annotations

import re
import shlex
from dataclasses import dataclass
from pathlib import Path

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
    """In the module of solvers the text ``old``, which stands there once, becomes ``new``.

    kind : one of KINDS; what : the mistake in one sentence
    check : what should find it, named beforehand: arguments of pytest, paths relative to verification/
    misprint : where the paper has it, as "MSQS (4.16a)"
    blind : why no check can see it; then ``check`` has to stay green
    survives : why it is not found although it could be; empty for all that are found
    """

    name: str
    module: str
    old: str
    new: str
    kind: str
    what: str
    check: str
    misprint: str = ""
    blind: str = ""
    survives: str = ""

    @property
    def path(self) -> str:
        """Path of the module's file from the root of the project."""
        return f"solvers/{self.module.replace('.', '/')}.py"

    def applied_to(self, text: str) -> str:
        """The module's text with the mistake. Raises ValueError unless ``old`` stands there exactly once."""
        count = text.count(self.old)
        if count != 1:
            raise ValueError(f"{self.name}: {self.old!r} stands {count} times in {self.path}, not once")
        return text.replace(self.old, self.new)

    def plant(self, root: Path):
        """Apply the patch to the copy of the project at ``root``."""
        path = root / self.path
        path.write_text(self.applied_to(path.read_text(encoding="utf-8")), encoding="utf-8", newline="")


def arguments(check: str) -> list[str]:
    """A check as arguments of pytest, run from the root of the project."""
    return [f"verification/{word}" if re.match(r"\w+/test_", word) else word for word in shlex.split(check)]
