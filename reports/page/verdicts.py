"""The strip at the top of the page: one measured figure per claim, and whether it is within the bound set for it."""

from __future__ import annotations

from dataclasses import dataclass

from . import analysis
from .claims import OUTCOMES, Question
from .formatting import TIMES, number, plural, ratio

# What the project set itself to reach before anything was measured.
MEDIAN_LIMITS, MAX_LIMITS = 4, 100
COLD_RATIO = 3  # times faster than MoorPy on one cold line
BATCH_US = 1.5  # per line, 1e5 lines on one thread
GROWTH = 11  # time of ten times as many lines


@dataclass
class Verdict:
    """value : as measured; good : within the bound (None: no bound); section : anchor on the page."""

    value: str
    label: str
    detail: str
    good: bool | None
    section: str


def strip(accuracy: dict | None, speed: dict | None, found: list[Question], ran: bool) -> list[Verdict]:
    """All verdicts that the present results allow."""
    return [
        *(_accuracy(accuracy) if accuracy else ()),
        *(_speed(speed) if speed else ()),
        *(_tests(found) if ran else ()),
    ]


def judged(accuracy: dict) -> dict:
    """This project over the reference table and the random lines (the map is a picture of one family)."""
    return analysis.summarise([row for row in accuracy["rows"] if row["set"] != "map"], analysis.OURS)


def _accuracy(accuracy: dict):
    found = judged(accuracy)
    sets = " + ".join(f"{number(chosen['count'])} {name}" for name, chosen in accuracy["sets"].items() if name != "map")
    yield Verdict(number(found["cases"]), "lines judged against 50 digits", sets, None, "regimes")
    for verdict in ("refused", "wrong"):
        yield Verdict(number(found[verdict]), verdict, "of these, wanted 0", found[verdict] == 0, "regimes")
    for key, bound in (("median", MEDIAN_LIMITS), ("max", MAX_LIMITS)):
        name = {"median": "median error", "max": "greatest error"}[key]
        good = found[key] is not None and found[key] <= bound
        yield Verdict(number(found[key], 2), name, f"condition limits, wanted at most {bound}", good, "regimes")


def _speed(speed: dict):
    cold, batch = speed["cold_oc3"], speed["batch"]
    for name, label, bound in (("moorpy", "MoorPy", COLD_RATIO), ("pycatenary", "pycatenary", None)):
        value = cold.get(f"ratio_{name}")
        if value is not None:
            wanted = f", wanted at least {bound}" if bound else ""
            text = f"over that of this project, one cold line{wanted}"
            yield Verdict(
                f"{ratio(value)} {TIMES}", f"time of {label}", text, None if bound is None else value >= bound, "speed"
            )
    us, growth = batch["us_per_line_1e5"], batch["growth"]
    yield Verdict(
        f"{number(us, 2)} µs",
        "per line",
        f"100 000 lines in one call, wanted at most {BATCH_US}",
        us <= BATCH_US,
        "speed",
    )
    yield Verdict(
        f"{number(growth, 3)} {TIMES}",
        "time of 1 000 000 lines",
        f"over that of 100 000, wanted at most {GROWTH}",
        growth <= GROWTH,
        "speed",
    )


def _tests(found: list[Question]):
    passed, failed, skipped = (sum(question.total(outcome) for question in found) for outcome in OUTCOMES)
    detail = f"{failed} failed, {skipped} skipped"
    yield Verdict(number(passed), "tests passed", detail, failed == 0 and passed > 0, "claims")


def sentence(accuracy: dict) -> tuple[str, int]:
    """The finding of the error section, and the number of lines that rounding alone moves by more than the bound."""
    found = judged(accuracy)
    said = (
        f"Of {plural(found['cases'], 'line')} of the reference table and the random set, "
        f"this project refused {found['refused']} and answered {found['wrong']} wrong."
    )
    if found["worst"]:
        greatest = f"{number(found['max'], 2)} limits ({found['worst']['case']})"
        said += f" Median error {number(found['median'], 2)}, greatest {greatest}."
    beyond = sum(row["limit"] is None or row["limit"] > accuracy["wrong_bound"] for row in accuracy["rows"])
    return said, beyond
