"""The periodic response of a chain as ``solve_periodic`` finds it: Fourier coefficients, what follows from them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ..common import diagnostics
from ..common.outcome import Outcome, Status
from ..common.response import Response
from ..numerics.chain import ChainSystem
from ..numerics.fourier import Basis
from ..numerics.newton import Step


@dataclass(frozen=True, repr=False)
class PeriodicResponse(Response, Outcome):
    """Periodic state: coefficients z (n_f, N, C) about ``system.rest_state()`` in the order of ``basis.harmonic``.

    time (Nt,) s; y, ydot (n_f, N, Nt): the samples. iterations: Newton steps with these harmonics, at all amplitudes;
    coarse_iterations: those with fewer harmonics or nodes before, of a moving line those of the start in time; steps:
    error (76) and relaxation of those of the last solve.
    residual_norm: largest coefficient of the rows, before a deferred correction.
    amplitude: share of the motion that was reached, 1 on success. event: (time, node) of an invalid state, or None.
    correction: mean |dz| of the deferred correction, which tells the error that the mesh had made; None without one.
    system: the chain; with a deferred correction that of ``fourth_order``, whose tangents serve no other solver.
    repeat: solves for another system with the same settings.
    mean: False marks the paper's variant without constant term: its mean forces are not in balance.
    """

    system: ChainSystem = field(repr=False)
    basis: Basis = field(repr=False)
    z: np.ndarray = field(repr=False)
    subharmonic: int
    status: Status
    iterations: int
    coarse_iterations: int
    residual_norm: float
    steps: tuple[Step, ...] = field(repr=False)
    amplitude: float
    mean: bool
    symmetric: bool
    event: tuple[float, int] | None = None
    correction: float | None = None
    repeat: Callable | None = field(repr=False, default=None, compare=False)

    def describe(self):
        """Yield period and harmonics, then what ``Response`` does."""
        yield f"period {self.last_period[1]:.6g} s, {self.basis.harmonics} harmonics"
        yield from super().describe()

    @property
    def time(self) -> np.ndarray:
        """Sample times, (Nt,), s."""
        return self.basis.times

    @cached_property
    def y(self) -> np.ndarray:
        """State at the samples, (n_f, N, Nt)."""
        return self.at(self.time)

    @cached_property
    def ydot(self) -> np.ndarray:
        """Rate at the samples, (n_f, N, Nt)."""
        return self.rate_at(self.time)

    @property
    def last_period(self) -> tuple[float, float]:
        """0 and the period of the response, nu / f, s."""
        return 0.0, 2 * math.pi / self.basis.omega

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        """What a cable's response has lost: drift, compression between instants, too few harmonics, mean forces."""
        return tuple(diagnostics.check_response(self))

    def at(self, t: ArrayLike) -> np.ndarray:
        """State at times t (S,) in s, (n_f, N, S)."""
        return self.system.rest_state()[..., None] + self.z @ self.basis.functions(np.asarray(t, dtype=float))[0].T

    def rate_at(self, t: ArrayLike) -> np.ndarray:
        """Rate of the state at times t (S,) in s, (n_f, N, S)."""
        return self.z @ self.basis.functions(np.asarray(t, dtype=float))[1].T
