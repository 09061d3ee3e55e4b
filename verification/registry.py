"""Problem type -> its named cases, for tests, and this project's solvers of it, for tests, benchmarks and report.

All solvers of a problem type are called alike: those of spans with a case, those of networks with a network, those of
cables with a function that builds the cable on a number of nodes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from solvers import Network, NetworkState, Span, solve_network, solve_periodic, solve_span, solve_time_domain

from .cases import cables, networks, spans
from .conformance.adapter import INSTANTS, SpanAnswer

__all__ = [
    "INSTANTS",
    "NETWORK_METHODS",
    "PROBLEMS",
    "NetworkMethod",
    "ProblemType",
    "SpanAnswer",
    "catenary",
    "corrected_harmonic_balance",
    "extrapolated_time_domain",
    "harmonic_balance",
    "instants",
    "last_period_tension",
    "time_domain",
]


@dataclass(frozen=True)
class ProblemType:
    """cases : named rows of verification.cases; solvers : name -> what solves one, as the module's docstring says."""

    cases: tuple
    solvers: dict[str, Callable]


# ---------------------------------------------------------------- one line at rest
def catenary(case, tolerance=None) -> SpanAnswer:
    """Return the answer of solvers.solve_span to a case of verification.cases.spans."""
    try:
        state = solve_span(
            Span(**case.inputs()), throw=False, **({} if tolerance is None else {"tolerance": tolerance})
        )
    except ValueError as error:
        return SpanAnswer(refused=str(error))
    return SpanAnswer(state.H, state.V, state.iterations, "" if state.success else state.status.value)


# ---------------------------------------------------------------- networks of lines at rest
@dataclass(frozen=True)
class NetworkMethod:
    """One way of solve_network: name in result files, label in figures, and the options that select it."""

    name: str
    label: str
    options: dict = field(default_factory=dict)

    def __call__(self, network: Network, **options) -> NetworkState:
        """Return the state of a network; ``options`` of solve_network beside those of the method."""
        return solve_network(network, **self.options, **options)


NETWORK_METHODS = (
    NetworkMethod("monolithic-line-search", "monolithic, line search"),
    NetworkMethod("monolithic-trust-region", "monolithic, trust region", {"globalisation": "trust-region"}),
    NetworkMethod("monolithic-differences", "monolithic, differences", {"jacobian": "finite-difference"}),
    NetworkMethod(
        "monolithic-differences-trust-region",
        "monolithic, differences, trust region",
        {"jacobian": "finite-difference", "globalisation": "trust-region"},
    ),
    NetworkMethod("nested-analytic", "nested, analytic", {"method": "nested"}),
    NetworkMethod("nested-differences", "nested, differences", {"method": "nested", "jacobian": "finite-difference"}),
)


# ---------------------------------------------------------------- moving cables
def instants(period: float, count: int = INSTANTS) -> np.ndarray:
    """Return ``count`` equal times in [0, period), s."""
    return period * np.arange(count) / count


def last_period_tension(response) -> np.ndarray:
    """Return the fairlead tension (INSTANTS,) in N over the last period of a time history or periodic response."""
    first, period = response.last_period
    return response.fairlead_tension(first + instants(period))


def harmonic_balance(build: Callable, nodes: int, harmonics: int) -> Callable:
    """Return a function of no argument that finds the periodic response of ``build(nodes)``."""
    system = build(nodes)
    return lambda: solve_periodic(system, harmonics=harmonics, throw=False)


def corrected_harmonic_balance(build: Callable, nodes: int, harmonics: int) -> Callable:
    """Return the same with a deferred correction, of fourth order in the cell."""
    system = build(nodes)
    return lambda: solve_periodic(system, harmonics=harmonics, deferred_correction=True, throw=False)


def time_domain(build: Callable, nodes: int, dt: float, periods: float = 3) -> Callable:
    """Return a function of no argument that integrates ``build(nodes)`` over some periods with steps of dt, s."""
    system = build(nodes)
    return lambda: solve_time_domain(system, dt=dt, periods=periods, throw=False)


def extrapolated_time_domain(build: Callable, nodes: int, dt: float, periods: float = 3) -> Callable:
    """Return a function that gives the fairlead tension of the last period, N, extrapolated from two time histories.

    Cells and steps of the finer one are half as long: the error of second order cancels.
    """
    coarse, fine = build(nodes), build(2 * nodes - 1)

    def solve() -> np.ndarray:
        histories = (
            solve_time_domain(system, dt=step, periods=periods) for system, step in ((coarse, dt), (fine, dt / 2))
        )
        rough, better = (last_period_tension(history) for history in histories)
        return better + (better - rough) / 3

    return solve


PROBLEMS = {
    "span": ProblemType(spans.NAMED, {"catenary": catenary}),
    "network": ProblemType(networks.NAMED, {method.name: method for method in NETWORK_METHODS}),
    "cable": ProblemType(
        tuple(cables.PAPER_CASES),
        {
            "harmonic balance": harmonic_balance,
            "harmonic balance, corrected": corrected_harmonic_balance,
            "time domain": time_domain,
            "time domain, extrapolated": extrapolated_time_domain,
        },
    ),
}
