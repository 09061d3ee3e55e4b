"""The cable that the solvers take: its equations, the equilibrium it moves from, and the same cable changed."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import make_interp_spline

from ..common.diagnostics import check_drag
from ..common.motions.motion import Ramped
from ..common.outcome import InputError
from ..common.types import Movement
from ..common.validation import one_of
from .equations import CableEquations, line_axes
from .mesh import check_mesh, every_second_node
from .statics import StaticState, solve_static

_MIN_NODES = 20  # below which a coarser mesh saves nothing
_SMALL_TURN = 0.02  # rad in a cell, up to which a drift correction feeds no wave that the water damps
_IN_PLANE = 1e-12  # out-of-plane parts below this share of a vector come from rounding its direction


def cable_system(
    scene,
    nodes: int = 50,
    *,
    mesh: ArrayLike | None = None,
    fields: str = "auto",
    motion: Movement | None = None,
    source: Callable[[ArrayLike], np.ndarray] | None = None,
) -> CableSystem:
    """Return the line of a scene on ``nodes`` nodes, for solve_static, solve_time_domain and solve_periodic.

    scene: a Scene; of another object its cable (CableProperties), environment (Environment), length in m, anchor and
    fairlead (3,) in m, and motion are taken.
    mesh: unstretched arc lengths (N,) of the nodes in m, from 0 to the length, or None: uniform.
    fields: "planar" (eps, u, v, phi), "spatial" (+ w, theta), or "auto": planar when current and motion lie in the
    line's vertical plane. z is added when the scene has a seabed.
    motion: displacement(t) and velocity(t), (3, *S) in m and m/s, in place of the scene's.
    source: t -> (n_f, N, *S), right-hand side added to the equations, for manufactured solutions.
    Raises InputError naming the field for anything missing or out of range.

    >>> chain = CableProperties(EA=384.243e6, diameter=0.09, mass_per_length=77.7066, Cdn=1.6)
    >>> scene = Scene("my line", chain, 902.2, (0.0, 0.0, -320.0), (848.67, 0.0, -70.0))
    >>> cable_system(scene, nodes=20).fields
    ('eps', 'u', 'v', 'phi')
    """
    if not hasattr(scene, "length"):
        problem = f"{type(scene).__name__} is no Scene; mooring_system takes a Network, too"
        raise InputError(problem, field="scene", value=scene)
    motion = scene.motion if motion is None else motion
    return CableSystem(scene, check_mesh(nodes, mesh, scene.length), _is_planar(fields, scene, motion), motion, source)


class CableSystem(CableEquations):
    """``CableEquations`` with the equilibrium that a motion starts from; see ``cable_system``."""

    def __init__(self, *arguments, equilibrium=None, **options):
        """As CableEquations; equilibrium: that of a cable with the same one, None: solved for when first asked."""
        super().__init__(*arguments, **options)
        if equilibrium is not None:
            self.equilibrium = equilibrium

    @cached_property
    def equilibrium(self) -> StaticState:
        """The discrete equilibrium."""
        return solve_static(self)

    @property
    def needs_mesh_check(self) -> bool:  # type: ignore[override]
        """True over a seabed: where the line touches down, a mesh that is fine elsewhere may be far too coarse."""
        return bool(self.has_seabed and self.seabed_stiffness)

    # ------------------------------------------------------------ the same cable, changed
    def replace(self, **changes) -> Self:
        """Return the same cable with other arguments of its constructor; another motion keeps the equilibrium."""
        kept = {} if changes.keys() - {"motion", "period", "order"} else {"equilibrium": self.equilibrium}
        return super().replace(**kept | changes)

    def ramped(self, duration) -> CableSystem:
        """Return the same cable, its motion grown from rest over a duration in s."""
        if self.motion is None:
            return self
        return self.replace(motion=Ramped(self.motion, duration), period=self.period)

    def scaled(self, load_factor) -> CableSystem:
        """Return the same cable with its motion multiplied by a number."""
        return self.replace(motion=self.motion.scaled(load_factor))  # type: ignore[attr-defined]

    def fourth_order(self) -> CableSystem:
        """Return the same cable about the same rest, its cells of fourth order in ds, tangents of the box scheme."""
        return self.replace(order=4)

    def coarser(self):
        """Return the cable on every second node about the same rest, and cubic splines between its nodes, or None."""
        if self.nodes < _MIN_NODES:
            return None
        nodes, source = every_second_node(self.nodes), self.source
        coarse = self.replace(
            s=self.s[nodes],
            source=source and (lambda t: source(t)[:, nodes]),
            equilibrium=replace(self.equilibrium, y=self.rest_state()[:, nodes]),
        )
        return coarse, lambda z: make_interp_spline(coarse.s, z, axis=1)(self.s)

    # ------------------------------------------------------------ about the equilibrium
    def rest_state(self) -> np.ndarray:
        """Return the discrete equilibrium of this mesh, (n_f, N)."""
        return self.equilibrium.y

    def rest_warnings(self) -> tuple[str, ...]:
        """Return ``input_warnings``, and one where the pretension is off that of the exact catenary."""
        return tuple(dict.fromkeys((*self.input_warnings(), *self.equilibrium.warnings)))

    def input_warnings(self) -> tuple[str, ...]:
        """Return what is suspected in the scene, no drag across the line, and friction that the rows do not carry."""
        scene, friction = self.scene, max(getattr(self.scene, "friction", ()), default=0.0)
        suspected = list(getattr(scene, "warnings", ()))
        suspected += check_drag([scene.cable], self.motion is not None, scene.environment.current)
        if friction > 0 and self.needs_mesh_check:
            suspected.append(f"friction: {friction:g} of the seabed is not in these equations, the line slides freely")
        return tuple(dict.fromkeys(suspected))

    def predict_motion(self, t) -> np.ndarray | None:
        """Return the equilibrium, (n_f, N, S), with velocities that grow from the anchor to the fairlead's, or None."""
        if self.motion is None:
            return None
        rest, velocities = self.rest_state(), slice(1, 1 + self.dimension)
        rotation = self.equations.frame(rest, False)[0]
        y = np.repeat(rest[..., None], np.size(t), axis=2)
        rate = self.axes @ self.motion.velocity(t)
        y[velocities] = np.einsum("dcn,n,dt->cnt", rotation, self.s / self.s[-1], rate)
        return y

    def scale(self) -> np.ndarray:
        """Return the largest strain at rest; 1 m/s, 1 rad, 1 m."""
        scale = np.ones(len(self.fields))
        scale[0] = abs(self.rest_state()[0]).max()
        return scale

    def settling_time(self) -> float:
        """Return the time in s in which an axial wave passes five cells and comes back."""
        return 10 * float(self.ds.max()) / math.sqrt(self.EA / self.m)

    def drift_gain(self) -> float:
        """Return a gain that falls with the squared tangent rotation per cell.

        Velocities and positions of the nodes agree only to that square at a bend, so a full correction excites waves.
        """
        y = self.rest_state()
        turn = np.diff(self.equations.frame(y, False)[0][:, 0], axis=-1)
        return min(1.0, float(_SMALL_TURN**2 / max((turn**2).sum(axis=0).max(), _SMALL_TURN**2)))


def _is_planar(fields, scene, motion) -> bool:
    one_of("fields", fields, ("auto", "planar", "spatial"))
    if motion is not None and not callable(getattr(motion, "velocity", None)):
        raise InputError(f"{motion!r} is no Motion, SampledMotion or FunctionMotion", field="motion", value=motion)
    if fields == "spatial":
        return False
    out = line_axes(scene)[2]
    current = np.array(scene.environment.current)
    directions = np.zeros((1, 3)) if motion is None else np.asarray(motion.directions())
    planar = all(np.all(abs(vector @ out) <= _IN_PLANE * np.linalg.norm(vector)) for vector in (current, *directions))
    if fields == "planar" and not planar:
        problem = "'planar', but the current or the motion leaves the line's vertical plane"
        raise InputError(problem, field="fields", value=fields)
    return planar
