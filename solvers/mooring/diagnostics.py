"""A-posteriori checks of a moving line's results: mesh, step, periodicity, harmonics; each violation is a sentence."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..common.diagnostics import CURVED, SETTLED, TAIL, check_mesh, largest_slope_change
from ..common.outcome import ConvergenceError

MAX_PRETENSION_ERROR = 0.01  # of the tension
MAX_SPREAD = 0.02  # of the tension: what a yielding seabed may change for rigid catenaries to give the pretension
_INSTANTS = 500  # at which two waveforms are compared


def exact_pretension(system) -> float | None:
    """Return the fairlead tension of the exact catenaries, N; None in a current or where a soft seabed decides it.

    A line sinks into a seabed by w/k where it rests. Its tension is then close to half way between those over rigid
    seabeds at the height of first contact and w/k lower; None where these differ by more than ``MAX_SPREAD``.
    """
    model, environment = system.model, system.model.environment
    if any(system.line.current) or system.held.size < 2:
        return None
    heaviest = max(segment.weight for segment in model.segments)
    sinks = [0.0]
    if environment.depth is not None and environment.seabed_stiffness and heaviest > 0:
        sinks.append(heaviest / environment.seabed_stiffness)
    tensions = []
    try:
        for sink in sinks:
            depth = None if environment.depth is None else environment.depth + sink
            at_depth = replace(model, environment=replace(environment, depth=depth))
            points = at_depth.equilibrium()
            last = model.segments[-1]
            state = last.profile(points[-2], points[-1], at_depth.environment, np.zeros(1))[2]
            tensions.append(np.hypot(state.H_anchor, state.V_anchor) if last.reversed else state.tension)
    except ConvergenceError:
        return None
    mean = float(np.mean(tensions))
    return mean if mean > 0 and np.ptp(tensions) <= MAX_SPREAD * mean else None


def rest_warnings(system):
    """Yield a sentence where the mesh makes the tension at rest wrong by more than ``MAX_PRETENSION_ERROR``."""
    error = system.rest.pretension_error
    if error is not None and error > MAX_PRETENSION_ERROR:
        yield f"mesh: the pretension is off by {error:.2g} of the exact catenary's: use more cells"


def check_history(history):
    """Yield warnings about a MooringHistory: rest, mesh, step, slack, periodicity."""
    yield from rest_warnings(history.system)
    time, tension = history.time, np.linalg.norm(history.fairlead_force, axis=0)
    if time.size < 3:
        yield f"time: only {time.size - 1} step is stored, which shows nothing of the error: use a shorter dt"
        return
    spread = float(np.ptp(tension))
    if spread <= 1e-9 * tension.max():
        return
    yield from check_mesh(history.mesh_error, "cells")
    if history.slack:
        longest = max(history.slack, key=lambda spell: spell.end - spell.start)
        cells = f"cells {min(longest.cells) + 1} to {max(longest.cells) + 1}"
        times = f"the longest from t = {longest.start:.4g} to {longest.end:.4g} s"
        yield f"slack: {len(history.slack)} times, {times}, {cells}"
    elif time.size == history.steps + 1 and (change := largest_slope_change(tension, time) / spread) > CURVED:
        yield f"dt: the slope of the tension changes by {change:.2g} of its range in a step: use a shorter dt"
    period = history.system.period
    if period is None or time[-1] < 2 * period:
        return
    last = np.linspace(time[-1] - period, time[-1], _INSTANTS)
    now, before = history.fairlead_tension(last), history.fairlead_tension(last - period)
    change, spread = abs(now - before).max(), np.ptp(now)
    if change > SETTLED * spread:
        yield f"periods: the last two differ by {change / spread:.2g} of the range of the tension: not periodic yet"


def check_response(response):
    """Yield warnings about a MooringResponse: rest, mesh, harmonics."""
    yield from rest_warnings(response.system)
    yield from check_mesh(response.mesh_error, "cells")
    count = response.basis.harmonics
    amplitudes = response.tension_harmonics(count)[1:]
    first, period = response.last_period
    spread = np.ptp(response.fairlead_tension(first + period * np.arange(_INSTANTS) / _INSTANTS))
    last = amplitudes[-2:].max()
    if last > TAIL * spread > 0:
        yield f"harmonics: the last of {count} carry {last / spread:.2g} of the tension's range: use more"
    if not response.mean:
        yield "mean: without the constant term the mean forces are not in balance"
