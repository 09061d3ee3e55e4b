"""Regression tests for mistakes that no other check detects, one claim each, from the lowest room to the highest."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from solvers import (
    ConvergenceError,
    Element,
    Environment,
    Network,
    Node,
    Regime,
    SampledMotion,
    Span,
    Status,
    solve_network,
    solve_periodic,
    solve_span,
    solve_spans,
    solve_static,
    solve_time_domain,
)
from solvers.common.response import Response
from solvers.harmonic_balance.residual import HarmonicResidual
from solvers.network import jacobian as network_jacobian
from solvers.network.nested import Count, solve_sparse
from solvers.numerics import newton
from solvers.numerics.chain import Residual, product, stack
from solvers.numerics.fourier import Basis
from solvers.numerics.lu.bordered import BlockChain
from solvers.numerics.modes import natural_modes
from solvers.numerics.newton import damped_newton
from solvers.time_domain.drift_control import PositionDriftControl
from solvers.time_domain.generalized_alpha import Scheme, Stepper
from solvers.time_domain.step_control import StepControl

from ..cable.problems import graded, random_state, system
from ..cases.cables import OC3, SURGE_5, CableCase
from ..cases.networks import bridle, two_line
from ..cases.oscillators import MassChain, cubic_chain, duffing, harmonic_force
from ..cases.spans import OC3 as OC3_SPAN
from ..exact import catenary_mp
from ..network.test_solve import METHODS, network_of
from ..numerics.test_bordered import Chain
from ..reference import EPS
from ..tools.orders import extrapolated

ROUNDING = 100 * EPS  # of sums of some ten terms of order one


# ---------------------------------------------------------------- one line, Newton's method
def test_an_iteration_that_runs_out_of_steps_is_no_success(monkeypatch):
    """With one step allowed a line ends in NOT_CONVERGED with NaN, alone and in a batch, and is raised."""
    monkeypatch.setattr(newton, "MAX_ITERATIONS", 1)
    span = Span(**OC3_SPAN)
    state = solve_span(span, throw=False)
    assert state.status is Status.NOT_CONVERGED and math.isnan(state.H) and not state.success
    with pytest.raises(ConvergenceError, match="stopped above the requested tolerance"):
        solve_span(span)
    assert solve_spans(*(getattr(span, name) for name in ("w", "EA", "L", "x", "z"))).status.tolist() == [state.status]


@pytest.mark.parametrize(("x", "z"), [(90.0, 10.0), (95.0, -4.0), (93.0, 0.0)])
def test_a_line_that_rests_between_raised_ends_is_that_of_50_digits(x, z):
    """Forces, touchdown, positions and tension of a sagging line: its higher end is the fairlead, or the anchor."""
    span = Span(30.0, 1e6, 100.0, x, z, clearance=5.0)
    state, inputs = solve_span(span), {name: getattr(span, name) for name in Span.__slots__}
    assert state.regime is Regime.SAGGING
    exact = catenary_mp.solve(**inputs)
    for name in ("H", "V", "H_anchor", "V_anchor"):
        assert getattr(state, name) == pytest.approx(float(getattr(exact, name)), rel=1e-12)
    s = np.linspace(0.0, 100.0, 12)
    wanted = np.array([[float(v) for v in catenary_mp.profile(one, **inputs, solution=exact)] for one in s]).T
    for got, right, unit in zip(state.profile(s), wanted, (100.0, 100.0, state.tension), strict=True):
        assert abs(got - right).max() <= 1e-11 * unit


@pytest.mark.parametrize("start", [1.5, 3.0, -20.0])
def test_damping_finds_what_full_steps_do_not(start):
    """arctan x = 0 from beyond 1.39, where full Newton steps run away."""
    residual = np.arctan
    linearise = lambda x: (residual(x), lambda F: F * (1 + x * x))
    x, steps, converged = damped_newton(linearise, residual, np.array([start]), 1e-12, lambda d: float(abs(d[0])))
    assert converged and abs(x[0]) <= 1e-12
    assert min(step.relaxation for step in steps) < 1


# ---------------------------------------------------------------- networks
@pytest.mark.parametrize("options", METHODS.values(), ids=METHODS)
@pytest.mark.parametrize("case", [two_line(), bridle()], ids=lambda case: case.name)
def test_each_method_reaches_its_tolerance_by_itself(case, options):
    """Without the fallback, which would mend it, each method is balanced to what was asked, each line on its curve."""
    state = solve_network(network_of(case), **options, fallback=False, tolerance=1e-9)
    assert state.success and state.residual_norm <= 1e-9
    tight = solve_network(network_of(case), tolerance=1e-13)
    assert abs(state.H - tight.H).max() <= 1e-7 * abs(tight.H).max()  # the softest direction is a hundred times softer


def test_friction_acts_only_where_the_anchor_end_lies():
    """A line that hangs to the seabed from two raised ends has the forces of one without friction."""
    nodes = Node("fixed", (0.0, 0.0, -15.0)), Node("coupled", (90.0, 0.0, -5.0))
    states = [
        solve_network(Network(nodes, [Element(30.0, 1e6, 100.0, (0, 1), friction)], Environment(depth=20.0)))
        for friction in (0.0, 0.5)
    ]
    assert states[0].H[0] > 0 and [s.H[0] for s in states] == [states[0].H[0]] * 2


def test_operations_are_those_of_5_6():
    """A factorisation of n unknowns counts (2/3) n^3, so the paper's nested example 24 x 18 + 90 x 42.67 = 4272."""
    count = Count()
    for n, times in ((3, 24), (4, 90)):
        for _ in range(times):
            solve_sparse(np.eye(n), 0.0, np.ones(n), count)
    assert count.operations == pytest.approx(4272, rel=1e-12)


@pytest.mark.parametrize(("start", "gained"), [(1.39, 0.0021), (1.2, 0.26), (0.5, 0.95)])
def test_the_trust_region_shrinks_where_its_model_fails(start, gained, monkeypatch):
    """arctan x = 0: radius halved below a quarter of the promised gain, kept up to three quarters, then grown."""
    monkeypatch.setattr(network_jacobian, "scaled_jacobian", lambda now, jacobian: np.array([[1 / (1 + now.x**2)]]))
    monkeypatch.setattr(network_jacobian, "split_step", lambda now, p: p[0])
    network = SimpleNamespace(count=Count())

    def at(x):
        return SimpleNamespace(x=x, residual=np.arctan([x]), system=network, take_step=lambda _, dx: at(x + dx))

    new, radius = network_jacobian.trust_region_step(at(start), "analytic", None)
    step = math.atan(start) * (1 + start**2)
    assert new.x == pytest.approx(start - step, rel=1e-12)
    assert 1 - (new.residual[0] / math.atan(start)) ** 2 == pytest.approx(gained, rel=0.1)
    assert radius == pytest.approx(step * (0.5 if gained < 0.25 else 1.0 if gained < 0.75 else 3.0), rel=1e-12)


# ---------------------------------------------------------------- equilibrium of a cable
def test_shooting_knows_the_binormal():
    """With C_db unlike C_dn, in a current across, the box scheme converges to the forces of the shooting method."""
    case = replace(OC3, Cdb=0.6, Cdt=0.05, current=(0.7, 1.4, 0.1))
    forces = [solve_static(system(case, nodes)).fairlead_force for nodes in (51, 101, 201)]
    shot = solve_static(system(case, 51), method="shooting").fairlead_force
    change = abs(shot - solve_static(system(replace(case, Cdb=None), 51), method="shooting").fairlead_force).max()
    error = abs(extrapolated([4, 2, 1], forces) - shot).max()
    assert error <= 1e-3 * change, (error, change)  # h^4 is left, some 1e-9 of the force: measured 2e-5 of the change


def test_drift_is_the_end_of_the_positions_on_any_mesh():
    """Where cells differ, too, the drift of the end is that of the positions of the nodes."""
    chain = system(replace(SURGE_5, amplitude=None), mesh=graded(SURGE_5.length, 9))
    y, _ = random_state(chain, 3)
    off = chain.positions(y)[:, -1] - chain.scene.fairlead
    assert abs(chain.axes.T @ chain.drift(y, 0.0) - off).max() <= 1e-12 * chain.s[-1]


# ---------------------------------------------------------------- motion in time
def test_a_series_goes_through_its_samples():
    """At the times of a series the motion is its samples, from either side."""
    rng = np.random.default_rng(11)
    series = SampledMotion(np.sort(rng.uniform(0, 60, 20)), rng.normal(size=(20, 3)))
    assert abs(series.displacement(series.time) - series.samples.T).max() <= ROUNDING
    before = series.displacement(series.time[1:] * (1 - 1e-9))
    assert abs(before - series.samples[1:].T).max() <= 1e-6  # some 10 m/s for 6e-8 s


def test_tangents_times_a_state_are_the_change_of_the_rows():
    """The matrix product of the eigenvalue solver, on a chain whose rows are linear: F(y + x) - F(y), node by node."""
    y, x = np.random.default_rng(12).normal(size=(2, 3, 3))
    rows = [part(y, 0 * y, 0.0) for part in (LINEAR.start, LINEAR.cells_or_empty, LINEAR.end)]
    values = [[part(state, 0 * y, 0.0).value for part in (LINEAR.start, LINEAR.cells_or_empty, LINEAR.end)]
              for state in (y, y + x)]  # fmt: skip
    change = stack(*(Residual(b - a) for a, b in zip(*values, strict=True)))
    assert abs(product([part.dy for part in rows], x) - change).max() <= ROUNDING


def test_a_hold_takes_an_offset_back():
    """An end that runs away by itself: the hold learns its rate; after twelve intervals 1 % of the offset is left."""
    offset, growth, before = np.array([1.0]), 0.3, np.zeros(1)
    hold = PositionDriftControl(
        SimpleNamespace(drift=lambda y, t: offset, settling_time=lambda: 0.0, drift_gain=lambda: 1.0), 1.0
    )
    for k in range(12):
        correction = hold(None, float(k), 1.0)
        offset, before = offset + growth + (before + correction) / 2, correction
    assert abs(offset[0]) <= 0.01
    assert correction[0] == pytest.approx(-growth, abs=0.01)


LINEAR = MassChain("linear", 2 * math.pi / 0.7, harmonic_force(0.3, 0.7, 2, 3), 3, 1.3, 0.2, 0.0, 2.0)


def stepped(*lengths):
    """(iterations, factorisations) of each step of these lengths of a linear chain from rest."""
    stepper = Stepper(LINEAR, Scheme.from_spectral_radius(0.5), 1e-10, None, max(lengths))
    y, ydot, t, spent = LINEAR.rest_state(), LINEAR.rest_state(), 0.0, []
    for h in lengths:
        before = stepper.iterations, stepper.factorisations
        y, ydot = stepper.step(y, ydot, t, h, ydot)
        spent.append((stepper.iterations - before[0], stepper.factorisations - before[1]))
        t += h
    return spent


def test_a_new_jacobian_converges_quadratically():
    """Equations that are linear take one iteration, and one that finds nothing left; the factors are kept."""
    assert stepped(0.3, 0.3, 0.3) == [(2, 1), (2, 0), (2, 0)]


def test_a_new_step_length_takes_a_new_jacobian():
    """A change of the step makes the factors new ones, and again two iterations are enough."""
    assert stepped(0.3, 0.1, 0.1, 0.3) == [(2, 1), (2, 1), (2, 0), (2, 1)]


@pytest.mark.parametrize("share", [0.05, 0.4])
def test_the_next_step_is_that_of_its_error(share):
    """A free swing from exact states: the next step is 0.9 h (tolerance / true error)^(1/3), to 3 per cent."""
    omega, h = 1.3, 0.03
    swing = MassChain("swing", 1.0, lambda t: np.zeros((1, *np.shape(t))), 1, 1.0, 0.0, 0.0, omega**2)

    def exact(t):
        q, v = math.cos(omega * t), -omega * math.sin(omega * t)
        state, rate = [q, v, omega**2 * q], [v, -(omega**2) * q, omega**2 * v]
        return np.array(state)[:, None], np.array(rate)[:, None]

    stepper, size = Stepper(swing, Scheme.trapezoid(), 1e-13, None, h), np.array([[1.0], [omega], [omega**2]])
    predicted = 2 * exact(h)[1] - exact(0.0)[1]
    result = stepper.step(*exact(h), h, h, predicted)
    error = float((abs(result[0] - exact(2 * h)[0]) / size).max())
    control = StepControl(swing, h, share * error, stepper.scheme.error_constant())
    control.size = size
    assert not control.accept(result, h, *exact(h), predicted, (h, exact(0.0)[1]))
    assert control.h == pytest.approx(0.9 * h * share ** (1 / 3), rel=0.03)


def test_the_default_ramp_takes_half_a_period():
    """HB 4.3: the motion grows over half a period unless told otherwise, and from a start it is there at once."""
    chain = system(SURGE_5, 5)
    run = {"dt": 0.1, "duration": 0.1}
    assert solve_time_domain(chain, **run).ramped_system.motion.duration == chain.period / 2
    assert solve_time_domain(chain, **run, start=(chain.rest_state(), 0 * chain.rest_state())).ramped_system is chain


# ---------------------------------------------------------------- output of responses
class Wave(Response):
    """A response whose fairlead tension is 5 + 3 sin(w t + 0.4) + 0.5 cos(3 w t), N."""

    last_period = 1.0, 2.0
    system = SimpleNamespace(tension=lambda y, ydot: y)

    def at(self, t):
        """The tension as the last of two nodes, (2, S)."""
        value = 5 + 3 * np.sin(math.pi * t + 0.4) + 0.5 * np.cos(3 * math.pi * t)
        return np.array([0 * t, value])

    rate_at = at


def test_harmonics_of_the_tension_are_those_of_its_samples():
    """Mean and amplitudes of a known sum of harmonics, in their order."""
    assert Wave().tension_harmonics(4) == pytest.approx([5.0, 3.0, 0.0, 0.5, 0.0], abs=ROUNDING)


def test_tension_has_its_part_of_damping():
    """T = EA (eps + beta d(eps)/dt) at the samples of a periodic response and at any times."""
    chain = system(replace(SURGE_5, damping=0.5), 8)
    response = solve_periodic(chain, harmonics=3)
    wanted = SURGE_5.EA * (response.y[0] + 0.5 * response.ydot[0])
    assert abs(0.5 * response.ydot[0]).max() > 1e-3 * abs(response.y[0]).max()
    assert response.tension == pytest.approx(wanted, rel=1e-12)
    assert response.fairlead_tension(response.time) == pytest.approx(wanted[-1], rel=1e-12)


# ---------------------------------------------------------------- harmonic balance
def test_a_start_without_the_constant_is_its_own():
    """In the paper's variant, too, a response is confirmed by one step from itself."""
    chain = duffing(0.8, 0.3, 0.1, 1.0, 1.0)
    response = solve_periodic(chain, harmonics=9, mean=False)
    again = solve_periodic(chain, harmonics=9, mean=False, start=response)
    assert again.iterations == 1 and abs(again.z - response.z).max() <= 1e-11


@pytest.mark.parametrize("nodes", [64, 65, 66, 129])
def test_blocks_in_parts_are_all_blocks(nodes):
    """Made in parts of 64 cells, the blocks of a chain are those made at once, whatever is left for the last part."""
    chain = cubic_chain(nodes)
    balance = HarmonicResidual(chain, Basis(1, 4, 0.4, True))
    x = np.random.default_rng(4).normal(size=(nodes, balance.n))
    rows, state = balance.rows(x, True)
    whole = balance.jacobian(rows, balance.slope(state))[1]
    parts = list(balance.jacobian(rows, balance.slope(state), 64)[1])
    made = np.concatenate(parts, axis=1)
    assert made.shape == whole.shape and abs(made - whole).max() <= ROUNDING * abs(whole).max()


def test_a_field_that_no_row_sees_is_told_without_full_rows():
    """A chain is singular where a node's column is empty, although the elimination runs through to its end."""
    chain = Chain.random(6, 5, 2, 0)
    start, cells, _, _ = chain.blocks
    start[:, 1] = cells[0, 0, :, 1] = 0.0
    assert BlockChain(*chain.blocks).singular and not BlockChain(*Chain.random(6, 5, 2, 0).blocks).singular


# ---------------------------------------------------------------- modes
def test_damping_of_modes_is_that_of_the_bar():
    """A Kelvin-Voigt bar: the axial mode of frequency f has the share pi f beta of the critical damping."""
    beta = 1e-4
    bar = CableCase("bar", 1e7, mass_per_length=10.0, submerged_weight=0.0, length=100.0, fairlead=(101.3, 0.0, 0.0),
                    Cdn=0.0, Ca=0.0, rho=0.0, diameter=0.1, damping=beta)  # fmt: skip
    modes = natural_modes(system(bar, 101), 3, near=5.0)
    axial = np.argmax([np.linalg.norm(modes.shapes[1, :, i]) / np.linalg.norm(modes.shapes[2, :, i]) for i in range(3)])
    assert modes.frequencies[axial] == pytest.approx(5.0, rel=2e-3)
    assert modes.damping[axial] == pytest.approx(math.pi * modes.frequencies[axial] * beta, rel=1e-3)
