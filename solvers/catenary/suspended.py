"""The elastic catenary between two raised ends, MSQS (2.4), in units of its own length and weight; see ``regimes``.

With y = half the difference of asinh(V/H) at the ends and v the height before stretch,

    v = h / (1 + (e/2) coth y),   H = l / (2y + e),   V = (v coth y + 1)/2,
    l = sqrt(1 - v^2) (y + e/2) / sinh y            (one equation for y; no difference of asinh or of square roots).

Where the line is over-stretched and steep, h > 1 + e/2, v reaches 1 at y = y_max, where l = 0. The unknown is then
t = y/(1 - y/y_max) in (0, inf), which keeps the distance to y_max as a relative quantity, so that 1 - v has no
cancellation however steep the line.
"""

from __future__ import annotations

from .regimes import LARGEST_ANGLE, TINY, cosh_excess, spare_height


def suspended_start(f, l, height, e):
    """Return (start, upper bound) for y: slack from sinh(y)/y, near-taut y^3 = 3 e c^2/(2 l^2), over-stretched."""
    chord = f.sqrt(l * l + height * height)
    one_minus_v = f.maximum(spare_height(height, e), TINY) / (1 + e / 2)
    slack = f.maximum(f.log(f.sqrt(one_minus_v * (2 - one_minus_v)) / l), 0.0)
    near = f.cbrt(1.5 * e * chord * chord / (l * l))
    over = f.where(chord > 1, e / 2 / f.maximum(chord - 1, TINY), 3.0)
    start = f.maximum(f.sqrt(6 * slack + slack * slack), f.minimum(f.minimum(near, over), 3.0))
    return f.minimum(start, LARGEST_ANGLE - 1), 0 * l + LARGEST_ANGLE


def suspended_residual(f, y, l, height, e):
    """Return the log of (computed l)/l, and its Newton step in log y."""
    return _suspended_step(f, *_suspended_angle(f, y, height, e), l, e)  # type: ignore[call-arg]


def _suspended_angle(f, y, height, e):
    """Return (y, sinh, cosh, v, 1 - v) at the unknown y; zeta = (e/2) coth y is the vertical stretch over v.

    1 - v is summed from two terms >= 0, with coth y - 1 = 1/(s (s + c)).
    """
    s, c = _sinh_cosh(f, y)
    zeta = e / 2 / s * c
    return y, s, c, height / (1 + zeta), (spare_height(height, e) + e / 2 / s / (s + c)) / (1 + zeta)


def _sinh_cosh(f, y):
    s = f.sinh(y)
    bounded = f.minimum(s, 1e9)  # beyond, cosh = sinh in double precision, and s * s may overflow
    return s, f.maximum(s, f.sqrt(1 + bounded * bounded))


def _suspended_step(f, y, s, c, v, one_minus_v, l, e):
    g = f.log(f.sqrt(one_minus_v * (1 + v)) * ((y + e / 2) / s) / l)
    # -dg/dlog y, both parts positive: of sqrt(1 - v^2), and of (y + e/2)/sinh y
    from_height = v * v * (e / 2 / s) * (y / s) / (one_minus_v * (1 + v) * (1 + e / 2 / s * c))
    return g, g / (from_height + (cosh_excess(f, y, s, c) + e / 2 * c) / (y + e / 2) * (y / s))


def steep_start(f, l, height, e):
    """Return (start, upper bound) for t: over-stretched as in ``suspended_start``, or nearly vertical."""
    y_max = _largest_y(f, height, e)
    s = f.sinh(y_max)
    chord = f.sqrt(l * l + height * height)
    near = f.cbrt(1.5 * e * chord * chord / (l * l))
    y = f.minimum(f.minimum(e / 2 / (chord - 1), near), 0.75 * y_max)
    width = l * s / (y_max + e / 2)
    distance = width * width * (height / e) * s * (s / y_max)  # (y_max - y)/y_max of a nearly vertical line
    return f.maximum(y / (1 - y / y_max), y_max * (1 / f.maximum(distance, TINY) - 1)), 0 * l + 1e300


def _largest_y(f, height, e):
    """Return y_max, where v = 1: (e/2) coth y_max = h - 1."""
    return f.log1p(e / -spare_height(height, e)) / 2


def _steep_angle(f, t, height, e):
    """Return (y, sinh, cosh, v, 1 - v) at the unknown t."""
    y_max = _largest_y(f, height, e)
    y = t / (1 + t / y_max)
    s, c = _sinh_cosh(f, y)
    zeta = e / 2 / s * c
    # zeta - (h - 1) = (e/2)(coth y - coth y_max)
    one_minus_v = e / 2 / s * (f.sinh(y_max / (1 + t / y_max)) / f.sinh(y_max)) / (1 + zeta)
    return y, s, c, height / (1 + zeta), one_minus_v


def steep_residual(f, t, l, height, e):
    """Return what ``suspended_residual`` does, with the unknown t."""
    y, s, c, v, one_minus_v = _steep_angle(f, t, height, e)
    g, step = _suspended_step(f, y, s, c, v, one_minus_v, l, e)
    return g, step * (t / y)


def steep_state(f, t, l, h, e):
    """Return forces and stiffness from the unknown t."""
    up = f.where(h.real < 0, -1.0, 1.0)
    return _suspended_state(f, *_steep_angle(f, t, up * h, e), l, up, e)  # type: ignore[call-arg]


def suspended_state(f, y, l, h, e):
    """Return forces and stiffness from y; the determinant of the compliance is summed from positive terms only."""
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
    excess = cosh_excess(f, y, s, c)
    C11 = 2 * excess / c * over_q + 2 * (s / c) * (v / r) * (v / r) + e * over_q
    determinant = 4 * (excess / s) + e * (C11 + X - e * over_q)
    forces = H, mean + 0.5, H, mean - 0.5, 0 * H
    return forces, (X / determinant, Y / determinant, Y / determinant, C11 / determinant)
