"""Are the derivatives right? Newton steps, then the stiffness of each regime, then that of the assembled solver."""

from __future__ import annotations

import math
from collections import Counter

import numpy as np
import pytest

from solvers import Regime, Span, solve_span

from ..cases.spans import NAMED, OC3
from ..reference import EPS, span_references
from ..tools.jacobians import ITERATED, newton_step_error, ordinary_kernels, stiffness_error

# Complex step makes no error of its own: what remains is the rounding of the closed forms, at most 1e6 eps where the
# reach is the small difference of 1 and what hangs (nearly slack), a few eps elsewhere.
STEP_ERROR, STEP_MEDIAN = 1e6 * EPS, 20 * EPS
STIFFNESS_ERROR, STIFFNESS_MEDIAN = 1e4 * EPS, 20 * EPS
FROM_THE_ROOT = (0.5, 0.9, 1.1, 2.0)  # the unknown over the root: a step is compared where it is not small
DIFFERENCE_STEP = 1e-6  # of L; central differences lose eps kappa/1e-6 to rounding, about as much to curvature
DIFFERENCE_ERROR = 1e-5


# ---------------------------------------------------------------- checks: each returns a sentence for every error
def newton_step_misses(kernels) -> list[str]:
    """Newton steps of the residuals against complex step."""
    misses = []
    for kernel in kernels:
        root = kernel.root()
        for factor in FROM_THE_ROOT:
            error = newton_step_error(kernel, factor * root)
            if not error <= STEP_ERROR:
                misses.append(f"{kernel}: at {factor} of the root the step is off by {error:.3g}")
    return misses


def implicit_stiffness_misses(kernels) -> list[str]:
    """Stiffness formulae against one complex Newton correction at the root."""
    errors = [(stiffness_error(kernel, kernel.root()), kernel) for kernel in kernels]
    return [f"{kernel}: off by {error:.3g} of the largest" for error, kernel in errors if not error <= STIFFNESS_ERROR]


def difference_misses(spans) -> list[str]:
    """Stiffness of the solver against central differences of its forces."""
    misses = []
    for span in spans:
        K, wanted = solve_span(span).stiffness, central_stiffness(span)
        error = np.max(np.abs(K - wanted)) / np.max(np.abs(wanted))
        if not error <= DIFFERENCE_ERROR:
            misses.append(f"{span}: got {K.tolist()}, wanted {wanted.tolist()}, off by {error:.3g} of the largest")
    return misses


def central_stiffness(span: Span) -> np.ndarray:
    """Return central differences (2, 2) of (H, V) for a fairlead displaced by DIFFERENCE_STEP L, N/m."""
    columns = []
    for direction in ((1, 0), (0, 1)):
        ends = []
        for sign in (1, -1):
            dx, dz = (sign * DIFFERENCE_STEP * span.L * part for part in direction)
            state = solve_span(displaced(span, dx, dz))
            ends.append(np.array([state.H, state.V]))
        columns.append((ends[0] - ends[1]) / (2 * DIFFERENCE_STEP * span.L))
    return np.column_stack(columns)


def displaced(span: Span, dx: float, dz: float) -> Span:
    """Return the line with its fairlead displaced by (dx, dz), m."""
    return Span(span.w, span.EA, span.L, span.x + dx, span.z + dz, span.seabed, span.friction, span.clearance)


# ---------------------------------------------------------------- first layer: the Newton steps
@pytest.mark.parametrize("regime", ITERATED)
def test_newton_steps_agree_with_complex_step(regime):
    """Away from the root, the Newton step of every regime's residual is that of its derivative by complex step."""
    kernels = [kernel for kernel in ordinary_kernels() if kernel.regime is regime]
    assert len(kernels) > 40
    misses = newton_step_misses(kernels)
    assert not misses, "\n".join(misses)
    errors = [newton_step_error(kernel, factor * kernel.root()) for kernel in kernels for factor in FROM_THE_ROOT]
    assert np.median(errors) <= STEP_MEDIAN


def test_kernels_cover_friction_pulled_and_not():
    """There are kernels where tension reaches the anchor, where friction takes it all, and without friction."""
    counts = Counter()
    for kernel in ordinary_kernels():
        if kernel.regime is Regime.GROUNDED:
            H_anchor = solve_span(Span(1.0, 1 / kernel.e, 1.0, kernel.l, kernel.h, friction=kernel.CB)).H_anchor
            counts["none" if kernel.CB == 0 else "pulled" if H_anchor > 0 else "fixed"] += 1
    assert min(counts["none"], counts["pulled"], counts["fixed"]) > 10, counts


# ---------------------------------------------------------------- second layer: the stiffness of each regime
@pytest.mark.parametrize("regime", ITERATED)
def test_stiffness_agrees_with_complex_step(regime):
    """The 2 x 2 stiffness of every iterated regime is that of the implicit solution by complex step."""
    kernels = [kernel for kernel in ordinary_kernels() if kernel.regime is regime]
    misses = implicit_stiffness_misses(kernels)
    assert not misses, "\n".join(misses)
    assert np.median([stiffness_error(kernel, kernel.root()) for kernel in kernels]) <= STIFFNESS_MEDIAN


# ---------------------------------------------------------------- third layer: the assembled solver
def difference_spans() -> list[Span]:
    """Return lines of every regime for central differences: named, buoyant, raised, slack, lying, vertical."""
    return [Span(**case.inputs()) for case in NAMED if case.name != "chord-equal-to-length"] + [
        Span(-30.0, 1e6, 100.0, 70.0, 40.0, seabed=False),
        Span(30.0, 1e6, 100.0, 70.0, -40.0, seabed=False),
        Span(30.0, 1e6, 100.0, 80.0, 10.0, clearance=5.0),
        Span(30.0, 1e6, 100.0, 80.0, -4.0, clearance=5.0),
        Span(30.0, 1e6, 100.0, 50.0, 30.0),
        Span(30.0, 1e4, 100.0, 30.0, 160.0, seabed=False),
        Span(-30.0, 1e4, 100.0, 30.0, -160.0, seabed=False),
        Span(0.0, 1e5, 100.0, 90.0, 60.0),
    ]


def test_stiffness_agrees_with_central_differences():
    """Moving the fairlead changes the force by the stiffness: signs, units and mirrors of the assembled solver."""
    misses = difference_misses(difference_spans())
    assert not misses, "\n".join(misses)


def test_sideways_stiffness_at_the_edges():
    """Where only one side exists (x = 0, or z = 0 on the seabed), K11 is the slope into the admissible side."""
    step = 1e-7
    for span in (Span(1.0, 100.0, 10.0, 0.0, 12.0, seabed=False), Span(1.0, 100.0, 10.0, 10.4, 0.0, friction=0.2)):
        wanted = (solve_span(displaced(span, step, 0.0)).H - solve_span(span).H) / step
        assert solve_span(span).stiffness[0, 0] == pytest.approx(wanted, rel=1e-5)


def test_stiffness_is_symmetric_without_friction():
    """Without friction the force has a potential: K12 = K21 to the rounding of the largest entry."""
    for case, _ in span_references():
        K = solve_span(Span(**case.inputs())).stiffness
        if case.friction == 0 and np.all(np.isfinite(K)):
            assert abs(K[0, 1] - K[1, 0]) <= 4 * EPS * np.max(np.abs(K)), (case.name, K)


def test_stiffness_is_positive_definite_without_friction():
    """The complementary energy is convex: no direction in which the fairlead can be moved against less force."""
    checked = 0
    for case, truth in span_references():
        state = solve_span(Span(**case.inputs()))
        K = state.stiffness
        if case.friction or not np.all(np.isfinite(K)) or not 0 < np.max(np.abs(K)) < 1e100:
            continue
        trace, determinant = K[0, 0] + K[1, 1], K[0, 0] * K[1, 1] - K[0, 1] * K[1, 0]
        # the determinant of the rounded entries is known to a few eps of the square of the largest
        assert K[0, 0] >= 0 and K[1, 1] >= 0 and determinant >= -8 * EPS * trace**2, (case.name, K)
        if truth.H > 1e-6 * abs(truth.V) and truth.condition < 1e6:
            assert determinant > 0, (case.name, K)
            checked += 1
    assert checked > 100


@pytest.mark.parametrize(("friction", "pulled"), [(0.5, True), (5.0, False)])
def test_friction_breaks_the_symmetry(friction, pulled):
    """With friction K12 < K21: the compliances differ by the friction term of d(2.23a)/dV alone."""
    state = solve_span(Span(1.0, 50.0, 1.0, 0.95, 0.2, friction=friction))
    assert (state.H_anchor > 0) is pulled
    K = state.stiffness
    C = np.linalg.inv(K)
    # CB L_B/EA while tension reaches the anchor, else H/(EA w); w = L = 1
    wanted = friction * state.grounded_length / 50.0 if pulled else state.H / 50.0
    assert C[0, 1] - C[1, 0] == pytest.approx(wanted, rel=1e-12 * np.max(np.abs(C)) / wanted)
    assert K[0, 1] < K[1, 0]


def test_oc3_stiffness_has_the_expected_size():
    """Pulled along its chord, the OC3 line is softer than the spring EA/L and stiffer than nothing."""
    K = solve_span(Span(**OC3)).stiffness
    along = np.array([OC3["x"], OC3["z"]]) / math.hypot(OC3["x"], OC3["z"])
    assert 0 < along @ K @ along < OC3["EA"] / OC3["L"]
