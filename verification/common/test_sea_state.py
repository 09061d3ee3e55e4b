"""Sea states: moments of spectra, the motion that a realisation makes, its derivatives on every way of summing it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad

from solvers import InputError
from solvers.common.motions import irregular_motion
from solvers.common.motions.irregular_motion import FEW_TIMES, IrregularMotion
from solvers.common.motions.sea_state import ResponseOperators, SeaState
from solvers.common.motions.spectrum import HIGHEST, Spectrum, usual_gamma

STEP = 1e-30  # of a complex step: its error is the rounding of the derivative
DERIVATIVE = 1e-11  # relative: the sum of a thousand terms whose angles are some thousand radians
SUMS = 1e-10  # relative: of three ways of the same sum, angles up to 1e4 radians and their rounding
TABLE = 2e-4  # relative: moments of a curve in 4000 lines, and of what they cut off at either end
EXACT = 1e-12  # relative: a few thousand roundings
rng = np.random.default_rng(1806)
MOTION = IrregularMotion(730.0, rng.normal(size=(900, 3)) + 1j * rng.normal(size=(900, 3)))
FREQUENCY = np.linspace(0.02, 0.6, 30)
TABLE_OF_OPERATORS = rng.normal(size=(3, 30, 6)) + 1j * rng.normal(size=(3, 30, 6))
OPERATORS = ResponseOperators(FREQUENCY, TABLE_OF_OPERATORS, [0.0, 90.0, 360.0])
ONE_TO_ONE = ResponseOperators([0.0, 2.0], np.ones((1, 2, 6)))


def formula(f, Hs, Tp) -> float:
    """Return the density of Pierson and Moskowitz (1964) at f in Hz, m^2/Hz, with Hs and Tp for their wind."""
    return 5 / 16 * Hs**2 * Tp**-4 * f**-5 * math.exp(-1.25 * (Tp * f) ** -4)


def test_moments_of_a_developed_sea():
    """Moments 0 to 2 of the Pierson-Moskowitz spectrum are those of its formula over the same frequencies."""
    Hs, Tp = 5.0, 12.0
    made = Spectrum.pierson_moskowitz(Hs, Tp)
    for order in range(3):
        whole = quad(lambda f, n=order: f**n * formula(f, Hs, Tp), 0.2 / Tp, HIGHEST / Tp, epsabs=0, limit=200)[0]
        assert made.moment(order) == pytest.approx(whole, rel=TABLE)
    assert made.significant_height == pytest.approx(Hs, rel=EXACT)


def test_peak_of_a_young_sea():
    """JONSWAP has its peak at 1/Tp, higher by the peakedness but for the scale, and the energy of its height."""
    made, flat = (Spectrum.jonswap(4.0, 9.0, gamma) for gamma in (3.3, 1.0))
    assert made.frequency[made.density.argmax()] == pytest.approx(1 / 9.0, rel=2e-3)  # the ratio of two frequencies
    assert made.significant_height == pytest.approx(4.0, rel=EXACT)
    scale = made.at(0.5) / flat.at(0.5)  # far from the peak gamma has no say
    assert made.at(1 / 9.0) / flat.at(1 / 9.0) / scale == pytest.approx(3.3, rel=1e-4)  # the lines beside the peak
    assert scale == pytest.approx(1 - 0.287 * math.log(3.3), rel=0.01)  # the rule of DNV-RP-C205 (3.5.5.2)


def test_peakedness_where_none_is_given():
    """It is 5 for steep seas, 1 for flat ones, and continuous between, DNV-RP-C205 (3.5.5.5)."""
    assert usual_gamma(4.0, 7.2) == 5 and usual_gamma(4.0, 10.0) == 1
    assert usual_gamma(4.0, 8.0) == pytest.approx(math.exp(5.75 - 1.15 * 4))
    assert usual_gamma(4.0, 7.2 + 1e-9) == pytest.approx(5.0, rel=2e-3)  # the rule jumps by so much


def test_moments_of_lines_are_exact():
    """Of a given spectrum of straight lines, cut where it is asked."""
    made = Spectrum([0.1, 0.2, 0.4], [0.0, 3.0, 1.0])
    assert made.moment(0) == pytest.approx(0.15 + 0.4, rel=EXACT)
    assert made.moment(0, lowest=0.15, highest=0.3) == pytest.approx((1.5 + 3) / 2 * 0.05 + 2.5 * 0.1, rel=EXACT)
    assert made.moment(0, lowest=0.1, highest=0.4) == made.moment(0)  # the ends themselves
    square = sum(quad(lambda f: f * f * made.at(f), a, b)[0] for a, b in ((0.1, 0.2), (0.2, 0.4)))
    assert made.moment(2) == pytest.approx(square, rel=1e-10)  # of the quadrature


WAYS = {
    "few times": np.linspace(0.0, 700.0, FEW_TIMES),
    "one transform": 0.25 * np.arange(2 * 2920 + 7),  # more than two times of repetition
    "one transform, later": 1011.1 + 730.0 / 2999 * np.arange(3000),  # 2999 such steps are 730 s but for rounding
    "products": 0.3 + 0.211 * np.arange(3000),
    "uneven": np.sort(np.random.default_rng(3).uniform(0, 900.0, 500)),
}


@pytest.mark.parametrize(("way", "t"), WAYS.items(), ids=WAYS)
def test_every_way_gives_the_sum(way, t, monkeypatch):
    """Displacement, velocity and acceleration are the sum and its complex-step derivatives, however they are summed.

    And it is the way named: on even times the sum as it stands would take minutes for a long sea.
    """
    called = []
    for name in ("_transform", "_multiply_blocks"):
        function = getattr(irregular_motion, name)
        monkeypatch.setattr(irregular_motion, name, lambda *a, f=function, n=name: [called.append(n), f(*a)][1])
    chosen = np.unique(np.linspace(0, t.size - 1, 40).astype(int))
    angle = 2 * math.pi / 730.0 * np.outer(np.arange(1, 901), t[chosen])
    expected = MOTION.amplitude.real.T @ np.cos(angle) - MOTION.amplitude.imag.T @ np.sin(angle)
    r, v, a = MOTION.trajectory(t)
    assert abs(r[:, chosen] - expected).max() <= SUMS * abs(expected).max()
    assert called == {"one": ["_transform"], "products": ["_multiply_blocks"]}.get(way.split()[0], [])
    assert abs(MOTION.velocity(t) - v).max() <= SUMS * abs(v).max()
    for value, rate in ((MOTION.displacement, v), (MOTION.velocity, a)):
        slope = value(t[chosen] + 1j * STEP).imag / STEP
        assert abs(rate[:, chosen] - slope).max() <= DERIVATIVE * abs(slope).max() + SUMS * abs(rate).max()


def test_standard_deviations_of_a_motion():
    """Those of displacement and velocity are root mean squares over the time of repetition."""
    t = 0.25 * np.arange(2920)
    assert MOTION.standard_deviation == pytest.approx(np.sqrt((MOTION.displacement(t) ** 2).mean(axis=1)), rel=EXACT)
    assert MOTION.velocity_deviation == pytest.approx(np.sqrt((MOTION.velocity(t) ** 2).mean(axis=1)), rel=EXACT)
    assert not hasattr(MOTION, "period")


def test_a_realisation_has_the_energy_of_its_sea():
    """Deterministic amplitudes have that of the spectrum, to the sum over its frequencies; random ones on average."""
    spectrum, duration = Spectrum.jonswap(3.0, 8.0, 2.0), 3600.0
    sea = SeaState(spectrum, ONE_TO_ONE, 4, duration, amplitudes="deterministic")
    assert sea.motion().translation.standard_deviation[0] == pytest.approx(0.75, rel=1e-3)  # 450 lines over the peak
    variances = [
        SeaState(spectrum, ONE_TO_ONE, seed, duration).motion().translation.standard_deviation[0] ** 2
        for seed in range(200)
    ]
    spread = np.std(variances) / math.sqrt(200)
    assert abs(np.mean(variances) - 0.75**2) <= 3 * spread
    f = np.linspace(0.02, 1.25, 20000)
    bandwidth = spectrum.moment(0) ** 2 / (spectrum.at(f) ** 2 @ np.gradient(f))  # (int S)^2 / int S^2
    expected = 0.75**2 / math.sqrt(bandwidth * duration)  # Goda: of the variance of a stretch of a Gaussian sea
    assert np.std(variances) == pytest.approx(expected, rel=0.2)  # four times 1 / sqrt(2 200)


def test_a_seed_makes_one_sea():
    """The same seed makes the same waves, another one others, and nothing but the seed is random."""
    spectrum = Spectrum.jonswap(3.0, 8.0)
    first, again, other = (SeaState(spectrum, ONE_TO_ONE, seed, 600.0).waves() for seed in (5, 5, 6))
    assert (first == again).all() and not (first == other)[first != 0].any() and first.any()


def test_operators_scale_and_lead():
    """A wave at a frequency and heading of the table moves the body by its entry, its phase ahead of the wave."""
    sea = SeaState(Spectrum.jonswap(3.0, 8.0), OPERATORS, 5, 1000.0, heading=90.0, reference=(1.0, 2.0, -3.0))
    motion, waves = sea.motion(), sea.waves()
    k = 99  # 0.1 Hz
    i = int(np.searchsorted(FREQUENCY, 0.1 - 1e-9))
    assert FREQUENCY[i] == pytest.approx(0.1)
    six = np.concatenate([motion.translation.amplitude[k], motion.rotation.amplitude[k]])
    assert six == pytest.approx(TABLE_OF_OPERATORS[1, i] * waves[k], rel=1e-9)  # rounding of 0.1
    assert motion.reference == (1.0, 2.0, -3.0) and motion.sea is sea
    assert sea.frequency == pytest.approx(np.arange(1, 601) / 1000.0)  # as far as the operators, not a line more


def test_operators_between_headings_go_round():
    """Between two headings they are linear; 450 degrees are 90, and -30 are 330."""
    f = [0.1, 0.33]
    assert (OPERATORS.at(f, 450.0) == OPERATORS.at(f, 90.0)).all()
    assert (OPERATORS.at(f, -30.0) == OPERATORS.at(f, 330.0)).all()
    mean = (OPERATORS.at(f, 0.0) + OPERATORS.at(f, 90.0)) / 2
    assert OPERATORS.at(f, 45.0) == pytest.approx(mean, rel=EXACT)
    one = ResponseOperators(FREQUENCY, TABLE_OF_OPERATORS[:1], [30.0])
    assert (one.at(f, 390.0 + 1e-10) == OPERATORS.at(f, 0.0)).all()  # one heading alone: to the rounding of degrees
    assert (OPERATORS.at([0.7], 0.0) == 0).all() and (OPERATORS.at([0.001], 0.0) == OPERATORS.at([0.02], 0.0)).all()


BAD = [
    (lambda: Spectrum.jonswap(-1.0, 8.0), "Hs: -1 m"),
    (lambda: Spectrum.jonswap(1.0, 8.0, 0.5), "gamma: 0.5"),
    (lambda: Spectrum([0.1, 0.1], [1.0, 1.0]), "must increase"),
    (lambda: Spectrum([0.1, 0.2], [1.0, -1.0]), "density[1]: -1 m^2/Hz"),
    (lambda: Spectrum([0.1, 0.2], [0.0, 0.0]), "no sea"),
    (lambda: Spectrum([0.1], [1.0]), "frequency: shape (1,)"),
    (lambda: IrregularMotion(10.0, [[1.0, 2.0]]), "shape (1, 2)"),
    (lambda: IrregularMotion(0.0, [[1.0, 2.0, 3.0]]), "repeats_after: 0 s"),
    (lambda: IrregularMotion(9.0, [[1.0, np.nan, 3.0]]), "amplitude[0, 1]"),
    (lambda: ResponseOperators([0.1, 0.2], np.ones((2, 2, 6))), "(1, 2, 6)"),
    (lambda: ResponseOperators([0.1, 0.1], np.ones((1, 2, 6))), "frequency: must be one row of increasing numbers"),
    (lambda: OPERATORS.at([0.1], math.nan), "heading"),
    (lambda: ResponseOperators([0.1, 0.2], np.ones((1, 2, 6)), [30.0]).at([0.1], 31.0), "31 degrees"),
    (lambda: SeaState(Spectrum.jonswap(1.0, 8.0), ResponseOperators([0.1, 0.2], np.ones((1, 2, 6))), 1, 60.0),
     "of the energy of the waves lies above 0.2 Hz"),
    (lambda: SeaState(Spectrum.jonswap(1.0, 8.0), ONE_TO_ONE, 1.5, 60.0), "seed"),
    (lambda: SeaState(Spectrum.jonswap(1.0, 8.0), ONE_TO_ONE, 1, 60.0, amplitudes="none"), "amplitudes"),
    (lambda: SeaState(Spectrum.jonswap(1.0, 8.0), ONE_TO_ONE, 1, 1e9), "duration"),
]  # fmt: skip


@pytest.mark.parametrize(("make", "message"), BAD, ids=[message for _, message in BAD])
def test_bad_seas_are_refused(make, message):
    """The message names field, value and unit."""
    with pytest.raises(InputError) as caught:
        make()
    assert message in str(caught.value)


def test_operators_that_end_at_rest_lose_nothing():
    """Where they have fallen to a hundredth waves beyond do not matter; where not, the energy lost is named."""
    frequency, sea = [0.02, 0.1, 0.15], Spectrum.jonswap(6.0, 10.0)
    table = np.zeros((1, 3, 6))
    table[0, :, 0] = 1.0, 0.4, 0.009
    assert ResponseOperators(frequency, table).ends_at_rest
    assert SeaState(sea, ResponseOperators(frequency, table), 1, 600.0).motion().translation is not None
    table[0, -1, 0] = 0.02
    assert not ResponseOperators(frequency, table).ends_at_rest
    lost = f"{100 * sea.moment(0, lowest=0.15) / sea.moment(0):.2g} %"
    with pytest.raises(InputError, match=rf"{lost} of the energy of the waves lies above 0\.15 Hz"):
        SeaState(sea, ResponseOperators(frequency, table), 1, 600.0)
