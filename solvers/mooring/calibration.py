"""Cells and loads for which the exact catenaries are the discrete equilibrium: the pretension has no mesh error.

The chord of a cell is shorter than the line in it, by a part of (turn of the cell)^2/24. Where the motion changes the
tension little, the error that this makes at rest is greater than the error of the motion.
"""

from __future__ import annotations

import numpy as np

SMALL_CHANGE = 0.1  # of the tension at rest: quasi-static change over the motion below which lines are calibrated


def tension_change(model, motion, places) -> float:
    """Return the quasi-static range of the fairlead tension over a period of the motion, over that at rest."""
    times = motion.period * np.arange(places) / places
    tensions = []
    for displacement in (np.zeros(3), *motion.displacement(times).T):
        points = model.equilibrium(displacement)
        state = model.segments[-1].profile(points[-2], points[-1], model.environment, np.zeros(1))[2]
        tensions.append(state.tension)
    return float(np.ptp(tensions) / tensions[0]) if tensions[0] > 0 else np.inf


def calibrated_line(system):
    """Return the Line of a MooringSystem with cells and loads for which its nodes rest on the catenaries.

    The length of a cell is |d|/(1 + T/EA) with its chord d and the T whose level component is that of the catenary;
    the load of a node is what balances its cells. Mass, drag and added mass stay. Without a level
    component the Line as it is.
    """
    line, model, joint = system.line, system.model, 0.0
    points = model.equilibrium()
    r, pull = np.zeros((3, system.nodes)), np.zeros(system.nodes - 1)
    middles = (system.s[1:] + system.s[:-1]) / 2
    ends = []
    for segment, start, end in zip(model.segments, points[:-1], points[1:], strict=True):
        at = (system.s >= joint - 1e-9 * segment.length) & (system.s <= joint + segment.length * (1 + 1e-9))
        local = np.clip(system.s[at] - joint, 0.0, segment.length)
        r[:, at], _, state = segment.profile(start, end, model.environment, local)
        pull[(middles > joint) & (middles < joint + segment.length)] = state.H
        ends.append(state)
        joint += segment.length
    r[:, [0, -1]] = np.transpose([points[0], points[-1]])
    chord = np.diff(r, axis=1)
    level = np.hypot(chord[0], chord[1])
    if not ((pull > 0) & (level > 0)).all():
        return line
    force = pull / level * chord  # of each cell on its first node
    tension = np.linalg.norm(force, axis=0)
    length = np.linalg.norm(chord, axis=0) / (1 + tension / line.EA)
    load = np.zeros((3, system.nodes))
    load[:, 1:-1] = -np.diff(force, axis=1)
    first, last, flip = ends[0], ends[-1], model.segments
    anchor_V = -first.V if flip[0].reversed else first.V_anchor
    fairlead_V = -last.V_anchor if flip[-1].reversed else last.V
    load[2, 0] = anchor_V - force[2, 0]
    load[2, -1] = -fairlead_V + force[2, -1]
    same = line.length / length
    changed = {name: getattr(line, name) * same for name in ("mass", "added_mass", "normal_drag", "tangential_drag")}
    return line._replace(length=length, load=np.ascontiguousarray((system.axes @ load).T), **changed)
