"""Does the published matrix of conformance say what the codes do: scripts, explanations, counts, what was left out?"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from importlib import import_module
from importlib.util import find_spec

import numpy as np
import pytest

from reports.conformance import explanations, scripts, section
from reports.page.section import Inputs
from reports.pipeline.stages import JUDGED
from solvers import Span, solve_span
from verification.conformance.answers import ask
from verification.conformance.judge import RIGHT, WRONG, judge, measure_error
from verification.conformance.problems import as_arguments
from verification.conformance.results.summary import count_answered, count_verdicts, name_mistakes, summarise_features
from verification.conformance.run import make_row
from verification.conformance.tables import LEVELS, load_table

CASES = {case.id: case for level in LEVELS for case in load_table(level).cases}
ONE_THREAD = {f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "MKL")}
"""As the report runs the codes: where an iteration ends early, rounding decides what it ends with."""
DIGITS = 3  # of an error, that page and script have in common
LONGEST = 120  # s of one script
CHOSEN = {
    "moorpy": ("statics/raised-slack", "network/hanging-mass", *explanations.SLACK, *explanations.FOLDED,
               "statics/rubber", "statics/short-stiff", "network/bridle", "network/floating-hose"),
    "pycatenary": ("statics/oc3", "statics/over-stretched", "statics/laboratory-chain", "statics/rubber"),
    "moordyn": ("motion/normal-drag-surge",),
}  # fmt: skip
"""Code -> cases whose scripts are run: wrong ones, but for MoorDyn, which has none; without --deep the first few."""
FEW = 2
SLOPE = 0.01  # MoorPy's horizontal stiffness of a slack line over its weight per length
FINER = 1e-10  # of a line's length: MoorPy's tolerance where its own is too great
NEAR = 1e-6  # of the scale, what it then errs by at most
STIFFER = 1e4  # times EA: the strain is gone


def adapter_of(code):
    """Return the adapter of a judged code; the test is skipped where its package is not installed."""
    (one,) = (one for one in JUDGED if one.name == code)
    if find_spec(one.package) is None:
        pytest.skip(f"{one.package} is not installed")
    module, _, name = one.solver.partition(":")
    return getattr(import_module(module), name)()


def report_of(code, ids):
    """Return the report of a code on some cases, as the command writes it."""
    adapter, judgements = adapter_of(code), []
    for case in (CASES[name] for name in ids):
        with np.errstate(all="ignore"):  # the code of another
            answer = ask(adapter, case.problem, case.inputs)
        judgements.append(judge(case, answer, load_table(case.level).mistakes))
    answered, asked = count_answered(judgements)
    return {"set": load_table("statics").version, "levels": list(dict.fromkeys(CASES[name].level for name in ids)),
            "solver": {"label": adapter.label, "version": adapter.version, "name": code},
            "verdicts": count_verdicts(judgements), "answered": {"quantities": answered, "asked": asked},
            "features": summarise_features(judgements),
            "mistakes": [vars(one) for one in name_mistakes(judgements)],
            "cases": [json.loads(json.dumps(make_row(one, 1.0, one.fails(), False))) for one in judgements],
            }  # fmt: skip


# ---------------------------------------------------------------- scripts
@pytest.mark.parametrize("code", CHOSEN)
def test_a_script_prints_what_the_matrix_says(code, deep, tmp_path):
    """Run alone, in a folder without this suite: every quantity with the verdict and the error of the page."""
    ids = CHOSEN[code] if deep else CHOSEN[code][:FEW]
    adapter_of(code)
    path = tmp_path / "judged.json"
    program = ("import json, sys; from verification.suite.conformance.test_conformance_matrix import report_of; "
               "json.dump(report_of(sys.argv[1], sys.argv[3:]), open(sys.argv[2], 'w'))")  # fmt: skip
    run([sys.executable, "-c", program, code, path, *ids], os.getcwd(), path=os.pathsep.join(sys.path))
    report = json.loads(path.read_text(encoding="utf-8"))
    names = scripts.write_scripts(tmp_path, code, report, report["cases"])
    assert names.keys() == set(ids)
    for row in report["cases"]:
        text = run([sys.executable, "-P", names[row["id"]]], tmp_path)
        assert code == "moordyn" or row["verdict"] == WRONG
        for one in row["quantities"]:
            (line,) = (line for line in text.splitlines() if line.startswith(f"{one['quantity']}: "))
            verdict, error = line.split(": ")[1].split(" (")[0].split(", error ")
            assert verdict == one["verdict"], line
            assert float(error) == pytest.approx(one["error"], rel=10.0**-DIGITS), line


def run(words, folder, path=""):
    """Return what a program prints; without this suite on its path where none is given."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"} | ONE_THREAD
    environment |= {"PYTHONPATH": path} if path else {}
    done = subprocess.run([*map(str, words)], cwd=folder, env=environment, capture_output=True, text=True,
                          timeout=LONGEST)  # fmt: skip
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize("path", sorted(scripts.TEMPLATES.glob("*_*.py.j2")), ids=lambda path: path.name)
def test_a_script_takes_nothing_of_this_suite(path):
    """Imports of the code, numpy and the standard library alone."""
    words = [line.split()[1].partition(".")[0] for line in path.read_text(encoding="utf-8").splitlines()
             if line.startswith(("import ", "from "))]  # fmt: skip
    assert {"numpy"} < set(words) <= {"numpy", path.name.partition("_")[0], *sys.stdlib_module_names}


# ---------------------------------------------------------------- this project
NEAR_THE_BOUND = tuple(f"motion/{name}" for name in ("friction-surge", "friction-two-harmonics", "slack-surge",
                                                     "lazy-wave"))  # fmt: skip
"""Cases that are not right on the cells that other codes are asked for, and so the first to be lost."""


def test_this_project_is_right_in_motion(deep):
    """As the page says; all cases with --deep. Those at rest are in test_conformance_tables.py."""
    ids = [name for name in CASES if name.startswith("motion/")] if deep else NEAR_THE_BOUND
    report = report_of("this_project", ids)
    assert report["verdicts"] == {RIGHT: len(ids)}, [row for row in report["cases"] if row["verdict"] != RIGHT]


# ---------------------------------------------------------------- explanations
def test_moorpy_gives_a_slack_line_a_hundredth_of_its_weight_as_stiffness():
    """And where it folds below its ends twice the weight, and the anchor's force upside down."""
    adapter = adapter_of("moorpy")
    for name in (*explanations.SLACK, "statics/raised-slack"):
        given = ask(adapter, "span", CASES[name].inputs)
        assert given["stiffness"][0][0] == pytest.approx(SLOPE * CASES[name].inputs["w"], rel=1e-9)
        assert CASES[name].truth["stiffness"][0][0] == 0
    for name in explanations.FOLDED:
        given, case = ask(adapter, "span", CASES[name].inputs), CASES[name]
        assert given["stiffness"][0][0] == pytest.approx(2 * case.inputs["w"], rel=1e-2)
        assert measure_error(case, "V_anchor", -given["V_anchor"]) < NEAR


def test_moorpy_counts_the_tension_of_hanging_parts_from_the_ends():
    """Three metres from the raised anchor the tension is that of three metres of line."""
    case, adapter = CASES["statics/raised-slack"], adapter_of("moorpy")
    given, w, L = ask(adapter, "span", case.inputs), case.inputs["w"], case.inputs["L"]
    assert given["tension"] == pytest.approx([w * min(s, L - s) for s in case.inputs["s"]], rel=1e-5)


def test_moorpy_is_right_with_a_finer_tolerance():
    """Where the page says so of its default."""
    adapter = adapter_of("moorpy")
    for known in explanations.KNOWN:
        for name in known.cases if "tolerance" in known.words else ():
            case = CASES[name]
            (given,) = as_arguments(case.problem, case.inputs)
            if case.problem == "span":
                answer = {"H": adapter.span(given, FINER).H, "V": adapter.span(given, FINER).V}
            else:
                answer = {"tension": adapter.network(given, FINER)().tension}
            assert max(measure_error(case, quantity, value) for quantity, value in answer.items()) < NEAR, name


def test_pycatenary_errs_by_the_strain():
    """The error of H falls with EA, all else equal, by at least half as many powers of ten."""
    adapter = adapter_of("pycatenary")
    (known,) = (one for one in explanations.KNOWN if "strain" in one.words)
    for name in known.cases:
        errors = []
        for factor in (1.0, STIFFER):
            (line,) = as_arguments("span", CASES[name].inputs | {"EA": factor * CASES[name].inputs["EA"]})
            with np.errstate(all="ignore"):  # the code of another
                H = adapter.span(line).H
            errors.append(abs(H / solve_span(Span(**line.inputs())).H - 1))
        assert errors[1] < errors[0] / STIFFER**0.5, name


def test_every_explanation_has_its_test():
    """Words of the page that no test here shows would be hearsay."""
    shown = {"moorpy": {*explanations.SLACK, *explanations.FOLDED, "statics/raised-slack", "statics/short-stiff",
                        "network/bridle", "network/floating-hose", "network/hanging-mass"},
             "pycatenary": {"statics/oc3", "statics/chain-50m", "statics/laboratory-chain", "statics/rubber",
                            "statics/nearly-slack"}}  # fmt: skip
    for known in explanations.KNOWN:
        assert set(known.cases) <= shown[known.code]
        assert set(known.cases) <= CASES.keys()


def test_pycatenary_returns_what_is_no_equilibrium():
    """Of a line that is nearly slack: a force a million times the weight of the line."""
    case = CASES["statics/nearly-slack"]
    with np.errstate(all="ignore"):  # the code of another
        given = ask(adapter_of("pycatenary"), "span", case.inputs)
    assert given["H"] > 1e6 * case.inputs["w"] * case.inputs["L"]


# ---------------------------------------------------------------- the section
def test_the_section_says_who_is_wrong_where(tmp_path):
    """A wrong code: state, script and row of each cell, what was left out, the mistake, the worst quantity."""
    case = CASES["statics/oc3-friction-1"]
    wrong = judge(case, case.truth | case.mistakes["friction_ignored"], load_table("statics").mistakes)
    good = judge(CASES["statics/oc3"], CASES["statics/oc3"].truth)
    reports = {}
    for name, judgements in {"moorpy": [good, wrong], "this_project": [good]}.items():
        reports[name] = {
            "set": "2026.11", "levels": ["statics"], "solver": {"label": name, "version": "1", "name": name},
            "verdicts": count_verdicts(judgements), "answered": {"quantities": 8, "asked": 16},
            "features": summarise_features(judgements),
            "mistakes": [vars(one) for one in name_mistakes(judgements)],
            "cases": [make_row(one, 1.0, one.fails(), False) for one in judgements]}  # fmt: skip
    (tmp_path / "tables").mkdir()
    content = section.build(Inputs({"conformance": reports}, {}, tmp_path, tmp_path / "tables", {}, []))
    shown = content.context["conformance"]
    (row,) = shown["wrong"]
    assert row["why"].startswith("equals the answer without friction")
    assert (row["error"] > row["wrong"]) and (tmp_path / row["script"]).is_file()
    cells = {line["feature"]: line["cells"] for line in shown["matrix"]}["friction"]
    assert (cells[0]["state"], cells[0]["script"]) == ("failed", row["script"])
    assert "as if there were none" in cells[0]["text"]
    assert (cells[1]["state"], cells[1]["text"]) == ("", section.NOT_RUN)
    assert shown["left_out"] == {"this_project 1": ["statics/oc3-friction-1"]}
    assert shown["mistakes"]["moorpy"][0].startswith("friction_ignored") and not shown["mistakes"]["this_project"]
    (verdict,) = content.verdicts
    assert verdict.good and verdict.value == "1"
    for name in ("cases", "codes", "features", "bounds"):
        assert (tmp_path / "tables" / f"conformance_{name}.csv").is_file()
    assert good.verdict == RIGHT
