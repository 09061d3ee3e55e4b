"""The verdicts on time stepping: one measured figure per claim, and whether it is within the bound set for it."""

from __future__ import annotations

from ..page.numbers.formatting import number, seconds
from ..page.numbers.verdicts import Verdict
from ..pipeline.published import printed_value
from .cases import motion_of

# What the project set itself to reach before anything was measured.
DRIFT, THREE_PERIODS = 1e-3, 0.35  # m after 50 periods; s
ORDER, SAME_ORBIT = 0.05, 1e-4


def verdicts(data: dict):
    """Yield the order in the cell, the difference of both methods, the drift and the time of three periods."""
    if data.get("orders"):
        last = data["orders"]["statics"]["orders"]["fairlead"][-1]
        detail = f"statics, finest pair, wanted 2 within {ORDER:g}"
        yield Verdict(number(last, 4), "order in the cell", detail, abs(last - 2) <= ORDER, "dynamics", "verified")
        difference = data["orders"]["step"]["rows"][-1]["damped"]
        detail = f"rms over the range, time stepping and harmonic balance, wanted at most {SAME_ORBIT:g}"
        yield Verdict(
            number(difference, 2),
            "difference of both methods",
            detail,
            difference <= SAME_ORBIT,
            "dynamics",
            "verified",
        )
    if data.get("drift"):
        drift = max(row["drift"][-1] for row in data["drift"] if row["hold"])
        periods = len(data["drift"][0]["period"]) - 1
        cases = ", ".join(dict.fromkeys(motion_of(row["case"]) for row in data["drift"] if row["hold"]))
        detail = f"{cases}, {periods} periods, wanted at most {1e3 * DRIFT:g} mm"
        yield Verdict(
            f"{number(1e3 * drift, 2)} mm", "drift of the fairlead", detail, drift <= DRIFT, "drift", "verified"
        )
    if data.get("speed"):
        least = min(data["speed"]["seconds"]["planar"])
        setting = f"{printed_value('nodes')} nodes, dt = {printed_value('time step')} s"
        detail = f"{setting}, wanted at most {seconds(THREE_PERIODS)}"
        yield Verdict(seconds(least), "three periods", detail, least <= THREE_PERIODS, "dynamics")
