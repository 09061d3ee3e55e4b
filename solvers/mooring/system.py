"""The moving lines that the solvers take: their arrays, motion and equilibrium; what their states mean outside."""

from __future__ import annotations

import copy
from dataclasses import replace
from functools import cached_property, partial

import numpy as np

from ..common.diagnostics import check_drag
from ..common.outcome import InputError, Status
from ..common.properties import MAX_STRAIN
from ..common.types import as_system
from ..common.validation import non_negative_number, positive_number
from ..network.model import Network
from ..numerics.newton import full_then_damped_newton
from .linearised.modes import LinePencil
from .lines.assembly import assemble_line, evaluate_forces, find_axes, take_end_cell
from .lines.calibration import calibrate_line, is_to_be_calibrated
from .lines.coarsening import coarsen, prolong, share_loads
from .lines.components import Component, integrate_components, merge_responses, split_system
from .lines.layout import number_nodes, plan_elimination
from .lines.mesh import build_mesh
from .lines.model import build_model
from .lines.prescribed_motion import move_points, ramp_motion, require_above_seabed, require_motion
from .periodic import harmonic, iterative_harmonics
from .statics import MooringState, solve_rest
from .stepping.history import MooringHistory
from .stepping.time_domain import integrate_line

SLIP_SPEED = 0.01  # m/s, at which the regularised friction reaches 0.7 of Coulomb's


def mooring_system(
    scene,
    cells: int = 50,
    *,
    mesh="fitted",
    fields="auto",
    motion=None,
    calibrate="auto",
    slip_speed=SLIP_SPEED,
    contact_depth=0.0,
    source=None,
) -> MooringSystem:
    """Return the moving line of a Scene, or the moving lines of a Network, as a MooringSystem.

    cells: of a line (a Scene, or a Network whose elements follow one another) in total; of another Network those of the
    longest element, the others in proportion to their length, or one number for each element. mesh: "fitted" to the
    lines at rest (finer where they bend and over the range that the touchdown travels), "touchdown" (fitted, and much
    finer over that range), "uniform", or unstretched arc lengths of the nodes in m, (N,) of a line, of a Network a list
    of one for each element.
    fields: "planar" (along, z), "spatial" (x, y, z), or "auto": planar where lines, current and motion lie in one
    vertical plane. motion: a BodyMotion, or displacement(t) and velocity(t), (3, *S) in m and m/s, of all coupled
    points, in place of the scene's.
    calibrate: make the exact catenaries the equilibrium of the mesh (``calibration``): True, False, or "auto", where
    the motion changes the tension by less than a tenth; not over a seabed, where a line hangs straight down, nor for
    a Network that is not one line.
    slip_speed: m/s, at which the friction of the seabed reaches 0.7 of Coulomb's. contact_depth: m, over which its
    damping grows from contact on (with 0 its force jumps, which harmonic balance seldom takes); usual: weight over k.
    source: t (S,) -> loads (S, N, n) on the nodes in N, along the axes of the system, for manufactured solutions.
    Raises InputError naming the field for anything missing or out of range.

    >>> chain = CableProperties(EA=384.243e6, diameter=0.09, mass_per_length=77.7066, Cdn=1.6)
    >>> scene = Scene("my line", chain, 902.2, (0.0, 0.0, -320.0), (848.67, 0.0, -70.0))
    >>> mooring_system(scene, cells=20).fields
    ('along', 'z')
    """
    if isinstance(scene, MooringSystem):
        problem = "is a MooringSystem already: solve it as it is, take its with_motion(motion) for another motion, or "
        raise InputError(problem + "give the Scene or Network that it was made of", field="scene", value=scene)
    model = build_model(scene)
    motion = getattr(scene, "motion", None) if motion is None else motion
    if motion is not None:
        require_motion(motion, model)
    axes = find_axes(model, fields, motion)
    layout = number_nodes(model, build_mesh(model, cells, mesh, motion))
    calibrated = is_to_be_calibrated(calibrate, model, motion)
    seabed = positive_number("slip_speed", slip_speed, "m/s"), non_negative_number("contact_depth", contact_depth, "m")
    return MooringSystem(model, layout, axes, motion, seabed, source, calibrated=calibrated)


class MooringSystem:
    """Lines of N nodes and C cells in n axes, the last one up; see ``mooring_system``.

    fields: names of the axes; layout: the Layout of nodes and cells; line: the arrays of ``equations.Line``; order: the
    Elimination; prescribed_nodes (P,): those that are prescribed; length: unstretched, of a line or of the longest
    element, m; period of the motion in s, or None; seabed: slip_speed and contact_depth; end_loads: of
    ``calibrate_line``, or None.
    """

    def __init__(self, model, layout, axes, motion, seabed, source=None, period=None, calibrated=False):
        self.model, self.layout, self.axes, self.motion, self.source = model, layout, axes, motion, source
        self.fields = ("along", "z") if len(axes) == 2 else ("x", "y", "z")
        self.nodes, self.seabed, self.period = layout.size, seabed, getattr(motion, "period", period)
        self.origin = model.positions[0] * [1.0, 1.0, 0.0]
        self._prescribed_points = [i for i, point in enumerate(model.points) if point.kind != "free"]
        self.prescribed_nodes = layout.points[self._prescribed_points]
        self._moved = [self._prescribed_points.index(i) for i in model.moved]  # among these
        self.length = model.length if model.is_line else max(segment.length for segment in model.segments)
        self.line, self.calibrated, self.end_loads = assemble_line(model, layout, axes, *seabed), calibrated, None
        self.order = plan_elimination(layout, self.prescribed_nodes, len(axes))
        if calibrated:
            self.line, self.end_loads = calibrate_line(self)
        self._end_cells: dict = {}

    @property
    def s(self) -> np.ndarray:
        """Unstretched arc lengths (N,) of the nodes of a line, m; those of a network are ``layout.s``."""
        if not self.model.is_line:
            raise InputError("the elements of a network have one each, layout.s", field="s")
        starts = np.cumsum([0.0, *(segment.length for segment in self.model.segments)])
        return np.concatenate([[0.0], *(start + s[1:] for start, s in zip(starts, self.layout.s, strict=False))])

    # ------------------------------------------------------------ the same line, changed
    def with_motion(self, motion) -> MooringSystem:
        """Return the same lines, of the same mesh and rest, with another motion of the coupled points."""
        other = copy.copy(self)
        if "components" in vars(self):
            parts = tuple(replace(part, system=part.system.with_motion(motion)) for part in self.components)
            other.__dict__["components"] = parts
        if (coarser := vars(self).get("_coarser")) is not None:
            other.__dict__["_coarser"] = coarser[0].with_motion(motion), coarser[1]
        other.motion, other.period = motion, getattr(motion, "period", self.period)
        return other

    def ramped(self, duration) -> MooringSystem:
        """Return the same line, its motion grown from rest over a duration in s."""
        return self if self.motion is None else self.with_motion(ramp_motion(self.motion, duration))

    def scaled(self, load_factor) -> MooringSystem:
        """Return the same line with its motion multiplied by a number."""
        return self.with_motion(self.motion.scaled(load_factor))

    @cached_property
    def components(self) -> tuple[Component, ...]:
        """Parts of a network that no free node joins, or none where it is one part."""
        return split_system(self)

    # ------------------------------------------------------------ about the equilibrium
    def input_warnings(self) -> tuple[str, ...]:
        """Return what is suspected in the scene or network, and where there is no drag across a line in motion."""
        model, current = self.model, self.model.environment.current
        suspected = [*getattr(model.given, "warnings", ())]
        suspected += check_drag([part.cable for part in model.segments], self.motion is not None, current)
        return tuple(dict.fromkeys(suspected))

    @cached_property
    def rest(self) -> MooringState:
        """The discrete equilibrium of this mesh, undisplaced; raises ConvergenceError where there is none."""
        return solve_rest(self)

    def solve_static(self, throw=True) -> MooringState:
        """Return the discrete equilibrium, as ``solvers.solve_static`` does."""
        return self.rest if throw else solve_rest(self, throw=False)

    def integrate(self, **settings) -> MooringHistory:
        """Return the motion over time, as ``solvers.solve_time_domain`` asks with settings that it has validated."""
        if not self.components:
            return integrate_line(self, **settings)
        return integrate_components(self, MooringHistory, **settings)

    def rest_state(self) -> np.ndarray:
        """Return the coordinates of the nodes at rest, (n, N), m."""
        return self.rest.y

    def pencil(self) -> LinePencil:
        """Return the linear pencil about rest, as ``natural_modes`` asks."""
        return LinePencil(self)

    # ------------------------------------------------------------ what solve_periodic asks
    newton = staticmethod(full_then_damped_newton)  # full steps, which the mixed method takes, first
    periodic_response = harmonic.MooringResponse
    periodic_start = harmonic.start_from_time
    solve_extrapolated = harmonic.solve_extrapolated
    merge_responses = merge_responses

    def harmonic_residual(self, basis, mirror) -> harmonic.MooringHarmonics:
        """Return the rows in Fourier coefficients, solved without blocks where they are many; no mirror is used."""
        is_iterative = basis.harmonics >= iterative_harmonics.ITERATIVE_FROM
        return (iterative_harmonics.IterativeHarmonics if is_iterative else harmonic.MooringHarmonics)(self, basis)

    def mirror(self):
        """Return None: no symmetry is used."""
        return None

    def invalid(self, y) -> tuple[Status, int] | None:
        """Return a status and a node where states (n, N, *S) stretch a line beyond ``MAX_STRAIN``, or None.

        None, too, where the line at rest is stretched so far.
        """
        line = self.line
        if (self.rest.tension > MAX_STRAIN * line.EA).any():  # soft springs, whose EA means what it says
            return None
        chord = np.sqrt(((y[:, line.last] - y[:, line.first]) ** 2).sum(axis=0))
        strain = (chord.reshape(line.length.size, -1).max(axis=1) / line.length) - 1
        return (Status.OVERSTRETCHED, int(line.last[strain.argmax()])) if strain.max() > MAX_STRAIN else None

    def fourth_order(self):
        """Return None: there are no rows of higher order."""
        return None

    def coarser(self):
        """Return the lines on every second node, and cubic splines between its nodes; None where one has too few.

        The same ones at each call, with the rest that was solved for.
        """
        return self._coarser

    @cached_property
    def _coarser(self):
        layout = coarsen(self.model, self.layout)
        if layout is None:
            return None
        source, share = self.source, share_loads(layout, self.layout) if self.source else None
        given = self.seabed, source and (lambda t: share @ source(t)), self.period, self.calibrated
        coarse = MooringSystem(self.model, layout, self.axes, self.motion, *given)
        return coarse, partial(prolong, layout, self.layout)

    # ------------------------------------------------------------ the points that are prescribed
    @property
    def moved_points(self) -> np.ndarray:
        """Mean positions (M, 3) of the coupled points, m."""
        return self.model.positions[self.model.moved]

    @property
    def coupled_nodes(self) -> np.ndarray:
        """Nodes (M,) at the coupled points."""
        return self.layout.points[self.model.moved]

    @cached_property
    def _prescribed_positions(self):
        return self.to_axes(self.model.positions[self._prescribed_points].T).T

    def path(self, t) -> np.ndarray:
        """Return position, velocity and acceleration of the prescribed nodes at times t (S,), (S, 3, P, n)."""
        t = np.asarray(t, dtype=float)
        path = np.zeros((t.size, 3, self.prescribed_nodes.size, len(self.axes)))
        path[:, 0] = self._prescribed_positions
        if self.motion is not None:
            parts = np.stack(move_points(self.motion, self.moved_points, t)).transpose(0, 2, 1, 3)
            path[:, :, self._moved] += (self.axes @ parts).transpose(3, 0, 1, 2)
            require_above_seabed(self.model, self.moved_points, t, path[:, 0, self._moved, -1])
        return path

    def name_node(self, node) -> str:
        """Return what a message calls a node: its number along a line, or its element and arc length."""
        if self.model.is_line:
            return f"node {node + 1} of {self.nodes}"
        e = next(e for e, nodes in enumerate(self.layout.nodes) if node in nodes)
        s = self.layout.s[e][np.flatnonzero(self.layout.nodes[e] == node)[0]]
        return f"element {e + 1}, {s:.4g} m from its anchor end"

    def forces(self, y, ydot, yddot):
        """Return forces (3, N, K) on what holds the nodes, public frame, and tensions (C, K) of the cells, N."""
        forces, tensions = evaluate_forces(self.line, y, ydot, yddot)
        return np.einsum("dc,knd->cnk", self.axes, forces), tensions.T

    def end_force(self, y, ydot, yddot, end, element=None) -> np.ndarray:
        """Return the force (K, n) on what holds the first (end 0) or last (end -1) node of an element, N, in the axes.

        y, ydot, yddot (n, N, K). element None: of a line, the whole of what its first or last node leaves.
        """
        line, nodes = self.end_cell(end, element)
        return evaluate_forces(line, y[:, nodes], ydot[:, nodes], yddot[:, nodes])[0][:, end]

    def end_cell(self, end, element=None):
        """Return the Line of the cell at that end, and its two nodes; see ``assembly.take_end_cell``."""
        if (end, element) not in self._end_cells:
            self._end_cells[end, element] = take_end_cell(self, end, element)
        return self._end_cells[end, element]

    def source_at(self, t) -> np.ndarray:
        """Return the loads (S, N, n) in N that a source adds at times t (S,), or an empty array without one."""
        n = len(self.axes)
        return np.empty((0, self.nodes, n)) if self.source is None else np.ascontiguousarray(self.source(t))

    # ------------------------------------------------------------ coordinates
    def to_axes(self, r) -> np.ndarray:
        """Return coordinates (n, *S) of positions (3, *S) in the public frame, m."""
        return np.tensordot(self.axes, r - self.origin.reshape(3, *(1,) * (np.ndim(r) - 1)), 1)

    def positions(self, y) -> np.ndarray:
        """Return positions (3, N, *S) in the public frame of coordinates (n, N, *S), m."""
        return np.tensordot(self.axes.T, y, 1) + self.origin.reshape(3, *(1,) * (np.ndim(y) - 1))


as_system.register(Network, mooring_system)
