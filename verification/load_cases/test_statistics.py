"""Statistics of a tension: cycles of ASTM E1049, Rayleigh and Dirlik in Gaussian series, worth of a Weibull fit."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy import stats

from solvers.load_cases.integration import LineSeries
from solvers.load_cases.results import line_result
from solvers.load_cases.statistics import (
    FEWEST_PEAKS,
    WeibullFit,
    damage_equivalent_load,
    find_peaks,
    fit_weibull,
    refine_extremes,
)

from ..exact.gaussian import dirlik_load, gaussian_series, narrow_band_load, rayleigh_extreme

SEEDS = 60  # of Gaussian series: their averages err by a 1/sqrt(60) of what one errs by
ERRORS = 3.5  # standard errors of an average: once in two thousand
CUT = 5e-3  # relative: half a cycle of a hundred, at the ends
PARABOLA = 8e-5  # relative: of a turning point of a sine with 20 samples a period, (pi/10)^4 / 128
STAIRS = 1e-4  # relative: turning points of half cosines of unlike height, 400 samples each
DIRLIK = 0.05  # relative: within which Dirlik's formula meets rainflow counts of broad-banded series
NARROW = 0.02  # relative: narrow-band theory for a band of 0.04 of its frequency, neither limit quite reached
HOUR, STEP = 3600.0, 0.25  # s

ASTM = [-2, 1, -3, 5, -1, 3, -4, 4, -2]
ASTM_CYCLES = {3: 0.5, 4: 1.5, 6: 0.5, 8: 1.0, 9: 0.5}
"""ASTM E1049-85 (2017), fig. 6: peaks and valleys, and how many cycles it counts of which range."""


def gaussian(seed: int, lowest: float, highest: float, duration: float = HOUR) -> np.ndarray:
    """Return a Gaussian series of unit variance with a level spectrum between two frequencies in Hz."""
    return gaussian_series(seed, lowest, highest, duration, STEP)


def test_cycles_of_the_standard():
    """The history of ASTM E1049, fig. 6, does the damage of its cycles, at every exponent."""
    half = (1 - np.cos(math.pi * np.arange(400) / 400)) / 2
    series = np.concatenate([a + (b - a) * half for a, b in pairwise(ASTM)] + [[ASTM[-1]]])
    for exponent in (1.0, 3.0, 5.0):
        damage = sum(count * span**exponent for span, count in ASTM_CYCLES.items())
        expected = (damage / 50.0) ** (1 / exponent)
        assert damage_equivalent_load(series, 50.0, exponent) == pytest.approx(expected, rel=STAIRS)


def test_cycles_of_a_sine():
    """n cycles of range 2 a in T seconds are 2 a (n/T)^(1/m), though no sample lies on a crest."""
    t = 0.5 * np.arange(2001) + 0.13
    series = 7.0 + 3.0 * np.sin(2 * math.pi * 0.1 * t)
    assert damage_equivalent_load(series, 1000.0, 3.0) == pytest.approx(6.0 * 0.1 ** (1 / 3), rel=PARABOLA + CUT / 3)
    turns = refine_extremes(series)[1:-1]
    assert abs(abs(turns - 7.0) - 3.0).max() <= 3 * PARABOLA
    assert damage_equivalent_load(np.full(9, 2.0), 9.0, 3.0) == 0.0


def test_a_flat_crest_is_one_turning_point():
    """Equal samples beside one another are one, and a rising series has none."""
    assert refine_extremes([0.0, 1.0, 1.0, 0.0]).tolist() == [0.0, 1.0, 0.0]
    assert refine_extremes([0.0, 1.0, 2.0]).tolist() == [0.0, 2.0]


def test_narrow_band_has_rayleigh_peaks(record_property):
    """Their peaks are Rayleigh's: shape 2, extreme sqrt(2 ln N); their damage has a Gamma(1 + m/2) in it."""
    lowest, highest, exponent, duration = 0.098, 0.102, 3.0, 20 * HOUR
    fits, extremes, loads = [], [], []
    for seed in range(SEEDS // 3):
        series = gaussian(seed, lowest, highest, duration)
        deviation = series.std()
        fit = fit_weibull(find_peaks(series))
        fits.append((fit.shape, fit.scale / deviation))
        extremes.append(fit.extreme(1080.0)[0] / deviation)
        loads.append(damage_equivalent_load(series, duration, exponent) / deviation)
    theory = narrow_band_load(0.1, exponent)
    wanted = {"shape": 2.0, "scale": math.sqrt(2), "extreme": rayleigh_extreme(1080.0), "damage": theory}
    got = np.column_stack([fits, extremes, loads])
    for (name, value), column in zip(wanted.items(), got.T, strict=True):
        error, sampling = column.mean() - value, column.std() / math.sqrt(SEEDS // 3)
        record_property(name, f"{column.mean():.5g} for {value:.5g}, sampling error {sampling:.2g}")
        assert abs(error) <= ERRORS * sampling + NARROW * value, name


def test_broad_band_has_dirliks_damage(record_property):
    """The damage of broad-banded Gaussian series is that of Dirlik's formula, which was fitted to such counts."""
    for lowest, highest, exponent in ((0.02, 0.2, 3.0), (0.05, 0.25, 4.0)):
        loads = [damage_equivalent_load(gaussian(seed, lowest, highest), HOUR, exponent) for seed in range(SEEDS)]
        theory, sampling = dirlik_load(lowest, highest, exponent), np.std(loads) / math.sqrt(SEEDS)
        record_property(f"{lowest:g} to {highest:g} Hz", f"{np.mean(loads):.4g} for {theory:.4g}, error {sampling:.2g}")
        assert abs(np.mean(loads) - theory) <= ERRORS * sampling + DIRLIK * theory


def test_fit_is_that_of_scipy():
    """Shape and scale are those of the general fit of scipy, which finds them by minimising."""
    x = stats.weibull_min(1.4, scale=3e4).rvs(300, random_state=np.random.default_rng(8))
    shape, _, scale = stats.weibull_min.fit(x, floc=0)
    fit = fit_weibull(x)
    assert (fit.shape, fit.scale) == pytest.approx((shape, scale), rel=1e-4)  # of its minimum


def test_intervals_hold_the_truth_as_often_as_they_say():
    """Of 600 samples of 400 peaks, nine in ten 90 % intervals hold the extreme of the distribution."""
    truth, samples = 3e4 * math.log(1200.0) ** (1 / 1.4), 600
    draws = stats.weibull_min(1.4, scale=3e4).rvs((samples, 400), random_state=np.random.default_rng(2))
    ends = [fit_weibull(draw).extreme(1200.0)[1:] for draw in draws]
    share = np.mean([low <= truth <= high for low, high in ends])
    assert abs(share - 0.9) <= ERRORS * math.sqrt(0.9 * 0.1 / samples)


def test_peaks_are_one_between_up_crossings():
    """A ripple on a slow wave makes no further peaks, and a series without two up-crossings has none."""
    t = 0.1 * np.arange(3000)
    series = 5.0 + np.sin(0.2 * math.pi * t - 0.5) + 0.05 * np.sin(4.1 * math.pi * t)
    assert find_peaks(series).size == 29  # of 30 periods, between 30 crossings
    assert find_peaks(np.linspace(0, 1, 50)).size == 0
    for periods in (30, 3):  # samples on the mean itself
        assert find_peaks(np.tile([0.0, 1.0, 0.0, -1.0], periods)).tolist() == [1.0] * (periods - 2)


FORCE = 1e5  # N, of a deviation or amplitude: limits are shares of it, and no numbers of newtons
TIME = STEP * np.arange(2000)
NO_EXTREME = {
    "few expected": (gaussian(5, 0.05, 0.15), 10.0, "tell nothing of it"),
    "regular": (np.sin(0.2 * math.pi * TIME) * (1 + 2e-4 * np.sin(0.03 * TIME)), HOUR, "the motion is regular"),
    "equal": (np.sin(0.2 * math.pi * TIME), HOUR, "the motion is regular"),
    "still": (np.zeros(2000), HOUR, "0 peaks tell nothing of it"),
}


@pytest.mark.parametrize(("tension", "reference_time", "why"), NO_EXTREME.values(), ids=NO_EXTREME)
def test_a_series_without_an_extreme_says_why(tension, reference_time, why):
    """Less than e peaks in the reference time, peaks that are equal or none; of no other fault is there a warning."""
    still = np.zeros(tension.size)
    series = LineSeries(FORCE * (5 + tension), still, still, still.astype(bool))
    result = line_result("line", series, STEP, 3.0, reference_time)
    assert result.extreme is None and len(result.warnings) == 1 and why in result.warnings[0]


def test_a_largest_peak_beyond_the_others_is_seen():
    """A snap that no distribution of the other peaks explains is unlikely; their own largest is not."""
    x = stats.weibull_min(2.0, scale=1.0).rvs(300, random_state=np.random.default_rng(3))
    fit = fit_weibull(x)
    assert fit.largest_is_likely(float(x.max()), 0.005)
    assert not fit.largest_is_likely(2 * float(x.max()), 0.005)
    assert not WeibullFit(2.0, 1.0, 300).largest_is_likely(1.0, 0.005)
    assert FEWEST_PEAKS > 1
