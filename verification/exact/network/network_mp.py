"""Equilibrium of a small cable network to 40 digits: node force balance with every element from ``catenary_mp``.

The force on a free node is F = load + sum of the pulls of its elements, each in the vertical plane through its ends.
Newton's method in mpmath finds F = 0 from a double start; its matrix is a difference quotient of F, so no derivative is
written down. Free nodes that start on the seabed stay there and must be pressed onto it. SI units.

A case has the attributes of solvers.Network: nodes (kind, r, mass, volume, force), elements (w, EA, L, ends, friction)
and environment (rho, g, depth).
"""

from __future__ import annotations

from dataclasses import dataclass

from mpmath import mp, mpf

from verification.exact.cable import catenary_mp

GUARD_DIGITS = 12
# The matrix is differenced with half of these digits: each Newton step gains about ten.
MATRIX_DIGITS, STEP = 26, mpf(10) ** -13
MOST_STEPS = 60
# A step that does not bring the force down by this factor asks for a new matrix.
CONTRACTION = mpf("1e-3")


@dataclass(frozen=True)
class ExactNetwork:
    """Verified state. r : n rows of three mpf, m; H, V, H_anchor, V_anchor : one mpf an element, N.

    force : n rows, sum of all forces on each node, N (zero but for supports);  residual : largest unbalanced force of
    the free coordinates over the largest force;  error : largest error of a coordinate that it implies, m.
    """

    r: list
    H: list
    V: list
    H_anchor: list
    V_anchor: list
    force: list
    residual: mpf
    error: mpf


def solve(case, start, digits=40):
    """``ExactNetwork`` to ``digits`` digits from positions start (n, 3), m, of which free nodes are a guess.

    Raises ArithmeticError where Newton's method gets nowhere, or where a node would leave or enter the seabed.
    """
    with mp.workdps(digits + GUARD_DIGITS):
        network = _Network(case, start)
        r = network.r
        spans, force, matrix = None, None, None
        for _ in range(MOST_STEPS):
            spans = network.spans(r, digits + GUARD_DIGITS // 2, spans)
            last, force = force, network.forces(r, spans)
            residual = network.largest(force) / network.scale(spans)
            if matrix is None or (last and network.largest(force) > CONTRACTION * network.largest(last)):
                matrix = network.matrix(r, spans)
            step = network.step(matrix, force)
            if residual < mpf(10) ** -digits:
                return network.verified(r, spans, force, residual, max(map(abs, step), default=mpf(0)))
            r = network.after(r, step, force)
    raise ArithmeticError(f"no equilibrium to {digits} digits: residual {mp.nstr(residual, 5)}")


def body_stiffness(case, state, reference):
    """(free nodes follow, free nodes held): 6 x 6 mp matrices of a rigid body on the coupled nodes of a solved case.

    -d(force, moment on the body)/d(translation, rotation), N/m, N, N m, the moment about the moved ``reference`` (3,).
    """
    network = _Network(case, state.r)
    network.r = [list(row) for row in state.r]
    coupled = [i for i, node in enumerate(case.nodes) if node.kind == "coupled"]
    places = [(i, axis) for i in coupled for axis in range(3)] + network.unknown
    spans = list(zip(state.H, state.V, state.H_anchor, state.V_anchor, strict=True))
    with mp.workdps(MATRIX_DIGITS):
        D, n = network.derivatives(network.r, spans, places), 3 * len(coupled)
        arms = [[c - mpf(float(o)) for c, o in zip(network.r[i], reference, strict=True)] for i in coupled]
        held = _about(arms, [state.force[i] for i in coupled], D[:n, :n])
        if not network.unknown:
            return held, held
        following = D[:n, :n] - D[:n, n:] * mp.inverse(D[n:, n:]) * D[n:, :n]
        return _about(arms, [state.force[i] for i in coupled], following), held


def _about(arms, forces, D):
    """Stiffness 6 x 6 from d(force)/dr of points at ``arms`` on which ``forces`` act."""
    motion = mp.matrix(D.rows, 6)
    for node, arm in enumerate(arms):
        cross = _cross(arm)
        for i in range(3):
            motion[3 * node + i, i] = mpf(1)
            for j in range(3):
                motion[3 * node + i, 3 + j] = -cross[i, j]
    K = -motion.T * D * motion
    for arm, force in zip(arms, forces, strict=True):
        turned = _cross(force) * _cross(arm)
        for i in range(3):
            for j in range(3):
                K[3 + i, 3 + j] -= turned[i, j]
    return K


def _cross(a):
    return mp.matrix([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


class _Network:
    def __init__(self, case, start):
        env = case.environment
        self.case, self.bottom = case, None if env.depth is None else -mpf(env.depth)
        self.r = [
            [mpf(float(c)) for c in (guess if node.kind == "free" else node.r)]
            for node, guess in zip(case.nodes, start, strict=True)
        ]
        self.load = [[mpf(f) for f in node.force] for node in case.nodes]
        for load, node in zip(self.load, case.nodes, strict=True):
            load[2] += (mpf(env.rho) * mpf(node.volume) - mpf(node.mass)) * mpf(env.g)
        free = [i for i, node in enumerate(case.nodes) if node.kind == "free"]
        self.resting = [i for i in free if self.bottom is not None and self.r[i][2] <= self.bottom]
        for i in self.resting:
            self.r[i][2] = self.bottom
        self.unknown = [(i, axis) for i in free for axis in range(3) if not (axis == 2 and i in self.resting)]

    def span(self, e, r, digits, start=None):
        """(H, V, H_anchor, V_anchor) of element e between the nodes at r."""
        line = self.case.elements[e]
        (xa, ya, za), (xf, yf, zf) = (r[end] for end in line.ends)
        clearance, seabed = mpf(0), self.bottom is not None and line.w >= 0
        if seabed:
            clearance = za - self.bottom
        friction = line.friction if seabed and clearance == 0 else 0
        state = catenary_mp.solve(
            *(line.w, line.EA, line.L, mp.hypot(xf - xa, yf - ya), zf - za),
            *(seabed, friction, clearance),
            start=start,
            digits=digits,
        )
        return state.H, state.V, state.H_anchor, state.V_anchor

    def spans(self, r, digits, starts=None):
        return [
            self.span(e, r, digits, starts[e][:2] if starts and starts[e][0] > 0 else None)
            for e in range(len(self.case.elements))
        ]

    def pulls(self, e, r, span):
        """Force vectors on the anchor node and on the fairlead node of element e."""
        a, f = self.case.elements[e].ends
        across, l = [r[f][k] - r[a][k] for k in (0, 1)], mp.hypot(r[f][0] - r[a][0], r[f][1] - r[a][1])
        c, s = (across[0] / l, across[1] / l) if l else (mpf(1), mpf(0))
        H, V, H_anchor, V_anchor = span
        return [H_anchor * c, H_anchor * s, V_anchor], [-H * c, -H * s, -V]

    def forces(self, r, spans):
        force = [list(load) for load in self.load]
        for e, span in enumerate(spans):
            for node, pull in zip(self.case.elements[e].ends, self.pulls(e, r, span), strict=True):
                force[node] = [a + b for a, b in zip(force[node], pull, strict=True)]
        return force

    def scale(self, spans):
        return max(abs(f) for row in (*spans, *self.load) for f in row)

    def largest(self, force):
        return max((abs(force[i][axis]) for i, axis in self.unknown), default=mpf(0))

    def matrix(self, r, spans):
        """d(force)/d(unknown), or None where nothing is unknown."""
        return self.derivatives(r, spans, self.unknown) if self.unknown else None

    def derivatives(self, r, spans, places):
        """d(force)/dr at ``places``, (node, axis) each, by forward differences; only moved elements are solved."""
        with mp.workdps(MATRIX_DIGITS):
            columns = []
            for node, axis in places:
                touched = [e for e, line in enumerate(self.case.elements) if node in line.ends]
                step = STEP * min(self.case.elements[e].L for e in touched)
                moved = [list(row) for row in r]
                moved[node][axis] += step
                change = {i: [mpf(0)] * 3 for i in range(len(r))}
                for e in touched:
                    start = spans[e][:2] if spans[e][0] > 0 else None
                    before = self.pulls(e, r, self.span(e, r, MATRIX_DIGITS, start))
                    after = self.pulls(e, moved, self.span(e, moved, MATRIX_DIGITS, start))
                    for end, p, q in zip(self.case.elements[e].ends, before, after, strict=True):
                        change[end] = [c + (b - a) / step for c, a, b in zip(change[end], p, q, strict=True)]
                columns.append([change[i][k] for i, k in places])
            return mp.matrix(columns).T

    def step(self, matrix, force):
        return list(mp.lu_solve(matrix, mp.matrix([-force[i][k] for i, k in self.unknown]))) if self.unknown else []

    def after(self, r, step, force):
        new = [list(row) for row in r]
        for (i, axis), change in zip(self.unknown, step, strict=True):
            new[i][axis] += change
        return new

    def verified(self, r, spans, force, residual, error):
        for i in self.resting:
            if force[i][2] > 0:
                raise ArithmeticError(f"node {i} would leave the seabed: {mp.nstr(force[i][2], 5)} N upwards")
        for i, axis in self.unknown:
            if axis == 2 and self.bottom is not None and r[i][2] < self.bottom:
                raise ArithmeticError(f"node {i} would sink into the seabed")
        columns = [list(column) for column in zip(*spans, strict=True)]
        return ExactNetwork(r, *columns, force, residual, error)
