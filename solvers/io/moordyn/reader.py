"""Read a MoorDyn input file, version 2 or 1, as a network.

LINE TYPES   Name Diam MassDen EA BA/-zeta EI Cd Ca CdAx CaAx: Cd on d l is Cdn and Cdb, CdAx on pi d l is Cdt;
             BA (N s) is damping = BA/EA (s); -zeta, a share of the critical damping of a segment, is BA = zeta (L/n)
             sqrt(EA m) in a line of length L and n segments, so damping = zeta (L/n) sqrt(m/EA) of that line
POINTS       ID Attachment X Y Z M V [FX FY FZ] CdA Ca: fixed, coupled and free points are nodes; forces in N
LINES        ID LineType AttachA AttachB UnstrLen NumSegs Outputs: end A is the anchor end of an element
OPTIONS      g, rho or WtrDnsty, WtrDpth; kBot and cBot act per area (Pa/m, Pa s/m), so times a diameter they are
             seabed_stiffness and seabed_damping; FrictionCoefficient is the friction of every element

Weights follow from MassDen and Diam. What else a file says is refused where it changes the model (bodies, rods,
bending, lift, curves of stiffness, waves, currents, bathymetry), and is listed in ``notes`` where it does not.
"""

from __future__ import annotations

import math
from os import PathLike
from pathlib import Path

from ...common.outcome import InputError
from ...common.properties import CableProperties, Environment
from ...network.model import Element, Node
from ..network_scene import NamedNetwork
from .tables import Row, nearest, read_sections

KINDS = {
    **dict.fromkeys(("anchor", "fixed", "fix"), "fixed"),
    **dict.fromkeys(("fairlead", "vessel", "ves", "coupled", "cpld"), "coupled"),
    **dict.fromkeys(("point", "connect", "con", "free"), "free"),
}
OPTIONS = {  # keyword -> its name here; those of MoorDyn 1 and of MoorDyn-F among them
    **{"g": "g", "gravity": "g", "rho": "rho", "rhow": "rho", "wtrdnsty": "rho", "wtrdpth": "depth"},
    **{"kbot": "kBot", "kb": "kBot", "cbot": "cBot", "cb": "cBot"},
    **{"frictioncoefficient": "friction", "mu_ka": "friction"},
}
DEFAULTS = {"g": 9.80665, "rho": 1025.0, "depth": 0.0, "kBot": 3e6, "cBot": 3e5, "friction": 0.0}
"""MoorDyn 2's own, source/MoorDyn2.cpp; SI units."""

NUMERICS = """dtm dt cfl tscheme dtic icdt tmaxic ictmax cdscaleic icdfac threshic icthresh gendynamicic icgendynamic
fileic icfile writelog writeunits dtout disableoutput disableouttime dtwave unifycurrentgrid outswitch echo inertialf
inertialf_rampt fricdamp statdynfricscale cv mc mu_kt"""
"""Options of time steps, initial conditions, outputs and the speed at which friction saturates."""

FORBIDDEN = {
    "wavekin": "waves are not supported",
    "currents": "current profiles are not supported; give Environment.current",
    "waterkin": "waves and current profiles are not supported",
    "seafloorfile": "a bathymetry is not supported; the seabed is flat",
}


def load_moordyn(path: str | PathLike[str]) -> NamedNetwork:
    """Return the network of a MoorDyn input file; ``notes`` lists what it says and has no meaning here.

    Raises InputError naming file and line of what is missing, wrong or not supported.

    >>> import pathlib, tempfile
    >>> from solvers.io import load_moordyn, load_network, write_moordyn
    >>> from importlib.resources import files
    >>> network = load_network(files("reference_data") / "scenes" / "networks" / "oc3_moving.toml")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     notes = write_moordyn(pathlib.Path(folder) / "lines.txt", network)
    ...     same = load_moordyn(pathlib.Path(folder) / "lines.txt")
    >>> [element.cable.Cdn for element in same.elements]
    [1.6, 1.6, 1.6]
    """
    sections = read_sections(path)
    notes: list[str] = []
    types = _line_types(sections["LINE TYPES"], notes)
    options = _options(sections.get("OPTIONS", []), notes)
    nodes = [_node(row, i) for i, row in enumerate(sections["POINTS"], start=1)]
    used = _used_types(sections["LINES"], types)
    try:
        environment = _environment(options, nodes, [row.number("Diam") for row in used], notes)
    except InputError as error:
        raise error.located(str(path)) from None
    rows = [(row, types[row.words["Type"]]) for row in sections["LINES"]]
    elements = [_element(row, of, i, len(nodes), environment, options) for i, (row, of) in enumerate(rows, start=1)]
    notes += _line_notes(rows, elements, nodes, options)
    if sections.get("OUTPUTS"):
        notes.append(f"{len(sections['OUTPUTS'])} lines of OUTPUTS: results are arrays here, and none is written")
    names = tuple(row.words["ID"] for row in sections["POINTS"])
    try:
        return NamedNetwork(nodes, elements, environment, name=Path(path).stem, node_names=names, notes=tuple(notes))
    except InputError as error:
        if error.item is None:
            raise error.located(str(path)) from None
        kind, i = error.item
        location = sections["POINTS" if kind == "node" else "LINES"][i].where
        raise error.labelled(f"{'point' if kind == 'node' else 'line'} {i + 1}").located(location) from None


def _options(rows: list[Row], notes: list[str]) -> dict[str, float]:
    """Return the options that have a meaning here, by their name here, with MoorDyn's defaults for the others."""
    given: dict[str, float] = {}
    for row in rows:
        keyword, word = row.words.get("Option"), row.words["Value"]
        if keyword is None:
            notes.append(f"option {word}: no keyword, which MoorDyn ignores too")
            continue
        key, refuse = (
            keyword.lower(),
            lambda problem, row=row: row.refuse("Value", f"of {row.words['Option']} {problem}"),
        )
        if key in FORBIDDEN:
            if word not in ("0", '"0"', '""'):
                refuse(f"is not 0: {FORBIDDEN[key]}")
        elif key in NUMERICS.split():
            notes.append(f"option {keyword} = {word}: of MoorDyn's own numerics")
        elif key not in OPTIONS:
            row.refuse("Option", f"is not known; {nearest(key, {*OPTIONS, *NUMERICS.split(), *FORBIDDEN})}")
        elif given.setdefault(OPTIONS[key], row.number("Value")) != row.number("Value"):
            row.refuse("Value", f"of {keyword} is there already, {given[OPTIONS[key]]:g}")
    return DEFAULTS | given


def _environment(options, nodes, diameters, notes) -> Environment:
    """Return the environment; its seabed is that under the thickest line, and no point lies below it."""
    lowest, thickest = -min(node.r[2] for node in nodes), max(diameters)
    if lowest > options["depth"]:  # as MoorDyn does
        notes.append(
            f"WtrDpth = {options['depth']:g} m is less than the depth of the lowest point, {lowest:g} m, taken"
        )
    if min(diameters) < thickest:
        pressed = f"kBot = {options['kBot']:g} Pa/m and cBot = {options['cBot']:g} Pa s/m times {thickest:g} m"
        notes.append(f"the seabed has one stiffness per length here: {pressed}, the diameter of the thickest line")
    return Environment(
        options["rho"],
        options["g"],
        max(lowest, options["depth"]),
        seabed_stiffness=options["kBot"] * thickest,
        seabed_damping=options["cBot"] * thickest,
    )


def _line_types(rows: list[Row], notes: list[str]) -> dict[str, Row]:
    types: dict[str, Row] = {}
    for row in rows:
        name = row.words["Name"]
        if name in types:
            row.refuse("Name", "is there already")
        for column, unit in (("EA", "N"), ("BA", "N s")):
            if "|" in row.words[column]:
                row.refuse(column, "is a viscoelastic line, which is not supported")
            try:
                float(row.words[column])
            except ValueError:
                row.refuse(column, f"must be a number ({unit}); curves in files are not supported")
        for column, what in (("EI", "bending stiffness"), ("Cl", "vortex-induced lift")):
            if column in row.words and row.number(column):
                row.refuse(column, f"is not 0: {what} is not supported")
        if axial := row.number("CaAx"):
            notes.append(f"line type {name}: CaAx = {axial:g}: lines have no added mass along themselves here")
        types[name] = row
    return types


def _used_types(lines: list[Row], types: dict[str, Row]) -> list[Row]:
    for row in lines:
        if row.words["Type"] not in types:
            row.refuse("Type", f"is no line type; {nearest(row.words['Type'], types)}")
    return [types[name] for name in dict.fromkeys(row.words["Type"] for row in lines)]


def _node(row: Row, i: int) -> Node:
    _check_number(row, i)
    kind = KINDS.get(row.words["Type"].lower().rstrip("0123456789"))
    if kind is None or row.words["Type"][-1].isdecimal():
        is_body = row.words["Type"].lower().startswith("body")
        row.refuse("Type", "is a body, which is not supported" if is_body else f"must be one of {', '.join(KINDS)}")
    x, y, z, mass, volume, CdA, Ca = (row.number(name) for name in ("X", "Y", "Z", "M", "V", "CdA", "Ca"))
    force = tuple(row.number(name) for name in ("FX", "FY", "FZ")) if "FX" in row.words else (0.0, 0.0, 0.0)
    return row.build(Node, kind, (x, y, z), mass, volume, force, CdA=CdA, Ca=Ca)


def _check_number(row: Row, i: int):
    if row.words["ID"] != str(i):
        row.refuse("ID", f"must be {i}: numbered 1, 2, ... in order")


def _element(row: Row, of: Row, i: int, points: int, environment: Environment, options) -> Element:
    _check_number(row, i)
    for name in ("AttachA", "AttachB"):
        if row.words[name][:1] in "Rr":
            row.refuse(name, "is the end of a rod, which is not supported")
        if row.words[name] not in map(str, range(1, points + 1)):
            row.refuse(name, f"must be a point from 1 to {points}")
    if row.words["AttachA"] == row.words["AttachB"]:
        row.refuse("AttachB", "is both ends of the line")
    ends = int(row.words["AttachA"]) - 1, int(row.words["AttachB"]) - 1
    length, segments = row.number("Length"), row.whole("NumSegs")
    diameter, mass, EA, BA = (of.number(name) for name in ("Diam", "MassDen", "EA", "BA"))
    of.build(CableProperties, EA, diameter, mass)  # signs, before the damping is computed from them
    damping = BA / EA if BA >= 0 else -BA * length / segments * math.sqrt(mass / EA)
    coefficients = {"Cdn": "Cd", "Cdt": "CdAx", "Ca": "Ca" if "Ca" in of.words else "CaN"}
    values = {name: of.number(column) for name, column in coefficients.items()}
    row.build(Element, 0.0, EA, length, ends)
    cable = of.build(CableProperties, EA, diameter, mass, damping=damping, **values)
    return row.build(Element, cable.weight_in(environment), EA, length, ends, options["friction"], cable)


def _line_notes(rows, elements, nodes, options):
    """Yield what of the lines has another meaning here, as text."""
    segments = ", ".join(row.words["NumSegs"] for row, _ in rows)
    yield f"NumSegs {segments}: the mesh is chosen where a line is moved"
    damped: dict[str, list[str]] = {}
    for i, ((_, of), element) in enumerate(zip(rows, elements, strict=True), start=1):
        if of.number("BA") < 0:
            share = f"{-of.number('BA'):g} of the critical damping of a segment"
            damping = f"{share} is a damping of {element.cable.damping:.6g} s, whatever the mesh"
            damped.setdefault(damping, []).append(str(i))
    for damping, lines in damped.items():
        yield f"line{'s' if len(lines) > 1 else ''} {', '.join(lines)}: {damping}"
    for i, node in enumerate(nodes, start=1):
        if node.r[2] > 0 and options["rho"] > 0:
            yield f"point {i} is above z = 0, where MoorDyn has air; all lines are in water here"
    if options["friction"]:
        yield "FrictionCoefficient: Coulomb friction of each element at rest; MoorDyn's is a damping that saturates"
