"""Special points confirmed in time: does a disturbed response on either side return or leave, as its multipliers say?

Along the curve on both sides of a special point a response is taken where the multiplier that passes the unit circle is
clear of it, and disturbed along the mode of that multiplier, or of a larger one that is unstable. Stable responses
return, unstable ones leave, and where they
settle is compared with the other responses that are known at that frequency. Past a fold, where the response ends, a
third integration starts from the last one: it must leave.
"""

from __future__ import annotations

import math

import numpy as np

from solvers import solve_time_domain
from solvers.stability import find_landing, responses_at
from solvers.stability.curves.special_points import BRANCH_POINT, FOLD, PERIOD_DOUBLING
from solvers.stability.multipliers.floquet import floquet
from solvers.stability.multipliers.monodromy import RADAU

DISTURBANCE = (
    0.01  # of the largest displacement: small enough to be linear, larger than what steps and harmonics err by
)
CLEAR, LEAST_CLEAR = 0.05, 2e-3  # |log| of the critical multiplier at which a response is tested: the first point that
# is so far from the circle, or else the farthest one
FARTHEST = 6  # points of the curve that are tried on each side
DECIDED = 5.0  # growth or decay of the disturbance, as a logarithm of its prediction, that is waited for
MOST_PERIODS, STEPS, MODE_STEPS = 3000, 400, 200
LANDING_PERIODS = 400  # that a motion which has left is followed to another response
PERIODS_PAST = 200  # a fold, where nothing holds the motion
RETURNED, LEFT = 0.5, 3.0  # of the first distance: below it has returned, above it has left
SAME = 1e-6  # of the largest coefficient, within which two responses are one
LONGER = 4  # times that the periods are doubled while nothing is decided
NEAR_REAL = 0.5  # rad, of a pair that meets on the real axis before one of it passes 1 or -1
STRAIGHT = 0.25  # rms of the logarithm of a growth that is exponential, about its line
BEYOND = 0.01  # of the range, past a fold


def confirm(curve, others=()) -> list[dict]:
    """Return two or three rows for each special point of a curve; others: curves of its branches."""
    rows: list[dict] = []
    for number, special in enumerate(curve.special):
        identity = {"special": number, "kind": special.kind, "at": special.value}
        for side in (-1, 1):
            i = _point_beside(curve, special, side)
            if i is None:
                rows.append(identity | {"side": side, "outcome": "no point clear of the threshold", "agrees": None})
            else:
                rows.append(identity | {"side": side} | _disturb(curve, i, special.kind, others))
        if special.kind == FOLD and (row := _integrate_past_fold(curve, special, others)) is not None:
            rows.append(identity | {"side": 0} | row)
    return rows


def _point_beside(curve, special, side):
    """Return the number of the point of a curve on a side of a special point that is clear of it, or None."""
    first = special.after if side < 0 else special.after + 1
    others = {each.after for each in curve.special if each is not special}
    best, clearest = None, LEAST_CLEAR
    for i in range(first, first + side * FARTHEST, side):
        is_past_another = i != first and min(i, i - side) in others
        if (
            not 0 <= i < curve.values.size
            or is_past_another
            or curve.stable_in_plane[i] != curve.stable_in_plane[first]
        ):
            break
        distance = abs(math.log(abs(_critical_multiplier(curve.multipliers[i], special.kind))))
        if distance > clearest:
            best, clearest = i, distance
        if clearest >= CLEAR:
            break
    return best


def _disturb(curve, i, kind, others) -> dict:
    """Return how a disturbed response of point i fares in time, beside what its multipliers say."""
    response = curve.response(i)
    wanted = _critical_multiplier(curve.multipliers[i], kind)
    predicted, (dy, dydot) = abs(wanted), _mode(response, wanted)
    nu = response.subharmonic
    periods = min(MOST_PERIODS, math.ceil(DECIDED / abs(math.log(predicted)))) * nu
    state, scale = _first_state(response), float(abs(response.z).max())
    start = state[0] + DISTURBANCE * scale * dy, state[1] + DISTURBANCE * scale * dydot
    row = {"value": float(curve.values[i]), "multiplier": predicted}
    for _ in range(LONGER):  # other multipliers may hide the largest one
        history = _integrate(response.system, start, periods)
        if history is None:
            return row | {"outcome": "a step failed", "agrees": None}
        distances = _distances(history, state, response) / (DISTURBANCE * scale)
        outcome = _judge_outcome(distances)
        if outcome != "undecided":
            break
        periods *= 2
    lands = "itself" if outcome == "returned" else _name_landing(curve, i, others, history)
    if outcome == "undecided" and lands == "itself":  # the motion that the steps repeat is a little beside the series
        outcome = "returned"
    if outcome == "undecided" and _meets_undisturbed(response, state, history):
        outcome, lands = "returned", "itself"
    agrees = None if outcome == "undecided" else (outcome == "returned") == bool(curve.stable_in_plane[i])
    measured, periods = _measure_growth(distances, predicted), history.y.shape[-1] - 1
    return row | {"multiplier": float(predicted), "measured": measured, "periods": periods, "outcome": outcome,
                    "agrees": agrees, "lands": lands}  # fmt: skip


def _meets_undisturbed(response, state, history) -> bool:
    """Return whether a disturbed history comes to the one without its disturbance, and was never far from it.

    The motion that time steps repeat is a little beside the series of the response, which may hide the return to it.
    """
    periods = history.y.shape[-1] - 1
    other = _integrate(response.system, state, periods)
    if other is None:
        return False
    offset = abs(history.y - other.y).max(axis=(0, 1))
    return bool(offset[-1] <= RETURNED * offset[0] and offset.max() < LEFT * offset[0])


def _distances(history, state, response):
    """Return how far the states at the starts of the periods of a response are from its own, in m; velocity / omega."""
    w, periods = response.basis.omega, response.subharmonic
    offset = np.concatenate([history.y - state[0][..., None], (history.ydot - state[1][..., None]) / w])
    return abs(offset[..., ::periods]).max(axis=(0, 1))


def _judge_outcome(distances) -> str:
    start, end = distances[0], distances[-3:].max()
    if end <= RETURNED * start:
        return "returned"
    return "left" if distances.max() >= LEFT * start else "undecided"


def _measure_growth(distances, predicted):
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


def _integrate_past_fold(curve, special, others):
    """Return how the response of a fold fares a little past it, where the curve has none; None where that is outside.

    Where the curve comes from elsewhere to that value, too, it lands there or on another motion, and must leave.
    """
    k = special.after
    offset = np.sign(special.value - curve.values[k]) or 1.0
    value = special.value + offset * BEYOND * abs(curve.values[-1] - curve.values[0])
    if not curve.values.min() < value < curve.values.max():
        return None
    response = curve.response(special)
    known = responses_at(curve, value)
    system = known[0].system
    state, scale = _first_state(response), float(abs(response.z).max())
    history = _integrate(system, state, PERIODS_PAST)
    if history is None:
        return {"value": value, "outcome": "a step failed", "agrees": None}
    distances = _distances(history, state, response) / scale
    outcome = "left" if distances[-1] > LEFT * DISTURBANCE else "stayed"
    lands = _lands_on(known, others, value, history)
    return {
        "value": float(value),
        "periods": PERIODS_PAST,
        "outcome": outcome,
        "agrees": outcome == "left",
        "lands": lands,
    }


def _name_landing(curve, i, others, history) -> str:
    itself, value = curve.response(i), float(curve.values[i])
    known = [each for each in responses_at(curve, value) if abs(each.z - itself.z).max() > SAME * abs(itself.z).max()]
    return _lands_on(known, others, value, history, itself)


def _lands_on(known, others, value, history, itself=None) -> str:
    """Return the name of the response that a history goes on to."""
    names = ["another part of the curve" if itself else "the curve"] * len(known)
    if itself is not None:
        known, names = [itself, *known], ["itself", *names]
    for name, other in others:
        if other.values.min() <= value <= other.values.max():
            on_branch = responses_at(other, value)
            known, names = [*known, *on_branch], [*names, *[name] * len(on_branch)]
    stable = [(response, name) for response, name in zip(known, names, strict=True)
              if floquet(response, method="monodromy").stable]  # fmt: skip
    if not stable:
        return "another motion"
    responses = [response for response, _ in stable]
    end = history.y[..., -1], history.ydot[..., -1]
    number = find_landing(responses, end, periods=LANDING_PERIODS, steps=STEPS)
    return stable[number][1] if number >= 0 else "another motion"


def _first_state(response):
    """Return (y, ydot) of a response at the start of its period."""
    t = np.zeros(1)
    return response.at(t)[..., 0], (response.z @ response.basis.functions(t)[1].T)[..., 0]


def _critical_multiplier(multipliers, kind):
    """Return the largest multiplier if it is unstable, else the largest of those that may pass at such a point."""
    largest = multipliers[abs(multipliers).argmax()]
    if abs(largest) > 1:
        return largest
    angle = abs(np.angle(multipliers))
    may_pass = {FOLD: angle <= NEAR_REAL, BRANCH_POINT: angle <= NEAR_REAL, PERIOD_DOUBLING: angle >= np.pi - NEAR_REAL}
    candidates = multipliers[may_pass.get(kind, (angle > 0) & (angle < np.pi))]
    return candidates[abs(candidates).argmax()] if candidates.size else largest


def _mode(response, multiplier):
    """Return (y, ydot), (n, N) each, of the mode whose multiplier is nearest to a given one, largest number 1."""
    period = response.linearised_period(MODE_STEPS, RADAU)
    values, vectors = np.linalg.eig(period.apply(np.eye(period.size)))
    vector = vectors[:, abs(values - multiplier).argmin()]
    vector = (vector / vector[abs(vector).argmax()]).real.reshape(2, period.free.size, period.n)
    mode = np.zeros((2, response.system.nodes, period.n))
    mode[:, period.free] = vector
    return mode[0].T, mode[1].T * response.basis.omega


def _integrate(system, start, periods):
    """Return the history at the starts of the periods of the motion, None where a step fails."""
    history = solve_time_domain(system, dt=system.period / STEPS, periods=periods, start=start, every=STEPS,
                                throw=False)  # fmt: skip
    return history if history.success else None
