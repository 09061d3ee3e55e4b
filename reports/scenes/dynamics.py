"""The moving line of a scene on the page: what to set, what error it makes, and how the tension runs."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..cable.cases import METHODS
from ..drawing import style
from ..drawing.axes import KN, add_legend, panel, set_decade_ticks
from ..page.analysis import pareto_front
from ..page.figures import Figure, Group
from ..page.formatting import DASH, number, plural, seconds, slug, status_words
from ..page.tables import Table

OWN = ("harmonic balance", "harmonic balance, corrected", "time domain")
OTHERS = {"REFUSED": "refused", "UNSUPPORTED": "not modelled"}
"""How other codes that give no tension are shown."""


def build(scene: dict, stem: str, figure_folder: Path, table_folder: Path) -> dict | None:
    """Return what dynamics.html.j2 shows; None for a scene at rest."""
    found = scene.get("dynamics")
    if found is None or "failed" in found:
        return found
    name = f"scene_{slug(stem)}_dynamics"
    solved = found.get("waveform") is not None
    figures = [_work(found, name, figure_folder)]
    if solved:
        figures += [
            _waveform(found, name, figure_folder),
            _spectrum(found, name, figure_folder),
            _envelope(found, name, figure_folder),
        ]
    tables = [_settings(found, name), _statics(found, name)]
    return {
        "sentence": _sentence(found),
        "facts": _facts(found),
        "python": found["python"] and found["python"].replace("FILE", scene["file"]),
        "warnings": found["warnings"],
        "figures": Group(_caption(found), figures),
        "tables": [table.write(table_folder) for table in tables],
    }


def _setting(row: dict) -> str:
    """As a reader says it."""
    if row["method"] != "time domain":
        how = " and a deferred correction" if row["method"].endswith("corrected") else ""
        return f"harmonic balance with {row['nodes']} nodes, {plural(row['harmonics'], 'harmonic')}{how}"
    return f"time stepping with {row['nodes']} nodes and dt = {number(row['dt'])} s"


def _sentence(found: dict) -> str:
    best = found["recommended"]
    if best is None:
        return "No setting solved this line: the table says how each ended."
    cost = f"{seconds(best['seconds'])} here, expected error {number(best['promised'], 2)} of the greatest tension"
    tolerance = number(found["tolerance"], 1)
    if best["meets"]:
        return f"Use {_setting(best)}: {cost}, within the tolerance of {tolerance}.{_cheaper(found, best)}"
    return f"No setting meets the tolerance of {tolerance}. The most accurate is {_setting(best)}: {cost}."


def _cheaper(found: dict, best: dict) -> str:
    """Other codes that meet the tolerance sooner than this project's setting that is recommended."""
    within = found["tolerance"] - found["reference"]["uncertainty"]
    rows = [row for row in found["ladder"] if row["method"] not in OWN and row["seconds"] < best["seconds"]]
    names = ", ".join(dict.fromkeys(r["method"] for r in rows if r["error"] is not None and r["error"] <= within))
    if not names:
        return ""
    return f" It is the cheapest of this project; cheaper still within the tolerance: {names}."


def _facts(found: dict) -> list[str]:
    """Extremes, reference and natural frequencies, one sentence each."""
    said = []
    if found.get("extremes"):
        low, mean, high = (number(KN * found["extremes"][key], 5) for key in ("min", "mean", "max"))
        said.append(f"Fairlead tension over a period: {low} to {high} kN, mean {mean} kN.")
        least = found["smallest"]
        said.append(
            f"The smallest tension along the line is {number(KN * least['tension'], 4)} kN, at s = "
            f"{number(least['s'], 4)} m, {number(least['time'])} s into the period."
        )
        said.append(_reference(found["reference"]))
    said.append(f"Lowest natural frequencies at rest: {', '.join(number(f, 4) for f in found['modes'])} Hz.")
    return said


def _reference(known: dict) -> str:
    order = known.get("order")
    seen = f" (observed order in the mesh {number(order)})" if order else ""
    if known["method"] == "harmonic balance":
        return (
            f"Errors are against harmonic balance extrapolated from meshes up to {known['nodes']} nodes{seen}, with up "
            f"to {known['harmonics']} harmonics, known to {number(known['uncertainty'], 2)} of the greatest tension."
        )
    return (
        f"Errors are against time stepping with {known['nodes']} nodes and dt = {number(known['dt'])} s, which moved "
        f"by {number(known['uncertainty'], 2)} of the greatest tension when it was refined to this."
    )


def _caption(found: dict) -> str:
    used = [row for row in found["ladder"] if row["error"]]
    failed = len(found["ladder"]) - len([row for row in found["ladder"] if row["error"] is not None])
    said = f"{plural(len(used), 'setting')} solved" + (f", {failed} failed" if failed else "")
    tail = "Dashed: the tolerance of the scene. Star: the recommended setting. Ringed: on the Pareto front."
    if found.get("harmonics"):
        mean, *rest = found["harmonics"]
        great = int(np.argmax(rest)) + 1
        tail += (
            f" The greatest harmonic of the tension is number {great}, {number(KN * rest[great - 1], 4)} kN about a "
            f"mean of {number(KN * mean, 5)} kN."
        )
    return f"{said}. {tail}"


def _work(found, name, folder) -> Figure:
    title = "Error against run time"
    figure, axes = panel(title, "run time, s", "error / greatest tension", xscale="log", yscale="log")
    solved = [row for row in found["ladder"] if row["error"]]
    for method, look in style.add_missing_looks(METHODS, dict.fromkeys(row["method"] for row in solved)).items():
        rows = [row for row in solved if row["method"] == method]
        if rows:
            axes.plot([r["seconds"] for r in rows], [r["error"] for r in rows], look["marker"], label=method,
                      color=look["color"])  # fmt: skip
    front = pareto_front(solved)
    axes.plot([r["seconds"] for r in front], [r["error"] for r in front], "o", markerfacecolor="none",
              markeredgecolor=style.INK, markersize=10)  # fmt: skip
    axes.axhline(found["tolerance"], color=style.INK, linestyle="--", linewidth=1)
    best = found["recommended"]
    if best and best["error"]:
        axes.plot(best["seconds"], best["error"], "*", color=style.RECOMMENDED, markeredgecolor=style.INK, markersize=14, zorder=6)
    set_decade_ticks(axes)
    add_legend(figure, axes)
    return style.save(figure, folder, f"{name}_work", title, f"{title} of {plural(len(solved), 'setting')}.")


def _waveform(found, name, folder) -> Figure:
    title, wave = "Fairlead tension over a period", found["waveform"]
    figure, axes = panel(title, "time, s", "tension, kN")
    axes.plot(wave["time"], KN * np.array(wave["tension"]), color=METHODS["reference"]["color"])
    axes.axhline(KN * found["statics"]["exact"], color=style.PALE, linestyle=":", label="at rest")
    add_legend(figure, axes)
    return style.save(figure, folder, f"{name}_tension", title, f"{title}, converged, and the tension at rest.")


def _spectrum(found, name, folder) -> Figure:
    title, harmonics = "Harmonics of the fairlead tension", np.array(found["harmonics"][1:])
    number_of = np.arange(1, harmonics.size + 1)
    figure, axes = panel(title, "harmonic of the frequency", "amplitude, kN", yscale="log")
    axes.bar(number_of, KN * np.maximum(harmonics, 1e-6 * harmonics.max()), color=style.PALETTE[0])
    axes.set_xticks(number_of)
    return style.save(figure, folder, f"{name}_harmonics", title, f"{title}, 1 to {harmonics.size}.")


def _envelope(found, name, folder) -> Figure:
    title, shape = "Tension along the line", {key: np.array(value) for key, value in found["envelope"].items()}
    figure, axes = panel(title, "s, m of unstretched line from the anchor", "tension, kN")
    axes.fill_between(shape["s"], KN * shape["low"], KN * shape["high"], color=style.PALETTE[0], alpha=0.25,
                      label="least to greatest")  # fmt: skip
    axes.plot(shape["s"], KN * shape["mean"], color=style.PALETTE[0], label="mean")
    least = found["smallest"]
    axes.plot(least["s"], KN * least["tension"], "v", color=style.WRONG, label="smallest")
    add_legend(figure, axes, 3)
    return style.save(figure, folder, f"{name}_envelope", title, f"{title} over a period: envelope and mean.")


def _settings(found, name) -> Table:
    best = found["recommended"]
    rows = [
        {
            "method": row["method"],
            "nodes": row["nodes"],
            "setting": f"{row['harmonics']} harmonics" if "harmonics" in row else f"dt = {number(row['dt'])} s",
            "error": row["error"],
            "seconds": row["seconds"],
            "ended": _ended(row, best),
        }
        for row in found["ladder"]
    ]
    heads = {"method": "method", "nodes": "nodes", "setting": "setting", "error": "error", "seconds": "run time",
             "ended": ""}  # fmt: skip
    error = lambda value: DASH if value is None else number(value, 2)
    return Table(f"{name}_settings", "Settings", heads, rows, {"error": error, "seconds": seconds})


def _ended(row, best) -> str:
    if row["status"] in OTHERS:
        return f"{OTHERS[row['status']]}: {row['sentence']}"
    if row["status"] != "SUCCESS":
        return status_words(row["status"])
    same = best and all(best.get(key) == row.get(key) for key in ("method", "nodes", "harmonics", "dt"))
    return "recommended" if same else ""


def _statics(found, name) -> Table:
    heads = {"nodes": "nodes", "tension": "tension at rest, N", "error": "error", "seconds": "run time"}
    formats = {"tension": lambda v: number(v, 8), "error": lambda v: number(v, 2), "seconds": seconds}
    return Table(f"{name}_statics", "The line at rest on the nodes", heads, found["statics"]["rows"], formats)
