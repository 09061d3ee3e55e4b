"""Does bad input of any kind end in a named error? Files, fields, arrays and keywords are spoiled, thousands of times.

Every example is spoiled so that it cannot be right, or may still be right by chance; what comes out is judged by one
rule: an InputError or ConvergenceError whose message names what is wrong, or a result that is finite and says how it
ended. Anything else - another exception, a warning, a floating-point error, a NaN in a success - is a defect.
"""

from __future__ import annotations

import math
import re
import tempfile
import time
import warnings
from dataclasses import fields
from functools import cache
from importlib.resources import files
from numbers import Real
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from solvers import (
    CableProperties,
    ConvergenceError,
    Element,
    Environment,
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
from solvers.io.map_plus_plus.reader import read_map_file
from solvers.io.moordyn.reader import load_moordyn
from solvers.io.moordyn.writer import write_moordyn
from solvers.io.network_scene import load_network
from solvers.numerics.modes import natural_modes

from ..tools.strategies import any_number

SCENES = files("reference_data") / "scenes"
SLOWEST = 10.0  # s for one bad input on a busy machine; the slowest takes 0.2 s: refused before any work
DEEP = 26  # times as many in the deep run
ASKED = 20_000  # bad inputs in the deep run, those not counted that happen to be valid
bad = []
"""Inputs that each test must see refused in the default run."""


# ---------------------------------------------------------------- what may be passed
class Unequal:
    """Its comparison says nothing: it gives an array, as a column of a table does."""

    __hash__ = None

    def __eq__(self, other):
        return np.array([True, False])

    def __repr__(self):
        return "Unequal()"


WITHOUT_TRUTH = {
    "empty": np.array([]), "numbers": np.array([1.0, 2.0]), "words": np.array(["free", "box"]),
    "flags": np.array([True, False]), "masked": np.ma.array([1.0, 2.0], mask=[True, False]),
    "masked away": np.ma.masked, "masked in a list": [np.ma.masked],
    "complex beside none": [None, np.complex128(1)], "unequal": Unequal(),
}  # fmt: skip
"""Values that a word or a flag cannot simply be compared with: numpy refuses to say whether the answer is true."""

NOT_A_NUMBER = st.sampled_from(
    (math.nan, math.inf, -math.inf, None, "", "10", b"1", 1j, True, [], [1.0], (1.0, 2.0), {}, {1}, object(),
     np.nan, np.array([1.0]), np.array([]), np.array("x"), np.True_, np.complex128(1), np.datetime64("2020-01-01"),
     10**400, -(10**400), Ellipsis, NotImplemented, len, Span, range(3), *WITHOUT_TRUTH.values())
)  # fmt: skip
ANYTHING = NOT_A_NUMBER | any_number | st.integers() | st.text(max_size=4) | st.lists(any_number, max_size=4)
VECTORS = ANYTHING | st.lists(NOT_A_NUMBER | any_number, max_size=4) | st.tuples(any_number, any_number, any_number)


def ends_well(call, named: str = "", result=lambda outcome: True) -> bool:
    """call() gives a result that ``result`` accepts, or a named error soon; True: the error."""
    refused = True
    start = time.perf_counter()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            outcome = call()
        except ConvergenceError as error:
            assert len(str(error)) > 8, str(error)
        except InputError as error:
            message = str(error)
            assert named in message and len(message) > 8, f"the error does not name {named!r}: {message!r}"
        else:
            assert result(outcome), f"accepted, with {outcome!r}"
            refused = False
    spent = time.perf_counter() - start
    assert spent < SLOWEST, f"{spent:.1f} s"
    return refused


def fuzzed(count: int, refused: int, *strategies):
    """A test of ``count`` spoiled inputs, at least so many ``refused``; DEEP times as many in the deep run.

    The check returns whether an input was refused.
    """

    def decorate(check):
        bad.append(refused)

        def run(deep, tmp_path_factory):
            folder, times, message = tmp_path_factory.mktemp("fuzz"), DEEP if deep else 1, []

            @settings(max_examples=count * times)
            @given(st.tuples(*strategies))
            def examples(drawn):
                message.append(check(folder, *drawn))

            examples()
            assert sum(message) >= refused * times, f"{sum(message)} of {len(message)} inputs were bad"

        run.__name__, run.__doc__ = check.__name__, check.__doc__
        return run

    return decorate


# ---------------------------------------------------------------- fields
GOOD = {
    Span: {"w": 100.0, "EA": 1e6, "L": 50.0, "x": 30.0, "z": 20.0, "seabed": True, "friction": 0.1, "clearance": 0.0},
    Node: {"kind": "free", "r": (0.0, 0.0, -5.0), "mass": 1.0, "volume": 0.0, "force": (0.0, 0.0, 1.0),
           "CdA": 1.0, "Ca": 0.5},
    Element: {"w": 100.0, "EA": 1e6, "L": 50.0, "ends": (0, 1), "friction": 0.0},
    Environment: {"rho": 1025.0, "g": 9.81, "depth": 50.0, "current": (0.0, 0.1, 0.0), "seabed_stiffness": 1e4},
    CableProperties: {
        "EA": 1e6, "diameter": 0.1, "mass_per_length": 80.0, "submerged_weight": 700.0, "Cdn": 1.2, "Cdb": 1.0,
        "Cdt": 0.1, "Ca": 1.0, "damping": 0.01,
    },
    Motion: {"frequency": 0.1, "sine": [[1.0, 0.0, 0.0]], "cosine": [[0.0, 0.0, 1.0]]},
    SampledMotion: {"time": [0.0, 1.0, 2.0], "samples": [[0.0] * 3, [1.0] * 3, [0.5] * 3]},
    Network: {
        "nodes": (Node("fixed", (0.0, 0.0, 0.0)), Node("free", (4.0, 0.0, -5.0))),
        "elements": (Element(10.0, 1e5, 7.0, (0, 1)),), "environment": Environment(),
    },
}  # fmt: skip
UNNAMED = {"depth": "seabed_stiffness", "nodes": "element"}
"""A field whose absence is told where another needs it."""

fields_of = st.sampled_from([(kind, field.name) for kind in GOOD for field in fields(kind) if field.name in GOOD[kind]])


def field_ends_well(where, value) -> bool:
    """The value is kept in the field as a finite one, or refused by the field's name; True: refused."""
    kind, name = where
    optional = value is None and kind in (Environment, CableProperties, Motion)
    known = "" if optional else _word(kind, name)

    def kept(made):
        valid = getattr(made, name)
        valid = 0.0 if valid is None and optional else valid
        if name == "kind":
            return valid in ("fixed", "free", "coupled")
        if name == "ends":  # of nodes, which the network counts
            return all(isinstance(end, int) for end in valid)
        return name == "seabed" or kind is Network or bool(np.isfinite(np.asarray(valid, dtype=float)).all())

    return ends_well(lambda: kind(**(GOOD[kind] | {name: value})), known, kept)


@fuzzed(300, 240, fields_of, VECTORS)
def test_fields(_, where, value):
    """Any value in any field of the public dataclasses is kept as a finite value, or refused by the field's name."""
    return field_ends_well(where, value)


def _word(kind, name) -> str:
    """The word of the message: Motion's arrays and SampledMotion's series may be told by the other's shape."""
    return "" if kind in (Motion, SampledMotion) and name != "frequency" else "" if name in UNNAMED else name


@fuzzed(80, 20, st.sampled_from(list(GOOD[Span])), ANYTHING | st.lists(ANYTHING, min_size=2, max_size=3))
def test_arrays_of_spans(_, name, value):
    """solve_spans with any value as an array: refused by name, or rows each with a status, NaN where failed."""
    if name == "seabed" and isinstance(value, (bool, np.bool_)):
        return False
    whole = {key: np.array([given, given]) for key, given in GOOD[Span].items()}

    def honest(batch):
        forces = np.array([batch.H, batch.V, batch.H_anchor, batch.V_anchor, batch.grounded_length])
        return bool((np.isfinite(forces).all(axis=0) == batch.success).all())

    with np.errstate(all="raise"):
        return ends_well(lambda: solve_spans(**(whole | {name: value})), "", honest)


numbers = {key: any_number | st.just(value) for key, value in GOOD[Span].items() if key != "seabed"}


@fuzzed(100, 65, st.fixed_dictionaries(numbers), st.booleans())
def test_spans_of_any_numbers(_, numbers, seabed):
    """Any numbers in all fields of a Span: an error, or a state whose forces are finite exactly if it is a success."""

    def solved():
        return solve_span(Span(**numbers, seabed=seabed), throw=False)

    honest = lambda state: state.success == all(map(math.isfinite, (state.H, state.V, state.H_anchor, state.V_anchor)))
    return ends_well(solved, "", honest)


# ---------------------------------------------------------------- files
@cache
def texts() -> dict[str, list[str]]:
    """Scene files by what reads them."""
    read = lambda pattern: [path.read_text(encoding="utf-8") for path in sorted(SCENES.glob(pattern))]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "lines.txt"
        write_moordyn(path, load_network(SCENES / "networks" / "oc3_moving.toml"))
        moordyn = [path.read_text(encoding="ascii")]
    return {"scene": read("*.toml") + read("dynamics/*.toml"), "network": read("networks/*.toml"), "map": read("*.map"),
            "moordyn": moordyn}  # fmt: skip


READERS = {
    "scene": Scene.load,
    "network": load_network,
    "map": lambda path: read_map_file(path, depth=320.0),
    "moordyn": load_moordyn,
}
VALUES = ("nan", "inf", "-inf", "-1", "0", "1e400", "true", '"text"', "[]", "[1]", "{}", "[[1, 2], [3]]", "1979-05-27",
          "-5e-324", "1e308", "''", "[1, 2, 'x']", "#", "-", "depth", "\x00", "\u00e9", "9" * 400)  # fmt: skip
cuts = st.integers(0, 10**6)


@st.composite
def spoiled(draw, kind: str) -> str:
    """A file of a kind with one to three places spoiled: a value, a key, a line, a piece, a character."""
    text = draw(st.sampled_from(texts()[kind]))
    for _ in range(draw(st.integers(1, 3))):
        how = draw(st.sampled_from(("value", "value", "value", "key", "double", "drop", "cut", "swap", "insert")))
        lines = text.split("\n")
        i, j = draw(cuts) % len(lines), draw(cuts) % len(lines)
        if how == "value":
            places = list(re.finditer(r"[-+#]?\d[\d.eE+-]*|\"[^\"]*\"|\bfix\b|\bconnect\b|\bvessel\b", text))
            if places:
                at = places[draw(cuts) % len(places)]
                text = text[: at.start()] + draw(st.sampled_from(VALUES)) + text[at.end() :]
        elif how == "key":
            lines[i] = draw(st.sampled_from(("x", "A", " "))) + lines[i]
            text = "\n".join(lines)
        elif how in ("double", "drop", "swap"):
            changed = {"double": lines[: i + 1] + lines[i:], "drop": lines[:i] + lines[i + 1 :]}
            lines[i], lines[j] = lines[j], lines[i]
            text = "\n".join(changed.get(how, lines))
        else:
            at = draw(cuts) % (len(text) + 1)
            new = draw(st.sampled_from(('"', "[", "]", "=", "\n", "-", "9", ",", "\t", "#", "\ufeff", ".")))
            text = text[:at] + (new + text[at:] if how == "insert" else "")
    return text


def _file_test(kind, count, refused=0.8):
    @fuzzed(count, int(refused * count), spoiled(kind))
    def check(folder, text):
        path = folder / f"bad.{'map' if kind == 'map' else 'toml'}"
        path.write_bytes(text.encode("utf-8"))
        return ends_well(lambda: READERS[kind](path), path.name)

    check.__doc__ = f"A spoiled {kind} file is read as something valid, or refused with an error that names the file."
    return check


test_scene_files, test_network_files, test_map_files = (
    _file_test(kind, count) for kind, count in (("scene", 150), ("network", 100), ("map", 120))
)
test_moordyn_files = _file_test("moordyn", 120, refused=0.4)  # whose titles, column names and units are not read


@fuzzed(20, 20, st.binary(max_size=60), st.sampled_from(sorted(READERS)))
def test_any_bytes_as_a_file(folder, content, kind):
    """A file of any bytes is refused with an InputError."""
    path = folder / "bytes"
    path.write_bytes(content)
    with pytest.raises(InputError, match="bytes"):
        READERS[kind](path)
    return True


@pytest.mark.parametrize("kind", READERS)
@pytest.mark.parametrize("path", [None, 3, 1.5, object(), [], {}, "", "no such file", "\x00", b"\xff", SCENES])
def test_paths(kind, path):
    """What is no path, no file or a folder is refused with an InputError."""
    with pytest.raises(InputError):
        READERS[kind](path)


# ---------------------------------------------------------------- solvers' keywords
@cache
def systems():
    """A small moving cable at rest, and a network of two lines."""
    from dataclasses import replace

    scene = Scene.load(SCENES / "dynamics" / "hb_case_1.toml")
    moving = cable_system(replace(scene, motion=Motion.harmonic(0.05, (0.1, 0.0, 0.0))), 5)
    nodes = (Node("fixed", (0.0, 0.0, 0.0)), Node("free", (4.0, 0.0, -5.0)), Node("coupled", (10.0, 0.0, 0.0)))
    lines = (Element(10.0, 1e5, 7.0, (0, 1)), Element(10.0, 1e5, 7.0, (1, 2)))
    return moving, Network(nodes, lines)


KEYWORDS = {
    "static": (lambda **k: solve_static(systems()[0], **k), {}, ("method", "tolerance", "throw")),
    "time": (
        lambda **k: solve_time_domain(systems()[0], **k),
        {"dt": 2.0, "periods": 0.2},
        (
            "dt",
            "periods",
            "duration",
            "rho_inf",
            "tolerance",
            "step_tolerance",
            "ramp",
            "start",
            "hold",
            "every",
            "scheme",
            "allow_invalid",
            "throw",
        ),
    ),
    "periodic": (
        lambda **k: solve_periodic(systems()[0], **k),
        {"harmonics": 2},
        (
            "harmonics",
            "samples",
            "subharmonic",
            "start",
            "tolerance",
            "globalisation",
            "mean",
            "multilevel",
            "symmetry",
            "throw",
        ),
    ),
    "network": (
        lambda **k: solve_network(systems()[1], **k),
        {},
        ("method", "jacobian", "globalisation", "units", "start", "tolerance", "fallback", "throw"),
    ),
    "modes": (lambda **k: natural_modes(systems()[0], **k), {}, ("count", "near")),
    "system": (lambda **k: cable_system(systems()[0].scene, **k), {}, ("nodes", "mesh", "fields", "motion")),
    "span": (lambda **k: solve_span(Span(**GOOD[Span]), **k), {}, ("tolerance", "throw")),
    "moved": (lambda **k: systems()[1].moved(**k), {}, ("positions",)),
}
SLOW_BUT_VALID = {"every", "harmonics", "samples", "nodes", "count", "periods", "duration", "dt", "subharmonic"}
"""Keywords of which a large or tiny valid number means work."""

WORK = 1e-8, 1e8  # between these such a number means work, beyond it must be refused

places = st.sampled_from([(solver, name) for solver, (_, _, names) in KEYWORDS.items() for name in names])


def keyword_ends_well(place, value) -> bool:
    """The value of the keyword is refused by its name, or solved with, to finite numbers; True: refused."""
    solver, name = place
    number = isinstance(value, Real) and not isinstance(value, bool)
    if number and name in SLOW_BUT_VALID and WORK[0] < value < WORK[1]:
        value = -value
    call, given, _ = KEYWORDS[solver]
    with np.errstate(divide="raise", over="raise", invalid="raise"):
        return ends_well(lambda: call(**(given | {name: value})), "" if value is None else name, _finite)


@fuzzed(150, 140, places, ANYTHING | VECTORS)
def test_keywords(_, place, value):
    """Any value of any keyword of the solvers is refused by the keyword's name, or solved, with finite numbers."""
    return keyword_ends_well(place, value)


@pytest.mark.parametrize("value", WITHOUT_TRUTH.values(), ids=WITHOUT_TRUTH)
def test_values_without_truth(value):
    """What cannot be compared is tried in every field and every keyword in every run, not only when it is drawn."""
    for kind, good in GOOD.items():
        for name in good:
            field_ends_well((kind, name), value)
    for solver, (_, _, names) in KEYWORDS.items():
        for name in names:
            keyword_ends_well((solver, name), value)


def _finite(result) -> bool:
    """No NaN leaves a solver as a success."""
    numbers = [getattr(result, name, 0.0) for name in ("y", "z", "r", "frequencies", "residual_norm")]
    return all(np.isfinite(np.asarray(part, dtype=float)).all() for part in numbers)


def test_the_deep_run_meets_enough_bad_inputs():
    """At least 20,000 in all, as each test counts its own."""
    assert DEEP * sum(bad) >= ASKED


# ---------------------------------------------------------------- the rule itself
@pytest.mark.parametrize(
    "call",
    [
        lambda: 1 / 0,
        lambda: {}["x"],
        lambda: warnings.warn("careful", stacklevel=2),
        lambda: (_ for _ in ()).throw(InputError("a value is wrong here")),
        lambda: (_ for _ in ()).throw(InputError("x")),
        lambda: math.nan,
    ],
)
def test_the_rule_finds_planted_faults(call):
    """Another exception, a warning, a message without the name, an empty message and a NaN each turn the rule red."""
    with pytest.raises((AssertionError, ZeroDivisionError, KeyError, UserWarning)):
        ends_well(call, "field", lambda result: result is not None and math.isfinite(result))
