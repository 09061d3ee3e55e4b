"""Force balance of a cable network and its tangent: MSQS (3.6), sections 3.1 and 4, for exact spans between nodes.

Every element lies in the vertical plane through its ends. With l, z_a, z_f its horizontal extent and the heights of its
ends, its end forces (H, V, H_anchor, V_anchor) and their derivatives ``D`` (4, 3) with (l, z_a, z_f) come from the
span; a seabed makes them depend on both heights, not on the difference alone. The assembly pattern is found once.
"""

from __future__ import annotations

from copy import copy
from functools import cached_property, partial

import numpy as np
import scipy.sparse as sparse

from ..catenary.solve import one, solve
from ..catenary.span import REGIMES, TOLERANCE, Regime, span_arrays
from ..numerics.elementary import SCALAR

FEW = 25  # lines up to which solving them one by one is faster
DENSE = 90  # unknowns up to which dense matrices are faster
ROUNDING = 4 * np.finfo(float).eps  # of coordinates and lengths
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
        self.anchor, self.fairlead = np.array([element.ends for element in network.elements]).T.copy()
        self.both_ends = np.concatenate([self.anchor, self.fairlead])
        columns = [(line.w, line.EA, line.L, line.friction) for line in network.elements]
        self.w, EA, self.L, self.friction = np.array(columns).T.copy()
        self.floor = -np.inf if environment.depth is None else -environment.depth
        self.lowest = np.where(self.free, self.floor, -np.inf)
        self.rests = (self.w >= 0) & np.isfinite(self.floor)  # a buoyant element never lies on the seabed
        self.heavy, self.massless = self.rests & (self.w > 0), self.w == 0
        self.any_rests, self.all_rest, self.any_massless = map(
            bool, (self.rests.any(), self.rests.all(), self.massless.any())
        )
        self.any_friction = bool(self.friction.any())
        weight = np.abs(self.w) * self.L
        self.heaviest = float(weight.max())  # N
        self.nothing, self.least = np.zeros(self.w.size), ROUNDING * self.L
        self.typical_length = float(np.median(self.L))
        self.typical_force = max(float(np.median(weight)), float(np.abs(self.load).max()) / weight.size, 1e-300)
        self.made_of(EA)
        self.pattern(self.free)

    def made_of(self, EA):
        """Set the stiffnesses EA (e,), N, and what follows from them."""
        self.EA, self.softness = EA, self.w / EA  # strain by the weight of a length, 1/m
        # N/m, what holds a node hardly at all: a line's own weight, or soft springs, shared by all nodes
        self.soft_stiffness = float(np.mean(np.abs(self.w)) or np.mean(EA / self.L) * 1e-6) / self.w.size

    def pattern(self, unknown):
        """Number the unknown nodes and find the place of every entry of the 6 x 6 element tangents."""
        self.unknown = unknown[:, None] & np.array([True, True, True])
        self.size = int(np.count_nonzero(self.unknown))
        self.dof = np.full((unknown.size, 3), -1)
        self.dof[unknown] = np.arange(self.size).reshape(-1, 3)
        ends = np.stack([self.anchor, self.fairlead], axis=1)
        self.coordinates = (3 * ends[:, :, None] + np.arange(3)).reshape(-1, 6)  # of the ends, of 3n
        self.ends = self.coordinates.T.ravel()
        of_element = self.dof.ravel()[self.coordinates]
        rows, columns = np.broadcast_arrays(of_element[:, :, None], of_element[:, None, :])
        self.used = np.flatnonzero((rows >= 0) & (columns >= 0))
        self.rows, self.columns = rows.ravel()[self.used], columns.ravel()[self.used]
        if self.size > DENSE:  # entries by column, then row, as sparse.csc_matrix stores them
            places, self.place = np.unique(self.columns * self.size + self.rows, return_inverse=True)
            starts = np.searchsorted(places, self.size * np.arange(self.size + 1))
            self.stored = (places % self.size).astype(np.int32), starts.astype(np.int32)
        else:
            self.place = self.rows * self.size + self.columns

    def moved(self, positions):
        """The same equations with the coupled nodes at positions (c, 3)."""
        other = copy(self)
        other.position = self.position.copy()
        other.position[self.coupled] = positions
        return other

    def moving(self, r, force):
        """(n, 3) bool: unknown coordinates, but for heights of nodes that the force presses onto the seabed."""
        if self.floor == -np.inf:
            return self.unknown
        stays = (r[:, 2] <= self.lowest) & (force[:, 2] <= 0)
        if not np.count_nonzero(stays):
            return self.unknown
        moving = self.unknown.copy()
        moving[stays, 2] = False
        return moving

    def on_floor(self, r):
        """r (n, 3) with its free nodes lifted to the seabed where they sank below, in place."""
        np.maximum(r[:, 2], self.lowest, out=r[:, 2])
        return r

    def spans(self, r):
        """Every element solved exactly between the nodes at r (n, 3)."""
        geometry = Geometry(self, r)
        return Elements(geometry, *exact_forces(self, geometry))

    def unbalanced(self, elements, Q=None):
        """(n, 3): sum of all forces on each node, N; ``Q`` instead of the elements' own forces if given."""
        H, V, H_anchor, V_anchor = elements.Q if Q is None else Q
        pull, direction = np.empty((6, H.size)), elements.geometry.direction
        pull[0:2], pull[2] = H_anchor * direction, V_anchor
        pull[3:5], pull[5] = -H * direction, -V
        return self.load + np.bincount(self.ends, pull.ravel(), self.load.size).reshape(-1, 3)

    def tangent(self, elements):
        """-d(unbalanced)/dr of the unknown nodes, (3m, 3m), dense up to DENSE unknowns, else sparse (csc).

        Positive semidefinite without friction: the second derivative of the potential energy.
        """
        values, n = elements.tangents().ravel()[self.used], self.size
        if n > DENSE:
            indices, starts = self.stored
            return sparse.csc_matrix((np.bincount(self.place, values, indices.size), indices, starts), shape=(n, n))
        return np.bincount(self.place, values, n * n).reshape(n, n)


class Geometry:
    """l (e,), direction (2, e) of the vertical planes, rise (e,), clearance (e,) of the anchor ends, friction (e,).

    rounding : (e,) m, to which distances are known; vertical : (e,) bool, l = 0: any azimuth will do, H/l has a limit;
        only there where ``any_vertical``
    """

    def __init__(self, balance, r):
        ends = r.take(balance.both_ends, 0)
        anchor_z, reach = ends[: balance.w.size, 2], ends[balance.w.size :] - ends[: balance.w.size]
        x, y, self.rise = reach.T
        self.r, self.l = r, np.hypot(x, y)
        self.rounding = ROUNDING * np.abs(r).max() + balance.least
        self.reach, self.direction, self.any_vertical = self.l, reach.T[:2], np.count_nonzero(self.l) < self.l.size
        if self.any_vertical:
            self.vertical = self.l == 0
            self.reach = np.where(self.vertical, 1.0, self.l)
            self.direction = np.array([np.where(self.vertical, 1.0, x), y])
        self.direction = self.direction / self.reach
        self.clearance, self.friction = balance.nothing, balance.friction
        if balance.any_rests:
            self.clearance = anchor_z - balance.floor
            if not balance.all_rest:
                self.clearance = self.clearance * balance.rests
        if balance.any_friction:  # where the anchor end lies on the seabed
            self.friction = np.where(self.clearance > 0, 0.0, balance.friction)

    @property
    def finite(self):
        """Whether every element lies between finite ends."""
        return bool(np.isfinite(self.l).all() and np.isfinite(self.rise).all())

    @cached_property
    def frame(self):
        """(e, 4, 6) and (e, 6, 6) of ``_frame``, which is linear in 1 and the direction."""
        turn = np.empty((self.l.size, 3))
        turn[:, 0], turn[:, 1:] = 1.0, self.direction.T
        frame = (turn @ FRAME).reshape(-1, 10, 6)
        return frame[:, :4], frame[:, 4:]


def _frame(c, s):
    """Of an element in direction (c, s), (4, 6): d(l, z_a, z_f, t)/d(r_a, r_f), t across the vertical plane;
    (6, 6): (pull on r_a, pull on r_f) from (H, V, H_anchor, V_anchor) and the two forces across, sign reversed.
    """
    motion, pulls = np.zeros((4, 6)), np.zeros((6, 6))
    along, across = np.array([c, s]), np.array([-s, c])
    motion[0, 0:2], motion[0, 3:5], motion[1, 2], motion[2, 5] = -along, along, 1.0, 1.0
    motion[3, 0:2], motion[3, 3:5] = -across, across
    pulls[3:5, 0], pulls[5, 1], pulls[0:2, 2], pulls[2, 3] = along, 1.0, -along, -1.0
    pulls[3:5, 4], pulls[0:2, 5] = across, -across
    return np.vstack([motion, pulls])


FRAME = np.array([_frame(0, 0), _frame(1, 0) - _frame(0, 0), _frame(0, 1) - _frame(0, 0)]).reshape(3, 60)


def exact_forces(balance, geometry, rows=slice(None)):
    """(H, V, H_anchor, V_anchor) (4, k) of the elements, the call that gives their D (k, 4, 3), span iterations."""
    lines = balance.w, balance.EA, balance.L, geometry.l, geometry.rise, balance.rests, geometry.friction
    w, EA, *lines = (column[rows] for column in (*lines, geometry.clearance))  # type: ignore[assignment]
    solved = one_by_one(w, EA, *lines) if w.size <= FEW and geometry.finite else span_arrays(w, EA, *lines)
    H, V, H_anchor, V_anchor, _, K, regime, _, iterations = solved
    Q = np.array([H, V, H_anchor, V_anchor])
    return Q, partial(exact_derivatives, Q, K, regime, w, EA, geometry.friction[rows]), int(np.sum(iterations))


def exact_derivatives(Q, K, regime, w, EA, friction):
    """D (k, 4, 3) of exact spans, from their stiffness K (4, k)."""
    H, _, H_anchor, V_anchor = Q
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
        D[sagging] = _sagging(*(k[sagging] for k in K), H[sagging], -V_anchor[sagging], w[sagging], EA[sagging])  # type: ignore[call-arg]
    return D


def one_by_one(*lines):
    """As ``span_arrays``, which for a few lines is slower."""
    with np.errstate(all="ignore"):
        rows = zip(*(column.tolist() for column in lines), strict=True)
        columns = np.array([solve(SCALAR, one, *line, TOLERANCE) for line in rows]).T  # type: ignore[call-arg]
    return *columns[:5], columns[5:9], columns[9], columns[10], columns[11]


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
    """Forces Q (4, e) = (H, V, H_anchor, V_anchor), and their derivatives D (e, 4, 3) with (l, z_a, z_f), if asked for.

    derivatives : call that gives D
    """

    def __init__(self, geometry, Q, derivatives=None, inner_iterations=0):
        self.geometry, self.Q, self.derivatives = geometry, Q, derivatives
        self.H, self.V, self.H_anchor, self.V_anchor = Q
        self.inner_iterations = inner_iterations

    @cached_property
    def D(self):
        """(e, 4, 3), by the call that was given."""
        return self.derivatives()

    def tangents(self, within=None):
        """(e, 6, 6): -d(force on anchor node, force on fairlead node)/d(r_a, r_f); the limit H/l = K11 where l = 0.

        within : derivatives in the plane of each element instead of D
        """
        g = self.geometry
        motion, pulls = g.frame
        D = np.zeros((self.H.size, 6, 4))
        D[:, :4, :3] = self.D if within is None else within
        D[:, 4, 3], D[:, 5, 3] = self.H / g.reach, self.H_anchor / g.reach
        if g.any_vertical:
            D[g.vertical, 4, 3], D[g.vertical, 5, 3] = self.D[g.vertical, 0, 0], self.D[g.vertical, 2, 0]
        return pulls @ D @ motion
