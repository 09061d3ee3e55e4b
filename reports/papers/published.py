"""The section on published values: those of reference_data beside what this project makes of their inputs."""

from __future__ import annotations

from ..page.numbers.formatting import two_digits
from ..page.numbers.tables import Table
from ..page.section import Content, Inputs, Section
from ..pipeline.published import SETS, read


def build(inputs: Inputs) -> Content:
    """Return every published set with its source and, where its lines were computed, the comparison."""
    scenes, sets = inputs.results["published"] or {}, []
    for name in SETS:
        source, _ = read(name)
        rows = compare(name, scenes)
        table = _table(name, rows).write(inputs.tables) if source and rows else None
        if source:
            sets.append({"source": source, "table": table, "within": sum(row["within"] for row in rows)})
    return Content({"sets": sets})


def _table(name: str, rows: list[dict]) -> Table:
    """Return printed against computed values."""
    columns = {"line": "line", "quantity": "quantity", "printed": "printed", "computed": "computed",
               "difference": "difference", "open": "left open by printed digits", "within": "within"}  # fmt: skip
    formats = {"printed": "{:.10g}".format, "computed": "{:.9g}".format, "difference": two_digits, "open": two_digits,
               "within": lambda v: "yes" if v else "no"}  # fmt: skip
    return Table(f"published_{name}", name, columns, rows, formats)


def compare(name: str, scenes: dict[str, dict]) -> list[dict]:
    """Return rows of printed and computed values, their difference, and what the printed digits leave open.

    scenes : stem of the scene file -> its result.
    """
    source, rows = read(name)
    comparison = []
    for row in rows:
        scene = scenes.get(f"{name}-{row['name']}")
        if scene:
            line = scene["lines"][0]
            values = (
                _openfast_values(source, row) if name == "openfast_r_test" else _msqs_values(source, row, rows, line)
            )
            comparison += [_compared(row["name"], *value, line) for value in values]
    return comparison


def _openfast_values(source, row):
    """Yield (symbol, printed, key of the result, scale, what the printed digits leave open)."""
    half = source["half_unit"]
    keys = {"H": "H", "V": "V", "T": "tension", "HAnch": "H_anchor", "VAnch": "V_anchor", "Lb": "grounded_length"}
    for symbol, key in keys.items():
        yield symbol, float(row[symbol]), key, 1.0, half[symbol]


def _msqs_values(source, row, rows, line):
    """Yield the same of forces in kN; few printed digits of the end become force by the stiffness. V as corrected."""
    half, vertical = source["half_unit"], row
    if source["inferred"].get("V_swapped"):
        vertical = next(other for other in rows if other["name"] != row["name"])
    for i, (symbol, printed) in enumerate((("H_kN", row["H_kN"]), ("V_kN", vertical["V_kN"]))):
        ends = sum(abs(k) * half[f"{axis}_fairlead"] for k, axis in zip(line["stiffness"][i], "xz", strict=True))
        yield symbol, float(printed), symbol[0], 1e-3, half[symbol] + 1e-3 * ends


def _compared(name, symbol, printed, key, scale, open_digits, line) -> dict:
    computed = scale * line[key]
    difference = computed - printed
    return {
        "line": name, "quantity": symbol, "printed": printed, "computed": computed, "difference": difference,
        "open": open_digits, "within": abs(difference) <= open_digits,
    }  # fmt: skip


PUBLISHED = Section(
    id="published",
    title="Published values",
    part="papers",
    page="papers",
    needs=("published",),
    template="papers/published.html.j2",
    build=build,
    tests={
        "published": (
            "suite/test_published.py::test_openfast_summary_to_its_printed_digits",
            "suite/test_published.py::test_two_line_example_line_by_line",
        ),
    },
)
