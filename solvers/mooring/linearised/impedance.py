"""Stiffness and impedance (6, 6) of a mooring: what forces and moments answer a small or a finite motion of the body.

With x = (translation, rotation) of the body about a reference point, x(t) = Re(x exp(i omega t)), the mooring exerts
the force and moment -Z(omega) x on it beside those at rest; Z(0) is the stiffness, and Z = K + i omega B - omega^2 A.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.sparse.linalg import splu

from ...common.motions.body_motion import BodyMotion
from ...common.outcome import InputError
from ...common.validation import non_negative_number, positive_number, real_array, vector
from ...harmonic_balance.solve import solve_periodic
from ..system import mooring_system

COORDINATES = ("surge", "sway", "heave", "roll", "pitch", "yaw")


def mooring_impedance(system, frequency, reference=(0.0, 0.0, 0.0)) -> np.ndarray:
    """Return Z (F, 6, 6) of the lines linearised about rest at frequencies (F,) in Hz, or (6, 6) of one.

    system: a MooringSystem in space (``fields="spatial"``) with coupled nodes, a Scene or a Network; reference: point
    (3,) that the body turns about, m. N/m, N and N m. Unsymmetric where the moment at rest is not zero. Still water has
    no linear drag, and friction of the seabed is that of the regularised law at rest. Raises InputError naming what is
    wrong, ConvergenceError without an equilibrium.
    """
    system = _in_space(system)
    arms = _arms(system, reference)
    given = np.atleast_1d(real_array(frequency))
    omega = [2 * np.pi * non_negative_number("frequency", f, "Hz") for f in given.tolist()]
    pencil = system.pencil()
    (K, C, M), free = pencil.whole, pencil.kept
    moved = (3 * system.coupled_nodes[:, None] + np.arange(3)).ravel()
    motion = np.vstack([np.hstack([np.eye(3), -_cross(arm)]) for arm in arms])
    force = system.rest.forces[:, system.coupled_nodes].T
    Z = np.empty((len(omega), 6, 6), dtype=complex)
    for k, w in enumerate(omega):
        A = (K + 1j * w * C - w**2 * M).tocsc()
        follow = splu(A[free][:, free]).solve(A[free][:, moved].toarray())
        Z[k] = motion.T @ (A[moved][:, moved].toarray() - A[moved][:, free] @ follow) @ motion
        for arm, F in zip(arms, force, strict=True):
            Z[k, 3:, 3:] -= _cross(F) @ _cross(arm)
    return Z[0] if np.ndim(frequency) == 0 else Z


def mooring_stiffness(system, reference=(0.0, 0.0, 0.0)) -> np.ndarray:
    """Return the stiffness (6, 6) of the lines about rest, N/m, N and N m: ``mooring_impedance`` at frequency zero."""
    return mooring_impedance(system, 0.0, reference).real


def harmonic_impedance(
    system, frequency, amplitude, reference=(0.0, 0.0, 0.0), *, harmonics=5, **options
) -> np.ndarray:
    """Return Z (6, 6) of finite motions, by harmonic balance: first harmonics of force and moment over the amplitude.

    frequency in Hz; amplitude (6,): of surge, sway, heave in m and roll, pitch, yaw in rad, one at a time; a column
    whose amplitude is zero is NaN. options: of ``solve_periodic``. Raises as that and ``mooring_impedance`` do.
    """
    system = _in_space(system)
    _arms(system, reference)
    frequency = positive_number("frequency", frequency, "Hz")
    sizes = real_array(amplitude)
    if sizes.shape != (6,) or not np.isfinite(sizes).all() or not sizes.any():
        problem = f"{amplitude!r} must be six numbers, {', '.join(COORDINATES)} (m, rad), not all zero"
        raise InputError(problem, field="amplitude", value=amplitude, unit="m, rad")
    Z = np.full((6, 6), np.nan, dtype=complex)
    for j in np.flatnonzero(sizes):
        motion = BodyMotion.harmonic(frequency, tuple(sizes * (np.arange(6) == j)), reference=reference)
        response: Any = solve_periodic(system.with_motion(motion), harmonics=harmonics, **options)
        both = np.concatenate([response.body_force, response.body_moment])
        first = 2 * both @ np.exp(-2j * np.pi * frequency * response.time) / response.time.size
        Z[:, j] = -first / (-1j * sizes[j])  # sin is the real part of -i exp
    return Z


def _in_space(given):
    """Return a MooringSystem as it is, a Scene or Network on the default mesh in space."""
    return given if hasattr(given, "axes") else mooring_system(given, fields="spatial")


def _arms(system, reference) -> np.ndarray:
    """Return the coupled nodes (M, 3) from the reference point, m."""
    if len(system.axes) != 3:
        raise InputError('a body has six degrees of freedom in space; build the system with fields="spatial"',
                         field="system", value=system)  # fmt: skip
    if not system.model.moved:
        raise InputError("it has no coupled node, so no body to answer", field="system", value=system)
    return system.moved_points - vector("reference", reference, "m", "coordinates")


def _cross(a) -> np.ndarray:
    """Return the matrix (3, 3) of the cross product a x."""
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])
