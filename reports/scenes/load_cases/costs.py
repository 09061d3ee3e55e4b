"""The section on what tables of load cases cost and err by: promises, MoorDyn on the same cases, theory."""

from __future__ import annotations

from ...page.numbers.formatting import number, seconds, times, two_digits
from ...page.numbers.tables import Table
from ...page.numbers.verdicts import Verdict
from ...page.section import Content, Inputs, Section

QUANTITIES = {"maximum": "greatest", "standard_deviation": "std. dev.", "damage_equivalent_load": "damage"}
WITHIN = 0.95  # of the cases, that the promise must be kept in
STANDARD_ERRORS = 4.0  # of an average, within which theory is met
THEORY_SHARE = 0.03  # of the theory: bands that are neither narrow nor broad to the limit, and Dirlik's own fit
FASTER = 20.0  # times, that MoorDyn is to take as long


def build(inputs: Inputs) -> Content:
    """Return the tables, and the verdicts on the promise, the speed and the theory."""
    data = inputs.results["load_case_costs"]
    if not data:
        return Content({"load_case_costs": None})
    made = {"errors": _errors(data), "costs": _costs(data), "theory": _theory(data)}
    shown = {name: table.write(inputs.tables) for name, table in made.items()}
    return Content({"load_case_costs": shown}, _verdicts(data), _sentences(data))


def _percent(value) -> str:
    return number(None if value is None else 100 * value, 2)


def _errors(data: dict) -> Table:
    rows = [{"system": name, "dt": row["dt"], "cells": row["cells"], "promised": row["promised"],
             "measured": row["measured"], "within": f"{row['within']} of {row['cases']}",
             **{key: max(row["errors"][key]) for key in QUANTITIES}}
            for name, row in data["systems"].items()]  # fmt: skip
    columns = {"system": "OC3", "dt": "step, s", "cells": "cells", "promised": "promised", "measured": "measured",
               "within": "within", **QUANTITIES}  # fmt: skip
    groups = (("", 1), ("setting chosen", 2), ("by the table itself, %", 2), ("against a run four times finer, %", 4))
    note = (
        f"Sea states of {number(data['duration'])} s, wanted: {_percent(data['tolerance'])} % of each quantity; the "
        "largest errors over all cases and lines."
    )
    formats = dict.fromkeys(("promised", "measured", *QUANTITIES), _percent)
    return Table("load_case_errors", "Errors promised and measured", columns, rows, formats, groups, note=note)


def _costs(data: dict) -> Table:
    rows = []
    for name, row in data["systems"].items():
        for k, other in enumerate((row["beside"] or {}).get("rows", ())):
            ours = row["beside"]["rows"][0]["hour"]
            rows.append(other | {"system": "" if k else name, "ratio": other["hour"] / ours if k else None})
    columns = {"system": "OC3", "code": "code", "cells": "cells", "dt": "step, s", "error": "error, %",
               "hour": "an hour takes", "ratio": "times"}  # fmt: skip
    note = (
        "Error: of the standard deviation, the largest over the same cases and lines, against this project four times "
        "finer. CPU seconds of one core; steps of MoorDyn are those of coupling. An hour of MoorDyn is extrapolated "
        "from shorter runs without their start."
    )
    formats = {"error": _percent, "hour": seconds, "ratio": two_digits}
    return Table("load_case_costs", "Cost at equal error", columns, rows, formats, note=note)


def _theory(data: dict) -> Table:
    columns = {
        "quantity": "of Gaussian series",
        "theory": "theory",
        "measured": "measured",
        "sampling": "sampling error",
    }
    exponent = f"exponent {data['exponent']:g}"
    note = f"In standard deviations of the series; damage as the range of one cycle a second, {exponent}."
    formats = dict.fromkeys(list(columns)[1:], lambda v: number(v, 4))
    return Table("load_case_theory", "Theory", columns, data["theory"], formats, note=note)


def _sentences(data: dict) -> list[str]:
    totals = [f"{row['count']} one-hour sea states of {name} take {number(row['total'] / 2)} s on two cores"
              for name, row in data["systems"].items()]  # fmt: skip
    return [f"Load cases of the OC3 system: {', '.join(totals)}."]


def _verdicts(data: dict) -> list[Verdict]:
    made = []
    for name, row in data["systems"].items():
        share = row["within"] / row["cases"]
        made.append(Verdict(f"{row['within']}/{row['cases']}", f"load cases within the promise, {name}",
                            f"{_percent(data['tolerance'])} % of maximum, deviation and damage", share >= WITHIN,
                            "load-case-costs"))  # fmt: skip
        if beside := row["beside"]:
            more = "" if beside["reached"] else "more than "
            detail = f"for the same sea states at equal error in standard deviation; wanted: {times(FASTER)}"
            label, good = f"MoorDyn's time over this project's, {name}", beside["ratio"] >= FASTER
            made.append(Verdict(f"{more}{times(beside['ratio'])}", label, detail, good, "load-case-costs"))
    off = [abs(row["measured"] - row["theory"]) <= STANDARD_ERRORS * row["sampling"] + THEORY_SHARE * row["theory"]
           for row in data["theory"]]  # fmt: skip
    made.append(Verdict(f"{sum(off)}/{len(off)}", "closed forms of Gaussian series met",
                        "Rayleigh, narrow band and Dirlik", all(off), "load-case-costs"))  # fmt: skip
    return made


LOAD_CASE_COSTS = Section(
    id="load-case-costs",
    title="Load cases",
    part="error-for-time",
    page="moving",
    needs=("load_case_costs",),
    template="scenes/load_cases/costs.html.j2",
    build=build,
    tests={
        "load-case-costs": (
            "load_cases/test_accuracy.py::test_the_promise_is_kept",
            "load_cases/test_solve.py::test_one_iteration_of_a_step_is_enough",
            "load_cases/test_solve.py::test_a_linear_line_has_rayleigh_maxima_and_the_damage_of_a_narrow_band",
            "load_cases/test_statistics.py::test_cycles_of_the_standard",
            "load_cases/test_statistics.py::test_broad_band_has_dirliks_damage",
        )
    },
)
