"""Are mistakes called by their names? Each is planted in an adapter around this project's solvers and judged.

The tables hold what the oracle makes of a mistake. Here it is made by another road where there is one: the weight from
mass and diameter, friction in the closed form of MSQS (2.12), the middle of a segment from the profile.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import brentq, root

from solvers import ConvergenceError, Element, Environment, InputError, Network, Node, Span, solve_network, solve_span

from ...conformance.judge import INACCURATE, REFUSED, RIGHT, WRONG, Judgement, judge
from ...conformance.problems import as_arguments
from ...conformance.results.summary import name_mistakes
from ...conformance.tables import load_table

STEEL = 7000.0  # kg/m^3: denser than this per volume-equivalent section is a chain, as no rope of the tables is
CELLS = 20  # segments of the line whose last one is taken for its end, as the table says
RIGID = 1e7  # on EA: another factor than the tables', the same answer to what is judged
TABLES = {level: load_table(level) for level in ("statics", "network")}


class NoAnswer(Exception):
    """The mistaken solver finds none."""


# ---------------------------------------------------------------- lines at rest
def solve_line(case, **changes):
    """Return all quantities of a line, with some inputs changed."""
    try:
        state = solve_span(Span(**case.inputs() | changes))
    except (InputError, ConvergenceError) as error:
        raise NoAnswer(str(error)) from None
    x, z, tension = state.profile(np.minimum(case.s, state.span.L))
    answer = {name: getattr(state, name) for name in ("H", "V", "H_anchor", "V_anchor", "grounded_length")}
    answer |= {"profile": np.column_stack([x, z]), "tension": tension, "stiffness": state.stiffness}
    return answer | ({} if np.isfinite(state.stiffness).all() else {"stiffness": None})


def weight(case, rho=None, g=None, diameter=None):
    """Return the submerged weight that a code computes of mass and diameter, N/m."""
    area = math.pi * (diameter or case.diameter) ** 2 / 4
    return (g or case.g) * (case.mass_per_length - area * (rho or case.rho))


def weighing(**mistake):
    """Return a solver that computes the weight itself, with a mistake."""
    return lambda case: solve_line(case, w=weight(case, **{name: value(case) for name, value in mistake.items()}))


def is_chain(part):
    return part.mass_per_length / (math.pi / 4 * part.diameter**2) > STEEL


def nominal(part):
    """Return the nominal diameter of a chain, m."""
    return part.diameter / 1.8 if is_chain(part) else part.diameter


def rub(sign):
    """Return a solver whose friction takes tension towards the anchor (+1) without a limit, or adds it (-1)."""

    def solve(case):
        start = solve_line(case)
        if not case.friction or not start["grounded_length"] or start["V"] <= 0:
            return start
        return _closed_form(case, sign * case.friction, start)

    return solve


def _closed_form(case, friction, start):
    """Return H, V and the anchor's forces of MSQS (2.12), (2.14) with x0 <= 0 throughout."""
    w, EA, L = case.w, case.EA, case.L

    def position(forces):
        H, V = forces
        grounded, t = L - V / w, V / H
        x = grounded + H / w * math.asinh(t) + H * L / EA - friction * w * grounded**2 / (2 * EA)
        return [x - case.x, H / w * (math.hypot(1, t) - 1) + V**2 / (2 * EA * w) - case.z]

    H, V = root(position, [start["H"], start["V"]], tol=1e-13).x
    grounded = L - V / w
    return {"H": H, "V": V, "H_anchor": H - friction * w * grounded, "V_anchor": 0.0, "grounded_length": grounded}


def scaled(factor):
    """Return a solver whose forces and stiffness are in another unit."""

    def solve(case):
        answer = solve_line(case)
        forces = ("H", "V", "H_anchor", "V_anchor", "tension", "stiffness")
        return answer | {name: answer[name] * factor for name in forces if answer[name] is not None}

    return solve


def degrees(case):
    answer = solve_line(case)
    T, angle = math.hypot(answer["H"], answer["V"]), math.degrees(math.atan2(answer["V"], answer["H"]))
    return answer | {"H": T * math.cos(angle), "V": T * math.sin(angle)}


def swap_ends(case):
    answer = solve_line(case)
    return answer | {"H": answer["H_anchor"], "V": answer["V_anchor"], "H_anchor": answer["H"], "V_anchor": answer["V"]}


def anchor_at_both(case):
    answer = solve_line(case)
    return answer | {"H": answer["H_anchor"], "V": answer["V_anchor"]}


def upwards(case):
    answer = solve_line(case)
    return answer | {"V": -answer["V"], "V_anchor": -answer["V_anchor"]}


def middle_of_last_segment(case):
    """Return the force vectors of the middle of the end segments, from the tension there and the constant H."""
    answer, state = solve_line(case), solve_span(Span(**case.inputs()))
    half = case.L / (2 * CELLS)
    top = _vertical(state.profile(case.L - half)[2], answer["H"], answer["V"])
    changed = {"V": top}
    if not answer["grounded_length"]:
        changed["V_anchor"] = _vertical(state.profile(half)[2], answer["H"], answer["V_anchor"])
    return answer | changed


def _vertical(T, H, like):
    return math.copysign(math.sqrt(max(float(T) ** 2 - H**2, 0.0)), like)


def chord_weight(case):
    return solve_line(case, w=case.w * math.hypot(case.x, case.z) / case.L)


def stretched_length(case):
    """Return the answer of the line whose length after stretching, summed over its profile, is L."""

    def excess(L):
        state = solve_span(Span(**case.inputs() | {"L": L}))
        bottom = state.grounded_length
        parts = [np.linspace(0, bottom, 2001)] * (bottom > 0) + [np.linspace(bottom, L, 20001)]
        return L + sum(np.trapezoid(state.profile(s)[2], s) for s in parts) / case.EA - case.L

    try:
        L = brentq(excess, 0.9 * case.L, case.L, xtol=1e-12 * case.L)
    except (ValueError, ConvergenceError):
        raise NoAnswer("no unstretched length") from None
    return solve_line(case, L=L)


def tension_for_horizontal(case):
    answer = solve_line(case)
    pairs = (("H", "V"), ("H_anchor", "V_anchor"))
    return answer | {h: math.hypot(answer[h], answer[v]) for h, v in pairs}


def horizontal_tension(case):
    """Return for the tension its horizontal component, from the tangent of the profile."""
    answer, state = solve_line(case), solve_span(Span(**case.inputs()))
    h = 1e-6 * case.L
    ahead, behind = (state.profile(np.asarray(case.s) + d) for d in (h, -h))
    along = np.hypot(ahead[0] - behind[0], ahead[1] - behind[1])
    return answer | {"tension": answer["tension"] * (ahead[0] - behind[0]) / np.where(along, along, 1.0)}


def from_fairlead(case):
    mirrored = type(case)(**vars(case) | {"s": [case.L - s for s in case.s]})
    return solve_line(mirrored)


def flexibility(case):
    answer = solve_line(case)
    if answer["stiffness"] is None or not np.linalg.det(answer["stiffness"]):
        return answer
    return answer | {"stiffness": np.linalg.inv(answer["stiffness"])}


def negative_stiffness(case):
    answer = solve_line(case)
    return answer | ({} if answer["stiffness"] is None else {"stiffness": -answer["stiffness"]})


def suspended_length(case):
    answer = solve_line(case)
    return answer | {"grounded_length": case.L - answer["grounded_length"]}


STATICS = {
    "friction_ignored": lambda case: solve_line(case, friction=0.0),
    "friction_sign": rub(-1),
    "friction_unlimited": rub(+1),
    "weight_in_air": lambda case: solve_line(case, w=case.mass_per_length * case.g),
    "g_9_81": weighing(g=lambda case: 9.81),
    "rho_1000": weighing(rho=lambda case: 1000.0),
    "nominal_diameter": weighing(diameter=nominal),
    "radius_for_diameter": weighing(diameter=lambda case: 2 * case.diameter),
    "elasticity_ignored": lambda case: solve_line(case, EA=RIGID * case.EA),
    "EA_per_area": lambda case: solve_line(case, EA=case.EA / (math.pi * (case.diameter / 2) ** 2)),
    "seabed_ignored": lambda case: solve_line(case, seabed=False, friction=0.0, clearance=0.0),
    "clearance_ignored": lambda case: solve_line(case, clearance=0.0),
    "chord_for_length": chord_weight,
    "stretched_for_unstretched": stretched_length,
    "kN_for_N": scaled(1e-3),
    "kgf_for_N": scaled(1 / 9.80665),
    "degrees": degrees,
    "ends_swapped": swap_ends,
    "anchor_force_for_fairlead": anchor_at_both,
    "vertical_sign": upwards,
    "tension_of_last_segment": middle_of_last_segment,
    "tension_for_horizontal": tension_for_horizontal,
    "horizontal_for_tension": horizontal_tension,
    "s_from_fairlead": from_fairlead,
    "flexibility_for_stiffness": flexibility,
    "stiffness_sign": negative_stiffness,
    "grounded_length_suspended": suspended_length,
}


# ---------------------------------------------------------------- networks at rest
def solve_net(network, node=lambda node: {}, line=lambda line: {}, **environment):
    """Return all quantities of a network, with inputs of its nodes, lines and environment changed."""
    names = {"nodes": ("kind", "r", "mass", "volume", "force"), "elements": ("w", "EA", "L", "ends", "friction")}
    pick = lambda part, one: {name: getattr(one, name) for name in names[part]}
    nodes = [Node(**pick("nodes", one) | node(one)) for one in network.nodes]
    lines = [Element(**pick("elements", one) | line(one)) for one in network.elements]
    water = {name: getattr(network.environment, name) for name in ("rho", "g", "depth")} | environment
    try:
        state = solve_network(Network(nodes, lines, Environment(**water)), tolerance=1e-12)
    except (InputError, ConvergenceError) as error:
        raise NoAnswer(str(error)) from None
    ends = [np.hypot(state.H_anchor, state.V_anchor), np.hypot(state.H, state.V)]
    answer = {"r": state.r, "tension": np.column_stack(ends), "stiffness": None}
    if network.body:
        answer["stiffness"] = state.body_stiffness(network.body.reference)
    return answer | {"state": state}


def net_weighing(rho=None, g=None, diameter=lambda line: line.diameter):
    """Return a solver of networks that computes weights itself, with a mistake."""

    def solve(network):
        water = network.environment
        used = {"rho": rho or water.rho, "g": g or water.g}

        def w(line):
            area = math.pi * diameter(line) ** 2 / 4
            return {"w": used["g"] * (line.mass_per_length - area * used["rho"])}

        return solve_net(network, line=w, **used)

    return solve


def net_stiffness(change):
    """Return a solver of networks whose stiffness is changed: change(network, answer)."""

    def solve(network):
        answer = solve_net(network)
        return answer | ({"stiffness": change(network, answer)} if network.body else {})

    return solve


def net_tension(change):
    """Return a solver of networks whose tensions are changed."""

    def solve(network):
        answer = solve_net(network)
        return answer | {"tension": change(answer)}

    return solve


def held_joints(network, answer):
    """Return the stiffness of the network whose free nodes are fixed where they balance."""
    places = iter(answer["r"])
    fixed = lambda node: {"r": tuple(next(places)), "kind": "fixed" if node.kind == "free" else node.kind}
    return solve_net(network, node=fixed)["stiffness"]


def without_mean_moments(network, answer):
    """Return the stiffness of the arms' translations alone: of forces whose mean is subtracted."""
    state, reference = answer["state"], np.asarray(network.body.reference)
    arms = state.r[state.coupled] - reference
    shift = np.vstack([np.hstack([np.eye(3), np.cross(np.eye(3), arm).T]) for arm in arms])
    return shift.T @ state.stiffness @ shift


def net_scaled(factor):
    def solve(network):
        answer = solve_net(network)
        K = answer["stiffness"]
        return answer | {"tension": answer["tension"] * factor, "stiffness": None if K is None else K * factor}

    return solve


NETWORKS = {
    "friction_ignored": lambda net: solve_net(net, line=lambda line: {"friction": 0.0}),
    "weight_in_air": lambda net: solve_net(net, line=lambda line: {"w": line.mass_per_length * net.environment.g}),
    "g_9_81": net_weighing(g=9.81),
    "rho_1000": net_weighing(rho=1000.0),
    "nominal_diameter": net_weighing(diameter=nominal),
    "elasticity_ignored": lambda net: solve_net(net, line=lambda line: {"EA": 1e5 * line.EA}),
    "seabed_ignored": lambda net: solve_net(net, depth=None),
    "anchors_on_seabed": lambda net: solve_net(
        net, node=lambda node: {"r": (*node.r[:2], -net.environment.depth)} if _can_drop(node, net) else {}
    ),
    "point_mass_ignored": lambda net: solve_net(net, node=lambda node: {"mass": 0.0}),
    "volume_ignored": lambda net: solve_net(net, node=lambda node: {"volume": 0.0}),
    "mass_for_weight": lambda net: solve_net(
        net, node=lambda node: {"mass": 0.0, "volume": 0.0, "force": _with_mass(node, net)}
    ),
    "node_force_sign": lambda net: solve_net(net, node=lambda node: {"force": tuple(-f for f in node.force)}),
    "joints_not_moved": lambda net: solve_net(net, node=lambda node: {"kind": "fixed"} if node.kind == "free" else {}),
    "kN_for_N": net_scaled(1e-3),
    "ends_swapped": net_tension(lambda answer: answer["tension"][:, ::-1]),
    "anchor_force_for_fairlead": net_tension(lambda answer: answer["tension"][:, [0, 0]]),
    "horizontal_for_tension": net_tension(
        lambda answer: np.column_stack([answer["state"].H_anchor, answer["state"].H])
    ),
    "stiffness_sign": net_stiffness(lambda net, answer: -answer["stiffness"]),
    "stiffness_per_degree": net_stiffness(
        lambda net, answer: answer["stiffness"] * np.radians([57.29577951308232] * 3 + [1.0] * 3)
    ),
    "stiffness_about_origin": net_stiffness(lambda net, answer: answer["state"].body_stiffness((0.0, 0.0, 0.0))),
    "stiffness_of_held_joints": net_stiffness(held_joints),
    "moments_of_translations": net_stiffness(without_mean_moments),
}


def _can_drop(node, net):
    return node.kind == "fixed" and net.environment.depth is not None


def _with_mass(node, net):
    """Return the force on a node with mass and displaced mass, kg, added as if they were N."""
    x, y, z = node.force
    return x, y, z + net.environment.rho * node.volume - node.mass


# ---------------------------------------------------------------- judged
def judge_solver(level, solver, quantities=None):
    """Return the judgements of a solver on all cases of a level, or of some of its quantities alone."""
    judgements = []
    for case in TABLES[level].cases:
        try:
            answer = solver(*as_arguments(case.problem, case.inputs))
        except NoAnswer as error:
            judgements.append(Judgement(case, REFUSED, words=str(error)))
            continue
        given = {name: answer.get(name) for name in quantities or case.truth}
        judgements.append(judge(case, given, TABLES[level].mistakes))
    return judgements


PLANTED = [("statics", name) for name in STATICS] + [("network", name) for name in NETWORKS]
SYNONYMS = {
    "friction_ignored": "without friction",
    "seabed_ignored": "without contact",
    "elasticity_ignored": "without elastic",
    "clearance_ignored": "without clearance",
    "anchors_on_seabed": "without clearance",
    "joints_not_moved": "without joints",
}
"""A mistake that is the absence of a feature has the answer of both."""


def is_named(name, judgements):
    """Whether the first diagnosis is the mistake."""
    diagnoses = name_mistakes(judgements)
    return bool(diagnoses) and diagnoses[0].name in (name, SYNONYMS.get(name))


def is_called(judgements):
    return any(one.verdict in (INACCURATE, WRONG) for one in judgements)


@pytest.mark.parametrize(("level", "solver"), [("statics", solve_line), ("network", solve_net)])
def test_solver_without_mistake_is_right(level, solver):
    """Nothing is called, so that what is called below is the mistake's doing."""
    judgements = judge_solver(level, solver)
    assert all(one.verdict == RIGHT for one in judgements), [one.text() for one in judgements if one.verdict != RIGHT]


@pytest.mark.parametrize(("level", "name"), PLANTED, ids=[f"{level}-{name}" for level, name in PLANTED])
def test_planted_mistake_is_called_and_named(level, name):
    judgements = judge_solver(level, {"statics": STATICS, "network": NETWORKS}[level][name])
    assert is_called(judgements)
    assert is_named(name, judgements), [one.text() for one in name_mistakes(judgements)]


def test_every_mistake_of_the_tables_is_planted():
    """More than thirty, those of networks that concern one line alone among the lines."""
    assert STATICS.keys() == TABLES["statics"].mistakes.keys()
    assert NETWORKS.keys() <= TABLES["network"].mistakes.keys() <= NETWORKS.keys() | STATICS.keys()
    assert len(STATICS.keys() | NETWORKS.keys()) >= 30


OF_OTHER_QUANTITIES = {
    "horizontal_for_tension",
    "s_from_fairlead",
    "flexibility_for_stiffness",
    "stiffness_sign",
    "grounded_length_suspended",
}
"""Mistakes that leave the force at the fairlead as it is: a code that answers nothing else does not make them."""
OFTEN_MADE = ("friction_ignored", "weight_in_air", "kN_for_N", "ends_swapped", "g_9_81", "elasticity_ignored")
"""Of the others only --deep asks, from that force alone."""
SAME_AT_THE_FAIRLEAD = {"anchor_force_for_fairlead": "ends_swapped"}
"""Only the force at the anchor tells these apart: without it the diagnosis names the second, or both."""


@pytest.mark.parametrize("name", [name for name in STATICS if name not in OF_OTHER_QUANTITIES])
def test_planted_mistake_is_named_from_the_fairlead_force_alone(name, deep):
    """As an adapter of 25 lines answers: H and V."""
    if not deep and name not in OFTEN_MADE:
        pytest.skip("with --deep")
    judgements = judge_solver("statics", STATICS[name], ("H", "V"))
    assert is_called(judgements)
    assert is_named(SAME_AT_THE_FAIRLEAD.get(name, name), judgements), [d.text() for d in name_mistakes(judgements)]
    assert any(match.name == name for one in judgements for match in one.matches)
