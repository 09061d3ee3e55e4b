"""The moving line that the solvers take: its arrays, its motion, and its equilibrium; what its states mean outside."""

from __future__ import annotations

import copy
import math
from functools import cached_property
from typing import Any

import numpy as np
from scipy.interpolate import make_interp_spline

from ..common.motion import Ramped, trajectory
from ..common.outcome import InputError
from ..common.validation import one_of, positive_number
from .calibration import SMALL_CHANGE, calibrate_line, estimate_tension_change
from .equations import Line, node_forces, residual, tangents
from .harmonic import MooringHarmonics, MooringResponse, full_then_damped_newton, solve_extrapolated, start_from_time
from .history import MooringHistory
from .mesh import FAIRLEAD_POSITIONS, build_mesh
from .model import build_line_model
from .modes import LinePencil
from .statics import MooringState, solve_rest
from .time_domain import integrate_line

MIN_NODES = 4  # of a coarser line
PERIODS_TO_START = 3  # of the motion, whose last one a periodic response starts from
SLIP_SPEED = 0.01  # m/s, at which the regularised friction reaches 0.7 of Coulomb's
_IN_PLANE = 1e-12  # out-of-plane parts below this share of a vector come from rounding its direction


def mooring_system(
    scene,
    cells: int = 50,
    *,
    mesh="fitted",
    fields="auto",
    motion=None,
    calibrate="auto",
    slip_speed=SLIP_SPEED,
    source=None,
) -> MooringSystem:
    """Return the moving line of a Scene, or of a Network whose elements follow one another, as a MooringSystem.

    cells: how many in total. mesh: "fitted" to the line at rest (finer where it bends and over the range that the
    touchdown travels), "uniform", or unstretched arc lengths (N,) of the nodes in m.
    fields: "planar" (along, z), "spatial" (x, y, z), or "auto": planar where line, current and motion lie in one
    vertical plane. motion: displacement(t) and velocity(t), (3, *S) in m and m/s, in place of the scene's.
    calibrate: make the exact catenaries the equilibrium of the mesh (``calibration``): True, False, or "auto", where
    the motion changes the tension by less than a tenth; not over a seabed, nor where a line hangs straight down.
    slip_speed: m/s, at which the friction of the seabed reaches 0.7 of Coulomb's.
    source: t (S,) -> loads (S, N, n) on the nodes in N, along the axes of the system, for manufactured solutions.
    Raises InputError naming the field for anything missing or out of range.

    >>> chain = CableProperties(EA=384.243e6, diameter=0.09, mass_per_length=77.7066, Cdn=1.6)
    >>> scene = Scene("my line", chain, 902.2, (0.0, 0.0, -320.0), (848.67, 0.0, -70.0))
    >>> mooring_system(scene, cells=20).fields
    ('along', 'z')
    """
    model = build_line_model(scene)
    motion = getattr(scene, "motion", None) if motion is None else motion
    if motion is not None and not callable(getattr(motion, "velocity", None)):
        raise InputError(f"{motion!r} is no Motion, SampledMotion or FunctionMotion", field="motion", value=motion)
    axes = _axes(model, fields, motion)
    s = build_mesh(model, cells, mesh, motion)
    slip_speed = positive_number("slip_speed", slip_speed, "m/s")
    return MooringSystem(model, s, axes, motion, slip_speed, source, calibrated=_calibrates(calibrate, model, motion))


class MooringSystem:
    """A line of N nodes and C = N - 1 cells in n axes, the last one up; see ``mooring_system``.

    fields: names of the axes; s (N,): unstretched arc lengths, m; line: the arrays of ``equations.Line``;
    prescribed_nodes: indices of the nodes that are prescribed; period of the motion in s, or None.
    """

    def __init__(self, model, s, axes, motion, slip_speed, source=None, period=None, calibrated=False):
        self.model, self.s, self.axes, self.motion, self.source = model, s, axes, motion, source
        self.fields = ("along", "z") if len(axes) == 2 else ("x", "y", "z")
        self.nodes = s.size
        self.kept: Any = None  # of the nodes of a finer line, those that this one has
        self.period = getattr(motion, "period", period)
        anchor = np.array(model.points[0].r)
        self.origin = np.array([anchor[0], anchor[1], 0.0])
        ends = (0, model.points[0]), (s.size - 1, model.points[-1])
        self.prescribed_nodes = np.array([node for node, point in ends if point.kind != "free"])
        self.line, self.calibrated = _line_arrays(model, s, axes, slip_speed), calibrated
        if calibrated:
            self.line = calibrate_line(self)

    # ------------------------------------------------------------ the same line, changed
    def with_motion(self, motion) -> MooringSystem:
        """Return the same line, of the same mesh and rest, with another motion of its last point."""
        other = copy.copy(self)  # a rest that is solved for is kept
        other.motion, other.period = motion, getattr(motion, "period", self.period)
        return other

    def ramped(self, duration) -> MooringSystem:
        """Return the same line, its motion grown from rest over a duration in s."""
        return self if self.motion is None else self.with_motion(Ramped(self.motion, duration))

    def scaled(self, load_factor) -> MooringSystem:
        """Return the same line with its motion multiplied by a number."""
        return self.with_motion(self.motion.scaled(load_factor))

    # ------------------------------------------------------------ about the equilibrium
    @cached_property
    def rest(self) -> MooringState:
        """The discrete equilibrium of this mesh, undisplaced; raises ConvergenceError where there is none."""
        return solve_rest(self)

    def solve_static(self, throw=True) -> MooringState:
        """Return the discrete equilibrium, as ``solvers.solve_static`` does."""
        return self.rest if throw else solve_rest(self, throw=False)

    def solve_extrapolated(self, **options) -> MooringResponse:
        """Return the periodic response whose end forces are extrapolated from two meshes, as solve_periodic asks."""
        return solve_extrapolated(self, **options)

    def integrate(self, **settings) -> MooringHistory:
        """Return the motion over time, as ``solvers.solve_time_domain`` asks with settings that it has validated."""
        return integrate_line(self, **settings)

    def rest_state(self) -> np.ndarray:
        """Return the coordinates of the nodes at rest, (n, N), m."""
        return self.rest.y

    def pencil(self) -> LinePencil:
        """Return the linear pencil about rest, as ``natural_modes`` asks."""
        return LinePencil(self)

    # ------------------------------------------------------------ what solve_periodic asks
    newton = staticmethod(full_then_damped_newton)
    periodic_response = MooringResponse

    def harmonic_residual(self, basis, mirror, iterative) -> MooringHarmonics:
        """Return the rows in Fourier coefficients; neither a mirror nor an iterative solver is used."""
        return MooringHarmonics(self, basis)

    def periodic_start(self, basis, harmonics_of_driving) -> np.ndarray:
        """Return coefficients z (n, N, C) from a short time integration."""
        return start_from_time(self, basis, max(2, PERIODS_TO_START // harmonics_of_driving))

    def mirror(self):
        """Return None: no symmetry is used."""
        return None

    def invalid(self, y):
        """Return None: a line is valid in every state, slack too."""
        return None

    def fourth_order(self):
        """Return None: there are no rows of higher order."""
        return None

    def coarser(self):
        """Return the line on every second node, and cubic splines between its nodes; None with too few."""
        if self.nodes + 1 < 2 * MIN_NODES:
            return None
        joints = np.cumsum([0.0, *(segment.length for segment in self.model.segments)])
        kept = np.zeros(self.nodes, dtype=bool)
        kept[::2] = True
        kept[abs(self.s[:, None] - joints).argmin(axis=0)] = True
        source, share = self.source, np.stack([np.interp(self.s, self.s[kept], unit) for unit in np.eye(kept.sum())])
        coarse = MooringSystem(
            self.model, self.s[kept], self.axes, self.motion, self.line.slip_speed,
            source and (lambda t: share @ source(t)), self.period, self.calibrated)  # fmt: skip
        coarse.kept = kept
        return coarse, lambda z: make_interp_spline(coarse.s, z, axis=1)(self.s)

    @cached_property
    def _prescribed_positions(self):
        return self.to_axes(np.array([self.model.points[0 if i == 0 else -1].r for i in self.prescribed_nodes]).T).T

    def path(self, t) -> np.ndarray:
        """Return position, velocity and acceleration of the prescribed nodes at times t (S,), (S, 3, P, n)."""
        t = np.asarray(t, dtype=float)
        path = np.zeros((t.size, 3, self.prescribed_nodes.size, len(self.axes)))
        path[:, 0] = self._prescribed_positions
        if self.motion is not None and self.prescribed_nodes.size and self.prescribed_nodes[-1] == self.nodes - 1:
            r, v, a = trajectory(self.motion, t)
            path[:, 0, -1] += (self.axes @ r).T
            path[:, 1, -1], path[:, 2, -1] = (self.axes @ v).T, (self.axes @ a).T
        return path

    def forces(self, y, ydot, yddot):
        """Return forces (3, N, K) on what holds the nodes, public frame, and tensions (C, K) of the cells, N."""
        forces, tensions = evaluate_forces(self.line, y, ydot, yddot)
        return np.einsum("dc,knd->cnk", self.axes, forces), tensions.T

    def end_force(self, y, ydot, yddot, end) -> np.ndarray:
        """Return the force (K, n) on what holds the first (end 0) or the last (end -1) node, in the axes, N."""
        line, count = self.line, self.nodes - 1
        cells, nodes = (slice(1), slice(2)) if end == 0 else (slice(-1, None), slice(-2, None))
        arrays = {name: value for name, value in line._asdict().items() if isinstance(value, np.ndarray)}
        ends: dict = {name: a[cells if len(a) == count else nodes] for name, a in arrays.items()}
        line = line._replace(**ends)
        return evaluate_forces(line, *(part[:, nodes] for part in (y, ydot, yddot)))[0][:, end]

    def acceleration(self, r, v) -> np.ndarray:
        """Return the accelerations (N, n) in m/s^2 that balance positions and velocities (N, n) at t = 0."""
        nodes, n = r.shape
        R, T, unit, zeros = np.empty_like(r), np.empty(nodes - 1), np.empty((nodes - 1, n)), np.zeros_like(r)
        mass, right, left = np.empty((nodes, n, n)), np.empty((nodes - 1, n, n)), np.empty((nodes - 1, n, n))
        no_tension = np.zeros(nodes - 1)
        residual(self.line, r, v, zeros, no_tension, R, T, unit)
        R -= self.source_at(np.zeros(1)).sum(axis=0)  # of none the sum is zero
        tangents(self.line, r, v, zeros, no_tension, (0.0, 0.0, 1.0), mass, right, left)
        a = np.linalg.solve(mass, -R[..., None])[..., 0]
        a[self.prescribed_nodes] = self.path(np.zeros(1))[0, 2]
        return a

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


def evaluate_forces(line, y, ydot, yddot):
    """Return forces (K, N, n) on what holds the nodes, in the axes, and tensions (K, C) of the cells of a Line, N."""
    record = tuple(np.ascontiguousarray(part.transpose(2, 1, 0)) for part in (y, ydot, yddot))
    forces, tensions = np.empty(record[0].shape), np.empty((len(record[0]), record[0].shape[1] - 1))
    node_forces(line, record, forces, tensions)
    return forces, tensions


def _axes(model, fields, motion) -> np.ndarray:
    """Return unit vectors of the coordinates, (2, 3) or (3, 3), the last one up."""
    one_of("fields", fields, ("auto", "planar", "spatial"))
    points = np.array([point.r for point in model.points])
    level = points[-1, :2] - points[0, :2]
    run = math.hypot(*level)
    along = np.array([*(level / run), 0.0]) if run > 0 else np.array([1.0, 0.0, 0.0])
    out = np.array([-along[1], along[0], 0.0])
    forces = [np.array(point.force) for point in model.points]
    vectors = [*(points - points[0]), np.array(model.environment.current), *forces]
    vectors += [] if motion is None else list(np.asarray(motion.directions()))
    planar = all(abs(v @ out) <= _IN_PLANE * np.linalg.norm(v) for v in vectors)
    if fields == "planar" and not planar:
        problem = "'planar', but a point, the current or the motion leaves the line's vertical plane"
        raise InputError(problem, field="fields", value=fields)
    if fields != "spatial" and planar:
        return np.array([along, [0.0, 0.0, 1.0]])
    return np.eye(3)


def _calibrates(given, model, motion) -> bool:
    if not (isinstance(given, (bool, np.bool_)) or given == "auto"):
        raise InputError(f"{given!r} must be 'auto', True or False", field="calibrate", value=given)
    if model.environment.depth is not None:
        if given is not False and given != "auto":
            raise InputError(
                "True, and over a seabed that would fix where the line lies", field="calibrate", value=given
            )
        return False
    if given != "auto":
        return bool(given)
    if getattr(motion, "period", None) is None:
        return False
    return estimate_tension_change(model, motion, FAIRLEAD_POSITIONS) < SMALL_CHANGE


def _line_arrays(model, s, axes, slip_speed) -> Line:
    """Return the arrays of the equations on a mesh."""
    environment, length = model.environment, np.diff(s)
    joints = np.cumsum([0.0, *(segment.length for segment in model.segments)])
    of_cell = np.clip(np.searchsorted(joints, (s[1:] + s[:-1]) / 2) - 1, 0, len(model.segments) - 1)

    def by_cell(value):
        return np.array([value(segment) for segment in model.segments], dtype=float)[of_cell]

    def by_node(per_length):
        halves = per_length * length / 2
        return np.append(halves, 0.0) + np.append(0.0, halves)

    rho = environment.rho
    load = np.zeros((s.size, len(axes)))
    load[:, -1] -= by_node(by_cell(lambda segment: segment.weight))
    point_mass = np.zeros(s.size)
    for point, joint in zip(model.points, joints, strict=True):
        i = int(abs(s - joint).argmin())
        point_mass[i] += point.mass
        load[i] += axes @ np.array(point.force)
        load[i, -1] -= environment.g * (point.mass - rho * point.volume)
    bed = 0.0 if environment.depth is None else environment.seabed_stiffness or 0.0
    everywhere = np.ones(length.size)
    friction = by_node(by_cell(lambda segment: segment.friction)) / by_node(everywhere)
    return Line(
        length,
        by_cell(lambda segment: segment.EA),
        by_cell(lambda segment: segment.cable.damping),
        by_cell(lambda segment: segment.cable.mass_per_length),
        by_cell(lambda segment: segment.cable.added_mass(environment)),
        by_cell(lambda segment: rho * segment.cable.diameter * segment.cable.Cdn / 2),
        by_cell(lambda segment: rho * math.pi * segment.cable.diameter * segment.cable.Cdt / 2),
        point_mass,
        load,
        bed * by_node(everywhere),
        environment.seabed_damping * by_node(everywhere) if bed else np.zeros(s.size),
        friction,
        -math.inf if environment.depth is None else -environment.depth,
        slip_speed,
        tuple(float(c) for c in axes @ np.array(environment.current)),
    )
