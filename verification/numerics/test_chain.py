"""Is ChainSystem a contract that a chain of any kind can be solved by: with its defaults, or told what is missing?"""

from __future__ import annotations

import inspect
import math

import numpy as np
import pytest

from solvers import InputError, solve_periodic, solve_time_domain
from solvers.numerics.chain import ChainSystem, Residual, product, stack

from ..cases.oscillators import LINEAR, MassChain, towed_chain
from ..reference import EPS

PERIOD = 2 * math.pi / 0.7
AGREES = 2e-3  # of the largest of each field, at 200 steps a period; measured 1.2e-3
SECOND_ORDER = (3.7, 4.3)  # ratio of the errors when the step is halved; measured 3.97 to 4.04


class Minimal(ChainSystem):
    """One mass, q' = v and v' + 0.4 v + q = cos(0.7 t): nothing given but what a chain must give."""

    fields, nodes, start_rows, period = ("q", "v"), 1, 1, PERIOD

    def start(self, y, ydot, t, tangents=True):
        """q' - v = 0."""
        J, Jt = np.zeros((2, 1, 2, *y.shape[2:]))
        Jt[0, 0], J[0, 1] = 1.0, -1.0
        value = ydot[:1, 0] - y[1:, 0]
        return Residual(value, J, Jt) if tangents else Residual(value)

    def end(self, y, ydot, t, tangents=True):
        """v' + 0.4 v + q - cos(0.7 t) = 0."""
        J, Jt = np.zeros((2, 1, 2, *y.shape[2:]))
        Jt[0, 1], J[0, 0], J[0, 1] = 1.0, 1.0, 0.4
        value = ydot[1:, 0] + 0.4 * y[1:, 0] + y[:1, 0] - np.cos(0.7 * t)
        return Residual(value, J, Jt) if tangents else Residual(value)


class MinimalTowed(ChainSystem):
    """One mass towed with the velocity 0.21 cos(0.7 t), v its velocity: beside the rows, the drift and its tangent."""

    fields, nodes, start_rows, period = ("q", "v"), 1, 1, PERIOD
    start = Minimal.start

    def end(self, y, ydot, t, tangents=True, correction=0.0):
        """v less the prescribed velocity and the correction."""
        J = np.zeros((1, 2, *y.shape[2:]))
        J[0, 1] = 1.0
        value = y[1:, 0] - 0.21 * np.cos(0.7 * t) - correction
        return Residual(value, J, 0 * J) if tangents else Residual(value)

    def drift(self, y, t):
        """q less the prescribed position."""
        return y[:1, 0] - 0.3 * np.sin(0.7 * t)

    def drift_tangent(self, y):
        """1 by q."""
        tangent = np.zeros((1, *y.shape))
        tangent[0, 0] = 1.0
        return tangent


def steady(t):
    """q of Minimal after all transients, from its impedance at 0.7 rad/s."""
    return (np.exp(0.7j * t) / (1 - 0.49 + 0.28j)).real


METHODS = [name for name, member in vars(ChainSystem).items() if inspect.isfunction(member) and name[0] != "_"]
MISSING = {"start", "cells", "end", "scaled", "drift_tangent", "tension", "positions", "direction"}
"""Methods without which a chain is none, or cannot answer what it is asked."""


def calls_of(kind, solve) -> set[str]:
    """Names of the methods that a solve asks of a chain and that the chain has from ChainSystem."""
    asked = set()

    class Spied(kind):
        def __getattribute__(self, name):
            asked.add(name)
            return super().__getattribute__(name)

    solve(Spied())
    return {name for name in asked if name in METHODS and name not in vars(kind)}


SOLVES = {
    "time": lambda chain: solve_time_domain(chain, dt=PERIOD / 100, periods=2, step_tolerance=1e-3),
    "harmonics": lambda chain: solve_periodic(chain, harmonics=5),
}


def test_each_method_has_a_default_that_solves_or_says_its_name():
    """What ChainSystem offers is used by one of the solvers as it is, or raises NotImplementedError with its name."""
    used = {name for kind in (Minimal, MinimalTowed) for solve in SOLVES.values() for name in calls_of(kind, solve)}

    def deferred(chain):
        with pytest.raises(InputError):
            solve_periodic(chain, harmonics=5, deferred_correction=True)

    used |= calls_of(Minimal, deferred)
    assert set(METHODS) == used | MISSING | {"residual", "rest_warnings"}  # of tests, and of the warnings of cables
    assert not used & MISSING


@pytest.mark.parametrize("name", sorted(MISSING))
def test_a_method_that_is_missing_is_named(name):
    """NotImplementedError names the class and the method, not an attribute somewhere inside a solver."""
    method = getattr(ChainSystem, name)
    arguments = [None] * (len([p for p in inspect.signature(method).parameters.values() if p.default is p.empty]) - 1)
    with pytest.raises(NotImplementedError, match=rf"^ChainSystem\.{name}: "):
        method(ChainSystem(), *arguments)


def test_a_chain_that_gives_only_its_rows_is_solved_by_both_solvers():
    """Steady amplitude and phase of one mass from rest and from harmonic balance, against its impedance."""
    response = solve_periodic(Minimal(), harmonics=3)
    assert abs(response.y[0, 0] - steady(response.time)).max() <= 1e-12
    history = solve_time_domain(Minimal(), dt=PERIOD / 400, periods=12)
    t = np.linspace(11, 12, 50) * PERIOD
    assert abs(history.at(t)[0, 0] - steady(t)).max() <= 1e-3  # (omega dt)^2 / 12 of some 1.5 m, twice


def test_the_vector_of_a_chain_is_its_rows_in_order():
    """residual: start, cells, end, with and without cells."""
    y, ydot = np.random.default_rng(3).normal(size=(2, 3, 4))
    chain = towed_chain(4)
    parts = [part(y, ydot, 0.3, False).value for part in (chain.start, chain.cells, chain.end)]
    assert np.array_equal(chain.residual(y, ydot, 0.3), np.concatenate([parts[0], parts[1].T.ravel(), parts[2]]))
    one, rate = y[:2, :1], ydot[:2, :1]
    assert Minimal().residual(one, rate, 0.3).tolist() == [
        rate[0, 0] - one[1, 0],
        rate[1, 0] + 0.4 * one[1, 0] + one[0, 0] - np.cos(0.7 * 0.3),
    ]


def test_defaults_of_a_chain_are_those_it_says():
    """Rest in zeros, errors in units of one, corrections of the drift at once and in full; nothing else is offered."""
    chain = Minimal()
    assert chain.rest_state().tolist() == [[0.0], [0.0]] and chain.scale().tolist() == [1.0, 1.0]
    assert (chain.settling_time(), chain.drift_gain(), chain.rest_warnings()) == (0.0, 1.0, ())
    assert chain.ramped(3.0) is chain
    y = chain.rest_state()
    assert {chain.mirror(), chain.invalid(y), chain.coarser(), chain.fourth_order(), chain.drift(y, 0.0)} == {None}
    assert chain.predict_motion(np.zeros(1)) is None


@pytest.mark.parametrize("samples", [(), (5,)])
def test_a_single_node_has_rows_of_no_cells(samples):
    """cells_or_empty: the shapes of a chain of no cells, for a single field, too."""
    chain = ChainSystem()
    chain.fields, chain.nodes = ("q",), 1
    empty = chain.cells_or_empty(np.zeros((1, 1, *samples)), np.zeros((1, 1, *samples)), np.zeros(samples))
    assert [part.shape for part in empty] == [(1, 0, *samples), *[(2, 1, 1, 0, *samples)] * 2]


def test_vectors_of_many_samples_are_those_of_each():
    """residual with sample axes: each sample's rows in the order of one instant."""
    t = np.array([0.0, 0.3])
    y, ydot = np.random.default_rng(5).normal(size=(2, 3, 4, t.size))
    chain = towed_chain(4)
    one_by_one = [chain.residual(y[..., i], ydot[..., i], t[i]) for i in range(t.size)]
    assert np.array_equal(chain.residual(y, ydot, t), np.stack(one_by_one, axis=-1))


# ---------------------------------------------------------------- masses in a row are such a chain
def distance(steps, hold, chain=None) -> np.ndarray:
    """Largest distance of the fields in the 20th period of a time integration from the periodic response, (n_f,).

    From rest where the drift is controlled; from the periodic response itself where nothing takes its offset away.
    """
    chain = chain or towed_chain(3)
    response = solve_periodic(towed_chain(3), harmonics=20)
    at_once = np.zeros(1)
    start = None if hold else (response.at(at_once)[..., 0], response.rate_at(at_once)[..., 0])
    history = solve_time_domain(chain, dt=chain.period / steps, periods=20, hold=hold, start=start)
    t = np.linspace(19, 20, 50) * chain.period
    return abs(history.at(t) - response.at(t)).max(axis=(1, 2)) / abs(response.y).max(axis=(1, 2))


@pytest.mark.parametrize("hold", ["position", "mean", None])
def test_towed_masses_in_time_tend_to_their_periodic_response(hold):
    """With either control of the drift, from rest, or without: second order in the step towards harmonic balance."""
    coarse, fine = distance(100, hold), distance(200, hold)
    assert (fine <= AGREES).all(), fine
    assert (coarse / fine > SECOND_ORDER[0]).all() and (coarse / fine < SECOND_ORDER[1]).all(), coarse / fine


def test_tangents_times_a_state_are_the_change_of_the_rows():
    """The matrix product of the eigenvalue solver, on a chain whose rows are linear: F(y + x) - F(y), node by node."""
    y, x = np.random.default_rng(12).normal(size=(2, 3, 3))
    rows = [part(y, 0 * y, 0.0) for part in (LINEAR.start, LINEAR.cells_or_empty, LINEAR.end)]
    values = [[part(state, 0 * y, 0.0).value for part in (LINEAR.start, LINEAR.cells_or_empty, LINEAR.end)]
              for state in (y, y + x)]  # fmt: skip
    change = stack(*(Residual(b - a) for a, b in zip(*values, strict=True)))
    assert abs(product([part.dy for part in rows], x) - change).max() <= 100 * EPS


class Misplaced(MassChain):
    """Towed masses whose drift is measured from a place 1 cm away."""

    def drift(self, y, t):
        """1 cm more than it is."""
        return super().drift(y, t) + 0.01


@pytest.mark.parametrize("hold", ["position", "mean"])
def test_a_misplaced_end_is_seen(hold):
    """One centimetre of the drift turns the comparison red."""
    true = towed_chain(3)
    wrong = Misplaced(**{name: getattr(true, name) for name in true.__dataclass_fields__})
    assert (distance(200, hold, wrong) > AGREES).any()
