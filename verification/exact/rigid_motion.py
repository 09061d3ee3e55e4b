"""Harmonic motion of a rigid body and of points fixed to it: positions, velocities and accelerations.

A point with the arm b about the reference point R_0 moves as

    r(t) = R_0 + d(t) + Rz(yaw) Ry(pitch) Rx(roll) b,        q(t) = mean + amplitude cos(omega t + phase)

for each q of surge, sway, heave (d, in m) and roll, pitch, yaw (rad). The three rotations are differentiated one by
one and multiplied by the product rule, so that no angular velocity is needed. z is up. SI units, radians.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

STILL = (0.0,) * 6


@dataclass(frozen=True)
class RigidMotion:
    """Motion of a body; orders surge, sway, heave, roll, pitch, yaw.

    reference : (x, y, z), m, of the reference point at d = 0;  omega : rad/s
    amplitude, mean : six each, m and rad;  phase : six, rad
    """

    reference: tuple[float, float, float] = (0.0, 0.0, 0.0)
    omega: float = 0.0
    amplitude: tuple[float, ...] = STILL
    phase: tuple[float, ...] = STILL
    mean: tuple[float, ...] = field(default=STILL)

    def coordinates(self, t, order=0):
        """Return the time derivative of the given order of the six coordinates, ndarray (*t.shape, 6)."""
        t = np.asarray(t, float)[..., None]
        turn = self.omega * t + np.array(self.phase, float) + order * np.pi / 2
        wave = np.array(self.amplitude, float) * self.omega**order * np.cos(turn)
        return wave + (np.array(self.mean, float) if order == 0 else 0.0)

    def rotations(self, t):
        """Return Rz(yaw) Ry(pitch) Rx(roll) and its first two time derivatives, ndarray (3, *t.shape, 3, 3)."""
        q = np.array([self.coordinates(t, order) for order in range(3)])
        first = _turns(2, q[..., 5])
        for axis in (1, 0):
            second = _turns(axis, q[..., 3 + axis])
            first = [
                first[0] @ second[0],
                first[1] @ second[0] + first[0] @ second[1],
                first[2] @ second[0] + 2 * first[1] @ second[1] + first[0] @ second[2],
            ]
        return np.array(first)

    def kinematics(self, at_rest, t):
        """Return positions, velocities and accelerations of points, ndarray (3, *t.shape, n, 3), m, m/s, m/s^2.

        at_rest : (n, 3), m, where the points are at d = 0 and angles 0
        """
        reference = np.array(self.reference, float)
        arms = np.asarray(at_rest, float) - reference
        moved = np.array([self.coordinates(t, order)[..., None, :3] for order in range(3)])
        moved = moved + arms @ np.swapaxes(self.rotations(t), -1, -2)
        moved[0] += reference
        return moved

    def reference_point(self, t):
        """Return the position of the reference point, ndarray (*t.shape, 3), m."""
        return self.coordinates(t)[..., :3] + np.array(self.reference, float)


def _turns(axis, angle):
    """Return a rotation about an axis and its time derivatives; angle : (3, ...), with derivatives."""
    i, j = (axis + 1) % 3, (axis + 2) % 3
    cos, sin = np.cos(angle[0]), np.sin(angle[0])
    rate, change = angle[1], angle[2]
    turns = np.zeros((3, *np.shape(cos), 3, 3))
    turns[0, ..., axis, axis] = 1.0
    cosines = np.array([cos, -sin * rate, -cos * rate**2 - sin * change])
    sines = np.array([sin, cos * rate, -sin * rate**2 + cos * change])
    turns[..., i, i] = turns[..., j, j] = cosines
    turns[..., j, i], turns[..., i, j] = sines, -sines
    return turns
