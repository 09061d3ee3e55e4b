"""Which of several responses do random starts come to, and how surely is that known?"""

from __future__ import annotations

from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

from solvers import CableProperties, InputError, Motion, Scene, mooring_system, solve_periodic
from solvers.stability import find_basins, find_landing, response_curve, responses_at
from solvers.stability.curves.basins import Z_95, _Metric, wilson_interval
from solvers.stability.multipliers.floquet import floquet

from ..cases.oscillators import duffing
from ..exact.oscillators import duffing_basins

OMEGA, FORCE, DAMPING, CUBIC = 1.2, 0.18, 0.05, 0.1
COUNT, STEPS = 12, 100
BOUNDARY = 0.1  # of q and v: a basin's edge moves by a part of it with 100 steps of second order a period
ROUND_OFF = 1e-12  # of numbers of order one
SOLVED = 1e-8  # of a state of order one: two solves whose last Newton steps are below 1e-10


@cache
def three_responses():
    """The responses of Duffing's oscillator between its folds: large, unstable, small."""
    resonance = lambda omega: duffing(omega, FORCE, c=DAMPING, k3=CUBIC)
    curve = response_curve(parameter=resonance, start=0.9, stop=1.5, harmonics=9)
    return curve, responses_at(curve, OMEGA)


@cache
def basins():
    return find_basins(three_responses()[1], count=COUNT, spread=0.7, seed=1, steps=STEPS)


def test_responses_at_a_value_are_those_of_the_curve():
    """Three, each periodic, the middle one unstable; at the edge of the range one; beyond it an error."""
    curve, responses = three_responses()
    assert [floquet(each, method="monodromy").stable for each in responses] == [True, False, True]
    for response in responses:
        again = solve_periodic(response.system, harmonics=9, start=response, symmetry=False)
        assert abs(again.z - response.z).max() <= SOLVED
    assert len(responses_at(curve, 0.95)) == 1
    with pytest.raises(InputError, match="does not pass"):
        responses_at(curve, 1.6)


def test_starts_land_where_another_integrator_has_them():
    """Runge-Kutta on the equation itself: each start clear of the boundary between the basins comes to the same."""
    result, responses = basins(), three_responses()[1]
    sizes = np.array([abs(each.at(each.time)[0]).max() for each in responses])
    q, v = (np.array([start[i][0, 0] for start in result.starts]) for i in (0, 1))
    around = np.array([(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)]).T[:, :, None] * BOUNDARY
    amplitudes = duffing_basins.last_amplitudes(
        (q + around[0]).ravel(), (v + around[1]).ravel(), omega=OMEGA, force=FORCE, c=DAMPING, b=CUBIC)  # fmt: skip
    expected = abs(amplitudes[:, None] - sizes).argmin(axis=1).reshape(-1, COUNT)
    is_clear = (expected == expected[0]).all(axis=0)
    assert (result.landed == expected[0])[is_clear].all() and is_clear.mean() > 0.75
    assert set(result.landed[is_clear]) == {0, 2} and result.unsettled == 0


def test_shares_count_the_starts():
    """Shares are the counts over all starts, and stand within their intervals; a seed gives the same again."""
    result = basins()
    assert result.shares == pytest.approx([(result.landed == r).mean() for r in range(3)], abs=ROUND_OFF)
    assert ((result.intervals[:, 0] <= result.shares) & (result.shares <= result.intervals[:, 1])).all()
    again = find_basins(three_responses()[1], count=3, spread=0.7, seed=1, steps=STEPS)
    assert (again.landed == result.landed[:3]).all()


@pytest.mark.parametrize(("hits", "count"), [(0, 10), (3, 10), (50, 100), (100, 100)])
def test_intervals_solve_wilsons_equation(hits, count):
    """Ends p are where the share is z standard deviations of p away: (share - p)^2 = z^2 p (1 - p) / count."""
    for p in wilson_interval(hits, count):
        assert (hits / count - p) ** 2 == pytest.approx(Z_95**2 * p * (1 - p) / count, abs=ROUND_OFF)
    low, high = wilson_interval(hits, count)
    assert 0 <= low <= hits / count <= high <= 1 and low < high


def test_a_line_lands_on_its_only_response():
    """Lines go through the compiled steps: from rest a line comes to its response, which is told from another's."""
    chain = CableProperties(EA=384.243e6, diameter=0.09, mass_per_length=77.7066, Cdn=1.6)
    scene = Scene("OC3", chain, 902.2, (0.0, 0.0, -320.0), (848.67, 0.0, -70.0),
                  motion=Motion.harmonic(0.05, (2.0, 0.0, 0.0)))  # fmt: skip
    system = mooring_system(scene, cells=6)
    there = solve_periodic(system, harmonics=7)
    elsewhere = solve_periodic(system.scaled(2.0), harmonics=7)
    rest = system.rest_state()
    assert find_landing((there, elsewhere), (rest, np.zeros_like(rest)), periods=60) == 0
    moved = [abs(each.at(each.time) - rest[..., None]).max(axis=(1, 2)) for each in (there, elsewhere)]
    moved += [
        abs(each.rate_at(each.time)).max(axis=(1, 2)) * system.period / (2 * np.pi) for each in (there, elsewhere)
    ]
    metric = _Metric((there, elsewhere))  # of positions, then velocities over the frequency, by field
    assert metric.sizes[:, 0, 0] == pytest.approx(np.tile(np.max(moved, axis=0), 2), rel=1e-12)
    velocities = there.rate_at(np.zeros(1)) * system.period / (2 * np.pi)
    assert np.allclose(metric.states[0][len(rest) :], velocities, rtol=0, atol=1e-12 * abs(velocities).max())


def test_a_start_whose_steps_fail_comes_to_no_response(monkeypatch):
    """It counts as one that has not settled."""
    monkeypatch.setattr(
        "solvers.stability.curves.basins.solve_time_domain", lambda *_, **__: SimpleNamespace(success=False)
    )
    result = find_basins(three_responses()[1], count=2)
    assert result.landed.tolist() == [-1, -1] and result.unsettled == 2 and not result.shares.any()


def test_bad_input_is_named():
    """One response, responses at two frequencies, no starts: the field is named before any work."""
    curve, responses = three_responses()
    others = responses_at(curve, 1.0)
    for given, field in (({"responses": responses[:1]}, "responses"),
                         ({"responses": [responses[0], others[0]]}, "responses"),
                         ({"responses": responses, "count": 0}, "count"),
                         ({"responses": responses, "spread": -1.0}, "spread")):  # fmt: skip
        with pytest.raises(InputError) as caught:
            find_basins(**given)
        assert caught.value.field == field
