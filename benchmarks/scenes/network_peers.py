"""A moving network by other codes: forces on the coupled nodes beside those of this project, at a setting or two.

A code without friction of the seabed is compared on a smooth one, on which this project is run anew.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from solvers import mooring_system, solve_network, solve_time_domain

from .. import peers
from ..network.systems import without_friction
from ..run import harness
from .network_study import Study, error_of

SETTINGS, COMPACT_SETTINGS = ((10, 200), (20, 200)), ((20, 200),)
"""(cells of the longest line, coupling steps in a period)."""
OUR_CELLS, OUR_STEPS = 80, 2  # beside them; steps of this project in one of a coupling
START_SHARE = 0.1  # of a series, which is not compared
MOST_STEPS = 20_000  # of a coupling, beyond which others are not asked for a series


def rows(study: Study) -> Iterator[dict]:
    """Yield a row for each code and setting: status, seconds, error, and extremes of the force on each coupled node."""
    smooth = replace_friction(study.network)
    ours: dict[int, np.ndarray] = {}
    for adapter in peers.solving("moving_network").values():
        for cells, steps in COMPACT_SETTINGS if study.compact else SETTINGS:
            row, tension = _ask(adapter, study, smooth, cells, steps)
            if tension is not None:
                if steps not in ours:
                    ours[steps] = _our_tension(study, smooth, steps)
                row |= compare(tension, ours[steps])
            yield row
            if tension is None:
                break


def static_rows(network) -> Iterator[dict]:
    """Yield a row for each code that solves networks at rest: seconds, tension of each line beside ours, N."""
    smooth = replace_friction(network)
    state = solve_network(smooth)
    ours = np.hypot(state.H, state.V)
    for adapter in peers.solving("network").values():
        began = time.perf_counter()
        call, who = (lambda adapter=adapter: _solved(adapter, smooth)), f"{adapter.name}, networks at rest"
        made, kind, message = harness.attempt(call, adapter.limit("network"), who)
        row = {"method": adapter.label, "seconds": time.perf_counter() - began, "sentence": message[:200],
               "smooth": smooth is not network, "tension": None, "ours": ours}  # fmt: skip
        if not kind:
            made, kind, message = harness.checked(made, (len(ours), 2))
        yield row | ({"status": kind.upper(), "sentence": message[:200]} if kind else
                     {"status": "SUCCESS", "tension": np.asarray(made)[:, 1]})  # fmt: skip


def _solved(adapter, network):
    answer = adapter.network(network)
    return answer() if callable(answer) else answer


def replace_friction(network):
    """Return the network on a smooth seabed; itself where it has no friction."""
    return without_friction(network) if any(element.friction for element in network.elements) else network


def compare(theirs, ours) -> dict:
    """Return the error of tensions (P, S) in N and the extremes of both at each coupled node, N."""
    nodes = [{"max": t.max(), "min": t.min(), "our_max": o.max(), "our_min": o.min()}
             for t, o in zip(theirs, ours, strict=True)]  # fmt: skip
    return {"error": error_of(theirs, ours), "nodes": nodes}


def _times(study: Study, steps: int) -> np.ndarray:
    """Return the times of the coupling, s, evenly spaced from 0."""
    count = round(study.duration / (study.unit / steps))
    return np.linspace(0.0, study.duration, count + 1)


def _window(study: Study, steps: int, values) -> np.ndarray:
    """Return what is compared of values (..., K) at the times of the coupling: the last period, or most of a series.

    At its start codes differ in how they take a body that moves at once.
    """
    if study.period is None:
        return values[..., round(START_SHARE * values.shape[-1]) :]
    return values[..., -1 - steps : -1]


def _ask(adapter, study: Study, network, cells: int, steps: int):
    """Return the row of a code, and its tensions (P, S) in N or None."""
    t = _times(study, steps)
    row = {"method": adapter.label, "cells": cells, "steps": steps, "dt": study.unit / steps, "seconds": None,
           "error": None, "smooth": network is not study.network}  # fmt: skip
    if t.size > MOST_STEPS:
        return row | {"status": "UNSUPPORTED", "sentence": f"the series is longer than {MOST_STEPS} steps"}, None
    motion = study.motion if study.period is None else study.motion.ramped(study.period / 2)
    counts = [s.size - 1 for s in mooring_system(network, cells).layout.s]
    began = time.perf_counter()
    forces, kind, message = harness.attempt(
        lambda: adapter.moving_network(network, motion, t, counts),
        adapter.limit("cable"),
        f"{adapter.name}, moving networks",
    )
    row["seconds"] = time.perf_counter() - began
    if not kind:
        coupled = sum(node.kind == "coupled" for node in network.nodes)
        forces, kind, message = harness.checked(forces, (coupled, 3, t.size))
    if kind:
        return row | {"status": kind.upper(), "sentence": message[:200]}, None
    tension = np.linalg.norm(_window(study, steps, forces), axis=1)
    return row | {"status": "SUCCESS", "sentence": f"{adapter.label} {adapter.version}"}, tension


def _our_tension(study: Study, network, steps: int) -> np.ndarray:
    """Return the force of this project on each coupled node at the times of the coupling, (P, S), N."""
    system = mooring_system(replace(network, motion=study.motion), OUR_CELLS)
    history = solve_time_domain(system, dt=study.unit / (OUR_STEPS * steps), duration=study.duration)
    forces = history.forces[:, system.coupled_nodes][..., ::OUR_STEPS]
    return np.linalg.norm(_window(study, steps, forces), axis=0)
