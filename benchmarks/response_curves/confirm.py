"""Special points confirmed in time: does a disturbed response on either side return or leave, as its multipliers say?

Along the curve on both sides of a special point a response is taken, where its largest multiplier is clear of the unit
circle, and disturbed by a few of the line's natural modes. Stable responses return, unstable ones leave, and where they
settle is compared with the other responses that are known at that frequency. Past a fold, where the response ends, a
third integration starts from the last one: it must leave.
"""

from __future__ import annotations

import math

import numpy as np

from solvers import solve_time_domain
from solvers.numerics.modes import natural_modes
from solvers.stability import find_landing, floquet, responses_at
from solvers.stability.special_points import FOLD

DISTURBANCE = 0.01  # of the largest displacement: small enough to be linear, larger than what steps and harmonics err by
MODES = 4
CLEAR, LEAST_CLEAR = 0.05, 5e-4  # |log| of the largest multiplier at which a response is tested: the first point that
# is so far from the circle, or else the farthest one
FARTHEST = 6  # points of the curve that are looked at on each side
DECIDED = 5.0  # growth or decay of the disturbance, as a logarithm of its prediction, that is waited for
MOST_PERIODS, STEPS = 3000, 400
LANDING_PERIODS = 400  # that a motion which has left is followed to another response
PERIODS_PAST = 200  # a fold, where nothing holds the motion
RETURNED, LEFT = 0.5, 3.0  # of the first distance: below it has returned, above it has left
LONGER = 4  # times that the periods are doubled while nothing is decided
STRAIGHT = 0.25  # rms of the logarithm of a growth that is exponential, about its line
BEYOND = 0.01  # of the range, past a fold


def confirm(curve, others=(), seed=0) -> list[dict]:
    """Return two or three rows for each special point of a curve; others: curves of its branches."""
    rng, rows = np.random.default_rng(seed), []
    for number, special in enumerate(curve.special):
        about = {"special": number, "kind": special.kind, "at": special.value}
        for side in (-1, 1):
            i = _point_beside(curve, special, side)
            if i is None:
                rows.append(about | {"side": side, "outcome": "no point clear of the threshold", "agrees": None})
            else:
                rows.append(about | {"side": side} | _disturb(curve, i, others, rng))
        if special.kind == FOLD and (row := _past(curve, special, others)) is not None:
            rows.append(about | {"side": 0} | row)
    return rows


def _point_beside(curve, special, side):
    """Return the number of the point of a curve on a side of a special point that is clear of it, or None."""
    first = special.after if side < 0 else special.after + 1
    others = {each.after for each in curve.special if each is not special}
    best, clearest = None, LEAST_CLEAR
    for i in range(first, first + side * FARTHEST, side):
        is_past_another = i != first and min(i, i - side) in others
        if not 0 <= i < curve.values.size or is_past_another or curve.stable[i] != curve.stable[first]:
            break
        distance = abs(math.log(abs(curve.multipliers[i]).max()))
        if distance > clearest:
            best, clearest = i, distance
        if clearest >= CLEAR:
            break
    return best


def _disturb(curve, i, others, rng) -> dict:
    """Return how a disturbed response of point i fares in time, beside what its multipliers say."""
    response = curve.response(i)
    predicted = float(abs(curve.multipliers[i]).max())
    nu = response.subharmonic
    periods = min(MOST_PERIODS, math.ceil(DECIDED / abs(math.log(predicted)))) * nu
    state, scale = _state(response), float(abs(response.z).max())
    start = state[0] + DISTURBANCE * scale * _shape(response.system, rng), state[1]
    about = {"value": float(curve.values[i]), "multiplier": predicted}
    for _ in range(LONGER):  # other multipliers may hide the largest one
        history = _integrate(response.system, start, periods)
        if history is None:
            return about | {"outcome": "a step failed", "agrees": None}
        distances = abs(history.y[..., ::nu] - state[0][..., None]).max(axis=(0, 1)) / (DISTURBANCE * scale)
        outcome = _outcome(distances)
        if outcome != "undecided":
            break
        periods *= 2
    agrees = None if outcome == "undecided" else (outcome == "returned") == (predicted < 1)
    lands = "itself" if outcome == "returned" else _name_landing(curve, i, others, history)
    return about | {"measured": _rate(distances, predicted), "periods": history.y.shape[-1] - 1, "outcome": outcome,
                    "agrees": agrees, "lands": lands}  # fmt: skip


def _outcome(distances) -> str:
    start, end = distances[0], distances[-3:].max()
    if end <= RETURNED * start:
        return "returned"
    return "left" if distances.max() >= LEFT * start else "undecided"


def _rate(distances, predicted):
    """Return the growth of the distance in a period, over its part that is neither first nor saturated, or None."""
    limit = distances.max() / 4 if predicted > 1 else np.inf
    floor = distances.min() * 3
    good = np.flatnonzero((distances < limit) & (distances > floor))
    good = good[good >= 3]
    if good.size < 4 or np.ptp(np.log(distances[good])) < 1:
        return None
    line = np.polyfit(good, np.log(distances[good]), 1)
    misfit = np.log(distances[good]) - np.polyval(line, good)
    return float(np.exp(line[0])) if misfit.std() < STRAIGHT else None


def _past(curve, special, others):
    """Return how the response of a fold fares a little past it, where the curve has none; None where that is outside.

    Where the curve comes from elsewhere to that value, too, it lands there or on another motion, and must leave.
    """
    k = special.after
    away = np.sign(special.value - curve.values[k]) or 1.0
    value = special.value + away * BEYOND * abs(curve.values[-1] - curve.values[0])
    if not curve.values.min() < value < curve.values.max():
        return None
    response = curve.response(special)
    known = responses_at(curve, value)
    system = known[0].system
    state, scale = _state(response), float(abs(response.z).max())
    history = _integrate(system, state, PERIODS_PAST)
    if history is None:
        return {"value": value, "outcome": "a step failed", "agrees": None}
    distances = abs(history.y - state[0][..., None]).max(axis=(0, 1)) / scale
    outcome = "left" if distances[-1] > LEFT * DISTURBANCE else "stayed"
    lands = _lands_on(known, others, value, history)
    return {"value": float(value), "periods": PERIODS_PAST, "outcome": outcome, "agrees": outcome == "left", "lands": lands}


def _name_landing(curve, i, others, history) -> str:
    value = float(curve.values[i])
    return _lands_on(responses_at(curve, value), others, value, history)


def _lands_on(known, others, value, history) -> str:
    """Return the name of the response that a history goes on to."""
    names = ["the curve"] * len(known)
    for name, other in others:
        if other.values.min() <= value <= other.values.max():
            more = responses_at(other, value)
            known, names = [*known, *more], [*names, *[name] * len(more)]
    stable = [(response, name) for response, name in zip(known, names, strict=True)
              if floquet(response, method="monodromy").stable]  # fmt: skip
    if not stable:
        return "another motion"
    responses = [response for response, _ in stable]
    end = history.y[..., -1], history.ydot[..., -1]
    number = find_landing(responses, end, periods=LANDING_PERIODS, steps=STEPS)
    return stable[number][1] if number >= 0 else "another motion"


def _state(response):
    """Return (y, ydot) of a response at the start of its period."""
    t = np.zeros(1)
    return response.at(t)[..., 0], (response.z @ response.basis.functions(t)[1].T)[..., 0]


def _shape(system, rng):
    """Return a displacement (n, N) of a few natural modes by random weights, its largest component one."""
    shapes = natural_modes(system, MODES).shapes
    shapes = shapes * np.exp(-1j * np.angle(shapes.reshape(-1, shapes.shape[-1])[abs(shapes).reshape(
        -1, shapes.shape[-1]).argmax(axis=0), range(shapes.shape[-1])]))  # fmt: skip
    shape = (shapes.real / abs(shapes).max(axis=(0, 1))) @ rng.normal(size=shapes.shape[-1])
    return shape / abs(shape).max()


def _integrate(system, start, periods):
    """Return the history at the starts of the periods of the motion, None where a step fails."""
    history = solve_time_domain(system, dt=system.period / STEPS, periods=periods, start=start, every=STEPS,
                                throw=False)  # fmt: skip
    return history if history.success else None

