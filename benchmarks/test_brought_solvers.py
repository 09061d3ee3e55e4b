"""Codes that a reader brings: do they run beside ours, right, wrong and refused, each with its words?"""

from __future__ import annotations

import csv
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SCENE = ROOT / "reference_data" / "scenes" / "taut_polyester.toml"
ROUNDED = 1e-9  # of the force: the example stops its iteration at 1e-10
MOST_LINES = 30  # of a complete adapter

PROGRAM = """
import json, sys
from types import SimpleNamespace

from my_code import MyCode

asked = json.load(sys.stdin)
print("a line before the answer")
try:
    found = MyCode().span(SimpleNamespace(**asked), asked["tolerance"])
    print(json.dumps({"H": found.H, "V": found.V, "iterations": found.iterations}))
except NotImplementedError as error:
    print(json.dumps({"unsupported": str(error)}))
"""

TOYS = """
import sys

from benchmarks.peers import Program, SpanAnswer
from my_code import MyCode

class TwoPercent(MyCode):
    label = "two per cent more"

    def span(self, case, tolerance=None):
        found = super().span(case, tolerance)
        return SpanAnswer(1.02 * found.H, 1.02 * found.V)

class Called(Program):
    label, command = "called", (sys.executable, "program.py")

class Hanging(Program):
    label, command, time_limits = "hanging", ("sleep", "100"), {"span": 0.2}

class Crashing(Program):
    label, command = "crashing", ("sh", "-c", "echo 'no more memory' >&2; exit 3")

class Nonsense(Program):
    label, command = "nonsense", ("echo", "H is about 5 kN")
"""

EXPECTED = {  # label -> verdict, and what its words hold
    "this project": ("right", ""),
    "my catenary": ("right", ""),
    "called": ("right", ""),
    "two per cent more": ("wrong", ""),
    "hanging": ("refused", "no answer within 0.2 s"),
    "crashing": ("refused", "exit status 3: no more memory"),
    "nonsense": ("refused", "printed no JSON object: 'H is about 5 kN"),
}


def example() -> str:
    """The adapter that the README prints."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    return re.search(r"<!-- file: my_code.py -->\n```python\n(.*?)```", text, re.DOTALL)[1]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with the README's adapter, the toys and their program."""
    folder = tmp_path_factory.mktemp("brought")
    for name, text in (("my_code.py", example()), ("toys.py", TOYS), ("program.py", PROGRAM)):
        (folder / name).write_text(text, encoding="utf-8")
    return folder


def python(*words, code=0):
    """What a command prints; its exit status is ``code``."""
    environment = {name: value for name, value in os.environ.items() if name != "MOORING_SOLVERS"}
    run = subprocess.run([sys.executable, "-m", *map(str, words)], cwd=ROOT, env=environment, capture_output=True,
                         text=True)  # fmt: skip
    assert run.returncode == code, run.stdout + run.stderr
    return run.stdout if code == 0 else run.stderr


@pytest.mark.skipif(os.name != "posix", reason="the toys are programs of a POSIX shell")
def test_each_stands_in_the_tables_of_a_page(folder, tmp_path):
    """Right, wrong by 2 %, hanging, crashing and printing nonsense: verdict and words of each are on the page."""
    python("reports", SCENE, "--solver", folder / "my_code.py", "--solver", folder / "toys.py", "--out", tmp_path)
    with (tmp_path / "tables" / "scene_taut_polyester_solvers.csv").open(encoding="utf-8", newline="") as file:
        rows = {row["label"]: row for row in csv.DictReader(file)}
    for label, (verdict, words) in EXPECTED.items():
        row = rows[label]
        assert row["words"] == verdict and words in row["message"], row
        if verdict != "refused":
            assert float(row["seconds"]) > 0 and (float(row["error"]) < ROUNDED) == (verdict == "right"), row
    page = (tmp_path / "scene-taut_polyester.html").read_text(encoding="utf-8")
    assert all(label in page for label in EXPECTED) and "no more memory" in page


def test_the_example_of_the_readme_is_short_and_tried(folder):
    """A complete adapter in less than 30 lines, and what ``benchmarks.trial`` says of it."""
    assert len(example().splitlines()) < MOST_LINES
    said = python("benchmarks.trial", folder / "my_code.py")
    assert "my catenary 0.1 (mycode) solves span" in said
    assert re.search(r"line oc3-floating: right, error \S+e-1\d\n", said), said
    assert "line oc3-friction-1: unsupported, it has no seabed" in said


def test_its_files_are_what_results_depend_on(folder):
    """A result belongs to the files that were brought, and to those that they import and call."""
    code = "import sys, pathlib; from reports import brought; print(*brought.sources(pathlib.Path(sys.argv[1])))"
    said = subprocess.run([sys.executable, "-c", code, folder / "toys.py"], cwd=ROOT, capture_output=True, text=True,
                          check=True).stdout  # fmt: skip
    assert set(said.split()) >= {str((folder / name).resolve()) for name in ("toys.py", "my_code.py", "program.py")}


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("x = 1", "defines no class derived from benchmarks.peers.Adapter or Program"),
        ("import no_such_package", "cannot be imported: ModuleNotFoundError"),
        ("from benchmarks.peers import Adapter\nclass Empty(Adapter): pass", "Empty: solves nothing"),
        ("from benchmarks.peers import Program\nclass Lost(Program): command = ('no-such-program',)",
         "there is no program 'no-such-program'"),
    ],
    ids=["nothing", "unimportable", "empty", "no program"],
)  # fmt: skip
def test_a_file_that_brings_nothing_is_refused_before_any_work(text, words, tmp_path):
    """By its name, with what is wanted."""
    (tmp_path / "bad.py").write_text(text, encoding="utf-8")
    said = python("reports", SCENE, "--solver", tmp_path / "bad.py", "--out", tmp_path / "out", code=2)
    assert words in said and "bad.py" in said, said
    assert not (tmp_path / "out" / "results" / "scene_taut_polyester.json").exists()
