"""Networks turned, reflected and renumbered, and what any solver must then give.

Each change returns a `Change`: the changed network and the way back for results per node and per cell in the order of
`moving_network.Mesh`. A solver's result for the changed network, mapped back, must equal that for the original. For
lines in n-fold symmetry about a vertical axis under a body that moves in a circle or stands still, `shift_error` says
how far the tensions of the lines are from one history with a shift in time.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from verification.exact.mooring.moving_network import Lines, Mesh, Network, Nodes
from verification.exact.rigid_motion import RigidMotion

STRAIGHT_ANGLE = 1e-12  # rad: by so much a quarter or half turn may be off


@dataclass(frozen=True)
class Change:
    """A changed network and the way back from its results to the original's.

    node (size,), cell (c,), line (e,) : place in the changed mesh of each node, cell and line of the original
    swapped (e,) : which lines of the original have changed their ends;  matrix (3, 3) : orthogonal, original to changed
    axis (3,) : m, a point that the matrix leaves where it is
    """

    network: Network
    node: np.ndarray
    cell: np.ndarray
    line: np.ndarray
    swapped: np.ndarray
    matrix: np.ndarray
    axis: np.ndarray

    def vectors_back(self, values):
        """Return velocities or forces (..., size, 3) of the changed mesh for the original's nodes and axes."""
        return np.asarray(values)[..., self.node, :] @ self.matrix

    def positions_back(self, values):
        """Return positions (..., size, 3), m, likewise."""
        return self.vectors_back(np.asarray(values) - self.axis) + self.axis

    def positions_forth(self, values):
        """Return positions (..., size, 3), m, of the original's nodes for the changed mesh."""
        result = np.empty(np.shape(values))
        result[..., self.node, :] = (np.asarray(values) - self.axis) @ self.matrix.T + self.axis
        return result

    def vectors_forth(self, values):
        """Return velocities (..., size, 3), m/s, of the original's nodes for the changed mesh."""
        return self.positions_forth(np.asarray(values) + self.axis) - self.axis

    def cells_back(self, values):
        """Return tensions (..., c) of the changed mesh for the original's cells."""
        return np.asarray(values)[..., self.cell]

    def ends_back(self, values):
        """Return numbers (..., e, 2) at the ends of the changed lines for the original's lines and ends."""
        values = np.asarray(values)[..., self.line, :]
        return np.where(self.swapped[:, None], values[..., ::-1], values)

    def moments_back(self, values):
        """Return moments (..., 3): they are axial, and turn round in a mirror."""
        return np.asarray(values) @ self.matrix * np.sign(np.linalg.det(self.matrix))


def _unchanged(network, **given):
    mesh, lines = Mesh(network), network.lines
    own = {
        "network": network,
        "node": np.arange(mesh.size),
        "cell": np.arange(len(mesh.l)),
        "line": np.arange(len(lines.ends)),
        "swapped": np.zeros(len(lines.ends), bool),
        "matrix": np.eye(3),
        "axis": np.zeros(3),
    }
    return Change(**(own | given))


# ---------------------------------------------------------------- in space
def rotate(network, angle, axis=(0.0, 0.0)):
    """Return the `Change` of a network turned by angle, rad, about the vertical axis through (x, y), m, current too.

    Raises ValueError where roll and pitch of the turned body would not be harmonic: with roll or pitch the angle is a
    multiple of a half turn, or of a quarter turn if one of them alone moves.
    """
    c, s = np.cos(angle), np.sin(angle)
    matrix = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return _moved(network, matrix, np.array([*axis, 0.0]), lambda motion: _turned(motion, angle))


def reflect(network, axis=(0.0, 0.0)):
    """Return the `Change` of a network reflected in the plane x, z through the point (x, y), m: y changes its sign."""
    signs = np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0])  # R reflected twice over is Rz(-yaw) Ry(pitch) Rx(-roll)
    flipped = lambda m: replace(m, amplitude=tuple(signs * m.amplitude), mean=tuple(signs * m.mean))
    return _moved(network, np.diag([1.0, -1.0, 1.0]), np.array([*axis, 0.0]), flipped)


def _moved(network, matrix, axis, change_motion):
    nodes, motion = network.nodes, change_motion(network.motion)
    moved = lambda r: (np.asarray(r, float) - axis) @ matrix.T + axis
    return _unchanged(
        replace(
            network,
            nodes=replace(nodes, position=moved(nodes.position), force=nodes.force @ matrix.T),
            motion=replace(motion, reference=tuple(moved(network.motion.reference))),
            current=tuple(matrix @ np.array(network.current)),
        ),
        matrix=matrix,
        axis=axis,
    )


def _turned(motion, angle):
    """Return a motion with its translation and rotation turned about the vertical."""
    wave = np.array(motion.amplitude, float) * np.exp(1j * np.array(motion.phase, float))
    mean = np.array(motion.mean, float)
    moves = [bool(wave[i] or mean[i]) for i in (3, 4)]
    unit = {0: None, 1: np.pi / 2, 2: np.pi}[sum(moves)]
    if unit and abs(angle / unit - round(angle / unit)) > STRAIGHT_ANGLE:
        raise ValueError(f"a body that rolls or pitches turns by multiples of {unit:.4f} rad only, not by {angle}")
    c, s = np.cos(angle), np.sin(angle)
    turn = lambda x, y: (c * x - s * y, s * x + c * y)
    rounded = lambda x, y: turn(x, y) if unit is None else tuple(np.round([c, s]) @ pair for pair in ([x, -y], [y, x]))
    for values in (wave, mean):
        values[0], values[1] = turn(values[0], values[1])
        values[3], values[4] = rounded(values[3], values[4])
    return replace(motion, amplitude=tuple(np.abs(wave)), phase=tuple(np.angle(wave)), mean=tuple(mean))


# ---------------------------------------------------------------- in their order
def renumber(network, nodes=None, lines=None, swapped=None):
    """Return the `Change` of a network with its nodes and lines in another order, and with some lines' ends swapped.

    nodes (n,), lines (e,) : which of the original stands at each place, permutations;  swapped (e,) : bool, of the
    original lines. None leaves as it is.
    """
    old, mesh = network.lines, Mesh(network)
    n, e = len(network.nodes.kind), len(old.ends)
    nodes = np.arange(n) if nodes is None else np.asarray(nodes)
    lines = np.arange(e) if lines is None else np.asarray(lines)
    swapped = np.zeros(e, bool) if swapped is None else np.asarray(swapped, bool)
    ends = np.where(swapped[:, None], old.ends[:, ::-1], old.ends)
    new_lines = Lines(
        ends=np.argsort(nodes)[ends][lines],
        cells=old.cells[lines],
        **{name: getattr(old, name)[lines] for name in Lines.PER_LINE},
    )
    new_nodes = Nodes(
        kind=tuple(network.nodes.kind[i] for i in nodes),
        **{k: getattr(network.nodes, k)[nodes] for k in ("position", "mass", "volume", "Ca", "CdA", "force")},
    )
    changed = replace(network, nodes=new_nodes, lines=new_lines)
    other, new_line = Mesh(changed), np.argsort(lines)
    node, cell = np.empty(mesh.size, int), np.empty(len(mesh.l), int)
    for i, chain in enumerate(mesh.chains):
        step = -1 if swapped[i] else 1
        node[chain] = other.chains[new_line[i]][::step]
        cell[mesh.line == i] = np.flatnonzero(other.line == new_line[i])[::step]
    node[nodes] = np.arange(n)
    return _unchanged(changed, node=node, cell=cell, line=new_line, swapped=swapped)


# ---------------------------------------------------------------- n-fold symmetry
def ring(n, *, radius, depth, fairlead_radius, length, cells, motion=None, line=None, **surroundings):
    """Return a network of n equal lines about the vertical axis, nodes 0..n-1 anchors, n..2n-1 coupled fairleads.

    radius, fairlead_radius, depth, length : m; anchors at z = -depth, fairleads at z = 0; line i at 2 pi i / n
    line : the other arguments of `Lines`;  surroundings : those of `Network`
    """
    angle = 2 * np.pi * np.arange(n) / n
    around = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(n)])
    position = np.concatenate([radius * around - (0.0, 0.0, depth), fairlead_radius * around])
    nodes = Nodes(position, ("fixed",) * n + ("coupled",) * n)
    ends = np.column_stack([np.arange(n), n + np.arange(n)])
    lines = Lines(ends, length, cells, **(line or {}))
    return Network(nodes, lines, motion or RigidMotion(), **surroundings)


def circling(radius, omega, heave=0.0):
    """Return the motion of a body whose reference point goes round the axis at omega t, at a constant heave."""
    return RigidMotion(
        omega=omega,
        amplitude=(radius, radius, 0.0, 0.0, 0.0, 0.0),
        phase=(0.0, -np.pi / 2, 0.0, 0.0, 0.0, 0.0),
        mean=(0.0, 0.0, heave, 0.0, 0.0, 0.0),
    )


def shift_error(tension):
    """Return the largest difference between lines of a `ring` under `circling`, over the largest tension.

    tension (n, samples) : of each line at one and the same place, over one period of the steady state, at equally
    spaced times without the last; samples is a multiple of n. Line i follows line 0 by i / n of a period. With a body
    at rest in the plane, or one that only heaves, any two lines are equal: pass the lines as they are to
    `spread_error`.
    """
    n, samples = np.shape(tension)
    if samples % n:
        raise ValueError(f"{samples} samples are not a multiple of {n} lines")
    shifted = [np.roll(tension[i], -i * samples // n) for i in range(n)]
    return spread_error(shifted)


def spread_error(tension):
    """Return the largest difference between lines (n, ...) over the largest tension."""
    return float(np.max(np.ptp(tension, axis=0)) / np.max(np.abs(tension)))


def ring_error(network, at_rest):
    """Return the largest difference, m, of a `ring`'s nodes at_rest (size, 3) from those of line 0 turned."""
    mesh = Mesh(network)
    chains, n = mesh.chains, len(mesh.chains)
    errors = []
    for i in range(n):
        c, s = np.cos(2 * np.pi * i / n), np.sin(2 * np.pi * i / n)
        turned = at_rest[chains[0]] @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]).T
        errors.append(np.abs(turned - at_rest[chains[i]]).max())
    return float(max(errors))
