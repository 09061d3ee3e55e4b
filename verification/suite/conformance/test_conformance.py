"""Does the conformance command judge outside solvers rightly: verdicts, mistakes, hangs, crashes, options, files?"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ET
from types import SimpleNamespace

import jsonschema
import numpy as np
import pytest

from solvers import BodyMotion
from solvers.common.motions.motion import Motion, Ramped
from verification import IN_REPOSITORY, ROOT
from verification.conformance import answers, problems
from verification.conformance.adapter import Refused, SpanAnswer
from verification.conformance.judge import (
    INACCURATE,
    REFUSED,
    RIGHT,
    WRONG,
    Match,
    find_mistakes,
    judge,
    measure_error,
)
from verification.conformance.process.loading import load_solver
from verification.conformance.results import report, summary
from verification.conformance.tables import Case, load_table, read_table

LONGEST = 120  # s of one run of the command here
ROUNDING = 1e-13  # relative, of sums of a few products
STATICS = load_table("statics")
COMMAND = ("-m", "pytest", "-p", "verification.conformance.plugin", "-p", "no:cacheprovider", "--pyargs",
           "verification.conformance")  # fmt: skip

NO_OTHER_PLUGINS = {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
"""Half of the time of a short run is the import of plugins that it does not use."""

SOLVERS = """
import os, signal, sys, time
from dataclasses import replace
from math import pi

from verification.conformance import Adapter, SpanAnswer
from verification.conformance.tables import load_table


class Good(Adapter):
    label, version = "good", "1.0"

    def line(self, case):
        return case.inputs()

    def span(self, case, tolerance=None):
        from solvers import Span, solve_span  # here, for it is slow to import

        state = solve_span(Span(**self.line(case)))
        x, z, tension = state.profile(case.s)
        return SpanAnswer(state.H, state.V, H_anchor=state.H_anchor, V_anchor=state.V_anchor,
                          grounded_length=state.grounded_length, stiffness=state.stiffness,
                          profile=list(zip(x, z)), tension=tension)


class NoFriction(Good):
    def line(self, case):
        return case.inputs() | {"friction": 0.0}


class InAir(Good):
    def line(self, case):
        return case.inputs() | {"w": case.mass_per_length * case.g}


class Gravity(Good):
    def line(self, case):
        return case.inputs() | {"w": case.w * 9.81 / case.g}


class FreshWater(Good):
    def line(self, case):
        return case.inputs() | {"w": case.g * (case.mass_per_length - 1000 * pi * case.diameter**2 / 4)}


class Rigid(Good):
    def line(self, case):
        return case.inputs() | {"EA": 1e9 * case.EA}


class KiloNewton(Good):
    def span(self, case, tolerance=None):
        answer = super().span(case)
        scaled = ("H", "V", "H_anchor", "V_anchor", "stiffness", "tension")
        return replace(answer, **{name: getattr(answer, name) / 1000 for name in scaled})


class Swapped(Good):
    def span(self, case, tolerance=None):
        answer = super().span(case)
        return replace(answer, H=answer.H_anchor, V=answer.V_anchor, H_anchor=answer.H, V_anchor=answer.V)


class Downwards(Good):
    def span(self, case, tolerance=None):
        answer = super().span(case)
        return replace(answer, V=-answer.V, V_anchor=-answer.V_anchor)


class Looked(Adapter):  # answers with the truth of the tables, and starts at once
    label, version = "looked up", "1.0"

    def span(self, case, tolerance=None):
        return SpanAnswer(**self.row(case).truth)

    def row(self, case):
        return next(one for one in load_table("statics").cases if one.inputs == vars(case))


class LookedWithoutFriction(Looked):
    def span(self, case, tolerance=None):
        row = self.row(case)
        return SpanAnswer(**row.truth | row.mistakes.get("friction_ignored", {}))


class Rough(Looked):
    def span(self, case, tolerance=None):
        answer = super().span(case)
        return replace(answer, H=answer.H * (1 + 1e-5), V=answer.V * (1 - 1e-5))


class Bad(Looked):
    time_limits = {"span": 0.5}

    def span(self, case, tolerance=None):
        if case.L == 902.2:
            self.fail()
        return super().span(case)


class Hangs(Bad):
    def fail(self):
        time.sleep(1000)


class Crashes(Bad):
    def fail(self):
        print("out of memory", file=sys.stderr, flush=True)
        os.kill(os.getpid(), signal.SIGSEGV)


class Leaves(Bad):
    def fail(self):
        os._exit(0)


class Babbles(Looked):
    def span(self, case, tolerance=None):
        print("solving" * 1000)
        os.write(1, b'{"answer": {"H": 0, "V": 0}}')
        sys.stdout.flush()
        try:
            input()
        except EOFError:
            return super().span(case)


class Nonsense(Looked):
    def span(self, case, tolerance=None):
        return "H is about 5 kN"


class Nothing(Adapter):
    def span(self, case, tolerance=None):
        raise NotImplementedError("lines are not its business")
"""

PROGRAM = """
import json, sys
from types import SimpleNamespace
from my_code import MyCode

asked = json.load(sys.stdin)
try:
    answer = MyCode().span(SimpleNamespace(**asked), asked["tolerance"])
    print("converged", json.dumps({"H": answer.H, "V": answer.V}), sep="\\n")
except NotImplementedError as error:
    print(json.dumps({"unsupported": str(error)}))
"""

MISTAKEN = {
    "NoFriction": "friction_ignored",
    "InAir": "weight_in_air",
    "Gravity": "g_9_81",
    "FreshWater": "rho_1000",
    "Rigid": "elasticity_ignored",
    "KiloNewton": "kN_for_N",
    "Swapped": "ends_swapped",
    "Downwards": "vertical_sign",
}
"""Class of SOLVERS -> the mistake that it makes, by another road than the table."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with solvers, a program and, of a checkout, the adapter that the README prints."""
    folder = tmp_path_factory.mktemp("judged")
    (folder / "codes.py").write_text(SOLVERS, encoding="utf-8")
    (folder / "program.py").write_text(PROGRAM, encoding="utf-8")
    if IN_REPOSITORY:
        text = (ROOT / "README.md").read_text(encoding="utf-8")
        example = re.search(r"<!-- file: my_code.py -->\n```python\n(.*?)```", text, re.DOTALL)[1]
        (folder / "my_code.py").write_text(example, encoding="utf-8")
    return folder


def run(folder, solver, *options, code=0, path=ROOT, **variables):
    """Run the command in the folder; return what it printed and its report. Its exit status is ``code``, None: any."""
    path_of_report = folder / "report.json"
    path_of_report.unlink(missing_ok=True)
    words = [] if solver is None else ["--solver", str(solver)]
    words += (
        [] if solver is None or "--conformance-report" in options else ["--conformance-report", str(path_of_report)]
    )
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST_")}
    environment |= {"PYTHONPATH": str(path)} | ({} if "-n" in options else NO_OTHER_PLUGINS) | variables
    done = subprocess.run([sys.executable, *COMMAND, *words, *map(str, options)], cwd=folder, env=environment,
                          capture_output=True, text=True, timeout=LONGEST)  # fmt: skip
    text = done.stdout + done.stderr
    assert code in (None, done.returncode), text
    return text, json.loads(path_of_report.read_text(encoding="utf-8")) if path_of_report.exists() else None


def rows(report):
    """Return id -> row of a report."""
    return {row["id"]: row for row in report["cases"]}


# ---------------------------------------------------------------- codes that are right, wrong, or worse
def test_a_good_code_is_right_everywhere(folder):
    """All quantities of all cases answered and right; report and badge say so, and the schema takes the report."""
    text, report = run(folder, "codes.py:Good", "--badge", "badge.svg")
    assert report["verdicts"] == {"right": len(STATICS.cases)} and report["passed"], text
    assert report["answered"]["quantities"] == report["answered"]["asked"] == sum(len(c.truth) for c in STATICS.cases)
    assert (report["solver"]["label"], report["set"]) == ("good", STATICS.version) and not report["mistakes"]
    schema = json.loads((ROOT / "verification/conformance/results/report.schema.json").read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator(schema).validate(report)
    badge = ET.parse(folder / "badge.svg").getroot()
    words = " ".join(one.text for one in badge.iter("{http://www.w3.org/2000/svg}text"))
    assert words == f"mooring conformance {STATICS.version} {len(STATICS.cases)} of {len(STATICS.cases)} right"


@pytest.mark.parametrize("name", MISTAKEN)
def test_a_mistake_is_named(folder, name):
    """The mistake that explains most cases is the one that was made, in all faulty ones that have an answer with it."""
    adapter = load_solver(str(folder / f"codes.py:{name}"))
    judgements = [judge(case, answers.ask(adapter, "span", case.inputs), STATICS.mistakes) for case in STATICS.cases]
    faulty = [one.case for one in judgements if one.verdict in summary.FAULTY]
    first = summary.name_mistakes(judgements)[0]
    assert first.name == MISTAKEN[name]
    assert set(first.cases) == {case.id for case in faulty if first.name in case.mistakes}
    assert len(first.cases) > max(5, len(faulty) / 2)  # a taut line has no answer without stretch


def test_friction_that_is_left_out_is_said_by_feature(folder):
    """In the words of the summary and of each failure."""
    text, _ = run(folder, "codes.py:NoFriction", code=1)
    assert re.search(r"friction: \d+ of \d+ wrong, .*all as if there were none", text)
    assert re.search(r"equals the answer without friction to \de-\d\d", text)
    assert "right up to 1e-06, wrong above 1e-03" in text


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("Hangs", "no answer within 0.5 s"),
        ("Crashes", "ended by SIGSEGV: out of memory"),
        ("Leaves", "ended with exit status 0"),
    ],
)
def test_a_hang_and_a_crash_are_judged_and_the_rest_goes_on(folder, name, words):
    """The everyday lines of 902.2 m fail; all others are right, also those after them."""
    text, report = run(folder, f"codes.py:{name}", code=1)
    for case in STATICS.cases:
        row, bad = rows(report)[case.id], case.inputs["L"] == 902.2
        assert (row["verdict"], row["message"]) == (("refused", words) if bad else ("right", "")), row
        assert row["failed"] == (bad and case.group == "everyday")
    assert text.count("FAILED") == sum(row["failed"] for row in report["cases"]) >= 3


def test_what_a_code_prints_and_reads_is_kept_apart(folder):
    """Also where it writes what looks like an answer, past sys.stdout."""
    _, report = run(folder, "codes.py:Babbles", "-k", "oc3")
    assert set(report["verdicts"]) == {"right"}


def test_nonsense_is_refused_and_a_code_that_models_nothing_has_not_passed(folder):
    """Exit status 1, and 5: nothing was judged."""
    _, report = run(folder, "codes.py:Nonsense", "-k", "oc3", code=1)
    assert (
        rows(report)["statics/oc3"]["message"]
        == "returned 'H is about 5 kN', and SpanAnswer(H, V) is wanted, or two numbers"
    )
    _, report = run(folder, "codes.py:Nothing", code=5)
    assert set(report["verdicts"]) == {"not modelled"}


def test_inaccurate_fails_if_strict_alone(folder):
    """With the digits that are reached."""
    _, report = run(folder, "codes.py:Rough", "-k", "oc3-out")
    assert report["verdicts"] == {"inaccurate": 1} and report["passed"]
    text, report = run(folder, "codes.py:Rough", "--strict", "-k", "oc3-out", code=1)
    assert report["strict"] and not report["passed"] and re.search(r"H +inaccurate, 5\.\d digits", text)


# ---------------------------------------------------------------- forms of solvers, levels, files
@pytest.mark.skipif(not IN_REPOSITORY, reason="an installed wheel has no README")
def test_the_adapter_of_the_readme_suffices(folder):
    """Right wherever it answers, as a file and as a program, and so a wheel is tried with it."""
    _, report = run(folder, "my_code.py")
    assert set(report["verdicts"]) == {"right", "not modelled"} and report["verdicts"]["right"] > 12
    text, called = run(folder, f"{sys.executable} program.py", "-k", "oc3-out or oc3-friction-1")
    assert called["levels"] == ["statics"] and called["verdicts"] == {"right": 1, "not modelled": 1}, text


NO_SOLVERS = {
    "none.py": "none.py: a solver is brought as a Python file",
    "codes.py": "defines Good, NoFriction,",
    "codes.py:Best": "there is no class Best",
    "no_such_package:Mine": "cannot be imported: ModuleNotFoundError",
    "json:JSONDecoder": "is no class derived from verification.conformance.Adapter",
    "./no-such-program --json": "there is no program './no-such-program'",
}
"""What a command line may name -> what is wrong with it."""


@pytest.mark.parametrize("solver", NO_SOLVERS)
def test_what_is_no_solver_is_refused_in_words(folder, solver, monkeypatch):
    """Of which the command makes a usage error."""
    monkeypatch.chdir(folder)
    with pytest.raises(ImportError, match=re.escape(NO_SOLVERS[solver])):
        load_solver(solver)


def test_what_is_no_solver_is_refused_before_any_case(folder):
    """A usage error, exit status 4, without a traceback; also where none is named."""
    for solver, words in (("codes.py:Best", "there is no class Best"), (None, "--solver: say which code is to be")):
        text, _ = run(folder, solver, code=4)
        assert words in text and "Traceback" not in text, text


def test_levels_are_those_that_the_code_has(folder):
    """One that it has no method for, and one that there is not, are refused."""
    text, _ = run(folder, "codes.py:Looked", "--level", "statics,motion", code=4)
    assert "--level motion: looked up has no method cable or moving_network" in text
    text, _ = run(folder, "codes.py:Looked", "--level", "statics", "--level", "dynamics", code=4)
    assert "'dynamics' is none of statics, network, motion" in text


def test_expected_failures_are_strict(folder):
    """A case that fails is expected; one that does not is red; an unknown id is refused with the nearest."""
    known = folder / "known.txt"
    known.write_text("# friction\nstatics/oc3-friction-1  # all as if there were none\n", encoding="utf-8")
    text, report = run(folder, "codes.py:LookedWithoutFriction", "--xfails", known, "-k", "oc3-friction-1")
    assert report["passed"] and rows(report)["statics/oc3-friction-1"]["expected_to_fail"] and "1 xfailed" in text
    text, report = run(folder, "codes.py:Looked", "--xfails", known, "-k", "oc3-friction-1", code=1)
    assert "statics/oc3-friction-1: is right and stands in" in text and "line 2: take it out" in text
    assert not report["passed"]
    known.write_text("statics/oc3-fricton-1\n", encoding="utf-8")
    text, _ = run(folder, "codes.py:Looked", "--xfails", known, code=4)
    assert "line 1: there is no case statics/oc3-fricton-1; the nearest is statics/oc3-friction-1" in text


def test_processes_side_by_side_give_the_same_report(folder, deep):
    """pytest -n 2: rows come from both."""
    if not deep:
        pytest.skip("three processes more: with --deep")
    words = ("codes.py:LookedWithoutFriction", "-k", "friction")
    reports = [run(folder, *words, *more, code=1)[1] for more in ((), ("-n", "2"))]
    for row in (row for one in reports for row in one["cases"]):
        row["seconds"] = None
    assert reports[0] == reports[1] and len(reports[0]["cases"]) >= 5


# ---------------------------------------------------------------- as installed, beside nothing and beside others
BLOCKED = """
import os, sys

class Blocked:
    @staticmethod
    def find_spec(name, path=None, target=None):
        if name.partition(".")[0] in {missing}:
            raise ModuleNotFoundError(name, name=name)

if "MISSING" in os.environ:
    sys.meta_path.insert(0, Blocked)
"""
ALONE = {"MISSING": "1", "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}  # a plugin of Hypothesis would import it
ENTRY = "[pytest11]\nverification.conformance.plugin = verification.conformance.plugin\n"


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """What a wheel installs of this command and of benchmarks.peers; with ALONE nothing else can be imported."""
    site = tmp_path_factory.mktemp("site")
    for name in ("verification/conformance", "reference_data/conformance", "benchmarks/peers"):
        shutil.copytree(ROOT / name, site / name, ignore=shutil.ignore_patterns("__pycache__"))
        package = name.partition("/")[0]
        shutil.copy(ROOT / package / "__init__.py", site / package / "__init__.py")
    shutil.copy(ROOT / "verification/conftest.py", site / "verification/conftest.py")
    missing = ("solvers", "numba", "hypothesis", "mpmath", "threadpoolctl")
    (site / "sitecustomize.py").write_text(BLOCKED.format(missing=missing), encoding="utf-8")
    metadata = site / "mooring_conformance-1.dist-info"
    metadata.mkdir()
    (metadata / "METADATA").write_text(
        "Metadata-Version: 2.1\nName: mooring-conformance\nVersion: 1\n", encoding="utf-8"
    )
    (metadata / "entry_points.txt").write_text(ENTRY, encoding="utf-8")
    return site


@pytest.mark.skipif(not IN_REPOSITORY, reason="an installed wheel has no README")
def test_no_solver_of_this_project_is_needed(folder, site):
    """Neither numba nor what the suite's own tests take; the old names of the contract work, too."""
    _, report = run(folder, "my_code.py", path=site, **ALONE)
    assert report["verdicts"]["right"] > 12
    old = (folder / "my_code.py").read_text(encoding="utf-8").replace("verification.conformance", "benchmarks.peers")
    (folder / "old_code.py").write_text(old, encoding="utf-8")
    assert "from benchmarks.peers import Adapter, SpanAnswer" in old
    assert run(folder, "old_code.py", path=site, **ALONE)[1]["verdicts"] == report["verdicts"]


@pytest.mark.parametrize(
    ("package", "name"), [("moorpy", "MoorPy"), ("pycatenary", "PyCatenary"), ("moordyn", "MoorDyn")]
)
def test_peers_are_judged_without_a_solver_of_this_project(folder, site, package, name):
    """They are loaded, and answer; what they answer is for the page of the peers."""
    pytest.importorskip(package)
    solver = f"benchmarks.peers.{package}:{name}"
    level = "motion" if package == "moordyn" else "statics"
    if not (ROOT / "reference_data" / "conformance" / f"{level}.json").is_file():
        pytest.skip(f"there are no cases of level {level}")
    case = load_table(level).cases[0].id
    _, report = run(folder, solver, "--level", level, "-k", case.partition("/")[2], path=site, code=None, **ALONE)
    assert rows(report)[case]["verdict"] not in ("refused", "not modelled"), rows(report)[case]


def test_a_project_with_the_same_options_is_left_alone(folder, site, tmp_path):
    """The plugin is loaded in all runs of pytest where it is installed, and takes part in those that name it."""
    (tmp_path / "conftest.py").write_text(
        "def pytest_addoption(parser):\n"
        "    for name in ('--solver', '--level', '--xfails', '--badge', '--deep'):\n"
        "        parser.addoption(name, default='theirs')\n", encoding="utf-8")  # fmt: skip
    test = "def test(request):\n    assert request.config.getoption('--solver') == 'mine'\n"
    (tmp_path / "test_theirs.py").write_text(test, encoding="utf-8")
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST_")}
    environment["PYTHONPATH"] = str(site)
    words = ["-m", "pytest", "test_theirs.py", "--solver", "mine", "--trace-config"]
    done = subprocess.run([sys.executable, *words], cwd=tmp_path, env=environment, capture_output=True, text=True,
                          timeout=LONGEST)  # fmt: skip
    assert done.returncode == 0 and "1 passed" in done.stdout, done.stdout + done.stderr
    assert str(site / "verification" / "conformance" / "plugin.py") in done.stdout  # it was there


def test_the_plugin_alone_imports_no_numpy():
    """It is imported in every run of pytest where it is installed."""
    code = "import sys, verification.conformance.plugin; print('numpy' in sys.modules, 'solvers' in sys.modules)"
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, timeout=LONGEST
    )
    assert done.stdout == "False False\n", done.stdout + done.stderr


# ---------------------------------------------------------------- judging
def example(level="statics", **changes) -> Case:
    """Return a case of one line with two mistakes, of which the second changes H alone."""
    row = {
        "id": f"{level}/one", "group": "everyday", "title": "one", "features": ["friction"], "inputs": {},
        "truth": {"H": 100.0, "V": 50.0, "tension": [1.0, 2.0]},
        "scale": {"H": 100.0, "V": 100.0, "tension": 100.0},
        "bound": {name: [1e-6, 1e-3] for name in ("H", "V", "tension")},
        "mistakes": {"both": {"H": 120.0, "V": 40.0}, "first": {"H": 120.0}, "third": {"H": 120.0, "V": 40.00001}},
        "without": {"friction": {"H": 110.0}},
    }  # fmt: skip
    return Case(level=level, **row | changes)


@pytest.mark.parametrize(
    ("H", "verdict"),
    [(100.0, RIGHT), (100.00009, RIGHT), (100.00011, INACCURATE), (100.09, INACCURATE), (100.11, WRONG)],
)
def test_verdicts_change_at_the_bounds(H, verdict):
    """An error of 1e-6 of the scale, and of 1e-3."""
    judgement = judge(example(), {"H": H, "V": 50.0})
    assert judgement.verdict == verdict and judgement.unanswered == ("tension",)
    assert judgement.fails() == (verdict == WRONG) and judgement.fails(strict=True) == (verdict != RIGHT)


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        ({"H": float("nan")}, "H = nan"),
        ({"H": "5 kN"}, "H = '5 kN', and a number is wanted"),
        ({"H": "100"}, "H = '100', and a number is wanted"),
        ({"H": [1.0, 2.0]}, "H has the shape (2,), and a number is wanted"),
        ({"H": 100.0, "tension": [1.0]}, "tension has the shape (1,), and numbers of shape (2,) are wanted"),
        ({"H": 100.0, "tension": [1.0, [2.0]]}, "tension is ragged"),
        ({"H": 100.0, "tension": [1.0, float("inf")]}, "tension holds inf"),
        ({"H": True}, "H = True"),
        ({}, "answered none of H, V, tension"),
    ],
)
def test_what_is_no_number_of_the_right_shape_is_refused(answer, words):
    """In words, with the name of the quantity; on an extreme case a refusal does not fail."""
    judgement = judge(example(), answer)
    assert judgement.verdict == REFUSED and words in judgement.words and judgement.fails()
    assert not judge(example(group="extreme"), answer).fails()


def names(answer, **changes):
    """Return the names of the mistakes that an answer to the example matches."""
    return [match.name for match in judge(example(**changes), answer).matches]


def test_a_mistake_matches_in_all_that_it_changes():
    """The one that explains most; several that are alike to the bound; none that contradicts an answer."""
    assert names({"H": 120.0, "V": 50.0}) == ["first"]
    assert names({"H": 120.0, "V": 40.0}) == ["both", "third"]
    assert names({"H": 110.0, "V": 50.0}) == ["without friction"]
    assert names({"H": 130.0, "V": 50.0}) == []
    assert names({"H": 120.1, "V": 50.0}) == ["first"]  # half a percent of what it changes: an error of the code
    assert names({"H": 100.0, "V": 50.0}) == []


def test_a_match_leaves_no_great_error_unexplained():
    """A mistake that changes H alone does not stand for an answer whose V is wrong, too, but beside a small error."""
    mistakes = {"first": {"H": 120.0}}
    (match,) = judge(example(mistakes=mistakes, without={}), {"H": 120.0, "V": 49.0}).matches
    assert (match.quantities, match.complete) == (("H",), False)
    (match,) = judge(example(mistakes=mistakes, without={}), {"H": 120.0, "V": 49.8}).matches
    assert match.complete
    assert judge(example(mistakes=mistakes, without={}), {"H": 120.1, "V": 49.0}).matches == ()


LINE = {"inputs": {"x": 8.0, "z": 3.0}, "mistakes": {}, "without": {},
        "truth": {"H": 100.0, "V": 50.0, "H_anchor": 90.0, "V_anchor": -20.0, "profile": [[0.0, 1.0], [8.0, 3.0]]},
        "scale": dict.fromkeys(("H", "V", "H_anchor", "V_anchor", "profile"), 100.0),
        "bound": {name: [1e-6, 1e-3] for name in ("H", "V", "H_anchor", "V_anchor", "profile")}}  # fmt: skip


@pytest.mark.parametrize(
    ("answer", "name"),
    [
        ({"H": 50.0, "V": 100.0}, "H_for_V"),
        ({"H": 50.0, "V": 100.0, "H_anchor": -20.0, "V_anchor": 90.0}, "H_for_V"),
        ({"H": -100.0, "V": -50.0, "V_anchor": 20.0}, "forces_reversed"),
        ({"H": 22.4808943, "V": 11.2404472}, "forces_times_0.2248"),
        ({"H": 300.0, "V": 150.0, "H_anchor": 270.0, "V_anchor": -60.0}, "forces_times_3"),
        ({"profile": [[-8.0, -2.0], [0.0, 0.0]]}, "profile_from_fairlead"),
        ({"profile": [[0.0, -1.0], [8.0, -3.0]]}, "profile_downwards"),
        ({"H": 101.0}, None),
        ({"H": 50.0, "V": 90.0}, None),
        ({"H": 100.5, "V": 50.25}, None),
    ],
)
def test_conventions_are_named_without_a_table(answer, name):
    """Exchanged components, signs, units, ends; no factor of one number, nor one that is near 1."""
    given = LINE["truth"] | answer
    matches = judge(example(**LINE), given).matches
    assert [match.name for match in matches] == ([name] if name else [])
    assert name != "forces_times_0.2248" or matches[0].sentence == "Forces are in lbf."


def test_a_chance_match_of_one_case_is_no_mistake_of_the_code():
    """One that explains one of five faulty cases that it changes: said with the case, and not of the code."""
    cases = [example(id=f"statics/{i}", without={}) for i in range(5)]
    judgements = [
        judge(case, {"H": H, "V": 30.0 + H}) for case, H in zip(cases, (120.0, 3.0, 7.0, 9.0, 11.0), strict=True)
    ]
    judgements[0] = judge(cases[0], {"H": 120.0})
    assert judgements[0].matches and summary.name_mistakes(judgements) == []
    assert summary.count_unexplained(judgements, []) == 5


def test_a_mistake_may_explain_most_quantities():
    """Within the bound of right answers; a loose match of a part is none."""
    answer = {"H": 120.0, "V": 40.0, "tension": [9.0, 9.0]}
    mistakes = {"all": {"H": 120.0, "V": 40.0, "tension": [3.0, 4.0]}}
    (match,) = judge(example(mistakes=mistakes), answer).matches
    assert (match.name, match.quantities, match.complete) == ("all", ("H", "V"), False)
    assert judge(example(mistakes=mistakes), answer | {"H": 120.1}).matches == ()


def test_series_are_compared_by_their_rms_and_harmonics_with_their_phase():
    """Envelopes, and all that is no series, by the greatest difference."""
    case = example("motion", truth={"tension": [[0.0] * 4], "envelope_max": [0.0] * 4, "harmonics": [[2.0, 0.0]]},
                   scale={"tension": 2.0, "envelope_max": 2.0, "harmonics": 2.0})  # fmt: skip
    assert measure_error(case, "tension", [[2.0, 0.0, 0.0, 0.0]]) == 0.5
    assert measure_error(case, "envelope_max", [2.0, 0.0, 0.0, 0.0]) == 1.0
    assert measure_error(case, "harmonics", [[2.0, np.pi]]) == pytest.approx(2.0, rel=ROUNDING)


def test_each_faulty_case_is_explained_by_one_mistake_over_all():
    """The one that fits most cases takes also those where another would fit."""
    cases = [example(id=f"statics/{i}") for i in range(3)]
    given = ({"H": 120.0, "V": 40.0}, {"H": 120.0, "V": 40.0}, {"H": 110.0, "V": 50.0})
    first, second = summary.name_mistakes([judge(*pair) for pair in zip(cases, given, strict=True)])
    assert (first.name, first.cases, first.applicable) == ("third", ("statics/0", "statics/1"), 3)
    assert first.alike == ("both",) and "third or both: 2 of the 3 cases" in first.text()
    assert (second.name, second.cases) == ("without friction", ("statics/2",))


def test_of_mistakes_that_explain_as_many_cases_the_better_fit_is_named():
    """A code that makes a mistake makes it wherever it changes the answer."""
    answer = {"H": 120.0}
    both = {"z in all": answer, "a in some": answer}
    cases = [example(id=f"statics/{i}", mistakes=both, without={}) for i in range(2)]
    cases.append(example(id="statics/2", mistakes={"z in all": answer}, without={}))
    judgements = [judge(case, {"H": H}) for case, H in zip(cases, (120.0, 120.0, 100.0), strict=True)]
    (named,) = summary.name_mistakes(judgements)
    assert (named.name, named.alike, named.applicable) == ("a in some", ("z in all",), 2)


def test_a_table_with_a_missing_bound_or_an_id_twice_is_refused():
    """By the id of the case."""
    one = {name: getattr(example(), name) for name in Case.__dataclass_fields__ if name not in ("level", "uncertainty")}
    table = {"version": "2026.11", "level": "statics", "units": {}, "mistakes": {}, "cases": [one]}
    assert len(read_table(table).cases) == 1
    for cases, words in (
        ([one, one], "given twice"),
        ([one | {"bound": {}}], "no scale or no bound"),
        ([one | {"id": "motion/one"}], "begins with its level"),
        ([one | {"bound": {name: [1e-3, 1e-6] for name in one["truth"]}}], "0 < right <= wrong"),
    ):
        with pytest.raises(ValueError, match=words):
            read_table(table | {"cases": cases})


@pytest.mark.parametrize(
    ("verdicts", "passed", "words", "colour"),
    [
        ({"right": 9, "not modelled": 3}, True, "9 of 9 right", report.GREEN),
        ({"right": 8, "inaccurate": 1}, True, "8 of 9 right, 1 inaccurate", report.AMBER),
        ({"right": 8, "refused": 1}, True, "8 of 9 right", report.AMBER),
        ({"right": 8, "wrong": 1}, True, "8 of 9 right, 1 wrong", report.RED),
        ({"right": 8, "refused": 1}, False, "8 of 9 right", report.RED),
        ({"not modelled": 9}, True, "nothing judged", report.RED),
    ],
)
def test_a_badge_has_the_colour_of_the_worst(verdicts, passed, words, colour):
    """Red also where a test failed that was expected to fail and did not."""
    badge = report.draw_badge({"set": "2026.11", "verdicts": verdicts, "passed": passed})
    assert f">{words}</text>" in badge and f'fill="{colour}"' in badge


# ---------------------------------------------------------------- what adapters are given and return
RULE = {"frequency": 0.1, "sin": [[1.0, 0.2, 0.3, 0.02, 0.05, 0.1], [0.1, 0, 0, 0, 0.03, 0]],
        "cos": [[0.3, 0, 0.1, 0.01, 0, 0.2], [0, 0.2, 0, 0, 0, 0.05]], "ramp": 5.0,
        "reference": [1.0, 2.0, -10.0]}  # fmt: skip


def test_motions_are_those_of_the_solvers():
    """Ramped harmonics of a fairlead and of a body in six degrees of freedom, rotation exact."""
    time, points = np.linspace(0.0, 12.0, 25), [[0.0, 5.0, -8.0], [-3.0, 1.0, 4.0]]
    body = BodyMotion.periodic(RULE["frequency"], RULE["sin"], RULE["cos"], RULE["reference"]).ramped(RULE["ramp"])
    mine = problems.BodyMotion(RULE).displacement(points, time)
    np.testing.assert_allclose(mine, body.displacement(points, time), rtol=0, atol=100 * ROUNDING)
    rule = {name: [row[:3] for row in RULE[name]] for name in ("sin", "cos")} | {"frequency": 0.1, "ramp": 5.0}
    line = {"fairlead": rule | {"mean": [1.0, 2.0, 3.0]}}
    theirs = Ramped(Motion(0.1, rule["sin"], rule["cos"]), 5.0).displacement(time).T + [1.0, 2.0, 3.0]
    np.testing.assert_allclose(problems.as_places(line, time), theirs, rtol=0, atol=100 * ROUNDING)


CLOCK = {"dt": 0.05, "period": 2.0, "periods": 3, "discard": 2, "instants": 20}


def test_the_last_period_of_a_moving_line_is_compared():
    """At its instants, with mean and harmonics; a series that has not all times is refused."""
    time = problems.as_times({"time": CLOCK})
    assert len(time) == 121 and time[-1] == pytest.approx(6.0, rel=ROUNDING)
    series = 5.0 + 3.0 * np.cos(np.pi * time + 0.4) + np.where(time < 4.0 - 1e-9, 100.0, 0.0)
    given = {"tension": series.tolist(), "envelope": {"max": [8.0], "min": [2.0]}}
    result = answers.as_quantities("cable", {"time": CLOCK}, given)
    assert len(result["fairlead_tension"]) == 20 and max(result["fairlead_tension"]) < 9.0
    assert result["mean"] == pytest.approx(5.0, rel=ROUNDING) and result["harmonics"][0] == pytest.approx([3.0, 0.4])
    assert (result["envelope_max"], result["envelope_min"]) == ([8.0], [2.0])
    for bad, words in ((series[:-1], "for each of 121 times"), (["a"] * 121, "numbers are wanted"), (5.0, "shape")):
        with pytest.raises(Refused, match=words):
            answers.as_quantities("cable", {"time": CLOCK}, {"tension": np.array(bad).tolist()})
    with pytest.raises(ValueError, match="multiple of 20 steps"):
        problems.as_times({"time": CLOCK | {"dt": 0.03}})


@pytest.mark.parametrize("answer", [SpanAnswer(1.0, 2.0), (1.0, 2.0), {"H": 1.0, "V": 2.0}, np.array([1.0, 2.0])])
def test_answers_come_in_several_forms(answer):
    """All that says H and V."""
    assert {name: answers.as_fields("span", answer)[name] for name in ("H", "V")} == {"H": 1.0, "V": 2.0}


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        (None, "None"),
        (3.0, "SpanAnswer"),
        ({"V": 1.0}, "no H"),
        (SpanAnswer(refused="too slack"), "too slack"),
        ({"H": 1.0, "V": 2.0, "anchor_H": 1.0}, "'anchor_H', and SpanAnswer has H, V, H_anchor"),
    ],
)
def test_what_is_no_answer_is_refused(answer, words):
    """With what it is."""
    with pytest.raises(Refused, match=words):
        answers.as_fields("span", answer)


def test_a_line_and_a_network_have_the_attributes_of_ours():
    """As solvers.Scene and Network; weights as they are given."""
    section = {"EA": 1e6, "diameter": 0.1, "mass_per_length": 20.0, "w": 100.0, "Cdn": 1.0}
    motion = {"frequency": 0.5, "sin": [[1, 0, 0]], "cos": [[0, 0, 0]], "mean": [60, 0, 0], "ramp": 1.0}
    line = {"rho": 1025.0, "g": 9.8, "depth": 50.0, "anchor": [0, 0, -50], "length": 80.0, "friction": 0.5,
            "time": CLOCK, "fairlead": motion}  # fmt: skip
    scene, _, fairlead, cells = problems.as_arguments("cable", line | section)
    assert (scene.cable.weight_in(scene.environment), scene.friction, scene.window) == (100.0, (0.5,), (4.0, 6.0))
    assert (scene.s[0], scene.s[-1], cells, fairlead.shape) == (0.0, 80.0, problems.CELLS, (121, 3))
    net = {"rho": 1025.0, "g": 9.8, "depth": None, "body": None,
           "nodes": [{"kind": "fixed", "r": [0, 0, 0]}, {"kind": "coupled", "r": [9, 0, 5]}],
           "elements": [section | {"L": 12.0, "ends": [0, 1]}]}  # fmt: skip
    (network,) = problems.as_arguments("network", net)
    assert network.body is None and network.elements[0].ends == (0, 1) and network.nodes[1].mass == 0.0
    assert isinstance(network.elements[0].cable, SimpleNamespace) and network.environment.current == (0.0, 0.0, 0.0)


def test_matches_are_words():
    """Of a feature that is left out, and of a part."""
    assert Match("without friction", "", 1e-9, ("H",)).text() == "equals the answer without friction to 1e-09"
    part = Match("kN_for_N", "Forces are in kN.", 1e-9, ("H", "V"), complete=False).text()
    assert part == "in H, V: equals the answer of kN_for_N (Forces are in kN.) to 1e-09"
    assert find_mistakes(example(), {"H": np.array(100.0)}, (), {}) == ()
