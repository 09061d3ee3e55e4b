"""Motion of a rigid body: rates are derivatives, distances are kept, circles close; what is no motion is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest

from solvers import BodyMotion, FunctionMotion, InputError, Motion, SampledMotion

from ..reference import EPS

STEP = 1e-30  # of a complex step: its error is the rounding of the derivative
DERIVATIVE = 1e-12  # of the largest rate: a few roundings of products of three rotations
DISTANCE = 20 * EPS  # of the distance from the reference point: roundings of three rotations of an arm
DIFFERENCE = 1e-6  # of the largest acceleration of a function motion, from differences over 1e-5 of the time span

rng = np.random.default_rng(20260101)
POINTS = np.array([[5.2, 0.0, -70.0], [-2.6, 4.5, -70.0], [-2.6, -4.5, -68.0], [40.0, -30.0, 10.0]])
REFERENCE = (1.0, -2.0, -10.0)
TIMES = np.linspace(0.0, 40.0, 43)
TRANSLATION = Motion(0.04, rng.normal(size=(3, 3)), rng.normal(size=(3, 3)))
TURNS = Motion(0.12, 0.5 * rng.normal(size=(2, 3)), 0.5 * rng.normal(size=(2, 3)))  # rad: as far as a half turn
SERIES = np.linspace(0.0, 40.0, 30)
MOTIONS = {
    "periodic": BodyMotion(TRANSLATION, TURNS, REFERENCE),
    "translation": BodyMotion(TRANSLATION),
    "rotation": BodyMotion(None, TURNS, REFERENCE),
    "sampled": BodyMotion(SampledMotion(SERIES, rng.normal(size=(30, 3))), SampledMotion(SERIES, rng.random((30, 3)))),
    "scaled": BodyMotion(SampledMotion(SERIES, rng.normal(size=(30, 3))), TURNS, REFERENCE).scaled(1.5),
    "ramped": BodyMotion(TRANSLATION, TURNS, REFERENCE).ramped(13.0),
}


# ---------------------------------------------------------------- kinematics
@pytest.mark.parametrize("motion", MOTIONS.values(), ids=MOTIONS)
def test_rates_are_derivatives(motion):
    """Velocity and acceleration are the complex-step derivatives; displacement and trajectory say the same."""
    t = TIMES[1:-1]
    r, v, a = motion.trajectory(POINTS, t)
    assert r.shape == v.shape == a.shape == (3, len(POINTS), len(t))
    np.testing.assert_allclose(motion.displacement(POINTS, t), r, rtol=0, atol=1e-13 * abs(POINTS).max())
    later = motion.trajectory(POINTS, t + 1j * STEP)
    for rate, before in ((v, later[0]), (a, later[1])):
        assert abs(rate).max() > 0
        np.testing.assert_allclose(rate, before.imag / STEP, rtol=0, atol=DERIVATIVE * abs(rate).max())


@pytest.mark.parametrize("motion", MOTIONS.values(), ids=MOTIONS)
def test_one_time_is_one_of_many(motion):
    """A number t gives what an array gives at it, without the axis of times."""
    for one, many in zip(
        motion.trajectory(POINTS, 7.0), motion.trajectory(POINTS, TIMES[[0, 9]] * 0 + 7.0), strict=True
    ):
        assert one.shape == (3, len(POINTS))
        np.testing.assert_allclose(one, many[..., 1], rtol=0, atol=1e-13 * max(abs(many).max(), 1))
    assert motion.displacement(POINTS, 7.0).shape == (3, len(POINTS))
    assert [part.shape for part in motion.pose(7.0)] == [(3,), (3, 3)]


@pytest.mark.parametrize("motion", MOTIONS.values(), ids=MOTIONS)
def test_a_rigid_body_keeps_its_distances(motion):
    """Distances between points are those of the mean place at any time, and R is a rotation, not a reflection."""
    moved = POINTS.T[..., None] + motion.displacement(POINTS, TIMES)
    size = np.linalg.norm(POINTS - motion.reference, axis=1).max()
    for i in range(len(POINTS)):
        for j in range(i):
            distance = np.linalg.norm(moved[:, i] - moved[:, j], axis=0)
            assert abs(distance - np.linalg.norm(POINTS[i] - POINTS[j])).max() <= DISTANCE * size, (i, j)
    R = np.moveaxis(motion.pose(TIMES)[1], -1, 0)
    assert abs(np.linalg.det(R) - 1).max() <= DISTANCE


def test_pose_carries_every_point():
    """Displacements are s + (R - 1)(p - reference)."""
    motion = MOTIONS["periodic"]
    s, R = motion.pose(TIMES)
    for p, displacement in zip(POINTS, np.moveaxis(motion.displacement(POINTS, TIMES), 1, 0), strict=True):
        arm = p - np.array(REFERENCE)
        expected = s + np.einsum("ijs,j->is", R, arm) - arm[:, None]
        np.testing.assert_allclose(displacement, expected, rtol=0, atol=1e-12)


def test_a_function_motion_has_accelerations_from_differences():
    """A function of time gives no acceleration; differences of its velocity stand in, also under rotation."""
    w = 0.25
    function = FunctionMotion(lambda t: [0, math.sin(w * t), 0], lambda t: [0, w * math.cos(w * t), 0])
    exact = Motion.harmonic(w / (2 * math.pi), (0.0, 1.0, 0.0))
    one, other = (BodyMotion(part, part, REFERENCE).trajectory(POINTS, TIMES) for part in (function, exact))
    for tolerance, a, b in zip((DERIVATIVE, DERIVATIVE, DIFFERENCE), one, other, strict=True):
        np.testing.assert_allclose(a, b, rtol=0, atol=tolerance * abs(b).max())


# ---------------------------------------------------------------- closed forms
@pytest.mark.parametrize(
    ("coordinate", "first", "second"), [(3, 1, 2), (4, 2, 0), (5, 0, 1)], ids=["roll", "pitch", "yaw"]
)
def test_one_rotation_is_a_circle(coordinate, first, second):
    """Uniform turning about one axis: a circle, right-handed, with its centripetal acceleration, by hand."""
    w = 0.3
    turning = FunctionMotion(lambda t: np.eye(3)[coordinate - 3] * w * t, lambda t: np.eye(3)[coordinate - 3] * w)
    r, v, a = BodyMotion(None, turning, (1.0, 2.0, 3.0)).trajectory([[1.0 + 6.0, 2.0 + 7.0, 3.0 + 8.0]], TIMES)
    arm = np.array([6.0, 7.0, 8.0])
    radius, start = math.hypot(arm[first], arm[second]), math.atan2(arm[second], arm[first])
    expected = np.zeros((3, TIMES.size))
    expected[first] = radius * np.cos(start + w * TIMES)
    expected[second] = radius * np.sin(start + w * TIMES)
    position = r[:, 0] + arm[:, None] * (np.arange(3) != coordinate - 3)[:, None]
    np.testing.assert_allclose(position, expected, rtol=0, atol=1e-13 * radius)
    np.testing.assert_allclose(np.linalg.norm(v[:, 0], axis=0), w * radius, rtol=1e-14)
    np.testing.assert_allclose(a[:, 0], -(w**2) * expected, rtol=0, atol=1e-10 * w**2 * radius)


def test_roll_is_taken_before_pitch_before_yaw():
    """Quarter turns about the fixed axes in that order, by hand: x -> x (roll) -> -z (pitch) -> -z (yaw)."""
    quarter = Motion(1.0, np.zeros((1, 3)), np.full((1, 3), math.pi / 2))
    displacement = BodyMotion(None, quarter).displacement([[1.0, 0.0, 0.0]], 0.0)
    np.testing.assert_allclose(displacement[:, 0], [-1.0, 0.0, -1.0], rtol=0, atol=1e-15)


def test_harmonic_motion_is_a_sine_with_phase_in_all_six():
    """amplitude sin(2 pi f t + phase): metres of the reference point, rad of the angles."""
    amplitude, phase = np.array([1.0, 2.0, 3.0, 0.1, 0.2, 0.3]), np.array([0.1, 0.5, -1.0, 2.0, 3.0, -2.0])
    motion = BodyMotion.harmonic(0.1, amplitude, phase, REFERENCE)
    expected = amplitude[:, None] * np.sin(0.2 * math.pi * TIMES + phase[:, None])
    np.testing.assert_allclose(motion.translation.displacement(TIMES), expected[:3], rtol=0, atol=1e-14 * 3)
    np.testing.assert_allclose(motion.rotation.displacement(TIMES), expected[3:], rtol=0, atol=1e-14)
    assert motion.period == 10.0 and motion.reference == REFERENCE
    assert BodyMotion.harmonic(0.1, (1, 0, 0, 0, 0, 0)).rotation is None
    assert BodyMotion.harmonic(0.1, (1, 0, 0, 0, 0, 0)).reference == (0.0, 0.0, 0.0)
    assert BodyMotion.periodic(0.1, [[0] * 6], [[0, 0, 0, 0.1, 0, 0]]).rotation is not None  # a cosine of roll alone
    assert BodyMotion.periodic(0.1, [[0] * 6]).reference == (0.0, 0.0, 0.0)


def test_harmonics_of_one_frequency():
    """Rows are harmonics 1, 2, ...: by hand at a quarter of the period."""
    motion = BodyMotion.periodic(0.1, [[2, 0, 0, 0, 0, 0.1], [0, 0, 0, 0, 0, 0]], [[0] * 6, [0, 3, 0, 0, 0, 0.4]])
    np.testing.assert_allclose(motion.translation.displacement(2.5), [2, -3, 0], atol=1e-14)
    np.testing.assert_allclose(motion.rotation.displacement(2.5), [0, 0, -0.3], atol=1e-14)


# ---------------------------------------------------------------- changed motions
@pytest.mark.parametrize("factor", [2.0, 0.3, -1.0, 0.0])
@pytest.mark.parametrize("name", ["periodic", "sampled", "ramped"])
def test_a_scaled_motion_has_all_six_coordinates_times_the_factor(name, factor):
    """The angles are scaled, not the displacements of the points."""
    motion, scaled = MOTIONS[name], MOTIONS[name].scaled(factor)
    for part in ("translation", "rotation"):
        for call in ("displacement", "velocity"):
            expected = factor * getattr(getattr(motion, part), call)(TIMES)
            np.testing.assert_allclose(getattr(getattr(scaled, part), call)(TIMES), expected, rtol=0, atol=1e-13)
    assert scaled.reference == motion.reference
    if factor == 0:
        assert len(scaled.directions(POINTS)) == 0


def test_a_ramp_starts_from_rest_and_ends_in_the_motion():
    motion, ramped = MOTIONS["periodic"], MOTIONS["ramped"]
    for start, end, expected in zip(
        ramped.trajectory(POINTS, 0.0),
        ramped.trajectory(POINTS, [13.0, 20.0]),
        motion.trajectory(POINTS, [13.0, 20.0]),
        strict=True,
    ):
        assert abs(start).max() <= 1e-13 * abs(POINTS).max()
        np.testing.assert_allclose(end, expected, rtol=0, atol=1e-13 * abs(expected).max())
    assert ramped.period is None


# ---------------------------------------------------------------- period, directions
def test_period_is_the_longer_one():
    assert BodyMotion(TRANSLATION, TURNS).period == TRANSLATION.period == 25.0
    assert BodyMotion(TURNS, TRANSLATION).period == 25.0
    assert BodyMotion(TRANSLATION).period == 25.0
    assert MOTIONS["sampled"].period is None and MOTIONS["scaled"].period is None


def test_two_periods_without_a_common_one_are_refused():
    motion = BodyMotion(Motion.harmonic(0.1, (1, 0, 0)), Motion.harmonic(0.15, (0, 0.1, 0)))
    with pytest.raises(InputError, match=r"rotation: its period, 6.66667 s, and that of translation, 10 s, .* whole"):
        _ = motion.period


@pytest.mark.parametrize(
    ("amplitude", "points", "kept"),
    [
        ((1, 0, 0, 0, 0, 0), POINTS, (0,)),
        ((1, 0, 1, 0, 0, 0), POINTS, (0,)),  # surge and heave in phase: one line
        ((0, 0, 0, 0.1, 0, 0), POINTS, (1, 2)),
        ((0, 0, 0, 0, 0.1, 0), POINTS, (0, 2)),
        ((2, 0, 1, 0, 0.1, 0), POINTS, (0, 2)),
        ((0, 0, 0, 0, 0, 0.1), POINTS, (0, 1)),
        ((0, 1, 0, 0, 0.1, 0), POINTS, (0, 1, 2)),
        ((0, 0, 0, 0, 0.1, 0.1), POINTS, (0, 1, 2)),
        ((0, 0, 0, 0, 0, 0.1), [(0, 0, -10), (0, 0, -70)], ()),  # on the axis of yaw
        ((0, 0, 0, 0.1, 0.1, 0.1), [(0, 0, 0)], ()),  # the reference point itself
    ],
)
def test_directions_span_the_displacements_and_no_more(amplitude, points, kept):
    """As many directions as the rank of all displacements; each displacement is in their span."""
    motion = BodyMotion.harmonic(0.1, amplitude)
    directions = motion.directions(points)
    assert len(directions) == (1 if amplitude == (1, 0, 1, 0, 0, 0) else len(kept))
    np.testing.assert_allclose(directions @ directions.T, np.eye(len(directions)), atol=1e-14)
    moved = motion.displacement(points, TIMES).reshape(3, -1)
    np.testing.assert_allclose(directions.T @ (directions @ moved), moved, rtol=0, atol=1e-13 * abs(POINTS).max())


# ---------------------------------------------------------------- refused
BAD = [
    (lambda: BodyMotion(None), r"translation: translation and rotation are both None"),
    (lambda: BodyMotion(3.0), r"translation: 3.0 must be None or a motion"),
    (lambda: BodyMotion(None, lambda t: t), r"rotation: .* must be None or a motion"),
    (lambda: BodyMotion(TRANSLATION, None, (0, 0)), r"reference: \(0, 0\) must be three coordinates \[x, y, z\] \(m\)"),
    (lambda: BodyMotion.harmonic(0.0, [1] * 6), r"frequency: 0 Hz must be > 0"),
    (lambda: BodyMotion.harmonic(0.1, [1] * 3), r"amplitude: \[1, 1, 1\] must be six numbers, surge, sway, heave"),
    (lambda: BodyMotion.harmonic(0.1, [1, 0, 0, 0, math.nan, 0]), r"amplitude\[4\]: nan rad must be finite"),
    (lambda: BodyMotion.harmonic(0.1, [1] * 6, [0, "a", 0, 0, 0, 0]), r"phase\[1\]: 'a' must be a real number \(rad\)"),
    (lambda: BodyMotion.periodic(0.1, [1] * 6), r"sine: shape \(6,\) must be \(K, 6\), K >= 1 rows surge"),
    (lambda: BodyMotion.periodic(0.1, [[1] * 6], [[1] * 6] * 2), r"cosine: shape \(2, 6\) must be that of sine"),
    (lambda: BodyMotion.periodic(0.1, [[1, 0, math.inf, 0, 0, 0]]), r"sine\[0, 2\]: inf m, rad must be finite"),
    (lambda: MOTIONS["periodic"].scaled("2"), r"factor: '2' must be a real number"),
    (lambda: MOTIONS["periodic"].ramped(0.0), r"duration: 0 s must be > 0"),
    (lambda: MOTIONS["periodic"].displacement([0, 0, 0], 0.0), r"points: shape \(3,\) must be \(P, 3\), one row"),
    (lambda: MOTIONS["periodic"].displacement([[0, math.nan, 0]], 0.0), r"points\[0, 1\]: nan m must be finite"),
    (lambda: MOTIONS["periodic"].pose([[0.0]]), r"t: shape \(1, 1\) must be \(\) or \(S,\)"),
]  # fmt: skip


@pytest.mark.parametrize(("make", "message"), BAD, ids=[message[:24] for _, message in BAD])
def test_bad_input_is_refused(make, message):
    """What is wrong is refused with the field, its value or shape and its unit."""
    with pytest.raises(InputError, match=message):
        make()
