"""The leading eigenvalues of a map over a period that is known by what it does: block Arnoldi, or all of a small one.

A map that damps most disturbances has few eigenvalues that decide, and a block of random disturbances shows them after
a few periods (Y. Saad, Numerical Methods for Large Eigenvalue Problems, 2011, 6.5). A block also shows several modes of
one eigenvalue, which a single disturbance does not. Eigenvalues below a least size are not waited for but the largest,
and that to a few digits: of a fine mesh these are many waves damped alike, which come out together and late.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...numerics.threads import one_blas_thread

MAX_DENSE = 100  # size up to which all disturbances are taken over the period at once
FLOOR = 1e-3  # eigenvalues from this size on are wanted, if no other size is asked for, and in any case the largest
TOLERANCE = 1e-9  # of the residual of a wanted eigenvector of length one, of the largest eigenvalue, at least of one
RELATIVE = 1e-5  # of the residual of one below the least size, of its own size
LEAST = 6  # so many are returned in any case, as far as they are as exact as that
CHECK_EACH_BLOCK, CHECK_GROWTH = 192, 1.25  # size up to which eigenvalues are taken after each block; then its growth
ZERO = 1e-14  # of the largest entry, below which nothing new is left


class LeadingEigenvalues(NamedTuple):
    """The largest eigenvalues of a map: values (m,), largest first, and residuals (m,) of their vectors of length one.

    None is left out between them: all from the least size on, at least the first, and what is known of the next.
    """

    values: np.ndarray
    residuals: np.ndarray


def leading_eigenvalues(period, least_size=FLOOR) -> LeadingEigenvalues:
    """Return the eigenvalues of ``period.apply`` from a size on; of a map up to ``MAX_DENSE`` all of them.

    period: has a ``size``, apply((size, k)) -> (size, k), and the ``columns`` k that it takes at little more than one.
    """
    with one_blas_thread():
        if period.size > MAX_DENSE:
            return _block_arnoldi(period, least_size)
        return _all_of(np.linalg.eigvals(period.apply(np.eye(period.size))))


def largest_first(values):
    """Return values in the order of their size."""
    return values[np.argsort(-abs(values), kind="stable")]


def _all_of(values):
    """Return the LeadingEigenvalues of a whole matrix, exact but for rounding."""
    return LeadingEigenvalues(largest_first(values), np.zeros(values.size))


def _block_arnoldi(period, least_size):
    """Return the wanted eigenvalues; all of them where most of half of the space is wanted, or the space ends."""
    size, block = period.size, period.columns
    V, H = np.linalg.qr(np.random.default_rng(0).normal(size=(size, block)))[0], np.zeros((block, 0))
    next_check = block
    for m in range(block, size - block + 1, block):
        V, H, R = _extend(V, H, period.apply(np.ascontiguousarray(V[:, m - block :])))
        if m < next_check:
            continue
        next_check = m + block if m < CHECK_EACH_BLOCK else int(CHECK_GROWTH * m)
        values, vectors = np.linalg.eig(H[:m])
        order = np.argsort(-abs(values), kind="stable")
        values, residuals = values[order], np.linalg.norm(R @ vectors[m - block :], axis=0)[order]
        wanted = max(1, int((abs(values) >= least_size).sum()))
        exact = _count_exact(values, residuals, least_size)
        if exact >= wanted or abs(R).max() <= ZERO * abs(H).max():
            listed = max(wanted, min(exact, LEAST))
            listed += values[listed - 1].imag > 0  # its conjugate
            return LeadingEigenvalues(values[:listed], residuals[:listed])
        if m >= size / 2 and wanted > m / 2:
            break
    return _all_eigenvalues(period, V, H)


def _extend(V, H, new):
    """Return disturbances V, their matrix H and its last block R after the images of the last block of V."""
    along = np.zeros((V.shape[1], new.shape[1]))
    for _ in range(2):  # the second time takes out what rounding left
        part = V.T @ new
        new = new - V @ part
        along += part
    Q, R = np.linalg.qr(new)
    Q = np.linalg.qr(Q - V @ (V.T @ Q))[0]
    below = np.hstack([np.zeros((R.shape[0], H.shape[1])), R])
    return np.hstack([V, Q]), np.vstack([np.hstack([H, along]), below]), R


def _count_exact(values, residuals, least_size):
    """Return how many values, largest first, come before the first one whose residual is too large."""
    sizes = abs(values)
    bounds = np.where(sizes >= least_size, TOLERANCE * max(1.0, sizes[0]), RELATIVE * sizes)
    return int(np.logical_and.accumulate(residuals <= bounds).sum())


def _all_eigenvalues(period, V, H):
    """Return all eigenvalues, of which disturbances V and their images V H are known: the others are taken as well."""
    m = H.shape[1]
    basis = np.hstack([V[:, :m], np.linalg.qr(V[:, :m], mode="complete")[0][:, m:]])
    images = np.hstack([V @ H, period.apply(np.ascontiguousarray(basis[:, m:]))])
    return _all_of(np.linalg.eigvals(basis.T @ images))
