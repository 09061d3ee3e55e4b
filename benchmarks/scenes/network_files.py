"""Network files of any format as networks, with a motion of their own or of another file, and names for their parts."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from solvers import InputError
from solvers.io import load_body_motion, load_moordyn, load_network, read_map_file
from solvers.io.network_scene import NamedNetwork
from solvers.io.plausibility import is_lighter_than_any_line, suspect_angles, suspect_heights, suspect_section

KEPT = ("name", "description", "warnings", "breaking_loads", "safety_factors")
"""What a network file says beside its nodes and elements, and a motion in place of its own leaves as it is."""
MAP_SECTION = "LINE DICTIONARY"  # by which a MAP++ file is known: .dat is its suffix in OpenFAST and one of MoorDyn's


def load(path: Path, depth: float | None = None, series: Path | None = None):
    """Return the network of a file and sentences on what the file says without meaning here.

    depth: of the water in m, which a MAP++ file may leave to its reader; series: a CSV file with the motion of the
    body, in place of the file's own. Raises InputError naming file and place of what is wrong.
    """
    network, notes = _read_network(path, depth)
    check_weights(network, [element.cable for element in network.elements], path)
    if series is None:
        return network, notes
    names, motion = getattr(network, "node_names", ()), load_body_motion(series)
    kept = {key: getattr(network, key) for key in KEPT if hasattr(network, key)}
    suspected = (*kept.pop("warnings", ()), *suspect_angles(motion, series.name))
    moved = NamedNetwork(network.nodes, network.elements, network.environment, node_names=names, motion=motion,
                         warnings=suspected, **kept)  # fmt: skip
    return moved, notes


def check_weights(system, cables, path: Path):
    """Raise InputError with all that is suspected of a system one of whose lines is lighter than any line there is.

    A unit is wrong in its file for certain, and minutes of work would go into a page of numbers without meaning.
    """
    light = next((cable for cable in cables if cable is not None and is_lighter_than_any_line(cable)), None)
    if light is None:
        return
    hint = "Nothing is computed of a line that is lighter than foam; where that is meant, give submerged_weight (N/m)."
    raise InputError(" ".join([*system.warnings, hint]), field=str(path), value=light.mass_per_length, unit="kg/m")


def _read_network(path: Path, depth: float | None):
    if path.suffix.lower() == ".toml":
        network = load_network(path)
        return network, network.notes
    if MAP_SECTION in path.read_text(encoding="utf-8", errors="replace").upper():
        network = read_map_file(path, depth=depth)
        notes = tuple(f"Not used: {text}." for text in network.ignored)
    else:
        network = load_moordyn(path)
        notes = network.notes
    return replace(network, warnings=tuple(_suspect(network))), notes


def _suspect(network):
    """Yield sentences on what is suspected in the file of another program, sections by the first line that has them."""
    first = {element.cable: i for i, element in reversed([*enumerate(network.elements, start=1)]) if element.cable}
    for cable, i in sorted(first.items(), key=lambda item: item[1]):
        yield from (f"line {i}: {text}" for text in suspect_section(cable, network.environment))
    nodes = dict(zip(node_names(network), network.nodes, strict=True))
    heights = {f"node {name}": node.r[2] for name, node in nodes.items()}
    anchors = tuple(f"node {name}" for name, node in nodes.items() if node.kind == "fixed")
    yield from suspect_heights(heights, anchors, network.environment.depth is not None)


def node_names(network) -> list[str]:
    """Return the names of the nodes, their numbers where the file gives none."""
    return list(getattr(network, "node_names", ())) or [str(i) for i in range(1, len(network.nodes) + 1)]


def line_names(network) -> list[str]:
    """Return a name for each line: those of the nodes at its ends, its number where the nodes have none."""
    names = getattr(network, "node_names", ())
    if not names:
        return [f"line {i}" for i in range(1, len(network.elements) + 1)]
    return [f"{names[a]} \N{EN DASH} {names[b]}" for a, b in (element.ends for element in network.elements)]
