"""One load case in one system: steps in chunks, of which tensions, length on the seabed and slack are kept."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from ..common.motions.body_motion import BodyMotion
from ..common.motions.sea_state import SeaMotion, SeaState
from ..common.outcome import InputError, Status
from ..common.properties import MAX_STRAIN
from ..common.response import ROUNDING
from ..mooring import equations
from ..mooring.equations import node_forces
from ..mooring.lines.mesh import build_mesh
from ..mooring.lines.model import build_model
from ..mooring.stepping.time_domain import stream_line
from ..mooring.system import mooring_system
from ..network.model import Network
from ..numerics.compiled import compiled

CHUNK = 512  # steps, whose states are held at a time; the rounding of results depends on it, so it is fixed
RANGE = 2.0  # standard deviations of the motion, over whose range of the touchdown the mesh is fine
OUT_OF_STEP = (0.0, 0.0, math.pi / 2, 0.0, 0.0, 0.0)  # rad, of heave: the range is then an ellipse and no line
LINE_TOLERANCE = 3e-3
"""Of the largest change of a tension so far, what the last Newton step of a time step may change: what is left then is
that by the contraction of Newton's method, at most a tenth, and smaller steps leave less of it, so that the error of a
setting (see ``accuracy``) has it in. At 1e-2, for 2 % fewer iterations, it may come to a third of the error of a step;
a second iteration where one is enough would cost a third of a case."""
CONTACT_TOLERANCE = 1e-3
"""The same over a seabed, whose stiffness and friction change within a step: steps that fail at 1e-2 cost more."""
ROUGH = 0.5
"""Friction of the seabed, above which the steps damp all that they do not resolve: at 0.6 and more an axial oscillation
of a few steps' period grows otherwise (some per cent of the deviation, at five times the iterations); at 0.5 it does
not, and undamped steps of 0.1 s err by 0.1 % of the deviation for 1 %."""


class LineSeries(NamedTuple):
    """Of one line after the ramp: tensions at its ends, (K,) N; length on the seabed (K,) m; slack (K,) bool."""

    fairlead: np.ndarray
    anchor: np.ndarray
    grounded: np.ndarray
    slack: np.ndarray


@dataclass(frozen=True)
class CaseSeries:
    """What one load case leaves: dt in s, a LineSeries for each line, status and where it failed, iterations."""

    dt: float
    lines: tuple[LineSeries, ...]
    status: Status
    event: tuple[float, str] | None
    iterations: int


def integrate_case(given, case, *, dt, cells, watch=None) -> CaseSeries:
    """Return the series of a LoadCase on a Scene or Network, with steps of at most dt in s on a mesh of ``cells``.

    The step divides the time after which a sea repeats, so that its waves are one transform. watch: called with the
    number of each line, the MooringSystem that it belongs to, its element there (None: all of it) and the number of
    steps after the ramp; what it returns looks at them, ``look(r, v, a)`` of states (k, N, n). Raises InputError and
    ConvergenceError for what the case cannot be.
    """
    motion = case.motion.motion() if isinstance(case.motion, SeaState) else case.motion
    displaced = move_system(given, case)
    system = mooring_system(displaced, cells, mesh=_fitted_mesh(displaced, motion, cells), motion=motion)
    _require_offset_within_reach(given, case, system, cells)
    repeats = case.motion.duration if isinstance(case.motion, SeaState) else case.whole_duration
    dt = repeats / math.ceil(repeats / dt * (1 - ROUNDING))
    count = math.ceil(case.whole_duration / dt * (1 - 1e-9))
    first = math.ceil(case.ramp / dt * (1 - 1e-9))
    if count - first < 2:
        problem = f"{case.duration:g} s holds fewer than two steps of {dt:g} s"
        raise InputError(problem, field="duration", value=case.duration, unit="s")
    path = (system.ramped(case.ramp) if case.ramp else system).path(dt * np.arange(count + 1))
    column = np.empty(system.nodes, dtype=int)  # of a prescribed node in the path
    column[system.prescribed_nodes] = np.arange(system.prescribed_nodes.size)
    model, iterations = system.model, 0
    lines: list[LineSeries | None] = [None] * len(model.segments)
    parts = [(part.system, part.nodes, part.cells) for part in system.components]
    for part, nodes, own_cells in parts or [(system, np.arange(system.nodes), np.arange(system.line.length.size))]:
        elements = [e for e, at in enumerate(system.layout.cells) if at.start in own_cells]
        own = [None] if len(lines) == 1 else range(len(elements))
        observers = [_Observer(part, e, count - first) for e in own]
        watching = (
            [watch(number, part, e, count - first) for number, e in zip(elements, own, strict=True)] if watch else []
        )
        own_path = np.ascontiguousarray(path[:, :, column[nodes[part.prescribed_nodes]]])
        status, event, work = _run(part, dt, count, first, case.ramp, own_path, [*observers, *watching])
        iterations += work
        if event is not None:
            return CaseSeries(dt, (), status, (event[0], part.name_node(event[1])), iterations)
        for e, observer in zip(elements, observers, strict=True):
            lines[e] = observer.series()
    return CaseSeries(dt, tuple(lines), Status.SUCCESS, None, iterations)  # type: ignore[arg-type]


def _require_offset_within_reach(given, case, system, cells):
    """Raise InputError where an offset stretches a line at rest as no mooring line is stretched."""

    def is_torn(one) -> bool:
        return bool((one.rest.tension > MAX_STRAIN * one.line.EA).any())

    if any(case.offset) and is_torn(system) and not is_torn(mooring_system(given, cells)):
        problem = f"{list(case.offset)} m stretches a line by more than {100 * MAX_STRAIN:g} % at rest"
        raise InputError(problem, field="offset", value=case.offset, unit="m")


def _fitted_mesh(given, motion, cells):
    """Return a mesh fitted to the range that the touchdown travels: in waves of two standard deviations."""
    if not isinstance(motion, SeaMotion):
        return "touchdown"
    of_parts: tuple[Any, ...] = (motion.translation, motion.rotation)
    parts = [np.zeros(3) if part is None else part.standard_deviation for part in of_parts]
    if not np.any(parts):
        return "touchdown"
    usual = BodyMotion.harmonic(1.0, RANGE * np.concatenate(parts), OUT_OF_STEP, motion.reference)
    model = build_model(given)
    mesh = build_mesh(model, cells, "touchdown", usual)
    if not model.is_line:
        return mesh
    starts = np.cumsum([0.0, *(part[-1] for part in mesh)])
    return np.concatenate([[0.0], *(start + part[1:] for start, part in zip(starts, mesh, strict=False))])


def move_system(given, case):
    """Return a Scene or Network in the current of a case, its coupled points displaced by the offset."""
    environment = given.environment
    if case.current is not None:
        environment = replace(environment, current=case.current)
    if isinstance(given, Network):
        nodes = [replace(node, r=_moved(node.r, case.offset)) if node.kind == "coupled" else node
                 for node in given.nodes]  # fmt: skip
        return replace(given, nodes=tuple(nodes), environment=environment)
    return replace(given, fairlead=_moved(given.fairlead, case.offset), environment=environment)


def _moved(r, offset) -> tuple[float, float, float]:
    x, y, z = (float(a + b) for a, b in zip(r, offset, strict=True))
    return x, y, z


def _run(part, dt, count, first, ramp, path, observers):
    """Take the steps of one part and let the observers look at each chunk; return status, event and iterations."""
    has_seabed = part.line.seabed_stiffness.any()
    is_rough = has_seabed and max(segment.friction for segment in part.model.segments) > ROUGH
    tolerance = CONTACT_TOLERANCE if has_seabed else LINE_TOLERANCE
    steps = stream_line(part, dt=dt, count=count, tolerance=tolerance, ramp=ramp, path=path, chunk=CHUNK,
                        rho_inf=0.0 if is_rough else None)  # fmt: skip
    while True:
        try:
            at, *states = next(steps)
        except StopIteration as end:
            return end.value
        skipped = max(first + 1 - at, 0)
        if skipped < len(states[0]):
            for observer in observers:
                observer.look(*(state[skipped:] for state in states))


class _Observer:
    """Looks at the states of one line, element e of a part (None: the part is one line), and keeps its series."""

    def __init__(self, part, e, count):
        self.part, self.at = part, 0
        layout = part.layout
        self.ends = [part.end_cell(end, e) for end in (-1, 0)]
        chosen = range(len(layout.s)) if e is None else [e]
        self.cells = np.concatenate([np.arange(layout.cells[i].start, layout.cells[i].stop) for i in chosen])
        self.kept = LineSeries(np.empty(count), np.empty(count), np.empty(count), np.empty(count, dtype=bool))

    def look(self, r, v, a):
        """Keep what is asked of states (k, N, n)."""
        here = slice(self.at, self.at + len(r))
        self.at += len(r)
        for (line, nodes), kept, end in zip(self.ends, self.kept[:2], (1, 0), strict=True):
            states = tuple(np.ascontiguousarray(part[:, nodes]) for part in (r, v, a))
            forces, tension = np.empty_like(states[0]), np.empty((len(r), 1))
            node_forces(line, states, forces, tension)
            kept[here] = np.sqrt((forces[:, end] ** 2).sum(axis=1))
        observe(self.part.line, self.cells, r, v, self.kept.grounded[here], self.kept.slack[here])

    def series(self) -> LineSeries:
        """Return what was kept."""
        return LineSeries(*(part[: self.at] for part in self.kept))


@compiled(calls=(equations,))
def observe(line, cells, r, v, grounded, slack):
    """Set grounded (K,) to the unstretched length in m below the seabed's surface, slack (K,) to whether a cell is.

    cells: those of the line; r, v (K, N, n). A cell that crosses the surface counts in proportion to its height.
    """
    n = r.shape[2]
    for k in range(r.shape[0]):
        length, loose = 0.0, False
        for c in cells:
            first, last = line.first[c], line.last[c]
            square, rate = 0.0, 0.0
            for j in range(n):
                d = r[k, last, j] - r[k, first, j]
                square += d * d
                rate += d * (v[k, last, j] - v[k, first, j])
            distance, l = np.sqrt(square), line.length[c]
            if distance / l - 1 + line.damping[c] * rate / (distance * l) <= 0:
                loose = True
            one, other = line.floor - r[k, first, n - 1], line.floor - r[k, last, n - 1]
            lower, upper = max(one, other), min(one, other)
            if upper >= 0 and lower > 0:
                length += l
            elif lower > 0:
                length += l * lower / (lower - upper)
        grounded[k], slack[k] = length, loose
