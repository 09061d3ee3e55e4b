"""Is the periodic response of a moving line the one that its equations have, and do results warn where they must?"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

from solvers import InputError, Motion, Status, mooring_system, solve_periodic, solve_time_domain
from solvers.harmonic_balance.start import history_coefficients
from solvers.mooring import diagnostics
from solvers.mooring.periodic import harmonic, iterative_harmonics
from solvers.numerics.fourier import Basis, project_samples, sample_series
from solvers.numerics.lu.block_elimination import BlockFactors

from ..cases import networks as cases
from ..cases.cables import EVERYTHING, OC3, OC3_SEABED, SURGE_5
from ..exact.mooring.moving_line import ALL_TERMS
from ..tools.orders import assert_order, extrapolated
from .networks import case_network
from .problems import build, exact_load, exact_state, manufactured, scene
from .test_order import graded
from .test_statics import NETWORKS

SPATIAL = pytest.mark.parametrize("planar", [True, False], ids=["planar", "spatial"])
SOLVED = 1e-9  # m: the last Newton step of 1e-10; measured 2e-12


def periodic_errors(line, cells, exact_on_mesh):
    """Return the largest error of the positions over a period, m, of a manufactured motion of two harmonics."""
    system = manufactured(line, cells)
    if exact_on_mesh:
        system.source = lambda t: exact_load(system, line, t)
    response = solve_periodic(system, harmonics=3 if exact_on_mesh else 6)
    times = np.linspace(0.0, system.period, 9)
    exact = np.stack([exact_state(system, line, t)[0] for t in times], axis=-1)
    assert abs(response.rate_at(times)[:, -1] - line.velocity(line.length, times)).max() < 1e-9
    return abs(response.at(times) - exact).max()


@SPATIAL
def test_a_motion_of_two_harmonics_comes_out(planar):
    """With the load that makes it exact on the mesh, positions are those of the motion at all times."""
    assert periodic_errors(replace(ALL_TERMS, planar=planar), 6, True) <= SOLVED


@SPATIAL
def test_order_in_ds(planar):
    """With the load of the continuous line the error falls with ds^2."""
    line, cells = replace(ALL_TERMS, planar=planar), (16, 32, 64)
    errors = [periodic_errors(line, count, False) / line.length for count in cells]
    assert_order([1 / c for c in cells], errors, 2, ceiling=2e-4, what="periodic, ds")


@pytest.mark.parametrize("case", [SURGE_5, EVERYTHING], ids=lambda case: case.name)
def test_jacobian_blocks_are_differences_of_the_rows(case):
    """The Jacobian, its tensions condensed, takes a small change of the unknowns to the change of the rows."""
    system = build(case, 6, calibrate=False)
    rows = system.harmonic_residual(Basis(4, 16, 2 * np.pi / system.period, True), None)
    rng, (nodes, n, count) = np.random.default_rng(5), rows.shape
    x = rows.pack(rng.normal(0, 0.02, (n, nodes, count)))
    rows.auxiliary = np.ones(rows.auxiliary.shape)
    _, T, _, samples = rows.evaluate(x)
    assert T.min() > 0
    rows.auxiliary = T
    diagonal, right, left = rows.jacobian(samples, rows.auxiliary)
    step = rng.normal(0, 1.0, x.shape)
    got = np.einsum("nij,nj->ni", diagonal, step)
    got[:-1] += np.einsum("nij,nj->ni", right, step[1:])
    got[1:] += np.einsum("nij,nj->ni", left, step[:-1])
    h = 1e-7
    difference = (rows.evaluate(x + h * step)[0] - rows.evaluate(x - h * step)[0]) / (2 * h)
    assert abs(got - difference).max() <= 1e-6 * abs(difference).max()


@pytest.mark.parametrize("case", [SURGE_5, EVERYTHING], ids=lambda case: case.name)
def test_tensions_of_a_step_are_predicted_to_second_order(case):
    """Auxiliary tensions after a step are those of the law but for the square of the step."""
    system, errors = build(case, 6, calibrate=False), []
    rows = system.harmonic_residual(Basis(4, 16, 2 * np.pi / system.period, True), None)
    rng, (nodes, n, count) = np.random.default_rng(6), rows.shape
    x, step = rows.pack(rng.normal(0, 0.02, (n, nodes, count))), rng.normal(0, 1.0, (nodes, n * count))
    for h in (1e-4, 5e-5):
        rows.initial = None
        rows.linearise(x)  # where the prediction begins
        assert rows.last_linearisation[1].min() > 0
        rows.linearise(x + h * step)
        exact = rows.last_linearisation[1]
        errors.append(abs(rows.auxiliary - exact).max() / exact.max())
    assert_order([1e-4, 5e-5], errors, 2, ceiling=1e-6, what="auxiliary tensions")


def test_factors_are_in_double_precision_where_many_are_needed():
    """The first three linearisations solve to single precision, which Newton's method mends, the next to double."""
    system = build(SURGE_5, 8, calibrate=False)
    rows = system.harmonic_residual(Basis(6, 24, 2 * np.pi / system.period, True), None)
    x = 0.01 * np.random.default_rng(4).normal(size=(system.nodes, rows.n * rows.shape[2]))
    solves = [rows.linearise(x)[1] for _ in range(4)]
    F, line = rows.linearise(x)[0], system.line
    wanted = BlockFactors(system.order, line.first, line.last, *rows.jacobian(rows.samples(x), rows.auxiliary)).solve(F)
    errors = [abs(solve(F) - wanted).max() / abs(wanted).max() for solve in solves]
    assert 1e-9 < min(errors[:3]) and max(errors[:3]) < 1e-2 and errors[3] < 1e-9


@pytest.mark.parametrize(("Cdn", "periods"), [(SURGE_5.Cdn, [2]), (0.0, [2, 3])], ids=["damped", "undamped"])
def test_a_start_that_does_not_settle_takes_one_more_period(Cdn, periods, monkeypatch):
    """Two periods in time where the second ends as the first did, else three; all their Newton steps are told."""
    taken, steps = [], []

    def integrate(system, **settings):
        taken.append(settings["duration"] / system.period)
        history = solve_time_domain(system, **settings)
        steps.append(history.iterations)
        return history

    monkeypatch.setattr(harmonic, "solve_time_domain", integrate)
    system = build(replace(SURGE_5, Cdn=Cdn), 8, calibrate=False)
    z, iterations = system.periodic_start(Basis(4, 16, 2 * np.pi / system.period, True))
    assert taken == pytest.approx(periods) and abs(z[:, -1]).max() == pytest.approx(5.0, rel=1e-3)
    assert iterations == sum(steps) > 0


def test_starts_are_as_fine_as_slack_and_touchdown_need(monkeypatch):
    """A line in deep water starts from a coarse integration; one over a seabed and networks from the usual one."""
    given, failed = [], SimpleNamespace(success=False, iterations=0)
    monkeypatch.setattr(harmonic, "solve_time_domain", lambda system, **settings: given.append(settings) or failed)
    motion = Motion.harmonic(0.1, (0.0, 0.0, 1.0))
    bridles = mooring_system(case_network(cases.bridle_system()), 4, motion=motion)
    lying = replace(OC3_SEABED, amplitude=(5.0, 0.0, 0.0))
    for system in (build(SURGE_5, 8), build(lying, 8), bridles):
        assert not system.periodic_start(Basis(4, 16, 2 * np.pi / system.period, True))[0].any()
    assert [one["tolerance"] for one in given] == [harmonic.START_TOLERANCE, None, None]


def test_coarser_lines_are_kept_and_take_the_motion():
    """Their rest is solved for once; with another motion of the line they have it, too."""
    system, motion = build(SURGE_5, 12), Motion.harmonic(0.1, (0.0, 0.0, 1.0))
    coarse = system.coarser()[0]
    coarse.rest_state()
    assert system.coarser()[0] is coarse and coarse.nodes == 7
    other = system.with_motion(motion).coarser()[0]
    assert other.motion is motion and other.rest is coarse.rest and coarse.motion is system.motion


def test_the_response_is_what_motions_in_time_settle_to():
    """The tension over a period is that of the eighth period in time, extrapolated in the step."""
    system, t = build(SURGE_5, 12, calibrate=False), np.linspace(0.0, 20.0, 200)
    response = solve_periodic(system, harmonics=45)
    runs = [
        solve_time_domain(system, dt=dt, periods=8, tolerance=1e-7).fairlead_tension(140 + t) for dt in (0.025, 0.0125)
    ]
    limit = extrapolated((2, 1), runs)
    assert abs(response.fairlead_tension(t) - limit).max() <= 5e-4 * np.ptp(limit)  # measured 2.4e-4
    assert abs(response.r[:, -1] - np.array(SURGE_5.fairlead)[:, None]
               - system.motion.displacement(response.time)).max() < 1e-9  # fmt: skip


def test_end_forces_are_extrapolated():
    """With a correction the error of the cells is a part of what it was, and the response of half as many is there."""
    t = np.linspace(0.0, 20.0, 100)
    fine = solve_periodic(build(SURGE_5, 160, mesh="uniform", calibrate=False), harmonics=8).fairlead_tension(t)
    plain = solve_periodic(build(SURGE_5, 20, mesh="uniform", calibrate=False), harmonics=8)
    better = solve_periodic(build(SURGE_5, 20, mesh="uniform", calibrate=False), harmonics=8, deferred_correction=True)
    errors = [abs(one.fairlead_tension(t) - fine).max() for one in (plain, better)]
    assert errors[1] < errors[0] / 3 and better.coarse.system.nodes == 11


@pytest.mark.parametrize("name", ["buoy", "clump weight"])
def test_a_line_of_several_materials_moves_periodically(name):
    """Joints with mass: the response is that in time, on the same mesh."""
    system = mooring_system(NETWORKS[name], 12, motion=Motion.harmonic(0.1, (1.0, 0.0, 0.5)), calibrate=False)
    response, t = solve_periodic(system, harmonics=12), np.linspace(0, 10.0, 50)
    history = solve_time_domain(system, dt=0.02, periods=25)
    tension = history.fairlead_tension(240 + t)
    assert abs(response.fairlead_tension(t) - tension).max() <= 2e-3 * np.ptp(tension)


def test_an_extrapolation_of_three_cells_is_refused():
    """A mesh of three cells has none of half as many."""
    with pytest.raises(InputError) as caught:
        solve_periodic(build(SURGE_5, 3), harmonics=3, deferred_correction=True)
    assert caught.value.field == "deferred_correction"


# ---------------------------------------------------------------- without blocks
BRIDLES = "three bridles"  # a network in three axes with joints, whose elimination fills in
HEAVED = {
    "line": lambda: build(EVERYTHING, 8, calibrate=False),
    "seabed": lambda: mooring_system(
        replace(scene(replace(OC3_SEABED, amplitude=(5.0, 0.0, 0.0))), friction=(0.5,)), 12),
    BRIDLES: lambda: mooring_system(
        case_network(cases.bridle_system()), 4, motion=Motion.harmonic(0.05, (1.0, 0.0, 0.5))),
}  # fmt: skip


@pytest.mark.parametrize("mean", [True, False])
@pytest.mark.parametrize("samples", [9, 24])
def test_fast_transforms_are_the_functions(samples, mean):
    """A series, its derivatives and the coefficients of samples, from FFT and from the functions of the basis."""
    basis, rng = Basis(4, samples, 0.7, mean), np.random.default_rng(2)
    z, f = rng.normal(size=(5, basis.harmonic.size)), rng.normal(size=(samples, 5))
    q, q_t = basis.functions(basis.times)
    wanted = np.stack([z @ part.T for part in (q, q_t, -q * (0.7 * basis.harmonic) ** 2)]).swapaxes(1, 2)
    assert abs(sample_series(basis, z, 3) - wanted).max() <= 1e-13 * abs(wanted).max()
    assert abs(project_samples(basis, f) - f.T @ basis.P).max() <= 1e-13


def iterative_rows(name, harmonics):
    """Return the rows of a case of HEAVED for GMRES at a start from time, its x, rows and Newton's step."""
    system = HEAVED[name]()
    basis = Basis(harmonics, 8 * harmonics, 2 * np.pi / system.period, True)
    rows = iterative_harmonics.IterativeHarmonics(system, basis)
    x = rows.pack(system.periodic_start(basis)[0])
    F, solve = rows.linearise(x)
    return rows, x, F, solve


@pytest.mark.parametrize("name", HEAVED)
def test_steps_without_blocks_are_those_of_the_blocks(name, monkeypatch):
    """With an accuracy that leaves nothing, prescribed nodes that are to move among them."""
    monkeypatch.setattr(iterative_harmonics, "ACCURACY", 1e-11)
    rows, x, F, solve = iterative_rows(name, 6)
    F = F + np.random.default_rng(8).normal(0, 0.01, F.shape) * abs(F).max()
    line = rows.system.line
    exact = BlockFactors(
        rows.system.order, line.first, line.last, *rows.jacobian(rows.samples(x), rows.auxiliary)
    ).solve(F)
    assert abs(exact[rows.system.prescribed_nodes]).max() > 0
    assert abs(solve(F) - exact).max() <= 1e-7 * abs(exact).max()  # measured 2e-9, with condition numbers of 1e4


def test_time_steps_tend_to_the_inverse_of_the_jacobian(monkeypatch):
    """About rest harmonics do not couple, and of low ones the steps have an error of second order, until it repeats."""
    monkeypatch.setattr(iterative_harmonics, "PERIODS", 40)
    system, errors = HEAVED["line"](), []
    for samples in (100, 200):
        rows = iterative_harmonics.IterativeHarmonics(system, Basis(3, samples, 2 * np.pi / system.period, True))
        F = np.random.default_rng(6).normal(size=(system.nodes, rows.n * rows.shape[2]))
        F[system.prescribed_nodes] = 0.0
        rows.linearise(0 * F)  # which sets the tensions at the samples
        newton, line = iterative_harmonics.SampledNewton(rows, rows.samples(0 * F), rows.auxiliary), system.line
        exact = BlockFactors(
            system.order, line.first, line.last, *rows.jacobian(rows.samples(0 * F), rows.auxiliary)
        ).solve(F)
        errors.append(np.linalg.norm(newton.precondition(F) - exact) / np.linalg.norm(exact))
    assert errors[1] <= 3e-3 and errors[1] < errors[0] / 3.5  # measured 1.6e-3 and a fourth


@pytest.mark.parametrize(("name", "harmonics"), [("seabed", 80), (BRIDLES, 40)])
def test_time_steps_leave_little_to_gmres(name, harmonics, monkeypatch):
    """With many harmonics a step takes some tens of vectors at most, where axial waves resonate with them."""
    products, multiply = [], iterative_harmonics.SampledNewton.product
    count = lambda newton, x: products.append(1) or multiply(newton, x)
    monkeypatch.setattr(iterative_harmonics.SampledNewton, "product", count)
    _, _, F, solve = iterative_rows(name, harmonics)
    assert np.isfinite(solve(F)).all() and len(products) <= 30


@pytest.mark.parametrize("name", HEAVED)
def test_responses_without_blocks_are_those_with_them(name, monkeypatch):
    """From a start in time, in as many Newton steps but for a few."""
    system = HEAVED[name]()
    direct = solve_periodic(system, harmonics=12, samples=96)
    monkeypatch.setattr(iterative_harmonics, "ITERATIVE_FROM", 12)
    iterative = solve_periodic(system, harmonics=12, samples=96)
    assert not np.array_equal(iterative.z, direct.z)
    assert abs(iterative.z - direct.z).max() <= SOLVED and iterative.iterations <= direct.iterations + 3


def test_blocks_serve_where_gmres_gives_up(monkeypatch):
    """Their step is taken, then and later; where there are too many harmonics for them the response says so."""
    monkeypatch.setattr(iterative_harmonics, "MOST_VECTORS", 1)
    rows, x, F, solve = iterative_rows("line", 6)
    line, auxiliary = rows.system.line, rows.auxiliary.copy()
    exact = BlockFactors(
        rows.system.order, line.first, line.last, *rows.jacobian(rows.samples(x), rows.auxiliary)
    ).solve(F)
    rows.auxiliary = 0 * auxiliary  # as a later step has others
    for _ in range(2):
        assert abs(solve(F) - exact).max() <= 1e-3 * abs(exact).max()  # in single precision
    assert rows.gives_up and not rows.auxiliary.any()
    monkeypatch.setattr(iterative_harmonics, "MOST_IN_BLOCKS", 1)
    assert np.isnan(iterative_rows("line", 6)[3](np.ones_like(x))).all()
    monkeypatch.setattr(iterative_harmonics, "ITERATIVE_FROM", 3)
    response = solve_periodic(HEAVED["line"](), harmonics=3, throw=False)
    assert response.status is Status.NO_PERIODIC_RESPONSE and response.amplitude < 1


# ---------------------------------------------------------------- warnings
@cache
def warned(case, cells=50, dt=0.1, periods=4, **options):
    """Return the first words of the warnings of a history."""
    history = solve_time_domain(build(case, cells, **options), dt=dt, periods=periods)
    return {warning.split(":")[0] for warning in history.warnings}


def test_a_good_history_has_no_warning():
    """Fifty cells, steps of a tenth of a second, and four periods."""
    assert warned(SURGE_5) == set()


@pytest.mark.parametrize(
    ("given", "word"),
    [
        ((SURGE_5, 4), "mesh"),
        ((replace(OC3_SEABED, amplitude=(5.0, 0.0, 0.0), seabed_stiffness=1e5), 8), "mesh"),
        ((SURGE_5, 50, 2.0), "dt"),
        ((replace(OC3, amplitude=(12.0, 0.0, 0.0)),), "slack"),
        ((SURGE_5, 50, 20.0, 1), "time"),
        ((replace(SURGE_5, Cdn=0.0), 20), "periods"),
    ],
    ids=["coarse", "coarse over a seabed", "long steps", "slack", "one step", "not settled"],
)
def test_a_bad_history_warns(given, word):
    """Each by the word that its warning begins with."""
    assert word in warned(*given)


def history_of(*tensions):
    """Return what the check of periodicity looks at, of lines whose tensions in N are functions of the time in s."""
    lines = [SimpleNamespace(fairlead_tension=tension) for tension in tensions]
    system = SimpleNamespace(period=10.0, model=SimpleNamespace(is_line=False))
    return SimpleNamespace(system=system, time=np.array([0.0, 40.0]), lines=lines)


def test_a_line_that_stands_still_is_periodic():
    """Beside one that moves; of two that change from period to period the worse one is named."""
    swing = lambda t: 1e5 + 1e3 * np.sin(0.2 * np.pi * t)
    still = lambda t: np.full(t.size, 2e5)
    assert list(diagnostics._check_periodicity(history_of(still, swing))) == []
    (text,) = diagnostics._check_periodicity(history_of(still, lambda t: swing(t) + 10 * t, lambda t: swing(t) + 9 * t))
    assert text.startswith("periods: the last two differ by 0.05") and "of element 2: not periodic yet" in text


def test_the_error_of_the_mesh_is_measured():
    """mesh_error is the rms change that half as many cells make, for histories and responses alike."""
    system = build(SURGE_5, 24, mesh="uniform", calibrate=False)
    coarse = build(SURGE_5, 12, mesh="uniform", calibrate=False)
    t = np.linspace(40.0, 60.0, 500)
    fine, rough = (solve_time_domain(one, dt=0.1, periods=3) for one in (system, coarse))
    T, other = (one.fairlead_tension(t) for one in (fine, rough))
    wanted = np.sqrt(np.mean((T - other) ** 2)) / np.ptp(T)
    assert fine.mesh_error == pytest.approx(wanted, rel=0.01)  # at other instants
    assert solve_periodic(system, harmonics=9).mesh_error == pytest.approx(wanted, rel=0.2)


def test_a_coarser_line_has_the_whole_load():
    """Loads of a source on nodes that a coarser line has not go to their neighbours, in sum and in moment."""
    system = manufactured(replace(ALL_TERMS, planar=True), 17, graded(ALL_TERMS.length, 17))
    coarse, t = system.coarser()[0], np.array([0.3, 1.2])
    load, other = system.source_at(t), coarse.source_at(t)
    assert coarse.nodes == 10 and other.shape == (2, 10, 2)
    assert np.allclose(load.sum(axis=1), other.sum(axis=1), rtol=1e-12)
    assert np.allclose((load * system.s[:, None]).sum(axis=1), (other * coarse.s[:, None]).sum(axis=1), rtol=1e-12)


def test_motion_of_a_response_at_any_time():
    """Positions, velocities and accelerations between the samples are the series and its derivatives."""
    response, t, h = solve_periodic(build(SURGE_5, 8), harmonics=3), np.array([0.3, 7.1]), 1e-5
    r, v, a = response.motion_at(t)
    assert np.allclose(r, response.at(t).T, rtol=1e-14) and np.allclose(v, response.rate_at(t).T, rtol=1e-12)
    later, before = (response.motion_at(t + step)[1] for step in (h, -h))
    assert np.allclose(a, (later - before) / (2 * h), rtol=0, atol=1e-8 * abs(a).max())  # (omega h)^2 / 6, and eps / h
    assert np.allclose(a, response.acceleration_at(t).T, rtol=1e-12)


def test_few_harmonics_and_no_mean_warn():
    """Where the last harmonics carry much, and where the constant term is left out."""
    assert any(w.startswith("harmonics") for w in solve_periodic(build(SURGE_5, 20), harmonics=2).warnings)
    assert any(w.startswith("mean") for w in solve_periodic(build(SURGE_5, 20), harmonics=9, mean=False).warnings)


def test_pretension_is_held_against_the_catenary():
    """A state on few cells says how far its tension is off the exact one, and warns beyond a per cent."""
    few, many = (build(OC3, cells, mesh="uniform", calibrate=False).solve_static() for cells in (4, 50))
    assert few.pretension_error > 0.01 and many.pretension_error < 1e-3
    assert any("pretension" in w for w in few.warnings) and many.warnings == ()
    assert build(replace(OC3, current=(0.3, 0.0, 0.0)), 10).solve_static().pretension_error is None
    lying = build(OC3_SEABED, 100).solve_static()
    assert lying.pretension_error < 2e-3


# ---------------------------------------------------------------- a time history to start from
SINKING = OC3_SEABED.submerged_weight / OC3_SEABED.seabed_stiffness  # m, as deep as the line lies
STARTED = 1e-3  # of the largest coefficient: what the steps leave; measured 1.9e-4
BALANCED = 1e-4  # of the range of the tension, rms: what steps and harmonics leave; measured 2.7e-5


def surging_over_the_seabed(contact_depth, cells=12):
    """Return a line over a seabed whose damping is critical for it as it lies, in surge of 5 m."""
    given, k = scene(replace(OC3_SEABED, amplitude=(5.0, 0.0, 0.0), damping=0.05)), OC3_SEABED.seabed_stiffness
    damping = 2 * np.sqrt(k * (given.cable.mass_per_length + given.cable.added_mass(given.environment)))
    given = replace(given, environment=replace(given.environment, seabed_damping=damping))
    return mooring_system(given, cells, contact_depth=contact_depth)


def test_a_history_starts_harmonic_balance():
    """Its coefficients are those of the response, every fifth step kept or all; both have the tension of the other."""
    system = surging_over_the_seabed(SINKING)
    history = solve_time_domain(system, dt=system.period / 1600, periods=5)
    response = solve_periodic(system, harmonics=60, samples=480, start=history)
    kept = replace(history, time=history.time[::5], y=history.y[..., ::5], ydot=history.ydot[..., ::5])
    for one in (history, kept):
        z = history_coefficients(one, response.basis, system.rest_state())
        assert abs(z - response.z).max() <= STARTED * abs(response.z).max()
    tension = history.fairlead_tension(4 * system.period + response.time)
    difference = response.fairlead_tension(response.time) - tension
    assert response.iterations <= 6 and np.sqrt(np.mean(difference**2)) <= BALANCED * np.ptp(tension)


def test_damping_that_grows_from_contact_on_lets_harmonic_balance_converge():
    """Where its force jumps at contact Newton's method alternates between nodes that touch and nodes that do not."""
    responses = []
    for contact_depth in (SINKING, 0.0):
        system = surging_over_the_seabed(contact_depth)
        history = solve_time_domain(system, dt=system.period / 800, periods=4)
        responses.append(solve_periodic(system, harmonics=20, samples=160, start=history, throw=False))
    grows, jumps = responses
    assert grows.success and grows.iterations <= 8 and not jumps.success


def test_a_history_that_cannot_start_is_refused():
    system = surging_over_the_seabed(SINKING)
    short = solve_time_domain(system, dt=system.period / 40, periods=0.5)
    other = solve_time_domain(surging_over_the_seabed(SINKING, 10), dt=system.period / 40, periods=1)
    for history, words in ((short, "no whole period"), (other, "does not fit")):
        with pytest.raises(InputError, match=words):
            solve_periodic(system, harmonics=3, start=history)
