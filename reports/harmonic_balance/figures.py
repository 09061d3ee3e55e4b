"""The figures on harmonic balance: those of the HB paper remade, spectra, envelopes, limits. Captions from the data."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.ticker import MaxNLocator

from ..cable.figures import KN, LOOKS, METHODS, decades, legend, metres, panel, save, sizes
from ..drawing import style
from ..evidence.published import stated
from ..page.formatting import MINUS, across, number, plural, seconds

VARIANTS = {"paper": "as the paper", "paper, constant kept": "constant kept", "default": "default of this project"}
DROPPED = {"dropped": "paper", "kept": "default"}
FIELDS = {"eps": "strain, ‰", "u": "u, m/s", "v": "v, m/s", "w": "w, m/s", "phi": "φ, rad", "theta": "θ, rad"}
PAPER_FIGURES = {"case_1": 6, "case_2": 7, "case_3": 8, "case_4": 9}
SMALL, LARGE = (stated(f"{which} amplitude of the convergence study") for which in ("least", "largest"))
TOLERANCE = stated("tolerance")
LEAST_SHOWN = 1e-4  # kN: of a spectrum
LEAST = 1e-17  # a Newton step below this is drawn here


def newton(rows: list[dict], folder: Path) -> style.Group:
    """HB Fig. 3: error of every Newton step; a row of panels an amplitude."""
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
        line[0].set_ylabel(f"{metres(case)}: error (76)")
    decades(grid[0, 0], "y", 5)
    legend(figure, grid[0, 1], 4, title="harmonics, samples")
    title = "HB Fig. 3: error of every Newton step"
    drawn = save(
        figure, folder, "newton", title, f"{title}, logarithmic, for {SMALL} m and {LARGE} m and three variants."
    )
    return style.Group(_newton_caption(rows), [drawn])


def _choice(row) -> str:
    return f"{row['harmonics']}, {row['samples']}"


def _of(rows, case: str, variant: str) -> list[dict]:
    return [row for row in rows if (row["case"], row["variant"]) == (case, variant)]


def _newton_caption(rows) -> str:
    small = [row for row in rows if row["case"] == "case_1"]
    direct = [row["iterations"] for row in small if row["variant"] != "default"]
    ours = [row["iterations"] for row in small if row["variant"] == "default"]
    said = [
        f"HB Fig. 3 remade. At {SMALL} m every choice converges from zero to {TOLERANCE} (dashed): the paper's "
        "relaxation takes "
        f"{_steps(direct)} steps, the default {_steps(ours)}, most of them with an old Jacobian, and starts with a few "
        "harmonics first, whose steps are not drawn."
    ]
    large = [row for row in rows if row["case"] == "case_1_large" and row["variant"] != "default"]
    raised = [row for row in large if row["iterations"] > len(row["errors"])]
    if raised:
        said.append(
            f"At {LARGE} m the paper shows convergence within {stated('most Newton steps')} steps; with its "
            f"relaxation alone {len(raised)} of "
            f"{plural(len(large), 'choice')} did not converge from zero, and the amplitude was raised in steps, of "
            "which "
            f"the last solve is drawn: {'; '.join(map(_raised, raised))}."
        )
    slack = [row for row in rows if row["status"] == "COMPRESSION"]
    if slack:
        said.append(
            f"{plural(len(slack), 'response')} of {len(rows)} hold compression somewhere, which their status says."
        )
    return " ".join(said)


def _raised(row) -> str:
    kept = "without constant" if row["variant"] == "paper" else "with constant"
    end = "" if row["reached"] == 1.0 else f", given up at {number(row['reached'], 3)} of it"
    return f"{row['harmonics']} harmonics {kept} {row['iterations']} steps in all{end}"


def _steps(values) -> str:
    low, high = min(values), max(values)
    return f"{low}" if low == high else f"{low} to {high}"


def tension(rows: list[dict], folder: Path) -> style.Group:
    """HB Fig. 4: fairlead tension over a period by (Nh, Nt)."""
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
        axes.set(title=f"{metres(case)}, {variant}", xlabel="time, s")
        lows[case, variant] = [min(row["tension"]) * KN for row in mine if row["reached"] == 1.0]
    for line in grid:
        line[0].set_ylabel("fairlead tension, kN")
    legend(figure, grid[0, 0], 4, title="harmonics, samples")
    title = "HB Fig. 4: fairlead tension over a period"
    drawn = save(
        figure, folder, "tension", title, f"{title} for {SMALL} m and {LARGE} m, with and without the constant term."
    )
    dropped, kept = lows["case_1_large", "dropped"], lows["case_1_large", "kept"]
    caption = (
        f"HB Fig. 4 remade, the constant term dropped and kept. At {LARGE} m the least fairlead tension is "
        f"{_signed(dropped)} kN without the constant term and "
        f"{_signed(kept)} kN with it, by number of harmonics: the zero tension that the paper shows comes from the "
        "dropped term."
    )
    return style.Group(caption, [drawn])


def _signed(values, digits: int = 3) -> str:
    return ", ".join(number(value, digits).replace("-", MINUS) for value in values)


def _period(values, period: float = 20.0):
    """Times of equally spaced values of the paper's period, s."""
    return period * np.arange(len(values)) / len(values)


def states(data: dict, folder: Path) -> list[tuple[str, style.Group]]:
    """HB Figs. 6 to 9: fairlead tension and the state at one node, a wide figure a case; (heading, group)."""
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
    legend(figure, flat[0])
    title = f"HB Fig. {PAPER_FIGURES[case]}: {metres(case)}"
    drawn = save(figure, folder, f"state_{case}", title, f"{title}: fairlead tension and state at node {data['node']}.")
    apart = np.ptp(stepped["tension"])
    difference = np.sqrt(np.mean((np.array(stepped["tension"]) - balanced["tension"]) ** 2)) / apart
    caption = (
        f"HB Fig. {PAPER_FIGURES[case]} remade: fairlead tension, and the state at node {data['node']} "
        f"(s = {number(data['s'], 4)} m). Lines: third period of the time domain; circles: harmonic balance. The "
        "tensions "
        f"differ by {number(difference, 2)} of the range (rms), each from the converged one by "
        f"{number(stepped['rms'], 2)} and {number(balanced['rms'], 2)}."
    )
    return style.Group(caption, [drawn], f"hb-fig{PAPER_FIGURES[case]}")


def constant(rows: list[dict], cases: dict | None, folder: Path) -> style.Group:
    """Fairlead tension with and without the constant term, with the reference and the time domain where known."""
    figures = []
    for case in dict.fromkeys(row["case"] for row in rows):
        mine = [row for row in rows if row["case"] == case]
        most = max(row["harmonics"] for row in mine if not row["mean"])
        title = f"{metres(case)}, {most} harmonics"
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
        legend(figure, axes)
        figures.append(save(figure, folder, f"constant_{case}", title, f"{title}: with and without the constant term."))
    return style.Group(_constant_caption(rows), figures)


def _constant_caption(rows) -> str:
    said = []
    for case in dict.fromkeys(row["case"] for row in rows):
        both = [row for row in rows if row["case"] == case]
        most = max(row["harmonics"] for row in both if not row["mean"])
        kept, dropped = (
            next(r for r in both if r["mean"] == mean and r["harmonics"] == most) for mean in (True, False)
        )
        said.append(
            f"{metres(case)}: mean {number((kept['average'] - dropped['average']) * KN, 3)} kN higher with the "
            "constant "
            f"term, least fairlead tension {_signed([kept['min'] * KN, dropped['min'] * KN], 4)} kN, "
            f"rms error {number(kept['rms'], 2)} and {number(dropped['rms'], 2)} of the range"
        )
    text = f"With and without the constant term: {'; '.join(said)}."
    sway = next((row for row in rows if row["case"] == "case_3" and row["mean"]), None)
    if sway:
        text += (
            " In sway the whole signal is so small that the error of the mesh in the mean tension outweighs the "
            "dropped "
            "term; beside the time domain on the same mesh (HB Fig. 8) the shift that the paper leaves unexplained is "
            "the constant."
        )
    return text


def needed(data: dict, folder: Path) -> style.Group:
    """Error against number of harmonics."""
    title = "Error in the number of harmonics alone"
    figure, axes = panel(title, "harmonics Nh", "rms error over the range", xscale="log", yscale="log")
    for row, look in zip(data["summary"], LOOKS, strict=False):
        mine = [r for r in data["rows"] if r["case"] == row["case"]]
        axes.plot(
            [r["harmonics"] for r in mine], [r["rms"] for r in mine], label=metres(row["case"]), linewidth=1, **look
        )
    ticks = sorted({r["harmonics"] for r in data["rows"]})
    decades(axes, "y")
    sizes(axes, ticks)
    legend(figure, axes)
    drawn = save(figure, folder, "needed", title, "Error by number of harmonics, both logarithmic, four cases.")
    rates = across(row["rate"] for row in data["summary"])
    level = "0.001"
    need = {row["case"]: row[level] for row in data["summary"]}
    said = ", ".join(f"{metres(case)} {most or 'more than tried'}" for case, most in need.items())
    caption = (
        f"Against {data['most']} harmonics on the same {data['nodes']} nodes. The drag |v|v has a kink, so the decay "
        "is "
        f"algebraic, with exponents {rates} here, and slower where the axial mode answers, near harmonic "
        f"{number(data['axial'])}. "
        f"Harmonics for an rms error of {level} of the range: {said}. The last case moves with the second harmonic, so "
        "that "
        "its harmonics count half."
    )
    return style.Group(caption, [drawn])


def spectra(rows: list[dict], folder: Path) -> style.Group:
    """Amplitude of the harmonics of the fairlead tension."""
    figure, grid = plt.subplots(1, len(rows), figsize=(style.WIDE[0], 3.2), sharey=True)
    for axes, row in zip(grid, rows, strict=True):
        amplitudes = np.array(row["amplitudes"][1:]) * KN
        k = np.arange(1, len(amplitudes) + 1)
        some = amplitudes > 1e-9 * amplitudes.max()  # those that a symmetry leaves
        axes.vlines(k[some], LEAST_SHOWN, amplitudes[some], color=style.PALETTE[0], linewidth=1.2)
        axes.plot(k[some], amplitudes[some], "o", color=style.PALETTE[0], markersize=3)
        axes.set(title=metres(row["case"]), xlabel="harmonic", yscale="log", ylim=(LEAST_SHOWN, 2e3))
    decades(grid[0], "y")
    grid[0].set_ylabel("amplitude, kN")
    title = "Harmonics of the fairlead tension"
    figures = [save(figure, folder, "spectra", title, f"{title}, logarithmic, a panel a case.")]
    told = []
    for row in rows:
        a = np.array(row["amplitudes"][1:]) * KN
        late = a[19:] if len(a) > 20 else a[-1:]
        told.append(
            f"{metres(row['case'])} {number(late.max(), 2)} kN at harmonic "
            f"{len(a) - len(late) + int(late.argmax()) + 1}"
        )
    caption = (
        "Harmonics of the fairlead tension. Out-of-plane motion of a planar line makes even ones only. The greatest "
        "late "
        f"harmonic: {'; '.join(told)}; the axial mode of the line lies at {number(rows[0]['axial'])} times the "
        "frequency."
    )
    return style.Group(caption, figures)


def envelope(rows: list[dict], folder: Path) -> style.Group:
    """Least, mean and greatest tension along the line."""
    figure, grid = plt.subplots(1, len(rows), figsize=(style.WIDE[0], 3.4), sharey=True)
    for axes, row in zip(grid, rows, strict=True):
        s = np.array(row["s"])
        low, high, mean, rest = (np.array(row[key]) * KN for key in ("min", "max", "mean", "rest"))
        axes.fill_between(s, low, high, color=style.PALETTE[0], alpha=0.25, linewidth=0)
        axes.plot(s, mean, color=style.PALETTE[0], linewidth=1.4, label="mean")
        axes.plot(s, rest, "--", color=style.INK, linewidth=1, label="at rest")
        axes.plot(s[row["node"] - 1], row["least"] * KN, "v", color=style.WRONG, label="least")
        axes.set(title=metres(row["case"]), xlabel="s, m", xticks=(0, 400, 800))
        axes.axhline(0, color=style.PALE, linewidth=0.8)
    grid[0].set_ylabel("tension, kN")
    legend(figure, grid[0], 3)
    drawn = save(
        figure, folder, "envelope", "Envelope of the tension", "Least, mean and greatest tension along the line."
    )
    said = "; ".join(
        f"{metres(row['case'])}: {number(row['least'] * KN, 3)} kN at node {row['node']} (s = "
        f"{number(row['s'][row['node'] - 1])} m), {number(row['at'], 3)} s"
        for row in rows
    )
    return style.Group(f"Range of the tension over a period along the line. Nearest to zero: {said}.", [drawn])


def limit(data: dict, folder: Path) -> style.Group:
    """Least tension against amplitude."""
    rows = [row for row in data["rows"] if row["reached"] == 1.0]
    figure, axes = panel("Surge raised until the tension vanishes", "amplitude, m", "least tension over a period, kN")
    x = [row["amplitude"] for row in rows]
    for (key, label), look in zip(
        (("least", "anywhere on the line"), ("fairlead", "at the fairlead")), LOOKS, strict=False
    ):
        axes.plot(x, [row[key] * KN for row in rows], label=label, linewidth=1, **look)
    slack = [row for row in rows if row["status"] != "SUCCESS"]
    axes.plot([r["amplitude"] for r in slack], [r["least"] * KN for r in slack], "x", color=style.WRONG, markersize=10,
              markeredgewidth=2, label="compression")  # fmt: skip
    axes.axhline(0, color=style.PALE, linewidth=1)
    legend(figure, axes, 3)
    drawn = save(figure, folder, "limit", "Vanishing tension", "Least tension by amplitude of the surge.")
    said = []
    if data["vanishes"]:
        first = next(row for row in rows if row["least"] < 0)
        said.append(
            f"The tension vanishes at an amplitude of {number(data['vanishes'], 4)} m, first at node {first['node']} "
            f"(s = {number(first['s'])} m from the anchor), {number(first['at'], 3)} s into the period, not at the "
            "fairlead; "
            "from there on the status says compression."
        )
    failed = [row for row in data["rows"] if row["reached"] < 1.0]
    for row in failed:
        said.append(
            f"At {row['amplitude']:g} m no response was found: the solver gave up at {number(row['reached'], 3)} of "
            "the "
            f"amplitude after {row['iterations']} steps, and its status says so."
        )
    return style.Group(" ".join(said), [drawn])


def growth(data: dict, folder: Path) -> style.Group:
    """Seconds by nodes and by harmonics."""
    figures = []
    for title, xlabel, names in (
        ("Growth with nodes", "nodes N", ("nodes",)),
        ("Growth with harmonics, sway", "harmonics Nh", ("harmonics, direct", "harmonics, iterative")),
    ):
        figure, axes = panel(title, xlabel, "time of one solve, s", xscale="log", yscale="log")
        ticks = set()
        for name, look in zip(names, LOOKS, strict=False):
            mine = [row for row in data["rows"] if row["series"] == name]
            label = name.split(", ")[-1]
            axes.plot([r["size"] for r in mine], [r["seconds"] for r in mine], label=label, linewidth=1, **look)
            ticks |= {r["size"] for r in mine}
        decades(axes, "y")
        sizes(axes, sorted(ticks))
        if len(names) > 1:
            legend(figure, axes)
        figures.append(save(figure, folder, f"growth_{names[0]}", title, f"{title}: time of one solve, logarithmic."))
    p, start = data["exponents"], data["fitted_from"]
    last = max((r for r in data["rows"] if r["series"] == "nodes"), key=lambda r: r["size"])
    caption = (
        f"With {data['harmonics']} harmonics the time grows as N to the power {number(p['nodes'], 3)} (from "
        f"{start['nodes']} nodes on; {seconds(last['seconds'])} for {last['size']}). With {data['nodes']} nodes it "
        "grows "
        f"as Nh to the power {number(p['harmonics, direct'], 3)} with direct blocks and "
        f"{number(p['harmonics, iterative'], 3)} with the iterative solver (from {start['harmonics, direct']} "
        "harmonics on)."
    )
    return style.Group(caption, figures)
