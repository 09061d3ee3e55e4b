"""Newton's method. First where it cannot fail: the root t > 0 of a strictly decreasing function, one or many at a time.

The residual returns its value g(t) and the Newton step in log t. A step is taken in t when it grows and in 1/t when it
shrinks (both agree with log t to first order, keep t > 0 and cost no exponential); a step that leaves the bracket found
so far is replaced by its geometric mean. The sign of g alone shrinks the bracket, so every start converges.
Then for systems: ``damped_newton``.
"""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from .elementary import ARRAY, SCALAR

MIN_RELAXATION = 1e-6  # shorter steps have never led anywhere: the start is too far, continue in a parameter
_RELAX_UP, _RELAX_DOWN = 1.02, 1.1
_KEEP = 0.2  # contraction at which a step with an old Jacobian is worth more than a new Jacobian
MAX_ITERATIONS = 200  # a bisection of the whole positive double range in log t needs 2 + log2(1420 / eps) = 65


def _advance(t, lo, hi, g, step, tolerance, f):
    """One safeguarded step: next t, the bracket, and whether t is already the root."""
    lo = f.where(g > 0, t, lo)
    hi = f.where(g < 0, t, hi)
    new = f.where(step > 0, t * (1 + step), t / (1 + abs(step)))
    new = f.where((new > lo) & (new < hi), new, f.sqrt(lo) * f.sqrt(hi))
    finished = (abs(g) <= tolerance) | (abs(step) <= tolerance) | (new == t)
    return f.where(finished, t, new), lo, hi, finished


def monotone_root(residual, start, upper, parameters, tolerance):
    """Root of one strictly decreasing function on (0, upper).

    residual(f, t, *parameters) -> (g, Newton step in log t), f the elementary functions. Floats in, floats out.
    Returns (t, iterations, abs(g), converged).
    """
    t, lo, hi = start, 0.0, upper
    for iteration in range(1, MAX_ITERATIONS + 1):  # noqa: B007 (returned)
        g, step = residual(SCALAR, t, *parameters)
        t, lo, hi, finished = _advance(t, lo, hi, g, step, tolerance, SCALAR)
        if finished:
            break
    return t, iteration, abs(g), finished


def monotone_roots(residual, start, upper, parameters, tolerance):
    """The same for arrays of shape (n,), row by row bit for bit as ``monotone_root``; finished rows leave the work."""
    root, iterations = start.copy(), np.ones(start.size, dtype=np.int64)
    value, converged = np.full(start.size, np.inf), np.zeros(start.size, dtype=bool)
    rows, t, lo, hi = np.arange(start.size), start, np.zeros(start.size), upper
    for iteration in range(1, MAX_ITERATIONS + 1):
        g, step = residual(ARRAY, t, *parameters)
        t, lo, hi, finished = _advance(t, lo, hi, g, step, tolerance, ARRAY)
        left = np.flatnonzero(~finished)
        iterations[rows[left]] += iteration < MAX_ITERATIONS
        if left.size <= 0.75 * rows.size or iteration == MAX_ITERATIONS:
            root[rows], value[rows], converged[rows] = t, abs(g), finished
            rows, t, lo, hi = rows[left], t[left], lo[left], hi[left]
            parameters = tuple(p[left] for p in parameters)
        if left.size == 0:
            break
    return root, iterations, value, converged


def adapted_relaxation(relaxation, error, last) -> float:
    """The relaxation factor of the next step: a little longer while the error falls, shorter when it grows.

    Gobat, HB reference [16]; its program's default factors.
    """
    return min(1.0, _RELAX_UP * relaxation) if error < last else relaxation / _RELAX_DOWN


class Step(NamedTuple):
    """One Newton step: its size by the caller's norm, and the share of it that was taken."""

    error: float
    relaxation: float


def relaxed_newton(linearise, residual, x, tolerance, norm, limit=50):
    """Newton's method with the relaxation factor of HB (75) as ``adapted_relaxation`` sets it; as ``damped_newton``."""
    steps, relaxation, last = [], 1.0, np.inf  # type: ignore[var-annotated]
    for _ in range(limit):
        F, solve = linearise(x)
        if solve is None or not np.isfinite(F).all():
            return x, steps, False
        full = solve(F)
        error = norm(full)
        if not np.isfinite(error):
            return x, steps, False
        relaxation = adapted_relaxation(relaxation, error, last)
        steps.append(Step(error, relaxation))
        x, last = x - relaxation * full, error
        if error <= tolerance:
            return x, steps, True
    return x, steps, False


def damped_newton(linearise, residual, x, tolerance, norm, limit=50):
    """Newton's method with the error-oriented damping of Deuflhard (Newton Methods for Nonlinear Problems, NLEQ-ERR).

    linearise(x) -> (F, solve) with solve(F) = J^-1 F, or None where J is singular; residual(x) -> F;
    norm(step) -> float: the damping asks that the simplified Newton step gets shorter, so it does not see the scaling
    of F. A Jacobian is kept, with Broyden's updates, while the steps with it shrink by _KEEP. Returns
    (x, steps, converged): converged when norm(step) <= tolerance.
    """
    steps, relaxation, last = [], 1.0, None  # type: ignore[var-annotated]
    while len(steps) < limit:
        solve = None  # the old factors go before the new ones come
        F, solve = linearise(x)
        if solve is None or not np.isfinite(F).all():
            return x, steps, False
        full = -solve(F)
        error = norm(full)
        if not np.isfinite(error):
            return x, steps, False
        if last is not None:
            before, simplified, taken = last
            change = norm(simplified - full)
            relaxation = min(1.0, taken * norm(before) * norm(simplified) / (change * error)) if change > 0 else 1.0
        while error > tolerance:
            trial = x + relaxation * full
            F = residual(trial)
            simplified = -solve(F) if np.isfinite(F).all() else np.full_like(full, np.inf)
            size = norm(simplified)
            if size <= (1 - relaxation / 4) * error:
                break
            bound = norm(simplified - (1 - relaxation) * full) if np.isfinite(size) else np.inf
            relaxation = min(relaxation / 2, 0.5 * error * relaxation**2 / bound)
            if relaxation < MIN_RELAXATION:
                return x, steps, False
        else:
            steps.append(Step(error, 1.0))
            return x + full, steps, True
        steps.append(Step(error, relaxation))
        x, last, taken = trial, (full, simplified, relaxation), [full]  # type: ignore[assignment]
        while relaxation == 1.0 and size <= max(_KEEP * error, tolerance) and len(steps) < limit:
            taken.append(_updated(simplified, taken))  # type: ignore[attr-defined]
            x, error = x + taken[-1], norm(taken[-1])  # type: ignore[index]
            steps.append(Step(error, 1.0))
            if error <= tolerance:
                return x, steps, True
            simplified = -solve(residual(x))
            size, last = norm(simplified), None
    return x, steps, False


def _updated(simplified, taken):
    """The step of Broyden's update of an old Jacobian from its own step and those taken with it before."""
    share = lambda step: np.vdot(step, simplified) / np.vdot(step, step)
    for step, after in pairwise(taken):
        simplified = simplified + share(step) * after
    return simplified / (1 - share(taken[-1]))
