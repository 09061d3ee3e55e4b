"""Closed forms for small networks: a point on elastic lines, a buoy on a tether, strings and bars that meet at a joint.

`PointOnLines` is a clump weight or buoy held by lines without inner nodes. `tethered_buoy` is a buoy over a tether with
mass and weight, without stretch, in Bessel functions. `joint_frequencies` is the transcendental equation of uniform
arms, strings or bars, that end at one mass; `star_frequencies` applies it to n equal arms at equal angles. An arm may
be lumped into cells: then the equation is exact for the lumped arm too. mpf throughout, SI units, frequencies in Hz.
"""

from __future__ import annotations

from dataclasses import dataclass

from mpmath import mp, mpf

from verification.exact.cable.frequencies import vertical_string


# ---------------------------------------------------------------- one point
@dataclass(frozen=True)
class PointOnLines:
    """A point with mass M, kg, and weight W in water, N (negative for a buoy), on straight lines from other points.

    ends (k, 3) : m;  length, EA, beta : k each, m, N, s;  added : Ca rho V, kg
    line_mass, line_added, line_weight : kg/m, kg/m, N/m, k each: the half of each line that its one cell gives to the
    point
    """

    ends: tuple
    length: tuple
    EA: tuple
    mass: float
    weight: float
    added: float = 0.0
    beta: tuple | None = None
    line_mass: tuple | None = None
    line_added: tuple | None = None
    line_weight: tuple | None = None

    def _of(self, name):
        return [mpf(value) for value in getattr(self, name) or [0] * len(self.length)]

    def _lines(self, r):
        """Return (size, tangent from the end to the point, tension, EA / length) of each line."""
        lines = []
        for end, l, EA in zip(self.ends, self._of("length"), self._of("EA"), strict=True):
            d = r - mp.matrix([mpf(x) for x in end])
            size = mp.norm(d)
            lines.append((size, d / size, EA * (size / l - 1), EA / l))
        return lines

    def _stiffness(self, r):
        total = mp.zeros(3)
        for size, t, T, k in self._lines(r):
            total += k * t * t.T + T / size * (mp.eye(3) - t * t.T)
        return total

    def equilibrium(self, start):
        """Return the point's position, mp.matrix (3), m, by Newton's method from `start` (3,).

        Raises ArithmeticError where it does not converge or a line is slack there.
        """
        down = (
            mpf(self.weight) + sum(w * l for w, l in zip(self._of("line_weight"), self._of("length"), strict=True)) / 2
        )
        r = mp.matrix([mpf(x) for x in start])
        for _ in range(60):
            force = mp.matrix([0, 0, -down])
            for _, t, T, _ in self._lines(r):
                force -= T * t
            step = mp.lu_solve(self._stiffness(r), force)
            r = r + step
            if mp.norm(step) < mp.norm(r) * mp.eps * 2**10:
                if min(line[2] for line in self._lines(r)) < 0:
                    raise ArithmeticError("a line is slack at the equilibrium")
                return r
        raise ArithmeticError("no equilibrium: start nearer")

    def tensions(self, r):
        """Return the tension of each line, N, with the point at r."""
        return [line[2] for line in self._lines(r)]

    def _mass(self, r):
        halves = zip(self._lines(r), self._of("length"), self._of("line_mass"), self._of("line_added"), strict=True)
        total = (mpf(self.mass) + mpf(self.added)) * mp.eye(3)
        for (_, t, _, _), l, m, ma in halves:
            total += l / 2 * ((m + ma) * mp.eye(3) - ma * t * t.T)
        return total

    def frequencies(self, r):
        """Return the three natural frequencies about the equilibrium r, Hz ascending."""
        factor = mp.cholesky(self._mass(r))
        half = factor**-1
        values = mp.eigsy(half * self._stiffness(r) * half.T, eigvals_only=True)
        return sorted(mp.sqrt(value) / (2 * mp.pi) for value in values)

    def plane_frequencies(self, r):
        """Return ((two in the plane x, z), the one across it), Hz, of ends with y = 0: roots of a quadratic."""
        K, M = self._stiffness(r), self._mass(r)
        a = M[0, 0] * M[2, 2] - M[0, 2] ** 2
        b = K[0, 0] * M[2, 2] + K[2, 2] * M[0, 0] - 2 * K[0, 2] * M[0, 2]
        c = K[0, 0] * K[2, 2] - K[0, 2] ** 2
        root = mp.sqrt(b * b - 4 * a * c)
        squares = (2 * c / (b + root), (b + root) / (2 * a))
        return tuple(mp.sqrt(x) / (2 * mp.pi) for x in squares), mp.sqrt(K[1, 1] / M[1, 1]) / (2 * mp.pi)

    def response(self, r, omega, line, motion):
        """Return the complex amplitudes of the point, mp.matrix (3), m, and of the tensions, N, of a moved end.

        omega : rad/s, of x(t) = Re X exp(i omega t);  line : whose end moves;  motion : (3,), m, its small amplitude
        """
        omega, h = mpf(omega), mp.matrix([mp.mpmathify(x) for x in motion])
        dynamic, load, complexities = -(omega**2) * self._mass(r), mp.zeros(3, 1), []
        for i, ((size, t, T, k), beta) in enumerate(zip(self._lines(r), self._of("beta"), strict=True)):
            along = k * (1 + 1j * omega * beta)
            matrix = along * t * t.T + T / size * (mp.eye(3) - t * t.T)
            dynamic += matrix
            complexities.append(along)
            if i == line:
                load = matrix * h
        x = mp.lu_solve(dynamic, load)
        tensions = []
        for i, ((_, t, _, _), along) in enumerate(zip(self._lines(r), complexities, strict=True)):
            tensions.append(along * (t.T * (x - h if i == line else x))[0])
        return x, tensions


def buoy_swing(buoyancy, mass, length, EA=mp.inf):
    """Return the frequency of a buoy's small swing on a tether without mass, Hz: sqrt(B / (M stretched length)).

    buoyancy : N, upward less weight;  mass : kg, added mass included;  length : m, unstretched
    """
    B = mpf(buoyancy)
    return mp.sqrt(B / (mpf(mass) * mpf(length) * (1 + B / mpf(EA)))) / (2 * mp.pi)


def buoy_heave(mass, length, EA):
    """Return the frequency of a buoy's heave on an elastic tether without mass, Hz: sqrt(EA / (length M))."""
    return mp.sqrt(mpf(EA) / (mpf(length) * mpf(mass))) / (2 * mp.pi)


def tethered_buoy(count, buoyancy, mass, weight, line_mass, length):
    """Return the first `count` swing frequencies, Hz, of a buoy over an inextensible tether held at its foot.

    buoyancy : N, of the buoy, the tension at the top;  mass : kg, of the buoy, added mass included
    weight : N/m, of the tether in water, > 0;  line_mass : kg/m, added mass included;  length : m
    With z = (2 omega sqrt(line_mass) / weight) sqrt(T(s)) the shapes are combinations of J0 and Y0 of z that vanish at
    the foot; at the top T u_s = mass omega^2 u. Each root lies below a frequency of the tether held at both ends.
    """
    w, m, M = mpf(weight), mpf(line_mass), mpf(mass)
    foot, top = mpf(buoyancy) - w * mpf(length), mpf(buoyancy)
    if foot <= 0:
        raise ValueError("the buoy does not bear the tether")

    def difference(omega):
        k = 2 * omega * mp.sqrt(m) / w
        z, z_foot = k * mp.sqrt(top), k * mp.sqrt(foot)
        u = mp.besselj(0, z) * mp.bessely(0, z_foot) - mp.bessely(0, z) * mp.besselj(0, z_foot)
        slope = -mp.besselj(1, z) * mp.bessely(0, z_foot) + mp.bessely(1, z) * mp.besselj(0, z_foot)
        return mp.sqrt(top) * k * w / 2 * slope / u - M * omega**2

    poles = [2 * mp.pi * f for f in vertical_string(count, foot, weight, line_mass, length)]
    lower = [poles[0] * mpf(10) ** -6, *poles]
    return [_falling_root(difference, a, b) / (2 * mp.pi) for a, b in zip(lower, poles, strict=False)]


# ---------------------------------------------------------------- arms at a joint
@dataclass(frozen=True)
class Arm:
    """A uniform string or bar, m u_tt = K u_ss, held at its far end: K N, mass kg/m, length m.

    cells : its number of equal cells with half of each one's mass at either end, or None for the continuous arm
    share : what of its force acts along the joint's motion, the sum of squared cosines over arms alike
    """

    K: float
    mass: float
    length: float
    cells: int | None = None
    share: float = 1

    def stiffness(self, omega):
        """Return the force at the joint over its displacement at omega rad/s, N/m, share left out.

        K k cot(k length) with k = omega sqrt(mass / K); in cells of length h, 2 sin(theta / 2) = h k and
        (K / h) sin(theta) cot(cells theta).
        """
        K, k, l = mpf(self.K), omega * mp.sqrt(mpf(self.mass) / mpf(self.K)), mpf(self.length)
        if self.cells is None:
            return K * k * mp.cot(k * l)
        h = l / self.cells
        theta = mp.acos(1 - (h * k) ** 2 / 2)  # complex above the highest frequency of the cells
        return mp.re(K / h * mp.sin(theta) * mp.cot(self.cells * theta))

    def poles(self, count):
        """Return at most `count` frequencies, rad/s, with the joint fixed."""
        speed, l = mp.sqrt(mpf(self.K) / mpf(self.mass)), mpf(self.length)
        if self.cells is None:
            return [n * mp.pi * speed / l for n in range(1, count + 1)]
        N = self.cells
        return [2 * speed * N / l * mp.sin(n * mp.pi / (2 * N)) for n in range(1, min(count, N - 1) + 1)]


def joint_frequencies(count, arms, joint_mass=0.0):
    """Return the first `count` frequencies, Hz, of arms that move one mass: sum share K k cot(k l) = mass omega^2.

    Arms in line are the two-material string (K = T / (1 + eps)) or bar (K = EA). The difference of the sides falls
    from one pole to the next, so that one root lies between; where poles coincide that root is the pole, at which the
    joint rests. Raises ValueError where lumped arms have fewer than `count` poles.
    """
    poles = sorted(pole for arm in arms for pole in arm.poles(count))[:count]
    if len(poles) < count:
        raise ValueError(f"{len(poles)} frequencies are closed between poles, not {count}")

    def difference(omega):
        return sum(mpf(arm.share) * arm.stiffness(omega) for arm in arms) - mpf(joint_mass) * omega**2

    lower = [poles[0] * mpf(10) ** -12, *poles]
    return [_falling_root(difference, a, b) / (2 * mp.pi) for a, b in zip(lower, poles, strict=False)]


def star_frequencies(count, *, arms, tension, EA, mass, added_mass, length, joint_mass, cells=None):
    """Return the first `count` frequencies, Hz, of each kind for n >= 3 equal taut arms at equal angles in a plane.

    tension : N, in the arms;  mass, added_mass : kg/m, the latter across the arms only;  length : m, unstretched
    joint_mass : kg, all that moves with the joint in any direction. Kinds, with their multiplicity for n = 3:
    "in plane" (2), joint moves in the plane; "out of plane" (1), across it; with the joint at rest "axial" (n - 2),
    "transverse in plane" (n - 2) and "transverse out of plane" (n - 1). Gravity is left out.
    """
    K = mpf(tension) / (1 + mpf(tension) / mpf(EA))
    axial = Arm(EA, mass, length, cells, mpf(arms) / 2)
    across = Arm(K, mass + added_mass, length, cells, mpf(arms) / 2)
    upright = Arm(K, mass + added_mass, length, cells, arms)
    to_Hz = lambda poles: [pole / (2 * mp.pi) for pole in poles]
    return {
        "in plane": joint_frequencies(count, [axial, across], joint_mass),
        "out of plane": joint_frequencies(count, [upright], joint_mass),
        "axial": to_Hz(axial.poles(count)),
        "transverse in plane": to_Hz(across.poles(count)),
        "transverse out of plane": to_Hz(across.poles(count)),
    }


def _falling_root(f, a, b):
    """Return the root in (a, b) of f, which falls there from a positive value; a where there is nothing between."""
    if b - a <= 4 * mp.eps * b:
        return a
    for _ in range(mp.prec + 8):
        middle = (a + b) / 2
        a, b = (middle, b) if f(middle) > 0 else (a, middle)
    return (a + b) / 2
