"""The figures of the HB paper remade: 3, 4 and 6 to 9, and the constant term. Captions come from the same data."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.ticker import MaxNLocator

from ..cable.cases import METHODS, motion_of, save
from ..drawing import style
from ..drawing.axes import KN, LOOKS, add_legend, panel, set_decade_ticks
from ..page.figures import Group
from ..page.numbers.formatting import MINUS, number, plural
from ..pipeline.published import printed_value

VARIANTS = {"paper": "as the paper", "paper, constant kept": "constant kept", "default": "default of this project"}
DROPPED = {"dropped": "paper", "kept": "default"}
FIELDS = {"eps": "strain, ‰", "u": "u, m/s", "v": "v, m/s", "w": "w, m/s", "phi": "φ, rad", "theta": "θ, rad"}
PAPER_FIGURES = {"case_1": 6, "case_2": 7, "case_3": 8, "case_4": 9}
SMALL, LARGE = (printed_value(f"{which} amplitude of the convergence study") for which in ("least", "largest"))
TOLERANCE = printed_value("tolerance")
LEAST = 1e-17  # a Newton step below this is drawn here


def newton(rows: list[dict], folder: Path) -> Group:
    """Return HB Fig. 3: error of every Newton step; a row of panels an amplitude."""
    cases = list(dict.fromkeys(row["case"] for row in rows))
    figure, grid = plt.subplots(len(cases), len(VARIANTS), figsize=(style.WIDE[0], 6.2), sharey=True)
    for case, line in zip(cases, grid, strict=True):
        for (variant, words), axes in zip(VARIANTS.items(), line, strict=True):
            for row, look in zip(_of(rows, case, variant), LOOKS, strict=False):
                errors = np.maximum(row["errors"], LEAST)
                axes.plot(range(1, len(errors) + 1), errors, label=_choice(row), linewidth=1, **look)
            axes.axhline(float(TOLERANCE), color=style.PALE, linestyle="--", linewidth=1)
            axes.set(title=words if case == cases[0] else "", xlabel="Newton step", yscale="log")
            axes.xaxis.set_major_locator(MaxNLocator(integer=True))
        line[0].set_ylabel(f"{motion_of(case)}: error (76)")
    set_decade_ticks(grid[0, 0], "y", 5)
    add_legend(figure, grid[0, 1], 4, title="harmonics, samples")
    title = "HB Fig. 3: error of every Newton step"
    drawn = save(
        figure, folder, "newton", title, f"{title}, logarithmic, for {SMALL} m and {LARGE} m and three variants."
    )
    return Group(_newton_caption(rows), [drawn])


def _choice(row) -> str:
    return f"{row['harmonics']}, {row['samples']}"


def _of(rows, case: str, variant: str) -> list[dict]:
    return [row for row in rows if (row["case"], row["variant"]) == (case, variant)]


def _newton_caption(rows) -> str:
    small = [row for row in rows if row["case"] == "case_1"]
    direct = [row["iterations"] for row in small if row["variant"] != "default"]
    ours = [row["iterations"] for row in small if row["variant"] == "default"]
    sentences = [
        f"HB Fig. 3 remade. At {SMALL} m every choice converges from zero to {TOLERANCE} (dashed): the paper's "
        f"relaxation takes {_steps(direct)} steps, the default {_steps(ours)}, most of them with an old Jacobian, and "
        "starts with a few harmonics first, whose steps are not drawn."
    ]
    large = [row for row in rows if row["case"] == "case_1_large" and row["variant"] != "default"]
    raised = [row for row in large if row["iterations"] > len(row["errors"])]
    if raised:
        sentences.append(
            f"At {LARGE} m the paper shows convergence within {printed_value('most Newton steps')} steps; with its "
            f"relaxation alone {len(raised)} of {plural(len(large), 'choice')} did not converge from zero, and the "
            f"amplitude was raised in steps, of which the last solve is drawn: {'; '.join(map(_raised, raised))}."
        )
    slack = [row for row in rows if row["status"] == "COMPRESSION"]
    if slack:
        sentences.append(
            f"{plural(len(slack), 'response')} of {len(rows)} hold compression somewhere, which their status says."
        )
    return " ".join(sentences)


def _raised(row) -> str:
    kept = "without constant" if row["variant"] == "paper" else "with constant"
    end = "" if row["reached"] == 1.0 else f", given up at {number(row['reached'], 3)} of it"
    return f"{row['harmonics']} harmonics {kept} {row['iterations']} steps in all{end}"


def _steps(values) -> str:
    low, high = min(values), max(values)
    return f"{low}" if low == high else f"{low} to {high}"


def tension(rows: list[dict], folder: Path) -> Group:
    """Return HB Fig. 4: fairlead tension over a period by (Nh, Nt)."""
    chosen = [(case, variant) for case in dict.fromkeys(row["case"] for row in rows) for variant in DROPPED]
    cases = len(chosen) // len(DROPPED)
    figure, grid = plt.subplots(cases, len(DROPPED), figsize=(style.WIDE[0], 2.7 * cases), sharey="row", squeeze=False)
    lows = {}
    for (case, variant), axes in zip(chosen, grid.ravel(), strict=True):
        mine = _of(rows, case, DROPPED[variant])
        for row, look in zip(mine, LOOKS, strict=False):
            values = np.array(row["tension"]) * KN
            axes.plot(_period(values), values, label=_choice(row), color=look["color"], linewidth=1.2)
        axes.axhline(0, color=style.PALE, linewidth=1)
        axes.set(title=f"{motion_of(case)}, {variant}", xlabel="time, s")
        lows[case, variant] = [min(row["tension"]) * KN for row in mine if row["reached"] == 1.0]
    for line in grid:
        line[0].set_ylabel("fairlead tension, kN")
    add_legend(figure, grid[0, 0], 4, title="harmonics, samples")
    title = "HB Fig. 4: fairlead tension over a period"
    drawn = save(
        figure, folder, "tension", title, f"{title} for {SMALL} m and {LARGE} m, with and without the constant term."
    )
    dropped, kept = lows["case_1_large", "dropped"], lows["case_1_large", "kept"]
    caption = (
        f"HB Fig. 4 remade, the constant term dropped and kept. At {LARGE} m the least fairlead tension is "
        f"{_signed(dropped)} kN without the constant term and {_signed(kept)} kN with it, by number of harmonics: the "
        "zero tension that the paper shows comes from the dropped term."
    )
    return Group(caption, [drawn])


def _signed(values, digits: int = 3) -> str:
    return ", ".join(number(value, digits).replace("-", MINUS) for value in values)


def _period(values, period: float = 20.0):
    """Return times of equally spaced values of the paper's period, s."""
    return period * np.arange(len(values)) / len(values)


def states(data: dict, folder: Path) -> list[tuple[str, Group]]:
    """Return HB Figs. 6 to 9: fairlead tension and the state at one node, a wide figure a case."""
    return [_state(data, case, folder) for case in PAPER_FIGURES if any(r["case"] == case for r in data["rows"])]


def _state(data: dict, case: str, folder: Path):
    rows = {row["method"]: row for row in data["rows"] if row["case"] == case}
    stepped, balanced = rows["time domain"], rows["harmonic balance"]
    names = list(stepped["fields"])
    columns = 3 if len(names) < 6 else 4
    figure, grid = plt.subplots(2, columns, figsize=(style.WIDE[0], 4.8), sharex=True)
    flat = grid.ravel()
    curves = [("fairlead tension, kN", *(np.array(row["tension"]) * KN for row in (stepped, balanced)))]
    for name in names:
        scale = 1e3 if name == "eps" else 1.0
        curves.append((FIELDS[name], *(scale * np.array(row["fields"][name]) for row in (stepped, balanced))))
    for axes, (label, line, points) in zip(flat, curves, strict=False):
        axes.plot(_period(line), line, color=style.PALETTE[1], linewidth=1.3, label="time domain")
        thin = slice(None, None, 8)
        axes.plot(_period(points)[thin], np.array(points)[thin], "o", color=style.PALETTE[0], markersize=3.5,
                  markerfacecolor="none", label="harmonic balance")  # fmt: skip
        axes.set_ylabel(label)
        axes.ticklabel_format(axis="y", useOffset=False)
        axes.yaxis.set_major_locator(MaxNLocator(5))
    for axes in flat[len(curves) :]:
        axes.set_visible(False)
    for axes in flat[max(0, len(curves) - columns) : len(curves)]:
        axes.set_xlabel("time, s")
        axes.tick_params(labelbottom=True)
    add_legend(figure, flat[0])
    title = f"HB Fig. {PAPER_FIGURES[case]}: {motion_of(case)}"
    drawn = save(figure, folder, f"state_{case}", title, f"{title}: fairlead tension and state at node {data['node']}.")
    apart = np.ptp(stepped["tension"])
    difference = np.sqrt(np.mean((np.array(stepped["tension"]) - balanced["tension"]) ** 2)) / apart
    caption = (
        f"HB Fig. {PAPER_FIGURES[case]} remade: fairlead tension, and the state at node {data['node']} (s = "
        f"{number(data['s'], 4)} m). Lines: third period of the time domain; circles: harmonic balance. The tensions "
        f"differ by {number(difference, 2)} of the range (rms), each from the converged one by "
        f"{number(stepped['rms'], 2)} and {number(balanced['rms'], 2)}."
    )
    return Group(caption, [drawn], f"hb-fig{PAPER_FIGURES[case]}")


def constant(rows: list[dict], cases: dict | None, folder: Path) -> Group:
    """Return the fairlead tension with and without the constant term, the reference and the time domain where known."""
    figures = []
    for case in dict.fromkeys(row["case"] for row in rows):
        mine = [row for row in rows if row["case"] == case]
        most = max(row["harmonics"] for row in mine if not row["mean"])
        title = f"{motion_of(case)}, {most} harmonics"
        figure, axes = panel(title, "time, s", "fairlead tension, kN")
        for row in (cases or {"rows": []})["rows"]:
            if row["case"] == case and row["method"] in ("reference", "time domain"):
                look = {
                    "color": METHODS[row["method"]]["color"],
                    "linewidth": 1.0 if row["method"] == "reference" else 1.6,
                }
                axes.plot(_period(row["tension"]), np.array(row["tension"]) * KN, label=row["method"], **look)
        for row in mine:
            if row["harmonics"] == most:
                label, dash = ("constant kept", "--") if row["mean"] else ("constant dropped", ":")
                colour = style.PALETTE[0] if row["mean"] else style.WRONG
                axes.plot(_period(row["tension"]), np.array(row["tension"]) * KN, dash, color=colour, label=label)
        axes.ticklabel_format(axis="y", useOffset=False)
        add_legend(figure, axes)
        figures.append(save(figure, folder, f"constant_{case}", title, f"{title}: with and without the constant term."))
    return Group(_constant_caption(rows), figures)


def _constant_caption(rows) -> str:
    differences = []
    for case in dict.fromkeys(row["case"] for row in rows):
        both = [row for row in rows if row["case"] == case]
        most = max(row["harmonics"] for row in both if not row["mean"])
        kept, dropped = (
            next(r for r in both if r["mean"] == mean and r["harmonics"] == most) for mean in (True, False)
        )
        differences.append(
            f"{motion_of(case)}: mean {number((kept['average'] - dropped['average']) * KN, 3)} kN higher with the "
            f"constant term, least fairlead tension {_signed([kept['min'] * KN, dropped['min'] * KN], 4)} kN, rms "
            f"error {number(kept['rms'], 2)} and {number(dropped['rms'], 2)} of the range"
        )
    text = f"With and without the constant term: {'; '.join(differences)}."
    sway = next((row for row in rows if row["case"] == "case_3" and row["mean"]), None)
    if sway:
        text += (
            " In sway the whole signal is so small that the error of the mesh in the mean tension outweighs the "
            "dropped term; beside the time domain on the same mesh (HB Fig. 8) the shift that the paper leaves "
            "unexplained is the constant."
        )
    return text
