"""MoorDyn 2 on a cable or a network with moving fairleads, through its own Python bindings.

What to mind: the tension output of a line is that of its last segment, half a segment from the end (first order), so
the force on the point is taken; in a coupling step the fairlead moves with one velocity, so the mean one is given, and
a long coupling step still shifts the response. Its RK2 is unstable for a line without internal damping: DAMPING is a
share of the critical damping of a segment, so it vanishes with refinement. Above z = 0 it has air, and a scene is in
water wherever its origin is: the line is let down until it is, and its seabed with it.
"""

from __future__ import annotations

import copy
import math
import os
import tempfile
from contextlib import contextmanager
from dataclasses import replace
from functools import lru_cache
from importlib import metadata
from pathlib import Path

import moordyn
import numpy as np

from verification.conformance.adapter import Adapter, CableAnswer, MovingNetworkAnswer

from .moordyn_networks import SAME_WEIGHT, describe_network, stable_step

DAMPING = -0.1
STEP = 0.5  # of the time that an axial wave takes through a segment; twice that is beyond the limit of stability
FAR_DOWN = 1e5  # m: deeper than any line is let down
RELAXATION = {"ICgenDynamic": 1, "CdScaleIC": 10.0, "TmaxIC": 600.0, "threshIC": 1e-6, "dtIC": 2.0}
"""How it finds a network at rest: with more drag, until the tensions change by less than threshIC in a few dtIC, s."""
SETTLING = 300.0
"""s, in which a line comes to rest in a current before it is moved: MoorDyn hangs it as in still water."""
_INPUT = """MoorDyn
--- LINE TYPES ---
Name Diam MassDen EA BA/-zeta EI Cd Ca CdAx CaAx
(-) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
cable {d!r} {m!r} {EA!r} {damping} 0 {Cd!r} {Ca!r} {Cdt!r} 0
--- POINTS ---
ID Attachment X Y Z M V CdA CA
(#) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)
1 Fixed {anchor} 0 0 0 0
2 Coupled {fairlead} 0 0 0 0
--- LINES ---
ID LineType AttachA AttachB UnstrLen NumSegs LineOutputs
(#) (name) (#) (#) (m) (-) (-)
1 cable 1 2 {L!r} {segments} -
--- OPTIONS ---
0 writeLog
1 disableOutput
1 disableOutTime
RK2 tScheme
{step!r} dtM
{g!r} g
{rho!r} rho
{depth!r} WtrDpth
{currents} Currents
0 TmaxIC
{seabed}--- OUTPUT ---
--- need this line ---
"""


class MoorDyn(Adapter):
    """Its coupling step is the step between the times that are asked for."""

    label = "MoorDyn"
    version = metadata.version("moordyn")
    settings = ((8, 100), (12, 200), (17, 500), (24, 500), (34, 1000), (49, 1000), (98, 2000))
    # 196 segments take four times as long as 98 and, but for case 3 of the paper, no further
    stages = 2  # of its RK2

    def cable(self, scene, time, fairlead, cells):
        """The force on the fairlead at the start and at the end of each coupling step.

        Of conformance cases a CableAnswer: also at the anchor, and the extremes of the tension along the line.
        """
        environment, cable = scene.environment, scene.cable
        if environment.depth is not None and environment.seabed_stiffness is None:
            raise NotImplementedError("its seabed is elastic, and no stiffness is given")
        if environment.depth is not None and any(scene.friction):
            raise NotImplementedError("its friction is a dashpot per node up to the Coulomb force: another law")
        if environment.seabed_damping:
            raise NotImplementedError("its seabed damping also pulls a rising line down: another law")
        if cable.Cdb != cable.Cdn:
            raise NotImplementedError("it has one transverse drag coefficient")
        weight, buoyancy = getattr(cable, "submerged_weight", None), environment.rho * math.pi * cable.diameter**2 / 4
        by_section = environment.g * (cable.mass_per_length - buoyancy)
        size = max(abs(by_section), environment.g * buoyancy)
        if weight is not None and abs(weight - by_section) > SAME_WEIGHT * size:
            raise NotImplementedError(f"it takes the weight from mass and diameter, {by_section:.7g} N/m")
        step = time[1] - time[0]
        velocity = np.diff(fairlead, axis=0) / step
        down = float(max(scene.anchor[2], fairlead[:, 2].max()) + scene.length)  # with its seabed, if it has one
        fairlead = fairlead - [0.0, 0.0, down]
        record = Record(len(time), getattr(scene, "window", None), cells)
        with tempfile.TemporaryDirectory() as folder, _silence():
            file = Path(folder) / "lines.txt"
            file.write_text(describe(scene, cells, down), encoding="utf-8")
            if any(environment.current):
                (Path(folder) / "current_profile.txt").write_text(_uniform(environment.current), encoding="ascii")
            system = moordyn.Create(str(file))
            try:
                moordyn.Init(system, list(fairlead[0]), [0.0, 0.0, 0.0])
                if any(environment.current):
                    moordyn.Step(system, list(fairlead[0]), [0.0, 0.0, 0.0], time[0] - SETTLING, SETTLING)
                record.take(system, 0, time[0])
                for k in range(len(time) - 1):
                    moordyn.Step(system, list(fairlead[k]), list(velocity[k]), time[k], step)
                    record.take(system, k + 1, time[k + 1])
            finally:
                moordyn.Close(system)
        return record.answer(scene) if hasattr(scene, "window") else record.ends[1]

    def moving_network(self, network, motion, time, cells, damping_ratio=-DAMPING):
        """The forces on the coupled nodes at the start and at the end of each coupling step, (P, 3, K), N.

        Of conformance cases a MovingNetworkAnswer, from where MoorDyn itself finds the network at rest.
        damping_ratio: of the critical damping of a segment, what lines without internal damping get.
        """
        if any(network.environment.current):
            raise NotImplementedError("this adapter gives it no current")
        if any(element.friction for element in network.elements):
            raise NotImplementedError("this adapter describes a seabed without friction")
        coupled = [i for i, node in enumerate(network.nodes) if node.kind == "coupled"]
        mean = np.array([network.nodes[i].r for i in coupled])
        positions = mean + np.moveaxis(motion.displacement(mean, time), (0, 1, 2), (2, 1, 0))  # (K, P, 3)
        step = time[1] - time[0]
        velocity = np.diff(positions, axis=0) / step
        top = max(positions[..., 2].max(), *(node.r[2] for node in network.nodes))
        down = float(top + sum(element.L for element in network.elements))
        positions = positions - [0.0, 0.0, down]
        forces = np.empty((len(coupled), 3, len(time)))
        is_case = hasattr(network, "body")
        tension = np.empty((len(network.elements) if is_case else 0, 2, len(time)))
        lowered = let_down_as_given(network, down) if is_case else let_down(network, down)
        start = RELAXATION if is_case else {"TmaxIC": 0}
        with _system(lowered, cells, {"tScheme": "RK2"} | start, damping_ratio, positions[0]) as (system, every):
            points = [every[i] for i in coupled]
            lines = [moordyn.GetLine(system, i + 1) for i in range(len(network.elements))] if is_case else []
            tension[..., 0] = end_tensions(lines)
            forces[..., 0] = [moordyn.GetPointForce(point) for point in points]
            for k in range(len(time) - 1):
                x, v = positions[k].ravel(), velocity[k].ravel()
                moordyn.Step(system, list(x), list(v), time[k], step)
                forces[..., k + 1] = [moordyn.GetPointForce(point) for point in points]
                tension[..., k + 1] = end_tensions(lines)
        return MovingNetworkAnswer(forces, tension) if is_case else forces

    def count_cable_steps(self, scene, coupling_step: float, cells: int) -> int:
        """Return how many steps of RK2 it takes in a coupling step in s, by the dtM that it is given."""
        return _count_within(coupling_step, _stable_step(scene, cells))

    def count_network_steps(self, network, coupling_step: float, counts) -> int:
        """Return the same for a network without internal damping of its own, with so many segments in each element."""
        elements = zip(network.elements, counts, strict=True)
        crossing = min(e.L / n * math.sqrt(e.cable.mass_per_length / e.cable.EA) for e, n in elements)
        return _count_within(coupling_step, STEP * crossing)

    def forces_at_rest(self, network, cells, seconds=600.0):
        """As the function of this name: where motions start, and no solver of networks at rest."""
        return forces_at_rest(network, cells, seconds)


def forces_at_rest(network, cells, seconds=600.0) -> np.ndarray:
    """The forces at all points, (n, 3), N, after a dynamic relaxation from our equilibrium; all nodes below z = 0."""
    relaxation = {"ICgenDynamic": 1, "CdScaleIC": 50.0, "TmaxIC": seconds, "threshIC": 1e-13, "dtIC": 2.0}
    coupled = np.array([node.r for node in network.nodes if node.kind == "coupled"])
    with _system(let_down(network, 0.0), cells, relaxation, 0.5, coupled) as (_, points):
        return np.array([moordyn.GetPointForce(point) for point in points])


def forces_of_file(file, coupled, count: int) -> np.ndarray:
    """The forces at its first points, (count, 3), N, after its own start; coupled: positions (P, 3) of those, m."""
    with _silence(), _started(file, coupled, count) as (_, points):
        return np.array([moordyn.GetPointForce(point) for point in points])


@contextmanager
def _system(network, cells, options, damping_ratio, coupled):
    """A started system with its points, the coupled ones at positions (P, 3) in m."""
    with tempfile.TemporaryDirectory() as folder, _silence():
        file = Path(folder) / "lines.txt"
        quiet = {"writeLog": 0, "disableOutput": 1, "disableOutTime": 1}
        write = _write_case if hasattr(network, "body") else _write
        write(file, network, cells, damping_ratio, options | quiet)
        with _started(file, coupled, len(network.nodes)) as system:
            yield system


def _write(file, network, cells, damping_ratio, options):
    """Write a solvers.Network, by this project's own writer."""
    from solvers.io.moordyn.writer import write_moordyn

    try:
        write_moordyn(file, network, cells, damping_ratio=damping_ratio, options=options)
    except ValueError as error:  # an InputError: outside MoorDyn's model
        raise NotImplementedError(str(error)) from None


def _write_case(file, network, cells, damping_ratio, options):
    """Write the network of a conformance case, without any solver of this project."""
    file.write_text(describe_network(network, cells, damping_ratio, options), encoding="ascii")


@contextmanager
def _started(file, coupled, count: int):
    system = moordyn.Create(str(file))
    try:
        moordyn.Init(system, list(np.ravel(coupled)), [0.0] * np.size(coupled))
        yield system, [moordyn.GetPoint(system, i + 1) for i in range(count)]
    finally:
        moordyn.Close(system)


def let_down(network, down: float):
    """The network so many m lower, with its seabed; free nodes where they are at rest, from where MoorDyn starts."""
    places = _places_at_rest(network) - [0.0, 0.0, down]
    nodes = [replace(node, r=tuple(r)) for node, r in zip(network.nodes, places.tolist(), strict=True)]
    environment = network.environment
    if environment.depth is not None:
        environment = replace(environment, depth=environment.depth + down)
    return type(network)(nodes, network.elements, environment)


def let_down_as_given(network, down: float):
    """Return the network of a conformance case so many m lower, with its seabed; free nodes where it puts them."""
    lowered = copy.deepcopy(network)
    for node in lowered.nodes:
        node.r = (node.r[0], node.r[1], node.r[2] - down)
    if network.environment.depth is not None:
        lowered.environment.depth += down
    return lowered


@lru_cache(maxsize=8)
def _places_at_rest(network):
    """Kept, so that the equilibrium that MoorDyn is given is in no timing of a second call."""
    from solvers.network.solve import solve_network

    return solve_network(network).r


def end_tensions(lines) -> np.ndarray:
    """Return the size of the force of each line on the points at its ends, (e, 2), N."""
    ends = [(line, end) for line in lines for end in (0, moordyn.GetLineN(line))]
    return np.array([np.linalg.norm(moordyn.GetLineNodeForce(*end)) for end in ends]).reshape(-1, 2)


class Record:
    """The tension at both ends at each time, and its extremes along the line over a window of times, s."""

    def __init__(self, times: int, window, cells: int):
        self.ends, self.window = np.empty((2, times)), window
        self.greatest, self.least = np.full(cells + 1, -np.inf), np.full(cells + 1, np.inf)

    def take(self, system, k: int, time: float):
        """Take the state at a time: the forces on the end points, and between them the tension of its nodes."""
        line, last = moordyn.GetLine(system, 1), len(self.least) - 1
        on_point = moordyn.GetPointForce(moordyn.GetPoint(system, 2))  # of a fixed point it gives none
        self.ends[:, k] = [np.linalg.norm(force) for force in (moordyn.GetLineNodeForce(line, 0), on_point)]
        if self.window and self.window[0] <= time <= self.window[1]:
            inner = [np.linalg.norm(moordyn.GetLineNodeTen(line, i)) for i in range(1, last)]
            along = np.array([self.ends[0, k], *inner, self.ends[1, k]])
            np.maximum(self.greatest, along, out=self.greatest)
            np.minimum(self.least, along, out=self.least)

    def answer(self, scene) -> CableAnswer:
        """Return all that is asked for; between its nodes the extremes are interpolated."""
        nodes = np.linspace(0.0, scene.length, len(self.least))
        envelope = [np.interp(scene.s, nodes, extreme) for extreme in (self.greatest, self.least)]
        return CableAnswer(self.ends[1], self.ends[0], envelope)


def _uniform(current) -> str:
    """Return its file of a steady current, the same at all depths, m/s: three lines of heading, then z and velocity."""
    row = " ".join(f"{float(part)!r}" for part in current)
    return f"steady current\nthe same at all depths\nz ux uy uz\n{-FAR_DOWN} {row}\n0.0 {row}\n"


def describe(scene, segments: int, down: float) -> str:
    """Its input file, the line let down by so many m; the submerged weight follows from diameter and mass."""
    cable, environment = scene.cable, scene.environment
    ends = {name: (*getattr(scene, name)[:2], getattr(scene, name)[2] - down) for name in ("anchor", "fairlead")}
    points = {name: " ".join(f"{float(part)!r}" for part in end) for name, end in ends.items()}
    if environment.depth is None:
        depth, seabed = float(2 * scene.length - min(end[2] for end in ends.values())), ""  # m: it is not reached
    else:  # per unit of the area that the diameter covers
        stiffness, damping = (c / cable.diameter for c in (environment.seabed_stiffness, environment.seabed_damping))
        depth, seabed = float(environment.depth + down), f"{stiffness!r} kBot\n{damping!r} cBot\n"
    return _INPUT.format(
        d=cable.diameter, m=cable.mass_per_length, EA=cable.EA, damping=cable.damping * cable.EA or DAMPING,
        Cd=cable.Cdn, Ca=cable.Ca, Cdt=cable.Cdt, L=scene.length, segments=segments,
        step=_stable_step(scene, segments), g=environment.g, rho=environment.rho, depth=depth,
        seabed=seabed, currents=int(any(environment.current)), **points,
    )  # fmt: skip


def _stable_step(scene, segments: int) -> float:
    """Return its dtM for a line, s."""
    crossing = scene.length / segments / math.sqrt(scene.cable.EA / scene.cable.mass_per_length)
    return stable_step(STEP, crossing, scene.cable.damping)


def _count_within(coupling_step: float, step: float) -> int:
    return math.ceil(coupling_step / step * (1 - 1e-9))  # a whole number of steps, in spite of rounding


@contextmanager
def _silence():
    """It prints from C++, past sys.stdout and sys.stderr."""
    kept = [os.dup(stream) for stream in (1, 2)]
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        for stream in (1, 2):
            os.dup2(nowhere, stream)
        yield
    finally:
        for stream, old in zip((1, 2), kept, strict=True):
            os.dup2(old, stream)
            os.close(old)
        os.close(nowhere)
