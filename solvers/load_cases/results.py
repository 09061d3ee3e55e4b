"""Results of load cases: what one line felt in one case, one row of the table, and the table."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, field
from typing import ClassVar

import numpy as np

from ..common.outcome import Status
from .statistics import FEWEST_PEAKS, damage_equivalent_load, find_peaks, fit_weibull, refine_extremes

UNLIKELY = 0.005  # of the largest peak, by the distribution that is fitted to all of them
SETTLING = 0.25  # standard deviations by which the means of both halves of a series may differ
QUANTITIES = ("maximum", "standard_deviation", "damage_equivalent_load")
"""For which steps and mesh are chosen."""


@dataclass(frozen=True)
class LineResult:
    """Fairlead tension of one line over a case, N, and what else is asked of it.

    extreme: what one peak in those of the reference time exceeds, with its confidence interval, None where too few
    peaks are there. damage_equivalent_load: range in N. anchor_maximum: N. grounded: least and greatest unstretched
    length on the seabed, m. slack_time: s in which some cell is slack. warnings: sentences.
    """

    line: str
    minimum: float
    mean: float
    maximum: float
    standard_deviation: float
    damage_equivalent_load: float
    extreme: float | None
    extreme_low: float | None
    extreme_high: float | None
    anchor_maximum: float
    grounded_least: float
    grounded_most: float
    slack_time: float
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True)
class CaseResult:
    """One row: its number from 0, its name, how it ended (a name of Status, or FAILED), what is wrong, its lines."""

    number: int
    name: str
    status: str
    message: str = ""
    lines: tuple[LineResult, ...] = ()
    iterations: int = 0

    @property
    def success(self) -> bool:
        """Whether the row has results."""
        return self.status == Status.SUCCESS.name

    def as_record(self) -> dict:
        """Return the row in types of JSON, from which ``from_record`` makes an equal one, bit for bit."""
        return asdict(self)

    @classmethod
    def from_record(cls, record: dict) -> CaseResult:
        """Return the row of a record."""
        lines = tuple(LineResult(**(line | {"warnings": tuple(line["warnings"])})) for line in record["lines"])
        return cls(**(record | {"lines": lines}))


@dataclass(frozen=True)
class Accuracy:
    """Errors of maximum (of it), standard deviation and damage-equivalent load (of each), over lines and cases.

    tolerance: what was asked for, None where dt and cells were given; promised: what the pilot cases leave, with the
    factor of safety; measured: the greatest change that steps of half and twice the cells make on a sample of the
    table, of which ``within`` of ``sampled`` cases are below the tolerance. None, not asked for.
    """

    SHARE: ClassVar[float] = 0.95  # of the sample, 19 of 20, that a kept promise has within the tolerance

    tolerance: float | None = None
    promised: float | None = None
    measured: float | None = None
    within: int = 0
    sampled: int = 0

    @property
    def is_kept(self) -> bool | None:
        """Whether enough of the sample is within the tolerance; None where none was asked for or looked at."""
        if self.tolerance is None or not self.sampled:
            return None
        return self.within >= self.SHARE * self.sampled


@dataclass(frozen=True, repr=False)
class LoadCaseTable:
    """Results of a table of load cases in its order; the dt in s and the number of cells; see ``Accuracy``."""

    cases: tuple[CaseResult, ...]
    dt: float
    cells: int
    accuracy: Accuracy = field(default_factory=Accuracy)

    @property
    def failed(self) -> tuple[CaseResult, ...]:
        """Rows without results."""
        return tuple(case for case in self.cases if not case.success)

    def values(self, quantity: str) -> np.ndarray:
        """Return a field of LineResult, (cases, lines); NaN where a row has none."""
        lines = max((len(case.lines) for case in self.cases), default=0)
        result = np.full((len(self.cases), lines), math.nan)
        for row, case in zip(result, self.cases, strict=True):
            for i, line in enumerate(case.lines):
                value = getattr(line, quantity)
                row[i] = math.nan if value is None else value
        return result

    def __repr__(self) -> str:
        """Return the number of rows, those that failed, the setting, and the greatest tension."""
        done = [line.maximum for case in self.cases for line in case.lines]
        most = f", greatest tension {max(done):.6g} N" if done else ""
        return f"{len(self.cases)} load cases, {len(self.failed)} failed, dt {self.dt:g} s, {self.cells} cells{most}"


def line_result(name: str, series, dt: float, exponent: float, reference_time: float) -> LineResult:
    """Return the LineResult of a LineSeries sampled each dt in s."""
    tension, duration = series.fairlead, dt * series.fairlead.size
    turns = refine_extremes(tension)
    deviation = float(tension.std())
    extreme, warnings = _extreme(tension, duration, reference_time)
    half = tension.size // 2
    if abs(tension[:half].mean() - tension[half:].mean()) > SETTLING * deviation:
        warnings.append("duration: the means of both halves differ much: a longer ramp or duration")
    slack = dt * int(series.slack.sum())
    if slack:
        warnings.append(f"slack: {slack:.4g} s; the snaps that follow depend on step and stiffness")
    return LineResult(
        name, float(turns.min()), float(tension.mean()), float(turns.max()), deviation,
        damage_equivalent_load(tension, duration, exponent), *extreme,  # type: ignore[call-arg]
 float(series.anchor.max()),
        float(series.grounded.min()), float(series.grounded.max()), float(slack), tuple(warnings))  # fmt: skip


def _extreme(tension, duration, reference_time) -> tuple[tuple, list[str]]:
    """Return the extreme with both ends of its interval, and a list of warnings."""
    peaks = find_peaks(tension)
    peaks = peaks[peaks > 0]
    expected = peaks.size * reference_time / duration
    if peaks.size < FEWEST_PEAKS or expected <= math.e:
        return (None, None, None), [f"extreme: {peaks.size} peaks tell nothing of it: a longer duration"]
    if np.ptp(peaks) <= EQUAL_PEAKS * peaks.max():
        return (None, None, None), ["extreme: all peaks are equal: the motion is regular"]
    fit = fit_weibull(peaks)
    warnings = []
    if not fit.largest_is_likely(float(peaks.max()), UNLIKELY):
        warnings.append("extreme: the largest peak does not fit the distribution of the others: use more seeds")
    values = tuple(float(tension.mean() + part) for part in fit.extreme(expected))
    return values, warnings


EQUAL_PEAKS = 1e-3  # of the largest: what a regular motion leaves
