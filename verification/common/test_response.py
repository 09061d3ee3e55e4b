"""Are the outputs that histories and periodic responses share those of the right end, period and harmonic?"""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from solvers.common.response import Response

PERIOD, FIRST = 5.0, 10.0
AMPLITUDES = (40.0, 3.0, 0.5, 0.25, 2.0)  # N: mean, harmonics 1, 2, ...


class Planted(Response):
    """A result of three nodes: at node i the line points along axis i, and the tension is i + 1 times the wave."""

    last_period = (FIRST, PERIOD)
    time = np.array([10.0, 11.0])
    y = ydot = np.array([np.stack([[i * 1.0, i * 1.0] for i in range(3)])])  # the state of a node is its number

    def __init__(self):
        self.system = SimpleNamespace(
            fields=("node",), direction=lambda y: np.eye(3)[:, y[0].astype(int)],
            tension=lambda y, ydot: (y[0] + 1) * y[-1] if len(y) > 1 else (y[0] + 1) * 10.0,
        )  # fmt: skip

    def at(self, t):
        """The wave of the last period; before it the mean is another."""
        wave = sum(a * np.cos(2 * np.pi * k * t / PERIOD + k) for k, a in enumerate(AMPLITUDES))
        return np.array([np.zeros((3, t.size)), np.tile(wave + np.where(t < FIRST, 100.0, 0.0), (3, 1))])

    rate_at = at


def test_forces_point_along_the_line_at_their_own_end():
    """On the vessel against the line's direction at the last node, on the anchor along it at the first."""
    result = Planted()
    assert np.array_equal(result.tension, [[10.0, 10.0], [20.0, 20.0], [30.0, 30.0]])
    assert np.array_equal(result.fairlead_force, [[0.0, 0.0], [0.0, 0.0], [-30.0, -30.0]])
    assert np.array_equal(result.anchor_force, [[10.0, 10.0], [0.0, 0.0], [0.0, 0.0]])


@pytest.mark.parametrize("k", range(len(AMPLITUDES)))
def test_harmonics_of_the_tension_are_those_of_the_last_period(k):
    """Mean and amplitudes of as many harmonics as are asked for, whatever is above them or was before."""
    assert Planted().tension_harmonics(k) == pytest.approx(np.abs(AMPLITUDES[: k + 1]), rel=1e-12)
