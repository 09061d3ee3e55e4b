"""Error-controlled time steps: Milne's device against the Adams-Bashforth formula of second order."""

from __future__ import annotations

import numpy as np

_GROWTH, _SHRINK, _SAFETY = 2.0, 0.2, 0.9  # of a step
_FIRST_STEP = 2.0**-10  # of dt, for the first step has no error estimate
_SMALLEST_STEP = 1e-6  # of dt, below which the control gives up


class StepControl:
    """Step length ``h`` in s that keeps the error of a step below a tolerance, relative to the largest value so far.

    dt: the longest step, s; constant: C of the scheme's local error C h^3 y'''.
    """

    def __init__(self, system, dt, tolerance, constant):
        self.dt, self.tolerance, self.constant = dt, tolerance, constant
        self.h = _FIRST_STEP * dt
        self.size = system.scale()[:, None]  # largest values so far

    def accept(self, new, h, y, ydot, predicted, previous) -> bool:
        """True if the step from (y, ydot) to ``new`` is accurate enough; sets the next step.

        new: (y, ydot) after the step, or None when it did not converge; predicted: the guess of its ydot, by linear
        extrapolation from ``previous`` = (length of the step before, ydot at its start), None at the first step.
        """
        if new is None:
            self.h = _SHRINK * h
            return False
        size = np.maximum(self.size, abs(new[0]).max(axis=1, keepdims=True))
        if previous is None:
            relative_error = 1.0  # nothing to compare with: keep the step
        else:
            explicit = y + h / 2 * (ydot + predicted)
            explicit_constant = (2 + 3 * previous[0] / h) / 12 + self.constant
            error = abs(self.constant / explicit_constant * (new[0] - explicit)) / size
            relative_error = float(np.sqrt((error**2).mean(axis=1)).max()) / self.tolerance
        factor = min(max(_SAFETY * relative_error ** (-1 / 3), _SHRINK), _GROWTH) if relative_error > 0 else _GROWTH
        if not 0.8 < factor < 1.2:  # a new step costs a factorisation
            self.h = min(factor * h, self.dt)
        if relative_error > 1:
            self.h = min(self.h, _SAFETY * h)
            return False
        self.size = size
        return True

    @property
    def gave_up(self) -> bool:
        """True when the step has become so small that the tolerance cannot be met."""
        return self.h < _SMALLEST_STEP * self.dt
