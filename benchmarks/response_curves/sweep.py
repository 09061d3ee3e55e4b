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
from solvers.common.motions.body_motion import BodyMotion
from solvers.io.curve_file import load_curve, save_curve
from solvers.stability import response_curve

from ..run import console, results
from ..scenes.network_files import line_names
from ..scenes.network_files import load as load_any_network
from .integration import KEPT_PERIODS, PERIODS, find_gap, integrate_gap, integrate_tensions
from .meaning import find_largest_tension, write_sentences

BAD_FILE = 2  # exit status
CELLS, HARMONICS = 24, 7
DEFAULT_AMPLITUDE = 1.0  # m, of surge, where neither the file nor the command line gives a motion
STEP, MAX_STEP, MIN_STEP = 0.02, 0.08, 1e-4
MOST_POINTS, CHUNK = 160, 8  # points of a curve, and between two writings of its file
SAMPLES_OF_MOTION = 200  # instants at which the amplitude of a motion is taken
GROWING_DAMPING = (
    "The curve lets the damping of the seabed grow from contact on, over the {:.2g} m that the line sinks: its force "
    "jumps otherwise where a node touches down, which no series of a few harmonics follows. The time integrations "
    "have it at once."
)


@dataclass(frozen=True)
class Case:
    """What is swept: the line or network, its motion at the start, and names for the page. notes: what was assumed.

    system: of the curve, with a contact depth where the seabed is damped; whole_system: without, for time integration.
    """

    given: object
    system: object
    whole_system: object
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
    motion, amplitude, assumed = _tune_motion(given, is_line, band[0], amplitude)
    whole_system = system = mooring_system(given, CELLS, motion=motion)
    if given.environment.seabed_damping > 0:
        heaviest = max(segment.weight for segment in whole_system.model.segments)
        sinking = max(heaviest, 0.0) / given.environment.seabed_stiffness
        system = mooring_system(given, CELLS, motion=motion, contact_depth=sinking)
        assumed = (*assumed, GROWING_DAMPING.format(sinking))
    names = ["line"] if is_line else line_names(given)
    known = (given.cable.breaking_load,) if is_line else getattr(given, "breaking_loads", ()) or ()
    breaking = [*known, *[None] * (len(names) - len(known))]
    name = getattr(given, "name", "") or path.stem
    return Case(given, system, whole_system, name, names, breaking, amplitude, (*notes, *assumed))


def _tune_motion(given, is_line, frequency, amplitude):
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

    folder, key: of the file for each way, in which the points are written as they come.
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
    gap = find_gap(rows, band)
    largest = [find_largest_tension(rows)[2]] if rows else []
    file |= {"gap": gap, "integrated": integrate_gap(case.whole_system, gap),
             "integrated_at_largest": integrate_tensions(case.whole_system, largest),
             "periods": PERIODS, "kept_periods": KEPT_PERIODS}  # fmt: skip
    return file | {"sentences": write_sentences(file)}


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
