"""The moving lines of nodes and elements that are measured, and the converged tension that errors are taken against.

The cases of the HB paper have the Reference of ``benchmarks.cable.cases``, which another discretisation gives. The
lines over a seabed have one of this core on meshes and steps far finer than those measured.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, replace
from functools import cache
from importlib.resources import files
from pathlib import Path

import numpy as np

from solvers import CableSystem, MooringSystem, Motion, Scene, cable_system, mooring_system, solve_time_domain
from verification.registry import last_period_tension

from ..cable import cases as cable_cases
from ..cable.cases import Reference, References, rms
from ..run import refinement, results

SCENES = files("reference_data") / "scenes"
PAPER = (*cable_cases.PAPER_CASES, "case_1_large")
SEABED = ("shallow_chain", "oc3_seabed", "semi_15MW")
CASES = (*PAPER, *SEABED)

PERIODS = {True: 5, False: 3}  # of a time history, over a seabed and without: what is left of the start is below 3e-4
REFERENCE, QUICK_REFERENCE = ((200, 800), (400, 1600)), ((100, 400), (200, 800))
"""(cells, steps in a period) of two runs; the finer one is the reference over a seabed, for both are of one core."""
REFERENCE_PERIODS = 6


@cache
def scene(name: str) -> Scene:
    """Return the scene of one of CASES, with its motion; lines over a seabed without structural damping.

    An explicit code pays for damping with short steps, which would say nothing of the method at equal error.
    """
    if name in PAPER:
        return cable_cases.scene(name)
    if name == "shallow_chain":
        case = Scene.load(SCENES / "dynamics" / "shallow_chain_surge.toml")
    elif name == "oc3_seabed":
        case = replace(Scene.load(SCENES / "mooring" / "oc3.toml"), motion=motion("surge", 5.0, 20.0))
        case = replace(case, name=f"{case.name}: surge of 5 m")
    else:
        case = replace(Scene.load(SCENES / "mooring" / "semi_15MW.toml"), motion=motion("circle", 3.0, 12.0))
        case = replace(case, name=f"{case.name}: circle of 3 m")
    return replace(case, cable=replace(case.cable, damping=0.0))


def motion(kind: str, amplitude: float, period: float) -> Motion:
    """Return a surge, a heave or a circle in the plane of the line: amplitude or radius in m, period in s."""
    rows = {
        "surge": ([[amplitude, 0.0, 0.0]], None),
        "heave": ([[0.0, 0.0, amplitude]], None),
        "circle": ([[amplitude, 0.0, 0.0]], [[0.0, 0.0, amplitude]]),  # away from the anchor at the top
    }
    return Motion(1 / period, *rows[kind])


def periods(name: str) -> int:
    """Return how many periods a time history of a case takes."""
    return PERIODS[name in SEABED]


@cache
def line(name: str, cells: int) -> MooringSystem:
    """Return the line of a case on so many cells, its equilibrium solved for."""
    system = mooring_system(scene(name), cells)
    system.rest_state()
    return system


def every_second_node(system: MooringSystem) -> MooringSystem:
    """Return the same line on half as many cells, every second node of its mesh, its equilibrium solved for."""
    coarse = system.coarser()[0]
    coarse.rest_state()
    return coarse


@cache
def box(name: str, nodes: int) -> CableSystem:
    """Return the cable of a case on the box scheme, its equilibrium solved for."""
    system = cable_system(scene(name), nodes)
    system.rest_state()
    return system


def finest(name: str, levels) -> Reference:
    """Return the tension on the last of two levels, refined by half in mesh and step alone, or on one level.

    Uncertainty: a third of what the first level differs by, as an error of second order leaves; where the touchdown
    travels it is a guide and no bound. refinements: three meshes with the finest step, three steps on the finest mesh.
    """
    runs = {level: run_in_time(name, *level) for level in levels}
    wave = runs[levels[-1]]
    spread = float(np.ptp(wave))
    uncertainty = rms(wave - runs[levels[0]]) / 3 / spread
    kept = {} if len(levels) == 1 else _refine(name, *levels[-1], wave)
    return Reference(line(name, levels[-1][0]).period, wave, uncertainty, tuple(cells for cells, _ in levels), kept)


def run_in_time(name: str, cells: int, steps: int) -> np.ndarray:
    """Return the fairlead tension (INSTANTS,) of a case over the last of REFERENCE_PERIODS, N."""
    system = line(name, cells)
    return last_period_tension(solve_time_domain(system, dt=system.period / steps, periods=REFERENCE_PERIODS))


def _refine(name: str, cells: int, steps: int, fine) -> dict:
    """Return "mesh" and "steps" -> the fields of a Refinement of the finest run, each by four, by two and by one."""
    spread = float(np.ptp(fine))
    meshes, counts = ([size // 4, size // 2, size] for size in (cells, steps))
    by_mesh = [*(run_in_time(name, size, steps) for size in meshes[:2]), fine]
    by_step = [*(run_in_time(name, cells, count) for count in counts[:2]), fine]
    return {"mesh": asdict(refinement.estimate_uncertainty(meshes, by_mesh, spread)),
            "steps": asdict(refinement.estimate_uncertainty(counts, by_step, spread))}  # fmt: skip


class ConvergedTensions:
    """Converged tensions of CASES, kept in ``folder``/cache by the content of what they are made with."""

    def __init__(self, folder: Path, quick: bool):
        self.folder, self.levels = folder / "cache", QUICK_REFERENCE if quick else REFERENCE
        self.of_paper = References(folder, quick)

    def get_or_compute(self, name: str) -> Reference:
        """Return the Reference of a case: kept, or computed."""
        if name in PAPER:
            return self.of_paper.get_or_compute(name)
        path = self.folder / f"mooring-{name}-{self._digest(name)}.json"
        if path.exists():
            kept = json.loads(path.read_text(encoding="utf-8"))
            return Reference(**kept | {"tension": np.array(kept["tension"])})
        reference = finest(name, self.levels)
        results.write(path, vars(reference))
        return reference

    def _digest(self, name) -> str:
        made = hashlib.sha256(json.dumps([self.levels, REFERENCE_PERIODS, repr(scene(name)), sources()]).encode())
        return made.hexdigest()[:16]


@cache
def sources() -> str:
    """Return a digest of the modules that a reference over a seabed depends on."""
    total = hashlib.sha256(Path(__file__).read_bytes() + Path(refinement.__file__).read_bytes())
    for path in sorted((files("solvers") / "mooring").iterdir(), key=lambda path: path.name):
        if path.name.endswith(".py"):
            total.update(path.read_bytes())
    return total.hexdigest()


def least_period_count(waves, level: float, known: Reference) -> int | None:
    """Return how many periods come before the error stays within a level; None where it never does.

    waves (P, INSTANTS): the fairlead tension of each period, N.
    """
    away = np.array([known.errors(wave)["rms"] for wave in waves])
    late = np.flatnonzero(~(away <= level))
    first = int(late[-1]) + 2 if late.size else 1
    return first if first <= len(away) else None
