"""Starts of the harmonic balance: from coarse meshes with few harmonics, and from small amplitudes.

Each level and each amplitude is solved by Newton's method on a ``HarmonicResidual``.
"""

from __future__ import annotations

from functools import partial
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from ..common.response import last_period
from ..numerics.continuation import continue_in_load
from ..numerics.fourier import Basis
from ..numerics.newton import full_then_damped_newton, relaxed_newton
from .residual import HarmonicResidual, harmonic_residual

COARSE_HARMONICS, COARSE_TOLERANCE = 3, 2e-2  # of the driving, and the error (76) that is good enough for a start
MAX_UNDAMPED_STEPS = 8  # before damped ones are tried
MIN_AMPLITUDE_STEP = 2.0**-5  # of the continuation
MAX_STEPS = 200  # Newton steps of a continuation; the hardest that ever succeeded took fifty


class Solution(NamedTuple):
    """Coefficients z at the amplitude that was reached; Newton steps in total, and those of the last solve.

    residual: of the last solve; inverse: its last element solves with the newest Jacobian.
    """

    z: np.ndarray
    iterations: int
    steps: list
    amplitude: float
    residual: HarmonicResidual
    inverse: list


def mean_change(step) -> float:
    """Return the mean of |step|, the error (76)."""
    return float(abs(step).mean())


def solve_with_continuation(system, basis, z, tolerance, newton, mirror) -> Solution:
    """Solve at the full amplitude from z, or from rest by steps in the amplitude of the driving."""
    if mirror is not None and not harmonic_residual(system, basis, mirror).start_is_symmetric(z):
        mirror = None
    last: list = []

    def solve(amplitude, guess):
        chain = system if amplitude == 1.0 else system.scaled(amplitude)
        residual = harmonic_residual(chain, basis, mirror)
        linearise, inverse = _keep_last_solve(residual.linearise)
        last[:] = residual, inverse  # before Newton's method: the factors of the last try go before new ones come
        x, steps, converged = newton(linearise, residual.residual, residual.pack(guess), tolerance, mean_change)
        return residual.unpack(x), steps, converged

    options = {"min_step": MIN_AMPLITUDE_STEP, "max_iterations": MAX_STEPS, "secant": True}
    z, amplitude, iterations, steps = continue_in_load(solve, z, np.zeros_like(z), **options)
    return Solution(z, iterations, steps, amplitude, *last)


def _keep_last_solve(linearise):
    """Return linearise, and a list of what its last call gave to solve with.

    The residual must not keep it: the solving function knows the residual, and in such a circle the factors would
    outlive the solve until a collection of garbage.
    """
    inverse: list = []

    def linearise_again(x):
        inverse.clear()  # the old factors go before the new ones come
        F, solve = linearise(x)
        inverse.append(solve)
        return F, solve

    return linearise_again, inverse


def multilevel_start(system, basis, harmonics_of_driving, newton, mirror):
    """Return coefficients z from fewer nodes and harmonics, and the Newton steps that they took."""
    chains, prolongations = [system], []
    while (coarser := chains[-1].coarser()) is not None:
        chains.append(coarser[0])
        prolongations.append(coarser[1])
    level, old, iterations = len(chains) - 1, basis, 0
    z = predictor_coefficients(chains[level], basis)
    levels, method = _levels(level, COARSE_HARMONICS * harmonics_of_driving, basis.harmonics), newton
    if z.any():
        method, levels = undamped_then_damped, levels or [(level, basis.harmonics)]
    for coarse, harmonics in levels:
        z = _prolongate(z, prolongations[coarse:level])
        level, new = coarse, Basis(harmonics, 4 * harmonics, basis.omega, basis.mean)
        start = truncate_or_pad(z, old, new)
        z, steps, *_ = solve_with_continuation(chains[level], new, start, COARSE_TOLERANCE, method, mirror)
        old, iterations, method = new, iterations + steps, newton
    return truncate_or_pad(_prolongate(z, prolongations[:level]), old, basis), iterations


def _prolongate(z, prolongations):
    """Take coefficients from the coarsest of some meshes to the finest."""
    for prolongate in reversed(prolongations):
        z = prolongate(z)
    return z


def predictor_coefficients(system, basis) -> np.ndarray:
    """Return the coefficients of the motion that the chain predicts, zeros where it predicts none."""
    rest = system.rest_state()
    y = system.predict_motion(basis.times)
    return np.zeros((*rest.shape, basis.harmonic.size)) if y is None else (y - rest[..., None]) @ basis.P


# From a rough start with drag full steps are few: up to eight undamped ones first
undamped_then_damped = partial(full_then_damped_newton, full=partial(relaxed_newton, limit=MAX_UNDAMPED_STEPS))


def _levels(coarsest, fewest, harmonics):
    """Return (times coarser, harmonics) of each start: each has twice the nodes, and up to three times the harmonics.

    The last has half the nodes and all harmonics: one factorisation is then left for all nodes. Where nodes cannot be
    fewer, harmonics grow fourfold.
    """
    if coarsest == 0:
        ladder = [fewest] if fewest < harmonics else []
        while ladder and 8 * ladder[-1] < harmonics:
            ladder.append(4 * ladder[-1])
        return [(0, few) for few in ladder]
    levels, few, coarse = [(1, harmonics)], -(-harmonics // 3), 2
    while few > fewest:
        levels.append((min(coarse, coarsest), few))
        few, coarse = -(-few // 3), coarse + 1
    if fewest < harmonics:
        levels.append((coarsest, fewest))
    return levels[::-1]


def history_coefficients(history, basis, rest) -> np.ndarray:
    """Return the coefficients z (n_f, N, C) of the end of a time history, its last whole period of the basis.

    rest (n_f, N): the state that z counts from. Between stored times cubic polynomials of states and rates. Raises
    InputError where less than a period is stored.
    """
    first, period = last_period(history.time, 2 * np.pi / basis.omega)
    stored = np.count_nonzero(history.time > first)
    count = max(basis.samples, stored)
    t = np.clip(first + period * np.arange(count) / count, history.time[0], history.time[-1])
    states = CubicHermiteSpline(history.time, history.y, history.ydot, axis=-1)(t)
    return 2 / count * (states - rest[..., None]) @ basis.functions(t)[0]


def truncate_or_pad(z, old, new) -> np.ndarray:
    """Return coefficients in another basis of the same frequency: cut, or filled with zeros."""
    padded = np.zeros((*z.shape[:2], new.harmonic.size))
    if old.mean and new.mean:
        padded[..., 0] = z[..., 0]
    count = 2 * min(old.harmonics, new.harmonics)
    padded[..., new.mean : new.mean + count] = z[..., old.mean : old.mean + count]
    return padded
