"""Solutions of a moving network: a converged reference, and the error and run time of settings against it.

Errors are the largest over the lines of the largest difference of the tension at a fairlead end over the period, or
over the series of the motion, divided by the largest tension there.
"""

from __future__ import annotations

import time
from itertools import pairwise

import numpy as np

from solvers import ConvergenceError, Status, mooring_system, solve_periodic, solve_time_domain
from verification.registry import instants

STEPPED = ((10, 30), (10, 60), (20, 60), (20, 120), (40, 120), (40, 240), (80, 240), (80, 480), (160, 480))
"""(cells, steps in a period) of time stepping, in the order of their cost."""
BALANCED = ((10, 5), (20, 5), (20, 9), (40, 9), (40, 15), (80, 15))
"""(cells, harmonics)."""
COMPACT_BALANCED = (10, 5), (20, 9), (40, 9)
"""Those of a section of the whole report, where some networks share its time."""
MOST_FAILURES = 2  # of harmonic balance: each takes seconds, and finer meshes fail as well
LEVELS = (40, 120), (80, 240), (160, 480)
"""(cells, steps in a period) of the reference: both doubled from one to the next."""
PERIODS, REFERENCE_PERIODS = 6, 10  # of a time history, whose last one is compared
SECOND_ORDER = 3.0, 5.0  # ratios of successive changes that are extrapolated: four where the order is two
SERIES_STEPS = 120  # least steps of the duration of a motion that is no periodic one
SERIES_UNIT = 60  # of these steps stand for a period in the tables of settings
COUNT = 1000  # times at which tensions are compared, of a period; of a series at least


class Study:
    """Solutions of one network with a motion, each solved once.

    period in s, or None of a series; duration: of a history, s; unit: the time that has the steps of a setting, s.
    """

    def __init__(self, network, compact: bool = False):
        self.network, self.motion, self.compact = network, network.motion, compact
        self.period = self.motion.period
        if self.period is None:
            self.duration, spacing = _describe_series(self.motion)
            self.unit = SERIES_UNIT * min(spacing, self.duration / SERIES_STEPS)
        else:
            self.duration, self.unit = PERIODS * self.period, self.period
        self._systems, self._rows = {}, {}

    # ------------------------------------------------------------ settings
    @property
    def balanced(self):
        """Settings (cells, harmonics) of harmonic balance; none for a motion that is not periodic."""
        if self.period is None:
            return ()
        return COMPACT_BALANCED if self.compact else BALANCED

    def system(self, cells):
        """Return the system on so many cells, of the longest element or of each, with its equilibrium solved for."""
        key = cells if np.ndim(cells) == 0 else tuple(cells)
        if key not in self._systems:
            system = mooring_system(self.network, cells)
            system.rest_state()
            self._systems[key] = system
        return self._systems[key]

    def warm_up(self):
        """Compile what is compiled, which the first timings would include."""
        cells, steps = STEPPED[0]
        self._history(cells, self.unit / steps, 2 * self.unit if self.period is None else 2 * self.period)
        if self.balanced:
            solve_periodic(self.system(cells), harmonics=2, throw=False)

    def run(self, method: str, cells: int, other: int):
        """Return the history or response of a setting, whatever its status."""
        if method == "harmonic balance":
            return solve_periodic(self.system(cells), harmonics=other, throw=False)
        return self._history(cells, self.unit / other, self.duration)

    def _history(self, cells, dt, duration):
        return solve_time_domain(self.system(cells), dt=dt, duration=min(duration, self.longest), throw=False)

    @property
    def longest(self) -> float:
        """Longest duration of a history, s: a series ends, and a periodic motion does not."""
        return self.duration if self.period is None else np.inf

    def solve(self, method: str, cells: int, other: int) -> dict:
        """Return one setting from rest: seconds, status, wave (None where it failed), and the response itself."""
        key = method, cells, other
        if key not in self._rows:
            self._rows[key] = self._solve(*key)
        return self._rows[key]

    def _solve(self, method, cells, other) -> dict:
        size = {"harmonics": other} if method == "harmonic balance" else {"steps": other, "dt": self.unit / other}
        row = {"method": method, "cells": cells, **size, "seconds": None, "wave": None, "response": None}
        try:
            self.system(cells)  # its equilibrium is in no timing
            began = time.perf_counter()
            response = self.run(method, cells, other)
            row["seconds"] = time.perf_counter() - began
        except ConvergenceError as error:
            status = getattr(error.outcome, "status", Status.NO_EQUILIBRIUM_FOUND)
            return row | {"status": status.name, "sentence": str(error)}
        row |= {"status": response.status.name, "sentence": _sentence(response), "response": response}
        return row | {"wave": self.wave(response) if response.success else None}

    def ladder(self):
        """Yield the row of each setting; harmonic balance ends after MOST_FAILURES failures."""
        for cells, steps in STEPPED:
            yield self.solve("time domain", cells, steps)
        failures = 0
        for cells, harmonics in self.balanced:
            if failures < MOST_FAILURES:
                row = self.solve("harmonic balance", cells, harmonics)
                failures += row["wave"] is None
                yield row

    # ------------------------------------------------------------ tensions
    def instants(self, response) -> np.ndarray:
        """Return the times (S,) at which tensions are compared, s: of the last period, or of the series."""
        if self.period is None:
            return np.linspace(0.0, response.time[-1], max(COUNT, round(self.duration / self.unit * SERIES_UNIT)) + 1)
        return response.last_period[0] + instants(self.period, COUNT)

    def wave(self, response) -> np.ndarray:
        """Return the tension at the fairlead end of each line, (lines, S), N."""
        t = self.instants(response)
        return np.array([element.fairlead_tension(t) for element in response.elements])

    # ------------------------------------------------------------ the reference
    def reference(self) -> dict:
        """Return the converged wave, its uncertainty and how it was made; wave None where time stepping fails.

        Cells and steps are doubled twice; where the changes fall as those of a method of second order the finest waves
        are extrapolated. uncertainty: what the extrapolation changes, or else the last change, and how far the last
        two periods differ.
        """
        waves, history, counts = [], None, None
        failure = ""
        for cells, steps in LEVELS:
            counts = cells if counts is None else _doubled(counts)
            try:
                attempt = self._history(counts, self.unit / steps, self._reference_duration)
            except ConvergenceError as error:
                failure = str(error)
                break
            if not attempt.success:
                failure = _sentence(attempt)
                break
            history, setting = attempt, {"cells": cells, "steps": steps, "dt": self.unit / steps}
            counts = counts if np.ndim(counts) else _counts(history.system)
            waves.append(self.wave(history))
        if len(waves) < 2:
            return {"wave": None, "uncertainty": None, "failure": failure, "history": history}
        wave, uncertainty, extrapolated = extrapolate(waves)
        unsteady = self._unsteadiness(history)
        return {"wave": wave, "uncertainty": uncertainty + unsteady, "unsteady": unsteady, "extrapolated": extrapolated,
                "failure": failure, "history": history, **setting}  # fmt: skip

    @property
    def _reference_duration(self) -> float:
        return self.duration if self.period is None else REFERENCE_PERIODS * self.period

    def _unsteadiness(self, history) -> float:
        """Return the error of the last period but one against the last one; zero of a series."""
        if self.period is None:
            return 0.0
        last = self.instants(history)
        both = [np.array([e.fairlead_tension(t) for e in history.elements]) for t in (last - self.period, last)]
        return error_of(*both)

    def agreement(self, ladder) -> dict | None:
        """Return how far harmonic balance is from time stepping on the same cells; None where it solved nothing.

        The finest setting that it solved, beside a history of small steps: the mesh adds nothing to the difference.
        """
        solved = [row for row in ladder if row["method"] == "harmonic balance" and row["wave"] is not None]
        if not solved:
            return None
        row = max(solved, key=lambda row: (row["cells"], row["harmonics"]))
        steps = LEVELS[-1][1]
        history = self._history(row["cells"], self.unit / steps, self._reference_duration)
        if not history.success:
            return None
        difference = error_of(row["wave"], self.wave(history))
        return {"cells": row["cells"], "harmonics": row["harmonics"], "steps": steps, "difference": difference}


def extrapolate(waves) -> tuple[np.ndarray, float, bool]:
    """Return (wave, uncertainty, whether extrapolated) of two or three waves (lines, S), each finer than the last."""
    changes = [error_of(before, after) for before, after in pairwise(waves)]
    low, high = SECOND_ORDER
    if len(waves) < 3 or not low * changes[1] <= changes[0] <= high * changes[1]:
        return waves[-1], changes[-1], False
    wave = waves[2] + (waves[2] - waves[1]) / 3
    return wave, error_of(waves[2], wave), True


def error_of(wave, reference) -> float:
    """Return the largest over the lines of the largest difference over the largest tension; waves (lines, S), N."""
    return float((abs(wave - reference).max(axis=1) / abs(reference).max(axis=1)).max())


def _sentence(response) -> str:
    """Return what the status says, and of a failed step when it failed."""
    event = getattr(response, "event", None)
    return response.status.value + (f" (it failed at t = {event[0]:.4g} s)" if event else "")


def _counts(system):
    """Return the number of cells of a line, or of each element of a network."""
    counts = [s.size - 1 for s in system.layout.s]
    return sum(counts) if system.model.is_line else counts


def _doubled(counts):
    return 2 * counts if np.ndim(counts) == 0 else [2 * count for count in counts]


def _describe_series(motion) -> tuple[float, float]:
    """Return the duration of a BodyMotion from a series, and the usual spacing of its samples, s."""
    times = [part.time for part in (motion.translation, motion.rotation) if part is not None]
    return float(min(t[-1] for t in times)), float(min(np.median(np.diff(t)) for t in times))
