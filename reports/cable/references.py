"""The table of references: observed order and numerical uncertainty in mesh and step, as in ASME V&V 20-2009."""

from __future__ import annotations

from pathlib import Path

from ..page.numbers.formatting import number, two_digits
from ..page.numbers.tables import Table, write_table

WHAT = {"mesh": "cells", "steps": "steps in a period", "harmonics": "harmonics"}
"""Key of a refinement -> what is refined."""


def explain_references(refinements: dict) -> str:
    """Return how the table is read, with the factors that were used."""
    used = [one for kinds in refinements.values() for one in kinds.values() if one["safety"] is not None]
    factors = " or ".join(_plain(value) for value in sorted({one["safety"] for one in used}))
    expansions = " or ".join(_plain(value) for value in sorted({one["expansion"] for one in used}))
    sentences = (
        "Numerical uncertainty of the references, as in ASME V&V 20: three sizes show the order p, and u_num = Fs "
        "change / (rᵖ - 1) / k is the standard uncertainty of the finest, which extrapolation may still improve.",
        "The safety factor Fs is the smaller where p is near the order of the scheme; the expansion factor k is that "
        "of an error on one side; a change of harmonics is taken to have second order at most.",
        f"Here Fs is {factors} and k {expansions}." if used else "",
        "Where the three differ in another way each time, as where the touchdown travels, they are not in the "
        "asymptotic range, and the bound is their greatest difference.",
        "Values are rms over the range of the tension.",
    )
    return " ".join(filter(None, sentences))


def reference_table(section: str, folder: Path, refinements: dict, titles: dict) -> Table | None:
    """Return a row for each reference and what was refined; None where none was.

    refinements: name -> "mesh", "steps" or "harmonics" -> the fields of a Refinement; titles: name -> title.
    """
    rows = [_row(titles[name], what, one) for name, kinds in refinements.items() for what, one in kinds.items()]
    if not rows:
        return None
    columns = {"reference": "reference", "what": "refined", "sizes": "three sizes", "formal": "order of the scheme",
               "order": "observed", "change": "last change, %", "safety": "Fs", "u_num": "u_num or bound, %",
               "range": "asymptotic range"}  # fmt: skip
    formats = dict.fromkeys(("order", "change", "u_num"), two_digits) | dict.fromkeys(("formal", "safety"), _plain)
    return write_table(section, folder, "references", "Uncertainty of the references", rows, columns, formats=formats)


def _row(title: str, what: str, one: dict) -> dict:
    return {"reference": title, "what": WHAT[what], "sizes": ", ".join(map(str, one["sizes"])),
            "formal": None if what == "harmonics" else one["formal_order"], "order": one["order"],
            "change": 100 * one["change"], "safety": one["safety"], "u_num": 100 * one["u_num"],
            "range": "yes" if one["is_asymptotic"] else "no"}  # fmt: skip


def _plain(value) -> str:
    return number(value) if value is None else f"{value:g}"
