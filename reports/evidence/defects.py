"""The section on seeded defects: which check finds which mistake, from defects.json."""

from __future__ import annotations

from ..page.formatting import plural
from ..page.section import Content, Inputs, Section
from ..page.tables import Table
from ..page.verdicts import Verdict

RANKS = OWN, OTHER, STORED, UNSEEN, VOID = "●○s·!"
"""Seen by the check that was named, by another, by a comparison with stored numbers; not seen; red by itself."""
FOUND = (OWN, OTHER, STORED)

WANTED = 0.95
"""Share that is to be found by checks other than comparisons with stored numbers."""

KINDS = {
    "sign": "a sign", "factor": "a factor such as 2 or π", "index": "a wrong index or end",
    "symbol": "one symbol for another", "term": "a term missing or doubled", "boundary": "a boundary row",
    "derivative": "a derivative beside a right value", "stale": "something old kept too long", "unit": "a unit",
    "order": "first order for second", "tolerance": "a tolerance that is none", "regime": "a regime missed",
    "input": "an input lost or let through", "misprint": "a misprint of the papers",
}  # fmt: skip


def build(inputs: Inputs) -> Content:
    """Return the defects by module, kind and check, those that no check found, and the verdicts."""
    data = inputs.results["defects"]
    if not data:
        return Content({"defects": None})
    real = [row for row in data["defects"] if not row["blind"]]
    everything = Table("defects", "Every defect and every check", {
        key: key for key in ("module", "name", "kind", "what", "named", "found", "others", "misprint", "blind")
    }, [_flat(row) for row in data["defects"]])  # fmt: skip
    kinds = _counts("defects_kinds", "By kind of mistake", "mistake", real, lambda row: KINDS[row["kind"]])
    shown = [_shown(row) for row in real]
    matrix = _matrix(shown)
    for table in (everything, kinds, matrix):
        table.write(inputs.tables)
    defects = {
        "everything": everything,
        "kinds": kinds,
        "summary": data["summary"],
        "matrix": matrix,
        "groups": {module: _group(shown, module) for module in sorted({row["module"] for row in shown})},
        "misprints": [row for row in shown if row["misprint"]],
        "survivors": [row for row in shown if not row["by_other"]],
        "blind": [_shown(row) for row in data["defects"] if row["blind"]],
        "wider": any(len(row["results"]) > 1 for row in real),
    }
    counts = data["summary"]
    text = f"The checks themselves are checked: {counts['caught']} of {plural(counts['defects'], 'planted mistake')} are found."
    return Content({"defects": defects}, verdicts(counts), [text])


def verdicts(counts: dict) -> list[Verdict]:
    """Return the share of planted mistakes that the checks found, and the misprints they did not find."""
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


def _matrix(rows: list[dict]) -> Table:
    """Module x file of tests: how many of the module's mistakes the file finds; none where it finds none."""
    files = sorted({file for row in rows for file in row["marks"]})
    found = []
    for module in sorted({row["module"] for row in rows}):
        mine = [row for row in rows if row["module"] == module]
        seen = {file: sum(row["marks"].get(file, "") in FOUND for row in mine) or None for file in files}
        found.append({"module": module, "planted": len(mine), "found": sum(row["by_other"] for row in mine)} | seen)
    total = {file: sum(row[file] or 0 for row in found) for file in files}
    found.append({"module": "all", "planted": len(rows), "found": sum(row["by_other"] for row in rows)} | total)
    return Table("defects_matrix", "Modules and files of tests", {
        "module": "module", "planted": "planted", "found": "found", **{file: file.replace("_", " ") for file in files}
    }, found)  # fmt: skip


def _group(rows: list[dict], module: str) -> dict:
    """The mistakes of a module, and the files of tests that were shown one of them: its own checks first."""
    mine = [row for row in rows if row["module"] == module]
    own = list(dict.fromkeys(file for row in mine for file, mark in row["marks"].items() if mark == OWN))
    return {"rows": mine, "files": [*own, *sorted({file for row in mine for file in row["marks"]} - {*own})]}


def _marks(row: dict) -> dict[str, str]:
    """File of tests -> what came of showing it the mistake; the stronger mark where it was shown twice."""
    found = {}
    for result in row["results"]:
        file = (result["test"] or result["check"]).split()[0].split("::")[0].removesuffix(".py").replace("/test_", " ")
        if result["void"]:
            mark = VOID
        elif result["outcome"] == "missed":
            mark = UNSEEN
        elif result["check"] == row["check"]:
            mark = OWN
        else:
            mark = STORED if result["frozen"] else OTHER
        found[file] = min(mark, found.get(file, mark), key=RANKS.index)
    return found


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
        "test": (own["test"] or own["check"]).split(" -k ")[0].replace("::", " "),
        "seconds": own["seconds"],
        "marks": _marks(row),
        "outcome": outcome(own),
        "good": own["outcome"] != "missed" and not own["void"],
        "others": [(other["check"].split()[0].removesuffix(".py"), outcome(other)) for other in others],
    }


def outcome(result: dict) -> str:
    """One or two words for how a check ended."""
    if result["void"]:
        return "red without it"
    return {"caught": "found", "timeout": "did not end", "crash": "crashed"}.get(result["outcome"], "not seen")


DEFECTS = Section(
    id="defects",
    title="Seeded defects",
    part="verified",
    needs=("defects",),
    template="evidence/defects.html.j2",
    build=build,
    tests={"defects": ("suite/test_defects.py::test_planted_defects_are_found", "catenary/test_checks.py")},
)
