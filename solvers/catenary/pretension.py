"""The tension at rest that exact catenaries give, and the warning where a mesh misses it."""

from __future__ import annotations

MAX_PRETENSION_ERROR = 0.01  # of the tension: what is left of a safety factor is read to a per cent
_MAX_SEABED_EFFECT = 0.02  # of the tension, by w/k of depth: up to here the mean of two catenaries is right to 4e-4


def mean_pretension(tension_over, sink) -> float | None:
    """Return the tension in N of a line over a seabed that yields: the mean of two catenaries over rigid ones.

    tension_over(depth) -> tension in N over a rigid seabed lower by a depth in m, or None without a stressed
    equilibrium. sink: w/k in m, how deep the resting line lies, MSQS (2.23); 0 without a seabed. The line leaves a
    seabed that yields between first contact and w/k lower. None where the two differ by more than 2 %.
    """
    tensions = [tension_over(depth) for depth in ((0.0, sink) if sink else (0.0,))]
    if not all(tensions):
        return None
    mean = sum(tensions) / len(tensions)
    return mean if max(tensions) - min(tensions) <= _MAX_SEABED_EFFECT * mean else None


def pretension_warnings(error, parts) -> tuple[str, ...]:
    """Return a warning where the pretension is off by more than ``MAX_PRETENSION_ERROR``; parts: "nodes" or "cells"."""
    if error is None or not error > MAX_PRETENSION_ERROR:
        return ()
    return (
        f"mesh: the pretension is off by {error:.2g} of the exact catenary's: use more {parts}, or a finer mesh where "
        "the line touches down or bends",
    )
