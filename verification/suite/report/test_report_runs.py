"""Does a report that is interrupted, repeated or compared keep what it has, and only what is right?"""

from __future__ import annotations

import contextlib
import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from solvers import Scene
from verification import ROOT

LONGEST = 60  # s that any command here may take
ENDS_WITHIN = 5.0  # s in which the children of a killed run are gone

needs_kill = pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="kill -9 is of POSIX systems")


def python(code: str, *arguments, **environment) -> subprocess.CompletedProcess:
    """A program given as text, from the repository's root."""
    command = [sys.executable, "-c", code, *map(str, arguments)]
    return subprocess.run(
        command, cwd=ROOT, env=os.environ | environment, capture_output=True, text=True, timeout=LONGEST
    )


def report(*arguments) -> subprocess.CompletedProcess:
    command = [sys.executable, "-m", "reports", *map(str, arguments)]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=LONGEST)


def wait_for(condition, seconds: float = LONGEST / 2):
    """Wait until ``condition()`` holds and return what it gives."""
    end = time.monotonic() + seconds
    while not (result := condition()):
        assert time.monotonic() < end, f"not within {seconds:g} s"
        time.sleep(0.02)
    return result


# ---------------------------------------------------------------- planted stages, killed in the middle
STAGE = """
import pathlib, subprocess, sys, time
number, part, beats, pause = int(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3], float(sys.argv[4])
beat = "import sys, time\\nwhile True:\\n    open(sys.argv[1], 'a').write('.'); time.sleep(0.02)"
child = subprocess.Popen([sys.executable, "-c", beat, beats])
text = "".join(f"{number} {line}\\\\n" for line in range(1000))
with part.open("w") as file:
    file.write(text[: len(text) // 2])
    file.flush()
    for step in range(10):
        time.sleep(pause / 10)
        print("progress", step, 10, flush=True)
    file.write(text[len(text) // 2 :])
child.kill()
"""
"""A stage that does not write atomically and has a child of its own, which tells that it lives."""

RUN = """
import pathlib, sys
from reports.pipeline.running.runner import run_all
from reports.pipeline.stages import Stage
folder, pause = pathlib.Path(sys.argv[1]), sys.argv[2]
stages = [Stage(f"s{i}", "tests", f"stage {i}", ("planted_stage", str(i), "{part}", str(folder / "beats"), pause),
                f"deep/{i}.txt", timed=i > 3, seconds=1.0) for i in range(6)]
print(*(f"{end.stage.name} {end.state}" for end in run_all(stages, folder, False)), sep="\\n")
"""


@pytest.fixture
def planted(tmp_path):
    """(start, folder): starts a run of six planted stages with their results in the folder."""
    (tmp_path / "planted_stage.py").write_text(STAGE.replace("\\\\n", "\\n"))

    def start(folder, pause=0.2):
        folder.mkdir(exist_ok=True)
        command = [sys.executable, "-c", RUN, str(folder), str(pause)]
        environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")])}
        return subprocess.Popen(command, cwd=ROOT, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                encoding="utf-8")  # fmt: skip

    return start


def outputs(folder: Path) -> dict[str, str]:
    return {path.name: path.read_text() for path in (folder / "deep").glob("*.txt")}


def recorded(folder: Path) -> list[Path]:
    """Results that the ledger knows: one that is not in it yet when a run is killed is made again."""
    ledger = folder / "stages.json"
    known = json.loads(ledger.read_text(encoding="utf-8")) if ledger.exists() else {}
    return [folder / "deep" / f"{name[1:]}.txt" for name in known]


def states(run: subprocess.Popen) -> list[str]:
    out, err = run.communicate(timeout=LONGEST)
    assert run.returncode == 0, err
    return [line.split()[1] for line in out.splitlines()]


def silent(path: Path) -> bool:
    """Nobody has written to the file for half a second."""
    before = path.stat().st_size
    time.sleep(0.5)
    return path.stat().st_size == before


@needs_kill
def test_killed_run_goes_on_where_it_was(tmp_path, planted):
    """kill -9 at four places, each in the middle of a half-written file: no child lives on, nothing finished is run
    again, no half file is taken as a result, and in the end all is as after an undisturbed run."""
    whole, folder = tmp_path / "whole", tmp_path / "killed"
    assert states(planted(whole)) == ["measured"] * 6
    kept: dict[Path, int] = {}
    for finished in range(4):
        run = planted(folder, pause=0.4)
        wait_for(lambda done=finished: len(recorded(folder)) > done and list((folder / "deep").glob("*.part")))
        run.kill()
        run.communicate()
        wait_for(lambda: silent(folder / "beats"), ENDS_WITHIN)
        assert all(path.stat().st_mtime_ns == stamp for path, stamp in kept.items())
        kept = {path: path.stat().st_mtime_ns for path in recorded(folder)}
        assert outputs(folder).items() <= outputs(whole).items()
    ended = states(planted(folder, pause=0.4))
    assert ended.count("reused") >= 4 and set(ended) <= {"reused", "measured"}
    assert outputs(folder) == outputs(whole) and len(outputs(whole)) == 6
    assert not list(folder.rglob("*.part")) and not list(folder.rglob("*.tmp"))
    assert states(planted(folder, pause=0.4)) == ["reused"] * 6


ENDS = {"by itself": "os._exit(3)", "its output closed": "print(flush=True)"}
"""What a stage does without end while its child lives: it is over at once, or as soon as its report is killed, before
anybody can have told it so."""


@needs_kill
@pytest.mark.parametrize("how", ENDS)
def test_a_stage_that_ends_first_leaves_no_child(tmp_path, planted, how):
    """Its report sees it failed and goes on, or was killed; in both cases what the stage started ends too."""
    stage = tmp_path / "planted_stage.py"
    start, _ = stage.read_text().split("text = ", 1)
    stage.write_text(f"import os\n{start}\nwhile True:\n    pathlib.Path(beats).exists() and {ENDS[how]}\n")
    run = planted(tmp_path / "run")
    beats = tmp_path / "run" / "beats"
    if how == "by itself":
        assert states(run) == ["failed"] * 6
    else:
        wait_for(beats.exists)
        run.kill()
        run.communicate()
    wait_for(lambda: silent(beats), ENDS_WITHIN)


@needs_kill
@pytest.mark.parametrize("signalled", [signal.SIGTERM, signal.SIGINT])
def test_a_terminated_guard_ends_its_stage(tmp_path, planted, signalled):
    """The stage, its child, and the output that a report would wait for; the status is that of shells."""
    beats, part = tmp_path / "beats", tmp_path / "part"
    command = [
        sys.executable,
        "-m",
        "reports.pipeline.running.process_group",
        "beside",
        "planted_stage",
        "0",
        part,
        beats,
        str(LONGEST),
    ]
    environment = os.environ | {"PYTHONPATH": str(tmp_path)}
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    with subprocess.Popen(command, cwd=ROOT, env=environment, start_new_session=True, **pipes) as guard:
        wait_for(beats.exists)
        guard.send_signal(signalled)
        guard.communicate(timeout=ENDS_WITHIN)
    assert guard.returncode == 128 + signalled
    wait_for(lambda: silent(beats), ENDS_WITHIN)


@needs_kill
def test_result_that_was_cut_is_made_again(tmp_path, planted):
    """A result file that is not as it was written (cut by a full disk, edited) is not valid, whatever its record."""
    states(planted(tmp_path / "run"))
    path = tmp_path / "run" / "deep" / "2.txt"
    whole = path.read_text()
    path.write_text(whole[:100])
    assert states(planted(tmp_path / "run")) == ["reused", "reused", "measured", "reused", "reused", "reused"]
    assert path.read_text() == whole


@needs_kill
def test_timings_run_alone(tmp_path, planted):
    """Two stages that time nothing run beside each other where there are two cores; timings never beside anything."""
    run = planted(tmp_path / "run")
    _, log = run.communicate(timeout=LONGEST)
    events = re.findall(r": stage (\d)( \.\.\.)?", log)
    under_way, most = set(), 0
    for number, begins in events:
        if begins:
            assert not under_way or (int(number) <= 3 and max(map(int, under_way)) <= 3), log
            under_way.add(number)
        else:
            under_way.discard(number)
        most = max(most, len(under_way))
    assert len(events) == 12 and most >= min(2, len(os.sched_getaffinity(0)))


@needs_kill
def test_two_reports_in_one_folder_are_refused(tmp_path, planted):
    """A second run in the same folder says so and changes nothing; the first goes on."""
    first = planted(tmp_path / "run", pause=0.5)
    wait_for(lambda: list((tmp_path / "run").glob("deep/*.part")))
    second = planted(tmp_path / "run")
    _, err = second.communicate(timeout=LONGEST)
    assert second.returncode == 1 and "another report is being made in" in err
    assert states(first) == ["measured"] * 6


# ---------------------------------------------------------------- the report itself, killed
def without_machine(folder: Path) -> dict[str, str]:
    """The pages but that on machine, dates and times."""
    pages = {path.name: path.read_text(encoding="utf-8") for path in folder.glob("*.html")}
    assert '<h2 id="machine">' in pages.pop("machine.html")
    return pages


@needs_kill
def test_killed_report_ends_in_the_same_page(tmp_path, deep):
    """`python -m reports --only published`, killed after its first result, then again: the same results, byte for byte,
    and the same pages apart from that on machine, dates and times."""
    if not deep:
        pytest.skip("three whole pages: with --deep")
    arguments = ("--only", "machine", "published", "--out")
    run = report(*arguments, tmp_path / "whole")
    assert run.returncode == 0, run.stderr
    command = [sys.executable, "-m", "reports", *arguments, str(tmp_path / "killed")]
    process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    results = tmp_path / "killed" / "results"
    wait_for(lambda: (results / "stages.json").exists() and "scene_" in (results / "stages.json").read_text())
    process.kill()
    process.wait()
    entries = json.loads((results / "stages.json").read_text(encoding="utf-8"))
    recorded = [results / f"{name}.json" for name, entry in entries.items() if "scene_" in name and entry.get("key")]
    kept = {path: path.stat().st_mtime_ns for path in recorded}
    assert kept and not (tmp_path / "killed" / "index.html").exists()
    again = report(*arguments, tmp_path / "killed")
    assert again.returncode == 0, again.stderr
    assert all(path.stat().st_mtime_ns == stamp for path, stamp in kept.items())
    pages = [tmp_path / name for name in ("whole", "killed")]
    names = [sorted(path.relative_to(page).as_posix() for path in page.rglob("*") if path.is_file()) for page in pages]
    assert names[0] == names[1] and any(name.startswith("results/scene_") for name in names[0])
    for name in names[0]:
        if re.match(r"results/scene_|tables/|figures/", name):
            assert (pages[0] / name).read_bytes() == (pages[1] / name).read_bytes(), name
    assert without_machine(pages[0]) == without_machine(pages[1])


# ---------------------------------------------------------------- reference data, killed
FEW = """
import itertools, sys
from reference_data import __main__ as program
from reference_data.generate import spans
from pathlib import Path
rows = list(itertools.islice(spans.design(), 0, None, 40))
spans.design = lambda: rows
program.HERE = Path(sys.argv[1])
sys.exit(program.main(["regenerate", "--only", "spans", "--jobs", "2"]))
"""
"""The program itself, every fortieth row of its design, the data in a folder of the test."""


def regeneration(folder: Path) -> subprocess.Popen:
    folder.mkdir(exist_ok=True)
    return subprocess.Popen([sys.executable, "-c", FEW, str(folder)], cwd=ROOT, stderr=subprocess.PIPE,
                            stdout=subprocess.DEVNULL, encoding="utf-8", start_new_session=True)  # fmt: skip


def members(group: int) -> list[str]:
    """Processes of a process group that are not over."""
    run = subprocess.run(["ps", "-eo", "pgid=,stat=,pid="], capture_output=True, text=True, check=True).stdout
    return [pid for pgid, stat, pid in map(str.split, run.splitlines()) if int(pgid) == group and stat[0] != "Z"]


@needs_kill
def test_killed_regeneration_loses_the_cut_line_only(tmp_path):
    """kill -9 among the rows, and the last line of the log cut in the middle: the processes of the pool end too, every
    other row is kept and computed no more, and the table is that of an undisturbed run."""
    whole, killed = tmp_path / "whole", tmp_path / "killed"
    _, shown = (run := regeneration(whole)).communicate(timeout=LONGEST)
    assert run.returncode == 0, shown
    run, log = regeneration(killed), killed / "spans" / "data.partial.tmp"
    wait_for(lambda: log.exists() and len(log.read_text(encoding="utf-8").splitlines()) > 4)
    assert len(members(run.pid)) > 2
    run.kill()
    run.wait()
    try:
        wait_for(lambda: not members(run.pid), ENDS_WITHIN)
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(run.pid, signal.SIGKILL)
        run.stderr.close()
    assert not (killed / "spans" / "data.csv").exists()
    text = log.read_text(encoding="utf-8")
    log.write_text(text[: text.rindex("{") + 40], encoding="utf-8")
    kept = text.count("{") - 1
    _, shown = (run := regeneration(killed)).communicate(timeout=LONGEST)
    assert run.returncode == 0, shown
    table = (whole / "spans" / "data.csv").read_bytes()
    rows = table.decode().count("\n") - 1
    assert (killed / "spans" / "data.csv").read_bytes() == table and rows > 10
    assert f"/{rows - kept} " in shown, shown  # of the progress bar: rows that were left to compute
    assert not list(tmp_path.rglob("*.tmp"))


# ---------------------------------------------------------------- comparisons
RUN_A = {"commit": "a1", "machine": "one", "date": "1", "packages": {}, "failed": [],
         "times": {"benchmark | case": [1.0, 0.9, 1.1]} | {f"work ours | {i}": [1.0 + 0.1 * i] for i in range(8)},
         "errors": {"accuracy | x": [1e-9, 1e-13], "accuracy | y": [1e-16, 1e-13]},
         "states": {"tests | t": "passed", "accuracy | x": "right"}}  # fmt: skip


@pytest.mark.parametrize(
    ("part", "change", "code", "says"),
    [
        ("times", {}, 0, "nothing is worse"),
        ("times", {"benchmark | case": [2.0, 1.8, 2.2]}, 1, "slower: 1"),
        ("times", {"benchmark | case": [1.6, 1.0, 2.2]}, 0, "nothing is worse"),  # within its spread
        ("times", {"benchmark | case": [1.25, 1.2, 1.3]}, 0, "nothing is worse"),  # within the threshold
        ("times", {f"work ours | {i}": [2.0 + 0.2 * i] for i in range(8)}, 1, "work ours, 8 timings"),
        ("times", {"work ours | 3": [9.0]}, 0, "nothing is worse"),  # one interruption among many
        ("times", {"benchmark | case": [0.5, 0.4, 0.6]}, 0, "faster: 1"),
        ("errors", {"accuracy | x": [3e-9, 1e-13]}, 1, "less accurate: 1"),
        ("errors", {"accuracy | y": [9e-15, 1e-13]}, 0, "nothing is worse"),  # rounding
        ("states", {"tests | t": "failed"}, 1, "failed: 1"),
        ("states", {"accuracy | x": "wrong"}, 1, "right -> wrong"),
        ("states", {"tests | new": "failed"}, 1, "not there -> failed"),
    ],
)
def test_comparison_sees_what_is_worse_and_no_noise(tmp_path, part, change, code, says):
    """Planted: a slow-down, a lost digit and a failure alarm with status 1; what is within the spread does not."""
    for name, run in (("a", RUN_A), ("b", RUN_A | {"commit": "b2", part: RUN_A[part] | change})):
        (tmp_path / f"{name}.json").write_text(json.dumps(run))
    result = report("compare", tmp_path / "a.json", tmp_path / "b.json")
    assert result.returncode == code, result.stdout + result.stderr
    assert says in result.stdout


def test_times_of_two_machines_are_not_compared(tmp_path):
    """They are marked, and errors and outcomes are compared all the same."""
    slow = RUN_A | {"machine": "two", "times": {"benchmark | case": [9.0, 9.0, 9.0]}}
    for name, run in (("a", RUN_A), ("b", slow)):
        (tmp_path / f"{name}.json").write_text(json.dumps(run))
    result = report("compare", tmp_path / "a.json", tmp_path / "b.json")
    assert result.returncode == 0 and "different machines" in result.stdout


def test_comparison_of_what_is_not_there(tmp_path):
    """Status 2 and a sentence; without any run, the list says how to get one."""
    run = report("compare", "no-such-commit", "--out", tmp_path)
    assert run.returncode == 2 and "no file and no saved commit" in run.stderr and "Traceback" not in run.stderr
    run = report("compare", "--out", tmp_path)
    assert run.returncode == 0 and "nothing is saved" in run.stdout


# ---------------------------------------------------------------- pictures, beside the drawing
PICTURES = """
import pathlib, sys, time
from reports.drawing import background
folder, bad = pathlib.Path(sys.argv[1]), int(sys.argv[2])

def write(i):
    time.sleep(0.05)
    (folder / f"{i}.png").write_text(str(i // (i != bad)))

for i in range(9):
    background.start(lambda: write(i))
background.finish()
print("whole")
"""


@pytest.mark.parametrize(("bad", "code"), [(-1, 0), (4, 1)])
def test_a_picture_that_fails_stops_the_page(tmp_path, bad, code):
    """All pictures are there when the page is finished; where one could not be written there is no page."""
    run = python(PICTURES, tmp_path, bad)
    assert run.returncode == code, run.stderr
    assert (run.stdout == "whole\n") == (code == 0)
    assert (len(list(tmp_path.glob("*.png"))) == 9) == (code == 0)
    assert ("ZeroDivisionError" in run.stderr) == (code == 1)


SECTIONS = """
import os, signal, time
from reports.drawing import background

begin = background._stay
def begin_late():  # in one process of two, which is ended before it has begun
    if os.getpid() % 2:
        time.sleep(0.1)
    begin()

background._stay = begin_late
signal.signal(signal.SIGTERM, signal.default_int_handler)  # as the program has it
for _ in range(20):
    assert background.for_each(lambda i: i, 4) == [0, 1, 2, 3]
"""


def test_processes_end_without_a_word():
    """Those that build sections are ended when all is built, one that is late to begin too, and show no traceback."""
    run = python(SECTIONS)
    assert (run.returncode, run.stderr) == (0, "")


# ---------------------------------------------------------------- what cannot be done
SCENE = "reference_data/scenes/shallow_chain.toml"


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--only", "accuracy", SCENE), f"{SCENE} stands among the stages: put scene files before --only"),
        ((SCENE, "--only", "accuracy"), "of the stages machine, scenes of this page, --only names none"),
        (("--only", "acuracy"), "unknown stage 'acuracy'; the stages are tests, machine, accuracy"),
        (("--out", "{file}/below"), "below: no results can be written there (Not a directory): give another"),
    ],
)
def test_impossible_runs_end_with_a_sentence(tmp_path, arguments, says):
    """Status 2, what is wrong and what to do instead; nothing is measured and no page written."""
    (tmp_path / "file").touch()
    words = [word.format(file=tmp_path / "file") for word in arguments]
    run = report("--out", tmp_path / "out", *words)
    assert run.returncode == 2 and says in " ".join(run.stderr.split()), run.stderr
    assert "Traceback" not in run.stderr and not list(tmp_path.rglob("*.html"))


def test_a_command_is_shown_with_its_real_folders():
    """Below the working folder as seen from there; elsewhere, beside it too, whole."""
    code = ("import sys; from reports.pipeline.stages import *; "
            "print(scene_stage(Path(sys.argv[1])).command_line(Path(sys.argv[2])))")  # fmt: skip
    for scene, out in ((f"{ROOT}-lines/a.toml", f"{ROOT}-out"), ("/lines/a.toml", "/out")):
        assert python(code, scene, out).stdout.strip() == f"python -m benchmarks.scenes.measure {scene} --out {out}"
    inside = python(code, str(ROOT / "a.toml"), str(ROOT / "mooring-report")).stdout.strip()
    assert inside == "python -m benchmarks.scenes.measure a.toml --out mooring-report"


def test_one_example_moves_and_the_quick_report_waits_for_none():
    """Of the scenes that the whole page shows one has a motion; its seconds are not spent by --quick."""
    code = (
        "from reports.pipeline.stages import *; print(*(f'{s.arguments[1]} {s.group in SLOW}' for s in plan(False, []) "
    )
    words = python(code + "if s.name.startswith('scene_')))").stdout.split()
    pairs = zip(words[::2], words[1::2], strict=True)
    results = [(Scene.load(path).motion is not None, late == "True") for path, late in pairs]
    assert len(results) >= 4 and results.count((True, True)) == 1 and results.count((False, False)) == len(results) - 1


# ---------------------------------------------------------------- the tests that a page names
CLAIMS = """
import json
from reports.page.registry import claimed_tests
from reports.pipeline.stages import ELSEWHERE, stages_of_claims
plans = {quick: [(s.arguments, s.better) for s in stages_of_claims(claimed_tests(), quick) if s.runs]
         for quick in (0, 1)}
print(json.dumps([sorted(t for t in claimed_tests() if t.partition(".py")[0] not in ELSEWHERE), plans]))
"""


def test_the_report_runs_every_test_that_its_page_names():
    """Each is run by itself or within its file; --quick leaves some out, for which the whole run's outcome serves."""
    claimed, plans = json.loads(python(CLAIMS).stdout)
    ran = {word.removeprefix("{root}/verification/") for words, _ in plans["0"] for word in words}
    missing = lambda ran: [test for test in claimed if not {test, test.partition("::")[0]} & ran]
    assert len(claimed) > 50 and missing(ran) == []
    quick = {word.removeprefix("{root}/verification/") for words, _ in plans["1"] for word in words}
    assert 0 < len(missing(quick)) <= 10
    serving = [words for arguments, better in plans["1"] for words in (arguments, *better)]
    assert all(words in serving for words, _ in plans["0"])


RECORDED = """
import sys
from dataclasses import replace
from pathlib import Path
from reports.pipeline.dependencies import ledger
from reports.pipeline.running.pytest_results import digest_sources, record_outcomes
from reports.pipeline.stages import Stage

folder, cases, before = Path(sys.argv[1]), sys.argv[2].split(), sys.argv[3] or digest_sources()
files = "verification/io/test_scene.py", "verification/io/test_map_file.py"
whole = Stage("two", "tests", "two files", ("pytest", "two files"), "tests/two.xml", files, codes=(0, 1))
one = replace(whole, name="one", arguments=("pytest", "one claim"), output="tests/one.xml", programs=files[:1],
              better=(("pytest", "one file"),))
xml = "".join(f'<testcase file="{file}" name="test_x" time="0.5">{"<failure/>" * (word == "failed")}</testcase>'
              for word, file in zip(cases, files))
(folder / "pytest.xml").write_text(f"<testsuites><testsuite>{xml}</testsuite></testsuites>")
count = record_outcomes(folder / "pytest.xml", folder / "results", [whole, one], before)
known = ledger.Ledger(folder / "results")
print(count, known.current(whole), known.current(one), known.valid(one))
"""


@pytest.mark.parametrize(
    ("outcomes", "before", "says"),
    [
        ("passed passed", "", "2 True True True"),
        ("passed", "", "1 False True True"),  # one file of two ran: no result of both
        ("passed failed", "", "2 False True True"),  # of both a result, but none to be reused
        ("failed passed", "", "2 False False True"),
        ("passed passed", "sources edited during the run", "0 False False False"),
    ],
)
def test_outcomes_of_pytest_are_taken_for_whole_files_of_the_same_sources(tmp_path, outcomes, before, says):
    """What passed is not run again, though the report would run less of it; failures and edits are no result."""
    (tmp_path / "results").mkdir()
    run = python(RECORDED, tmp_path, outcomes, before)
    assert run.stdout.strip() == says, run.stderr


# ---------------------------------------------------------------- what a result depends on
def test_results_depend_on_what_is_imported():
    """Timings of lines need neither networks nor templates; what names a folder or a program needs it."""
    code = (
        "from reports.pipeline.dependencies.sources import *; import sys, json; "
        "print(json.dumps(depends_on([program(sys.argv[1])])))"
    )
    results = {name: json.loads(python(code, name).stdout) for name in ("benchmarks.catenary.speed", "reports")}
    assert {"solvers/catenary/span.py", "benchmarks/run/harness.py", "benchmarks/peers/moorpy.py",
            "reference_data/spans/data.csv"} <= set(results["benchmarks.catenary.speed"])  # fmt: skip
    assert not [
        name for name in results["benchmarks.catenary.speed"] if "network.py" in name or name.startswith("reports")
    ]
    assert {"reports/page/templates/index.html.j2", "benchmarks/catenary/accuracy.py"} <= set(results["reports"])


USED = """
import importlib, json, sys
from pathlib import Path
from reports.pipeline.dependencies.sources import PACKAGES, ROOT, SUFFIXES
used, seen = set(), set()

def note(file):
    path = Path(file)
    if path.is_relative_to(ROOT) and path.relative_to(ROOT).parts[0] in PACKAGES:
        used.add(path.relative_to(ROOT).as_posix())

def opened(event, arguments):
    if event == "open" and isinstance(arguments[0], str) and Path(arguments[0]).suffix in SUFFIXES - {".py"}:
        note(Path(arguments[0]).absolute())

def called(frame, event, _):
    if event == "call" and frame.f_code not in seen and frame.f_code.co_name != "<module>":
        seen.add(frame.f_code)
        note(frame.f_code.co_filename)

name, *arguments = sys.argv[1:]
if name == "pytest":
    importlib.import_module(arguments[0].removesuffix(".py").replace("/", "."))
    arguments += ["-W", "ignore:Module already imported:pytest.PytestAssertRewriteWarning"]
program = importlib.import_module(name)
sys.addaudithook(opened)
sys.setprofile(called)
code = program.main(arguments)
sys.setprofile(None)
print("", json.dumps(sorted(used)), code, sep="\\n")
"""
"""Runs a program and prints the project's files that it really used: those it opened, and those with a function that it
called after its imports (that `from solvers import Span` also loads what Span does not need is no use of it)."""

RUNS = {
    "forces": ("benchmarks.scenes.measure", "reference_data/scenes/shallow_chain.toml", "--forces"),
    "scene": ("benchmarks.scenes.measure", "reference_data/scenes/shallow_chain.toml"),
    "dynamics": ("benchmarks.cable.measure", "--parts", "profile", "growth", "--quick"),
    "tests": ("pytest", "verification/io/test_network_scene.py"),
}


LOADED = ("verification/conftest.py", "verification/conformance/plugin.py")  # by pytest, by itself


def closure(*roots: str) -> set[str]:
    """What the report takes a result to depend on."""
    code = "import sys, json; from reports.pipeline.dependencies.sources import depends_on; "
    code += "print(json.dumps(depends_on(sys.argv[1:])))"
    return set(json.loads(python(code, *roots).stdout))


def test_timings_of_spans_do_not_depend_on_cables():
    """The harness asks no module that imports all solvers, as for the version: their results stay good."""
    assert not [path for path in closure("benchmarks/run/harness.py") if path.startswith("solvers/cable/")]


@pytest.mark.parametrize("name", RUNS)
def test_every_file_that_is_used_is_one_that_the_result_depends_on(request, tmp_path, name):
    """What programs open and call while they run is in what was found by reading them; to a closure of other programs
    the same files are strange, so that a missing one is seen."""
    if name != "forces" and not request.config.getoption("--deep"):
        pytest.skip("longer runs: with --deep")
    program, *arguments = RUNS[name]
    out = () if program == "pytest" else ("--out", tmp_path)
    run = python(USED, program, *arguments, *out)
    used, code = run.stdout.splitlines()[-2:]
    assert code.endswith("0"), run.stdout + run.stderr
    words = (program.replace(".", "/") + ".py", *arguments, *(LOADED if program == "pytest" else ()))
    files = [word for word in words if (ROOT / word).is_file()]
    assert set(json.loads(used)) <= closure(*files)
    strange = set(json.loads(used)) - closure("benchmarks/run/machine.py")
    assert {"solvers/catenary/span.py", "solvers/numerics/lu/bordered.py"} & strange


REFUSING = """
import pathlib, sys
from reports.pipeline.running.runner import run_all
from reports.pipeline.stages import Stage
folder, mine, other = (pathlib.Path(word) for word in sys.argv[1:])
stages = [Stage(name, group, name, ("refusing_stage",), f"{name}.txt", sources=(str(file), "beside.csv"), timed=timed)
          for name, group, file, timed in (("sea", "load_cases", mine, False), ("rest", "scenes", mine, True),
                                           ("another", "scenes", other, True), ("tests", "tests", mine, True))]
print(*(f"{end.stage.name} {end.tail[0]}" for end in run_all(stages, folder, False)), sep="\\n")
"""


def test_a_file_that_is_refused_is_not_tried_by_other_stages(tmp_path):
    """The first stage says why, for those about the same file as well; stages about others run."""
    (tmp_path / "refusing_stage.py").write_text(
        f"import os, sys\nprint(os.getpid())\nopen({str(tmp_path / 'runs')!r}, 'a').write('x')\nsys.exit(2)\n"
    )
    folder = tmp_path / "results"
    folder.mkdir()
    run = subprocess.run(
        [sys.executable, "-c", REFUSING.replace("\\\\n", "\\n"), folder, tmp_path / "mine", tmp_path / "other"],
        cwd=ROOT, env=os.environ | {"PYTHONPATH": str(tmp_path)}, capture_output=True, text=True, timeout=LONGEST,
        check=False)  # fmt: skip
    assert run.returncode == 0, run.stderr
    statuses = dict(line.split() for line in run.stdout.splitlines())
    assert statuses["sea"] == statuses["rest"] and len({statuses["sea"], statuses["another"], statuses["tests"]}) == 3
    assert (tmp_path / "runs").read_text() == "xxx"
