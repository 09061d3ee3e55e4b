"""Response curve of one's own line or network over a band of frequencies, with its stability: sweep_<stem>.json.

The points are kept as they come: interrupted, the same command goes on from the last ones.
"""

from __future__ import annotations

import argparse
import hashlib
import signal
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from solvers import ConvergenceError, InputError, Motion, Scene, mooring_system
from solvers.common.body_motion import BodyMotion
from solvers.io.curve_file import load_curve, save_curve
from solvers.stability import response_curve

from ..run import console, results
from ..scenes.network_files import line_names
from ..scenes.network_files import load as load_any_network

BAD_FILE = 2  # exit status
CELLS, HARMONICS = 24, 7
DEFAULT_AMPLITUDE = 1.0  # m, of surge, where neither the file nor the command line gives a motion
STEP, MAX_STEP, MIN_STEP = 0.02, 0.08, 1e-4
MOST_POINTS, CHUNK = 160, 8  # points of a curve, and between two writings of its file
LARGE_ERROR = 0.05  # of a point by its harmonics: what it says is then a guide
SAMPLES_OF_MOTION = 200  # instants at which the amplitude of a motion is taken


@dataclass(frozen=True)
class Case:
    """What is swept: the line or network, its motion at the start, and names for the page. notes: what was assumed."""

    given: object
    system: object
    name: str
    lines: list[str]
    breaking: list[float | None]
    amplitude: float
    notes: tuple[str, ...]


def read_band(text: str) -> tuple[float, float]:
    """Return (start, stop) in Hz of such as 0.02:0.3. Raises argparse.ArgumentTypeError for anything else."""
    try:
        start, stop = (float(part) for part in text.split(":"))
    except ValueError:
        start = stop = -1.0
    if not 0 < start < stop < np.inf:
        raise argparse.ArgumentTypeError(f"{text!r} is no band of frequencies in Hz, such as 0.02:0.3")
    return start, stop


def prepare(path: Path, band, amplitude=None, depth=None) -> Case:
    """Return the Case of a file. Raises InputError naming what is wrong in it."""
    is_line = path.suffix.lower() == ".toml" and "[[elements]]" not in path.read_text(encoding="utf-8")
    given, notes = (Scene.load(path), ()) if is_line else load_any_network(path, depth)
    motion, amplitude, more = _tuned(given, is_line, band[0], amplitude)
    system = mooring_system(given, CELLS, motion=motion)
    names = ["line"] if is_line else line_names(given)
    known = (given.cable.breaking_load,) if is_line else getattr(given, "breaking_loads", ()) or ()
    breaking = [*known, *[None] * (len(names) - len(known))]
    name = getattr(given, "name", "") or path.stem
    return Case(given, system, name, names, breaking, amplitude, (*notes, *more))


def _tuned(given, is_line, frequency, amplitude):
    """Return the motion at a frequency, its amplitude in m and what was assumed."""
    motion = getattr(given, "motion", None)
    if isinstance(motion, (Motion, BodyMotion)) and motion.period:
        path = motion if isinstance(motion, Motion) else motion.translation
        times = motion.period * np.arange(SAMPLES_OF_MOTION) / SAMPLES_OF_MOTION
        size = 0.0 if path is None else float(np.linalg.norm(path.displacement(times), axis=0).max())
        if amplitude is None:
            return motion, size, ()
        if size == 0:
            problem = f"{amplitude:g} m cannot scale a motion without displacement: leave --amplitude away where the "
            problem += "body only turns, else give [motion] of the file an amplitude in m"
            raise InputError(problem, field="amplitude", value=amplitude, unit="m")
        return motion.scaled(amplitude / size), amplitude, ()
    notes = ("The file has no harmonic motion: the moved ends go in surge",)
    notes = (f"{notes[0]} of {DEFAULT_AMPLITUDE:g} m; --amplitude takes another.",) if amplitude is None else (
        f"{notes[0]}.",)  # fmt: skip
    amplitude = DEFAULT_AMPLITUDE if amplitude is None else amplitude
    if not is_line:
        return BodyMotion.harmonic(frequency, (amplitude, 0.0, 0.0, 0.0, 0.0, 0.0)), amplitude, notes
    along = np.array(given.fairlead)[:2] - np.array(given.anchor)[:2]
    along = along / (np.linalg.norm(along) or 1.0) if along.any() else np.array([1.0, 0.0])
    return Motion.harmonic(frequency, (*(amplitude * along), 0.0)), amplitude, notes


def tensions(response) -> np.ndarray:
    """Return the tension at the second end of each element over the samples, (E, S), N."""
    elements = range(len(response.system.layout.s))
    return np.array([np.linalg.norm(response.end_force_at(response.time, -1, e), axis=1) for e in elements])


class Sweep:
    """The curves of a Case over a band: upwards, and from the stop down where the first one does not come so far.

    kept: file for each way, in which the points are written as they come.
    """

    def __init__(self, case, band, folder, key):
        self.case, self.band, self.folder, self.key = case, band, folder, key

    def follow(self):
        """Yield after each few points; ``curves`` then holds what is there."""
        self.curves = []
        yield from self._one_way("up", *self.band)
        if not self.curves[0].success:
            yield from self._one_way("down", *self.band[::-1])

    def _one_way(self, name, start, stop):
        file, system = self.folder / f"sweep-{self.key}-{name}.npz", self.case.system
        curve = load_curve(file, system) if file.exists() else None
        while curve is None or curve.status.name in ("CURVE_TOO_LONG", "CURVE_INTERRUPTED"):
            count = 0 if curve is None else curve.values.size
            if count >= MOST_POINTS:
                break
            before = curve
            curve = response_curve(
                system, start=start, stop=stop, harmonics=HARMONICS, step=STEP, max_step=MAX_STEP, min_step=MIN_STEP,
                max_points=count + CHUNK, stability=True, output=tensions, throw=False,
                resume=before if count else None)  # fmt: skip
            if curve.values.size:
                file.parent.mkdir(parents=True, exist_ok=True)
                save_curve(curve, file)
            if curve.status.name == "CURVE_INTERRUPTED":
                raise KeyboardInterrupt
            yield curve.values.size
        self.curves.append(curve)


def report(case: Case, band, curves, path: Path) -> dict:
    """Return what the page and the terminal say of the curves of a Case."""
    rows = [_rows(curve, way) for curve, way in zip(curves, ("up", "down"), strict=False) if curve.values.size]
    tensions_at_rest = _rest_tensions(case.system)
    file = {"file": path.name, "name": case.name, "lines": case.lines, "band": band, "amplitude": case.amplitude,
            "notes": case.notes, "rest": tensions_at_rest, "breaking": case.breaking, "curves": rows, "cells": CELLS,
            "harmonics": HARMONICS}  # fmt: skip
    return file | {"sentences": sentences(file)}


def _rest_tensions(system) -> np.ndarray:
    y = system.rest_state()[..., None]
    still = np.zeros_like(y)
    ends = [system.end_force(y, still, still, -1, e)[0] for e in range(len(system.layout.s))]
    return np.linalg.norm(ends, axis=1)


def _rows(curve, way) -> dict:
    """Return the points of a curve, and whether they are stable, sideways too."""
    across = [None] * curve.values.size if curve.sideways is None else curve.sideways
    sideways = [None if each is None else float(abs(each).max()) for each in across]
    special = [{"kind": each.kind, "value": each.value,
                "tension": float(curve.greatest[each.after].max()), "error": float(curve.errors[each.after])}
               for each in curve.special]  # fmt: skip
    unresolved = [{"kind": each.kind, "value": each.value, "doubt": each.doubt} for each in curve.unresolved]
    return {"way": way, "frequency": curve.values, "greatest": curve.greatest.T, "least": curve.least.T,
            "stable": curve.stable, "sideways": sideways, "errors": curve.errors, "special": special,
            "unresolved": unresolved,
            "status": curve.status.name, "advice": curve.status.value, "end": curve.end}  # fmt: skip


# ---------------------------------------------------------------- what it means
def sentences(file: dict) -> list[str]:
    """Return what the curves mean for the design, in sentences."""
    curves = file["curves"]
    low, high = file["band"]
    if not curves:
        return [f"No periodic response was found between {low:g} and {high:g} Hz: integrate in time there."]
    reached = sorted(bound for curve in curves for bound in (min(curve["frequency"]), max(curve["frequency"])))
    return [_largest(file), _jumps(curves), _instability(curves), *_gaps(curves, reached, low, high),
            *_doubts(curves)]  # fmt: skip


def _largest(file) -> str:
    curve, e, i = max(((curve, e, int(np.argmax(row))) for curve in file["curves"]
                       for e, row in enumerate(np.asarray(curve["greatest"]))),
                      key=lambda each: np.asarray(each[0]["greatest"])[each[1], each[2]])  # fmt: skip
    tension, frequency = float(np.asarray(curve["greatest"])[e, i]), float(curve["frequency"][i])
    name = "" if len(file["lines"]) == 1 else f" in {file['lines'][e]}"
    text = (
        f"With {file['amplitude']:.3g} m of motion the largest tension over the band is {tension / 1e3:.4g} kN{name}, "
        f"at {frequency:.4g} Hz ({1 / frequency:.3g} s), {tension / float(file['rest'][e]):.3g} times that at rest"
    )
    breaking = file["breaking"][e]
    return text + (f" and {100 * tension / breaking:.3g} % of the breaking load." if breaking else ".")


def _jumps(curves) -> str:
    folds = sorted(each["value"] for curve in curves for each in curve["special"] if each["kind"] == "fold")
    if not folds:
        return "No jumps: no frequency of the curve has a second response beside it."
    places = ", ".join(f"{value:.4g}" for value in folds)
    return (
        f"Jumps at {places} Hz: between two of them more than one response exists, and which one the line is in "
        "depends on how it came there; a simulation from rest shows one of them only."
    )


def _instability(curves) -> str:
    ranges = [part for curve in curves for part in _unstable_ranges(curve)]
    if not ranges:
        return "No instability: small disturbances, sideways too, decay at each frequency."
    kinds = sorted({each["kind"] for curve in curves for each in curve["special"] if each["kind"] != "fold"})
    sideways = any(across is not None and across >= 1 for curve in curves for across in curve["sideways"])
    named = [*kinds, *(["growth across the plane of the line"] if sideways else [])]
    why = f" ({', '.join(named)})" if named else ""
    places = ", ".join(f"{low:.4g}" if low == high else f"{low:.4g} to {high:.4g}" for low, high in ranges)
    return (
        f"Unstable at {places} Hz{why}: there the line leaves this motion for another one, and its tensions come from "
        "time integration."
    )


def _unstable_ranges(curve):
    """Return (lowest, highest) frequency of each run of unstable points along a curve."""
    runs: list[list[float]] = []
    was_stable = True
    for frequency, is_stable in zip(curve["frequency"], curve["stable"], strict=True):
        if not is_stable:
            if was_stable:
                runs.append([])
            runs[-1].append(float(frequency))
        was_stable = is_stable
    return [(min(run), max(run)) for run in runs]


def _gaps(curves, reached, low, high):
    """Yield a sentence where the curves do not cover the band."""
    up = max(curves[0]["frequency"]) if curves[0]["way"] == "up" else low
    down = min(curves[-1]["frequency"]) if curves[-1]["way"] == "down" else high
    if curves[-1]["way"] == "up" and curves[-1]["status"] != "SUCCESS":
        down = high
    if down > up and curves[0]["status"] != "SUCCESS":
        yield (
            f"From {up:.4g} to {down:.4g} Hz no curve was found ({curves[0]['end'] or curves[0]['status']}): tensions "
            "there come from time integration."
        )


def _doubts(curves):
    """Yield sentences on special points of the series alone, on slack and on harmonics that are too few."""
    turns = [each["value"] for curve in curves for each in curve["unresolved"]]
    if turns:
        places = f"{min(turns):.4g}" if min(turns) == max(turns) else f"{min(turns):.4g} to {max(turns):.4g}"
        yield (
            f"At {places} Hz the series of {HARMONICS} harmonics turns back where the motion does not: no jump of the "
            "line, but the end of what this curve resolves."
        )
    pairs = [(f, least, error) for curve in curves
             for f, least, error in zip(curve["frequency"], np.asarray(curve["least"]).min(axis=0), curve["errors"],
                                        strict=True)]  # fmt: skip
    doubtful = [f for f, _, error in pairs if error > LARGE_ERROR]
    if doubtful:
        yield (
            f"Between {min(doubtful):.4g} and {max(doubtful):.4g} Hz points have errors above "
            f"{100 * LARGE_ERROR:.0f} % by their {HARMONICS} harmonics: a line nearly slack, or a seabed that it meets."
        )


def main(argv=None) -> int:
    """Command line."""
    parser = console.parser("response_curves.sweep", __doc__)
    parser.add_argument("file", type=Path, metavar="FILE", help="a line or network: .toml, .map, .txt, .dat")
    parser.add_argument("--band", type=read_band, required=True, metavar="A:B", help="frequencies, Hz")
    parser.add_argument("--amplitude", type=float, metavar="M", help="largest displacement of the motion, m")
    parser.add_argument("--depth", type=float, metavar="M", help="depth of the water in m, where a MAP++ file asks")
    parser.add_argument("--name", help="of the result, where another file has the same stem")
    arguments = parser.parse_args(argv)
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    stem = arguments.name or arguments.file.stem
    try:
        case = prepare(arguments.file, arguments.band, arguments.amplitude, arguments.depth)
        sweep = Sweep(case, arguments.band, arguments.out / "cache", _key(arguments))
        for _ in console.progress(sweep.follow(), 2 * MOST_POINTS // CHUNK, f"sweep of {stem}"):
            pass
    except (InputError, ConvergenceError) as error:
        print(error, file=sys.stderr)
        return BAD_FILE
    content = report(case, arguments.band, sweep.curves, arguments.file)
    results.write(arguments.out / f"sweep_{stem}.json", {stem: content})
    print(*content["sentences"], sep="\n")
    return 0


def _key(arguments) -> str:
    """Return what the kept points depend on: the file, the band and the motion, and the solvers themselves."""
    solvers = sorted((console.ROOT / "solvers").rglob("*.py"))
    total = hashlib.sha256(b"".join(path.read_bytes() for path in (arguments.file, *solvers)))
    total.update(
        repr((arguments.band, arguments.amplitude, arguments.depth, CELLS, HARMONICS, STEP, MAX_STEP)).encode()
    )
    return total.hexdigest()[:16]


if __name__ == "__main__":
    console.run(main)
