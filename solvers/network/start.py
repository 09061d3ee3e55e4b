"""Start of a network from no guess: force densities, then a continuation in softness.

Soft lines over a soft seabed are nearly linear; each stage is stiffer and starts from the result of the one before.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sparse
from scipy.sparse.linalg import splu

from .equations import NetworkEquations
from .nested import solve_regularised

MAX_CONTACT_ELEMENTS = 60  # elements up to which contact of the lines with the seabed is solved on the way
SOFTNESS_RATIO = 0.1  # of a stage to the one before
SOFTNESS_START, SOFTNESS_END = 1.0, 1e-3  # of the first stage; of the last, over the number of elements
MIN_SOFTNESS = 1e-10  # strains below it drown in rounding
STAGE_TOLERANCE = 1e-2  # of the heaviest node load: the next stage only needs a start
STAGE_ITERATIONS = 60


class SoftenedStage(NetworkEquations):
    """A stage of the continuation: lines no stiffer than load/softness, a seabed of springs under the free nodes.

    softness : strain under the total load, and depth over the total length to which that load sinks a node
    contact : the lines rest on the rigid seabed, where a sunk node holds their ends; else they pass through it
    """

    def __init__(self, equations, softness, contact):
        vars(self).update(vars(equations))
        self.contact = contact
        if not contact:
            self.can_rest = np.zeros_like(equations.can_rest)
        node_load = _node_loads(equations)
        if node_load.any():
            self.set_stiffness(1 / (1 / equations.EA + softness / node_load.sum()))
        self.heaviest = node_load[equations.free].max(initial=0.0)
        self.spring = np.where(equations.free, node_load, 0.0) / (softness * equations.L.sum())

    def solve_elements(self, r):
        """Return the softened elements between nodes at r (n, 3), with ``sunk`` (n,), m, how far each node has sunk."""
        lifted = super().lift_to_seabed(r.copy())
        elements = super().solve_elements(lifted if self.contact else r)
        elements.sunk = lifted[:, 2] - r[:, 2]
        return elements

    def moving_coordinates(self, r, force):
        """Return every unknown coordinate: the seabed is soft."""
        return self.unknown

    def lift_to_seabed(self, r):
        """Return r unchanged: nodes may sink."""
        return r

    def unbalanced_force(self, elements, Q=None):
        """Return NetworkEquations.unbalanced_force with the springs of the seabed."""
        force = super().unbalanced_force(elements, Q)
        force[:, 2] += self.spring * elements.sunk
        return force

    def tangent(self, elements):
        """Return NetworkEquations.tangent with the springs of the seabed; line ends at sunk nodes keep their height."""
        below = np.flatnonzero(elements.sunk > 0)
        above, springs = np.ones(self.size), np.zeros(self.size)
        springs[self.dof[below, 2]] = self.spring[below]
        if self.contact:
            above[self.dof[below, 2]] = 0.0
        tangent = super().tangent(elements)
        if isinstance(tangent, np.ndarray):
            return tangent * above * above[:, None] + np.diag(springs)
        above = sparse.diags(above, format="csc")
        return above @ tangent @ above + sparse.diags(springs, format="csc")


def _node_loads(equations):
    """Return the size (n,) of the load on each node, half the weight of each of its lines included, N."""
    node_load = np.abs(equations.load).sum(axis=1)
    np.add.at(node_load, equations.both_ends, np.tile(np.abs(equations.w) * equations.L / 2, 2))
    return node_load


def force_density(equations):
    """Return positions (n, 3) of a net of springs with force density 1/L under the same loads, by one linear solve."""
    r, free = equations.position.copy(), np.flatnonzero(equations.free)
    if free.size == 0:
        return r
    a, f, q = equations.anchor, equations.fairlead, 1 / equations.L
    n = equations.free.size
    laplacian = sparse.coo_matrix(
        (np.concatenate([q, q, -q, -q]), (np.concatenate([a, f, a, f]), np.concatenate([a, f, f, a]))), shape=(n, n)
    ).tocsr()
    load = equations.load.copy()
    np.subtract.at(load[:, 2], equations.both_ends, np.tile(equations.w * equations.L / 2, 2))
    fixed = np.flatnonzero(~equations.free)
    scale = np.abs(load).sum() or 1.0
    right = load[free] / scale - laplacian[free][:, fixed] @ r[fixed]
    r[free] = splu(laplacian[free][:, free].tocsc()).solve(right)
    return r


def robust_start(equations, count, contact):
    """Return positions (n, 3) near equilibrium; no guess is needed.

    contact : solve the contact of the lines on the way, which converges well where much line is slack; a long chain of
        short elements converges better by its nodes alone
    """
    r, softness = force_density(equations), SOFTNESS_START
    total = _node_loads(equations).sum()
    last = min(SOFTNESS_END / equations.w.size, max(SOFTNESS_RATIO * total / equations.EA.max(), MIN_SOFTNESS))
    while softness > last:
        stage = SoftenedStage(equations, softness, contact)
        bound = STAGE_TOLERANCE * stage.heaviest
        r = solve_regularised(stage, r, lambda _, bound=bound: bound, count, STAGE_ITERATIONS)
        softness *= SOFTNESS_RATIO
    return equations.lift_to_seabed(r)
