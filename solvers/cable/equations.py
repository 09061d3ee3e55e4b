"""The cable as a chain: governing equations HB (1)-(12) on the box scheme (39), for the fields that the scene needs.

F = M(y) y_t + K(y) y_s + f(y) summed over the two nodes of a cell, in total form; the equations are in theory.md.
Structural damping is Kelvin-Voigt, T = EA (eps + beta d(eps)/dt), beta in s (the paper's beta in (1) is a misprint).
Inside, vectors are (up, along, out): HB's X, Y, Z with Y from the anchor towards the fairlead.
"""

from __future__ import annotations

import math
from typing import Any, Self

import numpy as np

from ..common.outcome import InputError, Status
from ..common.properties import MAX_STRAIN, missing_seabed_stiffness
from ..numerics.chain import ChainSystem, Residual
from . import planar as planar_equations
from . import spatial as spatial_equations
from .loads import seabed_support
from .mesh import trapezoidal_weights
from .midpoint_stencils import midpoint_stencils


class CableEquations(ChainSystem):
    """The equations of the line of a scene on the nodes ``s`` (N,), m; ``axes`` (2 or 3, 3): (up, along[, out]).

    planar: whether the fields are those of motion in the line's vertical plane. motion, source: as in ``cable_system``.
    period in s: that of the motion unless given. current (2 or 3,) in m/s along the axes, and seabed_stiffness in
    N/m^2: those of the scene unless given.
    order: 2, the box scheme, or 4: cells of fourth order in ds, with the tangents of the box scheme.
    """

    _ARGUMENTS = ("scene", "s", "planar", "motion", "source", "period", "current", "seabed_stiffness", "order")

    def __init__(
        self, scene, s, planar, motion=None, source=None, *, period=None, current=None, seabed_stiffness=None, order=2
    ):
        cable, environment = scene.cable, scene.environment
        for name, unit in (("diameter", "m"), ("mass_per_length", "kg/m")):
            if getattr(cable, name) is None:
                raise InputError(f"not given, and dynamics needs it ({unit})", field=name, unit=unit)
        self.scene, self.s, self.motion, self.source, self.order = scene, s, motion, source, order
        self.stencils: Any = midpoint_stencils(s) if order == 4 else None
        self.period = getattr(motion, "period", None) if period is None else period
        self.ds = np.diff(s)
        self.nodes, self.planar = s.size, planar
        self.axes = line_axes(scene)[: 2 if planar else 3]
        self.anchor = np.array(scene.anchor)
        self.chord = self.axes @ (np.array(scene.fairlead) - self.anchor)
        self.dimension = len(self.axes)
        self._set_loads(cable, environment, current, seabed_stiffness)
        self.fields = self.equations.FIELDS + (("z",) if self.has_seabed else ())
        self.start_rows = self.dimension + self.has_seabed
        self._start_tangent = np.zeros((self.start_rows, len(self.fields)))
        self._start_tangent[: self.dimension, 1 : 1 + self.dimension] = np.eye(self.dimension)
        self._start_tangent[self.dimension :, -1] = 1.0
        self._quadrature = self.stencils.quadrature() if self.stencils else trapezoidal_weights(self.ds)

    def _set_loads(self, cable, environment, current, seabed_stiffness):
        """Set stiffness, masses, coefficients of drag and current, and the seabed."""
        d, rho = cable.diameter, environment.rho
        self.EA, self.beta, self.m = cable.EA, cable.damping, cable.mass_per_length
        self.w0 = cable.weight_in(environment)
        self.ma = cable.added_mass(environment)
        self.drag_t = 0.5 * rho * math.pi * d * cable.Cdt
        self.drag_n, self.drag_b = 0.5 * rho * d * cable.Cdn, 0.5 * rho * d * cable.Cdb
        flow = self.axes @ np.array(environment.current) if current is None else current
        self.current = flow if np.any(flow) else None
        self.inertia = (1 + cable.Ca) * rho * cable.area  # C_m rho pi d^2 / 4
        self.has_seabed = environment.depth is not None
        self.seabed_stiffness = environment.seabed_stiffness if seabed_stiffness is None else seabed_stiffness
        if self.has_seabed and environment.seabed_stiffness is None:
            raise missing_seabed_stiffness("a moving line", d)
        if self.has_seabed and self.anchor[2] < -environment.depth:
            problem = f"z = {self.anchor[2]:g} m is below the seabed, z = {-environment.depth:g} m"
            raise InputError(problem, field="anchor", value=self.scene.anchor, unit="m")

    def replace(self, **changes) -> Self:
        """Return the same cable with other arguments of its constructor; another motion brings its own period."""
        kept = [name for name in self._ARGUMENTS if not (name == "period" and "motion" in changes)]
        return type(self)(**{name: getattr(self, name) for name in kept} | changes)

    def on_mesh(self, s) -> CableEquations:
        """Return the same cable on the nodes s (N,), m."""
        return self.replace(s=s)

    @property
    def equations(self):
        """The module with the equations for these fields; not an attribute, for modules cannot be pickled."""
        return planar_equations if self.planar else spatial_equations

    @property
    def is_fourth_order(self) -> bool:
        """True for a cable of ``fourth_order``."""
        return self.order == 4

    # ------------------------------------------------------------ rows
    def support(self, z):
        """Return the seabed's support at the heights z, HB 2.5, and its d/dz; N/m.

        Evaluating the support at the mean height of a cell keeps it conservative. The mean of the supports of two
        nodes has no potential where only one of them touches, and waves there would grow from nothing.
        """
        return seabed_support(self.seabed_stiffness, self.scene.environment.depth, z)

    def start(self, y, ydot, t, tangents=True) -> Residual:
        """Return the rows of the anchor: it is at rest, (42), and at its height on a seabed."""
        value = y[1 : 1 + self.start_rows, 0].copy()
        if self.has_seabed:
            value[-1] = y[-1, 0] - self.anchor[2]
        if not tangents:
            return Residual(value)
        J = np.broadcast_to(append_sample_axes(self._start_tangent, y), (*self._start_tangent.shape, *y.shape[2:]))
        return Residual(value, J, np.zeros_like(J))

    def cells(self, y, ydot, t, tangents=True) -> Residual:
        """Return the rows 1, 2, (3), 4, 5, (6), (z) of the box scheme (39), less the source."""
        if self.is_fourth_order and not tangents:
            return Residual(self._midpoint_residual(y, ydot, t))
        rows = self._box_scheme(y, ydot, tangents)
        if self.source is not None:
            q = self.source(t)
            np.subtract(rows.value, q[:, 1:] + q[:, :-1], out=rows.value)
        return rows._replace(value=self._midpoint_residual(y, ydot, t)) if self.is_fourth_order else rows

    def _box_scheme(self, y, ydot, tangents) -> Residual:
        """Return the rows (39), without a source."""
        equations, n, ds = self.equations, self.dimension, append_sample_axes(self.ds, y)
        a, T, by, bt = equations.local_terms(self, y, ydot, tangents)
        D = (y[:, 1:] - y[:, :-1]) / ds  # y_s
        sums = [q[1:] + q[:-1] for q in equations.stiffness_coefficients(y, T)]  # twice the mean
        F = a[:, 1:] + a[:, :-1]
        equations.add_stiffness(F, sums, D, 2 * (T[1:] - T[:-1]) / ds, 2)
        if self.has_seabed:
            support, support_z = self.support((y[-1, 1:] + y[-1, :-1]) / 2)
            (up, *_), (up_by_angles, *_) = equations.frame(y)
            S_up = up[:, 1:] + up[:, :-1]
            F[:n] += support * S_up
            F[-1] += 2 * D[-1]
        if not tangents:
            return Residual(F)

        J, Jt = (np.stack([part[:, :, :-1], part[:, :, 1:]]) for part in (by, bt))
        for side, per, at in ((0, -1 / ds, slice(None, -1)), (1, 1 / ds, slice(1, None))):
            by_tension = equations.add_stiffness_tangents(J[side], y[:, at], T[at], sums, D, per)
            for row, by_T in enumerate(by_tension):
                J[side, row, 0] += self.EA * by_T
                if self.beta:
                    Jt[side, row, 0] += self.EA * self.beta * by_T
            if self.has_seabed:
                J[side, :n, 1 + n : 2 * n] += support * up_by_angles[:, :, at]
                J[side, :n, -1] += support_z / 2 * S_up
                J[side, -1, -1] += 2 * per
        return Residual(F, J, Jt)

    def point(self, y, ydot, y_s, ydot_s):
        """Return M y_t + K y_s + f at points of the cable, all (n_f, n, *S)."""
        F, T, *_ = self.equations.local_terms(self, y, ydot, False)
        T_s = self.EA * (y_s[0] + self.beta * ydot_s[0])
        self.equations.add_stiffness(F, self.equations.stiffness_coefficients(y, T), y_s, T_s, 1)
        if self.has_seabed:
            F[: self.dimension] += self.support(y[-1])[0] * self.equations.frame(y, False)[0][0]
            F[-1] += y_s[-1]
        return F

    def _midpoint_residual(self, y, ydot, t):
        """Return twice the equations at the cells' midpoints, less the source; y and y_s there from four nodes."""
        stencils = self.stencils
        (value, slope), n = stencils(np.concatenate([y, ydot]), stencils.value, stencils.slope), len(y)
        F = 2 * self.point(value[:n], value[n:], slope[:n], slope[n:])
        return F if self.source is None else F - 2 * stencils(self.source(t), stencils.value)[0]

    def end(self, y, ydot, t, tangents=True, correction=None) -> Residual:
        """Return the velocity of the fairlead less the prescribed one, (43)-(45), less the ``correction`` (n_d, *S)."""
        value, tangent = self.velocity(y[:, -1], tangents)
        if self.motion is not None:
            value = value - self.axes @ self.motion.velocity(t)
        if correction is not None:
            value = value - correction
        return Residual(value, tangent, np.zeros_like(tangent) if tangents else None)

    # ------------------------------------------------------------ kinematics
    def velocity(self, y, tangents=True):
        """Return the velocity of the nodes along the axes, (n_d, *shape), (43)-(45); and d/dy (n_d, n_f, *shape)."""
        n, (frame, by_angles) = self.dimension, self.equations.frame(y, tangents)
        value = np.einsum("ij...,j...->i...", frame, y[1 : 1 + n])
        if not tangents:
            return value, None
        by_y = np.zeros((n, *y.shape), dtype=y.dtype)
        by_y[:, 1 : 1 + n] = frame
        by_y[:, 1 + n : 2 * n] = np.einsum("ija...,j...->ia...", by_angles, y[1 : 1 + n])
        return value, by_y

    def stretched_tangent(self, y, tangents=True):
        """Return (1 + eps) t of the nodes along the axes, (n_d, *shape); and d/dy (n_d, n_f, *shape)."""
        n, (frame, by_angles), stretch = self.dimension, self.equations.frame(y, tangents), 1 + y[0]
        if not tangents:
            return stretch * frame[:, 0], None
        by_y = np.zeros((n, *y.shape), dtype=y.dtype)
        by_y[:, 0], by_y[:, 1 + n : 2 * n] = frame[:, 0], stretch * by_angles[:, 0]
        return stretch * frame[:, 0], by_y

    # ------------------------------------------------------------ what holds for a state
    def mirror(self) -> tuple[tuple[int, ...], ...] | None:
        """Return the signs under a reflection at the plane of the line, None for planar fields.

        w, theta, rows 3 and 6 and the sideways velocity of the end change theirs.
        """
        if self.planar:
            return None
        z = (1,) * self.has_seabed
        return (1, 1, 1, -1, 1, -1, *z), (1, 1, -1, *z), (1, 1, -1, 1, 1, -1, *z), (1, 1, -1)

    def invalid(self, y) -> tuple[Status, int] | None:
        """Return a status and a node where a cable is compressed, and the equations ill-posed (HB [53]), or torn."""
        least, most = (np.unravel_index(at, y[0].shape) for at in (y[0].argmin(), y[0].argmax()))
        if y[0][least] < 0:
            return Status.COMPRESSION, int(least[0])
        return (Status.OVERSTRETCHED, int(most[0])) if y[0][most] > MAX_STRAIN else None

    # ------------------------------------------------------------ outputs, in the public frame
    def tension(self, y, ydot=None) -> np.ndarray:
        """Return EA (eps + beta eps_t), (N, *S), N; without ydot the elastic part."""
        return self.EA * (y[0] if ydot is None else y[0] + self.beta * ydot[0])

    def positions(self, y) -> np.ndarray:
        """Return the positions of the nodes, (3, N, *S), m: anchor plus the integral of (1 + eps) t ds."""
        tangent, stencils = self.stretched_tangent(y, False)[0], self.stencils
        if stencils is None:
            steps = (tangent[:, 1:] + tangent[:, :-1]) * append_sample_axes(self.ds / 2, y)
        else:
            steps = stencils(tangent, stencils.integral)[0]
        local = np.concatenate([np.zeros_like(steps[:, :1]), np.cumsum(steps, axis=1)], axis=1)
        return np.einsum("dc,dn...->cn...", self.axes, local) + append_sample_axes(self.anchor[:, None], y)

    def direction(self, y) -> np.ndarray:
        """Return the unit tangent of the nodes, (3, N, *S)."""
        return np.einsum("dc,dn...->cn...", self.axes, self.equations.frame(y, False)[0][:, 0])

    # ------------------------------------------------------------ the position of the fairlead
    def drift(self, y, t) -> np.ndarray:
        """Return the integral of (1 + eps) t ds less the prescribed position of the fairlead, (2 or 3, *S), m."""
        chord = append_sample_axes(self.chord[:, None] / self.s[-1], y)  # subtracted at nodes: smaller sums round less
        offset = np.einsum("dn...,n->d...", self.stretched_tangent(y, False)[0] - chord, self._quadrature)
        return offset - (0.0 if self.motion is None else self.axes @ self.motion.displacement(t))

    def drift_tangent(self, y) -> np.ndarray:
        """Return d(drift)/dy, (2 or 3, n_f, N, *S)."""
        return self.stretched_tangent(y)[1] * append_sample_axes(self._quadrature, y)


def append_sample_axes(array, y):
    """Return the array with the axes of the samples of y (n_f, N, *S) appended, each of length one."""
    return array.reshape(*array.shape, *(1,) * (y.ndim - 2))


def line_axes(scene) -> np.ndarray:
    """Return (up, along, out) as rows; along points from anchor to fairlead, or along x where the line is vertical."""
    dx, dy = (b - a for a, b in zip(scene.anchor[:2], scene.fairlead[:2], strict=True))
    span = math.hypot(dx, dy)
    cx, cy = (dx / span, dy / span) if span > 0 else (1.0, 0.0)
    return np.array([[0.0, 0.0, 1.0], [cx, cy, 0.0], [-cy, cx, 0.0]])
