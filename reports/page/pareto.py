"""Where this project is on the Pareto front of error and run time, and where another code is: words from the points."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from . import analysis
from .formatting import number, ratio, seconds


@dataclass(frozen=True)
class Behind:
    """A stretch of errors [least, most) for which another code is the fastest of all.

    theirs, ours : seconds to an error of at most ``least``; ours None where this project has no such point
    """

    label: str
    least: float
    most: float
    theirs: float
    ours: float | None

    @property
    def words(self) -> str:
        """ "from error 0.0014 up to 0.0017 MoorDyn takes 47 ms, this project 52 ms (1.1 times)"."""
        end = "up" if math.isinf(self.most) else f"up to {number(self.most, 2)}"
        mine = (
            "has no setting" if self.ours is None else f"{seconds(self.ours)} ({ratio(self.ours / self.theirs)} times)"
        )
        theirs = f"{self.label} takes {seconds(self.theirs)}"
        return f"from an error of {number(self.least, 2)} {end} {theirs}, this project {mine}"


MOVING_WRONG = 0.1  # greatest error over the range of the tension: beyond, an answer is wrong, as in the stability maps
OUR_METHODS = ("harmonic balance", "time domain")
"""How the names of this project's methods for moving cables begin."""


def behind(points: list[dict], mine: Callable[[dict], bool], label: Callable[[dict], str]) -> list[Behind]:
    """Every stretch of errors at which a point that is not mine is the fastest; points: ``seconds``, ``error``."""
    front, found, upper = analysis.pareto(points), [], math.inf
    for point in front:
        if not mine(point):
            ours = [p["seconds"] for p in points if mine(p) and p["error"] <= point["error"]]
            found.append(Behind(label(point), point["error"], upper, point["seconds"], min(ours, default=None)))
        upper = point["error"]
    return _joined(found)


def _joined(found: list[Behind]) -> list[Behind]:
    """Neighbouring stretches of one code as one, with the times of its smallest error."""
    joined = []
    for one in found:
        if joined and joined[-1].label == one.label and joined[-1].least == one.most:
            joined[-1] = Behind(one.label, one.least, joined[-1].most, one.theirs, one.ours)
        else:
            joined.append(one)
    return joined


@dataclass(frozen=True)
class Front:
    """The front of one case. mine, points : how many points of the front are this project's, and how many it has."""

    case: str
    mine: int
    points: int
    behind: tuple[Behind, ...]

    @property
    def words(self) -> str:
        """One sentence without its full stop."""
        if not self.behind:
            return f"{self.case}: this project is the fastest at every error that any code reaches"
        return f"{self.case}: {'; '.join(one.words for one in self.behind)}"


def static(points: list[dict]) -> list[Front]:
    """The fronts of the lines at rest; points of work_precision.json.

    Errors below the condition limit, which rounding the inputs alone causes, are taken as equal to it.
    """
    good = [p for p in analysis.usable(points) if not analysis.off_the_mark(p)]
    good = [p | {"error": max(p["error"], _limit(p))} for p in good]
    mine = lambda p: p["solver"].startswith(analysis.OURS)
    return [_front(case, [p for p in good if p["case"] == case], mine, lambda p: p["label"])
            for case in dict.fromkeys(p["case"] for p in good)]  # fmt: skip


def _limit(point: dict) -> float:
    """The condition limit of the case of a point; 0 where the point does not tell."""
    return point["error"] / point["in_limits"] if point.get("in_limits") else 0.0


def moving(points: list[dict], titles: dict) -> list[Front]:
    """The fronts of the moving cables; points of the part "work" of harmonic_balance.json, wrong answers left out."""
    good = [p | {"error": p["rms"]} for p in points if p["rms"] and p["error"] <= MOVING_WRONG]
    mine, label = lambda p: p["method"].startswith(OUR_METHODS), lambda p: p["method"]
    return [_front(titles[case], [p for p in good if p["case"] == case], mine, label)
            for case in dict.fromkeys(p["case"] for p in good)]  # fmt: skip


def _front(case: str, points: list[dict], mine, label) -> Front:
    front = analysis.pareto(points)
    return Front(case, sum(map(mine, front)), len(front), tuple(behind(points, mine, label)))
