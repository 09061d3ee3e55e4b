"""Regimes of the elastic catenary: which one holds, and the equations of lines on the seabed and of straight ones.

With lengths in L and forces in w L a span is four numbers, l = x/L, h = z/L, e = w L/EA and the friction CB, plus the
height c = clearance/L of the anchor above the seabed. Each regime with a tension field is one strictly decreasing
function of one unknown, so Newton's method with a bracket (``newton.monotone_root``) solves it from any start. Lines
that hang free are in ``suspended``. Resting on the seabed, MSQS (2.23): with p = asinh(V/H) at the (higher) end, H
follows from its height in closed form,

    h = H (cosh p - 1) + e (H sinh p)^2/2,  and (2.23a) is the one equation for p.

Every function takes a namespace ``f`` of elementary functions (``elementary.SCALAR`` or ``ARRAY``), so that one text
serves floats, arrays of shape (n,), and complex step in the tests. Forces are the tuple ``(H, V, H_anchor, V_anchor,
grounded_length)``, stiffness as ``(K11, K12, K21, K22)`` = d(H, V)/d(l, h).
"""

from __future__ import annotations

import math
from enum import Enum

SMALLEST = math.ulp(0.0)
TINY = 1e-290  # keeps a divisor from zero, far below anything that counts
NARROWEST = 1e-50  # a span narrower than this part of its length or height is vertical
LOWEST = 1e-100  # an end less than this part of L above the seabed lies on it
LIGHTEST = 1e-300  # N, of w L: below it forces lose their digits
STIFFEST = 1e-305  # wL/EA of a stiffer line is set to it
LARGEST = 1e40  # of l, h, c, CB and wL/EA: beyond, intermediate results leave the range of double precision
MASSLESS_STRAIN = 1e-60  # a taut line whose wL/EA is below it is straight to far below double precision
LARGEST_ANGLE = 690.0  # cosh stays finite; reached only below l = NARROWEST


class Regime(Enum):
    """Which closed form holds."""

    SUSPENDED = "suspended between its ends"
    STEEP = "suspended, stretched along its whole length and steep"
    GROUNDED = "resting on the seabed from the anchor on"
    SAGGING = "resting on the seabed between two raised ends"
    SLACK = "hanging straight down to the seabed, without horizontal force"
    LYING = "stretched along the seabed"
    VERTICAL = "vertical, or folded over without horizontal force"
    MASSLESS = "a straight spring"


REGIMES = tuple(Regime)
SUSPENDED, STEEP, GROUNDED, SAGGING, SLACK, LYING, VERTICAL, MASSLESS = range(len(REGIMES))


# ---------------------------------------------------------------- which regime holds
def classify(f, l, h, e, CB, c, seabed, massless):
    """Return the regime of each span; a line over a raised anchor counts as suspended until ``sags_to_seabed``."""
    chord = f.sqrt(l * l + h * h)
    regime = f.where(spare_height(abs(h), e) < 0, STEEP, SUSPENDED)
    regime = f.where((e < MASSLESS_STRAIN) & (chord > 1), MASSLESS, regime)
    on_seabed = seabed & (c == 0) & rests_from_anchor(f, l, h, e)
    regime = f.where(on_seabed, f.where(h > LOWEST, GROUNDED, LYING), regime)
    regime = f.where(l < NARROWEST * (1 + abs(h)), VERTICAL, regime)
    regime = f.where((e <= STIFFEST) & (chord > 1), MASSLESS, regime)
    hanging = hanging_length(f, f.where(seabed, h + c, 0.0), e), hanging_length(f, c, e)
    slack = seabed & (slack_length(1, l, *hanging) >= 0)
    return f.where(massless, MASSLESS, f.where(slack, SLACK, regime))


def slack_length(L, l, hanging, hanging_anchor):
    """Return what is left of the length L where both ends hang straight down, less the reach l: slack if >= 0.

    hanging, hanging_anchor : ``hanging_length`` of the fairlead and of the anchor end
    """
    return L - hanging - hanging_anchor - l


def rests_from_anchor(f, l, h, e):
    """Return whether a line with its anchor on the seabed rests there, at h = 0 also whether it lies all along.

    It just touches where V = wL: H = (1 - k^2)/2k from (2.23b) with k = h - e/2, and l from (2.23a).
    """
    difference = h - e / 2
    k = f.maximum(difference, SMALLEST)
    H = (1 - k * k) / (2 * k)
    return (difference <= 0) | ((k < 1) & (l <= H * (f.arcsinh(1 / f.maximum(H, SMALLEST)) + e)))


def sags_to_seabed(f, regime, forces, e, c):
    """Return whether a line that was taken as suspended over a raised anchor would hang below the seabed."""
    return (c > 0) & (regime <= STEEP) & (lowest_point(f, forces, e) > c)


def touches_seabed(V, lift, weight):
    """Return whether a line rests on the seabed: V >= 0, and both ends together lift less than its weight."""
    return (V >= 0) & (lift < weight)


def spare_height(height, e):
    """Return 1 + e/2 - h: how far a line of no reach would hang below its lower end; the line is steep if negative."""
    return (1 - height) + e / 2


def lowest_point(f, forces, e):
    """Return the depth below the anchor of the point where the line is level, 0 if there is none between the ends."""
    H, V, _, V_anchor, _ = forces
    b = f.where(V > 0, f.minimum(V_anchor, 0.0), 0.0)
    return b * b * (1 / (f.sqrt(H * H + b * b) + H + TINY) + e / 2)


def hanging_length(f, h, e):
    """Return the unstretched length s that hangs straight down to the seabed from height h: h = s + e s^2/2."""
    return 2 * h / (1 + f.sqrt(1 + 2 * e * h))


def hanging_force(f, H, h, e):
    """Return the vertical force V of an end at height h: h = sqrt(H^2 + V^2) - H + e V^2/2."""
    return f.sqrt(2 * h * (h + 2 * H) / (1 + e * (h + H) + f.sqrt(1 + 2 * e * (h + H) + (e * H) * (e * H))))


def hanging_force_in_newtons(f, H, height, w, EA, L):
    """Return the vertical force of an end at a height (m) above the seabed where the horizontal force is H, N."""
    weight = w * L
    return weight * hanging_force(f, H / weight, height / L, weight / EA)


def cosh_excess(f, y, sinh, cosh):
    """Return y cosh y - sinh y without cancellation (series below y = 0.1: next term y^11 / 4e8)."""
    y2 = y * y
    series = y * y2 / 3 * (1 + y2 / 10 * (1 + y2 / 28 * (1 + y2 / 54)))
    return f.where(abs(y) < 0.1, series, y * cosh - sinh)


# ---------------------------------------------------------------- resting on the seabed
def _end_compliance(f, p, H, V, T, e):
    """Return d(reach, height)/d(H, V) of what hangs from one end: (C11, C12 = C21, C22), without cancellation."""
    p_minus_tanh = cosh_excess(f, p, V / H, T / H) * (H / T)
    return p_minus_tanh + e * V, -V / T * (V / (T + H)), V / T + e * V


def _grounded_forces(f, p, h, e):
    """Return (H, V, T) of the end at height h whose tension makes sinh p = V/H."""
    s = f.sinh(p / 2)
    cosh_minus_1, sinh = 2 * s * s, 2 * s * f.sqrt(1 + s * s)
    H = 2 * h / (cosh_minus_1 * (1 + f.sqrt(1 + 2 * e * h * (1 + 2 / cosh_minus_1))))
    return H, H * sinh, H * (1 + cosh_minus_1)


def _other_end(f, H, c, e):
    """Return V, asinh(V/H) and ``_end_compliance`` of an end at height c >= 0 where the horizontal force is H."""
    V = hanging_force(f, H, c, e)
    angle = f.arcsinh(V / H)
    return V, angle, _end_compliance(f, angle, H, V, f.sqrt(H * H + V * V), e)


def friction_stretch(f, H, grounded, CB):
    """Return (S, dS/dH, H - dS/dgrounded) of S = integral of H(s) ds along the seabed, MSQS (2.14)-(2.19).

    Beyond lift-off (grounded < 0, iterates only) there is no friction: S stays increasing in H.
    """
    drag = CB * f.where(grounded.real > 0, grounded, 0.0)
    pulled = (H - drag).real >= 0  # tension reaches the anchor; else it ends after H/CB
    limit = H / f.maximum(CB, TINY)
    stretch = f.where(pulled, (H - drag / 2) * grounded, H / 2 * limit)
    return stretch, f.where(pulled, grounded, limit), f.where(pulled, drag, H)


def grounded_start(f, l, h, e, CB, c=0.0):
    """Return (start, upper bound) for p.

    Nearly slack from e^-p, taut from p = 3 (L - l)/h, over-stretched from H alone.
    """
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
    """Return (2.23a) minus l, in units of max(1, l), and its Newton step in log p.

    h: height of the higher end above the seabed; c: height of the other end (None: it lies there). Near the slack line
    the reach goes like H log(1/H), so the step is that of the logarithm of the reach gained over the slack line.
    """
    H, V, T = _grounded_forces(f, p, h, e)
    C11, C12, C22 = _end_compliance(f, p, H, V, T, e)
    dH = -H * T / (V + H * C12 / C22)  # at fixed height: C12 dH + C22 dV = 0, and H T dp = H dV - V dH
    dV = -C12 / C22 * dH
    Vc, angle, (B11, B12, B22) = (0.0, 0.0, (0.0, 0.0, 0.0)) if c is None else _other_end(f, H, c, e)
    dVc = 0.0 if c is None else -B12 / f.where(c > 0, B22, 1.0) * dH
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
    """Return forces and stiffness from p; swapped : the anchor is the higher end (only with c > 0, no friction)."""
    H, V, T = _grounded_forces(f, p, h, e)
    top = _end_compliance(f, p, H, V, T, e)
    Vc, _, low = (0.0 * V, 0.0, (0.0, 0.0, 0.0)) if c is None else _other_end(f, H, c, e)
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
    """Return H of a line stretched from 1 to l along the seabed; with friction its tension may end after H/CB."""
    stretch = f.maximum(l - 1, 0.0) / e
    return f.where(stretch < CB / 2, f.sqrt(2 * CB * stretch), stretch + CB / 2)


def lying_state(f, l, e, CB):
    """Return forces and stiffness of a line that is taut on the seabed, h = 0.

    Lifting it takes V = sqrt(2 H h): K22 is infinite, with friction K12 too.
    """
    H = lying_force(f, l, e, CB)
    slope = f.where(H < CB, CB / f.maximum(H, TINY), 1.0) / e
    coupling = f.where(CB > 0, -math.inf, 0.0)
    return (H, 0 * l, f.maximum(H - CB, 0.0), 0 * l, 1 + 0 * l), (slope, coupling, 0 * l, math.inf + l)


def slack_state(f, h, e, c):
    """Return forces and stiffness of a slack line: each end carries what hangs from it, the rest lies on the seabed."""
    zero = 0 * abs(h)
    V, V_anchor = hanging_length(f, h + c, e), 0 - hanging_length(f, c, e)
    return (zero, V, zero, V_anchor, 1 - V + V_anchor), (zero, zero, zero, 1 / (1 + e * V))


def vertical_state(f, h, e):
    """Return forces and stiffness at l = 0, taut (|h| > 1 + e/2) or folded over; K11 is the limit of H/l."""
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
    """Return forces, in EA, and stiffness of a straight spring: T = chord - 1 if positive, else 0."""
    chord = f.sqrt(l * l + h * h)
    T = f.maximum(chord - 1, 0.0)
    cos, sin = l / f.maximum(chord, TINY), h / f.maximum(chord, TINY)
    along, across = f.where(T > 0, 1.0, 0.0), T / f.maximum(chord, TINY)
    coupling = (along - across) * cos * sin
    stiffness = along * cos * cos + across * sin * sin, coupling, coupling, along * sin * sin + across * cos * cos
    return (T * cos, T * sin, T * cos, T * sin, 0 * l), stiffness
