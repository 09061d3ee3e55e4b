"""Periodic response of a ChainSystem by multi-harmonic balance with AFT, HB section 3; knows nothing of cables.

y(t) = rest + q(t) z with the Fourier functions q of ``fourier``; the rows of F are sampled, their Fourier coefficients
vanish, (63), and Newton's method solves for z with the blocks (72)-(74) of the sampled tangents.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from ..common.outcome import InputError, Status
from ..common.response import Response
from ..common.types import as_system
from ..common.validation import array_of_reals, flags, one_of, positive_number, whole_number
from ..numerics.chain import ChainSystem
from ..numerics.fourier import Basis
from ..numerics.memory import keep_freed_memory
from ..numerics.newton import damped_newton, relaxed_newton
from ..numerics.threads import one_blas_thread
from .residual import find_mirror
from .response import PeriodicResponse
from .start import history_coefficients, mean_change, multilevel_start, solve_with_continuation, truncate_or_pad

MAX_CORRECTIONS = 3  # deferred; each at most half the last, for on coarse meshes later ones make the error larger
INSTANTS_PER_SAMPLE = 4  # instants for each sample at which a state must be valid
MAX_COUNT = 10**5  # harmonics or samples, far beyond what memory holds


def solve_periodic(
    system: ChainSystem,
    *,
    harmonics: int,
    samples: int | None = None,
    subharmonic: int = 1,
    mean: bool = True,
    start: PeriodicResponse | Response | ArrayLike | None = None,
    tolerance: float = 1e-10,
    globalisation: str = "damped",
    multilevel: bool = True,
    symmetry: bool = True,
    deferred_correction: bool = False,
    throw: bool = True,
) -> PeriodicResponse:
    """The periodic response to the periodic driving of a chain.

    harmonics: Nh of the frequency divided by ``subharmonic`` (nu). samples: Nt >= 2 Nh + 1 in the period, by default
    4 Nh: aliasing of the drag then falls below its truncation. mean: keep the constant term; False is the paper's way.
    start: a PeriodicResponse of the same nodes and fields, a time history of them whose last period is stored, or
    coefficients z (n_f, N, C), in place of rest. Over a stiff seabed a history that has become periodic is the best,
    with 8 Nh samples.
    tolerance: error (76), the mean |dz| of the last Newton step. globalisation: "damped" (error-oriented damping, old
    Jacobians kept, and updated, while they serve) or "relaxation" (the paper's factor, a new Jacobian at every step).
    multilevel: start from a solution with three harmonics on the fewest nodes, then with more of both; a line of nodes
    and elements from a short time integration. From 200 harmonics on such a line is solved by GMRES, for seabeds on
    which nodes swing fast: three harmonics to the frequency sqrt(k/(m + ma)).
    symmetry: use a mirror symmetry of the chain where its rows show it.
    deferred_correction: at the end up to three steps with the last Jacobian to rows of ``ChainSystem.fourth_order``:
    what the mesh adds to the error is then of fourth order in its cells, where response and mesh are smooth (Pereyra,
    Numer. Math. 10 (1967) 316); not with mean=False, whose mean state stays that of the box scheme. It fails where the
    mesh is so coarse that the steps grow.
    When Newton's method fails, the driving is raised in steps. Raises InputError for bad input, ConvergenceError when
    no response is found (``throw=False``: the largest amplitude reached, with its status).

    >>> chain = CableProperties(EA=384.243e6, diameter=0.09, mass_per_length=77.7066, Cdn=1.6)
    >>> surge = Motion.harmonic(0.05, (5.0, 0.0, 0.0))
    >>> scene = Scene("my line", chain, 902.2, (0.0, 0.0, -320.0), (848.67, 0.0, -70.0), motion=surge)
    >>> response = solve_periodic(cable_system(scene, nodes=20), harmonics=3)
    >>> (response.tension_harmonics(1) / 1e3).round().tolist()  # kN, mean and first amplitude
    [974.0, 364.0]
    """
    system = as_system(system)
    if deferred_correction and hasattr(system, "solve_extrapolated"):  # a moving line of nodes and elements
        options = {name: value for name, value in locals().items() if name not in ("system", "deferred_correction")}
        return system.solve_extrapolated(**options)
    if len(parts := getattr(system, "components", ())) > 1:  # lines that no free node joins
        options = {name: value for name, value in locals().items() if name not in ("system", "parts", "throw", "start")}
        each = [solve_periodic(part.system, start=_start_of(part, start), throw=False, **options) for part in parts]
        response = system.merge_responses(each)  # type: ignore[attr-defined]
        failed = [part.system.model.name for part, one in zip(parts, each, strict=True) if not one.success]
        return response.or_raise(f"{harmonics} harmonics; {'; '.join(failed)}") if throw else response
    tolerance = positive_number("tolerance", tolerance, "(mean change of a coefficient)")
    one_of("globalisation", globalisation, _NEWTON)
    flags(mean=mean, multilevel=multilevel, symmetry=symmetry, deferred_correction=deferred_correction, throw=throw)
    finer = system.fourth_order() if deferred_correction else None
    if deferred_correction and finer is None:
        problem = "this chain has no rows of higher order"
        raise InputError(problem, field="deferred_correction", value=deferred_correction)
    basis, nu = _basis(system, harmonics, samples, subharmonic, mean)
    newton = _NEWTON[globalisation]
    if globalisation == "damped":
        newton = getattr(system, "newton", newton)  # a line of nodes and elements takes full steps first
    z, coarse_iterations = _start_coefficients(system, basis, start), 0
    keep_freed_memory()
    with one_blas_thread(), np.errstate(all="ignore"):  # a diverging step is found by its size
        mirror = find_mirror(system, basis) if symmetry else None
        if multilevel and start is None and hasattr(system, "periodic_start"):
            z, coarse_iterations = system.periodic_start(basis)
        elif multilevel and start is None:
            z, coarse_iterations = multilevel_start(system, basis, nu, newton, mirror)
        solution = solve_with_continuation(system, basis, z, tolerance, newton, mirror)
        if mirror and solution.amplitude == 1.0 and not solution.residual.satisfies_omitted_rows(solution.z):
            solution = solve_with_continuation(system, basis, z, tolerance, newton, None)
        response = _response(system, nu, coarse_iterations, solution, finer, tolerance)
    again = partial(
        solve_periodic, harmonics=basis.harmonics, samples=basis.samples, subharmonic=nu, mean=mean,
        tolerance=tolerance, throw=False, globalisation=globalisation,
        multilevel=multilevel, symmetry=symmetry)  # fmt: skip
    response = replace(response, repeat=again)
    given = f"{basis.harmonics} harmonics, {basis.samples} samples, amplitude reached: {solution.amplitude:.4g}"
    if response.event is not None:
        t, node = response.event
        name_node = getattr(system, "name_node", lambda node: f"node {node + 1} of {system.nodes}")
        given += f"; a state is invalid at t = {t:.4g} s, {name_node(node)}"
    return response.or_raise(given) if throw else response


def _basis(system, harmonics, samples, subharmonic, mean) -> tuple[Basis, int]:
    """Return the Fourier functions of the response and nu."""
    Nh, nu = (whole_number(n, v, 1, MAX_COUNT) for n, v in (("harmonics", harmonics), ("subharmonic", subharmonic)))
    Nt = max(4 * Nh, 8) if samples is None else whole_number("samples", samples, 1, MAX_COUNT)
    if Nt < 2 * Nh + 1:
        raise InputError(f"{Nt} must be at least 2 harmonics + 1 = {2 * Nh + 1}", field="samples", value=Nt)
    if system.period is None:
        problem = "the chain has no periodic driving, and its periodic response takes one"
        raise InputError(problem, field="motion", value=system.motion)
    return Basis(Nh, Nt, 2 * math.pi / (nu * system.period), bool(mean)), nu


def _response(system, nu, coarse_iterations, solution, finer, tolerance) -> PeriodicResponse:
    """Return the response of a solution, corrected with the rows of a ``finer`` chain if there is one."""
    status, correction = Status.SUCCESS, None
    z, iterations, steps, amplitude, residual, inverse = solution
    basis = residual.basis
    norm = float(abs(residual.residual(residual.pack(z))).max())
    if finer is not None and amplitude == 1.0:
        z, correction = _corrected(residual, inverse[-1], finer, z, tolerance)
        system = system if correction is None else finer
        status = Status.NOT_CORRECTED if correction is None else status
    if amplitude < 1.0:
        status = Status.NO_PERIODIC_RESPONSE
    invalid = _first_invalid(system, basis, z)
    event = None if invalid is None else invalid[1:]
    if invalid is not None and amplitude == 1.0:
        status = invalid[0]
    counts = iterations, coarse_iterations, norm
    settings = tuple(steps), amplitude, basis.mean, residual.symmetric, event, correction
    result = getattr(system, "periodic_response", PeriodicResponse)
    return result(system, basis, z, nu, status, *counts, *settings)  # type: ignore[arg-type]


def _first_invalid(system, basis, z):
    """Return (status, time in s, node) of the first state that is invalid, between the samples too, or None."""
    count = INSTANTS_PER_SAMPLE * basis.samples
    times = np.arange(count) * (2 * math.pi / basis.omega / count)
    y = system.rest_state()[..., None] + z @ basis.functions(times)[0].T
    if system.invalid(y) is None:
        return None
    every = ((system.invalid(y[..., i]), float(t)) for i, t in enumerate(times))
    return next((invalid[0], t, invalid[1]) for invalid, t in every if invalid is not None)


def _corrected(residual, inverse, finer, z, tolerance):
    """Return z after steps of the last Jacobian to the rows of a chain of higher order, and mean |dz|.

    One step is of fourth order with the Jacobian at z. The last one is often older, and the next steps mend it. Where
    the second is no shorter than the first the mesh is too coarse for either: z and None.
    """
    rows, x, last = residual.with_system(finer), residual.pack(z), np.inf
    for k in range(MAX_CORRECTIONS):  # noqa: B007 (used below)
        step = inverse(rows.residual(x))
        size = mean_change(step)
        if not (np.isfinite(size) and size <= last / 2):
            break
        x, last = x - step, size
    if k < 2 and not (size < last < np.inf or size <= tolerance):
        return z, None
    return residual.unpack(x), mean_change(x - residual.pack(z))


_NEWTON = {"damped": damped_newton, "relaxation": relaxed_newton}


def _start_of(part, start):
    """Return what of a start belongs to the nodes of a component."""
    if isinstance(start, PeriodicResponse):
        return replace(start, system=part.system, z=start.z[:, part.nodes])
    if hasattr(start, "ydot"):  # a time history
        return replace(start, system=part.system, y=start.y[:, part.nodes], ydot=start.ydot[:, part.nodes])
    return start if start is None or np.ndim(start) != 3 else np.asarray(start)[:, part.nodes]


def _start_coefficients(system, basis, start) -> np.ndarray:
    """Return coefficients (n_f, N, C) of what the caller gave as ``start``. Raises InputError where it does not fit."""
    shape = (len(system.fields), system.nodes)
    if start is None:
        return np.zeros((*shape, basis.harmonic.size))
    if isinstance(start, PeriodicResponse):
        z, old = start.z, start.basis
        if z.shape[:2] != shape or abs(old.omega / basis.omega - 1) > 1e-12:
            problem = f"a response of {z.shape[:2]} fields and nodes at {old.omega:g} rad/s does not fit"
            raise InputError(problem, field="start", value=start)
        return truncate_or_pad(z, old, basis)
    if isinstance(start, Response):  # a time history
        if start.y.shape[:2] != shape:
            problem = f"a history of {start.y.shape[:2]} fields and nodes does not fit {shape}"
            raise InputError(problem, field="start", value=start)
        return history_coefficients(start, basis, system.rest_state())
    z = array_of_reals("start", start, "must be a PeriodicResponse, a time history or an array of coefficients z")
    if z.shape != (*shape, basis.harmonic.size) or not np.isfinite(z).all():
        problem = f"coefficients of shape {z.shape} must be {(*shape, basis.harmonic.size)}, all finite"
        raise InputError(problem, field="start", value=start)
    return z
