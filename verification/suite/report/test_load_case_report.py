"""Does the page of a line or a network in waves show what the sea does to each line? Run as readers do."""

from __future__ import annotations

import csv
import json

import numpy as np
import pytest

from solvers.io.case_file import load_case_of, load_system
from solvers.load_cases.integration import integrate_case
from verification import ROOT

from .test_report import Page, broken_anchors, missing_files, report, undescribed

WAVES = """
[motion]
spectrum = "jonswap"
Hs = 3.0
Tp = 9.0
seed = 4
duration = 300.0
operators = "raos.csv"
"""
OPERATORS = "frequency,surge,heave,pitch_deg\n0.02,1,1,0.1\n0.2,0.2,0.1,0.1\n0.6,0,0,0\n"
FILES = {
    "line": ROOT / "reference_data" / "scenes" / "dynamics" / "hb_case_1.toml",
    "network": ROOT / "reference_data" / "scenes" / "networks" / "oc3_moving.toml",
}
PROMISE = 0.02  # relative: the tolerance where none is asked for


def shape_of(lines) -> list[tuple]:
    return [np.shape(line) for line in lines]


@pytest.mark.parametrize("kind", FILES)
def test_a_file_in_waves_has_a_page_of_its_sea(kind, tmp_path):
    """Statistics of every line within the promise of a finer run, when each is greatest, series, spectrum, margin."""
    text = FILES[kind].read_text(encoding="utf-8").partition("[motion]")[0] + WAVES
    text = text.replace("EA = 384.243e6", "breaking_load = 6e6\nEA = 384.243e6")
    (tmp_path / "raos.csv").write_text(OPERATORS)
    path = tmp_path / "mine.toml"
    path.write_text(text)
    done = report(path, "--out", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    out = tmp_path / "out"
    summary = json.loads((out / "results" / "load_cases_mine.json").read_text())["mine"]
    system = load_system(path)
    case = load_case_of(system)
    fine = integrate_case(system, case, dt=summary["dt"] / 4, cells=4 * summary["cells"])
    assert summary["accuracy"]["promised"] <= PROMISE and summary["accuracy"]["sampled"] == 1
    (row,) = summary["rows"]
    greatest = [line.fairlead.max() for line in fine.lines]
    assert [line["maximum"] for line in row["lines"]] == pytest.approx(greatest, rel=PROMISE)
    assert [line["standard_deviation"] for line in row["lines"]] == pytest.approx(
        [line.fairlead.std() for line in fine.lines], rel=PROMISE)  # fmt: skip
    times = [fine.dt * line.fairlead.argmax() for line in fine.lines]
    assert summary["series"]["time_of_max"] == pytest.approx(times, abs=2 * summary["dt"])
    density = np.array(summary["series"]["spectrum"]["density"])
    frequency = np.array(summary["series"]["spectrum"]["frequency"])
    energy = np.trapezoid(density, frequency, axis=1)
    assert energy == pytest.approx([line["standard_deviation"] ** 2 for line in row["lines"]], rel=0.3)  # windows
    characteristic = [max(line["maximum"], line["extreme"] or 0.0) for line in row["lines"]]
    assert [m["design"] for m in summary["margins"]] == pytest.approx(characteristic, rel=1e-12)  # factors of 1
    assert [m["basis"] for m in summary["margins"]] == [
        "greatest" if size == line["maximum"] else "extreme"
        for size, line in zip(characteristic, row["lines"], strict=True)
    ]
    for along, line in zip(summary["along"], row["lines"], strict=True):
        assert max(along["high"]) <= line["maximum"] * (1 + PROMISE) and min(along["low"]) > 0
    assert shape_of(summary["envelope"]["poses"][0]) == shape_of(summary["envelope"]["rest"])
    shown = (out / "scene-mine.html").read_text(encoding="utf-8")
    page = Page(shown)
    assert not broken_anchors(page) and not missing_files(page, out) and not undescribed(page)
    for words in (
        "in waves",
        "Spectrum of the tension",
        "Tension at the fairlead end",
        "Tension along the lines",
        '<svg class="moving"',
        "promised to",
        "greatest at, s",
    ):
        assert words in shown, words
    assert "in waves, Hs 3 m, seed 4: tensions in kN" in done.stdout and "promised to" in done.stdout
    with (out / "mine" / "sea.csv").open(newline="") as file:
        assert [float(r["maximum"]) for r in csv.DictReader(file)] == [line["maximum"] for line in row["lines"]]
