"""What an adapter returned, as quantities: name -> number or nested lists, by the names of the tables."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass

import numpy as np

from .adapter import CableAnswer, MovingNetworkAnswer, NetworkAnswer, Refused, SpanAnswer
from .problems import as_arguments, steps_per_period

KINDS = {"span": SpanAnswer, "network": NetworkAnswer, "cable": CableAnswer, "moving_network": MovingNetworkAnswer}
HARMONICS = 5
OF_THE_RUN = ("iterations", "refused", "unsupported", "seconds")
"""Names of an answer that are no quantities."""


def ask(adapter, problem: str, inputs: dict) -> dict:
    """Return quantity -> value, plain for JSON. Raises what the adapter raises, Refused for what is no answer."""
    answer = getattr(adapter, problem)(*as_arguments(problem, inputs, adapter.cells))
    if problem == "network" and callable(answer):
        answer = answer()
    return as_quantities(problem, inputs, as_fields(problem, answer))


def as_fields(problem: str, answer) -> dict:
    """Return the fields of an answer that are given. Raises Refused where it is none of its problem."""
    kind = KINDS[problem]
    if is_dataclass(answer) and not isinstance(answer, type) and type(answer).__name__ == kind.__name__:
        given = {one.name: getattr(answer, one.name) for one in fields(answer)}
    elif isinstance(answer, Mapping):
        given = dict(answer)
        _check_names(given, kind)
    elif answer is None:
        raise Refused(f"returned None, and {kind.__name__} is wanted")
    elif problem == "span":
        if not isinstance(answer, (tuple, list, np.ndarray)) or len(answer) != 2:
            raise Refused(f"returned {answer!r:.60}, and SpanAnswer(H, V) is wanted, or two numbers")
        given = {"H": answer[0], "V": answer[1]}
    else:
        given = {"force" if problem == "moving_network" else "tension": answer}
    if given.get("unsupported"):
        raise NotImplementedError(given["unsupported"])
    if given.get("refused"):
        raise Refused(given["refused"])
    if problem == "span":
        given = {"H": None, "V": None} | given
        for name in ("H", "V"):
            if given[name] is None:
                raise Refused(f"returned no {name}")
    return {name: plain(value) for name, value in given.items() if value is not None}


def _check_names(given: Mapping, kind):
    """Raise Refused for a name that an answer does not have: a quantity would be left out without a word."""
    names = [one.name for one in fields(kind)]
    for name in given:
        if name not in names:
            known = ", ".join(one for one in names if one not in OF_THE_RUN)
            raise Refused(f"returned {name!r}, and {kind.__name__} has {known}")


def plain(value):
    """Return numbers and arrays as JSON has them; what is no number stays, as text, for the judge to refuse."""
    if isinstance(value, np.ndarray) and value.dtype.kind in "fiu":
        return value.tolist()
    if isinstance(value, (list, tuple, np.ndarray)):
        return [plain(one) for one in value]
    if isinstance(value, np.generic) and value.dtype.kind in "fiu":
        return value.item()
    return value if type(value) in (int, float, str) else repr(value)


def as_quantities(problem: str, inputs: dict, given: dict) -> dict:
    """Return the quantities of the tables: of a moving line those of the compared period."""
    if problem in ("span", "network"):
        return given
    if problem == "moving_network":
        return {name: compared_period(name, given[name], inputs) for name in ("force", "tension") if name in given}
    quantities = {}
    for name, field in (("fairlead_tension", "tension"), ("anchor_tension", "anchor_tension")):
        if field in given:
            quantities[name] = compared_period(field, given[field], inputs)
    if "envelope" in given:
        quantities["envelope_max"], quantities["envelope_min"] = _envelope(given["envelope"])
    if "fairlead_tension" in quantities:
        quantities |= harmonics(np.array(quantities["fairlead_tension"]))
    return quantities


def compared_period(name: str, series, inputs: dict) -> list:
    """Return a series at the instants of the compared period. Raises Refused where it is no series of all times."""
    clock = inputs["time"]
    steps = steps_per_period(clock)
    try:
        array = np.array(series)
    except ValueError:
        raise Refused(f"{name} is ragged, and a value for each time is wanted") from None
    count = round(clock["periods"] * steps) + 1
    if array.dtype.kind not in "fiu":
        raise Refused(f"{name} = {series!r:.60}, and numbers are wanted")
    if not array.ndim or array.shape[-1] != count:
        raise Refused(f"{name} has the shape {array.shape}, and a value for each of {count} times is wanted")
    if not np.isfinite(array).all():
        raise Refused(f"{name} holds {array[~np.isfinite(array)].flat[0]}, and finite numbers are wanted")
    first, stride = clock["discard"] * steps, steps // clock["instants"]
    return array[..., first : first + steps : stride].tolist()


def harmonics(series) -> dict:
    """Return mean and harmonics (rows of amplitude and phase in rad: a cos(k 2 pi t/T + phase)) of one period (M,)."""
    if series.ndim != 1:
        return {}
    terms = np.fft.rfft(series) / len(series)
    rows = [[2 * abs(term), np.angle(term)] for term in terms[1 : HARMONICS + 1]]
    return {"mean": float(terms[0].real), "harmonics": [[float(size), float(phase)] for size, phase in rows]}


def _envelope(envelope):
    if isinstance(envelope, Mapping):
        envelope = [envelope.get("max"), envelope.get("min")]
    if not isinstance(envelope, (list, tuple)) or len(envelope) != 2:
        raise Refused(f"envelope = {envelope!r:.60}, and greatest and least tension at scene.s, (2, n), are wanted")
    return envelope
