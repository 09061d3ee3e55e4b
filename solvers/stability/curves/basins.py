"""Basins of attraction: which of several coexisting responses random starts come to, by time integration.

Starts are seeded: a state is the rest state and a sum of the departures of all responses from it, each at a random
instant of its period, by normal weights, so that it is a smooth shape of the size of the responses. The share of a
response is the part of the starts that come to it, with E. B. Wilson's interval (J. Am. Stat. Assoc. 22, 1927, 209).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from ...common.outcome import InputError
from ...common.validation import positive_number, whole_number
from ...harmonic_balance.response import PeriodicResponse
from ...harmonic_balance.solve import solve_periodic
from ...time_domain.solve import solve_time_domain
from .tracing import as_response

NEAR = 0.05  # of the distance to the nearest other response, within which a state has come to a response
PERIODS_AT_ONCE = 10  # between two looks at the state; it must be near the same response at two of them
MAX_COUNT = 10**6
SAME = 1e-6  # of the largest coefficient, within which two responses are one
Z_95 = 1.959963984540054  # of the normal distribution: intervals hold the share in 95 of 100 cases


@dataclass(frozen=True)
class BasinShares:
    """Where K starts lead, for R responses of one system.

    landed (K,): number of the response that each start comes to, -1 where it comes to none in the periods that it has.
    shares (R,): parts of the starts; intervals (R, 2): their 95 % confidence intervals. unsettled: starts with -1.
    starts: (y, ydot) of each. responses: as they were given.
    """

    responses: tuple = field(repr=False)
    landed: np.ndarray = field(repr=False)
    shares: np.ndarray
    intervals: np.ndarray
    unsettled: int
    starts: tuple = field(repr=False)


def find_basins(
    responses, *, count: int = 100, spread: float = 1.0, seed: int = 0, periods: int = 400, steps: int = 200
) -> BasinShares:
    """Return the BasinShares of responses of one system, as ``responses_at`` finds them.

    count: of the starts; spread: standard deviation of the weights by which departures of the responses are added;
    periods: most that a start is followed; steps: of the time integration in a period.
    Raises InputError for fewer than two responses, for responses of different systems, or bad numbers.

    >>> basins = find_basins(responses_at(curve, 1.2), count=50)  # doctest: +SKIP
    >>> basins.shares, basins.intervals  # doctest: +SKIP
    """
    responses = tuple(responses)
    if len(responses) < 2 or not all(isinstance(each, PeriodicResponse) for each in responses):
        raise InputError("must be two or more PeriodicResponses", field="responses", value=responses)
    period = responses[0].system.period
    if not all(math.isclose(each.system.period, period, rel_tol=SAME) for each in responses):
        raise InputError("must be of one system, driven at one frequency", field="responses", value=responses)
    K, steps = whole_number("count", count, 1, MAX_COUNT), whole_number("steps", steps, 4, MAX_COUNT)
    periods, spread = whole_number("periods", periods, 1, MAX_COUNT), positive_number("spread", spread, "(of a weight)")
    rng = np.random.default_rng(whole_number("seed", seed, 0))
    starts = tuple(draw_start(responses, spread, rng) for _ in range(K))
    landed = np.array([find_landing(responses, start, periods=periods, steps=steps) for start in starts])
    hits = np.array([(landed == r).sum() for r in range(len(responses))])
    intervals = np.array([wilson_interval(int(n), K) for n in hits])
    return BasinShares(responses, landed, hits / K, intervals, int((landed < 0).sum()), starts)


def draw_start(responses, spread, rng):
    """Return a random start (y, ydot) about the rest state, of the size of the responses."""
    rest = responses[0].system.rest_state()
    y, ydot = rest.copy(), np.zeros_like(rest)
    for response in responses:
        weight, t = spread * rng.normal(), np.array([rng.uniform(0.0, response.last_period[1])])
        y = y + weight * (response.at(t)[..., 0] - rest)
        ydot = ydot + weight * _rate_at(response, t)[..., 0]
    return y, ydot


def find_landing(responses, start, *, periods: int = 400, steps: int = 200) -> int:
    """Return the number of the response that time integration from a start (y, ydot) comes to, -1 where to none.

    Raises nothing where a step fails: such a start comes to no response.
    """
    system, longest = responses[0].system, max(each.subharmonic for each in responses)
    chunk, last = PERIODS_AT_ONCE * longest, -1
    metric, is_line = _Metric(responses), hasattr(system, "integrate")
    for _ in range(math.ceil(periods / chunk)):
        begin = start if is_line else (start[0], None)  # the rates of a chain are those that its rows leave
        history = solve_time_domain(system, dt=system.period / steps, duration=chunk * system.period, start=begin,
                                    every=steps, throw=False)  # fmt: skip
        if not history.success:
            return -1
        start = history.y[..., -1], history.ydot[..., -1]
        now = metric.nearest(start)
        if now >= 0 and now == last:
            return now
        last = now
    return -1


def wilson_interval(hits: int, count: int, z: float = Z_95) -> tuple[float, float]:
    """Return Wilson's interval of a share of which ``hits`` of ``count`` trials were counted; z: 1.96 for 95 %.

    >>> [round(end, 4) for end in wilson_interval(5, 10)]
    [0.2366, 0.7634]
    """
    share = hits / count
    centre, width = share + z * z / (2 * count), z * math.sqrt(share * (1 - share) / count + (z / (2 * count)) ** 2)
    low, high = ((centre + sign * width) / (1 + z * z / count) for sign in (-1, 1))
    return low if hits else 0.0, high if hits < count else 1.0


def responses_at(curve, value) -> list[PeriodicResponse]:
    """Return the responses of a ResponseCurve at a value of its parameter, in the order of the curve.

    Each is solved for from the curve between its two neighbours; one that Newton's method does not come to is left out.
    Raises InputError where the curve does not pass the value.
    """
    crossings = np.flatnonzero((curve.values[:-1] - value) * (curve.values[1:] - value) <= 0)
    if not crossings.size:
        problem = f"the curve from {curve.values.min():g} to {curve.values.max():g} does not pass {value:g}"
        raise InputError(problem, field="value", value=value)
    distinct: list[PeriodicResponse] = []
    for i in crossings:
        response = _solve_between(curve, int(i), float(value))
        if response is not None and not any(_are_same(response, other) for other in distinct):
            distinct.append(response)
    return distinct


def _solve_between(curve, i, value):
    """Return the response at a value between the points i and i + 1 of a curve, or None."""
    Nh = int(curve.harmonics[i : i + 2].max())
    before, after = curve.values[i : i + 2]
    share = (value - before) / (after - before) if after != before else 0.0
    z = ((1 - share) * curve.z[i] + share * curve.z[i + 1])[..., : 2 * Nh + 1]
    family = curve.family.with_harmonics(Nh)
    first = as_response(family, value, z)
    result = solve_periodic(first.system, harmonics=Nh, samples=first.basis.samples, start=first, symmetry=False,
                            subharmonic=family.subharmonic, throw=False)  # fmt: skip
    far = max(abs(curve.z[i] - curve.z[i + 1]).max(), SAME * abs(z).max())
    if not result.success or abs(result.z - z).max() > far:  # Newton's method left for another part of the curve
        return None
    return result


def _are_same(response, other) -> bool:
    if response.z.shape != other.z.shape:
        return False
    return bool(abs(response.z - other.z).max() <= SAME * abs(response.z).max())


def _rate_at(response, t):
    """Return ydot (n_f, N, S) of a response at times t in s."""
    return response.z @ response.basis.functions(np.asarray(t, dtype=float))[1].T


class _Metric:
    """Distances of states (y, ydot) from responses: each field over its largest departure from rest, worst of all."""

    def __init__(self, responses):
        system = responses[0].system
        rest, w = system.rest_state(), 2 * np.pi / system.period
        t = lambda response: system.period * np.arange(response.subharmonic)
        pack = lambda response: np.concatenate([response.at(t(response)) - rest[..., None],
                                                _rate_at(response, t(response)) / w])  # fmt: skip
        self.rest, self.w, self.states = rest, w, [pack(each) for each in responses]
        whole = [np.concatenate([each.at(each.time) - rest[..., None], _rate_at(each, each.time) / w])
                 for each in responses]  # fmt: skip
        sizes = np.max([abs(each).max(axis=(1, 2)) for each in whole], axis=0)
        fields = sizes.size // 2
        sizes = np.maximum(sizes[:fields], sizes[fields:])
        self.sizes = np.tile(np.where(sizes > 0, sizes, np.inf), 2)[:, None, None]
        distances = [[self._between(a, b) if i != j else np.inf for j, b in enumerate(self.states)]
                     for i, a in enumerate(self.states)]  # fmt: skip
        self.limits = NEAR * np.min(distances, axis=1)

    def _between(self, a, b):
        return min(float(abs((a[..., i, None] - b) / self.sizes).max(axis=(0, 1)).min()) for i in range(a.shape[-1]))

    def nearest(self, state):
        """Return the number of the response that a state at the start of a period is near, or -1."""
        y, ydot = state
        packed = np.concatenate([y - self.rest, ydot / self.w])[..., None]
        distances = np.array([self._between(packed, each) for each in self.states])
        inside = np.flatnonzero(distances <= self.limits)
        return int(inside[0]) if inside.size else -1
