"""The catenary forwards: excursion (l, h) of spans from their fairlead forces, (2.4) and (2.23), with all derivatives.

The monolithic network iterates on forces, so it needs the equations themselves and the blocks C of (4.13)-(4.16), as
corrected by the errata. Arrays (n,), m and N; H > 0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .catenary_regimes import friction_stretch, hanging_force
from .elementary import ARRAY


@dataclass(frozen=True)
class Excursion:
    """l, h : (n,), m. H_anchor, V_anchor : (n,), N.

    C : (n, 2, 2) = d(l, h)/d(H, V), m/N;  anchor : (n, 2, 2) = d(H_anchor, V_anchor)/d(H, V)
    raised : (n, 3) = d(l, h, V_anchor)/dc with the height c of the anchor above the seabed
    """

    l: np.ndarray
    h: np.ndarray
    H_anchor: np.ndarray
    V_anchor: np.ndarray
    C: np.ndarray
    anchor: np.ndarray
    raised: np.ndarray


def excursion(H, V, w, EA, L, rests, friction, clearance) -> Excursion:
    """Where a span ends when its fairlead is pulled with (H, V) N; arrays (n,), ``rests`` bool: above a seabed.

    Contact is decided by the forces: it touches when V and the hanging anchor end carry less than the weight w L.
    """
    weight, on_floor = w * L, rests & (clearance > 0)
    unit = np.where(rests, weight, 1.0)
    lift = np.where(
        on_floor, unit * hanging_force(ARRAY, H / unit, np.where(on_floor, clearance, 0.0) / L, unit / EA), 0.0
    )
    touching = rests & (V >= 0) & (V + lift < weight)
    free = _free(H, V, w, EA, L)
    if touching.any():
        free = _pick(touching, _touching(H, V, w, EA, L, friction, clearance, lift), free)
    return _pick(w == 0, _spring(H, V, EA, L), free) if (w == 0).any() else free


def _pick(rows, a, b) -> Excursion:
    return Excursion(**{name: _where(rows, getattr(a, name), getattr(b, name)) for name in Excursion.__annotations__})


def _where(rows, a, b):
    return np.where(rows.reshape(-1, *(1,) * (a.ndim - 1)), a, b)


def _free(H, V, w, EA, L) -> Excursion:
    """(2.4) and (4.15) with the differences between the ends resolved, see catenary_profile."""
    b = V - w * L
    Ta, Tb = np.sqrt(H * H + V * V), np.sqrt(H * H + b * b)
    same = V * b > 0
    spread = np.where(
        same,
        np.arcsinh(w * L * (V + b) / np.where(same, V * Tb + b * Ta, 1.0)),
        np.arcsinh(V / H) - np.arcsinh(b / H),
    )
    l = H / w * spread + H * L / EA
    h = L * (V + b) / (Ta + Tb) + L * (V - w * L / 2) / EA
    sine = (V / Ta - b / Tb) / w
    C12 = -H * L * (V + b) / (Ta * Tb * (Ta + Tb))  # H (1/Ta - 1/Tb)/w
    C = np.stack([spread / w - sine + L / EA, C12, C12, sine + L / EA], axis=-1).reshape(-1, 2, 2)
    return Excursion(l, h, H, b, C, np.broadcast_to(np.eye(2), C.shape), np.zeros((H.size, 3)))


def _spring(H, V, EA, L) -> Excursion:
    """A weightless line: straight along the force, stretched to L (1 + T/EA)."""
    T = np.sqrt(H * H + V * V)
    long, turn = L * (1 / T + 1 / EA), L / (T * T * T)
    C = np.stack([long - turn * H * H, -turn * H * V, -turn * H * V, long - turn * V * V], axis=-1).reshape(-1, 2, 2)
    return Excursion(long * H, long * V, H, V, C, np.broadcast_to(np.eye(2), C.shape), np.zeros((H.size, 3)))


def _touching(H, V, w, EA, L, friction, clearance, lift) -> Excursion:
    """(2.23) and (4.16) corrected; ``lift`` is the downward force of a raised anchor end, 0 on the seabed."""
    grounded = L - (V + lift) / w
    X, Y, X_H, Y_H, Y_V = _hanging(H, V, w, EA)
    Xa, _, Xa_H, Ya_H, Ya_V = _hanging(H, lift, w, EA)
    stretch, S_H, lost = friction_stretch(ARRAY, H, grounded, friction * w)
    softness = np.where(lift > 0, 1 / np.where(lift > 0, Ya_V, 1.0), 0.0)  # d(lift)/dc; d(lift)/dH = -Ya_H softness
    C11 = X_H + Xa_H + S_H / EA - Ya_H * Ya_H * softness
    C = np.stack([C11, Y_H + lost / (w * EA), Y_H, Y_V], axis=-1).reshape(-1, 2, 2)
    H_anchor = np.maximum(H - friction * w * grounded, 0.0)
    pulled, zero = H_anchor > 0, 0 * H
    anchor = np.stack([pulled * 1.0, pulled * friction, Ya_H * softness, zero], axis=-1).reshape(-1, 2, 2)
    raised = np.stack([Ya_H * softness, zero - 1, -softness], axis=-1)
    return Excursion(grounded + X + Xa + stretch / EA, Y - clearance, H_anchor, zero - lift, C, anchor, raised)


def _hanging(H, V, w, EA):
    """Reach X and height Y above its level point of an end pulled with (H, V): X, Y, dX/dH, dY/dH, dY/dV."""
    T = np.sqrt(H * H + V * V)
    X, Y = H / w * np.arcsinh(V / H) + H * V / (w * EA), V / w * (V / (T + H)) + V * V / (2 * w * EA)
    return X, Y, (np.arcsinh(V / H) - V / T) / w + V / (w * EA), -V / T * (V / (T + H)) / w, V / (w * T) + V / (w * EA)
