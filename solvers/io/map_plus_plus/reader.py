"""Read a MAP++ input file (.map; ..._MAP.dat of OpenFAST) as a Network.

Four sections, each a title between dashes, a line of column names, a line of units, then its rows, words parted by
blanks or tabs:

LINE DICTIONARY   LineType Diam MassDenInAir EA CB CIntDamp Ca Cdn Cdt    m, kg/m, N; CB: friction of the seabed; for
                  motion CIntDamp (Pa s), damping = CIntDamp (pi d^2/4)/EA in s, Cdn on d l, Cdt on pi d l
NODE PROPERTIES   Node Type X Y Z M B FX FY FZ      Type fix, connect or vessel; M kg, B m^3 (or named V), forces N
LINE PROPERTIES   Line LineType UnstrLen NodeAnch NodeFair Flags...
SOLVER OPTIONS    Option: a word and its numbers; a line that starts with a blank is a comment

"#" marks an unknown: "#90" with the guess 90, "#" without one (0 here). Z may be "depth": on the seabed. Nodes and
lines are numbered 1, 2, ... in order. "repeat a b ..." copies all of them, turned by each angle in degrees, clockwise
from above. Sources: MAP++ manual, input_file.rst; its reader, modules/map/src/mapinit.c of OpenFAST.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path

from ...common.outcome import InputError
from ...common.properties import CableProperties, Environment
from ...common.types import Vector
from ...network.model import Element, Node
from ..network_scene import NamedNetwork

SECTIONS = {
    "LINE DICTIONARY": "LineType Diam MassDenInAir EA CB CIntDamp Ca Cdn Cdt",
    "NODE PROPERTIES": "Node Type X Y Z M B FX FY FZ",
    "LINE PROPERTIES": "Line LineType UnstrLen NodeAnch NodeFair Flags",
    "SOLVER OPTIONS": "Option",
}
ALIASES = {"Node": "id", "Line": "id", "Type": "attachment", "B": "v"}
OPEN = {"LINE PROPERTIES": 5, "SOLVER OPTIONS": 1}  # columns after which any number of words may follow
KINDS = {"fix": "fixed", "connect": "free", "vessel": "coupled"}
OUTPUTS = """gx_pos gy_pos gz_pos gx_a_pos gy_a_pos gz_a_pos gx_force gy_force gz_force h_fair h_anch v_fair v_anch
tension_fair tension_anch x_excursion z_excursion azimuth altitude altitude_anch line_tension lay_length"""
UNITS = {"Diam": "m", "MassDenInAir": "kg/m", "EA": "N", "X": "m", "Y": "m", "Z": "m", "M": "kg", "B": "m^3",
         "FX": "N", "FY": "N", "FZ": "N", "UnstrLen": "m"}  # fmt: skip
NUMBERED = ("seg_size", "damage_time", "diagnostic")  # flags of the time domain, each with a number
IGNORED = """help inner_ftol inner_gtol inner_xtol inner_max_its outer_max_its outer_tol outer_epsilon outer_cd outer_bd
outer_fd powell pg_cooked krylov_accelerator ref_position integration_dt kb_default cb_default"""
REFUSED = {
    "omit_contact": "one line without seabed among others with it is not supported; without depth none has contact",
    "linear_spring": "a spring in place of a catenary is not supported",
    "lm_model": "lumped masses are another model of the lines",
    "wave_kinematics": "wave loads are not supported",
}


@dataclass(frozen=True)
class MapNetwork(NamedNetwork):
    """The network of a MAP++ file; node_names are its numbers, those of repeated nodes following."""

    @property
    def ignored(self) -> tuple[str, ...]:
        """Its flags, options and values that have no meaning here, as text: ``notes``."""
        return self.notes


def read_map_file(
    path: str | PathLike[str],
    *,
    depth: float | None = None,
    rho: float = Environment.rho,
    g: float = Environment.g,
    current: Vector = (0.0, 0.0, 0.0),
    seabed_stiffness: float | None = None,
    seabed_damping: float = 0.0,
) -> MapNetwork:
    """Return the network of a MAP++ file, in water ``depth`` m deep (None: no seabed), rho kg/m^3, g m/s^2.

    current, seabed_stiffness and seabed_damping as solvers.Environment takes them, for motion.
    Raises InputError naming file and line for what is missing, wrong or not supported.

    >>> from importlib.resources import files
    >>> from solvers.io import read_map_file
    >>> len(read_map_file(files("reference_data") / "scenes" / "oc3_hywind.map", depth=320.0).elements)
    3
    """
    seabed = {"seabed_stiffness": seabed_stiffness, "seabed_damping": seabed_damping}
    environment = Environment(rho, g, depth, current=current, **seabed)  # type: ignore[arg-type]
    types: dict[str, dict] = {}
    angles: list[float] = []
    ignored: list[str] = []
    try:
        text = Path(path).read_text(encoding="latin-1")  # all but the unit m^3 is ASCII, and that comes in any encoding
    except (TypeError, ValueError):
        raise InputError(f"{path!r} is not the path of a MAP++ file", field="path", value=path) from None
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", field="path", value=path, label=str(path)) from None
    rows = _sections(path, text.split("\n"))
    for row in rows["LINE DICTIONARY"]:
        row.require(row["LineType"] not in types, f"LineType {row['LineType']!r} is there already")
        types[row["LineType"]] = _line_type(row, environment, ignored)
    nodes = [_node(row, i, environment) for i, row in enumerate(rows["NODE PROPERTIES"], start=1)]
    elements = [_element(row, i, types, len(nodes)) for i, row in enumerate(rows["LINE PROPERTIES"], start=1)]
    ignored += [text for row in rows["LINE PROPERTIES"] for text in _flags(row, environment)]
    for row in rows["SOLVER OPTIONS"]:
        _option(row, angles, ignored)
    shifts = range(0, len(nodes) * (len(angles) + 1), len(nodes))
    copies = [replace(e, ends=(e.ends[0] + shift, e.ends[1] + shift)) for shift in shifts for e in elements]
    nodes += [_turned(node, angle) for angle in angles for node in nodes]
    try:
        names = tuple(str(i) for i in range(1, len(nodes) + 1))
        return MapNetwork(nodes, copies, environment, name=Path(path).stem, node_names=names, notes=tuple(ignored))
    except InputError as error:
        if error.item is None:
            raise error.located(str(path)) from None
        kind, i = error.item
        own = rows["NODE PROPERTIES" if kind == "node" else "LINE PROPERTIES"]
        number = f"node {i + 1} ({nodes[i].kind})" if kind == "node" else f"element {i + 1}"
        raise error.labelled(number).located(own[i % len(own)].where) from None


class _Row(dict):
    """One row of a section: its words by column name; ``more`` words after the last column."""

    def __init__(self, where, section, words):
        names = SECTIONS[section].split()
        count = OPEN.get(section, len(names))
        super().__init__(zip(names, words[:count], strict=False))
        self.where, self.more = where, words[count:]
        fits = len(words) == count or (len(words) > count and section in OPEN)
        self.require(fits, f"{len(words)} columns where {section} has {count}: {' '.join(names[:count])}")

    def require(self, condition, problem, field=None, word=None):
        """Raise InputError with the line number, the field (a column) and its word unless the condition holds."""
        if not condition:
            value = self.get(field) if word is None else word
            error = InputError(problem, field=field, value=value, unit=UNITS.get(field))
            raise error.located(self.where) from None

    def number(self, name, word=None, unknown=False) -> float:
        """Return the word in this column as a finite number; ``unknown``: it may be marked with #."""
        word = self[name] if word is None else word
        is_known = unknown or not word.startswith("#")
        self.require(is_known, f"{word!r} is marked as unknown, but must be given", name, word)
        digits = word.removeprefix("#") or "0"
        plain = re.fullmatch(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", digits, re.ASCII)
        self.require(word and plain and math.isfinite(float(digits)), f"{word!r} must be a number", name, word)
        return float(digits)

    def checked(self, make, *arguments, **named):
        """Return make(...); its InputError gets the line number."""
        try:
            return make(*arguments, **named)
        except InputError as error:
            raise error.located(self.where) from None


def _sections(path, lines) -> dict[str, list[_Row]]:
    rows: dict[str, list[_Row]] = {}
    section, header = None, 0
    for number, line in enumerate(lines, start=1):
        where, words = f"{path}:{number}", line.split()
        if line.lstrip().startswith("--"):
            section, header = next((name for name in SECTIONS if name in line.upper()), None), 0
            if section is None or section in rows:
                raise InputError(f"{where}: {line.strip('- ')!r}: unknown title, or there already")
            rows[section] = []
        elif not words or (section == "SOLVER OPTIONS" and header == 2 and line[0].isspace()):
            continue
        elif section is None:
            raise InputError(f"{where}: {line[:40]!r} stands before the first section, LINE DICTIONARY")
        elif header < 2:
            _check_header(where, section, words, header)
            header += 1
        else:
            rows[section].append(_Row(where, section, words))
    for name in SECTIONS:
        if name not in rows or not (rows[name] or name == "SOLVER OPTIONS"):
            raise InputError(f"{path}:{len(lines)}: section {name} is {'empty' if name in rows else 'missing'}")
    return rows


def _check_header(where, section, words, header):
    """Raise InputError unless the columns are those of MAP++ (MoorDyn's look alike and mean others), then units."""
    names = SECTIONS[section].split()
    same = [word.lower() in (name.lower(), ALIASES.get(name)) for word, name in zip(words, names, strict=False)]
    if header == 0 and (len(words) != len(names) or not all(same)):
        raise InputError(f"{where}: columns {' '.join(words)} of {section} must be {' '.join(names)}")
    if header == 1 and not words[0].startswith("("):
        raise InputError(f"{where}: {words[0]!r}: a line of units, (-) (m) ..., must stand above the rows of {section}")


def _line_type(row, environment, ignored) -> dict:
    """Return what its elements take; those with a negative coefficient, as files for statics have, have no section."""
    diameter, mass, EA, friction, pressure, Ca, Cdn, Cdt = [row.number(name) for name in row if name != "LineType"]
    cable = row.checked(CableProperties, EA, diameter, mass)
    values = {"w": cable.weight_in(environment), "EA": EA, "friction": friction}
    coefficients = {"CIntDamp": pressure, "Ca": Ca, "Cdn": Cdn, "Cdt": Cdt}
    negative = [f"{name} = {value:g}" for name, value in coefficients.items() if value < 0]
    if negative:
        ignored.append(f"line type {row['LineType']}: {', '.join(negative)}: no coefficient; it cannot be moved")
        return values
    return values | {"cable": replace(cable, damping=pressure * cable.area / EA, Ca=Ca, Cdn=Cdn, Cdb=Cdn, Cdt=Cdt)}


def _node(row, i, environment) -> Node:
    row.require(row["Node"] == str(i), f"{row['Node']!r} must be {i}: numbered 1, 2, ... in order", "Node")
    kind = KINDS.get(row["Type"].lower())
    free, on_seabed = kind == "free", row["Z"].lower() == "depth"
    row.require(kind, f"{row['Type']!r} must be one of {', '.join(KINDS)}", "Type")
    row.require(
        not on_seabed or environment.depth,
        "'depth' needs the depth of the water in m: --depth, or depth= of read_map_file",
        "Z",
    )
    z = -environment.depth if on_seabed else row.number("Z", unknown=free)
    r = row.number("X", unknown=free), row.number("Y", unknown=free), z
    # the force that holds a fix or vessel node is an output: # or a guess of it, no load
    loads = [0.0 if row[f].startswith("#") and not free else row.number(f) for f in ("FX", "FY", "FZ")]
    return row.checked(Node, kind, r, row.number("M"), row.number("B"), tuple(loads))


def _element(row, i, types, n) -> Element:
    row.require(row["Line"] == str(i), f"{row['Line']!r} must be {i}: numbered 1, 2, ... in order", "Line")
    row.require(row["LineType"] in types, f"{row['LineType']!r} is none of {', '.join(types)}", "LineType")
    for name in ("NodeAnch", "NodeFair"):
        row.require(row[name] in map(str, range(1, n + 1)), f"{row[name]!r} must be a node from 1 to {n}", name)
    row.require(row["NodeAnch"] != row["NodeFair"], f"NodeAnch and NodeFair are both {row['NodeAnch']}")
    ends = int(row["NodeAnch"]) - 1, int(row["NodeFair"]) - 1
    return row.checked(Element, L=row.number("UnstrLen"), ends=ends, **types[row["LineType"]])


def _flags(row, environment):
    """Yield the flags of a line as text, all without a meaning here; those that change the model are refused."""
    flags = iter(row.more)
    for flag in flags:
        key = flag.lower()
        known = key in (*OUTPUTS.split(), *NUMBERED) or (key == "omit_contact" and environment.depth is None)
        row.require(known, f"flag {flag!r}: {REFUSED.get(key, 'is not known')}")
        yield f"line {row['Line']}: {flag}" + (f" {row.number(flag, next(flags, '')):g}" if key in NUMBERED else "")


def _option(row, angles, ignored):
    key = row["Option"].lower()
    if key == "repeat":
        angles += [row.number(key, angle) for angle in row.more]
    else:
        row.require(key in IGNORED.split(), f"option {row['Option']!r}: {REFUSED.get(key, 'is not known')}")
        ignored.append(" ".join((row["Option"], *row.more)))


def _turned(node, degrees) -> Node:
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    (x, y, z), (fx, fy, fz) = node.r, node.force
    return replace(node, r=(c * x + s * y, c * y - s * x, z), force=(c * fx + s * fy, c * fy - s * fx, fz))
