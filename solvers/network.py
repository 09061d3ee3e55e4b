"""Networks of cables between nodes: the multisegmented quasi-static model, MSQS sections 3 to 5.

``Network`` (``network_model``) states the problem; ``solve_network`` finds the positions of its free nodes and the
forces of its elements: nested (exact spans inside a force balance, ``network_nested``) or monolithic (positions and
forces together, ``network_monolithic``). Lengths in m, forces in N, z up; the seabed is at z = -environment.depth.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from .network_balance import Balance
from .network_model import Network
from .network_monolithic import solve as monolithic
from .network_nested import (
    SHORT,
    Count,
    attainable,
    coupled_stiffness,
    evaluate,
    largest_force,
    nested,
    robust_start,
)
from .outcome import InputError, Outcome, Status
from .properties import real_number


@dataclass(frozen=True)
class NetworkState(Outcome):
    """Equilibrium of a network with n nodes and e elements.

    r : (n, 3) positions, m;  H, V, H_anchor, V_anchor : (e,) as in CatenaryState, N;  coupled : (n,) bool
    reaction : (n, 3) force on each node that its lines and loads leave to its support (fixed, coupled) or to the seabed
        (free, resting), N; the outputs y of section 1.3 are its coupled rows
    residual_norm : largest unbalanced force over the largest force
    iterations, function_evaluations, inner_iterations : of the outer loop, of the residual, of the spans inside it
    operations : of all factorizations, (2/3) n^3 each, (5.6)
    """

    r: np.ndarray
    H: np.ndarray
    V: np.ndarray
    H_anchor: np.ndarray
    V_anchor: np.ndarray
    reaction: np.ndarray
    coupled: np.ndarray
    status: Status
    iterations: int
    function_evaluations: int
    inner_iterations: int
    operations: float
    residual_norm: float
    balance: Balance = field(repr=False, compare=False)

    @cached_property
    def stiffness(self) -> np.ndarray:
        """(3c, 3c) d(-reaction)/dr of the c coupled nodes, the free nodes following, N/m."""
        resting = self.balance.free & (self.r[:, 2] <= self.balance.floor) & (self.reaction[:, 2] < 0)
        return coupled_stiffness(self.balance, self.r, resting)

    def body_stiffness(self, reference) -> np.ndarray:
        """(6, 6) stiffness of a rigid body that carries the coupled nodes, about ``reference`` (3,), m.

        -d(force, moment)/d(translation, rotation), N/m, N, N m, the moment about the moved reference point; unsymmetric
        where the moment is not zero.
        """
        arms = self.r[self.coupled] - np.asarray(reference, dtype=float)
        forces = -self.stiffness
        motion = np.vstack([np.hstack([np.eye(3), -_cross(arm)]) for arm in arms])
        to_body = np.vstack([np.hstack([np.eye(3), -_cross(arm)]) for arm in arms]).T
        K = -to_body @ forces @ motion
        for arm, force in zip(arms, self.reaction[self.coupled], strict=True):
            K[3:, 3:] -= _cross(force) @ _cross(arm)
        return K


def _cross(a) -> np.ndarray:
    """Matrix of a x."""
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


METHODS = {
    "method": ("monolithic", "nested"),
    "jacobian": ("analytic", "finite-difference"),
    "globalisation": ("line-search", "trust-region"),
    "units": ("scaled", "N", "kN"),
}


def solve_network(
    network: Network,
    *,
    method: str = "monolithic",
    jacobian: str = "analytic",
    globalisation: str = "line-search",
    units: str = "scaled",
    start=None,
    fallback: bool = True,
    tolerance: float = 1e-9,
    throw: bool = True,
) -> NetworkState:
    """Equilibrium of a network.

    method : "monolithic" (3.3, all of r, H, V at once) or "nested" (3.2, exact spans inside the force balance)
    jacobian : "analytic", or "finite-difference" as in the conventional method
    globalisation : "line-search" or "trust-region", and units "scaled", "N" or "kN" of the forces: monolithic only
    start : None (no guess needed), "nodes" (the free nodes' own r), a NetworkState, or arrays (r (n, 3), H, V (e,))
    fallback : when the method stops short, go on with the regularised nested solver, from no guess if need be
    tolerance : of residual_norm; where node positions as doubles cannot resolve it, what they can is accepted
    Raises InputError for unknown options, ConvergenceError when no equilibrium was found unless throw is False.
    """
    given = {"method": method, "jacobian": jacobian, "globalisation": globalisation, "units": units}
    for name, value in given.items():
        if value not in METHODS[name]:
            raise InputError(f"{name}: {value!r} must be one of {', '.join(METHODS[name])}")
    if not isinstance(network, Network):
        raise InputError(f"network: {network!r} is not a solvers.Network")
    if not 0 < real_number("tolerance", tolerance, "dimensionless") < 1:
        raise InputError(f"tolerance: {tolerance!r} (dimensionless) must lie in (0, 1)")
    balance, count = network.balance, Count()
    first, H, V = _start(network, balance, start, count)
    if method == "monolithic" and balance.size > 0:
        last, solved = monolithic(balance, first, H, V, count, units, jacobian, globalisation, tolerance)
        state = _state(balance, last.r, count, tolerance, last.elements if solved else None)
    else:
        r, _ = nested(balance, first, jacobian, tolerance, count)
        state = _state(balance, r, count, tolerance)
    if not state.success and fallback:
        state = _from_no_guess(balance, count, tolerance)
    return state.or_throw(f"{len(network.elements)} elements, {len(network.nodes)} nodes, {method}") if throw else state


def _from_no_guess(balance, count, tolerance) -> NetworkState:
    """Each way of leading to a start, then the nested solver, and from where it stops the monolithic one."""
    for contact in (True, False) if balance.w.size <= SHORT else (False, True):
        r, _ = nested(balance, robust_start(balance, count, contact), "analytic", tolerance, count)
        state = _state(balance, r, count, tolerance)
        if not state.residual_norm <= tolerance:
            last, solved = monolithic(balance, r, state.H, state.V, count, tolerance=tolerance)
            if solved or not state.success:
                state = _state(balance, last.r, count, tolerance, last.elements if solved else None)
        if state.success or not balance.rests.any():
            break
    return state


def _start(network, balance, start, count):
    r, H, V = balance.position, None, None
    if start is None:
        r = robust_start(balance, count, balance.w.size <= SHORT)
    elif isinstance(start, NetworkState):
        r = np.where(balance.free[:, None], start.r, balance.position)
        H, V = start.H, start.V
    elif not (isinstance(start, str) and start == "nodes"):
        try:
            r, H, V = (np.array(part, dtype=float) for part in start)
        except (TypeError, ValueError):
            raise InputError("start: must be None, 'nodes', a NetworkState or arrays (r, H, V)") from None
        e = balance.w.size
        if r.shape != balance.position.shape or H.shape != (e,) or V.shape != (e,) or not np.isfinite(r).all():
            given, wanted = (r.shape, H.shape, V.shape), (balance.position.shape, (e,), (e,))
            raise InputError(f"start: shapes {given} of (r, H, V) must be {wanted}, positions finite")
        r = np.where(balance.free[:, None], r, balance.position)
    r[balance.free, 2] = np.maximum(r[balance.free, 2], balance.floor)
    if H is None:
        elements, _ = evaluate(balance, r, count)
        H, V = elements.H, elements.V
    return r, H, V


def _state(balance, r, count, tolerance, elements=None) -> NetworkState:
    """The result, with the forces of the monolithic unknowns if they are given, else of exact spans at r.

    Exact spans of very stiff lines cannot tell the force from positions rounded to doubles; the unknowns can.
    """
    elements = balance.spans(r) if elements is None else elements
    force = balance.unbalanced(elements)
    resting = balance.free & (r[:, 2] <= balance.floor) & (force[:, 2] <= 0)
    unbalanced = np.where(balance.free[:, None], force, 0.0)
    unbalanced[resting, 2] = 0.0
    largest = largest_force(balance, elements) or 1.0
    residual = float(np.abs(unbalanced).max()) / largest
    solved = residual <= max(tolerance, attainable(balance) / largest)
    return NetworkState(
        r=r,
        **{name: getattr(elements, name) for name in ("H", "V", "H_anchor", "V_anchor")},
        reaction=force - unbalanced,
        coupled=balance.coupled,
        status=Status.SUCCESS if solved else Status.NOT_CONVERGED,
        iterations=count.iterations,
        function_evaluations=count.evaluations,
        inner_iterations=count.inner,
        operations=count.operations,
        residual_norm=residual,
        balance=balance,
    )
