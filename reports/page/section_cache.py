"""Sections that need not be drawn again: kept with a digest of all that they are made of."""

from __future__ import annotations

import hashlib
import json
import pickle
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib

from ..pipeline.dependencies.ledger import digests
from ..pipeline.dependencies.sources import files_of
from .figures import Figure
from .navigation.claim_links import link_tests
from .numbers.verdicts import Verdict
from .results import Results
from .section import Section

ALWAYS_BUILT = ("machine", "tests")
"""Groups whose sections change with every run, and draw nothing."""


@dataclass(frozen=True)
class Built:
    """A section as its page shows it: text, and what it gives to the head of the page and to the index."""

    text: str
    verdicts: list[Verdict]
    sentences: list[str]
    figures: list[tuple[str, Figure]]


class SectionCache:
    """Built sections of the last run, in results/cache/sections.pickle. A section is used again while the digest of
    its results, of the sources of the report, of its tests' outcomes and notes is as it was, and its files are there.
    """

    def __init__(self, out: Path, results: Results, looks: dict):
        self.out, self.results = out, results
        self.file = out / "results" / "cache" / "sections.pickle"
        shared = [digests(file for folder in ("reports", "reference_data") for file in files_of(folder)), looks]
        self.shared = json.dumps([*shared, matplotlib.__version__], sort_keys=True)
        self.before: dict[str, dict] = self._read()
        self.now: dict[str, dict] = {}

    def _read(self) -> dict[str, dict]:
        try:
            return pickle.loads(self.file.read_bytes())
        except (OSError, pickle.UnpicklingError, EOFError, AttributeError, ImportError, TypeError):
            return {}

    def load(self, section: Section) -> Built | None:
        """Return the section as it was built before; None where it must be built."""
        entry = self.before.get(section.id)
        if not entry or entry["key"] != self._key(section) or not all((self.out / f).is_file() for f in entry["files"]):
            return None
        self.now[section.id] = entry
        return entry["built"]

    def keep(self, section: Section, built: Built) -> Built:
        """Keep a section for the next run; return it."""
        if not set(section.needs) & set(ALWAYS_BUILT):
            files = sorted(_linked(built.text))
            self.now[section.id] = {"key": self._key(section), "built": built, "files": files}
        return built

    def write(self):
        """Write what was kept, once all files of its figures are there."""
        self.file.parent.mkdir(parents=True, exist_ok=True)
        temporary = self.file.with_suffix(".tmp")
        temporary.write_bytes(pickle.dumps(self.now))
        temporary.replace(self.file)

    def _key(self, section: Section) -> str:
        links = link_tests(section.tests, self.results.questions)
        states = {anchor: [link.state for link in of] for anchor, of in links.items()}
        parts: list[Any] = [self.shared, section.id, section.page, section.needs, states]
        parts += [self.results.digest(group) for group in section.needs]
        parts += [self.results.notes.get(group) for group in section.needs]
        return hashlib.sha256(json.dumps(parts, sort_keys=True, default=str).encode()).hexdigest()


def _linked(text: str) -> set[str]:
    """Return the files of figures and tables that a text links."""
    return set(re.findall(r'href="((?:figures|tables)/[^"#]+)"', text))
