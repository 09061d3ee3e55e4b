"""What is known of wrong answers of other codes that no listed mistake has: each is shown by a test on the code."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Known:
    """Words on the answers of a code to some cases, where one of these quantities is not right."""

    code: str
    cases: tuple[str, ...]
    quantities: tuple[str, ...]
    words: str


SLACK = tuple(f"statics/{name}" for name in ("chain-slack", "buoy-chain-slack", "chain-vertical", "wire-slack"))
FOLDED = ("statics/rope-folded", "statics/nearly-vertical-folded")
KNOWN = (
    Known("moorpy", (*SLACK, "statics/raised-slack"), ("stiffness",),
          "it gives a slack line a hundredth of its weight per length as horizontal stiffness, where there is none"),
    Known("moorpy", ("statics/raised-slack",), ("tension",),
          "tension along the hanging parts is counted from the ends, as if it were greatest at the seabed"),
    Known("moorpy", FOLDED, ("V_anchor",), "the vertical force at the anchor has the other sign"),
    Known("moorpy", FOLDED, ("stiffness",), "its horizontal stiffness is twice the weight per length"),
    Known("moorpy", ("statics/short-stiff",), ("H", "V"),
          "its default tolerance is a distance, too great for a short stiff line: with a finer one it is right"),
    Known("moorpy", ("network/bridle", "network/floating-hose", "network/hanging-mass"), ("tension",),
          "the default tolerance of its equilibrium is a distance: with a finer one they are right"),
    Known("pycatenary", tuple(f"statics/{name}" for name in ("oc3", "chain-50m", "laboratory-chain", "rubber")),
          ("H", "V"), "it gives a stretched line the shape of an inextensible one: the error falls with the strain"),
    Known("pycatenary", ("statics/nearly-slack",), ("H", "V"),
          "its iteration ends far from any equilibrium, and what it ends with is returned as the answer"),
)  # fmt: skip


def explain(code: str, row: dict) -> str:
    """Return what is known of the answer of a code to a case, empty where nothing is."""
    bad = {one["quantity"] for one in row["quantities"] if one["verdict"] != "right"}
    return "; ".join(
        known.words
        for known in KNOWN
        if known.code == code and row["id"] in known.cases and bad.intersection(known.quantities)
    )
