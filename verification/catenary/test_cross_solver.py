"""Do two ways to the answer agree? The batch with the scalar solver, bit for bit; a boundary-value solver with both."""

from __future__ import annotations

import math
from dataclasses import fields

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import root

from solvers import ConvergenceError, InputError, Span, Status, solve_span, solve_spans
from solvers.catenary.span import BLOCK, span_arrays

from ..cases.spans import NAMED, OC3, SpanCase, random_cases
from ..reference import span_references

RESULTS = ("H", "V", "H_anchor", "V_anchor", "grounded_length", "iterations", "residual_norm")
SHOOTING = 1e-8  # the integrator is asked for 1e-11 of each step; the force follows it with kappa up to 1e2


def batch_of(cases):
    """solve_spans on the columns of cases or spans."""
    return solve_spans(**{f.name: np.array([getattr(case, f.name) for case in cases]) for f in fields(Span)})


def scalar_row(case):
    """Return (results, stiffness, status) of solve_span; of a refused line what the batch should report."""
    try:
        state = solve_span(Span(**case.inputs()), throw=False)
    except InputError:
        return None, None, Status.INVALID_INPUT
    return [getattr(state, name) for name in RESULTS], state.stiffness, state.status


def batch_misses(cases, batch) -> list[str]:
    """Rows of a batch that differ from the scalar solver in any bit."""
    misses = []
    for i, case in enumerate(cases):
        row, stiffness, status = scalar_row(case)
        if batch.status[i] is not status:
            misses.append(f"{case.name}: status {batch.status[i].name}, alone {status.name}; {case.inputs()}")
        elif row is not None:
            got = [getattr(batch, name)[i] for name in RESULTS]
            same = np.array_equal(got, row, equal_nan=True)
            if not (same and np.array_equal(batch.stiffness[i], stiffness, equal_nan=True)):
                misses.append(f"{case.name}: got {got} {batch.stiffness[i].tolist()}, alone {row} {stiffness.tolist()}")
    return misses


# ---------------------------------------------------------------- batch and scalar
def test_batch_equals_scalar_on_the_reference_table():
    """Both give every result, iteration count and status of every reference row, to the last bit."""
    cases = [case for case, _ in span_references()]
    misses = batch_misses(cases, batch_of(cases))
    assert not misses, "\n".join(misses)


def test_batch_equals_scalar_on_random_lines(deep):
    """The same for random lines over every regime, with invalid rows and undetermined ones among them."""
    cases = random_cases(20_000 if deep else 3000, seed=11)
    cases[5::50] = [SpanCase(c.name, "bad", c.w, -c.EA, c.L, c.x, c.z) for c in cases[5::50]]
    cases[7::50] = [SpanCase(c.name, "bad", math.nan, c.EA, c.L, c.x, c.z) for c in cases[7::50]]
    cases[9::50] = [SpanCase(c.name, "undetermined", 1.0, 1e3, 1.0, 0.9, 0.1, True, 0.5, 0.01) for c in cases[9::50]]
    batch = batch_of(cases)
    assert {Status.SUCCESS, Status.INVALID_INPUT, Status.FRICTION_UNDETERMINED} <= set(batch.status)
    misses = batch_misses(cases, batch)
    assert not misses, "\n".join(misses[:20])


def test_arrays_of_checked_input_are_those_of_a_batch():
    """span_arrays, for callers that have checked their input: the same bits, with the status where a row fails."""
    cases = random_cases(300, seed=12)
    cases[::50] = [SpanCase(c.name, "undetermined", 1.0, 1e3, 1.0, 0.9, 0.1, True, 0.5, 0.01) for c in cases[::50]]
    batch = batch_of(cases)
    columns = (np.array([getattr(case, f.name) for case in cases]) for f in fields(Span))
    *forces, stiffness, regime, status, iterations = span_arrays(*columns)
    for name, values in zip(RESULTS, forces, strict=False):
        assert np.array_equal(values, getattr(batch, name), equal_nan=True), name
    assert np.array_equal(np.stack(stiffness, axis=-1), batch.stiffness.reshape(-1, 4), equal_nan=True)
    assert np.array_equal(regime, batch.regime_code) and np.array_equal(status, batch.status_code)
    assert np.array_equal(iterations, batch.iterations) and set(batch.success) == {True, False}


def test_rows_do_not_know_their_neighbours():
    """A line alone, first, last or among failures of every kind gives the same bits."""
    line = SpanCase("oc3", "grounded", **OC3)
    bad = [
        SpanCase("nan", "bad", math.nan, 1.0, 1.0, 1.0, 1.0),
        SpanCase("inf", "bad", 1.0, math.inf, 1.0, 1.0, 1.0),
        SpanCase("negative", "bad", 1.0, 1.0, -1.0, 1.0, 1.0),
        SpanCase("undetermined", "sagging", 1.0, 1e3, 1.0, 0.9, 0.1, True, 0.5, 0.01),
        SpanCase("huge", "lying", 1.0, 1e308, 1.0, 1e10, 0.0),
    ]
    for row in range(len(bad) + 1):
        cases = [*bad[:row], line, *bad[row:]]
        batch = batch_of(cases)
        assert batch.success.tolist() == [i == row for i in range(len(cases))]
        for name in ("H", "V", "H_anchor", "V_anchor", "grounded_length"):
            column = getattr(batch, name)
            assert column[row] == getattr(solve_span(Span(**OC3)), name)
            assert np.isnan(np.delete(column, row)).all()
        assert np.isnan(np.delete(batch.stiffness, row, axis=0)).all()


def test_arguments_broadcast():
    """Scalars, arrays (1,) and (n,), integers and lists mix; the result has the shape (n,), stiffness (n, 2, 2)."""
    x = [840.0, 848.67, 860.0]
    batch = solve_spans(698.094, np.array([384.243e6]), 902.2, x, 250, friction=np.float32(0.0))
    assert batch.H.shape == (3,) and batch.stiffness.shape == (3, 2, 2)
    for i, value in enumerate(x):
        assert batch.H[i] == solve_span(Span(698.094, 384.243e6, 902.2, value, 250.0)).H
    assert solve_spans(**OC3).H.shape == (1,)
    mixed = solve_spans(**OC3, seabed=[True, False])
    assert mixed.V[0] == solve_span(Span(**OC3)).V
    assert mixed.V[1] == solve_span(Span(**OC3, seabed=False)).V


def test_empty_batch():
    """No rows in, no rows out."""
    batch = solve_spans([], 1.0, 1.0, [], 0.0)
    assert batch.H.shape == (0,) and batch.stiffness.shape == (0, 2, 2) and batch.status.shape == (0,)


def test_blocks_do_not_show():
    """20001 rows, over two block boundaries, equal the concatenation of three odd parts, bit for bit."""
    assert 2 * BLOCK < 20_001
    cases = (random_cases(500, seed=3) * 41)[:20_001]
    whole = batch_of(cases)
    parts = [batch_of(cases[a:b]) for a, b in ((0, 777), (777, BLOCK + 1), (BLOCK + 1, 20_001))]
    for name in (*RESULTS, "stiffness", "status_code", "regime_code"):
        joined = np.concatenate([getattr(part, name) for part in parts])
        assert np.array_equal(getattr(whole, name), joined, equal_nan=True), name


def test_batch_and_scalar_share_the_meaning_of_tolerance():
    """A loose tolerance stops both after the same number of steps at the same force."""
    cases = random_cases(300, seed=5)
    columns = {f.name: np.array([getattr(case, f.name) for case in cases]) for f in fields(Span)}
    batch = solve_spans(**columns, tolerance=1e-4)
    for i, case in enumerate(cases):
        state = solve_span(Span(**case.inputs()), tolerance=1e-4, throw=False)
        assert (batch.iterations[i], batch.H[i]) == (state.iterations, state.H)
    assert batch.iterations.sum() < batch_of(cases).iterations.sum()


# ---------------------------------------------------------------- another method: shooting on the differential equation
SHOT = {
    **{case.name: Span(**case.inputs()) for case in NAMED},
    "buoyant": Span(-30.0, 1e6, 100.0, 70.0, 40.0, seabed=False),
    "fairlead below": Span(30.0, 1e6, 100.0, 80.0, -45.0, seabed=False),
}


@pytest.mark.parametrize("name", SHOT)
def test_shooting_reaches_the_same_force(name):
    """Shooting on dx/ds, dz/ds, dH/ds, dV/ds, which knows neither regimes nor closed forms, finds the same force."""
    span = SHOT[name]
    state = solve_span(span)
    # start 3 % away in both components, so that the start is not the solution
    start = np.array([state.H, state.V]) * [1.03, 0.98]
    shot = root(shooting_miss, start, args=(span,), tol=1e-12, options={"xtol": 1e-12})
    assert np.max(np.abs(shot.fun)) < 1e-9 * span.L, shot.message
    assert math.dist(shot.x, start) > 0.01 * state.tension
    assert math.dist(shot.x, (state.H, state.V)) <= SHOOTING * state.tension


def shooting_miss(force, span):
    """Return where a line with the force (H, V) at the fairlead ends, less where its anchor is, (2,), m."""

    def derivative(_, y):
        H, V = y[2:]
        T = math.hypot(H, V)
        return H / T + H / span.EA, V / T + V / span.EA, 0.0, span.w

    def touchdown(_, y):
        return y[3]

    touchdown.terminal = True
    H, V = force
    free = solve_ivp(
        derivative, (0.0, -span.L), (span.x, span.z, H, V), rtol=1e-11, atol=1e-11 * span.L, method="DOP853",
        events=touchdown if span.seabed else None,
    )  # fmt: skip
    x, z, H, _ = free.y[:, -1]
    grounded = span.L + free.t[-1]
    if grounded > 1e-9 * span.L:  # on the seabed: the tension falls by CB w until there is none
        pulled = min(grounded, H / (span.friction * span.w)) if span.friction else grounded
        x -= grounded + (H - span.friction * span.w * pulled / 2) * pulled / span.EA
    return np.array([x, z])


def test_failed_rows_explain_themselves():
    """The status of a failed row is a sentence, and building the Span of that row raises the same refusal."""
    batch = solve_spans([1.0, 1.0], [1.0, -1.0], 1.0, 0.5, 0.5)
    assert batch.status[1] is Status.INVALID_INPUT and "build solvers.Span" in batch.status[1].value
    with pytest.raises(InputError, match="EA: -1 N"):
        Span(1.0, -1.0, 1.0, 0.5, 0.5)
    with pytest.raises(ConvergenceError, match="friction = 0 or clearance = 0"):
        solve_span(Span(1.0, 1e3, 1.0, 0.9, 0.1, True, 0.5, 0.01))
