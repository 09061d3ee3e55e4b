"""Observed order and numerical uncertainty from three meshes or three time steps, as in ASME V&V 20-2009, section 2-4.

The grid convergence index of Roache with a safety factor: U_num = Fs |f1 - f2| / (r^p - 1) covers the error of the
finest run f1 at 95 %, and u_num = U_num / k is its standard uncertainty. The factor and the limits of the order are
those of Oberkampf and Roy, Verification and Validation in Scientific Computing (2010), section 8.6.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

SAFETY_NEAR, SAFETY_FAR = 1.25, 3.0
"""Fs where the observed order is near the formal one, and where it is not."""
NEAR = 0.1
"""Relative distance from the formal order that counts as near."""
LEAST_ORDER = 0.5
"""The order that an uncertainty is computed with lies between this and the formal one: a higher observed order, which
chance can give, makes no uncertainty smaller."""
EXPANSION = 1.15
"""k: of an error on one side, a normal distribution about the extrapolated value; the normal one about f1 would have 2
and a smaller u_num (V&V 20-2009, 2-4.2)."""
ORDERS = (0.01, 30.0)
"""Where an observed order is sought: below, refinement hardly changes the answer less each time."""
LEAST_COSINE = 0.5
"""Of the angle between the two differences of a waveform: below, they do not fall as one error C h^p does. Of single
numbers the cosine is 1 or -1, and this is the condition that they converge monotonically."""
ROUND_OFF = 1e-12
"""Of the size of the values: differences below are of rounding, and have no order."""


@dataclass(frozen=True)
class Refinement:
    """What three runs tell of the finest one.

    sizes : (3,) cells, steps or harmonics, coarsest first; formal_order : of the scheme
    order : observed, None where there is none
    change : of the last refinement, root mean square over the scale
    u_num : standard uncertainty, of the same kind; where ``is_asymptotic`` is false the greatest difference of two of
        the three, a bound by their range
    safety : Fs, expansion : k; None where no order gave the uncertainty
    """

    sizes: tuple[int, ...]
    formal_order: float
    order: float | None
    change: float
    u_num: float
    is_asymptotic: bool
    safety: float | None = None
    expansion: float | None = None


def estimate_uncertainty(
    sizes, values, scale: float, formal_order: float = 2.0, is_truncation: bool = False
) -> Refinement:
    """Return the observed order and the numerical uncertainty of the finest of three runs.

    sizes (3,): numbers of cells or steps, growing; values: of each run, a number or an array, such as a waveform;
    scale: what the uncertainty is relative to, in the unit of the values. is_truncation: of a Fourier series, whose
    successive differences are orthogonal, so that their norms alone must fall; of a smooth response faster than any
    order, and then that of the second is a bound.
    """
    if not (len(sizes) == len(values) == 3 and 0 < sizes[0] < sizes[1] < sizes[2]):
        raise ValueError(f"three growing sizes and their values are wanted, not {sizes!r}")
    coarse, medium, fine = (np.atleast_1d(np.asarray(value, dtype=float)) for value in values)
    before, last = medium - coarse, fine - medium
    changes = _rms(before), _rms(last)
    about = (tuple(int(size) for size in sizes), formal_order)
    if changes[1] <= ROUND_OFF * _rms(fine):
        return Refinement(*about, None, changes[1] / scale, changes[1] / scale, True)
    ratios = sizes[1] / sizes[0], sizes[2] / sizes[1]
    order = observed_order(changes, ratios) if is_truncation or _is_monotone(before, last) else None
    if order is None:
        greatest = max(*changes, _rms(fine - coarse))
        return Refinement(*about, None, changes[1] / scale, greatest / scale, False)
    is_near = abs(order / formal_order - 1) <= NEAR
    safety = SAFETY_NEAR if is_near else SAFETY_FAR
    used = min(max(order, LEAST_ORDER), formal_order)
    u_num = safety * changes[1] / (ratios[1] ** used - 1) / EXPANSION
    return Refinement(*about, order, changes[1] / scale, u_num / scale, True, safety, EXPANSION)


def observed_order(changes, ratios) -> float | None:
    """Return p of e = C h^p from the changes (2,) of successive runs with refinement ratios (2,).

    None where there is no order in ORDERS. The changes are C h^p (r^p - 1) with the ratio r of each pair.
    """
    first, second = np.log(ratios)

    def excess(p):
        return p * second + np.log(np.expm1(p * first) / np.expm1(p * second)) - np.log(changes[0] / changes[1])

    least, most = ORDERS
    return float(brentq(excess, least, most, xtol=1e-12)) if excess(least) < 0 < excess(most) else None


def largest(refinements) -> Refinement:
    """Return the one of greatest uncertainty, such as that of the worst fairlead."""
    return max(refinements, key=lambda one: one.u_num)


def _is_monotone(before, last) -> bool:
    size = np.linalg.norm(before) * np.linalg.norm(last)
    return bool(size > 0 and np.vdot(before, last) >= LEAST_COSINE * size)


def _rms(values) -> float:
    return float(np.sqrt(np.mean(np.square(values))))
