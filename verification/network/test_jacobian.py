"""Are the derivatives of networks right? Blocks of an element, pattern, assembled Jacobian, step, stiffness."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import scipy.sparse as sparse

from solvers import solve_network
from solvers.catenary.excursion import excursion
from solvers.network import equations as network_equations
from solvers.network import jacobian as network_jacobian
from solvers.network.equations import NetworkEquations
from solvers.network.jacobian import _dogleg, analytic_jacobian, dense_step, difference_jacobian, trust_region_step
from solvers.network.monolithic import MonolithicSystem
from solvers.network.nested import Count, solve_sparse
from solvers.network.scalar import ScalarEquations

from ..cases.networks import (
    NAMED,
    PAPER_START,
    TWO_LINE_W_PRINTED,
    ElementCase,
    EnvironmentCase,
    NetworkCase,
    NodeCase,
    bridle,
    bridle_system,
    chain,
    chain_wire_chain,
    clump_weight,
    hanging_mass,
    spring_net,
    two_line,
)
from ..exact.network import network_mp
from .test_solve import largest, network_of, solved

COMPLEX_STEP = 1e-30  # no truncation, no cancellation
BLOCK = 1e-11  # of the largest entry of the block: the closed forms are differences of nearly equal terms
DIFFERENCE_STEP = 1e-5  # m, of positions of some 100 m: rounding and curvature cost about 1e-8 each
DIFFERENCE = 1e-5  # of the largest entry, central differences
FORWARD = 1e-2  # the solver's own forward differences: at a coordinate of 0 its step is 1e-10 of the unit of length
EXACT_STEP, EXACT_DIGITS = 2e-4, 20  # m, of central differences of forces with that many digits: curvature costs 1e-9
EXACT_DIFFERENCE = 1e-8  # of the largest entry
ROUNDING = 1e-11  # of the largest entry: two ways to add the same numbers
STEP = 1e-7  # of the step: shift 1e-9 of the softest stiffness, condition 1e4


# ---------------------------------------------------------------- blocks of an element
# H, V, w, EA, L, can_rest, friction, clearance: suspended, steep, buoyant, grounded in both regimes of friction, raised
FORCES = {
    "suspended": (5e4, 8e4, 100.0, 1e7, 500.0, False, 0.0, 0.0),
    "suspended over a seabed": (5e4, 6e4, 100.0, 1e7, 500.0, True, 0.3, 0.0),
    "anchor end pulled up": (5e4, 2e4, 100.0, 1e7, 500.0, False, 0.0, 0.0),
    "fairlead below": (5e4, -2e4, 100.0, 1e7, 500.0, True, 0.0, 30.0),
    "buoyant": (3e4, 1e4, -80.0, 1e7, 500.0, False, 0.0, 0.0),
    "taut": (9e6, 1e4, 100.0, 1e9, 500.0, False, 0.0, 0.0),
    "nearly vertical": (1e1, 7e4, 100.0, 1e7, 500.0, False, 0.0, 0.0),
    "grounded": (4e4, 3e4, 100.0, 1e7, 500.0, True, 0.0, 0.0),
    "grounded, friction": (4e4, 3e4, 100.0, 1e6, 500.0, True, 0.3, 0.0),
    "grounded, friction takes all": (4e3, 3e4, 100.0, 1e6, 500.0, True, 1.0, 0.0),
    "sagging between raised ends": (4e3, 2.5e4, 100.0, 1e6, 500.0, True, 0.0, 20.0),
}


def excursion_at(H, V, w, EA, L, can_rest, friction, clearance):
    """Return the Excursion of one element; if one of H, V and the clearance is complex, all are."""
    number = np.result_type(H, V, clearance, float)
    H, V, clearance = (np.array([v], dtype=number) for v in (H, V, clearance))
    w, EA, L, can_rest, friction = (np.array([v]) for v in (w, EA, L, can_rest, friction))
    return excursion(H, V, w, EA, L, can_rest, friction, clearance)


def block_misses() -> list[str]:
    """C, anchor and by_clearance of ``excursion`` against complex step in H, V and the clearance."""
    misses = []
    for name, inputs in FORCES.items():
        at = excursion_at(*inputs)
        got = {0: (at.C[0, :, 0], at.anchor[0, :, 0]), 1: (at.C[0, :, 1], at.anchor[0, :, 1])}
        for column, (C, anchor) in got.items():
            shifted = _complex_step(inputs, column)
            misses += _block_miss(f"{name}: C, column {column}", C, (shifted.l, shifted.h), at.C)
            changed = shifted.H_anchor, shifted.V_anchor
            misses += _block_miss(f"{name}: anchor, column {column}", anchor, changed, at.anchor)
        if inputs[7] > 0:
            shifted = _complex_step(inputs, 7)
            changed = shifted.l, shifted.h, shifted.V_anchor
            misses += _block_miss(f"{name}: by_clearance", at.by_clearance[0], changed, at.by_clearance)
    return misses


def _complex_step(inputs, i):
    changed = list(inputs)
    changed[i] = inputs[i] + 1j * COMPLEX_STEP * abs(inputs[i])
    return excursion_at(*changed)


def _block_miss(name, got, changed, block):
    i = 7 if name.endswith("by_clearance") else int(name[-1])
    step = COMPLEX_STEP * abs(FORCES[name.split(":")[0]][i])
    wanted = np.array([np.imag(np.atleast_1d(value))[0] / step for value in changed])
    error = np.abs(got - wanted).max() / (np.abs(block).max() or 1.0)
    return [] if error <= BLOCK else [f"{name}: got {got}, wanted {wanted}, off by {error:.3g} of the largest"]


# ---------------------------------------------------------------- the assembled tangent of the force balance
def tangent_misses() -> list[str]:
    """NetworkEquations.tangent against central differences of the forces, away from equilibrium and the seabed."""
    misses, rng = [], np.random.default_rng(5)
    for case in (bridle(), bridle_system(0.4), two_line(TWO_LINE_W_PRINTED, 1.0), chain(5), spring_net(), _raised()):
        equations = NetworkEquations(network_of(case))
        r = solved(case).r + np.where(equations.free[:, None], rng.normal(size=(len(case.nodes), 3)), 0)
        _every_node(equations, case)
        got = equations.tangent(equations.solve_elements(r))
        got = got.toarray() if sparse.issparse(got) else got
        force = lambda r, eq=equations: eq.unbalanced_force(eq.solve_elements(r)).ravel()
        wanted = -_central(force, r)
        rows = _smooth_coordinates(case)
        error = np.abs(got - wanted)[:, rows].max() / np.abs(wanted[:, rows]).max()
        if not error <= DIFFERENCE:
            misses.append(f"{case.name}: tangent off by {error:.3g} of the largest")
    return misses


def _raised():
    """Return two slack bights over the seabed between raised ends, one higher: their middles lie on the seabed."""
    nodes = (
        NodeCase("coupled", (0.0, 0.0, -30.0)),
        NodeCase("free", (90.0, 20.0, -15.0), volume=1.0),
        NodeCase("coupled", (190.0, 10.0, -5.0)),
    )
    lines = (ElementCase(120.0, 2e6, 132.0, (0, 1)), ElementCase(120.0, 2e6, 155.0, (2, 1)))
    return NetworkCase("raised bights", nodes, lines, EnvironmentCase(depth=50.0))


def _every_node(equations, case):
    """Make the coordinates of every node unknown, of fixed ones too."""
    equations.build_sparsity(np.full(len(case.nodes), True))


def _smooth_coordinates(case):
    """Coordinates in which the forces have a derivative on both sides: not the heights of ends on the seabed."""
    depth = case.environment.depth
    return np.array([not (k == 2 and depth is not None and n.r[2] <= -depth) for n in case.nodes for k in range(3)])


def _central(function, r, step=DIFFERENCE_STEP):
    columns = []
    for i in range(r.size):
        ahead, behind = r.copy(), r.copy()
        ahead.flat[i] += step
        behind.flat[i] -= step
        with np.errstate(invalid="ignore"):  # formulae are computed for all rows, also where they do not hold
            columns.append(_difference(function, ahead, behind) / (2 * step))
    return np.column_stack(columns)


def _difference(function, ahead, behind):
    """Difference of both sides; nan where one is below the seabed, in a coordinate that is not compared."""
    return function(ahead) - function(behind)


def pattern_misses() -> list[str]:
    """Nodes are coupled where an element joins them: sparsity against a drawing by hand, dense and sparse tangents."""
    drawn = """
        x.x..
        .xx..
        xxxx.
        ..xxx
        ...xx"""
    picture = np.array([[c == "x" for c in row.strip()] for row in drawn.split()])
    nodes = tuple(NodeCase("free", (50.0 * i, 10.0 * i * i, -5.0 * i)) for i in range(5))
    lines = tuple(ElementCase(10.0, 1e6, 60.0, ends) for ends in ((0, 2), (1, 2), (2, 3), (4, 3)))
    case = NetworkCase("picture", (*nodes, NodeCase("fixed", (0, 0, 50.0))), (*lines, ElementCase(1, 1e6, 60, (5, 0))))
    equations = NetworkEquations(network_of(case))
    entries = np.zeros((5, 5), dtype=bool)
    entries[equations.rows // 3, equations.columns // 3] = True
    misses = [] if (entries == picture).all() else [f"pattern {entries.astype(int).tolist()}"]
    elements = equations.solve_elements(equations.position)
    dense = equations.tangent(elements)
    previous, network_equations.MAX_DENSE = network_equations.MAX_DENSE, 0
    equations.build_sparsity(equations.free)
    try:
        error = np.abs(equations.tangent(elements).toarray() - dense).max() / np.abs(dense).max()
    finally:
        network_equations.MAX_DENSE = previous
    return misses if error <= ROUNDING else [*misses, f"sparse and dense differ by {error:.3g}"]


# ---------------------------------------------------------------- the monolithic Jacobian
def iterates():
    """Return (name, Iterate) off equilibrium: named networks with random changes, and the paper's start."""
    rng, result = np.random.default_rng(3), []
    for case in (two_line(), two_line(TWO_LINE_W_PRINTED, 1.0), bridle(), bridle_system(), chain(4), spring_net()):
        equations, state = NetworkEquations(network_of(case)), solved(case)
        r = state.r + np.where(equations.free[:, None], 0.1 * rng.normal(size=state.r.shape), 0.0)
        factors = [1 + 0.02 * rng.normal(size=f.size) for f in (state.H, state.V)]
        for units in ("scaled", "kN"):
            now = _at(equations, units, r, state.H * factors[0], state.V * factors[1])
            result.append((f"{case.name}, {units}", now))
    start = [np.array(part) for part in PAPER_START]
    return [*result, ("paper's start", _at(NetworkEquations(network_of(two_line())), "N", *start))]


def _at(equations, units, r, H, V):
    with np.errstate(all="ignore"):  # as solve does: formulae are computed for all rows, also where they do not hold
        return MonolithicSystem(equations, units, Count()).evaluate(r, H, V)


def jacobian_misses() -> list[str]:
    """analytic_jacobian against central differences of the residual, and against the solver's forward differences.

    Each entry over the largest of its row and of its column.
    """
    misses = []
    for name, now in iterates():
        with np.errstate(all="ignore"):  # as in ``_at``
            got, forward = analytic_jacobian(now), difference_jacobian(now)
            wanted = _central_jacobian(now)
        scale = np.maximum(np.abs(wanted).max(axis=1, keepdims=True), np.abs(wanted).max(axis=0, keepdims=True))
        for what, matrix, allowed in (("analytic", got, DIFFERENCE), ("differences", forward, FORWARD)):
            error = (np.abs(matrix - wanted) / scale).max()
            if not error <= allowed:
                misses.append(f"{name}, {what}: off by {error:.3g}")
    return misses


def _central_jacobian(now):
    """Central differences of the residual in the moving coordinates and the unknown forces of ``now``."""
    n, unknown, m = np.count_nonzero(now.moving), now.unknown, now.system
    forces = np.column_stack([now.elements.H, now.elements.V])[unknown]
    units = np.concatenate([np.full(n, m.length_unit), np.full(forces.size, m.force_unit)])
    steps = np.concatenate([np.full(n, 1e-4), 1e-5 * (np.abs(forces) + np.abs(forces).mean())])

    def residual(change):
        r, q = now.r.copy(), np.column_stack([now.elements.H, now.elements.V])
        r[now.moving] += change[:n]
        q[unknown] += change[n:]
        shifted = m.evaluate(r, *q.T)
        return np.concatenate([shifted.force[now.moving] / m.force_unit, shifted.gap[unknown] / m.length_unit])

    columns = [(residual(step) - residual(-step)) / (2 * step[i]) * units[i] for i, step in enumerate(np.diag(steps))]
    return np.column_stack(columns)


def hand_misses() -> list[str]:
    """The two-line Jacobian at the paper's start (3.7), written out for its 3 + 4 unknowns in N and m."""
    case = two_line(TWO_LINE_W_PRINTED, 1.0)
    r, H, V = (np.array(part) for part in PAPER_START)
    V = np.array([1.9e5, 3.0e5])  # line 1 grounded, all of (2.23), (4.16)
    now = _at(NetworkEquations(network_of(case)), "N", r, H, V)
    wanted = np.zeros((7, 7))
    for i, line in enumerate(case.elements):
        reach = r[2] - r[i]
        l = np.hypot(reach[0], reach[1])
        c, s = reach[:2] / l
        # A: F = -(H c, H s, V); the azimuth turns as the node moves across
        wanted[:2, :2] -= H[i] / l * np.array([[s * s, -c * s], [-c * s, c * c]])
        wanted[0, 3 + 2 * i], wanted[1, 3 + 2 * i], wanted[2, 4 + 2 * i] = -c, -s, -1.0
        wanted[3 + 2 * i, :2], wanted[4 + 2 * i, 2] = (-c, -s), -1.0
        wanted[3 + 2 * i : 5 + 2 * i, 3 + 2 * i : 5 + 2 * i] = _paper_C(line, H[i], V[i])
    got = analytic_jacobian(now)
    error = np.abs(got - wanted).max() / np.abs(wanted).max()
    return [] if error <= ROUNDING else [f"two-line: off by {error:.3g}: {got.tolist()}, wanted {wanted.tolist()}"]


def _paper_C(line, H, V):
    """d(l, h)/d(H, V) by (4.15), (4.16), the erratum of (4.16a) applied."""
    w, EA, L, CB, T = line.w, line.EA, line.L, line.friction, np.hypot(H, V)
    b = V - w * L
    if b > 0:
        Tb = np.hypot(H, b)
        C11 = (np.arcsinh(V / H) - np.arcsinh(b / H)) / w - (V / T - b / Tb) / w + L / EA
        return [[C11, H / w * (1 / T - 1 / Tb)], [H / w * (1 / T - 1 / Tb), (V / T - b / Tb) / w + L / EA]]
    grounded = L - V / w
    x0 = grounded - H / (CB * w)
    C11 = (np.arcsinh(V / H) - V / T) / w + L / EA - (max(x0, 0.0)) / EA
    C12 = (H / T - 1) / w + (H / (EA * w) if x0 > 0 else CB * grounded / EA)
    return [[C11, C12], [(H / T - 1) / w, V / (w * T) + V / (w * EA)]]


def step_misses() -> list[str]:
    """The Newton step by the Schur complement against that of the dense Jacobian."""
    misses = []
    for name, now in iterates():
        schur, dense = now.newton_step(), dense_step(now, "analytic")
        for what, got, wanted in zip(("dr", "dH", "dV"), schur, dense, strict=True):
            error = np.abs(got - wanted).max(initial=0.0) / max(np.abs(wanted).max(), 1e-300)
            if not error <= STEP:
                misses.append(f"{name}: {what} differs by {error:.3g}")
    return misses


def float_misses() -> list[str]:
    """Scalar equations of small networks against those in arrays; None where the scalar ones do not hold.

    Residual and Jacobian, over the largest entry: two ways to round the same formulae.
    """
    misses = []
    for name, now in iterates():
        m = now.system
        scalar = ScalarEquations(m.equations, now.r, (m.force_unit, m.length_unit), Count())
        point = scalar.evaluate([*now.r[now.moving].tolist(), *now.elements.Q[:2].T.ravel().tolist()])
        friction_acts = now.geometry.friction * (now.elements.V_anchor == 0)
        valid = now.all_general and not m.equations.any_massless and not friction_acts.any()
        if (point is None) == valid:
            misses.append(f"{name}: {'refused' if valid else 'accepted'} by the scalar equations")
        if point is not None:
            pairs = (point.Z, now.residual), (scalar.jacobian(point), analytic_jacobian(now))
            for what, (got, wanted) in zip(("residual", "Jacobian"), pairs, strict=True):
                error = np.abs(np.subtract(got, wanted)).max() / np.abs(wanted).max()
                if not error <= ROUNDING:
                    misses.append(f"{name}: {what} differs by {error:.3g} of the largest")
    return misses


# ---------------------------------------------------------------- stiffness of coupled nodes and of a body
def stiffness_cases():
    """Coupled nodes everywhere: bridles, raised bights, joints and weights on the seabed, an anchor that is moved."""
    anchored = two_line(TWO_LINE_W_PRINTED, 0.05)
    moved = (replace(anchored.nodes[0], kind="coupled"), *anchored.nodes[1:])
    return [
        bridle(),
        bridle_system(),
        bridle_system(0.5),
        chain(3),
        chain_wire_chain(),
        chain_wire_chain(0.6),
        clump_weight(),
        _raised(),
        replace(anchored, name="coupled anchor on the seabed", nodes=moved),
    ]


def stiffness_misses() -> list[str]:
    """state.stiffness against central differences of solve_network; symmetric and positive without friction."""
    misses = []
    for case in stiffness_cases():
        network, state = network_of(case), solved(case)
        K, base = state.stiffness, state.r[state.coupled]

        def restoring(r, network=network, state=state):
            new = solve_network(network.moved(r), start=state, tolerance=1e-13)
            return -new.reaction[new.coupled].ravel()

        smooth = [not (k == 2 and r[2] <= -(case.environment.depth or np.inf)) for r in base for k in range(3)]
        columns = [i for i in range(base.size) if smooth[i]]
        wanted = np.column_stack([_one_column(restoring, base, i) for i in columns])
        error = np.abs(K[:, columns] - wanted).max() / np.abs(wanted).max()
        if not error <= DIFFERENCE:
            misses.append(f"{case.name}: stiffness off by {error:.3g} of the largest")
        if all(line.friction == 0 for line in case.elements):
            if np.abs(K - K.T).max() > 1e-9 * np.abs(K).max():
                misses.append(f"{case.name}: not symmetric by {np.abs(K - K.T).max():.3g} N/m")
            if np.linalg.eigvalsh((K + K.T) / 2).min() < -1e-9 * np.abs(K).max():
                misses.append(f"{case.name}: a displacement without work against it")
    return misses


def _one_column(function, r, i, step=1e-4):
    ahead, behind = r.copy(), r.copy()
    ahead.flat[i] += step
    behind.flat[i] -= step
    return (function(ahead) - function(behind)) / (2 * step)


def body_misses() -> list[str]:
    """body_stiffness against forces and moments of a body that is moved and turned, about two reference points."""
    misses = []
    for case in (bridle(), bridle_system(0.5, (5.0, 3.0, 0.0)), clump_weight(), _raised()):
        network, state = network_of(case), solved(case)
        base = state.r[state.coupled]
        for reference in (np.zeros(3), np.array([3.0, -7.0, -40.0])):

            def load(motion, network=network, state=state, base=base, reference=reference):
                """(6,) force and moment about the moved reference of the lines on the body."""
                arms = (base - reference) @ _rotation(motion[3:]).T
                new = solve_network(network.moved(reference + motion[:3] + arms), start=state, tolerance=1e-13)
                forces = new.reaction[new.coupled]
                return np.concatenate([forces.sum(axis=0), np.cross(arms, forces).sum(axis=0)])

            K = state.body_stiffness(reference)
            scale = np.repeat([1.0, np.abs(base - reference).max()], 3)
            wanted = np.column_stack([-_one_column(load, np.zeros(6), i, 1e-4 / scale[i]) for i in range(6)])
            error = np.abs((K - wanted) / np.outer(scale, scale)).max() / np.abs(wanted / np.outer(scale, scale)).max()
            if not error <= DIFFERENCE:
                misses.append(f"{case.name} about {reference}: off by {error:.3g} of the largest")
    return misses


def exact_reactions(case, places) -> np.ndarray:
    """(c, 3) forces of the lines on the coupled nodes at ``places`` (c, 3), N, by ``exact.network_mp``."""
    places = iter(places.tolist())
    nodes = [replace(node, r=tuple(next(places))) if node.kind == "coupled" else node for node in case.nodes]
    exact = network_mp.solve(replace(case, nodes=tuple(nodes)), [node.r for node in nodes], EXACT_DIGITS)
    rows = [row for row, node in zip(exact.force, nodes, strict=True) if node.kind == "coupled"]
    return np.array([[float(c) for c in row] for row in rows])


def test_stiffness_with_a_node_that_rests_on_the_seabed(deep):
    """A resting weight slides and does not rise: (6, 6) of the body, and of its nodes, against 20-digit forces.

    Every second column by default, all in the long version.
    """
    case, reference = clump_weight(friction=0.4), np.array([0.0, 0.0, -10.0])
    state = solved(case)
    assert state.r[1, 2] == -100.0 and state.reaction[1, 2] < 0 < state.V_anchor[1:].min()
    base = np.array([node.r for node in case.nodes if node.kind == "coupled"])

    every = 1 if deep else 2
    of_nodes = [-_one_column(lambda r: exact_reactions(case, r).ravel(), base, i, EXACT_STEP)
                for i in range(0, base.size, every)]  # fmt: skip
    assert_close(state.stiffness[:, ::every], np.column_stack(of_nodes))

    def load(motion):
        arms = (base - reference) @ _rotation(motion[3:]).T
        forces = exact_reactions(case, reference + motion[:3] + arms)
        return np.concatenate([forces.sum(axis=0), np.cross(arms, forces).sum(axis=0)])

    scale = np.repeat([1.0, np.abs(base - reference).max()], 3)
    of_body = [-_one_column(load, np.zeros(6), i, EXACT_STEP / scale[i]) / scale[i] / scale for i in range(0, 6, every)]
    got = state.body_stiffness(reference) / np.outer(scale, scale)
    assert_close(got[:, ::every], np.column_stack(of_body))


def assert_close(matrix, wanted):
    """Fail where an entry differs by more than EXACT_DIFFERENCE of the largest."""
    assert np.abs(matrix - wanted).max() <= EXACT_DIFFERENCE * np.abs(wanted).max()


def _rotation(vector):
    """Rodrigues' formula."""
    angle = np.linalg.norm(vector)
    x, y, z = vector
    A = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sinc(angle / np.pi) * A + 0.5 * np.sinc(angle / (2 * np.pi)) ** 2 * A @ A


CHECKS = {
    "blocks": block_misses,
    "tangent": tangent_misses,
    "pattern": pattern_misses,
    "assembled against differences": jacobian_misses,
    "assembled by hand": hand_misses,
    "Schur step against dense step": step_misses,
    "floats": float_misses,
    "stiffness of coupled nodes": stiffness_misses,
    "stiffness of a body": body_misses,
}


@pytest.mark.parametrize("check", CHECKS.values(), ids=CHECKS)
def test_network_derivatives(check):
    assert check() == []


@pytest.mark.parametrize(
    "case", [chain_wire_chain(), hanging_mass(), _raised(), spring_net()], ids=lambda case: case.name
)
def test_floats_leave_other_lines_and_resting_nodes_to_arrays(case):
    equations, state = NetworkEquations(network_of(case)), solved(case)
    scalar = ScalarEquations(equations, state.r, (1.0, 1.0), Count())
    z = [*state.r[equations.free].ravel().tolist(), *np.array([state.H, state.V]).T.ravel().tolist()]
    assert scalar.evaluate(z) is None


@pytest.mark.parametrize("value", [np.nan, np.inf, 1e-320, 1e200])
def test_floats_leave_what_they_cannot_carry_to_arrays(value):
    equations, (r, H, V) = NetworkEquations(network_of(two_line())), (np.array(part) for part in PAPER_START)
    scalar = ScalarEquations(equations, r, (1.0, 1.0), Count())
    start = [*r[2].tolist(), *np.array([H, V]).T.ravel().tolist()]
    assert scalar.evaluate(start) is not None and scalar.count.function_evaluations == 1
    for i in range(len(start)):
        point = scalar.evaluate([*start[:i], value, *start[i + 1 :]])
        assert point is None or np.isfinite([*point.Z, *np.ravel(scalar.jacobian(point)), point.gap_force]).all()


def test_every_regime_is_among_the_blocks():
    """Contact with both signs of x0, a hanging anchor end, an end below: as (4.15), (4.16) tell them apart."""
    grounded = {name: excursion_at(*inputs).V_anchor[0] for name, inputs in FORCES.items()}
    assert grounded["grounded, friction"] == 0 == excursion_at(*FORCES["grounded, friction takes all"]).H_anchor[0]
    assert excursion_at(*FORCES["grounded, friction"]).H_anchor[0] > 0 > grounded["sagging between raised ends"]


def test_raised_bights_lie_on_the_seabed():
    """What the case is there for: contact in the middle, both ends pulled down, the lines taut."""
    state, case = solved(_raised()), _raised()
    lift = state.V - state.V_anchor
    weight = np.array([line.w * line.L for line in case.elements])
    assert (lift < 0.9 * weight).all() and (state.H > 0.01 * weight).all()
    assert (state.V > 0).all() and (state.V_anchor < 0).all()


@pytest.mark.parametrize("case", NAMED, ids=lambda case: case.name)
def test_stiffness_has_the_size_of_its_coupled_nodes(case):
    state = solved(case)
    assert state.stiffness.shape == (3 * state.coupled.sum(),) * 2 and largest(state) > 0


# ---------------------------------------------------------------- the trust region
def test_the_dogleg_lies_on_its_path():
    """As long as the radius: along Cauchy's step, then from its end towards Newton's; or all of Newton's."""
    newton, cauchy = np.array([3.0, 4.0]), np.array([1.0, 0.0])
    assert np.array_equal(_dogleg(newton, cauchy, 6.0), newton)
    assert _dogleg(newton, cauchy, 0.25) == pytest.approx(0.25 * cauchy)
    step = _dogleg(newton, cauchy, 2.0)
    part = (step - cauchy) / (newton - cauchy)
    assert np.linalg.norm(step) == pytest.approx(2.0) and part[0] == pytest.approx(part[1]) and 0 < part[0] < 1


def test_operations_are_counted_as_in_the_paper():
    """A factorisation of n unknowns counts (2/3) n^3, so the paper's nested example 24 x 18 + 90 x 42.67 = 4272."""
    count = Count()
    for n, times in ((3, 24), (4, 90)):
        for _ in range(times):
            solve_sparse(np.eye(n), 0.0, np.ones(n), count)
    assert count.operations == pytest.approx(4272, rel=1e-12)


@pytest.mark.parametrize(("start", "gained"), [(1.39, 0.0021), (1.2, 0.26), (0.5, 0.95)])
def test_the_trust_region_shrinks_where_its_model_fails(start, gained, monkeypatch):
    """arctan x = 0: radius halved below a quarter of the promised gain, kept up to three quarters, then grown."""
    monkeypatch.setattr(network_jacobian, "scaled_jacobian", lambda now, jacobian: np.array([[1 / (1 + now.x**2)]]))
    monkeypatch.setattr(network_jacobian, "split_step", lambda now, p: p[0])
    network = SimpleNamespace(count=Count())

    def at(x):
        return SimpleNamespace(x=x, residual=np.arctan([x]), system=network, take_step=lambda _, dx: at(x + dx))

    new, radius = network_jacobian.trust_region_step(at(start), "analytic", None)
    step = math.atan(start) * (1 + start**2)
    assert new.x == pytest.approx(start - step, rel=1e-12)
    assert 1 - (new.residual[0] / math.atan(start)) ** 2 == pytest.approx(gained, rel=0.1)
    assert radius == pytest.approx(step * (0.5 if gained < 0.25 else 1.0 if gained < 0.75 else 3.0), rel=1e-12)


class Model:
    """An Iterate of two unknowns as ``trust_region_step`` reads it: Z(x), its Jacobian J, and how x moves."""

    def __init__(self, x, curvature):
        self.x, self.curvature = np.array(x, dtype=float), curvature
        self.residual = np.array([2.0, 1.0]) * self.x + curvature * self.x**2
        self.system = SimpleNamespace(count=Count())

    def take_step(self, length, step):
        """The iterate at x + length step."""
        return Model(self.x + length * step, self.curvature)


@pytest.fixture
def of_model(monkeypatch):
    """Gives ``trust_region_step`` the Jacobian of a Model, and its step as it is."""
    slope = lambda now, jacobian: np.diag(np.array([2.0, 1.0]) + 2 * now.curvature * now.x)
    monkeypatch.setattr("solvers.network.jacobian.scaled_jacobian", slope)
    monkeypatch.setattr("solvers.network.jacobian.split_step", lambda now, p: p)


def test_a_linear_residual_is_solved_by_the_newton_step(of_model):
    """Without a radius that is the Newton step, which is solved exactly; (2/3) n^3 operations are counted, (5.6)."""
    now = Model([3.0, 4.0], 0.0)
    new, radius = trust_region_step(now, "analytic", None)
    assert new.residual == pytest.approx([0.0, 0.0], abs=1e-15) and radius == 15.0  # three times the step
    assert now.system.count.operations == pytest.approx(2 / 3 * 2**3)


def test_a_step_within_the_radius_of_a_linear_residual_lets_it_grow(of_model):
    """Prediction and reduction agree, whatever the length of the step: it is taken, and three times as long a next."""
    for radius in (0.1, 1.0, 4.0):
        new, grown = trust_region_step(Model([3.0, 4.0], 0.0), "analytic", radius)
        assert np.linalg.norm(new.x - [3.0, 4.0]) == pytest.approx(radius) and grown == pytest.approx(3 * radius)


@pytest.mark.parametrize(
    ("curvature", "moved", "radius"),
    [  # from x = 1, Z = 2 + c: the Newton step leaves c p^2, so the ratio is 1 - (c p^2 / Z)^2
        (2.0, 1.0, 3.0),  # 0.95: three times the step
        (-0.5, 1.0, 1.0),  # 0.44: as it was
        (-0.53, 1.0, 0.5),  # 0.22: half the step
        (-0.6, 0.5, 1.5),  # -0.72: half the step is tried, whose ratio is 1.3
    ],
)
def test_the_radius_follows_the_agreement_of_model_and_residual(of_model, curvature, moved, radius):
    """Ratio of the reduction of |Z|^2 to the predicted one: bounds 1e-4, 1/4 and 3/4; in units of the Newton step."""
    newton = (2 + curvature) / (2 + 2 * curvature)
    new, left = trust_region_step(Model([1.0, 0.0], curvature), "analytic", None)
    assert new.x == pytest.approx([1 - moved * newton, 0.0]) and left == pytest.approx(radius * newton)


def test_no_step_is_taken_where_none_reduces_the_residual(of_model):
    """Of a residual that grows in all directions none is given, and the radius is hardly anything."""
    now = Model([1.0, 0.0], 0.0)
    now.take_step = lambda length, step: SimpleNamespace(residual=np.array([2.0, 0.0]))
    new, radius = trust_region_step(now, "analytic", None)
    assert new is None and 0 < radius <= 2e-12


# ---------------------------------------------------------------- a vertical line
@pytest.mark.parametrize(("EA", "z"), [(1e6, -120.0), (1e3, -400.0)])
def test_the_tangent_of_a_vertical_line_is_its_limit(EA, z):
    """At l = 0 forces across are H/l = dH/dl of each end, from any side; a taut line, so that H/l has a limit."""
    nodes = (NodeCase("fixed", (0.0, 0.0, 0.0)), NodeCase("free", (0.0, 0.0, z)))
    case = NetworkCase("hanging line", nodes, (ElementCase(50.0, EA, 100.0, (0, 1)),), EnvironmentCase())
    equations = NetworkEquations(network_of(case))
    _every_node(equations, case)
    vertical = equations.tangent(equations.solve_elements(equations.position))
    for side in ([1.0, 0.0, 0.0], [-0.6, 0.8, 0.0]):
        near = equations.tangent(equations.solve_elements(equations.position + 1e-6 * np.outer([0, 1], side)))
        assert np.abs(vertical - near).max() <= 1e-7 * np.abs(vertical).max()
    assert vertical[3, 3] > 1e-3 * np.abs(vertical).max()


# ---------------------------------------------------------------- lines that lie, hang vertically or are slack
def special(case, seed=4):
    """Return an Iterate of a case near its solution, which has lines other than general ones."""
    equations, state, rng = NetworkEquations(network_of(case)), solved(case), np.random.default_rng(seed)
    r = equations.lift_to_seabed(state.r + 1e-3 * np.where(equations.unknown, rng.normal(size=state.r.shape), 0.0))
    now = _at(equations, "scaled", r, 1.001 * state.H, 0.999 * state.V)
    assert now.kind.any() and not now.kind.all()
    return now


def test_eliminating_the_forces_gives_the_step_of_the_whole_matrix():
    """Where some lines lie on the seabed and others are general ones, too."""
    now = special(chain_wire_chain())
    with np.errstate(all="ignore"):  # as in ``_at``
        schur, dense = now.newton_step(), dense_step(now, "analytic")
    for part, wanted in zip(schur, dense, strict=True):
        assert np.abs(part - wanted).max() <= 1e-6 * np.abs(wanted).max()


def test_a_line_that_lies_has_no_vertical_force():
    """Whatever it was started with; its H stays as it is."""
    nodes = (NodeCase("fixed", (0.0, 0.0, -10.0)), NodeCase("coupled", (60.0, 0.0, -10.0)))
    case = NetworkCase("lying", nodes, (ElementCase(10.0, 1e5, 59.9, (0, 1)),), EnvironmentCase(depth=10.0))
    equations = NetworkEquations(network_of(case))
    now = _at(equations, "N", equations.position, np.array([100.0]), np.array([5.0]))
    assert now.lying.all() and now.elements.V.tolist() == [0.0] and now.elements.H.tolist() == [100.0]
