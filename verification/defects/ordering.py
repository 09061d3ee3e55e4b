"""Plugin of pytest that records what each test costs and calls, or runs tests in the order of recorded costs.

``-p verification.defects.ordering --record FILE`` writes {"tests": {node id: seconds}, "calls": {file: functions}};
``--order FILE`` runs the quickest tests first, so that a run with ``-x`` that fails does so early.
"""

from __future__ import annotations

import json
import re
import sys
import time
from pathlib import Path

import pytest

SOLVERS = str(Path(__file__).parents[2] / "solvers")


def pytest_addoption(parser):
    parser.addoption("--record", type=Path, help="write seconds of each test and solver functions called by each file")
    parser.addoption("--order", type=Path, help="run tests in the order of the seconds recorded in this file")


def pytest_configure(config):
    if config.getoption("--record"):
        config.pluginmanager.register(Recorder(config.getoption("--record")))


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(config, items):
    """Sort by recorded seconds; tests that are in no record come first."""
    if path := config.getoption("--order"):
        seconds = json.loads(path.read_text(encoding="utf-8"))
        items.sort(key=lambda item: seconds.get(item.nodeid, 0.0))


class Recorder:
    """Seconds of each test, and the functions of the solvers that the tests of each file call."""

    def __init__(self, path: Path):
        self.path, self.seconds, self.codes = path, {}, {}

    @pytest.hookimpl(hookwrapper=True)
    def pytest_runtest_protocol(self, item):
        """Time a test with its fixtures, and note every function that is entered."""
        codes = self.codes.setdefault(item.nodeid.split("::")[0], set())
        sys.setprofile(lambda frame, event, _: codes.add(frame.f_code) if event == "call" else None)
        began = time.perf_counter()
        yield
        self.seconds[item.nodeid] = time.perf_counter() - began
        sys.setprofile(None)

    def pytest_sessionfinish(self):
        """Write the record."""
        calls = {file: sorted({name for code in codes if (name := _name(code))}) for file, codes in self.codes.items()}
        self.path.write_text(json.dumps({"tests": self.seconds, "calls": calls}), encoding="utf-8")


def _name(code) -> str:
    """Module and function of the solvers that a code object belongs to, as "network.nested:newton"; "" for others."""
    if not code.co_filename.startswith(SOLVERS):
        return ""
    module = ".".join(Path(code.co_filename).relative_to(SOLVERS).with_suffix("").parts)
    function = re.sub(r"(\.<locals>)?\.<\w+>$", "", code.co_qualname.replace(".<locals>.<", ".<"))
    return f"{module}:{function.replace('.<locals>', '')}"
