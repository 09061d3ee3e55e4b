"""Time integration of a ChainSystem by the generalized-alpha method; knows nothing of cables."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from ..common.outcome import InputError, Status
from ..common.response import ROUNDING
from ..common.types import as_system
from ..common.validation import flags, non_negative_number, positive_number, real_array, refuse_for_lines, whole_number
from ..numerics.chain import ChainSystem
from .drift_control import check_hold
from .generalized_alpha import Scheme, Stepper
from .history import TimeHistory
from .step_control import StepControl

TOLERANCE = 1e-10  # mean change of a state
LINE_TOLERANCE = 1e-4  # of the largest change of a tension from rest
MAX_STEPS = 1e9  # a day of work for the shortest chain


def solve_time_domain(
    system: ChainSystem,
    *,
    dt: float,
    periods: float | None = None,
    duration: float | None = None,
    rho_inf: float | None = None,
    scheme: Scheme | None = None,
    tolerance: float | None = None,
    step_tolerance: float | None = None,
    ramp: float | None = None,
    start: Sequence[ArrayLike | None] | None = None,
    hold: str | None = "position",
    allow_invalid: bool = False,
    every: int = 1,
    progress: Callable[[float], object] | None = None,
    throw: bool = True,
) -> TimeHistory:
    """Integrate the chain from rest, or from ``start`` = (y, ydot or None), over ``periods`` or a ``duration`` in s.

    system: a cable on the box scheme (``cable_system``), a line of nodes and elements (``mooring_system``), which goes
    through slack and takes neither scheme, hold nor allow_invalid, or a Scene, taken as ``mooring_system(scene)``; of
    lines the result is a MooringHistory. A list of lines is integrated side by side, one core each: a list of results.
    dt: step in s, made to divide the duration; with step_tolerance (error of a step relative to the largest value of
    each field, or the chain's scale) the longest step.
    rho_inf: spectral radius at infinite frequency, 0.5 by default (near 1 the shortest waves are not damped, and a
    motion may feed them); or scheme, a Scheme.
    tolerance: mean |dy| of the last Newton step, HB (76), 1e-10 by default; of a line of nodes and elements that part
    of the largest change of a tension which the last Newton step may make, 1e-4 by default, up to five times that where
    the next one would make less than a tenth of it.
    ramp: time in s over which the motion grows from rest (none from a ``start``). Default: half a period, HB 4.3; where
    a step fails or a state is invalid within the first two periods, which so short a ramp alone may cause, a history of
    two periods or more is integrated again with a ramp of one period, unless allow_invalid; ``failed_ramp`` and a
    warning say so.
    hold: what keeps the last node from drifting, for the rows of the end see velocities only. "position": a velocity
    that leads it back at every step; "mean": one that takes back the mean drift once a period, so that the response
    is that of ``solve_periodic``; None: nothing, the paper's scheme.
    allow_invalid: go on where a state leaves what the chain is valid for (a cable in compression, which is ill-posed)
    and say so in the status; otherwise the history ends there.
    every: keep each n-th step, the first and the last. progress: called with the time reached in s after each step,
    of a line of nodes and elements after some hundred.
    Raises InputError for bad input, ConvergenceError when a step fails or a state is invalid (``throw=False``, and an
    invalid state that is allowed: the history up to there with its status).

    >>> chain = CableProperties(EA=384.243e6, diameter=0.09, mass_per_length=77.7066, Cdn=1.6)
    >>> surge = Motion.harmonic(0.05, (5.0, 0.0, 0.0))
    >>> scene = Scene("my line", chain, 902.2, (0.0, 0.0, -320.0), (848.67, 0.0, -70.0), motion=surge)
    >>> history = solve_time_domain(cable_system(scene, nodes=20), dt=0.5, periods=2)
    >>> round(float(history.fairlead_tension(40.0)) / 1e6, 2)  # MN
    1.28
    """
    if isinstance(system, (list, tuple)):
        options = {k: v for k, v in locals().items() if k != "system"}
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            return list(pool.map(lambda one: solve_time_domain(one, **options), system))  # type: ignore[return-value]
    system = as_system(system)
    is_line = hasattr(system, "integrate")  # of nodes and elements, with steps of its own
    tolerance = (LINE_TOLERANCE if is_line else TOLERANCE) if tolerance is None else tolerance
    end = _duration(system, periods, duration)
    dt, tolerance = _step_within(dt, end), positive_number("tolerance", tolerance, "(mean change of a state)")
    if step_tolerance is not None:
        step_tolerance = positive_number("step_tolerance", step_tolerance, "(dimensionless)")
    every = whole_number("every", every, 1, unit="steps")
    flags(allow_invalid=allow_invalid, throw=throw)
    if is_line:
        refuse_for_lines(("scheme", scheme, None), ("hold", hold, "position"), ("allow_invalid", allow_invalid, False))
    scheme = _scheme(scheme, rho_inf)
    if not (progress is None or callable(progress)):
        raise InputError(f"{progress!r} must be a function of time (s), or None", field="progress", value=progress)
    first_ramp = _first_ramp(system, ramp, start)
    check_hold(system, hold)
    state = _start_state(system, start)
    if is_line:
        count = math.ceil(end / dt * (1 - ROUNDING))
        settings: dict = {"dt": end / count, "count": count, "rho_inf": rho_inf, "tolerance": tolerance, "every": every}
        settings |= {"step_tolerance": step_tolerance, "ramp": first_ramp, "start": None if start is None else state}
        history = system.integrate(progress=progress, **settings)  # type: ignore[attr-defined]
        return history.or_raise(_given(history, dt, f"ramp = {first_ramp:g} s")) if throw else history

    def integrate(ramp) -> TimeHistory:
        stepper = Stepper(system.ramped(ramp) if ramp else system, scheme, tolerance, hold, dt)
        with np.errstate(all="ignore"):  # a Newton step that diverges is found by its size
            y, ydot = state
            rate = stepper.initial_rate(y, 1e-3 * dt) if ydot is None else ydot
            run = _Run(stepper, y, rate, end, dt, step_tolerance, every)
            while run.continues(allow_invalid):
                run.step()
                if progress is not None:
                    progress(run.t)
        again = partial(
            solve_time_domain, dt=dt, duration=end, scheme=scheme, tolerance=tolerance, step_tolerance=step_tolerance,
            ramp=ramp, hold=hold, allow_invalid=allow_invalid, every=every, throw=False)  # fmt: skip
        return run.history(system, hold, ramp, None if start is not None else again)

    history, tried = integrate(first_ramp), f"ramp = {first_ramp:g} s"
    early = history.event is not None and first_ramp > 0 and history.event[0] <= 2 * system.period <= end  # type: ignore[operator]
    if ramp is None and early and not allow_invalid:  # and a period of full motion fits in after a longer ramp
        longer, tried = integrate(system.period), f"{tried}, then {system.period:g} s"
        history = replace(longer, failed_ramp=first_ramp) if longer.success else history
    if not throw or (allow_invalid and history.status is not Status.STEP_FAILED):
        return history
    return history.or_raise(_given(history, dt, tried))


def _given(history, dt, ramps) -> str:
    """Return what a failed integration was given, where it stopped and what only an integration can try."""
    given = f"dt = {dt:g} s, {ramps}"
    if history.event is not None:
        time, node = history.event
        name_node = getattr(history.system, "name_node", lambda node: f"node {node + 1} of {history.system.nodes}")
        given += f"; stopped at t = {time:.6g} s, {name_node(node)}"
    if history.status in (Status.COMPRESSION, Status.OVERSTRETCHED) and not hasattr(history.system, "integrate"):
        given += "; allow_invalid=True goes on, to be read with care"
    return given


class _Run:
    """The state of an integration: step by step, with a fixed or an error-controlled step."""

    def __init__(self, stepper, y, ydot, end, dt, step_tolerance, every):
        self.stepper, self.end, self.every = stepper, end, every
        self.count = math.ceil(end / dt * (1 - ROUNDING))  # of fixed steps
        self.control = None
        if step_tolerance is not None:
            self.control = StepControl(stepper.system, dt, step_tolerance, stepper.scheme.error_constant())
        self.t, self.y, self.ydot = 0.0, y, np.zeros_like(y) if ydot is None else ydot
        self.previous = None  # (length of the step before, ydot at its start)
        self.record, self.steps, self.rejected = [(0.0, y, self.ydot)], 0, 0
        self.status, self.event = Status.SUCCESS, None
        if ydot is None:
            self.status, self.event = Status.STEP_FAILED, (0.0, stepper.worst)

    def continues(self, allow_invalid) -> bool:
        """True until the end of the history, a step that failed, or a state that is invalid and not allowed."""
        ended = self.status is Status.STEP_FAILED or (self.event is not None and not allow_invalid)
        return not ended and self.t < self.end * (1 - ROUNDING)

    def step(self):
        """Take one step, or reject it and shorten the next; sets the status where neither can be done."""
        control = self.control
        h = self.end / self.count if control is None else min(control.h, self.end - self.t)
        predicted = self.ydot
        if self.previous is not None:
            predicted = self.ydot + h / self.previous[0] * (self.ydot - self.previous[1])
        new = self.stepper.step(self.y, self.ydot, self.t, h, predicted)
        if new is None and self.previous is not None:  # the prediction may be what failed
            new = self.stepper.step(self.y, self.ydot, self.t, h, self.ydot)
        accepted = control is None or control.accept(new, h, self.y, self.ydot, predicted, self.previous)
        if new is None or not accepted:
            self.rejected += 1
            if control is None or control.gave_up:
                self.status, self.event = Status.STEP_FAILED, (self.t + h, self.stepper.worst)
            return
        self.previous = (h, self.ydot)
        self.steps += 1
        self.t = self.end * self.steps / self.count if control is None else self.t + h
        self.y, self.ydot = new
        if self.steps % self.every == 0:
            self.record.append((self.t, *new))
        invalid = None if self.event is not None else self.stepper.system.invalid(self.y)
        if invalid is not None:
            self.status, self.event = invalid[0], (self.t, invalid[1])

    def history(self, system, hold, ramp, repeat) -> TimeHistory:
        """Return what was recorded."""
        if self.record[-1][0] != self.t:
            self.record.append((self.t, self.y, self.ydot))
        time, y, ydot = zip(*self.record, strict=True)
        s = self.stepper
        counts = s.iterations, s.factorisations, s.error, self.steps, self.rejected
        series = np.array(time), np.stack(y, axis=-1), np.stack(ydot, axis=-1)
        return TimeHistory(system, s.system, *series, self.status, *counts, self.event, hold, ramp, repeat=repeat)


def _duration(system, periods, duration) -> float:
    if (periods is None) == (duration is None):
        raise InputError("give either periods (a number of them) or duration (s)", field="periods", value=periods)
    if duration is not None:
        return positive_number("duration", duration, "s")
    periods = positive_number("periods", periods, "(a number of periods)")
    if system.period is None:
        raise InputError("the motion has no period; give duration (s)", field="periods", value=periods)
    return periods * system.period


def _step_within(dt, end) -> float:
    """Return a step in s that fits into the duration, and not too often."""
    dt = positive_number("dt", dt, "s")
    if dt > end:
        problem = f"{dt:g} s must not exceed the duration (or periods), {end:g} s"
        raise InputError(problem, field="dt", value=dt, unit="s")
    if end / MAX_STEPS > dt:
        problem = f"{dt:g} s makes more than {MAX_STEPS:g} steps of the duration (or periods), {end:g} s"
        raise InputError(problem, field="dt", value=dt, unit="s")
    return dt


def _first_ramp(system, ramp, start) -> float:
    if ramp is None:
        return 0.0 if start is not None or system.period is None else system.period / 2
    return non_negative_number("ramp", ramp, "s")


def _scheme(scheme, rho_inf) -> Scheme:
    if not (scheme is None or isinstance(scheme, Scheme)):
        problem = f"{scheme!r} is not a solvers.time_domain.generalized_alpha.Scheme"
        raise InputError(problem, field="scheme", value=scheme)
    return Scheme.from_spectral_radius(0.5 if rho_inf is None else rho_inf) if scheme is None else scheme


def _start_state(system, start):
    """(y, ydot) from which to go on; ydot None: to be found."""
    shape = (len(system.fields), system.nodes)
    if start is None:
        y = system.rest_state()
        return y, np.zeros_like(y)
    try:
        y, ydot = (None if part is None else real_array(part) for part in start)
    except (TypeError, ValueError):
        problem = "must be (y, ydot), two arrays of numbers, ydot may be None"
        raise InputError(problem, field="start", value=start) from None
    for name, part in (("y", y), ("ydot", ydot)):
        if part is not None and (part.shape != shape or not np.isfinite(part).all()):
            raise InputError(f"{name} of shape {part.shape} must be {shape}, all finite", field="start", value=start)
    if y is None:
        raise InputError(f"y is None; it must be an array of shape {shape}", field="start", value=start)
    return y, ydot
