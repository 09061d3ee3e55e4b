"""Initial value problems y' = f(t, y) by extrapolation of the explicit midpoint rule, for reference solutions.

One step of length H is done with n = 2, 4, ..., 2 K equal substeps of the midpoint rule, begun by an Euler step. The
error of its result has a series in (H / n)^2, so that Aitken and Neville's scheme on the K results is of order 2 K;
the difference of its last two columns estimates the error (Hairer, Norsett and Wanner, Solving Ordinary Differential
Equations I, section II.9). The K sequences are independent: they go through f as one batch.

A right side with branches is smooth while the branches are kept. Each step keeps those of its start; where a switching
function has changed its sign at the end of a step, the step is shortened to the first such event, bracketed by
regula falsi, and the next one starts with the new branches.
"""

from __future__ import annotations

import numpy as np

COLUMNS = 7
SAFETY = 0.8
SMALLEST_STEP = 1e-12  # of the interval: no smooth problem needs a shorter one
LINGERING, MOST_TRIALS = 15, 100  # regula falsi takes some eight trials; from the former on, bisection


def integrate(
    f, times, y0, *, switches=None, widths=1e-13, rtol=1e-11, atol=1e-11, columns=COLUMNS, most_steps=100_000
):
    """Return y at `times`, ndarray (len(times), n); the first of them is where y0 (n,) belongs.

    f : (t (b,), y (b, n), branches) -> y' (b, n), for a batch of b independent states
    switches : None, or (t (b,), y (b, n)) -> (b, k); branches, bool (k,), says which of them are positive, or is None
    widths : (k,) or a number, s, how closely events of each are bracketed: what lies between a bracket's beginning and
    the event is done in the wrong branch. Where y' jumps 1e-13 is not too little, where its derivative does 1e-7
    Each step's estimated error is below atol + rtol max |y| over the history of each component so far.
    Raises ArithmeticError where the step becomes too short or too many are needed.
    """
    times, y = np.asarray(times, float), np.array(y0, float)
    method = _Extrapolation(f, switches, widths, 2 * np.arange(1, columns + 1), times[-1] - times[0])
    result, t, largest = [y], times[0], np.abs(y)
    H, order = (times[1] - times[0]) / 16, 2 * columns - 1
    branches = method.branches(t, y)
    for end in times[1:]:
        while t < end:
            method.count(t, H, most_steps)
            last = t + H * 1.0001 >= end
            h = end - t if last else H
            new, error = method.step(t, y, h, branches)
            scaled = np.max(np.abs(error) / (atol + rtol * np.maximum(largest, np.abs(new))))
            factor = SAFETY * (1 / max(scaled, 1e-30)) ** (1 / order)
            if scaled > 1:
                H = h * max(min(factor, 0.7), 0.1)
                continue
            to_event, new = method.first_event(t, y, h, branches, new)
            t, y = (end if last and to_event == h else t + to_event), new
            largest, branches = np.maximum(largest, np.abs(y)), method.branches(t, y)
            # a step cut short to meet an output says little of a longer one
            H = max(H, h * min(factor, 4.0)) if last and h < H else h * min(factor, 4.0)
        result.append(y)
    return np.array(result)


class _Extrapolation:
    def __init__(self, f, switches, widths, counts, duration):
        self.f, self.switches, self.widths = f, switches, np.asarray(widths, float)
        self.counts, self.duration, self.steps = counts, duration, 0

    def count(self, t, H, most_steps):
        """Count a step; raise ArithmeticError where there are too many, or where it is too short."""
        self.steps += 1
        if self.steps > most_steps or H < SMALLEST_STEP * self.duration:
            raise ArithmeticError(f"step {H:.1e} s after {self.steps} steps at t = {t:.6g} s")

    def branches(self, t, y):
        """Return which switching functions are positive, or None."""
        return None if self.switches is None else self.switches(np.array([t]), y[None])[0] > 0

    def step(self, t, y, H, branches):
        """Return y(t + H) and an estimate of its error, with branches as given all the way."""
        counts, h = self.counts, (H / self.counts)[:, None]
        before = np.repeat(y[None], counts.size, axis=0)
        now = y + h * self.f(np.array([t]), y[None], branches)
        for step in range(1, counts[-1]):
            active = slice(step // 2, None)  # counts are 2, 4, ...: the first step // 2 sequences are complete
            slope = self.f(t + step * h[active, 0], now[active], branches)
            before[active], now[active] = now[active], before[active] + 2 * h[active] * slope
        table, last_change = list(now), now[-1]
        for column in range(1, len(table)):
            last_change = table[-1]
            for row in range(len(table) - 1, column - 1, -1):
                ratio = (counts[row] / counts[row - column]) ** 2
                table[row] = table[row] + (table[row] - table[row - 1]) / (ratio - 1)
        return table[-1], table[-1] - last_change

    def first_event(self, t, y, H, branches, new):
        """Return the length of the step to the first event, or H where there is none, and y there.

        The first root of the switching functions that have left their branches, by the Illinois variant of regula
        falsi, with bisection where that lingers. The end beyond the event is returned.
        """
        if branches is None:
            return H, new

        def margins(h, state):
            values = self.switches(np.array([t + h]), state[None])[0]
            return np.where(branches, values, np.finfo(float).tiny - values)  # zero counts as not positive

        above = margins(H, new)
        if above.min() > 0:
            return H, new
        low, high, below, side = 0.0, H, margins(0.0, y), 0
        widths = np.maximum(np.broadcast_to(self.widths, above.shape), 4 * np.spacing(abs(t) + H))
        for trial in range(MOST_TRIALS):
            left = above <= 0
            closest = widths[left].min()
            if high - low <= closest:
                break
            share = 0.5 if trial >= LINGERING else (below[left] / (below[left] - above[left])).min()
            middle = min(max(low + (high - low) * share, low + closest / 2), high - closest / 2)
            state, _ = self.step(t, y, middle, branches)
            values = margins(middle, state)
            if values.min() > 0:
                low, below, above, side = middle, values, above / 2 if side > 0 else above, 1
            else:
                high, above, below, new, side = middle, values, below / 2 if side < 0 else below, state, -1
        return high, new
