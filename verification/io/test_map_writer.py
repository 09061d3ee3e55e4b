"""A network that is written for MAP++ comes back; what MAP++ has no place for is said or refused."""

from __future__ import annotations

from dataclasses import replace
from importlib.resources import files

import numpy as np
import pytest

from solvers import CableProperties, Element, Environment, InputError, Network, Node, solve_network
from solvers.io import load_network, read_map_file, write_map_file

NETWORKS = files("reference_data") / "scenes" / "networks"
WRITTEN = 1e-13  # relative: numbers are written with fifteen digits
CABLE = CableProperties(EA=3e8, diameter=0.1, mass_per_length=80.0, Cdn=1.2, Cdt=0.1, Ca=0.7, damping=0.03)


def bridle(cable=CABLE, **water):
    """Return two lines that meet in a joint with a mass, a volume and a force."""
    environment = Environment(depth=200.0, **water)
    nodes = [Node("fixed", (0, 0, -200)), Node("free", (250, 5, -120), 900.0, 2.0, (1e3, -2e3, 3e3)),
             Node("coupled", (320, 0, -10))]  # fmt: skip
    w = cable.weight_in(environment)
    ends = ((0, 1), (1, 2))
    elements = [
        Element(w, cable.EA, L, e, mu, cable) for L, e, mu in zip((280.0, 120.0), ends, (0.5, 0.0), strict=True)
    ]
    return Network(nodes, elements, environment)


def test_a_network_comes_back_as_it_was_written(tmp_path):
    """Sections, nodes and loads; two frictions of one section are two types."""
    network, path = bridle(), tmp_path / "bridle.map"
    notes = write_map_file(path, network)
    assert len(notes) == 1 and "depth 200 m" in notes[0]
    back = read_map_file(path, depth=200.0)
    for mine, theirs in zip(network.elements, back.elements, strict=True):
        assert (mine.L, mine.ends, mine.friction, mine.EA) == (theirs.L, theirs.ends, theirs.friction, theirs.EA)
        for name in ("diameter", "mass_per_length", "Cdn", "Cdb", "Cdt", "Ca", "damping"):
            assert getattr(theirs.cable, name) == pytest.approx(getattr(mine.cable, name), rel=WRITTEN), name
    for mine, theirs in zip(network.nodes, back.nodes, strict=True):
        assert mine.kind == theirs.kind and mine.r == pytest.approx(theirs.r, rel=WRITTEN)
        assert (mine.mass, mine.volume) == (theirs.mass, theirs.volume)
    assert back.nodes[1].force == (1e3, -2e3, 3e3)


def test_statics_are_those_of_the_network(tmp_path):
    """Of a shipped network, through the file."""
    network = load_network(NETWORKS / "three_bridles_moving.toml")
    write_map_file(tmp_path / "a.map", network)
    mine, theirs = solve_network(network), solve_network(read_map_file(tmp_path / "a.map", depth=320.0))
    np.testing.assert_allclose(theirs.H, mine.H, rtol=1e-9)  # of solved forces


def test_what_map_lacks_is_said(tmp_path):
    """Drag of a node, and a weight that is not that of mass and diameter."""
    network = bridle()
    drag = replace(network, nodes=[*network.nodes[:1], replace(network.nodes[1], CdA=2.0), *network.nodes[2:]])
    assert any("node 2: CdA and Ca" in note for note in write_map_file(tmp_path / "a.map", drag))
    heavy = replace(network, elements=[replace(network.elements[0], w=900.0), network.elements[1]])
    assert any("line 1: MAP++ makes its weight" in note for note in write_map_file(tmp_path / "a.map", heavy))


@pytest.mark.parametrize(
    ("cable", "message"), [(None, "element 0: it has no section"), (replace(CABLE, Cdb=2.0), "MAP.. has one")]
)
def test_what_map_cannot_state_is_refused(tmp_path, cable, message):
    network = bridle()
    changed = [replace(element, cable=cable) for element in network.elements]
    with pytest.raises(InputError, match=message):
        write_map_file(tmp_path / "a.map", replace(network, elements=changed))
    assert not (tmp_path / "a.map").exists()
