"""Shape and tension along a solved span: MSQS (2.1), (2.5), (2.16), (2.20)-(2.22), (2.24)."""

from __future__ import annotations

import numpy as np

from ..common.outcome import InputError
from ..common.validation import array_of_reals

STRAIGHT = 1e-9  # a piece lighter than this part of its tension is straight: the square is below rounding


def profile(state, s):
    """Return (x, z, tension) at unstretched arc length s (...), m, from the anchor; see ``CatenaryState.profile``."""
    span = state.span
    s = array_of_reals("s", s, f"{s!r} must be real numbers (m)", "m")
    if not np.all((s >= 0) & (s <= span.L)):
        raise InputError(f"values must lie in [0, {span.L:g}] m, the unstretched length", field="s", value=s, unit="m")
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):  # branches not taken
        if span.w == 0:
            return s / span.L * span.x, s / span.L * span.z, np.full_like(s, state.tension)
        if state.grounded_length == 0:
            return _hanging(span, state.H_anchor, state.V_anchor, s)
        # the piece that hangs from a raised anchor, the piece at rest, the piece up to the fairlead
        lifted = -state.V_anchor / span.w
        first = np.minimum(s, lifted)
        lying = np.clip(s - lifted, 0, state.grounded_length)
        last = np.maximum(state.V / span.w - (span.L - s), 0)
        x1, z1, T1 = _hanging(span, state.H_anchor, state.V_anchor, first)
        x2, T2 = _resting(span, state, lying)
        x3, z3, T3 = _hanging(span, state.H, 0.0, last)
    tension = np.where(s < lifted, T1, np.where(last > 0, T3, T2))
    return x1 + x2 + x3, z1 + z3, tension


def _hanging(span, H, V0, s):
    """Return (x, z, T) at s along a free line that starts with the force (H, V0), by (2.1) without cancellation:

    sqrt(H^2 + a^2) - sqrt(H^2 + b^2) = (a - b)(a + b)/(Ta + Tb), and for a, b of one sign
    asinh(a/H) - asinh(b/H) = asinh((a - b)(a + b)/(a Tb + b Ta)). Forces are taken in units of the largest.
    """
    unit = max(H, abs(V0), abs(span.w) * span.L)
    H, b, rise = H / unit, V0 / unit, span.w / unit * s
    a = b + rise
    Ta, Tb = np.sqrt(H * H + a * a), np.sqrt(H * H + b * b)
    total = np.where(Ta + Tb > 0, Ta + Tb, 1.0)
    z = s * ((a + b) / total + (b + rise / 2) * (unit / span.EA))
    if H == 0:
        return 0 * s, z, unit * Ta
    one_sign = np.arcsinh(rise * (a + b) / np.where(a * b > 0, a * Tb + b * Ta, 1.0))
    spread = np.where(a * b > 0, one_sign, np.arcsinh(a / H) - np.arcsinh(b / H))
    straight = np.abs(rise) <= STRAIGHT * np.minimum(Ta, Tb)
    dx_ds = H * np.where(straight, 2 / total, spread / np.where(straight, 1.0, rise))
    return s * (dx_ds + H * (unit / span.EA)), z, unit * Ta


def _resting(span, state, s):
    """Return (x, T) at s along the part on the seabed, from its anchor side: (2.16), (2.19)."""
    grounded = state.grounded_length
    if state.H == 0:  # slack: spread evenly over what is left of x
        return s / grounded * span.x, 0 * s
    if state.V_anchor < 0 or span.friction == 0:
        return s + state.H * s / span.EA, state.H + 0 * s
    drag = span.friction * span.w
    x0 = max(grounded - state.H / drag, 0.0)  # tension starts here, or at the anchor with H_anchor
    pulled = np.maximum(s - x0, 0)
    stretch = (state.H_anchor * pulled + drag * pulled * pulled / 2) / span.EA
    return s + stretch, np.maximum(state.H - drag * (grounded - s), 0.0)
