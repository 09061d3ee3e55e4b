"""Does the continuation reach the full load where it can, by the steps that it says, and stop where it says?"""

from __future__ import annotations

import numpy as np
import pytest

from solvers.numerics.continuation import continue_in_load

RADIUS = 0.3  # of the guesses from which the solver below converges


def solver(path, radius=RADIUS):
    """A solver that converges to path(load factor) from within a radius, in one step; and the tries it was given."""
    tries = []

    def solve(load_factor, guess):
        tries.append((load_factor, guess))
        converged = abs(guess - path(load_factor)) <= radius
        return (path(load_factor) if converged else np.nan), ["step"], converged

    return solve, tries


def test_the_full_load_is_tried_first():
    """Where it converges at once nothing else is tried."""
    solve, tries = solver(lambda load: 0.2 * load)
    assert continue_in_load(solve, 0.0, min_step=0.1) == (0.2, 1.0, 1, ["step"])
    assert tries == [(1.0, 0.0)]


def test_steps_halve_on_failure_and_double_on_success():
    """On a straight path of length 1 a solver of radius 0.3 reaches a quarter, then fails at three quarters."""
    solve, tries = solver(lambda load: load)
    result = continue_in_load(solve, 0.0, min_step=1e-3)
    assert (result.x, result.reached, result.iterations) == (1.0, 1.0, len(tries))
    assert [load for load, _ in tries] == [1.0, 0.5, 0.25, 0.75, 0.5, 1.0, 0.75, 1.0]


def test_the_secant_is_exact_on_a_straight_path():
    """With the secant every guess after two solutions is the solution, and the steps grow."""
    solve, tries = solver(lambda load: load)
    assert continue_in_load(solve, 0.0, min_step=1e-3, secant=True).reached == 1.0
    assert [load for load, _ in tries] == [1.0, 0.5, 0.25, 0.75, 0.5, 1.0]
    assert tries[-1][1] == pytest.approx(1.0)


def test_a_failed_full_load_begins_again_from_rest():
    """From a start that leads nowhere the steps begin at rest; without one they begin at the start itself."""
    solve, tries = solver(lambda load: load)
    assert continue_in_load(solve, -5.0, 0.0, min_step=1e-3).reached == 1.0
    assert tries[0][1] == -5.0 and tries[1][1] == 0.0
    assert continue_in_load(solver(lambda load: load)[0], -5.0, min_step=1e-3).reached == 0.0


def test_it_ends_at_the_smallest_step_and_at_the_most_iterations():
    """Across a jump of the path it gives up and says how far it came."""
    jump = lambda load: load if load <= 0.5 else load + 1.0
    result = continue_in_load(solver(jump)[0], 0.0, min_step=2.0**-6)
    assert result.x == result.reached == 0.5
    solve, tries = solver(jump)
    assert (
        continue_in_load(solve, 0.0, min_step=1e-9, max_iterations=4).iterations == 6 == len(tries)
    )  # seen when a step fails
