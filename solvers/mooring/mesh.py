"""Meshes of a moving line: unstretched arc lengths of the nodes, with one at each point where segments meet."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ..common.outcome import InputError
from ..common.validation import real_array, whole_number

FAIRLEAD_POSITIONS = 16  # of the fairlead in its motion, over which the touchdown travels
LEAST_DENSITY = 0.15  # of the greatest density of nodes
_MOST_CELLS = 10**6
_SAMPLES_PER_SEGMENT = 400  # places of a segment at which the curvature is looked at


def build_mesh(model, cells, mesh, motion) -> np.ndarray:
    """Return arc lengths (N,), m: ``mesh`` as given, "uniform", or "fitted" to the line at rest.

    Fitted: nodes as dense as the square root of the static curvature, the greatest over places of the motion.
    """
    joints = np.cumsum([0.0, *(segment.length for segment in model.segments)])
    cells = whole_number("cells", cells, max(2, len(model.segments)), _MOST_CELLS)
    if isinstance(mesh, str) and mesh == "uniform":
        s, amount = joints, joints
    elif isinstance(mesh, str) and mesh == "fitted":
        s, amount = _cumulative_density(model, joints, motion)
    elif isinstance(mesh, str):
        raise InputError(f"{mesh!r} must be 'fitted', 'uniform' or arc lengths (m)", field="mesh", value=mesh, unit="m")
    else:
        return _given(mesh, joints)
    at_joints = np.interp(joints, s, amount)
    counts = _apportion_cells(np.diff(at_joints), cells)
    pieces = [np.linspace(a, b, count + 1)[:-1] for a, b, count in zip(at_joints, at_joints[1:], counts, strict=False)]
    nodes = np.interp(np.append(np.concatenate(pieces), amount[-1]), amount, s)
    nodes[np.cumsum([0, *counts])] = joints
    return nodes


def _given(mesh, joints) -> np.ndarray:
    try:
        s = real_array(mesh)
    except (TypeError, ValueError):
        raise InputError(f"{mesh!r} must be arc lengths (m)", field="mesh", value=mesh, unit="m") from None
    length = joints[-1]
    if s.ndim != 1 or s.size < 3 or not np.isfinite(s).all() or not (np.diff(s) > 0).all():
        problem = f"must be three or more finite, increasing arc lengths (m), given {mesh!r}"
        raise InputError(problem, field="mesh", value=mesh, unit="m")
    distance = abs(s[:, None] - joints).min(axis=0)
    if distance.max() > 1e-12 * length or abs(s[-1] - length) > 1e-12 * length:
        missing = joints[distance.argmax()]
        problem = f"must run from 0 to the length, {length:g} m, with a node at each joint; none is at {missing:g} m"
        raise InputError(problem, field="mesh", value=mesh, unit="m")
    return s


def _apportion_cells(amounts, cells) -> list[int]:
    """Return whole numbers of cells in proportion to amounts, at least one each, ``cells`` in total."""
    wanted = amounts / amounts.sum() * (cells - len(amounts))
    counts = np.floor(wanted).astype(int)
    for i in np.argsort(counts - wanted)[: cells - len(amounts) - counts.sum()]:
        counts[i] += 1
    return (counts + 1).tolist()


def _cumulative_density(model, joints, motion):
    """Return fine arc lengths and the integral of the wanted density of nodes up to them."""
    period = getattr(motion, "period", None)
    places = [np.zeros(3)]
    if motion is not None and period is not None:
        places = [*motion.displacement(period * np.arange(FAIRLEAD_POSITIONS) / FAIRLEAD_POSITIONS).T, *places]
    s = [np.linspace(a, b, _SAMPLES_PER_SEGMENT) for a, b in pairwise(joints)]
    middles = [(part[1:] + part[:-1]) / 2 for part in s]
    curvature = [np.zeros(part.size) for part in middles]
    for displacement in places:
        points = model.equilibrium(displacement)
        for i, segment in enumerate(model.segments):
            local = middles[i] - joints[i]
            _, T, state = segment.profile(points[i], points[i + 1], model.environment, local)
            lying = (segment.length - local if segment.reversed else local) < state.grounded_length
            with np.errstate(all="ignore"):
                bend = np.where(lying | (T <= 0), 0.0, abs(segment.weight) * abs(state.H) / T**2)
            curvature[i] = np.fmax(curvature[i], bend)
    greatest = max(part.max() for part in curvature)
    density = [np.sqrt(np.fmax(part / greatest if greatest > 0 else 1.0, LEAST_DENSITY**2)) for part in curvature]
    steps = np.concatenate([part * np.diff(fine) for part, fine in zip(density, s, strict=True)])
    fine = np.concatenate([s[0], *(part[1:] for part in s[1:])])
    return fine, np.concatenate([[0.0], np.cumsum(steps)])
