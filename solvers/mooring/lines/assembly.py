"""Arrays of the equations on a mesh, the axes in which they stand, and the forces that they leave."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ...common.outcome import InputError
from ...common.validation import one_of
from ...network.model import Node
from ..equations import Line, node_forces
from .layout import INDEX, number_nodes
from .prescribed_motion import span_motion

IN_PLANE = 1e-12  # out-of-plane parts below this share of a vector come from rounding its direction
CELL_FIELDS = ("length", "EA", "damping", "mass", "added_mass", "normal_drag", "tangential_drag")
NODE_FIELDS = ("point_mass", "point_drag", "load", "seabed_stiffness", "seabed_damping", "friction")
"""Fields of ``equations.Line`` that belong to cells, and to nodes."""


def evaluate_forces(line, y, ydot, yddot):
    """Return forces (K, N, n) on what holds the nodes, in the axes, and tensions (K, C) of the cells of a Line, N."""
    record = tuple(np.ascontiguousarray(part.transpose(2, 1, 0)) for part in (y, ydot, yddot))
    forces, tensions = np.empty(record[0].shape), np.empty((len(record[0]), line.length.size))
    node_forces(line, record, forces, tensions)
    return forces, tensions


def find_axes(model, fields, motion) -> np.ndarray:
    """Return unit vectors of the coordinates, (2, 3) or (3, 3), the last one up."""
    one_of("fields", fields, ("auto", "planar", "spatial"))
    points = model.positions
    level = max((points[:, :2] - points[0, :2])[::-1], key=lambda d: math.hypot(*d))
    run = math.hypot(*level)
    along = np.array([*(level / run), 0.0]) if run > 0 else np.array([1.0, 0.0, 0.0])
    out = np.array([-along[1], along[0], 0.0])
    forces = [np.array(point.force) for point in model.points]
    vectors = [*(points - points[0]), np.array(model.environment.current), *forces]
    vectors += [] if motion is None else list(span_motion(motion, points[model.moved]))
    planar = all(abs(v @ out) <= IN_PLANE * np.linalg.norm(v) for v in vectors)
    if fields == "planar" and not planar:
        problem = "'planar', but a point, the current or the motion leaves the line's vertical plane"
        raise InputError(problem, field="fields", value=fields)
    if fields != "spatial" and planar:
        return np.array([along, [0.0, 0.0, 1.0]])
    return np.eye(3)


def assemble_line(model, layout, axes, slip_speed, contact_depth) -> Line:
    """Return the arrays of the equations on a mesh."""
    environment, rho, of_segments = model.environment, model.environment.rho, []
    for segment in model.segments:
        cable = segment.cable
        drag = rho * cable.diameter * cable.Cdn / 2, rho * math.pi * cable.diameter * cable.Cdt / 2
        inertia = cable.mass_per_length, cable.added_mass(environment)
        of_segments.append((segment.EA, cable.damping, *inertia, *drag, segment.weight, segment.friction))
    counts = [s.size - 1 for s in layout.s]
    of_cells = np.repeat(np.transpose(of_segments), counts, axis=1)
    EA, damping, mass, added_mass, normal_drag, tangential_drag, weight, friction = of_cells
    length = np.concatenate([np.diff(s) for s in layout.s])

    def by_node(per_length):
        halves, result = per_length * length / 2, np.zeros(layout.size)
        np.add.at(result, layout.first, halves)
        np.add.at(result, layout.last, halves)
        return result

    load, everywhere = np.zeros((layout.size, len(axes))), by_node(np.ones(length.size))
    load[:, -1] -= by_node(weight)
    point_mass, point_drag = np.zeros((2, layout.size))
    for point, i in zip(model.points, layout.points.tolist(), strict=True):
        point_mass[i] += point.mass + point.Ca * rho * point.volume
        point_drag[i] += rho * point.CdA / 2
        load[i] += axes @ np.array(point.force)
        load[i, -1] -= environment.g * (point.mass - rho * point.volume)
    bed = 0.0 if environment.depth is None else environment.seabed_stiffness or 0.0
    return Line(
        layout.first, layout.last, length, EA, damping, mass, added_mass, normal_drag, tangential_drag,
        point_mass, point_drag, load, bed * everywhere,
        (environment.seabed_damping if bed else 0.0) * everywhere, by_node(friction) / everywhere,
        -math.inf if environment.depth is None else -environment.depth, slip_speed,
        tuple(float(c) for c in axes @ np.array(environment.current)), contact_depth)  # fmt: skip


def take_end_cell(system, end, element=None) -> tuple[Line, np.ndarray]:
    """Return the Line of the cell at the first (end 0) or last (end -1) node of an element, and its two nodes.

    element None: the end of a line, with all that its node carries; else of the element alone.
    """
    model, layout, line, e = system.model, system.layout, system.line, end if element is None else element
    at, cell = (slice(None, 2), layout.cells[e].start) if end == 0 else (slice(-2, None), layout.cells[e].stop - 1)
    nodes, loaded, loaded_nodes = layout.nodes[e][at], line, layout.nodes[e][at]
    if element is not None:  # nodes carry the element alone; cells are those of the line, which may be calibrated
        points = tuple(Node("free", model.points[p].r) for p in model.segments[e].ends)
        alone = replace(model, segments=(replace(model.segments[e], ends=(0, 1)),), points=points)
        own = number_nodes(alone, [layout.s[e]])
        loaded = assemble_line(alone, own, system.axes, line.slip_speed, line.contact_depth)
        loaded_nodes = own.nodes[0][at]
        if system.end_loads is not None:
            loaded.load[loaded_nodes[end]] = system.axes @ [0.0, 0.0, system.end_loads[e, end]]
    arrays = {name: getattr(line, name)[[cell]] for name in CELL_FIELDS}
    arrays |= {name: getattr(loaded, name)[loaded_nodes] for name in NODE_FIELDS}
    return line._replace(first=np.array([0], INDEX), last=np.array([1], INDEX), **arrays), nodes
