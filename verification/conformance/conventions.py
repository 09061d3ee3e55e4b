"""Mistakes of units, signs and names, which need no table: the truth, told otherwise.

Their answers are made of the truth of a case: forces in another unit, horizontal for vertical, of the line on the body,
a profile from the other end.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from .tables import Case

FORCES = ("H", "V", "H_anchor", "V_anchor", "tension", "stiffness", "fairlead_tension", "anchor_tension", "mean",
          "envelope_max", "envelope_min", "force")  # fmt: skip
COMPONENTS = ("H", "V", "H_anchor", "V_anchor")
UNITS = {1 / 4.4482216: "lbf", 1 / 4448.2216: "kip", 1 / 9806.65: "tf", 1e-6: "MN", 1e5: "dyn"}
"""Over N -> unit, of those that no table has."""
NO_UNIT = 0.01  # off 1 or -1: an error that two components happen to share, or a sign
SAME_UNIT = 1e-4  # relative: a factor that a code has typed in five digits


def list_conventions(case: Case, values: Mapping, bad) -> dict[str, tuple[str, dict]]:
    """Return name -> (what is done, quantity -> answer), for answers of which the quantities ``bad`` are not right."""
    truth = {name: np.asarray(case.truth[name], dtype=float) for name in bad}
    answers = {}
    if truth.keys() <= set(COMPONENTS):
        answers["H_for_V"] = ("Horizontal and vertical components are exchanged.", _exchange(case, truth))
        opposite = {name: -value for name, value in truth.items()}
        answers["forces_reversed"] = ("Forces have the other sign: those of the line on what holds it.", opposite)
    if truth.keys() == {"profile"} and case.level == "statics":
        ends, profile = [case.inputs["x"], case.inputs["z"]], truth["profile"]
        answers["profile_from_fairlead"] = ("The profile is measured from the fairlead.", {"profile": profile - ends})
        answers["profile_downwards"] = ("z of the profile is positive downwards.", {"profile": profile * [1.0, -1.0]})
    several = sum(np.count_nonzero(one) for one in truth.values()) > 1  # one number has a factor at any rate
    if truth.keys() <= set(FORCES) and several:
        factor = _factor(case, truth, values)
        if abs(abs(factor) - 1) > NO_UNIT:
            answers[f"forces_times_{factor:.4g}"] = (_unit(factor), {name: factor * one for name, one in truth.items()})
    return answers


def _exchange(case: Case, truth: Mapping) -> dict:
    """Return the truth with the components of the ends exchanged whose answers are not right."""
    pairs = [pair for pair in (("H", "V"), ("H_anchor", "V_anchor")) if truth.keys() & set(pair)]
    known = [pair for pair in pairs if set(pair) <= case.truth.keys()]
    return {one: case.truth[other] for pair in known for one, other in (pair, pair[::-1])}


def _factor(case: Case, truth: Mapping, values: Mapping) -> float:
    """Return the factor between answer and truth that fits best, each quantity over its scale."""
    both = square = 0.0
    with np.errstate(over="ignore", invalid="ignore"):  # nonsensically large answers have no factor
        for name, one in truth.items():
            scale = np.asarray(case.scale[name], dtype=float)
            both += float(np.sum(one / scale * values[name] / scale))
            square += float(np.sum((one / scale) ** 2))
    return both / square if square else 0.0


def _unit(factor: float) -> str:
    for known, unit in UNITS.items():
        if abs(factor / known - 1) < SAME_UNIT:
            return f"Forces are in {unit}."
    return f"All forces are {factor:.4g} times the truth."
