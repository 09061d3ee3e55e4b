"""What a scene says about motion, water and section: read as written, or refused by name."""

from __future__ import annotations

from importlib.resources import files

import numpy as np
import pytest

from solvers import InputError, Scene, Status, cable_system, solve_static

FOLDER = files("reference_data") / "scenes" / "dynamics"
ROUNDING = 1e-14  # relative: one sine of an argument that is written as a decimal

SCENE = """
tolerance = 1e-3
[environment]
depth = 60.0
current = [0.3, 0.0, 0.0]
seabed_stiffness = 2e4
[line]
length = 665.0
EA = 384.243e6
submerged_weight = 698.094
diameter = 0.09
mass_per_length = 77.7066
Cdn = 1.6
Cdt = 0.05
Ca = 1.0
damping = 0.01
[ends]
anchor = [-655.2, 0.0, -60.0]
fairlead = [-5.2, 0.0, -10.0]
[motion]
period = 12.0
amplitude = [2.0, 0.0, 1.0]
phase = [0.0, 0.0, 1.5]
"""


@pytest.fixture
def written(tmp_path):
    """SCENE in a file, with one text replaced by another."""

    def write(old="", new=""):
        assert old in SCENE
        path = tmp_path / "line.toml"
        path.write_text(SCENE.replace(old, new, 1) if old else SCENE)
        return path

    return write


def test_every_key_arrives(written):
    """Section, water and motion of the file are those of the scene."""
    scene = Scene.load(written())
    cable, water = scene.cable, scene.environment
    assert (cable.Cdn, cable.Cdb, cable.Cdt, cable.Ca, cable.damping) == (1.6, 1.6, 0.05, 1.0, 0.01)
    assert (water.depth, water.current, water.seabed_stiffness) == (60.0, (0.3, 0.0, 0.0), 2e4)
    t = np.array([0.0, 1.7, 5.0])
    expected = [2.0 * np.sin(2 * np.pi * t / 12), 0 * t, np.sin(2 * np.pi * t / 12 + 1.5)]
    np.testing.assert_allclose(scene.motion.displacement(t), expected, rtol=0, atol=3 * ROUNDING)


def test_the_tolerance_is_a_millionth_where_none_is_given(written):
    """As that of a scene that is built."""
    assert Scene.load(written()).tolerance == 1e-3
    scene = Scene.load(written("tolerance = 1e-3\n"))
    assert scene.tolerance == 1e-6 == Scene("line", scene.cable, scene.length, scene.anchor, scene.fairlead).tolerance


def test_harmonics_of_a_motion_are_rows(written):
    """Rows of amplitude and phase are the harmonics of the frequency."""
    rows = "frequency = 0.05\namplitude = [[0, 5, 0], [2.5, 0, 0]]\nphase = [[0, 0, 0], [0.3, 0, 0]]\n"
    motion = Scene.load(written(SCENE[SCENE.index("period = 12") :], rows)).motion
    expected = [2.5 * np.sin(0.2 * np.pi * 3.0 + 0.3), 5 * np.sin(0.1 * np.pi * 3.0), 0.0]
    np.testing.assert_allclose(motion.displacement(3.0), expected, rtol=0, atol=6 * ROUNDING)
    assert motion.period == 20.0 and motion.harmonics == 2


def test_one_row_of_a_motion_is_its_first_harmonic(written):
    """A list of one row is that row."""
    rows = "period = 12.0\namplitude = [[2.0, 0.0, 1.0]]\nphase = [[0.0, 0.0, 1.5]]\n"
    one = Scene.load(written(SCENE[SCENE.index("period = 12") :], rows)).motion
    assert one.harmonics == 1
    assert np.array_equal(one.displacement(3.0), Scene.load(written()).motion.displacement(3.0))


@pytest.mark.parametrize(
    ("friction", "wanted"), [("", (0.0,)), ("friction = 0.3\n", (0.3,)), ("friction = [0, 1.0]\n", (0, 1.0))]
)
def test_friction_is_what_the_file_says(written, friction, wanted):
    """One coefficient, several, or none of it."""
    assert Scene.load(written("EA =", f"{friction}EA =")).friction == wanted


@pytest.mark.parametrize("phase", [0.0, 1.0, 2.0, 3.0, 4.0, 5.0])
def test_a_motion_may_touch_the_seabed_and_not_pass_it(written, phase):
    """50 m down from z = -10 m to the seabed is accepted, 50.1 m is not, wherever in a period of 1 s it is lowest."""
    motion = SCENE[SCENE.index("period = 12") :]
    heave = f"period = 1.0\namplitude = [0, 0, {{}}]\nphase = [0, 0, {phase}]\n"
    assert Scene.load(written(motion, heave.format(50.0))).motion.harmonics == 1
    with pytest.raises(InputError, match=r"motion.amplitude: takes the fairlead down to z = -60.*below the seabed"):
        Scene.load(written(motion, heave.format(50.1)))


def test_a_motion_down_to_the_seabed_itself_is_accepted(written):
    """Its lowest place is exactly the seabed."""
    motion = SCENE[SCENE.index("period = 12") :]
    scene = Scene.load(written(motion, "period = 4.0\namplitude = [0, 0, 50.0]\n"))
    assert scene.fairlead[2] + scene.motion.displacement(3.0)[2] == -60.0


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.toml")), ids=lambda path: path.stem)
def test_shipped_scenes_have_an_equilibrium(path):
    """Every shipped scene with motion is read, and its line is in equilibrium on the default mesh."""
    scene = Scene.load(path)
    assert scene.motion is not None
    assert solve_static(cable_system(scene)).status is Status.SUCCESS


def test_four_cases_of_the_paper():
    """The shipped cases 1 to 4 move as the paper says: Y, X, Z of 5 m at 0.05 Hz; Y 2.5 m at 0.1 Hz with Z 5 m."""
    quarter = 5.0  # s, the sine of 0.05 Hz is 1
    at_quarter = {1: [5, 0, 0], 2: [0, 0, 5], 3: [0, 5, 0], 4: [0, 5, 0]}
    at_eighth = {4: [2.5, 5 * np.sqrt(0.5), 0]}
    for case, place in at_quarter.items():
        motion = Scene.load(FOLDER / f"hb_case_{case}.toml").motion
        np.testing.assert_allclose(motion.displacement(quarter), place, rtol=0, atol=6 * ROUNDING)
        assert motion.period == 20.0
        if case in at_eighth:
            np.testing.assert_allclose(motion.displacement(quarter / 2), at_eighth[case], rtol=0, atol=6 * ROUNDING)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("period = 12.0\n", "", r"\[motion\] takes either frequency \(Hz\) or period \(s\); given: none"),
        ("period = 12.0", "period = 12.0\nfrequency = 0.1", r"\[motion\] takes .* given: frequency and period"),
        ("period = 12.0", "period = 0.0", r"motion.period: 0 s must be > 0"),
        ("period = 12.0", "frequency = -0.1", r"motion.frequency: -0.1 Hz must be > 0"),
        ("amplitude = [2.0, 0.0, 1.0]\n", "", r"missing key 'amplitude' in \[motion\]"),
        ("[2.0, 0.0, 1.0]", "[2.0, 0.0]", r"motion.amplitude: \[2.0, 0.0\] must be three components \[x, y, z\] \(m\)"),
        ("[2.0, 0.0, 1.0]", "5.0", r"motion.amplitude: 5.0 must be three components"),
        ("[2.0, 0.0, 1.0]", "[]", r"motion.amplitude: \[\] must be three components"),
        ("[2.0, 0.0, 1.0]", "[2.0, nan, 1.0]", r"motion.amplitude\[1\]: nan m must be finite"),
        ("[2.0, 0.0, 1.0]", "[[2.0, 0, 1], [0, 1]]", r"motion.amplitude\[1\]: \[0, 1\] must be three components"),
        ("[2.0, 0.0, 1.0]", "[[2.0, 0, 1], [0, 1, 0]]", r"motion.phase: 1 rows .* \(rad\) do not fit 2 of amplitude"),
        ("[0.0, 0.0, 1.5]", "['a', 0, 0]", r"motion.phase\[0\]: 'a' must be a real number \(rad\)"),
        ("phase", "phases", r"unknown key 'phases' in \[motion\]; did you mean 'phase'\?"),
        ("Cdn", "cdn", r"unknown key 'cdn' in \[line\]; did you mean 'Cdn'\?"),
        ("Cdn = 1.6", "Cdn = -1.6", r"Cdn: -1.6 \(dimensionless\) must be >= 0"),
        ("damping = 0.01", "damping = inf", r"damping: inf s must be finite"),
        ("diameter = 0.09\n", "", r"line.diameter: not given \(m\), and \[motion\] takes it"),
        ("mass_per_length = 77.7066\n", "", r"line.mass_per_length: not given \(kg/m\), and \[motion\] takes it"),
        ("seabed_stiffness = 2e4\n", "", r"environment.seabed_stiffness: not given \(N/m\^2\), and \[motion\] over a"),
        ("depth = 60.0\n", "", r"seabed_stiffness: 20000 N/m\^2 takes a seabed, and depth \(m\) is not given"),
        ("[0.3, 0.0, 0.0]", "[0.3, 0.0]", r"current: \[0.3, 0.0\] must be three components \[x, y, z\] \(m/s\)"),
        ("[2.0, 0.0, 1.0]", "[0, 0, 51]", r"motion.amplitude: takes the fairlead down to z = -6.*below the seabed"),
        ("[motion]", "[[motion]]", r"motion: .* must be a table, \[motion\]"),
    ],
)  # fmt: skip
def test_bad_scenes_with_motion(written, old, new, message):
    """A scene whose motion, water or section is wrong in one place is refused by key, value and unit."""
    path = written(old, new)
    with pytest.raises(InputError, match=message) as info:
        Scene.load(path)
    assert str(info.value).startswith(f"{path}: ")
