"""Write a network as a MAP++ input file, the inverse of ``read_map_file``; see map_file.py for conversions."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

from ...common.outcome import InputError
from ...common.properties import CableProperties
from ...network.model import Network
from .reader import KINDS

SAME_WEIGHT = 1e-9  # relative: a weight computed elsewhere from the same diameter and mass
_ATTACHMENTS = {kind: word for word, kind in KINDS.items()}
_FILE = """---------------------- LINE DICTIONARY ----------------------
LineType Diam MassDenInAir EA CB CIntDamp Ca Cdn Cdt
(-) (m) (kg/m) (N) (-) (Pa-s) (-) (-) (-)
{types}
---------------------- NODE PROPERTIES ----------------------
Node Type X Y Z M B FX FY FZ
(-) (-) (m) (m) (m) (kg) (m^3) (N) (N) (N)
{nodes}
---------------------- LINE PROPERTIES ----------------------
Line LineType UnstrLen NodeAnch NodeFair Flags
(-) (-) (m) (-) (-) (-)
{lines}
---------------------- SOLVER OPTIONS ----------------------
Option
(-)
"""


def write_map_file(path: str | PathLike[str], network: Network) -> tuple[str, ...]:
    """Write a network as a MAP++ input file; return what MAP++ lacks or takes another way, one sentence each.

    Raises InputError for what MAP++ cannot state: an element without a section (mass and diameter), an added mass or
    drag of a node, a binormal drag of its own.

    >>> import pathlib, tempfile
    >>> from importlib.resources import files
    >>> from solvers.io import load_network, read_map_file, write_map_file
    >>> network = load_network(files("reference_data") / "scenes" / "networks" / "oc3_moving.toml")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = pathlib.Path(folder) / "lines.map"
    ...     _ = write_map_file(file, network)
    ...     read_map_file(file, depth=320.0).elements[0].L
    902.2
    """
    notes: list[str] = []
    types: dict[tuple, str] = {}
    lines = []
    for i, element in enumerate(network.elements):
        cable = _section(element, i, network.environment, notes)
        name = types.setdefault((cable, element.friction), f"type{len(types) + 1}")
        lines.append(_row(i + 1, name, element.L, element.ends[0] + 1, element.ends[1] + 1))
    nodes = [
        _row(i, _ATTACHMENTS[node.kind], *node.r, node.mass, node.volume, *node.force)
        for i, node in enumerate(network.nodes, start=1)
    ]
    rows = [_type(name, cable, friction) for (cable, friction), name in types.items()]
    notes += [
        f"node {i}: CdA and Ca have no place in MAP++"
        for i, node in enumerate(network.nodes, start=1)
        if node.CdA or node.Ca
    ]
    water = network.environment
    depth = "no seabed" if water.depth is None else f"depth {water.depth:g} m"
    notes.append(f"{depth}, rho {water.rho:g} kg/m^3 and g {water.g:g} m/s^2 are those of its caller")
    text = _FILE.format(types="\n".join(rows), nodes="\n".join(nodes), lines="\n".join(lines))
    Path(path).write_text(text, encoding="utf-8")
    return tuple(notes)


def _section(element, i: int, environment, notes: list[str]) -> CableProperties:
    cable = element.cable
    if cable is None:
        problem = "it has no section (diameter in m, mass_per_length in kg/m), of which MAP++ makes its weight"
        raise InputError(problem, field="cable", item=("element", i))
    if cable.Cdb != cable.Cdn:
        problem = f"Cdb = {cable.Cdb:g} beside Cdn = {cable.Cdn:g}: MAP++ has one"
        raise InputError(problem, field="Cdb", item=("element", i))
    made = CableProperties(cable.EA, cable.diameter, cable.mass_per_length).weight_in(environment)
    if abs(made - element.w) > SAME_WEIGHT * abs(element.w):
        notes.append(f"line {i + 1}: MAP++ makes its weight of diameter and mass, {made:.6g} N/m for {element.w:.6g}")
    return cable


def _type(name: str, cable: CableProperties, friction: float) -> str:
    """Return a row of the line dictionary: the damping is the viscosity of a section."""
    viscosity = cable.damping * cable.EA / cable.area
    mass = cable.mass_per_length
    return _row(name, cable.diameter, mass, cable.EA, friction, viscosity, cable.Ca, cable.Cdn, cable.Cdt)


def _row(*words) -> str:
    return " ".join(f"{word:.15g}" if isinstance(word, float) else str(word) for word in words)
