"""Can every check turn red? Planted mistakes, each with the checks that must turn red on it.

A check that no defect can turn red is not a check. The mistakes are slips that a programmer makes: a factor, a sign, a
forgotten branch, a naive difference. They are planted in functions of the solver itself.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import pytest

from solvers.catenary import regimes
from solvers.numerics.elementary import SCALAR

from ..cases.spans import SpanCase
from ..reference import EPS, SpanTruth, force_error, span_references
from ..registry import PROBLEMS, SpanAnswer, catenary
from ..tools.jacobians import (
    COMPLEX,
    Complex,
    Kernel,
    derivative,
    implicit_stiffness,
    newton_step_error,
    ordinary_kernels,
)
from ..tools.planting import Fault, plant_in_place
from .test_cross_solver import batch_misses, batch_of
from .test_exact import (
    allowed,
    anchor_misses,
    force_misses,
    grounded_misses,
    iteration_misses,
    lying_misses,
    stiffness_misses,
)
from .test_invariants import swap_misses
from .test_jacobian import difference_misses, difference_spans, implicit_stiffness_misses, newton_step_misses

KERNELS = ordinary_kernels()  # by the solver as it is, before anything is planted

ROWS = [case for case, _ in span_references()]

CHECKS = {
    "forces": lambda: force_misses(span_references(), catenary)[0],
    "anchors": lambda: anchor_misses(span_references()),
    "grounded": lambda: grounded_misses(span_references()),
    "stiffness": lambda: stiffness_misses(span_references()),
    "evaluations": lambda: iteration_misses(span_references()),
    "newton steps": lambda: newton_step_misses(KERNELS),
    "implicit stiffness": lambda: implicit_stiffness_misses(KERNELS),
    "differences": lambda: difference_misses(difference_spans()),
    "batch": lambda: batch_misses(ROWS, batch_of(ROWS)),
    "lying": lying_misses,
    "swapped ends": lambda: swap_misses(ROWS),
}


@dataclass(frozen=True)
class Slip:
    """A fault, and the ``checks`` that must all turn red on it."""

    fault: Fault
    checks: tuple[str, ...]


def slip(fault: Fault, *checks: str) -> Slip:
    """Return a fault with the checks that must turn red."""
    return Slip(fault, checks)


SLIPS = [
    slip(
        Fault("catenary.regimes", "hanging_length", "2 * h / (1 + f.sqrt(1 + 2 * e * h))", "1 * h"),
        "forces",
        "grounded",
    ),
    slip(Fault("catenary.regimes", "cosh_excess", "y2 / 28", "y2 / 26"), "newton steps", "implicit stiffness"),
    slip(Fault("catenary.suspended", "_suspended_angle", "e / 2 / s * c", "e / s * c"), "forces", "newton steps"),
    slip(
        Fault(
            "catenary.suspended",
            "_suspended_step",
            "(cosh_excess(f, y, s, c) + e / 2 * c) / (y + e / 2)",
            "(cosh_excess(f, y, s, c) + e / 2 * c) / (y + e)",
        ),
        "newton steps",
        "evaluations",
    ),
    slip(
        Fault(
            "catenary.suspended", "_suspended_step", "f.sqrt(one_minus_v * (1 + v))", "f.sqrt(one_minus_v * (1 - v))"
        ),
        "forces",
    ),
    slip(Fault("catenary.suspended", "suspended_state", "f.where(h.real < 0, -1.0, 1.0)", "1.0"), "swapped ends"),
    slip(Fault("catenary.suspended", "_suspended_state", "mean - 0.5", "mean + 0.5"), "anchors"),
    slip(
        Fault("catenary.suspended", "_suspended_state", "up * 2", "-up * 2"),
        "stiffness",
        "implicit stiffness",
        "differences",
    ),
    slip(Fault("catenary.suspended", "_steep_angle", "t / (1 + t / y_max)", "t / (1 + 2 * t / y_max)"), "forces"),
    slip(Fault("catenary.suspended", "steep_residual", "step * (t / y)", "step"), "newton steps"),
    slip(
        Fault(
            "catenary.regimes",
            "lowest_point",
            "b * b * (1 / (f.sqrt(H * H + b * b) + H + TINY) + e / 2)",
            "0 * b * (1 / (f.sqrt(H * H + b * b) + H + TINY) + e / 2)",
        ),
        "forces",
        "grounded",
    ),
    slip(Fault("catenary.regimes", "_end_compliance", "-V", "V"), "newton steps", "implicit stiffness"),
    slip(Fault("catenary.regimes", "_grounded_forces", "2 * e * h", "e * h"), "forces", "grounded"),
    slip(
        Fault(
            "catenary.regimes",
            "_grounded_forces",
            "2 * s * s",
            "f.sqrt(1 + f.sinh(p) * f.sinh(p)) - 1",
            where="f.sinh(p / 2)",
        ),
        "evaluations",
    ),
    slip(Fault("catenary.regimes", "hanging_force", "h + 2 * H", "h + H"), "forces"),
    slip(Fault("catenary.regimes", "friction_stretch", "H - drag / 2", "H + drag / 2"), "forces", "newton steps"),
    slip(Fault("catenary.regimes", "friction_stretch", "H / 2 * limit", "H * limit"), "forces", "newton steps"),
    slip(
        Fault(
            "catenary.regimes",
            "friction_stretch",
            "stretch, f.where(pulled, grounded, limit), f.where(pulled, drag, H)",
            "stretch, f.where(pulled, grounded, limit), drag",
        ),
        "stiffness",
        "implicit stiffness",
        "newton steps",
    ),
    slip(Fault("catenary.regimes", "grounded_residual", "grounded + H * (p + angle)", "grounded + H * p"), "forces"),
    slip(Fault("catenary.regimes", "grounded_state", "(H - CB * grounded).real", "H.real"), "anchors"),
    slip(
        Fault(
            "catenary.regimes", "grounded_state", "f.maximum((H - CB * grounded).real, 0.0)", "(H - CB * grounded).real"
        ),
        "anchors",
    ),
    slip(Fault("catenary.regimes", "grounded_state", "1 - V - Vc", "1 - V"), "grounded"),
    slip(
        Fault("catenary.regimes", "grounded_state", "F12 + e * lost", "F12"),
        "stiffness",
        "implicit stiffness",
        "differences",
    ),
    slip(
        Fault(
            "catenary.regimes",
            "grounded_state",
            "f.where(F22 > 0, F22, 1.0) / determinant, -C12 / determinant, -F12 / determinant",
            "f.where(F22 > 0, F22, 1.0) / determinant, -F12 / determinant, -C12 / determinant",
        ),
        "stiffness",
        "implicit stiffness",
    ),
    slip(Fault("catenary.regimes", "lying_force", "stretch < CB / 2", "stretch < CB"), "lying"),
    slip(Fault("catenary.regimes", "lying_force", "stretch + CB / 2", "stretch"), "forces"),
    slip(
        Fault("catenary.regimes", "slack_state", "0 - hanging_length(f, c, e)", "hanging_length(f, c, e)"),
        "anchors",
        "grounded",
    ),
    slip(Fault("catenary.regimes", "vertical_state", "1 / (spread + e)", "1 / spread"), "stiffness"),
    slip(Fault("catenary.regimes", "vertical_state", "height / (2 + e)", "height / 2"), "forces"),
    slip(Fault("catenary.regimes", "massless_state", "along - across", "along + across"), "stiffness", "differences"),
    slip(Fault("catenary.solve", "_nondimensional", "up * z / L", "z / L"), "forces"),
    slip(Fault("catenary.regimes", "rests_from_anchor", "h - e / 2", "h"), "forces"),
    slip(Fault("numerics.newton", "_advance", "1 + step", "1 + 0.9 * step"), "evaluations"),
    slip(
        Fault(
            "numerics.newton",
            "_advance",
            "(abs(g) <= tolerance) | (abs(step) <= tolerance)",
            "(abs(g) <= tolerance) | (abs(step) <= 1e-3)",
        ),
        "forces",
    ),
    slip(
        Fault(
            "numerics.newton",
            "monotone_roots",
            "iterations[rows[left]] += iteration < MAX_ITERATIONS",
            "iterations[left] += iteration < MAX_ITERATIONS",
        ),
        "batch",
    ),
    slip(
        Fault(
            "numerics.newton",
            "monotone_roots",
            "root[rows], value[rows], converged[rows] = t, abs(g), finished",
            "root[: rows.size], value[rows], converged[rows] = t, abs(g), finished",
        ),
        "batch",
    ),
]


def red(check: str) -> str:
    """Return the first sentences of a check, or the exception it ends in; empty where it passes."""
    try:
        return "\n".join(CHECKS[check]()[:3])
    except (ArithmeticError, ValueError, RuntimeError, RuntimeWarning) as error:
        return repr(error)


@pytest.mark.parametrize("check", CHECKS)
def test_checks_are_content_with_the_solver(check):
    """Every check passes on the solver as it is, so that what it reports below is the planted mistake."""
    assert not red(check)


@pytest.mark.parametrize("slip", SLIPS, ids=lambda slip: f"{slip.fault.function}: {slip.fault.old} -> {slip.fault.new}")
def test_a_planted_mistake_is_found(slip, monkeypatch):
    """Each named check turns red on the mistake."""
    plant_in_place(slip.fault, monkeypatch)
    for check in slip.checks:
        assert red(check), f"{check} did not see {slip.fault}"


def test_every_check_is_shown_to_turn_red():
    """No check is left that no planted mistake is named for."""
    assert {check for slip in SLIPS for check in slip.checks} == CHECKS.keys()


def test_a_threshold_far_too_large_is_found(monkeypatch):
    """Lines of ordinary weight taken for weightless springs: the forces show it."""
    monkeypatch.setattr(regimes, "MASSLESS_STRAIN", 1e-3)
    assert red("forces") and red("stiffness")


# ---------------------------------------------------------------- the measures themselves
TRUTH = SpanTruth(3.0, 4.0, 3.0, -1.0, 0.0, ((1.0, 0.0), (0.0, 1.0)), 9.0)
CASE = SpanCase("planted", "suspended", 1.0, 1e3, 5.0, 1.0, 1.0)


@pytest.mark.parametrize(("H", "V", "error"), [(3.5, 4.0, 0.1), (3.0, 3.5, 0.1), (3.5, 4.25, 0.1), (-3.0, 4.0, 1.2)])
def test_force_error_measures_a_planted_error(H, V, error):
    """The larger error of H and V over the tension; the sign counts."""
    assert force_error(H, V, TRUTH, CASE) == pytest.approx(error, rel=4 * EPS)


def test_force_error_has_no_blind_spot():
    """NaN is an infinite error; where the truth is zero the weight is the scale, and where that is zero, EA."""
    assert force_error(math.nan, 4.0, TRUTH, CASE) == math.inf
    nothing = replace(TRUTH, H=0.0, V=0.0)
    assert force_error(0.5, 0.0, nothing, CASE) == 0.1
    assert force_error(10.0, 0.0, nothing, replace(CASE, w=0.0)) == 0.01


@pytest.mark.parametrize("factor", [1 + 200 * 10 * EPS, 0.9, -1.0, math.nan])
def test_the_force_check_sees_a_perturbed_answer(factor):
    """An error of 200 condition limits in H, a tenth, a sign, NaN: each is reported with the numbers."""

    def perturbed(case):
        return SpanAnswer(TRUTH.H * factor if abs(factor) < 1.1 else factor, TRUTH.V * (2 - factor), 1)

    misses, _ = force_misses([(CASE, TRUTH)], perturbed)
    assert len(misses) == 1 and "wanted (3.0, 4.0)" in misses[0] and "x allowed" in misses[0]
    assert not force_misses([(CASE, TRUTH)], lambda case: SpanAnswer(3.0, 4.0, 1))[0]


def test_the_force_check_sees_a_refusal():
    """A refused valid line is as bad as a wrong one."""
    misses, _ = force_misses([(CASE, TRUTH)], lambda case: SpanAnswer(refused="no"))
    assert "refused" in misses[0] or ": no:" in misses[0]


def test_an_infinite_condition_still_bounds_the_error():
    """Where the condition is infinite the check still asks for the square root of the rounding."""
    assert allowed(replace(TRUTH, condition=math.inf)) < 1e-5


def test_every_solver_of_the_registry_is_examined():
    """The table of solvers has the one that the planted mistakes are shown on."""
    assert PROBLEMS["span"].solvers["catenary"] is catenary


# ---------------------------------------------------------------- the complex-step helper
class Faulty(Kernel):
    """A kernel whose Newton step and stiffness are off by a factor."""

    def residual(self, f, t, l, h):
        g, step = super().residual(f, t, l, h)
        return g, step * FACTOR

    def state(self, f, t, l, h):
        forces, (K11, K12, K21, K22) = super().state(f, t, l, h)
        return forces, (K11 * FACTOR, K12, K21, K22)


FACTOR = 1.0


@pytest.mark.parametrize("factor", [1.01, 0.99, -1.0, 1 + 1e-8])
def test_the_jacobian_checks_see_a_wrong_factor(factor, monkeypatch):
    """One per cent, a sign, and even 1e-8 in a Newton step or in K11 are seen."""
    good = KERNELS[0]
    faulty = Faulty(good.regime, good.l, good.h, good.e, good.CB, good.c)
    assert not newton_step_misses([faulty]) and not implicit_stiffness_misses([faulty])
    root = good.root()
    monkeypatch.setattr("verification.catenary.test_checks.FACTOR", factor)
    assert newton_step_error(faulty, 1.1 * root) == pytest.approx(abs(factor - 1), rel=1e-3)
    right = good.state(SCALAR, root, good.l, good.h)[1]
    wrong = faulty.state(SCALAR, root, good.l, good.h)[1]
    assert abs(wrong[0] - implicit_stiffness(good, root)[0]) > 0.5e-8 * right[0]


def test_complex_step_differentiates():
    """x^3 by products and quotients, and every elementary function, to a few eps of the derivative known by hand."""
    x = 0.7
    for function, wanted in (
        (lambda x: x * x * x, 3 * x * x),
        (lambda x: 1 / x - 2.0 - -x, 1 - 1 / x**2),
        (COMPLEX.sqrt, 0.5 / math.sqrt(x)),
        (COMPLEX.sinh, math.cosh(x)),
        (COMPLEX.log, 1 / x),
        (COMPLEX.arcsinh, 1 / math.sqrt(1 + x * x)),
        (COMPLEX.log1p, 1 / (1 + x)),
    ):
        assert derivative(function, x) == pytest.approx(wanted, rel=8 * EPS)


def test_complex_numbers_are_ordered_by_their_real_part():
    """Branches and maxima of the formulae are taken as for real numbers."""
    a, b = Complex(1.0, 5.0), Complex(2.0, -5.0)
    assert a < b and b > a and a <= 1.0 <= a and b < 3.0 and max(a, b, 1.5) is b and min(a, 0.5) == 0.5
    assert isinstance(2.0 * a - b / 3.0, Complex) and isinstance(-a, Complex)
