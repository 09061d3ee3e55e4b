"""The cable as a chain: governing equations HB (1)-(12) on the box scheme (39), for the fields that the scene needs.

F = M(y) y_t + K(y) y_s + f(y) summed over the two nodes of a cell, in total form; f of EQUATIONS.md.
Structural damping is Kelvin-Voigt, T = EA (eps + beta d(eps)/dt), beta in s (the paper's beta in (1) is a misprint).
Inside, vectors are (up, along, out): HB's X, Y, Z with Y from the anchor towards the fairlead.
"""

from __future__ import annotations

import copy
import math
from functools import cached_property

import numpy as np
from scipy.interpolate import make_interp_spline

from ..common.motion import Ramped
from ..common.outcome import InputError, Status
from ..common.properties import one_of, real_array
from ..numerics.chain import ChainSystem, Residual
from . import planar as cable_planar
from . import spatial as cable_spatial
from .loads import seabed_support
from .midpoint_stencils import stencils

MAX_STRAIN = 0.3  # strain; chain breaks at 0.01, polyester at 0.15, nylon near 0.3
_FEWEST = 20  # nodes below which coarser ones save nothing
_SMALL_TURN = 0.02  # rad in a cell, up to which a hold of the fairlead feeds no wave that the water damps
_MOST_NODES = 10**6  # of a mesh; a state then takes 50 MB
_IN_PLANE = 1e-12  # out-of-plane parts below this share of a vector come from rounding its direction


def cable_system(scene, nodes=50, *, mesh=None, fields="auto", motion=None, source=None) -> CableSystem:
    """The line of a scene on ``nodes`` nodes, as a ChainSystem for solve_static, solve_time_domain, solve_periodic.

    mesh: unstretched arc lengths (N,) of the nodes in m, from 0 to the length, or None: uniform.
    fields: "planar" (eps, u, v, phi), "spatial" (+ w, theta), or "auto": planar when current and motion lie in the
    line's vertical plane. z is added when the scene has a seabed.
    motion: displacement(t) and velocity(t), (3, *S) in m and m/s, in place of the scene's.
    source: t -> (n_f, N, *S), right-hand side added to the equations, for manufactured solutions.
    Raises InputError naming the field for anything missing or out of range.
    """
    motion = scene.motion if motion is None else motion
    return CableSystem(scene, _mesh(nodes, mesh, scene.length), _planar(fields, scene, motion), motion, source)


class CableSystem(ChainSystem):
    """See ``cable_system``. ``s`` (N,) in m, ``fields``, ``axes`` (2 or 3, 3): (up, along[, out]) in x, y, z."""

    def __init__(self, scene, s, planar, motion, source=None):
        cable, environment = scene.cable, scene.environment
        for name in ("diameter", "mass_per_length"):
            if getattr(cable, name) is None:
                raise InputError(f"{name}: not given, and dynamics needs it ({'m' if name == 'diameter' else 'kg/m'})")
        self.scene, self.s, self.motion, self.source = scene, s, motion, source
        self._stencils = None  # of ``fourth_order``
        self.period = getattr(motion, "period", None)
        self.ds = np.diff(s)
        self.nodes, self.planar = s.size, planar
        self.axes = _axes(scene)[: 2 if planar else 3]
        self.anchor = np.array(scene.anchor)
        self.chord = self.axes @ (np.array(scene.fairlead) - self.anchor)

        d, rho = cable.diameter, environment.rho
        self.EA, self.beta, self.m = cable.EA, cable.damping, cable.mass_per_length
        self.w0 = cable.weight_in(environment)
        self.ma = cable.added_mass(environment)
        self.drag_t = 0.5 * rho * math.pi * d * cable.Cdt
        self.drag_n, self.drag_b = 0.5 * rho * d * cable.Cdn, 0.5 * rho * d * cable.Cdb
        flow = self.axes @ np.array(environment.current)
        self.current = flow if np.any(flow) else None
        self.inertia = (1 + cable.Ca) * rho * cable.area  # C_m rho pi d^2 / 4
        self.has_seabed, self.seabed_stiffness = environment.depth is not None, environment.seabed_stiffness
        if self.has_seabed and environment.seabed_stiffness is None:
            raise InputError(
                "seabed_stiffness: not given (N/m^2), and a line over a seabed (depth is set) needs it in dynamics; "
                f"{self.w0 / (0.1 * d):.3g} N/m^2 lets a resting line sink a tenth of its diameter"
            )
        if self.has_seabed and self.anchor[2] < -environment.depth:
            raise InputError(f"anchor: z = {self.anchor[2]:g} m is below the seabed, z = {-environment.depth:g} m")
        self.fields = self._rows.FIELDS + (("z",) if self.has_seabed else ())
        self.dimension = len(self.axes)
        self.start_rows = self.dimension + self.has_seabed
        self._start = np.zeros((self.start_rows, len(self.fields)))
        self._start[: self.dimension, 1 : 1 + self.dimension] = np.eye(self.dimension)
        self._start[self.dimension :, -1] = 1.0

    @property
    def _rows(self):
        """The equations for these fields; a module, which an attribute of a system to be pickled cannot be."""
        return cable_planar if self.planar else cable_spatial

    def support(self, z):
        """What the seabed carries at the heights z, HB 2.5, and its d/dz; N/m.

        The rows take it at the mean height of a cell: a force of that height alone has a potential, as the ground has.
        The mean of what two nodes get has none where only one of them touches, and waves there would grow from nothing.
        """
        return seabed_support(self.seabed_stiffness, self.scene.environment.depth, z)

    def start(self, y, ydot, t, tangents=True) -> Residual:
        """Anchor at rest, (42), and at its height on a seabed."""
        value = y[1 : 1 + self.start_rows, 0].copy()
        if self.has_seabed:
            value[-1] = y[-1, 0] - self.anchor[2]
        if not tangents:
            return Residual(value)
        J = np.broadcast_to(_over(self._start, y), (*self._start.shape, *y.shape[2:]))
        return Residual(value, J, np.zeros_like(J))

    def cells(self, y, ydot, t, tangents=True) -> Residual:
        """Rows 1, 2, (3), 4, 5, (6), (z) of the box scheme (39), less the source."""
        if self._stencils is not None and not tangents:
            return Residual(self._middle(y, ydot, t))
        rows = self._rows.cells(self, y, ydot, tangents)
        if self.source is not None:
            q = self.source(t)
            np.subtract(rows.value, q[:, 1:] + q[:, :-1], out=rows.value)
        return rows if self._stencils is None else Residual(self._middle(y, ydot, t), rows.dy, rows.dydot)

    def _middle(self, y, ydot, t):
        """Twice the equations in the middles of the cells, less the source, y and y_s there from four nodes."""
        to = self._stencils
        (middle, slope), n = to(np.concatenate([y, ydot]), to.value, to.slope), len(y)
        F = 2 * self._rows.point(self, middle[:n], middle[n:], slope[:n], slope[n:])
        return F if self.source is None else F - 2 * to(self.source(t), to.value)[0]

    @property
    def corrected(self) -> bool:
        """Whether this is a cable of ``fourth_order``."""
        return self._stencils is not None

    def fourth_order(self) -> CableSystem:
        """The same cable about the same rest, its cells of fourth order in ds, with the tangents of the box scheme."""
        finer = copy.copy(self)
        finer._equilibrium, finer._stencils = self.rest_state(), stencils(self.s)
        vars(finer).pop("_weights", None)  # of the box scheme
        return finer

    def end(self, y, ydot, t, tangents=True, correction=None) -> Residual:
        """Fairlead velocity is the prescribed one, (43)-(45), plus the ``correction`` (n_d, *S)."""
        value, slope = self._rows.velocity(y[:, -1], tangents)
        if self.motion is not None:
            value = value - self.axes @ self.motion.velocity(t)
        if correction is not None:
            value = value - correction
        return Residual(value, slope, np.zeros_like(slope) if tangents else None)

    def ramped(self, duration) -> CableSystem:
        """The same cable, its motion grown from rest over a duration in s."""
        if self.motion is None:
            return self
        ramped = copy.copy(self)
        ramped.motion = Ramped(self.motion, duration)
        return ramped

    def scaled(self, share) -> CableSystem:
        """The same cable with its motion multiplied by a number."""
        scaled = copy.copy(self)
        scaled.motion = self.motion.scaled(share)
        return scaled

    def coarser(self):
        """The cable on every second node, about the same rest; splines between its nodes."""
        if self.nodes < _FEWEST:
            return None
        at = np.append(np.arange(0, self.nodes - 1, 2), self.nodes - 1)
        coarse = CableSystem(self.scene, self.s[at], self.planar, self.motion)
        coarse._equilibrium = self.rest_state()[:, at]
        coarse._following = self._following and tuple(part[..., at] for part in self._following)
        if self.source is not None:
            coarse.source = lambda t: self.source(t)[:, at]
        return coarse, lambda z: make_interp_spline(coarse.s, z, axis=1)(self.s)

    def quasi_static_predictor(self, t) -> np.ndarray | None:
        """The equilibrium as it follows the fairlead, linearised, with the velocities of that.

        With a source, which takes the line elsewhere, the velocities alone: what drag needs.
        """
        if self.motion is None or self._following is None:
            return None
        state, place = self._following
        turn = self._rows.velocity(self.rest_state())[1][:, 1 : 1 + self.dimension]  # a rotation
        moved, rate = self.axes @ self.motion.displacement(t), self.axes @ self.motion.velocity(t)
        y = self.rest_state()[..., None] + np.einsum("afn,at->fnt", state, moved * (self.source is None))
        y[1 : 1 + self.dimension] = np.einsum("dcn,adn,at->cnt", turn, place, rate)
        return y

    def mirror(self) -> tuple[tuple[int, ...], ...] | None:
        """Reflection at the plane of the line: w, theta, row 3, row 6 and the sideways velocity change sign."""
        if self.planar:
            return None
        z = (1,) * self.has_seabed
        return (1, 1, 1, -1, 1, -1, *z), (1, 1, -1, *z), (1, 1, -1, 1, 1, -1, *z), (1, 1, -1)

    def invalid(self, y) -> tuple[Status, int] | None:
        """A cable carries no compression, and the equations are ill-posed there (HB reference [53]); it breaks, too."""
        least, most = (np.unravel_index(at, y[0].shape) for at in (y[0].argmin(), y[0].argmax()))
        if y[0][least] < 0:
            return Status.COMPRESSION, int(least[0])
        return (Status.OVERSTRETCHED, int(most[0])) if y[0][most] > MAX_STRAIN else None

    def scale(self) -> np.ndarray:
        """The largest strain at rest; 1 m/s, 1 rad, 1 m."""
        scale = np.ones(len(self.fields))
        scale[0] = abs(self.rest_state()[0]).max()
        return scale

    def rest_state(self) -> np.ndarray:
        """The discrete equilibrium of this mesh, (n_f, N)."""
        return self._equilibrium

    @cached_property
    def _equilibrium(self):
        from .statics import solve_static  # statics knows this module

        return solve_static(self).y

    @cached_property
    def _following(self):
        from .statics import follow  # statics knows this module

        return follow(self)

    def settling_time(self) -> float:
        """An axial wave passes five cells and comes back."""
        return 10 * float(self.ds.max()) / math.sqrt(self.EA / self.m)

    def drift_gain(self) -> float:
        """By the square of the line's turn in a cell: to that, velocities and places of the nodes agree at a bend."""
        y = self.rest_state()
        turn = np.diff(self._rows.stretched_tangent(y, False)[0] / (1 + y[0]), axis=-1)
        return min(1.0, float(_SMALL_TURN**2 / max((turn**2).sum(axis=0).max(), _SMALL_TURN**2)))

    def drift(self, y, t) -> np.ndarray:
        """Integral of (1 + eps) t ds less the prescribed place of the fairlead, (2 or 3, *S), m."""
        straight = _over(self.chord[:, None] / self.s[-1], y)  # taken off at the nodes: smaller sums round less
        away = np.einsum("dn...,n->d...", self._rows.stretched_tangent(y, False)[0] - straight, self._weights)
        return away - (0.0 if self.motion is None else self.axes @ self.motion.displacement(t))

    def drift_tangent(self, y) -> np.ndarray:
        """d(drift)/dy, (2 or 3, n_f, N, *S)."""
        return self._rows.stretched_tangent(y)[1] * _over(self._weights, y)

    @cached_property
    def _weights(self):
        """Trapezoidal rule on the mesh: the integral that the box scheme's position rows make; or of fourth order."""
        weights = np.zeros(self.nodes)
        if self._stencils is not None:
            np.add.at(weights, self._stencils.at, self._stencils.integral)
            return weights
        weights[1:] += self.ds / 2
        weights[:-1] += self.ds / 2
        return weights

    def stretched_tangent(self, y):
        """(1 + eps) t of the nodes in (up, along[, out]) and d/dy: (n_d, N, *S), (n_d, n_f, N, *S)."""
        return self._rows.stretched_tangent(y)

    def tension(self, y, ydot=None) -> np.ndarray:
        """EA (eps + beta eps_t), (N, *S), N."""
        return self.EA * (y[0] if ydot is None else y[0] + self.beta * ydot[0])

    def positions(self, y) -> np.ndarray:
        """Places of the nodes in the public frame, (3, N, *S), m: anchor plus the integral of (1 + eps) t ds."""
        step, to = self._rows.stretched_tangent(y, False)[0], self._stencils
        step = (step[:, 1:] + step[:, :-1]) * _over(self.ds / 2, y) if to is None else to(step, to.integral)[0]
        local = np.concatenate([np.zeros_like(step[:, :1]), np.cumsum(step, axis=1)], axis=1)
        return np.einsum("dc,dn...->cn...", self.axes, local) + _over(self.anchor[:, None], y)

    def direction(self, y) -> np.ndarray:
        """Unit tangent of the nodes in the public frame, (3, N, *S)."""
        return np.einsum("dc,dn...->cn...", self.axes, self._rows.stretched_tangent(y, False)[0] / (1 + y[0]))


def _over(array, y):
    """The array with the axes of the samples of y appended."""
    return array.reshape(*array.shape, *(1,) * (y.ndim - 2))


def _axes(scene) -> np.ndarray:
    """(up, along, out) as rows; along points from anchor to fairlead, or along x where the line is vertical."""
    dx, dy = (b - a for a, b in zip(scene.anchor[:2], scene.fairlead[:2], strict=True))
    span = math.hypot(dx, dy)
    cx, cy = (dx / span, dy / span) if span > 0 else (1.0, 0.0)
    return np.array([[0.0, 0.0, 1.0], [cx, cy, 0.0], [-cy, cx, 0.0]])


def _planar(fields, scene, motion) -> bool:
    one_of("fields", fields, ("auto", "planar", "spatial"))
    if motion is not None and not callable(getattr(motion, "velocity", None)):
        raise InputError(f"motion: {motion!r} is no Motion, SampledMotion or FunctionMotion")
    if fields == "spatial":
        return False
    out = _axes(scene)[2]
    current = np.array(scene.environment.current)
    moves = np.zeros((1, 3)) if motion is None else np.asarray(motion.directions())
    planar = all(np.all(abs(vector @ out) <= _IN_PLANE * np.linalg.norm(vector)) for vector in (current, *moves))
    if fields == "planar" and not planar:
        raise InputError("fields: 'planar', but the current or the motion leaves the line's vertical plane")
    return planar


def _mesh(nodes, mesh, length) -> np.ndarray:
    if mesh is None:
        if isinstance(nodes, bool) or not isinstance(nodes, (int, np.integer)) or not 3 <= nodes <= _MOST_NODES:
            raise InputError(f"nodes: {nodes!r} must be a whole number from 3 to {_MOST_NODES}")
        return np.linspace(0.0, length, nodes)
    try:
        s = real_array(mesh)
    except (TypeError, ValueError):
        raise InputError(f"mesh: {mesh!r} must be arc lengths (m)") from None
    if s.ndim != 1 or s.size < 3 or not np.isfinite(s).all() or not (np.diff(s) > 0).all():
        raise InputError(f"mesh: must be three or more finite, increasing arc lengths (m), given {mesh!r}")
    if s[0] != 0 or abs(s[-1] - length) > 1e-12 * length:
        raise InputError(f"mesh: runs from {s[0]:g} to {s[-1]:g} m, it must run from 0 to the length, {length:g} m")
    return s
