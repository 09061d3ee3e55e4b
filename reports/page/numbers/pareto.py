"""Where this project is on the Pareto front of error and run time, and where another code is, in sentences."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from . import analysis
from .formatting import number, plural, ratio, seconds
from .verdicts import Verdict


@dataclass(frozen=True)
class SlowerInterval:
    """An interval of errors [least, most) in which another code is the fastest of all.

    theirs, ours : seconds to an error of at most ``least``; ours None where this project has no such point
    """

    label: str
    least: float
    most: float
    theirs: float
    ours: float | None

    @property
    def sentence(self) -> str:
        """Such as "from an error of 0.0014 up to 0.0017 MoorDyn takes 47 ms, this project 52 ms (1.1 times)"."""
        end = "up" if math.isinf(self.most) else f"up to {number(self.most, 2)}"
        mine = (
            "has no setting" if self.ours is None else f"{seconds(self.ours)} ({ratio(self.ours / self.theirs)} times)"
        )
        theirs = f"{self.label} takes {seconds(self.theirs)}"
        return f"from an error of {number(self.least, 2)} {end} {theirs}, this project {mine}"


WRONG_BOUND = 0.1  # greatest error over the range of the tension: beyond, an answer is wrong, as in the stability maps
OUR_METHODS = ("harmonic balance", "time domain")
"""How the names of this project's methods for moving cables begin."""


def find_slower_intervals(
    points: list[dict], is_ours: Callable[[dict], bool], label: Callable[[dict], str]
) -> list[SlowerInterval]:
    """Return every interval of errors where a point that is not ours is the fastest, by ``seconds`` and ``error``."""
    intervals, upper = [], math.inf
    for point in analysis.pareto_front(points):
        if not is_ours(point):
            ours = [p["seconds"] for p in points if is_ours(p) and p["error"] <= point["error"]]
            least = min(ours, default=None)
            intervals.append(SlowerInterval(label(point), point["error"], upper, point["seconds"], least))
        upper = point["error"]
    return _join(intervals)


def _join(intervals: list[SlowerInterval]) -> list[SlowerInterval]:
    """Return neighbouring intervals of one code as one, with the times of its smallest error."""
    joined = []
    for one in intervals:
        if joined and joined[-1].label == one.label and joined[-1].least == one.most:
            joined[-1] = SlowerInterval(one.label, one.least, joined[-1].most, one.theirs, one.ours)
        else:
            joined.append(one)
    return joined


@dataclass(frozen=True)
class Front:
    """The Pareto front of one case. ours, points : number of its points that are this project's, and of all."""

    case: str
    ours: int
    points: int
    slower: tuple[SlowerInterval, ...]

    @property
    def sentence(self) -> str:
        """One sentence without its full stop."""
        if not self.slower:
            return f"{self.case}: this project is the fastest at every error that any code reaches"
        return f"{self.case}: {'; '.join(one.sentence for one in self.slower)}"


def static_fronts(points: list[dict]) -> list[Front]:
    """Return the fronts of the lines at rest; points of work_precision.json.

    Errors below the condition limit, which rounding the inputs alone causes, are taken as equal to it.
    """
    good = [p for p in analysis.select_answered(points) if not analysis.misses_tolerance(p)]
    good = [p | {"error": max(p["error"], _limit(p))} for p in good]
    is_ours = lambda p: p["solver"].startswith(analysis.OURS)
    return [_front(case, [p for p in good if p["case"] == case], is_ours, lambda p: p["label"])
            for case in dict.fromkeys(p["case"] for p in good)]  # fmt: skip


def _limit(point: dict) -> float:
    """Return the condition limit of the case of a point; 0 where it is not known."""
    return point["error"] / point["in_limits"] if point.get("in_limits") else 0.0


def moving_fronts(points: list[dict], titles: dict) -> list[Front]:
    """Return the fronts of the moving cables; points of harmonic_balance.json, wrong answers left out."""
    good = [p | {"error": p["rms"]} for p in points if p["rms"] and p["error"] <= WRONG_BOUND]
    is_ours, label = lambda p: p["method"].startswith(OUR_METHODS), lambda p: p["method"]
    return [_front(titles[case], [p for p in good if p["case"] == case], is_ours, label)
            for case in dict.fromkeys(p["case"] for p in good)]  # fmt: skip


def _front(case: str, points: list[dict], is_ours, label) -> Front:
    front = analysis.pareto_front(points)
    return Front(case, sum(map(is_ours, front)), len(front), tuple(find_slower_intervals(points, is_ours, label)))


def summarise_fronts(fronts: list[Front]) -> str:
    """Return in how many cases this project is the fastest at every error, and the codes that are faster elsewhere."""
    ahead = sum(not front.slower for front in fronts)
    text = f"this project is the fastest at every error in {ahead} of {plural(len(fronts), 'case')}"
    others = sorted({interval.label for front in fronts for interval in front.slower})
    where = "; ".join(front.case for front in fronts if front.slower)
    return f"{text}; {', '.join(others)} is faster at some error in: {where}." if others else f"{text}."


def front_verdict(cases: str, fronts: list[Front], anchor: str) -> Verdict:
    """Return the verdict on the cases in which this project is the fastest at every error."""
    ahead = sum(not front.slower for front in fronts)
    detail = f"cases, against all other codes, wanted {len(fronts)} of {len(fronts)}"
    value, label = f"{ahead} of {len(fronts)}", f"fastest at every error, {cases}"
    return Verdict(value, label, detail, ahead == len(fronts), anchor)
