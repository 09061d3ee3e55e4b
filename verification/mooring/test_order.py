"""Is the moving line of second order in the cell and in the step, with each term alone on the bare line and with all?

Truth is the manufactured line of exact/moving_line. In time alone a motion is made exact on the mesh: the load is then
what the rows of the mesh leave over of it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from solvers import solve_time_domain
from solvers.mooring.stepping import time_domain

from ..exact.mooring.moving_line import ALL_TERMS, BARE
from ..tools.orders import assert_order
from ..tools.planting import sign_faults
from .problems import (
    STEPS,
    compiled,
    evaluate,
    exact_load,
    exact_state,
    hanging_mass,
    interpreted,
    lumped_load,
    manufactured,
)

_BARE = ("EA", "mass")
_ON = {
    "bare": (),
    "damping": ("beta",),
    "added mass": ("Ca",),
    "normal drag": ("Cdn", "current"),
    "tangential drag": ("Cdt", "current"),
    "weight": ("weight",),
    "seabed": ("seabed_stiffness",),
    "seabed and damping": ("seabed_stiffness", "seabed_damping"),
    "seabed and friction": ("seabed_stiffness", "friction"),
}
TERMS = {
    name: replace(BARE, **{key: getattr(ALL_TERMS, key) for key in (*_BARE, *keys)}) for name, keys in _ON.items()
} | {"all": ALL_TERMS}
TERMS["seabed, damping that grows"] = replace(TERMS["seabed and damping"], contact_depth=60.0)
"""A line of mass and stiffness, each load alone on it, and all of them."""
STATIC = ("bare", "normal drag", "tangential drag", "weight", "seabed", "all")

CELLS = (16, 32, 64)
DURATION = 2.0  # s, a fifth of a period: an axial wave runs through a third of the line
CEILINGS = {"rows": 1e-3, "statics": 2.2e-4, "ds": 1e-5, "dt": 8e-6, "both": 1.1e-5}
"""On the last mesh and step: of the largest force, or of the length; twice the largest that was measured."""
SPATIAL = pytest.mark.parametrize("planar", [True, False], ids=["planar", "spatial"])
EACH_TERM = pytest.mark.parametrize("name", TERMS)


def line_of(name, planar, **changes):
    """Return the manufactured line with the terms of that name."""
    return replace(TERMS[name], planar=planar, **changes)


def at_the_worst_place(errors) -> list[float]:
    """Return the signed errors, of arrays (n, N) on nested places, where the last of them is largest."""
    worst = np.unravel_index(abs(errors[-1]).argmax(), errors[-1].shape)
    return [float(error[worst]) for error in errors]


def common(values, cells, coarsest):
    """Return the columns of an array (n, N) at the nodes that the coarsest mesh has too."""
    return values[:, :: cells // coarsest]


def graded(length, cells, ratio=4.0):
    """Return arc lengths (N,) of a smooth mesh whose last cell is about ``ratio`` times as long as its first, m."""
    s = length * np.expm1(np.linspace(0.0, 1.0, cells + 1) * np.log(ratio)) / (ratio - 1)
    s[-1] = length
    return s


# ---------------------------------------------------------------- the cell
@SPATIAL
@EACH_TERM
def test_rows_of_the_nodes(name, planar):
    """What the rows of the inner nodes leave over of the exact motion falls with ds^2."""
    line, left = line_of(name, planar), []
    for cells in CELLS:
        system = manufactured(line, cells)
        y, ydot = exact_state(system, line, 1.3)
        a = line.acceleration(system.s, 1.3)
        R, _, _ = evaluate(compiled, system.line, y.T, ydot.T, a.T, np.ones(cells))
        left.append(common((R - lumped_load(system, line, 1.3)[0]).T * cells / line.length, cells, CELLS[0])[:, 1:-1])
    size = max(abs(force).max() for force in line.forces(system.s, 1.3).values())
    errors = np.array(at_the_worst_place(left)) / size
    assert_order([1 / c for c in CELLS], errors, 2, ceiling=CEILINGS["rows"], what=f"{name}, rows")


@SPATIAL
@pytest.mark.parametrize("name", STATIC)
@pytest.mark.parametrize("mesh", ["uniform", "graded"])
def test_order_of_the_equilibrium(name, planar, mesh):
    """Statics of a manufactured shape, from catenaries that know nothing of it: positions err by ds^2."""
    line, errors = line_of(name, planar, omega=0.0), []
    for cells in CELLS:
        system = manufactured(line, cells, mesh if mesh == "uniform" else graded(line.length, cells))
        system.line = system.line._replace(load=system.line.load + lumped_load(system, line, 0.0)[0])
        state = system.solve_static()
        errors.append(common(state.y - exact_state(system, line, 0.0)[0], cells, CELLS[0]) / line.length)
    errors = at_the_worst_place(errors)
    assert_order([1 / c for c in CELLS], errors, 2, ceiling=CEILINGS["statics"], what=f"{name}, statics")


def run_errors(line, cells, dts, *, mesh="uniform", **options):
    """Return the signed errors of positions at the end of runs, over the length, where the last is largest."""
    errors = []
    for count, dt in zip(cells, dts, strict=True):
        system = manufactured(line, count, mesh if mesh == "uniform" else graded(line.length, count))
        history = solve_time_domain(
            system, dt=dt, duration=DURATION, start=exact_state(system, line, 0.0), tolerance=1e-9, **options
        )
        difference = history.y[:, :, -1] - exact_state(system, line, DURATION)[0]
        errors.append(common(difference, count, cells[0]) / line.length)
    return at_the_worst_place(errors)


@SPATIAL
@EACH_TERM
def test_order_in_ds(name, planar):
    """With steps so short that they add nothing, the error falls with ds^2."""
    errors = run_errors(line_of(name, planar), CELLS, (0.005,) * 3)
    assert_order([1 / c for c in CELLS], errors, 2, ceiling=CEILINGS["ds"], what=f"{name}, ds")


@SPATIAL
@EACH_TERM
def test_order_in_ds_and_dt_together(name, planar):
    """Cells and steps halved together, steps that are not short: the error falls with their square."""
    errors = run_errors(line_of(name, planar), CELLS, (0.08, 0.04, 0.02))
    assert_order([1 / c for c in CELLS], errors, 2, ceiling=CEILINGS["both"], what=f"{name}, ds and dt")


@SPATIAL
def test_order_on_a_graded_mesh(planar):
    """The same with all terms where the last cell is four times as long as the first."""
    errors = run_errors(line_of("all", planar), CELLS, (0.1, 0.05, 0.025), mesh="graded")
    assert_order([1 / c for c in CELLS], errors, 2, ceiling=CEILINGS["both"], what="graded")


# ---------------------------------------------------------------- the step
DTS = (0.1, 0.05, 0.025)  # s, for a motion of 0.6 and 1.2 rad/s


def errors_in_dt(line, dts, cells=6, **options):
    """Return the signed errors of runs whose load makes the motion exact on the mesh."""
    return at_the_worst_place([history_error(line, dt, cells, **options)[1] for dt in dts])


def history_error(line, dt, cells, **options):
    """Return the history of a run whose load makes the motion exact on the mesh, and its error (n, N) of the length."""
    system = manufactured(line, cells)
    system.source = lambda t: exact_load(system, line, t)
    history = solve_time_domain(
        system, dt=dt, duration=DURATION, start=exact_state(system, line, 0.0), tolerance=1e-10, **options
    )
    return history, (history.y[:, :, -1] - exact_state(system, line, DURATION)[0]) / line.length


@SPATIAL
@EACH_TERM
def test_order_in_dt(name, planar):
    """On a mesh that the motion fits exactly the error falls with dt^2."""
    errors = errors_in_dt(line_of(name, planar), DTS)
    assert_order(DTS, errors, 2, ceiling=CEILINGS["dt"], what=f"{name}, dt")


@SPATIAL
@pytest.mark.parametrize("rho_inf", [1.0, 0.8, 0.5, 0.0])
def test_order_in_dt_of_each_scheme(rho_inf, planar):
    """With any damping of the shortest waves, none and all of it, the order is the same."""
    errors = errors_in_dt(line_of("all", planar), DTS, rho_inf=rho_inf)
    assert_order(DTS, errors, 2, ceiling=CEILINGS["dt"], what=f"rho_inf {rho_inf}")


@SPATIAL
def test_work_of_a_step(planar):
    """Newton's method takes few iterations and factorisations; every second state can be kept."""
    assert not wrong_with_runs(planar)


# ---------------------------------------------------------------- a linear oscillator
LIKE_THE_FORMULA = 1e-10  # of the displacement, the speed and so on; measured 1.6e-11


def oscillator_errors(rho_inf, step, damping=0.05, steps=60):
    """Return the largest errors of a mass on a line from the recurrence of a linear oscillator, over displacement.

    step: in radians of the undamped oscillation; damping: of critical.
    """
    mass, EA, length = 500.0, 2e6, 10.0
    omega = np.sqrt(EA / length / mass)
    beta, h, start = 2 * damping / omega, step / omega, 0.01
    system = hanging_mass(mass, EA=EA, length=length, damping=beta, position=-length, line_mass=1e-9)
    free = np.delete(np.arange(system.nodes), system.prescribed_nodes)
    y, mass_node = system.rest_state().copy(), free[abs(system.rest_state()[1, free]).argmax()]
    y[1, free] += start * abs(y[1, free]) / abs(y[1, mass_node])
    settings = {"rho_inf": rho_inf, "tolerance": 1e-11, "throw": False}
    history = solve_time_domain(system, dt=h, duration=steps * h, start=(y, None), **settings)
    if not history.success:
        return np.full(3, np.inf)
    got = [part[1, mass_node] for part in (history.y, history.ydot, history.yddot)]
    got[0] = got[0] - system.rest_state()[1, mass_node]
    exact = oscillation(omega, damping, h, rho_inf, start, steps)
    size = start * np.array([1.0, omega, omega**2])
    return abs(np.array(got).T - exact).max(axis=0) / size


def oscillation(omega, damping, h, rho_inf, start, steps):
    """Return position, velocity and acceleration (steps + 1, 3) of a linear oscillator from rest at ``start``.

    Arnold and Bruels (2007), with the parameters of Chung and Hulbert (1993) for a spectral radius rho_inf.
    """
    m, f = (2 * rho_inf - 1) / (rho_inf + 1), rho_inf / (rho_inf + 1)
    gamma, beta = 0.5 - m + f, (1 - m + f) ** 2 / 4
    x, v, force = start, 0.0, -(omega**2) * start
    a, result = force, [(x, v, force)]
    for _ in range(steps):
        x_known, v_known = x + h * v + h * h * (0.5 - beta) * a, v + h * (1 - gamma) * a
        known = (m * a - f * force) / (1 - f) + 2 * damping * omega * v_known + omega**2 * x_known
        new = -known / ((1 - m) / (1 - f) + 2 * damping * omega * h * gamma + omega**2 * h * h * beta)
        x, v = x_known + h * h * beta * new, v_known + h * gamma * new
        force = ((1 - m) * new + m * a - f * force) / (1 - f)
        a = new
        result.append((x, v, force))
    return np.array(result)


@pytest.mark.parametrize("rho_inf", [0.95, 0.5, 0.0])
@pytest.mark.parametrize("step", [0.1, 3.0, 100.0])
def test_steps_are_those_of_the_formula(rho_inf, step):
    """A mass on a spring with a damper goes as the recurrence has it, in short steps and in those of many periods."""
    assert oscillator_errors(rho_inf, step).max() <= LIKE_THE_FORMULA


# ---------------------------------------------------------------- planted faults
COARSE = (0.1, 0.05)
MOST_ITERATIONS = 3.2  # of a step to 1e-10; measured 3.05
MOST_FACTORISATIONS = 1.0  # of a step; measured 0.95: one costs about as much as two iterations


def wrong_with_runs(planar) -> list[str]:
    """Return what is wrong with runs of three cells: positions, rates, their order, or the work of Newton's method."""
    line, errors, wrong = line_of("all", planar, EA=2.5e6, beta=0.05), [], []  # stiff: the Jacobian counts
    for dt in COARSE:
        history, error = history_error(line, dt, 3, rho_inf=0.8, throw=False, every=2)
        if not history.success or history.cut or history.time.size != round(DURATION / dt / 2) + 1:
            return ["a step failed, or is not there"]
        work = history.iterations / history.steps, history.factorisations / history.steps
        if work[0] > MOST_ITERATIONS or work[1] > MOST_FACTORISATIONS:
            wrong.append(f"work {work}")
        system, size = history.system, line.omega * line.length
        for k, t in enumerate(history.time):
            rates = [(history.ydot, line.velocity, size), (history.yddot, line.acceleration, size * line.omega)]
            for got, exact, scale in rates:
                difference = abs(got[:, :, k] - exact(system.s, t)).max() / scale
                if not difference <= RATES:
                    wrong.append(f"rates at {t:g} s: {difference:g}")
        errors.append(error)
    if not oscillator_errors(0.8, 1.0).max() <= LIKE_THE_FORMULA:
        wrong.append("an oscillator does not go as the formula has it")
    try:
        assert_order(COARSE, at_the_worst_place(errors), 2, ceiling=2e-5, band=0.15)
    except AssertionError as error:
        wrong.append(str(error))
    return wrong


RATES = 5e-3  # of length and frequency, at the longer step


def is_red(planar=True) -> bool:
    """Return whether anything is wrong with the runs, or they end with an exception."""
    try:
        with np.errstate(all="ignore"):  # a planted fault may overflow
            return bool(wrong_with_runs(planar))
    except (ArithmeticError, ValueError, TypeError, IndexError):
        return True


UNSEEN = {
    "more room than needed, or minus zero": ("nodes - (-(1))", "(-(0.0", "(-(True))"),
    "after a failed prediction": ("0.5 / beta", "(-(kept))"),
    "of the tension of a slack cell": (
        "R[line.last[c]",
        "R[line.first[c]",
        "T[c]",
        "(-(nodes)) - 1",
        "rest[c]",
        "by_v * line.damping",
    ),
    "of a place in the record": ("step + 1", "step + (-(1))"),
    "after fifteen iterations": ("auxiliary[:] = T",),
    "of how far the seabed is from converged": ("line.floor", "R[i, n - 1]", "r1[i, n - 1]", "v1[i, n - 1]"),
}
"""Signs that runs of a taut line, all of whose steps succeed, do not show: parts of their faults, by reason."""


def test_planted_signs_of_the_time_step_are_seen(deep, monkeypatch):
    """The sign of each term of the loop over the steps: none leaves order, error and work as they are."""
    survivors = []
    for fault in sign_faults(STEPS, ("integrate",), every=1 if deep else 8):
        monkeypatch.setattr(time_domain, "integrate", interpreted(fault).integrate)
        unseen = any(part in f"{fault.old} -> {fault.new}" for parts in UNSEEN.values() for part in parts)
        if not unseen and not is_red():
            survivors.append(str(fault))
    assert not survivors, "\n".join(survivors)


def test_no_fault_no_red(monkeypatch):
    """The same checks pass on the loop as Python runs it."""
    monkeypatch.setattr(time_domain, "integrate", interpreted().integrate)
    assert not is_red()
