"""Codes that a reader brings: do they run beside ours, right, wrong and refused, each with its words?"""

from __future__ import annotations

import csv
import os
import re
import subprocess
import sys
import time
from importlib.resources import files
from pathlib import Path

import pytest

from solvers import solve_periodic
from solvers.common.motions.motion import Ramped
from verification.cases.spans import NAMED
from verification.registry import last_period_tension

from .. import peers
from ..cable import work_precision as dynamic_work
from ..cable.cases import Reference, system
from ..network import accuracy as network_accuracy
from . import harness

ROOT = Path(str(files("benchmarks"))).parent
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
    answer = MyCode().span(SimpleNamespace(**asked), asked["tolerance"])
    print(json.dumps({"H": answer.H, "V": answer.V, "iterations": answer.iterations}))
except NotImplementedError as error:
    print(json.dumps({"unsupported": str(error)}))
"""

WHOLE = """
import json, sys

import numpy as np

from solvers import (CableProperties, Element, Environment, Network, Node, SampledMotion, Scene, cable_system,
                     solve_network, solve_time_domain)

asked = json.load(sys.stdin)
if asked["problem"] == "network":
    water = Environment(asked["rho"], asked["g"], asked["depth"])
    parts = [Node(**node) for node in asked["nodes"]], [Element(**element) for element in asked["elements"]]
    state = solve_network(Network(*parts, water))
    tension = np.column_stack([np.hypot(state.H_anchor, state.V_anchor), np.hypot(state.H, state.V)])
else:
    cable = CableProperties(*(asked[key] for key in ("EA", "diameter", "mass_per_length", "w")),
                            **{key: asked[key] for key in ("Cdn", "Cdb", "Cdt", "Ca", "damping")})
    water = Environment(asked["rho"], asked["g"], asked["depth"], current=asked["current"],
                        seabed_stiffness=asked["seabed_stiffness"])
    time, places = np.array(asked["time"]), np.array(asked["fairlead"])
    scene = Scene("asked", cable, asked["length"], tuple(asked["anchor"]), tuple(places[0].tolist()), water)
    chain = cable_system(scene, asked["cells"] + 1, motion=SampledMotion(time, places - places[0]))
    history = solve_time_domain(chain, dt=time[1], duration=time[-1])
    tension = history.fairlead_tension(time)
print(json.dumps({"tension": (FACTOR * tension).tolist()}))
"""
LINE = NAMED[0]
NETWORK, CABLE = "two lines, 59.1 N/m", "case_1"
MOVED = 5e-3  # rms over the range: 40 cells and 100 steps in a period, second order

TOYS = """
import sys

from benchmarks.peers import Program, SpanAnswer
from my_code import MyCode

class TwoPercent(MyCode):
    label = "two per cent more"

    def span(self, case, tolerance=None):
        answer = super().span(case, tolerance)
        return SpanAnswer(1.02 * answer.H, 1.02 * answer.V)

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


def python(*words, code=0, **variables):
    """What a command prints; its exit status is ``code``."""
    environment = {name: value for name, value in os.environ.items() if name != "MOORING_SOLVERS"}
    environment |= {name: str(value) for name, value in variables.items()}
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
        assert row["answer"] == verdict and words in row["message"], row
        if verdict != "refused":
            assert float(row["seconds"]) > 0 and (float(row["error"]) < ROUNDED) == (verdict == "right"), row
    page = (tmp_path / "scene-taut_polyester.html").read_text(encoding="utf-8")
    assert all(label in page for label in EXPECTED) and "no more memory" in page


def test_the_example_of_the_readme_is_short_and_listed(folder):
    """A complete adapter in less than 30 lines; verification/suite/conformance/test_conformance.py judges it."""
    assert len(example().splitlines()) < MOST_LINES
    run = python("benchmarks.peers", MOORING_SOLVERS=folder / "my_code.py")
    assert "my catenary 0.1 (mycode) solves span\n" in run


def test_its_files_are_what_results_depend_on(folder):
    """A result belongs to the files that were brought, and to those that they import and call."""
    code = (
        "import sys, pathlib; from reports.pipeline.external_solvers import sources; "
        "print(*sources(pathlib.Path(sys.argv[1])))"
    )
    run = subprocess.run([sys.executable, "-c", code, folder / "toys.py"], cwd=ROOT, capture_output=True, text=True,
                          check=True).stdout  # fmt: skip
    assert set(run.split()) >= {str((folder / name).resolve()) for name in ("toys.py", "my_code.py", "program.py")}


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("x = 1", "defines no class derived from verification.conformance.Adapter or Program"),
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
    run = python("reports", SCENE, "--solver", tmp_path / "bad.py", "--out", tmp_path / "out", code=2)
    assert words in run and "bad.py" in run, run
    assert not (tmp_path / "out" / "results" / "scene_taut_polyester.json").exists()


# ---------------------------------------------------------------- networks and moving cables, programs that end badly
class Whole(peers.Program):
    """This project's own solvers behind a command line, times a factor."""

    problems = ("network", "cable")

    def __init__(self, folder, factor):
        path = folder / "whole.py"
        path.write_text(WHOLE.replace("FACTOR", repr(factor)), encoding="utf-8")
        self.command, self.folder = (sys.executable, str(path)), str(ROOT)


@pytest.mark.parametrize(("factor", "verdict"), [(1.0, "right"), (1.02, "wrong")])
def test_a_network_reaches_a_program_whole(tmp_path, factor, verdict):
    """What it is given is all of the network: its answer is that of the solver itself; 2 % more is wrong."""
    adapter = Whole(tmp_path, factor)
    method = network_accuracy.Method("whole", "whole", {}, adapter)
    (row,) = network_accuracy.ladder(NETWORK, method, (1e-3, 1e-6))  # one point: it takes no tolerance
    assert (row["verdict"], row["error"] < ROUNDED) == (verdict, verdict == "right"), row


@pytest.mark.parametrize(("factor", "right"), [(1.0, True), (1.02, False)])
def test_a_moving_cable_reaches_a_program_whole(tmp_path, factor, right):
    """Section, water and motion: its tension is that of harmonic balance on a fine mesh; 2 % more is told apart."""
    chain = system(CABLE)
    known = Reference(chain.period, last_period_tension(solve_periodic(chain, harmonics=12)), 0.0)
    moved = Ramped(chain.scene.motion, chain.period / 2)
    answer = dynamic_work.ask(Whole(tmp_path, factor), chain.scene, moved, chain.period, (40, 100), periods=2)
    assert answer.kind == "", answer.message
    assert (dynamic_work.errors(known, answer)["rms"] < MOVED) == right


class Shell(peers.Program):
    """A line of shell."""

    def __init__(self, text):
        self.command = ("sh", "-c", text)


@pytest.mark.skipif(os.name != "posix", reason="programs of a POSIX shell")
@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("kill -SEGV $$", "ended by SIGSEGV"),
        ("true", "printed nothing"),
        ("yes", "printed more than 1 MB"),
        ("yes >&2", "printed more than 1 MB"),
        ("echo '{\"H\": 1}'", "returned H = 1, V = None"),
        ('echo \'{"H": "much", "V": 1}\'', "returned H = 'much', V = 1"),
        ('echo \'{"refused": "too slack"}\'', "too slack"),
        ("echo '[1, 2]'", "printed no JSON object: '[1, 2]"),
    ],
)
def test_a_program_that_ends_badly_is_refused_in_words(monkeypatch, text, words):
    """However it ends and whatever it prints, there is a sentence, and soon."""
    monkeypatch.setattr(peers.program, "MOST", 1_000_000)
    adapter = Shell(text)
    solver = harness.Solver("shell", "shell", "", adapter.span, tolerances=False)
    result = harness.ask(solver, LINE)
    assert words in result.refused, result


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="processes are counted in /proc")
def test_a_program_that_takes_too_long_ends_with_all_that_it_started(tmp_path):
    """Nothing of it runs on beside the timings that follow."""
    mark, long = tmp_path / "still-here", f"sleep 60.{os.getpid()}"
    adapter = Shell(f"{long} & {long} & touch {mark}; wait")
    adapter.time_limits = {"span": 0.5}
    solver = harness.Solver("slow", "slow", "", adapter.span, 5.0, False)
    assert harness.ask(solver, LINE).refused == "no answer within 0.5 s"
    assert mark.exists()
    time.sleep(0.1)
    assert long not in commands()


def commands() -> list[str]:
    """Command lines of the processes that are there."""
    results = []
    for path in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            results.append(path.read_bytes().replace(b"\0", b" ").decode(errors="replace").strip())
        except OSError:
            continue  # it has just ended
    return results
