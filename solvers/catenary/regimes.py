"""The elastic catenary of one span, regime by regime, in units of its own length and weight.

With lengths in L and forces in w L a span is four numbers: l = x/L, h = z/L, e = w L/EA and the friction CB, plus the
height c = clearance/L of the anchor above the seabed. Each regime with a tension field is one strictly decreasing
function of one unknown, so Newton's method with a bracket (``newton``) solves it from any start:

- suspended, MSQS (2.4): with y = half the difference of asinh(V/H) at the ends, v the height before stretch,
      v = h / (1 + (e/2) coth y),   H = l / (2y + e),   V = (v coth y + 1)/2,
      l = sqrt(1 - v^2) (y + e/2) / sinh y            (one equation for y; no difference of asinh or of square roots);
- resting on the seabed, MSQS (2.23): with p = asinh(V/H) at the (higher) end, H follows from its height in closed form,
      h = H (cosh p - 1) + e (H sinh p)^2/2,  and (2.23a) is the one equation for p.

Every function takes a namespace ``f`` of elementary functions (``elementary.SCALAR`` or ``ARRAY``), so that one text
serves floats, arrays of shape (n,), and complex step in the tests. Forces are the tuple ``(H, V, H_anchor, V_anchor,
grounded_length)``, stiffness as ``(K11, K12, K21, K22)`` = d(H, V)/d(l, h).
"""

from __future__ import annotations

import math

TINY = 1e-290  # keeps a divisor from zero, far below anything that counts
NARROWEST = 1e-50  # a span narrower than this part of its length or height is vertical
LOWEST = 1e-100  # an end less than this part of L above the seabed lies on it
LIGHTEST = 1e-300  # N, of w L: below it forces lose their digits
STIFFEST = 1e-305  # wL/EA of a stiffer line is set to it
LARGEST = 1e40  # of l, h, c, CB and wL/EA: beyond, intermediate results leave the range of double precision
MASSLESS = 1e-60  # a taut line lighter than MASSLESS EA/L is straight to far below double precision
LARGEST_ANGLE = 690.0  # cosh stays finite; reached only below l = NARROWEST


def hanging_length(f, h, e):
    """Unstretched length s that hangs straight down to the seabed from height h: h = s + e s^2/2."""
    return 2 * h / (1 + f.sqrt(1 + 2 * e * h))


def _cosh_excess(f, y, sinh, cosh):
    """y cosh y - sinh y without cancellation (series below y = 0.1: next term y^11 / 4e8)."""
    y2 = y * y
    series = y * y2 / 3 * (1 + y2 / 10 * (1 + y2 / 28 * (1 + y2 / 54)))
    return f.where(abs(y) < 0.1, series, y * cosh - sinh)


# ---------------------------------------------------------------- suspended
def suspended_start(f, l, height, e):
    """(start, upper bound) for y: slack from sinh(y)/y, near-taut y^3 = 3 e c^2/(2 l^2), over-stretched."""
    chord = f.sqrt(l * l + height * height)
    one_minus_v = f.maximum(spare_height(height, e), TINY) / (1 + e / 2)
    slack = f.maximum(f.log(f.sqrt(one_minus_v * (2 - one_minus_v)) / l), 0.0)
    near = f.cbrt(1.5 * e * chord * chord / (l * l))
    over = f.where(chord > 1, e / 2 / f.maximum(chord - 1, TINY), 3.0)
    start = f.maximum(f.sqrt(6 * slack + slack * slack), f.minimum(f.minimum(near, over), 3.0))
    return f.minimum(start, LARGEST_ANGLE - 1), 0 * l + LARGEST_ANGLE


def suspended_residual(f, y, l, height, e):
    """log of (computed l)/l, and its Newton step in log y."""
    return _suspended_step(f, *_suspended_angle(f, y, height, e), l, e)  # type: ignore[call-arg]


def _suspended_angle(f, y, height, e):
    """(y, sinh, cosh, v, 1 - v) at the unknown y; zeta = (e/2) coth y is the vertical stretch over v.

    1 - v is summed from two terms >= 0, with coth y - 1 = 1/(s (s + c)).
    """
    s, c = _sinh_cosh(f, y)
    zeta = e / 2 / s * c
    return y, s, c, height / (1 + zeta), (spare_height(height, e) + e / 2 / s / (s + c)) / (1 + zeta)


def spare_height(height, e):
    """1 + e/2 - h: how far a line of no horizontal extent would hang below its lower end; negative: steep."""
    return (1 - height) + e / 2


def _sinh_cosh(f, y):
    s = f.sinh(y)
    bounded = f.minimum(s, 1e9)  # beyond, cosh = sinh in double precision, and s * s may overflow
    return s, f.maximum(s, f.sqrt(1 + bounded * bounded))


def _suspended_step(f, y, s, c, v, one_minus_v, l, e):
    g = f.log(f.sqrt(one_minus_v * (1 + v)) * ((y + e / 2) / s) / l)
    # -dg/dlog y, both parts positive: of sqrt(1 - v^2), and of (y + e/2)/sinh y
    falling = v * v * (e / 2 / s) * (y / s) / (one_minus_v * (1 + v) * (1 + e / 2 / s * c))
    return g, g / (falling + (_cosh_excess(f, y, s, c) + e / 2 * c) / (y + e / 2) * (y / s))


# Over-stretched and steep (h > 1 + e/2): v reaches 1 at y = y_max, where l = 0. The unknown t = y/(1 - y/y_max) in
# (0, inf) keeps the distance to y_max as a relative quantity, so 1 - v has no cancellation however steep the line.
def steep_start(f, l, height, e):
    """(start, upper bound) for t: over-stretched as above, or nearly vertical."""
    y_max = _steepest(f, height, e)
    s = f.sinh(y_max)
    chord = f.sqrt(l * l + height * height)
    near = f.cbrt(1.5 * e * chord * chord / (l * l))
    y = f.minimum(f.minimum(e / 2 / (chord - 1), near), 0.75 * y_max)
    width = l * s / (y_max + e / 2)
    distance = width * width * (height / e) * s * (s / y_max)  # (y_max - y)/y_max of a nearly vertical line
    return f.maximum(y / (1 - y / y_max), y_max * (1 / f.maximum(distance, TINY) - 1)), 0 * l + 1e300


def _steepest(f, height, e):
    """y_max, where v = 1: (e/2) coth y_max = h - 1."""
    return f.log1p(e / -spare_height(height, e)) / 2


def _steep_angle(f, t, height, e):
    """(y, sinh, cosh, v, 1 - v) at the unknown t."""
    y_max = _steepest(f, height, e)
    y = t / (1 + t / y_max)
    s, c = _sinh_cosh(f, y)
    zeta = e / 2 / s * c
    # zeta - (h - 1) = (e/2)(coth y - coth y_max)
    one_minus_v = e / 2 / s * (f.sinh(y_max / (1 + t / y_max)) / f.sinh(y_max)) / (1 + zeta)
    return y, s, c, height / (1 + zeta), one_minus_v


def steep_residual(f, t, l, height, e):
    """As ``suspended_residual`` with the unknown t."""
    y, s, c, v, one_minus_v = _steep_angle(f, t, height, e)
    g, step = _suspended_step(f, y, s, c, v, one_minus_v, l, e)
    return g, step * (t / y)


def steep_state(f, t, l, h, e):
    """Forces and stiffness from the unknown t."""
    up = f.where(h.real < 0, -1.0, 1.0)
    return _suspended_state(f, *_steep_angle(f, t, up * h, e), l, up, e)  # type: ignore[call-arg]


def suspended_state(f, y, l, h, e):
    """Forces and stiffness from y; the determinant of the compliance is summed from positive terms only."""
    up = f.where(h.real < 0, -1.0, 1.0)
    return _suspended_state(f, *_suspended_angle(f, y, up * h, e), l, up, e)  # type: ignore[call-arg]


def _suspended_state(f, y, s, c, v, one_minus_v, l, up, e):
    H = l / (2 * y + e)
    mean = up * v / 2 * (c / s)
    # compliance d(l, h)/d(H, V) = [[C11 + e, -Y], [-Y, X + e]]; all divided by q = r^2/(1 + r^2)
    r = f.sqrt(one_minus_v * (1 + v)) * s
    over_q = 1 + (1 / r) * (1 / r)
    X = 2 * (c / s) + e * over_q
    Y = up * 2 * v / r
    excess = _cosh_excess(f, y, s, c)
    C11 = 2 * excess / c * over_q + 2 * (s / c) * (v / r) * (v / r) + e * over_q
    determinant = 4 * (excess / s) + e * (C11 + X - e * over_q)
    forces = H, mean + 0.5, H, mean - 0.5, 0 * H
    return forces, (X / determinant, Y / determinant, Y / determinant, C11 / determinant)


def lowest_point(f, forces, e):
    """Depth below the anchor of the point where the line is level, 0 if there is none between the ends."""
    H, V, _, V_anchor, _ = forces
    b = f.where(V > 0, f.minimum(V_anchor, 0.0), 0.0)
    return b * b * (1 / (f.sqrt(H * H + b * b) + H + TINY) + e / 2)


# ---------------------------------------------------------------- resting on the seabed
def _end_compliance(f, p, H, V, T, e):
    """d(reach, height)/d(H, V) of the part that hangs from one end: (C11, C12 = C21, C22), with H/T - 1 stable."""
    p_minus_tanh = _cosh_excess(f, p, V / H, T / H) * (H / T)
    return p_minus_tanh + e * V, -V / T * (V / (T + H)), V / T + e * V


def hanging_force(f, H, h, e):
    """Vertical force of an end at height h when the horizontal force is H: h = sqrt(H^2 + V^2) - H + e V^2/2."""
    return f.sqrt(2 * h * (h + 2 * H) / (1 + e * (h + H) + f.sqrt(1 + 2 * e * (h + H) + (e * H) * (e * H))))


def _grounded_forces(f, p, h, e):
    """(H, V, T) of the end at height h whose tension makes sinh p = V/H."""
    s = f.sinh(p / 2)
    rise, slope = 2 * s * s, 2 * s * f.sqrt(1 + s * s)  # cosh p - 1, sinh p
    H = 2 * h / (rise * (1 + f.sqrt(1 + 2 * e * h * (1 + 2 / rise))))
    return H, H * slope, H * (1 + rise)


def _other_end(f, H, dH, c, e):
    """Of an end at height c >= 0 where the horizontal force is H: V, d V for dH, asinh(V/H), C11 and C12."""
    V = hanging_force(f, H, c, e)
    angle = f.arcsinh(V / H)
    C11, C12, C22 = _end_compliance(f, angle, H, V, f.sqrt(H * H + V * V), e)
    return V, -C12 / f.where(c > 0, C22, 1.0) * dH, angle, C11, C12


def friction_stretch(f, H, grounded, CB):
    """(S, dS/dH, H - dS/dgrounded) of S = integral of H(s) ds along the seabed, MSQS (2.14)-(2.19).

    Beyond lift-off (grounded < 0, iterates only) there is no friction: S stays increasing in H.
    """
    drag = CB * f.where(grounded.real > 0, grounded, 0.0)
    pulled = (H - drag).real >= 0  # tension reaches the anchor; else it ends after H/CB
    limit = H / f.maximum(CB, TINY)
    stretch = f.where(pulled, (H - drag / 2) * grounded, H / 2 * limit)
    return stretch, f.where(pulled, grounded, limit), f.where(pulled, drag, H)


def grounded_start(f, l, h, e, CB, c=0.0):
    """(start, upper bound) for p: nearly slack from e^-p, taut from p = 3 (L - l)/h, over-stretched from H alone."""
    hanging = hanging_length(f, h, e) + hanging_length(f, c, e)
    slackness = l - (1 - hanging)
    D = (1 - l) / hanging
    x = f.log(2 * hanging / f.maximum(slackness, TINY))
    slack = x + f.log(f.maximum(x - 1, 1.0) + f.log(f.maximum(x, 1.0)))
    H = lying_force(f, l, e, CB) + TINY
    elastic = f.cbrt(6 * e)
    over = f.minimum(f.sqrt(2 * h / (H * (1 + e * H))), f.minimum(elastic, 5.0))
    taut = f.maximum(3 * D * (1 + 0.3 * D * D), f.minimum(elastic, 2.0))
    start = f.where(D > 0.6, slack, f.where(D > 0, taut, over))
    return f.minimum(start, LARGEST_ANGLE - 1), 0 * l + LARGEST_ANGLE


def grounded_residual(f, p, l, h, e, CB, c=None):
    """(2.23a) minus l, in units of max(1, l), and its Newton step in log p.

    h: height of the higher end above the seabed; c: height of the other end (None: it lies there). Near the slack line
    the reach goes like H log(1/H), so the step is that of the logarithm of the reach gained over the slack line.
    """
    H, V, T = _grounded_forces(f, p, h, e)
    C11, C12, C22 = _end_compliance(f, p, H, V, T, e)
    dH = -H * T / (V + H * C12 / C22)  # at fixed height: C12 dH + C22 dV = 0, and H T dp = H dV - V dH
    dV = -C12 / C22 * dH
    Vc, dVc, angle, B11, B12 = (0.0,) * 5 if c is None else _other_end(f, H, dH, c, e)
    grounded = 1 - V - Vc
    stretch, S_H, lost = friction_stretch(f, H, grounded, CB)
    reach = grounded + H * (p + angle) + e * (H * (V + Vc) + stretch)
    d_reach = (C11 + B11 + e * S_H) * dH + C12 * dV + B12 * dVc + e * lost * (dV + dVc)
    hanging = hanging_length(f, h, e) + (0.0 if c is None else hanging_length(f, c, e))
    gained, wanted = reach - (1 - hanging), l - (1 - hanging)
    near_slack = (wanted < 0.75 * hanging) & (gained.real > 0)
    ratio = f.where(near_slack, gained, 1.0) / f.where(near_slack, wanted, 1.0)
    difference = f.where(abs(ratio - 1) > 1e-6, gained * f.log(ratio), reach - l)
    return (reach - l) / f.maximum(l, 1.0), -difference / (p * d_reach)


def grounded_state(f, p, l, h, e, CB, c=None, swapped=False):
    """Forces and stiffness from p; ``swapped``: the anchor is the higher end (only with c > 0, without friction)."""
    H, V, T = _grounded_forces(f, p, h, e)
    top = _end_compliance(f, p, H, V, T, e)
    low, Vc = (0.0, 0.0, 0.0), 0.0 * V
    if c is not None:
        Vc = hanging_force(f, H, c, e)
        low = _end_compliance(f, f.arcsinh(Vc / H), H, Vc, f.sqrt(H * H + Vc * Vc), e)
    grounded = 1 - V - Vc
    _, S_H, lost = friction_stretch(f, H, grounded, CB)
    F11, F12, F22 = (f.where(swapped, b, a) for a, b in zip(top, low, strict=True))
    A11, A12, A22 = (f.where(swapped, a, b) for a, b in zip(top, low, strict=True))
    # the anchor end keeps its height: eliminate its V (Schur complement); an end on the seabed has none
    C11 = F11 + A11 - A12 * A12 / f.where(A22 > 0, A22, 1.0) + e * S_H
    C12 = F12 + e * lost
    # a fairlead on the seabed (F22 = 0) takes V = sqrt(2 H h) to lift: K22 is infinite
    determinant = f.where(F22 > 0, C11 * F22 - C12 * F12, C11)
    stiffness = f.where(F22 > 0, F22, 1.0) / determinant, -C12 / determinant, -F12 / determinant
    stiffness = *stiffness, f.where(F22 > 0, C11 / determinant, math.inf)  # type: ignore[assignment]
    forces = H, f.where(swapped, Vc, V), f.maximum((H - CB * grounded).real, 0.0), 0 - f.where(swapped, V, Vc), grounded
    return forces, stiffness


# ---------------------------------------------------------------- closed forms
def lying_force(f, l, e, CB):
    """H of a line stretched from 1 to l along the seabed: friction stops the tension after H/CB, or all of it moves."""
    stretch = f.maximum(l - 1, 0.0) / e
    return f.where(stretch < CB / 2, f.sqrt(2 * CB * stretch), stretch + CB / 2)


def lying_state(f, l, e, CB):
    """Taut on the bottom, h = 0. Lifting it takes V = sqrt(2 H h): K22 is infinite, with friction K12 too."""
    H = lying_force(f, l, e, CB)
    slope = f.where(H < CB, CB / f.maximum(H, TINY), 1.0) / e
    coupling = f.where(CB > 0, -math.inf, 0.0)
    return (H, 0 * l, f.maximum(H - CB, 0.0), 0 * l, 1 + 0 * l), (slope, coupling, 0 * l, math.inf + l)


def slack_state(f, h, e, c):
    """Zero horizontal force: each end carries what hangs straight down from it; the rest lies on the seabed."""
    zero = 0 * abs(h)
    V, V_anchor = hanging_length(f, h + c, e), 0 - hanging_length(f, c, e)
    return (zero, V, zero, V_anchor, 1 - V + V_anchor), (zero, zero, zero, 1 / (1 + e * V))


def vertical_state(f, h, e):
    """l = 0: a taut line (|h| > 1 + e/2), or one folded over. K11 is the limit of H/l."""
    up = f.where(h < 0, -1.0, 1.0)
    height = up * h
    zero = 0 * height
    taut = height > 1 + e / 2
    mean = f.where(taut, (height - 1) / e, height / (2 + e))
    spread = f.log1p(1 / f.maximum(mean - 0.5, TINY))  # asinh difference of the ends as H -> 0
    V = up * mean
    K11, K22 = f.where(taut, 1 / (spread + e), 0.0), f.where(taut, 1 / e, 1 / (2 + e))
    return (zero, V + 0.5, zero, V - 0.5, zero), (K11, zero, zero, K22)


def massless_state(f, l, h):
    """Straight spring, forces in EA: T = chord - 1 if positive, else nothing."""
    chord = f.sqrt(l * l + h * h)
    T = f.maximum(chord - 1, 0.0)
    cos, sin = l / f.maximum(chord, TINY), h / f.maximum(chord, TINY)
    along, across = f.where(T > 0, 1.0, 0.0), T / f.maximum(chord, TINY)
    coupling = (along - across) * cos * sin
    stiffness = along * cos * cos + across * sin * sin, coupling, coupling, along * sin * sin + across * cos * cos
    return (T * cos, T * sin, T * cos, T * sin, 0 * l), stiffness
