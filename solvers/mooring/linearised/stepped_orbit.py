"""Periodic motions of the time steps themselves, near a periodic response: for multipliers of lines with slack cells.

A series of few harmonics rings where cells go slack, and disturbances of it are those of another motion. Newton's
method on the change over a period, with the derivative of the steps (``SteppedPeriod``), finds the motion that time
steps repeat, also where small disturbances of it grow.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse.linalg import LinearOperator, gmres

from ..stepping.steps import newmark_parameters
from ..stepping.time_domain import _Run, balancing_acceleration
from .monodromy import SteppedPeriod

RHO_INF = 0.0  # steps over slack cells damp what they do not resolve at once, ``time_domain.integrate_line``
STEP_TOLERANCE = 1e-12  # of the Newton steps of a time step, so that rounding alone is left
PERIODIC = 1e-8  # change over a period, over the amplitude of the response, of a motion that is periodic
FIRST_PERIODS = 6  # taken before Newton's method, in which most disturbances decay
MAX_NEWTON = 15
DAMPING = (1.0, 0.5, 0.25, 0.125)  # of a Newton step, until the change falls; else one more period is taken
KRYLOV, KRYLOV_TOLERANCE = 60, 1e-5  # of the linear systems: disturbances that decay need few vectors


class SteppedOrbit:
    """A motion that ``steps`` time steps in the period of a response repeat, from the response on.

    is_periodic: whether it was found. change: over the period, over the amplitude of the response. state: r, v, r'' and
    a (4, N, n) where it begins; record: r, v, r'' (S, N, n) at the ends of the steps.
    """

    def __init__(self, response, steps):
        self.system, self.steps = response.system, steps
        self.period, self.amplitude = response.last_period[1], float(abs(response.z).max()) or 1.0
        self.scheme, self.free = newmark_parameters(RHO_INF), ~response.system.order.is_prescribed
        self.times = self.period / steps * np.arange(steps + 1)
        self.path = self.system.path(self.times)
        r, v = (part[0].copy() for part in response.motion_at(np.zeros(1))[:2])
        a = balancing_acceleration(self.system, r, v)
        self._find(np.stack([r, v, a, a]))

    def linearised(self, sideways=False) -> SteppedPeriod:
        """Return the linearised period of the steps."""
        return SteppedPeriod(self.system, self.record, self.period / self.steps, self.scheme, sideways)

    def take_period(self, state):
        """Return the state (4, N, n), r, v, r'' and a, a period later, and the record; None where a step fails."""
        run = _Run(self.system, RHO_INF, STEP_TOLERANCE, None, tuple(part.copy() for part in (*state, state[3])))
        record = tuple(np.empty((self.steps, *state[0].shape)) for _ in range(3))
        taken = run.advance(self.times, record, 1, self.path)
        return None if taken < self.steps or run.cut else (np.stack(run.state[:4]), record)

    def measure(self, change) -> float:
        """Return the rms of changes of r and v times the period over 2 pi, over the amplitude of the response."""
        r, v = change[0, self.free], change[1, self.free] * self.period / (2 * np.pi)
        return float(np.sqrt((r**2).mean() + (v**2).mean())) / self.amplitude

    def _find(self, state):
        """Set ``record``, ``change`` and ``is_periodic``."""
        self.state, self.record, self.change, self.is_periodic = state, None, np.inf, False
        for _ in range(FIRST_PERIODS):
            later = self.take_period(state)
            if later is None:
                return
            state = later[0]
        later = self.take_period(state)
        for _ in range(MAX_NEWTON):
            if later is None:
                return
            (end, self.record), self.state = later, state
            self.change = self.measure(end - state)
            if self.change <= PERIODIC:
                self.is_periodic = True
                return
            state, later = self._improve(state, end)

    def _improve(self, state, end):
        """Return the state after a Newton step, and what it is a period later."""
        period = self.linearised()
        less = LinearOperator((period.size,) * 2, lambda x: x - period.apply(x.reshape(-1, 1))[:, 0], dtype=float)
        step = gmres(less, period.pack(end - state), rtol=KRYLOV_TOLERANCE, restart=KRYLOV, maxiter=2)[0]
        for part in DAMPING:
            trial = state + part * period.unpack(step)
            later = self.take_period(trial)
            if later is not None and self.measure(later[0] - trial) < self.change:
                return trial, later
        return end, self.take_period(end)
