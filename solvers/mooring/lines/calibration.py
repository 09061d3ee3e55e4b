"""Cells and loads for which the exact catenaries are the discrete equilibrium: the pretension has no mesh error.

The chord of a cell is shorter than the line in it, by a part of (turn of the cell)^2/24. Where the motion changes the
tension little, the error that this makes at rest is greater than the error of the motion.
"""

from __future__ import annotations

import numpy as np

from ...common.outcome import InputError
from .mesh import FAIRLEAD_POSITIONS
from .prescribed_motion import displace_over_period

SMALL_CHANGE = 0.1  # of the tension at rest: quasi-static change over the motion below which lines are calibrated


def estimate_tension_change(model, motion, places) -> float:
    """Return the quasi-static range of the fairlead tension over a period of the motion, over that at rest."""
    displacements = np.zeros(3), *displace_over_period(model, motion, places)
    tensions = [model.pretension(displacement) for displacement in displacements]
    return float(np.ptp(tensions) / tensions[0]) if tensions[0] > 0 else np.inf


def calibrate_line(system):
    """Return the Line of a MooringSystem with cells and loads for which its nodes rest on the catenaries.

    The length of a cell is |d|/(1 + T/EA) with its chord d and the T whose level component is that of the catenary;
    the load of a node is what balances its cells. Mass, drag and added mass stay. Without a level
    component the Line as it is. Beside it the loads (k, 2) in N, upward, with which the ends of each element alone have
    the force of its catenary at rest, or None.
    """
    line, segments = system.line, system.model.segments
    r, _, horizontal_tension, states = system.model.at_rest(system.layout)
    chord = r[:, line.last] - r[:, line.first]
    level = np.hypot(chord[0], chord[1])
    if not ((horizontal_tension > 0) & (level > 0)).all():
        return line, None
    force = horizontal_tension / level * chord  # of each cell on its first node
    tension = np.linalg.norm(force, axis=0)
    length = np.linalg.norm(chord, axis=0) / (1 + tension / line.EA)
    end_loads = np.empty((len(segments), 2))
    for i, (segment, state, cells) in enumerate(zip(segments, states, system.layout.cells, strict=True)):
        first, last = (-state.V, -state.V_anchor) if segment.reversed else (state.V_anchor, state.V)  # where it rises
        end_loads[i] = first - force[2, cells.start], force[2, cells.stop - 1] - last
    load = np.zeros((3, system.nodes))
    load[:, 1:-1] = -np.diff(force, axis=1)
    load[2, [0, -1]] = end_loads[0, 0], end_loads[-1, 1]
    ratio = line.length / length  # keeps what stands at the nodes
    changed = {name: getattr(line, name) * ratio for name in ("mass", "added_mass", "normal_drag", "tangential_drag")}
    load = np.ascontiguousarray((system.axes @ load).T)
    return line._replace(length=length, load=load, **changed), end_loads


def is_to_be_calibrated(given, model, motion) -> bool:
    """Return whether a MooringModel in a motion is calibrated: as given, or for "auto" where that helps.

    Raises InputError for anything but True, False and "auto", and for True where it cannot be done.
    """
    if not (isinstance(given, (bool, np.bool_)) or given == "auto"):
        raise InputError(f"{given!r} must be 'auto', True or False", field="calibrate", value=given)
    problem = None if model.environment.depth is None else "over a seabed that would fix where the line lies"
    problem = problem if model.is_line else "it takes a single line"
    if given == "auto":
        is_periodic = problem is None and getattr(motion, "period", None) is not None
        return is_periodic and estimate_tension_change(model, motion, FAIRLEAD_POSITIONS) < SMALL_CHANGE
    if given and problem is not None:
        raise InputError(f"True, and {problem}", field="calibrate", value=given)
    return bool(given)
