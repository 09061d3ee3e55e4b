"""Do networks drawn by Hypothesis have the properties of every network? Balance, methods, invariances, symmetry.

Forces on the nodes are summed here, from ``solve_span`` of each element between the nodes as the solver left them.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from solvers import Element, Environment, Network, Node, Span, solve_network, solve_span

from ..cases.networks import ElementCase, EnvironmentCase, NetworkCase, NodeCase, hanging_mass, two_line
from ..reference import EPS, exact_network, tension_error
from ..tools.strategies import networks, powers

BALANCE = 1e-9  # of the largest force: the default tolerance
POSITION_EPS = 16  # eps by which positions of both ends, their difference and the length of an element are rounded
RESOLVED = 0.5  # of the examples, at least: those where rounded positions resolve forces to BALANCE; Hypothesis takes
# constants of all modules in memory for some: 0.63 in a run of all tests, 0.8 of this file alone
COMPARED = 0.2  # of the examples, at least: those without a loose node, mostly 0.5 to 0.7
SPREAD = 1e8  # largest over least stiffness of the free nodes, beyond which a difference quotient shows no loose node
FEW = settings(max_examples=settings().max_examples // 20)  # some 60 ms each, one set for each transformation
MORE = settings(max_examples=settings().max_examples // 12)  # two or three such sets


# ---------------------------------------------------------------- forces, summed by hand
class End(NamedTuple):
    """Force (3,) on a node by one element, N: of the exact span between the nodes, and of the network's state."""

    node: int
    exact: np.ndarray
    state: np.ndarray


def network_of(case: NetworkCase) -> Network:
    """Return the solvers.Network of a case."""
    nodes = tuple(Node(**vars(node)) for node in case.nodes)
    return Network(nodes, tuple(Element(**vars(line)) for line in case.elements), Environment(**vars(case.environment)))


def solved(case: NetworkCase, **options):
    """Return the state of a case from no guess; raises where there is none."""
    return solve_network(network_of(case), **options)


def span_of(case, line, r):
    """Return the solved span and horizontal unit vector (2,) of a line between the nodes at r (n, 3)."""
    reach = r[line.ends[1]] - r[line.ends[0]]
    l = math.sqrt(reach[0] ** 2 + reach[1] ** 2)
    depth, clearance = case.environment.depth, 0.0
    seabed = depth is not None and line.w >= 0
    if seabed:
        clearance = r[line.ends[0], 2] + depth
    span = Span(line.w, line.EA, line.L, l, reach[2], seabed, line.friction if clearance == 0 else 0.0, clearance)
    return solve_span(span), reach[:2] / l if l > 0 else np.zeros(2)


def rounding_of(case, r) -> float:
    """Return how far rounding may move the ends of a line against each other, m."""
    return POSITION_EPS * EPS * (np.abs(r).max() + max(line.L for line in case.elements))


def stiffest(case, r) -> float:
    """Return the largest entry of the stiffnesses of all lines between the nodes at r (n, 3), N/m.

    Their ends are also drawn apart by the rounding of their positions, where a line that is just slack is taut.
    """
    largest_entry = 0.0
    for line in case.elements:
        stretched, reach = r.copy(), r[line.ends[1]] - r[line.ends[0]]
        stretched[line.ends[1]] += reach / (np.linalg.norm(reach) or 1.0) * rounding_of(case, r)
        if case.environment.depth is not None:
            stretched[:, 2] = np.maximum(stretched[:, 2], -case.environment.depth)
        for K in (span_of(case, line, positions)[0].stiffness for positions in (r, stretched)):
            finite = K[np.isfinite(K)]  # infinite: the end lies on the seabed
            largest_entry = max(largest_entry, np.abs(finite).max(initial=0.0))
    return largest_entry


def ends_of(case, state):
    """Return both ends of every element, and by how much rounding the positions changes a force at most, N."""
    ends = []
    rounding = rounding_of(case, state.r) * stiffest(case, state.r)
    for e, line in enumerate(case.elements):
        span, along = span_of(case, line, state.r)
        anchor, fairlead = line.ends
        for node, sign, names in ((anchor, 1.0, ("H_anchor", "V_anchor")), (fairlead, -1.0, ("H", "V"))):
            exact, of_state = ([getattr(span, n) for n in names], [getattr(state, n)[e] for n in names])
            ends.append(End(node, *(sign * np.array([*(h * along), v]) for h, v in (exact, of_state))))
    return ends, rounding


def loads_of(case) -> np.ndarray:
    """Return all that acts at the nodes besides the lines, (n, 3), N."""
    env = case.environment
    lift = [[0.0, 0.0, (env.rho * node.volume - node.mass) * env.g] for node in case.nodes]
    return np.array([node.force for node in case.nodes]) + lift


def unsupported(case, r, force) -> np.ndarray:
    """Return what of the sums of force (n, 3) neither a support nor the seabed takes up, N."""
    unbalanced = np.where([[node.kind == "free"] for node in case.nodes], force, 0.0)
    if case.environment.depth is not None:
        pressed = (r[:, 2] <= -case.environment.depth) & (force[:, 2] <= 0)
        unbalanced[pressed, 2] = 0.0
    return unbalanced


def largest(ends, loads) -> float:
    """Return the largest horizontal or vertical force in the network, N; 1 where there is none at all."""
    forces = np.array([*loads, *(end.state for end in ends)])
    return float(max(np.hypot(*forces.T[:2]).max(), np.abs(forces[:, 2]).max())) or 1.0


def balance_misses(case, state) -> tuple[list[str], bool]:
    """Return sentences on errors of a state, and whether rounded positions resolve its forces to BALANCE."""
    ends, rounding = ends_of(case, state)
    total = loads_of(case)
    tolerance = BALANCE * largest(ends, total)
    misses, bound = [], max(tolerance, rounding)
    for end in ends:
        total[end.node] += end.state
        if not np.abs(end.state - end.exact).max() <= bound:
            misses.append(f"an element pulls node {end.node} by {end.state}, between the nodes it would by {end.exact}")
    unbalanced = unsupported(case, state.r, total)
    if not np.abs(unbalanced).max() <= bound:
        misses.append(f"unbalanced: {unbalanced.tolist()} N, allowed {bound:.3g}")
    if not np.abs(state.reaction - (total - unbalanced)).max() <= bound:
        misses.append(f"reactions {state.reaction.tolist()}, the forces leave {(total - unbalanced).tolist()}")
    return misses, rounding <= tolerance


# ---------------------------------------------------------------- two states of one network
def spread_of(case, r) -> float:
    """Return largest over least stiffness of the free nodes, by a difference quotient; inf where one is loose."""
    depth, step = case.environment.depth, 1e-6 * np.mean([line.L for line in case.elements])
    free = [i for i, node in enumerate(case.nodes) if node.kind == "free"]
    moving = [(i, k) for i in free for k in range(3) if not (k == 2 and depth is not None and r[i, 2] <= -depth)]
    if not moving:
        return 1.0
    K = np.zeros((len(moving), len(moving)))
    for column, (i, k) in enumerate(moving):
        shifted = r.copy()
        shifted[i, k] += step
        for line in (line for line in case.elements if i in line.ends):
            change = (pulls(case, line, r) - pulls(case, line, shifted)) / step
            for row, (j, m) in enumerate(moving):
                K[row, column] += sum(change[end, m] for end in (0, 1) if line.ends[end] == j)
    eigenvalues = np.linalg.eigvals(K).real
    return float(eigenvalues.max() / eigenvalues.min()) if eigenvalues.min() > 0 else math.inf


def pulls(case, line, r) -> np.ndarray:
    """Return the force (2, 3) of a line on its anchor and fairlead nodes, N."""
    span, along = span_of(case, line, r)
    return np.array([[*(span.H_anchor * along), span.V_anchor], [*(-span.H * along), -span.V]])


def allowed(case, *states) -> float | None:
    """Return how far the forces of two states may be apart, N; None where a free node is loose.

    An unbalanced force f moves that of a line by at most sqrt(k_largest/k_least) |f|, since K >= k d d^T of each line.
    """
    spread = spread_of(case, states[0].r)
    if not spread < SPREAD:
        return None
    loads, unbalanced = loads_of(case), 0.0
    for state in states:
        ends, rounding = ends_of(case, state)
        unbalanced += max(BALANCE * largest(ends, loads), rounding)
    return math.sqrt(3 * len(case.nodes) * spread) * unbalanced


def apart(first, second) -> float:
    """Return the largest difference of (H, V) of the fairlead ends of two states, arrays (e,), N."""
    return max(np.abs(a - b).max() for a, b in zip(first, second, strict=True))


def assert_enough(compared) -> None:
    """Raise AssertionError unless enough of all examples could be compared."""
    assert compared.count(True) >= COMPARED * len(compared)


# ---------------------------------------------------------------- transformations: (another case, its forces (H, V))
def rotated(draw, case, state):
    """About the vertical."""
    angle = draw(st.floats(-math.pi, math.pi))
    c, s = math.cos(angle), math.sin(angle)
    return case.mapped(np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])), (state.H, state.V)


def reflected(draw, case, state):
    """In a vertical plane."""
    return case.mapped(np.diag(draw(st.sampled_from(((-1.0, 1.0, 1.0), (1.0, -1.0, 1.0)))))), (state.H, state.V)


def renumbered(draw, case, state):
    """Nodes and elements in another order."""
    nodes = draw(st.permutations(range(len(case.nodes))))
    lines = draw(st.permutations(range(len(case.elements))))
    return case.renumbered(nodes, lines), (state.H[lines], state.V[lines])


def ends_swapped(draw, case, state):
    """Some elements laid from the other end, which changes the friction."""
    swap = np.array([draw(st.booleans()) for _ in case.elements])
    lines = (replace(line, ends=line.ends[:: -1 if s else 1]) for line, s in zip(case.elements, swap, strict=True))
    forces = np.where(swap, state.H_anchor, state.H), np.where(swap, -state.V_anchor, state.V)
    return replace(case, elements=tuple(lines)), forces


def scaled(draw, case, state):
    """Lengths and forces in other units."""
    length, force = draw(powers(-2, 2)), draw(powers(-3, 3))
    return case.scaled(length, force), (force * state.H, force * state.V)


SMOOTH = (ends_swapped,)  # only without friction


# ---------------------------------------------------------------- tests
BARELY_RESOLVED = NetworkCase(
    "two stiff tethers from one support, of which one carries a light line",
    (
        NodeCase("fixed", (0.0, 1.0, -10.0)),
        NodeCase("free", (0.0, 0.0, 0.0)),
        NodeCase("fixed", (0.0, 0.0, -10.0)),
        NodeCase("free", (0.0, 0.0, 0.0), force=(0.0, 5.0, 0.0)),
        NodeCase("free", (0.0, 0.0, 0.0)),
    ),
    (
        ElementCase(0.0, 1e8, 10.04987562112089, (0, 1)),
        ElementCase(1.0, 1e8, 1.0, (0, 2), friction=1.0),
        ElementCase(1.0, 1e8, 10.04987562112089, (0, 3)),
        ElementCase(1.0, 1e8, 0.01, (1, 4)),
    ),
    EnvironmentCase(depth=10.0),
)
"""Positions between which exact spans leave 1.6e-9 of the largest force, by either method."""


@pytest.mark.parametrize("method", ["monolithic", "nested"])
def test_any_network_is_balanced(method):
    """Each element on its catenary, each free node balanced, each support loaded by the rest, to 1e-9 of the largest.

    Where double-precision positions do not resolve the forces so far, to what they resolve.
    """
    resolved = []

    @MORE
    @given(networks())
    @example(BARELY_RESOLVED)
    def check(case):
        misses, is_resolved = balance_misses(case, solved(case, method=method))
        resolved.append(is_resolved)
        assert misses == []

    check()
    assert resolved.count(True) >= RESOLVED * len(resolved)


def test_nested_and_monolithic_agree_on_any_network():
    """Two methods that share no iteration give the same forces, where no free node is loose."""
    compared = []

    @FEW
    @given(networks())
    def check(case):
        states = solved(case), solved(case, method="nested")
        bound = allowed(case, *states)
        compared.append(bound is not None)
        assert bound is None or apart(*((state.H, state.V) for state in states)) <= bound

    check()
    assert_enough(compared)


@pytest.mark.parametrize("change", [rotated, reflected, renumbered, ends_swapped, scaled], ids=lambda c: c.__name__)
def test_any_network_drawn_again_has_the_same_forces(change):
    """Rotated about z, reflected, renumbered, laid from the other end, in other units."""
    compared = []

    @FEW
    @given(networks(friction=change not in SMOOTH), st.data())
    def check(case, data):
        state = solved(case)
        other, forces = change(data.draw, case, state)
        again = solved(other)
        bound = allowed(other, again, again)
        compared.append(bound is not None)
        assert bound is None or apart((again.H, again.V), forces) <= bound

    check()
    assert_enough(compared)


def test_stiffness_of_any_smooth_network_is_symmetric():
    """Without friction the forces of the coupled nodes have a potential.

    Eliminating the free nodes leaves rounding of the stiffest line times their spread, however soft the whole is.
    """
    compared = []

    @MORE
    @given(networks(friction=False))
    def check(case):
        if not any(node.kind == "coupled" for node in case.nodes):
            case = replace(case, nodes=(replace(case.nodes[0], kind="coupled"), *case.nodes[1:]))
        state = solved(case)
        spread = spread_of(case, state.r)
        compared.append(spread < SPREAD)
        if compared[-1]:
            K = state.stiffness
            assert np.abs(K - K.T).max() <= POSITION_EPS * EPS * spread * stiffest(case, state.r)

    check()
    assert_enough(compared)


def test_the_measure_of_the_benchmark_against_40_digits():
    """Tensions of the solver are right to rounding by it; one changed tension, or NaN, counts with its size."""
    for case in (hanging_mass(), two_line()):
        state = solved(case, tolerance=1e-13)
        truth = exact_network(case, state.r)
        tension = np.column_stack([np.hypot(state.H_anchor, state.V_anchor), np.hypot(state.H, state.V)])
        assert tension_error(tension, truth) < 1e-11
        wrong = tension.copy()
        wrong[0, 1] += 1e-3 * tension.max()
        assert tension_error(wrong, truth) == pytest.approx(1e-3, rel=1e-6)
        assert tension_error(np.full_like(tension, np.nan), truth) == math.inf
