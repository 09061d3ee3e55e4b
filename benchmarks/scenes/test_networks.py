"""What the page of a moving network says holds: errors against a finer run, tables by line, and how failures end."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest

from benchmarks.scenes import network_outputs, network_study, networks
from benchmarks.scenes.network_files import line_names, load
from benchmarks.scenes.network_study import Study, error_of, extrapolate
from solvers import (
    BodyMotion,
    CableProperties,
    ConvergenceError,
    Element,
    Environment,
    Node,
    SampledMotion,
    Status,
    mooring_system,
    solve_time_domain,
)
from solvers.io import load_network, write_moordyn
from solvers.io.network_scene import NamedNetwork

NETWORKS = Path(str(files("reference_data") / "scenes" / "networks"))
ROPE = CableProperties(EA=2e7, diameter=0.12, mass_per_length=25.0, Cdn=1.2, Cdt=0.05, Ca=1.0)
CHAIN = CableProperties(EA=1e8, diameter=0.08, mass_per_length=80.0, Cdn=2.0, Cdt=0.1, Ca=1.0)
SURGE = BodyMotion.harmonic(0.1, (1.0, 0.0, 0.5, 0.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0, 0.0, 0.0))

FEW_CELLS = {"STEPPED": ((6, 40), (12, 80)), "BALANCED": ((6, 5), (12, 9)), "LEVELS": ((12, 60), (24, 120), (48, 240))}
FINER, FINER_STEPS, FINER_PERIODS = 96, 480, 10
"""Cells, steps and periods of a run twice as fine as the reference."""
WORTH = 0.5
"""Least share of the promise that the error makes: the uncertainty adds a part of the smallest ones."""
SAME = 1e-9
"""Of the largest value: sums of forces in another order."""


def bridle(motion=SURGE, length=80.0) -> NamedNetwork:
    """Two ropes from mirrored anchors to a buoyed node, a chain from there to the body; nothing on the seabed."""
    environment = Environment()
    nodes = [
        Node("fixed", (0.0, -40.0, -90.0)),
        Node("fixed", (0.0, 40.0, -90.0)),
        Node("free", (55.0, 0.0, -60.0), mass=2000.0, volume=1.0, CdA=2.0, Ca=0.5),
        Node("coupled", (120.0, 0.0, -10.0)),
    ]
    lines = [(ROPE, 75.0, (0, 2)), (ROPE, 75.0, (1, 2)), (CHAIN, length, (2, 3))]
    elements = [Element(cable.weight_in(environment), cable.EA, L, ends, cable=cable) for cable, L, ends in lines]
    names = ("south", "north", "buoy", "fairlead")
    return NamedNetwork(nodes, elements, environment, name="bridle", node_names=names, motion=motion)


@pytest.fixture
def few_cells(monkeypatch):
    """Settings of few cells in place of those of the page, and no other code."""
    for name, value in FEW_CELLS.items():
        monkeypatch.setattr(network_study, name, value)
    monkeypatch.setattr(networks, "STEPPED", FEW_CELLS["STEPPED"])
    monkeypatch.setattr(networks.peers_beside, "rows", lambda study: [])


def report_of(network, compact=False) -> dict:
    """Return the report of a network, the last that the study yields, after as many steps as it says."""
    *before, last = networks.study(Path("bridle.toml"), network, (), compact)
    assert len(before) + 1 == networks.steps(network, compact)
    return last


@cache
def finer_wave() -> np.ndarray:
    """Return the tensions of a run twice as fine as the reference, (lines, S), N."""
    study, system = Study(bridle()), mooring_system(bridle(), FINER)
    dt = study.period / FINER_STEPS
    return study.wave(solve_time_domain(system, dt=dt, periods=FINER_PERIODS))


# ---------------------------------------------------------------- settings
def test_errors_of_the_settings_hold_against_a_finer_run(few_cells):
    """Every setting is as far from a finer run as its row and the uncertainty of the reference promise."""
    study = Study(bridle())
    reference = study.reference()
    ladder = list(study.ladder())
    rows = networks.rows_of(ladder, reference["wave"])
    assert [row["status"] for row in rows] == ["SUCCESS"] * 4
    for point, row in zip(ladder, rows, strict=True):
        error, promised = error_of(point["wave"], finer_wave()), row["error"] + reference["uncertainty"]
        assert WORTH * promised <= error <= promised, (row["method"], row["cells"], error, promised)
    agreement = study.agreement(ladder)
    assert agreement["cells"] == 12 and 0 < agreement["difference"] < rows[3]["error"]  # the mesh is in neither


def test_second_order_is_extrapolated_and_first_order_is_not():
    """Waves with an error C h^2 are extrapolated to the truth; with C h the finest is taken with its last change."""
    truth = 1e6 + 1e5 * np.sin(np.linspace(0, 6, 40)).reshape(2, 20)
    waves = {order: [truth * (1 + 0.1 * h**order) for h in (1.0, 0.5, 0.25)] for order in (1, 2)}
    wave, uncertainty, extrapolated = extrapolate(waves[2])
    assert extrapolated and error_of(wave, truth) < 1e-14 and uncertainty == pytest.approx(0.1 / 16, rel=1e-12)
    assert not extrapolate([truth * (1 + e) for e in (0.1, 0.01, 0.0)])[2]  # too fast for an order
    wave, uncertainty, extrapolated = extrapolate(waves[1])
    assert not extrapolated and wave is waves[1][2] and uncertainty == pytest.approx(0.025 / 1.025, rel=1e-12)


def test_harmonic_balance_ends_after_two_failures(few_cells, monkeypatch):
    """What costs seconds and fails is tried twice, not at every setting."""
    monkeypatch.setattr(network_study, "BALANCED", ((6, 5),) * 2 + ((12, 5), (12, 9)))
    failing = lambda self, method, cells, other: {"method": method, "wave": None, "cells": cells, "harmonics": other}
    monkeypatch.setattr(Study, "solve", failing)
    methods = [row["method"] for row in Study(bridle()).ladder()]
    assert methods.count("harmonic balance") == network_study.MOST_FAILURES
    assert methods.count("time domain") == len(FEW_CELLS["STEPPED"])


# ---------------------------------------------------------------- what the tables say
def test_mirrored_lines_have_mirrored_rows_and_add_up_to_the_body(few_cells):
    """In surge and heave both ropes have one row; the chain's largest force is that of the body, no sway, no yaw."""
    report = report_of(bridle())
    south, north, chain = report["motion"]
    for key in ("pretension", "min", "mean", "max", "std", "anchor_max", "uplift", "uplift_angle"):
        assert south[key] == pytest.approx(north[key], rel=1e-6), key
    assert south["min"] < south["pretension"] < south["max"] and south["grounded"] is None
    assert chain["uplift"] is None and south["uplift"] > 0  # ropes that hang from no seabed pull their anchors up
    body = {row["component"]: row for row in report["body"]}
    assert max(abs(body[name][key]) for name in ("sway", "yaw") for key in ("min", "max")) < 1e-3 * chain["max"]
    largest = np.hypot(body["surge"]["min"], body["heave"]["min"])  # the chain's force is that of the body
    assert chain["max"] <= largest * (1 + 1e-3)
    assert chain["greatest"]["s"] > 40.0  # the heavy end of the chain is the upper one


def test_statistics_are_those_of_the_history(few_cells):
    """Mean, deviation, extremes and their place against the stored history, computed anew."""
    study = Study(bridle())
    reference = study.reference()
    reference["wave"] = study.wave(reference["history"])  # without the extrapolation
    rows = network_outputs.lines(study, ["a", "b", "c"], reference, networks.statics(bridle(), True))
    history = reference["history"]
    last = history.time >= history.time[-1] - study.period * (1 - 1e-9)
    force = np.linalg.norm(history.elements[2].fairlead_force, axis=0)[last]
    close = {"mean": force.mean(), "std": force.std(), "max": force.max(), "min": force.min()}
    for key, value in close.items():
        assert rows[2][key] == pytest.approx(value, rel=2e-3), key
    cells = history.elements[2].tension[:, last]
    assert rows[2]["greatest"]["tension"] == cells.max() and rows[2]["least"]["tension"] == cells.min()
    assert rows[2]["slack"] == network_outputs.NEVER
    assert rows[0]["uplift"] == pytest.approx(history.elements[0].anchor_force[2, last].max(), rel=SAME)
    arm = np.array([120.0, 0.0, -10.0])  # the body does not turn: from its moving reference point as at rest
    pitch = np.cross(arm, history.elements[2].fairlead_force.T)[last, 1]
    row = network_outputs.body(study, reference)[4]
    assert [row["max"], row["min"], row["mean"]] == pytest.approx([pitch.max(), pitch.min(), pitch.mean()], rel=SAME)


def test_grounded_length_counts_parts_of_cells():
    """By hand: two cells of 10 m below, one that crosses at a third, one above; one at the height is not."""
    z = np.array([[-1.0, 0.0], [-1.0, 0.0], [-1.0, 0.0], [2.0, 0.0], [5.0, 0.0]])
    s = np.array([0.0, 10.0, 20.0, 32.0, 40.0])
    assert network_outputs.grounded_length(z, s, 0.0).tolist() == [20.0 + 12.0 / 3, 0.0]


def test_a_slack_line_is_said_to_be(few_cells, monkeypatch):
    """A light line that is let go loses all tension for part of the period; the row says from when and how long."""
    monkeypatch.setattr(network_study, "BALANCED", ())
    monkeypatch.setattr(network_study, "COMPACT_BALANCED", ())
    network = bridle(BodyMotion.harmonic(0.25, (6.0, 0.0, 3.0, 0.0, 0.0, 0.0)), length=84.0)
    report = report_of(network, compact=True)
    slack = [row["slack"] for row in report["motion"]]
    assert any(0 < part["share"] < 1 and part["start"] is not None for part in slack)
    assert any("goes slack" in text for text in report["warnings"])


# ---------------------------------------------------------------- files
def test_files_of_other_codes_are_the_same_network(tmp_path):
    """A MoorDyn file by either suffix, and a MAP++ file: the lines, notes on what is not used, a series as motion."""
    network = load_network(NETWORKS / "oc3_moving.toml")
    write_moordyn(tmp_path / "spar.dat", network)
    read, notes = load(tmp_path / "spar.dat", series=NETWORKS / "drift.csv")
    assert any("NumSegs" in note for note in notes) and read.motion.period is None
    assert read.motion.displacement([[0.0, 0.0, 0.0]], 60.0)[0, 0] == pytest.approx(4.0)
    flagged, flags = load(NETWORKS.parent / "oc3_hywind.map", depth=320.0)
    assert flags and all(note.startswith("Not used: ") for note in flags) and len(line_names(flagged)) == 3
    wanted = networks.statics(network, True)["exact"]
    for other in (read, flagged):
        assert networks.statics(other, True)["exact"] == pytest.approx(wanted, rel=1e-3)  # of a rounded weight
    assert line_names(network)[0] == "anchor 1 \N{EN DASH} fairlead 1"


# ---------------------------------------------------------------- series and failures
def test_a_series_is_taken_in_time_alone(few_cells):
    """No harmonics, no harmonic balance; the history lasts as long as the series."""
    t = np.linspace(0.0, 30.0, 31)
    series = SampledMotion(t, np.column_stack([2 * np.sin(np.pi * t / 30.0) ** 2, 0 * t, 0 * t]))
    report = report_of(bridle(BodyMotion(series)))
    assert report["period"] is None and report["duration"] == 30.0 and report["agreement"] is None
    assert {row["method"] for row in report["ladder"]} == {"time domain"}
    assert report["waveforms"]["time"][-1] == pytest.approx(30.0) and report["waveforms"]["harmonics"] is None
    assert report["impedance"]["frequency"] is None and "harmonics" not in report["body"][0]


def test_a_network_without_equilibrium_says_so(few_cells, monkeypatch):
    """A sentence in place of the tables, where nothing is known of the lines at rest."""

    def fail(network):
        raise ConvergenceError("residual 3 N")

    monkeypatch.setattr(networks, "solve_network", fail)
    report = report_of(bridle())
    assert report["failed"] == "The network has no equilibrium: residual 3 N" and "statics" not in report


def test_failed_steps_are_said_with_their_status(few_cells, monkeypatch):
    """Where every history fails the report has the status, its sentence and time, and no figures of the motion."""
    whole = network_study.solve_time_domain
    fail = lambda *a, **k: replace(whole(*a, **k), status=Status.STEP_FAILED, event=(1.25, 3))
    monkeypatch.setattr(network_study, "solve_time_domain", fail)
    report = report_of(bridle())
    assert "it failed at t = 1.25 s" in report["failed"] and Status.STEP_FAILED.value in report["failed"]
    assert "motion" not in report and "waveforms" not in report
    steps = [row for row in report["ladder"] if row["method"] == "time domain"]
    assert {row["status"] for row in steps} == {"STEP_FAILED"} and {row["error"] for row in steps} == {None}


def test_a_network_at_rest_has_its_pretension(few_cells):
    """Without a motion: exact tensions and the stiffness on the body."""
    report = report_of(bridle(motion=None))
    assert not report["moves"] and len(report["statics"]["exact"]) == 3
    assert np.shape(report["stiffness_at_rest"]) == (6, 6) and report["stiffness_at_rest"][0][0] > 0
