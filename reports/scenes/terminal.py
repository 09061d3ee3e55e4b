"""What the terminal shows of a scene: its lines at rest and in motion, the margin, the setting to use, warnings."""

from __future__ import annotations

from math import hypot

from ..page.numbers.formatting import number
from ..page.numbers.tables import Table
from .dynamics import describe_setting_to_use
from .margins import describe_margin
from .networks.tables import as_text, lines_for_terminal

KN = 1e-3
REST = {"label": "line", "regime": "state", "tension": "T", "H": "H", "V": "V", "anchor": "T anchor",
        "V_anchor": "upwards", "grounded_length": "on seabed, m"}  # fmt: skip


def summarise_scene(scene: dict) -> str:
    """Return a scene's name, its lines in kN, the setting to use and the warnings, as lines of text."""
    rows = [row | {"anchor": hypot(row["H_anchor"], row["V_anchor"]), "V_anchor": max(row["V_anchor"], 0.0)}
            for row in scene["lines"]]  # fmt: skip
    kn = lambda value: number(KN * value, 4)
    rest = Table("terminal", "", REST, rows, dict.fromkeys(("tension", "H", "V", "anchor", "V_anchor"), kn))
    suspected = [f"SUSPECTED: {warning}" for warning in scene.get("suspected", ())]
    text = [scene["name"], *suspected, "at rest, tensions in kN", as_text(rest)]
    dynamics, warnings = scene.get("dynamics"), [warning for row in scene["lines"] for warning in row["warnings"]]
    if dynamics and "failed" in dynamics:
        text.append(dynamics["failed"])
    elif dynamics:
        if "motion" in dynamics:
            text += ["in motion, tensions in kN", as_text(lines_for_terminal(dynamics))]
        text.append(describe_setting_to_use(dynamics))
        warnings += dynamics["warnings"]
    text += describe_margin(scene.get("margins", []), is_at_rest="motion" not in (dynamics or {}))
    kept = [warning for warning in dict.fromkeys(warnings) if warning not in scene.get("suspected", ())]
    return "\n".join([*text, *(f"- {warning}" for warning in kept)])
