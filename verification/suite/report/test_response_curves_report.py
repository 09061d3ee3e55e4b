"""Does the section on response curves show what was measured, and would it show a contradiction?"""

from __future__ import annotations

import csv
import json
import subprocess
import sys

import pytest

from .test_dynamics_report import page as built_page
from .test_dynamics_report import words
from .test_report import ROOT, Page, broken_anchors, missing_files, report, undescribed

PARTS = ("curve_taut", "methods", "parametric")


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """(folder, content of the result file, page) of a few cheap parts."""
    out = tmp_path_factory.mktemp("curves")
    command = [sys.executable, "-m", "benchmarks.response_curves.measure", "--quick", "--out", str(out / "results"),
               "--parts", *PARTS]  # fmt: skip
    run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=600)
    assert run.returncode == 0, run.stderr
    content = json.loads((out / "results" / "response_curves.json").read_text(encoding="utf-8"))
    return out, content, built_page(out)


def test_the_section_shows_the_parts_that_were_measured(built):
    """Measured parts have their headings, others none; figures are described, every link leads somewhere."""
    out, content, page = built
    for heading in ("Response curves and stability", "Special points in time", "Multipliers by two methods",
                    "Sideways and upward instability"):  # fmt: skip
        assert heading in page.text
    for heading in ("curves-basins", "curves-cost"):
        assert f'id="{heading}"' not in page.text
    assert undescribed(page) == [] and missing_files(page, out) == [] and broken_anchors(page) == []
    rows = content["curve_taut"]["curves"][0]["confirmed"]
    agree = sum(row["agrees"] is True for row in rows)
    assert f"Of {len(rows)} time integrations {agree} grow or decay as the multipliers say, 0 contradict" in words(page)
    assert agree >= 2 and not any(row["agrees"] is False for row in rows)


def test_a_contradiction_is_shown(built, tmp_path):
    """A time integration that returns where the multipliers say it leaves counts in the sentence and the verdict."""
    _, content, _ = built
    content = json.loads(json.dumps(content))
    content["curve_taut"]["curves"][0]["confirmed"][0]["agrees"] = False
    (tmp_path / "results").mkdir()
    (tmp_path / "results" / "response_curves.json").write_text(json.dumps(content), encoding="utf-8")
    page = built_page(tmp_path)
    assert "1 contradict them" in words(page)


@pytest.mark.parametrize(("arguments", "message"), [
    (["--sweep", "0.02:0.3"], "--sweep takes scene or network files"),
    (["--amplitude", "1"], "--amplitude is the largest displacement of a --sweep"),
    (["--sweep", "0.3:0.02"], "no band of frequencies"),
])  # fmt: skip
def test_a_sweep_that_cannot_be_is_refused(arguments, message, tmp_path):
    """Without a file, without a band, the wrong way round: status 2 and what is wrong."""
    run = report(*arguments, "--out", tmp_path)
    assert run.returncode == 2 and message in run.stderr


def test_a_line_is_swept_on_its_page(tmp_path):
    """The terminal and the page of one's own line say what the curve means; the figure is there."""
    line = ROOT / "reference_data" / "scenes" / "dynamics" / "hb_case_1.toml"
    run = report(line, "--sweep", "0.03:0.04", "--amplitude", "1", "--only", "sweep", "--out", tmp_path)
    assert run.returncode == 0, run.stderr
    page = Page((tmp_path / "scene-hb_case_1.html").read_text(encoding="utf-8"))
    for text in ("With 1 m of motion the largest tension over the band is", "No jumps", "No instability"):
        assert text in run.stdout and text in words(page)
    assert (tmp_path / "figures" / "sweep_hb-case-1_sweep.svg").is_file()
    curve = json.loads((tmp_path / "results" / "sweep_hb_case_1.json").read_text(encoding="utf-8"))
    curve = next(iter(report["curves"][0] for report in curve.values() if "curves" in report))
    with open(tmp_path / "figures" / "sweep_hb-case-1_sweep.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    for bound in ("greatest", "least"):  # each of the points, by what it is
        tensions = [float(row["tension_kN"]) for row in rows if row["bound"] == bound and row["state"] == "stable"]
        assert tensions == pytest.approx([1e-3 * value for value in curve[bound][0]])
    assert undescribed(page) == [] and missing_files(page, tmp_path) == []
