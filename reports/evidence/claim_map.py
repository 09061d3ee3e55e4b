"""The map of claims: code verification, solution verification and validation, and of what nothing is claimed."""

from __future__ import annotations

from ..cable.verdicts import verdicts as of_cable
from ..catenary.regimes import verdicts as of_lines
from ..mooring.networks import verdicts as of_moving_networks
from ..mooring.verdicts import verdicts as of_moving_lines
from ..network.verdicts import verdicts as of_networks
from ..page.numbers.formatting import number, plural
from ..page.numbers.tables import Table
from ..page.numbers.verdicts import Verdict
from ..page.section import Content, Inputs, Section
from ..stability.section import verdicts as of_limits
from .defects import verdicts as of_defects

CODE, SOLUTION = "code verification", "solution verification"
MEASURED, INDEPENDENT = "validation: measured", "comparison: an independent history"
KINDS = {
    "wrong": (CODE, "lines at rest against 50 digits"),
    "refused": (CODE, "lines at rest against 50 digits"),
    "greatest error": (CODE, "lines at rest against 50 digits"),
    "of mistakes found": (CODE, "mistakes planted in the solvers"),
    "order in the cell": (CODE, "the moving cable, refined"),
    "difference of both methods": (CODE, "time stepping and harmonic balance, one orbit"),
    "drift of the fairlead": (SOLUTION, "the moving cable in time"),
    "wrong at the limits": (SOLUTION, "answers at the limits"),
    "large errors over a seabed warned of": (SOLUTION, "moving lines on a default mesh"),
    "difference from the laboratory": (MEASURED, "maxima of a chain that snaps"),
    "difference from OrcaFlex": (INDEPENDENT, "fairlead tension of a studless chain"),
    "difference from MoorDyn, moving networks": (INDEPENDENT, "fairlead tensions of systems in motion"),
}
"""Label of a verdict -> kind of evidence, and what it is about."""

NOTHING_CLAIMED = (
    "the tension at the anchor of a line that slips with friction: friction here grows with the speed and holds no "
    "line at rest",
    "fatigue or breaking of a real line: damage and margins are computed from forces that the user's models give",
    "waves, soil and structures: their motion and stiffness are input",
    "a history that is not periodic yet, as if it were: such are marked where methods are compared",
    "run times on another machine: times are of the one named with the results, comparisons are ratios",
)
"""What no test shows, in words."""


def build(inputs: Inputs) -> Content:
    """Return the table of claims by kind of evidence, with the uncertainties of the references."""
    rows = [_row(verdict) for verdict in _verdicts(inputs.results) if verdict.label in KINDS]
    rows += _references(inputs.results) + _refinements(inputs.results)
    order = (CODE, SOLUTION, MEASURED, INDEPENDENT)
    rows.sort(key=lambda row: order.index(row["kind"]))
    columns = {"kind": "kind of evidence", "about": "of what", "value": "measured", "label": "what it is",
               "within": "within its bound"}  # fmt: skip
    table = Table("claim_map", "Claims by kind of evidence", columns, rows, anchors={"about": "anchor"})
    return Content({"claim_map": table.write(inputs.tables) if rows else None, "unclaimed": NOTHING_CLAIMED})


def _verdicts(results: dict) -> list[Verdict]:
    """Return the verdicts of every room that was measured."""
    networks, defects = results["networks"], results["defects"]
    parts = [networks.get(part) for part in ("speed", "peers", "growth")] if networks else []
    return [
        *(of_lines(results["accuracy"]) if results["accuracy"] else ()),
        *(of_networks(parts[0] or [], parts[1] or [], parts[2]) if networks else ()),
        *(of_defects(defects["summary"]) if defects else ()),
        *(of_cable(results["dynamics"]) if results["dynamics"] else ()),
        *(of_moving_lines(results["mooring"]) if results["mooring"] else ()),
        *(of_moving_networks(results["mooring_networks"]) if results["mooring_networks"] else ()),
        *(of_limits(results["stability"]) if results["stability"] else ()),
    ]


def _row(verdict: Verdict) -> dict:
    kind, about = KINDS[verdict.label]
    within = {None: "no bound", True: "yes", False: "no"}[verdict.good]
    return {"kind": kind, "about": about, "value": verdict.value, "label": f"{verdict.label}, {verdict.detail}",
            "within": within, "anchor": verdict.anchor}  # fmt: skip


def _references(results: dict) -> list[dict]:
    """Return a row for the uncertainty of the references of the moving lines, where they were measured."""
    work = (results["mooring"] or {}).get("work")
    if not work:
        return []
    values = list(work["uncertainty"].values())
    text = f"greatest uncertainty of a reference, rms over the range, of {plural(len(values), 'case')}"
    return [{"kind": SOLUTION, "about": "references of the moving line", "value": number(max(values), 2),
             "label": text, "within": "no bound", "anchor": "mooring-work"}]  # fmt: skip


def _refinements(results: dict) -> list[dict]:
    """Return a row on how many refinements of references show an order, where they were measured."""
    lines = ((results["mooring"] or {}).get("references") or {}).get("refinements", {})
    networks = ((results["mooring_networks"] or {}).get("agreement") or {}).get("rows", ())
    kinds = [*lines.values(), *(row.get("refinements", {}) for row in networks)]
    every = [one for kind in kinds for one in kind.values()]
    if not every:
        return []
    known = [one for one in every if one["is_asymptotic"]]
    networks_at = "mooring-networks-agreement" if networks else None
    anchor = "mooring-work" if (results["mooring"] or {}).get("work") else networks_at
    text = "refinements of references in mesh, step or harmonics in the asymptotic range; the others have a bound"
    return [{"kind": SOLUTION, "about": "references of moving lines and networks",
             "value": f"{len(known)} of {len(every)}", "label": text, "within": "no bound",
             "anchor": anchor}]  # fmt: skip


CLAIM_MAP = Section(
    id="claim-map",
    title="Map of claims",
    part="verified",
    page="evidence",
    needs=("accuracy", "networks", "defects", "dynamics", "mooring", "mooring_networks", "stability"),
    template="evidence/claim_map.html.j2",
    build=build,
)
