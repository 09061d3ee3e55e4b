"""Network files: lines at rest and in motion, forces on the body, and which setting gives which error for which time.

Networks in TOML with or without [motion], MAP++ files (.map) and MoorDyn files (.txt, .dat): network_<stem>.json.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np

from solvers import ConvergenceError, InputError, mooring_system, solve_network
from solvers.common.motions.sea_state import SeaMotion
from solvers.numerics.threads import one_blas_thread

from ..cable.work_precision import least_seconds
from ..network.pictures import drawn
from ..run import console, results
from . import network_outputs as outputs
from . import network_peers as peers_beside
from .exports import write_exports
from .margin import margins
from .network_files import line_names, load, node_names
from .network_study import PERIODS, REFERENCE_PERIODS, STEPPED, Study, error_of

BAD_FILE = 2  # exit status
TOLERANCE = 1e-2
"""Error that a setting may have: a hundredth of the largest tension, well below what drag coefficients are known to."""
STATIC_CELLS, COMPACT_STATIC_CELLS = (10, 20, 40, 80), (20, 40)
SLACK_SHARE = 0.1  # of the pretension: a smaller tension is called nearly slack
WORTH = 0.1  # of the tolerance, from which an unsteady response is mentioned
UPLIFT_ANGLE = 1.0  # degrees, from which uplift of an anchor is mentioned
TIMINGS = "timings"
"""Key of the file of timings: stem -> rows of method, cells, steps or harmonics, and seconds."""


def statics(network, compact: bool) -> dict:
    """Return the pretension of each line in N: exact catenaries, and on meshes of the moving lines where they move.

    Raises ConvergenceError without an equilibrium.
    """
    state = solve_network(network)
    exact, rows = np.hypot(state.H, state.V), []
    if any(element.cable is None for element in network.elements):
        return {"exact": exact, "meshes": rows}
    for cells in COMPACT_STATIC_CELLS if compact else STATIC_CELLS:
        row = {"cells": cells, "tension": None, "error": None, "sentence": ""}
        try:
            system = mooring_system(network, cells)
            row["tension"] = _rest_tensions(system)
            row["error"] = float((abs(row["tension"] - exact) / exact).max())
        except (ConvergenceError, InputError) as error:
            row["sentence"] = str(error)
        rows.append(row)
    return {"exact": exact, "meshes": rows}


def _rest_tensions(system) -> np.ndarray:
    """Return the tension at the fairlead end of each element at rest, N."""
    y = system.rest_state()[..., None]
    still = np.zeros_like(y)
    ends = [system.end_force(y, still, still, -1, e)[0] for e in range(len(system.layout.s))]
    return np.linalg.norm(ends, axis=1)


def _is_stepped(network) -> bool:
    """Return whether the body moves in a period or a series; a sea is a load case (benchmarks.load_cases.table)."""
    motion = getattr(network, "motion", None)
    return motion is not None and not isinstance(motion, SeaMotion)


def steps(network, compact: bool) -> int:
    """Return how many times ``study`` yields."""
    if not _is_stepped(network):
        return 1
    made = Study(network, compact)
    return 4 + len(STEPPED) + len(made.balanced)


def study(path: Path, network, notes, compact: bool = False):
    """Generator: yields None after each step of the work, and the report of the file last."""
    names = line_names(network)
    report = {"file": path.name, "name": getattr(network, "name", "") or path.stem, "compact": compact}
    report |= {"description": getattr(network, "description", ""), "tolerance": TOLERANCE}
    suspected = list(getattr(network, "warnings", ()))
    report |= {"warnings": [*suspected, *notes], "suspected": suspected, "notes": list(notes), "margins": []}
    report |= {"moves": _is_stepped(network), "lines": names, "current": network.environment.current}
    report |= {"coupled": _coupled_names(network)}
    total = steps(network, compact)
    try:
        report["statics"] = statics(network, compact)
        report["picture"] = _picture(network)
    except ConvergenceError as error:
        yield from [None] * (total - 1)
        yield report | {"failed": f"The network has no equilibrium: {error}"}
        return
    if not report["moves"]:
        peers = list(peers_beside.static_rows(network))
        still = [{"line": name, "mean": T, "max": T} for name, T in zip(names, report["statics"]["exact"], strict=True)]
        parts = {"static_peers": peers, "margins": _margins(network, still)}
        parts["warnings"] = report["warnings"] + list(_static_warnings(network, names))
        yield report | parts | {"stiffness_at_rest": _stiffness_at_rest(network)}
        return
    yield None
    yield from _motion(Study(network, compact), report, total - 1)


def _motion(made: Study, report: dict, left: int):
    """Yield None after each step of the work on a moving network, the report last; ``left`` yields in all."""
    try:
        made.warm_up()
        reference = made.reference()
    except ConvergenceError as error:
        yield from [None] * (left - 1)
        yield report | {"failed": f"The lines have no equilibrium to move from: {error}"}
        return
    yield None
    ladder, done = [], 1
    for row in made.ladder():
        ladder.append(row)
        yield None
        done += 1
    rows = rows_of(ladder, reference["wave"])
    rows += peers_beside.rows(made)
    yield None
    yield from [None] * (left - done - 2)
    yield report | _assemble(made, report, reference, ladder, rows)


def rows_of(ladder: list[dict], wave) -> list[dict]:
    """Return the settings without their waves, each with its error, None where it or the reference failed."""
    rows = []
    for point in ladder:
        known = point["wave"] is not None and wave is not None
        row = {key: value for key, value in point.items() if key not in ("wave", "response")}
        rows.append(row | {"error": error_of(point["wave"], wave) if known else None})
    return rows


def _assemble(made: Study, report: dict, reference: dict, ladder, rows) -> dict:
    """Return the parts of the report that say of the motion."""
    about = {key: value for key, value in reference.items() if key not in ("wave", "history")}
    parts = {"period": made.period, "duration": made.duration, "periods": PERIODS, "unit": made.unit, "ladder": rows,
             "reference": about | {"periods": REFERENCE_PERIODS}, "agreement": made.agreement(ladder),
             "impedance": _impedance(made)}  # fmt: skip
    if reference["wave"] is None:
        failure = reference["failure"]
        return parts | {"failed": f"The network could not be moved on a mesh fine enough to compare with: {failure}"}
    parts["motion"] = outputs.lines(made, report["lines"], reference, report["statics"])
    parts |= {"waveforms": outputs.waveforms(made, reference), "body": outputs.body(made, reference),
              "envelope": outputs.envelope(made, reference["history"]),
              "along": outputs.along_lines(made, reference["history"]),
              "static_peers": list(peers_beside.static_rows(made.network)),
              "margins": _margins(made.network, parts["motion"])}  # fmt: skip
    parts["warnings"] = report["warnings"] + list(_warnings(made, reference, rows, parts["motion"]))
    return parts


def _margins(network, rows: list[dict]) -> list[dict]:
    known = getattr(network, "breaking_loads", ()) or [None] * len(rows)
    return margins(rows, known, getattr(network, "safety_factors", None))


def _static_warnings(network, names):
    """Yield sentences on lines that are slack at rest in still water."""
    state = solve_network(network)
    for name, H, element in zip(names, state.H, network.elements, strict=True):
        (x0, y0, _), (x1, y1, _) = (state.r[end] for end in element.ends)
        if H == 0 and np.hypot(x1 - x0, y1 - y0) > 0 and not any(network.environment.current):
            yield f"{name} is slack at rest: its {element.L:g} m are more than its ends are apart; it pulls nothing."


def _impedance(made: Study) -> dict | None:
    try:
        return outputs.impedance(made)
    except (ConvergenceError, InputError) as error:
        return {"failed": str(error)}


def _coupled_names(network) -> list[str]:
    return [name for name, node in zip(node_names(network), network.nodes, strict=True) if node.kind == "coupled"]


def _picture(network) -> dict:
    """Return what a picture shows: see ``benchmarks.network.pictures.drawn``; each node with its name."""
    picture = drawn(network)
    for node, name in zip(picture["nodes"], node_names(network), strict=True):
        node["name"] = name
    return picture


def _stiffness_at_rest(network):
    state = solve_network(network)
    return state.body_stiffness((0.0, 0.0, 0.0)) if state.coupled.any() else None


def _warnings(made: Study, reference: dict, rows, motion: list[dict]):
    """Yield sentences on what the owner of this network should know."""
    network = made.network
    top = max(node.r[2] for node in network.nodes)
    if top > 0:
        yield f"A node is {top:.4g} m above still water (z = 0), and the lines are taken to be in the water all along."
    failed = {row["sentence"] for row in rows if row["method"] == "time domain" and row["status"] != "SUCCESS"}
    yield from (f"Some settings of time stepping failed: {sentence}." for sentence in sorted(failed))
    if reference["failure"]:
        yield f"The finest reference failed, and the one before is used: {reference['failure']}."
    if any(row["status"] == "NO_PERIODIC_RESPONSE" for row in rows):
        yield "Harmonic balance did not find the periodic response at every setting: time stepping is the safer choice."
    if reference["unsteady"] > WORTH * TOLERANCE:
        yield (
            f"The last two of {REFERENCE_PERIODS} periods differ by {reference['unsteady']:.2g} of the largest "
            "tension: the response is not yet periodic, or has another period than the motion."
        )
    for row in motion:
        yield from _line_warnings(row)


def _line_warnings(row: dict):
    least = row["least"]
    if row["slack"]["share"]:
        yield (
            f"{row['line']} goes slack from t = {row['slack']['start']:.4g} s, in {100 * row['slack']['share']:.2g} % "
            "of the time: the snap that follows depends on step and stiffness more than other maxima do."
        )
    elif least["tension"] < SLACK_SHARE * row["pretension"]:
        yield f"{row['line']} is nearly slack: {least['tension']:.4g} N at s = {least['s']:.4g} m."
    if row["uplift_angle"] is not None and row["uplift_angle"] > UPLIFT_ANGLE:
        yield (
            f"The anchor of {row['line']} is pulled upwards with {row['uplift']:.4g} N, {row['uplift_angle']:.3g} "
            "degrees from the horizontal: a drag anchor would lift."
        )


def timings(network, compact: bool, known: list[dict] | None) -> list[dict]:
    """Return the least seconds of each setting that solves; known: rows of an earlier run, which tell those that do."""
    made, rows = Study(network, compact), []
    settings = [("time domain", *setting) for setting in STEPPED]
    settings += [("harmonic balance", *setting) for setting in made.balanced]
    solved = known and {_key(row) for row in known if row["status"] == "SUCCESS"}
    made.warm_up()
    for setting in settings:
        if solved is not None and setting not in solved:
            continue
        made.system(setting[1])
        with one_blas_thread():
            seconds, response = least_seconds(lambda setting=setting: made.run(*setting))
        if response.success:
            size = "harmonics" if setting[0] == "harmonic balance" else "steps"
            rows.append({"method": setting[0], "cells": setting[1], size: setting[2], "seconds": seconds})
    return rows


def _key(row: dict):
    return row["method"], row["cells"], row.get("harmonics", row.get("steps"))


def _read(path: Path) -> dict:
    """Return an earlier result, empty where there is none."""
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}


def _run(arguments, networks: dict) -> dict:
    """Return the content of the result file."""
    compact, file = arguments.compact, {}
    if arguments.kind == "timed":
        kept = _read(arguments.out / "moving_networks_untimed.json")
        work = ((stem, timings(network, compact, kept.get(stem, {}).get("ladder")))
                for stem, (_, network, _) in networks.items())  # fmt: skip
        return {TIMINGS: dict(console.progress(work, len(networks), "moving networks"))}

    def work():
        for stem, (path, network, notes) in networks.items():
            for value in study(path, network, notes, compact):
                file[stem] = value and value | {"series": arguments.motion and arguments.motion.name}
                yield None
            if not compact:
                file[stem]["exports"] = write_exports(network, arguments.out, f"network_{stem}")

    total = sum(steps(network, compact) for _, network, _ in networks.values())
    for _ in console.progress(work(), total, ", ".join(networks)):
        pass
    return file


def main(argv=None) -> int:
    """Command line."""
    parser = console.parser("scenes.networks", __doc__)
    parser.add_argument("files", nargs="+", type=Path, metavar="FILE", help="network files: .toml, .map, .txt, .dat")
    parser.add_argument("--name", help="of the result, where another file has the same stem")
    parser.add_argument("--compact", action="store_true", help="fewer settings: a section of the whole report")
    parser.add_argument("--kind", choices=("timed", "untimed"), help="timings only, or all else, in files of their own")
    parser.add_argument("--depth", type=float, metavar="M", help="depth of the water in m, where a MAP++ file asks")
    parser.add_argument(
        "--motion", type=Path, metavar="FILE.csv", help="motion of the body, in place of the file's own"
    )
    arguments = parser.parse_args(argv)
    try:
        networks = {arguments.name or path.stem: (path, *load(path, arguments.depth, arguments.motion))
                    for path in arguments.files}  # fmt: skip
        file = _run(arguments, networks)
    except InputError as error:
        print(error, file=sys.stderr)
        return BAD_FILE
    names = {None: f"network_{arguments.name or arguments.files[0].stem}.json", "timed": "moving_networks.json",
             "untimed": "moving_networks_untimed.json"}  # fmt: skip
    results.write(arguments.out / names[arguments.kind], file)
    return 0


if __name__ == "__main__":
    console.run(main)
