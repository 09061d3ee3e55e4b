"""Excursion (l, h) of spans from given fairlead forces, (2.4) and (2.23), with all derivatives.

The monolithic network iterates on forces, so it needs the equations themselves and the blocks C of (4.13)-(4.16), as
corrected by the errata. Which of them hold is decided in ``regimes``. Arrays (n,), m and N; H > 0, or H = 0 of a line
that hangs vertically.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..numerics.elementary import ARRAY
from .regimes import friction_stretch, hanging_force_in_newtons, touches_seabed


@dataclass(slots=True)
class Excursion:
    """l, h : (n,), m. H_anchor, V_anchor : (n,), N.

    C : (n, 2, 2) = d(l, h)/d(H, V), m/N;  anchor : (n, 2, 2) = d(H_anchor, V_anchor)/d(H, V)
    by_clearance : (n, 3) = d(l, h, V_anchor)/dc with the height c of the anchor above the seabed
    """

    l: np.ndarray
    h: np.ndarray
    H_anchor: np.ndarray
    V_anchor: np.ndarray
    C: np.ndarray
    anchor: np.ndarray
    by_clearance: np.ndarray

    def replace_rows(self, rows, other: Excursion):
        """Replace the results of some rows by those of another excursion."""
        for name in self.__slots__:
            getattr(self, name)[rows] = getattr(other, name)


def excursion(H, V, w, EA, L, can_rest, friction, clearance) -> Excursion:
    """Return where spans end whose fairleads are pulled with (H, V), N; arrays (n,), can_rest : bool, above a seabed.

    Contact is decided by the forces, ``touches_seabed``.
    """
    weight = w * L
    low = can_rest & touches_seabed(V, V, weight)
    smooth, rough = None, ()
    if np.count_nonzero(low):
        special = low & ((friction > 0) | (clearance > 0))
        smooth, rough = low & ~special, np.flatnonzero(special)  # type: ignore[assignment]
    result = _free(H, V, w, EA, L, weight, smooth)
    if len(rough):
        line = [a[rough] for a in (H, V, w, EA, L, friction, clearance)]
        height = np.maximum(clearance[rough], 0.0)
        lift = hanging_force_in_newtons(ARRAY, line[0], height, *line[2:5])  # of the anchor end, 0 on the seabed
        touching = np.flatnonzero(touches_seabed(line[1], line[1] + lift, weight[rough]))
        result.replace_rows(rough[touching], _touching(*(a[touching] for a in (*line, lift))))
    for zero_where, formula, line in ((H, _vertical, (V, w, EA, L)), (w, _spring, (H, V, EA, L))):  # type: ignore[assignment]
        if np.count_nonzero(zero_where) < zero_where.size:
            rows = np.flatnonzero(zero_where == 0)
            result.replace_rows(rows, formula(*(a[rows] for a in line)))
    return result


def _free(H, V, w, EA, L, weight, smooth) -> Excursion:
    """Return ``suspended`` as an Excursion; smooth : (n,) bool or None."""
    l, h, b, C11, C12, C22 = suspended(ARRAY, H, V, w, EA, L, weight, False if smooth is None else smooth)
    anchor, by_clearance = _anchor_derivatives(H)
    if smooth is not None:
        anchor[smooth, 1, 1], by_clearance[smooth, 1] = 0.0, -1.0
    return Excursion(l, h, H.copy(), b, _block(C11, C12, C12, C22), anchor, by_clearance)


def suspended(f, H, V, w, EA, L, weight, smooth):
    """Return l, h, V_anchor and C11, C12 = C21, C22 of d(l, h)/d(H, V) by (2.4) and (4.15); f as in ``elementary``.

    The differences between the ends are resolved as in ``profile``. smooth : lines that lie on the seabed from the
    anchor on, without friction: (2.23) and (4.16) are the same with b = 0, the part V/w that hangs, and a lying rest.
    """
    b, hanging, lying = V - weight, L, 0.0
    if f.any(smooth):
        b, hanging = f.where(smooth, 0.0, b), f.where(smooth, V / w, L)
        lying = L - hanging
    HH, both = H * H, V + b
    Ta, Tb = f.sqrt(HH + V * V), f.sqrt(HH + b * b)
    same = V * b > 0
    spread = f.arcsinh(weight * both / f.where(same, V * Tb + b * Ta, 1.0))
    if f.any(V * b <= 0):
        spread = f.where(same, spread, f.arcsinh(V / H) - f.arcsinh(b / H))
    height, stretch = hanging * both / (Ta + Tb), hanging / EA  # height before stretch
    sine = (V / Ta - b / Tb) / w
    C12 = -H * height / (Ta * Tb)  # H (1/Ta - 1/Tb)/w
    spread = spread / w + L / EA
    return H * spread + lying, height + stretch * (both / 2), b, spread - sine, C12, sine + stretch


def _anchor_derivatives(H):
    """Return anchor and by_clearance of lines that touch nothing: anchor force and (H, V) differ by the weight."""
    anchor = np.zeros((H.size, 2, 2), H.dtype)
    anchor[:, 0, 0] = anchor[:, 1, 1] = 1.0
    return anchor, np.zeros((H.size, 3), H.dtype)


def _vertical(V, w, EA, L) -> Excursion:
    """Return the limit H = 0: taut all along, or folded over below the ends, where C11 is infinite."""
    b, zero = V - w * L, np.zeros_like(V)
    up, down = np.abs(V), np.abs(b)
    taut, stretch = V * b > 0, L / EA
    C11 = np.where(taut, np.abs(np.log(up / down) / w) + stretch, np.inf)
    C = _block(C11, zero, zero, np.where(taut, 0.0, 2 / np.abs(w)) + stretch)
    h = L * (V + b) / (up + down) + stretch * (V + b) / 2
    return Excursion(zero, h, zero, b, C, *_anchor_derivatives(V))


def _spring(H, V, EA, L) -> Excursion:
    """Return the excursion of weightless lines: straight along the force, stretched to L (1 + T/EA)."""
    T = np.sqrt(H * H + V * V)
    per_force, turn = L * (1 / T + 1 / EA), L / (T * T * T)
    C = _block(per_force - turn * H * H, -turn * H * V, -turn * H * V, per_force - turn * V * V)
    return Excursion(per_force * H, per_force * V, H, V, C, *_anchor_derivatives(H))


def spring_stiffness(H, V, EA, L):
    """Return d(H, V)/d(l, h) of weightless lines, (n, 2, 2): C^-1, whose determinant loses all digits where T << EA."""
    T = np.sqrt(H * H + V * V)
    c, s, along, across = H / T, V / T, EA / L, 1 / (L * (1 / T + 1 / EA))
    coupling = (along - across) * c * s
    return _block(along * c * c + across * s * s, coupling, coupling, along * s * s + across * c * c)


def _touching(H, V, w, EA, L, friction, clearance, lift) -> Excursion:
    """Return (2.23) and (4.16) corrected; lift : force that carries a raised anchor end, 0 on the seabed."""
    grounded, zero = L - (V + lift) / w, np.zeros_like(H)
    X, Y, X_H, Y_H, Y_V = _hanging(H, V, w, EA)
    stretch, S_H, lost = friction_stretch(ARRAY, H, grounded, friction * w)
    H_anchor = np.maximum(H - friction * w * grounded, 0.0)
    pulled = (H_anchor > 0) + zero
    Xa, _, Xa_H, Ya_H, Ya_V = _hanging(H, lift, w, EA)
    lift_c = np.where(lift > 0, 1 / np.where(lift > 0, Ya_V, 1.0), 0.0)  # d(lift)/dc
    lift_H = Ya_H * lift_c  # -d(lift)/dH
    l, C11 = grounded + X + stretch / EA + Xa, X_H + S_H / EA + Xa_H - Ya_H * lift_H
    C = _block(C11, Y_H + lost / (w * EA), Y_H, Y_V)
    anchor = _block(pulled, pulled * friction, lift_H, zero)
    by_clearance = np.array([lift_H, zero - 1, -lift_c]).T
    return Excursion(l, Y - clearance, H_anchor, zero - lift, C, anchor, by_clearance)


def _hanging(H, V, w, EA):
    """Return X, Y, dX/dH, dY/dH, dY/dV: reach and height over its level point of an end pulled with (H, V)."""
    T, e, angle = np.sqrt(H * H + V * V), w * EA, np.arcsinh(V / H)
    sine, half_tangent, stretch = V / T, V / (T + H), V / e
    X, Y = H * (angle / w + stretch), V * (half_tangent / w + stretch / 2)
    return X, Y, (angle - sine) / w + stretch, -sine * half_tangent / w, sine / w + stretch


def _block(a, b, c, d):
    """Return 2 x 2 blocks (n, 2, 2) of four arrays (n,)."""
    return np.array([a, b, c, d]).T.reshape(-1, 2, 2)
