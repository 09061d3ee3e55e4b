"""The checks of these benchmarks themselves: are fronts, ratios, maxima, periods and counts measured rightly?"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from solvers import InputError, Motion, mooring_system, solve_time_domain
from solvers.common.motions.motion import Ramped
from verification.registry import INSTANTS, instants

from .. import peers
from ..cable import work_precision as cable_work
from ..cable.cases import Reference, rms
from . import cases, seabed, validation
from . import work_precision as work

PERIOD = 20.0


def point(seconds, rms, method=work.TIME, case="case_1"):
    return {"case": case, "method": method, "size": 1, "other": 1, "seconds": seconds, "rms": rms}


# ---------------------------------------------------------------- ratios at equal error
LINE = [point(10.0**k, 1e-1 / 100.0**k) for k in range(3)]  # seconds = sqrt(0.1/rms)


def test_the_front_leaves_out_what_another_point_beats():
    worse = [point(2.0, 0.2), point(50.0, 1e-3), point(3.0, None)]
    assert work.pareto_front([*worse, *LINE]) == LINE


@pytest.mark.parametrize("rms", [1e-1, 3e-2, 1e-3, 2e-5, 1e-5])
def test_the_time_at_an_error_follows_the_power_law_of_the_front(rms):
    assert work.seconds_at(LINE, rms) == pytest.approx(math.sqrt(0.1 / rms), rel=1e-12)


def test_no_time_is_made_up_beyond_the_front():
    """Below the least error there is none; above the greatest, the least time of all."""
    assert work.seconds_at(LINE, 0.9e-5) is None and work.seconds_at([], 1e-3) is None
    assert work.seconds_at(LINE, 0.5) == pytest.approx(1.0, rel=1e-12)


def test_ratios_are_of_the_wanted_errors_on_the_front_of_the_other_code():
    """Its point off its own front, those of other errors and of a case that is not ours have none."""
    other = [point(30.0, 1e-3, "other"), point(31.0, 2e-3, "other"), point(7.0, 1e-2, "other"),
             point(1.0, 0.3, "other"), point(900.0, 5e-4, "other"), point(1.0, 5e-3, "other", "case_2")]  # fmt: skip
    rows = work.ratios([*LINE, *other], "other")
    assert [row["rms"] for row in rows] == [1e-2, 1e-3]
    assert [row["ratio"] for row in rows] == pytest.approx([7 / math.sqrt(10), 3.0], rel=1e-12)


def test_every_setting_has_an_own_name_and_is_called():
    """A quick case: each method gives a tension of the last period, its errors fall along its settings."""
    plan = {key: run for key, run in work.calls("case_1", quick=True).items() if key[0] in work.OWN}
    waves = {key: run().wave for key, run in plan.items()}
    assert {key[0] for key in plan} == set(work.OWN)
    finest = waves[work.TIME, *work.QUICK[work.TIME][-1]]
    known = Reference(PERIOD, finest, 0.0)
    assert all(known.errors(wave)["rms"] < 0.01 for wave in waves.values())
    errors = [known.errors(waves[work.TIME, *setting])["rms"] for setting in work.QUICK[work.TIME][:-1]]
    assert errors == sorted(errors, reverse=True)


def test_extrapolation_takes_the_second_order_out():
    """With c h^2 added to a tension on cells of h and 2 h, the extrapolated one is exact; on both it is not."""
    cells, steps = work.QUICK[work.EXTRAPOLATED][0]
    fine = work.call("case_1", work.TIME, cells, steps)().wave
    coarse_line = cases.every_second_node(cases.line("case_1", cells))
    assert coarse_line.nodes == cells // 2 + 1 and np.array_equal(coarse_line.s, cases.line("case_1", cells).s[::2])
    extrapolated = work.call("case_1", work.EXTRAPOLATED, cells, steps)().wave
    known = Reference(PERIOD, work.call("case_1", work.TIME, 112, 400)().wave, 0.0)
    assert known.errors(extrapolated)["rms"] < 0.5 * known.errors(fine)["rms"]


# ---------------------------------------------------------------- maxima, periods, exponents
def test_the_mean_maximum_is_of_the_last_cycles():
    steps = 40
    t = np.arange(5 * steps + 1) / steps
    tension = np.where(t > 3, 1.0, 9.0) * np.sin(2 * np.pi * t) * (1 + (t > 4))
    assert validation.mean_maximum(tension, steps, 2) == pytest.approx(1.5, rel=1e-12)


@pytest.mark.parametrize(("turn", "away"), [(1, 1.0), (-1, -1.0)])
def test_the_circle_turns_as_it_says(turn, away):
    """From the highest point, away from the anchor or towards it."""
    motion = validation.circle(0.2, 2.0, turn)
    assert motion.displacement(0.0) == pytest.approx([0.0, 0.0, 0.2], abs=1e-15)
    assert motion.velocity(0.0) == pytest.approx([away * 0.2 * math.pi, 0.0, 0.0], abs=1e-15)
    assert np.linalg.norm(motion.displacement(instants(2.0, 7)), axis=0) == pytest.approx(0.2, rel=1e-12)


def test_amplitude_and_lag_of_a_sine_are_recovered():
    t = np.arange(0, 20, 0.1)
    z = 3.0 * np.sin(2 * np.pi * (t - 0.03) / validation.ORCAFLEX_PERIOD)
    rows = [{"time": a, "z": b} for a, b in zip(t, z, strict=True)]
    assert validation.sine_of(rows) == pytest.approx((3.0, 0.03), rel=1e-9)


SINE = np.sin(2 * np.pi * np.arange(INSTANTS) / INSTANTS)


@pytest.mark.parametrize(("errors", "count"), [((1, 0.1, 1e-4, 1e-5), 3), ((1e-4, 1, 1e-4), 3), ((1e-4,) * 2, 1),
                                               ((1, 1e-4, 0.1), None), ((np.nan, 1e-4), 2)])  # fmt: skip
def test_periods_to_an_error_are_counted_from_the_last_that_exceeds_it(errors, count):
    waves = [SINE + 2 * error for error in errors]  # of a range of 2
    assert cases.least_period_count(waves, 1e-3, Reference(PERIOD, SINE, 0.0)) == count


# ---------------------------------------------------------------- seabeds
def seabed_row(error, subjects=(), change=0.0, status="SUCCESS", balance="SUCCESS"):
    return {"status": status, "error": error, "subjects": list(subjects), "change": change,
            "balance": {"status": balance, "difference": 0.01 if balance == "SUCCESS" else None}}  # fmt: skip


def test_motions_are_counted_by_error_and_warning():
    rows = [seabed_row(0.1, ["mesh"]), seabed_row(0.2, ["slack"], change=0.5), seabed_row(0.001, ["dt", "slack"]),
            seabed_row(0.003, balance="SLACK"), seabed_row(0.002, ["periods"]), seabed_row(None),
            {"status": "STEP_FAILED"}]  # fmt: skip
    summary = seabed.summarise(rows)
    assert {key: summary[key] for key in ("motions", "solved", "periodic", "large", "large_and_warned", "warned",
                                          "warned_and_small", "balanced")} == {
        "motions": 7, "solved": 5, "periodic": 4, "large": 2, "large_and_warned": 1, "warned": 3,
        "warned_and_small": 2, "balanced": 4}  # fmt: skip
    assert (summary["median"], summary["greatest"]) == (0.003, 0.2)


def test_every_line_over_a_seabed_can_move():
    """Ten lines, their fairleads above the seabed and within reach of the line, on seabeds of 1e3 to 1e7 N/m^2."""
    stiffness = []
    for name, motions in seabed.LINES.items():
        case = validation.scene(name)
        stiffness.append(case.environment.seabed_stiffness)
        for amplitude, period in motions:
            for kind in seabed.KINDS:
                motion = cases.motion(kind, amplitude, period)
                places = np.array(case.fairlead)[:, None] + motion.displacement(instants(period, 32))
                assert places[2].min() > -case.environment.depth
                reach = np.linalg.norm(places - np.array(case.anchor)[:, None], axis=0).max()
                assert reach < case.length * (1 + 1e-3), (name, kind)
    assert len(seabed.LINES) == 10 and (min(stiffness), max(stiffness)) == (1e3, 1e7)


def test_a_motion_is_measured_as_solved_elsewhere():
    """Error, change and warnings of one motion are those of histories made here; a warning has its subject."""
    row = seabed.measure_motion("oc3", "surge", 5.0, 20.0)
    assert row["status"] == row["fine_status"] == row["balance"]["status"] == "SUCCESS"
    assert 0 < row["error"] < 0.01 and row["change"] < 1e-4 and row["balance"]["difference"] < 0.01
    assert row["least"] < row["pretension"] < row["greatest"]
    assert row["subjects"] == sorted({text.partition(":")[0] for text in row["warnings"]})


# ---------------------------------------------------------------- references
def test_a_reference_is_refined_in_mesh_and_step_alone():
    """Both end at the reference's own cells and steps; a uniform error of the mesh would show in no step."""
    levels = ((20, 100), (40, 200))
    kept = cases.finest("oc3_seabed", levels).refinements
    assert (kept["mesh"]["sizes"], kept["steps"]["sizes"]) == ((10, 20, 40), (50, 100, 200))
    waves = {size: cases.run_in_time("oc3_seabed", *size) for size in ((20, 200), (40, 100), (40, 200))}
    fine = waves[40, 200]
    for what, size in (("mesh", (20, 200)), ("steps", (40, 100))):
        assert kept[what]["change"] == pytest.approx(rms(fine - waves[size]) / np.ptp(fine), rel=1e-9), what
    assert cases.finest("oc3_seabed", levels[1:]).refinements == {}


def test_a_reference_is_kept_and_made_anew_for_another_line(tmp_path, monkeypatch):
    made = []

    def finest(name, levels):
        made.append((name, levels))
        return Reference(PERIOD, SINE, 1e-5, (1, 2))

    monkeypatch.setattr(cases, "finest", finest)
    for _ in range(2):
        kept = cases.ConvergedTensions(tmp_path, quick=True).get_or_compute("oc3_seabed")
        assert np.array_equal(kept.tension, SINE) and kept.uncertainty == 1e-5
    assert made == [("oc3_seabed", cases.QUICK_REFERENCE)]
    cases.ConvergedTensions(tmp_path, quick=False).get_or_compute("oc3_seabed")
    assert made[1:] == [("oc3_seabed", cases.REFERENCE)]


def test_lines_over_a_seabed_are_measured_without_internal_damping():
    for name in cases.SEABED:
        assert cases.scene(name).cable.damping == 0 and cases.scene(name).motion is not None
    with pytest.raises(InputError, match="seabed_stiffness"):
        case = cases.scene("oc3_seabed")
        mooring_system(replace(case, environment=replace(case.environment, seabed_stiffness=None)), 10)


# ---------------------------------------------------------------- MoorDyn over a seabed
moordyn_installed = pytest.mark.skipif("moordyn" not in peers.adapters(), reason="the optional peer is not installed")


@moordyn_installed
def test_moordyn_has_the_seabed_of_the_scene():
    """At rest, without motion, it and this core agree to the error of their meshes; into a soft seabed both sink."""
    case = validation.scene("soft_clay")
    case = replace(case, cable=replace(case.cable, damping=0.0))
    still = Motion.harmonic(1 / PERIOD, (0.0, 0.0, 1e-9))
    tensions = []
    for stiffness in (1e5, 1e3):
        one = replace(case, environment=replace(case.environment, seabed_stiffness=stiffness), motion=still)
        answer = cable_work.ask(peers.adapters()["moordyn"], one, still, PERIOD, (60, 400), 3)
        pretension = mooring_system(one, 60).rest.fairlead_tension
        assert answer.tension[-1] == pytest.approx(pretension, rel=2e-2), stiffness
        tensions.append((answer.tension[-1], pretension))
    change = np.diff(tensions, axis=0)[0] / tensions[0]
    assert change[0] == pytest.approx(change[1], abs=0.01) and change[1] > 0.1


@moordyn_installed
def test_moordyn_refuses_friction_and_a_rigid_seabed():
    case = cases.scene("oc3_seabed")
    rigid = replace(case, environment=replace(case.environment, seabed_stiffness=None))
    for one in (replace(case, friction=(0.5,)), rigid):
        answer = cable_work.ask(peers.adapters()["moordyn"], one, one.motion, PERIOD, (10, 100), 1)
        assert answer.kind == "unsupported"


# ---------------------------------------------------------------- MoorDyn in surge
MOORDYN_LIMIT = 1e-3  # rms over the range; measured 4.6e-4 here, 3.0e-4 on twice the cells
# It is what MoorDyn has and this core has not: a tenth of the critical damping in each segment, which falls with the
# segment and not with its square, and drag on the unstretched length, e/2 = 0.1 % less.


@moordyn_installed
def test_moordyn_has_the_limit_of_this_core():
    """Both lump masses alike: tensions on the same cells extrapolate to one, and differ by less on finer cells."""
    case, period = cases.scene("case_1"), PERIOD
    lines, others = [], []
    for cells, steps in ((20, 500), (40, 1000)):
        motion = Ramped(case.motion, period / 2)
        answer = cable_work.ask(peers.adapters()["moordyn"], case, motion, period, (cells, steps), 3)
        made = mooring_system(case, cells, mesh="uniform", calibrate=False)
        history = solve_time_domain(made, dt=period / steps, periods=3, tolerance=1e-6)
        lines.append(history.fairlead_tension(2 * period + period * np.arange(500) / 500))
        others.append(answer.tension[:: steps // 500])
    apart = lambda a, b: np.sqrt(np.mean((a - b) ** 2)) / np.ptp(a)
    limit, other = (fine + (fine - rough) / 3 for rough, fine in (lines, others))
    assert apart(limit, other) <= MOORDYN_LIMIT < apart(limit, lines[0])
    assert apart(lines[1], others[1]) < 0.6 * apart(lines[0], others[0])
