"""Are the tangents of the cable the derivatives of its rows? By complex step, for every choice of terms and fields."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from ..cases.cables import EVERYTHING, OC3, OC3_SEABED
from ..tools.planting import Fault, planted
from .problems import (
    SOLVERS,
    by_complex_step,
    jacobian_error,
    random_state,
    statics_jacobian_error,
    system,
    unequal,
)

TANGENT = 1e-12  # relative to the largest entry of the same row and field: a sum of some ten terms; measured 1e-15
SOLVE = 1e-9  # of a solve with the band against a dense one: rounding times the condition, which is about 1e6

CHOICES = [
    pytest.param(
        replace(
            OC3_SEABED if seabed else OC3,
            Cdb=1.2,
            Cdt=0.05 if tangential else 0.0,
            damping=0.02 if damping else 0.0,
            current=current,
            amplitude=(2.0, 0.0, 1.5),
        ),
        fields,
        id=f"{fields}{' seabed' * seabed}{' current' * any(current)}{' tangential' * tangential}{' damped' * damping}",
    )
    for fields, seabed, still, tangential, damping in product(("planar", "spatial"), *[(False, True)] * 4)
    for current in [(0.0, 0.0, 0.0) if still else (0.7, 0.0 if fields == "planar" else 0.4, 0.1)]
]


@pytest.mark.parametrize(("case", "fields"), CHOICES)
def test_tangents_of_the_rows(case, fields):
    """dF/dy and dF/dydot of start, cells and end, and d(drift)/dy, at random states, at one time and at several."""
    assert jacobian_error(case, fields=fields) <= TANGENT
    assert jacobian_error(case, samples=(3,), seed=7, fields=fields) <= TANGENT


@pytest.mark.parametrize(("case", "fields"), [choice for choice in CHOICES if "damped" not in choice.id])
def test_tangents_of_the_equilibrium(case, fields):
    """The tangents of the rows that the equilibrium solves, on the line and off it."""
    assert statics_jacobian_error(case, fields=fields) <= TANGENT


@pytest.mark.parametrize("fields", ["planar", "spatial"])
@pytest.mark.parametrize("case", [OC3, OC3_SEABED], ids=lambda case: case.name)
def test_rows_do_not_depend_on_how_they_are_asked(case, fields):
    """Values without tangents, and samples one by one, are those with tangents and all at once, bit for bit."""
    chain = system(replace(case, Cdt=0.05, damping=0.02), 6, fields=fields)
    y, ydot = random_state(chain, 5, (4,))
    t = np.linspace(0.0, 3.0, 4)
    for rows in (chain.start, chain.cells, chain.end):
        whole = rows(y, ydot, t)
        assert np.array_equal(whole.value, rows(y, ydot, t, False).value)
        for k in range(4):
            one = rows(y[..., k], ydot[..., k], t[k])
            for got, wanted in zip(one, whole, strict=True):
                assert np.array_equal(got, wanted[..., k])


@pytest.mark.parametrize(("case", "fields"), CHOICES[::5])
def test_the_band_is_the_whole_matrix(case, fields):
    """A solve with the band matrix of 0.3 dF/dy + 0.7 dF/dydot is that with the dense matrix by complex step."""
    chain = system(case, 7, fields=fields)
    y, ydot = (part.astype(complex) for part in random_state(chain, 11))
    rows = [part(y, ydot, 1.0) for part in (chain.start, chain.cells, chain.end)]
    band = SOLVERS.numerics.chain.BandedJacobian(len(chain.fields), chain.nodes, chain.start_rows)
    assert band.factorise(*((0.3 * part.dy + 0.7 * part.dydot).real for part in rows))
    n = y.size
    masks = np.eye(n).reshape(n, *y.shape[::-1]).swapaxes(1, 2)  # unknowns node after node
    dense = by_complex_step(lambda x: chain.residual(y + 0.3 * (x - y), ydot + 0.7 * (x - y), 1.0), y, masks)
    right = np.random.default_rng(3).normal(size=n)
    got, wanted = band.solve(right), np.linalg.solve(dense, right)
    assert abs(got - wanted).max() <= SOLVE * abs(wanted).max()


# ---------------------------------------------------------------- the helpers on planted faults
def test_unequal_sees_a_small_entry_and_an_entry_that_should_not_be():
    """An entry 1e12 times smaller than its neighbour is measured by itself, and a false zero is infinite."""
    exact = np.array([[[1e12, 2e12], [1.0, 3.0]]])
    assert unequal(exact, exact) == 0
    assert unequal(exact + np.array([[[0.0], [3e-6]]]), exact) == pytest.approx(1e-6)
    assert unequal(np.array([[[1e-300]]]), np.array([[[0.0]]])) == np.inf
    assert unequal(np.array([[[0.0]]]), np.array([[[1e-300]]])) == 1


def test_complex_step_is_exact():
    """The derivative of a product of fields is exact to rounding."""
    y = np.array([[2.0, 3.0], [5.0, 7.0]], complex)
    masks = [np.array([[1.0, 1.0], [0, 0]]), np.array([[0, 0], [1.0, 1.0]])]
    derivative = by_complex_step(lambda y: (y[0] * y[1] ** 2)[None], y, masks)
    assert derivative[0] == pytest.approx(np.array([[25.0, 49.0], [20.0, 42.0]]), rel=4e-16)


STATICS_FAULTS = [
    Fault("cable.statics", "_Statics.rows", "-slope[:, self.angles, at]", "slope[:, self.angles, at]"),
    Fault("cable.statics", "_Statics.rows", "sign * 2 / system.ds", "sign / system.ds"),
    Fault("cable.statics", "_Statics.rows", "cells.dy[:, :n, -1]", "-cells.dy[:, :n, -1]"),
    Fault("cable.loads", "seabed_support", "np.where(touching, -stiffness, 0.0)", "np.where(touching, stiffness, 0.0)"),
]


@pytest.mark.parametrize("fault", STATICS_FAULTS, ids=str)
def test_a_wrong_tangent_of_the_equilibrium_is_seen(fault):
    """A sign or a factor in the tangents of the positions or of the seabed turns the check red."""
    with planted(fault) as faulty:
        assert statics_jacobian_error(EVERYTHING, faulty) > TANGENT
