"""The section on moving lines of nodes and elements: what the page shows of mooring.json."""

from __future__ import annotations

from functools import partial
from statistics import median

import numpy as np

from ..cable.references import explain_references, reference_table
from ..page.figures import FigureWithTable
from ..page.numbers.formatting import DASH, number, plural, seconds, status_words, times, two_digits
from ..page.numbers.tables import Table, write_table
from ..page.section import Content, Inputs, Section, show_parts
from . import figures, profiles
from .cases import CASES, GROWING, describe_history
from .verdicts import verdicts

_table = partial(write_table, "mooring")


def build(inputs: Inputs) -> Content:
    """Return figures and tables of every part that was measured, and the verdicts on them."""
    data = inputs.results["mooring"]
    if not data:
        return Content({"mooring": None})
    shown = show_parts(PARTS, data, inputs)
    if shown["work"]:
        others = [(inputs.results[group] or {}).get("work") for group in ("harmonic_balance", "mooring_networks")]
        points = profiles.collect_points(data["work"], *others)
        shown["work"] |= {"profiles": profiles.profiles(points, inputs.figures),
                          "costs": profiles.cost_table(points, inputs.tables)}  # fmt: skip
    content = Content({"mooring": shown}, list(verdicts(data)))
    if shown["work"]:
        content.figures += [("a moving line", figure) for figure in shown["work"]["points"].group.figures[:1]]
        content.sentences += _sentences(data["work"])
    return content


def _sentences(work) -> list[str]:
    ratios = [row["ratio"] for row in work["ratios"] if row["method"] == "MoorDyn"]
    if not ratios:
        return []
    return [
        f"Moving line of nodes and elements: at equal error MoorDyn takes {times(median(ratios))} as long (median of "
        f"{plural(len(ratios), 'setting')} on its front, least {number(min(ratios), 2)})."
    ]


def _work(data, folder, tables) -> dict:
    titles = CASES | data["titles"]
    points = [point | {"case": titles[point["case"]]} for point in data["points"]]
    columns = {"case": "case", "method": "method", "size": "cells or nodes", "other": "steps or harmonics",
               "seconds": "run time", **profiles.COUNTS, "rms": "rms error", "error": "greatest error",
               "status": "status"}  # fmt: skip
    rows = [row | {"case": titles[row["case"]]} for row in data["ratios"] if row["method"] == "MoorDyn"]
    ratios = {"case": "case", "size": "cells of MoorDyn", "other": "steps a period", "rms": "rms error",
              "seconds": "its run time", "ours": "nodes and elements", "ratio": "times"}  # fmt: skip
    formats = {"rms": two_digits, "seconds": seconds, "ours": seconds, "ratio": two_digits}
    return {
        "points": FigureWithTable(
            figures.work(data, folder), _table(tables, "work", "Error against run time", points, columns)
        ),
        "ratios": _table(tables, "ratios", "MoorDyn at equal error", rows, ratios, formats=formats) if rows else None,
    }


def _references(data, folder, tables) -> dict:
    kept, titles = data.get("refinements", {}), CASES | data.get("titles", {})
    return {"text": _difference(data), "table": reference_table("mooring", tables, kept, titles),
            "explained": explain_references(kept)}  # fmt: skip


def _difference(data) -> str:
    cases = ", ".join(f"{CASES[name]} {number(100 * value, 2)} %" for name, value in data["difference"].items())
    return (
        f"On a fine mesh nodes and elements come to the tension of the box scheme, another discretisation by other "
        f"equations, to (rms over the range): {cases}."
    )


def _three_periods(data, folder, tables) -> str:
    least = {name: min(values) for name, values in data["seconds"].items()}
    ours, box = least["nodes and elements"], least["box scheme"]
    return (
        f"Three periods of {GROWING}, {data['cells']} cells, dt = {data['dt']:g} s, with the forces at the fairlead, "
        f"turn and turn about: {seconds(ours)} by nodes and elements, {seconds(box)} by the box scheme, "
        f"{times(data['ratio'])} as long (median of the turns). Their "
        f"tensions differ by {number(100 * data['difference'], 2)} % of the range (rms)."
    )


def _growth(data, folder, tables) -> FigureWithTable:
    return FigureWithTable(figures.growth(data, folder), _table(tables, "growth", "Growth with cells", data["rows"]))


def _damping(data, folder, tables) -> FigureWithTable:
    rows = []
    for row in data["rows"]:
        stepped, balanced = row["in_time"] or {}, row["balance"] or {}
        rows.append({"drag": row["drag"], "periods": stepped.get("periods"), "in_time": stepped.get("seconds"),
                     "cells": stepped.get("cells"), "balance": balanced.get("seconds"),
                     "balance_cells": balanced.get("cells"), "harmonics": balanced.get("harmonics")})  # fmt: skip
    columns = {"drag": "drag coefficient", "periods": "periods", "cells": "cells", "in_time": "run time",
               "balance_cells": "cells", "harmonics": "harmonics", "balance": "run time"}  # fmt: skip
    groups = (("", 1), ("in time, extrapolated", 3), ("harmonic balance, extrapolated", 3))
    formats = {"drag": "{:g}".format, "in_time": seconds, "balance": seconds}
    table = _table(tables, "damping", "Run time by drag", rows, columns, formats=formats, groups=groups)
    return FigureWithTable(figures.damping(data, folder), table)


def _laboratory(data, folder, tables) -> FigureWithTable:
    columns = {"period": "period, s", "radius": "radius, m", "maximum": "measured, N", "computed": "computed, N",
               "deviation": "deviation, %", "finer": "on the finer mesh, N",
               "without_friction": "without friction, N", "other_way": "turned the other way, N"}  # fmt: skip
    columns = {key: heading for key, heading in columns.items() if any(key in row for row in data["rows"])}
    rows = [row | {"deviation": 100 * row["deviation"]} for row in data["rows"]]
    formats = dict.fromkeys(("maximum", "computed", "finer", "without_friction", "other_way"), _tenths) | {
        "deviation": _signed
    }
    table = _table(tables, "laboratory", "Laboratory chain", rows, columns, formats=formats)
    return FigureWithTable(figures.laboratory(data, folder), table)


def _tenths(value) -> str:
    return number(value) if value is None else f"{value:.1f}"


def _signed(value) -> str:
    return f"{value:+.1f}".replace("-", "\N{MINUS SIGN}")


def _orcaflex(rows, folder, tables) -> FigureWithTable:
    entries = []
    for row in rows:
        for label, computed in row["computed"].items():
            for end in ("fairlead", "anchor"):
                of, one = np.array(row[end]), computed[end]
                entries.append(
                    {"name": f"{row['scene']}, {row['amplitude']:.0f} m", "end": end, "label": label,
                     "static": row["static"][end], "ours_static": computed["static"][end],
                     "range": float(np.ptp(of)), "ours_range": float(np.ptp(one["tension"])),
                     "greatest": float(of.max()), "ours_greatest": float(np.max(one["tension"])),
                     "rms": 100 * one["rms"], "bias": 100 * one["bias"]})  # fmt: skip
    columns = {"name": "line, heave", "end": "end", "label": "seabed", "static": "OrcaFlex", "ours_static": "here",
               "range": "OrcaFlex", "ours_range": "here", "greatest": "OrcaFlex", "ours_greatest": "here",
               "rms": "rms", "bias": "mean"}  # fmt: skip
    groups = (("", 3), ("at rest, kN", 2), ("range, kN", 2), ("greatest, kN", 2), ("difference, % of the range", 2))
    whole = dict.fromkeys(("static", "ours_static", "range", "ours_range", "greatest", "ours_greatest"), _whole)
    formats = whole | {"rms": _tenths, "bias": _signed}
    table = _table(tables, "orcaflex", "OrcaFlex", entries, columns, formats=formats, groups=groups)
    return FigureWithTable(figures.orcaflex(rows, folder), table)


def _whole(value) -> str:
    return f"{value:.0f}"


def _seabeds(data, folder, tables) -> dict:
    columns = {"line": "line", "seabed_stiffness": "seabed, N/m²", "kind": "motion", "amplitude": "m", "period": "s",
               "pretension": "at rest, kN", "least": "least, kN", "greatest": "greatest, kN", "change": "last period",
               "history": "history", "error": "error", "warned": "warnings", "balance": "harmonic balance",
               "difference": "difference"}  # fmt: skip
    rows = [_motion_row(row, data["periodic"]) for row in data["rows"]]
    formats = dict.fromkeys(("change", "error", "difference"), two_digits) | {
        "seabed_stiffness": _stiffness,
        "amplitude": "{:g}".format,
        "period": "{:g}".format,
    }
    table = _table(tables, "seabeds", "Lines over a seabed", rows, columns, formats=formats)
    return {"figure": figures.seabeds(data, folder), "table": table, "lines": _line_table(data, tables)}


def _stiffness(value) -> str:
    return number(int(value))


def _motion_row(row, periodic: float) -> dict:
    """Return a motion for the table, its history marked where it is not periodic yet and is compared nevertheless."""
    balance = row.get("balance") or {"status": "", "difference": None}
    kN = {key: row[key] / 1e3 if key in row else None for key in ("pretension", "least", "greatest")}
    warned = ", ".join(row.get("subjects", ())) or "none"
    about = {"line": row["title"], "difference": balance["difference"], "change": row.get("change"),
             "history": describe_history(row.get("change"), periodic),
            "error": row.get("error"), "warned": warned if row["status"] == "SUCCESS" else status_words(row["status"]),
            "balance": status_words(balance["status"])}  # fmt: skip
    return row | kN | about


def _line_table(data, tables) -> Table:
    """Return a row for each line: how many of its motions are periodic, their errors, warnings and slack."""
    rows = []
    for line in dict.fromkeys(row["line"] for row in data["rows"]):
        mine = [row for row in data["rows"] if row["line"] == line]
        solved = [row for row in mine if row["status"] == "SUCCESS"]
        errors = [row["error"] for row in solved if row["error"] is not None]
        balanced = [row for row in solved if row["balance"]["status"] == "SUCCESS"]
        taut = [row for row in solved if row["balance"]["status"] != "SLACK"]
        rows.append(
            {"line": mine[0]["title"], "seabed": mine[0]["seabed_stiffness"], "solved": f"{len(solved)} of {len(mine)}",
             "slack": sum(row["slack"] for row in solved),
             "periodic": sum(row["change"] <= data["periodic"] for row in solved),
             "checked": len(errors), "median": 100 * median(errors) if errors else None,
             "greatest": 100 * max(errors) if errors else None,
             "large": sum(error > data["large"] for error in errors),
             "warned": sum(not set(data["advice"]).isdisjoint(row["subjects"]) for row in solved),
             "balanced": f"{len(balanced)} of {len(taut)}"})  # fmt: skip
    columns = {"line": "line", "seabed": "seabed, N/m²", "solved": "solved", "slack": "slack", "periodic": "periodic",
               "checked": "checked", "median": "median error, %", "greatest": "greatest, %",
               "large": f"above {100 * data['large']:g} %", "warned": "warned of",
               "balanced": "harmonic balance"}  # fmt: skip
    formats = {"median": two_digits, "greatest": two_digits, "seabed": _stiffness}
    return _table(tables, "seabed_lines", "Lines over a seabed, a row a line", rows, columns, formats=formats)


def _agreement(data, folder, tables) -> dict:
    """Return what the methods agree to in words, a row for each line, and the reasons of those that do not."""
    columns = {"name": "line", "motion": "motion", "contact": "on the bed", "undamped": "undamped",
               "damped": "damped", "effect": "damping", "harmonics": "Nh", "difference": "rms",
               "peer": "rms", "peer_greatest": "greatest", "peer_steps": "half step"}  # fmt: skip
    groups = (("", 2), ("swing, harmonic", 1), ("half the step, %", 2), ("effect, %", 1),
              ("harmonic balance, %", 2), ("MoorDyn, %", 3))  # fmt: skip
    formats = dict.fromkeys(("undamped", "damped", "effect", "difference", "peer", "peer_steps"), two_digits)
    formats |= {"contact": _whole, "peer_greatest": two_digits}
    rows = [_agreement_row(row) for row in data["rows"]]
    table = _table(tables, "agreement", "Two methods and MoorDyn over a seabed", rows, columns, formats=formats,
                   groups=groups)  # fmt: skip
    reasons = [f"{row['name']}: {row['reason']}" for row in rows if row["reason"]]
    return {"text": _agreement_words(data), "table": table, "reasons": reasons}


def _agreement_row(row) -> dict:
    balance, undamped, peer = row.get("balance") or {}, row.get("undamped") or {}, row["moordyn"] or {}
    percent = lambda value: None if value is None else 100 * value
    return {
        "name": f"{row['title']}, {_stiffness(row['seabed_stiffness'])} N/m²",
        "motion": f"{row['kind']} {row['amplitude']:g} m, {row['period']:g} s", "contact": row["contact"],
        "undamped": percent(undamped.get("steps")), "damped": percent(row.get("steps")),
        "effect": percent(row.get("effect")), "harmonics": balance.get("harmonics"),
        "difference": percent(balance.get("difference")), "peer": percent(peer.get("rms")),
        "peer_greatest": percent(peer.get("greatest")), "peer_steps": percent(peer.get("steps")),
        "reason": row["reason"] or "",
    }  # fmt: skip


def _agreement_words(data) -> str:
    solved = [row for row in data["rows"] if (row.get("balance") or {}).get("difference") is not None]
    alike = [row for row in solved if row["balance"]["difference"] <= data["agreed"]]
    first, *refined = data["steps"]
    farthest = max((row["balance"]["difference"] for row in solved), default=None)
    farthest = DASH if farthest is None else number(100 * farthest, 2)
    return (
        f"One motion of each line, {data['cells']} cells. Nodes that touch down swing on the seabed at the square root "
        f"of k/(m + ma); where no damping ends that, shorter steps excite more of it and neither method has a limit. "
        f"So the seabed here has the damping that is critical for the line as it lies, grown over the depth to which "
        f"it sinks; its effect on the tension stands beside. Time: {first} steps a period, then {refined[0]} and "
        f"{refined[1]}, extrapolated. Harmonic balance of Nh harmonics starts from the history, with at least "
        f"{data['resolved']} harmonics to each swing, beyond {data['direct']} by GMRES: {len(alike)} of "
        f"{plural(len(solved), 'response')} are within {number(100 * data['agreed'], 1)} % of the range of the "
        f"history (rms), the farthest {farthest} %. MoorDyn: "
        f"equal cells, {data['peer_steps']} coupling steps a period, no damping of the seabed and no friction in "
        f"either, for its laws are others. Beside it stands what half the step changes here on those cells: where that "
        f"is as much, neither follows the swing of an undamped seabed. An error of first order in its coupling step "
        f"is left, and its answers are kept as reference data. All differences over the range."
    )


PARTS = {
    "references": _references,
    "work": _work,
    "three_periods": _three_periods,
    "growth": _growth,
    "damping": _damping,
    "laboratory": _laboratory,
    "orcaflex": _orcaflex,
    "seabeds": _seabeds,
    "agreement": _agreement,
}
"""Part of mooring.json -> what the template takes of it."""

MOORING = Section(
    id="mooring",
    title="Moving line of nodes and elements",
    part="error-for-time",
    page="moving",
    needs=("mooring", "mooring_networks", "harmonic_balance"),
    template="mooring/section.html.j2",
    build=build,
    tests={
        "mooring": (
            "mooring/test_equations.py::test_forces_are_those_of_mpmath",
            "mooring/test_equations.py::test_tangents_are_complex_steps",
        ),
        "laboratory": ("mooring/test_published.py::test_each_maximum_of_the_laboratory_chain_is_met",),
        "orcaflex": ("mooring/test_published.py::test_the_fairlead_tension_of_orcaflex_is_met",),
    },
)
