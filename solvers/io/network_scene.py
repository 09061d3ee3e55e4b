"""A network of lines in one TOML file.

name = "..."                 optional: description
[environment]                rho = 1025 kg/m^3, g = 9.80665 m/s^2; depth (m): a flat seabed at z = -depth
[[line_types]]               name, EA (N), then submerged_weight (N/m) or diameter (m) + mass_per_length (kg/m)
[[nodes]]                    name, kind = "fixed", "free" or "coupled", r = [x, y, z] (m; of a free node a guess);
                             mass (kg), volume (m^3), force = [x, y, z] (N): 0 if not given
[[elements]]                 line_type, length (m), anchor and fairlead (names of nodes); friction of the seabed, or 0
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from difflib import get_close_matches

from ..common.outcome import InputError
from ..common.properties import CableProperties, Environment
from ..network.model import Element, Network, Node
from .scene import (  # private to this package: one wording of errors for all scene files
    _check_keys,
    _point,
    read_tables,
)

_SECTION = ("diameter", "mass_per_length", "submerged_weight")
_LOADS = ("mass", "volume", "force")
_TABLES = {  # table -> required keys, optional keys
    "line_types": (("name", "EA"), _SECTION),
    "nodes": (("name", "kind", "r"), _LOADS),
    "elements": (("line_type", "length", "anchor", "fairlead"), ("friction",)),
}


@dataclass(frozen=True)
class NamedNetwork(Network):
    """The network of a scene file; node_names (n,) in the order of its nodes."""

    name: str = ""
    description: str = ""
    node_names: tuple[str, ...] = ()


def load_network(path) -> NamedNetwork:
    """Read a network file. Raises InputError naming file, table, key and value of what is missing, unknown or wrong."""
    return read_tables(path, _from_tables)


def _from_tables(data: dict, stem: str) -> NamedNetwork:
    _check("the top level", data, tuple(_TABLES), ("name", "description", "environment"))
    for key in ("name", "description"):
        _text(key, data.get(key, ""))
    _check_keys("environment", data.get("environment", {}))
    environment = Environment(**data.get("environment", {}))
    types, nodes = (_by_name(name, data[name]) for name in ("line_types", "nodes"))
    weights = {name: _located(where, _cable, table) for name, (where, table) in types.items()}
    order = {name: i for i, name in enumerate(nodes)}
    made = [_located(where, _node, table) for where, table in nodes.values()]
    lines = [
        _located(where, _element, table, weights, order, environment)
        for where, table in _entries("elements", data["elements"])
    ]
    try:
        return NamedNetwork(
            *(tuple(made), tuple(lines), environment),
            name=data.get("name", stem),
            description=data.get("description", ""),
            node_names=tuple(nodes),
        )
    except InputError as error:
        raise InputError(
            re.sub(r"^node (\d+)", lambda i: f"[[nodes]] {list(nodes)[int(i[1])]!r}", str(error))
        ) from None


def _entries(name: str, tables):
    """(where, table) of an array of tables, each with its keys checked."""
    if not isinstance(tables, list) or not all(isinstance(table, dict) for table in tables):
        raise InputError(f"{name}: must be tables, each under a line [[{name}]]")
    if not tables:
        raise InputError(f"{name}: there must be at least one, under a line [[{name}]]")
    for i, table in enumerate(tables, start=1):
        own = repr(table["name"]) if "name" in table else f"number {i}"
        where = f"[[{name}]] {own}"
        _check(where, table, *_TABLES[name])
        yield where, table


def _check(where: str, table: dict, required, optional):
    known = (*required, *optional)
    for key in table:
        if key not in known:
            near = [k for k in known if k.lower() == key.lower()] or get_close_matches(key, known, n=1)
            hint = f"did you mean {near[0]!r}?" if near else f"known keys are {', '.join(sorted(known))}"
            raise InputError(f"unknown key {key!r} in {where}; {hint}")
    for key in required:
        if key not in table:
            raise InputError(f"missing key {key!r} in {where}")


def _by_name(kind: str, tables) -> dict:
    """Name -> (where, table)."""
    found = {}
    for where, table in _entries(kind, tables):
        name = _text(f"{where}: name", table["name"])
        if name in found:
            raise InputError(f"{where}: the name {name!r} is there already")
        found[name] = where, table
    return found


def _text(name: str, value) -> str:
    if not isinstance(value, str):
        raise InputError(f"{name}: {value!r} must be a text")
    return value


def _located(where: str, make, *arguments):
    """make(...), its InputError with the place in the file."""
    try:
        return make(*arguments)
    except InputError as error:
        raise InputError(f"{where}: {error}") from None


def _cable(table) -> CableProperties:
    return CableProperties(table["EA"], **{key: table[key] for key in _SECTION if key in table})


def _node(table) -> Node:
    loads = {key: table[key] for key in _LOADS if key in table}
    if "force" in loads:
        loads["force"] = _vector(loads["force"])
    return Node(table["kind"], _point("r", table["r"]), **loads)


def _vector(force):
    if not isinstance(force, list) or len(force) != 3:
        raise InputError(f"force: {force!r} must be three components [x, y, z] (N)")
    return tuple(force)


def _element(table, cables, order, environment) -> Element:
    cable = _known("line_type", table["line_type"], cables)
    ends = tuple(_known(end, table[end], order) for end in ("anchor", "fairlead"))
    if ends[0] == ends[1]:
        raise InputError(f"anchor and fairlead are both {table['anchor']!r}")
    return Element(cable.weight_in(environment), cable.EA, table["length"], ends, table.get("friction", 0.0))


def _known(key: str, name, found: dict):
    if not isinstance(name, str) or name not in found:
        near = get_close_matches(str(name), found, n=1)
        hint = f"did you mean {near[0]!r}?" if near else f"known are {', '.join(map(repr, found))}"
        raise InputError(f"{key}: {name!r} is not in the file; {hint}")
    return found[name]
