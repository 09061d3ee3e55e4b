"""The paragraphs on networks of lines: every number in them comes from networks.json."""

from __future__ import annotations

from ..page.numbers.formatting import DASH, across, number, plural, ratio, times
from ..pipeline import published

PRINTED_WEIGHT = published.values("msqs_paper")["inputs", "weight"]
"""N/m, as MSQS prints it; reference_data/errata.toml says why it is not the weight that its results were made with."""

WANTED_METHODS = 10  # nested with differences over monolithic analytic, two lines: set before anything was measured
WANTED_PEER = 20  # MoorPy over this project, warm re-solve of the bridle system: likewise
WANTED_SECONDS, LARGE = 10, 8000  # s for each of the networks of about 10 000 elements: likewise
WANTED_GROWTH = 1.2  # power of the number of elements in the time of a chain: likewise
INSIDE, OUTSIDE, WHOLE = 4, 3, 7
"""Sizes of matrices in (5.6): (H, V) of both lines, the position of the joint, all of them."""


def count_operations(iterations: int, unknowns: int) -> float:
    """Return the operations of dense factorizations, (5.6)."""
    return iterations * 2 / 3 * unknowns**3


def solved(rows: list[dict]) -> list[dict]:
    """Return the rows that ended in success."""
    return [row for row in rows if row["status"] == "SUCCESS"]


def reproduction(rows: list[dict], printed: list[dict]) -> list[tuple[str, str]]:
    """Return (subject, finding) of the printed table: what comes out again, what does not, and why."""
    nested = next(row for row in printed if row["method"] == "nested")
    whole = next(row for row in printed if row["method"] == "monolithic")
    given = [row for row in rows if row["start"] != "none"]
    return [
        ("Weight", _weight(rows)),
        ("Start", _start(given)),
        ("Monolithic counts", _monolithic(given, whole)),
        ("Nested counts", _nested(given, nested)),
        ("Operations", _operations(given, nested, whole)),
        ("Residuals", _residuals(given, printed, nested)),
        ("Units", _units(given)),
        ("Success", _success(rows)),
    ]


def _weight(rows) -> str:
    other = [w for w in dict.fromkeys(row["weight"] for row in rows) if w != PRINTED_WEIGHT]
    return (
        f"the printed {PRINTED_WEIGHT:g} N/m is a misprint, for the printed forces follow from "
        f"{' and '.join(f'{w:g}' for w in other)} N/m (see the misprints below). Both are shown."
    )


def _start(rows) -> str:
    counts = [f"{_share(rows, start=start)} from the {start} start" for start in ("printed", "sound")]
    return (
        "the printed start has vertical forces ten times too large for its horizontal ones; the sound start is that "
        f"of the formula it came from. {' and '.join(counts)} succeed, each method by itself and in all units. The "
        "nested method takes only the position of the joint from a start."
    )


def _share(rows, **wanted) -> str:
    """Return such as "12 of 14 settings": those that succeeded, of the rows with the given values."""
    mine = [row for row in rows if all(row[key] == value for key, value in wanted.items())]
    return f"{len(solved(mine))} of {len(mine)} settings"


def in_paper_units(rows: list[dict]) -> list[dict]:
    """Return the nested rows, and the monolithic ones in kN as the paper has them."""
    return [row for row in rows if row["units"] in (None, "kN")]


def _monolithic(rows, whole) -> str:
    def taken(chosen):
        return _between(row["iterations"] for row in solved(chosen) if row["method"] == "monolithic")

    counts = [
        f"{taken([r for r in in_paper_units(rows) if r['weight'] == w])} at {w:g} N/m"
        for w in dict.fromkeys(row["weight"] for row in rows)
    ]
    return (
        f"printed are {whole['iterations']} iterations whatever the Jacobian and the globalisation. In kN, the paper's "
        f"unit, they are {' and '.join(counts)}, over all units {taken(rows)}: the count depends on the start and on "
        "the rules of the line search and the trust region, which the paper does not give."
    )


def _nested(rows, nested) -> str:
    def inner(jacobian):
        mine = [r for r in solved(rows) if r["method"] == "nested" and r["jacobian"] == jacobian]
        return _between(r["inner_iterations"] for r in mine if r.get("inner_iterations") is not None)

    outer = _between(r["iterations"] for r in solved(rows) if r["method"] == "nested")
    return (
        f"printed are {nested['iterations']} outer and {nested['inner_iterations']} inner iterations; measured are "
        f"{outer} outer and, without differences, {inner('analytic')} inner ones. The outer method here is a "
        f"regularised Newton method with a line search, that of the paper is Levenberg{DASH}Marquardt, which stops at "
        f"{published.values('msqs_paper')['statement', 'tolerance of all solvers']:g} in units that it does not name. "
        "The paper does not count what the differences of the Jacobian cost; with them it is "
        f"{inner('finite-difference')} inner iterations here."
    )


def _operations(rows, nested, whole) -> str:
    n, m = nested["iterations"], nested["inner_iterations"]
    full = [row for row in rows if row["method"] == "monolithic" and not _eliminates(row)]
    agree = sum(abs(row["operations"] - count_operations(row["iterations"], WHOLE)) < 1 for row in full)
    text = (
        f"the printed ones follow from (5.6), 2n³/3 for each matrix of n unknowns: {n} of {OUTSIDE} and {m} of "
        f"{INSIDE} make {number(round(count_operations(n, OUTSIDE) + count_operations(m, INSIDE)))}, "
        f"{whole['iterations']} of {WHOLE} make {number(round(count_operations(whole['iterations'], WHOLE)))} (printed "
        f"{number(whole['operations'])}). So they do here for {agree} of the {len(full)} monolithic settings that "
        "factorize the whole matrix"
    )
    if agree < len(full):
        text += "; in the others the line search factorizes besides, to judge a step by the one that would follow"
    return (
        f"{text}. Analytic with line search, the two forces of each line are eliminated first, which leaves a matrix "
        f"of {OUTSIDE}. The nested rows count the outer matrices only: a line solves for its own two forces by itself."
    )


def _eliminates(row) -> bool:
    """Return whether a setting factorizes the Schur complement of the forces, not the matrix of all unknowns."""
    return (row["jacobian"], row["globalisation"]) == ("analytic", "line-search")


def _residuals(rows, printed, nested) -> str:
    norms = [p["residual_norm"] for p in printed if p["method"] == "monolithic"]
    good = solved(rows)
    return (
        f"the printed norms, {number(min(norms))} to {number(max(norms))} monolithic, {nested['residual_norm']:g} with "
        f"the outer and {number(nested['inner_residual_norm'])} with the inner count nested, have no unit. Measured is "
        "the greatest unbalanced force over the greatest force; the last step often takes it far below the tolerance, "
        f"to at most {_most(good, 'residual_norm')} where a setting succeeds. The horizontal forces then differ from a "
        f"40-digit solution by at most {_most(good, 'error')}, relative."
    )


def _most(rows, key: str) -> str:
    return number(max((row[key] for row in rows), default=None), 2)


def _units(rows) -> str:
    conditions = []
    for units in dict.fromkeys(r["units"] for r in rows if r["units"]):
        mine = [r for r in rows if r["units"] == units]
        name = "scaled" if units == "scaled" else f"in {units}"
        conditions.append(f"{across(r['condition_number'] for r in mine)} {name} ({_share(mine)} succeed)")
    return f"the condition number of the Jacobian at the solution is {', '.join(conditions)}."


def _success(rows) -> str:
    failed = [row for row in rows if row["status"] != "SUCCESS"]
    none = [row for row in rows if row["start"] == "none"]
    text = f"without any start {_share(none)} succeed, in {_between(r['iterations'] for r in none)} iterations."
    if failed:
        kinds = dict.fromkeys(f"forces in {row['units']}" if row["units"] else row["method"] for row in failed)
        text += (
            f" The {plural(len(failed), 'failure')} ({', '.join(kinds)}) are reported as such, not as answers; "
            "solve_network by default continues from there with a more robust method."
        )
    return text


def _between(values) -> str:
    """Return such as "6 to 26"."""
    values = sorted(values)
    if not values:
        return "no"
    return f"{values[0]}" if values[0] == values[-1] else f"{values[0]} to {values[-1]}"


def speed(rows: list[dict]) -> str:
    """Return the comparison of monolithic analytic with nested with differences."""
    small = [row for row in rows if row["system"].startswith("two lines")]
    chains = sorted((row for row in rows if row not in small), key=lambda row: row["elements"])
    sentences = [
        "Both methods take turns in one process, each by itself without a fallback; the ratio of CPU times is the "
        "median over the turns, with its 5 and 95 percentiles."
    ]
    if small:
        ratios = " and ".join(f"{ratio(row['ratio'])} ({row['system'].split(', ')[-1]})" for row in small)
        sentences.append(
            f"On the two lines, from the sound start, nested with differences takes {ratios} times as long as "
            f"monolithic analytic; {_wanted(WANTED_METHODS, [r['ratio'] for r in small])}."
        )
    if chains:
        first, last = chains[0], chains[-1]
        sentences.append(
            f"On a chain of {first['elements']} whose end moves by 1 % the ratio is {ratio(first['ratio'])}, on one of "
            f"{last['elements']} it is {ratio(last['ratio'])}."
        )
    failed = sum(row[f"{name}_status"] != "SUCCESS" for row in rows for name in ("monolithic", "nested_differences"))
    if failed:
        sentences.append(f"{plural(failed, 'solve')} did not converge; the table says which.")
    return " ".join(sentences)


def _wanted(bound: float, values: list[float]) -> str:
    """Return the bound, and in how many of the values it is reached."""
    reached = sum(value >= bound for value in values)
    return f"wanted was at least {bound}, reached in {reached} of {len(values)}"


def peers(rows: list[dict], names: dict) -> str:
    """Return the comparison with MoorPy on the same systems, faster or slower."""
    sentences = [
        "The vessel goes out by 1 m and back, and each code solves again from its own last state, in turns; seabed "
        "friction is off, since MoorPy leaves it out for a whole system. MoorPy's tolerance is a distance: its "
        "default, and a tight one. The ratios are MoorPy's time over this project's."
    ]
    for system in dict.fromkeys(row["system"] for row in rows):
        mine = [row for row in rows if row["system"] == system]
        sentences.append(f"{names.get(system, system).capitalize()}: {'; '.join(_peer(row) for row in mine)}.")
        if all(max(row["ratio"], row["ratio_back"]) < 1 for row in mine):
            sentences.append("This project is the slower one here.")
        if system == "three_bridles":
            both = [row[key] for row in mine for key in ("ratio", "ratio_back")]
            sentences.append(f"Here {_wanted(WANTED_PEER, both)}.")
    if any(row["our_iterations"] == 0 for row in rows):
        sentences.append(
            "Where the table counts no iterations no node is free, and a solve is one evaluation of each line."
        )
    return " ".join(sentences)


def _peer(row) -> str:
    return f"{times(row['ratio'])} out and {times(row['ratio_back'])} back at the {row['setting']} tolerance"
