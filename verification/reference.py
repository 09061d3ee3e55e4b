"""Truth beside a case, and the one measure of error that tests, benchmarks and the report share."""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from pathlib import Path

import numpy as np

from .cases.spans import SpanCase
from .exact.cable import catenary_mp
from .exact.network import network_mp

EPS = 2.0**-52
SPANS = files("reference_data") / "spans" / "data.csv"
MOVING_NETWORKS = files("reference_data") / "moving_networks" / "data.csv"

ORACLE = Path(catenary_mp.__file__)
"""The oracle's source: results kept between runs are valid as long as it does not change."""

WRONG = 1e-3
"""An answer returned as success with a larger relative error of the force is wrong: no design needs less."""


@dataclass(frozen=True)
class SpanTruth:
    """Forces in N, lengths in m, stiffness ((K11, K12), (K21, K22)) in N/m rounded from 30 digits or more.

    stiffness : of the rows of the reference table; None where the oracle was asked for the forces alone
    condition : sum over the inputs p of |p| max(|dH/dp|, |dV/dp|) / T, the error that inputs rounded to eps must cause
    is this times eps.
    """

    H: float
    V: float
    H_anchor: float
    V_anchor: float
    grounded_length: float
    stiffness: tuple | None
    condition: float

    @property
    def limit(self) -> float:
        """Error that rounding the inputs and the result causes: eps (1 + condition)."""
        return EPS * (1 + self.condition)


def force_error(H: float, V: float, truth: SpanTruth, case: SpanCase) -> float:
    """max(|dH|, |dV|)/T at the fairlead; where the true force is zero, over the weight or EA. NaN gives inf."""
    scale = math.hypot(truth.H, truth.V) or abs(case.w) * case.L or case.EA
    error = max(abs(H - truth.H), abs(V - truth.V)) / scale
    return math.inf if math.isnan(error) else error


_NUMBERS = ("H", "V", "H_anchor", "V_anchor", "grounded_length", "K11", "K12", "K21", "K22", "condition")


@cache
def span_references() -> tuple[tuple[SpanCase, SpanTruth], ...]:
    """The reference table reference_data/spans, row by row."""
    with SPANS.open(newline="") as file:
        return tuple((_case(row), _truth(row)) for row in csv.DictReader(file))


def _case(row) -> SpanCase:
    numbers = {key: float(row[key]) for key in ("w", "EA", "L", "x", "z", "friction", "clearance")}
    return SpanCase(row["name"], row["regime"], **numbers, seabed=row["seabed"] == "True")


def _truth(row) -> SpanTruth:
    H, V, H_anchor, V_anchor, grounded, K11, K12, K21, K22, condition = (float(row[key]) for key in _NUMBERS)
    return SpanTruth(H, V, H_anchor, V_anchor, grounded, ((K11, K12), (K21, K22)), condition)


def exact_span(case: SpanCase, start=None) -> SpanTruth:
    """Return forces and condition of any span by the 50-digit oracle; ``start`` = (H, V) only makes it faster."""
    inputs = case.inputs()
    exact = catenary_mp.solve(**inputs, start=start)
    condition = catenary_mp.condition_number(**inputs, solution=exact)
    forces = (exact.H, exact.V, exact.H_anchor, exact.V_anchor, exact.grounded_length)
    return SpanTruth(*(float(value) for value in forces), None, float(condition))


# ---------------------------------------------------------------- networks
NETWORK_START = 3
"""Decimals of a metre that a start keeps: what the solver found finer than a millimetre does not reach the oracle."""


@dataclass(frozen=True)
class NetworkTruth:
    """r (n, 3), m, and tension (e, 2) at the anchor and fairlead ends of the elements, N, rounded from 40 digits."""

    r: np.ndarray
    tension: np.ndarray


def exact_network(case, start) -> NetworkTruth:
    """Truth of a small network by the 40-digit oracle; ``start`` (n, 3), m, is near the equilibrium.

    Raises ArithmeticError where the oracle finds none.
    """
    exact = network_mp.solve(case, np.round(start, NETWORK_START))
    H, V, H_anchor, V_anchor = (np.array(f, dtype=float) for f in (exact.H, exact.V, exact.H_anchor, exact.V_anchor))
    ends = np.column_stack([np.hypot(H_anchor, V_anchor), np.hypot(H, V)])
    return NetworkTruth(np.array(exact.r, dtype=float), ends)


@cache
def moving_network_tensions() -> dict[int, tuple[np.ndarray, np.ndarray]]:
    """The reference table reference_data/moving_networks: seed -> (t (nt,) in s, end tensions (nt, e, 2) in N)."""
    with MOVING_NETWORKS.open(newline="") as file:
        rows = [{name: float(text) for name, text in row.items()} for row in csv.DictReader(file)]
    tables = {}
    for seed in sorted({int(row["seed"]) for row in rows}):
        own = [row for row in rows if row["seed"] == seed]
        t = np.unique([row["t"] for row in own])
        tables[seed] = t, np.array([(row["T_a"], row["T_b"]) for row in own]).reshape(t.size, -1, 2)
    return tables


def tension_error(tension, truth: NetworkTruth) -> float:
    """Largest difference of an end tension over the largest tension. NaN gives inf."""
    error = float(np.abs(np.asarray(tension) - truth.tension).max() / truth.tension.max())
    return math.inf if math.isnan(error) else error
