"""Are profiles those of small examples by hand, with ties, failures and a method that solves nothing?"""

from __future__ import annotations

import math

from reports.page.numbers.profiles import Profile, cheapest_points, data_profiles, least_costs, performance_profiles

COSTS = {"a": [1.0, 2.0, 4.0, None], "b": [2.0, 2.0, 1.0, None], "c": [None, None, None, None]}
"""Of four problems: each of a and b is the best of one, they tie in one, none solves the last; c solves nothing."""


def test_the_performance_profile_is_that_by_hand():
    """Ratios of a: 1, 1, 4, never; of b: 2, 1, 1, never. A tie counts for both, a failure in every share."""
    profiles = performance_profiles(COSTS)
    assert profiles["a"] == Profile((1.0, 4.0), (0.5, 0.75))
    assert profiles["b"] == Profile((1.0, 2.0), (0.5, 0.75))


def test_a_method_that_solves_nothing_stays_at_zero():
    profile = performance_profiles(COSTS)["c"]
    assert profile == Profile((), ()) and profile.solved == profile.at(math.inf) == 0.0


def test_a_profile_rises_at_its_bounds():
    profile = performance_profiles(COSTS)["a"]
    assert [profile.at(x) for x in (0.9, 1.0, 3.9, 4.0, 1e9)] == [0.0, 0.5, 0.5, 0.75, 0.75]
    assert profile.solved == 0.75


def test_the_data_profile_is_of_the_cost_itself():
    profiles = data_profiles(COSTS)
    assert profiles["a"] == Profile((1.0, 2.0, 4.0), (0.25, 0.5, 0.75))
    assert profiles["b"] == Profile((1.0, 2.0), (0.25, 0.75))


def test_a_method_alone_is_the_best_of_what_it_solves():
    assert performance_profiles({"a": [3.0, None]})["a"] == Profile((1.0,), (0.5,))


def test_methods_of_other_problems_are_refused():
    for profiles in (performance_profiles, data_profiles):
        try:
            profiles({"a": [1.0, 2.0], "b": [1.0]})
        except ValueError:
            continue
        raise AssertionError("methods with different numbers of problems were compared")


def point(case: str, method: str, rms: float | None, seconds: float | None, evaluations: int | None = None) -> dict:
    return {"case": case, "method": method, "rms": rms, "seconds": seconds, "evaluations": evaluations}


POINTS = [
    point("x", "a", 1e-1, 1.0, 10),
    point("x", "a", 1e-3, 5.0, 40),
    point("x", "a", 1e-2, 9.0, 90),  # a bad setting: another is cheaper and better
    point("y", "a", None, 7.0, 70),  # no answer
    point("x", "b", 1e-2, 2.0),
    point("y", "b", 1e-2, 3.0),
]


def test_the_least_cost_is_that_of_the_best_setting_that_reaches_the_error():
    """An error that equals the level reaches it; what gives no answer solves nothing; cases keep their order."""
    costs = least_costs(POINTS, (1e-1, 1e-2, 1e-3), lambda p: p["seconds"])
    assert costs == {"a": [1.0, 5.0, 5.0, None, None, None], "b": [2.0, 2.0, None, 3.0, 3.0, None]}


def test_a_method_that_tells_no_cost_has_no_entry():
    assert least_costs(POINTS, (1e-2,), lambda p: p["evaluations"]) == {"a": [40, None]}


def test_the_cheapest_point_of_each_error_keeps_its_setting():
    chosen = cheapest_points(POINTS, [1e-1, 1e-3], lambda p: p["seconds"])
    assert chosen == [POINTS[0] | {"level": 1e-1}, POINTS[4] | {"level": 1e-1}, POINTS[1] | {"level": 1e-3},
                      POINTS[5] | {"level": 1e-1}]  # fmt: skip
