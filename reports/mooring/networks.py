"""The section on moving networks: what the page shows of mooring_networks.json."""

from __future__ import annotations

from functools import partial
from statistics import median

from ..cable.references import explain_references, reference_table
from ..page.figures import FigureWithTable
from ..page.numbers.formatting import TIMES, number, plural, ratio, seconds, status_words, times, two_digits
from ..page.numbers.tables import Table, write_table
from ..page.numbers.verdicts import Verdict
from ..page.section import Content, Inputs, Section, show_parts
from . import network_figures
from .cases import describe_history
from .profiles import COUNTS

FASTER = 10.0  # times as fast as MoorDyn at equal error: what is asked of the nine lines
ALIKE = 0.01  # rms over the range, that MoorDyn and this core may be apart
LINEAR = 1.2  # exponent of the growth with lines: linear, with what caches add

_table = partial(write_table, "mooring_networks")


def build(inputs: Inputs) -> Content:
    """Return figures and tables of every part that was measured, and the verdicts on them."""
    data = inputs.results["mooring_networks"]
    if not data:
        return Content({"moving": None})
    shown = show_parts(PARTS, data, inputs)
    content = Content({"moving": shown}, list(verdicts(data)))
    if shown["work"]:
        content.figures += [("a network of nine lines", figure) for figure in shown["work"]["points"].group.figures]
        content.sentences += _sentences(data["work"])
    return content


def _sentences(work) -> list[str]:
    ratios = [row["ratio"] for row in work["ratios"]]
    if not ratios:
        return []
    return [
        f"Moving network of nine lines: at equal error MoorDyn takes {times(median(ratios))} as long (median of "
        f"{plural(len(ratios), 'setting')} on its front, least {ratio(min(ratios))})."
    ]


def verdicts(data: dict):
    """Yield the ratio to MoorDyn, how far it is from this core, and the growth with lines."""
    ratios = [row["ratio"] for row in data["work"]["ratios"]] if data.get("work") else []
    if ratios:
        detail = (
            f"nine lines, at equal error, {network_figures.wanted_errors(data['work'])} of the range: least of "
            f"{plural(len(ratios), 'setting')}, median {ratio(median(ratios))}, wanted at least {FASTER:g}"
        )
        good = min(ratios) >= FASTER
        yield Verdict(f"{ratio(min(ratios))} {TIMES}", "time of MoorDyn, moving network", detail, good,
                      "mooring-networks-work", "peers")  # fmt: skip
    rows = data["agreement"]["rows"] if data.get("agreement") else []
    if rows:
        worst = max(row["rms"] for row in rows)
        known = sum(row["rms"] <= row["explained"] for row in rows)
        detail = (
            f"rms over the range of a fairlead tension, worst of {plural(len(rows), 'system')} in motion, wanted at "
            f"most {ALIKE:.0%}; in {known} no more than meshes, steps and MoorDyn's damping explain"
        )
        good = worst <= ALIKE and known == len(rows)
        yield Verdict(f"{100 * worst:.2g} %", "difference from MoorDyn, moving networks", detail, good,
                      "mooring-networks-agreement", "verified")  # fmt: skip
    if data.get("growth"):
        value, lines = data["growth"]["exponents"]["seconds"], data["growth"]["rows"][-1]["lines"]
        detail = f"of the run time with lines, to {lines}, wanted at most {LINEAR:g}"
        yield Verdict(number(value, 3), "exponent of the growth with lines", detail, value <= LINEAR,
                      "mooring-networks-growth")  # fmt: skip


def _agreement(data, folder, tables) -> dict | None:
    if not data["rows"]:
        return None
    shares = ("rms", "error", "uncertainty", "rms_of_half", "by_segments", "by_steps", "by_damping", "same_cells",
              "explained")  # fmt: skip
    (rough, _), (fine, _) = data["rows"][0]["at_rest"]
    rows = [row | {key: 100 * row[key] for key in shares} | _at_rest(row) | {"range": row["range"] / 1e3,
            "history": describe_history(row.get("change"), row.get("periodic", 0.0))}
            for row in data["rows"]]  # fmt: skip
    formats = dict.fromkeys(shares, two_digits)
    formats |= {"range": _whole, "tension": _whole, "rest": _signed, "rest_half": _signed}
    columns = {"title": "system", "lines": "lines", "range": "range, kN", "tension": "at rest, kN",
               "rest_half": f"{rough} segments, %", "rest": f"{fine} segments, %", "rms": "rms, %",
               "error": "greatest, %", "explained": "explained, %", "history": "histories"}  # fmt: skip
    groups = (("", 4), ("MoorDyn at rest", 2), ("MoorDyn in motion", 4))
    causes = {"title": "system", "segments": "segments", "by_segments": "segments", "by_steps": "coupling steps",
              "by_damping": "damping", "uncertainty": "this core", "rms_of_half": "half the segments",
              "same_cells": "this core on its segments"}  # fmt: skip
    of_causes = (("", 2), ("rms change by, %", 4), ("rms difference, %", 2))
    title = "Four systems beside MoorDyn"
    return {"table": _table(tables, "agreement", title, rows, columns, formats=formats, groups=groups),
            "causes": _table(tables, "causes", "What explains it", rows, causes, formats=formats, groups=of_causes),
            "text": explain(data["rows"]), "references": _references(data["rows"], tables)}  # fmt: skip


def _references(rows, tables) -> dict:
    kept = {row["title"]: row["refinements"] for row in rows if row.get("refinements")}
    titles = dict(zip(kept, kept, strict=True))
    return {"table": reference_table("mooring_networks", tables, kept, titles), "explained": explain_references(kept)}


def _at_rest(row) -> dict:
    """Return the tension at rest in kN and MoorDyn's difference from it in per cent, finer and rougher."""
    (_, rough), (_, fine) = row["at_rest"]
    return {"tension": row["pretension"] / 1e3, "rest": 100 * fine, "rest_half": 100 * rough}


def explain(rows) -> str:
    """Return how far MoorDyn is in each system, and by what the difference is explained."""
    words = {"by_segments": "the segments", "by_steps": "the coupling steps", "by_damping": "the internal damping"}
    sentences = []
    for row in rows:
        most = max(words, key=row.get)
        verb = "matters" if most == "by_damping" else "matter"
        sentences.append(
            f"{_beginning(row['title'])}: {_percent(row['rms'])}, of which refining explains up to "
            f"{_percent(row['explained'])}; {words[most]} {verb} most."
        )
    return (
        "Rms difference of the fairlead tensions over the last period, the largest of the fairleads, over the range. "
        f"{' '.join(sentences)} Explained: a third of what half the segments change, as an error of second order "
        "leaves, what half the coupling steps change, half of what twice the internal damping changes, and the "
        "uncertainty of this core. MoorDyn's RK2 needs that damping, a tenth of critical in each segment, which falls "
        "with the segment; it and the steps are changed with half the segments. The tension at rest is of the first "
        "fairlead, exact here and relaxed in MoorDyn."
    )


def _beginning(text: str) -> str:
    return text[:1].upper() + text[1:]


def _percent(value: float) -> str:
    return f"{number(100 * value, 2)} %"


def _whole(value) -> str:
    return f"{value:.0f}"


def _signed(value) -> str:
    return f"{value:+.2g}".replace("-", "\N{MINUS SIGN}")


def _work(data, folder, tables) -> dict:
    points = [point | {"size": _setting(point)} for point in data["points"]]
    columns = {"method": "method", "size": "cells", "other": "steps or harmonics", "periods": "periods",
               "seconds": "run time", **COUNTS, "rms": "rms error", "error": "greatest error",
               "status": "status"}  # fmt: skip
    rows = [row | {"size": _setting(row)} for row in data["ratios"]]
    ratios = {"size": "segments of MoorDyn", "other": "coupling steps", "rms": "rms error", "seconds": "its run time",
              "ours": "nodes and elements", "ratio": "times"}  # fmt: skip
    formats = {"rms": two_digits, "seconds": seconds, "ours": seconds, "ratio": two_digits}
    return {
        "points": FigureWithTable(
            network_figures.work(data, folder), _table(tables, "work", "Error against run time", points, columns)
        ),
        "ratios": _table(tables, "ratios", "MoorDyn at equal error", rows, ratios, formats=formats) if rows else None,
    }


def _setting(row) -> str:
    """Return the segments of a lower line and of the legs of its bridle as words, or the cells of the longest line."""
    return " + ".join(str(n) for n in row["size"]) if isinstance(row["size"], list) else str(row["size"])


def _balance(data, folder, tables) -> str:
    solved = [row for row in data["rows"] if row["status"] == "SUCCESS"]
    failed = [f"{row['cells']} cells and {row['harmonics']} harmonics" for row in data["rows"] if row not in solved]
    tried = plural(len(data["rows"]), "setting")
    text = f"Harmonic balance has a response of the nine lines at {len(solved)} of {tried}"
    return f"{text}, none on {', '.join(failed)}." if failed else f"{text}."


def _growth(data, folder, tables) -> FigureWithTable:
    rows = [row | {"memory": row["memory"] / 1e6} for row in data["rows"]]
    columns = {"lines": "lines", "nodes": "nodes", "seconds": "run time", "memory": "memory, MB"}
    formats = {"seconds": seconds, "memory": two_digits}
    table = _table(tables, "growth", "Growth with lines", rows, columns, formats=formats)
    return FigureWithTable(network_figures.growth(data, folder), table)


def _damping(data, folder, tables) -> FigureWithTable:
    rows = [row | {"status": status_words(row["status"])} for row in data["rows"]]
    columns = {"title": "system", "drag": "share of the drag", "periods": "periods", "in_time": "in time",
               "balance": "harmonic balance", "status": "its status", "difference": "difference"}  # fmt: skip
    formats = {"drag": "{:g}".format, "in_time": seconds, "balance": seconds, "difference": two_digits}
    table: Table = _table(tables, "damping", "Until periodic, by drag", rows, columns, formats=formats)
    return FigureWithTable(network_figures.damping(data, folder), table)


PARTS = {"agreement": _agreement, "work": _work, "balance": _balance, "growth": _growth, "damping": _damping}
"""Part of mooring_networks.json -> what the template takes of it."""

MOORING_NETWORKS = Section(
    id="mooring-networks",
    title="Moving networks beside MoorDyn",
    part="error-for-time",
    page="moving",
    needs=("mooring_networks",),
    template="mooring/networks.html.j2",
    build=build,
    tests={
        "networks": ("mooring/test_network.py::test_a_network_is_taken_apart_where_nodes_are_prescribed",),
    },
)
