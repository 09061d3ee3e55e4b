"""The paragraphs on networks of lines: every number in them comes from networks.json."""

from __future__ import annotations

from .words import DASH, across, number, plural, ratio, times

PRINTED_WEIGHT = 226.61
"""N/m, as MSQS prints it; reference_data/errata.toml says why it is not the weight that its results were made with."""

WANTED_METHODS = 10  # nested with differences over monolithic analytic, two lines: set before anything was measured
WANTED_PEER = 20  # MoorPy over this project, warm re-solve of the bridle system: likewise
INSIDE, OUTSIDE, WHOLE = 4, 3, 7
"""Sizes of matrices in (5.6): (H, V) of both lines, the position of the joint, all of them."""


def counted(iterations: int, unknowns: int) -> float:
    """Operations of dense factorizations, (5.6)."""
    return iterations * 2 / 3 * unknowns**3


def solved(rows: list[dict]) -> list[dict]:
    """The rows that ended in success."""
    return [row for row in rows if row["status"] == "SUCCESS"]


def reproduction(rows: list[dict], printed: list[dict]) -> list[str]:
    """Two paragraphs: what of the printed table comes out again and what does not and why; what was found besides."""
    nested = next(row for row in printed if row["method"] == "nested")
    whole = next(row for row in printed if row["method"] == "monolithic")
    mine = [row for row in rows if row["start"] != "none"]
    first = (_weight(rows), _start(mine), _counts(mine, nested, whole), _operations(mine, nested, whole))
    second = (_residuals(mine, printed), _units(mine), _failed(mine), _no_start(rows))
    return [" ".join(filter(None, paragraph)) for paragraph in (first, second)]


def _weight(rows) -> str:
    other = [w for w in dict.fromkeys(row["weight"] for row in rows) if w != PRINTED_WEIGHT]
    return (
        f"The weight that the paper prints, {PRINTED_WEIGHT:g} N/m, is a misprint: its printed forces follow from "
        f"{' and '.join(f'{w:g}' for w in other)} N/m (see the misprints below). Both are shown."
    )


def _start(rows) -> str:
    said = []
    for start in ("printed", "sound"):
        mine = [row for row in rows if row["start"] == start]
        said.append(f"from the {start} start {len(solved(mine))} of {len(mine)} settings succeed")
    return (
        "Its printed start has vertical forces a decimal place too large beside the horizontal ones; the sound start "
        f"has those of the formula that it came from: {', '.join(said)}. The nested method uses the place of the joint "
        "alone, so both starts are one to it."
    )


def _counts(rows, nested, whole) -> str:
    outer, together = ([r for r in solved(rows) if r["method"] == name] for name in ("nested", "monolithic"))
    same = sum(r["iterations"] == whole["iterations"] for r in together)
    inner = [r["inner_iterations"] for r in outer if r.get("inner_iterations") is not None]
    return (
        f"The printed {nested['iterations']} outer and {nested['inner_iterations']} inner iterations of the nested "
        f"method do not come out: among other differences, where the paper has Levenberg{DASH}Marquardt, the outer "
        f"method here is a regularised "
        f"Newton method with a line search; it takes {_between(r['iterations'] for r in outer)} iterations"
        f"{f' and {_between(inner)} inner ones' if inner else ''}. "
        f"Of {len(together)} monolithic settings that succeed, {same} "
        f"take the printed {whole['iterations']} iterations, all {_between(r['iterations'] for r in together)}."
    )


def _operations(rows, nested, whole) -> str:
    n, m = nested["iterations"], nested["inner_iterations"]
    full, small = ([r for r in rows if r["method"] == "monolithic" and _is_whole(r) == is_whole] for is_whole in (1, 0))
    agree = sum(abs(r["operations"] - counted(r["iterations"], WHOLE)) < 1 for r in full)
    text = (
        f"The printed operations follow from (5.6), 2n³/3 for each matrix of n unknowns: {n} of {OUTSIDE} and {m} of "
        f"{INSIDE} make {number(round(counted(n, OUTSIDE) + counted(m, INSIDE)))} (printed "
        f"{number(nested['operations'])}), {whole['iterations']} of {WHOLE} make "
        f"{number(counted(whole['iterations'], WHOLE), 5)} (printed {number(whole['operations'])}). "
        f"So they do here for {agree} of the {len(full)} monolithic settings that factorize the whole matrix."
    )
    if small:
        text += (
            f" The other {len(small)} eliminate the forces of each line first and factorize a matrix of {OUTSIDE}; "
            "the nested rows count the outer matrices only, since a line solves for its own two forces by itself."
        )
    return text


def _is_whole(row) -> bool:
    """Whether a matrix of all unknowns is factorized in each iteration, not the Schur complement."""
    return row["operations"] > counted(row["iterations"], OUTSIDE) + 1


def _residuals(rows, printed) -> str:
    norms, good = [p["residual_norm"] for p in printed], solved(rows)
    return (
        f"The printed residual norms, {number(min(norms))} to {number(max(norms))}, have no unit; those measured are "
        f"the greatest unbalanced force over the greatest force, at most {_most(good, 'residual_norm')} where a "
        f"setting succeeds. The horizontal forces then differ from a 40-digit solution by at most "
        f"{_most(good, 'error')}, relative."
    )


def _most(rows, key: str) -> str:
    return number(max((row[key] for row in rows), default=None), 2)


def _units(rows) -> str:
    said = []
    for units in dict.fromkeys(r["units"] for r in rows if r["units"]):
        mine = [r for r in rows if r["units"] == units]
        condition = across(r["condition_number"] for r in mine)
        name = "scaled" if units == "scaled" else f"in {units}"
        said.append(f"{name} {condition}, {len(solved(mine))} of {len(mine)} settings succeed")
    return f"Units matter: the condition number of the Jacobian at the solution is {'; '.join(said)}."


def _failed(rows) -> str:
    failed = len(rows) - len(solved(rows))
    return failed and (
        f"The {failed} that fail are reported as such; the table shows each method by itself, whereas "
        "solve_network by default goes on to a sturdier one."
    )


def _no_start(rows) -> str:
    mine = [r for r in rows if r["start"] == "none"]
    return mine and (
        f"Without any start {len(solved(mine))} of {len(mine)} settings succeed, in "
        f"{_between(r['iterations'] for r in mine)} iterations, those that find a start included."
    )


def _between(values) -> str:
    """ "6 to 26"."""
    values = sorted(values)
    if not values:
        return "no"
    return f"{values[0]}" if values[0] == values[-1] else f"{values[0]} to {values[-1]}"


def speed(rows: list[dict]) -> str:
    """Monolithic analytic against nested with differences."""
    small = [row for row in rows if row["system"].startswith("two lines")]
    chains = sorted((row for row in rows if row not in small), key=lambda row: row["elements"])
    said = [
        "Both methods take turns in one process, each by itself without a fallback; the ratio is the median over the "
        "turns, with its 5 and 95 percentiles."
    ]
    if small:
        shown = " and ".join(f"{ratio(row['ratio'])} ({row['system'].split(', ')[-1]})" for row in small)
        said.append(
            "On the two lines, from the sound start, nested with differences takes "
            f"{shown} times as long as monolithic analytic; {_wanted(WANTED_METHODS, [r['ratio'] for r in small])}."
        )
    if chains:
        first, last = chains[0], chains[-1]
        said.append(
            f"On a chain of {first['elements']} whose end moves by 1 % the ratio is {ratio(first['ratio'])}, on one of "
            f"{last['elements']} it is {ratio(last['ratio'])}."
        )
    failed = sum(row[f"{name}_status"] != "SUCCESS" for row in rows for name in ("monolithic", "nested_differences"))
    if failed:
        said.append(f"{plural(failed, 'solve')} did not converge; the table says which.")
    return " ".join(said)


def _wanted(bound: float, values: list[float]) -> str:
    """The bound, and in how many of the values it is reached."""
    reached = sum(value >= bound for value in values)
    return f"wanted was at least {bound}, reached in {reached} of {len(values)}"


def peers(rows: list[dict], names: dict) -> str:
    """MoorPy on the same systems, faster or slower."""
    said = [
        "The vessel goes out by 1 m and back, and each code solves again from its own last state, in turns; seabed "
        "friction is off, since MoorPy leaves it out for a whole system. MoorPy's tolerance is a distance: its "
        "default, and a tight one. The ratios are MoorPy's time over this project's."
    ]
    for system in dict.fromkeys(row["system"] for row in rows):
        mine = [row for row in rows if row["system"] == system]
        said.append(f"{names.get(system, system).capitalize()}: {'; '.join(_peer(row) for row in mine)}.")
        if all(max(row["ratio"], row["ratio_back"]) < 1 for row in mine):
            said.append("This project is the slower one here.")
        if system == "three_bridles":
            both = [row[key] for row in mine for key in ("ratio", "ratio_back")]
            said.append(f"Here {_wanted(WANTED_PEER, both)}.")
    if any(row["our_iterations"] == 0 for row in rows):
        said.append("Where the table counts no iterations no node is free, and a solve is one evaluation of each line.")
    return " ".join(said)


def _peer(row) -> str:
    return f"{times(row['ratio'])} out and {times(row['ratio_back'])} back at the {row['setting']} tolerance"
