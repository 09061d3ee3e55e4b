"""Time and memory against the number of lines; run time in time and by harmonic balance against drag."""

from __future__ import annotations

import tracemalloc
from dataclasses import replace

import numpy as np

from solvers import mooring_system, solve_periodic
from solvers.io.network_scene import NamedNetwork
from solvers.numerics.threads import one_blas_thread

from ...cable.measure import exponent
from ...cable.work_precision import least_seconds
from . import systems

LINES, QUICK_LINES = (3, 10, 30, 100), (3, 10, 30)
CELLS = 50  # of a line
STEPS, PERIODS, EVERY = 120, 2, 10
"""Steps in a period, periods, and which steps are kept."""

DAMPED = ("oc3", "polyester")
DRAGS, QUICK_DRAGS = (1.0, 0.3, 0.1, 0.03, 0.01), (1.0, 0.1)
"""Of the drag coefficients of the lines."""
PERIODIC = 1e-4  # change of a tension from one period to the next, rms over its range
MOST_PERIODS, QUICK_MOST = 60, 40
MESH, STEPS_OF_MESH, HARMONICS = 20, 100, 9


def growth(quick: bool):
    """Seconds and memory of a history by lines, and the exponents of both."""
    rows = []
    with one_blas_thread(), systems.one_core():
        for lines in QUICK_LINES if quick else LINES:
            made = mooring_system(systems.farm(lines), CELLS)
            made.rest_state()
            run = lambda made=made: systems.history(made, STEPS, PERIODS, every=EVERY).body_force
            seconds, _ = least_seconds(run)
            rows.append({"lines": lines, "nodes": made.nodes, "seconds": seconds, "memory": peak_memory(run)})
            yield None
    growing = {"seconds": exponent(rows, "lines", 0),
               "memory": exponent([{**row, "seconds": row["memory"]} for row in rows], "lines", 0)}  # fmt: skip
    yield {"rows": rows, "cells": CELLS, "steps": STEPS, "periods": PERIODS, "every": EVERY, "exponents": growing}


def peak_memory(run) -> int:
    """Return the most bytes that a call has at once beyond what is there before it: arrays of numpy and objects."""
    tracemalloc.start()
    try:
        run()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def damping(quick: bool):
    """Seconds until a motion is periodic, by the share of the drag, and those of harmonic balance."""
    rows = []
    with one_blas_thread(), systems.one_core():
        for name in DAMPED[:1] if quick else DAMPED:
            for drag in QUICK_DRAGS if quick else DRAGS:
                rows.append(at_drag(name, drag, QUICK_MOST if quick else MOST_PERIODS))
                yield None
    yield {"rows": rows, "periodic": PERIODIC, "most_periods": QUICK_MOST if quick else MOST_PERIODS, "cells": MESH,
           "steps": STEPS_OF_MESH, "harmonics": HARMONICS}  # fmt: skip


def with_drag(network, share: float) -> NamedNetwork:
    """Return a network whose lines have a share of their drag coefficients."""

    def changed(element):
        cable = element.cable
        return replace(element, cable=replace(cable, Cdn=share * cable.Cdn, Cdb=None, Cdt=share * cable.Cdt))

    return replace(network, elements=tuple(changed(element) for element in network.elements))


def at_drag(name: str, drag: float, most: int) -> dict:
    """Return periods and seconds until the motion is periodic, those of harmonic balance, and how far they differ.

    Both on one mesh, so that a difference is of time step and harmonics alone.
    """
    network = with_drag(systems.network(name), drag)
    made = mooring_system(network, MESH, mesh="uniform")
    made.rest_state()
    periods, settled = periods_until_periodic(made, most)
    row = {"system": name, "title": network.name, "drag": drag, "periods": periods, "in_time": None}
    if periods is not None:
        row["in_time"], _ = least_seconds(lambda: _tensions(made, periods))
    run = lambda: solve_periodic(made, harmonics=HARMONICS, throw=False)
    row["balance"], response = least_seconds(run)
    row["status"], row["difference"] = response.status.name, None
    if response.success and periods is not None:
        row["difference"] = systems.differences(settled, systems.periodic_tensions(response))["rms"]
    return row


def _tensions(made, periods):
    return systems.our_tensions(systems.history(made, STEPS_OF_MESH, periods), STEPS_OF_MESH)


def periods_until_periodic(made, most: int):
    """Return how many periods a history takes to be periodic to PERIODIC (None: not in ``most``), and the tensions.

    The tensions (P, S), N, are those of its last period.
    """
    run = systems.history(made, STEPS_OF_MESH, most)
    forces = run.forces[:, made.coupled_nodes, : most * STEPS_OF_MESH]
    waves = np.linalg.norm(forces, axis=0).reshape(-1, most, STEPS_OF_MESH).swapaxes(0, 1)
    return settling_count(waves), waves[-1]


def settling_count(waves) -> int | None:
    """Return how many periods pass until each differs from the next by no more than PERIODIC; None: they never do.

    waves (periods, P, S): tensions of each period, N.
    """
    size = np.ptp(waves[-1], axis=-1)
    change = (np.sqrt((np.diff(waves, axis=0) ** 2).mean(axis=-1)) / size).max(axis=-1)
    late = np.flatnonzero(~(change <= PERIODIC))
    first = int(late[-1]) + 3 if late.size else 2
    return first if first <= len(waves) else None
