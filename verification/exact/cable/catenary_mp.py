"""One elastic mooring span to 50 digits, by quadrature of its differential equations.

Unstretched arc length s runs from the anchor at (0, 0) to the fairlead at (x, z), x >= 0, z up. The force at s has the
components H(s) and V(s) (positive where the line rises), T = hypot(H, V), and

    dx/ds = H/T + H/EA,    dz/ds = V/T + V/EA,    dV/ds = w,    H constant off the seabed,

the equations behind MSQS (2.1) and (2.20). On the seabed V = 0 and dH/ds = CB w while H > 0 (MSQS 2.10-2.16).
The closed forms (2.4) and (2.23) of the paper are not used: x and z are Gauss-Legendre sums, the state is found by
bracketing and refined by Newton steps whose derivatives are differences of the quadrature, and every state is verified
by evaluating the quadrature once more.

SI units throughout: w N/m, EA N, L, x, z, clearance m, forces N. Inputs are doubles, taken exactly.
"""

from dataclasses import dataclass, replace
from functools import cache, lru_cache
from itertools import pairwise
from math import ceil, cos, log, pi

from mpmath import mp, mpf
from mpmath.libmp import fone, fzero, mpf_add, mpf_div, mpf_mul, mpf_sqrt, round_nearest

# Regimes are told apart by signs of expressions in doubles, exponents within 1e-308 ... 1e308 and squares of them.
DECISION_DIGITS = 1300
# Digits carried beyond those asked for: they absorb the rounding of a few hundred additions and the last Newton step.
GUARD_DIGITS = 20
# Digits left out of the promise when the residual of the final state is checked.
RESIDUAL_MARGIN = 5
MOST_NEWTON_STEPS = 60
# Two difference quotients of the Jacobian must agree this well, in the metric in which Newton contracts.
DERIVATIVE_AGREEMENT = mpf("1e-3")
# Digits of a stiffness, and of a condition number.
STIFFNESS_DIGITS = 40
CONDITION_DIGITS = 12

UNDETERMINED = "friction with a touching line and clearance > 0 is not a determined problem"

ZERO = mpf(0)
ONE = mpf(1)


@dataclass(frozen=True)
class ExactSpan:
    """Verified state of one span.

    regime: "suspended", "grounded" (anchor end under tension), "grounded-anchor-slack" (friction takes all of H),
        "lying" (taut along the bottom), "slack" (H = 0 on the seabed), "vertical" (x = 0: taut, or folded),
        "weightless-taut", "weightless-slack".
    H, V: force at the fairlead, N. H_anchor, V_anchor: force at the anchor, N (V_anchor < 0 where the line leaves the
    anchor downwards). grounded_length: unstretched length lying on the seabed, m. All mpf.
    """

    regime: str
    H: mpf
    V: mpf
    H_anchor: mpf
    V_anchor: mpf
    grounded_length: mpf


@dataclass(frozen=True)
class _Span:
    """Validated inputs as mpf; w >= 0 after `mirrored`."""

    w: mpf
    EA: mpf
    L: mpf
    x: mpf
    z: mpf
    seabed: bool
    friction: mpf
    clearance: mpf


def _span(w, EA, L, x, z, seabed=True, friction=0, clearance=0):
    """Validated `_Span`; every number is converted exactly, whatever the working precision."""
    with mp.workdps(DECISION_DIGITS):
        span = _Span(*(mpf(v) for v in (w, EA, L, x, z)), bool(seabed), mpf(friction), mpf(clearance))
    numbers = [v for v in vars(span).values() if not isinstance(v, bool)]
    if not all(mp.isfinite(v) for v in numbers):
        raise ValueError(f"all inputs must be finite: {span}")
    if span.EA <= 0 or span.L <= 0 or span.x < 0 or span.friction < 0:
        raise ValueError(f"need EA > 0, L > 0, x >= 0, friction >= 0: {span}")
    if span.seabed and (span.w < 0 or span.clearance < 0 or span.z < -span.clearance):
        raise ValueError(f"a seabed needs w >= 0, clearance >= 0 and z >= -clearance: {span}")
    return span


# --- quadrature ------------------------------------------------------------------------------------------------------


def _legendre(n, t):
    """P_n(t) and P_n'(t) by the three-term recurrence, in the arithmetic of t."""
    p, q = 1, t
    for k in range(2, n + 1):
        p, q = q, ((2 * k - 1) * t * q - (k - 1) * p) / k
    return q, n * (p - t * q) / (1 - t * t)


def _legendre_root(n, k, dps):
    """The k-th root of P_n from the right: Newton in doubles, then in full precision."""
    t = cos(pi * (k + 0.75) / (n + 0.5))
    for _ in range(3):
        value, slope = _legendre(n, t)
        t -= value / slope
    t, step = mpf(t), ONE
    while abs(step) > mpf(10) ** (-dps // 2 - 3):  # the step after this one would be below 10^-dps
        value, slope = _legendre(n, t)
        step = value / slope
        t -= step
    return t


@cache
def _gauss(n, dps):
    """Nodes and weights of the n-point Gauss-Legendre rule on [0, 1], n even, to dps digits."""
    rule = []
    with mp.workdps(dps + 10):
        for k in range(n // 2):
            t = _legendre_root(n, k, dps)
            weight = 1 / ((1 - t * t) * _legendre(n, t)[1] ** 2)
            rule += [((1 - t) / 2, weight), ((1 + t) / 2, weight)]
    return rule


def _rule(a, d):
    """Rule for an integrand with branch points at +-i on the panel [a, a+d], or None if the panel is too long.

    The error of n points falls as rho^(-2n), rho the sum of the half axes of the ellipse through the branch point.
    """
    centre, half = a + d / 2, d / 2
    with mp.workdps(15):
        if half * 10**30 < 1 + abs(centre):
            log_rho = float(mp.log(2 * mp.hypot(1, centre) / half))
        else:
            zeta = mp.mpc(-centre, 1) / half
            root = mp.sqrt(zeta * zeta - 1)
            log_rho = float(mp.log(max(abs(zeta + root), abs(zeta - root))))
    if log_rho < 0.8:
        return None
    n = ceil(mp.dps * log(10) / (2 * log_rho)) + 2
    step = 4 if n <= 16 else 8 if n <= 64 else 16  # few distinct rules, each computed once
    return _gauss(step * ceil(n / step), 25 * ceil(mp.dps / 25))


def _direct(a, d, rule):
    """Integrals of 1/sqrt(1+u^2) and u/sqrt(1+u^2) over [a, a+d].

    Most of the time is spent here, so the sums are of mpmath's bare numbers: the same operations without their objects.
    """
    (a, width), rounding = (a._mpf_, d._mpf_), (mp.prec, round_nearest)
    across = along = fzero
    for t, weight in rule:
        u = mpf_add(a, mpf_mul(width, t._mpf_, *rounding), *rounding)
        root = mpf_sqrt(mpf_add(fone, mpf_mul(u, u, *rounding), *rounding), *rounding)
        f = mpf_div(weight._mpf_, root, *rounding)
        across = mpf_add(across, f, *rounding)
        along = mpf_add(along, mpf_mul(u, f, *rounding), *rounding)
    return d * mp.make_mpf(across), d * mp.make_mpf(along)


def _far(a, b):
    """The same integrals over [a, b], b >> a >= 1, in v = 1/u with the parts 1/u and 1 taken out.

    1/sqrt(1+u^2) = 1/u - v^2/(q(1+q)) v and u/sqrt(1+u^2) = 1 - v^2/(q(1+q)), q = sqrt(1+v^2), du = -dv/v^2.
    """
    start, d = 1 / b, (b - a) / (a * b)
    (first, width), rounding = (start._mpf_, d._mpf_), (mp.prec, round_nearest)
    across = along = fzero
    for t, weight in _rule(start, d):  # in mpmath's bare numbers, as in `_direct`
        v = mpf_add(first, mpf_mul(width, t._mpf_, *rounding), *rounding)
        q = mpf_sqrt(mpf_add(fone, mpf_mul(v, v, *rounding), *rounding), *rounding)
        f = mpf_div(weight._mpf_, mpf_mul(q, mpf_add(fone, q, *rounding), *rounding), *rounding)
        across = mpf_add(across, mpf_mul(v, f, *rounding), *rounding)
        along = mpf_add(along, f, *rounding)
    return mp.log(b / a) - d * mp.make_mpf(across), (b - a) - d * mp.make_mpf(along)


def _one_signed(a, d):
    """`_slope_integrals` for a panel that does not change sign and does not straddle |u| = 1."""
    rule = _rule(a, d)
    if rule:
        return _direct(a, d, rule)
    if a < 0:
        across, along = _far(-a - d, -a)
        return across, -along
    return _far(a, a + d)


def _slope_integrals(a, d):
    """Integrals of cos(phi) = 1/sqrt(1+u^2) and sin(phi) = u/sqrt(1+u^2) over the slopes u = V/H in [a, a+d]."""
    rule = _rule(a, d)
    if rule:
        return _direct(a, d, rule)
    cuts = [a, *(mpf(c) for c in (-1, 0, 1) if a < c < a + d), a + d]
    parts = [_one_signed(p, q - p) for p, q in pairwise(cuts)]
    return sum(p[0] for p in parts), sum(p[1] for p in parts)


# --- pieces of a line, from anchor to fairlead -----------------------------------------------------------------------


@dataclass(frozen=True)
class _Hanging:
    """A free piece: unstretched length, horizontal force, vertical force at its anchor-side end."""

    length: mpf
    H: mpf
    V: mpf

    def rise(self, s, w, EA):
        """(dx, dz) of the first s metres; the elastic integrands are linear in s, for which the trapezoid is exact."""
        stretch_x, stretch_z = self.H * s / EA, s * (2 * self.V + w * s) / (2 * EA)
        if s == 0:
            return ZERO, ZERO
        if self.H == 0:
            down = min(max(-self.V / w, ZERO), s)
            return ZERO, s - 2 * down + stretch_z
        across, along = _slope_integrals(self.V / self.H, w * s / self.H)
        return self.H / w * across + stretch_x, self.H / w * along + stretch_z

    def tension(self, s, w):
        return mp.hypot(self.H, self.V + w * s)


@dataclass(frozen=True)
class _Lying:
    """A piece on the bottom: unstretched length, tension at its anchor-side end, tension gained per metre."""

    length: mpf
    T: mpf
    gain: mpf = ZERO
    spread: mpf = ONE

    def rise(self, s, w, EA):
        return s * self.spread + s * (2 * self.T + self.gain * s) / (2 * EA), ZERO

    def tension(self, s, w):
        return self.T + self.gain * s


def _hanging_length(H, height, w, EA):
    """Length s that rises by `height` from a horizontal tangent with force H: a root of rise(s) = height."""
    return _root_of_rise(H, height, w, EA, mp.prec)


@lru_cache(maxsize=256)  # differences with respect to V, L, ... ask for the length of the same H again
def _root_of_rise(H, height, w, EA, precision):
    """Return the root; ``precision`` is that of mpmath, which it depends on.

    rise is convex and increasing with derivative V/T + V/EA, so Newton from above falls monotonically. The
    inextensible energy balance T = H + w height bounds the root from above. The precision follows the agreement.
    """
    if height == 0:
        return ZERO
    s, full = mp.sqrt(height * (height + 2 * H / w)), mp.dps
    dps = min(20, full)
    while True:
        with mp.workdps(dps):
            V = w * s
            step = (_Hanging(s, H, ZERO).rise(s, w, EA)[1] - height) / (V / mp.hypot(H, V) + V / EA)
            s -= step
            agreed = full if step == 0 else int(mp.log10(abs(s / step)))
        if dps == full and 2 * agreed > full:
            return s
        dps = min(full, max(20, 4 * agreed + 10))


def _on_bottom(length, H, friction, w):
    """Pieces of a grounded length that ends with force H on its fairlead side (MSQS 2.13-2.16)."""
    if friction == 0 or H == 0:
        return [_Lying(length, H)]
    mobilised = min(length, H / (friction * w))
    return [_Lying(length - mobilised, ZERO), _Lying(mobilised, H - friction * w * mobilised, friction * w)]


def _pieces(H, V, p):
    """The pieces of a line with fairlead force (H, V), w > 0, and its grounded length."""
    suspended = [_Hanging(p.L, H, V - p.w * p.L)]
    if not p.seabed or V < 0 or p.w * p.L <= V:
        return suspended, ZERO
    from_fairlead, from_anchor = V / p.w, _hanging_length(H, p.clearance, p.w, p.EA)
    grounded = p.L - from_fairlead - from_anchor
    if grounded <= 0:
        return suspended, ZERO
    if p.friction > 0 and p.clearance > 0:
        raise ValueError(UNDETERMINED)
    first, last = _Hanging(from_anchor, H, -p.w * from_anchor), _Hanging(from_fairlead, H, ZERO)
    return [first, *_on_bottom(grounded, H, p.friction, p.w), last], grounded


def _walk(pieces, s, w, EA):
    """(x, z, T) at arc length s along the pieces."""
    x = z = T = ZERO
    for piece in pieces:
        part = min(s, piece.length)
        dx, dz = piece.rise(part, w, EA)
        x, z, s = x + dx, z + dz, s - part
        T = piece.tension(part, w)
        if s <= 0 and part < piece.length:
            break
    return x, z, T


def _forward(H, V, p):
    """(x, z) of the fairlead for the force (H, V), H > 0, w > 0."""
    return _walk(_pieces(H, V, p)[0], p.L, p.w, p.EA)[:2]


def excursion(H, V, w, EA, L, seabed=True, friction=0, clearance=0):
    """Fairlead position (x, z) in m for the fairlead force H > 0, V in N; right to the caller's precision.

    For V >= 0 with contact and clearance > 0 the anchor force follows from H and the clearance.
    """
    p = _span(w, EA, L, 0, 0, seabed, friction, clearance)
    with mp.extradps(GUARD_DIGITS):
        H, V = mpf(H), mpf(V)
        if H <= 0:
            raise ValueError(f"the forward map needs H > 0, got {H}")
        if seabed and clearance == 0 and V < 0:
            raise ValueError(f"V < 0 would pull the fairlead below the seabed, got {V}")
        if p.w == 0:
            stretch = L * (1 / mp.hypot(H, V) + 1 / p.EA)
            x, z = H * stretch, V * stretch
        elif p.w < 0:
            x, z = _forward(H, -V, replace(p, w=-p.w))
            z = -z
        else:
            x, z = _forward(H, V, p)
    return +x, +z


# --- regimes whose state needs no quadrature -------------------------------------------------------------------------


def _slack_lengths(p):
    """Lengths that hang straight down from the anchor and from the fairlead to the seabed (H = 0)."""
    return tuple(_hanging_length(ZERO, height, p.w, p.EA) for height in (p.clearance, p.z + p.clearance))


def _slack_margin(p):
    """Unstretched length missing before the line hangs slack: <= 0 when it does."""
    return p.x + sum(_slack_lengths(p)) - p.L


def _regime(p):
    """Regime by exact signs; "elastic" stands for every state with H > 0 that the forward map describes."""
    if p.w == 0:
        return "weightless-taut" if p.x**2 + p.z**2 > p.L**2 else "weightless-slack"
    if p.seabed and _slack_margin(p) <= 0:
        return "slack"
    if p.seabed and p.z == -p.clearance == 0:
        return "lying"
    return "vertical" if p.x == 0 else "elastic"


def _line(y, t0, t1, f):
    """Abscissa where the straight line through (t0, f(t0)), (t1, f(t1)) takes the value y."""
    f0 = f(t0)
    return t0 + (y - f0) * (t1 - t0) / (f(t1) - f0)


def _vertical_force(p):
    """V of a line with H = 0 and x = 0, no seabed in reach: z(V) is straight below, between and above 0 and w L."""
    top = p.w * p.L

    def z(V):
        return _Hanging(p.L, ZERO, V - top).rise(p.L, p.w, p.EA)[1]

    if p.z >= z(top):
        return _line(p.z, top, 2 * top, z)
    if p.z <= z(ZERO):
        return _line(p.z, -top, ZERO, z)
    return _line(p.z, ZERO, top, z)


def _lying_force(p):
    """H of a line pulled along the bottom: x(H) is quadratic while friction takes all of H, then straight."""
    full = p.friction * p.w * p.L

    def x(H):
        return _walk(_on_bottom(p.L, H, p.friction, p.w), p.L, p.w, p.EA)[0]

    if p.x >= x(full):
        return _line(p.x, full, full + p.EA, x)
    return full * mp.sqrt((p.x - p.L) / (x(full) - p.L))


def _closed_force(regime, p):
    """(H, V) at the fairlead in the regimes without quadrature."""
    if regime == "slack":
        return ZERO, p.w * _slack_lengths(p)[1]
    if regime == "lying":
        return _lying_force(p), ZERO
    if regime == "vertical":
        return ZERO, _vertical_force(p)
    chord = mp.hypot(p.x, p.z)
    T = p.EA * (chord / p.L - 1) if regime == "weightless-taut" else ZERO
    return (T * p.x / chord, T * p.z / chord) if T else (ZERO, ZERO)


def _closed_pieces(regime, H, p):
    """Pieces of slack and lying lines; slack line on the bottom is spread evenly."""
    if regime == "lying":
        return _on_bottom(p.L, H, p.friction, p.w), p.L
    first, last = _slack_lengths(p)
    grounded = p.L - first - last
    spread = p.x / grounded if grounded else ZERO
    return [
        _Hanging(first, ZERO, -p.w * first),
        _Lying(grounded, ZERO, ZERO, spread),
        _Hanging(last, ZERO, ZERO),
    ], grounded


# --- the elastic regime: a robust start and Newton on the quadrature --------------------------------------------------


def _bracketed_root(f, a, b, fa, fb, tol):
    """Root of f in [a, b], fa fb < 0, by Chandrupatla's rule: inverse quadratic where safe, else bisection."""
    c, fc, t = a, fa, mpf(0.5)
    while True:
        m = a + t * (b - a)
        fm = f(m)
        if (fm > 0) == (fa > 0):
            c, fc = a, fa
        else:
            c, fc, b, fb = b, fb, a, fa
        a, fa = m, fm
        best = a if abs(fa) < abs(fb) else b
        if fm == 0 or abs(b - a) <= 2 * tol:
            return best
        xi, phi = (a - b) / (c - b), (fa - fb) / (fc - fb)
        if phi * phi < xi and (1 - phi) ** 2 < 1 - xi:
            t = fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
        else:
            t = mpf(0.5)
        least = tol / abs(b - a)
        t = min(max(t, least), 1 - least)


def _increasing_root(f, t, tol):
    """Root of an increasing function of t on the whole axis: widening steps, then `_bracketed_root`."""
    ft, step = f(t), mpf(1)
    if ft == 0:
        return t
    while True:
        other = t - step if ft > 0 else t + step
        fo = f(other)
        if fo == 0:
            return other
        if (fo > 0) != (ft > 0):
            return _bracketed_root(f, t, other, ft, fo, tol)
        t, ft, step = other, fo, 2 * step
        if step > 10**7:
            raise ArithmeticError("no sign change found")


def _suspended_force(H, p):
    """V of a suspended line that meets p.z at given H: z is odd and increasing in the force at mid length."""
    half = p.w * p.L / 2
    if p.z == 0:
        return half

    def excess(t):
        z = _Hanging(p.L, H, mp.exp(t) - half).rise(p.L, p.w, p.EA)[1]
        return mp.log(z / abs(p.z))

    guess = abs(p.z) / p.L * max(H, half)
    return half + mp.sign(p.z) * mp.exp(_increasing_root(excess, mp.log(guess), mpf(10) ** (5 - mp.dps)))


def _force_at(H, p):
    """V that meets p.z at given H: with contact if the hanging ends are together shorter than the line."""
    if p.seabed:
        ends = [_hanging_length(H, height, p.w, p.EA) for height in (p.clearance, p.z + p.clearance)]
        if sum(ends) < p.L:
            return p.w * ends[1]
    return _suspended_force(H, p)


def _tension_guess(p, excess):
    """Order of magnitude of the tension from sag and stretch of a shallow parabola; excess = chord/L - 1."""
    weight = p.w * p.L
    limit = (p.EA * weight**2 / 24) ** (mpf(1) / 3)
    if excess > 0:
        return max(p.EA * excess, min(limit, weight / mp.sqrt(24 * excess)))
    return min(limit, weight / mp.sqrt(-24 * excess)) if excess else limit


def _lost_digits(p):
    """Digits that the bracketing needs beyond its own: near-taut, near-slack and near-vertical lines cancel them."""
    with mp.workdps(DECISION_DIGITS):
        excess = mp.hypot(p.x, p.z) / p.L - 1
        ratios = [p.L / p.x]
        ceiling = (1 + p.EA / (p.w * p.L)) ** (mpf(2) / 3)
        ratios.append(min(1 / abs(excess), ceiling) if excess else ceiling)
        if p.seabed:
            ratios.append(p.L / _slack_margin(p))
    with mp.workdps(15):
        return max(0, ceil(max(mp.log10(r) for r in ratios))), +excess


def _bracketed_start(p, accuracy):
    """(H, V) to `accuracy` (relative, in H) by nested bracketing: x increases with H along z = const."""
    lost, excess = _lost_digits(p)
    with mp.workdps(15 - int(mp.log10(accuracy)) + lost):
        chord = mp.hypot(p.x, p.z)

        def f(t):
            H = mp.exp(t)
            return mp.log(_forward(H, _force_at(H, p), p)[0] / p.x)

        guess = mp.log(_tension_guess(p, excess) * p.x / chord)
        H = mp.exp(_increasing_root(f, guess, accuracy))
        return H, _force_at(H, p)


def _steps(H, V, p):
    """Natural steps of the two unknowns: H itself; for V the least tension of the line and, with contact, V."""
    low, high = sorted((abs(V), abs(V - p.w * p.L)))
    least = mp.hypot(H, low) if low + high > p.w * p.L else H
    return H, (min(least, V) if 0 < V < 2 * p.w * p.L and p.seabed else least)


def _jacobian(H, V, p, h, origin=None):
    """Differences of the forward map over h times the natural steps; central unless the value at `origin` is given.

    Returns [[x_H, x_V], [z_H, z_V]].
    """
    dH, dV = (h * step for step in _steps(H, V, p))
    ahead = _forward(H + dH, V, p), _forward(H, V + dV, p)
    behind = (origin, origin) if origin else (_forward(H - dH, V, p), _forward(H, V - dV, p))
    widths = (dH, dV) if origin else (2 * dH, 2 * dV)
    return [[(a[i] - b[i]) / d for a, b, d in zip(ahead, behind, widths, strict=True)] for i in (0, 1)]


def _solve2(J, r):
    """Solution of the 2 x 2 system J y = r."""
    (a, b), (c, d) = J
    det = a * d - b * c
    return (d * r[0] - b * r[1]) / det, (a * r[1] - c * r[0]) / det


def _relative(dH, dV, H, V):
    return max(abs(dH) / H, abs(dV) / mp.hypot(H, V))


def _residual(H, V, p):
    """Position missing, m, the position reached, and the residual relative to x and to the chord."""
    reached = _forward(H, V, p)
    r = p.x - reached[0], p.z - reached[1]
    return r, reached, max(abs(r[0]) / p.x, abs(r[1]) / mp.hypot(p.x, p.z))


def _newton_step(H, V, p):
    """One Newton step at the present precision: new (H, V) and the relative size of the step."""
    r, reached, _ = _residual(H, V, p)
    dH, dV = _solve2(_jacobian(H, V, p, mpf(10) ** (-mp.dps // 2), reached), r)
    H_new, V_new = H + dH, V + dV
    if H_new <= 0:
        H_new = H / 4
    if p.seabed and p.clearance == 0 and V_new <= 0:
        V_new = V / 4
    return H_new, V_new, _relative(dH, dV, H, V)


def _is_verified(H, V, p, digits):
    """Whether the residual and the error of (H, V) that it implies are below the promise.

    The implied error uses central differences; it is trusted only if one-sided differences over another step give the
    same derivatives, which they do not when rounding has swamped either of them.
    """
    h = mpf(10) ** (-mp.dps // 2)
    r, reached, relative = _residual(H, V, p)
    J, other = _jacobian(H, V, p, 7 * h), _jacobian(H, V, p, h, reached)
    scale = H, mp.hypot(H, V)
    for k in (0, 1):
        column = [scale[k] * row[k] for row in other]
        image = [y / e for y, e in zip(_solve2(J, column), scale, strict=True)]
        if max(abs(image[k] - 1), abs(image[1 - k])) > DERIVATIVE_AGREEMENT:
            return False
    promise = mpf(10) ** (RESIDUAL_MARGIN - digits)
    return relative < promise and _relative(*_solve2(J, r), H, V) < mpf(10) ** -digits


def _refined(H, V, p, digits, lost):
    """Newton in stages of precision; the verified (H, V), or None if it does not get there.

    `lost` digits vanish in the differences of the map: once for the residual, twice for its numerical derivatives.
    """
    least, most = 25 + 2 * lost, max(digits + GUARD_DIGITS + lost, 25 + 2 * lost)
    dps, last = least, mp.inf
    for _ in range(MOST_NEWTON_STEPS):
        with mp.workdps(dps):
            try:
                H, V, size = _newton_step(H, V, p)
                if dps == most and size < mpf(10) ** (-digits // 2 - 5):
                    return (H, V) if _is_verified(H, V, p, digits) else None
            except ZeroDivisionError:
                return None
            if size > 10 or (size > last and last < mpf("1e-6")):
                return None
            reached = dps if size == 0 else max(0, -int(mp.log10(size)))
        last, dps = size, min(max(least, dps, 4 * reached + lost), most)
    return None


def _elastic_force(p, digits, start):
    """(H, V) of the elastic regime: from `start` if Newton takes it, else from ever tighter brackets."""
    lost = _lost_digits(p)[0]
    if start and mpf(start[0]) > 0:
        state = _refined(mpf(start[0]), mpf(start[1]), p, digits, lost)
        if state:
            return state
    for accuracy, factor in (("1e-4", 1), ("1e-10", 2), ("1e-20", 4), ("1e-40", 8)):
        state = _refined(*_bracketed_start(p, mpf(accuracy)), p, digits, factor * (lost + 5))
        if state:
            return state
    raise ArithmeticError(f"no verified state for {p}")


def _mirror(p):
    """A buoyant line is a heavy line seen upside down."""
    return replace(p, w=-p.w, z=-p.z)


def _flip(state):
    return replace(state, V=-state.V, V_anchor=-state.V_anchor)


def _fairlead_on_bottom(p):
    return p.seabed and p.z == -p.clearance < 0


def _from_fairlead(p):
    """The same line walked from a fairlead that rests on the seabed: its anchor has no clearance."""
    return replace(p, z=p.clearance, clearance=ZERO)


def _rounded(digits, regime, *numbers):
    with mp.workdps(digits):
        return ExactSpan(regime, *(+n for n in numbers))


def _elastic_state(p, digits, start):
    H, V = _elastic_force(p, digits, start)
    with mp.workdps(2 * digits + GUARD_DIGITS):
        pieces, grounded = _pieces(H, V, p)
        H_anchor = max(H - p.friction * p.w * grounded, ZERO)
        regime = "suspended" if not grounded else "grounded" if H_anchor else "grounded-anchor-slack"
        V_anchor = pieces[0].V if p.clearance or not grounded else ZERO
    return _rounded(digits, regime, H, V, H_anchor, V_anchor, grounded)


def _closed_state(regime, p, digits):
    H, V = _closed_force(regime, p)
    if regime == "vertical":
        return _rounded(digits, regime, H, V, H, V - p.w * p.L, ZERO)
    if regime.startswith("weightless"):
        return _rounded(digits, regime, H, V, H, V, ZERO)
    pieces, grounded = _closed_pieces(regime, H, p)
    if p.friction > 0 and p.clearance > 0:
        raise ValueError(UNDETERMINED)
    H_anchor = max(H - p.friction * p.w * p.L, ZERO)
    return _rounded(digits, regime, H, V, H_anchor, pieces[0].V if regime == "slack" else ZERO, grounded)


def solve(w, EA, L, x, z, seabed=True, friction=0, clearance=0, start=None, digits=50):
    """Verified `ExactSpan` to `digits` significant digits.

    start: optional (H, V) in N, only to save time. Raises ValueError for inputs without a determined solution and
    ArithmeticError if no state could be verified.
    """
    p = _span(w, EA, L, x, z, seabed, friction, clearance)
    with mp.workdps(DECISION_DIGITS):  # a change of sign rounds, too
        if p.w < 0:
            mirrored = (start[0], -mpf(start[1])) if start else None
            return _flip(_solve(_mirror(p), digits, mirrored))
        return _solve(p, digits, start)


def _solve(p, digits, start):
    regime = _regime(p)
    if regime == "elastic" and _fairlead_on_bottom(p):
        other_start = (start[0], p.w * p.L - mpf(start[1])) if start else None
        other = _elastic_state(replace(_from_fairlead(p), friction=ZERO), digits, other_start)
        if p.friction > 0 and other.grounded_length > 0:
            raise ValueError(UNDETERMINED)
        return replace(other, V=-other.V_anchor, V_anchor=-other.V)
    return _elastic_state(p, digits, start) if regime == "elastic" else _closed_state(regime, p, digits)


# --- quantities derived from a state ----------------------------------------------------------------------------------


def _central(f, value, h):
    """Derivative of a pair-valued f with respect to ln(value), by a central difference."""
    return tuple((a - b) / (2 * h) for a, b in zip(f(value * (1 + h)), f(value * (1 - h)), strict=True))


def _differencing(p, digits):
    """(working digits, step) for central differences whose inverse keeps `digits`: error h^2 and 10^-dps / h."""
    lost = _lost_digits(p)[0]
    half = (digits + lost) // 2 + 2
    return 3 * half + lost + 10, mpf(10) ** -half


def _elastic_stiffness(p, solution, digits):
    """[[dH/dx, dH/dz], [dV/dx, dV/dz]]: the inverse of the Jacobian of the forward map."""
    dps, h = _differencing(p, digits)
    with mp.workdps(dps):
        J = _jacobian(solution.H, solution.V, p, h)
        (K11, K21), (K12, K22) = _solve2(J, (mpf(1), ZERO)), _solve2(J, (ZERO, mpf(1)))
        return K11, K12, K21, K22


def _slack_stiffness(p, solution):
    return ZERO, ZERO, ZERO, p.w / (1 + p.w * _slack_lengths(p)[1] / p.EA)


def _lying_stiffness(p, solution):
    """Lifting the end by z frees a length of order sqrt(z), which carries weight and rubs no more: unbounded rates."""
    x = _central(lambda H: _walk(_on_bottom(p.L, H, p.friction, p.w), p.L, p.w, p.EA), solution.H, FINE)[0]
    return solution.H / x, (-mp.inf if p.friction else ZERO), ZERO, mp.inf


def _vertical_stiffness(p, solution):
    """Sideways: the limit of H/x as H falls, zero when the line is folded. Along: a difference of the straight z(V)."""
    bottom, top = sorted((abs(solution.V), abs(solution.V - p.w * p.L)))
    taut = bottom + top > p.w * p.L
    H = bottom * FINE
    sideways = H / _Hanging(p.L, H, solution.V - p.w * p.L).rise(p.L, p.w, p.EA)[0] if taut and H else ZERO
    dz = p.L * FINE
    return sideways, ZERO, ZERO, (_vertical_force(replace(p, z=p.z + dz)) - _vertical_force(p)) / dz


def _weightless_stiffness(p, solution):
    if solution.H == solution.V == 0:
        return ZERO, ZERO, ZERO, ZERO
    chord = mp.hypot(p.x, p.z)
    cos_, sin_, T = p.x / chord, p.z / chord, p.EA * (chord / p.L - 1)
    along, across = p.EA / p.L, T / chord
    mixed = (along - across) * cos_ * sin_
    return along * cos_**2 + across * sin_**2, mixed, mixed, along * sin_**2 + across * cos_**2


CLOSED_STIFFNESS = {
    "slack": _slack_stiffness,
    "lying": _lying_stiffness,
    "vertical": _vertical_stiffness,
    "weightless-taut": _weightless_stiffness,
    "weightless-slack": _weightless_stiffness,
}
# Relative step of limits and differences in closed regimes: its square is below every digit that is kept.
FINE = mpf(10) ** -60


def _stiffness(p, solution, digits):
    if p.w < 0:
        K11, K12, K21, K22 = _stiffness(_mirror(p), _flip(solution), digits)
        return K11, -K12, -K21, K22
    if solution.regime in CLOSED_STIFFNESS:
        with mp.workdps(3 * digits + 60):
            return CLOSED_STIFFNESS[solution.regime](p, solution)
    if _fairlead_on_bottom(p) and solution.grounded_length:
        return _stiffness(_from_fairlead(p), replace(solution, V=-solution.V_anchor), digits)[0], ZERO, ZERO, mp.inf
    return _elastic_stiffness(p, solution, digits)


def stiffness(w, EA, L, x, z, seabed=True, friction=0, clearance=0, *, solution):
    """2 x 2 mp matrix d(H, V)/d(x, z) in N/m at the `solution` of these inputs; 40 digits, not symmetric with friction.

    One-sided into the admissible region for a line lying on the bottom, where dV/dz (and with friction dH/dz) is
    infinite. At x = 0 it is the limit x -> 0+: finite sideways for a taut line, zero for a folded one.
    """
    p = _span(w, EA, L, x, z, seabed, friction, clearance)
    with mp.workdps(DECISION_DIGITS):
        K11, K12, K21, K22 = _stiffness(p, solution, STIFFNESS_DIGITS)
    return mp.matrix([[K11, K12], [K21, K22]])


def _elastic_sensitivities(p, solution, names):
    """d(H, V)/d ln(p) for every named input, from J d(H, V) = -dF for properties and J d(H, V) = d(x, z) for ends."""
    H, V = solution.H, solution.V
    ends = {"x": (p.x, ZERO), "z": (ZERO, p.z)}
    dps, h = _differencing(p, CONDITION_DIGITS)
    with mp.workdps(dps):
        J = _jacobian(H, V, p, h)

        def moved(name):
            dx, dz = _central(lambda value: _forward(H, V, replace(p, **{name: value})), getattr(p, name), h)
            return -dx, -dz

        return [_solve2(J, ends[name] if name in ends else moved(name)) for name in names]


def _closed_sensitivities(p, solution, names):
    """The same from the closed relations of the regime."""
    for name in names:

        def force(value, name=name):
            return _closed_force(solution.regime, replace(p, **{name: value}))

        yield _central(force, getattr(p, name), mpf(10) ** (-DECISION_DIGITS // 3))


def condition_number(w, EA, L, x, z, seabed=True, friction=0, clearance=0, *, solution):
    """kappa = sum over inputs p of |p| max(|dH/dp|, |dV/dp|) / hypot(H, V), dimensionless.

    0 for a state without force (an exact zero is expected); inf where the force answers like a square root (fairlead
    resting on the seabed while the anchor has clearance). An input that is exactly zero contributes nothing.
    """
    p = _span(w, EA, L, x, z, seabed, friction, clearance)
    if solution.H == solution.V == 0:
        return ZERO
    with mp.workdps(DECISION_DIGITS):
        if p.w < 0:
            p, solution = _mirror(p), _flip(solution)
        if _fairlead_on_bottom(p) and solution.grounded_length:
            return mp.inf
        names = [n for n in ("w", "EA", "L", "x", "z", "friction", "clearance") if getattr(p, n) != 0]
        rule = _closed_sensitivities if solution.regime in CLOSED_STIFFNESS else _elastic_sensitivities
        total = sum(max(abs(dH), abs(dV)) for dH, dV in rule(p, solution, names))
        return total / mp.hypot(solution.H, solution.V)


def _line_of(p, solution):
    """Pieces of a solved line with w > 0."""
    if solution.regime in ("suspended", "vertical"):
        return [_Hanging(p.L, solution.H, solution.V - p.w * p.L)]
    if solution.regime in ("slack", "lying"):
        return _closed_pieces(solution.regime, solution.H, p)[0]
    return _pieces(solution.H, solution.V, p)[0]


def profile(s, w, EA, L, x, z, seabed=True, friction=0, clearance=0, *, solution):
    """(x, z, T) in m, m, N at unstretched arc length s (m) from the anchor, 0 <= s <= L.

    Slack line on the seabed is spread evenly; a weightless line without force is drawn straight between its ends.
    """
    p = _span(w, EA, L, x, z, seabed, friction, clearance)
    with mp.extradps(GUARD_DIGITS):
        s = mpf(s)
        if not 0 <= s <= p.L:
            raise ValueError(f"s must lie in [0, L], got {s}")
        if p.w == 0:
            place = p.x * s / p.L, p.z * s / p.L, mp.hypot(solution.H, solution.V)
        elif p.w < 0:
            p, solution = _mirror(p), _flip(solution)
            x, z, T = _walk(_line_of(p, solution), s, p.w, p.EA)
            place = x, -z, T
        else:
            place = _walk(_line_of(p, solution), s, p.w, p.EA)
    return tuple(+v for v in place)
