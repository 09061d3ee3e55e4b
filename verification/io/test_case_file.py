"""Files of sea states and load cases: what they say arrives, and what is wrong is named with file, line and column."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

from solvers import BodyMotion, InputError, Scene
from solvers.common.load_case import RAMP
from solvers.common.motions.sea_state import SeaMotion, SeaState
from solvers.io import load_network
from solvers.io.case_file import describe_columns, load_case_of, load_system, read_load_cases, read_records, write_rows
from solvers.io.keys import CASES
from solvers.io.series.sea_file import load_response_operators, load_spectrum
from verification import ROOT

SCENES = ROOT / "reference_data" / "scenes"
OPERATORS = "frequency,surge,surge_phase_deg,pitch_deg\n0.01,1.0,-90,0.5\n0.1,0.5,-90,0.2\n1.0,0,0,0\n"
SEA = '[motion]\nspectrum = "jonswap"\nHs = 3.0\nTp = 9.0\nseed = 4\nduration = 600.0\noperators = "raos.csv"\n'


@pytest.fixture
def folder(tmp_path):
    """A folder with operators, a spectrum, a series and a scene without motion."""
    (tmp_path / "raos.csv").write_text(OPERATORS)
    (tmp_path / "sea.csv").write_text("# measured\nfrequency,density\n0.05,0\n0.1,2.0\n0.2,0\n")
    (tmp_path / "drift.csv").write_text("time,surge\n0,0\n30,1\n60,0\n90,1\n")
    text = (SCENES / "dynamics" / "hb_case_1.toml").read_text()
    (tmp_path / "still.toml").write_text(text[: text.index("[motion]")])
    (tmp_path / "moving.toml").write_text(text[: text.index("[motion]")] + SEA)
    return tmp_path


def test_operators_arrive_in_radians(folder):
    """Degrees become radians, phases lead, and the imaginary part is that of exp(i phase)."""
    made = load_response_operators(folder / "raos.csv")
    assert made.frequency.tolist() == [0.01, 0.1, 1.0] and made.heading.tolist() == [0.0]
    assert made.operators[0, 0] == pytest.approx([-1j, 0, 0, 0, math.radians(0.5), 0], abs=1e-15)


def test_operators_of_headings_and_periods(folder):
    """Rows of any order, periods in s in place of frequencies; the steepest roll and a whole turn, as they are rounded.

    0.322 rad/m at 0.1 Hz is 8 times the slope of the wave, (2 pi 0.1)^2 / 9.80665.
    """
    path = folder / "headings.csv"
    path.write_text(
        "heading,period,heave,roll,roll_phase\n90,10,0.3,0.3,6.283186\n0,10,0.1,0,0\n0,5,0.2,0,0\n90,5,0.4,0,0\n"
    )
    made = load_response_operators(path)
    assert made.frequency == pytest.approx([0.1, 0.2]) and made.heading.tolist() == [0, 90]
    assert made.operators[:, :, 2].real.tolist() == [[0.1, 0.2], [0.3, 0.4]]


def test_a_spectrum_arrives(folder):
    """Its columns are its lines."""
    made = load_spectrum(folder / "sea.csv")
    assert made.frequency.tolist() == [0.05, 0.1, 0.2] and made.moment(0) == pytest.approx(0.15)


@pytest.mark.parametrize("kind", ["scene", "network"])
def test_motion_from_a_spectrum(folder, kind):
    """[motion] of a scene or network with a spectrum is the motion of that sea, and moves about its reference point."""
    path = folder / "moving.toml"
    if kind == "network":
        text = (SCENES / "networks" / "oc3_moving.toml").read_text()
        path.write_text(text[: text.index("[motion]")] + SEA + "reference = [0.0, 0.0, -10.0]\n")
    motion = (load_network(path) if kind == "network" else Scene.load(path)).motion
    assert isinstance(motion, SeaMotion) and motion.sea.seed == 4 and motion.sea.duration == 600.0
    assert motion.reference == (0.0, 0.0, -10.0 if kind == "network" else 0.0)
    assert motion.sea.spectrum.significant_height == pytest.approx(3.0)
    assert isinstance(load_system(path), type(load_network(path) if kind == "network" else Scene.load(path)))


def test_the_sea_of_a_system_is_a_case(folder):
    """Over the time after which its waves repeat, after a ramp; a system without one is refused."""
    system = load_system(folder / "moving.toml")
    case = load_case_of(system)
    assert case.motion is system.motion.sea and (case.name, case.duration) == ("Hs 3 m, seed 4", 600.0)
    with pytest.raises(InputError, match="is no sea: give a table of load cases"):
        load_case_of(load_system(folder / "still.toml"))


def test_rows_become_cases(folder):
    """Each kind of motion, durations, offsets and currents are read; empty cells are as columns that are not there."""
    path = folder / "cases.csv"
    path.write_text(
        "name,duration,ramp,Hs,Tp,gamma,spectrum,seed,heading,operators,period,surge,pitch_deg,motion,offset_x,current_y\n"
        "storm,600,60,6,11,3.3,,7,0,,,,,,3,0.5\n"
        "given,600,,,,,sea.csv,8,,raos.csv,,,,,,\n"
        ",50,10,,,,,,,,12.5,2.0,3,,,\n"
        "drift,70,0,,,,,,,,,,,drift.csv,,\n"
    )
    storm, given, regular, drift = read_load_cases(path, load_system(folder / "moving.toml"))
    assert (storm.name, storm.duration, storm.ramp, storm.offset, storm.current) == (
        *("storm", 600.0, 60.0, (3.0, 0.0, 0.0), (0.0, 0.5, 0.0)),
    )
    assert isinstance(storm.motion, SeaState) and (storm.motion.seed, storm.motion.duration) == (7, 660.0)
    assert storm.motion.spectrum.significant_height == pytest.approx(6.0)
    assert given.ramp == RAMP and given.motion.spectrum.moment(0) == pytest.approx(0.15) and given.current is None
    assert regular.name == "case 3" and regular.motion.period == pytest.approx(12.5)
    at = regular.motion.translation.displacement(12.5 / 4), regular.motion.rotation.displacement(12.5 / 4)
    assert np.concatenate(at) == pytest.approx([2.0, 0, 0, 0, math.radians(3), 0])
    assert isinstance(drift.motion, BodyMotion) and drift.motion.translation.displacement(30.0)[0] == pytest.approx(1.0)


ROWS = [
    ("duration,Hs,Tp,seed\n600,six,9,1\n", ":2: Hs: 'six' must be a finite number"),
    ("duration,Hs,Tp,seed\n600,-6,9,1\n", ":2: Hs: -6 m must be > 0"),
    ("duration,Hs,seed\n600,6,1\n", ":2: Tp: not given (s)"),
    ("duration,Hs,Tp\n600,6,9\n", ":2: seed: not given"),
    ("duration,Hs,Tp,seed\n600,6,9,1.5\n", ":2: seed: 1.5"),
    ("duration,Hs,Tp,seed\n,6,9,1\n", ":2: duration: not given (s)"),
    ("duration,Hs,Tp,seed\n600,6,9\n", ":2: 3 values where there are 4 columns"),
    ("duration,Hs,Tp,seed,surge\n600,6,9,1,2\n", "given: a sea and a regular motion"),
    ("duration,surge\n600,2\n", "period: None s must be > 0"),
    ("duration,period,surge\n600,0,2\n", "period: 0.0 s must be > 0"),
    ("duration,name\n600,x\n", "given: none"),
    ("duration,Hs,Tp,seed,operators\n600,6,9,1,none.csv\n", "none.csv: cannot be read"),
    ("duration,motion\n600,none.csv\n", "none.csv: cannot be read"),
    ("duration,Hs,Tp,seed,gamma,spectrum\n600,6,9,1,2,pierson_moskowitz\n", "gamma: has no meaning"),
    ("duration,Hs,Tp,seed,spectrum\n600,6,9,1,sea.csv\n", "Hs: has no meaning beside the spectrum of a file"),
]


@pytest.mark.parametrize(("text", "message"), ROWS, ids=[message[:40] for _, message in ROWS])
def test_a_bad_row_is_named_and_spoils_no_other(folder, text, message):
    """Its place in the list is an InputError with file, line and column; the row after it is read."""
    path = folder / "cases.csv"
    path.write_text(text + "\n")
    (case,) = read_load_cases(path, load_system(folder / "moving.toml"))
    assert isinstance(case, InputError) and str(case).startswith(f"{path}:2: ") and message in str(case)


def test_a_sea_without_operators_is_named(folder):
    """Where neither the row nor the system has them."""
    path = folder / "cases.csv"
    path.write_text("duration,Hs,Tp,seed\n600,6,9,1\n")
    (case,) = read_load_cases(path, load_system(folder / "still.toml"))
    assert isinstance(case, InputError) and "operators: not given" in str(case)


FILES = [
    (read_load_cases, "duration,hs\n1,2\n", ":1: unknown column 'hs'; did you mean 'Hs'?"),
    (read_load_cases, "duration,Hs\n", "has no rows of load cases"),
    (load_spectrum, "frequency\n0.1\n", "has no column 'density'"),
    (load_spectrum, "frequency,density\n0.1,1\n0.1,2\n", "must increase"),
    (load_response_operators, "frequency,surge\n0.1,-1\n", "its sign belongs to surge_phase"),
    (load_response_operators, "frequency,surge,surge_phase\n0.1,1,6.2832\n", "6.2832 rad is more than a turn"),
    (load_response_operators, "frequency,roll\n0.1,0.33\n", "roll: 0.33 rad/m at 0.1 Hz"),
    (load_response_operators, "surge\n1\n", "either frequency (Hz) or period (s)"),
    (load_response_operators, "period,surge\n0,1\n", "period: 0 s must be > 0"),
    (load_response_operators, "heading,frequency\n0,0.1\n0,0.2\n90,0.1\n", "each heading takes the same frequencies"),
    (load_response_operators, "frequency,surge\n0.1,1\n0.1,2\n", "each heading takes the same frequencies"),
]


@pytest.mark.parametrize(("read", "text", "message"), FILES, ids=[message[:40] for *_, message in FILES])
def test_a_bad_file_is_refused(tmp_path, read, text, message):
    """With its name, line and column."""
    path = tmp_path / "file.csv"
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        read(path)
    assert str(caught.value).startswith(str(path)) and message in str(caught.value)


def test_motion_of_a_bad_sea_is_named_with_its_key(folder):
    """As [motion] has it, and with the file where the fault is in that."""
    for change, message in (("Hs = 3.0", "motion.Hs: -3 m"), ("seed = 4", "motion.seed: -4")):
        text = (folder / "moving.toml").read_text()
        bad = folder / "bad.toml"
        bad.write_text(text.replace(change, change.replace("= ", "= -")))
        with pytest.raises(InputError, match=message):
            Scene.load(bad)
    (folder / "raos.csv").write_text("frequency,surge\n0.1,-1\n1,1\n")
    with pytest.raises(InputError, match=r"raos\.csv: surge: -1"):
        Scene.load(folder / "moving.toml")


def test_rows_are_written_with_all_digits(tmp_path):
    """None is an empty cell, and a number is the same when it is read again; no file of records is no record."""
    path = tmp_path / "rows.csv"
    write_rows(path, ["a", "b"], [[1 / 3, None], ["x, y", 2]])
    assert path.read_text() == 'a,b\n0.3333333333333333,\n"x, y",2\n'
    assert read_records(tmp_path / "none.jsonl") == [] and list(tmp_path.iterdir()) == [path]


NAMES = [
    ("duration,hs,Tp,seed", "did you mean 'Hs'?"),
    ("duration,significant_wave_height,Tp,seed", "did you mean 'Hs'? Significant wave height of the spectrum (m)"),
    ("duration,Hs,peak_period,seed", "did you mean 'Tp'?"),
    ("duration,Hs,Tp,seed,wave_direction", "did you mean 'heading'? Direction into which the waves run"),
    ("duration,Hs,Tp,seeds", "did you mean 'seed'?"),
    ("duration,Hs,Tp,seed,offset", "did you mean 'offset_x'? Displacement of the coupled points at rest, along x (m)"),
    ("duration,Hs,Tp,seed,qqqqqq", "known columns are Hs, Tp, amplitudes, current_x"),
]


@pytest.mark.parametrize(("header", "message"), NAMES, ids=[message for _, message in NAMES])
def test_an_unknown_column_gets_the_nearest_one(folder, header, message):
    """By another case, another name of the trade with its unit, a slip of the pen; else all columns are said."""
    path = folder / "cases.csv"
    path.write_text(header + "\n")
    with pytest.raises(InputError, match=re.escape(message)) as error:
        read_load_cases(path, None)
    assert str(error.value).startswith(f"{path}:1: unknown column")


def test_every_column_is_described_and_read(folder):
    """Each has a line with its unit; each can stand in a table, and those that are numbers are refused as words."""
    lines = dict(line.split(": ", 1) for line in describe_columns().splitlines())
    assert [name.partition(" (")[0] for name in lines] == list(CASES)
    assert "Hs (m)" in lines and "pitch_deg (degrees)" in lines and "seed" in lines
    assert f"; {RAMP:g} where it is empty." in lines["ramp (s)"]
    path = folder / "cases.csv"
    for name, key in CASES.items():
        path.write_text(f"{name}\nword\n")
        (case,) = read_load_cases(path, None)
        is_number = key.kind not in ("text", "amplitudes")
        assert isinstance(case, InputError)
        assert (f"{name}: 'word' must be a finite number" in str(case)) == is_number, name
