"""Does a table or a series become the motion of the body that it means, and is every slip named with its place?"""

from __future__ import annotations

import math
import re
from importlib.resources import files

import numpy as np
import pytest

from solvers import BodyMotion, InputError
from solvers.io import load_body_motion, load_network

NETWORKS = files("reference_data") / "scenes" / "networks"
MOVING = (NETWORKS / "oc3_moving.toml").read_text(encoding="utf-8")
TABLE = MOVING[MOVING.index("[motion]") :]
POINTS = [(5.2, 0.0, -70.0), (-2.6, 4.5, -70.0)]
TIMES = np.linspace(0.0, 12.0, 25)

ROUNDING = 1e-13
"""m, of displacements of some metres and arms of 70 m: a few roundings."""


def with_motion(folder, table):
    path = folder / "moving.toml"
    path.write_text(MOVING.replace(TABLE, f"[motion]\n{table}\n"), encoding="utf-8")
    return path


def written(folder, text, name="series.csv"):
    path = folder / name
    path.write_bytes(text.encode("utf-8"))
    return path


def same(one: BodyMotion, other: BodyMotion, times=TIMES):
    assert one.reference == other.reference
    for a, b in zip(one.trajectory(POINTS, times), other.trajectory(POINTS, times), strict=True):
        np.testing.assert_allclose(a, b, rtol=0, atol=ROUNDING)
        assert abs(b).max() > 0.01


# ---------------------------------------------------------------- what a table means
def test_the_example_moves_in_three_degrees_of_freedom():
    """Period, amplitudes and phases of the file arrive, and the lines have what motion takes."""
    network = load_network(NETWORKS / "oc3_moving.toml")
    expected = BodyMotion.harmonic(1 / 12.0, (2.0, 0.0, 0.5, 0.0, 0.03, 0.0), (0.0, 0.0, 1.2, 0.0, 0.4, 0.0))
    same(network.motion, expected)
    cable = network.elements[0].cable
    assert (cable.diameter, cable.mass_per_length, cable.Cdn, cable.Cdb, cable.Ca) == (0.09, 77.7066, 1.6, 1.6, 1.0)
    assert (network.environment.seabed_stiffness, network.environment.seabed_damping) == (1e4, 1e3)


def test_every_dynamic_key_of_a_network_arrives(tmp_path):
    """Coefficients of the line type, drag and added mass of a node, current: by hand."""
    text = MOVING.replace("Cdn = 1.6", "Cdn = 1.6\nCdb = 1.5\nCdt = 0.1\ndamping = 0.02")
    text = text.replace("r = [5.2, 0.0, -70.0]", "r = [5.2, 0.0, -70.0]\nCdA = 3.0\nCa = 0.5")
    text = text.replace("depth = 320.0", "depth = 320.0\ncurrent = [0.5, 0.1, 0.0]")
    network = load_network(written(tmp_path, text, "all.toml"))
    cable = network.elements[2].cable
    assert (cable.Cdn, cable.Cdb, cable.Cdt, cable.damping) == (1.6, 1.5, 0.1, 0.02)
    assert [(node.CdA, node.Ca) for node in network.nodes] == [(0.0, 0.0), (3.0, 0.5)] + [(0.0, 0.0)] * 4
    assert network.environment.current == (0.5, 0.1, 0.0)


def test_a_network_at_rest_has_no_motion_and_needs_no_section():
    network = load_network(NETWORKS / "oc3_three_lines.toml")
    assert network.motion is None and network.elements[0].cable is None and network.notes == ()


def test_rows_are_harmonics(tmp_path):
    path = with_motion(
        tmp_path,
        "frequency = 0.1\nreference = [1, 2, -10]\nsine = [[1, 0, 0, 0, 0.1, 0], [0, 2, 0, 0, 0, 0]]\n"
        "cosine = [[0, 0, 0, 0, 0, 0.2], [0, 0, 3, 0.1, 0, 0]]",
    )
    sine, cosine = [[1, 0, 0, 0, 0.1, 0], [0, 2, 0, 0, 0, 0]], [[0, 0, 0, 0, 0, 0.2], [0, 0, 3, 0.1, 0, 0]]
    same(load_network(path).motion, BodyMotion.periodic(0.1, sine, cosine, (1, 2, -10)))
    path = with_motion(tmp_path, "frequency = 0.1\ncosine = [[0, 0, 0, 0, 0, 0.2]]")
    same(load_network(path).motion, BodyMotion.harmonic(0.1, [0, 0, 0, 0, 0, 0.2], [0, 0, 0, 0, 0, math.pi / 2]))


def test_phase_and_reference_may_be_left_out(tmp_path):
    """Sines about the origin."""
    motion = load_network(with_motion(tmp_path, "frequency = 0.1\namplitude = [1, 2, 3, 0.1, 0.2, 0.3]")).motion
    same(motion, BodyMotion.harmonic(0.1, (1, 2, 3, 0.1, 0.2, 0.3)))
    assert motion.reference == load_body_motion(NETWORKS / "drift.csv").reference == (0.0, 0.0, 0.0)


def test_a_series_beside_the_network(tmp_path):
    """The file is looked up from the folder of the network, and turns about the reference point of the table."""
    time = np.linspace(0.0, 12.0, 40)
    rows = "\n".join(f"{t!r},{math.sin(t)!r},{math.cos(t)!r}" for t in time.tolist())
    written(tmp_path, "time,sway,pitch\n" + rows + "\n")
    motion = load_network(with_motion(tmp_path, 'file = "series.csv"\nreference = [0, 0, -10]')).motion
    same(motion, load_body_motion(tmp_path / "series.csv", (0.0, 0.0, -10.0)))
    s, R = motion.pose(time)
    np.testing.assert_allclose(s[1], np.sin(time), atol=ROUNDING)
    np.testing.assert_allclose(R[0, 2], np.sin(np.cos(time)), atol=ROUNDING)


# ---------------------------------------------------------------- what a series means
def test_columns_stand_in_any_order_and_angles_in_degrees(tmp_path):
    """Byte order mark, Windows line ends, blank lines, comments, blanks beside commas; degrees become rad."""
    text = "\ufeff# measured\r\n yaw_deg , time,heave\r\n\r\n10, 0, 1\r\n20,1,  4\r\n# gap\r\n30,2,9\r\n40,3,16\r\n"
    motion = load_body_motion(written(tmp_path, text))
    t = np.array([0.0, 0.5, 2.5])
    np.testing.assert_allclose(motion.translation.displacement(t), [0 * t, 0 * t, (1 + t) ** 2], atol=ROUNDING * 16)
    np.testing.assert_allclose(motion.rotation.displacement(t)[2], np.radians(10 + 10 * t), atol=ROUNDING)


def test_columns_that_are_not_there_are_zero(tmp_path):
    assert load_body_motion(written(tmp_path, "time,surge\n0,0\n1,2\n")).rotation is None
    assert load_body_motion(written(tmp_path, "time,roll\n0,0\n1,2\n")).translation is None
    still = load_body_motion(written(tmp_path, "time,surge\n0,0\n1,0\n"))
    assert not still.displacement(POINTS, 0.5).any()


# ---------------------------------------------------------------- what is refused, and where
SERIES = [
    ("time,surge,Yaw\n0,0,0\n", ":1: unknown column 'Yaw'; did you mean 'yaw'?"),
    ("time,x\n0,0\n", ":1: unknown column 'x'; known columns are time, surge"),
    ("surge,yaw\n0,0\n", ":1: columns surge, yaw must be time and one or more of surge"),
    ("time\n0\n", ":1: columns time must be time and one or more of surge"),
    ("time,yaw,yaw_deg\n0,0,0\n", ":1: column 'yaw_deg' is there already"),
    ("# c\ntime,surge\n0,0\n1,a\n", ":4: column 'surge': 'a' must be a finite number"),
    ("time,surge\n0,0\n1,nan\n", ":3: column 'surge': 'nan' must be a finite number"),
    ("time,surge\n0,0\n1,\n", ":3: column 'surge': '' must be a finite number"),
    ("time,surge\n0,0\n1\n", ":3: 1 values where there are 2 columns"),
    ("time,surge\n0,0\n", ": time: 1 rows of numbers; a series has two or more"),
    ("time,surge\n0,0\n2,1\n1,1\n", ": time: must increase (s), and 1 follows 2 at index 2"),
    ("# nothing\n", ": has no line of column names: time, surge"),
]


@pytest.mark.parametrize(("text", "message"), SERIES, ids=[message[:32] for _, message in SERIES])
def test_what_is_wrong_with_a_series_is_named_with_its_line(tmp_path, text, message):
    path = written(tmp_path, text)
    with pytest.raises(InputError, match="^" + re.escape(str(path) + message)):
        load_body_motion(path)


TABLES = [
    ("frequncy = 0.1", "unknown key 'frequncy' in [motion]; did you mean 'frequency'?"),
    (
        "frequency = 0.1",
        "[motion] takes one of amplitude (m, rad), sine with cosine (m, rad), file, and spectrum; given: none",
    ),
    ('amplitude = [1,0,0,0,0,0]\nfile = "a"', "file, and spectrum; given: amplitude and file"),
    ("amplitude = [1,0,0,0,0,0]", "motion.frequency: takes either frequency (Hz) or period (s); given: none"),
    ("amplitude = [1,0,0,0,0,0]\nperiod = 0.0", "motion.period: 0 s must be > 0"),
    ("amplitude = [1,0,0]\nperiod = 9.0", "motion.amplitude: [1, 0, 0] must be six numbers, surge, sway"),
    ("amplitude = [1,0,0,0,'a',0]\nperiod = 9.0", "motion.amplitude[4]: 'a' must be a real number (rad)"),
    ("amplitude = [1,0,0,0,0,0]\nperiod = 9.0\ncosine = []", "file, and spectrum; given: amplitude and cosine"),
    ("sine = [[1,0,0,0,0,0]]\nperiod = 9.0\nphase = []", "motion.phase: has no meaning beside sine; leave it out"),
    ("sine = [1,0,0,0,0,0]\nperiod = 9.0", "motion.sine: [1, 0, 0, 0, 0, 0] must be rows of six"),
    ("sine = [[1,0,0,0,0,true]]\nperiod = 9.0", "motion.sine[0]: True must be a real number (rad)"),
    ('file = "a.csv"\nperiod = 9.0', "motion.period: has no meaning beside file; leave it out"),
    ('file = "a.csv"', "a.csv: cannot be read: No such file"),
    ("file = 3", "motion.file: 3 must be a text"),
    ("amplitude = [1,0,0,0,0,0]\nperiod = 9.0\nreference = 3", "motion.reference: 3 must be three coordinates"),
]


@pytest.mark.parametrize(("table", "message"), TABLES, ids=[message[:32] for _, message in TABLES])
def test_what_is_wrong_with_a_table_is_named_with_its_key(tmp_path, table, message):
    path = with_motion(tmp_path, table)
    with pytest.raises(InputError, match="^" + re.escape(str(path)) + ": .*" + re.escape(message)):
        load_network(path)


LACKING = [
    (
        "diameter = 0.09            # m\n",
        "submerged_weight = 698.0\n",
        "[[elements]] number 1: line_type: its line type",
    ),
    ("seabed_stiffness = 1e4     # N/m^2\n", "", "environment.seabed_stiffness: not given (N/m^2), and [motion] over"),
    ('kind = "coupled"', 'kind = "fixed"', 'motion: no node has kind = "coupled", which a body would move'),
    (TABLE, "motion = 3", "unknown key 'motion' in [[elements]] number 3"),
    ('name = "OC3 Hywind, moving"', "motion = 3", "motion: 3 must be a table, [motion]"),
]


@pytest.mark.parametrize(("old", "new", "message"), LACKING, ids=[message[:32] for *_, message in LACKING])
def test_what_a_moving_network_lacks_is_named(tmp_path, old, new, message):
    text = MOVING if new != "motion = 3" or old == TABLE else MOVING.replace(TABLE, "")
    path = written(tmp_path, text.replace(old, new), "moving.toml")
    with pytest.raises(InputError, match="^" + re.escape(f"{path}: ") + ".*" + re.escape(message)):
        load_network(path)


@pytest.mark.parametrize("path", [None, 3, "\x00"])
def test_what_is_no_path_is_refused(path):
    with pytest.raises(InputError, match="is not the path of a CSV file"):
        load_body_motion(path)


def test_bytes_that_are_no_text_are_refused(tmp_path):
    path = tmp_path / "bytes.csv"
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match=r"bytes\.csv: cannot be read as a text file"):
        load_body_motion(path)
