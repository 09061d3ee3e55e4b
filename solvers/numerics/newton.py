"""Newton's method: safeguarded for the root of one decreasing function, damped for systems of equations.

One function: the residual returns its value g(t), t > 0, and the Newton step in log t. A step is taken in t when it
grows and in 1/t when it shrinks (both agree with log t to first order, keep t > 0 and cost no exponential); a step that
leaves the bracket is replaced by the geometric mean of its ends. The sign of g alone shrinks the bracket, so every
start converges.

Systems: ``iterate`` repeats the steps of any method; ``damped_newton`` and ``relaxed_newton`` are methods for one array
of unknowns, and those of networks are beside their equations.
"""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from .elementary import ARRAY, SCALAR

MIN_RELAXATION = 1e-6  # a start that needs shorter steps is too far from the solution: continue in a parameter
MIN_STEP = 1e-8  # part of a Newton step below which halving ends
SUFFICIENT_DECREASE = 1e-4  # of the residual norm, in Armijo's condition
_RELAX_UP, _RELAX_DOWN = 1.02, 1.1
_KEEP = 0.2  # contraction up to which another step with the old Jacobian is cheaper than a new Jacobian
_KEEP_FULL = 0.1  # the same where steps are not damped
_KEEP_FIRST = 0.05  # the same of the Jacobian at the start, which is far from that at the solution
MAX_ITERATIONS = 200  # a bisection of the whole positive double range in log t needs 2 + log2(1420 / eps) = 65


def _advance(t, lo, hi, g, step, tolerance, f):
    """Return the next t of a safeguarded step, the bracket (lo, hi), and whether t is already the root."""
    lo = f.where(g > 0, t, lo)
    hi = f.where(g < 0, t, hi)
    new = f.where(step > 0, t * (1 + step), t / (1 + abs(step)))
    new = f.where((new > lo) & (new < hi), new, f.sqrt(lo) * f.sqrt(hi))
    finished = (abs(g) <= tolerance) | (abs(step) <= tolerance) | (new == t)
    return f.where(finished, t, new), lo, hi, finished


def monotone_root(residual, start, upper, parameters, tolerance):
    """Return (t, iterations, abs(g), converged) of the root of one strictly decreasing function on (0, upper).

    residual(f, t, *parameters) -> (g, Newton step in log t), f the elementary functions; all numbers are floats.
    """
    t, lo, hi = start, 0.0, upper
    # Not by ``iterate``: its calls would cost as much as a step on floats, and the bracket narrows at the last one, too
    for iteration in range(1, MAX_ITERATIONS + 1):  # noqa: B007 (returned)
        g, step = residual(SCALAR, t, *parameters)
        t, lo, hi, finished = _advance(t, lo, hi, g, step, tolerance, SCALAR)
        if finished:
            break
    return t, iteration, abs(g), finished


def monotone_roots(residual, start, upper, parameters, tolerance):
    """Return arrays (n,) of the results of ``monotone_root``, each row bit for bit as that function gives it.

    Rows that have converged are taken out of the arrays that are iterated on.
    """
    root, iterations = start.copy(), np.ones(start.size, dtype=np.int64)
    value, converged = np.full(start.size, np.inf), np.zeros(start.size, dtype=bool)
    rows, t, lo, hi = np.arange(start.size), start, np.zeros(start.size), upper
    for iteration in range(1, MAX_ITERATIONS + 1):
        g, step = residual(ARRAY, t, *parameters)
        t, lo, hi, finished = _advance(t, lo, hi, g, step, tolerance, ARRAY)
        unfinished = np.flatnonzero(~finished)
        iterations[rows[unfinished]] += iteration < MAX_ITERATIONS
        if unfinished.size <= 0.75 * rows.size or iteration == MAX_ITERATIONS:
            root[rows], value[rows], converged[rows] = t, abs(g), finished
            rows, t, lo, hi = rows[unfinished], t[unfinished], lo[unfinished], hi[unfinished]
            parameters = tuple(p[unfinished] for p in parameters)
        if unfinished.size == 0:
            break
    return root, iterations, value, converged


def iterate(step, is_solved, x, limit):
    """Return the last iterate from ``x`` on, and whether it is solved.

    step(x) -> the next iterate, or None where no finite and acceptable one exists; is_solved(x) -> bool.
    limit : most steps
    """
    for _ in range(limit):
        if is_solved(x):
            return x, True
        new = step(x)
        if new is None:
            return x, False
        x = new
    return x, is_solved(x)


def is_contraction(simplified, full, length) -> bool:
    """Return whether the natural monotonicity test holds after a part ``length`` of a Newton step.

    Deuflhard, Newton Methods for Nonlinear Problems: the simplified Newton step, with the Jacobian of the step before,
    must get shorter. simplified, full : norms of both steps
    """
    return simplified <= (1 - length / 4) * full


def halve_step(trial, norm, contracts, is_solved):
    """Return the first acceptable iterate along a Newton step that is halved from 1 on, None where there is none.

    trial(length) -> iterate with a residual ``norm``, or None to give up; ``norm`` is that before the step;
    contracts(iterate, length) -> bool: the natural monotonicity test. The residual norm alone would creep where a stiff
    line swings: a full step across lengthens it, which the next step mends.
    """
    length = 1.0
    while length > MIN_STEP:
        new = trial(length)
        if new is None:
            return None
        if new.norm <= (1 - SUFFICIENT_DECREASE * length) * norm or contracts(new, length) or is_solved(new):
            return new
        length /= 2
    return None


def adapted_relaxation(relaxation, error, last) -> float:
    """Return the relaxation factor of the next step: a little larger while the error falls, smaller when it grows.

    Gobat, HB reference [16]; its program's default factors.
    """
    return min(1.0, _RELAX_UP * relaxation) if error < last else relaxation / _RELAX_DOWN


class Step(NamedTuple):
    """One Newton step: its size by the caller's norm, and the part of it that was taken."""

    error: float
    relaxation: float


def _newton_step(linearise, x, norm):
    """Return (solve, full step, its norm) at x, or None where the Jacobian is singular or anything is not finite."""
    F, solve = linearise(x)
    if solve is None or not np.isfinite(F).all():
        return None
    full = -solve(F)
    error = norm(full)
    return (solve, full, error) if np.isfinite(error) else None


def _repeat(step, steps, x, tolerance, limit):
    """Return (x, steps, converged) of a method that lists its steps, until the last is no larger than the tolerance."""
    x, converged = iterate(step, lambda _: bool(steps) and steps[-1].error <= tolerance, x, limit)
    return x, steps, converged


def relaxed_newton(linearise, residual, x, tolerance, norm, limit=50):
    """Return (x, steps, converged) of Newton's method with the relaxation factor of HB (75), ``adapted_relaxation``.

    Arguments as of ``damped_newton``; ``residual`` is not used.
    """
    steps = []  # type: ignore[var-annotated]

    def step(x):
        newton = _newton_step(linearise, x, norm)
        if newton is None:
            return None
        last = steps[-1] if steps else Step(np.inf, 1.0)
        steps.append(Step(newton[2], adapted_relaxation(last.relaxation, newton[2], last.error)))
        return x + steps[-1].relaxation * newton[1]

    return _repeat(step, steps, x, tolerance, limit)


def full_newton(linearise, residual, x, tolerance, norm, limit=12):
    """Return (x, steps, converged) of Newton's method in full steps, a Jacobian kept while it contracts by _KEEP_FULL.

    Arguments as of ``damped_newton``; for problems in whose form full steps are known to converge. The Jacobian at the
    start is tried for the second step.
    """
    steps, kept = [], []  # type: ignore[var-annotated]

    def step(x):
        newton = _newton_step((lambda x: (residual(x), kept[0])) if kept else linearise, x, norm)
        if len(steps) == 1 and not (newton and newton[2] <= _KEEP_FIRST * steps[0].error):
            newton = _newton_step(linearise, x, norm)
        if newton is None:
            return None
        last = steps[-1].error if steps else np.inf
        steps.append(Step(newton[2], 1.0))
        kept[:] = [newton[0]] if newton[2] <= _KEEP_FULL * last else []
        return x + newton[1]

    return _repeat(step, steps, x, tolerance, limit)


def damped_newton(linearise, residual, x, tolerance, norm, limit=50):
    """Return (x, steps, converged) of Newton's method with Deuflhard's error-oriented damping, NLEQ-ERR.

    linearise(x) -> (F, solve) with solve(F) = J^-1 F, or None where J is singular; residual(x) -> F;
    norm(step) -> float: the natural monotonicity test compares steps, so it does not depend on the scaling of F.
    Converged when norm(step) <= tolerance. P. Deuflhard, Newton Methods for Nonlinear Problems.
    """
    method = _ErrorOriented(linearise, residual, tolerance, norm)
    return _repeat(method.step, method.steps, x, tolerance, limit)


def full_then_damped_newton(linearise, residual, x, tolerance, norm, full=full_newton):
    """Return (x, steps, converged) of full steps, or where they do not converge of damped ones from the same x.

    Arguments as of ``damped_newton``, and the method that is tried before it; the steps of both count.
    """
    result, steps, converged = full(linearise, residual, x, tolerance, norm)
    if not converged:
        result, damped, converged = damped_newton(linearise, residual, x, tolerance, norm)
        steps = steps + damped
    return result, steps, converged


class _ErrorOriented:
    """The steps of ``damped_newton``. A Jacobian is kept, with Broyden's updates, while its steps shrink by _KEEP."""

    def __init__(self, linearise, residual, tolerance, norm):
        self.linearise, self.residual, self.tolerance, self.norm = linearise, residual, tolerance, norm
        self.steps, self.solve, self.relaxation, self.keep = [], None, 1.0, False
        self.damped = None  # (full, simplified, relaxation) of the last step, unless that was with an old Jacobian

    def step(self, x):
        """Return the next x, or None where the damping falls below MIN_RELAXATION or anything is not finite."""
        return self._broyden_step(x) if self.keep else self._damped_step(x)

    def _damped_step(self, x):
        self.solve = None  # frees the old factors before the new ones are made
        newton = _newton_step(self.linearise, x, self.norm)
        if newton is None:
            return None
        self.solve, full, error = newton
        relaxation = self._predicted_relaxation(full, error)
        if error <= self.tolerance:
            self.steps.append(Step(error, 1.0))
            return x + full
        # Not by ``iterate``: trials of one step are not iterates, each starts from the same x with another length
        while True:
            trial = x + relaxation * full
            F = self.residual(trial)
            simplified = -self.solve(F) if np.isfinite(F).all() else np.full_like(full, np.inf)
            size = self.norm(simplified)
            if is_contraction(size, error, relaxation):
                break
            bound = self.norm(simplified - (1 - relaxation) * full) if np.isfinite(size) else np.inf
            relaxation = min(relaxation / 2, 0.5 * error * relaxation**2 / bound)
            if relaxation < MIN_RELAXATION:
                return None
        self.steps.append(Step(error, relaxation))
        self.relaxation, self.damped, self.taken = relaxation, (full, simplified, relaxation), [full]
        self._keep_if_fast(simplified, size, error)
        return trial

    def _predicted_relaxation(self, full, error):
        """Return the damping factor that the last damped step foretells for this one."""
        if self.damped is None:
            return self.relaxation
        before, simplified, taken = self.damped
        change = self.norm(simplified - full)
        return min(1.0, taken * self.norm(before) * self.norm(simplified) / (change * error)) if change > 0 else 1.0

    def _broyden_step(self, x):
        self.taken.append(_updated(self.simplified, self.taken))
        x, error = x + self.taken[-1], self.norm(self.taken[-1])
        self.steps.append(Step(error, 1.0))
        if not error <= self.tolerance:
            simplified, self.damped = -self.solve(self.residual(x)), None  # type: ignore[misc]
            self._keep_if_fast(simplified, self.norm(simplified), error)
        return x

    def _keep_if_fast(self, simplified, size, error):
        self.simplified = simplified
        self.keep = self.relaxation == 1.0 and size <= max(_KEEP * error, self.tolerance)


def _updated(simplified, taken):
    """Return the step of Broyden's update of an old Jacobian, from its own step and those taken with it before."""
    projection = lambda step: np.vdot(step, simplified) / np.vdot(step, step)
    for step, after in pairwise(taken):
        simplified = simplified + projection(step) * after
    return simplified / (1 - projection(taken[-1]))
