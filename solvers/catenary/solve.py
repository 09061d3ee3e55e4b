"""From the inputs of spans to their forces: units, regime, iteration; one text for floats and for arrays."""

from __future__ import annotations

import math

import numpy as np

from ..common.outcome import Status
from ..numerics.elementary import ARRAY, SCALAR
from ..numerics.newton import monotone_root, monotone_roots
from . import regimes, suspended
from .regimes import LARGEST, LIGHTEST, LOWEST, MASSLESS, SAGGING, STIFFEST

STATUSES = Status.SUCCESS, Status.INVALID_INPUT, Status.NOT_CONVERGED, Status.FRICTION_UNDETERMINED, Status.NOT_FINITE
SUCCESS, INVALID_INPUT, NOT_CONVERGED, FRICTION_UNDETERMINED, NOT_FINITE = range(len(STATUSES))


def solve(f, dispatch, w, EA, L, x, z, seabed, CB, clearance, tolerance):
    """Return the forces, stiffness, regime, status, iterations and residual of spans, as numbers or arrays (n,).

    (H, V, H_anchor, V_anchor, grounded_length, K11, K12, K21, K22, regime, status, iterations, residual), N and m;
    regime and status are indices into REGIMES and STATUSES.
    f, dispatch : SCALAR and ``solve_one`` for floats, ARRAY and ``solve_batch`` for arrays
    """
    up, *columns, massless, beyond, weight = _nondimensional(f, w, EA, L, x, z, seabed, CB, clearance)
    _, _, e, CB, c = columns
    regime = regimes.classify(f, *columns, seabed, massless)  # type: ignore[call-arg]
    solved = dispatch(regime, columns, tolerance)
    sags = seabed & regimes.sags_to_seabed(f, regime, solved[:5], e, c)
    if f.any(sags):
        regime = f.where(sags, SAGGING, regime)
        solved = dispatch(regime, columns, tolerance, solved, sags)
    H, V, H_anchor, V_anchor, grounded, K11, K12, K21, K22, iterations, residual, converged = solved
    unit = f.where(regime == MASSLESS, EA, weight)
    status = f.where(converged, SUCCESS, NOT_CONVERGED)
    status = f.where(beyond | (abs(H * unit) + abs(V * unit) == math.inf) | (K11 != K11), NOT_FINITE, status)
    status = f.where((regime == SAGGING) & (CB > 0), FRICTION_UNDETERMINED, status)
    force = unit * f.where(status == SUCCESS, 1.0, math.nan)
    vertical, stiff, coupling = up * force, force / L, up * force / L
    grounded = f.where(status == SUCCESS, L * grounded, math.nan)
    forces = force * H, vertical * V, force * H_anchor, vertical * V_anchor, grounded
    stiffness = stiff * K11, coupling * K12, coupling * K21, stiff * K22
    return *forces, *stiffness, regime, status, iterations, residual


def _nondimensional(f, w, EA, L, x, z, seabed, CB, clearance):
    """Return (sign of the weight, l, h, e, CB, c, massless, beyond, weight), the span in units of L and w L.

    beyond : whether the span leaves the range of doubles
    """
    up = f.where(w < 0, -1.0, 1.0)  # a buoyant line is the mirror image of a heavy one
    weight = up * w * L
    l, c, e = x / L, f.where(clearance > LOWEST * L, clearance / L, 0.0), f.maximum(weight / EA, STIFFEST)
    h = f.where(seabed, f.maximum(z / L, -c), up * z / L)
    largest = f.maximum(f.maximum(f.maximum(l, abs(h)), f.maximum(c, CB)), e)
    beyond = (largest > LARGEST) | (1e308 * L < EA) | ((w != 0) & (weight < LIGHTEST))
    massless = (w == 0) | beyond  # where beyond, only to give it a kernel that cannot fail
    return up, l, h, e, CB, c, massless, beyond, weight


def solve_one(regime, columns, tolerance, *_):
    """Return the results of one span of the given regime."""
    return _KERNELS[regime](SCALAR, monotone_root, *columns, tolerance)  # type: ignore[call-arg]


def solve_batch(regime, columns, tolerance, solved=None, only=True):
    """Return arrays (n,) of results, solved regime by regime; ``only`` the rows that replace those of ``solved``."""
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


def _results(state, iterations=0, residual=0.0, converged=True):
    forces, stiffness = state
    return *forces, *stiffness, iterations, residual, converged


def _suspended(f, root, l, h, e, CB, c, tolerance):
    start, upper = suspended.suspended_start(f, l, abs(h), e)
    y, *count = root(suspended.suspended_residual, start, upper, (l, abs(h), e), tolerance)
    return _results(suspended.suspended_state(f, y, l, h, e), *count)


def _steep(f, root, l, h, e, CB, c, tolerance):
    start, upper = suspended.steep_start(f, l, abs(h), e)
    t, *count = root(suspended.steep_residual, start, upper, (l, abs(h), e), tolerance)
    return _results(suspended.steep_state(f, t, l, h, e), *count)


def _grounded(f, root, l, h, e, CB, c, tolerance):
    start, upper = regimes.grounded_start(f, l, h, e, CB)
    p, *count = root(regimes.grounded_residual, start, upper, (l, h, e, CB), tolerance)
    return _results(regimes.grounded_state(f, p, l, h, e, CB), *count)


def _sagging(f, root, l, h, e, CB, c, tolerance):
    high, low, no_friction = f.maximum(h + c, c), f.minimum(h + c, c), 0 * CB
    start, upper = regimes.grounded_start(f, l, high, e, no_friction, low)
    p, *count = root(regimes.grounded_residual, start, upper, (l, high, e, no_friction, low), tolerance)
    return _results(regimes.grounded_state(f, p, l, high, e, no_friction, low, h < 0), *count)


def _slack(f, root, l, h, e, CB, c, tolerance):
    return _results(regimes.slack_state(f, h, e, c))


def _lying(f, root, l, h, e, CB, c, tolerance):
    return _results(regimes.lying_state(f, l, e, CB))


def _vertical(f, root, l, h, e, CB, c, tolerance):
    return _results(regimes.vertical_state(f, h, e))


def _massless(f, root, l, h, e, CB, c, tolerance):
    return _results(regimes.massless_state(f, l, h))


_KERNELS = (_suspended, _steep, _grounded, _sagging, _slack, _lying, _vertical, _massless)
