"""One step of the generalized-alpha method for F(y, ydot, t) = 0 on a chain of nodes.

F(y at n + alpha_f, ydot at n + alpha_m) = 0, y(n+1) = y(n) + h ((1 - gamma) ydot(n) + gamma ydot(n+1)): Jansen, Whiting
and Hulbert, Comput. Methods Appl. Mech. Engrg. 190 (2000) 305; on cables Gobat and Grosenbaugh, HB reference [50]. End
rows without rates are constraints and hold at n + 1.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..common.outcome import InputError
from ..common.validation import real_number
from ..numerics.chain import BandedJacobian, stack
from ..numerics.newton import adapted_relaxation
from .drift_control import DRIFT_CONTROLS

MAX_ITERATIONS = 30  # of one step; three or four with a new Jacobian, some more with an old one
MAX_CONTRACTION = 0.03  # contraction above which a new factorisation is cheaper than more iterations with the old one


@dataclass(frozen=True)
class Scheme:
    """Weights of the generalized-alpha family; of second order when gamma = 1/2 + alpha_m - alpha_f."""

    alpha_m: float
    alpha_f: float
    gamma: float

    @classmethod
    def from_spectral_radius(cls, rho_inf) -> Scheme:
        """Second order, with this spectral radius at infinite frequency: 1 is the box method, 0 damps in one step."""
        rho = real_number("rho_inf", rho_inf, "(dimensionless)")
        if not 0 <= rho <= 1:
            problem = f"{rho:g} (dimensionless) must be between 0 and 1"
            raise InputError(problem, field="rho_inf", value=rho, unit="(dimensionless)")
        alpha_m, alpha_f = (3 - rho) / (2 + 2 * rho), 1 / (1 + rho)
        return cls(alpha_m, alpha_f, 0.5 + alpha_m - alpha_f)

    @classmethod
    def backward_euler(cls) -> Scheme:
        """First order; damps everything."""
        return cls(1.0, 1.0, 1.0)

    def amplification(self, z) -> np.ndarray:
        """Eigenvalues (2,) of a step (y, h ydot) -> (y, h ydot) on ydot = (z / h) y."""
        m, f, g = self.alpha_m, self.alpha_f, self.gamma
        new = np.array([[-z * f, m], [1.0, -g]])
        old = np.array([[z * (1 - f), m - 1], [1.0, 1 - g]])
        return np.linalg.eigvals(np.linalg.solve(new, old))

    def error_constant(self) -> float:
        """C of the local error C h^3 y''' (1/12 for the trapezoid), from the principal root at a small step."""
        z = 1e-2  # C to 1 %, and the difference of two numbers near 1 keeps eight digits
        roots = self.amplification(z)
        return float(roots[np.argmin(abs(roots - math.exp(z)))].real - math.exp(z)) / z**3


class Stepper:
    """Steps of a chain; keeps the factorised Jacobian from step to step and counts the work.

    iterations, factorisations: in total; error: mean |dy| of the last Newton step, HB (76), infinite after a singular
    Jacobian or a step that is not finite; worst: node of the largest.
    """

    def __init__(self, system, scheme: Scheme, tolerance: float, hold: str | None, dt: float):
        self.system, self.scheme, self.tolerance = system, scheme, tolerance
        self.jacobian = BandedJacobian(len(system.fields), system.nodes, system.start_rows)
        self.iterations = self.factorisations = self.worst = 0
        self.error, self._size = 0.0, np.zeros((len(system.fields), system.nodes))
        y, t = system.rest_state(), 0.0
        start, end = (not rows(y, 0 * y, t).dydot.any() for rows in (system.start, system.end))
        self.constraints = start, False, end  # of the start, cell and end rows
        self.drift_control = DRIFT_CONTROLS[hold](system, dt) if hold and system.drift(y, t) is not None else None  # type: ignore[misc]
        self._factorised_for = None

    def step(self, y, ydot, t, h, predicted):
        """(y, ydot) at t + h, or None when Newton's method fails; predicted: a guess of the new ydot."""
        m, f, g = self.scheme.alpha_m, self.scheme.alpha_f, self.scheme.gamma
        correction = {"correction": self.drift_control(y, t, h)} if self.drift_control else {}
        rate, old_rate = 1 / (g * h), (1 - g) / g * ydot
        new = y + h * ((1 - g) * ydot + g * predicted)
        last_error, relaxation = math.inf, 1.0
        # Newton's loop of its own: factors are kept from step to step, and a step must not cost more than its rows
        for _ in range(MAX_ITERATIONS):
            new_dot = rate * (new - y) - old_rate
            tangents = self._factorised_for != h
            ahead = (new, new_dot, t + h)
            between = (y + f * (new - y), ydot + m * (new_dot - ydot), t + f * h)
            first, middle, last = (ahead if constraint else between for constraint in self.constraints)
            start = self.system.start(*first, tangents)
            cells = self.system.cells_or_empty(*middle, tangents)
            end = self.system.end(*last, tangents, **correction)
            F = stack(start, cells, end)
            self.iterations += 1
            if tangents and not self._factorise((start, cells, end), h, rate):
                self.error = math.inf
                return self._failed()
            dy = self.jacobian.solve(F).reshape(y.T.shape).T
            size = abs(dy)
            error = float(np.add.reduce(size, axis=None)) / size.size
            self.error = error if math.isfinite(error) else math.inf
            if self.error == math.inf:
                return self._failed(F.reshape(y.T.shape).T)
            if error <= self.tolerance:  # the last step is taken in full, however the ones before were relaxed
                new = new - dy
                return new, rate * (new - y) - old_rate
            new = new - relaxation * dy
            self._size = size
            if error > MAX_CONTRACTION * last_error:
                if tangents:
                    relaxation = adapted_relaxation(relaxation, error, last_error)
                self._factorised_for = None
            last_error = error
        return self._failed()

    def _factorise(self, rows, h, rate) -> bool:
        f, m = self.scheme.alpha_f, self.scheme.alpha_m
        weights = [(1.0, rate) if constraint else (f, m * rate) for constraint in self.constraints]
        self.factorisations += 1
        self._factorised_for = h
        return self.jacobian.factorise(*(a * r.dy + b * r.dydot for r, (a, b) in zip(rows, weights, strict=True)))

    def _failed(self, F=None):
        """None; the next step starts with a Jacobian of its own."""
        self._factorised_for = None
        self.worst = int((self._size.max(axis=0) if F is None else ~np.isfinite(F).all(axis=0)).argmax())
        return None

    def initial_rate(self, y, h):
        """Return ydot of a state that starts to move: one step of backward Euler, so short (h, s) that y stays.

        Returns None where that step fails; ``error`` and ``worst`` are then those of that step.
        """
        euler = Stepper(self.system, Scheme.backward_euler(), self.tolerance, None, h)
        result = euler.step(y, np.zeros_like(y), 0.0, h, np.zeros_like(y))
        if result is None:
            self.error, self.worst = euler.error, euler.worst
            return None
        return result[1]
