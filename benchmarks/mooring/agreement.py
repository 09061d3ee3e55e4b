"""Do harmonic balance, time integration and MoorDyn agree over a seabed, on the same cells, and if not, why not?

``python -m benchmarks.mooring.agreement`` writes what MoorDyn gives, which takes minutes where internal damping makes
its steps short: reference_data/moordyn_seabeds.
"""

from __future__ import annotations

import csv
import math
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import numpy as np

from solvers import Status, mooring_system, solve_periodic, solve_time_domain
from solvers.common.motions.motion import Ramped
from solvers.numerics.threads import one_blas_thread
from verification.registry import instants, last_period_tension

from .. import peers
from ..cable.cases import rms
from . import cases
from .seabed import LINES
from .validation import scene

MOTIONS = {name: ("heave" if name == "shallow" else "surge", *motions[-1]) for name, motions in LINES.items()}
"""Line -> kind, amplitude or radius in m, period in s: the shorter motion of each; surge makes "shallow" slack."""
CELLS = 50
STEPS, REFINED = 800, (1600, 3200)  # in a period: from rest, and of the last periods, which are extrapolated
PERIODS, MORE_PERIODS = 12, 3  # from rest, and with each number of refined steps from where the last ones ended
HARMONICS, SAMPLES_PER_HARMONIC = 120, 8
MORE_HARMONICS = {"buoy": 240, "shallow": 240}  # light chains on hard seabeds, whose nodes swing fast
AGREED = 1e-3  # rms of a difference over the range of the tension, that harmonic balance and time integration keep
RESOLVED = 3  # harmonics to the frequency of the swing, with fewer of which a part of it is lost
MOST_CONTACT = 1.0  # times the harmonics: swing of nodes on the seabed beyond which balance is not tried
SOFTER = {"rock": 3e5, "shallow": 1e5}  # N/m^2: seabeds on which nodes swing well within the harmonics
PEER_STEPS, PEER_PERIODS, PEER_INSTANTS = 1600, 6, 200
"""Coupling steps in a period of MoorDyn, periods, and instants of the last one that are kept."""
PEER_DATA = files("reference_data") / "moordyn_seabeds" / "data.csv"


def swing_frequency(case) -> float:
    """Return sqrt(k / (m + ma)) in rad/s, at which a line that lies on a seabed of stiffness k swings."""
    return math.sqrt(case.environment.seabed_stiffness / _moved_mass(case))


def _moved_mass(case) -> float:
    return case.cable.mass_per_length + case.cable.added_mass(case.environment)


def damp_seabed(case):
    """Return a scene whose seabed has the damping that is critical for the line as it lies, 2 sqrt(k (m + ma))."""
    damping = 2 * _moved_mass(case) * swing_frequency(case)
    return replace(case, environment=replace(case.environment, seabed_damping=damping))


def sinking(case) -> float:
    """Return how deep a line lies in its seabed, m."""
    return case.cable.weight_in(case.environment) / case.environment.seabed_stiffness


class Integrated:
    """The fairlead tension of a moving line over one period, INSTANTS values in N, with shorter and shorter steps.

    history: the last one, or that which failed; waves: of each number of steps; extrapolated: from the last two;
    spread: the range of the last; change: of the last period from the one before, and steps: of the last two numbers
    of steps, rms over the range; slack: part of the period in which some cell is slack.
    """

    def __init__(self, system):
        self.history = solve_time_domain(system, dt=system.period / STEPS, periods=PERIODS, throw=False)
        self.waves = []
        for steps in REFINED:
            if not self.history.success:
                return
            self.waves.append(last_period_tension(self.history))
            start = self.history.y[..., -1], self.history.ydot[..., -1]
            self.history = solve_time_domain(
                system, dt=system.period / steps, periods=MORE_PERIODS, start=start, throw=False
            )
        if not self.history.success:
            return
        self.waves.append(last_period_tension(self.history))
        last, period = self.waves[-1], system.period
        self.spread = float(np.ptp(last))
        before = self.history.fairlead_tension((MORE_PERIODS - 2) * period + instants(period))
        self.change, self.steps = self.over_range(last - before), self.over_range(last - self.waves[-2])
        self.extrapolated = last + (last - self.waves[-2]) / ((REFINED[1] / REFINED[0]) ** 2 - 1)
        late = [spell for spell in self.history.slack if spell.end > (MORE_PERIODS - 1) * period]
        self.slack = max((spell.end - spell.start for spell in late), default=0.0) / period

    def over_range(self, difference) -> float:
        """Return the rms of a difference of tensions in N over their range."""
        return rms(difference) / self.spread


def compare(name: str, kind: str, amplitude: float, period: float, stiffness: float | None = None) -> dict:
    """Return how far a motion of a line over a damped seabed is apart by harmonic balance and in time, on one mesh.

    stiffness: of the seabed in N/m^2, in place of its own. contact: swing frequency over that of the motion. undamped:
    change from period to period and with shorter steps as the scene has it, without damping of the seabed. effect: what
    damping changes the tension by. balance: status, difference from the history. reason: why they are more than AGREED
    apart, or None.
    """
    given = scene(name)
    if stiffness is not None:
        given = replace(given, environment=replace(given.environment, seabed_stiffness=stiffness))
    motion = cases.motion(kind, amplitude, period)
    damped = mooring_system(damp_seabed(given), CELLS, motion=motion, contact_depth=sinking(given))
    history, undamped = Integrated(damped), Integrated(mooring_system(given, CELLS, motion=motion))
    row = {"line": name, "title": given.name, "kind": kind, "amplitude": amplitude, "period": period,
           "seabed_stiffness": given.environment.seabed_stiffness, "status": history.history.status.name,
           "contact": swing_frequency(given) * period / (2 * np.pi)}  # fmt: skip
    if not history.history.success:
        return row | {"reason": "a time step failed"}
    row |= {"change": history.change, "steps": history.steps, "slack": history.slack, "undamped": None, "effect": None}
    if undamped.history.success:
        row["undamped"] = {"change": undamped.change, "steps": undamped.steps}
        row["effect"] = undamped.over_range(history.waves[-1] - undamped.waves[-1])
    harmonics = MORE_HARMONICS.get(name, HARMONICS) if stiffness is None else HARMONICS
    balance = _balance(damped, history, row["contact"], harmonics)
    return row | {"balance": balance, "reason": explain(row | {"balance": balance})}


def _balance(system, integrated, contact, harmonics) -> dict:
    """Return harmonics and status of balance started from a history, and its difference; not tried without a chance."""
    row = {"harmonics": harmonics, "difference": None, "greatest": None}
    if integrated.slack > 0:
        return row | {"status": "SLACK"}
    if contact > MOST_CONTACT * harmonics:
        return row | {"status": "CONTACT"}
    samples = SAMPLES_PER_HARMONIC * harmonics
    response = solve_periodic(system, harmonics=harmonics, samples=samples, start=integrated.history, throw=False)
    if response.status is not Status.SUCCESS:
        return row | {"status": response.status.name}
    wave = response.fairlead_tension(instants(system.period))
    return row | {"status": "SUCCESS", "difference": integrated.over_range(wave - integrated.extrapolated),
                  "greatest": float(wave.max() - integrated.extrapolated.max()) / integrated.spread}  # fmt: skip


def explain(row: dict) -> str | None:
    """Return why harmonic balance and time integration are more than AGREED apart, from the figures of a row."""
    balance = row["balance"]
    if balance["status"] == "SUCCESS" and balance["difference"] <= AGREED:
        return None
    if row["slack"] > 0:
        return f"slack for {100 * row['slack']:.0f} % of the period: a snap has no few harmonics"
    if row["contact"] > balance["harmonics"] / RESOLVED:
        times, count = round(row["contact"]), balance["harmonics"]
        return f"nodes swing on the seabed at {times} times the frequency, and balance has {count} harmonics"
    if row["steps"] > AGREED:
        return f"the steps leave {row['steps']:.1e}"
    return "Newton's method finds no response" if balance["status"] != "SUCCESS" else "the harmonics do not suffice"


def agreement(quick: bool):
    """Yield a row for one motion of every line, ``compare`` and MoorDyn's answer beside it."""
    rows, known = [], read_moordyn()
    with one_blas_thread():
        for name, motion in list(MOTIONS.items())[: 2 if quick else None]:
            rows.append(compare(name, *motion) | {"moordyn": compare_with_moordyn(name, known[name])})
            yield None
            if name in SOFTER:
                rows.append(compare(name, *motion, SOFTER[name]) | {"moordyn": None})
                yield None
    yield {"rows": rows, "cells": CELLS, "steps": [STEPS, *REFINED], "agreed": AGREED,
           "samples": SAMPLES_PER_HARMONIC, "peer_steps": PEER_STEPS}  # fmt: skip


# ---------------------------------------------------------------- MoorDyn
def compare_with_moordyn(name: str, tension) -> dict:
    """Return how far MoorDyn's tension (PEER_INSTANTS,) in N is from this core's on equal cells, the seabed undamped.

    rms and greatest: of their difference and of that of their greatest values, over the range; steps: what half the
    step changes here, rms over the range.
    """
    kind, amplitude, period = MOTIONS[name]
    motion = cases.motion(kind, amplitude, period)
    system = mooring_system(scene(name), CELLS, mesh="uniform", calibrate=False, motion=motion)
    times, waves = (PEER_PERIODS - 1) * period + instants(period, PEER_INSTANTS), []
    for steps in (PEER_STEPS, 2 * PEER_STEPS):
        history = solve_time_domain(system, dt=period / steps, periods=PEER_PERIODS)
        waves.append(history.fairlead_tension(times))
    ours, spread = waves[0], float(np.ptp(waves[0]))
    return {"rms": rms(tension - ours) / spread, "greatest": float(tension.max() - ours.max()) / spread,
            "steps": rms(waves[1] - ours) / spread}  # fmt: skip


def read_moordyn() -> dict:
    """Return line -> the tension (PEER_INSTANTS,) in N that MoorDyn gave over its last period."""
    with PEER_DATA.open(encoding="utf-8", newline="") as lines:
        rows = list(csv.DictReader(lines))
    return {name: np.array([float(row[name]) for row in rows]) for name in rows[0] if name != "instant"}


def run_moordyn(name: str) -> np.ndarray:
    """Return the tension (PEER_INSTANTS,) in N of MoorDyn over the last of PEER_PERIODS, the motion ramped."""
    kind, amplitude, period = MOTIONS[name]
    case, motion = scene(name), Ramped(cases.motion(kind, amplitude, period), period / 2)
    time = np.linspace(0.0, PEER_PERIODS * period, PEER_PERIODS * PEER_STEPS + 1)
    fairlead = np.array(case.fairlead) + motion.displacement(time).T
    tension = peers.adapters()["moordyn"].cable(case, time, fairlead, CELLS)
    return tension[-1 - PEER_STEPS : -1 : PEER_STEPS // PEER_INSTANTS]


def main() -> None:
    """Write MoorDyn's tensions of every line, one column each."""
    columns = {name: run_moordyn(name) for name in MOTIONS}
    path = Path(str(PEER_DATA))
    path.parent.mkdir(exist_ok=True)
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["instant", *columns])
        for k, values in enumerate(zip(*columns.values(), strict=True)):
            writer.writerow([k, *(f"{value:.8g}" for value in values)])


if __name__ == "__main__":
    main()
