"""Bifurcations of Duffing's, van der Pol's and Helmholtz's oscillators to any number of digits, by shooting.

    m x'' + (c + e x^2) x' + k x + a x^2 + b x^3 = P cos(omega t)

x, and its derivative by the start of the orbit, are expanded in powers of time, step by step. The three unknowns are
the start (x, v) of the orbit and a parameter, omega or P. The orbit closes, and its monodromy matrix M has
det(M - 1) = 0 at a fold, det(M + 1) = 0 at a period doubling, det M = 1 at a Neimark-Sacker bifurcation. Where the
orbit has the symmetry x(t + T/2) = -x(t), H = -M(T/2) is the map whose square is M: at the point where a branch
without the symmetry leaves it, det(H + 1) = 0. No harmonic balance, no continuation and no numpy enters, but
multiplications of mpmath alone.
"""

from __future__ import annotations

from dataclasses import dataclass

from mpmath import cos, matrix, mp, mpf, pi, sin, sqrt

GUARD_DIGITS = 15
STEPS = 48  # of a period, each a series; their starts are also the samples of a harmonic, far beyond what it has
MOST_NEWTON = 12


@dataclass(frozen=True)
class Oscillator:
    """m x'' + (c + e x^2) x' + k x + a x^2 + b x^3 = P cos(omega t), in any units, numbers as decimal text."""

    m: str = "1"
    c: str = "0.05"
    k: str = "1"
    b: str = "0.1"
    P: str = "0.18"
    e: str = "0"
    a: str = "0"
    omega: str = "1"


CONDITIONS = {
    "fold": lambda a, b, c, d: (a - 1) * (d - 1) - b * c,
    "period doubling": lambda a, b, c, d: (a + 1) * (d + 1) - b * c,
    "Neimark-Sacker": lambda a, b, c, d: a * d - b * c - 1,
    "symmetry breaking": lambda a, b, c, d: (a + 1) * (d + 1) - b * c,  # of H
    "none": None,  # the orbit at a given parameter
}
"""Kind -> what vanishes, of the entries of the matrix ((a, b), (c, d))."""


def fold(oscillator, omega, x, v, digits=20):
    """Return (omega, amplitude of the first harmonic) at the fold near a start (x, v) at t = 0, as mpf."""
    return bifurcation(oscillator, "fold", "omega", omega, x, v, digits)[:2]


def bifurcation(oscillator, kind, parameter, value, x, v, digits=20):
    """Return the value of a parameter, amplitude of the first harmonic, trace and determinant at a bifurcation, as mpf.

    kind: of CONDITIONS; parameter: "omega" or "P"; near value and the start (x, v) at t = 0. Trace and determinant are
    those of M, or of H where the symmetry breaks. Raises ValueError where Newton's method does not converge.
    """
    with mp.workdps(digits + GUARD_DIGITS):
        order, unknowns = digits + GUARD_DIGITS, matrix([x, v, value])
        if CONDITIONS[kind] is None:
            unknowns = unknowns[:2]
        h = mpf(10) ** (-(digits + GUARD_DIGITS) // 2)
        conditions = lambda unknowns: _conditions(oscillator, kind, parameter, value, unknowns, order)
        for _ in range(MOST_NEWTON):
            residual, *state = conditions(unknowns)
            slope = matrix(len(unknowns), len(unknowns))
            for j in range(len(unknowns)):
                moved = unknowns.copy()
                moved[j] += h
                slope[:, j] = (conditions(moved)[0] - residual) / h
            step = mp.lu_solve(slope, residual)
            unknowns -= step
            if mp.norm(step) < mpf(10) ** (-digits):
                samples, trace, det = state
                return unknowns[2] if len(unknowns) == 3 else mpf(value), _first_harmonic(samples), trace, det
        raise ValueError(f"{oscillator}: no {kind} near {parameter} = {value}")


def _conditions(oscillator, kind, parameter, value, unknowns, order):
    """Return what vanishes, x at the starts of the steps, and trace and determinant of the matrix."""
    given = {name: mpf(getattr(oscillator, name)) for name in ("m", "c", "k", "b", "P", "e", "a", "omega")}
    given[parameter] = unknowns[2] if len(unknowns) == 3 else mpf(value)
    is_half = kind == "symmetry breaking"
    x0, v0, omega = unknowns[0], unknowns[1], given["omega"]
    h, samples = 2 * pi / omega / STEPS, []
    x, v, first, second = x0, v0, (mpf(1), mpf(0)), (mpf(0), mpf(1))
    for step in range(STEPS // 2 if is_half else STEPS):
        samples.append(x)
        x, v, first, second = _series_step(given, x, v, (first, second), omega * h * step, h, order)
    sign = -1 if is_half else 1
    a, c, b, d = (sign * entry for entry in (*first, *second))
    closed = [sign * x - x0, sign * v - v0]
    of_matrix = [] if CONDITIONS[kind] is None else [CONDITIONS[kind](a, b, c, d)]
    samples += [-x for x in samples] if is_half else []
    return matrix([*closed, *of_matrix]), samples, a + d, a * d - b * c


def _series_step(given, x0, v0, variations, angle, h, order):
    """Return x, v and both variations (dx, dv) after a step h from an angle of the force."""
    m, c, k, b, P, e, a, omega = (given[name] for name in ("m", "c", "k", "b", "P", "e", "a", "omega"))
    x, v, square = [x0], [v0], []
    ds = [([dx], [dv]) for dx, dv in variations]
    both = [[] for _ in ds]  # x dx
    waves, power = (cos(angle), -sin(angle), -cos(angle), sin(angle)), mpf(1)
    product = lambda p, q, n: mp.fdot(p[: n + 1], q[n::-1])
    for n in range(order):
        square.append(product(x, x, n))
        force = P * waves[n % 4] * power
        x.append(v[n] / (n + 1))
        drag = c * v[n] + (e * product(square, v, n) if e else 0)
        rates = []
        for (dx, dv), xdx in zip(ds, both, strict=True):
            xdx.append(product(x, dx, n))
            rate = c * dv[n] + k * dx[n] + 2 * a * xdx[n] + 3 * b * product(square, dx, n)
            if e:
                rate += e * (product(square, dv, n) + 2 * product(xdx, v, n))
            rates.append(-rate / (m * (n + 1)))
        v.append((force - drag - k * x[n] - a * square[n] - b * product(square, x, n)) / (m * (n + 1)))
        for (dx, dv), rate in zip(ds, rates, strict=True):
            dx.append(dv[n] / (n + 1))
            dv.append(rate)
        power *= omega / (n + 1)
    at_end = lambda series: mp.fsum(a * h**n for n, a in enumerate(series))
    return at_end(x), at_end(v), *((at_end(dx), at_end(dv)) for dx, dv in ds)


def _first_harmonic(samples):
    """Return the amplitude of the first harmonic of equally spaced samples."""
    angles = [2 * pi * i / len(samples) for i in range(len(samples))]
    s, c = (2 * sum(f(a) * x for a, x in zip(angles, samples, strict=True)) / len(samples) for f in (sin, cos))
    return sqrt(s * s + c * c)
