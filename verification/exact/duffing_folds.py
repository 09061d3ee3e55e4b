"""Folds of the response curve of Duffing's oscillator to any number of digits, by Taylor series and shooting.

    m x'' + c x' + k x + b x^3 = P cos(omega t)

x, and its derivative by the start of the orbit, are expanded in powers of time, step by step. At a fold the orbit
closes and one multiplier is one: det(M - 1) = 0 of the monodromy matrix M. The three unknowns are the start (x, v) and
omega. No harmonic balance, no continuation and no numpy enters: multiplications of mpmath alone.
"""

from __future__ import annotations

from dataclasses import dataclass

from mpmath import cos, matrix, mp, mpf, pi, sin, sqrt

GUARD_DIGITS = 15
STEPS = 48  # of a period, each a series; their starts are also the samples of a harmonic, far beyond what it has
MOST_NEWTON = 12


@dataclass(frozen=True)
class Duffing:
    """m x'' + c x' + k x + b x^3 = P cos(omega t), in any consistent units, numbers as decimal text."""

    m: str = "1"
    c: str = "0.05"
    k: str = "1"
    b: str = "0.1"
    P: str = "0.18"


def fold(oscillator, omega, x, v, digits=20):
    """Return (omega, amplitude of the first harmonic) at the fold near a start (x, v) at t = 0, as mpf.

    Raises ValueError where Newton's method does not converge.
    """
    with mp.workdps(digits + GUARD_DIGITS):
        order, unknowns = digits + GUARD_DIGITS, matrix([x, v, omega])
        h = mpf(10) ** (-(digits + GUARD_DIGITS) // 2)
        for _ in range(MOST_NEWTON):
            value, samples = _conditions(oscillator, unknowns, order)
            slope = matrix(3, 3)
            for j in range(3):
                moved = unknowns.copy()
                moved[j] += h
                slope[:, j] = (_conditions(oscillator, moved, order)[0] - value) / h
            step = mp.lu_solve(slope, value)
            unknowns -= step
            if mp.norm(step) < mpf(10) ** (-digits):
                return unknowns[2], _first_harmonic(samples)
        raise ValueError(f"{oscillator}: no fold near omega = {omega}")


def _conditions(oscillator, unknowns, order):
    """Return (x(T) - x(0), v(T) - v(0), det(M - 1)) and x at the starts of the steps."""
    m, c, k, b, P = (mpf(getattr(oscillator, name)) for name in ("m", "c", "k", "b", "P"))
    x0, v0, omega = unknowns
    h, samples = 2 * pi / omega / STEPS, []
    x, v, first, second = x0, v0, (mpf(1), mpf(0)), (mpf(0), mpf(1))
    for step in range(STEPS):
        samples.append(x)
        angle = omega * h * step
        x, v, first, second = _series_step((m, c, k, b, P), x, v, (first, second), omega, angle, h, order)
    det = (first[0] - 1) * (second[1] - 1) - first[1] * second[0]
    return matrix([x - x0, v - v0, det]), samples


def _series_step(parameters, x0, v0, variations, omega, angle, h, order):
    """Return x, v and both variations (dx, dv) after a step h from an angle of the force."""
    m, c, k, b, P = parameters
    x, v, square = [x0], [v0], []
    ds = [([dx], [dv]) for dx, dv in variations]
    waves, power = (cos(angle), -sin(angle), -cos(angle), sin(angle)), mpf(1)
    product = lambda p, q, n: sum(p[i] * q[n - i] for i in range(n + 1))
    for n in range(order):
        square.append(product(x, x, n))
        force = P * waves[n % 4] * power
        x.append(v[n] / (n + 1))
        v.append((force - c * v[n] - k * x[n] - b * product(square, x, n)) / (m * (n + 1)))
        for dx, dv in ds:
            dx.append(dv[n] / (n + 1))
            dv.append((-c * dv[n] - k * dx[n] - 3 * b * product(square, dx, n)) / (m * (n + 1)))
        power *= omega / (n + 1)
    at_end = lambda series: mp.fsum(a * h**n for n, a in enumerate(series))
    return at_end(x), at_end(v), *((at_end(dx), at_end(dv)) for dx, dv in ds)


def _first_harmonic(samples):
    """Return the amplitude of the first harmonic of equally spaced samples."""
    angles = [2 * pi * i / len(samples) for i in range(len(samples))]
    s, c = (2 * sum(f(a) * x for a, x in zip(angles, samples, strict=True)) / len(samples) for f in (sin, cos))
    return sqrt(s * s + c * c)
