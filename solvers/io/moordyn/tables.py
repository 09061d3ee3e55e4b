"""Sections and rows of a MoorDyn input file, as words with their line numbers.

A line with --- is the title of a section; a table has a line of column names and a line of units below it, which
MoorDyn does not read, and options are a value and its keyword. # starts a comment. Sources: MoorDyn 2 manual,
inputs.rst; its reader, source/MoorDyn2.cpp (v2.7.1), which tells the layouts apart by the number of columns.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from difflib import get_close_matches
from os import PathLike
from pathlib import Path
from typing import NoReturn

from ...common.outcome import InputError

TITLES = {  # section -> what its title may contain
    "LINE TYPES": ("LINE TYPES", "LINE DICTIONARY"),
    "ROD TYPES": ("ROD TYPES", "ROD DICTIONARY"),
    "BODIES": ("BODIES", "BODY LIST", "BODY PROPERTIES"),
    "RODS": ("RODS", "ROD LIST", "ROD PROPERTIES"),
    "POINTS": ("POINTS", "POINT LIST", "POINT PROPERTIES", "CONNECTION PROPERTIES", "NODE PROPERTIES"),
    "LINES": ("LINES", "LINE LIST", "LINE PROPERTIES"),
    "FAILURE": ("FAILURE",),
    "CONTROL": ("CONTROL",),
    "EXTERNAL LOADS": ("EXTERNAL LOADS",),
    "OPTIONS": ("OPTIONS",),
    "OUTPUTS": ("OUTPUT",),
}
REFUSED = {  # section -> why its rows have no meaning here
    "ROD TYPES": "",  # of no consequence without rods
    "BODIES": "bodies are not supported; a network moves with one body, whose motion is given",
    "RODS": "rigid rods are not supported",
    "FAILURE": "lines that break are not supported",
    "CONTROL": "lines of controlled length are not supported",
    "EXTERNAL LOADS": "dampers at points are not supported; forces stand in columns FX FY FZ of POINTS",
}
LAYOUTS = {  # section -> columns by their number
    "LINE TYPES": {
        9: "Name Diam MassDen EA BA CaN CaAx Cd CdAx",  # MoorDyn 1
        10: "Name Diam MassDen EA BA EI Cd Ca CdAx CaAx",
        11: "Name Diam MassDen EA BA EI Cd Ca CdAx CaAx Cl",
        13: "Name Diam MassDen EA BA EI Cd Ca CdAx CaAx Cl dF cF",
    },
    "POINTS": {9: "ID Type X Y Z M V CdA Ca", 12: "ID Type X Y Z M V FX FY FZ CdA Ca"},
    "LINES": {6: "ID Type AttachA AttachB Length NumSegs", 7: "ID Type AttachA AttachB Length NumSegs Outputs"},
}
MOORDYN_1_LINES = "ID Type Length NumSegs AttachA AttachB Outputs"  # told by its column names alone
UNITS = {"Diam": "m", "MassDen": "kg/m", "EA": "N", "BA": "N s", "EI": "N m^2", "X": "m", "Y": "m", "Z": "m",
         "M": "kg", "V": "m^3", "FX": "N", "FY": "N", "FZ": "N", "CdA": "m^2", "Length": "m"}  # fmt: skip


@dataclass(frozen=True)
class Row:
    """One row of a section: its words by column, and where it stands, file:line."""

    where: str
    words: dict[str, str]

    def refuse(self, column: str, problem: str) -> NoReturn:
        """Raise InputError naming file, line, column, its word and what is wrong with it."""
        word = self.words.get(column)
        error = InputError(f"{word!r} {problem}", field=column, value=word, unit=UNITS.get(column))
        raise error.located(self.where)

    def number(self, column: str) -> float:
        """Return the word of a column as a finite number."""
        word = self.words[column]
        try:
            number = float(word.replace("_", "?"))  # which Python would read as a separator of thousands
        except ValueError:
            self.refuse(column, "must be a number")
        return number if math.isfinite(number) else self.refuse(column, "must be a finite number")

    def whole(self, column: str) -> int:
        """Return the word of a column as a whole number >= 1."""
        if not self.words[column].isdecimal() or int(self.words[column]) < 1:
            self.refuse(column, "must be a whole number >= 1")
        return int(self.words[column])

    def build(self, make, *arguments, **named):
        """Return make(...); its InputError gets file and line."""
        try:
            return make(*arguments, **named)
        except InputError as error:
            raise error.located(self.where) from None


def read_lines(path: str | PathLike[str]) -> list[str]:
    """Return the lines of a file; raises InputError naming the path that is none, or cannot be read."""
    try:
        return Path(path).read_text(encoding="latin-1").splitlines()  # all but the unit m^3 is ASCII
    except (TypeError, ValueError):
        raise InputError(f"{path!r} is not the path of a MoorDyn file", field="path", value=path) from None
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", field="path", value=path, label=str(path)) from None


def read_sections(path: str | PathLike[str]) -> dict[str, list[Row]]:
    """Return the rows of LINE TYPES, POINTS, LINES, OPTIONS (columns Value, Option) and OUTPUTS.

    Raises InputError naming file and line of a section that is missing, twice there or not supported.
    """
    sections: dict[str, list[Row]] = {}
    name: str | None = None
    headers: list[list[str]] = []
    for number, line in enumerate(read_lines(path), start=1):
        where, words = f"{path}:{number}", line.split("#")[0].split()
        if "---" in line:
            name, headers = _section(where, line, sections), []
        elif name is None or not words:
            continue
        elif name == "OUTPUTS":
            sections[name].append(Row(where, {"Channel": " ".join(words)}))
        elif name == "OPTIONS":
            sections[name].append(Row(where, dict(zip(("Value", "Option"), words, strict=False))))
        elif len(headers) < 2:
            headers.append(words)
        elif name in LAYOUTS:
            sections[name].append(_row(where, name, headers[0], words))
        elif reason := REFUSED.get(name, "is not known"):
            raise InputError(reason, field=name, label=f"{where}: section {name}")
    for name in LAYOUTS:
        if not sections.get(name):
            problem = f"is {'empty' if name in sections else 'missing'}; is this a MoorDyn file?"
            raise InputError(problem, field=name, label=f"{path}: section {name}")
    return sections


def _section(where: str, title: str, sections) -> str | None:
    """Return the name of the section that a title begins, None for front matter and for the end of the file."""
    title = " ".join(title.split())
    name = next((name for name, phrases in TITLES.items() if any(p in title.upper() for p in phrases)), None)
    if name is None:
        is_text = not sections or "NEED THIS LINE" in title.upper() or not any(map(str.isalpha, title))
        return None if is_text else title.strip("- ")
    if name in sections and name != "OUTPUTS":
        raise InputError("is there already", field=name, label=f"{where}: section {name}")
    sections.setdefault(name, [])
    return name


def _row(where: str, name: str, header: list[str], words: list[str]) -> Row:
    layouts = LAYOUTS[name]
    columns = layouts.get(len(words), "")
    is_version_1 = any(column.lower().startswith("ca") for column in header[6:7])  # CaN CaAx before Cd
    if name == "LINE TYPES" and is_version_1 != (len(words) == 9):
        problem = f"columns {' '.join(header[5:])} and {len(words)} of them: neither {layouts[9]} nor {layouts[10]}"
        raise InputError(problem, field=name, value=" ".join(words), label=f"{where}: section {name}")
    if not columns:
        known = " or ".join(f"{count}: {names}" for count, names in layouts.items())
        problem = f"{len(words)} columns where MoorDyn takes {known}"
        raise InputError(problem, field=name, value=" ".join(words), label=f"{where}: section {name}")
    if name == "LINES" and len(header) > 2 and header[2].lower().startswith("unstr"):
        columns = MOORDYN_1_LINES
    return Row(where, dict(zip(columns.split(), words, strict=False)))


def nearest(name: str, known) -> str:
    """Return a hint at the known name that is most like a given one."""
    near = get_close_matches(name, known, n=1)
    return f"did you mean {near[0]!r}?" if near else f"known are {', '.join(sorted(known))}"
