"""Figures of performance and data profiles, and what they say in words."""

from __future__ import annotations

import math

from ..page.figures import Figure, Group
from ..page.numbers.formatting import number, plural
from ..page.numbers.profiles import Costs, Profile, data_profiles, performance_profiles
from .axes import add_legend, panel, set_decade_ticks

SHARE = "share of the problems solved"
BEYOND = 3.0
"""Times the greatest bound to which curves are drawn: what is not solved by then never is."""


def show_profiles(costs: Costs, work: Costs, looks: dict, save, about: str, xlabel: str, anchor: str) -> Group | None:
    """Return the performance profile of run times and the data profile of work; None where there is no cost at all.

    save: of the section, which gets a name; about: a sentence on what a problem is; xlabel: of the work.
    """
    if not costs:
        return None
    by_time, by_work = performance_profiles(costs), data_profiles(work)
    ratio = "run time over the least of all methods"
    figures = [draw_profiles(by_time, looks, "Performance profile", ratio, save, "performance-profile")]
    if work:
        figures.append(draw_profiles(by_work, looks, "Data profile", xlabel, save, "data-profile"))
    problems = len(next(iter(costs.values())))
    sentences = [describe_best(by_time, problems), about]
    sentences.append("Left, the cost is the run time over the least of all methods; right, evaluations.")
    sentences += [describe_median(by_work, xlabel)] if work else []
    untold = [method for method in costs if method not in work]
    sentences += [f"Evaluations are not told by {', '.join(untold)}."] if untold and work else []
    return Group(" ".join(sentences), figures, anchor)


def draw_profiles(profiles: dict[str, Profile], looks: dict, title: str, xlabel: str, save, name: str) -> Figure:
    """Return the profiles of methods as rising steps over a bound of the cost; save: of the section."""
    figure, axes = panel(title, xlabel, SHARE)
    bounds = [bound for profile in profiles.values() for bound in profile.bounds if bound > 0]
    first, last = (min(bounds), max(bounds)) if bounds else (1.0, 1.0)
    for method, profile in profiles.items():
        rises = [(b, share) for b, share in zip(profile.bounds, profile.shares, strict=True) if b > first]
        steps = [(first, profile.at(first)), *rises, (BEYOND * last, profile.solved)]  # what costs nothing, with first
        x, y = zip(*steps, strict=True)
        look = {"color": looks[method]["color"], "marker": looks[method]["marker"]}
        axes.step(x, y, where="post", linewidth=1.4, markersize=4, markevery=max(1, len(x) // 8),
                  label=method, **look)  # fmt: skip
    axes.set(xscale="log", xlim=(first / 1.05, BEYOND * last), ylim=(-0.03, 1.03))
    set_decade_ticks(axes, "x")
    add_legend(figure, axes)
    return save(figure, name=name, title=title, alt=f"{title}: {SHARE} against {xlabel}, rising steps, one a method.")


def describe_best(profiles: dict[str, Profile], problems: int) -> str:
    """Return how a curve is read, and in how many problems each method is the fastest and how many it solves."""
    order = sorted(profiles, key=lambda method: (-profiles[method].solved, -profiles[method].at(1.0)))
    counts = ((method, profiles[method].at(1.0), profiles[method].solved) for method in order)
    parts = [f"{method} {round(best * problems)} and {round(solved * problems)}" for method, best, solved in counts]
    return (
        f"A curve is the share of {plural(problems, 'problem')} that a method solves within the cost below it, "
        f"failures counted; fastest in, and solved at all: {'; '.join(parts)}."
    )


def describe_median(profiles: dict[str, Profile], what: str) -> str:
    """Return the cost within which each method solves half of the problems, in a sentence."""
    parts = [f"{method} {number(bound, 2) if bound < math.inf else 'never'}"
             for method, bound in ((method, half_solved(profile)) for method, profile in profiles.items())]  # fmt: skip
    return f"Half of the problems are solved by {', '.join(parts)} {what}."


def half_solved(profile: Profile) -> float:
    """Return the bound within which half of the problems are solved; infinite where they never are."""
    return next((b for b, share in zip(profile.bounds, profile.shares, strict=True) if share >= 0.5), math.inf)
