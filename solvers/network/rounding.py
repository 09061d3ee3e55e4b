"""Recover forces that double-precision positions cannot resolve.

A stiff line between rounded positions pulls by EA/L times their rounding too much or too little, and a buoy far from
the origin floats a rounding too high or too low. One more Newton step balances (3.6) to first order, and the forces are
those that this step predicts: exact spans between the new positions differ from them by no more than a rounding of
these positions causes. A line that is just slack or just taut has two stiffnesses; whether the step lengthens it
decides between them.
"""

from __future__ import annotations

from copy import copy

import numpy as np

from .equations import Elements, Geometry, exact_forces
from .nested import largest_force, motion_by, rounding_floor, tangent_of

MAX_STIFFNESS_CHOICES = 8  # times that the stiffnesses of lines are chosen anew
REGULARISATION = 1e-9  # of the softest stiffness that counts


def refine_within_rounding(equations, r, tolerance, count):
    """Return (r (n, 3), Elements), balanced to ``tolerance`` times the largest force by a Newton step from r (n, 3).

    None where more is out of balance at r than rounding explains, where the step does not balance, or where exact spans
    between the new positions differ from the predicted forces by more than rounding.
    """
    g = Geometry(equations, r)
    Q, derivatives, inner = exact_forces(equations, g)
    here, as_is = Elements(g, Q), derivatives()
    force = equations.unbalanced_force(here)
    moving = equations.moving_coordinates(r, force)
    if not np.abs(force[moving]).max(initial=0.0) <= rounding_floor(equations):
        return None
    _, derivatives, inner_stretched = exact_forces(equations, _stretched(equations, g))
    stretched, lengthens = derivatives(), np.ones(g.l.size, dtype=bool)
    for _ in range(MAX_STIFFNESS_CHOICES):
        here.D = np.where(lengthens[:, None, None], stretched, as_is)
        dr = _newton_step(equations, here, force, moving, count)
        if dr is None:
            return None
        motion = g.frame[0][:, :3] @ dr.ravel()[equations.coordinates][:, :, None]
        dl, dz_anchor, dz_fairlead = motion[:, :, 0].T
        before, lengthens = lengthens, g.l * dl + g.rise * (dz_fairlead - dz_anchor) >= 0
        if (lengthens == before).all():
            break
    r = equations.lift_to_seabed(r + dr)
    new = Geometry(equations, r)
    there, _, inner_there = exact_forces(equations, new)
    count.inner_iterations += inner + inner_stretched + inner_there
    predicted = Q + (here.D @ motion)[:, :, 0].T
    predicted[::2] = np.maximum(predicted[::2], 0.0)  # no horizontal force pushes
    elements = Elements(new, predicted)
    bound = tolerance * largest_force(elements)
    within = np.abs(there - predicted) <= g.rounding * np.abs(stretched).max(axis=2).T + bound
    force = equations.unbalanced_force(elements)
    balanced = np.abs(force[equations.moving_coordinates(r, force)]).max(initial=0.0) <= bound
    return (r, elements) if within.all() and balanced else None


def _stretched(equations, g):
    """Return the geometry with the ends of every line a rounding further apart, no fairlead below the seabed."""
    stretched, growth = copy(g), 1 + g.rounding / np.maximum(np.hypot(g.l, g.rise), g.rounding)
    stretched.l, stretched.rise = g.l * growth, g.rise * growth
    stretched.rise = np.where(equations.can_rest, np.maximum(stretched.rise, -g.clearance), stretched.rise)
    return stretched


def _newton_step(equations, elements, force, moving, count):
    """Return the motion (n, 3) of the nodes that balances the force to first order, None where there is none."""
    shift = REGULARISATION * equations.soft_stiffness
    dr = motion_by(tangent_of(equations, elements, moving), shift, force, moving, count)
    return dr if dr is not None and np.isfinite(dr).all() else None
