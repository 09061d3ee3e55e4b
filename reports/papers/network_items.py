"""Items of the paper on the multisegmented quasi-static model (MSQS): Masciola, Jonkman and Robertson."""

from __future__ import annotations

from collections.abc import Callable

from ..drawing.axes import KN
from ..network.paragraphs import INSIDE, OUTSIDE, PRINTED_WEIGHT, WHOLE, count_operations, in_paper_units, solved
from ..page.numbers.formatting import across, number, plural
from .items import AGREES, CORRECTED, DIFFERS, Entry, Outcome, Sources


def _picture(name: str, remark: str = "") -> Callable[[Sources], Outcome]:
    """Return the evaluation of a drawing: the range of tension and the balance of the same kind of network."""

    def evaluate(s: Sources) -> Outcome:
        row = next(row for row in s.networks["pictures"] if row["name"] == name)
        tensions = [value * KN for element in row["elements"] for value in element["tension"]]
        text = (
            f"{plural(len(row['elements']), 'line')} at {number(min(tensions))} to {number(max(tensions))} kN, in "
            f"balance to {number(row['residual_norm'], 2)} of the largest force"
        )
        return text, AGREES, remark

    return evaluate


def _table2(s: Sources) -> Outcome:
    rows = [
        r for r in in_paper_units(s.networks["table2"]) if r["start"] == "printed" and r["weight"] != PRINTED_WEIGHT
    ]
    good = solved(rows)
    whole = [r["iterations"] for r in good if r["method"] == "monolithic"]
    nested = [(r["iterations"], r["inner_iterations"]) for r in good if r["method"] == "nested"
              and r["jacobian"] == "analytic"]  # fmt: skip
    text = (
        f"monolithic {across(whole)}, nested {' and '.join(f'{a} outer with {b} inner' for a, b in nested)}; "
        f"{len(good)} of {plural(len(rows), 'setting')} in kN succeed"
    )
    same = set(whole) == {int(s.msqs["monolithic, analytic, line-search", "iterations"])}
    why = (
        "the order is the same, monolithic far ahead of nested; counts depend on the rules of line search, trust "
        "region and stopping, which the paper does not give (see there)"
    )
    return text, AGREES if same else DIFFERS, why


def _print_table2(s: Sources) -> str:
    whole = s.msqs["monolithic, analytic, line-search", "iterations"]
    outer, inner = s.msqs["nested", "iterations"], s.msqs["nested", "inner iterations"]
    return f"monolithic {whole:g} iterations, nested {outer:g} outer with {inner:g} inner"


def _jacobian(s: Sources) -> Outcome:
    row = next(row for row in s.networks["example"] if row["weight"] == PRINTED_WEIGHT)
    norms = ", ".join(f"{number(norm['difference'], 2)} {'scaled' if units == 'scaled' else f'in {units}'}"
                      for units, norm in row["jacobian"].items())  # fmt: skip
    text = f"{norms}, for forward differences with a relative step of {number(row['relative_step'], 1)}"
    ratio = s.msqs["jacobian", "norm difference"] / row["jacobian"]["kN"]["difference"]
    why = (
        f"the norm depends on step, units and kind of norm, which are not given; in kN printed is {number(ratio, 2)} "
        "times ours"
    )
    return text, AGREES if 0.1 <= ratio <= 10 else DIFFERS, why


def _forces(s: Sources) -> Outcome:
    """Return the outcome of (5.4), for the weight that the printed numbers belong to."""
    row = _example_at_right_weight(s)
    forces = {f"{c}{i + 1}": row[c][i] * KN for i in (0, 1) for c in "HV"}
    swapped = {"V1": "V2", "V2": "V1"}
    good = all(_fits(s, swapped.get(key, key), value) for key, value in forces.items())
    as_printed = all(_fits(s, key, value) for key, value in forces.items())
    why = _weight_misprint(s) + ("" if as_printed else "; V1 and V2 are printed swapped")
    return _values_text(forces, "kN", row), CORRECTED if good else DIFFERS, why


def _joint(s: Sources) -> Outcome:
    """Return the outcome of (5.5), for the weight that the printed numbers belong to."""
    row = _example_at_right_weight(s)
    position = dict(zip("xyz", row["r"], strict=True))
    good = all(_fits(s, key, value) for key, value in position.items())
    return _values_text(position, "m", row), CORRECTED if good else DIFFERS, _weight_misprint(s)


def _example_at_right_weight(s: Sources) -> dict:
    return next(row for row in s.networks["example"] if row["weight"] != PRINTED_WEIGHT)


def _values_text(values: dict, unit: str, row: dict) -> str:
    return f"{', '.join(f'{key} {value:.1f}' for key, value in values.items())} {unit} at {row['weight']:g} N/m"


def _weight_misprint(s: Sources) -> str:
    other = next(row for row in s.networks["example"] if row["weight"] == PRINTED_WEIGHT)
    return f"the printed {PRINTED_WEIGHT:g} N/m is a misprint: with it H is {other['H'][0] * KN:.1f} kN"


def _fits(s: Sources, key: str, value: float) -> bool:
    """Return whether a value is the printed one to half a unit of its last digit."""
    return abs(value - s.msqs["solution", key]) <= s.half["solution", key] + 1e-9


def _operations(s: Sources) -> Outcome:
    n, m = s.msqs["nested", "iterations"], s.msqs["nested", "inner iterations"]
    whole = count_operations(s.msqs["operations", "iterations of the monolithic method"], WHOLE)
    nested = count_operations(n, OUTSIDE) + count_operations(m, INSIDE)
    ratio = nested / whole
    good = (
        abs(whole - s.msqs["operations", "monolithic"]) <= s.half["operations", "monolithic"]
        and abs(nested - s.msqs["nested", "operations"]) <= s.half["nested", "operations"]
        and abs(ratio - s.msqs["operations", "nested over monolithic"])
        <= s.half["operations", "nested over monolithic"]
    )
    text = f"{number(whole, 5)} monolithic, {number(nested, 4)} nested, {number(ratio, 3)} times"
    return text, AGREES if good else DIFFERS, "arithmetic on the printed counts; measured counts are in Table 2"


SOLVE = "network/test_solve.py::"
ENTRIES = (
    Entry("MSQS", "Fig. 2", "networks-pictures", (f"{SOLVE}test_small_networks_to_40_digits",),
          lambda s: "a multisegmented system with bridles and seabed contact",
          _picture("three_bridles", "a drawing without numbers: a system of the same kind, three lines with bridles")),
    Entry("MSQS", "Fig. 12", "networks-pictures", (f"{SOLVE}test_two_line_example_to_every_digit",),
          lambda s: f"two lines and a buoyancy module of {s.msqs['inputs', 'Fz']:g} kN", _picture("two_lines")),
    Entry("MSQS", "Table 2", "msqs-table2", (f"{SOLVE}test_from_the_start_of_the_paper",), _print_table2, _table2),
    Entry("MSQS", "(5.3)", "msqs-table2", ("network/test_jacobian.py::test_network_derivatives",),
          lambda s: f"norm of the difference of the Jacobians {number(s.msqs['jacobian', 'norm difference'], 3)}",
          _jacobian),
    Entry("MSQS", "(5.4)", "msqs-table2", (f"{SOLVE}test_two_line_example_to_every_digit",
                                           "suite/test_published.py::test_erratum_swapped_vertical_forces",
                                           "suite/test_published.py::test_erratum_weight_of_two_line_example"),
          lambda s: ", ".join(f"{key} {s.msqs['solution', key]:g}" for key in ("H1", "V1", "H2", "V2")) + " kN at "
                    f"{s.msqs['inputs', 'weight']:g} N/m", _forces),
    Entry("MSQS", "(5.5)", "msqs-table2", (f"{SOLVE}test_two_line_example_to_every_digit",),
          lambda s: "joint at (" + ", ".join(f"{s.msqs['solution', a]:.1f}" for a in "xyz") + ") m", _joint),
    Entry("MSQS", "(5.6), (5.7)", "networks",
          ("catenary/test_references.py::test_operations_of_table_2_follow_from_5_6",),
          lambda s: f"{s.msqs['operations', 'monolithic']:g} monolithic, {s.msqs['nested', 'operations']:g} nested, "
                    f"{s.msqs['operations', 'nested over monolithic']:g} times", _operations),
)  # fmt: skip
