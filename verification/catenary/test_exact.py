"""Are the answers right, to the accuracy that their inputs allow? Hand values, the reference table, random lines.

Every error is stated in units of the condition limit eps (1 + kappa) of its own row (``SpanTruth.limit``).
"""

from __future__ import annotations

import math
from statistics import median

import numpy as np
import pytest
from hypothesis import Phase, given, settings

from solvers import Regime, Span, solve_span

from ..cases.spans import SpanCase, random_cases
from ..exact.cable import catenary_mp
from ..reference import EPS, WRONG, SpanTruth, exact_span, force_error, span_references
from ..registry import PROBLEMS
from ..tools.strategies import seabed_cases, suspended_cases

WORST_ERROR = 100  # condition limits: a hundred roundings, each as harmful as the worst rounding of the inputs
MEDIAN_ERROR = 4  # condition limits: as xsf and Boost.Math ask of a special function
SQUARE_ROOT = 100 * math.sqrt(EPS)  # where kappa is infinite the force answers like a square root of the input
HAND = 8 * EPS  # a value worked by hand costs a few roundings of its own
MOST_STEPS, MEAN_STEPS = 8, 3  # Newton evaluations from no guess; a bisection takes 65, a step 10 % too short 14
RANDOM_SEED, CHUNKS = 2026, 10
RANDOM_LINES = {False: 500, True: 5000}


def allowed(truth: SpanTruth, units: float = WORST_ERROR) -> float:
    """Return the relative error of the force that may remain."""
    return units * truth.limit if math.isfinite(truth.condition) else SQUARE_ROOT


# ---------------------------------------------------------------- checks: each returns a sentence for every error
def force_misses(rows, solver) -> tuple[list[str], list[tuple[float, str]]]:
    """Return a sentence for every bad row, and (error in limits, name) of every row answered."""
    misses, errors = [], []
    for case, truth in rows:
        answer = solver(case)
        error = math.inf if answer.refused else force_error(answer.H, answer.V, truth, case)
        errors.append((error / truth.limit, case.name))
        if error <= allowed(truth):
            continue
        verdict = answer.refused or ("WRONG" if error > WRONG else "inaccurate")
        misses.append(
            f"{case.name}: {verdict}: got ({answer.H!r}, {answer.V!r}), wanted ({truth.H!r}, {truth.V!r}), "
            f"relative {error:.3g} = {error / allowed(truth):.3g} x allowed, kappa {truth.condition:.3g}; "
            f"{case.inputs()}"
        )
    return misses, errors


def anchor_misses(rows) -> list[str]:
    """H_anchor and V_anchor follow from (H, V) by sums, so they share the limit of the fairlead force."""
    misses = []
    for case, truth in rows:
        state = solve_span(Span(**case.inputs()))
        anchor = SpanTruth(truth.H_anchor, truth.V_anchor, truth.H, truth.V, 0, (), 0)
        scale = math.hypot(truth.H, truth.V) or abs(case.w) * case.L or case.EA
        error = max(abs(state.H_anchor - anchor.H), abs(state.V_anchor - anchor.V)) / scale
        if not error <= allowed(truth):
            misses.append(
                f"{case.name}: got ({state.H_anchor!r}, {state.V_anchor!r}), wanted ({anchor.H!r}, {anchor.V!r}), "
                f"relative {error:.3g} = {error / allowed(truth):.3g} x allowed"
            )
    return misses


def grounded_misses(rows) -> list[str]:
    """V carries the weight of what does not lie, w (L - grounded), so an error dV moves the touchdown by dV/w."""
    misses = []
    for case, truth in rows:
        got = solve_span(Span(**case.inputs())).grounded_length
        wanted = truth.grounded_length
        tension = math.hypot(truth.H, truth.V)
        bound = 2 * (allowed(truth) * tension / case.w + WORST_ERROR * EPS * case.L) if wanted else 0.0
        if not abs(got - wanted) <= bound:
            misses.append(
                f"{case.name}: got {got!r}, wanted {wanted!r} m, difference {got - wanted:.3g}, may {bound:.3g}"
            )
    return misses


def sensitivity(case, truth) -> float:
    """Return the sum over the inputs p of |p| max(|dH/dp|, |dV/dp|), N, from the stiffness alone.

    For lines without friction and clearance, which are inputs of their own.
    By dimension analysis: H and V are homogeneous of degree one in (w, EA) and of degree zero in (L, x, z, 1/w), and a
    change of EA acts like moving the end by the stretch it causes.
    """
    K = np.array(truth.stiffness)
    K = np.where(np.isfinite(K), K, 0.0)
    force = np.array([truth.H, truth.V])
    hanging = case.L - truth.grounded_length
    stretch = np.array([truth.H * case.L, (truth.V + truth.V_anchor) / 2 * hanging]) / case.EA
    by_x, by_z, by_EA = K[:, 0] * case.x, K[:, 1] * case.z, K @ stretch
    by_L, by_w = force - by_x - by_z - by_EA, force - by_EA
    return float(sum(np.max(np.abs(part)) for part in (by_x, by_z, by_EA, by_L, by_w)))


def stiffness_condition(case, truth) -> float:
    """Return how much relative errors of the inputs change the least tension, which the stiffness follows from."""
    least = least_tension(truth)
    return sensitivity(case, truth) / least if least else 0.0


def least_tension(truth: SpanTruth) -> float:
    """Return the least tension of a line, N: H where it is level somewhere, else that of the lower end."""
    if truth.grounded_length > 0 or truth.V * truth.V_anchor < 0:
        return truth.H
    return min(math.hypot(truth.H, truth.V), math.hypot(truth.H_anchor, truth.V_anchor))


def stiffness_misses(rows) -> list[str]:
    """Every entry, relative to the largest one, whose rounding it shares."""
    misses = []
    for case, truth in rows:
        got, wanted = solve_span(Span(**case.inputs())).stiffness, np.array(truth.stiffness)
        finite = np.isfinite(wanted)
        same_infinities = np.array_equal(got[~finite], wanted[~finite])
        error = np.max(np.abs(got[finite] - wanted[finite])) / (np.max(np.abs(wanted[finite])) or 1.0)
        bound = WORST_ERROR * EPS * (1 + truth.condition + stiffness_condition(case, truth))
        if not (same_infinities and error <= bound):
            misses.append(
                f"{case.name}: got {got.tolist()}, wanted {wanted.tolist()}, "
                f"relative to the largest {error:.3g}, may {bound:.3g}"
            )
    return misses


def iteration_misses(rows) -> list[str]:
    """Lines that take more evaluations than Newton's method from a good start; and the mean, which rises first."""
    counts = [(solve_span(Span(**case.inputs())).iterations, case.name) for case, _ in rows]
    misses = [f"{name}: {count} evaluations" for count, name in counts if count > MOST_STEPS]
    mean = sum(count for count, _ in counts) / len(counts)
    return misses + ([f"{mean:.3g} evaluations in the mean"] if mean > MEAN_STEPS else [])


def report(record_property, errors, title):
    """Print the worst and the median error and record them in the JUnit file; returns the median."""
    worst, name = max((error, name) for error, name in errors if not math.isnan(error))
    middle = median(error for error, _ in errors)
    record_property("worst_case", name)
    record_property("worst_error_in_limits", worst)
    record_property("median_error_in_limits", middle)
    record_property("lines", len(errors))
    print(f"{title}: worst {name} {worst:.3g} limits, median {middle:.3g} limits, {len(errors)} lines")
    return middle


# ---------------------------------------------------------------- the reference table
@pytest.mark.parametrize("solver", PROBLEMS["span"].solvers)
def test_forces_equal_the_reference_table(solver, record_property):
    """Every reference line is answered, none wrong: error <= 100, median <= 4 condition limits."""
    misses, errors = force_misses(span_references(), PROBLEMS["span"].solvers[solver])
    middle = report(record_property, errors, f"{solver}, reference table")
    assert not misses, f"{len(misses)} bad lines\n" + "\n".join(misses)
    assert middle <= MEDIAN_ERROR


def test_anchor_forces_equal_the_reference_table():
    """The force at the anchor is as accurate as that at the fairlead."""
    misses = anchor_misses(span_references())
    assert not misses, "\n".join(misses)


def test_grounded_length_equals_the_reference_table():
    """The touchdown point is right to the accuracy of the force that carries what hangs; zero is exactly zero."""
    misses = grounded_misses(span_references())
    assert not misses, "\n".join(misses)


def test_stiffness_equals_the_reference_table():
    """The stiffness is right to its own condition: that of the least tension in the line."""
    misses = stiffness_misses(span_references())
    assert not misses, "\n".join(misses)


def test_stiffness_limit_is_rarely_vacuous():
    """Where kappa < 1e6, the limit of the stiffness lets more than 1e-6 pass in fewer than 5 % of the rows."""
    well = [(case, truth) for case, truth in span_references() if truth.condition < 1e6]
    loose = [case.name for case, truth in well if WORST_ERROR * EPS * stiffness_condition(case, truth) > 1e-6]
    assert len(loose) < 0.05 * len(well), loose


def test_few_evaluations_from_no_guess():
    """Every reference line is solved in at most 8 evaluations, 3 in the mean, without any starting value."""
    misses = iteration_misses(span_references())
    assert not misses, "\n".join(misses)


# ---------------------------------------------------------------- random lines
@pytest.mark.parametrize("chunk", range(CHUNKS))
@pytest.mark.parametrize("solver", PROBLEMS["span"].solvers)
def test_random_lines(solver, chunk, deep, record_property):
    """Random lines over every regime: 0 refused, 0 wrong, error <= 100, median <= 4 condition limits."""
    solve = PROBLEMS["span"].solvers[solver]
    cases = random_cases(RANDOM_LINES[deep], RANDOM_SEED)[chunk::CHUNKS]
    misses, errors = force_misses([(case, exact_near(case)) for case in cases], solve)
    middle = report(record_property, errors, f"{solver}, random lines {chunk}")
    assert not misses, f"{len(misses)} bad lines\n" + "\n".join(misses)
    assert middle <= MEDIAN_ERROR


def exact_near(case: SpanCase) -> SpanTruth:
    """Return the exact solution of a case; the solver's force is only where the oracle starts."""
    state = solve_span(Span(**case.inputs()), throw=False)
    return exact_span(case, (state.H, state.V) if state.success and state.H > 0 else None)


QUARTER = settings(  # of the examples of the run, for either family; shrinking at 40 ms an example would take minutes
    max_examples=settings().max_examples // 4, phases=(Phase.explicit, Phase.reuse, Phase.generate)
)


@QUARTER
@given(suspended_cases())
def test_any_free_line_agrees_with_50_digits(case):
    """The force of any line without seabed is within 100 condition limits of the exact one."""
    misses, _ = force_misses([(case, exact_near(case))], PROBLEMS["span"].solvers["catenary"])
    assert not misses, misses[0]


@QUARTER
@given(seabed_cases())
def test_any_line_over_a_seabed_agrees_with_50_digits(case):
    """So is that of any line over a seabed, with friction or with a raised anchor."""
    misses, _ = force_misses([(case, exact_near(case))], PROBLEMS["span"].solvers["catenary"])
    assert not misses, misses[0]


# ---------------------------------------------------------------- worked by hand
def test_catenary_of_parameter_one():
    """y = cosh x between -arsinh 1 and arsinh 1: slope 1 at the ends, length 2 m, so H = w a = V = w L/2 = 10 N."""
    # EA = 1e18 N stretches the line by 1e-17 of its length: below rounding
    state = solve_span(Span(w=10.0, EA=1e18, L=2.0, x=2 * math.asinh(1.0), z=0.0, seabed=False))
    assert state.H == pytest.approx(10.0, rel=4 * HAND)  # dH/dx x/H = 3.1: the rounding of x alone counts threefold
    assert state.V == pytest.approx(10.0, rel=HAND)
    assert state.V_anchor == pytest.approx(-10.0, rel=HAND)
    assert state.tension == pytest.approx(10.0 * math.sqrt(2), rel=4 * HAND)


def test_half_catenary_on_the_seabed():
    """The right half of the same curve with 3 m of line on the seabed: x = 3 + arsinh 1, z = cosh(arsinh 1) - 1."""
    state = solve_span(Span(w=10.0, EA=1e18, L=4.0, x=3.0 + math.asinh(1.0), z=math.sqrt(2.0) - 1.0))
    assert state.H == pytest.approx(10.0, rel=20 * HAND)  # kappa = 40
    assert state.V == pytest.approx(10.0, rel=20 * HAND)
    assert state.grounded_length == pytest.approx(3.0, rel=20 * HAND)
    assert state.regime is Regime.GROUNDED


def test_parallel_catenary_with_stretch():
    """H = 3, V = 4 N, w = 1 N/m, EA = 10 N, anchor level: L = 4 m, x = 3 arsinh(4/3) + 12/10, z = 2 + 16/20 m."""
    state = solve_span(Span(w=1.0, EA=10.0, L=4.0, x=3 * math.log(3.0) + 1.2, z=2.8, seabed=False))
    assert (state.H, state.V) == pytest.approx((3.0, 4.0), rel=4 * HAND)
    assert (state.H_anchor, state.V_anchor) == pytest.approx((3.0, 0.0), abs=12 * HAND)


def test_weightless_spring_3_4_5():
    """A weightless spring of 2.5 m and EA = 100 N pulled to (3, 4) m: strain 1, T = 100 N, H = 60, V = 80 N."""
    state = solve_span(Span(w=0.0, EA=100.0, L=2.5, x=3.0, z=4.0))
    assert (state.H, state.V, state.H_anchor, state.V_anchor) == (60.0, 80.0, 60.0, 80.0)
    # along the line EA/L = 40, across it T/chord = 20 N/m
    assert state.stiffness.tolist() == pytest.approx(np.array([[27.2, 9.6], [9.6, 32.8]]), rel=HAND)


def test_slack_spring_pulls_nothing():
    """A weightless line longer than its chord has no force and no stiffness."""
    state = solve_span(Span(w=0.0, EA=100.0, L=10.0, x=3.0, z=4.0))
    assert (state.H, state.V) == (0.0, 0.0)
    assert not state.stiffness.any()


def test_slack_line_hangs_straight_down():
    """z = s + w s^2/(2 EA) with s = 4 m, w = 2 N/m, EA = 16 N: z = 5 m, V = w s = 8 N, 6 of 10 m lie on the seabed."""
    state = solve_span(Span(w=2.0, EA=16.0, L=10.0, x=5.0, z=5.0))
    assert (state.H, state.V, state.V_anchor, state.grounded_length) == (0.0, 8.0, 0.0, 6.0)
    assert state.stiffness.tolist() == [[0.0, 0.0], [0.0, 2.0 / 1.5]]  # w/(1 + V/EA)
    assert state.regime is Regime.SLACK


def test_slack_line_over_a_raised_anchor():
    """Both ends hang straight down: anchor 5 m and fairlead 5 m above the seabed carry 8 N each."""
    state = solve_span(Span(w=2.0, EA=16.0, L=10.0, x=1.0, z=0.0, clearance=5.0))
    got = (state.H, state.V, state.V_anchor, state.grounded_length)
    assert got == pytest.approx((0.0, 8.0, -8.0, 2.0), rel=HAND)


# w = 1 N/m, EA = 100 N, L = 10 m, z = 0: x, friction and, from the integral of the friction, H, H_anchor, K11
LYING = [
    (11.0, 0.0, 10.0, 10.0, 10.0),  # EA (x/L - 1); EA/L
    (11.0, 0.5, 12.5, 7.5, 10.0),  # + CB w L/2; the anchor feels CB w L less
    (10.4, 0.5, 6.5, 1.5, 10.0),  # the same, barely pulled: H - CB w L = 1.5 N
    (10.2, 0.5, math.sqrt(20.0), 0.0, 50.0 / math.sqrt(20.0)),  # H^2 = 2 CB w EA (x - L): friction holds it all
]


def lying_misses() -> list[str]:
    """Lines stretched along the seabed against their integrals."""
    misses = []
    for x, friction, *wanted in LYING:
        state = solve_span(Span(w=1.0, EA=100.0, L=10.0, x=x, z=0.0, friction=friction))
        got = [state.H, state.H_anchor, state.stiffness[0, 0]]
        # x is given to eps, the stretch x - L to x/(x - L) eps
        if got != pytest.approx(wanted, rel=x / (x - 10.0) * HAND, abs=0.0):
            misses.append(f"x {x} m, friction {friction}: got {got}, wanted {wanted}")
        if (state.V, state.grounded_length, state.stiffness[1, 1]) != (0.0, 10.0, math.inf):
            misses.append(f"x {x} m, friction {friction}: {state}")
    return misses


def test_line_stretched_along_the_seabed():
    """A line that lies pulls by its stretch and by the friction under it, all along it or over H/(CB w) only."""
    misses = lying_misses()
    assert not misses, "\n".join(misses)


@pytest.mark.parametrize(
    ("z", "V", "V_anchor"),
    [
        (12.0, 25.0, 15.0),  # z = L + (V + V_anchor) L/(2 EA)
        (-12.0, -15.0, -25.0),
        (0.0, 5.0, -5.0),  # folded in the middle
        (2.1, 6.0, -4.0),  # 6 m of it hang below the fairlead, 4 below the anchor: z = 6 - 4 + (36 - 16)/200
    ],
)
def test_vertical_line(z, V, V_anchor):
    """w = 1 N/m, EA = 100 N, L = 10 m, x = 0: a spring under its own weight, or a folded one."""
    state = solve_span(Span(w=1.0, EA=100.0, L=10.0, x=0.0, z=z, seabed=False))
    assert (state.H, state.V, state.V_anchor) == pytest.approx((0.0, V, V_anchor), rel=HAND, abs=10 * HAND)
    assert state.regime is Regime.VERTICAL
    taut = abs(z) > 10.5
    assert state.stiffness[1, 1] == pytest.approx(10.0 if taut else 1 / 2.1, rel=HAND)  # EA/L, or 1/(2/w + L/EA)
    assert state.stiffness[0, 0] == (pytest.approx(1 / (math.log(25 / 15) + 0.1), rel=4 * HAND) if taut else 0.0)


@pytest.mark.parametrize(("x", "z"), [(90.0, 10.0), (95.0, -4.0), (93.0, 0.0)])
def test_a_line_that_rests_between_raised_ends(x, z):
    """Forces, touchdown, positions and tension of a sagging line: its higher end is the fairlead, or the anchor."""
    span = Span(30.0, 1e6, 100.0, x, z, clearance=5.0)
    state, inputs = solve_span(span), {name: getattr(span, name) for name in Span.__slots__}
    assert state.regime is Regime.SAGGING
    exact = catenary_mp.solve(**inputs)
    for name in ("H", "V", "H_anchor", "V_anchor"):
        assert getattr(state, name) == pytest.approx(float(getattr(exact, name)), rel=1e-12)
    s = np.linspace(0.0, 100.0, 12)
    wanted = np.array([[float(v) for v in catenary_mp.profile(one, **inputs, solution=exact)] for one in s]).T
    for got, right, unit in zip(state.profile(s), wanted, (100.0, 100.0, state.tension), strict=True):
        assert abs(got - right).max() <= 1e-11 * unit
