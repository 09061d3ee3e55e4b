"""Every table and figure with numbers of both papers: what it prints, what comes out, agreement or the reason why not.

Printed values come from reference_data, computed ones from the results; an item whose results are not there says so.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from ..cable.figures import KN
from ..network.paragraphs import INSIDE, OUTSIDE, PRINTED_WEIGHT, WHOLE, counted, in_paper_units, solved
from ..page.formatting import across, number, plural
from ..pipeline.stages import SCENES
from . import published

AGREES, CORRECTED, DIFFERS, MISSING = "agrees", "agrees once corrected", "differs", "not computed yet"
CLOSE = 0.02
"""Share of the range up to which curves that the paper calls consistent are taken to agree; no curve was digitised."""
TABLE_1 = {"diameter": "diameter", "unstretched length": "length", "mass per length": "mass_per_length",
           "submerged weight": "submerged_weight", "EA": "EA", "Ca": "Ca", "Cdt": "Cdt", "Cdn": "Cdn",
           "Cdb": "Cdb"}  # fmt: skip
"""Quantity of HB Table 1 -> key in the [line] of the scene."""


@dataclass(frozen=True)
class Item:
    """One item of a paper. prints : its statement; found : what comes out; why : reason of a difference, or remark.

    section : anchor of the remade figure or table; tests : files and names of the tests that show it.
    """

    paper: str
    item: str
    prints: str
    found: str
    verdict: str
    why: str
    section: str
    tests: tuple[str, ...] = ()


@dataclass(frozen=True)
class Sources:
    """Printed values by (name, quantity), and the result files (None where there is none)."""

    hb: dict
    msqs: dict
    cases: dict
    half: dict
    dynamics: dict
    harmonic: dict
    networks: dict


def items(dynamics: dict | None, harmonic: dict | None, networks: dict | None) -> list[Item]:
    """All items, in the order of the papers."""
    (about, rows), (_, section5) = published.read("hb_paper"), published.read("msqs_paper")
    half = {(row["name"], row["quantity"]): float(row["half_unit"]) for row in (*rows, *section5)}
    sources = Sources(published.values("hb_paper"), published.values("msqs_paper"), about["cases"], half,
                      dynamics or {}, harmonic or {},
                      networks or {})  # fmt: skip
    return [_item(*entry, sources) for entry in ITEMS]


def _item(paper, item, section, tests, prints: Callable, found: Callable, sources) -> Item:
    try:
        came, verdict, why = found(sources)
    except (KeyError, StopIteration, IndexError):  # a part that was not measured
        came, verdict, why = "", MISSING, "the part of the results is not there"
    return Item(paper, item, prints(sources), came, verdict, why, section, tests)


def counts(found: list[Item]) -> dict[str, int]:
    """Number of items by verdict, those that do not occur left out."""
    return {v: n for v in (AGREES, CORRECTED, DIFFERS, MISSING) if (n := sum(item.verdict == v for item in found))}


def sentence(found: list[Item]) -> str:
    """One sentence for the summary."""
    plain = {AGREES: "agree", CORRECTED: "agree once a misprint is corrected", DIFFERS: "differ"}
    said = ", ".join(f"{n} {plain.get(verdict, verdict)}" for verdict, n in counts(found).items())
    apart = [f"{item.paper} {item.item}" for item in found if item.verdict == DIFFERS]
    text = f"Of {len(found)} tables, figures and equations of both papers {said}."
    return f"{text} The table gives the reason for each that differs: {', '.join(apart)}." if apart else text


# ---------------------------------------------------------------- harmonic balance
def _table1(s):
    scene = _line_of(SCENES / "dynamics" / "hb_case_1.toml")
    line, ends = scene["line"], scene["ends"]
    used = {quantity: line.get(key) for quantity, key in TABLE_1.items()}
    used |= {"radius": ends["fairlead"][0] - ends["anchor"][0], "depth": ends["fairlead"][2] - ends["anchor"][2]}
    same = {q for q, value in used.items() if value is not None and abs(value - s.hb["line", q]) <= 1e-9 * abs(value)}
    apart = [f"{q} {number(used[q], 6)}" for q in used if q not in same]
    why = f"else: {', '.join(apart)}" if apart else "the inputs of everything below"
    return f"{len(same)} of {len(used)} values are those of the scenes", AGREES if not apart else DIFFERS, why


def _line_of(path: Path) -> dict:
    return tomllib.loads(path.read_text(encoding="utf-8"))


def _fig2(s):
    profile = s.dynamics["profile"]
    nodes = profile["nodes"]
    end = nodes["x"][-1], nodes["z"][-1]
    wanted = s.hb["line", "radius"], s.hb["line", "depth"]
    good = all(abs(a - b) < 1e-6 for a, b in zip(end, wanted, strict=True))
    box, exact = (profile["fairlead"][key] * KN for key in ("box scheme", "catenary"))
    found = (
        f"{plural(len(nodes['s']), 'node')} from the anchor to ({number(end[0], 5)}, {number(end[1], 5)}) m, within "
        f"{number(1e3 * profile['distance'], 2)} mm of the catenary; fairlead {number(box, 6)} kN, catenary "
        f"{number(exact, 6)} kN"
    )
    return (
        found,
        AGREES if good and len(nodes["s"]) == s.hb["statement", "nodes"] else DIFFERS,
        ("the figure gives a shape and no values; shooting, as the paper solves it, gives the catenary"),
    )


def _newton_rows(s, case: str, variant: str):
    return [row for row in s.harmonic["newton"] if (row["case"], row["variant"]) == (case, variant)]


def _fig3(s):
    most, tolerance = s.hb["statement", "most Newton steps"], s.hb["statement", "tolerance"]
    small, large = (_newton_rows(s, case, "paper") for case in ("case_1", "case_1_large"))
    within = [row for row in large if row["iterations"] <= most and row["errors"][-1] <= tolerance]
    found = (
        f"from zero, to {number(tolerance, 1)}: {_steps(small)} steps at {_amplitude(s, 'least')} m; at "
        f"{_amplitude(s, 'largest')} m {len(within)} of {plural(len(large), 'choice')} within {number(int(most))} steps"
    )
    good = all(row["iterations"] <= most for row in small)
    beyond = [row for row in large if row not in within]
    if not beyond:
        return found, AGREES if good else DIFFERS, ""
    names = ", ".join(f"{row['harmonics']} harmonics ({row['iterations']} steps"
                      f"{', none found' if row['reached'] < 1 else ''})" for row in beyond)  # fmt: skip
    kept = _newton_rows(s, "case_1_large", "default")
    return (
        found,
        DIFFERS,
        (
            f"with the paper's relaxation alone and its dropped constant term: {names}; with the constant kept, and "
            f"started from a few harmonics, every choice converges in {_steps(kept)} steps"
        ),
    )


def _steps(rows) -> str:
    low, high = min(row["iterations"] for row in rows), max(row["iterations"] for row in rows)
    return f"{low}" if low == high else f"{low} to {high}"


def _amplitude(s, which: str) -> str:
    return "{:g}".format(s.hb["statement", f"{which} amplitude of the convergence study"])


def _fig4(s):
    rows = [row for row in s.harmonic["constant"] if row["case"] == "case_1_large"]
    few = min(row["harmonics"] for row in rows)
    dropped = next(row for row in rows if not row["mean"] and row["harmonics"] == few)
    kept = max((row for row in rows if row["mean"]), key=lambda row: row["harmonics"])
    lowest = dropped["tension"].index(min(dropped["tension"]))
    period = 1 / s.cases["case 1"]["Y"][1]
    at = period * lowest / len(dropped["tension"])
    late = (s.hb["statement", "time of zero tension at 9 m"] - at) / period
    found = (
        f"constant dropped, {few} harmonics: {number(dropped['min'] * KN, 2)} kN at {number(at, 3)} s; constant kept, "
        f"{kept['harmonics']} harmonics: {number(kept['min'] * KN, 4)} kN"
    )
    return (
        found,
        DIFFERS,
        (
            "the zero comes out with the constant term dropped, as the paper does; it is not in the physics: with the "
            "term "
            f"kept, and in time stepping, the fairlead stays in tension. The paper's zero lies {number(late, 2)} of a "
            "period "
            "later; it does not say at which phase its motion starts, here a sine"
        ),
    )


def _fig5(s):
    rows = {row["drag"]: row for row in s.dynamics["settling"]}
    said, good = [], True
    for drag, wanted in _drags(s):
        level, first = max(rows[drag]["settled"].items(), key=lambda pair: float(pair[0]))
        said.append(f"drag {drag:g}: {'later than computed' if first is None else f'period {first}'}")
        good &= first is not None and (first <= wanted if drag == max(rows) else first >= wanted)
    found = f"within {float(level):g} of the range from {'; '.join(said)} on"
    return found, AGREES if good else DIFFERS, "" if good else "the paper gives no measure of a steady state"


def _drags(s):
    return ((s.hb["line", "Cdn"], s.hb["statement", "periods to steady state at Cdn 1.6"]),
            (s.hb["statement", "smaller drag coefficient"],
             s.hb["statement", "periods to steady state at Cdn 0.1"]))  # fmt: skip


def _states(case: str, figure: int):
    def found(s):
        rows = {row["method"]: row for row in s.harmonic["cases"]["rows"] if row["case"] == case}
        stepped, balanced = rows["time domain"]["tension"], rows["harmonic balance"]["tension"]
        apart = sum((a - b) ** 2 for a, b in zip(stepped, balanced, strict=True)) / len(stepped)
        share = apart**0.5 / (max(stepped) - min(stepped))
        came, consistent = (
            f"both methods differ by {number(share, 2)} of the range of the tension (rms)",
            share <= CLOSE,
        )
        node, printed = s.harmonic["cases"]["s"], s.hb["statement", "arc length of node 25"]
        why = (
            f"node {s.harmonic['cases']['node']} lies at {number(node, 5)} m, the caption prints {number(printed, 5)} m"
        )
        if case == "case_3":
            shift = _shift(s)
            why = (
                f"the differences that the paper sees are the dropped constant term, here {number(shift, 2)} kN; {why}"
            )
            return came, DIFFERS, why
        return came, AGREES if consistent else DIFFERS, why

    return found


def _shift(s) -> float:
    """Mean tension in sway with the constant term over that without, kN."""
    rows = {row["mean"]: row for row in s.harmonic["constant"] if row["case"] == "case_3"}
    return (rows[True]["average"] - rows[False]["average"]) * KN


def _table2(s):
    rows = {
        (row["case"], row["method"]): min(row["seconds"]) for row in s.harmonic["cases"]["rows"] if "seconds" in row
    }
    cases = dict.fromkeys(case for case, _ in rows)
    ours = [rows[case, "time domain"] / rows[case, "harmonic balance"] for case in cases]
    period = [3 * rows[case, "harmonic balance"] / rows[case, "time domain"] for case in cases]
    found = (
        f"harmonic balance {across(ours)} times as fast as three periods of time stepping, which is {across(period)} "
        "periods of it"
    )
    good = max(period) <= s.hb["statement", "periods that harmonic balance costs"]
    why = "another machine and language: seconds are not compared, ratios are"
    return found, AGREES if good else DIFFERS, why


def _print_table2(s) -> str:
    cases = range(1, 5)
    printed = [s.hb[f"case {c}", "time domain"] / s.hb[f"case {c}", "harmonic balance"] for c in cases]
    times = across(s.hb[f"case {c}", "harmonic balance"] for c in cases)
    return f"{times} s, {across(printed)} times as fast as three periods, almost the time of one period"


# ---------------------------------------------------------------- MSQS
def _picture(name: str):
    def found(s):
        row = next(row for row in s.networks["pictures"] if row["name"] == name)
        tensions = [value * KN for element in row["elements"] for value in element["tension"]]
        came = (
            f"{plural(len(row['elements']), 'line')} at {number(min(tensions))} to {number(max(tensions))} kN, in "
            "balance "
            f"to {number(row['residual_norm'], 2)} of the largest force"
        )
        why = "a drawing without numbers: a system of the same kind, three lines with bridles" if row["nodes"] and (
            name == "three_bridles") else ""  # fmt: skip
        return came, AGREES, why

    return found


def _msqs_table2(s):
    rows = [
        r for r in in_paper_units(s.networks["table2"]) if r["start"] == "printed" and r["weight"] != PRINTED_WEIGHT
    ]
    good = solved(rows)
    whole = [r["iterations"] for r in good if r["method"] == "monolithic"]
    nested = [(r["iterations"], r["inner_iterations"]) for r in good if r["method"] == "nested"
              and r["jacobian"] == "analytic"]  # fmt: skip
    found = (
        f"monolithic {across(whole)}, nested {' and '.join(f'{a} outer with {b} inner' for a, b in nested)}; "
        f"{len(good)} of {plural(len(rows), 'setting')} in kN succeed"
    )
    same = set(whole) == {int(s.msqs["monolithic, analytic, line-search", "iterations"])}
    return (
        found,
        AGREES if same else DIFFERS,
        (
            "the order is the same, monolithic far ahead of nested; counts depend on the rules of line search, trust "
            "region and stopping, which the paper does not give (see there)"
        ),
    )


def _jacobian(s):
    row = next(row for row in s.networks["example"] if row["weight"] == PRINTED_WEIGHT)
    said = ", ".join(f"{number(v['difference'], 2)} {'scaled' if u == 'scaled' else f'in {u}'}"
                     for u, v in row["jacobian"].items())  # fmt: skip
    found = f"{said}, for forward differences with a relative step of {number(row['relative_step'], 1)}"
    ratio = s.msqs["jacobian", "norm difference"] / row["jacobian"]["kN"]["difference"]
    why = (
        "the norm depends on step, units and kind of norm, which are not given; in kN printed is "
        f"{number(ratio, 2)} times ours"
    )
    return found, AGREES if 0.1 <= ratio <= 10 else DIFFERS, why


def _solution(name: str):
    """(5.4) forces or (5.5) place of the joint, for the weight that the printed numbers belong to."""

    def found(s):
        row = next(row for row in s.networks["example"] if row["weight"] != PRINTED_WEIGHT)
        if name == "forces":
            got = {f"{c}{i + 1}": row[c][i] * KN for i in (0, 1) for c in "HV"}
        else:
            got = dict(zip("xyz", row["r"], strict=True))
        swapped = {"V1": "V2", "V2": "V1"}
        right = all(_fits(s, key, value, swapped.get(key, key)) for key, value in got.items())
        as_printed = all(_fits(s, key, value, key) for key, value in got.items())
        unit = "kN" if name == "forces" else "m"
        came = f"{', '.join(f'{key} {value:.1f}' for key, value in got.items())} {unit} at {row['weight']:g} N/m"
        other = next(r for r in s.networks["example"] if r["weight"] == PRINTED_WEIGHT)
        why = f"the printed {PRINTED_WEIGHT:g} N/m is a misprint: with it H is {other['H'][0] * KN:.1f} kN"
        if name == "forces" and not as_printed:
            why += "; V1 and V2 are printed swapped"
        return came, CORRECTED if right else DIFFERS, why

    return found


def _fits(s, key: str, value: float, printed: str) -> bool:
    return abs(value - s.msqs["solution", printed]) <= s.half["solution", printed] + 1e-9


def _operations(s):
    n, m = s.msqs["nested", "iterations"], s.msqs["nested", "inner iterations"]
    whole = counted(s.msqs["operations", "iterations of the monolithic method"], WHOLE)
    nested = counted(n, OUTSIDE) + counted(m, INSIDE)
    ratio = nested / whole
    good = (
        abs(whole - s.msqs["operations", "monolithic"]) <= s.half["operations", "monolithic"]
        and abs(nested - s.msqs["nested", "operations"]) <= s.half["nested", "operations"]
        and abs(ratio - s.msqs["operations", "nested over monolithic"])
        <= s.half["operations", "nested over monolithic"]
    )
    found = f"{number(whole, 5)} monolithic, {number(nested, 4)} nested, {number(ratio, 3)} times"
    return found, AGREES if good else DIFFERS, "arithmetic on the printed counts; measured counts are in Table 2"


NETWORK = "network/test_solve.py::"
HARMONIC = "harmonic_balance/test_solve.py::"
ITEMS = (
    ("HB", "Table 1", "dynamics", ("cable/test_exact.py::test_both_sets_speak_of_one_line",
                                   "io/test_scene.py::test_four_cases_of_the_paper"),
     lambda s: f"{s.hb['line', 'unstretched length']:g} m, EA {number(s.hb['line', 'EA'], 6)} N, "
               f"{s.hb['line', 'submerged weight']:g} N/m and {len([k for k in s.hb if k[0] == 'line']) - 3} more",
     _table1),
    ("HB", "Fig. 2", "hb-fig2", ("cable/test_statics.py::test_box_scheme_converges_to_the_catenary",
                                 "cable/test_statics.py::test_the_oc3_line_is_that_of_the_notes"),
     lambda s: f"the static profile by shooting, {s.hb['statement', 'nodes']:g} nodes", _fig2),
    ("HB", "Fig. 3", "hb-fig3", (f"{HARMONIC}test_the_papers_relaxation_converges_as_fast",
                                 f"{HARMONIC}test_9_m_converges_by_itself_from_zero"),
     lambda s: f"all choices at {_amplitude(s, 'least')} and {_amplitude(s, 'largest')} m converge within "
               f"{s.hb['statement', 'most Newton steps']:g} steps to {number(s.hb['statement', 'tolerance'], 1)}",
     _fig3),
    ("HB", "Fig. 4", "hb-fig4", (f"{HARMONIC}test_9_m_without_the_constant_shows_the_papers_zero_tension",
                                 "time_domain/test_solve.py::test_nine_metres_keep_the_line_in_tension"),
     lambda s: f"at {_amplitude(s, 'largest')} m the fairlead tension is "
               f"{s.hb['statement', 'fairlead tension at 9 m near 15 s']:g} around "
               f"{s.hb['statement', 'time of zero tension at 9 m']:g} s", _fig4),
    ("HB", "Fig. 5", "hb-fig5", ("time_domain/test_solve.py::test_the_motion_becomes_periodic",),
     lambda s: "steady after " + ", ".join(f"{p:g} periods{' at least' if d < 1 else ''} with drag {d:g}"
                                           for d, p in _drags(s)), _fig5),
    *(("HB", f"Fig. {figure}", f"hb-fig{figure}", tests,
       lambda s, text=text: text, _states(case, figure))
      for figure, case, text, tests in (
          (6, "case_1", "surge: time domain and harmonic balance consistent",
           (f"{HARMONIC}test_refined_time_integration_is_the_response",)),
          (7, "case_2", "heave: consistent", (f"{HARMONIC}test_refined_time_integration_is_the_response",)),
          (8, "case_3", "sway: observable differences in tension and strain",
           (f"{HARMONIC}test_the_constant_term_explains_fig_8",)),
          (9, "case_4", "surge and sway: consistent", (f"{HARMONIC}test_refined_time_integration_is_the_response",)))),
    ("HB", "Table 2", "table2", ("cable/test_exact.py::test_table_2_of_the_paper",
                                 f"{HARMONIC}test_paper_cases_converge_from_zero"), _print_table2, _table2),
    ("MSQS", "Fig. 2", "networks-pictures", (f"{NETWORK}test_small_networks_to_40_digits",),
     lambda s: "a multisegmented system with bridles and seabed contact", _picture("three_bridles")),
    ("MSQS", "Fig. 12", "networks-pictures", (f"{NETWORK}test_two_line_example_to_every_digit",),
     lambda s: f"two lines and a buoyancy module of {s.msqs['inputs', 'Fz']:g} kN", _picture("two_lines")),
    ("MSQS", "Table 2", "msqs-table2", (f"{NETWORK}test_from_the_start_of_the_paper",),
     lambda s: f"monolithic {s.msqs['monolithic, analytic, line-search', 'iterations']:g} iterations, nested "
               f"{s.msqs['nested', 'iterations']:g} outer with {s.msqs['nested', 'inner iterations']:g} inner",
     _msqs_table2),
    ("MSQS", "(5.3)", "msqs-table2", ("network/test_jacobian.py::test_network_derivatives",),
     lambda s: f"norm of the difference of the Jacobians {number(s.msqs['jacobian', 'norm difference'], 3)}",
     _jacobian),
    ("MSQS", "(5.4)", "msqs-table2", (f"{NETWORK}test_two_line_example_to_every_digit",
                                      "suite/test_published.py::test_erratum_swapped_vertical_forces",
                                      "suite/test_published.py::test_erratum_weight_of_two_line_example"),
     lambda s: ", ".join(f"{key} {s.msqs['solution', key]:g}" for key in ("H1", "V1", "H2", "V2")) + " kN at "
               f"{s.msqs['inputs', 'weight']:g} N/m", _solution("forces")),
    ("MSQS", "(5.5)", "msqs-table2", (f"{NETWORK}test_two_line_example_to_every_digit",),
     lambda s: "joint at (" + ", ".join(f"{s.msqs['solution', a]:.1f}" for a in "xyz") + ") m", _solution("place")),
    ("MSQS", "(5.6), (5.7)", "networks", ("catenary/test_references.py::test_operations_of_table_2_follow_from_5_6",),
     lambda s: f"{s.msqs['operations', 'monolithic']:g} monolithic, {s.msqs['nested', 'operations']:g} nested, "
               f"{s.msqs['operations', 'nested over monolithic']:g} times", _operations),
)  # fmt: skip
"""(paper, item, section, tests, what it prints, what comes out)."""
