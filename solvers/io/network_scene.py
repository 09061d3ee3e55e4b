"""A network of lines in one TOML file.

name = "..."                 optional: description
[environment]                rho = 1025 kg/m^3, g = 9.80665 m/s^2; depth (m): a flat seabed at z = -depth
[[line_types]]               name, EA (N), then submerged_weight (N/m) or diameter (m) + mass_per_length (kg/m)
[[nodes]]                    name, kind = "fixed", "free" or "coupled", r = [x, y, z] (m; of a free node a guess);
                             mass (kg), volume (m^3), force = [x, y, z] (N): 0 if not given
[[elements]]                 line_type, length (m), anchor and fairlead (names of nodes); friction of the seabed, or 0
"""

from __future__ import annotations

from dataclasses import dataclass
from difflib import get_close_matches
from os import PathLike

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


def load_network(path: str | PathLike[str]) -> NamedNetwork:
    """Read a network file. Raises InputError naming file, table, key and value of what is missing, unknown or wrong.

    >>> from importlib.resources import files
    >>> from solvers.io import load_network
    >>> len(load_network(files("reference_data") / "scenes" / "networks" / "three_bridles.toml").elements)
    9
    """
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
        if not error.item or error.item[0] != "node":
            raise
        i = error.item[1]
        raise error.labelled(f"[[nodes]] {list(nodes)[i]!r} ({made[i].kind})") from None


def _entries(name: str, tables):
    """Yield (where, table) of an array of tables, each with its keys checked."""
    if not isinstance(tables, list) or not all(isinstance(table, dict) for table in tables):
        raise InputError(f"must be tables, each under a line [[{name}]]", field=name, value=tables)
    if not tables:
        raise InputError(f"there must be at least one, under a line [[{name}]]", field=name, value=tables)
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
            raise InputError(f"unknown key {key!r} in {where}; {hint}", field=key, value=table[key], label="")
    for key in required:
        if key not in table:
            raise InputError(f"missing key {key!r} in {where}", field=key, label="")


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
    return CableProperties(table["EA"], **{key: table[key] for key in _SECTION if key in table})


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
    return Element(cable.weight_in(environment), cable.EA, table["length"], ends, table.get("friction", 0.0))


def _known(key: str, name, by_name: dict):
    if not isinstance(name, str) or name not in by_name:
        near = get_close_matches(str(name), by_name, n=1)
        hint = f"did you mean {near[0]!r}?" if near else f"known are {', '.join(map(repr, by_name))}"
        raise InputError(f"{name!r} is not in the file; {hint}", field=key, value=name)
    return by_name[name]
