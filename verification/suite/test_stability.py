"""At the limits of each solver: is what it calls a success one, and does it say so when it has none?

Corners of the stability maps. Each check of a success looks at the result from outside: the equations by differences of
what was returned, the places by their integral, never the solver's own residual. Every check is shown a spoiled result.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eig

from solvers import Environment, Motion, Network, Span, Status, cable_system, solve_network, solve_periodic, solve_span
from solvers.cable.statics import solve_static
from solvers.cable.system import CableSystem
from solvers.time_domain.generalized_alpha import Scheme
from solvers.time_domain.solve import solve_time_domain

from ..cable.problems import scene, system
from ..cases.cables import OC3, OC3_SEABED, SLACK_CHAIN, SURGE_5
from ..cases.networks import chain
from ..cases.spans import SpanCase
from ..reference import exact_span, force_error
from ..tools.planting import Fault, planted

LIMITS = 100  # condition limits: what this project asks of its answers on its reference table
BALANCE = 2e-9  # of the largest force: the tolerance of the network solver, summed in another order
ROWS = 1e-8  # of the terms of a row: the tolerance is of the step
PLACE = 1e-9  # of the chord
MEAN = 1e-8  # m, of a chord of 885 m
LINEAR = 1e-3  # relative: what the quadratic terms do to a wave of a thousandth of the strain at rest
INVALID = (Status.COMPRESSION, Status.OVERSTRETCHED)


def at(case, nodes=8, **changes):
    """The system of a case with other values."""
    return cable_system(scene(replace(case, **changes)), nodes)


# ---------------------------------------------------------------- what a success must keep
def row_defect(system, y, ydot, t=0.0) -> float:
    """Largest cell row over the sum of the sizes of its terms, |dF/dy| |y| + |dF/dydot| |ydot|."""
    rows = system.cells(y, ydot, t)
    sizes = 0.0
    for J, field in ((rows.dy, y), (rows.dydot, ydot)):
        sizes = sizes + np.einsum("ij...,j...->i...", abs(J[0]), abs(field)[:, :-1])
        sizes = sizes + np.einsum("ij...,j...->i...", abs(J[1]), abs(field)[:, 1:])
    return float((abs(rows.value) / np.maximum(sizes, np.finfo(float).tiny)).max())


def check_static(state):
    """The rows are met at rest, the integral of the strained tangent ends at the fairlead, no part is compressed."""
    system = state.system
    assert np.isfinite(state.y).all() and np.isfinite(state.r).all()
    assert row_defect(system, state.y, np.zeros_like(state.y)) < ROWS
    miss = np.linalg.norm(system.positions(state.y)[:, -1] - system.scene.fairlead)
    assert miss < PLACE * np.linalg.norm(system.chord)
    assert state.tension.min() >= 0


def check_history(history, scheme):
    """Every step follows the method's relation between states and rates, the rows hold within, no compression."""
    y, ydot, time = history.y, history.ydot, history.time
    assert np.isfinite(y).all() and np.isfinite(ydot).all() and history.tension.min() >= 0
    mix = lambda a, share: (1 - share) * a[..., :-1] + share * a[..., 1:]
    slip = np.diff(y) - np.diff(time) * mix(ydot, scheme.gamma)
    assert (abs(slip).max(axis=(1, 2)) <= ROWS * abs(y).max(axis=(1, 2))).all()
    inside, rate = mix(y, scheme.alpha_f), mix(ydot, scheme.alpha_m)
    t = mix(time, scheme.alpha_f)
    ones = np.ones_like(inside)  # the tolerance of the solver is absolute: a state off by a part of 1 m/s, 1 rad
    rows = abs(history.ramped_system.cells(inside, rate, t).value)
    assert (rows <= ROWS * _terms(history.ramped_system, inside, rate, t, ones, ones / np.diff(time).max())).all()


def _terms(system, y, ydot, t, size, size_dot):
    rows = system.cells(y, ydot, t)
    return sum(
        np.einsum("ij...,j...->i...", abs(J[side]), field[:, at])
        for J, field in ((rows.dy, size), (rows.dydot, size_dot))
        for side, at in ((0, slice(None, -1)), (1, slice(1, None)))
    )


def check_response(response):
    """Coefficients of the rows vanish, the fairlead's mean place is kept, no compression at any of many instants."""
    system, y, ydot, t = response.system, response.y, response.ydot, response.time
    assert np.isfinite(y).all() and np.isfinite(ydot).all()
    coefficients = abs(np.fft.rfft(system.cells(y, ydot, t).value))[..., : response.basis.harmonics + 1] / t.size
    sizes = _terms(system, y, ydot, t, abs(y), abs(ydot)).mean(axis=-1)
    assert (coefficients <= ROWS * sizes[..., None]).all()
    assert abs(system.drift(y, t).mean(axis=-1)).max() < MEAN
    fine = np.linspace(0.0, system.period, 16 * t.size)
    assert system.tension(response.at(fine), response.rate_at(fine)).min() >= 0


# ---------------------------------------------------------------- lines and networks
@pytest.mark.parametrize("stiffness", [1.0, 1e6, 1e12])
@pytest.mark.parametrize("slackness", [0.5, 1 - 1e-6, 1.0, 1.02, 10.0])
@pytest.mark.parametrize("friction", [0.0, 1e3])
def test_spans_at_the_limits_against_50_digits(stiffness, slackness, friction):
    """From over-taut to ten chords, EA/wL 1 to 1e12, friction 0 to 1e3: right within 100 condition limits."""
    L = 500.0 * slackness
    case = SpanCase("", "", 700.0, stiffness * 700.0 * L, L, 480.0, 140.0, friction=friction)
    state, truth = solve_span(Span(**case.inputs())), exact_span(case)
    assert force_error(state.H, state.V, truth, case) <= LIMITS * truth.limit


@pytest.mark.parametrize("diameter", [1e-3, 1.0])
@pytest.mark.parametrize("depth", [1.0, 1e4])
def test_spans_of_any_size_against_50_digits(depth, diameter):
    """A steel line of 1 mm or 1 m in 1 m or 10 km of water is right within 100 condition limits."""
    area = math.pi * diameter**2 / 4
    case = SpanCase("", "", 6825 * 9.81 * area, 2e11 * area, 1.02 * math.hypot(2, 1) * depth, 2 * depth, depth)
    state, truth = solve_span(Span(**case.inputs())), exact_span(case)
    assert force_error(state.H, state.V, truth, case) <= LIMITS * truth.limit


@pytest.mark.parametrize("contrast", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize("lines", [2, 9, 100])
def test_networks_with_a_stiffness_contrast(lines, contrast):
    """A chain whose lines differ a millionfold in stiffness carries one H, and V falls by the weight of each line."""
    case = chain(lines, EA=1e8)
    made = tuple(replace(e, EA=e.EA / contrast if i % 2 else e.EA) for i, e in enumerate(case.elements))
    state = solve_network(_network(replace(case, elements=made)))
    weight, largest = np.array([e.w * e.L for e in made]), np.hypot(state.H, state.V).max()
    assert np.ptp(state.H) <= BALANCE * largest
    assert abs(state.V[:-1] - state.V_anchor[1:]).max() <= BALANCE * largest
    assert abs(state.V - state.V_anchor - weight).max() <= BALANCE * largest


def _network(case) -> Network:
    from solvers import Element, Node

    nodes = tuple(Node(n.kind, n.r, n.mass, n.volume, n.force) for n in case.nodes)
    lines = tuple(Element(e.w, e.EA, e.L, e.ends, e.friction) for e in case.elements)
    return Network(nodes, lines, Environment())


# ---------------------------------------------------------------- statics
@pytest.mark.parametrize("nodes", [3, 40, 2000])
@pytest.mark.parametrize("current", [(0.0, 0.0, 0.0), (5.0, 0.0, 0.0), (-3.0, 4.0, 0.0)])
def test_statics_with_current(nodes, current):
    """From 3 to 2000 nodes, with and without a current of 5 m/s along and across: solved, and a success by its rows."""
    check_static(solve_static(at(OC3, nodes, current=current)))


@pytest.mark.parametrize("nodes", [3, 10, 300])
@pytest.mark.parametrize("stiffness", [0.0, 1.0, 1e4, 1e9])
def test_statics_on_a_seabed(nodes, stiffness):
    """Seabed stiffness 0 to 1e9 N/m^2: solved, and a success by its rows."""
    check_static(solve_static(at(OC3_SEABED, nodes, seabed_stiffness=stiffness)))


@pytest.mark.parametrize(
    "corner",
    [
        {"current": (-1000.0, 300.0, 0.0)},
        {"EA": 1e2},
        {"length": 9e4},
        {"length": 600.0},
        {"current": (100.0, 0.0, 0.0)},
    ],
    ids=str,
)
def test_statics_beyond_the_limits(corner):
    """A current of 1000 m/s, a line far too soft, too long or too short: a success by its rows, or a status."""
    state = solve_static(at(OC3, 10, **corner), throw=False)
    if state.success:
        check_static(state)
    else:
        assert state.status in (*INVALID, Status.NO_EQUILIBRIUM_FOUND)


# ---------------------------------------------------------------- time domain
TIME_CORNERS = [
    {"Cdn": drag, "amplitude": (surge, 0.0, 0.0)} for drag, surge in itertools.product((0.0, 100.0), (0.01, 20.0))
] + [
    {"mass_per_length": mass, "Ca": added} for mass, added in itertools.product((1e-2, 77.7, 1e4), (0.0, 100.0))
] + [{"frequency": f, "amplitude": (0.1, 0.0, 0.0)} for f in (1e-4, 0.107, 1.23, 10.0)] + [
    {"damping": beta} for beta in (1e-3, 1.0, 100.0)
]  # fmt: skip


@pytest.mark.parametrize("hold", ["position", "mean"])
@pytest.mark.parametrize("corner", TIME_CORNERS, ids=str)
def test_time_domain_at_the_limits(corner, hold):
    """Drag, mass, frequency, structural damping at their ends: a success keeps its equations, a stop has a status."""
    system = at(SURGE_5, **corner)
    history = solve_time_domain(system, dt=system.period / 25, periods=1, hold=hold, throw=False)
    _judge_history(history, Scheme.from_spectral_radius(0.5))


@pytest.mark.parametrize("rho_inf", [0.0, 0.5, 0.9])
@pytest.mark.parametrize("share", [1e-4, 1e-2, 0.5])
def test_time_steps_at_the_limits(share, rho_inf):
    """Steps from 1e-4 to half a period: solved, whatever the spectral radius."""
    system = at(SURGE_5, amplitude=(1.0, 0.0, 0.0))
    dt = share * system.period
    history = solve_time_domain(system, dt=dt, duration=min(100 * dt, system.period), rho_inf=rho_inf, ramp=0.0)
    check_history(history, Scheme.from_spectral_radius(rho_inf))


def _judge_history(history, scheme):
    if history.success:
        check_history(history, scheme)
        return
    assert history.status in (*INVALID, Status.STEP_FAILED) and history.event is not None
    assert np.isfinite(history.y).all(), "what is recorded up to a stop is finite"


# ---------------------------------------------------------------- harmonic balance
@pytest.mark.parametrize("harmonics", [1, 5, 12])
@pytest.mark.parametrize("surge", [1e-3, 5.0, 20.0])
def test_harmonic_balance_at_the_limits(harmonics, surge):
    """Few or many harmonics, a tiny to a violent motion: a success keeps its equations, the others have a status."""
    _judge_response(solve_periodic(at(SURGE_5, amplitude=(surge, 0.0, 0.0)), harmonics=harmonics, throw=False))


@pytest.mark.parametrize("drag", [0.0, 100.0])
@pytest.mark.parametrize("frequency", [1e-4, 0.107, 1.23, 10.0])
def test_harmonic_balance_over_frequencies(frequency, drag):
    """1e-4 to 10 Hz, resonances among them, with and without drag: a success keeps its equations."""
    system = at(SURGE_5, frequency=frequency, Cdn=drag, amplitude=(0.01, 0.0, 0.0))
    _judge_response(solve_periodic(system, harmonics=3, throw=False))


def _judge_response(response):
    if response.success:
        check_response(response)
    else:
        assert response.status in (*INVALID, Status.NO_PERIODIC_RESPONSE)


def test_lost_tension_is_never_a_success():
    """A surge that takes the tension away ends with COMPRESSION in time, and without success in harmonic balance."""
    system = at(SURGE_5, amplitude=(15.0, 0.0, 0.0))
    assert solve_time_domain(system, dt=0.5, periods=1, throw=False).status is Status.COMPRESSION
    assert not solve_periodic(system, harmonics=5, throw=False).success


# ---------------------------------------------------------------- what a result says of itself
def warned(result) -> set[str]:
    """The first words of the warnings: what they are about."""
    return {text.split(":")[0] for text in result.warnings}


def test_a_good_result_warns_of_nothing():
    """Sixty steps a period, settled, on a mesh that keeps the fairlead in its place; nine harmonics."""
    system = at(SURGE_5, 20, amplitude=(2.0, 0.0, 0.0))
    assert solve_time_domain(system, dt=system.period / 60, periods=4).warnings == ()
    assert solve_periodic(system, harmonics=9).warnings == ()


@pytest.mark.parametrize("rho_inf", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("hold", ["position", "mean"])
def test_steps_too_long_for_the_motion_are_warned_of(rho_inf, hold):
    """Half a period in a step, where the error is 0.3 to 2.4 of the range, and a tenth, where it is 0.1: both warn."""
    system = at(SURGE_5, 10, amplitude=(2.0, 0.0, 0.0))
    for steps in (2, 10):
        history = solve_time_domain(system, dt=system.period / steps, periods=1.5, rho_inf=rho_inf, hold=hold)
        assert "dt" in warned(history)
    one = solve_time_domain(system, dt=system.period, periods=1, rho_inf=rho_inf, hold=hold, throw=False)
    assert not one.success or "time" in warned(one)


def test_drift_is_warned_of():
    """Without a hold the fairlead of a violent motion moves away from its place; held, it does not."""
    system = at(SURGE_5, 20, amplitude=(8.0, 0.0, 0.0))
    free, controlled = (solve_time_domain(system, dt=0.2, periods=6, hold=hold) for hold in (None, "position"))
    assert "drift" in warned(free) and "drift" not in warned(controlled)
    assert f"{free.drift().max():.3g} m" in free.warnings[0]


def test_a_line_that_does_not_move_warns_of_nothing():
    """With a motion of no amplitude ranges are rounding: no share of them is taken, nothing is divided by zero."""
    still = system(replace(SURGE_5, amplitude=(0.0, 0.0, 0.0)), 15)
    assert not solve_periodic(still, harmonics=5).warnings
    assert not solve_time_domain(still, dt=0.5, periods=2).warnings


def test_advice_of_one_solver_is_not_that_of_another():
    """Messages of statuses name no argument that only one solver has, and more harmonics are no cure on a seabed."""
    texts = {status: status.value for status in Status}
    assert not any("allow_invalid" in text for text in texts.values())
    assert "more harmonics" not in texts[Status.NO_PERIODIC_RESPONSE]
    assert "more nodes" in texts[Status.NO_PERIODIC_RESPONSE]


def test_the_warning_of_a_drift_names_a_remedy_that_is_left():
    """A mesh so coarse that the held end misses its place: more nodes or a shorter step, not the hold that it has."""
    chain = at(SURGE_5, 5, amplitude=(2.0, 0.0, 0.0))
    texts = {}
    for hold in ("position", "mean", None):
        history = solve_time_domain(chain, dt=0.2, periods=2, hold=hold, allow_invalid=True)
        texts[hold] = next(text for text in history.warnings if text.startswith("drift"))
    assert texts["position"].endswith("of its excursion: use more nodes or a shorter dt")
    assert all(texts[hold].endswith('a shorter dt, or hold="position"') for hold in ("mean", None))


@pytest.mark.parametrize("nodes", [3, 5, 10, 20])
def test_drift_control_feeds_no_wave(nodes):
    """A millimetre of surge, in which nothing damps, for 20 periods: held, the end stays as near as it does free."""
    system = at(SURGE_5, nodes, amplitude=(1e-3, 0.0, 0.0))
    free, controlled = (
        solve_time_domain(system, dt=0.5, periods=20, hold=hold).drift().max() for hold in (None, "position")
    )
    assert controlled < 1.2 * free


# ---------------------------------------------------------------- a slack chain on a seabed
STILL = replace(SLACK_CHAIN, current=(0.0, 0.0, 0.0))
GROWTH = 1e-4  # of a frequency: a nearly double eigenvalue moves by the root of what rounding moves; measured 2e-5


def growth(chain, rest) -> float:
    """Largest rate at which a small wave about rest grows, over its frequency: eigenvalues by complex steps."""
    still = np.zeros_like(rest)
    units = np.eye(rest.size).reshape(-1, *rest.shape)
    y, rate = (
        np.array([chain.residual(*at(1e-30j * unit), 0.0).imag / 1e-30 for unit in units]).T
        for at in (lambda step: (rest + step, still + 0j), lambda step: (rest + 0j, still + step))
    )
    rates = eig(y, -rate, right=False)
    rates = rates[
        np.isfinite(rates) & (abs(rates) > 1e-3) & (abs(rates) < 1e6)
    ]  # rad/s: not the open places of the end
    return float((rates.real / abs(rates)).max())


GROUNDS = [(25, 8e3), (13, 1.6e4), (13, 1e5), (25, 1e5)]


@pytest.mark.parametrize(("nodes", "stiffness"), GROUNDS)
def test_no_wave_grows_on_a_seabed(nodes, stiffness):
    """Nothing drives a line at rest over a seabed, which has a potential: no small wave about it grows by itself."""
    chain = system(replace(STILL, seabed_stiffness=stiffness), nodes)
    assert growth(chain, chain.rest_state()) < GROWTH


LIMITED = Fault(
    "cable.equations",
    "CableEquations.support",
    "return seabed_support(self.seabed_stiffness, self.scene.environment.depth, z)",
    (
        "support, slope = seabed_support(self.seabed_stiffness, self.scene.environment.depth, z)\n"
        "return np.minimum(support, self.w0), np.where(support < self.w0, slope, 0.0)"
    ),
)


class ByNodes(CableSystem):
    """A planar line on a seabed whose support of a cell is the mean of those of its two nodes."""

    def cells(self, y, ydot, t, tangents=True):
        rows = super().cells(y, ydot, t, tangents)
        z, up, turned = y[4], np.array([np.cos(y[3]), -np.sin(y[3])]), np.array([-np.sin(y[3]), -np.cos(y[3])])
        (middle, middle_z), (support, slope) = self.support((z[1:] + z[:-1]) / 2), self.support(z)
        left, right, both = slice(None, -1), slice(1, None), up[:, 1:] + up[:, :-1]
        rows.value[:2] += (support * up)[:, left] + (support * up)[:, right] - middle * both
        for side, at in enumerate((left, right) if tangents else ()):
            rows.dy[side, :2, 3] += (support[at] - middle) * turned[:, at]
            rows.dy[side, :2, 4] += slope[at] * up[:, at] - middle_z / 2 * both
        return rows


def test_a_seabed_by_nodes_is_seen_to_feed_waves():
    """The mean of the supports of two nodes, one on the ground and one above, has no potential: a wave grows."""
    chain = system(replace(STILL, seabed_stiffness=1e5), 13)
    chain.__class__ = ByNodes
    assert growth(chain, chain.rest_state()) > 100 * GROWTH


SETTLES = 5e-3  # of the range: the last two of eight periods; measured 1.1e-3 at most
SINKS = 2.5  # depths w0/k of a line at rest, which a moving one exceeds; measured 1.9


def unsettled(of=None, hold="position", steps=100, case=SLACK_CHAIN):
    """(change of the fairlead tension between the seventh period and the eighth, deepest sinking in w0/k)."""
    chain = system(case, 25, **({"of": of} if of else {}))
    solve = of.time_domain.solve.solve_time_domain if of else solve_time_domain
    history = solve(chain, dt=chain.period / steps, periods=8, hold=hold)
    t = (7 + np.arange(100) / 100) * chain.period
    now, before = history.fairlead_tension(t), history.fairlead_tension(t - chain.period)
    sunk = (-case.depth - history.y[-1].min()) * case.seabed_stiffness / chain.w0
    return abs(now - before).max() / np.ptp(now), sunk


@pytest.mark.parametrize("steps", [100, 200])
@pytest.mark.parametrize("hold", ["position", "mean", None])
def test_a_slack_chain_on_a_seabed_settles(hold, steps):
    """On a coarse mesh, whatever the hold and the step: periodic after eight periods, and not sunk in the ground."""
    case = SLACK_CHAIN if steps == 100 else replace(SLACK_CHAIN, current=(0.4, 0.0, 0.0))
    change, sunk = unsettled(hold=hold, steps=steps, case=case)
    assert change < SETTLES and sunk < SINKS, (change, sunk)


def test_a_seabed_that_carries_the_weight_at_most_is_seen():
    """With the limit of statics the line sinks on, and what meets it there shakes it: both checks turn red."""
    with planted(LIMITED) as faulty:
        change, sunk = unsettled(faulty, case=STILL)
    assert change > SETTLES and sunk > SINKS, (change, sunk)


def test_a_hold_that_counts_cells_is_seen_to_feed_waves():
    """25 cells are no measure where each turns the line by ten degrees: the hold shakes the chain until it fails."""
    by_count = Fault(
        "cable.system",
        "CableSystem.drift_gain",
        "y = self.rest_state()",
        "return min(1.0, (self.nodes / 30) ** 2)\ny = self.rest_state()",
    )
    with planted(by_count) as faulty, pytest.raises(faulty.common.outcome.ConvergenceError):
        unsettled(faulty, steps=200, case=replace(SLACK_CHAIN, current=(0.4, 0.0, 0.0)))


@pytest.mark.parametrize(
    ("nodes", "stiffness", "surge"), [(10, 1e5, 3.0), (10, 1e5, 6.0), (25, 1e5, 6.0), (25, 1e6, 3.0)]
)
def test_steps_on_a_stiff_seabed(nodes, stiffness, surge):
    """A hundred steps a period over a seabed on which the line swings in a fifth of a second: every step is solved."""
    chain = at(OC3_SEABED, nodes, seabed_stiffness=stiffness, amplitude=(surge, 0.0, 0.0))
    history = solve_time_domain(chain, dt=chain.period / 100, periods=1)
    assert history.success and history.iterations < 8 * history.steps


def test_waves_that_nothing_damps_end_with_a_reason():
    """Steps of 2 ms at rho_inf = 1: the alternating wave of the box scheme grows from rounding; 0.9 damps it."""
    system = at(SURGE_5, 10, amplitude=(2.0, 0.0, 0.0))
    run = lambda rho: solve_time_domain(system, dt=2e-3, duration=10.0, rho_inf=rho, hold="mean", throw=False)
    failed = run(1.0)
    assert failed.status is Status.STEP_FAILED and failed.event is not None and "smaller rho_inf" in failed.status.value
    assert run(0.9).success


def test_a_motion_that_is_not_periodic_yet_is_warned_of():
    """Nearly undamped, the second period differs from the first; settled, the sixth does not from the fifth."""
    calm = at(SURGE_5, 20, amplitude=(0.5, 0.0, 0.0), Cdn=0.02)
    assert "periods" in warned(solve_time_domain(calm, dt=0.2, periods=2))
    assert "periods" not in warned(solve_time_domain(at(SURGE_5, 20), dt=0.2, periods=6))


def test_compression_between_two_steps_is_warned_of():
    """Positive at every step, the tension dips below zero between two by the rates there."""
    history = solve_time_domain(at(SURGE_5, 20, amplitude=(2.0, 0.0, 0.0)), dt=0.3, periods=1)
    rates = history.ydot.copy()
    rates[0, 4, 30:32] = np.array([-1.0, 1.0]) * 10 * history.y[0, 4, 30] / 0.3
    spoiled = replace(history, ydot=rates)
    assert history.tension.min() > 0 and "tension" in warned(spoiled) - warned(history)


def test_shortcomings_of_a_periodic_response_are_warned_of():
    """Too few harmonics, a mesh of three nodes, and no constant term."""
    system = at(SURGE_5, 20, amplitude=(2.0, 0.0, 0.0))
    assert "harmonics" in warned(solve_periodic(system, harmonics=3))
    assert "drift" in warned(solve_periodic(at(SURGE_5, 3, amplitude=(2.0, 0.0, 0.0)), harmonics=9))
    assert "mean" in warned(solve_periodic(system, harmonics=9, mean=False))


# ---------------------------------------------------------------- stiff integration
@pytest.fixture(scope="module")
def waves():
    """A line without drag and its axial waves: (system, eigenvalues, left and right vectors, dF/dydot)."""
    system = at(OC3, 12, Cdn=0.0)
    rest = system.rest_state()
    parts = [rows(rest, np.zeros_like(rest), 0.0) for rows in (system.start, system.cells, system.end)]
    A, B = (_matrix(*(getattr(part, name) for part in parts)) for name in ("dy", "dydot"))
    values, left, right = eig(A, -B, left=True)
    finite = np.isfinite(values) & (abs(values) < 1e9)
    return system, values[finite], left[:, finite], right[:, finite], B


def _matrix(start, cells, end):
    n_f, between = cells.shape[1], cells.shape[-1]
    matrix = np.zeros((n_f * (between + 1),) * 2)
    matrix[: len(start), :n_f], matrix[len(matrix) - len(end) :, -n_f:] = start, end
    for i in range(between):
        place = slice(len(start) + n_f * i, len(start) + n_f * (i + 1))
        matrix[place, n_f * i : n_f * (i + 2)] = np.hstack([cells[0, ..., i], cells[1, ..., i]])
    return matrix


def test_implicit_steps_pass_the_explicit_limit(waves):
    """Runge-Kutta grows just beyond its limit; the implicit method takes a thousand times that step and decays."""
    _, values, *_ = waves
    limit = 2.828 / abs(values).max()
    runge_kutta = lambda z: abs(1 + z + z**2 / 2 + z**3 / 6 + z**4 / 24)
    assert runge_kutta(0.99 * limit * values).max() < 1 + 1e-9 < runge_kutta(1.01 * limit * values).max()
    for radius in (0.0, 0.5, 1.0):
        scheme = Scheme.from_spectral_radius(radius)
        assert max(abs(scheme.amplification(1000 * limit * value)).max() for value in values) < 1 + 1e-9


@pytest.mark.parametrize("radius", [0.0, 0.5, 1.0])
def test_axial_waves_decay_by_the_spectral_radius(waves, radius):
    """A free axial wave, eight steps to its period, loses what the roots of the method say, by its printed weights."""
    measured, expected = _loss(waves, radius, radius)
    assert measured == pytest.approx(expected, abs=LINEAR)


def test_another_radius_would_be_seen(waves):
    """The check distinguishes spectral radius 0.6 from 0.5."""
    measured, expected = _loss(waves, 0.6, 0.5)
    assert abs(measured - expected) > 10 * LINEAR


def _loss(waves, radius, supposed, steps=8, settled=24, last=48):
    """Share that the first axial wave loses in a period: (measured, from the roots of the scheme supposed)."""
    system, values, left, right, B = waves
    axial = [k for k, v in enumerate(values) if v.imag > 6 and _lengthwise(right[:, k], system)]
    mode = min(axial, key=lambda k: values[k].imag)
    value, rest = values[mode], system.rest_state()
    shape = right[:, mode].reshape(system.nodes, -1).T
    shape = shape * (1e-3 * rest[0].max() / abs(shape[0]).max())
    dt = 2 * math.pi / abs(value) / steps
    options = {"rho_inf": radius, "hold": None, "tolerance": 1e-13}
    start = rest + shape.real, (value * shape).real
    history = solve_time_domain(system, dt=dt, duration=last * dt, start=start, **options)
    flat = (history.y - rest[..., None]).swapaxes(0, 1).reshape(rest.size, -1)
    result = abs(left[:, mode].conj() @ B @ flat)
    z, f = value * dt, 1 / (1 + supposed)
    a = (3 - supposed) / (2 + 2 * supposed)
    g = 0.5 + a - f  # Jansen, Whiting and Hulbert (2000)
    roots = np.roots(np.polymul([1, -1], [a, 1 - a]) - z * np.polymul([f, 1 - f], [g, 1 - g]))
    principal = abs(roots[abs(roots - np.exp(z)).argmin()])
    return 1 - (result[last] / result[settled]) ** (steps / (last - settled)), 1 - principal**steps


def _lengthwise(vector, system) -> bool:
    along, across = abs(vector.reshape(system.nodes, -1).T[1:3]).max(axis=1)
    return along > across


# ---------------------------------------------------------------- the checks themselves
def _spoil(result, name, index, factor):
    array = getattr(result, name).copy()
    array[index] *= factor
    return replace(result, **{name: array})


@pytest.mark.parametrize("factor", [1 + 1e-5, math.nan, -1.0])
def test_a_spoiled_success_is_found(factor):
    """A strain wrong by 1e-5, NaN or negative turns each check of a success red."""
    system = at(SURGE_5, 6)
    state = solve_static(system)
    history = solve_time_domain(system, dt=1.0, periods=1)
    response = solve_periodic(system, harmonics=3)
    scheme = Scheme.from_spectral_radius(0.5)
    for good, bad, check in (
        (state, _spoil(state, "y", (0, 2), factor), check_static),
        (history, _spoil(history, "y", (0, 2, 7), factor), lambda result: check_history(result, scheme)),
        (response, _spoil(response, "z", (0, 2, 0), 1 + 100 * (factor - 1)), check_response),
    ):
        check(good)
        with pytest.raises(AssertionError), np.errstate(all="ignore"):  # NaN among them
            check(bad)
    assert isinstance(system.motion, Motion)
