"""What the seeded defects showed to be unchecked."""

from __future__ import annotations

import numpy as np
import pytest

from solvers import ConvergenceError, Span, Status, newton, solve_span, solve_spans

from .cases.spans import OC3


def test_an_iteration_that_runs_out_of_steps_is_no_success(monkeypatch):
    """With one step allowed a line ends in NOT_CONVERGED with NaN, alone and in a batch, and is raised."""
    monkeypatch.setattr(newton, "MAX_ITERATIONS", 1)
    span = Span(**OC3)
    state = solve_span(span, throw=False)
    assert state.status is Status.NOT_CONVERGED and np.isnan(state.H) and not state.success
    with pytest.raises(ConvergenceError, match="stopped above the requested tolerance"):
        solve_span(span)
    assert solve_spans(*(getattr(span, name) for name in ("w", "EA", "L", "x", "z"))).status.tolist() == [state.status]
