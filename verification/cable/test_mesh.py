"""Are meshes checked, coarsened and refined as they say, and are the stencils on them exact for cubics?"""

from __future__ import annotations

import numpy as np
import pytest

from solvers import InputError
from solvers.cable.mesh import check_mesh, every_second_node, refine, trapezoidal_weights
from solvers.cable.midpoint_stencils import midpoint_stencils

UNEVEN = np.array([0.0, 1.0, 1.5, 4.0, 6.5, 7.0])


def test_a_uniform_mesh_has_so_many_nodes():
    assert check_mesh(3, None, 10.0).tolist() == [0.0, 5.0, 10.0]
    assert check_mesh(10**6, None, 1.0).size == 10**6
    for nodes in (2, 10**6 + 1):
        with pytest.raises(InputError, match=r"^nodes: .* must be a whole number from 3 to 1000000"):
            check_mesh(nodes, None, 1.0)


def test_a_given_mesh_is_taken_as_it_is():
    """Three nodes at least, from 0 to the length, which may be missed by a rounding."""
    for s in ([0, 4, 7], UNEVEN, [0.0, 1.0, 7.0 * (1 + 0.9e-12)], [0.0, 1.0, 7.0 * (1 - 0.9e-12)]):
        assert check_mesh(None, s, 7.0).tolist() == list(s)


@pytest.mark.parametrize(
    ("mesh", "message"),
    [
        ([0.0, 7.0], "three or more finite, increasing"),
        ([[0.0, 1.0, 7.0]], "three or more finite, increasing"),
        ([0.0, 1.0, 1.0, 7.0], "three or more finite, increasing"),
        ([0.0, 2.0, 1.0, 7.0], "three or more finite, increasing"),
        ([0.0, np.nan, 7.0], "three or more finite, increasing"),
        (["a", "b", "c"], r"must be arc lengths \(m\)"),
        ([1e-9, 1.0, 7.0], "runs from 1e-09 to 7 m, it must run from 0 to the length, 7 m"),
        ([0.0, 1.0, 7.0 * (1 + 1.1e-12)], "it must run from 0 to the length, 7 m"),
        ([0.0, 1.0, 7.0 * (1 - 1.1e-12)], "it must run from 0 to the length, 7 m"),
    ],
)
def test_other_meshes_are_refused(mesh, message):
    with pytest.raises(InputError, match=rf"^mesh: .*{message}"):
        check_mesh(None, mesh, 7.0)


def test_a_mesh_is_made_coarser_by_every_second_node():
    """The last node stays, after one cell of the old mesh where the number of nodes is even."""
    assert every_second_node(7).tolist() == [0, 2, 4, 6]
    assert every_second_node(8).tolist() == [0, 2, 4, 6, 7]


def test_a_mesh_is_made_finer_cell_by_cell():
    assert refine(np.array([0.0, 3.0, 4.0]), 3).tolist() == pytest.approx([0, 1, 2, 3, 10 / 3, 11 / 3, 4])
    assert refine(UNEVEN, 1).tolist() == UNEVEN.tolist()


def test_the_trapezoidal_rule_is_exact_for_lines():
    weights = trapezoidal_weights(np.diff(UNEVEN))
    assert weights.tolist() == [0.5, 0.75, 1.5, 2.5, 1.5, 0.25]
    assert weights @ (3.0 + 2.0 * UNEVEN) == pytest.approx(3.0 * 7.0 + 7.0**2)


# ---------------------------------------------------------------- stencils
def polynomial(degree, order, s):
    """Return s^degree (order 0), its derivative (1) or its integral from 0 (-1)."""
    if order == 1:
        return degree * s ** max(degree - 1, 0)
    return s ** (degree - order) / (1 if order == 0 else degree + 1)


@pytest.mark.parametrize(("s", "highest"), [(UNEVEN, 3), (UNEVEN[:4], 3), (np.array([0.0, 1.0, 3.0]), 2)])
def test_stencils_are_exact_for_polynomials(s, highest):
    """Value and slope at the midpoints, integral over the cells and over all: cubics, on three nodes quadratics."""
    stencils, middle = midpoint_stencils(s), (s[1:] + s[:-1]) / 2
    assert stencils.at.shape == stencils.value.shape == (s.size - 1, highest + 1)
    for degree in range(highest + 1):
        q = np.stack([polynomial(degree, 0, s), -2 * polynomial(degree, 0, s)])
        value, slope, integral = stencils(q, stencils.value, stencils.slope, stencils.integral)
        for got, wanted in (
            (value, polynomial(degree, 0, middle)),
            (slope, polynomial(degree, 1, middle)),
            (integral, np.diff(polynomial(degree, -1, s))),
        ):
            assert got == pytest.approx(np.stack([wanted, -2 * wanted]), rel=1e-12, abs=1e-12 * s[-1] ** degree)
        assert stencils.quadrature() @ q[0] == pytest.approx(polynomial(degree, -1, s[-1]), rel=1e-13)


def test_stencils_lie_about_their_cell():
    """One node beyond either side, where the mesh has one."""
    assert midpoint_stencils(UNEVEN).at[:, 0].tolist() == [0, 0, 1, 2, 2]


def test_stencils_take_samples():
    """Sums over nodes for each sample alone."""
    stencils, q = midpoint_stencils(UNEVEN), np.random.default_rng(2).normal(size=(3, 6, 2, 4))
    (value,) = stencils(q, stencils.value)
    assert value.shape == (3, 5, 2, 4)
    assert np.array_equal(value[..., 1, 2], stencils(q[..., 1, 2], stencils.value)[0])
