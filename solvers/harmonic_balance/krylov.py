"""Newton step of the harmonic balance without its blocks: GMRES on the sampled tangents, preconditioned by harmonics.

With the tangents averaged over the period the harmonics part, and each is a linear chain, (A + i k omega B) x_k = f_k
in band storage; what the average leaves out, the coupling of the harmonics, is small beside it. Storage and work grow
with N Nh, or N Nh^2 where the samples are transformed; blocks take N Nh^2 and N Nh^3.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse.linalg import LinearOperator, gmres

from ..numerics.chain import BandedJacobian, Residual, stack
from ..numerics.lu.bordered import BlockChain

_ACCURACY = 1e-9  # of a Newton step, relative: two Newton steps then end below any tolerance that is asked
_BASIS = 200  # vectors kept before GMRES gives up; to restart it with fewer does not help where harmonics couple


class HarmonicKrylov:
    """The Jacobian of a HarmonicResidual at sampled rows, as a product and an approximate inverse.

    singular: True where there is no inverse.
    """

    def __init__(self, balance, rows, state):
        self.balance, self.rows = balance, rows
        system, basis = balance.system, balance.basis
        drift = system.drift(balance.rest, 0.0) if basis.mean else None
        self.slope = None if drift is None else system.drift_tangent(state[0])
        averages = [(part.dy.mean(axis=-1), part.dydot.mean(axis=-1)) for part in rows]
        self.factors, self.singular = [], False
        if basis.mean:
            start, cells, end = (by_y for by_y, _ in averages)
            full = np.zeros((0, *balance.rest.T.shape))
            if drift is not None:
                end = end[: len(end) - len(drift)]
                full = np.moveaxis(self.slope.mean(axis=-1), 2, 1)  # type: ignore[union-attr]
            self.still = BlockChain(start, np.moveaxis(cells, 3, 1), end, full)
            self.singular |= self.still.singular
        for k in range(1, basis.harmonics + 1):
            chain = BandedJacobian(len(system.fields), system.nodes, system.start_rows, complex)
            good = chain.factorise(*(by_y + 1j * k * basis.omega * by_ydot for by_y, by_ydot in averages))
            self.singular |= not good
            self.factors.append(chain)

    def solve(self, F):
        """J^-1 F, (N, n); not a number where GMRES does not get there."""
        balance = self.balance
        shape = (balance.rest.shape[1], balance.n)
        right = self.precondition(F).ravel()
        product = lambda x: self.precondition(self.product(x.reshape(shape))).ravel()
        operator = LinearOperator((right.size, right.size), product)
        x, info = gmres(operator, right, rtol=_ACCURACY, atol=0.0, restart=_BASIS, maxiter=1)
        return x.reshape(shape) if info == 0 else np.full(shape, np.nan)

    def product(self, x) -> np.ndarray:
        """J x as a vector of rows, x (N, n)."""
        return self.balance.product(self.rows, self.slope, x)

    def precondition(self, F) -> np.ndarray:
        """The averaged Jacobian's inverse times a vector of rows, (N, n)."""
        balance, basis = self.balance, self.balance.basis
        start, cells, end, drift = balance.coefficients(F)
        z, first = np.zeros((*balance.rest.shape, basis.harmonic.size)), int(basis.mean)
        if first:
            kept = len(end) - len(drift)
            z[..., 0] = self.still.solve(start[:, 0], cells[..., 0].T, end[:kept, 0], drift).T
        for k, chain in enumerate(self.factors):
            s, c = first + 2 * k, first + 2 * k + 1
            right = stack(*(Residual(part[..., c] - 1j * part[..., s]) for part in (start, cells, end)))
            result = chain.solve(right).reshape(balance.rest.T.shape).T
            z[..., c], z[..., s] = result.real, -result.imag
        return balance.pack(z)
