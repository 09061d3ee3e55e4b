"""Arrays of the equations on a mesh, the axes in which they stand, and the forces that they leave."""

from __future__ import annotations

import math

import numpy as np

from ...common.outcome import InputError
from ...common.validation import one_of
from ..equations import Line, node_forces
from .prescribed_motion import span_motion

IN_PLANE = 1e-12  # out-of-plane parts below this share of a vector come from rounding its direction
CELL_FIELDS = ("length", "EA", "damping", "mass", "added_mass", "normal_drag", "tangential_drag")
"""Fields of ``equations.Line`` that belong to cells."""


def evaluate_forces(line, y, ydot, yddot):
    """Return forces (K, N, n) on what holds the nodes, in the axes, and tensions (K, C) of the cells of a Line, N."""
    record = tuple(np.ascontiguousarray(part.transpose(2, 1, 0)) for part in (y, ydot, yddot))
    forces, tensions = np.empty(record[0].shape), np.empty((len(record[0]), line.length.size))
    node_forces(line, record, forces, tensions)
    return forces, tensions


def find_axes(model, fields, motion) -> np.ndarray:
    """Return unit vectors of the coordinates, (2, 3) or (3, 3), the last one up."""
    one_of("fields", fields, ("auto", "planar", "spatial"))
    points = np.array([point.r for point in model.points])
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


def assemble_line(model, layout, axes, slip_speed, contact_depth, only=None) -> Line:
    """Return the arrays of the equations on a mesh; ``only``: those of one segment, its points without a load."""
    environment, rho = model.environment, model.environment.rho
    used = range(len(model.segments)) if only is None else [only]
    length, values = np.zeros(layout.first.size), np.zeros((8, layout.first.size))
    for e, (segment, s) in enumerate(zip(model.segments, layout.s, strict=True)):
        cable, cells = segment.cable, layout.cells[e]
        length[cells] = np.diff(s)
        drag = rho * cable.diameter * cable.Cdn / 2, rho * math.pi * cable.diameter * cable.Cdt / 2
        of_cells = (segment.EA, cable.damping, cable.mass_per_length, cable.added_mass(environment), *drag)
        if e in used:
            values[:6, cells] = np.array(of_cells)[:, None]
            values[6:, cells] = [[segment.weight], [segment.friction]]
    EA, damping, mass, added_mass, normal_drag, tangential_drag, weight, friction = values
    counted = length * np.repeat(np.isin(range(len(layout.s)), used), [s.size - 1 for s in layout.s])

    def by_node(per_length):
        halves, result = per_length * counted / 2, np.zeros(layout.size)
        np.add.at(result, layout.first, halves)
        np.add.at(result, layout.last, halves)
        return result

    load = np.zeros((layout.size, len(axes)))
    load[:, -1] -= by_node(weight)
    point_mass, point_drag = np.zeros(layout.size), np.zeros(layout.size)
    for point, i in zip(model.points if only is None else (), layout.points.tolist(), strict=False):
        point_mass[i] += point.mass + point.Ca * rho * point.volume
        point_drag[i] += rho * point.CdA / 2
        load[i] += axes @ np.array(point.force)
        load[i, -1] -= environment.g * (point.mass - rho * point.volume)
    bed = 0.0 if environment.depth is None else environment.seabed_stiffness or 0.0
    everywhere = by_node(np.ones(length.size))
    with np.errstate(invalid="ignore"):
        friction = np.where(everywhere > 0, by_node(friction) / everywhere, 0.0)
    return Line(
        layout.first, layout.last, length, EA, damping, mass, added_mass, normal_drag, tangential_drag,
        point_mass, point_drag, load, bed * everywhere,
        environment.seabed_damping * everywhere if bed else np.zeros(layout.size), friction,
        -math.inf if environment.depth is None else -environment.depth, slip_speed,
        tuple(float(c) for c in axes @ np.array(environment.current)), contact_depth)  # fmt: skip


def take_end_cell(model, layout, axes, line, end, element, load=None) -> tuple[Line, np.ndarray]:
    """Return the Line of the cell at the first (end 0) or last (end -1) node of an element, and its two nodes.

    element None: the end of a line, with all that its node carries; else of the element alone. load (n,): of its end,
    where that is not its own weight, N.
    """
    e = end if element is None else element
    cells, nodes = layout.cells[e], layout.nodes[e][:2] if end == 0 else layout.nodes[e][-2:]
    c = cells.start if end == 0 else cells.stop - 1
    if element is not None:  # nodes carry the element alone; cells are those of the line, which may be calibrated
        alone = assemble_line(model, layout, axes, line.slip_speed, line.contact_depth, only=e)
        line = alone._replace(**{name: getattr(line, name) for name in CELL_FIELDS})
        if load is not None:
            line.load[nodes[end]] = load
    arrays: dict = {"first": np.array([0]), "last": np.array([1])}
    for name, value in line._asdict().items():
        if isinstance(value, np.ndarray) and name not in arrays:
            arrays[name] = value[[c]] if name in CELL_FIELDS else value[nodes]
    return line._replace(**arrays), nodes
