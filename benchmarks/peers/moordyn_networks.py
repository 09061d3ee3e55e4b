"""Input files of MoorDyn 2 for the networks of conformance cases, from their plain attributes.

Networks of this project have a writer of their own, solvers.io.moordyn.writer; an outside code is judged without it.
"""

from __future__ import annotations

import math

STEP = 0.5  # of the time that an axial wave takes through a segment; twice that is beyond the limit of stability
SAME_WEIGHT = 1e-6  # relative to the buoyancy: MoorDyn takes the weight from mass and diameter
ATTACHMENTS = {"fixed": "Fixed", "coupled": "Coupled", "free": "Free"}
_FILE = """MoorDyn
--- LINE TYPES ---
Name Diam MassDen EA BA/-zeta EI Cd Ca CdAx CaAx
(-) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
{types}
--- POINTS ---
ID Attachment X Y Z M V FX FY FZ CdA CA
(#) (-) (m) (m) (m) (kg) (m^3) (N) (N) (N) (m^2) (-)
{points}
--- LINES ---
ID LineType AttachA AttachB UnstrLen NumSegs LineOutputs
(#) (name) (#) (#) (m) (-) (-)
{lines}
--- OPTIONS ---
{options}
--- need this line ---
"""


def describe_network(network, cells, damping_ratio: float, options: dict) -> str:
    """Return the input file of a network with sections; cells: segments of each element, one number or a list.

    damping_ratio: share of the critical damping of a segment for lines without damping. Raises NotImplementedError
    for what MoorDyn cannot state.
    """
    elements, environment = network.elements, network.environment
    counts = [cells] * len(elements) if isinstance(cells, int) else list(cells)
    _check(network)
    types = [_line_type(i, element.cable, damping_ratio) for i, element in enumerate(elements, start=1)]
    points = [_point(i, node) for i, node in enumerate(network.nodes, start=1)]
    lines = [
        f"{i} type{i} {e.ends[0] + 1} {e.ends[1] + 1} {e.L!r} {n} -"
        for i, (e, n) in enumerate(zip(elements, counts, strict=True), start=1)
    ]
    crossing = min(e.L / n * math.sqrt(e.cable.mass_per_length / e.EA) for e, n in zip(elements, counts, strict=True))
    values = {"dtM": STEP * crossing, "g": environment.g, "rho": environment.rho} | _seabed(network) | options
    return _FILE.format(
        types="\n".join(types), points="\n".join(points), lines="\n".join(lines),
        options="\n".join(f"{value} {key}" for key, value in values.items()),
    )  # fmt: skip


def stable_step(share: float, crossing: float, damping: float) -> float:
    """Return a step of RK2, s: a share of what the explicit scheme is stable with.

    crossing is the time of an axial wave through a segment, damping the Kelvin-Voigt time, s.

    A wave alone is stable below the crossing, damping alone below crossing^2 / (2 damping): the greatest eigenvalue is
    4 damping / crossing^2.
    """
    step = share * crossing
    return min(step, share * crossing**2 / (2 * damping)) if damping else step


def _check(network):
    """Raise NotImplementedError for what MoorDyn cannot state."""
    environment = network.environment
    if environment.depth is not None and environment.seabed_stiffness is None:
        raise NotImplementedError("its seabed is elastic, and no stiffness is given")
    for i, element in enumerate(network.elements):
        cable = element.cable
        if cable.Cdb != cable.Cdn:
            raise NotImplementedError("it has one transverse drag coefficient")
        buoyancy = environment.rho * environment.g * math.pi * cable.diameter**2 / 4
        weight = environment.g * cable.mass_per_length - buoyancy
        if abs(element.w - weight) > SAME_WEIGHT * max(abs(weight), buoyancy):
            raise NotImplementedError(f"element {i}: it takes the weight from mass and diameter, {weight:.7g} N/m")


def _line_type(i: int, cable, damping_ratio: float) -> str:
    damping = cable.damping * cable.EA or -damping_ratio
    numbers = (cable.diameter, cable.mass_per_length, cable.EA, damping, 0, cable.Cdn, cable.Ca, cable.Cdt, 0)
    return f"type{i} {' '.join(map(repr, numbers))}"


def _point(i: int, node) -> str:
    numbers = (*map(float, node.r), node.mass, node.volume, *node.force, node.CdA, node.Ca)
    return f"{i} {ATTACHMENTS[node.kind]} {' '.join(map(repr, numbers))}"


def _seabed(network) -> dict:
    """Return WtrDpth, kBot and cBot: per area that the diameter covers, of the thickest line."""
    environment = network.environment
    if environment.depth is None:
        depth = sum(element.L for element in network.elements) - min(node.r[2] for node in network.nodes)
        return {"WtrDpth": float(depth), "kBot": 0.0, "cBot": 0.0}
    thickest = max(element.cable.diameter for element in network.elements)
    stiffness, damping = environment.seabed_stiffness / thickest, environment.seabed_damping / thickest
    return {"WtrDpth": float(environment.depth), "kBot": stiffness, "cBot": damping}
