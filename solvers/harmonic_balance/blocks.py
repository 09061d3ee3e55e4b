"""Blocks of the harmonic balance, HB (72)-(74): P^T diag(g) Q + P^T diag(h) Q_t of sampled tangents g and h.

A product of harmonics k and l is one of k - l and one of k + l, so a block is made of the coefficients of g and h up to
2 Nh, at any number of samples: work Nh^2, where sums over the samples take Nt Nh^2.
"""

from __future__ import annotations

import math

import numpy as np

from ..numerics.compiled import compiled


class Blocks:
    """The way from sampled tangents to blocks, for the Fourier functions of a Basis.

    Of rows and fields those coefficients count that ``columns`` and ``rows`` name: of each an index array into (51),
    every sine before its cosine.
    """

    def __init__(self, basis, columns):
        self.basis, self.columns, Nh = basis, self.harmonics(columns, basis), basis.harmonics
        angle = np.multiply.outer(basis.omega * basis.times, np.arange(-Nh, 2 * Nh + 1))
        waves = np.concatenate([np.cos(angle), np.sin(angle)], axis=1) / basis.samples
        self.waves = {np.dtype(real): waves.astype(real) for real in (np.float32, float)}

    @staticmethod
    def harmonics(active, basis):
        """Where the coefficients of each row or field begin, and their harmonics."""
        k = basis.harmonic[np.concatenate([[], *active]).astype(int)]
        return np.cumsum([0, *map(len, active)]), k.astype(np.uint64)  # of a sign the loops would take care

    def __call__(self, by_y, by_ydot, rows, precision, first=0, last=None, by_yddot=()):
        """(..., m, r, n) of tangents (..., n_r, n_f, nodes, Nt) at m nodes or cells, those of the slice first:last.

        rows: as ``harmonics`` gives them. precision: np.float32 or float. by_yddot: none, or those of one more
        derivative. Raises ValueError where shapes do not fit.
        """
        lead, shape, (to, k), (at, l) = by_y.shape[:-4], by_y.shape[-4:], rows, self.columns
        fits = (to.size - 1, at.size - 1, *shape[2:3], self.basis.samples)
        if any(other.shape != by_y.shape for other in (by_ydot, *by_yddot)) or shape != fits:
            raise ValueError(f"tangents of shape {by_y.shape} and {by_ydot.shape} do not fit to {to.size - 1} rows, "
                             f"{at.size - 1} fields and {self.basis.samples} samples")  # fmt: skip
        first, last, _ = slice(first, last).indices(shape[2])
        parts, out = math.prod(lead), np.zeros((*lead, max(last - first, 0), k.size, l.size), precision)
        for order, tangent in enumerate((by_y, by_ydot, *by_yddot)):
            tangent, rate = (
                np.ascontiguousarray(tangent, float).reshape(parts, *shape),
                self.basis.omega if order else 0.0,
            )
            blocks = out.reshape(parts, *out.shape[-3:])
            _add_all(blocks, tangent, self.waves[out.dtype], to, k, at, l, rate, order == 2, first)
        return out


@compiled
def _add(block, cos, sin, rows, columns, rate, twice):
    """Add P^T diag(g) Q, or with a rate P^T diag(g) Q_t or ``twice`` Q_tt, of rows and columns with these harmonics.

    cos, sin: sums of g cos(m w t) and g sin(m w t) over Nt, m = -Nh..2 Nh. A harmonic is exact in single precision and
    leaves that of a product with it to the other factor.
    """
    if rows.size == 0 or columns.size == 0:
        return
    zero, root = np.uint64(cos.size // 3), np.sqrt(block.dtype.type(2.0))
    first, begin = int(rows[0] == 0), int(columns[0] == 0)  # the constant function is a cosine over the root of two
    for i in range(first, rows.size, 2):
        k = rows[i]
        for j in range(begin, columns.size, 2):
            l = columns[j]
            less, more = zero + k - l, zero + k + l
            ss, sc = cos[less] - cos[more], sin[more] + sin[less]  # sin k with sin l and cos l
            cs, cc = sin[more] - sin[less], cos[less] + cos[more]  # cos k with them
            if twice:
                w = -((np.float32(np.int64(l)) * rate) ** 2)
                ss, sc, cs, cc = w * ss, w * sc, w * cs, w * cc
            elif rate:
                w = np.float32(np.int64(l)) * rate
                ss, sc, cs, cc = w * sc, -w * ss, w * cc, -w * cs
            block[i, j] += ss
            block[i, j + 1] += sc
            block[i + 1, j] += cs
            block[i + 1, j + 1] += cc
        if begin and not rate:
            block[i, 0] += root * sin[zero + k]
            block[i + 1, 0] += root * cos[zero + k]
    for j in range(begin, columns.size if first else 0, 2):
        s, c = root * sin[zero + columns[j]], root * cos[zero + columns[j]]
        if twice:
            w = -((np.float32(np.int64(columns[j])) * rate) ** 2)
            s, c = w * s, w * c
        elif rate:
            w = np.float32(np.int64(columns[j])) * rate
            s, c = w * c, -w * s
        block[0, j] += s
        block[0, j + 1] += c
    if first and begin and not rate:
        block[0, 0] += cos[zero]


@compiled
def _add_still(block, value, rows, columns, rate, twice):
    """The same of a g that does not change: only a harmonic with itself, or with one rate a sine with its cosine."""
    if value == 0 or rows.size == 0 or columns.size == 0:
        return
    first, j = int(rows[0] == 0), int(columns[0] == 0)
    if first and j and not rate:
        block[0, 0] += value
    for i in range(first, rows.size, 2):
        while j < columns.size and columns[j] < rows[i]:
            j += 2
        if j < columns.size and columns[j] == rows[i]:
            if twice:
                block[i, j] -= (np.float32(rows[i]) * rate) ** 2 * value
                block[i + 1, j + 1] -= (np.float32(rows[i]) * rate) ** 2 * value
            elif rate:
                block[i, j + 1] -= np.float32(rows[i]) * rate * value
                block[i + 1, j] += np.float32(rows[i]) * rate * value
            else:
                block[i, j] += value
                block[i + 1, j + 1] += value


@compiled
def _still(tangent):
    """Whether samples (nodes, Nt) do not change in time."""
    for samples in tangent:
        for value in samples:
            if value != samples[0]:
                return False
    return True


@compiled
def _add_all(out, tangents, waves, to, k, at, l, rate, twice, first):
    """Add the blocks (parts, m, r, n) of tangents (parts, n_r, n_f, nodes, Nt), from node ``first`` on."""
    parts, n_r, n_f, _, Nt = tangents.shape
    nodes, count, rate = out.shape[1], waves.shape[1] // 2, out.dtype.type(rate)
    sampled, result = np.empty((nodes, Nt), out.dtype), np.empty((nodes, waves.shape[1]), out.dtype)
    for p in range(parts):
        for a in range(n_r):
            for b in range(n_f):
                tangent = tangents[p, a, b, first : first + nodes]
                blocks = out[p, :, to[a] : to[a + 1], at[b] : at[b + 1]]
                rows, columns = k[to[a] : to[a + 1]], l[at[b] : at[b + 1]]
                if _still(tangent):
                    for i in range(nodes):
                        _add_still(blocks[i], out.dtype.type(tangent[i, 0]), rows, columns, rate, twice)
                else:
                    sampled[:] = tangent
                    np.dot(sampled, waves, result)
                    for i in range(nodes):
                        _add(blocks[i], result[i, :count], result[i, count:], rows, columns, rate, twice)
