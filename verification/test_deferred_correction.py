"""Is what the deferred correction of harmonic balance promises true: fourth order in ds, on every term of the cable?

Truth are chosen fields, with the independent equations of exact/cable_mp for their source, and finer meshes of the
paper's cases.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from solvers import InputError, harmonic_balance, solve_periodic, stencils
from solvers import cable as cable_module

from .cables import LENGTH, TERMS, Manufactured, chosen_fields, graded
from .cases.oscillators import duffing
from .exact import cable_mp
from .orders import assert_order
from .reference import EPS
from .test_harmonic_balance import system as case

SPATIAL = pytest.mark.parametrize("planar", [True, False], ids=["planar", "spatial"])
ROUNDING = 100 * EPS  # of weights that are solved for, on cells of four sizes; measured 6 eps
PERIOD, GAUSS = 20.0, np.polynomial.legendre.leggauss(40)
HARMONICS, SAMPLES = 4, 20  # the fields have one harmonic, what the mesh does to them a few
CEILING = 2.5e-6  # error relative to the field at 65 nodes, corrected: twice the largest measured, 1.1e-6
TRUNCATION = 10.0  # N/m: no ceiling, the order is what counts
NEARER = {1: 10, 2: 20, 3: 40, 4: 5}  # times, at 17 nodes; measured 15, 30, 61 and 8


# ---------------------------------------------------------------- stencils
@pytest.mark.parametrize("nodes", [3, 4, 5, 12])
def test_stencils_are_exact_for_polynomials(nodes):
    """Of degree three (two on three nodes): middle, slope and integral of every cell, on a graded mesh."""
    s = graded(LENGTH, nodes) / LENGTH
    to, middle = stencils.stencils(s), (s[1:] + s[:-1]) / 2
    for degree in range(min(nodes, 4)):
        q = s[None] ** degree
        integral = (s[1:] ** (degree + 1) - s[:-1] ** (degree + 1)) / (degree + 1)
        for weights, exact in (
            (to.value, middle**degree),
            (to.slope, degree * middle ** max(degree - 1, 0)),
            (to.integral, integral),
        ):
            assert abs(to(weights, q)[0] - exact).max() <= ROUNDING * abs(weights).max()


# ---------------------------------------------------------------- rows
@SPATIAL
@pytest.mark.parametrize("name", TERMS)
def test_truncation_is_of_fourth_order(name, planar):
    """What exact fields leave in the rows of the inner cells falls with ds^4, each term alone and all together."""
    assert_order(*truncation(name, planar), 4, ceiling=TRUNCATION, what=f"{name}, rows")


def truncation(name, planar):
    """Sizes of cells, and what the fields leave in the inner ones."""
    fields = chosen_fields(TERMS[name], space="curved", time="curved", planar=planar)
    meshes, sizes = (17, 33, 65), []
    for nodes in meshes:
        problem = Manufactured(TERMS[name], fields, nodes, planar=planar)
        y, _, ydot = problem.state(0.4)
        rows = problem.system.fourth_order().cells(y, ydot, 0.4, False).value
        sizes.append(abs(rows[:, 2:-2]).max())
    return [1 / (n - 1) for n in meshes], sizes


# ---------------------------------------------------------------- solutions
class _Moved:
    """The end of periodic fields: where it is from where the scene has it, and its velocity."""

    period = PERIOD

    def __init__(self, problem):
        self.end, self.problem = problem.system.motion, problem
        self.directions = self.end.directions

    def velocity(self, t):
        return self.end.velocity(t)

    def displacement(self, t):
        """By Gauss quadrature of (1 + eps) t over the line."""
        fields, system, t = self.problem.fields, self.problem.system, np.asarray(t, dtype=float)
        points, weights = (GAUSS[0] + 1) * LENGTH / 2, GAUSS[1] * LENGTH / 2
        at = [np.vectorize(lambda s, t, f=f: float(f(s, t)))(points[:, None], t.ravel())
              for f in (fields.eps, fields.phi, fields.theta)]  # fmt: skip
        eps, phi, theta = at
        local = np.array([np.cos(phi) * np.cos(theta), np.sin(phi) * np.cos(theta), -np.sin(theta)]) * (1 + eps)
        end = (local * weights[:, None]).sum(axis=1)[: len(system.axes)]
        return (system.axes.T @ (end - system.chord[:, None])).reshape(3, *t.shape)


def periodic(name, nodes, planar, mesh=None):
    """A system whose periodic response is chosen fields, and these at times t."""
    fields = cable_mp.manufactured(TERMS[name], LENGTH, 2 * math.pi / PERIOD, planar=planar)
    problem = Manufactured(TERMS[name], fields, nodes, planar=planar, mesh=mesh)
    problem.system.motion, problem.system.period = _Moved(problem), PERIOD
    return problem.system, lambda t: problem.state(t)[0]


def errors_of_responses(name, planar, corrected, mesh=lambda n: None):
    """Cells, and the largest error over nodes, fields and times relative to the field."""
    meshes, errors = (17, 33, 65), []
    for nodes in meshes:
        system, exact = periodic(name, nodes, planar, mesh(nodes))
        basis = harmonic_balance.Basis(HARMONICS, SAMPLES, 2 * math.pi / PERIOD, True)
        y = exact(basis.times)
        start = (y - system.rest()[..., None]) @ basis.P
        options = {"harmonics": HARMONICS, "samples": SAMPLES, "start": start, "deferred_correction": corrected}
        found = solve_periodic(system, **options)
        size = abs(y).max(axis=(1, 2))
        errors.append(float((abs(found.y - y).max(axis=(1, 2)) / np.where(size > 0, size, 1.0)).max()))
    return [1 / (n - 1) for n in meshes], errors


@SPATIAL
@pytest.mark.parametrize("name", ["current and drag", "all"])
def test_order_of_the_corrected_response(name, planar):
    """Periodic fields, smooth drag: the error of the response falls with ds^4, and with ds^2 as it was before."""
    assert_order(*errors_of_responses(name, planar, False), 2, ceiling=1.0, what=f"{name}, box scheme")
    assert_order(*errors_of_responses(name, planar, True), 4, ceiling=CEILING, what=f"{name}, corrected")


def test_the_size_of_the_correction_is_that_of_the_error():
    """``correction``, mean |dz|, beside the mean of what the finest mesh changes: within a quarter."""
    for name in NEARER:
        fine = solve_periodic(case(name, 97), harmonics=5, deferred_correction=True)
        system = case(name, 25)
        plain, corrected = (solve_periodic(system, harmonics=5, deferred_correction=on) for on in (False, True))
        error = abs(plain.at(fine.time) - fine.y[:, ::4]).mean(axis=-1)
        moved = abs(plain.at(fine.time) - corrected.at(fine.time)).mean(axis=-1)
        assert plain.correction is None and corrected.correction > 0
        assert moved.sum() == pytest.approx(error.sum(), rel=0.25), name


@pytest.mark.parametrize("name", NEARER)
def test_the_tension_is_nearer_the_converged_one(name):
    """At 17 nodes, the same harmonics on both sides."""
    assert gain(name) > NEARER[name]


def gain(name) -> float:
    """By how much the correction brings the fairlead tension nearer to that of 193 nodes."""
    t = np.linspace(0, PERIOD, 200)
    exact = solve_periodic(case(name, 193), harmonics=12).fairlead_tension(t)
    off = [
        np.sqrt(np.mean((solve_periodic(case(name, 17), harmonics=12, deferred_correction=on).fairlead_tension(t)
                         - exact) ** 2))
        for on in (False, True)
    ]  # fmt: skip
    return off[0] / off[1]


# ---------------------------------------------------------------- what belongs to it
def test_places_of_a_corrected_response_are_of_its_order():
    """The end is where it is prescribed to the square of the correction, and no warning says otherwise."""
    found = solve_periodic(case(1, 25), harmonics=9, deferred_correction=True)
    plain = solve_periodic(case(1, 25), harmonics=9)
    t = found.time
    wanted = np.array(found.system.scene.fairlead)[:, None] + found.system.motion.displacement(t)
    off, before = (abs(r.r[:, -1] - wanted).mean() for r in (found, plain))
    assert off < 0.2 * before and found.warnings == ()


def test_a_corrected_response_is_a_start():
    """Solved again from it, without a correction, it is the response that it was corrected from."""
    system = case(1, 17)
    corrected, plain = (solve_periodic(system, harmonics=5, deferred_correction=on) for on in (True, False))
    again = solve_periodic(system, harmonics=5, start=corrected)
    assert abs(again.z - plain.z).max() < 1e-8 < abs(corrected.z - plain.z).max()


def test_the_iterative_solver_corrects_alike():
    """To what its last linear solve leaves."""
    system = case(2, 13)
    one, other = (
        solve_periodic(system, harmonics=5, deferred_correction=True, linear_solver=solver).z
        for solver in ("direct", "iterative")
    )
    assert abs(one - other).max() < 1e-2 * abs(one - solve_periodic(system, harmonics=5).z).max()


def test_a_chain_without_cells_of_fourth_order_is_refused():
    with pytest.raises(InputError, match="deferred_correction: this chain has no rows of higher order"):
        solve_periodic(duffing(1.0, 0.3), harmonics=3, deferred_correction=True)


def test_a_failed_response_is_not_corrected():
    """It has no Jacobian worth a step."""
    found = solve_periodic(case(1, 25).scaled(4.0), harmonics=3, deferred_correction=True, throw=False)
    assert not found.success and found.correction is None


# ---------------------------------------------------------------- planted faults
def _trapezoid(self):
    weights = np.zeros(self.nodes)
    weights[1:] += self.ds / 2
    weights[:-1] += self.ds / 2
    return weights


def _second_order_slope(s):
    to = EXACT(s)
    first = np.arange(s.size - 1)
    low = np.where(to.at == first[:, None], -1.0, np.where(to.at == first[:, None] + 1, 1.0, 0.0))
    return to._replace(slope=low / np.diff(s)[:, None])


def _no_curvature(s):
    to = EXACT(s)
    first = np.arange(s.size - 1)
    near = (to.at == first[:, None]) | (to.at == first[:, None] + 1)
    return to._replace(value=np.where(near, 0.5, 0.0))


def _backwards(balance, finer, z, tolerance):
    x = balance.pack(z)
    step = balance.inverse(balance.of(finer).residual(x))
    return balance.unpack(x + step), 1.0


EXACT = stencils.stencils
FAULTS = {
    "step backwards": (harmonic_balance, "_corrected", _backwards),
    "slope of second order": (cable_module, "stencils", _second_order_slope),
    "middle of second order": (cable_module, "stencils", _no_curvature),
    "trapezoidal rule kept": (cable_module.CableSystem, "_weights", property(_trapezoid)),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_planted_fault_is_found(fault, monkeypatch):
    """By the order of the corrected response."""
    where, name, wrong = FAULTS[fault]
    monkeypatch.setattr(where, name, wrong)
    with pytest.raises(AssertionError):
        assert_order(*errors_of_responses("all", True, True), 4, ceiling=CEILING, what="corrected")
