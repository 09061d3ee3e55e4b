"""Statistics of a tension over a load case: moments, extremes from a Weibull fit, damage-equivalent load.

Extremes: the largest value between two up-crossings of the mean is a peak; peaks over the mean are fitted with a
Weibull distribution of two parameters by maximum likelihood, and the extreme of a longer time with N peaks is exceeded
by one peak in N on average. Its confidence interval is that of the fit (delta method, Fisher information of the
Weibull distribution): how much it would vary with another seed, while the peaks are independent and so distributed.

Damage: rainflow cycles as ASTM E1049-85 counts them, half cycles by half; the load of one cycle a second that does the
same damage by a Woehler curve of exponent m is (sum n_i S_i^m / T)^(1/m), S_i the ranges and T the time in s.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import rainflow
from scipy.optimize import brentq
from scipy.special import ndtri

CONFIDENCE = 0.9  # of the interval of an extreme
FEWEST_PEAKS = 20  # of which a distribution is fitted
REFERENCE_FREQUENCY = 1.0  # Hz, of the cycles of a damage-equivalent load
_EULER = 0.5772156649015329
_BY_SHAPE, _BOTH, _BY_SCALE = (f * 6 / math.pi**2 for f in (1.0, 1 - _EULER, math.pi**2 / 6 + (1 - _EULER) ** 2))
"""Of n times the inverse Fisher information of a Weibull distribution, in k^2, scale and (scale/k)^2; k: the shape."""
_SHAPES = 1e-2, 1e3  # between which the shape of peaks lies


@dataclass(frozen=True)
class WeibullFit:
    """Peaks over the mean: P(peak > x) = exp(-(x / scale)^shape), scale in N; count: of the peaks fitted."""

    shape: float
    scale: float
    count: int

    def extreme(self, peaks: float, confidence: float = CONFIDENCE) -> tuple[float, float, float]:
        """Return what one peak in ``peaks`` exceeds, and the ends of its confidence interval, N."""
        log_log = math.log(math.log(peaks))
        value = self.scale * math.exp(log_log / self.shape)
        variance = (_BY_SCALE - 2 * _BOTH * log_log + _BY_SHAPE * log_log**2) / (self.shape**2 * self.count)
        factor = math.exp(ndtri((1 + confidence) / 2) * math.sqrt(variance))  # of a positive quantity: of its logarithm
        return value, value / factor, value * factor

    def largest_is_likely(self, largest: float, level: float) -> bool:
        """Return whether the largest peak lies between the quantiles ``level`` and 1 - level of the largest of all."""
        log_probability = self.count * math.log1p(-math.exp(-((largest / self.scale) ** self.shape)))
        return math.log(level) <= log_probability <= math.log1p(-level)


def refine_extremes(series) -> np.ndarray:
    """Return the first value, the turning points and the last value of a series, (k,).

    A turning point between the samples is that of a parabola through three of them: an error of second order less.
    """
    series = np.asarray(series, dtype=float)
    distinct = np.concatenate([[True], np.diff(series) != 0])
    x = series[distinct]
    if x.size < 3:
        return x
    before, after = x[1:-1] - x[:-2], x[1:-1] - x[2:]
    turns = before * after > 0
    before, after = before[turns], after[turns]
    vertex = x[1:-1][turns] + (before - after) ** 2 / (8 * (before + after))
    return np.concatenate([x[:1], vertex, x[-1:]])


def fit_weibull(peaks) -> WeibullFit:
    """Return the Weibull distribution of most likelihood for positive peaks (n,)."""
    x = np.asarray(peaks, dtype=float)
    largest = x.max()
    logs = np.log(x / largest)
    mean = logs.mean()

    def slope(shape):
        weights = np.exp(shape * logs)
        return weights @ logs / weights.sum() - 1 / shape - mean

    shape = brentq(slope, *_SHAPES, xtol=1e-13, rtol=1e-13)
    return WeibullFit(float(shape), float(largest * np.exp(shape * logs).mean() ** (1 / shape)), x.size)


def find_peaks(series) -> np.ndarray:
    """Return the largest value between each two up-crossings of the mean, less the mean, (n,)."""
    series = np.asarray(series, dtype=float)
    x = series - series.mean()
    crossings = np.flatnonzero((x[:-1] < 0) & (x[1:] >= 0)) + 1
    if crossings.size < 2:
        return np.empty(0)
    x = x[: crossings[-1]]
    at = np.array([a + int(x[a:b].argmax()) for a, b in pairwise(crossings.tolist())])
    at = at[at + 1 < x.size]
    before, after = x[at] - x[at - 1], x[at] - x[at + 1]
    bend = before + after
    return x[at] + np.divide((before - after) ** 2, 8 * bend, out=np.zeros(at.size), where=bend > 0)


def damage_equivalent_load(series, duration: float, exponent: float) -> float:
    """Return the range of 1 Hz cycles that does the damage of a series over a duration in s, in its unit.

    exponent: of the Woehler curve. Cycles by rainflow, residual half cycles counted by half.

    >>> import numpy as np
    >>> wave = np.cos(2 * np.pi * 0.1 * np.arange(0.0, 1000.1, 0.1))
    >>> round(damage_equivalent_load(wave, 1000.0, 4.0), 4)  # 2 (0.1)^(1/4)
    1.1247
    """
    counted = [(span, count) for span, _, count, _, _ in rainflow.extract_cycles(refine_extremes(series))]
    if not counted:
        return 0.0
    ranges, counts = np.array(counted).T
    largest = ranges.max()
    damage = counts @ (ranges / largest) ** exponent / (duration * REFERENCE_FREQUENCY)
    return float(largest * damage ** (1 / exponent))
