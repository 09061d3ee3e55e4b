"""Are the loads of HB 2.1 and 2.5 those of the formulas, and their derivatives theirs?"""

from __future__ import annotations

import numpy as np
import pytest

from solvers.cable.loads import quadratic_drag, seabed_support, transverse_drag

STEP = 1e-30  # complex, no truncation
EXACT = 1e-15


def test_drag_along_a_direction():
    """-c |q| q sqrt(1 + eps), against the velocity either way, and its derivative."""
    q = np.array([-2.0, 0.0, 3.0])
    value, slope = quadratic_drag(0.5, q, 1.1)
    assert value == pytest.approx([0.5 * 4 * 1.1, 0.0, -0.5 * 9 * 1.1], rel=EXACT)
    assert slope == pytest.approx([-0.5 * 2 * 2 * 1.1, 0.0, -0.5 * 2 * 3 * 1.1], rel=EXACT)


def test_drag_across_follows_the_speed_in_both_directions():
    """Of the velocity (3, -4): speed 5; with unlike coefficients, and none at rest."""
    (normal, binormal), slopes = transverse_drag(0.5, 0.2, np.array([3.0, 0.0]), np.array([-4.0, 0.0]), 1.1)
    assert normal == pytest.approx([-0.5 * 3 * 5 * 1.1, 0.0]) and binormal == pytest.approx([0.2 * 4 * 5 * 1.1, 0.0])
    for parts in slopes:
        for slope in parts:
            assert slope[1] == 0.0


@pytest.mark.parametrize("velocity", [(3.0, -4.0), (0.0, 2.0), (-1e-9, 1e-9), (2.0, 0.0)])
def test_derivatives_of_drag_across(velocity):
    """By complex step."""
    v, w = velocity
    _, slopes = transverse_drag(0.5, 0.2, v, w, 1.1)
    for column, (dv, dw) in enumerate(((1j * STEP, 0.0), (0.0, 1j * STEP))):
        forces, _ = transverse_drag(0.5, 0.2, v + dv, w + dw, 1.1)
        for row, force in enumerate(forces):
            scale = 0.5 * np.hypot(v, w)
            assert slopes[row][column] == pytest.approx(np.imag(force) / STEP, rel=1e-14, abs=1e-14 * scale)


def test_the_seabed_supports_what_sinks_into_it():
    """k times the depth of penetration below it, nothing at it and above."""
    support, slope = seabed_support(2e4, 60.0, np.array([-59.0, -60.0, -60.5, -62.0]))
    assert support.tolist() == [0.0, 0.0, 1e4, 4e4] and slope.tolist() == [0.0, 0.0, -2e4, -2e4]
