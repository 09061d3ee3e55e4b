"""Networks taken apart where only prescribed nodes join them: each part moves by itself, as the body's motion is given.

Each part has steps and Newton iterations of its own, the parts are solved side by side, and harmonic balance holds the
factors of one part at a time.
"""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from .layout import number_nodes

WORK_FOR_THREADS = 2e5  # nodes times steps from which a second thread gains more than it costs


@dataclass(frozen=True)
class Component:
    """A part of a network: its MooringSystem, and which of the network its own nodes, cells and moved points are."""

    system: Any
    nodes: np.ndarray
    cells: np.ndarray
    moved: list[int]


def split_system(system) -> tuple[Component, ...]:
    """Return the parts of a MooringSystem that no free point joins, or none where it is one part."""
    model = system.model
    count, points = len(model.segments), len(model.points)
    joins = [(e, p) for e, segment in enumerate(model.segments) for p in segment.ends if model.points[p].kind == "free"]
    rows, columns = np.array(joins, dtype=int).reshape(-1, 2).T
    joined = coo_array((np.ones(len(joins)), (rows, count + columns)), shape=(count + points,) * 2)
    labels = connected_components(joined, directed=False)[1][:count].tolist()
    groups = [[e for e, label in enumerate(labels) if label == one] for one in dict.fromkeys(labels)]
    return tuple(_component(system, group) for group in groups) if len(groups) > 1 else ()


def _component(system, group) -> Component:
    model, layout = system.model, system.layout
    used = sorted({p for e in group for p in model.segments[e].ends})
    index = {p: i for i, p in enumerate(used)}
    segments = tuple(replace(model.segments[e], ends=tuple(index[p] for p in model.segments[e].ends)) for e in group)
    name = f"{model.name}, element{'s' if len(group) > 1 else ''} {', '.join(str(e + 1) for e in group)}"
    part = replace(model, segments=segments, points=tuple(model.points[p] for p in used), name=name)
    own = number_nodes(part, [layout.s[e] for e in group])
    nodes = np.empty(own.size, dtype=int)
    for e, own_nodes in zip(group, own.nodes, strict=True):
        nodes[own_nodes] = layout.nodes[e]
    cells = np.concatenate([np.arange(layout.first.size)[layout.cells[e]] for e in group])
    source = None if system.source is None else lambda t: system.source(t)[:, nodes]
    built = type(system)(part, own, system.axes, system.motion, system.seabed, source, system.period)
    built.origin = system.origin
    return Component(built, nodes, cells, [i for i, p in enumerate(model.moved) if p in index])


def integrate_components(system, build_history, *, start=None, progress=None, **settings):
    """Return the MooringHistory of a network from those of its components, integrated side by side.

    settings: of ``MooringSystem.integrate``. It ends where the first of them fails.
    """
    parts, reached, ramp = system.components, {}, settings["ramp"]
    moved, times = system.ramped(ramp) if ramp else system, settings["dt"] * np.arange(settings["count"] + 1)
    path = moved.path(times)  # of the body, once for all parts
    column = np.empty(system.nodes, dtype=int)  # of a prescribed node in the path
    column[system.prescribed_nodes] = np.arange(system.prescribed_nodes.size)

    def integrate(part):
        own_path = np.ascontiguousarray(path[:, :, column[part.nodes[part.system.prescribed_nodes]]])
        own_start = None if start is None else [None if y is None else y[:, part.nodes] for y in start]
        report = None
        if progress is not None:

            def report(t):
                reached[id(part)] = t
                if len(reached) == len(parts):
                    progress(min(reached.values()))

        return part.system.integrate(start=own_start, progress=report, path=own_path, **settings)

    histories = _side_by_side(integrate, parts, system.nodes * settings["count"])
    shortest = min(histories, key=lambda history: history.steps)
    steps, time = shortest.steps, shortest.time
    if not shortest.success:  # the others are not stored where it ends between two stored steps
        time = time[: steps // settings["every"] + 1]
    series = []
    for name in ("y", "ydot", "yddot"):
        whole = np.empty((time.size, system.nodes, len(system.axes)))  # as the steps store it
        for part, history in zip(parts, histories, strict=True):
            whole[:, part.nodes] = getattr(history, name).T[: time.size]
        series.append(whole.T)
    failed = [(history, part) for history, part in zip(histories, parts, strict=True) if not history.success]
    first, part = min(failed, key=lambda pair: pair[0].event[0], default=(shortest, None))
    event = None if part is None else (first.event[0], int(part.nodes[first.event[1]]))
    damped = [history.damped_from for history in histories if history.damped_from is not None]
    counts = (sum(getattr(history, name) for history in histories) for name in ("iterations", "factorisations"))
    error, cut = max(history.residual_norm for history in histories), sum(history.cut for history in histories)
    return build_history(
        system, moved, time, *series, first.status, *counts, error, steps, cut, min(damped, default=None), ramp, event,
        {"start": start, **settings})  # fmt: skip


def _side_by_side(call, parts, work) -> list:
    if work < WORK_FOR_THREADS:
        return [call(part) for part in parts]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(call, parts))


def merge_responses(system, responses):
    """Return the MooringResponse of a network from those of its components.

    The first that failed decides its status and the amplitude that was reached; Newton steps are added up.
    """
    worst = min(responses, key=lambda response: (response.success, response.amplitude))
    z = np.empty((len(system.axes), system.nodes, worst.basis.harmonic.size))
    for part, response in zip(system.components, responses, strict=True):
        z[:, part.nodes] = response.z
    counts = {name: sum(getattr(r, name) for r in responses) for name in ("iterations", "coarse_iterations")}
    norm = max(response.residual_norm for response in responses)
    return replace(worst, system=system, z=z, residual_norm=norm, **counts)
