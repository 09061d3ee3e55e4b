"""A-posteriori checks of a moving line's results: mesh, step, periodicity, harmonics; each violation is a sentence."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..catenary.pretension import mean_pretension, pretension_warnings
from ..common.diagnostics import CURVED, SETTLED, TAIL, check_mesh, largest_slope_change
from ..common.outcome import ConvergenceError

_INSTANTS = 500  # at which two waveforms are compared


def exact_pretension(system) -> float | None:
    """Return the fairlead tension of the exact catenaries, N; None in a current or where a soft seabed decides it."""
    model, environment = system.model, system.model.environment
    if any(system.line.current) or system.prescribed_nodes.size < 2:
        return None

    def tension_over(depth):
        lower = None if environment.depth is None else environment.depth + depth
        try:
            return replace(model, environment=replace(environment, depth=lower)).pretension()
        except ConvergenceError:
            return None

    weight, stiffness = max(segment.weight for segment in model.segments), environment.seabed_stiffness
    return mean_pretension(tension_over, weight / stiffness if stiffness and weight > 0 else 0.0)


def rest_warnings(system) -> tuple[str, ...]:
    """Return a warning where the mesh makes the tension at rest wrong."""
    return pretension_warnings(system.rest.pretension_error, "cells")


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
