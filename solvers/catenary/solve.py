"""From inputs to forces: the regime of each span, its kernel, the units; one text for floats and for arrays."""

from __future__ import annotations

import math
from enum import Enum

import numpy as np

from ..common.outcome import Status
from ..numerics.elementary import ARRAY, SCALAR
from ..numerics.newton import monotone_root, monotone_roots
from . import regimes
from .regimes import LARGEST, LIGHTEST, LOWEST, MASSLESS, NARROWEST, STIFFEST


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
STATUSES = (
    Status.SUCCESS,
    Status.INVALID_INPUT,
    Status.NOT_CONVERGED,
    Status.FRICTION_UNDETERMINED,
    Status.NOT_FINITE,
)
_SUSPENDED, _STEEP, _GROUNDED, _SAGGING, _SLACK, _LYING, _VERTICAL, _MASSLESS = range(len(REGIMES))
SUCCESS, INVALID_INPUT, NOT_CONVERGED, FRICTION_UNDETERMINED, NOT_FINITE = range(len(STATUSES))


def solve(f, run, w, EA, L, x, z, seabed, CB, clearance, tolerance):
    """(H, V, H_anchor, V_anchor, grounded_length, K11, K12, K21, K22, regime, status, iterations, residual)."""
    up, l, h, e, CB, c, massless, beyond, weight = _scaled(f, w, EA, L, x, z, seabed, CB, clearance)
    columns = l, h, e, CB, c
    regime = _classify(f, *columns, seabed, massless)
    solved = run(regime, columns, tolerance)
    touching = seabed & (c > 0) & (regime <= _STEEP) & (regimes.lowest_point(f, solved[:5], e) > c)
    if f.any(touching):
        regime = f.where(touching, _SAGGING, regime)
        solved = run(regime, columns, tolerance, solved, touching)
    H, V, H_anchor, V_anchor, grounded, K11, K12, K21, K22, iterations, residual, converged = solved
    unit = f.where(regime == _MASSLESS, EA, weight)
    status = f.where(converged, SUCCESS, NOT_CONVERGED)
    status = f.where(beyond | (abs(H * unit) + abs(V * unit) == math.inf) | (K11 != K11), NOT_FINITE, status)
    status = f.where((regime == _SAGGING) & (CB > 0), FRICTION_UNDETERMINED, status)
    force = unit * f.where(status == SUCCESS, 1.0, math.nan)
    lift, stiff, turn = up * force, force / L, up * force / L
    forces = force * H, lift * V, force * H_anchor, lift * V_anchor, f.where(status == SUCCESS, L * grounded, math.nan)
    return *forces, stiff * K11, turn * K12, turn * K21, stiff * K22, regime, status, iterations, residual


def _scaled(f, w, EA, L, x, z, seabed, CB, clearance):
    """Sign of the weight, the span in units of L and w L, and whether it is massless or beyond the range of doubles."""
    up = f.where(w < 0, -1.0, 1.0)  # a buoyant line is the mirror image of a heavy one
    weight = up * w * L
    l, c, e = x / L, f.where(clearance > LOWEST * L, clearance / L, 0.0), f.maximum(weight / EA, STIFFEST)
    h = f.where(seabed, f.maximum(z / L, -c), up * z / L)
    largest = f.maximum(f.maximum(f.maximum(l, abs(h)), f.maximum(c, CB)), e)
    beyond = (largest > LARGEST) | (1e308 * L < EA) | ((w != 0) & (weight < LIGHTEST))
    massless = (w == 0) | beyond  # where beyond, only to give it a kernel that cannot fail
    return up, l, h, e, CB, c, massless, beyond, weight


def _classify(f, l, h, e, CB, c, seabed, massless):
    """Regime of each span; a line over a raised anchor is taken as suspended until its lowest point is known."""
    chord = f.sqrt(l * l + h * h)
    over = f.where(seabed, h + c, 0.0)
    slack = seabed & (1 - regimes.hanging_length(f, over, e) - regimes.hanging_length(f, c, e) >= l)
    # just touching: V = wL, so H = (1 - k^2)/2k from (2.23b) with k = h - e/2, and l from (2.23a)
    k = h - e / 2
    H = f.where(k > 0, (1 - k * k) / f.where(k > 0, 2 * k, 1.0), 1.0)
    rests = (k <= 0) | ((k < 1) & (l <= H * (f.arcsinh(1 / f.where(k < 1, H, 1.0)) + e)))
    regime = f.where(regimes.spare_height(abs(h), e) < 0, _STEEP, _SUSPENDED)
    regime = f.where((e < MASSLESS) & (chord > 1), _MASSLESS, regime)
    regime = f.where(seabed & (c == 0) & rests, f.where(h > LOWEST, _GROUNDED, _LYING), regime)
    regime = f.where(l < NARROWEST * (1 + abs(h)), _VERTICAL, regime)
    regime = f.where((e <= STIFFEST) & (chord > 1), _MASSLESS, regime)
    return f.where(massless, _MASSLESS, f.where(slack, _SLACK, regime))


def one(regime, columns, tolerance, *_):
    """Solve one span of the given regime."""
    return _KERNELS[regime](SCALAR, monotone_root, *columns, tolerance)  # type: ignore[call-arg]


def many(regime, columns, tolerance, solved=None, only=True):
    """Regime by regime: gather the rows, solve them, put the results in place."""
    if solved is None:
        solved = [np.empty(regime.size) for _ in range(9)]
        solved += [np.empty(regime.size, dtype=int), np.empty(regime.size), np.empty(regime.size, dtype=bool)]
    for code, kernel in enumerate(_KERNELS):
        rows = np.flatnonzero((regime == code) & only)
        if rows.size:
            values = kernel(ARRAY, monotone_roots, *(column[rows] for column in columns), tolerance)  # type: ignore[call-arg]
            for target, value in zip(solved, values, strict=True):
                target[rows] = value
    return solved


def _result(state, iterations=0, residual=0.0, converged=True):
    forces, stiffness = state
    return *forces, *stiffness, iterations, residual, converged


def _suspended(f, root, l, h, e, CB, c, tolerance):
    start, upper = regimes.suspended_start(f, l, abs(h), e)
    y, *count = root(regimes.suspended_residual, start, upper, (l, abs(h), e), tolerance)
    return _result(regimes.suspended_state(f, y, l, h, e), *count)


def _steep(f, root, l, h, e, CB, c, tolerance):
    start, upper = regimes.steep_start(f, l, abs(h), e)
    t, *count = root(regimes.steep_residual, start, upper, (l, abs(h), e), tolerance)
    return _result(regimes.steep_state(f, t, l, h, e), *count)


def _grounded(f, root, l, h, e, CB, c, tolerance):
    start, upper = regimes.grounded_start(f, l, h, e, CB)
    p, *count = root(regimes.grounded_residual, start, upper, (l, h, e, CB), tolerance)
    return _result(regimes.grounded_state(f, p, l, h, e, CB), *count)


def _sagging(f, root, l, h, e, CB, c, tolerance):
    high, low, none = f.maximum(h + c, c), f.minimum(h + c, c), 0 * CB
    start, upper = regimes.grounded_start(f, l, high, e, none, low)
    p, *count = root(regimes.grounded_residual, start, upper, (l, high, e, none, low), tolerance)
    return _result(regimes.grounded_state(f, p, l, high, e, none, low, h < 0), *count)


def _slack(f, root, l, h, e, CB, c, tolerance):
    return _result(regimes.slack_state(f, h, e, c))


def _lying(f, root, l, h, e, CB, c, tolerance):
    return _result(regimes.lying_state(f, l, e, CB))


def _vertical(f, root, l, h, e, CB, c, tolerance):
    return _result(regimes.vertical_state(f, h, e))


def _massless(f, root, l, h, e, CB, c, tolerance):
    return _result(regimes.massless_state(f, l, h))


_KERNELS = (_suspended, _steep, _grounded, _sagging, _slack, _lying, _vertical, _massless)
