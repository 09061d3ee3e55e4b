"""Write a network as a MoorDyn 2 input file, the inverse of ``load_moordyn``; see reader.py for conversions."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any

from ...common.outcome import InputError
from ...common.validation import instance_of, non_negative_number, whole_number
from ...network.model import Network

ATTACHMENTS = {"fixed": "Fixed", "coupled": "Coupled", "free": "Free"}
STEP = 0.5  # of the time that an axial wave takes through a segment; RK2 is stable below twice that
SAME_WEIGHT = 1e-9  # relative: a weight computed elsewhere from the same diameter and mass
ROUNDED_WEIGHT = 1e-4  # relative: a weight that is given with four digits or more
_FILE = """--------------------- MoorDyn Input File ---------------------
{title}
--------------------- LINE TYPES ---------------------
Name Diam MassDen EA BA/-zeta EI Cd Ca CdAx CaAx
(-) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
{types}
--------------------- POINTS ---------------------
ID Attachment X Y Z M V {forces}CdA CA
(#) (-) (m) (m) (m) (kg) (m^3) {units}(m^2) (-)
{points}
--------------------- LINES ---------------------
ID LineType AttachA AttachB UnstrLen NumSegs LineOutputs
(#) (name) (#) (#) (m) (-) (-)
{lines}
--------------------- OPTIONS ---------------------
{options}
--------------------- need this line ---------------------
"""


def write_moordyn(
    path: str | PathLike[str],
    network: Network,
    cells: int | Sequence[int] = 20,
    *,
    damping_ratio: float | None = None,
    options: Mapping[str, float | str] | None = None,
) -> tuple[str, ...]:
    """Write a network as a MoorDyn 2 input file; return what MoorDyn lacks or takes another way, one sentence each.

    cells : NumSegs of every line, or of each
    damping_ratio : share of the critical damping of a segment for lines without damping, which MoorDyn's explicit
    steps need and which vanishes with refinement; None: damping of each line alone
    options : further options by keyword, or other values for those written, as "dtM" (s)
    Raises InputError for what MoorDyn cannot state, naming the element or node.

    >>> import pathlib, tempfile
    >>> from importlib.resources import files
    >>> from solvers.io import load_network, write_moordyn
    >>> network = load_network(files("reference_data") / "scenes" / "networks" / "oc3_moving.toml")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = pathlib.Path(folder) / "lines.txt"
    ...     notes = write_moordyn(file, network, cells=40)
    ...     print(next(line for line in file.read_text().splitlines() if line.startswith("3 type")))
    3 type1 5 6 902.2 40 -
    """
    instance_of("network", network, Network)
    counts = _counts(cells, len(network.elements))
    if damping_ratio is not None:
        damping_ratio = non_negative_number("damping_ratio", damping_ratio, "(dimensionless)")
    notes: list[str] = []
    _check(network, notes)
    sections = list(dict.fromkeys(element.cable for element in network.elements))
    lines = [
        f"{i} type{sections.index(e.cable) + 1} {e.ends[0] + 1} {e.ends[1] + 1} {e.L!r} {n} -"
        for i, (e, n) in enumerate(zip(network.elements, counts, strict=True), start=1)
    ]
    with_forces = any(any(node.force) for node in network.nodes)
    values = _options(network, counts, notes) | dict(options or {})
    title = " ".join(f"{getattr(network, 'name', '') or 'network'}".replace("---", "").split())
    text = _FILE.format(
        title=title or "network",
        types="\n".join(_line_type(i, cable, damping_ratio) for i, cable in enumerate(sections, start=1)),
        forces="FX FY FZ " if with_forces else "",
        units="(N) (N) (N) " if with_forces else "",
        points="\n".join(_point(i, node, with_forces) for i, node in enumerate(network.nodes, start=1)),
        lines="\n".join(lines),
        options="\n".join(f"{value if isinstance(value, str) else repr(value)} {key}" for key, value in values.items()),
    )
    try:
        Path(path).write_text(text, encoding="ascii", errors="replace")
    except (TypeError, ValueError):
        raise InputError(f"{path!r} is not a path", field="path", value=path) from None
    except OSError as error:
        raise InputError(f"cannot be written: {error.strerror}", field="path", value=path, label=str(path)) from None
    return tuple(notes)


def _counts(cells, elements: int) -> list[int]:
    """Return the number of segments of each line."""
    if not isinstance(cells, Sequence) or isinstance(cells, str):
        return [whole_number("cells", cells, 1)] * elements
    if len(cells) != elements:
        raise InputError(f"{len(cells)} numbers where there are {elements} elements", field="cells", value=cells)
    return [whole_number(f"cells[{i}]", n, 1) for i, n in enumerate(cells)]


def _check(network: Network, notes: list[str]):
    """Raise InputError for what MoorDyn cannot state, and note what it takes another way."""
    environment = network.environment
    if any(environment.current):
        problem = f"{environment.current} m/s: MoorDyn takes a current from files of its own"
        raise InputError(problem, field="current", value=environment.current, unit="m/s")
    if environment.depth is not None and environment.seabed_stiffness is None:
        problem = "not given (N/m^2), and MoorDyn's seabed is elastic"
        raise InputError(problem, field="seabed_stiffness", unit="N/m^2")
    for i, element in enumerate(network.elements):
        _check_element(element, environment, i, notes)
    frictions = sorted({element.friction for element in network.elements})
    if len(frictions) > 1:
        problem = f"{', '.join(map(str, frictions))}: MoorDyn has one FrictionCoefficient for all lines"
        raise InputError(problem, field="friction", value=frictions)
    if frictions[0]:
        notes.append("friction: MoorDyn's is a damping that saturates, and rests without force")
    for i, node in enumerate(network.nodes, start=1):
        if node.r[2] > 0 and environment.rho > 0:
            notes.append(f"point {i} is above z = 0, where MoorDyn has air; all lines are in water here")
    if getattr(network, "motion", None) is not None:
        notes.append("motion: MoorDyn is given positions of the coupled points step by step")


def _check_element(element, environment, i: int, notes: list[str]):
    def refuse(name, problem):
        raise InputError(problem, field=name, item=("element", i), label=f"element {i}: {name}")

    cable = element.cable
    if cable is None or cable.diameter is None or cable.mass_per_length is None:
        refuse("cable", "MoorDyn takes its diameter (m) and mass_per_length (kg/m), which are not given")
    if cable.Cdb != cable.Cdn:
        refuse("Cdb", f"{cable.Cdb:g} is not Cdn, {cable.Cdn:g}; MoorDyn has one transverse drag coefficient")
    buoyancy = environment.rho * environment.g * cable.area
    weight = environment.g * cable.mass_per_length - buoyancy
    difference = abs(element.w - weight) / max(abs(element.w), buoyancy)
    text = f"{element.w:.7g} N/m is not what diameter and mass give, {weight:.7g} N/m, which MoorDyn takes"
    if difference > ROUNDED_WEIGHT:
        refuse("w", text)
    elif difference > SAME_WEIGHT:
        notes.append(f"element {i}: its weight, {text}")


def _line_type(i: int, cable, damping_ratio) -> str:
    damping = cable.damping * cable.EA
    if not damping and damping_ratio:
        damping = -damping_ratio
    numbers = (cable.diameter, cable.mass_per_length, cable.EA, damping, 0, cable.Cdn, cable.Ca, cable.Cdt, 0)
    return f"type{i} {' '.join(map(repr, numbers))}"


def _point(i: int, node, with_forces: bool) -> str:
    numbers = (*node.r, node.mass, node.volume, *(node.force if with_forces else ()), node.CdA, node.Ca)
    return f"{i} {ATTACHMENTS[node.kind]} {' '.join(map(repr, numbers))}"


def _options(network: Network, counts: list[int], notes: list[str]) -> dict[str, float | str]:
    """Return options by keyword: the environment, and a time step that explicit steps are stable with."""
    environment = network.environment
    elements: Sequence[Any] = network.elements  # each with its section: checked
    crossing = min(e.L / n * math.sqrt(e.cable.mass_per_length / e.EA) for e, n in zip(elements, counts, strict=True))
    thickest = max(element.cable.diameter for element in elements)
    if min(element.cable.diameter for element in elements) < thickest and environment.depth is not None:
        text = f"over the diameter of the thickest line, {thickest:g} m; under others MoorDyn's is softer"
        notes.append(f"the seabed acts per area in MoorDyn: kBot and cBot are stiffness and damping {text}")
    depth, stiffness, damping = environment.depth, environment.seabed_stiffness, environment.seabed_damping
    if depth is None:
        depth = sum(e.L for e in elements) - min(node.r[2] for node in network.nodes)
        notes.append(f"no seabed: WtrDpth is {depth:g} m, which no line at rest reaches")
        stiffness = 0.0
    values: dict[str, float | str] = {"dtM": STEP * crossing, "g": environment.g, "rho": environment.rho}
    values |= {"WtrDpth": depth, "kBot": stiffness / thickest, "cBot": damping / thickest}
    return values | ({"FrictionCoefficient": elements[0].friction} if elements[0].friction else {})
