"""A-posteriori checks of a moving cable's result; each violation yields a warning with its number."""

from __future__ import annotations

import numpy as np

from .outcome import InputError

DRIFT = 0.05  # of the excursion of the fairlead: coarse meshes miss the prescribed position by that much
CURVED = 0.08  # of the range of the tension: its change of slope in a step, about the error of a second-order method
SETTLED = 1e-2  # of the range of the tension: the difference of two periods
TAIL = 5e-3  # of the range of the tension: the amplitude of the last two harmonics
MAX_MESH_ERROR = 0.03  # of the range of the tension: the rms change that half as many nodes or cells make
FEW = 4  # harmonics; with fewer, a resonance of the next one, of 0.02 of the range, was missed
ROUNDING = 1e-9  # of a size: smaller ranges and distances are rounding, and no motion
_INSTANTS = 16  # for each harmonic
_COMPARED = 500  # instants at which two waveforms are compared
_POSITIONS = 200  # of the fairlead, for its excursion


def check_drag(cables, is_moving: bool, current):
    """Yield a warning where a CableProperties of these (or None) in motion or a current has no drag across the line."""
    if (is_moving or any(current)) and any(cable is not None and cable.Cdn == 0 for cable in cables):
        yield (
            "Cdn: 0, or not given: no drag acts across the line, so currents do not push it and motions die out late "
            "or never; DNV-OS-E301 has 2.4 for studless chain and 1.6 for fibre rope"
        )


def check_history(history):
    """Yield warnings about a TimeHistory: position of the fairlead, tension, resolution in time, periodicity."""
    system, time = history.ramped_system, history.time
    if time.size < 3:
        yield f"time: only {time.size - 1} step is stored, which shows nothing of the error: use a shorter dt"
        return
    yield from system.rest_warnings()
    if history.failed_ramp is not None:
        yield f"ramp: the default, {history.failed_ramp:g} s, led to a failure; taken was one of {history.ramp:g} s"
    tension = history.tension[-1]
    spread = _range(tension)
    cure = (
        "more nodes or a shorter dt" if history.hold == "position" else 'more nodes, a shorter dt, or hold="position"'
    )
    yield from _check_position(history.drift(), history.system, time[-1], cure)
    if system.needs_mesh_check:
        yield from check_mesh(history.mesh_error, "nodes")
    midpoints = (time[1:] + time[:-1]) / 2
    between_steps = system.tension(history.at(midpoints), history.rate_at(midpoints))
    yield from _check_compression(between_steps, midpoints, "a shorter dt")
    if time.size == history.steps + 1 and spread > 0:
        change = largest_slope_change(tension, time) / spread
        if change > CURVED:
            yield f"dt: the slope of the tension changes by {change:.2g} of its range in a step: use a shorter dt"
    period = history.system.period
    if period is None or spread == 0 or time[-1] < 2 * period:
        return
    last = time[time >= time[-1] - period]
    now, before = history.fairlead_tension(last), history.fairlead_tension(last - period)
    change, spread = abs(now - before).max(), _range(now)
    if change > SETTLED * spread and spread > 0:
        yield f"periods: the last two differ by {change / spread:.2g} of the range of the tension: not periodic yet"


def check_response(response):
    """Yield warnings about a PeriodicResponse: position of the fairlead, tension, harmonics, mean forces."""
    system, basis = response.system, response.basis
    count = _INSTANTS * basis.harmonics
    t = response.last_period[1] / count * np.arange(count)
    y, ydot = response.at(t), response.rate_at(t)
    tension = system.tension(y, ydot)
    yield from system.rest_warnings()
    yield from _check_position(np.linalg.norm(system.drift(y, t), axis=0), system, 0.0, "more nodes or harmonics")
    yield from _check_compression(tension, t, "more nodes, or more harmonics")
    if system.needs_mesh_check and response.correction is None:
        yield from check_mesh(response.mesh_error, "nodes")
    amplitudes = 2 * abs(np.fft.rfft(tension[-1])[1 : basis.harmonics + 1]) / count
    last, spread = amplitudes[-2:].max(), _range(tension[-1])  # of two: a symmetric motion has every second only
    if basis.harmonics < FEW:
        yield f"harmonics: {basis.harmonics} are too few to show how the response falls off: use {FEW} or more"
    elif last > TAIL * spread and spread > 0:
        yield f"harmonics: the last of {basis.harmonics} carry {last / spread:.2g} of the tension's range: use more"
    if not response.mean:
        yield "mean: without the constant term the mean forces are not in balance"


def check_mesh(error, parts):
    """Yield a warning where the mesh, of nodes or cells, is too coarse or its error not known."""
    if error is None:
        yield f"mesh: its error is not known: too few {parts} for a mesh of half as many, or no solution on that"
    elif error > MAX_MESH_ERROR:
        yield f"mesh: half as many {parts} change the fairlead tension by {error:.2g} of its range: use more {parts}"


def relative_change(fine, coarse) -> float | None:
    """Return the rms difference of two fairlead tensions over the range of the first; None where the second failed.

    Over the last period, or the second half of a history that has none.
    """
    if not coarse.success:
        return None
    try:
        start, length = fine.last_period
    except InputError:
        start, length = float(fine.time[-1]) / 2, float(fine.time[-1]) / 2
    t = start + length * np.arange(1, _COMPARED + 1) / _COMPARED
    tension = fine.fairlead_tension(t)
    spread = _range(tension)
    return float(np.sqrt(np.mean((tension - coarse.fairlead_tension(t)) ** 2)) / spread) if spread else 0.0


def largest_change(fine, coarse) -> float | None:
    """Return the largest ``relative_change`` of two results of a line, or of the elements of a network."""
    changes = [relative_change(*pair) for pair in zip(fine.lines, coarse.lines, strict=True)]
    return None if None in changes else max(changes)  # type: ignore[type-var]


def _check_position(drift, system, end, cure):
    if system.motion is None:
        return
    t = np.linspace(0.0, max(end, system.period or 0.0), _POSITIONS)
    extent = np.linalg.norm(np.ptp(system.motion.displacement(t), axis=-1)) / 2
    if drift.max() > max(DRIFT * extent, ROUNDING * system.s[-1]):
        relative = f", {drift.max() / extent:.2g} of its excursion" if extent else ""
        yield f"drift: the fairlead is up to {drift.max():.3g} m from its place{relative}: use {cure}"


def _range(tension) -> float:
    """Return the greatest less the least tension, 0 where that is rounding."""
    spread = float(np.ptp(tension))
    return spread if spread > ROUNDING * abs(tension).max() else 0.0


def _check_compression(tension, t, cure):
    node, k = np.unravel_index(tension.argmin(), tension.shape)
    if tension[node, k] < 0:
        yield f"tension: {tension[node, k]:.3g} N between instants, at t = {t[k]:.4g} s, node {node + 1}: use {cure}"


def largest_slope_change(values, time) -> float:
    """Return the largest change of the slope from one step to the next, in units of the values per step."""
    step = np.diff(time)
    slope = np.diff(values) / step
    return float((abs(np.diff(slope)) * np.minimum(step[1:], step[:-1])).max())
