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
EVERY_BLOCK, LATER = 96, 1.25  # size up to which each block is looked at; beyond, what it grows by between two looks
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
    most = size // (2 * BLOCK) * BLOCK
    V, H = np.zeros((size, most + BLOCK)), np.zeros((most + BLOCK, most))
    V[:, :BLOCK] = np.linalg.qr(np.random.default_rng(0).normal(size=(size, BLOCK)))[0]
    look = BLOCK
    for m in range(BLOCK, most + 1, BLOCK):
        known, last = V[:, :m], slice(m - BLOCK, m)
        new = period.apply(np.ascontiguousarray(V[:, last]))
        for _ in range(2):  # the second time takes out what rounding left
            along = known.T @ new
            new = new - known @ along
            H[:m, last] += along
        Q, R = np.linalg.qr(new)
        V[:, m : m + BLOCK] = np.linalg.qr(Q - known @ (known.T @ Q))[0]
        H[m : m + BLOCK, last] = R
        if m < look and m < most:
            continue
        look = m + BLOCK if m < EVERY_BLOCK else int(LATER * m)
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
