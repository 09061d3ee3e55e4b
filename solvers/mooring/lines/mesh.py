"""Meshes of moving lines: unstretched arc lengths of the nodes of each segment, one at either end."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from ...common.outcome import InputError
from ...common.validation import array_of_reals, whole_number
from .prescribed_motion import displace_over_period

FAIRLEAD_POSITIONS = 16  # of the fairlead in its motion, over which the touchdown travels
FEWEST_CELLS = 6  # of an element of a network that is short beside the longest
LEAST_DENSITY = 0.15  # of the greatest density of nodes
TOUCHDOWN_DENSITY = 3.0  # of nodes where the touchdown travels, over the greatest that curvature asks for
TOUCHDOWN_REACH = 0.03  # of the length: distance from there in which the surplus falls to a half
_MOST_CELLS = 10**6
_SAMPLES_PER_SEGMENT = 400  # places of a segment at which the curvature is looked at


def build_mesh(model, cells, mesh, motion) -> list[np.ndarray]:
    """Return arc lengths of the nodes of each segment from its first point, m: as given, or of a kind.

    "uniform"; "fitted"; "touchdown": fitted, and denser where the touchdown travels, whose contact errs by the spacing
    of the nodes there while a hanging line of the same accuracy has few of them.

    cells: of a line in total; of a network those of its longest element, the others in proportion to their length, or
    one number for each element. Fitted: nodes as dense as the square root of the curvature at rest, the greatest over
    places of the motion.
    """
    lengths = [segment.length for segment in model.segments]
    if not isinstance(mesh, str):
        return _given_line(mesh, lengths) if model.is_line else _given_elements(mesh, lengths)
    if mesh == "uniform":
        fine = amount = [np.array([0.0, length]) for length in lengths]
    elif mesh in ("fitted", "touchdown"):
        fine, amount = _cumulative_density(model, lengths, motion, at_touchdown=mesh == "touchdown")
    else:
        problem = f"{mesh!r} must be 'fitted', 'touchdown', 'uniform' or arc lengths (m)"
        raise InputError(problem, field="mesh", value=mesh, unit="m")
    counts = _counts(model, cells, np.array([part[-1] for part in amount]))
    return [
        np.interp(np.linspace(0.0, part[-1], count + 1), part, s)
        for s, part, count in zip(fine, amount, counts, strict=True)
    ]


def _counts(model, cells, amounts) -> list[int]:
    """Return how many cells each segment has; at least two in a network, so that no two cells join the same nodes."""
    segments = model.segments
    if model.is_line:
        return _apportion_cells(amounts, whole_number("cells", cells, max(2, len(segments)), _MOST_CELLS))
    if np.ndim(cells) == 0:
        most = whole_number("cells", cells, 2, _MOST_CELLS)
        longest = max(segment.length for segment in segments)
        fewest = min(FEWEST_CELLS, most)
        return [max(fewest, math.ceil(most * segment.length / longest * (1 - 1e-12))) for segment in segments]
    if len(cells) != len(segments):
        problem = f"{len(cells)} numbers must be one, or one for each of the {len(segments)} elements"
        raise InputError(problem, field="cells", value=cells)
    return [whole_number(f"cells[{i}]", count, 2, _MOST_CELLS) for i, count in enumerate(cells)]


def _given_elements(mesh, lengths) -> list[np.ndarray]:
    if len(mesh) != len(lengths):
        problem = f"{len(mesh)} meshes must be one for each of the {len(lengths)} elements"
        raise InputError(problem, field="mesh", value=mesh, unit="m")
    return [_given_line(part, [length])[0] for part, length in zip(mesh, lengths, strict=True)]


def _given_line(mesh, lengths) -> list[np.ndarray]:
    s = array_of_reals("mesh", mesh, f"{mesh!r} must be arc lengths (m)", "m")
    joints = np.cumsum([0.0, *lengths])
    length = joints[-1]
    if s.ndim != 1 or s.size < 3 or not np.isfinite(s).all() or not (np.diff(s) > 0).all():
        problem = f"must be three or more finite, increasing arc lengths (m), given {mesh!r}"
        raise InputError(problem, field="mesh", value=mesh, unit="m")
    distance = abs(s[:, None] - joints)
    if distance.min(axis=0).max() > 1e-12 * length or abs(s[-1] - length) > 1e-12 * length:
        missing = joints[distance.min(axis=0).argmax()]
        problem = f"must run from 0 to the length, {length:g} m, with a node at each joint; none is at {missing:g} m"
        raise InputError(problem, field="mesh", value=mesh, unit="m")
    at = distance.argmin(axis=0)
    return [s[a : b + 1] - s[a] for a, b in pairwise(at)]


def _apportion_cells(amounts, cells) -> list[int]:
    """Return whole numbers of cells in proportion to amounts, at least one each, ``cells`` in total."""
    wanted = amounts / amounts.sum() * (cells - len(amounts))
    counts = np.floor(wanted).astype(int)
    for i in np.argsort(counts - wanted)[: cells - len(amounts) - counts.sum()]:
        counts[i] += 1
    return (counts + 1).tolist()


def _cumulative_density(model, lengths, motion, at_touchdown=False):
    """Return fine arc lengths of each segment and the integral of the wanted density of nodes up to them."""
    displacements = [np.zeros(3)]
    if getattr(motion, "period", None) is not None:
        displacements = [*displace_over_period(model, motion, FAIRLEAD_POSITIONS), *displacements]
    fine = [np.linspace(0.0, length, _SAMPLES_PER_SEGMENT) for length in lengths]
    curvature = [np.zeros(part.size - 1) for part in fine]
    grounded: list[list[float]] = [[] for _ in lengths]
    for displacement in displacements:
        points = model.equilibrium(displacement)
        for i, (segment, s) in enumerate(zip(model.segments, fine, strict=True)):
            local = (s[1:] + s[:-1]) / 2
            _, T, state = segment.profile(*(points[end] for end in segment.ends), model.environment, local)
            lying = (segment.length - local if segment.reversed else local) < state.grounded_length
            with np.errstate(all="ignore"):
                bend = np.where(lying | (T <= 0), 0.0, abs(segment.weight) * abs(state.H) / T**2)
            curvature[i] = np.fmax(curvature[i], bend)
            grounded[i].append(state.grounded_length)
    greatest = max(part.max() for part in curvature)
    density = [np.sqrt(np.fmax(part / greatest if greatest > 0 else 1.0, LEAST_DENSITY**2)) for part in curvature]
    if at_touchdown:
        for segment, s, part, touchdown in zip(model.segments, fine, density, grounded, strict=True):
            part += _surplus(segment, (s[1:] + s[:-1]) / 2, min(touchdown), max(touchdown))
    return fine, [np.append(0.0, np.cumsum(part * np.diff(s))) for part, s in zip(density, fine, strict=True)]


def _surplus(segment, s, nearest, farthest):
    """Return the surplus of the density at arc lengths s of a segment whose touchdown lies between two lengths, m."""
    if not 0 < farthest or nearest >= segment.length:  # it never lies, or it lies as a whole
        return np.zeros_like(s)
    local = segment.length - s if segment.reversed else s
    away = np.fmax(np.fmax(nearest - local, local - farthest), 0.0)
    return TOUCHDOWN_DENSITY / (1 + away / (TOUCHDOWN_REACH * segment.length))
