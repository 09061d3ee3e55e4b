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
from typing import Any

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
MOST_STEPS = 12800  # to which those of a damped seabed are doubled while the last doubling changed more than AGREED
PERIODS, MORE_PERIODS = 12, 3  # from rest, and with each number of refined steps from where the last ones ended
BALANCES = ((120, 8, 1e-10), (240, 4, 1e-10), (480, 4, 1e-10), (960, 4, 1e-8))
"""Harmonics, samples to each and last Newton step in m; all but the first are solved by GMRES. With 960 a node that
only touches the seabed makes steps of 5e-9 m for ever, which change the tension by 1e-5 of its range."""
AGREED = 1e-3  # rms of a difference over the range of the tension, that harmonic balance and time integration keep
RESOLVED = 3  # harmonics to the frequency of the swing, with fewer of which a part of it is lost
BRIEF, SAMPLES_OF_SLACK = 0.0125, 8
"""Part of a period for which cells may be slack, and samples to each harmonic then: at 1.0 % balance converges, and
at 1.4 % GMRES does not solve for the first Newton step."""
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

    most_steps: in a period, up to which they are doubled while the last two numbers of them are more than AGREED apart.
    history: the last one, or that which failed; waves: of each number of steps; extrapolated: from the last two;
    spread: the range of the last; change: of the last period from the one before, and steps: of the last two numbers
    of steps, rms over the range; slack: part of the period in which some cell is slack.
    """

    def __init__(self, system, most_steps=REFINED[-1]):
        self.history = solve_time_domain(system, dt=system.period / STEPS, periods=PERIODS, throw=False)
        self.waves = []
        for steps in REFINED:
            self._refine(system, steps)
        while self.history.success and steps < most_steps and self._last_change() > AGREED:
            steps *= 2
            self._refine(system, steps)
        if not self.history.success:
            return
        last, period = self.waves[-1], system.period
        self.spread = float(np.ptp(last))
        before = self.history.fairlead_tension((MORE_PERIODS - 2) * period + instants(period))
        self.change, self.steps = self.over_range(last - before), self._last_change()
        self.extrapolated = last + (last - self.waves[-2]) / 3  # of second order, with half the step
        late = [spell for spell in self.history.slack if spell.end > (MORE_PERIODS - 1) * period]
        self.slack = max((spell.end - spell.start for spell in late), default=0.0) / period

    def _refine(self, system, steps):
        """Take MORE_PERIODS with so many steps in each from where the history ended, unless it failed."""
        if not self.history.success:
            return
        self.waves = self.waves or [last_period_tension(self.history)]
        start, dt = (self.history.y[..., -1], self.history.ydot[..., -1]), system.period / steps
        self.history = solve_time_domain(system, dt=dt, periods=MORE_PERIODS, start=start, throw=False)
        if self.history.success:
            self.waves.append(last_period_tension(self.history))

    def _last_change(self) -> float:
        return rms(self.waves[-1] - self.waves[-2]) / float(np.ptp(self.waves[-1]))

    def over_range(self, difference) -> float:
        """Return the rms of a difference of tensions in N over their range."""
        return rms(difference) / self.spread


def compare(name: str, kind: str, amplitude: float, period: float) -> dict:
    """Return how far a motion of a line over a damped seabed is apart by harmonic balance and in time, on one mesh.

    contact: swing frequency over that of the motion. undamped: change from period to period and with shorter steps as
    the scene has it, without damping of the seabed. effect: what damping changes the tension by. balance: status,
    difference from the history. reason: why they are more than AGREED apart, or None.
    """
    given = scene(name)
    motion = cases.motion(kind, amplitude, period)
    damped = mooring_system(damp_seabed(given), CELLS, motion=motion, contact_depth=sinking(given))
    history, undamped = Integrated(damped, MOST_STEPS), Integrated(mooring_system(given, CELLS, motion=motion))
    row = {"line": name, "title": given.name, "kind": kind, "amplitude": amplitude, "period": period,
           "seabed_stiffness": given.environment.seabed_stiffness, "status": history.history.status.name,
           "contact": swing_frequency(given) * period / (2 * np.pi)}  # fmt: skip
    if not history.history.success:
        return row | {"reason": "a time step failed"}
    row |= {"change": history.change, "steps": history.steps, "slack": history.slack, "undamped": None, "effect": None}
    if undamped.history.success:
        row["undamped"] = {"change": undamped.change, "steps": undamped.steps}
        row["effect"] = undamped.over_range(history.waves[-1] - undamped.waves[-1])
    balance = _balance(damped, history, row["contact"])
    return row | {"balance": balance, "reason": explain(row | {"balance": balance})}


def choose_balance(contact: float, slack: float) -> tuple[int, int, float]:
    """Return the first of BALANCES that resolves the swing of nodes on the seabed, and slack cells by the last."""
    if slack > 0:
        harmonics, _, tolerance = BALANCES[-1]
        return harmonics, SAMPLES_OF_SLACK, tolerance
    return next((balance for balance in BALANCES if balance[0] >= RESOLVED * contact), BALANCES[-1])


def _balance(system, integrated, contact) -> dict:
    """Return harmonics and status of balance started from a history, and its difference; not tried without a chance."""
    harmonics, per_harmonic, tolerance = choose_balance(contact, integrated.slack)
    row = {"harmonics": harmonics, "difference": None, "greatest": None}
    if integrated.slack > BRIEF:
        return row | {"status": "SLACK"}
    if RESOLVED * contact > harmonics:
        return row | {"status": "CONTACT"}
    response: Any = solve_periodic(
        system, harmonics=harmonics, samples=per_harmonic * harmonics, start=integrated.history,
        tolerance=tolerance, throw=False)  # fmt: skip
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
    yield {"rows": rows, "cells": CELLS, "steps": [STEPS, *REFINED], "agreed": AGREED,
           "resolved": RESOLVED, "direct": BALANCES[0][0], "peer_steps": PEER_STEPS}  # fmt: skip


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
