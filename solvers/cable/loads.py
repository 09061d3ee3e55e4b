"""Loads on a cable per unit unstretched length, each with its derivative beside it; HB section 2.1.

A load is a function of what it depends on; square roots of squares stand for absolute values so that a complex step
passes through.
"""

from __future__ import annotations

import numpy as np


def quadratic_drag(coefficient, velocity, stretch):
    """-c |q| q sqrt(1 + eps) along one line, (10) and (11) in a plane; returns the load and d/dq."""
    slope = -coefficient * np.sqrt(velocity * velocity) * stretch
    return slope * velocity, 2 * slope


def transverse_drag(normal, binormal, v, w, stretch):
    """(11), (12): F_n = -c_n v |q| sqrt(1 + eps), F_b likewise, q = (v, w).

    Returns (F_n, F_b) and its tangent ((dF_n/dv, dF_n/dw), (dF_b/dv, dF_b/dw)).
    """
    speed = np.sqrt(v * v + w * w)
    quiet = speed == 0
    per_speed = stretch / np.where(quiet, 1.0, speed)
    speed, vv, vw, ww = speed * stretch, v * v * per_speed, v * w * per_speed, w * w * per_speed
    value = -normal * v * speed, -binormal * w * speed
    return value, ((-normal * (speed + vv), -normal * vw), (-binormal * vw, -binormal * (speed + ww)))


def seabed_support(stiffness, depth, z):
    """Support of a flat elastic seabed, max(k (-depth - z), 0), HB 2.5; returns it and d/dz.

    HB limits it to the weight in statics, where no line lies deeper than the weight presses it. A moving line does, and
    with that limit nothing but drag would stop it: it would sink on.
    """
    support = stiffness * (-depth - z)
    touching = support > 0
    return np.where(touching, support, 0.0), np.where(touching, -stiffness, 0.0)
