"""Force balance of a cable network and its tangent: MSQS (3.6), sections 3.1 and 4, for exact spans between nodes.

Every element lies in the vertical plane through its ends. With l, z_a, z_f its horizontal extent and the heights of its
ends, its end forces (H, V, H_anchor, V_anchor) and their derivatives ``D`` (4, 3) with (l, z_a, z_f) come from the
span; a seabed makes them depend on both heights, not on the difference alone. The assembly pattern is found once.
"""

from __future__ import annotations

from copy import copy

import numpy as np
import scipy.sparse as sparse

from .catenary import REGIMES, Regime, span_arrays

_PLANE = np.eye(2)
DENSE = 90  # unknowns up to which dense matrices are faster
GROUNDED, LYING, SAGGING, SLACK = (
    REGIMES.index(regime) for regime in (Regime.GROUNDED, Regime.LYING, Regime.SAGGING, Regime.SLACK)
)


class Balance:
    """The equations of one network: arrays of its n nodes and e elements, and the pattern of the tangent.

    free : (n,) bool, nodes whose position is unknown; dof : (n, 3), number of each unknown or -1
    load : (n, 3), N, all that acts at the nodes besides the lines: force + (rho volume - mass) g, (3.6c)
    """

    def __init__(self, network):
        environment = network.environment
        self.position = np.array([node.r for node in network.nodes], dtype=float)
        self.free = np.array([node.kind == "free" for node in network.nodes])
        self.coupled = np.array([node.kind == "coupled" for node in network.nodes])
        lift = [(environment.rho * node.volume - node.mass) * environment.g for node in network.nodes]
        self.load = np.array([node.force for node in network.nodes], dtype=float)
        self.load[:, 2] += lift
        self.anchor, self.fairlead = np.array([element.ends for element in network.elements]).T
        for name in ("w", "EA", "L", "friction"):
            setattr(self, name, np.array([getattr(element, name) for element in network.elements]))
        self.floor = -np.inf if environment.depth is None else -environment.depth
        self.rests = (self.w >= 0) & np.isfinite(self.floor)  # a buoyant element never lies on the seabed
        self.pattern(self.free)

    def pattern(self, unknown):
        """Number the unknown nodes and find the place of every entry of the 6 x 6 element tangents."""
        self.dof = np.full((unknown.size, 3), -1)
        self.dof[unknown] = np.arange(3 * np.count_nonzero(unknown)).reshape(-1, 3)
        self.size = 3 * int(np.count_nonzero(unknown))
        of_element = np.concatenate([self.dof[self.anchor], self.dof[self.fairlead]], axis=1)
        rows, columns = np.broadcast_arrays(of_element[:, :, None], of_element[:, None, :])
        self.used = ((rows >= 0) & (columns >= 0)).ravel()
        self.rows, self.columns = rows.ravel()[self.used], columns.ravel()[self.used]

    def moved(self, network):
        """The same equations for the same network with its nodes elsewhere."""
        other = copy(self)
        other.position = np.array([node.r for node in network.nodes])
        return other

    def geometry(self, r):
        """Horizontal extent, direction, rise and clearance of every element between the nodes at r (n, 3)."""
        return Geometry(self, r)

    def spans(self, r):
        """Every element solved exactly between the nodes at r (n, 3)."""
        geometry = self.geometry(r)
        return Elements(geometry, *exact_forces(self, geometry))

    def unbalanced(self, elements):
        """(n, 3): sum of all forces on each node, N."""
        force = self.load.copy()
        np.add.at(force, self.fairlead, -elements.pull(elements.H, elements.V))
        np.add.at(force, self.anchor, elements.pull(elements.H_anchor, elements.V_anchor))
        return force

    def tangent(self, elements):
        """-d(unbalanced)/dr of the unknown nodes, (3m, 3m), dense up to DENSE unknowns, else sparse (csc).

        Positive semidefinite without friction: the second derivative of the potential energy.
        """
        values = elements.tangents().ravel()[self.used]
        if self.size > DENSE:
            return sparse.csc_matrix((values, (self.rows, self.columns)), shape=(self.size, self.size))
        return np.bincount(self.rows * self.size + self.columns, values, self.size**2).reshape(self.size, self.size)


class Geometry:
    """l (e,), direction (e, 2) of the vertical planes, rise (e,), clearance (e,) of the anchor ends, friction (e,)."""

    def __init__(self, balance, r):
        self.r = r
        reach = r[balance.fairlead] - r[balance.anchor]
        self.l, self.rise = np.sqrt(reach[:, 0] ** 2 + reach[:, 1] ** 2), reach[:, 2]
        self.vertical = self.l == 0  # no azimuth: any will do, H/l has a limit
        self.reach = np.where(self.vertical, 1.0, self.l)
        self.direction = np.where(self.vertical[:, None], [1.0, 0.0], reach[:, :2] / self.reach[:, None])
        self.clearance = np.zeros_like(self.l)
        if balance.rests.any():
            self.clearance = np.where(balance.rests, r[balance.anchor, 2] - balance.floor, 0.0)
        self.friction = np.where(self.clearance > 0, 0.0, balance.friction)  # where the anchor end lies on the seabed


def exact_forces(balance, geometry, rows=slice(None)):
    """(H, V, H_anchor, V_anchor) (k,), their D (k, 4, 3) of the given elements, and the sum of span iterations."""
    w, EA, friction = balance.w[rows], balance.EA[rows], geometry.friction[rows]
    H, V, H_anchor, V_anchor, _, K, regime, _, iterations = span_arrays(
        *(w, EA, balance.L[rows]),
        *(geometry.l[rows], geometry.rise[rows], balance.rests[rows], friction, geometry.clearance[rows]),
    )
    K = np.where(np.isinf(K), 0.0, K)  # infinite: the end rests on the seabed
    D_H, D_V = np.stack([K[0], -K[1], K[1]], axis=-1), np.stack([K[2], -K[3], K[3]], axis=-1)
    D = np.stack([D_H, D_V, D_H, D_V], axis=-2)
    resting = (regime == GROUNDED) | (regime == LYING)
    if resting.any():
        D[resting, :, 1] = D[resting, 3] = 0.0
        # H_anchor = max(H - CB w L_B, 0) with L_B = L - V/w (the B block of 4.11 corrected)
        moved = D[resting, 0] + friction[resting, None] * D[resting, 1]
        D[resting, 2] = np.where(H_anchor[resting, None] > 0, moved, 0.0)
    slack = regime == SLACK
    if slack.any():
        D[slack] = 0.0
        D[slack, 1, 2], D[slack, 3, 1] = K[3][slack], -w[slack] / (1 - V_anchor[slack] / EA[slack])
    sagging = regime == SAGGING
    if sagging.any():
        D[sagging] = _sagging(*(k[sagging] for k in K), H[sagging], -V_anchor[sagging], w[sagging], EA[sagging])
    return H, V, H_anchor, V_anchor, D, int(np.sum(iterations))


def _sagging(K11, K12, K21, K22, H, lift, w, EA):
    """Both ends raised: the anchor end hangs from its own height, so its compliance enters by itself."""
    T = np.sqrt(H * H + lift * lift)
    raised = lift > 0
    softness = np.where(raised, w / np.where(raised, lift / T + lift / EA, 1.0), 0.0)  # d(lift)/dc at given H
    a = -lift / (w * T) * (lift / (T + H)) * softness
    dH = np.stack([K11, -a * K11, K12], axis=-1)
    dV = np.stack([K21, -a * K21, K22], axis=-1)
    d_lift = np.stack([-a * K11, softness + a * a * K11, -a * K12], axis=-1)
    return np.stack([dH, dV, dH, -d_lift], axis=-2)


class Elements:
    """Forces (e,) of all elements and their derivatives D (e, 4, 3) with (l, z_a, z_f), in their geometry."""

    def __init__(self, geometry, H, V, H_anchor, V_anchor, D, inner_iterations=0):
        self.geometry = geometry
        self.H, self.V, self.H_anchor, self.V_anchor, self.D = H, V, H_anchor, V_anchor, D
        self.inner_iterations = inner_iterations

    def pull(self, H, V):
        """(e, 3) force vectors with the horizontal component H along each element."""
        force = np.empty((H.size, 3))
        force[:, :2], force[:, 2] = H[:, None] * self.geometry.direction, V
        return force

    def tangents(self):
        """(e, 6, 6): -d(force on anchor node, force on fairlead node)/d(r_a, r_f); the limit H/l = K11 where l = 0."""
        T = np.zeros((self.H.size, 6, 6))
        along = self.geometry.direction[:, :, None] * self.geometry.direction[:, None, :]
        for place, sign, H, (h, v) in ((0, -1.0, self.H_anchor, (2, 3)), (3, 1.0, self.H, (0, 1))):
            swing = np.where(self.geometry.vertical, self.D[:, h, 0], H / self.geometry.reach)
            turn = sign * (self.D[:, h, 0, None, None] * along + swing[:, None, None] * (_PLANE - along))
            lift = sign * self.D[:, v, 0, None] * self.geometry.direction
            T[:, place : place + 2, 0:2], T[:, place : place + 2, 3:5] = -turn, turn
            T[:, place + 2, 0:2], T[:, place + 2, 3:5] = -lift, lift
            for column, z in ((2, 1), (5, 2)):
                T[:, place : place + 2, column] = sign * self.D[:, h, z, None] * self.geometry.direction
                T[:, place + 2, column] = sign * self.D[:, v, z]
        return T
