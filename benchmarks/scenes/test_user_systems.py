"""Ten systems as engineers write them from the README alone: each is solved, or refused or warned with the right hint.

Two have units mixed up. Tensions at rest are compared with formulas that are worked here, by hand; `--deep` has each
page built as readers have it. Sources: OC3 Hywind (Jonkman 2010, NREL/TP-500-47535), OC4 DeepCwind (Robertson et al.
2014, NREL/TP-5000-60601); the others are of the usual size of chain and polyester.
"""

from __future__ import annotations

import math
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest

from benchmarks.load_cases import table
from benchmarks.scenes import measure, networks
from benchmarks.scenes.network_files import load
from solvers import InputError, Scene, mooring_system, solve_network, solve_span, solve_static
from solvers.common.load_case import LoadCase
from solvers.common.motions.sea_state import SeaMotion
from solvers.io.case_file import load_case_of, load_system, read_load_cases
from solvers.load_cases import solve_load_cases

ROOT = Path(__file__).parents[2]
FOLDER = ROOT / "reference_data" / "scenes" / "users"
OC3_TENSION, OC4_TENSION = 911e3, 1105e3  # N at the fairlead at rest, of the definitions of both systems
PUBLISHED = 0.01  # relative, of tensions that are published to three digits
MESH = 0.02  # relative: of 20 cells of the longest line, over an elastic seabed
HAND = 1e-3  # relative: a taut line as a parabola, of fourth order in the sag
DEPTH = 200.0  # m, where the MAP++ file leaves it open
LONGEST = 600  # s of a page, on a busy machine
REFUSED = {"tonnes_and_kilonewtons": "likely in t/m", "millimetres_and_degrees": "likely in mm"}
"""Systems of which nothing is computed -> the hint."""
SEAS = {"oc3_spar": 2e-3, "chain_polyester_chain": 1e-2, "wave_energy_converter": 2e-2}
"""Systems whose motion is a sea -> share of the mean tension that its standard deviation is at least."""


def read(name: str):
    """Return a system by its stem, the notes of its reader left out."""
    (path,) = (p for p in FOLDER.iterdir() if p.stem == name and p.suffix != ".csv")
    return load_system(path) if path.suffix == ".toml" else load(path, DEPTH if path.suffix == ".map" else None)[0]


@pytest.mark.parametrize(("name", "tension"), [("oc3_spar", OC3_TENSION), ("oc4_semi", OC4_TENSION),
                                               ("map_semi", OC4_TENSION)])  # fmt: skip
def test_published_pretensions_are_met(name, tension):
    """The three lines of both reference platforms, in TOML and as a MAP++ file, and no suspicion."""
    network = read(name)
    state = solve_network(network)
    assert np.hypot(state.H, state.V) == pytest.approx(np.full(3, tension), rel=PUBLISHED)
    assert not getattr(network, "warnings", ())


def test_a_taut_line_carries_its_stretch():
    """At the middle EA times the strain of chord and parabolic sag; half the weight more at the fairlead."""
    scene = read("taut_polyester")
    (span,), chord = scene.spans(), math.dist(scene.anchor, scene.fairlead)
    tension = scene.cable.EA * (chord / scene.length - 1)
    for _ in range(20):
        sag = (span.w * span.x / tension) ** 2 / 24  # relative lengthening of the parabola under w cos(angle) chord
        tension = scene.cable.EA * (chord * (1 + sag) / scene.length - 1)
    by_hand = tension + span.w * span.z / 2
    assert solve_span(span).tension == pytest.approx(by_hand, rel=HAND)
    assert scene.warnings == ()


@pytest.mark.parametrize("name", ["oc3_spar", "oc4_semi", "taut_polyester", "wave_energy_converter",
                                  "chain_polyester_chain", "delta_spar", "barge"])  # fmt: skip
def test_each_hangs_in_balance(name):
    """What moves has an equilibrium on the mesh; in still water its pretensions are those of exact catenaries."""
    system = read(name)
    made = mooring_system(system, 20)
    assert solve_static(made).success
    if isinstance(system, Scene) or any(system.environment.current):
        return
    state = solve_network(system)
    forces = [made.end_force(made.rest_state()[..., None], *[np.zeros((*made.rest_state().shape, 1))] * 2, -1, e)[0]
              for e in range(len(system.elements))]  # fmt: skip
    assert np.linalg.norm(forces, axis=1) == pytest.approx(np.hypot(state.H, state.V), rel=MESH)


@pytest.mark.parametrize("name", SEAS)
def test_a_sea_of_its_own_is_a_load_case(name):
    """A minute of it: solved, every section a row, and moved as much as its waves are high."""
    system = read(name)
    assert isinstance(system.motion, SeaMotion)
    own = load_case_of(system)
    (row,) = solve_load_cases(system, [LoadCase("a minute", own.motion, 60.0, 20.0)], dt=0.2, cells=20).cases
    assert row.success, row.message
    assert len(row.lines) == len(getattr(system, "elements", (None,)))
    assert all(line.standard_deviation >= SEAS[name] * line.mean for line in row.lines)


@pytest.mark.parametrize(("name", "count"), [("oc3_spar", 5), ("oc4_semi", 4)])
def test_their_tables_of_load_cases_are_read(name, count):
    """Every row is a load case, with its offset, heading and operators."""
    rows = read_load_cases(FOLDER / f"{name}_cases.csv", read(name))
    assert len(rows) == count and all(isinstance(row, LoadCase) for row in rows), rows


def test_tonnes_and_kilonewtons_are_named():
    """Mass in t/m is refused, as such a line floats; once it is mended, EA and breaking load are suspected."""
    path = FOLDER / "tonnes_and_kilonewtons.toml"
    with pytest.raises(InputError, match=r"mass_per_length = 0\.287 kg/m .* likely in t/m, 287 kg/m"):
        Scene.load(path)
    text = path.read_text(encoding="utf-8").replace("0.287 ", "287.0 ")
    mended = path.with_name("mended.toml")
    stiffness, strength = _warnings_of(text, mended)
    assert re.search(r"EA = 1\.23e\+06 N .* likely in kN, 1\.23e\+09 N", stiffness)
    assert re.search(r"breaking_load = 13500 N .* likely in kN, 1\.35e\+07 N", strength)


def _warnings_of(text: str, path) -> tuple[str, ...]:
    return Scene._from_tables(tomllib.loads(text), path).warnings


def test_millimetres_and_degrees_are_named():
    """Diameter and angles, each with the likely unit, in the order of the file."""
    diameter, angle = read("millimetres_and_degrees").warnings
    assert "diameter = 76.6 m" in diameter and "likely in mm, 0.0766 m" in diameter
    assert "turns the body by 4 rad" in angle and "likely in degrees" in angle


@pytest.mark.parametrize("program", [networks, measure, table], ids=["network", "line", "load cases"])
def test_a_line_lighter_than_any_is_refused_before_the_work(program, tmp_path, capsys):
    """By each program of a page, with all that is suspected; a given weight is what lets it pass."""
    path = FOLDER / "millimetres_and_degrees.toml"
    if program is measure:  # of a line without a seabed, which may float
        text = (FOLDER / "taut_polyester.toml").read_text(encoding="utf-8").replace("diameter = 0.2", "diameter = 200")
        path = tmp_path / "mine.toml"
        path.write_text(re.sub("submerged_weight.*", "", text), encoding="utf-8")
    assert program.main([str(path), "--out", str(tmp_path / "out")]) == 2
    message = capsys.readouterr().err
    assert "likely in mm" in message and "give submerged_weight" in message
    assert program is measure or "likely in degrees" in message
    assert not list(tmp_path.glob("out/*.json"))


def test_files_of_other_programs_are_suspected_too(tmp_path):
    """EA in kN in a MoorDyn file, once for the four lines that have it; the file as it was written gives no cause."""
    text = (FOLDER / "barge.txt").read_text(encoding="utf-8")
    path = tmp_path / "barge.txt"
    path.write_text(text.replace("4.9E8", "4.9E5"), encoding="utf-8")
    (warning,) = load(path)[0].warnings
    assert warning.startswith("line 1: EA = 490000 N") and "likely in kN" in warning
    assert load(FOLDER / "barge.txt")[0].warnings == load(FOLDER / "map_semi.map", DEPTH)[0].warnings == ()


def test_a_given_weight_is_taken(tmp_path):
    """What is light by mass and diameter is meant where its weight is given."""
    text = (FOLDER / "millimetres_and_degrees.toml").read_text(encoding="utf-8")
    path = tmp_path / "mine.toml"
    path.write_text(text.replace("diameter = 76.6", "diameter = 76.6\nsubmerged_weight = 900.0"), encoding="utf-8")
    network, _ = load(path)
    assert network.elements[0].cable.submerged_weight == 900.0


def test_depth_of_a_map_file_is_asked_for():
    """With the option of the command line."""
    with pytest.raises(InputError, match="--depth"):
        load(FOLDER / "map_semi.map")


SLIPS = [  # of operators: header and row, message
    ("frequency,surge,surge_phase\n0.1,1,-90\n", "surge_phase: 90 rad is more than a turn.*surge_phase_deg"),
    ("period,surge,pitch\n12,0.6,0.3\n", "17.2 degrees a metre.*times the slope.*name the column pitch_deg"),
]


@pytest.mark.parametrize(("text", "message"), SLIPS, ids=["phase", "rotation"])
def test_operators_in_degrees_are_named(text, message, tmp_path):
    """Phases and rotations in columns of radians; nothing is moved by them."""
    (tmp_path / "raos.csv").write_text(text)
    scene = (FOLDER / "oc3_spar.toml").read_text(encoding="utf-8").replace("spar_raos.csv", "raos.csv")
    (tmp_path / "mine.toml").write_text(scene, encoding="utf-8")
    with pytest.raises(InputError, match=message):
        load_system(tmp_path / "mine.toml")


def test_a_series_in_place_of_the_motion_keeps_the_file(tmp_path):
    """Breaking loads and factors stay those of the file; rotations of the series in degrees are suspected."""
    (tmp_path / "series.csv").write_text("time,surge,pitch\n" + "".join(f"{t},0.1,{t % 3}\n" for t in range(9)))
    moved, _ = load(FOLDER / "oc3_spar.toml", series=tmp_path / "series.csv")
    assert moved.breaking_loads == (5.5e6,) * 3 and moved.safety_factors == (1.3, 1.75)
    assert any("series.csv turns the body by" in text and "likely in degrees" in text for text in moved.warnings)


def test_a_system_that_is_made_already_is_said_to_be():
    """In place of a line of the wrong mesh."""
    made = mooring_system(read("wave_energy_converter"), 10)
    with pytest.raises(InputError, match=r"is a MooringSystem already: solve it as it is, .* with_motion"):
        mooring_system(made)


@pytest.mark.parametrize("path", [p for p in sorted(FOLDER.iterdir()) if p.suffix != ".csv"], ids=lambda p: p.stem)
def test_each_has_its_page(path, request, tmp_path):
    """As readers have it: written, or refused with the file and what to change in it."""
    if not request.config.getoption("--deep", default=False):
        pytest.skip("builds ten pages: --deep")
    depth = ["--depth", "200"] if path.suffix == ".map" else []
    command = [sys.executable, "-m", "reports", str(path), *depth, "--out", str(tmp_path / "out")]
    run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False, timeout=LONGEST)
    if path.stem in REFUSED:
        assert run.returncode == 1 and REFUSED[path.stem] in run.stderr
    else:
        assert run.returncode == 0, run.stderr
        assert (tmp_path / "out" / f"scene-{path.stem}.html").is_file() and path.stem in run.stdout
