"""Are slips of unit and sign suspected, with the likely unit, and ordinary lines not? Ten systems of new users.

Written from the README alone; half of them with a mistake that users make.
"""

from __future__ import annotations

import re

import pytest

from solvers import Environment, InputError, Node, Scene, cable_system, mooring_system, solve_static
from solvers.common.properties import SEABED_PRESSURE, CableProperties
from solvers.io import load_network, plausibility

CHAIN = """
[environment]
depth = 50.0
seabed_stiffness = 3e5
[line]
length = 500.0
EA = 7.5e8
diameter = 0.16
mass_per_length = 160.0
Cdn = 2.4
Ca = 1.0
[ends]
anchor = [-480.0, 0.0, -50.0]
fairlead = [0.0, 0.0, -5.0]
[motion]
period = 10.0
amplitude = [2.0, 0.0, 1.0]
"""
SEMI = """
name = "Semi-submersible, two lines"
[environment]
depth = 200.0
seabed_stiffness = 2.5e5
[[line_types]]
name = "chain"
EA = 7.5e8
diameter = 0.16
mass_per_length = 160.0
Cdn = 2.4
[[nodes]]
name = "anchor east"
kind = "fixed"
r = [800.0, 0.0, -200.0]
[[nodes]]
name = "anchor west"
kind = "fixed"
r = [-800.0, 0.0, -200.0]
[[nodes]]
name = "east"
kind = "coupled"
r = [40.0, 0.0, -14.0]
[[nodes]]
name = "west"
kind = "coupled"
r = [-40.0, 0.0, -14.0]
[[elements]]
line_type = "chain"
length = 800.0
anchor = "anchor east"
fairlead = "east"
[[elements]]
line_type = "chain"
length = 800.0
anchor = "anchor west"
fairlead = "west"
[motion]
frequency = 0.1
amplitude = [2.0, 0.0, 1.0, 0.0, 0.05, 0.0]
"""


@pytest.fixture
def read(tmp_path):
    """Reader of a text with one part replaced by another, through a file."""

    def read_text(text, old="", new=""):
        assert old in text
        path = tmp_path / "mine.toml"
        path.write_text(text.replace(old, new, 1) if old else text, encoding="utf-8")
        return (load_network if "[[elements]]" in text else Scene.load)(path)

    return read_text


POLYESTER = ("[environment]\ndepth = 1500.0\nseabed_stiffness = 1e5\n", "[environment]\n")
RIGHT = [  # what differs from CHAIN or SEMI; each has an equilibrium and nothing to be suspected
    (CHAIN, "", ""),
    (SEMI, "", ""),
    (CHAIN, "[line]\nlength = 500.0\nEA = 7.5e8", "[line]\nlength = 482.0\nEA = 9e6\nsubmerged_weight = 14.0"),
    (CHAIN, "diameter = 0.16\nmass_per_length = 160.0", "diameter = 0.088\nmass_per_length = 160.0"),
    (SEMI, "mass_per_length = 160.0", "mass_per_length = 350.0\nsubmerged_weight = 2990.0"),
]
USUAL_ROPE = {"diameter = 0.16": "diameter = 0.09", "mass_per_length = 160.0": "mass_per_length = 5.5"}
"""Of the third: a nylon rope, whose weight in water differs from that of its section, for it has voids."""


@pytest.mark.parametrize(("text", "old", "new"), RIGHT, ids=["chain", "semi", "rope", "volume", "weight"])
def test_ordinary_systems_of_new_users_run(read, text, old, new):
    """No suspicion, and an equilibrium."""
    assert old in text
    text = text.replace(old, new, 1) if old else text
    if "EA = 9e6" in text:
        for name, value in USUAL_ROPE.items():
            text = text.replace(name, value, 1)
    system = read(text)
    assert system.warnings == ()
    assert solve_static(mooring_system(system, 20)).success


def names(rows) -> list[str]:
    """Return what stands in the names of tests for (text, old, new, message)."""
    return [new[-30:] or f"without {old}" for _, old, new, _ in rows]


SUSPECTED = [
    (CHAIN, "mass_per_length = 160.0", "mass_per_length = 1570.0", r"likely in N/m, 160.1 kg/m"),
    (CHAIN, "EA = 7.5e8", "EA = 7.5e5", r"EA = 750000 N .* likely in kN, 7.5e\+08 N"),
    (CHAIN, "EA = 7.5e8", "EA = 750.0", r"EA = 750 N .* likely in MN, 7.5e\+08 N"),
    (CHAIN, "[line]", "[line]\nsubmerged_weight = 1.367", r"contradicts .* make 1367 N/m: likely in kN/m, 1367 N/m"),
    (CHAIN, "[line]", "[line]\nsubmerged_weight = 139.4", r"contradicts .* likely in kg/m, 1367 N/m"),
    (CHAIN, "[line]", "[line]\nsubmerged_weight = 2500.0", r"contradicts mass_per_length .*: leave it out"),
    (CHAIN, "length = 500.0", "length = 1640.0", r"The line is slack: 1640 m are more than 480 m along and 45 m up"),
    (CHAIN, "length = 500.0", "length = 300.0", r"at rest is stretched by .* %, as no line holds"),
    (CHAIN, "Cdn = 2.4", "", r"Cdn: 0, or not given: no drag acts across the line"),
    (CHAIN, "[2.0, 0.0, 1.0]", "[2.0, 0.0, 1.0]\nphase = [0, 0, 90.0]", r"phase = 90 rad .* in degrees, 1.571 rad"),
    (CHAIN, "fairlead = [0.0, 0.0, -5.0]", "fairlead = [0.0, 0.0, 45.0]", r"fairlead is 45 m above still water"),
    (SEMI, "0.05, 0.0]", "3.0, 0.0]", r"turns the body by 3 rad, 172 degrees: likely in degrees"),
    (SEMI, "diameter = 0.16\nmass_per_length = 160.0", "diameter = 0.2\nmass_per_length = 32.0", r"the line floats"),
    (CHAIN, "[line]", "[line]\nbreaking_load = 7500.0", r"breaking_load = 7500 N .* likely in kN, 7\.5e\+06 N"),
    (SEMI, "diameter = 0.16", "diameter = 160", r"\[\[line_types\]\] 'chain': diameter = 160 m .* in mm"),
    (SEMI, "Cdn = 2.4", "", r"Cdn: 0"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "old", "new", "message"), SUSPECTED, ids=names(SUSPECTED))
def test_a_slip_is_suspected_with_the_likely_unit(read, text, old, new, message):
    """One sentence about it, and no other."""
    system = read(text, old, new)
    assert len(system.warnings) == 1, system.warnings
    assert re.search(message, system.warnings[0])


@pytest.mark.parametrize("text", [CHAIN, SEMI], ids=["scene", "network"])
def test_depths_that_count_downwards_are_suspected(read, text):
    """All z positive, anchors deepest."""
    text = text.replace("-5.0]", "0.0]")  # one fairlead is at still water
    for z in ("-50.0", "-200.0", "-14.0"):
        text = text.replace(z, z[1:])
    assert any("z counts upwards, so depths are negative" in warning for warning in read(text).warnings)


REFUSED = [
    (CHAIN, "mass_per_length = 160.0", "mass_per_length = 0.16", r"mass_per_length = 0.16 kg/m .* in t/m, 160 kg/m"),
    (CHAIN, "diameter = 0.16", "diameter = 160.0", r"diameter = 160 m .* likely in mm, 0.16 m"),
    (CHAIN, "diameter = 0.16", "diameter = 16.0", r"diameter = 16 m .* likely in cm, 0.16 m"),
    (CHAIN, "mass_per_length = 160.0", "mass_per_length = 10.0", r"a buoyant line.* In a file: leave out depth"),
    (
        CHAIN,
        "diameter = 0.16\nmass_per_length = 160.0",
        "diameter = 0.2\nmass_per_length = 32.0\n",
        r"displaces 32.2 kg/m of water, .* the line floats\. .* \(of polyester 0.172 m\)",
    ),
    (CHAIN, "Cdn", "Cd", "did you mean 'Cdn'"),
    (CHAIN, "depth = 50.0", "depth = -50.0", r"depth: -50 m must be > 0: the seabed is at z = -depth, so give 50 m"),
    (CHAIN, "seabed_stiffness = 3e5\n", "", r"3e\+06 Pa/m .*MoorDyn.*here 4.8e\+05 N/m\^2; or leave out depth, which"),
    (SEMI, "seabed_stiffness = 2.5e5\n", "", r"here 4.8e\+05 N/m\^2; or leave out depth, which removes the seabed"),
    (SEMI, 'fairlead = "east"', 'fairlead = "eas"', "'eas' is not in the file; did you mean 'east'"),
]


@pytest.mark.parametrize(("text", "old", "new", "message"), REFUSED, ids=names(REFUSED))
def test_a_mistake_is_refused_with_what_to_write(read, text, old, new, message):
    with pytest.raises(InputError, match=message):
        read(text, old, new)


def test_the_suggested_stiffness_is_that_of_moordyn_times_the_diameter():
    """The same for the paper's cable, for a line of nodes and for files."""
    chain = CableProperties(EA=3.8e8, diameter=0.09, mass_per_length=77.7, Cdn=1.6)
    scene = Scene("mine", chain, 902.2, (0.0, 0.0, -320.0), (848.67, 0.0, -70.0), Environment(depth=320.0))
    for make in (mooring_system, cable_system):
        with pytest.raises(InputError, match=f"here {0.09 * SEABED_PRESSURE:.2g}".replace("+", r"\+")):
            make(scene)


def test_results_repeat_what_is_suspected_of_their_input(read):
    """Static states say it at once, without a solve: a mistake is not out of sight once the file is read."""
    scene = read(CHAIN, "[line]", "[line]\nsubmerged_weight = 139.4")
    for system in (mooring_system(scene, 20), cable_system(scene, 40)):
        assert scene.warnings[0] in solve_static(system).warnings


def test_friction_that_is_not_carried_is_said_where_the_numbers_stand(read):
    """The paper's cable has none; a line of nodes has it in motion, and none at rest; without friction none is said."""
    rough, smooth = read(CHAIN, "[line]", "[line]\nfriction = 0.7"), read(CHAIN)
    for make, words in ((mooring_system, "in motion only"), (cable_system, "not in these equations")):
        said = [text for text in solve_static(make(rough, 40)).warnings if text.startswith("friction: 0.7")]
        assert len(said) == 1 and words in said[0]
        assert not any(text.startswith("friction") for text in solve_static(make(smooth, 40)).warnings)


def test_lines_in_a_tank_and_in_air_are_not_suspected():
    """Chain at 1:40 (EA and section by Froude), a foam-cored umbilical that floats, and a wire in air."""
    water = Environment()
    for section in (
        CableProperties(EA=7.5e8 / 40**3, diameter=0.16 / 40, mass_per_length=160 / 40**2),
        CableProperties(EA=2e8, diameter=0.3, mass_per_length=50.0),
        CableProperties(EA=1e8, diameter=0.04, mass_per_length=7.0),
    ):
        assert list(plausibility.suspect_section(section, water)) == []
    assert Node("fixed", (0, 0, 0)).mass == 0.0
