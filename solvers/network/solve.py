"""Networks of cables between nodes: the multisegmented quasi-static model, MSQS sections 3 to 5.

``Network`` (``network_model``) states the problem; ``solve_network`` finds the positions of its free nodes and the
forces of its elements: nested (exact spans inside a force balance, ``network_nested``) or monolithic (positions and
forces together, ``network_monolithic``). Lengths in m, forces in N, z up; the seabed is at z = -environment.depth.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ..common.outcome import InputError, Outcome, Status
from ..common.types import Vector
from ..common.validation import flags, one_of, real_array, real_number, vector
from .equations import Balance
from .model import Network
from .monolithic import solve as monolithic
from .nested import (
    EPS,
    SHORT,
    Count,
    coupled_stiffness,
    evaluate,
    largest_force,
    nested,
    robust_start,
)
from .rounding import within_rounding


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

    def body_stiffness(self, reference: Vector) -> np.ndarray:
        """(6, 6) stiffness of a rigid body that carries the coupled nodes, about ``reference`` (3,), m.

        -d(force, moment)/d(translation, rotation), N/m, N, N m, the moment about the moved reference point; unsymmetric
        where the moment is not zero. Raises InputError for a reference that is not three finite numbers.
        """
        arms = self.r[self.coupled] - vector("reference", reference, "m", "numbers")
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


PROMISED = 1e-9  # of the largest force: no more is left of a balance that is called solved, unless asked for
NO_FORCE = 1e-300  # N
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
    start: ArrayLike | None = None,
    fallback: bool = True,
    tolerance: float = PROMISED,
    throw: bool = True,
) -> NetworkState:
    """Equilibrium of a network.

    method : "monolithic" (3.3, all of r, H, V at once) or "nested" (3.2, exact spans inside the force balance)
    jacobian : "analytic", or "finite-difference" as in the conventional method
    globalisation : "line-search" or "trust-region", and units "scaled", "N" or "kN" of the forces: monolithic only
    start : None (no guess needed), "nodes" (the free nodes' own r), a NetworkState, or arrays (r (n, 3), H, V (e,))
    fallback : when the method stops short, go on from there by the monolithic one, then from no guess
    tolerance : of residual_norm; forces that positions as doubles do not tell so far are those of positions less than a
        rounding away
    Raises InputError for unknown options, ConvergenceError when no equilibrium was found unless throw is False.

    >>> ends = [Node("fixed", (0, 0, 0)), Node("fixed", (100, 0, 0)), Node("free", (50, 0, -20), force=(0, 0, -1e3))]
    >>> lines = [Element(w=10.0, EA=1e6, L=60.0, ends=(i, 2)) for i in (0, 1)]
    >>> state = solve_network(Network(ends, lines))
    >>> state.r[2].round(2).tolist(), state.status.name  # m
    ([50.0, 0.0, -32.78], 'SUCCESS')
    """
    given = {"method": method, "jacobian": jacobian, "globalisation": globalisation, "units": units}
    for name, value in given.items():
        one_of(name, value, METHODS[name])
    flags(fallback=fallback, throw=throw)
    if not isinstance(network, Network):
        raise InputError(f"{network!r} is not a solvers.Network", field="network", value=network)
    if not 0 < real_number("tolerance", tolerance, "dimensionless") < 1:
        problem = f"{tolerance!r} (dimensionless) must lie in (0, 1)"
        raise InputError(problem, field="tolerance", value=tolerance, unit="(dimensionless)")
    balance, count = network.balance, Count()
    first = _start(balance, start, count)
    if balance.size == 0:
        count.function_evaluations = 1
        state = _state(balance, first[0], count, tolerance)
    elif method == "monolithic":
        last, solved = monolithic(balance, *first, count, units, jacobian, globalisation, tolerance)  # type: ignore[call-arg]
        state = _state(balance, last.r, count, tolerance, last.elements if solved else None)
    else:
        r, _ = nested(balance, first[0], jacobian, tolerance, count)
        state = _state(balance, r, count, tolerance)
    if fallback and balance.size and not state.residual_norm <= tolerance:
        state = _settled(balance, state, count, tolerance)
    return state.or_raise(f"{len(network.elements)} elements, {len(network.nodes)} nodes, {method}") if throw else state


def _settled(balance, best, count, tolerance) -> NetworkState:
    """The best that the monolithic method finds from where a method stopped, then from each way of leading to a start:
    from where the nested method goes from there, and from the start itself.
    """
    ways = (True, False) if balance.w.size <= SHORT else (False, True)
    best = _led(balance, best, best, count, tolerance)
    for contact in ways if balance.any_rests else ways[:1]:
        if best.residual_norm <= tolerance:
            break
        start = _state(balance, robust_start(balance, count, contact), count, tolerance)
        r, _ = nested(balance, start.r, "analytic", tolerance, count)
        best = _led(balance, best, _state(balance, r, count, tolerance), count, tolerance)
        best = best if best.residual_norm <= tolerance else _led(balance, best, start, count, tolerance)
    return replace(best, **vars(count))


def _led(balance, best, state, count, tolerance) -> NetworkState:
    """The better of the best so far and where the monolithic method leads from a state, going on once if it stops."""
    for _ in range(2):
        if state.residual_norm <= tolerance:
            break
        last, solved = monolithic(balance, state.r, state.H, state.V, count, tolerance=tolerance)
        state = _state(balance, last.r, count, tolerance, last.elements if solved else None)
    return state if not best.residual_norm <= state.residual_norm else best


def _start(balance, start, count):
    """(r, H, V) to start from; H and V of exact spans where they are not given."""
    r, H, V = balance.position.copy(), None, None
    if start is None:
        r = robust_start(balance, count, balance.w.size <= SHORT) if balance.size else r
    elif not (isinstance(start, str) and start == "nodes"):
        parts = (start.r, start.H, start.V) if isinstance(start, NetworkState) else start
        try:
            given, H, V = map(real_array, parts)
        except (TypeError, ValueError):
            problem = "must be None, 'nodes', a NetworkState or arrays (r, H, V)"
            raise InputError(problem, field="start", value=start) from None
        shapes, wanted = (given.shape, H.shape, V.shape), (r.shape, balance.w.shape, balance.w.shape)
        if shapes != wanted or not np.isfinite(given).all():
            problem = f"shapes {shapes} of (r, H, V) must be {wanted}, positions finite"
            raise InputError(problem, field="start", value=start)
        r[balance.free] = given[balance.free]
    r = balance.on_floor(r)
    if H is None and balance.size:
        elements, _ = evaluate(balance, r, count)
        H, V = elements.H, elements.V
    return r, H, V


def _state(balance, r, count, tolerance, elements=None) -> NetworkState:
    """The result, with the forces of the monolithic unknowns if they are given, else of exact spans at r.

    Exact spans of very stiff lines cannot tell the force from positions rounded to doubles; the unknowns can, and so
    can a motion of less than that rounding.
    """
    found = elements or balance.spans(r)
    reaction, residual = _left(balance, r, found)
    if elements is None and not residual <= tolerance:
        refined = within_rounding(balance, r, tolerance, count)
        if refined is not None:
            r, found = refined
            reaction, residual = _left(balance, r, found)
    return NetworkState(
        r=r,
        **{name: getattr(found, name) for name in ("H", "V", "H_anchor", "V_anchor")},
        reaction=reaction,
        coupled=balance.coupled,
        status=Status.SUCCESS if residual <= tolerance else Status.NOT_CONVERGED,
        residual_norm=residual,
        balance=balance,
        **vars(count),
    )


def _left(balance, r, elements):
    """(n, 3) what the elements leave to supports and seabed, N; the largest unbalanced force over the largest force.

    Where lines lie or hang slack without a force, a rounding of the heaviest one's weight is the force to compare with.
    """
    force = balance.unbalanced(elements)
    unbalanced = np.where(balance.moving(r, force), force, 0.0)
    largest = max(largest_force(elements), EPS * balance.heaviest, NO_FORCE)
    return force - unbalanced, float(np.abs(unbalanced).max()) / largest
