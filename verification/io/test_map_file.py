"""Does a MAP++ file become the network that it means, and does everything else end in an error with file and line?"""

from __future__ import annotations

import math
import re
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest

from solvers import InputError, solve_network
from solvers.io.map_plus_plus.reader import SECTIONS, read_map_file

SCENES = files("reference_data") / "scenes"
OC3 = SCENES / "oc3_hywind.map"
BRIDLE = SCENES / "bridle.map"
DEPTH = 320.0

OPENFAST = {"H": 736939.290, "V": 535727.992, "H_anchor": 736845.198}
"""N: summary file of the OpenFAST r-test 5MW_OC3Spar_DLL_WTurb_WavesIrr, all three lines (g = 9.80665)."""
OPENFAST_TOLERANCE = 1e-8
"""Relative: MAP++ solves to 1e-6 m and N, prints 1e-3 N, and rounds pi to 3.14159264 (1e-9 of the weight)."""
ROTATED = 1e-12
"""Relative: cos and sin of the turned copies, amplified by the stiffness of a stretched line (about 1e3)."""


def edited(tmp_path, old: str, new: str, source=BRIDLE) -> Path:
    """A copy of a file with one text replaced, which must be there."""
    text = source.read_text(encoding="utf-8")
    assert text.count(old) >= 1, old
    path = tmp_path / "edited.map"
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    return path


# ---------------------------------------------------------------- what a file means
def test_the_oc3_file_gives_the_forces_of_openfast():
    """Weight in water, friction, depth, repeated lines: one wrong and the published forces are missed."""
    state = solve_network(read_map_file(OC3, depth=DEPTH))
    for name, value in OPENFAST.items():
        np.testing.assert_allclose(getattr(state, name), value, rtol=OPENFAST_TOLERANCE, err_msg=name)


def test_every_column_arrives():
    """Nodes, elements, kinds, guesses behind #, friction, lines of output flags and options: by hand."""
    network = read_map_file(BRIDLE, depth=DEPTH)
    assert [node.kind for node in network.nodes] == ["fixed", "free", "coupled", "coupled"] * 3
    assert network.nodes[0].r == (853.87, 0.0, -320.0)
    assert network.nodes[1].r == (40.0, 0.0, -80.0)
    first, leg = network.elements[0], network.elements[2]
    assert (first.ends, first.L, first.EA, first.friction) == ((0, 1), 870.0, 384.243e6, 1.0)
    assert (leg.ends, leg.L) == ((1, 3), 30.0)
    assert first.w == pytest.approx(9.80665 * (77.7066 - 1025 * math.pi * 0.09**2 / 4), rel=1e-15)
    assert network.ignored[1] == "line 1: tension_anch" and network.ignored[-1] == "outer_tol 1e-6"
    assert network.node_names == tuple(str(i) for i in range(1, 13)) and network.ignored == network.notes


def test_coefficients_of_motion_arrive(tmp_path):
    """Damping, added mass and drag of the section, current and a yielding seabed: by hand."""
    path = edited(tmp_path, "0.6   -1.0  0.05", "0.6    1.6  0.05")
    network = read_map_file(path, depth=DEPTH, current=(0.5, 0.0, 0.0), seabed_stiffness=1e4, seabed_damping=1e3)
    cable = network.elements[3].cable
    assert (cable.diameter, cable.mass_per_length) == (0.09, 77.7066)
    assert (cable.Ca, cable.Cdn, cable.Cdb, cable.Cdt) == (0.6, 1.6, 1.6, 0.05)
    assert cable.damping == pytest.approx(1e8 * math.pi * 0.09**2 / 4 / 384.243e6, rel=1e-14)
    environment = network.environment
    assert (environment.current, environment.seabed_stiffness) == ((0.5, 0.0, 0.0), 1e4)
    assert environment.seabed_damping == 1e3


def test_a_negative_coefficient_is_none():
    """As published files for statics have: the line can be solved at rest, and has no section to move with."""
    network = read_map_file(BRIDLE, depth=DEPTH)
    assert all(element.cable is None for element in network.elements)
    assert network.ignored[0] == "line type chain: Cdn = -1: no coefficient; it cannot be moved"


def test_environment_comes_from_the_arguments():
    network = read_map_file(OC3, depth=100.0, rho=1000.0, g=9.81)
    assert network.nodes[0].r[2] == -100.0
    assert network.elements[0].w == pytest.approx(9.81 * (77.7066 - 1000 * math.pi * 0.09**2 / 4), rel=1e-15)


def test_loads_of_nodes(tmp_path):
    """Mass, volume and force of a connect node; # at a vessel node is no load."""
    path = edited(tmp_path, "-80   0    0      0    0    0", "-80   12.5  3e1  1.  -2  .5")
    node = read_map_file(path, depth=DEPTH).nodes[1]
    assert (node.mass, node.volume, node.force) == (12.5, 30.0, (1.0, -2.0, 0.5))


@pytest.mark.parametrize("marked", ["#", "#-1e3"])
def test_a_guessed_reaction_is_no_load(tmp_path, marked):
    path = edited(tmp_path, "-70.0  0    0      #    #    #", f"-70.0  0    0  {marked} {marked} {marked}")
    assert read_map_file(path, depth=DEPTH).nodes[2].force == (0.0, 0.0, 0.0)


def test_repeat_turns_clockwise_from_above(tmp_path):
    """As MAP++: 90 degrees take (x, y) to (y, -x), positions and forces alike; elements follow their nodes."""
    path = edited(tmp_path, "repeat 120 240", "repeat 90")
    path = edited(tmp_path, "-80   0    0      0    0    0", "-80   0  0  7 3 1", source=path)
    network = read_map_file(path, depth=DEPTH)
    assert len(network.nodes) == 8 and len(network.elements) == 6
    for own, copy in zip(network.nodes[:4], network.nodes[4:], strict=True):
        for name in ("r", "force"):
            x, y, z = getattr(own, name)
            np.testing.assert_allclose(getattr(copy, name), (y, -x, z), atol=1e-13 * (abs(x) + abs(y)))
    assert [e.ends for e in network.elements[3:]] == [(a + 4, b + 4) for a, b in (e.ends for e in network.elements[:3])]


def test_copies_carry_equal_forces():
    """Three bridles turned by 120 degrees: the same tensions."""
    state = solve_network(read_map_file(BRIDLE, depth=DEPTH))
    tension = np.hypot(state.H, state.V).reshape(3, 3)
    np.testing.assert_allclose(tension, np.broadcast_to(tension[0], (3, 3)), rtol=1e-8)
    assert tension[0, 0] > 1e5


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("Node  Type ", "ID Attachment"),
        ("M    B ", "M    V "),
        ("(m^3)", "(m\u02c63)"),
        ("vessel   2.6     4.5", "VESSEL\t2.60\t4.5"),
        ("depth", "-320"),
        ("outer_tol 1e-6", "HELP\n\n repeat 5 is a comment: it starts with a blank"),
    ],
)
def test_spellings_that_real_files_use(tmp_path, old, new):
    same = read_map_file(edited(tmp_path, old, new), depth=DEPTH)
    network = read_map_file(BRIDLE, depth=DEPTH)
    assert same.nodes == network.nodes and same.elements == network.elements


def test_without_depth_there_is_no_contact_to_omit(tmp_path):
    path = edited(tmp_path, "depth", "-320")
    path = edited(tmp_path, "tension_anch", "omit_contact", source=path)
    assert read_map_file(path).environment.depth is None
    with pytest.raises(InputError, match="flag 'omit_contact': one line without seabed"):
        read_map_file(path, depth=DEPTH)


# ---------------------------------------------------------------- what is refused, and where
REFUSED = [
    ("870.0     1 ", "870.0     9 ", "NodeAnch: '9' must be a node from 1 to 4"),
    ("870.0     1 ", "870.0     2 ", "NodeAnch and NodeFair are both 2"),
    ("2     chain     30.0", "2     wire      30.0", "LineType: 'wire' is none of chain"),
    ("2     chain     30.0", "7     chain     30.0", "Line: '7' must be 2"),
    ("3     vessel", "2     vessel", "Node: '2' must be 3"),
    ("3     vessel", "3     anchor", "Type: 'anchor' must be one of fix, connect, vessel"),
    ("870.0", "#870.0", "UnstrLen: '#870.0' is marked as unknown"),
    ("870.0", "-870.0", "L: -870 m must be > 0"),
    ("870.0", "1_000", "UnstrLen: '1_000' must be a number"),
    ("870.0", "nan", "UnstrLen: 'nan' must be a number"),
    ("870.0", "1e999", "UnstrLen: '1e999' must be a number"),
    ("853.87  0  ", "#853.87  0  ", "X: '#853.87' is marked as unknown"),
    ("#40", "#forty", "X: '#forty' must be a number"),
    ("#-80", "-320.5", "node 2 (free): z = -320.5 m lies below the seabed"),
    ("#-80", "deep", "Z: 'deep' must be a number"),
    ("-80   0    0      0    0    0", "-80   0    0      #    0    0", "FX: '#' is marked as unknown"),
    ("-80   0    0      0    0    0", "-80   0    0      0    0", "9 columns where NODE PROPERTIES has 10"),
    ("-80   0    0 ", "-80   -5   0 ", "mass: -5 kg must be >= 0"),
    ("-80   0    0      0    0    0", "-80   0    0      0    0    0   0", "11 columns where NODE PROPERTIES has 10"),
    ("870.0     1         2         tension_anch", "870.0     1", "4 columns where LINE PROPERTIES has 5"),
    ("0.6   -1.0  0.05", "0.6   -1.0", "8 columns where LINE DICTIONARY has 9"),
    ("384.243E6", "0", "EA: 0 N must be > 0"),
    ("chain     0.09   77.7066", "chain     nine   77.7066", "Diam: 'nine' must be a number"),
    ("tension_anch", "linear_spring", "flag 'linear_spring': a spring in place of a catenary"),
    ("tension_anch", "tension", "flag 'tension': is not known"),
    ("tension_anch", "diagnostic", "diagnostic: '' must be a number"),
    ("outer_tol 1e-6", "lm_model", "option 'lm_model': lumped masses"),
    ("outer_tol 1e-6", "outer_tolerance 1e-6", "option 'outer_tolerance': is not known"),
    ("repeat 120 240", "repeat 120 x", "repeat: 'x' must be a number"),
    ("CB     CIntDamp", "cIntDamp Can ", "must be LineType Diam MassDenInAir EA CB CIntDamp Ca Cdn Cdt"),
    ("---------------------- NODE", "---------------------- KNOT", "unknown title"),
]


@pytest.mark.parametrize(("old", "new", "message"), REFUSED, ids=[f"{new}"[-24:] for _, new, _ in REFUSED])
def test_what_is_wrong_is_named_with_file_and_line(tmp_path, old, new, message):
    path = edited(tmp_path, old, new)
    changed = 1 + path.read_text(encoding="utf-8").split(new)[0].count("\n")
    with pytest.raises(InputError, match=re.escape(f"{path}:{changed}: ") + ".*" + re.escape(message)):
        read_map_file(path, depth=DEPTH)


@pytest.mark.parametrize(
    ("old", "new", "field", "value"),
    [
        ("3     vessel", "3     anchor", "Type", "anchor"),
        ("2     chain     30.0", "2     wire      30.0", "LineType", "wire"),
        ("870.0", "nan", "UnstrLen", "nan"),
        ("repeat 120 240", "repeat 120 x", "repeat", "x"),
    ],
)
def test_an_error_has_the_column_and_the_word_in_it(tmp_path, old, new, field, value):
    with pytest.raises(InputError) as refused:
        read_map_file(edited(tmp_path, old, new), depth=DEPTH)
    assert (refused.value.field, refused.value.value) == (field, value)


def test_a_second_type_of_the_same_name_is_refused(tmp_path):
    row = next(line for line in BRIDLE.read_text(encoding="utf-8").splitlines() if line.startswith("chain"))
    path = edited(tmp_path, row, f"{row}\n{row}")
    with pytest.raises(InputError, match=r"edited\.map:5: LineType 'chain' is there already"):
        read_map_file(path, depth=DEPTH)


@pytest.mark.parametrize("title", ["LINE DICTIONARY", "NODE PROPERTIES", "LINE PROPERTIES", "SOLVER OPTIONS"])
def test_a_section_that_is_missing_or_doubled_is_named(tmp_path, title):
    text = BRIDLE.read_text(encoding="utf-8")
    sections = re.split(r"(?m)^(?=-{10})", text)
    own = next(section for section in sections if title in section)
    path = tmp_path / "edited.map"
    for changed, message in ((text.replace(own, ""), "missing"), (text + own, "unknown title, or there already")):
        path.write_text(changed, encoding="utf-8")
        with pytest.raises(InputError, match=rf"edited\.map:\d+: .*({message})"):
            read_map_file(path, depth=DEPTH)


def test_only_the_section_of_options_may_be_empty(tmp_path):
    """A file without lines or nodes says nothing; one without options is read."""
    text = BRIDLE.read_text(encoding="utf-8").split("\n")
    titles = [i for i, line in enumerate(text) if line.startswith("--")] + [len(text)]
    for title, start, end in zip(SECTIONS, titles, titles[1:], strict=False):
        path = tmp_path / "empty.map"
        path.write_text("\n".join(text[: start + 3] + text[end:]), encoding="utf-8")
        if title == "SOLVER OPTIONS":
            assert len(read_map_file(path, depth=DEPTH).nodes) == 4
        else:
            with pytest.raises(InputError, match=f"section {title} is empty"):
                read_map_file(path, depth=DEPTH)


def test_a_missing_line_of_units_does_not_swallow_a_row(tmp_path):
    path = edited(tmp_path, "(-)   (-)       (m)       (-)       (-)       (-)\n", "")
    with pytest.raises(InputError, match=r"edited\.map:14: '1': a line of units"):
        read_map_file(path, depth=DEPTH)


def test_depth_is_asked_for():
    with pytest.raises(InputError, match=r"oc3_hywind\.map:8: Z: 'depth' needs the depth of the water in m: --depth"):
        read_map_file(OC3)


def test_a_node_without_line_is_named_with_its_own_line(tmp_path):
    row = "4     vessel   2.6     -4.5   -70.0  0    0      #    #    #"
    path = edited(tmp_path, row, row + "\n5     connect  #0      #0     #-50   0    0      0    0    0")
    with pytest.raises(InputError, match=r"edited\.map:12: node 5 \(free\): "):
        read_map_file(path, depth=DEPTH)


def test_what_is_no_map_file(tmp_path):
    with pytest.raises(InputError, match=r"none\.map: cannot be read: No such file"):
        read_map_file(tmp_path / "none.map")
    with pytest.raises(InputError, match="cannot be read: Is a directory"):
        read_map_file(tmp_path)
    path = tmp_path / "some.map"
    for content in (b"\x89PNG\r\n\x1a\n\0\0", BRIDLE.read_text(encoding="utf-8").encode("utf-16"), b""):
        path.write_bytes(content)
        with pytest.raises(InputError, match=r"some\.map:\d+: "):
            read_map_file(path)
