"""Are the forces on the nodes those of the equations, and the tangents their derivatives? Checks without a solve.

Truth of the forces is exact/lumped_node in 40 digits, of the tangents the complex step through the text of the
equations as it is written. The last part plants a fault in each single term and asks which check sees it.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from ..reference import EPS
from ..tools.planting import Fault, sign_faults
from .problems import (
    BRANCHED,
    ELIMINATION,
    EQUATIONS,
    NODES,
    PATTERNS,
    TERMS,
    compiled,
    dense,
    evaluate,
    interpreted,
    matrix,
    random_state,
    tangent_blocks,
)

ROUNDING = 8 * EPS  # of the largest force on a node: a force is a product of ten factors or so; measured 2.7 eps
TANGENTS = 8 * EPS  # of the largest entry; measured 3 eps
SOLVED = 20 * EPS  # of a row's sum without signs: elimination without a search for pivots
SEEN = 1e-9  # of every measure here: what a planted fault changes at least
STEP = 1e-30
WEIGHTS = (1.3, 0.7, 2.1)  # of the tangents in r, v and a
AXES = pytest.mark.parametrize("n", [2, 3], ids=["planar", "spatial"])
EACH_TERM = pytest.mark.parametrize("name", TERMS)
EACH_PATTERN = pytest.mark.parametrize("pattern", PATTERNS)


@cache
def as_written():
    """Return the equations as Python runs them."""
    return interpreted()


# ---------------------------------------------------------------- measures; of a module, so that it can be a faulty one
def residual_error(module, name, n, seed=1, pattern="line") -> float:
    """Return the largest difference of R from mpmath, over the largest force on a node."""
    state = random_state(name, n, seed, pattern)
    R, _, _ = evaluate(module, state.line, state.r, state.v, state.a, state.auxiliary)
    return abs(R - state.residual).max() / state.size


def tension_error(module, n, pattern="line") -> float:
    """Return the largest relative error of T, unit and R, where the auxiliary tension decides and where not.

    A cell whose own tension is not positive keeps it as long as the auxiliary one is, and loses it with that.
    """
    state, errors = random_state("all", n, 1, pattern), []
    line, (d, opening) = state.line, (part[state.line.last] - part[state.line.first] for part in (state.r, state.v))
    size = np.linalg.norm(d, axis=1)
    t = d / size[:, None]
    law = line.EA * (size / line.length - 1 + line.damping * np.sum(t * opening, axis=1) / line.length)
    assert law.min() < 0 < law.max()
    for auxiliary in (np.ones_like(law), np.zeros_like(law), -np.ones_like(law)):
        R, T, unit = evaluate(module, line, state.r, state.v, state.a, auxiliary)
        wanted = np.where(auxiliary > 0, law, np.maximum(law, 0.0))
        errors += [abs(T - wanted).max() / abs(law).max(), abs(unit - t).max()]
        lost = np.minimum(law, 0.0) * (auxiliary > 0)  # against the state of mpmath, which has no negative tension
        pull = np.zeros_like(R)
        np.add.at(pull, line.first, lost[:, None] * t)
        np.add.at(pull, line.last, -lost[:, None] * t)
        errors.append(abs(R - (state.residual - pull)).max() / state.size)
    return max(errors)


def tangent_error(module, values, name, n, seed=1, pattern="line") -> float:
    """Return the largest difference of the module's tangents from complex steps through the residual of ``values``."""
    state = random_state(name, n, seed, pattern)
    line, r, v, a = state.line, state.r, state.v, state.a
    exact, (w_r, w_v, w_a) = np.zeros((r.size, r.size)), WEIGHTS
    for i in range(r.size):
        move = np.zeros(r.size, complex)
        move[i] = 1j * STEP
        move = move.reshape(r.shape)
        R = evaluate(values, line, r + w_r * move, v + w_v * move, a + w_a * move, state.auxiliary)[0]
        exact[:, i] = R.imag.ravel() / STEP
    size = abs(exact).max()
    return abs(matrix(module, line, r, v, a, state.auxiliary, WEIGHTS) - exact).max() / (size if size > 0 else 1.0)


def mixed_tangent_error(module, n, pattern="line") -> float:
    """Return the error of the change of the tangents as auxiliary tensions leave the law: a cell turns with them."""
    state = random_state("all", n, 1, pattern)
    first, last = state.line.first, state.line.last
    t = state.r[last] - state.r[first]
    size = np.linalg.norm(t, axis=1)
    t /= size[:, None]
    taut, worst = state.auxiliary > 0, 0.0
    for auxiliary in (state.auxiliary + 700.0 * taut, -1.0 * taut):
        wanted, more = np.zeros((NODES, n, NODES, n)), np.maximum(auxiliary, 0.0) - state.auxiliary
        for c in np.flatnonzero(taut):
            block = WEIGHTS[0] * more[c] / size[c] * (np.eye(n) - np.outer(t[c], t[c]))
            p, q = first[c], last[c]
            for i, j in ((p, p), (q, q), (p, q), (q, p)):
                wanted[i, :, j] += block if i == j else -block
        given = state.line, state.r, state.v, state.a
        change = matrix(module, *given, auxiliary, WEIGHTS) - matrix(module, *given, state.auxiliary, WEIGHTS)
        worst = max(worst, abs(change - wanted.reshape(change.shape)).max() / abs(wanted).max())
    return worst


def solution_error(module, n, pattern="line") -> float:
    """Return what a solved system leaves over, relative to sums without signs, with and without prescribed nodes."""
    state, worst = random_state("all", n, 1, pattern), 0.0
    for nodes in ((), (0,), (0, NODES - 1), (NODES - 1,), (2, 4)):
        order = state.order(*nodes)
        given = state.line, state.r, state.v, state.a, state.auxiliary, (1.0, 5.0, 40.0)
        blocks = tangent_blocks(module, *given, order.edges)
        whole = dense(state.line, *(part.copy() for part in blocks))
        rows = np.repeat(order.is_prescribed, n)
        whole[rows], whole[:, rows] = 0.0, 0.0
        whole[rows, rows] = 1.0
        x = np.random.default_rng(3).normal(0, 1, state.r.shape)
        x[order.is_prescribed] = 0.0
        wanted = np.linalg.solve(whole, x.ravel())
        sums = abs(abs(whole) @ abs(wanted)).max()
        module.factorise(order, *blocks, np.empty(n))
        module.solve(order, *blocks, x, np.empty(n))
        worst = max(worst, abs(whole @ (x.ravel() - wanted)).max() / sums, abs(x[order.is_prescribed]).max(initial=0.0))
    return worst


# ---------------------------------------------------------------- what they have to be
@AXES
@EACH_TERM
def test_forces_are_those_of_mpmath(name, n):
    """Each term alone and all of them, at states with cells taut and slack and nodes in and above the seabed."""
    for seed in (1, 2, 3):
        assert residual_error(compiled, name, n, seed) <= ROUNDING
    for pattern in BRANCHED:
        assert residual_error(compiled, name, n, 1, pattern) <= ROUNDING


@AXES
@EACH_PATTERN
def test_tensions_follow_the_active_set(n, pattern):
    """A cell is taut where its own or the auxiliary tension is positive; its force is what it says it is."""
    assert tension_error(compiled, n, pattern) <= ROUNDING


@AXES
@EACH_TERM
def test_tangents_are_complex_steps(name, n):
    """The tangents in r, v and a together, each term alone and all of them."""
    for seed in (1, 2):
        assert tangent_error(compiled, as_written(), name, n, seed) <= TANGENTS
    for pattern in BRANCHED if name in ("all", "drag of nodes in a current") else ():
        assert tangent_error(compiled, as_written(), name, n, 1, pattern) <= TANGENTS


@AXES
@EACH_PATTERN
def test_cells_turn_with_their_auxiliary_tension(n, pattern):
    """The lateral stiffness is that of the tension as Newton's method has it, and nothing else takes it."""
    assert mixed_tangent_error(compiled, n, pattern) <= 1e-12


@AXES
@EACH_PATTERN
def test_blocks_are_eliminated(n, pattern):
    """The factors solve what numpy solves without regard to a pattern; a prescribed node stays where it is."""
    assert solution_error(compiled, n, pattern) <= SOLVED


@EACH_PATTERN
def test_elimination_adds_the_blocks_that_it_must(pattern):
    """Those between two later neighbours of a pivot, by graph theory: a path of lower nodes joins two that fill."""
    state = random_state("all", 2, 1, pattern)
    joined = set(PATTERNS[pattern])
    for p in range(NODES):
        later = sorted(q for q in range(NODES) if (p, q) in joined)
        joined |= {(a, b) for a in later for b in later if a < b}
    assert state.order().edges == len(joined)
    assert {"line": 5, "three arms": 5, "star with its centre first": 15}.get(pattern, 7) == len(joined)


@AXES
def test_the_compiled_loops_are_those_on_the_page(n):
    """Residual, tangents and elimination compiled and as Python runs them differ by rounding at most."""
    state = random_state("all", n)
    given = state.line, state.r, state.v, state.a, state.auxiliary
    for one, other in zip(evaluate(compiled, *given), evaluate(as_written(), *given), strict=True):
        assert abs(one - other).max() <= 4 * EPS * abs(other).max()
    one, other = (matrix(module, *given, WEIGHTS) for module in (compiled, as_written()))
    assert abs(one - other).max() <= 4 * EPS * abs(other).max()
    assert max(solution_error(as_written(), n, pattern) for pattern in PATTERNS) <= SOLVED


@AXES
def test_tangents_stay_finite_where_nothing_moves(n):
    """At rest in still water nothing is divided by zero, and drag has no stiffness."""
    state = random_state("all", n)
    line, zeros = state.line._replace(current=(0.0,) * n), np.zeros_like(state.r)
    got = matrix(compiled, line, state.r, zeros, zeros, state.auxiliary, WEIGHTS)
    calm = line._replace(**{name: 0 * getattr(line, name) for name in ("normal_drag", "tangential_drag", "point_drag")})
    assert np.isfinite(got).all()
    assert np.array_equal(got, matrix(compiled, calm, state.r, zeros, zeros, state.auxiliary, WEIGHTS))


# ---------------------------------------------------------------- patch
@AXES
def test_a_uniform_stretch_leaves_nothing_inside(n):
    """A straight line of uneven cells, stretched evenly, pulls at its ends alone, by EA e."""
    state = random_state("tension", n)
    line, strain = state.line._replace(EA=np.full(NODES - 1, 4e3)), 0.04
    direction = np.array([0.6, 0.48, 0.64][:n]) / np.linalg.norm([0.6, 0.48, 0.64][:n])
    s = np.append(0.0, np.cumsum(line.length))
    r = -7.0 + (1 + strain) * s[:, None] * direction
    still = np.zeros_like(r)
    R, T, _ = evaluate(compiled, line, r, still, still, np.zeros(NODES - 1))
    rounding = 100 * EPS * 4e3  # of EA: the strain is a small difference of lengths
    assert abs(T - 4e3 * strain).max() <= rounding and abs(R[1:-1]).max() <= rounding
    assert abs(R[0] + 4e3 * strain * direction).max() <= rounding
    assert abs(R[-1] - 4e3 * strain * direction).max() <= rounding


@AXES
def test_a_steady_translation_changes_nothing(n):
    """In vacuo and above the seabed all nodes may move with one velocity; in water, with the current."""
    for name in ("tension and damping", "inertia", "added mass", "drag in a current"):
        state = random_state(name, n)
        zeros = np.zeros_like(state.r)
        still = evaluate(compiled, state.line, state.r, zeros, zeros, state.auxiliary)[0]
        v = zeros + (state.line.current if "current" in name else [1.7, -0.4, 0.9][:n])
        moved = evaluate(compiled, state.line, state.r, v, zeros, state.auxiliary)[0]
        wanted = 0 * still if "current" in name else still
        assert abs(moved - wanted).max() <= 10 * EPS * state.size


@AXES
def test_a_rigid_rotation_stretches_nothing(n):
    """Turning at a constant rate about any point, the damper of a cell is silent, and only the mass is accelerated."""
    state = random_state("tension and damping", n)
    spin = np.zeros((n, n))
    spin[0, 1:], spin[1:, 0] = [0.8, -0.5][: n - 1], [-0.8, 0.5][: n - 1]
    line = state.line._replace(mass=np.full(NODES - 1, 70.0), point_mass=np.full(NODES, 50.0))
    v = (state.r - 3.0) @ spin.T
    a = v @ spin.T
    zeros = np.zeros_like(v)
    halves = (np.append(line.length, 0.0) + np.append(0.0, line.length)) / 2
    wanted = (
        evaluate(compiled, line, state.r, zeros, zeros, np.zeros(NODES - 1))[0] + (70.0 * halves + 50.0)[:, None] * a
    )
    got = evaluate(compiled, line, state.r, v, a, np.zeros(NODES - 1))[0]
    assert abs(got - wanted).max() <= 20 * EPS * abs(wanted).max()


# ---------------------------------------------------------------- planted faults
FUNCTIONS = {
    EQUATIONS: ("residual", "drag", "seabed", "tangents", "drag_tangents", "seabed_tangents"),
    ELIMINATION: ("factorise", "solve"),
}
NAMED = [
    ("residual", "line.damping[c] * rate / l", "line.damping[c] * rate", "rate of strain over nothing"),
    ("residual", "distance / l", "l / distance", "strain of the inverse", 1),
    (
        "residual",
        "half * line.added_mass[c] * inertia",
        "half * line.added_mass[c - 1] * inertia",
        "added mass of the cell before",
    ),
    ("residual", "np.sqrt(distance / l)", "distance / l", "drag with the stretch itself"),
    ("residual", "T[c].real <= 0 and auxiliary[c] <= 0", "T[c].real <= 0", "no active set"),
    ("residual", "T[c].real <= 0 and auxiliary[c] <= 0", "auxiliary[c] <= 0", "a cell that never catches"),
    ("residual", "R[last, k] += T[c] * unit[c, k]", "pass", "an end that pulls alone"),
    ("residual", "last if side else first", "c + side", "halves of a cell on the nodes of a line"),
    ("residual", "line.last[c]", "line.first[c] + 1", "a cell that ends at the next node"),
    ("drag", "np.sqrt(square)", "square", "drag of a node with the cube of the speed"),
    ("drag", "(v[i, k] - line.current[k]) ** 2", "v[i, k] ** 2", "drag of a node with its speed over the ground"),
    ("seabed", "penetration.real <= 0", "penetration.real <= -1e9", "a seabed that holds from above"),
    ("seabed", "normal.real <= 0", "normal.real <= -1e9", "a seabed that pulls"),
    ("seabed", "line.slip_speed**2", "line.slip_speed", "friction of another smoothing"),
    ("seabed", "range(n - 1)", "range(n)", "friction with the sinking in it", 1),
    ("seabed", "damping *= penetration / line.contact_depth", "pass", "damping that jumps at contact"),
    ("seabed", "penetration.real < line.contact_depth", "line.contact_depth > 0", "damping that grows on and on"),
    ("tangents", "max(auxiliary[c], 0.0)", "auxiliary[c] * taut", "lateral stiffness of compression"),
    ("tangents", "2 * slide * tt", "slide * tt", "half a tangent of tangential drag"),
    ("tangents", "turning * unit[j] * across[k]", "0.0 * across[k]", "no turn of the rate of strain"),
    ("tangents", "ma * (a[i, k] - inertia * unit[k])", "0.0 * ma", "added mass that stays"),
    (
        "tangents",
        "along * (slide - cn * speed) - ma * inertia",
        "along * (slide - cn * speed)",
        "added mass left behind",
    ),
    ("tangents", "cn * speed * normal[j] / 2", "cn * speed * normal[j]", "the stretch of the drag doubled"),
    ("tangents", "slide * along * unit[k] / 2", "slide * along * unit[k]", "the stretch of the drag along doubled"),
    ("tangents", "line.last[c]", "line.first[c] + 1", "tangents of a cell that ends at the next node"),
    (
        "tangents",
        "add_own(diagonal, i, j, k, weights, by_r, by_v + by_rate, m * (tt + P) + ma * P)",
        "add_own(diagonal, c + side, j, k, weights, by_r, by_v + by_rate, m * (tt + P) + ma * P)",
        "stiffness on the next node",
    ),
    (
        "tangents",
        "add_next(left, c, j, k, weights, -by_r, -by_rate)",
        "add_next(right, c, j, k, weights, -by_r, -by_rate)",
        "loads that turn with the wrong end",
    ),
    ("drag_tangents", "line.point_drag[i] * uu", "0.0 * uu", "drag of a node that does not grow"),
    ("seabed_tangents", "by_height * up", "0.0 * up", "friction of a constant weight"),
    ("seabed_tangents", "up -= c * v[i, -1] / line.contact_depth", "pass", "damping of a constant depth"),
]
"""(function, old, new, what[, place]) of faults that are no signs."""


def red_checks(module, function="") -> list[str]:
    """Return the names of the checks, those of one function or all, that a module turns red."""
    values, elimination = ("residual", "drag", "seabed"), ("factorise", "solve")
    tangents, loops = ("tangents", "drag_tangents", "seabed_tangents"), BRANCHED[2]
    red = []
    for n in (2, 3):
        checks = {
            ("forces", values): lambda: max(residual_error(module, name, n) for name in TERMS),  # noqa: B023
            ("forces of branches", values): lambda: residual_error(module, "all", n, 1, loops),  # noqa: B023
            ("tensions", values): lambda: tension_error(module, n),  # noqa: B023
            ("tangents", tangents): lambda: max(
                tangent_error(module, as_written(), name, n)  # noqa: B023
                for name in ("all", "tension and damping", "added mass")
            ),
            ("tangents of branches", tangents): lambda: tangent_error(module, as_written(), "all", n, 1, loops),  # noqa: B023
            ("turning", tangents): lambda: mixed_tangent_error(module, n),  # noqa: B023
            ("elimination", elimination): lambda: max(
                solution_error(module, n, pattern)  # noqa: B023
                for pattern in ("line", loops)
            ),
        }
        for (name, functions), check in checks.items():
            if function and function not in functions:
                continue
            try:
                with np.errstate(all="ignore"):  # a planted fault may overflow
                    is_red = not check() <= SEEN  # nan is red
            except (ArithmeticError, ValueError, TypeError, IndexError):
                is_red = True
            if is_red:
                return [f"{name}, {n} axes"]
    return red


@pytest.mark.parametrize("fault", NAMED, ids=lambda fault: fault[3])
def test_a_planted_fault_is_seen(fault):
    """Each mistake that is no sign turns a check red."""
    function, old, new, _, *place = fault
    assert red_checks(interpreted(Fault(EQUATIONS, function, old, new, *place)), function)


def test_planted_signs_are_seen(deep):
    """The sign of each single term of the residual, the tangents and the elimination: no fault passes all checks."""
    survivors = []
    every = 1 if deep else 12
    for fault in (fault for place, names in FUNCTIONS.items() for fault in sign_faults(place, names, every)):
        zero = "(-(0.0" in fault.new  # which has no sign
        if not zero and not red_checks(interpreted(fault), fault.function):
            survivors.append(str(fault))
    assert not survivors, "\n".join(survivors)


def test_no_fault_no_red():
    """The same checks pass on the text with a change that is none."""
    assert not red_checks(interpreted(Fault(EQUATIONS, "residual", "distance / l", "distance / l * 1", 2)))
