"""Are observed orders and numerical uncertainties those of manufactured sequences, and are their limits named?"""

from __future__ import annotations

import numpy as np
import pytest

from .refinement import EXPANSION, SAFETY_FAR, SAFETY_NEAR, estimate_uncertainty, largest

SIZES = (50, 100, 200)
T = 2 * np.pi * np.arange(64) / 64
WAVE, ERROR = 3.0 + np.sin(T), np.cos(2 * T)
EXACT = 1e-6  # relative: the sequences are exact but for rounding of 1e-16 in differences of 1e-9 and more


def sequence(order: float, sizes=SIZES, constant: float = 0.5, limit=WAVE, error=ERROR):
    """Runs whose error is ``constant`` h^order, h = 1/size."""
    return [limit + constant * float(size) ** -order * error for size in sizes]


@pytest.mark.parametrize("sizes", [SIZES, (49, 99, 199), (20, 30, 60)])
@pytest.mark.parametrize("order", [1.0, 1.9, 2.0, 4.0])
def test_the_order_of_a_manufactured_sequence_is_found(order, sizes):
    """With equal and unequal ratios of refinement."""
    result = estimate_uncertainty(sizes, sequence(order, sizes), 2.0, order)
    assert result.is_asymptotic and result.order == pytest.approx(order, rel=EXACT)


def test_the_uncertainty_is_that_of_the_finest_run():
    """At the formal order u_num is 1.25/1.15 of the true error of the finest run, relative to the scale."""
    result = estimate_uncertainty(SIZES, sequence(2.0), 2.0)
    true = 0.5 / 200**2 * np.sqrt(0.5) / 2.0
    assert result.safety == SAFETY_NEAR == 1.25 and result.expansion == EXPANSION == 1.15
    assert result.u_num == pytest.approx(1.25 / 1.15 * true, rel=EXACT)
    assert result.change == pytest.approx(3 * true, rel=EXACT)


def test_a_number_by_hand():
    """1.16, 1.04, 1.01: order 2, and 1.25 (0.03 / 3) / 1.15."""
    result = estimate_uncertainty((1, 2, 4), (1.16, 1.04, 1.01), 1.0)
    assert result.order == pytest.approx(2.0, rel=1e-12)
    assert result.u_num == pytest.approx(1.25 * 0.01 / 1.15, rel=1e-12)


@pytest.mark.parametrize(("order", "used"), [(1.0, 1.0), (0.2, 0.5), (3.0, 2.0), (6.0, 2.0)])
def test_away_from_the_formal_order_the_safety_factor_is_three(order, used):
    """The order that counts stays between 0.5 and the formal one, so that chance makes no uncertainty small."""
    runs = sequence(order, (5, 10, 20))
    result = estimate_uncertainty((5, 10, 20), runs, 2.0)
    change = np.sqrt(np.mean((runs[2] - runs[1]) ** 2)) / 2.0
    assert result.safety == SAFETY_FAR == 3.0 and result.order == pytest.approx(order, rel=EXACT)
    assert result.u_num == pytest.approx(3.0 * change / (2.0**used - 1) / 1.15, rel=EXACT)


@pytest.mark.parametrize("values", [(1.0, 1.4, 1.1), (1.0, 1.1, 1.4), (1.0, 1.1, 1.2)], ids=("back", "away", "evenly"))
def test_what_does_not_converge_is_not_in_the_asymptotic_range(values):
    """No order; the uncertainty is the range of the three."""
    result = estimate_uncertainty(SIZES, values, 2.0)
    assert not result.is_asymptotic and result.order is None and result.safety is None
    assert result.u_num == pytest.approx((max(values) - min(values)) / 2.0, rel=1e-12)


def test_a_wave_that_changes_otherwise_each_time_has_no_order():
    """Differences of falling size but other shape are not one error C h^p; of a truncated series they are."""
    runs = [WAVE, WAVE + 0.1 * np.cos(5 * T), WAVE + 0.1 * np.cos(5 * T) + 0.025 * np.cos(9 * T)]
    assert not estimate_uncertainty(SIZES, runs, 2.0).is_asymptotic
    truncated = estimate_uncertainty(SIZES, runs, 2.0, is_truncation=True)
    assert truncated.is_asymptotic and truncated.order == pytest.approx(2.0, rel=1e-12)
    assert not estimate_uncertainty(SIZES, [runs[0], runs[1], 1.5 * runs[2]], 2.0, is_truncation=True).is_asymptotic


def test_runs_that_differ_by_rounding_have_no_order():
    result = estimate_uncertainty(SIZES, [WAVE + 0.1, WAVE, WAVE + 1e-15], 2.0)
    assert result.is_asymptotic and result.order is None and result.u_num < 1e-15


def test_the_worst_of_several_is_taken():
    results = [estimate_uncertainty(SIZES, sequence(2.0, constant=c), 2.0) for c in (0.1, 0.7, 0.3)]
    assert largest(results) is results[1]


@pytest.mark.parametrize("sizes", [(100, 50, 25), (50, 50, 100), (50, 100), (0, 1, 2)])
def test_sizes_that_do_not_grow_are_refused(sizes):
    with pytest.raises(ValueError, match="three growing sizes"):
        estimate_uncertainty(sizes, [1.0] * len(sizes), 1.0)
