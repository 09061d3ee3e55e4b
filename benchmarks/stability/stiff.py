"""Stiff integration: the step that an explicit method could take, and how the implicit one damps axial waves."""

from __future__ import annotations

import numpy as np
from scipy.linalg import eig

from solvers import solve_time_domain
from solvers.time_domain.generalized_alpha import Scheme

from .maps import Axis
from .time import line

SIZES = (5, 10, 20, 40, 80)
DAMPING_TIMES = (0.0, 1e-3, 1e-2, 0.1, 1.0)  # s
RK4_REAL, RK4_IMAGINARY, LEAPFROG = 2.785, 2.828, 2.0
"""|lambda| dt up to which the classical Runge-Kutta method is stable on the negative real and on the imaginary axis,
and the leapfrog on the imaginary one."""
INFINITE = 1e9  # 1/s: the ends are constraints, which have eigenvalues of rounding at infinity

RADII = (0.0, 0.3, 0.6, 0.9, 1.0)
STEPS_A_PERIOD = Axis("steps in a period of the wave", (4, 6, 10, 20, 40))
NODES, AXIAL = 20, 1.0  # Hz: the first axial mode is the next above
TINY = 1e-3  # of the strain at rest: the rows are nearly linear there
ACCURACY = 1e-13  # mean |dy| of the last Newton step
SETTLED, LAST = 30, 60  # steps after which the spurious root has died away, and at which the run ends


def explicit() -> list[dict]:
    """By nodes and damping time: the largest eigenvalue of the chain about rest, and the limits of explicit steps."""
    rows = []
    for nodes, beta in [(n, 0.0) for n in SIZES] + [(SIZES[1], b) for b in DAMPING_TIMES[1:]]:
        system = line(1.0, nodes=nodes, damping=beta)
        values = eigenvalues(system)[0]
        fastest = values[abs(values).argmax()]
        oscillates = bool(abs(fastest.imag) > abs(fastest.real))
        wave = np.sqrt(system.EA / system.m)
        rows.append(
            {
                "nodes": nodes,
                "beta": beta,
                "largest": abs(fastest),
                "oscillates": oscillates,
                "leapfrog": LEAPFROG / abs(fastest) if oscillates else None,
                "rk4": (RK4_IMAGINARY if oscillates else RK4_REAL) / abs(fastest),
                "transit": system.ds[0] / wave,
                "period": system.period,
            }
        )
    return rows


def eigenvalues(system):
    """Finite eigenvalues of dF/dy + lambda dF/d(ydot) at rest, and the left and right vectors of all."""
    rest = system.rest_state()
    parts = [f(rest, np.zeros_like(rest), 0.0) for f in (system.start, system.cells, system.end)]
    A, B = (_dense(*(getattr(part, name) for part in parts)) for name in ("dy", "dydot"))
    values, left, right = eig(A, -B, left=True)
    with np.errstate(all="ignore"):
        good = np.isfinite(values) & (abs(values) < INFINITE)
    return values[good], left[:, good], right[:, good], B


def _dense(start, cells, end) -> np.ndarray:
    """The whole matrix of a combination of tangents, unknowns node by node."""
    n_f, between = cells.shape[1], cells.shape[-1]
    size, first = n_f * (between + 1), len(start)
    matrix = np.zeros((size, size))
    matrix[:first, :n_f], matrix[size - len(end) :, size - n_f :] = start, end
    for i in range(between):
        rows = slice(first + n_f * i, first + n_f * (i + 1))
        matrix[rows, n_f * i : n_f * (i + 2)] = np.concatenate([cells[0, ..., i], cells[1, ..., i]], axis=1)
    return matrix


def axial() -> list[dict]:
    """By spectral radius and step: the loss of the first axial wave in a period, measured and from the method's roots.

    A run starts from rest with a tiny part of the mode; the left vector takes the mode's amplitude out of each state.
    """
    system = line(1.0, nodes=NODES, Cdn=0.0)  # drag would damp, too
    system.motion = system.period = None
    values, left, right, B = eigenvalues(system)
    mode = min((k for k, v in enumerate(values) if v.imag > 2 * np.pi * AXIAL and _along(right[:, k])),
               key=lambda k: values[k].imag)  # fmt: skip
    rest, value = system.rest_state(), values[mode]
    shape = right[:, mode].reshape(system.nodes, -1).T
    shape = shape * (TINY * abs(rest[0]).max() / abs(shape[0]).max())
    start = rest + shape.real, (value * shape).real
    part = left[:, mode].conj() @ B
    rows = []
    for steps in STEPS_A_PERIOD.values:
        dt = 2 * np.pi / abs(value) / steps
        for radius in RADII:
            run = solve_time_domain(
                system, dt=dt, duration=LAST * dt, rho_inf=radius, hold=None, start=start,
                tolerance=ACCURACY, throw=False,
            )  # fmt: skip
            amplitude = part @ (run.y - rest[..., None]).swapaxes(0, 1).reshape(part.size, -1)
            factor = abs(amplitude[LAST] / amplitude[SETTLED]) ** (1 / (LAST - SETTLED)) if run.success else np.nan
            row = {"steps": steps, "radius": radius, "status": run.status.name, "frequency": abs(value) / (2 * np.pi)}
            rows.append(row | {"measured": 1 - factor**steps, "expected": 1 - principal(value * dt, radius) ** steps})
    return rows


def _along(vector) -> bool:
    """A mode whose nodes move mostly along the line."""
    u, v = abs(vector.reshape(NODES, -1).T[1:3])
    return u.max() > v.max()


def principal(z, radius) -> float:
    """|xi| of the root of the method nearest to exp(z): (xi - 1)(a xi + 1 - a) = z (f xi + 1 - f)(g xi + 1 - g)."""
    scheme = Scheme.from_spectral_radius(radius)
    a, f, g = scheme.alpha_m, scheme.alpha_f, scheme.gamma
    quadratic = np.polymul([1, -1], [a, 1 - a]) - z * np.polymul([f, 1 - f], [g, 1 - g])
    roots = np.roots(quadratic)
    return float(abs(roots[abs(roots - np.exp(z)).argmin()]))
