"""What one run measured, in a form that can be compared: times, errors and outcomes by name, a file per commit.

Result files are read without knowing what each is about: a row is named by its own words (case, solver, size ...), and
``seconds``, ``error`` and ``verdict`` or ``status`` are what there is to compare.
"""

from __future__ import annotations

import json
import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field
from datetime import datetime
from pathlib import Path

from .dependencies.ledger import Ledger, commit, machine, packages, write_atomically
from .stages import Stage

WHO = ("solver", "method", "variant", "family", "series", "peer", "map", "set", "system")
WHICH = ("fullname", "name", "case", "label", "setting", "weight", "start", "globalisation", "units", "jacobian", "x",
         "y", "tolerance", "nodes", "harmonics", "samples", "mean", "subharmonic", "elements", "size", "cells", "steps",
         "dt", "radius", "beta", "amplitude", "hold", "period")  # fmt: skip
"""What names a row: who was measured (rows of one are a group), and on what."""

STATES = ("verdict", "status", "outcome")
ROUNDING, LIMITS = 1e-13, 10.0
"""Errors below the one, and below so many condition limits where a row has them, are rounding: no loss if they grow."""


OTHERS = ("moorpy", "moordyn", "pycatenary")
"""Codes of others: their times tell how the machine changes, their errors are not this project's to watch."""


def of_others(name: str) -> bool:
    """Return whether a measurement is of another code."""
    return any(other in name.lower() for other in OTHERS)


@dataclass
class Measures:
    """One run.

    times : name -> [median] or [median, lower and upper quartile], s; errors : name -> [relative error, what of it is
    rounding]; states : name -> word. In a name what stands before " | " is the group. failed : titles of stages.
    """

    commit: str
    machine: str
    date: str
    packages: dict
    failed: list[str]
    times: dict[str, list[float]] = field(default_factory=dict)
    errors: dict[str, list[float]] = field(default_factory=dict)
    states: dict[str, str] = field(default_factory=dict)


# ---------------------------------------------------------------- kept beside the results
def save(out: Path, stages: list[Stage], failed: list[str]) -> Path:
    """Write what is valid of the results in ``out``; one file for each machine and commit, in ``out``/history."""
    measures = Measures(commit() or "no-commit", machine(), datetime.now().astimezone().isoformat(" ", "seconds"),
                        packages(), failed)  # fmt: skip
    ledger = Ledger(out / "results")
    for stage in stages:
        path = out / "results" / stage.output
        if path.exists() and ledger.valid(stage):
            read(path, stage.name, stage.timed, measures)
    folder = out / "history" / re.sub(r"\W+", "-", measures.machine).strip("-")
    folder.mkdir(parents=True, exist_ok=True)
    write_atomically(folder / f"{measures.commit}.json", json.dumps(asdict(measures)))
    return folder / f"{measures.commit}.json"


def load(path: Path) -> Measures:
    """Return the content of a file written by ``save``. Raises ValueError, OSError."""
    try:
        return Measures(**json.loads(path.read_text(encoding="utf-8")))
    except (ValueError, TypeError) as error:
        raise ValueError(f"{path}: is not a file of measurements that a report saved ({error})") from None


def saved(out: Path) -> list[Path]:
    """Return all files of measurements, the oldest first."""
    return sorted((out / "history").glob("*/*.json"), key=lambda path: path.stat().st_mtime)


# ---------------------------------------------------------------- reading result files
def read(path: Path, stage: str, timed: bool, into: Measures):
    """Add what a result file holds; times only where the stage measures them."""
    if path.suffix == ".xml":
        into.states |= _tests(path)
        return
    for name, kind, values in _walk(json.loads(path.read_text(encoding="utf-8")), stage, ""):
        if timed if kind == "times" else not of_others(name):
            getattr(into, kind)[name] = values


def _tests(path: Path) -> dict[str, str]:
    """Return test -> passed, failed or skipped."""
    outcomes = {}
    for case in ElementTree.parse(path).iter("testcase"):
        trouble = any(node.tag in ("failure", "error") for node in case)
        outcome = "failed" if trouble else "skipped" if case.find("skipped") is not None else "passed"
        outcomes[f"tests | {case.get('classname')}::{case.get('name')}"] = outcome
    return outcomes


def _walk(node, who: str, which: str) -> Iterator[tuple[str, str, object]]:
    """Yield (name, kind, values) of all that is below a node of a result file."""
    if isinstance(node, list):
        names = [_names(item) for item in node]
        for i, (item, name) in enumerate(zip(node, names, strict=True)):
            if isinstance(item, dict | list):
                twice = f" #{names[:i].count(name) + 1}" if names.count(name) > 1 else ""
                yield from _walk(item, _join(who, name[0]), _join(which, name[1] + twice))
    elif isinstance(node, dict):
        yield from _row(node, f"{who} | {which}" if which else who)
        for key, value in node.items():
            if isinstance(value, dict | list) and key != "seconds":
                inside = key not in ("rows", "points", "benchmarks", "extra_info")
                yield from _walk(value, _join(who, key if inside else ""), which)


def _names(item) -> tuple[str, str]:
    if not isinstance(item, dict):
        return "", ""
    words = [" ".join(_word(key, item[key]) for key in keys if _is_name(item, key)) for keys in (WHO, WHICH)]
    return words[0], words[1]


def _is_name(row: dict, key: str) -> bool:
    return isinstance(row.get(key), str | int | float) and row[key] != "" and (key != "name" or "fullname" not in row)


def _word(key: str, value) -> str:
    return value if isinstance(value, str) else f"{key} {value:.6g}"


def _join(*words: str) -> str:
    return " ".join(word for word in words if word)


def _row(row: dict, name: str) -> Iterator[tuple[str, str, object]]:
    for key, value in row.items():
        more = _join(name, *(key.replace("seconds", "").replace("error", "").strip("_").split("_")))
        if key == "stats":
            yield name, "times", [value["median"], value["q1"], value["q3"]]
        elif key == "seconds" or key.endswith("_seconds") or key.startswith("seconds_"):
            yield from _times(more, value)
        elif (key == "error" or key.startswith("error_")) and isinstance(value, int | float):
            yield more, "errors", [value, _rounding(row)]
        elif key in STATES and isinstance(value, str):
            yield name, "states", value


def _rounding(row: dict) -> float:
    limit = row["error"] / row["in_limits"] if row.get("in_limits") and row.get("error") else 0.0
    return max(ROUNDING, LIMITS * limit)


def _times(name: str, value) -> Iterator[tuple[str, str, object]]:
    if isinstance(value, dict):
        for key, part in value.items():
            yield from _times(_join(name, key), part)
    elif isinstance(value, list):
        numbers = sorted(part for part in value if isinstance(part, int | float))
        if numbers:
            quartiles = [numbers[round(share * (len(numbers) - 1))] for share in (0.5, 0.25, 0.75)]
            yield name, "times", quartiles
    elif isinstance(value, int | float):
        yield name, "times", [value]
