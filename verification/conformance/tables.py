"""Cases with their truth, bounds and the answers of typical mistakes, as reference_data/conformance holds them.

A level is one file. Its version, year and month, is that of the set: cases keep their ids over versions.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from functools import lru_cache
from importlib.resources import files

LEVELS = ("statics", "network", "motion")
"""In the order in which they are judged; each is a file of the same name."""

PROBLEMS = {"statics": ("span",), "network": ("network",), "motion": ("cable", "moving_network")}
"""Level -> methods of an Adapter that answer its cases."""

EVERYDAY, EXTREME = "everyday", "extreme"


@dataclass(frozen=True, eq=False)
class Case:
    """One row of a table.

    inputs : what the adapter is given, SI
    truth, scale, bound : quantity -> its value, the size over which its error is taken (a number, or one an entry where
    entries have units of their own), and (right, wrong): the greatest error of a right answer, and beyond which it is
    wrong
    mistakes : name -> quantity -> the answer of a code that makes this mistake alone
    without : feature -> quantity -> the answer of a code that leaves the feature out
    """

    id: str
    level: str
    group: str
    title: str
    features: tuple[str, ...]
    inputs: dict
    truth: dict
    scale: dict
    bound: dict
    uncertainty: dict = field(default_factory=dict)
    mistakes: dict = field(default_factory=dict)
    without: dict = field(default_factory=dict)

    @property
    def problem(self) -> str:
        """The method of an Adapter that answers it."""
        return PROBLEMS[self.level][self.level == "motion" and "elements" in self.inputs]


@dataclass(frozen=True, eq=False)
class Table:
    """Cases of a level; units : quantity -> unit; mistakes : name -> what is done wrong, one sentence."""

    version: str
    level: str
    units: dict
    mistakes: dict
    cases: tuple[Case, ...]


def available_levels() -> tuple[str, ...]:
    """Return the levels whose table is installed."""
    return tuple(level for level in LEVELS if _file(level).is_file())


@lru_cache(maxsize=len(LEVELS))
def load_table(level: str) -> Table:
    """Return the table of a level. Raises FileNotFoundError where it is not installed, ValueError for a bad one."""
    return read_table(json.loads(_file(level).read_text(encoding="utf-8")))


def read_table(data: dict) -> Table:
    """Return a table from its JSON. Raises ValueError naming the case and what is wrong with it."""
    cases = tuple(_read_case(data["level"], row) for row in data["cases"])
    ids = [case.id for case in cases]
    if len(set(ids)) < len(ids):
        raise ValueError(f"{next(one for one in ids if ids.count(one) > 1)}: this id is given twice")
    return Table(data["version"], data["level"], data["units"], data["mistakes"], cases)


def _read_case(level: str, row: dict) -> Case:
    names = Case.__dataclass_fields__.keys() - {"level"}
    case = Case(level=level, **{name: row[name] for name in names if name in row} | {"features": (*row["features"],)})
    if not case.id.startswith(f"{level}/"):
        raise ValueError(f"{case.id}: an id begins with its level, {level}/")
    for quantity in case.truth:
        if quantity not in case.scale or quantity not in case.bound:
            raise ValueError(f"{case.id}: {quantity} has no scale or no bound")
        right, wrong = case.bound[quantity]
        if not (0 < right <= wrong and _least(case.scale[quantity]) > 0):
            raise ValueError(f"{case.id}: {quantity}: scale > 0 and 0 < right <= wrong are wanted")
    return case


def _least(scale) -> float:
    """Return the least entry; without numpy, for the plugin imports this module in every run of pytest."""
    return min(map(_least, scale)) if isinstance(scale, list) else scale


def _file(level: str):
    return files("reference_data") / "conformance" / f"{level}.json"
