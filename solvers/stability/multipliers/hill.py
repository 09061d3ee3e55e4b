"""Hill's problem: disturbances exp(mu t) times a series with the harmonics of the response, (J + mu D) z = 0.

J is the Jacobian of the harmonic balance, D that of the rates alone. The mu of all harmonics give the same multiplier
exp(mu T); of these one counts.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import eig
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigs

from ...harmonic_balance.residual import HarmonicResidual
from ...numerics.threads import one_blas_thread
from .dense import assemble
from .leading import FLOOR, largest_first

INFINITE = 1e8  # times the frequency, a Hill exponent of an algebraic row that rounding made finite
MAX_GROWTH = 50.0  # times the frequency, exp(2 pi 50) a period: no disturbance but an algebraic row, whose infinite
# exponent is double or defective and comes out as a large number
EDGE = 1e-6  # the bounds of a mean harmonic are moved so far: of a negative multiplier, with 1/2 and -1/2, one counts
SHIFTS = (0.1, 0.13, 0.17)  # of the frequency: exponents are sought about the first of these that is none itself
FIRST_COUNT, MAX_COUNT = 12, 200  # exponents that are sought at first, and at last
TAIL = 1e-2  # share of a mode's energy in its last two harmonics, from which on the series is too short to count
ARNOLDI_TOLERANCE = 1e-10  # of an exponent
LEAST_SPACE = 40  # vectors of Arnoldi between restarts: with fewer the solves vary with the cells by a factor of two


def hill_exponents(response) -> np.ndarray:
    """Return the Floquet exponents (m,) of Hill's problem, 1/s: of each multiplier that with the most central series.

    A multiplier has an exponent for each harmonic, its series moved by one from the next. The mean harmonic of a series
    lies between -1/2 and 1/2 for one of them alone, also where a wave is faster than every harmonic.
    """
    basis = response.basis
    residual = HarmonicResidual(response.system, basis)
    rows, state = residual.rows(residual.pack(response.z), True)
    J, D = assemble(*residual.jacobian(rows, residual.slope(state))), assemble(*_rate_blocks(residual, rows))
    mu, modes = eig(J, -D)
    is_finite = np.isfinite(mu) & (abs(mu) < INFINITE * basis.omega)  # rows without a rate have infinite ones
    central = _mean_harmonics(modes[:, is_finite], basis)
    return mu[is_finite][(central > EDGE - 0.5) & (central <= EDGE + 0.5)]


def _mean_harmonics(modes, basis):
    """Return the mean of the harmonics k of exp(i k omega t) in modes (.. C, m), weighed by their energy, (m,)."""
    parts = modes.reshape(-1, basis.harmonic.size, modes.shape[1])
    sine, cosine = parts[:, int(basis.mean) :: 2], parts[:, int(basis.mean) + 1 :: 2]
    k = np.arange(1, basis.harmonics + 1)
    energy = lambda part: (abs(part) ** 2).sum(axis=0)
    forth, back = energy(cosine - 1j * sine) / 4, energy(cosine + 1j * sine) / 4
    still = energy(parts[:, :1]).sum(axis=0) / 2 if basis.mean else 0.0
    return k @ (forth - back) / (forth.sum(axis=0) + back.sum(axis=0) + still)


def _rate_blocks(residual, rows):
    """Return the blocks of the rows' derivatives by rates alone, in the places of the Jacobian's."""
    parts = []
    for part, harmonics in zip(rows, residual.row_harmonics, strict=True):
        by_rate = part.dydot if part.dydot.ndim == 5 else part.dydot[:, :, None]
        parts.append(residual.blocks(by_rate, np.zeros(by_rate.shape), harmonics, float))
    start, cells, end = parts
    border = np.zeros((len(residual.mean_constraints), residual.rest.shape[1], residual.n))
    return start[0], cells, end[0], border


def line_multipliers(problem, omega, least_size=FLOOR) -> np.ndarray:
    """Return the multipliers (m,) from a size on that the series of Hill's problem of a line resolve, largest first.

    problem: has ``size``, inverse(sigma) and series(modes), as ``mooring.periodic.hill.LineHill``. Those exponents
    count that lie between -i omega / 2 and i omega / 2, whose modes have little energy in their last harmonics: modes
    much faster than the harmonics are not among them. By shift and invert, for more and more exponents about a real
    shift.
    """
    least, start = omega * np.log(least_size) / (2 * np.pi), np.random.default_rng(0).normal(size=problem.size)
    shifts = (shift * omega for shift in SHIFTS)
    with one_blas_thread():
        sigma, inverse = next((s, inverse) for s in shifts if (inverse := problem.inverse(s)) is not None)
        radius, most, count = np.hypot(sigma - least, omega / 2), min(problem.size - 2, MAX_COUNT), FIRST_COUNT
        mu, modes = _nearest(problem.size, inverse, sigma, min(count, most), start)
        while abs(mu - sigma).max(initial=0.0) < radius and count < most:
            count *= 2
            mu, modes = _nearest(problem.size, inverse, sigma, min(count, most), start)
    energy = (abs(problem.series(modes)) ** 2).sum(axis=0)
    is_whole = energy[-4:].sum(axis=0) <= TAIL * energy.sum(axis=0)
    counts = is_whole & (mu.real >= least) & (mu.imag > omega * (EDGE - 0.5)) & (mu.imag <= omega * (EDGE + 0.5))
    return largest_first(np.exp(mu[counts] * 2 * np.pi / omega))


def _nearest(size, inverse, sigma, count, start):
    """Return the exponents (m,) nearest to a shift, and their modes; fewer than ``count`` where Arnoldi has no more."""
    try:
        space = min(size, max(LEAST_SPACE, 2 * count + 1))
        inverses, modes = eigs(LinearOperator((size, size), inverse, dtype=float), count, v0=start, ncv=space,
                               tol=ARNOLDI_TOLERANCE)  # fmt: skip
    except ArpackNoConvergence as error:
        inverses, modes = error.eigenvalues, error.eigenvectors
    return sigma - 1 / inverses, modes
