"""Items of the paper on harmonic balance (HB): Chen, Basu and Nielsen (2019)."""

from __future__ import annotations

import tomllib
from collections.abc import Callable

from ..drawing.axes import KN
from ..page.numbers.formatting import across, number, plural
from ..pipeline.stages import SCENES
from .items import AGREES, DIFFERS, Entry, Outcome, Sources

CLOSE = 0.02
"""Share of the range up to which curves that the paper calls consistent are taken to agree; no curve was digitised."""
TABLE_1 = {"diameter": "diameter", "unstretched length": "length", "mass per length": "mass_per_length",
           "submerged weight": "submerged_weight", "EA": "EA", "Ca": "Ca", "Cdt": "Cdt", "Cdn": "Cdn",
           "Cdb": "Cdb"}  # fmt: skip
"""Quantity of HB Table 1 -> key in the [line] of the scene."""


def _table1(s: Sources) -> Outcome:
    scene = tomllib.loads((SCENES / "dynamics" / "hb_case_1.toml").read_text(encoding="utf-8"))
    line, ends = scene["line"], scene["ends"]
    used = {quantity: line.get(key) for quantity, key in TABLE_1.items()}
    used |= {"radius": ends["fairlead"][0] - ends["anchor"][0], "depth": ends["fairlead"][2] - ends["anchor"][2]}
    same = {q for q, value in used.items() if value is not None and abs(value - s.hb["line", q]) <= 1e-9 * abs(value)}
    other = [f"{q} {number(used[q], 6)}" for q in used if q not in same]
    why = f"else: {', '.join(other)}" if other else "the inputs of everything below"
    return f"{len(same)} of {len(used)} values are those of the scenes", DIFFERS if other else AGREES, why


def _fig2(s: Sources) -> Outcome:
    profile = s.dynamics["profile"]
    nodes = profile["nodes"]
    end = nodes["x"][-1], nodes["z"][-1]
    wanted = s.hb["line", "radius"], s.hb["line", "depth"]
    same_end = all(abs(a - b) < 1e-6 for a, b in zip(end, wanted, strict=True))
    box, exact = (profile["fairlead"][key] * KN for key in ("box scheme", "catenary"))
    text = (
        f"{plural(len(nodes['s']), 'node')} from the anchor to ({number(end[0], 5)}, {number(end[1], 5)}) m, within "
        f"{number(1e3 * profile['distance'], 2)} mm of the catenary; fairlead {number(box, 6)} kN, catenary "
        f"{number(exact, 6)} kN"
    )
    verdict = AGREES if same_end and len(nodes["s"]) == s.hb["statement", "nodes"] else DIFFERS
    return text, verdict, "the figure gives a shape and no values; shooting, as the paper solves it, gives the catenary"


def _newton_rows(s: Sources, case: str, variant: str) -> list[dict]:
    return [row for row in s.harmonic["newton"] if (row["case"], row["variant"]) == (case, variant)]


def _fig3(s: Sources) -> Outcome:
    most, tolerance = s.hb["statement", "most Newton steps"], s.hb["statement", "tolerance"]
    small, large = (_newton_rows(s, case, "paper") for case in ("case_1", "case_1_large"))
    within = [row for row in large if row["iterations"] <= most and row["errors"][-1] <= tolerance]
    text = (
        f"from zero, to {number(tolerance, 1)}: {_steps(small)} steps at {_amplitude(s, 'least')} m; at "
        f"{_amplitude(s, 'largest')} m {len(within)} of {plural(len(large), 'choice')} within {number(int(most))} steps"
    )
    beyond = [row for row in large if row not in within]
    if not beyond:
        return text, AGREES if all(row["iterations"] <= most for row in small) else DIFFERS, ""
    names = ", ".join(f"{row['harmonics']} harmonics ({row['iterations']} steps"
                      f"{', none found' if row['reached'] < 1 else ''})" for row in beyond)  # fmt: skip
    why = (
        f"with the paper's relaxation alone and its dropped constant term: {names}; with the constant kept, and "
        f"started from a few harmonics, every choice converges in {_steps(_newton_rows(s, 'case_1_large', 'default'))} "
        "steps"
    )
    return text, DIFFERS, why


def _steps(rows: list[dict]) -> str:
    low, high = min(row["iterations"] for row in rows), max(row["iterations"] for row in rows)
    return f"{low}" if low == high else f"{low} to {high}"


def _amplitude(s: Sources, which: str) -> str:
    return "{:g}".format(s.hb["statement", f"{which} amplitude of the convergence study"])


def _fig4(s: Sources) -> Outcome:
    rows = [row for row in s.harmonic["constant"] if row["case"] == "case_1_large"]
    few = min(row["harmonics"] for row in rows)
    dropped = next(row for row in rows if not row["mean"] and row["harmonics"] == few)
    kept = max((row for row in rows if row["mean"]), key=lambda row: row["harmonics"])
    lowest = dropped["tension"].index(min(dropped["tension"]))
    period = 1 / s.cases["case 1"]["Y"][1]
    at = period * lowest / len(dropped["tension"])
    late = (s.hb["statement", "time of zero tension at 9 m"] - at) / period
    text = (
        f"constant dropped, {few} harmonics: {number(dropped['min'] * KN, 2)} kN at {number(at, 3)} s; constant kept, "
        f"{kept['harmonics']} harmonics: {number(kept['min'] * KN, 4)} kN"
    )
    why = (
        "the zero comes out with the constant term dropped, as the paper does; it is not in the physics: with the "
        f"term kept, and in time stepping, the fairlead stays in tension. The paper's zero lies {number(late, 2)} of a "
        "period later; it does not say at which phase its motion starts, here a sine"
    )
    return text, DIFFERS, why


def _fig5(s: Sources) -> Outcome:
    rows = {row["drag"]: row for row in s.dynamics["settling"]}
    periods, good = [], True
    for drag, wanted in _drags(s):
        level, first = max(rows[drag]["settled"].items(), key=lambda pair: float(pair[0]))
        periods.append(f"drag {drag:g}: {'later than computed' if first is None else f'period {first}'}")
        good &= first is not None and (first <= wanted if drag == max(rows) else first >= wanted)
    text = f"within {float(level):g} of the range from {'; '.join(periods)} on"
    return text, AGREES if good else DIFFERS, "" if good else "the paper gives no measure of a steady state"


def _drags(s: Sources):
    return ((s.hb["line", "Cdn"], s.hb["statement", "periods to steady state at Cdn 1.6"]),
            (s.hb["statement", "smaller drag coefficient"],
             s.hb["statement", "periods to steady state at Cdn 0.1"]))  # fmt: skip


def _compare_methods(case: str) -> Callable[[Sources], Outcome]:
    """Return the evaluation of HB Figs. 6 to 9: time domain against harmonic balance in one case."""

    def evaluate(s: Sources) -> Outcome:
        rows = {row["method"]: row for row in s.harmonic["cases"]["rows"] if row["case"] == case}
        stepped, balanced = rows["time domain"]["tension"], rows["harmonic balance"]["tension"]
        mean_square = sum((a - b) ** 2 for a, b in zip(stepped, balanced, strict=True)) / len(stepped)
        difference = mean_square**0.5 / (max(stepped) - min(stepped))
        text = f"both methods differ by {number(difference, 2)} of the range of the tension (rms)"
        node, printed = s.harmonic["cases"]["s"], s.hb["statement", "arc length of node 25"]
        why = (
            f"node {s.harmonic['cases']['node']} lies at {number(node, 5)} m, the caption prints {number(printed, 5)} m"
        )
        if case == "case_3":
            shift = number(_sway_shift(s), 2)
            why = f"the differences that the paper sees are the dropped constant term, here {shift} kN; {why}"
            return text, DIFFERS, why
        return text, AGREES if difference <= CLOSE else DIFFERS, why

    return evaluate


def _sway_shift(s: Sources) -> float:
    """Return the mean tension in sway with the constant term less that without, kN."""
    rows = {row["mean"]: row for row in s.harmonic["constant"] if row["case"] == "case_3"}
    return (rows[True]["average"] - rows[False]["average"]) * KN


def _table2(s: Sources) -> Outcome:
    rows = {
        (row["case"], row["method"]): min(row["seconds"]) for row in s.harmonic["cases"]["rows"] if "seconds" in row
    }
    cases = dict.fromkeys(case for case, _ in rows)
    ours = [rows[case, "time domain"] / rows[case, "harmonic balance"] for case in cases]
    period = [3 * rows[case, "harmonic balance"] / rows[case, "time domain"] for case in cases]
    text = (
        f"harmonic balance {across(ours)} times as fast as three periods of time stepping, which is {across(period)} "
        "periods of it"
    )
    good = max(period) <= s.hb["statement", "periods that harmonic balance costs"]
    return text, AGREES if good else DIFFERS, "another machine and language: seconds are not compared, ratios are"


def _print_table2(s: Sources) -> str:
    cases = range(1, 5)
    printed = [s.hb[f"case {c}", "time domain"] / s.hb[f"case {c}", "harmonic balance"] for c in cases]
    times = across(s.hb[f"case {c}", "harmonic balance"] for c in cases)
    return f"{times} s, {across(printed)} times as fast as three periods, almost the time of one period"


SOLVE = "harmonic_balance/test_solve.py::"
STEPPED = (f"{SOLVE}test_refined_time_integration_is_the_response",)

ENTRIES = (
    Entry("HB", "Table 1", "dynamics", ("cable/test_exact.py::test_both_reference_sets_describe_the_same_line",
                                   "io/test_scene.py::test_four_cases_of_the_paper"),
     lambda s: f"{s.hb['line', 'unstretched length']:g} m, EA {number(s.hb['line', 'EA'], 6)} N, "
               f"{s.hb['line', 'submerged weight']:g} N/m and {len([k for k in s.hb if k[0] == 'line']) - 3} more",
     _table1),
    Entry("HB", "Fig. 2", "hb-fig2", ("cable/test_statics.py::test_box_scheme_converges_to_the_catenary",
                                 "cable/test_statics.py::test_the_oc3_line_is_that_of_the_notes"),
     lambda s: f"the static profile by shooting, {s.hb['statement', 'nodes']:g} nodes", _fig2),
    Entry("HB", "Fig. 3", "hb-fig3", (f"{SOLVE}test_the_papers_relaxation_converges_as_fast",
                                 f"{SOLVE}test_9_m_converges_by_itself_from_zero"),
     lambda s: f"all choices at {_amplitude(s, 'least')} and {_amplitude(s, 'largest')} m converge within "
               f"{s.hb['statement', 'most Newton steps']:g} steps to {number(s.hb['statement', 'tolerance'], 1)}",
     _fig3),
    Entry("HB", "Fig. 4", "hb-fig4", (f"{SOLVE}test_9_m_without_the_constant_shows_the_papers_zero_tension",
                                 "time_domain/test_solve.py::test_nine_metres_keep_the_line_in_tension"),
     lambda s: f"at {_amplitude(s, 'largest')} m the fairlead tension is "
               f"{s.hb['statement', 'fairlead tension at 9 m near 15 s']:g} around "
               f"{s.hb['statement', 'time of zero tension at 9 m']:g} s", _fig4),
    Entry("HB", "Fig. 5", "hb-fig5", ("time_domain/test_solve.py::test_the_motion_becomes_periodic",),
     lambda s: "steady after " + ", ".join(f"{p:g} periods{' at least' if d < 1 else ''} with drag {d:g}"
                                           for d, p in _drags(s)), _fig5),
    *(Entry("HB", f"Fig. {figure}", f"hb-fig{figure}", tests, lambda s, text=text: text, _compare_methods(case))
      for figure, case, text, tests in (
          (6, "case_1", "surge: time domain and harmonic balance consistent", STEPPED),
          (7, "case_2", "heave: consistent", STEPPED),
          (8, "case_3", "sway: observable differences in tension and strain",
           (f"{SOLVE}test_the_constant_term_explains_fig_8",)),
          (9, "case_4", "surge and sway: consistent", STEPPED))),
    Entry("HB", "Table 2", "table2", ("cable/test_exact.py::test_table_2_of_the_paper",
                                      f"{SOLVE}test_paper_cases_converge_from_zero"), _print_table2, _table2),
)  # fmt: skip
