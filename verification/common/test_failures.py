"""Does bad input fail well? One clear error each, with the field, its value and its unit; nothing else ever escapes."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from solvers import (
    CableProperties,
    ConvergenceError,
    Environment,
    InputError,
    Regime,
    Scene,
    Span,
    Status,
    solve_span,
    solve_spans,
)

from ..tools.strategies import any_number

GOOD = {"w": 100.0, "EA": 1e6, "L": 50.0, "x": 30.0, "z": 20.0}
UNITS = {"w": "N/m", "EA": "N", "L": "m", "x": "m", "z": "m", "friction": "(dimensionless)", "clearance": "m"}
FUZZ = settings(max_examples=2000)  # some 2 ms each


def refused(message: str, **changes):
    """Span(**GOOD, **changes) is refused with a message that matches."""
    with pytest.raises(InputError, match=message):
        Span(**(GOOD | changes))


# ---------------------------------------------------------------- one span
@pytest.mark.parametrize("field", UNITS)
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, np.float64("nan")])
def test_numbers_must_be_finite(field, value):
    """NaN and infinities are refused with the name of the field, the value and the unit."""
    refused(rf"^{field}: {value} {re.escape(UNITS[field])} must be finite", **{field: value})


@pytest.mark.parametrize("field", UNITS)
@pytest.mark.parametrize("value", ["10", b"10", None, 1j, [1.0], [1.0, 2.0], (1.0,), {}, True, object()])
def test_numbers_must_be_real_numbers(field, value):
    """Texts, None, complex numbers, lists and bool are not numbers, whatever float() makes of them."""
    unit = re.escape(UNITS[field].strip("()"))
    refused(rf"^{field}: {re.escape(repr(value)[:8])}.* must be (a|one) real number \(+{unit}\)", **{field: value})


@pytest.mark.parametrize("value", [1, 0, "yes", None, 1.0, [True]])
def test_seabed_must_be_a_truth_value(value):
    """seabed takes True or False and nothing that merely looks like it."""
    refused(rf"^seabed: {re.escape(repr(value))} must be True or False", seabed=value)


def test_integers_and_numpy_numbers_are_numbers():
    """Python integers, numpy scalars and numpy truth values are what they stand for."""
    span = Span(np.int64(100), 10**6, np.float32(50), 30, np.array(20.0)[()], seabed=np.bool_(True))
    assert solve_span(span).H == solve_span(Span(**GOOD)).H


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"L": 0.0}, r"^L: 0 m must be > 0"),
        ({"L": -5.0}, r"^L: -5 m must be > 0"),
        ({"EA": 0}, r"^EA: 0 N must be > 0"),
        ({"EA": -1e6}, r"^EA: -1e\+06 N must be > 0"),
        ({"x": -1e-300}, r"^x: -1e-300 m must be >= 0: it is the horizontal distance"),
        ({"friction": -0.5}, r"^friction: -0.5 \(dimensionless\) must be >= 0 .*clearance"),
        ({"clearance": -2.0}, r"^clearance: -2 m must be >= 0: the anchor cannot be below the seabed"),
        ({"z": -1.0}, r"^z: -1 m puts the fairlead below the seabed, 0 m under the anchor"),
        ({"z": -3.0, "clearance": 2.0}, r"^z: -3 m puts the fairlead below the seabed, 2 m under the anchor"),
        ({"w": -1.0}, r"^w: -1 N/m, a buoyant line, cannot rest on a seabed: give seabed=False"),
        ({"clearance": 1.0, "seabed": False}, r"^clearance: 1 m has no meaning with seabed=False"),
        ({"w": 10**400}, r"^w: 1000.* must be finite"),
    ],
)
def test_values_out_of_range(changes, message):
    """Each rule of Span is reported with the name, the value, the unit and what to give instead."""
    refused(message, **changes)


def test_what_is_allowed_at_the_edge():
    """x = 0, z = -clearance, friction = 0 and w = 0 are inputs like any other; so is w < 0 without seabed."""
    for changes in ({"x": 0.0}, {"z": -2.0, "clearance": 2.0}, {"w": 0.0}, {"w": -100.0, "seabed": False}):
        assert solve_span(Span(**(GOOD | changes))).success


def test_an_argument_too_few():
    """A missing argument is Python's own error, which names it."""
    with pytest.raises(TypeError, match="'z'"):
        Span(100.0, 1e6, 50.0, 30.0)


@pytest.mark.parametrize("span", [None, GOOD, (100.0, 1e6, 50.0, 30.0, 20.0), "span"])
def test_solve_span_wants_a_span(span):
    """solve_span says what it was given instead of a Span."""
    with pytest.raises(InputError, match=r"^span: .* is not a solvers.Span"):
        solve_span(span)


@pytest.mark.parametrize("tolerance", [0.0, 1.0, -1e-6, 2.0, math.nan, math.inf])
def test_tolerance_must_make_sense(tolerance):
    """The tolerance lies between 0 and 1, for one line and for many."""
    with pytest.raises(InputError, match=r"^tolerance: .* must (lie in \(0, 1\)|be finite)"):
        solve_span(Span(**GOOD), tolerance=tolerance)
    with pytest.raises(InputError, match=r"^tolerance: .* must (lie in \(0, 1\)|be finite)"):
        solve_spans(**GOOD, tolerance=tolerance)


@pytest.mark.parametrize("s", [-1e-12, 50.1, math.nan, math.inf, [0.0, 51.0], [[0.0], [math.nan]]])
def test_profile_stays_on_the_line(s):
    """Arc length outside [0, L], or NaN, is refused."""
    with pytest.raises(InputError, match=r"^s: values must lie in \[0, 50\] m"):
        solve_span(Span(**GOOD)).profile(s)


@pytest.mark.parametrize("s", ["middle", [0.0, "x"], [[0.0], [1.0, 2.0]], 1j])
def test_profile_wants_numbers(s):
    """Arc length that is no array of real numbers is refused."""
    with pytest.raises(InputError, match=r"^s: .* must be real numbers \(m\)"):
        solve_span(Span(**GOOD)).profile(s)


def test_profile_keeps_shapes():
    """A number, a vector and a matrix of arc lengths come back in their own shape."""
    state = solve_span(Span(**GOOD))
    for s in (25.0, [1.0, 2.0], np.ones((2, 3)), []):
        assert all(part.shape == np.shape(s) for part in state.profile(s))


# ---------------------------------------------------------------- solves that fail
UNDETERMINED = Span(1.0, 1e3, 1.0, 0.9, 0.1, True, 0.5, 0.01)


def test_undetermined_friction_is_an_error():
    """Friction under a line that touches between raised ends: ConvergenceError, with the state and the inputs."""
    with pytest.raises(
        ConvergenceError, match=r"set friction = 0 or clearance = 0 \(given Span\(w=1.0, .*iterations"
    ) as info:
        solve_span(UNDETERMINED)
    assert info.value.outcome.status is Status.FRICTION_UNDETERMINED
    assert info.value.outcome.span is UNDETERMINED


def test_undetermined_friction_without_throw():
    """With throw=False the same state comes back: a status that is not success, NaN, and no profile."""
    state = solve_span(UNDETERMINED, throw=False)
    assert state.status is Status.FRICTION_UNDETERMINED and not state.success
    assert state.regime is Regime.SAGGING
    numbers = [state.H, state.V, state.H_anchor, state.V_anchor, state.grounded_length, state.tension]
    assert np.isnan(numbers).all() and np.isnan(state.stiffness).all()
    with pytest.raises(ConvergenceError, match="friction = 0 or clearance = 0"):
        state.profile(0.5)


def test_forces_out_of_range_are_an_error():
    """Forces beyond double precision: ConvergenceError that says so."""
    with pytest.raises(ConvergenceError, match="leave the range of double precision") as info:
        solve_span(Span(1.0, 1e308, 1.0, 1e10, 0.0))
    assert info.value.outcome.status is Status.NOT_FINITE


def test_statuses_read_as_sentences():
    """Every status says what happened in words, once."""
    assert len({status.value for status in Status}) == len(Status)
    assert all(" " in status.value and status.value[0].islower() for status in Status)


# ---------------------------------------------------------------- many spans
@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"x": np.ones((2, 2))}, r"^x: shape \(2, 2\) must be \(\) or \(n,\)"),
        ({"x": np.ones(2), "z": np.ones(3)}, r"do not broadcast to one \(n,\): x \(2,\), z \(3,\)"),
        ({"w": np.array([1.0, None], dtype=object)}, r"^w: values of type object must be real numbers \(N/m\)"),
        ({"EA": ["1e6"]}, r"^EA: values of type <U3 must be real numbers \(N\)"),
        ({"L": 1j}, r"^L: values of type complex128 must be real numbers \(m\)"),
        ({"L": [True, False]}, r"^L: values of type bool must be real numbers \(m\)"),
        ({"z": None}, r"^z: values of type object must be real numbers \(m\)"),
        ({"seabed": [1, 0]}, r"^seabed: values of type int64 must be True or False"),
        ({"seabed": "no"}, r"^seabed: values of type <U2 must be True or False"),
        ({"friction": np.array(["nan"])}, r"^friction: values of type <U3 must be real numbers"),
    ],
)
def test_batch_arguments(changes, message):
    """Arrays of the wrong shape or type are refused as a whole, with the name and what it should be."""
    with pytest.raises(InputError, match=message):
        solve_spans(**(GOOD | changes))


BAD_ROWS = [
    {"w": math.nan}, {"EA": math.inf}, {"L": -math.inf}, {"x": math.nan}, {"z": -math.inf}, {"friction": math.inf},
    {"clearance": math.nan}, {"L": 0.0}, {"L": -1.0}, {"EA": 0.0}, {"EA": -1.0}, {"x": -1.0}, {"friction": -0.1},
    {"clearance": -1.0}, {"z": -1.0}, {"z": -3.0, "clearance": 2.0}, {"w": -1.0},
    {"clearance": 1.0, "seabed": False},
]  # fmt: skip


@pytest.mark.parametrize("changes", BAD_ROWS, ids=str)
def test_bad_rows_are_refused_as_span_refuses_them(changes):
    """What Span refuses, solve_spans marks INVALID_INPUT with NaN, and the next row is right."""
    with pytest.raises(InputError):
        Span(**(GOOD | changes))
    row = GOOD | {"seabed": True, "friction": 0.0, "clearance": 0.0} | changes
    good = GOOD | {"seabed": True, "friction": 0.0, "clearance": 0.0}
    batch = solve_spans(**{name: [row[name], good[name]] for name in row})
    assert batch.status.tolist() == [Status.INVALID_INPUT, Status.SUCCESS]
    assert np.isnan([batch.H[0], batch.V[0], batch.H_anchor[0], batch.V_anchor[0], batch.grounded_length[0]]).all()
    assert np.isnan(batch.stiffness[0]).all()
    assert batch.H[1] == solve_span(Span(**GOOD)).H


# ---------------------------------------------------------------- anything at all
anything = st.fixed_dictionaries(dict.fromkeys(UNITS, any_number) | {"seabed": st.booleans()})
nearly_valid = st.fixed_dictionaries(
    {name: any_number.map(abs) for name in ("EA", "L", "x")}
    | {"w": any_number, "z": any_number, "seabed": st.booleans()}
    | {"friction": st.just(0.0) | any_number.map(abs), "clearance": st.just(0.0) | any_number.map(abs)}
)


def outcome_of(arguments) -> Status:
    """Status of a line, every number of a success examined; any exception that is not one of ours passes through."""
    try:
        state = solve_span(Span(**arguments))
    except InputError:
        return Status.INVALID_INPUT
    except ConvergenceError as error:
        return error.outcome.status
    numbers = [state.H, state.V, state.H_anchor, state.V_anchor, state.grounded_length]
    assert np.isfinite(numbers).all(), f"{arguments} gave {state} as success"
    assert not np.isnan(state.stiffness).any(), f"{arguments} gave {state} as success"
    assert state.H >= 0 and 0 <= state.grounded_length <= state.span.L
    return Status.SUCCESS


@FUZZ
@given(anything | nearly_valid)
def test_any_numbers_end_in_an_answer_or_a_refusal(arguments):
    """Any mixture of floats ends in InputError, ConvergenceError or a finite success, and in the same in a batch."""
    status = outcome_of(arguments)
    assert solve_spans(**arguments).status[0] is status


@FUZZ
@given(nearly_valid)
def test_ordinary_ratios_always_have_an_answer(arguments):
    """Valid lines with ratios to L and wL between 1e-12 and 1e12 are solved, or their friction is undetermined."""
    L, w = 10.0, 1.0

    def ratio(value):
        value = abs(value)
        return value if 1e-12 < value < 1e12 else 1.0 if math.isfinite(value) and value else 0.0

    clearance = ratio(arguments["clearance"]) * L * arguments["seabed"]
    line = {"w": w, "L": L, "EA": w * L * (ratio(arguments["EA"]) or 1.0), "x": L * ratio(arguments["x"])}
    z = max(L * math.copysign(ratio(arguments["z"]), arguments["z"]), -clearance if arguments["seabed"] else -math.inf)
    line |= {"z": z, "seabed": arguments["seabed"], "friction": ratio(arguments["friction"]), "clearance": clearance}
    assert outcome_of(line) in (Status.SUCCESS, Status.FRICTION_UNDETERMINED)


# ---------------------------------------------------------------- cable and environment
@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: Environment(rho=-1.0), r"^rho: -1 kg/m\^3 must be >= 0"),
        (lambda: Environment(rho=math.nan), r"^rho: nan kg/m\^3 must be finite"),
        (lambda: Environment(g=0.0), r"^g: 0 m/s\^2 must be > 0"),
        (lambda: Environment(depth=-320.0), r"^depth: -320 m must be > 0"),
        (lambda: Environment(depth="deep"), r"^depth: 'deep' must be a real number \(m\)"),
        (lambda: CableProperties(0.0, submerged_weight=1.0), r"^EA: 0 N must be > 0"),
        (lambda: CableProperties(1e6), r"^submerged_weight: not given \(N/m\), and it takes both diameter"),
        (lambda: CableProperties(1e6, diameter=0.1), r"^submerged_weight: not given"),
        (lambda: CableProperties(1e6, diameter=-0.1, mass_per_length=1.0), r"^diameter: -0.1 m must be > 0"),
        (
            lambda: CableProperties(1e6, diameter=1.1e100, submerged_weight=1.0),
            r"^diameter: 1.1e\+100 m must not exceed",
        ),
        (lambda: CableProperties(1e6, diameter=0.1, mass_per_length=True), r"^mass_per_length: True must be a real"),
        (lambda: CableProperties(1e6, submerged_weight=math.inf), r"^submerged_weight: inf N/m must be finite"),
    ],
)
def test_properties_are_validated_when_built(build, message):
    """Cable and environment name the field, the value and the unit, too."""
    with pytest.raises(InputError, match=message):
        build()


def test_a_diameter_may_be_the_largest():
    """1e100 m is taken, and squares of it stay finite."""
    assert math.isfinite(CableProperties(1e6, diameter=1e100, submerged_weight=1.0).area)


# ---------------------------------------------------------------- scene files
SCENE = """
name = "a line"
[environment]
depth = 320.0
[line]
length = 902.2
EA = 384.243e6
submerged_weight = 698.094
friction = 0.001
[ends]
anchor = [-853.87, 0.0, -320.0]
fairlead = [-5.2, 0.0, -70.0]
"""


@pytest.fixture
def scene_file(tmp_path):
    """Writes the good scene with a piece of text replaced; returns its path."""

    def write(old="", new="", text=SCENE):
        assert old in text
        path = tmp_path / "my_line.toml"
        path.write_text(text.replace(old, new, 1) if old else new + text, encoding="utf-8")
        return path

    return write


def test_the_good_scene_loads(scene_file):
    """The scene that the tests below spoil is a good one."""
    (span,) = Scene.load(scene_file()).spans()
    assert solve_span(span).success and span.clearance == 0.0


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("", "colour = 'red'\n", r"unknown key 'colour' in the top level; known keys are"),
        ("", "[moton]\n", r"unknown key 'moton' in the top level"),
        ("", "tolerence = 1e-6\n", r"unknown key 'tolerence' in the top level; did you mean 'tolerance'\?"),
        ("depth", "dept", r"unknown key 'dept' in \[environment\]; did you mean 'depth'\?"),
        ("EA =", "Ea = 1.0\nEA =", r"unknown key 'Ea' in \[line\]; .*'?EA"),
        ("friction", "frictoin", r"unknown key 'frictoin' in \[line\]; did you mean 'friction'\?"),
        ("fairlead", "fairled", r"unknown key 'fairled' in \[ends\]; did you mean 'fairlead'\?"),
        ("length = 902.2\n", "", r"missing key 'length' in \[line\]"),
        ("EA = 384.243e6\n", "", r"missing key 'EA' in \[line\]"),
        ("anchor = [-853.87, 0.0, -320.0]\n", "", r"missing key 'anchor' in \[ends\]"),
        ("[line]\nlength = 902.2\nEA = 384.243e6\nsubmerged_weight = 698.094\nfriction = 0.001\n", "",
         r"missing key 'line' in the top level"),
        ("submerged_weight = 698.094\n", "", r"submerged_weight: not given \(N/m\)"),
        ("902.2", "-902.2", r"length: -902.2 m must be > 0"),
        ("902.2", "'long'", r"length: 'long' must be a real number \(m\)"),
        ("902.2", "nan", r"length: nan m must be finite"),
        ("384.243e6", "0", r"EA: 0 N must be > 0"),
        ("384.243e6", "[1.0]", r"EA: \[1.0\] must be one real number \(N\)"),
        ("698.094", "true", r"submerged_weight: True must be a real number \(N/m\)"),
        ("698.094", "-698.094", r"w: -698.094 N/m, a buoyant line, cannot rest on a seabed"),
        ("0.001", "-0.001", r"friction: -0.001 \(dimensionless\) must be >= 0"),
        ("0.001", "[0.1, -1]", r"friction: -1 \(dimensionless\) must be >= 0"),
        ("0.001", "[0.1, 'rough']", r"friction: 'rough' must be a real number"),
        ("0.001", "[]", r"line.friction: the list is empty"),
        ("320.0\n", "-320.0\n", r"depth: -320 m must be > 0"),
        ("320.0\n", "300.0\n", r"clearance: -20 m must be >= 0: the anchor cannot be below the seabed"),
        ("-5.2, 0.0, -70.0", "-5.2, 0.0, -330.0", r"z: -10 m puts the fairlead below the seabed"),
        ("[-5.2, 0.0, -70.0]", "[-5.2, -70.0]", r"ends.fairlead: \[-5.2, -70.0\] must be three coordinates"),
        ("[-5.2, 0.0, -70.0]", "5.0", r"ends.fairlead: 5.0 must be three coordinates"),
        ("[-5.2, 0.0, -70.0]", "[-5.2, 'y', -70.0]", r"ends.fairlead\[1\]: 'y' must be a real number \(m\)"),
        ("[-5.2, 0.0, -70.0]", "[-5.2, inf, -70.0]", r"ends.fairlead\[1\]: inf m must be finite"),
        ('"a line"', "7", r"name: 7 must be a text"),
        ("", "description = ['x']\n", r"description: \['x'\] must be a text"),
        ("", "tolerance = 0\n", r"tolerance: 0 \(dimensionless\) must be > 0"),
        ("", "tolerance = 1\n", r"tolerance: 1 \(dimensionless\) must be < 1"),
        ("", "tolerance = 'fine'\n", r"tolerance: 'fine' must be a real number"),
        ("[environment]\ndepth = 320.0\n", "environment = 320.0\n", r"environment: 320.0 must be a table"),
        ("[environment]\ndepth = 320.0\n", "[[environment]]\ndepth = 320.0\n", r"environment: .* must be a table"),
        ("[line]", "[line", r"is not a TOML file: .*line 5"),
        ("length = 902.2", "length = 902.2\nlength = 902.2", r"is not a TOML file"),
    ],
)  # fmt: skip
def test_bad_scenes(scene_file, old, new, message):
    """A scene that is wrong in one place is refused with the file, the key, the value and what to write."""
    path = scene_file(old, new)
    with pytest.raises(InputError, match=message) as info:
        Scene.load(path)
    assert str(info.value).startswith(f"{path}: ")


def test_scene_file_that_is_not_there(tmp_path):
    """A path without a file says so."""
    with pytest.raises(InputError, match=r"nowhere.toml: there is no such scene file"):
        Scene.load(tmp_path / "nowhere.toml")


def test_scene_that_is_a_directory(tmp_path):
    """A directory is no scene."""
    with pytest.raises(InputError, match="cannot be read as a text file"):
        Scene.load(tmp_path)


def test_scene_that_is_not_text(tmp_path):
    """Bytes that are not UTF-8 are no scene."""
    path = tmp_path / "latin.toml"
    path.write_bytes(SCENE.replace("a line", "h\u00f6he").encode("latin-1"))
    with pytest.raises(InputError, match="cannot be read as a text file"):
        Scene.load(path)


def test_empty_scene_file(tmp_path):
    """An empty file lacks its tables, which are named."""
    path = tmp_path / "empty.toml"
    path.write_text("")
    with pytest.raises(InputError, match=r"missing key 'line' in the top level|missing key 'length' in \[line\]"):
        Scene.load(path)


@pytest.mark.parametrize("path", [None, 3, object()])
def test_scene_path_of_a_wrong_type(path):
    """Something that is no path is refused."""
    with pytest.raises(InputError, match=r"^path: .* is not the path of a scene file"):
        Scene.load(path)


@pytest.mark.parametrize("value", [np.complex128(902 + 5j), np.True_, np.array([1.0]), np.datetime64("2020-01-01")])
def test_what_only_looks_like_a_number_is_refused(value):
    """A numpy complex, a numpy bool, an array of one element and a date are no length."""
    with pytest.raises(InputError, match=r"^L: .* must be (a|one) real number \(m\)"):
        Span(1.0, 1e6, value, 0.5, 0.3)


@pytest.mark.parametrize("value", ["a", None, math.nan, 0.0, 1.0, [1e-3]])
def test_a_tolerance_is_a_number_between_0_and_1(value):
    """Anything else is refused by name, in the single and in the batch call."""
    with pytest.raises(InputError, match=r"^tolerance: "):
        solve_span(Span(1.0, 1e6, 1.0, 0.5, 0.3), tolerance=value)
    with pytest.raises(InputError, match=r"^tolerance: "):
        solve_spans(1.0, 1e6, 1.0, 0.5, 0.3, tolerance=value)


def test_ragged_rows_and_masked_elements_are_refused():
    """Rows of different lengths and hidden elements are named, not guessed."""
    with pytest.raises(InputError, match=r"^w: rows of different lengths"):
        solve_spans([[1.0], [1.0, 2.0]], 1e6, 1.0, 0.5, 0.3)
    with pytest.raises(InputError, match=r"^w: has masked elements"):
        solve_spans(np.ma.array([1.0, 2.0], mask=[False, True]), 1e6, 1.0, 0.5, 0.3)
