"""The section on seeded defects: which check finds which mistake, from defects.json."""

from __future__ import annotations

from pathlib import Path

from .tables import Table
from .verdicts import Verdict
from .words import plural

WANTED = 0.95
"""Share that is to be found by checks other than comparisons with stored numbers."""

KINDS = {
    "sign": "a sign", "factor": "a factor such as 2 or π", "index": "a wrong index or end",
    "symbol": "one symbol for another", "term": "a term missing or doubled", "boundary": "a boundary row",
    "derivative": "a derivative beside a right value", "stale": "something old kept too long", "unit": "a unit",
    "order": "first order for second", "tolerance": "a tolerance that is none", "regime": "a regime missed",
    "input": "an input lost or let through", "misprint": "a misprint of the papers",
}  # fmt: skip


def section(data: dict | None, table_folder: Path) -> dict | None:
    """What the template defects.html.j2 takes; None without a result file."""
    if not data:
        return None
    real = [row for row in data["defects"] if not row["blind"]]
    everything = Table("defects", "Every defect and every check", {
        key: key for key in ("module", "name", "kind", "what", "named", "found", "others", "misprint", "blind")
    }, [_flat(row) for row in data["defects"]])  # fmt: skip
    tables = {
        "modules": _counts("defects_modules", "By module", "module", real, lambda row: row["module"]),
        "kinds": _counts("defects_kinds", "By kind of mistake", "mistake", real, lambda row: KINDS[row["kind"]]),
    }
    for table in (everything, *tables.values()):
        table.write(table_folder)
    shown = [_shown(row) for row in real]
    return tables | {
        "everything": everything,
        "summary": data["summary"],
        "groups": {
            module: [row for row in shown if row["module"] == module]
            for module in sorted({row["module"] for row in shown})
        },
        "misprints": [row for row in shown if row["misprint"]],
        "survivors": [row for row in shown if not row["by_other"]],
        "blind": [_shown(row) for row in data["defects"] if row["blind"]],
        "wider": any(len(row["results"]) > 1 for row in real),
    }


def verdicts(data: dict | None) -> list[Verdict]:
    """For the strip at the top of the page."""
    if not data:
        return []
    counts = data["summary"]
    text = f"of {plural(counts['defects'], 'planted mistake')}, by checks without stored numbers, wanted {WANTED:.0%}"
    missed = len(counts["missed_misprints"])
    return [
        Verdict(f"{counts['rate']:.1%}", "of mistakes found", text, counts["rate"] >= WANTED, "defects"),
        Verdict(str(missed), "misprints not found", f"of {len(counts['misprints'])} planted, wanted 0", missed == 0,
                "defects"),
    ]  # fmt: skip


def _counts(name: str, title: str, heading: str, rows: list[dict], of) -> Table:
    """One row per module or kind: planted, found, by what."""
    shown = []
    for label in dict.fromkeys(sorted(map(of, rows))):
        mine = [row for row in rows if of(row) == label]
        other = sum(row["by_other"] for row in mine)
        shown.append(
            {
                "label": label,
                "planted": len(mine),
                "named": sum(row["by_named"] for row in mine),
                "other": other,
                "rate": other / len(mine),
            }
        )
    columns = {"label": heading, "planted": "planted", "named": "found by its own check",
               "other": "without stored numbers", "rate": "rate"}  # fmt: skip
    return Table(name, title, columns, shown, {"rate": "{:.0%}".format})


def _flat(row: dict) -> dict:
    shown = _shown(row)
    return row | {
        "named": row["check"],
        "found": shown["outcome"],
        "others": "; ".join(f"{name}: {word}" for name, word in shown["others"]),
    }


def _shown(row: dict) -> dict:
    """A defect as the page shows it: how its own check ended, and the other checks it was shown to."""
    own, *others = row["results"]
    return row | {
        "test": own["check"].split(" -k ")[0].replace("::", " "),
        "outcome": outcome(own),
        "good": own["outcome"] != "missed" and not own["void"],
        "others": [(other["check"].split()[0].removesuffix(".py"), outcome(other)) for other in others],
    }


def outcome(result: dict) -> str:
    """One or two words for how a check ended."""
    if result["void"]:
        return "red without it"
    return {"caught": "found", "timeout": "did not end", "crash": "crashed"}.get(result["outcome"], "not seen")
