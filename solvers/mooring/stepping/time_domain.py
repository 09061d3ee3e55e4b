"""Time integration of a moving line: generalized-alpha for r, v, a (Chung and Hulbert, J. Appl. Mech. 60 (1993) 371).

The loop over the steps is compiled (``steps.integrate``); here are the steps that it is given, those that fail or
are too long, which are taken again in 2, 4, 8, ... parts, and the history.
"""

from __future__ import annotations

import numpy as np

from ...common.outcome import Status
from ...common.properties import MAX_STRAIN
from ..equations import residual, tangents
from ..lines.prescribed_motion import displace_points
from ..statics import solve_rest
from .history import MooringHistory
from .steps import integrate, newmark_parameters

MOST_HALVINGS = 10  # of one step
STEPS_AT_ONCE = 256  # between two calls of ``progress``
RHO_INF = 0.5  # spectral radius at infinite frequency while all cells are taut
POSITION_SCALE = 0.01  # of the length: a position may err by so much less than a tension, each over its scale
ROUNDINGS = 4  # of a position as far away as the line is long, below which no Newton step is asked to fall
LEAST_CHANGE = 1e-3  # of the greatest tension at rest: smaller changes are not resolved any further
_LEAST_DISPLACEMENT = 1e-6  # of the length, which the error of a step refers to while less has moved
LENGTHEN_BELOW = 0.1  # of the step tolerance, below which the next step is in half as many parts


def integrate_line(
    system, *, dt, count, rho_inf, tolerance, step_tolerance, ramp, start, every, progress=None, path=None
) -> MooringHistory:
    """Return the MooringHistory of ``count`` steps of dt in s from rest, or from ``start`` = (y, ydot).

    Settings as ``solve_time_domain`` has validated them. rho_inf: None for 0.5, and 0 from the first time that a cell
    is slack (``history.damped_from``): a snap excites the shortest axial waves, which feed on the step where nothing
    damps them. tolerance: what the last Newton step of a time step may change in a tension or, relative to the length,
    a position, of the largest change of a tension from rest so far; up to five times that where no cell is slack and
    the contraction says that the next one would change less than a tenth of it. path (count + 1, 3, P, n): of the
    prescribed nodes at the ends of the steps, where it is known. step_tolerance: error of a step in a position, over
    the largest displacement so far; a step of dt is then taken in as many parts as that needs.
    """
    settings = {"dt": dt, "count": count, "rho_inf": rho_inf, "tolerance": tolerance, "step_tolerance": step_tolerance}
    settings |= {"ramp": ramp, "start": start, "every": every}
    moved = system.ramped(ramp) if ramp else system
    run = _Run(moved, rho_inf, tolerance, step_tolerance, _initial_state(moved, start, moves_at_once=not ramp))
    record = tuple(np.empty((count // every + 1 + (count % every > 0), *run.state[0].shape)) for _ in range(3))
    for part, begin in zip(record, run.state, strict=False):
        part[0] = begin
    path = moved.path(dt * np.arange(count + 1)) if path is None else path
    chunk, event = count if progress is None else every * max(1, STEPS_AT_ONCE // every), None
    for first in range(0, count, chunk):
        last = min(first + chunk, count)
        kept = [part[1 + first // every :] for part in record]
        done = first + run.advance(dt * np.arange(first, last + 1), kept, every, path[first : last + 1])
        if progress is not None:
            progress(dt * done)
        if done < last:
            event = dt * done, run.worst
            break
    time = dt * every * np.arange(done // every + 1)
    if done % every:
        time = np.append(time, dt * done)
        for part, now in zip(record, run.state, strict=False):
            part[time.size - 1] = now
    y, ydot, yddot = (part[: time.size].transpose(2, 1, 0) for part in record)
    status = Status.SUCCESS if event is None else Status.STEP_FAILED
    if event is None and (torn := _first_torn(run, time, y)) is not None:
        status, event = torn
    counts = run.iterations, run.factorisations, run.error, done, run.cut, run.damped_from
    return MooringHistory(system, moved, time, y, ydot, yddot, status, *counts, ramp, event, settings)


def _first_torn(run, time, y):
    """Return the status and (time in s, node) of the first of the states y (n, N, K) that is invalid, or None."""
    system, greatest = run.system, run.rest.max() + run.scale[0] * run.scale[2]
    if greatest <= MAX_STRAIN * system.line.EA.min() or system.invalid(y) is None:
        return None
    each = ((t, system.invalid(y[..., k])) for k, t in enumerate(time.tolist()))
    return next((invalid[0], (t, invalid[1])) for t, invalid in each if invalid is not None)


class _Run:
    """The state of an integration and the counts of its work."""

    def __init__(self, system, rho_inf, tolerance, step_tolerance, state):
        self.system, self.tolerance, self.step_tolerance = system, tolerance, step_tolerance
        self.scheme, self.stops_at_slack = newmark_parameters(RHO_INF if rho_inf is None else rho_inf), rho_inf is None
        self.damped_from = None
        self.state = state
        self.rest = system.rest.tension
        self.auxiliary = self.rest.copy()
        greatest, length = float(self.rest.max()) or 1.0, system.length
        stiffest = float((system.line.EA / system.line.length).max())
        rounding = ROUNDINGS * np.finfo(float).eps * (1 + stiffest * length / greatest)  # of a position, in a tension
        self.scale = np.array([greatest, POSITION_SCALE * length, LEAST_CHANGE, rounding])
        self.iterations = self.factorisations = self.cut = self.worst = self.halvings = 0
        self.error = self.largest_displacement = 0.0

    def advance(self, t, record, every, path) -> int:
        """Take the steps between the times t; return how many succeeded. path: of the prescribed nodes."""
        done, steps, h = 0, t.size - 1, t[1] - t[0]
        while done < steps:
            if self.step_tolerance is None:
                until_stored = -done % every  # steps to the next one that is kept
                end = min(done + until_stored, steps) if until_stored else steps
                kept = tuple(part[done // every :] for part in record)
                times, store_each, stop = t[done : end + 1], until_stored or every, self.stops_at_slack
                taken = self._integrate(path[done : end + 1], times, h, kept, store_each, stop)
                done += taken
                if done == end or self._damp_after_slack(taken, t[done]):
                    continue
                self.cut += 1
            if not self._subdivide_step(t[done], h):
                break
            done += 1
            if done % every == 0:
                for part, now in zip(record, self.state, strict=False):
                    part[done // every - 1] = now
        return done

    def _integrate(self, path, t, h, record, every, stop) -> int:
        source = self.system.source_at(t[1:])
        system, tolerance = self.system, self.tolerance
        taken, iterations, factorisations, self.error = integrate(
            system.line, system.order, system.prescribed_nodes, path, source, h, self.scheme, self.scale, tolerance,
            self.rest, self.state, self.auxiliary, record, every, stop)  # fmt: skip
        self.iterations += iterations
        self.factorisations += factorisations
        return taken

    def _damp_after_slack(self, taken, t) -> bool:
        """Return whether the steps ended at the first slack cell, and take the damped scheme from there on."""
        if not (self.stops_at_slack and taken and (self.auxiliary <= 0).any()):
            return False
        self.scheme, self.stops_at_slack, self.damped_from = newmark_parameters(0.0), False, float(t)
        return True

    def _subdivide_step(self, t, h) -> bool:
        """Take one step in as many parts as it needs; False, with the state as it was, where no number of them does."""
        begin, auxiliary = [part.copy() for part in self.state], self.auxiliary.copy()
        adapts = self.step_tolerance is not None
        for halvings in range(self.halvings if adapts else 1, MOST_HALVINGS + 1):
            parts = 2**halvings
            times = t + h / parts * np.arange(parts + 1)
            record = tuple(np.empty((parts, *begin[0].shape)) for _ in range(3))
            if not adapts:  # the acceleration changed too fast for the step to be predicted with it
                self.state[4][:] = self.state[3]
            path, stop = self.system.path(times), False  # the scheme stays the same within a step
            taken = self._integrate(path, times, h / parts, record, 1, stop)
            error = self._step_error(record, begin[2], h / parts) if adapts and taken == parts else 0.0
            if taken == parts and (not adapts or error <= self.step_tolerance):
                if not adapts:
                    self.state[4][:] = self.state[3]
                elif error < LENGTHEN_BELOW * self.step_tolerance:
                    self.halvings = max(0, halvings - 1)
                self._damp_after_slack(parts, times[-1])
                return True
            self.cut += adapts
            self.halvings = halvings + 1
            for part, old in zip(self.state, begin, strict=True):
                part[:] = old
            self.auxiliary[:] = auxiliary
        self.worst = int(abs(begin[1]).max(axis=1).argmax())
        return False

    def _step_error(self, record, first, h) -> float:
        """Return the largest local error of some steps, h^2 |beta - 1/6| |change of a|, over displacements."""
        change = np.diff(np.concatenate([first[None], record[2]]), axis=0)
        displacement = float(abs(record[0] - self.system.rest.y.T).max())
        self.largest_displacement = max(
            self.largest_displacement, displacement, _LEAST_DISPLACEMENT * self.system.length
        )
        return h * h * abs(self.scheme[2] - 1 / 6) * float(abs(change).max()) / self.largest_displacement


def _initial_state(system, start, moves_at_once):
    """Return r, v, r'', a and the a before, (N, n) each: at rest, or as given with the r'' that balances it."""
    if start is None:
        state, v = system.rest, np.zeros((system.nodes, len(system.axes)))
        if system.motion is not None and moves_at_once:  # a motion that is ramped starts from rest
            if (displacement := displace_points(system.motion, system.moved_points, 0.0).T).any():
                state = solve_rest(system, displacement)
            v[system.prescribed_nodes] = system.path(np.zeros(1))[0, 1]
        return np.array(state.y.T, order="C"), v, np.zeros_like(v), np.zeros_like(v), np.zeros_like(v)
    y, ydot = start
    ydot = np.zeros_like(y) if ydot is None else ydot
    r, v = np.array(y.T, order="C"), np.array(ydot.T, order="C")  # the steps change them in place
    a = balancing_acceleration(system, r, v)
    return r, v, a, a.copy(), a.copy()


def balancing_acceleration(system, r, v) -> np.ndarray:
    """Return the accelerations (N, n) in m/s^2 that balance positions and velocities (N, n) at t = 0."""
    (nodes, n), cells = r.shape, system.line.length.size
    R, T, unit, zeros = np.empty_like(r), np.empty(cells), np.empty((cells, n)), np.zeros_like(r)
    mass, right, left = np.empty((nodes, n, n)), np.empty((cells, n, n)), np.empty((cells, n, n))
    no_tension = np.zeros(cells)
    residual(system.line, r, v, zeros, no_tension, R, T, unit)
    R -= system.source_at(np.zeros(1)).sum(axis=0)  # of none the sum is zero
    tangents(system.line, r, v, zeros, no_tension, (0.0, 0.0, 1.0), mass, right, left)
    a = np.linalg.solve(mass, -R[..., None])[..., 0]
    a[system.prescribed_nodes] = system.path(np.zeros(1))[0, 2]
    return a


def stream_line(system, *, dt, count, tolerance, ramp, path, chunk, rho_inf=None):
    """Generator of the states of ``count`` steps of dt in s from rest, ``chunk`` steps at a time, none of them kept.

    ramp: time in s over which the motion grows; path (count + 1, 3, P, n): of the prescribed nodes at the ends of the
    steps, ramped; rho_inf: of ``integrate_line``. Yields (first, r, v, r''): the number of the first state, 0 for that
    at rest, and (k, N, n) each, overwritten later; what is returned is (status, time in s and node where it failed or
    None, iterations).
    """
    moved = system.ramped(ramp) if ramp else system
    run = _Run(moved, rho_inf, tolerance, None, _initial_state(moved, None, moves_at_once=not ramp))
    yield 0, *(part[None].copy() for part in run.state[:3])
    record = tuple(np.empty((chunk, *run.state[0].shape)) for _ in range(3))
    for done in range(0, count, chunk):
        times = dt * np.arange(done, min(done + chunk, count) + 1)
        taken = run.advance(times, record, 1, path[done : done + times.size])
        states = tuple(part[:taken] for part in record)
        if taken:
            yield done + 1, *states
        if taken < times.size - 1:
            return Status.STEP_FAILED, (float(times[taken]), run.worst), run.iterations
        if (torn := _first_torn(run, times[1:], states[0].transpose(2, 1, 0))) is not None:
            return *torn, run.iterations
    return Status.SUCCESS, None, run.iterations
