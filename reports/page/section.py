"""What the report consists of: pages of sections, each with its template and what it is built from."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from .figures import Figure
from .numbers.verdicts import Verdict

PARTS = {
    "verified": "What is verified, and how strongly?",
    "error-for-time": "Which method gives which error for which run time, on which scene?",
    "papers": "What do the papers say, and what comes out?",
    "breaks": "What breaks, and where?",
    "peers": "How do the peers do?",
    "trust": "Can I trust this on my machine?",
}
"""Id of a part of the report -> the question that it answers."""

PAGES = {
    "catenary": "Lines at rest",
    "network": "Networks at rest",
    "cable": "The cable of the paper",
    "moving": "Moving lines and networks",
    "harmonic": "Harmonic balance and time domain",
    "stability": "Stability of responses",
    "papers": "The papers, item by item",
    "limits": "Limits: what breaks, and where",
    "codes": "Other codes",
    "evidence": "Evidence: claims, tests, mistakes",
    "lines": "Your line",
    "machine": "This machine, and how to repeat",
}
"""Id of a page, which is also the name of its file -> its title; in the order of the navigation."""

PAGE_OF_PART = {"verified": "evidence", "error-for-time": "moving", "papers": "papers", "breaks": "limits",
                "peers": "codes", "trust": "machine"}  # fmt: skip
"""Id of a part -> the page of those of its sections that name none."""


@dataclass(frozen=True)
class Inputs:
    """What a section is built from.

    results : group of stages -> what their files hold (None: nothing to read), of the groups that the section needs;
        of "tests" the test files with their claims and outcomes
    looks : colour and marker of every solver; figures, tables : folders to write to
    notes : group of stages -> what is not as it should be; stages : the stages as they ran last
    """

    results: dict[str, Any]
    looks: dict
    figures: Path
    tables: Path
    notes: dict[str, list[str]]
    stages: list[dict]


def show_parts(parts: dict[str, Callable], data: dict, inputs: Inputs) -> dict[str, Any]:
    """Return part -> what its function makes of the measured data, figures and tables; None where none were measured.

    parts : name -> function of data, the folder of the figures and that of the tables
    """
    return {
        name: show(data[name], inputs.figures, inputs.tables) if data.get(name) else None
        for name, show in parts.items()
    }


@dataclass
class Content:
    """What a section shows: the variables of its template, and what it gives to the summary of its part.

    verdicts : measured figures; sentences : the answer in words; figures : (caption, figure)
    """

    context: dict
    verdicts: list[Verdict] = field(default_factory=list)
    sentences: list[str] = field(default_factory=list)
    figures: list[tuple[str, Figure]] = field(default_factory=list)


@dataclass(frozen=True)
class Section:
    """A section of the report.

    id : anchor of its heading; title : in the navigation; part : key of PARTS; page : key of PAGES
    needs : groups of stages whose results it shows; template : path below ``reports``
    tests : anchor within the section -> the tests that show what stands there, a file or file::name
    """

    id: str
    title: str
    part: str
    needs: tuple[str, ...]
    template: str
    build: Callable[[Inputs], Content]
    tests: dict[str, tuple[str, ...]] = field(default_factory=dict)
    page: str = ""

    def __post_init__(self):
        if not self.page:
            object.__setattr__(self, "page", PAGE_OF_PART[self.part])
        if self.page not in PAGES:
            raise KeyError(f"section {self.id!r}: no such page: {self.page!r}; there are {', '.join(PAGES)}")
