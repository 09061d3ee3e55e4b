"""Loads on a cable per unit unstretched length, each with its derivatives; HB section 2.1.

Square roots of squares stand for absolute values so that a complex step passes through.
"""

from __future__ import annotations

import numpy as np


def quadratic_drag(coefficient, velocity, stretch):
    """Return -c |q| q sqrt(1 + eps) along one direction, (10), and (11) in a plane; and its d/dq."""
    per_velocity = -coefficient * np.sqrt(velocity * velocity) * stretch
    return per_velocity * velocity, 2 * per_velocity


def transverse_drag(normal, binormal, v, w, stretch):
    """Return (F_n, F_b) of (11), (12) and their derivatives ((dF_n/dv, dF_n/dw), (dF_b/dv, dF_b/dw)).

    F_n = -c_n v |q| sqrt(1 + eps), F_b likewise, q = (v, w).
    """
    speed = np.sqrt(v * v + w * w)
    per_speed = stretch / np.where(speed == 0, 1.0, speed)
    speed, vv, vw, ww = speed * stretch, v * v * per_speed, v * w * per_speed, w * w * per_speed
    value = -normal * v * speed, -binormal * w * speed
    return value, ((-normal * (speed + vv), -normal * vw), (-binormal * vw, -binormal * (speed + ww)))


def seabed_support(stiffness, depth, z):
    """Return the support of a flat elastic seabed, max(k (-depth - z), 0), HB 2.5, and its d/dz; N/m.

    HB limits it to the weight in statics, where no line lies deeper than its weight presses it. A moving line does, and
    with that limit nothing but drag would stop it from sinking on.
    """
    support = stiffness * (-depth - z)
    touching = support > 0
    return np.where(touching, support, 0.0), np.where(touching, -stiffness, 0.0)
