"""Periodic motions of driven nonlinear oscillators to any number of digits, by Taylor series and shooting.

A chain of n masses between two walls, springs j = 0 .. n between x_{j-1} and x_j (x_{-1} = x_n = 0):

    m_i x_i'' + d_i x_i' + q_i |x_i'| x_i' + S_i - S_{i+1} = f_i + F_i cos(omega t)
    S_j = c_j e_j' + k_j e_j + a_j e_j^2 + b_j e_j^3,    e_j = x_j - x_{j-1}

One mass with one spring is Duffing's oscillator. The motion is expanded in powers of time, step by step; where |x'| x'
changes sign the step ends at the root of x', so the series never cross the kink. Newton's method closes the orbit. No
Fourier series enters: harmonics are integrals over the finished orbit. Any consistent units.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache

import numpy as np
from mpmath import mp, mpf
from numpy.polynomial import legendre

DOUBLE = 15  # digits that doubles are asked for
GUARD_DIGITS = 6
DIFFERENCE = 1e-7  # step of the differenced monodromy matrix over the size of the orbit: Newton gains 6 digits a step
MOST_NEWTON = 30
FARTHEST = 10.0  # sizes of the first run that a Newton step may take
LOOKS = 24  # places of a step where the sign of a velocity is looked at
GAUSS_POINTS = 40


def _each(value, n):
    return (value,) * n if np.isscalar(value) else tuple(value)


@dataclass(frozen=True)
class Chain:
    """Masses m, dampers d, q, forces f (`constant`), F (`force`): n each; springs c, k, a, b: n + 1; or one number.

    omega : rad per unit of time, of the drive.
    """

    n: int
    omega: float
    force: tuple | float
    mass: tuple | float = 1.0
    damping: tuple | float = 0.0
    quadratic: tuple | float = 0.0
    constant: tuple | float = 0.0
    spring_damping: tuple | float = 0.0
    stiffness: tuple | float = 0.0
    square: tuple | float = 0.0
    cubic: tuple | float = 0.0

    def __post_init__(self):
        for name in ("force", "mass", "damping", "quadratic", "constant"):
            object.__setattr__(self, name, _each(getattr(self, name), self.n))
        for name in ("spring_damping", "stiffness", "square", "cubic"):
            object.__setattr__(self, name, _each(getattr(self, name), self.n + 1))


def duffing(d, a, b, F, omega, *, square=0.0, constant=0.0):
    """`Chain` of x'' + d x' + a x + square x^2 + b x^3 = constant + F cos(omega t)."""
    springs = {"stiffness": (a, 0.0), "square": (square, 0.0), "cubic": (b, 0.0)}
    return Chain(1, omega, F, damping=d, constant=constant, **springs)


def quadratically_damped(m, c, k, F, omega):
    """`Chain` of m x'' + c |x'| x' + k x = F cos(omega t)."""
    return Chain(1, omega, F, mass=m, quadratic=c, stiffness=(k, 0.0))


@dataclass(frozen=True)
class _Segment:
    """x and v (p, n), coefficients of powers of t - begin, for begin <= t <= begin + length."""

    begin: object
    length: object
    x: np.ndarray
    v: np.ndarray


@dataclass(frozen=True)
class Orbit:
    """A periodic motion. period : `periods` times that of the drive;  start : x (n,), v (n,) at t = 0, mpf or float.

    multipliers : Floquet multipliers over `period` (2n,), stable where all lie in the unit circle;
    error : last Newton step over the size of the orbit.
    """

    chain: Chain
    periods: int
    period: object
    start: tuple
    multipliers: np.ndarray
    error: float
    segments: tuple = field(repr=False)

    @property
    def stable(self):
        """Whether all multipliers lie inside the unit circle."""
        return bool(np.all(np.abs(self.multipliers) < 1))

    def x(self, t):
        """ndarray (n, *S), doubles: positions at times t of shape S."""
        return self._at(t, "x")

    def v(self, t):
        """ndarray (n, *S), doubles: velocities at times t of shape S."""
        return self._at(t, "v")

    def samples(self, count):
        """x (n, count) at t = j period / count, j = 0 .. count - 1."""
        return self.x(np.arange(count) * (float(self.period) / count))

    def _at(self, t, name):
        t = np.mod(np.asarray(t, float), float(self.period))
        begins = np.array([float(s.begin) for s in self.segments])
        which = np.clip(np.searchsorted(begins, t, side="right") - 1, 0, None)
        out = np.empty((self.chain.n, *t.shape))
        for j in np.unique(which):
            here = which == j
            out[:, here] = _horner(getattr(self.segments[j], name).astype(float), t[here] - begins[j])
        return out

    def fourier(self, count):
        """Mean (n,), cosine and sine coefficients (count, n) of x: row k - 1 belongs to k omega / periods.

        x = mean + sum_k cosine_k cos(k omega t / periods) + sine_k sin(...), by Gauss quadrature piece by piece.
        """
        nodes, weights = legendre.leggauss(GAUSS_POINTS)
        period, pieces = (
            float(self.period),
            [(float(s.begin), float(s.length), s.x.astype(float)) for s in self.segments],
        )
        local = [(nodes + 1) / 2 * length for _, length, _ in pieces]
        t = np.concatenate([begin + tau for (begin, _, _), tau in zip(pieces, local, strict=True)])
        x = np.concatenate([_horner(x, tau) for (_, _, x), tau in zip(pieces, local, strict=True)], axis=1)
        share = np.concatenate([weights / 2 * length for _, length, _ in pieces]) / period
        angle = 2 * np.pi / period * np.arange(1, count + 1)[:, None] * t
        return x @ share, 2 * (np.cos(angle) * share) @ x.T, 2 * (np.sin(angle) * share) @ x.T


def _horner(coefficients, tau):
    """Polynomials (p, n) at tau (q,): (n, q)."""
    value = np.zeros((coefficients.shape[1], tau.size))
    for c in coefficients[::-1]:
        value = value * tau + c[:, None]
    return value


# --- Taylor series ----------------------------------------------------------------------------------------------------


class _Integrator:
    """March of states (n, columns) side by side in doubles or mpf; steps and events follow column 0."""

    def __init__(self, chain, digits):
        self.exact, self.n = digits > DOUBLE, chain.n
        self.order = int(1.15 * (digits + 3)) + 2
        number = (lambda x: mpf(float(x))) if self.exact else float
        self.number, self.omega, self.moving = number, number(chain.omega), any(chain.quadratic)

        def column(values):
            return self.array(values)[:, None]

        names = ("mass", "damping", "quadratic", "constant", "force")
        self.m, self.d, self.q, self.f, self.F = (column(getattr(chain, name)) for name in names)
        names = ("spring_damping", "stiffness", "square", "cubic")
        self.live = [j for j in range(chain.n + 1) if any(getattr(chain, name)[j] for name in names)]
        self.c, self.k, self.a, self.b = (column([getattr(chain, name)[j] for j in self.live]) for name in names)
        self.curved = any(chain.square) or any(chain.cubic)

    def array(self, values):
        return np.array([self.number(v) for v in np.ravel(values)], dtype=object if self.exact else float)

    def stretch(self, x):
        """e (springs, columns) of x (n, columns)."""
        wall = x[:1] * 0
        return np.diff(np.concatenate([wall, x, wall]), axis=0)[self.live]

    def pull(self, S):
        """S_i - S_{i+1} on each mass."""
        full = np.zeros((self.n + 1, S.shape[1]), dtype=S.dtype)
        full[self.live] = S
        return full[:-1] - full[1:]

    def drive(self, t):
        """Taylor coefficients of cos(omega t) about t, as many as the order."""
        lib = mp if self.exact else np
        c, s = lib.cos(self.omega * t), lib.sin(self.omega * t)
        turn, out, factor = (c, -s, -c, s), [], self.number(1)
        for k in range(self.order):
            out.append(turn[k % 4] * factor)
            factor = factor * self.omega / (k + 1)
        return out

    def series(self, t, x, v, sign):
        """Coefficients x, v (order + 1, n, columns) about t, with |x'| = sign x'."""
        p, drive = self.order, self.drive(t)
        X, V = np.zeros((2, p + 1, *x.shape), dtype=x.dtype)
        X[0], V[0] = x, v
        E, E2 = np.zeros((2, p, len(self.live), x.shape[1]), dtype=x.dtype)
        for k in range(p):
            E[k] = self.stretch(X[k])
            S = self.k * E[k] + self.c * self.stretch(V[k])
            if self.curved:
                E2[k] = (E[: k + 1] * E[k::-1]).sum(axis=0)
                S = S + self.a * E2[k] + self.b * (E2[: k + 1] * E[k::-1]).sum(axis=0)
            force = self.F * drive[k] - self.d * V[k] - self.pull(S)
            if k == 0:
                force = force + self.f
            if self.moving:
                force = force - self.q * sign * (V[: k + 1] * V[k::-1]).sum(axis=0)
            X[k + 1], V[k + 1] = V[k] / (k + 1), force / self.m / (k + 1)
        return X, V

    def step(self, X, V, rest):
        """Length of a step, at most `rest`: radius of convergence over e^2 (Jorba and Zou, Exp. Math. 14 (2005) 99)."""
        size = max(np.abs(X[0, :, 0]).max(), np.abs(V[0, :, 0]).max() / self.omega, abs(X[1:3, :, 0]).max())
        tail = [np.abs(C[k, :, 0]).max() for C in (X, V) for k in (self.order - 1, self.order)]
        powers = [self.order - 1, self.order] * 2
        radius = [(size / c) ** (self.number(1) / k) for c, k in zip(tail, powers, strict=True) if c > 0]
        return min(rest, min(radius, default=rest) / self.number(np.exp(2)))

    def turn(self, V, sign, h):
        """(first time in (0, h] where a quadratically damped velocity changes sign, the masses), else (h, [])."""
        found = []
        for i in np.flatnonzero([bool(q) for q in self.q[:, 0]]):
            poly = V[::-1, i, 0] * sign[i, 0]
            places = [h * (j + 1) / LOOKS for j in range(LOOKS)]
            bad = next((j for j, tau in enumerate(places) if _value(poly, tau) < 0), None)
            if bad is not None:
                found.append((self.root(poly, places[bad - 1] if bad else 0 * h, places[bad]), i))
        return min(found, default=(h, None))

    def root(self, poly, low, high):
        """Root between low, where poly >= 0, and high, where it is negative: bisection, then Newton to the end."""
        for _ in range(30):
            middle = (low + high) / 2
            low, high = (middle, high) if _value(poly, middle) > 0 else (low, middle)
        slope = np.array([c * k for k, c in zip(range(len(poly) - 1, 0, -1), poly[:-1], strict=True)], dtype=poly.dtype)
        for _ in range(4):
            high = high - _value(poly, high) / _value(slope, high)
        return high

    def march(self, x, v, begin, end):
        """State at `end` from x, v (n, columns) at `begin`, and the segments of column 0."""
        t, segments, turned = begin, [], None
        while t < end:
            sign = self.signs(t, x, v, turned) if self.moving else None
            X, V = self.series(t, x, v, sign)
            h = self.step(X, V, end - t)
            last = h == end - t
            if self.moving:
                h, turned = self.turn(V, sign, h)
                last = last and turned is None
            segments.append(_Segment(t, h, X[:, :, 0], V[:, :, 0]))
            x, v = (sum_powers(C, h) for C in (X, V))
            if turned is not None:
                v[turned, 0] = self.number(0)
            t = end if last else t + h
        return x, v, segments

    def signs(self, t, x, v, turned):
        """Sign (n, 1) of each velocity just after t: where it vanishes, that of the acceleration."""
        zero = [not c for c in v[:, 0]]
        speed = np.where(zero, self.series(t, x, v, self.array(np.ones(self.n))[:, None])[1][1, :, 0], v[:, 0])
        return self.array([1 if c >= 0 else -1 for c in speed])[:, None]


def _value(poly, tau):
    """Polynomial, highest power first."""
    value = poly[0]
    for c in poly[1:]:
        value = value * tau + c
    return value


def sum_powers(coefficients, h):
    """Value (n, columns) of the series (p, n, columns) at h."""
    value = coefficients[-1]
    for c in coefficients[-2::-1]:
        value = value * h + c
    return value


# --- shooting ---------------------------------------------------------------------------------------------------------


def trajectory(chain, start, duration, *, digits=DOUBLE):
    """x (n,), v (n,) after `duration` from start = (x, v) at t = 0; mpf where digits > 15."""
    with mp.workdps(digits + GUARD_DIGITS):
        march = _Integrator(chain, digits)
        x, v = (march.array(part)[:, None] for part in start)
        x, v, _ = march.march(x, v, march.number(0), march.number(duration))
        return x[:, 0], v[:, 0]


def periodic(chain, *, periods=1, start=None, settle=20, digits=DOUBLE):
    """`Orbit` of `periods` drive periods near start = (x, v), each (n,), at t = 0.

    Without a start the motion from rest is followed for `settle` drive periods: that finds a stable orbit. digits > 15
    carries the orbit on in mpmath to that many digits; the coefficients and samples that it returns are doubles.
    Raises ArithmeticError where Newton's method does not close the orbit.
    """
    n, march = chain.n, _Integrator(chain, DOUBLE)
    drive = 2 * np.pi / chain.omega
    x, v = (np.array(part, float).reshape(n, 1) for part in (start or (np.zeros(n), np.zeros(n))))
    if start is None:
        for _ in range(settle):
            x, v, _ = march.march(x, v, 0.0, drive)
    y = np.concatenate([x[:, 0], v[:, 0]])
    scale = _scale(march, y, periods * drive)
    monodromy, y, error, segments = _closed(march, y, periods * drive, scale)
    if digits > DOUBLE:
        with mp.workdps(digits + GUARD_DIGITS):
            exact = _Integrator(chain, digits)
            y, error, segments, period = _polished(exact, y, periods, monodromy, scale, digits)
    else:
        period = periods * drive
    return Orbit(chain, periods, period, (y[:n], y[n:]), np.linalg.eigvals(monodromy), float(error), tuple(segments))


def _scale(march, y, period):
    """Size (2n,) of positions and velocities over the first run, for differences and errors."""
    n = march.n
    _, _, segments = march.march(y[:n, None], y[n:, None], 0.0, period)
    sizes = [
        max(np.abs(part).max() for part in parts) for parts in zip(*[(s.x[0], s.v[0]) for s in segments], strict=True)
    ]
    return np.repeat([size or 1.0 for size in sizes], n)


def _closed(march, y, period, scale):
    """Newton's method in doubles: monodromy (2n, 2n), start (2n,), last step, segments."""
    n, best = march.n, np.inf
    for _ in range(MOST_NEWTON):
        columns = y[:, None] + np.concatenate([np.zeros((2 * n, 1)), np.diag(DIFFERENCE * scale)], axis=1)
        x, v, segments = march.march(columns[:n], columns[n:], 0.0, period)
        end = np.concatenate([x, v])
        monodromy = (end[:, 1:] - end[:, :1]) / (DIFFERENCE * scale)
        step = np.linalg.solve(np.eye(2 * n) - monodromy, end[:, 0] - y)
        error = np.abs(step / scale).max()
        if error < 1e-9 and error >= best / 2:  # round-off is reached: the step no longer shrinks
            return monodromy, y, min(error, best), segments
        if error > FARTHEST:  # far from every orbit the steps of the series shrink without end
            break
        best, y = error, y + step
    raise ArithmeticError(
        f"the orbit does not close: last step {error:.3g}, multipliers {np.linalg.eigvals(monodromy)}"
    )


def _polished(march, y, periods, monodromy, scale, digits):
    """The same in mpf with the monodromy matrix of the doubles: start, last step, segments, period."""
    n, period = march.n, periods * 2 * mp.pi / march.omega
    inverse = np.linalg.inv(np.eye(2 * n) - monodromy)
    y = march.array(y)
    for _ in range(MOST_NEWTON):
        x, v, segments = march.march(y[:n, None], y[n:, None], march.number(0), period)
        residual = np.concatenate([x, v])[:, 0] - y
        size = max(abs(residual / march.array(scale)))
        # the step in doubles, scaled so that it does not underflow
        step = march.array(inverse @ (residual / (size or 1)).astype(float)) * size
        error = max(abs(step / march.array(scale)))
        y = y + step
        if error < mpf(10) ** -digits:
            return y, error, segments, period
    raise ArithmeticError(f"the orbit does not close to {digits} digits: last step {mp.nstr(error, 3)}")


# --- chosen cases -----------------------------------------------------------------------------------------------------

_KRACK = {"d": 0.05, "a": 1.0, "b": 0.1, "F": 0.18}  # Krack and Gross, Harmonic Balance for Nonlinear Vibration, 2019
_UEDA = duffing(0.08, 0.0, 1.0, 0.2, 1.0)  # Ueda, Chaos, Solitons & Fractals 1 (1991) 199: five attractors at once
_PAIR = {"n": 2, "omega": 1.2, "force": (1.0, 0.0), "damping": 0.1, "stiffness": 1.0, "cubic": 0.5}

CASES = {
    "duffing below resonance": (duffing(**_KRACK, omega=0.9), {"start": ([0.75], [0.13])}),
    "duffing near resonance": (duffing(**_KRACK, omega=1.1), {"start": ([1.55], [1.33])}),
    "duffing small branch": (duffing(**_KRACK, omega=1.2), {"start": ([-0.41], [0.07])}),
    "duffing unstable branch": (duffing(**_KRACK, omega=1.2), {"start": ([-1.46], [2.09])}),
    "duffing large branch": (duffing(**_KRACK, omega=1.2), {"start": ([1.33], [2.54])}),
    "duffing third harmonic": (duffing(0.05, 1.0, 1.0, 1.0, 0.3), {"start": ([0.59], [0.01])}),
    "duffing softening": (duffing(0.1, 1.0, -0.35, 0.1, 0.6), {"start": ([0.16], [0.01])}),
    # RadiiPolynomial.jl proves a solution near: x'' + x'/10 + 4 x - x^2 = cos t
    "square": (duffing(0.1, 4.0, 0.0, 1.0, 1.0, square=-1.0), {"start": ([0.27], [0.51])}),
    "duffing biased": (duffing(0.1, 1.0, 0.5, 0.4, 0.8, constant=0.3), {"start": ([0.93], [0.09])}),
    "ueda small": (_UEDA, {"start": ([-0.21], [0.02])}),
    "ueda large": (_UEDA, {"start": ([1.05], [0.79])}),
    "ueda half a": (_UEDA, {"start": ([-0.67], [0.02]), "periods": 2}),
    "ueda half b": (_UEDA, {"start": ([-0.45], [0.29]), "periods": 2}),
    "ueda third": (_UEDA, {"start": ([-0.43], [0.12]), "periods": 3}),
    "quadratic at resonance": (quadratically_damped(1.0, 0.5, 1.0, 1.0, 1.0), {"start": ([-0.02], [1.52])}),
    "quadratic below": (quadratically_damped(1.0, 0.1, 1.0, 1.0, 0.5), {"start": ([1.33], [0.03])}),
    "quadratic strong": (quadratically_damped(1.0, 2.0, 1.0, 1.0, 1.0), {"start": ([-0.02], [0.74])}),
    "two masses": (Chain(**_PAIR), {"start": ([1.47, 1.18], [0.71, 0.70])}),
    "two masses, uneven": (
        Chain(**_PAIR | {"mass": (1.0, 2.0), "stiffness": (1.0, 0.5, 0.2), "cubic": (0.5, 0.3, 0.1), "square": 0.1}),
        {"start": ([0.87, -0.49], [0.16, -0.04])},
    ),
    "three masses, quadratic": (
        Chain(3, 1.2, (1.0, 0.0, 0.0), damping=0.1, quadratic=0.2, stiffness=1.0, cubic=0.5),
        {"start": ([0.24, -0.59, -0.73], [0.35, 0.17, -0.08])},
    ),
}
"""name -> (`Chain`, keywords of `periodic`): one branch each, "half" and "third" of two and three drive periods."""


@cache
def case(name, digits=DOUBLE):
    """`Orbit` of a row of `CASES`."""
    chain, options = CASES[name]
    return periodic(chain, **options, digits=digits)
