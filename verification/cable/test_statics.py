"""Is the equilibrium of the cable right: against 50-digit catenaries, the contact catenary, and a line in a current?

Truth with a current or an elastic seabed is a shot along the whole line in Cartesian vectors (``Shot``), which shares
no formula with the box scheme in strain and angles.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import root

from solvers.cable.statics import exact_pretension

from ..cases.cables import OC3, OC3_SEABED, SHORT_CHAIN, SLACK_CHAIN, STUDLESS_CHAIN, CableCase
from ..exact.cable import catenary_mp
from ..tools.orders import assert_order, extrapolated
from ..tools.planting import Fault, planted
from .problems import SOLVERS, graded, system

NODES = (51, 101, 201)
DIGITS = 25
solve_static = SOLVERS.cable.statics.solve_static


# ---------------------------------------------------------------- truth
@dataclass(frozen=True)
class Truth:
    """Forces of the line on the vessel and on the anchor, (3,), N, and r(s): positions (3, n), m."""

    fairlead_force: np.ndarray
    anchor_force: np.ndarray
    r: object


@cache
def catenary(case) -> Truth:
    """The elastic catenary of a case in the x, z plane, by quadrature."""
    line = {"w": case.submerged_weight, "EA": case.EA, "L": case.length, "seabed": case.depth is not None}
    dx, _, dz = (b - a for a, b in zip(case.anchor, case.fairlead, strict=True))
    line |= {"x": dx, "z": dz}
    state = catenary_mp.solve(**line, digits=DIGITS)

    def r(s):
        points = [catenary_mp.profile(one, **line, solution=state)[:2] for one in s]
        return np.array([[case.anchor[0] + float(x), 0.0, case.anchor[2] + float(z)] for x, z in points]).T

    force = lambda H, V, sign: sign * np.array([float(H), 0.0, float(V)])
    return Truth(force(state.H, state.V, -1), force(state.H_anchor, state.V_anchor, 1), r)


@cache
def shot(case) -> Truth:
    """r' = (1 + T/EA) t, F' = w_e z - drag of the current, Cdn = Cdb; F at the anchor such that r ends in place."""
    current, w0, half = np.array(case.current), case.submerged_weight, case.rho * case.diameter / 2

    def rate(_, state):
        r, F = state[:3], state[3:]
        T = math.sqrt(F @ F)
        t, stretch = F / T, 1 + T / case.EA
        along = (current @ t) * t
        across = current - along
        drag = case.Cdn * np.linalg.norm(across) * across + math.pi * case.Cdt * np.linalg.norm(along) * along
        support = 0.0 if case.depth is None else max(case.seabed_stiffness * (-case.depth - r[2]), 0.0)
        return np.concatenate([stretch * t, [0.0, 0.0, w0 - support] - half * math.sqrt(stretch) * drag])

    def shoot(F, dense=False):
        start = [*case.anchor, *F]
        return solve_ivp(rate, (0, case.length), start, "DOP853", rtol=1e-13, atol=1e-10, dense_output=dense)

    guess = solve_static(system(case, 51)).anchor_force
    solution = root(lambda F: shoot(F).y[:3, -1] - case.fairlead, guess, tol=1e-12)
    assert abs(solution.fun).max() < MISSED, solution.message
    line = shoot(solution.x, True).sol
    return Truth(-line(case.length)[3:], solution.x, lambda s: line(s)[:3])


MISSED = 1e-8  # m between the end of the shot and the fairlead: 1e-10 of the force, below every error measured here


def errors(case, truth, mesh) -> tuple[float, float, float]:
    """Errors at one mesh: force on vessel and anchor over the tension there, and positions over the length."""
    state = solve_static(system(case, mesh=mesh))
    relative = lambda got, wanted: float(np.linalg.norm(got - wanted) / np.linalg.norm(wanted))
    some = slice(None, None, (state.system.nodes - 1) // 10)
    position = abs(state.r[:, some] - truth.r(state.system.s[some])).max() / case.length
    return (
        relative(state.fairlead_force, truth.fairlead_force),
        relative(state.anchor_force, truth.anchor_force),
        float(position),
    )


CEILING = 8e-5  # of forces and positions at 201 nodes: twice the largest measured (buoyant line, graded mesh)

# ---------------------------------------------------------------- without seabed
TAUT = replace(OC3, name="taut", length=880.0)
SLACK = replace(OC3, name="slack", length=1100.0)
LOW = replace(OC3, name="fairlead below the anchor", fairlead=(700.0, 0.0, -150.0))
BUOYANT = replace(OC3, name="buoyant", submerged_weight=-300.0)
SOFT = replace(OC3, name="soft", EA=2e6)
MESHES = {"uniform": lambda L, n: np.linspace(0.0, L, n), "graded": graded}


@pytest.mark.parametrize("mesh", MESHES)
@pytest.mark.parametrize("case", [OC3, TAUT, SLACK, LOW, BUOYANT, SOFT], ids=lambda case: case.name)
def test_box_scheme_converges_to_the_catenary(case, mesh):
    """Forces at both ends and positions of nodes converge to the catenary with order 2, on even and graded meshes."""
    truth = catenary(case)
    table = np.array([errors(case, truth, MESHES[mesh](case.length, n)) for n in NODES])
    for column, what in zip(table.T, ("fairlead", "anchor", "positions"), strict=True):
        assert_order([1 / (n - 1) for n in NODES], column, 2, ceiling=CEILING, what=f"{case.name}, {what}")


def test_the_oc3_line_is_that_of_the_notes():
    """Fairlead tension 961.788 kN on 50 nodes, and 961.530 kN of the catenary: both to the last digit."""
    assert solve_static(system(OC3, 50)).tension[-1] == pytest.approx(961.788e3, abs=0.5)
    assert np.linalg.norm(catenary(OC3).fairlead_force) == pytest.approx(961.530e3, abs=0.5)


# ---------------------------------------------------------------- current
IN_PLANE = replace(OC3, name="current in the plane", current=(0.9, 0.0, 0.2), Cdt=0.05)
ACROSS = replace(OC3, name="current across", current=(0.7, 1.4, 0.1), Cdt=0.05)


@pytest.mark.parametrize("mesh", MESHES)
@pytest.mark.parametrize("case", [IN_PLANE, ACROSS], ids=lambda case: case.name)
def test_box_scheme_converges_to_the_line_in_a_current(case, mesh):
    """The same in a current, against a shot along the line in Cartesian vectors."""
    truth = shot(case)
    table = np.array([errors(case, truth, MESHES[mesh](case.length, n)) for n in NODES])
    for column, what in zip(table.T, ("fairlead", "anchor", "positions"), strict=True):
        assert_order([1 / (n - 1) for n in NODES], column, 2, ceiling=CEILING, what=f"{case.name}, {what}")


def test_the_shot_is_right_in_still_water():
    """The truth with a current tends to the truth without one: forces of the catenary to ten digits."""
    for name in ("fairlead_force", "anchor_force"):
        assert getattr(shot(OC3), name) == pytest.approx(getattr(catenary(OC3), name), rel=1e-9, abs=1e-3)


# ---------------------------------------------------------------- seabed
@pytest.mark.parametrize("case", [OC3_SEABED, replace(OC3_SEABED, current=(0.7, 1.4, 0.1))], ids=["still", "current"])
def test_box_scheme_on_an_elastic_seabed(case):
    """With a node where the line leaves the seabed, order 2 against the shot; without one, an error below C ds^2."""
    truth = shot(case)
    s = np.linspace(0, case.length, 200_001)
    lift = s[np.argmax(truth.r(s)[2] > -case.depth + 1e-6)]
    meshes = [
        np.concatenate([np.linspace(0, lift, n)[:-1], np.linspace(lift, case.length, 4 * n)]) for n in (20, 39, 77)
    ]
    table = [errors(case, truth, mesh)[0] for mesh in meshes]
    assert_order([1.0, 19 / 38, 19 / 76], table, 2, ceiling=CEILING, what="node at the lift-off")
    for n in (51, 101, 201, 401):
        assert errors(case, truth, np.linspace(0, case.length, n))[0] <= LIFT_OFF * (case.length / (n - 1)) ** 2, n


LIFT_OFF = 3e-6  # 1/m^2: C of the relative error C ds^2 wherever in a cell the line leaves; measured up to 2.2e-6
STIFF = (1e3, 1e4, 1e5, 1e6, 1e7)  # N/m^2
SEABED_NODES = 6401  # a boundary layer sqrt(T/k) of 0.27 m at the stiffest: two cells


def test_a_stiffening_seabed_tends_to_the_contact_catenary():
    """k from 1e3 to 1e7 N/m^2: the fairlead tension tends to that of the contact catenary like 1/k."""
    rigid = np.linalg.norm(catenary(OC3_SEABED).fairlead_force)
    gaps = []
    for k in STIFF:
        state = solve_static(system(replace(OC3_SEABED, seabed_stiffness=k), SEABED_NODES))
        gaps.append(state.tension[-1] - rigid)
        sink = OC3_SEABED.submerged_weight / k
        assert state.r[2].min() >= -OC3_SEABED.depth - 1.01 * sink, k
    assert_order(1 / np.array(STIFF[1:4]), gaps[1:4], 1, ceiling=4.0, what="tension over 1/k")  # N
    assert gaps[-1] == pytest.approx(gaps[-2] / 10, abs=0.05)  # N: the mesh's own error, 1e-7 of the tension


def test_a_resting_line_sinks_by_its_weight():
    """Far from the lift-off the line lies w0/k deep, to 1e-6 of that."""
    state = solve_static(system(replace(OC3_SEABED, seabed_stiffness=1e5), 801))
    resting = (state.system.s > 50) & (state.system.s < 80)  # 18 boundary layers sqrt(T/k) from either end
    sink = (-OC3_SEABED.depth - state.r[2, resting]) / (OC3_SEABED.submerged_weight / 1e5)
    assert sink == pytest.approx(np.ones(sink.size), abs=1e-6)


# ---------------------------------------------------------------- the state that is returned
@pytest.mark.parametrize("fields", ["planar", "spatial"])
@pytest.mark.parametrize(
    "case",
    [OC3, OC3_SEABED, TAUT, BUOYANT, replace(OC3_SEABED, current=(1.0, 0.0, 0.0), Cdt=0.05)],
    ids=lambda case: f"{case.name}{' current' * any(case.current)}",
)
def test_the_equilibrium_solves_the_rows_and_meets_the_ends(case, fields):
    """The rows of the dynamic system are met at rest, the drift of the end is nil, and status and work are reported."""
    chain = system(case, 50, fields=fields)
    state = solve_static(chain, tolerance=RESIDUAL / 10)  # a seabed answers an error of a height with its stiffness
    assert state.success and 1 <= state.iterations <= 20
    assert abs(solve_static(chain).y - state.y).max() <= SETTLED * abs(state.y).max()
    rows = chain.residual(state.y, 0 * state.y, 0.0)
    assert abs(rows).max() <= RESIDUAL * case.EA * abs(state.y[0]).max() / chain.ds.min()
    assert np.linalg.norm(chain.drift(state.y, 0.0)) <= MET * case.length
    assert abs(state.r[:, [0, -1]] - np.array([case.anchor, case.fairlead]).T).max() <= MET * case.length
    assert not state.y[1 : 1 + chain.dimension].any()


SETTLED = 1e-9  # of the largest field: a hundred times the mean change at which a solution stops
RESIDUAL = 1e-11  # over the largest part of row 1
MET = 1e-13  # of the length: a hundred cells sum to it


@pytest.mark.parametrize("case", [OC3_SEABED, ACROSS, IN_PLANE], ids=lambda case: case.name)
def test_shooting_agrees_with_the_truth(case):
    """solve_static(method="shooting") has the truth's forces to nine digits, on any number of nodes."""
    truth = shot(case)
    for nodes in (11, 50):
        state = solve_static(system(case, nodes), method="shooting")
        assert state.fairlead_force == pytest.approx(truth.fairlead_force, rel=1e-9, abs=1e-3)
        assert state.anchor_force == pytest.approx(truth.anchor_force, rel=1e-9, abs=1e-3)
        assert state.r == pytest.approx(truth.r(state.system.s), abs=1e-7)


def test_shooting_has_the_drag_of_the_binormal():
    """With C_db unlike C_dn, in a current across, the box scheme converges to the forces of the shooting method."""
    case = replace(OC3, Cdb=0.6, Cdt=0.05, current=(0.7, 1.4, 0.1))
    forces = [solve_static(system(case, nodes)).fairlead_force for nodes in (51, 101, 201)]
    shot = solve_static(system(case, 51), method="shooting").fairlead_force
    change = abs(shot - solve_static(system(replace(case, Cdb=None), 51), method="shooting").fairlead_force).max()
    error = abs(extrapolated([4, 2, 1], forces) - shot).max()
    assert error <= 1e-3 * change, (error, change)  # h^4 is left, some 1e-9 of the force: measured 2e-5 of the change


def test_a_strong_current_is_reached_in_steps():
    """A current of 20 m/s across, 26 times the weight, is reached, and its shape is the shot's to the mesh's error."""
    case = replace(OC3, current=(0.0, 20.0, 0.0))
    got = errors(case, shot(case), np.linspace(0, case.length, 201))
    assert max(got) <= CEILING, got


@pytest.mark.parametrize(
    ("case", "why"),
    [
        (replace(OC3, submerged_weight=0.0), "a weightless line longer than its chord has no shape"),
        (replace(OC3_SEABED, length=1200.0), "the part on the seabed has no tension"),
    ],
)
def test_no_equilibrium_is_a_status(case, why):
    """A line without a stressed equilibrium ends in NO_EQUILIBRIUM_FOUND, raised or returned."""
    state = solve_static(system(case), throw=False)
    assert state.status is SOLVERS.common.outcome.Status.NO_EQUILIBRIUM_FOUND and not state.success, why
    with pytest.raises(SOLVERS.common.outcome.ConvergenceError, match="no equilibrium") as raised:
        solve_static(system(case))
    assert raised.value.outcome.status is state.status


# ---------------------------------------------------------------- refusals
@pytest.mark.parametrize(
    ("case", "options", "message"),
    [
        (OC3, {"nodes": 2}, r"nodes: 2 must be a whole number from 3"),
        (OC3, {"nodes": 7.0}, r"nodes: 7.0 must be a whole number from 3"),
        (OC3, {"nodes": True}, r"nodes: True must be"),
        (OC3, {"mesh": [0.0, 902.2]}, r"mesh: must be three or more finite, increasing arc lengths \(m\)"),
        (OC3, {"mesh": [0.0, 500.0, 500.0, 902.2]}, r"mesh: must be three or more finite, increasing"),
        (OC3, {"mesh": [0.0, math.nan, 902.2]}, r"mesh: must be three or more finite"),
        (OC3, {"mesh": [0.0, 500.0, 902.0]}, r"mesh: runs from 0 to 902 m, .* 0 to the length, 902.2 m"),
        (OC3, {"fields": "all"}, r"fields: 'all' must be 'auto', 'planar' or 'spatial'"),
        (ACROSS, {"fields": "planar"}, r"fields: 'planar', but the current or the motion leaves"),
        (replace(OC3, amplitude=(0.0, 1.0, 0.0)), {"fields": "planar"}, r"fields: 'planar', but the current or the"),
        (replace(OC3, diameter=None), {}, r"diameter: not given, and dynamics needs it \(m\)"),
        (replace(OC3, mass_per_length=None), {}, r"mass_per_length: not given, and dynamics needs it \(kg/m\)"),
        (replace(OC3_SEABED, seabed_stiffness=None), {}, r"seabed_stiffness: not given \(N/m\^2\).*2.7e\+05 N/m\^2"),
    ],
)
def test_bad_systems_are_refused(case, options, message):
    """Too few nodes, a mesh that is none, fields that do not hold the loads, missing numbers: named with units."""
    with pytest.raises(SOLVERS.common.outcome.InputError, match=message):
        system(case, **options)


def test_a_method_that_is_none_is_refused():
    """An unknown method is named."""
    with pytest.raises(SOLVERS.common.outcome.InputError, match=r"method: 'magic' must be 'box' or 'shooting'"):
        solve_static(system(OC3), method="magic")


# ---------------------------------------------------------------- pretension
def test_a_pretension_that_the_mesh_spoils_is_warned_of():
    """On a coarse mesh over a seabed, in the state and in what moves from it; on a finer one not."""
    coarse, fine = (solve_static(system(SHORT_CHAIN, nodes)) for nodes in (25, 100))
    assert coarse.pretension_error > 0.04 and coarse.warnings[0].startswith("mesh: the pretension is off by 0.05")
    assert fine.pretension_error < 0.01 and not fine.warnings
    moving = system(replace(SHORT_CHAIN, amplitude=(0.1, 0.0, 0.0)), 25)
    history = SOLVERS.time_domain.solve.solve_time_domain(moving, dt=1.0, duration=4.0)
    assert any(text.startswith("mesh:") for text in history.warnings)


def test_the_pretension_error_is_that_of_the_catenary():
    """Of a hanging line: the box scheme's 961.788 kN over the catenary's 961.530 kN; none in a current."""
    assert abs(solve_static(system(OC3, 50)).pretension_error - (961.788 / 961.530 - 1)) < 2e-6
    assert solve_static(system(replace(OC3, current=(0.5, 0.0, 0.0)), 25)).pretension_error is None


CHAIN_60_M = CableCase(
    "60 m of chain in 5 m of water",
    EA=1.2e8,
    diameter=0.05,
    mass_per_length=55.0,
    submerged_weight=520.0,
    length=60.0,
    anchor=(0.0, 0.0, -5.0),
    fairlead=(56.25, 0.0, 0.0),
    depth=5.0,
)
YIELDING = {
    OC3_SEABED: (3e3, 1e3),
    replace(SLACK_CHAIN, current=(0.0, 0.0, 0.0)): (8e3, 3e3),
    SHORT_CHAIN: (2e4, 1e4, 8e3),
    STUDLESS_CHAIN: (1.75e5, 2e4, 5e3),
    CHAIN_60_M: (1e5, 2e4, 1e4),
}
"""Line -> stiffness of its seabed, N/m^2: it changes the tension by up to 1 %, half of what is allowed for."""
MEAN_ERROR = 0.05  # of the effect of the seabed, which the mean cancels to first order; measured 0.023


@pytest.mark.parametrize(
    "case",
    [replace(line, seabed_stiffness=k) for line, stiffnesses in YIELDING.items() for k in stiffnesses],
    ids=lambda case: f"{case.name}, {case.seabed_stiffness:g}",
)
def test_the_exact_pretension_over_a_yielding_seabed_is_that_of_shooting(case):
    """A 20th of the change that the yielding makes, and 4e-4 of the tension, a 25th of what warnings begin with."""
    line = system(case, 100)
    exact, shot_tension = exact_pretension(line), solve_static(line, method="shooting").tension[-1]
    effect = abs(exact / exact_pretension(line.replace(seabed_stiffness=1e12)) - 1)
    assert 1e-4 < effect < 0.01
    assert abs(exact / shot_tension - 1) <= min(MEAN_ERROR * effect, 4e-4)


@pytest.mark.parametrize("method", ["box", "shooting"])
def test_a_seabed_without_stiffness_is_none(method):
    """The line hangs through it as in deep water, by both methods, and so does the exact one."""
    nothing = system(replace(OC3_SEABED, seabed_stiffness=0.0), 21)
    deep = system(replace(OC3_SEABED, depth=None, seabed_stiffness=None), 21)
    states = [solve_static(chain, method=method) for chain in (nothing, deep)]
    assert states[0].tension == pytest.approx(states[1].tension, rel=1e-9)
    assert exact_pretension(nothing) == exact_pretension(deep)


def test_a_soft_seabed_is_no_error_of_the_mesh():
    """A chain that sinks by 1.2 m is off 0.8 % from the line on a rigid seabed, and by less than 3e-4 in its mesh."""
    state = solve_static(system(replace(STUDLESS_CHAIN, seabed_stiffness=5e3), 400))
    rigid = exact_pretension(state.system.replace(seabed_stiffness=1e12))
    assert abs(state.tension[-1] / rigid - 1) > 7e-3 and state.pretension_error < 3e-4 and not state.warnings


def test_a_seabed_too_soft_for_a_catenary_gives_no_pretension_error():
    """The rigid catenaries at first contact and w/k lower differ by 2.8 %: no exact tension, and no warning."""
    state = solve_static(system(replace(SHORT_CHAIN, seabed_stiffness=5e3), 25))
    assert state.success and exact_pretension(state.system) is None
    assert state.pretension_error is None and not state.warnings


# ---------------------------------------------------------------- planted faults
@pytest.mark.parametrize(
    "fault",
    [
        Fault(
            "cable.planar", "local_terms", "m * (v * phi_t - u_t) - c.w0 * cos", "m * (v * phi_t - u_t) + c.w0 * cos"
        ),
        Fault("cable.planar", "add_stiffness", "F[1] += T * y_s[PHI]", "F[1] -= T * y_s[PHI]"),
        Fault("cable.equations", "CableEquations._box_scheme", "q[1:] + q[:-1]", "2 * q[1:]"),
        Fault(
            "cable.statics",
            "_Statics.rows",
            "2 * (place[:, 1:] - place[:, :-1]) / system.ds - tangent[:, 1:] - tangent[:, :-1]",
            "2 * (place[:, 1:] - place[:, :-1]) / system.ds - 2 * tangent[:, 1:]",
        ),
    ],
    ids=str,
)
def test_a_wrong_equation_is_seen_by_the_catenary(fault):
    """A wrong sign finds no catenary, a one-sided mean only one of first order."""
    truth = catenary(OC3)
    with planted(fault) as faulty:
        gaps = []
        for nodes in NODES:
            state = faulty.cable.statics.solve_static(system(OC3, nodes, faulty), throw=False)
            gaps.append(np.linalg.norm(state.fairlead_force - truth.fairlead_force) if state.success else np.nan)
    with pytest.raises(AssertionError):
        assert_order([1 / (n - 1) for n in NODES], gaps, 2, ceiling=CEILING * np.linalg.norm(truth.fairlead_force))
