"""Force balance of a cable network and its tangent: MSQS (3.6), sections 3.1 and 4, for exact spans between nodes.

Every element lies in the vertical plane through its ends. With l, z_a, z_f its horizontal extent and the heights of its
ends, its end forces (H, V, H_anchor, V_anchor) and their derivatives ``D`` (4, 3) with (l, z_a, z_f) come from the
span; a seabed makes them depend on both heights, not on the difference alone. The sparsity pattern is built once.
"""

from __future__ import annotations

from copy import copy
from functools import cached_property, partial

import numpy as np
import scipy.sparse as sparse

from ..catenary.regimes import GROUNDED, LYING, SAGGING, SLACK
from ..catenary.solve import solve, solve_one
from ..catenary.span import TOLERANCE, span_arrays
from ..numerics.elementary import SCALAR

MAX_SCALAR_SPANS = 25  # lines up to which solving them one by one is faster
MAX_DENSE = 90  # unknowns up to which dense matrices are faster
ROUNDING = 4 * np.finfo(float).eps  # of coordinates and lengths


class NetworkEquations:
    """The equations of one network: arrays of its n nodes and e elements, and the sparsity of the tangent.

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
        self.seabed = -np.inf if environment.depth is None else -environment.depth
        self.min_z = np.where(self.free, self.seabed, -np.inf)
        self.can_rest = (self.w >= 0) & np.isfinite(self.seabed)  # a buoyant element never lies on the seabed
        self.heavy, self.massless = self.can_rest & (self.w > 0), self.w == 0
        self.any_can_rest, self.all_can_rest = bool(self.can_rest.any()), bool(self.can_rest.all())
        self.any_massless, self.any_friction = bool(self.massless.any()), bool(self.friction.any())
        weight = np.abs(self.w) * self.L
        self.largest_weight = float(weight.max())  # N
        self.zeros, self.length_rounding = np.zeros(self.w.size), ROUNDING * self.L
        self.typical_length = float(np.median(self.L))
        self.typical_force = max(float(np.median(weight)), float(np.abs(self.load).max()) / weight.size, 1e-300)
        self.set_stiffness(EA)
        self.build_sparsity(self.free)

    def set_stiffness(self, EA):
        """Set the stiffnesses EA (e,), N, and what follows from them."""
        self.EA, self.weight_strain = EA, self.w / EA  # strain by the weight of a length, 1/m
        # N/m, regularises nodes that hardly anything holds: a line's own weight, or soft springs, shared by all nodes
        self.soft_stiffness = float(np.mean(np.abs(self.w)) or np.mean(EA / self.L) * 1e-6) / self.w.size

    def build_sparsity(self, unknown):
        """Number the coordinates of unknown nodes (n,) bool and locate the entries of the 6 x 6 element tangents."""
        self.unknown = unknown[:, None] & np.array([True, True, True])
        self.size = int(np.count_nonzero(self.unknown))
        self.dof = np.full((unknown.size, 3), -1)
        self.dof[unknown] = np.arange(self.size).reshape(-1, 3)
        ends = np.stack([self.anchor, self.fairlead], axis=1)
        self.coordinates = (3 * ends[:, :, None] + np.arange(3)).reshape(-1, 6)  # of the ends, of 3n
        self.end_coordinates = self.coordinates.T.ravel()
        of_element = self.dof.ravel()[self.coordinates]
        rows, columns = np.broadcast_arrays(of_element[:, :, None], of_element[:, None, :])
        self.used = np.flatnonzero((rows >= 0) & (columns >= 0))
        self.rows, self.columns = rows.ravel()[self.used], columns.ravel()[self.used]
        if self.size > MAX_DENSE:  # entries by column, then row, as sparse.csc_matrix stores them
            entries, self.entry = np.unique(self.columns * self.size + self.rows, return_inverse=True)
            starts = np.searchsorted(entries, self.size * np.arange(self.size + 1))
            self.csc_pattern = (entries % self.size).astype(np.int32), starts.astype(np.int32)
        else:
            self.entry = self.rows * self.size + self.columns

    def with_coupled_nodes_at(self, positions):
        """Return the same equations with the coupled nodes at positions (c, 3), m."""
        other = copy(self)
        other.position = self.position.copy()
        other.position[self.coupled] = positions
        return other

    def moving_coordinates(self, r, force):
        """Return (n, 3) bool: the unknown coordinates without heights of nodes that ``force`` presses on the seabed."""
        if self.seabed == -np.inf:
            return self.unknown
        pressed = (r[:, 2] <= self.min_z) & (force[:, 2] <= 0)
        if not np.count_nonzero(pressed):
            return self.unknown
        moving = self.unknown.copy()
        moving[pressed, 2] = False
        return moving

    def lift_to_seabed(self, r):
        """Lift the free nodes of r (n, 3) that are below the seabed onto it, in place; returns r."""
        np.maximum(r[:, 2], self.min_z, out=r[:, 2])
        return r

    def solve_elements(self, r):
        """Return the Elements, each an exact span between the nodes at r (n, 3), m."""
        geometry = Geometry(self, r)
        return Elements(geometry, *exact_forces(self, geometry))

    def unbalanced_force(self, elements, Q=None):
        """Return the sum (n, 3) of all forces on each node, N; ``Q`` (4, e) instead of the elements' own if given."""
        H, V, H_anchor, V_anchor = elements.Q if Q is None else Q
        pull, direction = np.empty((6, H.size)), elements.geometry.direction
        pull[0:2], pull[2] = H_anchor * direction, V_anchor
        pull[3:5], pull[5] = -H * direction, -V
        return self.load + np.bincount(self.end_coordinates, pull.ravel(), self.load.size).reshape(-1, 3)

    def tangent(self, elements):
        """Return -d(unbalanced_force)/dr of the unknown nodes, (3m, 3m), N/m; sparse (csc) beyond MAX_DENSE unknowns.

        Positive semidefinite without friction: the second derivative of the potential energy.
        """
        values, n = elements.tangents().ravel()[self.used], self.size
        if n > MAX_DENSE:
            indices, starts = self.csc_pattern
            return sparse.csc_matrix((np.bincount(self.entry, values, indices.size), indices, starts), shape=(n, n))
        return np.bincount(self.entry, values, n * n).reshape(n, n)


class Geometry:
    """l (e,), direction (2, e) of the vertical planes, rise (e,), clearance (e,) of the anchor ends, friction (e,).

    rounding : (e,) m, to which distances are known; vertical : (e,) bool, l = 0, set only where ``any_vertical``: any
        azimuth will do, and H/l has a limit; divisor : (e,) l, but 1 where it is 0
    """

    def __init__(self, equations, r):
        ends = r.take(equations.both_ends, 0)
        anchor_z, chord = ends[: equations.w.size, 2], ends[equations.w.size :] - ends[: equations.w.size]
        x, y, self.rise = chord.T
        self.r, self.l = r, np.hypot(x, y)
        self.rounding = ROUNDING * np.abs(r).max() + equations.length_rounding
        self.divisor, self.direction, self.any_vertical = self.l, chord.T[:2], np.count_nonzero(self.l) < self.l.size
        if self.any_vertical:
            self.vertical = self.l == 0
            self.divisor = np.where(self.vertical, 1.0, self.l)
            self.direction = np.array([np.where(self.vertical, 1.0, x), y])
        self.direction = self.direction / self.divisor
        self.clearance, self.friction = equations.zeros, equations.friction
        if equations.any_can_rest:
            self.clearance = anchor_z - equations.seabed
            if not equations.all_can_rest:
                self.clearance = self.clearance * equations.can_rest
        if equations.any_friction:  # where the anchor end lies on the seabed
            self.friction = np.where(self.clearance > 0, 0.0, equations.friction)

    @cached_property
    def frame(self):
        """(e, 4, 6) and (e, 6, 6) of ``_frame``, which is linear in 1 and the direction."""
        one_and_direction = np.empty((self.l.size, 3))
        one_and_direction[:, 0], one_and_direction[:, 1:] = 1.0, self.direction.T
        frame = (one_and_direction @ FRAME).reshape(-1, 10, 6)
        return frame[:, :4], frame[:, 4:]


def _frame(c, s):
    """Return the two transformations of an element in direction (c, s), one above the other, (10, 6).

    (4, 6): d(l, z_a, z_f, t)/d(r_a, r_f), with t across the vertical plane; (6, 6): (pull on r_a, pull on r_f) from
    (H, V, H_anchor, V_anchor) and the two forces across, sign reversed.
    """
    motion, pulls = np.zeros((4, 6)), np.zeros((6, 6))
    along, across = np.array([c, s]), np.array([-s, c])
    motion[0, 0:2], motion[0, 3:5], motion[1, 2], motion[2, 5] = -along, along, 1.0, 1.0
    motion[3, 0:2], motion[3, 3:5] = -across, across
    pulls[3:5, 0], pulls[5, 1], pulls[0:2, 2], pulls[2, 3] = along, 1.0, -along, -1.0
    pulls[3:5, 4], pulls[0:2, 5] = across, -across
    return np.vstack([motion, pulls])


FRAME = np.array([_frame(0, 0), _frame(1, 0) - _frame(0, 0), _frame(0, 1) - _frame(0, 0)]).reshape(3, 60)


def exact_forces(equations, geometry, rows=slice(None)):
    """Return (H, V, H_anchor, V_anchor) (4, k) of exact spans, the call that gives their D (k, 4, 3), span iterations.

    rows : elements that are solved, all by default
    """
    eq = equations
    lines = eq.w, eq.EA, eq.L, geometry.l, geometry.rise, eq.can_rest, geometry.friction, geometry.clearance
    w, EA, *lines = (column[rows] for column in lines)  # type: ignore[assignment]
    is_finite = np.isfinite(geometry.l + geometry.rise).all()
    solve_spans = solve_scalar_spans if w.size <= MAX_SCALAR_SPANS and is_finite else span_arrays
    H, V, H_anchor, V_anchor, _, K, regime, _, iterations = solve_spans(w, EA, *lines)  # type: ignore[call-arg]
    Q = np.array([H, V, H_anchor, V_anchor])
    return Q, partial(exact_derivatives, Q, K, regime, w, EA, geometry.friction[rows]), int(np.sum(iterations))


def exact_derivatives(Q, K, regime, w, EA, friction):
    """Return D (k, 4, 3) of exact spans, from their stiffness K (4, k) = d(H, V)/d(l, rise)."""
    H, _, H_anchor, V_anchor = Q
    K = np.where(np.isinf(K), 0.0, K)  # infinite: the end rests on the seabed
    D_H, D_V = np.stack([K[0], -K[1], K[1]], axis=-1), np.stack([K[2], -K[3], K[3]], axis=-1)
    D = np.stack([D_H, D_V, D_H, D_V], axis=-2)
    resting = (regime == GROUNDED) | (regime == LYING)
    if resting.any():
        D[resting, :, 1] = D[resting, 3] = 0.0
        # H_anchor = max(H - CB w L_B, 0) with L_B = L - V/w (the B block of 4.11 corrected)
        pulled = D[resting, 0] + friction[resting, None] * D[resting, 1]
        D[resting, 2] = np.where(H_anchor[resting, None] > 0, pulled, 0.0)
    slack = regime == SLACK
    if slack.any():
        D[slack] = 0.0
        D[slack, 1, 2], D[slack, 3, 1] = K[3][slack], -w[slack] / (1 - V_anchor[slack] / EA[slack])
    sagging = regime == SAGGING
    if sagging.any():
        D[sagging] = _sagging_derivatives(K[:, sagging], H[sagging], -V_anchor[sagging], w[sagging], EA[sagging])
    return D


def solve_scalar_spans(*lines):
    """Return the results of ``span_arrays``, span by span in plain floats: for few lines arrays cost more."""
    with np.errstate(all="ignore"):
        rows = zip(*(column.tolist() for column in lines), strict=True)
        columns = np.array([solve(SCALAR, solve_one, *line, TOLERANCE) for line in rows]).T  # type: ignore[call-arg]
    return *columns[:5], columns[5:9], columns[9], columns[10], columns[11]


def _sagging_derivatives(K, H, lift, w, EA):
    """Return D (k, 4, 3) of lines on the seabed between raised ends: the anchor end hangs from its own height."""
    K11, K12, K21, K22 = K
    T = np.sqrt(H * H + lift * lift)
    raised = lift > 0
    end_stiffness = np.where(raised, w / np.where(raised, lift / T + lift / EA, 1.0), 0.0)  # d(lift)/dc at given H
    a = -lift / (w * T) * (lift / (T + H)) * end_stiffness
    dH = np.stack([K11, -a * K11, K12], axis=-1)
    dV = np.stack([K21, -a * K21, K22], axis=-1)
    d_lift = np.stack([-a * K11, end_stiffness + a * a * K11, -a * K12], axis=-1)
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
        """(e, 4, 3), by the call ``derivatives``."""
        return self.derivatives()

    def tangents(self, in_plane=None):
        """Return -d(force on anchor node, force on fairlead node)/d(r_a, r_f), (e, 6, 6); at l = 0 the limit H/l = K11.

        in_plane : derivatives in the plane of each element instead of D
        """
        g = self.geometry
        motion, pulls = g.frame
        D = np.zeros((self.H.size, 6, 4))
        D[:, :4, :3] = self.D if in_plane is None else in_plane
        D[:, 4, 3], D[:, 5, 3] = self.H / g.divisor, self.H_anchor / g.divisor
        if g.any_vertical:
            D[g.vertical, 4, 3], D[g.vertical, 5, 3] = self.D[g.vertical, 0, 0], self.D[g.vertical, 2, 0]
        return pulls @ D @ motion
