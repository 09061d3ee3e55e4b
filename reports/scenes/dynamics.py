"""The moving line of a scene on the page: what to set, what error it makes, and how the tension runs."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np

from ..cable.cases import METHODS
from ..drawing import style
from ..drawing.axes import KN, add_legend, panel, set_decade_ticks
from ..page.figures import Figure, Group
from ..page.numbers.analysis import pareto_front
from ..page.numbers.formatting import DASH, number, plural, seconds, slug, status_words
from ..page.numbers.tables import Table
from .animation import animate, caption
from .networks import tables as network_tables
from .networks.figures import enlargement
from .networks.settings import STAR, mark_best, what_would_meet

OWN = ("harmonic balance", "harmonic balance, corrected", "time domain")
NO_TENSION = {"REFUSED": "refused", "UNSUPPORTED": "not applicable"}
"""Status of another code that gives no tension -> words."""


def build(scene: dict, stem: str, figure_folder: Path, table_folder: Path) -> dict | None:
    """Return what dynamics.html.j2 shows; None for a scene at rest."""
    dynamics = scene.get("dynamics")
    if dynamics is None or "failed" in dynamics:
        return dynamics
    name = f"scene_{slug(stem)}_dynamics"
    solved = dynamics.get("waveform") is not None
    figures = [_work(dynamics, name, figure_folder)]
    if solved:
        figures += [
            _waveform(dynamics, name, figure_folder),
            _spectrum(dynamics, name, figure_folder),
            _envelope(dynamics, name, figure_folder),
        ]
    tables = [network_tables.lines(dynamics, name)] if "motion" in dynamics else []
    tables += [_settings(dynamics, name), _statics(dynamics, name)]
    return {
        "sentence": describe_setting_to_use(dynamics),
        "views": _views(scene, dynamics),
        "facts": _facts(dynamics),
        "python": dynamics["python"] and dynamics["python"].replace("FILE", scene["file"]),
        "warnings": dynamics["warnings"],
        "figures": Group(_caption(dynamics), figures),
        "tables": [table.write(table_folder) for table in tables],
    }


def _views(scene: dict, dynamics: dict) -> dict | None:
    """Return drawings of the line that moves, and their caption; None where nothing is known of it."""
    poses = dynamics.get("poses")
    if poses is None:
        return None
    factor = enlargement(poses)
    drawn = animate(poses, scene["name"], dynamics["period"], factor, scene.get("seabed"))
    return {"drawn": drawn, "caption": caption(dynamics["period"], factor, "A period")}


def _setting(row: dict) -> str:
    """Return a setting in words."""
    if row["method"] != "time domain":
        how = " and a deferred correction" if row["method"].endswith("corrected") else ""
        return f"harmonic balance with {row['nodes']} nodes, {plural(row['harmonics'], 'harmonic')}{how}"
    return f"time stepping with {row['nodes']} nodes and dt = {number(row['dt'])} s"


def describe_setting_to_use(dynamics: dict) -> str:
    """Return the setting to use, what it costs and which error it promises; else what would meet the tolerance."""
    best = dynamics["recommended"]
    if best is None:
        return "No setting solved this line: the table says how each failed."
    cost = f"{seconds(best['seconds'])} here, expected error {number(best['promised'], 2)} of the greatest tension"
    tolerance = number(dynamics["tolerance"], 1)
    if best["meets"]:
        return f"Use {_setting(best)}: {cost}, within the tolerance of {tolerance}.{_cheaper(dynamics, best)}"
    would = what_would_meet(best, dynamics["tolerance"], dynamics["reference"]["uncertainty"], "nodes")
    return f"No setting meets the tolerance of {tolerance}. The most accurate is {_setting(best)}: {cost}. {would}"


def _cheaper(dynamics: dict, best: dict) -> str:
    """Return the other codes that meet the tolerance in less time than the recommended setting of this project."""
    within = dynamics["tolerance"] - dynamics["reference"]["uncertainty"]
    rows = [row for row in dynamics["ladder"] if row["method"] not in OWN and row["seconds"] < best["seconds"]]
    names = ", ".join(dict.fromkeys(r["method"] for r in rows if r["error"] is not None and r["error"] <= within))
    if not names:
        return ""
    return f" It is the cheapest of this project; cheaper still within the tolerance: {names}."


def _facts(dynamics: dict) -> list[str]:
    """Return extremes, reference and natural frequencies, one sentence each."""
    sentences = []
    if dynamics.get("extremes"):
        low, mean, high = (number(KN * dynamics["extremes"][key], 5) for key in ("min", "mean", "max"))
        sentences.append(f"Fairlead tension over a period: {low} to {high} kN, mean {mean} kN.")
        least = dynamics["smallest"]
        sentences.append(
            f"The smallest tension along the line is {number(KN * least['tension'], 4)} kN, at s = "
            f"{number(least['s'], 4)} m, {number(least['time'])} s into the period."
        )
        sentences.append(_reference(dynamics["reference"]))
    return [*sentences, _describe_modes(dynamics)]


def _describe_modes(dynamics: dict) -> str:
    """Return the lowest natural frequencies; in a current of what still oscillates under its drag."""
    values = ", ".join(number(f, 4) for f in dynamics["modes"])
    if dynamics.get("in_current"):
        return (
            f"Lowest natural frequencies of the modes that oscillate about rest in the current: {values} Hz; its drag "
            "lets the others creep back."
        )
    return f"Lowest natural frequencies at rest: {values} Hz."


def _reference(known: dict) -> str:
    order = known.get("order")
    observed = f" (observed order in the mesh {number(order)})" if order else ""
    if known["method"] == "harmonic balance":
        return (
            f"Errors are against harmonic balance extrapolated from meshes up to {known['nodes']} nodes{observed}, "
            f"with up to {known['harmonics']} harmonics, known to {number(known['uncertainty'], 2)} of the greatest "
            "tension."
        )
    return (
        f"Errors are against time stepping with {known['nodes']} nodes and dt = {number(known['dt'])} s, which moved "
        f"by {number(known['uncertainty'], 2)} of the greatest tension when it was refined to this."
    )


def _caption(dynamics: dict) -> str:
    tail = f"Dashed: the tolerance of the scene. {STAR} Ringed: on the Pareto front."
    if dynamics.get("harmonics"):
        mean, *amplitudes = dynamics["harmonics"]
        great = int(np.argmax(amplitudes)) + 1
        tail += (
            f" The greatest harmonic of the tension is number {great}, {number(KN * amplitudes[great - 1], 4)} kN "
            f"about a mean of {number(KN * mean, 5)} kN."
        )
    return f"{_count_outcomes(dynamics['ladder'])}. {tail}"


def _count_outcomes(ladder: list[dict]) -> str:
    """Return such as "13 solved, 4 not corrected, MoorDyn not applicable"."""
    failed = [row for row in ladder if row["error"] is None]
    reasons = Counter(_reason(row) for row in failed if row["method"] in OWN)
    others = dict.fromkeys(
        f"{r['method']} {NO_TENSION.get(r['status'], 'failed')}" for r in failed if r["method"] not in OWN
    )
    ours = [f"{count} {reason}" for reason, count in reasons.items()]
    return ", ".join([f"{len(ladder) - len(failed)} solved", *ours, *others])


def _reason(row: dict) -> str:
    return "not corrected" if row["method"].endswith("corrected") else status_words(row["status"])


def _work(dynamics, name, folder) -> Figure:
    title = "Error against run time"
    figure, axes = panel(title, "run time, s", "error / greatest tension", xscale="log", yscale="log")
    solved = [row for row in dynamics["ladder"] if row["error"]]
    for method, look in style.add_missing_looks(METHODS, dict.fromkeys(row["method"] for row in solved)).items():
        rows = [row for row in solved if row["method"] == method]
        if rows:
            axes.plot([r["seconds"] for r in rows], [r["error"] for r in rows], look["marker"], label=method,
                      color=look["color"])  # fmt: skip
    front = pareto_front(solved)
    axes.plot([r["seconds"] for r in front], [r["error"] for r in front], "o", markerfacecolor="none",
              markeredgecolor=style.INK, markersize=10)  # fmt: skip
    axes.axhline(dynamics["tolerance"], color=style.INK, linestyle="--", linewidth=1)
    best = dynamics["recommended"]
    if best and best["error"]:
        axes.plot(
            best["seconds"],
            best["error"],
            "*",
            color=style.RECOMMENDED,
            markeredgecolor=style.INK,
            markersize=14,
            zorder=6,
        )
    set_decade_ticks(axes)
    add_legend(figure, axes)
    return style.save(figure, folder, f"{name}_work", title, f"{title} of {plural(len(solved), 'setting')}.")


def _waveform(dynamics, name, folder) -> Figure:
    title, wave = "Fairlead tension over a period", dynamics["waveform"]
    figure, axes = panel(title, "time, s", "tension, kN")
    axes.plot(wave["time"], KN * np.array(wave["tension"]), color=METHODS["reference"]["color"])
    axes.axhline(KN * dynamics["statics"]["exact"], color=style.PALE, linestyle=":", label="at rest")
    add_legend(figure, axes)
    return style.save(figure, folder, f"{name}_tension", title, f"{title}, converged, and the tension at rest.")


def _spectrum(dynamics, name, folder) -> Figure:
    title, harmonics = "Harmonics of the fairlead tension", np.array(dynamics["harmonics"][1:])
    number_of = np.arange(1, harmonics.size + 1)
    figure, axes = panel(title, "harmonic of the frequency", "amplitude, kN", yscale="log")
    is_shown = harmonics > 1e-6 * harmonics.max()  # a bar at the floor would look like a harmonic
    axes.bar(number_of[is_shown], KN * harmonics[is_shown], color=style.PALETTE[0])
    axes.set_xticks(number_of)
    return style.save(figure, folder, f"{name}_harmonics", title, f"{title}, 1 to {harmonics.size}.")


def _envelope(dynamics, name, folder) -> Figure:
    title, shape = "Tension along the line", {key: np.array(value) for key, value in dynamics["envelope"].items()}
    figure, axes = panel(title, "s, m of unstretched line from the anchor", "tension, kN")
    axes.fill_between(shape["s"], KN * shape["low"], KN * shape["high"], color=style.PALETTE[0], alpha=0.25,
                      label="least to greatest")  # fmt: skip
    axes.plot(shape["s"], KN * shape["mean"], color=style.PALETTE[0], label="mean")
    least = dynamics["smallest"]
    axes.plot(least["s"], KN * least["tension"], "v", color=style.WRONG, label="smallest")
    add_legend(figure, axes, 3)
    return style.save(figure, folder, f"{name}_envelope", title, f"{title} over a period: envelope and mean.")


def _settings(dynamics, name) -> Table:
    best = dynamics["recommended"]
    rows = [
        {
            "method": row["method"],
            "nodes": row["nodes"],
            "setting": f"{row['harmonics']} harmonics" if "harmonics" in row else f"dt = {number(row['dt'])} s",
            "error": row["error"],
            "seconds": row["seconds"],
            "ended": _outcome(row, best),
        }
        for row in dynamics["ladder"]
    ]
    heads = {"method": "method", "nodes": "nodes", "setting": "setting", "error": "error", "seconds": "run time",
             "ended": ""}  # fmt: skip
    error = lambda value: DASH if value is None else number(value, 2)
    return Table(f"{name}_settings", "Settings", heads, rows, {"error": error, "seconds": seconds})


def _outcome(row, best) -> str:
    if row["status"] in NO_TENSION:
        return f"{NO_TENSION[row['status']]}: {row['sentence']}"
    if row["status"] != "SUCCESS":
        return status_words(row["status"])
    same = best and all(best.get(key) == row.get(key) for key in ("method", "nodes", "harmonics", "dt"))
    return mark_best(best) if same else ""


def _statics(dynamics, name) -> Table:
    heads = {"nodes": "nodes", "tension": "tension at rest, kN", "error": "error", "seconds": "run time"}
    formats = {"tension": lambda v: number(KN * v, 8), "error": lambda v: number(v, 2), "seconds": seconds}
    return Table(f"{name}_statics", "The line at rest on the nodes", heads, dynamics["statics"]["rows"], formats)
