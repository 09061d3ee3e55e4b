"""The section on harmonic balance: figures, tables and sentences from harmonic_balance.json."""

from __future__ import annotations

from ..cable.cases import CASES, motion_of
from ..cable.references import reference_table
from ..cable.tables import to_long_form, write_table
from ..drawing.axes import KN
from ..page.figures import FigureWithTable
from ..page.numbers.formatting import MINUS, number, status_words, times, two_digits
from ..page.numbers.pareto import front_verdict, moving_fronts, summarise_fronts
from ..page.section import Content, Inputs, Section, show_parts
from ..pipeline import published
from . import case_tables, figures, paper_figures
from .verdicts import FIELDS_GAIN, fields_gain, verdicts


def build(inputs: Inputs) -> Content:
    """Return figures and tables of every part that was measured, and the verdicts on them."""
    data = inputs.results["harmonic_balance"]
    if not data:
        return Content({"harmonic": None})
    shown = show_parts(PARTS, data, inputs)
    constant = data.get("constant")
    shown["constant"] = _constant(constant, data.get("cases"), inputs.figures, inputs.tables) if constant else None
    content = Content({"harmonic": shown, "fronts": []}, list(verdicts(data)))
    if work := data.get("work"):
        fronts = moving_fronts(work["points"], CASES)
        content.context["fronts"] = fronts
        content.verdicts.append(front_verdict("moving cables", fronts, "dynamics-work"))
        content.sentences.append(f"Moving cable: {summarise_fronts(fronts)}")
        content.figures += [("a moving cable", figure) for figure in shown["work"]["points"].group.figures[:1]]
    return content


def _newton(rows, folder, tables) -> dict:
    points = [
        {"case": row["case"], "variant": row["variant"], "harmonics": row["harmonics"], "samples": row["samples"],
         "step": i, "error": error}
        for row in rows for i, error in enumerate(row["errors"], 1)
    ]  # fmt: skip
    waves = [
        {"case": row["case"], "variant": row["variant"], "harmonics": row["harmonics"], "samples": row["samples"],
         "instant": i, "tension": value}
        for row in rows for i, value in enumerate(row["tension"])
    ]  # fmt: skip
    return {
        "steps": FigureWithTable(
            paper_figures.newton(rows, folder), write_table(tables, "newton", "Newton steps", points)
        ),
        "tension": FigureWithTable(
            paper_figures.tension(rows, folder), write_table(tables, "tension", "Tension over a period", waves)
        ),
    }


def _constant(rows, cases, folder, tables) -> dict:
    entries = [
        {"case": motion_of(row["case"]), "harmonics": row["harmonics"],
         "mean": "kept" if row["mean"] else "dropped", "max": row["max"] * KN, "min": row["min"] * KN,
         "average": row["average"] * KN,
         **{f"h{k}": value * KN for k, value in enumerate(row["amplitudes"], 1)}, "least": row["least"] * KN,
         "iterations": row["iterations"], "rms": row["rms"], "status": status_words(row["status"]),
         "apart": _difference_from_others(row)}
        for row in rows
    ]  # fmt: skip
    columns = {"case": "case", "harmonics": "Nh", "mean": "constant", "max": "greatest", "min": "least",
               "average": "mean",
               **{f"h{k}": f"{k}" for k in range(1, 6)}, "least": "least on the line", "iterations": "steps",
               "apart": "difference from other programs", "rms": "rms error", "status": "status"}  # fmt: skip
    fixed = dict.fromkeys(("max", "min", "average", "least", *(f"h{k}" for k in range(1, 6))), _kN)
    fixed |= {"rms": two_digits, "apart": two_digits}
    groups = (("", 3), ("fairlead tension, kN", 3), ("harmonics, kN", 5), ("", 5))
    table = write_table(
        tables, "constant", "With and without the constant term", entries, columns, formats=fixed, groups=groups
    )
    return {"figures": paper_figures.constant(rows, cases, folder), "table": table}


def _difference_from_others(row) -> float | None:
    """Return the greatest difference of greatest, least and mean tension from those of independent programs, kN."""
    if not row["independent"]:
        return None
    known = published.independent(row["independent"])
    pairs = (("max", "maximum"), ("min", "minimum"), ("average", "mean"))
    return max(abs(row[key] * KN - known[quantity]) for key, quantity in pairs)


def _kN(value) -> str:
    return f"{value:.2f}".replace("-", MINUS)


def _needed(data, folder, tables) -> FigureWithTable:
    levels = [key for key in data["summary"][0] if key not in ("case", "rate")]
    rows = [row | {"case": CASES[row["case"]]} for row in data["summary"]]
    columns = {"case": "case", **{level: f"Nh for {level}" for level in levels}, "rate": "exponent of the decay"}
    write_table(tables, "needed_points", "Error by harmonics", data["rows"])
    table = write_table(tables, "needed", "Harmonics that are needed", rows, columns, formats={"rate": two_digits})
    return FigureWithTable(figures.needed(data, folder), table)


def _spectra(rows, folder, tables) -> dict:
    lines = [
        {"case": row["case"], "harmonic": k, "amplitude": value}
        for row in rows
        for k, value in enumerate(row["amplitudes"])
    ]
    along = [
        point
        for row in rows
        for point in to_long_form({key: row[key] for key in ("s", "rest", "min", "mean", "max")}, case=row["case"])
    ]
    return {
        "spectra": FigureWithTable(
            figures.spectra(rows, folder), write_table(tables, "spectra", "Harmonics of the tension", lines)
        ),
        "envelope": FigureWithTable(
            figures.envelope(rows, folder), write_table(tables, "envelope", "Tension along the line", along)
        ),
    }


def _limit(data, folder, tables) -> FigureWithTable:
    rows = [
        row | {"least": row["least"] * KN, "fairlead": row["fairlead"] * KN,
               "status": status_words(row["status"])}
        for row in data["rows"]
    ]  # fmt: skip
    columns = {"amplitude": "amplitude, m", "least": "least tension, kN", "node": "node", "s": "s, m", "at": "time, s",
               "fairlead": "least at the fairlead, kN", "iterations": "steps", "reached": "share reached",
               "status": "status"}  # fmt: skip
    formats = {"amplitude": "{:g}".format, "least": _kN, "fairlead": _kN}
    table = write_table(tables, "limit", "Amplitude raised", rows, columns, formats=formats)
    return FigureWithTable(figures.limit(data, folder), table)


def _growth(data, folder, tables) -> FigureWithTable:
    return FigureWithTable(
        figures.growth(data, folder), write_table(tables, "growth", "Growth of harmonic balance", data["rows"])
    )


def _fields(data, folder, tables) -> str:
    gain = fields_gain(data)
    return (
        f"The planar case 1 in six fields instead of four takes {times(gain)} as long (median of "
        f"{len(data['seconds']['planar'])} turns, {_wanted(gain, FIELDS_GAIN)}), and its tension differs by "
        f"{number(data['difference'], 1)}."
    )


def _wanted(value: float, bound: float) -> str:
    return f"wanted at least {bound:g}: {'reached' if value >= bound else 'not reached'}"


def _oscillators(rows, folder, tables) -> dict:
    entries = []
    for row in rows:
        ours = {
            "ours": 1e3 * row["seconds"],
            "full": 1e3 * row["seconds_full"],
            "unknowns": row["masses"] * (2 * row["harmonics"] + 1),
        }
        entries.append(row | ours | published.other_times(row["set"]))
    columns = {"masses": "masses", "harmonics": "harmonics", "unknowns": "unknowns", "ours": "with symmetry",
               "full": "without", "iterations": "steps", "dense LU": "dense LU", "pyHarm": "pyHarm", "mousai": "mousai",
               "harmonicbalance": "harmonicbalance"}  # fmt: skip
    groups = (("", 3), ("this project, ms, measured now", 3), ("measured on another day, CPU ms", 4))
    table = write_table(tables, "oscillators", "Chains of masses with cubic springs", entries, columns, groups=groups)
    libraries = ("pyHarm", "mousai", "harmonicbalance")
    ahead = [
        row["full"] < min(row[name] for name in libraries if row.get(name))
        for row in entries
        if any(row.get(n) for n in libraries)
    ]
    text = (
        "Chains of masses with cubic springs, solved from zero. Without using the symmetry this project is the "
        f"fastest of the libraries in {sum(ahead)} of the {len(ahead)} sizes that one of them solved. A dash: given "
        f"up, or not tried. Each mass has {rows[0]['fields']} fields here (position, velocity, force of the spring) "
        "and one in the libraries."
    )
    return {"text": text, "table": table}


def _references(data, folder, tables):
    kept = {case: one["refinements"] for case, one in data.items() if one.get("refinements")}
    return reference_table("dynamics", tables, kept, CASES)


PARTS = {
    "references": _references,
    "cases": case_tables.show_cases,
    "work": case_tables.show_work,
    "newton": _newton,
    "needed": _needed,
    "spectra": _spectra,
    "limit": _limit,
    "growth": _growth,
    "fields": _fields,
    "oscillators": _oscillators,
}
"""Part of harmonic_balance.json -> what the template takes of it."""

SOLVE = "harmonic_balance/test_solve.py::"
HARMONIC = Section(
    id="harmonic",
    title="Harmonic balance",
    part="error-for-time",
    page="harmonic",
    needs=("harmonic_balance",),
    template="harmonic_balance/section.html.j2",
    build=build,
    tests={
        "harmonic": (
            f"{SOLVE}test_refined_time_integration_is_the_response",
            f"{SOLVE}test_case_1_converges_to_the_independent_reference",
            f"{SOLVE}test_convergence_in_nodes_is_of_second_order",
            "harmonic_balance/test_jacobian.py",
            "harmonic_balance/test_oscillators.py",
        ),
        "table2": (f"{SOLVE}test_paper_cases_converge_from_zero",),
        "constant": (
            f"{SOLVE}test_table_of_the_constant_term",
            f"{SOLVE}test_the_constant_term_explains_fig_8",
            f"{SOLVE}test_9_m_without_the_constant_shows_the_papers_zero_tension",
        ),
        "needed": (
            f"{SOLVE}test_needed_harmonics",
            f"{SOLVE}test_four_samples_a_harmonic_are_enough",
        ),
        "limit": (
            f"{SOLVE}test_compression_is_named",
            f"{SOLVE}test_a_motion_too_large_is_named",
        ),
    },
)
