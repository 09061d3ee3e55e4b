"""Do the page's sections on moving cables show what was measured, and nothing else? Run from the command line."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from .test_report import ROOT, Page, broken_anchors, missing_files, read_site, report, undescribed

TIME, BALANCE, LINE, NETWORKS = "cable", "harmonic_balance", "mooring", "mooring.networks"
FILES = {TIME: "dynamics.json", BALANCE: "harmonic_balance.json", LINE: "mooring.json",
         NETWORKS: "mooring_networks.json"}  # fmt: skip
CHEAP = {TIME: ("profile",), BALANCE: ("fields", "oscillators")}


def measure(program: str, results: Path, *arguments: str) -> dict:
    """Run a benchmark program as its user does; its result file."""
    command = [sys.executable, "-m", f"benchmarks.{program}.measure", "--quick", "--out", str(results), *arguments]
    run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=600)
    assert run.returncode == 0, run.stderr
    return json.loads((results / FILES[program]).read_text(encoding="utf-8"))


def page(out: Path) -> Page:
    """The page made of what is in out/results; the machine alone is measured."""
    run = report("--only", "machine", "--out", out)
    assert run.returncode == 0, run.stderr
    return Page(read_site(out))


def words(result: Page) -> str:
    """The text of the page without tags, on one line."""
    return " ".join(re.sub(r"<[^>]+>", " ", result.text).split())


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """(folder, result files by program, page) of a few cheap parts."""
    out = tmp_path_factory.mktemp("dynamics")
    results = {program: measure(program, out / "results", "--parts", *parts) for program, parts in CHEAP.items()}
    return out, results, page(out)


def test_report_shows_the_parts_that_were_measured_and_no_other(built):
    """Measured parts have their headings, others none; figures are described, every link leads somewhere."""
    out, _, result = built
    for heading in (
        "The moving cable in time",
        "the line at rest",
        "Harmonic balance",
        "Compared with harmonic-balance",
    ):
        assert heading in result.text
    for heading in ("from rest to periodic", ">Drift<", "HB Table 2:", "HB Fig. 3:"):
        assert heading not in result.text
    assert undescribed(result) == [] and missing_files(result, out) == [] and broken_anchors(result) == []


def test_report_quotes_the_measured_profile(built):
    """The caption of the profile holds the tensions of the result file, rounded."""
    _, result, shown = built
    tensions = result[TIME]["profile"]["fairlead"]
    assert f"{tensions['box scheme'] / 1e3:.3f} kN on 50 nodes" in words(shown)
    assert f"{tensions['catenary'] / 1e3:.3f} kN on the catenary" in words(shown)


def test_report_keeps_the_data_of_its_figures(built):
    """The CSV beside the profile holds every node and every point of the catenary, unrounded."""
    out, result, _ = built
    rows = (out / "tables" / "dynamics_profile.csv").read_text(encoding="utf-8").splitlines()
    profile = result[TIME]["profile"]
    assert len(rows) == 1 + len(profile["nodes"]["s"]) + len(profile["catenary"]["s"])
    assert repr(profile["nodes"]["tension"][-1]) in rows[len(profile["nodes"]["s"])]


def test_report_follows_its_results_and_says_what_is_not_reached(built):
    """Planted results change the words: no number is typed in, and a gain below the bound is called not reached."""
    out, result, _ = built
    planted = json.loads(json.dumps(result))
    planted[TIME]["profile"]["distance"] = 0.123
    planted[TIME]["profile"]["fairlead"]["box scheme"] = 1234567.0
    seconds = planted[BALANCE]["fields"]["seconds"]
    seconds["planar"], seconds["spatial"] = [1.0] * 3, [1.5] * 3
    for row in planted[BALANCE]["oscillators"]:
        row["seconds_full"] = 1e3
    for program, data in planted.items():
        (out / "results" / FILES[program]).write_text(json.dumps(data), encoding="utf-8")
    text = words(page(out))
    assert "within 123 mm of the catenary" in text and "1234.57 kN on 50 nodes" in text
    assert "1.5 times as long" in text and re.search("run time, space over plane . not reached", text)
    assert "fastest of the libraries in 0 of the 3 sizes" in text


def test_report_of_every_part_is_whole(tmp_path, deep):
    """Every part of both programs has its section, its figures and its verdict (the long run only)."""
    if not deep:
        return
    for program in CHEAP:
        measure(program, tmp_path / "results")
    result = page(tmp_path)
    for heading in ("Orders of accuracy", "from rest to periodic", "Tension in space and time", "Drift", "HB Table 2",
                    "Error against run time", "HB Figs. 6 to 9", "HB Fig. 3", "HB Fig. 4", "The constant term",
                    "How many harmonics", "Spectra and envelopes", "Until the tension vanishes", "Cost"):  # fmt: skip
        assert heading in result.text, heading
    assert undescribed(result) == [] and missing_files(result, tmp_path) == [] and broken_anchors(result) == []
    assert "drift of the fairlead" in result.text and "time of time domain" in result.text


# ---------------------------------------------------------------- the line of nodes and elements
@pytest.fixture(scope="module")
def line(tmp_path_factory):
    """(folder, results, page) of cheap parts of the line of nodes and elements."""
    out = tmp_path_factory.mktemp("line")
    result = measure(LINE, out / "results", "--parts", "laboratory", "orcaflex", "three_periods")
    return out, result, page(out)


def test_report_shows_the_validation_that_was_measured(line):
    """The parts that were measured have their headings and figures, others none; deviations are quoted."""
    out, result, shown = line
    for heading in ("The moving line of nodes and elements", "Measured in the laboratory", "OrcaFlex, a studless"):
        assert heading in shown.text
    for heading in ("Ten thousand cells", "Everyday lines over a seabed", "Where harmonic balance pays"):
        assert heading not in shown.text
    assert undescribed(shown) == [] and missing_files(shown, out) == [] and broken_anchors(shown) == []
    data, text = result["laboratory"], words(shown)
    assert f"mean size {100 * data['mean_absolute']:.1f} %, greatest {100 * data['greatest']:.1f} %" in text
    computed = [row["computed"]["without friction"]["fairlead"] for row in result["orcaflex"]]
    rms = ", ".join(f"{100 * one['rms']:.1f} %" for one in computed)
    assert f"without friction: {rms} at the fairlead" in text


def test_report_calls_a_validation_that_is_missed_not_reached(line):
    """Planted deviations and times change the words and turn the verdicts."""
    out, result, _ = line
    planted = json.loads(json.dumps(result))
    planted["laboratory"] |= {"mean_absolute": 0.234, "greatest": 0.345}
    planted["three_periods"]["ratio"] = 0.5
    for row in planted["orcaflex"]:
        row["computed"]["without friction"]["fairlead"]["rms"] = 0.456
    (out / "results" / FILES[LINE]).write_text(json.dumps(planted), encoding="utf-8")
    text = words(page(out))
    assert "mean size 23.4 %, greatest 34.5 %" in text and "45.6 %, 45.6 %, 45.6 % at the fairlead" in text
    for label in ("difference from the laboratory", "difference from OrcaFlex", "time of the box scheme"):
        assert re.search(f"{label} . not reached", text), label


# ---------------------------------------------------------------- profiles and references
def refinement(order, u_num: float, is_asymptotic: bool = True) -> dict:
    factors = {"safety": 1.25, "expansion": 1.15} if is_asymptotic else {"safety": None, "expansion": None}
    return {"sizes": [10, 20, 40], "formal_order": 2.0, "order": order, "change": 0.003, "u_num": u_num,
            "is_asymptotic": is_asymptotic} | factors  # fmt: skip


REFINEMENTS = {"mesh": refinement(1.98, 0.00123), "steps": refinement(None, 0.25, is_asymptotic=False)}


def assert_references(file: Path, text: str):
    """The table holds orders and uncertainties in per cent, and the words say which factors were used."""
    rows = file.read_text(encoding="utf-8").splitlines()[1:]
    assert [row.rsplit(",", 1)[-1] for row in rows] == ["yes", "no"]
    assert ",2.0,1.98,0.3,1.25,0.123," in rows[0] and ",2.0,,0.3,,25.0," in rows[1]
    assert re.search(r"1 of 2 \s*refinements of references", text)


def test_report_counts_every_failure_in_its_profiles(tmp_path):
    """Of two lines and four errors: what has no answer, an error too large and a wrong status count as never solved."""
    points = [work_point("in time", 0.001, 0.0009, 500), work_point("in time", 0.004, 0.0009, 500, case="case_2"),
              work_point("MoorDyn", 0.01, 0.005, 9000), work_point("MoorDyn", 0.02, None, None, case="case_2"),
              work_point("harmonic balance", 0.0005, 0.02, 100, case="case_2", status="NOT_CORRECTED")]  # fmt: skip
    data = {"work": {"points": points, "titles": {}, "uncertainty": {"case_1": 1e-4, "case_2": 1e-4}, "ratios": [],
                     "wanted": [1e-3, 1e-2]},
            "references": {"difference": {}, "titles": {}, "refinements": {"case_1": REFINEMENTS}}}  # fmt: skip
    (tmp_path / "results").mkdir()
    (tmp_path / "results" / FILES[LINE]).write_text(json.dumps(data), encoding="utf-8")
    shown = page(tmp_path)
    text = words(shown)
    assert undescribed(shown) == [] and missing_files(shown, tmp_path) == [] and broken_anchors(shown) == []
    assert "share of 8 problems" in text
    assert "fastest in, and solved at all: in time 8 and 8; MoorDyn 0 and 2; harmonic balance 0 and 0" in text
    assert "Half of the problems are solved by in time 500, MoorDyn never, harmonic balance never" in text
    costs = (tmp_path / "tables" / "mooring_costs.csv").read_text(encoding="utf-8")
    assert costs.count("\n") == 1 + 8 + 2 and ",75,300,100,500\n" in costs
    assert "Here Fs is 1.25 and k 1.15" in text
    assert_references(tmp_path / "tables" / "mooring_references.csv", text)


def work_point(method, seconds, rms, evaluations, case="case_1", status="SUCCESS") -> dict:
    return {"case": case, "method": method, "size": 20, "other": 50, "seconds": seconds, "rms": rms, "error": rms,
            "status": status, "steps": 75, "iterations": 300, "factorisations": 100,
            "cell_evaluations": evaluations}  # fmt: skip


def test_report_shows_where_methods_agree_over_a_seabed_and_why_not(tmp_path):
    """Of three planted lines: two responses, one of them within 1e-3, and a reason; MoorDyn beside one of them."""
    row = {"line": "oc3", "title": "a chain", "kind": "surge", "amplitude": 2.0, "period": 10.0, "contact": 17.2,
           "seabed_stiffness": 1e4, "steps": 2e-6, "effect": 0.0123, "undamped": {"change": 0.0, "steps": 0.0345},
           "balance": {"status": "SUCCESS", "difference": 4e-4, "harmonics": 120},
           "moordyn": {"rms": 0.0567, "greatest": -0.0678, "steps": 0.0789}, "reason": None}  # fmt: skip
    far = {"balance": {"status": "SUCCESS", "difference": 0.0234, "harmonics": 240}, "reason": "a swing too fast"}
    none = {"balance": {"status": "SLACK", "difference": None, "harmonics": 120}, "reason": "slack", "moordyn": None}
    data = {"agreement": {"rows": [row, row | far, row | none, row | {"undamped": None, "effect": None}],
                          "cells": 50, "steps": [800, 1600, 3200], "agreed": 1e-3, "resolved": 3,
                          "direct": 120, "peer_steps": 1600}}  # fmt: skip
    (tmp_path / "results").mkdir()
    (tmp_path / "results" / FILES[LINE]).write_text(json.dumps(data), encoding="utf-8")
    shown = page(tmp_path)
    text = words(shown)
    assert undescribed(shown) == [] and missing_files(shown, tmp_path) == [] and broken_anchors(shown) == []
    assert "2 of 3 responses are within 0.1 % of the range of the history (rms), the farthest 2.3 %" in text
    assert "at least 3 harmonics to each swing, beyond 120 by GMRES" in text
    assert "800 steps a period, then 1600 and 3200, extrapolated" in text and "1600 coupling steps" in text
    for value in ("17", "3.5", "1.2", "240", "5.7", "-6.8", "7.9", "0.040", "a swing too fast"):
        assert re.search(rf"[> ]{re.escape(value)} ", text), value


# ---------------------------------------------------------------- moving networks
def test_report_shows_how_networks_grow_and_what_they_are_beside_moordyn(tmp_path):
    """The growth as measured; a difference from MoorDyn and a ratio, planted, turn words and verdicts."""
    result = measure(NETWORKS, tmp_path / "results", "--parts", "growth")
    row = {"title": "a spar", "lines": 3, "segments": 20, "range": 1e5, "pretension": 9e5, "rms": 0.0123, "error": 0.03,
           "explained": 0.0119, "uncertainty": 1e-3, "rms_of_half": 0.03, "by_segments": 0.02, "by_steps": 0.001,
           "by_damping": 0.002, "same_cells": 0.001, "at_rest": [[10, 0.004], [20, -0.001]],
           "change": 0.02, "periodic": 0.01, "refinements": REFINEMENTS}  # fmt: skip
    point = {"method": "in time", "size": 20, "other": 50, "periods": 2, "seconds": 0.01, "rms": 0.005, "error": 0.01,
             "status": "SUCCESS", "case": "bridles"}  # fmt: skip
    ratio = {"size": [20, 1, 1], "other": 400, "rms": 0.009, "seconds": 0.08, "ours": 0.01, "ratio": 8.0}
    result["agreement"] = {"rows": [row]}
    result["work"] = {"title": "nine lines", "points": [point], "wanted": [1e-3, 1e-2], "uncertainty": 1e-4,
                      "references_apart": 0.0015, "tolerance": 0.01, "ratios": [ratio], "coarse_ratios": [],
                      "coarse": 0.05}  # fmt: skip
    (tmp_path / "results" / FILES[NETWORKS]).write_text(json.dumps(result), encoding="utf-8")
    shown = page(tmp_path)
    text = words(shown)
    assert undescribed(shown) == [] and missing_files(shown, tmp_path) == [] and broken_anchors(shown) == []
    assert f"lines to the power {result['growth']['exponents']['seconds']:.2f} in time" in text
    assert "A spar: 1.2 %, of which refining explains up to 1.2 %; the segments matter most" in text
    assert "MoorDyn takes 8.0 times as long as this core" in text and "20 + 1 + 1" in text
    for label in ("difference from MoorDyn, moving networks", "time of MoorDyn, moving network"):
        assert re.search(f"{label} . not reached", text), label
    assert "exponent of the growth with lines" in text and "Light damping" not in text
    assert "not periodic yet" in text
    assert_references(tmp_path / "tables" / "mooring_networks_references.csv", text)
