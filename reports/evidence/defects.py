"""The section on seeded defects: which check finds which mistake, from defects.json."""

from __future__ import annotations

from ..page.numbers.formatting import plural
from ..page.numbers.tables import Table
from ..page.numbers.verdicts import Verdict
from ..page.section import Content, Inputs, Section

RANKS = OWN, OTHER, STORED, UNSEEN, VOID = "●○s·!"
"""Found by the named check, by another, by a comparison with stored numbers; not found; failing by itself."""
FOUND = (OWN, OTHER, STORED)

WANTED = 0.95
"""Share that checks other than comparisons with stored numbers are to find."""

KINDS = {
    "sign": "a sign", "factor": "a factor such as 2 or π", "index": "a wrong index or end",
    "symbol": "one symbol for another", "term": "a term missing or doubled", "boundary": "a boundary row",
    "derivative": "a wrong derivative of a right value", "stale": "a stale value", "unit": "a unit",
    "order": "first order for second", "tolerance": "a tolerance without effect", "regime": "a regime missed",
    "input": "an input ignored or not checked", "misprint": "a misprint of the papers",
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
    rows = [_describe(row) for row in real]
    matrix = _matrix(rows)
    for table in (everything, kinds, matrix):
        table.write(inputs.tables)
    defects = {
        "everything": everything,
        "kinds": kinds,
        "summary": data["summary"],
        "left": data.get("catalogue", len(data["defects"])) - len(data["defects"]),
        "matrix": matrix,
        "groups": {module: _group(rows, module) for module in sorted({row["module"] for row in rows})},
        "misprints": [row for row in rows if row["misprint"]],
        "survivors": [row for row in rows if not row["by_other"]],
        "blind": [_describe(row) for row in data["defects"] if row["blind"]],
        "wider": any(len(row["results"]) > 1 for row in real),
    }
    counts = data["summary"]
    planted = plural(counts["defects"], "planted mistake")
    drawn = f", drawn from {data['catalogue']}" if defects["left"] else ""
    text = f"The checks themselves are checked: {counts['caught']} of {planted}{drawn} are found."
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


def _counts(name: str, title: str, heading: str, rows: list[dict], label_of) -> Table:
    """Return one row per module or kind: planted, found, by what."""
    entries = []
    for label in dict.fromkeys(sorted(map(label_of, rows))):
        mine = [row for row in rows if label_of(row) == label]
        other = sum(row["by_other"] for row in mine)
        entries.append(
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
    return Table(name, title, columns, entries, {"rate": "{:.0%}".format})


def _matrix(rows: list[dict]) -> Table:
    """Return module x file of tests: how many of the module's mistakes the file finds; none where it finds none."""
    files = sorted({file for row in rows for file in row["marks"]})
    counted = []
    for module in sorted({row["module"] for row in rows}):
        mine = [row for row in rows if row["module"] == module]
        by_file = {file: sum(row["marks"].get(file, "") in FOUND for row in mine) or None for file in files}
        counted.append(
            {"module": module, "planted": len(mine), "found": sum(row["by_other"] for row in mine)} | by_file
        )
    total = {file: sum(row[file] or 0 for row in counted) for file in files}
    counted.append({"module": "all", "planted": len(rows), "found": sum(row["by_other"] for row in rows)} | total)
    return Table("defects_matrix", "Modules and files of tests", {
        "module": "module", "planted": "planted", "found": "found", **{file: file.replace("_", " ") for file in files}
    }, counted)  # fmt: skip


def _group(rows: list[dict], module: str) -> dict:
    """Return the mistakes of a module, and the files of tests run on them, the named checks first."""
    mine = [row for row in rows if row["module"] == module]
    own = list(dict.fromkeys(file for row in mine for file, mark in row["marks"].items() if mark == OWN))
    return {"rows": mine, "files": [*own, *sorted({file for row in mine for file in row["marks"]} - {*own})]}


def _marks(row: dict) -> dict[str, str]:
    """Return file of tests -> mark of whether it found the mistake; the stronger one where it was run twice."""
    marks = {}
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
        marks[file] = min(mark, marks.get(file, mark), key=RANKS.index)
    return marks


def _flat(row: dict) -> dict:
    described = _describe(row)
    return row | {
        "named": row["check"],
        "found": described["outcome"],
        "others": "; ".join(f"{name}: {word}" for name, word in described["others"]),
    }


def _describe(row: dict) -> dict:
    """Return a defect for the page: how its named check ended, and the other checks run on it."""
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
    """Return one or two words for how a check ended."""
    if result["void"]:
        return "fails without it"
    return {"caught": "found", "timeout": "did not end", "crash": "crashed"}.get(result["outcome"], "not found")


DEFECTS = Section(
    id="defects",
    title="Seeded defects",
    part="verified",
    page="evidence",
    needs=("defects",),
    template="evidence/defects.html.j2",
    build=build,
    tests={"defects": ("suite/test_defects.py::test_planted_defects_are_found", "catenary/test_checks.py")},
)
