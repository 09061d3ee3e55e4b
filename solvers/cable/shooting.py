"""Equilibrium of a cable by multiple shooting from node to node: the continuous equations, in Cartesian forces.

dF/ds = w_e up - drag, dr/ds = (1 + |F|/EA) F/|F|; HB section 4.1 after its reference [15]. One shot along the whole
line would grow a slip as exp(s sqrt(k/T)) on a seabed of stiffness k; from node to node it cannot.
It takes from the system its parameters and the law of its seabed, and shares no equation with the box scheme.
"""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

from ..numerics.chain import BandedJacobian, Residual, stack
from ..numerics.newton import damped_newton

_INTEGRATION = 3e-14  # relative error of a shot: the smallest that DOP853 takes, a hundred roundings
_COMPLEX_STEP = 1e-30


def shoot(system, y, tolerance):
    """Return the equilibrium x = (eps, angles, positions from the anchor) (2 n_d, N), jump, steps, converged.

    y (n_f, N): a state near it. jump: the largest between shots, in tensions and chords.
    """
    n, nodes = system.dimension, system.nodes
    tangent = system.axes @ system.direction(y)
    position = system.axes @ (system.positions(y) - system.anchor[:, None])
    scale = np.repeat([system.EA * abs(y[0]).max(), np.linalg.norm(system.chord) or 1.0], n)[:, None]
    x = np.concatenate([system.EA * y[0] * tangent, position]) / scale
    jacobian = BandedJacobian(2 * n, nodes, n)
    ends = np.eye(n, 2 * n, n)

    def shots(x):
        """Return the states at the ends of the cells, from those at their starts (2 n_d, *S)."""

        def rate(_, flat):
            F, r = np.split(flat.reshape(x.shape) * scale.reshape(-1, *(1,) * (x.ndim - 1)), 2)
            by_s = np.concatenate([-_load(system, F, r), _direction(F)[0] * (1 + _direction(F)[1] / system.EA)])
            ds = system.ds.reshape(-1, *(1,) * (x.ndim - 2))
            return (ds * by_s / scale.reshape(-1, *(1,) * (x.ndim - 1))).ravel()

        end = solve_ivp(rate, (0.0, 1.0), x.ravel(), "DOP853", t_eval=[1.0], rtol=_INTEGRATION, atol=_INTEGRATION)
        return end.y[:, -1].reshape(x.shape) if end.success else np.full_like(x, np.nan)

    def rows(x, arrived):
        return Residual(x[n:, 0]), Residual(x[:, 1:] - arrived), Residual(x[n:, -1] - system.chord / scale[n:, 0])

    def linearise(x):
        perturbed = x[:, :-1, None] + 1j * _COMPLEX_STEP * np.eye(2 * n)[:, None, :]
        arrived = shots(perturbed)
        cells = np.zeros((2, 2 * n, 2 * n, nodes - 1))
        cells[0] = -np.moveaxis(arrived.imag, 1, 2) / _COMPLEX_STEP
        cells[1] = np.eye(2 * n)[..., None]
        F = stack(*rows(x, arrived[..., 0].real))
        if not np.isfinite(cells).all() or not jacobian.factorise(ends, cells, ends):
            return F, None
        return F, lambda F: jacobian.solve(F).reshape(x.T.shape).T

    with np.errstate(all="ignore"):  # a shot that leaves the range of doubles is refused as not finite
        residual = lambda x: stack(*rows(x, shots(x[:, :-1])))
        x, steps, converged = damped_newton(linearise, residual, x, tolerance, lambda d: float(np.mean(abs(d))))
    (up, along, *out), T = _direction(x[:n])
    angles = [np.arctan2(along, up), *(np.arcsin(-sideways) for sideways in out)]
    strain = T * scale[0, 0] / system.EA
    return np.stack([strain, *angles, *(x[n:] * scale[n:])]), abs(residual(x)).max(), steps, converged


def _direction(F):
    """Return the unit tangent and the tension of forces F (n_d, *S)."""
    T = np.sqrt((F * F).sum(axis=0))
    return F / T, T


def _load(system, F, r):
    """Return weight, support of the seabed and drag of the current per unstretched length, (n_d, *S), N/m."""
    load = np.zeros_like(F)
    load[0] = -system.w0
    if system.has_seabed:
        load[0] += system.support(system.anchor[2] + r[0])[0]
    if system.current is None:
        return load
    t, T = _direction(F)
    current = system.current.reshape(-1, *(1,) * (F.ndim - 1))
    along = (current * t).sum(axis=0)
    across = current - along * t
    speed, stretch = np.sqrt((across * across).sum(axis=0)), np.sqrt(1 + T / system.EA)
    drag = system.drag_n * across
    if system.dimension == 3:  # the binormal of HB lies in the plane of tangent and Z, and its drag may differ
        level = np.sqrt(t[0] ** 2 + t[1] ** 2)
        binormal = np.stack([-t[0] * -t[2] / level, -t[1] * -t[2] / level, -level])
        drag = drag + (system.drag_b - system.drag_n) * (binormal * across).sum(axis=0) * binormal
    return load + stretch * (speed * drag + system.drag_t * np.sqrt(along * along) * along * t)
