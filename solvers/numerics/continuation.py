"""Natural-parameter continuation: a problem whose full load is too far is solved by steps in a load factor."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np


class ContinuationResult(NamedTuple):
    """x at the load factor that was ``reached``, 1 on success; iterations of all solves, ``steps`` of the last one."""

    x: np.ndarray
    reached: float
    iterations: int
    steps: list


def continue_in_load(solve, x, rest=None, *, min_step, max_iterations=math.inf, secant=False) -> ContinuationResult:
    """Return the solution at the full load, found from x at once or else by steps in the load factor from 0 to 1.

    solve(load_factor, guess) -> (x, steps, converged). A step that fails is halved, one that succeeds is followed by
    one twice as long. rest: where the steps begin when the full load fails at once, x itself by default. secant: guess
    along the secant of the last two solutions. It ends below ``min_step`` or beyond ``max_iterations``.
    """
    reached, step, iterations, before = 0.0, 1.0, 0, None
    while True:
        load_factor = min(1.0, reached + step)
        guess = x if before is None else x + (load_factor - reached) / (reached - before[0]) * (x - before[1])
        trial, steps, converged = solve(load_factor, guess)
        iterations += len(steps)
        if converged:
            if secant and reached > 0:
                before = (reached, x)
            x, reached, step = trial, load_factor, 2 * step
            if reached == 1.0:
                break
        else:
            if reached == 0 and rest is not None:
                x = rest
            step /= 2
            if step < min_step or iterations > max_iterations:
                break
    return ContinuationResult(x, reached, iterations, steps)
