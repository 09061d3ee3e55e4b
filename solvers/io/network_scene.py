"""A network of lines in one TOML file.

name = "..."                 optional: description
[environment]                rho = 1025 kg/m^3, g = 9.80665 m/s^2; depth (m): a flat seabed at z = -depth;
                             current (m/s, [x, y, z]), seabed_stiffness (N/m^2), seabed_damping (N s/m^2) for motion
[[line_types]]               name, EA (N), then submerged_weight (N/m) or diameter (m) + mass_per_length (kg/m); with
                             these, for motion: Cdn, Cdb, Cdt, Ca, damping (s), see CableProperties
[[nodes]]                    name, kind = "fixed", "free" or "coupled", r = [x, y, z] (m; of a free node a guess);
                             mass (kg), volume (m^3), force = [x, y, z] (N), CdA (m^2), Ca: 0 if not given
[[elements]]                 line_type, length (m), anchor and fairlead (names of nodes); friction of the seabed, or 0
[motion]                     optional, of the body that carries the coupled nodes, about those positions:
reference = [x, y, z]        m, the point that it turns about; the origin where it is not given
frequency = 0.1              Hz, or period (s)
amplitude = [2.0, 0.0, 0.0, 0.0, 0.05, 0.0]
                             surge, sway, heave (m), roll, pitch, yaw (rad), of sin(2 pi f t + phase); phase (rad): 0;
                             or sine and cosine: lists of rows of six, one for each harmonic of the frequency
file = "series.csv"          in place of all these but reference: a series, see solvers/io/series/motion_file.py
spectrum = "jonswap"         in place of them: waves, or "pierson_moskowitz", or a CSV file; Hs (m), Tp (s), gamma;
operators = "raos.csv"       seed, duration (s) until they repeat, heading (degrees); amplitudes = "rayleigh" or
                             "deterministic"; response amplitude operators: see solvers/io/series/sea_file.py
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from difflib import get_close_matches
from os import PathLike
from pathlib import Path

from ..common.diagnostics import check_drag
from ..common.motions.body_motion import BodyMotion
from ..common.outcome import InputError
from ..common.properties import CableProperties, Environment, missing_seabed_stiffness
from ..network.model import Element, Network, Node
from .keys import NETWORK, SECTION, check_keys
from .plausibility import suspect_angles, suspect_heights, suspect_phases, suspect_section
from .scene import (  # one wording of errors for all scene files
    _point,
    check_table,
    read_safety_factors,
    read_tables,
)
from .series.motion_file import motion_from_table

_LOADS = ("mass", "volume", "force", "CdA", "Ca")


@dataclass(frozen=True)
class NamedNetwork(Network):
    """The network of a file; node_names (n,) in the order of its nodes.

    motion : of the body that carries the coupled nodes, or None
    notes : what the file says and has no meaning here, or is taken in a way of its own, one sentence each
    warnings : what is suspected by its magnitude, with the likely unit or sign, one sentence each
    breaking_loads : of each element, N, or None; safety_factors : on mean and dynamic tension, for the page of the file
    """

    name: str = ""
    description: str = ""
    node_names: tuple[str, ...] = ()
    motion: BodyMotion | None = None
    notes: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    breaking_loads: tuple[float | None, ...] = ()
    safety_factors: tuple[float, float] | None = None


def load_network(path: str | PathLike[str]) -> NamedNetwork:
    """Read a network file. Raises InputError naming file, table, key and value of what is missing, unknown or wrong.

    What is suspected by its magnitude, a unit or a sign, stands in ``warnings``.

    >>> from importlib.resources import files
    >>> from solvers.io import load_network
    >>> len(load_network(files("reference_data") / "scenes" / "networks" / "three_bridles.toml").elements)
    9
    """
    return read_tables(path, _from_tables)


def _from_tables(data: dict, path: Path) -> NamedNetwork:
    check_keys("the top level", data, NETWORK[""])
    for key in ("name", "description"):
        _text(key, data.get(key, ""))
    check_table("environment", data.get("environment", {}), NETWORK)
    environment = Environment(**data.get("environment", {}))
    types, nodes = (_by_name(name, data[name]) for name in ("line_types", "nodes"))
    cables = {name: _located(where, _cable, table) for name, (where, table) in types.items()}
    order = {name: i for i, name in enumerate(nodes)}
    made = [_located(where, _node, table) for where, table in nodes.values()]
    lines = [
        _located(where, _element, table, cables, order, environment)
        for where, table in _entries("elements", data["elements"])
    ]
    if "safety_factors" in data:
        check_table("safety_factors", data["safety_factors"], NETWORK)
    types_of_lines = [cables[table["line_type"]] for table in data["elements"]]
    try:
        network = NamedNetwork(
            *(tuple(made), tuple(lines), environment),
            name=data.get("name", path.stem),
            description=data.get("description", ""),
            node_names=tuple(nodes),
            motion=_motion(data["motion"], path.parent, made, lines, environment) if "motion" in data else None,
            breaking_loads=tuple(cable.breaking_load for cable in types_of_lines),
            safety_factors=read_safety_factors(data),
        )
        return replace(network, warnings=tuple(_suspect(network, cables, data.get("motion", {}))))
    except InputError as error:
        if not error.item or error.item[0] != "node":
            raise
        i = error.item[1]
        raise error.labelled(f"[[nodes]] {list(nodes)[i]!r} ({made[i].kind})") from None


def _suspect(network, cables: dict[str, CableProperties], motion: dict):
    """Yield sentences on what is suspected in a network, its line types by name and its [motion] table."""
    for name, cable in cables.items():
        yield from (f"[[line_types]] {name!r}: {text}" for text in suspect_section(cable, network.environment))
    heights = {name: node.r[2] for name, node in zip(network.node_names, network.nodes, strict=True)}
    kinds = zip(network.node_names, network.nodes, strict=True)
    anchors = tuple(name for name, node in kinds if node.kind == "fixed")
    yield from suspect_heights(heights, anchors, network.environment.depth is not None)
    yield from suspect_angles(network.motion)
    yield from suspect_phases(motion.get("phase", ()))
    yield from check_drag(cables.values(), network.motion is not None, network.environment.current)


def _entries(name: str, tables):
    """Yield (where, table) of an array of tables, each with its keys checked."""
    if not isinstance(tables, list) or not all(isinstance(table, dict) for table in tables):
        raise InputError(f"must be tables, each under a line [[{name}]]", field=name, value=tables)
    if not tables:
        raise InputError(f"there must be at least one, under a line [[{name}]]", field=name, value=tables)
    for i, table in enumerate(tables, start=1):
        own = repr(table["name"]) if "name" in table else f"number {i}"
        where = f"[[{name}]] {own}"
        check_keys(where, table, NETWORK[name])
        yield where, table


def _by_name(kind: str, tables) -> dict:
    """Return {name: (where, table)}."""
    by_name = {}
    for where, table in _entries(kind, tables):
        name = _text("name", table["name"], label=f"{where}: name")
        if name in by_name:
            raise InputError(f"the name {name!r} is there already", field="name", value=name, label=where)
        by_name[name] = where, table
    return by_name


def _text(name: str, value, label=None) -> str:
    if not isinstance(value, str):
        raise InputError(f"{value!r} must be a text", field=name, value=value, label=label)
    return value


def _located(where: str, make, *arguments):
    """Return make(...); its InputError gets the table of the file."""
    try:
        return make(*arguments)
    except InputError as error:
        raise error.located(where) from None


def _cable(table) -> CableProperties:
    return CableProperties(table["EA"], **{key: table[key] for key in SECTION if key in table})


def _node(table) -> Node:
    loads = {key: table[key] for key in _LOADS if key in table}
    if "force" in loads:
        loads["force"] = _vector(loads["force"])
    return Node(table["kind"], _point("r", table["r"]), **loads)


def _vector(force):
    if not isinstance(force, list) or len(force) != 3:
        problem = f"{force!r} must be three components [x, y, z] (N)"
        raise InputError(problem, field="force", value=force, unit="N")
    return tuple(force)


def _element(table, cables, order, environment) -> Element:
    cable = _known("line_type", table["line_type"], cables)
    ends = tuple(_known(end, table[end], order) for end in ("anchor", "fairlead"))
    if ends[0] == ends[1]:
        problem = f"anchor and fairlead are both {table['anchor']!r}"
        raise InputError(problem, field="fairlead", value=table["fairlead"], label="")
    section = cable if cable.diameter and cable.mass_per_length else None  # both of which motion takes
    weight, friction = cable.weight_in(environment), table.get("friction", 0.0)
    return Element(weight, cable.EA, table["length"], ends, friction, section)


def _motion(table, folder: Path, nodes, elements, environment) -> BodyMotion:
    """Return the motion of the body; raises InputError for what a moving network needs and the file lacks."""
    check_table("motion", table, NETWORK)
    motion = motion_from_table(table, folder)
    if not any(node.kind == "coupled" for node in nodes):
        raise InputError('no node has kind = "coupled", which a body would move', field="motion")
    for i, element in enumerate(elements, start=1):
        if element.cable is None:
            problem = "its line type has no diameter (m) and mass_per_length (kg/m), and [motion] takes both"
            raise InputError(problem, field="line_type", label=f"[[elements]] number {i}: line_type")
    if environment.depth is not None and environment.seabed_stiffness is None:
        diameter = max(element.cable.diameter for element in elements)
        raise missing_seabed_stiffness("[motion]", diameter, "environment.seabed_stiffness")
    return motion


def _known(key: str, name, by_name: dict):
    if not isinstance(name, str) or name not in by_name:
        near = get_close_matches(str(name), by_name, n=1)
        hint = f"did you mean {near[0]!r}?" if near else f"known are {', '.join(map(repr, by_name))}"
        raise InputError(f"{name!r} is not in the file; {hint}", field=key, value=name)
    return by_name[name]
