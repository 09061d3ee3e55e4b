"""Fourier series of real periodic functions, between samples and coefficients (AFT).

y(t) = c_0/sqrt(2) + sum_k s_k sin(k w t / nu) + c_k cos(k w t / nu), HB (49); coefficients in the order of (51):
c_0, s_1, c_1, s_2, c_2, ..., without c_0 in the paper's variant.
"""

from __future__ import annotations

import math

import numpy as np
import scipy.fft


class Basis:
    """Harmonics 0 or 1 to Nh of angular frequency omega/nu (rad/s), sampled at Nt equal times of the period.

    times (Nt,) s; harmonic (C,): number k of each coefficient; Q, Q_t (Nt, C): the functions (55) and their rates;
    P (Nt, C): coefficients of samples f are f @ P, (61).
    """

    def __init__(self, harmonics: int, samples: int, omega: float, mean: bool):
        self.harmonics, self.samples, self.omega, self.mean = harmonics, samples, omega, mean
        self.times = 2 * math.pi / omega * np.arange(samples) / samples
        self.harmonic = np.concatenate([[0] if mean else [], np.repeat(np.arange(1, harmonics + 1), 2)]).astype(int)
        self.Q, self.Q_t = self.functions(self.times)
        self.P = 2 / samples * self.Q

    def functions(self, t):
        """Return q(t) and its rate, (S, C) each, for times (S,) in s, (55), (57)."""
        k = self.omega * np.arange(1, self.harmonics + 1)
        angle = np.multiply.outer(t, k)
        sin, cos, first = np.sin(angle), np.cos(angle), int(self.mean)
        q, q_t = np.zeros((2, len(t), self.harmonic.size))
        q[:, :first] = math.sqrt(0.5)
        q[:, first::2], q[:, first + 1 :: 2] = sin, cos
        q_t[:, first::2], q_t[:, first + 1 :: 2] = k * cos, -k * sin
        return q, q_t


def sample_series(basis, z, orders) -> np.ndarray:
    """Return a series and its derivatives, ``orders`` in all, at the samples of a Basis, (orders, Nt, M), by FFT.

    z (M, C): the coefficients. Work Nt log Nt, where the functions themselves take Nt C.
    """
    first, count = int(basis.mean), basis.samples // 2 + 1
    waves, result = np.zeros((count, len(z)), complex), np.empty((orders, basis.samples, len(z)))
    waves[0] = math.sqrt(2) * z[:, :first].sum(axis=1)
    waves[1 : basis.harmonics + 1] = (z[:, first + 1 :: 2] - 1j * z[:, first::2]).T
    rate = 1j * basis.omega * np.arange(count)[:, None]
    for order in range(orders):
        result[order] = scipy.fft.irfft(basis.samples / 2 * rate**order * waves, basis.samples, axis=0)
    return result


def project_samples(basis, f) -> np.ndarray:
    """Return the coefficients (M, C) of samples f (Nt, M), f @ P, by FFT."""
    first = int(basis.mean)
    waves = 2 / basis.samples * scipy.fft.rfft(f, axis=0)[: basis.harmonics + 1].T
    z = np.empty((f.shape[1], basis.harmonic.size))
    z[:, :first] = math.sqrt(0.5) * waves[:, :1].real
    z[:, first::2], z[:, first + 1 :: 2] = -waves[:, 1:].imag, waves[:, 1:].real
    return z
