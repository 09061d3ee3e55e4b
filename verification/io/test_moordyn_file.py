"""Does a MoorDyn file become the network that it means, is all else named, and does it come back as written?"""

from __future__ import annotations

import math
import re
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest

from solvers import CableProperties, Element, Environment, InputError, Network, Node, solve_network
from solvers.io import load_moordyn, load_network, write_moordyn

from ..reference import EPS

# The mooring of the OC3 Hywind spar (reference_data/oc3_hywind_loads): two lines alike, and one of another section.
OC3 = """OC3 Hywind
True Echo  of MoorDyn 1
----- LINE TYPES -----
TypeName Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx
(name) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
main 0.09 77.7066 384.243E6 -0.8 0 1.6 1.0 0.1 0.25
light 0.07 40.0 2e8 3e6 0 1.2 0.5 0.05 0.0
----- POINTS -----
ID Attachment X Y Z M V CdA CA
(#) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)
1 Fixed 853.87 0 -320.0 0 0 0 0
2 Anchor -426.94 739.47 -320.0 0 0 0 0
3 Free 400 0 -250.0 1e3 0.5 2 0.6
4 Vessel 5.2 0.0 -70.0 0 0 0 0
5 Coupled -2.6 4.5 -70.0 0 0 0 0
----- LINES -----
ID LineType AttachA AttachB UnstrLen NumSegs LineOutputs
(#) (name) (#) (#) (m) (-) (-)
1 main 1 3 450.0 20 p
2 light 3 4 452.2 10 -
3 main 2 5 902.2 40 -
----- SOLVER OPTIONS -----
0.002 dtM  time step
3.0e6 kBot
3.0e5 cBot
1025.0 WtrDnsty
9.81 g
320 WtrDpth
----- OUTPUTS -----
FairTen1
----- need this line -----
"""
MOORDYN_1 = """----- LINE TYPES -----
LineType Diam MassDen EA BA/-zeta Can Cat Cdn Cdt
(-) (m) (kg/m) (N) (Pa-s/-) (-) (-) (-) (-)
nylon 0.124 13.76 2515288.0 -0.8 1.1 0.0 1.6 0.05
----- CONNECTION PROPERTIES -----
Node Type X Y Z M V FX FY FZ CdA CA
(-) (-) (m) (m) (m) (kg) (m^3) (kN) (kN) (kN) (m^2) (-)
1 Vessel 0 0 -10 0 0 0 0 0 0 0
2 Connect 200 0 -60 100 0.1 10 -20 30 2 0.5
3 Fixed 267 0 -70 0 0 0 0 0 0 0
----- LINE PROPERTIES -----
Line LineType UnstrLen NumSegs NodeAnch NodeFair Flags/Outputs
(-) (-) (m) (-) (-) (-) (-)
1 nylon 210.0 50 2 1 p
2 nylon 80.0 50 3 2 p
----- SOLVER OPTIONS -----
70 WtrDpth - water depth
----- need this line -----
"""
ROUND_TRIP = 4 * EPS
"""Relative: a value is divided by EA or by a diameter and multiplied again."""


def written(folder, text, name="lines.txt") -> Path:
    path = folder / name
    path.write_bytes(text.encode("latin-1"))
    return path


# ---------------------------------------------------------------- what a file means
def test_every_column_arrives(tmp_path):
    """Points, ends, lengths, weights, coefficients, damping, seabed: by hand."""
    network = load_moordyn(written(tmp_path, OC3))
    assert [node.kind for node in network.nodes] == ["fixed", "fixed", "free", "coupled", "coupled"]
    assert network.node_names == ("1", "2", "3", "4", "5") and network.name == "lines"
    float_ = network.nodes[2]
    assert (float_.r, float_.mass, float_.volume) == ((400.0, 0.0, -250.0), 1e3, 0.5)
    assert (float_.CdA, float_.Ca, float_.force) == (2.0, 0.6, (0.0, 0.0, 0.0))
    assert [(e.ends, e.L, e.EA) for e in network.elements] == [
        ((0, 2), 450.0, 384.243e6),
        ((2, 3), 452.2, 2e8),
        ((1, 4), 902.2, 384.243e6),
    ]
    main, light = network.elements[0].cable, network.elements[1].cable
    assert (main.diameter, main.mass_per_length, main.Cdn, main.Cdb, main.Cdt, main.Ca) == (
        *(0.09, 77.7066, 1.6, 1.6),
        *(0.1, 1.0),
    )
    assert (light.Cdn, light.Ca, light.Cdt) == (1.2, 0.5, 0.05)
    weight = 9.81 * (77.7066 - 1025 * math.pi * 0.09**2 / 4)
    assert network.elements[2].w == pytest.approx(weight, rel=1e-15)
    environment = network.environment
    assert (environment.rho, environment.g, environment.depth) == (1025.0, 9.81, 320.0)
    assert environment.seabed_stiffness == pytest.approx(3e6 * 0.09, rel=1e-15)  # of the thicker line
    assert environment.seabed_damping == pytest.approx(3e5 * 0.09, rel=1e-15)
    assert load_moordyn(written(tmp_path, OC3 + "as sent\nby the yard\non Monday\n")) == network  # after its end


def test_damping_is_a_time_whichever_way_it_is_given(tmp_path):
    """BA is EA beta; -zeta is a share of the critical damping 2 sqrt(k m/4) = sqrt(EA m) of a segment: by hand."""
    first, second, third = (e.cable.damping for e in load_moordyn(written(tmp_path, OC3)).elements)
    segment = 450.0 / 20
    assert first == pytest.approx(0.8 * segment * math.sqrt(384.243e6 * 77.7066) / 384.243e6, rel=1e-14)
    assert second == pytest.approx(3e6 / 2e8, rel=1e-15)
    assert third == pytest.approx(first * (902.2 / 40) / segment, rel=1e-14)


def test_what_has_no_meaning_is_listed(tmp_path):
    """Each of them by name, and nothing twice."""
    notes = load_moordyn(written(tmp_path, OC3)).notes
    for part in ("CaAx = 0.25", "option dtM = 0.002", "NumSegs 20, 10, 40", "line 1: 0.8 of the critical damping",
                 "line 3: 0.8", "1 lines of OUTPUTS", "0.09 m, the diameter of the thickest line"):  # fmt: skip
        assert sum(part in note for note in notes) == 1, part
    assert len(notes) == 7


def test_only_ratios_of_damping_are_noted(tmp_path):
    """A damping of any size, and none, are what they are."""
    for BA in ("0", "0.5", "1e9"):
        notes = load_moordyn(written(tmp_path, OC3.replace("-0.8", BA))).notes
        assert not any("critical" in note for note in notes)


@pytest.mark.parametrize(("rho", "dry"), [("1025.0", ["point 4 is above z = 0", "point 5 is above z = 0"]), ("0", [])])
def test_points_above_the_water_are_noted_by_number(tmp_path, rho, dry):
    """Whichever way the file goes; without water there is no difference."""
    text = OC3.replace("-70.0", "2.0").replace("1025.0 WtrDnsty", f"{rho} WtrDnsty")
    network = load_moordyn(written(tmp_path, text))
    for notes in (network.notes, write_moordyn(tmp_path / "again.txt", network)):
        assert [note.split(",")[0] for note in notes if "above z" in note] == dry


def test_what_follows_the_end_is_not_read(tmp_path):
    """A title of a section that MoorDyn has not is refused; "need this line" and a bare rule end a section."""
    for rule in ("--- need this line ---", "------------------"):
        text = OC3.replace("----- OUTPUTS -----", f"{rule}\n9.9 g\nwhatever\n----- OUTPUTS -----")
        assert load_moordyn(written(tmp_path, text)).environment.g == 9.81


def test_lift_of_zero_is_none(tmp_path):
    network = load_moordyn(written(tmp_path, OC3.replace("0.1 0.25", "0.1 0.25 0 0.08 0.18")))
    assert network.elements == load_moordyn(written(tmp_path, OC3)).elements


def test_a_file_of_moordyn_1_has_other_columns(tmp_path):
    """Can Cat Cdn Cdt, forces of points, UnstrLen before the ends; defaults of the options: by hand."""
    network = load_moordyn(written(tmp_path, MOORDYN_1))
    cable = network.elements[0].cable
    assert (cable.Ca, cable.Cdn, cable.Cdt) == (1.1, 1.6, 0.05)
    assert network.nodes[1].force == (10.0, -20.0, 30.0) and (network.nodes[1].CdA, network.nodes[1].Ca) == (2.0, 0.5)
    assert [(e.ends, e.L) for e in network.elements] == [((1, 0), 210.0), ((2, 1), 80.0)]
    environment = network.environment
    assert (environment.rho, environment.g, environment.depth) == (1025.0, 9.80665, 70.0)
    assert environment.seabed_stiffness == pytest.approx(3e6 * 0.124, rel=1e-15)


SAME = [
    ("\n", "\r\n"),
    (" ", "\t"),
    ("\n", "   # a note --\n"),
    ("----- LINES -----", "---------------------- LINE LIST --"),
    ("----- POINTS -----", "--- POINT PROPERTIES ---"),
    ("1 Fixed", "# 1 Coupled 0 0 0 0 0 0 0\n\n1 FIX"),
    ("3 Free", "3 connect"),
    ("4 Vessel", "4 fairlead"),
    ("452.2 10 -", "452.2 10"),
    ("320 WtrDpth", "320 wtrdpth\n0 WaveKin\n0 Currents"),
    ("3.0e6 kBot", "3.0e6 kb the stiffness\n3.0e6 kbot"),
]


@pytest.mark.parametrize(("old", "new"), SAME, ids=[repr(new)[:24] for _, new in SAME])
def test_the_same_file_written_another_way(tmp_path, old, new):
    """Line ends, tabs, comments, aliases: nothing but notes changes."""
    network, other = (load_moordyn(written(tmp_path, text)) for text in (OC3, OC3.replace(old, new)))
    assert network.nodes == other.nodes and network.elements == other.elements
    assert network.environment == other.environment


def test_friction_of_the_seabed(tmp_path):
    network = load_moordyn(written(tmp_path, OC3.replace("9.81 g", "9.81 g\n0.6 FrictionCoefficient")))
    assert {element.friction for element in network.elements} == {0.6}
    assert any("saturates" in note for note in network.notes)


def test_the_seabed_is_below_the_lowest_point(tmp_path):
    """As MoorDyn does, with a note."""
    network = load_moordyn(written(tmp_path, OC3.replace("320 WtrDpth", "")))
    assert network.environment.depth == 320.0
    assert any("WtrDpth = 0 m is less than the depth of the lowest point, 320 m" in note for note in network.notes)


# ---------------------------------------------------------------- what is refused, and where
REFUSED = [
    ("----- LINE TYPES -----", "", ": section LINE TYPES: is missing; is this a MoorDyn file?"),
    ("----- LINES -----", "----- POINT LIST -----", ":16: section POINTS: is there already"),
    ("----- LINES -----", "----- CHAINS -----", ":19: section CHAINS: is not known"),
    ("----- LINES -----", "----- BODIES -----", ":19: section BODIES: bodies are not supported"),
    ("----- LINES -----", "----- RODS -----", ":19: section RODS: rigid rods are not supported"),
    ("----- LINES -----", "----- FAILURE -----", ":19: section FAILURE: lines that break are not supported"),
    ("----- LINES -----", "----- CONTROL -----", ":19: section CONTROL: lines of controlled length"),
    (" 0.05 0.0\n", " 0.05\n", ":7: section LINE TYPES: columns EI Cd Ca CdAx CaAx and 9 of them: neither"),
    ("0.09 77", "-0.09 77", ":6: diameter: -0.09 m must be > 0"),
    ("384.243E6", "curve.txt", ":6: EA: 'curve.txt' must be a number (N); curves in files are not supported"),
    ("384.243E6", "3e8|4e8", ":6: EA: '3e8|4e8' is a viscoelastic line, which is not supported"),
    ("-0.8 0 1.6", "-0.8|2 0 1.6", ":6: BA: '-0.8|2' is a viscoelastic line"),
    ("-0.8 0 1.6", "-0.8 1e4 1.6", ":6: EI: '1e4' is not 0: bending stiffness is not supported"),
    ("0.1 0.25", "0.1 0.25 0.5", ":6: Cl: '0.5' is not 0: vortex-induced lift is not supported"),
    ("EI Cd Ca CdAx CaAx", "EI Can Cat Cdn Cdt", ":6: section LINE TYPES: columns EI Can Cat Cdn Cdt and 10 of"),
    ("light 0.07", "main 0.07", ":7: Name: 'main' is there already"),
    ("77.7066", "1_000", ":6: MassDen: '1_000' must be a number"),
    ("77.7066", "inf", ":6: MassDen: 'inf' must be a finite number"),
    ("-320.0 0 0 0 0\n2", "-320.0 0 0 0\n2", ":11: section POINTS: 8 columns where MoorDyn takes 9: ID Type X"),
    ("2 Anchor", "1 Anchor", ":12: ID: '1' must be 2: numbered 1, 2, ... in order"),
    ("2 Anchor", "2 Body1", ":12: Type: 'Body1' is a body, which is not supported"),
    ("2 Anchor", "2 Anchr", ":12: Type: 'Anchr' must be one of anchor, fixed"),
    ("1e3 0.5 2", "-1e3 0.5 2", ":13: mass: -1000 kg must be >= 0"),
    ("-250.0", "deep", ":13: Z: 'deep' must be a number"),
    ("2 light 3", "2 lihgt 3", ":20: Type: 'lihgt' is no line type; did you mean 'light'?"),
    ("2 light 3", "1 light 3", ":20: ID: '1' must be 2: numbered 1, 2, ... in order"),
    ("2 light 3", "2 light R1A", ":20: AttachA: 'R1A' is the end of a rod, which is not supported"),
    ("2 light 3", "2 light 6", ":20: AttachA: '6' must be a point from 1 to 5"),
    ("2 light 3 4", "2 light 3 3", ":20: AttachB: '3' is both ends of the line"),
    ("452.2 10", "452.2 1.5", ":20: NumSegs: '1.5' must be a whole number >= 1"),
    ("452.2 10", "-452.2 10", ":20: L: -452.2 m must be > 0"),
    ("452.2 10 -", "452.2", ":20: section LINES: 5 columns where MoorDyn takes 6: ID Type AttachA"),
    ("9.81 g", "9.81 gg", ":27: Option: 'gg' is not known; did you mean 'g'?"),
    ("9.81 g", "0 g", ": g: 0 m/s^2 must be > 0"),
    ("9.81 g", "9.81 g\n9.82 gravity", ":28: Value: '9.82' of gravity is there already, 9.81"),
    ("9.81 g", "3 WaveKin", ":27: Value: '3' of WaveKin is not 0: waves are not supported"),
    ("9.81 g", "1 Currents", ":27: Value: '1' of Currents is not 0: current profiles are not supported"),
    ("9.81 g", "a.txt SeafloorFile", ":27: Value: 'a.txt' of SeafloorFile is not 0: a bathymetry is not"),
    ("320 WtrDpth", "bath.txt WtrDpth", ":28: Value: 'bath.txt' must be a number"),
    ("5 Coupled -2.6 4.5 -70.0 0 0 0 0", "5 Coupled -2.6 4.5 -70.0 0 0 0 0\n6 Free 0 0 0 0 0 0 0", ":16: point 6: "),
]


@pytest.mark.parametrize(("old", "new", "message"), REFUSED, ids=[f"{i}" for i in range(len(REFUSED))])
def test_what_is_wrong_is_named_with_its_line(tmp_path, old, new, message):
    assert old in OC3
    path = written(tmp_path, OC3.replace(old, new, 1))
    with pytest.raises(InputError, match="^" + re.escape(str(path) + message)):
        load_moordyn(path)


@pytest.mark.parametrize("path", [None, 3, "\x00", "no such file"])
def test_what_is_no_file(path):
    with pytest.raises(InputError, match=r"is not the path of a MoorDyn file|cannot be read"):
        load_moordyn(path)


# ---------------------------------------------------------------- round trips
def random_network(seed: int) -> Network:
    """Chains of lines from anchors over free nodes to one body, of some sections each, over a seabed."""
    rng = np.random.default_rng(seed)
    number = lambda low, high: float(rng.uniform(low, high))
    environment = Environment(
        number(1000, 1030), number(9.7, 9.9), number(100, 300), seabed_stiffness=number(1e3, 1e6),
        seabed_damping=number(0, 1e4),
    )  # fmt: skip
    cables = [
        CableProperties(
            *(number(1e7, 1e9), number(0.05, 0.2), number(20, 200)), Cdn=number(0, 2), Cdt=number(0, 0.3),
            Ca=number(0, 1), damping=number(0, 0.1) * int(rng.integers(0, 2)),
        )
        for _ in range(int(rng.integers(1, 4)))
    ]  # fmt: skip
    nodes, elements = [], []
    friction = number(0, 1) * int(rng.integers(0, 2))
    for angle in rng.uniform(0, 2 * math.pi, int(rng.integers(1, 4))):
        radii = np.linspace(400.0, 5.0, int(rng.integers(2, 5)))
        for k, radius in enumerate(radii.tolist()):
            kind = "fixed" if k == 0 else "coupled" if radius == 5.0 else "free"
            z = -environment.depth if k == 0 else number(-60.0, -10.0)
            r = (radius * math.cos(angle), radius * math.sin(angle), z)
            load = {"mass": number(0, 5e3), "volume": number(0, 3), "CdA": number(0, 4), "Ca": number(0, 1)}
            force = tuple(rng.normal(size=3).tolist()) if rng.integers(0, 2) else (0.0, 0.0, 0.0)
            nodes.append(Node(kind, r, force=force, **(load if kind == "free" else {})))
            if k:
                cable, ends = cables[int(rng.integers(len(cables)))], (len(nodes) - 2, len(nodes) - 1)
                length = number(1.0, 1.2) * float(np.linalg.norm(np.subtract(*(nodes[i].r for i in ends))))
                elements.append(Element(cable.weight_in(environment), cable.EA, length, ends, friction, cable))
    return Network(nodes, elements, environment)


def assert_same(one: Network, other: Network):
    """Equal to the rounding of the conversions; points and lines exactly."""
    assert one.nodes == other.nodes
    close = lambda a, b: np.testing.assert_allclose(a, b, rtol=ROUND_TRIP, atol=0)
    for name in ("rho", "g", "depth", "seabed_stiffness", "seabed_damping"):
        close(getattr(one.environment, name), getattr(other.environment, name))
    for a, b in zip(one.elements, other.elements, strict=True):
        assert (a.EA, a.L, a.ends, a.friction) == (b.EA, b.L, b.ends, b.friction)
        close(a.w, b.w)
        for name in ("EA", "diameter", "mass_per_length", "Cdn", "Cdb", "Cdt", "Ca", "damping"):
            close(getattr(a.cable, name), getattr(b.cable, name))


@pytest.mark.parametrize("seed", range(40))
def test_a_network_comes_back_as_it_was_written(tmp_path, seed):
    """Network to file to network to file: equal networks, and files alike but for their time step."""
    network, path = random_network(seed), tmp_path / "lines.txt"
    write_moordyn(path, network, cells=[5 + i for i in range(len(network.elements))])
    again = load_moordyn(path)
    assert_same(network, again)
    segments = next(note for note in again.notes if note.startswith("NumSegs"))
    assert segments.startswith("NumSegs " + ", ".join(str(5 + i) for i in range(len(network.elements))))
    write_moordyn(path, again)
    assert_same(network, load_moordyn(path))


@pytest.mark.parametrize("text", [OC3, MOORDYN_1], ids=["2", "1"])
def test_a_file_read_and_written_has_the_same_statics(tmp_path, text):
    """Its damping ratios are written as the damping that they are, its equilibrium is the same."""
    network = load_moordyn(written(tmp_path, text))
    write_moordyn(tmp_path / "again.txt", network, cells=7)
    again = load_moordyn(tmp_path / "again.txt")
    assert_same(network, again)
    np.testing.assert_allclose(solve_network(again).reaction, solve_network(network).reaction, rtol=0, atol=1e-3)


def test_damping_ratio_stands_for_lines_without_damping_alone(tmp_path):
    network = load_network(files("reference_data") / "scenes" / "networks" / "oc3_moving.toml")
    damped = replace(network.elements[0], cable=replace(network.elements[0].cable, damping=0.02))
    network = Network(network.nodes, [damped, *network.elements[1:]], network.environment)
    write_moordyn(tmp_path / "lines.txt", network, cells=10, damping_ratio=0.1)
    first, second, _ = (e.cable.damping for e in load_moordyn(tmp_path / "lines.txt").elements)
    assert first == pytest.approx(0.02, rel=1e-15)
    assert second == pytest.approx(0.1 * 90.22 * math.sqrt(77.7066 / 384.243e6), rel=1e-14)


def test_options_replace_what_is_written(tmp_path):
    network = load_network(files("reference_data") / "scenes" / "networks" / "oc3_moving.toml")
    notes = write_moordyn(tmp_path / "lines.txt", network, cells=10, options={"kBot": 5e6, "tScheme": "RK4"})
    again = load_moordyn(tmp_path / "lines.txt")
    assert again.environment.seabed_stiffness == pytest.approx(5e6 * 0.09, rel=1e-15)
    assert "option tScheme = RK4: of MoorDyn's own numerics" in again.notes
    assert len(notes) == 1 and notes[0].startswith("motion: ")


def test_the_file_steps_half_as_long_as_a_wave_crosses_the_shortest_segment(tmp_path):
    """And has one segment where one is asked for, no axial added mass, and a title."""
    network = load_network(files("reference_data") / "scenes" / "networks" / "oc3_moving.toml")
    write_moordyn(tmp_path / "lines.txt", network, cells=[1, 40, 5])
    again = load_moordyn(tmp_path / "lines.txt")
    step = next(note.split(" = ")[1].split(":")[0] for note in again.notes if note.startswith("option dtM"))
    assert float(step) == pytest.approx(0.5 * 902.2 / 40 * math.sqrt(77.7066 / 384.243e6), rel=1e-14)
    assert "NumSegs 1, 40, 5: the mesh is chosen where a line is moved" in again.notes
    assert not any("CaAx" in note for note in again.notes)
    assert (tmp_path / "lines.txt").read_text(encoding="ascii").splitlines()[1] == "OC3 Hywind, moving"


@pytest.mark.parametrize("depth", [320.0, None])
def test_a_seabed_under_lines_of_two_diameters_is_noted(tmp_path, depth):
    """Where there is one."""
    network = load_moordyn(written(tmp_path, OC3))
    environment = network.environment if depth else Environment(network.environment.rho, network.environment.g)
    notes = write_moordyn(tmp_path / "a.txt", Network(network.nodes, network.elements, environment))
    assert any("thickest line, 0.09 m" in note for note in notes) == (depth is not None)


def test_a_weight_that_is_rounded_is_noted(tmp_path):
    network = load_network(files("reference_data") / "scenes" / "networks" / "oc3_moving.toml")
    (note,) = (n for n in write_moordyn(tmp_path / "a.txt", change(network, w=698.09)) if "weight" in n)
    assert note.startswith("element 1: its weight, 698.09 N/m is not what diameter and mass give, 698.09")


def test_a_network_without_seabed_has_it_out_of_reach(tmp_path):
    network = random_network(3)
    bare = Network(network.nodes, network.elements, Environment(network.environment.rho, network.environment.g))
    notes = write_moordyn(tmp_path / "lines.txt", bare)
    again = load_moordyn(tmp_path / "lines.txt")
    assert sum("no seabed" in note for note in notes) == 1 and again.environment.seabed_stiffness == 0.0
    assert again.environment.depth > sum(e.L for e in bare.elements)


OUT_OF_REACH = [
    (lambda n: replace(n, environment=replace(n.environment, current=(1.0, 0.0, 0.0))), "current: (1.0, 0.0, 0.0) m/s"),
    (lambda n: replace(n, environment=replace(n.environment, seabed_stiffness=None)), "seabed_stiffness: not given"),
    (lambda n: change(n, cable=None), "element 1: cable: MoorDyn takes its diameter (m) and mass_per_length"),
    (lambda n: change(n, cable=CableProperties(n.elements[1].EA, 0.1, None, 1.0)), "element 1: cable: MoorDyn takes"),
    (lambda n: change(n, cable=CableProperties(n.elements[1].EA, None, 9.0, 1.0)), "element 1: cable: MoorDyn takes"),
    (lambda n: change(n, cable=replace(n.elements[1].cable, Cdb=9.0)), "element 1: Cdb: 9 is not Cdn"),
    (lambda n: change(n, w=50.0), "element 1: w: 50 N/m is not what diameter and mass give"),
    (lambda n: change(n, friction=2.0), "friction: 0.0, 2.0: MoorDyn has one FrictionCoefficient"),
    (lambda n: 3, "network: 3 is not a solvers.Network"),
]


def change(network, **fields):
    elements = list(network.elements)
    elements[1] = replace(elements[1], **fields)
    return Network(network.nodes, elements, network.environment)


@pytest.mark.parametrize(("make", "message"), OUT_OF_REACH, ids=[message[:24] for _, message in OUT_OF_REACH])
def test_what_moordyn_cannot_state_is_refused(tmp_path, make, message):
    network = load_network(files("reference_data") / "scenes" / "networks" / "oc3_moving.toml")
    with pytest.raises(InputError, match="^" + re.escape(message)):
        write_moordyn(tmp_path / "lines.txt", make(network))
    assert not (tmp_path / "lines.txt").exists()


@pytest.mark.parametrize(
    ("keywords", "message"),
    [({"cells": 0}, "cells: 0 must be"), ({"cells": [3, 4]}, "cells: 2 numbers where there are 3 elements"),
     ({"cells": [3, 4, 0.5]}, r"cells\[2\]: 0.5"), ({"damping_ratio": -1}, "damping_ratio: -1")],
)  # fmt: skip
def test_bad_keywords_are_refused(tmp_path, keywords, message):
    network = load_network(files("reference_data") / "scenes" / "networks" / "oc3_moving.toml")
    with pytest.raises(InputError, match=message):
        write_moordyn(tmp_path / "lines.txt", network, **keywords)
