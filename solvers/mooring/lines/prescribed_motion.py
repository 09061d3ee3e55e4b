"""Motion of the points that a body moves: of a BodyMotion, or of a motion that displaces all of them equally."""

from __future__ import annotations

import numpy as np

from ...common.motions.body_motion import BodyMotion
from ...common.motions.motion import Ramped, trajectory
from ...common.outcome import InputError

IN_SEABED = 1e-3  # of the depth, by which a point that rests on a soft seabed may be pressed into it


def displace_points(motion, points, t) -> np.ndarray:
    """Return the displacement of points (M, 3) in m at times t (S,) in s, (3, M, S), m."""
    if isinstance(motion, BodyMotion):
        return motion.displacement(points, t)
    return np.repeat(np.asarray(motion.displacement(t))[:, None], len(points), axis=1)


def displace_over_period(model, motion, count) -> np.ndarray:
    """Return ``count`` displacements (count, M, 3) of the coupled points of a MooringModel over a period, m."""
    times = motion.period * np.arange(count) / count
    return displace_points(motion, model.positions[model.moved], times).T


def move_points(motion, points, t) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return displacement, velocity and acceleration of points (M, 3) in m at times t (S,) in s, (3, M, S) each.

    (3, 1, S) where the motion displaces all points equally.
    """
    if isinstance(motion, BodyMotion):
        return motion.trajectory(points, t)
    r, v, a = (part[:, None] for part in trajectory(motion, t))
    return r, v, a


def reference_point(motion, t) -> np.ndarray:
    """Return the moved reference point of a body at times t (S,) in s, (3, S), m; without one that at the origin."""
    if motion is None:
        return np.zeros((3, np.size(t)))
    if isinstance(motion, BodyMotion):
        return np.array(motion.reference)[:, None] + motion.pose(t)[0]
    return np.asarray(motion.displacement(t))


def span_motion(motion, points) -> np.ndarray:
    """Return unit vectors (k, 3) that span the displacements of points (M, 3) in m."""
    return np.asarray(motion.directions(points) if isinstance(motion, BodyMotion) else motion.directions())


def ramp_motion(motion, duration):
    """Return the motion grown from rest over a duration in s."""
    return motion.ramped(duration) if isinstance(motion, BodyMotion) else Ramped(motion, duration)


def require_above_seabed(model, points, t, z):
    """Raise InputError where moved points (M, 3), above the seabed at rest, are below it at heights z (S, M)."""
    if model.environment.depth is None:
        return
    floor = -model.environment.depth
    below = (z < floor * (1 + IN_SEABED)) & (points[:, 2] >= floor)
    if below.any():
        k, i = np.argwhere(below)[0].tolist()
        place = f"node {model.moved[i] + 1} to z = {z[k, i]:g} m at t = {t[k]:g} s"
        raise InputError(f"takes {place}, below the seabed at {floor:g} m", field="motion", unit="m")


def require_motion(motion, model):
    """Raise InputError where that is no motion, or where a MooringModel has no coupled point that it moves."""
    if not (isinstance(motion, BodyMotion) or callable(getattr(motion, "velocity", None))):
        problem = f"{motion!r} is no BodyMotion, Motion, SampledMotion or FunctionMotion"
        raise InputError(problem, field="motion", value=motion)
    if not model.moved:
        raise InputError("it moves coupled points, and none is there", field="motion", value=motion)
