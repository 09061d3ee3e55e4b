"""Monodromy of a chain: dF/dydot d' + dF/dy d = 0 integrated over one period, in dense matrices.

By Radau IIA of order five (Hairer, Wanner, Solving Ordinary Differential Equations II, 1996, IV.5), which takes
algebraic rows as they are and damps what it does not resolve. Gauss's scheme of order six (ibid.) damps nothing of a
system that damps nothing, and of what it does not resolve next to nothing.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .dense import assemble


class Scheme(NamedTuple):
    """An implicit Runge-Kutta scheme of three stages: nodes (3,), weights (3, 3) of stages, last (3,) of the step."""

    nodes: np.ndarray
    weights: np.ndarray
    last: np.ndarray


def _radau() -> Scheme:
    """Return Radau IIA, order five, whose last stage is the end of the step."""
    r = np.sqrt(6.0)
    weights = np.array([
        [(88 - 7 * r) / 360, (296 - 169 * r) / 1800, (-2 + 3 * r) / 225],
        [(296 + 169 * r) / 1800, (88 + 7 * r) / 360, (-2 - 3 * r) / 225],
        [(16 - r) / 36, (16 + r) / 36, 1 / 9],
    ])  # fmt: skip
    return Scheme(np.array([(4 - r) / 10, (4 + r) / 10, 1.0]), weights, weights[-1])


def _gauss() -> Scheme:
    """Return Gauss's scheme, order six, which damps no wave however short."""
    r = np.sqrt(15.0)
    weights = np.array([
        [5 / 36, 2 / 9 - r / 15, 5 / 36 - r / 30],
        [5 / 36 + r / 24, 2 / 9, 5 / 36 - r / 24],
        [5 / 36 + r / 30, 2 / 9 + r / 15, 5 / 36],
    ])  # fmt: skip
    return Scheme(np.array([0.5 - r / 10, 0.5, 0.5 + r / 10]), weights, np.array([5 / 18, 4 / 9, 5 / 18]))


RADAU, GAUSS = _radau(), _gauss()

ENTRIES = 2**18  # of the matrices of the steps that are solved at once


def monodromy(response, steps) -> np.ndarray:
    """Return the matrix (n, n) that takes a small disturbance of a chain over one period of its response."""
    system, h, eye = response.system, response.last_period[1] / steps, np.eye(RADAU.nodes.size)
    n = len(system.fields) * system.nodes
    result, at_once = np.eye(n), max(1, ENTRIES // (eye.shape[0] * n) ** 2)
    for first in range(0, steps, at_once):
        t = h * (np.arange(first, min(first + at_once, steps))[:, None] + RADAU.nodes)
        tangents = _tangents_at(response, t.ravel())
        by_y, by_ydot = (each.reshape(n, n, *t.shape).transpose(2, 3, 0, 1) for each in tangents)
        stages = np.einsum("ij,siab->siajb", eye, by_ydot) + h * np.einsum("ij,siab->siajb", RADAU.weights, by_y)
        right = -by_y.reshape(len(t), -1, n)
        rates = np.linalg.solve(stages.reshape(len(t), right.shape[1], -1), right).reshape(by_y.shape)
        for growth in np.einsum("i,siab->sab", RADAU.last, rates):
            result = np.dot(np.eye(n) + h * growth, result)
    return result


def _tangents_at(response, t):
    """Return dF/dy and dF/dydot of the chain about its response at times t (S,), (n, n, S) each."""
    system = response.system
    state = response.at(t), response.rate_at(t), t
    start, cells, end = (part(*state) for part in (system.start, system.cells_or_empty, system.end))
    each = ((part, np.moveaxis(getattr(cells, part), 3, 1)) for part in ("dy", "dydot"))
    return tuple(assemble(getattr(start, part), between, getattr(end, part)) for part, between in each)
