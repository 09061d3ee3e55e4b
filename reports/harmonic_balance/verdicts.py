"""The verdicts on harmonic balance: one measured figure per claim, and whether it is within the bound set for it."""

from __future__ import annotations

from statistics import median

from ..page.numbers.formatting import TIMES, number, plural, ratio, seconds
from ..page.numbers.verdicts import Verdict
from ..pipeline.published import printed_value
from .work_figures import ratios_at_level

# What the project set itself to reach before anything was measured.
PLANAR, SPATIAL, STEPS = 0.060, 0.150, 10  # s of cases 1 and 2 to 4; Newton steps from zero
FIELDS_GAIN, EQUAL_ERROR = 2.0, 5.0
PAPERS_ERROR = 1e-3  # of the tension over its range: what the paper's settings reach in cases 1 and 2


def fields_gain(data: dict) -> float:
    """Return the median ratio of the times in six and in four fields."""
    return median(six / four for six, four in zip(data["seconds"]["spatial"], data["seconds"]["planar"], strict=True))


def verdicts(data: dict):
    """Yield the times of the cases, the Newton steps, the ratios to other methods and the gain of the planar case."""
    rows = [row for row in data.get("cases", {"rows": []})["rows"] if row["method"] == "harmonic balance"]
    if rows:
        worst = {name: max(min(row["seconds"]) for row in rows if (row["case"] == "case_1") == first)
                 for name, first in (("one solve of case 1", True), ("one of cases 2 to 4", False))}  # fmt: skip
        for (name, value), bound in zip(worst.items(), (PLANAR, SPATIAL), strict=True):
            detail = (
                f"harmonic balance, {printed_value('harmonics sufficient')} harmonics, wanted at most {seconds(bound)}"
            )
            yield Verdict(seconds(value), name, detail, value <= bound, "table2")
        steps = max(row["iterations"] for row in rows)
        yield Verdict(
            number(steps), "Newton steps at most", f"cases 1 to 4, wanted at most {STEPS}", steps <= STEPS, "table2"
        )
    if data.get("work"):
        for method in ("time domain", "MoorDyn"):
            ratios = ratios_at_level(data["work"]["at_errors"], PAPERS_ERROR, method)
            if ratios:
                value, cases = min(ratios), plural(len(ratios), "case")
                detail = (
                    f"to an error of {PAPERS_ERROR:g}, over that of harmonic balance, least of {cases}, wanted at "
                    f"least {EQUAL_ERROR:g}"
                )
                part = "peers" if method == "MoorDyn" else ""
                good = value >= EQUAL_ERROR
                yield Verdict(f"{ratio(value)} {TIMES}", f"time of {method}", detail, good, "dynamics-work", part)
    if data.get("fields"):
        gain = fields_gain(data["fields"])
        detail = f"six fields over four, harmonic balance, wanted at least {FIELDS_GAIN:g}"
        yield Verdict(f"{ratio(gain)} {TIMES}", "run time, space over plane", detail, gain >= FIELDS_GAIN, "harmonic")
