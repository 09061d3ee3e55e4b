"""Does the predicted motion follow the fairlead, and do the scales of a cable say what they should?"""

from __future__ import annotations

import math

import numpy as np
import pytest

from ..cases.cables import EVERYTHING, OC3, SURGE_5
from .problems import system

ROUND_OFF = 1e-14  # of velocities below 1 m/s: a rotation and its inverse


@pytest.mark.parametrize("case", [SURGE_5, EVERYTHING], ids=lambda case: case.name)
def test_the_predicted_velocities_grow_linearly_from_the_anchor(case):
    """Along the axes, at every node, as its share of the length; strains, angles and heights are those at rest."""
    chain, t = system(case, 15), np.array([0.7, 4.0])
    y, y_at_rest = chain.predict_motion(t), chain.rest_state()
    wanted = (chain.axes @ chain.motion.velocity(t))[:, None] * (chain.s / chain.s[-1])[:, None]
    assert abs(chain.velocity(y)[0] - wanted).max() <= ROUND_OFF
    still = [i for i, name in enumerate(chain.fields) if name not in "uvw"]
    assert np.array_equal(y[still], np.repeat(y_at_rest[still][..., None], 2, axis=2))


def test_without_a_motion_there_is_no_prediction():
    chain = system(SURGE_5, 15)
    assert chain.replace(motion=None).predict_motion(np.array([1.0])) is None
    assert chain.predict_motion(np.array([1.0])).shape == (4, 15, 1)


# ---------------------------------------------------------------- scales of a cable
@pytest.mark.parametrize("case", [SURGE_5, EVERYTHING], ids=lambda case: case.name)
def test_errors_are_measured_by_the_strain_at_rest(case):
    """The largest; 1 m/s, 1 rad and 1 m for the other fields."""
    chain = system(case, 9)
    assert chain.scale().tolist() == [abs(chain.rest_state()[0]).max(), *[1.0] * (len(chain.fields) - 1)]


def test_a_correction_settles_when_a_wave_has_passed_five_cells_and_back():
    """Of the longest, at the speed sqrt(EA/m) of axial waves."""
    chain = system(OC3, mesh=np.array([0.0, 200.0, 500.0, OC3.length]))
    assert chain.settling_time() == pytest.approx(2 * 5 * 402.2 / math.sqrt(OC3.EA / OC3.mass_per_length))


@pytest.mark.parametrize("nodes", [4, 9, 40, 400])
def test_the_drift_gain_falls_with_the_turn_in_a_cell(nodes):
    """(0.02 rad / turn)^2 of the cell that turns most, 1 at most; the turn is a chord of the unit circle."""
    chain = system(OC3, nodes)
    turn = 2 * np.sin(abs(np.diff(chain.rest_state()[3])).max() / 2)
    assert chain.drift_gain() == pytest.approx(min(1.0, (0.02 / turn) ** 2), rel=1e-12)
    assert (turn > 0.02) == (nodes < 100)
