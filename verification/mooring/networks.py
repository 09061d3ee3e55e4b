"""Networks of verification/exact and verification/cases as systems of the solver; their results in the same order."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from solvers import CableProperties, Element, Environment, Network, Node, mooring_system
from solvers.common.motions.body_motion import BodyMotion
from solvers.mooring.lines.model import build_model
from solvers.mooring.system import MooringSystem

from ..exact.mooring import moving_network
from ..exact.rigid_motion import RigidMotion

SEABED_STIFFNESS = 1e6  # N/m^2: a metre of the heaviest line of the cases sinks in by 2 mm


def body_motion(motion: RigidMotion) -> BodyMotion | None:
    """Return the BodyMotion of a RigidMotion without a mean; None of a body at rest."""
    amplitude, phase = np.array(motion.amplitude), np.array(motion.phase)
    if not amplitude.any():
        return None
    sine, cosine = [-amplitude * np.sin(phase)], [amplitude * np.cos(phase)]
    return BodyMotion.periodic(motion.omega / (2 * math.pi), sine, cosine, motion.reference)


def as_network(exact: moving_network.Network) -> Network:
    """Return the solvers.Network of one of verification/exact: sections of no Ca where there is no water."""
    nodes, lines, bed = exact.nodes, exact.lines, exact.seabed or moving_network.Seabed(0.0, 0.0)
    given = [
        Node(kind, tuple(nodes.position[i].tolist()), nodes.mass[i], nodes.volume[i], tuple(nodes.force[i].tolist()),
             CdA=nodes.CdA[i], Ca=nodes.Ca[i])
        for i, kind in enumerate(nodes.kind)
    ]  # fmt: skip
    elements = []
    for i, ends in enumerate(lines.ends.tolist()):
        d = lines.d[i] or 0.1
        displaced = exact.rho * math.pi * d**2 / 4
        Cdn, Cdt = (float(value[i]) if lines.d[i] else 0.0 for value in (lines.Cdn, lines.Cdt))
        Ca = float(lines.added_mass[i]) / displaced if displaced else 0.0
        cable = CableProperties(float(lines.EA[i]), float(d), float(lines.mass[i]), float(lines.weight[i]), Cdn=Cdn,
                                Cdt=Cdt, Ca=Ca, damping=float(lines.beta[i]))  # fmt: skip
        elements.append(
            Element(cable.submerged_weight, cable.EA, float(lines.length[i]), ends, bed.friction, cable=cable)
        )
    water = {"current": tuple(map(float, exact.current)), "g": exact.g}
    if exact.seabed is not None:
        water |= {"depth": bed.depth, "seabed_stiffness": bed.stiffness, "seabed_damping": bed.damping}
    return Network(given, elements, Environment(exact.rho, **water))


@dataclass(frozen=True)
class ExactSystem:
    """A network of verification/exact on its own mesh, and as a system.

    nodes (size,) and cells: those of the system, in the order of the exact mesh.
    """

    exact: moving_network.Network
    system: MooringSystem
    nodes: np.ndarray
    cells: slice

    def coordinates(self, positions) -> np.ndarray:
        """Return coordinates y (3, N), m, of the system of positions (size, 3)."""
        y = self.system.rest_state().copy()
        y[:, self.nodes] = np.transpose(positions) - self.system.origin[:, None]
        return y

    def rates(self, velocities) -> np.ndarray:
        """Return velocities (3, N), m/s, of those of the exact nodes, (size, 3)."""
        ydot = np.zeros((3, self.system.nodes))
        ydot[:, self.nodes] = np.transpose(velocities)
        return ydot

    def in_exact_order(self, vectors) -> np.ndarray:
        """Return vectors (3, N, *S) of the nodes of the system as (*S, size, 3)."""
        return np.moveaxis(vectors[:, self.nodes], (0, 1), (-1, -2))

    def tensions(self, result) -> np.ndarray:
        """Return the tensions (*S, c) of the exact cells of a state, history or response, N."""
        return np.moveaxis(result.tension[self.cells], 0, -1)


def exact_system(exact: moving_network.Network, loads=None, **options) -> ExactSystem:
    """Return a network of verification/exact as an ExactSystem; loads: t (S,) -> (S, size, 3) on its nodes, N.

    One that is a line has another one beside it, for the equations of networks to be taken.
    """
    slip = exact.seabed.friction_speed if exact.seabed else 0.1
    settings = {
        "mesh": "uniform",
        "motion": body_motion(exact.motion),
        "slip_speed": slip,
        "calibrate": False,
    } | options
    cells, network, mesh = exact.lines.cells.tolist(), as_network(exact), moving_network.Mesh(exact)
    if build_model(network).is_line:
        cells, network = [*cells, 2], with_line_far_away(network)
    system = mooring_system(network, cells, fields="spatial", **settings)
    nodes = np.empty(mesh.size, int)
    for chain, numbers in zip(mesh.chains, system.layout.nodes, strict=False):
        nodes[chain] = numbers
    if loads is not None:

        def source(t):
            load = np.zeros((np.size(t), system.nodes, 3))
            load[:, nodes] = loads(np.atleast_1d(t))
            return load

        system.source = source
    return ExactSystem(exact, system, nodes, slice(0, mesh.l.size))


def case_network(case, **environment) -> Network:
    """Return the solvers.Network of a NetworkCase, its lines chains and ropes by their weight, on a stiff seabed."""
    nodes = [Node(n.kind, n.r, n.mass, n.volume, n.force) for n in case.nodes]
    elements = [Element(e.w, e.EA, e.L, e.ends, cable=section(e.w, e.EA)) for e in case.elements]
    depth = case.environment.depth
    bed = {} if depth is None else {"depth": depth, "seabed_stiffness": SEABED_STIFFNESS}
    return Network(nodes, elements, Environment(case.environment.rho, case.environment.g, **bed | environment))


def section(w, EA) -> CableProperties:
    """Return a section of weight w, N/m, and EA, N: as wide as steel of the same weight would be, and with its mass."""
    per_metre = max(abs(w), 10.0) / 9.80665 / (1 - 1025.0 / 7850.0)
    d = 2 * math.sqrt(per_metre / 7850.0 / math.pi)
    return CableProperties(EA, d, per_metre, submerged_weight=w, Cdn=1.2, Cdt=0.05, Ca=1.0)


def with_line_far_away(network: Network, far: float = 5e3) -> Network:
    """Return the network with a taut line between fixed points beside it, so that it is no line even if it was one."""
    base = len(network.nodes)
    cable = CableProperties(1e6, 0.1, 20.0, submerged_weight=50.0, Cdn=1.2, Ca=1.0)
    nodes = [Node("fixed", (0.0, far, -1.0)), Node("fixed", (40.0, far, -1.0))]
    element = Element(50.0, 1e6, 39.9, (base, base + 1), cable=cable)
    return replace(network, nodes=[*network.nodes, *nodes], elements=[*network.elements, element])
