"""Forces that positions as doubles cannot tell.

A stiff line between rounded positions pulls by EA/L times their rounding too much or too little, and a buoy far from
the origin floats a rounding too high or too low. Here one more Newton step balances (3.6) to first order, and the
forces are those that the step foresees: exact spans between the new positions differ from them by no more than a
rounding of these moves them. A line that is just slack or just taut has two slopes; its own motion says which.
"""

from __future__ import annotations

from copy import copy

import numpy as np

from .equations import Elements, Geometry, exact_forces
from .nested import attainable, largest_force, solve_sparse

SIDES = 8  # times that the slopes of lines are chosen anew
REGULAR = 1e-9  # of the softest stiffness that counts


def within_rounding(balance, r, tolerance, count):
    """(r (n, 3), Elements) balanced to ``tolerance`` times the largest force, a Newton step from positions r.

    None where more is out of balance at r than rounding explains, where the step does not balance, or where exact spans
    between the new positions pull otherwise by more than rounding.
    """
    g = Geometry(balance, r)
    Q, slopes, inner = exact_forces(balance, g)
    here, slack = Elements(g, Q), slopes()
    force = balance.unbalanced(here)
    moving = balance.moving(r, force)
    if not np.abs(force[moving]).max(initial=0.0) <= attainable(balance):
        return None
    _, slopes, more = exact_forces(balance, _drawn_apart(balance, g))
    taut, lengthens = slopes(), np.ones(g.l.size, dtype=bool)
    for _ in range(SIDES):
        here.D = np.where(lengthens[:, None, None], taut, slack)
        dr = _step(balance, here, force, moving, count)
        if dr is None:
            return None
        motion = g.frame[0][:, :3] @ dr.ravel()[balance.coordinates][:, :, None]
        dl, da, df = motion[:, :, 0].T
        before, lengthens = lengthens, g.l * dl + g.rise * (df - da) >= 0
        if (lengthens == before).all():
            break
    r = balance.on_floor(r + dr)
    new = Geometry(balance, r)
    there, _, last = exact_forces(balance, new)
    count.inner_iterations += inner + more + last
    foreseen = Q + (here.D @ motion)[:, :, 0].T
    foreseen[::2] = np.maximum(foreseen[::2], 0.0)  # no horizontal force pushes
    found = Elements(new, foreseen)
    bound = tolerance * largest_force(found)
    rounded = np.abs(there - foreseen) <= g.rounding * np.abs(taut).max(axis=2).T + bound
    force = balance.unbalanced(found)
    balanced = np.abs(force[balance.moving(r, force)]).max(initial=0.0) <= bound
    return (r, found) if rounded.all() and balanced else None


def _drawn_apart(balance, g):
    """The geometry with the ends of every line a rounding further apart, no fairlead below the seabed."""
    apart, growth = copy(g), 1 + g.rounding / np.maximum(np.hypot(g.l, g.rise), g.rounding)
    apart.l, apart.rise = g.l * growth, g.rise * growth
    apart.rise = np.where(balance.rests, np.maximum(apart.rise, -g.clearance), apart.rise)
    return apart


def _step(balance, elements, force, moving, count):
    """(n, 3) motion of the nodes that balances the force to first order; None where the tangent is singular."""
    unknown, tangent = balance.dof[moving], balance.tangent(elements)
    change = solve_sparse(tangent[unknown][:, unknown], REGULAR * balance.soft_stiffness, force[moving], count)
    if change is None or not np.isfinite(change).all():
        return None
    dr = np.zeros(force.shape)
    dr[moving] = change
    return dr
