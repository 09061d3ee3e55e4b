"""The verdicts on networks of lines: one measured figure per claim, and whether it is within the bound set for it."""

from __future__ import annotations

from ..page.numbers.formatting import TIMES, number, seconds
from ..page.numbers.verdicts import Verdict
from .paragraphs import LARGE, WANTED_GROWTH, WANTED_METHODS, WANTED_PEER, WANTED_SECONDS


def verdicts(speed: list[dict], peers: list[dict], growth: dict | None) -> list[Verdict]:
    """Return the ratios of times, of which the least counts, and the time and growth of large networks."""
    lines = [row["ratio"] for row in speed if row["system"].startswith("two lines")]
    bridles = [row["ratio"] for row in peers if row["system"] == "three_bridles"]
    results = []
    if lines:
        text = f"over monolithic analytic, two lines, wanted at least {WANTED_METHODS}"
        results.append(_ratio(min(lines), "time of nested with differences", text, WANTED_METHODS))
    if bridles:
        text = f"over this project, nine lines after an offset, wanted at least {WANTED_PEER}"
        results.append(_ratio(min(bridles), "time of MoorPy on a network", text, WANTED_PEER, "peers"))
    if growth:
        results += _growth(growth)
    return results


def _ratio(value: float, label: str, detail: str, bound: float, part: str = "") -> Verdict:
    return Verdict(f"{number(value)} {TIMES}", label, detail, value >= bound, "networks", part)


def _growth(growth: dict):
    largest = [row for row in growth["rows"] if row["elements"] >= LARGE]
    if largest:
        slowest = max(largest, key=lambda row: row["seconds"])
        good = slowest["seconds"] <= WANTED_SECONDS and all(row["status"] == "SUCCESS" for row in largest)
        text = f"the slowest of chain, net and tree of 10 000, wanted at most {WANTED_SECONDS} s"
        label = f"for a {slowest['family']} of {number(slowest['elements'])} lines"
        yield Verdict(seconds(slowest["seconds"]), label, text, good, "networks")
    p = growth["exponents"]["chain"]
    if p is not None:
        text = f"the number of lines raised to it gives the time of a chain, wanted at most {WANTED_GROWTH}"
        yield Verdict(number(p), "power of growth", text, p <= WANTED_GROWTH, "networks")
