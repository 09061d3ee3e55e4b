"""Are the starts of the iterations near their roots in the limits that they are made for?

An iteration with a bracket converges from any start, so a wrong one costs steps and no digits: nothing else sees it.
"""

from __future__ import annotations

import pytest

from solvers.catenary import regimes, suspended
from solvers.catenary.regimes import hanging_length
from solvers.numerics.elementary import SCALAR
from solvers.numerics.newton import monotone_root

EPS = 1e-15
PYTHAGORAS = (0.6, 0.8)  # reach and height of a chord of length 1


def start_over_root(start, residual, arguments) -> float:
    """Return the start of an iteration, divided by the root that it leads to."""
    first, upper = start(SCALAR, *arguments)
    root, _, _, converged = monotone_root(residual, first, upper, arguments, EPS)
    assert converged
    return first / root


def free(l, h, e) -> float:
    """Return ``start_over_root`` of a line that hangs free."""
    return start_over_root(suspended.suspended_start, suspended.suspended_residual, (l, h, e))


def steep(l, h, e) -> float:
    """Return ``start_over_root`` of a steep line."""
    return start_over_root(suspended.steep_start, suspended.steep_residual, (l, h, e))


def grounded(l, h, e, CB=0.0) -> float:
    """Return ``start_over_root`` of a line that rests on the seabed."""
    return start_over_root(regimes.grounded_start, regimes.grounded_residual, (l, h, e, CB))


@pytest.mark.parametrize("e", [1e-4, 1e-6])
@pytest.mark.parametrize("chord", [1.1, 2.0])
def test_an_over_stretched_line(e, chord):
    """Straight, with T = (chord - 1)/e: half the difference of asinh(V/H) from its strain; both unknowns."""
    l, h = (chord * part for part in PYTHAGORAS)
    assert free(chord, 0.0, e) == pytest.approx(1.0, abs=1e-5)
    assert free(l, h, e) == pytest.approx(1.0, abs=1e-5)
    assert steep(0.6, 1.1, e) == pytest.approx(1.0, abs=1e-3)
    assert steep(0.05, 1.1, e) == pytest.approx(1.0, abs=0.02)


def test_an_over_stretched_line_on_the_seabed():
    """h = H p^2/2 (1 + e H), with H = (l - 1)/e from the stretch along the seabed."""
    for l, h, e in ((1.1, 1e-4, 1e-2), (1.1, 0.01, 1e-4), (1.01, 1e-4, 1e-4)):
        assert grounded(l, h, e) == pytest.approx(1.0, abs=1e-4), (l, h, e)
        assert grounded(l, h, e, CB=0.5) == pytest.approx(1.0, abs=2e-3), (l, h, e)


@pytest.mark.parametrize("l", [1e-3, 1e-6, 1e-9])
def test_a_nearly_vertical_line(l):
    """Stretched or just as long as its height: t from the distance to y_max, which falls with the square of l."""
    for h in (1.01, 1.3, 2.0):
        assert steep(l, h, 1e-3) == pytest.approx(1.0, abs=1e-4), h


def test_a_nearly_taut_line():
    """Up to the factor 2^(1/3) by which the stretch under its own tension makes a line sag more."""
    for e in (1e-4, 1e-6, 1e-9):
        for l, h in ((1.0, 0.0), PYTHAGORAS):
            assert free(l, h, e) == pytest.approx(0.5 ** (1 / 3), rel=2e-3), (l, h, e)


def test_a_slack_line_that_hangs_free():
    """From sinh(y)/y = sqrt(1 - h^2)/l: within 5 % over twelve orders of the reach."""
    for h in (0.0, 0.5):
        for l, least in ((0.9, 0.99), (0.5, 0.98), (0.1, 0.97), (1e-6, 0.95), (1e-12, 0.95)):
            assert least < free(l * (1 - h * h) ** 0.5, h, 1e-6) < 1.0, (l, h)


def test_a_nearly_slack_line_on_the_seabed():
    """The more exact the less is left of its length on the seabed; a taut one from p = 3 (L - l)/h."""
    for e in (1e-4, 1e-2):
        hanging = hanging_length(SCALAR, 0.3, e)
        for spare, error in ((1e-2, 0.01), (1e-4, 2e-3), (1e-8, 1e-3), (1e-12, 1e-3)):
            assert grounded(1 - hanging + spare, 0.3, e) == pytest.approx(1.0, abs=error), (e, spare)
    for h in (0.01, 0.1):
        hanging = hanging_length(SCALAR, h, 1e-7)
        for share, error in ((0.1, 0.02), (0.3, 0.02), (0.5, 0.03)):
            assert grounded(1 - share * hanging, h, 1e-7) == pytest.approx(1.0, abs=error), (h, share)
