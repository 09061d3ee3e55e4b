"""Performance profiles of Dolan and More (2002) and data profiles of More and Wild (2009), from recorded costs.

A problem is a case with an error that is to be reached; a method's cost of it is the least of all its settings that
reach it, or None where none does: such a problem counts as never solved, and in every share.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

Costs = dict[str, list[float | None]]
"""Method -> its cost of each problem, in one order; None where it never solves it."""


@dataclass(frozen=True)
class Profile:
    """The share of all problems that a method solves within a bound: a function of it that rises in steps.

    bounds : where it rises, growing; shares : the share from there on
    """

    bounds: tuple[float, ...]
    shares: tuple[float, ...]

    @property
    def solved(self) -> float:
        """Share of the problems that are solved at whatever cost."""
        return self.shares[-1] if self.shares else 0.0

    def at(self, bound: float) -> float:
        """Return the share that is solved within a bound."""
        return max((share for b, share in zip(self.bounds, self.shares, strict=True) if b <= bound), default=0.0)


def performance_profiles(costs: Costs) -> dict[str, Profile]:
    """Return each method's profile by the ratio of its cost to the least of all methods: at 1 it is the best, or equal.

    Raises ValueError where methods were not asked the same number of problems.
    """
    best = [min((c for c in of_problem if c is not None), default=None) for of_problem in _by_problem(costs)]
    ratios = {
        method: [None if c is None or b is None else c / b for c, b in zip(mine, best, strict=True)]
        for method, mine in costs.items()
    }
    return data_profiles(ratios)


def data_profiles(costs: Costs) -> dict[str, Profile]:
    """Return each method's profile by its cost itself, such as evaluations for each unknown. Raises as above."""
    _by_problem(costs)
    return {method: _profile(mine) for method, mine in costs.items()}


def _by_problem(costs: Costs) -> list[tuple]:
    return list(zip(*costs.values(), strict=True))


def _profile(costs: list[float | None]) -> Profile:
    solved = sorted(cost for cost in costs if cost is not None)
    bounds = tuple(dict.fromkeys(solved))
    shares = tuple(sum(cost <= bound for cost in solved) / len(costs) for bound in bounds)
    return Profile(bounds, shares)


def least_costs(points: Iterable[dict], levels: Iterable[float], cost: Callable[[dict], float | None]) -> Costs:
    """Return the cost of each method for each case and each error of ``levels``, case by case.

    points : of settings, with ``case``, ``method``, and ``rms``, the error; None: no answer. cost: of a point, None
    where it is not known; a method without a cost of any of its points has no entry.
    """
    points, levels = list(points), list(levels)
    cases = list(dict.fromkeys(p["case"] for p in points))
    methods_with_costs = {p["method"] for p in points if cost(p) is not None}
    least = {(p["method"], p["case"], p["level"]): cost(p) for p in cheapest_points(points, levels, cost)}
    return {
        method: [least.get((method, case, level)) for case in cases for level in levels]
        for method in dict.fromkeys(p["method"] for p in points)
        if method in methods_with_costs
    }


def cheapest_points(points: list[dict], levels: list[float], cost: Callable[[dict], float | None]) -> list[dict]:
    """Return for each case, error of ``levels`` and method the point of least cost that reaches it, with ``level``."""
    chosen: dict[tuple, dict] = {}
    for case in dict.fromkeys(p["case"] for p in points):
        mine = [p for p in points if p["case"] == case and p["rms"] is not None and cost(p) is not None]
        for level in levels:
            for p in mine:
                key = case, level, p["method"]
                if p["rms"] <= level and (key not in chosen or cost(p) < cost(chosen[key])):
                    chosen[key] = p | {"level": level}
    return list(chosen.values())
