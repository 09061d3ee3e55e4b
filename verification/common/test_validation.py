"""Do errors of inputs carry the field, its value and its unit, so that no program has to read their message?"""

from __future__ import annotations

import math
import pickle
from pathlib import Path

import numpy as np
import pytest

from solvers import (
    CableProperties,
    Element,
    Environment,
    FunctionMotion,
    InputError,
    Motion,
    Network,
    Node,
    SampledMotion,
    Scene,
    Span,
    cable_system,
    solve_network,
    solve_periodic,
    solve_span,
    solve_spans,
    solve_static,
    solve_time_domain,
)
from solvers.common.motion import Ramped
from solvers.common.validation import flags, non_negative_number, one_of, positive_number, real_number, vector
from solvers.common.validation import whole_number as whole
from solvers.io.map_file import read_map_file
from solvers.io.network_scene import load_network
from solvers.numerics.modes import natural_modes

from ..cable.problems import scene
from ..cases.cables import OC3, SURGE_5

SCENES = Path(__file__).parents[2] / "reference_data" / "scenes"
LINE = Span(100.0, 1e8, 900.0, 850.0, 200.0)
MOTION = Motion.harmonic(0.1, (1.0, 0.0, 0.0))
NODES = Node("fixed", (0.0, 0.0, -50.0)), Node("coupled", (90.0, 0.0, 0.0))
HANGING = Element(100.0, 1e8, 120.0, (0, 1))


def oc3():
    """The OC3 line on six nodes, its fairlead in surge."""
    return cable_system(scene(SURGE_5), 6)


def edited(folder, name, old, new):
    """A copy of a scene file with one text replaced."""
    text = (SCENES / name).read_text(encoding="utf-8")
    assert text.count(old) >= 1
    path = folder / Path(name).name
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    return path


CALLS = {
    "Span": (lambda: Span(100.0, -1e8, 900.0, 850.0, 200.0), "EA", -1e8, "N"),
    "Span, no number": (lambda: Span("a", 1e8, 900.0, 850.0, 200.0), "w", "a", "N/m"),
    "solve_span": (lambda: solve_span(LINE, tolerance="1"), "tolerance", "1", "dimensionless"),
    "solve_spans": (
        lambda: solve_spans(1.0, 1.0, 1.0, 1.0, 1.0, tolerance=math.nan),
        "tolerance",
        None,
        "dimensionless",
    ),
    "Node": (lambda: Node("free", (0.0, 0.0, 0.0), mass=-2.0), "mass", -2.0, "kg"),
    "Node, a component": (lambda: Node("free", (0.0, None, 0.0)), "r[1]", None, "m"),
    "Element": (lambda: Element(100.0, 1e8, 0.0, (0, 1)), "L", 0.0, "m"),
    "Element, ends": (lambda: Element(100.0, 1e8, 1.0, (0, "a")), "ends", (0, "a"), None),
    "Network": (lambda: Network(NODES, ()), "elements", (), None),
    "solve_network": (lambda: solve_network(Network(NODES, [HANGING]), method="x"), "method", "x", None),
    "CableProperties": (lambda: CableProperties(1e8, 0.1, -7.0), "mass_per_length", -7.0, "kg/m"),
    "CableProperties, missing": (lambda: CableProperties(1e8), "submerged_weight", None, "N/m"),
    "Environment": (lambda: Environment(depth=0.0), "depth", 0.0, "m"),
    "Environment, current": (lambda: Environment(current=(1.0, 2.0)), "current", (1.0, 2.0), "m/s"),
    "Motion": (lambda: Motion(0.0, [(1.0, 0.0, 0.0)]), "frequency", 0.0, "Hz"),
    "Motion, not finite": (lambda: Motion(1.0, [(1.0, math.inf, 0.0)]), "sine[0, 1]", math.inf, "m"),
    "Motion.harmonic": (lambda: Motion.harmonic(0.1, (1.0,)), "amplitude", (1.0,), "m"),
    "SampledMotion": (lambda: SampledMotion([0.0, 0.0], np.zeros((2, 3))), "time", [0.0, 0.0], "s"),
    "SampledMotion, outside": (lambda: SampledMotion([0, 1], np.zeros((2, 3))).velocity(2.0), "time", 2.0, "s"),
    "FunctionMotion": (lambda: FunctionMotion(1, 2), "position", 1, None),
    "Ramped": (lambda: Ramped(MOTION, -1.0), "duration", -1.0, "s"),
    "cable_system": (lambda: cable_system(scene(OC3), 2), "nodes", 2, None),
    "cable_system, mesh": (lambda: cable_system(scene(OC3), mesh=[0.0, 1.0]), "mesh", [0.0, 1.0], "m"),
    "cable_system, motion": (lambda: cable_system(scene(OC3), motion=3), "motion", 3, None),
    "solve_static": (lambda: solve_static(oc3(), tolerance=0), "tolerance", 0.0, "mean change of a state"),
    "solve_static, flag": (lambda: solve_static(oc3(), throw=1), "throw", 1, None),
    "solve_time_domain": (lambda: solve_time_domain(oc3(), dt=-0.1, periods=1), "dt", -0.1, "s"),
    "solve_time_domain, every": (lambda: solve_time_domain(oc3(), dt=1.0, periods=1, every=1.5), "every", 1.5, "steps"),
    "solve_periodic": (lambda: solve_periodic(oc3(), harmonics=0), "harmonics", 0, None),
    "solve_time_domain, step": (lambda: solve_time_domain(oc3(), dt=50.0, duration=1.0), "dt", 50.0, "s"),
    "solve_time_domain, start": (lambda: solve_time_domain(oc3(), dt=0.1, periods=1, start=3), "start", 3, None),
    "solve_periodic, samples": (lambda: solve_periodic(oc3(), harmonics=9, samples=4), "samples", 4, None),
    "natural_modes": (lambda: natural_modes(oc3(), 1000), "count", 1000, "modes"),
    "natural_modes, near": (lambda: natural_modes(oc3(), 1, near=-1), "near", -1.0, "Hz"),
    "Scene.load, no file": (lambda: Scene.load("none.toml"), "path", "none.toml", None),
    "read_map_file, no path": (lambda: read_map_file(3), "path", 3, None),
}


@pytest.mark.parametrize("name", CALLS)
def test_each_public_call_says_field_value_and_unit(name):
    """As attributes, and the message begins with the field and is made of them."""
    call, field, value, unit = CALLS[name]
    with pytest.raises(InputError) as refused:
        call()
    error = refused.value
    assert (error.field, error.unit) == (field, unit)
    if name != "solve_spans":  # nan is no equal of itself
        assert error.value == value and type(error.value) is type(value)
    assert str(error) == f"{field}: {error.problem}" or field == "path"
    assert not unit or unit in str(error) or name.startswith(("solve_time_domain, every", "natural_modes"))


FILES = {
    "scene": (Scene.load, "oc3_hywind.toml", "EA = 384.243e6", "EA = -1.0", "EA", -1.0, "N"),
    "scene, key": (Scene.load, "oc3_hywind.toml", "EA = 384.243e6", "EAA = 1.0", "EAA", 1.0, None),
    "network": (load_network, "networks/oc3_three_lines.toml", "length = 902.2", "length = 0", "L", 0.0, "m"),
    "MAP++, column": (read_map_file, "bridle.map", "870.0", "1_000", "UnstrLen", "1_000", "m"),
    "MAP++, data": (read_map_file, "bridle.map", "870.0", "-870.0", "L", -870.0, "m"),
    "MAP++, node": (read_map_file, "bridle.map", "#-80", "-320.5", "r", (40.0, 0.0, -320.5), "m"),
}


@pytest.mark.parametrize("name", FILES)
def test_errors_of_files_keep_the_field(name, tmp_path):
    """Beside the file, and line or table, which stand in front of the message."""
    load, file, old, new, field, value, unit = FILES[name]
    path = edited(tmp_path, file, old, new)
    with pytest.raises(InputError) as refused:
        load(path, **({"depth": 320.0} if load is read_map_file else {}))
    error = refused.value
    assert (error.field, error.value, error.unit) == (field, value, unit)
    assert str(error).startswith(str(path))


def test_an_error_of_a_network_says_which_node_or_element():
    """item is (kind, index), and another name of it can be put in its place."""
    free = Node("free", (1.0, 0.0, 0.0))
    with pytest.raises(InputError, match=r"^node 2 \(free\): carries no element$") as refused:
        Network((*NODES, free), [HANGING])
    assert refused.value.item == ("node", 2)
    assert str(refused.value.labelled("buoy")) == "buoy: carries no element"
    with pytest.raises(InputError, match=r"^element 1: both ends are node 1$") as refused:
        Network(NODES, [HANGING, Element(1.0, 1e8, 1.0, (1, 1))])
    assert (refused.value.item, refused.value.field, refused.value.value) == (("element", 1), "ends", (1, 1))


def test_an_error_goes_from_one_process_to_another():
    """With message, field, value, unit and item."""
    error = InputError("-1 kg must be >= 0", field="mass", value=-1, unit="kg", item=("node", 3)).located("a.map:7")
    copy = pickle.loads(pickle.dumps(error))
    assert str(copy) == str(error) == "a.map:7: node 3: -1 kg must be >= 0"
    assert vars(copy) == vars(error) and (copy.field, copy.value, copy.unit, copy.item) == (
        "mass",
        -1,
        "kg",
        ("node", 3),
    )


def test_a_free_message_has_no_field():
    """What concerns several inputs together is said in a sentence."""
    error = InputError("the shapes do not fit")
    assert str(error) == error.problem == "the shapes do not fit"
    assert error.field is error.value is error.unit is error.item is None


# ---------------------------------------------------------------- each validator
GOOD = [
    (real_number("a", np.array(3), "m"), 3.0),
    (real_number("a", np.float32(0.5), "m"), 0.5),
    (positive_number("a", 2, "m"), 2.0),
    (non_negative_number("a", 0, "m"), 0.0),
    (whole("a", np.int64(5), 1), 5),
    (whole("a", 5, 1, 5), 5),
    (vector("a", np.array([1, 2, 3]), "m"), (1.0, 2.0, 3.0)),
]
BAD = {
    "a: True must be a real number (m)": lambda: real_number("a", True, "m"),
    "a: [1] must be one real number (m)": lambda: real_number("a", [1], "m"),
    "a: inf m must be finite": lambda: real_number("a", math.inf, "m"),
    f"a: {10**400} m must be finite": lambda: real_number("a", 10**400, "m"),
    "a: 0 m must be > 0": lambda: positive_number("a", 0, "m"),
    "a: -1 m must be >= 0": lambda: non_negative_number("a", -1, "m"),
    "a: True must be a whole number >= 1": lambda: whole("a", True, 1),
    "a: 2.0 must be a whole number >= 1": lambda: whole("a", 2.0, 1),
    "a: 0 must be a whole number >= 1": lambda: whole("a", 0, 1),
    "a: 6 must be a whole number from 1 to 5": lambda: whole("a", 6, 1, 5),
    "a: 'x' must be 'y' or 'z'": lambda: one_of("a", "x", ("y", "z")),
    "a: 1 must be True or False": lambda: flags(a=1),
    "a: (1, 2) must be three components [x, y, z] (m)": lambda: vector("a", (1, 2), "m"),
    "a[2]: nan m must be finite": lambda: vector("a", (1, 2, math.nan), "m"),
}


@pytest.mark.parametrize(("got", "wanted"), GOOD)
def test_what_is_right_is_passed_on(got, wanted):
    """As numbers of Python."""
    assert got == wanted and type(got) is type(wanted)


@pytest.mark.parametrize("message", BAD)
def test_what_is_wrong_is_named(message):
    """Field, value, unit, and what it must be."""
    with pytest.raises(InputError) as refused:
        BAD[message]()
    assert str(refused.value) == message
