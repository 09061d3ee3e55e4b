"""Does the quasi-static predictor follow the fairlead, and do the scales of a cable say what they should?"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from solvers import Motion, solve_static
from solvers.cable.equations import line_axes
from solvers.cable.predictor import RestrictedEquilibrium

from ..cases.cables import EVERYTHING, OC3, OC3_SEABED, SURGE_5
from .problems import scene, system

AMPLITUDE = (1.5e-3, 2e-3)  # m up and along the line, small for lines of some hundred metres
SECOND_ORDER = 1e-4  # share of a small motion that is of second order; measured 9e-9, and 9e-6 of rates by differences
STEP = 1e-2  # s of central differences, small for a period of 20 s


def moving(case, sideways=0.0, **options):
    """Return a cable of a case on 15 nodes with a small harmonic motion, which is up and along unless ``sideways``."""
    amplitude = np.array([*AMPLITUDE, sideways]) @ line_axes(scene(case))
    return system(case, 15, motion=Motion.harmonic(0.05, amplitude), **options)


@pytest.mark.parametrize("case", [SURGE_5, OC3_SEABED, EVERYTHING], ids=lambda case: case.name)
def test_the_prediction_is_the_equilibrium_with_the_fairlead_there(case):
    """Strains, angles and heights, to first order in the motion."""
    chain, t = moving(case), np.array([0.0, 3.0, 11.0])
    y, rest = chain.quasi_static_predictor(t), chain.rest_state()
    still = [i for i, name in enumerate(chain.fields) if name not in "uvw"]
    for i, place in enumerate(chain.motion.displacement(t).T):
        ends = [replace(chain.scene, fairlead=tuple(chain.scene.fairlead + sign * place)) for sign in (1, -1)]
        there, opposite = (solve_static(chain.replace(scene=end)).y for end in ends)
        change = (there - opposite)[still] / 2
        size = abs(change).max(axis=1, keepdims=True)
        assert (abs((y[..., i] - rest)[still] - change) <= SECOND_ORDER * size + 1e-12).all()


@pytest.mark.parametrize("fields", ["planar", "spatial"])
def test_the_velocities_are_those_of_the_predicted_places(fields):
    """Rates of the positions along the axes, at every node."""
    chain = moving(OC3, 0.0 if fields == "planar" else 1e-3, fields=fields)
    t = np.array([0.7, 4.0])
    y, later, earlier = (chain.quasi_static_predictor(t + step) for step in (0.0, STEP, -STEP))
    rates = chain.axes @ ((chain.positions(later) - chain.positions(earlier)) / (2 * STEP)).reshape(3, -1)
    velocity = chain.equations.velocity(y)[0].reshape(len(chain.axes), -1)
    assert abs(velocity - rates).max() <= SECOND_ORDER * abs(rates).max()


def test_with_a_source_only_the_velocities_move():
    """The source holds the line elsewhere; drag takes the velocities."""
    chain = moving(SURGE_5)
    source = lambda t: np.zeros((4, 15, *np.shape(t)))
    with_source = chain.replace(source=source, equilibrium=chain.equilibrium).quasi_static_predictor(np.array([1.0]))
    without = chain.quasi_static_predictor(np.array([1.0]))
    assert np.array_equal(with_source[[0, 3], :, 0], chain.rest_state()[[0, 3]])
    assert np.array_equal(with_source[[1, 2]], without[[1, 2]]) and without[[1, 2]].any()


def test_without_a_motion_or_a_stiffness_there_is_no_prediction():
    t = np.array([1.0])
    chain = moving(SURGE_5)
    assert chain.replace(motion=None).quasi_static_predictor(t) is None
    loose = RestrictedEquilibrium(chain.rest_state(), None)
    assert chain.replace(motion=chain.motion, equilibrium=loose).quasi_static_predictor(t) is None
    assert chain.quasi_static_predictor(t).shape == (4, 15, 1)


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
