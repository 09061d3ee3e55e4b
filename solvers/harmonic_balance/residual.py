"""Rows of a chain in Fourier coefficients, HB (63), and their Jacobian (72)-(74), from sampled rows and tangents.

Mean: rows that see only rates cannot tell the mean position, so with the constant term kept the mean of the last node's
rows is replaced by the mean of ``ChainSystem.drift``. Without the constant term (the paper's variant) the mean balance
of forces is not solved.
"""

from __future__ import annotations

import copy
import math

import numpy as np

from ..numerics.lu.bordered import BlockChain
from .blocks import Blocks

SINGLE_PRECISION_FROM = 48  # unknowns of a node from which on single precision saves more than its check costs
CELLS_AT_ONCE = 32  # cells whose blocks exist at once, beside the factors
MAX_REFINEMENT = 1e-2  # size of a refinement beside its solution above which single precision does not do
SYMMETRY_TOLERANCE = 1e-9  # share of the rows that may be left where a symmetry says zero
_NONE = np.empty(0, int)


def harmonic_residual(system, basis, mirror=None):
    """Return the HarmonicResidual of a chain, or what another system gives in its place with the same methods."""
    build = getattr(system, "harmonic_residual", None)
    return HarmonicResidual(system, basis, mirror) if build is None else build(basis, mirror)


def find_mirror(system, basis):
    """Signs of the chain's mirror if its rows at a random state and at the image of it half a period later agree.

    At every sample, each with a state of its own: a few would miss a short push. None where they do not agree, or where
    the chain has no mirror.
    """
    mirror = system.mirror()
    if mirror is None:
        return None
    (fields, *signs), rng, rest = mirror, np.random.default_rng(1), system.rest_state()[..., None]
    half, t = math.pi / basis.omega, basis.times if basis.samples % 2 else basis.times[: basis.samples // 2]
    shape = (*rest.shape[:2], t.size)
    y, ydot = rest * (1 + 0.1 * rng.random(shape)) + 0.1 * rng.random(shape), rng.random(shape)
    turn = np.array(fields)[:, None, None]
    for part, sign in zip((system.start, system.cells_or_empty, system.end), signs, strict=True):
        here, there = part(y, ydot, t, False).value, part(turn * y, turn * ydot, t + half, False).value
        turned = (np.array(sign) * here.T).T
        if not abs(turned - there).max(initial=0) <= SYMMETRY_TOLERANCE * abs(here).max(initial=0):
            return None
    return mirror


class HarmonicResidual:
    """The rows (63) of a chain for the coefficients z, as a vector for Newton's method, and its Jacobian (72)-(74).

    x (N, n): the active coefficients of a node, field after field. Where a mirror maps the chain onto itself half a
    period later, fields that it keeps have even harmonics and fields that it turns have odd ones.
    """

    def __init__(self, system, basis, mirror=None):
        """mirror: signs as ``find_mirror`` gives them."""
        self.system, self.basis, self.rest, self.symmetric = system, basis, system.rest_state(), mirror is not None
        fields, start, cells, end = mirror or (None,) * 4
        n_f, first = len(system.fields), system.start_rows
        self.columns = self._active(fields, n_f)
        self.start_rows, self.cell_rows = self._active(start, first), self._active(cells, n_f)
        self.end_rows = self._active(end, n_f - first)
        drift = system.drift(self.rest, 0.0) if basis.mean else None
        self.mean_constraints = []  # components of the drift whose mean is in place of that of an end row
        if drift is not None:
            offset = n_f - first - len(drift)
            self.mean_constraints = [d for d in range(len(drift)) if 0 in self.end_rows[offset + d]]
            for d in self.mean_constraints:
                self.end_rows[offset + d] = self.end_rows[offset + d][1:]
        self.blocks = Blocks(basis, self.columns)
        self.n = sum(map(len, self.columns))
        parts = self.columns, self.start_rows, self.cell_rows, self.end_rows
        self.of_node, self.of_start, self.of_cell, self.of_end = (self._places(active) for active in parts)
        self.row_harmonics = [self.blocks.harmonics(active, basis) for active in parts[1:]]

    def _active(self, signs, count):
        """Coefficients (a list of index arrays) of each field or row."""
        k = self.basis.harmonic
        if signs is None:
            return [np.arange(k.size)] * count
        return [np.flatnonzero(k % 2 == (0 if sign > 0 else 1)) for sign in signs]

    def _places(self, active):
        """Of the active ones among all coefficients of a node, field after field, or of some rows."""
        places = np.concatenate([_NONE, *(c + f * self.basis.harmonic.size for f, c in enumerate(active))])
        return slice(None) if places.size == len(active) * self.basis.harmonic.size else places

    def start_is_symmetric(self, z) -> bool:
        """True if the start has the symmetry; otherwise symmetry is not used."""
        return bool(abs(self.unpack(self.pack(z)) - z).max() <= SYMMETRY_TOLERANCE * abs(z).max())

    def satisfies_omitted_rows(self, z) -> bool:
        """True if the solution also satisfies the rows that the symmetry leaves out: they are checked, not assumed."""
        if not self.symmetric:
            return True
        x = self.pack(z)
        rows, state = self.rows(x, False)
        every = HarmonicResidual(self.system, self.basis)._sampled(rows, state)
        left, size = abs(self._sampled(rows, state)).max(), abs(self.residual(0 * x)).max()
        return bool(abs(every).max() <= 2 * left + SYMMETRY_TOLERANCE * size)

    def with_system(self, system) -> HarmonicResidual:
        """Return the same rows of another system with the same fields, nodes and symmetry."""
        other = copy.copy(self)
        other.system = system
        return other

    def pack(self, z) -> np.ndarray:
        """x (N, n) of z (n_f, N, C)."""
        return np.swapaxes(z, 0, 1).reshape(z.shape[1], -1)[:, self.of_node]

    def unpack(self, x) -> np.ndarray:
        """z (n_f, N, C) of x (N, n)."""
        n_f, nodes = self.rest.shape
        z = np.zeros((nodes, n_f * self.basis.harmonic.size))
        z[:, self.of_node] = x
        return np.ascontiguousarray(z.reshape(nodes, n_f, -1).swapaxes(0, 1))

    def samples(self, x):
        """(y, ydot, t) at the samples."""
        z = self.unpack(x)
        return self.rest[..., None] + z @ self.basis.Q.T, z @ self.basis.Q_t.T, self.basis.times

    def rows(self, x, tangents):
        """start, cells and end rows at the samples, and the state there."""
        state = self.samples(x)
        parts = self.system.start, self.system.cells_or_empty, self.system.end
        return tuple(part(*state, tangents) for part in parts), state

    def residual(self, x) -> np.ndarray:
        """All rows as one vector."""
        return self._sampled(*self.rows(x, False))

    def _sampled(self, rows, state):
        drift = self.system.drift(state[0], state[2]) if self.mean_constraints else None
        return self.vector(*(part.value for part in rows), drift)  # type: ignore[call-arg]

    def vector(self, start, cells, end, drift) -> np.ndarray:
        """Active coefficients of sampled rows (n_r, *, Nt) and of the drift as one vector."""
        start, cells, end = start @ self.basis.P, cells @ self.basis.P, end @ self.basis.P
        middle = cells.swapaxes(0, 1).reshape(cells.shape[1], len(cells) * cells.shape[2])[:, self.of_cell]
        means = drift[self.mean_constraints] @ self.basis.P[:, 0] if self.mean_constraints else ()
        return np.concatenate([start.ravel()[self.of_start], middle.ravel(), end.ravel()[self.of_end], means])

    def linearise(self, x):
        """The residual and a function that solves with the Jacobian, None where it is singular."""
        rows, state = self.rows(x, True)
        F = self._sampled(rows, state)
        if not np.isfinite(F).all():
            return F, None
        slope = self.slope(state)
        if self.n >= SINGLE_PRECISION_FROM:
            factors = BlockChain(*self.jacobian(rows, slope, CELLS_AT_ONCE, np.float32))
            solve = lambda F: factors.solve(*self.split(F))
            step = solve(F)
            more = solve(F - self.product(rows, slope, step))
            if not factors.singular and abs(more).mean() <= MAX_REFINEMENT * abs(step).mean():
                return F, lambda right: step + more if right is F else solve(right)
        factors = BlockChain(*self.jacobian(rows, slope, CELLS_AT_ONCE, float))
        return F, None if factors.singular else lambda F: factors.solve(*self.split(F))

    def slope(self, state):
        """d(drift)/dy at the samples, (n_d, n_f, N, Nt), or None where no mean is closed with it."""
        return self.system.drift_tangent(state[0]) if self.mean_constraints else None

    def product(self, rows, slope, x) -> np.ndarray:
        """The Jacobian at sampled rows times x (N, n), as a vector of rows."""
        (start, cells, end), z = rows, self.unpack(x)
        moved = (z @ self.basis.Q.T, "dy"), (z @ self.basis.Q_t.T, "dydot")
        one = lambda part, node: sum(np.einsum("ijt,jt->it", getattr(part, by), d[:, node]) for d, by in moved)
        sides = (0, slice(None, -1)), (1, slice(1, None))
        between = sum(np.einsum("ijnt,jnt->int", getattr(cells, by)[i], d[:, at]) for d, by in moved for i, at in sides)
        drift = None if slope is None else np.einsum("djnt,jnt->dt", slope, moved[0][0])
        return self.vector(one(start, 0), between, one(end, -1), drift)

    def jacobian(self, rows, slope, part=None, precision=float):
        """Blocks of BlockChain: start (p, n), cells (2, N - 1, n, n), end (e, n), border (k, N, n).

        part: cells come as an iterator over parts of so many. precision: np.float32 or float.
        """
        start, cells, end = rows
        nodes = self.rest.shape[1]
        first, middle, last = self.row_harmonics
        between = lambda *some: self.blocks(cells.dy, cells.dydot, middle, precision, *some)
        blocks = (
            self.blocks(start.dy[:, :, None], start.dydot[:, :, None], first, precision)[0],
            between() if part is None else (between(i, i + part) for i in range(0, nodes - 1, part)),
            self.blocks(end.dy[:, :, None], end.dydot[:, :, None], last, precision)[0],
        )
        if not self.mean_constraints:
            return *blocks, np.zeros((0, nodes, self.n), precision)
        mean = slope[self.mean_constraints] @ (self.basis.P[:, :1] * self.basis.Q)  # (k, n_f, N, C)
        mean = np.swapaxes(mean, 1, 2).reshape(len(self.mean_constraints), nodes, -1)
        return *blocks, mean[..., self.of_node].astype(precision)

    def split(self, F):
        """Parts of a right-hand side as BlockChain takes them."""
        first, nodes = sum(map(len, self.start_rows)), self.rest.shape[1]
        middle = first + (nodes - 1) * self.n
        last = F.size - len(self.mean_constraints)
        return F[:first], F[first:middle].reshape(nodes - 1, self.n), F[middle:last], F[last:]
