"""The verdicts on moving lines: one measured figure per claim, and whether it is within the bound set for it."""

from __future__ import annotations

from statistics import median

from ..page.numbers.formatting import TIMES, number, plural, ratio
from ..page.numbers.verdicts import Verdict
from .figures import wanted_errors

# What is asked of them: bounds of others where there are any.
AHEAD = 1.0  # of the ratio to another code at equal error
LINEAR = 1.2  # exponent of the growth with cells: of a linear method, with what caches add
ACCEPTED = 0.15  # of the fairlead: what the repository that gives OrcaFlex's histories accepts in its own test


def verdicts(data: dict):
    """Yield the ratios to MoorDyn and the box scheme, growth, both validations and the warnings over a seabed."""
    ratios = [row["ratio"] for row in data["work"]["ratios"] if row["method"] == "MoorDyn"] if data.get("work") else []
    if ratios:
        detail = (
            f"at equal error, {wanted_errors(data['work'])} of the range, over that of nodes and elements: median of "
            f"{plural(len(ratios), 'setting')}, least {ratio(min(ratios))}, wanted more than {AHEAD:g} in all"
        )
        value = f"{ratio(median(ratios))} {TIMES}"
        yield Verdict(value, "time of MoorDyn, moving line", detail, min(ratios) > AHEAD, "mooring-work", "peers")
    if data.get("three_periods"):
        value, setting = data["three_periods"]["ratio"], data["three_periods"]
        setting = f"{setting['cells']} cells, dt = {setting['dt']:g} s"
        detail = f"three periods, {setting}, over that of nodes and elements, wanted more than {AHEAD:g}"
        yield Verdict(f"{ratio(value)} {TIMES}", "time of the box scheme", detail, value > AHEAD, "mooring-speed")
    if data.get("growth"):
        value = data["growth"]["exponent"]
        cells = number(data["growth"]["rows"][-1]["cells"])
        detail = f"of the run time with cells, to {cells}, wanted at most {LINEAR:g}"
        yield Verdict(number(value, 3), "exponent of the growth", detail, value <= LINEAR, "mooring-growth")
    if data.get("laboratory"):
        value, band = data["laboratory"]["greatest"], data["laboratory"]["band"]
        count = len(data["laboratory"]["rows"])
        detail = f"greatest over {count} measured maxima of a chain that snaps, wanted at most {100 * band:g} %"
        good = value <= band
        yield Verdict(
            f"{100 * value:.1f} %", "difference from the laboratory", detail, good, "mooring-laboratory", "verified"
        )
    if data.get("orcaflex"):
        value = max(next(iter(row["computed"].values()))["fairlead"]["rms"] for row in data["orcaflex"])
        count = len(data["orcaflex"])
        detail = f"rms over the range at the fairlead, worst of {count}, wanted at most {100 * ACCEPTED:g} %"
        good = value <= ACCEPTED
        yield Verdict(f"{100 * value:.1f} %", "difference from OrcaFlex", detail, good, "mooring-orcaflex", "verified")
    if data.get("seabeds"):
        summary, large = data["seabeds"]["summary"], data["seabeds"]["large"]
        detail = f"errors above {100 * large:g} % of the range with a warning, of {summary['solved']} motions"
        good = summary["large_and_warned"] == summary["large"]
        value = f"{summary['large_and_warned']} of {summary['large']}"
        yield Verdict(value, "large errors over a seabed warned of", detail, good, "mooring-seabeds", "verified")
