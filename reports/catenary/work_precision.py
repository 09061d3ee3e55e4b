"""The section on lines at rest: error against run time, where the errors are, and speed."""

from __future__ import annotations

from ..page.numbers import analysis
from ..page.numbers.formatting import TIMES, number, ratio
from ..page.numbers.pareto import front_verdict, static_fronts, summarise_fronts
from ..page.numbers.verdicts import Verdict
from ..page.section import Content, Inputs, Section
from . import figures, profiles
from .tables import speed_table, timing_table, work_table

# What the project set itself to reach before anything was measured.
COLD_RATIO = 3  # times faster than MoorPy on one cold line
BATCH_US = 1.5  # per line, 1e5 lines on one thread
GROWTH = 11  # time of ten times as many lines


def build(inputs: Inputs) -> Content:
    """Return figures and tables of errors and times, and the verdicts on speed and on the Pareto front."""
    accuracy, work, speed = (inputs.results[name] for name in ("accuracy", "work_precision", "speed"))
    timings = analysis.benchmark_rows(inputs.results["benchmarks"]) if inputs.results["benchmarks"] else []
    fronts = static_fronts(work["points"]) if work else []
    group = figures.work_precision(work, inputs.looks, inputs.figures) if work else None
    context = {
        "accuracy": accuracy,
        "work": group,
        "work_table": work_table(work).write(inputs.tables) if work else None,
        "fronts": fronts,
        "profiles": profiles.profiles(work, accuracy, inputs.looks, inputs.figures) if work else None,
        "costs": profiles.cost_table(work).write(inputs.tables) if work else None,
        "map": figures.error_map(accuracy, inputs.looks, inputs.figures) if accuracy else None,
        "speed": speed,
        "speed_table": speed_table(speed).write(inputs.tables) if speed else None,
        "cold": figures.cold_times(timings, inputs.looks, inputs.figures) if timings else None,
        "timings": timing_table(timings).write(inputs.tables) if timings else None,
    }
    content = Content(context, list(speed_verdicts(speed)) if speed else [])
    if work:
        content.verdicts.append(front_verdict("lines at rest", fronts, "work-precision"))
        content.sentences.append(f"Lines at rest: {summarise_fronts(fronts)}")
        content.figures += [("lines at rest, all cases together", figure) for figure in group.figures[:1]]
    return content


def speed_verdicts(speed: dict):
    """Yield the times of other codes over ours on one cold line, and the time and growth of many lines in one call."""
    cold, batch = speed["cold_oc3"], speed["batch"]
    for name, label, bound in (("moorpy", "MoorPy", COLD_RATIO), ("pycatenary", "pycatenary", None)):
        value = cold.get(f"ratio_{name}")
        if value is not None:
            wanted = f", wanted at least {bound}" if bound else ""
            text = f"over that of this project, one cold line{wanted}"
            good = None if bound is None else value >= bound
            yield Verdict(f"{ratio(value)} {TIMES}", f"time of {label}", text, good, "speed", "peers")
    us, growth = batch["us_per_line_1e5"], batch["growth"]
    text = f"100 000 lines in one call, wanted at most {BATCH_US}"
    yield Verdict(f"{number(us, 2)} µs", "per line", text, us <= BATCH_US, "speed")
    text = f"over that of 100 000, wanted at most {GROWTH}"
    yield Verdict(f"{number(growth, 3)} {TIMES}", "time of 1 000 000 lines", text, growth <= GROWTH, "speed")


WORK_PRECISION = Section(
    id="work-precision",
    title="Lines at rest",
    part="error-for-time",
    page="catenary",
    needs=("accuracy", "work_precision", "speed", "benchmarks"),
    template="catenary/work_precision.html.j2",
    build=build,
    tests={
        "work-precision": (
            "catenary/test_exact.py::test_few_evaluations_from_no_guess",
            "catenary/test_cross_solver.py::test_batch_and_scalar_share_the_meaning_of_tolerance",
        ),
        "map": ("catenary/test_limits.py", "suite/test_stability.py::test_spans_at_the_limits_against_50_digits"),
        "speed": (
            "catenary/test_cross_solver.py::test_batch_equals_scalar_on_the_reference_table",
            "catenary/test_cross_solver.py::test_rows_do_not_know_their_neighbours",
        ),
    },
)
