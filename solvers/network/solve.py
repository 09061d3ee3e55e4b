"""Networks of cables between nodes: the multisegmented quasi-static model, MSQS sections 3 to 5.

``Network`` (``model``) states the problem; ``solve_network`` returns the positions of its free nodes and the forces of
its elements: nested (exact spans inside a force balance, ``nested``) or monolithic (positions and forces together,
``monolithic``). Lengths in m, forces in N, z up; the seabed is at z = -environment.depth.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ..common.outcome import InputError, Outcome, Status, describe_vector
from ..common.types import Vector
from ..common.validation import flags, instance_of, one_of, real_array, real_number, vector
from .equations import NetworkEquations
from .model import Network
from .monolithic import solve as solve_monolithic
from .nested import EPS, Count, coupled_stiffness, evaluate_balance, largest_force, solve_nested
from .rounding import refine_within_rounding
from .start import MAX_CONTACT_ELEMENTS, robust_start


@dataclass(frozen=True, repr=False)
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
    equations: NetworkEquations = field(repr=False, compare=False)

    def describe(self):
        """Yield the extremes of the tension at the fairlead ends, and the force on what carries the coupled nodes."""
        tension = np.hypot(self.H, self.V)
        yield f"{tension.size} lines, {tension.min():.6g} to {tension.max():.6g} N at their fairlead ends"
        if self.coupled.any():
            yield f"force on the coupled nodes {describe_vector(self.reaction[self.coupled].sum(axis=0))} N"

    @cached_property
    def stiffness(self) -> np.ndarray:
        """(3c, 3c) d(-reaction)/dr of the c coupled nodes, the free nodes following, N/m."""
        resting = self.equations.free & (self.r[:, 2] <= self.equations.seabed) & (self.reaction[:, 2] < 0)
        return coupled_stiffness(self.equations, self.r, resting)

    def body_stiffness(self, reference: Vector) -> np.ndarray:
        """Return the stiffness (6, 6) of a rigid body that carries the coupled nodes, about ``reference`` (3,), m.

        -d(force, moment)/d(translation, rotation), N/m, N, N m, the moment about the moved reference point; unsymmetric
        where the moment is not zero. Raises InputError for a reference that is not three finite numbers.
        """
        arms = self.r[self.coupled] - vector("reference", reference, "m", "numbers")
        forces = -self.stiffness
        motion = np.vstack([np.hstack([np.eye(3), -_cross(arm)]) for arm in arms])
        K = -motion.T @ forces @ motion
        for arm, force in zip(arms, self.reaction[self.coupled], strict=True):
            K[3:, 3:] -= _cross(force) @ _cross(arm)
        return K


def _cross(a) -> np.ndarray:
    """Return the matrix (3, 3) of the cross product a x."""
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


DEFAULT_TOLERANCE = 1e-9  # of the largest force
MIN_FORCE = 1e-300  # N, keeps a divisor from zero
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
    tolerance: float = DEFAULT_TOLERANCE,
    throw: bool = True,
) -> NetworkState:
    """Return the equilibrium of a network.

    method : "monolithic" (3.3, all of r, H, V at once) or "nested" (3.2, exact spans inside the force balance)
    jacobian : "analytic", or "finite-difference" as in the conventional method
    globalisation : "line-search" or "trust-region", and units "scaled", "N" or "kN" of the forces: monolithic only
    start : None (no guess needed), "nodes" (the free nodes' own r), a NetworkState, or arrays (r (n, 3), H, V (e,))
    fallback : when the method stops short, go on from there by the monolithic one, then from no guess
    tolerance : of residual_norm; where double-precision positions do not resolve forces so far, the forces are those of
        positions less than a rounding away
    Raises InputError for unknown options, ConvergenceError where no equilibrium is reached unless throw is False.

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
    instance_of("network", network, Network)
    if not 0 < real_number("tolerance", tolerance, "dimensionless") < 1:
        problem = f"{tolerance!r} (dimensionless) must lie in (0, 1)"
        raise InputError(problem, field="tolerance", value=tolerance, unit="(dimensionless)")
    equations, count = network.equations, Count()
    first = _start_values(equations, start, count)
    if equations.size == 0:
        count.function_evaluations = 1
        state = _state(equations, first[0], count, tolerance)
    elif method == "monolithic":
        last, solved = solve_monolithic(equations, *first, count, units, jacobian, globalisation, tolerance)  # type: ignore[call-arg]
        state = _state(equations, last.r, count, tolerance, last.elements if solved else None)
    else:
        state = _state(equations, solve_nested(equations, first[0], jacobian, tolerance, count), count, tolerance)
    if fallback and equations.size and not state.residual_norm <= tolerance:
        state = _fallback(equations, state, count, tolerance)
    return state.or_raise(f"{len(network.elements)} elements, {len(network.nodes)} nodes, {method}") if throw else state


def _fallback(equations, best, count, tolerance) -> NetworkState:
    """Return the best state that the monolithic method reaches from several starts, until one is solved.

    From where a method stopped; then from each robust start, with and without contact: after the nested method from
    there, and from the start itself.
    """
    contacts = (True, False) if equations.w.size <= MAX_CONTACT_ELEMENTS else (False, True)
    best = _improve(equations, best, best, count, tolerance)
    for contact in contacts if equations.any_can_rest else contacts[:1]:
        if best.residual_norm <= tolerance:
            break
        start = _state(equations, robust_start(equations, count, contact), count, tolerance)
        r = solve_nested(equations, start.r, "analytic", tolerance, count)
        best = _improve(equations, best, _state(equations, r, count, tolerance), count, tolerance)
        best = best if best.residual_norm <= tolerance else _improve(equations, best, start, count, tolerance)
    return replace(best, **vars(count))


def _improve(equations, best, state, count, tolerance) -> NetworkState:
    """Return the better of ``best`` and what the monolithic method reaches from ``state``, restarted once."""
    for _ in range(2):
        if state.residual_norm <= tolerance:
            break
        last, solved = solve_monolithic(equations, state.r, state.H, state.V, count, tolerance=tolerance)
        state = _state(equations, last.r, count, tolerance, last.elements if solved else None)
    return state if not best.residual_norm <= state.residual_norm else best


def _start_values(equations, start, count):
    """Return (r, H, V) to start from; H and V of exact spans where they are not given."""
    r, H, V = equations.position.copy(), None, None
    if start is None:
        r = robust_start(equations, count, equations.w.size <= MAX_CONTACT_ELEMENTS) if equations.size else r
    elif not (isinstance(start, str) and start == "nodes"):
        parts = (start.r, start.H, start.V) if isinstance(start, NetworkState) else start
        try:
            given, H, V = map(real_array, parts)
        except (TypeError, ValueError):
            problem = "must be None, 'nodes', a NetworkState or arrays (r, H, V)"
            raise InputError(problem, field="start", value=start) from None
        shapes, wanted = (given.shape, H.shape, V.shape), (r.shape, equations.w.shape, equations.w.shape)
        if shapes != wanted or not np.isfinite(given).all():
            problem = f"shapes {shapes} of (r, H, V) must be {wanted}, positions finite"
            raise InputError(problem, field="start", value=start)
        r[equations.free] = given[equations.free]
    r = equations.lift_to_seabed(r)
    if H is None and equations.size:
        H, V = evaluate_balance(equations, r, count).elements.Q[:2]
    return r, H, V


def _state(equations, r, count, tolerance, elements=None) -> NetworkState:
    """Return the result, with the forces of the monolithic unknowns if they are given, else of exact spans at r.

    Positions rounded to doubles do not resolve the forces of exact spans of very stiff lines; the unknowns do, and so
    does a motion of less than that rounding.
    """
    elements, is_exact = elements or equations.solve_elements(r), elements is None
    reaction, residual = _reactions_and_residual(equations, r, elements)
    if is_exact and not residual <= tolerance:
        refined = refine_within_rounding(equations, r, tolerance, count)
        if refined is not None:
            r, elements = refined
            reaction, residual = _reactions_and_residual(equations, r, elements)
    return NetworkState(
        r=r,
        **{name: getattr(elements, name) for name in ("H", "V", "H_anchor", "V_anchor")},
        reaction=reaction,
        coupled=equations.coupled,
        status=Status.SUCCESS if residual <= tolerance else Status.NOT_CONVERGED,
        residual_norm=residual,
        equations=equations,
        **vars(count),
    )


def _reactions_and_residual(equations, r, elements):
    """Return the reactions (n, 3), N, and the largest unbalanced force over the largest force.

    Where lines lie or hang slack without a force, a rounding of the heaviest one's weight is the force to compare with.
    """
    force = equations.unbalanced_force(elements)
    unbalanced = np.where(equations.moving_coordinates(r, force), force, 0.0)
    largest = max(largest_force(elements), EPS * equations.largest_weight, MIN_FORCE)
    return force - unbalanced, float(np.abs(unbalanced).max()) / largest
