"""Is the motion level of the conformance cases what it says: bounds, features that are isolated, mistakes told apart?

The planted mistakes are made in an adapter around this project's solvers: in what the adapter is given, in the arrays
of the equations, or in what it gives out. The motion reaches it as a series of places, as it reaches any code.
"""

from __future__ import annotations

import copy
import math
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from benchmarks.conformance.this_project import LONGER, ThisProject, network_of
from solvers import Motion, mooring_system, solve_time_domain
from verification.conformance.adapter import CableAnswer, MovingNetworkAnswer
from verification.conformance.answers import ask
from verification.conformance.judge import RIGHT, judge, measure_error
from verification.conformance.tables import load_table

LEAST_CASES = 25
ISOLATED = 20.0  # right bounds that leaving a feature out moves the answer by
LARGEST_UNCERTAINTY = 0.005  # of the range: the bound of a right answer for a truth without error
SAME = 2.0  # right bounds: answers of two mistakes nearer to each other than that are not told apart
FEATURES = {
    "added_mass", "normal_drag", "tangential_drag", "current", "damping", "seabed_stiffness", "seabed_damping",
    "seabed_friction", "slack", "snap", "out_of_plane", "joints", "body_rotation", "buoyant",
}  # fmt: skip
INDISTINGUISHABLE: dict = {}
"""Pairs of mistakes that no case tells apart, and why."""

TABLE = load_table("motion")
CASES = {case.id: case for case in TABLE.cases}


# ---------------------------------------------------------------- the table
def test_ids_are_unique_and_cases_are_many():
    """At least 25 cases, each with the quantities and the clock that the judge wants."""
    assert len(TABLE.cases) >= LEAST_CASES == 25
    assert TABLE.level == "motion" and set(FEATURES) == {feature for case in TABLE.cases for feature in case.features}
    for case in TABLE.cases:
        assert set(case.truth) <= set(TABLE.units), case.id
        assert set(case.mistakes) <= set(TABLE.mistakes), case.id
        clock = case.inputs["time"]
        assert 5 <= clock["period"] <= 20 and clock["discard"] == clock["periods"] - 1, case.id


@pytest.mark.parametrize("name", CASES)
def test_uncertainty_is_below_the_bound(name):
    """Of each quantity of the truth: u below half of a per cent of the range, the bound at least 2 u above it."""
    case = CASES[name]
    assert set(case.uncertainty) == set(case.truth)
    for quantity, u in case.uncertainty.items():
        right, wrong = case.bound[quantity]
        assert 0 <= u <= LARGEST_UNCERTAINTY, quantity
        assert 2 * u < right < wrong, quantity


@pytest.mark.parametrize(("name", "feature"), [(case.id, feature) for case in TABLE.cases for feature in case.features])
def test_a_feature_left_out_moves_the_answer(name, feature):
    """By at least 20 times the bound of a right answer, in some quantity."""
    case = CASES[name]
    moved = {
        quantity: measure_error(case, quantity, np.array(value)) / case.bound[quantity][0]
        for quantity, value in case.without[feature].items()
    }
    assert max(moved.values()) >= ISOLATED, moved


def test_mistakes_are_told_from_each_other():
    """By at least one case, more than twice the bound apart; those that are not are listed with the reason."""
    names, apart = list(TABLE.mistakes), set()
    for case in TABLE.cases:
        for i, first in enumerate(names):
            for second in names[:i]:
                pair = frozenset({first, second})
                if pair not in apart and _tells_apart(case, first, second):
                    apart.add(pair)
    alike = {frozenset({a, b}) for i, a in enumerate(names) for b in names[:i]} - apart
    assert alike == set(INDISTINGUISHABLE), alike


def _tells_apart(case, first, second) -> bool:
    """Whether one is in the case and the other has another answer there, of the truth where it is not."""
    one, other = case.mistakes.get(first), case.mistakes.get(second)
    if one is None and other is None:
        return False
    one, other = one or {}, other or {}
    return any(
        measure_error(case, key, np.array(one.get(key, case.truth[key])), other.get(key, case.truth[key]))
        > SAME * case.bound[key][0]
        for key in {*one, *other}
    )


def test_a_truth_is_right_and_the_answer_of_a_mistake_is_named():
    """The judge on the table itself: the truth is right everywhere, each mistake is named where it stands."""
    for case in TABLE.cases:
        assert judge(case, case.truth).verdict == RIGHT, case.id
        for name, answer in case.mistakes.items():
            judgement = judge(case, answer, TABLE.mistakes)
            assert judgement.verdict != RIGHT, (case.id, name)
            assert name in {match.name for match in judgement.matches}, (case.id, name)


# ---------------------------------------------------------------- an adapter with mistakes
class Ours(ThisProject):
    """This project's nodes and elements behind the contract, with places where a mistake is planted."""

    refinement = 1

    def cable(self, scene, time, fairlead, cells):
        """Return the tensions of both ends and the envelope."""
        self.prepare(scene)
        return self.give(super().cable(scene, time, fairlead, cells))

    def moving_network(self, network, motion, time, cells):
        """Return the forces on the coupled nodes and the tensions of the ends of elements."""
        self.prepare(network)
        return self.give(super().moving_network(network, motion, time, cells))

    def prepare(self, given):
        """Change what is given."""

    def give(self, answer):
        """Return what is given out."""
        return answer


def sections(given) -> list:
    """Return the sections of a line or a network."""
    return [e.cable for e in given.elements] if hasattr(given, "elements") else [given.cable]


class Planted(Ours):
    """The same with one mistake: given, equations or answer are changed by the functions of PLANTED."""

    def __init__(self, given=None, line=None, answer=None, body=None):
        self.of_given, self.of_line, self.of_answer, self.of_body = given, line, answer, body

    def prepare(self, given):
        """Change the given."""
        if self.of_given:
            self.of_given(given)

    def system(self, *arguments, **options):
        """Change the arrays of the equations."""
        system = super().system(*arguments, **options)
        if self.of_line:
            system.line = self.of_line(system.line)
        return system

    def body_motion(self, motion):
        """Change the motion of the body."""
        return super().body_motion(self.of_body(copy.deepcopy(motion)) if self.of_body else motion)

    def give(self, answer):
        """Change the answer."""
        return self.of_answer(answer) if self.of_answer else answer


# ---------------------------------------------------------------- the mistakes, by another road than the table's
def scale_section(**factors):
    """Return a change of what is given: entries of each section times factors."""

    def change(given):
        for cable in sections(given):
            for key, factor in factors.items():
                setattr(cable, key, factor * getattr(cable, key))

    return {"given": change}


def set_environment(**values):
    """Return a change of what is given: entries of the environment, each a function of the old one."""

    def change(given):
        for key, value in values.items():
            setattr(given.environment, key, value(getattr(given.environment, key)))

    return {"given": change}


def set_weight(weight):
    """Return a change of what is given: the submerged weight as a function of section and environment."""

    def change(given):
        for part in [given.cable] if hasattr(given, "cable") else given.elements:
            cable = getattr(part, "cable", part)
            cable.submerged_weight = part.w = weight(cable, given.environment)

    return {"given": change}


def scale_line(**factors):
    """Return a change of the equations: arrays of ``equations.Line`` times factors."""
    return {"line": lambda line: line._replace(**{key: factor * getattr(line, key) for key, factor in factors.items()})}


def set_free_nodes(**values):
    """Return a change of what is given: entries of the free nodes."""

    def change(given):
        for node in given.nodes:
            if node.kind == "free":
                vars(node).update(values)

    return {"given": change}


def replace_answer(change):
    """Return a change of what is given out, of each array of an answer."""

    def given_out(answer):
        return type(answer)(
            **{key: change(np.asarray(value)) for key, value in vars(answer).items() if value is not None}
        )

    return {"answer": given_out}


def swap_ends(answer):
    """Return the answer with the ends exchanged."""
    if isinstance(answer, MovingNetworkAnswer):
        return MovingNetworkAnswer(answer.force, answer.tension[:, ::-1])
    envelope = None if answer.envelope is None else answer.envelope[:, ::-1]
    return CableAnswer(answer.anchor_tension, answer.tension, envelope)


def stop_rotation(motion):
    """Return the motion of the body with angles of zero."""
    for part in ("sin", "cos"):
        motion.rule[part] = [[*row[:3], 0.0, 0.0, 0.0] for row in motion.rule[part]]
    return motion


def in_air(cable, water) -> float:
    """Return the weight in air, N/m."""
    return cable.mass_per_length * water.g


def with_fresh_water(given):
    """Change density and, with it, the weight."""
    given.environment.rho = 1000.0
    set_weight(lambda cable, water: water.g * (cable.mass_per_length - water.rho * math.pi * cable.diameter**2 / 4))[
        "given"
    ](given)


class LastSegment(Ours):
    """The tension of the last segment for that of the end; equal segments."""

    def system(self, *arguments, **options):
        """On equal cells."""
        return super().system(*arguments, **options, mesh="uniform", calibrate=False)

    def end_tension(self, history, end):
        """Return the tension of the last cell."""
        return history.tension[end]


class Horizontal(Ours):
    """The level component of the force for its size."""

    def end_tension(self, history, end):
        """Return the level component."""
        return np.linalg.norm(history.forces[:2, end], axis=0)


class Planar(Ours):
    """Motion and current in the plane of x and z alone."""

    def cable(self, scene, time, fairlead, cells):
        """Drop y."""
        scene.environment.current = (scene.environment.current[0], 0.0, scene.environment.current[2])
        return super().cable(scene, time, fairlead * np.array([1.0, 0.0, 1.0]), cells)


class FirstPeriod(Ours):
    """The first period for the last."""

    def cable(self, scene, time, fairlead, cells):
        """Repeat the first period."""
        answer, steps = (
            super().cable(scene, time, fairlead, cells),
            round((scene.window[1] - scene.window[0]) / time[1]),
        )
        return CableAnswer(*(np.resize(T[:steps], len(time)) for T in (answer.tension, answer.anchor_tension)))


class SmallAngles(Ours):
    """The rotation of the body linearised: each coupled node moves by its own translation."""

    def moving_network(self, network, motion, time, cells):
        """Return the forces of three networks of one line each."""
        forces, tensions, nodes = [], [], network.nodes
        for element in network.elements:
            arm = np.array(nodes[element.ends[1]].r) - motion.reference
            rows = {part: [list(np.array(row[:3]) + np.cross(row[3:], arm)) for row in motion.rule[part]]
                    for part in ("sin", "cos")}  # fmt: skip
            ends = [nodes[end] for end in element.ends]
            alone = SimpleNamespace(nodes=ends, elements=[element], environment=network.environment,
                                    slip_speed=network.slip_speed)  # fmt: skip
            element.ends = (0, 1)
            moved = Motion(motion.rule["frequency"], rows["sin"], rows["cos"])
            system = mooring_system(network_of(alone), cells, motion=moved, calibrate=False, fields="spatial")
            history = solve_time_domain(system, dt=LONGER * time[1], duration=time[-1], ramp=motion.rule["ramp"])
            forces.append(history.forces[:, -1])
            tensions.append([np.linalg.norm(history.forces[:, end], axis=0) for end in (0, -1)])
        return MovingNetworkAnswer(
            *(CubicSpline(history.time, np.array(part), axis=-1)(time) for part in (forces, tensions))
        )


def in_all_directions(line):
    """Return the arrays with added mass that does not know its direction."""
    return line._replace(mass=line.mass + line.added_mass, added_mass=0.0 * line.added_mass)


def level_friction(given):
    """Take the friction away."""
    given.friction = (0.0,)


def without_seabed(given):
    """Take the seabed away."""
    vars(given.environment).update(depth=None, seabed_stiffness=None, seabed_damping=0.0)


PI = math.pi
PLANTED = {  # name -> (case, adapter)
    "added_mass_missing": ("added-mass-circle", Planted(**scale_line(added_mass=0.0))),
    "added_mass_tangential": ("added-mass-heave", Planted(line=in_all_directions)),
    "drag_without_half": ("normal-drag-surge", Planted(**scale_line(normal_drag=2.0, tangential_drag=2.0))),
    "drag_missing": ("seabed-soft-circle", Planted(**scale_line(normal_drag=0.0, tangential_drag=0.0))),
    "tangential_drag_ignored": ("tangential-drag-heave", Planted(**scale_line(tangential_drag=0.0))),
    "drag_on_wrong_area": ("tangential-drag-loop", Planted(**scale_line(tangential_drag=1 / PI))),
    "normal_drag_on_circumference": ("normal-drag-heave", Planted(**scale_line(normal_drag=PI))),
    "current_ignored": ("current-along", Planted(**set_environment(current=lambda u: (0.0, 0.0, 0.0)))),
    "drag_relative_velocity_wrong_sign": (
        "current-against",
        Planted(line=lambda line: line._replace(current=tuple(-c for c in line.current))),
    ),
    "damping_ignored": ("damping-taut", Planted(**scale_line(damping=0.0))),
    "nominal_diameter": ("added-mass-circle", Planted(**scale_section(diameter=1 / 1.8))),
    "radius_for_diameter": ("normal-drag-heave", Planted(**scale_section(diameter=2.0))),
    "rho_1000": ("added-mass-heave", Planted(given=with_fresh_water)),
    "weight_in_air": ("normal-drag-surge", Planted(**set_weight(in_air))),
    "mass_submerged": (
        "damping-taut",
        Planted(given=lambda scene: setattr(scene.cable, "mass_per_length", scene.cable.submerged_weight / 9.80665)),
    ),
    "elasticity_ignored": ("damping-two-harmonics", Planted(**scale_section(EA=50.0))),
    "seabed_ignored": ("normal-drag-seabed", Planted(given=without_seabed)),
    "seabed_per_area": (
        "seabed-soft-surge",
        Planted(given=lambda scene: setattr(scene.environment, "seabed_stiffness", 0.05 * 100.0)),
    ),
    "seabed_damping_ignored": ("seabed-damping-heave", Planted(**scale_line(seabed_damping=0.0))),
    "friction_ignored": ("friction-soft-line", Planted(given=level_friction)),
    "out_of_plane_dropped": ("sway-taut", Planar()),
    "body_rotation_ignored": ("yaw", Planted(body=stop_rotation)),
    "small_angles": ("yaw", SmallAngles()),
    "point_mass_ignored": ("clump", Planted(**set_free_nodes(mass=0.0))),
    "volume_ignored": ("buoy", Planted(**set_free_nodes(volume=0.0))),
    "point_drag_ignored": ("clump", Planted(**set_free_nodes(CdA=0.0))),
    "ramp_left_in": ("normal-drag-surge", FirstPeriod()),
    "kN_for_N": ("damping-taut", Planted(**replace_answer(lambda force: force / 1000))),
    "kgf_for_N": ("damping-taut", Planted(**replace_answer(lambda force: force / 9.80665))),
    "ends_swapped": ("normal-drag-surge", Planted(answer=swap_ends)),
    "anchor_force_for_fairlead": (
        "normal-drag-surge",
        Planted(answer=lambda given: CableAnswer(given.anchor_tension, given.anchor_tension)),
    ),
    "dynamic_part_alone": (
        "normal-drag-surge",
        Planted(answer=lambda given: CableAnswer(given.tension - given.tension[-2000:].mean())),
    ),
    "force_sign": ("bridle", Planted(answer=lambda given: MovingNetworkAnswer(-given.force))),
    "vertical_sign": (
        "bridle",
        Planted(answer=lambda given: MovingNetworkAnswer(given.force * np.array([1.0, 1.0, -1.0])[:, None])),
    ),
    "tension_of_last_segment": ("normal-drag-heave", LastSegment()),
    "horizontal_for_tension": ("added-mass-heave", Horizontal()),
}


@cache
def verdict_of(case_id, name):
    """Return the judgement of a planted mistake, or of the adapter without one (name "")."""
    adapter = PLANTED[name][1] if name else Ours()
    case = CASES[case_id]
    return judge(case, ask(adapter, case.problem, copy.deepcopy(case.inputs)), TABLE.mistakes)


@pytest.mark.parametrize("name", PLANTED)
def test_a_planted_mistake_is_named(name):
    """It is called wrong or inaccurate, and the mistake is among the matches that are told."""
    case_id, _ = PLANTED[name]
    judgement = verdict_of(f"motion/{case_id}", name)
    assert judgement.verdict not in (RIGHT, "refused"), judgement.text()
    assert name in {match.name for match in judgement.matches}, judgement.text()


@pytest.mark.parametrize("case_id", sorted({case for case, _ in PLANTED.values()}))
def test_without_a_mistake_the_same_adapter_is_right(case_id):
    """On each case that a mistake is planted in: the mistake, and nothing else, is what was named."""
    judgement = verdict_of(f"motion/{case_id}", "")
    assert judgement.verdict == RIGHT, judgement.text()


def test_all_mistakes_of_the_table_are_planted():
    """But for compression, and rest at each instant, which an adapter around these solvers cannot make."""
    assert set(TABLE.mistakes) - set(PLANTED) <= {"compression_allowed", "quasi_static"}
