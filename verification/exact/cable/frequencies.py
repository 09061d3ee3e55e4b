"""Natural frequencies of cables and their response to a small motion of the fairlead, in closed form and for any line.

`frequencies` and `fairlead_response` linearise the line about its static shape in Cartesian displacements, not in
strain and angles: with q(s, t) the small displacement of the particle s (unstretched arc length), t the static unit
tangent, T the static tension, eps = T/EA,

    [m I + ma (I - t t')] q_tt = d/ds { [EA t t' + T/(1 + eps) (I - t t')] q_s },    q = 0 at both ends,

because d(T t) = EA t (t . q_s) + T/(1 + eps) (I - t t') q_s and because added mass ma acts across the line only. With
Kelvin-Voigt damping EA becomes EA (1 + i omega beta).
In the plane of the line this couples two components; out of the plane it is T/(1 + eps) and m + ma alone.
SI units; frequencies in Hz unless said otherwise.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from mpmath import mp, mpf
from numpy.polynomial import legendre

from verification.exact.cable import catenary_mp

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


def two_part_line(count, stiffness, mass, length, joint_mass=0.0):
    """The first `count` frequencies, mpf, Hz, of two uniform parts in line, fixed at both ends and joined at a mass.

    stiffness, mass, length : pairs, of the two parts, K in N, kg/m and m;  joint_mass : kg. Each part moves by
    m u_tt = K u_ss: transverse with the tension for K, or T/(1 + eps) where lengths and masses are unstretched; axial
    with EA. With k_i = omega sqrt(m_i / K_i) the forces at the joint balance where

        K_1 k_1 cot(k_1 l_1) + K_2 k_2 cot(k_2 l_2) = joint_mass omega^2.

    The difference of the sides falls without end from one pole to the next, so that a single root lies between two
    poles, and on them where they coincide; poles are the frequencies of the parts with the joint fixed.
    """
    K, m, l = ([mpf(value) for value in pair] for pair in (stiffness, mass, length))
    delay = [l[i] * mp.sqrt(m[i] / K[i]) for i in (0, 1)]
    impedance = [mp.sqrt(K[i] * m[i]) for i in (0, 1)]

    def difference(omega):
        return sum(impedance[i] * mp.cot(delay[i] * omega) for i in (0, 1)) - mpf(joint_mass) * omega

    poles = sorted(n * mp.pi / part for part in delay for n in range(1, count + 1))
    return [_fallen(difference, a, b) / (2 * mp.pi) for a, b in zip([mpf(0), *poles], poles[:count], strict=False)]


def two_part_string(count, tension, mass, length, joint_mass=0.0):
    """The first `count` transverse frequencies, mpf, Hz, of a string of two materials under one tension, N."""
    return two_part_line(count, (tension, tension), mass, length, joint_mass)


def two_part_bar(count, EA, mass, length, joint_mass=0.0):
    """The first `count` axial frequencies, mpf, Hz, of a bar of two materials, EA a pair in N, held at both ends."""
    return two_part_line(count, EA, mass, length, joint_mass)


def _fallen(f, a, b):
    """Root in (a, b) of f, which falls from +infinity to -infinity there; a where there is nothing between."""
    if b - a <= 4 * mp.eps * b:
        return a
    for _ in range(mp.prec + 8):
        middle = (a + b) / 2
        a, b = (middle, b) if f(middle) > 0 else (a, middle)
    return (a + b) / 2


def lumped_string(count, tension, mass, length, cells):
    """The first `count` frequencies, mpf, Hz, of a taut string lumped at the nodes between equal cells.

    mass : kg/m;  count < cells. Half of each cell's mass lies at either end, l = length / cells is a cell, and
    sin(k pi j / cells) at node j is a mode: omega_k = 2 sqrt(tension / (mass l^2)) sin(k pi / (2 cells)).
    """
    l = mpf(length) / cells
    return [
        2 * mp.sqrt(mpf(tension) / mass) / l * mp.sin(k * mp.pi / (2 * cells)) / (2 * mp.pi)
        for k in range(1, count + 1)
    ]


def lumped_bar(count, EA, mass, length, cells):
    """The first `count` axial frequencies, mpf, Hz, of a bar lumped likewise, held at both ends."""
    return lumped_string(count, EA, mass, length, cells)


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
    x, _ = catenary_mp.excursion(H, w0 * L / 2, w0, EA, L, seabed=False)  # half the weight at either end: level
    return EA, m, w0, L, (float(x), 0.0), H


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
    line = _Line(EA, m, ma, w0, L, span, degree)
    phi, slope = line.basis()
    M = _gram(phi, line.weights, m * line.along + (m + ma) * line.across)
    in_plane, shapes = _modes(_gram(slope, line.weights, EA * line.along + line.string * line.across), M)
    along = np.einsum("aq,qi,ain->qn", line.t, phi, shapes.reshape(2, degree, -1))
    share = m * (line.weights @ along**2) / np.einsum("in,ij,jn->n", shapes, M, shapes, optimize=True)
    out_of_plane, _ = _modes(
        _gram(slope, line.weights, line.string[None, None]),
        _gram(phi, line.weights, 0 * line.string[None, None] + m + ma),
    )
    return LineModes(in_plane, out_of_plane, share, line.ends)


@dataclass(frozen=True)
class FairleadResponse:
    """Complex amplitudes per metre of motion, motion = Re e^(i omega t).

    tension (n,) N/m at the places asked for;  force (3,) N/m, x, y, z: on the line, at the fairlead.
    """

    tension: np.ndarray
    force: np.ndarray


def fairlead_response(EA, m, ma, w0, L, span, frequency, direction, *, beta=0.0, places=None, degree=80):
    """`FairleadResponse` of the line of `frequencies` whose fairlead moves by a unit vector times cos(omega t).

    frequency Hz; direction (x, y, z): (1, 0, 0) surge, (0, 1, 0) sway, (0, 0, 1) heave; beta s, Kelvin-Voigt;
    places (n,) m, arc lengths for the tension, the fairlead by default. Linear: sway changes no tension. At a natural
    frequency without damping there is no response: it is then large and meaningless.
    """
    line, omega = _Line(EA, m, ma, w0, L, span, degree), 2 * np.pi * frequency
    stiff = EA * (1 + 1j * omega * beta)
    x, y, z = direction
    K, M = stiff * line.along + line.string * line.across, m * line.along + (m + ma) * line.across
    places = np.array([L] if places is None else places, float)
    at = np.append(places, L)
    q_s = line.driven(K, M, omega, np.array([x, z]), at)
    H, V = line.H, line.V0 + w0 * at
    t = np.array([H + 0 * V, V]) / np.hypot(H, V)
    stretch = (t * q_s).sum(axis=0)
    T = np.hypot(H, V)
    change = stiff * stretch * t + T / (1 + T / EA) * (q_s - stretch * t)
    sway = line.driven(line.string[None, None], 0 * line.string[None, None] + m + ma, omega, np.array([y]), at)
    across = (T / (1 + T / EA) * sway[0])[-1]
    return FairleadResponse(stiff * stretch[:-1], np.array([change[0, -1], across, change[1, -1]]))


class _Line:
    """Static shape at the quadrature points: t (2, q), along = t t' and across (2, 2, q), string = T/(1 + eps) (q,)."""

    def __init__(self, EA, m, ma, w0, L, span, degree):
        self.nodes, weights = legendre.leggauss(2 * degree + EXTRA_POINTS)
        self.s, self.weights, self.L, self.degree = (self.nodes + 1) * L / 2, weights * L / 2, L, degree
        self.H, self.V0 = _anchor_force(EA, w0, L, span)
        V = self.V0 + w0 * self.s
        T = np.hypot(self.H, V)
        self.t, self.string = np.array([np.full_like(T, self.H), V]) / T, T / (1 + T / EA)
        self.along = self.t[:, None] * self.t[None]
        self.across = np.eye(2)[:, :, None] - self.along
        self.ends = float(np.hypot(self.H, self.V0)), float(np.hypot(self.H, self.V0 + w0 * L))

    def basis(self):
        return _basis(self.nodes, self.degree, self.L)

    def driven(self, K, M, omega, motion, at):
        """q_s (c, n) at arc lengths `at` for motions (c,) of the end s = L: s/L times the motion plus the basis."""
        phi, slope = self.basis()
        lift, lift_slope = (self.s / self.L)[:, None], np.full((self.s.size, 1), 1 / self.L)
        phi, slope = np.hstack([phi, lift]), np.hstack([slope, lift_slope])
        n, c = self.degree + 1, len(motion)
        stiffness = _gram(slope, self.weights, K) - omega**2 * _gram(phi, self.weights, M)
        held = np.arange(c) * n + n - 1
        free = np.setdiff1d(np.arange(c * n), held)
        a = np.zeros(c * n, complex)
        a[held] = motion
        a[free] = np.linalg.solve(stiffness[np.ix_(free, free)], -stiffness[np.ix_(free, held)] @ motion)
        _, slope = _basis(2 * at / self.L - 1, self.degree, self.L)
        return a.reshape(c, n) @ np.hstack([slope, np.full((at.size, 1), 1 / self.L)]).T


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
