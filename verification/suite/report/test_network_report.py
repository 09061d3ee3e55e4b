"""Does the page of a network file show every line, the setting to use and failures in words? Run as readers do."""

from __future__ import annotations

import csv
import json
import os
import re
import shutil
import subprocess
import sys

import pytest

from solvers.io import load_moordyn, read_map_file

from .test_report import ROOT, Page, broken_anchors, fetched, missing_files, report, undescribed

NETWORK = """
name = "Two ropes and a chain"
[environment]
depth = 100.0
seabed_stiffness = 2e4
seabed_damping = 2e3
[[line_types]]
name = "rope"
EA = 2e7
diameter = 0.12
mass_per_length = 25.0
Cdn = 1.2
Ca = 1.0
breaking_load = 6e5
[[nodes]]
name = "south"
kind = "fixed"
r = [0.0, -40.0, -90.0]
[[nodes]]
name = "north"
kind = "fixed"
r = [0.0, 40.0, -90.0]
[[nodes]]
name = "buoy"
kind = "free"
r = [55.0, 0.0, -60.0]
volume = 1.0
CdA = 2.0
[[nodes]]
name = "fairlead"
kind = "coupled"
r = [120.0, 0.0, -10.0]
[[elements]]
line_type = "rope"
length = 75.0
anchor = "south"
fairlead = "buoy"
[[elements]]
line_type = "rope"
length = 75.0
anchor = "north"
fairlead = "buoy"
[[elements]]
line_type = "rope"
length = 80.0
anchor = "buoy"
fairlead = "fairlead"
"""
MOTION = """
[safety_factors]
mean = 1.1
dynamic = 1.5
[motion]
period = 10.0
amplitude = [1.0, 0.0, 0.5, 0.0, 0.0, 0.0]
"""
LINES = ("south \N{EN DASH} buoy", "north \N{EN DASH} buoy", "buoy \N{EN DASH} fairlead")
ROUNDING = 1e-12  # relative: sums of a few numbers
PEER = 2e-3  # relative: codes that stop at a distance, MoorPy at 0.05 m
NAME, OWN = "ropes", ("time domain", "harmonic balance")


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """(folder, what the terminal showed, result, text of the page) of a network in motion."""
    folder = tmp_path_factory.mktemp("network")
    (folder / f"{NAME}.toml").write_text(NETWORK + MOTION, encoding="utf-8")
    run = report(folder / f"{NAME}.toml", "--out", folder / "out")
    assert run.returncode == 0, run.stderr
    result = json.loads((folder / "out" / "results" / f"network_{NAME}.json").read_text(encoding="utf-8"))[NAME]
    return folder, run.stdout, result, (folder / "out" / f"scene-{NAME}.html").read_text(encoding="utf-8")


def again(built, tmp_path, change) -> str:
    """Return the page made of the result with a change to it; nothing is measured but the machine."""
    folder, out = built[0], tmp_path / "out"
    shutil.copytree(folder / "out", out)
    path = out / "results" / f"network_{NAME}.json"
    data = json.loads(path.read_text(encoding="utf-8"))
    change(data[NAME])
    path.write_text(json.dumps(data), encoding="utf-8")
    run = report(folder / f"{NAME}.toml", "--only", "machine", "--out", out)
    assert run.returncode == 0, run.stderr
    return (out / f"scene-{NAME}.html").read_text(encoding="utf-8")


def test_the_page_is_whole(built):
    """Figures with words, files that are there, nothing fetched from elsewhere."""
    folder, _, _, text = built
    page = Page(text)
    assert undescribed(page) == [] and missing_files(page, folder / "out") == [] and broken_anchors(page) == []
    assert fetched(page) == []
    titles = ("In space", "From above", "From the side", "Tension at the fairlead end over a period",
              "Harmonics of the tension", "Error against run time")  # fmt: skip
    assert [title for title in titles if f">{title}:" not in text] == []


def test_every_line_is_in_page_file_and_terminal(built):
    """The greatest tension of each line, in kN, in the terminal and on the page; unrounded in the CSV."""
    folder, shown, result, text = built
    with (folder / "out" / "tables" / f"network_{NAME}_lines.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert tuple(row["line"] for row in rows) == LINES
    for row, line in zip(rows, result["motion"], strict=True):
        assert float(row["max"]) == line["max"] and float(row["std"]) == line["std"]
        printed = f"{line['max'] / 1e3:.{3 - len(str(int(line['max'] / 1e3))) + 1}f}"
        assert f">{printed}</td>" in text
        assert re.search(rf"^{re.escape(row['line'])} .*\s{re.escape(printed)}\s", shown, re.MULTILINE)
    for table in ("body", "stiffness", "impedance_real", "impedance_imaginary", "settings", "statics"):
        assert f'href="tables/network_{NAME}_{table}.csv"' in text


def test_the_recommended_setting_is_the_cheapest_within_the_tolerance(built):
    """Found anew from the result; its call is on the page, and its sentence in the terminal."""
    _, shown, result, text = built
    uncertainty = result["reference"]["uncertainty"]
    own = [row for row in result["ladder"] if row["method"] in OWN]
    within = [row for row in own if row["error"] is not None and row["error"] + uncertainty <= result["tolerance"]]
    best = min(within, key=lambda row: row["seconds"])
    size = f"harmonics={best['harmonics']}" if "harmonics" in best else f"dt={best['dt']:.6g}, periods="
    assert f"cells={best['cells']})" in text and size in text
    assert f"on {best['cells']} cells with" in shown and "within the tolerance of 0.01" in shown


def test_each_line_has_its_margin(built):
    """Design tension and utilisation worked out anew from mean and greatest tension; the worst in the terminal."""
    folder, shown, result, text = built
    with (folder / "out" / "tables" / f"network_{NAME}_margin.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert tuple(row["line"] for row in rows) == LINES
    used = []
    for row, line in zip(rows, result["motion"], strict=True):
        design = 1.1 * line["mean"] + 1.5 * (line["max"] - line["mean"])
        assert float(row["design"]) == pytest.approx(design, rel=ROUNDING)
        used.append(design / (0.95 * 6e5))
        assert float(row["utilisation"]) == pytest.approx(used[-1], rel=ROUNDING)
    worst = LINES[used.index(max(used))]
    assert re.search(rf"Utilisation at most {max(used):.3g}\d*, of {worst}: within the strength", shown)
    assert "gamma_mean = 1.1 and gamma_dyn = 1.5, of the file" in text


def test_lines_move_on_the_page_and_stand_still_on_paper(built):
    """Two views; each line is a polyline through its points at every instant, which ends where it began."""
    _, _, result, text = built
    views = re.findall(r'<svg class="moving".*?</svg>', text)
    assert len(views) == 2 and 'aria-label="Two ropes and a chain, moving, from above"' in views[1]
    for view in views:
        moving = re.findall(r'<polyline class="line" points="([^"]+)"><animate [^>]*values="([^"]+)"', view)
        assert len(moving) == len(LINES)
        for points, values in moving:
            poses = values.split(";")
            assert len(poses) == len(result["envelope"]["poses"]) + 1 and poses[0] == poses[-1] == points
    assert "prefers-reduced-motion" in text and fetched(Page(text)) == []


def test_files_for_other_programs_are_linked_and_read_back(built):
    """MoorDyn's and MAP++'s have the lengths of the lines; other codes at rest agree, where they are installed."""
    folder, _, result, text = built
    for program, read in (("moordyn.txt", load_moordyn), ("map.map", lambda path: read_map_file(path, depth=100.0))):
        file = f"results/network_{NAME}_{program}"
        assert f'href="{file}"' in text
        assert [element.L for element in read(folder / "out" / file).elements] == [75.0, 75.0, 80.0]
    for row in result["static_peers"]:
        if row["tension"]:
            assert row["tension"] == pytest.approx(result["statics"]["exact"], rel=PEER), row["method"]


NAMING = (
    "import json, sys; from pathlib import Path; from reports.pipeline.naming import name_files; "
    "print(*name_files([Path(file) for file in sys.argv[2:]], Path(sys.argv[1])).values())"
)


def test_files_of_one_name_in_two_folders_are_kept_apart(tmp_path):
    """Results and pages are named by stem, with the folder where that is taken; the same file keeps its name."""

    def names(*files) -> list[str]:
        command = [sys.executable, "-c", NAMING, "names.json", *files]
        run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=60,
                             env=os.environ | {"PYTHONPATH": str(ROOT)})  # fmt: skip
        assert run.returncode == 0, run.stderr
        return run.stdout.split()

    assert names("a/line.toml") == ["line"]
    assert names("b/line.toml") == ["line-b"]
    assert names("b/line.toml", "a/line.toml", "c/b/line.toml") == ["line-b", "line", "line-b-2"]


SENTENCE = (
    "import json, sys; from reports.scenes.networks.settings import *; "
    "report = json.load(open(sys.argv[1]))[sys.argv[2]]; "
    "report['tolerance'] = 1e-12; report['recommended'] = recommend(report); print(sentence(report))"
)


def test_without_a_setting_within_the_tolerance_the_best_is_named(built):
    """No setting meets a tolerance of nothing: the sentence says so and names the most accurate."""
    folder, _, result, _ = built
    path = folder / "out" / "results" / f"network_{NAME}.json"
    command = [sys.executable, "-c", SENTENCE, str(path), NAME]
    run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=60)
    own = [row for row in result["ladder"] if row["method"] in OWN and row["error"] is not None]
    best = min(own, key=lambda row: row["error"])
    assert "No setting meets the tolerance of 1e-12. The most accurate is" in run.stdout, run.stderr
    assert f"on {best['cells']} cells with" in run.stdout
    assert "so no setting can be promised" in run.stdout or "By second order it would take about" in run.stdout


def test_failures_are_said_and_no_page_is_blank(built, tmp_path):
    """A network that could not be moved: the sentence, the settings with their status, the lines at rest."""

    def fail(data):
        for key in ("motion", "waveforms", "body", "envelope"):
            del data[key]
        data["failed"] = "The network could not be moved: a time step did not converge."
        data["reference"] |= {"uncertainty": None}
        for row in data["ladder"]:
            row |= {"status": "STEP_FAILED", "sentence": "a time step did not converge", "error": None}

    text = again(built, tmp_path, fail)
    assert "The network could not be moved: a time step did not converge." in text
    assert "step failed" in text and ">In space:" in text and LINES[2] in text and "Use time stepping" not in text


def test_a_network_at_rest_has_its_page(tmp_path):
    """Without a motion: pretension of every line, on the page and in the terminal; a wrong file ends with its words."""
    path = tmp_path / "still.toml"
    path.write_text(NETWORK, encoding="utf-8")
    run = report(path, "--only", "moving_networks", "--out", tmp_path / "out")
    assert run.returncode == 0, run.stderr
    assert all(line in run.stdout for line in LINES)
    text = (tmp_path / "out" / "scene-still.html").read_text(encoding="utf-8")
    assert all(line in text for line in LINES) and "Stiffness at rest" in text
    path.write_text(NETWORK.replace("length = 80.0", "lenght = 80.0"), encoding="utf-8")
    run = report(path, "--only", "moving_networks", "--out", tmp_path / "out")
    assert run.returncode == 1 and "did you mean 'length'" in run.stderr
    assert "did you mean" in (tmp_path / "out" / "scene-still.html").read_text(encoding="utf-8")
