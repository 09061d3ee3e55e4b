"""What the tests' own command leaves for the report: outcomes of whole files, which need not run again."""

from __future__ import annotations

import copy
import hashlib
import os
import time
import xml.etree.ElementTree as ElementTree
from dataclasses import replace
from datetime import datetime
from pathlib import Path

from ..dependencies.ledger import Ledger, key, write_atomically
from ..dependencies.sources import PACKAGES, ROOT, files_of
from ..stages import PLUGINS, Stage
from .runner import BusyError, only_run

FAILURES = ("failure", "error")


def digest_sources() -> str:
    """Return a digest of all that a test may depend on, as the files are now."""
    total = hashlib.sha256()
    for file in (file for name in (*PACKAGES, "pyproject.toml", "conftest.py") for file in files_of(name)):
        total.update(f"{file}\0".encode() + hashlib.sha256((ROOT / file).read_bytes()).digest())
    return total.hexdigest()


def record_outcomes(xml: Path, results: Path, stages: list[Stage], before: str) -> int:
    """Record a whole run of pytest as the results of the stages whose files it ran; return how many these are.

    xml : what --junitxml wrote; results : folder of the results; before : ``digest_sources`` as the run began. None is
    recorded where a source has changed since, or while a report is being made there.
    """
    if before != digest_sources():
        return 0
    cases: dict[str, list] = {}
    for case in ElementTree.parse(xml).iter("testcase"):
        cases.setdefault(case.get("file", ""), []).append(case)
    try:
        with only_run(results):
            ledger = Ledger(results)
            return sum(_record(stage, cases, ledger) for stage in stages)
    except BusyError:
        return 0


def _record(stage: Stage, cases: dict[str, list], ledger: Ledger) -> bool:
    """Record the outcomes of a stage's files, if all of them are there."""
    files = [file for file in stage.programs if file not in PLUGINS]
    if not all(file in cases for file in files):
        return False
    mine = [case for file in files for case in cases[file]]
    suite = ElementTree.Element("testsuite")
    suite.extend(copy.copy(case) for case in mine)
    whole = replace(stage, arguments=stage.better[-1] if stage.better else stage.arguments)
    (ledger.results / stage.output).parent.mkdir(parents=True, exist_ok=True)
    write_atomically(ledger.results / stage.output, ElementTree.tostring(suite, encoding="unicode"))
    ledger.record(
        whole,
        key=key(whole, whole.arguments),
        good=not any(case.find(kind) is not None for case in mine for kind in FAILURES),
        seconds=sum(float(case.get("time") or 0) for case in mine),
        finished=datetime.fromtimestamp(time.time()).astimezone().isoformat(" ", "minutes"),
        load=[round(value, 2) for value in os.getloadavg()] if hasattr(os, "getloadavg") else None,
    )
    return True
