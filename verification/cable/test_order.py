"""Is the scheme of the cable what it says: exact where it must be, of second order elsewhere, and nothing else?

Truth is the independent equations of exact/cable_mp. Fields linear in s are exact in the box scheme and fields linear
in t in a second-order time scheme, so each order is measured without the other. The last part plants a fault in each
single term and asks which check sees it.
"""

from __future__ import annotations

import numpy as np
import pytest

from ..defects.planted.cables import ERRATA_FAULTS, LOAD_FAULTS
from ..exact.cable import cable_mp
from ..reference import EPS
from ..tools.orders import assert_order, differences, extrapolated, observed_orders
from ..tools.planting import Fault, planted, sign_faults
from .problems import (
    LENGTH,
    SOLVERS,
    TERMS,
    Manufactured,
    chosen_fields,
    geometry_error,
    graded,
    patch_error,
    red_checks,
)

ROUNDING = 10 * EPS  # of a residual over its largest part: a row is a sum of ten or so; measured 1 eps
LINEAR_RUN = 2000 * EPS  # of ten exact steps, through the inverse of each; measured 300 eps
NODES = (17, 33, 65)
MESH_CEILING = 1.2e-3  # error relative to the field at 65 nodes: twice the largest measured, 5.7e-4
DTS = (1 / 32, 1 / 64)  # s, for fields that vary with 4 rad/s
TIME_CEILING = 0.03  # at dt = 1/64 s: twice the largest measured, 0.014 (normal velocity over a seabed)
BOTH_CEILING = 1e-3  # at 65 nodes and 128 steps: twice the largest measured, 4.6e-4
SPATIAL = pytest.mark.parametrize("planar", [True, False], ids=["planar", "spatial"])
EACH_TERM = pytest.mark.parametrize("name", TERMS)


# ---------------------------------------------------------------- exact to rounding
@SPATIAL
@EACH_TERM
def test_fields_linear_in_s_leave_no_residual(name, planar):
    """Fields linear in s solve the box scheme to rounding on an uneven mesh, across the kinks of drag and seabed."""
    assert patch_error(TERMS[name], planar) <= ROUNDING


@SPATIAL
@EACH_TERM
def test_fields_linear_in_s_and_t_are_reproduced(name, planar):
    """Ten large time steps through fields linear in s and t end on them to rounding."""
    fields = chosen_fields(TERMS[name], space="linear", time="linear", planar=planar)
    errors = Manufactured(TERMS[name], fields, 7, planar=planar, by_cells=True).errors(dt=0.1, duration=1.0)
    assert errors.max() <= LINEAR_RUN, errors


@SPATIAL
def test_geometry_is_that_of_the_conventions(planar):
    """Positions, directions and the drift of the end are the integral of (1 + eps) t and t of the public frame."""
    assert geometry_error(planar) <= ROUNDING


# ---------------------------------------------------------------- orders
@SPATIAL
@EACH_TERM
def test_order_in_ds(name, planar):
    """Fields linear in t, curved in s: the error falls with ds^2, each term alone and all together."""
    errors_in_ds(name, planar, NODES, lambda n: None)


@SPATIAL
@pytest.mark.parametrize("name", ["bare", "all"])
def test_order_in_ds_on_a_graded_mesh(name, planar):
    """The same where the last cell is four times as long as the first."""
    errors_in_ds(name, planar, NODES, lambda n: graded(LENGTH, n))


@SPATIAL
@EACH_TERM
def test_order_of_the_corrected_rows(name, planar):
    """Rows of cells of fourth order at fields curved in s and t: what is left falls with ds^4, the end cells apart."""
    fields, left = chosen_fields(TERMS[name], space="curved", time="curved", planar=planar), []
    for n in NODES:
        problem = Manufactured(TERMS[name], fields, n, planar=planar)
        y, _, ydot = problem.state(0.3)
        rows = problem.system.fourth_order().cells(y, ydot, 0.3, False)
        left.append(abs(rows.value[:, 1:-1]).max())
    assert_order([1 / (n - 1) for n in NODES], left, 4, ceiling=CORRECTED, what=f"{name}, corrected rows")


CORRECTED = 3e-4  # at 65 nodes, N/m or 1/s: twice the largest measured, 1.3e-4


def errors_in_ds(name, planar, nodes, mesh):
    fields = chosen_fields(TERMS[name], space="curved", time="linear", planar=planar, span=20.0)
    problems = [Manufactured(TERMS[name], fields, n, planar=planar, mesh=mesh(n)) for n in nodes]
    errors = [problem.errors(dt=2.0, duration=20.0).max() for problem in problems]
    assert_order([1 / (n - 1) for n in nodes], errors, 2, ceiling=MESH_CEILING, what=f"{name}, ds")


@SPATIAL
@EACH_TERM
def test_order_in_dt(name, planar, deep):
    """Fields linear in s, curved in t: the error falls with dt^2, each term alone and all together."""
    errors_in_dt(name, planar, (*DTS, 1 / 128) if deep else DTS)


SCHEMES = {
    "box method": ({"rho_inf": 1.0}, 2),
    "rho_inf 0.5": ({"rho_inf": 0.5}, 2),
    "rho_inf 0": ({"rho_inf": 0.0}, 2),
    "trapezoid": ({"scheme": SOLVERS.time_domain.generalized_alpha.Scheme(1.0, 1.0, 0.5)}, 2),
    "backward Euler": ({"scheme": SOLVERS.time_domain.generalized_alpha.Scheme.backward_euler()}, 1),
}
FINE = (1 / 128, 1 / 256)  # s: strong damping needs finer steps to show its order


@SPATIAL
@pytest.mark.parametrize("scheme", SCHEMES)
def test_order_in_dt_of_each_scheme(scheme, planar, deep):
    """Every second-order choice of the scheme has order 2 and backward Euler order 1, with all terms."""
    options, order = SCHEMES[scheme]
    slow = scheme in ("rho_inf 0", "backward Euler")
    errors_in_dt("all" if order == 2 else "bare", planar, FINE if slow else DTS, order, **options)


def errors_in_dt(name, planar, dts, order=2, **options):
    fields = chosen_fields(TERMS[name], space="linear", time="curved", planar=planar)
    problem = Manufactured(TERMS[name], fields, 3, planar=planar, by_cells=True)
    errors = [problem.errors(dt=dt, duration=1.0, **options).max() for dt in dts]
    ceiling = TIME_CEILING if order == 2 else 1.0  # backward Euler only has to show its order
    assert_order(dts, errors, order, ceiling=ceiling, what=f"{name}, dt {options}")


@SPATIAL
def test_order_in_ds_and_dt_together(planar):
    """Waves through the line, all terms on, ds and dt halved together: the error falls with their square."""
    fields = cable_mp.manufactured(TERMS["all"], LENGTH, 0.3, planar=planar)
    errors = [
        Manufactured(TERMS["all"], fields, n, planar=planar).errors(dt=5.0 / (n - 1), duration=10.0).max()
        for n in NODES
    ]
    assert_order([1 / (n - 1) for n in NODES], errors, 2, ceiling=BOTH_CEILING, what="ds and dt")


@SPATIAL
def test_truncation_on_any_mesh_is_of_second_order(planar):
    """The residual at curved fields falls with ds^2 also where cells of two sizes alternate at random."""
    fields = chosen_fields(TERMS["all"], space="curved", time="curved", planar=planar)
    halves = np.random.default_rng(2026).uniform(0.3, 1.7, 16)
    sizes = []
    for split in (1, 2, 4):
        cells = np.repeat(halves / split, split)
        s = np.concatenate([[0.0], np.cumsum(cells)]) * (LENGTH / cells.sum())
        s[-1] = LENGTH
        problem = Manufactured(TERMS["all"], fields, None, planar=planar, mesh=s)
        y, _, ydot = problem.state(0.4)
        sizes.append(abs(problem.system.residual(y, ydot, 0.4)).max())
    assert_order([1, 1 / 2, 1 / 4], sizes, 2, ceiling=sizes[0], what="residual")


# ---------------------------------------------------------------- the helpers themselves
H = np.array([0.4, 0.2, 0.1, 0.05])


@pytest.mark.parametrize("order", [1, 2, 3, 2.3])
@pytest.mark.parametrize("factor", [3.0, -1e-4])
def test_planted_orders_are_found(order, factor):
    """Errors C h^p of either sign show p, and values 1 + C h^p extrapolate to 1."""
    errors = factor * H**order
    assert observed_orders(H, errors) == pytest.approx(np.full(3, order), abs=1e-10)
    assert observed_orders(H[1:], differences(1 + 7 * errors)) == pytest.approx(np.full(2, order), abs=1e-6)
    assert extrapolated(H, 1 + errors, order) == pytest.approx(1.0, abs=10 * EPS)
    assert_order(H, errors, order, ceiling=abs(factor))


@pytest.mark.parametrize(
    ("errors", "why"),
    [
        (H**1.94, "order 0.06 low"),
        (H**2.06, "order 0.06 high"),
        (2 * H**2, "ceiling"),
        ([0.1, 0.05, 0.02, 0.02], "stalls"),
        ([0.16, 0.04, 0.01, -0.0025], "sign changes"),
        ([0.16, 0.04, 0.01, np.nan], "not a number"),
        (1e-16 * H**2, "nothing above the floor"),
    ],
)
def test_planted_defects_of_an_error_table_fail(errors, why):
    """A wrong order either way, a wrong constant, a stall, a change of sign, nan and rounding alone are refused."""
    with pytest.raises(AssertionError):
        assert_order(H, errors, 2, ceiling=2.0 * H[-1] ** 2 - 1e-9, floor=1e-14)


def test_errors_at_the_floor_are_left_out():
    """The order is read above rounding."""
    assert_order(H, [0.16, 0.04, 1e-16, 2e-16], 2, ceiling=1.0, floor=1e-14)


@pytest.mark.parametrize("steps", [[0.1], [0.1, 0.2], [0.1, 0.0], [0.2, 0.1, 0.05]])
def test_tables_that_are_none_are_refused(steps):
    """One step, growing steps, a zero step or a missing error is an error of the caller."""
    with pytest.raises(ValueError, match="decreasing steps"):
        observed_orders(steps, [1.0, 2.0])


# ---------------------------------------------------------------- planted faults
SHARE = 30  # every thirtieth sign by default; all of them in the long version
SIGNS = {
    "cable.equations": ("_box_scheme", "velocity", "stretched_tangent"),
    "cable.planar": ("local_terms", "add_stiffness", "add_stiffness_tangents", "frame"),
    "cable.spatial": (
        "__init__",
        "local_terms",
        "stiffness_coefficients",
        "add_stiffness",
        "add_stiffness_tangents",
        "frame",
    ),
}
"""Functions of the box scheme and of HB (1)-(12) in which each term in turn is planted with the wrong sign."""


@pytest.mark.parametrize(("fault", "what"), ERRATA_FAULTS + LOAD_FAULTS, ids=lambda v: None)
def test_a_planted_misprint_is_seen(fault, what):
    """Each erratum of HB and each wrong load turns a check of values red, a wrong tangent the complex step."""
    with planted(fault) as faulty:
        assert red_checks(faulty), what


def test_planted_signs_are_seen(deep):
    """The sign of each single term of M, K, f, of the kinematics and of their tangents: no fault passes all checks.

    A fault that changes a value must be seen by the values; the tangents' checks see the others.
    """
    survivors = []
    for module, functions in SIGNS.items():
        for fault in sign_faults(module, functions, every=1 if deep else SHARE):
            with planted(fault) as faulty:
                if not red_checks(faulty):
                    survivors.append(str(fault))
    assert not survivors, "\n".join(survivors)


def test_no_fault_no_red():
    """The same checks pass on a copy of the solvers with a change that is none, and a fault not found is refused."""
    with planted(Fault("cable.loads", "quadratic_drag", "2 * slope", "2 * slope * 1")) as copy:
        assert not red_checks(copy)
    with (
        pytest.raises(ValueError, match="not once"),
        planted(Fault("cable.loads", "quadratic_drag", "no_such_code()", "1")),
    ):
        pass
