"""Does a network's TOML file become the network that it means, and is every slip named with its place?"""

from __future__ import annotations

import math
import re
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest

from solvers import InputError, solve_network
from solvers.io.map_plus_plus.reader import read_map_file
from solvers.io.network_scene import load_network

SCENES = files("reference_data") / "scenes"
NETWORKS = SCENES / "networks"
CHAIN = NETWORKS / "chain_wire_chain.toml"

COORDINATES = 1e-6
"""Relative: the TOML file rounds coordinates to 1e-6 m and w to 1e-3 N/m, the .map file computes them."""
BALANCED = 1e-9
"""Of the largest force: what is asked of any solved network."""


def edited(tmp_path, old: str, new: str, source=CHAIN) -> Path:
    text = source.read_text(encoding="utf-8")
    assert old in text, old
    path = tmp_path / "edited.toml"
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    return path


# ---------------------------------------------------------------- what a file means
def test_every_key_arrives():
    """Nodes, loads, ends by name, weight from diameter and mass, friction: by hand."""
    network = load_network(CHAIN)
    assert network.name == "Chain, wire, chain" and network.environment.depth == 200.0
    assert network.node_names == ("anchor", "ground joint", "upper joint", "fairlead")
    assert [node.kind for node in network.nodes] == ["fixed", "free", "free", "coupled"]
    buoy = network.nodes[2]
    assert (buoy.mass, buoy.volume, buoy.force, buoy.r) == (1500.0, 6.0, (0.0, 0.0, 0.0), (850.0, 0.0, -40.0))
    assert [e.ends for e in network.elements] == [(0, 1), (1, 2), (2, 3)]
    assert [(e.L, e.EA, e.friction) for e in network.elements] == [
        (400.0, 8.5e8, 0.7),
        (500.0, 5.5e8, 0.0),
        (50.0, 8.5e8, 0.0),
    ]
    for element, diameter, mass in zip(network.elements, (0.144, 0.084, 0.144), (128.0, 27.6, 128.0), strict=True):
        weight = 9.80665 * (mass - 1025 * math.pi * diameter**2 / 4)
        assert element.w == pytest.approx(weight, rel=1e-15)


def test_weights_follow_the_environment_of_the_file(tmp_path):
    path = edited(tmp_path, "rho = 1025.0\ng = 9.80665", "rho = 1000.0\ng = 9.81")
    weight = 9.81 * (128.0 - 1000 * math.pi * 0.144**2 / 4)
    assert load_network(path).elements[0].w == pytest.approx(weight, rel=1e-15)


def test_force_of_a_node(tmp_path):
    path = edited(tmp_path, "volume = 6.0", "volume = 6.0\nforce = [1, -2.5, 3e3]")
    assert load_network(path).nodes[2].force == (1.0, -2.5, 3000.0)


@pytest.mark.parametrize("path", sorted(NETWORKS.glob("*.toml")), ids=lambda path: path.stem)
def test_the_examples_are_in_balance(path):
    """Each is solved from no guess; free nodes carry no force but what the seabed gives, upwards."""
    network = load_network(path)
    state = solve_network(network)
    assert state.residual_norm <= BALANCED
    largest = np.hypot(state.H, state.V).max()
    for node, r, reaction in zip(network.nodes, state.r, state.reaction, strict=True):
        if node.kind == "free":
            assert np.abs(reaction[:2]).max() <= BALANCED * largest
            resting = r[2] <= -network.environment.depth
            assert reaction[2] < 0 if resting else abs(reaction[2]) <= BALANCED * largest


def test_the_ground_joint_lies_on_the_seabed():
    """What the example is there for: the joint of chain and wire rests and leaves its weight to the seabed."""
    network = load_network(CHAIN)
    state = solve_network(network)
    joint = network.node_names.index("ground joint")
    assert state.r[joint, 2] == -200.0
    assert state.reaction[joint, 2] == pytest.approx(-500.0 * 9.80665, rel=1e-6)


@pytest.mark.parametrize(("scene", "map_file"), [("oc3_three_lines", "oc3_hywind")])
def test_toml_and_map_tell_of_the_same_system(scene, map_file):
    """Two readers, two files, one mooring: equal sets of tensions."""
    states = (
        solve_network(load_network(NETWORKS / f"{scene}.toml")),
        solve_network(read_map_file(SCENES / f"{map_file}.map", depth=320.0)),
    )
    ours, other = (np.sort(np.hypot(state.H, state.V)) for state in states)
    np.testing.assert_allclose(ours, other, rtol=COORDINATES)


# ---------------------------------------------------------------- what is refused, and where
REFUSED = [
    ("[environment]", "[enviroment]", "unknown key 'enviroment' in the top level; did you mean 'environment'?"),
    ("[[nodes]]", "[[node]]", "unknown key 'node' in the top level; did you mean 'nodes'?"),
    ("depth = 200.0", "Depth = 200.0", "unknown key 'Depth' in [environment]; did you mean 'depth'?"),
    ("mass = 500.0", "masse = 500.0", "unknown key 'masse' in [[nodes]] 'ground joint'; did you mean 'mass'?"),
    ("friction = 0.7", "CB = 0.7", "unknown key 'CB' in [[elements]] number 1; did you mean 'friction'?"),
    ("EA = 5.5e8", "ea = 5.5e8", "unknown key 'ea' in [[line_types]] 'wire'; did you mean 'EA'?"),
    ("EA = 5.5e8", "", "missing key 'EA' in [[line_types]] 'wire'"),
    ("EA = 5.5e8", "EA = -5.5e8", "[[line_types]] 'wire': EA: -5.5e+08 N must be > 0"),
    ("mass_per_length = 27.6", "", "[[line_types]] 'wire': submerged_weight: not given"),
    ("length = 500.0", "", "missing key 'length' in [[elements]] number 2"),
    ("length = 500.0", "length = '500'", "[[elements]] number 2: L: '500' must be a real number"),
    ("length = 500.0", "length = -500", "[[elements]] number 2: L: -500 m must be > 0"),
    (
        'line_type = "wire"',
        'line_type = "wier"',
        "number 2: line_type: 'wier' is not in the file; did you mean 'wire'?",
    ),
    ('anchor = "ground joint"', 'anchor = "joint"', "[[elements]] number 2: anchor: 'joint' is not in the file"),
    (
        'anchor = "ground joint"',
        "anchor = 1",
        "[[elements]] number 2: anchor: 1 is not in the file; known are 'anchor'",
    ),
    ('anchor = "ground joint"', 'anchor = "upper joint"', "number 2: anchor and fairlead are both 'upper joint'"),
    ('name = "upper joint"', 'name = "ground joint"', "[[nodes]] 'ground joint': the name 'ground joint' is there"),
    ('name = "upper joint"', "name = 7", "name: 7 must be a text"),
    ('kind = "coupled"', 'kind = "vessel"', "[[nodes]] 'fairlead': kind: 'vessel' must be 'fixed', 'free' or"),
    ("r = [885.0, 0.0, -15.0]", "r = [885.0, -15.0]", "[[nodes]] 'fairlead': r: [885.0, -15.0] must be three"),
    ("r = [885.0, 0.0, -15.0]", "r = [885.0, 0.0, nan]", "[[nodes]] 'fairlead': r[2]: nan m must be finite"),
    ("r = [885.0, 0.0, -15.0]", "r = [885.0, 0.0, -201.0]", "[[nodes]] 'fairlead' (coupled): z = -201 m lies below"),
    ("volume = 6.0", "force = 5.0", "[[nodes]] 'upper joint': force: 5.0 must be three components"),
    ("volume = 6.0", "volume = -6.0", "[[nodes]] 'upper joint': volume: -6 m^3 must be >= 0"),
    ("friction = 0.7", "friction = -0.7", "[[elements]] number 1: friction: -0.7"),
    ("depth = 200.0", "depth = 'deep'", "depth: 'deep' must be a real number"),
    ('description = "', "description = 3 # ", "description: 3 must be a text"),
    ("[environment]", "[environment", "is not a TOML file"),
]


@pytest.mark.parametrize(("old", "new", "message"), REFUSED, ids=[f"{new}"[-24:] or old for old, new, _ in REFUSED])
def test_what_is_wrong_is_named_with_its_place(tmp_path, old, new, message):
    path = edited(tmp_path, old, new)
    with pytest.raises(InputError, match="^" + re.escape(f"{path}: ") + ".*" + re.escape(message)):
        load_network(path)


@pytest.mark.parametrize("tables", ["nodes = 3", "nodes = []", "[nodes]\nname = 'a'", "nodes = [1, 2]"])
def test_tables_of_another_shape_are_refused(tmp_path, tables):
    path = tmp_path / "some.toml"
    path.write_text(f"line_types = [{{name = 'a', EA = 1.0, submerged_weight = 1.0}}]\nelements = []\n{tables}\n")
    with pytest.raises(InputError, match=r"nodes: .*\[\[nodes\]\]"):
        load_network(path)


def test_a_node_without_line_goes_by_its_name(tmp_path):
    lone = '[[nodes]]\nname = "lone"\nkind = "free"\nr = [0.0, 0.0, -5.0]\n\n[[elements]]'
    with pytest.raises(InputError, match=r"edited\.toml: \[\[nodes\]\] 'lone' \(free\): "):
        load_network(edited(tmp_path, "[[elements]]", lone))


def test_what_is_no_file(tmp_path):
    with pytest.raises(InputError, match="there is no such scene file"):
        load_network(tmp_path / "none.toml")
    with pytest.raises(InputError, match="cannot be read as a text file"):
        load_network(tmp_path)
    path = tmp_path / "some.toml"
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match="cannot be read as a text file"):
        load_network(path)
    path.write_text("name = 'empty'\n")
    with pytest.raises(InputError, match="missing key 'line_types' in the top level"):
        load_network(path)
