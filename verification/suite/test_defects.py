"""Does the catalogue of seeded defects keep its promises: each patch a mistake, each mistake found or explained?"""

from __future__ import annotations

import ast
import json
import os
import re
import shutil
import subprocess
import sys
import time
import tomllib
from dataclasses import astuple, replace
from functools import cache
from pathlib import Path

import pytest

from verification import ROOT

from ..defects import campaign
from ..defects.catalogue import CATALOGUE, FROZEN, LONG, PLANTING, WIDER, draw, frozen, whole
from ..defects.defect import KINDS, Defect, arguments
from ..defects.interpreter import Interpreter, Stopped
from ..defects.mutants import changes, mutant, sample
from ..defects.runner import CheckError, Copies, Log, Result, checks_of_loops, digest, key, narrowed, run, run_check
from ..defects.verdict import as_json, kept, summary, verdicts
from ..tools.patterns import module_syntax
from ..tools.planting import Fault
from .report.test_report import Page, broken_anchors, misaligned, missing_files, read_site, report, section

SOLVERS = ROOT / "solvers"
TYPES = "common.types"  # for annotations alone: nothing in it runs
LEAST = 60
"""Defects that the catalogue has to have."""


def module_name(path):
    """Dotted name below solvers of the module in a file."""
    return ".".join(path.relative_to(SOLVERS).with_suffix("").parts)


by_name = pytest.mark.parametrize("defect", CATALOGUE, ids=lambda defect: defect.name)


# ---------------------------------------------------------------- the catalogue
@by_name
def test_every_patch_applies(defect):
    """The old code is found once in its function, and the new one makes another programme of the module."""
    text = (ROOT / defect.fault.path).read_text(encoding="utf-8")
    patched = defect.applied_to(text)
    assert module_syntax(patched.encode()) != module_syntax(text.encode())
    compile(patched, defect.module, "exec")


def test_names_and_patches_are_unique():
    """No two defects have one name, and no two are the same mistake."""
    assert len({d.name for d in CATALOGUE}) == len(CATALOGUE) == len({d.fault for d in CATALOGUE})


def test_the_catalogue_is_large_enough_and_leaves_no_module_out():
    """At least 60 mistakes, of every kind, one at least in every module of the solvers; a few blind spots."""
    real = [d for d in CATALOGUE if not d.blind]
    modules = {module_name(path) for path in SOLVERS.rglob("*.py") if path.stem != "__init__"} - {TYPES}
    assert len(real) >= LEAST and {d.module for d in CATALOGUE} == modules == set(WIDER)
    assert {d.kind for d in real} == set(KINDS)
    assert 0 < len(CATALOGUE) - len(real) <= LEAST // 6


def test_words_are_there():
    """Every defect says what it is; misprints say where; blind spots and survivors say why."""
    for defect in CATALOGUE:
        assert defect.what and defect.check and defect.kind in KINDS, defect.name
        assert (defect.kind == "misprint") == bool(defect.misprint), defect.name
        assert not (defect.blind and defect.survives), defect.name


def test_a_draw_has_every_misprint_and_most_modules():
    """Misprints and blind spots always, others from each module in turn; one seed gives one draw, another another."""
    most, all_names = 124, {d.name for d in CATALOGUE}
    drawn = draw(most, "a")
    always = [d for d in CATALOGUE if d.misprint or d.blind]
    assert drawn == draw(most, "a") and {d.name for d in drawn} != {d.name for d in draw(most, "b")}
    assert len(drawn) == len(always) + most and all(d in drawn for d in always)
    modules = {d.module for d in CATALOGUE if d not in always}
    assert len(modules) <= most and modules <= {d.module for d in drawn}
    assert {d.name for d in draw(len(CATALOGUE), "a")} == all_names
    assert {d.name for seed in range(120) for d in draw(most, str(seed))} == all_names


@cache
def functions(path: Path) -> set[str]:
    """Names of the tests of a file."""
    return {n.name for n in ast.walk(ast.parse(path.read_text(encoding="utf-8"))) if isinstance(n, ast.FunctionDef)}


def misnamed(check: str) -> list[str]:
    """Files and functions of a check that are not there."""
    results = []
    for word in (word for word in arguments(check) if word.startswith("verification/")):
        file, _, function = word.partition("::")
        if not (ROOT / file).is_file() or (function and function not in functions(ROOT / file)):
            results.append(word)
    return results


def test_named_checks_exist():
    """Every file and function that a defect, or the longer run, names as a check is there; none plants by itself."""
    checks = {d.check for d in CATALOGUE} | {check for result in WIDER.values() for check in result}
    assert [word for check in checks for word in misnamed(check)] == []
    planting = [d.name for d in CATALOGUE for file, words in PLANTING.items() for word in words
                if re.match(f"{file}::.*{word}", d.check)]  # fmt: skip
    assert planting == []
    assert misnamed("catenary/test_exact.py::test_that_is_not_there") and misnamed("test_nowhere.py")


def test_lists_of_checks_name_what_is_there():
    """Files, functions and words of the lists that the checks are sorted by are those of tests."""
    for name in FROZEN:
        file, _, function = name.partition("::")
        assert any(result.startswith(function) for result in functions(ROOT / "verification" / file)), name
    for file, words in (*PLANTING.items(), *LONG.items()):
        for word in words:
            assert any(word in name for name in functions(ROOT / "verification" / file)), (file, word)
    assert "-k 'not 50_digits and" in whole("catenary/test_exact.py") and "not test_forces_equal" in whole(
        "catenary/test_exact.py"
    )
    assert frozen("suite/test_published.py::test_x") and not frozen("catenary/test_exact.py::test_vertical_line")


def test_no_named_check_compares_with_stored_numbers():
    """What is named beforehand is another kind of check than a comparison with published or stored numbers."""
    assert [d.name for d in CATALOGUE if frozen(d.check)] == []


OF_THE_PAPERS = {  # EQUATIONS of the two papers that are misprinted: what reference_data/errata.toml calls the place
    "MSQS": ("(4.16a)", "(4.11)", "(4.5), (4.7)", "section 5, weight", "(5.4)", "(2.18)"),
    "HB": ("(22)", "(30)", "(34)", "(37)", "(57)", "(61)", "(71)", "(1), (28)", "section 4.1"),
}
NO_FORMULA = ("(5.1)", "(5.3)", "(38)", "Figs. 6 to 9")
"""Misprints of a start, of a number that depends on a step, of a name, of a caption: nothing to plant in a solver."""


def places(text: str) -> set[str]:
    """Numbers of equations and sections in the words for a place."""
    return set(re.findall(r"\(\d+(?:\.\d+)?[a-z]?\)|section \d(?:\.\d)?|\b4\.1\b", text))


def test_every_misprint_is_planted():
    """Each misprint of the two papers, and each row of the table of errata, has a defect that takes it at its word."""
    planted = {d.misprint for d in CATALOGUE if d.misprint}
    assert {f"{paper} {where}" for paper, all_ in OF_THE_PAPERS.items() for where in all_} == planted
    errata = tomllib.loads((ROOT / "reference_data" / "errata.toml").read_text(encoding="utf-8"))["erratum"]
    known = {p: {place for where in all_ for place in places(where)} for p, all_ in OF_THE_PAPERS.items()}
    missing = [
        f"{row['paper']} {row['where']}"
        for row in errata
        if not (places(row["where"]) & known[row["paper"]] or row["where"].startswith(NO_FORMULA))
    ]
    assert missing == []


# ---------------------------------------------------------------- the runner, on defects that are really planted
CHOSEN = ("velocity of the cosines", "hertz for radians per second")


def program(out, *arguments) -> subprocess.CompletedProcess:
    """A run of the program with its results in ``out``."""
    command = [sys.executable, "-m", "verification.defects", "--out", str(out), *arguments]
    environment = os.environ | {"MOORING_PROGRESS": "lines"}
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, env=environment, timeout=300)


def test_planted_defects_are_found(tmp_path):
    """Two defects of the catalogue in copies of the project: their checks pass without, and fail with them."""
    output = program(tmp_path, "--only", *CHOSEN)
    assert output.returncode == 0, output.stdout + output.stderr
    assert "progress 4 4" in output.stdout and "2 of 2 defects found, 2 by the check named for them" in output.stdout
    assert not (tmp_path / "defects.json").exists()  # a part is not the whole
    results = Log(tmp_path / "defects.jsonl").results.values()
    assert {r.defect: r.outcome for r in results} == {"": "missed", **dict.fromkeys(CHOSEN, "caught")}
    checks = {d.name: d.check for d in CATALOGUE}
    assert all(r.test == r.check == checks[r.defect] for r in results if r.defect)


def test_the_program_lists_and_refuses(tmp_path):
    """--list runs nothing; words that fit no defect are refused."""
    assert len(program(tmp_path, "--list").stdout.splitlines()) == len(CATALOGUE)
    refused = program(tmp_path, "--only", "no such")
    assert refused.returncode == 2 and "no defect has 'no such'" in refused.stderr
    refused = program(tmp_path, "--mutants", "1", "--module", "no.such")
    assert refused.returncode == 2 and "no module of solvers is named no.such" in refused.stderr
    listed = program(tmp_path, "--mutants", "2", "--module", "numerics.memory", "--module", "cable.loads", "--list")
    assert [line.split(":")[0] for line in listed.stdout.splitlines()] == ["numerics.memory"] * 2 + ["cable.loads"] * 2


# ---------------------------------------------------------------- the runner, on a project of two functions
MODULE = "def double(x):\n    return 2 * x\n\n\ndef half(x):\n    return x / 2\n"
TESTS = """
import time
from solvers.numbers import double, half


def test_double():
    assert double(3) == 6


def test_half():
    assert half(3) == 1.5


def test_that_waits():
    while double(1) == 3:
        time.sleep(0.05)
"""
TINY = (
    Defect(
        "tripled",
        Fault("numbers", "double", "2 * x", "3 * x"),
        "factor",
        "three for two",
        "test_numbers.py::test_double",
    ),
    Defect("plus", Fault("numbers", "half", "x / 2", "x + 2"), "symbol", "plus for over", "test_numbers.py::test_half"),
    Defect(
        "unseen",
        Fault("numbers", "half", "x / 2", "x * 0.5"),
        "factor",
        "the same",
        "test_numbers.py",
        blind="equal in doubles",
    ),
    Defect(
        "slow", Fault("numbers", "double", "2 * x", "3 * x"), "factor", "never ends", "test_numbers.py::test_that_waits"
    ),
    Defect(
        "survivor",
        Fault("numbers", "double", "2 * x", "3 * x"),
        "factor",
        "not looked at",
        "test_numbers.py::test_half -v",
    ),
)
ENDING = tuple(d for d in TINY if d.name != "slow")


@pytest.fixture
def tiny(tmp_path) -> Path:
    """A project with one module and three tests."""
    project = tmp_path / "project"
    for folder in ("solvers", "verification"):
        (project / folder).mkdir(parents=True)
        (project / folder / "__init__.py").write_text("")
    (project / "solvers" / "numbers.py").write_text(MODULE)
    (project / "verification" / "test_numbers.py").write_text(TESTS)
    (project / "pyproject.toml").write_text("[tool.pytest.ini_options]\naddopts = '-q -ra'\n")
    return project


def finished(project, log, defects=TINY, **options):
    """Results by defect of a run over the tiny catalogue."""
    wanted = [(None, d.check) for d in defects] + [(d, d.check) for d in defects]
    *_, (_, _, results) = run(wanted, log, project=project, **{"timeout": 120.0} | options)
    return results


def test_outcomes_and_verdicts(tiny, tmp_path):
    """Caught, not ended, not seen: each as it is; a survivor without a word of explanation breaks the promise."""
    results = finished(tiny, Log(tmp_path / "log"), ENDING, jobs=2)
    slow = TINY[3]
    anew = Interpreter(tiny, forks=False)  # as where nothing can be forked
    slow.fault.write_to(tiny)  # whatever the load of the machine, it is not green after this time
    results.append(Result("slow", slow.check, *run_check(anew, slow.check, 1.0)))
    assert {r.defect: r.outcome for r in results if r.defect} == {
        "tripled": "caught", "plus": "caught", "unseen": "missed", "slow": "timeout", "survivor": "missed",
    }  # fmt: skip
    assert {r.outcome for r in results if not r.defect} == {"missed"}
    counts = summary(verdicts(TINY, results))
    assert (counts["defects"], counts["caught"], counts["rate"]) == (4, 3, 0.75)
    assert counts["unexplained"] == ["survivor"] and not counts["seen_blind"] and not kept(counts)
    explained = [*TINY[:4], replace(TINY[4], survives="named wrongly, on purpose")]
    assert summary(verdicts(explained, results))["unexplained"] == []
    assert kept(summary(verdicts(TINY[:4], results)))


def test_a_check_that_is_red_by_itself_is_no_evidence(tiny, tmp_path):
    """A check that fails without any defect finds none, and the promise is broken."""
    path = tiny / "verification" / "test_numbers.py"
    path.write_text(path.read_text().replace("== 6", "== 7"))
    counts = summary(verdicts(TINY[:2], finished(tiny, Log(tmp_path / "log"), TINY[:2])))
    assert counts["void"] == [TINY[0].check] and counts["survivors"] == ["tripled"] and not kept(counts)


def test_only_what_a_defect_turned_red_is_run_without_it(tiny, tmp_path):
    """The test with its parameters, even if others are red by themselves; nothing where no defect was seen."""
    path, check = tiny / "verification" / "test_numbers.py", "test_numbers.py::test_each"
    rows = '[(3, 6), (4, 9), ("a b", "a ba b")]'
    path.write_text(f"{path.read_text()}\n\nimport pytest\n\n\n@pytest.mark.parametrize(('x', 'y'), {rows})\n"
                    "def test_each(x, y):\n    assert double(x) == y\n")  # fmt: skip
    defects = [replace(TINY[0], check=check), replace(TINY[1], check="test_numbers.py::test_that_waits")]
    results = finished(tiny, Log(tmp_path / "log"), defects)
    assert {(r.defect, r.outcome) for r in results} == {("tripled", "caught"), ("plus", "missed"), ("", "missed")}
    assert narrowed(check, results) == f"'{check}[3-6]'" and narrowed(defects[1].check, results) == ""
    assert narrowed("another", results) == "another"
    anew = Interpreter(tiny, forks=False)
    for parameters, outcome in (("[4-9]", "caught"), ("[a b-a ba b]", "missed")):
        red = [replace(r, parameters=parameters) if r.red else r for r in results]
        assert run_check(anew, narrowed(check, red), 120.0)[0] == outcome


def test_a_blind_spot_that_a_check_finds_is_reported(tiny, tmp_path):
    """A defect declared blind that a check finds breaks the promise."""
    seen = [replace(TINY[1], blind="it is not")]
    counts = summary(verdicts(seen, finished(tiny, Log(tmp_path / "log"), seen)))
    assert counts["seen_blind"] == ["plus"] and not kept(counts)


def test_stored_numbers_are_counted_apart():
    """What only a comparison with stored numbers has found does not count as found."""
    defect = replace(TINY[0], check="suite/test_published.py::test_x")
    results = [Result("tripled", defect.check, "caught", 0.1, defect.check)]
    counts = summary(verdicts([defect], results))
    assert counts["caught"] == 1 and counts["caught_otherwise"] == 0 and not kept(counts)


def test_a_check_that_does_not_exist_stops_the_run(tiny):
    """A name that pytest does not find is an error and not a result."""
    for check in ("test_numbers.py::test_nothing", "test_numbers.py -k nothing"):
        with pytest.raises(CheckError, match="pytest ended with status"):
            run_check(Interpreter(tiny, forks=False), check, 120.0)


def test_patches_that_do_not_fit_are_refused(tiny, tmp_path):
    """What is not there, is no code, or has no such function, is refused before any work by the name of the defect."""
    for change in ({"old": "3 * x"}, {"old": "2 * double(x"}, {"function": "treble"}):
        refused = replace(TINY[0], fault=replace(TINY[0].fault, **change))
        with pytest.raises(CheckError, match=r"^tripled: solvers/numbers.py, .*(found 0|neither|defined 0)"):
            finished(tiny, Log(tmp_path / "log"), [refused])
    assert not Log(tmp_path / "log").results


def test_copies_are_whole_again_after_a_defect(tiny, tmp_path):
    """A defect is removed with its bytecode: the next check on the copy, and the project itself, do not know of it."""
    folder = tmp_path / "copies"
    folder.mkdir()
    with Copies(folder, tiny, 1) as copies:
        outcomes = [copies.run(d, TINY[0].check, 120.0).outcome for d in (TINY[0], None, TINY[1])]
    assert outcomes == ["caught", "missed", "missed"]
    assert (tiny / "solvers" / "numbers.py").read_text() == MODULE


def test_forked_and_anew_are_one(tiny):
    """Both ways of running pytest see the same, and both end what does not end; one that is closed runs no more."""
    answers = []
    for forks in (True, False) if hasattr(os, "fork") else (False,):
        interpreter = Interpreter(tiny, forks)
        (tiny / "solvers" / "numbers.py").write_text(MODULE)
        answers.append([run_check(interpreter, "test_numbers.py::test_half", 120.0)[0]])
        TINY[0].fault.write_to(tiny)
        os.utime(tiny / "solvers" / "numbers.py", (1e9 + len(answers), 1e9 + len(answers)))  # no stale bytecode
        answers[-1] += [run_check(interpreter, check, 120.0)[:3:2] for check in ("test_numbers.py::test_double",)]
        answers[-1] += [run_check(interpreter, "test_numbers.py::test_that_waits", 0.5)[0]]
        interpreter.close()
        with pytest.raises(Stopped):
            interpreter.run([], 1.0)
    assert answers[0] == answers[-1] == ["missed", ("caught", "test_numbers.py::test_double"), "timeout"]


LOOPS = "from numba import njit\n\n\n@njit\ndef triple(x):\n    return 3 * x\n"
LOOP_TESTS = """
from solvers.loops import triple
from solvers.numbers import double


def test_triple():
    assert triple(2) == 6 and not hasattr(triple, "py_func")


def test_double():
    assert double(3) == 6 and hasattr(triple, "py_func")
"""


def test_defects_in_compiled_loops_are_shown_to_checks_with_interpreted_ones(tiny, tmp_path):
    """The check named for a mistake in a loop is run without a compiler, with the mistake and without; others with."""
    (tiny / "solvers" / "loops.py").write_text(LOOPS)
    (tiny / "verification" / "test_loops.py").write_text(LOOP_TESTS)
    in_loop = Defect(
        "sextupled", Fault("loops", "triple", "3 * x", "6 * x"), "factor", "", "test_loops.py::test_triple"
    )
    elsewhere = replace(TINY[0], check="test_loops.py::test_double")
    assert checks_of_loops(
        tiny, [(in_loop, in_loop.check), (in_loop, elsewhere.check), (elsewhere, elsewhere.check)]
    ) == {in_loop.check}
    results = finished(tiny, Log(tmp_path / "log"), (in_loop, elsewhere))
    assert {r.outcome for r in results if not r.defect} == {"missed"}
    assert {r.defect: r.outcome for r in results if r.defect} == {"sextupled": "caught", "tripled": "caught"}
    for forks in (True, False) if hasattr(os, "fork") else (False,):
        interpreter = Interpreter(tiny, forks)
        outcomes = [run_check(interpreter, in_loop.check, 120.0, interpreted)[0] for interpreted in (True, False)]
        interpreter.close()
        assert outcomes == ["missed", "caught"]


def test_mutants_are_changes_of_one_place(deep):
    """Places of every module can be changed, give another programme that compiles, and a draw is repeated.

    Planted in every module in the long version, in every tenth by default.
    """
    texts = {module_name(p): p.read_text(encoding="utf-8") for p in SOLVERS.rglob("*.py") if p.stem != "__init__"}
    chosen, plain = [*texts] if deep else [*dict.fromkeys(["network.nested", *list(texts)[::10]])], set()
    for module, text in texts.items():
        before, places = module_syntax(text.encode()), list(changes(text))
        assert len(set(places)) == len(places), module
        if not places:
            plain.add(module)
        for place in places[:: max(1, len(places) // 2)] if module in chosen else ():
            defect = mutant(module, text, *place)
            assert module_syntax(defect.applied_to(text).encode()) != before, defect.name
            assert misnamed(defect.check) == []
    assert plain <= {TYPES, "numerics.elementary", "numerics.compiled"}
    drawn = sample(SOLVERS, 1, chosen)
    assert [d.module for d in drawn] == [module for module in chosen if module not in plain]
    one = sample(SOLVERS, 5, ["network.nested"])
    assert one == sample(SOLVERS, 5, ["network.nested"]) != sample(SOLVERS, 5, ["network.nested"], seed=1)
    assert len({d.name for d in one}) == 5 and one[:1] == [d for d in drawn if d.module == "network.nested"]


# ---------------------------------------------------------------- a campaign of mutants
OTHER_TESTS = """
import time
from solvers.numbers import half, unused


def test_a_slow_half():
    time.sleep(0.3)
    assert half(4) == 2


def test_quick_half():
    assert half(8) == 4
"""
UNUSED = "\n\ndef unused(x):\n    return x - 1\n"


@pytest.fixture
def campaigning(tiny, monkeypatch) -> Path:
    """The tiny project with a second file of tests and a function that none of them calls."""
    (tiny / "solvers" / "numbers.py").write_text(MODULE + UNUSED)
    (tiny / "verification" / "test_more.py").write_text(OTHER_TESTS)
    (tiny / "verification" / "defects").mkdir()
    for name in ("__init__.py", "ordering.py"):
        shutil.copy2(ROOT / "verification" / "defects" / name, tiny / "verification" / "defects")
    monkeypatch.setattr(campaign, "files", lambda module: ["test_numbers.py", "test_more.py"])
    monkeypatch.setattr(campaign, "deselected", lambda file: "")
    return tiny


def mutants_of(project, *changes) -> list[Defect]:
    """Mutants of the tiny module, named by their code."""
    return [Defect(f"{old} -> {new}", Fault("numbers", function, old, new), "factor", "", "")
            for function, old, new in changes]  # fmt: skip


def campaigned(project, log, mutants, **options):
    """Results by name of a campaign on the tiny project."""
    *_, (done, total, results) = campaign.run(mutants, log, project=project, **options)
    assert done == total
    return results


THREE = (("half", "x / 2", "x * 2"), ("half", "x / 2", "x * 0.5"), ("unused", "x - 1", "x + 1"))


def test_mutants_are_killed_judged_or_open(campaigning, tmp_path):
    """The quickest test kills; survivors count as equivalent where the table says so, else as open."""
    mutants = mutants_of(campaigning, *THREE)
    results = campaigned(campaigning, Log(tmp_path / "log"), mutants, jobs=2)
    assert [results[m.name].outcome for m in mutants] == ["caught", "missed", "missed"]
    assert results["x / 2 -> x * 2"].test != "test_more.py::test_a_slow_half"
    judged = {astuple(mutants[1].fault): campaign.Judgement(mutants[1].fault, "equal in doubles")}
    (score,) = campaign.scores(mutants, results, judged)
    assert (score.planted, score.killed, score.equivalent, score.open) == (3, 1, (mutants[1],), (mutants[2],))
    assert score.rate == 0.5 and campaign.scores(mutants, results, {})[0].rate == pytest.approx(1 / 3)


def test_mutants_are_shown_to_the_files_that_call_them(campaigning, tmp_path):
    """``double`` is called in one file, ``half`` in both; what none calls is shown to all."""
    mutants = mutants_of(campaigning, *THREE, ("double", "2 * x", "2 / x"))
    results = campaigned(campaigning, Log(tmp_path / "log"), mutants)
    assert [results[m.name].check for m in mutants] == ["test_numbers.py test_more.py"] * 3 + ["test_numbers.py"]


def test_results_of_mutants_are_kept_while_they_hold(campaigning, tmp_path):
    """Killed ones while their module and test are there; survivors until a test changes, and may then be killed."""
    mutants, log = mutants_of(campaigning, *THREE), tmp_path / "log"
    first = campaigned(campaigning, Log(log), mutants)
    again = campaigned(campaigning, Log(log), mutants)
    assert first == again  # times included: none was measured again
    path = campaigning / "verification" / "test_more.py"
    path.write_text(path.read_text() + "\n\ndef test_unused():\n    assert unused(1) == 0\n")
    more = campaigned(campaigning, Log(log), mutants)
    assert more["x / 2 -> x * 2"] == first["x / 2 -> x * 2"]
    assert more["x - 1 -> x + 1"].test == "test_more.py::test_unused"
    fresh = campaigned(campaigning, Log(log), mutants[:1], fresh=True)
    assert fresh["x / 2 -> x * 2"] != first["x / 2 -> x * 2"]
    (campaigning / "solvers" / "numbers.py").write_text("\n" + MODULE + UNUSED)
    assert campaigned(campaigning, Log(log), mutants[:1])["x / 2 -> x * 2"] not in more.values()


def test_a_campaign_wants_green_tests(campaigning, tmp_path):
    """A test that fails without a mutant would kill them all: it is named, and nothing is run."""
    path = campaigning / "verification" / "test_more.py"
    path.write_text(path.read_text().replace("half(8) == 4", "half(8) == 5"))
    with pytest.raises(CheckError, match=r"test_more.py is red without any mutant: test_more.py::test_quick_half"):
        campaigned(campaigning, Log(tmp_path / "log"), mutants_of(campaigning, *THREE))


def test_judgements_are_of_mutants_of_the_solvers():
    """Every mutant of the table can be planted and is one of its module's changes; the reason is a sentence."""
    for judged in campaign.judgements().values():
        module, fault = judged.fault.module, judged.fault
        text = (ROOT / fault.path).read_text(encoding="utf-8")
        patched = fault.apply_to(text).encode()
        begin = _common_length(text.encode(), patched)
        end = len(text.encode()) - _common_length(text.encode()[::-1], patched[::-1])
        near = [place for place in changes(text) if place[0] <= end and place[1] >= begin]  # others change other code
        changed = module_syntax(patched)
        assert any(changed == _changed(text, *place) for place in near), f"{module}: {fault} is no mutant"
        assert judged.reason.endswith(".") and judged.reason[0].isupper() and len(judged.reason.split()) > 3, fault


def _common_length(one: bytes, other: bytes) -> int:
    """Number of bytes with which both begin."""
    pairs = zip(one, other, strict=False)
    return next((i for i, (a, b) in enumerate(pairs) if a != b), min(len(one), len(other)))


def _changed(text, start, end, new) -> tuple[str, ...]:
    """Syntax of the text with new code from ``start`` to ``end`` bytes."""
    source = text.encode()
    return module_syntax(source[:start] + new.encode() + source[end:])


def test_a_mutant_is_judged_once(tmp_path):
    """The same function and code twice in the table is refused."""
    row = '[[mutant]]\nmodule = "a"\nfunction = "f"\nold = "x"\nnew = "y"\nreason = "It is the same."\n'
    path = tmp_path / "equivalent.toml"
    path.write_text(row)
    assert [one.reason for one in campaign.judgements(path).values()] == ["It is the same."]
    path.write_text(row + row)
    with pytest.raises(ValueError, match="a mutant stands there twice"):
        campaign.judgements(path)


# ---------------------------------------------------------------- resumption
def test_results_are_kept_and_go_stale(tiny, tmp_path):
    """A second run runs nothing again; another source, another patch or another check runs what it concerns."""
    log = tmp_path / "log"
    first = finished(tiny, Log(log), TINY[:2])
    again = finished(tiny, Log(log), TINY[:2])
    assert {repr(r) for r in again} == {repr(r) for r in first}  # times included: none was measured again
    changed = [replace(TINY[0], fault=replace(TINY[0].fault, new="4 * x")), TINY[1]]
    third = {r.defect: r for r in finished(tiny, Log(log), changed) if r.defect}
    assert third["plus"] in first and third["tripled"] not in first
    path = tiny / "verification" / "test_numbers.py"
    path.write_text(path.read_text() + "\n# a remark\n")
    assert not {repr(r) for r in finished(tiny, Log(log), TINY[:2])} & {repr(r) for r in first}


def test_digest_leaves_out_what_results_do_not_depend_on(tiny):
    """Not the catalogue, its test or the benchmarks; but solvers, tests and settings."""
    before = digest(tiny)
    for name, counts in (("verification/defects/x.py", False), ("verification/suite/test_defects.py", False),
                         ("benchmarks/x.py", False), ("verification/test_y.py", True),
                         ("solvers/__pycache__/x.pyc", False)):  # fmt: skip
        (tiny / name).parent.mkdir(parents=True, exist_ok=True)
        (tiny / name).write_text("new")
        assert (digest(tiny) != before) is counts, name
        before = digest(tiny)
    assert key(before, None, "a") != key(before, TINY[0], "a") != key(before, TINY[0], "b")


def test_a_line_cut_short_is_no_result(tmp_path):
    """What a killed run left of its last line is passed over, and the next result stands on a line of its own."""
    log = Log(tmp_path / "log")
    log.append("a", Result("x", "c", "caught", 1.0))
    log.append("b", Result("y", "c", "missed", 1.0))
    path = tmp_path / "log"
    path.write_bytes(path.read_bytes()[:-15])
    again = Log(path)
    assert set(again.results) == {"a"}
    again.append("c", Result("z", "c", "caught", 1.0))
    assert set(Log(path).results) == {"a", "c"}


KILLED = """
import sys
from pathlib import Path
from verification.defects.runner import Log, run
from verification.suite.test_defects import TINY
project, log = map(Path, sys.argv[1:])
for _ in run([(d, d.check) for d in TINY[:4]], Log(log), project=project, timeout=60.0):
    pass
"""


@pytest.mark.skipif(not hasattr(os, "killpg"), reason="kills a group of processes")
def test_a_killed_run_goes_on_where_it_was(tiny, tmp_path):
    """kill -9 while the fourth check hangs: the three results before it are there and are not run again."""
    log = tmp_path / "log"
    process = subprocess.Popen(
        [sys.executable, "-c", KILLED, str(tiny), str(log)], cwd=ROOT, start_new_session=True, stderr=subprocess.PIPE
    )
    try:
        until = time.monotonic() + 300
        while len(Log(log).results) < 3 and time.monotonic() < until and process.poll() is None:
            time.sleep(0.1)
        before = dict(Log(log).results)
    finally:
        os.killpg(process.pid, 9)
        process.communicate()
    assert len(before) == 3
    *_, (_, total, results) = run([(d, d.check) for d in TINY[:3]], Log(log), project=tiny)
    assert total == 3 and sorted(results, key=repr) == sorted(before.values(), key=repr)


# ---------------------------------------------------------------- the page
def test_the_page_shows_the_results_of_the_catalogue(tmp_path):
    """Counts, rate, survivors with their reasons, blind spots and each module stand on the page; its links lead on."""
    defects = [replace(CATALOGUE[0], survives="It was left to show this sentence."), *CATALOGUE[1:]]
    results = [Result(d.name, d.check, "missed" if d.blind else "caught", 1.0, d.check) for d in defects]
    results[0] = replace(results[0], outcome="missed")
    data = as_json(verdicts(defects, results))
    assert data["kept"] and data["summary"]["survivors"] == [defects[0].name]
    (tmp_path / "results").mkdir()
    (tmp_path / "results" / "defects.json").write_text(json.dumps(data), encoding="utf-8")
    made = report("--only", "machine", "--out", tmp_path)
    assert made.returncode == 0, made.stderr
    page = Page(read_site(tmp_path))
    shown = section(page.text, "defects")
    real = [d for d in defects if not d.blind]
    assert f"Of {len(real)} mistakes" in shown and "It was left to show this sentence." in shown
    assert shown.count('<td class="mark own">●</td>') == len(real) - 1
    matrix = json.loads((tmp_path / "tables" / "defects_matrix.json").read_text(encoding="utf-8"))
    assert matrix[-1]["planted"] == len(real) and matrix[-1]["found"] == len(real) - 1
    assert 'id="defects-matrix"' in shown
    for module in {d.module for d in real}:
        count = sum(d.module == module for d in real)
        assert f"<b>{module}</b>" in shown and f"{count - (module == defects[0].module)} of {count} found" in shown
    assert all(d.blind[1:] in shown for d in defects if d.blind)
    assert missing_files(page, tmp_path) == [] and broken_anchors(page) == [] and misaligned(shown) == []


# ---------------------------------------------------------------- the whole catalogue
def test_the_catalogue_is_found(deep, tmp_path):
    """At least 95 % without stored numbers, survivors explained, misprints all found, blind spots blind.

    The whole catalogue in the long version, every two-hundredth defect by default.
    """
    defects = [d for i, d in enumerate(CATALOGUE) if deep or i % 200 == 0]
    wanted = [(None, d.check) for d in defects] + [(d, d.check) for d in defects]
    *_, (_, _, results) = run(wanted, Log(tmp_path / "log"), jobs=os.cpu_count() or 1)
    counts = summary(verdicts(defects, results))
    assert kept(counts), json.dumps(counts)  # whole: pytest would cut it short
