"""Meshes of a cable: checked, coarsened, refined; all as unstretched arc lengths s (N,) of the nodes in m."""

from __future__ import annotations

import numpy as np

from ..common.outcome import InputError
from ..common.validation import array_of_reals, whole_number

_MOST_NODES = 10**6  # of a mesh; a state then takes 50 MB


def check_mesh(nodes, mesh, length) -> np.ndarray:
    """Return a uniform mesh of ``nodes`` nodes, or the given ``mesh``; raises InputError naming what is wrong."""
    if mesh is None:
        return np.linspace(0.0, length, whole_number("nodes", nodes, 3, _MOST_NODES))
    s = array_of_reals("mesh", mesh, f"{mesh!r} must be arc lengths (m)", "m")
    if s.ndim != 1 or s.size < 3 or not np.isfinite(s).all() or not (np.diff(s) > 0).all():
        problem = f"must be three or more finite, increasing arc lengths (m), given {mesh!r}"
        raise InputError(problem, field="mesh", value=mesh, unit="m")
    if s[0] != 0 or abs(s[-1] - length) > 1e-12 * length:
        problem = f"runs from {s[0]:g} to {s[-1]:g} m, it must run from 0 to the length, {length:g} m"
        raise InputError(problem, field="mesh", value=mesh, unit="m")
    return s


def every_second_node(nodes) -> np.ndarray:
    """Return the indices of every second of ``nodes`` nodes, and of the last one."""
    return np.append(np.arange(0, nodes - 1, 2), nodes - 1)


def refine(s, pieces) -> np.ndarray:
    """Return the mesh s (N,) with each cell cut into ``pieces`` equal ones."""
    inner = np.arange(pieces) / pieces
    return np.append((s[:-1, None] + np.diff(s)[:, None] * inner).ravel(), s[-1])


def trapezoidal_weights(ds) -> np.ndarray:
    """Return the weights (N,) of the nodes in the trapezoidal rule over cells of lengths ds (N - 1,), m."""
    weights = np.zeros(ds.size + 1)
    weights[1:] += ds / 2
    weights[:-1] += ds / 2
    return weights
