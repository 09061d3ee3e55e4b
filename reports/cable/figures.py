"""The figures on the moving cable in time. Captions come from the same data."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.ticker import MaxNLocator

from ..drawing import style
from ..drawing.axes import KN, LOOKS, add_legend, draw_growth, draw_order_line, panel, set_decade_ticks
from ..page.figures import Group
from ..page.numbers.formatting import DASH, number, plural, seconds, status_words, times
from ..pipeline.published import printed_value
from .cases import METHODS, motion_of, save


def profile(data: dict, folder: Path) -> Group:
    """Return HB Fig. 2."""
    nodes, exact, fairlead = data["nodes"], data["catenary"], data["fairlead"]
    figures = []
    for key, ylabel, scale, title in (("z", "z, m above the anchor", 1, "Static profile"),
                                      ("tension", "tension, kN", KN, "Static tension")):  # fmt: skip
        along = "x" if key == "z" else "s"
        label = "x, m from the anchor" if key == "z" else "s, m of unstretched line from the anchor"
        figure, axes = panel(title, label, ylabel)
        axes.plot(exact[along], np.array(exact[key]) * scale, color=style.PALETTE[0], label="catenary")
        axes.plot(nodes[along], np.array(nodes[key]) * scale, "o", color=style.PALETTE[1], markersize=3.5,
                  markerfacecolor="none", label=f"box scheme, {len(nodes['s'])} nodes")  # fmt: skip
        add_legend(figure, axes)
        figures.append(save(figure, folder, f"profile_{key}", title, f"{title} of the OC3 line: catenary and nodes."))
    box, shooting, catenary = (fairlead[name] for name in ("box scheme", "shooting", "catenary"))
    caption = (
        f"HB Fig. 2 remade. The nodes lie within {number(1e3 * data['distance'], 2)} mm of the catenary; the fairlead "
        f"tension is {number(box * KN, 6)} kN on {len(nodes['s'])} nodes, {number(catenary * KN, 6)} kN on the "
        f"catenary, and shooting agrees with it to {number(abs(shooting / catenary - 1), 1)}. The moving cable starts "
        "from the nodes, so that it stays at rest when nothing moves it."
    )
    return Group(caption, figures)


def settling(rows: list[dict], folder: Path) -> Group:
    """Return HB Fig. 5, and the distance of each period from the last."""
    figures = []
    for row in rows:
        title = f"From rest, drag coefficient {row['drag']:g}"
        figure, axes = panel(title, "time, s", "fairlead tension, kN")
        axes.plot(row["time"], np.array(row["tension"]) * KN, color=style.PALETTE[0], linewidth=1.2)
        figures.append(save(figure, folder, f"settling_{row['drag']:g}", title, f"{title}: fairlead tension in time."))
    title = "Difference of a period from the last"
    figure, axes = panel(title, "period", "greatest difference over the range", yscale="log")
    for row, look in zip(rows, LOOKS, strict=False):
        away = row["away"][:-1]
        axes.plot(range(1, len(away) + 1), away, label=f"drag coefficient {row['drag']:g}", linewidth=1, **look)
    for level in rows[0]["settled"]:
        axes.axhline(float(level), color=style.PALE, linestyle="--", linewidth=1)
    set_decade_ticks(axes, "y")
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    add_legend(figure, axes)
    figures.append(save(figure, folder, "settling_away", title, f"{title}, logarithmic, for both drag coefficients."))
    first_periods = "; ".join(
        f"drag {row['drag']:g}: "
        + ", ".join(f"{_period(first)} to {float(level):g}" for level, first in row["settled"].items())
        for row in rows
    )
    caption = (
        f"HB Fig. 5 remade: surge of {printed_value('least amplitude of the convergence study')} m that grows in half "
        f"a period. The first period that equals the last: {first_periods} of the range of the tension. The paper "
        f"gives {printed_value('periods to steady state at Cdn 1.6')} periods, and at least "
        f"{printed_value('periods to steady state at Cdn 0.1')} with the small drag."
    )
    return Group(caption, figures)


def _period(first) -> str:
    return "later than computed" if first is None else f"period {first}"


def spacetime(rows: list[dict], folder: Path) -> Group:
    """Return the tension over unstretched length and time."""
    figures, least = [], []
    for row in rows:
        title = motion_of(row["case"])
        figure, axes = plt.subplots(figsize=(style.PANEL[0], 4.2))
        tension = np.array(row["tension"]) * KN
        mesh = axes.pcolormesh(
            row["time"], row["s"], tension, cmap=style.TENSION_COLOURS, shading="gouraud", rasterized=True
        )
        axes.set(title=title, xlabel="time in the period, s", ylabel="s, m of unstretched line from the anchor")
        axes.grid(False)
        axes.plot(row["at"], row["s"][row["node"] - 1], "*", color="white", markeredgecolor=style.INK, markersize=13)
        bar = figure.colorbar(mesh, ax=axes, location="bottom", aspect=35, shrink=0.9)
        bar.set_label("tension, kN")
        alt = (
            f"Map of the tension over time and length, {title}: {number(tension.min())} to {number(tension.max())} kN."
        )
        figures.append(save(figure, folder, f"spacetime_{row['case']}", title, alt))
        least.append(
            f"{title}: {number(row['least'] * KN)} kN at node {row['node']} of {len(row['s'])}, {number(row['at'])} s"
        )
    caption = f"Tension over one period; the star is where it comes nearest to zero. {'; '.join(least)}."
    return Group(caption, figures)


STATIC = {"fairlead": "fairlead tension", "along": "tension along the line", "place": "position of the nodes, m"}
CELL = {"harmonic balance": "harmonic balance", "time domain": "time domain"}
STEP = {"undamped": "no structural damping", "damped": "with structural damping",
        "extrapolated": "the same, against its extrapolation"}  # fmt: skip


def orders(data: dict, folder: Path) -> Group:
    """Return errors against cell and step, with lines of order 2."""
    figures = []
    for name, key, xlabel, ylabel, labels in (
        ("statics", "ds", "cell ds, m", "error against the catenary", STATIC),
        ("cell", "ds", "cell ds, m", "rms error over the range", CELL),
        ("step", "dt", "step dt, s", "rms error over the range", STEP),
    ):
        title = {"statics": "Statics in ds", "cell": "Dynamics in ds", "step": "Time domain in dt"}[name]
        figure, axes = panel(title, xlabel, ylabel, xscale="log", yscale="log")
        rows = data[name]["rows"]
        for (column, label), look in zip(labels.items(), LOOKS, strict=False):
            used = rows if name == "statics" or "damped" in column else rows[:-1]  # the last row serves as the limit
            axes.plot([r[key] for r in used], [r[column] for r in used], label=label, linewidth=1, **look)
        least = min(min(r[c] for c in labels) for r in rows[:-1])
        draw_order_line(axes, [r[key] for r in rows[:-1]], least)
        set_decade_ticks(axes)
        add_legend(figure, axes, 2 if name != "step" else 1)
        figures.append(save(figure, folder, f"orders_{name}", title, f"{title}: errors, logarithmic, near order 2."))
    return Group(_orders_caption(data), figures)


def _orders_caption(data: dict) -> str:
    last = {key: number(values[-1], 5) for key, values in data["statics"]["orders"].items()}
    cell = {
        key: number(values[-2], 4) for key, values in data["cell"]["orders"].items()
    }  # the last order is 2 by construction
    step = data["step"]
    finest = step["rows"][-1]
    return (
        f"Observed orders on the finest pair: statics {last['fairlead']} (fairlead tension), {last['along']} (tension "
        f"along the line), {last['place']} (positions). In the cell, against the extrapolation in N, the pair before "
        f"the finest: harmonic balance {cell['harmonic balance']}, time domain {cell['time domain']}. In the step the "
        f"same orbit is known from harmonic balance ({step['harmonics']} harmonics, {step['nodes']} nodes): at dt = "
        f"{number(finest['dt'])} s both differ by {number(finest['damped'], 2)} of the range. Without structural "
        f"damping the axial mode, at {number(step['axial'])} times the driving frequency, rings and masks the order "
        f"until dt resolves it; with {step['damping']:g} s of it the order is "
        f"{DASH.join(_ends(step['orders']['extrapolated'][:-1]))} against the extrapolation."
    )


def _ends(values) -> tuple[str, ...]:
    low, high = number(min(values), 3), number(max(values), 3)
    return (low,) if low == high else (low, high)


def drift(rows: list[dict], folder: Path) -> Group:
    """Return the distance of the fairlead from its prescribed position by period."""
    figure, axes = panel("Drift of the fairlead", "periods", "distance from the prescribed position, m", yscale="log")
    for row, look in zip(rows, LOOKS, strict=False):
        name = motion_of(row["case"])
        distance = np.maximum(row["drift"][1:], 1e-12)
        axes.plot(row["period"][1:], distance, label=f"{name}, {_control(row)}", linewidth=1, markevery=0.1, **look)
    set_decade_ticks(axes, "y")
    add_legend(figure, axes)
    drawn = save(
        figure,
        folder,
        "drift",
        "Drift of the fairlead",
        "Drift by period, logarithmic, with and without drift control.",
    )
    distances = "; ".join(
        f"{motion_of(row['case'])}, {_control(row)}: {number(1e3 * row['drift'][-1], 2)} mm"
        + ("" if row["status"] == "SUCCESS" else f" ({status_words(row['status'])})")
        for row in rows
    )
    periods = len(rows[0]["period"]) - 1
    controlled = [row for row in rows if row["hold"] and "within" in row]
    within = " and ".join(f"{number(1e3 * row['within'], 2)} mm ({motion_of(row['case'])})" for row in controlled)
    caption = (
        f"After {plural(periods, 'period')} with dt = {rows[0]['dt']:g} s: {distances}. The boundary rows prescribe "
        "only the velocity of the fairlead, and the paper accepts the drift that follows; here drift control adds a "
        "small velocity at every step that returns the fairlead to its prescribed position."
    )
    if within:
        caption += f" Within the last period the controlled fairlead is up to {within} away; this does not accumulate."
    return Group(caption, [drawn])


def _control(row: dict) -> str:
    return "with control" if row["hold"] else "without"


def growth(data: dict, folder: Path) -> Group:
    """Return the seconds of one period by nodes."""
    rows, p = data["rows"], data["exponent"]
    figure = draw_growth("Time stepping, growth with nodes", "nodes N", rows, "nodes", METHODS["time domain"])
    drawn = save(figure, folder, "growth_time", "Growth with nodes", "Time of one period by nodes, logarithmic.")
    first, last = rows[0], rows[-1]
    caption = (
        f"{seconds(first['seconds'])} for {first['nodes']} nodes, {seconds(last['seconds'])} for {last['nodes']}: "
        f"nodes to the power {number(p, 2)} from {data['fitted_from']} nodes on. Below a thousand nodes the calls of a "
        f"step weigh more than its arithmetic; {times(last['nodes'] / first['nodes'])} the nodes cost "
        f"{times(last['seconds'] / first['seconds'])} the time."
    )
    return Group(caption, [drawn])
