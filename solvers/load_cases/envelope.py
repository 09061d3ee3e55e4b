"""Extremes of tension along the lines over a load case, and where the lines are at some times of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..mooring.equations import node_forces
from .integration import integrate_case


@dataclass(frozen=True)
class LineEnvelope:
    """One line over a case: middles s (C,) of its cells in m from the anchor end, and least, mean and greatest tension.

    low, mean, high (C,) in N, over the case after its ramp; rest (3, N) in m, undisplaced; poses (K, 3, N) in m at the
    times that were asked for.
    """

    s: np.ndarray
    low: np.ndarray
    mean: np.ndarray
    high: np.ndarray
    rest: np.ndarray
    poses: np.ndarray


def find_envelopes(given, case, *, dt, cells, times) -> list[LineEnvelope]:
    """Return a LineEnvelope for each line of a LoadCase, which is integrated as ``integrate_case`` does.

    times (K,) in s from the end of the ramp, of the poses. Raises what ``integrate_case`` raises, and ValueError where
    the case ends early.
    """
    watchers: dict[int, _Watcher] = {}

    def watch(number, part, element, count):
        steps = np.round(np.asarray(times) / case.duration * count).astype(int)
        watchers[number] = _Watcher(part, element, np.clip(steps, 0, count - 1))
        return watchers[number]

    series = integrate_case(given, case, dt=dt, cells=cells, watch=watch)
    if not series.lines:
        raise ValueError(f"the case ended at {series.event}")
    return [watchers[number].envelope() for number in sorted(watchers)]


class _Watcher:
    """Looks at the states of element e of a part (None: the part is one line); keeps extremes, sums and some poses.

    steps (K,): numbers of the states whose positions are kept, in any order.
    """

    def __init__(self, part, e, steps):
        self.part, self.steps, self.at = part, steps, 0
        layout = part.layout
        chosen = range(len(layout.s)) if e is None else [e]
        self.cells = np.concatenate([np.arange(layout.cells[i].start, layout.cells[i].stop) for i in chosen])
        self.nodes = np.concatenate([layout.nodes[i][int(i != chosen[0]) :] for i in chosen])
        self.s = part.s if e is None else layout.s[e]
        self.low, self.high = np.full(self.cells.size, np.inf), np.full(self.cells.size, -np.inf)
        self.total, self.poses = np.zeros(self.cells.size), np.empty((steps.size, len(part.axes), self.nodes.size))

    def look(self, r, v, a):
        """Take states (k, N, n) of the part."""
        forces, tension = np.empty_like(r), np.empty((len(r), self.part.line.length.size))
        node_forces(self.part.line, (r, v, a), forces, tension)
        own = tension[:, self.cells]
        self.low, self.high = np.minimum(self.low, own.min(axis=0)), np.maximum(self.high, own.max(axis=0))
        self.total += own.sum(axis=0)
        here = (self.at <= self.steps) & (self.steps < self.at + len(r))
        self.poses[here] = r[self.steps[here] - self.at][:, self.nodes].transpose(0, 2, 1)
        self.at += len(r)

    def envelope(self) -> LineEnvelope:
        """Return what was kept."""
        moved = self.part.positions(self.poses.transpose(1, 2, 0))
        middles = (self.s[1:] + self.s[:-1]) / 2
        return LineEnvelope(middles, self.low, self.total / self.at, self.high, self.part.rest.r[:, self.nodes],
                            np.moveaxis(moved, -1, 0))  # fmt: skip
