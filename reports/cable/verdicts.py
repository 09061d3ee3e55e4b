"""The verdicts on time stepping: one measured figure per claim, and whether it is within the bound set for it."""

from __future__ import annotations

from ..page.formatting import number, seconds
from ..page.verdicts import Verdict
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
        apart = data["orders"]["step"]["rows"][-1]["damped"]
        detail = f"rms over the range, time stepping on the orbit of harmonic balance, wanted at most {SAME_ORBIT:g}"
        yield Verdict(number(apart, 2), "apart: two methods", detail, apart <= SAME_ORBIT, "dynamics", "verified")
    if data.get("drift"):
        held = max(row["drift"][-1] for row in data["drift"] if row["hold"])
        periods = len(data["drift"][0]["period"]) - 1
        held_cases = ", ".join(dict.fromkeys(motion_of(row["case"]) for row in data["drift"] if row["hold"]))
        detail = f"{held_cases}, {periods} periods, wanted at most {1e3 * DRIFT:g} mm"
        yield Verdict(f"{number(1e3 * held, 2)} mm", "drift of the fairlead", detail, held <= DRIFT, "drift", "verified")
    if data.get("speed"):
        least = min(data["speed"]["seconds"]["planar"])
        detail = f"{printed_value('nodes')} nodes, dt = {printed_value('time step')} s, wanted at most {seconds(THREE_PERIODS)}"
        yield Verdict(seconds(least), "three periods", detail, least <= THREE_PERIODS, "dynamics")
