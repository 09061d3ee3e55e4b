"""Are the outputs that histories and periodic responses share those of the right end, period and harmonic?"""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from solvers import solve_periodic
from solvers.common.response import Response

from ..cable.problems import system
from ..cases.cables import SURGE_5
from ..reference import EPS

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


class Wave(Response):
    """A response whose fairlead tension is 5 + 3 sin(w t + 0.4) + 0.5 cos(3 w t), N."""

    last_period = 1.0, 2.0
    system = SimpleNamespace(tension=lambda y, ydot: y)

    def at(self, t):
        """The tension as the last of two nodes, (2, S)."""
        value = 5 + 3 * np.sin(math.pi * t + 0.4) + 0.5 * np.cos(3 * math.pi * t)
        return np.array([0 * t, value])

    rate_at = at


def test_harmonics_of_the_tension_are_those_of_a_known_sum():
    """Mean and amplitudes of a known sum of harmonics, in their order."""
    assert Wave().tension_harmonics(4) == pytest.approx([5.0, 3.0, 0.0, 0.5, 0.0], abs=100 * EPS)


def test_tension_includes_the_material_damping():
    """T = EA (eps + beta d(eps)/dt) at the samples of a periodic response and at any times."""
    chain = system(replace(SURGE_5, damping=0.5), 8)
    response = solve_periodic(chain, harmonics=3)
    wanted = SURGE_5.EA * (response.y[0] + 0.5 * response.ydot[0])
    assert abs(0.5 * response.ydot[0]).max() > 1e-3 * abs(response.y[0]).max()
    assert response.tension == pytest.approx(wanted, rel=1e-12)
    assert response.fairlead_tension(response.time) == pytest.approx(wanted[-1], rel=1e-12)
