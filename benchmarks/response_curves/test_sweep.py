"""Does the sweep of one's own line read what it is given, keep what it has, and say what the curve means?"""

from __future__ import annotations

import argparse
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from solvers import InputError, Scene, mooring_system, solve_periodic

from . import meaning, sweep
from .confirm import confirm
from .integration import GAP_FREQUENCIES
from .systems import CASES, oc3

ROOT = Path(__file__).parents[2]
LINE = ROOT / "reference_data" / "scenes" / "dynamics" / "hb_case_1.toml"
MOVING = ROOT / "reference_data" / "scenes" / "networks" / "oc3_moving.toml"
NETWORK = ROOT / "reference_data" / "scenes" / "networks" / "three_bridles_moving.toml"
BAND = (0.03, 0.045)
SAME_MOTION = 2e-3  # of the greatest tension: 24 cells in both, 7 harmonics against 100 steps in the period
SAME_TENSION = 1e-6  # of a tension that two solves of the same response give


@pytest.fixture(scope="module")
def case():
    return sweep.prepare(LINE, BAND, 1.0)


def followed(case, folder, stop_after=None, band=BAND):
    """The Sweep of a case, ended after so many yields, as by an interruption."""
    record = sweep.Sweep(case, band, folder, "test")
    for number, _ in enumerate(record.follow(), start=1):
        if number == stop_after:
            return record
    return record


def test_an_interrupted_sweep_goes_on_from_its_points(case, tmp_path, monkeypatch):
    """Ended after its first points and called again: bit for bit the curve of one call, and none solved twice."""
    monkeypatch.setattr(sweep, "CHUNK", 3)
    followed(case, tmp_path / "two", stop_after=1)
    kept = next((tmp_path / "two").glob("*.npz"))
    assert sweep.load_curve(kept, case.system).values.size == 3
    again = followed(case, tmp_path / "two").curves[0]
    whole = followed(case, tmp_path / "one").curves[0]
    assert whole.values.size > 6 and whole.values[-1] == BAND[1]
    assert np.array_equal(again.values, whole.values) and np.array_equal(again.z, whole.z)


def test_the_largest_tension_is_that_of_a_direct_solve(case, tmp_path):
    """The sentence names the frequency of the largest tension and its value, which a solve there gives as well."""
    record = followed(case, tmp_path)
    report = sweep.report(case, BAND, record.curves, LINE)
    curve = record.curves[0]
    k = int(curve.greatest[:, 0].argmax())
    direct = solve_periodic(curve.response(k).system, harmonics=sweep.HARMONICS, start=curve.response(k))
    tension = float(sweep.tensions(direct).max())
    assert curve.greatest[k, 0] == pytest.approx(tension, rel=SAME_TENSION)
    assert f"{tension / 1e3:.4g} kN, at {curve.values[k]:.4g} Hz" in report["sentences"][0]
    integrated = report["integrated_at_largest"][0]["greatest"][0]
    assert integrated == pytest.approx(tension, rel=SAME_MOTION)
    assert f"time integration gives {integrated / 1e3:.4g} kN there" in report["sentences"][0]
    assert report["sentences"][1].startswith("No jumps") and report["sentences"][2].startswith("No instability")
    assert len(report["sentences"]) == 3


def test_what_a_curve_leaves_out_is_integrated(case, tmp_path, monkeypatch):
    """A curve that ends early: the gap is named, with the largest tension of the integrations at its frequencies."""
    monkeypatch.setattr(sweep, "MOST_POINTS", 2)
    monkeypatch.setattr(sweep, "CHUNK", 2)
    report = sweep.report(case, BAND, followed(case, tmp_path).curves, LINE)
    low, high = report["gap"]
    up, down = (curve["frequency"] for curve in report["curves"])
    assert BAND[0] < low == max(up) < high == min(down) < BAND[1]
    rows = report["integrated"]
    assert len(rows) == GAP_FREQUENCIES and low < rows[0]["frequency"] and rows[-1]["frequency"] == high
    motion = Scene.load(LINE).motion.scaled(1.0 / 5.0)
    for row in rows[::4]:
        line = mooring_system(Scene.load(LINE), sweep.CELLS, motion=replace(motion, frequency=row["frequency"]))
        tension = sweep.tensions(solve_periodic(line, harmonics=sweep.HARMONICS))[0]
        assert [row["greatest"][0], row["least"][0]] == pytest.approx([tension.max(), tension.min()], rel=SAME_MOTION)
    largest = max(row["greatest"][0] for row in rows)
    assert f"there gives up to {largest / 1e3:.4g} kN, at" in report["sentences"][3]
    assert "where the curve was followed" in report["sentences"][0] and "followed" in report["sentences"][1]


def test_a_damped_seabed_does_not_end_the_curve(tmp_path):
    """Its damping grows from contact on over what the line sinks, as a note says; at once it ends the curve early."""
    band = (0.065, 0.08)
    case = sweep.prepare(MOVING, band)
    line, whole = case.system.line, case.whole_system.line
    assert line.seabed_damping.all() and np.array_equal(line.seabed_damping, whole.seabed_damping)
    assert line.contact_depth == pytest.approx(698.094 / 1e4, rel=1e-3) and whole.contact_depth == 0
    assert any("grow from contact on, over the 0.07 m" in note for note in case.notes)
    grows = followed(case, tmp_path, band=band).curves
    jumps = followed(replace(case, system=case.whole_system), tmp_path / "at once", band=band).curves
    assert [curve.success for curve in grows] == [True] and not jumps[0].success


def test_amplitude_scales_the_motion_of_the_file(case):
    """The largest displacement is the amplitude; without one that of the file; networks move in six directions."""
    times = np.linspace(0, case.system.motion.period, 401)
    assert abs(case.system.motion.displacement(times)).max() == pytest.approx(1.0, rel=1e-3)
    assert sweep.prepare(LINE, BAND).amplitude == pytest.approx(5.0, rel=1e-3)
    network = sweep.prepare(NETWORK, BAND, 0.5)
    assert network.amplitude == 0.5 and len(network.lines) == 9


@pytest.mark.parametrize(
    ("amplitude", "message"), [(None, "motion: its amplitude is 0 m"), (1.0, "amplitude: 1 m cannot scale a motion")]
)
def test_a_file_whose_motion_is_zero_is_refused(amplitude, message, tmp_path, capsys):
    """On the command line: an exit status, and the field and what to do on the standard error."""
    text = LINE.read_text(encoding="utf-8")
    still = tmp_path / "still.toml"
    still.write_text(re.sub(r"(?m)^amplitude *=.*$", "amplitude = [0.0, 0.0, 0.0]", text), encoding="utf-8")
    given = [] if amplitude is None else ["--amplitude", str(amplitude)]
    status = sweep.main([str(still), "--band", "0.03:0.045", "--out", str(tmp_path), *given])
    assert status == sweep.BAD_FILE and message in capsys.readouterr().err
    assert not list(tmp_path.rglob("sweep*"))


def test_jumps_and_instability_are_named():
    """Folds of the motion are jumps, those of the series are not; unstable points have their band and their kind."""
    curve = {"special": [{"kind": "fold", "value": 0.1}, {"kind": "period doubling", "value": 0.15}],
             "unresolved": [{"kind": "fold", "value": 0.2, "doubt": "no multiplier near one"}],
             "errors": [0.0, 0.0, 0.0], "least": [[1.0, 1.0, 1.0]],
             "frequency": [0.1, 0.15, 0.2], "stable": [True, False, True], "sideways": [0.5, 1.2, 0.5]}  # fmt: skip
    jumps, unstable = meaning._jumps([curve], None), meaning._instability([curve], None)
    assert "Jumps at 0.1 Hz" in jumps and "0.2" not in jumps
    assert next(iter(meaning._doubts({"curves": [curve], "harmonics": 7}))).startswith(
        "At 0.2 Hz the series of 7 harmonics turns back"
    )
    assert "Unstable at 0.15 Hz (period doubling, growth across the plane of the line)" in unstable


@pytest.mark.parametrize("text", ["0.3:0.1", "0.1", "a:b", "0:0.1", "-1:2"])
def test_a_band_that_is_none_is_refused(text):
    with pytest.raises(argparse.ArgumentTypeError, match=r"no band of frequencies in Hz, such as 0\.02:0\.3"):
        sweep.read_band(text)


def test_a_line_that_cannot_move_is_named():
    """A scene without a diameter has no drag: the field is named."""
    with pytest.raises(InputError, match="diameter"):
        sweep.prepare(ROOT / "reference_data" / "scenes" / "oc3_hywind.toml", BAND)


def test_time_integration_tells_a_fold_of_a_taut_cable():
    """Both sides of the first special point of the taut cable fare as the multipliers say, growth to a hundredth."""
    from .curves import follow

    case = next(each for each in CASES if each.name == "taut")
    curve = follow(case, case.amplitudes[0], 30)
    rows = [row for row in confirm(curve) if row["special"] == 0]
    assert [row["agrees"] for row in rows] == [True, True]
    assert [row["outcome"] for row in rows] == ["returned", "left"]
    assert rows[1]["measured"] == pytest.approx(rows[1]["multiplier"], rel=0.01)


def test_the_lines_are_moved_as_named():
    """The OC3 line in surge moves along x by its amplitude, at its frequency."""
    system = oc3(2.0, 0.05)
    times = np.linspace(0, 20.0, 201)
    assert abs(system.motion.displacement(times)[0]).max() == pytest.approx(2.0, rel=1e-3)
    assert system.period == pytest.approx(20.0)
