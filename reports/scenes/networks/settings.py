"""The settings of a moving network: their run times, the cheapest that meets the tolerance, and how to call it."""

from __future__ import annotations

from collections import Counter

from ...page.numbers.formatting import number, plural, seconds, status_words

TIMINGS = "timings"
"""Key of the results that has the run times of settings by file, where they were measured apart."""
OWN = ("time domain", "harmonic balance")
STAR = "Star: the recommended setting, or where none meets the tolerance the most accurate one."
UNSUPPORTED = {"REFUSED": "refused", "UNSUPPORTED": "not applicable"}
"""Status of another code without an answer -> words."""


def merge_timings(results: dict | None) -> dict[str, dict]:
    """Return the reports by stem, each setting with the run time that was measured by itself, where it was."""
    reports = dict(results or {})
    timings = reports.pop(TIMINGS, {})
    for stem, report in reports.items():
        measured = {_key(row): row["seconds"] for row in timings.get(stem, ())}
        if measured and report.get("ladder"):
            ladder = [row | {"seconds": measured.get(_key(row), row["seconds"])} for row in report["ladder"]]
            reports[stem] = report | {"ladder": ladder}
    return {stem: report | {"recommended": recommend(report)} for stem, report in reports.items()}


def _key(row: dict):
    return row["method"], row["cells"], row.get("steps"), row.get("harmonics")


def recommend(report: dict) -> dict | None:
    """Return the cheapest setting whose error, with that of the reference, meets the tolerance; else the best one."""
    uncertainty = (report.get("reference") or {}).get("uncertainty")
    rows = [
        row | {"promised": row["error"] + uncertainty}
        for row in report.get("ladder", ())
        if row["method"] in OWN and row["error"] is not None and row["seconds"] and uncertainty is not None
    ]
    within = [row for row in rows if row["promised"] <= report["tolerance"]]
    if within:
        return min(within, key=lambda row: row["seconds"]) | {"meets": True}
    return min(rows, key=lambda row: row["promised"]) | {"meets": False} if rows else None


def mark_best(best: dict) -> str:
    """Return what a table says of the best setting: recommended only where its promise meets the tolerance."""
    return "recommended" if best["meets"] else "most accurate"


def describe_setting(row: dict) -> str:
    """Return a setting in words."""
    if row["method"] == "harmonic balance":
        return f"harmonic balance on {row['cells']} cells with {plural(row['harmonics'], 'harmonic')}"
    return f"time stepping on {row['cells']} cells with dt = {number(row['dt'])} s"


def sentence(report: dict) -> str:
    """Return what to use, what it costs and which error it promises."""
    best = report["recommended"]
    if best is None:
        return "No setting has an error that is known: the table says how each ended."
    tolerance = number(report["tolerance"], 1)
    cost = (
        f"{seconds(best['seconds'])} here for {_duration(report, best)}, expected error "
        f"{number(best['promised'], 2)} of the largest tension"
    )
    if best["meets"]:
        return f"Use {describe_setting(best)}: {cost}, within the tolerance of {tolerance}."
    return (
        f"No setting meets the tolerance of {tolerance}. The most accurate is {describe_setting(best)}: {cost}. "
        f"{what_would_meet(best, report['tolerance'], report['reference']['uncertainty'], 'cells')}"
    )


def what_would_meet(best: dict, tolerance: float, uncertainty: float, parts: str) -> str:
    """Return which setting would meet a tolerance, by the order of the methods, or why no promise can be made.

    parts: "cells" or "nodes"; both methods are of second order in these and in the step.
    """
    if uncertainty >= tolerance:
        return (
            f"The converged tension that it is compared with is known to {number(uncertainty, 2)} only, so no setting "
            "can be promised to meet it; slack and touchdown are the usual causes, with which errors fall slowly."
        )
    allowed = tolerance - uncertainty
    finer = (best["error"] / allowed) ** 0.5
    if best["method"] == "time domain":
        step = f"dt = {number(best['dt'] / finer, 2)} s"
        return f"By second order it would take about {_more(best[parts], finer)} {parts} and {step}."
    return f"By second order it would take about {_more(best[parts], finer)} {parts}, and harmonics in proportion."


def find_hidden_errors(report: dict) -> float | None:
    """Return to what the reference is known where settings differ from it by less; None where none does."""
    known = (report.get("reference") or {}).get("uncertainty")
    errors = [row["error"] for row in report.get("ladder", ()) if row["error"] is not None]
    return known if known is not None and min(errors, default=known) < known else None


def _more(count: int, factor: float) -> int:
    """Return a count times a factor, rounded up to tens."""
    return int(-(-count * factor // 10) * 10)


def _duration(report: dict, best: dict) -> str:
    if best["method"] == "harmonic balance":
        return "the periodic response"
    return f"{report['periods']} periods" if report["period"] else f"the series of {number(report['duration'])} s"


def describe_reference(report: dict) -> list[str]:
    """Return what errors are measured against, how well it is known, and how far the methods agree."""
    known, agreement = report["reference"], report["agreement"]
    if known["uncertainty"] is None:
        return []
    how = "extrapolated from this and two coarser ones" if known["extrapolated"] else "the finest of three"
    sentences = [
        "Errors are those of the worst line, over its largest tension, against time stepping on "
        f"{known['cells']} cells with dt = {number(known['dt'])} s, {how}, known to {number(known['uncertainty'], 2)}."
    ]
    if agreement:
        sentences.append(
            f"On the same {agreement['cells']} cells harmonic balance with "
            f"{plural(agreement['harmonics'], 'harmonic')} and time stepping with {agreement['steps']} steps a period "
            f"differ by {number(agreement['difference'], 2)}."
        )
    elif report["period"]:
        sentences.append("Harmonic balance solved none of its settings.")
    return sentences


def count_outcomes(ladder: list[dict]) -> str:
    """Return such as "13 solved, 2 no periodic response, MoorDyn not applicable"."""
    failed = [row for row in ladder if row["status"] != "SUCCESS"]
    reasons = Counter(status_words(row["status"]) for row in failed if row["method"] in OWN)
    others = dict.fromkeys(
        f"{row['method']} {UNSUPPORTED.get(row['status'], 'failed')}" for row in failed if row["method"] not in OWN
    )
    return ", ".join([f"{len(ladder) - len(failed)} solved", *(f"{n} {why}" for why, n in reasons.items()), *others])


def python_to_paste(report: dict) -> str | None:
    """Return the recommended setting as Python."""
    best = report["recommended"]
    if best is None:
        return None
    balanced = best["method"] == "harmonic balance"
    duration = f"periods={report['periods']}" if report["period"] else f"duration={report['duration']:.6g}"
    name, how = ("solve_periodic", f"harmonics={best['harmonics']}") if balanced else (
        "solve_time_domain", f"dt={best['dt']:.6g}, {duration}")  # fmt: skip
    reader = "load_network" if report["file"].endswith(".toml") else "load_moordyn"
    series = report.get("series")
    motion = f', motion=load_body_motion("{series}")' if series else ""
    readers = f"load_body_motion, {reader}" if series else reader
    return (
        f"from solvers import mooring_system, {name}\nfrom solvers.io import {readers}\n\n"
        f'system = mooring_system({reader}("{report["file"]}"), cells={best["cells"]}{motion})\n'
        f"result = {name}(system, {how})\n"
        "largest = [abs(line.fairlead_tension(line.time)).max() for line in result.elements]  # N\n"
        "force, moment = result.body_force, result.body_moment  # (3, K), N and N m"
    )
