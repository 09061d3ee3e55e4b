"""The section on the accuracy of lines at rest, judged against 50 digits, regime by regime."""

from __future__ import annotations

from ..page.numbers import analysis
from ..page.numbers.formatting import number, plural
from ..page.numbers.verdicts import Verdict
from ..page.section import Content, Inputs, Section
from .tables import regime_table, set_table

# What the project set itself to reach before anything was measured.
MEDIAN_ERROR, MAX_ERROR = 4, 100  # over the unavoidable rounding error


def build(inputs: Inputs) -> Content:
    """Return the tables by set and by regime, the verdicts and the sentence on the errors."""
    accuracy = inputs.results["accuracy"]
    if not accuracy:
        return Content({"accuracy": None})
    text = sentence(accuracy)
    context = {
        "accuracy": accuracy,
        "sentence": text,
        "beyond_double": sum(_exceeds_bound(row, accuracy) for row in accuracy["rows"]),
        "sets": set_table(accuracy).write(inputs.tables),
        "regimes": regime_table(accuracy).write(inputs.tables),
    }
    return Content(context, list(verdicts(accuracy)), [text])


def _exceeds_bound(row: dict, accuracy: dict) -> bool:
    """Return whether rounding the inputs alone moves the force by more than the bound of a wrong answer."""
    return row["limit"] is None or row["limit"] > accuracy["wrong_bound"]


def judged(accuracy: dict) -> dict:
    """Return the counts of this project over the reference table and the random lines; the map is of one family."""
    return analysis.summarise([row for row in accuracy["rows"] if row["set"] != "map"], analysis.OURS)


def verdicts(accuracy: dict):
    """Yield the number of lines judged, those refused or wrong, and the median and greatest error."""
    counts = judged(accuracy)
    sets = " + ".join(f"{number(chosen['count'])} {name}" for name, chosen in accuracy["sets"].items() if name != "map")
    yield Verdict(number(counts["cases"]), "lines judged against 50 digits", sets, None, "regimes")
    for verdict in ("refused", "wrong"):
        yield Verdict(number(counts[verdict]), verdict, "of these, wanted 0", counts[verdict] == 0, "regimes")
    for key, bound in (("median", MEDIAN_ERROR), ("max", MAX_ERROR)):
        name = {"median": "median error", "max": "greatest error"}[key]
        good = counts[key] is not None and counts[key] <= bound
        yield Verdict(
            number(counts[key], 2),
            name,
            f"times the unavoidable rounding error, wanted at most {bound}",
            good,
            "regimes",
        )


def sentence(accuracy: dict) -> str:
    """Return what came out of the judged lines: refused, wrong, median and greatest error."""
    counts = judged(accuracy)
    text = (
        f"Of {plural(counts['cases'], 'line')} of the reference table and the random set, this project refused "
        f"{counts['refused']} and answered {counts['wrong']} wrong."
    )
    if counts["worst"]:
        text += (
            f" Median error {number(counts['median'], 2)} of the unavoidable rounding error, greatest "
            f"{number(counts['max'], 2)} of it ({counts['worst']['case']})."
        )
    return text


REGIMES = Section(
    id="regimes",
    title="Lines against 50 digits",
    part="verified",
    page="catenary",
    needs=("accuracy",),
    template="catenary/regimes.html.j2",
    build=build,
    tests={
        "regimes": (
            "catenary/test_exact.py::test_forces_equal_the_reference_table",
            "catenary/test_exact.py::test_stiffness_equals_the_reference_table",
            "catenary/test_exact.py::test_random_lines",
            "catenary/test_exact.py::test_any_line_over_a_seabed_agrees_with_50_digits",
        ),
    },
)
