"""The leading eigenvalues of a map over a period that is known by what it does: block Arnoldi, or all of a small one.

A map that damps most disturbances has few eigenvalues that count, and a block of random disturbances shows them after a
few periods (Y. Saad, Numerical Methods for Large Eigenvalue Problems, 2011, 6.5). A block also shows several modes of
one eigenvalue, which a single disturbance does not.
"""

from __future__ import annotations

import numpy as np

from ..numerics.threads import one_blas_thread

MAX_DENSE = 100  # size up to which all disturbances are taken over the period at once
BLOCK = 12  # disturbances at a time: as long as they fit into the registers of a loop they cost little more than one
FLOOR = 1e-3  # eigenvalues from this size on are wanted, for smaller disturbances are gone after a period
LEAST = 4  # so many of the largest are wanted in any case
TOLERANCE = 1e-9  # of the residual of a wanted eigenvector of length one, of the largest eigenvalue, at least of one
CHECK_EACH_BLOCK, CHECK_GROWTH = 96, 1.25  # size up to which eigenvalues are taken after each block; then its growth
ZERO = 1e-14  # of the largest entry, below which nothing new is left


def leading_eigenvalues(period) -> np.ndarray:
    """Return eigenvalues (m,) of ``period.apply``, largest first: all up to ``MAX_DENSE``, else all above ``FLOOR``.

    period: has a ``size`` and apply((size, k)) -> (size, k).
    """
    with one_blas_thread():
        if period.size > MAX_DENSE:
            return _block_arnoldi(period)
        return largest_first(np.linalg.eigvals(period.apply(np.eye(period.size))))


def largest_first(values):
    """Return values in the order of their size."""
    return values[np.argsort(-abs(values), kind="stable")]


def _block_arnoldi(period):
    """Return the wanted eigenvalues; all of them where the wanted ones need more than half of the space."""
    size = period.size
    max_size = size // (2 * BLOCK) * BLOCK
    V, H = np.zeros((size, max_size + BLOCK)), np.zeros((max_size + BLOCK, max_size))
    V[:, :BLOCK] = np.linalg.qr(np.random.default_rng(0).normal(size=(size, BLOCK)))[0]
    next_check = BLOCK
    for m in range(BLOCK, max_size + 1, BLOCK):
        known, last = V[:, :m], slice(m - BLOCK, m)
        new = period.apply(np.ascontiguousarray(V[:, last]))
        for _ in range(2):  # the second time takes out what rounding left
            along = known.T @ new
            new = new - known @ along
            H[:m, last] += along
        Q, R = np.linalg.qr(new)
        V[:, m : m + BLOCK] = np.linalg.qr(Q - known @ (known.T @ Q))[0]
        H[m : m + BLOCK, last] = R
        if m < next_check and m < max_size:
            continue
        next_check = m + BLOCK if m < CHECK_EACH_BLOCK else int(CHECK_GROWTH * m)
        values, vectors = np.linalg.eig(H[:m, :m])
        residual = np.linalg.norm(R @ vectors[last], axis=0)
        order = np.argsort(-abs(values), kind="stable")
        wanted = order[: max(LEAST, int((abs(values) >= FLOOR).sum()))]
        scale = max(1.0, abs(values).max())
        if (residual[wanted] <= TOLERANCE * scale).all() or abs(R).max() <= ZERO * abs(H).max():
            return values[wanted]
    return _all_eigenvalues(period, V, H)


def _all_eigenvalues(period, V, H):
    """Return all eigenvalues, of which disturbances V and their images V H are known: the others are taken as well."""
    m = H.shape[1]
    basis = np.hstack([V[:, :m], np.linalg.qr(V[:, :m], mode="complete")[0][:, m:]])
    images = np.hstack([V @ H, period.apply(np.ascontiguousarray(basis[:, m:]))])
    return largest_first(np.linalg.eigvals(basis.T @ images))
