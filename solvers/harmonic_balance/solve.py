"""Periodic response of a ChainSystem by multi-harmonic balance with AFT, HB section 3; knows nothing of cables.

y(t) = rest + q(t) z with the Fourier functions q of ``fourier``; the rows of F are sampled, their Fourier coefficients
vanish, (63), and Newton's method solves for z with the blocks (72)-(74) of the sampled tangents.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..common.outcome import InputError, Status
from ..common.validation import flags, one_of, positive_number, real_array, whole_number
from ..numerics.chain import ChainSystem
from ..numerics.fourier import Basis
from ..numerics.memory import keep_freed_memory
from ..numerics.newton import damped_newton, relaxed_newton
from ..numerics.threads import one_blas_thread
from .residual import Balance, mirror_of
from .response import PeriodicResponse

_COARSE, _START = 3, 2e-2  # harmonics of the driving for a start, and the error (76) that is good enough there
_BOLD = 8  # full Newton steps before damped ones are tried
_CORRECTIONS = 3  # deferred ones at most, each at most half the last: on coarse meshes the later ones lead away
_SMALLEST_RISE = 2.0**-5  # of the amplitude, in the continuation
_BETWEEN = 4  # instants for each sample at which a state must be valid
_MOST = 10**5  # harmonics or samples, far beyond what memory holds
_PATIENCE = 200  # Newton steps of a continuation; the hardest that ever succeeded took fifty


def solve_periodic(
    system: ChainSystem,
    *,
    harmonics,
    samples=None,
    subharmonic=1,
    mean=True,
    start=None,
    tolerance=1e-10,
    globalisation="damped",
    multilevel=True,
    symmetry=True,
    linear_solver="direct",
    deferred_correction=False,
    throw=True,
) -> PeriodicResponse:
    """The periodic response to the periodic driving of a chain.

    harmonics: Nh of the frequency divided by ``subharmonic`` (nu). samples: Nt >= 2 Nh + 1 in the period, by default
    4 Nh: aliasing of the drag then falls below its truncation. mean: keep the constant term; False is the paper's way.
    start: a PeriodicResponse of the same nodes and fields, or coefficients z (n_f, N, C), in place of rest.
    tolerance: error (76), the mean |dz| of the last Newton step. globalisation: "damped" (error-oriented damping, old
    Jacobians kept, and updated, while they serve) or "relaxation" (the paper's factor, a new Jacobian at every step).
    multilevel: start from a solution with three harmonics on the fewest nodes, then with more of both.
    linear_solver: "direct" (blocks, storage N Nh^2, work N Nh^3) or "iterative" (GMRES preconditioned by the harmonics
    of the averaged chain, storage N Nh; for motions that change the tension by less than about a third of its mean).
    symmetry: use a mirror symmetry of the chain where its rows show it.
    deferred_correction: at the end up to three steps with the last Jacobian to rows of ``ChainSystem.fourth_order``:
    what the mesh adds to the error is then of fourth order in its cells, where response and mesh are smooth (Pereyra,
    Numer. Math. 10 (1967) 316); not with mean=False, whose mean state stays that of the box scheme. It fails where the
    mesh is so coarse that the steps grow.
    When Newton's method fails, the driving is raised in steps. Raises InputError for bad input, ConvergenceError when
    no response is found (``throw=False``: the largest amplitude reached, with its status).
    """
    Nh = _count("harmonics", harmonics)
    nu = _count("subharmonic", subharmonic)
    Nt = max(4 * Nh, 8) if samples is None else _count("samples", samples)
    if Nt < 2 * Nh + 1:
        raise InputError(f"{Nt} must be at least 2 harmonics + 1 = {2 * Nh + 1}", field="samples", value=Nt)
    tolerance = positive_number("tolerance", tolerance, "(mean change of a coefficient)")
    one_of("globalisation", globalisation, _NEWTON)
    one_of("linear_solver", linear_solver, ("direct", "iterative"))
    flags(mean=mean, multilevel=multilevel, symmetry=symmetry, deferred_correction=deferred_correction, throw=throw)
    finer = system.fourth_order() if deferred_correction else None
    if deferred_correction and finer is None:
        problem = "this chain has no rows of higher order"
        raise InputError(problem, field="deferred_correction", value=deferred_correction)
    if system.period is None:
        problem = "the chain has no periodic driving, and its periodic response takes one"
        raise InputError(problem, field="motion", value=system.motion)
    basis = Basis(Nh, Nt, 2 * math.pi / (nu * system.period), bool(mean))
    newton, iterative = _NEWTON[globalisation], linear_solver == "iterative"
    z, spent = _start(system, basis, start), 0
    keep_freed_memory()
    with one_blas_thread(), np.errstate(all="ignore"):  # a diverging step is found by its size
        mirror = mirror_of(system, basis) if symmetry else None
        if multilevel and start is None:
            z, spent = _climbed(system, basis, _COARSE * nu, newton, mirror, iterative)
        found = _continued(system, basis, z, tolerance, newton, mirror, iterative)
        if found.reached == 1.0 and found.balance.symmetric and not found.balance.holds(found.balance.pack(found.z)):
            found = _continued(system, basis, z, tolerance, newton, None, iterative)
        response = _response(system, nu, spent, found, finer, tolerance)
    given = f"{Nh} harmonics, {Nt} samples, amplitude reached: {found.reached:.4g}"
    if response.event is not None:
        t, node = response.event
        given += f"; a state is invalid at t = {t:.4g} s, node {node + 1} of {system.nodes}"
    return response.or_raise(given) if throw else response


def _climbed(system, basis, fewest, newton, mirror, iterative):
    """A start from fewer nodes and harmonics: coefficients z, and the steps that it took."""
    chains, carry = [system], []
    while (coarser := chains[-1].coarser()) is not None:
        chains.append(coarser[0])
        carry.append(coarser[1])
    at, of, spent = len(chains) - 1, basis, 0
    z, levels = _carried(chains[at], basis), _levels(at, fewest, basis.harmonics)
    first = newton
    if z.any():
        first, levels = _bold_newton, levels or [(at, basis.harmonics)]
    for coarse, harmonics in levels:
        for step in reversed(carry[coarse:at]):
            z = step(z)
        at, to = coarse, Basis(harmonics, 4 * harmonics, basis.omega, basis.mean)
        z, steps, *_ = _continued(chains[at], to, _resized(z, of, to), _START, first, mirror, iterative)
        of, spent, first = to, spent + steps, newton
    for step in reversed(carry[:at]):
        z = step(z)
    return _resized(z, of, basis), spent


def _carried(system, basis) -> np.ndarray:
    """Coefficients of the rough state that the chain offers, zeros where it offers none."""
    rest = system.rest_state()
    y = system.quasi_static_predictor(basis.times)
    return np.zeros((*rest.shape, basis.harmonic.size)) if y is None else (y - rest[..., None]) @ basis.P


def _bold_newton(linearise, residual, x, tolerance, norm):
    """Full steps, which from a rough start with drag are few and do not ask what they do; damped ones if they fail."""
    found, bold, converged = relaxed_newton(linearise, residual, x, tolerance, norm, _BOLD)
    if converged:
        return found, bold, True
    found, steps, converged = damped_newton(linearise, residual, x, tolerance, norm)
    return found, bold + steps, converged


def _levels(coarsest, fewest, harmonics):
    """(How many times coarser, harmonics) of the starts: each has twice the nodes, and up to three times the harmonics.

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


class _Found(NamedTuple):
    """Coefficients z at the share of the driving that was reached, and how: all iterations, steps of the last solve."""

    z: np.ndarray
    iterations: int
    steps: list
    reached: float
    balance: Balance
    inverse: list  # its last element solves with the newest Jacobian


def _continued(system, basis, z, tolerance, newton, mirror, iterative) -> _Found:
    """Newton at the full driving, or from rest by steps in its amplitude."""
    reached, rise, iterations, before = 0.0, 1.0, 0, None
    while True:
        share = min(1.0, reached + rise)
        balance = Balance(system if share == 1.0 else system.scaled(share), basis, mirror, iterative)
        if balance.symmetric and not balance.holds_start(z):
            return _continued(system, basis, z, tolerance, newton, None, iterative)
        guess = z
        if before is not None:  # along the secant
            guess = z + (share - reached) / (reached - before[0]) * (z - before[1])
        linearise, inverse = _remembered(balance.linearise)
        x, steps, converged = newton(linearise, balance.residual, balance.pack(guess), tolerance, _error)
        iterations += len(steps)
        if converged:
            if reached > 0:
                before = (reached, z)
            z, reached, rise = balance.unpack(x), share, 2 * rise
            if reached == 1.0:
                return _Found(z, iterations, steps, reached, balance, inverse)
        else:
            if reached == 0:
                z = np.zeros_like(z)
            rise /= 2
            if rise < _SMALLEST_RISE or iterations > _PATIENCE:
                return _Found(z, iterations, steps, reached, balance, inverse)


def _remembered(linearise):
    """linearise, and a list of what its last call gave to solve with.

    Not kept by the balance, which the solving function knows: factors would outlive the solve until a collection.
    """
    inverse = []

    def again(x):
        inverse.clear()  # the old factors go before the new ones come
        F, solve = linearise(x)
        inverse.append(solve)
        return F, solve

    return again, inverse


def _response(system, nu, spent, found, finer, tolerance) -> PeriodicResponse:
    """What was found, corrected with the rows of a ``finer`` chain if there is one."""
    status, event, correction = Status.SUCCESS, None, None
    z, iterations, steps, reached, balance, inverse = found
    basis = balance.basis
    norm = float(abs(balance.residual(balance.pack(z))).max())
    if finer is not None and reached == 1.0:
        z, correction = _corrected(balance, inverse[-1], finer, z, tolerance)
        system = system if correction is None else finer
        status = Status.NOT_CORRECTED if correction is None else status
    if reached < 1.0:
        status = Status.NO_PERIODIC_RESPONSE
    times = np.arange(_BETWEEN * basis.samples) * (2 * math.pi / basis.omega / (_BETWEEN * basis.samples))
    y = system.rest_state()[..., None] + z @ basis.functions(times)[0].T
    for i, t in enumerate(times if system.invalid(y) is not None else ()):
        invalid = system.invalid(y[..., i])
        if invalid is not None:
            status, event = (invalid[0] if reached == 1.0 else status), (float(t), invalid[1])
            break
    how = tuple(steps), reached, basis.mean, balance.symmetric, event, correction
    return PeriodicResponse(system, basis, z, nu, status, iterations, spent, norm, *how)


def _corrected(balance, inverse, finer, z, tolerance):
    """z after steps of the last Jacobian to the rows of a chain of higher order, and mean |dz|.

    One step is of fourth order with the Jacobian at z. The last one is often older, and the next steps mend it. Where
    the second is no shorter than the first the mesh is too coarse for either: z and None.
    """
    rows, x, last = balance.of(finer), balance.pack(z), np.inf
    for k in range(_CORRECTIONS):  # noqa: B007 (used below)
        step = inverse(rows.residual(x))
        size = _error(step)
        if not (np.isfinite(size) and size <= last / 2):
            break
        x, last = x - step, size
    if k < 2 and not (size < last < np.inf or size <= tolerance):
        return z, None
    return balance.unpack(x), _error(x - balance.pack(z))


def _error(step) -> float:
    """(76)."""
    return float(abs(step).mean())


_NEWTON = {"damped": damped_newton, "relaxation": relaxed_newton}


def _count(name, value) -> int:
    """Return a whole number from 1 to _MOST."""
    value = whole_number(name, value, 1)
    if value > _MOST:
        raise InputError(f"{value!r} must be at most {_MOST}", field=name, value=value)
    return value


def _start(system, basis, start) -> np.ndarray:
    shape = (len(system.fields), system.nodes)
    if start is None:
        return np.zeros((*shape, basis.harmonic.size))
    if isinstance(start, PeriodicResponse):
        z, of = start.z, start.basis
        if z.shape[:2] != shape or abs(of.omega / basis.omega - 1) > 1e-12:
            problem = f"a response of {z.shape[:2]} fields and nodes at {of.omega:g} rad/s does not fit"
            raise InputError(problem, field="start", value=start)
        return _resized(z, of, basis)
    try:
        z = real_array(start)
    except (TypeError, ValueError):
        problem = "must be a PeriodicResponse or an array of coefficients z"
        raise InputError(problem, field="start", value=start) from None
    if z.shape != (*shape, basis.harmonic.size) or not np.isfinite(z).all():
        problem = f"coefficients of shape {z.shape} must be {(*shape, basis.harmonic.size)}, all finite"
        raise InputError(problem, field="start", value=start)
    return z


def _resized(z, of, to) -> np.ndarray:
    """Coefficients in another basis of the same frequency: cut, or filled with zeros."""
    new = np.zeros((*z.shape[:2], to.harmonic.size))
    if of.mean and to.mean:
        new[..., 0] = z[..., 0]
    count = 2 * min(of.harmonics, to.harmonics)
    new[..., to.mean : to.mean + count] = z[..., of.mean : of.mean + count]
    return new
