"""A-posteriori checks of a moving line's results: mesh, step, periodicity, harmonics; each violation is a sentence."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..catenary.pretension import mean_pretension, pretension_warnings
from ..common.diagnostics import CURVED, SETTLED, TAIL, check_mesh, largest_slope_change
from ..common.outcome import ConvergenceError

STILL = 1e-9  # of a tension: smaller ranges are rounding
_INSTANTS = 500  # at which two waveforms are compared


def exact_pretension(system) -> float | None:
    """Return the fairlead tension of the exact catenaries, N; None in a current or where a soft seabed decides it."""
    model, environment = system.model, system.model.environment
    if not model.is_line or any(system.line.current) or system.prescribed_nodes.size < 2:
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


def friction_warnings(system) -> tuple[str, ...]:
    """Return a warning where lines rest on a seabed whose friction the equilibrium has none of."""
    model = system.model
    friction = max(segment.friction for segment in model.segments)
    if friction == 0 or model.environment.depth is None:
        return ()
    return (
        f"friction: {friction:g} of the seabed acts in motion only; at rest the lying line slides freely, and "
        "solve_span and solve_network have the friction of a line as it was laid",
    )


def check_history(history):
    """Yield warnings about a MooringHistory: input, rest, mesh, step, slack, periodicity."""
    yield from history.system.input_warnings()
    yield from rest_warnings(history.system)
    time = history.time
    if time.size < 3:
        yield f"time: only {time.size - 1} step is stored, which shows nothing of the error: use a shorter dt"
        return
    tensions = [np.linalg.norm(line.fairlead_force, axis=0) for line in history.lines]
    if all(np.ptp(tension) <= STILL * tension.max() for tension in tensions):
        return
    yield from check_mesh(history.mesh_error, "cells")
    if history.slack:
        longest = max(history.slack, key=lambda spell: spell.end - spell.start)
        cells = f"cells {min(longest.cells) + 1} to {max(longest.cells) + 1}"
        times = f"the longest from t = {longest.start:.4g} to {longest.end:.4g} s"
        yield f"slack: {len(history.slack)} times, {times}, {cells}"
    elif time.size == history.steps + 1:
        yield from _check_step(history, tensions)
    yield from _check_periodicity(history)


def _check_step(history, tensions):
    changes = [largest_slope_change(T, history.time) / np.ptp(T) for T in tensions if np.ptp(T) > STILL * T.max()]
    if max(changes) > CURVED:
        where = _element(history, int(np.argmax(changes)))
        change = f"changes by {max(changes):.2g} of its range in a step"
        yield f"dt: the slope of the tension{where} {change}: use a shorter dt"


def _check_periodicity(history):
    period, end = history.system.period, history.time[-1]
    if period is None or end < 2 * period:
        return
    last, changes = np.linspace(end - period, end, _INSTANTS), []
    for line in history.lines:
        now, before = line.fairlead_tension(last), line.fairlead_tension(last - period)
        spread = np.ptp(now)
        changes.append(abs(now - before).max() / spread if spread > STILL * now.max() else 0.0)
    if max(changes) > SETTLED:
        where = _element(history, int(np.argmax(changes)))
        yield f"periods: the last two differ by {max(changes):.2g} of the range of the tension{where}: not periodic yet"


def _element(result, index) -> str:
    return "" if result.system.model.is_line else f" of element {index + 1}"


def check_response(response):
    """Yield warnings about a MooringResponse: input, rest, mesh, harmonics."""
    yield from response.system.input_warnings()
    yield from rest_warnings(response.system)
    yield from check_mesh(response.mesh_error, "cells")
    count, (first, period) = response.basis.harmonics, response.last_period
    instants, shares = first + period * np.arange(_INSTANTS) / _INSTANTS, []
    for line in response.lines:
        tension = line.fairlead_tension(instants)
        last, spread = line.tension_harmonics(count)[1:][-2:].max(), np.ptp(tension)
        shares.append(last / spread if spread > STILL * tension.max() else 0.0)
    if max(shares) > TAIL:
        where = _element(response, int(np.argmax(shares)))
        yield f"harmonics: the last of {count} carry {max(shares):.2g} of the range of the tension{where}: use more"
    if not response.mean:
        yield "mean: without the constant term the mean forces are not in balance"
