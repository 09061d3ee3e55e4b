"""Tables of load cases: theory of a linear line, agreement with time stepping, executors, bad rows, resumed tables."""

from __future__ import annotations

import json
import math
import os
import signal
import subprocess
import sys
import time
from concurrent.futures import BrokenExecutor, Executor, ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from importlib.machinery import SourceFileLoader

import numpy as np
import pytest

from solvers import (
    BodyMotion,
    CableProperties,
    Element,
    Environment,
    InputError,
    Motion,
    Network,
    Node,
    Scene,
    mooring_system,
    solve_span,
    solve_time_domain,
)
from solvers.common.load_case import LoadCase
from solvers.common.motions.sea_state import SeaState
from solvers.common.motions.spectrum import Spectrum
from solvers.io.case_file import read_records
from solvers.load_cases import Accuracy, CaseResult, integration, solve_load_cases
from solvers.load_cases.envelope import find_envelopes
from solvers.load_cases.fingerprint import _sources, fingerprint
from solvers.load_cases.integration import CHUNK, integrate_case
from solvers.load_cases.solve import MOST_RESTARTS
from verification import ROOT

from ..exact.gaussian import narrow_band_load, rayleigh_extreme
from .systems import CATENARY, CHAIN, OVER_SEABED, SURGE, TAUT, TWO_LINES, sea_case

LINEAR = 0.02  # relative: inertia and drag of a light rope that is moved slowly, and its second order in the motion
ERRORS = 3.5  # standard errors of an average: once in two thousand
ROUNDING = 1e-9  # relative: chunks of steps begin with a new factorisation, and Newton stops at 1e-4 of a change
SAME = 1e-9  # relative, of the same numbers by another sum
NEWTON = 1e-3  # of a change of tension: two iterations that each stop at 1e-4 of it, over many steps
NEWTON_SHARE = 0.1  # of the error of a step: a tolerance of 1 leaves 0.12 to 0.22
JOINT = 0.02  # of the tension at a joint, between the ends of two sections: weight and inertia of the node
SETTING = {"dt": 0.2, "cells": 8}
SEAS = [sea_case(f"sea {seed}", 0.5 + 0.2 * seed, seed) for seed in range(6)]


def test_a_linear_line_has_rayleigh_maxima_and_the_damage_of_a_narrow_band(record_property):
    """A taut rope in slow, small, narrow-banded surge: tension by its stiffness, extremes and damage in closed form."""
    deviation, duration, exponent = 0.02, 36000.0, 3.0
    band = Spectrum([0.0779, 0.078, 0.082, 0.0821], [0.0, 1.0, 1.0, 0.0])
    sea = Spectrum(band.frequency, band.density * deviation**2 / band.moment(0))
    cases = [LoadCase(f"{seed}", SeaState(sea, SURGE, seed, duration + 100.0), duration, 100.0) for seed in range(6)]
    table = solve_load_cases(TAUT, cases, dt=0.5, cells=4, wohler=exponent, reference_time=duration)
    state = solve_span(TAUT.spans()[0])
    pull = np.array([state.H, state.V]) / math.hypot(state.H, state.V) @ state.stiffness[:, 0]
    seen = table.values("standard_deviation")[:, 0]
    scatter = [case.motion.motion().translation.standard_deviation[0] / deviation for case in cases]
    assert seen / scatter == pytest.approx(pull * deviation, rel=LINEAR)
    peaks = 0.08 * duration
    wanted = {
        "extreme": rayleigh_extreme(peaks),
        "damage_equivalent_load": narrow_band_load(0.08, exponent),
    }
    for name, theory in wanted.items():
        value = table.values(name)[:, 0] - (table.values("mean")[:, 0] if name == "extreme" else 0.0)
        value = value / seen
        error, sampling = value.mean() - theory, value.std() / math.sqrt(len(cases))
        record_property(name, f"{value.mean():.5g} for {theory:.5g}, sampling error {sampling:.2g}")
        assert abs(error) <= ERRORS * sampling + LINEAR * theory, name


@pytest.mark.parametrize("system", [CATENARY, TWO_LINES], ids=["line", "network"])
def test_a_row_is_what_time_stepping_gives(system, monkeypatch):
    """Statistics of a regular motion are those of the history on the same mesh, though no history is kept."""
    for name in ("LINE_TOLERANCE", "CONTACT_TOLERANCE"):
        monkeypatch.setattr(integration, name, 1e-4)  # as that of the history
    motion = BodyMotion.harmonic(0.1, (1.5, 0, 0.5, 0, 0.02, 0))
    case = LoadCase("regular", motion, duration=300.0, ramp=20.0)
    series = integrate_case(system, case, dt=0.1, cells=12)
    moved = mooring_system(system, 12, mesh="touchdown", motion=motion)
    history = solve_time_domain(moved, dt=0.1, duration=320.0, ramp=20.0)
    assert history.time.size > 2 * CHUNK
    for line, kept in zip(history.lines, series.lines, strict=True):
        tension = np.linalg.norm(line.fairlead_force, axis=0)[201:]
        anchor = np.linalg.norm(line.anchor_force, axis=0)[201:]
        assert kept.fairlead.size == 3000
        assert kept.fairlead == pytest.approx(tension, rel=0, abs=NEWTON * np.ptp(tension))
        assert kept.anchor == pytest.approx(anchor, rel=0, abs=NEWTON * np.ptp(anchor))
    e = moved.layout
    for i, kept in enumerate(series.lines):
        z = history.r[2, e.nodes[i]][:, 201:]
        lying = np.diff(e.s[i]) @ ((z[1:] < -50.0) & (z[:-1] < -50.0))
        least, most = np.diff(e.s[i]).min(), np.diff(e.s[i]).max()
        assert (kept.grounded >= lying - ROUNDING).all() and (kept.grounded <= lying + 2 * most).all() and least > 0
        assert 20 < kept.grounded.min() < kept.grounded.max() < 200


def test_a_cell_that_crosses_the_seabed_counts_in_proportion():
    """Its part below the surface lies, one that ends at the surface as a whole; a cell shorter than itself is slack."""
    line = mooring_system(CATENARY, 4, mesh="uniform").line
    assert line.floor == -50.0 and (line.length == 55.0).all()
    heights = np.array([[-0.5, -0.5, 0.0, 0.5, 1.0], [-0.5, 0.25, 0.5, 1.0, 2.0]])
    r = np.stack([np.broadcast_to(60.0 * np.arange(5.0), (2, 5)), heights - 50.0], axis=-1)
    r[1, :, 0] *= 0.9  # cells of 54 m
    grounded, slack = np.empty(2), np.empty(2, dtype=bool)
    integration.observe(line, np.arange(4), r, np.zeros_like(r), grounded, slack)
    assert grounded == pytest.approx([110.0, 55.0 * 0.5 / 0.75], rel=SAME) and slack.tolist() == [False, True]


@pytest.mark.parametrize("system", [CATENARY, TWO_LINES, TAUT], ids=["line", "network", "taut"])
def test_one_iteration_of_a_step_is_enough(system, monkeypatch):
    """What Newton's method leaves at the tolerance of load cases is small beside the error of the step itself."""
    case = sea_case("sea", 2.0, 3, duration=200.0)
    loose, half = (integrate_case(system, case, dt=dt, cells=12) for dt in (0.2, 0.1))
    for name in ("LINE_TOLERANCE", "CONTACT_TOLERANCE"):
        monkeypatch.setattr(integration, name, 1e-8)
    tight = integrate_case(system, case, dt=0.2, cells=12)
    assert loose.iterations < tight.iterations
    for a, b, c in zip(loose.lines, tight.lines, half.lines, strict=True):
        of_newton = abs(a.fairlead.std() - b.fairlead.std())
        assert of_newton <= NEWTON_SHARE * abs(b.fairlead.std() - c.fairlead.std())


ROUGH_ERROR = 0.05  # of the deviation, by which steps of 0.09 s err; with the oscillation 0.07 and more
FEW = 6  # iterations a step; with the oscillation 40


def test_a_rough_seabed_sustains_no_oscillation():
    """Chain on a seabed of friction 1, in a sea across it: the deviation of small steps, at a few iterations each."""
    chain = CableProperties(EA=753.6e6, diameter=0.0766, mass_per_length=113.35, Cdn=1.1)
    water = Environment(depth=200.0, seabed_stiffness=2.3e5)
    ends = [(r * 0.5, r * 3**0.5 / 2, z) for r, z in ((837.6, -200.0), (40.868, -14.0))]
    scene = Scene("chain of a semisubmersible", chain, 835.5, *ends, water, friction=(1.0,))
    case = sea_case("sea", 1.0, 1, duration=200.0)
    one, fine = (integrate_case(scene, case, dt=dt, cells=20) for dt in (0.09, 0.02))
    deviation = fine.lines[0].fairlead.std()
    assert abs(one.lines[0].fairlead.std() - deviation) <= ROUGH_ERROR * deviation
    assert one.iterations <= FEW * case.whole_duration / 0.09


@pytest.mark.parametrize("system", [CATENARY, TWO_LINES], ids=["line", "network"])
def test_extremes_along_the_lines_are_those_of_the_history(system, monkeypatch):
    """Least, mean and greatest tension of each cell, and the places of its nodes, against stored time steps."""
    monkeypatch.setattr(integration, "CHUNK", 100)  # of 250 steps: the states come in three parts
    case = LoadCase("surge", BodyMotion.harmonic(0.1, (1.5, 0, 0, 0, 0, 0)), 40.0, 10.0)
    lines = find_envelopes(system, case, **SETTING, times=[0.2, 7.4, 40.0])
    history = solve_time_domain(mooring_system(system, SETTING["cells"], mesh="touchdown", motion=case.motion),
                                dt=0.2, duration=50.0, ramp=10.0)  # fmt: skip
    series = integrate_case(system, case, **SETTING)
    assert len(lines) == len(series.lines)
    for line, element in zip(lines, history.elements if system is TWO_LINES else [history], strict=True):
        after = element.tension[:, 51:]
        for name, value in (("low", after.min(axis=1)), ("mean", after.mean(axis=1)), ("high", after.max(axis=1))):
            assert getattr(line, name) == pytest.approx(value, rel=NEWTON), name
        assert line.s.size == after.shape[0] and 0 < line.s[0] < line.s[-1] < 220.0
        for pose, step in zip(line.poses, (52, 88, 250), strict=True):
            np.testing.assert_allclose(pose, element.r[..., step], rtol=0, atol=NEWTON * 220.0)
        ends = [line.rest[:, 0], line.rest[:, -1]]
        wanted = [system.anchor, system.fairlead] if system is CATENARY else None
        assert wanted is None or np.allclose(ends, wanted, rtol=SAME)


def test_a_line_of_sections_has_a_row_for_each():
    """Each section's own tension, and the names of its ends; the fairlead is that of the line as a whole.

    In a sea the mesh is fitted to the range of the motion, and has a node where the sections meet.
    """
    nodes = (
        Node("fixed", (-205.0, 0.0, -50.0)),
        Node("free", (-100.0, 0.0, -48.0)),
        Node("coupled", (0.0, 0.0, -10.0)),
    )
    weight = CHAIN.weight_in(OVER_SEABED)
    elements = tuple(Element(weight, CHAIN.EA, 110.0, ends, 0.0, CHAIN) for ends in ((0, 1), (1, 2)))
    case = LoadCase("surge", BodyMotion.harmonic(0.1, (1.0, 0, 0, 0, 0, 0)), 40.0, 10.0)
    regular, in_sea = solve_load_cases(Network(nodes, elements, OVER_SEABED), [case, SEAS[0]], **SETTING).cases
    assert in_sea.success, in_sea.message
    lower, upper = regular.lines
    assert (lower.line, upper.line) == ("line 1", "line 2")
    assert lower.maximum < upper.maximum
    assert upper.anchor_maximum == pytest.approx(lower.maximum, rel=JOINT)


def test_offset_and_current_change_the_rest():
    """A case at an offset, or in a current, is that of a system there: the same numbers to the last bit."""
    case = LoadCase("there", BodyMotion.harmonic(0.1, (1.0, 0, 0, 0, 0, 0)), 40.0, 10.0)
    x, y, z = CATENARY.fairlead
    there = replace(CATENARY, fairlead=(x + 2.0, y, z), environment=replace(CATENARY.environment, current=(0.6, 0, 0)))
    moved = replace(case, offset=(2.0, 0.0, 0.0), current=(0.6, 0.0, 0.0))
    one, other = (solve_load_cases(s, [c], **SETTING).cases for s, c in ((there, case), (CATENARY, moved)))
    assert one == other
    assert solve_load_cases(CATENARY, [case], **SETTING).cases[0].lines[0].mean < 0.99 * one[0].lines[0].mean
    nodes = tuple(replace(n, r=(n.r[0] + 2.0, *n.r[1:])) if n.kind == "coupled" else n for n in TWO_LINES.nodes)
    there = replace(TWO_LINES, nodes=nodes)
    moved = replace(case, offset=(2.0, 0.0, 0.0))
    one, other = (solve_load_cases(s, [c], **SETTING).cases for s, c in ((there, case), (TWO_LINES, moved)))
    assert one == other


def test_slack_is_timed():
    """A rope that a wide motion lets go slack has its time in that, and says so; a small one has none."""
    wide, small = (LoadCase("x", Motion.harmonic(0.1, (a, 0, 0)), 50.0, 10.0) for a in (6.0, 0.1))
    (wide, small) = solve_load_cases(TAUT, [wide, small], dt=0.05, cells=8).cases
    assert 5.0 < wide.lines[0].slack_time < 45.0 and any("slack" in text for text in wide.lines[0].warnings)
    assert small.lines[0].slack_time == 0.0 and not any("slack" in text for text in small.lines[0].warnings)


def test_extremes_of_longer_times_are_higher():
    """The extreme of ten times the reference time is higher, and lies in no interval without the estimate in it."""
    case = sea_case("long", 0.5, 1, duration=600.0)
    short, long = (
        solve_load_cases(TAUT, [case], **SETTING, reference_time=time).cases[0].lines[0] for time in (3600.0, 36000.0)
    )
    assert short.extreme_low < short.extreme < short.extreme_high
    assert long.extreme > short.extreme > short.mean and short.maximum == long.maximum


# ---------------------------------------------------------------- executors
def test_results_do_not_depend_on_the_executor():
    """Threads, one process, two processes and no executor at all give the same rows, bit for bit."""
    alone = solve_load_cases(CATENARY, SEAS, **SETTING).cases
    assert all(case.success for case in alone) and len({case.lines[0].maximum for case in alone}) == len(alone)
    with ThreadPoolExecutor(3) as pool:
        assert solve_load_cases(CATENARY, SEAS, **SETTING, executor=pool).cases == alone
    assert solve_load_cases(CATENARY, SEAS, **SETTING, executor=partial(ProcessPoolExecutor, 2)).cases == alone


class KillsItsProcess:
    """A motion that ends the process that first asks for it, and after that is a surge."""

    def __init__(self, mark):
        self.mark, self.surge = str(mark), BodyMotion.harmonic(0.1, (1.0, 0, 0, 0, 0, 0)).translation

    def displacement(self, t):
        """Return that of the surge, if the process lives."""
        if not os.path.exists(self.mark):
            with open(self.mark, "w", encoding="utf-8"):
                pass
            os.kill(os.getpid(), signal.SIGKILL)
        return self.surge.displacement(t)

    def velocity(self, t):
        """Return that of the surge."""
        return self.surge.velocity(t)

    def directions(self):
        """Return those of the surge."""
        return self.surge.directions()


def test_a_killed_process_loses_nothing(tmp_path):
    """A worker killed in the middle breaks its pool, another one goes on, and the table is that of one process."""
    killer = LoadCase("killer", KillsItsProcess(tmp_path / "killed"), 50.0, 10.0)
    cases = [*SEAS[:3], killer, *SEAS[3:]]
    table = solve_load_cases(CATENARY, cases, **SETTING, executor=partial(ProcessPoolExecutor, 2))
    assert (tmp_path / "killed").exists()
    assert table.cases == solve_load_cases(CATENARY, cases, **SETTING).cases


class BrokenPool(Executor):
    """An executor that takes nothing."""

    made = 0

    def __init__(self):
        BrokenPool.made += 1
        assert BrokenPool.made <= MOST_RESTARTS + 1

    def submit(self, *_, **__):
        """Refuse."""
        raise BrokenExecutor("broken from the start")


def test_an_executor_that_always_breaks_is_given_up():
    """One that was made for the table is replaced some times, one that was given not at all."""
    for executor, made in ((BrokenPool, MOST_RESTARTS + 1), (BrokenPool(), 0)):
        BrokenPool.made = 0
        with pytest.raises(BrokenExecutor, match="broken from the start"):
            solve_load_cases(CATENARY, SEAS[:1], **SETTING, executor=executor)
        assert BrokenPool.made == made


# ---------------------------------------------------------------- bad rows
def test_a_bad_row_spoils_no_other():
    """Rows below the seabed, out of reach or that raise have their status; the others are as without them."""
    deep = LoadCase("deep", BodyMotion.harmonic(0.1, (0, 0, 60.0, 0, 0, 0)), 40.0, 10.0)
    far = LoadCase("far", SEAS[0].motion, 40.0, 10.0, offset=(120.0, 0.0, 0.0))
    broken = LoadCase("broken", KillsItsProcess("/"), 40.0, 10.0)
    broken.motion.surge = None
    given = InputError("-1 m must be > 0", field="Hs")
    table = solve_load_cases(CATENARY, [SEAS[0], deep, far, broken, given, SEAS[1]], **SETTING)
    assert [case.status for case in table.cases][3:] == ["FAILED", "INVALID_INPUT", "SUCCESS"]
    assert table.cases[1].status == "INVALID_INPUT" and "below the seabed" in table.cases[1].message
    assert table.cases[2].status == "INVALID_INPUT" and "offset: [120.0, 0.0, 0.0] m" in table.cases[2].message
    assert table.cases[4].message == "Hs: -1 m must be > 0"
    alone = solve_load_cases(CATENARY, SEAS[:2], **SETTING).cases
    assert (table.cases[0], replace(table.cases[5], number=1)) == alone
    assert np.isnan(table.values("maximum")[1:5]).all() and len(table.failed) == 4 and "4 failed" in repr(table)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({}, "give either dt (s) and cells, or tolerance"),
        ({"dt": 0.1}, "give either dt (s) and cells, or tolerance"),
        ({"dt": 0.1, "cells": 8, "tolerance": 0.1}, "give either dt (s) and cells, or tolerance"),
        ({"dt": -0.1, "cells": 8}, "dt: -0.1 s"),
        ({"dt": 0.1, "cells": 1}, "cells: 1"),
        ({"dt": 0.1, "cells": 8, "wohler": 0.0}, "wohler: 0"),
    ],
)
def test_bad_settings_are_refused(arguments, message):
    """Before any work, with name, value and unit."""
    with pytest.raises(InputError) as caught:
        solve_load_cases(CATENARY, SEAS, **arguments)
    assert message in str(caught.value)
    with pytest.raises(InputError, match="list of LoadCase"):
        solve_load_cases(CATENARY, [], **SETTING)


# ---------------------------------------------------------------- what is kept
def test_progress_counts_rows():
    """It is called with none done, then after each row; where step and cells are given no other is looked at."""
    counts = []
    table = solve_load_cases(CATENARY, SEAS[:3], **SETTING, progress=lambda done, total: counts.append((done, total)))
    assert counts == [(0, 3), (1, 3), (2, 3), (3, 3)] and table.accuracy == Accuracy()


def test_rows_of_other_inputs_are_not_taken(tmp_path):
    """A resumed table takes rows of the same inputs, and computes those whose case, system or setting has changed."""
    output, counts = tmp_path / "cases.csv", []

    def solve(system=CATENARY, cases=SEAS[:3], **changed):
        counts.clear()
        return solve_load_cases(
            system, cases, **(SETTING | changed), output=output, progress=lambda done, _: counts.append(done)
        ).cases

    first = solve()
    assert counts[0] == 0 and solve() == first and counts == [3]
    solve(cases=[*SEAS[:2], SEAS[4]])
    assert counts[0] == 2
    solve(replace(CATENARY, length=220.5))
    assert counts[0] == 0
    solve(wohler=4.0)
    assert counts[0] == 0
    solve(resume=False)
    assert counts[0] == 0
    with pytest.raises(InputError, match="no content that a later run could compare"):
        solve(cases=[LoadCase("function", KillsItsProcess("/"), 40.0)])


def test_a_torn_record_is_cut_off(tmp_path):
    """The end of a file that was being written when the power failed is computed again, bit for bit."""
    output = tmp_path / "cases.csv"
    whole = solve_load_cases(CATENARY, SEAS[:3], **SETTING, output=output)
    rows = tmp_path / "cases.jsonl"
    text, table = rows.read_bytes(), output.read_text()
    rows.write_bytes(text[:-7])
    output.unlink()
    assert len(read_records(rows)) == 2
    assert solve_load_cases(CATENARY, SEAS[:3], **SETTING, output=output).cases == whole.cases
    assert output.read_text() == table
    assert sorted(rows.read_text().splitlines()) == sorted(text.decode().splitlines())


def test_records_are_the_rows_bit_for_bit():
    """A row that went through JSON is equal to itself."""
    for case in solve_load_cases(CATENARY, [SEAS[0], InputError("x", field="y")], **SETTING).cases:
        assert CaseResult.from_record(json.loads(json.dumps(case.as_record()))) == case


PROGRAM = """
from verification.load_cases.systems import CATENARY, sea_case
from solvers.load_cases import solve_load_cases
cases = [sea_case(f"sea {seed}", 0.5 + 0.02 * seed, seed, duration=400.0) for seed in range(24)]
solve_load_cases(CATENARY, cases, dt=0.1, cells=20, output="cases.csv")
"""


def test_a_killed_table_goes_on(tmp_path):
    """Killed with SIGKILL after some rows, the program goes on, and its file is that of an uninterrupted run."""
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    for folder in ("killed", "whole"):
        (tmp_path / folder).mkdir()
    run = partial(subprocess.Popen, [sys.executable, "-c", PROGRAM], env=environment)
    rows = tmp_path / "killed" / "cases.jsonl"
    child = run(cwd=tmp_path / "killed")
    deadline = time.monotonic() + 120
    while time.monotonic() < deadline and not (rows.exists() and rows.read_bytes().count(b"\n") >= 3):
        time.sleep(0.01)
    child.kill()
    child.wait()
    left = rows.read_bytes().count(b"\n")
    assert 3 <= left < 24 and not (tmp_path / "killed" / "cases.csv").exists()
    assert run(cwd=tmp_path / "killed").wait() == 0 and run(cwd=tmp_path / "whole").wait() == 0
    killed, whole = ((tmp_path / folder / "cases.csv").read_text() for folder in ("killed", "whole"))
    assert killed == whole and killed.count("SUCCESS") == 24
    assert rows.read_bytes().count(b"\n") == 24  # no row that was kept is computed again


def test_fingerprints_tell_inputs_apart(monkeypatch):
    """Equal content has one, and a changed digit anywhere another, in the text of a solver, too."""
    assert fingerprint(CATENARY, SEAS[0]) == fingerprint(replace(CATENARY), replace(SEAS[0]))
    others = [(CATENARY, SEAS[1]), (TAUT, SEAS[0]), (CATENARY, replace(SEAS[0], duration=100.1)), (CATENARY,)]
    others.append((CATENARY, replace(SEAS[0], motion=replace(SEAS[0].motion, seed=99))))
    other = replace(SURGE, operators=1.01 * SURGE.operators)
    others.append((CATENARY, replace(SEAS[0], motion=replace(SEAS[0].motion, operators=other))))
    assert len({fingerprint(*pair) for pair in [(CATENARY, SEAS[0]), *others]}) == 7
    text_of, now = SourceFileLoader.get_source, _sources.__wrapped__()
    monkeypatch.setattr(
        SourceFileLoader,
        "get_source",
        lambda self, name: text_of(self, name) + "#" * name.endswith(".mooring.stepping.steps"),
    )
    assert _sources.__wrapped__() != now
