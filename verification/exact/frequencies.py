"""Natural frequencies of cables, and free waves: closed forms, and any sagging elastic line by a Galerkin method.

`frequencies` linearises the line in Cartesian displacements about its static shape, not in strain and angles: with
q(s, t) the small displacement of the particle s (unstretched arc length), t the static unit tangent, T the static
tension, eps = T/EA,

    [m I + ma (I - t t')] q_tt = d/ds { [EA t t' + T/(1 + eps) (I - t t')] q_s },    q = 0 at both ends,

because d(T t) = EA t (t . q_s) + T/(1 + eps) (I - t t') q_s and because added mass ma acts across the line only.
In the plane of the line this couples two components; out of the plane it is T/(1 + eps) and m + ma alone.
SI units; frequencies in Hz unless said otherwise.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from mpmath import mp, mpf
from numpy.polynomial import legendre

from verification.exact import catenary_mp

STATIC_DIGITS = 30
# Quadrature points beyond the number that integrates products of two basis functions with constant coefficients.
EXTRA_POINTS = 40


# --- closed forms -----------------------------------------------------------------------------------------------------


def hanging_chain(count, length=1.0, g=1.0):
    """The first `count` frequencies, mpf, Hz, of a chain hanging from its top: omega = (j0n / 2) sqrt(g / length)."""
    return [mp.besseljzero(0, n) / 2 * mp.sqrt(mpf(g) / length) / (2 * mp.pi) for n in range(1, count + 1)]


def taut_string(count, tension, mass, length):
    """The first `count` frequencies, mpf, Hz: n / (2 length) sqrt(tension / mass), mass in kg/m."""
    return [n / (2 * mpf(length)) * mp.sqrt(mpf(tension) / mass) for n in range(1, count + 1)]


def axial_bar(count, EA, mass, length):
    """The first `count` axial frequencies, mpf, Hz, of a straight bar held at both ends."""
    return taut_string(count, EA, mass, length)


def irvine_antisymmetric(count):
    """omega l sqrt(m/H) / pi of the first `count` antisymmetric in-plane modes of a parabolic cable: 2 n."""
    return [mpf(2 * n) for n in range(1, count + 1)]


def irvine_symmetric(count, lambda2):
    """omega l sqrt(m/H) / pi of the first `count` symmetric in-plane modes: tan(x/2) = x/2 - (4/lambda^2) (x/2)^3.

    lambda2 : Irvine's lambda^2 = (w l/H)^2 EA l / (H Le); 0 gives the taut string, infinity the inextensible cable.
    The roots are bracketed on the form without poles, sin - (...) cos; one lies in each ((2n - 1) pi, (2n + 1) pi).
    """
    cubic = mpf(0) if lambda2 == mp.inf else 4 / mpf(lambda2) if lambda2 else mp.inf
    if cubic == mp.inf:
        return [mpf(2 * n - 1) for n in range(1, count + 1)]

    def condition(half):
        return mp.sin(half) - (half - cubic * half**3) * mp.cos(half)

    return [
        _bisected(condition, (n - mpf("0.5")) * mp.pi, (n + mpf("0.5")) * mp.pi) * 2 / mp.pi
        for n in range(1, count + 1)
    ]


def _bisected(f, a, b):
    """Root of f in (a, b) to working precision."""
    rising = f(b) > 0
    if (f(a) > 0) == rising:
        raise ArithmeticError(f"no sign change between {mp.nstr(a, 8)} and {mp.nstr(b, 8)}")
    for _ in range(mp.prec + 4):
        middle = (a + b) / 2
        a, b = (a, middle) if (f(middle) > 0) == rising else (middle, b)
    return (a + b) / 2


def vertical_string(count, tension, weight, mass, length):
    """The first `count` transverse frequencies, mpf, Hz, of an inextensible vertical string held at both ends.

    tension : N, at the lower end; weight : N/m; mass : kg/m that moves, added mass included. With tau = sqrt(T(s)) the
    shapes are combinations of J0 and Y0 of (2 omega sqrt(mass) / weight) tau.
    """
    low, high = mp.sqrt(mpf(tension)), mp.sqrt(mpf(tension) + mpf(weight) * length)

    def condition(k):
        return mp.besselj(0, k * low) * mp.bessely(0, k * high) - mp.besselj(0, k * high) * mp.bessely(0, k * low)

    spacing = mp.pi / (high - low)  # k is close to n times this, from below
    roots = [_bisected(condition, (n - mpf("0.5")) * spacing, (n + mpf("0.25")) * spacing) for n in range(1, count + 1)]
    return [k * weight / (4 * mp.pi * mp.sqrt(mpf(mass))) for k in roots]


def irvine_line(lambda2, sag, L=100.0, m=10.0, w0=50.0):
    """Inputs of `frequencies` for a level cable with Irvine's lambda^2 and sag-to-span ratio, and its H (N) and l (m).

    sag is w l / (8 H) with L for l, a difference of second order in the sag, as are Irvine's own assumptions.
    Returns (EA, m, w0, L, span, H).
    """
    slope = 8 * sag
    H = w0 * L / slope
    EA = H * (1 + slope**2 / 8) * lambda2 / slope**2
    x, z = catenary_mp.excursion(H, w0 * L / 2, w0, EA, L, seabed=False)
    return EA, m, w0, L, (float(x), float(z)), H


# --- any line ---------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class LineModes:
    """Modes of a line, frequencies ascending, Hz.

    in_plane (n,), out_of_plane (k,) : frequencies;  axial_share (n,) : share of the kinetic energy of each in-plane
    mode that is motion along the line;  tension : (anchor, fairlead), N, of the static shape.
    """

    in_plane: np.ndarray
    out_of_plane: np.ndarray
    axial_share: np.ndarray
    tension: tuple[float, float]

    @property
    def first_axial(self):
        """Frequency of the first in-plane mode that moves mostly along the line, Hz."""
        return self.in_plane[np.argmax(self.axial_share > 0.5)]


def frequencies(EA, m, ma, w0, L, span, *, degree=80):
    """`LineModes` of an elastic line between fixed ends, undamped, in still water, without seabed.

    EA N, m kg/m, ma kg/m (added mass across the line), w0 N/m, L m unstretched, span (x, z) m from anchor to fairlead.
    Integrated Legendre polynomials up to `degree` + 1 and the static shape of `catenary_mp`: the error falls faster
    than any power of the degree for modes well below it (about a third of the degree is resolved).
    """
    H, V0 = _anchor_force(EA, w0, L, span)
    nodes, weights = legendre.leggauss(2 * degree + EXTRA_POINTS)
    s, weights = (nodes + 1) * L / 2, weights * L / 2
    phi, slope = _basis(nodes, degree, L)
    T = np.hypot(H, V0 + w0 * s)
    t = np.array([np.full_like(T, H), V0 + w0 * s]) / T
    across = T / (1 + T / EA)
    along_line = t[:, None] * t[None]
    across_line = np.eye(2)[:, :, None] - along_line
    K = _gram(slope, weights, EA * along_line + across * across_line)
    M = _gram(phi, weights, m * along_line + (m + ma) * across_line)
    in_plane, shapes = _modes(K, M)
    along = np.einsum("aq,qi,ain->qn", t, phi, shapes.reshape(2, degree, -1))
    share = m * (weights @ along**2) / np.einsum("in,ij,jn->n", shapes, M, shapes, optimize=True)
    out_of_plane, _ = _modes(*(_gram(f, weights, c[None, None]) for f, c in ((slope, across), (phi, 0 * T + m + ma))))
    return LineModes(in_plane, out_of_plane, share, (float(np.hypot(H, V0)), float(np.hypot(H, V0 + w0 * L))))


def _anchor_force(EA, w0, L, span):
    """(H, V) at the anchor, N, from the quadrature oracle."""
    state = catenary_mp.solve(w0, EA, L, *span, seabed=False, digits=STATIC_DIGITS)
    return float(state.H), float(state.V_anchor)


def _basis(x, degree, L):
    """Functions (q, degree) that vanish at both ends of [-1, 1], and their slopes d/ds, orthonormal in s."""
    P, k = legendre.legvander(x, degree + 1), np.arange(1, degree + 1)
    size = np.sqrt((2 * k + 1) / L)
    phi = (P[:, 2:] - P[:, :-2]) * (L / 2) * size / (2 * k + 1)
    return phi, P[:, 1:-1] * size


def _gram(functions, weights, coefficients):
    """Matrix of the bilinear form with coefficients (c, c, q), unknowns ordered by component."""
    c, n = coefficients.shape[0], functions.shape[1]
    blocks = [[functions.T @ (functions * (weights * coefficients[a, b])[:, None]) for b in range(c)] for a in range(c)]
    return np.block(blocks) if c > 1 else blocks[0][0].reshape(n, n)


def _modes(K, M):
    """Frequencies (n,), Hz, ascending, and shapes (., n). M is seen in the inner product of K: its largest eigenvalues,
    the lowest frequencies, then keep all their digits."""
    factor = np.linalg.cholesky(K)
    half = np.linalg.solve(factor, M)
    seen = np.linalg.solve(factor, half.T)
    values, vectors = np.linalg.eigh((seen + seen.T) / 2)
    return 1 / np.sqrt(values[::-1]) / (2 * np.pi), np.linalg.solve(factor.T, vectors)[:, ::-1]


# --- free waves -------------------------------------------------------------------------------------------------------


def string_speed(tension, EA, mass):
    """Speed of a small transverse wave along the unstretched arc length, m/s: sqrt(T / ((1 + T/EA) mass))."""
    return np.sqrt(tension / ((1 + tension / EA) * mass))


def plucked_string(shape, speed, L, s, t):
    """Displacement at (s, t) of a string held at 0 and L, released from rest with shape(s), by d'Alembert's formula.

    The shape is continued oddly about both ends and halved into two waves; shape is called on [0, L] only.
    """
    s, t = np.asarray(s, float), np.asarray(t, float)
    return (_odd(shape, L, s - speed * t) + _odd(shape, L, s + speed * t)) / 2


def plucked_string_velocity(slope, speed, L, s, t):
    """Velocity of `plucked_string` from slope(s), the derivative of the shape on [0, L]."""
    s, t = np.asarray(s, float), np.asarray(t, float)
    return speed / 2 * (_even(slope, L, s + speed * t) - _even(slope, L, s - speed * t))


def _folded(L, s):
    """(place in [0, L], whether on a mirrored stretch) of s in the continuation with period 2 L."""
    s = np.mod(s, 2 * L)
    return np.where(s > L, 2 * L - s, s), s > L


def _odd(f, L, s):
    place, mirrored = _folded(L, s)
    return np.where(mirrored, -1, 1) * f(place)


def _even(f, L, s):
    return f(_folded(L, s)[0])
