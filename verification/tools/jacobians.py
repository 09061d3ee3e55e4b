"""Derivatives by complex step, and the checks of the solver's derivatives that use them.

f(x + i eps) = f(x) + i eps f'(x) + O(eps^2): no difference, so no cancellation, and eps = 1e-30 leaves no truncation.
The formulae of ``catenary.regimes`` and ``catenary.suspended`` take the namespace COMPLEX as they take SCALAR or ARRAY.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from itertools import product
from types import SimpleNamespace

from solvers import Regime, Span, solve_span
from solvers.catenary import regimes, suspended
from solvers.catenary.span import TOLERANCE
from solvers.numerics import newton
from solvers.numerics.elementary import SCALAR

from ..cases.spans import SpanCase

STEP = 1e-30
"""Relative imaginary step: its square, 1e-60, is below every rounding."""


class Complex(complex):
    """A complex number ordered by its real part, as the real number that it stands for."""

    def __neg__(self):
        return Complex(complex.__neg__(self))

    def __lt__(self, other):
        return self.real < other.real

    def __le__(self, other):
        return self.real <= other.real

    def __gt__(self, other):
        return self.real > other.real

    def __ge__(self, other):
        return self.real >= other.real


def _closed(name):
    plain = getattr(complex, name)

    def operation(self, other):
        result = plain(self, other)
        return result if result is NotImplemented else Complex(result)

    return operation


for _name in ("add", "radd", "sub", "rsub", "mul", "rmul", "truediv", "rtruediv"):
    setattr(Complex, f"__{_name}__", _closed(f"__{_name}__"))


def _analytic(function):
    return lambda x: Complex(function(x))


COMPLEX = SimpleNamespace(
    where=lambda condition, a, b: a if condition else b,
    any=bool,
    minimum=min,
    maximum=max,
    sqrt=_analytic(cmath.sqrt),
    sinh=_analytic(cmath.sinh),
    log=_analytic(cmath.log),
    arcsinh=_analytic(cmath.asinh),
    log1p=lambda x: Complex(math.log1p(x.real), x.imag / (1 + x.real)),  # cmath has none; first order is all of it
)
"""The elementary functions for complex step; what is only used for first guesses is left out."""


def derivative(function, x: float) -> float:
    """f'(x) of a function of one Complex number."""
    size = STEP * (abs(x) or 1.0)
    return function(Complex(x, size)).imag / size


# ---------------------------------------------------------------- the regimes that are solved by iteration
ITERATED = (Regime.SUSPENDED, Regime.STEEP, Regime.GROUNDED, Regime.SAGGING)


@dataclass(frozen=True)
class Kernel:
    """One dimensionless span and the equation that its regime solves: residual, start, state as functions of (l, h).

    l, h, e, CB, c : as in solvers.catenary.regimes; h < 0 where the fairlead is the lower end.
    """

    regime: Regime
    l: float
    h: float
    e: float
    CB: float
    c: float

    @classmethod
    def of(cls, case) -> Kernel | None:
        """The kernel that solves a case, None where it has a closed form."""
        span = Span(**case.inputs())
        regime = solve_span(span, throw=False).regime
        if regime not in ITERATED:
            return None
        up = -1.0 if span.w < 0 else 1.0
        weight = up * span.w * span.L
        return cls(
            regime, span.x / span.L, up * span.z / span.L, weight / span.EA, span.friction, span.clearance / span.L
        )

    def parameters(self, l, h):
        """Arguments of the residual after the unknown, for a fairlead at (l, h)."""
        if self.regime in (Regime.SUSPENDED, Regime.STEEP):
            return l, -h if self.h < 0 else h, self.e
        if self.regime is Regime.GROUNDED:
            return l, h, self.e, self.CB
        ends = (self.c, h + self.c) if self.h < 0 else (h + self.c, self.c)
        return l, ends[0], self.e, 0.0, ends[1]

    def residual(self, f, t, l, h):
        """(value, Newton step in log t)."""
        return self._equations()[1](f, t, *self.parameters(l, h))

    def state(self, f, t, l, h):
        """(forces, stiffness)."""
        if self.regime is Regime.SUSPENDED:
            return suspended.suspended_state(f, t, l, h, self.e)
        if self.regime is Regime.STEEP:
            return suspended.steep_state(f, t, l, h, self.e)
        return regimes.grounded_state(f, t, *self.parameters(l, h), **self._swapped())

    def _equations(self):
        """Return the functions of the start and of the residual, as they are now, planted faults included."""
        if self.regime is Regime.SUSPENDED:
            return suspended.suspended_start, suspended.suspended_residual
        if self.regime is Regime.STEEP:
            return suspended.steep_start, suspended.steep_residual
        return regimes.grounded_start, regimes.grounded_residual

    def _swapped(self):
        return {"swapped": self.h < 0} if self.regime is Regime.SAGGING else {}

    def root(self) -> float:
        """The unknown of this regime, found by the solver's own iteration."""
        start, upper = self._equations()[0](SCALAR, *self.parameters(self.l, self.h))
        t, *_ = newton.monotone_root(
            lambda f, t, l, h: self.residual(f, t, l, h), start, upper, (self.l, self.h), TOLERANCE
        )
        return t


def newton_step_error(kernel: Kernel, t: float) -> float:
    """Relative error of the Newton step in log t at any t > 0.

    Wanted: -difference / (d residual / d log t), the derivative by complex step. The difference is the residual itself
    or, near the slack line, reach gained times the logarithm of gained over wanted (see ``grounded_residual``).
    """
    g, step = kernel.residual(SCALAR, t, kernel.l, kernel.h)
    slope = t * derivative(lambda t: kernel.residual(COMPLEX, t, kernel.l, kernel.h)[0], t)
    wanted = -g / slope
    if kernel.regime in (Regime.GROUNDED, Regime.SAGGING):
        wanted *= _logarithmic(kernel, g)
    return abs(step / wanted - 1) if wanted else abs(step)


def _logarithmic(kernel, g) -> float:
    """Factor that makes the step of a residual that of the logarithm of the reach gained, where it is taken."""
    _, *heights = kernel.parameters(kernel.l, kernel.h)
    e = heights[1]
    hanging = sum(2 * h / (1 + math.sqrt(1 + 2 * e * h)) for h in (heights[0], *heights[3:]))
    missing, wanted = g * max(kernel.l, 1.0), kernel.l - 1 + hanging
    gained = wanted + missing
    if not (wanted < 0.75 * hanging and gained > 0 and abs(gained / wanted - 1) > 1e-6):
        return 1.0
    return gained * math.log(gained / wanted) / missing


def implicit_stiffness(kernel: Kernel, t: float) -> tuple[float, float, float, float]:
    """d(H, V)/d(l, h) by one complex Newton correction of the root t for a moved end: (K11, K12, K21, K22)."""
    size = STEP * math.hypot(kernel.l, kernel.h)
    columns = []
    for direction in ((1.0, 0.0), (0.0, 1.0)):
        l, h = (Complex(value, size * part) for value, part in zip((kernel.l, kernel.h), direction, strict=True))
        step = kernel.residual(COMPLEX, t, l, h)[1]
        forces = kernel.state(COMPLEX, Complex(t, t * step.imag), l, h)[0]
        columns.append([force.imag / size for force in forces[:2]])
    (K11, K21), (K12, K22) = columns
    return K11, K12, K21, K22


def stiffness_error(kernel: Kernel, t: float) -> float:
    """Largest difference between the stiffness returned and that by complex step, over its largest entry."""
    got, wanted = kernel.state(SCALAR, t, kernel.l, kernel.h)[1], implicit_stiffness(kernel, t)
    return max(abs(a - b) for a, b in zip(got, wanted, strict=True)) / max(abs(b) for b in wanted)


def ordinary_kernels(classify=Kernel.of) -> list[Kernel]:
    """Spans of unit length and weight that round-off hardly troubles: taut to slack, flat to steep, stiff to soft.

    Over the seabed with and without friction, free on both sides, and with a raised anchor; in every iterated regime.
    """
    kernels = []
    for chord, angle, e in product((0.5, 0.9, 0.99, 1.0, 1.005, 1.1, 2.0), (0.05, 0.7, 1.4), (1e-5, 1e-3, 0.1, 3.0)):
        x, z = chord * math.cos(angle), chord * math.sin(angle)
        surroundings = [
            *({"z": sign * z, "seabed": False} for sign in (1, -1)),
            *({"z": z, "friction": CB} for CB in (0.0, 0.01, 1.0, 10.0)),
            *({"z": sign * min(z, c / 2), "clearance": c} for c in (0.02, 0.2) for sign in (1, -1)),
        ]
        cases = (SpanCase("", "ordinary", 1.0, 1 / e, 1.0, x, **around) for around in surroundings)
        kernels += filter(None, map(classify, cases))
    return kernels
