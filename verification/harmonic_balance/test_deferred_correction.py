"""Is the deferred correction of fourth order, however the response was found, and is it refused where it leads nowhere?

Truth is the independent equations of exact/cable_mp: periodic fields of one harmonic, so that the mesh is the only
error. Then the four cases of the paper against their tension on finer meshes; faults are planted in each part.
"""

from __future__ import annotations

import math
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

from solvers.cable import equations
from solvers.cable.mesh import trapezoidal_weights
from solvers.cable.midpoint_stencils import Stencils, midpoint_stencils
from solvers.cable.statics import solve_static
from solvers.cable.system import cable_system
from solvers.common.outcome import ConvergenceError, InputError, Status
from solvers.harmonic_balance.residual import HarmonicResidual
from solvers.harmonic_balance.solve import _corrected, solve_periodic

from ..cable.problems import LENGTH, SOLVERS, TERMS, Manufactured, graded
from ..cases.oscillators import MassChain, harmonic_force
from ..exact.cable import cable_mp
from ..reference import EPS
from ..tools.orders import assert_order, observed_orders
from ..tools.planting import planted, sign_faults
from .test_solve import scene
from .test_solve import system as case_system

OMEGA = 0.3  # rad/s
HARMONICS, SAMPLES = 1, 8  # all there is in the fields; the rows at the samples vanish with them
NODES = (17, 33, 65)
SECOND, FOURTH = (1.9, 2.1), (3.6, 4.1)  # orders; fourth ones are reached from below, measured 3.74 to 3.99
ROUNDING = 20 * EPS  # of weights of four nodes, through a system of four; measured 2.2 eps
POINT = 1e-14  # of the largest part of a row: the source is the same sum in another order; measured 5e-16
RATE = 2e-10  # with damping, whose rate of y_s is a difference over 2e-3 s; measured 5e-11
TOLD = 1e-3  # of the error removed: what is left of it is of fourth order; measured 2.2e-4
KEPT = 5e-3  # of the correction: what further steps would change; measured 1.9e-3
SAME = 1e-7  # of the range: the last steps of different Jacobians differ; measured 2e-9
CEILING = 7e-7  # error relative to the field at 65 nodes, with every term: twice the largest measured, 3.3e-7
SPATIAL = pytest.mark.parametrize("planar", [True, False], ids=["planar", "spatial"])


# ---------------------------------------------------------------- how many steps are taken
def corrected(*sizes, tolerance=1e-9):
    """Return (sum of the steps that were taken, reported mean |dz|) where the steps have these sizes."""
    steps = iter([size * np.array([1.0, -1.0]) for size in sizes])
    same = lambda z: z
    rows = SimpleNamespace(pack=same, unpack=same, with_system=lambda finer: SimpleNamespace(residual=same))
    z, reported = _corrected(rows, lambda F: next(steps), None, np.zeros(2), tolerance)
    assert z[1] == -z[0]
    return -z[0], reported


@pytest.mark.parametrize(
    ("sizes", "taken"),
    [
        ((1.0, 0.25, 0.0625), 1.3125),  # three at most
        ((1.0, 0.5, 0.25), 1.75),  # each half the last or less
        ((1.0, 0.45, 0.3), 1.45),
        ((1.0, 0.4, 0.9), 1.4),
        ((1.0, 0.55), 1.0),
        ((1e-12, 2e-12), 1e-12),  # a rounding that grows
    ],
)
def test_steps_are_taken_while_they_halve(sizes, taken):
    """The last one that is half the one before, or less; the first one alone where the second is at least shorter."""
    assert corrected(*sizes) == (pytest.approx(taken), pytest.approx(taken))


@pytest.mark.parametrize("sizes", [(1.0, 1.0), (1.0, 1.1), (math.nan,), (math.inf,), (1.0, math.nan)], ids=str)
def test_steps_that_grow_are_refused(sizes):
    """Nothing is corrected where the second step is no shorter than the first, or one is not finite."""
    assert corrected(*sizes) == (0.0, None)


# ---------------------------------------------------------------- a periodic problem whose solution is known
class _Path:
    """Motion of the end of the fields: its velocity for the rows, and the place that closes the mean."""

    def __init__(self, fields, chord):
        self.fields, self.chord, self.period = fields, chord, 2 * math.pi / OMEGA
        x, w = np.polynomial.legendre.leggauss(40)
        self.s, self.w = (x + 1) * LENGTH / 2, w * LENGTH / 2

    def velocity(self, t):
        return self.fields.velocity([LENGTH], t)[:, 0]

    def displacement(self, t):
        eps, _, _, _, phi, theta, _ = cable_mp.derivatives(self.fields, self.s, t)[0]
        tangent = np.array([np.sin(phi) * np.cos(theta), -np.sin(theta) + 0 * phi, np.cos(phi) * np.cos(theta)])
        place = np.einsum("n,dn...->d...", self.w, (1 + eps) * tangent)
        return place - self.chord.reshape(3, *(1,) * np.ndim(t))

    def directions(self):
        return np.eye(3)


def problem(name, nodes, planar, mesh=None, of=SOLVERS):
    """Manufactured with fields of one harmonic, as a periodic problem."""
    p = TERMS[name]
    fields = cable_mp.manufactured(p, LENGTH, OMEGA, planar=planar)
    made = Manufactured(p, fields, nodes, planar=planar, mesh=mesh, of=of)
    chain = made.system
    chain.motion = _Path(fields, np.array(chain.scene.fairlead) - chain.anchor)
    chain.period = chain.motion.period
    return made


def error(response, made) -> float:
    """Largest error at nodes and samples relative to the field."""
    exact = made.state(response.time)[0]
    size = abs(exact).max(axis=(1, 2))
    return (abs(response.y - exact).max(axis=(1, 2)) / np.where(size > 0, size, 1.0)).max()


def solved(made, deferred=True, **options):
    return solve_periodic(made.system, harmonics=HARMONICS, samples=SAMPLES, deferred_correction=deferred, **options)


def orders(name, planar, mesh, deferred=True, **options) -> np.ndarray:
    results = [problem(name, n, planar, mesh(n)) for n in NODES]
    return observed_orders(
        [1 / (n - 1) for n in NODES], [error(solved(made, deferred, **options), made) for made in results]
    )


# ---------------------------------------------------------------- the parts
def stencil_errors(s, degree) -> dict[str, float]:
    """Of the three weights for a polynomial of a degree on a mesh, over the largest value."""
    p = np.polynomial.Polynomial(np.random.default_rng(degree).uniform(0.5, 1.5, degree + 1), domain=[s[0], s[-1]])
    rule, middle, h = midpoint_stencils(s), (s[1:] + s[:-1]) / 2, np.diff(s)
    wanted = {"value": p(middle), "slope": p.deriv()(middle), "integral": p.integ()(s[1:]) - p.integ()(s[:-1])}
    assert (abs(rule.integral).sum() > 0) and rule.at.shape == rule.value.shape
    return {
        name: abs(rule(p(s)[None], getattr(rule, name))[0][0] - want).max() * (h.min() if name == "slope" else 1)
        / abs(p(s)).max() / (s[-1] if name == "integral" else 1)
        for name, want in wanted.items()
    }  # fmt: skip


MESHES = {
    "uniform": np.linspace(0.0, 300.0, 12),
    "graded": graded(300.0, 12, 20.0),
    "uneven": np.cumsum(np.r_[0.0, np.random.default_rng(2026).uniform(0.2, 2.0, 11)]),
    "four": np.array([0.0, 1.0, 3.0, 4.0]),
}


@pytest.mark.parametrize("mesh", MESHES)
def test_stencils_are_exact_for_cubics(mesh):
    """Value, slope and integral of cubic polynomials on every mesh, of quadratic ones on three nodes; no quartics."""
    for degree in range(4):
        assert max(stencil_errors(MESHES[mesh], degree).values()) <= ROUNDING
    assert min(stencil_errors(MESHES[mesh], 4).values()) > 1e3 * ROUNDING
    three = MESHES[mesh][:3]
    assert max(stencil_errors(three, 2).values()) <= ROUNDING


def point_error(name, planar, of=SOLVERS) -> float:
    """Rows at points of the fields less their source, over the largest part of row 1; derivatives exact.

    of: the solvers, or a package of them with a planted fault.
    """
    made = problem(name, 9, planar, of=of)
    t, h = np.array([0.7, 6.1, 13.3]), 1e-3
    y, y_s, y_t = made.state(t)
    y_st = (made.state(t + h)[1] - made.state(t - h)[1]) / (2 * h)
    rows = made.system.point(y, y_t, y_s, y_st)
    wanted = cable_mp.source_grid(made.p, made.fields, made.system.s, t, planar=planar)
    return float(abs(rows - wanted).max() / (made.p.EA * abs(y_s[0]).max()))


@SPATIAL
@pytest.mark.parametrize("name", TERMS)
def test_rows_at_a_point_are_the_equations(name, planar):
    """Each term alone and all together, against the independent statement of the equations."""
    assert point_error(name, planar) <= (RATE if TERMS[name].beta else POINT)


@SPATIAL
def test_each_sign_at_a_point_is_seen(planar):
    """Every term of the rows at a point in turn with the wrong sign misses the equations."""
    module, survivors = "cable.planar" if planar else "cable.spatial", []
    faults = sign_faults(module, ("add_stiffness", "stiffness_coefficients"))
    faults += sign_faults("cable.equations", ("point",))
    for fault in faults:
        with planted(fault) as faulty:
            if not point_error("all", planar, faulty) > RATE:
                survivors.append(str(fault))
    assert len(faults) >= 10 and not survivors, "\n".join(survivors)


# ---------------------------------------------------------------- orders
@SPATIAL
@pytest.mark.parametrize("name", ["bare", "seabed", "current and drag", "all"])
@pytest.mark.parametrize("mesh", ["uniform", "graded"])
def test_corrected_responses_are_of_fourth_order(name, planar, mesh):
    """The box scheme is of second order in ds and the corrected response of fourth, on smooth meshes."""
    of = (lambda n: graded(LENGTH, n)) if mesh == "graded" else (lambda n: None)
    low, high = FOURTH
    assert (low <= (result := orders(name, planar, of))).all() and (result <= high).all(), result
    low, high = SECOND
    assert (low <= (result := orders(name, planar, of, False))).all() and (result <= high).all(), result


@SPATIAL
@pytest.mark.parametrize("name", ["current and drag", "all"])
def test_order_of_the_corrected_response(name, planar):
    """Where drag damps all waves the order is four to a twentieth, and the error is as small as was measured."""
    made = [problem(name, n, planar) for n in NODES]
    errors = [error(solved(one), one) for one in made]
    assert_order([1 / (n - 1) for n in NODES], errors, 4, ceiling=CEILING, what=name)


@pytest.mark.parametrize("options", [{"globalisation": "relaxation"}, {"tolerance": 1e-6}], ids=str)
def test_the_order_is_that_of_any_jacobian(options):
    """However the response was found: the Jacobian that is left is older or newer, and the result is the same."""
    assert (orders("bare", True, lambda n: None, **options) >= FOURTH[0]).all()


def test_repeated_corrections_make_up_for_an_old_jacobian():
    """Without coarse starts the Jacobian is of an earlier state: one step leaves an error of order 2, three none."""
    made = problem("bare", 33, True)
    fresh, old = (error(solved(made, **o), made) for o in ({"globalisation": "relaxation"}, {"multilevel": False}))
    assert old <= 1.5 * fresh


@pytest.mark.parametrize("planar", [True, False])
def test_places_are_of_fourth_order(planar):
    """Positions of the nodes, by the integral of (1 + eps) t: of fourth order, too, and the mean place is closed."""
    results, path = [], None
    for n in NODES:
        made = problem("all", n, planar)
        path, response = made.system.motion, solved(made)
        end = response.r[:, -1] - np.array(made.system.scene.fairlead)[:, None]
        results.append(abs(end - path.displacement(response.time)).max())
    assert (observed_orders([1 / (n - 1) for n in NODES], results) >= FOURTH[0]).all(), results


@SPATIAL
def test_the_correction_is_the_error_that_it_removes(planar):
    """Its size is the mean distance of the box scheme's coefficients from the exact ones."""
    made = problem("all", 33, planar)
    response, box = solved(made), solved(made, False)
    exact = (made.state(response.time)[0] - made.system.rest_state()[..., None]) @ response.basis.P
    removed = abs(box.z - exact).mean()
    assert response.correction == pytest.approx(removed, rel=TOLD)
    assert box.correction is None


# ---------------------------------------------------------------- the paper's cases
@cache
def converged(case):
    """On a mesh whose distance from 193 nodes is below a hundredth of the corrected errors measured here."""
    return solve_periodic(cable_system(scene(case), 97), harmonics=7, deferred_correction=True)


def rms(response, case) -> float:
    wanted, t = converged(case), np.linspace(0.0, 20.0, 400)
    T = wanted.fairlead_tension(t)
    return float(np.sqrt(((response.fairlead_tension(t) - T) ** 2).mean()) / np.ptp(T))


GAIN = {1: 10.0, 2: 43.0, 3: 80.0, 4: 5.0}  # four fifths of the least, at 13 nodes: 12.3, 53.9, 102 and 6.3


@pytest.mark.parametrize("nodes", [13, 17, 25])
@pytest.mark.parametrize("case", GAIN)
def test_cases_of_the_paper_gain(case, nodes):
    """The corrected tension is nearer the converged one by the factor of the case."""
    chain = cable_system(scene(case), nodes)
    box, corrected = (solve_periodic(chain, harmonics=7, deferred_correction=d) for d in (False, True))
    assert rms(corrected, case) * GAIN[case] <= rms(box, case), (rms(box, case), rms(corrected, case))


# ---------------------------------------------------------------- limits
def test_where_the_steps_grow_it_is_refused():
    """On three nodes, and where one cell is a hundred times its neighbour: the message, the box scheme's response."""
    line = scene(1)
    uneven = np.linspace(0.0, line.length / 5, 17)
    uneven[1:] += line.length - uneven[-1]
    for chain in (cable_system(line, 3), cable_system(line, mesh=uneven)):
        box, corrected = (solve_periodic(chain, harmonics=5, deferred_correction=d, throw=False) for d in (False, True))
        assert corrected.status is Status.NOT_CORRECTED and corrected.correction is None
        assert corrected.system is chain and np.array_equal(corrected.z, box.z)
        with pytest.raises(ConvergenceError, match="too coarse or too uneven"):
            solve_periodic(chain, harmonics=5, deferred_correction=True)


def test_a_step_that_is_not_finite_is_no_correction(monkeypatch):
    """Rows of the finer chain that are no numbers: the response says so."""
    chain = cable_system(scene(1), 13)
    monkeypatch.setattr(HarmonicResidual, "with_system", lambda self, system: Lost(self))
    response = solve_periodic(chain, harmonics=3, deferred_correction=True, throw=False)
    assert response.status is Status.NOT_CORRECTED and np.isfinite(response.z).all()


class Lost:
    """Rows that are not numbers."""

    def __init__(self, balance):
        self.balance = balance

    def residual(self, x):
        return np.full_like(self.balance.residual(x), np.nan)


def test_a_corrected_response_is_kept_by_another_solve():
    """Started from a corrected one the response is the same; solved to the end on its own chain, nearly so."""
    chain = cable_system(scene(1), 25)
    first = solve_periodic(chain, harmonics=7, deferred_correction=True)
    again = solve_periodic(chain, harmonics=7, deferred_correction=True, start=first)
    whole = solve_periodic(first.system, harmonics=7, start=first)
    nothing = solve_periodic(first.system, harmonics=7, start=whole, deferred_correction=True)
    assert abs(again.z - first.z).mean() <= KEPT * first.correction
    assert abs(whole.z - first.z).mean() <= KEPT * first.correction
    assert nothing.success and nothing.correction <= 1e-9


def test_symmetry_and_fields_change_nothing():
    """With and without symmetry, in the plane and in space, at half the frequency: the same corrected tension.

    With a Jacobian of the solution: the last one is older by default, and where it is from depends on the start.
    """
    newest = {"globalisation": "relaxation", "deferred_correction": True}
    planar, spatial = (cable_system(scene(1), 17, fields=f) for f in ("planar", "spatial"))
    t = np.linspace(0.0, 20.0, 100)
    wanted = solve_periodic(planar, harmonics=5, **newest).fairlead_tension(t)
    for chain, options in (
        (spatial, {"harmonics": 5}),
        (spatial, {"harmonics": 5, "symmetry": False}),
        (planar, {"harmonics": 10, "subharmonic": 2}),
    ):
        got = solve_periodic(chain, **newest, **options).fairlead_tension(t)
        assert abs(got - wanted).max() <= SAME * np.ptp(wanted)


def test_a_chain_without_such_rows_is_refused():
    """Oscillators have no mesh."""
    chain = MassChain("mass", 2 * math.pi, harmonic_force(1.0, 1.0), k=3.0)
    with pytest.raises(InputError, match="no rows of higher order"):
        solve_periodic(chain, harmonics=3, deferred_correction=True)


def test_places_of_a_corrected_response_are_of_its_order():
    """The end is where it is prescribed to the square of the correction, and no warning says otherwise."""
    response = solve_periodic(case_system(1, 25), harmonics=9, deferred_correction=True)
    plain = solve_periodic(case_system(1, 25), harmonics=9)
    t = response.time
    wanted = np.array(response.system.scene.fairlead)[:, None] + response.system.motion.displacement(t)
    off, before = (abs(r.r[:, -1] - wanted).mean() for r in (response, plain))
    assert off < 0.2 * before and response.warnings == ()


def test_a_corrected_response_is_a_start():
    """Solved again from it, without a correction, it is the response that it was corrected from."""
    system = case_system(1, 17)
    corrected, plain = (solve_periodic(system, harmonics=5, deferred_correction=on) for on in (True, False))
    again = solve_periodic(system, harmonics=5, start=corrected)
    assert abs(again.z - plain.z).max() < 1e-8 < abs(corrected.z - plain.z).max()


def test_a_failed_response_is_not_corrected():
    """It has no Jacobian worth a step."""
    response = solve_periodic(case_system(1, 25).scaled(4.0), harmonics=3, deferred_correction=True, throw=False)
    assert not response.success and response.correction is None


# ---------------------------------------------------------------- planted faults
def wrong_sign(monkeypatch):
    true = HarmonicResidual.with_system
    monkeypatch.setattr(HarmonicResidual, "with_system", lambda self, c: Opposite(true(self, c)))


class Opposite:
    def __init__(self, balance):
        self.balance = balance

    def residual(self, x):
        return -self.balance.residual(x)


def second_order_slopes(monkeypatch):
    def planted(s):
        true = midpoint_stencils(s)
        cell, slope = np.arange(s.size - 1)[:, None], np.zeros_like(true.slope)
        slope[true.at == cell], slope[true.at == cell + 1] = -1 / np.diff(s), 1 / np.diff(s)
        return true._replace(slope=slope)

    monkeypatch.setattr(equations, "midpoint_stencils", planted)


def second_order_middle(monkeypatch):
    def planted(s):
        true, cell = midpoint_stencils(s), np.arange(s.size - 1)[:, None]
        return true._replace(value=np.where((true.at == cell) | (true.at == cell + 1), 0.5, 0.0))

    monkeypatch.setattr(equations, "midpoint_stencils", planted)


def old_weights(monkeypatch):
    planted = lambda self: trapezoidal_weights(self.integral.sum(axis=1))
    monkeypatch.setattr(Stencils, "quadrature", planted)


def source_of_the_box(monkeypatch):
    def planted(self, y, ydot, t):
        to, q = self.stencils, self.source(t)
        (middle, slope), (middle_t, slope_t) = (to(part, to.value, to.slope) for part in (y, ydot))
        return 2 * self.point(middle, middle_t, slope, slope_t) - (q[:, 1:] + q[:, :-1])

    monkeypatch.setattr(equations.CableEquations, "_midpoint_residual", planted)


FAULTS = [wrong_sign, second_order_slopes, second_order_middle, old_weights, source_of_the_box]


@pytest.mark.parametrize("fault", FAULTS)
def test_planted_faults_are_seen(fault, monkeypatch):
    """Each spoils the fourth order."""
    fault(monkeypatch)
    try:
        result = orders("all", True, lambda n: None)
    except ConvergenceError:
        return
    assert not (result >= FOURTH[0]).all(), result


def test_a_corrected_cable_has_no_statics():
    """Its cells are of fourth order, its places those of the box scheme: an equilibrium of both would be of neither."""
    response = solve_periodic(cable_system(scene(1), 17), harmonics=3, deferred_correction=True)
    with pytest.raises(InputError, match="give the cable that was solved for"):
        solve_static(response.system)
