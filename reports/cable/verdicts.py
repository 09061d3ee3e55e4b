"""The verdicts on moving cables: one measured figure per claim, and whether it is within the bound set for it."""

from __future__ import annotations

from statistics import median

from ..evidence.published import stated
from ..page.formatting import TIMES, number, plural, ratio, seconds
from ..page.verdicts import Verdict
from .figures import metres
from .work_figures import ratios_at

# What the project set itself to reach before anything was measured.
DRIFT, THREE_PERIODS = 1e-3, 0.35  # m after 50 periods; s
PLANAR, SPATIAL, STEPS = 0.060, 0.150, 10  # s of cases 1 and 2 to 4; Newton steps from zero
FIELDS_GAIN, EQUAL_ERROR = 2.0, 5.0
PAPERS_ERROR = 1e-3  # of the tension over its range: what the paper's settings reach in cases 1 and 2
ORDER, SAME_ORBIT = 0.05, 1e-4


def strip(stepped: dict, balanced: dict) -> list[Verdict]:
    """All verdicts that the present results allow."""
    return [*_time_verdicts(stepped), *_harmonic_verdicts(balanced)]


def fields_gain(data) -> float:
    """Median ratio of the times in six and in four fields."""
    return median(six / four for six, four in zip(data["seconds"]["spatial"], data["seconds"]["planar"], strict=True))


def _time_verdicts(data: dict):
    if data.get("orders"):
        last = data["orders"]["statics"]["orders"]["fairlead"][-1]
        detail = f"statics, finest pair, wanted 2 within {ORDER:g}"
        yield Verdict(number(last, 4), "order in the cell", detail, abs(last - 2) <= ORDER, "dynamics")
        apart = data["orders"]["step"]["rows"][-1]["damped"]
        detail = f"rms over the range, time stepping on the orbit of harmonic balance, wanted at most {SAME_ORBIT:g}"
        yield Verdict(number(apart, 2), "apart: two methods", detail, apart <= SAME_ORBIT, "dynamics")
    if data.get("drift"):
        held = max(row["drift"][-1] for row in data["drift"] if row["hold"])
        periods = len(data["drift"][0]["period"]) - 1
        held_cases = ", ".join(dict.fromkeys(metres(row["case"]) for row in data["drift"] if row["hold"]))
        detail = f"{held_cases}, {periods} periods, wanted at most {1e3 * DRIFT:g} mm"
        yield Verdict(f"{number(1e3 * held, 2)} mm", "drift of the fairlead", detail, held <= DRIFT, "drift")
    if data.get("speed"):
        least = min(data["speed"]["seconds"]["planar"])
        detail = f"{stated('nodes')} nodes, dt = {stated('time step')} s, wanted at most {seconds(THREE_PERIODS)}"
        yield Verdict(seconds(least), "three periods", detail, least <= THREE_PERIODS, "dynamics")


def _harmonic_verdicts(data: dict):
    rows = [row for row in data.get("cases", {"rows": []})["rows"] if row["method"] == "harmonic balance"]
    if rows:
        worst = {name: max(min(row["seconds"]) for row in rows if (row["case"] == "case_1") == first)
                 for name, first in (("one solve of case 1", True), ("one of cases 2 to 4", False))}  # fmt: skip
        for (name, value), bound in zip(worst.items(), (PLANAR, SPATIAL), strict=True):
            detail = f"harmonic balance, {stated('harmonics sufficient')} harmonics, wanted at most {seconds(bound)}"
            yield Verdict(seconds(value), name, detail, value <= bound, "table2")
        steps = max(row["iterations"] for row in rows)
        yield Verdict(
            number(steps), "Newton steps at most", f"cases 1 to 4, wanted at most {STEPS}", steps <= STEPS, "table2"
        )
    if data.get("work"):
        for method in ("time domain", "MoorDyn"):
            ratios = ratios_at(data["work"]["at_errors"], PAPERS_ERROR, method)
            if ratios:
                value, cases = min(ratios), plural(len(ratios), "case")
                detail = (
                    f"to an error of {PAPERS_ERROR:g}, over that of harmonic balance, least of {cases}, wanted at "
                    f"least {EQUAL_ERROR:g}"
                )
                yield Verdict(
                    f"{ratio(value)} {TIMES}", f"time of {method}", detail, value >= EQUAL_ERROR, "dynamics-work"
                )
    if data.get("fields"):
        gain = fields_gain(data["fields"])
        detail = f"six fields over four, harmonic balance, wanted at least {FIELDS_GAIN:g}"
        yield Verdict(f"{ratio(gain)} {TIMES}", "gain of the planar case", detail, gain >= FIELDS_GAIN, "harmonic")
