"""Prescribed motion of a rigid body in six degrees of freedom, and of the points that it carries.

Surge, sway and heave (m) are the displacement of a reference point in x, y, z; roll, pitch and yaw (rad) turn the body
about it by R = Rz(yaw) Ry(pitch) Rx(roll), exact at any angle: about the earth-fixed axes of the public frame roll is
taken first, then pitch, then yaw. A point at p in the mean place of the body is displaced by s(t) + (R(t) - 1) (p -
reference). t may be complex where it may be in both parts: a complex step passes through.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import reduce
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..outcome import InputError
from ..types import Movement, Vector
from ..validation import real_number, vector
from .motion import Motion, Ramped, trajectory
from .motion_arrays import as_times, check_finite, read_only_array, spanning_vectors

UNITS = ("m", "m", "m", "rad", "rad", "rad")
"""Of surge, sway, heave, roll, pitch and yaw."""

_SAME_RATIO = 1e-9  # relative: two frequencies written with ten digits are multiples of each other to this
_ZEROS = (0.0,) * 6


@dataclass(frozen=True, eq=False)
class BodyMotion:
    """Motion of a rigid body: translation of its reference point, and rotation about it.

    translation and rotation : None, or a motion as solvers.common.motions.motion describes; the displacement of
    rotation is roll, pitch, yaw in rad, its velocity in rad/s
    reference : (3,) m, the mean position of the reference point
    Raises InputError naming the field that is no motion, or no point, or where both parts are None.

    >>> pitch = BodyMotion.harmonic(0.1, (0, 0, 0, 0, 0.05, 0), reference=(0.0, 0.0, -10.0))
    >>> pitch.displacement([[0.0, 0.0, -30.0]], 2.5).round(4).tolist()  # m: x, y, z of one point
    [[-0.9996], [0.0], [0.025]]
    """

    translation: Movement | None
    rotation: Movement | None = None
    reference: Vector = (0.0, 0.0, 0.0)

    def __post_init__(self):
        for name in ("translation", "rotation"):
            part = getattr(self, name)
            if part is not None and not all(hasattr(part, call) for call in ("displacement", "velocity", "directions")):
                problem = f"{part!r} must be None or a motion, as solvers.Motion is"
                raise InputError(problem, field=name, value=part)
        if self.translation is None and self.rotation is None:
            raise InputError("translation and rotation are both None; one must be a motion", field="translation")
        object.__setattr__(self, "reference", vector("reference", self.reference, "m", "coordinates"))

    @classmethod
    def periodic(
        cls, frequency: float, sine: ArrayLike, cosine: ArrayLike | None = None, reference: Vector = (0.0, 0.0, 0.0)
    ) -> BodyMotion:
        """Return sum_k sine[k-1] sin(2 pi k f t) + cosine[k-1] cos(2 pi k f t) in all six: f in Hz, rows (K, 6) m, rad.

        >>> BodyMotion.periodic(0.1, [[1, 0, 0, 0, 0, 0], [0, 0, 0.2, 0, 0, 0]]).period  # s
        10.0
        """
        sine = _six_columns("sine", sine)
        cosine = np.zeros_like(sine) if cosine is None else _six_columns("cosine", cosine)
        if cosine.shape != sine.shape:
            problem = f"shape {cosine.shape} must be that of sine, {sine.shape}: one row a harmonic (m, rad)"
            raise InputError(problem, field="cosine", value=cosine, unit="m, rad")
        turns = sine[:, 3:].any() or cosine[:, 3:].any()
        rotation = Motion(frequency, sine[:, 3:], cosine[:, 3:]) if turns else None
        return cls(Motion(frequency, sine[:, :3], cosine[:, :3]), rotation, reference)

    @classmethod
    def harmonic(
        cls, frequency: float, amplitude: Vector, phase: Vector = _ZEROS, reference: Vector = (0.0, 0.0, 0.0)
    ) -> BodyMotion:
        """Return the motion amplitude sin(2 pi f t + phase): f in Hz, both (6,), m and rad, rad."""
        size, angle = _six("amplitude", amplitude, UNITS), _six("phase", phase, ("rad",) * 6)
        return cls.periodic(frequency, [size * np.cos(angle)], [size * np.sin(angle)], reference)

    @property
    def period(self) -> float | None:
        """Shortest common period of both parts, s; None where one is not periodic.

        Raises InputError where the period of neither is a whole multiple of that of the other.
        """
        periods = [getattr(part, "period", None) for part in (self.translation, self.rotation) if part is not None]
        if None in periods:
            return None
        longest, shortest = max(periods), min(periods)  # type: ignore[type-var]
        ratio = longest / shortest  # type: ignore[operator]
        if abs(ratio - round(ratio)) > _SAME_RATIO * ratio:
            problem = f"its period, {periods[1]:g} s, and that of translation, {periods[0]:g} s, have no common one: "
            raise InputError(problem + "one must be a whole multiple of the other", field="rotation", unit="s")
        return longest

    def scaled(self, factor: float) -> BodyMotion:
        """Return the same motion with all six coordinates, angles included, multiplied by a number."""
        factor = real_number("factor", factor, "(dimensionless)")
        return self._with_parts(lambda part: part.scaled(factor) if hasattr(part, "scaled") else Scaled(part, factor))

    def ramped(self, duration: float) -> BodyMotion:
        """Return the same motion, all six coordinates started from rest over a duration in s; see Ramped."""
        return self._with_parts(lambda part: Ramped(part, duration))

    def _with_parts(self, change) -> BodyMotion:
        parts = {name: getattr(self, name) for name in ("translation", "rotation")}
        return replace(self, **{name: part and change(part) for name, part in parts.items()})

    def pose(self, t: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        """Return the displacement of the reference point, m, and R: t in s, (S,) -> (3, S) and (3, 3, S).

        A number t -> (3,) and (3, 3).
        """
        t = as_times(t)
        s = self.translation.displacement(t) if self.translation else np.zeros((3, *t.shape))
        if self.rotation is None:
            return s, np.broadcast_to(np.eye(3).reshape(3, 3, *[1] * t.ndim), (3, 3, *t.shape))
        return s, np.moveaxis(_rotation(self.rotation.displacement(t)), (-2, -1), (0, 1))

    def displacement(self, points: ArrayLike, t: ArrayLike) -> np.ndarray:
        """Return the displacements, m, of points (P, 3) at their mean positions, m.

        t in s, (S,) -> (3, P, S), or a number -> (3, P).
        """
        (s, R), arms = self.pose(t), self._arms(points)
        return s[:, None] + np.einsum("ij...,pj->ip...", R, arms) - _with_times(arms.T, s)

    def trajectory(self, points: ArrayLike, t: ArrayLike) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return displacement, velocity and acceleration of points (P, 3) at their mean positions, m, m/s, m/s^2.

        t in s, (S,) -> (3, P, S) each, or a number -> (3, P) each.
        """
        t, arms = as_times(t), self._arms(points)
        still = np.zeros((3, *t.shape))
        s, v, a = trajectory(self.translation, t) if self.translation else (still, still, still)
        if self.rotation is None:
            s, v, a = (np.repeat(part[:, None], len(arms), axis=1) for part in (s, v, a))
            return s, v, a
        turns = _rotation_derivatives(*trajectory(self.rotation, t))
        arm, arm_t, arm_tt = (np.einsum("...ij,pj->ip...", R, arms) for R in turns)
        return (
            np.expand_dims(s, 1) + arm - _with_times(arms.T, s),
            np.expand_dims(v, 1) + arm_t,
            np.expand_dims(a, 1) + arm_tt,
        )

    def directions(self, points: ArrayLike) -> np.ndarray:
        """Return unit vectors (k, 3) that span the displacements of points (P, 3), m, at their mean positions.

        Exact for a rotation about one axis, x, y or z, which keeps its points in a plane; for rotations about two or
        three of them, all of space for any point off the reference point.
        """
        rows = [] if self.translation is None else [self.translation.directions()]
        turns = np.empty((0, 3)) if self.rotation is None else self.rotation.directions()
        axes = np.flatnonzero(turns.any(axis=0))
        arms = self._arms(points)
        if len(axes) == 1:
            normal = np.delete(np.eye(3), axes[0], axis=0)
            rows += [normal] if np.delete(arms, axes[0], axis=1).any() else []
        elif len(axes) and arms.any():
            return np.eye(3)
        spanned = np.concatenate([np.empty((0, 3)), *rows])
        return spanning_vectors(spanned) if len(spanned) else spanned

    def _arms(self, points) -> np.ndarray:
        """Return the points from the reference point, (P, 3), m."""
        array = read_only_array("points", points, "m")
        if array.ndim != 2 or array.shape[1] != 3:
            problem = f"shape {array.shape} must be (P, 3), one row [x, y, z] a point (m)"
            raise InputError(problem, field="points", value=points, unit="m")
        check_finite("points", array, "m")
        return array - self.reference


@dataclass(frozen=True, eq=False)
class Scaled:
    """Any motion with its displacement multiplied by a number, for motions that do not scale themselves."""

    motion: Any
    factor: float

    def directions(self) -> np.ndarray:
        """Return unit vectors that span the motion, (k, 3)."""
        return self.motion.directions() if self.factor else np.empty((0, 3))

    def displacement(self, t: ArrayLike) -> np.ndarray:
        """Return the displacement, m or rad: t in s, number -> (3,) or (S,) -> (3, S)."""
        return self.factor * self.motion.displacement(t)

    def velocity(self, t: ArrayLike) -> np.ndarray:
        """Return the velocity, m/s or rad/s: t in s, number -> (3,) or (S,) -> (3, S)."""
        return self.factor * self.motion.velocity(t)

    def trajectory(self, t: ArrayLike) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return displacement, velocity and acceleration, (3, S) each, at times t (S,) in s."""
        r, v, a = trajectory(self.motion, t)
        return self.factor * r, self.factor * v, self.factor * a


def _with_times(array, like) -> np.ndarray:
    """Return the array with the axis of times that (3, S) has behind its own, or as it is for (3,)."""
    return array.reshape(*array.shape, *[1] * (like.ndim - 1))


def _rotation(angles) -> np.ndarray:
    """Return R (S, 3, 3) of roll, pitch and yaw (3, S) in rad."""
    yaw, pitch, roll = (_axis_rotation(axis, angles[axis], 0.0, 0.0)[0] for axis in (2, 1, 0))
    return yaw @ pitch @ roll


def _rotation_derivatives(angles, rates, seconds) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return R and its first two time derivatives, (S, 3, 3) each; angles and their derivatives (3, S) in rad, s."""
    turning = [axis for axis in (2, 1, 0) if angles[axis].any() or rates[axis].any() or seconds[axis].any()]
    parts = [_axis_rotation(axis, angles[axis], rates[axis], seconds[axis]) for axis in turning or [2]]
    return reduce(_product, parts)


def _axis_rotation(axis: int, angle, rate, second) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return a rotation about one axis and its first two time derivatives, (S, 3, 3) each."""
    fixed, J = np.zeros((3, 3)), np.zeros((3, 3))
    fixed[axis, axis] = 1.0
    J[(axis + 2) % 3, (axis + 1) % 3], J[(axis + 1) % 3, (axis + 2) % 3] = 1.0, -1.0
    sin, cos, rate, second = (np.asarray(x)[..., None, None] for x in (np.sin(angle), np.cos(angle), rate, second))
    turning = np.eye(3) - fixed
    slope = cos * J - sin * turning  # by the angle
    return fixed + sin * J + cos * turning, rate * slope, second * slope - rate**2 * (sin * J + cos * turning)


def _product(A, B) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return A B and its first two derivatives; A and B are triples of a matrix and its first two derivatives."""
    return A[0] @ B[0], A[1] @ B[0] + A[0] @ B[1], A[2] @ B[0] + 2 * A[1] @ B[1] + A[0] @ B[2]


def _six(name: str, values, units) -> np.ndarray:
    """Return six real numbers as an array; raises InputError naming the one that is not."""
    listed = isinstance(values, (list, tuple)) or (isinstance(values, np.ndarray) and values.ndim == 1)
    if not listed or len(values) != 6:
        problem = f"{values!r} must be six numbers, surge, sway, heave, roll, pitch, yaw ({', '.join(units)})"
        raise InputError(problem, field=name, value=values, unit=", ".join(dict.fromkeys(units)))
    return np.array([real_number(f"{name}[{i}]", v, u) for i, (v, u) in enumerate(zip(values, units, strict=True))])


def _six_columns(name: str, values) -> np.ndarray:
    array = read_only_array(name, values, "m, rad")
    if array.ndim != 2 or array.shape[1] != 6 or not len(array):
        problem = f"shape {array.shape} must be (K, 6), K >= 1 rows surge, sway, heave (m), roll, pitch, yaw (rad)"
        raise InputError(problem, field=name, value=values, unit="m, rad")
    check_finite(name, array, "m, rad")
    return array
