"""Problem type -> {name: solver}. A solver takes a case and returns an answer; tests and benchmarks run the product."""

from __future__ import annotations

from dataclasses import dataclass

from solvers import Span, solve_span


@dataclass(frozen=True)
class SpanAnswer:
    """Fairlead force (H, V) in N as a solver returned it.

    refused : why it returned none; unsupported : why the case is outside its model
    seconds : of the solve by the solver's own clock, where it has one (a program, without its start)
    """

    H: float = float("nan")
    V: float = float("nan")
    iterations: int | None = None
    refused: str = ""
    unsupported: str = ""
    seconds: float | None = None


def catenary(case, tolerance=None) -> SpanAnswer:
    """solvers.solve_span."""
    try:
        state = solve_span(
            Span(**case.inputs()), throw=False, **({} if tolerance is None else {"tolerance": tolerance})
        )
    except ValueError as error:
        return SpanAnswer(refused=str(error))
    return SpanAnswer(state.H, state.V, state.iterations, "" if state.success else state.status.value)


SOLVERS = {"span": {"catenary": catenary}}
