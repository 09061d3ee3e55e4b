"""Do the parts of the nested iteration do what they say? Search along a step, stopping rule, step within rounding."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from solvers import Element, Environment, Network, Node
from solvers.network import nested, rounding
from solvers.network.equations import Geometry
from solvers.network.nested import Balance, Count

from ..cases.networks import bridle, two_line
from .test_solve import network_of, solved


class Bowl:
    """Equations of one node at the height z with the energy z^2/2; beyond ``finite`` the force is nan."""

    def __init__(self, finite=np.inf):
        self.finite, self.tried = finite, []

    def lift_to_seabed(self, r):
        """No seabed."""
        return r

    def solve_elements(self, r):
        """The position in place of elements."""
        self.tried.append(r[0, 2])
        return SimpleNamespace(r=r, inner_iterations=0)

    def unbalanced_force(self, elements):
        """-z, upwards."""
        z = elements.r[0, 2]
        return np.array([[0.0, 0.0, -z if abs(z) < self.finite else np.nan]])

    def moving_coordinates(self, r, force):
        """The height."""
        return np.array([[False, False, True]])


def search(size, bowl=None):
    """Return (length, heights that were tried) of a step from z = -1 that is ``size`` times the one to the bottom."""
    bowl = bowl or Bowl()
    now = nested.evaluate_balance(bowl, np.array([[0.0, 0.0, -1.0]]), Count())
    length, new = nested._search_along(bowl, now, np.array([[0.0, 0.0, size]]), Count())
    assert new is None or new.r[0, 2] == pytest.approx(length * size - 1)
    return length, bowl.tried[1:]


@pytest.mark.parametrize("size", [0.01, 1.0, 1.89])
def test_a_step_is_taken_that_lets_the_energy_fall_or_its_slope(size):
    """Short of the bottom, there, or beyond it by less than nine tenths of the way to it."""
    assert search(size) == (1.0, [pytest.approx(size - 1)])


@pytest.mark.parametrize("size", [1.91, 3.0, 9.0])
def test_a_longer_step_ends_where_the_slope_would_vanish(size):
    """By the secant of the slopes, exact for this energy."""
    assert search(size) == (pytest.approx(1 / size), [pytest.approx(size - 1), pytest.approx(0.0)])


def test_a_step_is_cut_to_a_tenth_at_most_and_where_it_is_not_finite():
    """Twentyfold: to 0.1, then by the secant; to 0.3 where the force is nan; not at all after twelve trials."""
    assert search(20.0)[1] == pytest.approx([19.0, 1.0, 0.0])
    assert search(1.0, Bowl(finite=1.5))[0] == 1.0
    assert search(10.0, Bowl(finite=3.0))[1] == pytest.approx([9.0, 2.0, 0.0])
    length, tried = search(1.0, SlopelessBowl())
    assert length == 0.0 and len(tried) == 12


class SlopelessBowl(Bowl):
    """One whose force is nan everywhere but at the start."""

    def unbalanced_force(self, elements):
        """-z at -1."""
        z = elements.r[0, 2]
        return np.array([[0.0, 0.0, -z if z == -1.0 else np.nan]])


def solved_at(forces, rounding_floor) -> list[bool]:
    """Return what ``is_solved`` says of one unbalanced force after the other, where none is small enough."""
    method = nested._RegularisedNewton(None, lambda elements: 1e-9, Count(), rounding_floor)
    moving = np.array([[False, False, True]])
    return [method.is_solved(Balance(None, None, np.array([[9.0, 9.0, f]]), moving)) for f in forces]


def test_rounding_is_accepted_when_it_no_longer_falls():
    """After three iterations in which the least force was not halved; at once what is small enough."""
    assert solved_at([8.0, 3.0, 1.0, 0.9, 0.8, 0.7], 1.0) == [False, False, False, False, False, True]
    assert solved_at([1.0, 0.4, 0.15, 0.05, 0.05, 0.05, 0.05], 1.0) == [*[False] * 6, True]
    assert solved_at([1.0, 1.0, 1.0, 1.0, 1.0], 0.9) == [False] * 5
    assert solved_at([1.0, 1e-9], 0.0) == [False, True]


# ---------------------------------------------------------------- a step within the rounding of positions
def step_within_rounding(tangent, force):
    """Return ``_newton_step`` of one node with a tangent (3, 3) and no regularisation."""
    equations = SimpleNamespace(
        dof=np.array([[0, 1, 2]]), size=3, tangent=lambda elements: np.array(tangent), soft_stiffness=0.0
    )
    moving = np.array([[True, True, True]])
    return rounding._newton_step(equations, None, np.array([force]), moving, Count())


def test_a_step_that_does_not_exist_is_none():
    """A singular tangent, or one that is not finite."""
    assert step_within_rounding(np.diag([1.0, 2.0, 4.0]), [1.0, 1.0, 1.0]).tolist() == [[1.0, 0.5, 0.25]]
    assert step_within_rounding(np.zeros((3, 3)), [1.0, 1.0, 1.0]) is None
    assert step_within_rounding(np.diag([1.0, 2.0, 4.0]), [1.0, np.nan, 1.0]) is None


@pytest.mark.parametrize("case", [bridle(), two_line()], ids=lambda case: case.name)
def test_all_spans_of_a_refinement_are_counted(case, monkeypatch):
    """At the positions, a rounding further apart, and at the new positions."""
    iterations, exact_forces = [], rounding.exact_forces

    def recorded(*arguments):
        result = exact_forces(*arguments)
        iterations.append(result[2])
        return result

    monkeypatch.setattr(rounding, "exact_forces", recorded)
    equations, count = network_of(case).equations, Count()
    assert rounding.refine_within_rounding(equations, solved(case).r, 1e-13, count) is not None
    assert len(iterations) == 3 and count.inner_iterations == sum(iterations) > 0


def test_stretched_lines_are_a_rounding_longer():
    """In their own direction; but no fairlead below the seabed, on which one of them lies."""
    nodes = [Node("fixed", (0.0, 0.0, -30.0)), Node("fixed", (60.0, 0.0, -45.0)), Node("coupled", (80.0, 0.0, -50.0))]
    lines = [Element(10.0, 1e6, 70.0, (0, 1)), Element(10.0, 1e6, 70.0, (0, 2)), Element(10.0, 1e6, 70.0, (2, 0))]
    equations = Network(nodes, lines, Environment(depth=50.0)).equations
    geometry = Geometry(equations, equations.position)
    geometry.rounding = np.full(3, 1e-3)  # m, to be seen
    stretched = rounding._stretched(equations, geometry)
    chords = np.hypot(geometry.l, geometry.rise)
    assert stretched.l == pytest.approx(geometry.l * (1 + 1e-3 / chords), rel=1e-15)
    assert stretched.rise == pytest.approx(geometry.rise * (1 + np.array([1, 0, 1]) * 1e-3 / chords), rel=1e-15)
