"""Are the multipliers of moving lines right? Natural modes, Mathieu's tongue, Hill's problem, and time integrations."""

from __future__ import annotations

import math
from functools import cache, partial
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.linalg import eig

from solvers import Element, Environment, Motion, Network, Node, Scene, mooring_system, solve_periodic
from solvers.common.properties import CableProperties
from solvers.harmonic_balance.residual import harmonic_residual
from solvers.mooring.linearised.monodromy import LinearisedPeriod
from solvers.numerics.modes import natural_modes
from solvers.stability import response_curve
from solvers.stability.curves.special_points import WANTED
from solvers.stability.multipliers.floquet import floquet
from solvers.stability.multipliers.hill import line_multipliers
from solvers.stability.multipliers.leading import FLOOR, LEAST, MAX_DENSE, RELATIVE, TOLERANCE, leading_eigenvalues
from solvers.stability.multipliers.monodromy import GAUSS, RADAU

from ..exact.oscillators import multipliers as exact
from ..tools.orders import assert_order

AT_REST = 1e-6  # 400 steps of sixth order in the first four modes; a drag of 1e-9 m of motion is less
STEP, DIFFERENCES = 1e-5, 1e-7  # m, a central difference, whose error is 1e-9 of the largest row
ROADS = 1e-8  # of smooth responses with 3 harmonics and 200 steps, which leave 3e-10
CHANGE = 0.01  # of the stiffness of the taut line
FIRST_ORDER = (
    0.005  # of the largest growth: a quarter of CHANGE is of second order; waves along the line are eleven times
)
# as fast as the motion, which makes 0.2 % of the tension
ENOUGH = 1e-5  # difference of the two methods where harmonics and steps are enough
LONGEST_TAIL = 1e-3  # of a multiplier whose series has a hundredth of its energy in its last two harmonics
MAP, MAP_STEP = 1e-4, 1e-3  # of a central difference of a period of time steps, with disturbances of 1 mm
SEABED_MAP, SEABED_STEP = 1e-5, 1e-4  # with 0.1 mm, in which no node meets the seabed at another step; measured 9e-7
WIDE = 0.25  # of an order that the drag's kinks disturb, one node after another
SMALL = 1e-5  # m, a disturbance that grows as its multiplier says; at 1e-7 m the time steps' own error is a thousandth
DECAY = 1e-4  # of a multiplier measured in time: the disturbance is small, and others have decayed; measured 4e-5
ARNOLDI = 100 * TOLERANCE  # of an eigenvalue, a few times the residual of its vector
RESTARTS = 1.25  # of the solves of Arnoldi's method, which restarts: measured 1.08, with its usual space 1.5
SMALL = 100 * RELATIVE  # of one below the least size, of its own size; likewise


def line(amplitude, frequency=0.05, cells=10, **options):
    """The line of OC3 in surge, m and Hz."""
    chain = CableProperties(EA=384.243e6, diameter=0.09, mass_per_length=77.7066, Cdn=1.6)
    surge = Motion.harmonic(frequency, (amplitude, 0.0, 0.0))
    scene = Scene("OC3", chain, 902.2, (0.0, 0.0, -320.0), (848.67, 0.0, -70.0), motion=surge)
    return mooring_system(scene, cells=cells, **options)


@cache
def response_of(amplitude, frequency=0.05, cells=10, harmonics=5):
    """The periodic response of ``line``."""
    return solve_periodic(line(amplitude, frequency, cells), harmonics=harmonics)


def bridle():
    """Two legs from a moving body to a joint, and a line from there to an anchor, with a current across."""
    cable = CableProperties(EA=5e7, diameter=0.08, mass_per_length=40.0, Cdn=1.2, Cdt=0.1, Ca=1.0, damping=0.02)
    water = Environment(current=(0.1, 0.4, 0.0))
    nodes = [Node("fixed", (0.0, 0.0, -100.0)), Node("free", (180.0, 0.0, -15.0), 500.0, 0.3),
             Node("coupled", (210.0, 15.0, -10.0)), Node("coupled", (210.0, -15.0, -10.0))]  # fmt: skip
    weight = cable.weight_in(water)
    ends = ((0, 1), 201.0), ((1, 2), 33.8), ((1, 3), 33.8)
    elements = [Element(weight, cable.EA, length, pair, cable=cable) for pair, length in ends]
    return mooring_system(Network(nodes, elements, water), cells=6, motion=Motion.harmonic(0.1, (1.0, 0.3, 0.5)))


# ---------------------------------------------------------------- a taut line
EA, MASS, LENGTH, TENSION, CELLS = 1e6, 1.0, 100.0, 2000.0, 10
SPEED = 0.02  # m/s, of a current up, in which the drag on sideways motion is linear
NATURAL = exact.string_frequency(EA, TENSION, MASS, LENGTH, CELLS)


def taut_line(change, omega, damping=0.0, **options):
    """A line without weight whose end moves along it: its stiffness across changes by cos(omega t) times ``change``.

    damping: rate c in 1/s of sideways motion, by the drag of the current.
    """
    diameter = 0.02
    drag = 2 * damping * MASS / (1000.0 * diameter * SPEED)
    cable = CableProperties(EA=EA, diameter=diameter, mass_per_length=MASS, submerged_weight=0.0, Cdn=drag)
    water = Environment(rho=1000.0, current=(0.0, 0.0, SPEED if damping else 0.0))
    amplitude = change / exact.stiffness_change(EA, TENSION, LENGTH, 1.0)
    motion = Motion.harmonic(omega / (2 * math.pi), (amplitude, 0.0, 0.0))
    end = (LENGTH * (1 + TENSION / EA), 0.0, 0.0)
    scene = Scene("taut", cable, LENGTH, (0.0, 0.0, 0.0), end, water, motion=motion)
    return mooring_system(scene, cells=CELLS, mesh="uniform", **options)


def growth_of(multipliers, period):
    """Rate of growth of the largest multiplier, 1/s."""
    return math.log(abs(multipliers[0])) / period


@pytest.mark.parametrize("detuning", [0.0, 0.1, -0.15])
@pytest.mark.parametrize("damping", [0.0, 0.002])
def test_sideways_growth_is_that_of_mathieu(detuning, damping):
    """Driven at twice the first sideways frequency: a negative multiplier, growing as in closed form of first order."""
    omega, damping = 2 * NATURAL * (1 + detuning * CHANGE), damping * NATURAL
    result = floquet(solve_periodic(taut_line(CHANGE, omega, damping), harmonics=3))
    expected = exact.parametric_growth(omega, NATURAL, CHANGE, damping).real
    assert result.sideways[0].real < -1 and not result.stable and result.constraints == 0
    largest = exact.parametric_growth(2 * NATURAL, NATURAL, CHANGE).real
    assert growth_of(result.sideways, result.period) == pytest.approx(expected, abs=FIRST_ORDER * largest)
    assert result.difference <= ROADS
    if not damping:  # without a current both directions across are alike
        assert abs(result.sideways[:, None] - result.multipliers).min(axis=1).max() <= ROADS


@pytest.mark.parametrize("detuning", [0.0, 0.2])
def test_sideways_threshold_is_that_of_mathieu(detuning):
    """With linear damping the amplitude at which sideways motion sets in: stable below, unstable above."""
    damping = 0.01 * NATURAL
    omega = 2 * NATURAL * (1 + 0.02 * detuning)
    threshold = exact.parametric_threshold(omega, NATURAL, damping)
    for factor in (1 - 2 * FIRST_ORDER, 1 + 2 * FIRST_ORDER):
        result = floquet(solve_periodic(taut_line(factor * threshold, omega, damping), harmonics=3), method="monodromy")
        assert (abs(result.sideways[0]) > 1) == (factor > 1)
        assert abs(result.multipliers[0]) < 1  # in the plane the drag of the current is twice as large


def test_sideways_growth_is_that_of_time_integration():
    """The line in space, pushed sideways by 1e-6 m, grows as the planar response's sideways multiplier says."""
    change, steps, periods = 0.15, 200, 30
    planar = solve_periodic(taut_line(change, 2 * NATURAL), harmonics=5)
    expected = floquet(planar, method="monodromy").sideways[0].real
    system = taut_line(change, 2 * NATURAL, fields="spatial")
    y, ydot = (np.insert(part(np.zeros(1))[..., 0], 1, 0.0, axis=0) for part in (planar.at, planar.rate_at))
    y[1, 1:-1] = 1e-6 * np.sin(math.pi * np.arange(1, CELLS) / CELLS)
    history = system.integrate(dt=planar.last_period[1] / steps, count=periods * steps, rho_inf=1.0, tolerance=1e-10,
                               step_tolerance=None, ramp=0.0, start=(y, ydot), every=steps)  # fmt: skip
    sideways = history.y[1, CELLS // 2]
    assert sideways[-1] / sideways[-2] == pytest.approx(expected, abs=DECAY)


@pytest.mark.parametrize(("scheme", "order", "ceiling"), [("radau", 5.0, 1e-7), ("gauss", 6.0, 1e-10)])
def test_steps_are_of_their_order(scheme, order, ceiling):
    """The multipliers of the first modes of the taut line fall with the power of the step that the scheme promises."""
    response = solve_periodic(taut_line(0.1, 2 * NATURAL), harmonics=4)
    schemes = {"radau": RADAU, "gauss": GAUSS}
    value = lambda count: leading_eigenvalues(response.linearised_period(count, schemes[scheme], True)).values[0]
    limit, steps = value(1600), [10, 20, 40]
    errors = [abs(value(count) - limit) for count in steps]
    assert_order([1 / count for count in steps], errors, order, ceiling=ceiling)


def test_gauss_damps_nothing_of_a_line_that_nothing_damps():
    """Outside the tongue all multipliers of the undamped taut line have size one with few steps, and not by Radau."""
    response = solve_periodic(taut_line(0.02, 1.5 * NATURAL), harmonics=3)
    gauss, radau = (floquet(response, method="monodromy", scheme=name, steps=50) for name in ("gauss", "radau"))
    assert abs(abs(gauss.multipliers) - 1).max() <= AT_REST
    assert abs(radau.multipliers).min() < 0.1
    assert radau.step_errors[:2].max() < 1e-3 < radau.step_errors.max()


# ---------------------------------------------------------------- lines and networks in water
def test_a_line_at_rest_swings_in_its_natural_modes():
    """Nearly at rest drag damps nothing: all multipliers lie on the unit circle, the slow ones at exp(i omega T)."""
    system = line(1e-9, 0.2)
    result = floquet(solve_periodic(system, harmonics=6), steps=400, scheme="gauss")
    assert result.multipliers.size == 2 * 2 * 9
    assert abs(abs(result.multipliers) - 1).max() <= AT_REST
    modes = np.exp(2j * np.pi * natural_modes(system).frequencies[:4] * system.period)
    for multipliers in (result.multipliers, result.hill):
        assert abs(multipliers[:, None] - modes).min(axis=0).max() <= AT_REST


def test_drag_damps_every_disturbance_of_a_moving_line():
    """In 3 m of surge the line is stable, its slowest wave damped by far more than the scheme could add."""
    result = floquet(response_of(3.0), steps=400, scheme="gauss")
    assert result.stable and abs(result.multipliers).max() < 0.99


def test_hill_and_monodromy_agree_on_a_line_in_small_motion():
    """In 2 mm of surge, with 25 harmonics and 1600 steps; each fails with fewer of its own."""
    responses = {harmonics: response_of(0.002, 0.2, harmonics=harmonics) for harmonics in (9, 25)}
    settings = (25, 1600), (9, 1600), (25, 400)
    both, few_harmonics, few_steps = (floquet(responses[count], steps=steps) for count, steps in settings)
    assert both.hill.size >= 20 and both.difference <= ENOUGH
    assert few_harmonics.difference > 2 * ENOUGH and few_steps.difference > 5 * ENOUGH


def test_series_that_are_too_short_do_not_count():
    """With two harmonics the slow modes have their energy in these: Hill's problem of the line says nothing."""
    result = floquet(response_of(0.002, 0.2, harmonics=2), steps=50)
    assert result.hill is None and result.difference is None


def test_hill_and_monodromy_agree_on_a_bridle():
    """A network with a joint, in space: both methods find the same multipliers but for the shortest waves."""
    result = floquet(solve_periodic(bridle(), harmonics=20), steps=1600)
    distance = abs(result.hill[:, None] - result.multipliers).min(axis=1)
    assert result.sideways is None and (distance <= ENOUGH).sum() >= 12
    assert result.difference <= LONGEST_TAIL


@pytest.mark.parametrize("system", [line(3.0), bridle()], ids=["line", "bridle"])
def test_hills_problem_is_the_derivative_of_the_rows(system):
    """J, D and M on a disturbance: differences of the rows of the balance, and of series that grow."""
    response, free = solve_periodic(system, harmonics=5), ~system.order.is_prescribed
    problem, basis = response.hill_problem(), response.basis
    assert floquet(response, method="hill").constraints == 0
    dz = np.random.default_rng(6).normal(size=problem.shape)
    dz[~free] = 0.0
    residual = harmonic_residual(system, basis)
    rows = lambda z: residual.residual(residual.pack(z))[free]
    change = STEP * residual.unpack(dz.reshape(system.nodes, -1))
    expected = (rows(response.z + change) - rows(response.z - change)) / (2 * STEP)
    along = lambda blocks, x: problem.multiply(blocks, x.reshape(system.nodes, -1))[free]
    assert abs(along(problem.J, dz) - expected).max() <= DIFFERENCES * abs(expected).max()
    # exp(mu t) z(t) with mu = i omega is the series one harmonic on: J + mu D + mu^2 M there is J on that series
    mu, z = 1j * basis.omega, np.zeros(problem.shape, dtype=complex)
    z[..., 0], on = dz[..., 0], np.zeros(problem.shape, dtype=complex)
    on[..., 1], on[..., 2] = 1j * dz[..., 0] / math.sqrt(2), dz[..., 0] / math.sqrt(2)
    still = lambda x: along(problem.J, x) + mu * along(problem.D, x) + mu**2 * (problem.M @ x.reshape(
        system.nodes, -1, 1))[free, :, 0]  # fmt: skip
    shifted = along(problem.J, on).reshape(free.sum(), *problem.shape[1:])
    mean = shifted[..., 1:3] @ np.array([-1j, 1.0]) / 2  # the part with exp(i omega t), which is the mean of the other
    assert abs(still(z).reshape(shifted.shape)[..., 0] / math.sqrt(2) - mean).max() <= DIFFERENCES * abs(mean).max()


def test_leading_eigenvalues_are_those_of_the_whole_matrix():
    """Of 30 cells in 3 m of surge block Arnoldi finds every multiplier above the floor, in the plane and across it."""
    response = response_of(3.0, cells=30)
    for sideways in (False, True):
        period = response.linearised_period(100, RADAU, sideways)
        eigenvalues = np.linalg.eigvals(period.apply(np.eye(period.size)))
        leading = leading_eigenvalues(period).values
        if not sideways:
            assert MAX_DENSE < period.size and leading.size < period.size / 2
        assert (abs(eigenvalues) >= FLOOR).sum() == (abs(leading) >= FLOOR).sum() >= 4
        assert abs(leading[:, None] - eigenvalues).min(axis=1).max() <= ARNOLDI


def test_hills_multipliers_above_the_floor_are_returned():
    """Of 40 exponents of a known pencil those above the floor, and of one motion those with the most central series."""
    omega, sizes = 0.7, np.full(40, 1e-9)
    sizes[:9] = 0.9, 0.5, 0.02, 1.5 * FLOOR, 0.8 * FLOOR, 0.3, 0.3, 0.25, 0.25
    pencil = np.diag(omega / (2 * math.pi) * np.log(sizes))
    for i, frequency in ((5, 0.6), (7, 0.4)):  # times omega: the first pair is that of another harmonic
        pencil[i, i + 1], pencil[i + 1, i] = frequency * omega, -frequency * omega
    series = lambda modes: np.concatenate([modes[:, None], np.zeros((40, 6, modes.shape[1]))], axis=1)
    inverse = lambda sigma: partial(np.linalg.solve, sigma * np.eye(40) - pencil)
    got = line_multipliers(SimpleNamespace(size=40, inverse=inverse, series=series), omega)
    pair = 0.25 * np.exp(0.8j * math.pi * np.array([1, -1]))
    wanted = np.concatenate([sizes[:2], pair, sizes[2:4]])
    assert got.size == 6 and abs(got[:, None] - wanted).min(axis=0).max() <= 1e-8


def test_few_that_count_take_few_disturbances():
    """Of 400 eigenvalues of which 5 are above the floor these are returned, after some blocks and not half of all."""
    sizes, taken = np.full(400, 1e-7), []
    sizes[:5] = 0.9, -0.5, 0.3, 0.1, 0.01
    period = SimpleNamespace(size=400, columns=12, apply=lambda x: taken.append(x.shape[1]) or sizes[:, None] * x)
    assert leading_eigenvalues(period).values[:5] == pytest.approx(sizes[:5], abs=ARNOLDI)
    assert sum(taken) <= 4 * period.columns


@pytest.mark.parametrize(("turn", "listed"), [(0.0, 6), (0.25, 7)], ids=["real", "pair"])
def test_eigenvalues_that_follow_the_wanted_ones_are_whole_pairs(turn, listed):
    """Six are returned where five are wanted, or seven where the sixth has a conjugate."""
    matrix = np.diag([0.9, 0.8, 0.7, 0.6, 0.5, 0.3, 0.3 if turn else 0.2, *[1e-9] * 393])
    matrix[5, 6], matrix[6, 5] = turn, -turn
    values = leading_eigenvalues(SimpleNamespace(size=400, columns=12, apply=lambda x: matrix @ x), 0.45).values
    assert values.size == listed and values[:5] == pytest.approx(np.diag(matrix)[:5], abs=ARNOLDI)
    assert abs(values[5:].imag) == pytest.approx([turn] * (listed - 5), abs=ARNOLDI)


@pytest.mark.parametrize(("amplitude", "sideways"), [(2.0, False), (3.0, False), (3.0, True)])
def test_eigenvalues_from_a_larger_size_on_are_the_largest(amplitude, sideways):
    """Of 90 cells with a least size of 0.1: all from there on, at least the first, and no gap in those that follow."""
    period = response_of(amplitude, cells=90).linearised_period(100, RADAU, sideways)
    eigenvalues = np.linalg.eigvals(period.apply(np.eye(period.size)))
    sizes = np.sort(abs(eigenvalues))[::-1]
    leading, residuals = leading_eigenvalues(period, WANTED)
    wanted = int((sizes >= WANTED).sum())
    assert max(1, wanted) <= leading.size <= max(wanted, LEAST) + 1 < period.size / 4
    allowed = np.where(abs(leading) >= WANTED, ARNOLDI, SMALL * abs(leading))
    assert (abs(leading[:, None] - eigenvalues).min(axis=1) <= allowed).all()
    assert (abs(abs(leading) - sizes[: leading.size]) <= allowed).all()
    assert (residuals <= allowed).all()


def test_the_periods_of_a_point_do_not_grow_with_the_cells(monkeypatch):
    """Disturbances that take a period for a point of a curve: on 400 cells no more than on 100, most of them few."""
    apply, columns = LinearisedPeriod.apply, []
    monkeypatch.setattr(LinearisedPeriod, "apply", lambda self, x: (columns.append(x.shape[1]), apply(self, x))[1])
    counts = []
    for cells in (100, 400):
        curve = response_curve(line(2.0, cells=cells), start=0.05, stop=0.06, harmonics=9, max_points=1,
                               stability=True, throw=False)  # fmt: skip
        assert curve.stable.tolist() == [True] and abs(curve.multipliers[0]).max() == pytest.approx(0.605, abs=0.01)
        counts.append(sum(columns))
        columns.clear()
    assert counts[1] <= counts[0] < 400


def test_the_solves_of_hills_problem_do_not_grow_with_the_cells():
    """Solves of the shifted pencil on 200 cells are those on 25, but for what Arnoldi's restarts vary."""
    counts = []
    for cells in (25, 200):
        problem, count = response_of(2.0, cells=cells, harmonics=9).hill_problem(), 0

        def inverse(sigma, of=problem.inverse):
            apply = of(sigma)

            def solve(x):
                nonlocal count
                count += 1
                return apply(x)

            return solve

        problem.inverse = inverse
        line_multipliers(problem, 2 * np.pi * 0.05, WANTED)
        counts.append(count)
    assert counts[1] <= RESTARTS * counts[0]


def test_where_little_is_damped_all_are_returned():
    """In 0.3 m of surge most multipliers are above the floor: the whole matrix is taken, and none is lost."""
    response = response_of(0.3, 0.1, cells=30)
    period = response.linearised_period(100, RADAU)
    eigenvalues = np.linalg.eigvals(period.apply(np.eye(period.size)))
    leading = leading_eigenvalues(period).values
    assert leading.size == eigenvalues.size and abs(leading[:, None] - eigenvalues).min(axis=0).max() <= ARNOLDI


# ---------------------------------------------------------------- the time steps themselves
def derivative_error(orbit, step, count):
    """Return the largest error of the linearised period over ``count`` random disturbances, relative to their size.

    Against central differences of a period of time steps; step: of the disturbances in m and m/s.
    """
    period, rng, errors = orbit.linearised(), np.random.default_rng(3), []
    for _ in range(count):
        disturbance = step * rng.normal(size=period.size)
        ends = [orbit.take_period(orbit.state + s * period.unpack(disturbance))[0] for s in (1, -1)]
        change = period.pack(ends[0] - ends[1]) / 2
        predicted = period.apply(disturbance[:, None])[:, 0]
        errors.append(np.linalg.norm(change - predicted) / np.linalg.norm(disturbance))
    return max(errors)


def test_the_linearised_steps_are_the_derivative_of_the_steps():
    """A period of time steps from disturbed states: central differences, of a line with slack cells and of a bridle."""
    for response in (response_of(5.0, 0.093), solve_periodic(bridle(), harmonics=5)):
        orbit = response.stepped_orbit(100)
        assert orbit.is_periodic
        assert derivative_error(orbit, MAP_STEP, count=2) <= MAP
        ones = np.ones_like(orbit.state)
        for i, size in ((0, 1.0), (1, orbit.period / (2 * math.pi))):  # m and m/s, over the amplitude
            change = ones * (np.arange(4) == i)[:, None, None]
            assert orbit.measure(change) * abs(response.z).max() == pytest.approx(size, rel=1e-14)


def test_steps_that_damp_less_have_their_derivative(monkeypatch):
    """With all four numbers of generalized-alpha different from those of the steps over slack cells."""
    monkeypatch.setattr("solvers.mooring.linearised.stepped_orbit.RHO_INF", 0.6)
    orbit = solve_periodic(bridle(), harmonics=5).stepped_orbit(100)
    assert orbit.is_periodic and all(0 < abs(number) != 1 for number in orbit.scheme)
    assert derivative_error(orbit, MAP_STEP, count=1) <= MAP


def test_steps_over_a_damped_seabed_have_their_derivative():
    """Nodes leave a seabed with damping and meet it again, where its force jumps: the tangents of the steps hold."""
    chain = CableProperties(EA=384.243e6, diameter=0.09, mass_per_length=77.7066, Cdn=1.6, Cdt=0.05, Ca=1.0,
                            submerged_weight=698.094, damping=0.05)  # fmt: skip
    sea = Environment(depth=60.0, seabed_stiffness=5e3, seabed_damping=50.0)
    surge = Motion.harmonic(1 / 12, (2.0, 0.0, 0.0))
    scene = Scene("chain", chain, 665.0, (-655.2, 0.0, -60.0), (-5.2, 0.0, -10.0), sea, motion=surge)
    orbit = solve_periodic(mooring_system(scene, cells=12), harmonics=5).stepped_orbit(100)
    on_seabed = orbit.record[0][:, :, -1] < orbit.system.line.floor
    assert orbit.is_periodic and (np.diff(on_seabed.astype(int), axis=0) != 0).any()
    assert derivative_error(orbit, SEABED_STEP, count=3) <= SEABED_MAP


@pytest.mark.parametrize(
    ("amplitude", "frequency", "steps", "expected"), [(5.0, 0.093, 400, -0.95232), (10.0, 0.05, 800, -2.62763)]
)
def test_disturbances_over_slack_cells_follow_their_multiplier_in_time(amplitude, frequency, steps, expected):
    """A motion with slack cells that settles and one that time steps leave, each at the rate of its multiplier."""
    response = response_of(amplitude, frequency)
    result = floquet(response, steps=steps)
    assert result.by_time_steps and result.multipliers[0].real == pytest.approx(expected, abs=DECAY)
    assert result.constraints == 0
    assert result.stable == (abs(expected) < 1)
    orbit = response.stepped_orbit(steps)
    period, state = orbit.linearised(), orbit.state
    values, left, right = eig(period.apply(np.eye(period.size)), left=True)
    first = abs(values).argmax()
    disturbance = SMALL * period.unpack(right[:, first].real / abs(right[:, first]).max())
    ends, sizes = [state + disturbance, state - disturbance], []
    for _ in range(3):
        ends = [orbit.take_period(end)[0] for end in ends]
        sizes.append(left[:, first].real @ period.pack(ends[0] - ends[1]))
    assert sizes[2] / sizes[1] == pytest.approx(expected, abs=DECAY)


def test_multipliers_of_a_ringing_series_are_those_of_another_motion():
    """Five harmonics over slack cells: those of the series are above five, of the motion of the time steps none is.

    The series has several solutions near each other; this one is that which a solve from rest converges to.
    """
    response = solve_periodic(line(5.0, 0.093), harmonics=5, multilevel=False)
    of_series = leading_eigenvalues(response.linearised_period(200, RADAU)).values
    assert abs(of_series[0]) > 5 and floquet(response).stable


def test_a_motion_that_time_steps_do_not_repeat_is_said():
    """With 800 steps the same line has no motion of that period near: the result says what its multipliers are."""
    result = floquet(response_of(5.0, 0.093), steps=800)
    assert not result.by_time_steps and "repeat no motion" in result.warnings[0]


def test_slow_multipliers_of_the_time_steps_are_of_second_order():
    """Without slack: the slowest sideways multiplier tends to its limit with the square of the step."""
    response = response_of(3.0)
    slowest = lambda steps: leading_eigenvalues(response.stepped_orbit(steps).linearised(sideways=True)).values[0].real
    values = [slowest(steps) for steps in (200, 400, 800)]
    assert_order([2.0, 1.0], np.diff(values), 2.0, ceiling=2e-5, band=WIDE)
    result = floquet(response, method="steps", steps=400)
    assert result.by_time_steps and result.sideways[0].real == values[1]
